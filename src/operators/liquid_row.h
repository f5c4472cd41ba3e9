/* The neighbours of a particle in the liquid, without walls, and the gradient that is exact for a linear value. */
#ifndef ISPH_LIQUID_ROW_H
#define ISPH_LIQUID_ROW_H

#include "../neighbors/pairs.h"

/* f[k] times d[k], the way from a neighbour, is V grad W. */
typedef struct {
  PetscInt  n, index[ROW_CAPACITY];
  PetscReal f[ROW_CAPACITY], d[ROW_CAPACITY][DIM];
  PetscReal B[6];   /* the inverse of their moments; the identity where neighbours are too few */
  PetscBool enough; /* they are not */
} LiquidRow;

/* LiquidRowLoad - of fluid particle a. Not collective. */
void LiquidRowLoad(Cloud cloud, PetscInt a, LiquidRow *out);

#endif
