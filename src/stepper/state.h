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
  PetscReal solver_error;       /* rms density error that the pressure solver left in the step, 1 */
  PetscReal density_mean;       /* mean rho/rho_0 inside, 1 */
  PetscReal surface_energy;     /* sigma times the area of the free surface, J (J/m in two dimensions) */
  PetscReal viscous_work;       /* done by viscosity on the fluid so far, J: what it dissipates counts negative */
  PetscReal tension_work;       /* done by surface tension on the fluid so far, J */
  PetscReal start_energy;       /* kinetic + potential at the start of the run, J */
  PetscReal start_density;      /* density_mean then */
  PetscInt  rejected;           /* steps rolled back so far */
  PetscInt  lost;               /* particles that left through open faces so far */
  PetscReal previous_time_step; /* the step's history that a restart needs, s */
} StepState;

#endif
