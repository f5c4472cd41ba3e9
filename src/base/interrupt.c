/* Ends a run cleanly: a handler records the signals that would end the program, and the run checks for them and for
   -wall_clock_limit between steps and during long work. The limit counts from the start of the program. */
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

#define WATCHED          PETSC_STATIC_ARRAY_LENGTH(Watched)
#define SLOW             0.5 /* s between checks, from which on a signal is confirmed when it arrives */
#define MPIEXEC_PATIENCE "OMPI_MCA_odls_base_sigkill_timeout" /* s after which Open MPI's mpiexec kills the program */

static const char Confirmation[] = "isph: received a signal: the run ends with a checkpoint after this step\n";
static const char Warning[] =
  "isph: received a signal: the run ends with a checkpoint after this step; if mpiexec "
  "sent the signal, it kills the run a second later: start mpiexec with " MPIEXEC_PATIENCE "=600\n";

static volatile sig_atomic_t Signalled = 0; /* 1 + index in Watched of the first signal; 0: none */
static PetscBool             Ignored[WATCHED];
static struct timespec       Start;
static double                Limit      = 0;           /* s; 0: none */
static double                LastCheck  = 0;           /* time of the last InterruptCheck, s on the program's clock */
static double                CheckPause = 0;           /* time between the last two, s */
static PetscBool             Speaks     = PETSC_FALSE; /* this is rank 0, and it has called InterruptCheck */
static PetscBool             KilledSoon = PETSC_FALSE; /* mpiexec kills the program a second after a signal */

/* A signal handler calls this: stdio is not safe there. */
static void Confirm(void)
{
  if (!Speaks || PetscMax(CheckPause, ProgramSeconds() - LastCheck) < SLOW) return;
  if (write(STDERR_FILENO, KilledSoon ? Warning : Confirmation,
            KilledSoon ? sizeof(Warning) - 1 : sizeof(Confirmation) - 1) < 0)
    return;
}

static void Record(int number)
{
  const int error = errno;

  if (!Signalled && number != SIGPIPE) Confirm();
  for (size_t k = 0; k < WATCHED && !Signalled; k++)
    if (Watched[k].number == number) Signalled = (sig_atomic_t)(k + 1);
  /* The second signal ends the program at once, but each print into a closed pipe raises SIGPIPE again. */
  if (number != SIGPIPE) (void)signal(number, SIG_DFL);
  errno = error;
}

void InterruptWatch(void)
{
  struct sigaction action = {.sa_handler = Record, .sa_flags = SA_RESTART}; /* an interrupted write goes on */
  sigset_t         all;

  (void)sigemptyset(&all);
  for (size_t k = 0; k < WATCHED; k++) {
    if (Ignored[k])
      (void)signal(Watched[k].number, SIG_IGN);
    else
      (void)sigaction(Watched[k].number, &action, NULL);
    (void)sigaddset(&all, Watched[k].number);
  }
  (void)signal(SIGXFSZ, SIG_IGN); /* a write beyond the file-size limit then fails as on a full disk */
  (void)sigprocmask(SIG_UNBLOCK, &all, NULL);
}

void InterruptBlock(void)
{
  sigset_t all;

  (void)sigemptyset(&all);
  for (size_t k = 0; k < WATCHED; k++) (void)sigaddset(&all, Watched[k].number);
  (void)sigprocmask(SIG_BLOCK, &all, NULL);
}

void ProgramStart(void)
{
  (void)clock_gettime(CLOCK_MONOTONIC, &Start);
  KilledSoon = (PetscBool)(getenv("OMPI_COMM_WORLD_SIZE") && !getenv(MPIEXEC_PATIENCE));
  /* A file of the run must not get the descriptor of a closed standard stream. */
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
  CheckPause = now - LastCheck;
  LastCheck  = now;
  Speaks     = (PetscBool)!rank;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, what, 3, MPIU_INT, MPI_MAX, comm));
  if (wanted) *wanted = (PetscBool)(what[2] > 0);
  *reason = what[0] ? Watched[what[0] - 1].name : what[1] ? "-wall_clock_limit" : NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}
