/* Contact lines, for lines/: what they ask the tension, and what it asks them. */
#ifndef ISPH_TENSION_LINES_H
#define ISPH_TENSION_LINES_H

#include "tension.h"

/* A wall face of the box, or the nearest solid with a contact angle. */
#define WALLS_NEAR (2 * DIM + 1)
typedef struct {
  PetscReal hysteresis;                           /* (cos r - cos a)/2, over sigma: see lines/hysteresis.c */
  PetscReal distance, inward[DIM], velocity[DIM]; /* m, negative inside a solid; into the liquid; m/s */
} LineWall;

/* Lines whose angle depends on their speed. The data are the tension's, zero at the start; 'start' and 'angle' are
   called only if they move. */
typedef struct {
  size_t size;                                                            /* of the data, bytes */
  PetscErrorCode (*read)(void *data, OptionItems items, PetscBool *move); /* options, inside a block. Collective. */
  const char *(*law)(const void *data);                                   /* its name; data NULL: another model */
  /* before the curvature: bend, [n_total], what 'angle' takes of particles, ghosts too. Collective. */
  PetscErrorCode (*start)(void *data, Cloud cloud, const PetscReal **bend);
  PetscReal (*angle)(const void *data, PetscReal at_rest, PetscReal bend); /* rad */
  /* from the normals ([n_total][3]) out of the liquid, where there are walls; INT_SURFACE of ghosts is current.
     Collective. */
  PetscErrorCode (*find)(void *data, Tension tension, Cloud cloud, const PetscReal normal[]);
  PetscErrorCode (*destroy)(void *data);
} LineOps;
extern const LineOps MovingLines; /* lines/law.c */

/* TensionLines - the data of MovingLines; NULL: the model has no contact angles. WallsNear - the walls within 'reach'
   (m) of particle a; returns how many. The model must be curvature. Not collective. */
void    *TensionLines(Tension tension);
PetscInt WallsNear(Tension tension, Cloud cloud, PetscInt a, PetscReal reach, LineWall wall[WALLS_NEAR]);

#endif
