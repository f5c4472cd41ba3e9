/* Rows of pairs for the loops that matter: the neighbours' values are gathered into short arrays, four numbers a
   neighbour, filled up to whole vectors with the particle itself (whose factor is zero); the loop over a row then has
   neither indirect addresses nor a remainder. */
#ifndef ISPH_ROWS_H
#define ISPH_ROWS_H

#include "cloud.h" /* which includes this file at its end */

#define ROW_LANES 8

typedef struct {
  PetscInt        n, m; /* neighbours; the same rounded up to ROW_LANES */
  const PetscInt *index;
  float           f[ROW_CAPACITY];     /* [m] factor of the pair: F = KernelScales' scale_f times it; 0 from n on */
  PetscReal       x[4 * ROW_CAPACITY]; /* [m][4] positions (m), and one number without meaning */
  PetscReal       v[4 * ROW_CAPACITY]; /* [m][4] whatever vector the loop wants */
} Row;

/* RowGather - vectors of a's neighbours, and behind them its own, from a field ([n_total][3], an array of the cloud:
   one number behind the last is read). Not collective. */
static inline void RowGather(const Row *row, PetscInt a, const PetscReal *restrict field, PetscReal *restrict to)
{
  const PetscInt n = row->n, m = row->m; /* copies: the compiler cannot know that 'to' is not where they are */
  const PetscInt *restrict index = row->index;

  for (PetscInt k = 0; k < n; k++) (void)memcpy(to + 4 * k, field + 3 * index[k], 4 * sizeof(PetscReal));
  for (PetscInt k = n; k < m; k++) (void)memcpy(to + 4 * k, field + 3 * a, 4 * sizeof(PetscReal));
}

/* RowLoad - factors and positions of a's row as the last search found them. Not collective. */
static inline void RowLoad(Cloud cloud, PetscInt a, Row *row)
{
  const PetscInt first = cloud->first[a];

  row->n     = cloud->first[a + 1] - first;
  row->m     = (row->n + ROW_LANES - 1) / ROW_LANES * ROW_LANES;
  row->index = cloud->list + first;
  (void)memcpy(row->f, cloud->slope + first, (size_t)row->n * sizeof(float));
  for (PetscInt k = row->n; k < row->m; k++) row->f[k] = 0;
  RowGather(row, a, cloud->field[FIELD_POSITION], row->x);
}

/* The number of lanes of a row, in a form that tells the compiler that no remainder follows. */
static inline PetscInt RowLanes(const Row *row)
{
  return row->m & ~(ROW_LANES - 1);
}

#endif
