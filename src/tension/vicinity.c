/* What is near some particles, in cells; the levels of graded particles look at the liquid around their own only. */
#include "tension_impl.h"

#define MAX_CELLS   (1 << 22) /* more cells than this would take too much memory: they are made larger */
#define CELL_GROWTH 1.25      /* by this factor at a time */

static void SetWindow(Vicinity *vicinity, Cloud cloud, PetscReal radius, PetscInt count, const PetscInt of[])
{
  PetscReal cells;

  for (PetscInt d = 0; d < DIM; d++) {
    vicinity->lower[d] = PETSC_MAX_REAL;
    vicinity->upper[d] = -PETSC_MAX_REAL;
  }
  for (PetscInt k = 0; k < count; k++)
    for (PetscInt d = 0; d < DIM; d++) {
      const PetscReal x = cloud->field[FIELD_POSITION][DIM * of[k] + d];

      vicinity->lower[d] = PetscMin(vicinity->lower[d], x);
      vicinity->upper[d] = PetscMax(vicinity->upper[d], x);
    }
  for (PetscInt d = 0; d < DIM; d++) {
    vicinity->lower[d] -= radius;
    vicinity->upper[d] += radius;
  }
  vicinity->size = radius;
  do {
    cells = 1;
    for (PetscInt d = 0; d < DIM; d++) cells *= (vicinity->upper[d] - vicinity->lower[d]) / vicinity->size + 1;
    if (cells > MAX_CELLS) vicinity->size *= CELL_GROWTH;
  } while (cells > MAX_CELLS);
  for (PetscInt d = 0; d < DIM; d++)
    vicinity->n[d] = (PetscInt)((vicinity->upper[d] - vicinity->lower[d]) / vicinity->size) + 1;
}

/* Marks the cells around a cell. */
static void MarkAround(const Vicinity *vicinity, PetscInt c, unsigned char *near)
{
  const PetscInt *n = vicinity->n;
  PetscInt        at[DIM];

  CellCoordinates(n, c, at);
  for (PetscInt z = PetscMax(0, at[2] - 1); z <= PetscMin(n[2] - 1, at[2] + 1); z++)
    for (PetscInt y = PetscMax(0, at[1] - 1); y <= PetscMin(n[1] - 1, at[1] + 1); y++)
      for (PetscInt x = PetscMax(0, at[0] - 1); x <= PetscMin(n[0] - 1, at[0] + 1); x++)
        near[CellIndex(n, x, y, z)] = 1;
}

PetscErrorCode VicinityCreate(Cloud cloud, PetscReal radius, PetscInt count, const PetscInt of[], Vicinity *vicinity)
{
  unsigned char *within;
  PetscInt       cells;

  PetscFunctionBegin;
  vicinity->near = NULL;
  if (count == 0) PetscFunctionReturn(PETSC_SUCCESS);
  SetWindow(vicinity, cloud, radius, count, of);
  cells = vicinity->n[0] * vicinity->n[1] * vicinity->n[2];
  PetscCall(PetscCalloc1(cells, &vicinity->near));
  PetscCall(PetscCalloc1(cells, &within));
  for (PetscInt k = 0; k < count; k++) within[VicinityCell(vicinity, cloud->field[FIELD_POSITION] + DIM * of[k])] = 1;
  for (PetscInt c = 0; c < cells; c++)
    if (within[c]) MarkAround(vicinity, c, vicinity->near);
  PetscCall(PetscFree(within));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode VicinityDestroy(Vicinity *vicinity)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(vicinity->near));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sorts the local indices of the fluid particles by level: those of level l are own[first[l] .. first[l+1]). */
static void SortByLevel(Cloud cloud, PetscInt levels, PetscInt own[], PetscInt first[])
{
  PetscInt count[SIZE_LEVELS] = {0};

  for (PetscInt a = 0; a < cloud->n_fluid; a++) count[CloudLevel(cloud, a)]++;
  first[0] = 0;
  for (PetscInt l = 0; l < levels; l++) {
    first[l + 1] = first[l] + count[l];
    count[l]     = first[l];
  }
  for (PetscInt a = 0; a < cloud->n_fluid; a++) own[count[CloudLevel(cloud, a)]++] = a;
}

/* Sets the bit of each level in the keep flags ([n_total]) of the fluid particles, or those of them on the surface,
   that are near what was found for it. */
static void MarkNear(Tension tension, Cloud cloud, PetscBool surface, const Vicinity vicinity[], unsigned char keep[])
{
  const PetscInt *layer = cloud->integer[INT_LAYER], *on_surface = cloud->integer[INT_SURFACE];

  for (PetscInt a = 0; a < cloud->n_total; a++) {
    keep[a] = 0;
    if (layer[a] != 0 || (surface && on_surface[a] != 1)) continue;
    for (PetscInt l = 0; l < tension->levels; l++)
      keep[a] |= (unsigned char)(VicinityHas(&vicinity[l], cloud->field[FIELD_POSITION] + DIM * a) << l);
  }
}

/* BandMark and LiquidSort for each level of graded particles, of what is around its own. */
static PetscErrorCode SortLevels(Tension tension, Cloud cloud)
{
  const PetscReal support = KernelSupport(tension->kernel);
  const PetscInt  levels  = tension->levels;
  Vicinity        vicinity[SIZE_LEVELS];
  PetscInt       *own, first[SIZE_LEVELS + 1];
  unsigned char  *keep;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(cloud->n_fluid, &own, cloud->n_total, &keep));
  SortByLevel(cloud, levels, own, first);
  for (PetscInt l = 0; l < levels; l++)
    PetscCall(VicinityCreate(cloud, tension->largest[l] * TensionSurfaceReach(tension), first[l + 1] - first[l],
                             own + first[l], &vicinity[l]));
  MarkNear(tension, cloud, PETSC_TRUE, vicinity, keep);
  for (PetscInt l = 0; l < levels; l++) {
    PetscInt near = first[l];

    PetscCall(VicinityDestroy(&vicinity[l]));
    PetscCall(BandMark(&tension->bands[l], cloud, tension->largest[l] * TensionSurfaceReach(tension),
                       tension->size_most * support, keep, 1 << l));
    for (PetscInt k = first[l]; k < first[l + 1]; k++)
      if (BandWithin(&tension->bands[l], cloud->field[FIELD_POSITION] + DIM * own[k],
                     TensionSurfaceReach(tension) * CloudSize(cloud, own[k])))
        own[near++] = own[k];
    PetscCall(VicinityCreate(cloud, tension->largest[l] * support, near - first[l], own + first[l], &vicinity[l]));
  }
  MarkNear(tension, cloud, PETSC_FALSE, vicinity, keep);
  for (PetscInt l = 0; l < levels; l++) {
    PetscCall(VicinityDestroy(&vicinity[l]));
    PetscCall(LiquidSort(TensionLevel(tension, l), cloud, support, tension->largest[l], keep, 1 << l));
  }
  PetscCall(PetscFree2(own, keep));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TensionSort(Tension tension, Cloud cloud)
{
  const PetscReal support = KernelSupport(tension->kernel);

  PetscFunctionBegin;
  if (tension->graded)
    PetscCall(SortLevels(tension, cloud));
  else {
    const unsigned char *keep = tension->phase ? tension->phases : NULL;

    PetscCall(BandMark(&tension->bands[0], cloud, TensionSurfaceReach(tension), support, keep, tension->phase));
    PetscCall(LiquidSort(TensionLevel(tension, 0), cloud, support, 1, keep, tension->phase));
  }
  for (PetscInt l = 0; l < tension->levels; l++) {
    if (cloud->weight) LiquidLoad(TensionLevel(tension, l), WEIGHT_COLUMN, 1, cloud->weight);
    if (tension->solid.count) LiquidLoad(TensionLevel(tension, l), SOLID_COLUMN, 1, tension->solid.index);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
