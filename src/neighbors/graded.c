/* The neighbour search of particles of different sizes. A pair belongs together if it is within the support of its mean
   smoothing length. Particles are sorted by size into levels, each with cells of its own as wide as the support of its
   largest particle, so that a search looks at about as many candidates as one of particles of one size. */
#include "search.h"

#define LEVELS       5    /* of sizes, by factors of 2 */
#define LEVEL_MARGIN 1.05 /* the fine and the coarse spacing themselves, and a little more, end a level */
#define SPLIT        4    /* cells along x in the width of a cell */

/* The particles of one level in the order of its grid; arrays have room for LANES more. */
typedef struct {
  PetscInt   n, longest; /* longest: particles of a cell at most */
  PetscReal  largest;    /* size, 1 */
  PetscInt  *point;      /* [n] local indices */
  PetscReal *x;          /* [n][3] m */
  CellGrid   grid;       /* of x */
  int32_t   *place[DIM]; /* [n] integer positions, in the grid's order from here on */
  float     *size;       /* [n] */
  PetscInt  *index;      /* [n] local indices */
} Level;

typedef struct {
  Units     units;
  PetscReal support;     /* of the kernel, m */
  float     limit, unit; /* support2/h2; of the Laplacian factors */
  Level     level[LEVELS];
  float s[ROW_CAPACITY + LANES], inverse[ROW_CAPACITY + LANES]; /* of one row: r2 over h_ab^2; 1/size of the pairs */
} GradedSearch;

static inline PetscInt LevelOf(PetscReal size)
{
  PetscInt  level = 0;
  PetscReal bound = LEVEL_MARGIN;

  while (size > bound && level < LEVELS - 1) {
    bound *= 2;
    level++;
  }
  return level;
}

/* Sorts the particles into the levels. */
static PetscErrorCode FillLevels(Cloud cloud, Level level[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    Level *own = &level[LevelOf(cloud->size[a])];

    own->n++;
    own->largest = PetscMax(own->largest, cloud->size[a]);
  }
  for (PetscInt l = 0; l < LEVELS; l++) {
    PetscCall(PetscMalloc2(level[l].n, &level[l].point, DIM * level[l].n, &level[l].x));
    level[l].n = 0;
  }
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    Level *own = &level[LevelOf(cloud->size[a])];

    for (PetscInt d = 0; d < DIM; d++) own->x[DIM * own->n + d] = x[DIM * a + d];
    own->point[own->n++] = a;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The cells of a level, and what a row reads of its particles, in the grid's order. */
static PetscErrorCode SortLevel(Cloud cloud, const Units *units, PetscReal support, Level *level)
{
  const PetscInt n = level->n;

  PetscFunctionBegin;
  PetscCall(CellGridBuild(&level->grid, cloud->domain->dim, n, level->x, support * level->largest, SPLIT));
  PetscCall(PetscCalloc5(n + LANES, &level->place[0], n + LANES, &level->place[1], n + LANES, &level->place[2],
                         n + LANES, &level->size, n + LANES, &level->index));
  for (PetscInt k = 0; k < n; k++) {
    const PetscInt   at = level->grid.order[k];
    const PetscReal *p  = level->x + DIM * at;

    level->index[k] = level->point[at];
    level->size[k]  = (float)cloud->size[level->point[at]];
    for (PetscInt d = 0; d < DIM; d++) {
      const PetscReal place = Place(units, d, p[d]);

      PetscCheck(PetscAbsReal(place) < INT32_MAX, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
                 "a particle at (%g, %g, %g) m is further from the box than that is long", (double)p[0], (double)p[1],
                 (double)p[2]);
      level->place[d][k] = (int32_t)place;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SearchCreate(Cloud cloud, GradedSearch *search)
{
  const float zero[LANES] = {0};
  float       slope[LANES];

  PetscFunctionBegin;
  search->units   = SearchUnits(cloud);
  search->support = KernelSupport(cloud->kernel);
  search->limit   = (float)PetscSqr(search->support / KernelSmoothingLength(cloud->kernel));
  KernelSingle(cloud->kernel, 1, zero, NULL, slope);
  /* V_a V_b F grows with the size to the power of the dimension less two */
  search->unit = (float)PetscPowRealInt(cloud->size_most, (int)cloud->domain->dim - 2) * slope[0] / -(float)UINT16_MAX;
  PetscCall(FillLevels(cloud, search->level));
  for (PetscInt l = 0; l < LEVELS; l++)
    if (search->level[l].n) PetscCall(SortLevel(cloud, &search->units, search->support, &search->level[l]));
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
    PetscCall(PetscFree5(level->place[0], level->place[1], level->place[2], level->size, level->index));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Appends to list, s and inverse those candidates begin <= k < end of a level that are near a particle at the integer
   position p: pairs with s = r2/h_ab^2 below the limit, without the particle itself; returns how many there are. LANES
   candidates are read, and as many may be written. */
#if defined(__AVX512F__) && !defined(PETSC_USE_64BIT_INDICES)
  #include <immintrin.h>

static inline __m512 Square(int32_t p, const int32_t *x, float unit)
{
  const __m512 d = _mm512_mul_ps(_mm512_set1_ps(unit),
                                 _mm512_cvtepi32_ps(_mm512_sub_epi32(_mm512_set1_epi32(p), _mm512_loadu_si512(x))));

  return _mm512_mul_ps(d, d);
}

static inline PetscInt KeepLanes(const Level *level, const float unit[DIM], float own, float limit, PetscInt a,
                                 const int32_t p[DIM], PetscInt begin, PetscInt count, PetscInt *restrict list,
                                 float *restrict s, float *restrict inverse)
{
  const __m512 sum      = _mm512_add_ps(_mm512_set1_ps(own), _mm512_loadu_ps(level->size + begin)),
               inv      = _mm512_div_ps(_mm512_set1_ps(2), sum),
               r2       = _mm512_add_ps(_mm512_add_ps(Square(p[0], level->place[0] + begin, unit[0]),
                                                      Square(p[1], level->place[1] + begin, unit[1])),
                                        Square(p[2], level->place[2] + begin, unit[2])),
               s2       = _mm512_mul_ps(r2, _mm512_mul_ps(inv, inv));
  const __m512i   b     = _mm512_loadu_si512(level->index + begin);
  const __mmask16 real  = (__mmask16)((1u << count) - 1);
  const __mmask16 other = _mm512_mask_cmpneq_epi32_mask(real, b, _mm512_set1_epi32(a));
  const __mmask16 keep  = _mm512_mask_cmp_ps_mask(other, s2, _mm512_set1_ps(limit), _CMP_LT_OQ);

  _mm512_storeu_si512(list, _mm512_maskz_compress_epi32(keep, b));
  _mm512_storeu_ps(s, _mm512_maskz_compress_ps(keep, s2));
  _mm512_storeu_ps(inverse, _mm512_maskz_compress_ps(keep, inv));
  return __builtin_popcount(keep);
}
#else
static inline PetscInt KeepLanes(const Level *level, const float unit[DIM], float own, float limit, PetscInt a,
                                 const int32_t p[DIM], PetscInt begin, PetscInt count, PetscInt *restrict list,
                                 float *restrict s, float *restrict inverse)
{
  const int32_t *x = level->place[0] + begin, *y = level->place[1] + begin, *z = level->place[2] + begin;
  float          s2[LANES], inv[LANES];
  PetscInt       found = 0;

  SIMD_LOOP()
  for (PetscInt k = 0; k < LANES; k++) {
    const float dx = unit[0] * (float)Apart(p[0], x[k]), dy = unit[1] * (float)Apart(p[1], y[k]),
                dz = unit[2] * (float)Apart(p[2], z[k]);

    inv[k] = 2 / (own + level->size[begin + k]);
    s2[k]  = (dx * dx + dy * dy + dz * dz) * (inv[k] * inv[k]);
  }
  for (PetscInt k = 0; k < count; k++) { /* branchless: the next one overwrites what is not kept */
    const PetscInt b = level->index[begin + k];

    list[found]    = b;
    s[found]       = s2[k];
    inverse[found] = inv[k];
    found += (s2[k] < limit) & (b != a);
  }
  return found;
}
#endif

/* Appends to a row the neighbours of particle a among the candidates begin <= k < end of a level; ROW_CAPACITY if there
   is no room for them. */
static inline PetscInt KeepNear(Cloud cloud, GradedSearch *search, const Level *level, PetscInt a, const int32_t p[DIM],
                                PetscInt begin, PetscInt end, PetscInt list[], PetscInt found)
{
  const float own = (float)cloud->size[a];

  for (; begin < end && found <= ROW_CAPACITY - LANES; begin += LANES)
    found += KeepLanes(level, search->units.unit, own, search->limit, a, p, begin, PetscMin(LANES, end - begin),
                       list + found, search->s + found, search->inverse + found);
  return begin < end ? ROW_CAPACITY : found;
}

/* How far a coordinate (m) is from the cell number c of a direction. */
static inline PetscReal CellDistance(const CellGrid *grid, PetscInt d, PetscInt c, PetscReal x)
{
  const PetscReal low = grid->lower[d] + c * grid->size - x;

  return PetscMax(0, PetscMax(low, -low - grid->size));
}

/* The cells of direction d within a distance (m) of x: first and last. */
static inline void CellRange(const CellGrid *grid, PetscInt d, PetscReal x, PetscReal distance, PetscReal per_size,
                             PetscInt *first, PetscInt *last)
{
  const PetscReal scale = per_size / grid->size, low = (x - distance - grid->lower[d]) * scale,
                  high = (x + distance - grid->lower[d]) * scale;

  *first = (PetscInt)PetscMax(0, PetscFloorReal(low));
  *last  = (PetscInt)PetscMin(grid->n[d] - 1, PetscFloorReal(high));
}

/* Appends to a row the neighbours of particle a of one level. */
static PetscInt FindInLevel(Cloud cloud, GradedSearch *search, const Level *level, PetscInt a, const int32_t p[DIM],
                            PetscInt list[], PetscInt found)
{
  const CellGrid  *grid   = &level->grid;
  const PetscReal *x      = cloud->field[FIELD_POSITION] + DIM * a;
  const PetscReal  radius = (1 + POINT_TOLERANCE) * search->support * 0.5 * (cloud->size[a] + level->largest);
  PetscInt         first[DIM], last[DIM];

  for (PetscInt d = 1; d < DIM; d++) CellRange(grid, d, x[d], radius, 1, &first[d], &last[d]);
  for (PetscInt z = first[2]; z <= last[2]; z++)
    for (PetscInt y = first[1]; y <= last[1]; y++) {
      const PetscReal dy = CellDistance(grid, 1, y, x[1]), dz = grid->n[2] > 1 ? CellDistance(grid, 2, z, x[2]) : 0,
                      left2 = radius * radius - dy * dy - dz * dz;
      PetscInt from, to;

      if (left2 < 0) continue;
      CellRange(grid, 0, x[0], PetscSqrtReal(left2), SPLIT, &from, &to);
      if (from > to) continue;
      found = KeepNear(cloud, search, level, a, p, grid->start[CellIndex(grid->n, from, y, z)],
                       grid->start[CellIndex(grid->n, to, y, z) + 1], list, found);
    }
  return found;
}

/* The factors of n padded pairs of particle a, with the weights of the neighbours: see Cloud and RowVisitor. With q = h
   over h_ab, the pair's W is q^dim times that of h at r q, F q^(dim + 2) times. w: NULL if not wanted. Returns the sum
   of the Laplacian factors. */
static PetscInt GradedFactors(Cloud cloud, const GradedSearch *search, PetscInt a, PetscInt n, const PetscInt list[],
                              float *restrict w, float *restrict slope_over_r2, float *restrict slope,
                              uint16_t *restrict laplacian)
{
  const float      eta2 = ETA_OVER_H * ETA_OVER_H, inverse = 1 / search->unit, own = (float)cloud->weight[a];
  const PetscBool  flat   = (PetscBool)(cloud->domain->dim == 2);
  const PetscReal *weight = cloud->weight;
  const PetscInt   padded = (n + LANES - 1) / LANES * LANES;
  PetscInt         sum    = 0;

  KernelSingle(cloud->kernel, n, search->s, w, slope);
  SIMD_LOOP(reduction(+ : sum))
  for (PetscInt k = 0; k < padded; k++) {
    const float   q = search->inverse[k], q2 = q * q, q_dim = flat ? q2 : q2 * q, other = (float)weight[list[k]];
    const float   steep = slope[k] * q_dim * q2, over = steep / (search->s[k] + eta2);
    const int32_t code = (int32_t)(0.5f - inverse * over * search->s[k] * (own * other));

    if (w) w[k] *= q_dim * other;
    slope[k]         = steep * other;
    slope_over_r2[k] = over * q2 * other;
    laplacian[k]     = (uint16_t)code;
    sum += code;
  }
  return sum;
}

/* Volumes over V_0. */
static void FindWeights(Cloud cloud)
{
  for (PetscInt a = 0; a < cloud->n_total; a++) cloud->weight[a] = cloud->volume[a] / cloud->domain->volume;
}

/* The row of particle a behind 'used' pairs; returns its length. */
static PetscErrorCode FindRow(Cloud cloud, GradedSearch *search, PetscInt a, PetscInt64 used, PetscInt *length)
{
  const PetscReal *x      = cloud->field[FIELD_POSITION] + DIM * a;
  const int32_t    p[DIM] = {(int32_t)Place(&search->units, 0, x[0]), (int32_t)Place(&search->units, 1, x[1]),
                             (int32_t)Place(&search->units, 2, x[2])};
  PetscInt        *list = cloud->list + used, found = 0;

  PetscFunctionBegin;
  for (PetscInt l = 0; l < LEVELS; l++)
    if (search->level[l].n) found = FindInLevel(cloud, search, &search->level[l], a, p, list, found);
  PetscCheck(found <= ROW_CAPACITY - LANES, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
             "particle %" PetscInt_FMT " at (%g, %g, %g) m has more than %" PetscInt_FMT
             " neighbours: particles have clumped; a smaller -time_cfl or -time_step helps",
             cloud->integer[INT_ID][a], (double)x[0], (double)x[1], (double)x[2], found);
  PadRow(a, found, list, search->s);
  for (PetscInt k = found; k < found + LANES; k++) search->inverse[k] = 1;
  *length = found;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SearchGraded(Cloud cloud, RowVisitor visit, void *context)
{
  const PetscInt most = ROW_CAPACITY + LANES;
  PetscInt64     used = 0; /* pairs */
  float          w[ROW_CAPACITY + LANES], slope_over_r2[ROW_CAPACITY + LANES];
  GradedSearch  *search;

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
    PetscCall(FindRow(cloud, search, a, used, &found));
    cloud->laplacian_sum[a] = GradedFactors(cloud, search, a, found, cloud->list + used, visit ? w : NULL,
                                            slope_over_r2, cloud->slope + used, cloud->laplacian + used);
    if (a >= cloud->n_fluid)
      cloud->laplacian_sum[a] =
        DropWallPairs(cloud->integer[INT_LAYER], found, cloud->list + used, cloud->laplacian + used);
    used += found;
    cloud->first[a + 1] = used;
    if (visit) visit(cloud, a, w, slope_over_r2, context);
  }
  PetscCall(SearchDestroy(search));
  PetscCall(PetscFree(search));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void PairRowEvaluate(Cloud cloud, PetscInt a, PairRow *row, PetscBool slope)
{
  const PetscInt dim = cloud->domain->dim;
  PetscReal      r2[ROW_CAPACITY];

  if (!cloud->size) {
    KernelEvaluate(cloud->kernel, row->n, row->r2, row->W, slope ? row->F : NULL);
    return;
  }
  for (PetscInt k = 0; k < row->n; k++) r2[k] = row->r2[k] / PetscSqr(CloudPairSize(cloud, a, row->index[k]));
  KernelEvaluate(cloud->kernel, row->n, r2, row->W, slope ? row->F : NULL);
  for (PetscInt k = 0; k < row->n; k++) {
    const PetscReal q = 1 / CloudPairSize(cloud, a, row->index[k]), q_dim = PetscPowRealInt(q, (int)dim);

    row->W[k] *= q_dim;
    if (slope) row->F[k] *= q_dim * q * q;
  }
}
