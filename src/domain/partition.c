/* The partition by METIS. Its graph has a vertex for each cell, weighted with the work of the cell's particles, and an
   edge between cells that share a face. */
#include "domain.h"
#include <metis.h>

#define IMBALANCE_MAX 10 /* 1/1000 */
#define SEED          1  /* of METIS: constant, so every run gets the same partition */

/* Numbers the parts by their first cell with particles. METIS' own order is arbitrary: with it a partition that hardly
   differs from the last one could move all particles to other ranks. */
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

/* Runs METIS on one rank; the graph is small. part: [cells]. */
static PetscErrorCode PartitionCells(Domain domain, PetscInt constraints, const PetscInt weight[], PetscMPIInt size,
                                     PetscMPIInt part[])
{
  const PetscInt *n = domain->cells, count = n[0] * n[1] * n[2];
  const idx_t direction_weight[DIM] = {4, 5, 6}; /* of edges: equal weights would cut a square pool in any direction */
  idx_t      *first, *neighbor, *edge, *vertex, *owner, options[METIS_NOPTIONS], vertices = count, kinds = constraints,
                                                                            parts = size, cut, edges = 0;
  int status;

  PetscFunctionBegin;
  PetscCall(PetscMalloc5(count + 1, &first, 2 * DIM * count, &neighbor, 2 * DIM * count, &edge, constraints * count,
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
        edge[edges++]   = direction_weight[d];
      }
    }
  }
  first[count] = edges;
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED]    = SEED;
  options[METIS_OPTION_UFACTOR] = IMBALANCE_MAX;
  status = METIS_PartGraphRecursive(&vertices, &kinds, first, neighbor, vertex, NULL, edge, &parts, NULL, NULL, options,
                                    &cut, owner);
  PetscCheck(status == METIS_OK, PETSC_COMM_SELF, PETSC_ERR_LIB, "METIS failed with code %d", status);
  PetscCall(NumberParts(count, constraints, weight, owner, size, part));
  PetscCall(PetscFree5(first, neighbor, edge, vertex, owner));
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
  if (count <= size) { /* each rank gets at most one cell */
    for (PetscInt c = 0; c < count; c++) domain->cell_rank[c] = (PetscMPIInt)c;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (rank == 0) PetscCall(PartitionCells(domain, constraints, weight, size, domain->cell_rank));
  PetscCallMPI(MPI_Bcast(domain->cell_rank, (PetscMPIInt)count, MPI_INT, 0, domain->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}
