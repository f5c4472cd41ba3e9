/* Conduction between particles: Fourier's series in a strip, what two liquids exchange, and that heat stays, in the
   plane and as rings. Runs on any number of ranks. */
#include "../../src/heat/heat_impl.h"
#include "../../src/stepper/edge.h"
#include "check.h"
#include "setup.h"

extern const Edge HeatEdge;

#define TERMS 200
/* a strip of 50 spacings, cold on the left; its diffusivity is 1e-5 m2/s, kernels end at its insulated ends */
#define STRIP                                                                                                          \
  "-packing_jitter 0 -dimension 2 -spacing 0.2e-3 -box_lower 0,0 -box_upper 10e-3,2e-3 -box_x wall -box_y periodic "   \
  "-bodies cold,hot "                                                                                                  \
  "-cold_upper 5e-3,2e-3 -hot_lower 5e-3,0 -cold_temperature 300 -hot_temperature 350 "                                \
  "-cold_thermal_conductivity 41.84 -hot_thermal_conductivity 41.84 "
/* a slab of 8 spacings with free surfaces, whose temperature differs by as much */
#define SLAB                                                                                                           \
  "-packing_jitter 0 -dimension 2 -spacing 0.2e-3 -box_lower 0,0 -box_upper 1.6e-3,2e-3 -box_y periodic -bodies "      \
  "cold,hot -cold_upper 0.8e-3,2e-3 -hot_lower 0.8e-3,0 -cold_temperature 300 -hot_temperature 350 "                   \
  "-cold_thermal_conductivity 41.84 -hot_thermal_conductivity 41.84 "
#define CUP                                                                                                            \
  "-dimension axisymmetric -spacing 0.5e-3 -box_lower 0,0 -box_upper 5e-3,5e-3 -box_ymin wall -bodies tea,milk "       \
  "-tea_upper 5e-3,2.5e-3 -milk_lower 0,2.5e-3 -tea_temperature 360 -milk_temperature 280 -milk_heat_capacity 3900 "   \
  "-tea_thermal_conductivity 0.6 -milk_thermal_conductivity 0.5 -milk_density 1030 "
/* a pool of 20 by 10 spacings at 300 K */
#define POOL                                                                                                           \
  "-packing_jitter 0 -dimension 2 -spacing 0.2e-3 -box_lower 0,0 -box_upper 4e-3,2e-3 -box_x wall -bodies water "      \
  "-water_upper 4e-3,2e-3 -water_temperature 300 -water_thermal_conductivity 0.6 "

/* Of the fluid: the sum of m c T (J), and the largest difference to Fourier's series at a time (s) with -box_x wall. */
static void Measure(Setup *s, PetscReal time, PetscReal *heat, PetscReal *error)
{
  const Cloud     cloud = s->cloud;
  const PetscReal L     = cloud->domain->upper[0];

  *heat = *error = 0;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal x = cloud->field[FIELD_POSITION][DIM * a], T = cloud->field[FIELD_TEMPERATURE][a];
    PetscReal       exact = 325;

    for (PetscInt n = 1; n < TERMS; n++) {
      const PetscReal k = n * PETSC_PI / L;

      exact -= 100 / (n * PETSC_PI) * PetscSinReal(0.5 * n * PETSC_PI) * PetscCosReal(k * x) *
               PetscExpReal(-1e-5 * k * k * time);
    }
    *error = PetscMax(*error, PetscAbsReal(T - exact));
    *heat += ScalarStore(cloud, HEAT_TEMPERATURE, a) * T;
  }
  *heat  = SetupSum(*heat);
  *error = SetupMax(*error);
}

/* gained: what each receiver has given in all steps, of this rank, J. */
static PetscErrorCode Conduct(const char options[], PetscReal dt, PetscInt steps, Setup *s, PetscReal heat[2],
                              PetscReal *error, PetscReal gained[RECEIVERS])
{
  HeatSpread spread = {.pair = NULL};
  PetscReal  more[RECEIVERS];

  PetscFunctionBegin;
  PetscCall(SetupPack(options, s));
  PetscCall(SetupMoments(s));
  Measure(s, 0, &heat[0], error);
  PetscCall(SpreadFind(&spread, s->cloud, HEAT_TEMPERATURE));
  PetscCall(PetscArrayzero(gained, RECEIVERS));
  for (PetscInt k = 0; k < steps; k++) {
    PetscCall(SpreadStep(&spread, s->cloud, HEAT_TEMPERATURE, dt, more));
    for (PetscInt r = 0; r < RECEIVERS; r++) gained[r] += more[r];
  }
  Measure(s, steps * dt, &heat[1], error);
  PetscCall(SpreadFree(&spread));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestStrip(void)
{
  Setup     s;
  PetscReal heat[2], error, low = PETSC_MAX_REAL, high = 0, gained[RECEIVERS];
  PetscInt  right = 0;

  PetscFunctionBegin;
  PetscCall(SetupPack(STRIP, &s));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    const PetscReal T = s.cloud->field[FIELD_TEMPERATURE][a];

    right += T == (s.cloud->field[FIELD_POSITION][DIM * a] < 5e-3 ? 300 : 350);
    low  = PetscMin(low, T);
    high = PetscMax(high, T);
  }
  CHECK(right == s.cloud->n_fluid, "a body's temperature at the start");
  CHECK(-SetupMax(-low) == 300 && SetupMax(high) == 350, "both are there");
  PetscCall(SetupClose(&s));
  PetscCall(Conduct(STRIP, 5e-4, 200, &s, heat, &error, gained));
  CHECK_CLOSE(error / 50, 0, 1e-3, "step in a strip, of the step");
  CHECK_CLOSE(heat[1] / heat[0], 1, 1e-12, "heat of the strip stays");
  PetscCall(SetupClose(&s));
  PetscCall(Conduct(STRIP, 2.5e-3, 40, &s, heat, &error, gained));
  CHECK_CLOSE(error / 50, 0, 1e-3, "the same in steps of many times the explicit limit");
  CHECK_CLOSE(heat[1] / heat[0], 1, 1e-12, "heat of the strip stays in them");
  PetscCall(SetupClose(&s));
  PetscCall(Conduct(SLAB, 1e-4, 150, &s, heat, &error, gained));
  CHECK_CLOSE(error / 50, 0, 7.5e-3, "step in a slab of 8 spacings");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The longest step is that of what conducts best, in whatever order the bodies are. */
static PetscErrorCode TestBound(void)
{
  const char *const order[] = {"-cold_thermal_conductivity 4.184 ", "-hot_thermal_conductivity 4.184 "};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2; k++) {
    StepBound bound = {.step = 1};
    char      options[1024];
    Setup     s;

    PetscCall(PetscSNPrintf(options, sizeof(options), STRIP "%s", order[k]));
    PetscCall(SetupPack(options, &s));
    HeatEdge.bound(&(Step){.cloud = s.cloud, .scene = s.scene}, 1, &bound);
    CHECK_CLOSE(bound.step / (0.5 * PetscSqr(KernelSmoothingLength(s.kernel)) / 1e-5), 1, 1e-9, "longest step");
    PetscCall(SetupClose(&s));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In the end both have the temperature of their mixture, which the gauge tells all the time. */
static PetscErrorCode TestCup(void)
{
  Setup     s;
  Gauges    gauges;
  PetscReal heat[2], error, all = 0, mixed, most = 0, told[3], gained[RECEIVERS];

  PetscFunctionBegin;
  PetscCall(Conduct(CUP, 0.5, 800, &s, heat, &error, gained));
  CHECK_CLOSE(heat[1] / heat[0], 1, 1e-12, "heat of two liquids as rings stays");
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) all += ScalarStore(s.cloud, HEAT_TEMPERATURE, a);
  mixed = heat[0] / SetupSum(all);
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
    most = PetscMax(most, PetscAbsReal(s.cloud->field[FIELD_TEMPERATURE][a] - mixed));
  CHECK_CLOSE(SetupMax(most), 0, 1e-2, "one temperature in the end");
  PetscCall(SetupClose(&s));
  PetscCall(Conduct(CUP, 0.1, 0, &s, heat, &error, gained));
  PetscCall(GaugesCreate(s.cloud, &gauges));
  PetscCall(GaugeScalars.measure(gauges, NULL, told));
  CHECK_CLOSE(told[1], mixed, 1e-6, "mean temperature is that of the mixture");
  CHECK(told[0] == 280 && told[2] == 360, "extremes of the temperature");
  PetscCall(GaugesDestroy(&gauges));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Between walls of two temperatures the heat that comes and goes is k dT/L; a flux gives what it says; the air takes
   h (T - T_air) from each part of the surface. Quantities a metre. */
static PetscErrorCode TestSides(void)
{
  Setup     s;
  PetscReal heat[2], error, gained[RECEIVERS], most = 0;

  PetscFunctionBegin;
  PetscCall(
    Conduct(POOL "-box_y wall -box_xmin_temperature 310 -box_xmax_temperature 290", 50, 20, &s, heat, &error, gained));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
    most = PetscMax(most, PetscAbsReal(s.cloud->field[FIELD_TEMPERATURE][a] -
                                       (310 - 20 * s.cloud->field[FIELD_POSITION][DIM * a] / 4e-3)));
  CHECK_CLOSE(SetupMax(most), 0, 2e-2, "straight line between two temperatures, K of 20");
  PetscCall(SetupClose(&s));
  PetscCall(Conduct(POOL "-box_y wall -box_xmin_temperature 310", 0.1, 1, &s, heat, &error, gained));
  CHECK_CLOSE((heat[1] - heat[0]) / SetupSum(gained[0]), 1, 1e-8, "what a wall gave");
  PetscCall(SetupClose(&s));
  PetscCall(Conduct(POOL "-box_y wall -box_ymin_heat_flux 500", 0.5, 2, &s, heat, &error, gained));
  CHECK_CLOSE(SetupSum(gained[2]) / (500 * 4e-3), 1, 5e-3, "a flux for a second");
  CHECK_CLOSE((heat[1] - heat[0]) / (500 * 4e-3), 1, 5e-3, "heats the liquid");
  PetscCall(SetupClose(&s));
  PetscCall(Conduct(POOL "-box_y wall -box_ymin_heat_flux 500 -water_thermal_conductivity 0", 0.5, 2, &s, heat, &error,
                    gained));
  CHECK_CLOSE((heat[1] - heat[0]) / (500 * 4e-3), 1, 5e-3, "and a liquid that does not conduct");
  PetscCall(SetupClose(&s));
  PetscCall(Conduct(POOL "-box_ymin wall -box_ymax open -surface_heat_transfer 20 -ambient_temperature 290", 0.5, 2, &s,
                    heat, &error, gained));
  CHECK_CLOSE(SetupSum(gained[OF_AIR]) / (-20 * 10 * 4e-3), 1, 2e-2, "the air takes heat");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A ball gives the air heat by all of its surface. */
static PetscErrorCode TestBall(void)
{
  HeatSpread spread = {.pair = NULL};
  Setup      s;
  PetscReal  flow[RECEIVERS];

  PetscFunctionBegin;
  PetscCall(SetupPack(
    "-packing_jitter 0 -dimension axisymmetric -spacing 0.1 -box_lower 0,-1.4 -box_upper 1.4,1.4 -bodies ball "
    "-ball_shape sphere -ball_radius 1 -ball_temperature 301 "
    "-surface_heat_transfer 1 -ambient_temperature 300 ",
    &s));
  PetscCall(SetupMoments(&s));
  PetscCall(SpreadFind(&spread, s.cloud, HEAT_TEMPERATURE));
  SpreadFlows(&spread, s.cloud->field[FIELD_TEMPERATURE], flow);
  CHECK_CLOSE(SetupSum(flow[OF_AIR]) / (-4 * PETSC_PI), 1, 2e-2, "heat of a ball of 10 spacings to the air");
  PetscCall(SpreadFree(&spread));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(TestStrip());
  PetscCall(TestBound());
  PetscCall(TestCup());
  PetscCall(TestSides());
  PetscCall(TestBall());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
