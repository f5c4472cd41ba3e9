/* Private to bodies/: bodies that move freely, an edge of the step. */
#ifndef ISPH_BODIES_IMPL_H
#define ISPH_BODIES_IMPL_H

#include "../gauges/columns.h"
#include "bodies.h"

/* A free body that two others (or walls: negative) hit at once. */
typedef struct {
  PetscBool seen;
  PetscInt  body, by[2];
} HitTogether;

/* The data of FreeEdge. */
typedef struct {
  HitTogether         hit;                                    /* the first one of the run */
  PetscReal           drag[RIGID_MOTIONS * SCENE_MAX_BODIES]; /* of viscosity and stress on each free solid, N, N m */
  PetscReal           impulse[RIGID_MOTIONS * SCENE_MAX_BODIES]; /* of 'push' in this step, N s, N m s */
  PetscReal           contact[RIGID_MOTIONS * SCENE_MAX_BODIES]; /* impulses of contacts in this step, N s, N m s */
  PetscReal           follow[RIGID_MOTIONS * RIGID_MOTIONS * SCENE_MAX_BODIES]; /* the inverses of FreeViscousHold */
  Cloud               cloud;                                                    /* borrowed */
  PetscInt            couplings;                                                /* free solids */
  struct _p_Coupling *coupling;                                                 /* [couplings], coupling.c */
} FreeData;

/* FreeSetVelocities - sets velocity ([n_owned][3], m/s) of the dummy particles of a free solid, by its index, to that
   of a motion. Not collective. FreeSum - sum[solids][RIGID_MOTIONS]: force and torque on each free solid, over all
   ranks, from the forces each ([n_total][3], N) on dummy particles; 0 for other solids. normal ([n_total][3]): see
   FreeAddForce, or NULL. FreeViscousHold, FreeViscousFollow, FreeViscousDrag - the hooks. Collective. */
void FreeSetVelocities(Cloud cloud, PetscInt solid, const PetscReal motion[RIGID_MOTIONS], PetscReal velocity[]);
PetscErrorCode FreeSum(Cloud cloud, const PetscReal each[], const PetscReal normal[], PetscReal sum[]);
PetscErrorCode FreeViscousHold(const Step *step);
PetscErrorCode FreeViscousFollow(const Step *step, PetscBool own, PetscReal u[]);
PetscErrorCode FreeViscousDrag(const Step *step, const PetscReal velocity[]);

/* FreeTouch - changes the motions of the free bodies, motion[solids][RIGID_MOTIONS], so that they do not enter walls,
   solids and each other in a step of dt (s) that ends at a time (s), nor close a gap of a spacing within 'leave' (s),
   nor leave an overlap faster than in steps of 'usual' (s), and gives sum[solids][RIGID_MOTIONS] the impulses (N s, N m
   s) that do it; the same on every rank. before: the motions at the start of the step, from which they rebound. hit: is
   set, unless it has been seen before. Collective. FreeFriction, FreeRestitution - the coefficients of a free body. Not
   collective. */
PetscErrorCode FreeTouch(Cloud cloud, PetscReal time, PetscReal dt, PetscReal usual, PetscReal leave,
                         const PetscReal before[], PetscReal motion[], PetscReal sum[], HitTogether *hit);
PetscReal      FreeFriction(Body solid);
PetscReal      FreeRestitution(Body solid);

/* BodyMovesAs - whether two solids have the same motion. BodyMove - moves a point x (m) with the solid from the time
   'from' to the time 'to' (s). Not collective. */
PetscBool BodyMovesAs(Body solid, Body other);
void      BodyMove(Body solid, PetscReal from, PetscReal to, PetscReal x[DIM]);

extern const OptionRow FreeOptions[];
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

/* SolidsMove - the hook 'drift' of solids that move and of their dummy particles. Not collective. */
PetscErrorCode SolidsMove(Cloud cloud, PetscReal from, PetscReal to, PetscReal end);

/* CouplingCreate - couples the free solids to the equation of the pressure, if there are any. CouplingForces - force
   and torque [couplings][RIGID_MOTIONS] (N, N m) of the cloud's pressure on each free solid, as in the equation, and of
   what else is beside it (PressureLoad).
   Collective. */
PetscErrorCode CouplingCreate(FreeData *data, Cloud cloud, Pressure pressure);
PetscErrorCode CouplingForces(FreeData *data, Pressure pressure, PetscReal force[]);
PetscErrorCode CouplingDestroy(FreeData *data);

extern const GaugeKind GaugeBodies; /* gauge.c */

#endif
