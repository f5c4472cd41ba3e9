/* Private to stepper/: the step that the consistent and the weakly compressible scheme share. */
#ifndef ISPH_CONSISTENT_H
#define ISPH_CONSISTENT_H

#include "shifting.h"
#include "stepper_impl.h"

/* Data of the consistent scheme; that of the weakly compressible one begins with it. */
typedef struct {
  PetscBool centered;          /* forces act in the middle of the step */
  PetscReal divergence_offset; /* the new velocity has no divergence so many steps after the forces act */
  Shifting  shifting;
  /* FIELD_PRESSURE of owned particles and ghosts: by the projection or an equation of state. Collective. */
  PetscErrorCode (*project)(Stepper stepper, PetscReal dt, PressureResult *result);
} Consistent;

/* ConsistentDefaults - types and options of both schemes; the scheme's data must be there. Not collective. */
PetscErrorCode ConsistentDefaults(Stepper stepper);
/* Entries of SchemeOps that both schemes use. */
PetscErrorCode ConsistentSetFromOptions(Stepper stepper, OptionItems PetscOptionsObject);
PetscErrorCode ConsistentView(Stepper stepper, PetscViewer viewer);
PetscErrorCode ConsistentStep(Stepper stepper, PetscReal dt, StepTrial *trial);
PetscErrorCode SchemeDestroyData(Stepper stepper);

#endif
