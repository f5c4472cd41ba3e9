/* The model curvature: its tables, options and data. curvature.c finds the curvature of one surface, interface.c has
   those of two liquids. */
#include "../base/simd.h"
#include "curvature.h"

/* With half of this limit drops, threads, sheets and contact lines behave the same, in up to twice the steps. */
#define STEP_LIMIT 0.5
/* The curvature is smoothed over H, so short waves are slow: forces at the middle of the step are stable up to 7.6 to
   8.5 times the unit (-spectrum); rings at rest move more than they should from 6 on. */
#define STEP_MOST 4

/* Tabulates depth and filled fraction of the neighbourhood of a flat surface. */
static PetscErrorCode CurvatureSetUp(void *owner)
{
  Tension         tension  = (Tension)owner;
  Curvature      *data     = tension->data;
  const PetscReal support  = KernelSupport(tension->kernel);
  PetscReal       fraction = 0.5, next = 0.5;

  PetscFunctionBegin;
  WideStart();
  PetscCall(KernelCreate(tension->comm, tension->dim, &data->core));
  PetscCall(KernelSetSmoothingLength(data->core, SHEET_CORE * KernelSmoothingLength(tension->kernel)));
  KernelHalfSpace(tension->kernel, 0, &data->plane, NULL);
  KernelSurfaceTable(tension->kernel, WALL_TABLE, data->fraction);
  for (PetscInt k = 0, m = 0; k <= WALL_TABLE; k++) { /* depth[k]: half-space fills (1 + k/WALL_TABLE)/2 */
    const PetscReal wanted = 0.5 + 0.5 * k / WALL_TABLE;

    while (m < WALL_TABLE && next < wanted) {
      fraction = next;
      m++;
      next += KernelSlice(tension->kernel, support * (m - 1) / WALL_TABLE, support * m / WALL_TABLE);
    }
    data->depth[k] = support / WALL_TABLE * (m > 0 ? m - 1 + PetscMin(1, (wanted - fraction) / (next - fraction)) : 0);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TensionApply_Curvature(Tension tension, Cloud cloud)
{
  Curvature *data = tension->data;

  PetscFunctionBegin;
  if (tension->rings) PetscCall(LooseFind(tension, cloud));
  if (data->contact.lines_move) PetscCall(MovingLines.start(data->contact.lines, cloud, &data->contact.bend));
  PetscCall(tension->surfaces ? tension->surfaces(tension, cloud) : TensionSurface(tension, cloud, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy(Tension tension)
{
  Curvature *data = tension->data;

  PetscFunctionBegin;
  PetscCall(KernelDestroy(&data->core));
  PetscCall(ContactDestroy(tension));
  PetscCall(ImagesDestroy(tension));
  PetscCall(PetscFree(data->weight));
  PetscCall(PetscFree(data->place));
  PetscCall(PetscFree(data->loose));
  PetscCall(PetscFree(data->close));
  for (PetscInt l = 0; l < SIZE_LEVELS; l++) {
    PetscCall(SortedCellsReset(&data->surface[l]));
    PetscCall(PetscFree(data->fit[l]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

const TensionModel TensionCurvature = {
  .choice     = {TENSION_CURVATURE, sizeof(Curvature), NULL, NULL, CurvatureSetUp},
  .more       = ContactSetFromOptions,
  .apply      = TensionApply_Curvature,
  .destroy    = Destroy,
  .on_surface = PETSC_TRUE,
  .step_limit = STEP_LIMIT,
  .step_most  = STEP_MOST,
};
