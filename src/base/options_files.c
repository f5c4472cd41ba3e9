/* Options files that include themselves: PETSc follows them until the stack ends. */
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

PetscErrorCode OptionsFilesCheck(MPI_Comm comm, int argc, char *argv[])
{
  for (int k = 1; k + 1 < argc; k++)
    if (!strcmp(argv[k], KEY) && !Shallow(argv[k + 1], DEPTH_MAX))
      return UserError(comm, "the options file %s includes itself, or others more than %d deep", argv[k + 1],
                       DEPTH_MAX);
  return PETSC_SUCCESS;
}
