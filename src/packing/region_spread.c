/* Spreads particles of different sizes evenly, as the shifting does during a run: each moves against sum V_b (1 + 0.2
   (W/W(s))^4) grad W. Faces of the region mirror it, so that the first layer comes to rest half a spacing from them.
   With the kernel used here particles do not pair. Each rank moves its share of the points; all know all positions. */
#include "../scene/body.h"
#include "packing_impl.h"

#define ROUNDS       150 /* of displacements */
#define SOLID_ROUNDS 60  /* of the dummies of a solid, which start from a lattice */
#define LIST_MARGIN  1.1 /* on the support, for larger neighbours, where sizes differ */
#define LIST_SLACK   0.3 /* spacings by which two points may come closer before neighbours are searched anew */
#define KERNEL_WIDTH 1.3 /* smoothing length, spacings */
#define SUPPORT      (2 * KERNEL_WIDTH)
#define STRENGTH     0.3 /* factor of a displacement: times s^2 times the sum */
#define FARTHEST     0.1 /* largest displacement, spacings */
#define CLUMP_WEIGHT 0.2 /* Monaghan (2000) */
#define DEEP_ENOUGH  0.2 /* least distance of centres from the region's surface, spacings */
/* the same at the start: a point of the fine lattice that is much nearer than a spacing to its mirror image is not
   repelled by it */
#define LEAST_DEPTH 0.1
/* fine spacings: difference for normals, and depth at which to test whether the region reaches a face */
#define PROBE    0.05
#define PARALLEL 0.9 /* least cosine between the normals of a curved surface and of a face that count as one mirror */

/* The kernel C2 of Wendland (1995) at q = r/h and its -F, both without norm, and the norm of F for h = KERNEL_WIDTH. */
#define WENDLAND(q)       (PetscSqr(PetscSqr(1 - 0.5 * (q))) * (2 * (q) + 1))
#define WENDLAND_SLOPE(q) (5 * PetscSqr(1 - 0.5 * (q)) * (1 - 0.5 * (q)))
#define NORM_2            (7 / (4 * PETSC_PI * PetscSqr(PetscSqr(KERNEL_WIDTH))))
#define NORM_3            (21 / (16 * PETSC_PI * PetscSqr(PetscSqr(KERNEL_WIDTH)) * KERNEL_WIDTH))

#define PLANES_MOST (DIM + 1)
#define BATCH       64 /* pairs whose displacements are found together, in SIMD registers */

/* A mirror: a point on it and its normal. */
typedef struct {
  PetscReal at[DIM], normal[DIM];
} Plane;

/* Where a point is, and its spacing, m. */
typedef struct {
  PetscReal x[DIM], s;
} Place;

/* Pairs within the support: r from the neighbour to the point (m), r^2 over the mean spacing's square, which is 'mean'
   (m), and the neighbour's spacing (m). */
typedef struct {
  PetscReal r[DIM][BATCH], square[BATCH], mean[BATCH], s[BATCH];
} Pairs;

typedef struct {
  Region    *region;
  Scene      scene;
  Domain     domain;
  PetscReal *x, *s; /* [n][3], [n] m */
  PetscReal *then;  /* [n][3] m, x at the last search of neighbours */
  PetscReal  reach; /* of neighbours, spacings */
  PetscReal *force; /* [n][3] of this rank's points, m */
  CellGrid   grid;
  PetscInt   low, high;              /* this rank's points: low to high - 1 */
  Place     *place;                  /* [n] of all points in the order of the grid, which is that of memory, too */
  PetscInt  *first, *list, capacity; /* neighbours of this rank's points; both are numbers in that order */
} Spread;

static inline PetscBool IsOwn(const Spread *p, PetscInt a)
{
  return (PetscBool)(a >= p->low && a < p->high);
}

/* Finds the neighbours of this rank's points. */
static PetscErrorCode FindNear(Spread *p)
{
  PetscInt used = 0;

  PetscFunctionBegin;
  PetscCall(CellGridBuild(&p->grid, p->domain->dim, p->region->n, p->x, SUPPORT * p->domain->spacing, 1));
  for (PetscInt i = 0; i < p->region->n; i++) {
    const PetscInt   a = p->grid.order[i];
    const PetscReal *x = p->x + DIM * a, reach = (p->reach + LIST_SLACK) * p->s[a];
    PetscInt         low[DIM], high[DIM], cell[DIM];

    p->first[i] = used;
    if (!IsOwn(p, a)) continue;
    for (PetscInt d = 0; d < DIM; d++) {
      low[d] = cell[d] = PetscMax(0, (PetscInt)((x[d] - reach - p->grid.lower[d]) / p->grid.size));
      high[d] =
        PetscMax(low[d], PetscMin(p->grid.n[d] - 1, (PetscInt)((x[d] + reach - p->grid.lower[d]) / p->grid.size)));
    }
    do {
      const PetscInt c = CellIndex(p->grid.n, cell[0], cell[1], cell[2]);

      for (PetscInt k = p->grid.start[c]; k < p->grid.start[c + 1]; k++) {
        const PetscInt  b      = p->grid.order[k];
        const PetscReal r[DIM] = {x[0] - p->x[DIM * b], x[1] - p->x[DIM * b + 1], x[2] - p->x[DIM * b + 2]};

        if (Dot(r, r) >= reach * reach) continue;
        PetscCall(ListGrow(used, &p->capacity, sizeof(PetscInt), &p->list));
        p->list[used++] = k; /* the point itself too, for its images */
      }
    } while (CellNext(low, high, cell));
  }
  p->first[p->region->n] = used;
  PetscCall(PetscArraycpy(p->then, p->x, DIM * p->region->n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether two points may have come closer by more than the slack since the last search of neighbours. */
static PetscBool Moved(const Spread *p)
{
  PetscReal most = 0;

  for (PetscInt a = 0; a < p->region->n; a++) {
    const PetscReal *x = p->x + DIM * a, *y = p->then + DIM * a, r[DIM] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};

    most = PetscMax(most, Dot(r, r) / PetscSqr(p->s[a]));
  }
  return (PetscBool)(2 * PetscSqrtReal(most) > LIST_SLACK);
}

static void CollectPlaces(Spread *p)
{
  for (PetscInt k = 0; k < p->region->n; k++) {
    const PetscInt b = p->grid.order[k];

    for (PetscInt d = 0; d < DIM; d++) p->place[k].x[d] = p->x[DIM * b + d];
    p->place[k].s = p->s[b];
  }
}

/* The body or solid that the region fills; NULL: a block. */
static inline Body Filled(const Spread *p)
{
  return p->region->body >= 0 ? SceneBody(p->scene, p->region->body) : p->region->solid;
}

/* Displaces a point (m) of the region's lattice as the body does. */
static inline void Displace(const Region *region, Body body, PetscReal x[DIM])
{
  if (!region->solid) BodyDisplace(body, x);
}

/* Signed distance (m) of a point, after the body's displacement, to the body's surface; a solid is where its shape is.
 */
static PetscReal Distance(const Region *region, Body body, const PetscReal x[DIM])
{
  PetscReal y[DIM] = {x[0], x[1], x[2]};

  Displace(region, body, y);
  return ShapeDistance(body, y);
}

/* The outward normal of the body's surface at x. */
static void SurfaceNormal(const Spread *p, Body body, const PetscReal x[DIM], PetscReal normal[DIM])
{
  const PetscReal step = PROBE * p->domain->spacing;
  PetscReal       length;

  for (PetscInt d = 0; d < DIM; d++) {
    PetscReal low[DIM] = {x[0], x[1], x[2]}, high[DIM] = {x[0], x[1], x[2]};

    low[d] -= step;
    high[d] += step;
    normal[d] = p->region->along[d] ? Distance(p->region, body, high) - Distance(p->region, body, low) : 0;
  }
  length = Norm(normal);
  for (PetscInt d = 0; d < DIM && length > 0; d++) normal[d] /= length;
}

/* The mirrors around x: faces of the box around the region that it reaches, and the surface of a body. */
static PetscInt FindPlanes(const Spread *p, const PetscReal x[DIM], PetscReal reach, Plane plane[PLANES_MOST])
{
  const Region *region = p->region;
  const Body    body   = Filled(p);
  PetscInt      n      = 0;
  PetscReal     deep, normal[DIM];

  for (PetscInt d = 0; d < DIM; d++)
    for (PetscInt side = 0; side < 2; side++) {
      const PetscReal face   = side ? region->upper[d] : region->lower[d];
      PetscReal       y[DIM] = {x[0], x[1], x[2]};

      if (!region->along[d] || PetscAbsReal(x[d] - face) > reach) continue;
      if (n && plane[n - 1].normal[d] != 0) continue; /* the region is thin: the nearer face is enough */
      y[d] = face + (side ? -1 : 1) * PROBE * p->domain->spacing;
      if (body) Displace(region, body, y);
      if (body && !BodyContains(body, y)) continue;
      plane[n]           = (Plane){{x[0], x[1], x[2]}, {0, 0, 0}};
      plane[n].at[d]     = face;
      plane[n].normal[d] = 1;
      n++;
    }
  if (!body) return n;
  deep = -Distance(region, body, x);
  if (deep > reach) return n;
  SurfaceNormal(p, body, x, normal);
  for (PetscInt k = 0; k < n; k++)
    if (PetscAbsReal(Dot(normal, plane[k].normal)) > PARALLEL) return n;
  for (PetscInt d = 0; d < DIM; d++) {
    plane[n].at[d]     = x[d] + deep * normal[d];
    plane[n].normal[d] = normal[d];
  }
  return n + 1;
}

/* Adds the displacements of a point with spacing s by n pairs, whose neighbours have the volume s_b^dim. */
static void AddDisplacements(const Spread *p, PetscReal s, PetscInt n, const Pairs *pairs, PetscReal force[DIM])
{
  const PetscBool flat = (PetscBool)(p->region->dim == 2);
  PetscReal       f[BATCH];

#pragma omp simd
  for (PetscInt k = 0; k < n; k++) {
    const PetscReal mean = pairs->mean[k], q = PetscSqrtReal(pairs->square[k]) / KERNEL_WIDTH,
                    ratio = pairs->s[k] / mean, clump = WENDLAND(q) / WENDLAND(1 / KERNEL_WIDTH);

    f[k] = STRENGTH * s * s * (flat ? ratio * ratio : ratio * (ratio * ratio)) * WENDLAND_SLOPE(q) / (mean * mean) *
           (flat ? NORM_2 : NORM_3) * (1 + CLUMP_WEIGHT * PetscSqr(clump * clump));
  }
  for (PetscInt k = 0; k < n; k++)
    for (PetscInt d = 0; d < DIM; d++)
      if (p->region->along[d]) force[d] += f[k] * pairs->r[d][k];
}

/* Sets pair n to a neighbour at y with spacing s_b of a point at x with spacing s, and returns whether it is within the
   support. */
static inline PetscInt SetPair(const PetscReal x[DIM], PetscReal s, const PetscReal y[DIM], PetscReal s_b, PetscInt n,
                               Pairs *pairs)
{
  const PetscReal mean = 0.5 * (s + s_b), r[DIM] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]},
                  square = Dot(r, r) / (mean * mean);

  for (PetscInt d = 0; d < DIM; d++) pairs->r[d][n] = r[d];
  pairs->square[n] = square;
  pairs->mean[n]   = mean;
  pairs->s[n]      = s_b;
  return (square < SUPPORT * SUPPORT) & (square != 0);
}

/* The height of y above the plane, m. */
static inline PetscReal Height(const Plane *plane, const PetscReal y[DIM])
{
  const PetscReal r[DIM] = {y[0] - plane->at[0], y[1] - plane->at[1], y[2] - plane->at[2]};

  return Dot(r, plane->normal);
}

/* The displacement of point a, the i-th in the order of the grid. */
static void FindForce(const Spread *p, PetscInt i, PetscInt a, PetscReal force[DIM])
{
  const PetscReal *x = p->x + DIM * a, s = p->s[a];
  Plane            plane[PLANES_MOST];
  const PetscInt   planes = FindPlanes(p, x, p->reach * s, plane);
  const PetscReal  own    = planes ? Height(&plane[0], x) : 0;
  PetscInt         n      = 0;
  Pairs            pairs;

  force[0] = force[1] = force[2] = 0;
  for (PetscInt k = p->first[i]; k < p->first[i + 1]; k++) {
    const Place    *b      = &p->place[p->list[k]];
    const PetscReal height = planes ? Height(&plane[0], b->x) : 0;
    /* the image of one plane is at least as far as the sum of both heights */
    const PetscInt images =
      planes == 1 && PetscAbsReal(own + height) > SUPPORT * (1 + PETSC_SQRT_MACHINE_EPSILON) * 0.5 * (s + b->s)
        ? 1
        : 1 << planes;

    for (PetscInt image = 0; image < images; image++) {
      PetscReal y[DIM] = {b->x[0], b->x[1], b->x[2]};

      for (PetscInt m = 0; m < planes; m++) {
        const PetscReal up = image >> m & 1 ? 2 * Height(&plane[m], y) : 0;

        if (image >> m & 1)
          for (PetscInt e = 0; e < DIM; e++) y[e] -= up * plane[m].normal[e];
      }
      n += SetPair(x, s, y, b->s, n, &pairs);
      if (n < BATCH) continue;
      AddDisplacements(p, s, n, &pairs, force);
      n = 0;
    }
  }
  AddDisplacements(p, s, n, &pairs, force);
}

/* Whether a centre may move from the depth 'from' below a surface to the depth 'to': deep enough, or at least not less
   deep. Points of the fine lattice start less deep than coarse particles should be. */
static inline PetscBool MayMove(PetscReal from, PetscReal to, PetscReal s)
{
  return (PetscBool)(to >= PetscMin(DEEP_ENOUGH * s, from));
}

/* Whether a centre may move from x to y. */
static PetscBool MayBe(const Spread *p, const PetscReal x[DIM], const PetscReal y[DIM], PetscReal s)
{
  const Region *region = p->region;

  for (PetscInt d = 0; d < DIM; d++)
    if (region->along[d] && (!MayMove(x[d] - region->lower[d], y[d] - region->lower[d], s) ||
                             !MayMove(region->upper[d] - x[d], region->upper[d] - y[d], s)))
      return PETSC_FALSE;
  for (PetscInt b = 0; b <= region->body; b++) {
    const Body      body    = SceneBody(p->scene, b);
    const PetscReal outward = b < region->body ? 1 : -1;

    if (!MayMove(outward * Distance(region, body, x), outward * Distance(region, body, y), s)) return PETSC_FALSE;
  }
  return (PetscBool)(!region->solid ||
                     MayMove(-Distance(region, region->solid, x), -Distance(region, region->solid, y), s));
}

/* Moves a point of a layer of a solid towards its depth, by at most 'most' (m). */
static void KeepDepth(const Spread *p, const RegionPoint *point, PetscReal most, PetscReal x[DIM])
{
  PetscReal normal[DIM], lack;

  if (!point->layer) return;
  lack = Distance(p->region, p->region->solid, x) + (point->layer - 0.5) * p->domain->spacing;
  lack = PetscMax(-most, PetscMin(most, lack));
  SurfaceNormal(p, p->region->solid, x, normal);
  for (PetscInt d = 0; d < DIM; d++) x[d] -= lack * normal[d];
}

/* One round: all forces, then all displacements. */
static void Move(Spread *p)
{
  CollectPlaces(p);
  for (PetscInt i = 0; i < p->region->n; i++) {
    const PetscInt a = p->grid.order[i];

    if (IsOwn(p, a)) FindForce(p, i, a, p->force + DIM * a);
  }
  for (PetscInt a = p->low; a < p->high; a++) {
    PetscReal *force = p->force + DIM * a, y[DIM], length;

    length = Norm(force);
    for (PetscInt d = 0; d < DIM; d++)
      y[d] = p->x[DIM * a + d] + force[d] * PetscMin(1, FARTHEST * p->s[a] / PetscMax(length, PETSC_SMALL * p->s[a]));
    if (!MayBe(p, p->x + DIM * a, y, p->s[a])) continue;
    KeepDepth(p, &p->region->point[a], FARTHEST * p->s[a], y);
    for (PetscInt d = 0; d < DIM; d++) p->x[DIM * a + d] = y[d];
    p->s[a] = RegionSpacing(p->region, y);
  }
}

PetscErrorCode RegionSpread(Region *region)
{
  const Cloud    cloud = region->packing->cloud;
  const PetscInt n     = region->n;
  Spread         p     = {.region = region, .scene = cloud->scene, .domain = cloud->domain};
  PetscInt       fixed = 0; /* points, before those that move */
  PetscMPIInt    size, low, own, *count, *start;
  MPI_Datatype   position;

  PetscFunctionBegin;
  p.reach = region->coarsest > p.domain->spacing ? SUPPORT * LIST_MARGIN : SUPPORT;
  while (fixed < n && region->point[fixed].fixed) fixed++;
  PetscCallMPI(MPI_Comm_size(cloud->comm, &size));
  PetscCall(PetscMalloc2(size, &count, size, &start));
  OwnShare(cloud->comm, n - fixed, &p.low, &p.high);
  p.low += fixed;
  p.high += fixed;
  PetscCall(PetscMPIIntCast(p.low, &low));
  PetscCall(PetscMPIIntCast(p.high - p.low, &own));
  PetscCallMPI(MPI_Allgather(&low, 1, MPI_INT, start, 1, MPI_INT, cloud->comm));
  PetscCallMPI(MPI_Allgather(&own, 1, MPI_INT, count, 1, MPI_INT, cloud->comm));
  PetscCallMPI(MPI_Type_contiguous(DIM, MPIU_REAL, &position));
  PetscCallMPI(MPI_Type_commit(&position));
  PetscCall(PetscMalloc6(DIM * n, &p.x, DIM * n, &p.then, n, &p.s, DIM * n, &p.force, n + 1, &p.first, n, &p.place));
  for (PetscInt a = 0; a < n; a++) {
    const RegionPoint *point = &region->point[a];

    PetscCall(PetscArraycpy(p.x + DIM * a, point->x, DIM));
    p.s[a] = point->fixed ? PetscPowReal(point->measure, 1. / region->dim) : RegionSpacing(region, point->x);
    for (PetscInt d = 0; d < DIM; d++)
      if (region->along[d] && !point->fixed)
        p.x[DIM * a + d] = PetscMax(region->lower[d] + LEAST_DEPTH * p.s[a],
                                    PetscMin(region->upper[d] - LEAST_DEPTH * p.s[a], p.x[DIM * a + d]));
  }
  for (PetscInt round = 0; round < (region->solid ? SOLID_ROUNDS : ROUNDS); round++) {
    if (round == 0 || Moved(&p)) PetscCall(FindNear(&p));
    Move(&p);
    PetscCallMPI(MPI_Allgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, p.x, count, start, position, cloud->comm));
    PetscCallMPI(MPI_Allgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, p.s, count, start, MPIU_REAL, cloud->comm));
  }
  for (PetscInt a = 0; a < n; a++) PetscCall(PetscArraycpy(region->point[a].x, p.x + DIM * a, DIM));
  PetscCallMPI(MPI_Type_free(&position));
  PetscCall(PetscFree2(count, start));
  PetscCall(PetscFree6(p.x, p.then, p.s, p.force, p.first, p.place));
  PetscCall(PetscFree(p.list));
  PetscCall(CellGridReset(&p.grid));
  PetscFunctionReturn(PETSC_SUCCESS);
}
