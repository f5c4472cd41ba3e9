/* One tension for two steps, where both together are within what tension allows: it is that between them, with the
   liquid half a step of its velocity ahead. With a force on each oscillation that is the leapfrog of the double step,
   which neither feeds nor damps it; a tension that is merely held acts late, and waves of a rate w gain w2 dt/4 of
   their amplitude in a unit of time. The curvature is the dearest part of a step near a surface; in such steps it costs
   half.

   What is kept are the numbers of particles in their local order, which stays between both (cloud->keep_order). After
   any new order, as after a checkpoint, the second step has its own tension. */
#include "curvature.h"

enum { CAPILLARY, SLOPE, BENDING = SLOPE + DIM, PULL, KEPT_NUMBERS = PULL + DIM };

/* Not of rings: the energies of ten packings of an impact scatter by 5.7 and 7.5 % at 10 and 15 ms, by 3.2 and 3.5 %
   with a tension in each step. */
PetscBool TensionPairs(Tension tension)
{
  return (PetscBool)(tension->active && !tension->rings && tension->model->on_surface && !tension->surfaces &&
                     !TensionHasLaw(tension) && !TensionHasHysteresis(tension) && !TensionSolidsWet(tension->scene));
}

/* Keeps what the tension has given. before: FIELD_ACCELERATION without it. */
static PetscErrorCode Keep(Tension tension, Cloud cloud, const PetscReal before[])
{
  const PetscReal *capillary = cloud->field[FIELD_CAPILLARY], *slope = cloud->field[FIELD_CAPILLARY_SLOPE],
                  *bending = cloud->field[FIELD_BENDING], *after = cloud->field[FIELD_ACCELERATION];
  Kept *kept = &tension->kept;

  PetscFunctionBegin;
  if (cloud->n_fluid > kept->capacity) {
    kept->capacity = cloud->capacity;
    PetscCall(PetscFree2(kept->of, kept->value));
    PetscCall(PetscMalloc2(kept->capacity, &kept->of, KEPT_NUMBERS * kept->capacity, &kept->value));
  }
  kept->n = 0;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal *value = kept->value + KEPT_NUMBERS * kept->n;

    for (PetscInt d = 0; d < DIM; d++) value[PULL + d] = after[DIM * a + d] - before[DIM * a + d];
    if (capillary[a] == 0 && Norm(value + PULL) == 0) continue;
    value[CAPILLARY] = capillary[a];
    value[BENDING]   = bending ? bending[a] : 0;
    for (PetscInt d = 0; d < DIM; d++) value[SLOPE + d] = slope[DIM * a + d];
    kept->of[kept->n++] = a;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TensionApplyAhead(Tension tension, Cloud cloud, PetscReal time)
{
  const size_t     all = (size_t)DIM * cloud->n_total;
  const PetscReal *v   = cloud->field[FIELD_VELOCITY];
  PetscReal       *x   = cloud->field[FIELD_POSITION], *place, *before;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, DIM, &place));
  PetscCall(CloudGetWork(cloud, DIM, &before));
  PetscCall(PetscArraycpy(place, x, all));
  PetscCall(PetscArraycpy(before, cloud->field[FIELD_ACCELERATION], DIM * cloud->n_fluid));
  for (PetscInt a = 0; a < cloud->n_total; a++)
    for (PetscInt d = 0; d < DIM && !cloud->integer[INT_LAYER][a]; d++) x[DIM * a + d] += time * v[DIM * a + d];
  PetscCall(TensionApply(tension, cloud));
  PetscCall(PetscArraycpy(x, place, all));
  PetscCall(Keep(tension, cloud, before));
  tension->kept.layout = cloud->layout;
  cloud->keep_order    = 2;
  PetscCall(CloudRestoreWork(cloud, &before));
  PetscCall(CloudRestoreWork(cloud, &place));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TensionApplyKept(Tension tension, Cloud cloud)
{
  const Kept *kept = &tension->kept;

  PetscFunctionBegin;
  if (kept->layout != cloud->layout) {
    PetscCall(TensionApply(tension, cloud));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  TensionClear(cloud);
  for (PetscInt k = 0; k < kept->n; k++) {
    const PetscInt   a     = kept->of[k];
    const PetscReal *value = kept->value + KEPT_NUMBERS * k;

    cloud->field[FIELD_CAPILLARY][a] = value[CAPILLARY];
    if (cloud->field[FIELD_BENDING]) cloud->field[FIELD_BENDING][a] = value[BENDING];
    for (PetscInt d = 0; d < DIM; d++) {
      cloud->field[FIELD_CAPILLARY_SLOPE][DIM * a + d] = value[SLOPE + d];
      cloud->field[FIELD_ACCELERATION][DIM * a + d] += value[PULL + d];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
