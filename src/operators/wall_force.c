/* The pressure force on walls, as the reaction to the pressure force on the fluid.

   Symmetric pair forces V_a V_b (p_a + p_b) grad W give each wall the reaction of its pairs. The corrected gradient
   B_a sum V_b (p_b - p_a) grad W is not symmetric. Written with p_a + p_b, it has B_a on the pairs and a remainder of
   two terms: 2 p_a B_a sum V_b grad W, and the sum over pairs of fluid that does not cancel because B_a differs from
   B_b. Inside the liquid the remainder sums to zero. At a wall, where it is 3 % of the weight of a film ten spacings
   deep, it acts on the wall: the dummy particles around a receive it in proportion to their W'. Liquid that pushes is
   like a wall. */
#include "../neighbors/pairs.h"
#include "operators.h"

/* V_a V_b (p_a + p_b) F, of rings times the length of the ring half-way between. */
static PetscReal PairForce(Cloud cloud, PetscInt a, const PairRow *row, PetscInt k)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *p = cloud->field[FIELD_PRESSURE];
  const PetscInt   b = row->index[k];

  return cloud->weight[a] * (cloud->weight[b] * PetscSqr(cloud->domain->volume)) *
         DomainPairLength(cloud->domain, x + DIM * a, x + DIM * b) * (p[a] + p[b]) * row->F[k];
}

/* The force of fluid particle a on the walls beyond its pairs with dummy particles. */
static void FindRemainder(Cloud cloud, PetscInt a, const PairRow *row, PetscReal remainder[DIM])
{
  const PetscReal *B = cloud->field[FIELD_CORRECTION], *normal = cloud->field[FIELD_NORMAL] + DIM * a;

  TensorApply(B + 6 * a, normal[0], normal[1], normal[2], remainder);
  for (PetscInt d = 0; d < DIM; d++) remainder[d] *= -2 * cloud->volume[a] * cloud->field[FIELD_PRESSURE][a];
  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt  b = row->index[k];
    const PetscReal c = 0.5 * PairForce(cloud, a, row, k);
    PetscReal       difference[6], part[DIM];

    if (CloudBounds(cloud, b)) continue;
    for (PetscInt e = 0; e < 6; e++) difference[e] = B[6 * a + e] - B[6 * b + e];
    TensorApply(difference, row->dx[k], row->dy[k], row->dz[k], part);
    for (PetscInt d = 0; d < DIM; d++) remainder[d] += c * part[d];
  }
}

/* Adds the force of fluid particle a on the dummy particles around it. */
static void AddRow(Cloud cloud, PetscBool corrected, PetscInt a, const PairRow *row, PetscReal force[])
{
  const PetscReal  identity[6]    = {1, 1, 1, 0, 0, 0};
  const PetscReal *B              = corrected ? cloud->field[FIELD_CORRECTION] + 6 * a : identity;
  PetscReal        remainder[DIM] = {0, 0, 0}, sum = 0;

  for (PetscInt k = 0; k < row->n; k++) sum += CloudBounds(cloud, row->index[k]) ? row->F[k] : 0;
  if (sum == 0) return;
  if (corrected) FindRemainder(cloud, a, row, remainder);
  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt b = row->index[k];
    PetscReal      c, part[DIM];

    if (!CloudBounds(cloud, b)) continue;
    c = PairForce(cloud, a, row, k);
    TensorApply(B, row->dx[k], row->dy[k], row->dz[k], part);
    for (PetscInt d = 0; d < DIM; d++) force[DIM * b + d] += c * part[d] + remainder[d] * row->F[k] / sum;
  }
}

PetscErrorCode OperatorsWallForce(Cloud cloud, PetscBool corrected, PetscReal force[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];
  PairRow          row;

  PetscFunctionBegin;
  if (corrected) PetscCall(CloudUpdate(cloud, FIELD_CORRECTION));
  PetscCall(PetscArrayzero(force, DIM * cloud->n_total));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    if (CloudPushes(cloud, a) || !(cloud->pushing || OperatorsNearWall(cloud, x + DIM * a))) continue;
    PairRowLoadGeometry(cloud, x, a, &row);
    PairRowGradient(cloud, a, &row);
    /* near the free surface the gradient is not corrected */
    AddRow(cloud, (PetscBool)(corrected && cloud->integer[INT_SURFACE][a] == 0), a, &row, force);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
