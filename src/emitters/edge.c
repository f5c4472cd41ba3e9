/* Emitters in a step: implicit viscosity holds the liquid inside them at their velocity, like a wall. In a long step
   viscosity brings neighbours nearly to one velocity: the liquid that has left would drag free liquid inside the
   emitter along, and tear. A row is held until its particles have left as a whole, when the next emission comes. If it
   were free as soon as their centres have left, a sheet of honey would fall freely in between: 6 % of the time with
   emissions of 8 rows. */
#include "emitters.h"

static const NumberRow rows[] = {
  {"inflow_energy", NUMBER_REAL, 0, ENERGY_BROUGHT, "emitters"},
  {.name = NULL},
};

static PetscErrorCode Destroy(Stepper stepper)
{
  PetscFunctionBegin;
  PetscCall(EmissionsDestroy(EmittersOf(stepper)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool On(Stepper stepper)
{
  return SceneComesLater(StepperCloud(stepper)->scene);
}

static PetscErrorCode Hold(Stepper stepper, PetscReal dt)
{
  Cloud cloud = StepperCloud(stepper);

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const Body       body = SceneBody(cloud->scene, cloud->integer[INT_BODY][a]);
    const PetscReal *x    = cloud->field[FIELD_POSITION] + DIM * a;
    PetscReal        v[DIM], radius = 0.5 * cloud->size[a] * cloud->domain->spacing;

    if (!BodyComesLater(body)) continue;
    BodyEmissionVelocity(body, StepperTime(stepper), x, v);
    if (BodyHolds(body, x, radius + dt * Norm(v))) PetscCall(ViscousHold(stepper, a, v));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define EMITTERS "-<body>_type emitter"

static PetscBool Emits(Scene scene, Tension tension)
{
  return (PetscBool)(scene && SceneComesLater(scene));
}

static const Feature features[] = {{EMITTERS, Emits}, {.name = NULL}};
static const Refusal refusals[] = {{FEATURE_POISSON, NOT_WITH, EMITTERS, "; use -packing_type lattice"}, {.one = NULL}};

const Edge EmitterEdge = {.name        = EMITTERS_EDGE,
                          .features    = features,
                          .refusals    = refusals,
                          .data_size   = sizeof(Emissions),
                          .number_size = sizeof(PetscReal),
                          .numbers     = rows,
                          .destroy     = Destroy,
                          .on          = On,
                          .drives      = On,
                          .hold        = Hold};
