/* Private to neighbors/: ghosts. A ghost is an owned particle of some rank (this one too) under an image: identity, a
   shift by the period, a mirror in a symmetry face, or their products. A PetscSF brings the values, the image changes
   their signs. */
#ifndef ISPH_HALO_H
#define ISPH_HALO_H

#include "cloud.h"

/* HaloCreate - no ghosts yet; domain is borrowed. Collective. */
PetscErrorCode HaloCreate(Domain domain, Halo *halo);
PetscErrorCode HaloDestroy(Halo *halo);
/* HaloBuild - chooses as ghosts all points within 'support' + 'margin' (m) of a cell of another rank or image, from the
   n owned positions x ([n][3], m). Points of different sizes ([n], 1; NULL: all have size 1) are ghosts where the
   support times the size of the point, or times that of the largest point in the cell, and the margin reach; no size is
   larger than size_most. *ghosts is their number on this rank. They come in the order of their owner's rank, then in
   that of its local indices. Collective. */
PetscErrorCode HaloBuild(Halo halo, PetscInt n, const PetscReal x[], PetscReal support, PetscReal margin,
                         const PetscReal size[], PetscReal size_most, PetscInt *ghosts);
/* HaloUpdate - copies the values of owned particles, array[0..n)[width], to the ghosts' places behind them and changes
   them as the image demands. Collective. */
PetscErrorCode HaloUpdate(Halo halo, PetscInt width, Parity parity, PetscReal array[]);
/* HaloUpdateInt - the same for integers, which no image changes. Collective. */
PetscErrorCode HaloUpdateInt(Halo halo, PetscInt array[]);
/* HaloDistanceOutside - how far (m) the n owned points x are outside the cells of this rank or, through periodic and
   symmetry faces, outside the box; at most 'limit'. Not collective. */
PetscReal HaloDistanceOutside(Domain domain, PetscMPIInt rank, PetscInt n, const PetscReal x[], PetscReal limit);

#endif
