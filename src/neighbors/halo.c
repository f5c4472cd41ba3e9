#include "halo.h"
#include <petscsf.h>

/* Images of one direction; an image of a point is one of these in each direction. */
enum { IMAGE_SAME, IMAGE_UP, IMAGE_DOWN, IMAGE_MIRROR_LOWER, IMAGE_MIRROR_UPPER, IMAGE_COUNT };

typedef struct {
  PetscReal sign[DIM], offset[DIM]; /* x' = sign x + offset */
} Image;

struct _p_Halo {
  Domain         domain;
  PetscMPIInt    rank, size;
  PetscSF        sf;
  PetscInt       n, ghosts, capacity;
  unsigned char *image; /* [ghosts] index into images */
  Image          images[IMAGE_COUNT * IMAGE_COUNT * IMAGE_COUNT];
  MPI_Datatype   vector, tensor;
};

/* Particles to send: for each of 'count', the receiving rank, the local index and the image. */
typedef struct {
  PetscInt  count, capacity;
  PetscInt *target, *index, *image;
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
    const PetscInt part[DIM] = {code % IMAGE_COUNT, (code / IMAGE_COUNT) % IMAGE_COUNT,
                                code / (IMAGE_COUNT * IMAGE_COUNT)};

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
    PetscCall(PetscRealloc(list->capacity * sizeof(PetscInt), &list->index));
    PetscCall(PetscRealloc(list->capacity * sizeof(PetscInt), &list->image));
  }
  list->target[list->count]  = target;
  list->index[list->count]   = index;
  list->image[list->count++] = image;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The cells within radius of x: first and last index a direction. False if an image lies too far outside the box to be
 * seen by anyone. */
static PetscBool CellRange(Domain domain, const PetscReal x[DIM], PetscReal radius, PetscBool inside[DIM],
                           PetscInt first[DIM], PetscInt last[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal low  = (x[d] - radius - domain->lower[d]) / domain->cell_size[d],
                    high = (x[d] + radius - domain->lower[d]) / domain->cell_size[d];
    const PetscReal n    = (PetscReal)domain->cells[d];

    if (!inside[d] && (high < 0 || low > n)) return PETSC_FALSE;
    first[d] = (PetscInt)PetscMax(0, PetscMin(n - 1, PetscFloorReal(low)));
    last[d]  = (PetscInt)PetscMax(0, PetscMin(n - 1, PetscFloorReal(high)));
  }
  return PETSC_TRUE;
}

/* The ranks that own a cell within radius of image 'code' (at x) of owned point 'index' get it. */
static PetscErrorCode SendImage(Halo halo, PetscInt index, PetscInt code, const PetscReal x[DIM], PetscReal radius,
                                SendList *list)
{
  Domain         domain    = halo->domain;
  const PetscInt part[DIM] = {code % IMAGE_COUNT, (code / IMAGE_COUNT) % IMAGE_COUNT,
                              code / (IMAGE_COUNT * IMAGE_COUNT)};
  PetscBool      inside[DIM];
  PetscInt       first[DIM], last[DIM], begin = list->count;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < DIM; d++) inside[d] = (PetscBool)(part[d] == IMAGE_SAME);
  if (!CellRange(domain, x, radius, inside, first, last)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = first[2]; k <= last[2]; k++)
    for (PetscInt j = first[1]; j <= last[1]; j++)
      for (PetscInt i = first[0]; i <= last[0]; i++) {
        const PetscInt target = domain->cell_rank[(k * domain->cells[1] + j) * domain->cells[0] + i];
        PetscBool      known  = (PetscBool)(code == 0 && target == halo->rank);

        for (PetscInt s = begin; s < list->count && !known; s++) known = (PetscBool)(list->target[s] == target);
        if (!known) PetscCall(SendListAdd(list, target, index, code));
      }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A cell is inner if everything within radius of it belongs to this rank: its points need no identity ghosts. */
static PetscErrorCode MarkInnerCells(Halo halo, PetscReal radius, PetscBool *inner)
{
  Domain          domain = halo->domain;
  const PetscInt *n = domain->cells, count = n[0] * n[1] * n[2];
  PetscInt        width[DIM];

  PetscFunctionBegin;
  for (PetscInt d = 0; d < DIM; d++) width[d] = (PetscInt)PetscCeilReal(radius / domain->cell_size[d]);
  for (PetscInt c = 0; c < count; c++) inner[c] = PETSC_TRUE;
  if (halo->size == 1) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt c = 0; c < count; c++) {
    const PetscInt at[DIM] = {c % n[0], (c / n[0]) % n[1], c / (n[0] * n[1])};

    inner[c] = (PetscBool)(domain->cell_rank[c] == halo->rank);
    for (PetscInt k = PetscMax(0, at[2] - width[2]); k <= PetscMin(n[2] - 1, at[2] + width[2]) && inner[c]; k++)
      for (PetscInt j = PetscMax(0, at[1] - width[1]); j <= PetscMin(n[1] - 1, at[1] + width[1]) && inner[c]; j++)
        for (PetscInt i = PetscMax(0, at[0] - width[0]); i <= PetscMin(n[0] - 1, at[0] + width[0]) && inner[c]; i++)
          inner[c] = (PetscBool)(domain->cell_rank[(k * n[1] + j) * n[0] + i] == halo->rank);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CollectSends(Halo halo, PetscInt n, const PetscReal x[], PetscReal radius, SendList *list)
{
  Domain     domain = halo->domain;
  PetscBool *inner;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(domain->cells[0] * domain->cells[1] * domain->cells[2], &inner));
  PetscCall(MarkInnerCells(halo, radius, inner));
  for (PetscInt a = 0; a < n; a++) {
    const PetscReal *p = x + DIM * a;
    PetscInt         option[DIM][3], options[DIM];

    for (PetscInt d = 0; d < DIM; d++) {
      const PetscReal below = p[d] - domain->lower[d], above = domain->upper[d] - p[d];

      options[d]              = 0;
      option[d][options[d]++] = IMAGE_SAME;
      if (domain->face[d][0] == FACE_PERIODIC && below < radius) option[d][options[d]++] = IMAGE_UP;
      if (domain->face[d][0] == FACE_PERIODIC && above < radius) option[d][options[d]++] = IMAGE_DOWN;
      if (domain->face[d][0] == FACE_SYMMETRY && below < radius) option[d][options[d]++] = IMAGE_MIRROR_LOWER;
      if (domain->face[d][1] == FACE_SYMMETRY && above < radius) option[d][options[d]++] = IMAGE_MIRROR_UPPER;
    }
    if (options[0] * options[1] * options[2] == 1 && inner[DomainCell(domain, p)]) continue;
    for (PetscInt k = 0; k < options[2]; k++)
      for (PetscInt j = 0; j < options[1]; j++)
        for (PetscInt i = 0; i < options[0]; i++) {
          const PetscInt code  = option[0][i] + IMAGE_COUNT * (option[1][j] + IMAGE_COUNT * option[2][k]);
          const Image   *image = &halo->images[code];
          PetscReal      y[DIM];

          if (code == 0 && halo->size == 1) continue;
          for (PetscInt d = 0; d < DIM; d++) y[d] = image->sign[d] * p[d] + image->offset[d];
          PetscCall(SendImage(halo, a, code, y, radius, list));
        }
  }
  PetscCall(PetscFree(inner));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tells each receiver which of our particles, under which image, are its ghosts. Received pairs (index, image) come
 * sorted by owner. */
static PetscErrorCode ExchangeLists(Halo halo, const SendList *list, PetscInt *ghosts, PetscMPIInt **owner,
                                    PetscInt **pairs)
{
  MPI_Comm     comm = halo->domain->comm;
  PetscInt    *place, *packed, received = 0;
  PetscMPIInt *count, *start, *from_count, *from_start;

  PetscFunctionBegin;
  PetscCall(
    PetscCalloc4(halo->size, &count, halo->size + 1, &start, halo->size, &from_count, halo->size + 1, &from_start));
  PetscCall(PetscMalloc2(halo->size, &place, 2 * list->count, &packed));
  for (PetscInt s = 0; s < list->count; s++) count[list->target[s]] += 2;
  for (PetscMPIInt r = 0; r < halo->size; r++) {
    start[r + 1] = start[r] + count[r];
    place[r]     = start[r];
  }
  for (PetscInt s = 0; s < list->count; s++) {
    packed[place[list->target[s]]++] = list->index[s];
    packed[place[list->target[s]]++] = list->image[s];
  }
  PetscCallMPI(MPI_Alltoall(count, 1, MPI_INT, from_count, 1, MPI_INT, comm));
  for (PetscMPIInt r = 0; r < halo->size; r++) from_start[r + 1] = from_start[r] + from_count[r];
  received = from_start[halo->size] / 2;
  PetscCall(PetscMalloc1(received, owner));
  PetscCall(PetscMalloc1(2 * received, pairs));
  PetscCallMPI(MPI_Alltoallv(packed, count, start, MPIU_INT, *pairs, from_count, from_start, MPIU_INT, comm));
  for (PetscMPIInt r = 0; r < halo->size; r++)
    for (PetscInt g = from_start[r] / 2; g < from_start[r + 1] / 2; g++) (*owner)[g] = r;
  PetscCall(PetscFree4(count, start, from_count, from_start));
  PetscCall(PetscFree2(place, packed));
  *ghosts = received;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode HaloBuild(Halo halo, PetscInt n, const PetscReal x[], PetscReal radius, PetscInt *ghosts)
{
  SendList     list = {0};
  PetscMPIInt *owner;
  PetscInt    *pairs;
  PetscSFNode *remote;

  PetscFunctionBegin;
  PetscCall(CollectSends(halo, n, x, radius, &list));
  PetscCall(ExchangeLists(halo, &list, &halo->ghosts, &owner, &pairs));
  PetscCall(PetscMalloc1(halo->ghosts, &remote));
  if (halo->ghosts > halo->capacity) {
    halo->capacity = halo->ghosts + halo->ghosts / 4;
    PetscCall(PetscFree(halo->image));
    PetscCall(PetscMalloc1(halo->capacity, &halo->image));
  }
  for (PetscInt g = 0; g < halo->ghosts; g++) {
    remote[g].rank  = owner[g];
    remote[g].index = pairs[2 * g];
    halo->image[g]  = (unsigned char)pairs[2 * g + 1];
  }
  halo->n = n;
  PetscCall(PetscSFDestroy(&halo->sf));
  PetscCall(PetscSFCreate(halo->domain->comm, &halo->sf));
  PetscCall(PetscSFSetGraph(halo->sf, n, halo->ghosts, NULL, PETSC_OWN_POINTER, remote, PETSC_OWN_POINTER));
  PetscCall(PetscSFSetUp(halo->sf));
  PetscCall(PetscFree(owner));
  PetscCall(PetscFree(pairs));
  PetscCall(PetscFree(list.target));
  PetscCall(PetscFree(list.index));
  PetscCall(PetscFree(list.image));
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

static PetscBool HasImages(FaceType face)
{
  return (PetscBool)(face == FACE_PERIODIC || face == FACE_SYMMETRY);
}

PetscReal HaloDistanceOutside(Domain domain, PetscMPIInt rank, PetscInt n, const PetscReal x[], PetscReal limit)
{
  const PetscBool inside[DIM] = {PETSC_TRUE, PETSC_TRUE, PETSC_TRUE};
  PetscReal       stray       = 0;

  for (PetscInt a = 0; a < n; a++) {
    const PetscReal *p = x + DIM * a;
    PetscInt         first[DIM], last[DIM];
    PetscReal        nearest = limit;

    for (PetscInt d = 0; d < DIM; d++) {
      if (HasImages(domain->face[d][0])) stray = PetscMax(stray, domain->lower[d] - p[d]);
      if (HasImages(domain->face[d][1])) stray = PetscMax(stray, p[d] - domain->upper[d]);
    }
    if (domain->cell_rank[DomainCell(domain, p)] == rank) continue;
    (void)CellRange(domain, p, limit, (PetscBool *)inside, first, last);
    for (PetscInt k = first[2]; k <= last[2]; k++)
      for (PetscInt j = first[1]; j <= last[1]; j++)
        for (PetscInt i = first[0]; i <= last[0]; i++) {
          const PetscInt cell[DIM] = {i, j, k};
          PetscReal      gap2      = 0;

          if (domain->cell_rank[(k * domain->cells[1] + j) * domain->cells[0] + i] != rank) continue;
          for (PetscInt d = 0; d < DIM; d++) {
            const PetscReal low = domain->lower[d] + cell[d] * domain->cell_size[d], high = low + domain->cell_size[d];

            if (p[d] < low && cell[d] > 0) gap2 += PetscSqr(low - p[d]);
            if (p[d] > high && cell[d] < domain->cells[d] - 1) gap2 += PetscSqr(p[d] - high);
          }
          nearest = PetscMin(nearest, PetscSqrtReal(gap2));
        }
    stray = PetscMax(stray, nearest);
  }
  return PetscMin(stray, limit);
}
