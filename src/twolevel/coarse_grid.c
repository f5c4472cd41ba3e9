/* A grid under a set of points, the interpolation between both, and the Laplacian on the grid. The interpolation needs
   no matrix: it uses each point's cell and position in the cell. */
#include "coarse_grid.h"

struct _p_CoarseGrid {
  MPI_Comm   comm;
  PetscInt   dim, n, n_cells, n_nodes; /* n: points; n_cells: cells that hold a point; n_nodes: local nodes of these */
  PetscInt   cells[DIM];               /* of the whole grid */
  PetscReal  lower[DIM], h[DIM];       /* m */
  PetscBool  periodic[DIM];
  PetscInt  *cell;       /* [n] cell of the point, -1: skipped */
  PetscReal *t;          /* [n][3] position in the cell, 0..1 */
  PetscInt  *corner;     /* [n_cells][8] local nodes; bit d of the corner's number: upper end in direction d */
  PetscReal *own_points; /* [n_cells] sum of the weights of this rank's points */
  PetscReal *points;     /* [n_cells] sum of the weights of all ranks' points */
  PetscInt  *key;        /* [n_nodes] number in the whole grid; periodic images have one number */
  PetscInt  *number;     /* [n_nodes] row of the coarse matrix */
  PetscInt   n_own;
  PetscReal *value; /* [n_nodes] work */
  PetscSF    sf;    /* local nodes -> owned nodes */
};

/* Sets the extent of the grid: the box in periodic directions, all points in the others. */
static PetscErrorCode GridExtent(CoarseGrid g, const PetscReal x[], const PetscBool skip[], PetscReal width,
                                 const PetscReal lower[DIM], const PetscReal upper[DIM])
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
  PetscCheckUser(nodes < PETSC_MAX_INT, g->comm,
                 "the grid of the two-level preconditioner would have %.3g nodes, more than this build of PETSc can "
                 "index: take a larger -spacing, or a PETSc configured with 64-bit indices",
                 (double)nodes);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds each point's cell and position in the cell. cell[a]: the cell's index in this rank's box of cells, which starts
   at 'first' and has 'size' cells. */
static PetscErrorCode LocatePoints(CoarseGrid g, const PetscReal x[], const PetscBool skip[], PetscInt first[DIM],
                                   PetscInt size[DIM])
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

      if (d < g->dim && g->periodic[d]) u -= g->cells[d] * PetscFloorReal(u / g->cells[d]);
      i                  = PetscMin(PetscMax((PetscInt)u, 0), g->cells[d] - 1);
      g->t[DIM * a + d]  = PetscMin(PetscMax(u - i, 0.0), 1.0);
      place[DIM * a + d] = i;
      first[d]           = PetscMin(first[d], i);
      last[d]            = PetscMax(last[d], i);
    }
  }
  for (PetscInt d = 0; d < DIM; d++) size[d] = PetscMax(0, last[d] - first[d] + 1);
  for (PetscInt a = 0; a < g->n; a++)
    g->cell[a] = skip[a] ? -1
                         : ((place[DIM * a + 2] - first[2]) * size[1] + place[DIM * a + 1] - first[1]) * size[0] +
                             place[DIM * a] - first[0];
  PetscCall(PetscFree(place));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Numbers the cells that hold a point, x fastest; cell[a] becomes this number. place[c]: index of cell c in this rank's
   box of 'count' cells. */
static PetscErrorCode NumberCells(CoarseGrid g, const PetscReal weight[], PetscInt count, PetscInt **place)
{
  PetscInt  *number;
  PetscReal *points;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(count, &number));
  PetscCall(PetscCalloc1(count, &points));
  for (PetscInt a = 0; a < g->n; a++)
    if (g->cell[a] >= 0) points[g->cell[a]] += weight ? weight[a] : 1;
  for (PetscInt k = 0; k < count; k++) number[k] = points[k] > 0 ? g->n_cells++ : -1;
  for (PetscInt a = 0; a < g->n; a++)
    if (g->cell[a] >= 0) g->cell[a] = number[g->cell[a]];
  PetscCall(PetscMalloc1(g->n_cells, place));
  PetscCall(PetscMalloc1(g->n_cells, &g->own_points));
  PetscCall(PetscMalloc1(g->n_cells, &g->points));
  for (PetscInt k = 0; k < count; k++) {
    if (number[k] < 0) continue;
    (*place)[number[k]]      = k;
    g->own_points[number[k]] = points[k];
  }
  PetscCall(PetscFree(number));
  PetscCall(PetscFree(points));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The local node at corner m of the cell 'at' of this rank's box; a new node gets the next number. node: numbers of the
   box's nodes, nx times ny in a layer; -1: no number yet. */
static PetscInt CornerNode(CoarseGrid g, const PetscInt first[DIM], const PetscInt at[DIM], PetscInt m, PetscInt nx,
                           PetscInt ny, PetscInt node[])
{
  PetscInt i[DIM], whole[DIM], k;

  for (PetscInt d = 0; d < DIM; d++) {
    i[d]     = at[d] + (d < g->dim ? m >> d & 1 : 0);
    whole[d] = first[d] + i[d];
    if (g->periodic[d] && whole[d] == g->cells[d]) { /* the image of the first node; this rank may have both */
      whole[d] = 0;
      if (first[d] == 0) i[d] = 0;
    }
  }
  k = (i[2] * ny + i[1]) * nx + i[0];
  if (node[k] < 0) {
    node[k]         = g->n_nodes++;
    g->key[node[k]] = (whole[2] * (g->cells[1] + 1) + whole[1]) * (g->cells[0] + 1) + whole[0];
  }
  return node[k];
}

/* Numbers the cells that hold a point, and their nodes. */
static PetscErrorCode FindNodes(CoarseGrid g, const PetscReal weight[], const PetscInt first[DIM],
                                const PetscInt size[DIM])
{
  const PetscInt nx = size[0] + 1, ny = size[1] + 1, nodes = nx * ny * (size[2] + 1);
  PetscInt      *place, *node;

  PetscFunctionBegin;
  PetscCall(NumberCells(g, weight, size[0] * size[1] * size[2], &place));
  PetscCall(PetscMalloc1(GRID_CORNERS * g->n_cells, &g->corner));
  PetscCall(PetscMalloc1(GRID_CORNERS * g->n_cells, &g->key));
  PetscCall(PetscMalloc1(nodes, &node));
  for (PetscInt k = 0; k < nodes; k++) node[k] = -1;
  for (PetscInt c = 0; c < g->n_cells; c++) {
    const PetscInt k = place[c], at[DIM] = {k % size[0], k / size[0] % size[1], k / size[0] / size[1]};

    for (PetscInt m = 0; m < GRID_CORNERS; m++)
      g->corner[GRID_CORNERS * c + m] = CornerNode(g, first, at, m, nx, ny, node);
  }
  PetscCall(PetscMalloc1(g->n_nodes, &g->value));
  PetscCall(PetscFree(place));
  PetscCall(PetscFree(node));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Combines the values of each node over the ranks that have the node, and gives all of them the result. root: start
   values. */
static PetscErrorCode Combine(PetscSF meet, MPI_Datatype type, MPI_Op op, void *value, void *root)
{
  PetscFunctionBegin;
  PetscCall(PetscSFReduceBegin(meet, type, value, root, op));
  PetscCall(PetscSFReduceEnd(meet, type, value, root, op));
  PetscCall(PetscSFBcastBegin(meet, type, root, value, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(meet, type, root, value, MPI_REPLACE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Numbers the rows of the nodes. A node belongs to the lowest rank that has it; the rows of a rank are consecutive. */
static PetscErrorCode NumberNodes(CoarseGrid g, PetscSF meet, PetscInt n_roots)
{
  PetscMPIInt rank, size;
  PetscInt   *root, *owner, next = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(g->comm, &rank));
  PetscCallMPI(MPI_Comm_size(g->comm, &size));
  PetscCall(PetscMalloc1(n_roots, &root));
  PetscCall(PetscMalloc1(g->n_nodes, &owner));
  PetscCall(PetscMalloc1(g->n_nodes, &g->number));
  for (PetscInt k = 0; k < n_roots; k++) root[k] = size;
  for (PetscInt k = 0; k < g->n_nodes; k++) owner[k] = rank;
  PetscCall(Combine(meet, MPIU_INT, MPI_MIN, owner, root));
  for (PetscInt k = 0; k < g->n_nodes; k++) g->n_own += owner[k] == rank;
  PetscCallMPI(MPI_Exscan(&g->n_own, &next, 1, MPIU_INT, MPI_SUM, g->comm));
  if (rank == 0) next = 0;
  for (PetscInt k = 0; k < g->n_nodes; k++) g->number[k] = owner[k] == rank ? next++ : -1;
  for (PetscInt k = 0; k < n_roots; k++) root[k] = -1;
  PetscCall(Combine(meet, MPIU_INT, MPI_MAX, g->number, root));
  PetscCall(PetscFree(root));
  PetscCall(PetscFree(owner));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sums the points of each cell over all ranks, at the cell's lower node. */
static PetscErrorCode SumPoints(CoarseGrid g, PetscSF meet, PetscInt n_roots)
{
  PetscReal *sum;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(n_roots, &sum));
  PetscCall(PetscArrayzero(g->value, g->n_nodes));
  for (PetscInt c = 0; c < g->n_cells; c++) g->value[g->corner[GRID_CORNERS * c]] += g->own_points[c];
  PetscCall(Combine(meet, MPIU_REAL, MPIU_SUM, g->value, sum));
  for (PetscInt c = 0; c < g->n_cells; c++) g->points[c] = g->value[g->corner[GRID_CORNERS * c]];
  PetscCall(PetscFree(sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the nodes that ranks share: all ranks exchange the owners of their nodes through the nodes of the whole grid,
   which are distributed over the ranks. */
static PetscErrorCode Connect(CoarseGrid g)
{
  PetscSF     meet;
  PetscLayout whole, owned;

  PetscFunctionBegin;
  PetscCall(PetscLayoutCreateFromSizes(g->comm, PETSC_DECIDE, (g->cells[0] + 1) * (g->cells[1] + 1) * (g->cells[2] + 1),
                                       1, &whole));
  PetscCall(PetscSFCreate(g->comm, &meet));
  PetscCall(PetscSFSetGraphLayout(meet, whole, g->n_nodes, NULL, PETSC_COPY_VALUES, g->key));
  PetscCall(NumberNodes(g, meet, whole->n));
  PetscCall(SumPoints(g, meet, whole->n));
  PetscCall(PetscSFDestroy(&meet));
  PetscCall(PetscLayoutDestroy(&whole));
  PetscCall(PetscLayoutCreateFromSizes(g->comm, g->n_own, PETSC_DETERMINE, 1, &owned));
  PetscCall(PetscSFCreate(g->comm, &g->sf));
  PetscCall(PetscSFSetGraphLayout(g->sf, owned, g->n_nodes, NULL, PETSC_COPY_VALUES, g->number));
  PetscCall(PetscLayoutDestroy(&owned));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CoarseGridCreate(MPI_Comm comm, PetscInt dim, PetscInt n, const PetscReal x[], const PetscReal weight[],
                                const PetscBool skip[], PetscReal width, const PetscReal lower[DIM],
                                const PetscReal upper[DIM], const PetscBool periodic[DIM], CoarseGrid *grid)
{
  CoarseGrid g;
  PetscInt   first[DIM], size[DIM];

  PetscFunctionBegin;
  PetscCall(PetscNew(&g));
  g->comm = comm;
  g->dim  = dim;
  g->n    = n;
  for (PetscInt d = 0; d < DIM; d++) g->periodic[d] = (PetscBool)(d < dim && periodic[d]);
  PetscCall(PetscMalloc1(n, &g->cell));
  PetscCall(PetscCalloc1(DIM * n, &g->t));
  PetscCall(GridExtent(g, x, skip, width, lower, upper));
  PetscCall(LocatePoints(g, x, skip, first, size));
  PetscCall(FindNodes(g, weight, first, size));
  PetscCall(Connect(g));
  *grid = g;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CoarseGridDestroy(CoarseGrid *grid)
{
  CoarseGrid g = *grid;

  PetscFunctionBegin;
  if (!g) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree(g->cell));
  PetscCall(PetscFree(g->t));
  PetscCall(PetscFree(g->corner));
  PetscCall(PetscFree(g->own_points));
  PetscCall(PetscFree(g->points));
  PetscCall(PetscFree(g->key));
  PetscCall(PetscFree(g->number));
  PetscCall(PetscFree(g->value));
  PetscCall(PetscSFDestroy(&g->sf));
  PetscCall(PetscFree(*grid));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CoarseGridSizes(CoarseGrid g, PetscInt *local, PetscInt *global)
{
  PetscFunctionBegin;
  if (local) *local = g->n_own;
  if (global) PetscCallMPI(MPI_Allreduce(&g->n_own, global, 1, MPIU_INT, MPI_SUM, g->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Weights w of the eight corners at the position t. */
static inline void CornerWeights(const PetscReal *restrict t, PetscReal *restrict w)
{
  const PetscReal x = t[0], y = t[1], z = t[2], xy = x * y, a = 1 - x - y + xy, b = x - xy, c = y - xy;

  w[4] = a * z;
  w[5] = b * z;
  w[6] = c * z;
  w[7] = xy * z;
  w[0] = a - w[4];
  w[1] = b - w[5];
  w[2] = c - w[6];
  w[3] = xy - w[7];
}

PetscErrorCode CoarseGridRestrict(CoarseGrid g, Vec fine, Vec coarse)
{
  const PetscInt     corners = 1 << g->dim;
  const PetscScalar *f;
  PetscScalar       *c;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(g->value, g->n_nodes));
  PetscCall(VecGetArrayRead(fine, &f));
  for (PetscInt a = 0; a < g->n; a++) {
    const PetscInt *corner;
    PetscReal       w[GRID_CORNERS];

    if (g->cell[a] < 0) continue;
    corner = g->corner + GRID_CORNERS * g->cell[a];
    CornerWeights(g->t + DIM * a, w);
    for (PetscInt m = 0; m < corners; m++) g->value[corner[m]] += w[m] * PetscRealPart(f[a]);
  }
  PetscCall(VecRestoreArrayRead(fine, &f));
  PetscCall(VecSet(coarse, 0));
  PetscCall(VecGetArray(coarse, &c));
  PetscCall(PetscSFReduceBegin(g->sf, MPIU_REAL, g->value, c, MPIU_SUM));
  PetscCall(PetscSFReduceEnd(g->sf, MPIU_REAL, g->value, c, MPIU_SUM));
  PetscCall(VecRestoreArray(coarse, &c));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CoarseGridProlongAdd(CoarseGrid g, Vec coarse, Vec fine)
{
  const PetscInt     corners = 1 << g->dim;
  const PetscScalar *c;
  PetscScalar       *f;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(coarse, &c));
  PetscCall(PetscSFBcastBegin(g->sf, MPIU_REAL, c, g->value, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(g->sf, MPIU_REAL, c, g->value, MPI_REPLACE));
  PetscCall(VecRestoreArrayRead(coarse, &c));
  PetscCall(VecGetArray(fine, &f));
  for (PetscInt a = 0; a < g->n; a++) {
    const PetscInt *corner;
    PetscReal       w[GRID_CORNERS], sum = 0;

    if (g->cell[a] < 0) continue;
    corner = g->corner + GRID_CORNERS * g->cell[a];
    CornerWeights(g->t + DIM * a, w);
    for (PetscInt m = 0; m < corners; m++) sum += w[m] * g->value[corner[m]];
    f[a] += sum;
  }
  PetscCall(VecRestoreArray(fine, &f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Index of corner j in the stencil of 'node', which is corner i of the same cell. */
static inline PetscInt64 StencilPlace(PetscInt node, PetscInt i, PetscInt j)
{
  return (PetscInt64)GRID_STENCIL * node + ((j >> 2 & 1) - (i >> 2 & 1) + 1) * 9 +
         ((j >> 1 & 1) - (i >> 1 & 1) + 1) * 3 + (j & 1) - (i & 1) + 1;
}

/* Adds cell c with its points to the stencils; points: the sum of their factors. Each of the 2^(dim-1) edges in a
 * direction carries an equal part. */
static void AddCell(CoarseGrid g, PetscInt c, PetscReal points, PetscReal energy, PetscReal stencil[], PetscInt node[])
{
  const PetscInt *corner = g->corner + GRID_CORNERS * c;

  for (PetscInt i = 0; i < GRID_CORNERS; i++)
    for (PetscInt j = 0; j < GRID_CORNERS; j++) node[StencilPlace(corner[i], i, j)] = corner[j];
  for (PetscInt i = 0; i < 1 << g->dim; i++)
    for (PetscInt d = 0; d < g->dim; d++) {
      const PetscReal k = energy * points / (g->h[d] * g->h[d] * (1 << (g->dim - 1)));

      stencil[StencilPlace(corner[i], i, i)] += k;
      stencil[StencilPlace(corner[i], i, i ^ 1 << d)] -= k;
    }
}

/* Computes the stencils ([n_nodes][27]), and the node of each entry (same shape). */
static PetscErrorCode FillStencils(CoarseGrid g, PetscReal energy, PetscReal volume, const PetscReal factor[],
                                   const PetscReal surplus[], PetscReal stencil[], PetscInt node[])
{
  PetscReal  capacity = 1 / volume; /* points in a full cell */
  PetscReal *sum;                   /* of the factors of a cell's points */

  PetscFunctionBegin;
  for (PetscInt d = 0; d < g->dim; d++) capacity *= g->h[d];
  PetscCall(PetscCalloc1(g->n_cells, &sum));
  for (PetscInt a = 0; a < g->n; a++)
    if (g->cell[a] >= 0) sum[g->cell[a]] += factor ? factor[a] : 1;
  for (PetscInt c = 0; c < g->n_cells; c++)
    AddCell(g, c, sum[c] * PetscMin(1, capacity / g->points[c]), energy, stencil, node);
  PetscCall(PetscFree(sum));
  for (PetscInt a = 0; a < g->n; a++) {
    const PetscInt *corner;
    PetscReal       w[GRID_CORNERS];

    if (g->cell[a] < 0 || surplus[a] <= 0) continue;
    corner = g->corner + GRID_CORNERS * g->cell[a];
    CornerWeights(g->t + DIM * a, w);
    for (PetscInt i = 0; i < 1 << g->dim; i++)
      for (PetscInt j = 0; j < 1 << g->dim; j++) stencil[StencilPlace(corner[i], i, j)] += surplus[a] * w[i] * w[j];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An empty matrix with room for the entries of the stencils: of a row that ranks share, those of all of them. */
static PetscErrorCode CreateMatrix(CoarseGrid g, const PetscReal stencil[], Mat *A)
{
  PetscInt *entries, *room;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(g->n_nodes, &entries, g->n_own, &room));
  for (PetscInt k = 0; k < g->n_nodes; k++)
    for (PetscInt s = 0; s < GRID_STENCIL; s++) entries[k] += stencil[(PetscInt64)GRID_STENCIL * k + s] != 0;
  PetscCall(PetscSFReduceBegin(g->sf, MPIU_INT, entries, room, MPI_SUM));
  PetscCall(PetscSFReduceEnd(g->sf, MPIU_INT, entries, room, MPI_SUM));
  for (PetscInt r = 0; r < g->n_own; r++) room[r] = PetscMin(room[r], g->n_own);
  PetscCall(MatCreateAIJ(g->comm, g->n_own, g->n_own, PETSC_DETERMINE, PETSC_DETERMINE, 0, room, 0, room, A));
  PetscCall(PetscFree2(entries, room));
  PetscCall(MatSetOption(*A, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE)); /* tiny grids may need more */
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CoarseGridMatrix(CoarseGrid g, PetscReal point_energy, PetscReal point_volume, const PetscReal factor[],
                                const PetscReal surplus[], Mat *A)
{
  PetscReal *stencil;
  PetscInt  *node, columns[GRID_STENCIL];

  PetscFunctionBegin;
  PetscCall(PetscCalloc1((size_t)GRID_STENCIL * (size_t)g->n_nodes, &stencil));
  PetscCall(PetscMalloc1((size_t)GRID_STENCIL * (size_t)g->n_nodes, &node));
  PetscCall(FillStencils(g, point_energy, point_volume, factor, surplus, stencil, node));
  PetscCall(CreateMatrix(g, stencil, A));
  for (PetscInt k = 0; k < g->n_nodes; k++) {
    const PetscInt64 first = (PetscInt64)GRID_STENCIL * k;
    PetscScalar      values[GRID_STENCIL];
    PetscInt         n = 0;

    for (PetscInt s = 0; s < GRID_STENCIL; s++) {
      if (stencil[first + s] == 0) continue;
      columns[n]  = g->number[node[first + s]];
      values[n++] = stencil[first + s];
    }
    PetscCall(MatSetValues(*A, 1, &g->number[k], n, columns, values, ADD_VALUES));
  }
  PetscCall(PetscFree(stencil));
  PetscCall(PetscFree(node));
  PetscCall(MatAssemblyBegin(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatSetOption(*A, MAT_SYMMETRIC, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}
