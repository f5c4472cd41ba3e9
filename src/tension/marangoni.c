/* The force grad_s sigma along a surface that liquids of different tension share, towards the larger tension. Without
   it the forces on a piece of liquid would not add up to zero: int sigma kappa n dA is not zero, int (sigma kappa n +
   grad_s sigma) dA is. A particle has the area 2 V |n| of the surface, n = sum V grad W, as for the pressure sigma
   kappa (gradient.c). */
#include "../neighbors/pairs.h"
#include "curvature.h"

#define INSIDE 0.1 /* h |n| due to disorder: up to this a particle has no surface */

/* Finds the tension (N/m) of each body; returns whether they differ. */
static PetscBool Tensions(Scene scene, PetscReal sigma[SCENE_MAX_BODIES])
{
  PetscBool differ = PETSC_FALSE;

  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    sigma[b] = BodyMaterial(SceneBody(scene, b))->tension;
    if (sigma[b] != sigma[0]) differ = PETSC_TRUE;
  }
  return differ;
}

void MarangoniAdd(Cloud cloud)
{
  const PetscInt  *layer = cloud->integer[INT_LAYER], *body = cloud->integer[INT_BODY];
  const PetscReal *x = cloud->field[FIELD_POSITION];
  PetscReal        sigma[SCENE_MAX_BODIES], scale_w, scale_f, inverse_h2;
  PairRow          row;

  if (!Tensions(cloud->scene, sigma)) return;
  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *n = cloud->field[FIELD_NORMAL] + DIM * a, n2 = Dot(n, n),
                    least = INSIDE / (cloud->size[a] * KernelSmoothingLength(cloud->kernel));
    PetscReal slope[DIM]  = {0, 0, 0}, along, grad[DIM];

    if (n2 < least * least) continue;
    PairRowLoadFactors(cloud, a, &row);
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt  b    = row.index[k];
      const PetscReal jump = layer[b] ? 0 : sigma[body[b]] - sigma[body[a]];

      for (PetscInt d = 0; d < DIM; d++) slope[d] += jump * row.f[k] * (x[DIM * a + d] - x[DIM * b + d]);
    }
    TensorApply(cloud->field[FIELD_CORRECTION] + 6 * a, slope[0], slope[1], slope[2], grad);
    along = Dot(grad, n) / n2;
    for (PetscInt d = 0; d < DIM; d++)
      cloud->field[FIELD_ACCELERATION][DIM * a + d] +=
        2 * PetscSqrtReal(n2) * cloud->domain->volume * scale_f * (grad[d] - along * n[d]) / cloud->rest_density[a];
  }
}
