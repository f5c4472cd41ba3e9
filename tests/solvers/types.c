/* Prints the names of all solvers, preconditioners and matrices that this PETSc has, and the program's own: the lists
   that sweep.py goes through. */
#include "../../src/twolevel/twolevel.h"

static PetscErrorCode Print(const char title[], PetscFunctionList list)
{
  const char **names;
  int          count;

  PetscFunctionBegin;
  PetscCall(PetscFunctionListGet(list, &names, &count));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s:", title));
  for (int k = 0; k < count && names[k]; k++) /* PETSc counts the end too */
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s %s", k ? "," : "", names[k]));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "\n"));
  PetscCall(PetscFree(names));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(KSPInitializePackage());
  PetscCall(PCInitializePackage());
  PetscCall(MatInitializePackage());
  PetscCall(PCTwoLevelRegister());
  PetscCall(Print("ksp", KSPList));
  PetscCall(Print("pc", PCList));
  PetscCall(Print("mat", MatList));
  PetscCall(PetscFinalize());
  return 0;
}
