/* The sub-steps of the schemes. */
#include "stepper_impl.h"

PetscErrorCode StepDrift(Stepper stepper, PetscReal dt, StepTrial *trial)
{
  Cloud            cloud = stepper->cloud;
  PetscReal       *r     = cloud->field[FIELD_POSITION];
  const PetscReal *v = cloud->field[FIELD_VELOCITY], time = stepper->now.time;
  PetscBool        moved = PETSC_FALSE;

  PetscFunctionBegin;
  trial->largest[LARGEST_DISPLACEMENT] = 0.5 * dt * stepper->fastest;
  if (StepTooFar(stepper, trial)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_DRIFT), 0, 0, 0, 0));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) r[k] += 0.5 * dt * v[k];
  StepHook(stepper, drift, &step, time, time + 0.5 * dt, time + dt, &moved);
  PetscCall(CloudMoved(cloud));
  if (moved) PetscCall(CloudUpdate(cloud, FIELD_VELOCITY));
  if (moved) PetscCall(CloudFindSolidNormals(cloud));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_DRIFT), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepSearch(Stepper stepper, PetscBool viscous)
{
  Cloud cloud = stepper->cloud;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_SEARCH), 0, 0, 0, 0));
  PetscCall(OperatorsMoments(cloud, viscous ? &stepper->viscosity : NULL)); /* Eq. (4) */
  PetscCall(CloudUpdate(cloud, FIELD_DENSITY));
  if (viscous) PetscCall(OperatorsViscosityRemainder(cloud, &stepper->viscosity));
  PetscCall(OperatorsFreeSurface(cloud));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_SEARCH), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepDivergence(Stepper stepper, PetscReal time_offset)
{
  Cloud cloud = stepper->cloud;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_DIVERGENCE), 0, 0, 0, 0));
  PetscCall(OperatorsDivergence(cloud, cloud->field[FIELD_VELOCITY_STAR], PETSC_TRUE, time_offset,
                                cloud->field[FIELD_DIVERGENCE], cloud->field[FIELD_VELOCITY_GRADIENT],
                                cloud->field[FIELD_VELOCITY_JUMP]));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_DIVERGENCE), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepProject(Stepper stepper, PetscReal dt, PressureResult *result)
{
  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_PROJECT), 0, 0, 0, 0));
  PetscCall(PressureSolve(stepper->pressure, dt, result));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_PROJECT), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepKick(Stepper stepper, PetscReal dt, StepTrial *trial)
{
  Cloud            cloud  = stepper->cloud;
  PetscReal       *v_star = cloud->field[FIELD_VELOCITY_STAR];
  const PetscReal *kept   = stepper->viscous.kept_kick;
  PetscReal       *v      = cloud->field[FIELD_VELOCITY_NEW], *a;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_KICK), 0, 0, 0, 0));
  if (PressureKeptShare(stepper->pressure) > 0)
    for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) v_star[k] -= kept[k];
  PetscCall(CloudGetWork(cloud, DIM, &a));
  PetscCall(PressureAcceleration(stepper->pressure, a));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) v[k] = v_star[k] + dt * a[k]; /* Eq. (9) */
  PressureKeepCarried(stepper->pressure, a);
  PetscCall(CloudRestoreWork(cloud, &a));
  PetscCall(StepTensionWork(stepper, dt, trial));
  StepHook(stepper, kick, &step);
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_KICK), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepDriftOn(Stepper stepper, PetscReal dt, const PetscReal from[], PetscBool half_done)
{
  Cloud            cloud = stepper->cloud;
  const PetscReal *v = cloud->field[FIELD_VELOCITY], *v_new = cloud->field[FIELD_VELOCITY_NEW];
  PetscReal       *r = cloud->field[FIELD_POSITION_NEW];

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_DRIFT), 0, 0, 0, 0));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++)
    r[k] = from[k] + 0.5 * dt * ((half_done ? 0 : v[k]) + v_new[k]); /* Eq. (10) */
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_DRIFT), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepGuard(Stepper stepper, PetscReal dt, const PetscReal from[], StepTrial *trial)
{
  Cloud           cloud = stepper->cloud;
  PetscReal      *r_new = cloud->field[FIELD_POSITION_NEW], *v_new = cloud->field[FIELD_VELOCITY_NEW], largest = 0;
  const PetscReal end   = stepper->now.time + dt;
  PetscBool       moved = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_GUARD), 0, 0, 0, 0));
  StepHook(stepper, drift, &step, stepper->now.time + 0.5 * dt, end, end, &moved);
  PetscCall(WallGuard(stepper, stepper->guard * cloud->domain->spacing, r_new, v_new));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal step[DIM] = {r_new[3 * a] - from[3 * a], r_new[3 * a + 1] - from[3 * a + 1],
                                 r_new[3 * a + 2] - from[3 * a + 2]};

    largest = PetscMax(largest, Norm(step) / cloud->size[a]);
    if (!(Norm(step) + Norm(v_new + DIM * a) < PETSC_MAX_REAL)) trial->largest[LARGEST_BROKEN] = 1;
  }
  trial->largest[LARGEST_DISPLACEMENT] += largest;
  PetscCall(PetscArraycpy(cloud->field[FIELD_POSITION], r_new, DIM * cloud->n_fluid));
  PetscCall(PetscArraycpy(cloud->field[FIELD_VELOCITY], v_new, DIM * cloud->n_fluid));
  DriveWork(cloud, 0.5 * dt, trial);
  StepHook(stepper, guard, &step);
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_GUARD), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
