/* The walls near a contact line, for what acts on lines. */
#ifndef ISPH_NEAR_WALL_H
#define ISPH_NEAR_WALL_H

#include "tension.h"

/* A wall face of the box, or the nearest solid with a contact angle. */
#define WALLS_NEAR (2 * DIM + 1)
typedef struct {
  PetscReal hysteresis;                           /* (cos r - cos a)/2, over sigma: see lines/hysteresis.c */
  PetscReal distance, inward[DIM], velocity[DIM]; /* m, negative inside a solid; into the liquid; m/s */
} LineWall;
/* WallsNear - those within 'reach' (m) of particle a; returns how many. The model must be curvature. Not collective. */
PetscInt WallsNear(Tension tension, Cloud cloud, PetscInt a, PetscReal reach, LineWall wall[WALLS_NEAR]);

#endif
