/* Private to scene/: triangulated surfaces from STL files. */
#ifndef ISPH_STL_H
#define ISPH_STL_H

#include "scene_impl.h"

#define STL_CELL 0.5 /* distance of the table's nodes, spacings */

/* The table of signed distances at the nodes origin + (i, j, k) cell, x fastest, 0 <= i < n[0] and so on. */
typedef struct {
  OptionFile file;
  PetscReal  scale, offset[DIM];      /* length of the file's unit, m; position of its origin, m */
  PetscReal  lower[DIM], upper[DIM];  /* of the surface, m */
  PetscReal  origin[DIM], cell, band; /* m; band: distance from the surface within which the table is exact */
  PetscInt   n[DIM];
  float      distance[]; /* [n2][n1][n0] m */
} Stl;

/* StlRead - reads the n triangles of a file, binary or text, on every rank. corner: [n][3][3] in the file's unit, not
   necessarily finite; free it with PetscFree. Refuses (UserError) a missing, truncated or other file. Collective. */
PetscErrorCode StlRead(MPI_Comm comm, const char path[], PetscInt *n, PetscReal **corner);
/* StlClose - makes a closed surface of n triangles, corner [n][3][3] (m, finite). It joins corners at almost the same
   position and removes triangles without area. Of several triangles with the same corners it keeps one, or none if as
   many have one orientation as the other, and says so. Refuses (UserError) a surface that is still open. Collective. */
PetscErrorCode StlClose(MPI_Comm comm, const char path[], PetscInt *n, PetscReal corner[]);
/* StlDistances - lowers the table's distances to the unsigned distances to n triangles, corner [n][3][3] (m). Not
   collective. */
PetscErrorCode StlDistances(Stl *stl, PetscInt n, const PetscReal corner[]);

#endif
