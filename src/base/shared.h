/* Arrays of the whole box, of which all ranks of a machine have one copy: bytes and work of a rank fall with their
   number. */
#ifndef ISPH_SHARED_H
#define ISPH_SHARED_H

#include "base.h"

typedef struct {
  void       *data;             /* the copy of this machine, zero at the start */
  PetscBool   leads;            /* this rank does for its machine what one rank must do */
  PetscMPIInt rank, size;       /* of this machine */
  PetscMPIInt of_all[2];        /* rank and size of the communicator */
  MPI_Comm    machine, leaders; /* leaders: of several machines, else MPI_COMM_NULL */
  MPI_Win     window;           /* MPI_WIN_NULL: this rank alone has the copy */
} Shared;

/* An array of it: where its address goes, how many members of how many bytes it has. */
typedef struct {
  void    *address;
  PetscInt count;
  size_t   bytes;
} SharedArray;

/* SharedCreate - lays n arrays of zeros. SharedFence - what a rank wrote before it, all ranks of its machine read after
   it. SharedReduce - the same, and the copies of several machines become one by an operation on 'count' values from
   'at' on. SharedDestroy - may be called without SharedCreate if all bytes are zero. Collective. */
PetscErrorCode SharedCreate(MPI_Comm comm, PetscInt n, const SharedArray array[], Shared *shared);
PetscErrorCode SharedFence(const Shared *shared);
PetscErrorCode SharedReduce(const Shared *shared, void *at, PetscInt count, MPI_Datatype type, MPI_Op op);
PetscErrorCode SharedDestroy(Shared *shared);

/* SharedCount - of counts of the ranks of a machine the sum before this rank's, and that of all. Collective. */
PetscErrorCode SharedCount(const Shared *shared, PetscInt own, PetscInt *before, PetscInt *all);

/* SharedSlice - the places first .. end - 1 of n in which this rank writes for its machine. SharedPart - those that it
   reads for all ranks, to sum over them. Not collective. */
static inline void SharedSlice(const Shared *shared, PetscInt n, PetscInt *first, PetscInt *end)
{
  *first = (PetscInt)((PetscInt64)n * shared->rank / shared->size);
  *end   = (PetscInt)((PetscInt64)n * (shared->rank + 1) / shared->size);
}
static inline void SharedPart(const Shared *shared, PetscInt n, PetscInt *first, PetscInt *end)
{
  *first = (PetscInt)((PetscInt64)n * shared->of_all[0] / shared->of_all[1]);
  *end   = (PetscInt)((PetscInt64)n * (shared->of_all[0] + 1) / shared->of_all[1]);
}

/* SharedOr, SharedMin, SharedMax - write to a place, of any type, that other ranks write to as well; the result does
   not depend on their order. Not collective. */
#define SharedOr(at, bits)                                                                                             \
  do {                                                                                                                 \
    if ((bits) & ~__atomic_load_n(at, __ATOMIC_RELAXED)) (void)__atomic_fetch_or(at, bits, __ATOMIC_RELAXED);          \
  } while (0)
static inline void SharedMin(PetscInt *at, PetscInt value)
{
  PetscInt has = __atomic_load_n(at, __ATOMIC_RELAXED);

  while (value < has && !__atomic_compare_exchange_n(at, &has, value, 0, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
}
static inline void SharedMax(PetscReal *at, PetscReal value)
{
  PetscReal has;

  __atomic_load(at, &has, __ATOMIC_RELAXED);
  while (value > has && !__atomic_compare_exchange(at, &has, &value, 0, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
}

/* SharedAdd - adds to a sum in SHARED_UNIT, which depends neither on the order of its parts nor on the ranks, and has
   room up to 2000. Not collective. */
#define SHARED_UNIT (1 / (PetscReal)((PetscInt64)1 << 52))
static inline void SharedAdd(const Shared *shared, PetscInt64 *at, PetscReal part)
{
  const PetscInt64 units = (PetscInt64)(part / SHARED_UNIT);

  if (shared->size > 1)
    (void)__atomic_fetch_add(at, units, __ATOMIC_RELAXED);
  else
    *at += units;
}

/* Pieces of what is connected: parent[k] is a member of k's piece that comes before k, or k itself, its first member.
   Several ranks may join at once. PieceFirst - the first member of k's piece. PieceJoin - makes two pieces one. Not
   collective. */
static inline PetscInt PieceFirst(PetscInt parent[], PetscInt k)
{
  PetscInt up = __atomic_load_n(&parent[k], __ATOMIC_RELAXED);

  while (up != k) { /* halves the way */
    const PetscInt next = __atomic_load_n(&parent[up], __ATOMIC_RELAXED);

    __atomic_store_n(&parent[k], next, __ATOMIC_RELAXED);
    k  = up;
    up = next;
  }
  return k;
}
static inline void PieceJoin(PetscInt parent[], PetscInt a, PetscInt b)
{
  for (;;) {
    PetscInt from, to;

    a    = PieceFirst(parent, a);
    b    = PieceFirst(parent, b);
    from = PetscMax(a, b);
    to   = PetscMin(a, b);
    if (a == b || __atomic_compare_exchange_n(&parent[from], &from, to, 0, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) return;
  }
}

/* PiecesNumber - parent[k] becomes the number of k's piece, in the order of their first members; negative ones stay, of
   places that are of no piece. *pieces: how many there are. Collective. */
PetscErrorCode PiecesNumber(const Shared *shared, PetscInt n, PetscInt parent[], PetscInt *pieces);

#endif
