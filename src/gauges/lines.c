/* Along lines, a block of rows at each snapshot: pressure, velocity and scalars (lines.csv), the thickness of the
   liquid on walls and solids below (film.csv). */
#include "gauges_impl.h"

#define LINE_POINTS 50 /* default of -gauge_line_points */

typedef struct {
  Places   lines, film;
  PetscInt points; /* of a line */
} Lines;

/* 'points' points of each line, ends included, at [lines][points][width] (m). width: coordinates of an end. */
static void LinePoints(const Places *lines, PetscInt width, PetscInt points, PetscReal at[])
{
  for (PetscInt p = 0; p < lines->count * points; p++) {
    const PetscReal *end = lines->at + 2 * width * (p / points), t = (PetscReal)(p % points) / (points - 1);

    for (PetscInt d = 0; d < width; d++) at[width * p + d] = (1 - t) * end[d] + t * end[width + d];
  }
}

static const OptionRow options[] = {
  {"-gauge_lines",
   "Lines from x,y,z to x,y,z (six numbers a line, in two dimensions four): pressure, velocity, temperature and "
   "concentration along them are written to lines.csv at each snapshot, nan inside solids",
   "m", NULL, ROW_NUMBERS, offsetof(Lines, lines), .fallback = "none", .most = (GAUGE_LINES_MOST + 1) * 2 * DIM},
  {"-gauge_line_points", "Points of a line, ends included", "1", "[2, 10000]", ROW_INT, offsetof(Lines, points)},
  {"-gauge_film",
   "Lines from x,y to x,y (four numbers a line, in two dimensions two): the thickness of the liquid on walls and "
   "solids below -gauge_line_points points of them is written to film.csv at each snapshot, 0 where they are dry",
   "m", NULL, ROW_NUMBERS, offsetof(Lines, film), .fallback = "none", .most = (GAUGE_LINES_MOST + 1) * 2 * (DIM - 1)},
  {.name = NULL},
};

static void Defaults_Lines(Gauges gauges, void *data)
{
  ((Lines *)data)->points = LINE_POINTS;
}

static PetscErrorCode Check_Lines(Gauges gauges, void *data)
{
  const PetscInt dim   = gauges->cloud->domain->dim;
  Lines         *lines = data;

  PetscFunctionBegin;
  PetscCall(PlacesCheck(gauges, "-gauge_lines", "line", 2, dim, GAUGE_LINES_MOST, &lines->lines));
  PetscCall(PlacesCheck(gauges, "-gauge_film", "line", 2, dim - 1, GAUGE_LINES_MOST, &lines->film));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows of a line's number and of the first 'coordinates' coordinates of a point. */
static PetscErrorCode ColumnsPlace(PetscInt coordinates, ColumnList *list)
{
  const Column place = {.unit = "m", .counts = COUNTS_VALUE, .of = OF_PLACE};

  PetscFunctionBegin;
  PetscCall(ColumnAdd(list, (Column){.counts = COUNTS_VALUE, .of = OF_PLACE}, "line"));
  PetscCall(ColumnAddVector(list, place, 0, coordinates - 1, ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Columns_Lines(Gauges gauges, const void *data, ColumnList *list)
{
  const Column pressure = {.unit = "Pa", .counts = COUNTS_VALUE, .of = OF_PLACE, .needs = NEEDS_PRESSURE},
               velocity = {.unit = "m/s", .counts = COUNTS_VALUE, .of = OF_PLACE};
  FieldId        fields[FIELD_STORED_COUNT];
  const PetscInt n = SampledFields(gauges, fields);

  PetscFunctionBegin;
  if (!((const Lines *)data)->lines.count) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ColumnsPlace(DIM, list));
  PetscCall(ColumnAdd(list, pressure, "pressure"));
  PetscCall(ColumnAddVector(list, velocity, 0, DIM - 1, "velocity"));
  PetscCall(ColumnAddFields(list, velocity, n, fields, ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Rows_Lines(Gauges gauges, void *data, PetscReal time, PetscInt *count, PetscReal **values)
{
  const Lines   *lines = data;
  FieldId        fields[FIELD_STORED_COUNT];
  const PetscInt dim = gauges->cloud->domain->dim, points = lines->points, n = lines->lines.count * points,
                 more = SampledFields(gauges, fields), got = 1 + dim + more, width = 2 + 2 * DIM + more;
  PetscReal *at, *sampled; /* [n][dim], [n][got] */

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n * dim, &at, n * got, &sampled));
  LinePoints(&lines->lines, dim, points, at);
  PetscCall(PointsSample(gauges, n, at, sampled));
  *count = gauges->rank ? 0 : n;
  PetscCall(PetscCalloc1(*count * width, values)); /* the third components are zero in two dimensions */
  for (PetscInt p = 0; p < *count; p++) {
    PetscReal *row = *values + width * p;

    row[0] = (PetscReal)(p / points) + 1;
    PetscCall(PetscArraycpy(row + 1, at + dim * p, dim));
    PetscCall(PetscArraycpy(row + 1 + DIM, sampled + got * p, 1 + dim));
    PetscCall(PetscArraycpy(row + 2 + 2 * DIM, sampled + got * p + 1 + dim, more));
  }
  PetscCall(PetscFree2(at, sampled));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Columns_Film(Gauges gauges, const void *data, ColumnList *list)
{
  PetscFunctionBegin;
  if (!((const Lines *)data)->film.count) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ColumnsPlace(gauges->cloud->domain->dim - 1, list));
  PetscCall(ColumnAdd(list, (Column){.unit = "m", .counts = COUNTS_VALUE, .of = OF_PLACE}, "thickness"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Rows_Film(Gauges gauges, void *data, PetscReal time, PetscInt *count, PetscReal **values)
{
  const Lines   *lines = data;
  const PetscInt flat = gauges->cloud->domain->dim - 1, n = lines->film.count * lines->points, width = 2 + flat;
  PetscReal     *at, *thickness; /* [n][flat], [n] */

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n * flat, &at, n, &thickness));
  LinePoints(&lines->film, flat, lines->points, at);
  PetscCall(HeightsSample(gauges, n, at, PETSC_TRUE, thickness));
  *count = gauges->rank ? 0 : n;
  PetscCall(PetscMalloc1(*count * width, values));
  for (PetscInt p = 0; p < *count; p++) {
    PetscReal *row = *values + width * p;

    row[0] = (PetscReal)(p / lines->points) + 1;
    PetscCall(PetscArraycpy(row + 1, at + flat * p, flat));
    row[1 + flat] = thickness[p];
  }
  PetscCall(PetscFree2(at, thickness));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const GaugeTable tables[] = {{.file = "lines.csv", .columns = Columns_Lines, .rows = Rows_Lines},
                                    {.file = "film.csv", .columns = Columns_Film, .rows = Rows_Film},
                                    {.file = NULL}};

const GaugeKind GaugeLines = {
  .bytes = sizeof(Lines), .options = options, .defaults = Defaults_Lines, .check = Check_Lines, .tables = tables};
