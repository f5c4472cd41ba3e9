/* How particles are made, for those who make some, here or in the folder of an edge. */
#ifndef ISPH_SAMPLES_H
#define ISPH_SAMPLES_H

#include "packing.h"

/* A particle to be made: position x (m), velocity v (m/s) and integers as in the field table. density (kg/m3): 0 if it
   is summed later. area: the area of a ring, or the volume of a graded particle, over V_0. size: of a graded ring; 0:
   the finest size. */
typedef struct {
  PetscReal x[DIM], v[DIM], density, area, size;
  PetscInt  id, parent, body, layer;
} Sample;

static inline PetscReal SampleSize(const Sample *sample)
{
  return sample->size > 0 ? sample->size : 1;
}

/* A source passes its samples, one after the other, to a visitor: on each rank a part of them. Positions and ids do not
   depend on the number of ranks. Collective. */
typedef PetscErrorCode (*SampleVisitor)(void *context, const Sample *sample);
typedef PetscErrorCode (*SampleSource)(void *source, SampleVisitor visitor, void *context);

/* OwnShare - this rank's share of 'count' points: first to last - 1. Not collective. OwnNumbers - *first: the sum of n
   over the ranks before this one, *last: over all. Collective. */
void           OwnShare(MPI_Comm comm, PetscInt count, PetscInt *first, PetscInt *last);
PetscErrorCode OwnNumbers(MPI_Comm comm, PetscInt n, PetscInt *first, PetscInt *last);
/* SampleKeep - a visitor: adds the sample to a PetscSegBuffer of samples. SamplesTake - the n samples of the buffer,
   which is destroyed; the caller frees them with PetscFree. Not collective. */
PetscErrorCode SampleKeep(void *buffer, const Sample *sample);
PetscErrorCode SamplesTake(PetscSegBuffer *buffer, PetscInt *n, Sample **sample);
/* SamplesAppend - appends this rank's samples to the swarm, with ids and parents counted from first_id on; *count:
   number of samples on all ranks. CloudResync then moves them to the ranks of their cells. Collective. */
PetscErrorCode SamplesAppend(Particles particles, Domain domain, SampleSource visit, void *source, PetscInt first_id,
                             PetscInt *count);

/* LatticeVisitBody - passes the lattice points of one body to the visitor; shaken: with the jitter. Collective. */
PetscErrorCode LatticeVisitBody(Packing packing, PetscInt body, PetscBool shaken, SampleVisitor visitor, void *context);

#endif
