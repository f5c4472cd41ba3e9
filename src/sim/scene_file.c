/* scene.json: what the program knows about a scene, for programs. Each part writes its own. */
#include "sim_impl.h"
#include <stdio.h>
#include <stdlib.h>

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

/* An OtherVisitor. */
static void WriteOther(void *context, const char name[], const char value[])
{
  Json *json = (Json *)context;

  JsonObject(json, NULL);
  JsonText(json, "name", name);
  JsonText(json, "value", value);
  JsonEnd(json);
}

static PetscErrorCode WriteScene(Sim sim, PetscBool particles, FILE *file)
{
  Json        json = {.file = file};
  SceneModel  model;
  PetscMPIInt ranks;

  PetscFunctionBegin;
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
  JsonArray(&json, "petsc_options");
  PetscCall(OthersVisit(WriteOther, &json));
  JsonEnd(&json);
  JsonArray(&json, "columns");
  PetscCall(OutputEachColumn(sim->output, WriteColumn, &json));
  JsonEnd(&json);
  JsonEnd(&json);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A FileWriter, before there are particles. */
static PetscErrorCode WriteAlone(Sim sim, FILE *file)
{
  return WriteScene(sim, PETSC_FALSE, file);
}

PetscErrorCode SimScene(Sim sim, PetscBool particles, char **text)
{
  PetscMPIInt rank;
  size_t      length;

  PetscFunctionBegin;
  *text = NULL;
  PetscCallMPI(MPI_Comm_rank(sim->comm, &rank));
  if (!rank) {
    FILE *stream = open_memstream(text, &length);

    PetscCheck(stream, PETSC_COMM_SELF, PETSC_ERR_MEM, "cannot keep the text of scene.json");
    PetscCall(WriteScene(sim, particles, stream));
    PetscCheck(!fclose(stream), PETSC_COMM_SELF, PETSC_ERR_MEM, "cannot keep the text of scene.json");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SceneFileWrite(Sim sim, const char path[])
{
  char *text;

  PetscFunctionBegin;
  if (path) {
    PetscCall(FileWrite(sim, path, "scene file", WriteAlone));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(SimScene(sim, PETSC_TRUE, &text));
  PetscCall(OutputText(sim->output, OUTPUT_SCENE, text));
  free(text);
  PetscFunctionReturn(PETSC_SUCCESS);
}
