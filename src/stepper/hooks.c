/* The edges that add to a step, and what they add to its state and its report. */
#include "stepper_impl.h"
#include <string.h>

extern const Edge InterfaceEdge, MovingEdge, ContactEdge, FreeEdge, HeatEdge, DependEdge, ElasticEdge, EmitterEdge,
  ResamplingEdge, GasEdge, OpeningEdge, OutletEdge;
const Edge *const StepEdges[] = {&InterfaceEdge, &MovingEdge,  &ContactEdge, &FreeEdge,       &HeatEdge,
                                 &DependEdge,    &ElasticEdge, &EmitterEdge, &ResamplingEdge, &GasEdge,
                                 &OpeningEdge,   &OutletEdge,  NULL};

PetscErrorCode StepperProperties(Domain domain)
{
  PetscFunctionBegin;
  for (const Edge *const *edge = StepEdges; *edge; edge++)
    for (const Property *property = (*edge)->properties; property && property->rows; property++)
      PetscCall(DomainAddProperty(domain, property));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A ParticlesStarter: new liquid gets the fields of the edges. */
static void StartFields(void *context, PetscInt first, ParticleArrays *arrays)
{
  for (const Edge *const *edge = StepEdges; *edge; edge++)
    for (const EdgeField *row = (*edge)->fields; row && row->needed; row++)
      for (PetscInt a = first; row->start && arrays->real[row->field] && a < arrays->n; a++)
        if (arrays->integer[INT_LAYER][a] == 0)
          row->start((Scene)context, arrays->integer[INT_BODY][a], arrays->real[FIELD_POSITION] + DIM * a,
                     arrays->real[row->field] + Fields[row->field].width * a);
}

PetscErrorCode StepperParticles(Scene scene, Tension tension, Particles *particles)
{
  FieldMask more = SceneViscosityVaries(scene) ? FIELD_BIT(FIELD_VISCOSITY) : 0;

  PetscFunctionBegin;
  for (const Edge *const *edge = StepEdges; *edge; edge++)
    for (const EdgeField *row = (*edge)->fields; row && row->needed; row++)
      if (row->needed(scene, tension)) more |= FIELD_BIT(row->field);
  PetscCall(ParticlesCreate(SceneDomain(scene), more, particles));
  ParticlesSetStart(*particles, StartFields, scene);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool StateNumber(const StepState *state, PetscInt k, Number *number)
{
  if (NumbersWalk(StateRows, state, &k, number)) return PETSC_TRUE;
  for (Step step = {.edge = StepEdges}; *step.edge; StepNext(&step))
    if (NumbersWalk((*step.edge)->numbers, StepNumbers(&step, state), &k, number)) return PETSC_TRUE;
  return PETSC_FALSE;
}

const NumberTable *StepperTable(const StepState *state, PetscInt k, void **numbers)
{
  for (Step step = {.edge = StepEdges}; *step.edge; StepNext(&step)) {
    const Edge *edge = *step.edge;

    if (!edge->table.name || k-- > 0) continue;
    *numbers = StepNumbers(&step, state);
    return &edge->table;
  }
  return NULL;
}

PetscReal StepperEnergy(const StepState *state, EnergyPart part)
{
  Number    number;
  PetscReal sum = 0;

  for (PetscInt k = 0; StateNumber(state, k, &number); k++)
    if (number.row->part == part) sum += *(PetscReal *)number.at;
  return sum;
}

PetscReal StepperOutsideWork(const StepState *state)
{
  return StepperEnergy(state, ENERGY_GIVEN) + StepperEnergy(state, ENERGY_BROUGHT) - StepperEnergy(state, ENERGY_TAKEN);
}

PetscErrorCode StepperReport(Scene scene, const StepState *state, PetscReal copies, const char joule[], char text[],
                             size_t length)
{
  PetscFunctionBegin;
  text[0] = 0;
  for (Step step = {.edge = StepEdges}; *step.edge; StepNext(&step)) {
    const size_t used = strlen(text);

    if ((*step.edge)->report)
      PetscCall((*step.edge)->report(scene, StepNumbers(&step, state), copies, joule, text + used, length - used));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Between steps the swarm has the state, and the next commit would write over it what the cloud still has: what an edge
   has changed in its fields goes into the cloud. */
static PetscErrorCode LoadFields(Stepper stepper)
{
  const Cloud    cloud = stepper->cloud;
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(cloud->particles, &arrays));
  for (const Edge *const *edge = StepEdges; *edge && arrays.n == cloud->n_owned; edge++)
    for (const EdgeField *row = (*edge)->fields; row && row->needed; row++)
      if (arrays.real[row->field])
        PetscCall(
          PetscArraycpy(cloud->field[row->field], arrays.real[row->field], arrays.n * Fields[row->field].width));
  PetscCall(ParticlesClose(cloud->particles, &arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperBring(Stepper stepper, Packing packing, Gauges gauges, PetscBool resumed, StepState *state)
{
  PetscFunctionBegin;
  StepHook(stepper, bring, &step, packing, gauges, resumed, state);
  PetscCall(LoadFields(stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperLoad(Stepper stepper, PetscReal force[])
{
  PetscFunctionBegin;
  for (Step step = StepFirst(stepper); *step.edge; StepNext(&step)) /* hooks call it, too */
    if ((*step.edge)->load && StepHas(&step)) PetscCall((*step.edge)->load(&step, force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal StepperFilling(Stepper stepper, PetscInt body, PetscInt *particles)
{
  for (Step step = StepFirst(stepper); *step.edge; StepNext(&step))
    if ((*step.edge)->filling) return (*step.edge)->filling(&step, body, particles);
  return 0;
}
