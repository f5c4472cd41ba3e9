/* Rows of pairs for the loops that matter. A vector of a neighbour is loaded as one register of four numbers, the
   fourth without meaning, and the sums over a row are such registers too: no gathering, no remainder, no sum across
   lanes. The vectors are those of GCC and clang, for any processor. */
#ifndef ISPH_ROWS_H
#define ISPH_ROWS_H

#include "cloud.h" /* which includes this file at its end */

typedef PetscReal Triple __attribute__((vector_size(4 * sizeof(PetscReal))));

/* TripleLoad - x[0] to x[2], and x[3], which must exist: arrays of the cloud have room behind the last particle. */
static inline Triple TripleLoad(const PetscReal x[])
{
  Triple t;

  (void)memcpy(&t, x, sizeof(t));
  return t;
}

static inline Triple TripleSet(PetscReal s)
{
  return (Triple){s, s, s, s};
}

static inline void TripleStore(Triple t, PetscReal x[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) x[d] = t[d];
}

/* TripleTurn - y, z, x. */
static inline Triple TripleTurn(Triple t)
{
  return __builtin_shufflevector(t, t, 1, 2, 0, 3);
}

/* TripleDot - a.b, three times. */
static inline Triple TripleDot(Triple a, Triple b)
{
  const Triple t = a * b, turned = TripleTurn(t);

  return t + turned + TripleTurn(turned);
}

/* The pairs of one particle. */
typedef struct {
  PetscInt        n;
  const PetscInt *index;
  PetscReal       f[ROW_CAPACITY]; /* factor of the pair: F = KernelScales' scale_f times it */
} Row;

/* RowLoad - the pairs of a as the last search found them. Not collective. */
static inline void RowLoad(Cloud cloud, PetscInt a, Row *row)
{
  const PetscInt first = cloud->first[a], n = cloud->first[a + 1] - first;
  const float *restrict from = cloud->slope + first;

  row->n     = n;
  row->index = cloud->list + first;
  SIMD_LOOP()
  for (PetscInt k = 0; k < n; k++) row->f[k] = from[k];
}

#endif
