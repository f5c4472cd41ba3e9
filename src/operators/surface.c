/* Free-surface detection of Marrone, Colagrossi, Le Touze and Graziani 2010. */
#include "../neighbors/pairs.h"
#include "operators.h"

#define LAMBDA_INNER 0.75 /* of Marrone et al.: particles with a larger lambda are not on the surface */
#define CONE         1.33 /* spacings, the h of Marrone et al., for any kernel */
#define LAMBDA_NEAR  0.95 /* particles with a larger lambda are not near the surface; a film's second layer has 0.9 */
#define NEAR         1.5  /* spacings: largest distance from a surface particle; chosen, as LAMBDA_NEAR is */

/* Whether no neighbour lies in the umbrella-shaped region above particle a. n: outward normal; s: scale of the cone, m.
 */
static PetscBool ConeIsEmpty(Cloud cloud, PetscInt a, const PetscReal n[DIM], PetscReal s)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *p = x + DIM * a;
  const PetscInt   dim = cloud->domain->dim;

  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    const PetscReal *q        = x + DIM * cloud->list[k];
    const PetscReal  r[DIM]   = {q[0] - p[0], q[1] - p[1], q[2] - p[2]},
                    t[DIM]    = {r[0] - s * n[0], r[1] - s * n[1], r[2] - s * n[2]};
    const PetscReal distance2 = Dot(r, r), height = Dot(r, n);

    if (distance2 >= 2 * s * s) {
      if (Dot(t, t) < s * s) return PETSC_FALSE;
    } else if (dim == 3) {
      if (height > 0 && height * height > 0.5 * distance2) return PETSC_FALSE; /* angle below pi/4 */
    } else {
      const PetscReal tangential = -t[0] * n[1] + t[1] * n[0];

      if (PetscAbsReal(Dot(n, t)) + PetscAbsReal(tangential) < s) return PETSC_FALSE;
    }
  }
  return PETSC_TRUE;
}

/* flag: 1 for rows on the free surface, 0 for other particles. */
static void FlagSurface(Cloud cloud, PetscInt flag[])
{
  const PetscReal  s      = CONE * cloud->domain->spacing;
  const PetscReal *lambda = cloud->field[FIELD_LAMBDA];

  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    const PetscReal *g = cloud->field[FIELD_NORMAL] + DIM * a, *B = cloud->field[FIELD_CORRECTION] + 6 * a;
    PetscReal        n[DIM], length;

    flag[a] = 0;
    if (a >= cloud->n_rows || lambda[a] >= LAMBDA_INNER) continue;
    TensorApply(B, -g[0], -g[1], -g[2], n);
    length = Norm(n);
    if (lambda[a] <= SPRAY_LAMBDA || length <= 0)
      flag[a] = 1;
    else {
      for (PetscInt d = 0; d < DIM; d++) n[d] /= length;
      flag[a] = ConeIsEmpty(cloud, a, n, s * cloud->size[a]) ? 1 : 0;
    }
  }
}

/* Whether a flagged fluid particle lies within a distance (m) of particle a. */
static PetscBool SurfaceIsNear(Cloud cloud, PetscInt a, PetscReal distance, const PetscInt flag[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, near2 = PetscSqr(distance);

  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    const PetscInt   b    = cloud->list[k];
    const PetscReal *y    = cloud->field[FIELD_POSITION] + DIM * b;
    const PetscReal  r[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};

    if (flag[b] == 1 && cloud->integer[INT_LAYER][b] == 0 && Dot(r, r) < near2) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

PetscErrorCode OperatorsFreeSurface(Cloud cloud)
{
  const PetscReal *lambda = cloud->field[FIELD_LAMBDA], distance = NEAR * cloud->domain->spacing;
  PetscInt        *flag = cloud->integer[INT_SURFACE];

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_SURFACE), 0, 0, 0, 0));
  FlagSurface(cloud, flag);
  PetscCall(CloudUpdateInt(cloud, INT_SURFACE));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    if (flag[a] || lambda[a] >= LAMBDA_NEAR) continue;
    if (lambda[a] < LAMBDA_INNER || SurfaceIsNear(cloud, a, distance * cloud->size[a], flag)) flag[a] = 2;
  }
  PetscCall(CloudUpdateInt(cloud, INT_SURFACE));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_SURFACE), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* weight of a particle in the mean of its normal over that of its neighbours: there are some eight beside it */
#define SELF 0.125

PetscErrorCode OperatorsSmoothNormals(Cloud cloud, PetscReal n[])
{
  const PetscReal *normal = cloud->field[FIELD_NORMAL];
  PairRow          row;

  PetscFunctionBegin;
  PetscCall(CloudUpdate(cloud, FIELD_NORMAL));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal sum[DIM] = {0, 0, 0}, weight = 0, *out = n + DIM * a, length;

    for (PetscInt d = 0; d < DIM; d++) out[d] = 0;
    if (!cloud->integer[INT_SURFACE][a]) continue;
    PairRowLoadFactors(cloud, a, &row);
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt b = row.index[k];

      if (cloud->integer[INT_LAYER][b]) continue;
      weight += row.f[k];
      for (PetscInt d = 0; d < DIM; d++) sum[d] += row.f[k] * normal[DIM * b + d];
    }
    for (PetscInt d = 0; d < DIM; d++) sum[d] = -(sum[d] + SELF * weight * normal[DIM * a + d]);
    length = Norm(sum);
    for (PetscInt d = 0; d < DIM && length > 0; d++) out[d] = sum[d] / length;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The integral of |n| over the liquid below a flat surface is half its area for any kernel, n = sum V grad W: sum V W
   rises from 1/2 at the surface to 1 inside. Of a curved one it is 1 - kappa s of that, s the depth int (1 - F) of the
   filled fraction F: below it there is less, and the missing pairs of a curved surface are more. Rings below have as
   much less again as they are shorter. */
PetscReal OperatorsSurfaceArea(Cloud cloud, PetscInt a, PetscReal kappa)
{
  const PetscReal *n = cloud->field[FIELD_NORMAL] + DIM * a, size = Norm(n);

  if (!cloud->integer[INT_SURFACE][a] || size == 0) return 0;
  if (kappa != 0) kappa -= DomainLengthening(cloud->domain, cloud->field[FIELD_POSITION] + DIM * a, n) / size;
  return 2 * cloud->volume[a] * size * (1 + kappa * KernelPlaneMoment(cloud->kernel) * cloud->size[a]);
}

/* The divergence of the smooth normals along the surface, from the slope that fits those of one side: G is K M, K their
   gradient, M the second moment, of which the part in the surface counts. Rings have their hoop. */
PetscErrorCode OperatorsCurvatures(Cloud cloud, PetscReal kappa[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];
  PetscReal       *n;
  PairRow          row;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, DIM, &n));
  PetscCall(PetscArrayzero(n + DIM * cloud->n_fluid, DIM * (cloud->n_owned - cloud->n_fluid)));
  PetscCall(OperatorsSmoothNormals(cloud, n));
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, n));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *own  = n + DIM * a;
    PetscReal        turn = 0, moment = 0;

    kappa[a] = 0;
    if (Dot(own, own) == 0) continue;
    PairRowLoadFactors(cloud, a, &row);
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscReal *its = n + DIM * row.index[k], *y = x + DIM * row.index[k],
                      r[DIM]      = {x[DIM * a] - y[0], x[DIM * a + 1] - y[1], x[DIM * a + 2] - y[2]},
                      change[DIM] = {own[0] - its[0], own[1] - its[1], own[2] - its[2]};

      if (Dot(own, its) <= 0) continue;
      turn += row.f[k] * Dot(change, r);
      moment += row.f[k] * (Dot(r, r) - PetscSqr(Dot(r, own)));
    }
    if (moment != 0) kappa[a] = -turn / moment * (cloud->domain->dim - 1);
    kappa[a] -= DomainLengthening(cloud->domain, x + DIM * a, own);
  }
  PetscCall(CloudRestoreWork(cloud, &n));
  PetscFunctionReturn(PETSC_SUCCESS);
}
