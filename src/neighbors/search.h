/* Private to neighbors/: the neighbour search. */
#ifndef ISPH_SEARCH_H
#define ISPH_SEARCH_H

#include "cloud.h"

/* NeighborsFind - CloudSearch; visit may be NULL. Not collective. */
PetscErrorCode NeighborsFind(Cloud cloud, RowVisitor visit, void *context);

#endif
