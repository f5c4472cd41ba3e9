/* Connected pieces of liquid: chains of neighbours closer than CONNECTION connect their particles. The cells of
   crater_grid.c are too coarse for the crown, whose rim sheds drops at a distance of one or two spacings. */
#include "gauges_impl.h"

PetscErrorCode ConnectedLabels(Gauges gauges, PetscReal label[])
{
  Cloud     cloud = gauges->cloud;
  PetscInt *parent;

  PetscFunctionBegin;
  PetscCall(CloudUpdate(cloud, FIELD_POSITION));
  PetscCall(PetscMalloc1(cloud->n_total, &parent));
  OperatorsConnect(cloud, CONNECTION * cloud->domain->spacing, parent);
  for (PetscInt a = 0; a < cloud->n_owned; a++) label[a] = (PetscReal)cloud->integer[INT_ID][a]; /* exact as reals */
  PetscCall(OperatorsComponentMinimum(cloud, parent, 1, label));
  PetscCall(PetscFree(parent));
  PetscFunctionReturn(PETSC_SUCCESS);
}
