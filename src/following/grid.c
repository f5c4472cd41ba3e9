/* The target of -spacing_follow: free surfaces, solids and emitters are sources, each with its own spacing. A grid over
   the box holds the least of (spacing of a source + growth times distance), by the chamfer distances 1, 4/3 and 5/3 of
   cells that share a face, an edge, a corner (Borgefors 1986). The distance is one through air, so a drop that comes
   near a pool makes the pool fine before they touch. */
#include "following_impl.h"

/* fine spacings from a free surface over which the spacing does not grow; the drop of a rings' impact is by 2.4 % of
   the largest diameter off, with 2 by 6.6 %, with 8, which has more particles, by 2.7 % */
#define BAND 4.
/* Spacings along the radius of curvature, 1 over the sum of the magnitudes of both principal curvatures: a drop of
   eight spacings across is fine all over. */
#define PER_RADIUS   4.
#define CELL         2.        /* fine spacings, least width of a cell */
#define CELLS_MOST   2000000   /* wider cells keep to this number */
#define CELL_GROWTH  1.1       /* factor by which they widen */
#define STENCIL      2.        /* fine spacings, step of the differences for the curvature of a body */
#define ACROSS       5.        /* particles across a sheet, which marked cells make 0.9 cells thicker than it is */
#define MARCH        0.5       /* cells, step of the search for the other side */
#define FILLED       0.75      /* spacings around a particle that count as liquid: disorder leaves no gap */
#define NEAR         1.2       /* cells, distance of a surface from a centre */
#define SHARP        0.05      /* least radius of a surface over that of its parallel */
#define OUTSIDE      0.5       /* fine spacings outside a surface, where air is if it is free */
#define SOLID_MARGIN 4.        /* fine spacings around solids and emitters within which the liquid is fine */
#define BACKWARD     13        /* neighbours of a cell that come before it, of 26 */
#define FAR          (1 << 30) /* the coarse spacing in units is about this, or less */

static PetscInt CellOf(const Target *t, const PetscReal x[DIM])
{
  PetscInt at[DIM];

  for (PetscInt d = 0; d < DIM; d++)
    at[d] = PetscMax(0, PetscMin(t->n[d] - 1, (PetscInt)PetscFloorReal((x[d] - t->lower[d]) / t->size)));
  return CellIndex(t->n, at[0], at[1], at[2]);
}

static PetscInt InUnits(const Target *t, PetscReal spacing)
{
  return (PetscInt)PetscFloorReal(spacing / t->unit + 0.5);
}

static void CellCenter(const Target *t, PetscInt c, PetscReal x[DIM])
{
  PetscInt at[DIM];

  CellCoordinates(t->n, c, at);
  for (PetscInt d = 0; d < DIM; d++) x[d] = t->n[d] > 1 ? t->lower[d] + (at[d] + 0.5) * t->size : 0;
}

static PetscErrorCode Lay(Domain domain, Target *t)
{
  PetscReal count, step;

  PetscFunctionBegin;
  t->size = CELL * domain->spacing;
  do {
    count = 1;
    for (PetscInt d = 0; d < DIM; d++) {
      t->lower[d] = domain->lower[d];
      t->n[d]     = d < domain->dim ? (PetscInt)PetscCeilReal((domain->upper[d] - domain->lower[d]) / t->size) : 1;
      count *= t->n[d];
    }
    if (count > CELLS_MOST) t->size *= CELL_GROWTH;
  } while (count > CELLS_MOST);
  t->count = (PetscInt)count;
  step     = domain->growth * t->size / 3;
  t->third = (PetscInt)PetscMax(1, FAR * PetscMin(step / domain->spacing_coarse, 0.1));
  t->unit  = step / t->third;
  {
    const SharedArray arrays[] = {{&t->value, t->count, sizeof(PetscInt)}, {&t->liquid, t->count, 1}};

    PetscCall(SharedCreate(domain->comm, PETSC_STATIC_ARRAY_LENGTH(arrays), arrays, &t->shared));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TargetClear(Scene scene)
{
  const Domain domain = SceneDomain(scene);
  Target      *t      = TargetOf(scene);
  PetscInt     first, end;

  PetscFunctionBegin;
  if (!t->value) PetscCall(Lay(domain, t));
  PetscCall(SharedFence(&t->shared)); /* no rank reads the former target any more */
  SharedSlice(&t->shared, t->count, &first, &end);
  for (PetscInt c = first; c < end; c++) {
    t->value[c]  = InUnits(t, domain->spacing_coarse);
    t->liquid[c] = 0;
  }
  PetscCall(SharedFence(&t->shared));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void TargetAdd(Scene scene, const PetscReal x[DIM], PetscReal spacing)
{
  const Domain    domain = SceneDomain(scene);
  Target         *target = TargetOf(scene);
  const PetscReal within = domain->growth * (BAND * domain->spacing);

  if (spacing < domain->spacing_coarse - within)
    SharedMin(&target->value[CellOf(target, x)], InUnits(target, spacing - within));
}

void TargetFill(Scene scene, const PetscReal x[DIM], PetscReal spacing)
{
  const Target *t = TargetOf(scene);
  PetscInt      first[DIM], last[DIM], cell[DIM];

  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal place = (x[d] - t->lower[d]) / t->size, half = FILLED * spacing / t->size;

    first[d] = cell[d] = PetscMax(0, PetscMin(t->n[d] - 1, (PetscInt)PetscFloorReal(place - half)));
    last[d]            = PetscMax(0, PetscMin(t->n[d] - 1, (PetscInt)PetscFloorReal(place + half)));
  }
  do SharedOr(&t->liquid[CellIndex(t->n, cell[0], cell[1], cell[2])], 1);
  while (CellNext(first, last, cell));
}

PetscErrorCode TargetFilled(Scene scene)
{
  Target *t = TargetOf(scene);

  PetscFunctionBegin;
  PetscCall(SharedReduce(&t->shared, t->liquid, t->count, MPI_UNSIGNED_CHAR, MPI_MAX));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How deep (m) the liquid is behind the point x of its surface, along the unit vector 'into'; at most 'most'. */
static PetscReal Thickness(Scene scene, const PetscReal x[DIM], const PetscReal into[DIM], PetscReal most)
{
  const Domain  domain = SceneDomain(scene);
  const Target *t      = TargetOf(scene);

  for (PetscReal depth = 0; depth < most; depth += MARCH * t->size) {
    PetscReal y[DIM];

    for (PetscInt d = 0; d < DIM; d++) y[d] = x[d] + depth * into[d];
    for (PetscInt d = 0; d < domain->dim; d++) {
      if (y[d] < domain->lower[d] && domain->face[d][0] == FACE_SYMMETRY) y[d] = 2 * domain->lower[d] - y[d];
      if (y[d] > domain->upper[d] && domain->face[d][1] == FACE_SYMMETRY) y[d] = 2 * domain->upper[d] - y[d];
    }
    DomainWrap(domain, y);
    for (PetscInt d = 0; d < domain->dim; d++)
      if (y[d] < domain->lower[d] || y[d] > domain->upper[d]) return depth;
    if (!t->liquid[CellOf(t, y)]) return depth;
  }
  return most;
}

PetscReal TargetSpacing(Scene scene, const PetscReal x[DIM], const PetscReal into[DIM], PetscReal curvature)
{
  const Domain    domain = SceneDomain(scene);
  const PetscReal coarse = domain->spacing_coarse;
  PetscReal       spacing;

  if (FollowOf(domain)->what == FOLLOW_SURFACE) return domain->spacing;
  spacing = PetscMin(coarse, 1 / (PER_RADIUS * (PetscAbsReal(curvature) + PETSC_SMALL)));
  spacing = PetscMin(spacing, Thickness(scene, x, into, ACROSS * coarse) / ACROSS);
  return PetscMax(domain->spacing, spacing);
}

/* The cell 'by' from the cell at, through periodic faces; -1: it is outside. */
static PetscInt CellBeside(const Domain domain, const Target *t, const PetscInt at[DIM], const PetscInt by[DIM])
{
  PetscInt to[DIM];

  for (PetscInt d = 0; d < DIM; d++) {
    to[d] = at[d] + by[d];
    if (domain->face[d][0] == FACE_PERIODIC) to[d] = (to[d] + t->n[d]) % t->n[d];
    if (to[d] < 0 || to[d] >= t->n[d]) return -1;
  }
  return CellIndex(t->n, to[0], to[1], to[2]);
}

/* A pass over the cells first .. end - 1, forwards or backwards: each takes what those before it allow, which another
   rank may be about to make less. Returns whether one has become less. */
static PetscBool Sweep(const Domain domain, Target *t, PetscInt first, PetscInt end, PetscInt direction)
{
  PetscInt  by[BACKWARD][DIM], offset[BACKWARD], allows[BACKWARD];
  PetscBool changed = PETSC_FALSE;

  for (PetscInt l = 0; l < BACKWARD; l++) {
    for (PetscInt d = 0, place = l; d < DIM; d++, place /= 3) by[l][d] = direction * (place % 3 - 1);
    offset[l] = CellIndex(t->n, by[l][0], by[l][1], by[l][2]);
    allows[l] = t->third * (2 + PetscAbsInt(by[l][0]) + PetscAbsInt(by[l][1]) + PetscAbsInt(by[l][2]));
  }
  for (PetscInt k = first; k < end; k++) {
    const PetscInt c      = direction > 0 ? k : first + end - 1 - k;
    PetscInt       least  = t->value[c], at[DIM];
    PetscBool      inside = PETSC_TRUE;

    CellCoordinates(t->n, c, at);
    for (PetscInt d = 0; d < domain->dim; d++) inside = (PetscBool)(inside && at[d] > 0 && at[d] < t->n[d] - 1);
    for (PetscInt l = domain->dim == 2 ? 9 : 0; l < BACKWARD; l++) {
      const PetscInt cell = inside ? c + offset[l] : CellBeside(domain, t, at, by[l]);

      if (cell >= 0) least = PetscMin(least, __atomic_load_n(&t->value[cell], __ATOMIC_RELAXED) + allows[l]);
    }
    changed = (PetscBool)(changed || least < t->value[c]);
    __atomic_store_n(&t->value[c], least, __ATOMIC_RELAXED);
  }
  return changed;
}

/* Two passes suffice, but over periodic faces and over cells of other ranks: there passes go on until none changes a
   cell. What they arrive at depends on no order, since no sum is rounded. */
PetscErrorCode TargetSpread(Scene scene)
{
  const Domain domain = SceneDomain(scene);
  Target      *t      = TargetOf(scene);
  PetscBool    open   = (PetscBool)(t->shared.size > 1), changed;
  PetscInt     first, end;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < domain->dim; d++) open = (PetscBool)(open || domain->face[d][0] == FACE_PERIODIC);
  SharedSlice(&t->shared, t->count, &first, &end);
  PetscCall(SharedReduce(&t->shared, t->value, t->count, MPIU_INT, MPI_MIN));
  do {
    changed = Sweep(domain, t, first, end, 1);
    changed = (PetscBool)(Sweep(domain, t, first, end, -1) || changed);
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPIU_BOOL, MPI_LOR, t->shared.machine));
  } while (changed && open);
  PetscCall(SharedFence(&t->shared));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal TargetAt(Domain domain, const PetscReal x[DIM])
{
  const Target *t   = &FollowOf(domain)->target;
  PetscReal     sum = 0, part[DIM];
  PetscInt      first[DIM];

  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal place =
      t->n[d] > 1 ? PetscMax(0, PetscMin(t->n[d] - 1.0, (x[d] - t->lower[d]) / t->size - 0.5)) : 0;

    first[d] = PetscMax(0, PetscMin(t->n[d] - 2, (PetscInt)place));
    part[d]  = place - first[d];
  }
  for (PetscInt corner = 0; corner < 1 << DIM; corner++) {
    PetscReal weight = 1;
    PetscInt  at[DIM];

    for (PetscInt d = 0; d < DIM; d++) {
      const PetscInt up = corner >> d & 1;

      weight *= up ? part[d] : 1 - part[d];
      at[d] = PetscMin(t->n[d] - 1, first[d] + up);
    }
    sum += weight * t->value[CellIndex(t->n, at[0], at[1], at[2])];
  }
  return sum * t->unit;
}

/* The distance of x (m) from the surface of body b, mirrored at walls and mirrors of the box, so that a body that ends
   there has no surface there. */
static PetscReal MirroredDistance(Scene scene, PetscInt b, const PetscReal x[DIM])
{
  const Domain domain = SceneDomain(scene);
  PetscReal    y[DIM];

  for (PetscInt d = 0; d < DIM; d++) {
    y[d] = x[d];
    if (d >= domain->dim) continue;
    if (y[d] < domain->lower[d] && domain->face[d][0] != FACE_OPEN) y[d] = 2 * domain->lower[d] - y[d];
    if (y[d] > domain->upper[d] && domain->face[d][1] != FACE_OPEN) y[d] = 2 * domain->upper[d] - y[d];
  }
  return SceneOwnDistance(scene, b, y);
}

/* Whether there is air at x (m), in the box. */
static PetscBool IsAir(Scene scene, const PetscReal x[DIM])
{
  for (PetscInt d = 0; d < SceneDomain(scene)->dim; d++)
    if (x[d] < SceneDomain(scene)->lower[d] || x[d] > SceneDomain(scene)->upper[d]) return PETSC_FALSE;
  for (PetscInt b = 0; b < SceneCount(scene); b++)
    if (!BodyComesLater(SceneBody(scene, b)) && BodyContains(SceneBody(scene, b), x)) return PETSC_FALSE;
  return (PetscBool)(SceneSolidDistance(scene, x, NULL) > 0);
}

/* Makes the free surface of body b a source if it is near the centre of the cell c, which is in air. The sum of the
   principal curvatures is the Laplacian of the distance, with rings the slope of their radius, too. It is taken
   on the parallel surface one step of the differences outside, so that no point of them is inside the body, where the
   distance is also that of its faces on walls. */
static void AddSurface(Scene scene, PetscInt b, PetscInt c)
{
  const Domain    domain = SceneDomain(scene);
  const PetscReal step   = STENCIL * domain->spacing;
  PetscReal       x[DIM], n[DIM], out[DIM], into[DIM], middle, distance, curvature = 0, inward;

  CellCenter(TargetOf(scene), c, x);
  distance = MirroredDistance(scene, b, x);
  if (distance <= 0 || distance > NEAR * TargetOf(scene)->size) return;
  DistanceNormal(scene, MirroredDistance, b, x, n);
  for (PetscInt d = 0; d < DIM; d++) {
    x[d] -= distance * n[d];
    out[d] = x[d] + OUTSIDE * domain->spacing * n[d];
  }
  if (Norm(n) == 0 || !IsAir(scene, out)) return;
  for (PetscInt d = 0; d < DIM; d++) out[d] = x[d] + step * n[d];
  middle = MirroredDistance(scene, b, out);
  for (PetscInt d = 0; d < domain->dim; d++) {
    PetscReal low[DIM] = {out[0], out[1], out[2]}, high[DIM] = {out[0], out[1], out[2]};

    low[d] -= step;
    high[d] += step;
    curvature += (MirroredDistance(scene, b, low) + MirroredDistance(scene, b, high) - 2 * middle) / (step * step);
  }
  if (domain->rings) curvature += n[0] / PetscMax(out[0], step);
  inward = 1 - curvature * step / (domain->rings ? 2 : domain->dim - 1); /* exact for spheres */
  for (PetscInt d = 0; d < DIM; d++) {
    into[d] = -n[d];
    out[d]  = x[d] + OUTSIDE * TargetOf(scene)->size * into[d]; /* in a cell of liquid */
  }
  TargetAdd(scene, x, TargetSpacing(scene, out, into, curvature / PetscMax(inward, SHARP)));
}

PetscErrorCode TargetSolids(Scene scene)
{
  const PetscReal margin = SOLID_MARGIN * SceneDomain(scene)->spacing + TargetOf(scene)->size;
  PetscReal       x[DIM];
  PetscInt        first, end;

  PetscFunctionBegin;
  if (!SceneSolidCount(scene) && !SceneComesLater(scene)) PetscFunctionReturn(PETSC_SUCCESS);
  SharedPart(&TargetOf(scene)->shared, TargetOf(scene)->count, &first, &end);
  for (PetscInt c = first; c < end; c++) {
    PetscBool fine;

    CellCenter(TargetOf(scene), c, x);
    fine = (PetscBool)(PetscAbsReal(SceneSolidDistance(scene, x, NULL)) < margin);
    for (PetscInt b = 0; b < SceneCount(scene) && !fine; b++)
      fine = (PetscBool)(BodyComesLater(SceneBody(scene, b)) && BodyDistance(SceneBody(scene, b), x) < margin);
    if (fine) TargetAdd(scene, x, SceneDomain(scene)->spacing);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TargetBodies(Domain domain, Scene scene)
{
  PetscInt first, end;

  PetscFunctionBegin;
  PetscCall(TargetClear(scene));
  SharedPart(&TargetOf(scene)->shared, TargetOf(scene)->count, &first, &end);
  for (PetscInt c = first; c < end; c++) {
    PetscReal x[DIM];

    CellCenter(TargetOf(scene), c, x);
    for (PetscInt b = 0; b < SceneCount(scene); b++)
      if (!BodyComesLater(SceneBody(scene, b)) && BodyContains(SceneBody(scene, b), x))
        SharedOr(&TargetOf(scene)->liquid[c], 1);
  }
  PetscCall(TargetFilled(scene));
  PetscCall(TargetSolids(scene));
  for (PetscInt b = 0; b < SceneCount(scene); b++)
    for (PetscInt c = first; c < end && !BodyComesLater(SceneBody(scene, b)); c++) AddSurface(scene, b, c);
  PetscCall(TargetSpread(scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}
