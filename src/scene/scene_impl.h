/* Private to scene/: what a body is made of. A shape or velocity field is a table of functions with data of its own in
   the body. */
#ifndef ISPH_SCENEIMPL_H
#define ISPH_SCENEIMPL_H

#include "scene.h"

#define SCENE_NAME_LENGTH 64

/* An initial velocity field, added to the uniform part -<b>_velocity. */
typedef struct {
  size_t size;                                                                 /* of the data, bytes */
  PetscErrorCode (*setfromoptions)(Body body, OptionItems PetscOptionsObject); /* NULL: no numbers */
  void (*add)(Body body, const PetscReal x[DIM],
              PetscReal v[DIM]); /* adds its velocity (m/s) at x (m) to v; NULL: zero */
} VelocityOps;

/* PetscFunctionList holds functions: each type is registered as one that returns its table. */
typedef const ShapeOps *(*ShapeTable)(void);
typedef const VelocityOps *(*VelocityTable)(void);

struct _p_Body {
  Domain             domain; /* borrowed */
  char               name[SCENE_NAME_LENGTH];
  char               prefix[SCENE_NAME_LENGTH + 1]; /* of its options: the name and an underscore */
  char               shape_type[SCENE_NAME_LENGTH];
  char               velocity_type[SCENE_NAME_LENGTH];
  const ShapeOps    *shape;
  const VelocityOps *velocity;
  void              *shape_data; /* of the shape's own struct, allocated by its setfromoptions, freed with PetscFree */
  void              *velocity_data; /* as shape_data */
  PetscReal          uniform[DIM];  /* uniform part of the velocity, m/s */
  Material           material;
  char               type[SCENE_NAME_LENGTH];
  void              *emitter; /* of an emitter, freed with PetscFree; NULL: liquid */
  PetscInt           color;
};

struct _p_Scene {
  Domain    domain; /* borrowed */
  PetscInt  count;
  Body      body[SCENE_MAX_BODIES];
  PetscInt  solids;
  Body      solid[SCENE_MAX_BODIES];
  PetscReal gravity[DIM];                      /* m/s2 */
  PetscReal central_rate;                      /* 1/s */
  PetscReal amplitude[DIM], angular_frequency; /* of the part of gravity that swings, m/s2, rad/s */
  PetscReal shake[DIM];                        /* that part at the time set last, m/s2 */
};

/* The tables of the shapes, one file each; registered in scene.c. */
const ShapeOps *ShapeBox(void);
const ShapeOps *ShapeSphere(void);
const ShapeOps *ShapeStl(void);
const ShapeOps *ShapeCylinder(void);
const ShapeOps *ShapeEllipsoid(void);
const ShapeOps *ShapeHalfSpace(void);
const ShapeOps *ShapeThread(void);
const ShapeOps *ShapeWave(void);

/* A type of body reads its options inside an options block, after shape and velocity; liquid has none. */
typedef PetscErrorCode (*BodyType)(Body body, OptionItems PetscOptionsObject);
PetscErrorCode BodyTypeLiquid(Body body, OptionItems PetscOptionsObject);
PetscErrorCode BodyTypeEmitter(Body body, OptionItems PetscOptionsObject);

/* VelocityRegisterAll - adds the velocity fields of velocity.c to a list. Not collective. */
PetscErrorCode VelocityRegisterAll(PetscFunctionList *list);

/* BodyCreate - a body of water at rest that fills the box, to be set by its options. BodySetFromOptions - reads all of
   -<b>_*; shapes and velocities are the lists of registered types. Refuses (UserError) what SceneSetFromOptions says of
   one body. Collective. */
PetscErrorCode BodyCreate(Domain domain, const char name[], PetscInt index, Body *body);
PetscErrorCode BodySetFromOptions(Body body, PetscFunctionList types, PetscFunctionList shapes,
                                  PetscFunctionList velocities);
/* SolidSetFromOptions - the shape alone: all a solid has. Collective. */
PetscErrorCode SolidSetFromOptions(Body body, PetscFunctionList shapes);
PetscErrorCode BodyView(Body body, PetscViewer viewer);
PetscErrorCode BodyDestroy(Body *body);

/* BodyOptionsLength - reads a length (m) that must be given, positive and finite. Collective. */
PetscErrorCode BodyOptionsLength(Body body, OptionItems PetscOptionsObject, const char option[], const char help[],
                                 PetscReal *length);
/* BodyOptionsAxis - reads a direction: x, y, z or a vector of any non-zero length; returns the unit vector. axis ([3])
   holds the default on entry. In two dimensions it must lie in the plane, or along z where 'normal_allowed'.
   Collective. */
PetscErrorCode BodyOptionsAxis(Body body, OptionItems PetscOptionsObject, const char option[], const char help[],
                               PetscBool normal_allowed, PetscReal axis[DIM]);

/* SceneLatticeSearch - looks for a point where both bodies' signed distance is below a bound (m): among the centres of
   the lattice cells of the particle spacing, counted from the lower corner of the box, that the intersection of the two
   bodies' bounds touches. The two may be one body. Skips what the distances exclude. Returns whether there is one, and
   the point x (m). Not collective. */
PetscBool SceneLatticeSearch(Body a, Body b, PetscReal bound, PetscReal x[DIM]);

#endif
