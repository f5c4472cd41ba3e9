/* Private to scene/: surfaces of triangles from STL files. */
#ifndef ISPH_STL_H
#define ISPH_STL_H

#include "scene_impl.h"

/* StlRead - the triangles of a file, binary or text: corner [n][3][3] in the file's unit, to be freed with PetscFree.
   Refuses (UserError) a file that is missing, cut off or something else. Every rank reads. Collective. */
PetscErrorCode StlRead(MPI_Comm comm, const char path[], PetscInt *n, PetscReal **corner);
/* StlCheckClosed - refuses (UserError) a surface with an edge that belongs to an odd number of triangles. lower, upper:
   its corners. Collective. */
PetscErrorCode StlCheckClosed(MPI_Comm comm, const char path[], PetscInt n, const PetscReal corner[],
                              const PetscReal lower[DIM], const PetscReal upper[DIM]);

#endif
