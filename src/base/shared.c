/* Shared memory of MPI. A machine that has none, or not enough, has a copy for each rank. */
#include "shared.h"
#include <string.h>

/* The window; without memory for it this rank is a machine of its own. */
static PetscErrorCode Open(Shared *shared, size_t bytes)
{
  void          *base = NULL;
  MPI_Aint       size;
  MPI_Errhandler handler;
  int            unit, failed;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_get_errhandler(shared->machine, &handler));
  PetscCallMPI(MPI_Comm_set_errhandler(shared->machine, MPI_ERRORS_RETURN));
  failed = MPI_Win_allocate_shared(shared->leads ? (MPI_Aint)bytes : 0, 1, MPI_INFO_NULL, shared->machine, &base,
                                   &shared->window) != MPI_SUCCESS;
  PetscCallMPI(MPI_Comm_set_errhandler(shared->machine, handler));
  PetscCallMPI(MPI_Errhandler_free(&handler));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, shared->machine));
  if (failed) {
    shared->window  = MPI_WIN_NULL;
    shared->machine = MPI_COMM_SELF;
    shared->leads   = PETSC_TRUE;
    shared->rank    = 0;
    shared->size    = 1;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCallMPI(MPI_Win_shared_query(shared->window, 0, &size, &unit, &shared->data));
  PetscCallMPI(MPI_Win_lock_all(MPI_MODE_NOCHECK, shared->window));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SharedCreate(MPI_Comm comm, PetscInt n, const SharedArray array[], Shared *shared)
{
  const size_t align = sizeof(PetscInt64);
  size_t       bytes = align, at = 0;
  PetscMPIInt  size;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++) bytes += (size_t)array[k].count * array[k].bytes + align;
  *shared = (Shared){.machine = MPI_COMM_SELF, .leaders = MPI_COMM_NULL, .window = MPI_WIN_NULL};
#if defined(PETSC_HAVE_MPI_PROCESS_SHARED_MEMORY)
  PetscShmComm machine;

  PetscCall(PetscShmCommGet(comm, &machine));
  PetscCall(PetscShmCommGetMpiShmComm(machine, &shared->machine));
#endif
  PetscCallMPI(MPI_Comm_rank(shared->machine, &shared->rank));
  PetscCallMPI(MPI_Comm_size(shared->machine, &shared->size));
  shared->leads = (PetscBool)(shared->rank == 0);
  if (shared->size > 1) PetscCall(Open(shared, bytes));
  if (!shared->data) PetscCall(PetscMalloc(bytes, &shared->data));
  PetscCallMPI(MPI_Comm_rank(comm, &shared->of_all[0]));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  shared->of_all[1] = size;
  if (shared->size < size) PetscCallMPI(MPI_Comm_split(comm, shared->leads ? 0 : MPI_UNDEFINED, 0, &shared->leaders));
  if (shared->leads) (void)memset(shared->data, 0, bytes);
  for (PetscInt k = 0; k < n; k++) {
    *(void **)array[k].address = (char *)shared->data + at;
    at += ((size_t)array[k].count * array[k].bytes + align - 1) / align * align;
  }
  PetscCall(PetscInfo(NULL, "shared array: %zu bytes for %d ranks\n", bytes, (int)shared->size));
  PetscCall(SharedFence(shared));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SharedFence(const Shared *shared)
{
  PetscFunctionBegin;
  if (shared->window == MPI_WIN_NULL) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Win_sync(shared->window));
  PetscCallMPI(MPI_Barrier(shared->machine));
  PetscCallMPI(MPI_Win_sync(shared->window));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SharedReduce(const Shared *shared, void *at, PetscInt count, MPI_Datatype type, MPI_Op op)
{
  PetscMPIInt number;

  PetscFunctionBegin;
  PetscCall(PetscMPIIntCast(count, &number));
  PetscCall(SharedFence(shared));
  if (shared->leaders == MPI_COMM_NULL) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, at, number, type, op, shared->leaders));
  PetscCall(SharedFence(shared));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SharedCount(const Shared *shared, PetscInt own, PetscInt *before, PetscInt *all)
{
  PetscFunctionBegin;
  *before = 0; /* of the first rank, which MPI leaves alone */
  PetscCallMPI(MPI_Exscan(&own, before, 1, MPIU_INT, MPI_SUM, shared->machine));
  PetscCallMPI(MPI_Allreduce(&own, all, 1, MPIU_INT, MPI_SUM, shared->machine));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SharedDestroy(Shared *shared)
{
  PetscFunctionBegin;
  if (!shared->data) PetscFunctionReturn(PETSC_SUCCESS);
  if (shared->leaders != MPI_COMM_NULL) PetscCallMPI(MPI_Comm_free(&shared->leaders));
  if (shared->window != MPI_WIN_NULL) {
    PetscCallMPI(MPI_Win_unlock_all(shared->window));
    PetscCallMPI(MPI_Win_free(&shared->window));
    shared->data = NULL;
  }
  PetscCall(PetscFree(shared->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Numbers of pieces are kept below all that a place may hold until all places of a piece have read them. */
#define HIDDEN(number) (PETSC_MIN_INT + (number))

PetscErrorCode PiecesNumber(const Shared *shared, PetscInt n, PetscInt parent[], PetscInt *pieces)
{
  PetscInt first, end, own = 0, before;

  PetscFunctionBegin;
  SharedSlice(shared, n, &first, &end);
  PetscCall(SharedFence(shared));
  for (PetscInt k = first; k < end; k++) {
    PetscInt up = k, next;

    if (parent[k] < 0) continue;
    while ((next = __atomic_load_n(&parent[up], __ATOMIC_RELAXED)) != up)
      up = next; /* others read it: not PieceFirst */
    __atomic_store_n(&parent[k], up, __ATOMIC_RELAXED);
    own += up == k;
  }
  PetscCall(SharedCount(shared, own, &before, pieces));
  PetscCall(SharedFence(shared));
  for (PetscInt k = first; k < end; k++)
    if (parent[k] == k) parent[k] = HIDDEN(before++);
  PetscCall(SharedFence(shared));
  for (PetscInt k = first; k < end; k++)
    if (parent[k] >= 0) parent[k] = parent[parent[k]];
  PetscCall(SharedFence(shared));
  for (PetscInt k = first; k < end; k++)
    if (parent[k] < HIDDEN(*pieces)) parent[k] -= PETSC_MIN_INT;
  PetscCall(SharedFence(shared));
  PetscFunctionReturn(PETSC_SUCCESS);
}
