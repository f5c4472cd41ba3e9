/* Operators on the fewest particles that show them: the viscous terms of two particles of two liquids, the sums of a
   pair, walls of both sides, the cone of the free-surface test, its options. Lengths in spacings. Runs on any number of
   ranks. */
#include "setup.h"
#include "check.h"

#define H 1.3
#define TWO                                                                                                            \
  "-dimension 2 -spacing 1 -box_lower 0,0 -box_upper 6,6 -packing_jitter 0 -bodies a,b -a_upper 1,1 -a_density 1000 "  \
  "-a_viscosity 2 -b_lower 1,2 -b_upper 2,3 -b_density 700 -b_viscosity 6 "
#define FLAT "-dimension 2 -spacing 1 -box_lower -20,-20 -box_upper 20,20 -bodies a "
#define GAP                                                                                                            \
  "-dimension 2 -spacing 1 -box_lower 0,0 -box_upper 10,10 -box_x periodic -bodies a -a_density 250 -a_viscosity 0.5 "

/* The cubic spline in two dimensions at the distance r, and its slope over r. */
static void Spline(PetscReal r, PetscReal *W, PetscReal *F)
{
  const PetscReal q = r / H, norm = 10 / (7 * PETSC_PI * H * H), far = 2 - q;

  *W = norm * (q < 1 ? 1 - 1.5 * q * q + 0.75 * q * q * q : q < 2 ? 0.25 * far * far * far : 0);
  *F = norm / (H * r) * (q < 1 ? -3 * q + 2.25 * q * q : q < 2 ? -0.75 * far * far : 0);
}

/* What a pair's product with r counts in two dimensions: 4/(r^2 + eta^2), or 2 over the spline's moment int r^2 W =
   31/49 h^2. */
static PetscReal Zeta(ViscosityForm form, PetscReal r2)
{
  return form == VISCOSITY_CLEARY ? 4 / (r2 + PetscSqr(0.1 * H)) : 2 / (31 * H * H / 49);
}

/* Two particles a distance (1, 2) apart, the second one moves with (3, -1); its density over the rest density is
   'crowd'. Explicit, as a linear operator, and the diagonal of that. */
static PetscErrorCode TestPair(ViscosityForm form, PetscReal crowd, const char label[])
{
  const Viscosity viscosity = {.form = form};
  const PetscReal r2 = 5, density[2] = {1000 * crowd, 700 * crowd}, mass[2] = {1000, 700}, u[DIM] = {3, -1, 0};
  const PetscReal common = (1 / PetscSqr(density[0]) + 1 / PetscSqr(density[1])) * 2 * 2 * 6 / (2 + 6),
                  along  = (u[0] * 1 + u[1] * 2) * Zeta(form, r2);
  PetscReal *rho, *pair, *out, *diagonal, error = 0, W, F;
  char       name[96];
  Setup      s;

  PetscFunctionBegin;
  Spline(PetscSqrtReal(r2), &W, &F);
  PetscCall(SetupPack(TWO, &s));
  PetscCall(SetupMoments(&s));
  PetscCall(PetscMalloc4(s.cloud->n_total, &rho, OperatorsViscosityRoom(s.cloud), &pair, DIM * s.cloud->n_fluid, &out,
                         DIM * s.cloud->n_fluid, &diagonal));
  for (PetscInt a = 0; a < s.cloud->n_total; a++) {
    const PetscInt b = s.cloud->integer[INT_BODY][a];

    rho[a] = density[b];
    for (PetscInt d = 0; d < DIM; d++) s.cloud->field[FIELD_VELOCITY][DIM * a + d] = b ? u[d] : 0;
  }
  PetscCall(PetscArrayzero(s.cloud->field[FIELD_ACCELERATION], DIM * s.cloud->n_owned));
  PetscCall(PetscArraycpy(s.cloud->field[FIELD_DENSITY], s.cloud->rest_density, s.cloud->n_total));
  PetscCall(OperatorsViscosity(s.cloud, &viscosity, crowd == 1 ? s.cloud->rest_density : rho));
  PetscCall(OperatorsViscosityPairs(s.cloud, &viscosity, rho, pair));
  PetscCall(OperatorsViscosityApply(s.cloud, &viscosity, pair, s.cloud->field[FIELD_VELOCITY], out));
  PetscCall(OperatorsViscosityDiagonal(s.cloud, &viscosity, pair, diagonal));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    const PetscInt b = s.cloud->integer[INT_BODY][a];

    for (PetscInt d = 0; d < 2; d++) {
      const PetscReal r = d + 1, factor = mass[1 - b] * common * F;
      const PetscReal due = (b ? 1 : -1) * factor * (form == VISCOSITY_MORRIS ? u[d] : along * r);
      const PetscReal on  = factor * (form == VISCOSITY_MORRIS ? 1 : Zeta(form, r2) * r * r);

      error = PetscMax(error, PetscAbsReal(s.cloud->field[FIELD_ACCELERATION][DIM * a + d] / due - 1));
      error = PetscMax(error, PetscAbsReal(out[DIM * a + d] / due - 1));
      error = PetscMax(error, PetscAbsReal(diagonal[DIM * a + d] / on - 1));
    }
  }
  PetscCall(PetscFree4(rho, pair, out, diagonal));
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_of_two_particles", label));
  CHECK_CLOSE(SetupMax(error), 0, 2e-6, name); /* factors of the pairs are in single precision */
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the implicit viscosity (nu = 0.001) dissipates in a sheet of 'rows' times 'columns' particles that is stretched
   at the rate 1. */
static PetscErrorCode Stretch(PetscInt rows, PetscInt columns, PetscReal *loss)
{
  const Viscosity viscosity = {.form = VISCOSITY_MOMENT};
  PetscReal       x[DIM * 100], sum = 0, *pair, *out;
  Setup           s;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < rows * columns; k++) {
    x[DIM * k]     = k / rows - 0.5 * columns;
    x[DIM * k + 1] = k % rows;
    x[DIM * k + 2] = 0;
  }
  PetscCall(SetupFill(FLAT "-a_density 1000 -a_viscosity 1", rows * columns, x, 0, &s));
  PetscCall(SetupMoments(&s));
  PetscCall(CloudUpdate(s.cloud, FIELD_DENSITY));
  PetscCall(PetscMalloc2(OperatorsViscosityRoom(s.cloud), &pair, DIM * s.cloud->n_fluid, &out));
  for (PetscInt a = 0; a < s.cloud->n_owned; a++)
    for (PetscInt d = 0; d < DIM; d++)
      s.cloud->field[FIELD_VELOCITY][DIM * a + d] = (d ? -1 : 1) * s.cloud->field[FIELD_POSITION][DIM * a + d];
  PetscCall(OperatorsViscosityPairs(s.cloud, &viscosity, s.cloud->rest_density, pair));
  PetscCall(OperatorsViscosityApply(s.cloud, &viscosity, pair, s.cloud->field[FIELD_VELOCITY], out));
  for (PetscInt k = 0; k < DIM * s.cloud->n_fluid; k++) sum -= s.cloud->field[FIELD_VELOCITY][k] * out[k];
  PetscCall(PetscFree2(pair, out));
  *loss = SetupSum(sum);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sheets of one to three particles resist a stretch with 4 nu times their thickness: the difference of two lengths has
   no ends. */
static PetscErrorCode TestSheets(void)
{
  PetscFunctionBegin;
  for (PetscInt rows = 1; rows <= 3; rows++) {
    PetscReal longer, shorter;
    char      name[96];

    PetscCall(Stretch(rows, 26, &longer));
    PetscCall(Stretch(rows, 16, &shorter));
    PetscCall(PetscSNPrintf(name, sizeof(name), "stretch_of_a_sheet_of_%d", (int)rows));
    CHECK_CLOSE((longer - shorter) / (10 * rows * 4e-3), 1, 0.07, name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Two particles 0.7 apart: the sums of grad W, with and without the term against pairing; four in a square, too few for
   a correction. */
static PetscErrorCode TestSums(void)
{
  const PetscReal two[] = {0, 0, 0, 0.7, 0, 0}, square[] = {0, 0, 0, 1.8, 0, 0, 0, 1.8, 0, 1.8, 1.8, 0};
  PetscReal       W, F, at_spacing, none, error = 0, correction = 0, smallest = 1;
  Setup           s;

  PetscFunctionBegin;
  Spline(0.7, &W, &F);
  Spline(1, &at_spacing, &none);
  PetscCall(SetupFill(FLAT, 2, two, 0, &s));
  PetscCall(SetupMoments(&s));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    const PetscReal due = (s.cloud->integer[INT_ID][a] ? 0.7 : -0.7) * F, ratio = W / at_spacing;

    error = PetscMax(error, PetscAbsReal(s.cloud->field[FIELD_NORMAL][DIM * a] / due - 1));
    error = PetscMax(error,
                     PetscAbsReal(s.cloud->field[FIELD_CROWDING][DIM * a] / due - 1 - 0.2 * PetscSqr(PetscSqr(ratio))));
  }
  CHECK_CLOSE(SetupMax(error), 0, 2e-6, "sums_of_a_pair");
  PetscCall(SetupClose(&s));
  PetscCall(SetupFill(FLAT, 4, square, 0, &s));
  PetscCall(SetupMoments(&s));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    const PetscReal identity[6] = {1, 1, 1, 0, 0, 0};

    smallest = PetscMin(smallest, s.cloud->field[FIELD_LAMBDA][a]);
    for (PetscInt k = 0; k < 6; k++)
      correction = PetscMax(correction, PetscAbsReal(s.cloud->field[FIELD_CORRECTION][6 * a + k] - identity[k]));
  }
  CHECK(-SetupMax(-smallest) > 0.001 && SetupMax(-smallest) < 0, "few_neighbours_have_moments");
  CHECK_CLOSE(SetupMax(correction), 0, 0, "few_neighbours_have_no_correction");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest difference of velocities around a particle, where one of all moves. */
static PetscErrorCode TestJump(void)
{
  PetscReal *jump, wrong = 0;
  Setup      s;

  PetscFunctionBegin;
  PetscCall(SetupPack(FLAT "-a_lower -3,-3 -a_upper 3,3 -packing_jitter 0", &s));
  PetscCall(SetupMoments(&s));
  for (PetscInt a = 0; a < s.cloud->n_total; a++) {
    const PetscBool moves = (PetscBool)(s.cloud->integer[INT_ID][a] == 14);

    s.cloud->field[FIELD_VELOCITY][DIM * a]     = moves ? 3 : 0;
    s.cloud->field[FIELD_VELOCITY][DIM * a + 1] = moves ? 4 : 0;
    s.cloud->field[FIELD_VELOCITY][DIM * a + 2] = 0;
  }
  PetscCall(PetscMalloc1(s.cloud->n_owned, &jump));
  PetscCall(OperatorsDivergence(s.cloud, s.cloud->field[FIELD_VELOCITY], PETSC_TRUE, 0, NULL, NULL, jump));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    PetscBool sees = (PetscBool)(s.cloud->integer[INT_ID][a] == 14);

    for (PetscInt k = s.cloud->first[a]; k < s.cloud->first[a + 1]; k++)
      sees = (PetscBool)(sees || s.cloud->integer[INT_ID][s.cloud->list[k]] == 14);
    wrong = PetscMax(wrong, PetscAbsReal(jump[a] - (sees ? 5 : 0)));
  }
  PetscCall(PetscFree(jump));
  CHECK_CLOSE(SetupMax(wrong), 0, 1e-14, "jump_of_velocities");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The densities of a floor: those of the liquid on it, the first body's where there is none, whatever was there
   before. */
static PetscErrorCode TestFloor(void)
{
  PetscReal off[2] = {0, 0}, light = 0;
  Setup     s;

  PetscFunctionBegin;
  PetscCall(
    SetupPack("-dimension 2 -spacing 1 -box_lower 0,0 -box_upper 40,30 -box_ymin wall -packing_jitter 0 -bodies "
              "a,b -a_upper 10,6 -a_density 1000 -b_lower 26,0 -b_upper 36,6 -b_density 700 ",
              &s));
  for (PetscInt round = 0; round < 2; round++) {
    PetscCall(SetupMoments(&s));
    for (PetscInt a = s.cloud->n_fluid; a < s.cloud->n_owned; a++) {
      const PetscReal x = s.cloud->field[FIELD_POSITION][DIM * a], due = x > 26 && x < 36 && round == 0 ? 700 : 1000;

      if (s.cloud->integer[INT_LAYER][a] != 2 || (x > 20 && x < 26) || x > 36) continue; /* its liquid may be far */
      off[round] = PetscMax(off[round], PetscAbsReal(s.cloud->rest_density[a] - due));
      light += round == 0 && due < 1000;
    }
    for (PetscInt a = 0; a < s.cloud->n_fluid; a++) /* b rises beyond the support of the second layer */
      if (s.cloud->integer[INT_BODY][a]) s.cloud->field[FIELD_POSITION][DIM * a + 1] += 0.7;
    PetscCall(CloudMoved(s.cloud));
  }
  CHECK(SetupSum(light) == 10, "a_floor_below_a_light_liquid");
  CHECK_CLOSE(SetupMax(off[0]), 0, 1e-9, "a_floor_has_the_density_of_its_liquid");
  CHECK_CLOSE(SetupMax(off[1]), 0, 1e-9, "a_floor_forgets_liquid_that_has_left");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same of particles four times as wide, whose liquid is farther than the support of a fine one. */
static PetscErrorCode TestCoarseFloor(void)
{
  PetscReal off = 0, coarse = 0;
  Setup     s;

  PetscFunctionBegin;
  PetscCall(SetupPack("-dimension 2 -spacing 1 -spacing_coarse 4 -spacing_growth 0.2 -fine near -near_shape sphere "
                      "-near_radius 2 -near_center 0,60 -box_lower 0,0 -box_upper 80,60 -box_ymin wall -packing_jitter "
                      "0 -bodies a,b -a_upper 40,24 -a_density 1000 -b_lower 40,0 -b_upper 80,24 -b_density 700 ",
                      &s));
  PetscCall(SetupMoments(&s));
  for (PetscInt a = s.cloud->n_fluid; a < s.cloud->n_owned; a++) {
    const PetscReal x = s.cloud->field[FIELD_POSITION][DIM * a];

    if (s.cloud->integer[INT_LAYER][a] != 1 || x < 56 || x > 72 || s.cloud->size[a] < 3) continue;
    off = PetscMax(off, PetscAbsReal(s.cloud->rest_density[a] - 700));
    coarse++;
  }
  CHECK(SetupSum(coarse) >= 3, "a_coarse_floor");
  CHECK_CLOSE(SetupMax(off), 0, 1e-9, "a_coarse_floor_has_the_density_of_its_liquid");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Liquid between a floor and a ceiling, which are walls of the box or solids: along them it slides without divergence,
   and wall particles that it leaves see it expand. With no slip, a shear flow that is at rest at a wall feels no force
   there. */
static PetscErrorCode TestWalls(const char walls[], const char label[])
{
  Viscosity  viscosity = {.form = VISCOSITY_CLEARY};
  PetscReal *div, slide = 0, least = 0, most[2] = {0, 0}, shear = 0, before = 0;
  char       options[512], name[96];
  Setup      s;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof(options), GAP "-packing_jitter 0 %s", walls));
  PetscCall(SetupPack(options, &s));
  PetscCall(SetupMoments(&s));
  PetscCall(PetscMalloc1(s.cloud->n_owned, &div));
  for (PetscInt d = 0; d < 2; d++) {
    for (PetscInt a = 0; a < s.cloud->n_total; a++)
      for (PetscInt k = 0; k < DIM; k++)
        s.cloud->field[FIELD_VELOCITY][DIM * a + k] = s.cloud->integer[INT_LAYER][a] == 0 && k == d;
    PetscCall(OperatorsDivergence(s.cloud, s.cloud->field[FIELD_VELOCITY], PETSC_TRUE, 0, div, NULL, NULL));
    for (PetscInt a = 0; a < s.cloud->n_owned; a++) {
      const PetscBool above = (PetscBool)(s.cloud->field[FIELD_POSITION][DIM * a + 1] > 5);

      if (d == 0)
        slide = PetscMax(slide, PetscAbsReal(div[a]));
      else if (a >= s.cloud->n_fluid) { /* upwards: away from the floor, against the ceiling */
        least       = PetscMin(least, above ? -div[a] : div[a]);
        most[above] = PetscMax(most[above], above ? -div[a] : div[a]);
      }
    }
  }
  PetscCall(PetscFree(div));
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_sliding_has_no_divergence", label));
  CHECK_CLOSE(SetupMax(slide), 0, 1e-5, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_leaving_has", label));
  CHECK(SetupMax(-least) < 1e-9 && SetupMax(most[0]) > 0.1 && SetupMax(most[1]) > 0.1, name);
  PetscCall(SetupClose(&s));
  PetscCall(PetscSNPrintf(options, sizeof(options), GAP "-packing_jitter 0 %s", walls));
  PetscCall(SetupPack(options, &s));
  PetscCall(SetupMoments(&s));
  for (PetscInt slip = 0; slip < 2; slip++) {
    PetscReal *worst = slip ? &shear : &before;

    if (slip) OperatorsNoSlip(s.cloud, &viscosity);
    for (PetscInt top = 0; top < 2; top++) {
      for (PetscInt a = 0; a < s.cloud->n_owned; a++) {
        const PetscReal y = s.cloud->field[FIELD_POSITION][DIM * a + 1];

        s.cloud->field[FIELD_VELOCITY][DIM * a]     = s.cloud->integer[INT_LAYER][a] ? 0 : top ? 8 - y : y - 2;
        s.cloud->field[FIELD_VELOCITY][DIM * a + 1] = 0;
      }
      PetscCall(CloudUpdate(s.cloud, FIELD_VELOCITY));
      PetscCall(PetscArrayzero(s.cloud->field[FIELD_ACCELERATION], DIM * s.cloud->n_owned));
      PetscCall(OperatorsViscosity(s.cloud, &viscosity, s.cloud->rest_density));
      for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
        if ((s.cloud->field[FIELD_POSITION][DIM * a + 1] > 5) == top)
          *worst = PetscMax(*worst, PetscAbsReal(s.cloud->field[FIELD_ACCELERATION][DIM * a]) / (0.5 / 250));
    }
  }
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_no_slip", label));
  CHECK(SetupMax(before) > 0.3 && SetupMax(shear) < 0.02, name);
  if (getenv("TEST_VERBOSE")) printf("%s: %g %g\n", label, before, shear);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The surface of a half-plane under 45 degrees, a particle at the origin and one more at 'across' along the surface and
   'above' over it: whether the one at the origin is on the surface. */
static PetscErrorCode OnSurface(PetscReal across, PetscReal above, PetscInt *flag)
{
  const PetscReal c = PETSC_SQRT2 / 2;
  PetscReal       x[DIM * 100], best = -PETSC_MAX_REAL;
  PetscInt        n = 0;
  Setup           s;

  PetscFunctionBegin;
  for (PetscInt i = -4; i <= 4; i++)
    for (PetscInt j = -4; j <= 0; j++, n++) {
      x[DIM * n]     = c * (j - i);
      x[DIM * n + 1] = c * (j + i);
      x[DIM * n + 2] = 0;
    }
  x[DIM * n]     = c * (above - across);
  x[DIM * n + 1] = c * (above + across);
  x[DIM * n + 2] = 0;
  PetscCall(SetupFill(FLAT, n + 1, x, 0, &s));
  PetscCall(SetupMoments(&s));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
    if (Norm(s.cloud->field[FIELD_POSITION] + DIM * a) < 0.1) best = s.cloud->integer[INT_SURFACE][a];
  *flag = (PetscInt)SetupMax(best);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestCone(void)
{
  PetscInt beside = -1, over = -1;

  PetscFunctionBegin;
  for (PetscInt side = -1; side <= 1; side += 2) {
    PetscCall(OnSurface(1.4 * side, 1.1, &beside));
    PetscCall(OnSurface(0.3 * side, 1.0, &over));
    CHECK_CLOSE(beside, 1, 0, "beside_the_cone");
    CHECK_CLOSE(over, 2, 0, "in_the_cone");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The shear rate that a liquid with mu = K times it shows, in a flow v(x) = flow(x) that does not slip at its walls; of
   particles below y = 5, for next to a free surface the rate is that a little farther inside. */
static PetscErrorCode TestShearRate(const char options[], void (*flow)(const PetscReal x[DIM], PetscReal v[DIM]),
                                    PetscReal (*rate)(const PetscReal x[DIM]), PetscReal tolerance, const char name[])
{
  const Viscosity viscosity = {.form = VISCOSITY_MORRIS, .no_slip = PETSC_TRUE};
  char            all[1024];
  PetscReal       error = 0;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(all, sizeof(all),
                          "-spacing 1 -bodies a -a_viscosity 5 -a_viscosity_model power_law -a_viscosity_exponent 2 "
                          "-packing_jitter 0 %s",
                          options));
  PetscCall(SetupPack(all, &s));
  PetscCall(SetupMoments(&s));
  for (PetscInt a = 0; a < s.cloud->n_owned; a++)
    if (s.cloud->integer[INT_LAYER][a])
      PetscCall(PetscArrayzero(s.cloud->field[FIELD_VELOCITY] + DIM * a, DIM));
    else
      flow(s.cloud->field[FIELD_POSITION] + DIM * a, s.cloud->field[FIELD_VELOCITY] + DIM * a);
  PetscCall(CloudUpdate(s.cloud, FIELD_VELOCITY));
  PetscCall(OperatorsApparentViscosity(s.cloud, &viscosity));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    const PetscReal *x = s.cloud->field[FIELD_POSITION] + DIM * a;

    if (x[1] < 5) error = PetscMax(error, PetscAbsReal(s.cloud->field[FIELD_VISCOSITY][a] / 5 - rate(x)));
  }
  CHECK_CLOSE(SetupMax(error), 0, tolerance, name);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A flow over the plane y = 2 whose velocity is quadratic in the distance, faster than that of a lid would be. */
static void Quadratic(const PetscReal x[DIM], PetscReal v[DIM])
{
  v[0] = 3 * (x[1] - 2) - 0.1 * PetscSqr(x[1] - 2);
  v[1] = v[2] = 0;
}

static PetscReal QuadraticRate(const PetscReal x[DIM])
{
  return PetscAbsReal(3 - 0.2 * (x[1] - 2));
}

/* A ring drop that is squeezed: 2 D:D = 2 (1/4 + 1/4 + 1). */
static void Squeeze(const PetscReal x[DIM], PetscReal v[DIM])
{
  v[0] = -0.5 * x[0];
  v[1] = x[1];
  v[2] = 0;
}

static PetscReal SqueezeRate(const PetscReal x[DIM])
{
  (void)x;
  return PetscSqrtReal(3);
}

static PetscErrorCode TestShearRates(void)
{
  PetscFunctionBegin;
  PetscCall(TestShearRate("-dimension 2 -box_lower 0,2 -box_upper 12,20 -box_x periodic -box_ymin wall -a_upper 12,8",
                          Quadratic, QuadraticRate, 1e-3, "shear_rate_over_a_wall"));
  PetscCall(TestShearRate("-dimension 2 -box_lower 0,-5 -box_upper 12,20 -box_x periodic -a_lower 0,2 -a_upper 12,8 "
                          "-solids floor -floor_lower -6,-5 -floor_upper 18,2",
                          Quadratic, QuadraticRate, 1e-3, "shear_rate_over_a_solid"));
  PetscCall(TestShearRate("-dimension axisymmetric -box_lower 0,-12 -box_upper 12,12 -a_shape sphere -a_radius 8 ",
                          Squeeze, SqueezeRate, 1e-4, "shear_rate_of_rings"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A periodic film of ten columns: the layers at both faces are on the surface, lambda 0.5, the next ones near it, 0.9.
 */
static PetscErrorCode TestSurfaceOfFilm(void)
{
  PetscReal count[2] = {0, 0};
  Setup     s;

  PetscFunctionBegin;
  PetscCall(SetupPack("-dimension 2 -spacing 1 -box_lower 0,-10 -box_upper 10,10 -box_x periodic -packing_jitter 0 "
                      "-bodies a -a_lower 0,-4 -a_upper 10,4",
                      &s));
  PetscCall(SetupMoments(&s));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
    if (s.cloud->integer[INT_SURFACE][a]) count[s.cloud->integer[INT_SURFACE][a] - 1]++;
  CHECK(SetupSum(count[0]) == 20 && SetupSum(count[1]) == 20, "surface_of_a_film");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(TestPair(VISCOSITY_MOMENT, 1, "moment"));
  PetscCall(TestPair(VISCOSITY_MOMENT, 1.1, "moment_summed_density"));
  PetscCall(TestPair(VISCOSITY_CLEARY, 1, "cleary"));
  PetscCall(TestPair(VISCOSITY_CLEARY, 1.1, "cleary_summed_density"));
  PetscCall(TestPair(VISCOSITY_MORRIS, 1, "morris"));
  PetscCall(TestSheets());
  PetscCall(TestSums());
  PetscCall(TestFloor());
  PetscCall(TestCoarseFloor());
  PetscCall(TestJump());
  PetscCall(TestWalls("-box_lower 0,2 -box_upper 10,8 -box_y wall -a_upper 10,8", "walls"));
  PetscCall(TestWalls("-a_lower 0,2 -a_upper 10,8 -solids floor,ceiling -floor_lower -5,0 -floor_upper 15,2 "
                      "-ceiling_lower -5,8 -ceiling_upper 15,10",
                      "solids"));
  PetscCall(TestShearRates());
  PetscCall(TestCone());
  PetscCall(TestSurfaceOfFilm());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
