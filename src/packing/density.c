/* The summed density of the particles. */
#include "packing_impl.h"

/* Loads the row of particle a, with kernel values W. Returns the volume fraction V_0 (W(0) + sum_b W_ab),
   dimensionless: the density over rho_0. */
static PetscReal Fraction(Cloud cloud, PetscInt a, PairRow *row)
{
  const PetscReal self = KernelSelf(cloud->kernel);
  PetscReal       sum  = 0;

  PairRowLoadGeometry(cloud, cloud->field[FIELD_POSITION], a, row);
  PairRowEvaluate(cloud, a, row);
  for (PetscInt k = 0; k < row->n; k++) row->W[k] *= cloud->weight[row->index[k]];
  SIMD_LOOP(reduction(+ : sum))
  for (PetscInt k = 0; k < row->n; k++) sum += row->W[k];
  return cloud->domain->volume * (sum + cloud->relative_weight[a] * self);
}

PetscErrorCode PackingMeasure(Packing packing, PackingReport *report)
{
  const Cloud cloud = packing->cloud;
  PairRow    *row;
  PetscReal   squares = 0, closest2 = PETSC_MAX_REAL;

  PetscFunctionBegin;
  PetscCall(PetscNew(&row));
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    const PetscReal rest = cloud->rest_density[a], fraction = Fraction(cloud, a, row);

    cloud->field[FIELD_DENSITY][a] = rest * fraction;
    if (a >= cloud->n_fluid) continue;
    squares += PetscSqr(rest * (fraction - 1));
    for (PetscInt k = 0; k < row->n; k++)
      if (cloud->integer[INT_LAYER][row->index[k]] == 0)
        closest2 = PetscMin(closest2, row->r2[k] / PetscSqr(CloudPairSize(cloud, a, row->index[k])));
  }
  PetscCall(PetscFree(row));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &squares, 1, MPIU_REAL, MPIU_SUM, cloud->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &closest2, 1, MPIU_REAL, MPIU_MIN, cloud->comm));
  report->density_std = PetscSqrtReal(squares / PetscMax(packing->count, 1));
  report->smallest_distance =
    closest2 < PETSC_MAX_REAL ? PetscSqrtReal(closest2) / cloud->domain->spacing : PETSC_INFINITY;
  PetscFunctionReturn(PETSC_SUCCESS);
}
