/* The pressure force on walls, as the reaction to the pressure force on the fluid.

   Symmetric pair forces V_a V_b (p_a + p_b) grad W give each wall the reaction of its pairs. The corrected gradient
   B_a sum V_b (p_b - p_a) grad W is not symmetric. Written with p_a + p_b, it has B_a on the pairs and a remainder of
   two terms: 2 p_a B_a sum V_b grad W, and the sum over pairs of fluid that does not cancel because B_a differs from
   B_b. Inside the liquid the remainder sums to zero. At a wall, where it is 3 % of the weight of a film ten spacings
   deep, it acts on the wall: the dummy particles around a receive it in proportion to their W'. Liquid that pushes is
   like a wall.

   A pressure that is the same everywhere does not push a solid that liquid surrounds. The sums give it a force of some
   percent of that pressure over its cross-section, where particles are as uneven as around a solid that moves. So the
   pressures around such a solid count less their mean. */
#include "../neighbors/pairs.h"
#include "operators.h"

#define FRONT 1.25 /* spacings, from a dummy particle of the first layer to what is in front of its solid */

/* The mean pressure (Pa) of the liquid next to each solid that it surrounds; 0 for others. */
typedef struct {
  PetscReal of[SCENE_MAX_BODIES];
} Levels;

/* Whether the solid of owned dummy particle b is bare there: a wall or another solid touches it, or no liquid is in
   front. Particles of deeper layers have their own solid in front. */
static PetscBool IsBare(Cloud cloud, PetscInt b)
{
  const PetscInt   body = cloud->integer[INT_BODY][b];
  const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * b, d0 = cloud->domain->spacing * cloud->size[b];
  PetscReal        front[DIM], y[DIM];
  PetscBool        wet;

  for (PetscInt d = 0; d < DIM; d++) front[d] = x[d] + FRONT * d0 * cloud->solid_normal[DIM * b + d];
  wet = (PetscBool)(BodyNearest(SceneSolid(cloud->scene, BODY_SOLID - body), front, y) < 0);
  for (PetscInt64 k = cloud->first[b]; k < cloud->first[b + 1]; k++) {
    const PetscInt  a      = cloud->list[k];
    const PetscBool liquid = (PetscBool)!CloudBounds(cloud, a);
    PetscReal       r[DIM];

    if (!liquid && cloud->integer[INT_BODY][a] == body) continue;
    for (PetscInt d = 0; d < DIM; d++) r[d] = cloud->field[FIELD_POSITION][DIM * a + d] - (liquid ? front[d] : x[d]);
    DomainNearest(cloud->domain, r);
    if (!liquid && Norm(r) < FRONT * d0) return PETSC_TRUE;
    wet = (PetscBool)(wet || (liquid && Norm(r) < d0));
  }
  return (PetscBool)!wet;
}

/* Whether a face of the box cuts a solid: its force there has nothing to balance it. */
static PetscBool IsCut(Domain domain, Body solid)
{
  PetscReal lower[DIM], upper[DIM];
  PetscBool cut = PETSC_FALSE;

  BodyBounds(solid, lower, upper);
  for (PetscInt f = 0; f < 2 * domain->dim; f++) {
    const PetscInt d = f / 2;

    if (domain->face[d][f % 2] != FACE_WALL && domain->face[d][f % 2] != FACE_OPEN) continue;
    cut = (PetscBool)(cut || (f % 2 ? upper[d] >= domain->upper[d] : lower[d] <= domain->lower[d]));
  }
  return cut;
}

static PetscErrorCode FindLevels(Cloud cloud, Levels *levels)
{
  const PetscInt solids                    = SceneSolidCount(cloud->scene);
  PetscReal      sum[3 * SCENE_MAX_BODIES] = {0}; /* weights, pressures, bare particles */

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(levels->of, SCENE_MAX_BODIES));
  if (!solids) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = cloud->n_fluid; b < cloud->n_owned; b++) {
    const PetscInt solid = BODY_SOLID - cloud->integer[INT_BODY][b];

    if (solid < 0 || cloud->integer[INT_LAYER][b] != 1) continue; /* of solids that move, all are of layer 1 */
    sum[3 * solid] += cloud->volume[b];
    sum[3 * solid + 1] += cloud->volume[b] * cloud->field[FIELD_PRESSURE][b];
    sum[3 * solid + 2] += IsBare(cloud, b);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, (PetscMPIInt)(3 * solids), MPIU_REAL, MPIU_SUM, cloud->comm));
  for (PetscInt s = 0; s < solids; s++)
    if (sum[3 * s] > 0 && sum[3 * s + 2] == 0 && !IsCut(cloud->domain, SceneSolid(cloud->scene, s)))
      levels->of[s] = sum[3 * s + 1] / sum[3 * s];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The level for component d of the force on particle b. Behind a mirror and around the axis the rest of the solid takes
   up what a level does. */
static PetscReal LevelOf(Cloud cloud, const Levels *levels, PetscInt b, PetscInt d)
{
  const PetscInt solid = BODY_SOLID - cloud->integer[INT_BODY][b];

  if (solid < 0 || cloud->domain->face[d][0] == FACE_SYMMETRY || cloud->domain->face[d][1] == FACE_SYMMETRY) return 0;
  return levels->of[solid];
}

/* V_a V_b F, of rings times the length of the ring half-way between. */
static PetscReal PairArea(Cloud cloud, PetscInt a, const PairRow *row, PetscInt k)
{
  const PetscReal *x = cloud->field[FIELD_POSITION];
  const PetscInt   b = row->index[k];

  return cloud->weight[a] * (cloud->weight[b] * PetscSqr(cloud->domain->volume)) *
         DomainPairLength(cloud->domain, x + DIM * a, x + DIM * b) * row->F[k];
}

/* The force of fluid particle a on the walls beyond its pairs with dummy particles; that of a pressure of 1 everywhere
   in 'one'. */
static void FindRemainder(Cloud cloud, PetscInt a, const PairRow *row, PetscReal remainder[DIM], PetscReal one[DIM])
{
  const PetscReal *B = cloud->field[FIELD_CORRECTION], *normal = cloud->field[FIELD_NORMAL] + DIM * a,
                  *p = cloud->field[FIELD_PRESSURE];

  TensorApply(B + 6 * a, normal[0], normal[1], normal[2], one);
  for (PetscInt d = 0; d < DIM; d++) {
    one[d] *= -2 * cloud->volume[a];
    remainder[d] = p[a] * one[d];
  }
  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt b = row->index[k];
    PetscReal      difference[6], part[DIM];

    if (CloudBounds(cloud, b)) continue;
    for (PetscInt e = 0; e < 6; e++) difference[e] = 0.5 * PairArea(cloud, a, row, k) * (B[6 * a + e] - B[6 * b + e]);
    TensorApply(difference, row->dx[k], row->dy[k], row->dz[k], part);
    for (PetscInt d = 0; d < DIM; d++) {
      one[d] += 2 * part[d];
      remainder[d] += (p[a] + p[b]) * part[d];
    }
  }
}

/* Adds the force of fluid particle a on the dummy particles around it. */
static void AddRow(Cloud cloud, const Levels *levels, PetscBool corrected, PetscInt a, const PairRow *row,
                   PetscReal force[])
{
  const PetscReal  identity[6] = {1, 1, 1, 0, 0, 0}, *p = cloud->field[FIELD_PRESSURE];
  const PetscReal *B              = corrected ? cloud->field[FIELD_CORRECTION] + 6 * a : identity;
  PetscReal        remainder[DIM] = {0, 0, 0}, one[DIM] = {0, 0, 0}, sum = 0;

  for (PetscInt k = 0; k < row->n; k++) sum += CloudBounds(cloud, row->index[k]) ? row->F[k] : 0;
  if (sum == 0) return;
  if (corrected) FindRemainder(cloud, a, row, remainder, one);
  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt b = row->index[k];
    PetscReal      c, part[DIM];

    if (!CloudBounds(cloud, b)) continue;
    c = PairArea(cloud, a, row, k);
    TensorApply(B, row->dx[k], row->dy[k], row->dz[k], part);
    for (PetscInt d = 0; d < DIM; d++) {
      const PetscReal level = LevelOf(cloud, levels, b, d);

      force[DIM * b + d] += c * (p[a] + p[b] - 2 * level) * part[d] + (remainder[d] - level * one[d]) * row->F[k] / sum;
    }
  }
}

PetscErrorCode OperatorsWallForce(Cloud cloud, PetscBool corrected, PetscReal force[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];
  Levels           levels;
  PairRow          row;

  PetscFunctionBegin;
  if (corrected) PetscCall(CloudUpdate(cloud, FIELD_CORRECTION));
  PetscCall(FindLevels(cloud, &levels));
  PetscCall(PetscArrayzero(force, DIM * cloud->n_total));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    if (CloudPushes(cloud, a) || !(cloud->pushing || OperatorsNearWall(cloud, x + DIM * a))) continue;
    PairRowLoadGeometry(cloud, x, a, &row);
    PairRowGradient(cloud, a, &row);
    /* near the free surface the gradient is not corrected */
    AddRow(cloud, &levels, (PetscBool)(corrected && cloud->integer[INT_SURFACE][a] == 0), a, &row, force);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes from u (m/s), at dummy particle b, what is not along its wall or solid. */
static void KeepAlong(Cloud cloud, PetscInt b, PetscReal u[DIM])
{
  const Domain     domain = cloud->domain;
  const PetscReal *x      = cloud->field[FIELD_POSITION] + DIM * b;

  if (cloud->integer[INT_BODY][b] <= BODY_SOLID) {
    const PetscReal *n = cloud->solid_normal + DIM * b, across = Dot(u, n);

    for (PetscInt d = 0; d < DIM; d++) u[d] -= across * n[d];
  } else
    for (PetscInt d = 0; d < DIM; d++)
      if (x[d] < domain->lower[d] || x[d] > domain->upper[d]) u[d] = 0;
}

PetscErrorCode OperatorsBeside(Cloud cloud, PetscReal u[])
{
  PetscReal *beside;

  PetscFunctionBegin;
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, u));
  PetscCall(CloudGetWork(cloud, DIM, &beside));
  for (PetscInt b = cloud->n_fluid; b < cloud->n_owned; b++) {
    PetscReal *mean  = beside + DIM * b;
    PetscInt   count = 0;

    for (PetscInt d = 0; d < DIM; d++) mean[d] = u[DIM * b + d];
    if (Dot(mean, mean) > 0) continue;
    for (PetscInt64 k = cloud->first[b]; k < cloud->first[b + 1]; k++) {
      const PetscInt   a = cloud->list[k];
      const PetscReal *v = u + DIM * a;

      if (cloud->integer[INT_LAYER][a] && Dot(v, v) == 0) continue;
      for (PetscInt d = 0; d < DIM; d++) mean[d] += v[d];
      count++;
    }
    for (PetscInt d = 0; d < DIM && count; d++) mean[d] /= count;
    KeepAlong(cloud, b, mean);
  }
  PetscCall(
    PetscArraycpy(u + DIM * cloud->n_fluid, beside + DIM * cloud->n_fluid, DIM * (cloud->n_owned - cloud->n_fluid)));
  PetscCall(CloudRestoreWork(cloud, &beside));
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, u));
  PetscFunctionReturn(PETSC_SUCCESS);
}
