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
  NUMBER(previous_time_step, NUMBER_SPAN),
  NUMBER(step, NUMBER_COUNT),
  NUMBER(iterations, NUMBER_COUNT),
  NUMBER(rejected, NUMBER_COUNT),
  NUMBER(lost, NUMBER_COUNT),
  NUMBER(density_error, NUMBER_REAL),
  NUMBER(density_mean, NUMBER_REAL),
  NUMBER(start_density, NUMBER_REAL),
  NUMBER(divergence, NUMBER_MAYBE),
  NUMBER(solver_error, NUMBER_REAL),
  NUMBER(start_energy, NUMBER_REAL),
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
  ENERGY(given_energy, ENERGY_BROUGHT, "the program that changed the liquid"),
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
  for (const Edge *const *edge = stepper->edges; *edge; edge++)
    if ((*edge)->create) PetscCall((*edge)->create(stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepEdgesDestroy(Stepper stepper)
{
  PetscFunctionBegin;
  for (const Edge *const *edge = stepper->edges; *edge; edge++)
    if ((*edge)->destroy) PetscCall((*edge)->destroy(stepper));
  PetscCall(PetscFree(stepper->edge_data));
  PetscCall(PetscFree(stepper->edge_sums));
  PetscFunctionReturn(PETSC_SUCCESS);
}

Cloud StepperCloud(Stepper stepper)
{
  return stepper->cloud;
}

Tension StepperTension(Stepper stepper)
{
  return stepper->tension;
}

Pressure StepperPressure(Stepper stepper)
{
  return stepper->pressure;
}

PetscReal StepperTime(Stepper stepper)
{
  return stepper->time;
}

void *StepEdgeData(Stepper stepper, const char name[])
{
  char *at = (char *)stepper->edge_data;

  for (const Edge *const *edge = stepper->edges; strcmp((*edge)->name, name); edge++) at += Room((*edge)->data_size);
  return at;
}

PetscReal *StepEdgeSums(Stepper stepper, const char name[])
{
  PetscReal *at = stepper->edge_sums;

  for (const Edge *const *edge = stepper->edges; strcmp((*edge)->name, name); edge++) at += (*edge)->sums;
  return at;
}

void *StepEdgeNumbers(const Edge *const edges[], const StepState *state, const char name[])
{
  char *at = (char *)state->edge;

  for (; strcmp((*edges)->name, name); edges++) at += Room((*edges)->number_size);
  return at;
}

PetscReal StepperDamping(Stepper stepper)
{
  return stepper->damping;
}

void *StepperNumbers(Stepper stepper, const StepState *state, const char name[])
{
  return StepEdgeNumbers(stepper->edges, state, name);
}
