/* Private to scene/: what a body is made of. A shape or velocity field is a table of functions with data of its own in
   the body. */
#ifndef ISPH_SCENEIMPL_H
#define ISPH_SCENEIMPL_H

#include "scene.h"

#define SCENE_NAME_LENGTH 64

/* Shapes, velocity fields and types of bodies are choices, each a table of functions that begins with this. Any of them
   may be NULL or 0. */
typedef struct {
  size_t size; /* of its own data in the body, bytes; they start as zeros */
  /* Reads its options inside an options block; refuses a value that is wrong by itself. -help calls no more than this.
   */
  PetscErrorCode (*setfromoptions)(Body body, OptionItems PetscOptionsObject);
  /* Refuses what is missing or does not fit together, and prepares the rest. */
  PetscErrorCode (*setup)(Body body);
} BodyChoice;

/* PetscFunctionList holds functions: each choice is registered as one that returns its table. */
typedef const BodyChoice *(*BodyChoiceTable)(void);

typedef struct {
  PetscFunctionList shapes, velocities, viscosities, types;
} BodyChoices;

/* A shape. */
typedef struct {
  BodyChoice choice;
  /* Signed distance of x (m), negative inside: of the right sign, and in size at most the distance. */
  PetscReal (*distance)(Body body, const PetscReal x[DIM]);
  void (*bounds)(Body body, PetscReal lower[DIM], PetscReal upper[DIM]); /* corners of a box that holds it, m */
  void (*displace)(Body body, PetscReal x[DIM]);                         /* see BodyDisplace; NULL: not at all */
  PetscReal (*wave)(Body body); /* length of the waves on its surface, m, 0 if it has none; NULL: none */
} ShapeOps;

/* An initial velocity field, added to the uniform part -<b>_velocity. */
typedef struct {
  BodyChoice choice;
  void (*add)(Body body, const PetscReal x[DIM], PetscReal v[DIM]); /* adds to v (m/s) at x (m); NULL: zero */
} VelocityOps;

/* A model of viscosity, from -<b>_viscosity. */
typedef struct {
  BodyChoice choice;
  PetscReal (*at)(Body body, PetscReal rate); /* Pa s, at a shear rate (1/s); NULL: constant */
} ViscosityOps;

struct _p_Body {
  Domain              domain; /* borrowed */
  char                name[SCENE_NAME_LENGTH];
  char                prefix[SCENE_NAME_LENGTH + 1]; /* of its options: the name and an underscore */
  char                shape_type[SCENE_NAME_LENGTH];
  char                velocity_type[SCENE_NAME_LENGTH];
  const ShapeOps     *shape;
  const VelocityOps  *velocity;
  void               *shape_data;    /* the shape's own struct, freed with PetscFree */
  void               *velocity_data; /* as shape_data */
  char                viscosity_type[SCENE_NAME_LENGTH];
  const ViscosityOps *viscosity;      /* NULL of a solid */
  void               *viscosity_data; /* as shape_data */
  PetscReal           uniform[DIM];   /* uniform part of the velocity, m/s */
  Material            material;
  char                type[SCENE_NAME_LENGTH];
  void               *emitter; /* the struct of an emitter, as shape_data; NULL: liquid */
  PetscInt            color;
  PetscReal           contact_angle;      /* of a solid, degrees; 0: none given */
  PetscReal           contact_hysteresis; /* of a solid, degrees */
  struct _p_Motion   *motion;             /* of a solid that moves; else NULL */
  struct _p_Free     *free;               /* of a solid that moves freely; else NULL */
};

struct _p_Scene {
  Domain    domain; /* borrowed */
  PetscInt  count;
  Body      body[SCENE_MAX_BODIES];
  PetscInt  solids;
  Body      solid[SCENE_MAX_BODIES];
  PetscInt  fine_regions;
  Body      fine[SCENE_MAX_BODIES];                 /* shapes alone, around which the spacing is fine */
  PetscBool overlap;                                /* bodies may: see SceneBodiesOverlap */
  PetscReal interface_tension;                      /* N/m; 0: the liquids mix */
  PetscInt  liquid[SCENE_MAX_BODIES];               /* 0 or 1: see SceneLiquid */
  PetscReal gravity[DIM];                           /* m/s2 */
  PetscReal central_rate;                           /* 1/s */
  PetscReal amplitude[DIM], angular_frequency;      /* of the part of gravity that swings, m/s2, rad/s */
  PetscReal frame_rate[DIM + 1], frame_center[DIM]; /* rad/s; m; one number more, to notice too many */
  PetscInt  frame_rates;                            /* numbers given */
  PetscReal solid_time;                             /* at which solids are asked where they are, s */
  PetscReal shake[DIM];                             /* that part at the time set last, m/s2 */
};

/* The tables of shapes, one file each, and of types; registered in scene.c. The type's options are read last: it may
   use shape and velocity. */
const BodyChoice *ShapeBox(void);
const BodyChoice *ShapeSphere(void);
const BodyChoice *ShapeStl(void);
const BodyChoice *ShapeCylinder(void);
const BodyChoice *ShapeEllipsoid(void);
const BodyChoice *ShapeHalfSpace(void);
const BodyChoice *ShapeThread(void);
const BodyChoice *ShapeWave(void);
const BodyChoice *BodyTypeLiquid(void);
const BodyChoice *BodyTypeEmitter(void);

/* LiquidsSetFromOptions - -interface_tension, -interface_bodies; refuses (UserError) what does not make two liquids.
   After the bodies. Collective. */
PetscErrorCode LiquidsSetFromOptions(Scene scene);
/* LiquidsView - prints the interface and warns if one of the three spreads between the others. Collective. */
PetscErrorCode LiquidsView(Scene scene, PetscViewer viewer);
/* VelocityRegisterAll - adds the velocity fields of velocity.c to a list. Not collective. */
PetscErrorCode VelocityRegisterAll(PetscFunctionList *list);
/* ViscosityRegisterAll - adds the models of viscosity.c to a list. Not collective. */
PetscErrorCode ViscosityRegisterAll(PetscFunctionList *list);

/* BodyCreate - a body of water at rest that fills the box, to be set by its options. BodySetFromOptions - reads all of
   -<b>_*. Refuses (UserError) what SceneSetFromOptions says of one body. BodyHelp - shows -help the
   options of all bodies and of each choice, with <body> for the name. Collective. */
PetscErrorCode BodyCreate(Domain domain, const char name[], PetscInt index, Body *body);
PetscErrorCode BodySetFromOptions(Body body, const BodyChoices *choices);
PetscErrorCode BodyHelp(MPI_Comm comm, const BodyChoices *choices);
/* SolidSetFromOptions - shape and motion: all a solid has. Collective. */
PetscErrorCode SolidSetFromOptions(Body body, const BodyChoices *choices);
/* MotionSetFromOptions - makes the motion of a solid from its options; MotionSetUp - refuses what does not fit
   together, and removes a motion of nothing. Collective. MotionView - prints it. MotionSetTime - the time (s) at which
   MotionBack finds the place y (m) at the time 0 of the solid's point that is at x (m). */
PetscErrorCode MotionSetFromOptions(Body body, OptionItems PetscOptionsObject);
PetscErrorCode MotionSetUp(Body body);
PetscErrorCode MotionView(Body body, PetscViewer viewer);
PetscErrorCode MotionDestroy(Body body);
void           MotionSetTime(Body body, PetscReal time);
/* RateCheck - makes what was read from -<prefix>rotation_rate, 'count' numbers, a vector (rad/s), and refuses
   (UserError) what is none. Collective. */
PetscErrorCode RateCheck(Domain domain, const char prefix[], PetscInt count, PetscReal rate[DIM + 1]);
/* FrameSetFromOptions - reads -frame_rotation_rate and -frame_rotation_center inside an options block; FrameCheck -
   refuses (UserError) what does not turn with it. Collective. FrameAdd - adds the centrifugal acceleration at x (m) to
   g (m/s2). FramePotential - its potential energy a unit mass (J/kg). FrameView - prints the frame if it turns. */
PetscErrorCode FrameSetFromOptions(Scene scene, OptionItems PetscOptionsObject);
PetscErrorCode FrameCheck(Scene scene);
void           FrameAdd(Scene scene, const PetscReal x[DIM], PetscReal g[DIM]);
PetscReal      FramePotential(Scene scene, const PetscReal x[DIM]);
PetscErrorCode FrameView(Scene scene, PetscViewer viewer);
/* FreeSetFromOptions - reads -<s>_mass and what belongs to it; FreeSetUp - refuses (UserError) what does not fit, and
   removes the free body if there is no mass. center (m): of mass, given if 'centered', else found here; velocity (m/s)
   and rate (rad/s): at the start. FreeCheck - refuses a mass, a moment of inertia or a centre of mass that cannot be in
   liquids of this density at most (kg/m3). Collective. FreePlace - shift (m) and turn at the time (s) of a free body;
   FreeVelocity - its velocity (m/s) and rate (rad/s) since it was pushed last; FreeSetTime - where it is from here on.
   FreeView - prints it. Collective.
 */
PetscErrorCode FreeSetFromOptions(Body body, OptionItems PetscOptionsObject);
PetscErrorCode FreeCheck(Body body, PetscReal density);
PetscErrorCode FreeSetUp(Body body, PetscBool centered, PetscReal center[DIM], const PetscReal velocity[DIM],
                         const PetscReal rate[DIM]);
PetscErrorCode FreeView(Body body, PetscViewer viewer);
void           FreePlace(Body body, PetscReal time, PetscReal shift[DIM], PetscReal turn[DIM][DIM]);
void           FreeVelocity(Body body, PetscReal velocity[DIM], PetscReal rate[DIM]);
void           FreeSetTime(Body body, const PetscReal shift[DIM], PetscReal turn[DIM][DIM]);
/* RotationMatrix - of a rotation with this rate (rad/s) for a time (s). RotationMultiply - out = A B. RotationInverse -
   of A. RotationStraighten - makes a matrix that rounding has bent one of a rotation again. RotationVector - its axis
   times its angle (rad), between -pi and pi. */
void RotationMatrix(const PetscReal rate[DIM], PetscReal time, PetscReal turn[DIM][DIM]);
void RotationMultiply(PetscReal A[DIM][DIM], PetscReal B[DIM][DIM], PetscReal out[DIM][DIM]);
void RotationInverse(PetscReal A[DIM][DIM], PetscReal out[DIM][DIM]);
void RotationStraighten(PetscReal turn[DIM][DIM]);
void RotationVector(PetscReal turn[DIM][DIM], PetscReal angle[DIM]);
#define SPEED_MOST 1e5 /* m/s, of a solid: some seventy times the speed of sound in water */
/* MotionSpeed - no point of a solid within these corners (m) at the time 0 is ever faster than this (m/s). */
PetscReal MotionSpeed(Body body, const PetscReal lower[DIM], const PetscReal upper[DIM]);
void      MotionBack(Body body, const PetscReal x[DIM], PetscReal y[DIM]);
/* RegionSetFromOptions - the shape alone: all a region of -fine has. Collective. */
PetscErrorCode RegionSetFromOptions(Body body, const BodyChoices *choices);
PetscErrorCode BodyView(Body body, PetscViewer viewer);
PetscErrorCode BodyDestroy(Body *body);

/* BodyCheckLength - refuses (UserError) a length of 0: its option is missing. Collective. */
PetscErrorCode BodyCheckLength(Body body, const char option[], PetscReal length);
/* BodyOptionsAxis - reads a direction: x, y, z or a vector of any non-zero length; returns the unit vector. axis ([3])
   holds the default on entry. In two dimensions it must lie in the plane, or along z where 'normal_allowed'.
   Collective. */
PetscErrorCode BodyOptionsAxis(Body body, OptionItems PetscOptionsObject, const char option[], const char help[],
                               PetscBool normal_allowed, PetscReal axis[DIM]);

/* BesselSeries - J0(x) and J1(x)/x for q = -x^2/4, I0(x) and I1(x)/x for q = x^2/4 (Abramowitz and Stegun 9.1.10,
   9.6.10), x up to 2 pi. MoveAlong - moves x (m) along a flow of the shape for a time (s), by steps of the Runge-Kutta
   method of fourth order. Not collective. */
typedef void (*ShapeFlow)(const void *shape, const PetscReal x[DIM], PetscReal v[DIM]); /* v (m/s) at x (m) */
void BesselSeries(PetscReal q, PetscReal *order_0, PetscReal *order_1_over_x);
void MoveAlong(const void *shape, ShapeFlow flow, PetscReal time, PetscInt steps, PetscReal x[DIM]);

/* BodyCheckInside - refuses (UserError) a body without a point in the box. SceneCheckOverlap - refuses bodies that
   overlap. Collective. */
PetscErrorCode BodyCheckInside(Body body);
PetscErrorCode SceneCheckOverlap(Scene scene);

#endif
