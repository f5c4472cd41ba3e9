/* Stage one of a step, and what is measured where it was evaluated: density, surface, divergence, work. */
#include "stepper_impl.h"

/* Sum of m v.u of the fluid for a field u, this rank: the power (W) of an acceleration; of FIELD_VELOCITY_STAR (J), the
   change of which is the work of an implicit force. */
static PetscReal MassWeightedDot(Cloud cloud, PetscInt field)
{
  const PetscReal *v = cloud->field[FIELD_VELOCITY], *u = cloud->field[field];
  PetscReal        sum = 0;

  for (PetscInt k = 0; k < cloud->n_fluid; k++)
    sum += cloud->volume[k] * cloud->rest_density[k] * Dot(v + DIM * k, u + DIM * k);
  return sum;
}

/* Area of the free surface of one particle's share, m2. The integral of |sum V grad W| over the liquid below a flat
   surface is half its area, for any kernel: sum V W rises from 1/2 at the surface to 1 inside. */
static PetscReal Area(Cloud cloud, PetscInt a)
{
  return cloud->integer[INT_SURFACE][a] ? 2 * cloud->volume[a] * Norm(cloud->field[FIELD_NORMAL] + DIM * a) : 0;
}

/* What the work of the pressure sigma kappa on the free surface, -int sigma kappa v.n dA, is made of. The flux of the
   liquid through its surface should vanish; what it does not is taken out in CheckTrial as if it were spread evenly,
   because the pressure that all of a drop has in common would do work on it. */
static void CapillaryWork(Cloud cloud, PetscReal dt, StepTrial *trial)
{
  const PetscReal *v = cloud->field[FIELD_VELOCITY], *n = cloud->field[FIELD_NORMAL],
                  *capillary = cloud->field[FIELD_CAPILLARY];

  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal area = Area(cloud, a), inward = 2 * cloud->volume[a] * dt * Dot(v + DIM * a, n + DIM * a);

    if (area == 0) continue;
    trial->tension_work += capillary[a] * inward;
    trial->inward += inward;
    trial->area += area;
    trial->capillary_area += capillary[a] * area;
  }
}

PetscBool ViscosityIsExplicit(Stepper stepper)
{
  return (PetscBool)(SceneHasViscosity(stepper->cloud->scene) && !stepper->viscous.implicit);
}

PetscErrorCode StageOne(Stepper stepper, PetscReal dt, const PetscReal density[], PetscBool viscous, StepTrial *trial)
{
  Cloud      cloud        = stepper->cloud;
  PetscReal *acceleration = cloud->field[FIELD_ACCELERATION], *v = cloud->field[FIELD_VELOCITY],
            *predicted = cloud->field[FIELD_VELOCITY_STAR];
  PetscReal before     = 0; /* power of what acts so far, W */

  PetscFunctionBegin;
  if (!viscous) PetscCall(PetscArrayzero(acceleration, DIM * cloud->n_owned));
  if (ViscosityIsExplicit(stepper)) {
    if (!viscous) PetscCall(OperatorsViscosity(cloud, stepper->viscosity_form, density));
    trial->viscous_work = dt * MassWeightedDot(cloud, FIELD_ACCELERATION);
  }
  if (stepper->damping == 1)
    for (PetscInt a = 0; a < cloud->n_fluid; a++) {
      PetscReal g[DIM];

      SceneAcceleration(cloud->scene, cloud->field[FIELD_POSITION] + DIM * a, g);
      for (PetscInt d = 0; d < DIM; d++) acceleration[DIM * a + d] += g[d];
    }
  if (TensionReach(stepper->tension) > 0) before = MassWeightedDot(cloud, FIELD_ACCELERATION);
  PetscCall(TensionApply(stepper->tension, cloud));
  if (TensionReach(stepper->tension) > 0) {
    trial->tension_work = dt * (MassWeightedDot(cloud, FIELD_ACCELERATION) - before);
    CapillaryWork(cloud, dt, trial);
  }
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) predicted[k] = stepper->damping * v[k] + dt * acceleration[k];
  for (PetscInt k = DIM * cloud->n_fluid; k < DIM * cloud->n_owned; k++) predicted[k] = v[k];
  if (stepper->viscous.implicit) {
    before = MassWeightedDot(cloud, FIELD_VELOCITY_STAR);
    PetscCall(ViscousSolve(stepper, dt, density, &trial->viscous));
    trial->viscous_work = MassWeightedDot(cloud, FIELD_VELOCITY_STAR) - before;
  } else
    PetscCall(CloudUpdate(cloud, FIELD_VELOCITY_STAR));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Diagnose(Stepper stepper, PetscBool divergence, StepTrial *trial)
{
  Cloud      cloud = stepper->cloud;
  PetscReal *div;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal ratio = cloud->field[FIELD_DENSITY][a] / cloud->rest_density[a];

    trial->density = PetscMax(trial->density, ratio);
    trial->surface += BodyMaterial(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]))->tension * Area(cloud, a);
    if (cloud->integer[INT_SURFACE][a]) continue;
    trial->error += ratio;
    trial->error2 += PetscSqr(ratio - 1);
    trial->inside++;
  }
  if (!divergence) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(cloud->n_owned, &div));
  PetscCall(OperatorsDivergence(cloud, cloud->field[FIELD_VELOCITY], PETSC_TRUE, 0, div));
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    if (!cloud->integer[INT_SURFACE][a]) trial->divergence2 += PetscSqr(div[a]);
  PetscCall(PetscFree(div));
  PetscFunctionReturn(PETSC_SUCCESS);
}
