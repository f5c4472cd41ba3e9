/* Floor 1: the PC type "twolevel", a preconditioner for Laplacians on points with known positions: see twolevel.c. It
   uses the matrix, the positions of its rows and the spacing of the points, and knows nothing of particles. */
#ifndef ISPH_TWOLEVEL_H
#define ISPH_TWOLEVEL_H

#include "../base/base.h"

#define PCTWOLEVEL "twolevel"

/* PCTwoLevelRegister - registers the type with PETSc, for -pc_type twolevel. Repeated calls are allowed. Not
   collective. */
PetscErrorCode PCTwoLevelRegister(void);
/* PCTwoLevelSetGrid - sets the spacing of the points (m), the corners of the box (m) and the periodic directions.
   PCSetCoordinates sets the positions of the rows before each set-up. No effect on a PC of another type. Collective. */
PetscErrorCode PCTwoLevelSetGrid(PC pc, PetscReal spacing, const PetscReal lower[DIM], const PetscReal upper[DIM],
                                 const PetscBool periodic[DIM]);
/* PCTwoLevelSetVolumes - for points of different sizes, after PCTwoLevelSetGrid: sets the largest spacing (m), the
   relative volumes of the n points ([n], 1), which are volumes over spacing^dim, and the factors of the rows of the
   matrix ([n], 1), which are these volumes, of rings times the ring's length (any unit). No effect on a PC of another
   type. Collective. */
PetscErrorCode PCTwoLevelSetVolumes(PC pc, PetscReal spacing_most, PetscInt n, const PetscReal volume[],
                                    const PetscReal factor[]);

#endif
