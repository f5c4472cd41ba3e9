/* The scene as lines of text, "-<option> = <value>", with all numbers as they were read: two scenes are the same if
   these lines are. Options that may change from one start of a run to the next are not among them: forces, viscosity,
   contact angles, and the velocity and times of emitters. */
#include "scene_impl.h"

/* What a body, solid or hole is made of, and its shape. */
static void PrintShape(FILE *text, Body body)
{
  const OptionRow *rows;
  const void      *data;

  for (PetscInt k = 0; k < body->holes; k++) {
    fprintf(text, "hole %d of -%sholes = %s\n", (int)k + 1, body->prefix, body->hole[k]->name);
    PrintShape(text, body->hole[k]);
  }
  for (PetscInt k = 0; (rows = BodyMatter(body, k, &data)); k++)
    OptionsIdentity(text, body->prefix, rows, data, body->domain->dim);
  fprintf(text, "-%sshape = %s\n", body->prefix, body->shape_type);
  OptionsIdentity(text, body->prefix, body->shape->choice.options, body->shape_data, body->domain->dim);
}

static void PrintBody(FILE *text, Body body)
{
  fprintf(text, "-%stype = %s\n", body->prefix, body->type);
  PrintShape(text, body);
  if (BodyComesLater(body)) return;
  OptionsIdentity(text, body->prefix, BodyStart, body, body->domain->dim);
  OptionsIdentity(text, body->prefix, body->velocity->choice.options, body->velocity_data, body->domain->dim);
}

PetscErrorCode SceneIdentity(Scene scene, FILE *text)
{
  char names[SCENE_MAX_BODIES * SCENE_NAME_LENGTH];

  PetscFunctionBegin;
  DomainIdentity(scene->domain, text);
  PropertiesIdentity(scene->domain, &scene->own, "", text);
  for (PetscInt b = 0; b < scene->count; b++) {
    fprintf(text, "body %d of -bodies = %s\n", (int)b + 1, scene->body[b]->name);
    PrintBody(text, scene->body[b]);
  }
  for (PetscInt b = 0; b < scene->solids; b++) {
    const Body solid = scene->solid[b];

    fprintf(text, "solid %d of -solids = %s\n", (int)b + 1, solid->name);
    PrintShape(text, solid);
    for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(SolidMotion.rows); k++)
      if (MotionData(solid, k))
        OptionsIdentity(text, solid->prefix, SolidMotion.rows[k], MotionData(solid, k), solid->domain->dim);
  }
  if (scene->interface_tension == 0) PetscFunctionReturn(PETSC_SUCCESS); /* the liquids mix */
  PetscCall(SceneInterfaceBodies(scene, names, sizeof(names)));
  fprintf(text, "-interface_tension = %.12g\n-interface_bodies = %s\n", (double)scene->interface_tension, names);
  PetscFunctionReturn(PETSC_SUCCESS);
}
