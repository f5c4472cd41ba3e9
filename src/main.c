static char help[] =
  "isph: incompressible smoothed particle hydrodynamics on PETSc.\n"
  "  ./isph -options_file cases/drop_impact/case.opts [-options_file options/quick.opts ...] [-name value ...]\n"
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

int main(int argc, char **argv)
{
  int code;

  if (MPI_Init(&argc, &argv) || UserErrorHandlerPush())
    return 2; /* before the options are read: a missing options file is the user's error too */
  code = (int)CommandLineCheck(MPI_COMM_WORLD, argc, argv);
  if (!code) code = (int)PetscInitialize(&argc, &argv, NULL, help);
  if (!code) {
    code = (int)Run();
    (void)PetscFinalize();
  }
  (void)MPI_Finalize();
  return code ? 1 : 0;
}
