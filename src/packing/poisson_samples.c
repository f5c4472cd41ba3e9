/* The samples that -packing_type poisson starts from: random points at a distance from each other (Schechter & Bridson
   2012, Ghost SPH for animating water, Sec. 4), first on the free surface, then in the volume. Three things differ from
   that paper. The surface samples are half a spacing inside the surface, as centres of particles must be. The volume is
   filled by plain darts whose distance shrinks until there are V / d0^dim of them, the number that can reach rho_0. TAO
   takes the place of their relaxation. */
#include "packing_impl.h"

/* Lengths in spacings. All numbers were found by trial on drops and films; TAO tolerates changes of each. */
/* first distance of the darts, on the surface and in the volume; V / d0^3 fit 0.90 at most */
#define FIRST_RADIUS  0.95
#define RADIUS_SHRINK 0.98 /* factor on the distance in the volume ... */
#define PLACED_LEAST  0.03 /* ... when less than this part of the darts in the core is accepted */
/* a body that has no room for its samples at this distance is too thin for the skin ... */
#define RADIUS_SMALLEST 0.6
#define SKIN_SHRINK     0.5  /* ... which takes this factor ... */
#define SKIN_SMALLEST   0.05 /* ... down to this depth */
#define SURFACE_DARTS   15   /* thrown into a grid cell that the surface crosses */
#define VOLUME_DARTS    2    /* thrown in a batch for each missing sample, and ... */
#define VOLUME_DARTS_0  1000 /* ... so many more */
#define SKIN            0.5  /* spacings below the surface, where the first layer of a lattice lies */
#define PROJECTIONS     4    /* of a dart onto the surface, by Newton's method */
#define ON_SURFACE      1e-3 /* a dart this close to the surface is on it */
#define FOOT_OFF        0.1  /* largest distance of the foot of a normal from the surface */
#define SUBCELLS        6    /* in each direction: the share of a cell inside the body is exact to about 1 % */
#define NOBODY          (-1)
#define WATCH_AFTER     4096 /* darts: between two looks at the clock */

typedef struct {
  Domain             domain;
  PetscReal          spacing; /* m */
  unsigned long long seed, draws;
  Body               body;                   /* being filled */
  PetscReal          lower[DIM], upper[DIM]; /* of the body, m */
  PetscReal          skin, skin_first;       /* depth of the surface samples, now and at first, m */
  PetscReal          radius;                 /* m */
  /* A grid of cells at least one spacing wide over all bodies; lists of samples through head and next. */
  PetscReal  grid_lower[DIM], cell[DIM];
  PetscInt   cells[DIM], *head, *next;
  PetscInt   n, total; /* samples, and samples wanted for all bodies */
  PetscReal *x;        /* [n][3] m */
} Darts;

/* The next random number. */
static PetscReal Draw(Darts *darts)
{
  return RandomUnit(darts->seed, darts->draws++);
}

/* The cell of the grid that contains x; outside the grid the nearest cell. */
static void FindCell(const Darts *darts, const PetscReal x[DIM], PetscInt cell[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscInt c = (PetscInt)PetscFloorReal((x[d] - darts->grid_lower[d]) / darts->cell[d]);

    cell[d] = PetscMax(0, PetscMin(darts->cells[d] - 1, c));
  }
}

/* Squared distance of x to a sample, to its nearest image where the box is periodic. */
static PetscReal SampleDistance2(const Darts *darts, const PetscReal x[DIM], PetscInt sample)
{
  PetscReal sum = 0;

  for (PetscInt d = 0; d < darts->domain->dim; d++) {
    PetscReal r = PetscAbsReal(x[d] - darts->x[DIM * sample + d]);

    if (darts->domain->face[d][0] == FACE_PERIODIC)
      r = PetscMin(r, darts->domain->upper[d] - darts->domain->lower[d] - r);
    sum += r * r;
  }
  return sum;
}

/* Whether x is far enough from the dummies of a wall and from its own image in a mirror. */
static PetscBool ClearOfFaces(const Darts *darts, const PetscReal x[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) {
    const FaceType *face = darts->domain->face[d];

    if ((face[0] == FACE_WALL || face[0] == FACE_SYMMETRY) && x[d] < darts->domain->lower[d] + 0.5 * darts->radius)
      return PETSC_FALSE;
    if ((face[1] == FACE_WALL || face[1] == FACE_SYMMETRY) && x[d] > darts->domain->upper[d] - 0.5 * darts->radius)
      return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* The cell at an offset from another, across periodic faces; returns whether it exists. */
static PetscBool ShiftCell(const Darts *darts, const PetscInt from[DIM], const PetscInt offset[DIM], PetscInt cell[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) {
    cell[d] = from[d] + offset[d];
    if (darts->domain->face[d][0] == FACE_PERIODIC)
      cell[d] = (cell[d] + darts->cells[d]) % darts->cells[d];
    else if (cell[d] < 0 || cell[d] >= darts->cells[d])
      return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* Whether a sample may be at x: far enough from walls, mirrors and other samples. */
static PetscBool IsFree(const Darts *darts, const PetscReal x[DIM])
{
  const PetscInt last[DIM] = {1, 1, darts->domain->dim == DIM ? 1 : 0}, first[DIM] = {-1, -1, -last[2]};
  PetscInt       center[DIM], cell[DIM], offset[DIM] = {first[0], first[1], first[2]};

  if (!ClearOfFaces(darts, x)) return PETSC_FALSE;
  FindCell(darts, x, center);
  do {
    if (!ShiftCell(darts, center, offset, cell)) continue;
    for (PetscInt s = darts->head[CellIndex(darts->cells, cell[0], cell[1], cell[2])]; s != NOBODY; s = darts->next[s])
      if (SampleDistance2(darts, x, s) < PetscSqr(darts->radius)) return PETSC_FALSE;
  } while (CellNext(first, last, offset));
  return PETSC_TRUE;
}

static void AddSample(Darts *darts, const PetscReal x[DIM])
{
  PetscInt cell[DIM], index;

  FindCell(darts, x, cell);
  index = CellIndex(darts->cells, cell[0], cell[1], cell[2]);
  for (PetscInt d = 0; d < DIM; d++) darts->x[DIM * darts->n + d] = x[d];
  darts->next[darts->n] = darts->head[index];
  darts->head[index]    = darts->n++;
}

/* Outward normal of the body at x by central differences, zero where the distance is flat. */
static void Normal(const Darts *darts, const PetscReal x[DIM], PetscReal normal[DIM])
{
  const PetscReal step = ON_SURFACE * darts->spacing;
  PetscReal       size;

  for (PetscInt d = 0; d < DIM; d++) {
    PetscReal low[DIM] = {x[0], x[1], x[2]}, high[DIM] = {x[0], x[1], x[2]};

    low[d] -= step;
    high[d] += step;
    normal[d] =
      d < darts->domain->dim ? (BodyDistance(darts->body, high) - BodyDistance(darts->body, low)) / (2 * step) : 0;
  }
  size = Norm(normal);
  for (PetscInt d = 0; d < DIM && size > 0; d++) normal[d] /= size;
}

/* Whether the surface next to x, at distance s (negative inside), is free: its nearest point is in the box and not on a
   closed face, where an image continues the liquid or a wall bounds it. False where no normal leads to the surface, as
   between two faces of a box. */
static PetscBool IsFreeSurface(const Darts *darts, const PetscReal x[DIM], PetscReal s, const PetscReal normal[DIM])
{
  const PetscReal tiny = ON_SURFACE * darts->spacing;
  PetscReal       foot[DIM];

  for (PetscInt d = 0; d < DIM; d++) foot[d] = x[d] - s * normal[d];
  for (PetscInt d = 0; d < darts->domain->dim; d++) {
    if (darts->domain->face[d][0] != FACE_OPEN && foot[d] < darts->domain->lower[d] + tiny) return PETSC_FALSE;
    if (darts->domain->face[d][1] != FACE_OPEN && foot[d] > darts->domain->upper[d] - tiny) return PETSC_FALSE;
  }
  return (PetscBool)(Norm(normal) == 0 || PetscAbsReal(BodyDistance(darts->body, foot)) < FOOT_OFF * darts->spacing);
}

/* Whether x is in the body and below its skin. */
static PetscBool InCore(const Darts *darts, const PetscReal x[DIM])
{
  const PetscReal s = BodyDistance(darts->body, x);
  PetscReal       normal[DIM];

  if (s > -POINT_TOLERANCE * darts->spacing || !BodyContains(darts->body, x)) return PETSC_FALSE;
  if (s <= -darts->skin) return PETSC_TRUE;
  Normal(darts, x, normal);
  return (PetscBool)!IsFreeSurface(darts, x, s, normal);
}

/* Moves x along the normal to the surface of the core; false if this fails or the surface is not free. */
static PetscBool ProjectToSkin(const Darts *darts, PetscReal x[DIM])
{
  PetscReal normal[DIM] = {0, 0, 0}, s = BodyDistance(darts->body, x);

  for (PetscInt pass = 0; pass < PROJECTIONS; pass++) {
    Normal(darts, x, normal);
    for (PetscInt d = 0; d < DIM; d++) x[d] -= (s + darts->skin) * normal[d];
    s = BodyDistance(darts->body, x);
  }
  return (PetscBool)(PetscAbsReal(s + darts->skin) < ON_SURFACE * darts->spacing && BodyContains(darts->body, x) &&
                     IsFreeSurface(darts, x, s, normal));
}

/* Prints the line of progress; one rank does this work. */
static PetscErrorCode Watch(const Darts *darts)
{
  PetscFunctionBegin;
  PetscCall(ProgressWork(PETSC_COMM_SELF, (PetscReal)darts->n / PetscMax(1, darts->total),
                         "%" PetscInt_FMT " of %" PetscInt_FMT " random samples", darts->n, darts->total));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Throws darts into the cells of the grid that the surface of the core may cross. */
static PetscErrorCode SampleSurface(Darts *darts, PetscInt most)
{
  const PetscReal half = 0.5 * Norm(darts->cell);
  PetscInt        first[DIM], last[DIM], cell[DIM], looked = 0;
  PetscReal       x[DIM] = {0, 0, 0};

  PetscFunctionBegin;
  darts->radius = FIRST_RADIUS * darts->spacing;
  FindCell(darts, darts->lower, first);
  FindCell(darts, darts->upper, last);
  FindCell(darts, darts->lower, cell);
  do {
    if (looked++ % (WATCH_AFTER / SURFACE_DARTS) == 0) PetscCall(Watch(darts));
    for (PetscInt d = 0; d < darts->domain->dim; d++) x[d] = darts->grid_lower[d] + (cell[d] + 0.5) * darts->cell[d];
    if (PetscAbsReal(BodyDistance(darts->body, x) + darts->skin) > half) continue;
    for (PetscInt dart = 0; dart < SURFACE_DARTS && darts->n < most; dart++) {
      for (PetscInt d = 0; d < darts->domain->dim; d++)
        x[d] = darts->grid_lower[d] + (cell[d] + Draw(darts)) * darts->cell[d];
      if (ProjectToSkin(darts, x) && IsFree(darts, x)) AddSample(darts, x);
    }
  } while (CellNext(first, last, cell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Throws darts into the core until there are 'most' samples, or until too few darts are accepted. */
static PetscErrorCode SampleVolume(Darts *darts, PetscInt most)
{
  PetscFunctionBegin;
  darts->radius = FIRST_RADIUS * darts->spacing;
  while (darts->n < most) {
    const PetscInt missing = most - darts->n, batch = VOLUME_DARTS * missing + VOLUME_DARTS_0;
    PetscInt       inside = 0;

    for (PetscInt dart = 0; dart < batch && darts->n < most; dart++) {
      PetscReal x[DIM] = {0, 0, 0};

      if (dart % WATCH_AFTER == 0) PetscCall(Watch(darts));
      for (PetscInt d = 0; d < darts->domain->dim; d++)
        x[d] = darts->lower[d] + Draw(darts) * (darts->upper[d] - darts->lower[d]);
      if (!InCore(darts, x)) continue;
      inside++;
      if (IsFree(darts, x)) AddSample(darts, x);
    }
    if (missing - (most - darts->n) >= PLACED_LEAST * inside && inside > 0) continue;
    darts->radius *= RADIUS_SHRINK;
    if (darts->radius >= RADIUS_SMALLEST * darts->spacing) continue;
    darts->skin *= SKIN_SHRINK;
    darts->radius = FIRST_RADIUS * darts->spacing;
    if (darts->skin < SKIN_SMALLEST * darts->spacing) break;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The share inside the body of cell 'at', of a grid with these edges (m) from the body's lower corner on. */
static PetscReal CellShare(const Darts *darts, const PetscInt at[DIM], const PetscReal edge[DIM])
{
  const PetscInt n[DIM] = {SUBCELLS, SUBCELLS, darts->domain->dim == DIM ? SUBCELLS : 1}, points = n[0] * n[1] * n[2];
  PetscInt       inside = 0;

  for (PetscInt p = 0; p < points; p++) {
    PetscReal y[DIM] = {0, 0, 0};
    PetscInt  part[DIM];

    CellCoordinates(n, p, part);
    for (PetscInt d = 0; d < darts->domain->dim; d++)
      y[d] = darts->lower[d] + (at[d] + (part[d] + 0.5) / n[d]) * edge[d];
    inside += BodyContains(darts->body, y);
  }
  return (PetscReal)inside / points;
}

/* The volume (in two dimensions the area) of the body in the box over that of a particle, from cells of about one
   spacing. */
static PetscReal CountParticles(const Darts *darts)
{
  PetscReal edge[DIM] = {0, 0, 0}, half, volume = 1, sum = 0;
  PetscInt  n[DIM] = {1, 1, 1};

  for (PetscInt d = 0; d < darts->domain->dim; d++) {
    n[d]    = PetscMax(1, (PetscInt)PetscFloorReal((darts->upper[d] - darts->lower[d]) / darts->spacing + 0.5));
    edge[d] = (darts->upper[d] - darts->lower[d]) / n[d];
    volume *= edge[d];
  }
  half = 0.5 * Norm(edge);
  for (PetscInt c = 0; c < n[0] * n[1] * n[2]; c++) {
    PetscReal x[DIM] = {0, 0, 0}, s;
    PetscInt  at[DIM];

    CellCoordinates(n, c, at);
    for (PetscInt d = 0; d < darts->domain->dim; d++) x[d] = darts->lower[d] + (at[d] + 0.5) * edge[d];
    s = BodyDistance(darts->body, x);
    if (s < -half) sum += 1;
    if (PetscAbsReal(s) > half) continue;
    sum += CellShare(darts, at, edge);
  }
  return sum * volume / darts->domain->volume;
}

static void SelectBody(Darts *darts, Body body)
{
  darts->body = body;
  darts->skin = darts->skin_first;
  BodyBounds(body, darts->lower, darts->upper);
  for (PetscInt d = 0; d < DIM; d++) {
    darts->lower[d] = PetscMax(darts->lower[d], darts->domain->lower[d]);
    darts->upper[d] = PetscMin(darts->upper[d], darts->domain->upper[d]);
  }
}

/* The grid over all bodies, over the whole box in periodic directions; room for 'capacity' samples. */
static PetscErrorCode GridCreate(Darts *darts, Scene scene, PetscInt capacity)
{
  PetscReal upper[DIM];
  PetscInt  count = 1;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    SelectBody(darts, SceneBody(scene, b));
    for (PetscInt d = 0; d < DIM; d++) {
      darts->grid_lower[d] = b ? PetscMin(darts->grid_lower[d], darts->lower[d]) : darts->lower[d];
      upper[d]             = b ? PetscMax(upper[d], darts->upper[d]) : darts->upper[d];
    }
  }
  for (PetscInt d = 0; d < DIM; d++) {
    if (darts->domain->face[d][0] == FACE_PERIODIC) {
      darts->grid_lower[d] = darts->domain->lower[d];
      upper[d]             = darts->domain->upper[d];
    }
    darts->cells[d] = 1;
    if (d < darts->domain->dim) {
      darts->cells[d] = PetscMax(1, (PetscInt)PetscFloorReal((upper[d] - darts->grid_lower[d]) / darts->spacing));
    }
    darts->cell[d] = (upper[d] - darts->grid_lower[d]) / darts->cells[d];
    PetscCall(PetscIntMultError(count, darts->cells[d], &count));
  }
  PetscCall(PetscMalloc3(count, &darts->head, capacity, &darts->next, DIM * capacity, &darts->x));
  for (PetscInt c = 0; c < count; c++) darts->head[c] = NOBODY;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PoissonSample(Packing packing, PetscInt *n, PetscReal **x, PetscInt **body)
{
  const Scene scene = packing->cloud->scene;
  Darts       darts = {.domain = packing->cloud->domain, .seed = (unsigned long long)packing->seed};
  PetscInt    wanted[SCENE_MAX_BODIES];

  PetscFunctionBegin;
  darts.spacing    = darts.domain->spacing;
  darts.skin_first = SKIN * darts.spacing;
  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    SelectBody(&darts, SceneBody(scene, b));
    wanted[b] = (PetscInt)PetscFloorReal(CountParticles(&darts) + 0.5);
    darts.total += wanted[b];
  }
  PetscCall(GridCreate(&darts, scene, darts.total));
  PetscCall(PetscMalloc1(darts.total, body));
  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    const PetscInt before = darts.n;

    SelectBody(&darts, SceneBody(scene, b));
    PetscCall(SampleSurface(&darts, before + wanted[b]));
    PetscCall(PetscInfo(NULL, "packing %s: %" PetscInt_FMT " samples, %" PetscInt_FMT " on the surface\n",
                        BodyName(darts.body), wanted[b], darts.n - before));
    PetscCall(SampleVolume(&darts, before + wanted[b]));
    PetscCall(PetscInfo(NULL, "packing %s: %" PetscInt_FMT " samples at least %g spacings apart, skin %g\n",
                        BodyName(darts.body), darts.n - before, (double)(darts.radius / darts.spacing),
                        (double)(darts.skin / darts.spacing)));
    for (PetscInt a = before; a < darts.n; a++) (*body)[a] = b;
  }
  *n = darts.n;
  PetscCall(PetscMalloc1(DIM * darts.n, x));
  PetscCall(PetscArraycpy(*x, darts.x, DIM * darts.n));
  PetscCall(PetscFree3(darts.head, darts.next, darts.x));
  PetscFunctionReturn(PETSC_SUCCESS);
}
