/* Connected pieces of liquid: chains of neighbours closer than a distance. */
#include "../base/shared.h"
#include "operators.h"

#define GROUP 8 /* pairs */

typedef struct {
  Cloud     cloud;
  PetscReal distance; /* m */
  PetscInt *parent;
} Pieces;

/* Whether the pair may join two pieces: its particles have different parents, and no other row has the pair. Without
   branches, for the order of the particles is as good as random. */
static inline PetscBool MayJoin(const Pieces *p, PetscInt a, PetscInt b)
{
  return (PetscBool)((p->parent[a] != p->parent[b]) & ((b < a) | (b >= p->cloud->n_fluid)));
}

/* Joins the pieces of fluid particle a and of b if b is fluid and near. The root of a piece is its first particle. */
static void Join(const Pieces *p, PetscInt a, PetscInt b)
{
  const Cloud      cloud = p->cloud;
  const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, *y = cloud->field[FIELD_POSITION] + DIM * b,
                  r[DIM] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};

  if (cloud->integer[INT_LAYER][b] || Dot(r, r) >= PetscSqr(CloudPairSize(cloud, a, b) * p->distance)) return;
  PieceJoin(p->parent, a, b);
}

/* The particle before a is often near it; then most of the other pairs have one parent, and whole groups are passed. In
   the end all particles of a piece have its root as their parent. */
void OperatorsConnect(Cloud cloud, PetscReal distance, PetscInt parent[])
{
  const Pieces pieces = {.cloud = cloud, .distance = distance, .parent = parent};

  for (PetscInt a = 0; a < cloud->n_total; a++) parent[a] = a;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscInt64 end = cloud->first[a + 1];

    if (a > 0) Join(&pieces, a, a - 1);
    for (PetscInt64 group = cloud->first[a]; group < end; group += GROUP) {
      const PetscInt *b = cloud->list + group, n = (PetscInt)PetscMin(GROUP, end - group);
      PetscBool       any = PETSC_FALSE;

      for (PetscInt k = 0; k < n; k++) any |= MayJoin(&pieces, a, b[k]);
      for (PetscInt k = 0; k < n && any; k++)
        if (MayJoin(&pieces, a, b[k])) Join(&pieces, a, b[k]);
    }
  }
  for (PetscInt a = 0; a < cloud->n_total; a++) parent[a] = PieceFirst(parent, a);
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
