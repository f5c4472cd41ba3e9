/* Rows without walls. */
#include "liquid_row.h"
#include "operators.h"

void LiquidRowLoad(Cloud cloud, PetscInt a, LiquidRow *out)
{
  const PetscReal *x    = cloud->field[FIELD_POSITION];
  PetscReal        M[6] = {0}, scale, scale_w, inverse_h2;
  PairRow          row;

  KernelScales(cloud->kernel, &scale_w, &scale, &inverse_h2);
  scale *= cloud->domain->volume;
  PairRowLoadFactors(cloud, a, &row);
  out->n = 0;
  for (PetscInt k = 0; k < row.n; k++) {
    const PetscInt  b = row.index[k];
    const PetscReal f = scale * row.f[k];
    PetscReal      *d = out->d[out->n];

    if (cloud->integer[INT_LAYER][b]) continue;
    for (PetscInt i = 0; i < DIM; i++) d[i] = x[DIM * a + i] - x[DIM * b + i];
    for (PetscInt i = 0; i < DIM; i++) M[i] -= f * d[i] * d[i];
    M[3] -= f * d[0] * d[1];
    M[4] -= f * d[0] * d[2];
    M[5] -= f * d[1] * d[2];
    out->index[out->n] = b;
    out->f[out->n++]   = f;
  }
  for (PetscInt m = 0; m < 6; m++) out->B[m] = m < DIM;
  out->enough = (PetscBool)(SymmetricSmallestEigenvalue(cloud->domain->dim, M) > MOMENT_MINIMUM);
  if (out->enough) SymmetricInverse(cloud->domain->dim, M, out->B);
}
