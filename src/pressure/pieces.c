/* The small types that combine into a projection: sources, closures at the free surface, gradients. */
#include "pressure_impl.h"

/* --- sources: minus the right-hand side of div(grad p/rho) --- */

/* Eq. (8): (rho_0 - rho_a)/(rho_0 dt^2). A wall particle that is not covered by liquid all around lacks density without
   any liquid being rarefied, and its row, with few pairs, would turn that into a suction that tears particles off
   whatever the step. So walls push, they do not pull. */
PetscErrorCode SourceDensity(Pressure pressure, PetscReal dt, PetscReal rhs[])
{
  Cloud            cloud = pressure->cloud;
  const PetscReal *rho = cloud->field[FIELD_DENSITY], *rest = cloud->rest_density;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_rows; a++) rhs[a] = (rho[a] / rest[a] - 1) / (dt * dt);
  for (PetscInt a = cloud->n_fluid; a < cloud->n_rows; a++) rhs[a] = PetscMax(rhs[a], 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define LAMBDA_FULL 0.95 /* above: a full neighbourhood, F = 1 */
#define LAMBDA_THIN 0.3  /* below: too few neighbours for F; only compression counts */

/* e_a = F_a - rho_a/(rho_0 S), S the sum V W on a full lattice: the density defect that is neither the free surface's
   nor the kernel's. */
static PetscReal DensityDefect(Pressure pressure, PetscInt a)
{
  Cloud            cloud    = pressure->cloud;
  const PetscReal *gradient = cloud->field[FIELD_NORMAL] + DIM * a, lambda = cloud->field[FIELD_LAMBDA][a];
  PetscReal        fraction = 1, defect;

  if (lambda < LAMBDA_FULL) {
    const PetscReal place = Norm(gradient) / pressure->surface_plane * SURFACE_TABLE;
    const PetscInt  k     = (PetscInt)PetscMin(place, (PetscReal)(SURFACE_TABLE - 1));
    const PetscReal t     = PetscMin(place - k, 1.0);

    fraction = (1 - t) * pressure->surface_fraction[k] + t * pressure->surface_fraction[k + 1];
  }
  defect = fraction - cloud->field[FIELD_DENSITY][a] / (cloud->rest_density[a] * pressure->lattice_sum);
  return lambda < LAMBDA_THIN ? PetscMin(defect, 0) : defect;
}

/* A relaxation in fewer steps overshoots: the Couette flow with implicit viscosity at dt = 3 T blows up. */
#define RELAXATION_STEPS 5

/* (1/dt) div v* with corrected kernel gradients, plus e/(dt T), T at least RELAXATION_STEPS dt; wall rows: plain
   divergence, deeper layers folded in. Positions are those of the middle of a centered step, the new velocity belongs
   to its end, 'ahead' of them. Free of divergence in the middle, it would have dt/2 tr (grad v)^2 at the end: the
   density would drift by that times T, and the pressure's work on it is a loss of dt/2 |grad p|^2/rho a volume and
   time, 3 % of the energy of Taylor-Green vortices of Re 1000 at 50 spacings. */
PetscErrorCode SourceDivergence(Pressure pressure, PetscReal dt, PetscReal rhs[])
{
  Cloud           cloud = pressure->cloud;
  const PetscReal rate  = 1 / (dt * PetscMax(pressure->relaxation_time, RELAXATION_STEPS * dt));

  PetscFunctionBegin;
  if (cloud->n_owned > pressure->div_capacity) {
    pressure->div_capacity = cloud->capacity;
    PetscCall(PetscFree(pressure->div));
    PetscCall(PetscMalloc1(pressure->div_capacity, &pressure->div));
  }
  PetscCall(
    OperatorsDivergence(cloud, cloud->field[FIELD_VELOCITY_STAR], PETSC_TRUE, pressure->ahead * dt, pressure->div));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) rhs[a] = -pressure->div[a] / dt - DensityDefect(pressure, a) * rate;
  for (PetscInt a = cloud->n_fluid; a < cloud->n_rows; a++) rhs[a] = -pressure->div[a] / dt;
  for (PetscInt a = cloud->n_rows; a < cloud->n_owned; a++)
    rhs[cloud->row[a] - cloud->row_start] -= pressure->div[a] / dt;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- closures --- */

/* Eq. (11): (2 p_a - p_b) in place of (p_a - p_b). */
PetscReal ClosureDoubled(Pressure pressure, PetscInt a, PetscReal diagonal)
{
  return pressure->cloud->integer[INT_SURFACE][a] == 1 ? diagonal : 0;
}

/* Nair & Tomar (2014) fill the diagonal of a row near the surface up to that of a full neighbourhood: as if the missing
   neighbours had p = 0, which puts the zero where they would be, 0.8 spacings outside the surface (the first pressure
   of a rotating square is then 8 % too large at 40 spacings a side). As if they had -p_a, mirrored in the surface as in
   Eq. (11), is twice the filling: 2.2 %. */
#define LAMBDA_CLOSURE 0.9 /* fluid below this lambda has its diagonal filled up */

/* Crowded particles near the surface (two fronts meet) lack nothing that could be filled, but their free side pushes
   them as before: by Eq. (9) a pressure p drives them by 2 p n/rho, n = sum V grad W, and the corrected divergence of
   that is 2 n.B n p/rho. Rows closed by less than half of it make each projection reverse a velocity and enlarge it, 5
   to 15 times where they are not closed at all, whatever the step. At rest density the filling is 2.5 to 6 n.B n/rho,
   for all kernels and h; crowded rows get no less. */
#define CLOSURE_LEAST 2.5

PetscReal ClosureFull(Pressure pressure, PetscInt a, PetscReal diagonal)
{
  Cloud     cloud   = pressure->cloud;
  PetscReal filling = 0, mass, n[DIM];

  if (!pressure->free_surface || a >= cloud->n_fluid) return 0;
  mass = cloud->volume[a] * cloud->rest_density[a] * pressure->row_scale / PressureDensity(pressure)[a];
  if (cloud->field[FIELD_LAMBDA][a] < LAMBDA_CLOSURE)
    filling = pressure->closure_factor * PetscMax(0, pressure->lattice_diagonal * mass - diagonal);
  if (!cloud->integer[INT_SURFACE][a]) return filling;
  {
    const PetscReal *normal = cloud->field[FIELD_NORMAL] + DIM * a;

    TensorApply(cloud->field[FIELD_CORRECTION] + 6 * a, normal[0], normal[1], normal[2], n);
    return PetscMax(filling, CLOSURE_LEAST * Dot(n, normal) * mass);
  }
}

void PressureLattice(Cloud cloud, PetscReal *diagonal, PetscReal *sum)
{
  const PetscInt dim   = cloud->domain->dim,
                 reach = (PetscInt)(KernelSupport(cloud->kernel) / cloud->domain->spacing) + 1;
  const PetscReal d0 = cloud->domain->spacing, eta2 = EtaSquared(cloud->kernel), V = cloud->domain->volume;

  *diagonal = *sum = 0;
  for (PetscInt k = dim == 3 ? -reach : 0; k <= (dim == 3 ? reach : 0); k++)
    for (PetscInt j = -reach; j <= reach; j++)
      for (PetscInt i = -reach; i <= reach; i++) {
        const PetscReal r2 = d0 * d0 * (i * i + j * j + k * k);
        PetscReal       W, F;

        KernelEvaluate(cloud->kernel, 1, &r2, &W, &F);
        *sum += V * W;
        if (r2 > 0) *diagonal -= 2 * V * F * r2 / (r2 + eta2);
      }
}

/* --- gradients: acceleration -grad p/rho --- */

/* -sum c (r_a - r_b) over the row of a; c: as its factors, padded. */
static void SumAlong(Cloud cloud, PetscInt a, const Row *row, const PetscReal c[], PetscReal out[DIM])
{
  const PetscReal *x    = cloud->field[FIELD_POSITION];
  const Vec8x3     p    = Vec8x3Set(x + DIM * a);
  const Vec8       zero = Vec8Set(0);
  Vec8x3           sum  = {zero, zero, zero};

  for (PetscInt k = 0; k < row->n; k += VEC8) {
    const Vec8Offsets at = Vec8Locate(row->index + k);

    Vec8x3Add(&sum, Vec8Load(c + k), Vec8x3Difference(Vec8x3Collect(x, &at), p));
  }
  Vec4Store(Vec8x3Sum(sum, zero), out);
}

/* Eq. (9) for one row; scale: of the kernel's F times V. */
static void SymmetricRow(Pressure pressure, PetscInt a, const Row *restrict row, PetscReal scale, PetscReal out[DIM])
{
  Cloud            cloud   = pressure->cloud;
  const PetscReal *density = PressureDensity(pressure), *rest = cloud->rest_density, *p = cloud->field[FIELD_PRESSURE];
  const PetscReal  own    = (p[a] - 2 * cloud->field[FIELD_CAPILLARY][a]) / (density[a] * density[a]);
  const PetscReal *slope  = cloud->field[FIELD_CAPILLARY_SLOPE] + DIM * a;
  const PetscInt   padded = PaddedLength(row->n);
  PetscReal        c[ROW_CAPACITY + VEC8];

  SIMD_LOOP()
  for (PetscInt k = 0; k < padded; k++) {
    const PetscInt b = row->index[k];

    c[k] = scale * rest[b] * (own + p[b] / (density[b] * density[b])) * row->f[k];
  }
  SumAlong(cloud, a, row, c, out);
  if (Dot(slope, slope) > 0) {
    PetscReal M[6], part[DIM];

    SymmetricInverse(cloud->domain->dim, cloud->field[FIELD_CORRECTION] + 6 * a, M);
    TensorApply(M, slope[0], slope[1], slope[2], part);
    for (PetscInt d = 0; d < DIM; d++) out[d] -= (slope[d] - part[d]) / density[a];
  }
}

/* V times the scale of the kernel's F: what sums over rows are multiplied by. */
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
  Row             row;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    RowLoad(cloud, a, &row);
    SymmetricRow(pressure, a, &row, scale, acceleration + DIM * a);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* -B_a sum V (p_b - p_a) grad W of one row. */
static void CorrectedRow(Cloud cloud, PetscInt a, const Row *restrict row, PetscReal scale, PetscReal out[DIM])
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *p = cloud->field[FIELD_PRESSURE];
  const Vec8x3     place = Vec8x3Set(x + DIM * a);
  const Vec8       zero = Vec8Set(0), own = Vec8Set(p[a]);
  Vec8x3           sum = {zero, zero, zero};
  Vec4             g;

  for (PetscInt k = 0; k < row->n; k += VEC8) {
    const Vec8Offsets at = Vec8Locate(row->index + k);
    const Vec8x3      d  = Vec8x3Difference(Vec8x3Collect(x, &at), place);

    Vec8x3Add(&sum, (Vec8Gather(p, row->index + k) - own) * Vec8Load(row->f + k), d);
  }
  g = scale * Vec8x3Sum(sum, zero);
  TensorApply(cloud->field[FIELD_CORRECTION] + 6 * a, g[0], g[1], g[2], out);
}

/* Inside -B_a sum V (p_b - p_a) grad W/rho_a; near the surface Eq. (9), where pressure differences know nothing of the
   outside. Eq. (9) everywhere conserves momentum, but on disordered particles its error, 2 p_a sum V grad W, grows with
   the pressure itself: a smooth error of the velocity makes a pressure that grows with the depth, that a rough
   velocity, and so on from step to step. A film of 40 spacings (jitter 0.1) is torn apart within five steps of any
   size.

   The same error is what keeps particles evenly spread, so a little of it is put back: 2 q sum V grad W of a background
   pressure q = c h |grad p| that knows nothing of the depth.

   That sum alone drives particles of a cubic spline with h = 1.3 d0 into pairs (Dehnen & Aly 2012), so a share of the
   shifting's term against pairing (Monaghan 2000) goes with it. In motion the shifting helps and a tenth is enough;
   more is a viscosity: half of it costs Taylor-Green vortices of 50 spacings 3 % of their energy. At rest shifting and
   background hold each other, and what is left is a velocity with which nothing moves, 0.01 sqrt(gH) in a tank. So
   where a body force makes the pressure it is half. */
#define PAIRING_MOVING 0.1
#define PAIRING_LOADED 0.5

PetscErrorCode GradientCorrected(Pressure pressure, PetscReal acceleration[])
{
  Cloud            cloud   = pressure->cloud;
  const PetscReal *density = PressureDensity(pressure), scale = RowScale(cloud),
                  factor = 2 * pressure->regularization * KernelSmoothingLength(cloud->kernel);
  Row row;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal *out = acceleration + DIM * a;

    RowLoad(cloud, a, &row);
    if (cloud->integer[INT_SURFACE][a])
      SymmetricRow(pressure, a, &row, scale, out);
    else {
      const PetscReal *n = cloud->field[FIELD_NORMAL] + DIM * a, *crowding = cloud->field[FIELD_CROWDING] + DIM * a;
      PetscReal        g[DIM], background, against;

      CorrectedRow(cloud, a, &row, scale, out);
      SceneAcceleration(cloud->scene, cloud->field[FIELD_POSITION] + DIM * a, g);
      background = factor * Norm(out);
      against =
        PetscMax(PAIRING_MOVING * background, PAIRING_LOADED * PetscMin(background, factor * density[a] * Norm(g)));
      for (PetscInt d = 0; d < DIM; d++)
        out[d] = (out[d] - background * n[d] - against * (crowding[d] - n[d])) / density[a];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* As GradientCorrected, but the neighbours pay for its difference to Eq. (9), which alone has a sum and a torque. */
PetscErrorCode GradientConserved(Pressure pressure, PetscReal acceleration[])
{
  Cloud           cloud     = pressure->cloud;
  PetscReal      *corrected = cloud->field[FIELD_ACCELERATION], *change = cloud->field[FIELD_START];
  const PetscReal scale = RowScale(cloud);
  Row             row;

  PetscFunctionBegin;
  PetscCall(GradientCorrected(pressure, corrected));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal symmetric[DIM];

    for (PetscInt d = 0; d < DIM; d++) change[DIM * a + d] = 0;
    if (cloud->integer[INT_SURFACE][a]) continue;
    RowLoad(cloud, a, &row);
    SymmetricRow(pressure, a, &row, scale, symmetric);
    for (PetscInt d = 0; d < DIM; d++) {
      change[DIM * a + d]    = corrected[DIM * a + d] - symmetric[d];
      corrected[DIM * a + d] = symmetric[d];
    }
  }
  PetscCall(OperatorsCompensationWeights(cloud));
  PetscCall(PetscArrayzero(cloud->field[FIELD_WORK3], DIM * cloud->n_owned));
  PetscCall(OperatorsCompensate(cloud, cloud->field[FIELD_POSITION], cloud->field[FIELD_VELOCITY_STAR], change));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) acceleration[k] = corrected[k] + change[k];
  PetscFunctionReturn(PETSC_SUCCESS);
}
