/* The options of a body: shape, material, velocity, type. */
#include "scene_impl.h"

PetscErrorCode BodyCheckLength(Body body, const char option[], PetscReal length)
{
  char full[2 * SCENE_NAME_LENGTH];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(full, sizeof(full), "-%s%s", body->prefix, option + 1));
  PetscCheckUser(length > 0, body->domain->comm, "%s is missing%s: it must be given (m) and positive", full,
                 OptionMeant(full));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads the name of a choice from a list; name: the default on entry. */
static PetscErrorCode ReadChoice(Body body, OptionItems PetscOptionsObject, const char option[], const char help[],
                                 const char what[], PetscFunctionList list, char name[SCENE_NAME_LENGTH],
                                 const BodyChoice **choice)
{
  BodyChoiceTable table;
  char            names[NAMES_LENGTH];

  PetscFunctionBegin;
  PetscCall(PetscOptionsFList(option, help, "SceneSetFromOptions", list, name, name, SCENE_NAME_LENGTH, NULL));
  PetscCall(PetscFunctionListFind(list, name, &table));
  PetscCall(ListNames(list, names));
  PetscCheckUser(table, body->domain->comm, "-%s%s %s is not a %s; there are %s", body->prefix, option + 1, name, what,
                 names);
  *choice = table();
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The names of the holes; ReadHoles reads their shapes, outside the body's block of options. */
static PetscErrorCode ReadHoleNames(Body body, OptionItems PetscOptionsObject, char *names[], PetscInt *count)
{
  PetscFunctionBegin;
  *count = BODY_HOLES_MOST;
  PetscCall(PetscOptionsStringArray("-holes",
                                    "Names of shapes that are cut out of the body or solid, separated by commas; each "
                                    "has a shape like a body, and may be a body itself",
                                    "SceneSetFromOptions", names, count, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadHoles(Body body, const BodyChoices *choices, char *names[], PetscInt count)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < count; k++) {
    PetscBool same;

    PetscCall(PetscStrcmp(names[k], body->name, &same));
    PetscCheckUser(names[k][0] && !same, body->domain->comm, "-%sholes: '%s' cannot be a hole of %s", body->prefix,
                   names[k], body->name);
    PetscCall(BodyCreate(body->domain, names[k], k, &body->hole[k]));
    body->holes++;
    PetscCall(RegionSetFromOptions(body->hole[k], choices));
    PetscCall(BodyCheckShape(body->hole[k]));
    PetscCall(BodyCheckInside(body->hole[k]));
    PetscCall(PetscFree(names[k]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadShape(Body body, OptionItems PetscOptionsObject, PetscFunctionList shapes)
{
  const BodyChoice *choice;

  PetscFunctionBegin;
  PetscCall(ReadChoice(body, PetscOptionsObject, "-shape", "Shape of the body, cut by the box", "shape", shapes,
                       body->shape_type, &choice));
  body->shape = (const ShapeOps *)choice;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const OptionRow material[] = {
  {"-density", "Density (kg/m3)", "(0, inf)", ROW_REAL, offsetof(struct _p_Body, material.density)},
  {"-viscosity",
   "Dynamic viscosity (Pa s); with -viscosity_model carreau the viscosity at rest, with power_law and herschel_bulkley "
   "the consistency, Pa s^n",
   "[0, inf)", ROW_REAL, offsetof(struct _p_Body, material.viscosity)},
  {"-tension", "Surface tension (N/m)", "[0, inf)", ROW_REAL, offsetof(struct _p_Body, material.tension)},
  {.name = NULL},
};

static const OptionRow contact[] = {
  {"-contact_angle",
   "Contact angle of the free surface on the solid, in the liquid (degrees); 0: the liquid does not wet the solid",
   "[0, 180)", ROW_REAL, offsetof(struct _p_Body, contact_angle)},
  {"-contact_hysteresis",
   "Advancing minus receding contact angle (degrees), half of it on either side of -contact_angle; between them "
   "contact lines do not move",
   "[0, 180)", ROW_REAL, offsetof(struct _p_Body, contact_hysteresis)},
  {.name = NULL},
};

static const OptionRow uniform[] = {
  {"-velocity", "Uniform part of the initial velocity (m/s)", NULL, ROW_DIRECTION, offsetof(struct _p_Body, uniform)},
  {.name = NULL},
};

static PetscErrorCode Read(Body body, OptionItems PetscOptionsObject, const OptionRow rows[], void *data)
{
  return DomainReadOptions(body->domain, PetscOptionsObject, rows, "SceneSetFromOptions", data);
}

static PetscErrorCode ReadVelocity(Body body, OptionItems PetscOptionsObject, PetscFunctionList velocities)
{
  const BodyChoice *choice;

  PetscFunctionBegin;
  PetscCall(Read(body, PetscOptionsObject, uniform, body));
  PetscCall(ReadChoice(body, PetscOptionsObject, "-velocity_type", "Initial velocity field, added to the uniform part",
                       "velocity field", velocities, body->velocity_type, &choice));
  body->velocity = (const VelocityOps *)choice;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadViscosity(Body body, OptionItems PetscOptionsObject, PetscFunctionList viscosities)
{
  const BodyChoice *choice;

  PetscFunctionBegin;
  PetscCall(ReadChoice(body, PetscOptionsObject, "-viscosity_model", "How the viscosity depends on the shear rate",
                       "viscosity model", viscosities, body->viscosity_type, &choice));
  body->viscosity = (const ViscosityOps *)choice;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadType(Body body, OptionItems PetscOptionsObject, PetscFunctionList types,
                               const BodyChoice **type)
{
  PetscFunctionBegin;
  PetscCall(ReadChoice(body, PetscOptionsObject, "-type", "Type of the body", "type of body", types, body->type, type));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Allocates the data of a choice and reads its options. */
static PetscErrorCode ReadOptionsOf(const BodyChoice *choice, Body body, OptionItems PetscOptionsObject, void **data)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(*data));
  if (choice->size) PetscCall(PetscCalloc(choice->size, data));
  if (choice->defaults) choice->defaults(body);
  PetscCall(Read(body, PetscOptionsObject, choice->options, *data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadAndSetUp(const BodyChoice *choice, Body body, OptionItems PetscOptionsObject, void **data)
{
  PetscFunctionBegin;
  PetscCall(ReadOptionsOf(choice, body, PetscOptionsObject, data));
  if (choice->setup) PetscCall(choice->setup(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadAndSetUpShape(Body body, OptionItems PetscOptionsObject, PetscFunctionList shapes)
{
  PetscFunctionBegin;
  PetscCall(ReadShape(body, PetscOptionsObject, shapes));
  PetscCall(ReadAndSetUp(&body->shape->choice, body, PetscOptionsObject, &body->shape_data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodySetFromOptions(Body body, const BodyChoices *choices)
{
  char              title[2 * SCENE_NAME_LENGTH], *holes[BODY_HOLES_MOST];
  PetscInt          count;
  const BodyChoice *type;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(title, sizeof(title), "Body %s", body->name));
  PetscOptionsBegin(body->domain->comm, body->prefix, title, "Scene");
  PetscCall(ReadAndSetUpShape(body, PetscOptionsObject, choices->shapes));
  PetscCall(ReadHoleNames(body, PetscOptionsObject, holes, &count));
  PetscCall(Read(body, PetscOptionsObject, material, body));
  PetscCall(ReadViscosity(body, PetscOptionsObject, choices->viscosities));
  PetscCall(ReadAndSetUp(&body->viscosity->choice, body, PetscOptionsObject, &body->viscosity_data));
  PetscCall(ReadVelocity(body, PetscOptionsObject, choices->velocities));
  PetscCall(ReadAndSetUp(&body->velocity->choice, body, PetscOptionsObject, &body->velocity_data));
  PetscCall(
    ReadType(body, PetscOptionsObject, choices->types, &type)); /* last: an emitter looks at shape and velocity */
  PetscCall(ReadAndSetUp(type, body, PetscOptionsObject, &body->emitter));
  PetscOptionsEnd();
  PetscCall(ReadHoles(body, choices, holes, count));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadContactAngle(Body body, OptionItems PetscOptionsObject)
{
  PetscFunctionBegin;
  PetscCall(Read(body, PetscOptionsObject, contact, body));
  PetscCheckUser(body->contact_hysteresis == 0 || body->contact_angle > 0, body->domain->comm,
                 "-%scontact_hysteresis needs -%scontact_angle", body->prefix, body->prefix);
  PetscCheckUser(body->contact_hysteresis == 0 ||
                   0.5 * body->contact_hysteresis < PetscMin(body->contact_angle, 180 - body->contact_angle),
                 body->domain->comm,
                 "-%scontact_hysteresis %g: the contact angle, %g, plus and minus half of it must lie in (0, 180)",
                 body->prefix, (double)body->contact_hysteresis, (double)body->contact_angle);
  PetscCheckUser(body->contact_angle == 0 || !body->free, body->domain->comm,
                 "-%scontact_angle cannot be used with -%smass: the surface tension's force on a free body is not "
                 "computed",
                 body->prefix, body->prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SolidSetFromOptions(Body body, const BodyChoices *choices)
{
  char     title[2 * SCENE_NAME_LENGTH], *holes[BODY_HOLES_MOST];
  PetscInt count;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(title, sizeof(title), "Solid %s", body->name));
  PetscOptionsBegin(body->domain->comm, body->prefix, title, "Scene");
  PetscCall(ReadAndSetUpShape(body, PetscOptionsObject, choices->shapes));
  PetscCall(ReadHoleNames(body, PetscOptionsObject, holes, &count));
  PetscOptionsEnd();
  PetscCall(ReadHoles(body, choices, holes, count)); /* the mass of a free body needs them */
  PetscCall(PetscSNPrintf(title, sizeof(title), "Motion and contact of solid %s", body->name)); /* PETSc helps once */
  PetscOptionsBegin(body->domain->comm, body->prefix, title, "Scene");
  PetscCall(MotionSetFromOptions(body, PetscOptionsObject));
  PetscCall(MotionSetUp(body));
  PetscCall(ReadContactAngle(body, PetscOptionsObject));
  PetscOptionsEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RegionSetFromOptions(Body body, const BodyChoices *choices)
{
  char title[2 * SCENE_NAME_LENGTH];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(title, sizeof(title), "Region %s", body->name));
  PetscOptionsBegin(body->domain->comm, body->prefix, title, "Scene");
  PetscCall(ReadAndSetUpShape(body, PetscOptionsObject, choices->shapes));
  PetscOptionsEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes -help list the options of each choice of a list. option: it selects the choice; data: of the choice, in the
   body. */
static PetscErrorCode HelpChoices(Body body, PetscFunctionList list, const char option[], void **data)
{
  const char    **names;
  int             count;
  char            title[3 * SCENE_NAME_LENGTH];
  BodyChoiceTable table;

  PetscFunctionBegin;
  PetscCall(PetscFunctionListGet(list, &names, &count));
  for (int k = 0; k < count && names[k]; k++) { /* PETSc counts the end too */
    PetscCall(PetscFunctionListFind(list, names[k], &table));
    if (!table()->options) continue;
    PetscCall(PetscSNPrintf(title, sizeof(title), "Body with -%s%s %s", body->prefix, option, names[k]));
    PetscOptionsBegin(body->domain->comm, body->prefix, title, "Scene");
    PetscCall(ReadOptionsOf(table(), body, PetscOptionsObject, data));
    PetscOptionsEnd();
  }
  PetscCall(PetscFree(names));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BodyHelp(MPI_Comm comm, const BodyChoices *choices)
{
  Domain            domain;
  Body              body;
  const BodyChoice *type;
  char             *holes[BODY_HOLES_MOST];
  PetscInt          count;

  PetscFunctionBegin;
  PetscCall(DomainCreate(comm, &domain));
  PetscCall(BodyCreate(domain, "<body>", 0, &body)); /* no name of a scene's body has these signs */
  PetscOptionsBegin(comm, body->prefix, "Body, any", "Scene");
  PetscCall(ReadShape(body, PetscOptionsObject, choices->shapes));
  PetscCall(ReadHoleNames(body, PetscOptionsObject, holes, &count));
  PetscCall(Read(body, PetscOptionsObject, material, body));
  PetscCall(ReadViscosity(body, PetscOptionsObject, choices->viscosities));
  PetscCall(ReadVelocity(body, PetscOptionsObject, choices->velocities));
  PetscCall(ReadType(body, PetscOptionsObject, choices->types, &type));
  PetscOptionsEnd();
  PetscCall(HelpChoices(body, choices->shapes, "shape", &body->shape_data));
  PetscCall(HelpChoices(body, choices->viscosities, "viscosity_model", &body->viscosity_data));
  PetscCall(HelpChoices(body, choices->velocities, "velocity_type", &body->velocity_data));
  PetscCall(HelpChoices(body, choices->types, "type", &body->emitter));
  PetscOptionsBegin(comm, body->prefix, "Solid that moves", "Scene");
  PetscCall(MotionSetFromOptions(body, PetscOptionsObject));
  PetscOptionsEnd();
  PetscOptionsBegin(comm, body->prefix, "Solid, any", "Scene");
  PetscCall(ReadContactAngle(body, PetscOptionsObject));
  PetscOptionsEnd();
  PetscCall(BodyDestroy(&body));
  PetscCall(DomainDestroy(&domain));
  PetscFunctionReturn(PETSC_SUCCESS);
}
