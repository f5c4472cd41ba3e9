/* The divergence of a velocity field. Sliding along walls does not count. */
#include "../neighbors/pairs.h"
#include "../scene/body.h"
#include "operators.h"

/* Cosines between the normal of a dummy particle, of either sign, and the direction to its liquid, below and above
   which the liquid does not cover its face and does. A sheet that leaves an edge along one of two faces has 0.71 at the
   edge and 0 behind the other face; it is the same to 0.1 % with a jump at 0.85 or 0.95. */
#define BARE    0.75
#define COVERED 0.9

/* bare[b] is 1 at dummy particles of solids whose faces the liquid does not cover, 0 where it does and at others.
   Liquid that leaves such a face, as a jet that passes an edge, opens a void, which is no liquid that expands. Counted
   as a divergence it is a suction at the edge, for any size of the step: a sheet that leaves a plate turns down by 7 %
   of its speed, and a slot jet is 33 % too wide with 5 spacings in half the slot. Faces of free bodies pull, since what
   moves them (OperatorsSolidDivergence) is linear in their velocity. Ghosts, too; collective. */
static PetscErrorCode FindBare(Cloud cloud, PetscReal bare[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];
  PairRow          row;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(bare, cloud->n_total));
  if (!cloud->solid_normal) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = cloud->n_fluid; b < cloud->n_owned; b++) {
    const PetscInt body   = cloud->integer[INT_BODY][b];
    PetscReal      m[DIM] = {0, 0, 0};

    if (body > BODY_SOLID || SceneSolid(cloud->scene, BODY_SOLID - body)->free) continue;
    PairRowLoadFactors(cloud, b, &row);
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt a = row.index[k];

      for (PetscInt d = 0; d < DIM && !cloud->integer[INT_LAYER][a]; d++)
        m[d] += row.f[k] * (x[DIM * b + d] - x[DIM * a + d]);
    }
    if (Norm(m) > 0)
      bare[b] =
        PetscClipInterval((COVERED - PetscAbsReal(Dot(m, cloud->solid_normal + DIM * b)) / Norm(m)) / (COVERED - BARE),
                          0, 1);
  }
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, bare));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The part of a velocity u (m/s) normal to the wall of dummy particle b. For a wall of the box: the components in the
   directions in which b is behind a face. For a solid: the component along its normal, none at a bare face. */
static inline void WallPart(Cloud cloud, const PetscReal bare[], PetscInt b, const PetscReal u[DIM],
                            PetscReal part[DIM])
{
  const Domain     domain = cloud->domain;
  const PetscReal *x      = cloud->field[FIELD_POSITION] + DIM * b;

  if (cloud->solid_normal && cloud->integer[INT_BODY][b] <= BODY_SOLID) {
    const PetscReal *n = cloud->solid_normal + DIM * b, along = (1 - bare[b]) * Dot(u, n);

    for (PetscInt d = 0; d < DIM; d++) part[d] = along * n[d];
    return;
  }
  for (PetscInt d = 0; d < DIM; d++)
    part[d] = (domain->face[d][0] == FACE_WALL && x[d] < domain->lower[d]) ||
                  (domain->face[d][1] == FACE_WALL && x[d] > domain->upper[d])
                ? u[d]
                : 0;
}

/* Removes all contributions of walls from the velocity gradient G of fluid particle a, and the tangential contributions
   from its copy 'no_sliding'. Row i belongs to velocity component i; both are divided by V scale_f (KernelScales). */
static void RemoveWalls(Cloud cloud, const PetscReal bare[], PetscInt a, const PairRow *row, const PetscReal velocity[],
                        PetscReal G[DIM * DIM], PetscReal no_sliding[DIM * DIM])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];

  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt b = row->index[k];
    PetscReal      u[DIM], part[DIM];

    if (!cloud->integer[INT_LAYER][b]) continue;
    for (PetscInt i = 0; i < DIM; i++) u[i] = velocity[DIM * b + i] - velocity[DIM * a + i];
    WallPart(cloud, bare, b, u, part);
    for (PetscInt i = 0; i < DIM; i++)
      for (PetscInt j = 0; j < DIM; j++) {
        const PetscReal fr = row->f[k] * (x[DIM * a + j] - x[DIM * b + j]);

        G[DIM * i + j] -= u[i] * fr;
        no_sliding[DIM * i + j] -= (u[i] - part[i]) * fr;
      }
  }
}

/* sum f (v_b - v_a).r_ab of a wall particle, or of liquid that pushes, over its neighbours in the liquid that is free;
   of a wall with the velocity normal to it. */
static PetscReal WallDivergence(Cloud cloud, const PetscReal bare[], PetscInt a, const PairRow *row,
                                const PetscReal velocity[])
{
  const PetscReal *x   = cloud->field[FIELD_POSITION];
  PetscReal        sum = 0;

  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt b = row->index[k];
    PetscReal      u[DIM], part[DIM];

    if (CloudBounds(cloud, b)) continue;
    for (PetscInt d = 0; d < DIM; d++) part[d] = u[d] = velocity[DIM * b + d] - velocity[DIM * a + d];
    if (cloud->integer[INT_LAYER][a]) WallPart(cloud, bare, a, u, part);
    for (PetscInt d = 0; d < DIM; d++) sum += row->f[k] * part[d] * (x[DIM * a + d] - x[DIM * b + d]);
  }
  return sum;
}

/* G_ij = sum f (v_b - v_a)_i (r_ab)_j over the row of a. Returns the largest |v_b - v_a|^2. */
static inline PetscReal VelocityGradient(PetscBool flat, Cloud cloud, const PairRow *row, PetscInt a,
                                         const PetscReal velocity[], PetscReal G[DIM * DIM])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];
  const Simd3      p = Simd3Set(x + DIM * a), v = Simd3Set(velocity + DIM * a);
  const Simd       zero = SimdSet(0);
  Simd3            gx = {zero, zero, zero}, gy = gx, gz = gx;
  Simd             most    = zero;
  PetscReal        largest = 0;

  for (PetscInt k = 0; k < row->n; k += SIMD_WIDTH) {
    const SimdOffsets at = SimdLocate(row->index + k);
    const Simd3       d  = Simd3Difference(flat, p, Simd3Collect(flat, x, &at)),
                w        = Simd3Difference(flat, Simd3Collect(flat, velocity, &at), v);
    const Simd f = SimdLoad(row->f + k), w2 = SimdFirst(Simd3Dot(flat, w, w), row->n - k);

    Simd3Add(flat, &gx, f * w.x, d);
    Simd3Add(flat, &gy, f * w.y, d);
    if (!flat) Simd3Add(flat, &gz, f * w.z, d);
    most = SimdMax(most, w2);
  }
  if (flat) {
    const Vec4 g = SimdSums(gx.x, gx.y, gy.x, gy.y);

    for (PetscInt k = 0; k < DIM * DIM; k++) G[k] = 0;
    G[0] = g[0];
    G[1] = g[1];
    G[3] = g[2];
    G[4] = g[3];
  } else {
    Vec4Store(Simd3Sum(gx, zero), G);
    Vec4Store(Simd3Sum(gy, zero), G + DIM);
    Vec4Store(Simd3Sum(gz, zero), G + 2 * DIM);
  }
  for (PetscInt k = 0; k < SIMD_WIDTH; k++) largest = PetscMax(largest, most[k]);
  return largest;
}

/* The divergence of a ring's growth, v_r/r, with time_offset (s) as in OperatorsDivergence. Within half a spacing of
   the axis it approaches its limit, the slope of v_r, since v_r/r amplifies errors at small r. G is divided by 'scale'.
   Not inlined: else the compiler rounds the sums of scenes without rings differently. */
__attribute__((noinline)) static PetscReal HoopDivergence(Domain domain, PetscReal size, PetscReal r, PetscReal v_r,
                                                          PetscReal scale, const PetscReal G[DIM * DIM],
                                                          const PetscReal B[6], PetscReal time_offset)
{
  const PetscReal short2 = PetscMax(0, PetscSqr(0.5 * domain->spacing * size) - r * r),
                  slope  = scale * (B[0] * G[0] + B[3] * G[1] + B[4] * G[2]),
                  hoop   = (r * v_r + short2 * slope) / (r * r + short2);

  return hoop - time_offset * hoop * hoop;
}

/* tr (G B)^2 of a velocity gradient G and a correction B. */
static PetscReal SquareTrace(const PetscReal G[DIM * DIM], const PetscReal B[6])
{
  PetscReal L[DIM][DIM], trace = 0;

  for (PetscInt i = 0; i < DIM; i++) TensorApply(B, G[DIM * i], G[DIM * i + 1], G[DIM * i + 2], L[i]);
  for (PetscInt i = 0; i < DIM; i++)
    for (PetscInt j = 0; j < DIM; j++) trace += L[i][j] * L[j][i];
  return trace;
}

PetscErrorCode OperatorsDivergence(Cloud cloud, const PetscReal velocity[], PetscBool corrected, PetscReal time_offset,
                                   PetscReal div[], PetscReal gradient[], PetscReal jump[])
{
  const PetscReal  identity[6] = {1, 1, 1, 0, 0, 0};
  const PetscReal *x           = cloud->field[FIELD_POSITION];
  PetscReal        scale_w, scale_f, inverse_h2, scale, *bare;
  PairRow          row;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, 1, &bare));
  PetscCall(FindBare(cloud, bare));
  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  scale = cloud->domain->volume * scale_f;
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    const PetscReal *B = corrected ? cloud->field[FIELD_CORRECTION] + 6 * a : identity;
    PetscReal        own[DIM * DIM], *G = gradient ? gradient + DIM * DIM * a : own, no_sliding[DIM * DIM], jump2;

    PairRowLoadFactors(cloud, a, &row);
    if (cloud->integer[INT_LAYER][a]) {
      if (div) div[a] = scale * WallDivergence(cloud, bare, a, &row, velocity);
      continue;
    }
    jump2 = cloud->domain->dim == 2 ? VelocityGradient(PETSC_TRUE, cloud, &row, a, velocity, G)
                                    : VelocityGradient(PETSC_FALSE, cloud, &row, a, velocity, G);
    if (jump) jump[a] = PetscSqrtReal(jump2);
    for (PetscInt k = 0; k < DIM * DIM; k++) no_sliding[k] = G[k];
    if (OperatorsNearWall(cloud, x + DIM * a)) RemoveWalls(cloud, bare, a, &row, velocity, G, no_sliding);
    for (PetscInt k = 0; k < DIM * DIM; k++) G[k] *= scale;
    if (!div) continue;
    if (CloudPushes(cloud, a)) {
      div[a] = scale * WallDivergence(cloud, bare, a, &row, velocity);
      continue;
    }
    div[a] = scale * (B[0] * no_sliding[0] + B[1] * no_sliding[4] + B[2] * no_sliding[8] +
                      B[3] * (no_sliding[1] + no_sliding[3]) + B[4] * (no_sliding[2] + no_sliding[6]) +
                      B[5] * (no_sliding[5] + no_sliding[7]));
    if (time_offset > 0) div[a] -= time_offset * scale * scale * SquareTrace(no_sliding, B);
    if (cloud->domain->rings)
      div[a] +=
        HoopDivergence(cloud->domain, cloud->size[a], x[DIM * a], velocity[DIM * a], scale, no_sliding, B, time_offset);
  }
  PetscCall(CloudRestoreWork(cloud, &bare));
  PetscCall(LogPairFlops(cloud->first[cloud->n_owned], 33));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The part of a velocity of b normal to the wall is n (n.u), so that this is a sum of (B r_ab . n) n.u. */
void OperatorsSolidDivergence(Cloud cloud, PetscInt a, PetscInt body, const PetscReal center[DIM],
                              PetscReal slope[RIGID_MOTIONS])
{
  const PetscBool  dummy = (PetscBool)(cloud->integer[INT_LAYER][a] > 0);
  const PetscReal *x = cloud->field[FIELD_POSITION], *B = cloud->field[FIELD_CORRECTION] + 6 * a;
  PetscReal        scale_w, scale_f, inverse_h2;
  PairRow          row;

  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  for (PetscInt k = 0; k < RIGID_MOTIONS; k++) slope[k] = 0;
  PairRowLoadFactors(cloud, a, &row);
  for (PetscInt k = 0; k < row.n; k++) {
    const PetscInt   b = row.index[k], of = dummy ? a : b;
    const PetscReal *n = cloud->solid_normal + DIM * of;
    PetscReal        r[DIM], arm[DIM], translation[DIM], rotation[DIM], flux;

    if (dummy ? cloud->integer[INT_LAYER][b] > 0 : cloud->integer[INT_BODY][b] != body) continue;
    for (PetscInt d = 0; d < DIM; d++) {
      r[d]   = x[DIM * a + d] - x[DIM * b + d];
      arm[d] = x[DIM * of + d] - center[d];
    }
    DomainNearest(cloud->domain, arm);
    if (!dummy) {
      PetscReal corrected[DIM];

      TensorApply(B, r[0], r[1], r[2], corrected);
      for (PetscInt d = 0; d < DIM; d++) r[d] = corrected[d];
    }
    flux = (dummy ? -1 : 1) * cloud->domain->volume * scale_f * row.f[k] * Dot(n, r);
    for (PetscInt d = 0; d < DIM; d++) translation[d] = flux * n[d];
    Cross(arm, translation, rotation);
    for (PetscInt d = 0; d < DIM; d++) {
      slope[d] += translation[d];
      slope[DIM + d] += rotation[d];
    }
  }
}
