/* Density, moments and normals of the particles, summed during the neighbour search.

   Six sums and the viscous term need the same neighbours, positions and kernel values. A loop for each sum would read
   the whole pair list from memory, which costs more than its arithmetic. Therefore the search passes every row on while
   it is in the cache (RowVisitor), and one loop computes all sums, at little more than the cost of one. */
#include "../neighbors/pairs.h"
#include "operators.h"

/* R of the term R (W/W(d0))^4 grad W against pairing (Lind et al. 2012, after Monaghan 2000). */
#define CROWDING_WEIGHT 0.2

/* The smallest root of 4 c^3 - 3 c = r is c = cos(arccos(r)/3 + 2 pi/3). This parabola in t = sqrt(1 - r) has the
   root's value at r = -1, and its value and slope at r = 1; between, it is right to 0.4 %. NEWTON_STEPS steps of
   Newton's method then reach round-off, in half the time of the trigonometric functions. */
#define SMALLEST_ROOT(t) (-0.5 - (t) * (0.408248290463863 - 0.0386751345948129 * (t)))
#define NEWTON_STEPS     3
#define SMALLEST         1e-300 /* added to a divisor that is zero for a matrix of zeros */

/* Smallest2 and Smallest3: the smallest eigenvalues of symmetric matrices, without branches, so that loops over them
   vectorise. */
static inline PetscReal Smallest2(PetscReal xx, PetscReal yy, PetscReal xy)
{
  return 0.5 * (xx + yy) - PetscSqrtReal(0.25 * (xx - yy) * (xx - yy) + xy * xy);
}

/* The trigonometric solution of Smith, Comm. ACM 4, 168 (1961). */
static inline PetscReal Smallest3(PetscReal xx, PetscReal yy, PetscReal zz, PetscReal xy, PetscReal xz, PetscReal yz)
{
  const PetscReal mean = (xx + yy + zz) / 3, a = xx - mean, b = yy - mean, c = zz - mean;
  const PetscReal square = (a * a + b * b + c * c + 2 * (xy * xy + xz * xz + yz * yz)) / 6;
  const PetscReal spread = PetscSqrtReal(square), p = spread + PETSC_MACHINE_EPSILON * PetscAbsReal(mean) + SMALLEST;
  const PetscReal x = xy / p, y = xz / p, z = yz / p, u = a / p, v = b / p, w = c / p;
  const PetscReal half = 0.5 * (u * (v * w - z * z) - x * (x * w - z * y) + y * (x * z - v * y));
  const PetscReal low = half < 1 ? half : 1, r = low > -1 ? low : -1, t = PetscSqrtReal(1 - r);
  PetscReal       root = SMALLEST_ROOT(t);

  for (PetscInt k = 0; k < NEWTON_STEPS; k++) /* epsilon: the slope is zero at the double root -1/2 */
    root -= (root * (4 * root * root - 3) - r) / (12 * root * root - 3 + PETSC_MACHINE_EPSILON);
  return mean + 2 * spread * root;
}

PetscReal SymmetricSmallestEigenvalue(PetscInt dim, const PetscReal M[6])
{
  return dim == 2 ? Smallest2(M[0], M[1], M[3]) : Smallest3(M[0], M[1], M[2], M[3], M[4], M[5]);
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

/* The constants of all rows of OperatorsMoments. */
typedef struct {
  PetscReal V, self;          /* volume of a particle, m^dim; W(0), m^-dim */
  PetscReal scale_w, scale_f; /* of KernelScales */
  PetscReal ratio;            /* scale_w/W(d0) */
  PetscBool viscous;          /* the viscous term is wanted */
  PetscReal nu, friction;     /* mu/rho, m2/s; zeta V 2 nu scale_f, m^-4/s */
} Scales;

/* (s_ab/s_b)^dim of SIMD_WIDTH neighbours of a graded particle; s_ab is the mean of both sizes. It turns V_b W_ab into
   V_0 s_ab^dim W_ab, which has one value at a distance of s_ab spacings, for pairs of all sizes. */
static inline Simd PairVolumeRatio(Cloud cloud, PetscInt a, const PetscInt list[])
{
  const Simd other = SimdGather(cloud->size, list), ratio = 0.5 * (SimdSet(cloud->size[a]) + other) / other;

  return cloud->domain->dim == 2 ? ratio * ratio : ratio * ratio * ratio;
}

/* s_ab^2 of SIMD_WIDTH neighbours. */
static inline Simd SquareOfSize(Cloud cloud, PetscInt a, const PetscInt list[])
{
  const Simd size = 0.5 * (SimdSet(cloud->size[a]) + SimdGather(cloud->size, list));

  return size * size;
}

/* Adds the lanes up and stores all sums of row a but the viscous term. In two dimensions there are two thirds of them.
 */
static inline void StoreMoments(PetscBool flat, Cloud cloud, PetscInt a, const Scales *scales, Simd3 normal, Simd sum,
                                Simd3 crowding, Simd3 diagonal, Simd3 off)
{
  const PetscReal V = scales->V, scale = V * scales->scale_f;
  const Simd      zero  = SimdSet(0);
  const Vec4      total = Simd3Sum(normal, sum),
             more       = flat ? SimdSums(crowding.x, crowding.y, zero, off.x) : Simd3Sum(crowding, off.x);
  PetscReal *M          = cloud->field[FIELD_CORRECTION] + 6 * a;

  Vec4Store(scale * total, cloud->field[FIELD_NORMAL] + DIM * a);
  cloud->field[FIELD_DENSITY][a] =
    cloud->rest_density[a] * V * (cloud->relative_weight[a] * scales->self + scales->scale_w * total[3]);
  Vec4Store(scale * (total + more), cloud->field[FIELD_CROWDING] + DIM * a);
  Vec4Store(-scale * Simd3Sum(diagonal, zero), M);
  M[3] = -scale * more[3];
  M[4] = flat ? 0 : -scale * SimdSum(off.y);
  M[5] = flat ? 0 : -scale * SimdSum(off.z);
}

/* Computes all sums of row a: FIELD_DENSITY, FIELD_NORMAL, FIELD_CROWDING, the moments in FIELD_CORRECTION and, if
   'viscous', the viscous term in FIELD_ACCELERATION. */
static inline void SumMoments(PetscBool flat, PetscBool graded, PetscBool viscous, Cloud cloud, PetscInt a,
                              const float w[], const Scales *scales)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *v = cloud->field[FIELD_VELOCITY];
  const PetscInt  *list = cloud->list + cloud->first[a], n = (PetscInt)(cloud->first[a + 1] - cloud->first[a]);
  const float     *slope = cloud->slope + cloud->first[a];
  const Simd3      p = Simd3Set(x + DIM * a), own = Simd3Set(v + DIM * a);
  const Simd       zero = SimdSet(0), ratio = SimdSet(scales->ratio), weight = SimdSet(CROWDING_WEIGHT),
             along       = SimdSet(PETSC_PI / cloud->length[a]);
  const PetscBool rings  = cloud->domain->rings;
  Simd3           normal = {zero, zero, zero}, crowding = normal, diagonal = normal, off = normal, friction = normal;
  Simd            sum = zero;

  for (PetscInt k = 0; k < n; k += SIMD_WIDTH) {
    const SimdOffsets at = SimdLocate(list + k);
    const Simd3       d  = Simd3Difference(flat, p, Simd3Collect(flat, x, &at));
    const Simd        f = SimdLoadSingle(slope + k), W = SimdLoadSingle(w + k),
               r = graded ? W * ratio * PairVolumeRatio(cloud, a, list + k) : W * ratio, r2 = r * r, fx = f * d.x,
               fy = f * d.y;

    sum += W;
    normal.x += fx;
    normal.y += fy;
    Simd3Add(flat, &crowding, weight * r2 * r2 * f, d);
    diagonal.x += fx * d.x;
    diagonal.y += fy * d.y;
    off.x += fx * d.y;
    if (!flat) {
      const Simd fz = f * d.z;

      normal.z += fz;
      diagonal.z += fz * d.z;
      off.y += fx * d.z;
      off.z += fy * d.z;
    }
    if (viscous) { /* VISCOSITY_MOMENT */
      const Simd3 u = Simd3Difference(flat, own, Simd3Collect(flat, v, &at));
      Simd        c = f * Simd3Dot(flat, u, d);

      if (graded) c /= SquareOfSize(cloud, a, list + k);
      if (flat && rings) c *= along * SimdAbs(2 * p.x - d.x); /* DomainPairLength over the ring's own */
      Simd3Add(flat, &friction, c, d);
    }
  }
  StoreMoments(flat, cloud, a, scales, normal, sum, crowding, diagonal, off);
  if (viscous) {
    PetscReal *acceleration = cloud->field[FIELD_ACCELERATION] + DIM * a;

    Vec4Store(scales->friction * Simd3Sum(friction, zero), acceleration);
    if (rings) acceleration[0] += OperatorsGrowthFriction(cloud, VISCOSITY_MOMENT, a, scales->nu) * v[DIM * a];
  }
}

/* Five instances of one text. */
static void MomentsRow(Cloud cloud, PetscInt a, const float w[], void *context)
{
  const Scales   *scales  = (const Scales *)context;
  const PetscBool viscous = (PetscBool)(scales->viscous && a < cloud->n_fluid);
  const PetscBool flat    = (PetscBool)(cloud->domain->dim == 2);

  if (cloud->domain->graded && flat)
    SumMoments(PETSC_TRUE, PETSC_TRUE, viscous, cloud, a, w, scales);
  else if (cloud->domain->graded)
    SumMoments(PETSC_FALSE, PETSC_TRUE, viscous, cloud, a, w, scales);
  else if (flat)
    SumMoments(PETSC_TRUE, PETSC_FALSE, viscous, cloud, a, w, scales);
  else if (scales->viscous)
    SumMoments(PETSC_FALSE, PETSC_FALSE, viscous, cloud, a, w, scales);
  else
    SumMoments(PETSC_FALSE, PETSC_FALSE, PETSC_FALSE, cloud, a, w, scales);
}

/* Computes FIELD_LAMBDA from the moments M in FIELD_CORRECTION, and replaces M by B. */
static void Renormalise(Cloud cloud)
{
  const PetscInt n = cloud->n_owned, dim = cloud->domain->dim;
  PetscReal     *M = cloud->field[FIELD_CORRECTION], *lambda = cloud->field[FIELD_LAMBDA];

  if (dim == 2) {
    SIMD_LOOP()
    for (PetscInt a = 0; a < n; a++) lambda[a] = Smallest2(M[6 * a], M[6 * a + 1], M[6 * a + 3]);
  } else {
    SIMD_LOOP()
    for (PetscInt a = 0; a < n; a++)
      lambda[a] = Smallest3(M[6 * a], M[6 * a + 1], M[6 * a + 2], M[6 * a + 3], M[6 * a + 4], M[6 * a + 5]);
  }
  for (PetscInt a = 0; a < n; a++) {
    PetscReal B[6] = {1, 1, 1, 0, 0, 0};

    if (lambda[a] > MOMENT_MINIMUM) SymmetricInverse(dim, M + 6 * a, B);
    for (PetscInt k = 0; k < 6; k++) M[6 * a + k] = B[k];
  }
}

/* Behind a wall is the liquid that is before it: where bodies differ in density, a particle of a wall has the mean of
   those of its liquid neighbours, without any that of the first body. One density for all walls, that of some body,
   would act on the others. */
static PetscErrorCode WallDensities(Cloud cloud)
{
  PetscReal *rho = cloud->field[FIELD_DENSITY], *rest = cloud->rest_density;
  PairRow    row;

  PetscFunctionBegin;
  if (SceneOneDensity(cloud->scene)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++) {
    PetscReal sum = 0, filled = 0;

    PairRowLoadGeometry(cloud, cloud->field[FIELD_POSITION], a, &row);
    PairRowEvaluate(cloud, a, &row);
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt  b     = row.index[k];
      const PetscReal share = cloud->integer[INT_LAYER][b] ? 0 : row.W[k] * cloud->weight[b];

      filled += share;
      sum += share * rest[b];
    }
    if (filled <= 0) continue;
    rho[a] *= sum / filled / rest[a];
    rest[a] = sum / filled;
  }
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, rest));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OperatorsMoments(Cloud cloud, const Viscosity *viscosity)
{
  const Material *liquid = BodyMaterial(SceneBody(cloud->scene, 0));
  const PetscReal d2     = PetscSqr(cloud->domain->spacing);
  Scales          scales = {.V = cloud->domain->volume, .self = KernelSelf(cloud->kernel)};
  PetscReal       at_spacing, inverse_h2;

  PetscFunctionBegin;
  KernelScales(cloud->kernel, &scales.scale_w, &scales.scale_f, &inverse_h2);
  KernelEvaluate(cloud->kernel, 1, &d2, &at_spacing, NULL);
  scales.ratio   = scales.scale_w / at_spacing;
  scales.viscous = (PetscBool)(viscosity != NULL);
  scales.nu      = liquid->viscosity / liquid->density;
  scales.friction =
    viscosity ? OperatorsViscosityFactor(cloud, VISCOSITY_MOMENT) * scales.V * 2 * scales.nu * scales.scale_f : 0;
  for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++) /* not what the step before left: see WallDensities */
    cloud->rest_density[a] = liquid->density;
  PetscCall(CloudSearch(cloud, MomentsRow, &scales));
  PetscCall(WallDensities(cloud));
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_MOMENTS), 0, 0, 0, 0));
  Renormalise(cloud);
  CloudWrote(cloud, FIELD_CORRECTION); /* stands for all sums of this function */
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_MOMENTS), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
