/* Private to tension/. */
#ifndef ISPH_TENSION_TYPES_H
#define ISPH_TENSION_TYPES_H

#include "tension.h"

#define WALL_TABLE 256

typedef PetscErrorCode (*TensionFunction)(Tension, Cloud);

struct _p_Tension {
  MPI_Comm        comm;
  PetscBool       active;
  char            type[64];
  TensionFunction apply;
  PetscReal       spacing, smoothing, ratio, calibration, band;
  Kernel          kernel; /* W^H */
  PetscReal       wall[WALL_TABLE + 1];
  /* The liquid near a surface, sorted along cells. */
  CellGrid       grid;
  PetscInt       capacity, count, near_capacity;
  PetscReal     *sorted;     /* [9][count] x, y, z, then a payload of six, in the grid's order */
  PetscReal     *candidates; /* [9][count] those around one cell, same columns */
  PetscInt      *liquid;     /* [count] local index of each */
  unsigned char *near;       /* [cells] whether a surface is within the band */
};

PetscErrorCode TensionApply_CahnHilliard(Tension tension, Cloud cloud);
PetscErrorCode TensionApply_None(Tension tension, Cloud cloud);

#endif
