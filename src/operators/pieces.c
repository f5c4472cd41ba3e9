/* Connected pieces of liquid: chains of neighbours closer than a distance. */
#include "operators.h"

/* The root of a's tree in a union-find forest; halves the paths on the way. */
static PetscInt Find(PetscInt parent[], PetscInt a)
{
  while (parent[a] != a) {
    parent[a] = parent[parent[a]];
    a         = parent[a];
  }
  return a;
}

/* Each pair of owned particles is looked at once. The root of a piece is its first particle, and in the end the parent
   of all of them. */
void OperatorsConnect(Cloud cloud, PetscReal distance, PetscInt parent[])
{
  const PetscReal *x     = cloud->field[FIELD_POSITION];
  const PetscInt  *layer = cloud->integer[INT_LAYER];

  for (PetscInt a = 0; a < cloud->n_total; a++) parent[a] = a;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
      const PetscInt b = cloud->list[k];
      PetscReal      r[DIM];

      /* most pairs share a parent already; the order is as good as random, so it must not be a branch of its own */
      if ((parent[a] == parent[b]) | ((b > a) & (b < cloud->n_fluid)) | (layer[b] != 0)) continue;
      for (PetscInt d = 0; d < DIM; d++) r[d] = x[DIM * a + d] - x[DIM * b + d];
      if (Dot(r, r) < PetscSqr(CloudPairSize(cloud, a, b) * distance)) {
        const PetscInt p = Find(parent, a), q = Find(parent, b);

        if (p != q) parent[PetscMax(p, q)] = PetscMin(p, q);
      }
    }
  }
  for (PetscInt a = 0; a < cloud->n_total; a++) parent[a] = Find(parent, a);
}

/* Sets the values of each particle to the least of its piece. Returns whether a value of an owned particle changed.
   least: [n_total][width] scratch. */
static PetscBool TakeLeast(Cloud cloud, const PetscInt parent[], PetscInt width, PetscReal value[], PetscReal least[])
{
  PetscBool changed = PETSC_FALSE;

  for (PetscInt k = 0; k < width * cloud->n_total; k++) least[k] = PETSC_MAX_REAL;
  for (PetscInt a = 0; a < cloud->n_total; a++)
    for (PetscInt k = 0; k < width; k++)
      least[width * parent[a] + k] = PetscMin(least[width * parent[a] + k], value[width * a + k]);
  for (PetscInt a = 0; a < cloud->n_owned; a++)
    for (PetscInt k = 0; k < width; k++) {
      changed              = (PetscBool)(changed || least[width * parent[a] + k] < value[width * a + k]);
      value[width * a + k] = least[width * parent[a] + k];
    }
  return changed;
}

PetscErrorCode OperatorsComponentMinimum(Cloud cloud, const PetscInt parent[], PetscInt width, PetscReal value[])
{
  PetscReal *least;
  PetscBool  changed;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(width * cloud->n_total, &least));
  do {
    PetscCall(CloudUpdateArray(cloud, width, PARITY_SCALAR, value));
    changed = TakeLeast(cloud, parent, width, value, least);
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPIU_BOOL, MPI_LOR, cloud->comm));
  } while (changed);
  PetscCall(PetscFree(least));
  PetscFunctionReturn(PETSC_SUCCESS);
}
