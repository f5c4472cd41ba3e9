/* -dump_options: all options of a scene as a commented options file, from the notes of what was read. */
#include "sim_impl.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>

/* Options that say what to do with the scene, not what it is. */
static const char *const deeds[] = {DUMP_OPTION, LIST_OPTION, SCENE_OPTION, "-dry_run", "-scene_model"};

static PetscBool IsDeed(const char name[])
{
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(deeds); k++)
    if (!strcmp(name, deeds[k])) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* An option as two lines: what it means, and its value, behind a # if it is the default. The default of a list of
   numbers is left out: how many are allowed depends on the dimension. */
static PetscErrorCode WriteOption(FILE *file, const OptionNote *note)
{
  const PetscBool shown = (PetscBool)(note->given || note->row.kind < ROW_NUMBERS);
  const char     *value = shown ? note->value : "", *quote = strchr(value, ' ') ? "\"" : "";
  char            help[NAMES_LENGTH];

  PetscFunctionBegin;
  PetscCall(OptionHelp(&note->row, help));
  fprintf(file, "# %s\n%s%s%s%s%s%s\n", help, note->given ? "" : "# ", note->name, value[0] ? " " : "", quote, value,
          quote);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes the options that no class has read yet: those of PETSc's solvers. */
static PetscErrorCode WriteOthers(FILE *file)
{
  PetscInt count, restored;
  char   **name, **value;

  PetscFunctionBegin;
  fprintf(file, "\n# --- PETSc's own options in use ---\n");
  PetscCall(PetscOptionsLeftGet(NULL, &count, &name, &value));
  for (PetscInt k = 0; k < count; k++)
    fprintf(file, "-%s%s%s\n", name[k], value[k] ? " " : "", value[k] ? value[k] : "");
  restored = count;
  PetscCall(PetscOptionsLeftRestore(NULL, &restored, &name, &value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteDump(FILE *file)
{
  PetscInt          n;
  const OptionNote *note  = OptionsNoted(&n);
  const char       *title = "";

  PetscFunctionBegin;
  fprintf(file, "# All options of this scene; options behind a # have their default.\n");
  for (PetscInt k = 0; k < n; k++) {
    if (!note[k].read || IsDeed(note[k].name)) continue;
    if (strcmp(note[k].title, title)) fprintf(file, "\n# --- %s ---\n", note[k].title);
    title = note[k].title;
    PetscCall(WriteOption(file, &note[k]));
  }
  PetscCall(WriteOthers(file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All options of the program, with <body> for the name of a body, and what cannot be used together. */
static PetscErrorCode WriteList(FILE *file)
{
  Json json = {.file = file};

  PetscFunctionBegin;
  JsonObject(&json, NULL);
  PetscCall(OptionsJson(&json, PETSC_FALSE));
  RefusalsJson(&json);
  JsonEnd(&json);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes a file on rank 0. */
static PetscErrorCode Write(MPI_Comm comm, const char path[], PetscErrorCode (*write)(FILE *))
{
  PetscMPIInt rank;
  int         error = 0;

  PetscFunctionBegin;
  if (!path[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (!rank) {
    FILE *file = fopen(path, "w");

    if (file) PetscCall((*write)(file));
    if (!file || fclose(file)) error = errno;
  }
  PetscCallMPI(MPI_Bcast(&error, 1, MPI_INT, 0, comm));
  PetscCheckUser(!error, comm, "cannot write the options file %s: %s", path, strerror(error));
  PetscCall(PetscPrintf(comm, "all options of this scene are in %s\n", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode DumpOptions(Sim sim)
{
  PetscFunctionBegin;
  PetscCall(Write(sim->comm, sim->dump, WriteDump));
  PetscCall(Write(sim->comm, sim->list, WriteList));
  PetscFunctionReturn(PETSC_SUCCESS);
}
