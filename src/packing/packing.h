/* Floor 6: the initial state. Fills the bodies of a scene with particles and the walls with dummies.

   Types: lattice (with jitter; what the consistent scheme starts from) and poisson (Schechter & Bridson 2012 sampling
   at the particle spacing, then TAO on the positions until the standard deviation of the density is small, as in Kuri
   et al.). */
#ifndef ISPH_PACKING_H
#define ISPH_PACKING_H

#include "../neighbors/cloud.h"

typedef struct _p_Packing *Packing;

typedef struct {
  PetscReal density_std;       /* standard deviation of the summed density about rho_0 over the fluid, kg/m3 */
  PetscReal smallest_distance; /* between two fluid particles, in units of the spacing */
  PetscInt  iterations;        /* of TAO, 0 for the lattice */
  PetscBool cached;            /* read from the cache file */
} PackingReport;

/* PackingCreate - fills 'particles' (borrowed, empty) through 'cloud' (borrowed) for the scene of the cloud.
   Collective. */
PetscErrorCode PackingCreate(Cloud cloud, Packing *packing);
/* PackingSetFromOptions - -packing_type lattice|poisson, -packing_jitter (in spacings), -packing_seed,
   -packing_distance, -packing_tolerance, -packing_cache (folder; empty: none), -packing_tao_*. Collective. */
PetscErrorCode PackingSetFromOptions(Packing packing);
/* PackingRun - puts fluid and wall particles into the swarm with id, body, layer, parent, position, initial velocity,
   density; the same particles (by id and to the last bit of the position for the lattice) on any number of ranks; ends
   with CloudResync. Refuses a scene without a single fluid particle. Collective. */
PetscErrorCode PackingRun(Packing packing, PackingReport *report);
/* PackingFindRelaxed - if the cache holds this packing after a relaxation described by the text 'how', takes its
   positions. PackingKeepRelaxed puts the present positions there. Both to be called after PackingRun. Collective. */
PetscErrorCode PackingFindRelaxed(Packing packing, const char how[], PetscBool *found);
PetscErrorCode PackingKeepRelaxed(Packing packing, const char how[]);
/* PackingSetVelocities - gives every fluid particle the initial velocity of its body at its position; ends with
   CloudResync. Collective. */
PetscErrorCode PackingSetVelocities(Packing packing);
/* PackingEmit - adds to the swarm what the emitters of the scene have brought up to the time (s) since the last call,
   and gives the liquid inside them their velocity. 'resumed': the first call of a run that continues, which only counts
   what was brought before. Ends with CloudResync when there is new liquid: *emitted particles over all ranks.
   Collective. */
PetscErrorCode PackingEmit(Packing packing, PetscReal time, PetscBool resumed, PetscInt *emitted);
/* PackingEmitted - how many particles emitters have brought up to and at the time (s), after the first PackingEmit. Not
   collective. */
PetscReal      PackingEmitted(Packing packing, PetscReal time);
PetscErrorCode PackingDestroy(Packing *packing);

#endif
