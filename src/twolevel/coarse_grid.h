/* Private to twolevel/: the background grid of the preconditioner. It knows points and weights. */
#ifndef ISPH_COARSE_GRID_H
#define ISPH_COARSE_GRID_H

#include "../base/base.h"

#define GRID_CORNERS 8 /* of a cell; in two dimensions the upper four repeat the lower four with weight zero */
#define GRID_STENCIL 27

typedef struct _p_CoarseGrid *CoarseGrid;

/* CoarseGridCreate - covers the points x ([n][dim], m) whose skip[a] is false with cells of about the given width (m).
   weight ([n], 1; NULL: 1): points that each stands for, by its volume.
   Periodic directions span lower..upper (m) with a whole number of cells; the others span the points. Only nodes of
   cells that hold a point exist; a node belongs to the lowest rank that touches it. Collective on comm; ranks may have
   no point. */
PetscErrorCode CoarseGridCreate(MPI_Comm comm, PetscInt dim, PetscInt n, const PetscReal x[], const PetscReal weight[],
                                const PetscBool skip[], PetscReal width, const PetscReal lower[DIM],
                                const PetscReal upper[DIM], const PetscBool periodic[DIM], CoarseGrid *grid);
PetscErrorCode CoarseGridDestroy(CoarseGrid *grid);
/* CoarseGridSizes - nodes of this rank and of all; any pointer may be NULL. Not collective. */
PetscErrorCode CoarseGridSizes(CoarseGrid grid, PetscInt *local, PetscInt *global);
/* CoarseGridRestrict - coarse = P^T fine; P is the (bi/tri)linear interpolation from nodes to points, zero in skipped
 * rows. Collective. */
PetscErrorCode CoarseGridRestrict(CoarseGrid grid, Vec fine, Vec coarse);
/* CoarseGridProlongAdd - fine += P coarse. Collective. */
PetscErrorCode CoarseGridProlongAdd(CoarseGrid grid, Vec coarse, Vec fine);
/* CoarseGridMatrix - the 5/7-point matrix of point_energy * sum over points of |grad p|^2 (point_energy in [A] m2),
   where no cell counts more points than fit it at one a point_volume (m^dim), plus P^T S P with the diagonal S =
   surplus ([n], [A]). Symmetric. Collective; destroy the matrix. */
PetscErrorCode CoarseGridMatrix(CoarseGrid grid, PetscReal point_energy, PetscReal point_volume,
                                const PetscReal surplus[], Mat *A);

#endif
