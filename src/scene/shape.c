/* A shape and the holes in it. */
#include "scene_impl.h"

PetscReal ShapeDistance(Body body, const PetscReal x[DIM])
{
  PetscReal s = body->shape->distance(body, x);

  for (PetscInt k = 0; k < body->holes; k++) s = PetscMax(s, -body->hole[k]->shape->distance(body->hole[k], x));
  return s;
}
