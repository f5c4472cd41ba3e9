/* The journal of a run: what goes to standard output, and the sentence of an error, in a file as well. PETSc prints
   through a function pointer; here that function writes twice. */
#include "base.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define TEXT_LENGTH 8192 /* of one print, bytes; what is longer is cut in the journal */

static FILE *journal = NULL;
static PetscErrorCode (*printer)(FILE *, const char[], va_list); /* PETSc's own */

void JournalText(const char text[])
{
  if (!journal || (text[0] == '\r' && !strchr(text, '\n'))) return; /* a line that the terminal overwrites */
  fputs(text + (text[0] == '\r'), journal);
  if (strchr(text, '\n')) fflush(journal);
}

static PetscErrorCode Both(FILE *stream, const char format[], va_list arguments)
{
  char    text[TEXT_LENGTH];
  size_t  length;
  va_list copy;

  PetscFunctionBegin;
  if (stream == PETSC_STDOUT && journal) {
    va_copy(copy, arguments);
    PetscCall(PetscVSNPrintf(text, sizeof(text), format, &length, copy));
    va_end(copy);
    JournalText(text);
  }
  PetscCall((*printer)(stream, format, arguments));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode JournalOpen(MPI_Comm comm, const char path[])
{
  char        date[64] = "";
  time_t      now      = time(NULL);
  struct tm   moment;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank || journal) PetscFunctionReturn(PETSC_SUCCESS);
  journal = fopen(path, "a"); /* a run does not fail for want of its journal */
  if (!journal) PetscFunctionReturn(PETSC_SUCCESS);
  printer       = PetscVFPrintf;
  PetscVFPrintf = Both;
  if (gmtime_r(&now, &moment)) strftime(date, sizeof(date), "%Y-%m-%d %H:%M:%S UTC", &moment);
  fprintf(journal, "=== isph %s, %s\n", ISPH_VERSION, date);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode JournalClose(void)
{
  PetscFunctionBegin;
  if (!journal) PetscFunctionReturn(PETSC_SUCCESS);
  PetscVFPrintf = printer;
  fclose(journal);
  journal = NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}
