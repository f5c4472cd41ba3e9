/* Eight numbers, or eight vectors, at a time: what the pair loops that cost most are written with. The vector types are
   those of GCC and clang, so the code compiles for any processor; the two or three operations that these compilers do
   badly have a second form in AVX-512 intrinsics. */
#ifndef ISPH_VEC8_H
#define ISPH_VEC8_H

#if defined(__AVX512F__)
  #include <immintrin.h>
#endif
#include "base.h"

typedef PetscReal Vec4 __attribute__((vector_size(4 * sizeof(PetscReal))));

/* Vec4Load - x[0] to x[3]; the last of these must exist, also where only three are meant. */
static inline Vec4 Vec4Load(const PetscReal x[])
{
  Vec4 t;

  (void)memcpy(&t, x, sizeof(t));
  return t;
}

/* Vec4Store - stores the first three of the four numbers. */
static inline void Vec4Store(Vec4 t, PetscReal x[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) x[d] = t[d];
}

#define VEC8 8

typedef PetscReal Vec8 __attribute__((vector_size(VEC8 * sizeof(PetscReal))));
typedef int64_t   Vec8Mask __attribute__((vector_size(VEC8 * sizeof(int64_t))));
typedef float     Vec8Single __attribute__((vector_size(VEC8 * sizeof(float))));

/* Eight vectors of three numbers. */
typedef struct {
  Vec8 x, y, z;
} Vec8x3;

/* Vec8Set - eight times s. */
static inline Vec8 Vec8Set(PetscReal s)
{
  return (Vec8){s, s, s, s, s, s, s, s};
}

/* Vec8Load - x[0] to x[7]. */
static inline Vec8 Vec8Load(const PetscReal x[])
{
  Vec8 t;

  (void)memcpy(&t, x, sizeof(t));
  return t;
}

/* Vec8LoadSingle - the same from an array in single precision. */
static inline Vec8 Vec8LoadSingle(const float x[])
{
#if defined(__AVX512F__)
  return (Vec8)_mm512_cvtps_pd(_mm256_loadu_ps(x));
#else
  Vec8Single t;

  (void)memcpy(&t, x, sizeof(t));
  return __builtin_convertvector(t, Vec8);
#endif
}

/* Vec8Gather - p[b[0]] to p[b[7]]. They are loaded one by one, which is faster than the processor's gather instruction.
 */
static inline Vec8 Vec8Gather(const PetscReal p[], const PetscInt b[VEC8])
{
  return (Vec8){p[b[0]], p[b[1]], p[b[2]], p[b[3]], p[b[4]], p[b[5]], p[b[6]], p[b[7]]};
}

/* Vec8First - the first n of the eight numbers of t, and zeros in place of the others. */
static inline Vec8 Vec8First(Vec8 t, PetscInt n)
{
  const Vec8Mask place = {0, 1, 2, 3, 4, 5, 6, 7};

  return (Vec8)((Vec8Mask)t & (place < n));
}

/* Vec8x3Set - eight times the vector v. */
static inline Vec8x3 Vec8x3Set(const PetscReal v[DIM])
{
  return (Vec8x3){Vec8Set(v[0]), Vec8Set(v[1]), Vec8Set(v[2])};
}

/* Vec8OfTwo - a[0] to a[3], then b[0] to b[3]. */
static inline Vec8 Vec8OfTwo(const PetscReal a[], const PetscReal b[])
{
#if defined(__AVX512F__)
  return (Vec8)_mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(a)), _mm256_loadu_pd(b), 1);
#else
  return __builtin_shufflevector(Vec4Load(a), Vec4Load(b), 0, 1, 2, 3, 4, 5, 6, 7);
#endif
}

/* Where the vectors of eight particles begin in an array [n][3]. */
typedef struct {
  uint32_t at[VEC8];
} Vec8Offsets;

/* Vec8Locate - the places of particles b[0] to b[7]; one set of places serves several arrays. */
static inline Vec8Offsets Vec8Locate(const PetscInt b[VEC8])
{
  Vec8Offsets p;

  for (PetscInt k = 0; k < VEC8; k++) p.at[k] = DIM * (uint32_t)b[k];
  return p;
}

/* Vec8x3Collect - the vectors of eight particles from v ([n][3], with room for one number behind the last vector). Each
   vector is loaded as a register of four numbers, the fourth without meaning, and eight of these are transposed to
   eight x, eight y and eight z: this takes half the time of gathering them. */
static inline Vec8x3 Vec8x3Collect(const PetscReal v[], const Vec8Offsets *places)
{
  const uint32_t *at = places->at;
  const Vec8      t0 = Vec8OfTwo(v + at[0], v + at[4]), t1 = Vec8OfTwo(v + at[1], v + at[5]),
             t2 = Vec8OfTwo(v + at[2], v + at[6]), t3 = Vec8OfTwo(v + at[3], v + at[7]);
  const Vec8 xz01  = __builtin_shufflevector(t0, t1, 0, 8, 2, 10, 4, 12, 6, 14),
             xz23  = __builtin_shufflevector(t2, t3, 0, 8, 2, 10, 4, 12, 6, 14);
  const Vec8 y01   = __builtin_shufflevector(t0, t1, 1, 9, 3, 11, 5, 13, 7, 15),
             y23   = __builtin_shufflevector(t2, t3, 1, 9, 3, 11, 5, 13, 7, 15);
  const Vec8x3 all = {__builtin_shufflevector(xz01, xz23, 0, 1, 8, 9, 4, 5, 12, 13),
                      __builtin_shufflevector(y01, y23, 0, 1, 8, 9, 4, 5, 12, 13),
                      __builtin_shufflevector(xz01, xz23, 2, 3, 10, 11, 6, 7, 14, 15)};
  return all;
}

/* Vec8x3Difference - a - b. */
static inline Vec8x3 Vec8x3Difference(Vec8x3 a, Vec8x3 b)
{
  return (Vec8x3){a.x - b.x, a.y - b.y, a.z - b.z};
}

/* Vec8x3Add - adds f v to sum. */
static inline void Vec8x3Add(Vec8x3 *sum, Vec8 f, Vec8x3 v)
{
  sum->x += f * v.x;
  sum->y += f * v.y;
  sum->z += f * v.z;
}

/* Vec8x3Dot - the eight products a.b. */
static inline Vec8 Vec8x3Dot(Vec8x3 a, Vec8x3 b)
{
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* Vec8Max - the larger of a and b, eight times. */
static inline Vec8 Vec8Max(Vec8 a, Vec8 b)
{
  const Vec8Mask larger = a > b;

  return (Vec8)((larger & (Vec8Mask)a) | (~larger & (Vec8Mask)b));
}

/* Vec8Halves - the sum of the first four and the last four numbers. */
static inline Vec4 Vec8Halves(Vec8 t)
{
  return __builtin_shufflevector(t, t, 0, 1, 2, 3) + __builtin_shufflevector(t, t, 4, 5, 6, 7);
}

/* Vec8Sums - the sum over the eight numbers of a, of b, of c and of d. */
static inline Vec4 Vec8Sums(Vec8 a, Vec8 b, Vec8 c, Vec8 d)
{
  const Vec4 ha = Vec8Halves(a), hb = Vec8Halves(b), hc = Vec8Halves(c), hd = Vec8Halves(d);
  const Vec4 ab = __builtin_shufflevector(ha, hb, 0, 4, 2, 6) + __builtin_shufflevector(ha, hb, 1, 5, 3, 7),
             cd = __builtin_shufflevector(hc, hd, 0, 4, 2, 6) + __builtin_shufflevector(hc, hd, 1, 5, 3, 7);

  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

/* Vec8x3Sum - the sum over the eight vectors of v and, as the fourth number, that over 'fourth'. */
static inline Vec4 Vec8x3Sum(Vec8x3 v, Vec8 fourth)
{
  return Vec8Sums(v.x, v.y, v.z, fourth);
}

/* PaddedLength - n rounded up to a multiple of eight. */
static inline PetscInt PaddedLength(PetscInt n)
{
  return (n + VEC8 - 1) / VEC8 * VEC8;
}

#endif
