/* Floor 6: -spectrum reports, by SLEPc: extreme eigenvalues and condition number of the pressure operator, plain and
   preconditioned, beside theory and the iterations of CG; the largest stable time steps of explicit viscosity and
   surface tension; the oscillation modes of a free drop. */
#ifndef ISPH_SPECTRUM_H
#define ISPH_SPECTRUM_H

#include "../operators/operators.h"
#include "../pressure/pressure.h"
#include "../tension/tension.h"

typedef struct _p_Spectrum *Spectrum;

/* The step in which the operators are analysed. */
typedef struct {
  PetscReal        dt;         /* s */
  PetscInt         iterations; /* of the step's pressure solver */
  const Viscosity *viscosity;
} SpectrumStep;

/* SpectrumCreate - borrows cloud, tension and pressure. Collective. */
PetscErrorCode SpectrumCreate(Cloud cloud, Tension tension, Pressure pressure, Spectrum *spectrum);
/* SpectrumSetFromOptions - reads -spectrum. The eigenvalue solvers read -spectrum_eps_* later.
   Collective. */
PetscErrorCode SpectrumSetFromOptions(Spectrum spectrum);
/* SpectrumWanted - whether -spectrum was given. Not collective. */
PetscBool SpectrumWanted(Spectrum spectrum);
/* SpectrumRun - prints the report on the state of the cloud, after stage one of a step (StepperPredict). It destroys
   the cloud's fields and leaves the swarm as it is. Collective. */
PetscErrorCode SpectrumRun(Spectrum spectrum, const SpectrumStep *step);
PetscErrorCode SpectrumDestroy(Spectrum *spectrum);

#endif
