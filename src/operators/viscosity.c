/* The viscous term of a velocity field, explicit or as a linear operator, and its factor on walls that gives no slip.
 */
#include "../neighbors/pairs.h"
#include "operators.h"

#define PLANE_POINTS    64   /* of the integral over a layer of dummy particles */
#define MOMENT_OFF_MOST 0.03 /* by which a second moment may be off 1: see SecondMoment */
#define FILLED_SHARE    0.98 /* of the kernel: disorder inside the liquid leaves more */

/* What the sum of Morris et al. around particle a must be divided by: it is the Laplacian times the mean second moment
   sum V |F| r^2/dim of the neighbours, the mean of the diagonal of M, which on a lattice that a slow flow keeps is up
   to a hundredth off 1 however fine the spacing is. Where neighbours are missing it is not that. */
static PetscReal SecondMoment(Cloud cloud, PetscInt a)
{
  const PetscReal *B     = cloud->field[FIELD_CORRECTION] + 6 * a;
  PetscReal        trace = 0;

  for (PetscInt d = 0; d < cloud->domain->dim; d++) trace += B[d];
  return PetscMax(1 - MOMENT_OFF_MOST, PetscMin(1 + MOMENT_OFF_MOST, cloud->domain->dim / trace));
}

/* The viscosity of each particle, Pa s, in the form of Morris over its second moment. -1 marks walls, which take that
   of their neighbour. Collective. */
static PetscErrorCode CollectViscosity(Cloud cloud, const Viscosity *viscosity, PetscReal mu[])
{
  const PetscBool  varies = SceneViscosityVaries(cloud->scene);
  const PetscReal *stored = cloud->field[FIELD_VISCOSITY];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    const PetscInt body = cloud->integer[INT_BODY][a];

    mu[a] = body < 0 ? -1 : varies ? stored[a] : BodyMaterial(SceneBody(cloud->scene, body))->viscosity;
  }
  if (viscosity->form == VISCOSITY_CLEARY) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = 0; a < cloud->n_fluid; a++) mu[a] /= SecondMoment(cloud, a);
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, mu));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The factor zeta of the form: see ViscosityForm. */
static PetscReal FormFactor(Cloud cloud, ViscosityForm form)
{
  return form == VISCOSITY_CLEARY ? (PetscReal)(cloud->domain->dim + 2) : 1;
}

/* The factor on wall friction that gives no slip at the face, as a table over the distance from a flat wall whose
   layers of dummy particles begin half a spacing behind its face. A dummy at depth z behind the face, seen from a
   particle at the distance s in front of it, must carry the velocity difference times 1 + z/s if the velocity is to go
   on straight behind the face. The factor is the mean of that over the layers, each weighted with its part in the
   viscous term of a flow along the wall. */
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
                                                     (viscosity->form == VISCOSITY_CLEARY ? rho2 / (r2[m] + eta2) : 1);

        sum += part;
        moment += part * depth;
      }
    }
    viscosity->wall_factor[k] = sum > 0 ? 1 + moment / sum / distance : 1;
  }
}

/* The factor on wall friction of fluid particle a, from its distance to the nearest wall. Dummy particles of walls have
   the size of the liquid beside them. */
static PetscReal WallFactor(Cloud cloud, const Viscosity *viscosity, PetscInt a)
{
  const Domain     domain = cloud->domain;
  const PetscReal *x      = cloud->field[FIELD_POSITION] + DIM * a,
                  support = CloudSize(cloud, a) * KernelSupport(cloud->kernel);
  PetscReal nearest       = cloud->solid_normal ? SceneSolidDistance(cloud->scene, x, NULL) : support, place;
  PetscInt  k;

  if (!viscosity->no_slip) return 1;
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

  if (SceneViscosityVaries(cloud->scene)) return PETSC_FALSE;
  for (PetscInt b = 1; b < SceneCount(cloud->scene); b++) {
    const Material *m = BodyMaterial(SceneBody(cloud->scene, b));

    if (m->density != first->density || m->viscosity != first->viscosity) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* Multiplies the row's factors by m_b (1/rho_a^2 + 1/rho_b^2) 2 mu_a mu_b/(mu_a + mu_b), m_b = V_b rho_0b, which also
   holds between liquids of different density. 'one': there is one liquid only, at its rest density. */
static void MultiplyViscosity(Cloud cloud, PetscBool one, PetscInt a, const PetscReal density[], const PetscReal mu[],
                              PairRow *row)
{
  const PetscReal *rest = cloud->rest_density, V = cloud->domain->volume, mu_a = mu[a],
                  inverse_a = 1 / (density[a] * density[a]), same = V * 2 * mu_a / density[a];

  if (one) {
    SIMD_LOOP()
    for (PetscInt k = 0; k < row->n; k++) row->f[k] *= same;
    return;
  }
  SIMD_LOOP()
  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt  b    = row->index[k];
    const PetscReal mu_b = mu[b] < 0 ? mu_a : mu[b];

    row->f[k] *= V * rest[b] * (inverse_a + 1 / (density[b] * density[b])) * 2 * mu_a * mu_b / (mu_a + mu_b);
  }
}

/* The sum of Eq. (1) of Kuri et al. for particle a, from factors that are divided by r2 + eta2. */
static void ViscosityCleary(Cloud cloud, PetscInt a, const PairRow *row, const PetscReal v[], PetscReal out[DIM])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];
  const Simd3      p = Simd3Set(x + DIM * a), own = Simd3Set(v + DIM * a);
  const Simd       zero = SimdSet(0);
  Simd3            sum  = {zero, zero, zero};

  for (PetscInt k = 0; k < row->n; k += SIMD_WIDTH) {
    const SimdOffsets at = SimdLocate(row->index + k);
    const Simd3       d = Simd3Difference(p, Simd3Collect(x, &at)), u = Simd3Difference(own, Simd3Collect(v, &at));

    Simd3Add(&sum, SimdLoad(row->f + k) * Simd3Dot(u, d), d);
  }
  Vec4Store(Simd3Sum(sum, zero), out);
}

/* The sum of Morris et al. 1997 for particle a. grad W.r/r2 is finite at r = 0, so eta is not needed. */
static void ViscosityMorris(PetscInt a, const PairRow *row, const PetscReal v[], PetscReal out[DIM])
{
  const Simd3 own  = Simd3Set(v + DIM * a);
  const Simd  zero = SimdSet(0);
  Simd3       sum  = {zero, zero, zero};

  for (PetscInt k = 0; k < row->n; k += SIMD_WIDTH) {
    const SimdOffsets at = SimdLocate(row->index + k);

    Simd3Add(&sum, SimdLoad(row->f + k), Simd3Difference(own, Simd3Collect(v, &at)));
  }
  Vec4Store(Simd3Sum(sum, zero), out);
}

/* The same for rings, r and z: each pair has the length of its middle (DomainPairLength). Along the axis the sum is
   that of the Laplacian; away from it v_r/r takes the place of v, with the lengths of both rings as further weights:
   lap v_r - v_r/r2 = (r^3 (v_r/r)')'/r2 + v_r,zz. Momentum along the axis is kept, energy is only lost, and neither
   v_z = 1 nor v_r = r is slowed down, up to how the first half spacing is counted (DomainRingLength). */
static void ViscosityRings(Cloud cloud, PetscInt a, const PairRow *row, const PetscReal v[], PetscReal out[DIM])
{
  const Domain     domain = cloud->domain;
  const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, length_a = CloudRingLength(cloud, a),
                  growth_a = v[DIM * a] / length_a;

  out[0] = out[1] = out[2] = 0;
  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt   b        = row->index[k];
    const PetscReal *y        = cloud->field[FIELD_POSITION] + DIM * b;
    const PetscReal  length_b = CloudRingLength(cloud, b), f = row->f[k] * DomainPairLength(domain, x, y) / length_a;

    out[0] += f * (length_b * growth_a - (y[0] < 0 ? -1 : 1) * v[DIM * b]);
    out[1] += f * (v[DIM * a + 1] - v[DIM * b + 1]);
  }
}

/* Multiplies the row's factors by the length of each pair's middle over that of ring a. */
static void MultiplyLengths(Cloud cloud, PetscInt a, PairRow *row)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], length_a = CloudRingLength(cloud, a);

  for (PetscInt k = 0; k < row->n; k++)
    row->f[k] *= DomainPairLength(cloud->domain, x + DIM * a, x + DIM * row->index[k]) / length_a;
}

/* The rate (1/s) at which ring a's growth is resisted in the form of Cleary: -nu v_r/R2. The pairs in the plane lose 2
   S:S + (tr S)2 times mu, of the rate of strain S in it; its trace is -v_r/r, for all three directions together do not
   change the volume. The loss in all is 2 S:S + 2 (v_r/r)2, so that (v_r/r)2 remains for the growth. */
static PetscReal GrowthFriction(Cloud cloud, PetscInt a, PetscReal nu)
{
  const PetscReal r = CloudRingLength(cloud, a) / (2 * PETSC_PI);

  return -nu / (r * r);
}

/* Divides the row's factors F by r2 + eta2 (m2). */
static void DivideByDistance(Cloud cloud, PetscInt a, PetscReal eta2, PairRow *row)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], x0 = x[DIM * a], x1 = x[DIM * a + 1], x2 = x[DIM * a + 2];

  for (PetscInt k = 0; k < row->n && cloud->size; k++) {
    const PetscInt   b      = row->index[k];
    const PetscReal *at     = x + DIM * b;
    const PetscReal  d[DIM] = {x0 - at[0], x1 - at[1], x2 - at[2]};

    row->f[k] /= Dot(d, d) + eta2 * PetscSqr(CloudPairSize(cloud, a, b));
  }
  if (cloud->size) return;
  SIMD_LOOP()
  for (PetscInt k = 0; k < row->n; k++) {
    const PetscReal *at = x + DIM * row->index[k];

    row->f[k] /= PetscSqr(x0 - at[0]) + PetscSqr(x1 - at[1]) + PetscSqr(x2 - at[2]) + eta2;
  }
}

/* By how much more than 1 a particle must weigh because a share s = sum V W of its kernel is filled: 1/s - 1, from a
   share on that disorder inside the liquid leaves; 0 of walls. [n_total]. */
static void FindLack(Cloud cloud, PetscReal lack[])
{
  const PetscReal *rho = cloud->field[FIELD_DENSITY], *rest = cloud->rest_density;

  for (PetscInt a = 0; a < cloud->n_total; a++)
    lack[a] = cloud->integer[INT_LAYER][a] ? 0 : PetscMax(0, FILLED_SHARE * rest[a] / rho[a] - 1);
}

/* By what a pair of particles at rest density must weigh more where neighbours of both are missing, so that the sum is
   the dissipation of the liquid that there is. On a lattice a sheet of one, two or three particles resists a stretch
   with 0.53, 0.75 and 0.88 of its viscosity without it (test_operators). */
static inline PetscReal Filling(PetscReal own, PetscReal other)
{
  return own > 0 && other > 0 ? 1 + 2 * own * other / (own + other) : 1;
}

PetscErrorCode OperatorsFrictionRest(Cloud cloud, const Viscosity *viscosity)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *v = cloud->field[FIELD_VELOCITY],
                  eta2   = EtaSquared(cloud->kernel);
  const Material *liquid = BodyMaterial(SceneBody(cloud->scene, 0));
  PetscReal       scale_w, scale_f, inverse_h2, scale, *lack;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_VISCOSITY), 0, 0, 0, 0));
  PetscCall(CloudGetWork(cloud, 1, &lack));
  FindLack(cloud, lack);
  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  scale =
    FormFactor(cloud, VISCOSITY_CLEARY) * cloud->domain->volume * 2 * liquid->viscosity / liquid->density * scale_f;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal factor  = WallFactor(cloud, viscosity, a);
    const PetscBool missing = (PetscBool)(lack[a] > 0);
    PetscReal      *out     = cloud->field[FIELD_ACCELERATION] + DIM * a;
    PairRow         row;

    if (factor == 1 && !missing) continue;
    PairRowLoadFactors(cloud, a, &row);
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt  b     = row.index[k];
      const PetscReal times = cloud->integer[INT_LAYER][b] ? factor : missing ? Filling(lack[a], lack[b]) : 1;
      PetscReal       d[DIM], u[DIM], f;

      if (times == 1) continue;
      for (PetscInt i = 0; i < DIM; i++) {
        d[i] = x[DIM * a + i] - x[DIM * b + i];
        u[i] = v[DIM * a + i] - v[DIM * b + i];
      }
      f = (times - 1) * scale * row.f[k] * Dot(u, d) / (Dot(d, d) + eta2 * PetscSqr(CloudPairSize(cloud, a, b)));
      for (PetscInt i = 0; i < DIM; i++) out[i] += f * d[i];
    }
  }
  PetscCall(CloudRestoreWork(cloud, &lack));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_VISCOSITY), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The row of fluid particle a with its factors in the viscous sum, but zeta and scale_f. lack: of FindLack, or NULL. */
static inline void LoadViscousRow(Cloud cloud, const Viscosity *viscosity, PetscBool one, PetscInt a,
                                  const PetscReal density[], const PetscReal mu[], const PetscReal lack[], PairRow *row)
{
  PetscReal factor;

  PairRowLoadFactors(cloud, a, row);
  if (viscosity->form == VISCOSITY_CLEARY) DivideByDistance(cloud, a, EtaSquared(cloud->kernel), row);
  MultiplyViscosity(cloud, one, a, density, mu, row);
  if (lack && lack[a] > 0)
    for (PetscInt k = 0; k < row->n; k++) row->f[k] *= Filling(lack[a], lack[row->index[k]]);
  factor = WallFactor(cloud, viscosity, a);
  if (factor != 1)
    for (PetscInt k = 0; k < row->n; k++)
      if (cloud->integer[INT_LAYER][row->index[k]]) row->f[k] *= factor;
  if (viscosity->form == VISCOSITY_CLEARY && cloud->domain->rings) MultiplyLengths(cloud, a, row);
}

PetscErrorCode OperatorsWallDrag(Cloud cloud, const Viscosity *viscosity, const PetscReal velocity[], PetscReal drag[])
{
  const Domain     domain = cloud->domain;
  const PetscReal *x = cloud->field[FIELD_POSITION], *v = velocity, zeta = FormFactor(cloud, viscosity->form);
  PetscReal       *mu, scale_w, scale_f, inverse_h2;
  PairRow          row;

  PetscFunctionBegin;
  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  PetscCall(CloudGetWork(cloud, 1, &mu));
  PetscCall(CollectViscosity(cloud, viscosity, mu));
  PetscCall(PetscArrayzero(drag, DIM * cloud->n_total));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal mass = cloud->volume[a] * cloud->rest_density[a];

    if (mu[a] <= 0 || !OperatorsNearWall(cloud, x + DIM * a)) continue;
    LoadViscousRow(cloud, viscosity, PETSC_FALSE, a, cloud->rest_density, mu, NULL, &row);
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt b = row.index[k];
      PetscReal      d[DIM], u[DIM], f = mass * zeta * scale_f * row.f[k];

      if (!cloud->integer[INT_LAYER][b]) continue;
      for (PetscInt i = 0; i < DIM; i++) {
        d[i] = x[DIM * a + i] - x[DIM * b + i];
        u[i] = v[DIM * a + i] - v[DIM * b + i];
      }
      if (viscosity->form == VISCOSITY_CLEARY)
        f *= Dot(u, d);
      else if (domain->rings)
        f *= DomainPairLength(domain, x + DIM * a, x + DIM * b) / CloudRingLength(cloud, a);
      for (PetscInt i = 0; i < DIM; i++) drag[DIM * b + i] -= f * (viscosity->form == VISCOSITY_CLEARY ? d[i] : u[i]);
    }
  }
  PetscCall(CloudRestoreWork(cloud, &mu));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OperatorsViscosity(Cloud cloud, const Viscosity *viscosity, const PetscReal density[])
{
  const PetscReal *v    = cloud->field[FIELD_VELOCITY];
  const PetscReal  zeta = FormFactor(cloud, viscosity->form);
  const PetscBool  one =
    (PetscBool)(density == cloud->rest_density && viscosity->form == VISCOSITY_CLEARY && OperatorsOneLiquid(cloud));
  PetscReal *mu, *lack, *acceleration = cloud->field[FIELD_ACCELERATION], scale_w, scale_f, inverse_h2;
  PairRow    row;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_VISCOSITY), 0, 0, 0, 0));
  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  PetscCall(CloudGetWork(cloud, 1, &mu));
  PetscCall(CollectViscosity(cloud, viscosity, mu));
  PetscCall(CloudGetWork(cloud, 1, &lack));
  FindLack(cloud, lack);
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal sum[DIM];

    if (mu[a] <= 0) continue;
    LoadViscousRow(cloud, viscosity, one, a, density, mu, density == cloud->rest_density ? lack : NULL, &row);
    if (viscosity->form == VISCOSITY_CLEARY && cloud->domain->rings)
      acceleration[DIM * a] += GrowthFriction(cloud, a, mu[a] / density[a]) * v[DIM * a];
    if (viscosity->form == VISCOSITY_CLEARY)
      ViscosityCleary(cloud, a, &row, v, sum);
    else if (cloud->domain->rings)
      ViscosityRings(cloud, a, &row, v, sum);
    else
      ViscosityMorris(a, &row, v, sum);
    for (PetscInt d = 0; d < DIM; d++) acceleration[DIM * a + d] += zeta * scale_f * sum[d];
  }
  PetscCall(CloudRestoreWork(cloud, &lack));
  PetscCall(CloudRestoreWork(cloud, &mu));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_VISCOSITY), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Turns the volumes of the neighbours in the coefficients of rings into areas, and multiplies by the length of each
   pair's middle over that of the ring; and sets the coefficients of their growth. Not inlined, as HoopDivergence is
   not: other dimensions keep their rounding. */
__attribute__((noinline)) static void WeighRings(Cloud cloud, const Viscosity *viscosity, const PetscReal mu[],
                                                 const PetscReal density[], PetscReal pair[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];

  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal length_a = CloudRingLength(cloud, a);

    for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
      const PetscInt b = cloud->list[k];

      pair[k] *= DomainPairLength(cloud->domain, x + DIM * a, x + DIM * b) / (length_a * CloudRingLength(cloud, b));
    }
    pair[cloud->first[cloud->n_fluid] + a] =
      viscosity->form == VISCOSITY_CLEARY ? GrowthFriction(cloud, a, mu[a] / density[a]) : 0;
  }
}

/* The factor of v_r of ring a in the pair with b in the form of Morris, over that of b's. */
static inline PetscReal GrowthRatio(Cloud cloud, PetscInt a, PetscInt b)
{
  return CloudRingLength(cloud, b) / CloudRingLength(cloud, a);
}

/* Products of the operator of rings, of the form of Morris as in ViscosityRings. */
__attribute__((noinline)) static void ApplyRings(Cloud cloud, const Viscosity *viscosity, const PetscReal pair[],
                                                 const PetscReal v[], PetscReal out[])
{
  const PetscBool cleary = (PetscBool)(viscosity->form == VISCOSITY_CLEARY);
  PairRow         row;

  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *c = pair + cloud->first[a], *own = v + DIM * a;
    PetscReal        sum[DIM] = {pair[cloud->first[cloud->n_fluid] + a] * own[0], 0, 0};

    PairRowLoadGeometry(cloud, cloud->field[FIELD_POSITION], a, &row);
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt   b     = row.index[k];
      const PetscReal *other = v + DIM * b, side = cloud->field[FIELD_POSITION][DIM * b] < 0 ? -1 : 1;
      const PetscReal  f = c[k] * ((own[0] - other[0]) * row.dx[k] + (own[1] - other[1]) * row.dy[k]);

      sum[0] += cleary ? f * row.dx[k] : c[k] * (GrowthRatio(cloud, a, b) * own[0] - side * other[0]);
      sum[1] += cleary ? f * row.dy[k] : c[k] * (own[1] - other[1]);
    }
    for (PetscInt d = 0; d < DIM; d++) out[DIM * a + d] = sum[d];
  }
}

PetscErrorCode OperatorsViscosityPairs(Cloud cloud, const Viscosity *viscosity, const PetscReal density[],
                                       PetscReal pair[])
{
  const PetscReal *volume = cloud->volume, *rest = cloud->rest_density;
  const PetscReal  eta2 = EtaSquared(cloud->kernel), zeta = FormFactor(cloud, viscosity->form);
  PetscReal       *mu, *lack;
  PairRow          row;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, 1, &mu));
  PetscCall(CollectViscosity(cloud, viscosity, mu));
  PetscCall(CloudGetWork(cloud, 1, &lack));
  FindLack(cloud, lack);
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal      *c      = pair + cloud->first[a];
    const PetscReal factor = WallFactor(cloud, viscosity, a);

    PairRowLoadGeometry(cloud, cloud->field[FIELD_POSITION], a, &row);
    PairRowGradient(cloud, a, &row);
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt  b    = row.index[k];
      const PetscReal mu_b = mu[b] < 0 ? mu[a] : mu[b], sum = mu[a] + mu_b;

      c[k] = sum > 0 ? volume[b] * rest[b] * zeta * (1 / PetscSqr(density[a]) + 1 / PetscSqr(density[b])) * 2 * mu[a] *
                         mu_b / sum * row.F[k]
                     : 0;
      if (viscosity->form == VISCOSITY_CLEARY) c[k] /= row.r2[k] + eta2 * PetscSqr(CloudPairSize(cloud, a, b));
      if (cloud->integer[INT_LAYER][b]) c[k] *= factor;
      if (density == rest) c[k] *= Filling(lack[a], lack[b]);
    }
  }
  if (cloud->domain->rings) WeighRings(cloud, viscosity, mu, density, pair);
  PetscCall(CloudRestoreWork(cloud, &lack));
  PetscCall(CloudRestoreWork(cloud, &mu));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OperatorsViscosityApply(Cloud cloud, const Viscosity *viscosity, const PetscReal pair[],
                                       PetscReal velocity[], PetscReal out[])
{
  const PetscReal *v = velocity;
  PairRow          row;

  PetscFunctionBegin;
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, velocity));
  if (cloud->domain->rings) {
    ApplyRings(cloud, viscosity, pair, v, out);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *restrict c = pair + cloud->first[a];
    const PetscReal vx = v[3 * a], vy = v[3 * a + 1], vz = v[3 * a + 2];
    PetscReal       ax = 0, ay = 0, az = 0;

    PairRowLoadGeometry(cloud, cloud->field[FIELD_POSITION], a, &row);
    if (viscosity->form == VISCOSITY_CLEARY) {
      SIMD_LOOP(reduction(+ : ax, ay, az))
      for (PetscInt k = 0; k < row.n; k++) {
        const PetscInt  b = row.index[k];
        const PetscReal f =
          c[k] * ((vx - v[3 * b]) * row.dx[k] + (vy - v[3 * b + 1]) * row.dy[k] + (vz - v[3 * b + 2]) * row.dz[k]);

        ax += f * row.dx[k];
        ay += f * row.dy[k];
        az += f * row.dz[k];
      }
    } else {
      SIMD_LOOP(reduction(+ : ax, ay, az))
      for (PetscInt k = 0; k < row.n; k++) {
        const PetscInt b = row.index[k];

        ax += c[k] * (vx - v[3 * b]);
        ay += c[k] * (vy - v[3 * b + 1]);
        az += c[k] * (vz - v[3 * b + 2]);
      }
    }
    out[3 * a]     = ax;
    out[3 * a + 1] = ay;
    out[3 * a + 2] = az;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The diagonal for ring a. */
__attribute__((noinline)) static void DiagonalOfRing(Cloud cloud, const Viscosity *viscosity, PetscInt a,
                                                     const PairRow *row, const PetscReal pair[], PetscReal d[DIM])
{
  const PetscBool  cleary = (PetscBool)(viscosity->form == VISCOSITY_CLEARY);
  const PetscReal *c      = pair + cloud->first[a];

  d[0] = pair[cloud->first[cloud->n_fluid] + a];
  d[1] = d[2] = 0;
  for (PetscInt k = 0; k < row->n; k++) {
    d[0] += c[k] * (cleary ? PetscSqr(row->dx[k]) : GrowthRatio(cloud, a, row->index[k]));
    d[1] += c[k] * (cleary ? PetscSqr(row->dy[k]) : 1);
  }
}

PetscErrorCode OperatorsViscosityDiagonal(Cloud cloud, const Viscosity *viscosity, const PetscReal pair[],
                                          PetscReal diagonal[])
{
  PairRow row;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *c = pair + cloud->first[a];
    PetscReal       *d = diagonal + DIM * a;

    d[0] = d[1] = d[2] = 0;
    PairRowLoadGeometry(cloud, cloud->field[FIELD_POSITION], a, &row);
    if (cloud->domain->rings) {
      DiagonalOfRing(cloud, viscosity, a, &row, pair, d);
      continue;
    }
    for (PetscInt k = 0; k < row.n; k++) {
      d[0] += c[k] * (viscosity->form == VISCOSITY_CLEARY ? PetscSqr(row.dx[k]) : 1);
      d[1] += c[k] * (viscosity->form == VISCOSITY_CLEARY ? PetscSqr(row.dy[k]) : 1);
      d[2] += c[k] * (viscosity->form == VISCOSITY_CLEARY ? PetscSqr(row.dz[k]) : 1);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
