/* The class: the list of the kinds of gauges, and their common options. */
#include "gauges_impl.h"

/* In the order of their columns in the series. The output writes the columns of GaugeCrater. */
static const GaugeKind *const kinds[] = {&GaugeCrater, &GaugePoints,   &GaugeHeights, &GaugeForces,
                                         &GaugeBodies, &GaugeDroplets, &GaugeLines,   &GaugeSpread,
                                         &GaugeFilm,   &GaugeNeck,     &GaugePinchOff};

#define KINDS ((PetscInt)PETSC_STATIC_ARRAY_LENGTH(kinds))

PetscErrorCode GaugesCreate(Cloud cloud, Gauges *gauges)
{
  Gauges g;

  PetscFunctionBegin;
  PetscCall(PetscNew(&g));
  g->comm         = cloud->comm;
  g->cloud        = cloud;
  g->level        = NAN;
  g->multiplicity = 1;
  g->neck         = DIM;
  g->before       = -1;
  PetscCallMPI(MPI_Comm_rank(g->comm, &g->rank));
  PetscCallMPI(MPI_Comm_size(g->comm, &g->size));
  *gauges = g;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GaugesDestroy(Gauges *gauges)
{
  PetscFunctionBegin;
  PetscCall(PetscFree((*gauges)->piece_before));
  PetscCall(PetscFree(*gauges));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void GaugesSetRefresh(Gauges gauges, PetscErrorCode (*refresh)(void *context), void *context)
{
  gauges->refresh = refresh;
  gauges->context = context;
}

void GaugesSetForces(Gauges gauges, const Viscosity *viscosity, PetscBool corrected, PetscBool tension)
{
  gauges->viscosity = viscosity;
  gauges->corrected = corrected;
  gauges->tension   = tension;
}

PetscErrorCode GaugesSetFromOptions(Gauges gauges)
{
  PetscFunctionBegin;
  PetscOptionsBegin(gauges->comm, NULL, "Gauges: measurements", "Gauges");
  PetscCall(PetscOptionsReal("-gauge_level",
                             "Level of the undisturbed free surface (m): heights count from it; nan: measured at the "
                             "first state with -gauge_crater, else 0",
                             "GaugesLevel", gauges->level, &gauges->level, NULL));
  PetscCall(PetscOptionsReal("-gauge_multiplicity",
                             "Copies of the simulated part that make the whole scene, 4 for a quarter: factor of "
                             "energies, volume and droplets (1)",
                             "GaugesTotals", gauges->multiplicity, &gauges->multiplicity, NULL));
  for (PetscInt k = 0; k < KINDS; k++)
    if (kinds[k]->setfromoptions) PetscCall(kinds[k]->setfromoptions(gauges, PetscOptionsObject));
  PetscOptionsEnd();
  gauges->level_given = (PetscBool)!PetscIsInfOrNanReal(gauges->level);
  PetscCheckUser(gauges->multiplicity > 0, gauges->comm, "-gauge_multiplicity is %g; it must be positive.",
                 (double)gauges->multiplicity);
  for (PetscInt k = 0; k < KINDS; k++)
    if (kinds[k]->check) PetscCall(kinds[k]->check(gauges));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GaugesView(Gauges gauges, PetscViewer viewer)
{
  const CraterSetup *crater = &gauges->crater;

  PetscFunctionBegin;
  if (!crater->wanted) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscViewerASCIIPrintf(viewer, "  gauges: axis %g %g m, jet radius %g m, crater radius %g m, pool %s\n",
                                   (double)crater->axis[0], (double)crater->axis[1], (double)crater->jet_radius,
                                   (double)crater->radius, crater->pool_name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool GaugesHasCrater(Gauges gauges)
{
  return gauges->crater.wanted;
}

/* --- columns of the series --- */

static PetscInt Columns(Gauges gauges, PetscInt k)
{
  return kinds[k]->columns ? kinds[k]->columns(gauges) : 0;
}

PetscInt GaugesColumns(Gauges gauges)
{
  PetscInt columns = 0;

  for (PetscInt k = 0; k < KINDS; k++) columns += Columns(gauges, k);
  return columns;
}

PetscErrorCode GaugesColumnName(Gauges gauges, PetscInt column, char name[], size_t length)
{
  PetscInt k = 0;

  PetscFunctionBegin;
  while (column >= Columns(gauges, k)) column -= Columns(gauges, k++);
  PetscCall(kinds[k]->name(gauges, column, name, length));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Computes the sums over neighbours anew if a gauge reads them and the particles have changed their order. */
static PetscErrorCode Refresh(Gauges gauges)
{
  const Cloud     cloud = gauges->cloud;
  const PetscBool old =
    (PetscBool)(!CloudIsCurrent(cloud, FIELD_CORRECTION) || !CloudIsCurrent(cloud, FIELD_CAPILLARY));
  PetscBool needed = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < KINDS; k++) needed = (PetscBool)(needed || (kinds[k]->needs_sums && Columns(gauges, k)));
  if (needed && old && gauges->refresh) PetscCall(gauges->refresh(gauges->context));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GaugesMeasure(Gauges gauges, PetscReal values[])
{
  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_GAUGES), 0, 0, 0, 0));
  PetscCall(Refresh(gauges));
  for (PetscInt k = 0; k < KINDS; k++) {
    const PetscInt columns = Columns(gauges, k);

    if (columns) PetscCall(kinds[k]->measure(gauges, values));
    values += columns;
  }
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_GAUGES), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- tables --- */

PetscInt GaugesTables(Gauges gauges)
{
  PetscInt tables = 0;

  for (PetscInt k = 0; k < KINDS; k++) tables += kinds[k]->file && kinds[k]->wanted(gauges);
  return tables;
}

static const GaugeKind *TableKind(Gauges gauges, PetscInt table)
{
  PetscInt k = 0;

  while (!(kinds[k]->file && kinds[k]->wanted(gauges) && table-- == 0)) k++;
  return kinds[k];
}

PetscBool GaugesTableEvents(Gauges gauges, PetscInt table)
{
  return TableKind(gauges, table)->events;
}

PetscErrorCode GaugesTableHead(Gauges gauges, PetscInt table, const char **file, char head[], size_t length)
{
  const GaugeKind *kind = TableKind(gauges, table);

  PetscFunctionBegin;
  *file = kind->file;
  PetscCall(kind->head(gauges, head, length));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GaugesTableRows(Gauges gauges, PetscInt table, PetscReal time, PetscInt *count, PetscInt *width,
                               PetscReal **values)
{
  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_GAUGES), 0, 0, 0, 0));
  gauges->time = time;
  PetscCall(TableKind(gauges, table)->rows(gauges, count, width, values));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_GAUGES), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
