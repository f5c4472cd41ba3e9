/* Which liquid hangs together, particle by particle: chains of neighbours closer than -gauge_connection. The cells of
   crater_grid.c are too coarse for the crown, whose rim sheds drops a spacing or two away. */
#include "gauges_impl.h"

/* The representative of a's set in the forest of parents; paths are halved on the way. */
static PetscInt Find(PetscInt parent[], PetscInt a)
{
  while (parent[a] != a) {
    parent[a] = parent[parent[a]];
    a         = parent[a];
  }
  return a;
}

/* Joins particles, ghosts too, that chains of this rank's particles connect: parent [n_total] of the sets' trees. */
static void JoinNeighbors(Cloud cloud, PetscReal distance, PetscInt parent[])
{
  const PetscReal *x     = cloud->field[FIELD_POSITION];
  const PetscInt  *layer = cloud->integer[INT_LAYER];

  for (PetscInt a = 0; a < cloud->n_total; a++) parent[a] = a;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
      const PetscInt  b      = cloud->list[k];
      const PetscReal r[DIM] = {x[3 * a] - x[3 * b], x[3 * a + 1] - x[3 * b + 1], x[3 * a + 2] - x[3 * b + 2]};

      if (layer[b] == 0 && Dot(r, r) < PetscSqr(CloudPairSize(cloud, a, b) * distance)) {
        const PetscInt p = Find(parent, a), q = Find(parent, b);

        if (p != q) parent[PetscMax(p, q)] = PetscMin(p, q);
      }
    }
  }
}

/* Spreads the smallest id of each set through the ghosts until every chain, on whatever ranks it lies, has one label
   (ids are exact as reals). smallest [n_total] is scratch. */
static PetscErrorCode LabelSets(Cloud cloud, PetscInt parent[], PetscReal smallest[], PetscReal label[])
{
  PetscInt changed;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_owned; a++) label[a] = (PetscReal)cloud->integer[INT_ID][a];
  do {
    changed = 0;
    PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, label));
    for (PetscInt a = 0; a < cloud->n_total; a++) smallest[a] = PETSC_MAX_REAL;
    for (PetscInt a = 0; a < cloud->n_total; a++) {
      const PetscInt p = Find(parent, a);

      smallest[p] = PetscMin(smallest[p], label[a]);
    }
    for (PetscInt a = 0; a < cloud->n_owned; a++) {
      const PetscReal least = smallest[Find(parent, a)];

      changed += least < label[a];
      label[a] = least;
    }
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPIU_INT, MPI_SUM, cloud->comm));
  } while (changed);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ConnectedLabels(Gauges gauges, PetscReal label[])
{
  Cloud      cloud = gauges->cloud;
  PetscInt  *parent;
  PetscReal *smallest;

  PetscFunctionBegin;
  PetscCall(CloudUpdate(cloud, FIELD_POSITION));
  PetscCall(PetscMalloc2(cloud->n_total, &parent, cloud->n_total, &smallest));
  JoinNeighbors(cloud, gauges->connection * cloud->domain->spacing, parent);
  PetscCall(LabelSets(cloud, parent, smallest, label));
  PetscCall(PetscFree2(parent, smallest));
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
