/* Bodies filled from a lattice of the particle spacing, with a jitter. */
#include "packing_impl.h"

#define LEVEL_MAX 0.5 /* pitches: farthest level from the body's surface; a body has a point more or less across it */
/* Points at one distance from the surface are a shell. One with a larger share than this of all points near the surface
   is a flat face, which a level does not divide. */
#define SHELL_SPLIT 0.5
#define SUBPOINTS   6  /* in each direction: the share of a lattice cell inside a body is exact to about 1 % */
#define RING_POINTS 40 /* the same for rings, which have few cells */

#define ROUGH_JITTER 0.5 /* of -packing_jitter, for particles that settling does not even out */

#define TIE 0.1 /* of POINT_TOLERANCE: random part of a distance, which orders points of equal distance */

typedef struct {
  PetscReal jitter; /* largest displacement of a component, spacings */
} LatticeData;

void LatticeOfBox(Domain domain, PetscReal spacing, Lattice *lattice)
{
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal length = domain->upper[d] - domain->lower[d];
    const PetscBool below  = (PetscBool)(domain->face[d][0] != FACE_OPEN);
    const PetscBool above  = (PetscBool)(domain->face[d][1] != FACE_OPEN);
    const PetscBool fitted = (PetscBool)(below && above); /* the nearest number of points; else those in the box */

    if (d >= domain->dim) { /* the plane z = 0 */
      lattice->n[d]      = 1;
      lattice->pitch[d]  = spacing;
      lattice->origin[d] = 0;
      continue;
    }
    lattice->n[d] =
      PetscMax(1, (PetscInt)PetscFloorReal(length / spacing + 0.5 + (fitted ? POINT_TOLERANCE : -POINT_TOLERANCE)));
    lattice->pitch[d] = fitted ? length / lattice->n[d] : spacing;
    lattice->origin[d] =
      above && !below ? domain->upper[d] - (lattice->n[d] - 0.5) * spacing : domain->lower[d] + 0.5 * lattice->pitch[d];
  }
}

/* The part of the lattice that may be inside a body, and one layer more. Between two closed faces the pitch is the
   box's, which walls and images continue. The pitch of the other directions compensates, so that a cell has the volume
   spacing^dim of a particle: else the liquid of a box that is no multiple of the spacing would start too dense or too
   thin, and the projection would move it as a whole. The lattice starts at the closed face that the body touches, or is
   symmetric about the body's middle. */
void LatticeOfBody(Domain domain, PetscReal spacing, Body body, Lattice *lattice)
{
  const PetscReal tiny = POINT_TOLERANCE * domain->spacing;
  PetscReal       lower[DIM], upper[DIM], pitch = 1;
  PetscBool       below[DIM], above[DIM];
  PetscInt        free_directions = 0;

  BodyBounds(body, lower, upper);
  LatticeOfBox(domain, spacing, lattice);
  for (PetscInt d = 0; d < domain->dim; d++) {
    below[d] = (PetscBool)(domain->face[d][0] != FACE_OPEN && lower[d] <= domain->lower[d] + tiny);
    above[d] = (PetscBool)(domain->face[d][1] != FACE_OPEN && upper[d] >= domain->upper[d] - tiny);
    if (below[d] && above[d])
      pitch *= spacing / lattice->pitch[d];
    else
      free_directions++;
  }
  pitch = PetscAbsReal(pitch - 1) < POINT_TOLERANCE ? spacing
                                                    : spacing * PetscPowReal(pitch, 1 / PetscMax(free_directions, 1.0));
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal length = upper[d] - lower[d];

    if (below[d] && above[d]) continue;
    lattice->pitch[d] = pitch;
    if (below[d] || above[d]) {
      lattice->n[d]      = PetscMax(1, (PetscInt)PetscFloorReal(length / pitch + POINT_TOLERANCE + 0.5)) + 1;
      lattice->origin[d] = below[d] ? domain->lower[d] + 0.5 * pitch : domain->upper[d] - (lattice->n[d] - 0.5) * pitch;
    } else {
      lattice->n[d]      = PetscMax(1, (PetscInt)PetscFloorReal(length / pitch + 0.5)) + 2;
      lattice->origin[d] = 0.5 * (lower[d] + upper[d]) - 0.5 * (lattice->n[d] - 1) * pitch;
    }
  }
}

/* Signed distance of lattice point number 'point' at x (m) to the surface of body b, with a random part far below
   POINT_TOLERANCE that orders points of equal distance. */
static PetscReal PointDistance(Packing packing, PetscInt b, PetscInt point, const PetscReal x[DIM])
{
  const PetscReal tie = RandomUnit((unsigned long long)packing->seed + 1, (unsigned long long)point);

  return BodyDistance(SceneBody(packing->cloud->scene, b), x) +
         TIE * POINT_TOLERANCE * packing->cloud->domain->spacing * tie;
}

/* Whether x (m) is inside the box, not on a face. */
static PetscBool InsideBox(Domain domain, const PetscReal x[DIM])
{
  for (PetscInt d = 0; d < domain->dim; d++)
    if (x[d] <= domain->lower[d] || x[d] >= domain->upper[d]) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* Whether body b takes the point of its lattice nearest to x (m), at 'distance' (m) from its surface. Of the points at
   the distance of its level the body takes some; where bodies overlap, the next body takes the others. */
static PetscBool Takes(Packing packing, PetscInt b, PetscReal level, PetscReal distance, const PetscReal x[DIM])
{
  const Domain domain = packing->cloud->domain;
  Lattice      lattice;
  PetscInt     at[DIM];

  if (!SceneBodiesOverlap(packing->cloud->scene) || PetscAbsReal(distance - level) > POINT_TOLERANCE * domain->spacing)
    return (PetscBool)(distance <= level);
  LatticeOfBody(domain, domain->spacing, SceneBody(packing->cloud->scene, b), &lattice);
  for (PetscInt d = 0; d < DIM; d++) {
    at[d] = (PetscInt)PetscFloorReal((x[d] - lattice.origin[d]) / lattice.pitch[d] + 0.5);
    at[d] = PetscMax(0, PetscMin(lattice.n[d] - 1, at[d]));
  }
  return (PetscBool)(PointDistance(packing, b, CellIndex(lattice.n, at[0], at[1], at[2]), x) <= level);
}

PetscBool LatticeBelongs(Packing packing, const PetscReal level[], PetscInt b, PetscInt point, const PetscReal x[DIM])
{
  const Scene scene = packing->cloud->scene;

  if (!InsideBox(packing->cloud->domain, x)) return PETSC_FALSE;
  if (PointDistance(packing, b, point, x) > level[b]) return PETSC_FALSE;
  /* not within rounding of a face, where a solid would get liquid on one side alone */
  if (SceneSolidDistance(scene, x, NULL) <= POINT_TOLERANCE * packing->cloud->domain->spacing) return PETSC_FALSE;
  for (PetscInt other = 0; other < b; other++)
    if (Takes(packing, other, level[other], BodyDistance(SceneBody(scene, other), x), x)) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* The points of the lattice cell around x, displaced as the body displaces it, that are inside body b and box, of
   CellPoints. *length: the mean length (m) of the rings in the cell before the displacement, counting zero outside, in
   solids and in earlier bodies. */
static PetscInt CellPoints(Domain domain)
{
  const PetscInt m = domain->rings ? RING_POINTS : SUBPOINTS;

  return domain->dim == DIM ? m * m * m : m * m;
}

static PetscInt CellInside(Scene scene, Domain domain, const Lattice *lattice, PetscInt b, const PetscReal x[DIM],
                           PetscReal *length)
{
  const Body     body      = SceneBody(scene, b);
  const PetscInt m         = domain->rings ? RING_POINTS : SUBPOINTS,
                 last[DIM] = {m - 1, m - 1, domain->dim == DIM ? m - 1 : 0}, first[DIM] = {0, 0, 0};
  PetscInt inside = 0, at[DIM] = {0, 0, 0};

  *length = 0;
  do {
    PetscReal y[DIM] = {x[0], x[1], x[2]}, r;

    for (PetscInt d = 0; d < domain->dim; d++) y[d] += ((at[d] + 0.5) / m - 0.5) * lattice->pitch[d];
    r = y[0];
    BodyDisplace(body, y);
    if (!BodyContains(body, y)) continue;
    inside++;
    if (domain->rings && SceneSolidDistance(scene, y, NULL) > 0 &&
        (!SceneBodiesOverlap(scene) || SceneOwnDistance(scene, b, y) < 0))
      *length += 2 * PETSC_PI * r;
  } while (CellNext(first, last, at));
  *length /= CellPoints(domain);
  return inside;
}

/* The lattice points around a body. */
typedef struct {
  PetscInt64 full, parts; /* cells inside the body, and points of the others that are */
  PetscReal  target;      /* the body's volume over that of a lattice cell */
  PetscReal  length;      /* rings: the body's volume over the area of a lattice cell, m */
  PetscReal  bound;       /* of the level, m */
  PetscInt   sure;        /* points deeper inside than the bound */
  PetscInt   n;           /* points next to the surface */
  PetscReal *distance;    /* [n] of these points from the surface, m, ascending */
} Shells;

/* The ranks that share a lattice. Each rank walks through all rings, for they add up lengths, which must not depend on
   the number of ranks. */
static MPI_Comm LatticeComm(Domain domain)
{
  return domain->rings ? PETSC_COMM_SELF : domain->comm;
}

/* Adds up the shells of the ranks' shares. The sums are of integers, so they do not depend on the number of ranks. */
static PetscErrorCode ShareShells(MPI_Comm comm, Shells *shells)
{
  PetscInt64 sum[3] = {shells->full, shells->parts, shells->sure};
  PetscReal *distance;
  PetscInt   total;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 3, MPIU_INT64, MPI_SUM, comm));
  PetscCall(GatherAll(comm, shells->n, shells->distance, MPIU_REAL, &total, &distance));
  PetscCall(PetscFree(shells->distance));
  shells->distance = distance;
  shells->n        = total;
  shells->full     = sum[0];
  shells->parts    = sum[1];
  shells->sure     = (PetscInt)sum[2];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CollectShells(Packing packing, PetscInt b, const Lattice *lattice, Shells *shells)
{
  const Domain    domain = packing->cloud->domain;
  const Scene     scene  = packing->cloud->scene;
  const Body      body   = SceneBody(scene, b);
  const PetscReal reach  = 0.5 * domain->spacing * domain->dim; /* the surface crosses no cell farther away */
  const PetscBool cut    = (PetscBool)(domain->rings && b > 0 && SceneBodiesOverlap(scene));
  PetscSegBuffer  near;
  PetscInt        first, last;
  size_t          n;

  PetscFunctionBegin;
  OwnShare(LatticeComm(domain), LatticeCount(lattice), &first, &last);
  *shells = (Shells){.bound = PETSC_MAX_REAL};
  for (PetscInt d = 0; d < domain->dim; d++) shells->bound = PetscMin(shells->bound, LEVEL_MAX * lattice->pitch[d]);
  shells->bound *= 1 - POINT_TOLERANCE; /* below the depth of the outermost points of a fitting body */
  PetscCall(PetscSegBufferCreate(sizeof(PetscReal), 1024, &near));
  for (PetscInt point = first; point < last; point++) {
    PetscReal x[DIM], placed[DIM], s, solid, *kept, length;
    PetscBool inside;

    LatticePoint(lattice, point, x);
    for (PetscInt d = 0; d < DIM; d++) placed[d] = x[d];
    BodyDisplace(body, placed);
    inside = InsideBox(domain, placed);
    s      = PointDistance(packing, b, point, placed);
    solid  = domain->rings ? SceneSolidDistance(scene, placed, NULL) : PETSC_MAX_REAL;
    length = inside && solid > 0 ? 2 * PETSC_PI * x[0] : 0;
    if (PetscAbsReal(s) <= reach)
      shells->parts += CellInside(scene, domain, lattice, b, x, &length);
    else if (s < 0 && (PetscAbsReal(solid) <= reach || cut))
      (void)CellInside(scene, domain, lattice, b, x, &length);
    if (s < -reach) shells->full += inside;
    if (s <= reach) shells->length += length;
    if (!inside || s > shells->bound) continue;
    if (s < -shells->bound)
      shells->sure++;
    else {
      PetscCall(PetscSegBufferGet(near, 1, &kept));
      *kept = s;
    }
  }
  PetscCall(PetscSegBufferGetSize(near, &n));
  PetscCall(PetscSegBufferExtractAlloc(near, &shells->distance));
  PetscCall(PetscSegBufferDestroy(&near));
  shells->n = (PetscInt)n;
  PetscCall(ShareShells(LatticeComm(domain), shells));
  shells->target = (PetscReal)shells->full + (PetscReal)shells->parts / CellPoints(domain);
  PetscCall(PetscSortReal(shells->n, shells->distance));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The level with which the number of points is nearest to the target. A shell of points at equal distance (within
   'tolerance', m) may be taken in part unless it is a flat layer. */
static PetscReal ChooseLevel(const Shells *shells, PetscReal tolerance)
{
  const PetscInt   n        = shells->n;
  const PetscReal *distance = shells->distance;
  PetscReal        best = PETSC_MAX_REAL, level = 0;

  for (PetscInt k = 0, first = 0; k <= n; k++) { /* take the first k points; first: of the k-th point's shell */
    const PetscReal low = k > 0 ? distance[k - 1] : -shells->bound, high = k < n ? distance[k] : shells->bound;
    const PetscReal miss   = PetscAbsReal((PetscReal)(shells->sure + k) - shells->target);
    const PetscBool within = (PetscBool)(k > 0 && k < n && high - low < tolerance); /* the level would divide a shell */
    PetscInt        last   = k;

    if (!within) first = k;
    while (last < n && distance[last] - distance[first] < tolerance) last++;
    if (miss > best - 0.5 || (within && last - first >= SHELL_SPLIT * n)) continue;
    best  = miss;
    level = low < 0 && high > 0 && !within ? 0 : 0.5 * (low + high);
  }
  return level;
}

/* *level: lattice points at a smaller signed distance (m) fill the body, so that their number is the body's volume over
   that of a lattice cell. With the level 0 a small sphere would be up to a fifth too light or heavy. At most LEVEL_MAX
   pitches from 0. *length: the volume of the body as rings over the area of a lattice cell, m. */
static PetscErrorCode FitLevel(Packing packing, PetscInt b, PetscReal *level, PetscReal *length)
{
  const Domain domain = packing->cloud->domain;
  Lattice      lattice;
  Shells       shells;

  PetscFunctionBegin;
  LatticeOfBody(domain, domain->spacing, SceneBody(packing->cloud->scene, b), &lattice);
  PetscCall(CollectShells(packing, b, &lattice, &shells));
  *level  = ChooseLevel(&shells, POINT_TOLERANCE * domain->spacing);
  *length = shells.length;
  PetscCall(PetscFree(shells.distance));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode LatticeFit(Packing packing, PetscReal level[SCENE_MAX_BODIES], PetscReal length[SCENE_MAX_BODIES])
{
  const Scene scene = packing->cloud->scene;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    level[b] = -PETSC_MAX_REAL; /* an emitter has no lattice points */
    if (!BodyComesLater(SceneBody(scene, b))) PetscCall(FitLevel(packing, b, &level[b], &length[b]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes samples of the points first to last - 1 of body b's lattice, before the jitter and without numbers. */
static PetscErrorCode FindSamples(Packing packing, PetscInt b, const Lattice *lattice, PetscInt first, PetscInt last,
                                  const PetscReal level[], PetscInt *n, Sample **samples)
{
  const Domain   domain = packing->cloud->domain;
  PetscSegBuffer found;

  PetscFunctionBegin;
  PetscCall(PetscSegBufferCreate(sizeof(Sample), 1024, &found));
  for (PetscInt point = first; point < last; point++) {
    Sample    sample = {.body = b};
    PetscReal length;

    LatticePoint(lattice, point, sample.x);
    length = DomainRingLength(domain, sample.x, 1);
    BodyDisplace(SceneBody(packing->cloud->scene, b), sample.x);
    sample.area = length / DomainRingLength(domain, sample.x, 1); /* a displaced ring keeps its volume */
    if (LatticeBelongs(packing, level, b, point, sample.x)) PetscCall(SampleKeep(found, &sample));
  }
  PetscCall(SamplesTake(&found, n, samples));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Settling evens the liquid out along a surface, and leaves its roughness: a sheet of five particles got up to a fifth
   more energy from the surface tension of a jitter of 0.2, whatever its surface. What is held stays as it is. */
void LatticeShake(Packing packing, PetscReal spacing, Sample *sample)
{
  const Domain             domain = packing->cloud->domain;
  const Body               body   = SceneBody(packing->cloud->scene, sample->body);
  const unsigned long long seed   = (unsigned long long)packing->seed;
  const PetscBool rough  = (PetscBool)(packing->rough || PetscAbsReal(BodyDistance(body, sample->x)) < spacing ||
                                      BodyHolds(body, sample->x, 0.5 * spacing));
  const PetscReal share  = rough ? ROUGH_JITTER : 1,
                  jitter = share * ((const LatticeData *)packing->data)->jitter * spacing;

  for (PetscInt d = 0; d < domain->dim; d++)
    sample->x[d] += jitter * (2 * RandomUnit(seed, (unsigned long long)sample->id * DIM + (unsigned long long)d) - 1);
  DomainConfine(domain, sample->x);
}

/* Passes this rank's share of the points of body b to the visitor; comm: the ranks that share them. All rings have one
   area, with which they have the body's volume. length: see LatticeFit. *id: the number of the body's first particle,
   then of the next body's. shaken: with the jitter. */
static PetscErrorCode VisitBody(Packing packing, PetscInt b, MPI_Comm comm, const PetscReal level[], PetscReal length,
                                PetscBool shaken, SampleVisitor visitor, void *context, PetscInt *id)
{
  const Domain   domain = packing->cloud->domain;
  const MPI_Comm walk   = domain->rings ? PETSC_COMM_SELF : comm;
  PetscReal      area = 1, sum = 0;
  PetscInt       n, first, last, before, all;
  Sample        *sample;
  Lattice        lattice;

  PetscFunctionBegin;
  LatticeOfBody(domain, domain->spacing, SceneBody(packing->cloud->scene, b), &lattice);
  OwnShare(walk, LatticeCount(&lattice), &first, &last);
  PetscCall(FindSamples(packing, b, &lattice, first, last, level, &n, &sample));
  PetscCall(OwnNumbers(walk, n, &before, &all));
  for (PetscInt k = 0; k < n; k++) {
    sample[k].id = sample[k].parent = *id + before + k;
    if (shaken) LatticeShake(packing, domain->spacing, &sample[k]);
    sum += sample[k].area * DomainRingLength(domain, sample[k].x, 1);
  }
  if (domain->rings) area = lattice.pitch[0] * lattice.pitch[1] / domain->volume * (sum > 0 ? length / sum : 1);
  OwnShare(domain->rings ? comm : PETSC_COMM_SELF, n, &first, &last);
  for (PetscInt k = first; k < last; k++) {
    sample[k].area *= area;
    PetscCall(visitor(context, &sample[k]));
  }
  *id += all;
  PetscCall(PetscFree(sample));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Visit_Lattice(void *source, SampleVisitor visitor, void *context)
{
  const Packing packing = (Packing)source;
  const Scene   scene   = packing->cloud->scene;
  PetscReal     level[SCENE_MAX_BODIES], length[SCENE_MAX_BODIES];
  PetscInt      id = 0;

  PetscFunctionBegin;
  PetscCall(LatticeFit(packing, level, length));
  for (PetscInt b = 0; b < SceneCount(scene); b++)
    if (!BodyComesLater(SceneBody(scene, b)))
      PetscCall(VisitBody(packing, b, packing->cloud->comm, level, length[b], PETSC_TRUE, visitor, context, &id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode LatticeVisitBody(Packing packing, PetscInt body, PetscBool shaken, SampleVisitor visitor, void *context)
{
  PetscReal level[SCENE_MAX_BODIES], length;
  PetscInt  id = 0;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < SCENE_MAX_BODIES; b++) level[b] = -PETSC_MAX_REAL;
  PetscCall(FitLevel(packing, body, &level[body], &length));
  PetscCall(VisitBody(packing, body, PETSC_COMM_SELF, level, length, shaken, visitor, context, &id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const OptionRow options[] = {
  {"-packing_jitter",
   "Largest random displacement from the lattice, of each component; half of it within a spacing of a surface",
   "spacings", "[0, 0.5)", ROW_REAL, offsetof(LatticeData, jitter)},
  {.name = NULL},
};

static void Defaults(void *owner)
{
  ((LatticeData *)((Packing)owner)->data)->jitter = 0.2; /* 0.1, once evened out, lets a drop that is stretched swell */
}

const PackingOps PackingLattice = {.choice = {"lattice", sizeof(LatticeData), options, Defaults, NULL},
                                   .visit  = Visit_Lattice};
