/* Dummy particles of the solids: points of the box's lattice inside them. Liquid on the same lattice, as all that
   reaches a closed face is, then has its full spacing from them whatever the shape. */
#include "packing_impl.h"

/* Sees each point: its number among them all, the index of its solid, its place x (m). */
typedef void (*SolidVisitor)(void *context, PetscInt number, PetscInt solid, const PetscReal x[DIM]);

static void SolidVisit(Domain domain, Scene scene, PetscInt layers, SolidVisitor visitor, void *context)
{
  const PetscReal depth = layers * domain->spacing;
  BoxLattice      box;
  PetscInt        number = 0, solid = 0;

  if (!SceneSolidCount(scene)) return;
  BoxLatticeSetUp(domain, &box);
  for (PetscInt k = 0; k < box.n[2]; k++) {
    for (PetscInt j = 0; j < box.n[1]; j++) {
      for (PetscInt i = 0; i < box.n[0]; i++) {
        const PetscInt index[DIM] = {i, j, k};
        PetscReal      x[DIM], s;

        for (PetscInt d = 0; d < DIM; d++) x[d] = box.origin[d] + index[d] * box.pitch[d];
        s = SceneSolidDistance(scene, x, &solid);
        if (s <= 0 && s > -depth) visitor(context, number++, solid, x);
      }
    }
  }
}

static void Weigh(void *context, PetscInt number, PetscInt solid, const PetscReal x[DIM])
{
  DummyWeigh((DummyFilling *)context, x);
}

static void Fill(void *context, PetscInt number, PetscInt solid, const PetscReal x[DIM])
{
  DummyFilling  *filling = (DummyFilling *)context;
  const PetscInt a       = filling->next;

  if (filling->domain->cell_rank[DomainCell(filling->domain, x)] != filling->rank) return;
  for (PetscInt d = 0; d < DIM; d++) filling->arrays.real[FIELD_POSITION][DIM * a + d] = x[d];
  filling->arrays.integer[INT_ID][a]     = filling->first_id + number;
  filling->arrays.integer[INT_BODY][a]   = BODY_SOLID - solid;
  filling->arrays.integer[INT_LAYER][a]  = 1;
  filling->arrays.integer[INT_PARENT][a] = filling->first_id + number;
  filling->next++;
}

void SolidWeigh(Domain domain, Scene scene, PetscInt layers, PetscInt weight[])
{
  DummyFilling filling = {.domain = domain, .weight = weight};

  SolidVisit(domain, scene, layers, Weigh, &filling);
}

PetscErrorCode SolidCreateParticles(Particles particles, Domain domain, Scene scene, PetscInt layers, PetscInt first_id,
                                    PetscInt *count)
{
  DummyFilling filling = {.domain = domain, .first_id = first_id};

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(domain->comm, &filling.rank));
  SolidVisit(domain, scene, layers, Weigh, &filling);
  *count = filling.count;
  if (*count == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ParticlesLocalSize(particles, &filling.next));
  PetscCall(ParticlesAppend(particles, filling.own));
  PetscCall(ParticlesOpen(particles, &filling.arrays));
  SolidVisit(domain, scene, layers, Fill, &filling);
  PetscCall(ParticlesClose(particles, &filling.arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}
