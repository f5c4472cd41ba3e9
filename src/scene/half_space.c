/* Half-space of liquid behind a plane; the normal points out of the liquid. */
#include "scene_impl.h"

typedef struct {
  PetscReal point[DIM];  /* of the plane, m */
  PetscReal normal[DIM]; /* unit vector */
} HalfSpace;

static const OptionRow options[] = {
  {"-point", "Point of the surface of a half-space", "m", NULL, ROW_POINT, offsetof(HalfSpace, point)},
  {"-normal", "Normal of a half-space, out of the liquid: x, y, z or a vector", NULL, NULL, ROW_AXIS,
   offsetof(HalfSpace, normal)},
  {.name = NULL},
};

static void HalfSpaceDefaults(void *owner)
{
  Body body                                                      = (Body)owner;
  ((HalfSpace *)body->shape_data)->normal[body->domain->dim - 1] = 1;
}

static PetscReal HalfSpaceDistance(Body body, const PetscReal x[DIM])
{
  const HalfSpace *half     = (const HalfSpace *)body->shape_data;
  PetscReal        distance = 0;

  for (PetscInt d = 0; d < body->domain->dim; d++) distance += (x[d] - half->point[d]) * half->normal[d];
  return distance;
}

static void HalfSpaceBounds(Body body, PetscReal lower[DIM], PetscReal upper[DIM])
{
  const HalfSpace *half = (const HalfSpace *)body->shape_data;

  /* Bounded in one direction only if the normal is along an axis. */
  for (PetscInt d = 0; d < DIM; d++) {
    lower[d] = half->normal[d] == -1 ? half->point[d] : -PETSC_MAX_REAL;
    upper[d] = half->normal[d] == 1 ? half->point[d] : PETSC_MAX_REAL;
  }
}

const ShapeOps ShapeHalfSpace = {
  {"half_space", sizeof(HalfSpace), options, HalfSpaceDefaults, NULL}, HalfSpaceDistance, HalfSpaceBounds, NULL, NULL};
