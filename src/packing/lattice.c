/* Bodies filled from a lattice of the particle spacing, with a jitter. */
#include "packing_impl.h"

#define LEVEL_MAX   0.5 /* spacings */
#define SHELL_SPLIT 0.5 /* share of the points near the surface: a larger shell of equal distance is a flat layer */
#define SUBPOINTS   6   /* a direction, for the share of a lattice cell */

typedef struct {
  PetscReal jitter; /* largest displacement a component, in spacings */
} Lattice;

void BoxLatticeSetUp(Domain domain, BoxLattice *lattice)
{
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal length = domain->upper[d] - domain->lower[d], spacing = domain->spacing;
    const PetscBool below  = (PetscBool)(domain->face[d][0] != FACE_OPEN);
    const PetscBool above  = (PetscBool)(domain->face[d][1] != FACE_OPEN);
    const PetscBool fitted = (PetscBool)(below && above); /* the nearest number of points; else those inside the box */

    if (d >= domain->dim) { /* the plane z = 0 */
      lattice->n[d]      = 1;
      lattice->pitch[d]  = spacing;
      lattice->origin[d] = 0;
      continue;
    }
    lattice->n[d]     = PetscMax(1, (PetscInt)PetscFloorReal(length / spacing + 0.5 + (fitted ? ROUNDING : -ROUNDING)));
    lattice->pitch[d] = fitted ? length / lattice->n[d] : spacing;
    lattice->origin[d] =
      above && !below ? domain->upper[d] - (lattice->n[d] - 0.5) * spacing : domain->lower[d] + 0.5 * lattice->pitch[d];
  }
}

/* The part of the lattice that may be inside a body, and one layer more. Where the body touches a closed face it is the
   box's, which the walls and images continue; elsewhere it has the spacing and is symmetric about the middle of the
   body. */
static void BodyLattice(Domain domain, const BoxLattice *box, Body body, BoxLattice *lattice)
{
  const PetscReal tiny = ROUNDING * domain->spacing;
  PetscReal       lower[DIM], upper[DIM];

  BodyBounds(body, lower, upper);
  *lattice = *box;
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscBool below = (PetscBool)(domain->face[d][0] != FACE_OPEN && lower[d] <= domain->lower[d] + tiny);
    const PetscBool above = (PetscBool)(domain->face[d][1] != FACE_OPEN && upper[d] >= domain->upper[d] - tiny);

    if (below || above) {
      const PetscInt first =
        PetscMax(0, (PetscInt)PetscCeilReal((lower[d] - box->origin[d]) / box->pitch[d] - ROUNDING) - 1);
      const PetscInt last =
        PetscMin(box->n[d] - 1, (PetscInt)PetscFloorReal((upper[d] - box->origin[d]) / box->pitch[d] + ROUNDING) + 1);

      lattice->n[d]      = PetscMax(0, last - first + 1);
      lattice->origin[d] = box->origin[d] + first * box->pitch[d];
    } else {
      lattice->n[d]      = PetscMax(1, (PetscInt)PetscFloorReal((upper[d] - lower[d]) / domain->spacing + 0.5)) + 2;
      lattice->pitch[d]  = domain->spacing;
      lattice->origin[d] = 0.5 * (lower[d] + upper[d]) - 0.5 * (lattice->n[d] - 1) * domain->spacing;
    }
  }
}

/* Signed distance of lattice point number 'point' at x (m) to the surface of body b, with a random part far below
   rounding that puts points of equal distance in an order. */
static PetscReal PointDistance(Packing packing, PetscInt b, PetscInt point, const PetscReal x[DIM])
{
  const PetscReal tie = RandomUnit((unsigned long long)packing->seed + 1, (unsigned long long)point);

  return BodyDistance(SceneBody(packing->cloud->scene, b), x) + 0.1 * ROUNDING * packing->cloud->domain->spacing * tie;
}

/* Whether point x (m) is inside the box and closer to the inside of body number b than its level, and of no earlier
   body. */
static PetscBool Belongs(Packing packing, const PetscReal level[], PetscInt b, PetscInt point, const PetscReal x[DIM])
{
  const Domain domain = packing->cloud->domain;
  const Scene  scene  = packing->cloud->scene;

  for (PetscInt d = 0; d < domain->dim; d++)
    if (x[d] <= domain->lower[d] || x[d] >= domain->upper[d]) return PETSC_FALSE;
  if (PointDistance(packing, b, point, x) > level[b] || SceneSolidDistance(scene, x, NULL) <= 0) return PETSC_FALSE;
  for (PetscInt other = 0; other < b; other++)
    if (BodyDistance(SceneBody(scene, other), x) <= level[other]) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* The share of the lattice cell around x that is inside body and box, displaced as the body displaces it. */
static PetscReal CellShare(Domain domain, const BoxLattice *lattice, Body body, const PetscReal x[DIM])
{
  const PetscInt points = domain->dim == 3 ? SUBPOINTS * SUBPOINTS * SUBPOINTS : SUBPOINTS * SUBPOINTS;
  PetscInt       inside = 0;

  for (PetscInt k = 0; k < points; k++) {
    const PetscInt at[DIM] = {k % SUBPOINTS, (k / SUBPOINTS) % SUBPOINTS, k / (SUBPOINTS * SUBPOINTS)};
    PetscReal      y[DIM]  = {x[0], x[1], x[2]};

    for (PetscInt d = 0; d < domain->dim; d++) y[d] += ((at[d] + 0.5) / SUBPOINTS - 0.5) * lattice->pitch[d];
    BodyDisplace(body, y);
    inside += BodyContains(body, y);
  }
  return (PetscReal)inside / points;
}

/* The level of the signed distance (m) below which lattice points fill a body, so that their number is its volume over
   that of a lattice cell: with the level 0 a small sphere would be up to a fifth too light or heavy. At most LEVEL_MAX
   spacings from 0. A shell of equal distance may be filled in part unless it is a flat layer. */
static PetscErrorCode FitLevel(Packing packing, PetscInt b, const BoxLattice *lattice, PetscReal *level)
{
  const Domain    domain = packing->cloud->domain;
  const Body      body   = SceneBody(packing->cloud->scene, b);
  const PetscReal d0 = domain->spacing, bound = LEVEL_MAX * d0 * (1 + ROUNDING), reach = 0.5 * d0 * domain->dim;
  PetscInt        sure = 0, count = 0, capacity = 1024;
  PetscReal      *distance, target = 0, best = PETSC_MAX_REAL;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(capacity, &distance));
  for (PetscInt k = 0; k < lattice->n[2]; k++) {
    for (PetscInt j = 0; j < lattice->n[1]; j++) {
      for (PetscInt i = 0; i < lattice->n[0]; i++) {
        const PetscInt index[DIM] = {i, j, k};
        PetscReal      x[DIM], placed[DIM], s;
        PetscBool      inside = PETSC_TRUE;

        for (PetscInt d = 0; d < DIM; d++) x[d] = placed[d] = lattice->origin[d] + index[d] * lattice->pitch[d];
        BodyDisplace(body, placed);
        for (PetscInt d = 0; d < domain->dim; d++)
          if (placed[d] <= domain->lower[d] || placed[d] >= domain->upper[d]) inside = PETSC_FALSE;
        s = PointDistance(packing, b, (k * lattice->n[1] + j) * lattice->n[0] + i, placed);
        target += s < -reach ? inside : s > reach ? 0 : CellShare(domain, lattice, body, x);
        if (!inside || s > bound) continue;
        if (s < -bound)
          sure++;
        else {
          if (count == capacity) PetscCall(PetscRealloc((capacity *= 2) * sizeof(*distance), &distance));
          distance[count++] = s;
        }
      }
    }
  }
  PetscCall(PetscSortReal(count, distance));
  *level = 0;
  for (PetscInt k = 0, first = 0; k <= count; k++) { /* the first k of them */
    const PetscReal low = k > 0 ? distance[k - 1] : -bound, high = k < count ? distance[k] : bound;
    const PetscReal miss = PetscAbsReal((PetscReal)(sure + k) - target);
    const PetscBool within =
      (PetscBool)(k > 0 && k < count && high - low < ROUNDING * d0); /* in the middle of a shell */
    PetscInt last = k;

    if (!within) first = k;
    while (last < count && distance[last] - distance[first] < ROUNDING * d0) last++;
    if (miss > best - 0.5 || (within && last - first >= SHELL_SPLIT * count)) continue;
    best   = miss;
    *level = low < 0 && high > 0 && !within ? 0 : 0.5 * (low + high);
  }
  PetscCall(PetscFree(distance));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Shows the points of body b's lattice to the visitor; *id is the number of the next. */
static void VisitBody(Packing packing, PetscInt b, const BoxLattice *lattice, const PetscReal level[],
                      PackingVisitor visitor, void *context, PetscInt *id)
{
  const Domain             domain = packing->cloud->domain;
  const Scene              scene  = packing->cloud->scene;
  const PetscReal          jitter = ((Lattice *)packing->data)->jitter * domain->spacing; /* m */
  const unsigned long long seed   = (unsigned long long)packing->seed;

  for (PetscInt k = 0; k < lattice->n[2]; k++) {
    for (PetscInt j = 0; j < lattice->n[1]; j++) {
      for (PetscInt i = 0; i < lattice->n[0]; i++) {
        const PetscInt index[DIM] = {i, j, k};
        PetscReal      x[DIM];

        for (PetscInt d = 0; d < DIM; d++) x[d] = lattice->origin[d] + index[d] * lattice->pitch[d];
        BodyDisplace(SceneBody(scene, b), x);
        if (!Belongs(packing, level, b, (k * lattice->n[1] + j) * lattice->n[0] + i, x)) continue;
        for (PetscInt d = 0; d < domain->dim; d++)
          x[d] += jitter * (2 * RandomUnit(seed, (unsigned long long)*id * DIM + (unsigned long long)d) - 1);
        PackingConfine(domain, x);
        visitor(context, (*id)++, b, x);
      }
    }
  }
}

static PetscErrorCode Visit_Lattice(Packing packing, PackingVisitor visitor, void *context)
{
  const Domain domain = packing->cloud->domain;
  const Scene  scene  = packing->cloud->scene;
  BoxLattice   box, lattice;
  PetscReal    level[SCENE_MAX_BODIES];
  PetscInt     id = 0;

  PetscFunctionBegin;
  BoxLatticeSetUp(domain, &box);
  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    level[b] = -PETSC_MAX_REAL; /* of an emitter, which has no place of its own */
    if (BodyEmits(SceneBody(scene, b))) continue;
    BodyLattice(domain, &box, SceneBody(scene, b), &lattice);
    PetscCall(FitLevel(packing, b, &lattice, &level[b]));
    VisitBody(packing, b, &lattice, level, visitor, context, &id);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode LatticeVisitBody(Packing packing, PetscInt body, PackingVisitor visitor, void *context)
{
  BoxLattice box, lattice;
  PetscReal  level[SCENE_MAX_BODIES];
  PetscInt   id = 0;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < SCENE_MAX_BODIES; b++) level[b] = -PETSC_MAX_REAL;
  BoxLatticeSetUp(packing->cloud->domain, &box);
  BodyLattice(packing->cloud->domain, &box, SceneBody(packing->cloud->scene, body), &lattice);
  PetscCall(FitLevel(packing, body, &lattice, &level[body]));
  VisitBody(packing, body, &lattice, level, visitor, context, &id);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetFromOptions_Lattice(Packing packing, OptionItems PetscOptionsObject)
{
  Lattice *lattice = (Lattice *)packing->data;

  PetscFunctionBegin;
  PetscCall(PetscOptionsReal("-packing_jitter", "largest random displacement from the lattice, a component (spacings)",
                             "PackingSetFromOptions", lattice->jitter, &lattice->jitter, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Check_Lattice(Packing packing)
{
  const PetscReal jitter = ((Lattice *)packing->data)->jitter;

  PetscFunctionBegin;
  PetscCheckUser(jitter >= 0 && jitter < 0.5, packing->cloud->comm,
                 "-packing_jitter is %g; it must lie in [0, 0.5) spacings", (double)jitter);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy_Lattice(Packing packing)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(packing->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PackingCreate_Lattice(Packing packing)
{
  Lattice *lattice;

  PetscFunctionBegin;
  PetscCall(PetscNew(&lattice));
  lattice->jitter             = 0.1; /* at rest in the consistent scheme; 0.25 costs kinetic energy at impact */
  packing->data               = lattice;
  packing->ops.setfromoptions = SetFromOptions_Lattice;
  packing->ops.check          = Check_Lattice;
  packing->ops.visit          = Visit_Lattice;
  packing->ops.destroy        = Destroy_Lattice;
  PetscFunctionReturn(PETSC_SUCCESS);
}
