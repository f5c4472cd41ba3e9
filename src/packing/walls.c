/* Dummy particles of the walls: the box's lattice, continued beyond the faces that are walls. */
#include "packing_impl.h"

/* Lattice indices [first, end) a direction, those inside the box excluded. */
typedef struct {
  BoxLattice box;
  PetscInt   layers, first[DIM], end[DIM];
} WallLattice;

typedef void (*WallVisitor)(void *context, const WallLattice *wall, const PetscInt index[DIM], const PetscReal x[DIM]);

static void WallLatticeSetUp(Domain domain, PetscInt layers, WallLattice *wall)
{
  BoxLatticeSetUp(domain, &wall->box);
  wall->layers = layers;
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscBool real = (PetscBool)(d < domain->dim);

    wall->first[d] = real && domain->face[d][0] == FACE_WALL ? -layers : 0;
    wall->end[d]   = wall->box.n[d] + (real && domain->face[d][1] == FACE_WALL ? layers : 0);
  }
}

/* How many lattice steps an index is outside the box, 0 inside. */
static inline PetscInt Depth(const WallLattice *wall, PetscInt d, PetscInt index)
{
  return index < 0 ? -index : PetscMax(0, index - wall->box.n[d] + 1);
}

static void WallVisit(Domain domain, const WallLattice *wall, WallVisitor visitor, void *context)
{
  const BoxLattice *box = &wall->box;

  for (PetscInt k = wall->first[2]; k < wall->end[2]; k++) {
    for (PetscInt j = wall->first[1]; j < wall->end[1]; j++) {
      const PetscBool inside = (PetscBool)(!Depth(wall, 1, j) && !Depth(wall, 2, k));

      for (PetscInt i = wall->first[0]; i < wall->end[0]; i++) {
        PetscInt  index[DIM] = {i, j, k};
        PetscReal x[DIM];

        if (inside && i == 0) index[0] = i = box->n[0]; /* leap over the box */
        if (i >= wall->end[0]) break;
        for (PetscInt d = 0; d < DIM; d++) x[d] = box->origin[d] + index[d] * box->pitch[d];
        visitor(context, wall, index, x);
      }
    }
  }
}

/* Number of wall particles before this one in the order of WallVisit: all lattice points before it less those inside
   the box. */
static PetscInt WallOrdinal(const WallLattice *wall, const PetscInt index[DIM])
{
  const PetscInt *n = wall->box.n, wide = wall->end[0] - wall->first[0], deep = wall->end[1] - wall->first[1];
  PetscInt        all, inside, clamped[DIM];

  for (PetscInt d = 0; d < DIM; d++) clamped[d] = PetscMax(0, PetscMin(n[d], index[d]));
  all    = ((index[2] - wall->first[2]) * deep + index[1] - wall->first[1]) * wide + index[0] - wall->first[0];
  inside = clamped[2] * n[1] * n[0];
  if (!Depth(wall, 2, index[2])) {
    inside += clamped[1] * n[0];
    if (!Depth(wall, 1, index[1])) inside += clamped[0];
  }
  return all - inside;
}

static void Weigh(void *context, const WallLattice *wall, const PetscInt index[DIM], const PetscReal x[DIM])
{
  DummyWeigh((DummyFilling *)context, x);
}

/* The wall's velocity v (m/s): that of the face; in an edge or corner zero in each component in which the faces
   differ. */
static void WallVelocity(Domain domain, const WallLattice *wall, const PetscInt index[DIM], PetscReal v[DIM])
{
  PetscInt faces = 0;

  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal *face = domain->wall_velocity[d][index[d] < 0 ? 0 : 1];

    if (!Depth(wall, d, index[d])) continue;
    for (PetscInt c = 0; c < DIM; c++) v[c] = faces == 0 || v[c] == face[c] ? face[c] : 0;
    faces++;
  }
}

static void Fill(void *context, const WallLattice *wall, const PetscInt index[DIM], const PetscReal x[DIM])
{
  DummyFilling  *filling = (DummyFilling *)context;
  const PetscInt a       = filling->next;
  PetscInt       parent[DIM], layer = 0;

  if (filling->domain->cell_rank[DomainCell(filling->domain, x)] != filling->rank) return;
  for (PetscInt d = 0; d < DIM; d++) {
    filling->arrays.real[FIELD_POSITION][DIM * a + d] = x[d];
    parent[d]                                         = PetscMax(-1, PetscMin(wall->box.n[d], index[d]));
    layer                                             = PetscMax(layer, Depth(wall, d, index[d]));
  }
  WallVelocity(filling->domain, wall, index, filling->arrays.real[FIELD_VELOCITY] + DIM * a);
  filling->arrays.integer[INT_ID][a]     = filling->first_id + WallOrdinal(wall, index);
  filling->arrays.integer[INT_BODY][a]   = -1;
  filling->arrays.integer[INT_LAYER][a]  = layer;
  filling->arrays.integer[INT_PARENT][a] = filling->first_id + WallOrdinal(wall, parent);
  filling->next++;
}

void WallWeigh(Domain domain, PetscInt layers, PetscInt weight[])
{
  DummyFilling filling = {.domain = domain, .weight = weight};
  WallLattice  wall;

  WallLatticeSetUp(domain, layers, &wall);
  WallVisit(domain, &wall, Weigh, &filling);
}

PetscErrorCode WallCreateParticles(Particles particles, Domain domain, PetscInt layers, PetscInt first_id,
                                   PetscInt *count)
{
  DummyFilling filling = {.domain = domain, .first_id = first_id};
  WallLattice  wall;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(domain->comm, &filling.rank));
  WallLatticeSetUp(domain, layers, &wall);
  WallVisit(domain, &wall, Weigh, &filling);
  *count = filling.count;
  if (*count == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ParticlesLocalSize(particles, &filling.next));
  PetscCall(ParticlesAppend(particles, filling.own));
  PetscCall(ParticlesOpen(particles, &filling.arrays));
  WallVisit(domain, &wall, Fill, &filling);
  PetscCall(ParticlesClose(particles, &filling.arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}
