/* Floor 5: surface tension as a registered type.

   curvature (default): the pressure solver puts sigma times the curvature on the free surface. curvature.c finds the
   curvature; sheet.c treats sheets of one or two particles. A drop's pressure is 2 sigma/R to 0.1 % at R/d0 = 8
   (sigma/R to 0.5 % in 2-d). The error of momentum is that of the curvature. Walls and solids have contact angles. Two
   immiscible liquids may have interface tension (interface.c). FIELD_CAPILLARY has all of the tension but that of
   sheets.

   cahn_hilliard: Eqs. (5)-(7) of Kuri et al. with a longer kernel W^H. The divergence of S uses the same kernel as grad
   phi: with the paper's two kernels (W^h for the divergence) the surface of a drop at rest becomes rough, because S_a .
   grad phi_a = 0 removes the particle's own term with one kernel only. For the same reason the symmetric pair form and
   the one-sided sum_b V_b S_b grad W^H are identical; the one-sided form is evaluated. */
#ifndef ISPH_TENSION_H
#define ISPH_TENSION_H

#include "../neighbors/cloud.h"

typedef struct _p_Tension *Tension;

#define TENSION_CAHN_HILLIARD "cahn_hilliard"
#define TENSION_CURVATURE     "curvature"
#define TENSION_NONE          "none"

/* TensionCreate - creates the tension of a scene's bodies. Borrows the scene. Its model is known after
   TensionSetFromOptions; before, no other function may be called but TensionDestroy. Collective. */
PetscErrorCode TensionCreate(Domain domain, Scene scene, Kernel kernel, Tension *tension);
/* TensionSetFromOptions - -tension_type, -tension_ratio (H/h); curvature: -wall_contact_angle,
   -box_<face>_contact_angle, -wall_contact_hysteresis; cahn_hilliard: -tension_calibration (kappa/(sigma H)).
   Collective. */
PetscErrorCode TensionSetFromOptions(Tension tension);
/* TensionReach - the range (m) in which the model needs neighbours; 0 without tension in the scene. Not collective. */
PetscReal TensionReach(Tension tension);
/* TensionOnSurface - whether there is tension and all of it is in FIELD_CAPILLARY: see TensionApply. Not collective. */
PetscBool TensionOnSurface(Tension tension);
/* TensionStepLimits - the largest time step over sqrt(rho h^3/(2 pi sigma)), for a scheme whose forces act in the
   middle of the step. limit: of any liquid; most: of bodies so thick that the waves of their surface are slow. Not
   collective.
 */
void TensionStepLimits(Tension tension, PetscReal *limit, PetscReal *most);
/* TensionApply - from positions and INT_SURFACE, either adds the acceleration (m/s2) of the fluid to FIELD_ACCELERATION
   or sets FIELD_CAPILLARY and FIELD_CAPILLARY_SLOPE, which the pressure solver reads, and FIELD_BENDING if the spacing
   adapts (zero otherwise). Evaluates particles near surface particles only. Collective. */
PetscErrorCode TensionApply(Tension tension, Cloud cloud);
/* TensionPairs - whether one tension can serve two steps: it depends on the places of the liquid alone, and not of
   rings. TensionApplyAhead - TensionApply with the fluid, ghosts too, moved by FIELD_VELOCITY for a time (s), for this
   step and the next, which keeps the local order. TensionApplyKept - the same tension again, or TensionApply if the
   order is new or TensionApply came between. Collective but for TensionPairs. */
PetscBool      TensionPairs(Tension tension);
PetscErrorCode TensionApplyAhead(Tension tension, Cloud cloud, PetscReal time);
PetscErrorCode TensionApplyKept(Tension tension, Cloud cloud);
/* The liquid whose surface is evaluated, of several that do not mix. In its place NULL: all liquid. */
typedef struct {
  PetscInt             bits; /* of the liquids */
  const unsigned char *of;   /* [n_total] bits of the particles */
  PetscReal            part; /* of the tension, N/m */
  const PetscInt      *also; /* [n_total] 1: counts as a surface particle, too; NULL: none */
} Phase;
/* TensionSurface - the work of TensionApply for the surface of one phase, by the model curvature: sets FIELD_CAPILLARY
   and FIELD_CAPILLARY_SLOPE of particles with a normal, and adds the forces of sheets. TensionSetSurfaces - what the
   model calls in place of TensionSurface for all liquid. Collective. */
typedef PetscErrorCode (*TensionSurfaces)(Tension tension, Cloud cloud);
PetscErrorCode TensionSurface(Tension tension, Cloud cloud, const Phase *phase);
void           TensionSetSurfaces(Tension tension, TensionSurfaces surfaces);
/* TensionHasHysteresis - whether a wall or solid has hysteresis. TensionHasAngles - whether some contact angle is not
   90 degrees or has hysteresis. Not collective. */
PetscBool TensionHasHysteresis(Tension tension);
PetscBool TensionHasAngles(Tension tension);
/* TensionHasLaw - whether the angle of a contact line depends on its speed (-wall_contact_law). Not collective. */
PetscBool TensionHasLaw(Tension tension);
/* TensionSolidsWet - whether a solid has a contact angle. Not collective. */
PetscBool TensionSolidsWet(Scene scene);
/* TensionFaceAngles, TensionSolidAngles - the receding and the advancing contact angle (degrees) of a face or a solid;
   false: it has none. TensionJson - writes the model and all angles into the open object of scene.json. Not
   collective. */
PetscBool      TensionFaceAngles(Tension tension, PetscInt d, PetscInt side, PetscReal angle[2]);
PetscBool      TensionSolidAngles(Tension tension, PetscInt solid, PetscReal angle[2]);
void           TensionJson(Tension tension, Json *json);
PetscErrorCode TensionView(Tension tension, PetscViewer viewer);
PetscErrorCode TensionDestroy(Tension *tension);

#endif
