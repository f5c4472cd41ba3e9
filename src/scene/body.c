/* One body: its options, and what other folders ask of it. */
#include "scene_impl.h"
#include <stdlib.h>

#define WATER_DENSITY     1000.0 /* kg/m3, default */
#define WATER_VISCOSITY   1e-3   /* Pa s, default */
#define SURFACE_TOLERANCE 1e-6   /* of the spacing: points of the surface itself are outside, whatever the rounding */

static const char *const AxisNames[DIM] = {"x", "y", "z"};

PetscErrorCode BodyCreate(Domain domain, const char name[], PetscInt index, Body *body)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(body));
  (*body)->domain             = domain;
  (*body)->color              = index;
  (*body)->material.density   = WATER_DENSITY;
  (*body)->material.viscosity = WATER_VISCOSITY;
  PetscCall(PetscStrncpy((*body)->name, name, sizeof((*body)->name)));
  PetscCall(PetscSNPrintf((*body)->prefix, sizeof((*body)->prefix), "%s_", name));
  PetscCall(PetscStrncpy((*body)->type, "liquid", sizeof((*body)->type)));
  PetscCall(PetscStrncpy((*body)->shape_type, "box", sizeof((*body)->shape_type)));
  PetscCall(PetscStrncpy((*body)->velocity_type, "uniform", sizeof((*body)->velocity_type)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyDestroy(Body *body)
{
  PetscFunctionBegin;
  if (!*body) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree((*body)->shape_data));
  PetscCall(PetscFree((*body)->velocity_data));
  PetscCall(PetscFree((*body)->emitter));
  PetscCall(PetscFree(*body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyOptionsLength(Body body, OptionItems PetscOptionsObject, const char option[], const char help[],
                                 PetscReal *length)
{
  PetscBool       found;
  const PetscBool needed = *length > 0 ? PETSC_FALSE : PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(PetscOptionsReal(option, help, "SceneSetFromOptions", *length, length, &found));
  PetscCheckUser(found || !needed, body->domain->comm, "-%s%s is missing: it must be given (m) and positive",
                 body->prefix, option + 1);
  PetscCheckUser(*length > 0 && !PetscIsInfOrNanReal(*length), body->domain->comm,
                 "-%s%s must be positive and finite, not %g m", body->prefix, option + 1, (double)*length);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The numbers of "1,0,-2"; count is -1 when the text is something else. */
static void ParseNumbers(const char text[], PetscInt most, PetscReal number[], PetscInt *count)
{
  char *end;

  for (*count = 0; *count < most; text = end + 1) {
    number[(*count)++] = (PetscReal)strtod(text, &end);
    if (end == text || (*end && *end != ',')) *count = -1;
    if (*count < 0 || !*end) return;
  }
  *count = -1;
}

PetscErrorCode BodyOptionsAxis(Body body, OptionItems PetscOptionsObject, const char option[], const char help[],
                               PetscBool normal_allowed, PetscReal axis[DIM])
{
  Domain    domain = body->domain;
  PetscInt  count, largest = 0;
  PetscReal v[DIM] = {0, 0, 0}, size;
  PetscBool found, planar;
  char      text[SCENE_NAME_LENGTH];

  PetscFunctionBegin;
  for (PetscInt d = 1; d < DIM; d++) largest = axis[d] > axis[largest] ? d : largest;
  PetscCall(PetscOptionsString(option, help, "SceneSetFromOptions", AxisNames[largest], text, sizeof(text), &found));
  if (!found) PetscFunctionReturn(PETSC_SUCCESS);
  if (text[0] >= 'x' && text[0] <= 'z' && !text[1])
    v[text[0] - 'x'] = 1;
  else {
    ParseNumbers(text, DIM, v, &count);
    PetscCheckUser(count == domain->dim || count == DIM, domain->comm,
                   "-%s%s %s is no direction: it must be x, y, z or %s numbers", body->prefix, option + 1, text,
                   domain->dim == 2 ? "two or three" : "three");
  }
  /* Two scalings: a length such as 1e-200 has no square. */
  size = PetscMax(PetscAbsReal(v[0]), PetscMax(PetscAbsReal(v[1]), PetscAbsReal(v[2])));
  PetscCheckUser(size > 0 && !PetscIsInfOrNanReal(v[0] + v[1] + v[2]), domain->comm,
                 "-%s%s %s must be finite and not zero", body->prefix, option + 1, text);
  for (PetscInt d = 0; d < DIM; d++) v[d] /= size;
  size   = Norm(v);
  planar = v[2] == 0 || (normal_allowed && v[0] == 0 && v[1] == 0) ? PETSC_TRUE : PETSC_FALSE;
  PetscCheckUser(domain->dim == DIM || planar, domain->comm, "-%s%s %s must lie in the plane%s in two dimensions",
                 body->prefix, option + 1, text, normal_allowed ? " or along z" : "");
  for (PetscInt d = 0; d < DIM; d++) axis[d] = v[d] / size;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadShape(Body body, OptionItems PetscOptionsObject, PetscFunctionList shapes)
{
  ShapeTable table;
  char       names[NAMES_LENGTH];

  PetscFunctionBegin;
  PetscCall(PetscOptionsFList("-shape", "Shape of the body, cut by the box", "SceneSetFromOptions", shapes,
                              body->shape_type, body->shape_type, sizeof(body->shape_type), NULL));
  PetscCall(PetscFunctionListFind(shapes, body->shape_type, &table));
  PetscCall(ListNames(shapes, names));
  PetscCheckUser(table, body->domain->comm, "-%sshape %s is not a shape; there are %s", body->prefix, body->shape_type,
                 names);
  PetscCall(PetscFree(body->shape_data));
  body->shape = table();
  PetscCall(body->shape->setfromoptions(body, PetscOptionsObject));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadMaterial(Body body, OptionItems PetscOptionsObject)
{
  Material *m    = &body->material;
  MPI_Comm  comm = body->domain->comm;

  PetscFunctionBegin;
  PetscCall(PetscOptionsReal("-density", "Density (kg/m3)", "SceneSetFromOptions", m->density, &m->density, NULL));
  PetscCheckUser(m->density > 0 && !PetscIsInfOrNanReal(m->density), comm,
                 "-%sdensity must be positive and finite, not %g kg/m3", body->prefix, (double)m->density);
  PetscCall(PetscOptionsReal("-viscosity", "Dynamic viscosity (Pa s)", "SceneSetFromOptions", m->viscosity,
                             &m->viscosity, NULL));
  PetscCheckUser(m->viscosity >= 0 && !PetscIsInfOrNanReal(m->viscosity), comm,
                 "-%sviscosity must be finite and not negative, not %g Pa s", body->prefix, (double)m->viscosity);
  PetscCall(
    PetscOptionsReal("-tension", "Surface tension (N/m)", "SceneSetFromOptions", m->tension, &m->tension, NULL));
  PetscCheckUser(m->tension >= 0 && !PetscIsInfOrNanReal(m->tension), comm,
                 "-%stension must be finite and not negative, not %g N/m", body->prefix, (double)m->tension);
  PetscCall(
    PetscOptionsInt("-color", "Label of the body in pictures", "SceneSetFromOptions", body->color, &body->color, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadVelocity(Body body, OptionItems PetscOptionsObject, PetscFunctionList velocities)
{
  VelocityTable table;
  char          names[NAMES_LENGTH];

  PetscFunctionBegin;
  PetscCall(DomainOptionsVector(body->domain, PetscOptionsObject, VECTOR_DIRECTION, "-velocity",
                                "Uniform part of the initial velocity (m/s)", "SceneSetFromOptions", body->uniform,
                                NULL));
  PetscCall(PetscOptionsFList("-velocity_type", "Initial velocity field, added to the uniform part",
                              "SceneSetFromOptions", velocities, body->velocity_type, body->velocity_type,
                              sizeof(body->velocity_type), NULL));
  PetscCall(PetscFunctionListFind(velocities, body->velocity_type, &table));
  PetscCall(ListNames(velocities, names));
  PetscCheckUser(table, body->domain->comm, "-%svelocity_type %s is not a velocity field; there are %s", body->prefix,
                 body->velocity_type, names);
  PetscCall(PetscFree(body->velocity_data));
  body->velocity = table();
  if (body->velocity->size) PetscCall(PetscCalloc(body->velocity->size, &body->velocity_data));
  if (body->velocity->setfromoptions) PetscCall(body->velocity->setfromoptions(body, PetscOptionsObject));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses a body without a point in the box: its bounds miss the box, or every lattice point is farther than a cell's
   diagonal. */
static PetscErrorCode CheckInside(Body body)
{
  Domain    domain = body->domain;
  PetscReal lower[DIM], upper[DIM], x[DIM];
  PetscBool inside = PETSC_TRUE;

  PetscFunctionBegin;
  BodyBounds(body, lower, upper);
  for (PetscInt d = 0; d < domain->dim; d++) {
    if (upper[d] - lower[d] <= SURFACE_TOLERANCE * domain->spacing) inside = PETSC_FALSE;
  }
  if (inside) inside = SceneLatticeSearch(body, body, PetscSqrtReal((PetscReal)domain->dim) * domain->spacing, x);
  PetscCheckUser(inside, domain->comm,
                 "the body %s is wholly outside the box: its shape must reach into -box_lower to -box_upper",
                 body->name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The type last: an emitter looks at shape and velocity. */
static PetscErrorCode ReadType(Body body, OptionItems PetscOptionsObject, PetscFunctionList types)
{
  BodyType type;
  char     names[NAMES_LENGTH];

  PetscFunctionBegin;
  PetscCall(PetscOptionsFList("-type", "What the body is", "SceneSetFromOptions", types, body->type, body->type,
                              sizeof(body->type), NULL));
  PetscCall(PetscFunctionListFind(types, body->type, &type));
  PetscCall(ListNames(types, names));
  PetscCheckUser(type, body->domain->comm, "-%stype %s is no type of body; there are %s", body->prefix, body->type,
                 names);
  PetscCall(type(body, PetscOptionsObject));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodySetFromOptions(Body body, PetscFunctionList types, PetscFunctionList shapes,
                                  PetscFunctionList velocities)
{
  char title[2 * SCENE_NAME_LENGTH];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(title, sizeof(title), "Body %s", body->name));
  PetscOptionsBegin(body->domain->comm, body->prefix, title, "Scene");
  PetscCall(ReadShape(body, PetscOptionsObject, shapes));
  PetscCall(ReadMaterial(body, PetscOptionsObject));
  PetscCall(ReadVelocity(body, PetscOptionsObject, velocities));
  PetscCall(ReadType(body, PetscOptionsObject, types));
  PetscOptionsEnd();
  PetscCall(CheckInside(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SolidSetFromOptions(Body body, PetscFunctionList shapes)
{
  char title[2 * SCENE_NAME_LENGTH];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(title, sizeof(title), "Solid %s", body->name));
  PetscOptionsBegin(body->domain->comm, body->prefix, title, "Scene");
  PetscCall(ReadShape(body, PetscOptionsObject, shapes));
  PetscOptionsEnd();
  PetscCall(CheckInside(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyView(Body body, PetscViewer viewer)
{
  const Material  *m = &body->material;
  const PetscReal *v = body->uniform;
  PetscReal        lower[DIM], upper[DIM];

  PetscFunctionBegin;
  BodyBounds(body, lower, upper);
  PetscCall(PetscViewerASCIIPrintf(viewer, "%s: %s%s within %g, %g, %g to %g, %g, %g m\n", body->name,
                                   body->emitter ? "emitter, " : "", body->shape_type, (double)lower[0],
                                   (double)lower[1], (double)lower[2], (double)upper[0], (double)upper[1],
                                   (double)upper[2]));
  if (!body->velocity) PetscFunctionReturn(PETSC_SUCCESS); /* a solid */
  PetscCall(PetscViewerASCIIPushTab(viewer));
  PetscCall(PetscViewerASCIIPrintf(viewer,
                                   "density %g kg/m3, viscosity %g Pa s, tension %g N/m, color %" PetscInt_FMT "\n",
                                   (double)m->density, (double)m->viscosity, (double)m->tension, body->color));
  PetscCall(PetscViewerASCIIPrintf(viewer, "velocity %s and %g, %g, %g m/s\n", body->velocity_type, (double)v[0],
                                   (double)v[1], (double)v[2]));
  PetscCall(PetscViewerASCIIPopTab(viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const char *BodyName(Body body)
{
  return body->name;
}

const Material *BodyMaterial(Body body)
{
  return &body->material;
}

PetscInt BodyColor(Body body)
{
  return body->color;
}

PetscReal BodyDistance(Body body, const PetscReal x[DIM])
{
  return body->shape->distance(body, x);
}

PetscBool BodyContains(Body body, const PetscReal x[DIM])
{
  for (PetscInt d = 0; d < body->domain->dim; d++) {
    if (!(x[d] >= body->domain->lower[d] && x[d] <= body->domain->upper[d])) return PETSC_FALSE;
  }
  return body->shape->distance(body, x) < -SURFACE_TOLERANCE * body->domain->spacing ? PETSC_TRUE : PETSC_FALSE;
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
