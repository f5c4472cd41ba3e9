/* Where tension is evaluated: cells over the whole box within a distance of a surface particle. The cells are the same
   on every rank and the marks are shared, so the answer does not depend on how the particles are divided. */
#include "types.h"

#define CELLS_A_RADIUS 4
#define MAX_CELLS      (1 << 25) /* above, the cells are made larger: a bound of the memory */

PetscErrorCode BandCreate(Domain domain, PetscReal radius, PetscReal pad, Band *band)
{
  PetscReal count;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(band, sizeof(*band)));
  band->comm   = domain->comm;
  band->radius = radius;
  for (band->size = radius / CELLS_A_RADIUS;; band->size *= 1.25) {
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
  PetscCall(PetscMalloc2(band->count, &band->surface, band->count, &band->near));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BandDestroy(Band *band)
{
  PetscFunctionBegin;
  PetscCall(PetscFree2(band->surface, band->near));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How many cells further along x may hold points within the radius of a cell that is dy, dz cells away; -1: none. */
static PetscInt CellsAlong(const Band *band, PetscInt dy, PetscInt dz)
{
  const PetscReal y = PetscMax(PetscAbsInt(dy) - 1, 0) * band->size, z = PetscMax(PetscAbsInt(dz) - 1, 0) * band->size,
                  rest = band->radius * band->radius - y * y - z * z;

  return rest > 0 ? (PetscInt)(PetscSqrtReal(rest) / band->size) + 1 : -1;
}

PetscErrorCode BandMark(Band *band, Cloud cloud)
{
  const PetscInt *n = band->n, reach = (PetscInt)(band->radius / band->size) + 1;
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
    const PetscInt x = c % n[0], y = (c / n[0]) % n[1], z = c / (n[0] * n[1]);

    if (!band->surface[c]) continue;
    for (PetscInt dz = PetscMax(-reach, -z); dz <= PetscMin(reach, n[2] - 1 - z); dz++)
      for (PetscInt dy = PetscMax(-reach, -y); dy <= PetscMin(reach, n[1] - 1 - y); dy++) {
        const PetscInt along = CellsAlong(band, dy, dz), line = ((z + dz) * n[1] + y + dy) * n[0];

        for (PetscInt k = PetscMax(0, x - along); along >= 0 && k <= PetscMin(n[0] - 1, x + along); k++)
          band->near[line + k] = 1;
      }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
