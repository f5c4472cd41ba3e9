/* Where tension is evaluated: cells over the whole box within a distance of a surface particle. The cells are the same
   on every rank and the marks are shared, so the answer does not depend on how the particles are divided. */
#include "types.h"

#define MAX_CELLS (1 << 25) /* above, the cells are made larger: a bound of the memory */

PetscErrorCode BandCreate(Domain domain, PetscReal radius, PetscReal pad, Band *band)
{
  PetscReal count;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(band, sizeof(*band)));
  band->comm   = domain->comm;
  for (band->size = radius / BAND_CELLS;; band->size *= 1.25) {
    count = 1;
    for (PetscInt d = 0; d < domain->dim; d++)
      count *= PetscCeilReal((domain->upper[d] - domain->lower[d] + 2 * pad) / band->size);
    if (count <= MAX_CELLS) break;
  }
  for (PetscInt d = 0; d < DIM; d++) {
    band->lower[d] = domain->lower[d] - pad;
    band->n[d] =
      d < domain->dim ? (PetscInt)PetscCeilReal((domain->upper[d] - domain->lower[d] + 2 * pad) / band->size) : 1;
  }
  band->count = band->n[0] * band->n[1] * band->n[2];
  band->reach = (PetscInt)(radius / band->size) + 1;
  for (PetscInt dy = 0; dy <= band->reach; dy++)
    for (PetscInt dz = 0; dz <= band->reach; dz++) band->along[dy][dz] = CellsAlong(band->size, radius, dy, dz);
  PetscCall(PetscMalloc2(band->count, &band->surface, band->count, &band->near));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BandDestroy(Band *band)
{
  PetscFunctionBegin;
  PetscCall(PetscFree2(band->surface, band->near));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BandMark(Band *band, Cloud cloud)
{
  const PetscInt *n = band->n, reach = band->reach;
  PetscMPIInt     size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(band->comm, &size));
  PetscCall(PetscArrayzero(band->surface, band->count));
  PetscCall(PetscArrayzero(band->near, band->count));
  for (PetscInt a = 0; a < cloud->n_total; a++)
    if (cloud->integer[INT_SURFACE][a] == 1 && cloud->integer[INT_LAYER][a] == 0)
      band->surface[BandCell(band, cloud->field[FIELD_POSITION] + DIM * a)] = 1;
  if (size > 1)
    PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, band->surface, (PetscMPIInt)band->count, MPI_UNSIGNED_CHAR, MPI_MAX, band->comm));
  for (PetscInt c = 0; c < band->count; c++) {
    PetscInt x, y, z;

    if (!band->surface[c]) continue;
    x = c % n[0];
    y = (c / n[0]) % n[1];
    z = c / (n[0] * n[1]);
    for (PetscInt dz = PetscMax(-reach, -z); dz <= PetscMin(reach, n[2] - 1 - z); dz++)
      for (PetscInt dy = PetscMax(-reach, -y); dy <= PetscMin(reach, n[1] - 1 - y); dy++) {
        const PetscInt along = band->along[PetscAbsInt(dy)][PetscAbsInt(dz)], line = ((z + dz) * n[1] + y + dy) * n[0],
                       first = PetscMax(0, x - along), last = PetscMin(n[0] - 1, x + along);

        if (along >= 0) (void)memset(band->near + line + first, 1, (size_t)last - (size_t)first + 1);
      }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
