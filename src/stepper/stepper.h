/* Floor 6: the time step. Stage one (viscosity, tension, body force), stage two (a registered scheme: how pressure
   restores incompressibility), the size of the step, and the decision to accept or roll back. */
#ifndef ISPH_STEPPER_H
#define ISPH_STEPPER_H

#include "../operators/operators.h"
#include "../pressure/pressure.h"
#include "../tension/tension.h"

typedef struct _p_Stepper *Stepper;

/* The state of a run besides the particles, as a restart needs it; the same on every rank; SI units. */
typedef struct {
  PetscReal time, time_step;
  PetscReal pressure_time; /* of the step's pressures: its middle, or its start where forces act there, s */
  PetscInt  step, iterations;
  PetscReal density_error;      /* rms of (rho - rho_0)/rho_0 over particles inside the liquid, 1 */
  PetscReal divergence;         /* rms of the velocity divergence inside times the time step, 1; nan: not measured */
  PetscReal solver_error;       /* rms density error that the pressure solver left in the step, 1 */
  PetscReal density_mean;       /* mean rho/rho_0 inside, 1 */
  PetscReal surface_energy;     /* sigma times the area of the free surface, J (J/m in two dimensions) */
  PetscReal viscous_work;       /* done by viscosity on the fluid so far, J; dissipation is negative */
  PetscReal tension_work;       /* done by surface tension on the fluid so far, J */
  PetscReal solid_work;         /* done on the fluid by the pressure of solids that move so far, J */
  PetscReal drive_work;         /* done by SceneDrive so far, J */
  PetscReal outflow_energy;     /* kinetic + potential of what left through open faces so far, J */
  PetscReal given_energy;       /* kinetic + potential that the liquid got between steps so far, J */
  PetscReal tension_swing;      /* sum over the steps of |work of surface tension|, J */
  PetscReal friction_work;      /* the part of viscous_work done by walls and solids that move, J */
  PetscReal kinetic_energy;     /* of the fluid at the end of the step, J */
  PetscReal kinetic_most;       /* the largest of these so far, J */
  PetscReal given, taken;       /* sums over the steps of the energy that the fluid's motion gained and lost, J */
  PetscReal start_energy;       /* kinetic + potential at the start of the run, J */
  PetscReal potential_energy;   /* of the fluid when the state was written, J */
  PetscReal start_surface;      /* surface_energy at the start of the run, J */
  PetscReal start_density;      /* density_mean at the start */
  PetscInt  rejected;           /* steps rolled back so far */
  PetscInt  lost;               /* particles that left through open faces so far */
  PetscInt  said;               /* bits: which have said what they doubt, StepperDoubt */
  PetscReal previous_time_step; /* the step's history that a restart needs, s */
  PetscReal edge[2048];         /* numbers of the edges of a step: StepEdgeNumbers */
} StepState;

/* Numbers as rows of a table: checkpoints, restarts and the energy budget walk them. A number of the core has a row in
   state.c, one of an edge in the edge's file. */
typedef enum {
  NUMBER_REAL,  /* PetscReal */
  NUMBER_SPAN,  /* PetscReal, not negative */
  NUMBER_MAYBE, /* PetscReal, nan: not known */
  NUMBER_COUNT  /* PetscInt, not negative */
} NumberKind;

/* What an energy (J) is to the liquid: what boundaries and forces gave it, what came and left with liquid, what the
   numerical method took; the work of a boundary that is a part of viscous_work. */
typedef enum { ENERGY_NONE, ENERGY_GIVEN, ENERGY_BROUGHT, ENERGY_TAKEN, ENERGY_LOST, ENERGY_FRICTION } EnergyPart;

/* A row: the number's name in a checkpoint, its kind, its place in the struct (bytes); of an energy: its part, and what
   gave or took it, for the error budget. The last row of a table has no name. */
typedef struct {
  const char *name;
  NumberKind  kind;
  size_t      offset;
  EnergyPart  part;
  const char *source;
} NumberRow;
typedef struct {
  const NumberRow *row;
  void            *at; /* PetscReal or PetscInt */
} Number;

/* Rows of numbers that an edge of a step keeps in the scene or among its numbers, for checkpoints: their name there,
   what they are, and row k of the given width, NULL: there are only k. */
typedef struct {
  const char *name, *meaning;
  PetscReal *(*row)(Scene scene, void *numbers, PetscInt k, PetscInt *width);
} NumberTable;

/* NumbersWalk - number *k of a struct, by the rows of its table (NULL: none); false: there are fewer, and *k is less by
   as many. StateNumber - number k of a state, those of the edges last; false: there are only k. StepperEnergy - the sum
   of a part of the energy, J. StepperOutsideWork - energy that the fluid got from outside so far, J, less the energy
   that left with liquid. StepperTable - table k of the edges, and the numbers of its edge in a state; NULL: there are
   only k. StepperReport - lines (LF at the end of each) about what the edges of a step have done so far; text: at most
   'length' bytes; copies: of the liquid in the whole scene (GaugeTotals); joule: the unit of energies. Not collective.
 */
PetscBool          NumbersWalk(const NumberRow rows[], const void *of, PetscInt *k, Number *number);
PetscBool          StateNumber(const StepState *state, PetscInt k, Number *number);
PetscReal          StepperEnergy(const StepState *state, EnergyPart part);
PetscReal          StepperOutsideWork(const StepState *state);
const NumberTable *StepperTable(const StepState *state, PetscInt k, void **numbers);
PetscErrorCode     StepperReport(Scene scene, const StepState *state, PetscReal copies, const char joule[], char text[],
                                 size_t length);

#define SCHEME_DENSITY_INVARIANT "density_invariant" /* the paper as printed, but for surface tension */
#define SCHEME_CONSISTENT        "consistent" /* corrected divergence, relaxed surface-corrected density, shifting */

#define SCHEME_WEAKLY_COMPRESSIBLE                                                                                     \
  "weakly_compressible" /* the consistent scheme with an explicit pressure: Tait's equation, artificial sound */

/* StepperProperties - gives the domain what edges bring of properties, before any options are read. Not collective. */
PetscErrorCode StepperProperties(Domain domain);
/* StepperParticles - an empty swarm with the fields of every run, of viscosity and of the edges, which give them their
   start values. Collective. */
PetscErrorCode StepperParticles(Scene scene, Tension tension, Particles *particles);
/* StepperCreate - of a cloud, with its tension and pressure (all borrowed). Collective. */
PetscErrorCode StepperCreate(Cloud cloud, Tension tension, Pressure pressure, Stepper *stepper);
/* StepperSetFromOptions - -scheme (sets the pressure's types, which its own options may then change; calls
   PressureSetFromOptions), -shifting_*, -time_cfl, -time_step_min, -time_step_max (s), -time_step (s, fixed),
   -displacement_max (spacings), -energy_max (1), -wall_guard (spacings); weakly compressible: -sound_speed (m/s),
   Collective. */
PetscErrorCode StepperSetFromOptions(Stepper stepper);
PetscErrorCode StepperView(Stepper stepper, PetscViewer viewer);
/* StepperJson - writes the scheme, if a step has been chosen its bounds, and what edges add, into the open object of
   scene.json. Not collective. */
void StepperJson(Stepper stepper, PetscBool chosen, Json *json);
/* StepperForesee - refuses (UserError) at the start of a run from 'start' to 'end' (s; PETSC_MAX_REAL: not known) what
   would stop it later, as far as motions tell. Collective. */
PetscErrorCode StepperForesee(Stepper stepper, PetscReal start, PetscReal end);
/* StepperPrepare - sets the solver up at the present state, so that it reads all its options. Collective. */
PetscErrorCode StepperPrepare(Stepper stepper);
/* StepperAdvance - makes one accepted step, at most to the time 'end' (s). Rolls back and halves the step as often as
   needed. *failed: this did not help; the swarm then holds the last good state, and 'why' (a sentence of at most
   'length' bytes) says what went wrong. diagnose: measures the divergence, too. Collective. */
PetscErrorCode StepperAdvance(Stepper stepper, PetscReal end, PetscBool diagnose, StepState *state, PetscBool *failed,
                              char why[], size_t length);
/* StepperPredict - computes stage one of a step from the swarm's state, for PressureAssemble. *dt: the step's size (s).
   Collective. */
PetscErrorCode StepperPredict(Stepper stepper, const StepState *state, PetscReal *dt);
/* StepperViscosity - the viscous term as -viscosity_form and -viscosity_wall choose it; borrowed. Not collective. */
const Viscosity *StepperViscosity(Stepper stepper);
/* StepperLoad - adds to force ([n_total][3], N) what stresses that edges give the liquid do to dummy particles, at the
   last search and with the velocities of ghosts. Collective. */
PetscErrorCode StepperLoad(Stepper stepper, PetscReal force[]);
/* StepperRefresh - computes the work fields that gauges read (see GaugesSetRefresh) from the swarm's state. No stored
   field changes. Collective. */
PetscErrorCode StepperRefresh(Stepper stepper);
/* StepperMeasure - measures density_error, density_mean and surface_energy of the swarm's particles at the start of a
   run or after they were changed from outside; also stores their viscosity if it varies. Collective. */
PetscErrorCode StepperMeasure(Stepper stepper, StepState *state);
/* StepperRepairsAtOnce - whether each step corrects all density errors. Then the first step turns those of the packing
   into velocities. Not collective. */
PetscBool StepperRepairsAtOnce(Stepper stepper);
/* StepperReset - forgets what former steps left beside the StepState: the next step is that of a restart. resumed: the
   state has been read. Right after CloudResync. Collective. */
PetscErrorCode StepperReset(Stepper stepper, PetscBool resumed, StepState *state);
/* StepperSettle - moves the particles of a packing, in a few iterations, to places from which pressure does not drive
   them; without the divergence source and the corrected gradient the packing stays. Velocities stay those of the
   particles. Collective. StepperSettles - whether it does, not collective. */
PetscErrorCode StepperSettle(Stepper stepper);
PetscBool      StepperSettles(Stepper stepper);
/* StepperSetRelaxation - relaxing: from now on steps relax the packing to rest: no body force, velocities damped before
   each step, and a fixed step (s; 0: chosen as in the run, with the scene's velocity). Not collective. */
PetscErrorCode StepperSetRelaxation(Stepper stepper, PetscBool relaxing, PetscReal size);
/* Bounds of a time step, s; PETSC_MAX_REAL: none. viscosity: of an explicit step. viscosity_flow: the same, but a
   viscosity that varies has its value at the shear rate U/h, U the scene's velocity; implicit steps are limited in
   multiples of it, or by flow, the step of a flow without inertia, if that is longer (0: inertia counts). swing: of
   what swings in the scene. */
typedef struct {
  PetscReal speed, force, viscosity, viscosity_flow, tension, flow, swing;
} StepBounds;

/* A bound of the step as a row: its name in scene.json, its cause, its size (s), and what lifts it. StepperBounds -
   lists those of the step that was chosen last, first the one that bounds it; returns how many. Not collective.
   STEP_BOUNDS: the most of core and edges. */
typedef struct {
  const char *name, *cause;
  PetscReal   step;
  const char *lift;
} StepBound;
#define STEP_BOUNDS 24
PetscInt StepperBounds(Stepper stepper, StepBound rows[STEP_BOUNDS]);
/* StepperUnderresolved - number of particles of viscous liquid whose neighbours in the last step lay along a line at
   most: a sheet or thread is one particle thick there and tears. Not collective. */
PetscInt StepperUnderresolved(Stepper stepper);
/* StepperBeside - the pressure (Pa, over that of the open air) at x (m), where no liquid is, after the last step. Not
   collective. */
PetscReal StepperBeside(Stepper stepper, const PetscReal x[DIM]);
/* StepperDoubt - what an edge says about the last step, or that -time_step is far beyond a bound, each once in a run
   and its restarts (state), in a sentence of at most 'length' bytes; mostly empty. Collective. */
PetscErrorCode StepperDoubt(Stepper stepper, StepState *state, char text[], size_t length);
/* StepperBring - adds the liquid that bodies bring up to the state's time, and its energy to the state; gauges NULL:
   not its energy, before the run. resumed: only counts what the run brought before it was continued. Collective.
   StepperFilling - the number of particles (may be NULL) of one filling of a body, by its index, and their volume (m3,
   in two dimensions m2), after the first StepperBring. Not collective. */
typedef struct _p_Packing *Packing; /* of higher floors, passed on */
typedef struct _p_Gauges  *Gauges;
PetscErrorCode StepperBring(Stepper stepper, Packing packing, Gauges gauges, PetscBool resumed, StepState *state);
PetscReal      StepperFilling(Stepper stepper, PetscInt body, PetscInt *particles);
/* StepperSteadyStep - the step (s) that StepperBounds and the options allow, without the limit on its growth; with
   implicit viscosity if that is faster. scale (1): for the same flow with a spacing so many times as large. Not
   collective. */
PetscReal StepperSteadyStep(Stepper stepper, PetscReal scale);
/* StepperStepsIn - the number of steps in a time (s) that grow from the one before (s) to the steady step 'most' (s).
   Not collective. */
PetscReal StepperStepsIn(PetscReal time, PetscReal before, PetscReal most);
/* StepperReferenceVelocity - the scene's own velocity scale (m/s), sqrt(U^2 + g L + sigma/(rho h)); U: the largest
   speed of bodies, solids and walls. Not collective. */
PetscReal      StepperReferenceVelocity(Stepper stepper);
PetscErrorCode StepperDestroy(Stepper *stepper);

#endif
