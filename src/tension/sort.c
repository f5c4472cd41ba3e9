/* Selects the particles for which sums are computed, and sorts the liquid of these sums into cells. Each level of sizes
   of graded particles has its own cells, with the liquid around its own particles. */
#include "curvature.h"

/* Length of a cell, spacings: small enough that the cells around a particle are not much more than its support, large
   enough that many particles of a cell share the collected neighbourhood. A support is 2 or 3 cells, with graded
   particles 3, because a large particle has more particles around it. */
#define CELL         1.6
#define CELLS_LEAST  2
#define CELLS_MOST   3
#define AROUND_CELLS 2 /* cells in the radius of LiquidAround */

/* Whether a particle is of the phase and has its keep flag set. */
static inline PetscBool Counts(Cloud cloud, const Phase *phase, const unsigned char keep[], PetscInt a)
{
  return (PetscBool)(cloud->integer[INT_LAYER][a] == 0 && (!keep || keep[a]) && (!phase || phase->of[a] & phase->bits));
}

PetscErrorCode LiquidSort(Tension tension, Cloud cloud, const Phase *phase, PetscInt level, const unsigned char keep[])
{
  const PetscReal support = KernelSupport(tension->kernel);
  const PetscInt  across  = (PetscInt)(support / (CELL * cloud->domain->spacing)),
                 cells    = tension->size_most > 1 ? CELLS_MOST : PetscMax(CELLS_LEAST, PetscMin(CELLS_MOST, across));
  const Curvature *data   = CurvatureOf(tension);
  SortedCells     *liquid = &tension->liquid[level];
  PetscInt        *of, count = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(cloud->n_total, &of));
  for (PetscInt a = 0; a < cloud->n_total; a++)
    if (Counts(cloud, phase, keep, a)) of[count++] = a;
  PetscCall(SortedCellsBuild(liquid, cloud, count, of, tension->largest[level] * support / cells, support));
  PetscCall(PetscFree(of));
  PetscCall(PetscFree(liquid->largest));
  PetscCall(PetscCalloc1(liquid->grid.count, &liquid->largest));
  for (PetscInt p = 0; p < liquid->count; p++) {
    PetscReal *largest = &liquid->largest[SortedCell(liquid, p)];

    if (CloudLevel(cloud, liquid->index[p]) == level) *largest = PetscMax(*largest, cloud->size[liquid->index[p]]);
  }
  if (tension->weighted) SortedCellsLoad(liquid, WEIGHT_COLUMN, 1, cloud->weight);
  if (data && data->contact.solids) SortedCellsLoad(liquid, SOLID_COLUMN, 1, data->solid.index);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode LiquidAround(Cloud cloud, PetscReal radius, PetscInt count, const PetscInt of[], unsigned char keep[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];
  CellMask         mask;

  PetscFunctionBegin;
  PetscCall(CellMaskCreate(PETSC_COMM_SELF, cloud->domain->dim, cloud->domain->lower, radius / AROUND_CELLS, radius,
                           count, of, x, &mask));
  for (PetscInt a = 0; a < cloud->n_total; a++)
    keep[a] = cloud->integer[INT_LAYER][a] == 0 && CellMaskHas(&mask, x + DIM * a);
  PetscCall(CellMaskDestroy(&mask));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a particle is one of the surface particles of SurfaceList. */
static inline PetscBool IsSurface(Cloud cloud, const Phase *phase, const unsigned char keep[], PetscInt a)
{
  return (PetscBool)((cloud->integer[INT_SURFACE][a] == 1 || (phase && phase->also && phase->also[a])) &&
                     Counts(cloud, phase, keep, a));
}

PetscErrorCode SurfaceList(Cloud cloud, const Phase *phase, const unsigned char keep[], PetscInt of[], PetscInt *count)
{
  PetscFunctionBegin;
  *count = 0;
  for (PetscInt a = 0; a < cloud->n_total; a++)
    if (IsSurface(cloud, phase, keep, a)) of[(*count)++] = a;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sorts the surface particles of a level. of: [n_total] of work. */
static PetscErrorCode SortSurface(Tension tension, Cloud cloud, const Phase *phase, PetscInt level,
                                  const unsigned char keep[], PetscInt of[])
{
  Curvature      *data  = tension->data;
  const PetscReal reach = tension->largest[level] * TensionSurfaceReach(tension);
  PetscInt        count;

  PetscFunctionBegin;
  PetscCall(SurfaceList(cloud, phase, keep, of, &count));
  PetscCall(SortedCellsBuild(&data->surface[level], cloud, count, of, reach, reach));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* SortNearSurface of a level. of: [n_total] of work. */
static PetscErrorCode SortLevel(Tension tension, Cloud cloud, const Phase *phase, PetscInt level, PetscInt of[])
{
  Curvature      *data    = tension->data;
  const PetscReal largest = tension->largest[level];
  PetscInt        count   = 0;
  unsigned char  *keep;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(cloud->n_total, &keep));
  for (PetscInt a = 0; a < cloud->n_total; a++) keep[a] = 1;
  if (tension->levels > 1) {
    for (PetscInt a = 0; a < cloud->n_fluid; a++)
      if (CloudLevel(cloud, a) == level) of[count++] = a;
    PetscCall(LiquidAround(cloud, largest * TensionSurfaceReach(tension), count, of, keep));
  }
  PetscCall(SortSurface(tension, cloud, phase, level, keep, of));
  count = 0;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    if (CloudLevel(cloud, a) != level) continue;
    data->close[a] = IsSurface(cloud, phase, keep, a) ||
                     SortedCellsWithin(&data->surface[level], cloud->field[FIELD_POSITION] + DIM * a,
                                       cloud->size[a] * TensionSurfaceReach(tension));
    if (data->close[a]) of[count++] = a;
  }
  PetscCall(LiquidAround(cloud, largest * KernelSupport(tension->kernel), count, of, keep));
  PetscCall(LiquidSort(tension, cloud, phase, level, keep));
  PetscCall(PetscFree(keep));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SortNearSurface(Tension tension, Cloud cloud, const Phase *phase)
{
  Curvature *data = tension->data;
  PetscInt  *of;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(cloud->n_total, &of));
  PetscCall(PetscRealloc((size_t)cloud->n_owned, &data->close));
  for (PetscInt l = 0; l < tension->levels; l++) PetscCall(SortLevel(tension, cloud, phase, l, of));
  PetscCall(PetscFree(of));
  PetscFunctionReturn(PETSC_SUCCESS);
}
