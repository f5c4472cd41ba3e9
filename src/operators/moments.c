#include "operators.h"

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

PetscErrorCode OperatorsMoments(Cloud cloud)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *volume = cloud->volume, self = KernelSelf(cloud->kernel);
  const PetscInt   dim = cloud->domain->dim;
  PairRow          row;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_MOMENTS), 0, 0, 0, 0));
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    PetscReal sum = volume[a] * self, nx = 0, ny = 0, nz = 0, xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0,
              *B = cloud->field[FIELD_MOMENT] + 6 * a;

    PairRowLoad(cloud, x, a, &row);
    KernelEvaluate(cloud->kernel, row.n, row.r2, row.W, NULL);
    KernelGradient(cloud->kernel, row.n, row.r2, row.F);
    SIMD_LOOP(reduction(+ : sum, nx, ny, nz, xx, yy, zz, xy, xz, yz))
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscReal V = volume[row.index[k]], f = V * row.F[k], dx = row.dx[k], dy = row.dy[k], dz = row.dz[k];

      sum += V * row.W[k];
      nx += f * dx;
      ny += f * dy;
      nz += f * dz;
      xx -= f * dx * dx;
      yy -= f * dy * dy;
      zz -= f * dz * dz;
      xy -= f * dx * dy;
      xz -= f * dx * dz;
      yz -= f * dy * dz;
    }
    {
      const PetscReal M[6] = {xx, yy, zz, xy, xz, yz}, lambda = SymmetricSmallestEigenvalue(dim, M);

      cloud->field[FIELD_LAMBDA][a]           = lambda;
      cloud->field[FIELD_DENSITY][a]          = cloud->rest_density[a] * sum;
      cloud->field[FIELD_NORMAL][DIM * a]     = nx;
      cloud->field[FIELD_NORMAL][DIM * a + 1] = ny;
      cloud->field[FIELD_NORMAL][DIM * a + 2] = nz;
      if (lambda > MOMENT_MINIMUM)
        SymmetricInverse(dim, M, B);
      else {
        B[0] = B[1] = B[2] = 1;
        B[3] = B[4] = B[5] = 0;
      }
    }
  }
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_MOMENTS), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
