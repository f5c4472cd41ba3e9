/* Circular cylinder about any axis, infinite unless it has a height. In two dimensions: a circle if the axis is z, a
   strip for an axis in the plane. With rings: a cylinder about their axis, y. */
#include "scene_impl.h"

typedef struct {
  PetscReal center[DIM]; /* at half the height, m */
  PetscReal axis[DIM];   /* unit vector */
  PetscReal radius;      /* m */
  PetscReal height;      /* m; 0: infinite */
  PetscReal half_height; /* m; PETSC_MAX_REAL: infinite */
} Cylinder;

static const OptionRow options[] = {
  ROW_OF_CENTER(Cylinder),
  ROW_OF_RADIUS(Cylinder),
  {"-axis", "Axis of a cylinder: x, y, z or a vector", NULL, NULL, ROW_NORMAL, offsetof(Cylinder, axis)},
  {"-height", "Height of a cylinder, half of it on either side of the center; 0: infinite", "m", "[0, inf)", ROW_REAL,
   offsetof(Cylinder, height)},
  {.name = NULL},
};

static void CylinderDefaults(void *owner)
{
  Body body                                                         = (Body)owner;
  ((Cylinder *)body->shape_data)->axis[body->domain->rings ? 1 : 2] = 1;
}

static PetscErrorCode CylinderSetUp(void *owner)
{
  Body      body     = (Body)owner;
  Cylinder *cylinder = (Cylinder *)body->shape_data;

  PetscFunctionBegin;
  PetscCall(BodyCheckLength(body, "-radius", cylinder->radius));
  PetscCheckUser(!body->domain->rings || (cylinder->center[0] == 0 && PetscAbsReal(cylinder->axis[1]) == 1),
                 body->domain->comm,
                 "with -dimension axisymmetric -%sshape cylinder must be about the axis: the first number of "
                 "-%scenter must be 0, and -%saxis y; a tube is a box",
                 body->prefix, body->prefix, body->prefix);
  /* In two dimensions the plane cuts a cylinder about z at half its height. */
  if (body->domain->dim == 2 && cylinder->axis[2] != 0) cylinder->height = 0;
  cylinder->half_height = cylinder->height > 0 ? 0.5 * cylinder->height : PETSC_MAX_REAL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal CylinderDistance(Body body, const PetscReal x[DIM])
{
  const Cylinder *cylinder = (const Cylinder *)body->shape_data;
  PetscReal       r[DIM]   = {0, 0, 0}, along, side, end;

  for (PetscInt d = 0; d < body->domain->dim; d++) r[d] = x[d] - cylinder->center[d];
  along = Dot(r, cylinder->axis);
  for (PetscInt d = 0; d < DIM; d++) r[d] -= along * cylinder->axis[d];
  side = Norm(r) - cylinder->radius;
  end  = PetscAbsReal(along) - cylinder->half_height;
  if (side > 0 && end > 0) return PetscSqrtReal(side * side + end * end); /* nearest to the rim */
  return PetscMax(side, end);
}

static void CylinderBounds(Body body, PetscReal lower[DIM], PetscReal upper[DIM])
{
  const Cylinder *cylinder = (const Cylinder *)body->shape_data;

  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal a    = cylinder->axis[d];
    PetscReal       half = cylinder->radius * PetscSqrtReal(PetscMax(0, 1 - a * a)); /* extent of an end disc */

    if (a != 0)
      half = cylinder->half_height == PETSC_MAX_REAL ? PETSC_MAX_REAL : half + PetscAbsReal(a) * cylinder->half_height;
    lower[d] = cylinder->center[d] - half;
    upper[d] = cylinder->center[d] + half;
  }
}

const ShapeOps ShapeCylinder = {{"cylinder", sizeof(Cylinder), options, CylinderDefaults, CylinderSetUp},
                                CylinderDistance,
                                CylinderBounds,
                                NULL,
                                NULL};
