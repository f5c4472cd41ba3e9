/* Dummy particles of the walls: the box's lattice, continued beyond the faces that are walls. */
#include "packing_impl.h"

/* The lattice of box and walls. Point i of direction d is inside the box if low[d] <= i < high[d]. */
typedef struct {
  Lattice  lattice;
  PetscInt low[DIM], high[DIM];
} Walls;

static void WallsSetUp(Domain domain, PetscInt layers, Walls *walls)
{
  Lattice *lattice = &walls->lattice;

  LatticeOfBox(domain, domain->spacing, lattice);
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscBool real  = (PetscBool)(d < domain->dim);
    const PetscInt  below = real && domain->face[d][0] == FACE_WALL ? layers : 0;
    const PetscInt  above = real && domain->face[d][1] == FACE_WALL ? layers : 0;

    walls->low[d]  = below;
    walls->high[d] = below + lattice->n[d];
    lattice->n[d] += below + above;
  }
}

/* How many lattice steps a point is outside the box in direction d, 0 inside. */
static inline PetscInt StepsOutside(const Walls *walls, PetscInt d, PetscInt at)
{
  return PetscMax(0, PetscMax(walls->low[d] - at, at - walls->high[d] + 1));
}

/* The number of wall points before this point in the order of the lattice: all points before it less those inside the
   box. */
static PetscInt WallOrdinal(const Walls *walls, const PetscInt at[DIM])
{
  PetscInt n[DIM], before[DIM], inside; /* of the box: its points, and its points before this point */

  for (PetscInt d = 0; d < DIM; d++) {
    n[d]      = walls->high[d] - walls->low[d];
    before[d] = PetscMax(0, PetscMin(n[d], at[d] - walls->low[d]));
  }
  inside = before[2] * n[1] * n[0];
  if (!StepsOutside(walls, 2, at[2])) {
    inside += before[1] * n[0];
    if (!StepsOutside(walls, 1, at[1])) inside += before[0];
  }
  return CellIndex(walls->lattice.n, at[0], at[1], at[2]) - inside;
}

PetscErrorCode WallVisit(void *source, SampleVisitor visitor, void *context)
{
  const Cloud    cloud = ((const Dummies *)source)->cloud;
  Walls          walls;
  const Lattice *lattice = &walls.lattice;
  PetscInt       first, last;

  PetscFunctionBegin;
  WallsSetUp(cloud->domain, ((const Dummies *)source)->layers, &walls);
  OwnShare(cloud->comm, LatticeCount(lattice), &first, &last);
  for (PetscInt point = first; point < last; point++) {
    Sample   sample = {.body = -1, .area = lattice->pitch[0] * lattice->pitch[1] / cloud->domain->volume};
    PetscInt at[DIM], parent[DIM];

    CellCoordinates(lattice->n, point, at);
    for (PetscInt d = 0; d < DIM; d++) sample.layer = PetscMax(sample.layer, StepsOutside(&walls, d, at[d]));
    if (!sample.layer) continue;
    for (PetscInt d = 0; d < DIM; d++) {
      sample.x[d] = lattice->origin[d] + (at[d] - walls.low[d]) * lattice->pitch[d];
      parent[d]   = PetscMax(walls.low[d] - 1, PetscMin(walls.high[d], at[d]));
    }
    DomainWallVelocity(cloud->domain, sample.x, sample.v);
    sample.id     = WallOrdinal(&walls, at);
    sample.parent = WallOrdinal(&walls, parent);
    PetscCall(visitor(context, &sample));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
