/* Where tension is evaluated: cells within a distance of a surface particle. The cells are the same on every rank, so
   the answer does not depend on how the particles are divided. */
#include "types.h"

#define MAX_CELLS (1 << 25) /* of the whole box; above, the cells are made larger: a bound of the memory */
#define JOIN      3         /* cells along x from one mark to the next within which one stroke marks around both */

PetscErrorCode BandCreate(Domain domain, PetscReal radius, PetscReal known, PetscReal pad, Band *band)
{
  PetscReal count;

  PetscFunctionBegin;
  PetscCall(PetscMemzero(band, sizeof(*band)));
  band->comm = domain->comm;
  for (band->size = radius / BAND_CELLS;; band->size *= 1.25) {
    count = 1;
    for (PetscInt d = 0; d < domain->dim; d++)
      count *= PetscCeilReal((domain->upper[d] - domain->lower[d] + 2 * pad) / band->size);
    if (count <= MAX_CELLS) break;
  }
  for (PetscInt d = 0; d < DIM; d++) {
    band->lower[d] = domain->lower[d] - pad;
    band->all[d] =
      d < domain->dim ? (PetscInt)PetscCeilReal((domain->upper[d] - domain->lower[d] + 2 * pad) / band->size) : 1;
  }
  band->reach = (PetscInt)(radius / band->size) + 1;
  for (PetscInt dy = 0; dy <= band->reach; dy++)
    for (PetscInt dz = 0; dz <= band->reach; dz++) band->along[dy][dz] = CellsAlong(band->size, radius, dy, dz);
  band->shared = (PetscBool)(radius + 2 * PetscSqrtReal((PetscReal)domain->dim) * band->size > known);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BandDestroy(Band *band)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(band->surface));
  PetscCall(PetscFree(band->near));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static inline PetscBool OnSurface(Cloud cloud, PetscInt a)
{
  return (PetscBool)(cloud->integer[INT_SURFACE][a] == 1 && cloud->integer[INT_LAYER][a] == 0);
}

/* The window: what the radius around the surface particles reaches. Room for it. */
static PetscErrorCode SetWindow(Band *band, Cloud cloud)
{
  PetscInt bound[2 * DIM] = {PETSC_MAX_INT, PETSC_MAX_INT, PETSC_MAX_INT, PETSC_MAX_INT, PETSC_MAX_INT, PETSC_MAX_INT};
  PetscInt count          = 1;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    PetscInt cell[DIM];

    if (!OnSurface(cloud, a)) continue;
    BandPlace(band, cloud->field[FIELD_POSITION] + DIM * a, cell);
    for (PetscInt d = 0; d < DIM; d++) {
      bound[d]       = PetscMin(bound[d], cell[d]);
      bound[DIM + d] = PetscMin(bound[DIM + d], -cell[d]);
    }
  }
  if (band->shared) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, bound, 2 * DIM, MPIU_INT, MPI_MIN, band->comm));
  for (PetscInt d = 0; d < DIM; d++) {
    band->first[d] = PetscMax(0, PetscMin(bound[d], band->all[d]) - band->reach);
    band->n[d] = bound[d] < PETSC_MAX_INT
                   ? PetscMin(band->all[d] - 1, -bound[DIM + d] + band->reach) - band->first[d] + 1
                   : 0;
    count *= band->n[d];
  }
  if (count > band->capacity) {
    band->capacity = count + count / 4;
    PetscCall(PetscFree(band->surface));
    PetscCall(PetscFree(band->near));
    PetscCall(PetscMalloc1(band->capacity, &band->surface));
    PetscCall(PetscMalloc1(band->capacity, &band->near));
  }
  PetscCall(PetscArrayzero(band->surface, count));
  PetscCall(PetscArrayzero(band->near, count));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks what is near the cells first to last of line y, z. */
static void MarkAround(Band *band, PetscInt first, PetscInt last, PetscInt y, PetscInt z)
{
  const PetscInt *n = band->n, reach = band->reach;

  for (PetscInt dz = PetscMax(-reach, -z); dz <= PetscMin(reach, n[2] - 1 - z); dz++)
    for (PetscInt dy = PetscMax(-reach, -y); dy <= PetscMin(reach, n[1] - 1 - y); dy++) {
      const PetscInt along = band->along[PetscAbsInt(dy)][PetscAbsInt(dz)], line = ((z + dz) * n[1] + y + dy) * n[0],
                     begin = PetscMax(0, first - along), end = PetscMin(n[0] - 1, last + along);

      if (along > 0) (void)memset(band->near + line + begin, 1, (size_t)(end - begin + 1));
    }
}

PetscErrorCode BandMark(Band *band, Cloud cloud)
{
  PetscInt count;

  PetscFunctionBegin;
  PetscCall(SetWindow(band, cloud));
  count = band->n[0] * band->n[1] * band->n[2];
  for (PetscInt a = 0; a < cloud->n_total; a++)
    if (OnSurface(cloud, a)) band->surface[BandCell(band, cloud->field[FIELD_POSITION] + DIM * a)] = 1;
  if (band->shared)
    PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, band->surface, (PetscMPIInt)count, MPI_UNSIGNED_CHAR, MPI_MAX, band->comm));
  for (PetscInt row = 0; row < band->n[1] * band->n[2] && count > 0; row++) {
    const unsigned char *line = band->surface + row * band->n[0], *end = line + band->n[0];
    const unsigned char *mark = (const unsigned char *)memchr(line, 1, (size_t)band->n[0]);

    while (mark) {
      const unsigned char *last = mark, *next = mark;

      while (next && next - last <= JOIN) { /* 'along' is at least 1: nothing between them is left out */
        last = next;
        next = (const unsigned char *)memchr(last + 1, 1, (size_t)(end - last - 1));
      }
      MarkAround(band, (PetscInt)(mark - line), (PetscInt)(last - line), row % band->n[1], row / band->n[1]);
      mark = next;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
