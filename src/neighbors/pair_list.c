/* What the searches of particles of one size and of graded ones share: units of places, room for the list. */
#include "search.h"

#define ROW_GUESS 72 /* neighbours a particle: the first guess of the size of the list */
#define BOX_BITS  30
#define OUTSIDE   1.5 /* the integers reach so many box lengths from the middle of the box, and besides */
#define REACHES   4   /* so many times the largest support */

Units SearchUnits(Cloud cloud)
{
  const Domain domain = cloud->domain;
  Units        units  = {{0}, {0}, {0}};

  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal length = domain->upper[d] - domain->lower[d], needed = OUTSIDE * length + REACHES * cloud->reach;
    int             bits = BOX_BITS;

    while (PetscPowRealInt(2, 31 - bits) * length < needed) bits--;
    units.center[d]  = 0.5 * (domain->lower[d] + domain->upper[d]);
    units.inverse[d] = PetscPowRealInt(2, bits) / length;
    units.unit[d]    = (float)(1 / (units.inverse[d] * KernelSmoothingLength(cloud->kernel)));
  }
  return units;
}

PetscInt64 CloudListRoom(PetscInt64 used, PetscInt rows, PetscInt most)
{
  return used + PetscMax(most, used / 8 + (PetscInt64)ROW_GUESS * rows) + most;
}

PetscErrorCode ReserveList(Cloud cloud, PetscInt64 pairs)
{
  const size_t room = (size_t)pairs;

  PetscFunctionBegin;
  cloud->list_capacity = pairs;
  PetscCall(PetscRealloc(room * sizeof(PetscInt), &cloud->list));
  PetscCall(PetscRealloc(room * sizeof(float), &cloud->slope));
  PetscCall(PetscRealloc(room * sizeof(uint16_t), &cloud->laplacian));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt DropWallPairs(const PetscInt layer[], PetscInt n, const PetscInt list[], uint16_t laplacian[])
{
  PetscInt sum = 0;

  for (PetscInt k = 0; k < n; k++) {
    if (layer[list[k]]) laplacian[k] = 0;
    sum += laplacian[k];
  }
  return sum;
}
