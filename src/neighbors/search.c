/* Cells over the points of the cloud, and the list of neighbours. */
#include "search.h"

#define LINES_AROUND 9   /* of cells along x */
#define SPLIT        4   /* cells along x in the kernel's support: a line is cut close, which leaves fewer candidates */
#define LANES        16  /* of the vector that compares candidates */
#define CHUNK        256 /* candidates compared before they are kept */
#define ROW_GUESS    72  /* neighbours a particle, to begin with */

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

PetscErrorCode CellGridBuild(CellGrid *grid, PetscInt dim, PetscInt n, const PetscReal x[], PetscReal size,
                             PetscInt split)
{
  const PetscReal per_size[DIM] = {split, 1, 1};
  PetscReal       upper[DIM], cells = 1;

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
      cells *= d < dim ? PetscFloorReal((upper[d] - grid->lower[d]) * (per_size[d] / grid->size)) + 1 : 1;
    if (cells <= CELLS_PER_POINT * (PetscReal)n + 1000) break;
  }
  for (PetscInt d = 0; d < DIM; d++)
    grid->n[d] = d < dim ? (PetscInt)((upper[d] - grid->lower[d]) * (per_size[d] / grid->size)) + 1 : 1;
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
      cell[d] = PetscMin(grid->n[d] - 1, (PetscInt)((x[DIM * a + d] - grid->lower[d]) * (per_size[d] / grid->size)));
    grid->of_point[a] = (cell[2] * grid->n[1] + cell[1]) * grid->n[0] + cell[0];
    grid->start[grid->of_point[a] + 1]++;
  }
  for (PetscInt c = 0; c < grid->count; c++) grid->start[c + 1] += grid->start[c];
  for (PetscInt a = 0; a < n; a++) grid->order[grid->start[grid->of_point[a]]++] = a;
  for (PetscInt c = grid->count; c > 0; c--) grid->start[c] = grid->start[c - 1];
  grid->start[0] = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Places are compared as whole numbers of a unit, sixteen at a time. The unit is the same on every rank and the box is
   2^n of them, 2^30 if it is not narrow: differences are exact, and the same for both particles of a pair, also across
   a periodic face or a mirror. It is a billionth of the box, so that a place is as exact as the single precision of the
   factors. */
#define BOX_BITS 30
#define OUTSIDE  1.5 /* box lengths from the middle that the numbers reach, and so many times the largest support: */
#define REACHES  4

typedef struct {
  PetscReal center[DIM], inverse[DIM]; /* m; 1/m */
  float     unit[DIM];                 /* over h */
} Units;

static Units ChooseUnits(Cloud cloud)
{
  const Domain domain = cloud->domain;
  Units        units  = {{0}, {0}, {0}};

  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal length = domain->upper[d] - domain->lower[d], needed = OUTSIDE * length + REACHES * cloud->reach;
    int             bits = BOX_BITS;

    while (PetscPowRealInt(2, 31 - bits) * length < needed) bits--;
    units.center[d]  = 0.5 * (domain->lower[d] + domain->upper[d]);
    units.inverse[d] = PetscPowRealInt(2, bits) / length;
    units.unit[d]    = (float)(1 / (units.inverse[d] * KernelSmoothingLength(cloud->kernel)));
  }
  return units;
}

static inline PetscReal Place(const Units *units, PetscInt d, PetscReal x)
{
  return rint((x - units->center[d]) * units->inverse[d]);
}

/* Places of the points in the grid's order: [3][n]. */
static PetscErrorCode SortPlaces(Cloud cloud, const Units *units, int32_t sorted[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];
  const PetscInt   n = cloud->n_total;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++) {
    const PetscReal *p = x + DIM * cloud->grid.order[k];

    for (PetscInt d = 0; d < DIM; d++) {
      const PetscReal place = Place(units, d, p[d]);

      PetscCheck(PetscAbsReal(place) < INT32_MAX, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
                 "a particle at (%g, %g, %g) m is further from the box than that is long", (double)p[0], (double)p[1],
                 (double)p[2]);
      sorted[d * n + k] = (int32_t)place;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Appends to list and s those of 'count' points whose squared distance s = r2/h2 is below 'limit', point a itself
   excluded; returns how many. order: local indices, x, y, z: places, p: place of a, unit: over h. May write LANES - 1
   entries behind the last. This loop sees every candidate. */
#if defined(__AVX512F__) && !defined(PETSC_USE_64BIT_INDICES)
  #include <immintrin.h>

/* (p - x)/h of the lanes */
static inline __m512 Difference(__mmask16 valid, __m512i p, const int32_t *x, __m512 unit)
{
  return _mm512_mul_ps(unit, _mm512_cvtepi32_ps(_mm512_sub_epi32(p, _mm512_maskz_loadu_epi32(valid, x))));
}

static inline PetscInt KeepNear(PetscInt count, const PetscInt *restrict order, const int32_t *restrict x,
                                const int32_t *restrict y, const int32_t *restrict z, const int32_t p[DIM],
                                const float unit[DIM], float limit, PetscInt a, PetscInt *restrict list,
                                float *restrict s)
{
  const __m512i px = _mm512_set1_epi32(p[0]), py = _mm512_set1_epi32(p[1]), pz = _mm512_set1_epi32(p[2]),
                self = _mm512_set1_epi32(a);
  const __m512 end = _mm512_set1_ps(limit), ux = _mm512_set1_ps(unit[0]), uy = _mm512_set1_ps(unit[1]),
               uz = _mm512_set1_ps(unit[2]);
  PetscInt found  = 0;

  for (PetscInt k = 0; k < count; k += LANES) {
    const __mmask16 valid = (__mmask16)(count - k >= LANES ? 0xffff : (1 << (count - k)) - 1);
    const __m512    dx    = Difference(valid, px, x + k, ux);
    const __m512    dy    = Difference(valid, py, y + k, uy);
    const __m512    dz    = Difference(valid, pz, z + k, uz);
    const __m512    s2    = _mm512_fmadd_ps(dz, dz, _mm512_fmadd_ps(dy, dy, _mm512_mul_ps(dx, dx)));
    const __m512i   b     = _mm512_maskz_loadu_epi32(valid, order + k);
    const __mmask16 other = _mm512_mask_cmpneq_epi32_mask(valid, b, self);
    const __mmask16 keep  = _mm512_mask_cmp_ps_mask(other, s2, end, _CMP_LT_OQ);

    _mm512_storeu_si512(list + found, _mm512_maskz_compress_epi32(keep, b));
    _mm512_storeu_ps(s + found, _mm512_maskz_compress_ps(keep, s2));
    found += __builtin_popcount(keep);
  }
  return found;
}
#else
static inline PetscInt KeepNear(PetscInt count, const PetscInt *restrict order, const int32_t *restrict x,
                                const int32_t *restrict y, const int32_t *restrict z, const int32_t p[DIM],
                                const float unit[DIM], float limit, PetscInt a, PetscInt *restrict list,
                                float *restrict s)
{
  const int32_t px = p[0], py = p[1], pz = p[2];
  float         s2[CHUNK];
  PetscInt      found = 0;

  for (PetscInt begin = 0; begin < count; begin += CHUNK) {
    const PetscInt m = PetscMin(CHUNK, count - begin);

    SIMD_LOOP()
    for (PetscInt k = 0; k < m; k++) {
      const float dx = unit[0] * (float)(px - x[begin + k]), dy = unit[1] * (float)(py - y[begin + k]),
                  dz = unit[2] * (float)(pz - z[begin + k]);

      s2[k] = dx * dx + dy * dy + dz * dz;
    }
    for (PetscInt k = 0; k < m; k++) { /* without a branch */
      const PetscInt b = order[begin + k];

      list[found] = b;
      s[found]    = s2[k];
      found += (s2[k] < limit) & (b != a);
    }
  }
  return found;
}
#endif

/* The neighbours of point a among sorted points: appends their indices to list and squared distances to s, returns
 * their number. sorted: [3][n], in the grid's order. */
static PetscInt FindNeighbors(const CellGrid *grid, PetscInt n, const int32_t *restrict sorted, const int32_t p[DIM],
                              PetscInt a, const float unit[DIM], float limit, PetscInt *restrict list,
                              float *restrict s)
{
  const PetscInt cell = grid->of_point[a], cx = cell % grid->n[0], cy = (cell / grid->n[0]) % grid->n[1],
                 cz = cell / (grid->n[0] * grid->n[1]);
  const PetscInt x0 = PetscMax(0, cx - SPLIT), x1 = PetscMin(grid->n[0] - 1, cx + SPLIT);
  PetscInt       found = 0;

  for (PetscInt kz = PetscMax(0, cz - 1); kz <= PetscMin(grid->n[2] - 1, cz + 1); kz++)
    for (PetscInt ky = PetscMax(0, cy - 1); ky <= PetscMin(grid->n[1] - 1, cy + 1); ky++) {
      const PetscInt line = (kz * grid->n[1] + ky) * grid->n[0], begin = grid->start[line + x0],
                     count = grid->start[line + x1 + 1] - begin;

      found += KeepNear(count, grid->order + begin, sorted + begin, sorted + n + begin, sorted + 2 * n + begin, p, unit,
                        limit, a, list + found, s + found);
    }
  return found;
}

/* Room for 'more' pairs behind the 'used' ones. */
static PetscErrorCode ReserveList(Cloud cloud, PetscInt used, PetscInt more)
{
  PetscFunctionBegin;
  if (used + more <= cloud->list_capacity) PetscFunctionReturn(PETSC_SUCCESS);
  cloud->list_capacity = used + more;
  PetscCall(PetscRealloc(cloud->list_capacity * sizeof(PetscInt), &cloud->list));
  PetscCall(PetscRealloc(cloud->list_capacity * sizeof(float), &cloud->slope));
  PetscCall(PetscRealloc(cloud->list_capacity * sizeof(uint16_t), &cloud->laplacian));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The factors of n pairs from s = r2/h2, and w (NULL: not wanted); returns the sum of the Laplacian ones. -F is largest
   at r = 0, so that -F r2/(r2 + eta2) is at most 'unit' times the largest number of sixteen bits. */
static PetscInt PairFactors(Kernel kernel, float unit, PetscInt n, const float *restrict s, float *restrict w,
                            float *restrict slope, uint16_t *restrict laplacian)
{
  const float eta2 = ETA_OVER_H * ETA_OVER_H, inverse = 1 / unit;
  PetscInt    sum = 0;

  KernelSingle(kernel, n, s, w, slope);
  SIMD_LOOP(reduction(+ : sum))
  for (PetscInt k = 0; k < n; k++) {
    const int32_t whole = (int32_t)(0.5f - inverse * slope[k] * s[k] / (s[k] + eta2));

    laplacian[k] = (uint16_t)whole;
    sum += whole;
  }
  return sum;
}

/* Pairs of wall particles have no weight: nothing flows between them. Returns the sum of the others'. */
static PetscInt DropWallPairs(const PetscInt layer[], PetscInt n, const PetscInt list[], uint16_t laplacian[])
{
  PetscInt sum = 0;

  for (PetscInt k = 0; k < n; k++) {
    if (layer[list[k]]) laplacian[k] = 0;
    sum += laplacian[k];
  }
  return sum;
}

PetscErrorCode NeighborsFind(Cloud cloud, RowVisitor visit, void *context)
{
  const PetscInt   n      = cloud->n_total;
  const PetscReal *x      = cloud->field[FIELD_POSITION];
  const Units      units  = ChooseUnits(cloud);
  const PetscReal  radius = KernelSupport(cloud->kernel);
  const float      limit  = (float)PetscSqr(radius / KernelSmoothingLength(cloud->kernel));
  PetscInt         used = 0, most, longest = 0;
  int32_t         *sorted;
  float           *s, w[ROW_CAPACITY], zero = 0, unit;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_NEIGHBORS), 0, 0, 0, 0));
  PetscCall(CellGridBuild(&cloud->grid, cloud->domain->dim, n, x, radius, SPLIT));
  for (PetscInt c = 0; c < cloud->grid.count; c++)
    longest = PetscMax(longest, cloud->grid.start[c + 1] - cloud->grid.start[c]);
  KernelSingle(cloud->kernel, 1, &zero, NULL, &unit);
  unit /= -(float)UINT16_MAX;
  cloud->laplacian_unit = unit;
  most                  = LINES_AROUND * (2 * SPLIT + 1) * longest + LANES;
  PetscCall(PetscMalloc2(DIM * n, &sorted, most, &s));
  PetscCall(SortPlaces(cloud, &units, sorted));
  cloud->first[0] = 0;
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    const int32_t p[DIM] = {(int32_t)Place(&units, 0, x[DIM * a]), (int32_t)Place(&units, 1, x[DIM * a + 1]),
                            (int32_t)Place(&units, 2, x[DIM * a + 2])};
    PetscInt      found;

    if (used + most > cloud->list_capacity)
      PetscCall(ReserveList(cloud, used, PetscMax(most, used / 8 + ROW_GUESS * (cloud->n_owned - a)) + most));
    found = FindNeighbors(&cloud->grid, n, sorted, p, a, units.unit, limit, cloud->list + used, s);
    PetscCheck(found <= ROW_CAPACITY, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
               "particle %" PetscInt_FMT " at (%g, %g, %g) has %" PetscInt_FMT " neighbours: particles have clumped",
               cloud->integer[INT_ID][a], (double)x[3 * a], (double)x[3 * a + 1], (double)x[3 * a + 2], found);
    cloud->laplacian_sum[a] =
      PairFactors(cloud->kernel, unit, found, s, visit ? w : NULL, cloud->slope + used, cloud->laplacian + used);
    if (a >= cloud->n_fluid)
      cloud->laplacian_sum[a] =
        DropWallPairs(cloud->integer[INT_LAYER], found, cloud->list + used, cloud->laplacian + used);
    used += found;
    cloud->first[a + 1] = used;
    if (visit) visit(cloud, a, s, w, context);
  }
  PetscCall(PetscFree2(sorted, s));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_NEIGHBORS), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
