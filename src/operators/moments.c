#include "operators.h"

#define CLUMP_WEIGHT 0.2 /* of the term that resists pairing (Lind et al. 2012; Monaghan 2000) */

/* The smallest root of 4 c^3 - 3 c = r, which is cos(arccos(r)/3 + 2 pi/3), over t = sqrt(1 - r): to 0.4 % by the
   parabola that is exact at r = 1, slope included, and at r = -1; to round-off after so many steps of Newton's method,
   in half the time of the two functions. */
#define SMALLEST_ROOT(t) (-0.5 - (t) * (0.408248290463863 - 0.0386751345948129 * (t)))
#define NEWTON_STEPS     3

/* Smith, Comm. ACM 4, 168 (1961). */
PetscReal SymmetricSmallestEigenvalue(PetscInt dim, const PetscReal M[6])
{
  const PetscReal half = 0.5 * (M[0] + M[1]), plane = PetscSqrtReal(PetscSqr(0.5 * (M[0] - M[1])) + M[3] * M[3]);

  if (dim == 2) return half - plane;
  {
    const PetscReal off = M[3] * M[3] + M[4] * M[4] + M[5] * M[5], mean = (M[0] + M[1] + M[2]) / 3;
    const PetscReal a = M[0] - mean, b = M[1] - mean, c = M[2] - mean;
    const PetscReal p = PetscSqrtReal((a * a + b * b + c * c + 2 * off) / 6);
    PetscReal       determinant, r, t, root;

    if (p <= PETSC_MACHINE_EPSILON * PetscAbsReal(mean)) return mean;
    determinant = a * (b * c - M[5] * M[5]) - M[3] * (M[3] * c - M[5] * M[4]) + M[4] * (M[3] * M[5] - b * M[4]);
    r           = PetscMax(-1.0, PetscMin(1.0, determinant / (2 * p * p * p)));
    t           = PetscSqrtReal(1 - r);
    root        = SMALLEST_ROOT(t);
    if (t > 0)
      for (PetscInt k = 0; k < NEWTON_STEPS; k++) root -= (root * (4 * root * root - 3) - r) / (12 * root * root - 3);
    return mean + 2 * p * root;
  }
}

void SymmetricInverse(PetscInt dim, const PetscReal M[6], PetscReal B[6])
{
  if (dim == 2) {
    const PetscReal inverse = 1 / (M[0] * M[1] - M[3] * M[3]);

    B[0] = M[1] * inverse;
    B[1] = M[0] * inverse;
    B[3] = -M[3] * inverse;
    B[2] = 1;
    B[4] = B[5] = 0;
  } else {
    const PetscReal xx = M[1] * M[2] - M[5] * M[5], xy = M[4] * M[5] - M[3] * M[2], xz = M[3] * M[5] - M[1] * M[4];
    const PetscReal inverse = 1 / (M[0] * xx + M[3] * xy + M[4] * xz);

    B[0] = xx * inverse;
    B[1] = (M[0] * M[2] - M[4] * M[4]) * inverse;
    B[2] = (M[0] * M[1] - M[3] * M[3]) * inverse;
    B[3] = xy * inverse;
    B[4] = xz * inverse;
    B[5] = (M[3] * M[4] - M[0] * M[5]) * inverse;
  }
}

PetscErrorCode OperatorsDensity(Cloud cloud)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *volume = cloud->volume, self = KernelSelf(cloud->kernel);
  PairRow          row;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_MOMENTS), 0, 0, 0, 0));
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    PetscReal sum = volume[a] * self;

    PairRowLoad(cloud, x, a, &row);
    KernelEvaluate(cloud->kernel, row.n, row.r2, row.W, NULL);
    SIMD_LOOP(reduction(+ : sum))
    for (PetscInt k = 0; k < row.n; k++) sum += volume[row.index[k]] * row.W[k];
    cloud->field[FIELD_DENSITY][a] = cloud->rest_density[a] * sum;
  }
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_MOMENTS), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the rows of OperatorsMoments share. */
typedef struct {
  PetscReal V, self, scale_w, scale_f, ratio; /* V in m^dim; W(0); of the kernel; scale_w/W(d0) */
} Scales;

/* One row: the sums, then what follows from them. */
static void MomentsRow(Cloud cloud, PetscInt a, const float w[], void *context)
{
  const Scales    *scales = (const Scales *)context;
  const PetscReal *x = cloud->field[FIELD_POSITION], V = scales->V, scale = V * scales->scale_f, ratio = scales->ratio;
  const Triple     p      = TripleLoad(x + DIM * a);
  Triple           normal = TripleSet(0), crowd = normal, diagonal = normal, off = normal;
  PetscReal       *B = cloud->field[FIELD_MOMENT] + 6 * a, M[6], clump[ROW_CAPACITY], sum = 0, lambda;
  Row              row;

  RowLoad(cloud, a, &row);
  SIMD_LOOP(reduction(+ : sum))
  for (PetscInt k = 0; k < row.n; k++) {
    const PetscReal r = w[k] * ratio, r2 = r * r;

    sum += w[k];
    clump[k] = row.f[k] * (1 + CLUMP_WEIGHT * r2 * r2);
  }
  for (PetscInt k = 0; k < row.n; k++) {
    const Triple d = p - TripleLoad(x + DIM * row.index[k]), fd = TripleSet(row.f[k]) * d;

    normal += fd;
    crowd += TripleSet(clump[k]) * d;
    diagonal -= fd * d;
    off -= fd * TripleTurn(d); /* xy, yz, zx */
  }
  for (PetscInt d = 0; d < DIM; d++) {
    M[d]                                      = scale * diagonal[d];
    cloud->field[FIELD_NORMAL][DIM * a + d]   = scale * normal[d];
    cloud->field[FIELD_CROWDING][DIM * a + d] = scale * crowd[d];
  }
  M[3]                           = scale * off[0];
  M[4]                           = scale * off[2];
  M[5]                           = scale * off[1];
  lambda                         = SymmetricSmallestEigenvalue(cloud->domain->dim, M);
  cloud->field[FIELD_LAMBDA][a]  = lambda;
  cloud->field[FIELD_DENSITY][a] = cloud->rest_density[a] * V * (scales->self + scales->scale_w * sum);
  if (lambda > MOMENT_MINIMUM)
    SymmetricInverse(cloud->domain->dim, M, B);
  else {
    B[0] = B[1] = B[2] = 1;
    B[3] = B[4] = B[5] = 0;
  }
}

PetscErrorCode OperatorsMoments(Cloud cloud)
{
  const PetscReal d2     = PetscSqr(cloud->domain->spacing);
  Scales          scales = {.V = cloud->domain->volume, .self = KernelSelf(cloud->kernel)};
  PetscReal       inverse_h2, at_spacing;

  PetscFunctionBegin;
  KernelScales(cloud->kernel, &scales.scale_w, &scales.scale_f, &inverse_h2);
  KernelEvaluate(cloud->kernel, 1, &d2, &at_spacing, NULL);
  scales.ratio = scales.scale_w / at_spacing;
  PetscCall(CloudSearch(cloud, MomentsRow, &scales));
  PetscFunctionReturn(PETSC_SUCCESS);
}
