/* Floor 9: the initial state. Fills the bodies of a scene with particles and the walls with dummies.

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
   -packing_tolerance, -packing_cache (folder; empty: none), -packing_tao_*. Collective. */
PetscErrorCode PackingSetFromOptions(Packing packing);
/* PackingSetRough - rough: the stepper does not even the particles out before the run, so that the jitter is half of
   what it is otherwise. Not collective. */
void PackingSetRough(Packing packing, PetscBool rough);
/* PackingRun - puts fluid and wall particles into the swarm, with id, body, layer, parent, position, initial velocity
   and density. Any number of ranks gives the same particles; lattices are the same to the last bit. Ends with
   CloudResync. Refuses (UserError) a scene without a fluid particle. Where the swarm has the liquid (OutputRestart), it
   makes the dummy particles alone. Collective. */
PetscErrorCode PackingRun(Packing packing, PackingReport *report);
/* PackingSetVelocities - gives every fluid particle the initial velocity of its body at its position; ends with
   CloudResync. Collective. */
PetscErrorCode PackingSetVelocities(Packing packing);
PetscErrorCode PackingDestroy(Packing *packing);
/* PackingSolidDepth - how deep below the surfaces of solids there are dummy particles, m. Not collective. */
PetscReal PackingSolidDepth(Cloud cloud);

#endif
