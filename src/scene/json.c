/* The bodies, solids and forces of scene.json (options/scene_json.md). Numbers have the names of their options. */
#include "scene_impl.h"

#define MOMENTS_MOST 64

/* A type and its numbers as an object. */
static void WriteChoice(Json *json, const char key[], Body body, const Choice *choice, const void *data)
{
  JsonObject(json, key);
  JsonText(json, "type", choice->name);
  JsonObject(json, "numbers");
  OptionsValues(json, choice->options, data, body->domain->dim);
  JsonEnd(json);
  JsonEnd(json);
}

/* What every shape has: name, shape, bounds, what features give it. */
static void WriteShape(Json *json, Body body)
{
  const PetscInt dim = body->domain->dim;
  PetscReal      lower[DIM], upper[DIM];

  BodyBounds(body, lower, upper);
  JsonText(json, "name", body->name);
  WriteChoice(json, "shape", body, &body->shape->choice, body->shape_data);
  JsonReals(json, "lower", dim, lower);
  JsonReals(json, "upper", dim, upper);
  PropertiesJson(body->domain, &body->own, json);
}

static void WriteShapes(Json *json, const char key[], PetscInt n, const Body body[])
{
  JsonArray(json, key);
  for (PetscInt k = 0; k < n; k++) {
    JsonObject(json, NULL);
    WriteShape(json, body[k]);
    JsonEnd(json);
  }
  JsonEnd(json);
}

static void WriteNumbers(Json *json, Scene scene, PetscInt b)
{
  BodyNumbers numbers;

  SceneNumbers(scene, b, &numbers);
  JsonReal(json, "spacings", numbers.length / scene->domain->spacing);
  JsonArray(json, "dimensionless");
  for (PetscInt k = 0; k < SCENE_NUMBERS; k++) {
    if (PetscIsNanReal(numbers.number[k].value)) continue;
    JsonObject(json, NULL);
    JsonText(json, "name", numbers.number[k].name);
    JsonReal(json, "value", numbers.number[k].value);
    JsonReal(json, "length", numbers.length);
    JsonReal(json, "speed", numbers.speed);
    JsonEnd(json);
  }
  JsonEnd(json);
}

static void WriteBody(Json *json, Scene scene, PetscInt b)
{
  const Body       body = scene->body[b];
  const OptionRow *rows;
  const void      *data;

  JsonObject(json, NULL);
  WriteShape(json, body);
  WriteShapes(json, "holes", body->holes, body->hole);
  rows = BodyMatter(body, 0, &data);
  OptionsValues(json, rows, data, body->domain->dim);
  WriteChoice(json, "viscosity_model", body, &body->viscosity->choice, body->viscosity_data);
  JsonInt(json, "liquid", scene->liquid[b]);
  JsonReals(json, "velocity", scene->domain->dim, body->uniform);
  WriteChoice(json, "velocity_field", body, &body->velocity->choice, body->velocity_data);
  for (const Choice *const *type = BodyTypes; *type; type++) {
    if (!(*type)->options) continue;
    JsonObject(json, (*type)->name);
    if (*type == &body->kind->choice) OptionsValues(json, (*type)->options, body->type_data, body->domain->dim);
    JsonEnd(json);
  }
  WriteNumbers(json, scene, b);
  JsonEnd(json);
}

static void WriteSolid(Json *json, Body body, PetscReal start, PetscReal end)
{
  PetscReal      moment[MOMENTS_MOST];
  const PetscInt moments = BodyMoments(body, start, end, MOMENTS_MOST, moment);

  JsonObject(json, NULL);
  WriteShape(json, body);
  WriteShapes(json, "holes", body->holes, body->hole);
  SolidMotion.json(body, json);
  JsonObject(json, "motion");
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(SolidMotion.rows); k++)
    if (MotionData(body, k)) OptionsValues(json, SolidMotion.rows[k], MotionData(body, k), body->domain->dim);
  JsonEnd(json);
  JsonReals(json, "moments", moments, moment);
  JsonEnd(json);
}

void SceneJson(Scene scene, PetscReal start, PetscReal end, Json *json)
{
  PropertiesJson(scene->domain, &scene->own, json);
  ForcesJson(scene, json);
  JsonArray(json, "bodies");
  for (PetscInt b = 0; b < scene->count; b++) WriteBody(json, scene, b);
  JsonEnd(json);
  JsonArray(json, "solids");
  for (PetscInt b = 0; b < scene->solids; b++) WriteSolid(json, scene->solid[b], start, end);
  JsonEnd(json);
  WriteShapes(json, "regions", scene->fine_regions, scene->fine);
}
