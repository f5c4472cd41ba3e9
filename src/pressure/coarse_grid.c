/* A grid under a cloud of points: interpolation by cell and weights, never stored as a matrix, and the rediscretised Laplacian. */
#include "coarse_grid.h"

struct _p_CoarseGrid {
  MPI_Comm   comm;
  PetscInt   dim, n, n_cells, n_nodes; /* points; touched cells; nodes of those cells: the local nodes */
  PetscInt   cells[DIM];               /* of the whole grid */
  PetscReal  lower[DIM], h[DIM];       /* m */
  PetscBool  periodic[DIM];
  PetscInt  *cell;                     /* [n] touched cell of the point, -1: skipped */
  PetscReal *t;                        /* [n][3] place in the cell, 0..1 */
  PetscInt  *corner;                   /* [n_cells][8] local nodes; bit d of the corner's number: upper end in direction d */
  PetscReal *fill;                     /* [n_cells] points of this rank */
  PetscReal *share;                    /* [n_cells] points of all ranks */
  PetscInt  *key;                      /* [n_nodes] place in the whole grid, periodic images united */
  PetscInt  *number;                   /* [n_nodes] row of the coarse matrix */
  PetscInt   n_own;
  PetscReal *value;                    /* [n_nodes] work */
  PetscSF    sf;                       /* local nodes -> owned nodes */
};

/* Range of the grid: the box in periodic directions, all points in the others. */
static PetscErrorCode GridExtent(CoarseGrid g, const PetscReal x[], const PetscBool skip[], PetscReal width, const PetscReal lower[DIM], const PetscReal upper[DIM])
{
  PetscReal range[2 * DIM]; /* lower ends, negative upper ends */
  PetscReal nodes = 1;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < 2 * DIM; d++) range[d] = PETSC_MAX_REAL;
  for (PetscInt a = 0; a < g->n; a++) {
    if (skip[a]) continue;
    for (PetscInt d = 0; d < g->dim; d++) {
      range[d]       = PetscMin(range[d], x[g->dim * a + d]);
      range[DIM + d] = PetscMin(range[DIM + d], -x[g->dim * a + d]);
    }
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, range, 2 * DIM, MPIU_REAL, MPIU_MIN, g->comm));
  for (PetscInt d = 0; d < DIM; d++) {
    PetscReal extent;

    g->cells[d] = 1;
    g->h[d]     = width;
    g->lower[d] = 0;
    if (d >= g->dim || range[d] == PETSC_MAX_REAL) continue;
    if (g->periodic[d]) {
      extent      = upper[d] - lower[d];
      g->lower[d] = lower[d];
      g->cells[d] = PetscMax(1, (PetscInt)(extent / width + 0.5));
      g->h[d]     = extent / g->cells[d];
    } else {
      extent      = -range[DIM + d] - range[d];
      g->cells[d] = PetscMax(1, (PetscInt)PetscCeilReal(extent / width));
      g->lower[d] = range[d] - 0.5 * (g->cells[d] * width - extent);
    }
    nodes *= g->cells[d] + 1;
  }
  PetscCheck(nodes < PETSC_MAX_INT, g->comm, PETSC_ERR_SUP, "The grid over all points would have %g nodes; PETSc with 64-bit indices could number them", (double)nodes);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Cell and place of each point: cell[a] becomes the cell's number in the box first..first+size of cells of this rank. */
static PetscErrorCode LocatePoints(CoarseGrid g, const PetscReal x[], const PetscBool skip[], PetscInt first[DIM], PetscInt size[DIM])
{
  PetscInt *place, last[DIM];

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(DIM * g->n, &place));
  for (PetscInt d = 0; d < DIM; d++) {
    first[d] = g->cells[d];
    last[d]  = -1;
  }
  for (PetscInt a = 0; a < g->n; a++) {
    if (skip[a]) continue;
    for (PetscInt d = 0; d < DIM; d++) {
      PetscReal u = d < g->dim ? (x[g->dim * a + d] - g->lower[d]) / g->h[d] : 0;
      PetscInt  i;

      if (g->periodic[d] && d < g->dim) u -= g->cells[d] * PetscFloorReal(u / g->cells[d]);
      i                   = PetscMin(PetscMax((PetscInt)u, 0), g->cells[d] - 1);
      g->t[DIM * a + d]   = PetscMin(PetscMax(u - i, 0.0), 1.0);
      place[DIM * a + d]  = i;
      first[d]            = PetscMin(first[d], i);
      last[d]             = PetscMax(last[d], i);
    }
  }
  for (PetscInt d = 0; d < DIM; d++) size[d] = PetscMax(0, last[d] - first[d] + 1);
  for (PetscInt a = 0; a < g->n; a++) g->cell[a] = skip[a] ? -1 : ((place[DIM * a + 2] - first[2]) * size[1] + place[DIM * a + 1] - first[1]) * size[0] + place[DIM * a] - first[0];
  PetscCall(PetscFree(place));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Numbers the touched cells and their nodes, x fastest. */
static PetscErrorCode TouchNodes(CoarseGrid g, const PetscInt first[DIM], const PetscInt size[DIM])
{
  const PetscInt count = size[0] * size[1] * size[2], nx = size[0] + 1, ny = size[1] + 1;
  PetscInt      *number, *node, *points;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(count, &number));
  PetscCall(PetscCalloc1(count, &points));
  for (PetscInt a = 0; a < g->n; a++)
    if (g->cell[a] >= 0) points[g->cell[a]]++;
  for (PetscInt c = 0; c < count; c++) number[c] = points[c] ? g->n_cells++ : -1;
  for (PetscInt a = 0; a < g->n; a++)
    if (g->cell[a] >= 0) g->cell[a] = number[g->cell[a]];
  PetscCall(PetscMalloc1(nx * ny * (size[2] + 1), &node));
  PetscCall(PetscMalloc1(GRID_CORNERS * g->n_cells, &g->corner));
  PetscCall(PetscMalloc1(GRID_CORNERS * g->n_cells, &g->key));
  PetscCall(PetscMalloc1(g->n_cells, &g->fill));
  PetscCall(PetscMalloc1(g->n_cells, &g->share));
  for (PetscInt k = 0; k < nx * ny * (size[2] + 1); k++) node[k] = -1;
  for (PetscInt c = 0; c < count; c++) {
    const PetscInt at[DIM] = {c % size[0], c / size[0] % size[1], c / size[0] / size[1]};

    if (number[c] < 0) continue;
    g->fill[number[c]] = points[c];
    for (PetscInt m = 0; m < GRID_CORNERS; m++) {
      PetscInt i[DIM], whole[DIM], k;

      for (PetscInt d = 0; d < DIM; d++) {
        i[d]     = at[d] + (d < g->dim ? m >> d & 1 : 0);
        whole[d] = first[d] + i[d];
        if (g->periodic[d] && whole[d] == g->cells[d]) { /* the image of the first node, which may be here too */
          whole[d] = 0;
          if (first[d] == 0) i[d] = 0;
        }
      }
      k = (i[2] * ny + i[1]) * nx + i[0];
      if (node[k] < 0) {
        node[k]         = g->n_nodes++;
        g->key[node[k]] = (whole[2] * (g->cells[1] + 1) + whole[1]) * (g->cells[0] + 1) + whole[0];
      }
      g->corner[GRID_CORNERS * number[c] + m] = node[k];
    }
  }
  PetscCall(PetscMalloc1(g->n_nodes, &g->value));
  PetscCall(PetscFree(number));
  PetscCall(PetscFree(points));
  PetscCall(PetscFree(node));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ranks meet at the places of the whole grid: each learns the owner and the row of its nodes and the points in its cells. */
static PetscErrorCode NumberNodes(CoarseGrid g)
{
  PetscSF     meet;
  PetscLayout whole, owned;
  PetscMPIInt rank, size;
  PetscInt   *root, *owner, start = 0, next;
  PetscReal  *sum;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(g->comm, &rank));
  PetscCallMPI(MPI_Comm_size(g->comm, &size));
  PetscCall(PetscLayoutCreateFromSizes(g->comm, PETSC_DECIDE, (g->cells[0] + 1) * (g->cells[1] + 1) * (g->cells[2] + 1), 1, &whole));
  PetscCall(PetscSFCreate(g->comm, &meet));
  PetscCall(PetscSFSetGraphLayout(meet, whole, g->n_nodes, NULL, PETSC_COPY_VALUES, g->key));
  PetscCall(PetscMalloc1(whole->n, &root));
  PetscCall(PetscCalloc1(whole->n, &sum));
  PetscCall(PetscMalloc1(g->n_nodes, &owner));
  PetscCall(PetscMalloc1(g->n_nodes, &g->number));
  for (PetscInt k = 0; k < whole->n; k++) root[k] = size;
  for (PetscInt k = 0; k < g->n_nodes; k++) owner[k] = rank;
  PetscCall(PetscSFReduceBegin(meet, MPIU_INT, owner, root, MPI_MIN));
  PetscCall(PetscSFReduceEnd(meet, MPIU_INT, owner, root, MPI_MIN));
  PetscCall(PetscSFBcastBegin(meet, MPIU_INT, root, owner, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(meet, MPIU_INT, root, owner, MPI_REPLACE));
  /* two local nodes have the same place only where a periodic direction has one cell or starts at another rank: the first of them counts */
  for (PetscInt k = 0; k < g->n_nodes; k++) g->n_own += owner[k] == rank;
  PetscCallMPI(MPI_Exscan(&g->n_own, &start, 1, MPIU_INT, MPI_SUM, g->comm));
  next = rank ? start : 0;
  for (PetscInt k = 0; k < g->n_nodes; k++) g->number[k] = owner[k] == rank ? next++ : -1;
  for (PetscInt k = 0; k < whole->n; k++) root[k] = -1;
  PetscCall(PetscSFReduceBegin(meet, MPIU_INT, g->number, root, MPI_MAX));
  PetscCall(PetscSFReduceEnd(meet, MPIU_INT, g->number, root, MPI_MAX));
  PetscCall(PetscSFBcastBegin(meet, MPIU_INT, root, g->number, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(meet, MPIU_INT, root, g->number, MPI_REPLACE));
  /* points of a cell meet at its lower node */
  PetscCall(PetscArrayzero(g->value, g->n_nodes));
  for (PetscInt c = 0; c < g->n_cells; c++) g->value[g->corner[GRID_CORNERS * c]] += g->fill[c];
  PetscCall(PetscSFReduceBegin(meet, MPIU_REAL, g->value, sum, MPIU_SUM));
  PetscCall(PetscSFReduceEnd(meet, MPIU_REAL, g->value, sum, MPIU_SUM));
  PetscCall(PetscSFBcastBegin(meet, MPIU_REAL, sum, g->value, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(meet, MPIU_REAL, sum, g->value, MPI_REPLACE));
  for (PetscInt c = 0; c < g->n_cells; c++) g->share[c] = g->value[g->corner[GRID_CORNERS * c]];
  PetscCall(PetscSFDestroy(&meet));
  PetscCall(PetscLayoutDestroy(&whole));
  PetscCall(PetscFree(root));
  PetscCall(PetscFree(sum));
  PetscCall(PetscFree(owner));
  PetscCall(PetscLayoutCreateFromSizes(g->comm, g->n_own, PETSC_DETERMINE, 1, &owned));
  PetscCall(PetscSFCreate(g->comm, &g->sf));
  PetscCall(PetscSFSetGraphLayout(g->sf, owned, g->n_nodes, NULL, PETSC_COPY_VALUES, g->number));
  PetscCall(PetscLayoutDestroy(&owned));
  PetscFunctionReturn(PETSC_SUCCESS);
}
