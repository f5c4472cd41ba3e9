/* Rotation matrices. */
#include "bodies_impl.h"

/* Rodrigues' formula. */
void RotationMatrix(const PetscReal rate[DIM], PetscReal time, PetscReal turn[DIM][DIM])
{
  const PetscReal size = Norm(rate), c = PetscCosReal(size * time), s = PetscSinReal(size * time);
  PetscReal       n[DIM] = {0, 0, 0};

  for (PetscInt d = 0; d < DIM && size > 0; d++) n[d] = rate[d] / size;
  for (PetscInt i = 0; i < DIM; i++)
    for (PetscInt j = 0; j < DIM; j++) {
      const PetscInt k = DIM - i - j; /* the third direction, where i and j differ */

      turn[i][j] = (1 - c) * n[i] * n[j] + (i == j ? c : 0);
      if (i != j) turn[i][j] += ((j - i + DIM) % DIM == 1 ? -1 : 1) * s * n[k];
    }
}

void RotationMultiply(PetscReal A[DIM][DIM], PetscReal B[DIM][DIM], PetscReal out[DIM][DIM])
{
  for (PetscInt i = 0; i < DIM; i++)
    for (PetscInt j = 0; j < DIM; j++) {
      out[i][j] = 0;
      for (PetscInt k = 0; k < DIM; k++) out[i][j] += A[i][k] * B[k][j];
    }
}

/* The rows of the inverse, times the determinant, are cross products of the columns. */
void RotationInverse(PetscReal A[DIM][DIM], PetscReal out[DIM][DIM])
{
  PetscReal column[DIM][DIM], determinant;

  for (PetscInt i = 0; i < DIM; i++)
    for (PetscInt j = 0; j < DIM; j++) column[j][i] = A[i][j];
  for (PetscInt i = 0; i < DIM; i++) Cross(column[(i + 1) % DIM], column[(i + 2) % DIM], out[i]);
  determinant = Dot(column[0], out[0]);
  for (PetscInt i = 0; i < DIM; i++)
    for (PetscInt j = 0; j < DIM; j++) out[i][j] /= determinant;
}

void RotationStraighten(PetscReal turn[DIM][DIM])
{
  PetscReal length = Norm(turn[0]), along;

  for (PetscInt d = 0; d < DIM; d++) turn[0][d] /= length;
  along = Dot(turn[0], turn[1]);
  for (PetscInt d = 0; d < DIM; d++) turn[1][d] -= along * turn[0][d];
  length = Norm(turn[1]);
  for (PetscInt d = 0; d < DIM; d++) turn[1][d] /= length;
  Cross(turn[0], turn[1], turn[2]);
}

/* The antisymmetric part of R is sin(angle) times the axis; the trace is 1 + 2 cos(angle). */
void RotationVector(PetscReal turn[DIM][DIM], PetscReal angle[DIM])
{
  const PetscReal cosine = 0.5 * (turn[0][0] + turn[1][1] + turn[2][2] - 1);
  PetscReal       sine, size;

  for (PetscInt d = 0; d < DIM; d++) {
    const PetscInt e = (d + 1) % DIM, f = (d + 2) % DIM;

    angle[d] = 0.5 * (turn[f][e] - turn[e][f]);
  }
  sine = Norm(angle);
  size = atan2(sine, cosine);
  for (PetscInt d = 0; d < DIM; d++) angle[d] *= sine > 0 ? size / sine : 1;
}
