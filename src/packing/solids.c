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
  PetscInt        first, last, number, n, solid = 0;
  PetscSegBuffer  found;
  Sample         *samples;

  PetscFunctionBegin;
  if (!SceneSolidCount(cloud->scene)) PetscFunctionReturn(PETSC_SUCCESS);
  LatticeOfBox(domain, domain->spacing, &box);
  OwnShare(cloud->comm, LatticeCount(&box), &first, &last);
  PetscCall(PetscSegBufferCreate(sizeof(Sample), 1024, &found));
  for (PetscInt point = first; point < last; point++) {
    Sample    sample = {.layer = 1, .area = domain->graded ? 1 : box.pitch[0] * box.pitch[1] / domain->volume};
    PetscReal s;

    LatticePoint(&box, point, sample.x);
    s = SceneSolidDistance(cloud->scene, sample.x, &solid);
    if (s > 0 || s <= -depth) continue;
    sample.body = BODY_SOLID - solid;
    SceneSolidVelocity(cloud->scene, solid, sample.x, sample.v);
    PetscCall(SampleKeep(found, &sample));
  }
  PetscCall(SamplesTake(&found, &n, &samples));
  PetscCall(OwnNumbers(cloud->comm, n, &number, &last));
  for (PetscInt k = 0; k < n; k++) {
    samples[k].id = samples[k].parent = number + k;
    PetscCall(visitor(context, &samples[k]));
  }
  PetscCall(PetscFree(samples));
  PetscFunctionReturn(PETSC_SUCCESS);
}
