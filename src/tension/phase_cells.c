/* The liquid sorted into cells, and the part of it around a cell in columns, over which the compiler can vectorise. */
#include "tension_impl.h"

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
    PetscCall(PetscMalloc1(LIQUID_WIDTH * liquid->capacity, &liquid->sorted));
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

/* Copies columns of the 'length' particles from 'begin' on behind the n collected ones. */
static void CopyLine(Liquid *liquid, PetscInt n, PetscInt begin, PetscInt length, PetscInt columns)
{
  for (PetscInt w = 0; columns >> w; w++) {
    PetscReal *restrict to         = liquid->near + w * liquid->stride + n;
    const PetscReal *restrict from = liquid->sorted + w * liquid->count + begin;

    if (!(columns >> w & 1)) continue;
    SIMD_LOOP()
    for (PetscInt k = 0; k < length; k++) to[k] = from[k];
  }
}

/* The same in single precision, positions relative to 'origin'. */
static void NarrowLine(Liquid *liquid, PetscInt n, PetscInt begin, PetscInt length, PetscInt columns,
                       const PetscReal origin[DIM])
{
  for (PetscInt w = 0; columns >> w; w++) {
    float *restrict to             = liquid->single + w * liquid->single_stride + n;
    const PetscReal *restrict from = liquid->sorted + w * liquid->count + begin, shift = w < DIM ? origin[w] : 0;

    if (!(columns >> w & 1)) continue;
    SIMD_LOOP()
    for (PetscInt k = 0; k < length; k++) to[k] = (float)(from[k] - shift);
  }
}

/* One pass over the cells around c: counts the particles and copies the columns whose bits are set, to 'near' or, with
   an origin, to 'single'. */
static PetscInt Gather(Liquid *liquid, PetscInt c, PetscInt columns, const PetscReal origin[])
{
  const CellGrid *grid  = &liquid->grid;
  const PetscInt  reach = liquid->reach;
  PetscInt        n     = 0, cell[DIM];

  CellCoordinates(grid->n, c, cell);
  for (PetscInt z = PetscMax(0, cell[2] - reach); z <= PetscMin(grid->n[2] - 1, cell[2] + reach); z++)
    for (PetscInt y = PetscMax(0, cell[1] - reach); y <= PetscMin(grid->n[1] - 1, cell[1] + reach); y++) {
      const PetscInt along = liquid->along[PetscAbsInt(y - cell[1])][PetscAbsInt(z - cell[2])],
                     line  = CellIndex(grid->n, 0, y, z);
      PetscInt begin, length;

      if (along < 0) continue;
      begin  = grid->start[line + PetscMax(0, cell[0] - along)];
      length = grid->start[line + PetscMin(grid->n[0] - 1, cell[0] + along) + 1] - begin;
      if (origin)
        NarrowLine(liquid, n, begin, length, columns, origin);
      else
        CopyLine(liquid, n, begin, length, columns);
      n += length;
    }
  return n;
}

PetscErrorCode LiquidCollect(Liquid *liquid, PetscInt c, PetscInt columns, PetscInt copies, PetscInt *n)
{
  const PetscReal radius = liquid->support * (liquid->largest ? liquid->largest[c] : 1);

  PetscFunctionBegin;
  if (radius != liquid->radius) SetReach(liquid, radius);
  *n = Gather(liquid, c, 0, NULL);
  if (*n * copies > liquid->stride) {
    liquid->stride = *n * copies * 2;
    PetscCall(PetscFree(liquid->near));
    PetscCall(PetscMalloc1(LIQUID_WIDTH * liquid->stride, &liquid->near));
  }
  Gather(liquid, c, columns, NULL);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode LiquidCollectSingle(Liquid *liquid, PetscInt c, PetscInt columns, const PetscReal origin[DIM],
                                   PetscInt *m)
{
  const PetscInt n = Gather(liquid, c, 0, NULL);

  PetscFunctionBegin;
  *m = (n + KERNEL_LANES - 1) / KERNEL_LANES * KERNEL_LANES;
  if (*m > liquid->single_stride) {
    liquid->single_stride = *m + *m / 4 / KERNEL_LANES * KERNEL_LANES;
    PetscCall(PetscFree(liquid->single));
    PetscCall(PetscMalloc1(LIQUID_WIDTH * liquid->single_stride, &liquid->single));
  }
  Gather(liquid, c, columns, origin);
  for (PetscInt w = 0; columns >> w; w++)
    for (PetscInt k = n; k < *m; k++)
      liquid->single[w * liquid->single_stride + k] = w < DIM ? (float)(FAR_AWAY * liquid->support) : 0;
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
