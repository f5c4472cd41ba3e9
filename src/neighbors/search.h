/* Private to neighbors/: the search of the neighbours. */
#ifndef ISPH_SEARCH_H
#define ISPH_SEARCH_H

#include "../base/simd.h"
#include "pairs.h"

#define LANES   SEARCH_LANES /* candidates compared at once */
#define PADDING 1e4f         /* squared distance over h2, beyond any kernel */

/* Positions are compared as integers, many at a time. Their unit is the same on every rank, and the box is 2^n units
   long, n = BOX_BITS unless the box is narrow. So differences are exact, and the same for both particles of a pair,
   also across a periodic face or a mirror. The unit is a billionth of the box, as exact as the single precision of the
   pair factors. */
typedef struct {
  PetscReal center[DIM], inverse[DIM]; /* m; 1/m */
  float     unit[DIM];                 /* over h */
} Units;

/* SearchUnits - the units of a cloud. Not collective. */
Units                   SearchUnits(Cloud cloud);
static inline PetscReal IntegerPosition(const Units *units, PetscInt d, PetscReal x)
{
  return rint((x - units->center[d]) * units->inverse[d]);
}

/* A run of up to LANES candidates in one integer: the lower half is its start in the grid's order, the upper half its
   count. This halves the memory traffic. A larger count means that more runs follow. */
typedef int64_t Run;

#define RUN(begin, count) ((begin) + (int64_t)(count) * (UINT32_MAX + 1LL))
#define RUN_BEGIN(run)    ((PetscInt)((run)&UINT32_MAX))
#define RUN_COUNT(run)    (PetscMin((PetscInt)((run) >> 32), LANES))

/* The lines of cells along x around a cell, up to 'reach' cells away in y and z: 'count' lines, LINES(reach) at most,
   and more outside to fill the lanes. y, z: offsets of the lines; cells: offset of their cells' numbers. The distance
   of a point from a line along an axis, in cells, is from + times p, with p from 0 to 1 the position in the point's own
   cell. */
#define SPLIT            4     /* cells along x in the length of a cell along y and z */
#define SLACK            1e-3f /* of a cell along x: error of a chord in single precision */
#define LINES(reach)     ((2 * (reach) + 1) * (2 * (reach) + 1))
#define LINES_MOST_REACH 5
#define LINES_MOST       128 /* LINES(LINES_MOST_REACH), in whole vectors */

typedef struct {
  PetscInt count;
  PetscInt y[LINES_MOST], z[LINES_MOST], cells[LINES_MOST];
  float    from_y[LINES_MOST], times_y[LINES_MOST], from_z[LINES_MOST], times_z[LINES_MOST];
} Lines;

/* LinesSet - sets the lines of a grid in 'dim' dimensions. LinesCandidates - largest number of candidates of FindRuns
   with at most 'longest' points in a cell. Not collective. */
void     LinesSet(const CellGrid *grid, PetscInt dim, PetscInt reach, Lines *lines);
PetscInt LinesCandidates(PetscInt reach, PetscInt longest);

/* FindRuns - finds the candidates for neighbours of a point at x (m): of each line of cells around it, the cells that
   intersect the sphere of the radius (m). The radius is at most as many cells in y and z as the lines
   reach. outside: the point may be outside the grid. Returns the number of runs. There are no data-dependent branches
   but for long runs. Not collective. */
static inline PetscInt FindRuns(const CellGrid *grid, const Lines *lines, PetscBool outside, const PetscReal x[DIM],
                                PetscReal radius, Run run[])
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
  for (PetscInt l = 0; l < (lines->count + LANES - 1) / LANES * LANES; l++) {
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
  for (PetscInt l = 0; l < lines->count; l++) {
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

/* ReserveList - makes room in the list for so many pairs. Not collective. */
PetscErrorCode ReserveList(Cloud cloud, PetscInt64 pairs);
/* DropWallPairs - sets the Laplacian weights of pairs of a wall particle with wall particles to zero, since nothing
   flows between them. Returns the sum of the other weights. Not collective. */
PetscInt DropWallPairs(const PetscInt layer[], PetscInt n, const PetscInt list[], uint16_t laplacian[]);
/* FindWeights - computes the cloud's weight, length and relative_weight, ghosts too. WeightRow - multiplies the factors
   of a row, which are for a relative_weight of 1, by that of the neighbours. Not collective. */
void FindWeights(Cloud cloud);
void WeightRow(Cloud cloud, PetscInt n, const PetscInt list[], float w[], float slope[]);
/* Blocks of a level's grid, of SPLIT cells along x, and some layers of blocks around it: the largest sizes of the
   particles that may form pairs with a particle in the block; 0: none. */
typedef struct {
  CellBox box;
  /* [box.count] coarse: for a particle of the grid's level, sizes in this level and coarser levels; fine: for a
     particle of a coarser level, sizes in the grid's level */
  PetscReal *coarse[SEARCH_LEVELS], *fine[SEARCH_LEVELS];
} Blocks;

/* The particles of a level in the order of its grid, and LANES more entries, which are read but not used. */
typedef struct {
  PetscInt  n;
  int32_t  *position; /* [3][n] integer positions */
  float    *size;     /* [n] of graded particles */
  PetscInt *index;    /* [n] local indices */
} Candidates;

/* The particles of a level of sizes, ghosts too. Particles of one size have one level, without the parts for graded
   particles. */
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
  PetscReal support;     /* the kernel's, m */
  float     limit, unit; /* support2/h2; unit of the Laplacian factors */
  Level     level[SEARCH_LEVELS];
  Run      *run; /* runs of one row */
  /* Of one row: r2/h2, then over h_ab2; sizes of the neighbours; h over h_ab. */
  float s[ROW_CAPACITY + LANES], size[ROW_CAPACITY + LANES], ratio[ROW_CAPACITY + LANES];
} Search;

/* SearchCreate - sorts the particles at the positions of the cloud; search is zeroed. Not collective. */
PetscErrorCode SearchCreate(Cloud cloud, Search *search);
PetscErrorCode SearchDestroy(Cloud cloud, Search *search);
/* SearchLevel - the search's level of particle a. SearchLevelRuns - writes the candidates of level l for particle a of
   level 'own' to search->run: those near enough for a pair with the largest of them. block: of particle a in the finer
   level. Returns the number of runs. Not collective. */
static inline PetscInt SearchLevel(Cloud cloud, PetscInt a)
{
  return (CloudLevel(cloud, a) + 1) / 2;
}
PetscInt SearchLevelRuns(Cloud cloud, const Search *search, PetscInt a, PetscInt own, PetscInt l, PetscInt block);

/* Pads a row with pairs of the particle with itself, of weight zero, so that loops work on whole vectors. The next row
   overwrites them. */
static inline void PadRow(PetscInt a, PetscInt n, PetscInt list[], float s[])
{
  for (PetscInt k = n; k < n + LANES; k++) {
    list[k] = a;
    s[k]    = PADDING;
  }
}

/* RowCheck - refuses a row with too many neighbours. Not collective. */
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

/* RowEnd - closes the row of particle a, whose 'found' pairs and factors follow 'used' earlier pairs, and calls the
   visitor. Returns the number of pairs used now. Not collective. */
static inline PetscInt64 RowEnd(Cloud cloud, PetscInt a, PetscInt64 used, PetscInt found, const float w[],
                                RowVisitor visit, void *context)
{
  if (a >= cloud->n_fluid)
    cloud->laplacian_sum[a] =
      DropWallPairs(cloud->integer[INT_LAYER], found, cloud->list + used, cloud->laplacian + used);
  cloud->first[a + 1] = used + found;
  if (visit) visit(cloud, a, w, context);
  return used + found;
}

#endif
