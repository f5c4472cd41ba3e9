#include "sorted_cells.h"
#include "../base/simd.h"

#define VECTOR   8    /* numbers that are copied at once */
#define ROUNDING 1e-5 /* of positions in single precision, over the support */
#define FAR_AWAY 10   /* supports: position of the entries that fill the last vector */

PetscErrorCode SortedCellsBuild(SortedCells *cells, Cloud cloud, PetscInt count, const PetscInt of[], PetscReal size,
                                PetscReal support)
{
  PetscReal *x;

  PetscFunctionBegin;
  if (count > cells->capacity || !cells->index) {
    cells->capacity = count + count / 8;
    PetscCall(PetscFree(cells->sorted));
    PetscCall(PetscFree(cells->index));
    PetscCall(PetscCalloc1(SORTED_WIDTH * cells->capacity + WIDE, &cells->sorted));
    PetscCall(PetscMalloc1(cells->capacity, &cells->index));
  }
  cells->support = support;
  cells->radius  = 0;
  cells->count   = count;
  PetscCall(PetscMalloc1(DIM * count, &x));
  for (PetscInt k = 0; k < count; k++)
    for (PetscInt d = 0; d < DIM; d++) x[DIM * k + d] = cloud->field[FIELD_POSITION][DIM * of[k] + d];
  PetscCall(CellGridBuild(&cells->grid, cloud->domain->dim, count, x, size, 1));
  for (PetscInt k = 0; k < count; k++) {
    const PetscInt from = cells->grid.order[k];

    cells->index[k] = of[from];
    for (PetscInt d = 0; d < DIM; d++) cells->sorted[d * count + k] = x[DIM * from + d];
  }
  PetscCall(PetscFree(x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void SortedCellsLoad(SortedCells *cells, PetscInt column, PetscInt width, const PetscReal field[])
{
  for (PetscInt w = 0; w < width; w++)
    for (PetscInt k = 0; k < cells->count; k++)
      cells->sorted[(column + w) * cells->count + k] = field[width * cells->index[k] + w];
}

/* Finds the lines of the cells within the radius (m) of a cell, which may be outside the grid. Returns the number of
   their particles. */
static PetscInt FindLines(SortedCells *cells, const PetscInt cell[DIM], PetscReal radius)
{
  const CellGrid *grid = &cells->grid;
  PetscInt        n    = 0, reach;

  if (radius != cells->radius) {
    cells->radius = radius;
    cells->reach  = (PetscInt)(radius / grid->size) + 1;
    for (PetscInt dy = 0; dy <= cells->reach; dy++)
      for (PetscInt dz = 0; dz <= cells->reach; dz++) cells->along[dy][dz] = CellsWithin(grid->size, radius, dy, dz);
  }
  reach        = cells->reach;
  cells->lines = 0;
  for (PetscInt z = PetscMax(0, cell[2] - reach); z <= PetscMin(grid->n[2] - 1, cell[2] + reach); z++)
    for (PetscInt y = PetscMax(0, cell[1] - reach); y <= PetscMin(grid->n[1] - 1, cell[1] + reach); y++) {
      const PetscInt along = cells->along[PetscAbsInt(y - cell[1])][PetscAbsInt(z - cell[2])],
                     first = PetscMax(0, cell[0] - along), last = PetscMin(grid->n[0] - 1, cell[0] + along),
                     row = CellIndex(grid->n, 0, y, z);
      PetscInt begin, length;

      if (along < 0 || first > last) continue;
      begin  = grid->start[row + first];
      length = grid->start[row + last + 1] - begin;
      if (length == 0) continue;
      cells->line[cells->lines++] = (SortedLine){begin, length};
      n += length;
    }
  return n;
}

void SortedCellsLines(SortedCells *cells, const PetscReal x[DIM], PetscReal radius)
{
  const PetscReal far = (PetscReal)(PETSC_MAX_INT / 2);
  PetscInt        cell[DIM];

  for (PetscInt d = 0; d < DIM; d++)
    cell[d] = (PetscInt)PetscFloorReal(PetscMax(-far, PetscMin(far, (x[d] - cells->grid.lower[d]) / cells->grid.size)));
  (void)FindLines(cells, cell, radius);
}

PetscBool SortedCellsWithin(SortedCells *cells, const PetscReal x[DIM], PetscReal radius)
{
  const PetscReal *cx = cells->sorted, *cy = cx + cells->count, *cz = cy + cells->count;

  SortedCellsLines(cells, x, radius);
  for (PetscInt l = 0; l < cells->lines; l++) { /* the middle line, which is likely to be that of x, comes first */
    const SortedLine line = cells->line[(cells->lines / 2 + l) % cells->lines];

    for (PetscInt k = line.begin; k < line.begin + line.length; k++) {
      const PetscReal d[DIM] = {x[0] - cx[k], x[1] - cy[k], x[2] - cz[k]};

      if (Dot(d, d) <= radius * radius) return PETSC_TRUE;
    }
  }
  return PETSC_FALSE;
}

/* Copies columns of the lines. Each line is copied in whole vectors; the next line overwrites the surplus. A line is
   short, so the loop over the columns is the inner one: a call of memmove for each column of a line takes longer. */
static void CopyColumns(const SortedCells *cells, PetscInt columns)
{
  const PetscReal *from[SORTED_WIDTH];
  PetscReal       *to[SORTED_WIDTH];
  PetscInt         count = 0, at = 0;

  for (PetscInt w = 0; w < SORTED_WIDTH; w++) {
    if (!(columns >> w & 1)) continue;
    from[count] = cells->sorted + w * cells->count;
    to[count++] = cells->near + w * cells->stride;
  }
  for (PetscInt l = 0; l < cells->lines; at += cells->line[l++].length)
    for (PetscInt k = 0; k < cells->line[l].length; k += VECTOR)
      for (PetscInt w = 0; w < count; w++)
        (void)memcpy(to[w] + at + k, from[w] + cells->line[l].begin + k, VECTOR * sizeof(PetscReal));
}

PetscErrorCode SortedCellsCollect(SortedCells *cells, PetscInt c, PetscInt columns, PetscInt copies, PetscInt *n)
{
  PetscInt cell[DIM];

  PetscFunctionBegin;
  CellCoordinates(cells->grid.n, c, cell);
  *n = FindLines(cells, cell, SortedRadius(cells, c));
  if (*n * copies + VECTOR > cells->stride) {
    cells->stride = *n * copies * 2 + VECTOR;
    PetscCall(PetscFree(cells->near));
    PetscCall(PetscMalloc1(SORTED_WIDTH * cells->stride, &cells->near));
  }
  CopyColumns(cells, columns);
  PetscFunctionReturn(PETSC_SUCCESS);
}

void SortedCellsPlaces(const SortedCells *cells, PetscInt n, int32_t index[])
{
  PetscInt line = -1, end = 0, shift = 0;

  for (PetscInt k = 0; k < n; k++) {
    while (index[k] >= end) {
      shift = cells->line[++line].begin - end;
      end += cells->line[line].length;
    }
    index[k] += (int32_t)shift;
  }
}

/* What is copied in single precision: the columns of the particles within the support of a box. */
typedef struct {
  PetscInt         columns;
  const PetscReal *from[SORTED_WIDTH]; /* [columns], the first three the positions */
  float           *to[SORTED_WIDTH];
  PetscReal        origin[DIM];                   /* m */
  float            center[DIM], half[DIM], limit; /* of the box, relative to the origin, m; square of the support, m2 */
} Near;

/* The numbers of WIDE particles, less 'shift'. */
static inline Wide LoadNarrow(const PetscReal from[], PetscReal shift)
{
  typedef PetscReal WideReal __attribute__((vector_size(WIDE * sizeof(PetscReal))));
  WideReal          t;

  (void)memcpy(&t, from, sizeof(t));
  return __builtin_convertvector(t - shift, Wide);
}

/* Copies those of a line; n have been copied before. Returns how many there are then. */
static inline PetscInt CopyNear(const Near *near, SortedLine line, PetscInt n)
{
  for (PetscInt k = 0; k < line.length; k += WIDE) {
    const PetscInt place = line.begin + k;
    Wide           x[DIM], s = WideSet(0);
    WideKept       kept;

    for (PetscInt d = 0; d < DIM; d++) {
      Wide outside;

      x[d]    = LoadNarrow(near->from[d] + place, near->origin[d]);
      outside = (Wide)((WideInteger)(x[d] - near->center[d]) & INT32_MAX) - near->half[d]; /* of the absolute value */
      outside = (Wide)((WideInteger)outside & (outside > 0));
      s += outside * outside;
    }
    kept = WideKeep(WideBelow(s, WideSet(near->limit)), line.length - k);
    for (PetscInt d = 0; d < DIM; d++) WidePack(kept, x[d], near->to[d] + n);
    for (PetscInt w = DIM; w < near->columns; w++)
      WidePack(kept, LoadNarrow(near->from[w] + place, 0), near->to[w] + n);
    n += WideCount(kept);
  }
  return n;
}

PetscErrorCode SortedCellsCollectSingle(SortedCells *cells, PetscInt c, PetscInt columns, const PetscReal lower[DIM],
                                        const PetscReal upper[DIM], PetscInt *m)
{
  Near     near = {.columns = columns, .limit = (float)PetscSqr((1 + ROUNDING) * SortedRadius(cells, c))};
  PetscInt n, cell[DIM];

  PetscFunctionBegin;
  WideStart();
  CellCoordinates(cells->grid.n, c, cell);
  n = FindLines(cells, cell, SortedRadius(cells, c));
  if (n + KERNEL_LANES + WIDE > cells->single_stride) {
    cells->single_stride = (n + n / 4) / KERNEL_LANES * KERNEL_LANES + 3 * KERNEL_LANES;
    PetscCall(PetscFree(cells->single));
    PetscCall(PetscMalloc1(SORTED_WIDTH * cells->single_stride, &cells->single));
  }
  for (PetscInt w = 0; w < columns; w++) {
    near.from[w] = cells->sorted + w * cells->count;
    near.to[w]   = cells->single + w * cells->single_stride;
  }
  for (PetscInt d = 0; d < DIM; d++) {
    near.origin[d] = lower[d];
    near.center[d] = near.half[d] = (float)(0.5 * (upper[d] - lower[d]));
  }
  n = 0;
  for (PetscInt l = 0; l < cells->lines; l++) n = CopyNear(&near, cells->line[l], n);
  for (*m = n; *m % KERNEL_LANES; ++*m)
    for (PetscInt w = 0; w < columns; w++) near.to[w][*m] = w < DIM ? (float)(FAR_AWAY * cells->support) : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SortedCellsReset(SortedCells *cells)
{
  PetscFunctionBegin;
  PetscCall(CellGridReset(&cells->grid));
  PetscCall(PetscFree(cells->sorted));
  PetscCall(PetscFree(cells->near));
  PetscCall(PetscFree(cells->single));
  PetscCall(PetscFree(cells->index));
  PetscCall(PetscFree(cells->largest));
  PetscCall(PetscMemzero(cells, sizeof(*cells)));
  PetscFunctionReturn(PETSC_SUCCESS);
}
