#include "operators.h"

#define CLUMP_WEIGHT 0.2 /* of the term that resists pairing (Lind et al. 2012; Monaghan 2000) */

PetscReal SymmetricSmallestEigenvalue(PetscInt dim, const PetscReal M[6])
{
  const PetscReal half = 0.5 * (M[0] + M[1]), plane = PetscSqrtReal(PetscSqr(0.5 * (M[0] - M[1])) + M[3] * M[3]);

  if (dim == 2) return half - plane;
  {
    const PetscReal off = M[3] * M[3] + M[4] * M[4] + M[5] * M[5], mean = (M[0] + M[1] + M[2]) / 3;
    const PetscReal a = M[0] - mean, b = M[1] - mean, c = M[2] - mean;
    const PetscReal p = PetscSqrtReal((a * a + b * b + c * c + 2 * off) / 6);
    PetscReal       determinant, cosine;

    if (p <= PETSC_MACHINE_EPSILON * PetscAbsReal(mean)) return mean;
    determinant = a * (b * c - M[5] * M[5]) - M[3] * (M[3] * c - M[5] * M[4]) + M[4] * (M[3] * M[5] - b * M[4]);
    cosine      = PetscMax(-1.0, PetscMin(1.0, determinant / (2 * p * p * p)));
    return mean + 2 * p * PetscCosReal(PetscAcosReal(cosine) / 3 + 2 * PETSC_PI / 3);
  }
}

void SymmetricInverse(PetscInt dim, const PetscReal M[6], PetscReal B[6])
{
  if (dim == 2) {
    const PetscReal determinant = M[0] * M[1] - M[3] * M[3];

    B[0] = M[1] / determinant;
    B[1] = M[0] / determinant;
    B[3] = -M[3] / determinant;
    B[2] = 1;
    B[4] = B[5] = 0;
  } else {
    const PetscReal xx = M[1] * M[2] - M[5] * M[5], xy = M[4] * M[5] - M[3] * M[2], xz = M[3] * M[5] - M[1] * M[4];
    const PetscReal determinant = M[0] * xx + M[3] * xy + M[4] * xz;

    B[0] = xx / determinant;
    B[1] = (M[0] * M[2] - M[4] * M[4]) / determinant;
    B[2] = (M[0] * M[1] - M[3] * M[3]) / determinant;
    B[3] = xy / determinant;
    B[4] = xz / determinant;
    B[5] = (M[3] * M[4] - M[0] * M[5]) / determinant;
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

/* The sums over one row, without the scales of the kernel. */
typedef struct {
  PetscReal w, f[DIM], crowd[DIM], rr[6]; /* W; F r; F (1 + clump (W/W(d0))^4) r; -F r r */
} Sums;

static void SumRow(const Row *restrict row, const float *restrict w, PetscReal x, PetscReal y, PetscReal z,
                   PetscReal scale, Sums *out)
{
  const PetscInt m  = RowLanes(row);
  PetscReal      sw = 0, nx = 0, ny = 0, nz = 0, cx = 0, cy = 0, cz = 0, xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

  SIMD_LOOP(reduction(+ : sw, nx, ny, nz, cx, cy, cz, xx, yy, zz, xy, xz, yz))
  for (PetscInt k = 0; k < m; k++) {
    const PetscReal dx = x - row->x[4 * k], dy = y - row->x[4 * k + 1], dz = z - row->x[4 * k + 2], f = row->f[k];
    const PetscReal ratio = w[k] * scale, ratio2 = ratio * ratio, clump = CLUMP_WEIGHT * ratio2 * ratio2, fx = f * dx,
                    fy = f * dy, fz = f * dz;

    sw += w[k];
    nx += fx;
    ny += fy;
    nz += fz;
    cx += clump * fx;
    cy += clump * fy;
    cz += clump * fz;
    xx -= fx * dx;
    yy -= fy * dy;
    zz -= fz * dz;
    xy -= fx * dy;
    xz -= fx * dz;
    yz -= fy * dz;
  }
  *out = (Sums){.w = sw, .f = {nx, ny, nz}, .crowd = {nx + cx, ny + cy, nz + cz}, .rr = {xx, yy, zz, xy, xz, yz}};
}

/* w[k] of the row; zero behind its end. */
static void RowKernel(Kernel kernel, const Row *restrict row, PetscReal x, PetscReal y, PetscReal z,
                      PetscReal inverse_h2, float *restrict w)
{
  const PetscInt m = RowLanes(row);
  float          s[ROW_CAPACITY];

  SIMD_LOOP()
  for (PetscInt k = 0; k < m; k++) {
    const PetscReal dx = x - row->x[4 * k], dy = y - row->x[4 * k + 1], dz = z - row->x[4 * k + 2];

    s[k] = (float)((dx * dx + dy * dy + dz * dz) * inverse_h2);
  }
  KernelSingle(kernel, row->n, s, w, NULL);
  for (PetscInt k = row->n; k < m; k++) w[k] = 0;
}

PetscErrorCode OperatorsMoments(Cloud cloud)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], V = cloud->domain->volume, d2 = PetscSqr(cloud->domain->spacing),
                  self = KernelSelf(cloud->kernel);
  const PetscInt dim   = cloud->domain->dim;
  PetscReal      scale_w, scale_f, inverse_h2, at_spacing;
  float          w[ROW_CAPACITY];
  Row            row;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_MOMENTS), 0, 0, 0, 0));
  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  KernelEvaluate(cloud->kernel, 1, &d2, &at_spacing, NULL);
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    const PetscReal px = x[DIM * a], py = x[DIM * a + 1], pz = x[DIM * a + 2];
    PetscReal      *B = cloud->field[FIELD_MOMENT] + 6 * a, M[6], lambda;
    Sums            sums;

    RowLoad(cloud, a, &row);
    RowKernel(cloud->kernel, &row, px, py, pz, inverse_h2, w);
    SumRow(&row, w, px, py, pz, scale_w / at_spacing, &sums);
    for (PetscInt k = 0; k < 6; k++) M[k] = V * scale_f * sums.rr[k];
    lambda                         = SymmetricSmallestEigenvalue(dim, M);
    cloud->field[FIELD_LAMBDA][a]  = lambda;
    cloud->field[FIELD_DENSITY][a] = cloud->rest_density[a] * V * (self + scale_w * sums.w);
    for (PetscInt d = 0; d < DIM; d++) {
      cloud->field[FIELD_NORMAL][DIM * a + d]   = V * scale_f * sums.f[d];
      cloud->field[FIELD_CROWDING][DIM * a + d] = V * scale_f * sums.crowd[d];
    }
    if (lambda > MOMENT_MINIMUM)
      SymmetricInverse(dim, M, B);
    else {
      B[0] = B[1] = B[2] = 1;
      B[3] = B[4] = B[5] = 0;
    }
  }
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_MOMENTS), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
