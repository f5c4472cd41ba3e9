/* -dump_options: all options of a scene as a commented options file. The file is made from the text of -help: PETSc
   prints this text through a function pointer, and the function here keeps it. */
#include "sim_impl.h"
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static FILE  *keeper = NULL; /* a stream that appends the help to the text */
static char  *text   = NULL;
static size_t text_length;
static PetscErrorCode (*printer)(FILE *, const char[], va_list); /* PETSc's own, to be put back */

static PetscErrorCode KeepHelp(FILE *stream, const char format[], va_list arguments)
{
  PetscFunctionBegin;
  (void)vfprintf(keeper, format, arguments);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode HelpCatch(void)
{
  PetscFunctionBegin;
  keeper = open_memstream(&text, &text_length);
  PetscCheck(keeper, PETSC_COMM_SELF, PETSC_ERR_MEM, "cannot keep the help texts");
  printer       = PetscVFPrintf;
  PetscVFPrintf = KeepHelp;
  PetscCall(PetscOptionsHelpPrintedDestroy(&PetscOptionsHelpPrintedSingleton)); /* options read again are shown again */
  PetscCall(PetscOptionsSetValue(NULL, "-help", NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode HelpCaught(char **caught)
{
  PetscFunctionBegin;
  PetscVFPrintf = printer;
  PetscCall(PetscOptionsClearValue(NULL, "-help"));
  (void)fclose(keeper);
  *caught = text;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode DumpStart(Sim sim)
{
  PetscBool set;

  PetscFunctionBegin;
  PetscOptionsBegin(sim->comm, NULL, "Help", "Sim");
  PetscCall(PetscOptionsString(DUMP_OPTION, "write a commented options file of the scene with all options, and stop",
                               "SimSetFromOptions", sim->dump, sim->dump, sizeof(sim->dump), &set));
  PetscOptionsEnd();
  PetscCheckUser(!set || sim->dump[0], sim->comm, DUMP_OPTION " needs the name of the file to write");
  if (!set) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(HelpCatch());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes one line of help, " -name <now value : formerly default>: meaning (source)" and similar forms, as two lines of
   the file. Leaves out the list of numbers of an option that is not set, since PETSc shows the first number only. */
static PetscErrorCode WriteOption(FILE *file, char *line)
{
  char      name[PETSC_MAX_PATH_LEN], shown[PETSC_MAX_PATH_LEN] = "", given[PETSC_MAX_PATH_LEN], *meaning, *end;
  char     *value = shown;
  PetscBool set;

  PetscFunctionBegin;
  if (sscanf(line, " %255[^ :]%*[ :]<%255[^>]", name, shown) < 1 || !(meaning = strchr(line, '>')))
    PetscFunctionReturn(PETSC_SUCCESS);
  if (!strcmp(name, DUMP_OPTION) || !strcmp(name, "-dry_run")) PetscFunctionReturn(PETSC_SUCCESS);
  meaning += 1 + strspn(meaning + 1, ": ");
  if ((end = strrchr(meaning, '(')) && end > meaning) end[-1] = 0; /* the source */
  if ((end = strstr(shown, " : ")))
    *end = 0;
  else
    shown[0] = 0;
  if (!strncmp(value, "now ", 4)) value += 4;
  PetscCall(PetscOptionsGetString(NULL, NULL, name, given, sizeof(given), &set));
  if (set) value = given;
  fprintf(file, "# %s\n%s%s", meaning, set ? "" : "# ", name);
  fprintf(file, strchr(value, ' ') ? " \"%s\"\n" : value[0] ? " %s\n" : "%s\n", value);
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

static PetscErrorCode WriteFile(const char path[], char *help, int *error)
{
  FILE *file = fopen(path, "w");
  char *rest = NULL;

  PetscFunctionBegin;
  *error = file ? 0 : errno;
  if (!file) PetscFunctionReturn(PETSC_SUCCESS);
  fprintf(file, "# All options of this scene; options behind a # have their default.\n");
  for (char *line = strtok_r(help, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
    const size_t length = strlen(line);

    if (!strncmp(line, "  -", 3))
      PetscCall(WriteOption(file, line));
    else if (line[length - 1] == ':' && line[0] != ' ')
      fprintf(file, "\n# --- %.*s ---\n", (int)length - 1, line);
  }
  PetscCall(WriteOthers(file));
  if (fclose(file)) *error = errno;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode DumpFinish(Sim sim)
{
  PetscMPIInt rank;
  char       *help  = NULL;
  int         error = 0;

  PetscFunctionBegin;
  if (!sim->dump[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(HelpCaught(&help));
  PetscCallMPI(MPI_Comm_rank(sim->comm, &rank));
  if (!rank) PetscCall(WriteFile(sim->dump, help, &error));
  free(help);
  PetscCallMPI(MPI_Bcast(&error, 1, MPI_INT, 0, sim->comm));
  PetscCheckUser(!error, sim->comm, "cannot write the options file %s: %s", sim->dump, strerror(error));
  PetscCall(PetscPrintf(sim->comm, "all options of this scene are in %s\n", sim->dump));
  PetscFunctionReturn(PETSC_SUCCESS);
}
