/* Private to scene/: the parts of a body. A shape or a velocity field is a table of functions with data in the body. */
#ifndef ISPH_SCENEIMPL_H
#define ISPH_SCENEIMPL_H

#include "scene.h"

#define SCENE_NAME_LENGTH OPTION_WORD_LENGTH
#define BODY_HOLES_MOST   16

/* A shape. */
typedef struct {
  Choice choice;
  /* Signed distance of x (m), negative inside. The sign is exact; the absolute value may be less than the distance. */
  PetscReal (*distance)(Body body, const PetscReal x[DIM]);
  void (*bounds)(Body body, PetscReal lower[DIM], PetscReal upper[DIM]); /* bounds of the shape, m */
  void (*displace)(Body body, PetscReal x[DIM]);                         /* see BodyDisplace; NULL: not at all */
  PetscReal (*wave)(Body body); /* wavelength of the surface, m; 0 or NULL: no waves */
} ShapeOps;

/* An initial velocity field, added to the uniform part -<b>_velocity. */
typedef struct {
  Choice choice;
  void (*add)(Body body, const PetscReal x[DIM], PetscReal v[DIM]); /* adds to v (m/s) at x (m); NULL: zero */
} VelocityOps;

/* A viscosity model. */
typedef struct {
  Choice choice;
  PetscReal (*at)(Body body, PetscReal rate); /* mu (Pa s) at a shear rate (1/s); NULL: constant */
} ViscosityOps;

/* Moments of SceneMoments. MomentAdd - adds a time (s) if it lies in the run and there is room. MomentPeriod - adds the
   eighths of the first period of an oscillation with this frequency (Hz; 0: none) from a time (s): where it and its
   rate are extreme, and between. Not collective. */
typedef struct {
  PetscReal  start, end; /* s, of the run */
  PetscInt   most, n;
  PetscReal *time; /* [n] s */
} Moments;

static inline void MomentAdd(Moments *moments, PetscReal time)
{
  for (PetscInt k = 0; k < moments->n; k++)
    if (moments->time[k] == time) return;
  if (time >= moments->start && time <= moments->end && moments->n < moments->most) moments->time[moments->n++] = time;
}

static inline void MomentPeriod(Moments *moments, PetscReal frequency, PetscReal start)
{
  for (PetscInt k = 0; k < 8 && frequency > 0; k++)
    MomentAdd(moments, PetscMax(start, moments->start) + k / (8 * frequency));
}

/* A type of body. Liquid that is there from the start has none of these functions. */
typedef struct {
  Choice choice;
  PetscBool (*holds)(Body body, const PetscReal x[DIM], PetscReal behind); /* see BodyHolds */
  void (*moments)(Body body, Moments *moments);                            /* adds those of the body */
} BodyTypeOps;

struct _p_Body {
  Domain              domain; /* borrowed */
  char                name[SCENE_NAME_LENGTH];
  char                prefix[SCENE_NAME_LENGTH + 1]; /* of the options: the name and an underscore */
  char                shape_type[SCENE_NAME_LENGTH];
  char                velocity_type[SCENE_NAME_LENGTH];
  const ShapeOps     *shape;
  const VelocityOps  *velocity;
  void               *shape_data; /* the shape's own struct, freed with PetscFree */
  PetscInt            holes;
  struct _p_Body     *hole[BODY_HOLES_MOST]; /* shapes that are cut out; they have a shape only */
  void               *velocity_data;         /* as shape_data */
  char                viscosity_type[SCENE_NAME_LENGTH];
  const ViscosityOps *viscosity;      /* NULL of a solid */
  void               *viscosity_data; /* as shape_data */
  PetscReal           uniform[DIM];   /* uniform part of the velocity, m/s */
  Material            material;
  char                type[SCENE_NAME_LENGTH];
  const BodyTypeOps  *kind;               /* NULL of a solid */
  void               *emitter;            /* data of the type, as shape_data; NULL: liquid from the start */
  PetscReal           contact_angle;      /* of a solid, degrees; 0: none */
  PetscReal           contact_hysteresis; /* of a solid, degrees */
  struct _p_Motion   *motion;             /* of a solid that can move; else NULL */
  struct _p_Free     *free;               /* of a free body; else NULL */
};

/* The spacing that -spacing_follow wants, in cells over the box: see spacing.c. */
typedef struct {
  PetscInt       n[DIM], count;    /* of cells */
  PetscReal      lower[DIM], size; /* m */
  float         *value;            /* [count] m; NULL: nothing is followed */
  unsigned char *liquid;           /* [count] 1: there is liquid in the cell */
} SpacingTarget;

struct _p_Scene {
  Domain        domain; /* borrowed */
  PetscInt      count;
  Body          body[SCENE_MAX_BODIES];
  PetscInt      solids;
  Body          solid[SCENE_MAX_BODIES];
  PetscInt      fine_regions;
  Body          fine[SCENE_MAX_BODIES]; /* regions of -fine; they have a shape only */
  SpacingTarget target;
  PetscBool     overlap;                            /* see SceneBodiesOverlap */
  PetscReal     interface_tension;                  /* N/m; 0: the liquids mix */
  PetscInt      liquid[SCENE_MAX_BODIES];           /* 0 or 1, see SceneLiquid */
  PetscReal     gravity[DIM];                       /* m/s2 */
  PetscReal     central_rate;                       /* 1/s */
  PetscReal     amplitude[DIM];                     /* of the oscillating part of gravity, m/s2 */
  PetscReal     angular_frequency, phase;           /* of that part, rad/s, degrees */
  OptionNumbers frame_given;                        /* -frame_rotation_rate */
  PetscReal     frame_rate[DIM], frame_center[DIM]; /* rad/s, m */
  PetscReal     solid_time;                         /* of SceneMoveSolids, s */
  PetscReal     shake[DIM];                         /* oscillating part of gravity at the time of SceneSetTime, m/s2 */
};

/* The registries: shapes (one file each; shapes.c lists them), velocity fields, viscosity models, types of bodies. The
   owner of a choice is the body. A type's options are read last, since a type may use shape and velocity. */
extern const ShapeOps ShapeBox, ShapeSphere, ShapeStl, ShapeCylinder, ShapeEllipsoid, ShapeHalfSpace, ShapeThread,
  ShapeWave;
extern const BodyTypeOps   BodyTypeEmitter;
extern const Choice *const Shapes[], *const Velocities[], *const Viscosities[], *const BodyTypes[];

/* DistanceNormal - the unit normal n from differences of a signed distance around x (m); zero where these vanish.
   which: passed on to the distance. SceneOwnDistance is one of these functions. */
typedef PetscReal (*SceneDistance)(Scene scene, PetscInt which, const PetscReal x[DIM]);
void DistanceNormal(Scene scene, SceneDistance distance, PetscInt which, const PetscReal x[DIM], PetscReal n[DIM]);
/* LiquidsSetFromOptions - reads -interface_tension and -interface_bodies, after the bodies' options. Refuses
   (UserError) bodies that do not make two liquids. Collective. */
PetscErrorCode LiquidsSetFromOptions(Scene scene);
/* SceneInterfaceBodies - the names of the bodies of liquid 1, separated by commas. */
PetscErrorCode SceneInterfaceBodies(Scene scene, char names[], size_t length);
/* LiquidsView - prints the interface. Warns if a liquid or gas spreads between the other two. Collective. */
PetscErrorCode LiquidsView(Scene scene, PetscViewer viewer);
/* BodyCreate - creates a body of water at rest that fills the box. BodySetFromOptions - reads the options -<b>_* and
   refuses (UserError) wrong values. BodyHelp - makes -help list the options, see SceneHelp. Collective. */
PetscErrorCode BodyCreate(Domain domain, const char name[], PetscInt index, Body *body);
PetscErrorCode BodySetFromOptions(Body body);
PetscErrorCode BodyHelp(MPI_Comm comm);
/* SolidSetFromOptions - reads shape, motion and contact angle of a solid. Collective. */
PetscErrorCode SolidSetFromOptions(Body body);
/* MotionSetFromOptions - creates the motion of a solid from its options, which are those of two tables. MotionSetUp -
   refuses (UserError) options that contradict each other, and destroys the motion of a fixed solid. MotionView - prints
   the motion. Collective. MotionSetTime - sets the time (s). MotionBack - finds the position y (m) at the time 0 of the
   solid's point that is at x (m) at the time of MotionSetTime. MotionMoments - adds the moments of the motion. Not
   collective. */
extern const OptionRow MotionOptions[], FreeOptions[];
PetscErrorCode         MotionSetFromOptions(Body body, OptionItems PetscOptionsObject);
PetscErrorCode         MotionSetUp(Body body);
PetscErrorCode         MotionView(Body body, PetscViewer viewer);
PetscErrorCode         MotionDestroy(Body body);
void                   MotionSetTime(Body body, PetscReal time);
void                   MotionMoments(Body body, Moments *moments);
/* RateCheck - completes the numbers of -<prefix>rotation_rate to a vector (rad/s), zero without numbers, and refuses
   (UserError) numbers that are no angular velocity. Collective. */
PetscErrorCode RateCheck(Domain domain, const char prefix[], const OptionNumbers *given, PetscReal rate[DIM]);
/* FrameCheck - completes the angular velocity of the frame, and refuses (UserError) gravity and faces that are not
   constant in the rotating frame. FrameView - prints the frame if it rotates. Collective. FrameAdd - adds the
   centrifugal acceleration at x (m) to g (m/s2). FramePotential - the centrifugal potential (J/kg) at x (m). Not
   collective. */
PetscErrorCode FrameCheck(Scene scene);
void           FrameAdd(Scene scene, const PetscReal x[DIM], PetscReal g[DIM]);
PetscReal      FramePotential(Scene scene, const PetscReal x[DIM]);
PetscErrorCode FrameView(Scene scene, PetscViewer viewer);
/* FreeSetFromOptions - reads -<s>_mass, -<s>_inertia and -<s>_turns. FreeSetUp - refuses (UserError) options that
   contradict each other, and removes the free body if its mass is 0. center (m): the centre of mass, given if
   'centered', else computed; velocity (m/s), rate (rad/s): at the start. FreeCheck - refuses (UserError) a mass, a
   moment of inertia or a centre of mass out of range; density: the largest one of the liquids (kg/m3). FreeView -
   prints the free body. Collective. FreePose - translation (m) and rotation matrix of a free body at a time (s).
   FreeVelocity - velocity (m/s) and angular velocity (rad/s) since the last FreePush. FreeSetTime - sets the pose from
   which FreeMotion and FreeResponse start. Not collective. */
PetscErrorCode FreeSetFromOptions(Body body, OptionItems PetscOptionsObject);
PetscErrorCode FreeCheck(Body body, PetscReal density);
PetscErrorCode FreeSetUp(Body body, PetscBool centered, PetscReal center[DIM], const PetscReal velocity[DIM],
                         const PetscReal rate[DIM]);
PetscErrorCode FreeView(Body body, PetscViewer viewer);
void           FreePose(Body body, PetscReal time, PetscReal shift[DIM], PetscReal turn[DIM][DIM]);
void           FreeVelocity(Body body, PetscReal velocity[DIM], PetscReal rate[DIM]);
void           FreeSetTime(Body body, const PetscReal shift[DIM], PetscReal turn[DIM][DIM]);
/* RotationMatrix - the matrix of a rotation with an angular velocity (rad/s) for a time (s). RotationMultiply - out = A
   B. RotationInverse - the inverse of A. RotationStraighten - orthonormalises a rotation matrix with rounding errors.
   RotationVector - the axis times the angle (rad, at most pi) of a rotation matrix. Not collective. */
void RotationMatrix(const PetscReal rate[DIM], PetscReal time, PetscReal turn[DIM][DIM]);
void RotationMultiply(PetscReal A[DIM][DIM], PetscReal B[DIM][DIM], PetscReal out[DIM][DIM]);
void RotationInverse(PetscReal A[DIM][DIM], PetscReal out[DIM][DIM]);
void RotationStraighten(PetscReal turn[DIM][DIM]);
void RotationVector(PetscReal turn[DIM][DIM], PetscReal angle[DIM]);
#define SPEED_MAX 1e5 /* m/s, of a solid: some seventy times the speed of sound in water */
/* MotionSpeed - an upper bound of the speed (m/s) of a solid's points that are within these bounds (m) at the time 0.
   Not collective. */
PetscReal MotionSpeed(Body body, const PetscReal lower[DIM], const PetscReal upper[DIM]);
void      MotionBack(Body body, const PetscReal x[DIM], PetscReal y[DIM]);
/* RegionSetFromOptions - reads the shape of a region of -fine, or of a hole. Collective. ShapeDistance - signed
   distance (m) of x (m) to the shape less its holes, at the time 0. Not collective. */
PetscErrorCode RegionSetFromOptions(Body body);
PetscReal      ShapeDistance(Body body, const PetscReal x[DIM]);
PetscErrorCode BodyView(Body body, PetscViewer viewer);
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
   BodyCheckInside - refuses (UserError) a body wholly outside the box. SceneCheckOverlap - refuses (UserError) bodies
   that overlap. Collective. */
PetscErrorCode BodyCheckShape(Body body);
PetscErrorCode BodyCheckInside(Body body);
PetscErrorCode SceneCheckOverlap(Scene scene);

#endif
