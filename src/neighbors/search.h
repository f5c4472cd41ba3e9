/* Private to neighbors/: the search of the neighbours. */
#ifndef ISPH_SEARCH_H
#define ISPH_SEARCH_H

#include "../base/simd.h"
#include "pairs.h"

#define LANES   SEARCH_LANES /* candidates compared at once */
#define PADDING 1e4f         /* squared distance over h2, beyond any kernel */

/* Positions are compared as integers, many at a time. Their unit is the same on every rank, and the box is 2^n units
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

/* A run of up to LANES candidates in one integer: where it starts in the grid's order in the lower half, its count in
   the upper half, to halve the memory traffic. A larger count stands for more runs behind this one. */
typedef int64_t Run;

#define RUN(begin, count) ((begin) + (int64_t)(count) * (UINT32_MAX + 1LL))
#define RUN_BEGIN(run)    ((PetscInt)((run)&UINT32_MAX))
#define RUN_COUNT(run)    (PetscMin((PetscInt)((run) >> 32), LANES))

/* The lines of cells along x around a cell, up to 'reach' cells away in y and z: LINES(reach) of them, and more outside
   to fill up the lanes. Their offsets in y and z, the offset of their cells' numbers, and, for a point at 0 to 1 of its
   own cell, how far it is from the line along each axis: from + times point, in cells. */
#define SPLIT            4     /* cells along x in the length of a cell along y and z */
#define SLACK            1e-3f /* of a cell along x: what single precision may miss of a chord */
#define LINES(reach)     ((2 * (reach) + 1) * (2 * (reach) + 1))
#define LINES_MOST_REACH 3
#define LINES_MOST       64 /* LINES of that, in whole vectors */

typedef struct {
  PetscInt y[LINES_MOST], z[LINES_MOST], cells[LINES_MOST];
  float    from_y[LINES_MOST], times_y[LINES_MOST], from_z[LINES_MOST], times_z[LINES_MOST];
} Lines;

/* LinesSet - the lines of a grid. LinesCandidates - how many candidates FindRuns may find, of cells with at most
   'longest' points. Not collective. */
void     LinesSet(const CellGrid *grid, PetscInt reach, Lines *lines);
PetscInt LinesCandidates(PetscInt reach, PetscInt longest);

/* FindRuns - the candidates for neighbours of a point at x (m): of each line of cells around it, the cells that the
   sphere of the radius (m) reaches. The radius is at most 'reach' cells in y and z, for which the lines are.
   outside: the point may be anywhere, otherwise it is in the grid. Returns the number of runs. There are no
   data-dependent branches, but for long runs. Not collective. */
static inline PetscInt FindRuns(const CellGrid *grid, const Lines *lines, PetscInt reach, PetscBool outside,
                                const PetscReal x[DIM], PetscReal radius, Run run[])
{
  const PetscInt *start = grid->start, nx = grid->n[0], ny = grid->n[1], nz = grid->n[2];
  const PetscReal inverse = 1 / grid->size, ry = inverse * (x[1] - grid->lower[1]),
                  rz = inverse * (x[2] - grid->lower[2]);
  const PetscInt cy = PetscMin((PetscInt)ry, ny - 1), cz = PetscMin((PetscInt)rz, nz - 1);
  const float    reach2 = (float)PetscSqr(radius * inverse), px = (float)(SPLIT * inverse * (x[0] - grid->lower[0])),
              py = (float)(ry - (PetscReal)cy), pz = (float)(rz - (PetscReal)cz);
  const PetscInt line = (cz * ny + cy) * nx;
  PetscInt       from[LINES_MOST], to[LINES_MOST], runs = 0;

  SIMD_LOOP()
  for (PetscInt l = 0; l < (LINES(reach) + LANES - 1) / LANES * LANES; l++) {
    const float    dy = lines->from_y[l] + lines->times_y[l] * py, dz = lines->from_z[l] + lines->times_z[l] * pz;
    const float    left2 = reach2 - dy * dy - dz * dz, half = SPLIT * sqrtf(left2 > 0 ? left2 : 0) + SLACK;
    const PetscInt iy = cy + lines->y[l], iz = cz + lines->z[l];
    const float    low = px - half, high = px + half;
    const PetscInt inside = (!outside) | ((high >= 0) & (low < (float)nx));
    const PetscInt there  = (iy >= 0) & (iy < ny) & (iz >= 0) & (iz < nz) & (left2 > -SLACK) & inside;
    const PetscInt x0 = (PetscInt)(low > 0 ? low : 0), last = (PetscInt)high, x1 = last < nx ? last : nx - 1;

    from[l] = there ? line + lines->cells[l] + x0 : 0;
    to[l]   = there ? line + lines->cells[l] + x1 + 1 : 0;
  }
  for (PetscInt l = 0; l < LINES(reach); l++) {
    const PetscInt begin = start[from[l]];
    Run            next  = RUN(begin, start[to[l]] - begin);

    while (next >= RUN(0, 3 * LANES)) { /* this is rare */
      run[runs++] = next;
      next += RUN(LANES, -LANES);
    }
    for (PetscInt k = 0; k < 3; k++) {
      run[runs] = next;
      runs += next >= RUN(0, 1);
      next += RUN(LANES, -LANES);
    }
  }
  return runs;
}

/* ReserveList - makes room for so many pairs. Not collective. */
PetscErrorCode ReserveList(Cloud cloud, PetscInt64 pairs);
/* DropWallPairs - removes the Laplacian weights of the pairs of a wall particle with other wall particles, between
   which nothing flows. Returns the sum of the other weights. Not collective. */
PetscInt DropWallPairs(const PetscInt layer[], PetscInt n, const PetscInt list[], uint16_t laplacian[]);
/* FindWeights - the cloud's weight, length and share, ghosts too. WeightRow - multiplies the factors of a row, where
   they stand for a neighbour of full share, by its share. Not collective.
 */
void FindWeights(Cloud cloud);
void WeightRow(Cloud cloud, PetscInt n, const PetscInt list[], float w[], float slope_over_r2[], float slope[]);
/* Cells of a level's grid, SPLIT along x in one, and some more layers of them all around: the largest sizes of the
   particles that may be in pairs with one in the cell; 0: there are none. */
typedef struct {
  CellBox box;
  /* [box.count] for a particle of the grid's level, those of this level and coarser ones; for a particle of a coarser
     level, those of the grid's level */
  PetscReal *coarse[SEARCH_LEVELS], *fine[SEARCH_LEVELS];
} Blocks;

/* The particles of a level in the order of its grid, with room for LANES more, which are read and not used. */
typedef struct {
  PetscInt  n;
  int32_t  *place; /* [3][n] integer positions */
  float    *size;  /* [n] of graded particles */
  PetscInt *index; /* [n] local indices */
} Candidates;

/* The particles of a level of sizes, ghosts too. Those of one size have one level, without what only graded ones need.
 */
typedef struct {
  PetscReal       largest; /* size, 1 */
  PetscInt       *point;   /* [n] local indices, of graded particles, and ... */
  PetscReal      *x;       /* [n][3] ... their positions, m */
  const CellGrid *grid;
  Lines           lines[LINES_MOST_REACH];
  Blocks          blocks;
  Candidates      all;
} Level;

typedef struct {
  Units     units;
  PetscReal support;     /* of the kernel, m */
  float     limit, unit; /* support2/h2; of the Laplacian factors */
  Level     level[SEARCH_LEVELS];
  Run      *run; /* of one row */
  /* Of one row: r2/h2, then over h_ab2; sizes of the neighbours; h over h_ab. */
  float s[ROW_CAPACITY + LANES], size[ROW_CAPACITY + LANES], ratio[ROW_CAPACITY + LANES];
} Search;

/* SearchCreate - sorts the particles at the positions of the cloud; search is zeroed. Not collective. */
PetscErrorCode SearchCreate(Cloud cloud, Search *search);
PetscErrorCode SearchDestroy(Cloud cloud, Search *search);
/* SearchLevel - the level of particle a. SearchLevelRuns - the candidates of level l for particle a, of level 'own':
   those near enough for a pair with the largest of them. The block is that of the finer one of both levels. Writes to
   search->run; returns their number. Not collective. */
static inline PetscInt SearchLevel(Cloud cloud, PetscInt a)
{
  return (CloudLevel(cloud, a) + 1) / 2;
}
PetscInt SearchLevelRuns(Cloud cloud, const Search *search, PetscInt a, PetscInt own, PetscInt l, PetscInt block);

/* Pads a row with pairs of the particle with itself that weigh nothing, so that what follows works on whole vectors.
   The next row overwrites them. */
static inline void PadRow(PetscInt a, PetscInt n, PetscInt list[], float s[])
{
  for (PetscInt k = n; k < n + LANES; k++) {
    list[k] = a;
    s[k]    = PADDING;
  }
}

/* RowCheck - refuses a row of more neighbours than a row may have. Not collective. */
static inline PetscErrorCode RowCheck(Cloud cloud, PetscInt a, PetscInt found)
{
  const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a;

  PetscFunctionBegin;
  PetscCheck(found <= ROW_CAPACITY, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
             "particle %" PetscInt_FMT " at (%g, %g, %g) m has %" PetscInt_FMT
             " neighbours: particles have clumped; a smaller -time_cfl or -time_step helps",
             cloud->integer[INT_ID][a], (double)x[0], (double)x[1], (double)x[2], found);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* RowEnd - closes the row of particle a, whose 'found' pairs stand behind 'used' ones with all their factors, and shows
   it to the visitor. Returns how many pairs are used now. Not collective. */
static inline PetscInt64 RowEnd(Cloud cloud, PetscInt a, PetscInt64 used, PetscInt found, const float w[],
                                const float slope_over_r2[], RowVisitor visit, void *context)
{
  if (a >= cloud->n_fluid)
    cloud->laplacian_sum[a] =
      DropWallPairs(cloud->integer[INT_LAYER], found, cloud->list + used, cloud->laplacian + used);
  cloud->first[a + 1] = used + found;
  if (visit) visit(cloud, a, w, slope_over_r2, context);
  return used + found;
}

#endif
