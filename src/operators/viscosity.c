/* The viscous term of a velocity field, explicit or as a linear operator, and the wall factor for no slip. */
#include "../neighbors/pairs.h"
#include "operators.h"

/* of Deficit: sheets of 1 to 20 particles resist a stretch in their plane within 5 %, whatever the kernel, both ways
   within 16 % */
#define SHEETS          3
#define PLANE_POINTS    64     /* of the integral over a layer of dummy particles */
#define MOMENT_OFF_MOST 0.03   /* largest deviation of a second moment from 1: see SecondMoment */
#define SMALLEST        1e-300 /* added to a divisor that is zero between liquids without viscosity */
#define FILLED_FRACTION 0.98   /* of the kernel's sum: disorder inside the liquid leaves more than this */

/* The divisor of the sum of Morris et al. around particle a. The sum is the Laplacian times the mean second moment
   sum V |F| r^2/dim, the mean of the diagonal of M. A slow flow keeps the initial lattice, whose second moment deviates
   from 1 by up to 1 % at any spacing. The bound is for particles with missing neighbours, where M means something else.
 */
static PetscReal SecondMoment(Cloud cloud, PetscInt a)
{
  const PetscReal *B     = cloud->field[FIELD_CORRECTION] + 6 * a;
  PetscReal        trace = 0;

  for (PetscInt d = 0; d < cloud->domain->dim; d++) trace += B[d];
  return PetscMax(1 - MOMENT_OFF_MOST, PetscMin(1 + MOMENT_OFF_MOST, cloud->domain->dim / trace));
}

/* Whether the force of a pair acts along the line of centres. */
static inline PetscBool IsCentral(ViscosityForm form)
{
  return (PetscBool)(form != VISCOSITY_MORRIS);
}

/* mu: viscosity of each particle, Pa s, in the form of Morris over its second moment. Walls have -1: they take the
   viscosity of their neighbour. Collective. */
static PetscErrorCode CollectViscosity(Cloud cloud, const Viscosity *viscosity, PetscReal mu[])
{
  const PetscReal *stored = cloud->field[FIELD_VISCOSITY];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    const PetscInt body = cloud->integer[INT_BODY][a];

    mu[a] = body < 0 ? -1 : stored ? stored[a] : BodyMaterial(SceneBody(cloud->scene, body))->viscosity;
  }
  if (IsCentral(viscosity->form)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = 0; a < cloud->n_fluid; a++) mu[a] /= SecondMoment(cloud, a);
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, mu));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal OperatorsViscosityFactor(Cloud cloud, ViscosityForm form)
{
  if (form == VISCOSITY_MOMENT) return cloud->domain->dim / KernelMoment(cloud->kernel);
  return form == VISCOSITY_CLEARY ? (PetscReal)(cloud->domain->dim + 2) : 1;
}

/* What a pair counts in a flow along a wall; along2: the square of its extent along the wall, r2: of its distance. */
static PetscReal FormWeight(ViscosityForm form, PetscReal along2, PetscReal r2)
{
  if (form == VISCOSITY_MOMENT) return along2;
  return form == VISCOSITY_CLEARY ? along2 / r2 : 1;
}

/* Tabulates the wall factor over the distance from a flat wall, whose layers of dummy particles begin half a spacing
   behind its face. A linear velocity behind the face needs, for a particle at the distance s and a dummy particle at
   the depth z, the velocity difference times 1 + z/s. The wall factor is the mean of 1 + z/s over the layers, weighted
   with their part in the viscous term of a flow along the wall. */
void OperatorsNoSlip(Cloud cloud, Viscosity *viscosity)
{
  const PetscReal spacing = cloud->domain->spacing, support = KernelSupport(cloud->kernel),
                  eta2 = EtaSquared(cloud->kernel);
  PetscReal r2[PLANE_POINTS], F[PLANE_POINTS];

  viscosity->no_slip = PETSC_TRUE;
  for (PetscInt k = 0; k <= WALL_FACTORS; k++) {
    const PetscReal distance = PetscMax(support * k / WALL_FACTORS, WALL_CLOSEST * spacing);
    PetscReal       sum = 0, moment = 0;

    for (PetscReal depth = 0.5 * spacing; distance + depth < support; depth += spacing) {
      const PetscReal z = distance + depth, reach = PetscSqrtReal(support * support - z * z);

      for (PetscInt m = 0; m < PLANE_POINTS; m++) r2[m] = z * z + PetscSqr(reach * (m + 0.5) / PLANE_POINTS);
      KernelEvaluate(cloud->kernel, PLANE_POINTS, r2, NULL, F);
      for (PetscInt m = 0; m < PLANE_POINTS; m++) {
        const PetscReal rho2 = r2[m] - z * z, part = -F[m] * reach *
                                                     (cloud->domain->dim == 3 ? PetscSqrtReal(rho2) : 1) *
                                                     FormWeight(viscosity->form, rho2, r2[m] + eta2);

        sum += part;
        moment += part * depth;
      }
    }
    viscosity->wall_factor[k] = sum > 0 ? 1 + moment / sum / distance : 1;
  }
}

/* The wall factor of fluid particle a, from its distance to the nearest wall. Dummy particles have the size of the
   liquid beside them. */
static PetscReal WallFactor(Cloud cloud, const Viscosity *viscosity, PetscInt a)
{
  const Domain     domain = cloud->domain;
  const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, support = cloud->size[a] * KernelSupport(cloud->kernel);
  PetscReal        nearest = support, place;
  PetscInt         k;

  if (!viscosity->no_slip) return 1;
  if (cloud->solid_normal) nearest = SceneSolidWithin(cloud->scene, support, x, NULL);
  for (PetscInt d = 0; d < domain->dim; d++) {
    if (domain->face[d][0] == FACE_WALL) nearest = PetscMin(nearest, x[d] - domain->lower[d]);
    if (domain->face[d][1] == FACE_WALL) nearest = PetscMin(nearest, domain->upper[d] - x[d]);
  }
  if (nearest >= support) return 1;
  place = PetscMax(nearest, 0) * WALL_FACTORS / support;
  k     = (PetscInt)place;
  return viscosity->wall_factor[k] + (place - k) * (viscosity->wall_factor[k + 1] - viscosity->wall_factor[k]);
}

PetscBool OperatorsOneLiquid(Cloud cloud)
{
  const Material *first = BodyMaterial(SceneBody(cloud->scene, 0));

  if (cloud->field[FIELD_VISCOSITY]) return PETSC_FALSE;
  for (PetscInt b = 1; b < SceneCount(cloud->scene); b++) {
    const Material *m = BodyMaterial(SceneBody(cloud->scene, b));

    if (m->density != first->density || m->viscosity != first->viscosity) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* The viscous term as a sum over pairs, Eq. (1) of Kuri et al.: a particle's acceleration is

     moment, cleary   sum c_ab (v_ab . r_ab) r_ab       morris   sum c_ab v_ab

   Coefficients computes the c_ab. Explicit steps sum them row by row; implicit steps keep them for all products. For
   one liquid and explicit steps of VISCOSITY_MOMENT, moments.c has the same c_ab, a constant, and sums it during the
   search; OperatorsViscosityRemainder adds what that sum omits. */
typedef struct {
  const Viscosity *viscosity;
  const PetscReal *density;    /* [n_total] kg/m3 */
  PetscReal       *mu;         /* [n_total] Pa s, see CollectViscosity */
  PetscReal       *deficit;    /* [n_total] see FindDeficits */
  PetscReal        scale;      /* zeta V_0 scale_f */
  PetscBool        one_liquid; /* all pairs of the fluid have one density and one viscosity */
  PetscInt        *kept;       /* [ROW_CAPACITY + SIMD_WIDTH] room for LoadRemainder; NULL: all pairs stay */
} Friction;

#define IS_WALL (-1) /* in place of a deficit */

/* Of a particle whose kernel is filled to s = sum V W: what its pairs with its like count more. In VISCOSITY_MOMENT far
   pairs count most, and more of these are missing. */
static PetscReal Deficit(ViscosityForm form, PetscReal s)
{
  return PetscMax(0, form == VISCOSITY_MOMENT ? SHEETS * (FILLED_FRACTION - s) : FILLED_FRACTION / s - 1);
}

/* deficit: [n_total]; 0 if missing neighbours do not count. */
static void FindDeficits(Cloud cloud, ViscosityForm form, PetscBool count, PetscReal deficit[])
{
  const PetscReal *rho = cloud->field[FIELD_DENSITY], *rest = cloud->rest_density;

  for (PetscInt a = 0; a < cloud->n_total; a++)
    deficit[a] = cloud->integer[INT_LAYER][a] ? IS_WALL : count ? Deficit(form, rho[a] / rest[a]) : 0;
}

/* filled: missing neighbours count, if density is the rest density. Collective. */
static PetscErrorCode FrictionBegin(Cloud cloud, const Viscosity *viscosity, const PetscReal density[],
                                    PetscBool filled, Friction *f)
{
  PetscReal scale_w, scale_f, inverse_h2;

  PetscFunctionBegin;
  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  *f = (Friction){.viscosity  = viscosity,
                  .density    = density,
                  .one_liquid = (PetscBool)(density == cloud->rest_density && IsCentral(viscosity->form) &&
                                            OperatorsOneLiquid(cloud)),
                  .scale      = OperatorsViscosityFactor(cloud, viscosity->form) * cloud->domain->volume * scale_f};
  PetscCall(CloudGetWork(cloud, 1, &f->mu));
  PetscCall(CollectViscosity(cloud, viscosity, f->mu));
  PetscCall(CloudGetWork(cloud, 1, &f->deficit));
  FindDeficits(cloud, viscosity->form, (PetscBool)(filled && density == cloud->rest_density), f->deficit);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FrictionEnd(Cloud cloud, Friction *f)
{
  PetscFunctionBegin;
  PetscCall(CloudRestoreWork(cloud, &f->deficit));
  PetscCall(CloudRestoreWork(cloud, &f->mu));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Loads only those pairs of fluid particle a that MultiplyFactors changes. */
static void LoadRemainder(Cloud cloud, const Friction *f, PetscInt a, PairRow *row)
{
  const float    *slope = cloud->slope + cloud->first[a];
  const PetscInt *list = cloud->list + cloud->first[a], count = (PetscInt)(cloud->first[a + 1] - cloud->first[a]);
  const PetscReal least = f->deficit[a] > 0 ? SMALLEST : PETSC_MAX_REAL;
  PetscInt        n     = 0;

  for (PetscInt k = 0; k < count; k++) {
    const PetscReal other = f->deficit[list[k]];

    f->kept[n] = list[k];
    row->f[n]  = slope[k];
    n += (other < 0) | (other >= least);
  }
  for (PetscInt k = n; k < n + SIMD_WIDTH; k++) { /* SumPairs reads multiples of SIMD_WIDTH */
    f->kept[k] = a;
    row->f[k]  = 0;
  }
  row->n     = n;
  row->index = f->kept;
}

/* Multiplies the pairs of fluid particle a with walls by 'factor', and those at rest density whose particles both miss
   neighbours so that the sum has the dissipation of the existing liquid. Without this a sheet of one, two or three
   particles resists stretching with 0.44, 0.58 and 0.74 of its viscosity, on a lattice (test_operators). With
   f->kept the factors are what they exceed 1 by. */
static void MultiplyFactors(const Friction *f, PetscInt a, PetscReal factor, PairRow *row)
{
  const PetscReal *deficit = f->deficit, own = deficit[a], least = f->kept ? 0 : 1, wall = factor - 1;

  SIMD_LOOP()
  for (PetscInt k = 0; k < row->n; k++) {
    const PetscReal other = deficit[row->index[k]];

    row->f[k] *= least + (other < 0 ? wall : 2 * own * other / (own + other + SMALLEST));
  }
}

/* Divides the row by r^2 + eta^2. */
static void DivideByDistance(Cloud cloud, PetscInt a, PairRow *row)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], eta2 = EtaSquared(cloud->kernel);
  const Simd3      p = Simd3Set(x + DIM * a);

  for (PetscInt k = 0; k < row->n; k += SIMD_WIDTH) {
    const SimdOffsets at   = SimdLocate(row->index + k);
    const Simd3       d    = Simd3Difference(PETSC_FALSE, p, Simd3Collect(PETSC_FALSE, x, &at));
    const Simd        size = 0.5 * (SimdSet(cloud->size[a]) + SimdGather(cloud->size, row->index + k)),
               f           = SimdLoad(row->f + k) / (Simd3Dot(PETSC_FALSE, d, d) + eta2 * size * size);

    (void)memcpy(row->f + k, &f, sizeof(f));
  }
}

/* Loads the row of fluid particle a, whose pairs with walls count 'factor' times, with its coefficients

     zeta m_b F (1/rho_a^2 + 1/rho_b^2) 2 mu_a mu_b/(mu_a + mu_b), cleary: over r^2 + eta^2, moment: over s_ab^2,

   with the neighbour's mass m_b = V_b rho_0b, also between liquids of different density. Rings: times the length of a
   ring at the pair's middle over the length of ring a. */
static void Coefficients(Cloud cloud, const Friction *f, PetscInt a, PetscReal factor, PairRow *row)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *rest = cloud->rest_density, *density = f->density, *mu = f->mu;
  const PetscReal  mu_a = mu[a], inverse_a = 1 / (density[a] * density[a]), scale = 2 * f->scale * mu_a;

  if (f->kept)
    LoadRemainder(cloud, f, a, row);
  else
    PairRowLoadFactors(cloud, a, row);
  if (factor != 1 || f->deficit[a] > 0) MultiplyFactors(f, a, factor, row);
  if (f->one_liquid) {
    SIMD_LOOP()
    for (PetscInt k = 0; k < row->n; k++) row->f[k] *= scale / density[a];
  } else {
    SIMD_LOOP()
    for (PetscInt k = 0; k < row->n; k++) {
      const PetscInt  b    = row->index[k];
      const PetscReal mu_b = mu[b] < 0 ? mu_a : mu[b];

      row->f[k] *= scale * rest[b] * (inverse_a + 1 / (density[b] * density[b])) * mu_b / (mu_a + mu_b + SMALLEST);
    }
  }
  if (f->viscosity->form == VISCOSITY_CLEARY) DivideByDistance(cloud, a, row);
  if (f->viscosity->form == VISCOSITY_MOMENT && cloud->domain->graded)
    for (PetscInt k = 0; k < row->n; k++) row->f[k] /= PetscSqr(0.5 * (cloud->size[a] + cloud->size[row->index[k]]));
  if (cloud->domain->rings)
    for (PetscInt k = 0; k < row->n; k++)
      row->f[k] *= DomainPairLength(cloud->domain, x + DIM * a, x + DIM * row->index[k]) / cloud->length[a];
}

PetscReal OperatorsGrowthFriction(Cloud cloud, ViscosityForm form, PetscInt a, PetscReal nu)
{
  const PetscReal length = cloud->length[a] / (2 * PETSC_PI), x = PetscAbsReal(cloud->field[FIELD_POSITION][DIM * a]);
  const PetscReal place = x / (0.5 * cloud->size[a] * KernelSupport(cloud->kernel)) * AXIS_TABLE;
  const PetscInt  k     = (PetscInt)PetscMin(place, (PetscReal)AXIS_TABLE - 1);
  const PetscReal t     = PetscMin(place - k, 1);

  if (!cloud->domain->rings) return 0;
  if (form != VISCOSITY_MOMENT) return -nu / PetscSqr(length);
  return -nu * ((1 - t) * cloud->axis[k] + t * cloud->axis[k + 1]) / (length * (x + SMALLEST));
}

static PetscReal GrowthFriction(Cloud cloud, const Friction *f, PetscInt a)
{
  return IsCentral(f->viscosity->form) ? OperatorsGrowthFriction(cloud, f->viscosity->form, a, f->mu[a] / f->density[a])
                                       : 0;
}

/* The factor of v_r of ring a over that of v_r of ring b, in the form of Morris. Along the axis the sum is the
   Laplacian. The radial sum has v_r/r in place of v, and the lengths of both rings as further weights: lap v_r -
   v_r/r^2 = (r^3 (v_r/r)')'/r^2 + v_r,zz. Axial momentum is conserved, and energy dissipates. The sum vanishes for v_z
   = 1 and for v_r = r, except near the axis (DomainRingLength). */
static inline PetscReal GrowthRatio(Cloud cloud, PetscInt a, PetscInt b)
{
  return cloud->length[b] / cloud->length[a];
}

/* The radial part of ring a's sum in the form of Morris that pairs of other particles do not have. */
static PetscReal MorrisGrowth(Cloud cloud, PetscInt a, PetscInt n, const PetscInt index[], const PetscReal c[],
                              const PetscReal v[])
{
  PetscReal sum = 0;

  for (PetscInt k = 0; k < n; k++) {
    const PetscInt b = index[k];

    sum += c[k] * (GrowthRatio(cloud, a, b) - 1) * v[DIM * a];
    if (cloud->field[FIELD_POSITION][DIM * b] < 0) sum += 2 * c[k] * v[DIM * b]; /* its image grows the other way */
  }
  return sum;
}

/* Adds SIMD_WIDTH pairs with coefficients f to the sum of a particle at p with the velocity 'own'. */
static inline void AddPairs(ViscosityForm form, const PetscInt index[], Simd f, const PetscReal x[],
                            const PetscReal v[], Simd3 p, Simd3 own, Simd3 *sum)
{
  const SimdOffsets at = SimdLocate(index);
  const Simd3       u  = Simd3Difference(PETSC_FALSE, own, Simd3Collect(PETSC_FALSE, v, &at));

  if (IsCentral(form)) {
    const Simd3 d = Simd3Difference(PETSC_FALSE, p, Simd3Collect(PETSC_FALSE, x, &at));

    Simd3Add(PETSC_FALSE, sum, f * Simd3Dot(PETSC_FALSE, u, d), d);
  } else
    Simd3Add(PETSC_FALSE, sum, f, u);
}

/* out: the sum over the n pairs of fluid particle a with coefficients c. index and c are readable up to the next
   multiple of SIMD_WIDTH. */
static inline void SumForm(Cloud cloud, ViscosityForm form, PetscInt a, PetscInt n, const PetscInt index[],
                           const PetscReal c[], const PetscReal v[], PetscReal out[DIM])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];
  const Simd3      p = Simd3Set(x + DIM * a), own = Simd3Set(v + DIM * a);
  const Simd       zero = SimdSet(0);
  Simd3            sum  = {zero, zero, zero};
  PetscInt         k    = 0;

  for (; k + SIMD_WIDTH <= n; k += SIMD_WIDTH) AddPairs(form, index + k, SimdLoad(c + k), x, v, p, own, &sum);
  if (k < n) AddPairs(form, index + k, SimdFirst(SimdLoad(c + k), n - k), x, v, p, own, &sum);
  Vec4Store(Simd3Sum(sum, zero), out);
}

static void SumPairs(Cloud cloud, ViscosityForm form, PetscInt a, PetscInt n, const PetscInt index[],
                     const PetscReal c[], const PetscReal v[], PetscReal out[DIM])
{
  if (IsCentral(form))
    SumForm(cloud, VISCOSITY_CLEARY, a, n, index, c, v, out);
  else
    SumForm(cloud, VISCOSITY_MORRIS, a, n, index, c, v, out);
  if (form == VISCOSITY_MORRIS && cloud->domain->rings) out[0] += MorrisGrowth(cloud, a, n, index, c, v);
}

PetscErrorCode OperatorsViscosityRemainder(Cloud cloud, const Viscosity *viscosity)
{
  Friction f;
  PairRow  row;
  PetscInt kept[ROW_CAPACITY + SIMD_WIDTH];

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_VISCOSITY), 0, 0, 0, 0));
  PetscCall(FrictionBegin(cloud, viscosity, cloud->rest_density, PETSC_TRUE, &f));
  f.kept = kept;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal factor = WallFactor(cloud, viscosity, a);
    PetscReal       sum[DIM];

    if (f.deficit[a] == 0 && factor == 1) continue;
    Coefficients(cloud, &f, a, factor, &row);
    SumPairs(cloud, viscosity->form, a, row.n, row.index, row.f, cloud->field[FIELD_VELOCITY], sum);
    for (PetscInt d = 0; d < DIM; d++) cloud->field[FIELD_ACCELERATION][DIM * a + d] += sum[d];
  }
  PetscCall(FrictionEnd(cloud, &f));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_VISCOSITY), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OperatorsWallDrag(Cloud cloud, const Viscosity *viscosity, const PetscReal velocity[], PetscReal drag[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *v = velocity;
  Friction         f;
  PairRow          row;

  PetscFunctionBegin;
  PetscCall(FrictionBegin(cloud, viscosity, cloud->rest_density, PETSC_FALSE, &f));
  PetscCall(PetscArrayzero(drag, DIM * cloud->n_total));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    if (f.mu[a] <= 0 || !OperatorsNearWall(cloud, x + DIM * a)) continue;
    Coefficients(cloud, &f, a, WallFactor(cloud, viscosity, a), &row);
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt b = row.index[k];
      PetscReal      d[DIM], u[DIM], c = cloud->volume[a] * cloud->rest_density[a] * row.f[k];

      if (!cloud->integer[INT_LAYER][b]) continue;
      for (PetscInt i = 0; i < DIM; i++) {
        d[i] = x[DIM * a + i] - x[DIM * b + i];
        u[i] = v[DIM * a + i] - v[DIM * b + i];
      }
      if (IsCentral(viscosity->form)) c *= Dot(u, d);
      for (PetscInt i = 0; i < DIM; i++) drag[DIM * b + i] -= c * (IsCentral(viscosity->form) ? d[i] : u[i]);
    }
  }
  PetscCall(FrictionEnd(cloud, &f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OperatorsViscosity(Cloud cloud, const Viscosity *viscosity, const PetscReal density[])
{
  const PetscReal *v = cloud->field[FIELD_VELOCITY];
  Friction         f;
  PairRow          row;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_VISCOSITY), 0, 0, 0, 0));
  PetscCall(FrictionBegin(cloud, viscosity, density, PETSC_TRUE, &f));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal *acceleration = cloud->field[FIELD_ACCELERATION] + DIM * a, sum[DIM];

    if (f.mu[a] <= 0) continue;
    Coefficients(cloud, &f, a, WallFactor(cloud, viscosity, a), &row);
    SumPairs(cloud, viscosity->form, a, row.n, row.index, row.f, v, sum);
    acceleration[0] += GrowthFriction(cloud, &f, a) * v[DIM * a];
    for (PetscInt d = 0; d < DIM; d++) acceleration[d] += sum[d];
  }
  PetscCall(FrictionEnd(cloud, &f));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_VISCOSITY), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt64 OperatorsViscosityRoom(Cloud cloud)
{
  return cloud->first[cloud->n_fluid] + cloud->n_fluid + SIMD_WIDTH; /* SumPairs reads multiples of SIMD_WIDTH */
}

PetscErrorCode OperatorsViscosityPairs(Cloud cloud, const Viscosity *viscosity, const PetscReal density[],
                                       PetscReal pair[])
{
  Friction f;
  PairRow  row;

  PetscFunctionBegin;
  PetscCall(FrictionBegin(cloud, viscosity, density, PETSC_TRUE, &f));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    Coefficients(cloud, &f, a, WallFactor(cloud, viscosity, a), &row);
    PetscCall(PetscArraycpy(pair + cloud->first[a], row.f, row.n));
    pair[cloud->first[cloud->n_fluid] + a] = GrowthFriction(cloud, &f, a);
  }
  PetscCall(FrictionEnd(cloud, &f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void OperatorsViscosityRow(Cloud cloud, const Viscosity *viscosity, const PetscReal pair[], PetscInt a,
                           const PetscReal velocity[], PetscReal out[DIM])
{
  const PetscInt64 first = cloud->first[a];

  SumPairs(cloud, viscosity->form, a, (PetscInt)(cloud->first[a + 1] - first), cloud->list + first, pair + first,
           velocity, out);
  out[0] += pair[cloud->first[cloud->n_fluid] + a] * velocity[DIM * a];
}

PetscErrorCode OperatorsViscosityApply(Cloud cloud, const Viscosity *viscosity, const PetscReal pair[],
                                       PetscReal velocity[], PetscReal out[])
{
  PetscFunctionBegin;
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, velocity));
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    OperatorsViscosityRow(cloud, viscosity, pair, a, velocity, out + DIM * a);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OperatorsViscosityDiagonal(Cloud cloud, const Viscosity *viscosity, const PetscReal pair[],
                                          PetscReal diagonal[])
{
  const PetscReal *x      = cloud->field[FIELD_POSITION];
  const PetscBool  cleary = IsCentral(viscosity->form);

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal *d = diagonal + DIM * a;

    d[0] = pair[cloud->first[cloud->n_fluid] + a];
    d[1] = d[2] = 0;
    for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
      const PetscInt  b = cloud->list[k];
      const PetscReal c = pair[k];

      for (PetscInt i = 0; i < DIM; i++) d[i] += c * (cleary ? PetscSqr(x[DIM * a + i] - x[DIM * b + i]) : 1);
      if (!cleary) d[0] += c * (GrowthRatio(cloud, a, b) - 1);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
