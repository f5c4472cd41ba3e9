/* The acceleration -grad p/rho of the fluid.

     symmetric   -sum_b m_b (p_a/rho_a^2 + p_b/rho_b^2) grad W: Eq. (9) of Kuri et al., conserves momentum
     corrected   -B_a sum_b V (p_b - p_a) 2/(rho_a + rho_b) grad W and a background pressure inside, symmetric near the
                 surface; of what differs from the pressure that is carried (balance.c)
     conserved   corrected; neighbours compensate the momentum that differs from symmetric */
#include "pressure_impl.h"

#define PAIRING 0.1 /* the term against pairing over the background pressure: see GradientCorrected */

/* -sum c (r_a - r_b) over the row of a. c is padded to a multiple of SIMD_WIDTH, as the row's factors are. */
static void SumAlong(Cloud cloud, PetscInt a, const PairRow *row, const PetscReal c[], PetscReal out[DIM])
{
  const PetscReal *x    = cloud->field[FIELD_POSITION];
  const Simd3      p    = Simd3Set(x + DIM * a);
  const Simd       zero = SimdSet(0);
  Simd3            sum  = {zero, zero, zero};

  for (PetscInt k = 0; k < row->n; k += SIMD_WIDTH) {
    const SimdOffsets at = SimdLocate(row->index + k);

    Simd3Add(PETSC_FALSE, &sum, SimdLoad(c + k), Simd3Difference(PETSC_FALSE, Simd3Collect(PETSC_FALSE, x, &at), p));
  }
  Vec4Store(Simd3Sum(sum, zero), out);
}

/* Adds the acceleration by a slope of the pressure outside to that by Eq. (9). */
static void AddSlope(Pressure pressure, PetscInt a, const PetscReal slope[DIM], PetscReal out[DIM])
{
  const Cloud cloud = pressure->cloud;
  PetscReal   M[6], part[DIM];

  SymmetricInverse(cloud->domain->dim, cloud->field[FIELD_CORRECTION] + 6 * a, M);
  TensorApply(M, slope[0], slope[1], slope[2], part);
  for (PetscInt d = 0; d < DIM; d++) out[d] -= (slope[d] - part[d]) / PressureDensity(pressure)[a];
}

void PressureSlopeAcceleration(Pressure pressure, PetscInt a, const PetscReal slope[DIM], PetscReal out[DIM])
{
  const PetscBool symmetric = (PetscBool)(pressure->gradient == GradientSymmetric);

  for (PetscInt d = 0; d < DIM; d++) out[d] = 0;
  if (!(symmetric || pressure->cloud->integer[INT_SURFACE][a]) || Dot(slope, slope) == 0) return;
  AddSlope(pressure, a, slope, out);
  for (PetscInt d = 0; d < DIM && !symmetric; d++) out[d] /= SurfaceSlope(pressure, a);
}

/* Eq. (9) for one row; scale: see RowScale. Without summed densities -sum_b V (p_a + p_b) grad W/rho_a, which is the
   same for one liquid. Where the density jumps, it conserves momentum, too, and pressures of any level that balance the
   surfaces and interfaces accelerate nothing. */
static void SymmetricRow(Pressure pressure, PetscInt a, const PairRow *restrict row, PetscReal scale,
                         PetscReal out[DIM])
{
  Cloud            cloud   = pressure->cloud;
  const PetscReal *density = PressureDensity(pressure), *rest = cloud->rest_density, *p = cloud->field[FIELD_PRESSURE];
  const PetscReal *slope  = pressure->outside_slope + DIM * a;
  const PetscInt   padded = PaddedLength(row->n);
  PetscReal        c[ROW_CAPACITY + SIMD_WIDTH], own = p[a] - 2 * pressure->outside[a], jump[DIM] = {0, 0, 0};

  if (pressure->summed) {
    own /= density[a] * density[a];
    for (PetscInt k = 0; k < padded; k++) {
      const PetscInt b = row->index[k];

      c[k] = scale * rest[b] * (own + p[b] / (density[b] * density[b])) * row->f[k];
    }
  } else {
    scale /= density[a];
    SIMD_LOOP()
    for (PetscInt k = 0; k < padded; k++) c[k] = scale * (own + p[row->index[k]]) * row->f[k];
  }
  SumAlong(cloud, a, row, c, out);
  if (cloud->liquid && cloud->at_interface[a]) {
    JumpsSum(cloud, a, row, PETSC_FALSE, jump);
    for (PetscInt d = 0; d < DIM; d++) out[d] += scale * jump[d];
  }
  if (Dot(slope, slope) > 0) AddSlope(pressure, a, slope, out);
}

/* The factor on sums over the factors of a row: V times the scale of the kernel's F. */
static PetscReal RowScale(Cloud cloud)
{
  PetscReal scale_w, scale_f, inverse_h2;

  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  return cloud->domain->volume * scale_f;
}

/* Eq. (9). */
PetscErrorCode GradientSymmetric(Pressure pressure, PetscReal acceleration[])
{
  Cloud           cloud = pressure->cloud;
  const PetscReal scale = RowScale(cloud);
  PairRow         row;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PairRowLoadFactors(cloud, a, &row);
    SymmetricRow(pressure, a, &row, scale, acceleration + DIM * a);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For one row of the corrected gradient, inside -B_a sum V D grad W, D the pressure's difference that is not carried,
   p_b - p_a - T_ab.(y_b - y_a), and near the surface -sum V (2 (p_a - P) + D) grad W, P the pressure outside. */
static void CorrectedRow(Pressure pressure, PetscInt a, const PairRow *restrict row, PetscBool mean, PetscReal scale,
                         PetscReal out[DIM])
{
  const Cloud      cloud   = pressure->cloud;
  const PetscBool  surface = (PetscBool)(cloud->integer[INT_SURFACE][a] != 0);
  const PetscReal *x = cloud->field[FIELD_POSITION], *p = cloud->field[FIELD_PRESSURE], *rho = cloud->rest_density;
  const Simd       rise = SimdSet((surface ? 2 * (p[a] - pressure->outside[a]) : 0) - p[a]), zero = SimdSet(0);
  const Simd3      place     = Simd3Set(x + DIM * a);
  const Balance    balance   = pressure->balances ? BalanceOf(pressure, a) : (Balance){{zero, zero, zero}};
  Simd3            along     = {zero, zero, zero};
  PetscReal        jump[DIM] = {0, 0, 0};
  Vec4             sum;

  for (PetscInt k = 0; k < row->n; k += SIMD_WIDTH) {
    const PetscInt   *b  = row->index + k;
    const SimdOffsets at = SimdLocate(b);
    Simd              D;

    if (pressure->balances) {
      const Simd carried = BalanceTo(pressure, &balance, &at, &D);

      D = rise + D - carried;
    } else
      D = rise + SimdGather(p, b);
    if (mean && !surface) D *= 2 * rho[a] / (rho[a] + SimdGather(rho, b));
    Simd3Add(PETSC_FALSE, &along, D * SimdLoad(row->f + k),
             Simd3Difference(PETSC_FALSE, Simd3Collect(PETSC_FALSE, x, &at), place));
  }
  sum = Simd3Sum(along, zero);
  if (cloud->liquid && cloud->at_interface[a]) JumpsSum(cloud, a, row, (PetscBool)(mean && !surface), jump);
  for (PetscInt d = 0; d < DIM; d++) sum[d] = scale * (sum[d] + jump[d]);
  if (!surface)
    TensorApply(cloud->field[FIELD_CORRECTION] + 6 * a, sum[0], sum[1], sum[2], out);
  else
    for (PetscInt d = 0; d < DIM; d++) out[d] = sum[d];
}

/* Inside the liquid -B_a sum V (p_b - p_a) grad W/rho_a; near the surface Eq. (9), since pressure differences do not
   contain the outside. Eq. (9) everywhere would conserve momentum, but its error on disordered particles, 2 p_a sum V
   grad W, is proportional to the pressure: a smooth error of the velocity makes a pressure that grows with the depth,
   this pressure makes a rough velocity, and so on from step to step. A film of 40 spacings (jitter 0.1) is torn apart
   within five steps of any size.

   But this error keeps particles evenly spread. So a part of it remains: 2 q sum V grad W of a background pressure q =
   c h |grad p - T| (c: regularization), which does not grow with the depth. T is what is carried (balance.c): in
   proportion to the whole slope the background was a shear stress in liquid that merely has a weight. Without it
   Taylor-Green's error is 1.4 times as large.

   This sum alone drives particles of a cubic spline with h = 1.3 d0 into pairs (Dehnen & Aly 2012). So a part of the
   shifting's term against pairing (Monaghan 2000) is added. The shifting helps, and 0.1 is enough; 0.5 costs
   Taylor-Green vortices of 50 spacings 3 % of their energy. */
PetscErrorCode GradientCorrected(Pressure pressure, PetscReal acceleration[])
{
  Cloud            cloud   = pressure->cloud;
  const PetscReal *density = PressureDensity(pressure), scale = RowScale(cloud),
                  factor = 2 * pressure->regularization * KernelSmoothingLength(cloud->kernel);
  const PetscBool mean   = (PetscBool)!SceneOneDensity(cloud->scene);
  PairRow         row;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal *out = acceleration + DIM * a;

    PairRowLoadFactors(cloud, a, &row);
    CorrectedRow(pressure, a, &row, mean, scale, out);
    if (cloud->integer[INT_SURFACE][a]) {
      const PetscReal *slope = pressure->outside_slope + DIM * a;

      for (PetscInt d = 0; d < DIM; d++) out[d] /= density[a];
      if (Dot(slope, slope) > 0) AddSlope(pressure, a, slope, out);
      for (PetscInt d = 0; d < DIM; d++) out[d] /= SurfaceSlope(pressure, a);
    } else {
      const PetscReal *n = cloud->field[FIELD_NORMAL] + DIM * a, *crowding = cloud->field[FIELD_CROWDING] + DIM * a,
                      background = cloud->size[a] * factor * Norm(out);

      for (PetscInt d = 0; d < DIM; d++)
        out[d] = (out[d] - background * (n[d] + PAIRING * (crowding[d] - n[d]))) / density[a];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* As GradientCorrected, but neighbours compensate the difference to Eq. (9), which alone changes total momentum and
   angular momentum. */
PetscErrorCode GradientConserved(Pressure pressure, PetscReal acceleration[])
{
  Cloud           cloud = pressure->cloud;
  const PetscReal scale = RowScale(cloud);
  PetscReal      *weight, *change;
  PairRow         row;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, 1, &weight));
  PetscCall(CloudGetWork(cloud, DIM, &change));
  PetscCall(GradientCorrected(pressure, acceleration));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal symmetric[DIM];

    PairRowLoadFactors(cloud, a, &row);
    SymmetricRow(pressure, a, &row, scale, symmetric);
    for (PetscInt d = 0; d < DIM; d++) {
      change[DIM * a + d]       = acceleration[DIM * a + d] - symmetric[d];
      acceleration[DIM * a + d] = symmetric[d];
    }
  }
  PetscCall(OperatorsCompensationWeights(cloud, weight));
  PetscCall(
    OperatorsCompensate(cloud, weight, cloud->field[FIELD_POSITION], NULL, cloud->field[FIELD_VELOCITY], change));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) acceleration[k] += change[k];
  PetscCall(CloudRestoreWork(cloud, &change));
  PetscCall(CloudRestoreWork(cloud, &weight));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the pressure outside the free surface and its slope: of surface tension and what is carried, and of what else
   surrounds the liquid. */
static PetscErrorCode OutsideGet(Pressure pressure)
{
  Cloud cloud = pressure->cloud;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, 1, &pressure->outside));
  PetscCall(CloudGetWork(cloud, DIM, &pressure->outside_slope));
  PetscCall(PetscArraycpy(pressure->outside, cloud->field[FIELD_CAPILLARY], cloud->n_fluid));
  PetscCall(PetscArraycpy(pressure->outside_slope, cloud->field[FIELD_CAPILLARY_SLOPE], DIM * cloud->n_fluid));
  for (PetscInt a = 0; a < cloud->n_fluid && pressure->balances; a++)
    if (cloud->integer[INT_SURFACE][a])
      pressure->outside[a] = PressureSurrounds(pressure, a, pressure->outside_slope + DIM * a);
  for (PetscInt a = 0; a < cloud->n_total && pressure->balances; a++)
    pressure->load[DIM * a + 2] = cloud->field[FIELD_PRESSURE][a];
  for (PetscInt k = 0; k < pressure->low_ranks; k++)
    if (pressure->low_rank[k].term->outside)
      PetscCall(pressure->low_rank[k].term->outside(pressure->low_rank[k].context, pressure, pressure->outside,
                                                    pressure->outside_slope));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureAcceleration(Pressure pressure, PetscReal acceleration[])
{
  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_GRADIENT), 0, 0, 0, 0));
  PetscCall(OutsideGet(pressure));
  PetscCall(pressure->gradient(pressure, acceleration));
  PetscCall(CloudRestoreWork(pressure->cloud, &pressure->outside_slope));
  PetscCall(CloudRestoreWork(pressure->cloud, &pressure->outside));
  PetscCall(LogPairFlops(pressure->cloud->first[pressure->cloud->n_fluid], 11));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_GRADIENT), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
