/* When the solver may stop. The residual of a row over its mass is a source that the projection leaves, in 1/s2; times
   dt^2 it is the relative density error that the step leaves there. -pressure_density_tolerance bounds it. */
#include "pressure_impl.h"

typedef struct {
  Pressure pressure;
  void    *standard; /* of KSPConvergedDefault */
} Context;

/* b - A x of the finished solve, or of the present iterate. CG keeps this vector; for other methods it is computed. */
static PetscErrorCode Residual(Pressure pressure, PetscBool finished, Vec *residual)
{
  PetscBool cg;
  Mat       A;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2; k++)
    if (!pressure->scratch[k]) PetscCall(VecDuplicate(pressure->b, &pressure->scratch[k]));
  PetscCall(PetscObjectTypeCompare((PetscObject)pressure->ksp, KSPCG, &cg));
  if (cg || !finished)
    PetscCall(KSPBuildResidual(pressure->ksp, pressure->scratch[0], pressure->scratch[1], residual));
  else {
    PetscCall(KSPGetOperators(pressure->ksp, &A, NULL));
    PetscCall(MatMult(A, pressure->x, pressure->scratch[1]));
    PetscCall(VecAYPX(pressure->scratch[1], -1, pressure->b));
    *residual = pressure->scratch[1];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ResidualDensity(Pressure pressure, PetscBool finished, PetscReal *largest, PetscReal *rms)
{
  Cloud              cloud = pressure->cloud;
  const PetscReal    dt2   = PetscSqr(pressure->dt);
  const PetscScalar *r;
  PetscReal          most = 0, sum = 0;
  Vec                residual;

  PetscFunctionBegin;
  PetscCall(Residual(pressure, finished, &residual));
  PetscCall(VecGetArrayRead(residual, &r));
  for (PetscInt a = 0; a < cloud->n_rows; a++) {
    const PetscReal error =
      dt2 * PetscAbsScalar(r[a]) / (cloud->volume[a] * cloud->rest_density[a] * pressure->row_scale);

    most = PetscMax(most, error);
    sum += PetscSqr(error);
  }
  PetscCall(VecRestoreArrayRead(residual, &r));
  PetscCallMPI(MPI_Allreduce(&most, largest, 1, MPIU_REAL, MPIU_MAX, cloud->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPIU_REAL, MPIU_SUM, cloud->comm));
  *rms = PetscSqrtReal(sum / PetscMax(1, pressure->rows_global));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The solver has failed if PETSc's own test says so, and converged if the largest density error is below the tolerance.
   The largest error is at least the root mean square, which follows from the norm at no cost: while that is too large,
   the residual itself is not looked at. */
static PetscErrorCode Converged(KSP ksp, PetscInt iteration, PetscReal norm, KSPConvergedReason *reason, void *context)
{
  Context    *c        = (Context *)context;
  Pressure    pressure = c->pressure;
  KSPNormType type;
  PetscReal   largest, rms;

  PetscFunctionBegin;
  PetscCall(KSPConvergedDefault(ksp, iteration, norm, reason, c->standard));
  if (*reason < 0) PetscFunctionReturn(PETSC_SUCCESS);
  *reason = KSP_CONVERGED_ITERATING;
  PetscCall(KSPGetNormType(ksp, &type));
  if (type == KSP_NORM_UNPRECONDITIONED) {
    const Cloud cloud    = pressure->cloud;
    PetscReal   heaviest = 0; /* largest mass of a row, over that of the first body's */

    for (PetscInt b = 0; b < SceneCount(cloud->scene); b++)
      heaviest = PetscMax(heaviest, BodyMaterial(SceneBody(cloud->scene, b))->density);
    heaviest *= cloud->domain->volume * pressure->row_scale;
    if (norm * PetscSqr(pressure->dt) >
        pressure->density_tolerance * heaviest * PetscSqrtReal((PetscReal)pressure->rows_global))
      PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ResidualDensity(pressure, PETSC_FALSE, &largest, &rms));
  if (largest <= pressure->density_tolerance) *reason = KSP_CONVERGED_ATOL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ContextDestroy(void *context)
{
  Context *c = (Context *)context;

  PetscFunctionBegin;
  PetscCall(KSPConvergedDefaultDestroy(c->standard));
  PetscCall(PetscFree(c));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SetDensityConvergence(Pressure pressure)
{
  Context *c;

  PetscFunctionBegin;
  PetscCall(PetscNew(&c));
  c->pressure = pressure;
  PetscCall(KSPConvergedDefaultCreate(&c->standard));
  PetscCall(KSPSetConvergenceTest(pressure->ksp, Converged, c, ContextDestroy));
  PetscFunctionReturn(PETSC_SUCCESS);
}
