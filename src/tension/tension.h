/* Floor 5: surface tension as a registered type.

   cahn_hilliard: Eqs. (5)-(7) of Kuri et al. with a longer kernel W^H. The divergence of S uses the same kernel as grad
   phi: the paper's mixture (W^h outside) makes a resting drop roughen, because only with one kernel does S_a . grad
   phi_a = 0 remove the particle's own term. For the same reason the symmetric pair form and the one-sided sum_b V_b S_b
   grad W^H are identical; the one-sided form is evaluated. */
#ifndef ISPH_TENSION_H
#define ISPH_TENSION_H

#include "../neighbors/cloud.h"

typedef struct _p_Tension *Tension;

#define TENSION_CAHN_HILLIARD "cahn_hilliard"
#define TENSION_CURVATURE     "curvature"
#define TENSION_NONE          "none"

/* TensionCreate - for the bodies of a scene; nothing is borrowed beyond the calls. Collective. */
PetscErrorCode TensionCreate(Domain domain, Scene scene, Kernel kernel, Tension *tension);
/* TensionSetFromOptions - -tension_type, -tension_ratio (H/h), -tension_calibration (kappa/(sigma H)), -tension_band.
 * Collective. */
PetscErrorCode TensionSetFromOptions(Tension tension);
/* TensionReach - how far (m) the model looks for neighbours; 0 if there is no tension in the scene. Not collective. */
PetscReal TensionReach(Tension tension);
/* TensionApply - adds the acceleration (m/s2) of the fluid to FIELD_ACCELERATION, from positions and INT_SURFACE;
   updates the ghosts of the fields in between. Nothing is evaluated further than band * 2H + d0 from a surface
   particle. Collective. */
PetscErrorCode TensionApply(Tension tension, Cloud cloud);
PetscErrorCode TensionView(Tension tension, PetscViewer viewer);
PetscErrorCode TensionDestroy(Tension *tension);

#endif
