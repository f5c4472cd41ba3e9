/* Rings (-dimension axisymmetric): volumes, and the operators near the axis against fields with known answers. Lengths
   in spacings. Runs on any number of ranks. */
#include "../../src/resampling/resampling_impl.h"
#include "setup.h"
#include "check.h"

#define TANK                                                                                                           \
  "-dimension axisymmetric -spacing 1 -box_lower 0,-10 -box_upper 16,10 -bodies a -a_density 900 -a_viscosity 90 "     \
  "-tension_type none "
#define NU (90. / 900.)
#define DT 1e-3 /* s; what the sources divide by, without meaning here */

/* Whether the neighbours of a particle are all around it. */
static PetscBool Inside(Cloud cloud, PetscInt a)
{
  const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a;

  return (PetscBool)(x[0] < 12 && PetscAbsReal(x[1]) < 6);
}

typedef void (*Flow)(const PetscReal x[DIM], PetscReal v[DIM]);

static void Growth(const PetscReal x[DIM], PetscReal v[DIM])
{
  v[0] = x[0];
  v[1] = 0;
}

static void Strain(const PetscReal x[DIM], PetscReal v[DIM])
{
  v[0] = -0.5 * x[0];
  v[1] = x[1];
}

/* Hill's spherical vortex of radius 16, its inside; U = 1. */
static void Vortex(const PetscReal x[DIM], PetscReal v[DIM])
{
  const PetscReal a2 = 16 * 16;

  v[0] = 1.5 * x[0] * x[1] / a2;
  v[1] = 1.5 * (1 - (2 * x[0] * x[0] + x[1] * x[1]) / a2);
}

static void Stream(const PetscReal x[DIM], PetscReal v[DIM])
{
  v[0] = 0;
  v[1] = 1;
}

static void Pipe(const PetscReal x[DIM], PetscReal v[DIM])
{
  v[0] = 0;
  v[1] = x[0] * x[0];
}

static void Swell(const PetscReal x[DIM], PetscReal v[DIM])
{
  v[0] = x[0] * x[0] * x[0];
  v[1] = 0;
}

static PetscErrorCode SetFlow(Cloud cloud, Flow flow)
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    cloud->field[FIELD_VELOCITY][DIM * a + 2] = 0;
    flow(cloud->field[FIELD_POSITION] + DIM * a, cloud->field[FIELD_VELOCITY] + DIM * a);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Largest error of a row's value from what it should be, in the first ring (r < 1) and elsewhere. */
typedef struct {
  PetscReal first, other;
} Errors;

static void Collect(Errors *errors, PetscReal r, PetscReal error)
{
  PetscReal *worst = r < 1 ? &errors->first : &errors->other;

  *worst = PetscMax(*worst, PetscAbsReal(error));
}

static void Share(Errors *errors)
{
  errors->first = SetupMax(errors->first);
  errors->other = SetupMax(errors->other);
}

static PetscErrorCode Divergence(Setup *s, Flow flow, PetscReal time_offset, PetscReal exact, Errors *errors)
{
  Cloud cloud = s->cloud;

  PetscFunctionBegin;
  *errors = (Errors){0, 0};
  PetscCall(SetFlow(cloud, flow));
  PetscCall(OperatorsDivergence(cloud, cloud->field[FIELD_VELOCITY], PETSC_TRUE, time_offset,
                                cloud->field[FIELD_DIVERGENCE], NULL, NULL));
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    if (Inside(cloud, a))
      Collect(errors, cloud->field[FIELD_POSITION][DIM * a], cloud->field[FIELD_DIVERGENCE][a] - exact);
  Share(errors);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Hill's vortex in five disordered packings: root of the mean square of the divergence in the first ring over that
   elsewhere, 1.15 of these. */
static PetscErrorCode TestDisorder(void)
{
  PetscReal square[2] = {0, 0}, count[2] = {0, 0};
  Errors    errors;
  Setup     s;

  PetscFunctionBegin;
  for (PetscInt seed = 1; seed <= 5; seed++) {
    char options[512];

    PetscCall(PetscSNPrintf(options, sizeof(options), TANK "-packing_jitter 0.3 -packing_seed %d", (int)seed));
    PetscCall(SetupPack(options, &s));
    PetscCall(SetupMoments(&s));
    PetscCall(Divergence(&s, Vortex, 0, 0, &errors));
    for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
      const PetscInt other = s.cloud->field[FIELD_POSITION][DIM * a] < 1 ? 0 : 1;

      if (!Inside(s.cloud, a)) continue;
      square[other] += PetscSqr(s.cloud->field[FIELD_DIVERGENCE][a]);
      count[other]++;
    }
    PetscCall(SetupClose(&s));
  }
  for (PetscInt k = 0; k < 2; k++) square[k] = PetscSqrtReal(SetupSum(square[k]) / SetupSum(count[k]));
  CHECK(square[0] < 1.5 * square[1] && square[1] < 1e-3, "divergence_of_a_vortex_in_disorder");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestDivergence(void)
{
  Errors lattice, jitter;
  Setup  s;

  PetscFunctionBegin;
  PetscCall(SetupPack(TANK "-packing_jitter 0", &s));
  PetscCall(SetupMoments(&s));
  PetscCall(Divergence(&s, Growth, 0, 2, &lattice));
  CHECK_CLOSE(PetscMax(lattice.first, lattice.other), 0, 1e-5, "divergence_of_growth");
  PetscCall(Divergence(&s, Growth, 0.25, 1.5, &lattice)); /* 2 - t (1 + 1) */
  CHECK_CLOSE(PetscMax(lattice.first, lattice.other), 0, 1e-5, "divergence_of_growth_later");
  PetscCall(Divergence(&s, Strain, 0, 0, &lattice));
  CHECK_CLOSE(PetscMax(lattice.first, lattice.other), 0, 1e-5, "divergence_of_strain");
  PetscCall(Divergence(&s, Vortex, 0, 0, &lattice));
  CHECK_CLOSE(PetscMax(lattice.first, lattice.other), 0, 1e-5, "divergence_of_vortex");
  PetscCall(SetupClose(&s));
  PetscCall(SetupPack(TANK "-packing_jitter 0.3", &s));
  PetscCall(SetupMoments(&s));
  PetscCall(Divergence(&s, Strain, 0, 0, &jitter));
  CHECK_CLOSE(PetscMax(jitter.first, jitter.other), 0, 1e-5, "divergence_of_strain_in_disorder");
  PetscCall(Divergence(&s, Vortex, 0, 0, &jitter)); /* slopes of v are up to 3/16 */
  CHECK(jitter.first <= 2 * jitter.other && jitter.other < 0.01, "divergence_at_the_axis_is_as_good_as_elsewhere");
  PetscCall(SetupClose(&s));
  PetscCall(TestDisorder());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A ring's volume is a lattice cell's, all around; a body's that of its shape. Ring areas are those of the lattice. */
static PetscErrorCode TestVolumes(void)
{
  const char ball[] = "-dimension axisymmetric -spacing 1 -box_lower 0,-20 -box_upper 20,20 -bodies a -a_shape sphere "
                      "-a_radius 8 -a_center 0,0 ",
             tank[] = TANK "-box_xmax wall -box_ymin wall -packing_jitter 0 ";
  PetscReal sum = 0, area = 0;
  Setup     s;

  PetscFunctionBegin;
  PetscCall(SetupPack(tank, &s));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) sum += s.cloud->volume[a];
  for (PetscInt a = 0; a < s.cloud->n_total; a++)
    area = PetscMax(area, PetscAbsReal(s.cloud->weight[a] - 1)); /* walls and images too */
  CHECK_CLOSE(SetupSum(sum) / (PETSC_PI * 16 * 16 * 20), 1, 1e-12, "volume_of_a_tank");
  CHECK_CLOSE(SetupMax(area), 0, 1e-12, "ring_areas_of_a_lattice");
  PetscCall(SetupClose(&s));
  /* what a wave displaces keeps its volume: of the lattice, 2 pi (k + 1/2), not of where it is now */
  PetscCall(SetupPack(TANK "-box_xmax wall -box_ymin wall -packing_jitter 0 -a_shape wave -a_upper 16,0 "
                           "-a_wave_amplitude 1",
                      &s));
  area = 0;
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    const PetscReal r = s.cloud->volume[a] / (2 * PETSC_PI);

    area = PetscMax(area, PetscAbsReal(r - PetscFloorReal(r) - 0.5));
  }
  CHECK_CLOSE(SetupMax(area), 0, 1e-9, "volumes_of_displaced_rings");
  PetscCall(SetupClose(&s));
  for (PetscInt seed = 1; seed <= 3; seed++) {
    char options[512];

    PetscCall(PetscSNPrintf(options, sizeof(options), "%s -packing_jitter 0.2 -packing_seed %d", ball, (int)seed));
    PetscCall(SetupPack(options, &s));
    sum = 0;
    for (PetscInt a = 0; a < s.cloud->n_fluid; a++) sum += s.cloud->volume[a];
    CHECK_CLOSE(SetupSum(sum) / (4. / 3 * PETSC_PI * 512), 1, 1e-4, "volume_of_a_sphere");
    PetscCall(SetupClose(&s));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Errors of the pressure operator's Laplacian of r^2 (which = 0) or z^2, over its exact value. */
static PetscErrorCode Laplacian(Setup *s, PetscInt which, Errors *errors)
{
  Cloud      cloud = s->cloud;
  PetscReal *p, *y;

  PetscFunctionBegin;
  *errors = (Errors){0, 0};
  PetscCall(PetscMalloc2(cloud->n_rows, &p, cloud->n_rows, &y));
  for (PetscInt a = 0; a < cloud->n_rows; a++) p[a] = PetscSqr(cloud->field[FIELD_POSITION][DIM * a + which]);
  PetscCall(PressureMultiply(s->pressure, p, y));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal laplacian = -y[a] * cloud->rest_density[a] / cloud->volume[a], exact = which ? 2 : 4;

    if (Inside(cloud, a)) Collect(errors, cloud->field[FIELD_POSITION][DIM * a], laplacian / exact - 1);
  }
  Share(errors);
  PetscCall(PetscFree2(p, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestLaplacian(void)
{
  Errors    r2, z2;
  Setup     s;
  Mat       A, T;
  Vec       b;
  PetscReal asymmetry;

  PetscFunctionBegin;
  PetscCall(SetupPack(TANK "-packing_jitter 0", &s));
  PetscCall(SetupMoments(&s));
  PetscCall(PressureCreate(s.cloud, &s.pressure));
  PetscCall(PressureSetFromOptions(s.pressure));
  PetscCall(PetscArrayzero(s.cloud->field[FIELD_DIVERGENCE], s.cloud->n_owned));
  PetscCall(PetscArrayzero(s.cloud->field[FIELD_CAPILLARY], s.cloud->n_owned));
  PetscCall(PressureAssemble(s.pressure, DT, &A, &b));
  PetscCall(MatTranspose(A, MAT_INITIAL_MATRIX, &T));
  PetscCall(MatAXPY(T, -1, A, DIFFERENT_NONZERO_PATTERN));
  PetscCall(MatNorm(T, NORM_FROBENIUS, &asymmetry));
  PetscCall(MatDestroy(&T));
  CHECK_CLOSE(asymmetry, 0, 1e-15, "pressure_rows_are_symmetric");
  PetscCall(Laplacian(&s, 0, &r2));
  PetscCall(Laplacian(&s, 1, &z2));
  CHECK_CLOSE(r2.first, 0.054, 1e-3, "laplacian_of_r2_at_the_axis"); /* with |r| in place of the middle 0.08 and 0.26 */
  CHECK_CLOSE(z2.first, 0.022, 1e-3, "laplacian_of_z2_at_the_axis");
  CHECK_CLOSE(PetscMax(r2.other, z2.other), 0, 5e-4, "laplacian_elsewhere");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Errors of the viscous acceleration over nu times a scale. */
static PetscErrorCode Friction(Setup *s, ViscosityForm form, Flow flow, PetscInt component,
                               PetscReal (*exact)(PetscReal), Errors *errors)
{
  Cloud cloud = s->cloud;

  PetscFunctionBegin;
  *errors = (Errors){0, 0};
  PetscCall(SetFlow(cloud, flow));
  PetscCall(PetscArrayzero(cloud->field[FIELD_ACCELERATION], DIM * cloud->n_owned));
  PetscCall(OperatorsViscosity(cloud, &(Viscosity){.form = form}, cloud->rest_density));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal r = cloud->field[FIELD_POSITION][DIM * a];

    if (Inside(cloud, a)) Collect(errors, r, cloud->field[FIELD_ACCELERATION][DIM * a + component] / NU - exact(r));
  }
  Share(errors);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal None(PetscReal r)
{
  return 0;
}

static PetscReal Four(PetscReal r)
{
  return 4;
}

static PetscReal EightR(PetscReal r)
{
  return 8 * r;
}

/* Of Hill's vortex, -10 of 1.5/16^2; the forms along the line of centres have a further -grad v_r/r, which the pressure
 * takes up. */
static PetscReal Vortical(PetscReal r)
{
  return -11 * 1.5 / (16 * 16);
}

/* The forms along the line of centres; first, other: of the friction in a pipe and in strain, that the first rings and
   others may miss. */
static PetscErrorCode CentralFriction(Setup *s, ViscosityForm form, const PetscReal first[2], const PetscReal other[2],
                                      const char label[])
{
  Errors error[5];
  char   name[96];

  PetscFunctionBegin;
  PetscCall(Friction(s, form, Stream, 1, None, &error[0]));
  PetscCall(Friction(s, form, Strain, 0, None, &error[1])); /* of pairs and growth alone it is 1/2r, 1 in the first */
  PetscCall(Friction(s, form, Strain, 1, None, &error[2]));
  PetscCall(Friction(s, form, Pipe, 1, Four, &error[3]));
  PetscCall(Friction(s, form, Vortex, 1, Vortical, &error[4]));
  if (getenv("TEST_VERBOSE"))
    for (PetscInt k = 0; k < 5; k++) printf("%s %d: %g %g\n", label, (int)k, error[k].first, error[k].other);
  PetscCall(PetscSNPrintf(name, sizeof(name), "no_friction_in_a_stream_%s", label));
  CHECK_CLOSE(PetscMax(error[0].first, error[0].other), 0, 1e-12, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "friction_in_strain_%s", label));
  CHECK(error[1].first < first[0] && error[1].other < other[0], name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "friction_in_strain_along_the_axis_%s", label));
  CHECK_CLOSE(PetscMax(error[2].first, error[2].other), 0, 1e-6, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "friction_in_a_pipe_%s", label));
  CHECK(error[3].first < first[1] && error[3].other < other[1], name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "friction_in_a_vortex_%s", label));
  CHECK(PetscMax(error[4].first, error[4].other) < 0.042 * -Vortical(0), name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestViscosity(void)
{
  const ViscosityForm morris = VISCOSITY_MORRIS;
  Errors              error;
  Setup               s;

  PetscFunctionBegin;
  PetscCall(SetupPack(TANK "-packing_jitter 0", &s));
  PetscCall(SetupMoments(&s));
  PetscCall(Friction(&s, morris, Stream, 1, None, &error));
  CHECK_CLOSE(PetscMax(error.first, error.other), 0, 1e-12, "no_friction_in_a_stream");
  PetscCall(Friction(&s, morris, Growth, 0, None, &error));
  CHECK_CLOSE(PetscMax(error.first, error.other), 0, 1e-12, "no_friction_in_growth");
  PetscCall(Friction(&s, morris, Pipe, 1, Four, &error));
  CHECK(error.first < 0.08 * 4 && error.other < 1e-6 * 4, "friction_in_a_pipe");
  PetscCall(Friction(&s, morris, Swell, 0, EightR, &error));
  CHECK(error.first < 0.05 * 8 * 12 && error.other < 0.02 * 8 * 12, "friction_in_a_swell"); /* of the largest */
  PetscCall(
    CentralFriction(&s, VISCOSITY_MOMENT, (PetscReal[]){0.04, 0.05 * 4}, (PetscReal[]){0.04, 0.01 * 4}, "moment"));
  PetscCall(
    CentralFriction(&s, VISCOSITY_CLEARY, (PetscReal[]){0.09, 0.13 * 4}, (PetscReal[]){0.15, 0.14 * 4}, "cleary"));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Random(const PetscReal x[DIM], PetscReal v[DIM])
{
  v[0] = x[0] * PetscCosReal(0.7 * x[1] + x[0]);
  v[1] = PetscSinReal(0.9 * x[0] * x[1]);
}

/* The operator of the implicit solve: its product is the explicit term, where neighbours are missing, too; times the
   mass it is symmetric, and the diagonal is its own. */
static PetscErrorCode TestImplicit(ViscosityForm form, const char label[])
{
  const Viscosity viscosity = {.form = form};
  Setup           s;
  Cloud           cloud;
  PetscReal      *pair, *u, *out, *diagonal, error = 0, most = 0, product[2] = {0, 0}, wrong = 0, along = 0;
  char            name[96];

  PetscFunctionBegin;
  PetscCall(SetupPack(TANK "-box_xmax wall -box_ymin wall -packing_jitter 0.2", &s));
  PetscCall(SetupMoments(&s));
  cloud = s.cloud;
  PetscCall(PetscMalloc4(OperatorsViscosityRoom(cloud), &pair, DIM * cloud->n_total, &u, DIM * cloud->n_total, &out,
                         DIM * cloud->n_total, &diagonal));
  PetscCall(SetFlow(cloud, Random));
  PetscCall(CloudUpdate(cloud, FIELD_VELOCITY)); /* images are those of vectors */
  PetscCall(PetscArrayzero(cloud->field[FIELD_ACCELERATION], DIM * cloud->n_owned));
  PetscCall(OperatorsViscosity(cloud, &viscosity, cloud->rest_density));
  PetscCall(OperatorsViscosityPairs(cloud, &viscosity, cloud->rest_density, pair));
  PetscCall(OperatorsViscosityApply(cloud, &viscosity, pair, cloud->field[FIELD_VELOCITY], out));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) {
    error = PetscMax(error, PetscAbsReal(out[k] - cloud->field[FIELD_ACCELERATION][k]));
    most  = PetscMax(most, PetscAbsReal(out[k]));
  }
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_implicit_as_explicit", label));
  CHECK_CLOSE(SetupMax(error) / SetupMax(most), 0, 1e-6, name);
  if (form == VISCOSITY_MOMENT) PetscCall(SetupTakenAlong(cloud, &viscosity, &along));
  CHECK_CLOSE(along, 0, 1e-6, "viscosity_taken_along");
  for (PetscInt a = 0; a < cloud->n_total; a++) /* two other fields, the walls at rest */
    for (PetscInt d = 0; d < DIM; d++) {
      const PetscReal fluid = cloud->integer[INT_LAYER][a] ? 0 : 1;

      cloud->field[FIELD_VELOCITY][DIM * a + d] *= fluid;
      u[DIM * a + d] = d < 2 ? fluid * RandomUnit(3, (unsigned long long)(DIM * cloud->integer[INT_ID][a] + d)) : 0;
    }
  for (PetscInt pass = 0; pass < 2; pass++) {
    PetscReal *field = pass ? u : cloud->field[FIELD_VELOCITY], *other = pass ? cloud->field[FIELD_VELOCITY] : u;

    PetscCall(OperatorsViscosityApply(cloud, &viscosity, pair, field, out));
    for (PetscInt a = 0; a < cloud->n_fluid; a++)
      product[pass] += cloud->volume[a] * Dot(out + DIM * a, other + DIM * a);
    product[pass] = SetupSum(product[pass]);
  }
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_implicit_symmetric", label));
  CHECK_CLOSE(product[0] / product[1], 1, 1e-12, name);
  PetscCall(OperatorsViscosityDiagonal(cloud, &viscosity, pair, diagonal));
  for (PetscInt d = 0; d < 2; d++) { /* of the particle with the middle id, which may be near the axis or not */
    const PetscInt middle = (PetscInt)(SetupSum((PetscReal)cloud->n_fluid) / 2);

    PetscCall(PetscArrayzero(u, DIM * cloud->n_total));
    for (PetscInt a = 0; a < cloud->n_owned; a++)
      if (cloud->integer[INT_ID][a] == middle) u[DIM * a + d] = 1;
    PetscCall(OperatorsViscosityApply(cloud, &viscosity, pair, u, out));
    for (PetscInt a = 0; a < cloud->n_fluid; a++)
      if (cloud->integer[INT_ID][a] == middle)
        wrong = PetscMax(wrong, PetscAbsReal(out[DIM * a + d] / diagonal[DIM * a + d] - 1));
  }
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_implicit_diagonal", label));
  CHECK_CLOSE(SetupMax(wrong), 0, 1e-12, name);
  PetscCall(PetscFree4(pair, u, out, diagonal));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Surface tension: the pressure 2 sigma/R of a drop, of which a plane drop would have half. */
static PetscErrorCode TestTension(void)
{
  Setup     s;
  PetscReal sum = 0, count = 0;

  PetscFunctionBegin;
  PetscCall(SetupPack("-dimension axisymmetric -spacing 1 -box_lower 0,-20 -box_upper 20,20 -bodies a -a_shape sphere "
                      "-a_radius 8 -a_center 0,0 -a_tension 1 -packing_jitter 0.1 ",
                      &s));
  PetscCall(SetupMoments(&s));
  PetscCall(PetscArrayzero(s.cloud->field[FIELD_ACCELERATION], DIM * s.cloud->n_owned));
  PetscCall(TensionApply(s.tension, s.cloud));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    if (s.cloud->integer[INT_SURFACE][a] != 1) continue;
    sum += s.cloud->volume[a] * s.cloud->field[FIELD_CAPILLARY][a] / (2. / 8);
    count += s.cloud->volume[a];
  }
  CHECK_CLOSE(SetupSum(sum) / SetupSum(count), 1, 0.04, "tension_of_a_drop"); /* not yet at rest */
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sums over the liquid: volume, of it times height, radial and axial velocity, half its square, and pressure. */
typedef struct {
  PetscReal V, z, v[2], energy, p;
  PetscReal least, most; /* ring areas over V_0; largest inside */
  PetscInt  count, highest;
} Sums;

static Sums SumUp(Setup *s)
{
  Cloud cloud = s->cloud;
  Sums  sums  = {.least = PETSC_MAX_REAL};

  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, *v = cloud->field[FIELD_VELOCITY] + DIM * a,
                    V = cloud->volume[a], area = V / DomainRingLength(cloud->domain, x, 1);

    sums.V += V;
    sums.z += V * x[1];
    for (PetscInt d = 0; d < 2; d++) sums.v[d] += V * v[d];
    sums.energy += 0.5 * cloud->rest_density[a] * V * Dot(v, v);
    sums.p += V * cloud->field[FIELD_PRESSURE][a];
    sums.least = PetscMin(sums.least, area);
    if (Inside(cloud, a)) sums.most = PetscMax(sums.most, area); /* there is no room for two in a corner of the box */
    sums.count++;
    sums.highest = PetscMax(sums.highest, cloud->integer[INT_ID][a]);
  }
  sums.V      = SetupSum(sums.V);
  sums.z      = SetupSum(sums.z);
  sums.v[0]   = SetupSum(sums.v[0]);
  sums.v[1]   = SetupSum(sums.v[1]);
  sums.energy = SetupSum(sums.energy);
  sums.p      = SetupSum(sums.p);
  sums.least  = -SetupMax(-sums.least);
  sums.most   = SetupMax(sums.most);
  sums.count  = (PetscInt)SetupSum((PetscReal)sums.count);
  return sums;
}

/* A fat ring on the axis and under an open top, where there is room in one direction only, and little of it. */
static PetscErrorCode TestNarrow(void)
{
  Setup            s;
  ParticleArrays   arrays;
  ResamplingReport report;

  PetscFunctionBegin;
  PetscCall(SetupPack("-dimension axisymmetric -spacing 1 -box_lower 0,0 -box_upper 20,10.2 -bodies a -a_lower 0,9 "
                      "-a_upper 1,10 -packing_jitter 0",
                      &s));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) arrays.real[FIELD_VOLUME][a] *= 6;
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(CloudResync(s.cloud));
  PetscCall(SetupMoments(&s));
  PetscCall(SetupDivergence(&s));
  CHECK(ResamplingDue(1, SetupMax(s.cloud->n_owned ? ResamplingArea(s.cloud, 0) : 0)),
        "resampling_does_not_wait_for_a_ring_that_is_far_too_fat");
  PetscCall(Resample(s.cloud, &report));
  CHECK(report.split == 1, "resampling_splits_where_there_is_little_room");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Every third ring of a tank that flows is made thin and every seventh fat: joining and splitting take the areas back
   between their bounds and keep volume, its height and momentum; energy changes by what is reported. */
static PetscErrorCode TestResampling(void)
{
  Setup            s;
  ParticleArrays   arrays;
  ResamplingReport report;
  Sums             before, after;

  PetscFunctionBegin;
  PetscCall(SetupPack(TANK "-packing_jitter 0.2", &s));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscInt id = arrays.integer[INT_ID][a];

    arrays.real[FIELD_VOLUME][a] *= id % 7 == 0 ? 1.7 : id % 3 == 0 ? 0.3 : 0.9;
    arrays.real[FIELD_PRESSURE][a] = 1 + id % 5;
    Vortex(arrays.real[FIELD_POSITION] + DIM * a, arrays.real[FIELD_VELOCITY] + DIM * a);
  }
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(CloudResync(s.cloud));
  PetscCall(SetupMoments(&s));
  PetscCall(PetscArraycpy(s.cloud->field[FIELD_VELOCITY_STAR], s.cloud->field[FIELD_VELOCITY], DIM * s.cloud->n_total));
  PetscCall(SetupDivergence(&s));
  before = SumUp(&s);
  CHECK(!ResamplingDue(9, 1.7) && ResamplingDue(10, 1.7) && !ResamplingDue(11, 1.7),
        "resampling_is_due_at_its_interval");
  PetscCall(Resample(s.cloud, &report));
  after = SumUp(&s);
  CHECK(report.joined > 50 && report.split > 20, "resampling_joins_and_splits");
  CHECK(after.count == before.count - report.joined + report.split, "resampling_counts");
  CHECK_CLOSE(after.V / before.V, 1, 1e-13, "resampling_keeps_the_volume");
  CHECK_CLOSE((after.z - before.z) / before.V, 0, 1e-13, "resampling_keeps_the_height");
  CHECK_CLOSE((after.v[0] - before.v[0]) / before.V, 0, 1e-13, "resampling_keeps_the_flow_outwards");
  CHECK_CLOSE((after.v[1] - before.v[1]) / before.V, 0, 1e-13, "resampling_keeps_momentum");
  CHECK_CLOSE(after.p / before.p, 1, 1e-13, "resampling_keeps_the_mean_pressure");
  CHECK_CLOSE((before.energy - after.energy - report.energy) / before.energy, 0, 1e-13,
              "resampling_reports_the_energy");
  CHECK(before.most > 1.6 && after.most < 1.6, "resampling_leaves_none_fat");
  for (PetscInt k = 0; k < 5; k++) { /* of three in a row one waits for the next time */
    PetscCall(SetupMoments(&s));
    PetscCall(SetupDivergence(&s));
    PetscCall(Resample(s.cloud, &report));
  }
  after = SumUp(&s);
  CHECK(before.least < 0.35 && after.least > 0.55 && after.count < 0.9 * before.count, "resampling_joins_the_thin");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A sheet one ring thick, part of a cone: 20 rings from 10 spacings off the axis on, one after the other with this
   slope. Its energy is that of two surfaces, 2 sigma A. Stretched by 1 + e, A grows by 2 e A, one half along the cone,
   the other around it, so sum V rho a x, over the places x from the cone's tip, is -4 sigma A; and there is no force
   along the axis. */
static PetscErrorCode TestSheet(PetscReal slope)
{
  const PetscReal c    = 1 / PetscSqrtReal(1 + slope * slope);
  PetscReal       work = 0, along = 0, most = 0, area = 0;
  char            name[64];
  Setup           s;
  ParticleArrays  arrays;
  PetscMPIInt     rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(SetupOpen("-dimension axisymmetric -spacing 1 -box_lower 0,-40 -box_upper 50,40 -bodies a -a_density 1 "
                      "-a_tension 1 ",
                      &s));
  PetscCall(ParticlesAppend(s.particles, rank ? 0 : 20));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    PetscReal *x = arrays.real[FIELD_POSITION] + DIM * a;

    x[0] = 10 + (a + 0.5) * c;
    x[1] = slope * x[0];

    arrays.real[FIELD_VOLUME][a] = 2 * PETSC_PI * x[0];
    arrays.integer[INT_ID][a] = arrays.integer[INT_PARENT][a] = a;
  }
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(CloudResync(s.cloud));
  PetscCall(SetupMoments(&s));
  PetscCall(PetscArrayzero(s.cloud->field[FIELD_ACCELERATION], DIM * s.cloud->n_owned));
  PetscCall(TensionSurface(s.tension, s.cloud, NULL)); /* the sheet is no ring in flight */
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    const PetscReal *x = s.cloud->field[FIELD_POSITION] + DIM * a, *pull = s.cloud->field[FIELD_ACCELERATION] + DIM * a;

    work += s.cloud->volume[a] * Dot(pull, x);
    along += s.cloud->volume[a] * pull[1];
    most += s.cloud->volume[a] * Norm(pull);
    area += s.cloud->volume[a];
  }
  PetscCall(PetscSNPrintf(name, sizeof(name), "pull_of_a_sheet_of_rings_of_slope_%g", (double)slope));
  CHECK_CLOSE(SetupSum(work) / (-4 * SetupSum(area)), 1, 0.1, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "no_force_along_the_axis_of_slope_%g", (double)slope));
  CHECK_CLOSE(SetupSum(along) / SetupSum(most), 0, 1e-4, name);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Two small rings near each other join if they are of one body. */
static PetscErrorCode TestBodies(PetscBool same)
{
  const PetscReal  x[2 * DIM] = {8, 0, 0, 8.7, 0, 0};
  Setup            s;
  ParticleArrays   arrays;
  ResamplingReport report;
  PetscMPIInt      rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(SetupOpen(TANK "-bodies a,b -a_upper 16,9 -b_density 900 -b_viscosity 90 -b_lower 0,9 ", &s));
  PetscCall(ParticlesAppend(s.particles, rank ? 0 : 2));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  PetscCall(PetscArraycpy(arrays.real[FIELD_POSITION], x, DIM * arrays.n));
  for (PetscInt a = 0; a < arrays.n; a++) {
    arrays.real[FIELD_VOLUME][a] = 0.4 * 2 * PETSC_PI * arrays.real[FIELD_POSITION][DIM * a];
    arrays.integer[INT_BODY][a]  = same ? 1 : a;
    arrays.integer[INT_ID][a] = arrays.integer[INT_PARENT][a] = a;
  }
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(CloudResync(s.cloud));
  PetscCall(SetupMoments(&s));
  PetscCall(SetupDivergence(&s));
  PetscCall(Resample(s.cloud, &report));
  CHECK(report.joined == (same ? 1 : 0), same ? "small_rings_of_one_body_join" : "small_rings_of_two_bodies_do_not");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(TestVolumes());
  PetscCall(TestDivergence());
  PetscCall(TestLaplacian());
  PetscCall(TestViscosity());
  PetscCall(TestImplicit(VISCOSITY_MORRIS, "morris"));
  PetscCall(TestImplicit(VISCOSITY_CLEARY, "cleary"));
  PetscCall(TestImplicit(VISCOSITY_MOMENT, "moment"));
  PetscCall(TestTension());
  PetscCall(TestNarrow());
  PetscCall(TestResampling());
  PetscCall(TestSheet(0));
  PetscCall(TestSheet(0.75));
  PetscCall(TestBodies(PETSC_TRUE));
  PetscCall(TestBodies(PETSC_FALSE));
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
