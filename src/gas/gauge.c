/* Pockets of gas: columns of the series, and a table of them. They are those of the last step, in whose middle they
   were found. */
#include "gas_impl.h"

typedef struct {
  PetscBool wanted; /* the table */
} PocketGauge;

static const OptionRow options[] = {
  {"-gauge_pockets",
   "Write pockets.csv: volume, pressure, amount and centre of each pocket of gas, with -gas, and how many of it the "
   "whole scene has; voids have the amount 0",
   NULL, NULL, ROW_BOOL, offsetof(PocketGauge, wanted)},
  {.name = NULL},
};

/* The gas of the run; NULL: it has none. */
static const Gas *RunGas(Gauges gauges)
{
  const Gas *gas = (const Gas *)StepperOwn((Stepper)GaugesRun(gauges), &GaugePockets);

  return gas && gas->on ? gas : NULL;
}

static PetscErrorCode Check_Pockets(Gauges gauges, void *data)
{
  PetscFunctionBegin;
  PetscCheckUser(!((PocketGauge *)data)->wanted || RunGas(gauges), GaugesCloud(gauges)->comm,
                 "-gauge_pockets needs -gas: without it there are no pockets of gas");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Columns_Pockets(Gauges gauges, const void *data, ColumnList *list)
{
  PetscFunctionBegin;
  if (!RunGas(gauges)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ColumnAdd(list, (Column){.counts = COUNTS_RUN, .needs = NEEDS_STEP}, "gas_pockets"));
  PetscCall(ColumnAdd(list, (Column){.unit = "m3", .counts = COUNTS_SUM, .needs = NEEDS_STEP}, "gas_volume"));
  PetscCall(ColumnAdd(list, (Column){.unit = "Pa", .counts = COUNTS_VALUE, .of = OF_SCENE, .needs = NEEDS_PRESSURE},
                      "gas_pressure_max"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Measure_Pockets(Gauges gauges, const void *data, PetscReal values[])
{
  const Pockets *pockets = &RunGas(gauges)->before;

  PetscFunctionBegin;
  values[0] = values[1] = 0;
  values[2]             = NAN;
  for (PetscInt k = 1; k <= pockets->count; k++) {
    if (PocketIsVoid(&pockets->pocket[k])) continue;
    values[0]++;
    values[1] += pockets->pocket[k].tracked;
    values[2] = values[0] > 1 ? PetscMax(values[2], pockets->pocket[k].pressure) : pockets->pocket[k].pressure;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ColumnsTable_Pockets(Gauges gauges, const void *data, ColumnList *list)
{
  const Column place = {.unit = "m", .counts = COUNTS_VALUE, .of = OF_PIECE};

  PetscFunctionBegin;
  if (!((const PocketGauge *)data)->wanted) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ColumnAdd(list, (Column){.counts = COUNTS_RUN, .of = OF_PIECE}, "pocket"));
  PetscCall(ColumnAdd(list, (Column){.unit = "m3", .counts = COUNTS_SUM, .of = OF_PIECE}, "volume"));
  PetscCall(ColumnAdd(list, (Column){.unit = "Pa", .counts = COUNTS_VALUE, .of = OF_PIECE, .needs = NEEDS_PRESSURE},
                      "pressure"));
  PetscCall(ColumnAdd(list, (Column){.unit = "m3", .counts = COUNTS_SUM, .of = OF_PIECE}, "amount"));
  PetscCall(ColumnAddVector(list, place, 0, DIM - 1, ""));
  PetscCall(ColumnAdd(list, (Column){.counts = COUNTS_VALUE, .of = OF_PIECE}, "number"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The mirrors that a pocket touches, and the axis of rings: [DIM], -1 at the lower, 1 at the upper face. */
static void FindMirrors(Domain domain, PetscInt faces, PetscReal mirror[DIM])
{
  PetscArrayzero(mirror, DIM);
  for (PetscInt f = 0; f < 2 * domain->dim; f++)
    if (faces >> f & 1 &&
        (domain->face[f / 2][f % 2] == FACE_SYMMETRY || (f % 2 == 0 && DomainIsRadial(domain, f / 2))))
      mirror[f / 2] = f % 2 ? 1 : -1;
}

static PetscErrorCode Rows_Pockets(Gauges gauges, void *data, PetscReal time, PetscInt *count, PetscReal **values)
{
  const PetscInt width   = 5 + DIM;
  const Domain   domain  = GaugesCloud(gauges)->domain;
  const Pockets *pockets = &RunGas(gauges)->before;
  PetscMPIInt    rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(GaugesCloud(gauges)->comm, &rank));
  *count = rank ? 0 : pockets->count;
  PetscCall(PetscMalloc1(width * *count, values));
  for (PetscInt k = 0; k < *count; k++) {
    const Pocket *pocket = &pockets->pocket[k + 1];
    PetscReal    *row = *values + width * k, *center = row + 4, larger, mirror[DIM];

    FindMirrors(domain, pockets->faces[k + 1], mirror);
    PetscCall(PetscArraycpy(center, pocket->center, DIM));
    if (DomainIsRadial(domain, 0) && mirror[0] != 0) center[0] = mirror[0] = 0; /* a whole one on the axis */
    larger = GaugeWhole(gauges, mirror, center, NULL, &center[DIM]);
    row[0] = k + 1;
    row[1] = larger * pocket->tracked;
    row[2] = pocket->pressure;
    row[3] = larger * pocket->amount;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const GaugeTable tables[] = {
  {.file = "pockets.csv", .columns = ColumnsTable_Pockets, .rows = Rows_Pockets, .events = PETSC_TRUE}, {.file = NULL}};

const GaugeKind GaugePockets = {.bytes   = sizeof(PocketGauge),
                                .options = options,
                                .check   = Check_Pockets,
                                .columns = Columns_Pockets,
                                .measure = Measure_Pockets,
                                .tables  = tables};
