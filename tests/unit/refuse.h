/* Checks that bad input is refused with one line on standard error: isph: error: <sentence>. */
#ifndef ISPH_REFUSE_H
#define ISPH_REFUSE_H

#include "../../src/base/base.h"
#include "check.h"
#include <string.h>
#include <unistd.h>

static FILE *refuse_file;
static int   refuse_stderr;

/* RefuseBegin, RefuseEnd - what standard error gets between the two goes to a file. */
static inline void RefuseBegin(void)
{
  fflush(stderr);
  refuse_file   = tmpfile();
  refuse_stderr = dup(STDERR_FILENO);
  (void)dup2(fileno(refuse_file), STDERR_FILENO);
}

/* The code must be that of UserError; rank 0 must have printed one line that holds 'word', the others nothing. */
static inline void RefuseEnd(PetscErrorCode code, const char word[], const char name[])
{
  char        text[4096] = "";
  PetscMPIInt rank       = 0;
  size_t      length;
  int         good;

  fflush(stderr);
  (void)dup2(refuse_stderr, STDERR_FILENO);
  close(refuse_stderr);
  rewind(refuse_file);
  length       = fread(text, 1, sizeof(text) - 1, refuse_file);
  text[length] = 0;
  fclose(refuse_file);
  (void)MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  good = code == ISPH_USER_ERROR;
  if (rank)
    good = good && !length;
  else
    good = good && !strncmp(text, "isph: error: ", 13) && strchr(text, '\n') == text + length - 1 && strstr(text, word);
  CHECK(good, name);
  if (!good) printf("  code %d, standard error: %s\n", (int)code, text);
}

#endif
