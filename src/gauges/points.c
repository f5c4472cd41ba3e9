/* Pressure and velocity at fixed points: columns of the series. */
#include "gauges_impl.h"

static PetscErrorCode SetFromOptions_Points(Gauges gauges, OptionItems PetscOptionsObject)
{
  Places *points = &gauges->points;

  PetscFunctionBegin;
  points->numbers = (GAUGE_PLACES_MOST + 1) * DIM; /* room for one point too many, to refuse it */
  PetscCall(
    PetscOptionsRealArray("-gauge_points",
                          "Points x,y,z,x,y,z,... (in two dimensions x,y,x,y,...), m, whose pressure and velocity are "
                          "written to the series; in air the pressure is 0, inside a moving solid nan; default: none",
                          "PointsSample", points->at, &points->numbers, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Check_Points(Gauges gauges)
{
  const Scene    scene = gauges->cloud->scene;
  const PetscInt dim   = gauges->cloud->domain->dim;

  PetscFunctionBegin;
  PetscCall(PlacesCheck(gauges, "-gauge_points", "point", 1, dim, GAUGE_PLACES_MOST, &gauges->points));
  for (PetscInt k = 0; k < gauges->points.count * SceneSolidCount(scene); k++) {
    const PetscInt point  = k / SceneSolidCount(scene);
    const Body     solid  = SceneSolid(scene, k % SceneSolidCount(scene));
    PetscReal      x[DIM] = {0, 0, 0};

    PetscCall(PetscArraycpy(x, gauges->points.at + dim * point, dim));
    PetscCheckUser(BodyMoves(solid) || !InsideSolid(gauges, BodyDistance(solid, x)), gauges->comm,
                   "-gauge_points: point %d is inside the solid %s, which does not move; put it on the solid's surface "
                   "or into the liquid.",
                   (int)point + 1, BodyName(solid));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt Columns_Points(Gauges gauges)
{
  return gauges->points.count * (1 + gauges->cloud->domain->dim);
}

static PetscErrorCode Name_Points(Gauges gauges, PetscInt column, char name[], size_t length)
{
  const PetscInt width = 1 + gauges->cloud->domain->dim, point = column / width, part = column % width;

  PetscFunctionBegin;
  if (part == 0)
    PetscCall(PetscSNPrintf(name, length, "point_%d_pressure_Pa", (int)point + 1));
  else
    PetscCall(PetscSNPrintf(name, length, "point_%d_velocity_%c_m/s", (int)point + 1, AxisName(part - 1)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Measure_Points(Gauges gauges, PetscReal values[])
{
  PetscFunctionBegin;
  PetscCall(PointsSample(gauges, gauges->points.count, gauges->points.at, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const GaugeKind GaugePoints = {.setfromoptions = SetFromOptions_Points,
                               .check          = Check_Points,
                               .columns        = Columns_Points,
                               .name           = Name_Points,
                               .measure        = Measure_Points};
