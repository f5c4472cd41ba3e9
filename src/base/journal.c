/* What goes to standard output: it may be lost without harm, and with the sentence of an error it is also kept in a
   file, the journal of a run. PETSc prints through a function pointer; here that function does both. */
#include "base.h"
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define TEXT_LENGTH 8192    /* of one print, bytes; what is longer takes memory of its own */
#define EARLY_MOST  1048576 /* bytes kept for a journal that is not open yet */

static FILE     *journal   = NULL;
static PetscBool early     = PETSC_TRUE; /* no journal has been open yet: what is printed is kept for it */
static char     *kept      = NULL;
static PetscBool lost      = PETSC_FALSE; /* standard output */
static PetscBool open_line = PETSC_FALSE; /* the next line of progress overwrites the last one */

/* What is printed before the journal is open; what is too much for it, or for the memory, is left out. */
static void Keep(const char text[])
{
  const size_t used = kept ? strlen(kept) : 0, length = strlen(text);
  char        *longer = used + length < EARLY_MOST ? realloc(kept, used + length + 1) : NULL;

  if (!longer) return;
  memcpy(longer + used, text, length + 1);
  kept = longer;
}

static void KeepNoMore(void)
{
  free(kept);
  kept  = NULL;
  early = PETSC_FALSE;
}

void JournalText(const char text[])
{
  const size_t skip = text[0] == '\r';

  if (skip && !strchr(text, '\n')) return; /* a line that the terminal overwrites */
  if (early) Keep(text + skip);
  if (!journal) return;
  fputs(text + skip, journal);
  if (strchr(text, '\n')) fflush(journal);
}

PetscBool PrinterLost(void)
{
  return lost;
}

void PrinterBreak(void)
{
  if (!open_line) return;
  fputs("\n", stdout);
  fflush(stdout);
  open_line = PETSC_FALSE;
}

/* Standard output that cannot be written becomes one that can: PETSc takes a print that fails for an error. */
static void Write(FILE *stream, const char text[])
{
  PetscBool failed;

  if (text[0] != '\r') PrinterBreak();
  if (stream == stdout) open_line = (PetscBool)(text[0] == '\r' && !strchr(text, '\n'));
  failed = (PetscBool)(fputs(text, stream) < 0 || fflush(stream));

  if (stream == stdout || stream == stderr) JournalText(text);
  if (!failed || stream != stdout || lost) return;
  if (errno != EPIPE) /* a reader that has gone away knows */
    fprintf(stderr, "isph: standard output is gone (%s); what would be printed is dropped\n", strerror(errno));
  lost = (PetscBool)(freopen("/dev/null", "w", stdout) != NULL);
}

static PetscErrorCode Print(FILE *stream, const char format[], va_list arguments)
{
  char    text[TEXT_LENGTH], *longer;
  size_t  length;
  va_list copy;

  PetscFunctionBegin;
  va_copy(copy, arguments);
  PetscCall(PetscVSNPrintf(text, sizeof(text), format, &length, arguments));
  longer = length > sizeof(text) ? malloc(length + 1) : NULL;
  if (longer) PetscCall(PetscVSNPrintf(longer, length + 1, format, &length, copy));
  va_end(copy);
  Write(stream, longer ? longer : text);
  free(longer);
  PetscFunctionReturn(PETSC_SUCCESS);
}

void PrinterStart(void)
{
  PetscVFPrintf = Print;
}

PetscErrorCode JournalOpen(MPI_Comm comm, const char path[])
{
  char        date[64] = "";
  time_t      now      = time(NULL);
  struct tm   moment;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (!rank && !journal) {
    journal = fopen(path, "a"); /* a run does not fail for want of its journal */
    if (gmtime_r(&now, &moment)) strftime(date, sizeof(date), "%Y-%m-%d %H:%M:%S UTC", &moment);
    if (journal) fprintf(journal, "=== isph %s, %s\n%s", ISPH_VERSION, date, kept ? kept : "");
  }
  KeepNoMore();
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode JournalClose(void)
{
  PetscFunctionBegin;
  KeepNoMore();
  if (!journal) PetscFunctionReturn(PETSC_SUCCESS);
  fclose(journal);
  journal = NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}
