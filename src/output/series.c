/* The time series: CSV with a head line, one line for each due step, SI units; and the tables that gauges fill. */
#include "output_impl.h"

#define SERIES_DIGITS 12
#define TABLE_DIGITS  9

/* What the columns are taken from. */
typedef struct {
  const StepState *state;
  GaugeTotals      totals;
  PetscReal        wall; /* s */
} SeriesValues;

/* The columns before those of gauges: name, unit in space, what the number counts, what it needs; its value in the
   simulated part, from v (SeriesValues). Time and step are the first columns of each table. */
#define SERIES_COLUMNS(X)                                                                                              \
  X("time", "s", COUNTS_VALUE, 0, v->state->time)                                                                      \
  X("step", NULL, COUNTS_RUN, 0, v->state->step)                                                                       \
  X("time_step", "s", COUNTS_RUN, NEEDS_STEP, v->state->time_step)                                                     \
  X("pressure_time", "s", COUNTS_VALUE, NEEDS_PRESSURE, v->state->pressure_time)                                       \
  X("kinetic_energy", "J", COUNTS_SUM, 0, v->totals.kinetic_energy)                                                    \
  X("iterations", NULL, COUNTS_RUN, NEEDS_STEP, v->state->iterations)                                                  \
  X("highest", "m", COUNTS_VALUE, 0, v->totals.highest)                                                                \
  X("potential_energy", "J", COUNTS_SUM, NEEDS_GRAVITY, v->totals.potential_energy)                                    \
  X("volume", "m3", COUNTS_SUM, 0, v->totals.volume)                                                                   \
  X("density_error", NULL, COUNTS_RUN, 0, v->state->density_error)                                                     \
  X("divergence", NULL, COUNTS_RUN, 0, v->state->divergence)                                                           \
  X("solver_error", NULL, COUNTS_RUN, NEEDS_STEP, v->state->solver_error)                                              \
  X("surface_energy", "J", COUNTS_SUM, NEEDS_TENSION, v->state->surface_energy)                                        \
  X("viscous_work", "J", COUNTS_SUM, NEEDS_VISCOSITY | NEEDS_PAST, v->state->viscous_work)                             \
  X("tension_work", "J", COUNTS_SUM, NEEDS_TENSION | NEEDS_PAST, v->state->tension_work)                               \
  X("outside_work", "J", COUNTS_SUM, NEEDS_PAST, StepperOutsideWork(v->state))                                         \
  X("particles", NULL, COUNTS_RUN, 0, v->totals.particles)                                                             \
  X("lost", NULL, COUNTS_RUN, 0, v->state->lost)                                                                       \
  X("rejected", NULL, COUNTS_RUN, 0, v->state->rejected)                                                               \
  X("wall_time", "s", COUNTS_RUN, 0, v->wall)

static const Column own[] = {
#define COLUMN(name, unit, counts, needs, value) {name, unit, counts, OF_SCENE, 0, 0, needs},
  SERIES_COLUMNS(COLUMN)
#undef COLUMN
};

/* Whether a column is of the particles alone: neither of the steps before nor of the computation. */
static PetscBool IsMeasured(const Column *column)
{
  return (PetscBool)(!(column->needs & (NEEDS_STEP | NEEDS_PAST)) && column->counts != COUNTS_RUN);
}

#define OWN  ((PetscInt)PETSC_STATIC_ARRAY_LENGTH(own))
#define KEYS 2 /* time and step */

/* Calls visit for a table's columns: of 'own' the first so many, then those of gauges. */
static PetscErrorCode EachColumn(Output output, const char file[], PetscInt first, PetscInt gauges,
                                 const Column of_gauges[], ColumnVisitor visit, void *context)
{
  PetscFunctionBegin;
  for (PetscInt c = 0; c < first + gauges; c++) {
    const Column *column = c < first ? &own[c] : &of_gauges[c - first];
    ColumnWords   words;

    PetscCall(GaugesColumnWords(output->gauges, column, &words));
    PetscCall(visit(context, file, column, &words));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputEachColumn(Output output, ColumnVisitor visit, void *context)
{
  PetscInt      gauges;
  const Column *columns;
  const char   *file;

  PetscFunctionBegin;
  PetscCall(GaugesColumns(output->gauges, &gauges, &columns));
  PetscCall(EachColumn(output, OUTPUT_SERIES, OWN, gauges, columns, visit, context));
  for (PetscInt t = 0; t < GaugesTables(output->gauges); t++) {
    PetscCall(GaugesTableColumns(output->gauges, t, &file, &gauges, &columns));
    PetscCall(EachColumn(output, file, KEYS, gauges, columns, visit, context));
  }
  for (PetscInt f = 0; f < SNAPSHOT_FIELDS; f++) {
    const SnapshotField field = SnapshotFieldAt(f);

    if (output->content.fields & 1U << f)
      PetscCall(EachColumn(output, "snapshot", 0, 1, &field.column, visit, context));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Opens a file whose head has the words of its columns. */
typedef struct {
  const char *file;
  char        head[LINE_LENGTH];
} Head;

static PetscErrorCode AddToHead(void *context, const char file[], const Column *column, const ColumnWords *words)
{
  Head *h = context;

  PetscFunctionBegin;
  if (strcmp(file, h->file)) PetscFunctionReturn(PETSC_SUCCESS);
  if (h->head[0]) TextAppend(h->head, sizeof(h->head), ",");
  TextAppend(h->head, sizeof(h->head), words->head);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Start(Output output, const char file[], PetscBool same, PetscInt step, FILE **stream,
                            PetscInt *last)
{
  Head *head;

  PetscFunctionBegin;
  PetscCall(PetscNew(&head));
  head->file = file;
  PetscCall(OutputEachColumn(output, AddToHead, head));
  TextAppend(head->head, sizeof(head->head), "\n");
  PetscCall(TableOpen(output, file, head->head, same, step, stream, last));
  PetscCall(PetscFree(head));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SeriesStart(Output output, PetscBool same, const StepState *state)
{
  PetscFunctionBegin;
  PetscCall(Start(output, OUTPUT_SERIES, same, state->step, &output->series_file, &output->series_step));
  for (PetscInt t = 0; t < GaugesTables(output->gauges); t++) {
    const char   *file;
    const Column *columns;
    PetscInt      last, count, width;

    PetscCall(GaugesTableColumns(output->gauges, t, &file, &width, &columns));
    PetscCall(Start(output, file, same, state->step, &output->table_file[t], &last));
    if (GaugesTableEvents(output->gauges, t)) { /* what is there at the start is no event */
      PetscReal *values;

      PetscCall(GaugesTableRows(output->gauges, t, state->time, &count, &width, &values));
      PetscCall(PetscFree(values));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Before the first step: what one has to fill has no value yet. */
static void Blank(PetscInt count, const Column columns[], PetscReal values[])
{
  for (PetscInt c = 0; c < count; c++)
    if (columns[c].needs & (NEEDS_PRESSURE | NEEDS_STEP)) values[c] = NAN;
}

/* The columns of the whole scene. */
static void FillColumns(Output output, const SeriesValues *v, PetscReal line[])
{
  const PetscReal part[] = {
#define COLUMN(name, unit, counts, needs, value) (PetscReal)(value),
    SERIES_COLUMNS(COLUMN)
#undef COLUMN
  };

  for (PetscInt c = 0; c < OWN; c++) line[c] = GaugesFactor(output->gauges, &own[c]) * part[c];
}

PetscErrorCode OutputMeasure(Output output, const StepState *state, PetscInt *count, const PetscReal **values)
{
  SeriesValues  v = {.state = state};
  const Column *columns;

  PetscFunctionBegin;
  PetscCall(GaugesColumns(output->gauges, count, &columns));
  if (!output->line) PetscCall(PetscMalloc1(OWN + *count, &output->line));
  PetscCall(GaugesMeasure(output->gauges, output->line + OWN)); /* first: a crater measures the level */
  PetscCall(GaugesTotals(output->gauges, &v.totals));
  v.wall = OutputWallTime(output);
  FillColumns(output, &v, output->line);
  if (!state->step) {
    Blank(OWN, own, output->line);
    Blank(*count, columns, output->line + OWN);
  }
  *count += OWN;
  *values = output->line;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputMeasured(Output output, const StepState *state, FILE *file)
{
  const PetscReal *line = NULL;
  const Column    *columns;
  PetscInt         count;
  ColumnWords      words;

  PetscFunctionBegin;
  if (state) PetscCall(OutputMeasure(output, state, &count, &line));
  PetscCall(GaugesColumns(output->gauges, &count, &columns));
  for (PetscInt c = 0; c < OWN + count; c++) {
    const Column *column = c < OWN ? &own[c] : &columns[c - OWN];

    if (c >= KEYS && !IsMeasured(column)) continue;
    PetscCall(GaugesColumnWords(output->gauges, column, &words));
    if (state)
      (void)fprintf(file, "%s%.*g", c ? "," : "", SERIES_DIGITS,
                    column->of == OF_RECEIVER && column->needs & NEEDS_PRESSURE && !output->pressed ? NAN
                                                                                                    : (double)line[c]);
    else
      (void)fprintf(file, "%s%s", c ? "," : "", words.head);
  }
  (void)fputs("\n", file);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SeriesWrite(Output output, const StepState *state)
{
  const PetscReal *line;
  PetscInt         count;
  int              error = 0;

  PetscFunctionBegin;
  PetscCall(OutputMeasure(output, state, &count, &line));
  if (!output->rank) error = TableWrite(output->series_file, state, SERIES_DIGITS, 1, count - KEYS, line + KEYS);
  PetscCall(FolderStatus(output, error, "write", OUTPUT_SERIES));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SeriesWriteTables(Output output, const StepState *state, PetscBool events)
{
  PetscFunctionBegin;
  for (PetscInt t = 0; t < GaugesTables(output->gauges); t++) {
    PetscInt      count, width;
    PetscReal    *values;
    const char   *file;
    const Column *columns;
    int           error = 0;

    if (GaugesTableEvents(output->gauges, t) != events) continue;
    PetscCall(GaugesTableRows(output->gauges, t, state->time, &count, &width, &values));
    PetscCall(GaugesTableColumns(output->gauges, t, &file, &width, &columns));
    for (PetscInt r = 0; r < count && !state->step; r++) Blank(width, columns, values + r * width);
    if (!output->rank) error = TableWrite(output->table_file[t], state, TABLE_DIGITS, count, width, values);
    PetscCall(PetscFree(values));
    PetscCall(FolderStatus(output, error, "write", file));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

const PetscReal *OutputLine(Output output, PetscInt step)
{
  return output->series_step == step ? output->line : NULL;
}

PetscErrorCode SeriesFinish(Output output)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(output->line));
  if (output->series_file) fclose(output->series_file);
  for (PetscInt t = 0; t < GAUGE_TABLES_MOST; t++)
    if (output->table_file[t]) fclose(output->table_file[t]);
  PetscFunctionReturn(PETSC_SUCCESS);
}
