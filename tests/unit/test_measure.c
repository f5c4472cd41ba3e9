/* Gauges on blocks of a lattice with fields set by hand: energies and volume, droplets, forces on walls, heights,
   points beside periodic faces, lines. Runs on any number of ranks. */
#include "../../src/gauges/gauges.h"
#include "setup.h"
#include "check.h"
#include "columns.h"

#define COLUMNS_MOST 16
#define SPACE        "-dimension 2 -spacing 0.1 -packing_jitter 0 "
#define BLOCKS                                                                                                         \
  SPACE "-box_lower 0,0 -box_upper 3,3 -gravity 0,-10 -bodies a,b -a_upper 1,1 -a_density 800 -b_lower 1,0 -b_upper "  \
        "2,0.5 -b_density 400 "
#define DROPS                                                                                                          \
  SPACE "-box_lower 0,0 -box_upper 3,3 -box_ymin wall -bodies pool,left,right,crumb -pool_upper 3,0.5 -left_lower "    \
        "0.5,1.5 -left_upper 0.9,1.7 -left_velocity 2,-1 -right_lower 0.95,1.5 -right_upper 1.35,1.7 -crumb_lower "    \
        "2.5,2 -crumb_upper 2.7,2.1 -crumb_velocity 0,3 -gauge_droplets "
#define RING_DROPS                                                                                                     \
  "-dimension axisymmetric -spacing 0.1 -packing_jitter 0 -box_lower 0,0 -box_upper 3,3 -bodies far,near -far_lower "  \
  "2,1 -far_upper 2.4,1.3 -far_velocity 0,4 -near_upper 0.5,0.6 -gauge_droplets -gauge_droplet_main "
#define TANK                                                                                                           \
  SPACE "-box_lower 0,0.5 -box_upper 2,2.5 -box_x wall -box_ymin wall -bodies a -a_lower 0,0.5 -a_upper 2,1.5 "        \
        "-solids block -block_lower 0.8,0.3 -block_upper 1.2,0.9 "

typedef void (*Fill)(PetscInt layer, const PetscReal x[], PetscReal v[], PetscReal *p);

/* Packs a scene, sets velocities and pressures (NULL: as packed), opens its gauges. */
static PetscErrorCode Open(const char options[], Fill fill, Setup *s, Gauges *gauges)
{
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(SetupPack(options, s));
  PetscCall(ParticlesOpen(s->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n && fill; a++)
    fill(arrays.integer[INT_LAYER][a], arrays.real[FIELD_POSITION] + DIM * a, arrays.real[FIELD_VELOCITY] + DIM * a,
         &arrays.real[FIELD_PRESSURE][a]);
  PetscCall(ParticlesClose(s->particles, &arrays));
  PetscCall(CloudResync(s->cloud)); /* the cloud has what the swarm has */
  PetscCall(GaugesCreate(s->cloud, gauges));
  PetscCall(GaugesSetFromOptions(*gauges));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Close(Setup *s, Gauges *gauges)
{
  PetscFunctionBegin;
  PetscCall(GaugesDestroy(gauges));
  PetscCall(SetupClose(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Columns(const char options[], Fill fill, PetscReal value[COLUMNS_MOST])
{
  Setup  s;
  Gauges gauges;

  PetscFunctionBegin;
  PetscCall(Open(options, fill, &s, &gauges));
  PetscCheck(ColumnCount(gauges) <= COLUMNS_MOST, PETSC_COMM_WORLD, PETSC_ERR_ARG_SIZ, "too many columns");
  PetscCall(GaugesMeasure(gauges, value));
  PetscCall(Close(&s, &gauges));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- sums --- */

static void Moving(PetscInt layer, const PetscReal x[], PetscReal v[], PetscReal *p)
{
  v[0] = 3;
  v[1] = -4;
}

/* Two blocks of 800 and 200 kg at heights of 0.5 and 0.25 m, which move at 5 m/s. */
static PetscErrorCode TestTotals(PetscReal copies)
{
  char        options[512];
  GaugeTotals t;
  Setup       s;
  Gauges      gauges;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof(options), BLOCKS "-gauge_multiplicity %g -gauge_level 0.2", (double)copies));
  PetscCall(Open(options, Moving, &s, &gauges));
  PetscCall(GaugesTotals(gauges, &t));
  CHECK_CLOSE(t.kinetic_energy, 1000 * 12.5, 1e-8, "kinetic_energy");
  CHECK_CLOSE(t.potential_energy, 10 * (800 * 0.5 + 200 * 0.25), 1e-9, "potential_energy");
  CHECK_CLOSE(t.volume, 1.5, 1e-12, "volume");
  CHECK_CLOSE(t.multiplicity, copies, 0, "multiplicity");
  CHECK_CLOSE(t.particles, 150, 0, "particles");
  CHECK_CLOSE(t.highest, 0.8, 1e-12, "highest");
  PetscCall(Close(&s, &gauges));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A particle nearer to a face than half a spacing is below the top of the box, if the face is periodic. */
static PetscErrorCode TestHighest(const char face[], PetscReal highest)
{
  const PetscReal x[] = {0.45, 0.48, 0, 0.55, 0.98, 0};
  char            options[256];
  GaugeTotals     t;
  Setup           s;
  Gauges          gauges;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof(options), SPACE "-box_lower 0,0 -box_upper 1,1 -box_y %s -bodies a", face));
  PetscCall(SetupFill(options, 2, x, 0, &s));
  PetscCall(GaugesCreate(s.cloud, &gauges));
  PetscCall(GaugesSetFromOptions(gauges));
  PetscCall(GaugesTotals(gauges, &t));
  CHECK_CLOSE(t.highest, highest, 1e-12, face);
  PetscCall(Close(&s, &gauges));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- droplets --- */

/* The droplets that the table has: number of rows, and of the first and last row particles, volume, place and velocity.
 */
static PetscErrorCode Table(const char options[], PetscInt *count, PetscReal first[6], PetscReal last[6])
{
  PetscInt   width;
  PetscReal *rows;
  Setup      s;
  Gauges     gauges;

  PetscFunctionBegin;
  PetscCall(Open(options, NULL, &s, &gauges));
  PetscCall(GaugesTableRows(gauges, 0, 0, count, &width, &rows));
  for (PetscInt k = 0; k < 6 && *count; k++) { /* x, y of place and velocity */
    const PetscInt column[] = {0, 1, 2, 3, 5, 6};

    first[k] = rows[column[k]];
    last[k]  = rows[width * (*count - 1) + column[k]];
  }
  PetscCall(PetscFree(rows));
  PetscCall(Close(&s, &gauges));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Two drops of eight particles 1.5 spacings apart, and one of two. */
static PetscErrorCode TestDroplets(void)
{
  const PetscReal left[6] = {8, 0.08, 0.7, 1.6, 2, -1}, crumb[6] = {2, 0.02, 2.6, 2.05, 0, 3};
  PetscReal       first[6], last[6], apart[COLUMNS_MOST], large[COLUMNS_MOST];
  PetscInt        count;
  PetscMPIInt     rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(Table(DROPS, &count, first, last));
  PetscCall(Columns(DROPS, NULL, apart));
  PetscCall(Columns(DROPS "-gauge_droplet_least 3", NULL, large));
  if (rank) PetscFunctionReturn(PETSC_SUCCESS);
  CHECK(count == 3 && apart[0] == 3 && apart[3] == 0, "three_droplets");
  for (PetscInt k = 0; k < 6; k++) {
    CHECK_CLOSE(first[k], left[k], 1e-12, "first_droplet");
    CHECK_CLOSE(last[k], crumb[k], 1e-12, "last_droplet");
  }
  CHECK_CLOSE(apart[1], 0.18, 1e-12, "volume_of_droplets");
  CHECK_CLOSE(apart[2], 0.08, 1e-12, "largest_droplet");
  CHECK(large[0] == 2 && large[3] == 2, "a_droplet_of_two_particles_is_spray_if_three_are_the_least");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rings: the piece far from the axis has 12 particles and 1.65876 m3, that at the axis 30 particles and 0.4712 m3. The
   far one is the largest; the centre of the other is that of its volume, r = 2/3 of 0.5 m. */
static PetscErrorCode TestRingDroplets(void)
{
  PetscReal   largest[6], droplet[6], columns[COLUMNS_MOST];
  PetscInt    count;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(Table(RING_DROPS, &count, largest, droplet));
  PetscCall(Columns(RING_DROPS, NULL, columns));
  if (rank) PetscFunctionReturn(PETSC_SUCCESS);
  CHECK(count == 2 && columns[0] == 1, "one_droplet_of_rings");
  CHECK_CLOSE(columns[1] / (PETSC_PI * 0.25 * 0.6), 1, 0.01, "the_droplet_of_rings_has_less_volume");
  CHECK_CLOSE(largest[1] / (PETSC_PI * (5.76 - 4) * 0.3), 1, 0.01, "the_largest_piece_has_more_volume");
  CHECK_CLOSE(largest[5], 4, 1e-9, "velocity_of_the_largest_piece");
  CHECK_CLOSE(droplet[2] / (0.5 * 2 / 3), 1, 0.02, "centre_of_volume_of_rings");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- walls --- */

static void Pressed(PetscInt layer, const PetscReal x[], PetscReal v[], PetscReal *p)
{
  *p = layer ? 300 : 100; /* 200 Pa at the face */
}

/* Liquid of 100 Pa beside walls of 300 Pa: 200 Pa push side walls of 1 m outwards, the floor of 2 m, but for the solid
   on it, downwards; the solid from both sides alike, and downwards. The kernel's sums cost a percent. */
static PetscErrorCode TestForces(void)
{
  PetscReal force[COLUMNS_MOST]; /* xmin, xmax, ymin, block */

  PetscFunctionBegin;
  PetscCall(Columns(TANK "-gauge_forces", Pressed, force));
  CHECK_CLOSE(force[0] / -200, 1, 0.02, "force_on_the_left_wall");
  CHECK_CLOSE(force[2] / 200, 1, 0.02, "force_on_the_right_wall");
  CHECK_CLOSE(force[5] / (-200 * 1.6), 1, 0.02, "force_on_the_floor");
  CHECK_CLOSE(force[7] / (-200 * 0.4), 1, 0.02, "force_on_the_solid");
  CHECK_CLOSE(force[4] / 200, 0, 0.01, "no_force_along_the_floor");
  CHECK_CLOSE(force[6] / 200, 0, 0.01, "no_force_on_the_solid_to_the_side");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A pressure of 5 Pa on the free surface, 2 m wide, is what lines of contact pull up with; beside a mirror there is no
   sum to the side. */
static PetscErrorCode TestPull(void)
{
  static const char *const scenes[] = {TANK "-gauge_forces", TANK "-box_xmin symmetry -gauge_forces"};
  Setup                    s;
  Gauges                   gauges;

  PetscFunctionBegin;
  for (PetscInt mirror = 0; mirror < 2; mirror++) {
    PetscReal force[COLUMNS_MOST];
    char      name[64];
    PetscInt  last;

    PetscCall(Open(scenes[mirror], NULL, &s, &gauges));
    GaugesSetForces(gauges, NULL, NULL, PETSC_TRUE);
    PetscCall(SetupMoments(&s));
    for (PetscInt a = 0; a < s.cloud->n_owned; a++) s.cloud->field[FIELD_CAPILLARY][a] = 5;
    last = ColumnCount(gauges) - 1;
    PetscCall(GaugesMeasure(gauges, force));
    PetscCall(ColumnHead(gauges, last, name, sizeof(name)));
    CHECK(!strcmp(name, "force_tension_y_N/m"), "name_of_the_pull");
    CHECK_CLOSE(force[last] / 10, 1, 0.02, "pull_at_lines_of_contact");
    if (mirror)
      CHECK(last == 6, "no_pull_beside_a_mirror");
    else
      CHECK_CLOSE(force[last - 1] / 10, 0, 1e-12, "no_pull_to_the_side");
    PetscCall(Close(&s, &gauges));
  }
  PetscCall(Open(SPACE "-box_lower 0,0 -box_upper 2,2 -bodies a -a_upper 1,1 -gauge_forces", NULL, &s, &gauges));
  GaugesSetForces(gauges, NULL, NULL, PETSC_TRUE);
  CHECK(ColumnCount(gauges) == 0, "no_pull_where_nothing_is_wetted");
  PetscCall(Close(&s, &gauges));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The surface at 1.5 m: in the middle, at the foot of a wall, over the solid. */
static PetscErrorCode TestHeights(void)
{
  PetscReal height[COLUMNS_MOST];

  PetscFunctionBegin;
  PetscCall(Columns(TANK "-gauge_heights 0.4,0,1", NULL, height));
  CHECK_CLOSE(height[0], 1.5, 0.02, "height_in_the_middle");
  CHECK_CLOSE(height[1], 1.5, 0.02, "height_at_a_wall");
  CHECK_CLOSE(height[2], 1.5, 0.02, "height_over_a_solid");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- places --- */

static void Wave(PetscInt layer, const PetscReal x[], PetscReal v[], PetscReal *p)
{
  *p   = 10 + PetscSinReal(PETSC_PI * x[0]);
  v[0] = 7 * x[1];
}

/* Beside periodic faces a point sees through them: the sine of the box's width is small there. */
static PetscErrorCode TestPeriodic(void)
{
  PetscReal point[COLUMNS_MOST];

  PetscFunctionBegin;
  PetscCall(Columns(SPACE "-box_lower 0,0 -box_upper 2,1 -box_x periodic -bodies a -gauge_points 0.02,0.5,1.98,0.5",
                    Wave, point));
  CHECK_CLOSE(point[0] - 10, PetscSinReal(PETSC_PI * 0.02), 0.02, "point_beside_the_lower_face");
  CHECK_CLOSE(point[3] - 10, -PetscSinReal(PETSC_PI * 0.02), 0.02, "point_beside_the_upper_face");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Five points from end to end, and the velocity there. */
static PetscErrorCode TestLines(void)
{
  PetscInt    count, width;
  PetscReal  *rows, wrong = 0;
  PetscMPIInt rank;
  Setup       s;
  Gauges      gauges;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(Open(SPACE "-box_lower 0,0 -box_upper 2,1 -box_x periodic -bodies a -gauge_lines 1,0.3,1.2,0.7 "
                       "-gauge_line_points 5",
                 Wave, &s, &gauges));
  PetscCall(GaugesTableRows(gauges, 0, 0, &count, &width, &rows));
  CHECK(count == (rank ? 0 : 5), "points_of_a_line");
  for (PetscInt k = 0; k < count; k++) {
    const PetscReal *row = rows + width * k, y = 0.3 + 0.1 * k;

    wrong = PetscMax(wrong, PetscAbsReal(row[0] - 1) + PetscAbsReal(row[1] - 1 - 0.05 * k) + PetscAbsReal(row[2] - y));
    wrong = PetscMax(wrong, PetscAbsReal(row[5] / (7 * y) - 1));
  }
  CHECK_CLOSE(wrong, 0, 1e-9, "points_of_a_line_and_velocity"); /* on lines of the lattice and half-way between */
  PetscCall(PetscFree(rows));
  PetscCall(Close(&s, &gauges));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(LogRegister());
  PetscCall(TestTotals(1));
  PetscCall(TestTotals(3));
  PetscCall(TestHighest("open", 1.03));
  PetscCall(TestHighest("periodic", 1));
  PetscCall(TestDroplets());
  PetscCall(TestRingDroplets());
  PetscCall(TestForces());
  PetscCall(TestPull());
  PetscCall(TestHeights());
  PetscCall(TestPeriodic());
  PetscCall(TestLines());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
