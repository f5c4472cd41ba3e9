/* Gauges on shapes cut out of a lattice: crater, crown and jet; totals; droplets in a quarter of the scene; necks and
   pieces that come off. */
#include "columns.h"
#include "lattice.h"

#define FILM    10e-3
#define FULL    "-box_lower -12e-3,-12e-3,0 -box_upper 12e-3,12e-3,30e-3 " SIDES
#define SIDES   "-box_x periodic -box_y periodic -box_zmin wall "
#define QUARTER "-box_lower 0,0,0 -box_upper 12e-3,12e-3,30e-3 -box_xmin symmetry -box_ymin symmetry -box_zmin wall "
#define PLANE   "-dimension 2 -box_lower -12e-3,0,0 -box_upper 12e-3,30e-3,0 -box_ymin wall "
#define HALF    "-dimension 2 -box_lower 0,0,0 -box_upper 12e-3,30e-3,0 -box_xmin symmetry -box_ymin wall "
#define BODIES                                                                                                         \
  "-spacing 0.5e-3 -bodies film,drop -film_shape box -film_density 1100 -drop_shape sphere -drop_radius 2e-3 "         \
  "-drop_density 1000 -gauge_crater "
#define BODIES_3D BODIES "-film_lower -1,-1,0 -film_upper 1,1,10e-3 -drop_center 0,0,14e-3 "
#define BODIES_2D BODIES "-film_lower -1,0,-1 -film_upper 1,10e-3,1 -drop_center 0,14e-3,0 "

#define CRATER (6e-3)

static int Flat(PetscReal r, PetscReal z)
{
  return z < FILM;
}

/* A crumb below the film is deeper than it, and no part of it. */
static int Crumb(PetscReal r, PetscReal z)
{
  return Flat(r, z) && (z > 1e-3 || (r < 0.5e-3 && z < 0.5e-3));
}

static int Bowl(PetscReal r, PetscReal z)
{
  return z < FILM && r * r + (z - FILM) * (z - FILM) > CRATER * CRATER;
}

/* A crown that leans in over the crater, 5 mm high, and rises from its edge. */
static int Crown(PetscReal r, PetscReal z)
{
  const PetscReal edge = CRATER + 1.0e-3 - 0.5 * (z - FILM);

  return Bowl(r, z) || (z >= FILM && z < FILM + 5e-3 && PetscAbsReal(r - edge) < 1.0e-3);
}

/* With spray over the crater and beside it. */
static int Spray(PetscReal r, PetscReal z)
{
  return Crown(r, z) || (PetscAbsReal(z - 25e-3) < 1e-3 && r < 4e-3) || (r < 1e-3 && PetscAbsReal(z - 12e-3) < 1e-3);
}

/* With a jet in the middle that carries the drop's liquid. */
static int Jet(PetscReal r, PetscReal z)
{
  return r < 1.5e-3 && z < FILM + 8e-3 ? 2 : Bowl(r, z);
}

/* A jet with a cap that hides most of the crater from above. */
static int Mushroom(PetscReal r, PetscReal z)
{
  const int jet = Jet(r, z);

  return jet ? jet : r < 4e-3 && PetscAbsReal(z - FILM - 5e-3) < 1e-3;
}

/* Flat, with a void inside. */
static int Void(PetscReal r, PetscReal z)
{
  return Flat(r, z) && r * r + (z - 5e-3) * (z - 5e-3) > 9e-6;
}

/* A drop just above the flat film. */
static int Above(PetscReal r, PetscReal z)
{
  return r * r + (z - 13.5e-3) * (z - 13.5e-3) < 4e-6 ? 2 : Flat(r, z);
}

/* A crater down to the bottom of the pool. */
static int Dry(PetscReal r, PetscReal z)
{
  return z < FILM && r > CRATER;
}

/* What a shape should give, in spacings; not a number: not checked. */
typedef struct {
  const char *name, *options;
  Shape       shape;
  PetscReal   jitter, depth, diameter, crown, jet, tolerance;
} Case;

static const Case cases[] = {
  {"flat", FULL BODIES_3D, Flat, 0, 0, 0, 0, 0, 1e-6},
  {"flat jittered", FULL BODIES_3D, Flat, 0.25, 0, 0, 0, 0, 0.3},
  {"flat quarter", QUARTER BODIES_3D, Flat, 0.2, 0, 0, 0, 0, 0.3},
  {"flat plane", PLANE BODIES_2D, Flat, 0.2, 0, 0, 0, 0, 0.3},
  {"crumb", FULL BODIES_3D, Crumb, 0, 0, 0, 0, 0, 1e-6},
  {"void", FULL BODIES_3D, Void, 0.2, 0, 0, 0, 0, 0.3},
  {"drop above", FULL BODIES_3D, Above, 0, 0, 0, 0, 0, 1e-6},
  {"bowl", FULL BODIES_3D "-gauge_level 10e-3 ", Bowl, 0, 12, 24, 0, -11.2, 0.6},
  {"bowl jittered", FULL BODIES_3D "-gauge_level 10e-3 ", Bowl, 0.25, 12, 24, NAN, NAN, 0.6},
  {"bowl quarter", QUARTER BODIES_3D "-gauge_level 10e-3 ", Bowl, 0.2, 12, 24, NAN, NAN, 0.6},
  {"bowl plane", PLANE BODIES_2D "-gauge_level 10e-3 ", Bowl, 0, 12, 24, 0, NAN, 0.6},
  {"crown", FULL BODIES_3D "-gauge_level 10e-3 ", Crown, 0.1, 12, 23.6, 10, NAN, 0.6},
  {"spray", FULL BODIES_3D "-gauge_level 10e-3 ", Spray, 0.1, 12, 23.6, 10, NAN, 0.6},
  {"jet", FULL BODIES_3D "-gauge_level 10e-3 ", Jet, 0.1, 11.2, 24, NAN, 16, 0.6},
  {"mushroom", FULL BODIES_3D "-gauge_level 10e-3 ", Mushroom, 0.1, 11.2, 24, 12, 16, 0.6},
  {"dry", FULL BODIES_3D "-gauge_level 10e-3 ", Dry, 0.1, 20, 24, NAN, NAN, 0.6},
};

static PetscErrorCode CheckGauges(const Case *c)
{
  Run         run;
  PetscReal   g[5]; /* crown and its mean, depth, diameter, jet */
  GaugeTotals totals;
  char        name[128];
  double      start;

  PetscFunctionBegin;
  PetscCall(RunCreate(c->options, &run));
  PetscCall(Fill(&run, c->shape, c->jitter));
  start = MPI_Wtime();
  PetscCall(GaugesMeasure(run.gauges, g));
  PetscCall(GaugesTotals(run.gauges, &totals));
  start = MPI_Wtime() - start;
#define CHECK_LENGTH(value, expected, what)                                                                            \
  do {                                                                                                                 \
    (void)snprintf(name, sizeof(name), "gauges %s: %s", c->name, what);                                                \
    if (expected == expected) CHECK_CLOSE((value) / D0, expected, c->tolerance, name);                                 \
  } while (0)
  CHECK_LENGTH(g[2], c->depth, "depth");
  CHECK_LENGTH(g[3], c->diameter, "diameter");
  CHECK_LENGTH(g[0], c->crown, "crown");
  CHECK_LENGTH(g[1], c->crown, "crown, mean");
  CHECK_LENGTH(g[4], c->jet, "jet");
#undef CHECK_LENGTH
  if (getenv("TEST_VERBOSE"))
    printf("%-15s D %g phi %g H %g jet %g top %g N %d KE %g, %.1f ms\n", c->name, g[2] / D0, g[3] / D0, g[0] / D0,
           g[4] / D0, totals.highest / D0, (int)totals.particles, totals.kinetic_energy, 1e3 * start);
  PetscCall(RunDestroy(&run));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Half a crown is half as high in the mean. */
static PetscErrorCode CheckHalfCrown(void)
{
  Run            run;
  ParticleArrays arrays;
  PetscReal      g[5];

  PetscFunctionBegin;
  PetscCall(RunCreate(FULL BODIES_3D "-gauge_level 10e-3 ", &run));
  PetscCall(Fill(&run, Crown, 0));
  PetscCall(ParticlesOpen(run.particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    PetscReal *x = arrays.real[FIELD_POSITION] + DIM * a;

    if (x[1] < 0 && x[2] > FILM) x[2] = 0.5 * FILM;
  }
  PetscCall(ParticlesClose(run.particles, &arrays));
  PetscCall(CloudResync(run.cloud));
  PetscCall(GaugesMeasure(run.gauges, g));
  CHECK_CLOSE(g[0] / D0, 10, 0.6, "gauges: half a crown's highest point");
  CHECK_CLOSE(g[1] / D0, 5, 0.6, "gauges: half a crown's mean");
  PetscCall(RunDestroy(&run));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- droplets --- */

/* Over a film a droplet on the axis, one beside it and its mirror image, a piece of two particles on the axis, and a
   single particle and its image. */
static int Drops(PetscReal r, PetscReal z)
{
  if (r * r + (z - 16e-3) * (z - 16e-3) < 4e-6 || (r - 7e-3) * (r - 7e-3) + (z - 20e-3) * (z - 20e-3) < 1e-6) return 1;
  return (r < D0 && PetscAbsReal(z - 25.25e-3) < 0.5 * D0) ||
             (PetscAbsReal(r - 10.25e-3) < 0.5 * D0 && PetscAbsReal(z - 25.25e-3) < 0.5 * D0)
           ? 1
           : Flat(r, z);
}

#define DROPLETS 4 /* columns: number, volume, largest volume, spray */

/* Gives the liquid a velocity to the right: it leaves the mirror, or crosses it with its image. */
static PetscErrorCode Across(Run *run, PetscReal speed)
{
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(run->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) arrays.real[FIELD_VELOCITY][DIM * a] = speed;
  PetscCall(ParticlesClose(run->particles, &arrays));
  PetscCall(CloudResync(run->cloud));
  PetscCall(CloudBegin(run->cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The columns of the droplets; and from the table how many droplets the rows stand for, and their volume. */
static PetscErrorCode MeasureDroplets(const char options[], PetscReal multiplicity, PetscReal columns[DROPLETS],
                                      PetscReal table[2])
{
  Run        run;
  PetscInt   count, width;
  PetscReal *rows;

  PetscFunctionBegin;
  PetscCall(RunCreate(options, &run));
  PetscCall(Fill(&run, Drops, 0));
  PetscCall(Across(&run, 3));
  CHECK(ColumnCount(run.gauges) == DROPLETS && GaugesTables(run.gauges) == 1, "droplets: columns and a table");
  PetscCall(GaugesMeasure(run.gauges, columns));
  PetscCall(GaugesTableRows(run.gauges, 0, 0, &count, &width, &rows));
  table[0] = table[1] = 0;
  for (PetscInt k = 0; k < count; k++) {
    table[0] += rows[width * k + width - 1];
    table[1] += rows[width * k + width - 1] * rows[width * k + 1];
    if (rows[width * k + width - 1] < multiplicity) CHECK_CLOSE(rows[width * k + 2], 0, 1e-12, "droplets: on the axis");
    CHECK_CLOSE(rows[width * k + 5], rows[width * k + width - 1] < multiplicity ? 0 : 3, 1e-12,
                "droplets: none moves across the mirror");
  }
  PetscCall(PetscFree(rows));
  PetscCall(RunDestroy(&run));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Half of a scene, taken twice, has the droplets of the whole. */
static PetscErrorCode CheckDroplets(void)
{
  static const char *const name[] = {"droplets: number", "droplets: volume", "droplets: largest", "droplets: spray"};
  PetscReal                whole[DROPLETS], half[DROPLETS], table[2];
  PetscMPIInt              rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(MeasureDroplets(PLANE BODIES_2D "-gauge_crater 0 -gauge_droplets ", 1, whole, table));
  PetscCall(MeasureDroplets(HALF BODIES_2D "-gauge_crater 0 -gauge_droplets -gauge_multiplicity 2 ", 2, half, table));
  if (rank) PetscFunctionReturn(PETSC_SUCCESS);
  CHECK(whole[0] == 4 && whole[3] == 2, "droplets: four, and two particles of spray");
  for (PetscInt c = 0; c < DROPLETS; c++) CHECK_CLOSE(half[c], whole[c], 1e-12 * whole[c], name[c]);
  CHECK_CLOSE(table[0], whole[0], 0, "droplets: number in the table");
  CHECK_CLOSE(table[1], whole[1], 1e-12 * whole[1], "droplets: volume in the table");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- the largest piece, necks, pieces that come off --- */

/* Two blocks of different size, 6 spacings thick in the bar between them, which is longer on top. */
static int Dumbbell(PetscReal r, PetscReal z)
{
  return (z > 4e-3 && z < 10e-3 && r < 5e-3) || (z >= 10e-3 && z < 14e-3 && r < 1.5e-3) ||
         (z >= 14e-3 && z < 18e-3 && r < 2e-3) || (z >= 18e-3 && z < 24e-3 && r < 5e-3);
}

/* Neck (m; a quarter of the bar has 8 particles in a section), its place, the mean diameter; with and without a mirror
 * at the axis. */
static PetscErrorCode CheckNeck(const char options[], Shape shape, PetscReal neck, PetscReal mean, const char name[])
{
  Run       run;
  PetscReal value[3];

  PetscFunctionBegin;
  PetscCall(RunCreate(options, &run));
  PetscCall(Fill(&run, shape, 0));
  PetscCall(GaugesMeasure(run.gauges, value));
  if (neck == neck) {
    CHECK_CLOSE(value[0] / neck, 1, 1e-2, name);
    CHECK_CLOSE(value[1], 12e-3, 2e-3, "neck: between the blocks");
  } else
    CHECK(value[0] != value[0] && value[1] != value[1], name);
  CHECK_CLOSE(value[2] / mean, 1, 0.1, "neck: mean diameter");
  PetscCall(RunDestroy(&run));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckNecks(void)
{
  PetscFunctionBegin;
  PetscCall(CheckNeck(PLANE BODIES_2D "-gauge_crater 0 -gauge_neck y ", Dumbbell, 3e-3, 6.8e-3, "neck: of a bar"));
  PetscCall(CheckNeck(HALF BODIES_2D "-gauge_crater 0 -gauge_neck y -gauge_multiplicity 2 ", Dumbbell, 3e-3, 6.8e-3,
                      "neck: of half a bar"));
  PetscCall(CheckNeck(QUARTER BODIES_3D "-gauge_crater 0 -gauge_neck z -gauge_multiplicity 4 ", Dumbbell, 3.1915e-3,
                      6.8e-3, "neck: of a quarter of a bar"));
  PetscCall(CheckNeck(PLANE BODIES_2D "-gauge_crater 0 -gauge_neck y ", Flat, NAN, 24e-3, "neck: a film has none"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves the liquid above a height (m) upwards by a distance (m). */
static PetscErrorCode Lift(Run *run, PetscReal above, PetscReal distance)
{
  const PetscInt up = run->domain->dim - 1;
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(run->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++)
    if (arrays.real[FIELD_POSITION][DIM * a + up] > above) arrays.real[FIELD_POSITION][DIM * a + up] += distance;
  PetscCall(ParticlesClose(run->particles, &arrays));
  PetscCall(CloudResync(run->cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows of a table at a time (s), and the volume of the first. */
static PetscErrorCode Rows(Gauges gauges, PetscInt table, PetscReal time, PetscInt *count, PetscReal *volume)
{
  PetscInt   width;
  PetscReal *rows;

  PetscFunctionBegin;
  PetscCall(GaugesTableRows(gauges, table, time, count, &width, &rows));
  *volume = *count ? rows[1] : 0;
  PetscCall(PetscFree(rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A block breaks off at 18 mm, and moves on; then a bar at 13 mm. What is there at the start or after a restart is no
 * event. */
static PetscErrorCode CheckPinchOff(void)
{
  Run         run;
  Gauges      again;
  PetscInt    count;
  PetscReal   volume;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(RunCreate(PLANE BODIES_2D "-gauge_crater 0 -gauge_droplets -gauge_droplet_main -gauge_pinch_off ", &run));
  PetscCall(Fill(&run, Dumbbell, 0));
  CHECK(GaugesTables(run.gauges) == 2 && !GaugesTableEvents(run.gauges, 0) && GaugesTableEvents(run.gauges, 1),
        "pinch-off: a table of events");
  PetscCall(Rows(run.gauges, 0, 0, &count, &volume));
  CHECK(count == !rank, "droplets: the largest piece has a row");
  PetscCall(Rows(run.gauges, 1, 0, &count, &volume));
  CHECK(count == 0, "pinch-off: none at the start");
  PetscCall(Lift(&run, 18e-3, 1e-3));
  PetscCall(Rows(run.gauges, 1, 0, &count, &volume));
  CHECK(count == !rank, "pinch-off: a block comes off");
  if (!rank) CHECK_CLOSE(volume / 60e-6, 1, 1e-9, "pinch-off: volume of the block");
  PetscCall(Lift(&run, 18e-3, 2e-3));
  PetscCall(Rows(run.gauges, 1, 0, &count, &volume));
  CHECK(count == 0, "pinch-off: once");
  PetscCall(Lift(&run, 13e-3, 1e-3));
  PetscCall(Rows(run.gauges, 1, 0, &count, &volume));
  CHECK(count == !rank, "pinch-off: a bar comes off");
  if (!rank) CHECK_CLOSE(volume / 19e-6, 1, 1e-9, "pinch-off: volume of the bar");
  PetscCall(Rows(run.gauges, 0, 0, &count, &volume));
  CHECK(count == (rank ? 0 : 3), "droplets: three pieces");
  PetscCall(GaugesCreate(run.cloud, &again));
  PetscCall(GaugesSetFromOptions(again));
  PetscCall(Rows(again, 1, 0, &count, &volume));
  CHECK(count == 0, "pinch-off: none after a restart");
  PetscCall(GaugesDestroy(&again));
  PetscCall(RunDestroy(&run));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A block that flies, and whose particles have other ids at the end, as after joins, is the same one. */
static PetscErrorCode CheckFlight(void)
{
  Run            run;
  PetscInt       count;
  PetscReal      volume;
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(RunCreate(PLANE BODIES_2D "-gauge_crater 0 -gauge_pinch_off ", &run));
  PetscCall(Fill(&run, Dumbbell, 0));
  PetscCall(Lift(&run, 18e-3, 1e-3));
  for (PetscInt later = 0; later < 2; later++) {
    PetscCall(ParticlesOpen(run.particles, &arrays));
    for (PetscInt a = 0; a < arrays.n; a++)
      if (arrays.real[FIELD_POSITION][DIM * a + 1] > 18e-3) {
        arrays.real[FIELD_VELOCITY][DIM * a + 1] = 1;
        arrays.integer[INT_ID][a] += later * 1000000;
      }
    PetscCall(ParticlesClose(run.particles, &arrays));
    PetscCall(Lift(&run, 18e-3, later * 2e-3));
    PetscCall(Rows(run.gauges, 0, later * 2e-3, &count, &volume));
    CHECK(count == 0, "pinch-off: a block that flies is no event");
  }
  PetscCall(RunDestroy(&run));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The liquid with the smallest id comes off: its label was the largest piece's. */
static PetscErrorCode CheckLabels(void)
{
  Run         run;
  PetscInt    count;
  PetscReal   volume;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(RunCreate(PLANE BODIES_2D "-gauge_crater 0 -gauge_pinch_off ", &run));
  PetscCall(Fill(&run, Dumbbell, 0));
  PetscCall(Rows(run.gauges, 0, 0, &count, &volume));
  PetscCall(Lift(&run, 5e-3, 1e-3));
  PetscCall(Rows(run.gauges, 0, 0, &count, &volume));
  CHECK(count == !rank, "pinch-off: with the smallest id");
  if (!rank) CHECK_CLOSE(volume / 10e-6, 1, 1e-9, "pinch-off: volume with the smallest id");
  PetscCall(RunDestroy(&run));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- roughness --- */

/* The height (m) at which the highest particle of a column finds the surface in the plane by its |sum V grad W|, if the
   columns of a lattice are displaced by a wave of this amplitude (m) there, 4 spacings long. */
static PetscReal Height(Kernel kernel, PetscReal amplitude)
{
  PetscReal n = 0, w, low = 0, high = KernelSupport(kernel);

  for (PetscInt j = -3; j <= 3; j++)
    for (PetscInt layer = 0; layer <= 4; layer++) {
      const PetscReal y  = amplitude * (1 - PetscCosReal(0.5 * PETSC_PI * j)) + layer * D0,
                      r2 = PetscSqr(j * D0) + y * y;
      PetscReal W, F;

      KernelEvaluate(kernel, 1, &r2, &W, &F);
      n -= F * y * D0 * D0;
    }
  for (PetscInt k = 0; k < 60; k++) {
    KernelHalfSpace(kernel, 0.5 * (low + high), &w, NULL);
    *(w > n ? &low : &high) = 0.5 * (low + high);
  }
  return amplitude + low;
}

/* The roughness (m) of a film whose columns are displaced by a wave of this amplitude and length (m); the amplitude
   that its highest particles see. */
static PetscErrorCode Roughness(const char options[], PetscReal amplitude, PetscReal length, PetscReal *roughness,
                                PetscReal *seen)
{
  Run            run;
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(RunCreate(options, &run));
  PetscCall(PressureCreate(run.cloud, &run.set.pressure));
  PetscCall(PressureSetFromOptions(run.set.pressure));
  GaugesSetForces(run.gauges, NULL, run.set.pressure, PETSC_FALSE);
  PetscCall(Fill(&run, Flat, 0));
  PetscCall(ParticlesOpen(run.particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    PetscReal *x = arrays.real[FIELD_POSITION] + DIM * a;

    x[run.domain->dim - 1] += amplitude * PetscCosReal(2 * PETSC_PI * x[0] / length);
  }
  PetscCall(ParticlesClose(run.particles, &arrays));
  PetscCall(CloudResync(run.cloud));
  PetscCall(OperatorsMoments(run.cloud, NULL));
  PetscCall(OperatorsFreeSurface(run.cloud));
  PetscCall(GaugesMeasure(run.gauges, roughness));
  *seen = (Height(run.cloud->kernel, amplitude) - Height(run.cloud->kernel, -amplitude)) / 2;
  PetscCall(PressureDestroy(&run.set.pressure));
  PetscCall(RunDestroy(&run));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define WAVE (1e-3 * D0)

/* In the plane five places make a fit: a quadratic leaves the parts along (-1, 2, 0, -2, 1) and (1, -4, 6, -4, 1), of a
   wave of 4 spacings 0.457 of the square of its amplitude. A wave of 24 spacings is a quadratic there. */
static PetscErrorCode CheckRoughness(void)
{
  static const char *const options[] = {PLANE "-box_x periodic " BODIES_2D "-gauge_crater 0 -gauge_roughness ",
                                        FULL BODIES_3D "-gauge_crater 0 -gauge_roughness "};
  PetscReal                rough, twice, seen;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2; k++) {
    PetscCall(Roughness(options[k], 0, 1, &rough, &seen));
    CHECK_CLOSE(rough / D0, 0, 1e-6, "roughness: none of a lattice");
    PetscCall(Roughness(options[k], WAVE, 24 * D0, &rough, &seen));
    CHECK_CLOSE(rough / WAVE, 0, 0.02, "roughness: a long wave is none");
    PetscCall(Roughness(options[k], WAVE, 4 * D0, &rough, &seen));
    PetscCall(Roughness(options[k], 2 * WAVE, 4 * D0, &twice, &seen));
    CHECK_CLOSE(twice / rough, 2, 0.05, "roughness: in proportion to a short wave");
    if (k == 0) CHECK_CLOSE(2 * rough / seen, PetscSqrtReal(0.457), 0.05, "roughness: of a short wave");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- which columns there are --- */

static PetscErrorCode HasCrater(const char options[], PetscBool expected, const char name[])
{
  Run run;

  PetscFunctionBegin;
  PetscCall(RunCreate(options, &run));
  CHECK((ColumnFind(run.gauges, "crater_depth") >= 0) == expected, name);
  PetscCall(RunDestroy(&run));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define TANK                                                                                                           \
  "-dimension 2 -box_lower 0,0,0 -box_upper 6e-3,6e-3,0 -spacing 0.5e-3 -bodies film -film_shape box -film_lower "     \
  "0,0,-1 -film_upper 1,3e-3,1 "

static PetscErrorCode CheckCraterOption(void)
{
  PetscFunctionBegin;
  PetscCall(HasCrater(TANK, PETSC_FALSE, "crater: not unless asked for"));
  PetscCall(HasCrater(TANK "-gauge_crater ", PETSC_TRUE, "crater: asked for"));
  PetscCall(HasCrater(TANK "-gauge_jet_radius 1e-3 ", PETSC_TRUE, "crater: asked for by one of its options"));
  PetscCall(HasCrater(TANK "-gauge_jet_radius 1e-3 -gauge_crater 0 ", PETSC_FALSE, "crater: asked not to"));
  PetscCall(HasCrater(TANK "-gauge_level 1e-3 ", PETSC_FALSE, "crater: the level alone does not ask for it"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  world = PETSC_COMM_WORLD;
  PetscCall(LogRegister());
  PetscCall(UserErrorHandlerPush());
  for (size_t c = 0; c < sizeof(cases) / sizeof(cases[0]); c++) PetscCall(CheckGauges(&cases[c]));
  PetscCall(CheckDroplets());
  PetscCall(CheckNecks());
  PetscCall(CheckPinchOff());
  PetscCall(CheckRoughness());
  PetscCall(CheckFlight());
  PetscCall(CheckLabels());
  PetscCall(CheckHalfCrown());
  PetscCall(CheckCraterOption());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
