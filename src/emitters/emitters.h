/* Floor 7: emitters, an edge of the step: bodies that bring liquid during the run. */
#ifndef ISPH_EMITTERS_H
#define ISPH_EMITTERS_H

#include "../stepper/edge.h"

/* EmittersEnergy - kinetic + potential energy (J) of what emitters brought so far, a number of the state. Not
   collective. */
PetscReal *EmittersEnergy(Stepper stepper, const StepState *state);

#endif
