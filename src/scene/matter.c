/* What bodies, solids and holes are made of: rows, which whatever compares, tells or prints them walks. */
#include "scene_impl.h"

const OptionRow BodyMaterials[] = {
  {"-density", "Density", "kg/m3", "(0, inf)", ROW_REAL, offsetof(struct _p_Body, material.density)},
  {"-viscosity",
   "Dynamic viscosity; with -viscosity_model carreau the viscosity at rest, with power_law and herschel_bulkley the "
   "consistency, Pa s^n",
   "Pa s", "[0, inf)", ROW_REAL, offsetof(struct _p_Body, material.viscosity), .changes = PETSC_TRUE},
  {"-tension", "Surface tension", "N/m", "[0, inf)", ROW_REAL, offsetof(struct _p_Body, material.tension)},
  {.name = NULL},
};

const OptionRow BodyViscosities[] = {
  {"-viscosity_model", "How the viscosity depends on the shear rate", NULL, NULL, ROW_CHOICE,
   offsetof(struct _p_Body, viscosity_type), .choices = Viscosities},
  {.name = NULL},
};

const OptionRow BodyStart[] = {
  {"-velocity", "Uniform part of the initial velocity", "m/s", NULL, ROW_DIRECTION, offsetof(struct _p_Body, uniform)},
  {"-velocity_type", "Initial velocity field, added to the uniform part", NULL, NULL, ROW_CHOICE,
   offsetof(struct _p_Body, velocity_type), .choices = Velocities},
  {.name = NULL},
};

const OptionRow *BodyMatter(Body body, PetscInt k, const void **data)
{
  static const OptionRow none[] = {{.name = NULL}};
  const PetscBool        liquid = (PetscBool)(body->own.owner == OWNER_BODY),
                  solid         = (PetscBool)(body->own.owner == OWNER_SOLID);
  const Property *property;
  void           *own;

  *data = body;
  if (liquid && k < 2) return k == 0 ? BodyMaterials : BodyViscosities;
  *data = liquid ? body->viscosity_data : body->wetting;
  if (liquid && k == 2) return body->viscosity->choice.options ? body->viscosity->choice.options : none;
  if (solid && k == 0) return SolidWetting.rows;
  property = PropertiesWalk(body->domain, &body->own, k - (liquid ? 3 : solid ? 1 : 0), &own);
  *data    = own;
  return property ? property->rows : NULL;
}

PetscBool BodiesAlike(Body one, Body other)
{
  const OptionRow *rows, *others;
  const void      *a, *b;

  if (one->own.owner != other->own.owner) return PETSC_FALSE;
  for (PetscInt k = 0; (rows = BodyMatter(one, k, &a)); k++) {
    others = BodyMatter(other, k, &b);
    if (rows != others || !OptionsSame(rows, a, b)) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* What a body is made of: its material, the names of what it chose besides the first of a registry, and the numbers of
   properties that are not as they are without options. */
static PetscErrorCode ViewMatter(Body body, PetscViewer viewer)
{
  const Domain     domain                   = body->domain;
  char             text[OPTION_TEXT_LENGTH] = "";
  struct _p_Body   plain                    = *body;
  const OptionRow *rows;
  const void      *data, *standard;

  PetscFunctionBegin;
  plain.own.data = NULL;
  PetscCall(PropertiesMake(domain, plain.own.owner, &plain.own));
  for (PetscInt k = 0; (rows = BodyMatter(body, k, &data)); k++) {
    (void)BodyMatter(&plain, k, &standard);
    if (data == (const void *)body) standard = data;
    if (data == standard || !OptionsSame(rows, data, standard))
      OptionsTell(text, sizeof(text), rows, data, domain->dim, (PetscBool)(data == standard));
  }
  PetscCall(PropertiesFree(&plain.own));
  PetscCall(PetscViewerASCIIPrintf(viewer, "%s\n", text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Warns of what is not filled: unlike solids, a body of liquid does not go on behind a periodic face. One that reaches
   beyond both faces fills the period. */
static PetscErrorCode ViewCut(Body body, PetscViewer viewer)
{
  const Domain domain = body->domain;
  PetscReal    lower[DIM], upper[DIM];

  PetscFunctionBegin;
  body->shape->bounds(body, lower, upper);
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscBool below = (PetscBool)(lower[d] < domain->lower[d] - 0.5 * domain->spacing),
                    above = (PetscBool)(upper[d] > domain->upper[d] + 0.5 * domain->spacing);

    if (domain->face[d][0] != FACE_PERIODIC || below == above) continue;
    PetscCall(PetscViewerASCIIPrintf(viewer,
                                     "warning: %s is cut at the periodic face %c%s; a second body of this shape, %g m "
                                     "away, fills what is beyond it\n",
                                     body->name, "xyz"[d], below ? "min" : "max",
                                     (double)(domain->upper[d] - domain->lower[d])));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyView(Body body, PetscBool tension, PetscViewer viewer)
{
  const PetscInt dim = body->domain->dim;
  PetscReal      lower[DIM], upper[DIM];
  char           from[VECTOR_TEXT], to[VECTOR_TEXT];

  PetscFunctionBegin;
  BodyBounds(body, lower, upper);
  PetscCall(PetscViewerASCIIPrintf(viewer, "%s: %s%s%s within %s to %s m\n", body->name,
                                   BodyComesLater(body) ? body->type : "", BodyComesLater(body) ? ", " : "",
                                   body->shape_type, VectorText(dim, lower, from), VectorText(dim, upper, to)));
  if (!body->velocity) { /* a solid */
    if (body->motion) PetscCall(SolidMotion.view(body, tension, viewer));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscViewerASCIIPushTab(viewer));
  PetscCall(ViewCut(body, viewer));
  PetscCall(ViewMatter(body, viewer));
  PetscCall(PetscViewerASCIIPrintf(viewer, "velocity %s and %s m/s\n", body->velocity_type,
                                   VectorText(dim, body->uniform, to)));
  PetscCall(PetscViewerASCIIPopTab(viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}
