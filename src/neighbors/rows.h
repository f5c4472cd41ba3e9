/* Rows of pairs for the loops that matter: eight pairs at a time. A vector of a neighbour is loaded as one register of
   four numbers, the fourth without meaning; eight of them are turned into eight x, eight y, eight z, in half the time
   of gathering these. A row's last octet goes on into the next row, that of the last into padding; what is too much
   weighs nothing. The vectors are those of GCC and clang, for any processor. */
#ifndef ISPH_ROWS_H
#define ISPH_ROWS_H

#if defined(__AVX512F__)
  #include <immintrin.h>
#endif
#include "cloud.h" /* which includes this file at its end */

typedef PetscReal Triple __attribute__((vector_size(4 * sizeof(PetscReal))));

/* TripleLoad - x[0] to x[2], and x[3], which must exist: arrays of the cloud have room behind the last particle. */
static inline Triple TripleLoad(const PetscReal x[])
{
  Triple t;

  (void)memcpy(&t, x, sizeof(t));
  return t;
}

static inline void TripleStore(Triple t, PetscReal x[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) x[d] = t[d];
}

#define OCTET 8

typedef PetscReal Octet __attribute__((vector_size(OCTET * sizeof(PetscReal))));
typedef int64_t   OctetMask __attribute__((vector_size(OCTET * sizeof(int64_t))));
typedef float     OctetOfSingle __attribute__((vector_size(OCTET * sizeof(float))));

typedef struct {
  Octet x, y, z;
} Octets;

static inline Octet OctetSet(PetscReal s)
{
  return (Octet){s, s, s, s, s, s, s, s};
}

/* OctetLoad - x[0] to x[7]. */
static inline Octet OctetLoad(const PetscReal x[])
{
  Octet t;

  (void)memcpy(&t, x, sizeof(t));
  return t;
}

/* OctetLoadSingle - the same of single precision. */
static inline Octet OctetLoadSingle(const float x[])
{
#if defined(__AVX512F__)
  return (Octet)_mm512_cvtps_pd(_mm256_loadu_ps(x));
#else
  OctetOfSingle t;

  (void)memcpy(&t, x, sizeof(t));
  return __builtin_convertvector(t, Octet);
#endif
}

/* OctetGather - p[b] of eight particles b; one by one, which is faster than a processor's own gathering. */
static inline Octet OctetGather(const PetscReal p[], const PetscInt b[OCTET])
{
  return (Octet){p[b[0]], p[b[1]], p[b[2]], p[b[3]], p[b[4]], p[b[5]], p[b[6]], p[b[7]]};
}

/* OctetFirst - the first n of the eight, zero for the others. */
static inline Octet OctetFirst(Octet t, PetscInt n)
{
  const OctetMask place = {0, 1, 2, 3, 4, 5, 6, 7};

  return (Octet)((OctetMask)t & (place < n));
}

static inline Octets OctetsSet(const PetscReal v[DIM])
{
  return (Octets){OctetSet(v[0]), OctetSet(v[1]), OctetSet(v[2])};
}

/* OctetOfTwo - a[0] to a[3], b[0] to b[3]. */
static inline Octet OctetOfTwo(const PetscReal a[], const PetscReal b[])
{
#if defined(__AVX512F__)
  return (Octet)_mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(a)), _mm256_loadu_pd(b), 1);
#else
  return __builtin_shufflevector(TripleLoad(a), TripleLoad(b), 0, 1, 2, 3, 4, 5, 6, 7);
#endif
}

/* Where the vectors of eight particles begin. */
typedef struct {
  uint32_t at[OCTET];
} OctetPlaces;

static inline OctetPlaces OctetLocate(const PetscInt b[OCTET])
{
  OctetPlaces p;

  for (PetscInt k = 0; k < OCTET; k++) p.at[k] = DIM * (uint32_t)b[k];
  return p;
}

/* OctetsCollect - the vectors of eight particles from v ([n_total][3]). */
static inline Octets OctetsCollect(const PetscReal v[], const OctetPlaces *places)
{
  const uint32_t *at = places->at;
  const Octet     t0 = OctetOfTwo(v + at[0], v + at[4]), t1 = OctetOfTwo(v + at[1], v + at[5]),
              t2 = OctetOfTwo(v + at[2], v + at[6]), t3 = OctetOfTwo(v + at[3], v + at[7]);
  const Octet xz01 = __builtin_shufflevector(t0, t1, 0, 8, 2, 10, 4, 12, 6, 14),
              xz23 = __builtin_shufflevector(t2, t3, 0, 8, 2, 10, 4, 12, 6, 14);
  const Octet y01  = __builtin_shufflevector(t0, t1, 1, 9, 3, 11, 5, 13, 7, 15),
              y23  = __builtin_shufflevector(t2, t3, 1, 9, 3, 11, 5, 13, 7, 15);
  const Octets all = {__builtin_shufflevector(xz01, xz23, 0, 1, 8, 9, 4, 5, 12, 13),
                      __builtin_shufflevector(y01, y23, 0, 1, 8, 9, 4, 5, 12, 13),
                      __builtin_shufflevector(xz01, xz23, 2, 3, 10, 11, 6, 7, 14, 15)};
  return all;
}

/* OctetsDifference - a - b. */
static inline Octets OctetsDifference(Octets a, Octets b)
{
  return (Octets){a.x - b.x, a.y - b.y, a.z - b.z};
}

/* OctetsAdd - sum += f v. */
static inline void OctetsAdd(Octets *sum, Octet f, Octets v)
{
  sum->x += f * v.x;
  sum->y += f * v.y;
  sum->z += f * v.z;
}

static inline Octet OctetsDot(Octets a, Octets b)
{
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline Octet OctetMax(Octet a, Octet b)
{
  const OctetMask larger = a > b;

  return (Octet)((larger & (OctetMask)a) | (~larger & (OctetMask)b));
}

static inline Triple OctetHalves(Octet t)
{
  return __builtin_shufflevector(t, t, 0, 1, 2, 3) + __builtin_shufflevector(t, t, 4, 5, 6, 7);
}

/* OctetSums - the sums of the eight numbers of each. */
static inline Triple OctetSums(Octet a, Octet b, Octet c, Octet d)
{
  const Triple ha = OctetHalves(a), hb = OctetHalves(b), hc = OctetHalves(c), hd = OctetHalves(d);
  const Triple ab = __builtin_shufflevector(ha, hb, 0, 4, 2, 6) + __builtin_shufflevector(ha, hb, 1, 5, 3, 7),
               cd = __builtin_shufflevector(hc, hd, 0, 4, 2, 6) + __builtin_shufflevector(hc, hd, 1, 5, 3, 7);

  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

/* OctetsSum - those of three, and of a fourth. */
static inline Triple OctetsSum(Octets v, Octet fourth)
{
  return OctetSums(v.x, v.y, v.z, fourth);
}

/* PaddedLength - n rounded up to whole octets. */
static inline PetscInt PaddedLength(PetscInt n)
{
  return (n + OCTET - 1) / OCTET * OCTET;
}

/* The pairs of one particle. What the padded index names exists, and weighs nothing. */
typedef struct {
  PetscInt        n;
  const PetscInt *index;
  PetscReal       f[ROW_CAPACITY + OCTET]; /* factor of the pair: F = KernelScales' scale_f times it */
} Row;

/* RowLoad - the pairs of a as the last search found them. Not collective. */
static inline void RowLoad(Cloud cloud, PetscInt a, Row *row)
{
  const PetscInt first = cloud->first[a], n = cloud->first[a + 1] - first;
  const float *restrict from = cloud->slope + first;

  row->n     = n;
  row->index = cloud->list + first;
  PairsAhead(row->index, n);
  PairsAhead(from, n);
  for (PetscInt k = 0; k < n; k += OCTET) { /* the arrays have room behind the last row */
    const Octet f = OctetLoadSingle(from + k);

    (void)memcpy(row->f + k, &f, sizeof(f));
  }
  for (PetscInt k = n; k < n + OCTET; k++) row->f[k] = 0;
}

#endif
