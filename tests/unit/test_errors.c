/* How the program says what went wrong, and what it prints. 'test_errors alone' on two ranks is the fault of one of
   them, for tests/faults/signals.py. */
#include "refuse.h"
#include <signal.h>

static PetscErrorCode Fails(void)
{
  PetscFunctionBegin;
  PetscCheck(PETSC_FALSE, PETSC_COMM_SELF, PETSC_ERR_PLIB, "seven\nand more");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Calls(PetscMPIInt failing)
{
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == failing) PetscCall(Fails());
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD)); /* without end where one rank has failed */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A print into what cannot be written is no error, and what follows is dropped. */
static PetscErrorCode TestPrinter(void)
{
  const int out = dup(STDOUT_FILENO);

  PetscFunctionBegin;
  PrinterStart();
  CHECK(!PrinterLost(), "standard output is there");
  fflush(stdout);
  CHECK(freopen("/dev/full", "w", stdout) != NULL, "a full device");
  RefuseBegin();
  PetscCall(PetscPrintf(PETSC_COMM_SELF, "nobody reads this %g\n", 1.));
  PetscCall(PetscViewerASCIIPrintf(PETSC_VIEWER_STDOUT_SELF, "nor that\n"));
  fflush(stderr);
  (void)dup2(refuse_stderr, STDERR_FILENO);
  (void)dup2(out, STDOUT_FILENO);
  CHECK(PrinterLost(), "standard output is lost and the program goes on");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestDuration(void)
{
  const double      seconds[] = {0, 59.6, 61, 3600, 7261};
  const char *const texts[]   = {"0 s", "1 min 00 s", "1 min 01 s", "1 h 00 min", "2 h 01 min"};
  char              text[64];
  PetscBool         same, all = PETSC_TRUE;

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(seconds); k++) {
    PetscCall(FormatDuration(seconds[k], text, sizeof(text)));
    PetscCall(PetscStrcmp(text, texts[k], &same));
    all = (PetscBool)(all && same);
  }
  CHECK(all, "durations");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Signals are noted by name, and so is the clock. */
static PetscErrorCode TestInterrupts(void)
{
  const char    *reason;
  PetscErrorCode code;
  PetscBool      same;

  PetscFunctionBegin;
  PetscCall(InterruptCheck(PETSC_COMM_WORLD, NULL, &reason));
  CHECK(!reason, "nothing asks for the end");
  InterruptLimit(1e-9);
  PetscCall(InterruptCheck(PETSC_COMM_WORLD, NULL, &reason));
  PetscCall(PetscStrcmp(reason, "-wall_clock_limit", &same));
  CHECK(same, "the clock asks for the end");
  InterruptLimit(0);
  (void)raise(SIGHUP);
  PetscCall(InterruptCheck(PETSC_COMM_WORLD, NULL, &reason));
  PetscCall(PetscStrcmp(reason, "SIGHUP", &same));
  CHECK(same, "a signal asks for the end");
  ProgressBegin("this test", "all of it is left");
  RefuseBegin();
  code = ProgressWork(PETSC_COMM_WORLD, 0.5, "half of it");
  RefuseEnd(code, "ended by SIGHUP during this test: all of it is left", "work ends at a signal");
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscErrorCode  code  = PETSC_SUCCESS;
  const PetscBool alone = (PetscBool)(argc > 1 && !strcmp(argv[1], "alone"));

  ProgramStart();
  if (MPI_Init(&argc, &argv) || UserErrorHandlerPush()) return 2;
  InterruptBlock();
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  InterruptWatch();
  if (alone) {
    code = Calls(1);
    (void)ErrorFinish(code);
  } else {
    PetscCall(TestDuration());
    PetscCall(TestInterrupts());
    PetscCall(TestPrinter());
    RefuseBegin();
    (void)Calls(0);
    (void)ErrorFinish(ISPH_USER_ERROR);
    RefuseEnd(ISPH_USER_ERROR, "\"seven\" (error 77 in Fails, line", "PETSc's error is one sentence with its calls");
  }
  PetscCall(PetscFinalize());
  (void)MPI_Finalize();
  return CHECK_DONE();
}
