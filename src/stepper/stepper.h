/* Floor 6: the time step. Stage one (viscosity, tension, body force), stage two (a registered scheme: how pressure
   restores incompressibility), the size of the step, and the decision to accept or roll back. */
#ifndef ISPH_STEPPER_H
#define ISPH_STEPPER_H

#include "../operators/operators.h"
#include "../pressure/pressure.h"
#include "../resampling/resampling.h"
#include "../tension/tension.h"

typedef struct _p_Stepper *Stepper;

/* What a stepper knows of the run, and what a restart needs besides the particles: the same on every rank; SI units. */
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
  PetscReal solid_work;         /* done on the fluid by the pressure of solids that move so far, J */
  PetscReal shaking_work;       /* done by the part of gravity that swings so far, J */
  PetscReal inflow_energy;      /* kinetic + potential of what emitters brought so far, J */
  PetscReal outflow_energy;     /* kinetic + potential of what left through open faces so far, J */
  PetscReal tension_swing;      /* the sizes of the works of surface tension, added up step by step, J */
  PetscReal friction_work;      /* the part of viscous_work that walls and solids that move did, J */
  PetscReal kinetic_energy;     /* of the fluid at the end of the step, J */
  PetscReal given, taken;       /* what went into the fluid's motion and what came out of it so far, step by step, J */
  PetscReal resampling_loss;    /* kinetic energy lost by joining and splitting particles so far, J */
  PetscReal start_energy;       /* kinetic + potential at the start of the run, J */
  PetscReal start_density;      /* density_mean then */
  PetscInt  rejected;           /* steps rolled back so far */
  PetscInt  lost;               /* particles that left through open faces so far */
  PetscInt  joined, split;      /* particles that are gone by joining, that came by splitting so far */
  PetscReal previous_time_step; /* the step's history that a restart needs, s */
} StepState;

/* StepperOutsideWork - what the fluid got from outside so far, J: from solids that move, shaking, emitters, less what
   left through open faces. Not collective. */
static inline PetscReal StepperOutsideWork(const StepState *state)
{
  return state->solid_work + state->shaking_work + state->inflow_energy - state->outflow_energy;
}

#define SCHEME_DENSITY_INVARIANT "density_invariant" /* the paper as printed, with the mended tension */
#define SCHEME_CONSISTENT        "consistent" /* corrected divergence, relaxed surface-corrected density, shifting */

#define SCHEME_WEAKLY_COMPRESSIBLE                                                                                     \
  "weakly_compressible" /* the consistent scheme with an explicit pressure: Tait's equation, artificial sound */

/* StepperCreate - borrows all three. Collective. */
PetscErrorCode StepperCreate(Cloud cloud, Tension tension, Pressure pressure, Stepper *stepper);
/* StepperSetScheme - a registered type; sets the pressure's types and all defaults of its own. Collective. */
PetscErrorCode StepperSetScheme(Stepper stepper, const char name[]);
/* StepperSetFromOptions - -scheme (sets the pressure's types, which its own options may then change; calls
   PressureSetFromOptions), -shifting_*, -time_cfl, -time_step_min, -time_step_max (s), -time_step (s, fixed),
   -displacement_max (spacings), -density_max (1), -wall_guard (spacings); weakly compressible: -sound_speed (m/s),
   -sound_mach, -sound_cfl, -density_diffusion. Collective. */
PetscErrorCode StepperSetFromOptions(Stepper stepper);
PetscErrorCode StepperView(Stepper stepper, PetscViewer viewer);
/* StepperPrepare - assembles and sets the solver up at the present state so that every option of the solver has been
 * read. Collective. */
PetscErrorCode StepperPrepare(Stepper stepper);
/* StepperAdvance - one accepted step, at most to time 'end' (s); rolls back and halves the step as often as it takes.
   *failed is true if that did not help: the swarm then holds the last good state and 'why' (a sentence of at most
   'length' bytes) says what went wrong. diagnose: also measure the divergence. Collective. */
PetscErrorCode StepperAdvance(Stepper stepper, PetscReal end, PetscBool diagnose, StepState *state, PetscBool *failed,
                              char why[], size_t length);
/* StepperPredict - stage one of a step from the swarm's state, so that PressureAssemble gives the system of that step;
 *dt: its size (s). Collective. */
PetscErrorCode StepperPredict(Stepper stepper, const StepState *state, PetscReal *dt);
/* StepperViscosity - of -viscosity_form and -viscosity_wall; borrowed. Not collective. */
const Viscosity *StepperViscosity(Stepper stepper);
/* StepperRefresh - the work fields that gauges read (see GaugesSetRefresh), from the swarm's state as the cloud has it;
   nothing that is stored changes. Collective. */
PetscErrorCode StepperRefresh(Stepper stepper);
/* StepperMeasure - density, its mean and surface_energy of the state at the start of a run, of the swarm's particles as
   they are; gives them their viscosity where it varies. Collective. */
PetscErrorCode StepperMeasure(Stepper stepper, StepState *state);
/* StepperRepairsAtOnce - whether each step repairs all density errors, so that those of the packing become speed in the
   first one. Not collective. */
PetscBool StepperRepairsAtOnce(Stepper stepper);
/* StepperReset - as after a restart: nothing is carried over from former steps but the StepState. Collective. */
PetscErrorCode StepperReset(Stepper stepper);
/* StepperSetRelaxation - whether steps are those of the relaxation to rest: no body force, velocities multiplied with
   'damping' (1) before each step, and a fixed step (s; 0: as in the run, from the scene's velocity). Not collective. */
PetscErrorCode StepperSetRelaxation(Stepper stepper, PetscBool relaxing, PetscReal damping, PetscReal step);
/* What bounds a time step, s; PETSC_MAX_REAL: nothing. viscosity: explicit; viscosity_flow: explicit, of a viscosity
   that varies as it is at the shear rate of the scene's own velocity over the smoothing length, which implicit steps go
   by. */
typedef struct {
  PetscReal speed, force, viscosity, viscosity_flow, tension;
} StepBounds;

/* StepperBounds - of the last step that was chosen. Not collective. */
StepBounds StepperBounds(Stepper stepper);
/* StepperUnderresolved - the particles of thick liquid that had neighbours along a line at most in the last step: a
   sheet or thread is one particle thick there and tears. Not collective. */
PetscInt StepperUnderresolved(Stepper stepper);
/* StepperSteadyStep - the step (s) that those bounds and the options allow, were it not growing from that before; with
   implicit viscosity if that is quicker. scale: for a spacing so many times as large (1), the flow being the same. Not
   collective. */
PetscReal StepperSteadyStep(Stepper stepper, PetscReal scale);
/* StepperReferenceVelocity - the scene's own velocity scale (m/s): initial speeds, those of walls, sqrt(g L),
 * sqrt(sigma/(rho h)). Not collective. */
PetscReal      StepperReferenceVelocity(Stepper stepper);
PetscErrorCode StepperDestroy(Stepper *stepper);

#endif
