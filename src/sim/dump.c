/* -dump_options: all options of a scene as a commented options file, from the notes of what was read. */
#include "sim_impl.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

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

PetscErrorCode OthersVisit(OtherVisitor visit, void *context)
{
  PetscInt count, restored;
  char   **name, **value;

  PetscFunctionBegin;
  PetscCall(PetscOptionsLeftGet(NULL, &count, &name, &value));
  for (PetscInt k = 0; k < count; k++) visit(context, name[k], value[k] ? value[k] : "");
  restored = count;
  PetscCall(PetscOptionsLeftRestore(NULL, &restored, &name, &value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An OtherVisitor. */
static void WriteOther(void *file, const char name[], const char value[])
{
  fprintf((FILE *)file, "-%s%s%s\n", name, value[0] ? " " : "", value);
}

static PetscErrorCode WriteDump(Sim sim, FILE *file)
{
  PetscInt          n;
  const OptionNote *note  = OptionsNoted(&n);
  const char       *title = "";

  PetscFunctionBegin;
  fprintf(file, "# All options of this scene; options behind a # have their default.\n");
  for (PetscInt k = 0; k < n; k++) {
    if (!note[k].read || !strcmp(note[k].title, DEEDS)) continue;
    if (strcmp(note[k].title, title)) fprintf(file, "\n# --- %s ---\n", note[k].title);
    title = note[k].title;
    PetscCall(WriteOption(file, &note[k]));
  }
  fprintf(file, "\n# --- PETSc's own options in use ---\n");
  PetscCall(OthersVisit(WriteOther, file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All options of the program, with <body> for the name of a body, and what cannot be used together. */
static PetscErrorCode WriteList(Sim sim, FILE *file)
{
  Json json = {.file = file};

  PetscFunctionBegin;
  JsonObject(&json, NULL);
  PetscCall(OptionsJson(&json, PETSC_FALSE));
  UnitsJson(&json);
  RefusalsJson(&json);
  JsonEnd(&json);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* -help WORD: the options that have it in name, meaning, group or choice. */
static PetscErrorCode PrintHelpOn(Sim sim)
{
  PetscInt          n;
  const OptionNote *note  = OptionsNoted(&n);
  const char       *title = "";
  PetscBool         any   = PETSC_FALSE, petsc;
  char              help[NAMES_LENGTH];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++) {
    const OptionRow *row = &note[k].row;

    if (note[k].owner[0] && !strchr(note[k].name, '<')) continue; /* a body's: shown once, as any body's */
    PetscCall(OptionHelp(row, help));
    if (!Mentions(note[k].name, sim->word) && !Mentions(help, sim->word) && !Mentions(note[k].title, sim->word) &&
        !Mentions(note[k].choice, sim->word))
      continue;
    if (strcmp(note[k].title, title)) PetscCall(PetscPrintf(sim->comm, "%s%s:\n", any ? "\n" : "", note[k].title));
    title = note[k].title;
    any   = PETSC_TRUE;
    PetscCall(PetscPrintf(sim->comm, "  %s%s%s: %s%s%s%s\n", note[k].name, note[k].value[0] ? " " : "", note[k].value,
                          help, note[k].choice[0] ? " (" : "", note[k].choice, note[k].choice[0] ? ")" : ""));
  }
  PetscCall(SolversHelp(sim->word, &petsc));
  PetscCheckUser(any || petsc, sim->comm, "-help %s: no option has that in its name or meaning; -help alone lists all",
                 sim->word);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FileWrite(Sim sim, const char path[], const char what[], FileWriter write)
{
  PetscMPIInt rank;
  int         error = 0;

  PetscFunctionBegin;
  if (!path[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Comm_rank(sim->comm, &rank));
  if (!rank) {
    FILE *file = fopen(path, "w");

    if (file) PetscCall((*write)(sim, file));
    if (!file || fclose(file)) error = errno;
  }
  PetscCallMPI(MPI_Bcast(&error, 1, MPI_INT, 0, sim->comm));
  PetscCheckUser(!error, sim->comm, "cannot write the %s %s: %s", what, path, strerror(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode DumpOptions(Sim sim)
{
  PetscFunctionBegin;
  PetscCall(FileWrite(sim, sim->dump, "options file", WriteDump));
  if (sim->dump[0]) PetscCall(PetscPrintf(sim->comm, "all options of this scene are in %s\n", sim->dump));
  PetscCall(FileWrite(sim, sim->list, "list of options", WriteList));
  if (sim->word[0]) PetscCall(PrintHelpOn(sim));
  PetscFunctionReturn(PETSC_SUCCESS);
}
