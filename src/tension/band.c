/* Where tension is evaluated: in cells within a distance of a surface particle. A rank has as many cells as its surface
   particles and their surroundings need, and asks no other rank unless its ghosts do not reach that far. The cells have
   the same places on every rank, so that all ranks decide alike. What depends on the distance itself and not on the
   cells asks BandWithin. */
#include "tension_impl.h"

#define MAX_CELLS   (1 << 25) /* more cells than this would take too much memory: they are made larger */
#define CELL_GROWTH 1.25      /* by this factor at a time */
#define JOIN        3         /* surface cells so close to each other along x are marked around in one stroke */

/* Sets up the band at its first use: see BandMark. */
static void Create(Band *band, Cloud cloud, PetscReal radius, PetscReal known)
{
  const Domain    domain = cloud->domain;
  const PetscReal pad    = known + cloud->slack;

  band->comm   = domain->comm;
  band->dim    = domain->dim;
  band->radius = radius;
  band->shared = (PetscBool)(radius > known);
  for (PetscInt d = 0; d < DIM; d++) {
    band->lower[d] = domain->lower[d] - pad;
    band->upper[d] = domain->upper[d] + pad;
  }
}

PetscErrorCode BandDestroy(Band *band)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(band->surface));
  PetscCall(PetscFree(band->near));
  PetscCall(PetscFree(band->begin));
  PetscCall(PetscFree(band->place));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static inline PetscBool OnSurface(const Band *band, Cloud cloud, PetscInt a)
{
  return (PetscBool)((cloud->integer[INT_SURFACE][a] == 1 || (band->also && band->also[a])) &&
                     cloud->integer[INT_LAYER][a] == 0);
}

/* The box (m) around the surface particles of this rank, or of all ranks if they share: its lower corner and minus its
   upper corner, PETSC_MAX_REAL if there are no surface particles. */
static PetscErrorCode SurfaceBox(const Band *band, Cloud cloud, const unsigned char keep[], PetscInt bits,
                                 PetscReal box[2 * DIM])
{
  PetscFunctionBegin;
  for (PetscInt d = 0; d < 2 * DIM; d++) box[d] = PETSC_MAX_REAL;
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    if (!OnSurface(band, cloud, a) || (keep && !(keep[a] & bits))) continue;
    for (PetscInt d = 0; d < DIM; d++) {
      const PetscReal x = BandClamp(band, d, cloud->field[FIELD_POSITION][DIM * a + d]);

      box[d]       = PetscMin(box[d], x);
      box[DIM + d] = PetscMin(box[DIM + d], -x);
    }
  }
  if (band->shared) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, box, 2 * DIM, MPIU_REAL, MPIU_MIN, band->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lays cells of this size (m) over the box and the radius around it. Returns their number, which may be too large for
   an integer. */
static PetscReal SetCells(Band *band, PetscReal size, const PetscReal box[2 * DIM])
{
  PetscReal count = 1;

  band->size  = size;
  band->reach = (PetscInt)(band->radius / size) + 1;
  for (PetscInt dy = 0; dy <= band->reach; dy++)
    for (PetscInt dz = 0; dz <= band->reach; dz++) band->along[dy][dz] = CellsAlong(size, band->radius, dy, dz);
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal first = PetscFloorReal((box[d] - band->lower[d]) / size),
                    last  = PetscFloorReal((-box[DIM + d] - band->lower[d]) / size);
    const PetscInt reach  = d < band->dim ? band->reach : 0;

    band->first[d] = (PetscInt)PetscMin(first, (PetscReal)PETSC_MAX_INT / 2) - reach;
    band->n[d]     = (PetscInt)PetscMin(last - first, (PetscReal)PETSC_MAX_INT / 2) + 1 + 2 * reach;
    count *= (PetscReal)band->n[d];
  }
  return count;
}

/* Chooses the cells around the surface particles, makes room for them and clears their marks. */
static PetscErrorCode SetWindow(Band *band, Cloud cloud, const unsigned char keep[], PetscInt bits, PetscInt *count)
{
  PetscReal box[2 * DIM], size = band->radius / BAND_CELLS;

  PetscFunctionBegin;
  *count = band->n[0] = band->n[1] = band->n[2] = 0;
  PetscCall(SurfaceBox(band, cloud, keep, bits, box));
  if (box[0] == PETSC_MAX_REAL) PetscFunctionReturn(PETSC_SUCCESS);
  while (SetCells(band, size, box) > MAX_CELLS) size *= CELL_GROWTH;
  *count = band->n[0] * band->n[1] * band->n[2];
  if (*count > band->capacity) {
    band->capacity = *count + *count / 4;
    PetscCall(PetscFree(band->surface));
    PetscCall(PetscFree(band->near));
    PetscCall(PetscMalloc1(band->capacity, &band->surface));
    PetscCall(PetscMalloc1(band->capacity, &band->near));
    PetscCall(PetscFree(band->begin));
    PetscCall(PetscMalloc1(band->capacity + 2, &band->begin));
  }
  PetscCall(PetscArrayzero(band->surface, *count));
  PetscCall(PetscArrayzero(band->near, *count));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks all cells within the radius of the cells first to last of the line y, z. */
static void MarkAround(Band *band, PetscInt first, PetscInt last, PetscInt y, PetscInt z)
{
  const PetscInt *n = band->n, reach = band->reach;

  for (PetscInt dz = PetscMax(-reach, -z); dz <= PetscMin(reach, n[2] - 1 - z); dz++)
    for (PetscInt dy = PetscMax(-reach, -y); dy <= PetscMin(reach, n[1] - 1 - y); dy++) {
      const PetscInt along = band->along[PetscAbsInt(dy)][PetscAbsInt(dz)], line = CellIndex(n, 0, y + dy, z + dz),
                     begin = PetscMax(0, first - along), end = PetscMin(n[0] - 1, last + along);

      if (along > 0) (void)memset(band->near + line + begin, 1, (size_t)(end - begin + 1));
    }
}

/* Sorts the positions of the surface particles into the cells. */
static PetscErrorCode Sort(Band *band, Cloud cloud, const unsigned char keep[], PetscInt bits, PetscInt count)
{
  const PetscReal *x     = cloud->field[FIELD_POSITION];
  PetscInt        *begin = band->begin + 1; /* of a cell first its particles, then their first place, then their last */

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(band->begin, count + 2));
  for (PetscInt a = 0; a < cloud->n_total; a++)
    if (OnSurface(band, cloud, a) && (!keep || keep[a] & bits)) begin[BandCell(band, x + DIM * a) + 1]++;
  for (PetscInt c = 0; c < count; c++) begin[c + 1] += begin[c];
  if (begin[count] > band->place_capacity) {
    band->place_capacity = begin[count] + begin[count] / 4;
    PetscCall(PetscFree(band->place));
    PetscCall(PetscMalloc1(DIM * band->place_capacity, &band->place));
  }
  for (PetscInt a = 0; a < cloud->n_total; a++)
    if (OnSurface(band, cloud, a) && (!keep || keep[a] & bits))
      PetscCall(PetscArraycpy(band->place + DIM * begin[BandCell(band, x + DIM * a)]++, x + DIM * a, DIM));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool BandWithin(const Band *band, const PetscReal x[DIM], PetscReal radius)
{
  const PetscInt cell = BandCell(band, x), *n = band->n;
  PetscInt       at[DIM];

  if (cell < 0 || !band->near[cell]) return PETSC_FALSE;
  CellCoordinates(n, cell, at);
  for (PetscInt dz = PetscMax(-band->reach, -at[2]); dz <= PetscMin(band->reach, n[2] - 1 - at[2]); dz++)
    for (PetscInt dy = PetscMax(-band->reach, -at[1]); dy <= PetscMin(band->reach, n[1] - 1 - at[1]); dy++) {
      const PetscInt along = band->along[PetscAbsInt(dy)][PetscAbsInt(dz)],
                     line  = CellIndex(n, 0, at[1] + dy, at[2] + dz);

      if (along <= 0) continue;
      for (PetscInt k = band->begin[line + PetscMax(0, at[0] - along)];
           k < band->begin[line + PetscMin(n[0] - 1, at[0] + along) + 1]; k++) {
        const PetscReal *s = band->place + DIM * k, d[DIM] = {x[0] - s[0], x[1] - s[1], x[2] - s[2]};

        if (Dot(d, d) <= radius * radius) return PETSC_TRUE;
      }
    }
  return PETSC_FALSE;
}

PetscErrorCode BandMark(Band *band, Cloud cloud, PetscReal radius, PetscReal known, const unsigned char keep[],
                        PetscInt bits)
{
  PetscInt count;

  PetscFunctionBegin;
  if (band->radius <= 0) Create(band, cloud, radius, known);
  PetscCall(SetWindow(band, cloud, keep, bits, &count));
  if (count == 0) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = 0; a < cloud->n_total; a++)
    if (OnSurface(band, cloud, a) && (!keep || keep[a] & bits))
      band->surface[BandCell(band, cloud->field[FIELD_POSITION] + DIM * a)] = 1;
  if (band->shared)
    PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, band->surface, (PetscMPIInt)count, MPI_UNSIGNED_CHAR, MPI_MAX, band->comm));
  for (PetscInt row = 0; row < band->n[1] * band->n[2]; row++) {
    const unsigned char *line = band->surface + row * band->n[0], *end = line + band->n[0];
    const unsigned char *mark = (const unsigned char *)memchr(line, 1, (size_t)band->n[0]);

    while (mark) {
      const unsigned char *last = mark, *next = mark;

      while (next && next - last <= JOIN) { /* each marks at least one cell along x: no gap of JOIN - 1 is left out */
        last = next;
        next = (const unsigned char *)memchr(last + 1, 1, (size_t)(end - last - 1));
      }
      MarkAround(band, (PetscInt)(mark - line), (PetscInt)(last - line), row % band->n[1], row / band->n[1]);
      mark = next;
    }
  }
  if (!band->shared) PetscCall(Sort(band, cloud, keep, bits, count));
  PetscFunctionReturn(PETSC_SUCCESS);
}
