/* Floor 5: what keeps liquid inside the box where the particles of walls and mirrors leave a gap. */
#ifndef ISPH_WALL_H
#define ISPH_WALL_H

#include "../neighbors/cloud.h"

/* WallGuard - on the new state x ([n_owned][3], m), v (m/s) of the fluid: a particle closer to a wall face or solid
   than 'distance' (m) is set back to it and loses its velocity into the wall; one that crossed a symmetry face is
   mirrored back. The Neumann condition of the pressure makes walls impermeable to first order only; this is the
   remainder. *touched = number of particles set back on this rank. Not collective. */
PetscErrorCode WallGuard(Cloud cloud, PetscReal distance, PetscReal x[], PetscReal v[], PetscInt *touched);

#endif
