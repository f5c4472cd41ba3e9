/* Floor 8: joining and splitting of particles during a run. Sums over neighbours are accurate as long as neighbours
   have similar volumes in the sums. A ring enters with its cross-section area, its volume over its length, so the area
   shrinks in a crown and grows in a jet. At an interval
     a ring with too small an area joins its nearest neighbour, and
     a ring with too large an area splits, in the direction of the widest gap between its neighbours.
   If the spacing adapts, all particles do the same with their volume over that of the spacing wanted at their place,
   their share, and those that stand unevenly after it move a little (smooth.c).
   Other graded particles keep their volumes, but a splash throws small particles among large particles. These push a
   small particle about like a molecule and accelerate it: a small particle without others of its size joins its nearest
   larger neighbour.
   Mass of each liquid, momentum and centre of mass are kept to round-off; the liquid of the first body is kept as the
   colour of particles that have joined across bodies. A report counts the loss of kinetic energy.
   Distances and ids decide, so the result is the same on any number of ranks. */
#ifndef ISPH_RESAMPLING_H
#define ISPH_RESAMPLING_H

#include "../operators/operators.h"

typedef struct {
  PetscInt  interval;    /* steps between two resamplings; 0: never */
  PetscReal alone;       /* a graded particle joins if liquid of its size fills less than this part of its support */
  PetscReal least, most; /* shares below which a particle joins, and above which it splits */
} Resampling;

typedef struct {
  PetscInt  joined, split; /* particles removed by joining, added by splitting */
  PetscReal energy;        /* loss of kinetic energy, J */
} ResamplingReport;

/* ResamplingSetFromOptions - reads -resampling_interval, and for graded particles -resampling_alone. Scenes with equal
   volumes have neither. Collective. */
PetscErrorCode ResamplingSetFromOptions(Cloud cloud, Resampling *resampling);
/* ResamplingArea - the ring area of particle a over V_0. ResamplingDue - whether to resample after this step: at the
   interval, and in any step whose largest ring area, 'largest', exceeds twice MOST (resampling_impl.h). Not collective.
 */
PetscReal ResamplingArea(Cloud cloud, PetscInt a);
PetscBool ResamplingDue(const Resampling *resampling, PetscInt step, PetscReal largest);
/* Resample - joins and splits at the end of an accepted step. The cloud must still hold the step's neighbours, moments
   and velocity gradient. Ends with CloudResync if a particle joined or split. Collective. */
PetscErrorCode Resample(Cloud cloud, const Resampling *resampling, ResamplingReport *report);

#endif
