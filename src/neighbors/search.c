/* The neighbour search: the list of the pairs within the kernel's support, and the factors of the pairs. */
#include "search.h"

#define PAIR_FLOPS    29 /* of a pair for -log_view: distance, kernel, factors */
#define VISITED_FLOPS 77 /* with the visitor's sums: W, normal, crowding, six moments */
#define AROUND        1  /* lines of cells around that of a particle, each way */

/* Stores in list and s those candidates of a run whose squared distance s = r2/h2 is below 'limit', without point a
   itself; returns how many there are. order holds the local indices, x, y and z the integer positions of all points in
   the grid's order; p is the position of a, unit its unit over h. LANES candidates are read, and as many may be
   written.
 */
#if defined(__AVX512F__) && !defined(PETSC_USE_64BIT_INDICES)
  #include <immintrin.h>

/* (p - x)/h of LANES candidates */
static inline __m512 Difference(__m512i p, const int32_t *x, __m512 unit)
{
  return _mm512_mul_ps(unit, _mm512_cvtepi32_ps(_mm512_sub_epi32(p, _mm512_loadu_si512(x))));
}

static inline PetscInt KeepNear(Run run, const PetscInt *restrict order, const int32_t *restrict x,
                                const int32_t *restrict y, const int32_t *restrict z, const int32_t p[DIM],
                                const float unit[DIM], float limit, PetscInt a, PetscInt *restrict list,
                                float *restrict s)
{
  const PetscInt  begin = RUN_BEGIN(run);
  const __m512    dx    = Difference(_mm512_set1_epi32(p[0]), x + begin, _mm512_set1_ps(unit[0]));
  const __m512    dy    = Difference(_mm512_set1_epi32(p[1]), y + begin, _mm512_set1_ps(unit[1]));
  const __m512    dz    = Difference(_mm512_set1_epi32(p[2]), z + begin, _mm512_set1_ps(unit[2]));
  const __m512    s2    = _mm512_fmadd_ps(dz, dz, _mm512_fmadd_ps(dy, dy, _mm512_mul_ps(dx, dx)));
  const __m512i   b     = _mm512_loadu_si512(order + begin);
  const __mmask16 real  = (__mmask16)((1u << RUN_COUNT(run)) - 1);
  const __mmask16 other = _mm512_mask_cmpneq_epi32_mask(real, b, _mm512_set1_epi32(a));
  const __mmask16 keep  = _mm512_mask_cmp_ps_mask(other, s2, _mm512_set1_ps(limit), _CMP_LT_OQ);

  _mm512_storeu_si512(list, _mm512_maskz_compress_epi32(keep, b));
  _mm512_storeu_ps(s, _mm512_maskz_compress_ps(keep, s2));
  return __builtin_popcount(keep);
}
#elif defined(SEARCH_EIGHT)
static inline PetscInt KeepEight(PetscInt begin, PetscInt count, const PetscInt *restrict order,
                                 const int32_t *restrict x, const int32_t *restrict y, const int32_t *restrict z,
                                 const int32_t p[DIM], const float unit[DIM], float limit, PetscInt a,
                                 PetscInt *restrict list, float *restrict s)
{
  const __m256   s2    = EightSquares(p, unit, x + begin, y + begin, z + begin);
  const __m256i  b     = _mm256_loadu_si256((const __m256i *)(order + begin));
  const unsigned bits  = EightNear(s2, _mm256_set1_ps(limit), b, a, count);
  const __m256i  place = EightFront(bits);

  _mm256_storeu_si256((__m256i *)list, _mm256_permutevar8x32_epi32(b, place));
  _mm256_storeu_ps(s, _mm256_permutevar8x32_ps(s2, place));
  return __builtin_popcount(bits);
}

static inline PetscInt KeepNear(Run run, const PetscInt *restrict order, const int32_t *restrict x,
                                const int32_t *restrict y, const int32_t *restrict z, const int32_t p[DIM],
                                const float unit[DIM], float limit, PetscInt a, PetscInt *restrict list,
                                float *restrict s)
{
  const PetscInt begin = RUN_BEGIN(run), count = RUN_COUNT(run);
  const PetscInt found = KeepEight(begin, count, order, x, y, z, p, unit, limit, a, list, s);

  if (count <= EIGHT) return found;
  return found + KeepEight(begin + EIGHT, count - EIGHT, order, x, y, z, p, unit, limit, a, list + found, s + found);
}
#else
static inline PetscInt KeepNear(Run run, const PetscInt *restrict order, const int32_t *restrict x,
                                const int32_t *restrict y, const int32_t *restrict z, const int32_t p[DIM],
                                const float unit[DIM], float limit, PetscInt a, PetscInt *restrict list,
                                float *restrict s)
{
  const int32_t px = p[0], py = p[1], pz = p[2];
  float         s2[LANES];
  PetscInt      found = 0;

  SIMD_LOOP()
  for (PetscInt k = 0; k < LANES; k++) {
    const PetscInt at = RUN_BEGIN(run) + k;
    const float    dx = unit[0] * (float)Apart(px, x[at]), dy = unit[1] * (float)Apart(py, y[at]),
                dz = unit[2] * (float)Apart(pz, z[at]);

    s2[k] = SumSquares(dx, dy, dz);
  }
  for (PetscInt k = 0; k < RUN_COUNT(run); k++) { /* branchless: the next one overwrites what is not kept */
    const PetscInt b = order[RUN_BEGIN(run) + k];

    list[found] = b;
    s[found]    = s2[k];
    found += (s2[k] < limit) & (b != a);
  }
  return found;
}
#endif

/* The factors of n padded pairs from s = r2/h2: w (NULL if not wanted), slope, the slope over s + eta2/h2, and the
   Laplacian ones in units of 'unit', whose sum is returned. -F is largest at r = 0; with the unit of SearchCreate no
   Laplacian factor is larger than sixteen bits can hold. */
static PetscInt PairFactors(Kernel kernel, float unit, PetscInt n, const float *restrict s, float *restrict w,
                            float *restrict slope_over_r2, float *restrict slope, uint16_t *restrict laplacian)
{
  const float    eta2 = ETA_OVER_H * ETA_OVER_H, inverse = 1 / unit;
  const PetscInt padded = (n + LANES - 1) / LANES * LANES;
  PetscInt       sum    = 0;

  KernelSingle(kernel, n, s, w, slope);
  for (PetscInt begin = 0; begin < padded; begin += LANES) {
    SIMD_LOOP(reduction(+ : sum))
    for (PetscInt k = begin; k < begin + LANES; k++) {
      const float   over = slope[k] / (s[k] + eta2);
      const int32_t code = (int32_t)(0.5f - inverse * over * s[k]);

      slope_over_r2[k] = over;
      laplacian[k]     = (uint16_t)code;
      sum += code;
    }
  }
  return sum;
}

/* What the search of all rows shares. */
typedef struct {
  Units     units;
  Lines     lines;
  PetscReal radius; /* of the kernel's support, m */
  float     limit;  /* its square over h2 */
  float     unit;   /* of the Laplacian factors */
  PetscInt  most;   /* the candidates of one row are at most so many */
  int32_t  *place;  /* [3][n_total] integer positions in the grid's order */
  Run      *run;    /* the runs of one row */
  float    *s;      /* [most] r2/h2 of the pairs of one row */
} Search;

static PetscErrorCode SearchCreate(Cloud cloud, Search *search)
{
  const CellGrid *grid        = &cloud->grid;
  const float     zero[LANES] = {0};
  float           slope[LANES];
  PetscInt        longest = 0;

  PetscFunctionBegin;
  search->units  = SearchUnits(cloud);
  search->radius = KernelSupport(cloud->kernel);
  search->limit  = (float)PetscSqr(search->radius / KernelSmoothingLength(cloud->kernel));
  LinesSet(grid, AROUND, &search->lines);
  for (PetscInt c = 0; c < grid->count; c++) longest = PetscMax(longest, grid->start[c + 1] - grid->start[c]);
  search->most = LinesCandidates(AROUND, longest);
  KernelSingle(cloud->kernel, 1, zero, NULL, slope);
  search->unit = slope[0] / -(float)UINT16_MAX;
  PetscCall(PetscMalloc3(DIM * cloud->n_total + LANES, &search->place, search->most, &search->s,
                         search->most / LANES + 3, &search->run));
  PetscCall(PlacesSort(&search->units, grid, cloud->n_total, cloud->field[FIELD_POSITION], search->place));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the neighbours of particle a; returns their number. Writes to list and search->s, whole vectors. What the loop
   needs is copied to local variables, which it keeps in registers: its stores could otherwise be to *search. */
static inline PetscInt FindNeighbors(Cloud cloud, const Search *search, PetscInt a, PetscInt list[])
{
  const PetscInt   n = cloud->n_total, *order = cloud->grid.order;
  const PetscReal *x     = cloud->field[FIELD_POSITION] + DIM * a;
  const Units     *units = &search->units;
  const int32_t   *place = search->place;
  const Run       *run   = search->run;
  float           *s     = search->s;
  const float      limit = search->limit, unit[DIM] = {units->unit[0], units->unit[1], units->unit[2]};
  const int32_t    p[DIM] = {(int32_t)Place(units, 0, x[0]), (int32_t)Place(units, 1, x[1]),
                             (int32_t)Place(units, 2, x[2])};
  const PetscInt   runs   = FindRuns(&cloud->grid, &search->lines, AROUND, PETSC_FALSE, x, search->radius, search->run);
  PetscInt         found  = 0;

  for (PetscInt r = 0; r < runs; r++)
    found += KeepNear(run[r], order, place, place + n, place + 2 * n, p, unit, limit, a, list + found, s + found);
  return found;
}

PetscErrorCode CloudSearch(Cloud cloud, RowVisitor visit, void *context)
{
  const PetscReal *x    = cloud->field[FIELD_POSITION];
  PetscInt64       used = 0; /* pairs */
  float            w[ROW_CAPACITY + LANES], slope_over_r2[ROW_CAPACITY + LANES];
  Search           search;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_NEIGHBORS), 0, 0, 0, 0));
  EightSet();
  if (cloud->size) {
    PetscCall(SearchGraded(cloud, visit, context));
    PetscCall(LogPairFlops(cloud->first[cloud->n_owned], visit ? VISITED_FLOPS : PAIR_FLOPS));
    PetscCall(PetscLogEventEnd(LogEvent(EVENT_NEIGHBORS), 0, 0, 0, 0));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(CellGridBuild(&cloud->grid, cloud->domain->dim, cloud->n_total, x, KernelSupport(cloud->kernel), SPLIT));
  PetscCall(SearchCreate(cloud, &search));
  FindWeights(cloud);
  cloud->laplacian_unit = search.unit;
  cloud->first[0]       = 0;
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    PetscInt found;

    if (used + search.most > cloud->list_capacity)
      PetscCall(ReserveList(cloud, CloudListRoom(used, cloud->n_owned - a, search.most)));
    found = FindNeighbors(cloud, &search, a, cloud->list + used);
    PetscCall(RowCheck(cloud, a, found));
    PadRow(a, found, cloud->list + used, search.s);
    cloud->laplacian_sum[a] = PairFactors(cloud->kernel, search.unit, found, search.s, visit ? w : NULL, slope_over_r2,
                                          cloud->slope + used, cloud->laplacian + used);
    if (cloud->weight)
      WeightRow(cloud, found, cloud->list + used, visit ? w : NULL, slope_over_r2, cloud->slope + used);
    used = RowEnd(cloud, a, used, found, w, slope_over_r2, visit, context);
  }
  PetscCall(PetscFree3(search.place, search.s, search.run));
  PetscCall(LogPairFlops(cloud->first[cloud->n_owned], visit ? VISITED_FLOPS : PAIR_FLOPS));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_NEIGHBORS), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
