/* Cells near free surfaces, and how far they are filled with liquid, walls and solids. */
#include "gas_impl.h"

#define SHIFT 2 /* a block has 2^SHIFT cells a direction, as many as a GasMask has bits in three dimensions */
#define MARGIN                                                                                                         \
  1.5 /* spacings that the cells reach into walls, where they are full: without them half of the part of W             \
         that dry walls have in the box is missing, and a volume is short by d0/4 per wall */
#define NEAR_WET 1.01 /* spacings around a particle inside in which a cell is full */
#define IMAGES   27

enum { TOUCH_EMPTY, TOUCH_FULL, TOUCH_NEAR };

/* The images of a particle at x that are within 'reach' (m) of the box, itself first. Returns their number. */
static PetscInt Images(Domain domain, const PetscReal x[DIM], PetscReal reach, GasImage image[IMAGES])
{
  PetscInt n = 1;

  image[0] = (GasImage){{1, 1, 1}, {0, 0, 0}};
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal length = domain->upper[d] - domain->lower[d];
    const PetscInt  before = n;

    for (PetscInt side = 0; side < 2; side++) {
      const FaceType  face = domain->face[d][side];
      const PetscReal at   = side ? domain->upper[d] : domain->lower[d];

      if ((face != FACE_PERIODIC && face != FACE_SYMMETRY) || PetscAbsReal(x[d] - at) >= reach) continue;
      for (PetscInt k = 0; k < before; k++) {
        image[n] = image[k];
        if (face == FACE_SYMMETRY)
          image[n].sign[d] = -1, image[n++].offset[d] = 2 * at;
        else
          image[n++].offset[d] = side ? -length : length;
      }
    }
  }
  return n;
}

static void Map(const GasImage *image, const PetscReal x[DIM], PetscReal y[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) y[d] = image->sign[d] * x[d] + image->offset[d];
}

static PetscErrorCode SetGrid(GasCells *cells, Domain domain)
{
  PetscFunctionBegin;
  if (cells->block) PetscFunctionReturn(PETSC_SUCCESS);
  cells->all = 1, cells->volume = 1, cells->per = 1;
  for (PetscInt d = 0; d < DIM; d++) {
    PetscReal length = domain->upper[d] - domain->lower[d];

    cells->lower[d] = domain->lower[d];
    for (PetscInt side = 0; side < 2 && d < domain->dim; side++) {
      if (domain->face[d][side] != FACE_WALL) continue;
      length += MARGIN * domain->spacing;
      if (side == 0) cells->lower[d] -= MARGIN * domain->spacing;
    }
    cells->n[d]      = d < domain->dim ? PetscMax(1, (PetscInt)PetscFloorReal(0.5 + length / domain->spacing)) : 1;
    cells->size[d]   = length / cells->n[d];
    cells->many[d]   = 1 / cells->size[d];
    cells->shift[d]  = d < domain->dim ? SHIFT : 0;
    cells->blocks[d] = (cells->n[d] + (1 << cells->shift[d]) - 1) >> cells->shift[d];
    cells->all *= cells->blocks[d];
    cells->per <<= cells->shift[d];
    if (d < domain->dim) cells->volume *= cells->size[d];
  }
  PetscCall(PetscMalloc1(cells->n[0], &cells->column));
  for (PetscInt i = 0; i < cells->n[0]; i++) {
    const PetscReal x[DIM] = {cells->lower[0] + (i + 0.5) * cells->size[0], 0, 0};

    cells->column[i] = cells->volume * DomainPairLength(domain, x, x);
  }
  PetscCall(PetscMalloc1(cells->all, &cells->block));
  PetscCall(PetscMalloc1(cells->all, &cells->home));
  PetscCall(PetscMalloc1(cells->all, &cells->close));
  PetscCall(PetscMalloc1(cells->all, &cells->seen));
  PetscCall(PetscMalloc1(cells->all, &cells->held));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool GasCellsRange(const GasCells *cells, Domain domain, const PetscReal x[DIM], PetscReal reach,
                        PetscInt first[DIM], PetscInt last[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) {
    first[d] = last[d] = 0;
    if (d >= domain->dim) continue;
    first[d] = (PetscInt)PetscMax(0, PetscCeilReal((x[d] - reach - cells->lower[d]) * cells->many[d] - 0.5));
    last[d] =
      (PetscInt)PetscMin(cells->n[d] - 1., PetscFloorReal((x[d] + reach - cells->lower[d]) * cells->many[d] - 0.5));
    if (first[d] > last[d]) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

void GasCellsPlace(const GasCells *cells, PetscInt node, PetscInt at[DIM])
{
  const PetscInt *s = cells->shift, inside = node % cells->per,
                 home =
                   node < cells->near * cells->per ? cells->home[node / cells->per] : node - cells->near * cells->per;

  CellCoordinates(cells->blocks, home, at);
  for (PetscInt d = 0; d < DIM; d++) at[d] <<= s[d];
  if (node >= cells->near * cells->per) return;
  at[0] += inside & ((1 << s[0]) - 1);
  at[1] += (inside >> s[0]) & ((1 << s[1]) - 1);
  at[2] += inside >> (s[0] + s[1]);
}

/* inside[a]: what is next to owned particle a is full: it is inside liquid, or of a wall or solid beside such liquid.
 */
static PetscErrorCode FindInside(Cloud cloud, Pressure pressure, PetscBool inside[])
{
  PetscFunctionBegin;
  PetscCall(PressureNumber(pressure));
  for (PetscInt a = 0; a < cloud->n_owned; a++)
    inside[a] = a < cloud->n_rows ? (PetscBool)!PressureCloses(pressure, a) : inside[PressureParent(pressure, a)];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Calls 'visit' for the images of the owned particles. */
typedef void (*Visitor)(GasCells *cells, Cloud cloud, PetscInt a, PetscBool inside, const PetscReal x[DIM],
                        void *context);

static void ForImages(GasCells *cells, Cloud cloud, const PetscBool inside[], Visitor visit, void *context)
{
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    const PetscReal *x     = cloud->field[FIELD_POSITION] + DIM * a;
    const PetscReal  reach = cloud->size[a] * KernelSupport(cloud->kernel);
    GasImage         image[IMAGES];
    const PetscInt   n = Images(cloud->domain, x, reach, image);

    for (PetscInt k = 0; k < n; k++) {
      PetscReal y[DIM];

      Map(&image[k], x, y);
      visit(cells, cloud, a, inside[a], y, context);
    }
  }
}

/* The blocks that a particle touches; context: [all] TOUCH_... */
static void TouchBlocks(GasCells *cells, Cloud cloud, PetscInt a, PetscBool inside, const PetscReal x[DIM],
                        void *context)
{
  const Domain   domain = cloud->domain;
  unsigned char *touch  = (unsigned char *)context;
  PetscInt       first[DIM], last[DIM];

  if (!GasCellsRange(cells, domain, x, cloud->size[a] * (inside ? domain->spacing : KernelSupport(cloud->kernel)),
                     first, last))
    return;
  for (PetscInt d = 0; d < DIM; d++) first[d] >>= cells->shift[d], last[d] >>= cells->shift[d];
  for (PetscInt k = first[2]; k <= last[2]; k++)
    for (PetscInt j = first[1]; j <= last[1]; j++)
      for (PetscInt i = first[0]; i <= last[0]; i++) {
        unsigned char *block = &touch[CellIndex(cells->blocks, i, j, k)];

        *block = (unsigned char)PetscMax(*block, inside ? TOUCH_FULL : TOUCH_NEAR);
      }
}

static PetscErrorCode SetBlocks(GasCells *cells, Cloud cloud, const PetscBool inside[])
{
  unsigned char *touch;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(cells->all, &touch));
  ForImages(cells, cloud, inside, TouchBlocks, touch);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, touch, (PetscMPIInt)cells->all, MPI_UNSIGNED_CHAR, MPI_MAX, cloud->comm));
  cells->near = 0;
  for (PetscInt b = 0; b < cells->all; b++) {
    cells->block[b] = touch[b] == TOUCH_EMPTY ? BLOCK_EMPTY : BLOCK_FULL;
    if (touch[b] != TOUCH_NEAR) continue;
    cells->home[cells->near] = b;
    cells->block[b]          = cells->near++;
  }
  PetscCall(PetscFree(touch));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Reserve(GasCells *cells)
{
  const PetscInt nodes = cells->near * cells->per + cells->all;

  PetscFunctionBegin;
  if (nodes <= cells->capacity) PetscFunctionReturn(PETSC_SUCCESS);
  cells->capacity = nodes + nodes / 4;
  PetscCall(PetscFree(cells->filled));
  PetscCall(PetscFree(cells->solid));
  PetscCall(PetscFree(cells->label));
  PetscCall(PetscFree(cells->owner));
  PetscCall(PetscMalloc1(cells->capacity, &cells->filled));
  PetscCall(PetscMalloc1(cells->capacity, &cells->solid));
  PetscCall(PetscMalloc1(cells->capacity, &cells->label));
  PetscCall(PetscMalloc1(cells->capacity, &cells->owner));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The bits width lo .. width (hi + 1) - 1. */
static GasMask Bits(PetscInt width, PetscInt lo, PetscInt hi)
{
  return ((GasMask)2 << (width * (hi + 1) - 1)) - ((GasMask)1 << (width * lo));
}

/* The cells first .. last of the block (at[0], at[1], at[2]). */
static GasMask BoxMask(const GasCells *cells, const PetscInt at[DIM], const PetscInt first[DIM],
                       const PetscInt last[DIM])
{
  const GasMask each[DIM] = {0x1111111111111111, 0x0001000100010001, 1};
  GasMask       mask      = ~(GasMask)0;

  for (PetscInt d = 0; d < DIM; d++) {
    const PetscInt lo = PetscMax(0, first[d] - (at[d] << cells->shift[d])),
                   hi = PetscMin((1 << cells->shift[d]) - 1, last[d] - (at[d] << cells->shift[d]));

    mask &= Bits((PetscInt)1 << (SHIFT * d), lo, hi) * each[d];
  }
  return mask;
}

/* context: [near] masks of the cells near what is inside, and beside them those within the support of the others */
static void MarkCells(GasCells *cells, Cloud cloud, PetscInt a, PetscBool inside, const PetscReal x[DIM], void *context)
{
  GasMask        *mask  = (GasMask *)context + (inside ? 0 : cells->near);
  const PetscReal reach = inside ? NEAR_WET * cloud->domain->spacing : KernelSupport(cloud->kernel);
  PetscInt        first[DIM], last[DIM], from[DIM], to[DIM], at[DIM];

  if (!GasCellsRange(cells, cloud->domain, x, cloud->size[a] * reach, first, last)) return;
  for (PetscInt d = 0; d < DIM; d++) {
    at[d] = from[d] = first[d] >> cells->shift[d];
    to[d]           = last[d] >> cells->shift[d];
  }
  do {
    const PetscInt block = cells->block[CellIndex(cells->blocks, at[0], at[1], at[2])];

    if (block >= 0) mask[block] |= BoxMask(cells, at, first, last);
  } while (CellNext(from, to, at));
}

/* Evaluates the kernel at the cells that have been found, and visits them. */
static void Visit(const GasCells *cells, Kernel kernel, GasNear *near, GasVisitor visit, void *context)
{
  if (!near->n) return;
  KernelEvaluate(kernel, near->n, near->r2, near->W, near->F);
  visit(cells, near, context);
  near->n = 0;
}

/* Adds the cells of a mask of the block (at[0], at[1], at[2]) that are within the support of the particle at x. */
static void AddBlock(const GasCells *cells, Cloud cloud, GasMask mask, const PetscInt at[DIM], const PetscReal x[DIM],
                     PetscReal size, GasVisitor visit, void *context, GasNear *near)
{
  const PetscReal support2 = PetscSqr(KernelSupport(cloud->kernel)), per = 1 / size;
  const PetscInt  node = cells->block[CellIndex(cells->blocks, at[0], at[1], at[2])] * cells->per, *s = cells->shift;
  PetscReal       from[DIM] = {0, 0, 0}, step[DIM] = {0, 0, 0};

  for (PetscInt d = 0; d < cloud->domain->dim; d++) {
    from[d] = (x[d] - cells->lower[d] - ((at[d] << s[d]) + 0.5) * cells->size[d]) * per;
    step[d] = cells->size[d] * per;
  }
  for (; mask; mask &= mask - 1) {
    const PetscInt cell = __builtin_ctzll(mask), i = cell & ((1 << s[0]) - 1), j = (cell >> s[0]) & ((1 << s[1]) - 1),
                   k       = cell >> (s[0] + s[1]);
    const PetscReal r[DIM] = {from[0] - i * step[0], from[1] - j * step[1], from[2] - k * step[2]}, r2 = Dot(r, r);

    if (r2 >= support2) continue;
    near->node[near->n]   = node + cell;
    near->volume[near->n] = cells->column[(at[0] << s[0]) + i];
    near->r2[near->n]     = r2;
    for (PetscInt d = 0; d < DIM; d++) near->r[near->n][d] = r[d];
    if (++near->n == GAS_NEAR) Visit(cells, cloud->kernel, near, visit, context);
  }
}

/* For the image of a particle at x. */
static void ForImage(const GasCells *cells, Cloud cloud, const GasMask set[], PetscInt a, const GasImage *image,
                     const PetscReal x[DIM], GasVisitor visit, void *context)
{
  PetscInt first[DIM], last[DIM], from[DIM], to[DIM], at[DIM];
  GasNear  near;

  if (!GasCellsRange(cells, cloud->domain, x, cloud->size[a] * KernelSupport(cloud->kernel), first, last)) return;
  for (PetscInt d = 0; d < DIM; d++) {
    at[d] = from[d] = first[d] >> cells->shift[d];
    to[d]           = last[d] >> cells->shift[d];
  }
  near.n     = 0;
  near.image = image;
  do {
    const PetscInt block = cells->block[CellIndex(cells->blocks, at[0], at[1], at[2])];
    const GasMask  mask  = block >= 0 && set[block] ? set[block] & BoxMask(cells, at, first, last) : 0;

    if (mask) AddBlock(cells, cloud, mask, at, x, cloud->size[a], visit, context, &near);
  } while (CellNext(from, to, at));
  Visit(cells, cloud->kernel, &near, visit, context);
}

void GasCellsNear(const GasCells *cells, Cloud cloud, const GasMask set[], PetscInt a, GasVisitor visit, void *context)
{
  const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a;
  GasImage         image[IMAGES];
  const PetscInt   n = Images(cloud->domain, x, cloud->size[a] * KernelSupport(cloud->kernel), image);

  for (PetscInt k = 0; k < n; k++) {
    PetscReal y[DIM];

    Map(&image[k], x, y);
    ForImage(cells, cloud, set, a, &image[k], y, visit, context);
  }
}

/* Where a particle's sums go, and its volume of GasPart. */
typedef struct {
  PetscReal *sum, part;
} Filling;

static void AddFilled(const GasCells *cells, const GasNear *near, void *context)
{
  const Filling *filling = (const Filling *)context;

  for (PetscInt m = 0; m < near->n; m++) filling->sum[near->node[m]] += filling->part * near->W[m];
}

/* Adds the particles from 'first' on to the sums of the cells; full: sum V W on a full lattice. */
static void FillFrom(const GasCells *cells, Cloud cloud, PetscInt first, PetscReal full, PetscReal sum[])
{
  for (PetscInt a = first; a < cloud->n_owned; a++) {
    Filling filling = {sum, GasPart(cloud, a, full)};

    GasCellsNear(cells, cloud, cells->close, a, AddFilled, &filling);
  }
}

/* The middle of a cell, or of the first cell of an empty block. */
static void CellMiddle(const GasCells *cells, Domain domain, PetscInt node, PetscReal x[DIM])
{
  PetscInt at[DIM];

  GasCellsPlace(cells, node, at);
  for (PetscInt d = 0; d < DIM; d++) x[d] = d < domain->dim ? cells->lower[d] + (at[d] + 0.5) * cells->size[d] : 0;
}

enum { CORE_UNKNOWN, CORE_OUTSIDE, CORE_DEEP, CORE_HOLLOW };

/* How deep a cell is in a solid; from CORE_HOLLOW on it is full, whatever moves: behind its dummy particles a solid is
   hollow. */
static unsigned char CoreOf(const GasCells *cells, Cloud cloud, PetscInt node)
{
  PetscReal x[DIM], depth;

  CellMiddle(cells, cloud->domain, node, x);
  depth = -SceneSolidDistance(cloud->scene, x, NULL) / cloud->domain->spacing;
  return depth > MARGIN ? CORE_HOLLOW : depth > 1 ? CORE_DEEP : CORE_OUTSIDE;
}

/* Cells inside a solid are full. Solids at rest are asked for each cell once. */
static PetscErrorCode FillSolids(GasCells *cells, Cloud cloud, const GasMask wet[], PetscBool moved)
{
  PetscFunctionBegin;
  if (!SceneSolidCount(cloud->scene)) PetscFunctionReturn(PETSC_SUCCESS);
  if (!cells->core) PetscCall(PetscCalloc1(cells->all * cells->per, &cells->core));
  if (moved) PetscCall(PetscArrayzero(cells->core, cells->all * cells->per));
  for (PetscInt c = 0; c < cells->near * cells->per; c++) {
    unsigned char *core = &cells->core[cells->home[c / cells->per] * cells->per + c % cells->per];
    const GasMask  bit  = (GasMask)1 << (c % cells->per);

    if (wet[c / cells->per] & ~cells->close[c / cells->per] & bit) continue;
    if (*core == CORE_UNKNOWN) *core = CoreOf(cells, cloud, c);
    if (*core == CORE_HOLLOW || (*core == CORE_DEEP && cells->filled[c] < 0.5)) cells->filled[c] = 1;
    if (*core == CORE_HOLLOW) cells->close[c / cells->per] &= ~bit;
  }
  for (PetscInt b = 0; b < cells->all; b++)
    if (cells->block[b] == BLOCK_EMPTY && CoreOf(cells, cloud, cells->near * cells->per + b) > CORE_OUTSIDE)
      cells->block[b] = BLOCK_FULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GasCellsFill(GasCells *cells, Cloud cloud, Pressure pressure, PetscBool moved)
{
  PetscInt   count;
  PetscBool *inside;
  GasMask   *wet;

  PetscFunctionBegin;
  PetscCall(SetGrid(cells, cloud->domain));
  PetscCall(PetscMalloc1(cloud->n_owned, &inside));
  PetscCall(FindInside(cloud, pressure, inside));
  PetscCall(SetBlocks(cells, cloud, inside));
  PetscCall(Reserve(cells));
  count = cells->near * cells->per;
  PetscCall(PetscCalloc1(2 * cells->near, &wet));
  ForImages(cells, cloud, inside, MarkCells, wet);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, wet, (PetscMPIInt)(2 * cells->near), MPI_UINT64_T, MPI_BOR, cloud->comm));
  PetscCall(PetscArraycpy(cells->close, wet + cells->near, cells->near));
  PetscCall(PetscArrayzero(cells->filled, count));
  cells->solid_known = PETSC_FALSE;
  FillFrom(cells, cloud, 0, PressureFull(pressure), cells->filled);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, cells->filled, (PetscMPIInt)count, MPIU_REAL, MPIU_SUM, cloud->comm));
  for (PetscInt c = 0; c < count; c++)
    if ((wet[c / cells->per] & ~cells->close[c / cells->per]) >> (c % cells->per) & 1) cells->filled[c] = 1;
  PetscCall(FillSolids(cells, cloud, wet, moved));
  PetscCall(PetscFree(wet));
  PetscCall(PetscFree(inside));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GasCellsSolid(GasCells *cells, Cloud cloud, PetscReal full)
{
  const PetscInt count = cells->near * cells->per;

  PetscFunctionBegin;
  if (cells->solid_known) PetscFunctionReturn(PETSC_SUCCESS);
  cells->solid_known = PETSC_TRUE;
  PetscCall(PetscArrayzero(cells->solid, count));
  FillFrom(cells, cloud, cloud->n_fluid, full, cells->solid);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, cells->solid, (PetscMPIInt)count, MPIU_REAL, MPIU_SUM, cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces on a dummy particle by the regions around it. */
typedef struct {
  PetscReal part, size;
  PetscInt  count, owner[GAS_SHARE];
  PetscReal unit[GAS_SHARE][DIM];
} Load;

static void AddLoad(const GasCells *cells, const GasNear *near, void *context)
{
  Load *load = (Load *)context;

  for (PetscInt m = 0; m < near->n; m++) {
    const PetscInt  node = near->node[m], owner = cells->owner[node];
    const PetscReal scale =
      -6 * cells->solid[node] * (1 - cells->filled[node]) * load->part * near->volume[m] * near->F[m] / load->size;
    PetscInt k = 0;

    while (k < load->count && load->owner[k] != owner) k++;
    if (k == GAS_SHARE) continue;
    if (k == load->count) load->owner[load->count++] = owner;
    for (PetscInt d = 0; d < DIM; d++) load->unit[k][d] += near->image->sign[d] * scale * near->r[m][d];
  }
}

/* Whether direction d of a force on a dummy particle at x counts. For a wall of the box that is its normal; what
   particles behind a corner and beside it get along the other wall would cancel. */
static PetscBool Bears(Domain domain, PetscInt body, const PetscReal x[DIM], PetscInt d)
{
  PetscInt beyond[DIM], faces = 0;

  for (PetscInt e = 0; e < DIM; e++) {
    beyond[e] = e < domain->dim && ((domain->face[e][0] == FACE_WALL && x[e] < domain->lower[e]) ||
                                    (domain->face[e][1] == FACE_WALL && x[e] > domain->upper[e]));
    faces += beyond[e];
  }
  return (PetscBool)(body <= BODY_SOLID || (faces == 1 && beyond[d]));
}

static PetscErrorCode ListLoads(Domain domain, PetscInt a, PetscInt body, const PetscReal x[DIM], const Load *load,
                                GasLoads *loads)
{
  PetscFunctionBegin;
  if (loads->count + load->count > loads->capacity) {
    loads->capacity = 2 * loads->capacity + 1024;
    PetscCall(PetscRealloc((size_t)loads->capacity * sizeof(GasLoad), &loads->load));
  }
  for (PetscInt k = 0; k < load->count; k++) {
    GasLoad *to = &loads->load[loads->count++];

    *to = (GasLoad){.dummy = a, .pocket = load->owner[k]};
    for (PetscInt d = 0; d < DIM; d++) to->unit[d] = Bears(domain, body, x, d) ? load->unit[k][d] : 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GasCellsLoads(GasCells *cells, Cloud cloud, PetscReal full, GasLoads *loads)
{
  PetscFunctionBegin;
  loads->count = 0;
  PetscCall(GasCellsSolid(cells, cloud, full));
  for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++) {
    const PetscReal *x    = cloud->field[FIELD_POSITION] + DIM * a;
    Load             load = {.part = GasPart(cloud, a, full), .size = cloud->size[a]};

    if (!cloud->integer[INT_LAYER][a]) continue;
    GasCellsNear(cells, cloud, cells->held, a, AddLoad, &load);
    PetscCall(ListLoads(cloud->domain, a, cloud->integer[INT_BODY][a], x, &load, loads));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GasCellsDestroy(GasCells *cells)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(cells->column));
  PetscCall(PetscFree(cells->block));
  PetscCall(PetscFree(cells->home));
  PetscCall(PetscFree(cells->close));
  PetscCall(PetscFree(cells->seen));
  PetscCall(PetscFree(cells->held));
  PetscCall(PetscFree(cells->core));
  PetscCall(PetscFree(cells->filled));
  PetscCall(PetscFree(cells->solid));
  PetscCall(PetscFree(cells->label));
  PetscCall(PetscFree(cells->owner));
  PetscFunctionReturn(PETSC_SUCCESS);
}
