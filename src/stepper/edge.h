/* What acts in a step besides the liquid and its pressure: bodies, sources, contact lines. An edge is a record, which
   the stepper walks; it includes this header and is listed in hooks.c. */
#ifndef ISPH_EDGE_H
#define ISPH_EDGE_H

#include "stepper.h"

#define SURFACES     3 /* on which tension may act: the free surface, and two that edges add */
#define SURFACE_SUMS 3

/* Sums over the fluid, and largest values, in a trial of a step; of this rank until TrialReduce, then of all ranks.
   "Inside" are the particles that are neither on nor near the free surface. */
typedef enum {
  SUM_INSIDE,         /* particles inside */
  SUM_DENSITY,        /* rho/rho_0 inside */
  SUM_DENSITY2,       /* (rho/rho_0 - 1)^2 inside */
  SUM_DIVERGENCE2,    /* (div v)^2 inside, 1/s2; with 'diagnose' only */
  SUM_SURFACE_ENERGY, /* sigma times the area of the free surface, J */
  SUM_VISCOUS_WORK,   /* J */
  SUM_FRICTION_WORK,  /* the part of it done by walls and solids that move, J */
  SUM_TENSION_WORK,   /* J */
  SUM_SOLID_WORK,     /* J */
  SUM_DRIVE_WORK,     /* J */
  SUM_SURFACES,       /* of each surface: liquid that flows in, m3; area, m2; integral of the pressure of tension, N */
  SUM_SURFACES_LAST = SUM_SURFACES + SURFACES * SURFACE_SUMS - 1,
  SUM_KINETIC,       /* kinetic energy, J */
  SUM_UNDERRESOLVED, /* particles of viscous liquid with neighbours along a line at most */
  SUM_MASS,          /* kg */
  SUM_COUNT
} TrialSum;
typedef enum {
  LARGEST_DISPLACEMENT, /* m, over the particle's size */
  LARGEST_DENSITY,      /* rho/rho_0 */
  LARGEST_BROKEN,       /* 1 if a position is not a number, else 0 */
  LARGEST_COUNT
} TrialLargest;

/* The result of a trial of a step. The cloud has the new state (positions, velocities, pressure), not yet committed. */
typedef struct {
  PetscBool      diagnose; /* input: measure the divergence of the velocity, too */
  PressureResult pressure;
  SolverReport   viscous; /* of the implicit viscosity, if the step has one */
  PetscReal      sum[SUM_COUNT], largest[LARGEST_COUNT];
  PetscInt       lost; /* particles that left through open faces, after acceptance */
} StepTrial;

/* A feature that scenes may have, by the name that the user writes; those that are options need no row. What cannot be
   used together: 'one' not with 'other' (NOT_WITH), or not without it, a default (NEEDS) or an option that must be
   given (NEEDS_GIVEN); 'rest' ends the sentence. The last row has no name. sim/refusals.c has the features and refusals
   of the core. */
typedef struct {
  const char *name;
  PetscBool (*on)(Scene scene, Tension tension); /* NULL: not made yet */
} Feature;
typedef enum { NOT_WITH, NEEDS, NEEDS_GIVEN } Relation;
typedef struct {
  const char *one;
  Relation    relation;
  const char *other, *rest;
} Refusal;

/* Names of features of several folders. */
#define FEATURE_FIXED      "-spacing_coarse without -spacing_follow"
#define FEATURE_ANGLES     "contact angles other than 90 degrees or hysteresis"
#define FEATURE_DENSITIES  "bodies of different -<body>_density"
#define FEATURE_FRAME      "-frame_rotation_rate"
#define FEATURE_POISSON    "-packing_type poisson"
#define FEATURE_CONSISTENT "-scheme " SCHEME_CONSISTENT
#define FEATURE_CENTERED   "-time_centered"
#define FEATURE_DIVERGENCE "-pressure_source " SOURCE_DIVERGENCE

/* A row of particles.h that an edge stores. The last has no 'needed'. */
typedef struct {
  FieldId field;
  PetscBool (*needed)(Scene scene, Tension tension); /* NULL: not made yet */
  /* its value in new liquid of a body at x (m); NULL: zero */
  void (*start)(Scene scene, PetscInt body, const PetscReal x[DIM], PetscReal value[]);
} EdgeField;

/* What a hook gets: the step, and what of it is the edge's own. */
typedef struct {
  Stepper    stepper;
  Scene      scene;
  Cloud      cloud;
  Tension    tension;
  Pressure   pressure;
  void      *own;     /* the edge's data: data_size bytes, zero when the stepper is made */
  PetscReal *sums;    /* its sums in the trial, zero at its start; of this rank until 'commit', then of all ranks */
  StepTrial *trial;   /* the trial of the step; between steps the last one */
  PetscReal  time;    /* s, at the start of the step */
  PetscReal  dt;      /* s, the size of the step */
  PetscReal  usual;   /* s, the larger one of it and of the step before: a last step, or one tried again, is shorter */
  PetscBool  first;   /* the step is the first of a run: what moves starts with it */
  PetscReal  damping; /* the factor on velocities in each step of a relaxation; 1 in a run */
  const struct _Edge *const *edge;    /* the edge in the list */
  size_t                     numbers; /* where its numbers begin in a state, bytes: StepNumbers */
} Step;

/* What an edge adds to a step, in a folder or file of its own and one line of hooks.c. A hook is called if 'on' says
   that the run has the edge; on = NULL: always. A hook that is NULL adds nothing. All hooks but 'on' and 'report' are
   collective. */
typedef struct _Edge {
  const char *name;
  PetscBool (*on)(const Step *step);
  /* when the stepper is made and destroyed, whether it is on or not; its data are freed after */
  PetscErrorCode (*create)(const Step *step);
  PetscErrorCode (*destroy)(const Step *step);
  size_t                  data_size;   /* bytes of its data in the stepper: Step.own */
  size_t                  number_size; /* bytes of its numbers in a StepState, zero at the start: StepNumbers */
  const NumberRow        *numbers;     /* their rows */
  NumberTable             table;       /* numbers that it keeps in the scene; no name: none */
  const struct GaugeKind *gauge;       /* its columns and tables, of gauges/columns.h; NULL: none */
  const Property         *properties;  /* options that it gives to bodies, faces, ...: see domain.h; NULL: none */
  const EdgeField        *fields;      /* NULL: none */
  PetscInt                sums;        /* numbers that it sums in a trial: Step.sums */
  const Feature          *features;    /* NULL: none */
  const Refusal          *refusals;    /* the same */
  /* a line about what it has done so far, if anything, whether it is on or not; numbers: its own. See StepperReport */
  PetscErrorCode (*report)(Scene scene, const void *numbers, PetscReal copies, const char joule[], char text[],
                           size_t length);
  /* writes what it adds into the open object of scene.json, whether it is on or not. Not collective. */
  void (*json)(const Step *step, Json *json);
  /* what it is if no symmetry of a scene with it is looked for, "a free body"; NULL: nothing. Not collective. */
  const char *(*lopsided)(Scene scene);
  /* its bound of the step, as it is now, with a spacing 'scale' (1) times as large. Not collective. */
  void (*bound)(const Step *step, PetscReal scale, StepBound *bound);
  /* the pressure (Pa, over that of the open air) at x (m), where no liquid is. Not collective. */
  PetscReal (*beside)(const Step *step, const PetscReal x[DIM]);
  /* adds to force ([n_total][3], N) what its stress in the liquid does to dummy particles, at the last search */
  PetscErrorCode (*load)(const Step *step, PetscReal force[]);
  /* whether it can bring liquid any energy, so that the scene bounds none */
  PetscBool (*drives)(const Step *step);
  /* the speed (m/s) that it gives liquid from rest, as far as the options tell. Not collective. */
  PetscReal (*speed)(const Step *step);
  /* see StepperFilling. Not collective. */
  PetscReal (*filling)(const Step *step, PetscInt body, PetscInt *particles);
  /* fixes its boundaries while the packing relaxes (true), or releases them */
  PetscErrorCode (*freeze)(const Step *step, PetscBool frozen);
  /* opens its options blocks; called whether the edge is on or not */
  PetscErrorCode (*options)(const Step *step);
  /* once in each trial, after its energies are summed at the positions of the last search: adds its own */
  PetscErrorCode (*diagnose)(const Step *step);
  /* --- a step; the order of these members is that of the calls: StepHook refuses another --- */

  /* before a step: 'why' says in a sentence of at most 'length' bytes why the step cannot be made, or stays empty;
     ahead: at the start of the run, for a time dt later, of what depends on the time alone */
  PetscErrorCode (*check)(const Step *step, PetscBool ahead, char why[], size_t length);
  /* keeps its state at the start of a step, for 'restore', which goes back to it before each trial */
  PetscErrorCode (*save)(const Step *step);
  PetscErrorCode (*restore)(const Step *step);
  /* moves boundaries from their positions at the time 'from' to those at 'to', and gives them their velocities at 'end'
     (s); *moved: a position or velocity changed */
  PetscErrorCode (*drift)(const Step *step, PetscReal from, PetscReal to, PetscReal end, PetscBool *moved);
  /* changes FIELD_VISCOSITY (Pa s) of the fluid, which its fields must name, after the shear rates have given it */
  PetscErrorCode (*thicken)(const Step *step);
  /* at the positions of the sums: adds its force over the mass (m/s2) to FIELD_ACCELERATION of the fluid; not while the
     packing relaxes */
  PetscErrorCode (*force)(const Step *step);
  /* before surface tension: sets the tension of the particles (cloud->tension), which counts until it has acted */
  PetscErrorCode (*tense)(const Step *step);
  /* at the positions of the sums, with surface tension, before the pressure of the former step acts: finds what
     surrounds the liquid */
  PetscErrorCode (*surround)(const Step *step);
  /* before implicit viscosity: calls ViscousHold for liquid with a given velocity; prepares 'follow' */
  PetscErrorCode (*hold)(const Step *step);
  /* during implicit viscosity, with the velocities u of the liquid ([n_total][3], m/s): sets u of boundaries that
     follow the liquid. own: they have their velocity at the start and the other forces on them, as the right side of
     the equation needs; else neither, as its matrix needs */
  PetscErrorCode (*follow)(const Step *step, PetscBool own, PetscReal u[]);
  /* after viscosity has acted, at these velocities ([n_total][3], m/s) */
  PetscErrorCode (*drag)(const Step *step, const PetscReal velocity[]);
  /* after all forces but the pressure: sets FIELD_VELOCITY_STAR of boundaries, ghosts too */
  PetscErrorCode (*predict)(const Step *step);
  /* with tension, before 'kick': the work of its pressure at the mean velocities of the step ([n_total][3], m/s, not
     yet of ghosts) */
  PetscErrorCode (*work)(const Step *step, PetscReal mean[]);
  /* after the pressure has made FIELD_VELOCITY_NEW */
  PetscErrorCode (*kick)(const Step *step);
  /* after particles have been shifted: moved ([n_fluid][3], m), relative to the liquid, at the positions of the sums */
  PetscErrorCode (*shifted)(const Step *step, const PetscReal moved[]);
  /* --- the second half of 'drift' --- */

  /* at the end of the step, for each particle that is kept out of a solid: x (m), and the momentum (N s) that it loses.
     Not collective. */
  PetscErrorCode (*push)(const Step *step, PetscInt solid, const PetscReal x[DIM], const PetscReal momentum[DIM]);
  /* after all of these */
  PetscErrorCode (*guard)(const Step *step);
  /* after the step has been accepted */
  PetscErrorCode (*commit)(const Step *step, StepState *state);
  /* see StepperBring */
  PetscErrorCode (*bring)(const Step *step, Packing packing, Gauges gauges, PetscBool resumed, StepState *state);
  /* after a step: 'text' says in a sentence of at most 'length' bytes what is doubtful about it; not called again in
     the run once it has */
  PetscErrorCode (*doubt)(const Step *step, char text[], size_t length);
  /* the cloud has been made anew from the stored fields, for a checkpoint or after one has been read (resumed): what
     follows must depend on these fields and the edge's numbers alone, so that a restart goes on like the run */
  PetscErrorCode (*renew)(const Step *step, PetscBool resumed, StepState *state);
} Edge;

extern const Edge *const StepEdges[]; /* in the order in which they are called; NULL at the end */

/* StepNumbers - the edge's numbers in a state. StepperOwn - the data of the edge that has a gauge; NULL without a
   stepper. Not collective. */
void *StepNumbers(const Step *step, const StepState *state);
void *StepperOwn(Stepper stepper, const struct GaugeKind *gauge);

/* ViscousHold - in the hook 'hold': fluid particle a keeps the velocity v (m/s), like a wall. Not collective. */
PetscErrorCode ViscousHold(Stepper stepper, PetscInt a, const PetscReal v[DIM]);

#endif
