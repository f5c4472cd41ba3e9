/* Lines of progress of the steps and of other long work. On a terminal each line overwrites the one before; in a file
   the lines become rarer. */
#include "base.h"
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define LASTING_SHARE 0.02 /* of the time of the work: least time between two lines that are not overwritten */
#define SILENCE_MAX   10   /* s: largest value of that time in a file */
#define LINE_LENGTH   256
#define ESTIMATE_MAX  1e8 /* s: a longer remaining time is not printed */

static struct {
  const char *what, *outcome;                    /* of ProgressBegin */
  double      interval, began, printed, lasting; /* s; on the program's clock: start, last line, last lasting line */
  PetscBool   open;                              /* the next line overwrites the last one */
} Work = {"the set-up", "no step was computed", 2, 0, 0, 0, PETSC_FALSE};

void ProgressInterval(double seconds)
{
  Work.interval = seconds;
}

PetscErrorCode FormatDuration(double seconds, char text[], size_t length)
{
  const PetscInt64 whole = (PetscInt64)PetscMin(seconds + 0.5, 1e15);

  PetscFunctionBegin;
  if (whole >= 3600)
    PetscCall(PetscSNPrintf(text, length, "%" PetscInt64_FMT " h %02d min", whole / 3600, (int)(whole / 60 % 60)));
  else if (whole >= 60)
    PetscCall(PetscSNPrintf(text, length, "%d min %02d s", (int)(whole / 60), (int)(whole % 60)));
  else
    PetscCall(PetscSNPrintf(text, length, "%d s", (int)whole));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void ProgressBegin(const char what[], const char outcome[])
{
  Work.what    = what;
  Work.outcome = outcome;
  Work.began   = ProgramSeconds();
  InterruptAlive(what);
}

PetscErrorCode ProgressDue(MPI_Comm comm, PetscBool last, PetscBool *due)
{
  const double    now      = ProgramSeconds();
  const PetscBool terminal = (PetscBool)isatty(STDOUT_FILENO);
  double          rare     = LASTING_SHARE * (now - Work.began);
  PetscMPIInt     what[2];

  PetscFunctionBegin;
  if (!terminal) rare = PetscMin(rare, SILENCE_MAX);
  what[1] = last || now - Work.lasting >= PetscMax(Work.interval, rare);
  what[0] = Work.interval > 0 && (last || now - Work.printed >= Work.interval) && (terminal || what[1]);
  PetscCallMPI(MPI_Bcast(what, 2, MPI_INT, 0, comm)); /* clocks differ between ranks */
  *due = what[0] ? PETSC_TRUE : PETSC_FALSE;
  if (!what[0]) PetscFunctionReturn(PETSC_SUCCESS);
  Work.open    = (PetscBool)(terminal && !what[1]);
  Work.printed = now;
  if (what[1]) Work.lasting = now;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ProgressPrint(MPI_Comm comm, PetscReal share, const char format[], ...)
{
  const double to_go = (ProgramSeconds() - Work.began) * (1 / PetscMax((double)share, 1e-30) - 1);
  char         text[LINE_LENGTH], left[64] = "";
  va_list      arguments;

  PetscFunctionBegin;
  va_start(arguments, format);
  (void)vsnprintf(text, sizeof(text), format, arguments);
  va_end(arguments);
  PetscCall(FormatDuration(to_go, left, sizeof(left)));
  if (share >= 0) (void)snprintf(text + strlen(text), sizeof(text) - strlen(text), "  %3d %%", (int)(100 * share));
  if (share >= 0 && to_go < ESTIMATE_MAX)
    (void)snprintf(text + strlen(text), sizeof(text) - strlen(text), "  to go %s", left);
  PetscCall(PetscPrintf(comm, "%s%s%s", isatty(STDOUT_FILENO) ? "\r" : "", text, Work.open ? "   " : "\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ProgressWork(MPI_Comm comm, PetscReal share, const char format[], ...)
{
  const char *reason;
  char        text[LINE_LENGTH];
  PetscBool   due;
  va_list     arguments;

  PetscFunctionBegin;
  PetscCall(InterruptCheck(comm, NULL, &reason));
  PetscCheckUser(!reason, comm, "ended by %s during %s: %s", reason, Work.what, Work.outcome);
  PetscCall(ProgressDue(comm, PETSC_FALSE, &due));
  if (!due) PetscFunctionReturn(PETSC_SUCCESS);
  va_start(arguments, format);
  (void)vsnprintf(text, sizeof(text), format, arguments);
  va_end(arguments);
  PetscCall(ProgressPrint(comm, share, "%s: %s", Work.what, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}
