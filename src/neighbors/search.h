/* Private to neighbors/: the neighbour search. */
#ifndef ISPH_SEARCH_H
#define ISPH_SEARCH_H

#include "cloud.h"

/* NeighborsFind - the list of all points within radius (m) of each owned particle, from the positions of the cloud. Not
 * collective. */
PetscErrorCode NeighborsFind(Cloud cloud, PetscReal radius);

#endif
