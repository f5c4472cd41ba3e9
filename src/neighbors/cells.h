/* Boxes of cells, numbered by CellIndex: points sorted into cells, and masks of the cells near some points. */
#ifndef ISPH_CELLS_H
#define ISPH_CELLS_H

#include "../base/base.h"

#define SEARCH_LANES 16 /* candidates that the search reads at once; a grid's order has room for as many more */

/* Cells over a set of points; the points of cell c are order[start[c] .. start[c+1]). */
typedef struct {
  PetscInt  n[DIM], count, capacity, point_capacity;
  PetscReal lower[DIM], size; /* m; along x a cell is 'size'/split long: see CellGridBuild */
  PetscInt *start, *order, *of_point;
} CellGrid;

/* CellGridBuild - sorts n points x ([n][3], m) into cells of at least the given size (m), along x of size/split. In two
   dimensions there is one layer of cells. Not collective. */
PetscErrorCode CellGridBuild(CellGrid *grid, PetscInt dim, PetscInt n, const PetscReal x[], PetscReal size,
                             PetscInt split);
PetscErrorCode CellGridReset(CellGrid *grid);

/* A box of cubic cells. CellBoxFind - the cell of a point x (m); -1: outside the box. Not collective. */
typedef struct {
  PetscInt  n[DIM], count;
  PetscReal lower[DIM], inverse; /* m; 1/m, of the size of a cell */
} CellBox;

static inline PetscInt CellBoxFind(const CellBox *box, const PetscReal x[DIM])
{
  PetscInt cell[DIM];

  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal place = (x[d] - box->lower[d]) * box->inverse;

    if (!(place >= 0 && place < (PetscReal)box->n[d])) return -1;
    cell[d] = (PetscInt)place;
  }
  return CellIndex(box->n, cell[0], cell[1], cell[2]);
}

/* CellsWithin - number of cells of a size (m) along x, to either side, that may hold points within 'radius' (m) of a
   cell that is dy, dz cells away; -1: none. Not collective. */
static inline PetscInt CellsWithin(PetscReal size, PetscReal radius, PetscInt dy, PetscInt dz)
{
  const PetscReal y = PetscMax(PetscAbsInt(dy) - 1, 0) * size, z = PetscMax(PetscAbsInt(dz) - 1, 0) * size,
                  rest = radius * radius - y * y - z * z;

  return rest > 0 ? (PetscInt)(PetscSqrtReal(rest) / size) + 1 : -1;
}

/* CellsSpread - value ([n[2]][n[1]][n[0]]) of each cell becomes the largest in the block of cells up to 'width' away
   along each axis. Not collective. */
PetscErrorCode CellsSpread(const PetscInt n[DIM], const PetscInt width[DIM], PetscReal value[]);

/* The cells within a radius of some points. */
typedef struct {
  CellBox        box;
  unsigned char *near; /* [box.count] 1: within the radius of a point; NULL: there are no points */
} CellMask;

/* CellMaskCreate - marks the cells within 'radius' (m) of the points of all ranks of comm: x ([][3], m) of the 'count'
   local indices 'of'. Cells have the given size (m), or a larger one if there were too many, and begin at 'origin' (m)
   or whole sizes from it, the same on all ranks. Collective on comm. */
PetscErrorCode CellMaskCreate(MPI_Comm comm, PetscInt dim, const PetscReal origin[DIM], PetscReal size,
                              PetscReal radius, PetscInt count, const PetscInt of[], const PetscReal x[],
                              CellMask *mask);
PetscErrorCode CellMaskDestroy(CellMask *mask);

/* CellMaskHas - whether x (m) may be within the radius of a point: true if it is, false beyond the radius plus the
   diagonals of two cells. Not collective. */
static inline PetscBool CellMaskHas(const CellMask *mask, const PetscReal x[DIM])
{
  const PetscInt cell = mask->near ? CellBoxFind(&mask->box, x) : -1;

  return (PetscBool)(cell >= 0 && mask->near[cell]);
}

#endif
