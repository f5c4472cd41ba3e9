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

/* The options of both schemes. */
#define CONSISTENT_ROWS                                                                                                \
  {"-shifting", "Shift particles towards an even distribution", NULL, NULL,                                            \
   ROW_BOOL,    offsetof(Consistent, shifting.active)},                                                                \
    {"-shifting_conserved",                                                                                            \
     "Shifting conserves momentum and angular momentum, but loses more energy",                                        \
     NULL,                                                                                                             \
     NULL,                                                                                                             \
     ROW_BOOL,                                                                                                         \
     offsetof(Consistent, shifting.conserved)},                                                                        \
  {                                                                                                                    \
    "-time_centered", "Evaluate forces at the middle of the step: drift, kick, drift", NULL, NULL, ROW_BOOL,           \
      offsetof(Consistent, centered)                                                                                   \
  }

/* ConsistentDefaults - sets the types and defaults of both schemes, after the scheme has made its data. Not
   collective. */
PetscErrorCode ConsistentDefaults(Stepper stepper);
/* Entries of SchemeOps that both schemes use. */
PetscErrorCode ConsistentSetUp(void *stepper);
PetscErrorCode ConsistentView(Stepper stepper, PetscViewer viewer);
PetscErrorCode ConsistentStep(Stepper stepper, PetscReal dt, StepTrial *trial);

#endif
