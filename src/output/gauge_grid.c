/* Cells over the fluid: which liquid hangs together with the pool, and which surface the sky sees. */
#include "output_impl.h"

/* Layers of empty cells on top of the fluid, where the sky starts. */
#define SKY_LAYERS 3
/* Above this number of cells they are made larger: a bound of the memory. */
#define MAX_CELLS (1 << 25)
/* The sky enters gaps of this many cells in each direction: single holes between particles do not count as craters. */
#define SKY_GAP 2

static PetscErrorCode SetSizes(Output output, const ParticleArrays *arrays, GaugeGrid *grid)
{
  const Domain domain = output->cloud->domain;
  PetscReal    bounds[2 * DIM]; /* minus the lower ends, the upper ends */
  PetscReal    cells;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < DIM; d++) grid->component[d] = domain->dim == 2 ? (d == 0 ? 0 : 3 - d) : d;
  for (PetscInt k = 0; k < 2 * DIM; k++) bounds[k] = -PETSC_MAX_REAL;
  for (PetscInt a = 0; a < arrays->n; a++) {
    const PetscReal *x = arrays->real[FIELD_POSITION] + DIM * a;

    if (arrays->integer[INT_LAYER][a]) continue;
    for (PetscInt d = 0; d < DIM; d++) {
      const PetscReal s = x[grid->component[d]];

      if (-s > bounds[d]) bounds[d] = -s;
      if (s > bounds[DIM + d]) bounds[DIM + d] = s;
    }
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, bounds, 2 * DIM, MPIU_REAL, MPIU_MAX, output->comm));
  for (PetscInt d = 0; d < DIM; d++) { /* no fluid at all: one cell */
    if (bounds[DIM + d] < -bounds[d]) bounds[d] = bounds[DIM + d] = 0;
    grid->lower[d] = -bounds[d];
  }
  for (grid->size = output->gauge.cell * domain->spacing;; grid->size *= 1.25) {
    cells = 1;
    for (PetscInt d = 0; d < DIM; d++)
      cells *= PetscFloorReal((bounds[DIM + d] + bounds[d]) / grid->size) + 3 + (d == 2 ? SKY_LAYERS : 0);
    if (cells <= MAX_CELLS) break;
  }
  for (PetscInt d = 0; d < DIM; d++)
    grid->n[d] = (PetscInt)PetscFloorReal((bounds[DIM + d] + bounds[d]) / grid->size) + 3 + (d == 2 ? SKY_LAYERS : 0);
  grid->columns = grid->n[0] * grid->n[1];
  grid->count   = grid->columns * grid->n[2];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GaugeGridCreate(Output output, const ParticleArrays *arrays, GaugeGrid *grid)
{
  PetscFunctionBegin;
  PetscCall(SetSizes(output, arrays, grid));
  PetscCall(PetscCalloc1(grid->count, &grid->cell));
  PetscCall(PetscMalloc1(grid->count, &grid->queue));
  for (PetscInt a = 0; a < arrays->n; a++) {
    PetscInt index[DIM], c;

    if (arrays->integer[INT_LAYER][a]) continue;
    c = GaugeGridCell(grid, arrays->real[FIELD_POSITION] + DIM * a, index);
    if (c >= 0)
      grid->cell[c] |= arrays->integer[INT_BODY][a] == output->gauge.pool ? CELL_LIQUID | CELL_BODY : CELL_LIQUID;
  }
  PetscCallMPI(
    MPI_Allreduce(MPI_IN_PLACE, grid->cell, (PetscMPIInt)grid->count, MPI_UNSIGNED_CHAR, MPI_BOR, output->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GaugeGridDestroy(GaugeGrid *grid)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(grid->cell));
  PetscCall(PetscFree(grid->queue));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void GaugeGridPool(GaugeGrid *grid)
{
  PetscInt step[26], steps = 0, end = 0, best_start = 0, best_end = 0, best = 0;

  for (PetscInt k = -1; k <= 1; k++)
    for (PetscInt j = -1; j <= 1; j++)
      for (PetscInt i = -1; i <= 1; i++)
        if (i || j || k) step[steps++] = (k * grid->n[1] + j) * grid->n[0] + i;
  for (PetscInt seed = 0; seed < grid->count; seed++) {
    const PetscInt start = end;
    PetscInt       body  = 0;

    if ((grid->cell[seed] & (CELL_BODY | CELL_VISITED)) != CELL_BODY) continue;
    grid->cell[seed] |= CELL_VISITED;
    grid->queue[end++] = seed;
    for (PetscInt head = start; head < end; head++) { /* the rim is empty: no step leaves the grid */
      const PetscInt c = grid->queue[head];

      body += (grid->cell[c] & CELL_BODY) != 0;
      for (PetscInt s = 0; s < 26; s++) {
        const PetscInt next = c + step[s];

        if ((grid->cell[next] & (CELL_LIQUID | CELL_VISITED)) != CELL_LIQUID) continue;
        grid->cell[next] |= CELL_VISITED;
        grid->queue[end++] = next;
      }
    }
    if (body > best) {
      best       = body;
      best_start = start;
      best_end   = end;
    }
  }
  for (PetscInt k = best_start; k < best_end; k++) grid->cell[grid->queue[k]] |= CELL_POOL;
}

/* Blocks of SKY_GAP cells a side, named by their first cell. */
typedef struct {
  PetscInt cells, offset[SKY_GAP * SKY_GAP * SKY_GAP];
} Block;

static void BlockSet(const GaugeGrid *grid, PetscInt dim, Block *block)
{
  block->cells = 0;
  for (PetscInt k = 0; k < SKY_GAP; k++)
    for (PetscInt j = 0; j < (dim == 2 ? 1 : SKY_GAP); j++)
      for (PetscInt i = 0; i < SKY_GAP; i++) block->offset[block->cells++] = (k * grid->n[1] + j) * grid->n[0] + i;
}

/* Tests a block once: inside the columns, above the bottom rim, and without liquid of the pool. */
static PetscBool BlockEnter(GaugeGrid *grid, const Block *block, const PetscBool inside[], PetscInt c)
{
  PetscInt column;

  if (c < grid->columns || grid->cell[c] & CELL_TESTED) return PETSC_FALSE;
  grid->cell[c] |= CELL_TESTED;
  column = c % grid->columns;
  for (PetscInt b = 0; b < block->cells; b++) {
    const PetscInt in_layer = block->offset[b] % grid->columns;

    if (!inside[column + in_layer] || grid->cell[c + block->offset[b]] & CELL_POOL) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

void GaugeGridSky(GaugeGrid *grid, PetscInt dim, const PetscBool inside[], PetscInt lowest[])
{
  const PetscInt step[2 * DIM] = {-1, 1, -grid->n[0], grid->n[0], -grid->columns, grid->columns};
  const PetscInt top = (grid->n[2] - 1 - SKY_GAP) * grid->columns, last = top + grid->columns;
  PetscInt       end = 0;
  Block          block;

  BlockSet(grid, dim, &block);
  for (PetscInt c = 0; c < grid->columns; c++) lowest[c] = grid->n[2];
  for (PetscInt c = 0; c < grid->columns; c++)
    if (inside[c] && BlockEnter(grid, &block, inside, top + c)) grid->queue[end++] = top + c;
  for (PetscInt head = 0; head < end; head++) {
    const PetscInt c = grid->queue[head];

    for (PetscInt b = 0; b < block.cells; b++) {
      const PetscInt cell = c + block.offset[b], column = cell % grid->columns;

      lowest[column] = PetscMin(lowest[column], cell / grid->columns);
    }
    for (PetscInt s = 0; s < 2 * DIM; s++) {
      const PetscInt next = c + step[s];

      if (next < last && BlockEnter(grid, &block, inside, next)) grid->queue[end++] = next;
    }
  }
}
