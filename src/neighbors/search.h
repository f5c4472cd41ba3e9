/* Private to neighbors/: what the searches of particles of one size and of graded ones share. */
#ifndef ISPH_SEARCH_H
#define ISPH_SEARCH_H

#include "pairs.h"

#define LANES   SEARCH_LANES /* candidates compared at once */
#define PADDING 1e4f         /* squared distance over h2, beyond any kernel */

/* Positions are compared as integers, sixteen at a time. Their unit is the same on every rank, and the box is 2^n units
   long, n = BOX_BITS unless the box is narrow. Differences are therefore exact, and the same for both particles of a
   pair, also across a periodic face or a mirror. The unit is a billionth of the box, so a position is as exact as the
   single precision of the pair factors. */
typedef struct {
  PetscReal center[DIM], inverse[DIM]; /* m; 1/m */
  float     unit[DIM];                 /* over h */
} Units;

/* SearchUnits - the units of a cloud. Not collective. */
Units                   SearchUnits(Cloud cloud);
static inline PetscReal Place(const Units *units, PetscInt d, PetscReal x)
{
  return rint((x - units->center[d]) * units->inverse[d]);
}

/* Apart - p - x. Lanes behind the candidates may hold points so far away that it wraps around; nothing comes of them.
 */
static inline int32_t Apart(int32_t p, int32_t x)
{
  return (int32_t)((uint32_t)p - (uint32_t)x);
}

/* ReserveList - makes room for so many pairs. Not collective. */
PetscErrorCode ReserveList(Cloud cloud, PetscInt64 pairs);
/* DropWallPairs - removes the Laplacian weights of the pairs of a wall particle with other wall particles, between
   which nothing flows. Returns the sum of the other weights. Not collective. */
PetscInt DropWallPairs(const PetscInt layer[], PetscInt n, const PetscInt list[], uint16_t laplacian[]);
/* SearchGraded - CloudSearch of particles of different sizes. Not collective. */
PetscErrorCode SearchGraded(Cloud cloud, RowVisitor visit, void *context);

/* Pads a row with pairs of the particle with itself that weigh nothing, so that what follows works on whole vectors.
   The next row overwrites them. */
static inline void PadRow(PetscInt a, PetscInt n, PetscInt list[], float s[])
{
  for (PetscInt k = n; k < n + LANES; k++) {
    list[k] = a;
    s[k]    = PADDING;
  }
}

#endif
