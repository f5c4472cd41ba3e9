/* Floor 5: joining and splitting of particles while a run goes on. Where volumes may differ, sums over neighbours are
   right as long as the shares of neighbours are alike. Rings do not keep theirs: the ring area is the volume over the
   ring's length, so it shrinks in a crown and grows in a jet. Now and then
     a particle whose share is too small becomes one with its nearest neighbour, and
     one whose share is too large becomes two, where the gap between its neighbours is widest.
   Graded particles that are no rings keep their volumes, but a splash throws small ones among large ones, where they
   are pushed about like molecules, faster and faster: one that is alone there becomes one with the nearest larger one.
   Mass and momentum are kept to round-off, each kind of liquid and the place of the mass too; the kinetic energy that
   this takes is counted. Which particles join follows from their distances and ids, so it is the same on any number of
   ranks. */
#ifndef ISPH_RESAMPLING_H
#define ISPH_RESAMPLING_H

#include "../operators/operators.h"

typedef struct {
  PetscInt  interval; /* steps from one time to the next; 0: never */
  PetscReal alone;    /* of graded particles: share of liquid of their size in the support that asks for joining */
} Resampling;

/* What was done. */
typedef struct {
  PetscInt  joined, split; /* particles that are gone, that are new */
  PetscReal energy;        /* kinetic energy lost by it, J */
} ResamplingReport;

/* ResamplingSetFromOptions - -resampling_interval, and -resampling_alone of graded particles; nothing to read where all
 * volumes are the same. Collective. */
PetscErrorCode ResamplingSetFromOptions(Cloud cloud, Resampling *resampling);
/* ResamplingShare - the ring area of particle a over V_0. ResamplingDue - whether to join and split after this step, in
   which 'largest' is the largest share: at the interval, and at once where it is more than twice the most. Not
   collective. */
PetscReal ResamplingShare(Cloud cloud, PetscInt a);
PetscBool ResamplingDue(const Resampling *resampling, PetscInt step, PetscReal largest);
/* Resample - joins and splits at the end of an accepted step, whose neighbours, moments and velocity gradient the cloud
   still has; ends with CloudResync if anything was done. Collective. */
PetscErrorCode Resample(Cloud cloud, const Resampling *resampling, ResamplingReport *report);

#endif
