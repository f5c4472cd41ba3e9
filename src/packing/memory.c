/* Checks that the particles of a scene fit the memory, before any is made. */
#include "packing_impl.h"
#include <unistd.h>

#define PARTICLE_LEAST 500 /* bytes of a particle, at least: 1.1 kB in two dimensions, 1.7 kB in three by default */
#define SAMPLES        16  /* probes of a body in each direction */

/* The number of particles of the bodies, to a few percent, and of the box's walls. */
static PetscReal EstimateParticles(Packing packing)
{
  const Domain    domain = packing->cloud->domain;
  const PetscInt  n[DIM] = {SAMPLES, SAMPLES, domain->dim == DIM ? SAMPLES : 1}, points = n[0] * n[1] * n[2];
  const PetscReal layers = (PetscReal)CloudWallLayers(packing->cloud);
  PetscReal       count = 0, box = 1, walled = 1;

  for (PetscInt b = 0; b < SceneCount(packing->cloud->scene); b++) {
    const Body body   = SceneBody(packing->cloud->scene, b);
    PetscReal  volume = 1 / domain->volume, inside = 0, lower[DIM], upper[DIM], x[DIM];

    BodyBounds(body, lower, upper);
    for (PetscInt d = 0; d < domain->dim; d++) volume *= upper[d] - lower[d];
    for (PetscInt k = 0; k < points; k++) {
      PetscInt at[DIM];

      CellCoordinates(n, k, at);
      for (PetscInt d = 0; d < DIM; d++) x[d] = lower[d] + (upper[d] - lower[d]) * (at[d] + 0.5) / n[d];
      if (BodyContains(body, x))
        inside += PetscPowRealInt(domain->spacing / SceneSpacing(packing->cloud->scene, x), (int)domain->dim);
    }
    count += volume * inside / points;
  }
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal spacings = (domain->upper[d] - domain->lower[d]) / domain->spacing;

    box *= spacings;
    walled *= spacings + layers * ((domain->face[d][0] == FACE_WALL) + (domain->face[d][1] == FACE_WALL));
  }
  return domain->graded ? count : count + walled - box; /* few dummy particles have the fine size */
}

/* Linux grants more memory than there is and kills the run later. */
PetscErrorCode PackingCheckMemory(Packing packing)
{
  const MPI_Comm comm  = packing->cloud->comm;
  const double   bytes = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE),
               count   = EstimateParticles(packing);
  double      room;
  PetscMPIInt neighbors;
  MPI_Comm    machine;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine));
  PetscCallMPI(MPI_Comm_size(machine, &neighbors));
  PetscCallMPI(MPI_Comm_free(&machine));
  room = bytes / neighbors;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &room, 1, MPI_DOUBLE, MPI_SUM, comm));
  PetscCheckUser(bytes <= 0 || count * PARTICLE_LEAST <= room, comm,
                 "-spacing %g m is too small for the memory: about %.2g particles take more than %.3g GB, there are "
                 "%.3g GB",
                 (double)packing->cloud->domain->spacing, count, count * PARTICLE_LEAST / 1e9, room / 1e9);
  PetscFunctionReturn(PETSC_SUCCESS);
}
