/* Floor 5: surface tension as a registered type.

   curvature (default): the pressure solver puts sigma times the curvature on the free surface; see curvature.c for how
   the curvature is found, sheet.c what sheets of one or two particles have instead. A drop's pressure is 2 sigma/R to
   0.1 % at R/d0 = 8 (sigma/R to 0.5 % in 2-d). Momentum is conserved as well as the curvature is known, not exactly.
   Walls and solids have contact angles. Two liquids that do not mix have a tension between them, too (interface.c). All
   of it but that of sheets is in FIELD_CAPILLARY.

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
/* TensionSetFromOptions - -tension_type, -tension_ratio (H/h); curvature: -tension_sharpening, -tension_sheets,
   -wall_contact_angle and that of a face, -box_<face>_contact_angle, -wall_contact_hysteresis; cahn_hilliard:
   -tension_calibration (kappa/(sigma H)), -tension_band. Collective. */
PetscErrorCode TensionSetFromOptions(Tension tension);
/* TensionReach - how far (m) the model looks for neighbours; 0 if there is no tension in the scene. Not collective. */
PetscReal TensionReach(Tension tension);
/* TensionOnSurface - whether there is tension and all of it acts as FIELD_CAPILLARY on the free surface, see
   TensionApply. Not collective. */
PetscBool TensionOnSurface(Tension tension);
/* TensionStepLimit - largest time step over sqrt(rho h^3/(2 pi sigma)) in a scheme with forces at the middle of the
   step. Not collective. */
PetscReal TensionStepLimit(Tension tension);
/* TensionApply - from positions and INT_SURFACE, either adds the acceleration (m/s2) of the fluid to
   FIELD_ACCELERATION or sets FIELD_CAPILLARY and FIELD_CAPILLARY_SLOPE, which the pressure solver reads (zero
   otherwise). Only near a surface particle is anything evaluated. Collective. */
PetscErrorCode TensionApply(Tension tension, Cloud cloud);
/* TensionHold - what contact lines that stick (-wall_contact_hysteresis) take in dt (s) from the velocities v
   ([n_fluid][3], m/s) after the pressure has acted; adds its work (J) to *work. TensionSticks - whether any does.
   TensionHasAngles - whether any is not of 90 degrees, or sticks. Not collective. */
PetscErrorCode TensionHold(Tension tension, Cloud cloud, PetscReal dt, PetscReal v[], PetscReal *work);
PetscBool      TensionSticks(Tension tension);
PetscBool      TensionHasAngles(Tension tension);
PetscErrorCode TensionView(Tension tension, PetscViewer viewer);
PetscErrorCode TensionDestroy(Tension *tension);

#endif
