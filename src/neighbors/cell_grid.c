/* Cells over a set of points, and the points sorted into them. */
#include "cloud.h"

/* More cells a point than this cost more than they save: the cells are then made larger, by CELL_GROWTH at a time. A
   few points may have LEAST_CELLS. */
#define CELLS_PER_POINT 4
#define LEAST_CELLS     1000
#define CELL_GROWTH     1.25

PetscErrorCode CellGridReset(CellGrid *grid)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(grid->start));
  PetscCall(PetscFree(grid->order));
  PetscCall(PetscFree(grid->of_point));
  PetscCall(PetscMemzero(grid, sizeof(*grid)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Chooses lower corner, size and number of the cells. per_size: cells along each direction in the length 'size'. */
static void ChooseCells(CellGrid *grid, PetscInt dim, PetscInt n, const PetscReal x[], PetscReal size,
                        const PetscReal per_size[DIM])
{
  PetscReal upper[DIM], count;

  for (PetscInt d = 0; d < DIM; d++) {
    grid->lower[d] = upper[d] = n ? x[d] : 0;
    for (PetscInt a = 1; a < n; a++) {
      grid->lower[d] = PetscMin(grid->lower[d], x[DIM * a + d]);
      upper[d]       = PetscMax(upper[d], x[DIM * a + d]);
    }
  }
  for (grid->size = size;; grid->size *= CELL_GROWTH) {
    count = 1; /* a real number: that of cells may be too large for an integer */
    for (PetscInt d = 0; d < dim; d++)
      count *= PetscFloorReal((upper[d] - grid->lower[d]) * (per_size[d] / grid->size)) + 1;
    if (count <= CELLS_PER_POINT * (PetscReal)n + LEAST_CELLS) break;
  }
  for (PetscInt d = 0; d < DIM; d++)
    grid->n[d] = d < dim ? (PetscInt)((upper[d] - grid->lower[d]) * (per_size[d] / grid->size)) + 1 : 1;
  grid->count = grid->n[0] * grid->n[1] * grid->n[2];
}

static PetscErrorCode Reserve(CellGrid *grid, PetscInt n)
{
  PetscFunctionBegin;
  if (grid->count + 1 > grid->capacity) {
    grid->capacity = grid->count + 1 + grid->count / 4;
    PetscCall(PetscFree(grid->start));
    PetscCall(PetscMalloc1(grid->capacity, &grid->start));
  }
  if (n > grid->point_capacity) {
    grid->point_capacity = n + n / 4;
    PetscCall(PetscFree(grid->order));
    PetscCall(PetscFree(grid->of_point));
    PetscCall(PetscMalloc1(grid->point_capacity + SEARCH_LANES, &grid->order));
    PetscCall(PetscMalloc1(grid->point_capacity, &grid->of_point));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CellGridBuild(CellGrid *grid, PetscInt dim, PetscInt n, const PetscReal x[], PetscReal size,
                             PetscInt split)
{
  const PetscReal per_size[DIM] = {split, 1, 1};

  PetscFunctionBegin;
  ChooseCells(grid, dim, n, x, size, per_size);
  PetscCall(Reserve(grid, n));
  /* This is a counting sort. Points of one cell stay in the order of their indices. */
  PetscCall(PetscArrayzero(grid->start, grid->count + 1));
  for (PetscInt a = 0; a < n; a++) {
    PetscInt cell[DIM] = {0, 0, 0};

    for (PetscInt d = 0; d < dim; d++)
      cell[d] = PetscMin(grid->n[d] - 1, (PetscInt)((x[DIM * a + d] - grid->lower[d]) * (per_size[d] / grid->size)));
    grid->of_point[a] = CellIndex(grid->n, cell[0], cell[1], cell[2]);
    grid->start[grid->of_point[a] + 1]++;
  }
  for (PetscInt c = 0; c < grid->count; c++) grid->start[c + 1] += grid->start[c];
  for (PetscInt a = 0; a < n; a++) grid->order[grid->start[grid->of_point[a]]++] = a;
  for (PetscInt c = grid->count; c > 0; c--) grid->start[c] = grid->start[c - 1];
  grid->start[0] = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}
