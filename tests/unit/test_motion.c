/* Solids that move, as their options say and freely. */
#include "../../src/bodies/bodies_impl.h"
#include "read_scene.h"

#define TABLE "output/test_scene_motion.csv"
#define MOVING                                                                                                         \
  SQUARE BALL "-a_radius 0.1 -a_center 0.8,0.8 -solids s -s_lower 0,0 -s_upper 0.3,0.1 -s_motion_file " TABLE

static PetscErrorCode WriteTable(const char text[])
{
  PetscMPIInt rank;
  FILE       *file;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (!rank) {
    file = fopen(TABLE, "w");
    PetscCheck(file, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "cannot write " TABLE);
    fputs(text, file);
    (void)fclose(file);
  }
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A solid that moves as a table says: through its rows, in between as a parabola does where the rows are one, at rest
   before and after; its velocity is that of its places. */
static PetscErrorCode TestTable(void)
{
  const PetscReal times[] = {-1, 0, 0.5, 1, 1.5, 2, 3, 4, 9}, due[] = {0.1, 0.1, 0.1, 0, 0, 0.3, 0.8, 0.9, 0.9};
  PetscReal       error = 0, slope = 0, fastest = 0;
  Domain          domain;
  Scene           scene;
  Body            solid;

  PetscFunctionBegin;
  PetscCall(WriteTable("time,x,y\n# a comment\n0,0.1,0\n1,0,0.2\n2,0.3,0\n3, 0.8, 0\n4 0.9 0.1\n"));
  PetscCall(Read(MOVING, &domain, &scene));
  solid = SceneSolid(scene, 0);
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(times); k++) {
    PetscReal x[DIM] = {0.1, 0, 0}, low[DIM], high[DIM], v[DIM];

    if (times[k] == 0.5 || times[k] == 1.5) continue;
    BodyMove(solid, 0, times[k], x);
    error = PetscMax(error, PetscAbsReal(x[0] - due[k]));
    BodyMotion(solid, times[k] + 0.3, x, v);
    fastest = PetscMax(fastest, Norm(v));
    for (PetscInt d = 0; d < DIM; d++) low[d] = high[d] = x[d];
    BodyMove(solid, times[k], times[k] + 0.3 - 1e-5, low);
    BodyMove(solid, times[k], times[k] + 0.3 + 1e-5, high);
    for (PetscInt d = 0; d < DIM; d++) slope = PetscMax(slope, PetscAbsReal((high[d] - low[d]) / 2e-5 - v[d]));
  }
  CHECK_CLOSE(error, 0, 1e-12, "table_of_places");
  CHECK_CLOSE(slope, 0, 1e-8, "velocity_of_a_table");
  CHECK(fastest > 0.3 && fastest <= 1.02 * SceneSolidSpeed(scene), "speed_of_a_table");
  PetscCall(Free(&domain, &scene));
  PetscCall(WriteTable("0,0,0\n0.5,1,0\n0.5,2,0\n"));
  PetscCall(Refused(MOVING, "line 3", "refuse_times_that_do_not_rise"));
  PetscCall(WriteTable("0,0,0\n0.5,1\n"));
  PetscCall(Refused(MOVING, "line 2", "refuse_a_short_line"));
  PetscCall(WriteTable("0,0,0\n"));
  PetscCall(Refused(MOVING, "two lines or more", "refuse_one_row"));
  PetscCall(Refused(MOVING "x", "cannot be read", "refuse_missing_table"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where a table stands still the solid does, and it is nowhere beyond the rows beside it. */
static PetscErrorCode TestStop(void)
{
  PetscReal beyond = 0, moved = 0;
  Domain    domain;
  Scene     scene;

  PetscFunctionBegin;
  PetscCall(WriteTable("0,0,0\n0.2,0.4,0\n0.4,0.4,0\n0.6,0.4,0\n0.65,0.5,0\n1,0.1,0\n"));
  PetscCall(Read(MOVING, &domain, &scene));
  for (PetscInt k = 0; k <= 100; k++) {
    PetscReal x[DIM] = {0.1, 0, 0};

    BodyMove(SceneSolid(scene, 0), 0, 0.01 * k, x);
    beyond = PetscMax(beyond, x[0] - (k <= 60 ? 0.5 : 0.6));
    if (k >= 20 && k <= 60) moved = PetscMax(moved, PetscAbsReal(x[0] - 0.5));
  }
  CHECK_CLOSE(moved, 0, 1e-12, "a_table_that_stands_still");
  CHECK_CLOSE(PetscMax(beyond, 0), 0, 1e-12, "a_table_that_turns");
  PetscCall(Free(&domain, &scene));
  PetscCall(WriteTable("0,0,0\n1,0.01,0\n1.1,0.6,0\n")); /* a steep row does not pull the curve below the first */
  PetscCall(Read(MOVING, &domain, &scene));
  beyond = 0;
  for (PetscInt k = 0; k <= 100; k++) {
    PetscReal x[DIM] = {0.1, 0, 0};

    BodyMove(SceneSolid(scene, 0), 0, 0.01 * k, x);
    beyond = PetscMax(beyond, 0.1 - x[0]);
  }
  CHECK_CLOSE(beyond, 0, 1e-12, "a_table_that_grows_steep");
  PetscCall(Free(&domain, &scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A solid whose table has angles turns as one with a rate, where the rows are on a line: places, velocities. */
static PetscErrorCode TestAngles(void)
{
  const char *const both[] = {MOVING " -s_rotation_center 0.1,0", SQUARE BALL
                              "-a_radius 0.1 -a_center 0.8,0.8 -solids s -s_lower 0,0 -s_upper 0.3,0.1 "
                              "-s_rotation_center 0.1,0 -s_rotation_rate 1.57079632679489662 -s_velocity 0,0.1"};
  PetscReal         place[2][DIM], speed[2][DIM], error = 0;

  PetscFunctionBegin;
  PetscCall(WriteTable("-2,0,-0.2,-180\n-1,0,-0.1,-90\n0,0,0,0\n1,0,0.1,90\n2,0,0.2,180\n"));
  for (PetscInt k = 0; k < 2; k++) {
    Domain domain;
    Scene  scene;

    PetscCall(Read(both[k], &domain, &scene));
    place[k][0] = 0.3;
    place[k][1] = 0.1;
    place[k][2] = 0;
    BodyMove(SceneSolid(scene, 0), 0, 0.6, place[k]);
    BodyMotion(SceneSolid(scene, 0), 0.6, place[k], speed[k]);
    CHECK(Norm(speed[k]) <= 1.02 * SceneSolidSpeed(scene), "speed_of_angles");
    PetscCall(Free(&domain, &scene));
  }
  for (PetscInt d = 0; d < DIM; d++)
    error += PetscAbsReal(place[0][d] - place[1][d]) + PetscAbsReal(speed[0][d] - speed[1][d]);
  CHECK_CLOSE(error, 0, 1e-12, "angles_of_a_table");
  PetscCall(Refused(MOVING " -s_rotation_rate 1", "cannot be used together", "refuse_angles_and_rate"));
  PetscCall(WriteTable("0,0,0,0\n1,0,0.1\n"));
  PetscCall(Refused(MOVING, "line 2", "refuse_a_line_without_angle"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What a table's file may begin with, and what not: no line of numbers is dropped. */
static PetscErrorCode TestTableText(void)
{
  static const struct {
    const char *name, *text, *refusal; /* none: the solid goes from 0.1 to 0.3 m along x */
  } files[] = {
    {"names_of_columns", "# a comment\n\n  \"t (s)\", information, x2\n0,0.1,0\n1,0.3,0\n", NULL},
    {"indented_comment", " # a comment\n0,0.1,0\n1,0.3,0\n", NULL},
    {"byte_order_mark",
     "\xef\xbb\xbf"
     "0,0.1,0\n1,0.3,0\n",
     NULL},
    {"mark_before_names", "\xef\xbb\xbft,x,y\r\n0,0.1,0\r\n1,0.3,0\r\n", NULL},
    {"refuse_other_mark",
     "\xff\xfe"
     "0,0.1,0\n0.5,0.1,0\n1,0.3,0\n",
     "line 1"},
    {"refuse_semicolons", "0;0.1;0\n0,0.1,0\n1,0.3,0\n", "line 1"},
    {"refuse_quoted_numbers", "\"-1\",\"0\",\"0\"\n0,0.1,0\n1,0.3,0\n", "line 1"},
    {"refuse_a_letter_among", "O,0.2,0\n0.5,0.1,0\n1,0.3,0\n", "line 1"},
    {"refuse_signs_of_print",
     "\xe2\x88\x92"
     "1,0,0\n0,0.1,0\n1,0.3,0\n",
     "line 1"},
    {"refuse_what_is_no_number", "nan,0,0\n0,0.1,0\n1,0.3,0\n", "line 1"},
    {"refuse_names_twice", "t,x,y\ns,m,m\n0,0.1,0\n1,0.3,0\n", "line 2"},
    {"refuse_names_later", "0,0.1,0\nt,x,y\n1,0.3,0\n", "line 2"},
    {"refuse_a_jump", "0,0.1,0\n1,0.1,0\n1.000000001,0.3,0\n", "m/s are allowed"},
    {"refuse_far_places", "0,0.1,0\n1,1e300,0\n", "m/s are allowed"},
    {"refuse_far_times", "-1.7e308,0,0\n1.7e308,1,0\n", "line 1"},
  };

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(files); k++) {
    PetscReal x[DIM] = {0.1, 0, 0}, y[DIM] = {0.1, 0, 0};
    Domain    domain;
    Scene     scene;

    PetscCall(WriteTable(files[k].text));
    if (files[k].refusal) {
      PetscCall(Refused(MOVING, files[k].refusal, files[k].name));
      continue;
    }
    PetscCall(Read(MOVING, &domain, &scene));
    BodyMove(SceneSolid(scene, 0), 1, 0, x);
    BodyMove(SceneSolid(scene, 0), 0, 1, y);
    CHECK(PetscAbsReal(x[0] + 0.1) < 1e-12 && PetscAbsReal(y[0] - 0.3) < 1e-12, files[k].name);
    PetscCall(Free(&domain, &scene));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A solid that moves in every way: its points stay the same distance apart, come back, and have the velocity of the
   differences of their places; the distance to it goes with it. */
/* Within a reach the distance is that of SceneSolidDistance wherever the solid has gone: 'miss' is the largest
   difference on a lattice over the box and around it. */
static PetscReal WithinReach(Scene scene, PetscReal reach)
{
  PetscReal miss = 0;

  for (PetscInt k = 0; k < 21 * 21 * 21; k++) {
    const PetscReal x[DIM]  = {-2 + 0.2 * (PetscReal)(k % 21), -2 + 0.2 * (PetscReal)(k / 21 % 21),
                               -2 + 0.2 * (PetscReal)(k / 441)};
    PetscInt        nearest = -1;
    const PetscReal s = SceneSolidDistance(scene, x, NULL), got = SceneSolidWithin(scene, reach, x, &nearest);

    miss = PetscMax(miss, PetscAbsReal(got - PetscMin(s, reach)) + (PetscReal)((nearest == 0) != (s < reach)));
  }
  return miss;
}

static PetscErrorCode TestMotion(void)
{
  const char *const options = CUBE "-bodies a -a_upper 1,1,-0.9 -solids s -s_lower -0.3,-0.2,-0.1 -s_upper 0.3,0.2,0.1 "
                                   "-s_velocity 0.1,0,0 -s_oscillation_amplitude 0,0.2,0 -s_oscillation_frequency 2 "
                                   "-s_oscillation_phase -90 -s_rotation_rate 1,2,-2 -s_rotation_center 0.1,0,0";
  const PetscReal   t = 0.37, step = 1e-5, corner[DIM] = {0.3, 0.2, 0.1};
  PetscReal x[DIM] = {0.3, 0.2, 0.1}, low[DIM], high[DIM], v[DIM], out[DIM] = {0.5, 0.2, 0.1}, error = 0, r2 = 0;
  Domain    domain;
  Scene     scene;
  Body      solid;

  PetscFunctionBegin;
  PetscCall(Read(options, &domain, &scene));
  solid = SceneSolid(scene, 0);
  CHECK(BodyMoves(solid) && SceneSolidsMove(scene), "solid_moves");
  BodyMove(solid, 0, t, x);
  for (PetscInt d = 0; d < DIM; d++) {
    low[d] = high[d]          = x[d];
    const PetscReal from_axis = x[d] - (d == 0   ? 0.1 + 0.1 * t
                                        : d == 1 ? 0.2 * (1 - PetscCosReal(4 * PETSC_PI * t))
                                                 : 0);

    r2 += from_axis * from_axis;
  }
  CHECK_CLOSE(r2, 0.04 + 0.04 + 0.01, 1e-12, "motion_is_rigid");
  BodyMove(solid, t, t - step, low);
  BodyMove(solid, t, t + step, high);
  BodyMotion(solid, t, x, v);
  for (PetscInt d = 0; d < DIM; d++) error = PetscMax(error, PetscAbsReal((high[d] - low[d]) / (2 * step) - v[d]));
  CHECK_CLOSE(error, 0, 1e-7, "velocity_of_a_motion");
  CHECK(Norm(v) <= SceneSolidSpeed(scene) && Norm(v) > 0.1 * SceneSolidSpeed(scene), "speed_bounds_a_motion");
  SceneMoveSolids(scene, t);
  BodyMove(solid, 0, t, out);
  CHECK_CLOSE(SceneSolidDistance(scene, x, NULL), 0, 1e-12, "distance_goes_with_a_solid");
  CHECK_CLOSE(SceneSolidDistance(scene, out, NULL), 0.2, 1e-12, "distance_from_a_solid");
  CHECK_CLOSE(WithinReach(scene, 0.25), 0, 1e-15, "distance_within_a_reach");
  BodyMove(solid, t, 0, x);
  for (PetscInt d = 0; d < DIM; d++) error = PetscMax(error, PetscAbsReal(x[d] - corner[d]) * 1e5);
  CHECK_CLOSE(error, 0, 1e-7, "motion_back");
  PetscCall(Free(&domain, &scene));
  PetscCall(TestTable());
  PetscCall(TestStop());
  PetscCall(TestTableText());
  PetscCall(TestAngles());
  PetscCall(Refused(CUBE BALL "-solids s -s_upper -0.9,1,1 -s_velocity 0,0,1e300", "m/s are allowed", "refuse_speed"));
  PetscCall(Refused(CUBE BALL "-solids s -s_upper -0.9,1,1 -s_rotation_rate 0,0,1e9", "m/s are allowed",
                    "refuse_speed_of_a_turn"));
  PetscCall(Refused(CUBE BALL "-solids s -s_upper -0.9,1,1 -s_oscillation_amplitude 0,0,1e-3 "
                              "-s_oscillation_frequency 1e300",
                    "m/s are allowed", "refuse_speed_of_an_oscillation"));
  /* a quarter turn about z in the plane: x goes to y */
  PetscCall(Read(SQUARE BALL "-a_radius 0.1 -a_center 0.8,0.8 -solids s -s_lower 0,0 -s_upper 0.3,0.1 -s_rotation_rate "
                             "3.14159265358979",
                 &domain, &scene));
  x[0] = 0.3;
  x[1] = x[2] = 0;
  BodyMove(SceneSolid(scene, 0), 0, 0.5, x);
  CHECK(PetscAbsReal(x[0]) < 1e-12 && PetscAbsReal(x[1] - 0.3) < 1e-12, "turn_of_a_quarter");
  PetscCall(Free(&domain, &scene));
  PetscCall(
    Refused(CUBE BALL "-solids s -s_upper -0.9,1,1 -s_rotation_rate 3", "three numbers", "refuse_rate_of_solid"));
  PetscCall(Refused(CUBE BALL "-solids s -s_upper -0.9,1,1 -s_oscillation_amplitude 1,0,0", "-s_oscillation_frequency",
                    "refuse_no_frequency"));
  PetscCall(Refused("-dimension axisymmetric -spacing 0.1 -box_lower 0,-1 -box_upper 1,1 " BALL
                    "-a_radius 0.2 -solids s -s_upper 1,-0.9 -s_velocity 1,0",
                    "along the axis only", "refuse_motion_of_rings"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define FLOAT CUBE "-bodies a -a_upper 1,1,-0.9 -solids s -s_lower -0.3,-0.2,-0.1 -s_upper 0.3,0.4,0.3 "

/* A free box turns about its centre with its own moments of inertia: without a torque it keeps its angular momentum
   and, to the order of the step, its energy; the place of a point and its velocity agree; a state that was kept comes
   back.
 */
static PetscErrorCode TestFree(void)
{
  const PetscReal dt = 1e-3, push[RIGID_MOTIONS] = {1.2, 0, 2.4, 0, 0.5, 0}, none[RIGID_MOTIONS] = {0, 0, 0, 0, 0, 0};
  PetscReal center[DIM], motion[RIGID_MOTIONS], change[RIGID_MOTIONS], x[DIM], high[DIM], v[DIM], kinetic, time = 0,
                                                                                                           error = 0;
  PetscInt   count;
  PetscReal *numbers;
  Domain     domain;
  Scene      scene;
  Body       solid;

  PetscFunctionBegin;
  PetscCall(Read(FLOAT "-s_mass 12 -s_velocity 0.1,0,0 -s_rotation_rate 0.3,4,0.2", &domain, &scene));
  solid = SceneSolid(scene, 0);
  CHECK(SceneHasFree(scene) && BodyMass(solid) == 12, "free_body");
  FreeMotion(solid, center, motion);
  CHECK(PetscAbsReal(center[0]) < 1e-12 && PetscAbsReal(center[1] - 0.1) < 1e-12 &&
          PetscAbsReal(center[2] - 0.1) < 1e-12,
        "centre_of_a_box");
  /* 12 kg, 0.6 m by 0.6 m by 0.4 m: (0.36 + 0.16), twice, and (0.36 + 0.36) kg m2 */
  FreeResponse(solid, push, change);
  CHECK_CLOSE(change[0], 0.1, 1e-12, "push_of_a_mass");
  CHECK_CLOSE(change[4], 0.5 / 0.52, 1e-3, "inertia_of_a_box");
  SceneSave(scene);
  kinetic = FreeKinetic(solid);
  CHECK_CLOSE(kinetic / (0.5 * (12 * 0.01 + 0.52 * (0.09 + 16) + 0.72 * 0.04)), 1, 1e-3, "energy_of_a_box");
  numbers = FreeNumbers(solid, &count);
  for (PetscInt k = 0; k < 2000; k++) {
    time += dt;
    SceneMoveSolids(scene, time);
    FreePush(solid, time, none);
  }
  CHECK_CLOSE(FreeKinetic(solid) / kinetic, 1, 1e-3, "free_energy");
  FreeMotion(solid, center, motion);
  CHECK_CLOSE(center[0], 0.2, 1e-9, "free_drift");
  for (PetscInt d = 0; d < DIM; d++) x[d] = center[d] + 0.1 * (d + 1);
  for (PetscInt d = 0; d < DIM; d++) high[d] = x[d];
  BodyMotion(solid, time, x, v);
  BodyMove(solid, time, time + 1e-5, high);
  for (PetscInt d = 0; d < DIM; d++) error = PetscMax(error, PetscAbsReal((high[d] - x[d]) / 1e-5 - v[d]));
  CHECK_CLOSE(error, 0, 1e-4, "velocity_of_a_free_body");
  SceneFreeze(scene, PETSC_TRUE);
  BodyMotion(solid, time, x, v);
  CHECK(Norm(v) == 0, "free_body_held");
  SceneFreeze(scene, PETSC_FALSE);
  SceneRestore(scene);
  CHECK(FreeKinetic(solid) == kinetic && numbers[0] == 0, "free_body_returns");
  PetscCall(Free(&domain, &scene));
  PetscCall(Refused(FLOAT "-s_mass -1", "-s_mass", "refuse_negative_mass"));
  PetscCall(Refused(FLOAT "-s_inertia 1", "need -s_mass", "refuse_inertia_without_mass"));
  PetscCall(Refused(FLOAT "-s_mass 1 -s_inertia 1,2", "one number or three", "refuse_two_moments"));
  PetscCall(Refused(FLOAT "-s_mass 1 -s_inertia 0", "positive", "refuse_no_inertia"));
  PetscCall(Refused(FLOAT "-s_mass 1e-300", "-s_mass is 1e-300 kg; it must lie in", "refuse_no_mass"));
  PetscCall(Refused(FLOAT "-s_mass 1e-9", "-s_mass is 1e-09 kg; it must lie in", "refuse_light_mass"));
  PetscCall(Refused(FLOAT "-s_mass 1e300", "-s_mass is 1e+300 kg; it must lie in", "refuse_heavy_mass"));
  PetscCall(Refused(FLOAT "-s_mass 9 -s_inertia 1e-300", "-s_inertia has 1e-300", "refuse_little_inertia"));
  PetscCall(Refused(FLOAT "-s_mass 9 -s_inertia 1,1,1e300", "-s_inertia has 1e+300", "refuse_large_inertia"));
  PetscCall(Refused(FLOAT "-s_mass 9 -s_velocity 0,1e300,0", "m/s are allowed", "refuse_speed_of_free_body"));
  PetscCall(Refused(FLOAT "-s_mass 9 -s_rotation_center 0,9,0", "-s_rotation_center", "refuse_centre_far_away"));
  PetscCall(Refused(FLOAT "-s_mass 9 -s_rotation_center 0,1e300,0", "-s_rotation_center", "refuse_centre_nowhere"));
  PetscCall(Read(FLOAT "-s_mass 2e-3", &domain, &scene)); /* a bubble of air may be light, an anchor heavy */
  PetscCall(Free(&domain, &scene));
  PetscCall(Read(FLOAT "-s_mass 1e11", &domain, &scene));
  PetscCall(Free(&domain, &scene));
  PetscCall(Refused(FLOAT "-s_mass 1 -s_turns 0 -s_rotation_rate 1,0,0", "-s_turns 0", "refuse_rate_of_no_turn"));
  PetscCall(Refused(FLOAT "-s_mass 1 -s_oscillation_amplitude 1,0,0 -s_oscillation_frequency 1", "cannot be used",
                    "refuse_two_ways_of_moving"));
  PetscCall(Refused(FLOAT "-s_mass 1 -s_upper 0.3,0.4,1.3", "wholly in the box", "refuse_free_body_outside"));
  PetscCall(Refused(FLOAT "-s_mass 1 -box_xmin symmetry", "symmetry face -box_xmin", "refuse_free_body_and_mirror"));
  PetscCall(Refused("-dimension axisymmetric -spacing 0.1 -box_lower 0,-1 -box_upper 1,1 " BALL
                    "-a_radius 0.2 -solids s -s_upper 1,-0.8 -s_lower 0,-0.9 -s_mass 1 -s_inertia 1",
                    "along the axis only", "refuse_turning_rings"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves a free body that no torque acts on to a time (s) in steps. */
static void Spin(Scene scene, PetscReal end, PetscInt steps)
{
  const PetscReal none[RIGID_MOTIONS] = {0, 0, 0, 0, 0, 0};

  for (PetscInt k = 1; k <= steps; k++) {
    SceneMoveSolids(scene, end * (PetscReal)k / (PetscReal)steps);
    FreePush(SceneSolid(scene, 0), end * (PetscReal)k / (PetscReal)steps, none);
  }
  SceneMoveSolids(scene, end);
}

/* A vector x turned by an angle about an axis of any length, after Rodrigues. */
static void Turned(const PetscReal x[DIM], const PetscReal axis[DIM], PetscReal angle, PetscReal out[DIM])
{
  const PetscReal c = PetscCosReal(angle), s = PetscSinReal(angle), along = Dot(axis, x) / Dot(axis, axis);
  PetscReal       across[DIM];

  Cross(axis, x, across);
  for (PetscInt d = 0; d < DIM; d++) out[d] = c * x[d] + s / Norm(axis) * across[d] + (1 - c) * along * axis[d];
}

/* A cup of 2 kg with walls of a fiftieth of its width, 0.6 m by 0.6 m by 0.4 m, open below: the outer box less the
   inner one has its centre of mass and moments of inertia. */
static PetscErrorCode TestHollow(void)
{
  const PetscReal wall = 0.012, width = 0.6 - 2 * wall, height = 0.4 - wall, outer = 0.6 * 0.6 * 0.4,
                  inner = width * width * height, share = 2 / (outer - inner);
  const PetscReal above = (outer * 0.1 - inner * (-0.1 + height / 2)) / (outer - inner);
  const PetscReal inertia =
    share *
    (outer * ((0.36 + 0.16) / 12 + (0.1 - above) * (0.1 - above)) -
     inner * ((width * width + height * height) / 12 + (-0.1 + height / 2 - above) * (-0.1 + height / 2 - above)));
  const PetscReal push[RIGID_MOTIONS] = {0, 0, 0, 0, 1, 0};
  PetscReal       center[DIM], motion[RIGID_MOTIONS], change[RIGID_MOTIONS];
  Domain          domain;
  Scene           scene;

  PetscFunctionBegin;
  PetscCall(Read(CUBE "-bodies a -a_upper 1,1,-0.9 -solids s -s_lower -0.3,-0.3,-0.1 -s_upper 0.3,0.3,0.3 -s_mass 2 "
                      "-s_holes room -room_lower -0.288,-0.288,-0.2 -room_upper 0.288,0.288,0.288",
                 &domain, &scene));
  FreeMotion(SceneSolid(scene, 0), center, motion);
  CHECK(PetscAbsReal(center[0]) < 1e-12 && PetscAbsReal(center[1]) < 1e-12, "centre_of_a_cup");
  CHECK_CLOSE(center[2], above, 2e-3, "height_of_the_centre_of_a_cup");
  FreeResponse(SceneSolid(scene, 0), push, change);
  CHECK_CLOSE(1 / change[4], inertia, 2e-3, "inertia_of_a_cup");
  PetscCall(Free(&domain, &scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A cylinder of 2 kg about the axis n, radius 0.3 m and height 1 m, at an angle to all axes: I = A across it,
   2 (0.09/4 + 1/12), and C along it, 2 0.09/2 kg m2. What it keeps, L, turns n with L/A about it. */
static PetscErrorCode TestTilted(void)
{
  const PetscReal n[DIM] = {1. / 3, 2. / 3, -2. / 3}, rate[DIM] = {3, -1, 2}, end = 0.4, A = 2 * (0.0225 + 1. / 12),
                  C = 0.09, along = Dot(n, rate);
  PetscReal center[DIM], motion[RIGID_MOTIONS], change[RIGID_MOTIONS], L[DIM], x[DIM], due[DIM], turn[DIM],
    error = 0, angle, energy = 0;
  Domain domain;
  Scene  scene;
  Body   solid;

  PetscFunctionBegin;
  PetscCall(Read(CUBE "-bodies a -a_upper 1,1,-0.9 -solids s -s_shape cylinder -s_radius 0.3 -s_height 1 -s_center "
                      "0.1,0,0.05 -s_axis 1,2,-2 -s_mass 2 -s_velocity 0,0.5,0 -s_rotation_rate 3,-1,2",
                 &domain, &scene));
  solid = SceneSolid(scene, 0);
  for (PetscInt e = 0; e < DIM; e++) {
    PetscReal impulse[RIGID_MOTIONS] = {0, 0, 0, 0, 0, 0};

    impulse[DIM + e] = 1;
    FreeResponse(solid, impulse, change);
    for (PetscInt d = 0; d < DIM; d++) /* (1 - n n)/A + n n/C */
      error = PetscMax(error, PetscAbsReal(change[DIM + d] - ((d == e) / A + n[d] * n[e] * (1 / C - 1 / A))));
  }
  CHECK_CLOSE(error * C, 0, 0.01, "inertia_of_a_tilted_cylinder");
  energy = 0.5 * (2 * 0.25 + A * (Dot(rate, rate) - along * along) + C * along * along);
  CHECK_CLOSE(FreeKinetic(solid) / energy, 1, 3e-3, "energy_of_a_tilted_cylinder");
  for (PetscInt d = 0; d < DIM; d++) L[d] = A * rate[d] + (C - A) * along * n[d];
  Spin(scene, end, 4000);
  FreeMotion(solid, center, motion);
  FreeTurned(solid, turn);
  Turned(n, turn, Norm(turn), x);
  angle = Norm(L) / A * end;
  Turned(n, L, angle, due);
  error = 0;
  for (PetscInt d = 0; d < DIM; d++) error = PetscMax(error, PetscAbsReal(x[d] - due[d]));
  CHECK(angle > 1, "it_turns_far");
  CHECK_CLOSE(error, 0, 0.01, "the_axis_of_a_top");
  error = 0; /* the rate goes round with the axis: A rate + (C - A) (n rate) n is kept */
  for (PetscInt d = 0; d < DIM; d++)
    error = PetscMax(error, PetscAbsReal(A * motion[DIM + d] + (C - A) * Dot(due, motion + DIM) * due[d] - L[d]));
  CHECK_CLOSE(error / Norm(L), 0, 0.01, "angular_momentum_of_a_top");
  CHECK_CLOSE(FreeKinetic(solid) / energy, 1, 3e-3, "energy_of_a_top");
  PetscCall(Free(&domain, &scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moments that are given, one about each axis; the torque of a force on a body that has come a way, and how far and in
   which sense it has turned. */
static PetscErrorCode TestTorque(void)
{
  const PetscReal force[DIM] = {2, -1, 3}, arm[DIM] = {0.1, 0.2, -0.1},
                  due[RIGID_MOTIONS] = {2, -1, 3, 0.5, -0.5, -0.5}, normal[DIM] = {0, 0, 1},
                  push[RIGID_MOTIONS] = {0, 0, 0, 6, 6, 6};
  PetscReal center[DIM], motion[RIGID_MOTIONS], change[RIGID_MOTIONS], sum[RIGID_MOTIONS] = {0, 0, 0, 0, 0, 0}, x[DIM],
                                                                       angle[DIM], error = 0;
  Domain domain;
  Scene  scene;
  Body   solid;

  PetscFunctionBegin;
  PetscCall(
    Read(FLOAT "-s_mass 12 -s_inertia 1,2,3 -s_velocity 0.5,0,-0.25 -s_rotation_rate 0,0.75,0", &domain, &scene));
  solid = SceneSolid(scene, 0);
  FreeResponse(solid, push, change);
  for (PetscInt d = 0; d < DIM; d++) CHECK_CLOSE(change[DIM + d], 6. / (d + 1), 1e-12, "moments_that_are_given");
  CHECK_CLOSE(FreeKinetic(solid), 6 * 0.3125 + 0.5 * 2 * 0.5625, 1e-12, "energy_with_moments_that_are_given");
  Spin(scene, 0.4, 8);
  FreeMotion(solid, center, motion);
  CHECK(PetscAbsReal(center[0] - 0.2) < 1e-12 && PetscAbsReal(center[2]) < 1e-12, "it_has_come_a_way");
  FreeTurned(solid, angle);
  CHECK(PetscAbsReal(angle[1] - 0.3) < 1e-12 && PetscAbsReal(angle[0]) + PetscAbsReal(angle[2]) < 1e-12,
        "turned_by_0.3");
  for (PetscInt d = 0; d < DIM; d++) x[d] = center[d] + arm[d];
  FreeAddForce(solid, x, force, NULL, sum);
  for (PetscInt k = 0; k < RIGID_MOTIONS; k++) error = PetscMax(error, PetscAbsReal(sum[k] - due[k]));
  CHECK_CLOSE(error, 0, 1e-12, "torque_about_the_centre");
  for (PetscInt k = 0; k < RIGID_MOTIONS; k++) sum[k] = 0;
  FreeAddForce(solid, x, force, normal, sum); /* only the normal part (0.2 3, -0.1 3, 0) turns */
  CHECK(PetscAbsReal(sum[DIM] - 0.6) < 1e-12 && PetscAbsReal(sum[DIM + 1] + 0.3) < 1e-12 &&
          PetscAbsReal(sum[DIM + 2]) < 1e-12 && sum[0] == 2,
        "torque_along_a_normal");
  PetscCall(Free(&domain, &scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest frequency of what swings in a scene. A table that turns often enough has one, whatever its noise; a pulse
   has none. */
static PetscErrorCode TestFrequency(void)
{
  static const struct {
    const char *name, *options;
    PetscReal   due; /* Hz */
  } cases[] = {{"nothing", "-s_velocity 1,0", 0},
               {"gravity", "-s_velocity 1,0 -gravity_amplitude 0,1 -gravity_frequency 7", 7},
               {"oscillation", "-s_oscillation_amplitude 0,0.01 -s_oscillation_frequency 5", 5},
               {"rotation", "-s_rotation_rate 3.141592653589793", 0.5},
               {"emitter", "-a_type emitter -a_velocity 0.1,0 -a_modulation 0.1 -a_modulation_frequency 20", 20},
               {"table", "-s_motion_file " TABLE, 2},
               {"speeds", "-a_type emitter -a_velocity 0.1,0 -a_velocity_file " TABLE, 2},
               {"pulse", "-s_motion_file " TABLE, 0}};
  char text[4096], name[64];

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(cases); k++) {
    const PetscBool speeds = (PetscBool)(cases[k].options[3] == 't'), pulse = (PetscBool)(cases[k].name[0] == 'p');
    Domain          domain;
    Scene           scene;

    text[0] = 0;
    for (PetscInt row = 0; row <= 100; row++) { /* 2 Hz from 0.6 s on, and noise */
      const PetscReal t = 0.02 * (PetscReal)row, noise = row % 2 ? 1e-5 : 0,
                      swing = pulse ? (row >= 40 && row < 50 ? 0.01 : 0)
                                    : (t > 0.6 ? 0.01 * PetscSinReal(4 * PETSC_PI * (t - 0.6)) : 0);
      const size_t length   = strlen(text);

      PetscCall(PetscSNPrintf(text + length, sizeof(text) - length, speeds ? "%g,%g\n" : "%g,%g,0\n", (double)t,
                              (double)(swing + noise + 0.02)));
    }
    PetscCall(WriteTable(text));
    PetscCall(PetscSNPrintf(text, sizeof(text),
                            SQUARE
                            "-bodies a -a_lower 0.5,0.5 -a_upper 0.8,0.8 -solids s -s_lower 0,0 -s_upper 0.3,0.1 "
                            "%s",
                            cases[k].options));
    PetscCall(Read(text, &domain, &scene));
    PetscCall(PetscSNPrintf(name, sizeof(name), "frequency_of_%s", cases[k].name));
    CHECK_CLOSE(SceneFrequency(scene), cases[k].due, 0.05 * cases[k].due, name);
    PetscCall(Free(&domain, &scene));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(UserErrorHandlerPush());
  PetscCall(TestTilted());
  PetscCall(TestHollow());
  PetscCall(TestTorque());
  PetscCall(TestMotion());
  PetscCall(TestFree());
  PetscCall(TestFrequency());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
