/* Arrays of the whole box, of which all ranks of a machine have one copy: bytes and work of a rank fall with their
   number. */
#ifndef ISPH_SHARED_H
#define ISPH_SHARED_H

#include "base.h"

typedef struct {
  void       *data;             /* the copy of this machine, zero at the start */
  PetscBool   leads;            /* this rank does for its machine what one rank must do */
  PetscMPIInt rank, size;       /* of this machine */
  MPI_Comm    machine, leaders; /* leaders: of several machines, else MPI_COMM_NULL */
  MPI_Win     window;           /* MPI_WIN_NULL: this rank alone has the copy */
} Shared;

/* SharedCreate - bytes of zeros. SharedFence - what a rank wrote before it, all ranks of its machine read after it.
   SharedReduce - the same, and the copies of several machines become one by an operation on 'count' values from 'at'
   on. SharedDestroy - may be called without SharedCreate if all bytes are zero. Collective. */
PetscErrorCode SharedCreate(MPI_Comm comm, size_t bytes, Shared *shared);
PetscErrorCode SharedFence(const Shared *shared);
PetscErrorCode SharedReduce(const Shared *shared, void *at, PetscInt count, MPI_Datatype type, MPI_Op op);
PetscErrorCode SharedDestroy(Shared *shared);

/* SharedOr, SharedMin - write to a place that other ranks write to as well; the result does not depend on their order.
   Not collective. */
static inline void SharedOr(unsigned char *at, unsigned char bits)
{
  (void)__atomic_fetch_or(at, bits, __ATOMIC_RELAXED);
}
static inline void SharedMin(float *at, float value)
{
  float has;

  __atomic_load(at, &has, __ATOMIC_RELAXED);
  while (value < has && !__atomic_compare_exchange(at, &has, &value, 0, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
}

#endif
