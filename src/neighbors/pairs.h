/* Pair loops: how an operator visits the neighbours of a particle.

   A loop over the owned particles loads one row at a time, the neighbours of particle a, into a PairRow. There are two
   loaders, for the same neighbours in the same order:

   PairRowLoadGeometry   distances in double from any positions, for instance those after the particles have moved; the
                         kernel is then evaluated where it is needed, by KernelEvaluate (double precision) or
                         KernelGradient (single precision). This is the form to begin with.
   PairRowLoadFactors    the factors f of grad W that the last search found, at the positions of that search only:
                         grad_a W_ab = scale_f f r_ab with scale_f of KernelScales. Nothing is evaluated, and the row is
                         padded to a multiple of SIMD_WIDTH for the vector types of base/simd.h. This is the form for
   loops that a profile of the step shows.

   How to write a pair loop, here sum_b V_b W_ab:

     PairRow row;

     for (PetscInt a = 0; a < cloud->n_fluid; a++) {
       PetscReal sum = 0;

       PairRowLoadGeometry(cloud, cloud->field[FIELD_POSITION], a, &row);
       PairRowEvaluate(cloud, a, &row);
       for (PetscInt k = 0; k < row.n; k++) sum += cloud->weight[row.index[k]] * cloud->domain->volume * row.W[k];
     }

   SIMD_LOOP(reduction(+ : sum)) above the inner loop makes it a vector loop. The row excludes particle a itself. A
   PairRow takes 120 kB: one a function, on the stack. */
#ifndef ISPH_PAIRS_H
#define ISPH_PAIRS_H

#include "../base/simd.h"
#include "cloud.h"

#define ROW_CAPACITY 2120 /* not a multiple of 512, so that the arrays of a row do not share cache sets */

/* The n neighbours b = index[k] of a particle a, as local indices. */
typedef struct {
  PetscInt        n;
  const PetscInt *index;
  /* PairRowLoadGeometry: r_ab = r_a - r_b (m) and its square (m2). */
  PetscReal dx[ROW_CAPACITY], dy[ROW_CAPACITY], dz[ROW_CAPACITY], r2[ROW_CAPACITY];
  /* Room for KernelEvaluate's or KernelGradient's values: W (m^-dim) and F = W'/r (m^-dim-2). */
  PetscReal W[ROW_CAPACITY], F[ROW_CAPACITY];
  /* PairRowLoadFactors: F over scale_f, zero for the pairs of the padding. */
  PetscReal f[ROW_CAPACITY + SIMD_WIDTH];
} PairRow;

/* CloudListRoom - the number of pairs for which CloudSearch makes room when 'used' are stored and 'rows' rows of at
   most 'most' pairs follow. Not collective. */
PetscInt64 CloudListRoom(PetscInt64 used, PetscInt rows, PetscInt most);

/* PairRowLoadGeometry - fills n, index, dx, dy, dz and r2 of particle a's row from positions x ([n_total][3], m). Not
   collective. */
static inline void PairRowLoadGeometry(Cloud cloud, const PetscReal *restrict x, PetscInt a, PairRow *restrict row)
{
  const PetscInt *restrict index = cloud->list + cloud->first[a];
  const PetscReal xa = x[3 * a], ya = x[3 * a + 1], za = x[3 * a + 2];

  row->n     = (PetscInt)(cloud->first[a + 1] - cloud->first[a]);
  row->index = index;
  SIMD_LOOP()
  for (PetscInt k = 0; k < row->n; k++) {
    const PetscReal dx = xa - x[3 * index[k]], dy = ya - x[3 * index[k] + 1], dz = za - x[3 * index[k] + 2];

    row->dx[k] = dx;
    row->dy[k] = dy;
    row->dz[k] = dz;
    row->r2[k] = dx * dx + dy * dy + dz * dz;
  }
}

/* PairRowEvaluate, PairRowGradient - evaluate W, or F, of particle a's row after PairRowLoadGeometry, with the pairs'
   own smoothing lengths. Not collective. */
void PairRowEvaluate(Cloud cloud, PetscInt a, PairRow *row);
void PairRowGradient(Cloud cloud, PetscInt a, PairRow *row);

/* PairsPrefetch - prefetches the n entries of an array stored like the list that a loop over all rows needs about
   fourteen rows later. The arrays are larger than the caches, and processors do not prefetch far enough by themselves:
   without this the solver's product takes a fifth longer, other loops a twentieth. */
#define PREFETCH_DISTANCE 1024 /* entries */
#define CACHE_LINE        64   /* bytes */
#define PairsPrefetch(array, n)                                                                                        \
  do {                                                                                                                 \
    const char *ahead = (const char *)((array) + PREFETCH_DISTANCE), *end = ahead + (n) * sizeof(*(array));            \
                                                                                                                       \
    for (; ahead < end; ahead += CACHE_LINE) __builtin_prefetch(ahead);                                                \
  } while (0)

/* PairRowLoadFactors - fills n, index and f of particle a's row from the last search. index may be read up to the next
   multiple of SIMD_WIDTH: the entries there are valid indices of particles, also behind the last row, and the factors
   of these pairs are zero. Not collective. */
static inline void PairRowLoadFactors(Cloud cloud, PetscInt a, PairRow *row)
{
  const PetscInt64 first     = cloud->first[a];
  const PetscInt   n         = (PetscInt)(cloud->first[a + 1] - first);
  const float *restrict from = cloud->slope + first;

  row->n     = n;
  row->index = cloud->list + first;
  PairsPrefetch(row->index, n);
  PairsPrefetch(from, n);
  for (PetscInt k = 0; k < n; k += SIMD_WIDTH) {
    const Simd f = SimdLoadSingle(from + k);

    (void)memcpy(row->f + k, &f, sizeof(f));
  }
  for (PetscInt k = n; k < n + SIMD_WIDTH; k++) row->f[k] = 0;
}

#endif
