/* -dump_options: the help texts of all options, with what the scene sets, as an options file. PETSc prints help through
   a function pointer; here that function keeps the text. */
#include "sim_impl.h"
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static char  *kept = NULL; /* the text so far */
static size_t used, room;
static PetscErrorCode (*printer)(FILE *, const char[], va_list); /* of PETSc, to be put back */

static PetscErrorCode Keep(FILE *stream, const char format[], va_list arguments)
{
  char   line[8192];
  size_t length, full;

  PetscFunctionBegin;
  PetscCall(PetscVSNPrintf(line, sizeof(line), format, &full, arguments));
  PetscCall(PetscStrlen(line, &length));
  if (used + length + 1 > room) {
    room = 2 * (used + length + 1);
    PetscCall(PetscRealloc(room, &kept));
  }
  memcpy(kept + used, line, length + 1);
  used += length;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The next line of a text, which is cut there; NULL at the end. */
static char *NextLine(char **rest)
{
  char *line = *rest, *end;

  if (!line) return NULL;
  end = strchr(line, '\n');
  if (end) *end = 0;
  *rest = end ? end + 1 : NULL;
  return line;
}

PetscErrorCode DumpStart(Sim sim)
{
  PetscBool set;

  PetscFunctionBegin;
  PetscOptionsBegin(sim->comm, NULL, "Options", "Sim");
  PetscCall(PetscOptionsString("-dump_options",
                               "write a commented options file of the scene with all options, and stop",
                               "SimSetFromOptions", sim->dump, sim->dump, sizeof(sim->dump), &set));
  PetscOptionsEnd();
  PetscCheckUser(!set || sim->dump[0], sim->comm, "-dump_options needs the name of the file to write");
  if (!set) PetscFunctionReturn(PETSC_SUCCESS);
  used = room   = 0;
  printer       = PetscVFPrintf;
  PetscVFPrintf = Keep;
  PetscCall(PetscOptionsSetValue(NULL, "-help", NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Cuts the source's name, the last words in parentheses, off a help text. */
static void CutManual(char *help)
{
  char *last = strrchr(help, '(');

  if (last && last > help && last[-1] == ' ' && help[strlen(help) - 1] == ')') last[-1] = 0;
}

/* One line of help, "  -name <now value : formerly default>: help (manual)" in several forms, as lines of the file. */
static PetscErrorCode WriteOption(FILE *file, char *line)
{
  char       *name = line + 2, *name_end = name + strcspn(name, " :"), *open = strchr(name_end, '<'), *close, *help;
  const char *value;
  char        text[PETSC_MAX_PATH_LEN] = "";
  PetscBool   set, array;

  PetscFunctionBegin;
  if (!open || !(close = strchr(open, '>'))) PetscFunctionReturn(PETSC_SUCCESS);
  help = close + 1 + strspn(close + 1, ": ");
  CutManual(help);
  *close = *name_end = 0;
  value              = open + 1;
  if (!strncmp(value, "now ", 4)) value += 4;
  array = (PetscBool)!strstr(value, " : "); /* of which PETSc shows one number only */
  if (!array) *strstr(value, " : ") = 0;
  if (!strcmp(value, "nan.")) value = "nan"; /* PETSc does not read what it writes */
  PetscCall(PetscOptionsGetString(NULL, NULL, name, text, sizeof(text), &set));
  if (!strcmp(name, "-dump_options") || !strcmp(name, "-dry_run")) PetscFunctionReturn(PETSC_SUCCESS);
  if (set)
    fprintf(file, "# %s\n%s %s%s%s\n", help, name, strchr(text, ' ') ? "\"" : "", text, strchr(text, ' ') ? "\"" : "");
  else if (strchr(value, '<') || array)
    fprintf(file, "# %s\n# %s\n", help, name);
  else
    fprintf(file, "# %s\n# %s %s\n", help, name, value);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Options in use that no help text names: PETSc's own. */
static PetscErrorCode WriteOthers(FILE *file)
{
  char *options, *rest;

  PetscFunctionBegin;
  PetscCall(OutputOptions(&options));
  fprintf(file, "\n# --- PETSc's own options in use ---\n");
  rest = options;
  for (char *line = NextLine(&rest); line; line = NextLine(&rest)) {
    char   name[PETSC_MAX_PATH_LEN];
    char  *blank  = strchr(line, ' ');
    size_t length = blank ? (size_t)(blank - line) : strlen(line);

    if (!length || length + 4 > sizeof(name)) continue;
    (void)snprintf(name, sizeof(name), "  %.*s", (int)length, line);
    for (const char *found = strstr(kept, name);; found = strstr(found + 1, name)) {
      if (!found) fprintf(file, "%s\n", line);
      if (!found || strchr(" :", found[strlen(name)])) break;
    }
  }
  PetscCall(PetscFree(options));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode DumpFinish(Sim sim)
{
  PetscMPIInt rank;
  FILE       *file  = NULL;
  int         error = 0;

  PetscFunctionBegin;
  if (!sim->dump[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscVFPrintf = printer;
  PetscCall(PetscOptionsClearValue(NULL, "-help"));
  PetscCallMPI(MPI_Comm_rank(sim->comm, &rank));
  if (!rank) {
    char *text, *rest;

    file = fopen(sim->dump, "w");
    if (!file) error = errno;
    PetscCall(PetscStrallocpy(kept, &text));
    rest = text;
    if (file) fprintf(file, "# All options of this scene; those behind a # have their default.\n");
    for (char *line = NextLine(&rest); line && file; line = NextLine(&rest)) {
      const size_t length = strlen(line);

      if (!strncmp(line, "  -", 3))
        PetscCall(WriteOption(file, line));
      else if (length > 1 && line[length - 1] == ':' && line[0] != ' ')
        fprintf(file, "\n# --- %.*s ---\n", (int)length - 1, line);
    }
    PetscCall(PetscFree(text));
    if (file) PetscCall(WriteOthers(file));
    if (file && fclose(file)) error = errno;
  }
  PetscCallMPI(MPI_Bcast(&error, 1, MPI_INT, 0, sim->comm));
  PetscCheckUser(!error, sim->comm, "cannot write the options file %s: %s", sim->dump, strerror(error));
  PetscCall(PetscPrintf(sim->comm, "all options of this scene are in %s\n", sim->dump));
  PetscCall(PetscFree(kept));
  PetscFunctionReturn(PETSC_SUCCESS);
}
