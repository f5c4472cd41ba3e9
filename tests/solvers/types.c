/* Prints the names of all solvers, preconditioners and matrices that this PETSc has, and the program's own: the lists
   that sweep.py goes through. */
#include "../../src/twolevel/twolevel.h"

static PetscErrorCode Print(const char title[], PetscFunctionList list)
{
  char names[NAMES_LENGTH];

  PetscFunctionBegin;
  PetscCall(ListNames(list, names));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s: %s\n", title, names));
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
