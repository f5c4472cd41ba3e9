/* The neighbour search of particles of different sizes. A pair belongs together if it is within the support of its mean
   smoothing length. Particles are sorted by size into levels, each with cells of its own as wide as the support of its
   largest particle. A particle looks at a level only where it has particles, and as far as those near it are large, so
   that a search looks at about as many candidates as one of particles of one size. */
#include "search.h"

#define LEVELS ((SIZE_LEVELS + 1) / 2) /* of sizes, by factors of 2: the first, then two of the cloud's each */

/* Cells of a grid, SPLIT along x in one, and some more layers of them all around: the largest sizes of the particles
   that may be in pairs with one in the cell; 0: there are none. */
typedef struct {
  CellBox box;
  /* [box.count] for a particle of the grid's level, those of this level and coarser ones; for a particle of a coarser
     level, those of the grid's level */
  PetscReal *coarse[LEVELS], *fine[LEVELS];
} Blocks;

/* The particles of a level, ghosts too. */
typedef struct {
  PetscInt   n;
  PetscReal  largest; /* size, 1 */
  PetscInt  *point;   /* [n] local indices */
  PetscReal *x;       /* [n][3] m */
  CellGrid   grid;    /* of x */
  Lines      lines[LINES_MOST_REACH];
  Blocks     blocks;
  int32_t   *place; /* [3][n] integer positions, in the grid's order from here on */
  float     *size;  /* [n] */
  PetscInt  *index; /* [n] local indices */
} Level;

typedef struct {
  Units     units;
  PetscReal support;     /* of the kernel, m */
  float     limit, unit; /* support2/h2; of the Laplacian factors */
  Level     level[LEVELS];
  Run      *run;                                             /* of one row */
  float s[ROW_CAPACITY + LANES], size[ROW_CAPACITY + LANES]; /* of one row: r2/h2, then over h_ab2; of the neighbours */
} GradedSearch;

static inline PetscInt LevelOf(Cloud cloud, PetscInt a)
{
  return (CloudLevel(cloud, a) + 1) / 2;
}

/* Sorts the particles into the levels. */
static PetscErrorCode FillLevels(Cloud cloud, Level level[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    Level *own = &level[LevelOf(cloud, a)];

    own->n++;
    own->largest = PetscMax(own->largest, cloud->size[a]);
  }
  for (PetscInt l = 0; l < LEVELS; l++) {
    PetscCall(PetscMalloc2(level[l].n, &level[l].point, DIM * level[l].n, &level[l].x));
    level[l].n = 0;
  }
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    Level *own = &level[LevelOf(cloud, a)];

    for (PetscInt d = 0; d < DIM; d++) own->x[DIM * own->n + d] = x[DIM * a + d];
    own->point[own->n++] = a;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How many cells of level 'own' the pairs with particles of a coarser level reach. */
static PetscInt LevelReach(PetscReal support, const Level *own, const Level *coarse)
{
  return (PetscInt)PetscCeilReal(0.5 * support * (own->largest + coarse->largest) / own->grid.size);
}

/* The largest sizes of the particles of a level, seen from up to 'reach' blocks away. */
static PetscErrorCode FindLargest(const CellBox *box, const Level *level, PetscInt reach, PetscReal **largest)
{
  const PetscInt width[DIM] = {reach, reach, reach};

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(box->count, largest));
  for (PetscInt k = 0; k < level->n; k++) {
    const PetscInt block = CellBoxFind(box, level->x + DIM * level->grid.order[k]);

    if (block >= 0) (*largest)[block] = PetscMax((*largest)[block], (PetscReal)level->size[k]);
  }
  PetscCall(CellsSpread(box->n, width, *largest));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The blocks over the grid of level 'own'. */
static PetscErrorCode SetBlocks(PetscInt dim, PetscReal support, Level level[], PetscInt own)
{
  const CellGrid *grid   = &level[own].grid;
  Blocks         *blocks = &level[own].blocks;
  CellBox        *box    = &blocks->box;
  PetscInt        reach[LEVELS], layers = 1;

  PetscFunctionBegin;
  for (PetscInt l = own; l < LEVELS; l++) {
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
  for (PetscInt l = own; l < LEVELS; l++) {
    if (!level[l].n) continue;
    PetscCall(FindLargest(box, &level[l], reach[l], &blocks->coarse[l]));
    if (l > own) PetscCall(FindLargest(box, &level[own], reach[l], &blocks->fine[l]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The cells of a level, and what a row reads of its particles, in the grid's order. Returns the candidates that a
   particle can have at most. */
static PetscErrorCode SortLevel(Cloud cloud, const Units *units, PetscReal support, Level *level, PetscInt *most)
{
  const PetscInt n       = level->n;
  PetscInt       longest = 0;

  PetscFunctionBegin;
  PetscCall(CellGridBuild(&level->grid, cloud->domain->dim, n, level->x, support * level->largest, SPLIT));
  PetscCall(PetscMalloc3(DIM * n + LANES, &level->place, n + LANES, &level->size, n + LANES, &level->index));
  PetscCall(PlacesSort(units, &level->grid, n, level->x, level->place));
  for (PetscInt k = 0; k < n; k++) {
    level->index[k] = level->point[level->grid.order[k]];
    level->size[k]  = (float)cloud->size[level->index[k]];
  }
  PetscCall(PetscArrayzero(level->index + n, LANES)); /* read, and not used */
  PetscCall(PetscArrayzero(level->size + n, LANES));
  for (PetscInt r = 0; r < LINES_MOST_REACH; r++) LinesSet(&level->grid, r + 1, &level->lines[r]);
  for (PetscInt c = 0; c < level->grid.count; c++)
    longest = PetscMax(longest, level->grid.start[c + 1] - level->grid.start[c]);
  *most = LinesCandidates(LINES_MOST_REACH, longest);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SearchCreate(Cloud cloud, GradedSearch *search)
{
  const float zero[LANES] = {0};
  float       slope[LANES];
  PetscInt    most = 0;

  PetscFunctionBegin;
  search->units   = SearchUnits(cloud);
  search->support = KernelSupport(cloud->kernel);
  search->limit   = (float)PetscSqr(search->support / KernelSmoothingLength(cloud->kernel));
  KernelSingle(cloud->kernel, 1, zero, NULL, slope);
  /* V_a V_b F grows with the size to the power of the dimension less two */
  search->unit = (float)PetscPowRealInt(cloud->size_most, (int)cloud->domain->dim - 2) * slope[0] / -(float)UINT16_MAX;
  PetscCall(FillLevels(cloud, search->level));
  for (PetscInt l = 0; l < LEVELS; l++) {
    PetscInt candidates = 0;

    if (!search->level[l].n) continue;
    PetscCall(SortLevel(cloud, &search->units, search->support, &search->level[l], &candidates));
    most = PetscMax(most, candidates);
  }
  for (PetscInt l = 0; l < LEVELS; l++)
    if (search->level[l].n) PetscCall(SetBlocks(cloud->domain->dim, search->support, search->level, l));
  PetscCall(PetscMalloc1(most / LANES + 3, &search->run));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SearchDestroy(GradedSearch *search)
{
  PetscFunctionBegin;
  for (PetscInt l = 0; l < LEVELS; l++) {
    Level *level = &search->level[l];

    PetscCall(PetscFree2(level->point, level->x));
    if (!level->n) continue;
    PetscCall(CellGridReset(&level->grid));
    PetscCall(PetscFree3(level->place, level->size, level->index));
    for (PetscInt k = 0; k < LEVELS; k++) {
      PetscCall(PetscFree(level->blocks.coarse[k]));
      PetscCall(PetscFree(level->blocks.fine[k]));
    }
  }
  PetscCall(PetscFree(search->run));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Stores in list, s and near those candidates of a run that are near particle a at the integer position p: pairs with s
   = r2/h2 below the limit times the square of the mean size, without the particle itself; near is their size. Returns
   how many there are. LANES candidates are read, and as many may be written. */
#if defined(__AVX512F__) && !defined(PETSC_USE_64BIT_INDICES)
  #include <immintrin.h>

static inline __m512 Square(int32_t p, const int32_t *x, float unit)
{
  const __m512 d = _mm512_mul_ps(_mm512_set1_ps(unit),
                                 _mm512_cvtepi32_ps(_mm512_sub_epi32(_mm512_set1_epi32(p), _mm512_loadu_si512(x))));

  return _mm512_mul_ps(d, d);
}

static inline PetscInt KeepNear(Run run, PetscInt n, const int32_t *place, const float *size, const PetscInt *index,
                                const float unit[DIM], float own, float limit, PetscInt a, const int32_t p[DIM],
                                PetscInt *restrict list, float *restrict s, float *restrict near)
{
  const PetscInt  begin = RUN_BEGIN(run);
  const int32_t  *x     = place + begin;
  const __m512    other = _mm512_loadu_ps(size + begin), both = _mm512_add_ps(_mm512_set1_ps(own), other);
  const __m512    s2    = _mm512_add_ps(_mm512_add_ps(Square(p[0], x, unit[0]), Square(p[1], x + n, unit[1])),
                                        Square(p[2], x + 2 * n, unit[2]));
  const __m512i   b     = _mm512_loadu_si512(index + begin);
  const __mmask16 real  = (__mmask16)((1u << RUN_COUNT(run)) - 1);
  const __mmask16 alien = _mm512_mask_cmpneq_epi32_mask(real, b, _mm512_set1_epi32(a));
  const __mmask16 keep =
    _mm512_mask_cmp_ps_mask(alien, s2, _mm512_mul_ps(_mm512_mul_ps(both, both), _mm512_set1_ps(0.25f * limit)),
                            _CMP_LT_OQ);

  _mm512_storeu_si512(list, _mm512_maskz_compress_epi32(keep, b));
  _mm512_storeu_ps(s, _mm512_maskz_compress_ps(keep, s2));
  _mm512_storeu_ps(near, _mm512_maskz_compress_ps(keep, other));
  return __builtin_popcount(keep);
}
#elif defined(SEARCH_EIGHT)
static inline PetscInt KeepEight(PetscInt begin, PetscInt count, PetscInt n, const int32_t *place, const float *size,
                                 const PetscInt *index, const float unit[DIM], float own, float limit, PetscInt a,
                                 const int32_t p[DIM], PetscInt *restrict list, float *restrict s, float *restrict near)
{
  const int32_t *x     = place + begin;
  const __m256   s2    = EightSquares(p, unit, x, x + n, x + 2 * n);
  const __m256   other = _mm256_loadu_ps(size + begin), both = _mm256_add_ps(_mm256_set1_ps(own), other);
  const __m256   most  = _mm256_mul_ps(_mm256_mul_ps(both, both), _mm256_set1_ps(0.25f * limit));
  const __m256i  b     = _mm256_loadu_si256((const __m256i *)(index + begin));
  const unsigned bits  = EightNear(s2, most, b, a, count);
  const __m256i  front = EightFront(bits);

  _mm256_storeu_si256((__m256i *)list, _mm256_permutevar8x32_epi32(b, front));
  _mm256_storeu_ps(s, _mm256_permutevar8x32_ps(s2, front));
  _mm256_storeu_ps(near, _mm256_permutevar8x32_ps(other, front));
  return __builtin_popcount(bits);
}

static inline PetscInt KeepNear(Run run, PetscInt n, const int32_t *place, const float *size, const PetscInt *index,
                                const float unit[DIM], float own, float limit, PetscInt a, const int32_t p[DIM],
                                PetscInt *restrict list, float *restrict s, float *restrict near)
{
  const PetscInt begin = RUN_BEGIN(run), count = RUN_COUNT(run);
  const PetscInt found = KeepEight(begin, count, n, place, size, index, unit, own, limit, a, p, list, s, near);

  if (count <= EIGHT) return found;
  return found + KeepEight(begin + EIGHT, count - EIGHT, n, place, size, index, unit, own, limit, a, p, list + found,
                           s + found, near + found);
}
#else
static inline PetscInt KeepNear(Run run, PetscInt n, const int32_t *place, const float *size, const PetscInt *index,
                                const float unit[DIM], float own, float limit, PetscInt a, const int32_t p[DIM],
                                PetscInt *restrict list, float *restrict s, float *restrict near)
{
  const PetscInt begin = RUN_BEGIN(run);
  const int32_t *x = place + begin, *y = x + n, *z = y + n;
  float          s2[LANES], both[LANES];
  PetscInt       found = 0;

  SIMD_LOOP()
  for (PetscInt k = 0; k < LANES; k++) {
    const float dx = unit[0] * (float)Apart(p[0], x[k]), dy = unit[1] * (float)Apart(p[1], y[k]),
                dz = unit[2] * (float)Apart(p[2], z[k]);

    both[k] = own + size[begin + k];
    s2[k]   = SumSquares(dx, dy, dz);
  }
  for (PetscInt k = 0; k < RUN_COUNT(run); k++) { /* branchless: the next one overwrites what is not kept */
    const PetscInt b = index[begin + k];

    list[found] = b;
    s[found]    = s2[k];
    near[found] = size[begin + k];
    found += (s2[k] < both[k] * both[k] * (0.25f * limit)) & (b != a);
  }
  return found;
}
#endif

/* Appends to the 'found' neighbours of particle a those of a level among the candidates of the runs; see KeepNear. */
static inline PetscInt KeepRuns(const Level *level, const Run *restrict run, PetscInt runs, const float unit[DIM],
                                float own, float limit, PetscInt a, const int32_t p[DIM], PetscInt *restrict list,
                                float *restrict s, float *restrict near, PetscInt found)
{
  const PetscInt n = level->n, *index = level->index;
  const int32_t *place = level->place;
  const float   *size  = level->size;

  for (PetscInt r = 0; r < runs && found <= ROW_CAPACITY - LANES; r++)
    found += KeepNear(run[r], n, place, size, index, unit, own, limit, a, p, list + found, s + found, near + found);
  return found;
}

/* The candidates of level l for particle a, of level 'own': those near enough for a pair with the largest of them. The
   block is that of the finer one of both levels. */
static inline PetscInt FindLevelRuns(Cloud cloud, const GradedSearch *search, PetscInt a, PetscInt own, PetscInt l,
                                     PetscInt block)
{
  const PetscReal *x      = cloud->field[FIELD_POSITION] + DIM * a;
  const Level     *level  = &search->level[l];
  const CellGrid  *grid   = &level->grid;
  const Blocks    *blocks = &search->level[PetscMin(l, own)].blocks;
  const PetscReal  near   = block < 0 ? 0 : l < own ? blocks->fine[own][block] : blocks->coarse[l][block];
  const PetscReal  radius = (1 + POINT_TOLERANCE) * 0.5 * search->support * (cloud->size[a] + near);

  if (near <= 0) return 0;
  if (radius <= grid->size) return FindRuns(grid, &level->lines[0], 1, PETSC_TRUE, x, radius, search->run);
  if (radius <= 2 * grid->size) return FindRuns(grid, &level->lines[1], 2, PETSC_TRUE, x, radius, search->run);
  return FindRuns(grid, &level->lines[2], LINES_MOST_REACH, PETSC_TRUE, x, radius, search->run);
}

/* Finds the neighbours of particle a; more than ROW_CAPACITY - LANES: there is no room for more. Writes to list,
   search->s and search->size. */
static PetscInt FindNeighbors(Cloud cloud, GradedSearch *search, PetscInt a, PetscInt list[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, size = cloud->size[a];
  const PetscInt   own       = LevelOf(cloud, a);
  const Units     *units     = &search->units;
  const int32_t    p[DIM]    = {(int32_t)Place(units, 0, x[0]), (int32_t)Place(units, 1, x[1]),
                                (int32_t)Place(units, 2, x[2])};
  const float      unit[DIM] = {units->unit[0], units->unit[1], units->unit[2]}, limit = search->limit;
  PetscInt         found = 0, block = -1; /* of the finer one of both levels */

  for (PetscInt l = 0; l < LEVELS; l++) {
    const Level *level = &search->level[l];
    PetscInt     runs;

    if (!level->n) continue;
    if (l <= own) block = CellBoxFind(&level->blocks.box, x);
    runs = FindLevelRuns(cloud, search, a, own, l, block);

    found = KeepRuns(level, search->run, runs, unit, (float)size, limit, a, p, list, search->s, search->size, found);
  }
  return found;
}

/* The factors of n padded pairs of particle a, with the weights of the neighbours, size^dim: see Cloud and RowVisitor.
   With q = h over h_ab, the pair's W is q^dim times that of h at r q, F q^(dim + 2) times. w: NULL if not wanted.
   Returns the sum of the Laplacian factors. */
static inline PetscInt GradedFactors(Cloud cloud, GradedSearch *search, PetscInt a, PetscInt n, PetscBool flat,
                                     float *restrict w, float *restrict slope_over_r2, float *restrict slope,
                                     uint16_t *restrict laplacian)
{
  const float eta2 = ETA_OVER_H * ETA_OVER_H, inverse = 1 / search->unit, own = (float)cloud->size[a],
              own_weight = flat ? own * own : own * own * own;
  const PetscInt padded  = (n + LANES - 1) / LANES * LANES;
  float *restrict s = search->s, *restrict size = search->size;
  float    ratio[ROW_CAPACITY + LANES];
  PetscInt sum = 0;

  for (PetscInt begin = 0; begin < padded; begin += LANES) {
    SIMD_LOOP()
    for (PetscInt k = begin; k < begin + LANES; k++) {
      ratio[k] = 2 / (own + size[k]);
      s[k] *= ratio[k] * ratio[k];
    }
  }
  KernelSingle(cloud->kernel, n, s, w, slope);
  for (PetscInt begin = 0; begin < padded; begin += LANES) {
    SIMD_LOOP(reduction(+ : sum))
    for (PetscInt k = begin; k < begin + LANES; k++) {
      const float q = ratio[k], q2 = q * q, q_dim = flat ? q2 : q2 * q;
      const float weight = flat ? size[k] * size[k] : size[k] * size[k] * size[k], steep = slope[k] * q_dim * q2,
                  over   = steep / (s[k] + eta2);
      const int32_t code = (int32_t)(0.5f - inverse * over * s[k] * (own_weight * weight));

      if (w) w[k] *= q_dim * weight;
      slope[k]         = steep * weight;
      slope_over_r2[k] = over * q2 * weight;
      laplacian[k]     = (uint16_t)code;
      sum += code;
    }
  }
  return sum;
}

PetscErrorCode SearchGraded(Cloud cloud, RowVisitor visit, void *context)
{
  const PetscBool flat = (PetscBool)(cloud->domain->dim == 2);
  const PetscInt  most = ROW_CAPACITY + LANES;
  PetscInt64      used = 0; /* pairs */
  float           w[ROW_CAPACITY + LANES], slope_over_r2[ROW_CAPACITY + LANES];
  GradedSearch   *search;

  PetscFunctionBegin;
  PetscCall(PetscNew(&search));
  FindWeights(cloud);
  PetscCall(SearchCreate(cloud, search));
  cloud->laplacian_unit = search->unit;
  cloud->first[0]       = 0;
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    PetscInt found;

    if (used + most > cloud->list_capacity)
      PetscCall(ReserveList(cloud, CloudListRoom(used, cloud->n_owned - a, most)));
    found = FindNeighbors(cloud, search, a, cloud->list + used);
    PetscCall(RowCheck(cloud, a, found > ROW_CAPACITY - LANES ? ROW_CAPACITY + 1 : found));
    PadRow(a, found, cloud->list + used, search->s);
    for (PetscInt k = found; k < found + LANES; k++) search->size[k] = 1;
    cloud->laplacian_sum[a] = flat ? GradedFactors(cloud, search, a, found, PETSC_TRUE, visit ? w : NULL, slope_over_r2,
                                                   cloud->slope + used, cloud->laplacian + used)
                                   : GradedFactors(cloud, search, a, found, PETSC_FALSE, visit ? w : NULL,
                                                   slope_over_r2, cloud->slope + used, cloud->laplacian + used);
    if (cloud->domain->rings)
      WeightRow(cloud, found, cloud->list + used, visit ? w : NULL, slope_over_r2, cloud->slope + used);
    used = RowEnd(cloud, a, used, found, w, slope_over_r2, visit, context);
  }
  PetscCall(SearchDestroy(search));
  PetscCall(PetscFree(search));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* r2 of a graded particle's row over the square of the pair's size. */
static void ScaleRow(Cloud cloud, PetscInt a, const PairRow *row, PetscReal r2[])
{
  for (PetscInt k = 0; k < row->n; k++) r2[k] = row->r2[k] / PetscSqr(CloudPairSize(cloud, a, row->index[k]));
}

void PairRowEvaluate(Cloud cloud, PetscInt a, PairRow *row)
{
  PetscReal r2[ROW_CAPACITY];

  if (!cloud->size) {
    KernelEvaluate(cloud->kernel, row->n, row->r2, row->W, NULL);
    return;
  }
  ScaleRow(cloud, a, row, r2);
  KernelEvaluate(cloud->kernel, row->n, r2, row->W, NULL);
  for (PetscInt k = 0; k < row->n; k++)
    row->W[k] *= PetscPowRealInt(1 / CloudPairSize(cloud, a, row->index[k]), (int)cloud->domain->dim);
}

void PairRowGradient(Cloud cloud, PetscInt a, PairRow *row)
{
  PetscReal r2[ROW_CAPACITY];

  if (!cloud->size) {
    KernelGradient(cloud->kernel, row->n, row->r2, row->F);
    return;
  }
  ScaleRow(cloud, a, row, r2);
  KernelGradient(cloud->kernel, row->n, r2, row->F);
  for (PetscInt k = 0; k < row->n; k++)
    row->F[k] *= PetscPowRealInt(1 / CloudPairSize(cloud, a, row->index[k]), (int)cloud->domain->dim + 2);
}
