/* The size of the time step, what a trial of a step measures and refuses, the guards at walls, the work of the forces:
   against the formulas, from states that are set by hand. Runs on any number of ranks. */
#include "../../src/bodies/bodies_impl.h"
#include "../../src/pressure/pressure_impl.h"
#include "../../src/stepper/stepper_impl.h"
#include "refuse.h"
#include "setup.h"

#define D0  0.1  /* spacing, m */
#define H   0.13 /* smoothing length, m */
#define RHO 800. /* kg/m3 */
#define BLOCK                                                                                                          \
  "-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 4,4 -packing_jitter 0 -bodies a -a_upper 1,1 -a_density 800 "   \
  "-a_velocity 1,0 "
#define QUIET BLOCK "-a_viscosity 0 "

static PetscErrorCode MakeStepper(Setup *s, Stepper *stepper)
{
  PetscFunctionBegin;
  PetscCall(PressureCreate(s->cloud, &s->pressure));
  PetscCall(StepperCreate(s->cloud, s->tension, s->pressure, stepper));
  PetscCall(StepperSetFromOptions(*stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- size of the step --- */

/* The step of a block that moves at 5 m/s, after one of 'previous' (s), with 'left' (s) to go; the particle with id 0
   is spray of 50 m/s if 'spray' says so. */
static PetscErrorCode StepOf(const char options[], PetscReal previous, PetscReal left, PetscBool spray, PetscReal *dt,
                             PetscBool *implicit)
{
  const StepState state = {.time = 3, .step = 7, .previous_time_step = previous};
  ParticleArrays  arrays;
  Stepper         stepper;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(SetupPack(options, &s));
  PetscCall(MakeStepper(&s, &stepper));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscReal fast = spray && arrays.integer[INT_ID][a] == 0 ? 10 : 1;

    arrays.real[FIELD_VELOCITY][DIM * a]     = 3 * fast;
    arrays.real[FIELD_VELOCITY][DIM * a + 1] = -4 * fast;
    arrays.real[FIELD_LAMBDA][a]             = fast > 1 ? 0.1 : 1;
  }
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(StepSize(stepper, &state, 3 + left, dt));
  *implicit = stepper->viscous.implicit;
  PetscCall(StepperDestroy(&stepper));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define CAPILLARY PetscSqrtReal(RHO *H *H *H / (2 * PETSC_PI * 7e4)) /* s */

#define PERIOD (2 * PETSC_PI * PetscSqrtReal(RHO * 0.125 / (8 * 7e4))) /* s, of a sphere of radius 0.5 m */

static PetscErrorCode TestStep(void)
{
  const struct {
    const char *name, *options;
    PetscReal   previous, left;
    PetscBool   spray;
    PetscReal   due;
    PetscBool   implicit;
  } cases[] = {
    {"speed", QUIET "-time_cfl 0.3", 1, 9, PETSC_FALSE, 0.3 * H / 5, PETSC_FALSE},
    {"speed, as far as no rollback", QUIET "-time_cfl 0.5", 1, 9, PETSC_FALSE, 0.8 * 0.5 * D0 / 5, PETSC_FALSE},
    {"growth", QUIET, 1e-4, 9, PETSC_FALSE, 1.2e-4, PETSC_FALSE},
    {"largest", QUIET "-time_step_max 1e-3", 1, 9, PETSC_FALSE, 1e-3, PETSC_FALSE},
    {"smallest", QUIET "-time_step_min 8e-3", 1, 9, PETSC_FALSE, 8e-3, PETSC_FALSE},
    {"fixed", QUIET "-time_step 0.1", 1, 0.25, PETSC_FALSE, 0.1, PETSC_FALSE},
    {"fixed, the last two", QUIET "-time_step 0.1", 1, 0.15, PETSC_FALSE, 0.075, PETSC_FALSE},
    {"viscosity", BLOCK "-a_viscosity 8000 -viscosity_solver explicit", 1, 9, PETSC_FALSE, 0.08 * H * H * RHO / 8000,
     PETSC_FALSE},
    {"implicit viscosity", BLOCK "-a_viscosity 8000 ", 1, 9, PETSC_FALSE, 30 * 0.08 * H * H * RHO / 8000, PETSC_TRUE},
    {"viscosity that is small", BLOCK "-a_viscosity 8", 1, 9, PETSC_FALSE, 0.2 * H / 5, PETSC_FALSE},
    {"tension, default", QUIET "-a_tension 7e4", 1, 9, PETSC_FALSE, 0.5 * CAPILLARY, PETSC_FALSE},
    {"tension, few steps", QUIET "-a_tension 7e4 -time_steps_per_period 40", 1, 9, PETSC_FALSE, PERIOD / 40,
     PETSC_FALSE},
    {"tension, thick",
     QUIET "-a_tension 7e4 -a_upper 4,4 -time_steps_per_period 60 -displacement_max 9"
           " -time_cfl 2",
     1, 9, PETSC_FALSE, 4 * CAPILLARY, PETSC_FALSE},
    {"tension, a hole",
     QUIET "-a_tension 7e4 -a_upper 4,4 -time_steps_per_period 40 -displacement_max 9"
           " -time_cfl 2 -a_holes hole -hole_shape sphere -hole_center 2,2 -hole_radius 0.5",
     1, 9, PETSC_FALSE, PERIOD / 40, PETSC_FALSE},
    {"tension, not centered", QUIET "-a_tension 7e4 -time_centered 0", 1, 9, PETSC_FALSE, 0.25 * CAPILLARY,
     PETSC_FALSE},
    {"tension, Cahn-Hilliard", QUIET "-a_tension 7e4 -tension_type cahn_hilliard", 1, 9, PETSC_FALSE, 0.25 * CAPILLARY,
     PETSC_FALSE},
    {"force", QUIET "-gravity 0,-1000", 1, 9, PETSC_FALSE, 0.25 * PetscSqrtReal(H / 1000), PETSC_FALSE},
    {"force, not centered", QUIET "-gravity 0,-1000 -time_centered 0", 1, 9, PETSC_FALSE,
     0.03 * PetscSqrtReal(H / 1000), PETSC_FALSE},
    {"swing", QUIET "-gravity_amplitude 0,1e-3 -gravity_frequency 50", 1, 9, PETSC_FALSE, 1 / (16 * 50.), PETSC_FALSE},
    {"viscosity without inertia", BLOCK "-a_viscosity 80000", 1, 9, PETSC_FALSE, 0.15 / 100, PETSC_TRUE},
    {"tension, very viscous", BLOCK "-a_tension 7e4 -a_viscosity 20000", 1, 9, PETSC_FALSE, 0.03 * 20000 * H / 7e4,
     PETSC_TRUE},
    {"spray", QUIET "-displacement_max 0.4", 1, 9, PETSC_TRUE, 0.8 * 0.4 * D0 / 50, PETSC_FALSE},
    {"last", QUIET, 1, 0.2 * H / 5 * 1.0005, PETSC_FALSE, 0.2 * H / 5 * 1.0005, PETSC_FALSE},
    {"last two", QUIET, 1, 0.2 * H / 5 * 1.5, PETSC_FALSE, 0.2 * H / 5 * 0.75, PETSC_FALSE},
    {"sound", QUIET "-scheme weakly_compressible -sound_speed 95", 1, 9, PETSC_FALSE, 0.4 * H / 100, PETSC_FALSE},
  };

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(cases); k++) {
    PetscReal dt       = 0;
    PetscBool implicit = PETSC_FALSE;
    char      name[64];

    PetscCall(StepOf(cases[k].options, cases[k].previous, cases[k].left, cases[k].spray, &dt, &implicit));
    PetscCall(PetscSNPrintf(name, sizeof(name), "step: %s", cases[k].name));
    CHECK_CLOSE(dt / cases[k].due, 1, 1e-12, name);
    CHECK_CLOSE(implicit, cases[k].implicit, 0, name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Velocity and energy of a scene: a speed of 5 m/s, 1 m to fall within the body and 4 m in the box at 10 m/s2, and
   tension. */
static PetscErrorCode TestScales(void)
{
  const PetscReal capillary = 70 / (RHO * H);
  Stepper         stepper;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(SetupPack(QUIET "-a_velocity 3,-4 -gravity 0,-10 -a_tension 70", &s));
  PetscCall(MakeStepper(&s, &stepper));
  CHECK_CLOSE(StepperReferenceVelocity(stepper), PetscSqrtReal(25 + 10 + capillary), 1e-12, "scene: velocity");
  CHECK_CLOSE(StepperEnergyAtHand(stepper), 12.5 + 40 + capillary, 1e-12, "scene: energy at hand");
  CHECK_CLOSE(s.pressure->relaxation_time, 5 * H / PetscSqrtReal(35 + capillary), 1e-12, "scene: relaxation time");
  PetscCall(StepperDestroy(&stepper));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Liquids whose densities are too far apart are refused. */
static PetscErrorCode TestDensities(void)
{
  PetscErrorCode code;
  Stepper        stepper;
  Setup          s;

  PetscFunctionBegin;
  PetscCall(SetupPack(QUIET "-bodies a,b -b_lower 1,0 -b_upper 2,1 -b_density 300", &s));
  PetscCall(PressureCreate(s.cloud, &s.pressure));
  PetscCall(StepperCreate(s.cloud, s.tension, s.pressure, &stepper));
  RefuseBegin();
  code = StepperSetFromOptions(stepper);
  RefuseEnd(code, "-a_density is 2.66667 times -b_density", "scene: densities too far apart");
  PetscCall(StepperDestroy(&stepper));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- trial --- */

/* Whether a trial is refused, with these numbers on top of those of a good one. */
static PetscErrorCode Refused(Stepper stepper, TrialLargest which, PetscReal value, PetscReal kinetic,
                              const char word[], const char name[])
{
  StepTrial trial = {.sum[SUM_MASS] = 2, .sum[SUM_KINETIC] = kinetic};
  char      why[512];

  PetscFunctionBegin;
  if (which < LARGEST_COUNT) trial.largest[which] = value;
  PetscCall(TrialCheck(stepper, 1e-3, &trial, why, sizeof(why)));
  CHECK(word ? strstr(why, word) != NULL : !why[0], name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestRefused(void)
{
  Stepper stepper;
  Setup   s;

  PetscFunctionBegin;
  PetscCall(SetupPack(QUIET "-a_velocity 2,0 -displacement_max 0.4 -energy_max 3", &s));
  PetscCall(MakeStepper(&s, &stepper)); /* 2 J/kg at hand, so 12 J for 2 kg */
  PetscCall(Refused(stepper, LARGEST_DISPLACEMENT, 0.39 * D0, 11.9, NULL, "trial: a good one"));
  PetscCall(Refused(stepper, LARGEST_DISPLACEMENT, 0.41 * D0, 0, "-displacement_max", "trial: too far"));
  PetscCall(Refused(stepper, LARGEST_DENSITY, 2.99, 0, NULL, "trial: dense"));
  PetscCall(Refused(stepper, LARGEST_DENSITY, 3.01, 0, "have clumped", "trial: too dense"));
  PetscCall(Refused(stepper, LARGEST_BROKEN, 1, 0, "not numbers", "trial: not a number"));
  PetscCall(Refused(stepper, LARGEST_COUNT, 0, 12.1, "-energy_max", "trial: too much energy"));
  PetscCall(StepperDestroy(&stepper));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sums of a trial from densities, flags and normals set by hand: particles with an even number are inside, those with
   an odd one, and those at corners, where the divergence is not exact, on the surface. Two liquids of 800 and 400
   kg/m3. */
static PetscErrorCode TestSums(void)
{
  StepTrial trial  = {.diagnose = PETSC_TRUE};
  PetscReal inside = 0, tension = 0, mass = 0;
  Stepper   stepper;
  Setup     s;
  Cloud     cloud;

  PetscFunctionBegin;
  PetscCall(SetupPack(
    "-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 4,4 -packing_jitter 0.1 -bodies a,b "
    "-a_upper 1,1 -a_density 800 -a_velocity 1,0 -a_tension 0.5 -b_lower 1,0 -b_upper 2,1 -b_density 400 -b_tension "
    "0.25 ",
    &s));
  PetscCall(MakeStepper(&s, &stepper));
  PetscCall(SetupMoments(&s));
  cloud = s.cloud;
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a;

    cloud->integer[INT_SURFACE][a] = cloud->integer[INT_ID][a] % 2 || cloud->field[FIELD_LAMBDA][a] <= MOMENT_MINIMUM;
    cloud->field[FIELD_DENSITY][a] = 1.02 * cloud->rest_density[a];
    cloud->field[FIELD_NORMAL][DIM * a]       = 3;
    cloud->field[FIELD_NORMAL][DIM * a + 1]   = -4;
    cloud->field[FIELD_VELOCITY][DIM * a]     = 2 * x[0] - x[1];
    cloud->field[FIELD_VELOCITY][DIM * a + 1] = 5 * x[1] + 8 * x[0];
    if (a >= cloud->n_fluid) continue;
    inside += !cloud->integer[INT_SURFACE][a];
    tension += cloud->integer[INT_SURFACE][a] ? cloud->integer[INT_BODY][a] ? 0.25 : 0.5 : 0;
    mass += D0 * D0 * (cloud->integer[INT_BODY][a] ? 400 : 800);
  }
  PetscCall(TrialDiagnose(stepper, &trial));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) cloud->field[FIELD_VELOCITY][k] = 2;
  PetscCall(TrialReduce(stepper, &trial));
  inside  = SetupSum(inside);
  tension = SetupSum(tension);
  mass    = SetupSum(mass);
  CHECK(inside > 90 && inside <= 100, "sums: about half is inside");
  CHECK_CLOSE(trial.sum[SUM_INSIDE], inside, 0, "sums: particles inside");
  CHECK_CLOSE(trial.sum[SUM_DENSITY] / inside, 1.02, 1e-12, "sums: density");
  CHECK_CLOSE(trial.sum[SUM_DENSITY2] / inside, 4e-4, 1e-12, "sums: square of the density error");
  CHECK_CLOSE(trial.sum[SUM_DIVERGENCE2] / inside, 49, 1e-8, "sums: square of the divergence");
  CHECK_CLOSE(trial.sum[SUM_SURFACE_ENERGY], tension * 2 * 5 * D0 * D0, 1e-12, "sums: surface energy");
  CHECK_CLOSE(trial.sum[SUM_MASS], 1200, 1e-9, "sums: mass");
  CHECK_CLOSE(mass, 1200, 1e-9, "sums: mass of two liquids");
  CHECK_CLOSE(trial.sum[SUM_KINETIC], 1200 * 6, 1e-8, "sums: kinetic energy"); /* 12/2 m2/s2 */
  CHECK_CLOSE(trial.largest[LARGEST_DENSITY], 1.02, 1e-12, "sums: largest density");
  PetscCall(StepperDestroy(&stepper));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- guard --- */

/* A particle at (x, y) with velocity (u, v), and where it must be and go after the guard of a quarter spacing. */
typedef struct {
  PetscReal before[4], after[4];
} Guarded;

/* An edge that adds up what the guard takes, over the mass of a particle. */
static PetscReal taken[DIM];

static PetscErrorCode AddPush(const Step *step, PetscInt solid, const PetscReal x[DIM], const PetscReal momentum[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) taken[d] += momentum[d] / (step->cloud->volume[0] * step->cloud->rest_density[0]);
  return PETSC_SUCCESS;
}

/* With particles of this size, whose guard is as much wider. */
static PetscErrorCode TestGuard(PetscReal size)
{
  static const Edge        adds    = {.name = "adds", .push = AddPush};
  static const Edge *const edges[] = {&adds, NULL};
  struct _p_Stepper        stepper = {.edges = edges};
  /* walls at x = 0 and 4, mirrors at y = 0 and 4, a solid disc of 0.5 m about (2, 2); a plate 0.03 m from the wall at
     x = 4 and 0.04 m from a bar: in these gaps a particle is in the middle */
  static const Guarded cases[] = {
    {{0.01, 1, -1, 3}, {0.025, 1, 0, 3}}, {{0.01, 1, 1, 3}, {0.025, 1, 1, 3}},
    {{3.99, 1, 1, 3}, {3.975, 1, 0, 3}},  {{3.99, 1, -1, 3}, {3.975, 1, -1, 3}},
    {{1, -0.01, 3, -1}, {1, 0.01, 3, 1}}, {{1, 4.02, 3, 1}, {1, 3.98, 3, -1}},
    {{2.51, 2, -1, 3}, {2.525, 2, 0, 3}}, {{2.51, 2, 1, 3}, {2.525, 2, 1, 3}},
    {{2, 1.49, 3, 1}, {2, 1.475, 3, 0}},  {{0.03, 0.01, -1, -1}, {0.03, 0.01, -1, -1}},
    {{2.53, 2, -1, 3}, {2.53, 2, -1, 3}}, {{3.99, 3, 1, 3}, {3.985, 3, 0, 3}},
    {{3.96, 3, 1, 3}, {3.985, 3, 0, 3}},  {{2.99, 3, 1, 3}, {2.98, 3, 1, 3}},
  };
  const PetscInt n                                              = PETSC_STATIC_ARRAY_LENGTH(cases);
  PetscReal      points[DIM * PETSC_STATIC_ARRAY_LENGTH(cases)] = {0}, *x, *v, worst = 0;
  Setup          s;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(taken, DIM));
  for (PetscInt k = 0; k < n; k++) {
    points[DIM * k]     = 0.5 + 0.25 * (k % 4); /* somewhere in the box */
    points[DIM * k + 1] = 0.5 + 0.25 * (k / 4);
  }
  PetscCall(SetupFill("-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 4,4 -box_x wall -box_y symmetry -bodies a "
                      "-a_upper 1.2,4 -solids disc,plate,bar -disc_shape sphere -disc_center 2,2 -disc_radius 0.5 "
                      "-plate_lower 3,2.7 -plate_upper 3.97,3.4 -bar_lower 2,2.7 -bar_upper 2.96,3.4",
                      n, points, 0, &s));
  x = s.cloud->field[FIELD_POSITION];
  v = s.cloud->field[FIELD_VELOCITY];
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
    for (PetscInt d = 0; d < 2; d++) {
      const Guarded *c = &cases[s.cloud->integer[INT_ID][a]];

      x[DIM * a + d] = c->before[d];
      v[DIM * a + d] = c->before[2 + d];
    }
  stepper.cloud = stepper.now.cloud = s.cloud;
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) s.cloud->size[a] = size;
  PetscCall(WallGuard(&stepper, 0.025 / size, x, v));
  CHECK_CLOSE(SetupSum(taken[0]), -1, 1e-9, "guard_takes_momentum_x");
  CHECK_CLOSE(SetupSum(taken[1]), 1, 1e-9, "guard_takes_momentum_y");
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
    for (PetscInt d = 0; d < 2; d++) {
      const Guarded  *c = &cases[s.cloud->integer[INT_ID][a]];
      const PetscReal error =
        PetscMax(PetscAbsReal(x[DIM * a + d] - c->after[d]), PetscAbsReal(v[DIM * a + d] - c->after[2 + d]));

      if (error > 1e-9)
        printf("  case %d: %g %g, %g\n", (int)s.cloud->integer[INT_ID][a], x[DIM * a], x[DIM * a + 1], v[DIM * a + d]);
      worst = PetscMax(worst, error);
    }
  CHECK_CLOSE(SetupMax(worst), 0, 1e-9, "guard"); /* the normal of a solid is a difference of distances */
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- forces and sub-steps --- */

/* Sum of m v.(v* - v) of the fluid. */
static PetscReal Work(Cloud cloud)
{
  PetscReal sum = 0;

  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++)
    sum += cloud->volume[k / DIM] * cloud->rest_density[k / DIM] * cloud->field[FIELD_VELOCITY][k] *
           (cloud->field[FIELD_VELOCITY_STAR][k] - cloud->field[FIELD_VELOCITY][k]);
  return SetupSum(sum);
}

/* Viscosity and tension of Cahn and Hilliard do the work that the velocities change by, to first order. */
static PetscErrorCode TestWork(void)
{
  const PetscReal dt        = 1e-6;
  const char     *options[] = {BLOCK "-a_viscosity 20", QUIET "-a_tension 0.5 -tension_type cahn_hilliard"};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2; k++) {
    StepTrial trial = {0};
    Stepper   stepper;
    Setup     s;

    PetscCall(SetupPack(options[k], &s));
    PetscCall(MakeStepper(&s, &stepper));
    PetscCall(SetupMoments(&s));
    for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
      const PetscReal *x = s.cloud->field[FIELD_POSITION] + DIM * a;

      s.cloud->field[FIELD_VELOCITY][DIM * a]     = x[0] + x[0] * x[0];
      s.cloud->field[FIELD_VELOCITY][DIM * a + 1] = 2 * x[1] - x[1] * x[1];
    }
    PetscCall(CloudUpdate(s.cloud, FIELD_VELOCITY));
    PetscCall(StepForces(stepper, dt, s.cloud->rest_density, PETSC_FALSE, &trial));
    trial.sum[SUM_VISCOUS_WORK] = SetupSum(trial.sum[SUM_VISCOUS_WORK]);
    trial.sum[SUM_TENSION_WORK] = SetupSum(trial.sum[SUM_TENSION_WORK]);
    CHECK(PetscAbsReal(Work(s.cloud)) > 1e-9, "work: there is some");
    CHECK_CLOSE(trial.sum[k ? SUM_TENSION_WORK : SUM_VISCOUS_WORK] / Work(s.cloud), 1, 1e-6,
                k ? "work of tension" : "work of viscosity");
    CHECK_CLOSE(trial.sum[k ? SUM_VISCOUS_WORK : SUM_TENSION_WORK], 0, 0, "work of what is not there");
    PetscCall(StepperDestroy(&stepper));
    PetscCall(SetupClose(&s));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Implicit viscosity does the work that the velocities change by, without the kept share of the pressure, which
   StepKick takes out; a solver that gives up is told. */
static PetscErrorCode TestImplicit(PetscBool gives_up)
{
  StepTrial trial    = {0};
  PetscReal momentum = 0, size = 0;
  Stepper   stepper;
  Setup     s;

  PetscFunctionBegin;
  PetscCall(SetupPack(gives_up ? BLOCK "-a_viscosity 8000 -viscous_ksp_max_it 1" : BLOCK "-a_viscosity 8000", &s));
  PetscCall(MakeStepper(&s, &stepper));
  PetscCall(SetupMoments(&s));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    const PetscReal *x = s.cloud->field[FIELD_POSITION] + DIM * a;

    s.cloud->field[FIELD_VELOCITY][DIM * a]     = x[0] + x[0] * x[1];
    s.cloud->field[FIELD_VELOCITY][DIM * a + 1] = 2 * x[1] - x[1] * x[1];
  }
  PetscCall(CloudUpdate(s.cloud, FIELD_VELOCITY));
  for (PetscInt a = 0; a < s.cloud->n_total; a++)
    s.cloud->field[FIELD_PRESSURE][a] = 4e5 * s.cloud->field[FIELD_POSITION][DIM * a + 1];
  stepper->viscous.implicit      = PETSC_TRUE;
  stepper->bounds.viscosity_flow = 2.5e-4;
  PetscCall(StepForces(stepper, 1e-3, s.cloud->rest_density, PETSC_FALSE, &trial));
  CHECK_CLOSE(PressureKeptShare(stepper->pressure), 0.75, 1e-12,
              "implicit viscosity: share of the pressure that is kept");
  for (PetscInt k = 0; k < DIM * s.cloud->n_fluid; k++)
    s.cloud->field[FIELD_VELOCITY_STAR][k] -= stepper->viscous.kept_kick[k];
  if (gives_up)
    CHECK(trial.viscous.reason == KSP_DIVERGED_ITS && TrialFailed(&trial), "implicit viscosity: solver that gives up");
  else {
    CHECK(trial.viscous.reason > 0 && Work(s.cloud) != 0, "implicit viscosity: it works");
    for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
      momentum += s.cloud->field[FIELD_VELOCITY_STAR][DIM * a + 1] - s.cloud->field[FIELD_VELOCITY][DIM * a + 1];
      size += PetscAbsReal(s.cloud->field[FIELD_VELOCITY][DIM * a + 1]);
    }
    CHECK_CLOSE(SetupSum(momentum) / SetupSum(size), 0, 1e-6, "implicit viscosity: momentum, whatever the pressure is");
    CHECK_CLOSE(SetupSum(trial.sum[SUM_VISCOUS_WORK]) / Work(s.cloud), 1, 1e-9, "implicit viscosity: its work");
  }
  PetscCall(StepperDestroy(&stepper));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A disc of radius R that grows with v = x/2 at the start and 3 x/2 at the end of a step: length of the edge 2 pi R,
   inflow -2 pi R^2 dt, the integral of sigma kappa 2 pi sigma, the work -2 pi sigma R dt. */
static PetscErrorCode TestCapillaryWork(void)
{
  const PetscReal dt = 1e-3, sigma = 0.5, R = 1.6;
  StepTrial       trial = {0};
  PetscReal       sum[SUM_COUNT];
  Stepper         stepper;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(SetupPack("-dimension 2 -spacing 0.1 -box_lower -3,-3 -box_upper 3,3 -packing_jitter 0.1 -bodies a "
                      "-a_shape sphere -a_radius 1.6 -a_viscosity 0 -a_tension 0.5",
                      &s));
  PetscCall(MakeStepper(&s, &stepper));
  PetscCall(SetupMoments(&s));
  for (PetscInt k = 0; k < DIM * s.cloud->n_total; k++)
    s.cloud->field[FIELD_VELOCITY][k] = 0.5 * s.cloud->field[FIELD_POSITION][k];
  PetscCall(StepForces(stepper, dt, s.cloud->rest_density, PETSC_FALSE, &trial));
  for (PetscInt k = 0; k < DIM * s.cloud->n_fluid; k++)
    s.cloud->field[FIELD_VELOCITY_NEW][k] = 3 * s.cloud->field[FIELD_VELOCITY][k];
  PetscCall(StepTensionWork(stepper, dt, &trial));
  for (PetscInt k = 0; k < SUM_COUNT; k++) sum[k] = SetupSum(trial.sum[k]);
  CHECK_CLOSE(sum[SUM_SURFACES + 1] / (2 * PETSC_PI * R), 1, 0.08, "edge of a disc"); /* 2 V |n| stands for it */
  CHECK_CLOSE(sum[SUM_SURFACES] / (-2 * PETSC_PI * R * R * dt), 1, 0.1, "inflow of a disc that grows");
  CHECK_CLOSE(sum[SUM_SURFACES + 2] / (2 * PETSC_PI * sigma), 1, 0.1, "capillary pressure on its edge");
  CHECK_CLOSE(sum[SUM_TENSION_WORK] / (-2 * PETSC_PI * sigma * R * dt), 1, 0.12, "work of its tension");
  PetscCall(StepperDestroy(&stepper));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One particle in a box that is shaken: the force of the middle of the step acts. */
static PetscErrorCode TestShaken(void)
{
  const PetscReal x[DIM] = {1, 1, 0}, dt = 0.01;
  StepState       state = {.time = 0.05, .step = 1, .previous_time_step = dt};
  PetscReal       u     = -1;
  PetscBool       failed;
  char            why[512];
  ParticleArrays  arrays;
  Stepper         stepper;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(SetupFill("-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 4,4 -bodies a -a_viscosity 0 "
                      "-gravity_amplitude 3,0 -gravity_frequency 2 -gravity_phase 30 -time_step 0.01 -energy_max 0",
                      1, x, 0, &s));
  PetscCall(MakeStepper(&s, &stepper));
  PetscCall(StepperAdvance(stepper, 1, PETSC_FALSE, &state, &failed, why, sizeof(why)));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  if (arrays.n) u = arrays.real[FIELD_VELOCITY][0];
  PetscCall(ParticlesClose(s.particles, &arrays));
  CHECK_CLOSE(SetupMax(u), dt * 3 * PetscSinReal(2 * PETSC_PI * 2 * 0.055 + PETSC_PI / 6), 1e-12, "shaken particle");
  CHECK_CLOSE(state.time, 0.06, 1e-15, "shaken particle: time");
  PetscCall(StepperDestroy(&stepper));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In a step from 0 to 0.1 s the dummy particles of a solid are where it is at 0.05 s, with the velocity of 0.1 s: one
   that goes to and fro by 0.2 sin(2 pi 2 t), and turns with 3 rad/s about the middle of the box. */
static PetscErrorCode TestSolids(void)
{
  const PetscReal half = 0.2 * PetscSinReal(4 * PETSC_PI * 0.05), end = 0.2 * PetscSinReal(4 * PETSC_PI * 0.1),
                  speed = 0.2 * 4 * PETSC_PI * PetscCosReal(4 * PETSC_PI * 0.1);
  PetscReal error[2] = {0, 0}, count = 0, *before;
  Setup     s;
  Cloud     cloud;

  PetscFunctionBegin;
  PetscCall(SetupPack(QUIET "-solids s -s_lower 2.2,1.8 -s_upper 2.6,2.2 -s_oscillation_amplitude 0.2,0 "
                            "-s_oscillation_frequency 2 -s_rotation_rate 3 -s_rotation_center 2,2",
                      &s));
  cloud = s.cloud;
  PetscCall(PetscMalloc1(DIM * cloud->n_owned, &before));
  PetscCall(PetscArraycpy(before, cloud->field[FIELD_POSITION], DIM * cloud->n_owned));
  PetscCall(SolidsMove(cloud, 0, 0.05, 0.1));
  for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++) {
    const PetscReal x = before[DIM * a] - 2, y = before[DIM * a + 1] - 2, c = PetscCosReal(0.15),
                    i = PetscSinReal(0.15), due[2] = {2 + half + c * x - i * y, 2 + i * x + c * y},
                    later[2] = {PetscCosReal(0.3), PetscSinReal(0.3)},
                    v[2]     = {speed - 3 * (later[1] * x + later[0] * y), 3 * (later[0] * x - later[1] * y)};

    for (PetscInt d = 0; d < 2; d++) {
      error[0] = PetscMax(error[0], PetscAbsReal(cloud->field[FIELD_POSITION][DIM * a + d] - due[d]));
      error[1] = PetscMax(error[1], PetscAbsReal(cloud->field[FIELD_VELOCITY][DIM * a + d] - v[d]));
    }
    count++;
  }
  CHECK(SetupSum(count) > 10 && end > half, "a solid that moves");
  CHECK_CLOSE(SetupMax(error[0]), 0, 1e-12, "solids: where the liquid is, half way");
  CHECK_CLOSE(SetupMax(error[1]), 0, 1e-12, "solids: the velocity of the end");
  PetscCall(PetscFree(before));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A particle so fast that no step of its bound advances the time. */
static PetscErrorCode TestStalled(void)
{
  const PetscReal x[DIM]   = {1, 1, 0};
  StepState       state    = {.time = 1, .step = 1, .previous_time_step = 1e-3};
  PetscBool       failed   = PETSC_FALSE;
  char            why[512] = "";
  ParticleArrays  arrays;
  Stepper         stepper;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(
    SetupFill("-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 4,4 -bodies a -energy_max 0 -gravity 0,-9.81", 1, x,
              0, &s));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  if (arrays.n) arrays.real[FIELD_VELOCITY][0] = 1e15;
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(MakeStepper(&s, &stepper));
  PetscCall(StepperAdvance(stepper, 2, PETSC_FALSE, &state, &failed, why, sizeof(why)));
  CHECK(failed && strstr(why, "does not advance the time"), "stalled");
  CHECK_CLOSE(state.time, 1, 0, "stalled: time");
  PetscCall(StepperDestroy(&stepper));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A linear pressure accelerates by -grad p/rho, a step moves by the mean of both velocities, a position that is not a
   number is found. */
static PetscErrorCode TestSubsteps(void)
{
  const PetscReal dt    = 1e-3;
  StepTrial       trial = {0};
  PetscReal       kick = 0, drift = 0, *from;
  Stepper         stepper;
  Setup           s;
  Cloud           cloud;

  PetscFunctionBegin;
  PetscCall(SetupPack(QUIET "-a_velocity 1,0 -pressure_gradient corrected -pressure_regularization 0", &s));
  PetscCall(MakeStepper(&s, &stepper));
  PetscCall(SetupMoments(&s));
  cloud = s.cloud;
  PetscCall(PetscMalloc1(DIM * cloud->n_owned, &from));
  PetscCall(PetscArraycpy(from, cloud->field[FIELD_POSITION], DIM * cloud->n_owned));
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    cloud->field[FIELD_PRESSURE][a]                = 400 * cloud->field[FIELD_POSITION][DIM * a + 1];
    cloud->field[FIELD_VELOCITY_STAR][DIM * a]     = 3;
    cloud->field[FIELD_VELOCITY_STAR][DIM * a + 1] = 2;
    cloud->field[FIELD_VELOCITY_STAR][DIM * a + 2] = 0;
    cloud->field[FIELD_VELOCITY][DIM * a]          = 1;
    cloud->integer[INT_SURFACE][a]                 = 0;
  }
  PetscCall(StepKick(stepper, dt, &trial));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *v = cloud->field[FIELD_VELOCITY_NEW] + DIM * a;

    if (cloud->field[FIELD_LAMBDA][a] > MOMENT_MINIMUM)
      kick = PetscMax(kick, PetscMax(PetscAbsReal(v[0] - 3), PetscAbsReal(v[1] - 2 + dt * 400 / RHO)));
  }
  CHECK_CLOSE(SetupMax(kick), 0, 1e-12, "kick by a linear pressure");
  for (PetscInt half = 0; half < 2; half++) {
    PetscCall(StepDriftOn(stepper, dt, from, (PetscBool)half));
    for (PetscInt a = 0; a < cloud->n_fluid; a++) {
      const PetscReal moved = cloud->field[FIELD_POSITION_NEW][DIM * a] - from[DIM * a];

      drift = PetscMax(drift, PetscAbsReal(moved - 0.5 * dt * (cloud->field[FIELD_VELOCITY_NEW][DIM * a] + 1 - half)));
    }
  }
  CHECK_CLOSE(SetupMax(drift), 0, 1e-15, "drift with the mean velocity");
  PetscCall(StepGuard(stepper, dt, from, &trial));
  CHECK(SetupMax(trial.largest[LARGEST_BROKEN]) == 0 && SetupMax(trial.largest[LARGEST_DISPLACEMENT]) > 1e-3,
        "all positions are numbers");
  if (cloud->n_fluid) cloud->field[FIELD_POSITION_NEW][1] = NAN;
  PetscCall(StepGuard(stepper, dt, from, &trial));
  CHECK(SetupMax(trial.largest[LARGEST_BROKEN]) == 1, "a position that is not a number");
  PetscCall(PetscFree(from));
  PetscCall(StepperDestroy(&stepper));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(LogRegister());
  PetscCall(UserErrorHandlerPush());
  PetscCall(TestStep());
  PetscCall(TestScales());
  PetscCall(TestDensities());
  PetscCall(TestRefused());
  PetscCall(TestSums());
  PetscCall(TestGuard(1));
  PetscCall(TestGuard(2));
  PetscCall(TestWork());
  PetscCall(TestImplicit(PETSC_FALSE));
  PetscCall(TestImplicit(PETSC_TRUE));
  PetscCall(TestCapillaryWork());
  PetscCall(TestShaken());
  PetscCall(TestSolids());
  PetscCall(TestStalled());
  PetscCall(TestSubsteps());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
