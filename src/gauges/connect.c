/* Connected pieces of liquid: chains of neighbours closer than CONNECTION connect their particles. The cells of
   crater_grid.c are too coarse for the crown, whose rim sheds drops at a distance of one or two spacings. */
#include "gauges_impl.h"

PetscErrorCode ConnectedLabels(Gauges gauges, PetscReal label[])
{
  Cloud     cloud = gauges->cloud;
  PetscInt *parent;

  PetscFunctionBegin;
  PetscCall(CloudUpdate(cloud, FIELD_POSITION));
  PetscCall(PetscMalloc1(cloud->n_total, &parent));
  OperatorsConnect(cloud, CONNECTION * cloud->domain->spacing, parent);
  for (PetscInt a = 0; a < cloud->n_owned; a++) label[a] = (PetscReal)cloud->integer[INT_ID][a]; /* exact as reals */
  PetscCall(OperatorsComponentMinimum(cloud, parent, 1, label));
  PetscCall(PetscFree(parent));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ConnectedWithBody(Gauges gauges, PetscInt body, PetscBool connected[])
{
  Cloud          cloud = gauges->cloud;
  const PetscInt up    = cloud->domain->dim - 1;
  struct {
    double value;
    int    rank;
  } deepest = {.value = PETSC_MAX_REAL, .rank = gauges->rank};
  PetscReal *label, deepest_label = -1;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, 1, &label));
  PetscCall(ConnectedLabels(gauges, label));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal height = cloud->field[FIELD_POSITION][DIM * a + up];

    if (cloud->integer[INT_BODY][a] != body || height >= deepest.value) continue;
    deepest.value = (double)height;
    deepest_label = label[a];
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &deepest, 1, MPI_DOUBLE_INT, MPI_MINLOC, cloud->comm));
  PetscCallMPI(MPI_Bcast(&deepest_label, 1, MPIU_REAL, deepest.rank, cloud->comm));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) connected[a] = (PetscBool)(label[a] == deepest_label);
  PetscCall(CloudRestoreWork(cloud, &label));
  PetscFunctionReturn(PETSC_SUCCESS);
}
