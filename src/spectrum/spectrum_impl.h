/* Private to spectrum/. */
#ifndef ISPH_SPECTRUM_TYPES_H
#define ISPH_SPECTRUM_TYPES_H

#include "spectrum.h"
#include <slepceps.h>

struct _p_Spectrum {
  Cloud            cloud;    /* borrowed */
  Tension          tension;  /* borrowed */
  Pressure         pressure; /* borrowed */
  PetscBool        wanted;
  const Viscosity *viscosity;
  PetscReal       *position; /* [n_owned][3] positions of the state, m */
};

/* SpectrumExtreme - the eigenvalue of A that 'which' selects, to a relative tolerance. deflated: direction without
   eigenvectors, or NULL. *found: whether the eigenvalue converged; if not, *value is NAN. Collective. */
PetscErrorCode SpectrumExtreme(Mat A, EPSProblemType type, EPSWhich which, PetscReal tolerance, Vec deflated,
                               PetscReal *value, PetscBool *found);
/* SpectrumPoisson - prints the report on the pressure operator; PressureSetUp must have been called. Collective. */
PetscErrorCode SpectrumPoisson(Spectrum spectrum, PetscInt iterations);
/* SpectrumLimits - prints the stability limits of the explicit terms against the time step dt (s). Collective. */
PetscErrorCode SpectrumLimits(Spectrum spectrum, PetscReal dt);
/* SpectrumModes - prints the modes of the drop, if the scene is a free drop. Collective. */
PetscErrorCode SpectrumModes(Spectrum spectrum);
/* CapillaryResponse - acceleration (m/s2) per displacement (m) of the fluid, both [n_fluid][3]: from the change of
   surface tension and of the pressure with it. Operators are those of the undisplaced state. Collective. */
PetscErrorCode CapillaryResponse(Spectrum spectrum, const PetscReal displacement[], PetscReal acceleration[]);

#endif
