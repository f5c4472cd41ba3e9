/* Heat in a step: liquid has the temperature of its body, and conducts. */
#include "heat_impl.h"

#define STABLE 0.1 /* h^2 over the diffusivity, the longest step; see spread.c */

static PetscBool On(const Step *step)
{
  return HeatOn(step->scene, NULL);
}

static void Start(Scene scene, PetscInt body, const PetscReal x[DIM], PetscReal value[])
{
  value[0] = HeatOf(scene, body)->temperature;
}

static const EdgeField fields[] = {{FIELD_TEMPERATURE, HeatOn, Start}, {.needed = NULL}};

static void Bound(const Step *step, PetscReal scale, StepBound *bound)
{
  const Cloud     cloud = step->cloud;
  const PetscReal h     = scale * KernelSmoothingLength(cloud->kernel);

  bound->name  = "heat";
  bound->cause = "conduction of heat";
  bound->lift  = "a larger -spacing";
  for (PetscInt b = 0; b < SceneCount(cloud->scene); b++) {
    const BodyHeat *heat  = HeatOf(cloud->scene, b);
    const PetscReal alpha = heat->conductivity / (BodyMaterial(SceneBody(cloud->scene, b))->density * heat->capacity);

    if (alpha > 0) bound->step = PetscMin(bound->step, STABLE * h * h / alpha);
  }
}

static PetscErrorCode Kick(const Step *step)
{
  PetscFunctionBegin;
  if (step->damping == 1) PetscCall(HeatSpread(step->cloud, step->dt));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define TEMPERATURE "-<body>_temperature"

static const Feature features[] = {{TEMPERATURE, HeatOn}, {.name = NULL}};
static const Refusal refusals[] = {{TEMPERATURE, NEEDS, FEATURE_CONSISTENT, ", the default"}, {.one = NULL}};

const Edge HeatEdge = {.name       = "heat",
                       .properties = HeatProperties,
                       .fields     = fields,
                       .features   = features,
                       .refusals   = refusals,
                       .gauge      = &GaugeTemperature,
                       .on         = On,
                       .bound      = Bound,
                       .kick       = Kick};
