/* A body: creation, and the functions that other folders call. */
#include "scene_impl.h"

#define WATER_DENSITY   1000.0     /* kg/m3, that of water is 998 at 20 degrees Celsius */
#define WATER_VISCOSITY 1e-3       /* Pa s, that of water is 1.002e-3 there */
#define BALL_EXCESS     (1 + 1e-6) /* factor of a ball about a solid: more than its rounding */

PetscErrorCode BodyCreate(Domain domain, const char name[], PetscInt index, Body *body)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(body));
  (*body)->domain             = domain;
  (*body)->material.density   = WATER_DENSITY;
  (*body)->material.viscosity = WATER_VISCOSITY;
  PetscCall(PetscStrncpy((*body)->name, name, sizeof((*body)->name)));
  PetscCall(PetscSNPrintf((*body)->prefix, sizeof((*body)->prefix), "%s_", name));
  PetscCall(PetscStrncpy((*body)->type, "liquid", sizeof((*body)->type)));
  PetscCall(PetscStrncpy((*body)->shape_type, "box", sizeof((*body)->shape_type)));
  PetscCall(PetscStrncpy((*body)->velocity_type, "uniform", sizeof((*body)->velocity_type)));
  PetscCall(PetscStrncpy((*body)->viscosity_type, "newtonian", sizeof((*body)->viscosity_type)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyDestroy(Body *body)
{
  PetscFunctionBegin;
  if (!*body) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < (*body)->holes; k++) PetscCall(BodyDestroy(&(*body)->hole[k]));
  PetscCall(PetscFree((*body)->shape_data));
  PetscCall(PetscFree((*body)->velocity_data));
  PetscCall(PetscFree((*body)->viscosity_data));
  PetscCall(PetscFree((*body)->type_data));
  PetscCall(PetscFree((*body)->wetting));
  PetscCall(PropertiesFree(&(*body)->own));
  PetscCall(SolidMotion.destroy(*body));
  PetscCall(PetscFree(*body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const char *BodyName(Body body)
{
  return body->name;
}

void *BodyOwn(Body body, const Property *property)
{
  return PropertyOf(body->domain, &body->own, property);
}

const Material *BodyMaterial(Body body)
{
  return &body->material;
}

PetscReal BodyDistance(Body body, const PetscReal x[DIM])
{
  PetscReal y[DIM];

  if (!body->motion) return ShapeDistance(body, x);
  SolidMotion.back(body, x, y);
  return ShapeDistance(body, y);
}

void BodyForth(Body body, PetscReal x[DIM])
{
  if (body->motion) SolidMotion.forth(body, x);
}

void BodyFindBall(Body solid)
{
  PetscReal lower[DIM], upper[DIM], center[DIM], corner[DIM] = {0};

  solid->shape->bounds(solid, lower, upper);
  for (PetscInt d = 0; d < DIM && !solid->motion; d++) solid->middle[d] = 0.5 * (lower[d] + upper[d]);
  for (PetscInt d = 0; d < DIM; d++) center[d] = solid->middle[d];
  if (solid->motion) SolidMotion.back(solid, solid->middle, center);
  for (PetscInt d = 0; d < solid->domain->dim; d++)
    corner[d] = PetscMax(PetscAbsReal(lower[d] - center[d]), PetscAbsReal(upper[d] - center[d]));
  solid->extent = Norm(corner);
}

PetscBool BodyBeyond(Body solid, PetscReal reach, const PetscReal x[DIM])
{
  const Domain domain = solid->domain;
  PetscReal    r[DIM] = {0};

  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal length = domain->upper[d] - domain->lower[d];

    r[d] = x[d] - solid->middle[d];
    if (domain->face[d][0] == FACE_PERIODIC) r[d] -= length * PetscFloorReal(r[d] / length + 0.5);
  }
  return (PetscBool)(Dot(r, r) > PetscSqr(BALL_EXCESS * (solid->extent + reach)));
}

PetscReal BodyNearest(Body body, const PetscReal x[DIM], PetscReal y[DIM])
{
  const Domain domain = body->domain;
  PetscReal    least  = PETSC_MAX_REAL;
  PetscInt     images = 1, sides[DIM];

  for (PetscInt d = 0; d < DIM; d++) {
    sides[d] = d < domain->dim && domain->face[d][0] == FACE_PERIODIC ? 3 : 1;
    images *= sides[d];
  }
  for (PetscInt k = 0; k < images; k++) {
    const PetscInt at[DIM] = {k % sides[0], k / sides[0] % sides[1], k / (sides[0] * sides[1])};
    PetscReal      image[DIM], s;

    for (PetscInt d = 0; d < DIM; d++)
      image[d] = x[d] + (sides[d] > 1 ? (PetscReal)(at[d] - 1) * (domain->upper[d] - domain->lower[d]) : 0);
    s = BodyDistance(body, image);
    if (s >= least) continue;
    least = s;
    for (PetscInt d = 0; d < DIM; d++) y[d] = image[d];
  }
  return least;
}

PetscBool BodyContains(Body body, const PetscReal x[DIM])
{
  for (PetscInt d = 0; d < body->domain->dim; d++) {
    if (!(x[d] >= body->domain->lower[d] && x[d] <= body->domain->upper[d])) return PETSC_FALSE;
  }
  return ShapeDistance(body, x) < -POINT_TOLERANCE * body->domain->spacing ? PETSC_TRUE : PETSC_FALSE;
}

void BodyBounds(Body body, PetscReal lower[DIM], PetscReal upper[DIM])
{
  Domain domain = body->domain;

  body->shape->bounds(body, lower, upper);
  for (PetscInt d = 0; d < DIM; d++) {
    lower[d] = d < domain->dim ? PetscMax(lower[d], domain->lower[d]) : domain->lower[d];
    upper[d] = d < domain->dim ? PetscMin(upper[d], domain->upper[d]) : domain->upper[d];
  }
}

void BodyDisplace(Body body, PetscReal x[DIM])
{
  if (body->shape->displace) body->shape->displace(body, x);
}

void BodyVelocity(Body body, const PetscReal x[DIM], PetscReal v[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) v[d] = body->uniform[d];
  if (body->velocity->add) body->velocity->add(body, x, v);
}

PetscBool BodyHolds(Body body, const PetscReal x[DIM], PetscReal behind)
{
  return (PetscBool)(body->kind->holds && body->kind->holds(body, x, behind));
}

PetscInt BodyFillings(Body body, PetscReal time)
{
  return body->kind->fillings(body, time);
}

void BodyFillingVelocity(Body body, PetscReal time, const PetscReal x[DIM], PetscReal v[DIM])
{
  body->kind->velocity(body, time, x, v);
}

PetscBool BodyMoves(Body solid)
{
  return (PetscBool)(solid->motion != NULL);
}

void BodyMotion(Body solid, PetscReal time, const PetscReal x[DIM], PetscReal v[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) v[d] = 0;
  if (solid->motion) SolidMotion.velocity(solid, time, x, v);
}

PetscBool BodyComesLater(Body body)
{
  return (PetscBool)(body->kind && body->kind->later);
}
