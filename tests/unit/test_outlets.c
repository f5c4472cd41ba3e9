/* Outlets, without a run: the pressure outside by hand, which particles it is beside, what it holds and calms, and the
   books of what left. Lengths in spacings. Runs on any number of ranks. */
#include "../../src/outlets/edge.c"
#include "setup.h"
#include "check.h"

#define TANK                                                                                                           \
  "-dimension 2 -spacing 1 -packing_jitter 0 -box_lower 0,0 -box_upper 12,12 -box_xmin wall -box_ymin wall -gravity "  \
  "0,-10 -bodies a -a_upper 12,9 -a_density 800 "
#define OUTSIDE "-box_xmax_level 7 -box_xmax_pressure 300 -box_ymax_pressure -50 "

static PetscErrorCode Open(const char options[], Setup *s, Outlets *outlets)
{
  const Step step = {.own = outlets, .scene = NULL};

  PetscFunctionBegin;
  PetscCall(SetupPack(options, s));
  PetscCall(SetupMoments(s));
  PetscCall(PressureCreate(s->cloud, &s->pressure));
  PetscCall(PressureSetTypes(s->pressure, SOURCE_DIVERGENCE, CLOSURE_FULL, GRADIENT_CORRECTED, PETSC_FALSE));
  PetscCall(PressureSetFromOptions(s->pressure));
  PetscCall(PetscMemzero(outlets, sizeof(*outlets)));
  PetscCall(Create(&(Step){.own = step.own, .cloud = s->cloud, .pressure = s->pressure}));
  PetscCall(Options(&(Step){.own = step.own, .cloud = s->cloud, .pressure = s->pressure, .scene = s->scene}));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Below the level hydrostatic, above it air, and the pressure besides; a surface that stands off the face by a gap is
   held as one that much lower. The speed is Bernoulli's at the lowest corner. */
static PetscErrorCode TestOutside(void)
{
  const PetscReal low[DIM] = {11, 2, 0}, high[DIM] = {11, 8, 0};
  PetscReal       slope[DIM];
  Outlets         outlets;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(Open(TANK OUTSIDE, &s, &outlets));
  CHECK_CLOSE(outlets.gravity[1], -10, 1e-9, "gravity_is_the_slope_of_the_potential");
  CHECK_CLOSE(OutletOutside(&outlets, 0, 1, low, 0, slope), 300 + 800 * 10 * (7 - 2), 1e-6, "below_the_level");
  CHECK_CLOSE(slope[1], -800 * 10, 1e-6, "it_falls_with_the_height");
  CHECK_CLOSE(slope[0], 0, 0, "along_the_face_alone");
  CHECK_CLOSE(OutletOutside(&outlets, 0, 1, high, 0, slope), 300, 1e-6, "above_the_level");
  CHECK_CLOSE(slope[1], 0, 0, "the_same_everywhere");
  CHECK_CLOSE(OutletOutside(&outlets, 0, 1, low, 0.5, NULL), 300 + 800 * 10 * (7 - 2 - 0.5), 1e-6, "off_the_face");
  CHECK_CLOSE(OutletOutside(&outlets, 1, 1, low, 0, slope), -50, 1e-9, "a_pressure_without_a_level");
  CHECK_CLOSE(outlets.speed, PetscSqrtReal(2 * (300. / 800 + 10 * 7)), 1e-9, "speed_of_bernoulli");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the normal (1/m) of all liquid. */
static void Look(Cloud cloud, PetscReal x, PetscReal y)
{
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    cloud->field[FIELD_NORMAL][DIM * a]     = x;
    cloud->field[FIELD_NORMAL][DIM * a + 1] = y;
  }
}

/* Normals point into the liquid. A surface beside the face has the outside's pressure fully up to 45 degrees, in part
   beyond, and none behind; what is away from the face has none. */
static PetscErrorCode TestLooks(void)
{
  const PetscReal n[][2] = {{-1, 0}, {-1, 1}, {-1, PetscSqrtReal(3)}, {0, 1}, {1, 0}}, share[] = {1, 1, 0.5, 0, 0};
  const PetscInt  face[] = {1, 1, 1, -1, -1};
  Outlets         outlets;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(Open(TANK "-box_xmax_level 7 -box_xmax_pressure 300 ", &s, &outlets));
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(share); k++) {
    PetscReal wrong = 0, far = 0, unlike = 0, near = 0;

    Look(s.cloud, n[k][0], n[k][1]);
    for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
      const PetscReal *x = s.cloud->field[FIELD_POSITION] + DIM * a, away = 12 - x[0],
                      gap = PetscMax(-1, PetscMin(1, away - PressureDepth(s.pressure, a)));
      PetscReal P;

      P = OutletsPressure(&outlets, a, NULL);
      unlike += OutletsFacing(&outlets, a) != face[k];
      if (away > KernelSupport(s.kernel) + 1) {
        far = PetscMax(far, PetscAbsReal(P));
        continue;
      }
      near++;
      wrong = PetscMax(wrong, PetscAbsReal(P - share[k] * OutletOutside(&outlets, 0, 1, x, gap, NULL)));
    }
    CHECK_CLOSE(SetupMax(wrong), 0, 1e-6, "share_of_a_surface_that_looks_at_the_face");
    CHECK_CLOSE(SetupMax(far), 0, 0, "none_away_from_it");
    CHECK_CLOSE(SetupSum(unlike), 0, 0, "the_face_that_it_looks_at");
    CHECK_CLOSE(SetupSum(near), 4 * 9, 0, "all_within_reach");
  }
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A uniform velocity stays; noise on the surface falls, takes energy, and what is inside keeps its own. */
static PetscErrorCode TestCalm(void)
{
  PetscReal *v, moved = 0, energy[2] = {0, 0}, before[2] = {0, 0}, after[2] = {0, 0}, lost = 0;
  Outlets    outlets;
  Setup      s;

  PetscFunctionBegin;
  PetscCall(Open(TANK "-box_xmax_level 7 ", &s, &outlets));
  PetscCall(CloudGetWork(s.cloud, DIM, &v));
  for (PetscInt k = 0; k < DIM * s.cloud->n_owned; k++) v[k] = k % DIM == 0;
  PetscCall(OutletsCalm(&outlets, 0.1, v, &energy[0]));
  for (PetscInt k = 0; k < DIM * s.cloud->n_fluid; k++) moved = PetscMax(moved, PetscAbsReal(v[k] - (k % DIM == 0)));
  CHECK_CLOSE(SetupMax(moved), 0, 1e-12, "a_uniform_flow_is_not_calmed");
  CHECK_CLOSE(SetupSum(energy[0]), 0, 1e-9, "and_keeps_its_energy");
  for (PetscInt a = 0; a < s.cloud->n_owned; a++)
    v[DIM * a] = a < s.cloud->n_fluid && s.cloud->integer[INT_ID][a] % 2 ? 1 : -1;
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    v[DIM * a + 1] = v[DIM * a + 2] = 0;
    before[s.cloud->field[FIELD_POSITION][DIM * a] > 11 && s.cloud->field[FIELD_POSITION][DIM * a + 1] < 6]++;
  }
  PetscCall(OutletsCalm(&outlets, 0.1, v, &energy[1]));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    after[s.cloud->field[FIELD_POSITION][DIM * a] > 11 && s.cloud->field[FIELD_POSITION][DIM * a + 1] < 6] +=
      Dot(v + DIM * a, v + DIM * a);
    lost += 0.5 * 800 * (Dot(v + DIM * a, v + DIM * a) - 1);
  }
  CHECK(SetupSum(after[1]) < 0.5 * SetupSum(before[1]), "noise_at_an_outlet_is_calmed");
  CHECK_CLOSE(SetupSum(energy[1]) / SetupSum(lost), 1, 1e-9, "the_energy_that_it_takes");
  PetscCall(CloudRestoreWork(s.cloud, &v));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What is beyond an outlet leaves and takes the work of the pressure outside; what leaves elsewhere does not count. The
   work on a surface that is pushed in comes back as it comes back, and small changes of it do not add up. */
static PetscErrorCode TestBooks(void)
{
  OutletSums sums = {.now = {0}};
  PetscReal  left[2 * DIM], push = 0;
  Outlets    outlets;
  Setup      s;
  PetscInt   moved = 0;

  PetscFunctionBegin;
  PetscCall(Open(TANK "-box_xmax_level 7 -box_xmax_pressure 300 ", &s, &outlets));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    PetscReal *x = s.cloud->field[FIELD_POSITION] + DIM * a;

    if (x[1] > 1) continue; /* the lowest row: the first half leaves by the outlet, the rest by the top */
    moved++;
    if (x[0] < 6) {
      x[0] = 12.1;
      x[1] = 3;
    } else
      x[1] = 12.1;
  }
  PetscCall(Guard(&(Step){.own = &outlets, .sums = (PetscReal *)&sums, .cloud = s.cloud}));
  for (PetscInt f = 0; f < 2 * DIM; f++) left[f] = SetupSum(sums.now.left[f]);
  CHECK_CLOSE(SetupSum((PetscReal)moved), 12, 0, "a_row_of_the_lattice");
  CHECK_CLOSE(left[1], 6, 1e-9, "volume_that_left_by_the_outlet");
  CHECK_CLOSE(left[3], 0, 0, "not_by_another_face");
  CHECK_CLOSE(SetupSum(sums.now.work), -6 * (300 + 8000 * 4), 1e-6, "work_against_the_outside");
  CHECK_CLOSE(SetupSum(sums.against[1]), 6 * (300 + 8000 * 4), 1e-6, "the_same_of_its_face");
  CHECK_CLOSE(Pushed(0, 5, 0, 1), 5, 0, "work_on_a_surface_that_is_pushed_in");
  CHECK_CLOSE(Pushed(5, -4, 0.5, 1), 1, 0, "and_back");
  CHECK_CLOSE(Pushed(0, -5, 0, 1), -1, 0, "never_out_by_more_than_half_a_spacing");
  for (PetscInt k = 0; k < 100; k++) push = Pushed(push, 0.3, -0.4, 1);
  CHECK_CLOSE(push, -1, 0.5, "small_differences_do_not_add_up");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(LogRegister());
  PetscCall(TestOutside());
  PetscCall(TestLooks());
  PetscCall(TestCalm());
  PetscCall(TestBooks());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
