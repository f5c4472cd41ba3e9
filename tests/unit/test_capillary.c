/* Surface tension: walls stand for liquid in the stress of Cahn and Hilliard; the options of the curvature model act;
   one tension serves two steps. Lengths in spacings. Runs on any number of ranks. */
#include "../../src/lines/lines.h"
#include "../../src/tension/curvature.h"
#include "setup.h"
#include "check.h"

#define PLANE  "-dimension 2 -spacing 1 -box_x periodic -packing_jitter 0 -bodies a -a_tension 1 -a_upper 6,6 "
#define LAYERS 6
/* The stress along the surface of the layers at heights 0.5 to 5.5, N/m2. */
static PetscErrorCode Stress(const char options[], PetscReal layer[LAYERS])
{
  PetscReal *g;
  Setup      s;

  PetscFunctionBegin;
  PetscCall(SetupPack(options, &s));
  PetscCall(SetupMoments(&s));
  PetscCall(PetscMalloc1(DIM * s.cloud->n_owned, &g));
  PetscCall(CahnHilliardGradient(s.tension, s.cloud, g));
  for (PetscInt k = 0; k < LAYERS; k++) layer[k] = -PETSC_MAX_REAL;
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    const PetscInt k = (PetscInt)PetscFloorReal(s.cloud->field[FIELD_POSITION][DIM * a + 1]);

    if (k >= 0 && k < LAYERS) layer[k] = PetscMax(layer[k], PetscSqr(g[DIM * a + 1]) + PetscSqr(g[DIM * a + 2]));
  }
  for (PetscInt k = 0; k < LAYERS; k++) layer[k] = SetupMax(layer[k]);
  PetscCall(PetscFree(g));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A film on a floor has the stress of the upper part of a deeper one; so has its mirror image under a ceiling. */
static PetscErrorCode TestFloor(void)
{
  const char ch[] = "-tension_type cahn_hilliard ";
  char       options[512];
  PetscReal  deep[LAYERS], wall[LAYERS], error = 0;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof(options), PLANE "-box_lower -6,-20 -box_upper 6,30 -a_lower -6,-10 %s", ch));
  PetscCall(Stress(options, deep));
  PetscCall(PetscSNPrintf(options, sizeof(options), PLANE "-box_lower -6,0 -box_upper 6,30 -box_ymin wall %s", ch));
  PetscCall(Stress(options, wall));
  for (PetscInt k = 0; k < LAYERS; k++) error = PetscMax(error, PetscAbsReal(wall[k] - deep[k]));
  CHECK_CLOSE(error / deep[LAYERS - 1], 0, 0.02, "floor_stands_for_liquid"); /* integrals for sums over a lattice */
  PetscCall(PetscSNPrintf(options, sizeof(options), PLANE "-box_lower -6,-20 -box_upper 6,6 -box_ymax wall %s", ch));
  PetscCall(Stress(options, wall));
  error = 0;
  for (PetscInt k = 0; k < LAYERS; k++) error = PetscMax(error, PetscAbsReal(wall[k]));
  CHECK_CLOSE(error / deep[LAYERS - 1], 0, 0.02, "ceiling_stands_for_liquid"); /* no surface is near */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The angle of a line with this angle at rest beside a particle of size 1. */
static PetscReal Angle(Tension tension, PetscReal at_rest, PetscReal capillary)
{
  void *lines = TensionLines(tension);

  return MovingLines.angle(lines, at_rest, LineBend(lines, 1, 1, capillary));
}

/* The laws of contact lines that move. Kistler's from its function; Cox's by theta^3 = 9 Ca L, which holds for small
   angles (at 45 degrees within 3 %); with a slip length of a spacing no angle changes. */
static PetscErrorCode TestLaws(void)
{
  const char      line[] = PLANE "-box_lower -6,0 -box_upper 6,30 -box_ymin wall -a_lower -6,0 ";
  const PetscReal Ca = 0.02, at_rest = 1.2, number = Ca / (1 + 1.31 * PetscPowReal(Ca, 0.99));
  const PetscReal hoffman = acos(1 - 2 * PetscTanhReal(5.16 * PetscPowReal(number, 0.706)));
  char            options[512];
  Setup           s;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof(options), "%s -wall_contact_law kistler ", line));
  PetscCall(SetupPack(options, &s));
  CHECK_CLOSE(Angle(s.tension, 0, Ca), hoffman, 1e-3, "kistler_from_zero");
  CHECK_CLOSE(Angle(s.tension, hoffman, -Ca), 20 * PETSC_PI / 180, 1e-3, "kistler_back_to_the_least");
  PetscCall(SetupClose(&s));
  PetscCall(PetscSNPrintf(options, sizeof(options), "%s -wall_contact_law cox_voinov -wall_contact_slip %.17g ", line,
                          (double)PetscExpReal(-10)));
  PetscCall(SetupPack(options, &s));
  CHECK_CLOSE(Angle(s.tension, 0, 0.005), PetscPowReal(0.45, 1. / 3), 0.01, "voinov");
  CHECK_CLOSE(Angle(s.tension, Angle(s.tension, at_rest, Ca), -Ca), at_rest, 1e-5, "there_and_back");
  CHECK_CLOSE(Angle(s.tension, at_rest, 9), 165 * PETSC_PI / 180, 1e-12, "largest_angle");
  CHECK_CLOSE(LineBend(TensionLines(s.tension), 1, 2, Ca) - LineBend(TensionLines(s.tension), 1, 1, Ca),
              Ca * PetscLogReal(2), 1e-12, "bend_of_size");
  PetscCall(SetupClose(&s));
  PetscCall(PetscSNPrintf(options, sizeof(options), "%s -wall_contact_law cox_voinov -wall_contact_slip 1 ", line));
  PetscCall(SetupPack(options, &s));
  CHECK_CLOSE(Angle(s.tension, at_rest, 9), at_rest, 1e-12, "no_room_no_change");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define FOOT                                                                                                           \
  "-dimension 2 -spacing 1 -box_lower -20,0 -box_upper 20,20 -box_ymin wall -wall_contact_law cox_voinov "             \
  "-bodies a -a_tension 2 -a_viscosity 4 -a_shape sphere -a_radius 9 "

/* The number of the line at the right (x > 0) or left end of a drop, mean over the particles that have one. */
static PetscReal LineNumber(Setup *s, PetscBool right)
{
  PetscReal sum = 0, count = 0;

  for (PetscInt a = 0; a < s->cloud->n_fluid; a++) {
    const PetscReal line = s->cloud->field[FIELD_LINE][a];

    if (line == 0 || (s->cloud->field[FIELD_POSITION][DIM * a] > 0) != right) continue;
    sum += line;
    count++;
  }
  return SetupSum(sum) / PetscMax(1, SetupSum(count));
}

/* A drop that moves beside its wall, or the wall beside it, has lines of exactly mu U/sigma, one of which recedes. A
   particle without a number takes over that of those around it. */
static PetscErrorCode TestNumbers(void)
{
  const char *const motion[] = {"-a_velocity 0.3,0", "-box_ymin_velocity -0.3,0"};
  char              options[512];
  Setup             s;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2; k++) {
    PetscInt first = -1;

    PetscCall(PetscSNPrintf(options, sizeof(options), FOOT "%s ", motion[k]));
    PetscCall(SetupPack(options, &s));
    PetscCall(SetupMoments(&s));
    PetscCall(TensionApply(s.tension, s.cloud));
    LinesMove(s.tension, s.cloud, 1e9);
    CHECK_CLOSE(LineNumber(&s, PETSC_TRUE), 0.6, 1e-9, "line_advances");
    CHECK_CLOSE(LineNumber(&s, PETSC_FALSE), -0.6, 1e-9, "line_recedes");
    for (PetscInt a = 0; a < s.cloud->n_fluid && first < 0; a++)
      if (s.cloud->field[FIELD_LINE][a] != 0) first = a;
    if (first >= 0) s.cloud->field[FIELD_LINE][first] = 0;
    PetscCall(TensionApply(s.tension, s.cloud));
    LinesMove(s.tension, s.cloud, 0);
    CHECK(first < 0 || PetscAbsReal(PetscAbsReal(s.cloud->field[FIELD_LINE][first]) - 0.6) < 1e-9, "newcomer");
    PetscCall(SetupClose(&s));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One tension serves two steps: it is that of the places between them, and the second step gets it to the last bit,
   with the pull of sheets; TensionApply between, or a new order, ends that. */
static PetscErrorCode TestPair(void)
{
  const PetscReal time = 0.05;
  PetscReal      *x, *v, *first[3], apart[3] = {0, 0, 0}, largest = 0;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(SetupPack("-dimension 2 -spacing 1 -box_lower -20,-20 -box_upper 20,20 -bodies a,b -a_shape sphere "
                      "-a_radius 8 -a_tension 1 -b_lower 10,-9 -b_upper 12,9 -b_tension 1 ",
                      &s));
  PetscCall(SetupMoments(&s));
  x = s.cloud->field[FIELD_POSITION];
  v = s.cloud->field[FIELD_VELOCITY];
  for (PetscInt k = 0; k < DIM * s.cloud->n_total; k++) v[k] = k % DIM == 0 ? 3 * x[k] / 8 : 0; /* stretches */
  for (PetscInt k = 0; k < 3; k++) {
    PetscCall(PetscMalloc1((DIM + 1) * s.cloud->n_fluid, &first[k]));
    PetscCall(PetscArrayzero(s.cloud->field[FIELD_ACCELERATION], DIM * s.cloud->n_owned));
    for (PetscInt i = 0; i < DIM * s.cloud->n_total && k == 2; i++) x[i] += time * v[i];
    if (k == 0) PetscCall(TensionApplyAhead(s.tension, s.cloud, time));
    if (k == 1) PetscCall(TensionApplyKept(s.tension, s.cloud));
    if (k == 2) PetscCall(TensionApply(s.tension, s.cloud));
    PetscCall(PetscArraycpy(first[k], s.cloud->field[FIELD_ACCELERATION], DIM * s.cloud->n_fluid));
    PetscCall(PetscArraycpy(first[k] + DIM * s.cloud->n_fluid, s.cloud->field[FIELD_CAPILLARY], s.cloud->n_fluid));
  }
  for (PetscInt i = 0; i < (DIM + 1) * s.cloud->n_fluid; i++) {
    apart[0] = PetscMax(apart[0], PetscAbsReal(first[1][i] - first[0][i]));
    apart[1] = PetscMax(apart[1], PetscAbsReal(first[2][i] - first[0][i]));
    if (i < DIM * s.cloud->n_fluid) largest = PetscMax(largest, PetscAbsReal(first[0][i]));
  }
  CHECK(SetupMax(largest) > 0, "pair_pulls");
  CHECK_CLOSE(SetupMax(apart[0]), 0, 0, "pair_second");
  CHECK_CLOSE(SetupMax(apart[1]), 0, 1e-12, "pair_between");
  for (PetscInt i = 0; i < DIM * s.cloud->n_total; i++) x[i] -= time * v[i];
  PetscCall(TensionApplyKept(s.tension, s.cloud));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
    apart[2] =
      PetscMax(apart[2], PetscAbsReal(s.cloud->field[FIELD_CAPILLARY][a] - first[0][DIM * s.cloud->n_fluid + a]));
  CHECK(SetupMax(apart[2]) > 1e-4, "pair_ended");
  for (PetscInt k = 0; k < 3; k++) PetscCall(PetscFree(first[k]));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(LogRegister());
  PetscCall(TestFloor());
  PetscCall(TestLaws());
  PetscCall(TestNumbers());
  PetscCall(TestPair());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
