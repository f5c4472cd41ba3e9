/* Surface tension as a pressure on the free surface, sigma times its curvature.

   The outward normal is n = -grad phi/|grad phi| of phi = sum V W^H over the liquid. Where |grad phi| shows that the
   surface is near, the curvature tensor K = grad n is the slope of a weighted linear fit, intercept included, to the
   normals around (those that look the same way), projected onto the tangent plane; its eigenvalues belong to a parallel
   surface at the fit's mean depth s below the free one and are carried to it by k/(1 + s k). The mean of
   sigma (k1 + k2) over the neighbours is FIELD_CAPILLARY. The pressure solver puts it on the free surface in place of
   p = 0: a drop of constant curvature is then at rest exactly, because both closure and gradient see only p - sigma
   kappa. Depth: phi = F(s) of a half-space, lowered by kappa/2 int x^2 W dA where the surface is curved.

   Walls are mirrors: the liquid and its normals are continued behind them so that the surface meets the wall under the
   contact angle. A mirror keeps the even part of the surface's form and reverses the odd part, its slope; that is set
   right in grad phi (SumMirrored) and in the normals of the images (Mirror). */
#include "tension_impl.h"

#define ALIKE      0.2       /* n_a . n_b above: the same side of the liquid */
#define FEWEST     (DIM + 2) /* normals a fit needs */
#define THIN       0.3       /* 1 + s k is taken no smaller */
#define PARALLEL   0.5  /* times sin of the contact angle: a smaller part of n along the wall is no contact line's */
#define REGULARITY 1e-6 /* of the fit's matrix, relative to its trace */

PetscErrorCode CurvatureSetUp(Tension tension)
{
  const PetscReal support = KernelSupport(tension->kernel);
  PetscReal       r2[WALL_TABLE], W[WALL_TABLE], fraction = 0.5, next = 0.5;
  const PetscReal dr = support / WALL_TABLE;

  PetscFunctionBegin;
  KernelHalfSpace(tension->kernel, 0, &tension->plane, NULL);
  KernelSurfaceTable(tension->kernel, WALL_TABLE, tension->fraction);
  for (PetscInt k = 0; k < WALL_TABLE; k++) r2[k] = PetscSqr((k + 0.5) * dr);
  KernelEvaluate(tension->kernel, WALL_TABLE, r2, W, NULL);
  tension->moment = 0;
  for (PetscInt k = 0; k < WALL_TABLE; k++)
    tension->moment += W[k] * r2[k] * dr * (tension->dim == 3 ? PETSC_PI * PetscSqrtReal(r2[k]) : 2);
  for (PetscInt k = 0, m = 0; k <= WALL_TABLE; k++) { /* the depth at which a half-space fills (1 + k/WALL_TABLE)/2 */
    const PetscReal wanted = 0.5 + 0.5 * k / WALL_TABLE;

    while (m < WALL_TABLE && next < wanted) {
      fraction = next;
      m++;
      KernelHalfSpace(tension->kernel, support * m / WALL_TABLE, NULL, &next);
    }
    tension->depth[k] =
      support / WALL_TABLE * (m > 0 ? m - 1 + PetscMin(1, (wanted - fraction) / (next - fraction)) : 0);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Depth (m) below a flat surface of a particle with this phi; negative outside. */
static PetscReal FlatDepth(Tension tension, PetscReal phi)
{
  const PetscReal place = PetscMin(2 * phi - 1, 1 - 1e-9) * WALL_TABLE;
  const PetscInt  k     = (PetscInt)place;

  if (place < 0) return PetscMax((phi - 0.5) / tension->plane, -0.5 * tension->spacing);
  return tension->depth[k] + (place - k) * (tension->depth[k + 1] - tension->depth[k]);
}

/* The mirror images that one wall adds to the collected particles. */
typedef struct {
  PetscInt  begin, end, axis;
  PetscReal inward; /* +1 or -1: the way into the box along the axis */
} Image;

/* How far from a wall a cell's particles may have images among their neighbours, m. */
static PetscReal ImageReach(const Liquid *liquid)
{
  return liquid->support + liquid->grid.size;
}

static PetscBool NearWall(Tension tension, Domain domain, const PetscReal x[DIM])
{
  const PetscReal reach = ImageReach(&tension->liquid);
  PetscBool       near  = PETSC_FALSE;

  for (PetscInt d = 0; d < domain->dim && tension->walls; d++) {
    if (domain->face[d][0] == FACE_WALL && PetscAbsReal(x[d] - domain->lower[d]) <= reach) near = PETSC_TRUE;
    if (domain->face[d][1] == FACE_WALL && PetscAbsReal(x[d] - domain->upper[d]) <= reach) near = PETSC_TRUE;
  }
  return near;
}

/* Continues the n collected candidates behind the walls within the support of the cell of x; normals (columns 3 to 5,
   if width says there are any) so that their mean with the originals has the contact angle, unless the surface is too
   close to parallel to the wall to end there. Returns the new number, and what each wall added. */
static PetscInt Mirror(Tension tension, Domain domain, const PetscReal x[DIM], PetscInt width, PetscInt n,
                       Image image[2 * DIM], PetscInt *images)
{
  Liquid         *liquid = &tension->liquid;
  const PetscReal reach = ImageReach(liquid), c = PetscCosReal(tension->angle), s = PetscSinReal(tension->angle);

  *images = 0;
  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt side = 0; side < 2; side++) {
      const PetscReal wall = side ? domain->upper[d] : domain->lower[d], inward = side ? -1 : 1;
      PetscInt        copies = n;

      if (domain->face[d][side] != FACE_WALL || PetscAbsReal(x[d] - wall) > reach) continue;
      for (PetscInt k = 0; k < n; k++) {
        PetscReal *to = liquid->near + copies, *from = liquid->near + k;

        if (PetscAbsReal(from[d * liquid->stride] - wall) > reach) continue;
        for (PetscInt w = 0; w < width; w++) to[w * liquid->stride] = from[w * liquid->stride];
        to[d * liquid->stride] = 2 * wall - from[d * liquid->stride];
        if (width > DIM) {
          PetscReal normal[DIM], along = 0, scale, length = 0;

          for (PetscInt e = 0; e < DIM; e++) {
            normal[e] = from[(DIM + e) * liquid->stride];
            if (e != d) along += PetscSqr(normal[e]);
          }
          if (along < PetscSqr(PARALLEL * s)) continue;
          scale = 2 * s / PetscSqrtReal(along);
          for (PetscInt e = 0; e < DIM; e++) {
            normal[e] = (e == d ? 2 * c * inward : scale * normal[e]) - normal[e];
            length += PetscSqr(normal[e]);
          }
          length = length > 0 ? 1 / PetscSqrtReal(length) : 0;
          for (PetscInt e = 0; e < DIM; e++) to[(DIM + e) * liquid->stride] = length * normal[e];
        }
        copies++;
      }
      image[(*images)++] = (Image){n, copies, d, inward};
      n                  = copies;
    }
  return n;
}

/* Adds phi and grad phi of the collected candidates first to n - 1 at x, without V. */
static void SumPhase(Tension tension, PetscInt first, PetscInt n, const PetscReal x[DIM], PetscReal *phi,
                     PetscReal gradient[DIM])
{
  const PetscReal *restrict cx = tension->liquid.near, *restrict cy = cx + tension->liquid.stride,
                            *restrict cz = cy + tension->liquid.stride;
  const PetscReal x0 = x[0], y0 = x[1], z0 = x[2];
  PetscReal       sum = 0, gx = 0, gy = 0, gz = 0, scale_w, scale_f, inverse_h2;
  float           s[CHUNK], W[CHUNK], F[CHUNK];

  KernelScales(tension->kernel, &scale_w, &scale_f, &inverse_h2);
  for (PetscInt begin = first; begin < n; begin += CHUNK) {
    const PetscInt m = PetscMin(CHUNK, n - begin);

    Distances(tension, begin, m, x, inverse_h2, s);
    KernelSingle(tension->kernel, m, s, W, F);
    SIMD_LOOP(reduction(+ : sum, gx, gy, gz))
    for (PetscInt k = 0; k < m; k++) {
      sum += W[k];
      gx += F[k] * (x0 - cx[begin + k]);
      gy += F[k] * (y0 - cy[begin + k]);
      gz += F[k] * (z0 - cz[begin + k]);
    }
  }
  *phi += scale_w * sum;
  gradient[0] += scale_f * gx;
  gradient[1] += scale_f * gy;
  gradient[2] += scale_f * gz;
}

/* phi and grad phi at x of the n collected particles and, behind them, the images. An image of the free surface has the
   part of grad phi normal to the wall reversed: it would draw all normals near the wall towards 90 degrees. In its
   place comes that of a surface which goes on straight under the contact angle, cot(angle) times the part along the
   wall. */
static void SumMirrored(Tension tension, PetscInt n, const Image image[], PetscInt images, const PetscReal x[DIM],
                        PetscReal *phi, PetscReal g[DIM])
{
  PetscReal of[2 * DIM][DIM], turn[2 * DIM];

  *phi = g[0] = g[1] = g[2] = 0;
  SumPhase(tension, 0, n, x, phi, g);
  for (PetscInt k = 0; k < images; k++) {
    of[k][0] = of[k][1] = of[k][2] = 0;
    SumPhase(tension, image[k].begin, image[k].end, x, phi, of[k]);
    for (PetscInt d = 0; d < DIM; d++) g[d] += of[k][d];
  }
  for (PetscInt k = 0; k < images; k++) {
    PetscReal along = 0, square = 0;

    for (PetscInt d = 0; d < DIM; d++) {
      if (d == image[k].axis) continue;
      along += of[k][d] * g[d];
      square += PetscSqr(g[d]);
    }
    turn[k] = along > 0 ? 2 * image[k].inward * along / (PetscSqrtReal(square) * PetscTanReal(tension->angle)) : 0;
  }
  for (PetscInt k = 0; k < images; k++) g[image[k].axis] -= turn[k];
}

/* Weighted sums over the collected normals that look the same way as n at x: number, weight, positions relative to x,
   normals, depth, and their products; weight: [m], zero for the others. */
typedef struct {
  PetscReal count, w, x[DIM], n[DIM], s, xx[6], nx[DIM][DIM];
} Moments;

static void SumNormals(Tension tension, PetscInt m, const PetscReal x[DIM], const PetscReal n[DIM],
                       float *restrict weight, Moments *out)
{
  const PetscInt stride        = tension->liquid.stride;
  const PetscReal *restrict cx = tension->liquid.near, *restrict cy = cx + stride, *restrict cz = cy + stride,
                            *restrict nx = cz + stride, *restrict ny = nx + stride, *restrict nz = ny + stride,
                            *restrict depth = nz + stride;
  const PetscReal x0 = x[0], y0 = x[1], z0 = x[2], ax = n[0], ay = n[1], az = n[2];
  PetscReal       scale_w, scale_f, inverse_h2;
  float           s[CHUNK], W[CHUNK];
  PetscReal       count = 0, sw = 0, sx = 0, sy = 0, sz = 0, px = 0, py = 0, pz = 0, ss = 0;
  PetscReal       xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
  PetscReal       qxx = 0, qxy = 0, qxz = 0, qyx = 0, qyy = 0, qyz = 0, qzx = 0, qzy = 0, qzz = 0;

  KernelScales(tension->kernel, &scale_w, &scale_f, &inverse_h2);
  for (PetscInt begin = 0; begin < m; begin += CHUNK) {
    const PetscInt l = PetscMin(CHUNK, m - begin);

    Distances(tension, begin, l, x, inverse_h2, s);
    KernelSingle(tension->kernel, l, s, W, NULL);
    /* clang-format off */
    SIMD_LOOP(reduction(+ : count, sw, sx, sy, sz, px, py, pz, ss, xx, yy, zz, xy, xz, yz) \
              reduction(+ : qxx, qxy, qxz, qyx, qyy, qyz, qzx, qzy, qzz))
    /* clang-format on */
    for (PetscInt k = 0; k < l; k++) {
      const PetscInt  b     = begin + k;
      const PetscReal alike = ax * nx[b] + ay * ny[b] + az * nz[b] > ALIKE ? 1 : 0, w = alike * W[k];
      const PetscReal dx = cx[b] - x0, dy = cy[b] - y0, dz = cz[b] - z0;
      const PetscReal wx = w * dx, wy = w * dy, wz = w * dz;

      weight[b] = (float)w;
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
  }
  *out = (Moments){.count = count,
                   .w     = sw,
                   .x     = {sx, sy, sz},
                   .n     = {px, py, pz},
                   .s     = ss,
                   .xx    = {xx, yy, zz, xy, xz, yz},
                   .nx    = {{qxx, qxy, qxz}, {qyx, qyy, qyz}, {qzx, qzy, qzz}}};
}

/* What a linear fit to values at the collected places with normals that look the same way needs to know of these. */
static void FitPlaces(Tension tension, const Moments *m, NormalFit *fit)
{
  PetscReal M[6];

  fit->enough    = (PetscBool)(m->count >= FEWEST);
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
    const PetscReal small = REGULARITY * (M[0] + M[1] + M[2]);

    for (PetscInt d = 0; d < DIM; d++) M[d] += small;
    SymmetricInverse(tension->dim, M, fit->B);
  }
}

/* kappa (1/m) of the free surface from the sums around a particle with normal n. */
static PetscReal Curvature(Tension tension, const Moments *m, const NormalFit *fit, const PetscReal n[DIM])
{
  const PetscReal limit = (tension->dim - 1) / tension->spacing;
  PetscReal G[DIM][DIM], K[DIM][DIM], trace = 0, square = 0, kappa, depth, root, k1, k2, Kn[DIM], nK[DIM], nKn = 0;

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
  root  = 0.5 * PetscSqrtReal(PetscMax(0, 2 * square - trace * trace));
  k1    = 0.5 * trace + root;
  k2    = 0.5 * trace - root;
  depth = m->s / m->w;
  kappa = k1 / PetscMax(1 + depth * k1, THIN) + k2 / PetscMax(1 + depth * k2, THIN);
  depth += 0.5 * PetscMax(-limit, PetscMin(limit, kappa)) * tension->moment / tension->plane;
  kappa = k1 / PetscMax(1 + depth * k1, THIN) + k2 / PetscMax(1 + depth * k2, THIN);
  return PetscMax(-limit, PetscMin(limit, kappa));
}

/* Mean of column 6 over the m collected candidates with their weights, and its slope along the surface. */
static PetscReal Mean(Tension tension, PetscInt m, const float *restrict weight, const PetscReal x[DIM],
                      const PetscReal n[DIM], const NormalFit *fit, PetscReal slope[DIM])
{
  const PetscInt stride        = tension->liquid.stride;
  const PetscReal *restrict cx = tension->liquid.near, *restrict cy = cx + stride, *restrict cz = cy + stride,
                            *restrict value = cx + 2 * DIM * stride;
  const PetscReal x0 = x[0], y0 = x[1], z0 = x[2];
  PetscReal       along, f = 0, fx = 0, fy = 0, fz = 0;

  SIMD_LOOP(reduction(+ : f, fx, fy, fz))
  for (PetscInt k = 0; k < m; k++) {
    const PetscReal wv = weight[k] * value[k];

    f += wv;
    fx += wv * (cx[k] - x0);
    fy += wv * (cy[k] - y0);
    fz += wv * (cz[k] - z0);
  }
  slope[0] = slope[1] = slope[2] = 0;
  if (fit->enough) {
    TensorApply(fit->B, fx - f * fit->x[0], fy - f * fit->x[1], fz - f * fit->x[2], slope);
    along = Dot(slope, n);
    for (PetscInt d = 0; d < DIM; d++) slope[d] -= along * n[d];
  }
  return f * fit->inverse_w;
}

static inline PetscReal Sigma(Cloud cloud, PetscInt a)
{
  return BodyMaterial(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]))->tension;
}

typedef enum { PASS_NORMAL, PASS_CURVATURE, PASS_MEAN } PassKind;

/* One pass over the owned particles of the sorted liquid. Normal and depth go to FIELD_WORK3 (zero where the surface is
 * not near) and FIELD_WORK1, the curvature to FIELD_WORK1, its mean times sigma to FIELD_CAPILLARY. */
static PetscErrorCode Pass(Tension tension, Cloud cloud, PassKind kind)
{
  Liquid         *liquid = &tension->liquid;
  const CellGrid *grid   = &liquid->grid;
  const PetscReal V = cloud->domain->volume, H = KernelSmoothingLength(tension->kernel);
  const PetscInt  width = kind == PASS_NORMAL ? DIM : 2 * DIM + 1, copies = 1 << (2 * cloud->domain->dim);
  PetscInt        used   = 0; /* weights */
  PetscReal      *normal = cloud->field[FIELD_WORK3], *scalar = cloud->field[FIELD_WORK1];

  PetscFunctionBegin;
  for (PetscInt c = 0; c < grid->count; c++) {
    PetscInt n = -1, real = 0, images = 0;
    Image    image[2 * DIM];

    for (PetscInt p = grid->start[c]; p < grid->start[c + 1]; p++) {
      const PetscInt  a      = LiquidParticle(liquid, p);
      const PetscReal x[DIM] = {liquid->sorted[p], liquid->sorted[liquid->count + p],
                                liquid->sorted[2 * liquid->count + p]};

      if (a >= cloud->n_owned || (kind == PASS_NORMAL && !BandNear(&tension->band_cells, x))) continue;
      if (n < 0) {
        const PetscBool mirrored = NearWall(tension, cloud->domain, x);
        const PetscInt  columns  = COLUMNS(0, DIM) | (kind == PASS_MEAN && !mirrored ? 0 : COLUMNS(DIM, width - DIM)) |
                                 (kind == PASS_MEAN ? COLUMNS(2 * DIM, 1) : 0);

        PetscCall(LiquidCollect(liquid, c, columns, mirrored ? copies : 1, &n));
        real = n;
        if (mirrored) n = Mirror(tension, cloud->domain, x, width, n, image, &images);
      }
      if (kind == PASS_NORMAL) {
        PetscReal g[DIM], phi, length;

        SumMirrored(tension, real, image, images, x, &phi, g);
        length = Norm(g);
        if (tension->sheets)
          cloud->field[FIELD_CAPILLARY][a] = Sigma(cloud, a) * SheetSlope(tension, V, V * phi, V * length);
        if (V * length * H < tension->threshold) continue;
        for (PetscInt d = 0; d < DIM; d++) normal[DIM * a + d] = -g[d] / length;
        scalar[a] = FlatDepth(tension, V * phi);
      } else if (kind == PASS_CURVATURE) {
        Moments m;

        if (used + n > tension->weight_capacity) {
          tension->weight_capacity = 2 * (used + n);
          PetscCall(PetscRealloc(tension->weight_capacity * sizeof(float), &tension->weight));
        }
        SumNormals(tension, n, x, normal + DIM * a, tension->weight + used, &m);
        FitPlaces(tension, &m, &tension->fit[p]);
        scalar[a] = Sigma(cloud, a) * Curvature(tension, &m, &tension->fit[p], normal + DIM * a);
      } else
        cloud->field[FIELD_CAPILLARY][a] = Mean(tension, n, tension->weight + used, x, normal + DIM * a,
                                                &tension->fit[p], cloud->field[FIELD_CAPILLARY_SLOPE] + DIM * a);
      if (kind != PASS_NORMAL) used += n;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Approximate deconvolution (van Cittert): f + c (f - mean f) for f = FIELD_CAPILLARY and its slope, which gives back
   what normals, fit and mean have smoothed away of a curvature that varies over a few H. With c = 2 a drop's second
   mode has its period to 3 % at R/d0 = 8 (15 to 20 % too long without). */
static PetscErrorCode Sharpen(Tension tension, Cloud cloud)
{
  PetscReal *value = cloud->field[FIELD_CAPILLARY], *slope = cloud->field[FIELD_CAPILLARY_SLOPE], *first, *first_slope;
  const PetscReal c = tension->sharpening;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(cloud->n_fluid, &first, DIM * cloud->n_fluid, &first_slope));
  PetscCall(PetscArraycpy(first, value, cloud->n_fluid));
  PetscCall(PetscArraycpy(first_slope, slope, DIM * cloud->n_fluid));
  PetscCall(CloudUpdate(cloud, FIELD_CAPILLARY));
  LiquidLoad(&tension->liquid, 2 * DIM, 1, value);
  PetscCall(Pass(tension, cloud, PASS_MEAN));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) value[a] = first[a] + c * (first[a] - value[a]);
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) slope[k] = first_slope[k] + c * (first_slope[k] - slope[k]);
  PetscCall(PetscFree2(first, first_slope));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TensionApply_Curvature(Tension tension, Cloud cloud)
{
  const PetscReal support = KernelSupport(tension->kernel);
  PetscReal      *normal  = cloud->field[FIELD_WORK3];
  PetscBool      *keep;

  PetscFunctionBegin;
  /* |grad phi| H is below the threshold 0.9 H deep; surface particles are half a spacing deep */
  PetscCall(TensionBand(tension, cloud, KernelSmoothingLength(tension->kernel)));
  PetscCall(PetscArrayzero(normal, DIM * cloud->n_owned));
  PetscCall(PetscArrayzero(cloud->field[FIELD_WORK1], cloud->n_owned));
  PetscCall(LiquidSort(&tension->liquid, cloud, support, NULL));
  PetscCall(Pass(tension, cloud, PASS_NORMAL));
  if (tension->sheets) PetscCall(SheetPull(tension, cloud));
  PetscCall(CloudUpdate(cloud, FIELD_WORK3));
  PetscCall(CloudUpdate(cloud, FIELD_WORK1));
  PetscCall(PetscMalloc1(cloud->n_total, &keep));
  for (PetscInt a = 0; a < cloud->n_total; a++)
    keep[a] = (PetscBool)(cloud->integer[INT_LAYER][a] == 0 && Dot(normal + DIM * a, normal + DIM * a) > 0);
  PetscCall(LiquidSort(&tension->liquid, cloud, support, keep));
  PetscCall(PetscFree(keep));
  if (tension->liquid.count > tension->fit_capacity) {
    tension->fit_capacity = tension->liquid.count + tension->liquid.count / 4;
    PetscCall(PetscFree(tension->fit));
    PetscCall(PetscMalloc1(tension->fit_capacity, &tension->fit));
  }
  LiquidLoad(&tension->liquid, DIM, DIM, normal);
  LiquidLoad(&tension->liquid, 2 * DIM, 1, cloud->field[FIELD_WORK1]);
  PetscCall(Pass(tension, cloud, PASS_CURVATURE));
  PetscCall(CloudUpdate(cloud, FIELD_WORK1));
  LiquidLoad(&tension->liquid, 2 * DIM, 1, cloud->field[FIELD_WORK1]);
  PetscCall(Pass(tension, cloud, PASS_MEAN));
  if (tension->sharpening > 0) PetscCall(Sharpen(tension, cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}
