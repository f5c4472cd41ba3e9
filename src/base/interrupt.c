/* Ends a run cleanly: signals that end a program are noted, to be asked for between steps and in long work, and so is
   -wall_clock_limit, which counts from the start of the program. */
#include "base.h"
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

static const struct {
  int         number;
  const char *name;
} Watched[] = {{SIGHUP, "SIGHUP"},   {SIGINT, "SIGINT"},   {SIGQUIT, "SIGQUIT"}, {SIGPIPE, "SIGPIPE"},
               {SIGTERM, "SIGTERM"}, {SIGUSR1, "SIGUSR1"}, {SIGXCPU, "SIGXCPU"}};

#define WATCHED PETSC_STATIC_ARRAY_LENGTH(Watched)
#define SLOW    0.5 /* s: a signal that may wait so long for its answer is confirmed at once */
#define PATIENT "OMPI_MCA_odls_base_sigkill_timeout" /* s that Open MPI's mpiexec waits before it kills */

static const char Confirmed[] = "isph: a signal came: the run ends with a checkpoint when this step is done\n";
static const char Hurried[]   = "isph: a signal came: the run ends with a checkpoint when this step is done; if it was "
                                "mpiexec's, that kills it a second later: start mpiexec with " PATIENT "=600\n";

static volatile sig_atomic_t Signalled = 0; /* the first signal that came, its place in the table and 1 */
static PetscBool             Ignored[WATCHED];
static struct timespec       Start;
static double                Limit = 0; /* s; 0: none */
static double                Asked = 0; /* s, on the program's clock: when InterruptCheck was called last, and ... */
static double                Pause = 0; /* ... how long after the time before */
static PetscBool             First = PETSC_FALSE; /* this is the rank that speaks, and it has begun its work */
static PetscBool             Hasty = PETSC_FALSE; /* what started the program kills it a second after a signal */

/* May be called in a handler of signals, so it prints without stdio. */
static void Confirm(void)
{
  if (!First || PetscMax(Pause, ProgramSeconds() - Asked) < SLOW) return;
  if (write(STDERR_FILENO, Hasty ? Hurried : Confirmed, Hasty ? sizeof(Hurried) - 1 : sizeof(Confirmed) - 1) < 0)
    return;
}

static void Note(int number)
{
  const int error = errno;

  if (!Signalled && number != SIGPIPE) Confirm();
  for (size_t k = 0; k < WATCHED && !Signalled; k++)
    if (Watched[k].number == number) Signalled = (sig_atomic_t)(k + 1);
  /* a second one ends the program at once; but each print into a closed pipe brings another SIGPIPE */
  if (number != SIGPIPE) (void)signal(number, SIG_DFL);
  errno = error;
}

void InterruptWatch(void)
{
  struct sigaction action = {.sa_handler = Note, .sa_flags = SA_RESTART}; /* half a write is not the end of it */
  sigset_t         all;

  (void)sigemptyset(&all);
  for (size_t k = 0; k < WATCHED; k++) {
    if (Ignored[k])
      (void)signal(Watched[k].number, SIG_IGN);
    else
      (void)sigaction(Watched[k].number, &action, NULL);
    (void)sigaddset(&all, Watched[k].number);
  }
  (void)signal(SIGXFSZ, SIG_IGN); /* a write beyond the user's limit fails like one on a full disk */
  (void)sigprocmask(SIG_UNBLOCK, &all, NULL);
}

void InterruptHold(void)
{
  sigset_t all;

  (void)sigemptyset(&all);
  for (size_t k = 0; k < WATCHED; k++) (void)sigaddset(&all, Watched[k].number);
  (void)sigprocmask(SIG_BLOCK, &all, NULL);
}

void ProgramStart(void)
{
  (void)clock_gettime(CLOCK_MONOTONIC, &Start);
  Hasty = (PetscBool)(getenv("OMPI_COMM_WORLD_SIZE") && !getenv(PATIENT));
  /* A standard stream that is closed must not become the number of a file of the run. */
  for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++)
    if (fcntl(fd, F_GETFD) < 0 && errno == EBADF) (void)open("/dev/null", fd == STDIN_FILENO ? O_RDONLY : O_WRONLY);
  for (size_t k = 0; k < WATCHED; k++) {
    struct sigaction before;

    Ignored[k] = (PetscBool)(!sigaction(Watched[k].number, NULL, &before) && before.sa_handler == SIG_IGN);
  }
  InterruptWatch();
}

double ProgramSeconds(void)
{
  struct timespec now;

  (void)clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)(now.tv_sec - Start.tv_sec) + 1e-9 * (double)(now.tv_nsec - Start.tv_nsec);
}

void InterruptLimit(double seconds)
{
  Limit = seconds;
}

PetscErrorCode InterruptCheck(MPI_Comm comm, PetscBool *wanted, const char **reason)
{
  const double now     = ProgramSeconds();
  PetscInt     what[3] = {Signalled, Limit > 0 && now > Limit, wanted && *wanted};
  PetscMPIInt  rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  Pause = now - Asked;
  Asked = now;
  First = (PetscBool)!rank;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, what, 3, MPIU_INT, MPI_MAX, comm));
  if (wanted) *wanted = (PetscBool)(what[2] > 0);
  *reason = what[0] ? Watched[what[0] - 1].name : what[1] ? "-wall_clock_limit" : NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}
