/* Particle shifting. Plain: each particle is shifted by itself, in one pass. Conserved (-shifting_conserved): the
   neighbours of a particle lose what it gains, so that centre of mass, momentum and angular momentum are conserved; in
   the drop impact at 0.5 mm this costs about 5 % of the kinetic energy at 5 ms. */
#include "../neighbors/pairs.h"
#include "shifting.h"

#define CAP      0.1 /* spacings, of a shift in a step; with 0.05 a dam break's column is 2.7 % of 2 a off, not 2.3 % */
#define STRENGTH 2   /* A of Skillen et al. 2013 */

/* Shortens dr along the normal n (1) of a wall, which is 'gap' (m) away from where the guard keeps particles: that far
   it may lead to the wall. */
static void ShortenAt(PetscReal gap, const PetscReal n[DIM], PetscReal dr[DIM])
{
  const PetscReal beyond = PetscMin(0, Dot(dr, n) + PetscMax(0, gap));

  for (PetscInt d = 0; d < DIM; d++) dr[d] -= beyond * n[d];
}

/* Takes from the shift dr of particle a what the guard would take back. It left the particle where it was but with the
   Taylor term of the velocity: a particle at a floor, with liquid on one side alone, went faster in each step. */
static void ShortenAtWalls(Cloud cloud, PetscReal guard, PetscInt a, PetscReal dr[DIM])
{
  const Domain     domain = cloud->domain;
  const PetscReal *x = cloud->field[FIELD_POSITION_NEW] + DIM * a, least = guard * domain->spacing;

  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt side = 0; side < 2; side++) {
      const PetscReal at     = side ? domain->upper[d] : domain->lower[d];
      PetscReal       n[DIM] = {0, 0, 0};

      if (domain->face[d][side] != FACE_WALL) continue;
      n[d] = side ? -1 : 1;
      ShortenAt(n[d] * (x[d] - at) - least * cloud->size[a], n, dr);
    }
  if (SceneSolidCount(cloud->scene)) {
    const PetscReal reach = least + Norm(dr), distance = SceneSolidWithin(cloud->scene, reach, x, NULL);
    PetscReal       n[DIM];

    if (distance >= reach) return;
    SceneSolidNormal(cloud->scene, x, n);
    ShortenAt(distance - least, n, dr);
  }
}

/* dr_a = -A h dt max_b|v_b - v_a| sum V (1 + 0.2 (W/W(d0))^4) grad W (Skillen et al. 2013, Lind et al. 2012), at most
   CAP spacings; particles on or near the surface lose the component along sum V grad W. */
static void DesiredShift(Cloud cloud, PetscReal guard, PetscReal dt, PetscInt a, PetscReal dr[DIM])
{
  const PetscReal *normal = cloud->field[FIELD_NORMAL] + DIM * a, *crowding = cloud->field[FIELD_CROWDING] + DIM * a;
  const PetscReal  size = cloud->size[a], h = size * KernelSmoothingLength(cloud->kernel),
                  cap    = size * CAP * cloud->domain->spacing,
                  factor = -STRENGTH * h * dt * cloud->field[FIELD_VELOCITY_JUMP][a];
  PetscReal length;

  for (PetscInt d = 0; d < DIM; d++) dr[d] = factor * crowding[d];
  if (cloud->integer[INT_SURFACE][a]) {
    const PetscReal n2 = Dot(normal, normal), share = n2 > 0 ? Dot(dr, normal) / n2 : 0;

    for (PetscInt d = 0; d < DIM; d++) dr[d] -= share * normal[d];
  }
  length = Norm(dr);
  if (length > cap)
    for (PetscInt d = 0; d < DIM; d++) dr[d] *= cap / length;
  ShortenAtWalls(cloud, guard, a, dr);
}

/* The first Taylor term of the velocity, (dr . B grad) u, of the fluid around a. */
static void TaylorTerm(Cloud cloud, PetscInt a, const PetscReal dr[DIM], PetscReal change[DIM])
{
  const PetscReal *G = cloud->field[FIELD_VELOCITY_GRADIENT] + DIM * DIM * a;
  PetscReal        along[DIM];

  TensorApply(cloud->field[FIELD_CORRECTION] + 6 * a, dr[0], dr[1], dr[2], along);
  for (PetscInt d = 0; d < DIM; d++) change[d] = Dot(G + DIM * d, along);
}

/* Plain shifting, in one pass. */
static PetscErrorCode ShiftPlain(Cloud cloud, const Shifting *shifting, PetscReal guard, PetscReal dt)
{
  PetscReal *x = cloud->field[FIELD_POSITION_NEW], *v = cloud->field[FIELD_VELOCITY_NEW];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal dr[DIM], change[DIM];

    if (cloud->field[FIELD_LAMBDA][a] <= SPRAY_LAMBDA) continue;
    DesiredShift(cloud, guard, dt, a, dr);
    TaylorTerm(cloud, a, dr, change);
    for (PetscInt d = 0; d < DIM; d++) {
      x[DIM * a + d] += dr[d];
      v[DIM * a + d] += change[d];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the displacements dr_a - sum_b s_b W_ab dr_b to the new positions. desired: dr ([n_total][3], m); weight: s_b,
   with which the centre of mass stays. change ([n_fluid][3], m/s): change of the velocity, to first order. */
static void Displace(Cloud cloud, const PetscReal desired[], const PetscReal weight[], PetscReal change[])
{
  PetscReal *x = cloud->field[FIELD_POSITION_NEW];
  PairRow    pairs;

  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal dr[DIM], sx = desired[3 * a], sy = desired[3 * a + 1], sz = desired[3 * a + 2];

    PairRowLoadGeometry(cloud, cloud->field[FIELD_POSITION], a, &pairs);
    KernelEvaluate(cloud->kernel, pairs.n, pairs.r2, pairs.W, NULL);
    SIMD_LOOP(reduction(- : sx, sy, sz))
    for (PetscInt k = 0; k < pairs.n; k++) {
      const PetscInt  b = pairs.index[k];
      const PetscReal w = pairs.W[k] * weight[b]; /* walls have none */

      sx -= w * desired[3 * b];
      sy -= w * desired[3 * b + 1];
      sz -= w * desired[3 * b + 2];
    }
    dr[0] = sx;
    dr[1] = sy;
    dr[2] = sz;
    TaylorTerm(cloud, a, dr, change + DIM * a);
    for (PetscInt d = 0; d < DIM; d++) {
      x[DIM * a + d] += dr[d];
      if (weight[a] <= 0) change[DIM * a + d] = 0;
    }
  }
}

/* Conserved shifting: neighbours lose what a particle gains. */
static PetscErrorCode ShiftConserved(Cloud cloud, const Shifting *shifting, PetscReal guard, PetscReal dt)
{
  PetscReal *x = cloud->field[FIELD_POSITION_NEW], *v = cloud->field[FIELD_VELOCITY_NEW], *weight, *desired, *change;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, 1, &weight));
  PetscCall(CloudGetWork(cloud, DIM, &desired));
  PetscCall(CloudGetWork(cloud, DIM, &change));
  PetscCall(CloudUpdate(cloud, FIELD_VELOCITY_NEW));
  PetscCall(OperatorsCompensationWeights(cloud, weight));
  PetscCall(PetscArrayzero(desired, DIM * cloud->n_owned));
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    if (weight[a] > 0) DesiredShift(cloud, guard, dt, a, desired + DIM * a);
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, desired));
  Displace(cloud, desired, weight, change);
  PetscCall(CloudUpdate(cloud, FIELD_POSITION_NEW));
  PetscCall(OperatorsCompensate(cloud, weight, x, desired, v, change));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) v[k] += change[k];
  PetscCall(CloudRestoreWork(cloud, &change));
  PetscCall(CloudRestoreWork(cloud, &desired));
  PetscCall(CloudRestoreWork(cloud, &weight));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Shift(Cloud cloud, const Shifting *shifting, PetscReal guard, PetscReal dt)
{
  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_SHIFT), 0, 0, 0, 0));
  if (shifting->conserved)
    PetscCall(ShiftConserved(cloud, shifting, guard, dt));
  else
    PetscCall(ShiftPlain(cloud, shifting, guard, dt));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_SHIFT), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
