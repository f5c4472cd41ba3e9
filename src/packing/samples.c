/* Makes particles from samples: every rank visits all samples of a source and keeps those of its cells, or visits its
   share of them, which then move to the ranks of their cells. */
#include "packing_impl.h"

typedef struct {
  Domain         domain;
  PetscMPIInt    rank;
  PetscBool      shared;
  PetscInt      *weight; /* [cells] */
  PetscInt       count;  /* samples seen */
  PetscSegBuffer own;    /* of this rank */
} Selection;

static PetscErrorCode WeighSample(void *context, const Sample *sample)
{
  Selection *selection = (Selection *)context;

  selection->count++;
  selection->weight[DomainCell(selection->domain, sample->x)]++;
  return PETSC_SUCCESS;
}

PetscErrorCode SamplesWeigh(Domain domain, SampleSource visit, void *source, PetscInt weight[], PetscInt *count)
{
  Selection selection = {.domain = domain, .weight = weight};

  PetscFunctionBegin;
  PetscCall(visit(source, WeighSample, &selection));
  *count = selection.count;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode KeepSample(void *context, const Sample *sample)
{
  Selection *selection = (Selection *)context;
  Sample    *kept;

  PetscFunctionBegin;
  selection->count++;
  if (selection->shared || selection->domain->cell_rank[DomainCell(selection->domain, sample->x)] == selection->rank) {
    PetscCall(PetscSegBufferGet(selection->own, 1, &kept));
    *kept = *sample;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SamplesAppend(Particles particles, Domain domain, SampleSource visit, PetscBool shared, void *source,
                             PetscInt first_id, PetscInt *count)
{
  Selection      selection = {.domain = domain, .shared = shared};
  ParticleArrays arrays;
  PetscInt       next;
  size_t         n;
  Sample        *sample;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(domain->comm, &selection.rank));
  PetscCall(PetscSegBufferCreate(sizeof(Sample), 1024, &selection.own));
  PetscCall(visit(source, KeepSample, &selection));
  *count = selection.count;
  if (shared) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, count, 1, MPIU_INT, MPI_SUM, domain->comm));
  PetscCall(PetscSegBufferGetSize(selection.own, &n));
  PetscCall(PetscSegBufferExtractInPlace(selection.own, &sample));
  PetscCall(ParticlesLocalSize(particles, &next));
  PetscCall(ParticlesAppend(particles, (PetscInt)n));
  PetscCall(ParticlesOpen(particles, &arrays));
  for (size_t k = 0; k < n; k++, next++) {
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
  PetscCall(ParticlesClose(particles, &arrays));
  PetscCall(PetscSegBufferDestroy(&selection.own));
  if (shared) PetscCall(ParticlesMigrate(particles));
  PetscFunctionReturn(PETSC_SUCCESS);
}
