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
  PetscInt         degrees; /* of the modes of a drop; 0: none */
  const Viscosity *viscosity;
  PetscReal       *place; /* [n_owned][3] positions of the state, m */
};

/* SpectrumExtreme - the eigenvalue of a matrix that 'which' names; deflated: NULL, or a vector whose direction is left
   out. *found: whether it converged to 'tolerance' (relative). Collective. */
PetscErrorCode SpectrumExtreme(Mat A, EPSProblemType type, EPSWhich which, PetscReal tolerance, Vec deflated,
                               PetscReal *value, PetscBool *found);
/* SpectrumPoisson - prints the report on the pressure operator; PressureSetUp must have been called. Collective. */
PetscErrorCode SpectrumPoisson(Spectrum spectrum, PetscInt iterations);
/* SpectrumLimits - prints the stability limits of the explicit terms against the time step dt (s). Collective. */
PetscErrorCode SpectrumLimits(Spectrum spectrum, PetscReal dt);
/* SpectrumModes - prints the modes of a drop, if the scene is one. Collective. */
PetscErrorCode SpectrumModes(Spectrum spectrum);
/* CapillaryResponse - acceleration (m/s2) by a displacement (m) of the fluid, both [n_fluid][3]: of the
   surface tension's change, with the pressure that answers it, at the operators of the undisplaced state. Collective.
 */
PetscErrorCode CapillaryResponse(Spectrum spectrum, const PetscReal displacement[], PetscReal acceleration[]);

#endif
