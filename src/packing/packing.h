/* Floor 8: the initial state. Fills the bodies of a scene with particles and the walls with dummies.

   Types: lattice (with jitter; for the consistent scheme) and poisson (sampling of Schechter & Bridson 2012 at the
   particle spacing, then TAO moves the particles until the standard deviation of the density is small, as in Kuri et
   al.). */
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
/* PackingRun - puts fluid and wall particles into the swarm, with id, body, layer, parent, position, initial velocity
   and density. Any number of ranks gives the same particles; lattices are the same to the last bit. Ends with
   CloudResync. Refuses (UserError) a scene without a fluid particle. Collective. */
PetscErrorCode PackingRun(Packing packing, PackingReport *report);
/* PackingSetVelocities - gives every fluid particle the initial velocity of its body at its position; ends with
   CloudResync. Collective. */
PetscErrorCode PackingSetVelocities(Packing packing);
/* PackingEmit - adds to the swarm the liquid that emitters have brought since the last call, up to the time (s), and
   gives the liquid inside an emitter the emitter's velocity. resumed: the first call of a continued run, which only
   counts what emitters brought before. *emitted: new particles over all ranks; if there are any, ends with CloudResync.
   Collective. */
PetscErrorCode PackingEmit(Packing packing, PetscReal time, PetscBool resumed, PetscInt *emitted);
/* PackingEmitted - how many particles emitters have brought up to and at the time (s), after the first PackingEmit. Not
   collective. */
PetscReal PackingEmitted(Packing packing, PetscReal time);
/* PackingFillingVolume - volume (m3, in two dimensions m2) of the particles of one filling of an emitter, the body of
   this index, after the first PackingEmit: over that of its shape, it is the emitter's flux over the one of its
   options. Not collective. */
PetscReal      PackingFillingVolume(Packing packing, PetscInt body);
PetscErrorCode PackingDestroy(Packing *packing);

#endif
