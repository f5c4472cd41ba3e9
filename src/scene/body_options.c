/* The options of a body: shape, material, velocity, type. */
#include "scene_impl.h"

static PetscErrorCode Read(Body body, OptionItems PetscOptionsObject, const OptionRow rows[], void *data)
{
  return DomainReadOptions(body->domain, PetscOptionsObject, rows, "SceneSetFromOptions", data);
}

/* The holes; ReadHoles reads their shapes, outside the body's block of options. */
typedef struct {
  PetscInt count;
  char    *name[BODY_HOLES_MOST];
} Holes;

static const OptionRow holed[] = {
  {"-holes",
   "Names of shapes that are cut out of the body or solid, separated by commas; each has a shape like a body, and may "
   "be a body itself",
   NULL, NULL, ROW_NAMES, 0, .most = BODY_HOLES_MOST},
  {.name = NULL},
};

static PetscErrorCode ReadHoles(Body body, Holes *holes)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < holes->count; k++) {
    PetscBool same;

    PetscCall(PetscStrcmp(holes->name[k], body->name, &same));
    PetscCheckUser(holes->name[k][0] && !same, body->domain->comm, "-%sholes: '%s' cannot be a hole of %s",
                   body->prefix, holes->name[k], body->name);
    for (PetscInt j = 0; j < k; j++)
      PetscCheckUser(strcmp(body->hole[j]->name, holes->name[k]), body->domain->comm,
                     "-%sholes: the name %s appears twice", body->prefix, holes->name[k]);
    PetscCall(BodyCreate(body->domain, holes->name[k], k, &body->hole[k]));
    body->holes++;
    PetscCall(RegionSetFromOptions(body->hole[k], PETSC_TRUE));
    PetscCall(BodyCheckShape(body->hole[k]));
    PetscCall(BodyCheckInside(body->hole[k]));
    PetscCall(PetscFree(holes->name[k]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const OptionRow shaped[] = {
  {"-shape", "Shape of the body, cut by the box", NULL, NULL, ROW_CHOICE, offsetof(struct _p_Body, shape_type),
   .choices = Shapes},
  {.name = NULL},
};

static const OptionRow typed[] = {
  {"-type", "Type of the body; an emitter is an inflow", NULL, NULL, ROW_CHOICE, offsetof(struct _p_Body, type),
   .choices = BodyTypes},
  {.name = NULL},
};

/* A ChoiceReader: allocates the data of a choice and reads its options, in the body's block or in one of their own. */
typedef struct {
  Body        body;
  OptionItems items; /* NULL: a block of their own */
  const char *option;
  void      **data;
} ChoiceReading;

static PetscErrorCode ReadOptionsOf(void *object, const Choice *choice)
{
  const ChoiceReading *r    = (const ChoiceReading *)object;
  Body                 body = r->body;
  char                 title[3 * SCENE_NAME_LENGTH];

  PetscFunctionBegin;
  PetscCall(PetscFree(*r->data));
  if (choice->size) PetscCall(PetscCalloc(choice->size, r->data));
  if (choice->defaults) choice->defaults(body);
  if (r->items) PetscCall(Read(body, r->items, choice->options, *r->data));
  if (r->items || !choice->options) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(title, sizeof(title), "Body with %s %s", r->option, choice->name));
  PetscOptionsBegin(body->domain->comm, body->prefix, title, "Scene");
  PetscCall(Read(body, PetscOptionsObject, choice->options, *r->data));
  PetscOptionsEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the choice that the body has made of the row's, and reads its options; without items, those of all. */
static PetscErrorCode ReadChosen(Body body, OptionItems items, const OptionRow *row, void **data, const Choice **choice)
{
  const char   *name = (const char *)body + row->offset;
  char          option[OPTION_NAME_LENGTH];
  ChoiceReading reading = {body, items, option, data};

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(option, sizeof(option), "-%s%s", body->prefix, row->name + 1));
  PetscCall(ChoiceFind(body->domain->comm, row->choices, option, name, choice));
  PetscCall(ChoicesRead(row->choices, option, body->prefix, *choice, (PetscBool)!items, ReadOptionsOf, &reading));
  if (items && (*choice)->setup) PetscCall((*choice)->setup(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadShape(Body body, OptionItems PetscOptionsObject)
{
  const Choice *choice;

  PetscFunctionBegin;
  PetscCall(Read(body, PetscOptionsObject, shaped, body));
  PetscCall(ReadChosen(body, PetscOptionsObject, shaped, &body->shape_data, &choice));
  body->shape = (const ShapeOps *)choice;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const OptionRow *const of_bodies[] = {BodyMaterials, BodyViscosities, BodyStart, typed};

PetscErrorCode BodySetFromOptions(Body body)
{
  char          title[2 * SCENE_NAME_LENGTH];
  Holes         holes = {0};
  const Choice *choice;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(title, sizeof(title), "Body %s", body->name));
  PetscOptionsBegin(body->domain->comm, body->prefix, title, "Scene");
  PetscCall(ReadShape(body, PetscOptionsObject));
  PetscCall(Read(body, PetscOptionsObject, holed, &holes));
  PetscCall(Read(body, PetscOptionsObject, BodyMaterials, body));
  PetscCall(Read(body, PetscOptionsObject, BodyViscosities, body));
  PetscCall(ReadChosen(body, PetscOptionsObject, BodyViscosities, &body->viscosity_data, &choice));
  body->viscosity = (const ViscosityOps *)choice;
  PetscCall(Read(body, PetscOptionsObject, BodyStart, body));
  PetscCall(ReadChosen(body, PetscOptionsObject, &BodyStart[1], &body->velocity_data, &choice));
  body->velocity = (const VelocityOps *)choice;
  PetscCall(PropertiesRead(body->domain, PetscOptionsObject, OWNER_BODY, &body->own));
  PetscCall(Read(body, PetscOptionsObject, typed, body)); /* last: a type may look at shape and velocity */
  PetscCall(ReadChosen(body, PetscOptionsObject, typed, &body->type_data, &choice));
  body->kind = (const BodyTypeOps *)choice;
  PetscOptionsEnd();
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(SolidMotion.rows); k++)
    PetscCall(OptionsNote(body->prefix, "a solid", SolidMotion.rows[k]));
  PetscCall(OptionsNote(body->prefix, "a solid", SolidWetting.rows));
  PetscCall(PropertiesNote(body->domain, body->prefix, "a solid", OWNER_SOLID));
  PetscCall(ReadHoles(body, &holes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadWetting(Body body, OptionItems PetscOptionsObject)
{
  PetscFunctionBegin;
  PetscCall(PetscCalloc(SolidWetting.size, &body->wetting));
  PetscCall(Read(body, PetscOptionsObject, SolidWetting.rows, body->wetting));
  PetscCall(SolidWetting.check(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SolidSetFromOptions(Body body)
{
  char  title[2 * SCENE_NAME_LENGTH];
  Holes holes = {0};

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(title, sizeof(title), "Solid %s", body->name));
  PetscOptionsBegin(body->domain->comm, body->prefix, title, "Scene");
  PetscCall(ReadShape(body, PetscOptionsObject));
  PetscCall(Read(body, PetscOptionsObject, holed, &holes));
  PetscOptionsEnd();
  PetscCall(ReadHoles(body, &holes)); /* the mass of a free body needs them */
  PetscCall(SolidCheckHoles(body));
  PetscCall(PetscSNPrintf(title, sizeof(title), "Motion and contact of solid %s", body->name)); /* PETSc helps once */
  PetscOptionsBegin(body->domain->comm, body->prefix, title, "Scene");
  PetscCall(SolidMotion.read(body, PetscOptionsObject));
  PetscCall(SolidMotion.setup(body));
  BodyFindBall(body);
  PetscCall(ReadWetting(body, PetscOptionsObject));
  PetscCall(PropertiesRead(body->domain, PetscOptionsObject, OWNER_SOLID, &body->own));
  PetscOptionsEnd();
  PetscCall(PropertiesNote(body->domain, body->prefix, "a body of liquid", OWNER_BODY));
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(of_bodies); k++)
    PetscCall(OptionsNote(body->prefix, "a body of liquid", of_bodies[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RegionSetFromOptions(Body body, PetscBool hole)
{
  char title[2 * SCENE_NAME_LENGTH];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(title, sizeof(title), "Region %s", body->name));
  PetscOptionsBegin(body->domain->comm, body->prefix, title, "Scene");
  PetscCall(ReadShape(body, PetscOptionsObject));
  if (hole) PetscCall(PropertiesRead(body->domain, PetscOptionsObject, OWNER_HOLE, &body->own));
  PetscOptionsEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SceneHelp(Domain of)
{
  const MPI_Comm comm = of->comm;
  Domain         domain;
  Body           body;
  Holes          holes = {0};
  const Choice  *choice;

  PetscFunctionBegin;
  PetscCall(DomainCreate(comm, &domain));
  for (PetscInt k = 0; k < of->property_count; k++) PetscCall(DomainAddProperty(domain, of->property[k]));
  PetscCall(BodyCreate(domain, "<body>", 0, &body)); /* no name of a scene's body has these signs */
  PetscOptionsBegin(comm, body->prefix, "Body, any", "Scene");
  PetscCall(Read(body, PetscOptionsObject, shaped, body));
  PetscCall(Read(body, PetscOptionsObject, holed, &holes));
  PetscCall(Read(body, PetscOptionsObject, BodyMaterials, body));
  PetscCall(Read(body, PetscOptionsObject, BodyViscosities, body));
  PetscCall(Read(body, PetscOptionsObject, BodyStart, body));
  PetscCall(Read(body, PetscOptionsObject, typed, body));
  PetscOptionsEnd();
  PetscOptionsBegin(comm, body->prefix, "Body, what features give it", "Scene");
  PetscCall(PropertiesRead(domain, PetscOptionsObject, OWNER_BODY, &body->own));
  PetscOptionsEnd();
  PetscCall(ReadChosen(body, NULL, shaped, &body->shape_data, &choice));
  PetscCall(ReadChosen(body, NULL, BodyViscosities, &body->viscosity_data, &choice));
  PetscCall(ReadChosen(body, NULL, &BodyStart[1], &body->velocity_data, &choice));
  PetscCall(ReadChosen(body, NULL, typed, &body->type_data, &choice));
  PetscOptionsBegin(comm, body->prefix, "Solid that moves", "Scene");
  PetscCall(SolidMotion.read(body, PetscOptionsObject));
  PetscOptionsEnd();
  PetscOptionsBegin(comm, body->prefix, "Hole, any", "Scene");
  PetscCall(PropertiesRead(domain, PetscOptionsObject, OWNER_HOLE, &body->own));
  PetscOptionsEnd();
  PetscOptionsBegin(comm, body->prefix, "Solid, any", "Scene");
  PetscCall(ReadWetting(body, PetscOptionsObject));
  PetscCall(PropertiesRead(domain, PetscOptionsObject, OWNER_SOLID, &body->own));
  PetscOptionsEnd();
  PetscCall(BodyDestroy(&body));
  PetscCall(DomainDestroy(&domain));
  PetscFunctionReturn(PETSC_SUCCESS);
}
