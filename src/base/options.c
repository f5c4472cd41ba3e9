/* What the command line asks: options files that include themselves, which PETSc follows until the stack ends; plain
   arguments; and help. */
#include "base.h"
#include <stdio.h>
#include <string.h>

#define DEPTH_MAX   32 /* files within files */
#define LINE_LENGTH 8192
#define KEY         "-options_file"
#define BLANKS      " \t\r\n\"'"

/* Whether the file and those it names are nested less deep than 'left'. */
static PetscBool Shallow(const char file[], int left)
{
  FILE     *text = fopen(file, "r");
  char      line[LINE_LENGTH];
  PetscBool good = (PetscBool)(left > 0);

  if (!text) return good; /* PETSc refuses it */
  while (good && fgets(line, sizeof(line), text)) {
    char *word = strtok(line, BLANKS);

    if (word && !strcmp(word, KEY) && (word = strtok(NULL, BLANKS))) good = Shallow(word, left - 1);
  }
  (void)fclose(text);
  return good;
}

PetscErrorCode CommandLineCheck(MPI_Comm comm, int argc, char *argv[])
{
  static char help[] = "-help";

  for (int k = 1; k < argc; k++) {
    if (!strcmp(argv[k], "-h") || !strcmp(argv[k], "--help")) argv[k] = help;
    if (argv[k][0] != '-' && argv[k - 1][0] != '-')
      return UserError(comm, "%s is not the value of an option; did you mean -options_file %s?", argv[k], argv[k]);
    if (!strcmp(argv[k], KEY) && k + 1 < argc && !Shallow(argv[k + 1], DEPTH_MAX))
      return UserError(comm, "the options file %s includes itself, or others more than %d deep", argv[k + 1],
                       DEPTH_MAX);
  }
  return PETSC_SUCCESS;
}

PetscBool HelpWanted(void)
{
  PetscBool help = PETSC_FALSE, dump = PETSC_FALSE;

  (void)PetscOptionsHasHelp(NULL, &help);
  (void)PetscOptionsHasName(NULL, NULL, DUMP_OPTION, &dump);
  return (PetscBool)(help && !dump);
}

PetscErrorCode ReadTypeOptions(PetscFunctionList list, const char chosen[], TypeReader reader, void *object)
{
  const char **types;
  int          count;

  PetscFunctionBegin;
  if (HelpWanted()) {
    PetscCall(PetscFunctionListGet(list, &types, &count));
    for (int k = 0; k < count && types[k]; k++) PetscCall(reader(object, types[k])); /* PETSc counts the end too */
    PetscCall(PetscFree(types));
  }
  PetscCall(reader(object, chosen));
  PetscFunctionReturn(PETSC_SUCCESS);
}
