/* Divergence of a velocity field; sliding along walls does not count. */
#include "operators.h"

/* The part of a velocity u (m/s) that is normal to the wall of dummy particle b: in the directions of the faces it is
   behind, or along the normal of its solid. */
static inline void WallPart(Cloud cloud, PetscInt b, const PetscReal u[DIM], PetscReal part[DIM])
{
  const Domain     domain = cloud->domain;
  const PetscReal *x      = cloud->field[FIELD_POSITION] + DIM * b;

  if (cloud->solid_normal && cloud->integer[INT_BODY][b] <= BODY_SOLID) {
    const PetscReal *n = cloud->solid_normal + DIM * b, along = Dot(u, n);

    for (PetscInt d = 0; d < DIM; d++) part[d] = along * n[d];
    return;
  }
  for (PetscInt d = 0; d < DIM; d++)
    part[d] = (domain->face[d][0] == FACE_WALL && x[d] < domain->lower[d]) ||
                  (domain->face[d][1] == FACE_WALL && x[d] > domain->upper[d])
                ? u[d]
                : 0;
}

/* Takes from the velocity gradient G (rows: components of the velocity) of fluid particle a what walls gave it by
   sliding; without the scale of the kernel, as G. */
static void RemoveSliding(Cloud cloud, PetscInt a, const Row *row, const PetscReal velocity[], PetscReal G[DIM][DIM])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];

  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt b = row->index[k];
    PetscReal      u[DIM], part[DIM];

    if (!cloud->integer[INT_LAYER][b]) continue;
    for (PetscInt i = 0; i < DIM; i++) u[i] = velocity[DIM * b + i] - velocity[DIM * a + i];
    WallPart(cloud, b, u, part);
    for (PetscInt i = 0; i < DIM; i++)
      for (PetscInt j = 0; j < DIM; j++) G[i][j] -= (u[i] - part[i]) * row->f[k] * (x[DIM * a + j] - x[DIM * b + j]);
  }
}

/* sum (v_b - v_a).f r of a wall particle: the fluid only, its velocity normal to the wall only. */
static PetscReal WallDivergence(Cloud cloud, PetscInt a, const Row *row, const PetscReal velocity[])
{
  const PetscReal *x   = cloud->field[FIELD_POSITION];
  PetscReal        sum = 0;

  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt b = row->index[k];
    PetscReal      u[DIM], part[DIM];

    if (cloud->integer[INT_LAYER][b]) continue;
    for (PetscInt d = 0; d < DIM; d++) u[d] = velocity[DIM * b + d] - velocity[DIM * a + d];
    WallPart(cloud, a, u, part);
    for (PetscInt d = 0; d < DIM; d++) sum += row->f[k] * part[d] * (x[DIM * a + d] - x[DIM * b + d]);
  }
  return sum;
}

void OperatorsVelocityGradient(Cloud cloud, const Row *row, PetscInt a, const PetscReal velocity[],
                               PetscReal G[DIM][DIM])
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *v = velocity + DIM * a;
  const Triple     p = TripleLoad(x + DIM * a), vx = TripleSet(v[0]), vy = TripleSet(v[1]), vz = TripleSet(v[2]);
  Triple           gx = TripleSet(0), gy = gx, gz = gx;

  for (PetscInt k = 0; k < row->n; k++) {
    const PetscReal *u = velocity + DIM * row->index[k];
    const Triple     d = TripleSet(row->f[k]) * (p - TripleLoad(x + DIM * row->index[k]));

    gx += (TripleSet(u[0]) - vx) * d;
    gy += (TripleSet(u[1]) - vy) * d;
    gz += (TripleSet(u[2]) - vz) * d;
  }
  TripleStore(gx, G[0]);
  TripleStore(gy, G[1]);
  TripleStore(gz, G[2]);
}

/* tr (G B)^2 of a velocity gradient G without scale. */
static PetscReal SquareTrace(PetscReal G[DIM][DIM], const PetscReal B[6])
{
  PetscReal L[DIM][DIM], trace = 0;

  for (PetscInt i = 0; i < DIM; i++) TensorApply(B, G[i][0], G[i][1], G[i][2], L[i]);
  for (PetscInt i = 0; i < DIM; i++)
    for (PetscInt j = 0; j < DIM; j++) trace += L[i][j] * L[j][i];
  return trace;
}

PetscErrorCode OperatorsDivergence(Cloud cloud, const PetscReal velocity[], PetscBool corrected, PetscReal ahead,
                                   PetscReal div[])
{
  const PetscReal  identity[6] = {1, 1, 1, 0, 0, 0};
  const PetscReal *x           = cloud->field[FIELD_POSITION];
  PetscReal        scale_w, scale_f, inverse_h2, scale;
  Row              row;

  PetscFunctionBegin;
  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  scale = cloud->domain->volume * scale_f;
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    const PetscReal *B = corrected ? cloud->field[FIELD_MOMENT] + 6 * a : identity;
    PetscReal        G[DIM][DIM];

    RowLoad(cloud, a, &row);
    if (cloud->integer[INT_LAYER][a]) {
      div[a] = scale * WallDivergence(cloud, a, &row, velocity);
      continue;
    }
    /* the velocity gradient once, then B: div v = sum_ij G_ij B_ij */
    OperatorsVelocityGradient(cloud, &row, a, velocity, G);
    if (OperatorsNearWall(cloud, x + DIM * a)) RemoveSliding(cloud, a, &row, velocity, G);
    div[a] = scale * (B[0] * G[0][0] + B[1] * G[1][1] + B[2] * G[2][2] + B[3] * (G[0][1] + G[1][0]) +
                      B[4] * (G[0][2] + G[2][0]) + B[5] * (G[1][2] + G[2][1]));
    if (ahead > 0) div[a] -= ahead * scale * scale * SquareTrace(G, B);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
