/* Pressure and velocity along lines: a block of rows of lines.csv at each snapshot. */
#include "gauges_impl.h"

#define LINE_POINTS  50 /* default of -gauge_line_points */
#define LINE_COLUMNS 8  /* line, position, pressure, velocity */

void LinePoints(const Places *lines, PetscInt width, PetscInt points, PetscReal at[])
{
  for (PetscInt p = 0; p < lines->count * points; p++) {
    const PetscReal *end = lines->at + 2 * width * (p / points), t = (PetscReal)(p % points) / (points - 1);

    for (PetscInt d = 0; d < width; d++) at[width * p + d] = (1 - t) * end[d] + t * end[width + d];
  }
}

static PetscErrorCode SetFromOptions_Lines(Gauges gauges, OptionItems PetscOptionsObject)
{
  Places *lines = &gauges->lines;

  PetscFunctionBegin;
  lines->numbers      = (GAUGE_LINES_MOST + 1) * 2 * DIM; /* room for one line too many, to refuse it */
  gauges->line_points = LINE_POINTS;
  PetscCall(
    PetscOptionsRealArray("-gauge_lines",
                          "Lines from x,y,z to x,y,z (six numbers a line, in two dimensions four), m: pressure and "
                          "velocity along them are written to lines.csv at each snapshot, nan inside solids; default: "
                          "none",
                          "PointsSample", lines->at, &lines->numbers, NULL));
  PetscCall(OptionInt("-gauge_line_points", "Points of a line, ends included", "[2, 10000]", &gauges->line_points));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Check_Lines(Gauges gauges)
{
  PetscFunctionBegin;
  PetscCall(
    PlacesCheck(gauges, "-gauge_lines", "line", 2, gauges->cloud->domain->dim, GAUGE_LINES_MOST, &gauges->lines));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool Wanted_Lines(Gauges gauges)
{
  return (PetscBool)(gauges->lines.count > 0);
}

static PetscErrorCode Head_Lines(Gauges gauges, char head[], size_t length)
{
  PetscFunctionBegin;
  PetscCall(PetscStrncpy(head, "line,x_m,y_m,z_m,pressure_Pa,velocity_x_m/s,velocity_y_m/s,velocity_z_m/s", length));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Rows_Lines(Gauges gauges, PetscInt *count, PetscInt *width, PetscReal **values)
{
  const PetscInt dim = gauges->cloud->domain->dim, points = gauges->line_points, n = gauges->lines.count * points;
  PetscReal     *at, *sampled; /* [n][dim], [n][1 + dim] */

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n * dim, &at, n * (1 + dim), &sampled));
  LinePoints(&gauges->lines, dim, points, at);
  PetscCall(PointsSample(gauges, n, at, sampled));
  *width = LINE_COLUMNS;
  *count = gauges->rank ? 0 : n;
  PetscCall(PetscCalloc1(*count * LINE_COLUMNS, values)); /* the third components are zero in two dimensions */
  for (PetscInt p = 0; p < *count; p++) {
    PetscReal *row = *values + LINE_COLUMNS * p;

    row[0] = (PetscReal)(p / points) + 1;
    PetscCall(PetscArraycpy(row + 1, at + dim * p, dim));
    PetscCall(PetscArraycpy(row + 1 + DIM, sampled + (1 + dim) * p, 1 + dim));
  }
  PetscCall(PetscFree2(at, sampled));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const GaugeKind GaugeLines = {.setfromoptions = SetFromOptions_Lines,
                              .check          = Check_Lines,
                              .file           = "lines.csv",
                              .wanted         = Wanted_Lines,
                              .head           = Head_Lines,
                              .rows           = Rows_Lines};
