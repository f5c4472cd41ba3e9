/* Cells over the fluid: the liquid connected with the pool, and the surface below the open sky. */
#include "gauges_impl.h"

#define SKY_LAYERS 3         /* of empty cells on top of the fluid, where the sky starts */
#define SKY_GAP    2         /* cells a side of a gap that the sky enters: holes between particles are narrower */
#define MAX_CELLS  (1 << 25) /* bounds the memory: a scene with more gets larger cells */
#define COARSENING 1.25      /* factor of one enlargement */
#define ROWS       4         /* of cells that touch a row of cells along x, at edges too, and come before it */
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

/* The first cell of the run of liquid along x that has the cell, and the cell behind it. The rim is empty, so no run
   leaves its row. */
static PetscInt RunFirst(const CraterGrid *grid, PetscInt cell)
{
  while (grid->cell[cell - 1] & CELL_LIQUID) cell--;
  return cell;
}
static PetscInt RunEnd(const CraterGrid *grid, PetscInt cell)
{
  while (grid->cell[cell] & CELL_LIQUID) cell++;
  return cell;
}

/* Joins the run from 'first' on with those that it touches in the rows before its own, at corners too. row: steps to
   these rows. */
static void JoinRun(CraterGrid *grid, const PetscInt row[ROWS], PetscInt first)
{
  const PetscInt end = RunEnd(grid, first);

  for (PetscInt r = 0; r < ROWS; r++)
    for (PetscInt c = first - 1 + row[r]; c <= end + row[r]; c++)
      if (grid->cell[c] & CELL_LIQUID) {
        PieceJoin(grid->piece, RunFirst(grid, c), first);
        c = RunEnd(grid, c);
      }
}

/* Marks CELL_POOL: the component with the most cells of the pool's body. The runs are the members of pieces, each at
   its first cell. */
static PetscErrorCode MarkPool(CraterGrid *grid)
{
  PetscInt row[ROWS], first, end, pieces, best = 0, *body;

  PetscFunctionBegin;
  for (PetscInt r = 0; r < ROWS; r++) row[r] = CellIndex(grid->n, 0, r % 3 - 1, r / 3 - 1);
  SharedSlice(&grid->shared, grid->count, &first, &end);
  for (PetscInt c = first; c < end; c++)
    grid->piece[c] = grid->cell[c] & CELL_LIQUID && !(grid->cell[c - 1] & CELL_LIQUID) ? c : -1;
  PetscCall(SharedFence(&grid->shared));
  for (PetscInt c = first; c < end; c++)
    if (grid->piece[c] >= 0) JoinRun(grid, row, c);
  PetscCall(PiecesNumber(&grid->shared, grid->count, grid->piece, &pieces));
  PetscCall(PetscCalloc1(pieces + 1, &body));
  for (PetscInt c = first; c < end; c++)
    for (PetscInt k = c; grid->piece[c] >= 0 && grid->cell[k] & CELL_LIQUID; k++)
      body[grid->piece[c]] += (grid->cell[k] & CELL_BODY) != 0;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, body, (PetscMPIInt)pieces, MPIU_INT, MPI_SUM, grid->shared.machine));
  for (PetscInt k = 0; k < pieces; k++)
    if (body[k] > body[best]) best = k;
  for (PetscInt c = first; c < end && body[best]; c++)
    for (PetscInt k = c; grid->piece[c] == best && grid->cell[k] & CELL_LIQUID; k++) grid->cell[k] |= CELL_POOL;
  PetscCall(PetscFree(body));
  PetscCall(SharedFence(&grid->shared));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CraterGridCreate(Gauges gauges, PetscInt pool, const ParticleArrays *arrays, CraterGrid *grid)
{
  const Domain domain = gauges->cloud->domain;

  PetscFunctionBegin;
  PetscCall(SetSizes(gauges, arrays, grid));
  {
    const PetscInt    columns  = grid->columns;
    const SharedArray shared[] = {{&grid->cell, grid->count, 1},
                                  {&grid->piece, grid->count + 1, sizeof(PetscInt)},
                                  {&grid->lowest, columns, sizeof(PetscInt)},
                                  {&grid->radius, columns, sizeof(PetscReal)},
                                  {&grid->top, columns, sizeof(PetscReal)},
                                  {&grid->inside, columns, sizeof(PetscBool)}};

    PetscCall(SharedCreate(gauges->comm, PETSC_STATIC_ARRAY_LENGTH(shared), shared, &grid->shared));
  }
  for (PetscInt a = 0; a < arrays->n; a++) {
    const unsigned char kind = arrays->integer[INT_BODY][a] == pool ? CELL_LIQUID | CELL_BODY : CELL_LIQUID;
    PetscInt            first[DIM], last[DIM], at[DIM];

    if (arrays->integer[INT_LAYER][a]) continue;
    if (!CraterGridReach(grid, arrays->real[FIELD_POSITION] + DIM * a, ParticleSize(domain, arrays, a), domain->spacing,
                         first, last))
      continue;
    for (PetscInt d = 0; d < DIM; d++) at[d] = first[d];
    do SharedOr(&grid->cell[CellIndex(grid->n, at[0], at[1], at[2])], kind);
    while (CellNext(first, last, at));
  }
  PetscCall(SharedReduce(&grid->shared, grid->cell, grid->count, MPI_UNSIGNED_CHAR, MPI_BOR));
  PetscCall(MarkPool(grid));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CraterGridDestroy(CraterGrid *grid)
{
  PetscFunctionBegin;
  PetscCall(SharedDestroy(&grid->shared));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the block of SKY_GAP cells a side from this cell on has room for the sky: inside the columns, above the
   bottom rim, and without liquid of the pool. */
static PetscBool IsRoom(const CraterGrid *grid, PetscInt dim, PetscInt cell)
{
  for (PetscInt k = 0; k < SKY_GAP; k++)
    for (PetscInt j = 0; j < (dim == 2 ? 1 : SKY_GAP); j++)
      for (PetscInt i = 0; i < SKY_GAP; i++) {
        const PetscInt c = cell + CellIndex(grid->n, i, j, k);

        if (!grid->inside[c % grid->columns] || grid->cell[c] & CELL_POOL) return PETSC_FALSE;
      }
  return PETSC_TRUE;
}

/* The blocks are the members of pieces, each at its first cell; that of the sky has the place behind the cells. */
PetscErrorCode CraterGridSky(CraterGrid *grid, PetscInt dim)
{
  const PetscInt back[DIM] = {1, grid->n[0], grid->columns}, sky = grid->count;
  const PetscInt top = (grid->n[2] - 1 - SKY_GAP) * grid->columns, last = top + grid->columns;
  PetscInt       first, end;

  PetscFunctionBegin;
  SharedSlice(&grid->shared, grid->count, &first, &end);
  for (PetscInt c = first; c < end; c++)
    grid->piece[c] = c >= grid->columns && c < last && IsRoom(grid, dim, c) ? c : -1;
  if (grid->shared.leads) {
    grid->piece[sky] = sky;
    for (PetscInt c = 0; c < grid->columns; c++) grid->lowest[c] = grid->n[2];
  }
  PetscCall(SharedFence(&grid->shared));
  for (PetscInt c = first; c < end; c++) {
    if (grid->piece[c] < 0) continue;
    for (PetscInt d = 0; d < DIM; d++)
      if (grid->piece[c - back[d]] >= 0) PieceJoin(grid->piece, c - back[d], c);
    if (c >= top) PieceJoin(grid->piece, c, sky);
  }
  PetscCall(SharedFence(&grid->shared));
  for (PetscInt c = first; c < end; c++) {
    if (grid->piece[c] < 0 || PieceFirst(grid->piece, c) != PieceFirst(grid->piece, sky)) continue;
    for (PetscInt j = 0; j < (dim == 2 ? 1 : SKY_GAP); j++)
      for (PetscInt i = 0; i < SKY_GAP; i++)
        SharedMin(&grid->lowest[(c + CellIndex(grid->n, i, j, 0)) % grid->columns], c / grid->columns);
  }
  PetscCall(SharedFence(&grid->shared));
  PetscFunctionReturn(PETSC_SUCCESS);
}
