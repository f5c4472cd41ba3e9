/* The surface of liquid that rests or flows slowly is calmed.

   The forces on the rows of the free surface are no gradient of an energy: a little of the disorder of their normals
   and depths becomes motion from particle to particle, which nothing takes away in a liquid of small viscosity, now
   that a balanced pressure (pressure/balance.c) has no viscosity of its own. So what the velocity of such a row differs
   from the linear flow around it decays,

     v_a += (1 - exp(-RATE w sqrt(f/s) dt)) sum_b K_ab (v_b - v_a - G_a (r_b - r_a))/sum_b K_ab,

   w the share of the body force f that is carried, s the spacing, G the velocity gradient, b the liquid around. Shear
   and waves of ten spacings and more are linear there. A tank at rest moves with 0.0010 in place of 0.0025 sqrt(gH)
   after a minute, and a layer that shears keeps the slope of its velocity.

   Under a surface that hangs, waves shorter than the kernel of the curvature are unstable (Rayleigh and Taylor): the
   tension that holds them in the world is smoothed away. They grow within 1/sqrt(f/s), until the surface is a row of
   drops of one particle, and the contact lines of a hanging drop creep. There what the lack of a row differs from the
   mean around it, in proportion to the fourth power of a wave's number, decays as well, with HANGING sqrt(f/s) times
   the cosine between f and the outward normal. Decay alone is too little: what is unstable then grows slowly. So a row
   out of line moves back, with LEVEL sqrt(f/s) times what its height differs from the rows of the surface around it,
   less the mean of theirs, which is curvature. They count by |sum V grad W|^2, so that none comes or goes at once.

   The lacks of rings within the support of the kernel of the axis decay, too, with sqrt(sigma/(rho s^3)). Such a ring
   and its image are one particle: the errors of both add up, and what is small across the axis is large along it. The
   poles of a drop at rest trembled forever, and those of a bubble that swings came apart within two periods. A third of
   RATE of the lack itself leaves two of eight bubbles so; RATE holds them, but a jet on the axis is 3 % late. */
#include "stepper_impl.h"

/* 0.1 to 1 give a tank at rest the same order; the period of a wave falls by 0.1 % at 0.3 and 1. */
#define RATE 0.3
/* 10 lets a hanging drop of 13 spacings creep, 60 and 100 hold its contact radius within 1 % (five packings) */
#define HANGING 60
#define AT_ONCE 0.5 /* the largest share of it in a step: with .9 it overshoots */
/* The surface of a hanging drop of 13 spacings has a roughness of 0.03 spacings, 0.13 without it; with 0.3 the same */
#define LEVEL  0.1
#define BESIDE -0.5 /* such cosines have rows beside one that hangs, on a drop of six spacings */

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

/* Whether tension acts on the axis of rings. */
static PetscBool HasAxis(Stepper stepper)
{
  return (PetscBool)(DomainNearAxis(stepper->cloud->domain, 0, 0) && TensionOnSurface(stepper->tension));
}

/* sqrt(sigma/(rho s^3)) (1/s) of a ring at the axis, else 0. */
static PetscReal AtAxis(Stepper stepper, PetscInt a)
{
  const Cloud     cloud = stepper->cloud;
  const PetscReal s     = cloud->size[a] * cloud->domain->spacing,
                  sigma = BodyMaterial(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]))->tension;

  if (!HasAxis(stepper) || !DomainNearAxis(cloud->domain, cloud->field[FIELD_POSITION][DIM * a],
                                           cloud->size[a] * KernelSupport(cloud->kernel)))
    return 0;
  return PetscSqrtReal(sigma / (cloud->rest_density[a] * s * s * s));
}

/* Whether the row of particle a may be calmed. */
static PetscBool IsCalmed(Stepper stepper, PetscInt a)
{
  const Cloud cloud = stepper->cloud;

  return (PetscBool)((PressureShare(stepper->pressure, a) > 0 || HasAxis(stepper)) &&
                     PressureCloses(stepper->pressure, a) && !CloudPushes(cloud, a) &&
                     cloud->field[FIELD_LAMBDA][a] > SPRAY_LAMBDA);
}

/* How far the surface of particle a hangs: the cosine between its outward normal and the force f (m/s2); f is set. */
static PetscReal Hangs(Cloud cloud, PetscInt a, PetscReal f[DIM])
{
  const PetscReal *n = cloud->field[FIELD_NORMAL] + DIM * a;
  PetscReal        length;

  SceneAcceleration(cloud->scene, cloud->field[FIELD_POSITION] + DIM * a, f);
  length = Norm(n) * Norm(f);
  return length > 0 ? -Dot(n, f) / length : 0;
}

/* What remains of the lacks of particle a without the mean of those around it. */
static void Rough(Cloud cloud, PetscInt a, const PetscReal lack[], PetscReal rough[DIM])
{
  PetscReal weight = 0, mean[DIM] = {0, 0, 0};

  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    const PetscInt  b = cloud->list[k];
    const PetscReal K = cloud->integer[INT_LAYER][b] ? 0 : cloud->laplacian[k];

    weight += K;
    for (PetscInt d = 0; d < DIM; d++) mean[d] += K * lack[DIM * b + d];
  }
  for (PetscInt d = 0; d < DIM; d++) rough[d] = lack[DIM * a + d] - (weight > 0 ? mean[d] / weight : 0);
}

/* The part along its normal of what a row a of the surface lacks to the mean of q ([n_total][3]) around it. */
static void SurfaceLack(Cloud cloud, PetscInt a, const PetscReal q[], PetscReal lack[DIM])
{
  const PetscReal *n      = cloud->field[FIELD_NORMAL] + DIM * a;
  PetscReal        weight = 0, along = 0;

  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1] && cloud->integer[INT_SURFACE][a] == 1; k++) {
    const PetscInt   b = cloud->list[k];
    const PetscReal *m = cloud->field[FIELD_NORMAL] + DIM * b,
                    K  = cloud->integer[INT_LAYER][b] ? 0 : cloud->laplacian[k] * Dot(m, m);

    weight += K;
    for (PetscInt d = 0; d < DIM; d++) along += K * (q[DIM * b + d] - q[DIM * a + d]) * n[d];
  }
  for (PetscInt d = 0; d < DIM; d++) lack[d] = weight * Dot(n, n) > 0 ? along / (weight * Dot(n, n)) * n[d] : 0;
}

PetscErrorCode StepCalm(Stepper stepper, PetscReal dt)
{
  const Cloud cloud = stepper->cloud;
  PetscReal  *v     = cloud->field[FIELD_VELOCITY_NEW], *lack, *low;

  PetscFunctionBegin;
  if (!PressureCarries(stepper->pressure) && !HasAxis(stepper)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CloudGetWork(cloud, DIM, &lack));
  PetscCall(CloudGetWork(cloud, DIM, &low));
  PetscCall(CloudUpdate(cloud, FIELD_VELOCITY_NEW));
  PetscCall(CloudUpdate(cloud, FIELD_NORMAL));
  PetscCall(PetscArrayzero(lack, DIM * cloud->n_total));
  PetscCall(PetscArrayzero(low, DIM * cloud->n_total));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal f[DIM];

    if (!IsCalmed(stepper, a)) continue;
    LinearLack(cloud, a, v, lack + DIM * a);
    if (Hangs(cloud, a, f) > BESIDE) SurfaceLack(cloud, a, cloud->field[FIELD_POSITION], low + DIM * a);
  }
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, lack));
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, low));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal f[DIM], rough[DIM], mean[DIM], rate, share, hangs, quick;

    if (!IsCalmed(stepper, a)) continue;
    hangs = PetscMax(0, Hangs(cloud, a, f));
    rate  = PressureShare(stepper->pressure, a) * PetscSqrtReal(Norm(f) / (cloud->size[a] * cloud->domain->spacing));
    share = 1 - PetscExpReal(-RATE * rate * dt);
    quick = PetscMin(AT_ONCE, 1 - PetscExpReal(-(HANGING * rate * hangs + AtAxis(stepper, a)) * dt));
    for (PetscInt d = 0; d < DIM; d++) v[DIM * a + d] += share * lack[DIM * a + d];
    if (quick <= 0) continue;
    Rough(cloud, a, lack, rough);
    for (PetscInt d = 0; d < DIM; d++) v[DIM * a + d] += quick * rough[d];
    if (hangs > 0) SurfaceLack(cloud, a, low, mean);
    for (PetscInt d = 0; d < DIM && hangs > 0; d++) v[DIM * a + d] -= quick * LEVEL * rate * mean[d];
  }
  PetscCall(CloudRestoreWork(cloud, &low));
  PetscCall(CloudRestoreWork(cloud, &lack));
  PetscFunctionReturn(PETSC_SUCCESS);
}
