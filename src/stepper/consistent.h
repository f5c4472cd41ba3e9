/* Private to stepper/: the step that the consistent and the weakly compressible scheme share. */
#ifndef ISPH_CONSISTENT_H
#define ISPH_CONSISTENT_H

#include "shifting.h"
#include "stepper_impl.h"

/* Data of the consistent scheme, and the beginning of the weakly compressible scheme's data. */
typedef struct {
  PetscBool centered;          /* forces act in the middle of the step */
  PetscReal divergence_offset; /* steps after the forces act at which the new velocity has no divergence, 1 */
  Shifting  shifting;
  /* Sets FIELD_PRESSURE of owned particles and ghosts, by the projection or an equation of state. Collective. */
  PetscErrorCode (*project)(Stepper stepper, PetscReal dt, PressureResult *result);
} Consistent;

/* ConsistentDefaults - sets the types and defaults of both schemes, after the scheme has made its data. Not
   collective. */
PetscErrorCode ConsistentDefaults(Stepper stepper);
/* Entries of SchemeOps that both schemes use. */
PetscErrorCode ConsistentSetFromOptions(Stepper stepper, OptionItems PetscOptionsObject);
PetscErrorCode ConsistentView(Stepper stepper, PetscViewer viewer);
PetscErrorCode ConsistentStep(Stepper stepper, PetscReal dt, StepTrial *trial);
PetscErrorCode SchemeDestroyData(Stepper stepper);

#endif
