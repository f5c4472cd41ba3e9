/* The scheme of Kuri et al. as printed: Eqs. (1), (2), then Eqs. (8)-(11) at r^F. */
#include "stepper_impl.h"

PetscErrorCode SchemeDensityInvariant(Stepper stepper, PetscReal dt, PetscBool diagnose, StepTrial *trial)
{
  Cloud      cloud = stepper->cloud;
  PetscReal *r, *v, *start, *predicted, *a;
  PetscInt   touched;

  PetscFunctionBegin;
  /* Stage 1: everything but pressure, Eqs. (1), (2), (4)-(7), at r^n */
  PetscCall(CloudBegin(cloud, PETSC_FALSE));
  PetscCall(OperatorsMoments(cloud, PETSC_FALSE)); /* Eq. (4) */
  PetscCall(CloudUpdate(cloud, FIELD_DENSITY));
  if (TensionReach(stepper->tension) > 0) PetscCall(OperatorsFreeSurface(cloud));
  PetscCall(StageOne(stepper, dt, cloud->field[FIELD_DENSITY], PETSC_FALSE, trial));
  if (trial->viscous < 0) PetscFunctionReturn(PETSC_SUCCESS);
  r         = cloud->field[FIELD_POSITION];
  start     = cloud->field[FIELD_START];
  predicted = cloud->field[FIELD_VELOCITY_STAR];
  PetscCall(PetscArraycpy(start, r, DIM * cloud->n_owned));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) r[k] += dt * predicted[k]; /* Eq. (2) */

  /* Stage 2: pressure restores rho_0, Eqs. (8)-(11), at r^F */
  PetscCall(CloudMoved(cloud, PETSC_FALSE));
  PetscCall(OperatorsMoments(cloud, PETSC_FALSE));
  PetscCall(CloudUpdate(cloud, FIELD_DENSITY));
  PetscCall(OperatorsFreeSurface(cloud));
  PetscCall(Diagnose(stepper, diagnose, trial));
  PetscCall(PressureSolve(stepper->pressure, dt, &trial->pressure));
  if (trial->pressure.reason < 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PressureAcceleration(stepper->pressure));
  r         = cloud->field[FIELD_POSITION]; /* new ghosts may have moved the arrays */
  v         = cloud->field[FIELD_VELOCITY];
  start     = cloud->field[FIELD_START];
  predicted = cloud->field[FIELD_VELOCITY_STAR];
  a         = cloud->field[FIELD_WORK3];
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) {
    const PetscReal velocity = predicted[k] + dt * a[k]; /* Eq. (9) */

    r[k] = start[k] + 0.5 * dt * (v[k] + velocity); /* Eq. (10) */
    v[k] = velocity;
  }

  /* Guard */
  PetscCall(WallGuard(cloud, stepper->guard * cloud->domain->spacing, r, v, &touched));
  for (PetscInt k = 0; k < cloud->n_fluid; k++) {
    const PetscReal moved[DIM] = {r[3 * k] - start[3 * k], r[3 * k + 1] - start[3 * k + 1],
                                  r[3 * k + 2] - start[3 * k + 2]};

    trial->displacement = PetscMax(trial->displacement, Norm(moved));
    if (!(Norm(moved) < PETSC_MAX_REAL)) trial->broken = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
