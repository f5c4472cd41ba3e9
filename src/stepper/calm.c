/* The surface of liquid that rests or flows slowly is calmed.

   The forces on the rows of the free surface are no gradient of an energy: a little of the disorder of their normals
   and depths becomes motion from particle to particle, which nothing takes away in a liquid of small viscosity, now
   that a balanced pressure (pressure/balance.c) has no viscosity of its own. So what the velocity of such a row differs
   from the linear flow around it decays,

     v_a += (1 - exp(-RATE w sqrt(f/s) dt)) sum_b K_ab (v_b - v_a - G_a (r_b - r_a))/sum_b K_ab,

   w the share of the body force f that is carried, s the spacing, G the velocity gradient, b the liquid around. Shear
   and waves of ten spacings and more are linear there. A tank at rest moves with 0.0010 in place of 0.0025 sqrt(gH)
   after a minute, and a layer that shears keeps the slope of its velocity. */
#include "stepper_impl.h"

#define RATE 0.3 /* 0.1 to 1 give a tank at rest the same order; the period of a wave falls by 0.1 % at 0.3 and 1 */

/* What the velocity v ([n_total][3], m/s) of particle a lacks to the linear flow around it. */
static void LinearLack(Cloud cloud, PetscInt a, const PetscReal v[], PetscReal lack[DIM])
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *G = cloud->field[FIELD_VELOCITY_GRADIENT] + DIM * DIM * a;
  PetscReal        weight = 0, away[DIM] = {0, 0, 0}, along[DIM];

  for (PetscInt d = 0; d < DIM; d++) lack[d] = 0;
  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    const PetscInt  b = cloud->list[k];
    const PetscReal K = cloud->laplacian[k];

    if (cloud->integer[INT_LAYER][b]) continue;
    weight += K;
    for (PetscInt d = 0; d < DIM; d++) {
      lack[d] += K * (v[DIM * b + d] - v[DIM * a + d]);
      away[d] += K * (x[DIM * b + d] - x[DIM * a + d]);
    }
  }
  TensorApply(cloud->field[FIELD_CORRECTION] + 6 * a, away[0], away[1], away[2], along);
  for (PetscInt d = 0; d < DIM; d++) lack[d] = weight > 0 ? (lack[d] - Dot(G + DIM * d, along)) / weight : 0;
}

PetscErrorCode StepCalm(Stepper stepper, PetscReal dt)
{
  const Cloud      cloud = stepper->cloud;
  const PetscReal *w     = cloud->field[FIELD_CARRIED];
  PetscReal       *v     = cloud->field[FIELD_VELOCITY_NEW], *before;

  PetscFunctionBegin;
  if (!PressureCarries(stepper->pressure)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CloudGetWork(cloud, DIM, &before));
  PetscCall(PetscArraycpy(before, v, DIM * cloud->n_fluid));
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, before));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal g[DIM], lack[DIM], share;

    if (w[a] == 0 || !PressureCloses(stepper->pressure, a) || CloudPushes(cloud, a) ||
        cloud->field[FIELD_LAMBDA][a] <= SPRAY_LAMBDA)
      continue;
    SceneAcceleration(cloud->scene, cloud->field[FIELD_POSITION] + DIM * a, g);
    share = 1 - PetscExpReal(-RATE * w[a] * dt * PetscSqrtReal(Norm(g) / (cloud->size[a] * cloud->domain->spacing)));
    LinearLack(cloud, a, before, lack);
    for (PetscInt d = 0; d < DIM; d++) v[DIM * a + d] += share * lack[d];
  }
  PetscCall(CloudRestoreWork(cloud, &before));
  PetscFunctionReturn(PETSC_SUCCESS);
}
