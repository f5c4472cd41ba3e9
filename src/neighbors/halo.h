/* Private to neighbors/: ghosts. A ghost is an owned particle of some rank (this one too) under an image: identity, a
   shift by the period, a mirror in a symmetry face, or their products. A PetscSF brings the values, the image changes
   their signs. */
#ifndef ISPH_HALO_H
#define ISPH_HALO_H

#include "cloud.h"

/* HaloCreate - a halo without ghosts; domain is borrowed. Collective. */
PetscErrorCode HaloCreate(Domain domain, Halo *halo);
PetscErrorCode HaloDestroy(Halo *halo);
/* HaloBuild - chooses the ghosts from the n owned positions x ([n][3], m): points within 'support' + 'margin' (m) of a
   cell of another rank or image. size ([n], 1; NULL: all 1, at most size_most): the support is multiplied with the size
   of the point or of the largest point in the cell, whichever is larger. *ghosts: their number on this rank. Ghosts are
   in the order of their owners' ranks, then of the owners' local indices. Collective. */
PetscErrorCode HaloBuild(Halo halo, PetscInt n, const PetscReal x[], PetscReal support, PetscReal margin,
                         const PetscReal size[], PetscReal size_most, PetscInt *ghosts);
/* HaloUpdate - copies the values of owned particles, array[0..n)[width], to the ghosts behind them, transformed as the
   image requires. Collective. */
PetscErrorCode HaloUpdate(Halo halo, PetscInt width, Parity parity, PetscReal array[]);
/* HaloUpdateInt - the same for integers, which no image changes. Collective. */
PetscErrorCode HaloUpdateInt(Halo halo, PetscInt array[]);
/* HaloDistanceOutside - largest distance (m) of the n owned points x from the cells of this rank or, through periodic
   and symmetry faces, from the box; at most 'limit'. Not collective. */
PetscReal HaloDistanceOutside(Domain domain, PetscMPIInt rank, PetscInt n, const PetscReal x[], PetscReal limit);

#endif
