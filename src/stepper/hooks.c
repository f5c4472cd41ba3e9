/* The edges that add to a step, and what they add to its state and its report. */
#include "stepper_impl.h"
#include <string.h>

extern const Edge InterfaceEdge, MovingEdge, ContactEdge, FreeEdge, EmitterEdge, ResamplingEdge, GasEdge, OutletEdge;
const Edge *const StepEdges[] = {&InterfaceEdge,  &MovingEdge, &ContactEdge, &FreeEdge, &EmitterEdge,
                                 &ResamplingEdge, &GasEdge,    &OutletEdge,  NULL};

PetscErrorCode StepperProperties(Domain domain)
{
  PetscFunctionBegin;
  for (const Edge *const *edge = StepEdges; *edge; edge++)
    for (const Property *property = (*edge)->properties; property && property->rows; property++)
      PetscCall(DomainAddProperty(domain, property));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool StateNumber(const StepState *state, PetscInt k, Number *number)
{
  if (NumbersWalk(StateRows, state, &k, number)) return PETSC_TRUE;
  for (const Edge *const *edge = StepEdges; *edge; edge++)
    if (NumbersWalk((*edge)->numbers, StepEdgeNumbers(StepEdges, state, (*edge)->name), &k, number)) return PETSC_TRUE;
  return PETSC_FALSE;
}

const NumberTable *StepperTable(const StepState *state, PetscInt k, void **numbers)
{
  for (const Edge *const *edge = StepEdges; *edge; edge++) {
    if (!(*edge)->table.name || k-- > 0) continue;
    *numbers = StepEdgeNumbers(StepEdges, state, (*edge)->name);
    return &(*edge)->table;
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
  for (const Edge *const *edge = StepEdges; *edge; edge++) {
    const size_t used = strlen(text);

    if ((*edge)->report)
      PetscCall((*edge)->report(scene, StepEdgeNumbers(StepEdges, state, (*edge)->name), copies, joule, text + used,
                                length - used));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperBring(Stepper stepper, Packing packing, Gauges gauges, PetscBool resumed, StepState *state)
{
  PetscFunctionBegin;
  StepHook(stepper, bring, stepper, packing, gauges, resumed, state);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal StepperFilling(Stepper stepper, PetscInt body, PetscInt *particles)
{
  for (const Edge *const *edge = StepEdges; *edge; edge++)
    if ((*edge)->filling) return (*edge)->filling(stepper, body, particles);
  return 0;
}
