/* The time series: CSV with a head line, one line for each due step, SI units; and the tables that gauges fill. */
#include "output_impl.h"

#define SERIES_FILE   "series.csv"
#define SERIES_DIGITS 12
#define TABLE_DIGITS  9
#define NAME_LENGTH   64  /* bytes of a column's name */
#define HEAD_LENGTH   160 /* bytes of a table's head, without time and step */

/* What the columns behind time and step are taken from. */
typedef struct {
  const StepState *state;
  GaugeTotals      totals;
  CraterValues     crater;
  PetscReal        wall; /* s */
} SeriesValues;

/* The columns behind time and step: name, unit ("": none), whether -gauge_crater is needed, value from v
   (SeriesValues). */
#define SERIES_COLUMNS(X)                                                                                              \
  X("time_step", "s", PETSC_FALSE, v->state->time_step)                                                                \
  X("crown_height", "m", PETSC_TRUE, v->crater.crown_height)                                                           \
  X("crater_depth", "m", PETSC_TRUE, v->crater.crater_depth)                                                           \
  X("crater_diameter", "m", PETSC_TRUE, v->crater.crater_diameter)                                                     \
  X("kinetic_energy", "J", PETSC_FALSE, v->totals.kinetic_energy)                                                      \
  X("iterations", "", PETSC_FALSE, v->state->iterations)                                                               \
  X("jet_height", "m", PETSC_TRUE, v->crater.jet_height)                                                               \
  X("highest", "m", PETSC_FALSE, v->totals.highest)                                                                    \
  X("potential_energy", "J", PETSC_FALSE, v->totals.potential_energy)                                                  \
  X("volume", "m3", PETSC_FALSE, v->totals.volume)                                                                     \
  X("density_error", "", PETSC_FALSE, v->state->density_error)                                                         \
  X("divergence", "", PETSC_FALSE, v->state->divergence)                                                               \
  X("solver_error", "", PETSC_FALSE, v->state->solver_error)                                                           \
  X("surface_energy", "J", PETSC_FALSE, v->totals.multiplicity * v->state->surface_energy)                             \
  X("viscous_work", "J", PETSC_FALSE, v->totals.multiplicity * v->state->viscous_work)                                 \
  X("tension_work", "J", PETSC_FALSE, v->totals.multiplicity * v->state->tension_work)                                 \
  X("outside_work", "J", PETSC_FALSE, v->totals.multiplicity *StepperOutsideWork(v->state))                            \
  X("particles", "", PETSC_FALSE, v->totals.particles)                                                                 \
  X("lost", "", PETSC_FALSE, v->state->lost)                                                                           \
  X("rejected", "", PETSC_FALSE, v->state->rejected)                                                                   \
  X("wall_time", "s", PETSC_FALSE, v->wall)

static const struct {
  const char *name, *unit;
  PetscBool   of_crater;
} columns[] = {
#define COLUMN(name, unit, of_crater, value) {name, unit, of_crater},
  SERIES_COLUMNS(COLUMN)
#undef COLUMN
};

#define COLUMNS ((PetscInt)PETSC_STATIC_ARRAY_LENGTH(columns))

/* Whether the run has a column. */
static PetscBool HasColumn(Output output, PetscInt column)
{
  return (PetscBool)(!columns[column].of_crater || GaugesHasCrater(output->gauges));
}

/* The head line, to be freed. */
static PetscErrorCode HeadLine(Output output, char **line)
{
  const PetscInt gauges = GaugesColumns(output->gauges);
  const size_t   length = (size_t)(COLUMNS + gauges + 2) * (NAME_LENGTH + 1);
  size_t         used;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(length, line));
  used = (size_t)snprintf(*line, length, "time_s,step");
  for (PetscInt c = 0; c < COLUMNS; c++)
    if (HasColumn(output, c))
      used += (size_t)snprintf(*line + used, length - used, ",%s%s%s", columns[c].name, columns[c].unit[0] ? "_" : "",
                               GaugeUnit(output->cloud->domain, columns[c].unit));
  for (PetscInt c = 0; c < gauges; c++) {
    char name[NAME_LENGTH];

    PetscCall(GaugesColumnName(output->gauges, c, name, sizeof(name)));
    used += (size_t)snprintf(*line + used, length - used, ",%s", name);
  }
  (void)snprintf(*line + used, length - used, "\n");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SeriesStart(Output output, PetscBool same, const StepState *state)
{
  char *head;

  PetscFunctionBegin;
  PetscCall(HeadLine(output, &head));
  PetscCall(TableOpen(output, SERIES_FILE, head, same, state->step, &output->series_file, &output->series_step));
  PetscCall(PetscFree(head));
  for (PetscInt t = 0; t < GaugesTables(output->gauges); t++) {
    const char *file;
    char        columns_of_gauge[HEAD_LENGTH], line[HEAD_LENGTH + 16];
    PetscInt    last;

    PetscCall(GaugesTableHead(output->gauges, t, &file, columns_of_gauge, sizeof(columns_of_gauge)));
    PetscCall(PetscSNPrintf(line, sizeof(line), "time_s,step,%s\n", columns_of_gauge));
    PetscCall(TableOpen(output, file, line, same, state->step, &output->table_file[t], &last));
    if (GaugesTableEvents(output->gauges, t)) { /* what is there at the start is no event */
      PetscInt   count, width;
      PetscReal *values;

      PetscCall(GaugesTableRows(output->gauges, t, state->time, &count, &width, &values));
      PetscCall(PetscFree(values));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The columns that the run has, behind time and step; returns how many. */
static PetscInt FillColumns(Output output, const SeriesValues *v, PetscReal line[COLUMNS])
{
  const PetscReal all[] = {
#define COLUMN(name, unit, of_crater, value) (PetscReal)(value),
    SERIES_COLUMNS(COLUMN)
#undef COLUMN
  };
  PetscInt n = 0;

  for (PetscInt c = 0; c < COLUMNS; c++)
    if (HasColumn(output, c)) line[n++] = all[c];
  return n;
}

PetscErrorCode SeriesWrite(Output output, const StepState *state)
{
  const PetscInt gauges = GaugesColumns(output->gauges);
  SeriesValues   v      = {.state = state};
  PetscReal     *line;
  PetscInt       n;
  int            error = 0;

  PetscFunctionBegin;
  if (GaugesHasCrater(output->gauges))
    PetscCall(GaugesCrater(output->gauges, &v.crater)); /* first: it measures the level */
  PetscCall(GaugesTotals(output->gauges, &v.totals));
  PetscCall(PetscMalloc1(COLUMNS + gauges, &line));
  v.wall = OutputWallTime(output);
  n      = FillColumns(output, &v, line);
  PetscCall(GaugesMeasure(output->gauges, line + n));
  if (!output->rank) error = TableWrite(output->series_file, state, SERIES_DIGITS, 1, n + gauges, line);
  PetscCall(PetscFree(line));
  PetscCall(FolderStatus(output, error, "write", SERIES_FILE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SeriesWriteTables(Output output, const StepState *state, PetscBool events)
{
  PetscFunctionBegin;
  for (PetscInt t = 0; t < GaugesTables(output->gauges); t++) {
    PetscInt    count, width;
    PetscReal  *values;
    const char *file;
    char        head[HEAD_LENGTH];
    int         error = 0;

    if (GaugesTableEvents(output->gauges, t) != events) continue;
    PetscCall(GaugesTableRows(output->gauges, t, state->time, &count, &width, &values));
    if (!output->rank) error = TableWrite(output->table_file[t], state, TABLE_DIGITS, count, width, values);
    PetscCall(PetscFree(values));
    PetscCall(GaugesTableHead(output->gauges, t, &file, head, sizeof(head)));
    PetscCall(FolderStatus(output, error, "write", file));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SeriesFinish(Output output)
{
  PetscFunctionBegin;
  if (output->series_file) fclose(output->series_file);
  for (PetscInt t = 0; t < GAUGE_TABLES_MOST; t++)
    if (output->table_file[t]) fclose(output->table_file[t]);
  PetscFunctionReturn(PETSC_SUCCESS);
}
