/* The tension of every second step is that of the two before, continued in a straight line in time, where the step is
   well below what tension allows. The curvature is the dearest part of a step near a surface; there it costs half.

   A tension that is merely held acts late by a quarter of the step in the mean: waves of a rate w gain w2 dt/4 of their
   amplitude in a unit of time, a fifth of the damping of a drop with 8 spacings in its radius. Continued, the errors
   are of the third order: periods, damping and rest of drops and waves are the same within 0.2 %, with viscosity and
   without. What is kept are the numbers of the particles in their local order, so after a new order, as after a
   checkpoint, two steps have their own. */
#include "curvature.h"

#define CAPILLARY 0 /* columns of Applied: pressure, its slope, bending, acceleration */
#define SLOPE     1
#define BENDING   4
#define PULL      5

/* Whether the tension follows from the places alone, of one surface. */
static PetscBool DependsOnPlaces(Tension tension)
{
  return (PetscBool)(tension->model->on_surface && !tension->surfaces && !TensionHasLaw(tension) &&
                     !TensionHasHysteresis(tension));
}

/* Keeps what the tension has given at a time (s). before: FIELD_ACCELERATION without it. */
static PetscErrorCode Keep(Tension tension, Cloud cloud, PetscReal time, const PetscReal before[])
{
  const PetscReal *capillary = cloud->field[FIELD_CAPILLARY], *slope = cloud->field[FIELD_CAPILLARY_SLOPE],
                  *bending = cloud->field[FIELD_BENDING], *after = cloud->field[FIELD_ACCELERATION];
  Applied kept             = tension->applied[1];

  PetscFunctionBegin;
  if (cloud->n_fluid > kept.capacity) {
    kept.capacity = cloud->capacity;
    PetscCall(PetscFree2(kept.of, kept.value));
    PetscCall(PetscMalloc2(kept.capacity, &kept.of, kept.capacity, &kept.value));
  }
  kept.n      = 0;
  kept.time   = time;
  kept.layout = cloud->layout;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal *value = kept.value[kept.n], sum = PetscAbsReal(capillary[a]);

    value[CAPILLARY] = capillary[a];
    value[BENDING]   = bending ? bending[a] : 0;
    for (PetscInt d = 0; d < DIM; d++) {
      value[SLOPE + d] = slope[DIM * a + d];
      value[PULL + d]  = after[DIM * a + d] - before[DIM * a + d];
      sum += PetscAbsReal(value[PULL + d]);
    }
    if (sum > 0) kept.of[kept.n++] = a;
  }
  tension->applied[1] = tension->applied[0];
  tension->applied[0] = kept;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Continues both to a time (s); what only the last has stays. */
static void Continue(Tension tension, Cloud cloud, PetscReal time)
{
  const Applied  *last = &tension->applied[0], *former = &tension->applied[1];
  const PetscReal ahead = (time - last->time) / (last->time - former->time);

  for (PetscInt k = 0, j = 0; k < last->n; k++) {
    const PetscInt   a   = last->of[k];
    const PetscReal *own = last->value[k];
    PetscReal        value[APPLIED];

    while (j < former->n && former->of[j] < a) j++;
    for (PetscInt i = 0; i < APPLIED; i++)
      value[i] = own[i] + (j < former->n && former->of[j] == a ? ahead * (own[i] - former->value[j][i]) : 0);
    cloud->field[FIELD_CAPILLARY][a] = value[CAPILLARY];
    if (cloud->field[FIELD_BENDING]) cloud->field[FIELD_BENDING][a] = value[BENDING];
    for (PetscInt d = 0; d < DIM; d++) {
      cloud->field[FIELD_CAPILLARY_SLOPE][DIM * a + d] = value[SLOPE + d];
      cloud->field[FIELD_ACCELERATION][DIM * a + d] += value[PULL + d];
    }
  }
}

PetscErrorCode TensionContinue(Tension tension, Cloud cloud, PetscReal time)
{
  const Applied  *last = &tension->applied[0], *former = &tension->applied[1];
  const PetscBool follows =
    (PetscBool)(!tension->continued && former->layout == cloud->layout && former->time < last->time &&
                last->time < time && last->layout == cloud->layout);
  PetscReal *before;

  PetscFunctionBegin;
  if (!tension->active || !DependsOnPlaces(tension)) {
    PetscCall(TensionApply(tension, cloud));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  tension->continued = follows;
  if (follows) {
    TensionClear(cloud);
    Continue(tension, cloud, time);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(CloudGetWork(cloud, DIM, &before));
  PetscCall(PetscArraycpy(before, cloud->field[FIELD_ACCELERATION], DIM * cloud->n_fluid));
  PetscCall(TensionApply(tension, cloud));
  PetscCall(Keep(tension, cloud, time, before));
  PetscCall(CloudRestoreWork(cloud, &before));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ContinuedDestroy(Tension tension)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2; k++) PetscCall(PetscFree2(tension->applied[k].of, tension->applied[k].value));
  PetscFunctionReturn(PETSC_SUCCESS);
}
