/* Conduction between particles, dT_a/dt = 1/(m_a c_a) sum over b of what a pair exchanges (W):

     Q_ab = 2 V_a V_b k_ab F_ab (T_b - T_a)/C_ab,    k_ab = 2 k_a k_b/(k_a + k_b),    C_ab = (C_a + C_b)/2

   the sum of Brookshaw (1985) with the mean of Cleary and Monaghan (1999). F = -W'/r. C_a is the second moment of the
   sum, sum V_b r^2 F_ab/dim, 1 but for the places of the particles; near a free surface, which no heat crosses, the
   missing pairs are none of it: 1. What a gives is what b gets. */
#include "../neighbors/pairs.h"
#include "heat_impl.h"

/* V_b F_ab (m-2) of a pair, with the length of the ring half-way between both. */
static PetscReal Slope(Cloud cloud, PetscInt64 k, PetscReal scale_f)
{
  return -cloud->domain->volume * scale_f * cloud->slope[k];
}

/* C ([n_total], ghosts too). */
static PetscErrorCode FindMoments(Cloud cloud, PetscReal scale_f, PetscReal C[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    C[a] = 0;
    for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
      const PetscInt  b      = cloud->list[k];
      const PetscReal r[DIM] = {x[DIM * a] - x[DIM * b], x[DIM * a + 1] - x[DIM * b + 1],
                                x[DIM * a + 2] - x[DIM * b + 2]};

      C[a] += Slope(cloud, k, scale_f) * Dot(r, r) / cloud->domain->dim;
    }
    if (cloud->integer[INT_SURFACE][a]) C[a] = 1;
  }
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, C));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode HeatSpread(Cloud cloud, PetscReal dt)
{
  PetscReal *T = cloud->field[FIELD_TEMPERATURE], *C, *change, scale_w, scale_f, inverse_h2;

  PetscFunctionBegin;
  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  PetscCall(CloudUpdate(cloud, FIELD_TEMPERATURE));
  PetscCall(CloudGetWork(cloud, 1, &C));
  PetscCall(CloudGetWork(cloud, 1, &change));
  PetscCall(FindMoments(cloud, scale_f, C));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const BodyHeat *own  = HeatOf(cloud->scene, cloud->integer[INT_BODY][a]);
    const PetscReal heat = cloud->rest_density[a] * own->capacity; /* J/(m3 K) */

    change[a] = 0;
    for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
      const PetscInt  b   = cloud->list[k];
      const BodyHeat *its = cloud->integer[INT_LAYER][b] ? NULL : HeatOf(cloud->scene, cloud->integer[INT_BODY][b]);
      const PetscReal sum = its ? own->conductivity + its->conductivity : 0;

      if (sum == 0) continue;
      change[a] += dt / heat * 2 * own->conductivity * its->conductivity / sum * Slope(cloud, k, scale_f) *
                   (1 + cloud->length[b] / cloud->length[a]) * (T[b] - T[a]) * 2 / (C[a] + C[b]);
    }
  }
  for (PetscInt a = 0; a < cloud->n_fluid; a++) T[a] += change[a];
  PetscCall(CloudRestoreWork(cloud, &change));
  PetscCall(CloudRestoreWork(cloud, &C));
  PetscFunctionReturn(PETSC_SUCCESS);
}
