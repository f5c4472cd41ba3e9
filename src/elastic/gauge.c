/* Polymers: columns of the series. */
#include "elastic_impl.h"

static PetscErrorCode Columns_Elastic(Gauges gauges, const void *data, ColumnList *list)
{
  PetscFunctionBegin;
  if (!ElasticOn(GaugesCloud(gauges)->scene, NULL)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ColumnAdd(list, (Column){.unit = "J", .counts = COUNTS_SUM, .of = OF_SCENE}, "elastic_energy"));
  PetscCall(ColumnAdd(list, (Column){.counts = COUNTS_VALUE, .of = OF_SCENE}, "stretch_max"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Measure_Elastic(Gauges gauges, const void *data, PetscReal values[])
{
  const Cloud    cloud  = GaugesCloud(gauges);
  PetscReal      energy = 0, most = 0;
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(cloud->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscReal *s = arrays.real[FIELD_STRETCH] + 6 * a;

    if (arrays.integer[INT_LAYER][a]) continue;
    energy += ParticleVolume(cloud->domain, &arrays, a) *
              PolymersEnergy(PolymersOf(cloud->scene, arrays.integer[INT_BODY][a]), s);
    most = PetscMax(most, s[0] + s[1] + s[2]);
  }
  PetscCall(ParticlesClose(cloud->particles, &arrays));
  PetscCallMPI(MPI_Allreduce(&energy, &values[0], 1, MPIU_REAL, MPIU_SUM, cloud->comm));
  PetscCallMPI(MPI_Allreduce(&most, &values[1], 1, MPIU_REAL, MPIU_MAX, cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const GaugeKind GaugeElastic = {.columns = Columns_Elastic, .measure = Measure_Elastic};
