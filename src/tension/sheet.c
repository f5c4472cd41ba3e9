/* Tension of sheets too thin for normals.

   The two sides of a sheet of one or two particles cancel in grad phi, and its edge looks like a flat surface. The
   surface S of a particle in it follows from phi itself: a sheet of thickness t has phi = t w1(0) in its middle and the
   surface 2 V/t for each particle, so S' = dS/dphi = -2 V w1(0)/phi^2. The energy sum_b sigma S(phi_b) gives

     V rho dv_a/dt = -sum_b (sigma_a S'_a + sigma_b S'_b) V grad W^H_ab,

   which is pairwise and central. A sheet of one particle pulls its edge back with 2 sigma per unit of length
   (cases/retracting_sheet). Four limits:
   - Where curvature.c resolves the sides, nothing may be added. phi is then that of a flat surface with the same
   |grad phi|, and S' fades out as phi approaches that value.
   - Where S' acts in full, curvature.c finds no normals in an even sheet. With the smallest displacements the normals
   at its edge turn from one side to the other within a particle: a curvature of 1/H, whose pressure would pull the edge
   a second time. This pressure is reduced by the fourth power of the share of S', so that it remains in sheets of two
   particles, where both act.
   - Below THICKNESS_SPRAY, where particles are nearly isolated, S' is constant.
   - In threads there is no S'. phi does not distinguish a thread from a thinner sheet, whose pull is 1.5 times as
   large, and with that pull threads would not break (Rayleigh). There is no reference for this; forces from a function
   of the density are those of many-body dissipative particle dynamics (Pagonabarraga and Frenkel 2001).

   Particles of different sizes: phi_b has the H of particle b and the volumes of its neighbours, and S_b its volume.
   The force of a pair is V_a times b's part, so b has V_a/V_b of the acceleration.

   Rings: S_b is that of the whole ring, so neighbour a has b's part times the length of ring b over the length of ring
   a. And phi_b falls as ring a grows, which gives sigma S'_a phi_a/(V rho r) towards the axis, the pull of a hoop. An
   isolated ring has no hoop pull, since in flight it is a row of droplets; the pull grows with the part of phi due to
   other rings, over that in a row of rings one spacing apart.

   By itself this force tears sheets: where particles crowd over less than the kernel's length, phi grows less than
   their number density. With w(k) the transform of W^H over the plane, 1 at k = 0, a wave dn/n of the number density
   has the energy 2 sigma (w^2 - w) (dn/n)^2 per area. That is negative, and the wave grows by a factor e in 0.5 ms at a
   thickness of 0.25 mm. So particles repel each other at a shorter range. With W_c, the kernel with SHEET_CORE H and
   the same integral over the plane, in

     grad W^H + P (grad W^H - grad W_c)

   instead of grad W^H, the energy becomes 2 sigma (w^2 - w + (w_c - w)) (dn/n)^2. Its minimum is -0.03 sigma instead of
   -0.5 sigma, and the crown of the drop impact stays whole. The pull of the edge does not change but for the difference
   of sums over a lattice to integrals (2 % of W_c). P projects onto the plane of the sheet at the thin particle of the
   pair: repulsion along the line between two particles would push particles out that have left the plane, and a row of
   particles would zigzag and break within a millisecond. Momentum is conserved exactly, angular momentum in a flat
   sheet. */
#include "curvature.h"

/* No references: chosen for this model. */
#define THICKNESS_SPRAY 0.41 /* in spacings; a thinner sheet would have more surface than its particles as spheres */
#define LACK_NONE       0.2  /* phi of a flat surface with this |grad phi|, less phi: below this no S', ... */
#define LACK_ALL        0.65 /* ... and above this all of it */
#define FLAT_NONE       0.2  /* second over largest moment of the neighbours: below this a thread, no S', ... */
#define FLAT_ALL        0.5  /* ... and above this a sheet, all of it */
#define MOMENT_LEAST    1e-4 /* added to the moments, relative to their trace, so that an even plane has a normal */

/* 0 for x below 'none', 1 above 'all', linear between. The factors SheetShare and Flatness are 3 t^2 - 2 t^3 of it. */
static PetscReal Ramp(PetscReal none, PetscReal all, PetscReal x)
{
  return PetscMin(1, PetscMax(0, (x - none) / (all - none)));
}

PetscReal SheetShare(Tension tension, const At *at, PetscReal phi, PetscReal gradient)
{
  const Curvature *data  = tension->data;
  const PetscReal  place = PetscMin(at->size * gradient / data->plane, 1) * WALL_TABLE;
  const PetscInt   k     = PetscMin((PetscInt)place, WALL_TABLE - 1);
  const PetscReal  flat  = data->fraction[k] + (place - k) * (data->fraction[k + 1] - data->fraction[k]),
                  t      = Ramp(LACK_NONE, LACK_ALL, flat - phi);

  return t * t * (3 - 2 * t);
}

PetscReal SheetSlope(Tension tension, const At *at, PetscReal phi)
{
  const Curvature *data = tension->data;
  const PetscReal  low  = PetscMax(phi, THICKNESS_SPRAY * data->plane * tension->spacing),
                  V_0   = PetscPowRealInt(tension->spacing, (int)tension->dim);

  return -2 * V_0 * data->plane / (at->size * low * low);
}

void SheetHoop(Tension tension, Cloud cloud, PetscInt a, PetscReal slope, PetscReal phi)
{
  const Curvature *data   = tension->data;
  const Domain     domain = cloud->domain;
  const PetscReal  V = domain->volume, self = V * KernelSelf(tension->kernel),
                  others = (phi - cloud->relative_weight[a] * self) / (data->plane * tension->spacing - self),
                  r      = cloud->length[a] / (2 * PETSC_PI);

  cloud->field[FIELD_ACCELERATION][DIM * a] +=
    slope * phi / (V * cloud->rest_density[a] * r) * PetscMax(0, PetscMin(1, others));
}

/* The second moments M = sum W r (x) r of the n collected neighbours of the particle. */
static void SecondMoments(Tension tension, const At *at, PetscInt n, PetscReal M[6])
{
  const SortedCells *liquid    = at->liquid;
  const PetscReal *restrict cx = liquid->near, *restrict cy = cx + liquid->stride, *restrict cz = cy + liquid->stride;
  const PetscReal *volume = liquid->near + WEIGHT_COLUMN * liquid->stride;
  PetscReal        xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0, w[CHUNK], scale_w, scale_f, inverse_h2;
  float            s[CHUNK], W[CHUNK];

  AtScales(at, tension->dim, tension->kernel, &scale_w, &scale_f, &inverse_h2);
  for (PetscInt begin = 0; begin < n; begin += CHUNK) {
    const PetscInt m = PetscMin(CHUNK, n - begin);

    Distances(at, begin, m, inverse_h2, s);
    KernelSingle(tension->kernel, m, s, W, NULL);
    /* weights stay double: those of rings differ by rounding between ranks, and the moments of a sheet are singular */
    for (PetscInt k = 0; k < m; k++) w[k] = tension->weighted ? W[k] * volume[begin + k] : W[k];
    SIMD_LOOP(reduction(+ : xx, yy, zz, xy, xz, yz))
    for (PetscInt k = 0; k < m; k++) {
      const PetscReal dx = cx[begin + k] - at->x[0], dy = cy[begin + k] - at->x[1], dz = cz[begin + k] - at->x[2];

      xx += w[k] * dx * dx;
      yy += w[k] * dy * dy;
      zz += w[k] * dz * dz;
      xy += w[k] * dx * dy;
      xz += w[k] * dx * dz;
      yz += w[k] * dy * dz;
    }
  }
  M[0] = xx;
  M[1] = yy;
  M[2] = zz;
  M[3] = xy;
  M[4] = xz;
  M[5] = yz;
}

/* The flatness of a neighbourhood with the second moments M, 0 for threads, 1 for sheets: from the ratio of the second
   to the largest eigenvalue, which is 1 in a sheet and at its edge and small in a thread. */
static PetscReal Flatness(PetscInt dim, const PetscReal M[6])
{
  PetscReal opposite[6], largest, t;

  if (dim == 2) return 1;
  for (PetscInt d = 0; d < 6; d++) opposite[d] = -M[d];
  largest = -SymmetricSmallestEigenvalue(DIM, opposite);
  if (largest <= 0) return 0; /* an isolated particle */
  t = (M[0] + M[1] + M[2] - SymmetricSmallestEigenvalue(DIM, M) - largest) / largest;
  t = Ramp(FLAT_NONE, FLAT_ALL, t);
  return t * t * (3 - 2 * t);
}

/* P = I - M^-1/tr M^-1 projects onto the plane of a sheet with the second moments M; for equal moments it is I less its
   mean. */
static void Project(PetscInt dim, const PetscReal M[6], PetscReal P[6])
{
  const PetscReal small = MOMENT_LEAST * (M[0] + M[1] + M[2]);
  PetscReal       regular[6], inverse[6], trace = 0;

  for (PetscInt d = 0; d < 6; d++) {
    regular[d] = M[d] + (d < DIM ? small : 0);
    P[d]       = d < DIM ? 1 : 0;
  }
  if (small <= 0) return;
  SymmetricInverse(dim, regular, inverse);
  for (PetscInt d = 0; d < dim; d++) trace += inverse[d];
  for (PetscInt d = 0; d < 6; d++) P[d] -= inverse[d] / trace;
}

/* Adds the pull of thin particle b on its neighbour a (pull: over their weights) to a's acceleration; adds a's reaction
   on b, times rho, to 'sum'. */
static void PullPair(Cloud cloud, PetscInt b, PetscInt a, const PetscReal pull[DIM], PetscReal sum[DIM])
{
  const PetscReal on_a = cloud->weight[b] * cloud->length[b] / (cloud->length[a] * cloud->rest_density[a]);

  for (PetscInt e = 0; e < DIM; e++) {
    sum[e] += cloud->weight[a] * pull[e];
    if (a < cloud->n_owned) cloud->field[FIELD_ACCELERATION][DIM * a + e] -= on_a * pull[e];
  }
}

/* Adds the pull of a thin particle on all n collected candidates, and their reactions. slope: sigma S'; P:
   see Project. Column 3 has the local indices. */
static void Pull(Tension tension, Cloud cloud, const At *at, PetscInt n, PetscReal slope, const PetscReal P[6])
{
  const Curvature   *data   = tension->data;
  const SortedCells *liquid = at->liquid;
  const PetscInt     b      = at->a;
  PetscReal         *out = cloud->field[FIELD_ACCELERATION], sum[DIM] = {0, 0, 0}, scale_w, scale_f, core_f, inverse_h2,
            core_h2;
  float s[CHUNK], F[CHUNK], core[CHUNK];

  AtScales(at, tension->dim, data->core, &scale_w, &core_f, &core_h2);
  AtScales(at, tension->dim, tension->kernel, &scale_w, &scale_f, &inverse_h2);
  for (PetscInt begin = 0; begin < n; begin += CHUNK) {
    const PetscInt m = PetscMin(CHUNK, n - begin);

    Distances(at, begin, m, core_h2, s);
    KernelSingle(data->core, m, s, NULL, core);
    Distances(at, begin, m, inverse_h2, s);
    KernelSingle(tension->kernel, m, s, NULL, F);
    for (PetscInt k = 0; k < m; k++) {
      const PetscReal *near = liquid->near + begin + k;
      const PetscInt   a    = (PetscInt)near[DIM * liquid->stride];
      const PetscReal  f = slope * scale_f * F[k], spread = f - slope * SHEET_CORE * core_f * core[k],
                      d[DIM] = {near[0] - at->x[0], near[liquid->stride] - at->x[1],
                                near[2 * liquid->stride] - at->x[2]};
      PetscReal pull[DIM];

      if (F[k] == 0) continue;
      TensorApply(P, d[0], d[1], d[2], pull);
      for (PetscInt e = 0; e < DIM; e++) pull[e] = f * d[e] + spread * pull[e];
      PullPair(cloud, b, a, pull, sum);
    }
  }
  if (b < cloud->n_owned)
    for (PetscInt e = 0; e < DIM; e++) out[DIM * b + e] += sum[e] / cloud->rest_density[b];
}

void SheetPlane(Tension tension, const At *at, PetscInt n, PetscReal *slope, PetscReal *share, PetscReal plane[6])
{
  PetscReal M[6], flatness;

  SecondMoments(tension, at, n, M);
  flatness = Flatness(tension->dim, M);
  *slope *= flatness;
  *share *= flatness;
  Project(tension->dim, M, plane);
}

/* Sorts the liquid around the thin particles of a level, ghosts too, if there are any. *count: their number. */
static PetscErrorCode SortThin(Tension tension, Cloud cloud, const Phase *phase, PetscInt level,
                               const PetscReal slope[], PetscInt *count)
{
  PetscInt      *thin;
  unsigned char *keep;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(cloud->n_total, &thin, cloud->n_total, &keep));
  *count = 0;
  for (PetscInt a = 0; a < cloud->n_total; a++)
    if (cloud->integer[INT_LAYER][a] == 0 && slope[a] != 0 && CloudLevel(cloud, a) == level) thin[(*count)++] = a;
  if (*count > 0) {
    PetscCall(LiquidAround(cloud, tension->largest[level] * KernelSupport(tension->kernel), *count, thin, keep));
    PetscCall(LiquidSort(tension, cloud, phase, level, keep));
  }
  PetscCall(PetscFree2(thin, keep));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the forces between the thin particles of a level, ghosts too, and all others. */
static PetscErrorCode PullAll(Tension tension, Cloud cloud, const Phase *phase, PetscInt level, const PetscReal slope[],
                              const PetscReal plane[])
{
  SortedCells *liquid = &tension->liquid[level];
  PetscInt     cell = -1, n = 0, thin = 0;

  PetscFunctionBegin;
  PetscCall(SortThin(tension, cloud, phase, level, slope, &thin));
  if (thin == 0) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < liquid->count; p++) liquid->sorted[DIM * liquid->count + p] = (PetscReal)liquid->index[p];
  for (PetscInt p = 0; p < liquid->count; p++) {
    const At       at = TensionAt(tension, cloud, level, p);
    const PetscInt a  = at.a;

    if (CloudLevel(cloud, a) != level || slope[a] == 0) continue;
    if (SortedCell(liquid, p) != cell) {
      cell = SortedCell(liquid, p);
      PetscCall(SortedCellsCollect(liquid, cell, COLUMNS(0, DIM + 1), 1, &n));
    }
    Pull(tension, cloud, &at, n, slope[a], plane + 6 * a);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SheetPull(Tension tension, Cloud cloud, const Phase *phase, PetscReal slope[], PetscReal plane[])
{
  PetscFunctionBegin;
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, slope));
  PetscCall(CloudUpdateArray(cloud, 6, PARITY_TENSOR, plane));
  for (PetscInt l = 0; l < tension->levels; l++) PetscCall(PullAll(tension, cloud, phase, l, slope, plane));
  PetscFunctionReturn(PETSC_SUCCESS);
}
