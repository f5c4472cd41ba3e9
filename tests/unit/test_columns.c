/* Columns as rows. Whatever a run writes has a row, with a unit and a meaning. And what the rows say is so: the same
   state measured whole, as half and as quarter, with one size of particles and with two, in space and as rings, has the
   same numbers in all columns but those of the computation. Lengths in spacings. Runs on any number of ranks. */
#include "../../src/output/output_impl.h"
#include "setup.h"
#include "check.h"
#include <string.h>

#define COLUMNS_MOST 256
#define LINES_MOST   64
#define PLACES_MOST  16384
#define EXACT        1e-8 /* droplets.csv has nine digits */
#define CRATER       1.2  /* spacings: each depth of a crater is right to 0.6, see crater.c */

/* A tank with a floor and, of the whole, four sides; a post on its axis, and an obstacle on each side of it. Of the
   pool a drop and its spray come off. */
#define GAUGES                                                                                                         \
  " -gauge_forces -gauge_spread -gauge_droplets -gauge_droplet_main -gauge_pinch_off -gauge_crater -gauge_axis 0,0 "   \
  "-gauge_jet_radius 3 -gauge_level 6 -gauge_points 2.5,0.5,1.5,6,2.5,3.2 -gauge_heights 3,0.5,6.2,2.5 -gauge_neck z " \
  "-gauge_lines 1.5,0.5,2.5,7,0.5,2.5 -gauge_film 1.5,0.5,7,0.5 -gauge_line_points 5 -gauge_roughness "
#define FLAT_GAUGES                                                                                                    \
  " -gauge_forces -gauge_spread -gauge_droplets -gauge_droplet_main -gauge_pinch_off -gauge_crater -gauge_axis 0 "     \
  "-gauge_jet_radius 3 -gauge_level 6 -gauge_points 2.5,1.5,6,3.2 -gauge_heights 3,6.2 -gauge_neck y -gauge_lines "    \
  "1.5,2.5,7,2.5 -gauge_film 1.5,7 -gauge_line_points 5 -gauge_roughness "
#define COMMON                                                                                                         \
  "-spacing 1 -packing_jitter 0 -bodies water -output_overwrite -snapshot_interval 0 -post_lower -1,-1,-9 "            \
  "-post_upper 1,1,1 -right_lower 4,-1,-9 -right_upper 6,1,1 "
#define FLAT_COMMON                                                                                                    \
  "-dimension 2 -spacing 1 -packing_jitter 0 -bodies water -output_overwrite -snapshot_interval 0 "                    \
  "-post_lower -1,-9 "                                                                                                 \
  "-post_upper 1,1 "
#define RIGHT "-right_lower 4,-9 -right_upper 6,1 "

#define WHOLE                                                                                                          \
  "-box_lower -12,-12,0 -box_upper 12,12,16 -box_x wall -box_y wall -box_zmin wall -solids post,right,left "           \
  "-left_lower -6,-1,-9 -left_upper -4,1,1 -gravity 0,0,-10 "
#define FLAT_WHOLE                                                                                                     \
  "-box_lower -12,0 -box_upper 12,16 -box_x wall -box_ymin wall -solids post,right,left -left_lower -6,-9 "            \
  "-left_upper -4,1 -gravity 0,-10 "
/* Blocks of liquid in the air; a free solid, which has no half. */
#define BLOCKS "-gravity 0,-10 -gauge_droplets -gauge_heights 5 "
#define RAFT   "-solids post,raft -raft_lower 9,9 -raft_upper 11,11 -raft_mass 10 "
/* A round pool with its drop. */
#define ROUND " -gauge_forces -gauge_spread -gauge_droplets -gauge_crater -gauge_jet_radius 3 -gauge_level 6 "
#define RINGS                                                                                                          \
  "-dimension axisymmetric -spacing 1 -packing_jitter 0 -bodies water -output_overwrite -snapshot_interval 0 "         \
  "-gauge_axis 0 -gauge_points 2.5,1.5 -gauge_heights 7 -gauge_neck y -box_lower 0,0 -box_upper 12,16 -box_ymin wall " \
  "-solids post -post_lower 0,-9 -post_upper 2,1 -gravity 0,-10"

/* A column of a file: its row in words, and its numbers in the lines. */
typedef struct {
  char         file[32], head[COLUMN_NAME_LENGTH + 16], unit[16];
  ColumnCounts counts;
  ColumnOf     of;
  PetscInt     index;
  char         component;
  PetscBool    radial; /* the component of a sum that rings have no other for */
  PetscInt     lines;
  PetscReal    value[LINES_MOST];
} Numbers;

typedef struct {
  PetscInt count;
  Numbers  column[COLUMNS_MOST];
} Table;

static PetscBool uniform;    /* velocity */
static char      folder[64]; /* of the runs; another one for another number of ranks */

typedef int (*Liquid)(const PetscReal x[DIM]);

/* Whether the tank's liquid fills a place: a pool with a crater, a drop on the axis, one on each side, spray. The
   crater is that of a sphere. */
static int Tank(const PetscReal x[DIM])
{
  const PetscReal ax = PetscAbsReal(x[0]), ay = PetscAbsReal(x[1]), z = x[2], r2 = ax * ax + ay * ay;

  if ((ax < 1 && ay < 1 && z < 1) || (ax > 4 && ax < 6 && ay < 1 && z < 1)) return 0; /* solids */
  if (z < 6) return r2 + PetscSqr(z - 8) > 36;
  return r2 + PetscSqr(z - 11) < 5 || PetscSqr(ax - 6) + ay * ay + PetscSqr(z - 11) < 3 ||
         (ax > 3 && ax < 4 && (ay > 3 || ay == 0) && ay < 4 && z > 14 && z < 15);
}

/* The pool with its crater and the drop, round and away from the sides of the tank. */
static int Round(const PetscReal x[DIM])
{
  const PetscReal r2 = x[0] * x[0] + x[1] * x[1], z = x[2];

  if (r2 < 4 && z < 1) return 0; /* the post */
  if (z < 6) return r2 < 81 && r2 + PetscSqr(z - 8) > 36;
  return r2 + PetscSqr(z - 11) < 8;
}

/* A block of liquid on each side of the tank; on one side. */
static int Two(const PetscReal x[DIM])
{
  const PetscReal ax = PetscAbsReal(x[0]);

  return ax > 2 && ax < 8 && x[2] > 1 && x[2] < 8;
}

static int One(const PetscReal x[DIM])
{
  return x[0] > 0 && Two(x);
}

/* Pressure, velocity and the pressure of tension there: the same on both sides of a mirror. */
static void State(PetscInt layer, PetscInt up, const PetscReal x[DIM], PetscReal *p, PetscReal v[DIM])
{
  for (PetscInt d = 0; d < DIM && !layer; d++)
    v[d] = d > up ? 0 : uniform ? 3 * (d == up) : d == up ? 0.2 * x[up] - 1 : 0.1 * x[d];
  *p = 2000 - 100 * x[up] + 10 * PetscAbsReal(x[0]);
}

/* The places of a liquid in the box, on a lattice, and their sizes: with -spacing_coarse 2 where x > 0, as far as
   blocks of two are full. */
static PetscInt Places(const char options[], Liquid liquid, PetscReal x[], PetscInt size[])
{
  const PetscBool flat      = (PetscBool)(strstr(options, "-dimension") != NULL),
                  mixed     = (PetscBool)(strstr(options, "-spacing_coarse") != NULL);
  const PetscInt least[DIM] = {strstr(options, "-box_xmin symmetry") || strstr(options, "axisymmetric") ? 0 : -12,
                               flat || strstr(options, "-box_ymin symmetry") ? 0 : -12, 0};
  PetscInt n = 0;

  for (PetscInt k = least[2]; k < 16; k++)
    for (PetscInt j = least[1]; j < (flat ? 1 : 12); j++)
      for (PetscInt i = least[0]; i < 12; i++) {
        const PetscInt first[DIM] = {i & ~1, flat ? 0 : j & ~1, k & ~1}, at[DIM] = {i, j, k};
        PetscReal      place[DIM];
        PetscInt       full = 0, most = flat ? 4 : 8;

        for (PetscInt b = 0; b < 8 && mixed && i >= 0 && i < 10 && j >= -10 && j < 10 && k >= 4; b++) {
          const PetscReal in[DIM] = {first[0] + (b & 1) + 0.5, flat ? 0 : first[1] + (b >> 2) + 0.5,
                                     first[2] + (b >> 1 & 1) + 0.5};

          full += b < most && liquid(in);
        }
        size[n] = full == most ? 2 : 1;
        for (PetscInt d = 0; d < DIM; d++) place[d] = flat && d == 1 ? 0 : size[n] == 2 ? first[d] + 1 : at[d] + 0.5;
        if (size[n] == 2 ? at[0] != first[0] || at[1] != first[1] || at[2] != first[2] : !liquid(place)) continue;
        x[DIM * n]     = place[0];
        x[DIM * n + 1] = flat ? place[2] : place[1];
        x[DIM * n + 2] = flat ? 0 : place[2];
        n++;
      }
  return n;
}

/* --- what a run writes --- */

static PetscErrorCode Collect(void *context, const char file[], const Column *column, const ColumnWords *words)
{
  Table   *table = context;
  Numbers *to    = &table->column[PetscMin(table->count, COLUMNS_MOST - 1)];

  PetscFunctionBegin;
  table->count++;
  PetscCall(PetscStrncpy(to->file, file, sizeof(to->file)));
  PetscCall(PetscStrncpy(to->head, words->head, sizeof(to->head)));
  PetscCall(PetscStrncpy(to->unit, words->unit, sizeof(to->unit)));
  to->lines     = 0;
  to->counts    = column->counts;
  to->of        = column->of;
  to->index     = column->index;
  to->component = column->component;
  to->radial    = (PetscBool)!strcmp(words->direction, "radial");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads a file's lines into its columns; whether its head has exactly the rows' names. Rank 0. */
static PetscBool ReadFile(const char file[], Table *table)
{
  char      path[128], line[LINE_LENGTH], *next;
  PetscInt  first = 0, count = 0, lines = 0;
  PetscBool same = PETSC_TRUE;
  FILE     *stream;

  while (strcmp(table->column[first].file, file)) first++;
  while (first + count < table->count && !strcmp(table->column[first + count].file, file)) count++;
  (void)snprintf(path, sizeof(path), "%s/%s", folder, file);
  stream = fopen(path, "r");
  if (!stream || !fgets(line, sizeof(line), stream)) return PETSC_FALSE;
  line[strcspn(line, "\n")] = 0;
  for (PetscInt c = 0; c < count; c++) {
    const char *word = strtok_r(c ? NULL : line, ",", &next);

    same = (PetscBool)(same && word && !strcmp(word, table->column[first + c].head));
  }
  same = (PetscBool)(same && !*next);
  while (fgets(line, sizeof(line), stream) && lines < LINES_MOST) {
    for (PetscInt c = 0; c < count; c++) {
      const char *word = strtok_r(c ? NULL : line, ",", &next);

      same                                  = (PetscBool)(same && word);
      table->column[first + c].value[lines] = word ? atof(word) : NAN;
    }
    same = (PetscBool)(same && !*next);
    lines++;
  }
  (void)fclose(stream);
  for (PetscInt c = 0; c < count; c++) table->column[first + c].lines = lines;
  return same;
}

/* Fills a scene with a liquid, of size 2 below coarse, and gives what a run writes of this state. copies: of the part
   in the whole, which divide the sums that a run has. */
static PetscErrorCode Write(const char options[], Liquid liquid, PetscReal copies, const char name[], Table *table)
{
  const StepState state     = {.time           = 0.5,
                               .step           = 3,
                               .surface_energy = 12 / copies,
                               .viscous_work   = -8 / copies,
                               .tension_work   = 20 / copies,
                               .solid_work     = 4 / copies};
  const Viscosity viscosity = {.form = VISCOSITY_CLEARY};
  PetscReal      *x;
  PetscInt       *size;
  Setup           s;
  Gauges          gauges;
  Output          output;
  ParticleArrays  arrays;
  PetscMPIInt     rank;
  char            file[32] = "", text[128];

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(PetscMalloc2(DIM * PLACES_MOST, &x, PLACES_MOST, &size));
  PetscCall(SetupFill(options, Places(options, liquid, x, size), x, 3, &s));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    if (s.domain->graded && !arrays.integer[INT_LAYER][a])
      arrays.real[FIELD_VOLUME][a] = PetscPowRealInt(size[arrays.integer[INT_ID][a]], (int)s.domain->dim);
    State(arrays.integer[INT_LAYER][a], s.domain->dim - 1, arrays.real[FIELD_POSITION] + DIM * a,
          &arrays.real[FIELD_PRESSURE][a], arrays.real[FIELD_VELOCITY] + DIM * a);
  }
  PetscCall(PetscFree2(x, size));
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(CloudResync(s.cloud));
  PetscCall(SetupMoments(&s));
  for (PetscInt a = 0; a < s.cloud->n_owned; a++)
    s.cloud->field[FIELD_CAPILLARY][a] = 5 + s.cloud->field[FIELD_POSITION][DIM * a + s.domain->dim - 1];
  PetscCall(PetscOptionsSetValue(NULL, "-output_dir", folder));
  PetscCall(GaugesCreate(s.cloud, &gauges));
  PetscCall(GaugesSetFromOptions(gauges));
  GaugesSetForces(gauges, &viscosity, NULL, PETSC_TRUE);
  PetscCall(OutputCreate(s.cloud, gauges, &output));
  PetscCall(OutputSetFromOptions(output));
  PetscCall(OutputSetUp(output, NULL, &state));
  table->count = 0;
  PetscCall(OutputEachColumn(output, Collect, table));
  PetscCall(PetscSNPrintf(text, sizeof(text), "%s: number of columns", name));
  CHECK(table->count > 30 && table->count < COLUMNS_MOST, text);
  PetscCall(OutputStep(output, &state, PETSC_TRUE));
  PetscCall(OutputCheckpoint(output, &state));
  PetscCall(OutputDestroy(&output));
  PetscCall(GaugesDestroy(&gauges));
  PetscCall(SetupClose(&s));
  for (PetscInt c = 0; c < table->count && !rank; c++) {
    if (!strcmp(file, table->column[c].file) || !strcmp("snapshot", table->column[c].file)) continue;
    PetscCall(PetscStrncpy(file, table->column[c].file, sizeof(file)));
    PetscCall(
      PetscSNPrintf(text, sizeof(text), "%s: the head of %s has its rows, each line a number for each", name, file));
    CHECK(ReadFile(file, table), text);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- rows --- */

/* Each field of a snapshot has a row and its unit; each of these fields of a checkpoint, too. Rank 0. */
static PetscErrorCode CheckFields(const char file_name[], const Table *table, PetscInt others, const char name[])
{
  hid_t      file;
  PetscBool  good   = PETSC_TRUE;
  PetscInt   fields = 0;
  H5G_info_t info;
  char       text[128];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(text, sizeof(text), "%s/%s", folder, file_name));
  file = H5Fopen(text, H5F_ACC_RDONLY, H5P_DEFAULT);
  for (PetscInt c = 0; c < table->count; c++) {
    const Numbers *row       = &table->column[c];
    char           field[64] = "", unit[64] = "";
    hid_t          attribute, type;

    if (strcmp(row->file, "snapshot")) continue;
    fields++;
    PetscCall(PetscStrncpy(field, row->head, sizeof(field)));
    if (row->unit[0]) field[strlen(field) - strlen(row->unit) - 1] = 0;
    attribute = H5Aopen_by_name(file, field, "unit", H5P_DEFAULT, H5P_DEFAULT);
    type      = H5Aget_type(attribute);
    (void)H5Aread(attribute, type, unit);
    (void)H5Tclose(type);
    (void)H5Aclose(attribute);
    good = (PetscBool)(good && !strcmp(unit, row->unit[0] ? row->unit : "1"));
  }
  (void)H5Gget_info(file, &info);
  (void)H5Fclose(file);
  PetscCall(PetscSNPrintf(text, sizeof(text), "%s: fields of %s have their rows' units", name, file_name));
  CHECK(good && fields > 5 && (PetscInt)info.nlinks == fields + others, text);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Each row has a name of its own in its file, a unit of the list, and only a pure number has none. */
static PetscErrorCode CheckRows(const Table *table, PetscInt dim, const char name[])
{
  static const char *const        space[] = {"s",   "m",     "m/s", "Pa", "degrees", "kg/m3", "Pa s",
                                             "rad", "rad/s", "J",   "N",  "m2",      "m3",    ""},
                           *const plane[] = {"s",   "m",     "m/s", "Pa",  "degrees", "kg/m3", "Pa s",
                                             "rad", "rad/s", "J/m", "N/m", "m2",      ""};
  PetscBool                       good = PETSC_TRUE, alone = PETSC_TRUE;
  PetscMPIInt                     rank;
  char                            text[128];

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt c = 0; c < table->count; c++) {
    const Numbers *row   = &table->column[c];
    PetscBool      known = PETSC_FALSE;

    for (size_t k = 0; k < (dim == 2 ? PETSC_STATIC_ARRAY_LENGTH(plane) : PETSC_STATIC_ARRAY_LENGTH(space)); k++)
      known = (PetscBool)(known || !strcmp(row->unit, dim == 2 ? plane[k] : space[k]));
    good = (PetscBool)(good && known && row->head[0]);
    for (PetscInt k = 0; k < c; k++)
      alone =
        (PetscBool)(alone && (strcmp(row->file, table->column[k].file) || strcmp(row->head, table->column[k].head)));
  }
  PetscCall(PetscSNPrintf(text, sizeof(text), "%s: units of all columns", name));
  CHECK(good, text);
  PetscCall(PetscSNPrintf(text, sizeof(text), "%s: names of all columns", name));
  CHECK(alone, text);
  PetscCall(CheckFields("snapshot_000000.h5", table, 1, name));   /* and the group VTKHDF */
  PetscCall(CheckFields("checkpoint_000003.h5", table, 3, name)); /* and layer, parent, counts of ranks */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- what the rows say --- */

static const Numbers *Find(const Table *table, const char file[], const char head[])
{
  for (PetscInt c = 0; c < table->count; c++)
    if (!strcmp(table->column[c].file, file) && !strcmp(table->column[c].head, head)) return &table->column[c];
  return NULL;
}

/* The numbers of a column that both runs must have: those of its lines; of pieces of liquid, the sum over all copies.
 */
static PetscInt Comparable(const Table *table, const Numbers *column, PetscReal value[LINES_MOST])
{
  const Numbers *number = Find(table, column->file, "number");

  if (!number) {
    for (PetscInt k = 0; k < column->lines; k++) value[k] = column->value[k];
    return column->lines;
  }
  value[0] = 0;
  for (PetscInt k = 0; k < column->lines; k++)
    value[0] += column == number ? number->value[k] : number->value[k] * column->value[k];
  return column == number || column->counts == COUNTS_SUM;
}

/* How far columns may be apart: the share of the larger number, and a length for those in m. exact: columns of
   series.csv that may not. */
typedef struct {
  PetscReal share, length;
  PetscBool rings; /* the part is rings about the axis z of the whole */
} Limits;

static const char *const exact[] = {"kinetic_energy",
                                    "potential_energy",
                                    "volume",
                                    "highest",
                                    "droplet",
                                    "largest_droplet",
                                    "surface_energy",
                                    "viscous_work",
                                    "tension_work",
                                    "outside_work",
                                    "number",
                                    "step",
                                    "time"};

/* Columns that depend on the spacing by more than Limits say. */
static const char *const rough[] = {"contact_angle", "thread_diameter"};

/* The name in the whole of a column of rings: their axis is y. */
static void Turn(const char head[], char turned[COLUMN_NAME_LENGTH + 16])
{
  PetscInt n = 0;

  (void)snprintf(turned, COLUMN_NAME_LENGTH + 16, "%s", head);
  for (char *c = turned; *c; c++, n++)
    if (*c == 'y' && (n == 0 || c[-1] == '_') && (c[1] == '_' || !strncmp(c, "ymin", 4))) *c = 'z';
}

/* The largest distance of two numbers of a column that passes. */
static PetscReal Tolerance(const Table *whole, const Numbers *column, const Limits *limits, PetscInt line, PetscReal b)
{
  PetscReal scale = PetscAbsReal(b);

  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(exact) && !limits->rings; k++)
    if (!strncmp(column->head, exact[k], strlen(exact[k]))) return EXACT * (1 + scale);
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(rough) && limits->share > 0; k++)
    if (!strncmp(column->head, rough[k], strlen(rough[k]))) return 0.3 * scale;
  if (!strcmp(column->head, "crater_depth_m")) return PetscMax(CRATER, limits->length);
  for (PetscInt c = 0; c < whole->count; c++) { /* a component: of the vector's largest */
    const Numbers *other = &whole->column[c];

    if (column->component && other->component && !strcmp(other->file, column->file) && other->of == column->of &&
        other->index == column->index && !strcmp(other->unit, column->unit) && line < other->lines)
      scale = PetscMax(scale, PetscAbsReal(other->value[line]));
  }
  return EXACT + (EXACT + limits->share) * scale + (strcmp(column->unit, "m") ? 0 : limits->length);
}

/* All columns that two runs of the same state have, but those of the computation. */
static PetscErrorCode CheckSame(const Table *whole, const Table *part, PetscInt least, Limits limits, const char name[])
{
  PetscInt    shared = 0;
  PetscMPIInt rank;
  char        text[192], head[COLUMN_NAME_LENGTH + 16];

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt c = 0; c < part->count; c++) {
    const Numbers *of_part = &part->column[c], *of_whole;
    PetscReal      a[LINES_MOST], b[LINES_MOST];
    const PetscInt n = Comparable(part, of_part, a);

    PetscCall(PetscStrncpy(head, of_part->head, sizeof(head)));
    if (limits.rings) Turn(of_part->head, head);
    of_whole = Find(whole, of_part->file, head);
    if (!of_whole || !strcmp(of_part->file, "snapshot") || of_part->counts == COUNTS_RUN || of_part->radial) continue;
    PetscCall(PetscSNPrintf(text, sizeof(text), "%s: %s of %s", name, of_part->head, of_part->file));
    if (n != Comparable(whole, of_whole, b)) CHECK(PETSC_FALSE, text);
    for (PetscInt k = 0; k < n; k++)
      if (a[k] == a[k] || b[k] == b[k]) CHECK_CLOSE(a[k], b[k], Tolerance(whole, of_whole, &limits, k, b[k]), text);
    shared++;
  }
  PetscCall(PetscSNPrintf(text, sizeof(text), "%s: columns that are compared", name));
  CHECK(shared >= least, text);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestMirrors(void)
{
  Table *whole, *part;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(1, &whole, 1, &part));
  PetscCall(Write(COMMON GAUGES
                  "-box_lower -12,-12,0 -box_upper 12,12,16 -box_x wall -box_y wall -box_zmin wall -solids "
                  "post,right,left -left_lower -6,-1,-9 -left_upper -4,1,1 -gravity 0,0,-10",
                  Tank, 1, "whole", whole));
  PetscCall(CheckRows(whole, 3, "whole"));
  PetscCall(Write(COMMON GAUGES "-box_lower 0,-12,0 -box_upper 12,12,16 -box_xmin symmetry -box_xmax wall -box_y wall "
                                "-box_zmin wall -solids post,right -gravity 0,0,-10 -gauge_multiplicity 2",
                  Tank, 2, "half", part));
  PetscCall(CheckSame(whole, part, 60, (Limits){0}, "half"));
  PetscCall(Write(COMMON GAUGES "-box_lower 0,0,0 -box_upper 12,12,16 -box_xmin symmetry -box_xmax wall -box_ymin "
                                "symmetry -box_ymax wall -box_zmin wall -solids post,right -gravity 0,0,-10 "
                                "-gauge_multiplicity 4",
                  Tank, 4, "quarter", part));
  PetscCall(CheckSame(whole, part, 60, (Limits){0}, "quarter"));
  PetscCall(Write(FLAT_COMMON RIGHT FLAT_GAUGES FLAT_WHOLE, Tank, 1, "plane", whole));
  PetscCall(CheckRows(whole, 2, "plane"));
  PetscCall(Write(FLAT_COMMON RIGHT FLAT_GAUGES
                  "-box_lower 0,0 -box_upper 12,16 -box_xmin symmetry -box_xmax wall -box_ymin "
                  "wall -solids post,right -gravity 0,-10 -gauge_multiplicity 2",
                  Tank, 2, "half plane", part));
  PetscCall(CheckSame(whole, part, 40, (Limits){0}, "half plane"));
  PetscCall(Write(FLAT_COMMON BLOCKS "-solids post -box_lower -12,0 -box_upper 12,16", Two, 1, "blocks", whole));
  PetscCall(Write(FLAT_COMMON BLOCKS
                  "-solids post -box_lower 0,0 -box_upper 12,16 -box_xmin symmetry -gauge_multiplicity 2",
                  Two, 2, "one of two blocks", part));
  PetscCall(CheckSame(whole, part, 15, (Limits){0}, "one of two blocks"));
  PetscCall(PetscFree2(whole, part));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One size of particles and two; and a round pool in space and as rings. */
static PetscErrorCode TestOthers(void)
{
#define SIZES "-spacing_coarse 2 -fine everywhere -everywhere_shape half_space "
  Table *one, *other;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(1, &one, 1, &other));
  uniform = PETSC_TRUE;
  PetscCall(Write(COMMON GAUGES WHOLE, Tank, 1, "one size", one));
  PetscCall(
    Write(COMMON GAUGES WHOLE SIZES "-everywhere_normal 0,0,1 -everywhere_point 0,0,100", Tank, 1, "two sizes", other));
  PetscCall(CheckSame(one, other, 60, (Limits){.share = 0.15, .length = 0.6}, "two sizes"));
  PetscCall(Write(FLAT_COMMON RIGHT FLAT_GAUGES FLAT_WHOLE, Tank, 1, "one size in a plane", one));
  PetscCall(Write(FLAT_COMMON RIGHT FLAT_GAUGES FLAT_WHOLE SIZES "-everywhere_normal 0,1 -everywhere_point 0,100", Tank,
                  1, "two sizes in a plane", other));
  PetscCall(CheckRows(other, 2, "two sizes in a plane"));
  PetscCall(CheckSame(one, other, 40, (Limits){.share = 0.15, .length = 0.6}, "two sizes in a plane"));
  PetscCall(Write(FLAT_COMMON BLOCKS RAFT "-box_lower -12,0 -box_upper 12,16", One, 1, "block", one));
  PetscCall(Write(FLAT_COMMON BLOCKS RAFT "-box_lower -12,0 -box_upper 12,16 " SIZES
                                          "-everywhere_normal 0,1 -everywhere_point 0,100",
                  One, 1, "coarse block", other));
  PetscCall(CheckSame(one, other, 15, (Limits){.share = 0.15, .length = 0.6}, "coarse block"));
  PetscCall(Write(COMMON ROUND
                  "-gauge_axis 0,0 -gauge_points 2.5,0,1.5 -gauge_heights 7,0 -gauge_neck z -box_lower "
                  "-12,-12,0 -box_upper 12,12,16 -box_zmin wall -solids post -post_shape cylinder -post_radius 2 "
                  "-post_center 0,0,-4 -post_height 10 -gravity 0,0,-10",
                  Round, 1, "round", one));
  PetscCall(Write(RINGS ROUND, Round, 1, "rings", other));
  PetscCall(CheckRows(other, 3, "rings"));
  PetscCall(CheckSame(one, other, 20, (Limits){.share = 0.1, .length = 1, .rings = PETSC_TRUE}, "rings"));
  PetscCall(PetscFree2(one, other));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscMPIInt rank, size;
  char        remove[128];

  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(PetscSNPrintf(folder, sizeof(folder), "output/test_columns_%d", size));
  PetscCall(PetscSNPrintf(remove, sizeof(remove), "rm -rf %s", folder));
  PetscCall(LogRegister());
  PetscCall(TestMirrors());
  PetscCall(TestOthers());
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  if (!rank) CHECK(!system(remove), "folder removed");
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
