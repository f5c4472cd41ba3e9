/* Private to emitters/: bodies that bring liquid during the run, a type of body and an edge of the step. */
#ifndef ISPH_EMITTERS_IMPL_H
#define ISPH_EMITTERS_IMPL_H

#include "../gauges/gauges.h"
#include "../packing/samples.h"
#include "../stepper/edge.h"

/* EmissionShift - the displacement (m) of the liquid of filling k of an emitter at a time (s) if the liquid keeps the
   emitter's velocity; 1/2 is half an interval after filling 0. Not collective. */
void EmissionShift(Body body, PetscReal k, PetscReal time, PetscReal shift[DIM]);
/* EmissionIsJet - whether an emitter's fillings follow each other without gaps, along an axis, *along. Not
   collective. */
PetscBool EmissionIsJet(Body body, PetscInt *along);

/* The points of an emitter, which it brings at each emission; of each body of a scene. Zero at the start. */
typedef struct {
  PetscInt   n;       /* points */
  PetscReal *x;       /* [n][3] m; NULL: not yet known */
  PetscReal *way;     /* [n] 1, of EmissionWay */
  PetscInt  *done;    /* [n] particles so far */
  PetscReal  area;    /* of each point, as in Sample */
  PetscInt   along;   /* axis of the jet */
  PetscReal  stretch; /* of its train of points along it */
} Emission;

/* An emitter whose fillings follow each other without gaps and whose shape is a prism along its velocity is always
   full: a particle of the next filling comes as soon as there is room for it behind those before, not with the filling
   as a whole. A lattice in a nozzle of a few spacings has up to a quarter too much or too little of its cross-section.
   So the liquid is a train of points stretched by that share. EmissionWay - the way from the point x (m) of the shape
   to its front, over its length; -1: the emitter brings its fillings as a whole. EmissionCount - how many particles of
   point p have come up to and at a time (s). EmissionFilling - k of EmissionShift for the k-th of them. Not collective.
 */
PetscReal EmissionWay(Body body, const PetscReal x[DIM]);
PetscInt  EmissionCount(const Emission *emission, Body body, PetscReal time, PetscInt p);
PetscReal EmissionFilling(const Emission *emission, PetscInt k, PetscInt p);

/* A particle that pushes in a step. */
typedef struct {
  PetscInt  a;
  PetscReal v[DIM], x[DIM]; /* m/s, m, at the end of the step */
} Pushed;
typedef struct {
  Emission  of[SCENE_MAX_BODIES];
  PetscBool full;            /* liquid has no way out */
  PetscBool frozen;          /* the packing relaxes */
  PetscBool held;            /* in this step implicit viscosity holds what pushes: the former pressure acts */
  PetscBool half;            /* the sums of the step are in its middle, not at its start */
  PetscInt *pushing;         /* [capacity], see Cloud */
  Pushed   *pushed;          /* [count] */
  PetscInt  capacity, count; /* capacity: of both */
  PetscReal work;            /* J, of this rank in the step: what keeps the liquid at its velocity */
} Emissions;

/* EmissionsAdd - adds to the swarm the liquid that emitters have brought since the last call, up to the time (s), and
   gives the liquid inside an emitter the emitter's velocity. resumed: the first call of a continued run, which only
   counts what emitters brought before. *emitted: new particles over all ranks; if there are any, ends with CloudResync.
   Collective. EmissionVolume - the volume (m3, in two dimensions m2) of one filling, after it, of a jet in the mean.
   Not collective. */
PetscErrorCode EmissionsAdd(Emissions *emissions, Cloud cloud, Packing packing, PetscReal time, PetscBool resumed,
                            PetscInt *emitted);
PetscReal      EmissionVolume(const Emission *emission, Domain domain);
PetscErrorCode EmissionsDestroy(Emissions *emissions);

#endif
