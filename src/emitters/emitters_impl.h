/* Private to emitters/: bodies that bring liquid during the run, a type of body and an edge of the step. */
#ifndef ISPH_EMITTERS_IMPL_H
#define ISPH_EMITTERS_IMPL_H

#include "../gauges/gauges.h"
#include "../packing/samples.h"
#include "../stepper/edge.h"

/* EmissionShift - the displacement (m) of the liquid of filling k = 0, 1, ... of an emitter at a time (s) if the liquid
   keeps the emitter's velocity. Not collective. */
void EmissionShift(Body body, PetscInt k, PetscReal time, PetscReal shift[DIM]);
/* EmissionIsJet - whether an emitter's fillings follow each other without gaps, along an axis, *along. Not
   collective. */
PetscBool EmissionIsJet(Body body, PetscInt *along);

/* The points of an emitter, which it brings at each emission; of each body of a scene. Zero at the start. */
typedef struct {
  PetscInt   n, done; /* points; emissions so far */
  PetscReal *x;       /* [n][3] m; NULL: not yet known */
  PetscReal  area;    /* of each point, as in Sample */
  PetscInt   along;   /* axis of the jet */
  PetscReal  stretch; /* of its train of points along it, see EmissionPoint */
} Emission;
typedef struct {
  Emission of[SCENE_MAX_BODIES];
} Emissions;

/* EmissionsAdd - adds to the swarm the liquid that emitters have brought since the last call, up to the time (s), and
   gives the liquid inside an emitter the emitter's velocity. resumed: the first call of a continued run, which only
   counts what emitters brought before. *emitted: new particles over all ranks; if there are any, ends with CloudResync.
   Collective. EmissionVolume - the volume (m3, in two dimensions m2) of one filling, after it, of a jet in the mean.
   EmissionPoint - the place (m) of point p of an emitter in filling k; copy: 0, 1: a filling has the point so often at
   most. A lattice in a nozzle of a few spacings has up to a quarter too much or too little of its cross-section. So a
   jet is a train of points stretched by that share, of which a filling takes what is in it: a row more or less. False:
   the filling has none. Not collective. */
PetscErrorCode EmissionsAdd(Emissions *emissions, Cloud cloud, Packing packing, PetscReal time, PetscBool resumed,
                            PetscInt *emitted);
PetscReal      EmissionVolume(const Emission *emission, Domain domain);
PetscBool EmissionPoint(const Emission *emission, Body body, PetscInt k, PetscInt p, PetscInt copy, PetscReal x[DIM]);
PetscErrorCode EmissionsDestroy(Emissions *emissions);

#endif
