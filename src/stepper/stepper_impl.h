/* Private to stepper/. */
#ifndef ISPH_STEPPER_TYPES_H
#define ISPH_STEPPER_TYPES_H

#include "../operators/operators.h"
#include "../wall/wall.h"
#include "stepper.h"

/* What an attempt at a step gives: the new state stands in the cloud (positions, velocities, pressure), not yet
 * committed. */
typedef struct {
  PressureResult     pressure;
  KSPConvergedReason viscous;                    /* of the implicit viscosity; 0: not used */
  PetscReal          displacement;               /* largest, m, this rank */
  PetscReal          density;                    /* largest rho/rho_0, this rank */
  PetscReal          error2;                     /* sum of squares of rho/rho_0 - 1 inside, this rank */
  PetscReal          divergence2;                /* sum of squares of div v inside, this rank, 1/s2 */
  PetscReal          error;                      /* sum of rho/rho_0 inside, this rank */
  PetscReal          surface;                    /* sigma times area, J, this rank */
  PetscReal          viscous_work, tension_work; /* of the step, J, this rank */
  /* of the free surface under tension, this rank: liquid that flows in through it in the step, m3; area, m2; integral
     of sigma kappa over it, N */
  PetscReal inward, area, capillary_area;
  PetscInt  inside; /* particles in those sums */
  PetscBool broken; /* not a number, this rank */
} StepTrial;

typedef enum { VISCOUS_EXPLICIT, VISCOUS_IMPLICIT, VISCOUS_AUTO } ViscousSolver;

/* The implicit viscosity, viscous.c. */
typedef struct {
  ViscousSolver solver;
  PetscReal     ratio;            /* largest step over the explicit limit */
  PetscBool     implicit;         /* in this step */
  PetscReal     dt;               /* s, of the system being solved */
  PetscReal    *pair;             /* [pairs of the fluid] coefficients */
  PetscInt      capacity, layout; /* of pair; the local order the solver was made for */
  KSP           ksp;
  Mat           A;
  Vec           x, b; /* velocities of the fluid, [n_fluid][3] */
} Viscous;

typedef PetscErrorCode (*SchemeFunction)(Stepper, PetscReal dt, PetscBool diagnose, StepTrial *);

/* How the pressure of a step comes about: FIELD_PRESSURE of owned particles and ghosts. */
typedef PetscErrorCode (*PressureStep)(Stepper, PetscReal dt, PressureResult *);

struct _p_Stepper {
  Cloud          cloud;    /* borrowed */
  Tension        tension;  /* borrowed */
  Pressure       pressure; /* borrowed */
  char           scheme_type[64];
  SchemeFunction scheme;
  PetscReal      cfl, step_min, step_max, step_fixed, displacement_max, density_max, guard;
  ViscosityForm  viscosity_form;
  Viscous        viscous;
  PetscBool      centered; /* consistent: forces at the middle of the step */
  PetscBool      shifting, shifting_conserved;
  PetscReal      shifting_strength, shifting_cap;
  PetscReal      relaxation_ratio;
  PetscReal      reference_velocity; /* m/s */
  PetscReal      energy_max;         /* kinetic energy over all at hand that stops the run; 0: not watched */
  PetscReal      energy_at_hand;     /* J/kg; 0: no bound: gravity drives a periodic direction, or an emitter */
  PetscReal      density_ratio_max;  /* of the densities of two bodies */
  PetscReal      damping;
  StepBounds     bounds; /* of the last step size chosen */
  PetscBool      first;  /* the step is the first of a run */
  /* weakly compressible */
  PetscBool sound_projected; /* the first pressure is projected */
  PetscReal sound_speed, sound_mach, sound_cfl, density_diffusion, lattice_sum;
};

PetscErrorCode SchemeDensityInvariant(Stepper, PetscReal, PetscBool, StepTrial *);
PetscErrorCode SchemeConsistent(Stepper, PetscReal, PetscBool, StepTrial *);
PetscErrorCode SchemeWeaklyCompressible(Stepper, PetscReal, PetscBool, StepTrial *);
/* CompressibleSetFromOptions - the options of the weakly compressible scheme, inside an options block;
   CompressibleCheck - refuses bad values, after it, and chooses the speed of sound for the scene's velocity (m/s).
   Collective. */
PetscErrorCode CompressibleSetFromOptions(Stepper stepper, OptionItems PetscOptionsObject);
PetscErrorCode CompressibleCheck(Stepper stepper, PetscReal velocity);
/* ConsistentStep - the step that the consistent and the weakly compressible scheme share. Collective. */
PetscErrorCode ConsistentStep(Stepper, PetscReal, PetscBool, PressureStep, StepTrial *);
/* PressureProjected - by PressureSolve. Collective. */
PetscErrorCode PressureProjected(Stepper stepper, PetscReal dt, PressureResult *result);
/* StageOne - acceleration by viscosity, tension and body force at the positions and velocities of the cloud, then
   FIELD_VELOCITY_STAR = v + dt a for the fluid and the wall's own velocity for walls, ghosts included. density: what
   viscosity divides by. viscous: OperatorsMoments has left the viscous term in FIELD_ACCELERATION. Also
   trial->viscous_work and tension_work. Viscosity acts at the new velocity in steps that StepSize made implicit.
   Collective. */
PetscErrorCode StageOne(Stepper stepper, PetscReal dt, const PetscReal density[], PetscBool viscous, StepTrial *trial);
/* ViscosityIsExplicit - in this step; false also without viscosity. Not collective. */
PetscBool ViscosityIsExplicit(Stepper stepper);
/* ViscousSetFromOptions - inside an options block; ViscousPrepare - reads the options of the solver, if it may be used.
   ViscousSolve - FIELD_VELOCITY_STAR (of the fluid, without viscosity) becomes the velocity u with u = predicted + dt V
   u, ghosts included, walls with their own velocity. Overwrites FIELD_WORK1, FIELD_WORK3. Collective. */
PetscErrorCode ViscousSetFromOptions(Stepper stepper, OptionItems PetscOptionsObject);
PetscErrorCode ViscousPrepare(Stepper stepper);
PetscErrorCode ViscousSolve(Stepper stepper, PetscReal dt, const PetscReal density[], KSPConvergedReason *reason);
PetscErrorCode ViscousDestroy(Stepper stepper);
/* Diagnose - density error, largest density, area of the free surface and (if asked) divergence of FIELD_VELOCITY, at
   the positions where moments and surface were last evaluated. Not collective. */
PetscErrorCode Diagnose(Stepper stepper, PetscBool divergence, StepTrial *trial);
/* Shift - moves FIELD_START (the new positions, m) towards an even distribution and takes FIELD_VELOCITY_STAR (the new
   velocity, m/s) to where the particles then are: into FIELD_VELOCITY; reads what the last OperatorsDivergence summed.
   If shifting is conserved, centre of mass, momentum and angular momentum of the fluid stay, to round-off, except what
   mirrors and the box's period do to them. Lists, kernels and B are those of FIELD_POSITION. Overwrites FIELD_WORK1,
   FIELD_WORK3, FIELD_STRESS, FIELD_ACCELERATION. Collective. */
PetscErrorCode Shift(Stepper stepper, PetscReal dt);
/* StepperEnergyAtHand - what a scene's liquid can turn into kinetic energy, J/kg: speeds of bodies and walls, a fall
   through the box, the surface of every particle; 0 if gravity drives it round a periodic box or it comes from
   emitters. Not collective. */
PetscReal StepperEnergyAtHand(Stepper stepper);
/* StepSize - the step (s) the state allows, within the bounds of the options, and whether its viscosity is implicit.
   Collective. */
PetscErrorCode StepSize(Stepper stepper, const StepState *state, PetscReal end, PetscReal *dt);

#endif
