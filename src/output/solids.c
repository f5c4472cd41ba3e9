/* solids.h5: where the solids are, for pictures. */
#include "output_impl.h"

#define SOLIDS_FILE "solids.h5"

PetscErrorCode SolidsWrite(Output output)
{
  Cloud     cloud = output->cloud;
  Rows      rows;
  PetscInt  count = 0;
  H5File    h5;
  PetscBool failed;
  double   *place, *normal;
  PetscInt *solid;
  char      path[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  if (!SceneSolidCount(cloud->scene)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc3(DIM * cloud->n_owned, &place, DIM * cloud->n_owned, &normal, cloud->n_owned, &solid));
  for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++) {
    const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a;
    PetscReal        n[DIM];

    if (cloud->integer[INT_BODY][a] > BODY_SOLID) continue;
    SceneSolidNormal(cloud->scene, x, n);
    for (PetscInt d = 0; d < DIM; d++) {
      place[DIM * count + d]  = (double)x[d];
      normal[DIM * count + d] = (double)n[d];
    }
    solid[count++] = BODY_SOLID - cloud->integer[INT_BODY][a];
  }
  PetscCall(RowsSet(output->comm, count, DIM, &rows));
  PetscCall(OutputPath(output, SOLIDS_FILE ".tmp", path));
  PetscCall(H5FileCreate(output->comm, path, &h5));
  H5FilePutText(&h5, "format", "isph solids");
  PetscCall(H5FileWrite(&h5, "position", H5T_NATIVE_DOUBLE, &rows, place, "m", "dummy particles of solids"));
  PetscCall(H5FileWrite(&h5, "normal", H5T_NATIVE_DOUBLE, &rows, normal, "1", "out of the solid"));
  rows.width = 1;
  PetscCall(H5FileWrite(&h5, "solid", H5FILE_INT, &rows, solid, "1", "index of the solid in -solids"));
  PetscCall(H5FileClose(&h5, &failed));
  PetscCall(PetscFree3(place, normal, solid));
  PetscCheckUser(!failed, output->comm, "Cannot write %s/%s: is the disk full, or the folder gone?", output->folder,
                 SOLIDS_FILE);
  PetscCall(FolderCommit(output, SOLIDS_FILE, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}
