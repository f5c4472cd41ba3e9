/* Private to tension/. */
#ifndef ISPH_TENSION_TYPES_H
#define ISPH_TENSION_TYPES_H

#include "tension.h"

#define WALL_TABLE 256

typedef PetscErrorCode (*TensionFunction)(Tension, Cloud);

typedef struct {
  MPI_Comm       comm;
  PetscInt       n[DIM], count;
  PetscReal      lower[DIM], size, radius; /* m */
  unsigned char *surface, *near;           /* [count] holds a surface particle; is within the radius of one */
} Band;

/* BandCreate - cells over the box and 'pad' (m) around it, for a distance 'radius' (m). Not collective. */
PetscErrorCode BandCreate(Domain domain, PetscReal radius, PetscReal pad, Band *band);
/* BandMark - finds the cells near the surface particles (INT_SURFACE is 1) of all ranks and their images. Collective.
 */
PetscErrorCode BandMark(Band *band, Cloud cloud);
PetscErrorCode BandDestroy(Band *band);

/* The cell of x (m); the nearest for points outside. */
static inline PetscInt BandCell(const Band *band, const PetscReal x[DIM])
{
  PetscInt cell[DIM];

  for (PetscInt d = 0; d < DIM; d++)
    cell[d] = (PetscInt)PetscMax(0, PetscMin(band->n[d] - 1, PetscFloorReal((x[d] - band->lower[d]) / band->size)));
  return (cell[2] * band->n[1] + cell[1]) * band->n[0] + cell[0];
}

struct _p_Tension {
  MPI_Comm        comm;
  PetscBool       active;
  char            type[64];
  TensionFunction apply;
  PetscReal       spacing, smoothing, ratio, calibration, band;
  Kernel          kernel; /* W^H */
  PetscReal       wall[WALL_TABLE + 1];
  /* The liquid near a surface, sorted along cells. */
  CellGrid   grid;
  PetscInt   capacity, count;
  PetscReal *sorted;     /* [9][count] x, y, z, then a payload of six, in the grid's order */
  PetscReal *candidates; /* [9][count] those around one cell, same columns */
  PetscInt  *liquid;     /* [count] local index of each */
  Band       band_cells;
  PetscBool  has_band;
};

PetscErrorCode TensionApply_CahnHilliard(Tension tension, Cloud cloud);
PetscErrorCode TensionApply_None(Tension tension, Cloud cloud);

#endif
