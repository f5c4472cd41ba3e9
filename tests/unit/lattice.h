/* A cloud whose particles are cut out of a lattice, its gauges and its output. */
#ifndef ISPH_LATTICE_H
#define ISPH_LATTICE_H

#include "../../src/output/output.h"
#include "refuse.h"
#include "setup.h"
#include <string.h>

#define D0 0.5e-3 /* spacing of the lattice, m */

typedef struct {
  Setup     set;
  Domain    domain; /* of it ... */
  Scene     scene;
  Particles particles;
  Cloud     cloud;
  Gauges    gauges; /* ... and its own */
  Output    output;
} Run;

static MPI_Comm world; /* of the runs: all ranks, or this one alone */

static inline PetscErrorCode RunCreate(const char options[], Run *run)
{
  PetscFunctionBegin;
  PetscCall(SetupOpenOn(world, options, &run->set));
  run->domain    = run->set.domain;
  run->scene     = run->set.scene;
  run->particles = run->set.particles;
  run->cloud     = run->set.cloud;
  PetscCall(GaugesCreate(run->cloud, &run->gauges));
  PetscCall(GaugesSetFromOptions(run->gauges));
  PetscCall(OutputCreate(run->cloud, run->gauges, &run->output));
  PetscCall(OutputSetFromOptions(run->output));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static inline PetscErrorCode RunDestroy(Run *run)
{
  PetscFunctionBegin;
  PetscCall(OutputDestroy(&run->output));
  PetscCall(GaugesDestroy(&run->gauges));
  PetscCall(SetupClose(&run->set));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which liquid is there: r is the distance from the vertical axis, z the height over the bottom, m. Returns the body +
 * 1, or 0. */
typedef int (*Shape)(PetscReal r, PetscReal z);

/* Appends the particles of a shape, spread over the ranks in turn, displaced at random by up to jitter spacings. */
static inline PetscErrorCode Fill(Run *run, Shape shape, PetscReal jitter)
{
  const Domain   domain = run->domain;
  const PetscInt up     = domain->dim - 1;
  PetscInt       cells[DIM], local = 0;
  PetscMPIInt    rank, size;
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(domain->comm, &rank));
  PetscCallMPI(MPI_Comm_size(domain->comm, &size));
  for (PetscInt d = 0; d < DIM; d++) cells[d] = (PetscInt)((domain->upper[d] - domain->lower[d]) / D0 + 0.5);
  for (PetscInt pass = 0; pass < 2; pass++) {
    PetscInt id = 0, k = 0;

    if (pass) {
      PetscCall(ParticlesAppend(run->particles, local));
      PetscCall(ParticlesOpen(run->particles, &arrays));
    }
    for (PetscInt c = 0; c < cells[0] * cells[1] * cells[2]; c++) {
      const PetscInt  index[DIM] = {c % cells[0], c / cells[0] % cells[1], c / cells[0] / cells[1]};
      PetscReal       x[DIM];
      const PetscInt *i = index;
      int             body;

      for (PetscInt d = 0; d < DIM; d++) x[d] = domain->lower[d] + (i[d] + 0.5) * D0;
      body = shape(domain->dim == 2 ? PetscAbsReal(x[0]) : PetscSqrtReal(x[0] * x[0] + x[1] * x[1]), x[up]);
      if (!body) continue;
      if (id++ % size != rank) continue;
      if (!pass) {
        local++;
        continue;
      }
      for (PetscInt d = 0; d < domain->dim; d++)
        x[d] += jitter * D0 * (2 * RandomUnit(7, DIM * (unsigned long long)id + d) - 1);
      for (PetscInt d = 0; d < DIM; d++) arrays.real[FIELD_POSITION][DIM * k + d] = x[d];
      for (PetscInt d = 0; d < DIM; d++) arrays.real[FIELD_VELOCITY][DIM * k + d] = d == up ? 2.0 : 0;
      arrays.real[FIELD_DENSITY][k] = 1000 + id;
      arrays.integer[INT_ID][k]     = id - 1;
      arrays.integer[INT_PARENT][k] = id - 1;
      arrays.integer[INT_BODY][k++] = body - 1;
    }
    if (pass) PetscCall(ParticlesClose(run->particles, &arrays));
  }
  PetscCall(CloudResync(run->cloud)); /* the gauges follow the neighbour lists */
  PetscFunctionReturn(PETSC_SUCCESS);
}

#endif
