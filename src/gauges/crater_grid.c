/* Cells over the fluid: the liquid connected with the pool, and the surface below the open sky. */
#include "gauges_impl.h"

#define SKY_LAYERS 3         /* of empty cells on top of the fluid, where the sky starts */
#define SKY_GAP    2         /* cells a side of a gap that the sky enters: holes between particles are narrower */
#define MAX_CELLS  (1 << 25) /* bounds the memory: a scene with more gets larger cells */
#define COARSENING 1.25      /* factor of one enlargement */
#define ROWS       8         /* of cells that touch a row of cells along x, at edges too */
#define CELL_SIZE  1.25      /* spacings: a lattice of particles leaves no such cell empty */

/* Bounds of the fluid of all ranks along the grid's axes, m: minus the lower bounds, then the upper bounds. */
static PetscErrorCode FluidBounds(Gauges gauges, const ParticleArrays *arrays, const PetscInt component[],
                                  PetscReal bounds[2 * DIM])
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2 * DIM; k++) bounds[k] = -PETSC_MAX_REAL;
  for (PetscInt a = 0; a < arrays->n; a++) {
    const PetscReal *x = arrays->real[FIELD_POSITION] + DIM * a;

    if (arrays->integer[INT_LAYER][a]) continue;
    for (PetscInt d = 0; d < DIM; d++) {
      const PetscReal s = x[component[d]];

      if (-s > bounds[d]) bounds[d] = -s;
      if (s > bounds[DIM + d]) bounds[DIM + d] = s;
    }
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, bounds, 2 * DIM, MPIU_REAL, MPIU_MAX, gauges->comm));
  for (PetscInt d = 0; d < DIM; d++) /* no fluid at all: one cell */
    if (bounds[DIM + d] < -bounds[d]) bounds[d] = bounds[DIM + d] = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Cells along an axis of the grid: over the fluid, two of the rim, and the sky's. */
static PetscReal CellsAlong(const PetscReal bounds[2 * DIM], PetscInt d, PetscReal size)
{
  return PetscFloorReal((bounds[DIM + d] + bounds[d]) / size) + 3 + (d == 2 ? SKY_LAYERS : 0);
}

static PetscErrorCode SetSizes(Gauges gauges, const ParticleArrays *arrays, CraterGrid *grid)
{
  const Domain domain = gauges->cloud->domain;
  PetscReal    bounds[2 * DIM];

  PetscFunctionBegin;
  for (PetscInt d = 0; d < DIM; d++) grid->component[d] = domain->dim == 2 ? (d == 0 ? 0 : 3 - d) : d;
  PetscCall(FluidBounds(gauges, arrays, grid->component, bounds));
  grid->size = CELL_SIZE * domain->spacing;
  while (CellsAlong(bounds, 0, grid->size) * CellsAlong(bounds, 1, grid->size) * CellsAlong(bounds, 2, grid->size) >
         MAX_CELLS)
    grid->size *= COARSENING;
  for (PetscInt d = 0; d < DIM; d++) {
    grid->lower[d] = -bounds[d];
    grid->n[d]     = (PetscInt)CellsAlong(bounds, d, grid->size);
  }
  grid->columns = grid->n[0] * grid->n[1];
  grid->count   = grid->columns * grid->n[2];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Visits the run of liquid along x that has cell c: queues its first cell behind 'end', and adds its cells with liquid
   of the pool's body. Returns the cell behind the run. The rim is empty, so no run leaves its row. */
static PetscInt Enter(CraterGrid *grid, PetscInt c, PetscInt *end, PetscInt *body)
{
  while (grid->cell[c - 1] & CELL_LIQUID) c--;
  grid->queue[(*end)++] = c;
  for (; grid->cell[c] & CELL_LIQUID; c++) {
    grid->cell[c] |= CELL_VISITED;
    *body += (grid->cell[c] & CELL_BODY) != 0;
  }
  return c;
}

/* Visits all liquid connected with the cell 'seed', at corners too: afterwards queue[start .. end) holds the first
   cells of its runs. Returns 'end'. row: steps to the rows around one; body: number of the cells with liquid of the
   pool's body. */
static PetscInt Flood(CraterGrid *grid, const PetscInt row[ROWS], PetscInt seed, PetscInt start, PetscInt *body)
{
  PetscInt end = start;

  *body = 0;
  (void)Enter(grid, seed, &end, body);
  for (PetscInt head = start; head < end; head++) {
    const PetscInt first = grid->queue[head];
    PetscInt       last  = first;

    while (grid->cell[last + 1] & CELL_LIQUID) last++;
    for (PetscInt r = 0; r < ROWS; r++)
      for (PetscInt c = first - 1 + row[r]; c <= last + 1 + row[r]; c++)
        if ((grid->cell[c] & (CELL_LIQUID | CELL_VISITED)) == CELL_LIQUID) c = Enter(grid, c, &end, body);
  }
  return end;
}

/* Marks CELL_POOL: the component with the most cells of the pool's body. */
static void MarkPool(CraterGrid *grid)
{
  PetscInt row[ROWS], rows = 0, end = 0, best_start = 0, best_end = 0, best = 0;

  for (PetscInt c = 0; c < ROWS + 1; c++)
    if (c != ROWS / 2) row[rows++] = CellIndex(grid->n, 0, c % 3 - 1, c / 3 - 1);
  for (PetscInt seed = 0; seed < grid->count; seed++) {
    const PetscInt start = end;
    PetscInt       body;

    if ((grid->cell[seed] & (CELL_BODY | CELL_VISITED)) != CELL_BODY) continue;
    end = Flood(grid, row, seed, start, &body);
    if (body > best) {
      best       = body;
      best_start = start;
      best_end   = end;
    }
  }
  for (PetscInt k = best_start; k < best_end; k++)
    for (PetscInt c = grid->queue[k]; grid->cell[c] & CELL_LIQUID; c++) grid->cell[c] |= CELL_POOL;
}

PetscErrorCode CraterGridCreate(Gauges gauges, PetscInt pool, const ParticleArrays *arrays, CraterGrid *grid)
{
  const Domain domain = gauges->cloud->domain;

  PetscFunctionBegin;
  PetscCall(SetSizes(gauges, arrays, grid));
  PetscCall(SharedCreate(gauges->comm, (size_t)grid->count, &grid->shared));
  grid->cell = (unsigned char *)grid->shared.data;
  PetscCall(PetscMalloc1(grid->shared.leads ? grid->count : 0, &grid->queue));
  for (PetscInt a = 0; a < arrays->n; a++) {
    PetscInt first[DIM], last[DIM], at[DIM];

    if (arrays->integer[INT_LAYER][a]) continue;
    if (!CraterGridReach(grid, arrays->real[FIELD_POSITION] + DIM * a, ParticleSize(domain, arrays, a), domain->spacing,
                         first, last))
      continue;
    for (PetscInt d = 0; d < DIM; d++) at[d] = first[d];
    do
      SharedOr(&grid->cell[CellIndex(grid->n, at[0], at[1], at[2])],
               arrays->integer[INT_BODY][a] == pool ? CELL_LIQUID | CELL_BODY : CELL_LIQUID);
    while (CellNext(first, last, at));
  }
  PetscCall(SharedReduce(&grid->shared, grid->cell, grid->count, MPI_UNSIGNED_CHAR, MPI_BOR));
  if (grid->shared.leads) MarkPool(grid);
  PetscCall(SharedFence(&grid->shared));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CraterGridDestroy(CraterGrid *grid)
{
  PetscFunctionBegin;
  PetscCall(SharedDestroy(&grid->shared));
  PetscCall(PetscFree(grid->queue));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A block of SKY_GAP cells a side; its first cell identifies it. */
typedef struct {
  PetscInt cells, offset[SKY_GAP * SKY_GAP * SKY_GAP];
} Block;

static void BlockSet(const CraterGrid *grid, PetscInt dim, Block *block)
{
  block->cells = 0;
  for (PetscInt k = 0; k < SKY_GAP; k++)
    for (PetscInt j = 0; j < (dim == 2 ? 1 : SKY_GAP); j++)
      for (PetscInt i = 0; i < SKY_GAP; i++) block->offset[block->cells++] = CellIndex(grid->n, i, j, k);
}

/* Whether the sky may enter block c: the block is inside the columns, above the bottom rim, and without liquid of the
   pool. True at most once for a block. */
static PetscBool BlockEnter(CraterGrid *grid, const Block *block, const PetscBool inside[], PetscInt c)
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

/* CraterGridSky on the rank that leads. */
static void FindSky(CraterGrid *grid, PetscInt dim, const PetscBool inside[], PetscInt lowest[])
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

PetscErrorCode CraterGridSky(CraterGrid *grid, PetscInt dim, const PetscBool inside[], PetscInt lowest[])
{
  PetscFunctionBegin;
  if (grid->shared.leads) FindSky(grid, dim, inside, lowest);
  PetscCallMPI(MPI_Bcast(lowest, (PetscMPIInt)grid->columns, MPIU_INT, 0, grid->shared.machine));
  PetscFunctionReturn(PETSC_SUCCESS);
}
