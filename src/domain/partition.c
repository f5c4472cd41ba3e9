/* METIS on the graph of cells: vertices are cells weighted with their particles, edges join cells that share a face. */
#include "domain.h"
#include <metis.h>

#define IMBALANCE_MAX 10 /* of the parts, 1/1000 */
#define SEED          1  /* of METIS: the same partition in every run */

/* METIS numbers its parts as it likes: they are numbered by their first cell with particles, so that a partition much
   like the last leaves most particles where they are. */
static PetscErrorCode NumberParts(PetscInt count, PetscInt constraints, const PetscInt weight[], const idx_t owner[],
                                  PetscMPIInt size, PetscMPIInt part[])
{
  PetscMPIInt *number, next = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(size, &number));
  for (PetscMPIInt p = 0; p < size; p++) number[p] = -1;
  for (PetscInt empty = 0; empty < 2; empty++)
    for (PetscInt c = 0; c < count; c++)
      if (number[owner[c]] < 0 && (empty || weight[constraints * c] > 0)) number[owner[c]] = next++;
  for (PetscInt c = 0; c < count; c++) part[c] = number[owner[c]];
  PetscCall(PetscFree(number));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Runs METIS on one rank; part is [cells]. The graph is small (the cells are at least a kernel support wide). */
static PetscErrorCode PartitionCells(Domain domain, PetscInt constraints, const PetscInt weight[], PetscMPIInt size,
                                     PetscMPIInt part[])
{
  const PetscInt *n = domain->cells, count = n[0] * n[1] * n[2];
  const idx_t price[DIM] = {4, 5, 6}; /* of an edge: without a favourite a square pool is cut along x or y by chance */
  idx_t      *first, *neighbor, *along, *vertex, *owner, options[METIS_NOPTIONS], vertices = count, kinds = constraints,
                                                                             parts = size, cut, edges = 0;
  int status;

  PetscFunctionBegin;
  PetscCall(PetscMalloc5(count + 1, &first, 2 * DIM * count, &neighbor, 2 * DIM * count, &along, constraints * count,
                         &vertex, count, &owner));
  for (PetscInt c = 0; c < count; c++) {
    const PetscInt stride[DIM] = {1, n[0], n[0] * n[1]};
    PetscInt       at[DIM];

    CellCoordinates(n, c, at);
    first[c] = edges;
    for (PetscInt k = 0; k < constraints; k++) vertex[constraints * c + k] = weight[constraints * c + k];
    for (PetscInt d = 0; d < DIM; d++) {
      for (PetscInt side = -1; side <= 1; side += 2) {
        if (side < 0 ? at[d] == 0 : at[d] == n[d] - 1) continue;
        neighbor[edges] = c + side * stride[d];
        along[edges++]  = price[d];
      }
    }
  }
  first[count] = edges;
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED]    = SEED;
  options[METIS_OPTION_UFACTOR] = IMBALANCE_MAX;
  status = METIS_PartGraphRecursive(&vertices, &kinds, first, neighbor, vertex, NULL, along, &parts, NULL, NULL,
                                    options, &cut, owner);
  PetscCheck(status == METIS_OK, PETSC_COMM_SELF, PETSC_ERR_LIB, "METIS failed with code %d", status);
  PetscCall(NumberParts(count, constraints, weight, owner, size, part));
  PetscCall(PetscFree5(first, neighbor, along, vertex, owner));
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
