/* Private to twolevel/: the background grid of the preconditioner. */
#ifndef ISPH_COARSE_GRID_H
#define ISPH_COARSE_GRID_H

#include "../base/base.h"

#define GRID_CORNERS 8 /* of a cell; in two dimensions the upper four repeat the lower four, with weight zero */
#define GRID_STENCIL 27

typedef struct _p_CoarseGrid *CoarseGrid;

/* CoarseGridCreate - covers the points x ([n][dim], m) whose skip[a] is false with cells of about the given width (m).
   weight: [n] relative volume of each point, 1; NULL: all 1. In a periodic direction the grid spans lower..upper (m)
   with a whole number of cells; in other directions it spans the points. A node exists if one of its cells holds a
   point; it belongs to the lowest rank that has such a cell. Collective on comm; ranks may have no point. */
PetscErrorCode CoarseGridCreate(MPI_Comm comm, PetscInt dim, PetscInt n, const PetscReal x[], const PetscReal weight[],
                                const PetscBool skip[], PetscReal width, const PetscReal lower[DIM],
                                const PetscReal upper[DIM], const PetscBool periodic[DIM], CoarseGrid *grid);
PetscErrorCode CoarseGridDestroy(CoarseGrid *grid);
/* CoarseGridSizes - number of nodes of this rank and of all ranks; either pointer may be NULL. Collective if 'global'
   is not NULL. */
PetscErrorCode CoarseGridSizes(CoarseGrid grid, PetscInt *local, PetscInt *global);
/* CoarseGridRestrict - coarse = P^T fine. P is the (bi/tri)linear interpolation from nodes to points; its skipped rows
   are zero. Collective. */
PetscErrorCode CoarseGridRestrict(CoarseGrid grid, Vec fine, Vec coarse);
/* CoarseGridProlongAdd - fine += P coarse. Collective. */
PetscErrorCode CoarseGridProlongAdd(CoarseGrid grid, Vec coarse, Vec fine);
/* CoarseGridMatrix - creates the symmetric matrix A: the 5/7-point matrix of the energy point_energy * sum over points
   of factor |grad p|^2 (point_energy in [A] m2; factor: [n] 1, NULL: all 1), plus P^T S P with the diagonal S = surplus
   ([n], [A]). A cell counts at most one point of volume 1 per point_volume (m^dim). Collective. */
PetscErrorCode CoarseGridMatrix(CoarseGrid grid, PetscReal point_energy, PetscReal point_volume,
                                const PetscReal factor[], const PetscReal surplus[], Mat *A);

#endif
