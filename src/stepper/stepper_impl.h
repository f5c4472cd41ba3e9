/* Private to stepper/. */
#ifndef ISPH_STEPPER_IMPL_H
#define ISPH_STEPPER_IMPL_H

#include "edge.h"

/* TrialFailed - whether a solver failed, so that the rest of the step is useless. */
static inline PetscBool TrialFailed(const StepTrial *trial)
{
  return (PetscBool)(SolverFailed(&trial->viscous) || SolverFailed(&trial->pressure.solver));
}

/* What a scheme provides: one file, and one line in stepper.c. Entries other than step may be NULL. */
typedef struct {
  Choice choice;                             /* its data are stepper->scheme */
  PetscErrorCode (*create)(Stepper stepper); /* the defaults of stepper, pressure and data */
  PetscErrorCode (*check)(Stepper stepper);  /* completes and checks; stepper->reference_velocity is known */
  PetscErrorCode (*view)(Stepper stepper, PetscViewer viewer);
  PetscReal (*bound)(
    Stepper   stepper,
    PetscReal speed); /* bound of the step (s), besides those of every scheme; speed: the fluid's largest, m/s */
  PetscErrorCode (*step)(Stepper stepper, PetscReal dt, StepTrial *trial);
  const char *advice;  /* what else to try when smaller steps do not help */
  PetscBool   at_once; /* corrects all density errors in each step, unless the source is a divergence */
} SchemeOps;

#define VISCOUS_EQUATION "viscous" /* for SolverTry and SolverExplain */

typedef enum { VISCOUS_EXPLICIT, VISCOUS_IMPLICIT, VISCOUS_AUTO } ViscousSolver;

/* The implicit viscosity, viscous.c. */
typedef struct {
  ViscousSolver choice;
  PetscBool     implicit;                         /* in this step */
  PetscReal     dt;                               /* s, of the system being solved */
  PetscReal    *pair;                             /* [pairs of the fluid] coefficients */
  PetscInt64    capacity;                         /* of pair */
  PetscInt      layout;                           /* cloud->layout for which the solver was made */
  PetscInt      held_count, held_capacity, *held; /* fluid particles whose velocity is given: ViscousHold */
  PetscReal    *held_star;                        /* [held_count][3] their FIELD_VELOCITY_STAR before the solve, m/s */
  PetscReal    *kept_kick;                        /* [n_fluid][3] dt times the kept share of -grad p/rho, m/s */
  PetscInt      kick_capacity;                    /* particles */
  Solver        solver;                           /* of the velocities of the fluid, [n_fluid][3] */
} Viscous;

/* Bounds of the time step; see the options of time_step.c. */
typedef struct {
  PetscReal cfl, min, max, fixed;
  PetscReal force_limit;     /* over sqrt(h/|g|) */
  PetscReal capillary_limit; /* over sqrt(rho h^3/(2 pi sigma)) of Brackbill et al. 1992 */
  PetscReal capillary_most;  /* the same, of bodies so thick that their waves are slow */
  PetscReal swing;           /* s, for the shortest period of what swings in the scene */
  PetscReal per_period;      /* steps in a period of a body's slowest surface wave, at least; 0: no such bound */
} TimeStepLimits;

/* Limits beyond which a step is rolled back or stops the run. */
typedef struct {
  PetscReal displacement; /* spacings */
  PetscReal energy;       /* kinetic energy over at_hand; 0: no limit, nor one of the density */
  PetscReal at_hand;      /* StepperEnergyAtHand, J/kg; 0: no bound */
} TrialLimits;

struct _p_Stepper {
  Cloud              cloud;    /* borrowed */
  Tension            tension;  /* borrowed */
  Pressure           pressure; /* borrowed */
  char               scheme_type[OPTION_WORD_LENGTH];
  const SchemeOps   *ops;
  void              *scheme;    /* data of the scheme */
  const Edge *const *edges;     /* StepEdges */
  void              *edge_data; /* Step.own */
  PetscReal         *edge_sums; /* Step.sums */
  PetscInt           edge_sum_count;
  Step               now;     /* of the present or last step, of no edge */
  StepTrial          result;  /* now.trial */
  PetscBool          trying;  /* from 'restore' to 'guard' */
  size_t             reached; /* the last hook of the trial, its place in an Edge */
  TimeStepLimits     limits;
  TrialLimits        trial;
  StepBounds         bounds;  /* of the last step size chosen */
  PetscBool          second;  /* the step is the second of a pair: see StepTension */
  PetscReal          fastest; /* m/s, largest speed of the liquid when the bounds were found */
  Viscosity          viscosity;
  Viscous            viscous;
  PetscReal          guard;              /* spacings that particles keep from walls */
  PetscReal          reference_velocity; /* m/s */
  PetscBool          relaxing;           /* StepperSetRelaxation: no body force */
  PetscReal          relaxation_step;    /* s; 0: as in the run */
  PetscInt           underresolved;      /* StepperUnderresolved */
  /* chosen by the scheme at its creation */
  PetscBool no_slip;          /* default of -viscosity_wall: no slip at the wall's face */
  PetscReal relaxation_ratio; /* time in which density errors are corrected, over h/U of the scene */
  PetscReal force_time;       /* when forces act, in steps from the start of the step */
  PetscBool keeps_pressure;   /* implicit steps keep a share of the former pressure; StepKick removes it */
};

/* StepTooFar - whether the trial has moved a particle farther than a step may. Then a neighbour search is useless, and
   would not find all pairs. The same on every rank if the displacement is. */
static inline PetscBool StepTooFar(Stepper stepper, const StepTrial *trial)
{
  return (PetscBool) !(trial->largest[LARGEST_DISPLACEMENT] <=
                       stepper->trial.displacement * stepper->cloud->domain->spacing);
}

extern const SchemeOps SchemeConsistent, SchemeDensityInvariant, SchemeWeaklyCompressible;

/* --- sub-steps, substeps.c; all collective, each with its log event --- */

/* StepDrift - r += v dt/2 for the fluid, ghosts included; boundaries go to the middle of the step. */
PetscErrorCode StepDrift(Stepper stepper, PetscReal dt, StepTrial *trial);
/* StepSearch - at the positions of the cloud: neighbours, FIELD_DENSITY (ghosts too), FIELD_CORRECTION, FIELD_LAMBDA,
   FIELD_NORMAL, FIELD_CROWDING, INT_SURFACE. viscous: also sums the viscous term into FIELD_ACCELERATION, at half the
   cost of a separate sum; only if StepViscosityFused. */
PetscErrorCode StepSearch(Stepper stepper, PetscBool viscous);
/* StepViscosityFused - whether StepSearch can sum the viscous term of this step: explicit viscosity in the form of
   Cleary, one liquid, rest density. Not collective. */
PetscBool StepViscosityFused(Stepper stepper);
/* StepForces - FIELD_ACCELERATION of viscosity, tension and body force at the positions and velocities of the cloud,
   Eqs. (1), (5) to (7); FIELD_VELOCITY_STAR = v + dt a for the fluid, and the wall's own velocity for walls, ghosts
   included. density ([n_total], kg/m3): the viscous term divides by it. fused: FIELD_ACCELERATION has the viscous term
   from StepSearch. In steps that StepSize made implicit viscosity acts at the new velocity. Sums the works of the
   forces. Boundaries that follow the liquid get their velocity in FIELD_VELOCITY_STAR. */
PetscErrorCode StepForces(Stepper stepper, PetscReal dt, const PetscReal density[], PetscBool fused, StepTrial *trial);
/* StepTensionWork - sums the work of the pressure of tension on the free surface, after StepKick. */
PetscErrorCode StepTensionWork(Stepper stepper, PetscReal dt, StepTrial *trial);
/* StepDivergence - FIELD_DIVERGENCE, FIELD_VELOCITY_GRADIENT and FIELD_VELOCITY_JUMP of FIELD_VELOCITY_STAR. The
   divergence is that of the particles moved on for time_offset (s). */
PetscErrorCode StepDivergence(Stepper stepper, PetscReal time_offset);
/* StepProject - FIELD_PRESSURE of owned particles and ghosts by PressureSolve, Eqs. (8), (11). */
PetscErrorCode StepProject(Stepper stepper, PetscReal dt, PressureResult *result);
/* StepKick - FIELD_VELOCITY_NEW = FIELD_VELOCITY_STAR - dt grad p/rho, Eq. (9). First removes from FIELD_VELOCITY_STAR
   the share of the former pressure that an implicit step kept in it. */
PetscErrorCode StepKick(Stepper stepper, PetscReal dt, StepTrial *trial);
/* StepCalm - after StepKick, calms FIELD_VELOCITY_NEW at the surface of liquid whose weight the pressure carries; reads
   FIELD_VELOCITY_GRADIENT. Collective. */
PetscErrorCode StepCalm(Stepper stepper, PetscReal dt);
/* StepDriftOn - the second half of the drift: FIELD_POSITION_NEW = from + dt/2 FIELD_VELOCITY_NEW. half_done is false:
   both halves, from + dt/2 (v + FIELD_VELOCITY_NEW), Eq. (10). from: [n_fluid][3], m. */
PetscErrorCode StepDriftOn(Stepper stepper, PetscReal dt, const PetscReal from[], PetscBool half_done);
/* StepGuard - applies the wall guard (guard.c) to FIELD_POSITION_NEW and FIELD_VELOCITY_NEW and copies them to
   FIELD_POSITION and FIELD_VELOCITY. Boundaries that move go to their positions at the end of the step. The trial adds
   the largest displacement since 'from' ([n_fluid][3], m), over the particle's size. */
PetscErrorCode StepGuard(Stepper stepper, PetscReal dt, const PetscReal from[], StepTrial *trial);

/* WallGuard - on the new state x ([n_owned][3], m), v (m/s) of the fluid: moves a particle closer than 'distance' (m)
   to a wall face or solid back to this distance and removes its velocity into the wall, whose momentum the edges get by
   the hook 'push'; mirrors a particle that crossed a symmetry face back. In a gap too narrow for that it moves the
   particle to the middle. 'distance' is for the finest particles; it
   grows with the size. The Neumann condition of the pressure makes walls impermeable to first order only; this is the
   remainder. Not collective. */
PetscErrorCode WallGuard(Stepper stepper, PetscReal distance, PetscReal x[], PetscReal v[]);

/* --- state.c --- */

extern const NumberRow StateRows[]; /* of the numbers of a StepState, without those of edges */

/* StepEdgesCreate, StepEdgesDestroy - of the data of all edges. StepFirst, StepNext - the step as the first, the next
   edge gets it; *step.edge is NULL behind the last. StepHas - whether the run has the edge. StepInOrder - that a hook
   (its offset in an Edge) follows those before it in the step. Not collective. */
PetscErrorCode StepEdgesCreate(Stepper stepper);
PetscErrorCode StepEdgesDestroy(Stepper stepper);
Step           StepFirst(Stepper stepper);
void           StepNext(Step *step);
PetscBool      StepHas(const Step *step);
PetscErrorCode StepInOrder(Stepper stepper, size_t hook);

/* StepHook - calls a hook of all edges that the run has; further arguments are the hook's: &step and what follows it.
 */
#define StepHook(stepper, hook, ...)                                                                                   \
  do {                                                                                                                 \
    PetscCall(StepInOrder(stepper, offsetof(Edge, hook)));                                                             \
    for (Step step = StepFirst(stepper); *step.edge; StepNext(&step))                                                  \
      if ((*step.edge)->hook && StepHas(&step)) PetscCall((*step.edge)->hook(__VA_ARGS__));                            \
  } while (0)

/* --- forces.c --- */

/* DriveWork - adds to the trial the work of SceneDrive with FIELD_VELOCITY in a time (s). Not collective. */
void DriveWork(Cloud cloud, PetscReal time, StepTrial *trial);

/* StepApparentViscosity - OperatorsApparentViscosity, and what edges change of it. Collective. */
PetscErrorCode StepApparentViscosity(Stepper stepper);
/* StepTension - TensionApply with the tension that edges give the particles; in steps whose next or former one needs no
   tension of its own, of both. dt: of the step (s); 0: of a state. Collective. */
PetscErrorCode StepTension(Stepper stepper, PetscReal dt);

/* --- trial.c --- */

/* TrialStart - a trial of a step of dt (s), and the sums of the edges, at zero; borrowed. Not collective. */
StepTrial *TrialStart(Stepper stepper, PetscReal dt, PetscBool diagnose);
/* TrialDiagnose - measures density error, largest density, area of the free surface and, with trial->diagnose, the
   divergence of FIELD_VELOCITY, at the positions of the last StepSearch. Not collective. */
PetscErrorCode TrialDiagnose(Stepper stepper, StepTrial *trial);
/* TrialReduce - adds kinetic energy and mass, and reduces sums and largest values over all ranks. Collective. */
PetscErrorCode TrialReduce(Stepper stepper, StepTrial *trial);
/* TrialCheck - after TrialReduce: 'why' says in a sentence of at most 'length' bytes what is wrong with a step of dt
   (s); empty if nothing is. Not collective. */
PetscErrorCode TrialCheck(Stepper stepper, PetscReal dt, const StepTrial *trial, char why[], size_t length);

/* --- viscous.c --- */

/* ViscosityIsExplicit - whether viscosity is explicit in this step; false without viscosity. Not collective. */
PetscBool ViscosityIsExplicit(Stepper stepper);
/* ViscousSetFromOptions - reads -viscosity_..., inside an options block. ViscousPrepare - reads the options of the
   solver, if the run may need it. ViscousGetKeptKick - an array [n_fluid][3] (borrowed) that lasts until the end of the
   step. ViscousSolve - FIELD_VELOCITY_STAR, v* without viscosity, becomes u with u = v* + dt V u, ghosts included;
   walls keep their own velocity. Collective. ViscousRelease - gives held liquid the v* that viscosity alone gives it,
   from which the work of what holds it follows. Right after ViscousSolve. Not collective. */
PetscErrorCode ViscousSetFromOptions(Stepper stepper, OptionItems PetscOptionsObject);
PetscErrorCode ViscousPrepare(Stepper stepper);
PetscErrorCode ViscousGetKeptKick(Stepper stepper, PetscReal **kick);
PetscErrorCode ViscousSolve(Stepper stepper, PetscReal dt, const PetscReal density[], SolverReport *report);
void           ViscousRelease(Stepper stepper);
PetscErrorCode ViscousDestroy(Stepper stepper);

/* --- time_step.c --- */

/* TimeStepDefaults; TimeStepSetFromOptions - opens its options blocks and refuses bad values; TimeStepView - warns of a
   step that the user wants longer than what swings allows. Collective. TimeStepDoubt - once, a sentence if -time_step
   is far longer than a bound, else nothing. Not collective. */
void           TimeStepDefaults(TimeStepLimits *limits);
PetscErrorCode TimeStepSetFromOptions(Stepper stepper);
PetscErrorCode TimeStepView(Stepper stepper, PetscViewer viewer);
void           TimeStepDoubt(Stepper stepper, char text[], size_t length);
/* StepSize - chooses the step (s) from the state and the options, and whether its viscosity is implicit. Collective. */
PetscErrorCode StepSize(Stepper stepper, const StepState *state, PetscReal end, PetscReal *dt);
/* StepEdgesBound - the least bound of the step (s) that edges bring, with a spacing 'scale' times as large. Not
   collective. */
PetscReal StepEdgesBound(Stepper stepper, PetscReal scale);
/* StepperEnergyAtHand - bound of the kinetic energy that a scene's liquid can have, J/kg: from speeds of bodies and
   walls, a fall through the box, and the surface of every particle. 0: no bound, since gravity acts along a periodic
   direction or an edge brings energy. Not collective. */
PetscReal StepperEnergyAtHand(Stepper stepper);

#endif
