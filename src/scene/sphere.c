/* Sphere; a circle in two dimensions. */
#include "scene_impl.h"

typedef struct {
  PetscReal center[DIM]; /* m */
  PetscReal radius;      /* m */
} Sphere;

static PetscErrorCode SphereSetFromOptions(Body body, OptionItems PetscOptionsObject)
{
  Sphere *sphere = (Sphere *)body->shape_data;

  PetscFunctionBegin;
  PetscCall(DomainOptionsVector(body->domain, PetscOptionsObject, VECTOR_POINT, "-center", "Center of a sphere (m)",
                                "ShapeSphere", sphere->center, NULL));
  PetscCall(OptionReal("-radius", "Radius of a sphere (m), required", "(0, inf)", &sphere->radius));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SphereSetUp(Body body)
{
  PetscFunctionBegin;
  PetscCall(BodyCheckLength(body, "-radius", ((const Sphere *)body->shape_data)->radius));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal SphereDistance(Body body, const PetscReal x[DIM])
{
  const Sphere *sphere = (const Sphere *)body->shape_data;
  PetscReal     square = 0;

  for (PetscInt d = 0; d < body->domain->dim; d++) square += PetscSqr(x[d] - sphere->center[d]);
  return PetscSqrtReal(square) - sphere->radius;
}

static void SphereBounds(Body body, PetscReal lower[DIM], PetscReal upper[DIM])
{
  const Sphere *sphere = (const Sphere *)body->shape_data;

  for (PetscInt d = 0; d < DIM; d++) {
    lower[d] = sphere->center[d] - sphere->radius;
    upper[d] = sphere->center[d] + sphere->radius;
  }
}

const BodyChoice *ShapeSphere(void)
{
  static const ShapeOps ops = {{sizeof(Sphere), SphereSetFromOptions, SphereSetUp}, SphereDistance, SphereBounds, NULL};

  return &ops.choice;
}
