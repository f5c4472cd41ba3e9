/* Floor 6: what SLEPc knows of the operators, -spectrum: extreme eigenvalues and condition number of the pressure
   operator, plain and preconditioned, beside what theory and the iterations say; the time steps at which the explicit
   viscosity and surface tension become unstable; the oscillation modes of a free drop. */
#ifndef ISPH_SPECTRUM_H
#define ISPH_SPECTRUM_H

#include "../operators/operators.h"
#include "../pressure/pressure.h"
#include "../tension/tension.h"

typedef struct _p_Spectrum *Spectrum;

/* The step that the operators are of. */
typedef struct {
  PetscReal        dt;         /* s */
  PetscInt         iterations; /* of its pressure solver */
  const Viscosity *viscosity;
} SpectrumStep;

/* SpectrumCreate - borrows all three. Collective. */
PetscErrorCode SpectrumCreate(Cloud cloud, Tension tension, Pressure pressure, Spectrum *spectrum);
/* SpectrumSetFromOptions - -spectrum, -spectrum_modes; the eigenvalue solvers read -spectrum_eps_* when they are used.
   Collective. */
PetscErrorCode SpectrumSetFromOptions(Spectrum spectrum);
/* SpectrumWanted - whether -spectrum was given. Not collective. */
PetscBool SpectrumWanted(Spectrum spectrum);
/* SpectrumRun - prints the report on the state of the cloud, after stage one of a step (StepperPredict). The cloud's
   fields are not worth anything afterwards; the swarm is untouched. Collective. */
PetscErrorCode SpectrumRun(Spectrum spectrum, const SpectrumStep *step);
PetscErrorCode SpectrumDestroy(Spectrum *spectrum);

#endif
