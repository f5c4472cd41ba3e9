/* Private to scene/: surfaces of triangles from STL files. */
#ifndef ISPH_STL_H
#define ISPH_STL_H

#include "scene_impl.h"

#define STL_CELL 0.5 /* distance of the table's nodes, spacings */

/* The table: nodes lower + (i, j, k) cell, x fastest, 0 <= i < n[0] and so on; the band's width around the surface. */
typedef struct {
  char      path[PETSC_MAX_PATH_LEN];
  PetscReal scale, offset[DIM];      /* of the file's unit, m */
  PetscReal lower[DIM], upper[DIM];  /* of the surface, m */
  PetscReal origin[DIM], cell, band; /* m */
  PetscInt  n[DIM];
  float     distance[]; /* [n2][n1][n0] m */
} Stl;

/* StlRead - the triangles of a file, binary or text: corner [n][3][3] in the file's unit, to be freed with PetscFree;
   they may be any numbers. Refuses (UserError) a file that is missing, cut off or something else. Every rank reads.
   Collective. */
PetscErrorCode StlRead(MPI_Comm comm, const char path[], PetscInt *n, PetscReal **corner);
/* StlClose - makes a closed surface of n triangles, corner [n][3][3] (m, finite), and refuses (UserError) one that is
   none: joins corners that are almost at one place, drops triangles without area, takes what stands there several times
   once, or not at all where two triangles look opposite ways, and says so. Collective. */
PetscErrorCode StlClose(MPI_Comm comm, const char path[], PetscInt *n, PetscReal corner[]);
/* StlDistances - lowers the table's distances, without sign, to those of n triangles, corner [n][3][3] (m). Not
   collective. */
PetscErrorCode StlDistances(Stl *stl, PetscInt n, const PetscReal corner[]);

#endif
