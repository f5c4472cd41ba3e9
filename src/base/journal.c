/* Standard output, and the journal: a file with the output and the error message of a run. PETSc prints through the
   pointer PetscVFPrintf; the function here writes both and survives the loss of standard output. */
#include "base.h"
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define TEXT_LENGTH 8192    /* bytes of one print; a longer text is allocated */
#define BUFFER_MAX  1048576 /* bytes */

static FILE     *journal   = NULL;
static PetscBool buffering = PETSC_TRUE; /* output is buffered until the journal is open */
static char     *buffer    = NULL;
static PetscBool lost      = PETSC_FALSE; /* standard output has failed */
static PetscBool silent    = PETSC_FALSE; /* PrinterQuiet */
static PetscBool open_line = PETSC_FALSE; /* the last line is one of progress, which the next one overwrites */

/* Drops a text that does not fit. */
static void Buffer(const char text[])
{
  const size_t used = buffer ? strlen(buffer) : 0, length = strlen(text);
  char        *longer = used + length < BUFFER_MAX ? realloc(buffer, used + length + 1) : NULL;

  if (!longer) return;
  memcpy(longer + used, text, length + 1);
  buffer = longer;
}

static void StopBuffering(void)
{
  free(buffer);
  buffer    = NULL;
  buffering = PETSC_FALSE;
}

void JournalText(const char text[])
{
  const size_t skip = text[0] == '\r';

  if (skip && !strchr(text, '\n')) return; /* a line of progress, which the next one overwrites */
  if (buffering) Buffer(text + skip);
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

/* When standard output fails it is redirected to /dev/null, since PETSc treats a failed print as an error. */
static void Write(FILE *stream, const char text[])
{
  PetscBool failed;

  if (silent) {
    JournalText(text);
    return;
  }
  if (text[0] != '\r') PrinterBreak();
  if (stream == stdout) open_line = (PetscBool)(text[0] == '\r' && !strchr(text, '\n'));
  failed = (PetscBool)(fputs(text, stream) < 0 || fflush(stream));

  if (stream == stdout || stream == stderr) JournalText(text);
  if (!failed || stream != stdout || lost) return;
  if (errno != EPIPE) /* a closed pipe: its reader has ended on purpose */
    fprintf(stderr, "isph: standard output failed (%s); further output is dropped\n", strerror(errno));
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

void PrinterQuiet(PetscBool quiet)
{
  static PetscErrorCode (*before)(FILE *, const char[], va_list) = NULL;

  if (quiet) before = PetscVFPrintf;
  if (quiet && !journal) buffering = PETSC_TRUE;
  PetscVFPrintf = quiet ? Print : before;
  silent        = quiet;
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
    journal = fopen(path, "a"); /* a run goes on without its journal */
    if (gmtime_r(&now, &moment)) strftime(date, sizeof(date), "%Y-%m-%d %H:%M:%S UTC", &moment);
    if (journal) fprintf(journal, "=== isph %s, %s\n%s", ISPH_VERSION, date, buffer ? buffer : "");
  }
  StopBuffering();
  PetscFunctionReturn(PETSC_SUCCESS);
}

int JournalFile(void)
{
  return journal ? fileno(journal) : -1;
}

PetscErrorCode JournalClose(void)
{
  PetscFunctionBegin;
  StopBuffering();
  if (!journal) PetscFunctionReturn(PETSC_SUCCESS);
  fclose(journal);
  journal = NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}
