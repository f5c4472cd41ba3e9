/* Evens a packing out before the start. Lattices are displaced at random (-packing_jitter), and solids and surfaces cut
   them. In the first steps of a run two terms would even the particles out, and their motion has a pressure that is not
   the scene's:

   - The background pressure of the corrected gradient (pressure/gradient.c) drives displaced particles back within
     sqrt(d0/g). The projection does not know this force, and what divergence it makes is seen a step later: liquid at
     rest sinks for some milliseconds, and the force on the floor of a tank is 0.41 to 1.23 of the weight.
   - Density defects e are removed within T = 5 h/U, U of the scene, whatever the viscosity: heavy balls rise in syrup.

   So both act on positions alone, without velocities and body forces:

     dr = -s h^2 (sum V grad W + c sum V 0.2 (W/W(d0))^4 grad W) - f grad phi,   lap phi = e

   s: SPREAD, c: PAIRING, f: SHARE. On and near the free surface the sums act along it alone, and e is left to the
   run. Solids stand still, and so does what emitters hold. A quarter of the jitter remains, in long waves: enough that
   lattices do not buckle where they are stretched. */
#include "stepper_impl.h"

#define ITERATIONS 20   /* cost what 6 steps of an impact do */
#define SPREAD     0.35 /* over h^2; 0.6 is unstable with the default kernel, in two and three dimensions */
#define USUAL      1.3  /* h over the spacing, of that kernel */
#define SHARE      0.3  /* of the density defects, that an iteration removes */
#define PAIRING    0.5  /* weight of the term against pairing, as in pressure/gradient.c for liquid at rest */
#define CAP        0.1  /* spacings, largest displacement in an iteration */

/* What the sums are multiplied by (m2), for particles of size 1. The sums of displaced particles grow with V/h^dim. */
static PetscReal Spreading(Cloud cloud)
{
  const PetscReal h = KernelSmoothingLength(cloud->kernel), ratio = h / (USUAL * cloud->domain->spacing);

  return SPREAD * h * h * PetscMin(1, PetscPowRealInt(ratio, cloud->domain->dim));
}

/* Adds the displacement (m) of particle a that spreads it and its neighbours evenly. */
static void Spread(Cloud cloud, PetscInt a, PetscReal spreading, PetscReal dr[DIM])
{
  const PetscReal *n = cloud->field[FIELD_NORMAL] + DIM * a, *crowding = cloud->field[FIELD_CROWDING] + DIM * a;
  const PetscReal  n2 = Dot(n, n);
  PetscReal        way[DIM], along;

  for (PetscInt d = 0; d < DIM; d++)
    way[d] = -spreading * PetscSqr(cloud->size[a]) * (n[d] + PAIRING * (crowding[d] - n[d]));
  along = cloud->integer[INT_SURFACE][a] && n2 > 0 ? Dot(way, n) / n2 : 0;
  for (PetscInt d = 0; d < DIM; d++) dr[d] += way[d] - along * n[d];
}

/* The displacements dr ([n_owned][3], m) that remove SHARE of the density defects inside: those of a step from rest
   whose divergence is the defects' over its length. */
static PetscErrorCode RemoveDefects(Stepper stepper, PetscReal dr[])
{
  const Cloud     cloud = stepper->cloud;
  const PetscReal T = PressureRelaxationTime(stepper->pressure), dt = T > 0 ? T : 1; /* any */
  PressureResult  result;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(cloud->field[FIELD_CAPILLARY], cloud->n_owned));
  PetscCall(PetscArrayzero(cloud->field[FIELD_CAPILLARY_SLOPE], DIM * cloud->n_owned));
  PetscCall(PetscArrayzero(cloud->field[FIELD_DIVERGENCE], cloud->n_owned));
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    if (!cloud->integer[INT_SURFACE][a])
      cloud->field[FIELD_DIVERGENCE][a] = SHARE / dt * PressureDensityDefect(stepper->pressure, a);
  PetscCall(PressureSetKeptShare(stepper->pressure, 0));
  PressureSetRepair(stepper->pressure, 0);
  PetscCall(PressureSolve(stepper->pressure, dt, &result));
  PetscCall(PressureAcceleration(stepper->pressure, dr));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) dr[k] *= dt * dt;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One iteration, from the swarm's state to a new one. */
static PetscErrorCode Even(Stepper stepper)
{
  const Cloud     cloud     = stepper->cloud;
  const PetscReal spreading = Spreading(cloud);
  PetscReal      *dr, *x;
  PetscInt        lost = 0;

  PetscFunctionBegin;
  PetscCall(CloudBegin(cloud));
  PetscCall(StepSearch(stepper, PETSC_FALSE));
  StepHook(stepper, surround, &step);
  PetscCall(CloudGetWork(cloud, DIM, &dr));
  PetscCall(RemoveDefects(stepper, dr));
  x = cloud->field[FIELD_POSITION_NEW];
  PetscCall(PetscArraycpy(x, cloud->field[FIELD_POSITION], DIM * cloud->n_fluid));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal most = CAP * cloud->size[a] * cloud->domain->spacing;
    PetscReal       length;

    if (cloud->field[FIELD_LAMBDA][a] <= SPRAY_LAMBDA || PressureHolds(stepper->pressure, a)) continue;
    Spread(cloud, a, spreading, dr + DIM * a);
    length = Norm(dr + DIM * a);
    for (PetscInt d = 0; d < DIM; d++) x[DIM * a + d] += dr[DIM * a + d] * (length > most ? most / length : 1);
  }
  PetscCall(CloudRestoreWork(cloud, &dr));
  PetscCall(PetscArrayzero(cloud->field[FIELD_VELOCITY_NEW], DIM * cloud->n_fluid)); /* no momentum for free bodies */
  PetscCall(WallGuard(stepper, stepper->guard * cloud->domain->spacing, x, cloud->field[FIELD_VELOCITY_NEW]));
  PetscCall(PetscArraycpy(cloud->field[FIELD_POSITION], x, DIM * cloud->n_fluid));
  PetscCall(CloudCommit(cloud, &lost, NULL));
  PetscCheckUser(
    lost == 0, cloud->comm,
    "%" PetscInt_FMT
    " particles left the box while the packing was evened out; give the bodies more room to the open faces",
    lost);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool StepperSettles(Stepper stepper)
{
  return (PetscBool)(PressureTakesDivergence(stepper->pressure) && PressureGradientCorrected(stepper->pressure));
}

PetscErrorCode StepperSettle(Stepper stepper)
{
  PetscFunctionBegin;
  if (!StepperSettles(stepper)) PetscFunctionReturn(PETSC_SUCCESS);
  StepHook(stepper, freeze, &step, PETSC_TRUE);
  ProgressBegin("the settling of the packing", "no step of the run was computed");
  for (PetscInt k = 0; k < ITERATIONS; k++) {
    PetscCall(ProgressWork(stepper->cloud->comm, (PetscReal)k / ITERATIONS, "iteration %" PetscInt_FMT, k));
    PetscCall(Even(stepper));
    if (k == 0) PetscCall(PressureReset(stepper->pressure)); /* its preconditioner is the lattice's, and poor */
  }
  StepHook(stepper, freeze, &step, PETSC_FALSE);
  PetscFunctionReturn(PETSC_SUCCESS);
}
