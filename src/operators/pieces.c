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

void OperatorsConnect(Cloud cloud, PetscReal distance, PetscInt parent[])
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

/* Sets the value of each particle to the least of its piece. Returns whether the value of an owned particle changed.
   least: [n_total] scratch. */
static PetscBool TakeLeast(Cloud cloud, PetscInt parent[], PetscInt width, PetscReal value[], PetscReal least[])
{
  PetscBool changed = PETSC_FALSE;

  for (PetscInt a = 0; a < cloud->n_total; a++) least[a] = PETSC_MAX_REAL;
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    const PetscInt p = Find(parent, a);

    least[p] = PetscMin(least[p], value[width * a]);
  }
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    const PetscReal of_set = least[Find(parent, a)];

    if (of_set < value[width * a]) changed = PETSC_TRUE;
    value[width * a] = of_set;
  }
  return changed;
}

PetscErrorCode OperatorsComponentMinimum(Cloud cloud, PetscInt parent[], PetscInt width, PetscReal value[])
{
  PetscReal *least;
  PetscBool  changed;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(cloud->n_total, &least));
  do {
    changed = PETSC_FALSE;
    PetscCall(CloudUpdateArray(cloud, width, PARITY_SCALAR, value));
    for (PetscInt k = 0; k < width; k++)
      if (TakeLeast(cloud, parent, width, value + k, least)) changed = PETSC_TRUE;
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPIU_BOOL, MPI_LOR, cloud->comm));
  } while (changed);
  PetscCall(PetscFree(least));
  PetscFunctionReturn(PETSC_SUCCESS);
}
