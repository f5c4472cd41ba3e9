/* Some of the particles sorted into cells, and the particles within a radius of a cell copied into columns, over which
   loops vectorise. A particle has a place in the sorted order and a local index in the cloud. */
#ifndef ISPH_SORTED_CELLS_H
#define ISPH_SORTED_CELLS_H

#include "cloud.h"

#define SORTED_WIDTH 11 /* columns: x, y, z, then the quantities that a pass sums */
#define SORTED_REACH 5  /* cells that lines reach at most */

/* A range of places in the sorted order. */
typedef struct {
  PetscInt begin, length;
} SortedLine;

/* Must be zeroed before the first use. */
typedef struct {
  CellGrid   grid;
  PetscInt   count, capacity, stride, single_stride;
  PetscInt  *index;   /* [count] local index of each particle, by place */
  PetscReal *sorted;  /* [SORTED_WIDTH][count] the columns of all particles, by place */
  PetscReal  support; /* m: radius around a cell within which particles are collected, at size 1 */
  PetscReal *largest; /* [cells] largest size of a cell's particles, a factor on the support; NULL: 1 */
  PetscReal  radius;  /* m, radius of the table */
  PetscInt   reach, along[SORTED_REACH + 1][SORTED_REACH + 1]; /* cells within the radius: see CellsWithin */
  PetscInt   lines;                                            /* of SortedCellsLines */
  SortedLine line[PetscSqr(2 * SORTED_REACH + 1)];             /* [lines] */
  PetscReal *near;   /* [SORTED_WIDTH][stride] columns of the particles of SortedCellsCollect */
  float     *single; /* [SORTED_WIDTH][single_stride] columns of SortedCellsCollectSingle */
} SortedCells;

/* SortedCellsBuild - sorts the particles with the 'count' local indices 'of' into cells of at least this size (m). size
   is at least support (m) over SORTED_REACH - 1. SortedCellsLoad - fills 'width' columns from 'column' on with the
   values of a field ([n_total][width]). Not collective. */
PetscErrorCode SortedCellsBuild(SortedCells *cells, Cloud cloud, PetscInt count, const PetscInt of[], PetscReal size,
                                PetscReal support);
void           SortedCellsLoad(SortedCells *cells, PetscInt column, PetscInt width, const PetscReal field[]);
PetscErrorCode SortedCellsReset(SortedCells *cells);

/* SortedCellsCollect - copies the columns whose bits are set (COLUMNS) of the *n particles within the support of cell c
   to 'near', which has room for 'copies' times as many. SortedCellsPlaces - replaces n ascending indices of particles
   that it has copied last by their places in the sorted order. SortedCellsCollectSingle - copies the first 'columns'
   columns of the particles within the support of the box from 'lower' to 'upper' (m), a part of cell c, in single
   precision to 'single', with positions relative to 'lower'. *m: the number, including far-away entries that fill the
   last vector (KERNEL_LANES). Not collective. */
#define COLUMNS(first, count) (((1 << (count)) - 1) << (first))
PetscErrorCode SortedCellsCollect(SortedCells *cells, PetscInt c, PetscInt columns, PetscInt copies, PetscInt *n);
void           SortedCellsPlaces(const SortedCells *cells, PetscInt n, int32_t index[]);
PetscErrorCode SortedCellsCollectSingle(SortedCells *cells, PetscInt c, PetscInt columns, const PetscReal lower[DIM],
                                        const PetscReal upper[DIM], PetscInt *m);

/* SortedCellsLines - sets the lines of the particles in cells within a radius (m), at most the support, of the cell of
   x (m); x may be outside all cells. SortedCellsWithin - whether one of the particles is within the radius of x. Not
   collective. */
void      SortedCellsLines(SortedCells *cells, const PetscReal x[DIM], PetscReal radius);
PetscBool SortedCellsWithin(SortedCells *cells, const PetscReal x[DIM], PetscReal radius);

/* SortedCell - the cell of the particle at a place. SortedRadius - the support (m) of the particles of a cell.
   SortedPosition - x (m) of the particle at a place. Not collective. */
static inline PetscInt SortedCell(const SortedCells *cells, PetscInt place)
{
  return cells->grid.of_point[cells->grid.order[place]];
}
static inline PetscReal SortedRadius(const SortedCells *cells, PetscInt cell)
{
  return cells->support * (cells->largest ? cells->largest[cell] : 1);
}
static inline void SortedPosition(const SortedCells *cells, PetscInt place, PetscReal x[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) x[d] = cells->sorted[d * cells->count + place];
}

#endif
