/* The search's levels. Particles of different sizes are neighbours within the support of their mean smoothing length.
   Particles are sorted by size into levels, whose cells are as wide as the support of the largest particle in the
   level. For a particle the search visits a level only where this has particles, and only as far as the sizes nearby
   require. So there are about as many candidates as with particles of one size. */
#include "search.h"

/* Sorts the particles into the levels; particles of one size are all in the first. */
static PetscErrorCode FillLevels(Cloud cloud, Level level[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];

  PetscFunctionBegin;
  if (!cloud->domain->graded) {
    level[0].all.n   = cloud->n_total;
    level[0].largest = 1;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    Level *own = &level[SearchLevel(cloud, a)];

    own->all.n++;
    own->largest = PetscMax(own->largest, cloud->size[a]);
  }
  for (PetscInt l = 0; l < SEARCH_LEVELS; l++) {
    PetscCall(PetscMalloc2(level[l].all.n, &level[l].point, DIM * level[l].all.n, &level[l].x));
    level[l].all.n = 0;
  }
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    Level *own = &level[SearchLevel(cloud, a)];

    for (PetscInt d = 0; d < DIM; d++) own->x[DIM * own->all.n + d] = x[DIM * a + d];
    own->point[own->all.n++] = a;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The reach, in cells of level 'own', of pairs with particles of a coarser level. */
static PetscInt LevelReach(PetscReal support, const Level *own, const Level *coarse)
{
  return (PetscInt)PetscCeilReal(0.5 * support * (own->largest + coarse->largest) / own->grid->size);
}

/* The largest size of the particles of a level within 'reach' blocks of each block. */
static PetscErrorCode FindLargest(const CellBox *box, const Level *level, PetscInt reach, PetscReal **largest)
{
  const PetscInt width[DIM] = {reach, reach, reach};

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(box->count, largest));
  for (PetscInt k = 0; k < level->all.n; k++) {
    const PetscInt block = CellBoxFind(box, level->x + DIM * level->grid->order[k]);

    if (block >= 0) (*largest)[block] = PetscMax((*largest)[block], (PetscReal)level->all.size[k]);
  }
  PetscCall(CellsSpread(box->n, width, *largest));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the blocks over the grid of level 'own'. */
static PetscErrorCode SetBlocks(PetscInt dim, PetscReal support, Level level[], PetscInt own)
{
  const CellGrid *grid   = level[own].grid;
  Blocks         *blocks = &level[own].blocks;
  CellBox        *box    = &blocks->box;
  PetscInt        reach[SEARCH_LEVELS], layers = 1;

  PetscFunctionBegin;
  for (PetscInt l = own; l < SEARCH_LEVELS; l++) {
    reach[l] = l > own ? LevelReach(support, &level[own], &level[l]) : 1;
    layers   = PetscMax(layers, reach[l]);
  }
  box->inverse = 1 / grid->size;
  box->count   = 1;
  for (PetscInt d = 0; d < DIM; d++) {
    box->lower[d] = grid->lower[d] - (d < dim ? layers : 0) * grid->size;
    box->n[d]     = d >= dim ? 1 : (d > 0 ? grid->n[d] : (grid->n[0] - 1) / SPLIT + 1) + 2 * layers;
    box->count *= box->n[d];
  }
  for (PetscInt l = own; l < SEARCH_LEVELS; l++) {
    if (!level[l].all.n) continue;
    PetscCall(FindLargest(box, &level[l], reach[l], &blocks->coarse[l]));
    if (l > own) PetscCall(FindLargest(box, &level[own], reach[l], &blocks->fine[l]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The integer positions of n points x ([n][3], m) in the order of their grid, and zeros behind them. */
static PetscErrorCode SortPositions(const Units *units, const CellGrid *grid, PetscInt n, const PetscReal x[],
                                    int32_t sorted[])
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++) {
    const PetscReal *p = x + DIM * grid->order[k];

    for (PetscInt d = 0; d < DIM; d++) {
      const PetscReal position = IntegerPosition(units, d, p[d]);

      PetscCheck(PetscAbsReal(position) < INT32_MAX, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
                 "a particle at (%g, %g, %g) m is farther from the box than the box is long", (double)p[0],
                 (double)p[1], (double)p[2]);
      sorted[d * n + k] = (int32_t)position;
    }
  }
  PetscCall(PetscArrayzero(sorted + DIM * n, LANES)); /* read but not used */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Builds the cells of a level, and the data of its particles in the grid's order. *most: the largest number of
   candidates of a particle. */
static PetscErrorCode SortLevel(Cloud cloud, const Search *search, CellGrid *grid, Level *level, PetscInt *most)
{
  const PetscInt   n = level->all.n, reach = cloud->domain->graded ? LINES_MOST_REACH : 1;
  const PetscReal *x       = cloud->domain->graded ? level->x : cloud->field[FIELD_POSITION];
  PetscInt         longest = 0;

  PetscFunctionBegin;
  PetscCall(CellGridBuild(grid, cloud->domain->dim, n, x, search->support * level->largest, SPLIT));
  level->grid = grid;
  PetscCall(PetscMalloc1(DIM * n + LANES, &level->all.position));
  PetscCall(SortPositions(&search->units, grid, n, x, level->all.position));
  level->all.index = grid->order;
  if (cloud->domain->graded) {
    PetscCall(PetscCalloc2(n + LANES, &level->all.size, n + LANES, &level->all.index));
    for (PetscInt k = 0; k < n; k++) {
      level->all.index[k] = level->point[grid->order[k]];
      level->all.size[k]  = (float)cloud->size[level->all.index[k]];
    }
  }
  for (PetscInt r = 0; r < reach; r++) LinesSet(grid, cloud->domain->dim, r + 1, &level->lines[r]);
  for (PetscInt c = 0; c < grid->count; c++) longest = PetscMax(longest, grid->start[c + 1] - grid->start[c]);
  *most = LinesCandidates(reach, longest);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SearchCreate(Cloud cloud, Search *search)
{
  const float zero[LANES] = {0};
  Level      *level       = search->level;
  float       slope[LANES];
  PetscInt    most = 0;

  PetscFunctionBegin;
  search->units   = SearchUnits(cloud);
  search->support = KernelSupport(cloud->kernel) + cloud->margin;
  search->limit   = (float)PetscSqr(search->support / KernelSmoothingLength(cloud->kernel));
  KernelSingle(cloud->kernel, 1, zero, NULL, slope);
  /* V_a V_b F grows as size^(dim - 2) */
  search->unit = (float)PetscPowRealInt(cloud->size_most, (int)cloud->domain->dim - 2) * slope[0] / -(float)UINT16_MAX;
  PetscCall(FillLevels(cloud, level));
  for (PetscInt l = 0; l < SEARCH_LEVELS; l++) {
    PetscInt candidates = 0;

    if (level[l].all.n) PetscCall(SortLevel(cloud, search, &cloud->grid[l], &level[l], &candidates));
    most = PetscMax(most, candidates);
  }
  for (PetscInt l = 0; l < SEARCH_LEVELS && cloud->domain->graded; l++)
    if (level[l].all.n) PetscCall(SetBlocks(cloud->domain->dim, search->support, level, l));
  PetscCall(PetscMalloc1(most / LANES + 3, &search->run));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SearchDestroy(Cloud cloud, Search *search)
{
  PetscFunctionBegin;
  for (PetscInt l = 0; l < SEARCH_LEVELS; l++) {
    Level *level = &search->level[l];

    PetscCall(PetscFree(level->all.position));
    if (!cloud->domain->graded) continue;
    PetscCall(PetscFree2(level->point, level->x));
    PetscCall(PetscFree2(level->all.size, level->all.index));
    for (PetscInt k = 0; k < SEARCH_LEVELS; k++) {
      PetscCall(PetscFree(level->blocks.coarse[k]));
      PetscCall(PetscFree(level->blocks.fine[k]));
    }
  }
  PetscCall(PetscFree(search->run));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt SearchLevelRuns(Cloud cloud, const Search *search, PetscInt a, PetscInt own, PetscInt l, PetscInt block)
{
  const PetscReal *x      = cloud->field[FIELD_POSITION] + DIM * a;
  const Level     *level  = &search->level[l];
  const CellGrid  *grid   = level->grid;
  const Blocks    *blocks = &search->level[PetscMin(l, own)].blocks;
  const PetscReal  near   = block < 0 ? 0 : l < own ? blocks->fine[own][block] : blocks->coarse[l][block];
  const PetscReal  radius = (1 + POINT_TOLERANCE) * 0.5 * search->support * (cloud->size[a] + near);

  if (near <= 0) return 0;
  if (radius <= grid->size) return FindRuns(grid, &level->lines[0], PETSC_TRUE, x, radius, search->run);
  if (radius <= 2 * grid->size) return FindRuns(grid, &level->lines[1], PETSC_TRUE, x, radius, search->run);
  if (radius <= 3 * grid->size) return FindRuns(grid, &level->lines[2], PETSC_TRUE, x, radius, search->run);
  return FindRuns(grid, &level->lines[LINES_MOST_REACH - 1], PETSC_TRUE, x, radius, search->run);
}
