/* Pressure and velocity at points, of a lattice with known fields; on any number of ranks. */
#include "../../src/gauges/gauges.h"
#include "refuse.h"
#include "setup.h"

#define SPACE "-spacing 0.1 -packing_jitter 0 -bodies a "
#define BLOCK                                                                                                          \
  SPACE "-box_lower 0,0,0 -box_upper 2,1,1.5 -box_x periodic -box_ymin symmetry -box_ymax wall -box_zmin wall "        \
        "-a_upper 2,1,1 "
#define PLANE    SPACE "-dimension 2 -box_lower 0,0 -box_upper 2,1.5 -box_x wall -box_ymin wall -a_upper 2,1 "
#define GRADIENT 3. /* of the pressure upwards, Pa/m */
#define SLIP     5. /* of the velocity along x with z (in two dimensions y), 1/s; the velocity along y is y, 1/s */

/* The values at the points of -gauge_points. */
static PetscErrorCode Measure(const char options[], PetscReal values[])
{
  Setup          s;
  Gauges         gauges;
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(SetupPack(options, &s));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscReal *x = arrays.real[FIELD_POSITION] + DIM * a;
    PetscReal       *v = arrays.real[FIELD_VELOCITY] + DIM * a, up = x[s.domain->dim - 1];

    /* walls have nonsense, which must not be read */
    arrays.real[FIELD_PRESSURE][a] = arrays.integer[INT_LAYER][a] ? 1e6 : 10 - GRADIENT * up;
    v[0]                           = arrays.integer[INT_LAYER][a] ? 1e6 : SLIP * up;
    v[1]                           = x[1];
  }
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(GaugesCreate(s.cloud, &gauges));
  PetscCall(GaugesSetFromOptions(gauges));
  PetscCall(GaugesMeasure(gauges, values));
  PetscCall(GaugesDestroy(&gauges));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestBlock(void)
{
  PetscReal p[6][4];

  PetscFunctionBegin;
  PetscCall(Measure(BLOCK "-gauge_points 1.05,0.45,0.55,1,0.5,0.5,0,0.45,0.55,1,0,0.5,1,0.5,0,1,0.5,1.3", p[0]));
  CHECK_CLOSE(p[0][0], 10 - GRADIENT * 0.55, 1e-12, "pressure_on_a_particle");
  CHECK_CLOSE(p[0][1], SLIP * 0.55, 1e-12, "velocity_on_a_particle");
  CHECK_CLOSE(p[0][2], 0.45, 1e-12, "velocity_y_on_a_particle");
  CHECK_CLOSE(p[1][0], 10 - GRADIENT * 0.5, 1e-12, "pressure_between_particles");
  CHECK_CLOSE(p[2][0], 10 - GRADIENT * 0.55, 1e-12, "pressure_in_a_periodic_face");
  CHECK_CLOSE(p[2][1], SLIP * 0.55, 1e-12, "velocity_in_a_periodic_face");
  CHECK_CLOSE(p[3][0], 10 - GRADIENT * 0.5, 1e-12, "pressure_in_a_mirror");
  CHECK_CLOSE(p[3][2], 0, 1e-12, "no_velocity_through_a_mirror");
  CHECK_CLOSE(p[4][0], 10, 1e-12, "pressure_on_a_wall_is_that_of_the_fluid_continued");
  CHECK_CLOSE(p[4][1], 0, 1e-12, "velocity_on_a_wall_is_that_of_the_fluid_continued");
  CHECK(p[5][0] == 0 && PetscIsNanReal(p[5][1]), "no_fluid_no_pressure");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestPlane(void)
{
  PetscReal p[2][3];

  PetscFunctionBegin;
  PetscCall(Measure(PLANE "-gauge_points 1,0.5,2,0.5", p[0]));
  CHECK_CLOSE(p[0][0], 10 - GRADIENT * 0.5, 1e-12, "pressure_in_two_dimensions");
  CHECK_CLOSE(p[1][0], 10 - GRADIENT * 0.5, 1e-12, "pressure_on_a_side_wall");
  CHECK_CLOSE(p[1][1], SLIP * 0.5, 1e-12, "velocity_on_a_side_wall_is_of_the_fluid");
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define PLATE PLANE "-solids plate -plate_lower 0.95,0 -plate_upper 1.05,1.2 "

/* A solid that moves: nothing inside it, and in front of it the fluid of that side alone. */
static PetscErrorCode TestSolid(void)
{
  PetscReal p[4][3], thin[1][3];

  PetscFunctionBegin;
  PetscCall(Measure(PLATE "-plate_velocity 1e-9,0 -gauge_points 1,0.5,0.95,0.5,1.05,0.5,1.2,0.5", p[0]));
  CHECK(PetscIsNanReal(p[0][0]) && PetscIsNanReal(p[0][1]), "nothing_inside_a_solid");
  CHECK_CLOSE(p[1][0], 10 - GRADIENT * 0.5, 1e-12, "pressure_on_a_solid");
  CHECK_CLOSE(p[2][0], 10 - GRADIENT * 0.5, 1e-12, "pressure_on_its_other_side");
  CHECK_CLOSE(p[3][0], 10 - GRADIENT * 0.5, 1e-12, "pressure_beside_it");
  PetscCall(Measure(PLANE "-a_upper 0.9,1 -solids plate -plate_lower 0.95,0 -plate_upper 1.05,1.2 "
                          "-gauge_points 1.05,0.5",
                    thin[0]));
  CHECK(thin[0][0] == 0 && PetscIsNanReal(thin[0][1]), "no_fluid_from_behind_a_solid");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Refused(const char options[], const char word[], const char name[])
{
  Setup          s;
  Gauges         gauges;
  PetscErrorCode code;

  PetscFunctionBegin;
  PetscCall(SetupOpen(options, &s));
  PetscCall(GaugesCreate(s.cloud, &gauges));
  RefuseBegin();
  code = GaugesSetFromOptions(gauges);
  RefuseEnd(code, word, name);
  PetscCall(GaugesDestroy(&gauges));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(LogRegister());
  PetscCall(UserErrorHandlerPush());
  PetscCall(TestBlock());
  PetscCall(TestPlane());
  PetscCall(TestSolid());
  PetscCall(Refused(BLOCK "-gauge_points 1,0.5", "2 numbers; it needs 3 a point", "refuse_half_a_point"));
  PetscCall(Refused(PLANE "-gauge_points 1,0.5,1,1.6", "y = 1.6 m of point 2 is not in the box", "refuse_outside"));
  PetscCall(Refused(PLATE "-gauge_points 0.95,0.5,1,0.5", "point 2 is inside the solid plate", "refuse_in_a_solid"));
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
