/* Scalars as columns of the series: extremes and mean, and what faces, solids and the air give. */
#include "heat_impl.h"

/* Whether receiver r gives the liquid some of a scalar. */
static PetscBool Gives(Scene scene, const Scalar *scalar, PetscInt r)
{
  if (r == OF_AIR) return (PetscBool)(scalar->air && ((const Air *)SceneOwn(scene, scalar->air))->transfer > 0);
  return (PetscBool)(r < 2 * DIM + SceneSolidCount(scene) && SideOf(scene, scalar, r));
}

/* The receiver as the gauges of forces number it: wall faces, then solids; -1: the air. */
static PetscInt Numbered(Domain domain, PetscInt r)
{
  PetscInt       direction, side;
  const PetscInt faces = GaugeWallFace(domain, -1, NULL, NULL);

  if (r == OF_AIR) return -1;
  if (r >= 2 * DIM) return faces + r - 2 * DIM;
  for (PetscInt k = 0; k < faces; k++) {
    (void)GaugeWallFace(domain, k, &direction, &side);
    if (2 * direction + side == r) return k;
  }
  return -1;
}

static PetscErrorCode Columns_Scalars(Gauges gauges, const void *data, ColumnList *list)
{
  const Cloud cloud = GaugesCloud(gauges);

  PetscFunctionBegin;
  for (const Scalar *scalar = Scalars; scalar < Scalars + SCALARS; scalar++) {
    const Column column = {.unit = scalar->unit, .counts = COUNTS_VALUE, .of = OF_SCENE};

    if (!ScalarOn(cloud->scene, scalar)) continue;
    PetscCall(ColumnAdd(list, column, "%s_min", scalar->name));
    PetscCall(ColumnAdd(list, column, "%s_mean", scalar->name));
    PetscCall(ColumnAdd(list, column, "%s_max", scalar->name));
    for (PetscInt r = 0; r < RECEIVERS; r++) {
      const PetscInt index = Gives(cloud->scene, scalar, r) ? Numbered(cloud->domain, r) : -1;

      if (!Gives(cloud->scene, scalar, r)) continue;
      PetscCall(ColumnAdd(list,
                          (Column){.unit   = scalar->flow_unit,
                                   .counts = COUNTS_SUM,
                                   .of     = r == OF_AIR ? OF_SCENE : OF_RECEIVER,
                                   .index  = r == OF_AIR ? 0 : index},
                          "%s_from_%s", scalar->amount, r == OF_AIR ? "air" : GaugeReceiverName(gauges, index)));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Minimum, mean and maximum; the mean is that of the amount. */
static PetscErrorCode Summarise(Cloud cloud, const Scalar *scalar, PetscReal values[3])
{
  PetscReal sum[2]     = {0, 0};
  PetscReal extreme[2] = {-PETSC_MAX_REAL, -PETSC_MAX_REAL}; /* -min, max */

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal T = cloud->field[scalar->field][a], store = ScalarStore(cloud, scalar, a);

    sum[0] += store * T;
    sum[1] += store;
    extreme[0] = PetscMax(extreme[0], -T);
    extreme[1] = PetscMax(extreme[1], T);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPIU_REAL, MPIU_SUM, cloud->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, extreme, 2, MPIU_REAL, MPIU_MAX, cloud->comm));
  values[0] = sum[1] > 0 ? -extreme[0] : NAN;
  values[1] = sum[1] > 0 ? sum[0] / sum[1] : NAN;
  values[2] = sum[1] > 0 ? extreme[1] : NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Measure_Scalars(Gauges gauges, const void *data, PetscReal values[])
{
  const Cloud cloud  = GaugesCloud(gauges);
  HeatSpread  spread = {.pair = NULL};
  PetscReal   flow[RECEIVERS];

  PetscFunctionBegin;
  for (const Scalar *scalar = Scalars; scalar < Scalars + SCALARS; scalar++) {
    PetscInt n = 0;

    if (!ScalarOn(cloud->scene, scalar)) continue;
    PetscCall(Summarise(cloud, scalar, values));
    values += 3;
    for (PetscInt r = 0; r < RECEIVERS; r++) n += Gives(cloud->scene, scalar, r);
    if (n == 0) continue;
    PetscCall(CloudUpdate(cloud, FIELD_POSITION));
    PetscCall(SpreadFind(&spread, cloud, scalar));
    SpreadFlows(&spread, cloud->field[scalar->field], flow);
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, flow, RECEIVERS, MPIU_REAL, MPIU_SUM, cloud->comm));
    for (PetscInt r = 0; r < RECEIVERS; r++)
      if (Gives(cloud->scene, scalar, r)) *values++ = flow[r];
  }
  PetscCall(SpreadFree(&spread));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const GaugeKind GaugeScalars = {.columns = Columns_Scalars, .measure = Measure_Scalars, .needs_sums = PETSC_TRUE};
