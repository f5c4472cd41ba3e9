/* Ellipsoid with axes along x, y, z; an ellipse in two dimensions. */
#include "scene_impl.h"

#define NEWTON_MAX 200 /* steps; a start next to a pole takes a fraction of them */

typedef struct {
  PetscReal center[DIM]; /* m */
  PetscReal radii[DIM];  /* m */
} Ellipsoid;

static const OptionRow options[] = {
  ROW_OF_CENTER(Ellipsoid),
  {"-radii", "Radii of an ellipsoid along x, y, z", "m", NULL, ROW_POINT, offsetof(Ellipsoid, radii),
   .fallback = OPTION_REQUIRED},
  {.name = NULL},
};

static PetscErrorCode EllipsoidSetUp(void *owner)
{
  Body             body      = (Body)owner;
  Domain           domain    = body->domain;
  const Ellipsoid *ellipsoid = (const Ellipsoid *)body->shape_data;
  PetscBool        given;

  PetscFunctionBegin;
  PetscCall(PetscOptionsHasName(NULL, body->prefix, "-radii", &given));
  PetscCheckUser(given, domain->comm, "-%sradii is missing: the radii of the ellipsoid (m) must be given",
                 body->prefix);
  for (PetscInt d = 0; d < domain->dim; d++) {
    PetscCheckUser(ellipsoid->radii[d] > 0, domain->comm, "-%sradii must be positive, not %g m", body->prefix,
                   (double)ellipsoid->radii[d]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* sum_d (r_d y_d / p_d)^2 - 1 with p_d = s + r_d^2 - least^2, and its derivative to s. A term with y_d = 0 is zero even
   at its pole. */
static PetscReal Excess(PetscInt dim, const PetscReal r[], const PetscReal y[], PetscReal least, PetscReal s,
                        PetscReal *slope)
{
  PetscReal value = -1;

  *slope = 0;
  for (PetscInt d = 0; d < dim; d++) {
    if (y[d] > 0) {
      const PetscReal pole = s + (r[d] - least) * (r[d] + least), q = r[d] * y[d] / pole;

      value += q * q;
      *slope -= 2 * q * q / pole;
    }
  }
  return value;
}

/* The surface point nearest to y >= 0 (one octant) is z_d = r_d^2 y_d / p_d with s the root of Excess (D. Eberly,
   Distance from a point to an ellipse, an ellipsoid, or a hyperellipsoid, Geometric Tools). Excess is convex and
   decreases for s > 0, so Newton's method does not overshoot if Excess is positive at the start. */
static PetscReal EllipsoidDistance(Body body, const PetscReal x[DIM])
{
  const Ellipsoid *ellipsoid = (const Ellipsoid *)body->shape_data;
  const PetscInt   dim       = body->domain->dim;
  const PetscReal *r         = ellipsoid->radii;
  PetscReal        y[DIM], least = PETSC_MAX_REAL, thin = 0, level = -1, square = 0, rest = 1, s, value, slope;
  PetscBool        rooted;

  for (PetscInt d = 0; d < dim; d++) {
    y[d]  = PetscAbsReal(x[d] - ellipsoid->center[d]);
    least = PetscMin(least, r[d]);
    level += PetscSqr(y[d] / r[d]);
  }
  for (PetscInt d = 0; d < dim; d++) {
    if (r[d] == least) thin += y[d] * y[d];
  }
  s      = least * PetscSqrtReal(thin); /* the terms of the shortest radius make Excess >= 0 */
  value  = Excess(dim, r, y, least, s, &slope);
  rooted = thin > 0 || value > 0 ? PETSC_TRUE : PETSC_FALSE;
  for (PetscInt i = 0; i < NEWTON_MAX && value > 0; i++) {
    const PetscReal next = s - value / slope;

    if (!(next > s)) break;
    s     = next;
    value = Excess(dim, r, y, least, s, &slope);
  }
  for (PetscInt d = 0; d < dim; d++) {
    const PetscReal nearest = y[d] > 0 ? r[d] * r[d] * y[d] / (s + (r[d] - least) * (r[d] + least)) : 0;

    square += PetscSqr(nearest - y[d]);
    rest -= PetscSqr(nearest / r[d]);
  }
  /* Deep inside on the mid-plane of the shortest radius Excess has no root; the nearest point is off that plane. */
  if (!rooted) square += least * least * PetscMax(0, rest);
  return level < 0 ? -PetscSqrtReal(square) : PetscSqrtReal(square);
}

static void EllipsoidBounds(Body body, PetscReal lower[DIM], PetscReal upper[DIM])
{
  const Ellipsoid *ellipsoid = (const Ellipsoid *)body->shape_data;

  for (PetscInt d = 0; d < DIM; d++) {
    lower[d] = ellipsoid->center[d] - ellipsoid->radii[d];
    upper[d] = ellipsoid->center[d] + ellipsoid->radii[d];
  }
}

const ShapeOps ShapeEllipsoid = {
  {"ellipsoid", sizeof(Ellipsoid), options, NULL, EllipsoidSetUp}, EllipsoidDistance, EllipsoidBounds, NULL, NULL};
