/* The scene: its bodies by name, the registered shapes, overlap, and the body forces. */
#include "sceneimpl.h"
#include <ctype.h>

#define OVERLAP_TOLERANCE 1e-6 /* of the spacing; bodies that touch do not overlap */

static PetscFunctionList ShapeList    = NULL;
static PetscFunctionList VelocityList = NULL;

static PetscErrorCode SceneFinalizePackage(void)
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListDestroy(&ShapeList));
  PetscCall(PetscFunctionListDestroy(&VelocityList));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SceneRegisterAll(void)
{
  PetscFunctionBegin;
  if (ShapeList) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFunctionListAdd(&ShapeList, "box", ShapeBox));
  PetscCall(PetscFunctionListAdd(&ShapeList, "sphere", ShapeSphere));
  PetscCall(PetscFunctionListAdd(&ShapeList, "cylinder", ShapeCylinder));
  PetscCall(PetscFunctionListAdd(&ShapeList, "ellipsoid", ShapeEllipsoid));
  PetscCall(PetscFunctionListAdd(&ShapeList, "half_space", ShapeHalfSpace));
  PetscCall(PetscFunctionListAdd(&ShapeList, "thread", ShapeThread));
  PetscCall(PetscFunctionListAdd(&ShapeList, "wave", ShapeWave));
  PetscCall(VelocityRegisterAll(&VelocityList));
  PetscCall(PetscRegisterFinalize(SceneFinalizePackage));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SceneCreate(Domain domain, Scene *scene)
{
  PetscFunctionBegin;
  PetscCall(SceneRegisterAll());
  PetscCall(PetscNew(scene));
  (*scene)->domain = domain;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SceneDestroy(Scene *scene)
{
  PetscFunctionBegin;
  if (!*scene) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < (*scene)->count; b++) PetscCall(BodyDestroy(&(*scene)->body[b]));
  PetscCall(PetscFree(*scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads -gravity, -central_force_rate and -bodies; name is [count] strings to be freed. */
static PetscErrorCode ReadScene(Scene scene, char *name[], PetscInt *count)
{
  PetscFunctionBegin;
  PetscOptionsBegin(scene->domain->comm, NULL, "Scene", "Scene");
  PetscCall(PetscOptionsStringArray("-bodies", "Names of the bodies, separated by commas, required",
                                    "SceneSetFromOptions", name, count, NULL));
  PetscCall(DomainOptionsVector(scene->domain, PetscOptionsObject, VECTOR_DIRECTION, "-gravity",
                                "Acceleration of gravity (m/s2)", "SceneSetFromOptions", scene->gravity, NULL));
  PetscCall(PetscOptionsReal("-central_force_rate",
                             "Rate w of a central force, acceleration -w^2 x about the origin (1/s)",
                             "SceneSetFromOptions", scene->central_rate, &scene->central_rate, NULL));
  PetscOptionsEnd();
  PetscCheckUser(scene->central_rate >= 0 && !PetscIsInfOrNanReal(scene->central_rate), scene->domain->comm,
                 "-central_force_rate must be finite and not negative, not %g 1/s", (double)scene->central_rate);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An identifier that is new and does not collide with the options of the box. */
static PetscErrorCode CheckName(Scene scene, const char name[])
{
  MPI_Comm  comm = scene->domain->comm;
  size_t    length;
  PetscBool good, same;

  PetscFunctionBegin;
  PetscCall(PetscStrlen(name, &length));
  good = length > 0 && length < SCENE_NAME_LENGTH && isalpha((unsigned char)name[0]) ? PETSC_TRUE : PETSC_FALSE;
  for (size_t k = 0; k < length; k++) {
    if (!isalnum((unsigned char)name[k]) && name[k] != '_') good = PETSC_FALSE;
  }
  PetscCheckUser(
    good, comm,
    "-bodies: '%s' is not a name; a letter, then letters, digits and underscores, fewer than %d, are allowed", name,
    SCENE_NAME_LENGTH);
  PetscCall(PetscStrcmp(name, "box", &same));
  if (!same) PetscCall(PetscStrncmp(name, "box_", 4, &same));
  PetscCheckUser(!same, comm, "-bodies: the name %s is taken: -box_... are the options of the box", name);
  for (PetscInt b = 0; b < scene->count; b++) {
    PetscCall(PetscStrcmp(name, scene->body[b]->name, &same));
    PetscCheckUser(!same, comm, "-bodies: the name %s appears twice", name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckOverlap(Scene scene)
{
  const PetscReal tolerance = OVERLAP_TOLERANCE * scene->domain->spacing;
  PetscReal       x[DIM];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < scene->count; a++) {
    for (PetscInt b = a + 1; b < scene->count; b++) {
      PetscCheckUser(!SceneLatticeSearch(scene->body[a], scene->body[b], -tolerance, x), scene->domain->comm,
                     "the bodies %s and %s overlap, for instance at %g,%g,%g m: shapes must be apart or touch",
                     scene->body[a]->name, scene->body[b]->name, (double)x[0], (double)x[1], (double)x[2]);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SceneSetFromOptions(Scene scene)
{
  Domain         domain                     = scene->domain;
  char          *name[SCENE_MAX_BODIES + 1] = {NULL}; /* one more than allowed, to notice too many */
  PetscInt       count                      = SCENE_MAX_BODIES + 1;
  PetscErrorCode bad                        = PETSC_SUCCESS;

  PetscFunctionBegin;
  PetscCheck(!scene->count, domain->comm, PETSC_ERR_ORDER, "the options of a scene can be read once only");
  PetscCall(ReadScene(scene, name, &count));
  PetscCheckUser(count > 0, domain->comm,
                 "-bodies is missing: the names of one or more bodies of liquid must be given");
  PetscCheckUser(count <= SCENE_MAX_BODIES, domain->comm, "-bodies has more than the %d names allowed",
                 SCENE_MAX_BODIES);
  for (PetscInt b = 0; b < count; b++) {
    if (!bad) bad = CheckName(scene, name[b]);
    if (!bad) {
      PetscCall(BodyCreate(domain, name[b], b, &scene->body[b]));
      scene->count++;
    }
    PetscCall(PetscFree(name[b]));
  }
  PetscCall(bad);
  for (PetscInt b = 0; b < count; b++) PetscCall(BodySetFromOptions(scene->body[b], ShapeList, VelocityList));
  PetscCall(CheckOverlap(scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool SceneLatticeSearch(Body a, Body b, PetscReal bound, PetscReal x[DIM])
{
  Domain          domain = a->domain;
  const PetscReal d0     = domain->spacing;
  PetscReal       lower[2][DIM], upper[2][DIM];
  PetscInt64      first[DIM] = {0, 0, 0}, last[DIM] = {0, 0, 0};

  BodyBounds(a, lower[0], upper[0]);
  BodyBounds(b, lower[1], upper[1]);
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal  low = PetscMax(lower[0][d], lower[1][d]), high = PetscMin(upper[0][d], upper[1][d]);
    const PetscInt64 cells = (PetscInt64)PetscMax(1, PetscFloorReal((domain->upper[d] - domain->lower[d]) / d0 + 0.5));

    if (low > high) return PETSC_FALSE;
    first[d] = PetscMin((PetscInt64)((low - domain->lower[d]) / d0), cells - 1);
    last[d]  = PetscMin((PetscInt64)((high - domain->lower[d]) / d0), cells - 1);
  }
  x[2] = 0;
  for (PetscInt64 k = first[2]; k <= last[2]; k++) {
    if (domain->dim == DIM) x[2] = domain->lower[2] + ((PetscReal)k + 0.5) * d0;
    for (PetscInt64 j = first[1]; j <= last[1]; j++) {
      x[1] = domain->lower[1] + ((PetscReal)j + 0.5) * d0;
      for (PetscInt64 i = first[0]; i <= last[0];) {
        PetscReal s;

        x[0] = domain->lower[0] + ((PetscReal)i + 0.5) * d0;
        s    = PetscMax(BodyDistance(a, x), BodyDistance(b, x));
        if (s < bound) return PETSC_TRUE;
        /* No point nearer than s - bound has a distance below the bound. */
        i += 1 + (PetscInt64)PetscMin((s - bound) / d0, (PetscReal)(last[0] - i));
      }
    }
  }
  return PETSC_FALSE;
}

PetscErrorCode SceneView(Scene scene, PetscViewer viewer)
{
  const PetscReal *g = scene->gravity;
  PetscBool        ascii;

  PetscFunctionBegin;
  if (!viewer) PetscCall(PetscViewerASCIIGetStdout(scene->domain->comm, &viewer));
  PetscCall(PetscObjectTypeCompare((PetscObject)viewer, PETSCVIEWERASCII, &ascii));
  if (!ascii) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(
    PetscViewerASCIIPrintf(viewer,
                           "Scene: %" PetscInt_FMT " bodies, gravity %g, %g, %g m/s2, central force rate %g 1/s\n",
                           scene->count, (double)g[0], (double)g[1], (double)g[2], (double)scene->central_rate));
  PetscCall(PetscViewerASCIIPushTab(viewer));
  for (PetscInt b = 0; b < scene->count; b++) PetscCall(BodyView(scene->body[b], viewer));
  PetscCall(PetscViewerASCIIPopTab(viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt SceneCount(Scene scene)
{
  return scene->count;
}

Body SceneBody(Scene scene, PetscInt index)
{
  return scene->body[index];
}

void SceneAcceleration(Scene scene, const PetscReal x[DIM], PetscReal g[DIM])
{
  const PetscReal square = scene->central_rate * scene->central_rate;

  for (PetscInt d = 0; d < DIM; d++) g[d] = scene->gravity[d] - (d < scene->domain->dim ? square * x[d] : 0);
}

/* The acceleration is minus its gradient. */
PetscReal SceneForcePotential(Scene scene, const PetscReal x[DIM])
{
  const PetscReal square = scene->central_rate * scene->central_rate;
  PetscReal       energy = 0;

  for (PetscInt d = 0; d < scene->domain->dim; d++) energy += x[d] * (0.5 * square * x[d] - scene->gravity[d]);
  return energy;
}

PetscBool SceneHasViscosity(Scene scene)
{
  for (PetscInt b = 0; b < scene->count; b++) {
    if (scene->body[b]->material.viscosity > 0) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

PetscBool SceneHasTension(Scene scene)
{
  for (PetscInt b = 0; b < scene->count; b++) {
    if (scene->body[b]->material.tension > 0) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}
