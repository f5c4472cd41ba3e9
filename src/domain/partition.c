/* METIS on the graph of cells: vertices are cells weighted with their particles, edges join cells that share a face. */
#include "domain.h"
#include <metis.h>

/* Runs METIS on one rank; part is [cells]. The graph is small (the cells are at least a kernel support wide). */
static PetscErrorCode PartitionCells(Domain domain, PetscInt constraints, const PetscInt weight[], PetscMPIInt size,
                                     PetscMPIInt part[])
{
  const PetscInt *n = domain->cells, count = n[0] * n[1] * n[2];
  idx_t          *first, *neighbor, *vertex, *owner, options[METIS_NOPTIONS], vertices = count, kinds = constraints,
                                                                     parts = size, cut, edges = 0;
  int status;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(count + 1, &first, 2 * DIM * count, &neighbor, constraints * count, &vertex, count, &owner));
  for (PetscInt c = 0; c < count; c++) {
    const PetscInt at[DIM] = {c % n[0], (c / n[0]) % n[1], c / (n[0] * n[1])}, stride[DIM] = {1, n[0], n[0] * n[1]};

    first[c] = edges;
    for (PetscInt k = 0; k < constraints; k++) vertex[constraints * c + k] = weight[constraints * c + k];
    for (PetscInt d = 0; d < DIM; d++) {
      if (at[d] > 0) neighbor[edges++] = c - stride[d];
      if (at[d] < n[d] - 1) neighbor[edges++] = c + stride[d];
    }
  }
  first[count] = edges;
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED]    = 1;
  options[METIS_OPTION_UFACTOR] = 10; /* allowed imbalance, 1/1000 */
  status = METIS_PartGraphRecursive(&vertices, &kinds, first, neighbor, vertex, NULL, NULL, &parts, NULL, NULL, options,
                                    &cut, owner);
  PetscCheck(status == METIS_OK, PETSC_COMM_SELF, PETSC_ERR_LIB, "METIS failed with code %d", status);
  for (PetscInt c = 0; c < count; c++) part[c] = (PetscMPIInt)owner[c];
  PetscCall(PetscFree4(first, neighbor, vertex, owner));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode DomainPartition(Domain domain, PetscInt constraints, PetscInt weight[])
{
  const PetscInt count = domain->cells[0] * domain->cells[1] * domain->cells[2];
  PetscMPIInt    rank, size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(domain->comm, &rank));
  PetscCallMPI(MPI_Comm_size(domain->comm, &size));
  if (size == 1) {
    PetscCall(PetscArrayzero(domain->cell_rank, count));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCallMPI(
    MPI_Allreduce(MPI_IN_PLACE, weight, (PetscMPIInt)(constraints * count), MPIU_INT, MPI_SUM, domain->comm));
  if (count <= size) { /* fewer cells than ranks: one each, the other ranks stay empty */
    for (PetscInt c = 0; c < count; c++) domain->cell_rank[c] = (PetscMPIInt)c;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (rank == 0) PetscCall(PartitionCells(domain, constraints, weight, size, domain->cell_rank));
  PetscCallMPI(MPI_Bcast(domain->cell_rank, (PetscMPIInt)count, MPI_INT, 0, domain->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}
