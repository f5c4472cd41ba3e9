/* Two liquids that do not mix: bodies that overlap fill the lattice, the jump at a circle, the parts of three tensions,
   and that a pressure which balances the jumps pushes nothing, next to walls and at a free surface too. Lengths in
   spacings. Runs on any number of ranks. */
#include "../../src/interface/interface_impl.h"
#include "../../src/stepper/edge.h"
#include "setup.h"
#include "check.h"

#define BOX                                                                                                            \
  "-dimension 2 -spacing 1 -packing_jitter 0 -bodies a,b -bodies_overlap -a_shape sphere -a_center 0,0 -a_radius 8 "   \
  "-b_shape box -b_density 700 -interface_tension 3 "
#define FULL BOX "-box_lower -14,-14 -box_upper 14,14 -box_x periodic -box_y periodic "
/* The circle of a is cut by walls. */
#define WALLS BOX "-box_lower -14,-4 -box_upper 14,14 -box_x wall -box_y wall "
/* Both have a free surface. */
#define OPEN                                                                                                           \
  BOX "-box_lower -14,0 -box_upper 14,14 -box_x symmetry -box_ymin symmetry -a_center 0,3 -b_upper 14,8 "              \
      "-a_tension 2 -b_tension 4 "
#define DT 1e-3

static PetscErrorCode Open(const char options[], Setup *s)
{
  PetscFunctionBegin;
  PetscCall(SetupPack(options, s));
  PetscCall(SetupMoments(s));
  PetscCall(PetscArrayzero(s->cloud->field[FIELD_VELOCITY_STAR], DIM * s->cloud->n_owned));
  PetscCall(SetupDivergence(s));
  TensionSetSurfaces(s->tension, InterfaceApply);
  PetscCall(TensionApply(s->tension, s->cloud));
  PetscCall(PressureCreate(s->cloud, &s->pressure));
  PetscCall(PressureSetTypes(s->pressure, SOURCE_DIVERGENCE, CLOSURE_FULL, GRADIENT_CORRECTED, PETSC_FALSE));
  PetscCall(PressureSetFromOptions(s->pressure));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All points of the lattice are taken, and those far inside have the jump of the curvature. */
static PetscErrorCode TestCircle(void)
{
  PetscReal sum[3] = {0, 0, 0}, count[3] = {0, 0, 0}, jump;
  Setup     s;

  PetscFunctionBegin;
  PetscCall(Open(FULL, &s));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    const PetscInt  l = s.cloud->liquid[a];
    const PetscReal r = Norm(s.cloud->field[FIELD_POSITION] + DIM * a);

    count[2]++;
    if (PetscAbsReal(r - 8) > 1) continue;
    sum[l] += s.cloud->pressure_jump[a];
    count[l]++;
  }
  for (PetscInt k = 0; k < 3; k++) {
    sum[k]   = SetupSum(sum[k]);
    count[k] = SetupSum(count[k]);
  }
  jump = sum[0] / count[0] - sum[1] / count[1];
  CHECK_CLOSE(count[2], 28 * 28, 0, "overlapping_bodies_fill_the_lattice");
  CHECK_CLOSE(jump / (3. / 8), 1, 0.03, "jump_is_tension_over_radius");
  CHECK_CLOSE(sum[0] / count[0] / jump, 0.5, 0.05, "both_sides_have_half_of_it");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

extern const Edge InterfaceEdge;

/* The edge: the energy of a circle of tension 3 and radius 8, and its sums for the surface of each liquid while the
   circle grows. */
static PetscErrorCode TestEnergy(void)
{
  StepTrial  trial = {.diagnose = PETSC_FALSE};
  PetscReal *mean, *sum = trial.sum;
  Step       step;
  Stepper    stepper;
  Setup      s;

  PetscFunctionBegin;
  PetscCall(Open(FULL, &s));
  PetscCall(StepperCreate(s.cloud, s.tension, s.pressure, &stepper));
  step = (Step){stepper, s.scene, s.cloud, s.tension, s.pressure, .trial = &trial, .dt = 0.1};
  PetscCall(InterfaceEdge.diagnose(&step));
  PetscCall(CloudGetWork(s.cloud, DIM, &mean));
  for (PetscInt k = 0; k < DIM * s.cloud->n_fluid; k++) mean[k] = s.cloud->field[FIELD_POSITION][k];
  PetscCall(InterfaceEdge.work(&step, mean));
  PetscCall(CloudRestoreWork(s.cloud, &mean));
  CHECK_CLOSE(SetupSum(sum[SUM_SURFACE_ENERGY]) / (3 * 2 * PETSC_PI * 8), 1, 0.1, "energy_of_an_interface");
  for (PetscInt k = SUM_SURFACES + SURFACE_SUMS; k <= SUM_SURFACES_LAST; k += SURFACE_SUMS) {
    CHECK_CLOSE(SetupSum(sum[k]) / (0.1 * 2 * PETSC_PI * 8 * 8), k > SUM_SURFACES + SURFACE_SUMS ? 1 : -1, 0.15,
                "flow_into_each_side_of_a_circle_that_grows");
    CHECK_CLOSE(SetupSum(sum[k + 1]) / (2 * PETSC_PI * 8), 1, 0.1, "each_side_of_an_interface_has_its_area");
  }
  CHECK_CLOSE(SetupSum(sum[SUM_SURFACES + 1]), 0, 0, "an_interface_is_no_free_surface");
  PetscCall(StepperDestroy(&stepper));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Jumps of one size everywhere, a gas pressure of 2, and the pressure that balances them. */
static PetscErrorCode TestBalance(const char options[], const char name[])
{
  const PetscReal part[2]  = {5, -3};
  PetscReal       worst[2] = {0, 0}, scale = 0, *sum, *contribution, *acceleration;
  char            label[64];
  Setup           s;
  Cloud           cloud;

  PetscFunctionBegin;
  PetscCall(Open(options, &s));
  cloud = s.cloud;
  for (PetscInt a = 0; a < cloud->n_total; a++)
    cloud->pressure_jump[a] = cloud->liquid[a] < 0 ? 0 : part[cloud->liquid[a]];
  PetscCall(PetscArrayzero(cloud->pressure_jump_slope, DIM * cloud->n_total));
  PetscCall(PetscArrayzero(cloud->field[FIELD_CAPILLARY_SLOPE], DIM * cloud->n_owned));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) cloud->field[FIELD_CAPILLARY][a] = 2 + cloud->pressure_jump[a];
  PetscCall(PressureSetUp(s.pressure, DT));
  for (PetscInt a = 0; a < cloud->n_owned; a++)
    cloud->field[FIELD_PRESSURE][a] = 2 + (cloud->liquid[a] < 0 ? 0 : part[cloud->liquid[a]]);
  PetscCall(CloudUpdate(cloud, FIELD_PRESSURE));
  PetscCall(PetscMalloc3(cloud->n_rows, &sum, cloud->n_rows, &contribution, DIM * cloud->n_fluid, &acceleration));
  PetscCall(PressureMultiply(s.pressure, cloud->field[FIELD_PRESSURE], sum));
  PetscCall(PressureCapillary(s.pressure, contribution));
  for (PetscInt r = 0; r < cloud->n_rows; r++) {
    worst[0] = PetscMax(worst[0], PetscAbsReal(sum[r] - contribution[r]));
    scale    = PetscMax(scale, PetscAbsReal(contribution[r]));
  }
  PetscCall(PressureAcceleration(s.pressure, acceleration));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) worst[1] = PetscMax(worst[1], Norm(acceleration + DIM * a));
  PetscCall(PetscSNPrintf(label, sizeof(label), "%s_equation_is_balanced", name));
  CHECK_CLOSE(SetupMax(worst[0]) / SetupMax(scale), 0, 1e-12, label);
  PetscCall(PetscSNPrintf(label, sizeof(label), "%s_gradient_is_balanced", name));
  CHECK_CLOSE(SetupMax(worst[1]) / (8. / 700), 0, 1e-12, label);
  PetscCall(PetscFree3(sum, contribution, acceleration));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Parts of a fifth and five fifths of the larger one: all particles that meet the other liquid have the jump of their
   own, also those too deep for a normal, and what gas has no part in is the same at its surface, slopes too. */
static PetscErrorCode TestUnequal(void)
{
  const PetscReal due[2]   = {0.5 / 8, -2.5 / 8};
  PetscReal       wrong[2] = {0, 0}, sum[2] = {0, 0}, count[2] = {0, 0}, slope = 0, differs = 0;
  Setup           s;
  Cloud           cloud;
  char            label[64];

  PetscFunctionBegin;
  PetscCall(Open(FULL "-a_tension 1 -b_tension 3 ", &s));
  cloud = s.cloud;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscInt l = cloud->liquid[a];

    if (!cloud->at_interface[a]) continue;
    count[l]++;
    sum[l] += cloud->pressure_jump[a] / due[l];
    wrong[l] += cloud->pressure_jump[a] / due[l] <= 0;
  }
  for (PetscInt l = 0; l < 2; l++) {
    PetscCall(PetscSNPrintf(label, sizeof(label), "part_%" PetscInt_FMT "_of_unequal_liquids", l));
    CHECK_CLOSE(SetupSum(sum[l]) / SetupSum(count[l]), 1, 0.03, label);
    PetscCall(PetscSNPrintf(label, sizeof(label), "sign_of_part_%" PetscInt_FMT "_of_each_particle", l));
    CHECK_CLOSE(SetupSum(wrong[l]), 0, 0, label);
  }
  PetscCall(SetupClose(&s));
  PetscCall(Open(OPEN "-a_tension 1 -b_tension 2 ", &s)); /* 1 + 2 N/m: nothing is left for gas */
  cloud = s.cloud;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    differs = PetscMax(differs, PetscAbsReal(cloud->field[FIELD_CAPILLARY][a] - cloud->pressure_jump[a]));
    for (PetscInt d = 0; d < DIM; d++) {
      const PetscReal own = cloud->pressure_jump_slope[DIM * a + d];

      slope   = PetscMax(slope, PetscAbsReal(own));
      differs = PetscMax(differs, PetscAbsReal(cloud->field[FIELD_CAPILLARY_SLOPE][DIM * a + d] - own));
    }
  }
  CHECK(SetupMax(slope) > 1e-3, "the_jump_has_slopes");
  CHECK_CLOSE(SetupMax(differs), 0, 1e-12, "gas_without_a_part");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An ellipse, 12 by 8: its curvature, and its slope along the edge, in closed form. With t the angle of the point 12
   cos t, 8 sin t and g^2 = 144 sin^2 t + 64 cos^2 t, the curvature is 96/g^3, so its slope is -3 96 (144 - 64) sin t
   cos t/g^6 over the length along the tangent (-12 sin t, 8 cos t)/g. */
static PetscErrorCode TestEllipse(void)
{
  PetscReal sum[4] = {0, 0, 0, 0};
  Setup     s;
  Cloud     cloud;

  PetscFunctionBegin;
  PetscCall(
    Open("-dimension 2 -spacing 1 -packing_jitter 0 -bodies a,b -bodies_overlap -a_shape ellipsoid -a_center 0,0 "
         "-a_radii 12,8 -b_shape box -interface_tension 3 -box_lower -18,-14 -box_upper 18,14 -box_x periodic "
         "-box_y periodic ",
         &s));
  cloud = s.cloud;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, *slope = cloud->pressure_jump_slope + DIM * a,
                    t = atan2(x[1] / 8, x[0] / 12), c = PetscCosReal(t), i = PetscSinReal(t),
                    g = PetscSqrtReal(144 * i * i + 64 * c * c), part = cloud->liquid[a] ? -1.5 : 1.5,
                    due = -part * 3 * 96 * 80 * i * c / PetscPowReal(g, 6), curved = part * 96 / (g * g * g);

    if (!cloud->at_interface[a] || cloud->pressure_jump[a] == 0) continue;
    sum[0] += due * due;
    sum[1] += due * (-12 * i * slope[0] + 8 * c * slope[1]) / g;
    sum[2] += curved * curved;
    sum[3] += curved * cloud->pressure_jump[a];
  }
  CHECK_CLOSE(SetupSum(sum[3]) / SetupSum(sum[2]), 1, 0.03, "jump_of_an_ellipse");
  CHECK_CLOSE(SetupSum(sum[1]) / SetupSum(sum[0]), 1, 0.05, "slope_of_the_jump_of_an_ellipse");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Jumps that are linear in space, c + g x, other ones for both liquids, and the pressure that they balance in each: its
   gradient is g at each particle, and in the equation a pair of both liquids sees the jump in its middle. The weights
   of the pairs are those of the operator. */
static PetscErrorCode TestSlopes(void)
{
  const PetscReal part[2] = {5, -3}, g[2][DIM] = {{0.3, -0.1, 0}, {-0.2, 0.5, 0}};
  PetscReal      *p, *row[DIM + 1], *both, *none, *acceleration, worst[3] = {0, 0, 0}, scale = 0;
  Setup           s;
  Cloud           cloud;

  PetscFunctionBegin;
  PetscCall(Open(FULL, &s));
  cloud = s.cloud;
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    const PetscInt l = cloud->liquid[a];

    cloud->pressure_jump[a] = part[l] + Dot(g[l], cloud->field[FIELD_POSITION] + DIM * a);
    for (PetscInt d = 0; d < DIM; d++) cloud->pressure_jump_slope[DIM * a + d] = g[l][d];
  }
  PetscCall(PetscArrayzero(cloud->field[FIELD_CAPILLARY], cloud->n_owned));
  PetscCall(PetscArrayzero(cloud->field[FIELD_CAPILLARY_SLOPE], DIM * cloud->n_owned));
  PetscCall(PressureSetUp(s.pressure, DT));
  PetscCall(
    PetscMalloc4(cloud->n_rows, &p, cloud->n_rows, &both, cloud->n_rows, &none, DIM * cloud->n_fluid, &acceleration));
  PetscCall(PressureCapillary(s.pressure, both));
  for (PetscInt a = 0; a < cloud->n_owned; a++) cloud->field[FIELD_PRESSURE][a] = cloud->pressure_jump[a];
  PetscCall(CloudUpdate(cloud, FIELD_PRESSURE));
  PetscCall(PressureAcceleration(s.pressure, acceleration));
  PetscCall(PetscArrayzero(cloud->pressure_jump_slope, DIM * cloud->n_total));
  PetscCall(PressureCapillary(s.pressure, none));
  for (PetscInt k = 0; k <= DIM; k++) PetscCall(PetscMalloc1(cloud->n_rows, &row[k]));
  for (PetscInt l = 0; l < 2; l++) {
    for (PetscInt k = 0; k <= DIM; k++) { /* the sums of K_ab and of K_ab x_b over the other liquid, with a minus */
      for (PetscInt b = 0; b < cloud->n_rows; b++)
        p[b] = cloud->liquid[b] == l ? 0 : k == DIM ? 1 : cloud->field[FIELD_POSITION][DIM * b + k];
      PetscCall(PressureMultiply(s.pressure, p, row[k]));
    }
    for (PetscInt a = 0; a < cloud->n_fluid; a++) {
      const PetscReal *x   = cloud->field[FIELD_POSITION] + DIM * a;
      PetscReal        due = 0, off[DIM];

      if (cloud->liquid[a] != l || Norm(x) > 10) continue; /* beyond, the pressure jumps at the periodic faces */
      for (PetscInt d = 0; d < DIM; d++) {
        due -= 0.5 * (g[0][d] + g[1][d]) * (row[d][a] - x[d] * row[DIM][a]);
        off[d] = acceleration[DIM * a + d] * cloud->rest_density[a] + g[l][d];
      }
      worst[0] = PetscMax(worst[0], PetscAbsReal(both[a] - none[a] - due));
      scale    = PetscMax(scale, PetscAbsReal(due));
      worst[1] = PetscMax(worst[1], Norm(off));
    }
  }
  CHECK_CLOSE(SetupMax(worst[0]) / SetupMax(scale), 0, 1e-6, "slopes_in_the_equation");
  CHECK_CLOSE(SetupMax(worst[1]), 0, 1e-6, "slopes_in_the_gradient");
  for (PetscInt k = 0; k <= DIM; k++) PetscCall(PetscFree(row[k]));
  PetscCall(PetscFree4(p, both, none, acceleration));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Wall particles are of the liquid in front of them, and have its jump and slope. */
static PetscErrorCode TestWalls(void)
{
  const PetscReal part[2] = {5, -3}, g[2] = {0.3, -0.2};
  PetscReal       wrong = 0, jumps = 0, known[2] = {0, 0};
  Setup           s;
  Cloud           cloud;

  PetscFunctionBegin;
  PetscCall(Open(WALLS, &s));
  cloud = s.cloud;
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    const PetscInt l = cloud->liquid[a];

    cloud->pressure_jump[a]                 = l < 0 ? 0 : part[l];
    cloud->pressure_jump_slope[DIM * a]     = l < 0 ? 0 : g[l];
    cloud->pressure_jump_slope[DIM * a + 1] = cloud->pressure_jump_slope[DIM * a + 2] = 0;
  }
  PetscCall(PressureSetUp(s.pressure, DT));
  for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++) {
    const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a;
    const PetscInt   l = PetscAbsReal(x[0]) < PetscSqrtReal(64 - 16) && x[1] < 0 ? 0 : 1;

    if (x[1] < 0 && PetscAbsReal(PetscAbsReal(x[0]) - PetscSqrtReal(64 - 16)) < 2) continue; /* where both are near */
    known[l]++;
    wrong += cloud->liquid[a] != l;
    jumps = PetscMax(jumps, PetscAbsReal(cloud->pressure_jump[a] - part[l]) +
                              PetscAbsReal(cloud->pressure_jump_slope[DIM * a] - g[l]));
  }
  CHECK(SetupSum(known[0]) > 10 && SetupSum(known[1]) > 50, "walls_of_both_liquids");
  CHECK_CLOSE(SetupSum(wrong), 0, 0, "the_liquid_of_a_wall");
  CHECK_CLOSE(SetupMax(jumps), 0, 1e-12, "jump_and_slope_of_a_wall");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestParts(void)
{
  PetscReal part[3];
  Setup     s;

  PetscFunctionBegin;
  PetscCall(SetupOpen(OPEN, &s));
  SceneTensions(s.scene, part);
  CHECK_CLOSE(part[0] + part[1], 3, 1e-14, "tension_of_the_interface");
  CHECK_CLOSE(part[0] + part[2], 2, 1e-14, "tension_of_the_first_liquid");
  CHECK_CLOSE(part[1] + part[2], 4, 1e-14, "tension_of_the_second_liquid");
  CHECK_CLOSE(SceneInterfaceDensity(s.scene), 1000 + 700, 0, "both_densities_make_capillary_waves");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Two liquids of 1 and 3 N/m side by side under one level surface, which is pulled along itself by their difference, in
   the mean of some packings, by particles on the surface only: displaced ones inside have no share. */
static PetscErrorCode TestMarangoni(PetscReal jitter, PetscInt packings, PetscReal tolerance)
{
  PetscReal pull = 0, across = 0, deep = 0;

  PetscFunctionBegin;
  for (PetscInt seed = 1; seed <= packings; seed++) {
    char  options[512];
    Setup s;

    PetscCall(PetscSNPrintf(options, sizeof(options), "%s-packing_jitter %g -packing_seed %d ",
                            "-dimension 2 -spacing 1 -box_lower -14,0 -box_upper 14,14 -box_x symmetry "
                            "-box_ymin symmetry -bodies a,b -a_lower -14,0 -a_upper 0,8 -b_lower 0,0 -b_upper 14,8 "
                            "-b_density 700 -a_tension 1 -b_tension 3 ",
                            (double)jitter, (int)seed));
    PetscCall(SetupPack(options, &s));
    PetscCall(SetupMoments(&s));
    PetscCall(PetscArrayzero(s.cloud->field[FIELD_ACCELERATION], DIM * s.cloud->n_fluid));
    PetscCall(TensionApply(s.tension, s.cloud));
    for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
      const PetscReal *force = s.cloud->field[FIELD_ACCELERATION] + DIM * a,
                      mass   = s.cloud->volume[a] * s.cloud->rest_density[a];

      pull += mass * force[0] / packings;
      across += PetscSqr(mass * force[1]) / packings;
      if (s.cloud->field[FIELD_POSITION][DIM * a + 1] < 5) deep = PetscMax(deep, mass * Norm(force));
    }
    PetscCall(SetupClose(&s));
  }
  CHECK_CLOSE(SetupSum(pull), 2, tolerance, "pull_towards_the_larger_tension");
  CHECK_CLOSE(PetscSqrtReal(SetupSum(across)), 0, 0.2 * jitter, "pull_is_along_the_surface");
  CHECK_CLOSE(SetupMax(deep), 0, 0, "no_pull_inside");
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(LogRegister());
  PetscCall(TestCircle());
  PetscCall(TestEnergy());
  PetscCall(TestBalance(FULL, "full"));
  PetscCall(TestBalance(WALLS, "walls"));
  PetscCall(TestBalance(OPEN, "open"));
  PetscCall(TestUnequal());
  PetscCall(TestEllipse());
  PetscCall(TestSlopes());
  PetscCall(TestWalls());
  PetscCall(TestParts());
  PetscCall(TestMarangoni(0, 1, 0.2));
  PetscCall(TestMarangoni(0.2, 12, 0.15));
  PetscCall(TestMarangoni(0.4, 4, 1));
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
