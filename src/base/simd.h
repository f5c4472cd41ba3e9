/* SIMD types for the most expensive pair loops: SIMD_WIDTH numbers, or SIMD_WIDTH vectors, at a time. SIMD_WIDTH is the
   width of the processor's registers, at least four. The types are vector extensions of GCC and clang, so the code
   compiles for any processor; intrinsics stand only where these compilers produce slow code. */
#ifndef ISPH_SIMD_H
#define ISPH_SIMD_H

#if defined(__AVX2__)
  #include <immintrin.h>
#endif
#if defined(__AVX512F__)
  #define SIMD_WIDTH 8
  #define SIMD_NAME  "AVX-512"
#elif defined(__AVX2__)
  #define SIMD_WIDTH 4
  #define SIMD_NAME  "AVX2"
#else
  #define SIMD_WIDTH 4
  #define SIMD_NAME  "any processor of its architecture"
#endif
#include "base.h"

typedef PetscReal Vec4 __attribute__((vector_size(4 * sizeof(PetscReal))));

/* Vec4Load - x[0] to x[3]; x[3] must be readable even if the caller needs three numbers only. */
static inline Vec4 Vec4Load(const PetscReal x[])
{
  Vec4 t;

  (void)memcpy(&t, x, sizeof(t));
  return t;
}

/* Vec4Store - stores the first three numbers. */
static inline void Vec4Store(Vec4 t, PetscReal x[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) x[d] = t[d];
}

typedef PetscReal Simd __attribute__((vector_size(SIMD_WIDTH * sizeof(PetscReal))));
typedef int64_t   SimdMask __attribute__((vector_size(SIMD_WIDTH * sizeof(int64_t))));
typedef float     SimdSingle __attribute__((vector_size(SIMD_WIDTH * sizeof(float))));

/* SIMD_WIDTH vectors of three numbers. */
typedef struct {
  Simd x, y, z;
} Simd3;

/* SimdSet - s in every lane. */
static inline Simd SimdSet(PetscReal s)
{
#if SIMD_WIDTH == 8
  return (Simd){s, s, s, s, s, s, s, s};
#else
  return (Simd){s, s, s, s};
#endif
}

/* SimdLoad - x[0] to x[SIMD_WIDTH - 1]. */
static inline Simd SimdLoad(const PetscReal x[])
{
  Simd t;

  (void)memcpy(&t, x, sizeof(t));
  return t;
}

/* SimdLoadSingle - SimdLoad from an array in single precision. */
static inline Simd SimdLoadSingle(const float x[])
{
#if defined(__AVX512F__)
  return (Simd)_mm512_cvtps_pd(_mm256_loadu_ps(x));
#else
  SimdSingle t;

  (void)memcpy(&t, x, sizeof(t));
  return __builtin_convertvector(t, Simd);
#endif
}

/* SimdScaleSingle - multiplies SIMD_WIDTH numbers in single precision with t. */
static inline void SimdScaleSingle(SimdSingle t, float x[])
{
  SimdSingle own;

  (void)memcpy(&own, x, sizeof(own));
  own *= t;
  (void)memcpy(x, &own, sizeof(own));
}

/* SimdGather - p[b[0]] to p[b[SIMD_WIDTH - 1]]. Single loads are faster than the processor's gather instruction. */
static inline Simd SimdGather(const PetscReal p[], const PetscInt b[SIMD_WIDTH])
{
#if SIMD_WIDTH == 8
  return (Simd){p[b[0]], p[b[1]], p[b[2]], p[b[3]], p[b[4]], p[b[5]], p[b[6]], p[b[7]]};
#else
  return (Simd){p[b[0]], p[b[1]], p[b[2]], p[b[3]]};
#endif
}

/* SimdFirst - t with zeros in all lanes but the first n. */
static inline Simd SimdFirst(Simd t, PetscInt n)
{
#if SIMD_WIDTH == 8
  const SimdMask lane = {0, 1, 2, 3, 4, 5, 6, 7};
#else
  const SimdMask lane = {0, 1, 2, 3};
#endif

  return (Simd)((SimdMask)t & (lane < n));
}

/* Simd3Set - the vector v in every lane. */
static inline Simd3 Simd3Set(const PetscReal v[DIM])
{
  return (Simd3){SimdSet(v[0]), SimdSet(v[1]), SimdSet(v[2])};
}

/* Where the vectors of SIMD_WIDTH particles begin in an array [n][3]. */
typedef struct {
  uint32_t at[SIMD_WIDTH];
} SimdOffsets;

/* SimdLocate - the offsets of particles b[0] to b[SIMD_WIDTH - 1], which serve all arrays [n][3]. */
static inline SimdOffsets SimdLocate(const PetscInt b[SIMD_WIDTH])
{
  SimdOffsets p;

  for (PetscInt k = 0; k < SIMD_WIDTH; k++) p.at[k] = DIM * (uint32_t)b[k];
  return p;
}

/* Simd3Collect - the vectors of SIMD_WIDTH particles from v ([n][3], with one readable number after the last vector).
   It loads four numbers for each vector and transposes the registers to x, y and z, in half the time of a gather.
   flat, here and below: in two dimensions; z is zero and costs nothing if the compiler knows 'flat'. */
#if SIMD_WIDTH == 8
/* a[0] to a[3], then b[0] to b[3] */
static inline Simd SimdOfTwo(const PetscReal a[], const PetscReal b[])
{
  return (Simd)_mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(a)), _mm256_loadu_pd(b), 1);
}

/* a[0], a[1], b[0], b[1], c[0] and so on */
static inline Simd SimdOfFour(const PetscReal a[], const PetscReal b[], const PetscReal c[], const PetscReal d[])
{
  const __m512d t = _mm512_insertf64x2(_mm512_castpd128_pd512(_mm_loadu_pd(a)), _mm_loadu_pd(b), 1);

  return (Simd)_mm512_insertf64x2(_mm512_insertf64x2(t, _mm_loadu_pd(c), 2), _mm_loadu_pd(d), 3);
}

static inline Simd3 Simd3CollectFlat(const PetscReal v[], const uint32_t at[])
{
  const Simd t0 = SimdOfFour(v + at[0], v + at[2], v + at[4], v + at[6]),
             t1 = SimdOfFour(v + at[1], v + at[3], v + at[5], v + at[7]);

  return (Simd3){__builtin_shufflevector(t0, t1, 0, 8, 2, 10, 4, 12, 6, 14),
                 __builtin_shufflevector(t0, t1, 1, 9, 3, 11, 5, 13, 7, 15), SimdSet(0)};
}

static inline Simd3 Simd3CollectAll(const PetscReal v[], const uint32_t at[])
{
  const Simd t0 = SimdOfTwo(v + at[0], v + at[4]), t1 = SimdOfTwo(v + at[1], v + at[5]),
             t2 = SimdOfTwo(v + at[2], v + at[6]), t3 = SimdOfTwo(v + at[3], v + at[7]);
  const Simd xz01 = __builtin_shufflevector(t0, t1, 0, 8, 2, 10, 4, 12, 6, 14),
             xz23 = __builtin_shufflevector(t2, t3, 0, 8, 2, 10, 4, 12, 6, 14);
  const Simd y01  = __builtin_shufflevector(t0, t1, 1, 9, 3, 11, 5, 13, 7, 15),
             y23  = __builtin_shufflevector(t2, t3, 1, 9, 3, 11, 5, 13, 7, 15);
  const Simd3 all = {__builtin_shufflevector(xz01, xz23, 0, 1, 8, 9, 4, 5, 12, 13),
                     __builtin_shufflevector(y01, y23, 0, 1, 8, 9, 4, 5, 12, 13),
                     __builtin_shufflevector(xz01, xz23, 2, 3, 10, 11, 6, 7, 14, 15)};
  return all;
}

static inline Simd3 Simd3Collect(PetscBool flat, const PetscReal v[], const SimdOffsets *offsets)
{
  return flat ? Simd3CollectFlat(v, offsets->at) : Simd3CollectAll(v, offsets->at);
}
#else
static inline Simd3 Simd3Collect(PetscBool flat, const PetscReal v[], const SimdOffsets *offsets)
{
  const uint32_t *at = offsets->at;
  const Vec4 t0 = Vec4Load(v + at[0]), t1 = Vec4Load(v + at[1]), t2 = Vec4Load(v + at[2]), t3 = Vec4Load(v + at[3]);
  const Vec4 xz01 = __builtin_shufflevector(t0, t1, 0, 4, 2, 6), xz23 = __builtin_shufflevector(t2, t3, 0, 4, 2, 6),
             y01 = __builtin_shufflevector(t0, t1, 1, 5, 3, 7), y23 = __builtin_shufflevector(t2, t3, 1, 5, 3, 7);
  const Simd3 all = {__builtin_shufflevector(xz01, xz23, 0, 1, 4, 5), __builtin_shufflevector(y01, y23, 0, 1, 4, 5),
                     flat ? SimdSet(0) : __builtin_shufflevector(xz01, xz23, 2, 3, 6, 7)};
  return all;
}
#endif

/* Simd3Difference - a - b. */
static inline Simd3 Simd3Difference(PetscBool flat, Simd3 a, Simd3 b)
{
  return (Simd3){a.x - b.x, a.y - b.y, flat ? SimdSet(0) : a.z - b.z};
}

/* Simd3Add - adds f v to sum. */
static inline void Simd3Add(PetscBool flat, Simd3 *sum, Simd f, Simd3 v)
{
  sum->x += f * v.x;
  sum->y += f * v.y;
  if (!flat) sum->z += f * v.z;
}

/* Simd3Dot - the products a.b. */
static inline Simd Simd3Dot(PetscBool flat, Simd3 a, Simd3 b)
{
  const Simd sum = a.x * b.x + a.y * b.y;

  return flat ? sum : sum + a.z * b.z;
}

/* SimdMax - the larger of a and b. */
static inline Simd SimdMax(Simd a, Simd b)
{
  const SimdMask larger = a > b;

  return (Simd)((larger & (SimdMask)a) | (~larger & (SimdMask)b));
}

/* SimdAbs - |a|. */
static inline Simd SimdAbs(Simd a)
{
  return SimdMax(a, -a);
}

/* SimdFold - the first four numbers plus the last four; t itself if SIMD_WIDTH is four. */
static inline Vec4 SimdFold(Simd t)
{
#if SIMD_WIDTH == 8
  return __builtin_shufflevector(t, t, 0, 1, 2, 3) + __builtin_shufflevector(t, t, 4, 5, 6, 7);
#else
  return t;
#endif
}

/* SimdSums - four sums over the lanes: of a, of b, of c and of d. */
static inline Vec4 SimdSums(Simd a, Simd b, Simd c, Simd d)
{
  const Vec4 ha = SimdFold(a), hb = SimdFold(b), hc = SimdFold(c), hd = SimdFold(d);
  const Vec4 ab = __builtin_shufflevector(ha, hb, 0, 4, 2, 6) + __builtin_shufflevector(ha, hb, 1, 5, 3, 7),
             cd = __builtin_shufflevector(hc, hd, 0, 4, 2, 6) + __builtin_shufflevector(hc, hd, 1, 5, 3, 7);

  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

/* SimdSum - the sum over the lanes of t, as SimdSums has it. */
static inline PetscReal SimdSum(Simd t)
{
  const Vec4 h = SimdFold(t);

  return (h[0] + h[1]) + (h[2] + h[3]);
}

/* Simd3Sum - the sum of the vectors v; the fourth number is the sum of 'fourth'. */
static inline Vec4 Simd3Sum(Simd3 v, Simd fourth)
{
  return SimdSums(v.x, v.y, v.z, fourth);
}

/* PaddedLength - n rounded up to a multiple of SIMD_WIDTH. */
static inline PetscInt PaddedLength(PetscInt n)
{
  return (n + SIMD_WIDTH - 1) / SIMD_WIDTH * SIMD_WIDTH;
}

/* WIDE numbers in single precision or integers, as many as a register of the processor holds, at least four. A WideMask
   selects some of the lanes; & combines masks. */
#if defined(__AVX512F__)
  #define WIDE 16
#elif defined(__AVX2__)
  #define WIDE 8
#else
  #define WIDE 4
#endif
typedef float   Wide __attribute__((vector_size(WIDE * sizeof(float))));
typedef int32_t WideInteger __attribute__((vector_size(WIDE * sizeof(int32_t))));

/* wide_front - for each pattern of eight bits the indices of the bits that are set, a byte each. WideStart fills the
   table; call it before the functions below. */
extern uint64_t wide_front[1 << 8];
void            WideStart(void);

/* WideLoad - x[0] to x[WIDE - 1]. WideSet - WIDE times s. */
static inline Wide WideLoad(const float x[])
{
  Wide t;

  (void)memcpy(&t, x, sizeof(t));
  return t;
}

static inline Wide WideSet(float s)
{
  return s - (Wide){0};
}

/* WideApart - p - x modulo 2^32 in single precision, for x[0] to x[WIDE - 1]. Integer positions have units so small
   that the box exceeds 32 bits; a difference of neighbours fits. */
static inline Wide WideApart(int32_t p, const int32_t x[])
{
  typedef uint32_t Wrapping __attribute__((vector_size(WIDE * sizeof(uint32_t))));
  Wrapping         t;

  (void)memcpy(&t, x, sizeof(t));
  return __builtin_convertvector((WideInteger)((uint32_t)p - t), Wide);
}

/* WideCounting - first, first + 1, ... */
static inline WideInteger WideCounting(int32_t first)
{
#if WIDE == 16
  return first + (WideInteger){0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
#elif WIDE == 8
  return first + (WideInteger){0, 1, 2, 3, 4, 5, 6, 7};
#else
  return first + (WideInteger){0, 1, 2, 3};
#endif
}

/* WideBelow - selects the lanes where s is below the limit, WideOther those where b differs from a. WideKeep - keeps
   the selected lanes among the first n. WideCount - the number of lanes kept. WidePack - writes these lanes of x to the
   front of 'to'; it may overwrite all WIDE elements. WidePackIntegers - WidePack for integers. */
#if defined(__AVX512F__)
typedef __mmask16 WideMask, WideKept;

static inline WideMask WideBelow(Wide s, Wide limit)
{
  return _mm512_cmp_ps_mask((__m512)s, (__m512)limit, _CMP_LT_OQ);
}

static inline WideMask WideOther(WideInteger b, int32_t a)
{
  return _mm512_cmpneq_epi32_mask((__m512i)b, _mm512_set1_epi32(a));
}

static inline WideKept WideKeep(WideMask mask, PetscInt n)
{
  return mask & (WideMask)((1u << PetscMin(n, WIDE)) - 1);
}

static inline PetscInt WideCount(WideKept kept)
{
  return __builtin_popcount(kept);
}

static inline void WidePack(WideKept kept, Wide x, float to[])
{
  _mm512_storeu_ps(to, _mm512_maskz_compress_ps(kept, (__m512)x));
}

static inline void WidePackIntegers(WideKept kept, WideInteger x, int32_t to[])
{
  _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(kept, (__m512i)x));
}
#else
typedef WideInteger WideMask; /* all bits of a selected lane are set */

static inline WideMask WideBelow(Wide s, Wide limit)
{
  return s < limit;
}

static inline WideMask WideOther(WideInteger b, int32_t a)
{
  return b != a;
}

  #if defined(__AVX2__)
typedef struct {
  __m256i front; /* the permutation that moves the kept lanes to the front */
  PetscInt count;
} WideKept;

static inline WideKept WideKeep(WideMask mask, PetscInt n)
{
  const int bits = _mm256_movemask_ps((__m256)mask) & ((1 << PetscMin(n, WIDE)) - 1);
  const WideKept kept = {_mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(wide_front + bits))),
                         __builtin_popcount((unsigned)bits)};

  return kept;
}

static inline PetscInt WideCount(WideKept kept)
{
  return kept.count;
}

static inline void WidePack(WideKept kept, Wide x, float to[])
{
  _mm256_storeu_ps(to, _mm256_permutevar8x32_ps((__m256)x, kept.front));
}

static inline void WidePackIntegers(WideKept kept, WideInteger x, int32_t to[])
{
  _mm256_storeu_si256((__m256i *)to, _mm256_permutevar8x32_epi32((__m256i)x, kept.front));
}
  #else
typedef struct {
  PetscInt
    to[WIDE + 1]; /* the place of each lane, of which the next lane overwrites one that is not kept; their number */
} WideKept;

static inline WideKept WideKeep(WideMask mask, PetscInt n)
{
  WideKept kept = {{0}};

  mask &= WideCounting(0) < (int32_t)n;
  for (PetscInt k = 0; k < WIDE; k++) kept.to[k + 1] = kept.to[k] - mask[k];
  return kept;
}

static inline PetscInt WideCount(WideKept kept)
{
  return kept.to[WIDE];
}

static inline void WidePack(WideKept kept, Wide x, float to[])
{
  for (PetscInt k = 0; k < WIDE; k++) to[kept.to[k]] = x[k];
}

static inline void WidePackIntegers(WideKept kept, WideInteger x, int32_t to[])
{
  for (PetscInt k = 0; k < WIDE; k++) to[kept.to[k]] = x[k];
}
  #endif
#endif

#endif
