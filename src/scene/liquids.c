/* Two immiscible liquids: the liquid of each body, and the tension of the interface. */
#include "scene_impl.h"

/* Makes the named bodies the second liquid; without names the second body. */
static PetscErrorCode AssignLiquids(Scene scene, PetscInt names, char *name[])
{
  const MPI_Comm comm = scene->domain->comm;
  PetscInt       second;

  PetscFunctionBegin;
  PetscCheckUser(
    names > 0 || scene->count == 2, comm,
    "-interface_tension needs two bodies, or -interface_bodies with the names of the bodies of one liquid: "
    "there %s %" PetscInt_FMT " in -bodies",
    scene->count == 1 ? "is" : "are", scene->count);
  if (names == 0) scene->liquid[1] = 1;
  for (PetscInt k = 0; k < names; k++) {
    PetscBool same = PETSC_FALSE;

    for (PetscInt b = 0; b < scene->count && !same; b++) {
      PetscCall(PetscStrcmp(name[k], scene->body[b]->name, &same));
      if (same) scene->liquid[b] = 1;
    }
    PetscCheckUser(same, comm, "-interface_bodies: %s is none of -bodies", name[k]);
  }
  second = 0;
  for (PetscInt b = 0; b < scene->count; b++) second += scene->liquid[b];
  PetscCheckUser(second < scene->count, comm,
                 "-interface_bodies names all of -bodies: the other liquid needs a body, too");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses bodies of one liquid with different surface tensions. */
static PetscErrorCode CheckTensions(Scene scene)
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < scene->count; a++)
    for (PetscInt b = a + 1; b < scene->count; b++)
      PetscCheckUser(scene->liquid[a] != scene->liquid[b] ||
                       scene->body[a]->material.tension == scene->body[b]->material.tension,
                     scene->domain->comm,
                     "-%stension and -%stension differ, but both bodies are of one liquid: -interface_bodies names the "
                     "bodies of one of the two liquids",
                     scene->body[a]->prefix, scene->body[b]->prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const OptionRow two[] = {
  {"-interface_tension", "Tension of the interface between two liquids; 0: they mix", "N/m", "[0, inf)", ROW_REAL,
   offsetof(struct _p_Scene, interface_tension)},
  {.name = NULL},
};
static const OptionRow second[] = {
  {"-interface_bodies", "Names of the bodies of one of the two liquids", NULL, NULL, ROW_NAMES, 0,
   .fallback = "of two bodies the second", .most = SCENE_MAX_BODIES},
  {.name = NULL},
};

PetscErrorCode LiquidsSetFromOptions(Scene scene)
{
  Names names = {0};

  PetscFunctionBegin;
  PetscOptionsBegin(scene->domain->comm, NULL, "Two liquids that do not mix", "Scene");
  PetscCall(OptionsRead(PetscOptionsObject, two, "SceneSetFromOptions", scene));
  PetscCall(OptionsRead(PetscOptionsObject, second, "SceneSetFromOptions", &names));
  PetscOptionsEnd();
  if (scene->interface_tension > 0) {
    PetscCall(AssignLiquids(scene, names.count, names.name));
    PetscCall(CheckTensions(scene));
  }
  PetscCheckUser(!names.count || scene->interface_tension > 0, scene->domain->comm,
                 "-interface_bodies needs -interface_tension (N/m)");
  for (PetscInt k = 0; k < names.count; k++) PetscCall(PetscFree(names.name[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal SceneInterfaceTension(Scene scene)
{
  return scene->interface_tension;
}

PetscReal SceneInterfaceDensity(Scene scene)
{
  PetscReal least[2] = {PETSC_MAX_REAL, PETSC_MAX_REAL};

  for (PetscInt b = 0; b < scene->count; b++)
    least[scene->liquid[b]] = PetscMin(least[scene->liquid[b]], scene->body[b]->material.density);
  return least[0] + least[1];
}

PetscInt SceneLiquid(Scene scene, PetscInt body)
{
  return scene->liquid[body];
}

void SceneTensions(Scene scene, PetscReal part[3])
{
  PetscReal gas[2] = {0, 0};

  for (PetscInt b = 0; b < scene->count; b++) gas[scene->liquid[b]] = scene->body[b]->material.tension;
  part[0] = 0.5 * (gas[0] + scene->interface_tension - gas[1]);
  part[1] = 0.5 * (gas[1] + scene->interface_tension - gas[0]);
  part[2] = 0.5 * (gas[0] + gas[1] - scene->interface_tension);
}

PetscErrorCode SceneInterfaceBodies(Scene scene, char names[], size_t length)
{
  PetscFunctionBegin;
  names[0] = 0;
  for (PetscInt b = 0; b < scene->count; b++) {
    if (scene->liquid[b] == 0) continue;
    if (names[0]) TextAppend(names, length, ",");
    TextAppend(names, length, scene->body[b]->name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode LiquidsView(Scene scene, PetscViewer viewer)
{
  static const char *const spreads[3] = {
    "the other liquid spreads between this liquid and gas, as a film that becomes thinner than a particle",
    "this liquid spreads between the other liquid and gas, as a film that becomes thinner than a particle",
    "gas spreads between the liquids, which separate"};
  PetscReal part[3];
  PetscBool gas; /* a liquid has a surface tension */
  char      names[SCENE_MAX_BODIES * SCENE_NAME_LENGTH];

  PetscFunctionBegin;
  if (scene->interface_tension == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SceneInterfaceBodies(scene, names, sizeof(names)));
  PetscCall(PetscViewerASCIIPrintf(viewer, "interface of %g N/m between the liquid of %s and the other\n",
                                   (double)scene->interface_tension, names));
  SceneTensions(scene, part);
  gas = (PetscBool)(part[0] + part[2] > 0 || part[1] + part[2] > 0);
  for (PetscInt k = 0; k < 3; k++)
    if (part[k] < 0 && (gas || k != 2))
      PetscCall(PetscViewerASCIIPrintf(viewer,
                                       "  warning: where both liquids meet gas no contact angles balance the tensions: "
                                       "%s (spreading coefficient %.3g N/m)\n",
                                       spreads[k], (double)(-2 * part[k])));
  PetscFunctionReturn(PETSC_SUCCESS);
}
