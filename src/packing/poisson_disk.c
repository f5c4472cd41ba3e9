/* Random samples at a distance from each other: Schechter & Bridson 2012 (Ghost SPH for animating water, Sec. 4), first
   the free surface, then the volume. Departures: the samples stand half a spacing inside the surface, where the centres
   of particles belong; the volume is filled by plain darts whose distance shrinks until there are V / d0^dim of them,
   the number that can reach rho_0; TAO takes the place of their relaxation. */
#include "packing_impl.h"

#define SURFACE_RADIUS  0.95 /* first distance between surface samples, spacings */
#define SURFACE_DARTS   15   /* a grid cell crossed by the surface */
#define SURFACE_NEWTON  4    /* projections of a dart onto the surface */
#define SURFACE_PRECISE 1e-3 /* distance from the surface that is on it, spacings */
#define SURFACE_FOOT    0.1  /* how far the foot of a normal may be from the surface, spacings */
#define VOLUME_RADIUS   0.95 /* first distance of darts in the volume, spacings; 0.90 is the most for V / d0^3 darts */
#define VOLUME_SHRINK   0.98 /* when ... */
#define VOLUME_POOR     0.03 /* ... less than this part of the darts in the core finds a place */
#define VOLUME_BATCH    2    /* darts thrown a batch, over the missing samples */
#define RADIUS_SMALLEST 0.6  /* spacings; a body that does not hold its samples then is too thin for the skin */
#define SKIN            0.5  /* depth of the surface samples, spacings */
#define SKIN_SMALLEST   0.05
#define SUBCELLS        6 /* a direction, to measure cells that the surface crosses */
#define NOBODY          (-1)

typedef struct {
  Domain             domain;
  PetscReal          spacing; /* m */
  unsigned long long seed, draws;
  Body               body;                   /* that is being filled */
  PetscReal          lower[DIM], upper[DIM]; /* of it, m */
  PetscReal          skin;                   /* m */
  PetscReal          radius;                 /* m */
  /* A grid of cells at least one spacing wide over all bodies; lists of samples through head and next. */
  PetscReal  grid_lower[DIM], cell[DIM];
  PetscInt   cells[DIM], *head, *next;
  PetscInt   n;
  PetscReal *x; /* [n][3] m */
} Darts;

static PetscReal Draw(Darts *darts)
{
  return RandomUnit(darts->seed, darts->draws++);
}

static void CellOf(const Darts *darts, const PetscReal x[DIM], PetscInt cell[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscInt c = (PetscInt)PetscFloorReal((x[d] - darts->grid_lower[d]) / darts->cell[d]);

    cell[d] = PetscMax(0, PetscMin(darts->cells[d] - 1, c));
  }
}

static inline PetscInt Place(const Darts *darts, const PetscInt cell[DIM])
{
  return (cell[2] * darts->cells[1] + cell[1]) * darts->cells[0] + cell[0];
}

/* Squared distance of x to a sample, to its nearest image where the box is periodic. */
static PetscReal Distance2(const Darts *darts, const PetscReal x[DIM], PetscInt sample)
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

/* Whether a sample may stand at x: far enough from the others, from its own mirror image and from the dummies of a
   wall. */
static PetscBool Free(const Darts *darts, const PetscReal x[DIM])
{
  PetscInt center[DIM], width[DIM], cell[DIM];

  for (PetscInt d = 0; d < DIM; d++) {
    const FaceType *face = darts->domain->face[d];

    width[d] = d < darts->domain->dim;
    if ((face[0] == FACE_WALL || face[0] == FACE_SYMMETRY) && x[d] < darts->domain->lower[d] + 0.5 * darts->radius)
      return PETSC_FALSE;
    if ((face[1] == FACE_WALL || face[1] == FACE_SYMMETRY) && x[d] > darts->domain->upper[d] - 0.5 * darts->radius)
      return PETSC_FALSE;
  }
  CellOf(darts, x, center);
  for (PetscInt k = -width[2]; k <= width[2]; k++) {
    for (PetscInt j = -width[1]; j <= width[1]; j++) {
      for (PetscInt i = -width[0]; i <= width[0]; i++) {
        const PetscInt offset[DIM] = {i, j, k};
        PetscBool      valid       = PETSC_TRUE;

        for (PetscInt d = 0; d < DIM; d++) {
          cell[d] = center[d] + offset[d];
          if (darts->domain->face[d][0] == FACE_PERIODIC)
            cell[d] = (cell[d] + darts->cells[d]) % darts->cells[d];
          else
            valid = (PetscBool)(valid && cell[d] >= 0 && cell[d] < darts->cells[d]);
        }
        if (!valid) continue;
        for (PetscInt s = darts->head[Place(darts, cell)]; s != NOBODY; s = darts->next[s])
          if (Distance2(darts, x, s) < PetscSqr(darts->radius)) return PETSC_FALSE;
      }
    }
  }
  return PETSC_TRUE;
}

static void Add(Darts *darts, const PetscReal x[DIM])
{
  PetscInt cell[DIM], place;

  CellOf(darts, x, cell);
  place = Place(darts, cell);
  for (PetscInt d = 0; d < DIM; d++) darts->x[DIM * darts->n + d] = x[d];
  darts->next[darts->n] = darts->head[place];
  darts->head[place]    = darts->n++;
}

/* Outward normal of the body at x by central differences, zero where the distance is flat. */
static void Normal(const Darts *darts, const PetscReal x[DIM], PetscReal normal[DIM])
{
  const PetscReal step = SURFACE_PRECISE * darts->spacing;
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

/* Whether the surface next to x, at distance s (negative inside), is a free one: its nearest point is in the box and
   not on a closed face, where the liquid goes on as an image or meets a wall. Not so where no normal leads to the
   surface, as between two faces of a box. */
static PetscBool FreeSurface(const Darts *darts, const PetscReal x[DIM], PetscReal s, const PetscReal normal[DIM])
{
  const PetscReal tiny = SURFACE_PRECISE * darts->spacing;
  PetscReal       foot[DIM];

  for (PetscInt d = 0; d < DIM; d++) foot[d] = x[d] - s * normal[d];
  for (PetscInt d = 0; d < darts->domain->dim; d++) {
    if (darts->domain->face[d][0] != FACE_OPEN && foot[d] < darts->domain->lower[d] + tiny) return PETSC_FALSE;
    if (darts->domain->face[d][1] != FACE_OPEN && foot[d] > darts->domain->upper[d] - tiny) return PETSC_FALSE;
  }
  return (PetscBool)(Norm(normal) == 0 ||
                     PetscAbsReal(BodyDistance(darts->body, foot)) < SURFACE_FOOT * darts->spacing);
}

/* Whether x is in the body and below its skin. */
static PetscBool InCore(const Darts *darts, const PetscReal x[DIM])
{
  const PetscReal s = BodyDistance(darts->body, x);
  PetscReal       normal[DIM];

  if (s > -ROUNDING * darts->spacing || !BodyContains(darts->body, x)) return PETSC_FALSE;
  if (s <= -darts->skin) return PETSC_TRUE;
  Normal(darts, x, normal);
  return (PetscBool)!FreeSurface(darts, x, s, normal);
}

/* Takes x to the surface of the core along the normal; false if that fails or the surface is not free. */
static PetscBool Project(const Darts *darts, PetscReal x[DIM])
{
  PetscReal normal[DIM] = {0, 0, 0}, s = BodyDistance(darts->body, x);

  for (PetscInt pass = 0; pass < SURFACE_NEWTON; pass++) {
    Normal(darts, x, normal);
    for (PetscInt d = 0; d < DIM; d++) x[d] -= (s + darts->skin) * normal[d];
    s = BodyDistance(darts->body, x);
  }
  return (PetscBool)(PetscAbsReal(s + darts->skin) < SURFACE_PRECISE * darts->spacing && BodyContains(darts->body, x) &&
                     FreeSurface(darts, x, s, normal));
}

/* Darts at the cells of the grid that the surface of the core may cross. */
static void SampleSurface(Darts *darts, PetscInt most)
{
  const PetscReal half = 0.5 * Norm(darts->cell);
  PetscInt        first[DIM], last[DIM];

  darts->radius = SURFACE_RADIUS * darts->spacing;
  CellOf(darts, darts->lower, first);
  CellOf(darts, darts->upper, last);
  for (PetscInt k = first[2]; k <= last[2]; k++) {
    for (PetscInt j = first[1]; j <= last[1]; j++) {
      for (PetscInt i = first[0]; i <= last[0]; i++) {
        const PetscInt at[DIM] = {i, j, k};
        PetscReal      x[DIM];

        for (PetscInt d = 0; d < DIM; d++)
          x[d] = d < darts->domain->dim ? darts->grid_lower[d] + (at[d] + 0.5) * darts->cell[d] : 0;
        if (PetscAbsReal(BodyDistance(darts->body, x) + darts->skin) > half) continue;
        for (PetscInt dart = 0; dart < SURFACE_DARTS && darts->n < most; dart++) {
          for (PetscInt d = 0; d < darts->domain->dim; d++)
            x[d] = darts->grid_lower[d] + (at[d] + Draw(darts)) * darts->cell[d];
          if (Project(darts, x) && Free(darts, x)) Add(darts, x);
        }
      }
    }
  }
}

/* Darts into the core until there are 'most' samples or no hope. */
static void SampleVolume(Darts *darts, PetscInt most)
{
  darts->radius = VOLUME_RADIUS * darts->spacing;
  while (darts->n < most) {
    const PetscInt missing = most - darts->n, batch = VOLUME_BATCH * missing + 1000;
    PetscInt       inside = 0;

    for (PetscInt dart = 0; dart < batch && darts->n < most; dart++) {
      PetscReal x[DIM] = {0, 0, 0};

      for (PetscInt d = 0; d < darts->domain->dim; d++)
        x[d] = darts->lower[d] + Draw(darts) * (darts->upper[d] - darts->lower[d]);
      if (!InCore(darts, x)) continue;
      inside++;
      if (Free(darts, x)) Add(darts, x);
    }
    if (missing - (most - darts->n) >= VOLUME_POOR * inside && inside > 0) continue;
    darts->radius *= VOLUME_SHRINK;
    if (darts->radius >= RADIUS_SMALLEST * darts->spacing) continue;
    darts->skin *= 0.5;
    darts->radius = VOLUME_RADIUS * darts->spacing;
    if (darts->skin < SKIN_SMALLEST * darts->spacing) break;
  }
}

/* Volume (area in two dimensions) of the body in the box over that of one particle, by cells of about one spacing. */
static PetscReal Measure(const Darts *darts)
{
  PetscReal cell[DIM] = {0, 0, 0}, half, volume = 1, sum = 0;
  PetscInt  n[DIM] = {1, 1, 1}, sub[DIM] = {1, 1, 1};

  for (PetscInt d = 0; d < darts->domain->dim; d++) {
    n[d]    = PetscMax(1, (PetscInt)PetscFloorReal((darts->upper[d] - darts->lower[d]) / darts->spacing + 0.5));
    cell[d] = (darts->upper[d] - darts->lower[d]) / n[d];
    sub[d]  = SUBCELLS;
    volume *= cell[d];
  }
  half = 0.5 * Norm(cell);
  for (PetscInt c = 0; c < n[0] * n[1] * n[2]; c++) {
    const PetscInt at[DIM] = {c % n[0], (c / n[0]) % n[1], c / (n[0] * n[1])};
    PetscReal      x[DIM]  = {0, 0, 0}, s;
    PetscInt       inside  = 0;

    for (PetscInt d = 0; d < darts->domain->dim; d++) x[d] = darts->lower[d] + (at[d] + 0.5) * cell[d];
    s = BodyDistance(darts->body, x);
    if (s < -half) sum += 1;
    if (PetscAbsReal(s) > half) continue;
    for (PetscInt p = 0; p < sub[0] * sub[1] * sub[2]; p++) {
      const PetscInt part[DIM] = {p % sub[0], (p / sub[0]) % sub[1], p / (sub[0] * sub[1])};

      for (PetscInt d = 0; d < darts->domain->dim; d++)
        x[d] = darts->lower[d] + (at[d] + (part[d] + 0.5) / sub[d]) * cell[d];
      inside += BodyContains(darts->body, x);
    }
    sum += (PetscReal)inside / (sub[0] * sub[1] * sub[2]);
  }
  return sum * volume / darts->domain->volume;
}

static void SelectBody(Darts *darts, Body body)
{
  darts->body = body;
  darts->skin = SKIN * darts->spacing;
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
  PetscInt    wanted[SCENE_MAX_BODIES], total = 0;

  PetscFunctionBegin;
  darts.spacing = darts.domain->spacing;
  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    SelectBody(&darts, SceneBody(scene, b));
    wanted[b] = (PetscInt)PetscFloorReal(Measure(&darts) + 0.5);
    total += wanted[b];
  }
  PetscCall(GridCreate(&darts, scene, total));
  PetscCall(PetscMalloc1(total, body));
  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    const PetscInt before = darts.n;

    SelectBody(&darts, SceneBody(scene, b));
    SampleSurface(&darts, before + wanted[b]);
    PetscCall(PetscInfo(NULL, "packing %s: %" PetscInt_FMT " samples, %" PetscInt_FMT " on the surface\n",
                        BodyName(darts.body), wanted[b], darts.n - before));
    SampleVolume(&darts, before + wanted[b]);
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
