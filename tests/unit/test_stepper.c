/* Shifting: the centre of mass, momentum and angular momentum stay, in two and three dimensions, of one and of two
   liquids; it does move particles, and to where they are more even; a step has what it reads. Runs on any number of
   ranks. */
#include "../../src/stepper/shifting.h"
#include "../../src/stepper/stepper_impl.h"
#include "setup.h"
#include "check.h"

#define DT    0.02 /* s */
#define CAP   0.1  /* spacings, of a shift */
#define GUARD 0.5  /* spacings from walls, to which a shift may lead */
#define SLOW  1e-2 /* m/s, of neighbours that are shifted by less than that */
#define DROP  "-spacing 1 -packing_jitter 0.25 -bodies a -a_shape sphere -a_radius 4.3 "
#define TWO                                                                                                            \
  "-spacing 1 -packing_jitter 0.25 -box_lower -9,-9,-9 -box_upper 9,9,9 -bodies a,b -a_lower -4,-4,-4 -a_upper 4,4,0 " \
  "-b_lower -4,-4,0 -b_upper 4,4,3 -b_density 300 "
#define FLAT "-dimension 2 -spacing 1 -packing_jitter 0.25 -box_lower -9,-9 -box_upper 9,9 -bodies a -a_radius 6 "
#define POST                                                                                                           \
  "-dimension 2 -spacing 1 -packing_jitter 0.25 -box_lower 0,0 -box_upper 42,12 -box_xmin wall -box_ymin wall "        \
  "-bodies a -a_upper 41,11 -solids s -s_shape sphere -s_center 6,6 -s_radius 2 "
#define ROUND                                                                                                          \
  "-spacing 1 -packing_jitter 0.25 -box_lower 0,0,0 -box_upper 9,8,8 -box_x periodic -box_y periodic -box_z periodic " \
  "-bodies a "

/* sums[0..2] of m r, [3..5] of m v, [6..8] of m r x v of the fluid, [9] of m |v|. */
static void Sums(Cloud cloud, const PetscReal x[], const PetscReal v[], PetscReal sums[10])
{
  for (PetscInt i = 0; i < 10; i++) sums[i] = 0;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal m = cloud->volume[a] * cloud->rest_density[a], *r = x + DIM * a, *u = v + DIM * a;

    for (PetscInt d = 0; d < DIM; d++) {
      const PetscInt e = (d + 1) % DIM, f = (d + 2) % DIM;

      sums[d] += m * r[d];
      sums[DIM + d] += m * u[d];
      sums[2 * DIM + d] += m * (r[e] * u[f] - r[f] * u[e]);
    }
    sums[9] += m * Norm(u);
  }
  for (PetscInt i = 0; i < 10; i++) sums[i] = SetupSum(sums[i]);
}

/* Mean square of sum V grad W inside: how uneven the distribution is. */
static PetscReal Unevenness(Cloud cloud)
{
  PetscReal sum = 0, count = 0;

  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    if (cloud->integer[INT_SURFACE][a]) continue;
    sum += Dot(cloud->field[FIELD_NORMAL] + DIM * a, cloud->field[FIELD_NORMAL] + DIM * a);
    count++;
  }
  return SetupSum(sum) / SetupSum(count);
}

static PetscErrorCode CheckShift(const char options[], PetscBool open, const char label[])
{
  char           name[96];
  Setup          s;
  Cloud          cloud;
  PetscReal      before[10], after[10], uneven, moved = 0;
  const Shifting conserved = {PETSC_TRUE, PETSC_TRUE};
  const PetscInt turns     = open ? 3 : 2; /* angular momentum means nothing in a periodic box */

  PetscFunctionBegin;
  PetscCall(SetupPack(options, &s));
  cloud = s.cloud;
  PetscCall(SetupMoments(&s));
  uneven = Unevenness(cloud);
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    for (PetscInt d = 0; d < DIM; d++)
      cloud->field[FIELD_VELOCITY_NEW][DIM * a + d] =
        d < cloud->domain->dim ? 1 + RandomUnit(9, (unsigned long long)(DIM * cloud->integer[INT_ID][a] + d)) : 0;
  PetscCall(CloudUpdate(cloud, FIELD_VELOCITY_NEW));
  PetscCall(PetscArraycpy(cloud->field[FIELD_POSITION_NEW], cloud->field[FIELD_POSITION], DIM * cloud->n_owned));
  Sums(cloud, cloud->field[FIELD_POSITION_NEW], cloud->field[FIELD_VELOCITY_NEW], before);
  PetscCall(OperatorsDivergence(cloud, cloud->field[FIELD_VELOCITY_NEW], PETSC_TRUE, 0, NULL,
                                cloud->field[FIELD_VELOCITY_GRADIENT], cloud->field[FIELD_VELOCITY_JUMP]));
  PetscCall(Shift(cloud, &conserved, GUARD, DT));
  Sums(cloud, cloud->field[FIELD_POSITION_NEW], cloud->field[FIELD_VELOCITY_NEW], after);
  for (PetscInt i = 0; i < turns; i++) {
    static const char *const what[] = {"centre", "momentum", "angular_momentum"};
    PetscReal                error  = 0;

    for (PetscInt d = 0; d < DIM; d++) error = PetscMax(error, PetscAbsReal(after[DIM * i + d] - before[DIM * i + d]));
    PetscCall(PetscSNPrintf(name, sizeof(name), "%s_%s", label, what[i]));
    CHECK_CLOSE(error / before[9], 0, 1e-13, name);
  }
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) {
    const PetscReal step = cloud->field[FIELD_POSITION_NEW][k] - cloud->field[FIELD_POSITION][k];

    moved                           = PetscMax(moved, PetscAbsReal(step));
    cloud->field[FIELD_POSITION][k] = cloud->field[FIELD_POSITION_NEW][k];
  }
  moved = SetupMax(moved);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_moves", label));
  CheckTrue(moved > 1e-3 && moved < 0.3, name);
  PetscCall(CloudMoved(cloud));
  PetscCall(CloudSearch(cloud, NULL, NULL));
  PetscCall(SetupMoments(&s));
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_more_even", label));
  CheckTrue(Unevenness(cloud) < uneven, name);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A drop of an arranged packing with its moments, whose particles the next shift moves from where they are. */
static PetscErrorCode OpenDrop(Setup *s)
{
  PetscFunctionBegin;
  PetscCall(SetupPack(FLAT "-a_shape sphere ", s));
  PetscCall(SetupMoments(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Shifts particles from their positions; the new ones are beside them. */
static PetscErrorCode ShiftFromHere(Cloud cloud, const Shifting *shifting)
{
  PetscFunctionBegin;
  PetscCall(PetscArraycpy(cloud->field[FIELD_POSITION_NEW], cloud->field[FIELD_POSITION], DIM * cloud->n_owned));
  PetscCall(Shift(cloud, shifting, GUARD, DT));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How particle a was shifted. */
static void ShiftOf(Cloud cloud, PetscInt a, PetscReal dr[DIM])
{
  for (PetscInt d = 0; d < DIM; d++)
    dr[d] = cloud->field[FIELD_POSITION_NEW][DIM * a + d] - cloud->field[FIELD_POSITION][DIM * a + d];
}

/* Every particle for itself: no shift is longer than the cap, on the surface it is along it, and a linear velocity is
   the same function of the place as before. */
static PetscErrorCode CheckPlain(PetscReal rate)
{
  const Shifting  plain       = {PETSC_TRUE, PETSC_FALSE};
  const PetscReal G[DIM][DIM] = {{0.3 * rate, -0.7 * rate, 0}, {0.2 * rate, -0.3 * rate, 0}, {0, 0, 0}};
  PetscReal       longest = 0, wrong = 0, off = 0;
  Setup           s;
  Cloud           cloud;

  PetscFunctionBegin;
  PetscCall(OpenDrop(&s));
  cloud = s.cloud;
  for (PetscInt a = 0; a < cloud->n_total; a++)
    for (PetscInt d = 0; d < DIM; d++)
      cloud->field[FIELD_VELOCITY_NEW][DIM * a + d] = Dot(G[d], cloud->field[FIELD_POSITION] + DIM * a);
  PetscCall(OperatorsDivergence(cloud, cloud->field[FIELD_VELOCITY_NEW], PETSC_TRUE, 0, NULL,
                                cloud->field[FIELD_VELOCITY_GRADIENT], cloud->field[FIELD_VELOCITY_JUMP]));
  PetscCall(ShiftFromHere(cloud, &plain));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *x = cloud->field[FIELD_POSITION_NEW] + DIM * a;
    PetscReal        dr[DIM];

    ShiftOf(cloud, a, dr);
    longest = PetscMax(longest, Norm(dr));
    if (cloud->integer[INT_SURFACE][a])
      off = PetscMax(off, PetscAbsReal(Dot(dr, cloud->field[FIELD_NORMAL] + DIM * a)));
    for (PetscInt d = 0; d < DIM && cloud->field[FIELD_LAMBDA][a] > MOMENT_MINIMUM; d++)
      wrong = PetscMax(wrong, PetscAbsReal(cloud->field[FIELD_VELOCITY_NEW][DIM * a + d] - Dot(G[d], x)));
  }
  CHECK_CLOSE(SetupMax(longest) / CAP, rate > 1 ? 1 : 0.5, rate > 1 ? 1e-12 : 0.49, "plain_shift_is_capped");
  CHECK_CLOSE(SetupMax(off), 0, 1e-12, "plain_shift_of_the_surface_is_along_it");
  CHECK_CLOSE(SetupMax(wrong), 0, 1e-12 * rate, "plain_shift_keeps_a_linear_velocity");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Distance of x from the walls and the post, in spacings. */
static PetscReal WallDistance(Cloud cloud, const PetscReal x[DIM])
{
  return PetscMin(PetscMin(x[0], x[1]), SceneSolidDistance(cloud->scene, x, NULL));
}

/* Beside walls no shift leads closer than the guard lets. In a shear flow over the floor, where the others get a
   velocity by the shift across it, what is stopped there gets none: it is beside where it was. Adds what is stopped and
   what it gets, over its shift, to all. */
static PetscErrorCode CheckWalls(PetscInt seed, PetscReal all[2])
{
  char           options[512];
  const Shifting plain  = {PETSC_TRUE, PETSC_FALSE};
  PetscReal      closer = 0, given = 0, stopped = 0;
  Setup          s;
  Cloud          cloud;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof(options), POST "-packing_seed %d ", (int)seed));
  PetscCall(SetupPack(options, &s));
  PetscCall(SetupMoments(&s));
  cloud = s.cloud;
  for (PetscInt a = 0; a < cloud->n_total; a++)
    for (PetscInt d = 0; d < DIM; d++)
      cloud->field[FIELD_VELOCITY_NEW][DIM * a + d] = d ? 0 : cloud->field[FIELD_POSITION][DIM * a + 1];
  PetscCall(OperatorsDivergence(cloud, cloud->field[FIELD_VELOCITY_NEW], PETSC_TRUE, 0, NULL,
                                cloud->field[FIELD_VELOCITY_GRADIENT], cloud->field[FIELD_VELOCITY_JUMP]));
  PetscCall(ShiftFromHere(cloud, &plain));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, before = WallDistance(cloud, x),
                    after = WallDistance(cloud, cloud->field[FIELD_POSITION_NEW] + DIM * a);
    PetscReal dr[DIM];

    ShiftOf(cloud, a, dr);
    closer = PetscMax(closer, PetscMin(before, GUARD) - after);
    if (before < x[1] || x[1] > GUARD || dr[1] != 0) continue;
    stopped++;
    given += PetscAbsReal(cloud->field[FIELD_VELOCITY_NEW][DIM * a] - x[1]) / PetscAbsReal(dr[0]);
  }
  CHECK_CLOSE(SetupMax(closer), 0, 1e-3, "walls_stop_a_shift"); /* the post is round */
  all[0] += SetupSum(stopped);
  all[1] += SetupSum(given);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The surface of liquid that carries its weight is calmed, whatever walls beside it do: a flow that is linear across a
   periodic box, and a uniform one between walls, stay as they are, and noise on the surface alone falls. */
static PetscErrorCode CheckCalm(const char sides[], PetscReal shear)
{
  PetscReal *v, moved = 0, left[2] = {0, 0}, count[2] = {0, 0};
  char       options[512];
  Stepper    stepper;
  Setup      s;
  Cloud      cloud;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof(options),
                          "-dimension 2 -spacing 1 -packing_jitter 0.1 -box_lower 0,0 -box_upper 16,14 -box_ymin wall "
                          "-gravity 0,-10 -bodies a -a_upper 16,9 -box_x %s ",
                          sides));
  PetscCall(SetupPack(options, &s));
  PetscCall(SetupMoments(&s));
  cloud = s.cloud;
  PetscCall(PressureCreate(cloud, &s.pressure));
  PetscCall(StepperCreate(cloud, s.tension, s.pressure, &stepper));
  PetscCall(StepperSetFromOptions(stepper));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) cloud->field[FIELD_CARRIED][a] = 1;
  PetscCall(PressurePredict(s.pressure));
  PetscCall(PressureSetUp(s.pressure, DT));
  v = cloud->field[FIELD_VELOCITY_NEW];
  for (PetscInt k = 0; k < 2; k++) {
    PetscCall(PetscArrayzero(v, DIM * cloud->n_owned));
    for (PetscInt a = 0; a < cloud->n_owned; a++)
      v[DIM * a] = a < cloud->n_fluid ? 1 + shear * cloud->field[FIELD_POSITION][DIM * a + 1] : 100;
    PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, v));
    PetscCall(OperatorsDivergence(cloud, v, PETSC_TRUE, 0, NULL, cloud->field[FIELD_VELOCITY_GRADIENT], NULL));
    for (PetscInt a = 0; a < cloud->n_fluid && k; a++) v[DIM * a] += cloud->integer[INT_ID][a] % 2 ? 1 : -1;
    PetscCall(StepCalm(stepper, 10));
    for (PetscInt a = 0; a < cloud->n_fluid; a++) {
      const PetscReal off     = v[DIM * a] - 1 - shear * cloud->field[FIELD_POSITION][DIM * a + 1];
      const PetscBool surface = (PetscBool)(cloud->integer[INT_SURFACE][a] == 1);

      if (!k) moved = PetscMax(moved, PetscAbsReal(off));
      if (!k || (!surface && PressureCloses(s.pressure, a))) continue;
      left[surface] += PetscAbsReal(off);
      count[surface]++;
    }
  }
  CHECK_CLOSE(SetupMax(moved), 0, 1e-6, "a_linear_flow_is_not_calmed"); /* factors in single precision */
  CheckTrue(SetupSum(left[1]) < 0.7 * SetupSum(count[1]), "noise_of_a_surface_is_calmed");
  CHECK_CLOSE(SetupSum(left[0]) / SetupSum(count[0]), 1, 1e-9, "inside_it_is_not");
  PetscCall(StepperDestroy(&stepper));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whatever the source of the pressure is, a step sums the speeds that its shifting reads. */
static PetscErrorCode CheckSpeeds(const char options[], const char label[])
{
  StepTrial trial = {0};
  Setup     s;
  Stepper   stepper;
  PetscReal unknown = 0;

  PetscFunctionBegin;
  PetscCall(SetupPack(options, &s));
  PetscCall(PressureCreate(s.cloud, &s.pressure));
  PetscCall(StepperCreate(s.cloud, s.tension, s.pressure, &stepper));
  PetscCall(StepperSetFromOptions(stepper));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) s.cloud->field[FIELD_VELOCITY_JUMP][a] = -1;
  PetscCall(stepper->ops->step(stepper, 1e-4, &trial));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) unknown += s.cloud->field[FIELD_VELOCITY_JUMP][a] < 0;
  CHECK_CLOSE(SetupSum(unknown), 0, 0, label);
  PetscCall(StepperDestroy(&stepper));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscReal all[2] = {0, 0};

  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(LogRegister());
  PetscCall(CheckShift(DROP "-box_lower -9,-9,-9 -box_upper 9,9,9 ", PETSC_TRUE, "drop"));
  PetscCall(CheckShift(TWO, PETSC_TRUE, "two_liquids"));
  PetscCall(CheckShift(FLAT "-a_shape sphere ", PETSC_TRUE, "flat"));
  PetscCall(CheckShift(ROUND, PETSC_FALSE, "periodic"));
  PetscCall(CheckPlain(1));
  PetscCall(CheckPlain(100));
  for (PetscInt seed = 1; seed <= 4; seed++) PetscCall(CheckWalls(seed, all));
  CheckTrue(all[0] > 8, "a_floor_stops_some");
  CHECK_CLOSE(all[1] / all[0], 0, 0.05, "what_is_stopped_gets_no_velocity");
  PetscCall(CheckCalm("wall", 0));
  PetscCall(CheckCalm("periodic", 0.3));
  PetscCall(CheckSpeeds(FLAT "-a_shape sphere -time_step 1e-4 -pressure_source divergence ", "speeds_divergence"));
  PetscCall(CheckSpeeds(FLAT "-a_shape sphere -time_step 1e-4 -pressure_source density ", "speeds_density"));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
