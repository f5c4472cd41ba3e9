/* All forces but the pressure, and their work. */
#include "stepper_impl.h"

/* Sum of m v.u of this rank's fluid for a field u: of an acceleration the power (W); of a velocity an energy (J), whose
   change is the work of an implicit force. */
static PetscReal MassWeightedDot(Cloud cloud, FieldId field)
{
  const PetscReal *v = cloud->field[FIELD_VELOCITY], *u = cloud->field[field];
  PetscReal        sum = 0;

  for (PetscInt k = 0; k < cloud->n_fluid; k++)
    sum += cloud->volume[k] * cloud->rest_density[k] * Dot(v + DIM * k, u + DIM * k);
  return sum;
}

/* The work (J) on this rank's fluid of a kick by FIELD_ACCELERATION: that at the mean of the velocities before and
   after it. In a flow from rest the velocity before has none of the motion that a wall brings in a step. */
static PetscReal KickWork(Cloud cloud, PetscReal dt)
{
  const PetscReal *v = cloud->field[FIELD_VELOCITY], *a = cloud->field[FIELD_ACCELERATION];
  PetscReal        sum = 0;

  for (PetscInt k = 0; k < cloud->n_fluid; k++)
    sum += cloud->volume[k] * cloud->rest_density[k] *
           (Dot(v + DIM * k, a + DIM * k) + 0.5 * dt * Dot(a + DIM * k, a + DIM * k));
  return dt * sum;
}

/* Adds the terms of the work of the pressure sigma kappa on the free surface, -int sigma kappa v.n dA. The net flux of
   the liquid through its surface is not exactly zero, and the mean pressure of a drop would do work on it. RecordStep
   subtracts this work, as if the net flux were spread evenly. v ([n_fluid][3], m/s): the velocity in the middle of the
   step. The velocity at its start lacks the motion by which this step's pressure smooths the surface; with it, drops
   gained up to three times the work that was counted. */
static void SumCapillaryWork(Cloud cloud, PetscReal dt, const PetscReal v[], StepTrial *trial)
{
  const PetscReal *n = cloud->field[FIELD_NORMAL], *capillary = cloud->field[FIELD_CAPILLARY];

  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal area   = OperatorsSurfaceArea(cloud, a, 0),
                    inflow = 2 * cloud->volume[a] * dt * Dot(v + DIM * a, n + DIM * a);
    PetscReal value;

    if (area == 0) continue;
    value = cloud->liquid ? capillary[a] - cloud->pressure_jump[a] : capillary[a]; /* edges have the rest */
    trial->sum[SUM_TENSION_WORK] += value * inflow;
    trial->sum[SUM_SURFACES] += inflow;
    trial->sum[SUM_SURFACES + 1] += area;
    trial->sum[SUM_SURFACES + 2] += value * area;
  }
}

void DriveWork(Cloud cloud, PetscReal time, StepTrial *trial)
{
  const PetscReal *v = cloud->field[FIELD_VELOCITY];
  PetscReal        drive[DIM];

  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    if (SceneDrive(cloud->scene, cloud->field[FIELD_POSITION] + DIM * a, drive))
      trial->sum[SUM_DRIVE_WORK] += time * cloud->volume[a] * cloud->rest_density[a] * Dot(v + DIM * a, drive);
}

PetscBool StepViscosityFused(Stepper stepper)
{
  return (PetscBool)(ViscosityIsExplicit(stepper) && stepper->viscosity.form == VISCOSITY_MOMENT &&
                     OperatorsOneLiquid(stepper->cloud));
}

PetscErrorCode StepApparentViscosity(Stepper stepper)
{
  PetscFunctionBegin;
  PetscCall(OperatorsApparentViscosity(stepper->cloud, &stepper->viscosity));
  StepHook(stepper, thicken, &step);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void AddBodyForce(Cloud cloud, PetscReal acceleration[])
{
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal g[DIM];

    SceneAcceleration(cloud->scene, cloud->field[FIELD_POSITION] + DIM * a, g);
    for (PetscInt d = 0; d < DIM; d++) acceleration[DIM * a + d] += g[d];
  }
}

PetscErrorCode StepTension(Stepper stepper, PetscReal dt)
{
  const Tension   tension = stepper->tension;
  const PetscReal other   = stepper->second ? stepper->now.usual : dt;
  const PetscBool pairs =
    (PetscBool)(dt > 0 && stepper->force_time == 0.5 && TensionPairs(tension) && dt + other <= stepper->bounds.tension);

  PetscFunctionBegin;
  StepHook(stepper, tense, &step);
  if (!pairs)
    PetscCall(TensionApply(tension, stepper->cloud));
  else if (stepper->second)
    PetscCall(TensionApplyKept(tension, stepper->cloud));
  else
    PetscCall(TensionApplyAhead(tension, stepper->cloud, 0.5 * dt));
  stepper->cloud->tension = NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds surface tension to FIELD_ACCELERATION, or sets the pressure on the free surface. */
static PetscErrorCode AddTension(Stepper stepper, PetscReal dt, StepTrial *trial)
{
  Cloud           cloud  = stepper->cloud;
  const PetscBool acts   = (PetscBool)(TensionReach(stepper->tension) > 0);
  const PetscReal before = acts ? MassWeightedDot(cloud, FIELD_ACCELERATION) : 0;

  PetscFunctionBegin;
  PetscCall(StepTension(stepper, dt));
  if (acts) trial->sum[SUM_TENSION_WORK] = dt * (MassWeightedDot(cloud, FIELD_ACCELERATION) - before);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepTensionWork(Stepper stepper, PetscReal dt, StepTrial *trial)
{
  Cloud            cloud = stepper->cloud;
  const PetscReal *v = cloud->field[FIELD_VELOCITY], *v_new = cloud->field[FIELD_VELOCITY_NEW];
  PetscReal       *mean;

  PetscFunctionBegin;
  if (TensionReach(stepper->tension) <= 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CloudGetWork(cloud, DIM, &mean));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) mean[k] = 0.5 * (v[k] + v_new[k]);
  SumCapillaryWork(cloud, dt, mean, trial);
  StepHook(stepper, work, &step, mean);
  PetscCall(CloudRestoreWork(cloud, &mean));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Implicit viscosity. It must balance the pressure. In a step in which momentum diffuses over more than a few spacings,
   viscosity without pressure lets the liquid swell or shrink. The projection removes this motion, and with it part of
   the resistance to stretching: hanging sheets stretched up to 1.3 times too fast, and liquid at rest crept. So the
   pressure of the former step acts during the solve, the incremental splitting of Goda (1979): a steady flow has no
   splitting error.

   Where viscosity alone makes the pressure, dt grad p/rho is many times the velocity of the flow. The projection is
   approximate: if it solves for the whole pressure, a divergence dt (L p - div grad p)/rho remains, L the operator of
   the equation, and the density of a stretching sheet fell by a tenth, until the sheet tore. So most of the former
   pressure stays in the velocity. The projection solves for the remaining share, which is as large as in a step of the
   explicit limit, and so is the divergence that it leaves. If all of the former pressure stayed, pressures without
   acceleration would add up. */
static PetscErrorCode SolveViscosity(Stepper stepper, PetscReal dt, const PetscReal density[], StepTrial *trial)
{
  Cloud           cloud  = stepper->cloud;
  PetscReal      *v_star = cloud->field[FIELD_VELOCITY_STAR], *kick;
  const PetscInt  n      = DIM * cloud->n_fluid;
  const PetscBool split  = PressureTakesDivergence(stepper->pressure);
  const PetscReal before = MassWeightedDot(cloud, FIELD_VELOCITY_STAR),
                  share  = stepper->keeps_pressure && split ? PetscMax(0, 1 - stepper->bounds.viscosity_flow / dt) : 0;

  PetscFunctionBegin;
  PetscCall(ViscousGetKeptKick(stepper, &kick));
  if (split) {
    PetscCall(PressureAcceleration(stepper->pressure, kick));
    for (PetscInt a = 0; a < cloud->n_fluid; a++) /* no pressure moves it */
      if (PressureHolds(stepper->pressure, a)) PetscCall(PetscArrayzero(kick + DIM * a, DIM));
    for (PetscInt k = 0; k < n; k++) v_star[k] += dt * kick[k];
  }
  PetscCall(ViscousSolve(stepper, dt, density, &trial->viscous));
  StepHook(stepper, drag, &step, v_star);
  if (split) ViscousRelease(stepper);
  if (split)
    for (PetscInt k = 0; k < n; k++) v_star[k] -= dt * kick[k];
  trial->sum[SUM_VISCOUS_WORK] = MassWeightedDot(cloud, FIELD_VELOCITY_STAR) - before;
  PetscCall(PressureSetKeptShare(stepper->pressure, share));
  for (PetscInt k = 0; k < n && share > 0; k++) {
    kick[k] *= share * dt;
    v_star[k] += kick[k];
  }
  if (split) PetscCall(CloudUpdate(cloud, FIELD_VELOCITY_STAR));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the Coriolis acceleration -2 W x (v + v')/2, v the velocity before and v' after the step, to
   FIELD_VELOCITY_STAR, which has all other forces: with t = W dt, v' + t x v' = v* - t x v. The pressure of the former
   step acts during this, as in SolveViscosity: the forces that it balances must not be rotated. */
static PetscErrorCode AddCoriolis(Stepper stepper, PetscReal dt)
{
  Cloud            cloud = stepper->cloud;
  const PetscReal *v     = cloud->field[FIELD_VELOCITY];
  PetscReal       *acceleration, t[DIM];

  PetscFunctionBegin;
  SceneFrameRate(cloud->scene, t);
  for (PetscInt d = 0; d < DIM; d++) t[d] *= dt;
  PetscCall(CloudGetWork(cloud, DIM, &acceleration));
  PetscCall(PressureAcceleration(stepper->pressure, acceleration));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal *v_star = cloud->field[FIELD_VELOCITY_STAR] + DIM * a, b[DIM], turned[DIM];

    Cross(t, v + DIM * a, turned);
    for (PetscInt d = 0; d < DIM; d++) b[d] = v_star[d] + dt * acceleration[DIM * a + d] - turned[d];
    Cross(t, b, turned);
    for (PetscInt d = 0; d < DIM; d++)
      v_star[d] = (b[d] - turned[d] + Dot(t, b) * t[d]) / (1 + Dot(t, t)) - dt * acceleration[DIM * a + d];
  }
  PetscCall(CloudRestoreWork(cloud, &acceleration));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepForces(Stepper stepper, PetscReal dt, const PetscReal density[], PetscBool fused, StepTrial *trial)
{
  Cloud            cloud        = stepper->cloud;
  PetscReal       *acceleration = cloud->field[FIELD_ACCELERATION], *v_star = cloud->field[FIELD_VELOCITY_STAR];
  const PetscReal *v = cloud->field[FIELD_VELOCITY];

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_FORCES), 0, 0, 0, 0));
  PetscCall(StepApparentViscosity(stepper));
  PetscCall(PressureSetKeptShare(stepper->pressure, 0));
  if (stepper->keeps_pressure && !stepper->relaxing) PetscCall(PressurePredict(stepper->pressure));
  if (!fused) PetscCall(PetscArrayzero(acceleration, DIM * cloud->n_owned));
  if (ViscosityIsExplicit(stepper)) {
    if (!fused) PetscCall(OperatorsViscosity(cloud, &stepper->viscosity, density));
    trial->sum[SUM_VISCOUS_WORK] = KickWork(cloud, dt);
  }
  DriveWork(cloud, 0.5 * dt, trial); /* StepGuard adds the other half, with the velocity at the end of the step */
  if (!stepper->relaxing) {
    AddBodyForce(cloud, acceleration);
    StepHook(stepper, force, &step);
  }
  PressureTakeCarried(stepper->pressure, acceleration);
  PetscCall(AddTension(stepper, dt, trial));
  StepHook(stepper, surround, &step);
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) v_star[k] = stepper->now.damping * v[k] + dt * acceleration[k];
  if (SceneFrameTurns(cloud->scene) && !stepper->relaxing) PetscCall(AddCoriolis(stepper, dt));
  PetscCall(
    PetscArraycpy(v_star + DIM * cloud->n_fluid, v + DIM * cloud->n_fluid, DIM * (cloud->n_owned - cloud->n_fluid)));
  if (ViscosityIsExplicit(stepper)) StepHook(stepper, drag, &step, v);
  if (stepper->viscous.implicit)
    PetscCall(SolveViscosity(stepper, dt, density, trial));
  else
    PetscCall(CloudUpdate(cloud, FIELD_VELOCITY_STAR));
  StepHook(stepper, predict, &step);
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_FORCES), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
