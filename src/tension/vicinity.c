/* What is near some particles, in cells: the levels of graded particles look at the liquid around their own only. */
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
