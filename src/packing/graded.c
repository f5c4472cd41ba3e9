/* The particles of a scene with graded spacing: its bodies, and the dummy particles of the walls, which have the sizes
   of the liquid beside them. */
#include "packing_impl.h"

/* Points of the faces, edges and corners of the box have columns of dummy particles behind them, one along each
   direction in which they are on a wall. side[d]: 0: not on a face, 1: lower, 2: upper. */
typedef struct {
  PetscInt side[DIM], outward;
} Corner;

#define FINE_MARGIN 3. /* fine spacings by which a fine region must extend beyond solids and emitters */

/* Whether the spacing is fine within FINE_MARGIN of x (m) along the axes. */
static PetscBool IsFine(Domain domain, Scene scene, const PetscReal x[DIM])
{
  const PetscReal fine = (1 + POINT_TOLERANCE) * domain->spacing;

  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt side = -1; side <= 1; side += 2) {
      PetscReal y[DIM] = {x[0], x[1], x[2]};

      y[d] = PetscMax(domain->lower[d], PetscMin(domain->upper[d], y[d] + side * FINE_MARGIN * domain->spacing));
      if (SceneSpacing(scene, y) > fine) return PETSC_FALSE;
    }
  return PETSC_TRUE;
}

/* Refuses solids whose surface is not well inside a fine region, since their particles are fine. */
static PetscErrorCode CheckSolids(Domain domain, Scene scene)
{
  Lattice  box;
  PetscInt solid = 0;

  PetscFunctionBegin;
  if (!SceneSolidCount(scene)) PetscFunctionReturn(PETSC_SUCCESS);
  LatticeOfBox(domain, domain->spacing, &box);
  for (PetscInt point = 0; point < LatticeCount(&box); point++) {
    PetscReal x[DIM], s;

    LatticePoint(&box, point, x);
    s = SceneSolidDistance(scene, x, &solid);
    PetscCheckUser(PetscAbsReal(s) > domain->spacing || IsFine(domain, scene, x), domain->comm,
                   "the solid %s must lie in a region of -fine that extends %g fine spacings beyond its surface, but "
                   "at (%g, %g, %g) m the spacing grows: with -spacing_coarse its particles are fine",
                   BodyName(SceneSolid(scene, solid)), (double)FINE_MARGIN, (double)x[0], (double)x[1], (double)x[2]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses an emitter whose bounds are not well inside a fine region, since its particles are fine. */
static PetscErrorCode CheckEmitter(Domain domain, Scene scene, Body body)
{
  PetscReal lower[DIM], upper[DIM];

  PetscFunctionBegin;
  BodyBounds(body, lower, upper);
  for (PetscInt corner = 0; corner < 1 << domain->dim; corner++) {
    PetscReal x[DIM];

    for (PetscInt d = 0; d < DIM; d++) x[d] = corner >> d & 1 ? upper[d] : lower[d];
    PetscCheckUser(IsFine(domain, scene, x), domain->comm,
                   "the emitter %s must lie in a region of -fine that extends %g fine spacings beyond it: with "
                   "-spacing_coarse its particles are fine",
                   BodyName(body), (double)FINE_MARGIN);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses a coarse spacing that no lattice between two closed faces can have. */
static PetscErrorCode CheckPitch(Packing packing, const Region *region)
{
  const Domain domain = packing->cloud->domain;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < DIM; d++)
    PetscCheckUser(
      !region->along[d] || region->coarse.pitch[d] <= (SIZE_MARGIN - POINT_TOLERANCE) * domain->spacing_coarse,
      domain->comm,
      "-spacing_coarse %g m does not fit the box, which is %g m wide in %c: a lattice there would have %g m",
      (double)domain->spacing_coarse, (double)(domain->upper[d] - domain->lower[d]), "xyz"[d],
      (double)region -> coarse.pitch[d]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The factor on the measures of a body's points with which rings have the body's volume (m3); 1 without rings. */
static PetscReal Stretch(const Region *region, PetscReal volume)
{
  const Domain domain = region->packing->cloud->domain;
  const Scene  scene  = region->packing->cloud->scene;
  PetscReal    sum    = 0;

  for (PetscInt k = 0; k < region->n && domain->rings; k++) {
    const RegionPoint *point = &region->point[k];

    sum += point->measure * DomainRingLength(domain, point->x, SceneSpacing(scene, point->x) / domain->spacing);
  }
  return sum > 0 ? volume / sum : 1;
}

/* Adds the particles of body b. Rings: its volume is ring_length (m) times the area of a cell of the fine lattice. *id:
   the number of the next particle. */
static PetscErrorCode AddBody(Packing packing, PetscInt b, const PetscReal level[], PetscReal ring_length,
                              PetscSegBuffer samples, PetscInt *id)
{
  const Domain domain = packing->cloud->domain;
  const Body   body   = SceneBody(packing->cloud->scene, b);
  Region       region = {.packing = packing, .dim = domain->dim, .body = b, .level = level};
  PetscReal    stretch;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < domain->dim; d++) region.along[d] = PETSC_TRUE;
  region.coarsest = domain->spacing_coarse;
  BodyBounds(body, region.lower, region.upper);
  LatticeOfBody(domain, domain->spacing, body, &region.fine);
  LatticeOfBody(domain, region.coarsest, body, &region.coarse);
  PetscCall(CheckPitch(packing, &region));
  PetscCall(RegionFill(&region));
  stretch = Stretch(&region, ring_length * region.fine.pitch[0] * region.fine.pitch[1]);
  for (PetscInt k = 0; k < region.n; k++) {
    const RegionPoint *point  = &region.point[k];
    const PetscReal    s      = DomainSize(domain, point->measure) * domain->spacing;
    Sample             sample = {.body = b, .area = stretch * point->measure / domain->volume};
    PetscReal          length;

    sample.id = sample.parent = (*id)++;
    sample.size               = domain->rings ? SceneSpacing(packing->cloud->scene, point->x) / domain->spacing
                                              : DomainSize(domain, stretch * point->measure);
    length                    = DomainRingLength(domain, point->x, sample.size);
    PetscCall(PetscArraycpy(sample.x, point->x, DIM));
    BodyDisplace(body, sample.x);
    sample.area *= length / DomainRingLength(domain, sample.x, sample.size); /* a displaced ring keeps its volume */
    if (point->fixed)
      LatticeShake(packing, s, &sample);
    else
      DomainConfine(domain, sample.x);
    PetscCall(SampleKeep(samples, &sample));
  }
  PetscCall(PetscFree(region.point));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the column behind a point of a corner: a block of layers^outward particles. */
static PetscErrorCode AddColumn(const Region *region, const Corner *corner, const RegionPoint *point, PetscReal s,
                                PetscInt layers, PetscSegBuffer samples, PetscInt *number)
{
  const Domain   domain = region->packing->cloud->domain;
  PetscInt       first[DIM], last[DIM], step[DIM];
  const PetscInt parent = *number; /* the first particle of the block */

  PetscFunctionBegin;
  for (PetscInt d = 0; d < DIM; d++) {
    first[d] = step[d] = corner->side[d] ? 1 : 0;
    last[d]            = corner->side[d] ? layers : 0;
  }
  do {
    Sample sample = {.body = BODY_WALL, .id = (*number)++, .parent = parent};

    sample.area = point->measure * PetscPowRealInt(s, (int)corner->outward) / domain->volume;
    sample.size = RegionSpacing(region, point->x) / domain->spacing;
    for (PetscInt d = 0; d < DIM; d++) {
      sample.x[d]  = point->x[d] + (corner->side[d] == 0 ? 0 : corner->side[d] == 1 ? -1 : 1) * (step[d] - 0.5) * s;
      sample.layer = PetscMax(sample.layer, step[d]);
      if (d >= domain->dim) sample.x[d] = 0;
    }
    DomainWallVelocity(domain, sample.x, sample.v);
    PetscCall(SampleKeep(samples, &sample));
  } while (CellNext(first, last, step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the dummy particles behind a part of the box: a face (outward 1), an edge (2) or a corner (3). */
static PetscErrorCode AddCorner(Packing packing, const Corner *corner, PetscSegBuffer samples, PetscInt *number)
{
  const Cloud  cloud  = packing->cloud;
  const Domain domain = cloud->domain;
  Region       region = {.packing = packing, .dim = domain->dim - corner->outward, .body = -1};

  PetscFunctionBegin;
  LatticeOfBox(domain, domain->spacing, &region.fine);
  region.coarsest = domain->spacing_coarse;
  LatticeOfBox(domain, region.coarsest, &region.coarse);
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal face = corner->side[d] == 1 ? domain->lower[d] : domain->upper[d];

    region.along[d] = (PetscBool)(d < domain->dim && !corner->side[d]);
    region.lower[d] = region.along[d] ? domain->lower[d] : d < domain->dim ? face : 0;
    region.upper[d] = region.along[d] ? domain->upper[d] : region.lower[d];
    if (region.along[d]) continue;
    region.fine.n[d] = region.coarse.n[d] = 1;
    region.fine.origin[d] = region.coarse.origin[d] = region.lower[d];
  }
  PetscCall(CheckPitch(packing, &region));
  PetscCall(RegionFill(&region));
  for (PetscInt k = 0; k < region.n; k++) {
    const RegionPoint *point = &region.point[k];
    const PetscReal s = region.dim ? PetscPowReal(point->measure, 1. / region.dim) : RegionSpacing(&region, point->x);

    PetscCall(AddColumn(&region, corner, point, s, CloudWallLayers(cloud), samples, number));
  }
  PetscCall(PetscFree(region.point));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the dummy particles of all walls, numbered from 0 on. */
static PetscErrorCode AddWalls(Packing packing, PetscSegBuffer samples)
{
  const Domain domain     = packing->cloud->domain;
  PetscInt     first[DIM] = {0, 0, 0}, last[DIM] = {2, 2, domain->dim == DIM ? 2 : 0}, number = 0;
  Corner       corner = {{0, 0, 0}, 0};

  PetscFunctionBegin;
  do {
    PetscBool walls = PETSC_TRUE;

    corner.outward = 0;
    for (PetscInt d = 0; d < DIM; d++) {
      if (!corner.side[d]) continue;
      corner.outward++;
      if (domain->face[d][corner.side[d] - 1] != FACE_WALL) walls = PETSC_FALSE;
    }
    if (walls && corner.outward) PetscCall(AddCorner(packing, &corner, samples, &number));
  } while (CellNext(first, last, corner.side));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GradedSetUp(Packing packing)
{
  const Scene    scene = packing->cloud->scene;
  PetscReal      level[SCENE_MAX_BODIES], length[SCENE_MAX_BODIES];
  PetscSegBuffer samples;
  PetscInt       id = 0;

  PetscFunctionBegin;
  PetscCall(LatticeFit(packing, level, length));
  PetscCall(PetscSegBufferCreate(sizeof(Sample), 1024, &samples));
  PetscCall(CheckSolids(packing->cloud->domain, scene));
  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    if (BodyComesLater(SceneBody(scene, b)))
      PetscCall(CheckEmitter(packing->cloud->domain, scene, SceneBody(scene, b)));
    else
      PetscCall(AddBody(packing, b, level, length[b], samples, &id));
  }
  PetscCall(SamplesTake(&samples, &packing->graded_count[0], &packing->graded[0]));
  PetscCall(PetscSegBufferCreate(sizeof(Sample), 1024, &samples));
  if (!packing->cloud->domain->adaptive) PetscCall(AddWalls(packing, samples));
  PetscCall(SamplesTake(&samples, &packing->graded_count[1], &packing->graded[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Passes this rank's share of the samples. kind: 0: liquid, 1: walls. */
static PetscErrorCode VisitShare(Packing packing, PetscInt kind, SampleVisitor visitor, void *context)
{
  PetscInt first, last;

  PetscFunctionBegin;
  OwnShare(packing->cloud->comm, packing->graded_count[kind], &first, &last);
  for (PetscInt k = first; k < last; k++) PetscCall(visitor(context, &packing->graded[kind][k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GradedVisit(void *source, SampleVisitor visitor, void *context)
{
  return VisitShare((Packing)source, 0, visitor, context);
}

PetscErrorCode GradedVisitWalls(void *source, SampleVisitor visitor, void *context)
{
  return VisitShare((Packing)source, 1, visitor, context);
}

PetscErrorCode GradedDestroy(Packing packing)
{
  PetscFunctionBegin;
  for (PetscInt kind = 0; kind < 2; kind++) PetscCall(PetscFree(packing->graded[kind]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
