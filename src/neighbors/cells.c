/* Points sorted into cells, and the cells near some points. */
#include "cells.h"

/* Cells for each point at most, since more cost more than they save; LEAST_CELLS are allowed in any case. */
#define CELLS_PER_POINT 4
#define LEAST_CELLS     1000
#define MASK_CELLS      (1 << 25) /* largest number of cells of a mask, for its memory */
#define CELL_GROWTH     1.25      /* factor by which cells grow at a time if there are too many */
#define JOIN            3         /* cells this close to each other along x are marked in one pass */

PetscErrorCode CellGridReset(CellGrid *grid)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(grid->start));
  PetscCall(PetscFree(grid->order));
  PetscCall(PetscFree(grid->of_point));
  PetscCall(PetscMemzero(grid, sizeof(*grid)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The size (m), at least 'size', of the cells over a box of this extent (m), so that there are at most so many.
   per_size: cells along each direction in this length. */
static PetscReal FitSize(PetscInt dim, const PetscReal extent[DIM], const PetscReal per_size[DIM], PetscReal size,
                         PetscReal most)
{
  for (;; size *= CELL_GROWTH) {
    PetscReal count = 1; /* a real number, since it may be too large for an integer */

    for (PetscInt d = 0; d < dim; d++) count *= PetscFloorReal(extent[d] * (per_size[d] / size)) + 1;
    if (count <= most) return size;
  }
}

/* Chooses lower corner, size and number of the cells. per_size: cells along each direction in the length 'size'. */
static void ChooseCells(CellGrid *grid, PetscInt dim, PetscInt n, const PetscReal x[], PetscReal size,
                        const PetscReal per_size[DIM])
{
  PetscReal extent[DIM];

  for (PetscInt d = 0; d < DIM; d++) {
    PetscReal upper = n ? x[d] : 0;

    grid->lower[d] = upper;
    for (PetscInt a = 1; a < n; a++) {
      grid->lower[d] = PetscMin(grid->lower[d], x[DIM * a + d]);
      upper          = PetscMax(upper, x[DIM * a + d]);
    }
    extent[d] = upper - grid->lower[d];
  }
  grid->size = FitSize(dim, extent, per_size, size, CELLS_PER_POINT * (PetscReal)n + LEAST_CELLS);
  for (PetscInt d = 0; d < DIM; d++) grid->n[d] = d < dim ? (PetscInt)(extent[d] * (per_size[d] / grid->size)) + 1 : 1;
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
  /* A counting sort: points of a cell stay in the order of their indices. */
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

/* Sets value[k] to the larger of value[k] and other[k]. */
static inline void TakeLarger(PetscInt n, const PetscReal *restrict other, PetscReal *restrict value)
{
  SIMD_LOOP()
  for (PetscInt k = 0; k < n; k++) value[k] = PetscMax(value[k], other[k]);
}

PetscErrorCode CellsSpread(const PetscInt n[DIM], const PetscInt width[DIM], PetscReal value[])
{
  const PetscInt count = n[0] * n[1] * n[2];
  PetscReal     *from;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(count, &from));
  for (PetscInt d = 0, stride = 1; d < DIM; stride *= n[d++]) {
    const PetscInt length = stride * n[d], inner = length - stride; /* of a row of cells along the axis */

    for (PetscInt w = 0; w < PetscMin(width[d], n[d] - 1); w++) {
      PetscCall(PetscArraycpy(from, value, count));
      for (PetscInt row = 0; row < count; row += length) {
        TakeLarger(inner, from + row, value + row + stride);
        TakeLarger(inner, from + row + stride, value + row);
      }
    }
  }
  PetscCall(PetscFree(from));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lays the cells over the points of all ranks and the radius (m) around them; without points there are none. Sets the
   final size (m) of the cells. */
static PetscErrorCode ChooseBox(MPI_Comm comm, PetscInt dim, const PetscReal origin[DIM], PetscReal radius,
                                PetscInt count, const PetscInt of[], const PetscReal x[], PetscReal *size, CellBox *box)
{
  const PetscReal one[DIM] = {1, 1, 1};
  PetscReal       ends[2 * DIM], extent[DIM]; /* lower corner and negative upper corner */

  PetscFunctionBegin;
  for (PetscInt d = 0; d < 2 * DIM; d++) ends[d] = PETSC_MAX_REAL;
  for (PetscInt k = 0; k < count; k++)
    for (PetscInt d = 0; d < DIM; d++) {
      ends[d]       = PetscMin(ends[d], x[DIM * of[k] + d]);
      ends[DIM + d] = PetscMin(ends[DIM + d], -x[DIM * of[k] + d]);
    }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, ends, 2 * DIM, MPIU_REAL, MPIU_MIN, comm));
  box->count = ends[0] < PETSC_MAX_REAL;
  if (!box->count) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt d = 0; d < DIM; d++) extent[d] = 2 * radius - ends[DIM + d] - ends[d];
  *size        = FitSize(dim, extent, one, *size, MASK_CELLS);
  box->inverse = 1 / *size;
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal first = PetscFloorReal((ends[d] - origin[d]) / *size),
                    last  = PetscFloorReal((-ends[DIM + d] - origin[d]) / *size);
    const PetscInt reach  = d < dim ? CellsWithin(*size, radius, 0, 0) : 0;

    box->lower[d] = origin[d] + (first - (PetscReal)reach) * *size;
    box->n[d]     = (PetscInt)(last - first) + 1 + 2 * reach;
    box->count *= box->n[d];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks all cells of this size (m) within the radius (m) of the cells first to last of the line y, z. */
static void MarkAround(CellMask *mask, PetscReal size, PetscReal radius, PetscInt first, PetscInt last, PetscInt y,
                       PetscInt z)
{
  const PetscInt *n = mask->box.n, reach = CellsWithin(size, radius, 0, 0);

  for (PetscInt dz = PetscMax(-reach, -z); dz <= PetscMin(reach, n[2] - 1 - z); dz++)
    for (PetscInt dy = PetscMax(-reach, -y); dy <= PetscMin(reach, n[1] - 1 - y); dy++) {
      const PetscInt along = CellsWithin(size, radius, dy, dz), line = CellIndex(n, 0, y + dy, z + dz),
                     begin = PetscMax(0, first - along), end = PetscMin(n[0] - 1, last + along);

      if (along > 0) (void)memset(mask->near + line + begin, 1, (size_t)(end - begin + 1));
    }
}

PetscErrorCode CellMaskCreate(MPI_Comm comm, PetscInt dim, const PetscReal origin[DIM], PetscReal size,
                              PetscReal radius, PetscInt count, const PetscInt of[], const PetscReal x[],
                              CellMask *mask)
{
  CellBox       *box = &mask->box;
  unsigned char *within;

  PetscFunctionBegin;
  mask->near = NULL;
  PetscCall(ChooseBox(comm, dim, origin, radius, count, of, x, &size, box));
  if (!box->count) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscCalloc1(box->count, &mask->near));
  PetscCall(PetscCalloc1(box->count, &within));
  for (PetscInt k = 0; k < count; k++) within[CellBoxFind(box, x + DIM * of[k])] = 1;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, within, (PetscMPIInt)box->count, MPI_UNSIGNED_CHAR, MPI_MAX, comm));
  for (PetscInt row = 0; row < box->n[1] * box->n[2]; row++) {
    const unsigned char *line = within + row * box->n[0], *end = line + box->n[0];
    const unsigned char *mark = (const unsigned char *)memchr(line, 1, (size_t)box->n[0]);

    while (mark) {
      const unsigned char *last = mark, *next = mark;

      while (next && next - last <= JOIN) { /* a gap of JOIN - 1 is marked anyway */
        last = next;
        next = (const unsigned char *)memchr(last + 1, 1, (size_t)(end - last - 1));
      }
      MarkAround(mask, size, radius, (PetscInt)(mark - line), (PetscInt)(last - line), row % box->n[1],
                 row / box->n[1]);
      mark = next;
    }
  }
  PetscCall(PetscFree(within));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CellMaskDestroy(CellMask *mask)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(mask->near));
  PetscFunctionReturn(PETSC_SUCCESS);
}
