/* The liquid sorted into cells, and the part of it around a cell in columns, over which the compiler can vectorise. */
#include "tension_impl.h"

#define VECTOR   8  /* numbers that are copied at once */
#define FAR_AWAY 10 /* supports, of what fills up the last vector */

/* The largest size of the liquid's level in each cell, from which LiquidCollect knows how far to reach. */
static PetscErrorCode FindLargest(Liquid *liquid, Cloud cloud)
{
  PetscFunctionBegin;
  if (!cloud->size) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree(liquid->largest));
  PetscCall(PetscCalloc1(liquid->grid.count, &liquid->largest));
  for (PetscInt k = 0; k < liquid->count; k++) {
    PetscReal *largest = &liquid->largest[liquid->grid.of_point[k]], size = cloud->size[liquid->index[k]];

    if (LiquidHas(liquid, cloud, liquid->index[k])) *largest = PetscMax(*largest, size);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The cells within a radius (m). */
static void SetReach(Liquid *liquid, PetscReal radius)
{
  liquid->radius = radius;
  liquid->reach  = (PetscInt)(radius / liquid->grid.size) + 1;
  for (PetscInt dy = 0; dy <= liquid->reach; dy++)
    for (PetscInt dz = 0; dz <= liquid->reach; dz++)
      liquid->along[dy][dz] = CellsAlong(liquid->grid.size, radius, dy, dz);
}

PetscErrorCode LiquidSort(Liquid *liquid, Cloud cloud, PetscReal support, PetscReal largest, const unsigned char keep[],
                          PetscInt bits)
{
  const PetscInt *layer = cloud->integer[INT_LAYER],
                 across = (PetscInt)(support / (LIQUID_CELL * cloud->domain->spacing)),
                 least  = cloud->size ? LIQUID_CELLS_GRADED : LIQUID_CELLS_LEAST,
                 cells  = PetscMax(least, PetscMin(LIQUID_CELLS_MOST, across));
  PetscReal *x;

  PetscFunctionBegin;
  if (cloud->n_total > liquid->capacity) {
    liquid->capacity = cloud->n_total + cloud->n_total / 8;
    PetscCall(PetscFree(liquid->sorted));
    PetscCall(PetscFree(liquid->index));
    PetscCall(PetscCalloc1(LIQUID_WIDTH * liquid->capacity + VECTOR, &liquid->sorted));
    PetscCall(PetscMalloc1(liquid->capacity, &liquid->index));
  }
  liquid->support = support;
  liquid->count   = 0;
  for (PetscInt a = 0; a < cloud->n_total; a++)
    if (layer[a] == 0 && (!keep || keep[a] & bits)) liquid->index[liquid->count++] = a;
  PetscCall(PetscMalloc1(DIM * liquid->count, &x));
  for (PetscInt k = 0; k < liquid->count; k++)
    for (PetscInt d = 0; d < DIM; d++) x[DIM * k + d] = cloud->field[FIELD_POSITION][DIM * liquid->index[k] + d];
  PetscCall(CellGridBuild(&liquid->grid, cloud->domain->dim, liquid->count, x, largest * support / cells, 1));
  for (PetscInt k = 0; k < liquid->count; k++)
    for (PetscInt d = 0; d < DIM; d++) liquid->sorted[d * liquid->count + k] = x[DIM * liquid->grid.order[k] + d];
  PetscCall(PetscFree(x));
  PetscCall(FindLargest(liquid, cloud));
  SetReach(liquid, support);
  PetscFunctionReturn(PETSC_SUCCESS);
}

void LiquidLoad(Liquid *liquid, PetscInt column, PetscInt width, const PetscReal field[])
{
  for (PetscInt w = 0; w < width; w++)
    for (PetscInt k = 0; k < liquid->count; k++)
      liquid->sorted[(column + w) * liquid->count + k] = field[width * LiquidParticle(liquid, k) + w];
}

/* Finds what is within the support of cell c: lines of neighbouring cells, whose particles stand one behind the other.
   Returns the number of these particles. */
static PetscInt FindLines(Liquid *liquid, PetscInt c)
{
  const CellGrid *grid   = &liquid->grid;
  const PetscReal radius = LiquidRadius(liquid, c);
  PetscInt        n      = 0, reach, cell[DIM];

  if (radius != liquid->radius) SetReach(liquid, radius);
  reach         = liquid->reach;
  liquid->lines = 0;
  CellCoordinates(grid->n, c, cell);
  for (PetscInt z = PetscMax(0, cell[2] - reach); z <= PetscMin(grid->n[2] - 1, cell[2] + reach); z++)
    for (PetscInt y = PetscMax(0, cell[1] - reach); y <= PetscMin(grid->n[1] - 1, cell[1] + reach); y++) {
      const PetscInt along = liquid->along[PetscAbsInt(y - cell[1])][PetscAbsInt(z - cell[2])],
                     row   = CellIndex(grid->n, 0, y, z);
      PetscInt begin, length;

      if (along < 0) continue;
      begin  = grid->start[row + PetscMax(0, cell[0] - along)];
      length = grid->start[row + PetscMin(grid->n[0] - 1, cell[0] + along) + 1] - begin;
      if (length == 0) continue;
      liquid->line[liquid->lines++] = (LiquidLine){begin, length};
      n += length;
    }
  return n;
}

/* Functions that copy a column of the lines, less 'shift'. Each line is copied in whole vectors, of which the next one
   overwrites the end. */
#define COPY_COLUMN(Name, Type)                                                                                        \
  static void Name(const Liquid *liquid, const PetscReal from[], PetscReal shift, Type *restrict to)                   \
  {                                                                                                                    \
    for (PetscInt l = 0; l < liquid->lines; to += liquid->line[l++].length)                                            \
      for (PetscInt k = 0; k < liquid->line[l].length; k += VECTOR) {                                                  \
        const PetscReal *restrict piece = from + liquid->line[l].begin + k;                                            \
                                                                                                                       \
        SIMD_LOOP()                                                                                                    \
        for (PetscInt i = 0; i < VECTOR; i++) to[k + i] = (Type)(piece[i] - shift);                                    \
      }                                                                                                                \
  }

COPY_COLUMN(CopyColumn, PetscReal)
COPY_COLUMN(NarrowColumn, float)

PetscErrorCode LiquidCollect(Liquid *liquid, PetscInt c, PetscInt columns, PetscInt copies, PetscInt *n)
{
  PetscFunctionBegin;
  *n = FindLines(liquid, c);
  if (*n * copies + VECTOR > liquid->stride) {
    liquid->stride = *n * copies * 2 + VECTOR;
    PetscCall(PetscFree(liquid->near));
    PetscCall(PetscMalloc1(LIQUID_WIDTH * liquid->stride, &liquid->near));
  }
  for (PetscInt w = 0; w < LIQUID_WIDTH; w++)
    if (columns >> w & 1) CopyColumn(liquid, liquid->sorted + w * liquid->count, 0, liquid->near + w * liquid->stride);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode LiquidCollectSingle(Liquid *liquid, PetscInt c, PetscInt columns, const PetscReal origin[DIM],
                                   PetscInt *m)
{
  const PetscInt n = FindLines(liquid, c);

  PetscFunctionBegin;
  *m = (n + KERNEL_LANES - 1) / KERNEL_LANES * KERNEL_LANES;
  if (*m + VECTOR > liquid->single_stride) {
    liquid->single_stride = *m + (*m / 4 + VECTOR) / KERNEL_LANES * KERNEL_LANES + KERNEL_LANES;
    PetscCall(PetscFree(liquid->single));
    PetscCall(PetscMalloc1(LIQUID_WIDTH * liquid->single_stride, &liquid->single));
  }
  for (PetscInt w = 0; w < LIQUID_WIDTH; w++) {
    float *column = liquid->single + w * liquid->single_stride;

    if (!(columns >> w & 1)) continue;
    NarrowColumn(liquid, liquid->sorted + w * liquid->count, w < DIM ? origin[w] : 0, column);
    for (PetscInt k = n; k < *m; k++) column[k] = w < DIM ? (float)(FAR_AWAY * liquid->support) : 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode LiquidReset(Liquid *liquid)
{
  PetscFunctionBegin;
  PetscCall(CellGridReset(&liquid->grid));
  PetscCall(PetscFree(liquid->sorted));
  PetscCall(PetscFree(liquid->near));
  PetscCall(PetscFree(liquid->single));
  PetscCall(PetscFree(liquid->index));
  PetscCall(PetscFree(liquid->largest));
  PetscFunctionReturn(PETSC_SUCCESS);
}
