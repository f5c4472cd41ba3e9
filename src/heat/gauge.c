/* Temperatures: columns of the series. */
#include "heat_impl.h"

static PetscErrorCode Columns_Temperature(Gauges gauges, const void *data, ColumnList *list)
{
  const Column column = {.unit = "K", .counts = COUNTS_VALUE, .of = OF_SCENE};

  PetscFunctionBegin;
  if (!HeatOn(GaugesCloud(gauges)->scene, NULL)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ColumnAdd(list, column, "temperature_min"));
  PetscCall(ColumnAdd(list, column, "temperature_mean"));
  PetscCall(ColumnAdd(list, column, "temperature_max"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The mean is that of the heat: weighted by mass and capacity. */
static PetscErrorCode Measure_Temperature(Gauges gauges, const void *data, PetscReal values[])
{
  const Cloud    cloud      = GaugesCloud(gauges);
  PetscReal      sum[2]     = {0, 0};
  PetscReal      extreme[2] = {-PETSC_MAX_REAL, -PETSC_MAX_REAL}; /* -min, max */
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(cloud->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscInt  body = arrays.integer[INT_BODY][a];
    const PetscReal T    = arrays.real[FIELD_TEMPERATURE][a];
    PetscReal       heat;

    if (arrays.integer[INT_LAYER][a]) continue;
    heat = ParticleVolume(cloud->domain, &arrays, a) * BodyMaterial(SceneBody(cloud->scene, body))->density *
           HeatOf(cloud->scene, body)->capacity;
    sum[0] += heat * T;
    sum[1] += heat;
    extreme[0] = PetscMax(extreme[0], -T);
    extreme[1] = PetscMax(extreme[1], T);
  }
  PetscCall(ParticlesClose(cloud->particles, &arrays));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPIU_REAL, MPIU_SUM, cloud->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, extreme, 2, MPIU_REAL, MPIU_MAX, cloud->comm));
  values[0] = sum[1] > 0 ? -extreme[0] : NAN;
  values[1] = sum[1] > 0 ? sum[0] / sum[1] : NAN;
  values[2] = sum[1] > 0 ? extreme[1] : NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

const GaugeKind GaugeTemperature = {.columns = Columns_Temperature, .measure = Measure_Temperature};
