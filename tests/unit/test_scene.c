/* Bodies: shapes and their distances, velocity fields, materials, refusals. */
#include "../../src/scene/scene_impl.h"
#include "read_scene.h"
#include <stdarg.h>

#define SAMPLES 2000

/* Distance of one point to the first body of a scene. */
static PetscErrorCode CheckDistance(const char options[], PetscReal x, PetscReal y, PetscReal z, PetscReal expected,
                                    const char name[])
{
  const PetscReal point[DIM] = {x, y, z};
  Domain          domain;
  Scene           scene;

  PetscFunctionBegin;
  PetscCall(Read(options, &domain, &scene));
  CHECK_CLOSE(BodyDistance(SceneBody(scene, 0), point), expected, 1e-12, name);
  PetscCall(Free(&domain, &scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Random pairs of points: a distance changes by no more than the way between them, and its gradient has length one;
   points of the body are within its bounds. */
static PetscErrorCode CheckShape(const char options[], const char name[])
{
  Domain    domain;
  Scene     scene;
  Body      body;
  PetscReal lower[DIM], upper[DIM], worst = 0, slope = 0;
  PetscBool held   = PETSC_TRUE;
  PetscInt  inside = 0;
  char      label[64];

  PetscFunctionBegin;
  PetscCall(Read(options, &domain, &scene));
  body = SceneBody(scene, 0);
  BodyBounds(body, lower, upper);
  for (PetscInt k = 0; k < SAMPLES; k++) {
    PetscReal x[DIM] = {0, 0, 0}, y[DIM] = {0, 0, 0}, r[DIM] = {0, 0, 0}, square = 0;

    for (PetscInt d = 0; d < domain->dim; d++) {
      x[d] = 3 * RandomUnit(1, (unsigned long long)(6 * k + d)) - 1.5;
      y[d] = 3 * RandomUnit(1, (unsigned long long)(6 * k + d + 3)) - 1.5;
      r[d] = x[d] - y[d];
    }
    worst = PetscMax(worst, PetscAbsReal(BodyDistance(body, x) - BodyDistance(body, y)) / Norm(r));
    for (PetscInt d = 0; d < domain->dim; d++) {
      PetscReal up[DIM] = {x[0], x[1], x[2]}, down[DIM] = {x[0], x[1], x[2]};

      up[d] += 1e-6;
      down[d] -= 1e-6;
      square += PetscSqr((BodyDistance(body, up) - BodyDistance(body, down)) / 2e-6);
    }
    if (PetscAbsReal(PetscSqrtReal(square) - 1) < 1e-4) slope += 1. / SAMPLES; /* all but those next to a ridge */
    if (BodyContains(body, x)) {
      inside++;
      for (PetscInt d = 0; d < DIM; d++) held = held && x[d] >= lower[d] && x[d] <= upper[d];
    }
  }
  PetscCall(PetscSNPrintf(label, sizeof(label), "%s_lipschitz", name));
  CHECK(worst <= 1 + 1e-9, label);
  PetscCall(PetscSNPrintf(label, sizeof(label), "%s_slope", name));
  CHECK_CLOSE(slope, 1, 1e-2, label);
  PetscCall(PetscSNPrintf(label, sizeof(label), "%s_bounds", name));
  CHECK(held && inside > 0, label);
  PetscCall(Free(&domain, &scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestShapes(void)
{
  const char ellipsoid[] = CUBE "-bodies a -a_shape ellipsoid -a_radii 0.8,0.4,0.2 ";
  const char can[]       = CUBE "-bodies a -a_shape cylinder -a_radius 0.5 -a_height 0.6 -a_center 0,0,0.1 ";
  const char half[]      = CUBE "-bodies a -a_shape half_space -a_point 0,0,0.2 ";

  PetscFunctionBegin;
  PetscCall(CheckShape(CUBE "-bodies a -a_lower -0.5,-0.3,-0.8", "box"));
  PetscCall(CheckShape(CUBE BALL "-a_center 0.7,0.1,0", "sphere"));
  PetscCall(CheckShape(CUBE "-bodies a -a_shape cylinder -a_radius 0.5 -a_axis 1,-2,3 -a_height 0.9", "cylinder"));
  PetscCall(CheckShape(CUBE "-bodies a -a_shape cylinder -a_radius 0.5 -a_axis 0,-1,0", "infinite_cylinder"));
  PetscCall(CheckShape(ellipsoid, "ellipsoid"));
  PetscCall(CheckShape(CUBE "-bodies a -a_shape ellipsoid -a_radii 0.3,0.7,0.3", "prolate"));
  PetscCall(CheckShape(CUBE "-bodies a -a_shape half_space -a_normal 1,-1,0.5 -a_point 0.1,0,0", "half_space"));
  PetscCall(CheckShape(SQUARE "-bodies a -a_shape ellipsoid -a_radii 0.3,0.7", "ellipse"));
  PetscCall(CheckShape(SQUARE "-bodies a -a_shape cylinder -a_radius 0.2 -a_axis y", "strip"));
  PetscCall(CheckShape(CUBE "-bodies a -a_shape wave -a_wave_amplitude 0.1 -a_upper 1,1,0.3", "wave"));
  PetscCall(
    CheckShape(SQUARE "-bodies a -a_shape wave -a_wave_amplitude -0.05 -a_wave_length 0.8 -a_upper 1,0", "wave_2d"));
  PetscCall(CheckDistance(CUBE "-bodies a", 0.2, 0, 0, -0.8, "box_default_is_the_box"));
  PetscCall(CheckDistance(CUBE "-bodies a -a_upper 0,0,0", 3, 4, -0.5, 5, "box_edge"));
  PetscCall(CheckDistance(CUBE BALL, 3, 4, 0, 4.5, "sphere_outside"));
  PetscCall(CheckDistance(SQUARE BALL "-a_center 0,0,9", 0, 0.3, 5, -0.2, "circle_ignores_z"));
  PetscCall(CheckDistance(can, 0.5 + 0.3, 0, 0.4 + 0.4, 0.5, "cylinder_rim"));
  PetscCall(CheckDistance(can, 0, 0, 0.3, -0.1, "cylinder_end"));
  PetscCall(
    CheckDistance(SQUARE "-bodies a -a_shape cylinder -a_radius 0.5 -a_height 0.01", 0, 0, 0, -0.5, "cylinder_2d"));
  PetscCall(CheckDistance(half, 0.4, -0.3, 0.5, 0.3, "half_space_up"));
  PetscCall(
    CheckDistance(SQUARE "-bodies a -a_shape half_space -a_normal -1,0", 0.4, -0.3, 0.5, -0.4, "half_space_2d"));
  PetscCall(
    CheckShape(CUBE BALL "-a_holes b,c -b_shape sphere -b_radius 0.2 -b_center 0.2,0,0 -c_lower 0.2,-2,-2", "holes"));
  PetscCall(CheckDistance(CUBE BALL "-a_holes b -b_shape sphere -b_radius 0.2", 0.1, 0, 0, 0.1, "inside_a_hole"));
  PetscCall(CheckDistance(CUBE BALL "-a_holes b -b_shape sphere -b_radius 0.2", 0, 0.25, 0, -0.05, "beside_a_hole"));
  PetscCall(CheckDistance(ellipsoid, 0, 0, 0, -0.2, "ellipsoid_center"));
  PetscCall(CheckDistance(ellipsoid, 1.8, 0, 0, 1, "ellipsoid_along_x"));
  PetscCall(CheckDistance(ellipsoid, 0, 0, -0.3, 0.1, "ellipsoid_along_z"));
  PetscCall(CheckDistance(ellipsoid, 0, 0.39, 0, -0.01, "ellipsoid_mid_plane_near_tip"));
  /* On the long axis, deep inside: the nearest point is above or below, d^2 = c^2 (1 - x^2/(a^2 - c^2)). */
  PetscCall(CheckDistance(ellipsoid, 0.3, 0, 0, -0.2 * PetscSqrtReal(1 - 0.09 / 0.6), "ellipsoid_mid_plane_deep"));
  PetscCall(
    CheckDistance(ellipsoid, 0.3, 0, 1e-17, -0.2 * PetscSqrtReal(1 - 0.09 / 0.6), "ellipsoid_next_to_mid_plane"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A lattice of small cells, displaced: the level goes to the top, bottom and sides to themselves, and the area of a
   cell, by the cross product of its displaced edges, stays. */
static PetscErrorCode TestWave(void)
{
  const char      wave[] = SQUARE "-bodies a -a_shape wave -a_wave_amplitude 0.02 -a_wave_length 2 -a_upper 1,0 ";
  const PetscReal k = PETSC_PI, second = 0.5 * k * 4e-4 / PetscTanhReal(k), cell = 1e-4;
  PetscReal       top = 0, bottom = 0, side = 0, area = 0;
  Domain          domain;
  Scene           scene;

  PetscFunctionBegin;
  PetscCall(Read(wave, &domain, &scene));
  for (PetscInt n = 0; n <= 40; n++) {
    const PetscReal s            = -1 + n / 20.;
    PetscReal       x[3][DIM]    = {{s, 0, 0}, {s, -1, 0}, {-1, s, 0}};
    PetscReal       edge[4][DIM] = {{s - cell, -0.2, 0}, {s + cell, -0.2, 0}, {s, -0.2 - cell, 0}, {s, -0.2 + cell, 0}};

    for (PetscInt p = 0; p < 3; p++) BodyDisplace(SceneBody(scene, 0), x[p]);
    for (PetscInt p = 0; p < 4; p++) BodyDisplace(SceneBody(scene, 0), edge[p]);
    top    = PetscMax(top, PetscAbsReal(BodyDistance(SceneBody(scene, 0), x[0])));
    bottom = PetscMax(bottom, PetscAbsReal(x[1][1] + 1));
    side   = PetscMax(side, PetscAbsReal(x[2][0] + 1));
    area   = PetscMax(area, PetscAbsReal(((edge[1][0] - edge[0][0]) * (edge[3][1] - edge[2][1]) -
                                        (edge[1][1] - edge[0][1]) * (edge[3][0] - edge[2][0])) /
                                           (4 * cell * cell) -
                                         1));
  }
  CHECK_CLOSE(top, 0, 1e-4, "wave_level_goes_to_the_top");
  CHECK_CLOSE(bottom + side, 0, 1e-12, "wave_keeps_bottom_and_sides");
  CHECK_CLOSE(area, 0, 1e-6, "wave_keeps_areas");
  PetscCall(Free(&domain, &scene));
  PetscCall(CheckDistance(wave, -1, 0.02 + second + 0.2, 0, 0.2, "wave_above_a_crest"));
  PetscCall(CheckDistance(wave, 0, -0.02 + second - 0.1, 0, -0.1, "wave_below_a_trough"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The wave of a body at one point of its undisplaced surface: it moves by 'moved' across, to first order, and is on the
   surface then; around it and half way to the center the map keeps volumes, of rings whole ones. */
static PetscErrorCode CheckWave(const char options[], PetscReal x, PetscReal y, PetscReal z, PetscReal moved_x,
                                PetscReal moved_y, PetscReal moved_z, const char name[])
{
  const PetscReal start[DIM] = {x, y, z}, moved[DIM] = {moved_x, moved_y, moved_z}, step = 1e-4;
  PetscReal       at[DIM] = {x, y, z}, error = 0, worst = 0;
  char            label[64];
  Domain          domain;
  Scene           scene;
  Body            body;

  PetscFunctionBegin;
  PetscCall(Read(options, &domain, &scene));
  body = SceneBody(scene, 0);
  BodyDisplace(body, at);
  for (PetscInt d = 0; d < DIM; d++) error = PetscMax(error, PetscAbsReal(at[d] - start[d] - moved[d]));
  PetscCall(PetscSNPrintf(label, sizeof(label), "%s_moves", name));
  CHECK(error < 0.05 * Norm(moved), label);
  PetscCall(PetscSNPrintf(label, sizeof(label), "%s_surface", name));
  CHECK_CLOSE(BodyDistance(body, at), 0, 1e-8, label);
  for (PetscInt half = 0; half < 2; half++) {
    PetscReal J[DIM][DIM] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, center[DIM] = {0, 0, 0}, volume;

    for (PetscInt d = 0; d < DIM; d++) center[d] = start[d] * (half ? 0.5 : 1) + (d < domain->dim ? 0.03 : 0);
    for (PetscInt d = 0; d < domain->dim; d++) {
      PetscReal up[DIM] = {center[0], center[1], center[2]}, down[DIM] = {center[0], center[1], center[2]};

      up[d] += step;
      down[d] -= step;
      BodyDisplace(body, up);
      BodyDisplace(body, down);
      for (PetscInt i = 0; i < DIM; i++) J[i][d] = (up[i] - down[i]) / (2 * step);
    }
    volume = J[0][0] * (J[1][1] * J[2][2] - J[1][2] * J[2][1]) - J[0][1] * (J[1][0] * J[2][2] - J[1][2] * J[2][0]) +
             J[0][2] * (J[1][0] * J[2][1] - J[1][1] * J[2][0]);
    if (domain->rings) {
      const PetscReal r = center[0];

      BodyDisplace(body, center);
      volume *= center[0] / r;
    }
    worst = PetscMax(worst, PetscAbsReal(volume - 1));
  }
  PetscCall(PetscSNPrintf(label, sizeof(label), "%s_keeps_volumes", name));
  CHECK_CLOSE(worst, 0, 1e-6, label);
  PetscCall(Free(&domain, &scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Spheres with waves; tanks and threads of rings. */
static PetscErrorCode TestWaves(void)
{
  const char rings[] = "-dimension axisymmetric -spacing 0.1 -box_lower 0,-1 -box_upper 1,1 -bodies a ";
  const char tank[] = "-a_shape wave -a_wave_amplitude 0.01 -a_upper 1,0 ", ball[] = "-a_shape sphere -a_radius 0.5 ",
             thread[] = "-a_shape thread -a_radius 0.5 -a_wave_length 2 -a_wave_amplitude 0.01 -box_y periodic ";
  char scene[512];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(scene, sizeof(scene), "%s%s", rings, tank));
  PetscCall(CheckWave(scene, 0, 0, 0, 0, 0.01, 0, "tank_of_rings_axis"));
  PetscCall(CheckWave(scene, 1, 0, 0, 0, -0.01 * 0.402759, 0, "tank_of_rings_wall")); /* J0 at the zero of J1 */
  PetscCall(PetscSNPrintf(scene, sizeof(scene), "%s%s", rings, thread));
  PetscCall(CheckWave(scene, 0.5, 0, 0, 0.01, 0, 0, "thread_of_rings_crest"));
  PetscCall(CheckWave(scene, 0.5, 1, 0, -0.01, 0, 0, "thread_of_rings_trough"));
  PetscCall(PetscSNPrintf(scene, sizeof(scene), "%s%s-a_wave_mode 3 -a_wave_amplitude 0.003", rings, ball));
  PetscCall(CheckWave(scene, 0, 0.5, 0, 0, 0.003, 0, "third_mode_pole"));
  PetscCall(CheckWave(scene, 0, -0.5, 0, 0, 0.003, 0, "third_mode_lower_pole"));
  PetscCall(CheckWave(scene, 0.5, 0, 0, 0, -0.0015, 0, "third_mode_equator")); /* S3 = z^3 - 1.5 z r^2 */
  PetscCall(CheckWave(CUBE BALL "-a_wave_amplitude 0.003", 0, 0, 0.5, 0, 0, 0.003, "second_mode_pole"));
  PetscCall(CheckWave(CUBE BALL "-a_wave_amplitude 0.003", 0.3, 0.4, 0, -0.0009, -0.0012, 0, "second_mode_equator"));
  PetscCall(Refused(SQUARE BALL "-a_wave_amplitude 0.003", "needs three dimensions", "refuse_wave_of_a_circle"));
  PetscCall(Refused(CUBE BALL "-a_wave_amplitude 0.11", "must be at most 0.1 m", "refuse_steep_wave"));
  PetscCall(
    Refused(SQUARE "-bodies a -a_shape thread -a_radius 0.5 -a_wave_length 2", "or rings", "refuse_plane_thread"));
  PetscCall(PetscSNPrintf(scene, sizeof(scene), "%s%s-a_wave_length 1.5", rings, tank));
  PetscCall(Refused(scene, "cannot be used", "refuse_wave_length_of_rings"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Velocity of the first body at one point. */
static PetscErrorCode CheckVelocity(const char options[], const PetscReal x[DIM], PetscReal u, PetscReal v, PetscReal w,
                                    const char name[])
{
  const PetscReal expected[DIM] = {u, v, w};
  PetscReal       got[DIM], error[DIM];
  Domain          domain;
  Scene           scene;

  PetscFunctionBegin;
  PetscCall(Read(options, &domain, &scene));
  BodyVelocity(SceneBody(scene, 0), x, got);
  for (PetscInt d = 0; d < DIM; d++) error[d] = got[d] - expected[d];
  CHECK_CLOSE(Norm(error), 0, 1e-12, name);
  PetscCall(Free(&domain, &scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestVelocities(void)
{
  const PetscReal x[DIM] = {0.3, 0.2, -0.1}, p[DIM] = {0.3, 0.2, 0}, k = 2 * PETSC_PI;

  PetscFunctionBegin;
  PetscCall(CheckVelocity(CUBE BALL, x, 0, 0, 0, "velocity_at_rest"));
  PetscCall(CheckVelocity(CUBE BALL "-a_velocity 1,2,3", x, 1, 2, 3, "velocity_uniform"));
  PetscCall(CheckVelocity(
    CUBE BALL "-a_velocity 1,2,3 -a_velocity_type rotation -a_rotation_rate 1,2,3 -a_rotation_center 0.1,0,0", x,
    1 + (2 * -0.1 - 3 * 0.2), 2 + (3 * 0.2 - 1 * -0.1), 3 + (1 * 0.2 - 2 * 0.2), "velocity_rotation_and_uniform"));
  PetscCall(CheckVelocity(SQUARE BALL "-a_velocity_type rotation -a_rotation_rate -2", p, 0.4, -0.6, 0,
                          "velocity_square_patch"));
  PetscCall(CheckVelocity(SQUARE BALL "-a_velocity_type strain -a_strain_rate -100,100", p, -30, 20, 0,
                          "velocity_stretching_drop"));
  PetscCall(CheckVelocity(CUBE BALL
                          "-a_velocity_type strain -a_strain_rate 1,2,3,4,5,6,7,8,-6 -a_strain_center 0,0,0.1",
                          x, 0.1, 1, 4.9, "velocity_full_strain"));
  PetscCall(CheckVelocity(CUBE BALL "-a_velocity_type strain -a_strain_rate 0,0,10,0,0,0,0,0,0 -a_strain_center 0,0,-1 "
                                    "-a_velocity 0,1,0",
                          x, 9, 1, 0, "velocity_shear"));
  PetscCall(
    CheckVelocity(SQUARE BALL
                  "-a_velocity_type formula -a_velocity_formula 0-2*cos(2*pi*x)*sin(2*pi*y),2*sin(2*pi*x)*cos(2*pi*y)",
                  p, -2 * PetscCosReal(k * 0.3) * PetscSinReal(k * 0.2),
                  2 * PetscSinReal(k * 0.3) * PetscCosReal(k * 0.2), 0, "velocity_taylor_green"));
  PetscCall(CheckVelocity(CUBE BALL
                          "-a_velocity 1,0,0 -a_velocity_type formula -a_velocity_formula "
                          "0-x^2+2*-y-(y-z)/.5,2^3^2/2^-1*step(z)+step(-z),exp(log(abs(z)))*cos(pi)+1e-1*sqrt(4)",
                          x, 1 - 0.09 - 0.4 - 0.6, 1, -0.1 + 0.2, "velocity_formulas"));
  PetscCall(CheckVelocity("-dimension axisymmetric -spacing 0.1 -box_lower 0,-1 -box_upper 1,1 " BALL
                          "-a_velocity_type formula -a_velocity_formula r*z,tanh(atan(tan(z)))+sin(r)",
                          p, 0.06, PetscTanhReal(0.2) + PetscSinReal(0.3), 0, "velocity_formulas_of_rings"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestScene(void)
{
  const PetscReal x[DIM] = {0.1, 0.2, 0.3}, drop[DIM] = {0, 0, 0.5}, outside[DIM] = {0, 0, -1.1},
                  face[DIM] = {0, 0, 0.2};
  PetscReal g[DIM], lower[DIM], upper[DIM];
  Domain    domain;
  Scene     scene;
  Body      film, ball;

  PetscFunctionBegin;
  PetscCall(Read(CUBE
                 "-bodies film,drop -film_upper 1,1,0.2 -drop_shape sphere -drop_radius 0.3 -drop_center 0,0,0.5 "
                 "-drop_density 1100 -drop_viscosity 0 -drop_tension 0.067 -gravity 0,0,-9.81 -central_force_rate 2",
                 &domain, &scene)); /* drop and film touch */
  film = SceneBody(scene, 0);
  ball = SceneBody(scene, 1);
  CHECK(SceneCount(scene) == 2 && !strcmp(BodyName(ball), "drop"), "scene_bodies");
  CHECK(BodyMaterial(film)->density == 1000 && BodyMaterial(film)->viscosity == 1e-3 &&
          BodyMaterial(film)->tension == 0,
        "material_defaults");
  CHECK(BodyMaterial(ball)->density == 1100 && BodyMaterial(ball)->viscosity == 0 &&
          BodyMaterial(ball)->tension == 0.067,
        "material_options");
  CHECK(SceneHasViscosity(scene) && SceneHasTension(scene), "scene_has");
  CHECK(BodyContains(ball, drop) && !BodyContains(film, drop), "contains");
  CHECK(BodyDistance(film, outside) > 0 && !BodyContains(film, outside), "contains_only_in_box");
  CHECK(!BodyContains(film, face) && !BodyContains(ball, face), "contains_not_the_surface");
  BodyBounds(film, lower, upper);
  CHECK(lower[2] == -1 && upper[2] == 0.2 && upper[0] == 1, "bounds_cut_by_the_box");
  SceneAcceleration(scene, x, g);
  CHECK_CLOSE(g[0], -0.4, 1e-15, "acceleration_central");
  CHECK_CLOSE(g[2], -9.81 - 1.2, 1e-14, "acceleration_gravity");
  CHECK_CLOSE(SceneForcePotential(scene, x), 9.81 * 0.3 + 2 * 0.14, 1e-14, "potential");
  PetscCall(Free(&domain, &scene));
  PetscCall(Read(CUBE BALL "-a_viscosity 0", &domain, &scene));
  CHECK(!SceneHasViscosity(scene) && !SceneHasTension(scene), "scene_has_not");
  PetscCall(Free(&domain, &scene));
  /* Smaller than the spacing, between lattice points: still a body. */
  PetscCall(Read(CUBE "-bodies a -a_shape sphere -a_radius 0.01", &domain, &scene));
  CHECK(SceneCount(scene) == 1, "tiny_body");
  PetscCall(Free(&domain, &scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* mu at a shear rate, Pa s. */
static PetscErrorCode CheckModel(const char options[], PetscReal rate, PetscReal due, const char name[])
{
  Domain domain;
  Scene  scene;

  PetscFunctionBegin;
  PetscCall(Read(options, &domain, &scene));
  CHECK_CLOSE(BodyViscosity(SceneBody(scene, 0), rate) / due, 1, 1e-12, name);
  PetscCall(Free(&domain, &scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The laws of src/scene/viscosity.c. */
static PetscErrorCode TestViscosityModels(void)
{
  const char *const thin           = CUBE BALL "-a_viscosity 3 -a_viscosity_model power_law -a_viscosity_exponent 0.5",
                    *const carreau = CUBE BALL "-a_viscosity 3 -a_viscosity_model carreau -a_viscosity_exponent 0.5 "
                                               "-a_viscosity_time 2 -a_viscosity_infinite 1",
                    *const                paste =
                      CUBE BALL "-a_viscosity 3 -a_viscosity_model herschel_bulkley -a_viscosity_exponent 0.5 "
                                "-a_yield_stress 7 -a_viscosity_max 1400",
                    *const bingham = CUBE BALL "-a_viscosity 3 -a_viscosity_model herschel_bulkley -a_yield_stress 7";
  Domain                                  domain;
  Scene                                   scene;

  PetscFunctionBegin;
  PetscCall(CheckModel(CUBE BALL "-a_viscosity 3", 4, 3, "newtonian"));
  PetscCall(CheckModel(thin, 4, 1.5, "power_law"));
  PetscCall(CheckModel(thin, 0, 3000, "power_law_at_rest"));
  PetscCall(CheckModel(CUBE BALL "-a_viscosity 3 -a_viscosity_model power_law -a_viscosity_exponent 1.5", 4, 6,
                       "power_law_that_thickens"));
  PetscCall(CheckModel(carreau, 0, 3, "carreau_at_rest"));
  PetscCall(CheckModel(carreau, PetscSqrtReal(15) / 2, 2, "carreau"));
  PetscCall(CheckModel(paste, 4, 7.0 / 4 + 1.5, "herschel_bulkley"));
  PetscCall(CheckModel(paste, 0.005, 7 * (1 - PetscExpReal(-1)) / 0.005 + 3 / PetscSqrtReal(0.005),
                       "herschel_bulkley_regularised"));
  PetscCall(CheckModel(paste, 0, 1400, "herschel_bulkley_at_rest"));
  PetscCall(CheckModel(bingham, 1e3, 3.007, "bingham"));
  PetscCall(CheckModel(bingham, 0, 1e4, "bingham_at_rest"));
  PetscCall(Read(bingham, &domain, &scene));
  CHECK(SceneViscosityVaries(scene) && SceneHasViscosity(scene), "viscosity_varies");
  PetscCall(Free(&domain, &scene));
  PetscCall(Refused(CUBE BALL "-a_viscosity_model jelly", "newtonian, power_law, carreau, herschel_bulkley",
                    "refuse_viscosity_model"));
  PetscCall(
    Refused(CUBE BALL "-a_viscosity_model power_law", "-a_viscosity_exponent is missing", "refuse_no_exponent"));
  PetscCall(Refused(CUBE BALL "-a_viscosity_model power_law -a_viscosity_exponent 3", "-a_viscosity_exponent is 3",
                    "refuse_exponent"));
  PetscCall(Refused(CUBE BALL "-a_viscosity_model power_law -a_viscosity_exponent 0.5 -a_viscosity 0",
                    "-a_viscosity is 0", "refuse_model_without_viscosity"));
  PetscCall(Refused(CUBE BALL "-a_viscosity_model carreau -a_viscosity_exponent 0.5", "-a_viscosity_time is missing",
                    "refuse_no_time"));
  PetscCall(Refused(CUBE BALL "-a_viscosity_model carreau -a_viscosity_exponent 0.5 -a_viscosity_time 1 "
                              "-a_viscosity_infinite 2",
                    "at most -a_viscosity", "refuse_viscosity_infinite"));
  PetscCall(Refused(CUBE BALL "-a_viscosity_model herschel_bulkley", "-a_yield_stress is missing", "refuse_no_yield"));
  PetscCall(Refused(CUBE BALL "-a_viscosity_model herschel_bulkley -a_yield_stress 1 -a_viscosity_max 1e-4",
                    "must be more than -a_viscosity", "refuse_viscosity_max"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestRefusals(void)
{
  PetscFunctionBegin;
  PetscCall(Refused(CUBE, "-bodies is missing", "refuse_no_body"));
  PetscCall(Refused(CUBE "-bodies a,a", "twice", "refuse_twice"));
  PetscCall(Refused(CUBE BALL "-a_holes a", "cannot be a hole", "refuse_hole_of_itself"));
  PetscCall(Refused(CUBE BALL "-a_holes pit -pitt_radius 0.1", "pit has no shape", "refuse_hole_without_shape"));
  PetscCall(Refused(CUBE BALL "-a_holes b -b_upper -2,0,0", "-b_upper must be above", "refuse_hole_without_size"));
  PetscCall(Refused(CUBE "-bodies 2a", "'2a' is not a name", "refuse_name"));
  PetscCall(Refused(CUBE "-bodies box", "taken", "refuse_box_name"));
  PetscCall(Refused(CUBE "-bodies a -a_shape cone", "half_space, stl, thread, wave", "refuse_shape"));
  PetscCall(Refused(CUBE BALL "-a_velocity_type spin", "formula", "refuse_velocity_type"));
  PetscCall(Refused(CUBE "-bodies a -a_shape sphere", "-a_radius is missing", "refuse_no_radius"));
  PetscCall(Refused(CUBE BALL "-a_radius -1", "-a_radius is -1; it must lie in (0, inf)", "refuse_radius"));
  PetscCall(Refused(CUBE BALL "-a_radius nan", "-a_radius is nan; it must lie in (0, inf)", "refuse_radius_nan"));
  PetscCall(Refused(CUBE "-bodies a -a_upper -2,0,0", "-a_upper must be above", "refuse_empty_box_shape"));
  PetscCall(Refused(CUBE "-bodies a -a_shape ellipsoid -a_radii 1,0,1", "-a_radii", "refuse_radii"));
  PetscCall(Refused(CUBE "-bodies a -a_shape cylinder -a_radius 1 -a_axis w", "is no direction", "refuse_axis"));
  PetscCall(Refused(CUBE "-bodies a -a_shape cylinder -a_radius 1 -a_axis 0,0,0", "not zero", "refuse_zero_axis"));
  PetscCall(Refused("-dimension axisymmetric -spacing 0.1 -box_lower 0,0 -box_upper 1,1 -bodies a -a_shape cylinder "
                    "-a_radius 0.5 -a_axis z",
                    "must be about the axis", "refuse_cylinder_across_rings"));
  PetscCall(Refused("-dimension axisymmetric -spacing 0.1 -box_lower 0,0 -box_upper 1,1 -bodies a -a_shape cylinder "
                    "-a_radius 0.5 -a_center 0.5,0",
                    "must be 0", "refuse_cylinder_off_the_axis"));
  PetscCall(Refused("-dimension axisymmetric -spacing 0.1 -box_lower 0,0 -box_upper 1,1 -bodies a -a_type emitter "
                    "-a_lower 0.4,0.4 -a_upper 0.6,0.6 -a_velocity 1,0",
                    "must leave along the axis", "refuse_emitter_away_from_the_axis"));
  PetscCall(Refused(SQUARE "-bodies a -a_shape half_space -a_normal z", "in the plane", "refuse_normal_2d"));
  PetscCall(Refused(CUBE "-bodies a -a_shape wave", "-a_wave_amplitude must be given", "refuse_no_amplitude"));
  PetscCall(Refused(CUBE "-bodies a -a_shape wave -a_wave_amplitude 0.1 -a_wave_length 0.7",
                    "whole number of half waves", "refuse_wave_length"));
  PetscCall(Refused(CUBE BALL "-a_density 0", "-a_density", "refuse_density"));
  PetscCall(Refused(CUBE BALL "-a_viscosity -1", "-a_viscosity", "refuse_viscosity"));
  PetscCall(Refused(CUBE BALL "-a_tension nan", "-a_tension", "refuse_tension"));
  PetscCall(Refused(SQUARE BALL "-gravity 0,0,-9.81", "third component", "refuse_gravity_2d"));
  PetscCall(Refused(CUBE BALL "-a_velocity_type rotation", "-a_rotation_rate is missing", "refuse_no_rate"));
  PetscCall(
    Refused(CUBE BALL "-a_velocity_type strain -a_strain_rate 1,1,1", "sum of its diagonal", "refuse_divergence"));
  PetscCall(Refused(SQUARE BALL "-a_velocity_type formula", "-a_velocity_formula is missing", "refuse_no_formula"));
  PetscCall(Refused(SQUARE BALL "-a_velocity_type formula -a_velocity_formula x", "1 formulas that can be read, not 2",
                    "refuse_one_formula"));
  PetscCall(Refused(SQUARE BALL "-a_velocity_type formula -a_velocity_formula x,y,0", "\"0\" is left",
                    "refuse_three_formulas"));
  for (const char *const *f = (const char *const[]){"z", "2x", "sin", "sin(x", "x+", "(", "x)", "cos x", "0x1f", NULL};
       *f; f++) {
    char text[256];

    PetscCall(
      PetscSNPrintf(text, sizeof(text), SQUARE BALL "-a_velocity_type formula -a_velocity_formula \"0,%s\"", *f));
    PetscCall(Refused(text, "formula", *f));
  }
  PetscCall(Refused("-dimension axisymmetric -spacing 0.1 -box_lower 0,-1 -box_upper 1,1 " BALL
                    "-a_velocity_type strain -a_strain_rate -1,1",
                    "first number counted twice for rings", "refuse_divergence_of_rings"));
  PetscCall(Refused(CUBE BALL "-a_center 5,0,0", "wholly outside", "refuse_outside"));
  PetscCall(Refused(CUBE BALL "-a_center 1.45,1.45,1.45 -spacing 0.02", "wholly outside", "refuse_outside_at_corner"));
  PetscCall(Refused(CUBE "-bodies a -a_shape half_space -a_normal 1,1,1 -a_point -1.1,-1.1,-1.1 -spacing 0.02",
                    "wholly outside", "refuse_outside_half_space"));
  PetscCall(Refused(CUBE "-bodies a,b -a_upper 1,1,0.2 -b_shape sphere -b_radius 0.3 -b_center 0,0,0.4", "overlap",
                    "refuse_overlap"));
  PetscCall(Refused(CUBE "-bodies a,b,c -a_upper 1,1,0.2 -b_lower -1,-1,0.2 -c_shape half_space", "bodies a and c",
                    "refuse_overlap_pair"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The options of all bodies and of each shape, velocity field and type are noted without a scene, with the choice that
   each belongs to. */
static PetscErrorCode TestHelp(void)
{
  static const char *const options[][2] = {{"density", ""},
                                           {"velocity", ""},
                                           {"upper", "-<body>_shape box"},
                                           {"radius", "-<body>_shape sphere"},
                                           {"height", "-<body>_shape cylinder"},
                                           {"radii", "-<body>_shape ellipsoid"},
                                           {"normal", "-<body>_shape half_space"},
                                           {"file", "-<body>_shape stl"},
                                           {"scale", "-<body>_shape stl"},
                                           {"strain_center", "-<body>_velocity_type strain"},
                                           {"velocity_formula", "-<body>_velocity_type formula"},
                                           {"yield_stress", "-<body>_viscosity_model herschel_bulkley"},
                                           {"interval", "-<body>_type emitter"},
                                           {"modulation", "-<body>_type emitter"}};
  Domain                   domain;

  PetscFunctionBegin;
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(OptionsForget());
  PetscCall(PetscOptionsSetValue(NULL, LIST_OPTION, "list.json"));
  PetscCall(DomainCreate(PETSC_COMM_WORLD, &domain));
  PetscCall(SceneHelp(domain));
  PetscCall(DomainDestroy(&domain));
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(options); k++) {
    char              option[64], name[64];
    const OptionNote *note;

    PetscCall(PetscSNPrintf(option, sizeof(option), "-<body>_%s", options[k][0]));
    PetscCall(PetscSNPrintf(name, sizeof(name), "noted_%s", options[k][0]));
    note = OptionFind(option);
    CHECK(note && note->read && !strcmp(note->owner, "<body>") && !strcmp(note->choice, options[k][1]), name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Boxes that are one box have its extent: a film of two layers, and of three. A box that covers half of a film, one of
   another liquid and an emitter do not count. */
static PetscErrorCode TestCut(void)
{
  static const char *const films[] = {
    "-bodies a,b -a_upper 1,0 -b_lower -1,0 -b_upper 1,0.5",
    "-bodies a,c,b -a_upper 1,-0.5 -b_lower -1,-0.5 -b_upper 1,0 -c_lower -1,0 -c_upper 1,0.5",
    "-bodies a,b -a_upper 1,0 -b_lower -1,0 -b_upper 0,0.5",
    "-bodies a,b -a_upper 1,0 -b_lower -1,0 -b_upper 1,0.5 -b_density 900",
    "-bodies a,b -a_upper 1,0 -b_type emitter -b_velocity 0,1 -b_lower -1,0 -b_upper 1,0.5"};
  const PetscReal high[] = {1.5, 1.5, 1, 1, 1};

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(films); k++) {
    char       options[512], name[64];
    BodyScales scales;
    Domain     domain;
    Scene      scene;

    PetscCall(PetscSNPrintf(options, sizeof(options), SQUARE "-gravity 0,-10 %s", films[k]));
    PetscCall(Read(options, &domain, &scene));
    SceneBodyScales(scene, 0, &scales);
    PetscCall(PetscSNPrintf(name, sizeof(name), "extent of a cut body, %d", (int)k));
    CHECK_CLOSE(scales.extent[1], high[k], 1e-12, name);
    PetscCall(Free(&domain, &scene));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A shaken scene has a sin(2 pi f t + phase) besides, and what is said to be the most is the largest of all times. */
static PetscErrorCode TestShaking(void)
{
  const PetscReal x[DIM] = {0.3, 0.2, 0.1}, a[DIM] = {2, 0, -0.5};
  PetscReal       g[DIM], most[DIM], largest[DIM] = {0, 0, 0}, worst = 0;
  Domain          domain;
  Scene           scene;

  PetscFunctionBegin;
  PetscCall(Read(CUBE BALL "-gravity 0,0,-9 -gravity_amplitude 2,0,-0.5 -gravity_frequency 4 -gravity_phase 30 ",
                 &domain, &scene));
  for (PetscInt k = 0; k < 300; k++) {
    const PetscReal time = 1.25 * k / 300, swing = PetscSinReal(2 * PETSC_PI * 4 * time + PETSC_PI / 6);

    SceneSetTime(scene, time);
    SceneAcceleration(scene, x, g);
    for (PetscInt d = 0; d < DIM; d++) {
      worst      = PetscMax(worst, PetscAbsReal(g[d] - a[d] * swing + (d == 2 ? 9 : 0)));
      largest[d] = PetscMax(largest[d], PetscAbsReal(g[d]));
    }
  }
  ForcesMost(scene, x, most);
  CHECK_CLOSE(worst, 0, 1e-12, "shaking_by_its_formula");
  for (PetscInt d = 0; d < DIM; d++) CHECK_CLOSE(most[d], largest[d], 1e-2, "the_most_of_all_times");
  PetscCall(Free(&domain, &scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The acceleration by the forces that have a potential is its slope, wherever they turn about. */
static PetscErrorCode TestPotentials(void)
{
  const char *const options[] = {"-gravity 1,-2,3 ", "-central_force_rate 3 ", "-frame_rotation_rate 0.5,1,2 ",
                                 "-gravity 0,0,-9 -frame_rotation_rate 0,0,2 -frame_rotation_center 0.3,-0.4,0.1 "};
  const PetscReal   x[DIM] = {0.7, 0.2, -0.5}, step = 1e-3; /* potentials are quadratic: differences are exact */

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(options); k++) {
    char      text[512];
    PetscReal g[DIM], worst = 0;
    Domain    domain;
    Scene     scene;

    PetscCall(PetscSNPrintf(text, sizeof(text), CUBE BALL "%s", options[k]));
    PetscCall(Read(text, &domain, &scene));
    SceneAcceleration(scene, x, g);
    for (PetscInt d = 0; d < DIM; d++) {
      PetscReal low[DIM] = {x[0], x[1], x[2]}, high[DIM] = {x[0], x[1], x[2]};

      low[d] -= step;
      high[d] += step;
      worst = PetscMax(worst, PetscAbsReal(g[d] + (SceneForcePotential(scene, high) - SceneForcePotential(scene, low)) /
                                                    (2 * step)));
    }
    CHECK_CLOSE(worst, 0, 1e-9, "a_force_is_the_slope_of_its_potential");
    PetscCall(Free(&domain, &scene));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(UserErrorHandlerPush());
  PetscCall(TestShapes());
  PetscCall(TestWave());
  PetscCall(TestWaves());
  PetscCall(TestVelocities());
  PetscCall(TestScene());
  PetscCall(TestCut());
  PetscCall(TestRefusals());
  PetscCall(TestViscosityModels());
  PetscCall(TestHelp());
  PetscCall(TestPotentials());
  PetscCall(TestShaking());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
