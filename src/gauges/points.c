/* Pressure and velocity at fixed points: columns of the series. */
#include "gauges_impl.h"

static const OptionRow options[] = {
  {"-gauge_points",
   "Points (probes) x,y,z,x,y,z,... (in two dimensions x,y,x,y,...) whose pressure, velocity, temperature and "
   "concentration are written to the series; in open air the pressure is 0, in a pocket of gas its own, inside a "
   "moving solid nan",
   "m", NULL, ROW_NUMBERS, 0, .fallback = "none", .most = (GAUGE_PLACES_MOST + 1) * DIM},
  {.name = NULL},
};

static PetscErrorCode Check_Points(Gauges gauges, void *data)
{
  Places        *points = data;
  const Scene    scene  = gauges->cloud->scene;
  const PetscInt dim    = gauges->cloud->domain->dim;

  PetscFunctionBegin;
  PetscCall(PlacesCheck(gauges, "-gauge_points", "point", 1, dim, GAUGE_PLACES_MOST, points));
  for (PetscInt k = 0; k < points->count * SceneSolidCount(scene); k++) {
    const PetscInt point  = k / SceneSolidCount(scene);
    const Body     solid  = SceneSolid(scene, k % SceneSolidCount(scene));
    PetscReal      x[DIM] = {0, 0, 0};

    PetscCall(PetscArraycpy(x, points->at + dim * point, dim));
    PetscCheckUser(BodyMoves(solid) || !InsideSolid(gauges, BodyDistance(solid, x)), gauges->comm,
                   "-gauge_points: point %d is inside the solid %s, which does not move; put it on the solid's surface "
                   "or into the liquid.",
                   (int)point + 1, BodyName(solid));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Columns_Points(Gauges gauges, const void *data, ColumnList *list)
{
  FieldId        fields[FIELD_STORED_COUNT];
  const PetscInt dim = gauges->cloud->domain->dim, n = SampledFields(gauges, fields);

  PetscFunctionBegin;
  for (PetscInt p = 0; p < ((const Places *)data)->count; p++) {
    Column row = {.unit = "Pa", .counts = COUNTS_VALUE, .of = OF_PLACE, .index = p, .needs = NEEDS_PRESSURE};
    char   name[COLUMN_NAME_LENGTH];

    PetscCall(ColumnAdd(list, row, "point_%d_pressure", (int)p + 1));
    row.unit  = "m/s";
    row.needs = 0;
    PetscCall(PetscSNPrintf(name, sizeof(name), "point_%d_velocity", (int)p + 1));
    PetscCall(ColumnAddVector(list, row, 0, dim - 1, name));
    PetscCall(PetscSNPrintf(name, sizeof(name), "point_%d_", (int)p + 1));
    PetscCall(ColumnAddFields(list, row, n, fields, name));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Measure_Points(Gauges gauges, const void *data, PetscReal values[])
{
  const Places *points = data;

  PetscFunctionBegin;
  PetscCall(PointsSample(gauges, points->count, points->at, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const GaugeKind GaugePoints = {.bytes   = sizeof(Places),
                               .options = options,
                               .check   = Check_Points,
                               .columns = Columns_Points,
                               .measure = Measure_Points};
