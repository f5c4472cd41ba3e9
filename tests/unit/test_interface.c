/* Two liquids that do not mix: bodies that overlap fill the lattice, the jump at a circle, the parts of three tensions,
   and that a pressure which balances the jumps pushes nothing, next to walls and at a free surface too. Lengths in
   spacings. Runs on any number of ranks. */
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
    sum[l] += s.cloud->jump[a];
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
  for (PetscInt a = 0; a < cloud->n_total; a++) cloud->jump[a] = cloud->liquid[a] < 0 ? 0 : part[cloud->liquid[a]];
  PetscCall(PetscArrayzero(cloud->jump_slope, DIM * cloud->n_total));
  PetscCall(PetscArrayzero(cloud->field[FIELD_CAPILLARY_SLOPE], DIM * cloud->n_owned));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) cloud->field[FIELD_CAPILLARY][a] = 2 + cloud->jump[a];
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
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(LogRegister());
  PetscCall(TestCircle());
  PetscCall(TestBalance(FULL, "full"));
  PetscCall(TestBalance(WALLS, "walls"));
  PetscCall(TestBalance(OPEN, "open"));
  PetscCall(TestParts());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
