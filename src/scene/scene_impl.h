/* Private to scene/: the parts of a body. A shape or a velocity field is a table of functions with data in the body. */
#ifndef ISPH_SCENEIMPL_H
#define ISPH_SCENEIMPL_H

#include "body.h"

/* Names of an option, to be freed. */
typedef struct {
  PetscInt count;
  char    *name[SCENE_MAX_BODIES];
} Names;

struct _p_Scene {
  Domain           domain; /* borrowed */
  PetscInt         count;
  Body             body[SCENE_MAX_BODIES];
  PetscInt         solids;
  Body             solid[SCENE_MAX_BODIES];
  PetscInt         fine_regions;
  Body             fine[SCENE_MAX_BODIES];   /* regions of -fine; they have a shape only */
  Properties       own;                      /* of the scene as a whole */
  Body             air;                      /* a hole of no body, with the defaults of its properties */
  PetscBool        overlap;                  /* see SceneBodiesOverlap */
  PetscReal        interface_tension;        /* N/m; 0: the liquids mix */
  PetscInt         liquid[SCENE_MAX_BODIES]; /* 0 or 1, see SceneLiquid */
  void           **force;                    /* [k]: data of Forces[k] */
  PetscReal        uniform[DIM], drive[DIM]; /* m/s2, of the forces that are the same everywhere: all, see SceneDrive */
  PetscBool        varies;                   /* another force is not */
  struct _p_Frame *frame;                    /* NULL: not read */
  PetscReal        time;                     /* of SceneSetTime, s; NAN: not yet set */
  PetscReal        solid_time;               /* of SceneMoveSolids, s */
};

/* The registries: shapes (one file each; shapes.c lists them), velocity fields, viscosity models, types of bodies;
   how solids move, and how they are wetted. The owner of a choice is the body. A type's options are read last, since a
   type may use shape and velocity. */
extern const ShapeOps ShapeBox, ShapeSphere, ShapeStl, ShapeCylinder, ShapeEllipsoid, ShapeHalfSpace, ShapeThread,
  ShapeWave;
extern const BodyTypeOps   BodyTypeEmitter;
extern const MotionOps     SolidMotion;
extern const WettingOps    SolidWetting;
extern const Choice *const Shapes[], *const Velocities[], *const Viscosities[], *const BodyTypes[];

/* BodyMatter - table k of the options that say what a body, solid or hole is made of, and the struct with their values;
   NULL: there are only k. BodyMaterials, BodyViscosities, BodyStart - rows in the
   body: its material, the model of its viscosity, its velocity at the start. Not collective. */
const OptionRow       *BodyMatter(Body body, PetscInt k, const void **data);
extern const OptionRow BodyMaterials[], BodyViscosities[], BodyStart[];

/* MotionData - the data of table k of the options of motions; NULL: the solid has none. Not collective. */
static inline void *MotionData(Body solid, size_t k)
{
  return *(void **)((char *)solid + SolidMotion.data[k]);
}

/* LiquidsSetFromOptions - reads -interface_tension and -interface_bodies, after the bodies' options. Refuses
   (UserError) bodies that do not make two liquids. Collective. */
PetscErrorCode LiquidsSetFromOptions(Scene scene);
/* SceneInterfaceBodies - the names of the bodies of liquid 1, separated by commas. */
PetscErrorCode SceneInterfaceBodies(Scene scene, char names[], size_t length);
/* LiquidsView - prints the interface. Warns if a liquid or gas spreads between the other two. Collective. */
PetscErrorCode LiquidsView(Scene scene, PetscViewer viewer);
/* BodyCreate - creates a body of water at rest that fills the box. BodySetFromOptions - reads the options -<b>_* and
   refuses (UserError) wrong values. Collective. */
PetscErrorCode BodyCreate(Domain domain, const char name[], PetscInt index, Body *body);
PetscErrorCode BodySetFromOptions(Body body);
/* SolidSetFromOptions - reads shape, motion and contact angle of a solid. Collective. */
PetscErrorCode SolidSetFromOptions(Body body);
/* A body force, with data of its own; forces.c lists them. All but the first two members may be NULL. */
typedef struct {
  size_t           size; /* of the data, bytes */
  const OptionRow *rows;
  void (*add)(Domain domain, const void *data, const PetscReal x[DIM], PetscReal g[DIM]); /* to g (m/s2) at x (m) */
  /* its potential (J/kg); NULL: the run counts its work */
  PetscReal (*potential)(Domain domain, const void *data, const PetscReal x[DIM]);
  void (*at)(void *data, PetscReal time);                   /* it is that at a time (s) from now on; NAN: before any */
  PetscBool (*moments)(const void *data, Moments *moments); /* adds its own; whether it depends on the time */
  void (*direction)(const void *data, PetscReal g[DIM]);    /* of a force that is the same everywhere: along it */
  PetscBool (*varies)(const void *data); /* whether any other force is not 0 everywhere; NULL: it is not */
  PetscErrorCode (*check)(Scene scene, void *data);         /* completes; refuses (UserError) contradictions */
} ForceOps;
extern const ForceOps        ForceFrame;
extern const ForceOps *const Forces[];

/* ForcesRead, ForcesCheck, ForcesView, ForcesDestroy - of all body forces. Collective. ForcesJson - the object
   "forces". ForcesMoments - adds the moments of all; whether one depends on the time. Not collective. */
PetscErrorCode ForcesRead(Scene scene, OptionItems items);
PetscErrorCode ForcesCheck(Scene scene);
PetscErrorCode ForcesView(Scene scene, PetscViewer viewer);
PetscErrorCode ForcesDestroy(Scene scene);
PetscErrorCode FrameView(Scene scene, PetscViewer viewer); /* prints the frame if it rotates */
/* FrameKeeps - whether a direction is the same at all times in the frame of reference. Not collective. */
PetscBool FrameKeeps(Scene scene, const PetscReal g[DIM]);
void      ForcesJson(Scene scene, Json *json);
PetscBool ForcesMoments(Scene scene, Moments *moments);
/* ForcesMost - the size of the acceleration at x (m) in each direction, of shaking its amplitude (m/s2). Not
   collective. */
void ForcesMost(Scene scene, const PetscReal x[DIM], PetscReal most[DIM]);
/* RegionSetFromOptions - reads the shape of a region of -fine, or of a hole, and what else
   a hole has. Collective. */
PetscErrorCode RegionSetFromOptions(Body body, PetscBool hole);
PetscErrorCode BodyView(Body body, PetscBool tension, PetscViewer viewer); /* tension: the scene has some */
PetscErrorCode BodyDestroy(Body *body);

/* BodyCheckLength - refuses (UserError) a length of 0, whose option is missing. Collective. */
PetscErrorCode BodyCheckLength(Body body, const char option[], PetscReal length);

/* BesselSeries - J0(x) and J1(x)/x for q = -x^2/4, I0(x) and I1(x)/x for q = x^2/4 (Abramowitz and Stegun 9.1.10,
   9.6.10), x up to 2 pi. MoveAlong - moves x (m) along a flow for a time (s) by 'steps' steps of the fourth-order
   Runge-Kutta method. Not collective. */
typedef void (*ShapeFlow)(const void *shape, const PetscReal x[DIM], PetscReal v[DIM]); /* v (m/s) at x (m) */
void BesselSeries(PetscReal q, PetscReal *order_0, PetscReal *order_1_over_x);
void MoveAlong(const void *shape, ShapeFlow flow, PetscReal time, PetscInt steps, PetscReal x[DIM]);

/* BodyCheckShape - refuses (UserError) a body without a shape, perhaps for a misspelt option, which would fill the box.
   BodyCheckInside - refuses (UserError) a body wholly outside the box. SolidCheckHoles - refuses (UserError) holes of a
   solid that leave a wall without thickness between them. SceneCheckOverlap - refuses (UserError) bodies that overlap.
   Collective. */
PetscErrorCode SolidCheckHoles(Body solid);
PetscErrorCode BodyCheckShape(Body body);
PetscErrorCode BodyCheckInside(Body body);
PetscErrorCode SceneCheckOverlap(Scene scene);

/* Rows that several shapes have; 'type' is the struct of the shape. */
#define ROW_OF_CENTER(type)                                                                                            \
  {                                                                                                                    \
    "-center",                                                                                                         \
      "Center of a sphere, a cylinder or an ellipsoid; of a thread a point on its axis at a crest of its waves", "m",  \
      NULL, ROW_POINT, offsetof(type, center)                                                                          \
  }
#define ROW_OF_RADIUS(type)                                                                                            \
  {                                                                                                                    \
    "-radius", "Radius of a sphere, a cylinder or a thread", "m", "(0, inf)", ROW_REAL, offsetof(type, radius),        \
      .fallback = OPTION_REQUIRED                                                                                      \
  }
#define ROW_OF_LOWER(type)                                                                                             \
  {                                                                                                                    \
    "-lower", "Lower corner of a box, or of the box of a wave", "m", NULL, ROW_POINT, offsetof(type, lower),           \
      .fallback = "-box_lower"                                                                                         \
  }
#define ROW_OF_UPPER(type)                                                                                             \
  {                                                                                                                    \
    "-upper", "Upper corner of a box, or of the box of a wave, whose last number is the mean level", "m", NULL,        \
      ROW_POINT, offsetof(type, upper), .fallback = "-box_upper"                                                       \
  }
#define ROW_OF_AMPLITUDE(type)                                                                                         \
  {                                                                                                                    \
    "-wave_amplitude",                                                                                                 \
      "Amplitude of a wave on a sphere, outwards at the upper pole, which conserves the volume; or of the waves on "   \
      "the radius of a thread",                                                                                        \
      "m", NULL, ROW_REAL, offsetof(type, amplitude)                                                                   \
  }

#endif
