/* scene.json: what the program knows about a scene, for programs. Each part writes its own. */
#include "sim_impl.h"
#include <errno.h>
#include <string.h>

/* A ColumnVisitor. */
static PetscErrorCode WriteColumn(void *context, const char file[], const Column *column, const ColumnWords *words)
{
  Json *json = (Json *)context;

  PetscFunctionBegin;
  JsonObject(json, NULL);
  JsonText(json, "file", file);
  JsonText(json, "name", column->name);
  JsonText(json, "head", words->head);
  JsonText(json, "unit", words->unit);
  JsonText(json, "counts", words->counts);
  JsonText(json, "of", words->of);
  JsonText(json, "whose", words->whose);
  JsonText(json, "direction", words->direction);
  JsonText(json, "extent", words->extent);
  JsonArray(json, "needs");
  for (PetscInt k = 0; words->needs[k]; k++) JsonText(json, NULL, words->needs[k]);
  JsonEnd(json);
  JsonEnd(json);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The options that no class has read yet: those of PETSc's solvers. */
static PetscErrorCode WriteOthers(Json *json)
{
  PetscInt count, restored;
  char   **name, **value;

  PetscFunctionBegin;
  JsonArray(json, "petsc_options");
  PetscCall(PetscOptionsLeftGet(NULL, &count, &name, &value));
  for (PetscInt k = 0; k < count; k++) {
    JsonObject(json, NULL);
    JsonText(json, "name", name[k]);
    JsonText(json, "value", value[k] ? value[k] : "");
    JsonEnd(json);
  }
  restored = count;
  PetscCall(PetscOptionsLeftRestore(NULL, &restored, &name, &value));
  JsonEnd(json);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The text, to be freed with free. Rank 0 only. */
static PetscErrorCode MakeText(Sim sim, PetscBool particles, char **text)
{
  size_t      length;
  Json        json = {.file = open_memstream(text, &length)};
  SceneModel  model;
  PetscMPIInt ranks;

  PetscFunctionBegin;
  PetscCheck(json.file, PETSC_COMM_SELF, PETSC_ERR_MEM, "cannot keep the text of scene.json");
  PetscCallMPI(MPI_Comm_size(sim->comm, &ranks));
  ModelFind(sim, &model);
  JsonObject(&json, NULL);
  JsonText(&json, "version", ISPH_VERSION);
  JsonInt(&json, "ranks", ranks);
  JsonReal(&json, "time_start", sim->state.time);
  JsonReal(&json, "time_end", sim->time_end);
  DomainJson(sim->domain, &json);
  SceneJson(sim->scene, sim->state.time, sim->time_end, &json);
  TensionJson(sim->tension, &json);
  StepperJson(sim->stepper, particles, &json);
  ModelJson(sim, &model, &json);
  PetscCall(OptionsJson(&json, PETSC_TRUE));
  PetscCall(WriteOthers(&json));
  JsonArray(&json, "columns");
  PetscCall(OutputEachColumn(sim->output, WriteColumn, &json));
  JsonEnd(&json);
  JsonEnd(&json);
  PetscCheck(!ferror(json.file) && !fclose(json.file), PETSC_COMM_SELF, PETSC_ERR_MEM, "cannot keep scene.json");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SceneFileWrite(Sim sim, const char path[])
{
  PetscMPIInt rank;
  char       *text  = NULL;
  int         error = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(sim->comm, &rank));
  if (!rank) PetscCall(MakeText(sim, (PetscBool)!path, &text));
  if (!path) PetscCall(OutputText(sim->output, OUTPUT_SCENE, text));
  if (path && !rank) {
    FILE *file = fopen(path, "w");

    if (!file || fputs(text, file) < 0) error = errno;
    if (file && fclose(file) && !error) error = errno;
  }
  free(text);
  PetscCallMPI(MPI_Bcast(&error, 1, MPI_INT, 0, sim->comm));
  PetscCheckUser(!error, sim->comm, "cannot write the scene file %s: %s", path, strerror(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}
