/* Ends a run cleanly: at SIGINT, SIGTERM or SIGUSR1, and when -wall_clock_limit is used up. A file that grows beyond
   the user's limit fails like one on a full disk. */
#include "sim_impl.h"
#include <petsctime.h>
#include <signal.h>

static volatile sig_atomic_t signalled = 0;

static void Note(int number)
{
  signalled = number;
  (void)signal(number, SIG_DFL); /* a second one ends the program at once */
}

PetscErrorCode InterruptWatch(void)
{
  const int        numbers[] = {SIGINT, SIGTERM, SIGUSR1};
  struct sigaction action    = {.sa_handler = Note};

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(numbers); k++)
    PetscCheck(!sigaction(numbers[k], &action, NULL), PETSC_COMM_SELF, PETSC_ERR_SYS, "cannot watch for signal %d",
               numbers[k]);
  (void)signal(SIGXFSZ, SIG_IGN); /* the write then returns EFBIG */
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode InterruptCheck(Sim sim, const Progress *progress, const char **reason)
{
  PetscInt what[2] = {signalled != 0, 0}; /* a signal, the end of the time */
  double   now;

  PetscFunctionBegin;
  PetscCall(PetscTime(&now));
  what[1] = sim->wall_clock_limit > 0 && now - progress->started > sim->wall_clock_limit;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, what, 2, MPIU_INT, MPI_MAX, sim->comm));
  *reason = what[0] ? "a signal" : what[1] ? "-wall_clock_limit" : NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}
