/* The sources of -spacing_follow: particles of the free surface, each with the spacing that its curvature asks for. */
#include "../neighbors/pairs.h"
#include "following_impl.h"

#define THIN       0.4 /* lambda below which liquid is too thin for a curvature */
#define BISECTIONS 20
#define SAME_SIDE  0.2 /* least cosine of two normals on the same side of the liquid, as in tension/curvature.c */

/* The neighbours of surface particle a on the same side of the surface, [n] places in its row, which is loaded with
   their weights. */
static PetscInt SameSide(Cloud cloud, PetscInt a, PairRow *row, PetscInt place[])
{
  const PetscReal *g = cloud->field[FIELD_NORMAL], *n = g + DIM * a, length = Norm(n);
  PetscInt         count = 0;

  PairRowLoadGeometry(cloud, cloud->field[FIELD_POSITION], a, row);
  PairRowEvaluate(cloud, a, row);
  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt   b  = row->index[k];
    const PetscReal *nb = g + DIM * b, of_b = Norm(nb);

    if (cloud->integer[INT_LAYER][b] == 0 && cloud->integer[INT_SURFACE][b] == 1 && row->r2[k] > 0 && of_b > 0 &&
        Dot(n, nb) > SAME_SIDE * length * of_b)
      place[count++] = k;
  }
  return count;
}

/* The sum of the principal curvatures (1/m) of the free surface at particle a from the normals of its neighbours on the
   surface: in the direction of a neighbour the curvature is (n_b - n_a).(x_b - x_a) over their distance squared, and
   the mean over all directions is half the sum in space. */
static PetscReal FromNormals(Cloud cloud, PetscInt a, PairRow *row, PetscInt place[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *g = cloud->field[FIELD_NORMAL], *n = g + DIM * a;
  const PetscReal  length = Norm(n);
  const PetscInt   count  = SameSide(cloud, a, row, place);
  PetscReal        sum = 0, weights = 0;

  for (PetscInt l = 0; l < count; l++) {
    const PetscInt   k  = place[l];
    const PetscReal *nb = g + DIM * row->index[k], of_b = Norm(nb), r[DIM] = {row->dx[k], row->dy[k], row->dz[k]};

    for (PetscInt d = 0; d < DIM; d++) sum += row->W[k] / row->r2[k] * (n[d] / length - nb[d] / of_b) * r[d];
    weights += row->W[k];
  }
  if (weights > 0) sum *= -(PetscReal)(cloud->domain->dim - 1) / weights; /* FIELD_NORMAL points into the liquid */
  if (cloud->domain->rings) sum -= n[0] / length / PetscMax(x[DIM * a], cloud->size[a] * cloud->domain->spacing);
  return sum;
}

/* The mean of a value over surface particle a and its neighbours on the same side: the target takes the least spacing
   around, which would be that of the noise. */
static PetscReal Smoothed(Cloud cloud, PetscInt a, const PetscReal value[], PairRow *row, PetscInt place[])
{
  const PetscInt count = SameSide(cloud, a, row, place);
  PetscReal      sum   = value[a];

  for (PetscInt l = 0; l < count; l++) sum += value[row->index[place[l]]];
  return sum / (1 + count);
}

/* Whether particle a is of spray or of liquid a particle thick, which keeps its spacing. */
static PetscBool IsThin(Cloud cloud, PetscInt a)
{
  return (PetscBool)(cloud->field[FIELD_LAMBDA][a] < THIN);
}

/* Whether particle a tells where the free surface is. Thin liquid and spray do not: a drop of one particle would make
   the pool below it fine. */
static PetscBool OnSurface(Cloud cloud, PetscInt a)
{
  return (PetscBool)(cloud->integer[INT_SURFACE][a] == 1 && Norm(cloud->field[FIELD_NORMAL] + DIM * a) > 0 &&
                     !IsThin(cloud, a));
}

/* -spacing_follow surface: all of the free surface is fine, and thin liquid keeps its spacing. */
static void AddAll(Cloud cloud)
{
  const PetscReal spacing = cloud->domain->spacing;

  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    if (cloud->integer[INT_SURFACE][a] == 1)
      TargetAdd(cloud->scene, cloud->field[FIELD_POSITION] + DIM * a,
                IsThin(cloud, a) ? cloud->size[a] * spacing : spacing);
}

/* -spacing_follow curvature. Principal curvatures count by their magnitudes: their sum vanishes on the lip of a crater,
   where they have opposite signs, and the crater closed with a width 12 % wrong. Without tension it is the magnitude of
   the sum. curvature: [n_total], of work. */
static PetscErrorCode AddCurved(Cloud cloud, PetscReal curvature[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];
  PetscInt         place[ROW_CAPACITY];
  PairRow          row;

  PetscFunctionBegin;
  PetscCall(CloudUpdate(cloud, FIELD_NORMAL));
  PetscCall(CloudUpdateInt(cloud, INT_SURFACE));
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    TargetFill(cloud->scene, x + DIM * a, cloud->size[a] * cloud->domain->spacing);
  PetscCall(TargetFilled(cloud->scene));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal sigma     = BodyMaterial(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]))->tension,
                    capillary = CloudIsCurrent(cloud, FIELD_CAPILLARY) ? cloud->field[FIELD_CAPILLARY][a] : 0;

    curvature[a] = 0;
    if (OnSurface(cloud, a))
      curvature[a] = sigma > 0 && capillary != 0 ? cloud->field[FIELD_BENDING][a] : FromNormals(cloud, a, &row, place);
  }
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, curvature));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *n = cloud->field[FIELD_NORMAL] + DIM * a;
    PetscReal        into[DIM];

    if (!OnSurface(cloud, a)) continue;
    for (PetscInt d = 0; d < DIM; d++) into[d] = n[d] / Norm(n);
    TargetAdd(cloud->scene, x + DIM * a,
              TargetSpacing(cloud->scene, x + DIM * a, into, Smoothed(cloud, a, curvature, &row, place)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The particles of liquid, of all ranks, that a target 'factor' times as coarse asks for. */
static PetscErrorCode CountWanted(Cloud cloud, const PetscReal size[], PetscReal factor, PetscReal *count)
{
  const Domain domain = cloud->domain;
  PetscReal    sum    = 0;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    sum += cloud->weight[a] /
           PetscPowRealInt(PetscMin(factor * size[a], domain->spacing_coarse / domain->spacing), (int)domain->dim);
  PetscCallMPI(MPI_Allreduce(&sum, count, 1, MPIU_REAL, MPI_SUM, cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes the target coarser until it asks for no more than -particles_most. */
static PetscErrorCode BoundCount(Cloud cloud, PetscReal size[])
{
  const PetscInt  most     = FollowOf(cloud->domain)->particles_most;
  const PetscReal coarsest = cloud->domain->spacing_coarse / cloud->domain->spacing;
  PetscReal       low = 1, high = coarsest, count;

  PetscFunctionBegin;
  if (!most) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CountWanted(cloud, size, low, &count));
  if (count <= most) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < BISECTIONS; k++) {
    const PetscReal middle = 0.5 * (low + high);

    PetscCall(CountWanted(cloud, size, middle, &count));
    if (count > most)
      low = middle;
    else
      high = middle;
  }
  for (PetscInt a = 0; a < cloud->n_total; a++) size[a] = PetscMin(high * size[a], coarsest);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TargetFind(Cloud cloud, PetscReal size[])
{
  const Domain domain = cloud->domain;

  PetscFunctionBegin;
  PetscCall(CloudUpdate(cloud, FIELD_LAMBDA));
  PetscCall(TargetClear(cloud->scene));
  PetscCall(TargetSolids(cloud->scene));
  if (FollowOf(domain)->what == FOLLOW_SURFACE)
    AddAll(cloud);
  else
    PetscCall(AddCurved(cloud, size));
  PetscCall(TargetSpread(cloud->scene));
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    size[a] = SceneSpacing(cloud->scene, cloud->field[FIELD_POSITION] + DIM * a) / domain->spacing;
    if (IsThin(cloud, a)) size[a] = PetscMin(size[a], cloud->size[a]);
  }
  PetscCall(BoundCount(cloud, size));
  PetscFunctionReturn(PETSC_SUCCESS);
}
