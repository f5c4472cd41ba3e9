/* The scene as lines of text, "-<option> = <value>", with all numbers as they were read: two scenes are the same if
   these lines are. Options that may change from one start of a run to the next are not among them: forces, viscosity,
   contact angles, and the velocity and times of emitters. */
#include "scene_impl.h"
#include <stdio.h>

static void PrintNumbers(FILE *text, PetscInt n, const PetscReal x[])
{
  for (PetscInt k = 0; k < n; k++) fprintf(text, "%s%.12g", k ? "," : "", (double)(x[k] + 0.0)); /* -0 as 0 */
  fprintf(text, "\n");
}

static void PrintRows(FILE *text, Body body, const OptionRow rows[], const void *data)
{
  for (const OptionRow *row = rows; row && row->name; row++) {
    const void          *value   = (const char *)data + row->offset;
    const PetscReal     *real    = (const PetscReal *)value;
    const OptionNumbers *numbers = (const OptionNumbers *)value;
    const OptionFile    *file    = (const OptionFile *)value;
    const PetscBool      unit    = (PetscBool)(row->kind == ROW_AXIS || row->kind == ROW_NORMAL);
    const PetscInt       n       = row->kind == ROW_REAL ? 1 : unit ? DIM : body->domain->dim;

    if (row->kind == ROW_NUMBERS && numbers->count == 0) continue;
    if (row->kind == ROW_FILE && !file->path[0]) continue;
    fprintf(text, "-%s%s = ", body->prefix, row->name + 1);
    if (row->kind == ROW_INT)
      fprintf(text, "%" PetscInt_FMT "\n", *(const PetscInt *)value);
    else if (row->kind == ROW_BOOL)
      fprintf(text, "%d\n", (int)*(const PetscBool *)value);
    else if (row->kind == ROW_FILE)
      fprintf(text, "a file of the checksum %016llx\n", file->checksum);
    else if (row->kind == ROW_NUMBERS)
      PrintNumbers(text, numbers->count, numbers->value);
    else
      PrintNumbers(text, n, real);
  }
}

static void PrintShape(FILE *text, Body body)
{
  for (PetscInt k = 0; k < body->holes; k++) {
    fprintf(text, "hole %d of -%sholes = %s\n", (int)k + 1, body->prefix, body->hole[k]->name);
    PrintShape(text, body->hole[k]);
  }
  fprintf(text, "-%sshape = %s\n", body->prefix, body->shape_type);
  PrintRows(text, body, body->shape->choice.options, body->shape_data);
}

static void PrintBody(FILE *text, Body body)
{
  fprintf(text, "-%stype = %s\n-%sviscosity_model = %s\n", body->prefix, body->type, body->prefix,
          body->viscosity_type);
  fprintf(text, "-%sdensity = %.12g\n-%stension = %.12g\n", body->prefix, (double)body->material.density, body->prefix,
          (double)body->material.tension);
  PrintShape(text, body);
  if (BodyComesLater(body)) return;
  fprintf(text, "-%svelocity = ", body->prefix);
  PrintNumbers(text, body->domain->dim, body->uniform);
  fprintf(text, "-%svelocity_type = %s\n", body->prefix, body->velocity_type);
  PrintRows(text, body, body->velocity->choice.options, body->velocity_data);
}

static void PrintDomain(FILE *text, Domain domain)
{
  fprintf(text, "-dimension = %s\n", domain->rings ? "axisymmetric" : domain->dim == 2 ? "2" : "3");
  fprintf(text, "-spacing = %.12g\n", (double)domain->spacing);
  if (domain->graded) fprintf(text, "-spacing_coarse = %.12g\n", (double)domain->spacing_coarse);
  if (domain->adaptive) fprintf(text, "-spacing_follow = on\n"); /* what it follows may change */
  fprintf(text, "-box_lower = ");
  PrintNumbers(text, domain->dim, domain->lower);
  fprintf(text, "-box_upper = ");
  PrintNumbers(text, domain->dim, domain->upper);
  for (PetscInt f = 0; f < 2 * domain->dim; f++)
    fprintf(text, "-box_%c%s = %s\n", "xyz"[f / 2], f % 2 ? "max" : "min", FaceTypes[domain->face[f / 2][f % 2]]);
}

PetscErrorCode SceneIdentity(Scene scene, FILE *text)
{
  char names[SCENE_MAX_BODIES * SCENE_NAME_LENGTH];

  PetscFunctionBegin;
  PrintDomain(text, scene->domain);
  for (PetscInt b = 0; b < scene->count; b++) {
    fprintf(text, "body %d of -bodies = %s\n", (int)b + 1, scene->body[b]->name);
    PrintBody(text, scene->body[b]);
  }
  for (PetscInt b = 0; b < scene->solids; b++) {
    const Body solid = scene->solid[b];

    fprintf(text, "solid %d of -solids = %s\n", (int)b + 1, solid->name);
    PrintShape(text, solid);
    for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(SolidMotion.rows); k++)
      if (MotionData(solid, k)) PrintRows(text, solid, SolidMotion.rows[k], MotionData(solid, k));
  }
  if (scene->interface_tension == 0) PetscFunctionReturn(PETSC_SUCCESS); /* the liquids mix */
  PetscCall(SceneInterfaceBodies(scene, names, sizeof(names)));
  fprintf(text, "-interface_tension = %.12g\n-interface_bodies = %s\n", (double)scene->interface_tension, names);
  PetscFunctionReturn(PETSC_SUCCESS);
}
