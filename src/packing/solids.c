/* Dummy particles of the solids. Each solid has points of its own, whose first layer is half a spacing below its faces,
   wherever they are: liquid feels a wall half a spacing in front of the first layer.

   A box, also with holes that are boxes, has a lattice whose planes are half a spacing from each face and evenly spaced
   between two faces. Other shapes start from a lattice about their middle. Of its points, in the order of their depth,
   the first layer gets as many as a layer's volume holds, then the second; both are moved to their depths and spread
   evenly along the surface (RegionSpread). What is left of a volume of dummies that is no whole number of particles
   shifts no face: the spacing along the faces differs instead. */
#include "../scene/body.h"
#include "packing_impl.h"
#include <stdlib.h>

#define LAYERS 2   /* that keep their depth: with a kernel of 2.6 spacings liquid hardly feels a third */
#define FIXED  3   /* spacings below the dummies, in which the lattice holds them */
#define MISFIT 0.1 /* of a layer's particles, by which a layer may differ so that shells of the lattice stay whole */

/* A lattice with its own planes in each direction: at[d] ([n[d]], m). cell: the volume of a cell in sums, m^dim. */
typedef struct {
  PetscInt   n[DIM];
  PetscReal *at[DIM], cell;
} Planes;

/* Where the solid's shape is, along periodic directions and of one that moves beyond the box, too; through[d]: it
   reaches both closed faces. */
static void Extent(Domain domain, Body solid, PetscReal lower[DIM], PetscReal upper[DIM], PetscBool through[DIM])
{
  const PetscReal tiny = POINT_TOLERANCE * domain->spacing;
  PetscReal       low[DIM], high[DIM];

  BodyBounds(solid, lower, upper);
  solid->shape->bounds(solid, low, high);
  for (PetscInt d = 0; d < DIM; d++) {
    through[d] = PETSC_FALSE;
    if (d >= domain->dim) continue;
    through[d] = (PetscBool)(domain->face[d][0] != FACE_OPEN && domain->face[d][1] != FACE_OPEN &&
                             lower[d] <= domain->lower[d] + tiny && upper[d] >= domain->upper[d] - tiny);
    if ((domain->face[d][0] != FACE_PERIODIC && !solid->motion) || through[d]) continue;
    lower[d] = low[d];
    upper[d] = high[d];
  }
}

static PetscErrorCode AddPlane(PetscSegBuffer planes, PetscReal at)
{
  PetscReal *plane;

  PetscFunctionBegin;
  PetscCall(PetscSegBufferGet(planes, 1, &plane));
  *plane = at;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The planes between two faces at low and high (m): half a spacing from both, evenly spaced between. */
static PetscErrorCode AddBetween(PetscSegBuffer planes, PetscReal spacing, PetscReal low, PetscReal high)
{
  const PetscInt n = (PetscInt)PetscFloorReal((high - low) / spacing + 0.5 + POINT_TOLERANCE);

  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++)
    PetscCall(AddPlane(planes, n == 1 ? 0.5 * (low + high)
                                      : low + 0.5 * spacing + k * (high - low - spacing) / (PetscReal)(n - 1)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the solid and its holes are boxes. */
static PetscBool IsBoxed(Body solid)
{
  for (PetscInt k = 0; k < solid->holes; k++)
    if (!solid->hole[k]->shape->boxed) return PETSC_FALSE;
  return solid->shape->boxed;
}

/* The planes of a box in direction d: between its faces and those of its holes. */
static PetscErrorCode AddBoxed(PetscSegBuffer planes, Domain domain, Body solid, PetscInt d, PetscReal lower,
                               PetscReal upper)
{
  PetscReal face[2 * BODY_HOLES_MOST + 2];
  PetscInt  n = 0;

  PetscFunctionBegin;
  face[n++] = lower;
  face[n++] = upper;
  for (PetscInt k = 0; k < solid->holes; k++) {
    PetscReal low[DIM], high[DIM];

    solid->hole[k]->shape->bounds(solid->hole[k], low, high);
    if (low[d] > lower && low[d] < upper) face[n++] = low[d];
    if (high[d] > lower && high[d] < upper) face[n++] = high[d];
  }
  PetscCall(PetscSortReal(n, face));
  for (PetscInt k = 1; k < n; k++)
    if (face[k] > face[k - 1] + POINT_TOLERANCE * domain->spacing)
      PetscCall(AddBetween(planes, domain->spacing, face[k - 1], face[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PlanesFind(Domain domain, Body solid, Planes *planes)
{
  const PetscReal s     = domain->spacing;
  const PetscBool boxed = IsBoxed(solid);
  PetscReal       lower[DIM], upper[DIM];
  PetscBool       through[DIM];
  Lattice         box;

  PetscFunctionBegin;
  Extent(domain, solid, lower, upper, through);
  LatticeOfBox(domain, s, &box);
  planes->cell = 1;
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal tiny = POINT_TOLERANCE * s, length = upper[d] - lower[d];
    PetscSegBuffer  found;
    size_t          n;

    PetscCall(PetscSegBufferCreate(sizeof(PetscReal), 64, &found));
    if (d >= domain->dim)
      PetscCall(AddPlane(found, 0));
    else if (through[d] || !boxed) {
      const PetscBool closed = domain->face[d][0] != FACE_PERIODIC;
      const PetscBool below =
                        (PetscBool)(closed && domain->face[d][0] != FACE_OPEN && lower[d] <= domain->lower[d] + tiny),
                      above =
                        (PetscBool)(closed && domain->face[d][1] != FACE_OPEN && upper[d] >= domain->upper[d] - tiny);
      const PetscInt more   = through[d]       ? 0
                              : below || above ? 1
                                               : 2, /* layers around the solid */
        count               = through[d] ? box.n[d] : PetscMax(1, (PetscInt)PetscFloorReal(length / s + 0.5)) + more;
      const PetscReal pitch = through[d] ? box.pitch[d] : s,
                      first = through[d] ? box.origin[d]
                              : below    ? domain->lower[d] + 0.5 * s
                              : above    ? domain->upper[d] - (count - 0.5) * s
                                         : 0.5 * (lower[d] + upper[d]) - 0.5 * (count - 1) * s;

      for (PetscInt k = 0; k < count; k++) PetscCall(AddPlane(found, first + k * pitch));
    } else
      PetscCall(AddBoxed(found, domain, solid, d, lower[d], upper[d]));
    PetscCall(PetscSegBufferGetSize(found, &n));
    PetscCall(PetscSegBufferExtractAlloc(found, &planes->at[d]));
    PetscCall(PetscSegBufferDestroy(&found));
    planes->n[d] = (PetscInt)n;
    if (d < domain->dim) planes->cell *= through[d] ? box.pitch[d] : boxed ? length / (PetscReal)n : s;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether x (m), of a solid, is inside the box. */
static PetscBool InBox(Domain domain, const PetscReal x[DIM])
{
  for (PetscInt d = 0; d < domain->dim; d++)
    if (domain->face[d][0] != FACE_PERIODIC && (x[d] <= domain->lower[d] || x[d] >= domain->upper[d]))
      return PETSC_FALSE;
  return PETSC_TRUE;
}

/* The points of the planes in the box less than 'reach' (m) outside of the solid's shape, and less than 'depth' inside;
   those of a solid that moves may lie outside of the box. */
static PetscErrorCode PlanesPoints(Domain domain, Body solid, PetscReal reach, PetscReal depth, PetscInt *n,
                                   PetscReal *cell, RegionPoint **point)
{
  Planes         planes;
  PetscSegBuffer found;
  size_t         size;

  PetscFunctionBegin;
  PetscCall(PlanesFind(domain, solid, &planes));
  PetscCall(PetscSegBufferCreate(sizeof(RegionPoint), 1024, &found));
  for (PetscInt k = 0; k < planes.n[0] * planes.n[1] * planes.n[2]; k++) {
    RegionPoint one = {.measure = 0}, *kept;
    PetscInt    at[DIM];

    if (k % POINTS_ALIVE == 0) InterruptAlive(NULL);
    CellCoordinates(planes.n, k, at);
    for (PetscInt d = 0; d < DIM; d++) one.x[d] = planes.at[d][at[d]];
    one.measure = ShapeDistance(solid, one.x);
    if (one.measure >= reach || one.measure <= -depth || (!solid->motion && !InBox(domain, one.x))) continue;
    PetscCall(PetscSegBufferGet(found, 1, &kept));
    *kept = one;
  }
  PetscCall(PetscSegBufferGetSize(found, &size));
  PetscCall(PetscSegBufferExtractAlloc(found, point));
  PetscCall(PetscSegBufferDestroy(&found));
  *n    = (PetscInt)size;
  *cell = planes.cell;
  for (PetscInt d = 0; d < DIM; d++) PetscCall(PetscFree(planes.at[d]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In the order of their depth, the deepest first; 'measure' is the distance from the surface, m. */
static int CompareDepths(const void *left, const void *right)
{
  const RegionPoint *a = (const RegionPoint *)left, *b = (const RegionPoint *)right;

  for (PetscInt d = -1; d < DIM; d++) {
    const PetscReal x = d < 0 ? a->measure : a->x[d], y = d < 0 ? b->measure : b->x[d];

    if (x != y) return x < y ? -1 : 1;
  }
  return 0;
}

/* How many lattice points the part of the solid that is deeper than 'deep' (m) has room for: each cell counts by its
   share inside, as if the surface were a plane along the lattice. On the mean that is exact for any plane. */
static PetscReal Room(PetscReal spacing, PetscInt n, const RegionPoint point[], PetscReal deep)
{
  PetscReal room = 0;

  for (PetscInt k = 0; k < n; k++) room += PetscMax(0, PetscMin(1, 0.5 - (point[k].measure + deep) / spacing));
  return room;
}

/* How many of the points, the deepest first, to take for 'room' particles: a number that divides no shell of points at
   one distance, if the layer of 'layer' particles can do with the difference. A symmetric solid then has symmetric
   points. */
static PetscInt Take(PetscReal spacing, PetscInt n, const RegionPoint point[], PetscReal room, PetscReal layer)
{
  const PetscInt exact = PetscMin(n, PetscMax(0, (PetscInt)PetscFloorReal(room + 0.5)));
  PetscInt       best  = exact;
  PetscReal      least = MISFIT * layer;

  for (PetscInt k = 1; k <= n; k++) {
    const PetscReal miss = PetscAbsReal((PetscReal)k - room);

    if (k < n && point[k].measure - point[k - 1].measure < POINT_TOLERANCE * spacing) continue;
    if (miss >= least) continue;
    least = miss;
    best  = k;
  }
  return best;
}

/* Marks the points, the deepest first, that are the outer layers: each as many as it has room for. */
static void MarkLayers(PetscReal spacing, PetscReal whole, PetscInt n, RegionPoint point[])
{
  const PetscInt all              = n;
  PetscReal      room[LAYERS + 1] = {whole};

  for (PetscInt k = 1; k <= LAYERS; k++) {
    PetscInt first = 0;

    room[k] = Room(spacing, all, point, k * spacing);
    if (room[k] > 0) first = Take(spacing, n, point, n - (room[k - 1] - room[k]), room[k - 1] - room[k]);
    for (PetscInt m = first; m < n; m++) point[m].layer = k;
    if (first == 0) break;
    n = first;
  }
}

/* The dummies of a solid that is no box: *n points at *point; cell: the volume of each in sums, m^dim. Collective. */
static PetscErrorCode FillShape(Cloud cloud, Body solid, PetscReal depth, PetscInt *n, PetscReal *cell,
                                RegionPoint **point)
{
  const PetscReal   s       = cloud->domain->spacing;
  struct _p_Packing packing = {.cloud = cloud}; /* RegionSpread needs no more of it */
  Region    region = {.packing = &packing, .dim = cloud->domain->dim, .body = -1, .solid = solid, .coarsest = s};
  PetscBool through[DIM];
  PetscReal whole;
  PetscInt  all;

  PetscFunctionBegin;
  Extent(cloud->domain, solid, region.lower, region.upper, through);
  PetscCall(PlanesPoints(cloud->domain, solid, s, depth + FIXED * s, &all, cell, &region.point));
  if (all) qsort(region.point, (size_t)all, sizeof(*region.point), CompareDepths);
  whole    = Room(s, all, region.point, 0);
  region.n = all ? Take(s, all, region.point, whole, whole - Room(s, all, region.point, s)) : 0;
  MarkLayers(s, whole, region.n, region.point);
  for (PetscInt k = 0; k < region.n; k++) {
    region.point[k].fixed   = (PetscBool)(region.point[k].measure <= -depth);
    region.point[k].measure = region.point[k].fixed ? PetscPowRealInt(s, (int)region.dim) : 0;
  }
  for (PetscInt d = 0; d < DIM; d++) region.along[d] = (PetscBool)(d < cloud->domain->dim);
  PetscCall(RegionSpread(&region));
  *n     = region.n;
  *point = region.point;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the point belongs to the solid of this index: no other is nearer, or has it deeper inside. */
static PetscBool Owns(Scene scene, PetscInt b, const PetscReal x[DIM])
{
  PetscInt nearest = b;

  (void)SceneSolidDistance(scene, x, &nearest);
  return (PetscBool)(nearest == b);
}

/* Sizes of liquid beside a solid are between the finest and the mean of it and the coarsest. */
static PetscReal Depth(Domain domain, PetscInt layers)
{
  return layers * domain->spacing * (domain->graded ? 0.5 * (1 + DomainSizeMax(domain)) : 1);
}

PetscReal PackingSolidDepth(Cloud cloud)
{
  return Depth(cloud->domain, CloudWallLayers(cloud));
}

PetscErrorCode SolidVisit(void *source, SampleVisitor visitor, void *context)
{
  const Cloud     cloud  = ((const Dummies *)source)->cloud;
  const Domain    domain = cloud->domain;
  const PetscReal depth  = Depth(domain, ((const Dummies *)source)->layers);
  PetscInt        id     = 0;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < SceneSolidCount(cloud->scene); b++) {
    const Body      solid = SceneSolid(cloud->scene, b);
    const PetscBool boxed = IsBoxed(solid);
    PetscReal       cell, image[DIM];
    PetscInt        n, kept = 0, first, last;
    RegionPoint    *point;

    if (boxed)
      PetscCall(PlanesPoints(domain, solid, 0, depth, &n, &cell, &point));
    else
      PetscCall(FillShape(cloud, solid, depth, &n, &cell, &point));
    for (PetscInt k = 0; k < n; k++) {
      BodyForth(solid, point[k].x);
      DomainWrap(domain, point[k].x);
      if (InBox(domain, point[k].x) && Owns(cloud->scene, b, point[k].x) &&
          BodyNearest(solid, point[k].x, image) > -depth)
        point[kept++] = point[k];
    }
    OwnShare(cloud->comm, kept, &first, &last);
    for (PetscInt k = first; k < last; k++) {
      Sample sample = {.layer = 1, .body = BODY_SOLID - b, .area = domain->graded ? 1 : cell / domain->volume};

      PetscCall(PetscArraycpy(sample.x, point[k].x, DIM));
      SceneSolidVelocity(cloud->scene, b, sample.x, sample.v);
      sample.id = sample.parent = id + k;
      PetscCall(visitor(context, &sample));
    }
    id += kept;
    PetscCall(PetscFree(point));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
