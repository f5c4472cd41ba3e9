/* Floor 1: the PC type "twolevel", a preconditioner for Laplacians on points whose places are known: see twolevel.c. It
   knows a matrix, the places of its rows and the spacing of the points, nothing of particles. */
#ifndef ISPH_TWOLEVEL_H
#define ISPH_TWOLEVEL_H

#include "../base/base.h"

#define PCTWOLEVEL "twolevel"

/* PCTwoLevelRegister - makes the type known to PETSc, for -pc_type twolevel. Not collective; may be called repeatedly.
 */
PetscErrorCode PCTwoLevelRegister(void);
/* PCTwoLevelSetGrid - the spacing of the points (m), the corners of the box (m) and which directions are periodic. The
   places of the rows come by PCSetCoordinates before each set-up. Does nothing to a PC of another type. Collective. */
PetscErrorCode PCTwoLevelSetGrid(PC pc, PetscReal spacing, const PetscReal lower[DIM], const PetscReal upper[DIM],
                                 const PetscBool periodic[DIM]);
/* PCTwoLevelSetVolumes - where points differ in size, after PCTwoLevelSetGrid: the largest spacing (m), and the volumes
   of the n points over that of one of the spacing given there ([n], 1), with which the rows of the matrix are
   multiplied. Does nothing to a PC of another type. Collective. */
PetscErrorCode PCTwoLevelSetVolumes(PC pc, PetscReal spacing_most, PetscInt n, const PetscReal volume[]);

#endif
