/* Refuses bodies that are outside the box, and bodies that overlap. */
#include "scene_impl.h"

#define FACING (-0.5) /* product of the normals of faces that face each other, at most */

/* Searches for a point x (m) where the signed distances to two bodies, which may be the same, are both below 'bound'
   (m). Candidates are the cell centres of a lattice of the particle spacing from the lower corner of the box, within
   the bounds of both bodies. The distances exclude most of them. Returns whether there is a point. */
static PetscBool FindCommonPoint(Body a, Body b, PetscReal bound, PetscReal x[DIM])
{
  Domain          domain = a->domain;
  const PetscReal d0     = domain->spacing;
  PetscReal       lower[2][DIM], upper[2][DIM];
  PetscInt64      first[DIM] = {0, 0, 0}, last[DIM] = {0, 0, 0};

  BodyBounds(a, lower[0], upper[0]);
  BodyBounds(b, lower[1], upper[1]);
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal  low = PetscMax(lower[0][d], lower[1][d]), high = PetscMin(upper[0][d], upper[1][d]);
    const PetscInt64 cells = (PetscInt64)PetscMax(1, PetscFloorReal((domain->upper[d] - domain->lower[d]) / d0 + 0.5));

    if (low > high) return PETSC_FALSE;
    first[d] = PetscMin((PetscInt64)((low - domain->lower[d]) / d0), cells - 1);
    last[d]  = PetscMin((PetscInt64)((high - domain->lower[d]) / d0), cells - 1);
  }
  x[2] = 0;
  for (PetscInt64 k = first[2]; k <= last[2]; k++) {
    if (domain->dim == DIM) x[2] = domain->lower[2] + ((PetscReal)k + 0.5) * d0;
    for (PetscInt64 j = first[1]; j <= last[1]; j++) {
      x[1] = domain->lower[1] + ((PetscReal)j + 0.5) * d0;
      for (PetscInt64 i = first[0]; i <= last[0];) {
        PetscReal s;

        x[0] = domain->lower[0] + ((PetscReal)i + 0.5) * d0;
        s    = PetscMax(ShapeDistance(a, x), ShapeDistance(b, x));
        if (s < bound) return PETSC_TRUE;
        /* The distance is at least 'bound' at all points within s - bound. */
        i += 1 + (PetscInt64)PetscMin((s - bound) / d0, (PetscReal)(last[0] - i));
      }
    }
  }
  return PETSC_FALSE;
}

/* A body is outside if its bounds miss the box, or if each lattice point is farther from it than a cell's diagonal. A
   motion may have taken a solid elsewhere before the start: the packing refuses it there. */
PetscErrorCode BodyCheckInside(Body body)
{
  Domain    domain = body->domain;
  PetscReal lower[DIM], upper[DIM], x[DIM];
  PetscBool inside = PETSC_TRUE;

  PetscFunctionBegin;
  if (body->motion && !body->free) PetscFunctionReturn(PETSC_SUCCESS);
  BodyBounds(body, lower, upper);
  for (PetscInt d = 0; d < domain->dim; d++) {
    if (upper[d] - lower[d] <= POINT_TOLERANCE * domain->spacing) inside = PETSC_FALSE;
  }
  if (inside) inside = FindCommonPoint(body, body, PetscSqrtReal((PetscReal)domain->dim) * domain->spacing, x);
  PetscCheckUser(inside, domain->comm,
                 "the body %s is wholly outside the box: its shape must reach into -box_lower to -box_upper",
                 body->name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the faces of holes a and b of a solid meet at x (m): they are closer than 'reach' (m) and face each other. */
static PetscBool FacesMeet(Body solid, Body a, Body b, PetscReal reach, const PetscReal x[DIM])
{
  PetscReal along = 0, s[2] = {a->shape->distance(a, x), b->shape->distance(b, x)};

  if (solid->shape->distance(solid, x) > -reach || PetscMax(PetscAbsReal(s[0]), PetscAbsReal(s[1])) > reach)
    return PETSC_FALSE;
  for (PetscInt k = 0; k < solid->holes; k++)
    if (solid->hole[k]->shape->distance(solid->hole[k], x) < -reach) return PETSC_FALSE;
  for (PetscInt d = 0; d < solid->domain->dim; d++) {
    PetscReal to[DIM] = {x[0], x[1], x[2]};

    to[d] += reach / 2;
    along += (a->shape->distance(a, to) - s[0]) * (b->shape->distance(b, to) - s[1]) / PetscSqr(reach / 2);
  }
  return (PetscBool)(along < FACING);
}

/* Refuses holes a and b of a solid whose faces meet somewhere. */
static PetscErrorCode CheckHoles(Body solid, Body a, Body b)
{
  const Domain    domain = solid->domain;
  const PetscReal reach  = domain->spacing / 2;
  PetscReal       lower[2][DIM], upper[2][DIM], low[DIM], step[DIM] = {0, 0, 0};
  PetscInt        at[DIM], first[DIM] = {0, 0, 0}, last[DIM] = {0, 0, 0};

  PetscFunctionBegin;
  a->shape->bounds(a, lower[0], upper[0]);
  b->shape->bounds(b, lower[1], upper[1]);
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal high = PetscMin(PetscMin(upper[0][d], upper[1][d]), domain->upper[d]);

    low[d] = PetscMax(PetscMax(lower[0][d], lower[1][d]), domain->lower[d]);
    if (low[d] > high + reach) PetscFunctionReturn(PETSC_SUCCESS);
    last[d] = (PetscInt)PetscMax(0, (high - low[d]) / domain->spacing);
    step[d] = (high - low[d]) / (last[d] + 1);
  }
  at[0] = at[1] = at[2] = 0;
  do {
    PetscReal x[DIM] = {0, 0, 0};

    for (PetscInt d = 0; d < domain->dim; d++) x[d] = low[d] + (at[d] + 0.5) * step[d];
    PetscCheckUser(!FacesMeet(solid, a, b, reach, x), domain->comm,
                   "the holes %s and %s of %s touch at %g,%g,%g m: a wall without thickness stays between them; they "
                   "must overlap by a spacing, %g m, or leave a wall as thick",
                   a->name, b->name, solid->name, (double)x[0], (double)x[1], (double)x[2], (double)domain->spacing);
  } while (CellNext(first, last, at));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SolidCheckHoles(Body solid)
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < solid->holes; a++)
    for (PetscInt b = a + 1; b < solid->holes; b++) PetscCall(CheckHoles(solid, solid->hole[a], solid->hole[b]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether an option sets the shape; without one the body fills the box. */
static PetscErrorCode ShapeGiven(Body body, PetscBool *given)
{
  const char *const options[] = {"-shape", "-lower", "-upper"};

  PetscFunctionBegin;
  *given = PETSC_FALSE;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(options) && !*given; k++)
    PetscCall(PetscOptionsHasName(NULL, body->prefix, options[k], given));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyCheckShape(Body body)
{
  char      option[2 * SCENE_NAME_LENGTH];
  PetscBool given;

  PetscFunctionBegin;
  PetscCall(ShapeGiven(body, &given));
  PetscCall(PetscSNPrintf(option, sizeof(option), "-%sshape", body->prefix));
  PetscCheckUser(
    given, body->domain->comm,
    "the body %s has no shape and would fill the whole box over the others: %s%s, or the corners of a box, "
    "-%slower and -%supper, must be given",
    body->name, option, OptionMeant(option), body->prefix, body->prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SceneCheckOverlap(Scene scene)
{
  const PetscReal tolerance = POINT_TOLERANCE * scene->domain->spacing;
  PetscReal       x[DIM];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < scene->count; a++) {
    for (PetscInt b = a + 1; b < scene->count; b++) {
      const PetscBool overlap = FindCommonPoint(scene->body[a], scene->body[b], -tolerance, x);

      if (overlap) PetscCall(BodyCheckShape(scene->body[b]));
      if (overlap) PetscCall(BodyCheckShape(scene->body[a]));
      PetscCheckUser(!overlap, scene->domain->comm,
                     "the bodies %s and %s overlap, for instance at %g,%g,%g m: shapes must be apart or touch, or "
                     "-bodies_overlap gives the common part to the first in -bodies",
                     scene->body[a]->name, scene->body[b]->name, (double)x[0], (double)x[1], (double)x[2]);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
