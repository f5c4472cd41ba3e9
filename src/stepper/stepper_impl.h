/* Private to stepper/. */
#ifndef ISPH_STEPPER_IMPL_H
#define ISPH_STEPPER_IMPL_H

#include "../operators/operators.h"
#include "stepper.h"

#define LIQUID_SUMS 3

/* What a trial of a step sums over the fluid, and what it finds the largest of; of this rank until TrialReduce, then of
   all. "Inside" are the particles that are neither on nor near the free surface. */
typedef enum {
  SUM_INSIDE,         /* particles inside */
  SUM_DENSITY,        /* rho/rho_0 inside */
  SUM_DENSITY2,       /* (rho/rho_0 - 1)^2 inside */
  SUM_DIVERGENCE2,    /* (div v)^2 inside, 1/s2; with 'diagnose' only */
  SUM_SURFACE_ENERGY, /* sigma times the area of the free surface, J */
  SUM_VISCOUS_WORK,   /* J */
  SUM_FRICTION_WORK,  /* the part of it that walls and solids that move do, J */
  SUM_TENSION_WORK,   /* J */
  SUM_SOLID_WORK,     /* J */
  SUM_SHAKING_WORK,   /* J */
  SUM_INFLOW,         /* liquid that flows in through the free surface under tension, m3 */
  SUM_AREA,           /* of that surface, m2 */
  SUM_CAPILLARY_AREA, /* integral of sigma kappa over it, N */
  SUM_LIQUIDS, /* the last three of both liquids that do not mix: of their whole surfaces, without the gas's part */
  SUM_LIQUIDS_LAST = SUM_LIQUIDS + 2 * LIQUID_SUMS - 1,
  SUM_KINETIC,       /* kinetic energy, J */
  SUM_UNDERRESOLVED, /* particles of thick liquid with neighbours along a line at most */
  SUM_MASS,          /* kg */
  SUM_COUNT
} TrialSum;
typedef enum {
  LARGEST_DISPLACEMENT, /* m */
  LARGEST_DENSITY,      /* rho/rho_0 */
  LARGEST_BROKEN,       /* 1 if a position is not a number, else 0 */
  LARGEST_SHARE,        /* of volume over that at the start, 1: of resampling */
  LARGEST_COUNT
} TrialLargest;

/* What a trial of a step gives: the new state stands in the cloud (positions, velocities, pressure), not yet
   committed. */
typedef struct {
  PetscBool      diagnose; /* given: the divergence of the velocity is to be measured too */
  PressureResult pressure;
  SolverReport   viscous; /* of the implicit viscosity, if the step has one */
  PetscReal      sum[SUM_COUNT], largest[LARGEST_COUNT];
  PetscInt       lost; /* particles that left through open faces, once it is accepted */
} StepTrial;

/* TrialFailed - whether a solver did not do what was asked, so that the rest of the step makes no sense. */
static inline PetscBool TrialFailed(const StepTrial *trial)
{
  return (PetscBool)(SolverFailed(&trial->viscous) || SolverFailed(&trial->pressure.solver));
}

/* What a scheme provides: one file, and one line in stepper.c. Entries other than step may be NULL. */
typedef struct {
  PetscErrorCode (*setfromoptions)(Stepper stepper, OptionItems PetscOptionsObject); /* inside an options block */
  PetscErrorCode (*check)(Stepper stepper); /* refuses bad values; stepper->reference_velocity is known */
  PetscErrorCode (*view)(Stepper stepper, PetscViewer viewer);
  PetscReal (*bound)(Stepper stepper, PetscReal speed); /* on the step (s), besides those of every scheme; 'speed': the
                                                           largest of the fluid, m/s */
  PetscErrorCode (*step)(Stepper stepper, PetscReal dt, StepTrial *trial);
  PetscErrorCode (*destroy)(Stepper stepper);
  const char *advice;  /* what else to try when a step fails for good */
  PetscBool   at_once; /* repairs the density in each step, unless the source is a divergence */
} SchemeOps;

/* What an edge adds to a step, in one file of its own and one line of hooks.c. A hook is called where 'on' says that
   the run has the edge (NULL: always); NULL: the edge adds nothing there. dt: s. All but 'on' are collective. */
typedef struct {
  PetscBool (*on)(Stepper stepper);
  /* opens its options blocks; whether the edge is on or not */
  PetscErrorCode (*options)(Stepper stepper);
  /* before a step: 'why' says in a sentence of at most 'length' bytes why it cannot be made; else it stays empty */
  PetscErrorCode (*check)(Stepper stepper, PetscReal dt, char why[], size_t length);
  /* moves boundaries from their places at the time 'from' to those at 'to', with their velocities at 'end' (s); sets
   *moved if it has changed any place or velocity */
  PetscErrorCode (*drift)(Stepper stepper, PetscReal from, PetscReal to, PetscReal end, PetscBool *moved);
  /* before implicit viscosity: ViscousHold for liquid whose velocity is given; what 'follow' needs */
  PetscErrorCode (*hold)(Stepper stepper, PetscReal dt);
  /* within it, the liquid having the velocities u ([n_total][3], m/s): sets those of boundaries that follow the liquid;
     own: with what else acts on them, else of boundaries that start at rest */
  PetscErrorCode (*follow)(Stepper stepper, PetscBool own, PetscReal dt, PetscReal u[]);
  /* viscosity has acted, at these velocities ([n_total][3], m/s) */
  PetscErrorCode (*drag)(Stepper stepper, PetscReal dt, const PetscReal velocity[], StepTrial *trial);
  /* after all forces but the pressure: FIELD_VELOCITY_STAR of boundaries, ghosts too */
  PetscErrorCode (*predict)(Stepper stepper, PetscReal dt);
  /* after the pressure has made FIELD_VELOCITY_NEW */
  PetscErrorCode (*kick)(Stepper stepper, PetscReal dt, StepTrial *trial);
  /* at the end of the step; impulse: that of WallGuard */
  PetscErrorCode (*guard)(Stepper stepper, PetscReal dt, const PetscReal impulse[], StepTrial *trial);
  /* after the step has been accepted */
  PetscErrorCode (*commit)(Stepper stepper, const StepTrial *trial, StepState *state);
} StepHooks;

#define VISCOUS_EQUATION "viscous" /* for SolverTry and SolverExplain */

typedef enum { VISCOUS_EXPLICIT, VISCOUS_IMPLICIT, VISCOUS_AUTO } ViscousSolver;

/* The implicit viscosity, viscous.c. */
typedef struct {
  ViscousSolver choice;
  PetscReal     ratio;                            /* largest step over the explicit limit */
  PetscBool     implicit;                         /* in this step */
  PetscReal     dt;                               /* s, of the system being solved */
  PetscReal    *pair;                             /* [pairs of the fluid] coefficients */
  PetscInt64    capacity;                         /* of pair */
  PetscInt      layout;                           /* the local order the solver was made for */
  PetscInt      held_count, held_capacity, *held; /* fluid particles whose velocity is given: ViscousHold */
  PetscReal    *push;                             /* [n_fluid][3] dt times the kept share of -grad p/rho, m/s */
  PetscInt      push_capacity;                    /* particles */
  Solver        solver;                           /* of the velocities of the fluid, [n_fluid][3] */
} Viscous;

/* What bounds the time step; see the options of time_step.c. */
typedef struct {
  PetscReal cfl, min, max, fixed;
  PetscReal capillary_limit; /* over sqrt(rho h^3/(2 pi sigma)) of Brackbill et al. 1992 */
} TimeStepLimits;

/* What a step may do before it is rolled back or stops the run. */
typedef struct {
  PetscReal displacement; /* spacings */
  PetscReal density;      /* summed over rest density */
  PetscReal energy;       /* kinetic energy over all at hand; 0: not watched */
  PetscReal at_hand;      /* J/kg; 0: no bound, since gravity drives a periodic direction, or an emitter brings more */
} TrialLimits;

struct _p_Stepper {
  Cloud                   cloud;    /* borrowed */
  Tension                 tension;  /* borrowed */
  Pressure                pressure; /* borrowed */
  char                    scheme_type[64];
  SchemeOps               ops;
  void                   *scheme; /* data of the scheme */
  const StepHooks *const *edges;  /* StepEdges */
  TimeStepLimits          limits;
  TrialLimits             trial;
  StepBounds              bounds;  /* of the last step size chosen */
  PetscReal               fastest; /* m/s, of all the liquid, at that time */
  Viscosity               viscosity;
  Resampling              resampling;
  Viscous                 viscous;
  PetscReal               guard;              /* spacings that particles keep from walls */
  PetscReal               density_ratio_max;  /* of the densities of two bodies */
  PetscReal               reference_velocity; /* m/s */
  PetscBool               relaxing;           /* StepperSetRelaxation: no body force */
  PetscReal               damping;            /* velocities are multiplied with it in each step */
  PetscReal               relaxation_step;    /* s; 0: as in the run */
  PetscReal               time;               /* s, at the start of the step */
  PetscBool               first;              /* the step is the first of a run */
  PetscInt                underresolved;      /* StepperUnderresolved */
  PetscReal               free_drag[FREE_MOTIONS * SCENE_MAX_BODIES]; /* of each solid that is free, N, N m */
  PetscReal               free_follow[FREE_MOTIONS * FREE_MOTIONS * SCENE_MAX_BODIES]; /* of free_viscous.c */
  /* chosen by the scheme at its creation */
  PetscBool no_slip;          /* default of -viscosity_wall: no slip at the face */
  PetscReal relaxation_ratio; /* default of -pressure_relaxation_ratio */
  PetscReal force_time;       /* when forces act, in steps after the start of the step */
  PetscBool keeps_pressure;   /* implicit steps keep a share of the former pressure: StepKick takes it out */
};

/* StepTooFar - whether the trial has moved a particle further than a step may: then neighbours need not be looked for,
   nor would they be found. The same on every rank where the displacement is. */
static inline PetscBool StepTooFar(Stepper stepper, const StepTrial *trial)
{
  return (PetscBool) !(trial->largest[LARGEST_DISPLACEMENT] <=
                       stepper->trial.displacement * stepper->cloud->domain->spacing);
}

/* Each scheme's creation: defaults of stepper and pressure, its data and operations. Not collective. */
PetscErrorCode SchemeCreate_Consistent(Stepper stepper);
PetscErrorCode SchemeCreate_DensityInvariant(Stepper stepper);
PetscErrorCode SchemeCreate_WeaklyCompressible(Stepper stepper);

/* --- sub-steps, substeps.c; all collective, each with its log event --- */

/* StepDrift - r += v dt/2 for the fluid, ghosts included; boundaries go to the middle of the step. */
PetscErrorCode StepDrift(Stepper stepper, PetscReal dt, StepTrial *trial);
/* StepSearch - at the positions of the cloud: neighbours, FIELD_DENSITY (ghosts too), FIELD_CORRECTION, FIELD_LAMBDA,
   FIELD_NORMAL, FIELD_CROWDING, INT_SURFACE. viscous: also the viscous term, into FIELD_ACCELERATION, at half the price
   of a sum of its own; for StepViscosityFused only. */
PetscErrorCode StepSearch(Stepper stepper, PetscBool viscous);
/* StepViscosityFused - whether StepSearch can sum the viscous term of this step: it is explicit, in the form of Cleary,
   and of one liquid at rest density. Not collective. */
PetscBool StepViscosityFused(Stepper stepper);
/* StepForces - FIELD_ACCELERATION of viscosity, tension and body force at the positions and velocities of the cloud,
   Eqs. (1), (5) to (7); FIELD_VELOCITY_STAR = v + dt a for the fluid and the wall's own velocity for walls, ghosts
   included. density ([n_total], kg/m3): what viscosity divides by. fused: StepSearch has begun FIELD_ACCELERATION with
   the viscous term. Viscosity acts at the new velocity in steps that StepSize made implicit. Sums the works. Boundaries
   that the liquid moves get their velocity there. */
PetscErrorCode StepForces(Stepper stepper, PetscReal dt, const PetscReal density[], PetscBool fused, StepTrial *trial);
/* StepDivergence - FIELD_DIVERGENCE, FIELD_VELOCITY_GRADIENT and FIELD_VELOCITY_JUMP of FIELD_VELOCITY_STAR; the
   divergence is that after the particles have moved for time_offset (s). */
PetscErrorCode StepDivergence(Stepper stepper, PetscReal time_offset);
/* StepProject - FIELD_PRESSURE of owned particles and ghosts by PressureSolve, Eqs. (8), (11). */
PetscErrorCode StepProject(Stepper stepper, PetscReal dt, PressureResult *result);
/* StepKick - FIELD_VELOCITY_NEW = FIELD_VELOCITY_STAR - dt grad p/rho, Eq. (9), after what an implicit step has kept of
   the former pressure has been taken out of FIELD_VELOCITY_STAR. */
PetscErrorCode StepKick(Stepper stepper, PetscReal dt, StepTrial *trial);
/* StepDriftOn - FIELD_POSITION_NEW = from + dt/2 (v + FIELD_VELOCITY_NEW), Eq. (10), or without v, where the first half
   of the drift is done. from ([n_fluid][3], m). */
PetscErrorCode StepDriftOn(Stepper stepper, PetscReal dt, const PetscReal from[], PetscBool half_done);
/* StepGuard - the wall guard (guard.c) on FIELD_POSITION_NEW and FIELD_VELOCITY_NEW, which then become FIELD_POSITION
   and FIELD_VELOCITY, with boundaries that move at the end of the step; adds the largest displacement since 'from'
   ([n_fluid][3], m) to the trial. */
PetscErrorCode StepGuard(Stepper stepper, PetscReal dt, const PetscReal from[], StepTrial *trial);

/* WallGuard - on the new state x ([n_owned][3], m), v (m/s) of the fluid: a particle closer to a wall face or solid
   than 'distance' (m) is set back to it and loses its velocity into the wall; one that crossed a symmetry face is
   mirrored back. The distance is that of the finest particles; larger ones keep more. The Neumann condition of the
   pressure makes walls impermeable to first order only; this is the remainder. impulse[solids][FREE_MOTIONS]: the
   momentum (N s) and angular momentum (N m s) that free bodies take up by it, of all ranks. Collective. */
PetscErrorCode WallGuard(Cloud cloud, PetscReal distance, PetscReal x[], PetscReal v[], PetscReal impulse[]);

/* --- hooks.c --- */

extern const StepHooks        MovingHooks, ContactHooks, FreeHooks, EmitterHooks, ResamplingHooks;
extern const StepHooks *const StepEdges[]; /* in the order in which they are called; NULL at the end */

/* StepHook - calls a hook of all edges, with what it takes behind the stepper. */
#define StepHook(stepper, hook, ...)                                                                                   \
  do {                                                                                                                 \
    for (const StepHooks *const *edge_ = (stepper)->edges; *edge_; edge_++)                                            \
      if ((*edge_)->hook && (!(*edge_)->on || (*edge_)->on(stepper)))                                                  \
        PetscCall((*edge_)->hook((stepper), __VA_ARGS__));                                                             \
  } while (0)

/* --- moving.c --- */

/* SolidsMove - the 'drift' of the solids that move and their dummy particles. Not collective. */
PetscErrorCode SolidsMove(Cloud cloud, PetscReal from, PetscReal to, PetscReal end);

/* --- free.c, free_viscous.c --- */

/* FreeSetVelocities - the dummy particles of a free solid, by its index, get the velocities of a motion: velocity[]
   ([n_owned][3], m/s). Not collective. FreeSum - sum[solids][FREE_MOTIONS] of the forces on their dummy particles, each
   ([n_total][3], N), of all ranks; 0 of solids that are not free. normal ([n_total][3]): see FreeAddForce, or NULL.
   FreeViscousHold, FreeViscousFollow, FreeViscousDrag - the hooks. Collective. */
void FreeSetVelocities(Cloud cloud, PetscInt solid, const PetscReal motion[FREE_MOTIONS], PetscReal velocity[]);
PetscErrorCode FreeSum(Cloud cloud, const PetscReal each[], const PetscReal normal[], PetscReal sum[]);
PetscErrorCode FreeViscousHold(Stepper stepper, PetscReal dt);
PetscErrorCode FreeViscousFollow(Stepper stepper, PetscBool own, PetscReal dt, PetscReal u[]);
PetscErrorCode FreeViscousDrag(Stepper stepper, PetscReal dt, const PetscReal velocity[], StepTrial *trial);

/* --- forces.c --- */

/* ShakingWork - adds to the trial what the part of gravity that swings does with FIELD_VELOCITY in a time (s). Not
   collective. */
void ShakingWork(Cloud cloud, PetscReal time, StepTrial *trial);

/* --- trial.c --- */

/* TrialDiagnose - density error, largest density, area of the free surface and (if asked) divergence of FIELD_VELOCITY,
   at the positions of the last StepSearch. Not collective. */
PetscErrorCode TrialDiagnose(Stepper stepper, StepTrial *trial);
/* TrialInterface - n, the sum of V grad W (1/m) over the neighbours of the other liquid of particle a; adds to *flow
   (m3/s), if it is not NULL, what flows into a's liquid through its share of their interface. Not collective. */
void TrialInterface(Cloud cloud, PetscInt a, PetscReal n[DIM], PetscReal *flow);
/* TrialSurfaceArea - area of the free surface of one particle's share, m2. Not collective. */
PetscReal TrialSurfaceArea(Cloud cloud, PetscInt a);
/* TrialReduce - adds kinetic energy and mass; sums and largest values of all ranks. Collective. */
PetscErrorCode TrialReduce(Stepper stepper, StepTrial *trial);
/* TrialCheck - after TrialReduce: 'why' says in a sentence of at most 'length' bytes what is wrong with a step of dt
   (s); empty if nothing is. Not collective. */
PetscErrorCode TrialCheck(Stepper stepper, PetscReal dt, const StepTrial *trial, char why[], size_t length);

/* --- viscous.c --- */

/* ViscosityIsExplicit - in this step; false also without viscosity. Not collective. */
PetscBool ViscosityIsExplicit(Stepper stepper);
/* ViscousSetFromOptions - inside an options block; ViscousPrepare - reads the options of the solver, if it may be used.
   ViscousHold - in the hook 'hold': fluid particle a keeps the velocity v (m/s), as a wall does. Not collective.
   ViscousGetPush - an array [n_fluid][3] that stays until the end of the step, borrowed.
   ViscousSolve - FIELD_VELOCITY_STAR (of the fluid, without viscosity) becomes the velocity u with u = v* + dt V u,
   ghosts included, walls with their own velocity. Collective. */
PetscErrorCode ViscousSetFromOptions(Stepper stepper, OptionItems PetscOptionsObject);
PetscErrorCode ViscousPrepare(Stepper stepper);
PetscErrorCode ViscousHold(Stepper stepper, PetscInt a, const PetscReal v[DIM]);
PetscErrorCode ViscousGetPush(Stepper stepper, PetscReal **push);
PetscErrorCode ViscousSolve(Stepper stepper, PetscReal dt, const PetscReal density[], SolverReport *report);
PetscErrorCode ViscousDestroy(Stepper stepper);

/* --- time_step.c --- */

/* TimeStepDefaults; TimeStepSetFromOptions - opens its options blocks and refuses bad values. Collective. */
void           TimeStepDefaults(TimeStepLimits *limits);
PetscErrorCode TimeStepSetFromOptions(Stepper stepper);
/* StepSize - the step (s) the state allows, within the bounds of the options, and whether its viscosity is implicit.
   Collective. */
PetscErrorCode StepSize(Stepper stepper, const StepState *state, PetscReal end, PetscReal *dt);
/* StepperEnergyAtHand - what a scene's liquid can turn into kinetic energy, J/kg: speeds of bodies and walls, a fall
   through the box, the surface of every particle; 0 if gravity drives it round a periodic box or it comes from
   emitters. Not collective. */
PetscReal StepperEnergyAtHand(Stepper stepper);

#endif
