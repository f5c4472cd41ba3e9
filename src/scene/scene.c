/* The scene: its named bodies, the registered shapes, and the body forces. */
#include "scene_impl.h"
#include <ctype.h>
#include <string.h>

#define NORMAL_STEP   0.1  /* of the differences that give a normal, spacings */
#define RIDGE         1e-3 /* of the step: differences below this vanish */
#define AXIS_SAMPLES  9    /* points on the axis of rings at which CheckRings computes a body's velocity */
#define AXIS_ROUNDING 1e-9 /* of a velocity, relative */

PetscErrorCode SceneCreate(Domain domain, Scene *scene)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(scene));
  (*scene)->domain = domain;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SceneDestroy(Scene *scene)
{
  PetscFunctionBegin;
  if (!*scene) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < (*scene)->count; b++) PetscCall(BodyDestroy(&(*scene)->body[b]));
  for (PetscInt b = 0; b < (*scene)->solids; b++) PetscCall(BodyDestroy(&(*scene)->solid[b]));
  for (PetscInt b = 0; b < (*scene)->fine_regions; b++) PetscCall(BodyDestroy(&(*scene)->fine[b]));
  PetscCall(BodyDestroy(&(*scene)->air));
  PetscCall(PropertiesFree(&(*scene)->own));
  PetscCall(ForcesDestroy(*scene));
  PetscCall(PetscFree(*scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The names of bodies, solids and regions. */
typedef struct {
  Names bodies, solids, fine;
} SceneWords;

static const OptionRow words[] = {
  {"-bodies", "Names of the bodies, separated by commas", NULL, NULL, ROW_NAMES, offsetof(SceneWords, bodies),
   .fallback = OPTION_REQUIRED, .most = SCENE_MAX_BODIES},
  {"-solids", "Names of the solids, separated by commas", NULL, NULL, ROW_NAMES, offsetof(SceneWords, solids),
   .most = SCENE_MAX_BODIES},
  {"-fine",
   "Names of the regions where the spacing is -spacing, separated by commas; each has a shape like a body; needs "
   "-spacing_coarse",
   NULL, NULL, ROW_NAMES, offsetof(SceneWords, fine), .most = SCENE_MAX_BODIES},
  {.name = NULL},
};

static const OptionRow options[] = {
  {"-bodies_overlap", "Bodies may overlap: the first of them in -bodies gets the common part", NULL, NULL, ROW_BOOL,
   offsetof(struct _p_Scene, overlap)},
  {.name = NULL},
};

Body SceneHole(Scene scene, PetscInt k)
{
  for (PetscInt b = 0; b < scene->count + scene->solids; b++) {
    const Body body = b < scene->count ? scene->body[b] : scene->solid[b - scene->count];

    if (k < body->holes) return body->hole[k];
    k -= body->holes;
  }
  return NULL;
}

Body SceneHoleAt(Scene scene, const PetscReal x[DIM])
{
  Body hole;

  for (PetscInt k = 0; (hole = SceneHole(scene, k)); k++)
    if (ShapeDistance(hole, x) < 0) return hole;
  return scene->air;
}

void *SceneOwn(Scene scene, const Property *property)
{
  return PropertyOf(scene->domain, &scene->own, property);
}

void *SceneFaceOwn(Scene scene, PetscInt d, PetscInt side, const Property *property)
{
  return PropertyOf(scene->domain, &scene->domain->own[d][side], property);
}

/* Reads the body forces and the names. */
static PetscErrorCode ReadScene(Scene scene, SceneWords *names)
{
  PetscFunctionBegin;
  PetscOptionsBegin(scene->domain->comm, NULL, "Scene", "Scene");
  PetscCall(OptionsRead(PetscOptionsObject, words, "SceneSetFromOptions", names));
  PetscCall(DomainReadOptions(scene->domain, PetscOptionsObject, options, "SceneSetFromOptions", scene));
  PetscCall(ForcesRead(scene, PetscOptionsObject));
  PetscCall(PropertiesRead(scene->domain, PetscOptionsObject, OWNER_SCENE, &scene->own));
  PetscOptionsEnd();
  PetscCall(BodyCreate(scene->domain, "air", 0, &scene->air));
  PetscCall(PropertiesMake(scene->domain, OWNER_HOLE, &scene->air->own));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool HasName(PetscInt n, const Body body[], const char name[])
{
  for (PetscInt k = 0; k < n; k++)
    if (!strcmp(body[k]->name, name)) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Refuses a name that is no identifier, appears twice or collides with the options of the box. */
static PetscErrorCode CheckName(Scene scene, const char option[], const char name[])
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
  PetscCheckUser(good, comm,
                 "%s: '%s' is not a name; a name is a letter, then letters, digits and underscores, fewer than %d in "
                 "all",
                 option, name, SCENE_NAME_LENGTH);
  PetscCall(PetscStrcmp(name, "box", &same));
  if (!same) PetscCall(PetscStrncmp(name, "box_", 4, &same));
  PetscCheckUser(!same, comm, "%s: the name %s is taken: -box_... are the options of the box", option, name);
  PetscCheckUser(!HasName(scene->count, scene->body, name) && !HasName(scene->solids, scene->solid, name) &&
                   !HasName(scene->fine_regions, scene->fine, name),
                 comm, "%s: the name %s appears twice", option, name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Creates a body for each name and frees the names. */
static PetscErrorCode CreateBodies(Scene scene, const char option[], Names *names, Body body[], PetscInt *count)
{
  PetscErrorCode bad = PETSC_SUCCESS;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < names->count; b++) {
    if (!bad) bad = CheckName(scene, option, names->name[b]);
    if (!bad) {
      PetscCall(BodyCreate(scene->domain, names->name[b], b, &body[b]));
      (*count)++;
    }
    PetscCall(PetscFree(names->name[b]));
  }
  PetscCall(bad);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses options that are not axisymmetric. */
static PetscErrorCode CheckRings(Scene scene)
{
  const Domain domain = scene->domain;

  PetscFunctionBegin;
  if (!domain->rings) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < scene->count; b++) {
    const Body body = scene->body[b];
    PetscReal  lower[DIM], upper[DIM];

    BodyBounds(body, lower, upper);
    for (PetscInt k = 0; k < AXIS_SAMPLES && lower[0] <= 0; k++) {
      const PetscReal x[DIM] = {0, lower[1] + (upper[1] - lower[1]) * k / (AXIS_SAMPLES - 1), 0};
      PetscReal       v[DIM];

      BodyVelocity(body, x, v);
      PetscCheckUser(
        PetscAbsReal(v[0]) <= AXIS_ROUNDING * Norm(v), domain->comm,
        "the initial velocity of the body %s at (0, %g) m has %g m/s away from the axis: on the axis it must be along "
        "the axis",
        body->name, (double)x[1], (double)v[0]);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses -fine and -spacing_follow without -spacing_coarse and the reverse. */
static PetscErrorCode CheckGrading(Scene scene)
{
  const Domain domain = scene->domain;

  PetscFunctionBegin;
  PetscCheckUser(domain->graded == (PetscBool)(scene->fine_regions > 0 || domain->adaptive), domain->comm,
                 "-spacing_coarse belongs to -fine or -spacing_follow: %s is missing%s",
                 domain->graded ? "-fine, the names of the regions of the fine spacing," : "-spacing_coarse (m)",
                 OptionMeant(domain->graded ? "-fine" : "-spacing_coarse"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses a solid that could be faster than SPEED_MAX. */
static PetscErrorCode CheckSpeed(Body solid)
{
  PetscReal lower[DIM], upper[DIM], speed;

  PetscFunctionBegin;
  if (!solid->motion) PetscFunctionReturn(PETSC_SUCCESS);
  BodyBounds(solid, lower, upper);
  speed = SolidMotion.speed(solid, lower, upper);
  PetscCheckUser(
    speed <= SPEED_MAX, solid->domain->comm,
    "the solid %s moves with up to %g m/s, by -%svelocity, -%srotation_rate and its other motions; at most "
    "%g m/s are allowed",
    solid->name, (double)speed, solid->prefix, solid->prefix, SPEED_MAX);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SceneSetFromOptions(Scene scene)
{
  Domain     domain  = scene->domain;
  PetscReal  densest = 0;
  SceneWords names   = {0};

  PetscFunctionBegin;
  PetscCheck(!scene->count, domain->comm, PETSC_ERR_ORDER, "the options of a scene can be read only once");
  PetscCall(ReadScene(scene, &names));
  PetscCheckUser(names.bodies.count > 0, domain->comm,
                 "-bodies is missing%s: the names of one or more bodies of liquid must be given",
                 OptionMeant("-bodies"));
  PetscCall(CreateBodies(scene, "-bodies", &names.bodies, scene->body, &scene->count));
  PetscCall(CreateBodies(scene, "-solids", &names.solids, scene->solid, &scene->solids));
  PetscCall(CreateBodies(scene, "-fine", &names.fine, scene->fine, &scene->fine_regions));
  for (PetscInt b = 0; b < scene->count; b++) {
    PetscCall(BodySetFromOptions(scene->body[b]));
    PetscCall(BodyCheckInside(scene->body[b]));
    densest = PetscMax(densest, BodyMaterial(scene->body[b])->density);
  }
  for (PetscInt b = 0; b < scene->solids; b++) {
    PetscCall(SolidSetFromOptions(scene->solid[b]));
    PetscCall(CheckSpeed(scene->solid[b]));
    PetscCall(SolidMotion.check(scene->solid[b], densest));
    PetscCall(BodyCheckInside(scene->solid[b]));
  }
  for (PetscInt b = 0; b < scene->fine_regions; b++) {
    PetscCall(RegionSetFromOptions(scene->fine[b], PETSC_FALSE));
    PetscCall(BodyCheckInside(scene->fine[b]));
  }
  PetscCall(LiquidsSetFromOptions(scene));
  PetscCall(ForcesCheck(scene));
  PetscCall(CheckGrading(scene));
  PetscCall(CheckRings(scene));
  if (!scene->overlap) PetscCall(SceneCheckOverlap(scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

Domain SceneDomain(Scene scene)
{
  return scene->domain;
}

PetscReal SceneSpacing(Scene scene, const PetscReal x[DIM])
{
  const Domain domain = scene->domain;
  PetscReal    least  = domain->spacing_coarse;

  for (PetscInt b = 0; b < scene->fine_regions; b++)
    least = PetscMin(least, domain->spacing + domain->growth * PetscMax(0, BodyDistance(scene->fine[b], x)));
  if (domain->adaptive) least = PetscMin(least, PetscMax(domain->spacing, domain->adaptive->at(domain, x)));
  return least;
}

PetscInt SceneCount(Scene scene)
{
  return scene->count;
}

Body SceneBody(Scene scene, PetscInt index)
{
  return scene->body[index];
}

PetscInt SceneSolidCount(Scene scene)
{
  return scene->solids;
}

PetscBool SceneComesLater(Scene scene)
{
  for (PetscInt b = 0; b < scene->count; b++)
    if (BodyComesLater(scene->body[b])) return PETSC_TRUE;
  return PETSC_FALSE;
}

Body SceneSolid(Scene scene, PetscInt index)
{
  return scene->solid[index];
}

PetscReal SceneSolidDistance(Scene scene, const PetscReal x[DIM], PetscInt *nearest)
{
  return SceneSolidWithin(scene, PETSC_MAX_REAL, x, nearest);
}

PetscReal SceneSolidWithin(Scene scene, PetscReal reach, const PetscReal x[DIM], PetscInt *nearest)
{
  PetscReal least = reach;

  for (PetscInt b = 0; b < scene->solids; b++) {
    PetscReal y[DIM], s;

    if (BodyBeyond(scene->solid[b], least, x)) continue;
    s = BodyNearest(scene->solid[b], x, y);
    if (s < least) {
      least = s;
      if (nearest) *nearest = b;
    }
  }
  return least;
}

PetscBool SceneSolidsMove(Scene scene)
{
  for (PetscInt b = 0; b < scene->solids; b++)
    if (BodyMoves(scene->solid[b])) return PETSC_TRUE;
  return PETSC_FALSE;
}

void SceneMoveSolids(Scene scene, PetscReal time)
{
  scene->solid_time = time;
  for (PetscInt b = 0; b < scene->solids; b++)
    if (scene->solid[b]->motion) SolidMotion.move(scene->solid[b], time);
}

PetscReal SceneSolidTime(Scene scene)
{
  return scene->solid_time;
}

void SceneSolidVelocity(Scene scene, PetscInt solid, const PetscReal x[DIM], PetscReal v[DIM])
{
  BodyMotion(scene->solid[solid], scene->solid_time, x, v);
}

PetscReal SceneSolidSpeed(Scene scene)
{
  PetscReal speed = 0, lower[DIM], upper[DIM];

  for (PetscInt b = 0; b < scene->solids; b++) {
    if (!BodyMoves(scene->solid[b])) continue;
    BodyBounds(scene->solid[b], lower, upper);
    speed = PetscMax(speed, SolidMotion.speed(scene->solid[b], lower, upper));
  }
  return speed;
}

/* The differences n of a distance (m) over 2 NORMAL_STEP, and how much it bends in each direction. Returns |n|. */
static PetscReal Differences(Scene scene, SceneDistance distance, PetscInt which, const PetscReal x[DIM],
                             PetscReal n[DIM], PetscReal bend[DIM])
{
  const PetscReal step = NORMAL_STEP * scene->domain->spacing, here = distance(scene, which, x);

  for (PetscInt d = 0; d < DIM; d++) {
    PetscReal low[DIM] = {x[0], x[1], x[2]}, high[DIM] = {x[0], x[1], x[2]}, below, above;

    low[d] -= step;
    high[d] += step;
    below   = d < scene->domain->dim ? distance(scene, which, low) : here;
    above   = d < scene->domain->dim ? distance(scene, which, high) : here;
    n[d]    = above - below;
    bend[d] = PetscAbsReal(above + below - 2 * here);
  }
  return Norm(n);
}

void DistanceNormal(Scene scene, SceneDistance distance, PetscInt which, const PetscReal x[DIM], PetscReal n[DIM])
{
  const PetscReal step = NORMAL_STEP * scene->domain->spacing;
  PetscReal       bend[DIM], length = Differences(scene, distance, which, x, n, bend);

  if (length < RIDGE * step && distance(scene, which, x) < 0) { /* in a thin solid: that of a point beside the middle */
    PetscReal beside[DIM] = {x[0], x[1], x[2]};
    PetscInt  across      = 0;

    for (PetscInt d = 1; d < DIM; d++)
      if (bend[d] > (1 + RIDGE) * bend[across]) across = d;
    beside[across] += 2 * step;
    length = Differences(scene, distance, which, beside, n, bend);
  }
  if (length < RIDGE * step) length = 0;
  for (PetscInt d = 0; d < DIM; d++) n[d] = length > 0 ? n[d] / length : 0;
}

PetscReal SceneOneDistance(Scene scene, PetscInt which, const PetscReal x[DIM])
{
  return BodyDistance(scene->solid[which], x);
}

static PetscReal SolidDistance(Scene scene, PetscInt which, const PetscReal x[DIM])
{
  return SceneSolidDistance(scene, x, NULL);
}

void SceneSolidNormal(Scene scene, const PetscReal x[DIM], PetscReal n[DIM])
{
  DistanceNormal(scene, SolidDistance, 0, x, n);
}

PetscBool SceneBodiesOverlap(Scene scene)
{
  return scene->overlap;
}

PetscReal SceneOwnDistance(Scene scene, PetscInt body, const PetscReal x[DIM])
{
  PetscReal s = BodyDistance(scene->body[body], x);

  for (PetscInt b = 0; b < body && scene->overlap; b++) s = PetscMax(s, -BodyDistance(scene->body[b], x));
  return s;
}

PetscBool SceneHasViscosity(Scene scene)
{
  for (PetscInt b = 0; b < scene->count; b++) {
    if (scene->body[b]->material.viscosity > 0) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

PetscBool SceneOneDensity(Scene scene)
{
  for (PetscInt b = 1; b < scene->count; b++)
    if (scene->body[b]->material.density != scene->body[0]->material.density) return PETSC_FALSE;
  return PETSC_TRUE;
}

PetscBool SceneHasTension(Scene scene)
{
  if (scene->interface_tension > 0) return PETSC_TRUE;
  for (PetscInt b = 0; b < scene->count; b++) {
    if (scene->body[b]->material.tension > 0) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}
