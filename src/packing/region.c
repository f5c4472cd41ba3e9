/* Fills a part of space with particles of different sizes: with lattices where the spacing is the finest or the
   coarsest, between them with points of the fine lattice, thinned out to the wanted spacing and spread evenly. */
#include "packing_impl.h"
#include <stdlib.h>

#define CORNER_SHRINK 1e-3 /* of a coarse cell: so much less must be inside the body */
#define GAP_POINTS    200  /* of the integral of 1/s over a gap */
#define LEAST_GAP     0.25 /* particles for which a gap must have room */
/* spacings, of the points between the lattices at the start, so that no row of them stays straight */
#define JITTER 0.1

static PetscReal LatticeMeasure(const Region *region, const Lattice *lattice)
{
  PetscReal measure = 1;

  for (PetscInt d = 0; d < DIM; d++)
    if (region->along[d]) measure *= lattice->pitch[d];
  return measure;
}

/* Whether the spacing wanted at a point x of the coarse lattice is the coarse one, and its cell is wholly in the
   region. */
static PetscBool CoarseEnough(const Region *region, const PetscReal x[DIM])
{
  const Scene     scene = region->packing->cloud->scene;
  const PetscReal least = (1 - POINT_TOLERANCE) * region->coarsest;

  if (region->coarsest <= (1 + POINT_TOLERANCE) * region->packing->cloud->domain->spacing ||
      RegionSpacing(region, x) < least)
    return PETSC_FALSE;
  for (PetscInt corner = 0; corner < 1 << DIM && region->body >= 0; corner++) {
    PetscReal y[DIM] = {x[0], x[1], x[2]};

    for (PetscInt d = 0; d < DIM; d++)
      if (region->along[d]) y[d] += (corner >> d & 1 ? 0.5 : -0.5) * (1 - CORNER_SHRINK) * region->coarse.pitch[d];
    BodyDisplace(SceneBody(scene, region->body), y);
    if (!BodyContains(SceneBody(scene, region->body), y) || SceneSolidDistance(scene, y, NULL) <= 0) return PETSC_FALSE;
    for (PetscInt other = 0; other < region->body; other++)
      if (!BodyComesLater(SceneBody(scene, other)) && BodyContains(SceneBody(scene, other), y)) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* Whether x lies in the cell of a taken point of the coarse lattice. taken: [points of the coarse lattice]. */
static PetscBool Covered(const Region *region, const PetscBool taken[], const PetscReal x[DIM])
{
  const Lattice *coarse = &region->coarse;
  PetscInt       at[DIM];

  for (PetscInt d = 0; d < DIM; d++) {
    at[d] = region->along[d] ? (PetscInt)PetscFloorReal((x[d] - coarse->origin[d]) / coarse->pitch[d] + 0.5) : 0;
    if (at[d] < 0 || at[d] >= coarse->n[d]) return PETSC_FALSE;
  }
  return taken[CellIndex(coarse->n, at[0], at[1], at[2])];
}

/* A point of the fine lattice where the wanted spacing is larger. order: its number in the order of Morton (1966), in
   which successive points are close together. */
typedef struct {
  uint64_t  order;
  PetscReal x[DIM];
} Candidate;

static uint64_t MortonOrder(const PetscInt at[DIM])
{
  uint64_t order = 0;

  for (PetscInt bit = 0; bit < 20; bit++)
    for (PetscInt d = 0; d < DIM; d++) order |= (uint64_t)(at[d] >> bit & 1) << (DIM * bit + d);
  return order;
}

static int CompareCandidates(const void *left, const void *right)
{
  const Candidate *a = (const Candidate *)left, *b = (const Candidate *)right;

  return (a->order > b->order) - (a->order < b->order);
}

static PetscErrorCode AddPoint(PetscSegBuffer points, const PetscReal x[DIM], PetscReal measure, PetscBool fixed)
{
  RegionPoint *point;

  PetscFunctionBegin;
  PetscCall(PetscSegBufferGet(points, 1, &point));
  *point = (RegionPoint){.x = {x[0], x[1], x[2]}, .measure = measure, .fixed = fixed};
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the points of the coarse lattice where CoarseEnough. taken: which they are; *measure: their measure is added. */
static PetscErrorCode AddCoarse(const Region *region, PetscSegBuffer points, PetscBool taken[], PetscReal *measure)
{
  const PetscReal cell = LatticeMeasure(region, &region->coarse);

  PetscFunctionBegin;
  for (PetscInt point = 0; point < LatticeCount(&region->coarse); point++) {
    PetscReal x[DIM];

    LatticePoint(&region->coarse, point, x);
    taken[point] = CoarseEnough(region, x);
    if (!taken[point]) continue;
    PetscCall(AddPoint(points, x, cell, PETSC_TRUE));
    *measure += cell;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the points of the fine lattice where the wanted spacing is fine. The others become candidates, unless a coarse
   cell covers them. *left: the region's measure less the measure of all points on lattices. */
static PetscErrorCode AddFine(const Region *region, PetscSegBuffer points, const PetscBool taken[],
                              PetscSegBuffer candidates, PetscReal *left)
{
  const Packing   packing = region->packing;
  const Domain    domain  = packing->cloud->domain;
  const PetscReal cell    = LatticeMeasure(region, &region->fine),
                  own     = PetscPowRealInt(domain->spacing, (int)region->dim);

  PetscFunctionBegin;
  for (PetscInt point = 0; point < LatticeCount(&region->fine); point++) {
    PetscReal  x[DIM];
    Candidate *candidate;
    PetscInt   at[DIM];

    LatticePoint(&region->fine, point, x);
    if (region->body >= 0) {
      PetscReal displaced[DIM] = {x[0], x[1], x[2]};

      BodyDisplace(SceneBody(packing->cloud->scene, region->body), displaced);
      if (!LatticeBelongs(packing, region->level, region->body, point, displaced)) continue;
    }
    *left += cell;
    if (Covered(region, taken, x)) continue;
    if (RegionSpacing(region, x) <= (1 + POINT_TOLERANCE) * domain->spacing) {
      PetscCall(AddPoint(points, x, own, PETSC_TRUE));
      *left -= cell;
      continue;
    }
    CellCoordinates(region->fine.n, point, at);
    PetscCall(PetscSegBufferGet(candidates, 1, &candidate));
    candidate->order = MortonOrder(at);
    PetscCall(PetscArraycpy(candidate->x, x, DIM));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes as many of the n candidates as the wanted spacing allows. A candidate counts as a fraction of a particle; when
   the sum of the fractions passes an integer, the candidate is taken. */
static PetscErrorCode Thin(const Region *region, PetscInt n, Candidate candidate[], PetscReal left,
                           PetscSegBuffer points)
{
  const PetscReal cell = LatticeMeasure(region, &region->fine), scale = n ? left / (n * cell) : 0;
  PetscReal       sum = 0.5;

  PetscFunctionBegin;
  if (n) qsort(candidate, (size_t)n, sizeof(*candidate), CompareCandidates);
  for (PetscInt k = 0; k < n; k++) {
    const PetscReal s     = RegionSpacing(region, candidate[k].x);
    const PetscReal share = scale * cell / PetscPowRealInt(s, (int)region->dim), before = PetscFloorReal(sum);

    sum += share;
    if (PetscFloorReal(sum) == before) continue;
    for (PetscInt d = 0; d < DIM; d++)
      if (region->along[d])
        candidate[k].x[d] +=
          JITTER * s *
          (2 * RandomUnit((unsigned long long)region->packing->seed + 2, (unsigned long long)(DIM * k + d)) - 1);
    PetscCall(AddPoint(points, candidate[k].x, 0, PETSC_FALSE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Divides the measure left (m^dim) among the points that are not fixed, by their spacings. */
static void ShareMeasure(Region *region, PetscReal left)
{
  PetscReal sum = 0;

  for (PetscInt k = 0; k < region->n; k++)
    if (!region->point[k].fixed) sum += PetscPowRealInt(RegionSpacing(region, region->point[k].x), (int)region->dim);
  for (PetscInt k = 0; k < region->n; k++)
    if (!region->point[k].fixed)
      region->point[k].measure =
        left / sum * PetscPowRealInt(RegionSpacing(region, region->point[k].x), (int)region->dim);
}

static int ComparePoints(const void *left, const void *right)
{
  const RegionPoint *a = (const RegionPoint *)left, *b = (const RegionPoint *)right;
  const PetscReal x = a->x[0] + a->x[1] + a->x[2], y = b->x[0] + b->x[1] + b->x[2]; /* they differ in one coordinate */

  return (x > y) - (x < y);
}

/* Fills a gap of an edge, from low to high (m) along direction d, with points at equal steps of the integral of 1/s. */
static PetscErrorCode FillGap(const Region *region, PetscInt d, PetscReal low, PetscReal high, PetscSegBuffer points)
{
  const PetscReal step = (high - low) / GAP_POINTS;
  PetscReal       x[DIM], whole = 0, sum = 0, last = low;
  PetscInt        n, done = 0;

  PetscFunctionBegin;
  for (PetscInt e = 0; e < DIM; e++) x[e] = region->lower[e];
  for (PetscInt k = 0; k < GAP_POINTS; k++) {
    x[d] = low + (k + 0.5) * step;
    whole += step / RegionSpacing(region, x);
  }
  if (whole < LEAST_GAP) PetscFunctionReturn(PETSC_SUCCESS);
  n = PetscMax(1, (PetscInt)PetscFloorReal(whole + 0.5));
  for (PetscInt k = 0; k < GAP_POINTS && done < n; k++) {
    const PetscReal at = low + (k + 0.5) * step;
    PetscReal       add;

    x[d] = at;
    add  = step / RegionSpacing(region, x) * n / whole;
    while (done < n && (sum + add >= done + 1 || k == GAP_POINTS - 1)) { /* the end of particle number 'done' */
      const PetscReal end = done == n - 1 ? high : low + (k + (done + 1 - sum) / add) * step;

      x[d] = 0.5 * (last + end);
      PetscCall(AddPoint(points, x, end - last, PETSC_TRUE));
      last = end;
      done++;
    }
    sum += add;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Fills the gaps between the points of an edge. */
static PetscErrorCode FillGaps(const Region *region, PetscSegBuffer points)
{
  RegionPoint *point;
  PetscInt     d = 0, n;
  PetscReal    low;
  size_t       count;

  PetscFunctionBegin;
  while (!region->along[d]) d++;
  low = region->lower[d];
  PetscCall(PetscSegBufferGetSize(points, &count));
  PetscCall(PetscSegBufferExtractAlloc(points, &point));
  n = (PetscInt)count;
  if (n) qsort(point, (size_t)n, sizeof(*point), ComparePoints);
  for (PetscInt k = 0; k <= n; k++) {
    const PetscReal high = k < n ? point[k].x[d] - 0.5 * point[k].measure : region->upper[d];

    if (high > low) PetscCall(FillGap(region, d, low, high, points));
    if (k == n) break;
    PetscCall(AddPoint(points, point[k].x, point[k].measure, PETSC_TRUE));
    low = point[k].x[d] + 0.5 * point[k].measure;
  }
  PetscCall(PetscFree(point));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves the points of a buffer into the region. */
static PetscErrorCode TakePoints(PetscSegBuffer points, Region *region)
{
  size_t n;

  PetscFunctionBegin;
  PetscCall(PetscSegBufferGetSize(points, &n));
  region->n = (PetscInt)n;
  PetscCall(PetscSegBufferExtractAlloc(points, &region->point));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RegionFill(Region *region)
{
  PetscSegBuffer points, candidates;
  PetscBool     *taken;
  PetscReal      left = 0, coarse = 0;
  Candidate     *candidate;
  size_t         n;

  PetscFunctionBegin;
  PetscCall(PetscSegBufferCreate(sizeof(RegionPoint), 1024, &points));
  PetscCall(PetscSegBufferCreate(sizeof(Candidate), 1024, &candidates));
  if (region->dim == 0)
    PetscCall(AddPoint(points, region->lower, 1, PETSC_TRUE));
  else {
    PetscCall(PetscMalloc1(LatticeCount(&region->coarse), &taken));
    PetscCall(AddCoarse(region, points, taken, &coarse));
    PetscCall(AddFine(region, points, taken, candidates, &left));
    PetscCall(PetscFree(taken));
    left -= coarse;
    PetscCall(PetscSegBufferGetSize(candidates, &n));
    PetscCall(PetscSegBufferExtractInPlace(candidates, &candidate));
    if (region->dim == 1)
      PetscCall(FillGaps(region, points));
    else
      PetscCall(Thin(region, (PetscInt)n, candidate, left, points));
  }
  PetscCall(TakePoints(points, region));
  PetscCall(PetscSegBufferDestroy(&points));
  PetscCall(PetscSegBufferDestroy(&candidates));
  if (region->dim > 1) {
    PetscCall(RegionSpread(region));
    ShareMeasure(region, left);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
