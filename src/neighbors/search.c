/* Cells over the points of the cloud, and the list of neighbours. */
#include "search.h"

PetscErrorCode CellGridReset(CellGrid *grid)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(grid->start));
  PetscCall(PetscFree(grid->order));
  PetscCall(PetscFree(grid->of_point));
  PetscCall(PetscMemzero(grid, sizeof(*grid)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* More cells than this many a point would cost more than they save: the cells are made larger. */
#define CELLS_PER_POINT 4

PetscErrorCode CellGridBuild(CellGrid *grid, PetscInt dim, PetscInt n, const PetscReal x[], PetscReal size)
{
  PetscReal upper[DIM], cells = 1;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < DIM; d++) {
    grid->lower[d] = n ? x[d] : 0;
    upper[d]       = n ? x[d] : 0;
    for (PetscInt a = 1; a < n; a++) {
      grid->lower[d] = PetscMin(grid->lower[d], x[DIM * a + d]);
      upper[d]       = PetscMax(upper[d], x[DIM * a + d]);
    }
  }
  for (grid->size = size;; grid->size *= 1.25) {
    cells = 1;
    for (PetscInt d = 0; d < DIM; d++)
      cells *= d < dim ? PetscFloorReal((upper[d] - grid->lower[d]) / grid->size) + 1 : 1;
    if (cells <= CELLS_PER_POINT * (PetscReal)n + 1000) break;
  }
  for (PetscInt d = 0; d < DIM; d++)
    grid->n[d] = d < dim ? (PetscInt)((upper[d] - grid->lower[d]) / grid->size) + 1 : 1;
  grid->count = grid->n[0] * grid->n[1] * grid->n[2];
  if (grid->count + 1 > grid->capacity) {
    grid->capacity = grid->count + 1 + grid->count / 4;
    PetscCall(PetscFree(grid->start));
    PetscCall(PetscMalloc1(grid->capacity, &grid->start));
  }
  if (n > grid->point_capacity) {
    grid->point_capacity = n + n / 4;
    PetscCall(PetscFree(grid->order));
    PetscCall(PetscFree(grid->of_point));
    PetscCall(PetscMalloc1(grid->point_capacity, &grid->order));
    PetscCall(PetscMalloc1(grid->point_capacity, &grid->of_point));
  }
  /* counting sort, stable in the local index */
  PetscCall(PetscArrayzero(grid->start, grid->count + 1));
  for (PetscInt a = 0; a < n; a++) {
    PetscInt cell[DIM] = {0, 0, 0};

    for (PetscInt d = 0; d < dim; d++)
      cell[d] = PetscMin(grid->n[d] - 1, (PetscInt)((x[DIM * a + d] - grid->lower[d]) / grid->size));
    grid->of_point[a] = (cell[2] * grid->n[1] + cell[1]) * grid->n[0] + cell[0];
    grid->start[grid->of_point[a] + 1]++;
  }
  for (PetscInt c = 0; c < grid->count; c++) grid->start[c + 1] += grid->start[c];
  for (PetscInt a = 0; a < n; a++) grid->order[grid->start[grid->of_point[a]]++] = a;
  for (PetscInt c = grid->count; c > 0; c--) grid->start[c] = grid->start[c - 1];
  grid->start[0] = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Appends the points of a run whose squared distance is below radius2, a itself excluded; returns how many. Without a
   branch, and kept out of line so that the counter stays in a register: this loop sees every candidate. */
static __attribute__((noinline)) PetscInt KeepNear(PetscInt count, const PetscInt *restrict order,
                                                   const PetscReal *restrict r2, PetscReal radius2, PetscInt a,
                                                   PetscInt *restrict list)
{
  PetscInt found = 0;

  for (PetscInt k = 0; k < count; k++) {
    const PetscInt b = order[k];

    list[found] = b;
    found += (r2[k] < radius2) & (b != a);
  }
  return found;
}

/* The neighbours of point a among sorted points: appends their indices to list, returns their number. s is [3][n], in
 * the grid's order. */
static PetscInt FindNeighbors(const CellGrid *grid, PetscInt n, const PetscReal *restrict s, const PetscReal p[DIM],
                              PetscInt a, PetscReal radius2, PetscReal *restrict r2, PetscInt *restrict list)
{
  const PetscInt cell = grid->of_point[a], cx = cell % grid->n[0], cy = (cell / grid->n[0]) % grid->n[1],
                 cz  = cell / (grid->n[0] * grid->n[1]);
  const PetscInt  x0 = PetscMax(0, cx - 1), x1 = PetscMin(grid->n[0] - 1, cx + 1);
  const PetscReal px = p[0], py = p[1], pz = p[2];
  PetscInt        found = 0;

  for (PetscInt kz = PetscMax(0, cz - 1); kz <= PetscMin(grid->n[2] - 1, cz + 1); kz++)
    for (PetscInt ky = PetscMax(0, cy - 1); ky <= PetscMin(grid->n[1] - 1, cy + 1); ky++) {
      const PetscInt line = (kz * grid->n[1] + ky) * grid->n[0], begin = grid->start[line + x0],
                     count         = grid->start[line + x1 + 1] - begin;
      const PetscReal *restrict sx = s + begin, *restrict sy = s + n + begin, *restrict sz = s + 2 * n + begin;

      SIMD_LOOP()
      for (PetscInt k = 0; k < count; k++) {
        const PetscReal dx = px - sx[k], dy = py - sy[k], dz = pz - sz[k];

        r2[k] = dx * dx + dy * dy + dz * dz;
      }
      found += KeepNear(count, grid->order + begin, r2, radius2, a, list + found);
    }
  return found;
}

/* Number of points in the cells around point a: the room its neighbours may need. */
static PetscInt CountCandidates(const CellGrid *grid, PetscInt a, PetscInt *longest)
{
  const PetscInt cell = grid->of_point[a], cx = cell % grid->n[0], cy = (cell / grid->n[0]) % grid->n[1],
                 cz = cell / (grid->n[0] * grid->n[1]);
  const PetscInt x0 = PetscMax(0, cx - 1), x1 = PetscMin(grid->n[0] - 1, cx + 1);
  PetscInt       total = 0;

  for (PetscInt kz = PetscMax(0, cz - 1); kz <= PetscMin(grid->n[2] - 1, cz + 1); kz++)
    for (PetscInt ky = PetscMax(0, cy - 1); ky <= PetscMin(grid->n[1] - 1, cy + 1); ky++) {
      const PetscInt line  = (kz * grid->n[1] + ky) * grid->n[0],
                     count = grid->start[line + x1 + 1] - grid->start[line + x0];

      *longest = PetscMax(*longest, count);
      total += count;
    }
  return total;
}

PetscErrorCode NeighborsFind(Cloud cloud, PetscReal radius)
{
  const PetscInt   n = cloud->n_total;
  const PetscReal *x = cloud->field[FIELD_POSITION];
  PetscReal       *sorted, *r2;
  PetscInt         used = 0, longest = 0, r2_capacity = 0;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_NEIGHBORS), 0, 0, 0, 0));
  PetscCall(CellGridBuild(&cloud->grid, cloud->domain->dim, n, x, radius));
  for (PetscInt c = 0; c < cloud->grid.count; c++)
    longest = PetscMax(longest, cloud->grid.start[c + 1] - cloud->grid.start[c]);
  r2_capacity = 3 * longest;
  PetscCall(PetscMalloc2(DIM * n, &sorted, r2_capacity, &r2));
  for (PetscInt k = 0; k < n; k++)
    for (PetscInt d = 0; d < DIM; d++) sorted[d * n + k] = x[DIM * cloud->grid.order[k] + d];
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    const PetscInt candidates = CountCandidates(&cloud->grid, a, &longest);

    if (used + candidates > cloud->list_capacity) {
      cloud->list_capacity = PetscMax(used + candidates, used + used / 4 + 64 * (cloud->n_owned - a)) + 1024;
      PetscCall(PetscRealloc(cloud->list_capacity * sizeof(PetscInt), &cloud->list));
    }
    cloud->first[a] = used;
    used += FindNeighbors(&cloud->grid, n, sorted, x + DIM * a, a, radius * radius, r2, cloud->list + used);
    PetscCheck(used - cloud->first[a] <= ROW_CAPACITY, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
               "particle %" PetscInt_FMT " at (%g, %g, %g) has %" PetscInt_FMT " neighbours: particles have clumped",
               cloud->integer[INT_ID][a], (double)x[3 * a], (double)x[3 * a + 1], (double)x[3 * a + 2],
               used - cloud->first[a]);
  }
  cloud->first[cloud->n_owned] = used;
  PetscCall(PetscFree2(sorted, r2));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_NEIGHBORS), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
