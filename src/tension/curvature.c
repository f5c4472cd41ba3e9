/* Surface tension as a pressure on the free surface, sigma times its curvature.

   The outward normal is n = -grad phi/|grad phi| of phi = sum V W^H over the liquid. Near the surface, where |grad phi|
   is large, the curvature tensor K = grad n is the slope of a weighted linear fit, with intercept, to the normals
   nearby that point to the same side of the liquid. K is projected onto the tangent plane. Its eigenvalues k are those
   of a parallel surface at the fit's mean depth s below the free surface; k/(1 + s k) are those of the free surface.
   FIELD_CAPILLARY is the mean of sigma (k1 + k2) over the neighbours, FIELD_BENDING |k1| + |k2| itself. The pressure
   solver uses it on the free surface in place of p = 0. A drop of constant curvature is then at rest exactly, because
   closure and gradient depend on p - sigma kappa only. The depth follows from phi = F(s) of a half-space; a curved
   surface lowers phi by kappa/2 int x^2 W dA.

   For a surface of revolution the planar fit gives one principal curvature. The other is n_r/r: the slope of the line
   through the axis that fits n_r best, with the weights of the planar fit. Rings are weighted with their volume, at the
   middle between the two rings: W A |r_a + r_b|/2.

   Walls are mirrors: images continue the liquid and its normals behind them (contact.c), so that the surface meets the
   wall at the contact angle. */
#include <float.h>

#include "../base/simd.h"
#include "curvature.h"

/* Least |grad phi| H of a particle with a normal: 0.9 H below a flat surface. No reference. */
#define THRESHOLD 0.2
/* Least n_a . n_b of normals on the same side of the liquid, which excludes the other side of a sheet. No reference. */
#define SAME_SIDE 0.2
/* Least 1 + s k with which a curvature at the depth s is carried to the surface. No reference. */
#define THINNEST   0.3
#define SHARPENING 2 /* S of Sharpen, which has the measurement */
#define ROUNDS     5 /* steps of Newton's method in Together */
/* Least number of normals of a fit: one more than it has coefficients. */
#define FEWEST_NORMALS (DIM + 2)
/* Added to the fit's matrix, relative to its trace, so that normals along a line give no NaN. */
#define REGULARITY 1e-6
/* Least spread of the places of a fit in any direction, spacings: each side of a sheet of three particles has one row
   of normals, which are displaced by thousandths of a spacing and say nothing of what is below them. A slope fitted to
   that pulled the corners of a strip with 70 times its tension. From 0.02 to 0.3 nothing changes. */
#define LEAST_SPREAD 0.05
/* Largest distance of a particle outside the liquid, spacings. */
#define LARGEST_OUTSIDE 0.5
#define ROOM            (CHUNK + WIDE) /* for a chunk, whose last vector may go beyond its end */
#define BELOW_ONE       (1 - 1e-9)

/* The depth (m) below a flat surface of a particle with this phi; it is negative outside. */
static PetscReal FlatDepth(Tension tension, PetscReal phi)
{
  const Curvature *data  = tension->data;
  const PetscReal  place = PetscMin(2 * phi - 1, BELOW_ONE) * WALL_TABLE;
  const PetscInt   k     = (PetscInt)place;

  if (place < 0) return PetscMax((phi - 0.5) / data->plane, -LARGEST_OUTSIDE * tension->spacing);
  return data->depth[k] + (place - k) * (data->depth[k + 1] - data->depth[k]);
}

/* The neighbours of a particle in a chunk of the collected candidates. The candidates serve all particles of a cell; a
   quarter to a half of them is within a particle's support, and the kernel is evaluated for these alone. */
typedef struct {
  int32_t place[ROOM];        /* among the collected candidates, ascending */
  float   s[ROOM];            /* |x - c|^2/H^2 */
  float   W[CHUNK], F[CHUNK]; /* of the kernel */
} Neighbors;

/* Finds the neighbours among the m <= CHUNK collected candidates from 'begin' on, with distances s ([ROOM]). Returns
   their number. */
static PetscInt FindNeighbors(Tension tension, PetscInt begin, PetscInt m, float s[], Neighbors *near)
{
  const Wide limit = WideSet((float)PetscSqr(KernelSupport(tension->kernel) / KernelSmoothingLength(tension->kernel)));
  PetscInt   n     = 0;

  for (PetscInt k = m; k < m + WIDE; k++) s[k] = FLT_MAX; /* fills the last vector */
  for (PetscInt k = 0; k < m; k += WIDE) {
    const Wide     wide = WideLoad(s + k);
    const WideKept kept = WideKeep(WideBelow(wide, limit), WIDE);

    WidePack(kept, wide, near->s + n);
    WidePackIntegers(kept, WideCounting((int32_t)(begin + k)), near->place + n);
    n += WideCount(kept);
  }
  return n;
}

/* Evaluates W, and F if wanted, of n neighbours, times the relative volumes of graded particles and images. */
static void EvaluateNeighbors(Tension tension, const At *at, const Around *around, PetscInt n, PetscBool wants_f,
                              Neighbors *near)
{
  const Curvature *data   = tension->data;
  const PetscReal *volume = at->liquid->near + WEIGHT_COLUMN * at->liquid->stride;

  KernelSingle(tension->kernel, n, near->s, near->W, wants_f ? near->F : NULL);
  for (PetscInt k = 0; k < n && tension->weighted; k++) {
    const float v = (float)volume[near->place[k]];

    near->W[k] *= v;
    if (wants_f) near->F[k] *= v;
  }
  for (PetscInt k = n - 1; k >= 0 && near->place[k] >= around->real && data->images.used; k--) {
    const float image = ImagesVolume(tension, at, near->place[k]);

    near->W[k] *= image;
    if (wants_f) near->F[k] *= image;
  }
}

/* Multiplies W of n neighbours by the distance from the axis of the middle between them and the particle. */
static void WeighMiddles(Tension tension, const At *at, PetscInt n, Neighbors *near)
{
  const PetscReal *r = at->liquid->near;

  for (PetscInt k = 0; k < n; k++)
    near->W[k] *= (float)(0.5 * PetscAbsReal(at->x[0] + r[near->place[k]]) / tension->spacing);
}

/* Adds phi and grad phi at the particle of the collected candidates first to n - 1, without V. */
static void SumPhase(Tension tension, const At *at, const Around *around, PetscInt first, PetscInt n, PetscReal *phi,
                     PetscReal gradient[DIM])
{
  const PetscReal *restrict cx = at->liquid->near, *restrict cy = cx + at->liquid->stride,
                            *restrict cz = cy + at->liquid->stride;
  const PetscReal x0 = at->x[0], y0 = at->x[1], z0 = at->x[2];
  PetscReal       sum = 0, gx = 0, gy = 0, gz = 0, scale_w, scale_f, inverse_h2;
  float           s[ROOM];
  Neighbors       near;

  AtScales(at, tension->dim, tension->kernel, &scale_w, &scale_f, &inverse_h2);
  for (PetscInt begin = first; begin < n; begin += CHUNK) {
    const PetscInt m = PetscMin(CHUNK, n - begin);
    PetscInt       l;

    Distances(at, begin, m, inverse_h2, s);
    l = FindNeighbors(tension, begin, m, s, &near);
    EvaluateNeighbors(tension, at, around, l, PETSC_TRUE, &near);
    SIMD_LOOP(reduction(+ : sum, gx, gy, gz))
    for (PetscInt k = 0; k < l; k++) {
      const PetscInt b = near.place[k];

      sum += near.W[k];
      gx += near.F[k] * (x0 - cx[b]);
      gy += near.F[k] * (y0 - cy[b]);
      gz += near.F[k] * (z0 - cz[b]);
    }
  }
  *phi += scale_w * sum;
  gradient[0] += scale_f * gx;
  gradient[1] += scale_f * gy;
  gradient[2] += scale_f * gz;
}

/* phi and grad phi at the particle, from all collected candidates, without V. full: |grad phi| of a
   particle near the surface. Images moved by less than the contact angle requires do not continue the surface straight.
   So their part of grad phi normal to the wall is corrected to that of a straight surface: by 1/residual_tan times
   their part along the wall. */
static void SumMirrored(Tension tension, const At *at, const Around *around, PetscReal full, PetscReal *phi,
                        PetscReal g[DIM])
{
  PetscReal of[2 * DIM + 1][DIM], turn[2 * DIM + 1], inward[2 * DIM + 1][DIM], outward[DIM];

  *phi = g[0] = g[1] = g[2] = 0;
  SumPhase(tension, at, around, 0, around->real, phi, g);
  for (PetscInt d = 0; d < DIM; d++) outward[d] = -g[d];
  ImagesTilt(tension, at, around, outward, full);
  for (PetscInt k = 0; k < around->images; k++) {
    of[k][0] = of[k][1] = of[k][2] = 0;
    SumPhase(tension, at, around, around->image[k].begin, around->image[k].end, phi, of[k]);
    for (PetscInt d = 0; d < DIM; d++) g[d] += of[k][d];
  }
  for (PetscInt k = 0; k < around->images; k++) {
    ContactAngle    contact;
    const PetscBool found = ImagesAngle(tension, at, &around->image[k], inward[k], &contact);
    PetscReal       flat[DIM], along, into = Dot(g, inward[k]);

    for (PetscInt d = 0; d < DIM; d++) flat[d] = g[d] - into * inward[k][d];
    along   = Dot(of[k], flat);
    turn[k] = found && along > 0 ? 2 * along / (Norm(flat) * contact.residual_tan) : 0;
  }
  for (PetscInt k = 0; k < around->images; k++)
    for (PetscInt d = 0; d < DIM && turn[k] != 0; d++) g[d] -= turn[k] * inward[k][d];
}

/* Weighted sums over the collected normals that point to the same side as that of the particle. */
typedef struct {
  PetscInt  kept;           /* neighbours */
  PetscReal count, w;       /* number of normals; sum of weights */
  PetscReal x[DIM], n[DIM]; /* sums of positions relative to the particle; of normals */
  PetscReal s;              /* depths */
  PetscReal xx[6];          /* of products of positions: xx yy zz xy xz yz */
  PetscReal nx[DIM][DIM];   /* of products of normals and positions */
} Moments;

/* weight, place: [around->n] of the out->kept neighbours whose normals point to the same side. The loop is long because
   all sums share it. */
static void SumNormals(Tension tension, const At *at, const Around *around, const PetscReal n[DIM],
                       float *restrict weight, int32_t *restrict place, Moments *out)
{
  const PetscInt stride        = at->liquid->stride;
  const PetscReal *restrict cx = at->liquid->near, *restrict cy = cx + stride, *restrict cz = cy + stride,
                            *restrict nx = cz + stride, *restrict ny = nx + stride, *restrict nz = ny + stride,
                            *restrict depth = nz + stride;
  const PetscReal same_side = SAME_SIDE, x0 = at->x[0], y0 = at->x[1], z0 = at->x[2], ax = n[0], ay = n[1], az = n[2];
  PetscReal       scale_w, scale_f, inverse_h2;
  float           s[ROOM];
  Neighbors       near;
  PetscInt        kept  = 0;
  PetscReal       count = 0, sw = 0, sx = 0, sy = 0, sz = 0, px = 0, py = 0, pz = 0, ss = 0;
  PetscReal       xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
  PetscReal       qxx = 0, qxy = 0, qxz = 0, qyx = 0, qyy = 0, qyz = 0, qzx = 0, qzy = 0, qzz = 0;

  AtScales(at, tension->dim, tension->kernel, &scale_w, &scale_f, &inverse_h2);
  for (PetscInt begin = 0; begin < around->n; begin += CHUNK) {
    const PetscInt m = PetscMin(CHUNK, around->n - begin);
    PetscInt       l;

    Distances(at, begin, m, inverse_h2, s);
    SIMD_LOOP()
    for (PetscInt k = 0; k < m; k++)
      s[k] = ax * nx[begin + k] + ay * ny[begin + k] + az * nz[begin + k] > same_side ? s[k] : FLT_MAX;
    l = FindNeighbors(tension, begin, m, s, &near);
    EvaluateNeighbors(tension, at, around, l, PETSC_FALSE, &near);
    if (tension->rings) WeighMiddles(tension, at, l, &near);
    /* clang-format off */
    SIMD_LOOP(reduction(+ : count, sw, sx, sy, sz, px, py, pz, ss, xx, yy, zz, xy, xz, yz) \
              reduction(+ : qxx, qxy, qxz, qyx, qyy, qyz, qzx, qzy, qzz))
    /* clang-format on */
    for (PetscInt k = 0; k < l; k++) {
      const PetscInt  b  = near.place[k];
      const PetscReal w  = near.W[k];
      const PetscReal dx = cx[b] - x0, dy = cy[b] - y0, dz = cz[b] - z0;
      const PetscReal wx = w * dx, wy = w * dy, wz = w * dz;

      weight[kept + k] = near.W[k];
      place[kept + k]  = near.place[k];
      count += w > 0 ? 1 : 0;
      sw += w;
      sx += wx;
      sy += wy;
      sz += wz;
      px += w * nx[b];
      py += w * ny[b];
      pz += w * nz[b];
      ss += w * depth[b];
      xx += wx * dx;
      yy += wy * dy;
      zz += wz * dz;
      xy += wx * dy;
      xz += wx * dz;
      yz += wy * dz;
      qxx += wx * nx[b];
      qxy += wy * nx[b];
      qxz += wz * nx[b];
      qyx += wx * ny[b];
      qyy += wy * ny[b];
      qyz += wz * ny[b];
      qzx += wx * nz[b];
      qzy += wy * nz[b];
      qzz += wz * nz[b];
    }
    kept += l;
  }
  *out = (Moments){.kept  = kept,
                   .count = count,
                   .w     = sw,
                   .x     = {sx, sy, sz},
                   .n     = {px, py, pz},
                   .s     = ss,
                   .xx    = {xx, yy, zz, xy, xz, yz},
                   .nx    = {{qxx, qxy, qxz}, {qyx, qyy, qyz}, {qzx, qzy, qzz}}};
}

/* Prepares a linear fit to values at the collected positions whose normals point to the same side. */
static void PrepareFit(Tension tension, const At *at, const Moments *m, NormalFit *fit)
{
  PetscReal M[6];

  fit->count     = m->kept;
  fit->enough    = (PetscBool)(m->count >= FEWEST_NORMALS);
  fit->inverse_w = m->w > 0 ? 1 / m->w : 0;
  for (PetscInt d = 0; d < DIM; d++) fit->x[d] = m->x[d] * fit->inverse_w;
  if (!fit->enough) return;
  M[0] = m->xx[0] - m->x[0] * m->x[0] / m->w;
  M[1] = m->xx[1] - m->x[1] * m->x[1] / m->w;
  M[2] = m->xx[2] - m->x[2] * m->x[2] / m->w;
  M[3] = m->xx[3] - m->x[0] * m->x[1] / m->w;
  M[4] = m->xx[4] - m->x[0] * m->x[2] / m->w;
  M[5] = m->xx[5] - m->x[1] * m->x[2] / m->w;
  {
    const PetscReal least = m->w * PetscSqr(LEAST_SPREAD * at->size * tension->spacing),
                    lacks = least - SymmetricSmallestEigenvalue(tension->dim, M),
                    small = PetscMax(REGULARITY * (M[0] + M[1] + M[2]), lacks);

    for (PetscInt d = 0; d < DIM; d++) M[d] += small;
    SymmetricInverse(tension->dim, M, fit->B);
  }
}

/* Carries the principal curvatures k1 and k2 (1/m) of a surface at 'depth' (m) to the parallel free surface; returns
   their sum. */
static PetscReal CarryToSurface(PetscReal k1, PetscReal k2, PetscReal depth)
{
  return k1 / PetscMax(1 + depth * k1, THINNEST) + k2 / PetscMax(1 + depth * k2, THINNEST);
}

/* The curvature kappa (1/m) of the free surface, at most 'limit', from the principal curvatures k1 and k2 of a parallel
   surface below it. That surface lies at depth + c kappa (m), deeper where the free surface is more curved, so kappa is
   the root of kappa = CarryToSurface(depth + c kappa). The right side falls as kappa grows: there is one root, and
   Newton's method amplifies no rounding. (Without c kappa a thread of two spacings loses 4 % of its pressure.) */
static PetscReal Together(PetscReal k1, PetscReal k2, PetscReal depth, PetscReal c, PetscReal limit)
{
  PetscReal kappa = PetscMax(-limit, PetscMin(limit, CarryToSurface(k1, k2, depth)));

  for (PetscInt round = 0; round < ROUNDS; round++) {
    const PetscReal s = depth + c * kappa, first = k1 / PetscMax(1 + s * k1, THINNEST),
                    second = k2 / PetscMax(1 + s * k2, THINNEST);

    kappa -= (kappa - first - second) / (1 + c * (first * first + second * second));
    kappa = PetscMax(-limit, PetscMin(limit, kappa));
  }
  return kappa;
}

/* The slope (1/m) of the line through the axis that fits n_r around a particle at r (m). */
static PetscReal HoopCurvature(const Moments *m, PetscReal r)
{
  const PetscReal square = m->xx[0] + 2 * r * m->x[0] + r * r * m->w;

  return square > 0 ? (m->nx[0][0] + r * m->n[0]) / square : 0;
}

/* kappa (1/m) of the free surface from the sums around a particle with normal n; at most that of a drop of one spacing.
   bending: |k1| + |k2|. */
static PetscReal SurfaceCurvature(Tension tension, const At *at, const Moments *m, const NormalFit *fit,
                                  const PetscReal n[DIM], PetscReal *deeper, PetscReal *bending)
{
  const Curvature *data  = tension->data;
  const PetscReal  limit = (tension->rings ? 2 : tension->dim - 1) / (at->size * tension->spacing);
  const PetscReal  c     = 0.5 * KernelPlaneMoment(tension->kernel) / data->plane * PetscSqr(at->size);
  PetscReal G[DIM][DIM], K[DIM][DIM], trace = 0, square = 0, kappa, depth, root, k1, k2, lowers, Kn[DIM], nK[DIM],
                                      nKn = 0;

  *deeper = *bending = 0;
  if (!fit->enough) return 0;
  for (PetscInt i = 0; i < DIM; i++)
    for (PetscInt j = 0; j < DIM; j++) G[i][j] = m->nx[i][j] - m->n[i] * fit->x[j];
  for (PetscInt i = 0; i < DIM; i++) TensorApply(fit->B, G[i][0], G[i][1], G[i][2], K[i]);
  for (PetscInt i = 0; i < DIM; i++) {
    Kn[i] = nK[i] = 0;
    for (PetscInt j = 0; j < DIM; j++) {
      Kn[i] += K[i][j] * n[j];
      nK[i] += n[j] * K[j][i];
    }
    nKn += n[i] * Kn[i];
  }
  for (PetscInt i = 0; i < DIM; i++)
    for (PetscInt j = 0; j < DIM; j++) K[i][j] += -n[i] * nK[j] - Kn[i] * n[j] + n[i] * n[j] * nKn;
  for (PetscInt i = 0; i < DIM; i++) {
    trace += K[i][i];
    for (PetscInt j = 0; j < DIM; j++) square += PetscSqr(0.5 * (K[i][j] + K[j][i]));
  }
  root   = 0.5 * PetscSqrtReal(PetscMax(0, 2 * square - trace * trace));
  k1     = 0.5 * trace + root;
  k2     = 0.5 * trace - root;
  depth  = m->s / m->w;
  lowers = k2;
  if (tension->rings) {
    k1     = trace;
    k2     = LooseHas(tension, at->a) ? 0 : HoopCurvature(m, at->x[0]);
    lowers = 0; /* phi is a sum over the plane */
  }
  *deeper = c * Together(k1, lowers, depth, c, limit);
  depth += *deeper;
  kappa    = CarryToSurface(k1, k2, depth);
  *bending = PetscAbsReal(CarryToSurface(k1, 0, depth)) + PetscAbsReal(CarryToSurface(0, k2, depth));
  return PetscMax(-limit, PetscMin(limit, kappa));
}

/* Column 6 holds the depth, then sigma kappa; DEPTH_COLUMN the depth for images that are moved (contact.c). */
#define VALUE_COLUMN        (2 * DIM)
#define COLUMNS_TOTAL(data) ((data)->contact.tilted ? DEPTH_COLUMN + 1 : VALUE_COLUMN + 1)

/* The weighted mean of column 6 over the neighbours of a fit. */
static PetscReal WeightedMean(const At        *at, const float *restrict weight, const int32_t *restrict place,
                              const NormalFit *fit)
{
  const SortedCells *liquid = at->liquid;
  const PetscReal *restrict value =
    fit->sorted ? liquid->sorted + VALUE_COLUMN * liquid->count : liquid->near + VALUE_COLUMN * liquid->stride;
  PetscReal f = 0;

  SIMD_LOOP(reduction(+ : f))
  for (PetscInt k = 0; k < fit->count; k++) f += weight[k] * value[place[k]];
  return f * fit->inverse_w;
}

/* The slope of column 6 along the surface with the normal n at the particle, where its mean is 'mean'. */
static void WeightedSlope(const At       *at, const float *restrict weight, const int32_t *restrict place,
                          const PetscReal n[DIM], const NormalFit *fit, PetscReal mean, PetscReal slope[DIM])
{
  const PetscInt stride        = fit->sorted ? at->liquid->count : at->liquid->stride;
  const PetscReal *restrict cx = fit->sorted ? at->liquid->sorted : at->liquid->near, *restrict cy = cx + stride,
                            *restrict cz = cy + stride, *restrict value = cx + 2 * DIM * stride;
  const PetscReal x0 = at->x[0], y0 = at->x[1], z0 = at->x[2];
  PetscReal       along, fx = 0, fy = 0, fz = 0, f;

  slope[0] = slope[1] = slope[2] = 0;
  if (!fit->enough) return;
  SIMD_LOOP(reduction(+ : fx, fy, fz))
  for (PetscInt k = 0; k < fit->count; k++) {
    const PetscInt  b  = place[k];
    const PetscReal wv = weight[k] * value[b];

    fx += wv * (cx[b] - x0);
    fy += wv * (cy[b] - y0);
    fz += wv * (cz[b] - z0);
  }
  f = mean / fit->inverse_w;
  TensorApply(fit->B, fx - f * fit->x[0], fy - f * fit->x[1], fz - f * fit->x[2], slope);
  along = Dot(slope, n);
  for (PetscInt d = 0; d < DIM; d++) slope[d] -= along * n[d];
}

static inline PetscReal Sigma(Cloud cloud, const Phase *phase, PetscInt a)
{
  if (phase) return phase->part;
  if (cloud->tension) return cloud->tension[a];
  return BodyMaterial(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]))->tension;
}

static PetscBool TensionsDiffer(Scene scene)
{
  for (PetscInt b = 1; b < SceneCount(scene); b++)
    if (BodyMaterial(SceneBody(scene, b))->tension != BodyMaterial(SceneBody(scene, 0))->tension) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Finds normal ([n_owned][3]) and depth ([n_owned], m) of the owned particles of a level near the surface; both are
   zero elsewhere. slope: NULL, or sigma times SheetSlope times share of the owned particles near the surface; share
   ([n_owned]): SheetShare; plane ([n_owned][6]): SheetPlane. */
static PetscErrorCode FindNormals(Tension tension, Cloud cloud, const Phase *phase, PetscInt level, PetscReal normal[],
                                  PetscReal depth[], PetscReal slope[], PetscReal share[], PetscReal plane[])
{
  const Curvature *data = tension->data;
  const PetscReal  V = cloud->domain->volume, H = KernelSmoothingLength(tension->kernel);
  Around           around = {.cell = -1};

  PetscFunctionBegin;
  for (PetscInt p = 0; p < tension->liquid[level].count; p++) {
    const At       at = TensionAt(tension, cloud, level, p);
    const PetscInt a  = at.a;
    PetscReal      g[DIM], phi, length;

    if (!TensionOwns(tension, cloud, level, p) || !data->close[a]) continue;
    PetscCall(ImagesCollect(tension, cloud->domain, &at, COLUMNS(0, DIM), DIM, &around));
    SumMirrored(tension, &at, &around, THRESHOLD / (V * H * at.size), &phi, g);
    length = Norm(g);
    if (slope) {
      share[a] = SheetShare(tension, &at, V * phi, V * length);
      slope[a] = Sigma(cloud, phase, a) * SheetSlope(tension, &at, V * phi) * share[a];
    }
    if (slope && tension->rings && !LooseHas(tension, a)) SheetHoop(tension, cloud, a, slope[a], V * phi);
    if (slope && slope[a] != 0) SheetPlane(tension, &at, around.real, &slope[a], &share[a], plane + 6 * a);
    if (V * length * H * at.size < THRESHOLD) continue;
    for (PetscInt d = 0; d < DIM; d++) normal[DIM * a + d] = -g[d] / length;
    depth[a] = at.size * FlatDepth(tension, V * phi);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes room for 'count' weights and places of neighbours. */
static PetscErrorCode ReserveWeights(Curvature *data, PetscInt64 count)
{
  PetscFunctionBegin;
  if (count <= data->weight_capacity) PetscFunctionReturn(PETSC_SUCCESS);
  data->weight_capacity = 2 * count;
  PetscCall(PetscRealloc((size_t)data->weight_capacity * sizeof(*data->weight), &data->weight));
  PetscCall(PetscRealloc((size_t)data->weight_capacity * sizeof(*data->place), &data->place));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds sigma kappa ([n_owned], Pa) of the owned particles of a level with a normal; keeps fits, weights and places of
   their neighbours for TakeMean, behind 'used' earlier entries. The depth is in its column. share: see SheetShare.
   deeper: NULL, or the depths ([n_owned], m) of a flat surface, to which is added what the curvature makes them deeper.
 */
static PetscErrorCode FindCurvature(Tension tension, Cloud cloud, const Phase *phase, PetscInt level,
                                    const PetscReal normal[], const PetscReal share[], PetscReal capillary[],
                                    PetscReal deeper[], PetscInt64 *used)
{
  Curvature *data   = tension->data;
  NormalFit *fit    = data->fit[level];
  PetscReal *bends  = cloud->field[FIELD_BENDING]; /* NULL: nobody asks */
  Around     around = {.cell = -1};

  PetscFunctionBegin;
  for (PetscInt p = 0; p < tension->liquid[level].count; p++) {
    const At         at = TensionAt(tension, cloud, level, p);
    const PetscInt   a  = at.a;
    const PetscReal *n  = normal + DIM * a;
    PetscReal        more, bending;
    Moments          m;

    if (!TensionOwns(tension, cloud, level, p)) continue;
    PetscCall(
      ImagesCollect(tension, cloud->domain, &at, COLUMNS(0, COLUMNS_TOTAL(data)), COLUMNS_TOTAL(data), &around));
    PetscCall(ReserveWeights(data, *used + around.n));
    ImagesTilt(tension, &at, &around, n, 1);
    SumNormals(tension, &at, &around, n, data->weight + *used, data->place + *used, &m);
    PrepareFit(tension, &at, &m, &fit[p]);
    fit[p].sorted = (PetscBool)(around.images == 0);
    if (fit[p].sorted) SortedCellsPlaces(at.liquid, m.kept, data->place + *used);
    capillary[a] = Sigma(cloud, phase, a) * SurfaceCurvature(tension, &at, &m, &fit[p], n, &more, &bending);
    if (bends) bends[a] = bending;
    if (deeper) deeper[a] += more;
    capillary[a] *= 1 - PetscSqr(share[a] * share[a]); /* in thin sheets SheetPull has this force: see sheet.c */
    *used += m.kept;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* TakeMean for the particles of a level, whose weights follow 'used' earlier ones. */
static PetscErrorCode TakeMeanOfLevel(Tension tension, Cloud cloud, PetscInt level, const PetscReal normal[],
                                      const PetscReal value[], PetscReal mean[], PetscReal slope[], PetscInt64 *used)
{
  const Curvature *data    = tension->data;
  const PetscInt   columns = COLUMNS(VALUE_COLUMN, 1) | (slope ? COLUMNS(0, DIM) : 0);
  Around           around  = {.cell = -1};

  PetscFunctionBegin;
  SortedCellsLoad(&tension->liquid[level], VALUE_COLUMN, 1, value);
  for (PetscInt p = 0; p < tension->liquid[level].count; p++) {
    const At         at     = TensionAt(tension, cloud, level, p);
    const PetscInt   a      = at.a;
    const NormalFit *fit    = &data->fit[level][p];
    const float     *weight = data->weight + *used;
    const int32_t   *place  = data->place + *used;

    if (!TensionOwns(tension, cloud, level, p)) continue;
    if (!fit->sorted) PetscCall(ImagesCollect(tension, cloud->domain, &at, columns, COLUMNS_TOTAL(data), &around));
    mean[a] = WeightedMean(&at, weight, place, fit);
    if (slope) {
      if (!fit->sorted) ImagesTilt(tension, &at, &around, normal + DIM * a, 1);
      WeightedSlope(&at, weight, place, normal + DIM * a, fit, mean[a], slope + DIM * a);
    }
    *used += fit->count;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Computes, for owned particles with a normal, the mean of a value ([n_total], Pa; ghosts current) over the neighbours,
   and its slope ([n_owned][3], may be NULL). After FindCurvature, with the same particles. */
static PetscErrorCode TakeMean(Tension tension, Cloud cloud, const PetscReal normal[], const PetscReal value[],
                               PetscReal mean[], PetscReal slope[])
{
  PetscInt64 used = 0; /* weights */

  PetscFunctionBegin;
  for (PetscInt l = 0; l < tension->levels; l++)
    PetscCall(TakeMeanOfLevel(tension, cloud, l, normal, value, mean, slope, &used));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Approximate deconvolution (van Cittert): f + S (f - mean f) for f = value ([n_total], Pa), ghosts current before and
   after. It restores variations of the curvature over a few H that normals, fit and mean have smoothed; before or after
   the mean makes no difference. With S = 2 the period of a drop's second mode is right to 3 % at R/d0 = 8; without, it
   is 15 to 20 % too long. */
static PetscErrorCode Sharpen(Tension tension, Cloud cloud, const PetscReal normal[], PetscReal value[])
{
  PetscReal *mean = cloud->field[FIELD_CAPILLARY]; /* zero for owned particles without a normal, like the value */

  PetscFunctionBegin;
  PetscCall(TakeMean(tension, cloud, normal, value, mean, NULL));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) value[a] += SHARPENING * (value[a] - mean[a]);
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sorts the particles with a normal, ghosts too, and loads the columns of normal and depth. */
static PetscErrorCode SortNormals(Tension tension, Cloud cloud, const Phase *phase, const PetscReal normal[],
                                  const PetscReal depth[])
{
  Curvature     *data = tension->data;
  unsigned char *keep;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(cloud->n_total, &keep));
  for (PetscInt a = 0; a < cloud->n_total; a++)
    keep[a] = cloud->integer[INT_LAYER][a] == 0 && Dot(normal + DIM * a, normal + DIM * a) > 0;
  for (PetscInt l = 0; l < tension->levels; l++) {
    SortedCells *liquid = &tension->liquid[l];

    PetscCall(LiquidSort(tension, cloud, phase, l, keep));
    SortedCellsLoad(liquid, DIM, DIM, normal);
    SortedCellsLoad(liquid, VALUE_COLUMN, 1, depth);
    if (data->contact.tilted) SortedCellsLoad(liquid, DEPTH_COLUMN, 1, depth);
    if (data->contact.bend) SortedCellsLoad(liquid, LINE_COLUMN, 1, data->contact.bend);
    if (liquid->count > data->fit_capacity[l]) {
      data->fit_capacity[l] = liquid->count + liquid->count / 4;
      PetscCall(PetscFree(data->fit[l]));
      PetscCall(PetscMalloc1(data->fit_capacity[l], &data->fit[l]));
    }
  }
  PetscCall(PetscFree(keep));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the normals of the particles near the surface, ghosts too; adds the forces of thin sheets. share: [n_owned]
   SheetShare. */
static PetscErrorCode FindNormalsAndSheets(Tension tension, Cloud cloud, const Phase *phase, PetscReal normal[],
                                           PetscReal depth[], PetscReal share[])
{
  PetscReal *slope, *plane;

  PetscFunctionBegin;
  PetscCall(SortNearSurface(tension, cloud, phase));
  PetscCall(PetscArrayzero(normal, DIM * cloud->n_owned));
  PetscCall(PetscArrayzero(depth, cloud->n_owned));
  PetscCall(PetscArrayzero(share, cloud->n_owned));
  PetscCall(CloudGetWork(cloud, 1, &slope));
  PetscCall(CloudGetWork(cloud, 6, &plane));
  PetscCall(PetscArrayzero(slope, cloud->n_owned));
  for (PetscInt l = 0; l < tension->levels; l++)
    PetscCall(FindNormals(tension, cloud, phase, l, normal, depth, slope, share, plane));
  PetscCall(SheetPull(tension, cloud, phase, slope, plane));
  PetscCall(CloudRestoreWork(cloud, &plane));
  PetscCall(CloudRestoreWork(cloud, &slope));
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, normal));
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, depth));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the force grad_s sigma along a surface that liquids of different tension share, towards the larger tension.
   Without it the forces on a piece of liquid would not add up to zero: int sigma kappa n dA is not zero, int (sigma
   kappa n + grad_s sigma) dA is. Both terms need one sigma: the mean of sigma kappa changes over the support of its
   fits, and so does this one. A slope over the nearest neighbours gave a disc of two liquids twice the force on itself.
   A particle has the area of OperatorsSurfaceArea. After FindCurvature; value ([n_total], Pa): sigma kappa. */
static PetscErrorCode MarangoniAdd(Tension tension, Cloud cloud, const PetscReal normal[], const PetscReal value[])
{
  PetscReal *sigma, *slope, *acceleration = cloud->field[FIELD_ACCELERATION];

  PetscFunctionBegin;
  if (!cloud->tension && !TensionsDiffer(cloud->scene)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CloudGetWork(cloud, 1, &sigma));
  PetscCall(CloudGetWork(cloud, DIM, &slope));
  PetscCall(PetscArrayzero(slope, DIM * cloud->n_owned));
  for (PetscInt a = 0; a < cloud->n_total; a++) sigma[a] = cloud->integer[INT_LAYER][a] ? 0 : Sigma(cloud, NULL, a);
  PetscCall(TakeMean(tension, cloud, normal, sigma, cloud->field[FIELD_CAPILLARY], slope));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal area = sigma[a] == 0 ? 0 : OperatorsSurfaceArea(cloud, a, value[a] / sigma[a]),
                    mass = cloud->volume[a] * cloud->rest_density[a];

    for (PetscInt d = 0; d < DIM; d++) acceleration[DIM * a + d] += area / mass * slope[DIM * a + d];
  }
  PetscCall(CloudRestoreWork(cloud, &slope));
  PetscCall(CloudRestoreWork(cloud, &sigma));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TensionSurface(Tension tension, Cloud cloud, const Phase *phase)
{
  const Curvature *data = tension->data;
  PetscInt64       used = 0;                /* weights */
  PetscReal       *normal, *share, *scalar; /* the depth, then sigma kappa */

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, DIM, &normal));
  PetscCall(CloudGetWork(cloud, 1, &scalar));
  PetscCall(CloudGetWork(cloud, 1, &share));
  PetscCall(ImagesFindSolids(tension, cloud));
  PetscCall(FindNormalsAndSheets(tension, cloud, phase, normal, scalar, share));
  PetscCall(ImagesFindMeeting(tension, cloud, normal, scalar));
  if (data->contact.walls || data->contact.solids)
    PetscCall(MovingLines.find(data->contact.lines, tension, cloud, normal));
  PetscCall(SortNormals(tension, cloud, phase, normal, scalar));
  if (data->contact.tilted) { /* first the depths, to which the places of images belong */
    PetscReal *deeper;

    PetscCall(CloudGetWork(cloud, 1, &deeper));
    PetscCall(PetscArraycpy(deeper, scalar, cloud->n_owned));
    for (PetscInt l = 0; l < tension->levels; l++)
      PetscCall(FindCurvature(tension, cloud, phase, l, normal, share, scalar, deeper, &used));
    PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, deeper));
    for (PetscInt l = 0; l < tension->levels; l++) SortedCellsLoad(&tension->liquid[l], DEPTH_COLUMN, 1, deeper);
    PetscCall(CloudRestoreWork(cloud, &deeper));
    used = 0;
  }
  for (PetscInt l = 0; l < tension->levels; l++)
    PetscCall(FindCurvature(tension, cloud, phase, l, normal, share, scalar, NULL, &used));
  PetscCall(CloudRestoreWork(cloud, &share));
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, scalar));
  if (!phase) PetscCall(MarangoniAdd(tension, cloud, normal, scalar));
  PetscCall(Sharpen(tension, cloud, normal, scalar));
  PetscCall(
    TakeMean(tension, cloud, normal, scalar, cloud->field[FIELD_CAPILLARY], cloud->field[FIELD_CAPILLARY_SLOPE]));
  PetscCall(CloudRestoreWork(cloud, &scalar));
  PetscCall(ImagesRestore(tension, cloud));
  PetscCall(CloudRestoreWork(cloud, &normal));
  PetscFunctionReturn(PETSC_SUCCESS);
}
