/* The ghosts of a rank: the particles and images that ranks send to each other, and the exchange of their values. */
#include "halo.h"
#include <petscsf.h>

/* The map of an image along one direction. The code of an image is the number (CellIndex) of a cell in a box of
   IMAGE_COUNT cells along each direction; its coordinates are these values. */
enum { IMAGE_SAME, IMAGE_UP, IMAGE_DOWN, IMAGE_MIRROR_LOWER, IMAGE_MIRROR_UPPER, IMAGE_COUNT };
static const PetscInt image_box[DIM] = {IMAGE_COUNT, IMAGE_COUNT, IMAGE_COUNT};

typedef struct {
  PetscReal sign[DIM], offset[DIM]; /* x' = sign x + offset */
} Image;

struct _p_Halo {
  Domain         domain;
  PetscMPIInt    rank, size;
  PetscSF        sf;
  PetscInt       n, ghosts, capacity;
  unsigned char *image; /* [ghosts] code of the image */
  Image          images[IMAGE_COUNT * IMAGE_COUNT * IMAGE_COUNT];
  MPI_Datatype   vector, tensor;
};

/* A ghost as its owner describes it to the receiver: the owner's local index, and the code of the image. A pair of
   MPIU_2INT. */
typedef struct {
  PetscInt index, image;
} Ghost;

/* The ranges within which points interact. Points of different sizes interact up to the support of the larger. */
typedef struct {
  PetscReal        radius;          /* m, of all points; the largest if sizes differ */
  PetscReal        support, margin; /* m: support at size 1; margin added to all supports */
  const PetscReal *size;            /* [n] 1; NULL: one size */
  /* [cells] largest size in the cell, over all ranks; largest size that interacts with its points; squared range of its
     points, m2 */
  PetscReal *most, *around, *reach2;
} InteractionRange;

/* Ghosts to send, and the receiving rank of each. */
typedef struct {
  PetscInt  count, capacity;
  PetscInt *target;
  Ghost    *ghost;
} SendList;

PetscErrorCode HaloCreate(Domain domain, Halo *halo)
{
  Halo h;

  PetscFunctionBegin;
  PetscCall(PetscNew(&h));
  h->domain = domain;
  PetscCallMPI(MPI_Comm_rank(domain->comm, &h->rank));
  PetscCallMPI(MPI_Comm_size(domain->comm, &h->size));
  for (PetscInt code = 0; code < IMAGE_COUNT * IMAGE_COUNT * IMAGE_COUNT; code++) {
    PetscInt part[DIM];

    CellCoordinates(image_box, code, part);
    for (PetscInt d = 0; d < DIM; d++) {
      const PetscReal length = domain->upper[d] - domain->lower[d];

      h->images[code].sign[d]   = part[d] == IMAGE_MIRROR_LOWER || part[d] == IMAGE_MIRROR_UPPER ? -1 : 1;
      h->images[code].offset[d] = part[d] == IMAGE_UP             ? length
                                  : part[d] == IMAGE_DOWN         ? -length
                                  : part[d] == IMAGE_MIRROR_LOWER ? 2 * domain->lower[d]
                                  : part[d] == IMAGE_MIRROR_UPPER ? 2 * domain->upper[d]
                                                                  : 0;
    }
  }
  PetscCallMPI(MPI_Type_contiguous(3, MPIU_REAL, &h->vector));
  PetscCallMPI(MPI_Type_commit(&h->vector));
  PetscCallMPI(MPI_Type_contiguous(6, MPIU_REAL, &h->tensor));
  PetscCallMPI(MPI_Type_commit(&h->tensor));
  *halo = h;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode HaloDestroy(Halo *halo)
{
  PetscFunctionBegin;
  if (!*halo) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSFDestroy(&(*halo)->sf));
  PetscCallMPI(MPI_Type_free(&(*halo)->vector));
  PetscCallMPI(MPI_Type_free(&(*halo)->tensor));
  PetscCall(PetscFree((*halo)->image));
  PetscCall(PetscFree(*halo));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SendListAdd(SendList *list, PetscInt target, PetscInt index, PetscInt image)
{
  PetscFunctionBegin;
  if (list->count == list->capacity) {
    list->capacity = 2 * list->capacity + 1024;
    PetscCall(PetscRealloc(list->capacity * sizeof(PetscInt), &list->target));
    PetscCall(PetscRealloc(list->capacity * sizeof(Ghost), &list->ghost));
  }
  list->target[list->count]  = target;
  list->ghost[list->count++] = (Ghost){index, image};
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The block of the domain's cells that a sphere around x touches. A point outside the box belongs to the nearest
   cells. */
static void CellsAround(Domain domain, const PetscReal x[DIM], PetscReal radius, PetscInt first[DIM],
                        PetscInt last[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal low  = (x[d] - radius - domain->lower[d]) / domain->cell_size[d],
                    high = (x[d] + radius - domain->lower[d]) / domain->cell_size[d];
    const PetscReal n    = (PetscReal)domain->cells[d];

    first[d] = (PetscInt)PetscMax(0, PetscMin(n - 1, PetscFloorReal(low)));
    last[d]  = (PetscInt)PetscMax(0, PetscMin(n - 1, PetscFloorReal(high)));
  }
}

static inline PetscInt CellOwner(Domain domain, const PetscInt cell[DIM])
{
  return domain->cell_rank[CellIndex(domain->cells, cell[0], cell[1], cell[2])];
}

/* Whether an image with this code at x is so far outside the box that no cell is within the radius. */
static PetscBool OutOfRange(Domain domain, PetscInt code, const PetscReal x[DIM], PetscReal radius)
{
  PetscInt part[DIM];

  CellCoordinates(image_box, code, part);
  for (PetscInt d = 0; d < DIM; d++)
    if (part[d] != IMAGE_SAME && ((x[d] + radius - domain->lower[d]) / domain->cell_size[d] < 0 ||
                                  (x[d] - radius - domain->lower[d]) / domain->cell_size[d] > domain->cells[d]))
      return PETSC_TRUE;
  return PETSC_FALSE;
}

static PetscBool HasImages(FaceType face)
{
  return (PetscBool)(face == FACE_PERIODIC || face == FACE_SYMMETRY);
}

/* Distance (m) of x from a cell along one direction. The outermost cells extend beyond the box; at a face with images
   only if 'beyond'. */
static inline PetscReal DistanceAlong(Domain domain, PetscInt d, PetscInt cell, PetscReal x, PetscBool beyond)
{
  const PetscReal low = domain->lower[d] + cell * domain->cell_size[d], high = low + domain->cell_size[d];

  if (x < low) return cell > 0 || (!beyond && HasImages(domain->face[d][0])) ? low - x : 0;
  if (x > high) return cell < domain->cells[d] - 1 || (!beyond && HasImages(domain->face[d][1])) ? x - high : 0;
  return 0;
}

static PetscErrorCode SendTo(PetscInt target, PetscInt index, PetscInt code, PetscInt begin, SendList *list)
{
  PetscFunctionBegin;
  for (PetscInt s = begin; s < list->count; s++)
    if (list->target[s] == target) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SendListAdd(list, target, index, code));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* SendImage for points of different sizes: to every rank that owns a cell which may hold a point that interacts with
   it. */
static PetscErrorCode SendSized(Halo halo, PetscInt index, PetscInt code, const PetscReal x[DIM],
                                const InteractionRange *range, SendList *list)
{
  const Domain    domain = halo->domain;
  const PetscInt *cells = domain->cells, begin = list->count;
  const PetscReal around = PetscMax(range->size[index], range->around[DomainCell(domain, x)]),
                  own2   = PetscSqr(range->support * range->size[index] + range->margin);
  PetscInt first[DIM], last[DIM];

  PetscFunctionBegin;
  if (OutOfRange(domain, code, x, range->support * around + range->margin)) PetscFunctionReturn(PETSC_SUCCESS);
  CellsAround(domain, x, range->support * around + range->margin, first, last);
  for (PetscInt z = first[2]; z <= last[2]; z++)
    for (PetscInt y = first[1]; y <= last[1]; y++) {
      const PetscReal gap2 = PetscSqr(DistanceAlong(domain, 2, z, x[2], PETSC_FALSE)) +
                             PetscSqr(DistanceAlong(domain, 1, y, x[1], PETSC_FALSE));
      const PetscInt line = CellIndex(cells, 0, y, z);

      for (PetscInt k = first[0]; k <= last[0]; k++) {
        const PetscInt  c = line + k, target = domain->cell_rank[c];
        const PetscReal reach2 = PetscMax(own2, range->reach2[c]);

        if (range->most[c] == 0 || (code == 0 && target == halo->rank)) continue;
        if (gap2 + PetscSqr(DistanceAlong(domain, 0, k, x[0], PETSC_FALSE)) > reach2) continue;
        PetscCall(SendTo(target, index, code, begin, list));
        if (halo->size == 1) PetscFunctionReturn(PETSC_SUCCESS);
      }
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sends the image with this code, at x, of owned point 'index' to every rank that owns a cell within the radius. */
static PetscErrorCode SendImage(Halo halo, PetscInt index, PetscInt code, const PetscReal x[DIM],
                                const InteractionRange *range, SendList *list)
{
  const PetscInt begin = list->count;
  PetscInt       first[DIM], last[DIM], cell[DIM];

  PetscFunctionBegin;
  if (range->size) {
    PetscCall(SendSized(halo, index, code, x, range, list));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (OutOfRange(halo->domain, code, x, range->radius)) PetscFunctionReturn(PETSC_SUCCESS);
  CellsAround(halo->domain, x, range->radius, first, last);
  PetscCall(PetscArraycpy(cell, first, DIM));
  do {
    const PetscInt target = CellOwner(halo->domain, cell);

    if (code != 0 || target != halo->rank) PetscCall(SendTo(target, index, code, begin, list));
  } while (CellNext(first, last, cell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks the cells around which all cells within the radius belong to this rank: their points are no ghosts of other
   ranks. */
static void MarkInnerCells(Halo halo, const InteractionRange *range, PetscBool *inner)
{
  const Domain    domain = halo->domain;
  const PetscInt *n      = domain->cells;

  for (PetscInt c = 0; c < n[0] * n[1] * n[2]; c++) {
    const PetscReal radius = range->size ? range->support * range->around[c] + range->margin : range->radius;
    PetscInt        at[DIM], first[DIM], last[DIM], cell[DIM];

    inner[c] = (PetscBool)(domain->cell_rank[c] == halo->rank);
    if (halo->size == 1 || !inner[c]) continue;
    CellCoordinates(n, c, at);
    for (PetscInt d = 0; d < DIM; d++) {
      const PetscInt width = (PetscInt)PetscCeilReal(radius / domain->cell_size[d]);

      first[d] = cell[d] = PetscMax(0, at[d] - width);
      last[d]            = PetscMin(n[d] - 1, at[d] + width);
    }
    do inner[c] = (PetscBool)(CellOwner(domain, cell) == halo->rank);
    while (inner[c] && CellNext(first, last, cell));
  }
}

/* Finds the maps along direction d that bring images of a point at x within the radius of the box. Returns their number
   in 'kind'. */
static PetscInt ImagesAlong(Domain domain, PetscInt d, PetscReal x, PetscReal radius, PetscInt kind[IMAGE_COUNT])
{
  const PetscReal below = x - domain->lower[d], above = domain->upper[d] - x;
  PetscInt        count = 0;

  kind[count++] = IMAGE_SAME;
  if (domain->face[d][0] == FACE_PERIODIC && below < radius) kind[count++] = IMAGE_UP;
  if (domain->face[d][0] == FACE_PERIODIC && above < radius) kind[count++] = IMAGE_DOWN;
  if (domain->face[d][0] == FACE_SYMMETRY && below < radius) kind[count++] = IMAGE_MIRROR_LOWER;
  if (domain->face[d][1] == FACE_SYMMETRY && above < radius) kind[count++] = IMAGE_MIRROR_UPPER;
  return count;
}

/* Sends all images of owned point 'index' at x. inner: it is in an inner cell. */
static PetscErrorCode SendImages(Halo halo, PetscInt index, const PetscReal x[DIM], PetscBool inner,
                                 const InteractionRange *range, SendList *list)
{
  const PetscInt first[DIM] = {0, 0, 0};
  PetscInt       kind[DIM][IMAGE_COUNT], last[DIM], at[DIM] = {0, 0, 0};

  PetscFunctionBegin;
  for (PetscInt d = 0; d < DIM; d++) last[d] = ImagesAlong(halo->domain, d, x[d], range->radius, kind[d]) - 1;
  do {
    const PetscInt code  = CellIndex(image_box, kind[0][at[0]], kind[1][at[1]], kind[2][at[2]]);
    const Image   *image = &halo->images[code];
    PetscReal      y[DIM];

    if (code == 0 && inner) continue;
    for (PetscInt d = 0; d < DIM; d++) y[d] = image->sign[d] * x[d] + image->offset[d];
    PetscCall(SendImage(halo, index, code, y, range, list));
  } while (CellNext(first, last, at));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest size that interacts with points in each cell: a cell's largest size acts as far as its support. One level
   of sizes ([cells] of work) at a time spreads as far as its largest size. */
static PetscErrorCode SpreadSizes(Domain domain, InteractionRange *range, PetscReal level[])
{
  const PetscInt *cells = domain->cells, count = cells[0] * cells[1] * cells[2];

  PetscFunctionBegin;
  for (PetscInt l = 0; l < SIZE_LEVELS; l++) {
    const PetscReal least = l > 0 ? CloudLevelSize(l - 1) : 0,
                    most  = l < SIZE_LEVELS - 1 ? CloudLevelSize(l) : PETSC_MAX_REAL;
    PetscReal largest     = 0;
    PetscInt  width[DIM];

    for (PetscInt c = 0; c < count; c++) {
      level[c] = range->most[c] > least && range->most[c] <= most ? range->most[c] : 0;
      largest  = PetscMax(largest, level[c]);
    }
    if (largest == 0) continue;
    for (PetscInt d = 0; d < DIM; d++)
      width[d] = (PetscInt)PetscCeilReal((range->support * largest + range->margin) / domain->cell_size[d]);
    PetscCall(CellsSpread(cells, width, level));
    for (PetscInt c = 0; c < count; c++) range->around[c] = PetscMax(range->around[c], level[c]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the largest sizes in and around the cells, for points of different sizes. */
static PetscErrorCode FindSizes(Halo halo, PetscInt n, const PetscReal x[], InteractionRange *range)
{
  const Domain    domain = halo->domain;
  const PetscInt *cells = domain->cells, count = cells[0] * cells[1] * cells[2];
  PetscReal      *level;

  PetscFunctionBegin;
  PetscCall(PetscCalloc3(count, &range->most, count, &range->around, count, &range->reach2));
  PetscCall(PetscMalloc1(count, &level));
  for (PetscInt a = 0; a < n; a++) {
    PetscReal *most = &range->most[DomainCell(domain, x + DIM * a)];

    *most = PetscMax(*most, range->size[a]);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, range->most, (PetscMPIInt)count, MPIU_REAL, MPIU_MAX, domain->comm));
  for (PetscInt c = 0; c < count; c++) range->reach2[c] = PetscSqr(range->support * range->most[c] + range->margin);
  PetscCall(SpreadSizes(domain, range, level));
  PetscCall(PetscFree(level));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CollectSends(Halo halo, PetscInt n, const PetscReal x[], const InteractionRange *range,
                                   SendList *list)
{
  const PetscInt *cells = halo->domain->cells;
  PetscBool      *inner;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(cells[0] * cells[1] * cells[2], &inner));
  MarkInnerCells(halo, range, inner);
  for (PetscInt a = 0; a < n; a++)
    PetscCall(SendImages(halo, a, x + DIM * a, inner[DomainCell(halo->domain, x + DIM * a)], range, list));
  PetscCall(PetscFree(inner));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tells each receiver its ghosts from this rank, and gets the ghosts of this rank: received[from[r] .. from[r+1]) from
   rank r. (With PetscCommBuildTwoSided the messages would still have to be counted, packed and sorted by rank.) */
static PetscErrorCode ExchangeGhosts(Halo halo, const SendList *list, PetscMPIInt from[], Ghost **received)
{
  MPI_Comm     comm = halo->domain->comm;
  Ghost       *packed;
  PetscMPIInt *count, *start, *from_count;

  PetscFunctionBegin;
  PetscCall(PetscCalloc3(halo->size, &count, halo->size, &start, halo->size, &from_count));
  PetscCall(PetscMalloc1(list->count, &packed));
  for (PetscInt s = 0; s < list->count; s++) count[list->target[s]]++;
  for (PetscMPIInt r = 0; r < halo->size; r++) start[r] = (r > 0 ? start[r - 1] : 0) + count[r];
  for (PetscInt s = list->count - 1; s >= 0; s--) packed[--start[list->target[s]]] = list->ghost[s];
  PetscCallMPI(MPI_Alltoall(count, 1, MPI_INT, from_count, 1, MPI_INT, comm));
  from[0] = 0;
  for (PetscMPIInt r = 0; r < halo->size; r++) from[r + 1] = from[r] + from_count[r];
  PetscCall(PetscMalloc1(from[halo->size], received));
  PetscCallMPI(MPI_Alltoallv(packed, count, start, MPIU_2INT, *received, from_count, from, MPIU_2INT, comm));
  PetscCall(PetscFree3(count, start, from_count));
  PetscCall(PetscFree(packed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode HaloBuild(Halo halo, PetscInt n, const PetscReal x[], PetscReal support, PetscReal margin,
                         const PetscReal size[], PetscReal size_most, PetscInt *ghosts)
{
  InteractionRange range = {support * size_most + margin, support, margin, size, NULL, NULL, NULL};
  SendList         list  = {0};
  PetscMPIInt     *from;
  Ghost           *received;
  PetscSFNode     *remote;

  PetscFunctionBegin;
  if (size) PetscCall(FindSizes(halo, n, x, &range));
  PetscCall(CollectSends(halo, n, x, &range, &list));
  PetscCall(PetscFree3(range.most, range.around, range.reach2));
  PetscCall(PetscMalloc1(halo->size + 1, &from));
  PetscCall(ExchangeGhosts(halo, &list, from, &received));
  halo->ghosts = from[halo->size];
  PetscCall(PetscMalloc1(halo->ghosts, &remote));
  if (halo->ghosts > halo->capacity) {
    halo->capacity = halo->ghosts + halo->ghosts / 4;
    PetscCall(PetscFree(halo->image));
    PetscCall(PetscMalloc1(halo->capacity, &halo->image));
  }
  for (PetscMPIInt r = 0; r < halo->size; r++)
    for (PetscInt g = from[r]; g < from[r + 1]; g++) {
      remote[g].rank  = r;
      remote[g].index = received[g].index;
      halo->image[g]  = (unsigned char)received[g].image;
    }
  halo->n = n;
  PetscCall(PetscSFDestroy(&halo->sf));
  PetscCall(PetscSFCreate(halo->domain->comm, &halo->sf));
  PetscCall(PetscSFSetGraph(halo->sf, n, halo->ghosts, NULL, PETSC_OWN_POINTER, remote, PETSC_OWN_POINTER));
  PetscCall(PetscSFSetUp(halo->sf));
  PetscCall(PetscFree(from));
  PetscCall(PetscFree(received));
  PetscCall(PetscFree(list.target));
  PetscCall(PetscFree(list.ghost));
  *ghosts = halo->ghosts;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void ApplyImages(Halo halo, PetscInt width, Parity parity, PetscReal *ghost)
{
  for (PetscInt g = 0; g < halo->ghosts; g++) {
    const Image     *image = &halo->images[halo->image[g]];
    const PetscReal *s     = image->sign;
    PetscReal       *value = ghost + g * width;

    if (!halo->image[g]) continue;
    if (parity == PARITY_TENSOR) {
      value[3] *= s[0] * s[1];
      value[4] *= s[0] * s[2];
      value[5] *= s[1] * s[2];
    } else if (parity == PARITY_AXIAL) {
      value[0] *= s[1] * s[2];
      value[1] *= s[0] * s[2];
      value[2] *= s[0] * s[1];
    } else {
      for (PetscInt d = 0; d < DIM; d++) value[d] = s[d] * value[d] + (parity == PARITY_POINT ? image->offset[d] : 0);
    }
  }
}

PetscErrorCode HaloUpdate(Halo halo, PetscInt width, Parity parity, PetscReal array[])
{
  const MPI_Datatype unit  = width == 1 ? MPIU_REAL : width == 3 ? halo->vector : halo->tensor;
  PetscReal         *ghost = array + halo->n * width;

  PetscFunctionBegin;
  PetscCheck(width == 1 || width == 3 || width == 6, PETSC_COMM_SELF, PETSC_ERR_SUP,
             "fields have width 1, 3 or 6, not %" PetscInt_FMT, width);
  PetscCall(PetscSFBcastBegin(halo->sf, unit, array, ghost, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(halo->sf, unit, array, ghost, MPI_REPLACE));
  if (parity != PARITY_SCALAR) ApplyImages(halo, width, parity, ghost);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode HaloUpdateInt(Halo halo, PetscInt array[])
{
  PetscFunctionBegin;
  PetscCall(PetscSFBcastBegin(halo->sf, MPIU_INT, array, array + halo->n, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(halo->sf, MPIU_INT, array, array + halo->n, MPI_REPLACE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Distance (m) of x from a cell; the outermost cells extend beyond the box. */
static PetscReal DistanceToCell(Domain domain, const PetscInt cell[DIM], const PetscReal x[DIM])
{
  PetscReal gap2 = 0;

  for (PetscInt d = 0; d < DIM; d++) gap2 += PetscSqr(DistanceAlong(domain, d, cell[d], x[d], PETSC_TRUE));
  return PetscSqrtReal(gap2);
}

/* Distance (m) of x from the nearest cell of this rank; at most 'limit'. */
static PetscReal DistanceToRank(Domain domain, PetscMPIInt rank, const PetscReal x[DIM], PetscReal limit)
{
  PetscReal nearest = limit;
  PetscInt  first[DIM], last[DIM], cell[DIM];

  if (domain->cell_rank[DomainCell(domain, x)] == rank) return 0;
  CellsAround(domain, x, limit, first, last);
  for (PetscInt d = 0; d < DIM; d++) cell[d] = first[d];
  do {
    if (CellOwner(domain, cell) == rank) nearest = PetscMin(nearest, DistanceToCell(domain, cell, x));
  } while (CellNext(first, last, cell));
  return nearest;
}

PetscReal HaloDistanceOutside(Domain domain, PetscMPIInt rank, PetscInt n, const PetscReal x[], PetscReal limit)
{
  PetscReal largest = 0;

  for (PetscInt a = 0; a < n; a++) {
    const PetscReal *p = x + DIM * a;

    for (PetscInt d = 0; d < DIM; d++) {
      if (HasImages(domain->face[d][0])) largest = PetscMax(largest, domain->lower[d] - p[d]);
      if (HasImages(domain->face[d][1])) largest = PetscMax(largest, p[d] - domain->upper[d]);
    }
    largest = PetscMax(largest, DistanceToRank(domain, rank, p, limit));
  }
  return PetscMin(largest, limit);
}
