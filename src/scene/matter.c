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

/* The numbers of what a body is made of, and the names of what it chose besides the defaults: the first of a registry.
 */
static PetscErrorCode ViewMatter(Body body, PetscViewer viewer)
{
  char             text[OPTION_TEXT_LENGTH] = "";
  const OptionRow *rows;
  const void      *data;

  PetscFunctionBegin;
  for (PetscInt k = 0; (rows = BodyMatter(body, k, &data)); k++)
    OptionsTell(text, sizeof(text), rows, data, PETSC_TRUE);
  PetscCall(PetscViewerASCIIPrintf(viewer, "%s\n", text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyView(Body body, PetscBool tension, PetscViewer viewer)
{
  const PetscReal *v = body->uniform;
  PetscReal        lower[DIM], upper[DIM];

  PetscFunctionBegin;
  BodyBounds(body, lower, upper);
  PetscCall(PetscViewerASCIIPrintf(viewer, "%s: %s%s%s within %g, %g, %g to %g, %g, %g m\n", body->name,
                                   BodyComesLater(body) ? body->type : "", BodyComesLater(body) ? ", " : "",
                                   body->shape_type, (double)lower[0], (double)lower[1], (double)lower[2],
                                   (double)upper[0], (double)upper[1], (double)upper[2]));
  if (!body->velocity) { /* a solid */
    if (body->motion) PetscCall(SolidMotion.view(body, tension, viewer));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscViewerASCIIPushTab(viewer));
  PetscCall(ViewMatter(body, viewer));
  PetscCall(PetscViewerASCIIPrintf(viewer, "velocity %s and %g, %g, %g m/s\n", body->velocity_type, (double)v[0],
                                   (double)v[1], (double)v[2]));
  PetscCall(PetscViewerASCIIPopTab(viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}
