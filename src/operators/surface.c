/* Free-surface detection of Marrone, Colagrossi, Le Touze, Graziani 2010. */
#include "operators.h"

#define LAMBDA_INNER  0.75 /* at least: inner */
#define LAMBDA_NEAR   0.95 /* at most, next to a flagged particle: near the surface */
#define CONE_SCALE    1.33 /* cone radius over spacing: tied to the spacing, not to a wide kernel */
#define NEAR_DISTANCE 1.5  /* spacings */

/* Whether no neighbour lies in the umbrella above particle a: outward normal n, cone scale s. */
static PetscBool ConeIsEmpty(Cloud cloud, PetscInt a, const PetscReal n[DIM], PetscReal s)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *p = x + DIM * a;
  const PetscInt   dim = cloud->domain->dim;

  for (PetscInt k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
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

PetscErrorCode OperatorsFreeSurface(Cloud cloud)
{
  const PetscReal  s = CONE_SCALE * cloud->domain->spacing, near2 = PetscSqr(NEAR_DISTANCE * cloud->domain->spacing);
  const PetscReal *lambda = cloud->field[FIELD_LAMBDA], *x = cloud->field[FIELD_POSITION];
  const PetscInt  *layer = cloud->integer[INT_LAYER];
  PetscInt        *flag  = cloud->integer[INT_SURFACE];

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_SURFACE), 0, 0, 0, 0));
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
      flag[a] = ConeIsEmpty(cloud, a, n, s) ? 1 : 0;
    }
  }
  PetscCall(CloudUpdateInt(cloud, INT_SURFACE));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    if (flag[a] || lambda[a] >= LAMBDA_NEAR) continue;
    if (lambda[a] < LAMBDA_INNER) flag[a] = 2;
    for (PetscInt k = cloud->first[a]; k < cloud->first[a + 1] && !flag[a]; k++) {
      const PetscInt b = cloud->list[k];

      if (flag[b] == 1 && layer[b] == 0) {
        const PetscReal dx = x[3 * a] - x[3 * b], dy = x[3 * a + 1] - x[3 * b + 1], dz = x[3 * a + 2] - x[3 * b + 2];

        if (dx * dx + dy * dy + dz * dz < near2) flag[a] = 2;
      }
    }
  }
  PetscCall(CloudUpdateInt(cloud, INT_SURFACE));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_SURFACE), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
