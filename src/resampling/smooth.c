/* Smoothing. Particles that have just split or joined stand unevenly, and the pressure would move them: those inside
   the liquid go down the slope of the filled fraction. They keep their velocities, so momentum is kept to round-off,
   and the mean of their displacements is taken back, so that the centre of mass stays. */
#include "resampling_impl.h"

#define STRENGTH 0.5  /* dr = -0.5 h^2 sum V grad W */
#define DISORDER 0.03 /* h |sum V grad W| from which on a particle moves; a particle of a film at rest has 0.01 */
#define FARTHEST 0.1  /* spacings of the particle */

/* The displacement dr (m) of fluid particle a; false: it stays. */
static PetscBool Displacement(Cloud cloud, PetscInt a, PetscReal dr[DIM])
{
  const PetscReal *slope = cloud->field[FIELD_NORMAL] + DIM * a, spacing = cloud->size[a] * cloud->domain->spacing,
                  h = cloud->size[a] * KernelSmoothingLength(cloud->kernel), length = Norm(slope);
  const PetscReal move = PetscMin(STRENGTH * h * h * length, FARTHEST * spacing);

  if (cloud->integer[INT_SURFACE][a] != 0 || h * length <= DISORDER) return PETSC_FALSE;
  for (PetscInt d = 0; d < DIM; d++) dr[d] = -move * slope[d] / length;
  return PETSC_TRUE;
}

PetscErrorCode SmoothDisorder(Cloud cloud)
{
  const Domain   domain = cloud->domain;
  ParticleArrays arrays;
  PetscReal      dr[DIM], sum[DIM + 1] = {0, 0, 0, 0}; /* of V dr; of V */

  PetscFunctionBegin;
  PetscCall(OperatorsMoments(cloud, NULL));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    if (!Displacement(cloud, a, dr)) continue;
    for (PetscInt d = 0; d < DIM; d++) sum[d] += cloud->volume[a] * cloud->rest_density[a] * dr[d];
    sum[DIM] += cloud->volume[a] * cloud->rest_density[a];
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, DIM + 1, MPIU_REAL, MPI_SUM, cloud->comm));
  if (domain->rings) sum[0] = 0; /* all around it has no mean */
  PetscCall(ParticlesOpen(cloud->particles, &arrays));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal *x = arrays.real[FIELD_POSITION] + DIM * a;

    if (!Displacement(cloud, a, dr)) continue;
    for (PetscInt d = 0; d < DIM; d++) x[d] += dr[d] - sum[d] / sum[DIM];
    DomainConfine(domain, x);
  }
  PetscCall(ParticlesClose(cloud->particles, &arrays));
  PetscCall(CloudResync(cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}
