/* The consistent scheme: all operators at the same positions, r^n with one neighbour search (-time_centered: r^n + v^n
   dt/2); kernel-corrected divergence, a relaxed density term that leaves the free surface alone, Nair-Tomar closure,
   shifting with velocity correction. Keeps the energy of an impact at three times the spacing the printed scheme needs.
 */
#include "stepper_impl.h"

PetscErrorCode SchemeConsistent(Stepper stepper, PetscReal dt, PetscBool diagnose, StepTrial *trial)
{
  PetscFunctionBegin;
  PetscCall(ConsistentStep(stepper, dt, diagnose, PressureProjected, trial));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureProjected(Stepper stepper, PetscReal dt, PressureResult *result)
{
  PetscFunctionBegin;
  PetscCall(PressureSolve(stepper->pressure, dt, result));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ConsistentStep(Stepper stepper, PetscReal dt, PetscBool diagnose, PressureStep pressure,
                              StepTrial *trial)
{
  Cloud           cloud = stepper->cloud;
  PetscReal      *r, *v, *new_r, *new_v, *a;
  PetscReal       drift = 0; /* largest displacement of the first half, m */
  PetscInt        touched;
  const PetscBool viscous = (PetscBool)(ViscosityIsExplicit(stepper) && stepper->viscosity_form == VISCOSITY_CLEARY &&
                                        OperatorsOneLiquid(stepper->cloud));

  PetscFunctionBegin;
  /* Stage 1: everything but pressure, at r^n or half a step later */
  PetscCall(CloudBegin(cloud, PETSC_FALSE));
  r = cloud->field[FIELD_POSITION];
  v = cloud->field[FIELD_VELOCITY];
  if (stepper->centered) { /* leapfrog: keeps the phase volume of an oscillation, which the kick at r^n multiplies by 1
                              + (w dt)^2/2 */
    for (PetscInt k = 0; k < cloud->n_fluid; k++) {
      for (PetscInt d = 0; d < DIM; d++) r[DIM * k + d] += 0.5 * dt * v[DIM * k + d];
      drift = PetscMax(drift, 0.5 * dt * Norm(v + DIM * k));
    }
    PetscCall(CloudMoved(cloud, PETSC_FALSE));
    r = cloud->field[FIELD_POSITION];
    v = cloud->field[FIELD_VELOCITY];
  }
  PetscCall(OperatorsMoments(cloud, viscous));
  PetscCall(OperatorsFreeSurface(cloud));
  PetscCall(Diagnose(stepper, diagnose, trial));
  if (PressureDensity(stepper->pressure) == cloud->field[FIELD_DENSITY]) PetscCall(CloudUpdate(cloud, FIELD_DENSITY));
  PetscCall(StageOne(stepper, dt, cloud->rest_density, viscous, trial));
  if (trial->viscous < 0) PetscFunctionReturn(PETSC_SUCCESS);

  /* Stage 2: pressure, at the same positions */
  if (stepper->shifting && !PressureTakesDivergence(stepper->pressure))
    PetscCall(OperatorsDivergence(cloud, cloud->field[FIELD_VELOCITY_STAR], PETSC_TRUE, 0, NULL));
  PetscCall(pressure(stepper, dt, &trial->pressure));
  if (trial->pressure.reason < 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PressureAcceleration(stepper->pressure));
  new_r = cloud->field[FIELD_START];
  new_v = cloud->field[FIELD_VELOCITY_STAR];
  a     = cloud->field[FIELD_WORK3];
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) {
    const PetscReal first = stepper->centered ? 0 : v[k]; /* the first half of Eq. (10) is done if centered */

    new_v[k] += dt * a[k];                           /* Eq. (9) */
    new_r[k] = r[k] + 0.5 * dt * (first + new_v[k]); /* Eq. (10) */
  }
  if (stepper->shifting)
    PetscCall(Shift(stepper, dt));
  else
    PetscCall(PetscArraycpy(v, new_v, DIM * cloud->n_fluid));

  /* Guard */
  PetscCall(WallGuard(cloud, stepper->guard * cloud->domain->spacing, new_r, v, &touched));
  for (PetscInt k = 0; k < cloud->n_fluid; k++) {
    PetscReal moved[DIM];

    for (PetscInt d = 0; d < DIM; d++) {
      moved[d]       = new_r[DIM * k + d] - r[DIM * k + d];
      r[DIM * k + d] = new_r[DIM * k + d];
    }
    trial->displacement = PetscMax(trial->displacement, drift + Norm(moved));
    if (!(Norm(moved) < PETSC_MAX_REAL)) trial->broken = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
