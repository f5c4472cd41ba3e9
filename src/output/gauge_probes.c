/* Further gauges: surface heights, forces and droplets as columns of the series; lines and lists of droplets as tables
   of their own, a block of rows a snapshot. */
#include "output_impl.h"
#include <errno.h>

#define LINE_POINTS_MOST 10000
#define DROPLET_COLUMNS  4

static const char *const AxisNames[DIM] = {"x", "y", "z"};

PetscErrorCode ProbesSetFromOptions(Output output, OptionItems PetscOptionsObject)
{
  GaugeProbes *probes = &output->probes;

  PetscFunctionBegin;
  probes->height_numbers = (GAUGE_HEIGHTS_MOST + 1) * (DIM - 1);
  probes->line_numbers   = (GAUGE_LINES_MOST + 1) * 2 * DIM;
  probes->line_points    = 50;
  probes->droplet_least  = 2;
  PetscCall(
    PetscOptionsRealArray("-gauge_heights",
                          "Places x,y,x,y,... (in two dimensions x,x,...) where the series holds the height of the "
                          "liquid that stands there without a gap, m",
                          "Output", probes->height_at, &probes->height_numbers, NULL));
  PetscCall(PetscOptionsRealArray("-gauge_lines",
                                  "Lines from x,y,z to x,y,z (six numbers a line, in two dimensions four) along which "
                                  "lines.csv holds pressure and velocity at each snapshot, m",
                                  "Output", probes->line_at, &probes->line_numbers, NULL));
  PetscCall(PetscOptionsInt("-gauge_line_points", "Points of a line, ends included, 2 to 10000", "Output",
                            probes->line_points, &probes->line_points, NULL));
  PetscCall(PetscOptionsBool("-gauge_forces",
                             "The series holds the force of the liquid on each wall of the box and each solid (N)",
                             "Output", probes->forces, &probes->forces, NULL));
  PetscCall(PetscOptionsBool("-gauge_droplets",
                             "The series holds number and volume of the droplets, droplets.csv lists them at each "
                             "snapshot: pieces that hang together (-gauge_connection), but for the largest",
                             "Output", probes->droplets, &probes->droplets, NULL));
  PetscCall(PetscOptionsInt("-gauge_droplet_least",
                            "Particles of the smallest droplet, 1 or more; smaller ones are spray", "Output",
                            probes->droplet_least, &probes->droplet_least, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckInside(Output output, const char option[], PetscInt wide, PetscInt numbers,
                                  const PetscReal at[])
{
  const Domain domain = output->cloud->domain;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < numbers; k++) {
    const PetscInt d = k % wide;

    PetscCheckUser(at[k] >= domain->lower[d] && at[k] <= domain->upper[d], output->comm,
                   "%s: %s = %g m is not in the box.", option, AxisNames[d], (double)at[k]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ProbesCheck(Output output)
{
  const PetscInt dim    = output->cloud->domain->dim;
  GaugeProbes   *probes = &output->probes;

  PetscFunctionBegin;
  PetscCheckUser(probes->height_numbers % (dim - 1) == 0, output->comm,
                 "-gauge_heights has %d numbers; it needs %d a place.", (int)probes->height_numbers, (int)dim - 1);
  probes->heights = probes->height_numbers / (dim - 1);
  PetscCheckUser(probes->heights <= GAUGE_HEIGHTS_MOST, output->comm, "-gauge_heights has more than %d places.",
                 GAUGE_HEIGHTS_MOST);
  PetscCheckUser(probes->line_numbers % (2 * dim) == 0, output->comm,
                 "-gauge_lines has %d numbers; it needs %d a line.", (int)probes->line_numbers, 2 * (int)dim);
  probes->lines = probes->line_numbers / (2 * dim);
  PetscCheckUser(probes->lines <= GAUGE_LINES_MOST, output->comm, "-gauge_lines has more than %d lines.",
                 GAUGE_LINES_MOST);
  PetscCheckUser(probes->line_points >= 2 && probes->line_points <= LINE_POINTS_MOST, output->comm,
                 "-gauge_line_points is %d; it must be from 2 to %d.", (int)probes->line_points, LINE_POINTS_MOST);
  PetscCheckUser(probes->droplet_least >= 1, output->comm, "-gauge_droplet_least is %d; it must be 1 or more.",
                 (int)probes->droplet_least);
  PetscCall(CheckInside(output, "-gauge_heights", dim - 1, probes->height_numbers, probes->height_at));
  PetscCall(CheckInside(output, "-gauge_lines", dim, probes->line_numbers, probes->line_at));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt ProbesColumns(Output output)
{
  const GaugeProbes *probes = &output->probes;

  return probes->heights + (probes->forces ? ForcesCount(output) * output->cloud->domain->dim : 0) +
         (probes->droplets ? DROPLET_COLUMNS : 0);
}

PetscErrorCode ProbesName(Output output, PetscInt column, char name[], size_t length)
{
  static const char *const droplet[DROPLET_COLUMNS] = {"droplets", "droplet_volume_%s", "largest_droplet_%s", "spray"};
  const GaugeProbes       *probes                   = &output->probes;
  const PetscInt           dim = output->cloud->domain->dim, forces = probes->forces ? ForcesCount(output) * dim : 0;

  PetscFunctionBegin;
  if (column < probes->heights)
    PetscCall(PetscSNPrintf(name, length, "height_%d_m", (int)column + 1));
  else if ((column -= probes->heights) < forces)
    PetscCall(PetscSNPrintf(name, length, "force_%s_%s_%s", ForcesName(output, column / dim), AxisNames[column % dim],
                            GaugeUnit(output, "N")));
  else
    PetscCall(PetscSNPrintf(name, length, droplet[column - forces], GaugeUnit(output, "m3")));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Number and volume (m3; m2 in two dimensions) of the droplets, the largest one's volume, particles of spray; on rank
 * 0. */
static PetscErrorCode MeasureDroplets(Output output, PetscReal value[DROPLET_COLUMNS])
{
  const PetscReal volume = output->cloud->domain->volume;
  PetscInt        count;
  Piece          *piece;

  PetscFunctionBegin;
  PetscCall(DropletsFind(output, &count, &piece));
  for (PetscInt c = 0; c < DROPLET_COLUMNS; c++) value[c] = 0;
  for (PetscInt k = 1; k < count; k++) {
    if (piece[k].particles < output->probes.droplet_least) {
      value[3] += piece[k].particles;
      continue;
    }
    value[0]++;
    value[1] += volume * piece[k].particles;
    value[2] = PetscMax(value[2], volume * piece[k].particles);
  }
  PetscCall(PetscFree(piece));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ProbesMeasure(Output output, PetscReal values[])
{
  const GaugeProbes *probes = &output->probes;

  PetscFunctionBegin;
  if (!ProbesColumns(output)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_GAUGES), 0, 0, 0, 0));
  if (probes->heights) PetscCall(HeightsMeasure(output, values));
  values += probes->heights;
  if (probes->forces) {
    PetscCall(ForcesMeasure(output, values));
    values += ForcesCount(output) * output->cloud->domain->dim;
  }
  if (probes->droplets) PetscCall(MeasureDroplets(output, values));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_GAUGES), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ProbesStart(Output output, PetscBool same, PetscInt restart_step)
{
  GaugeProbes *probes = &output->probes;
  PetscInt     last;
  char         head[128];

  PetscFunctionBegin;
  if (probes->lines)
    PetscCall(TableStart(output, "lines.csv",
                         "time_s,step,line,x_m,y_m,z_m,pressure_Pa,velocity_x_m/s,velocity_y_m/s,velocity_z_m/s\n",
                         same, restart_step, &probes->line_file, &last));
  if (!probes->droplets) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(head, sizeof(head),
                          "time_s,step,particles,volume_%s,x_m,y_m,z_m,velocity_x_m/s,velocity_y_m/s,velocity_z_m/s\n",
                          GaugeUnit(output, "m3")));
  PetscCall(TableStart(output, "droplets.csv", head, same, restart_step, &probes->droplet_file, &last));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteLines(Output output, const StepState *state)
{
  const PetscInt     dim = output->cloud->domain->dim, width = 1 + dim;
  const GaugeProbes *probes = &output->probes;
  const PetscInt     count  = probes->lines * probes->line_points;
  PetscReal         *at, *value;
  int                error = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(count * dim, &at, count * width, &value));
  for (PetscInt p = 0; p < count; p++) {
    const PetscReal *end = probes->line_at + 2 * dim * (p / probes->line_points),
                    t    = (PetscReal)(p % probes->line_points) / (probes->line_points - 1);

    for (PetscInt d = 0; d < dim; d++) at[dim * p + d] = (1 - t) * end[d] + t * end[dim + d];
  }
  PetscCall(PointsSample(output, count, at, value));
  for (PetscInt p = 0; p < count && !output->rank; p++) {
    const PetscReal *x = at + dim * p, *v = value + width * p;

    if (fprintf(probes->line_file, "%.12g,%d,%d,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", (double)state->time,
                (int)state->step, (int)(p / probes->line_points) + 1, (double)x[0], (double)x[1],
                dim == 3 ? (double)x[2] : 0, (double)v[0], (double)v[1], (double)v[2], dim == 3 ? (double)v[3] : 0) < 0)
      error = errno;
  }
  if (!output->rank && fflush(probes->line_file)) error = errno;
  PetscCall(PetscFree2(at, value));
  PetscCall(FolderStatus(output, error, "write", "lines.csv"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteDroplets(Output output, const StepState *state)
{
  const PetscReal volume = output->cloud->domain->volume;
  FILE           *file   = output->probes.droplet_file;
  PetscInt        count;
  Piece          *piece;
  int             error = 0;

  PetscFunctionBegin;
  PetscCall(DropletsFind(output, &count, &piece));
  for (PetscInt k = 1; k < count && piece[k].particles >= output->probes.droplet_least; k++) {
    const PetscReal *x = piece[k].place, *v = piece[k].velocity;

    if (fprintf(file, "%.12g,%d,%d,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", (double)state->time, (int)state->step,
                (int)piece[k].particles, (double)(volume * piece[k].particles), (double)x[0], (double)x[1],
                (double)x[2], (double)v[0], (double)v[1], (double)v[2]) < 0)
      error = errno;
  }
  if (!output->rank && fflush(file)) error = errno;
  PetscCall(PetscFree(piece));
  PetscCall(FolderStatus(output, error, "write", "droplets.csv"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ProbesWrite(Output output, const StepState *state)
{
  PetscFunctionBegin;
  if (output->probes.lines) PetscCall(WriteLines(output, state));
  if (output->probes.droplets) PetscCall(WriteDroplets(output, state));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ProbesFinish(Output output)
{
  PetscFunctionBegin;
  if (output->probes.line_file) fclose(output->probes.line_file);
  if (output->probes.droplet_file) fclose(output->probes.droplet_file);
  PetscFunctionReturn(PETSC_SUCCESS);
}
