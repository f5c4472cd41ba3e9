/* Flow through outlets: columns of the series. */
#include "outlets_impl.h"

#define DEPTH 2 /* spacings in front of the face in which the rate is taken */

/* The outlets of the run; NULL: it has none. */
static const Outlets *RunOutlets(Gauges gauges)
{
  return (const Outlets *)StepperOwn((Stepper)GaugesRun(gauges), &GaugeOutlets);
}

static PetscErrorCode Columns_Outlets(Gauges gauges, const void *data, ColumnList *list)
{
  const Outlets *outlets = RunOutlets(gauges);

  PetscFunctionBegin;
  for (PetscInt f = 0; f < 2 * DIM && outlets; f++) {
    if (!outlets->face[f / 2][f % 2]->on) continue;
    PetscCall(ColumnAdd(list, (Column){.unit = "m3", .counts = COUNTS_SUM, .needs = NEEDS_PAST}, "outflow_%s",
                        FaceNames[f / 2][f % 2]));
    PetscCall(ColumnAdd(list, (Column){.unit = "m3/s", .counts = COUNTS_SUM, .needs = NEEDS_PAST}, "outflow_rate_%s",
                        FaceNames[f / 2][f % 2]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The volume that left, and the flux in front of the face: the sum of V v.n over a layer, over its depth. */
static PetscErrorCode Measure_Outlets(Gauges gauges, const void *data, PetscReal values[])
{
  const Outlets  *outlets = RunOutlets(gauges);
  const Cloud     cloud   = GaugesCloud(gauges);
  const Domain    domain  = cloud->domain;
  const PetscReal depth   = DEPTH * domain->spacing * DomainSizeMax(domain);
  ParticleArrays  arrays;
  PetscInt        n = 0;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(cloud->particles, &arrays));
  for (PetscInt f = 0; f < 2 * DIM && outlets; f++) {
    const PetscInt d    = f / 2;
    PetscReal      rate = 0;

    if (!outlets->face[d][f % 2]->on) continue;
    for (PetscInt a = 0; a < arrays.n; a++) {
      const PetscReal x = arrays.real[FIELD_POSITION][DIM * a + d], v = arrays.real[FIELD_VELOCITY][DIM * a + d];

      if (arrays.integer[INT_LAYER][a] || (f % 2 ? x < domain->upper[d] - depth : x > domain->lower[d] + depth))
        continue;
      rate += ParticleVolume(domain, &arrays, a) * (f % 2 ? v : -v) / depth;
    }
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &rate, 1, MPIU_REAL, MPIU_SUM, cloud->comm));
    values[n++] = outlets->so_far.left[f];
    values[n++] = rate;
  }
  PetscCall(ParticlesClose(cloud->particles, &arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const GaugeKind GaugeOutlets = {.columns = Columns_Outlets, .measure = Measure_Outlets};
