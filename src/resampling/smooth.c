/* Smoothing. Particles that have just split or joined stand unevenly, and the pressure would move them: those inside
   the liquid go down the slope of the filled fraction. They keep their velocities, so momentum is kept to round-off. */
#include "resampling_impl.h"

#define STRENGTH 0.5  /* dr = -0.5 h^2 sum V grad W */
#define DISORDER 0.03 /* h |sum V grad W| from which on a particle moves; a particle of a film at rest has 0.01 */
#define FARTHEST 0.1  /* spacings of the particle */

PetscErrorCode SmoothDisorder(Cloud cloud)
{
  const Domain   domain = cloud->domain;
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(OperatorsMoments(cloud, NULL));
  PetscCall(ParticlesOpen(cloud->particles, &arrays));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *slope = cloud->field[FIELD_NORMAL] + DIM * a, spacing = cloud->size[a] * domain->spacing,
                    h = cloud->size[a] * KernelSmoothingLength(cloud->kernel), length = Norm(slope);
    const PetscReal move = PetscMin(STRENGTH * h * h * length, FARTHEST * spacing);

    if (cloud->integer[INT_SURFACE][a] != 0 || h * length <= DISORDER) continue;
    for (PetscInt d = 0; d < DIM; d++) arrays.real[FIELD_POSITION][DIM * a + d] -= move * slope[d] / length;
    DomainConfine(domain, arrays.real[FIELD_POSITION] + DIM * a);
  }
  PetscCall(ParticlesClose(cloud->particles, &arrays));
  PetscCall(CloudResync(cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}
