/* The numbers of a run's state that a restart needs, as rows; the data and numbers of the edges of a step. */
#include "stepper_impl.h"
#include <string.h>

#define NUMBER(field, kind)                                                                                            \
  {                                                                                                                    \
    #field, kind, offsetof(StepState, field), ENERGY_NONE, NULL                                                        \
  }
#define ENERGY(field, part, of)                                                                                        \
  {                                                                                                                    \
    #field, NUMBER_REAL, offsetof(StepState, field), part, of                                                          \
  }

const NumberRow StateRows[] = {
  NUMBER(time, NUMBER_REAL),
  NUMBER(time_step, NUMBER_SPAN),
  NUMBER(pressure_time, NUMBER_REAL),
  NUMBER(previous_time_step, NUMBER_SPAN),
  NUMBER(step, NUMBER_COUNT),
  NUMBER(iterations, NUMBER_COUNT),
  NUMBER(rejected, NUMBER_COUNT),
  NUMBER(lost, NUMBER_COUNT),
  NUMBER(said, NUMBER_COUNT),
  NUMBER(density_error, NUMBER_REAL),
  NUMBER(density_mean, NUMBER_REAL),
  NUMBER(start_density, NUMBER_REAL),
  NUMBER(divergence, NUMBER_MAYBE),
  NUMBER(solver_error, NUMBER_REAL),
  NUMBER(start_energy, NUMBER_REAL),
  NUMBER(potential_energy, NUMBER_REAL),
  NUMBER(start_surface, NUMBER_REAL),
  NUMBER(kinetic_energy, NUMBER_REAL),
  NUMBER(kinetic_most, NUMBER_SPAN),
  NUMBER(surface_energy, NUMBER_REAL),
  NUMBER(viscous_work, NUMBER_REAL),
  NUMBER(tension_work, NUMBER_REAL),
  NUMBER(tension_swing, NUMBER_REAL),
  NUMBER(given, NUMBER_REAL),
  NUMBER(taken, NUMBER_REAL),
  ENERGY(friction_work, ENERGY_FRICTION, "the friction of walls that move"),
  ENERGY(solid_work, ENERGY_GIVEN, "the pressure of solids that move"),
  ENERGY(drive_work, ENERGY_GIVEN, "gravity along periodic directions and shaking"),
  ENERGY(outflow_energy, ENERGY_TAKEN, "what left through open faces"),
  ENERGY(given_energy, ENERGY_BROUGHT, "a changed scene or program"),
  {.name = NULL},
};

PetscBool NumbersWalk(const NumberRow rows[], const void *of, PetscInt *k, Number *number)
{
  for (; rows && rows->name; rows++, (*k)--) {
    if (*k > 0) continue;
    *number = (Number){.row = rows, .at = (char *)of + rows->offset};
    return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* The bytes that a struct of an edge takes up among those of other edges. */
static size_t Room(size_t size)
{
  return (size + sizeof(PetscReal) - 1) / sizeof(PetscReal) * sizeof(PetscReal);
}

Step StepFirst(Stepper stepper)
{
  Step step = stepper->now;

  step.edge = stepper->edges;
  step.own  = stepper->edge_data;
  step.sums = stepper->edge_sums;
  return step;
}

void StepNext(Step *step)
{
  const Edge *edge = *step->edge++;

  if (step->own) step->own = (char *)step->own + Room(edge->data_size);
  if (step->sums) step->sums += edge->sums;
  step->numbers += Room(edge->number_size);
}

void *StepNumbers(const Step *step, const StepState *state)
{
  return (char *)state->edge + step->numbers;
}

void *StepperOwn(Stepper stepper, const struct GaugeKind *gauge)
{
  Step step;

  if (!stepper) return NULL;
  for (step = StepFirst(stepper); (*step.edge)->gauge != gauge;) StepNext(&step);
  return step.own;
}

PetscErrorCode StepEdgesCreate(Stepper stepper)
{
  size_t   data = 0, numbers = 0;
  PetscInt sums = 0;

  PetscFunctionBegin;
  for (const Edge *const *edge = stepper->edges; *edge; edge++) {
    data += Room((*edge)->data_size);
    numbers += Room((*edge)->number_size);
    sums += (*edge)->sums;
  }
  PetscCheck(numbers <= sizeof(((StepState *)NULL)->edge), stepper->cloud->comm, PETSC_ERR_PLIB,
             "The edges of a step have more numbers than StepState has room for");
  PetscCall(PetscCalloc1(data, (char **)&stepper->edge_data));
  PetscCall(PetscCalloc1(sums, &stepper->edge_sums));
  stepper->edge_sum_count = sums;
  for (Step step = StepFirst(stepper); *step.edge; StepNext(&step))
    if ((*step.edge)->create) PetscCall((*step.edge)->create(&step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepEdgesDestroy(Stepper stepper)
{
  PetscFunctionBegin;
  for (Step step = StepFirst(stepper); *step.edge; StepNext(&step))
    if ((*step.edge)->destroy) PetscCall((*step.edge)->destroy(&step));
  PetscCall(PetscFree(stepper->edge_data));
  PetscCall(PetscFree(stepper->edge_sums));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool StepHas(const Step *step)
{
  return (PetscBool)(!(*step->edge)->on || (*step->edge)->on(step));
}

PetscErrorCode StepInOrder(Stepper stepper, size_t hook)
{
  PetscFunctionBegin;
  if (!stepper->trying || hook == offsetof(Edge, diagnose) || hook == offsetof(Edge, drift))
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(hook >= stepper->reached || hook == offsetof(Edge, restore), stepper->cloud->comm, PETSC_ERR_PLIB,
             "A hook of a step is called in another order than that of its record, edge.h");
  stepper->reached = hook;
  PetscFunctionReturn(PETSC_SUCCESS);
}
