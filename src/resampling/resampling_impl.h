/* Private to resampling/. */
#ifndef ISPH_RESAMPLING_IMPL_H
#define ISPH_RESAMPLING_IMPL_H

#include "resampling.h"

/* The ring area over spacing^2 above which rings split. Chosen for rings, no reference: the largest becomes two of 0.8;
   joined, two of the smallest are 1.2 at most (join.c). */
#define MOST 1.6

/* The particles as they will be: the swarm's arrays, in which those that stay are changed; which of them stay; and new
   ones. The cloud keeps the state before. */
typedef struct {
  ParticleArrays arrays;
  PetscBool     *keep;           /* [n_owned] */
  PetscBool     *changed;        /* [n_owned] has joined with another: is not split as well */
  PetscReal     *share;          /* [n_total] of rings, over V_0, at the end of the step */
  PetscInt       split, *parent; /* [split] local indices of those that became two */
  PetscReal *at; /* [split][3] m, from the parent's old place to the new particle's; the parent goes the other way */
} Change;

/* JoinSmall - joins particles with too small shares with their nearest neighbours. Collective. */
PetscErrorCode JoinSmall(Cloud cloud, const Resampling *resampling, Change *change, ResamplingReport *report);
/* SplitLarge - chooses the particles to split and where their halves go, and moves the halves that keep their place in
   the swarm. Not collective. */
PetscErrorCode SplitLarge(Cloud cloud, const Resampling *resampling, Change *change, ResamplingReport *report);
/* SplitVelocity - by how much (m/s) the velocity of the liquid differs at the distance at (m) from particle a. Not
   collective. */
void SplitVelocity(Cloud cloud, PetscInt a, const PetscReal at[DIM], PetscReal dv[DIM]);

#endif
