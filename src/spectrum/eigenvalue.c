/* One eigenvalue of a matrix, by SLEPc. */
#include "spectrum_impl.h"

#define SUBSPACE 40 /* dimension of the Krylov space */

/* A monitor of SLEPc: shows the progress. */
static PetscErrorCode ShowIteration(EPS eps, PetscInt iterations, PetscInt converged, PetscScalar *real,
                                    PetscScalar *imaginary, PetscReal *errors, PetscInt count, void *context)
{
  PetscFunctionBegin;
  PetscCall(
    ProgressWork(PetscObjectComm((PetscObject)eps), -1, "iteration %" PetscInt_FMT " of an eigenvalue", iterations));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SpectrumExtreme(Mat A, EPSProblemType type, EPSWhich which, PetscReal tolerance, Vec deflated,
                               PetscReal *value, PetscBool *found)
{
  EPS         eps;
  PetscInt    count, n;
  PetscScalar real, imaginary;

  PetscFunctionBegin;
  PetscCall(MatGetSize(A, &n, NULL));
  PetscCall(EPSCreate(PetscObjectComm((PetscObject)A), &eps));
  PetscCall(EPSSetOperators(eps, A, NULL));
  PetscCall(EPSSetProblemType(eps, type));
  PetscCall(EPSSetWhichEigenpairs(eps, which));
  PetscCall(EPSSetDimensions(eps, 1, PetscMin(SUBSPACE, n), PETSC_DEFAULT));
  PetscCall(EPSSetTolerances(eps, tolerance, PETSC_DEFAULT));
  if (deflated) PetscCall(EPSSetDeflationSpace(eps, 1, &deflated));
  PetscCall(EPSMonitorSet(eps, ShowIteration, NULL, NULL));
  PetscCall(EPSSetOptionsPrefix(eps, "spectrum_"));
  PetscCall(EPSSetFromOptions(eps));
  PetscCall(EPSSolve(eps));
  PetscCall(EPSGetConverged(eps, &count));
  *found = (PetscBool)(count > 0);
  *value = NAN;
  if (*found) {
    PetscCall(EPSGetEigenvalue(eps, 0, &real, &imaginary));
    *value = PetscRealPart(real);
  }
  PetscCall(EPSDestroy(&eps));
  PetscFunctionReturn(PETSC_SUCCESS);
}
