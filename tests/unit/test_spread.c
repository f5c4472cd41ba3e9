/* What liquid wets, and the contact angle seen, of caps that a wall or a solid cuts: in two and three dimensions, as
   rings, whole and as a quarter; the thickness of a film along a line. Runs on any number of ranks. */
#include "../../src/gauges/gauges.h"
#include "setup.h"
#include "check.h"
#include "columns.h"
#include <string.h>

#define COLUMNS_MOST 32
#define FOOT         10.7 /* spacings: radius of the foot of a cap */
#define CAP          "-spacing 1 -bodies drop -drop_shape sphere -gauge_spread "
#define SPACE        "-box_lower -26,-26,0 -box_upper 26,26,26 -box_zmin wall "
#define QUARTER      "-box_lower 0,0,0 -box_upper 26,26,26 -box_zmin wall -box_xmin symmetry -box_ymin symmetry "
#define TANK                                                                                                           \
  "-dimension 2 -spacing 0.1 -packing_jitter 0 -box_lower 0,0.5 -box_upper 3,2.2 -box_x wall -box_ymin wall -solids "  \
  "block -block_lower 0.8,0.3 -block_upper 1.2,0.87 "

typedef struct {
  PetscInt  count;
  PetscReal value[COLUMNS_MOST];
  char      name[COLUMNS_MOST][64];
} Series;

static PetscErrorCode Measure(const char options[], Series *series)
{
  Setup  s;
  Gauges gauges;

  PetscFunctionBegin;
  PetscCall(SetupPack(options, &s));
  PetscCall(SetupMoments(&s));
  PetscCall(GaugesCreate(s.cloud, &gauges));
  PetscCall(GaugesSetFromOptions(gauges));
  series->count = ColumnCount(gauges);
  PetscCheck(series->count <= COLUMNS_MOST, PETSC_COMM_WORLD, PETSC_ERR_ARG_SIZ, "too many columns");
  for (PetscInt k = 0; k < series->count; k++)
    PetscCall(ColumnHead(gauges, k, series->name[k], sizeof(series->name[k])));
  PetscCall(GaugesMeasure(gauges, series->value));
  PetscCall(GaugesDestroy(&gauges));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The value of a column; -1: there is none. */
static PetscReal Value(const Series *series, const char name[])
{
  for (PetscInt k = 0; k < series->count; k++)
    if (!strcmp(series->name[k], name)) return series->value[k];
  return -1;
}

/* A cap. The lattice's edges in a plane are too rough for an angle (degrees: NAN).
 */
typedef struct {
  const char *scene, *wall;             /* options; the wall's name in the columns */
  PetscReal   angle, way[DIM], degrees; /* its angle; the normal of the wall; tolerance of the angle */
} Cap;

static PetscErrorCode TestCaps(void)
{
  static const Cap caps[] = {
    {SPACE, "zmin", 60, {0, 0, 1}, 5},
    {SPACE, "zmin", 90, {0, 0, 1}, 5},
    {SPACE, "zmin", 120, {0, 0, 1}, 5},
    {"-box_lower -26,-26,-26 -box_upper 26,26,26 -solids slope -slope_shape half_space -slope_normal 1,0,1 "
     "-slope_point -0.25,0,-0.25 ",
     "slope",
     90,
     {0.70710678118654752, 0, 0.70710678118654752},
     5},
    {"-dimension axisymmetric -box_lower 0,0 -box_upper 26,26 -box_ymin wall ", "ymin", 90, {0, 1, 0}, NAN},
    {"-dimension 2 -box_lower -26,0 -box_upper 26,26 -box_ymin wall ", "ymin", 60, {0, 1, 0}, NAN},
    {"-dimension 2 -box_lower -26,-26 -box_upper 26,26 -solids slope -slope_shape half_space -slope_normal 1,1 "
     "-slope_point -0.25,-0.25 ",
     "slope",
     90,
     {0.70710678118654752, 0.70710678118654752, 0},
     NAN},
  };

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(caps); k++) {
    const Cap      *c    = &caps[k];
    const PetscReal turn = c->angle * PETSC_PI / 180, radius = FOOT / PetscSinReal(turn),
                    high = -radius * PetscCosReal(turn);
    const PetscBool flat = (PetscBool)(strstr(c->scene, "-dimension 2") != NULL);
    char            options[512], name[64], what[128];
    Series          series;
    PetscReal       area;

    PetscCall(PetscSNPrintf(options, sizeof(options), "%s" CAP "-drop_radius %.17g -drop_center %.17g,%.17g", c->scene,
                            (double)radius, (double)(high * c->way[0]), (double)(high * c->way[1])));
    if (!strstr(c->scene, "-dimension"))
      PetscCall(PetscSNPrintf(options + strlen(options), 32, ",%.17g", (double)(high * c->way[2])));
    PetscCall(Measure(options, &series));
    PetscCall(PetscSNPrintf(what, sizeof(what), "diameter_of_cap_%d_on_%s", (int)k, c->wall));
    PetscCall(PetscSNPrintf(name, sizeof(name), "contact_diameter_%s_m", c->wall));
    CHECK_CLOSE(Value(&series, name), 2 * FOOT, 1, what);
    PetscCall(PetscSNPrintf(name, sizeof(name), "wetted_%s_%s", c->wall, flat ? "m" : "m2"));
    area = Value(&series, name);
    PetscCall(PetscSNPrintf(what, sizeof(what), "area_of_cap_%d_on_%s", (int)k, c->wall));
    CHECK_CLOSE(area, flat ? 2 * FOOT : FOOT * FOOT * PETSC_PI, flat ? 1 : FOOT * PETSC_PI, what);
    PetscCall(PetscSNPrintf(name, sizeof(name), "contact_angle_%s_degrees", c->wall));
    PetscCall(PetscSNPrintf(what, sizeof(what), "angle_of_cap_%d_on_%s", (int)k, c->wall));
    if (c->degrees == c->degrees) CHECK_CLOSE(Value(&series, name), c->angle, c->degrees, what);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Half an ellipsoid has its axes; a quarter of it, counted four times, has those of the whole: but for one particle in
   2375. */
static PetscErrorCode TestQuarter(void)
{
#define ELLIPSOID "-spacing 1 -bodies drop -drop_shape ellipsoid -drop_radii 14,9,9 -packing_jitter 0 -gauge_spread "
  static const char *const same[] = {"wetted_zmin_m2", "contact_long_zmin_m", "contact_short_zmin_m",
                                     "contact_angle_zmin_degrees", "spread_zmin_m"};
  Series                   whole, quarter;

  PetscFunctionBegin;
  PetscCall(Measure(SPACE ELLIPSOID, &whole));
  PetscCall(Measure(QUARTER ELLIPSOID "-gauge_multiplicity 4", &quarter));
  CHECK_CLOSE(Value(&whole, "contact_long_zmin_m"), 28, 1, "length_of_the_ellipse");
  CHECK_CLOSE(Value(&whole, "contact_short_zmin_m"), 18, 1, "width_of_the_ellipse");
  CHECK_CLOSE(Value(&whole, "spread_zmin_m"), 28, 1, "spread_of_the_ellipsoid");
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(same); k++)
    CHECK_CLOSE(Value(&quarter, same[k]) / Value(&whole, same[k]), 1, 2e-3, same[k]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A floor that liquid covers has no contact line, its side walls have one at the surface; a dry wall has no area. */
static PetscErrorCode TestPool(void)
{
  Series series;

  PetscFunctionBegin;
  PetscCall(Measure("-dimension 2 -spacing 1 -packing_jitter 0 -box_lower 0,0 -box_upper 60,40 -box_x wall -box_y wall "
                    "-bodies pool -pool_upper 60,20 -gauge_spread",
                    &series));
  CHECK_CLOSE(Value(&series, "wetted_ymin_m"), 60, 0.1, "a_floor_under_a_pool");
  CHECK_CLOSE(Value(&series, "wetted_xmin_m"), 20, 0.5, "a_wall_beside_a_pool");
  CHECK_CLOSE(Value(&series, "wetted_ymax_m"), 0, 0, "a_dry_ceiling");
  CHECK(PetscIsNanReal(Value(&series, "contact_angle_ymin_degrees")), "no_line_no_angle");
  CHECK_CLOSE(Value(&series, "contact_angle_xmax_degrees"), 90, 5, "a_pool_meets_its_wall");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A film on a floor and over a block, beside dry floor under liquid in the air. */
static PetscErrorCode TestFilm(void)
{
  const PetscReal exact[] = {1, 1, 0.63, 1, 0, 0};
  PetscInt        count, width;
  PetscReal      *rows;
  PetscMPIInt     rank;
  Setup           s;
  Gauges          gauges;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(SetupPack(TANK "-bodies a,b -a_lower 0,0.5 -a_upper 1.75,1.5 -b_lower 2.2,1.5 -b_upper 3,2 -gauge_film "
                           "0,2.5 -gauge_line_points 6",
                      &s));
  PetscCall(GaugesCreate(s.cloud, &gauges));
  PetscCall(GaugesSetFromOptions(gauges));
  PetscCall(GaugesTableRows(gauges, 0, 0, &count, &width, &rows));
  CHECK(count == (rank ? 0 : 6) && width == 3, "rows_of_a_film");
  for (PetscInt k = 0; k < count; k++) {
    CHECK_CLOSE(rows[width * k + 1], 0.5 * k, 1e-12, "place_on_the_line");
    CHECK_CLOSE(rows[width * k + 2], exact[k], 0.03, "thickness_of_the_film");
  }
  PetscCall(PetscFree(rows));
  PetscCall(GaugesDestroy(&gauges));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(LogRegister());
  PetscCall(TestCaps());
  PetscCall(TestQuarter());
  PetscCall(TestPool());
  PetscCall(TestFilm());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
