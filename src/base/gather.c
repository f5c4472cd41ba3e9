#include "base.h"

PetscErrorCode ListGrow(PetscInt count, PetscInt *capacity, size_t bytes, void *list)
{
  PetscFunctionBegin;
  if (count < *capacity) PetscFunctionReturn(PETSC_SUCCESS);
  *capacity = 2 * *capacity + 64;
  PetscCall(PetscRealloc((size_t)*capacity * bytes, (void **)list));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GatherTo(MPI_Comm comm, PetscBool every, PetscInt n, const void *own, MPI_Datatype type, PetscInt *total,
                        void *all)
{
  PetscMPIInt rank, size, send, sum = 0, bytes, *count, *start;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCallMPI(MPI_Type_size(type, &bytes));
  PetscCall(PetscMPIIntCast(n, &send));
  PetscCall(PetscMalloc2(size, &count, size, &start));
  PetscCallMPI(MPI_Allgather(&send, 1, MPI_INT, count, 1, MPI_INT, comm));
  for (PetscMPIInt r = 0; r < size && (every || !rank); r++) {
    start[r] = sum;
    sum += count[r];
  }
  PetscCall(PetscMalloc1((size_t)sum * (size_t)bytes, (char **)all));
  if (every)
    PetscCallMPI(MPI_Allgatherv(own, send, type, *(void **)all, count, start, type, comm));
  else
    PetscCallMPI(MPI_Gatherv(own, send, type, *(void **)all, count, start, type, 0, comm));
  PetscCall(PetscFree2(count, start));
  *total = sum;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GatherAll(MPI_Comm comm, PetscInt n, const void *own, MPI_Datatype type, PetscInt *total, void *all)
{
  return GatherTo(comm, PETSC_TRUE, n, own, type, total, all);
}
