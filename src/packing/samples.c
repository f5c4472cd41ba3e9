/* Makes particles from samples: every rank visits its part of a source. */
#include "packing_impl.h"

void OwnShare(MPI_Comm comm, PetscInt count, PetscInt *first, PetscInt *last)
{
  PetscMPIInt rank, size;

  (void)MPI_Comm_rank(comm, &rank);
  (void)MPI_Comm_size(comm, &size);
  *first = (PetscInt)((PetscInt64)count * rank / size);
  *last  = (PetscInt)((PetscInt64)count * (rank + 1) / size);
}

PetscErrorCode OwnNumbers(MPI_Comm comm, PetscInt n, PetscInt *first, PetscInt *last)
{
  PetscFunctionBegin;
  *last = n;
  PetscCallMPI(MPI_Scan(&n, first, 1, MPIU_INT, MPI_SUM, comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, last, 1, MPIU_INT, MPI_SUM, comm));
  *first -= n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SampleKeep(void *buffer, const Sample *sample)
{
  Sample *kept;

  PetscFunctionBegin;
  PetscCall(PetscSegBufferGet((PetscSegBuffer)buffer, 1, &kept));
  *kept = *sample;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SamplesTake(PetscSegBuffer *buffer, PetscInt *n, Sample **sample)
{
  size_t size;

  PetscFunctionBegin;
  PetscCall(PetscSegBufferGetSize(*buffer, &size));
  PetscCall(PetscSegBufferExtractAlloc(*buffer, sample));
  PetscCall(PetscSegBufferDestroy(buffer));
  *n = (PetscInt)size;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SamplesAppend(Particles particles, Domain domain, SampleSource visit, void *source, PetscInt first_id,
                             PetscInt *count)
{
  ParticleArrays arrays;
  PetscSegBuffer own;
  PetscInt       next, n, first;
  Sample        *sample;

  PetscFunctionBegin;
  PetscCall(PetscSegBufferCreate(sizeof(Sample), 1024, &own));
  PetscCall(visit(source, SampleKeep, own));
  PetscCall(SamplesTake(&own, &n, &sample));
  PetscCallMPI(MPI_Allreduce(&n, count, 1, MPIU_INT, MPI_SUM, domain->comm));
  PetscCall(ParticlesLocalSize(particles, &first));
  next = first;
  PetscCall(ParticlesAppend(particles, n));
  PetscCall(ParticlesOpen(particles, &arrays));
  for (PetscInt k = 0; k < n; k++, next++) {
    PetscCall(PetscArraycpy(arrays.real[FIELD_POSITION] + DIM * next, sample[k].x, DIM));
    PetscCall(PetscArraycpy(arrays.real[FIELD_VELOCITY] + DIM * next, sample[k].v, DIM));
    arrays.real[FIELD_DENSITY][next] = sample[k].density;
    if (arrays.real[FIELD_SIZE]) arrays.real[FIELD_SIZE][next] = SampleSize(&sample[k]);
    if (arrays.real[FIELD_VOLUME])
      arrays.real[FIELD_VOLUME][next] =
        sample[k].area * domain->volume * DomainRingLength(domain, sample[k].x, SampleSize(&sample[k]));
    if (arrays.real[FIELD_COLOUR]) arrays.real[FIELD_COLOUR][next] = sample[k].body == 0 ? 1 : 0;
    arrays.integer[INT_ID][next]     = first_id + sample[k].id;
    arrays.integer[INT_PARENT][next] = first_id + sample[k].parent;
    arrays.integer[INT_BODY][next]   = sample[k].body;
    arrays.integer[INT_LAYER][next]  = sample[k].layer;
  }
  ParticlesStart(particles, first, &arrays);
  PetscCall(ParticlesClose(particles, &arrays));
  PetscCall(PetscFree(sample));
  PetscFunctionReturn(PETSC_SUCCESS);
}
