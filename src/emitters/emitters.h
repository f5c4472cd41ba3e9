/* Floor 9: emitters, bodies that bring liquid during the run: a type of body and an edge of the step. */
#ifndef ISPH_EMITTERS_H
#define ISPH_EMITTERS_H

#include "../gauges/gauges.h"
#include "../packing/samples.h"
#include "../stepper/edge.h"

#define EMITTERS_EDGE "emitters" /* the name of the edge */

/* BodyEmissions - the number of fillings of an emitter up to and at a time (s). BodyEmissionShift - the displacement
   (m) of the liquid of filling k = 0, 1, ... at a time (s) if the liquid keeps the emitter's velocity.
   BodyEmissionVelocity
   - that velocity v (m/s) at x (m). Not collective. */
PetscInt BodyEmissions(Body body, PetscReal time);
void     BodyEmissionShift(Body body, PetscInt k, PetscReal time, PetscReal shift[DIM]);
void     BodyEmissionVelocity(Body body, PetscReal time, const PetscReal x[DIM], PetscReal v[DIM]);

/* The points of an emitter, which it brings at each emission; of each body of a scene. Zero at the start. */
typedef struct {
  PetscInt   n, done; /* points; emissions so far */
  PetscReal *x;       /* [n][3] m; NULL: not yet known */
  PetscReal  area;    /* of each point, as in Sample */
} Emission;
typedef struct {
  Emission of[SCENE_MAX_BODIES];
} Emissions;

/* EmissionsAdd - adds to the swarm the liquid that emitters have brought since the last call, up to the time (s), and
   gives the liquid inside an emitter the emitter's velocity. resumed: the first call of a continued run, which only
   counts what emitters brought before. *emitted: new particles over all ranks; if there are any, ends with CloudResync.
   Collective. EmissionsCount - how many particles emitters have brought up to and at the time (s), after the first
   EmissionsAdd. EmissionsVolume - volume (m3, in two dimensions m2) of the particles of one filling of an emitter, the
   body of this index, after the first EmissionsAdd: over that of its shape, it is the emitter's flux over the one of
   its options. Not collective. */
PetscErrorCode EmissionsAdd(Emissions *emissions, Cloud cloud, Packing packing, PetscReal time, PetscBool resumed,
                            PetscInt *emitted);
PetscReal      EmissionsCount(const Emissions *emissions, Scene scene, PetscReal time);
PetscReal      EmissionsVolume(const Emissions *emissions, Domain domain, PetscInt body);
PetscErrorCode EmissionsDestroy(Emissions *emissions);
/* EmittersOf - those of a run. Not collective. EmittersBring - adds the liquid that emitters bring up to the state's
   time, and its energy to the state: the work, too, that keeps liquid inside emitters moving. Collective. */
Emissions     *EmittersOf(Stepper stepper);
PetscErrorCode EmittersBring(Stepper stepper, Packing packing, Gauges gauges, StepState *state);

#endif
