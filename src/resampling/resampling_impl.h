/* Private to resampling/: joining and splitting of particles during a run, an edge. Sums over neighbours are accurate
   as long as neighbours have similar volumes in the sums. A ring enters with its cross-section area, its volume over
   its length, so the area shrinks in a crown and grows in a jet. At an interval a ring with too small an area joins its
   nearest neighbour, and a ring with too large an area splits, in the direction of the widest gap between its
   neighbours. If the spacing adapts, all particles do the same with their volume over that of the spacing wanted at
   their place, their share, and those that stand unevenly after it move a little (smooth.c). Other graded particles
   keep their volumes, but a splash throws small particles among large particles. These push a small particle about like
   a molecule and accelerate it: a small particle without others of its size joins its nearest larger neighbour. Mass of
   each liquid, momentum and centre of mass are kept to round-off; the liquid of the first body is kept as the colour of
   particles that have joined across bodies. A report counts the loss of kinetic energy. Distances and ids decide, so
   the result is the same on any number of ranks. */
#ifndef ISPH_RESAMPLING_IMPL_H
#define ISPH_RESAMPLING_IMPL_H

#include "../operators/operators.h"

/* Shares from which particles split and below which they join. Rings at fixed spacings: the largest splits into halves
   of 0.8; two of the smallest join to 1.2. A target that moves needs more between both, or particles split and join all
   the time: 94 k joins in 60 ms of a drop impact became 13 k. There 1.7 and 2.2 leave the diameter as it is, 2.4 % off
   at most; 0.2 is better (1.8 %), 0.4 worse (4.2 %). */
#define MOST         1.6
#define LEAST        0.6
#define MOST_FOLLOW  1.9
#define LEAST_FOLLOW 0.3

/* Whether particles join and split by their share; else graded particles join where they are alone. */
static inline PetscBool ByShare(Domain domain)
{
  return (PetscBool)(domain->rings || domain->adaptive);
}

typedef struct {
  PetscInt  joined, split; /* particles removed by joining, added by splitting */
  PetscReal energy;        /* loss of kinetic energy, J */
} ResamplingReport;

/* ResamplingArea - the ring area of particle a over V_0. ResamplingDue - whether to resample after this step: after
   every tenth, and after any whose largest ring area, 'largest', exceeds twice MOST. Not collective. */
PetscReal ResamplingArea(Cloud cloud, PetscInt a);
PetscBool ResamplingDue(PetscInt step, PetscReal largest);
/* Resample - joins and splits at the end of an accepted step. The cloud must still hold the step's neighbours, moments
   and velocity gradient. Ends with CloudResync if a particle joined or split. Collective. */
PetscErrorCode Resample(Cloud cloud, ResamplingReport *report);

/* The particles after resampling. The cloud keeps the state before. */
typedef struct {
  ParticleArrays arrays;         /* of the swarm, with the new values of the particles that stay */
  PetscBool     *keep;           /* [n_owned] whether the particle stays */
  PetscBool     *changed;        /* [n_owned] whether the particle has absorbed another; then it does not split */
  PetscReal     *unit;           /* [n_total] spacing (of -spacing, 1) that the particle should have, and ... */
  PetscReal     *share;          /* [n_total] ... its volume over that of such a particle, at the end of the step */
  PetscInt       split, *parent; /* [split] local indices of the particles that split */
  PetscReal     *at;             /* [split][3] m, displacement of the new half; the parent moves by -at */
} Change;

/* ShareSize - the size that is stored of particle a if 'part' of its volume stays: that of its spacing, and at fixed
   spacings its own. Not collective. */
static inline PetscReal ShareSize(Cloud cloud, const Change *change, PetscInt a, PetscReal part)
{
  if (!cloud->domain->adaptive) return change->unit[a];
  return PetscMax(cloud->domain->rings ? 1 : 0,
                  PetscMin(cloud->size_most, change->unit[a] * PetscPowReal(part * change->share[a],
                                                                            1. / (PetscReal)cloud->domain->dim)));
}

/* SmoothDisorder - moves particles that stand unevenly after splits and joins. Ends with CloudResync. Collective. */
PetscErrorCode SmoothDisorder(Cloud cloud);
/* JoinSmall - joins small particles with their nearest neighbours. Collective. */
PetscErrorCode JoinSmall(Cloud cloud, Change *change, ResamplingReport *report);
/* SplitLarge - chooses the particles that split and the positions of their halves, and moves the parents. Not
   collective. */
PetscErrorCode SplitLarge(Cloud cloud, Change *change, ResamplingReport *report);
/* SplitVelocity - change dv (m/s) of the liquid's velocity over the displacement at (m) from particle a. Not
   collective. */
void SplitVelocity(Cloud cloud, PetscInt a, const PetscReal at[DIM], PetscReal dv[DIM]);

#endif
