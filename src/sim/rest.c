/* -stop_at_rest: the run ends when columns of its series rest, which is when each has stayed within REST of its range
   throughout the second half of the run. A column that has changed by less than that of its largest value proves
   nothing: the kinetic energy of a drop in flight is constant, too. The window grows with the run, so that the
   criterion has no time of its own: what decays exponentially is within 5e-4 of its end when it stops, and a spreading
   drop, whose radius grows by a power of the time, does not rest before a contact angle holds it. A restart watches
   from its own start. */
#include "sim_impl.h"

#define REST        0.02 /* of the range of a column */
#define LINES_LEAST 10   /* of the series in the second half */
#define PATIENCE    50   /* the curve is judged each time that it has grown by this fraction of it */

static const char *const energies[] = {"kinetic_energy", "potential_energy", "surface_energy"};

static const OptionRow options[] = {
  {"-stop_at_rest",
   "The run ends before -time_end when each of these columns of series.csv has stayed within 2 % of its range in the "
   "second half of the run, no solid moves by itself, and nothing is still to begin or swing; alone: the energies",
   NULL, NULL, ROW_NAMES, 0, .fallback = "none", .most = REST_COLUMNS},
  {.name = NULL},
};

PetscErrorCode RestSetFromOptions(Sim sim)
{
  RestWatch *rest = &sim->rest;
  PetscBool  alone;

  PetscFunctionBegin;
  PetscCall(OptionsReadBlock(sim->comm, "End at rest", options, __func__, &rest->names));
  PetscCall(PetscOptionsHasName(NULL, NULL, options[0].name, &alone));
  if (rest->names.count) alone = PETSC_FALSE;
  for (size_t k = 0; alone && k < PETSC_STATIC_ARRAY_LENGTH(energies); k++)
    PetscCall(PetscStrallocpy(energies[k], &rest->names.text[rest->names.count++]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The names of the columns of a series. */
typedef struct {
  RestWatch *rest;
  char       names[NAMES_LENGTH];
  PetscInt   columns, found;
} Search;

static PetscErrorCode Compare(void *context, const char file[], const Column *column, const ColumnWords *words)
{
  Search   *search = context;
  PetscBool same;

  PetscFunctionBegin;
  (void)words;
  PetscCall(PetscStrcmp(file, OUTPUT_SERIES, &same));
  if (!same) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < search->rest->names.count; k++) {
    PetscCall(PetscStrcmp(search->rest->names.text[k], column->name, &same));
    if (same) search->rest->column[k] = search->columns;
  }
  if (search->columns++) TextAppend(search->names, sizeof(search->names), ", ");
  TextAppend(search->names, sizeof(search->names), column->name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RestSetUp(Sim sim)
{
  RestWatch *rest = &sim->rest;
  Search    *search;

  PetscFunctionBegin;
  PetscCall(PetscNew(&search));
  search->rest = rest;
  for (PetscInt k = 0; k < rest->names.count; k++) rest->column[k] = -1;
  PetscCall(OutputEachColumn(sim->output, Compare, search));
  for (PetscInt k = 0; k < rest->names.count; k++)
    PetscCheckUser(rest->column[k] >= 0, sim->comm, "-stop_at_rest: the series has no column %s; it has %s",
                   rest->names.text[k], search->names);
  PetscCall(PetscFree(search));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds a line to the curves. */
static PetscErrorCode Append(RestWatch *rest, const PetscReal line[])
{
  const PetscInt width = 1 + rest->names.count;
  PetscReal     *row;

  PetscFunctionBegin;
  PetscCall(ListGrow(rest->lines, &rest->capacity, (size_t)width * sizeof(PetscReal), &rest->curve));
  row    = rest->curve + width * rest->lines++;
  row[0] = line[0];
  for (PetscInt k = 0; k < rest->names.count; k++) row[1 + k] = line[rest->column[k]];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether all columns rest in the lines from 'half' on; a column that hardly changes proves nothing, and
   one without a value does not rest. */
static PetscBool Rests(const RestWatch *rest, PetscInt half)
{
  const PetscInt width = 1 + rest->names.count;
  PetscBool      any   = PETSC_FALSE;

  for (PetscInt k = 1; k < width; k++) {
    PetscReal low = PETSC_MAX_REAL, high = PETSC_MIN_REAL, late_low = low, late_high = high;

    for (PetscInt i = 0; i < rest->lines; i++) {
      const PetscReal value = rest->curve[width * i + k];

      if (PetscIsInfOrNanReal(value) && i < half) continue; /* a droplet that is not there yet */
      if (PetscIsInfOrNanReal(value)) return PETSC_FALSE;
      low  = PetscMin(low, value);
      high = PetscMax(high, value);
      if (i < half) continue;
      late_low  = PetscMin(late_low, value);
      late_high = PetscMax(late_high, value);
    }
    if (high - low <= REST * PetscMax(PetscAbsReal(low), PetscAbsReal(high))) continue;
    if (late_high - late_low > REST * (high - low)) return PETSC_FALSE;
    any = PETSC_TRUE;
  }
  return any;
}

/* Whether the scene has something that begins, ends or turns after a time (s). */
static PetscBool Awaits(Sim sim, PetscReal time)
{
  PetscReal moment[2];

  return (PetscBool)(SceneMoments(sim->scene, time, sim->time_end, 2, moment) > 1);
}

PetscErrorCode RestCheck(Sim sim, PetscBool *rests)
{
  RestWatch       *rest  = &sim->rest;
  const PetscReal *line  = OutputLine(sim->output, sim->state.step);
  const PetscInt   width = 1 + rest->names.count;
  PetscReal        start, middle = 0;
  PetscInt         half = 0;
  PetscMPIInt      rank;

  PetscFunctionBegin;
  *rests = PETSC_FALSE;
  if (!rest->names.count || !line) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Comm_rank(sim->comm, &rank));
  if (!rank)
    PetscCall(Append(rest, line));
  else
    rest->lines++;
  if (rest->lines < rest->next) PetscFunctionReturn(PETSC_SUCCESS);
  rest->next = rest->lines + rest->lines / PATIENCE + 1;
  if (!rank) {
    start  = rest->curve[0];
    middle = 0.5 * (start + sim->state.time);
    while (half < rest->lines && rest->curve[width * half] < middle) half++;
    *rests = (PetscBool)(rest->lines - half >= LINES_LEAST && Rests(rest, half) && !Awaits(sim, sim->state.time));
  }
  PetscCallMPI(MPI_Bcast(rests, 1, MPIU_BOOL, 0, sim->comm));
  if (*rests)
    PetscCall(PetscPrintf(sim->comm, "at rest at %g s: %s stayed within %d %% of %s range since %g s\n",
                          (double)sim->state.time,
                          rest->names.count > 1 ? "the columns of -stop_at_rest" : rest->names.text[0],
                          (int)(100 * REST), rest->names.count > 1 ? "their" : "its", (double)middle));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RestDestroy(Sim sim)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < sim->rest.names.count; k++) PetscCall(PetscFree(sim->rest.names.text[k]));
  PetscCall(PetscFree(sim->rest.curve));
  PetscFunctionReturn(PETSC_SUCCESS);
}
