/* Dummy particles of the solids: points of the box's lattice inside them. Liquid that reaches a closed face is on the
   same lattice, so it is a full spacing away from a solid of any shape. */
#include "packing_impl.h"

PetscErrorCode SolidVisit(void *source, SampleVisitor visitor, void *context)
{
  const Cloud     cloud  = ((const Dummies *)source)->cloud;
  const Domain    domain = cloud->domain;
  const PetscReal fine   = domain->graded ? 0.5 * (1 + DomainSizeMax(domain)) : 1; /* fine beside coarsest */
  const PetscReal depth  = ((const Dummies *)source)->layers * domain->spacing * fine;
  Lattice         box;
  PetscInt        number = 0, solid = 0;

  PetscFunctionBegin;
  if (!SceneSolidCount(cloud->scene)) PetscFunctionReturn(PETSC_SUCCESS);
  LatticeOfBox(domain, domain->spacing, &box);
  for (PetscInt point = 0; point < LatticeCount(&box); point++) {
    Sample    sample = {.layer = 1, .area = domain->graded ? 1 : box.pitch[0] * box.pitch[1] / domain->volume};
    PetscReal s;

    LatticePoint(&box, point, sample.x);
    s = SceneSolidDistance(cloud->scene, sample.x, &solid);
    if (s > 0 || s <= -depth) continue;
    sample.id = sample.parent = number++;
    sample.body               = BODY_SOLID - solid;
    BodyMotion(SceneSolid(cloud->scene, solid), SceneSolidTime(cloud->scene), sample.x, sample.v);
    PetscCall(visitor(context, &sample));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
