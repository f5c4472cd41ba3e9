/* Which liquid hangs together with the pool, particle by particle: chains of neighbours closer than a given distance.
   The cells of gauge_grid.c are too coarse for the crown, whose rim sheds drops a spacing or two away. */
#include "output_impl.h"

/* The representative of a's set; paths are halved on the way. */
static PetscInt Find(PetscInt parent[], PetscInt a)
{
  while (parent[a] != a) {
    parent[a] = parent[parent[a]];
    a         = parent[a];
  }
  return a;
}

/* Sets of particles, ghosts too, that chains of this rank's particles join. */
static void JoinNeighbors(Cloud cloud, PetscReal distance, PetscInt parent[])
{
  const PetscReal *x     = cloud->field[FIELD_POSITION];
  const PetscInt  *layer = cloud->integer[INT_LAYER];

  for (PetscInt a = 0; a < cloud->n_total; a++) parent[a] = a;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    for (PetscInt k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
      const PetscInt  b      = cloud->list[k];
      const PetscReal r[DIM] = {x[3 * a] - x[3 * b], x[3 * a + 1] - x[3 * b + 1], x[3 * a + 2] - x[3 * b + 2]};

      if (layer[b] == 0 && Dot(r, r) < distance * distance) {
        const PetscInt p = Find(parent, a), q = Find(parent, b);

        if (p != q) parent[PetscMax(p, q)] = PetscMin(p, q);
      }
    }
  }
}

/* Spreads the smallest id of each set through the ghosts until every chain has one label: FIELD_WORK1 (ids are exact as
 * reals). */
static PetscErrorCode LabelSets(Cloud cloud, PetscInt parent[], PetscReal smallest[])
{
  PetscReal *label   = cloud->field[FIELD_WORK1];
  PetscBool  changed = PETSC_TRUE;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_owned; a++) label[a] = (PetscReal)cloud->integer[INT_ID][a];
  while (changed) {
    PetscInt news = 0;

    PetscCall(CloudUpdate(cloud, FIELD_WORK1));
    for (PetscInt a = 0; a < cloud->n_total; a++) smallest[a] = PETSC_MAX_REAL;
    for (PetscInt a = 0; a < cloud->n_total; a++) {
      const PetscInt p = Find(parent, a);

      smallest[p] = PetscMin(smallest[p], label[a]);
    }
    for (PetscInt a = 0; a < cloud->n_owned; a++) {
      const PetscReal least = smallest[Find(parent, a)];

      news += least < label[a];
      label[a] = least;
    }
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &news, 1, MPIU_INT, MPI_SUM, cloud->comm));
    changed = (PetscBool)(news > 0);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GaugeLabels(Output output, PetscReal distance)
{
  Cloud      cloud = output->cloud;
  PetscInt  *parent;
  PetscReal *smallest;

  PetscFunctionBegin;
  PetscCall(CloudUpdate(cloud, FIELD_POSITION));
  PetscCall(PetscMalloc2(cloud->n_total, &parent, cloud->n_total, &smallest));
  JoinNeighbors(cloud, distance, parent);
  PetscCall(LabelSets(cloud, parent, smallest));
  PetscCall(PetscFree2(parent, smallest));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GaugeConnected(Output output, PetscReal distance, PetscBool connected[])
{
  Cloud          cloud = output->cloud;
  const PetscInt up    = cloud->domain->dim - 1;
  struct {
    double value;
    int    rank;
  } deepest         = {.value = PETSC_MAX_REAL};
  PetscReal   label = -1;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(cloud->comm, &rank));
  PetscCall(GaugeLabels(output, distance));
  /* the pool is what the deepest particle of its body hangs together with */
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal height = cloud->field[FIELD_POSITION][DIM * a + up];

    if (cloud->integer[INT_BODY][a] != output->gauge.pool || height >= deepest.value) continue;
    deepest.value = (double)height;
    label         = cloud->field[FIELD_WORK1][a];
  }
  deepest.rank = rank;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &deepest, 1, MPI_DOUBLE_INT, MPI_MINLOC, cloud->comm));
  PetscCallMPI(MPI_Bcast(&label, 1, MPIU_REAL, deepest.rank, cloud->comm));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) connected[a] = (PetscBool)(cloud->field[FIELD_WORK1][a] == label);
  PetscFunctionReturn(PETSC_SUCCESS);
}
