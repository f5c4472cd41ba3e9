/* Private to resampling/. */
#ifndef ISPH_RESAMPLING_IMPL_H
#define ISPH_RESAMPLING_IMPL_H

#include "resampling.h"

/* Ring area over spacing^2: a larger ring splits. Chosen, no reference: the largest ring splits into halves of 0.8; two
   of the smallest (join.c) join to 1.2. */
#define MOST 1.6

/* The particles after resampling. The cloud keeps the state before. */
typedef struct {
  ParticleArrays arrays;         /* of the swarm, with the new values of the particles that stay */
  PetscBool     *keep;           /* [n_owned] whether the particle stays */
  PetscBool     *changed;        /* [n_owned] whether the particle has absorbed another; then it does not split */
  PetscReal     *area;           /* [n_total] of rings, over V_0, at the end of the step */
  PetscInt       split, *parent; /* [split] local indices of the particles that split */
  PetscReal     *at;             /* [split][3] m, displacement of the new half; the parent moves by -at */
} Change;

/* JoinSmall - joins small particles with their nearest neighbours. Collective. */
PetscErrorCode JoinSmall(Cloud cloud, const Resampling *resampling, Change *change, ResamplingReport *report);
/* SplitLarge - chooses the particles that split and the positions of their halves, and moves the parents. Not
   collective. */
PetscErrorCode SplitLarge(Cloud cloud, const Resampling *resampling, Change *change, ResamplingReport *report);
/* SplitVelocity - change dv (m/s) of the liquid's velocity over the displacement at (m) from particle a. Not
   collective. */
void SplitVelocity(Cloud cloud, PetscInt a, const PetscReal at[DIM], PetscReal dv[DIM]);

#endif
