/* The rows of the particles. Each fluid particle and each wall particle of the top layer has a row, in the order of the
   cloud. A particle of a deeper wall layer shares the row of its parent in the top layer, so that a wall has the
   pressure of its face throughout. */
#include "pressure_impl.h"

/* The rows of deeper wall particles. A parent is on the same rank. */
static PetscErrorCode FindParentRows(Pressure pressure)
{
  const Cloud     cloud = pressure->cloud;
  const PetscInt *id = cloud->integer[INT_ID], *parent = cloud->integer[INT_PARENT];
  const PetscInt  tops = cloud->n_rows - cloud->n_fluid;
  PetscInt       *top_id, *top_row, place;

  PetscFunctionBegin;
  PetscCall(PetscFree(pressure->parent_row));
  PetscCall(PetscMalloc1(cloud->n_owned - cloud->n_rows, &pressure->parent_row));
  PetscCall(PetscMalloc2(tops, &top_id, tops, &top_row));
  for (PetscInt k = 0; k < tops; k++) {
    top_row[k] = cloud->n_fluid + k;
    top_id[k]  = id[top_row[k]];
  }
  PetscCall(PetscSortIntWithArray(tops, top_id, top_row));
  for (PetscInt a = cloud->n_rows; a < cloud->n_owned; a++) {
    PetscCall(PetscFindInt(parent[a], tops, top_id, &place));
    PetscCheck(place >= 0, PETSC_COMM_SELF, PETSC_ERR_PLIB,
               "wall particle %" PetscInt_FMT " is on another rank than its parent %" PetscInt_FMT, id[a], parent[a]);
    pressure->parent_row[a - cloud->n_rows] = top_row[place];
  }
  PetscCall(PetscFree2(top_id, top_row));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RowsNumber(Pressure pressure)
{
  const Cloud cloud = pressure->cloud;

  PetscFunctionBegin;
  if (pressure->row_layout == cloud->layout) PetscFunctionReturn(PETSC_SUCCESS);
  pressure->row_start = 0;
  PetscCallMPI(MPI_Exscan(&cloud->n_rows, &pressure->row_start, 1, MPIU_INT, MPI_SUM, cloud->comm));
  PetscCallMPI(MPI_Allreduce(&cloud->n_rows, &pressure->rows_global, 1, MPIU_INT, MPI_SUM, cloud->comm));
  PetscCall(FindParentRows(pressure));
  pressure->row_layout = cloud->layout;
  PetscFunctionReturn(PETSC_SUCCESS);
}
