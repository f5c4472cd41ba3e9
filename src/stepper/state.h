/* What a stepper knows of the run, and what a restart needs besides the particles. */
#ifndef ISPH_STATE_H
#define ISPH_STATE_H

#include "../base/base.h"

/* Global values, the same on every rank; SI units. */
typedef struct {
  PetscReal time, time_step;
  PetscInt  step, iterations;
  PetscReal density_error;      /* rms of (rho - rho_0)/rho_0 over particles inside the liquid, 1 */
  PetscReal divergence;         /* rms of the velocity divergence inside times the time step, 1; nan: not measured */
  PetscInt  rejected;           /* steps rolled back so far */
  PetscInt  lost;               /* particles that left through open faces so far */
  PetscReal previous_time_step; /* the step's history that a restart needs, s */
} StepState;

#endif
