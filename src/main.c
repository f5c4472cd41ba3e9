static char help[] = "isph: incompressible smoothed particle hydrodynamics on PETSc.\n"
                     "  ./isph [-ranks N] cases/drop_impact/case.opts [options/quick.opts ...] [-name value ...]\n"
                     "Later options win over earlier ones.\n\n";

#include "sim/sim.h"

static PetscErrorCode Run(void)
{
  Sim       sim;
  PetscBool stop;

  PetscFunctionBegin;
  PetscCall(LogRegister());
  PetscCall(SimCreate(PETSC_COMM_WORLD, &sim));
  PetscCall(SimSetFromOptions(sim, &stop));
  if (!stop) {
    PetscCall(SimSetUp(sim));
    PetscCall(SimView(sim, PETSC_VIEWER_STDOUT_WORLD));
    if (SimIsDry(sim))
      PetscCall(SimDryRun(sim));
    else
      PetscCall(SimRun(sim));
  }
  PetscCall(SimDestroy(&sim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* PetscInitialize sets handlers of signals, of which none may end the program without a word. */
static PetscErrorCode Initialize(int *argc, char ***argv)
{
  PetscErrorCode code;

  InterruptBlock();
  code = PetscInitialize(argc, argv, NULL, help);
  InterruptWatch();
  return code;
}

int main(int argc, char **argv)
{
  PetscErrorCode code;
  PetscBool      stop;
  int            result;

  ProgramStart();
  result = RanksLaunch(argc, argv);
  if (result >= 0) return result;
  if (MPI_Init(&argc, &argv) || UserErrorHandlerPush())
    return 2; /* before the options are read: a missing options file is the user's error too */
  PrinterStart();
  code = CommandLineCheck(MPI_COMM_WORLD, &argc, &argv, &stop);
  if (!code && !stop) code = Initialize(&argc, &argv);
  if (!code && !stop) code = Run();
  result = ErrorFinish(code);
  if (PetscInitializeCalled) (void)PetscFinalize();
  (void)MPI_Finalize();
  return result;
}
