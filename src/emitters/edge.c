/* Emitters in a step: implicit viscosity holds the liquid inside them at their velocity, like a wall. In a long step
   viscosity brings neighbours nearly to one velocity: the liquid that has left would drag free liquid inside the
   emitter along, and tear. A row is held until its particles have left as a whole, when the next emission comes. If it
   were free as soon as their centres have left, a sheet of honey would fall freely in between: 6 % of the time with
   emissions of 8 rows. */
#include "emitters_impl.h"

#define NAME "emitters"

static const NumberRow rows[] = {
  {"inflow_energy", NUMBER_REAL, 0, ENERGY_BROUGHT, "emitters"},
  {.name = NULL},
};

static Emissions *Of(Stepper stepper)
{
  return (Emissions *)StepEdgeData(stepper, NAME);
}

static PetscErrorCode Destroy(Stepper stepper)
{
  PetscFunctionBegin;
  PetscCall(EmissionsDestroy(Of(stepper)));
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
    BodyFillingVelocity(body, StepperTime(stepper), x, v);
    if (BodyHolds(body, x, radius + dt * Norm(v))) PetscCall(ViscousHold(stepper, a, v));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Brings energy, too: the work that keeps liquid inside emitters moving is a part of it. */
static PetscErrorCode Bring(Stepper stepper, Packing packing, Gauges gauges, PetscBool resumed, StepState *state)
{
  GaugeTotals before, after;
  PetscInt    emitted;

  PetscFunctionBegin;
  if (gauges) PetscCall(GaugesTotals(gauges, &before));
  PetscCall(EmissionsAdd(Of(stepper), StepperCloud(stepper), packing, state->time, resumed, &emitted));
  if (!gauges) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GaugesTotals(gauges, &after));
  *(PetscReal *)StepperNumbers(stepper, state, NAME) +=
    after.kinetic_energy + after.potential_energy - before.kinetic_energy - before.potential_energy;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal Filling(Stepper stepper, PetscInt body, PetscInt *particles)
{
  const Emission *emission = &Of(stepper)->of[body];

  if (particles) *particles = emission->n;
  return EmissionVolume(emission, StepperCloud(stepper)->domain);
}

#define EMITTERS "-<body>_type emitter"

static PetscBool Emits(Scene scene, Tension tension)
{
  return (PetscBool)(scene && SceneComesLater(scene));
}

static const Feature features[] = {{EMITTERS, Emits}, {.name = NULL}};
static const Refusal refusals[] = {{FEATURE_POISSON, NOT_WITH, EMITTERS, "; use -packing_type lattice"}, {.one = NULL}};

const Edge EmitterEdge = {.name        = NAME,
                          .features    = features,
                          .refusals    = refusals,
                          .data_size   = sizeof(Emissions),
                          .number_size = sizeof(PetscReal),
                          .numbers     = rows,
                          .destroy     = Destroy,
                          .on          = On,
                          .drives      = On,
                          .hold        = Hold,
                          .bring       = Bring,
                          .filling     = Filling};
