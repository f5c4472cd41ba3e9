/* Dummy particles of the solids: points of the box's lattice inside them. Liquid on the same lattice, as all that
   reaches a closed face is, then has its full spacing from them whatever the shape. */
#include "packing_impl.h"

typedef struct {
  Domain    domain;
  Scene     scene;
  PetscReal depth; /* of the particles below the surface, m */
  PetscInt  first_id;
} Solids;

static PetscErrorCode VisitSolids(void *source, SampleVisitor visitor, void *context)
{
  const Solids *solids = (const Solids *)source;
  Lattice       box;
  PetscInt      number = 0, solid = 0;

  PetscFunctionBegin;
  if (!SceneSolidCount(solids->scene)) PetscFunctionReturn(PETSC_SUCCESS);
  LatticeOfBox(solids->domain, solids->domain->spacing, &box);
  for (PetscInt point = 0; point < LatticeCount(&box); point++) {
    Sample    sample = {.layer = 1, .area = box.pitch[0] * box.pitch[1] / solids->domain->volume};
    PetscReal s;

    if (solids->domain->graded) sample.area = 1;
    LatticePoint(&box, point, sample.x);
    s = SceneSolidDistance(solids->scene, sample.x, &solid);
    if (s > 0 || s <= -solids->depth) continue;
    sample.id = sample.parent = solids->first_id + number++;
    sample.body               = BODY_SOLID - solid;
    BodyMotion(SceneSolid(solids->scene, solid), SceneSolidTime(solids->scene), sample.x, sample.v);
    PetscCall(visitor(context, &sample));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How deep (m) solids are filled: as far as the pair of a fine particle with the coarsest reaches. */
static PetscReal Depth(Domain domain, PetscInt layers)
{
  return layers * domain->spacing * (domain->graded ? 0.5 * (1 + DomainSizeMax(domain)) : 1);
}

PetscErrorCode SolidWeigh(Domain domain, Scene scene, PetscInt layers, PetscInt weight[])
{
  Solids   solids = {.domain = domain, .scene = scene, .depth = Depth(domain, layers)};
  PetscInt count;

  PetscFunctionBegin;
  PetscCall(SamplesWeigh(domain, VisitSolids, &solids, weight, &count));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SolidCreateParticles(Particles particles, Domain domain, Scene scene, PetscInt layers, PetscInt first_id,
                                    PetscInt *count)
{
  Solids solids = {.domain = domain, .scene = scene, .depth = Depth(domain, layers), .first_id = first_id};

  PetscFunctionBegin;
  PetscCall(SamplesAppend(particles, domain, VisitSolids, &solids, count));
  PetscFunctionReturn(PETSC_SUCCESS);
}
