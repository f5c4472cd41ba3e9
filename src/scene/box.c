/* Box with faces normal to the axes. The default corners are those of the simulation box. */
#include "scene_impl.h"

typedef struct {
  PetscReal lower[DIM], upper[DIM]; /* m */
} Box;

static const OptionRow options[] = {
  ROW_OF_LOWER(Box),
  ROW_OF_UPPER(Box),
  {.name = NULL},
};

static void BoxDefaults(void *owner)
{
  Body body = (Body)owner;
  Box *box  = (Box *)body->shape_data;

  for (PetscInt d = 0; d < DIM; d++) {
    box->lower[d] = body->domain->lower[d];
    box->upper[d] = body->domain->upper[d];
  }
}

static PetscErrorCode BoxSetUp(void *owner)
{
  Body       body   = (Body)owner;
  Domain     domain = body->domain;
  const Box *box    = (const Box *)body->shape_data;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < domain->dim; d++) {
    PetscCheckUser(box->upper[d] > box->lower[d], domain->comm,
                   "-%supper must be above -%slower in every direction: %g m is not above %g m", body->prefix,
                   body->prefix, (double)box->upper[d], (double)box->lower[d]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal BoxDistance(Body body, const PetscReal x[DIM])
{
  const Box *box  = (const Box *)body->shape_data;
  PetscReal  deep = PETSC_MIN_REAL, out = 0;

  for (PetscInt d = 0; d < body->domain->dim; d++) {
    const PetscReal s = PetscMax(box->lower[d] - x[d], x[d] - box->upper[d]);

    deep = PetscMax(deep, s);
    if (s > 0) out += s * s;
  }
  return deep > 0 ? PetscSqrtReal(out) : deep;
}

static void BoxBounds(Body body, PetscReal lower[DIM], PetscReal upper[DIM])
{
  const Box *box = (const Box *)body->shape_data;

  for (PetscInt d = 0; d < DIM; d++) {
    lower[d] = box->lower[d];
    upper[d] = box->upper[d];
  }
}

const ShapeOps ShapeBox = {
  {"box", sizeof(Box), options, BoxDefaults, BoxSetUp}, BoxDistance, BoxBounds, NULL, NULL, PETSC_TRUE};
