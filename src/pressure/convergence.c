/* Residuals of the pressure equation as density errors, the solver's test, and the check of its claim. The residual of
   a row over its weight is a source that the projection leaves, in 1/s2. Times dt^2 this is the relative density error
   that the step leaves, which -pressure_density_tolerance bounds. */
#include "pressure_impl.h"

/* Measures of a residual r with the right-hand side b: |r|, |b|, and |diagonal x|, whose rounding is in r; as density
   errors (1): the largest, the root mean square, and the largest due to rounding. */
typedef struct {
  PetscReal norm, rhs, rounding, largest, rms, largest_rounding;
} ResidualSize;

/* Measures r, the residual of x. */
static PetscErrorCode Measure(Pressure pressure, Vec r, Vec x, ResidualSize *size)
{
  const Cloud        cloud = pressure->cloud;
  const PetscReal    dt2   = PetscSqr(pressure->dt);
  const PetscScalar *residual, *rhs, *value;
  PetscReal          most[2] = {0, 0}, sum[4] = {0, 0, 0, 0};

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(r, &residual));
  PetscCall(VecGetArrayRead(x, &value));
  PetscCall(VecGetArrayRead(pressure->solver.b, &rhs));
  for (PetscInt a = 0; a < cloud->n_rows; a++) {
    const PetscReal density  = dt2 / PressureRowWeight(pressure, a),
                    rounding = (pressure->pair_diagonal[a] + pressure->closure_diagonal[a]) * PetscAbsScalar(value[a]),
                    error    = density * PetscAbsScalar(residual[a]);

    most[0] = PetscMax(most[0], error);
    most[1] = PetscMax(most[1], density * rounding);
    sum[0] += PetscSqr(error);
    sum[1] += PetscSqr(PetscRealPart(residual[a]));
    sum[2] += PetscSqr(PetscRealPart(rhs[a]));
    sum[3] += PetscSqr(rounding);
  }
  PetscCall(VecRestoreArrayRead(pressure->solver.b, &rhs));
  PetscCall(VecRestoreArrayRead(x, &value));
  PetscCall(VecRestoreArrayRead(r, &residual));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, most, 2, MPIU_REAL, MPIU_MAX, cloud->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 4, MPIU_REAL, MPIU_SUM, cloud->comm));
  *size = (ResidualSize){.norm             = PetscSqrtReal(sum[1]),
                         .rhs              = PetscSqrtReal(sum[2]),
                         .rounding         = PetscSqrtReal(sum[3]),
                         .largest          = sum[1] == sum[1] ? most[0] : NAN, /* a maximum would drop nan */
                         .rms              = PetscSqrtReal(sum[0] / PetscMax(1, pressure->rows_global)),
                         .largest_rounding = most[1]};
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The 2-norm of the residual that -ksp_rtol and -ksp_atol ask for. */
static PetscErrorCode Asked(KSP ksp, PetscReal rhs, PetscReal *asked)
{
  PetscReal rtol, atol;

  PetscFunctionBegin;
  PetscCall(KSPGetTolerances(ksp, &rtol, &atol, NULL, NULL));
  *asked = PetscMax(rtol * rhs, atol);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ResidualMeasure(void *context, Vec r, SolverReport *report, PetscReal *rounding)
{
  Pressure     pressure = (Pressure)context;
  ResidualSize size;

  PetscFunctionBegin;
  PetscCall(Measure(pressure, r, pressure->solver.x, &size));
  if (pressure->density_tolerance > 0) {
    report->asked    = pressure->density_tolerance;
    report->claimed  = pressure->density_claimed;
    report->residual = size.largest;
    *rounding        = size.largest_rounding;
  } else {
    PetscCall(Asked(pressure->solver.ksp, size.rhs, &report->asked));
    PetscCall(KSPGetResidualNorm(pressure->solver.ksp, &report->claimed));
    report->residual = size.norm;
    *rounding        = size.rounding;
  }
  pressure->density_left = size.rms;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- the solver's test --- */

/* PETSc's own test, which ours calls first. */
typedef struct {
  Pressure pressure;
  PetscErrorCode (*test)(KSP, PetscInt, PetscReal, KSPConvergedReason *, void *);
  void *context;
  PetscErrorCode (*destroy)(void *);
} OwnTest;

/* Whether the 2-norm permits a density error that is small enough: the largest error is at least the mean. */
static PetscBool DensityNear(Pressure pressure, PetscReal norm)
{
  const Cloud cloud    = pressure->cloud;
  PetscReal   heaviest = 0; /* the largest weight of a row */

  for (PetscInt b = 0; b < SceneCount(cloud->scene); b++)
    heaviest =
      PetscMax(heaviest, RowWeight(pressure, cloud->volume_most, BodyMaterial(SceneBody(cloud->scene, b))->density));
  return (PetscBool) !(norm * PetscSqr(pressure->dt) >
                       pressure->density_tolerance * heaviest * PetscSqrtReal((PetscReal)pressure->rows_global));
}

/* PETSc's own test decides about failure. Success is a small density error if density_tolerance is set, else a small
   residual in the 2-norm. If the solver uses another norm, the residual is computed when that norm is small enough. */
static PetscErrorCode Converged(KSP ksp, PetscInt iteration, PetscReal norm, KSPConvergedReason *reason, void *context)
{
  OwnTest     *own      = (OwnTest *)context;
  Pressure     pressure = own->pressure;
  KSPNormType  type;
  ResidualSize size;
  PetscReal    asked = 0;
  Vec          r;

  PetscFunctionBegin;
  PetscCall(own->test(ksp, iteration, norm, reason, own->context));
  if (*reason < 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(KSPGetNormType(ksp, &type));
  if (pressure->density_tolerance > 0) {
    *reason = KSP_CONVERGED_ITERATING;
    if (type == KSP_NORM_UNPRECONDITIONED && !DensityNear(pressure, norm)) PetscFunctionReturn(PETSC_SUCCESS);
  } else if (*reason == KSP_CONVERGED_ITERATING || type == KSP_NORM_UNPRECONDITIONED || type == KSP_NORM_NONE)
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(KSPBuildResidual(ksp, pressure->solver.scratch[0], pressure->solver.scratch[1], &r));
  PetscCall(Measure(pressure, r, pressure->solver.x, &size));
  if (pressure->density_tolerance > 0) {
    pressure->density_claimed = size.largest;
    if (size.largest <= pressure->density_tolerance) *reason = KSP_CONVERGED_ATOL;
  } else {
    PetscCall(Asked(ksp, size.rhs, &asked));
    if (!(size.norm <= asked)) *reason = KSP_CONVERGED_ITERATING;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode OwnTestDestroy(void *context)
{
  OwnTest *own = (OwnTest *)context;

  PetscFunctionBegin;
  if (own->destroy) PetscCall(own->destroy(own->context));
  PetscCall(PetscFree(own));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SetConvergence(Pressure pressure)
{
  OwnTest *own;

  PetscFunctionBegin;
  PetscCall(PetscNew(&own));
  own->pressure = pressure;
  PetscCall(KSPGetAndClearConvergenceTest(pressure->solver.ksp, &own->test, &own->context, &own->destroy));
  PetscCall(KSPSetConvergenceTest(pressure->solver.ksp, Converged, own, OwnTestDestroy));
  PetscFunctionReturn(PETSC_SUCCESS);
}
