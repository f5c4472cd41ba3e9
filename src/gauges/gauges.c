/* The class: the list of the kinds of gauges, their common options, and their columns and tables. */
#include "../stepper/edge.h"
#include "gauges_impl.h"

static const GaugeKind *const own[] = {&GaugeCrater,   &GaugePoints, &GaugeHeights, &GaugeForces,
                                       &GaugeDroplets, &GaugeLines,  &GaugeNeck,    &GaugeRoughness};

/* Kind k of gauges in the order of their columns in the series, those of edges last; NULL: there are only k. */
static const GaugeKind *Kind(PetscInt k)
{
  const PetscInt n = PETSC_STATIC_ARRAY_LENGTH(own);

  if (k < n) return own[k];
  for (const Edge *const *edge = StepEdges; *edge; edge++)
    if ((*edge)->gauge && k-- == n) return (*edge)->gauge;
  return NULL;
}

PetscErrorCode GaugesCreate(Cloud cloud, Gauges *gauges)
{
  Gauges g;

  PetscFunctionBegin;
  PetscCall(PetscNew(&g));
  g->comm         = cloud->comm;
  g->cloud        = cloud;
  g->level        = NAN;
  g->multiplicity = 1;
  for (PetscInt k = 0; Kind(k); k++) {
    PetscCheck(k < GAUGE_KINDS, cloud->comm, PETSC_ERR_PLIB, "more than %d kinds of gauges", GAUGE_KINDS);
    PetscCall(PetscCalloc1(Kind(k)->bytes, (char **)&g->data[k]));
  }
  PetscCallMPI(MPI_Comm_rank(g->comm, &g->rank));
  PetscCallMPI(MPI_Comm_size(g->comm, &g->size));
  *gauges = g;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GaugesDestroy(Gauges *gauges)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; Kind(k); k++) {
    if (Kind(k)->destroy) PetscCall(Kind(k)->destroy((*gauges)->data[k]));
    PetscCall(PetscFree((*gauges)->data[k]));
  }
  for (PetscInt t = 0; t < GAUGE_TABLES_MOST; t++) PetscCall(PetscFree((*gauges)->table[t].columns.row));
  PetscCall(PetscFree((*gauges)->series.row));
  PetscCall(PetscFree(*gauges));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void GaugesSetRun(Gauges gauges, void *run)
{
  gauges->run = run;
}

void *GaugesRun(Gauges gauges)
{
  return gauges->run;
}

PetscReal GaugesMultiplicity(Gauges gauges)
{
  return gauges->multiplicity;
}

void GaugesSetRefresh(Gauges gauges, PetscErrorCode (*refresh)(void *context), void *context)
{
  gauges->refresh = refresh;
  gauges->context = context;
}

void GaugesSetForces(Gauges gauges, const Viscosity *viscosity, Pressure pressure, PetscBool tension)
{
  gauges->viscosity = viscosity;
  gauges->pressure  = pressure;
  gauges->corrected = (PetscBool)(!pressure || PressureGradientCorrected(pressure));
  gauges->tension   = tension;
  gauges->listed    = PETSC_FALSE;
}

static const OptionRow options[] = {
  {"-gauge_level", "Level of the undisturbed free surface, from which heights count", "m", NULL, ROW_REAL,
   offsetof(struct _p_Gauges, level), .fallback = "measured at the first state with -gauge_crater, else 0"},
  {"-gauge_multiplicity",
   "Copies of the simulated part that make the whole scene, 4 for a quarter: columns that are sums, as energies, "
   "volumes, forces and wetted areas, are those of the whole",
   "1", "(0, inf)", ROW_REAL, offsetof(struct _p_Gauges, multiplicity)},
  {.name = NULL},
};

PetscErrorCode GaugesSetFromOptions(Gauges gauges)
{
  PetscFunctionBegin;
  PetscOptionsBegin(gauges->comm, NULL, "Gauges: measurements", "Gauges");
  PetscCall(OptionsRead(PetscOptionsObject, options, __func__, gauges));
  for (PetscInt k = 0; Kind(k); k++) {
    if (Kind(k)->defaults) Kind(k)->defaults(gauges, gauges->data[k]);
    PetscCall(OptionsRead(PetscOptionsObject, Kind(k)->options, __func__, gauges->data[k]));
    if (Kind(k)->more) PetscCall(Kind(k)->more(gauges, PetscOptionsObject, gauges->data[k]));
  }
  PetscOptionsEnd();
  gauges->level_given = (PetscBool)!PetscIsInfOrNanReal(gauges->level);
  gauges->listed      = PETSC_FALSE;
  for (PetscInt k = 0; Kind(k); k++)
    if (Kind(k)->check) PetscCall(Kind(k)->check(gauges, gauges->data[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lists the rows of the series and of the tables that are written. */
static PetscErrorCode List(Gauges gauges)
{
  PetscFunctionBegin;
  if (gauges->listed) PetscFunctionReturn(PETSC_SUCCESS);
  gauges->series.count = gauges->tables = 0;
  for (PetscInt k = 0; Kind(k); k++) {
    if (Kind(k)->columns) PetscCall(Kind(k)->columns(gauges, gauges->data[k], &gauges->series));
    for (const GaugeTable *kind = Kind(k)->tables; kind && kind->file; kind++) {
      FilledTable *table = &gauges->table[gauges->tables];

      PetscCheck(gauges->tables < GAUGE_TABLES_MOST, gauges->comm, PETSC_ERR_PLIB, "Gauges have more tables");
      table->columns.count = 0;
      PetscCall(kind->columns(gauges, gauges->data[k], &table->columns));
      if (!table->columns.count) continue;
      table->kind = kind;
      table->data = gauges->data[k];
      gauges->tables++;
    }
    gauges->first[k + 1] = gauges->series.count;
  }
  gauges->listed = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- columns of the series --- */

PetscErrorCode GaugesColumns(Gauges gauges, PetscInt *count, const Column *columns[])
{
  PetscFunctionBegin;
  PetscCall(List(gauges));
  *count   = gauges->series.count;
  *columns = gauges->series.row;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the run has columns of a kind. */
static PetscBool Has(Gauges gauges, PetscInt k)
{
  return (PetscBool)(gauges->first[k + 1] > gauges->first[k]);
}

/* Moves the ghosts to where the particles are if a gauge reads sums over neighbours, and computes those anew if the
   particles have changed their order. */
static PetscErrorCode Refresh(Gauges gauges)
{
  const Cloud     cloud = gauges->cloud;
  const PetscBool old =
    (PetscBool)(!CloudIsCurrent(cloud, FIELD_CORRECTION) || !CloudIsCurrent(cloud, FIELD_CAPILLARY));
  PetscBool needed = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt k = 0; Kind(k); k++) needed = (PetscBool)(needed || (Kind(k)->needs_sums && Has(gauges, k)));
  if (needed) PetscCall(CloudUpdate(cloud, FIELD_POSITION));
  if (needed && old && gauges->refresh) PetscCall(gauges->refresh(gauges->context));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GaugesMeasure(Gauges gauges, PetscReal values[])
{
  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_GAUGES), 0, 0, 0, 0));
  PetscCall(List(gauges));
  PetscCall(Refresh(gauges));
  for (PetscInt k = 0; Kind(k); k++)
    if (Has(gauges, k)) PetscCall(Kind(k)->measure(gauges, gauges->data[k], values + gauges->first[k]));
  for (PetscInt c = 0; c < gauges->series.count; c++) values[c] *= GaugesFactor(gauges, &gauges->series.row[c]);
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_GAUGES), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- tables --- */

const char *GaugesTableFile(PetscInt t)
{
  for (PetscInt k = 0; Kind(k); k++)
    for (const GaugeTable *table = Kind(k)->tables; table && table->file; table++)
      if (t-- == 0) return table->file;
  return NULL;
}

PetscInt GaugesTables(Gauges gauges)
{
  return List(gauges) ? 0 : gauges->tables;
}

PetscBool GaugesTableEvents(Gauges gauges, PetscInt table)
{
  return gauges->table[table].kind->events;
}

PetscErrorCode GaugesTableColumns(Gauges gauges, PetscInt table, const char **file, PetscInt *count,
                                  const Column *columns[])
{
  PetscFunctionBegin;
  PetscCall(List(gauges));
  *file    = gauges->table[table].kind->file;
  *count   = gauges->table[table].columns.count;
  *columns = gauges->table[table].columns.row;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GaugesTableRows(Gauges gauges, PetscInt table, PetscReal time, PetscInt *count, PetscInt *width,
                               PetscReal **values)
{
  const FilledTable *filled;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_GAUGES), 0, 0, 0, 0));
  PetscCall(List(gauges));
  filled = &gauges->table[table];
  *width = filled->columns.count;
  PetscCall(filled->kind->rows(gauges, filled->data, time, count, values));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_GAUGES), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
