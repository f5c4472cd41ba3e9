/* Cells near free surfaces, and how far they are filled with liquid, walls and solids. */
#include "gas_impl.h"

#define SHIFT 2 /* a block has 2^SHIFT cells a direction, as many as a GasMask has bits in three dimensions */
/* spacings that the cells reach into walls, where they are full: without them half of the part of W that dry walls have
   in the box is missing, and a volume is short by d0/4 per wall */
#define MARGIN   1.5
#define NEAR_WET 1.01 /* spacings around a particle inside in which a cell is full */

enum { TOUCH_FULL = 1, TOUCH_WALL = 2, TOUCH_NEAR = 4 };

static const Image Itself = {.sign = {1, 1, 1}};

/* Whether a particle at x has no image but itself within 'reach' (m) of the box. */
static PetscBool Alone(const GasCells *cells, const PetscReal x[DIM], PetscReal reach)
{
  for (PetscInt d = 0; d < DIM; d++)
    if (x[d] - reach <= cells->single[d][0] || x[d] + reach >= cells->single[d][1]) return PETSC_FALSE;
  return PETSC_TRUE;
}

static PetscErrorCode SetGrid(GasCells *cells, Domain domain)
{
  PetscFunctionBegin;
  if (cells->block) PetscFunctionReturn(PETSC_SUCCESS);
  cells->all = 1, cells->volume = 1, cells->per = 1;
  for (PetscInt d = 0; d < DIM; d++) {
    PetscReal length = domain->upper[d] - domain->lower[d];

    cells->lower[d] = domain->lower[d];
    for (PetscInt side = 0; side < 2; side++) {
      const PetscBool images =
        (PetscBool)(domain->face[d][side] == FACE_PERIODIC || domain->face[d][side] == FACE_SYMMETRY);

      cells->single[d][side] = d < domain->dim && images ? (side ? domain->upper[d] : domain->lower[d])
                                                         : (side ? PETSC_INFINITY : PETSC_NINFINITY);
    }
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
  for (GasSet *const *set = (GasSet *const[]){&cells->close, &cells->seen, &cells->held, NULL}; *set; set++) {
    PetscCall(PetscMalloc1(cells->all, &(*set)->mask));
    PetscCall(PetscMalloc1(cells->all, &(*set)->beside));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The cells first .. last whose middles lie within 'reach' (m) of x (m); false: there are none. */
static PetscBool Range(const GasCells *cells, Domain domain, const PetscReal x[DIM], PetscReal reach,
                       PetscInt first[DIM], PetscInt last[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) {
    first[d] = last[d] = 0;
    if (d >= domain->dim) continue;
    const PetscReal from = (x[d] - reach - cells->lower[d]) * cells->many[d] - 0.5,
                    to   = (x[d] + reach - cells->lower[d]) * cells->many[d] - 0.5;

    if (!(to >= 0 && from <= cells->n[d] - 1)) return PETSC_FALSE;
    if (from > 0) first[d] = (PetscInt)from, first[d] += first[d] < from;
    last[d] = to < cells->n[d] ? (PetscInt)to : cells->n[d] - 1;
    if (first[d] > last[d]) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

void GasCellsPlace(const GasCells *cells, PetscInt node, PetscInt at[DIM])
{
  const PetscInt *s = cells->shift, inside = node & (cells->per - 1), all = s[0] + s[1] + s[2],
                 home = node < cells->near * cells->per ? cells->home[node >> all] : node - cells->near * cells->per;

  CellCoordinates(cells->blocks, home, at);
  for (PetscInt d = 0; d < DIM; d++) at[d] <<= s[d];
  if (node >= cells->near * cells->per) return;
  at[0] += inside & ((1 << s[0]) - 1);
  at[1] += (inside >> s[0]) & ((1 << s[1]) - 1);
  at[2] += inside >> (s[0] + s[1]);
}

/* beside[]: whether block (at[0], at[1], at[2]) or one beside it is one of those that are added. */
static void AddBeside(const GasCells *cells, PetscInt home, unsigned char beside[])
{
  PetscInt at[DIM], from[DIM], to[DIM];

  CellCoordinates(cells->blocks, home, at);
  for (PetscInt d = 0; d < DIM; d++) {
    from[d] = PetscMax(0, at[d] - 1);
    to[d]   = PetscMin(cells->blocks[d] - 1, at[d] + 1);
    at[d]   = from[d];
  }
  do beside[CellIndex(cells->blocks, at[0], at[1], at[2])] = 1;
  while (CellNext(from, to, at));
}

void GasSetBeside(const GasCells *cells, GasSet *set)
{
  for (PetscInt b = 0; b < cells->all; b++) set->beside[b] = 0;
  for (PetscInt b = 0; b < cells->near; b++)
    if (set->mask[b]) AddBeside(cells, cells->home[b], set->beside);
}

/* Whether there may be cells within 'reach' (m) of x in blocks that have been added to beside. */
static PetscBool MayReach(const GasCells *cells, Domain domain, const unsigned char beside[], const PetscReal x[DIM],
                          PetscReal reach)
{
  PetscInt home = 0;

  for (PetscInt d = domain->dim - 1; d >= 0; d--) {
    const PetscReal at = (x[d] - cells->lower[d]) * cells->many[d];

    if (reach * cells->many[d] > 1 << SHIFT) return PETSC_TRUE; /* beyond the blocks beside it */
    home *= cells->blocks[d];
    if (at > 0) home += at < cells->n[d] ? (PetscInt)at >> SHIFT : cells->blocks[d] - 1;
  }
  return (PetscBool)beside[home];
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
  const PetscReal support = KernelSupport(cloud->kernel);

  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a;
    Image            image[IMAGES_MOST];
    PetscInt         n;

    if (Alone(cells, x, cloud->size[a] * support)) {
      visit(cells, cloud, a, inside[a], x, context);
      continue;
    }
    n = DomainImages(cloud->domain, x, cloud->size[a] * support, image);
    for (PetscInt k = 0; k < n; k++) visit(cells, cloud, a, inside[a], image[k].x, context);
  }
}

/* The blocks that a particle touches; context: [all] TOUCH_..., of what is inside, of other particles of walls of the
   box, and of the rest. */
static void TouchBlocks(GasCells *cells, Cloud cloud, PetscInt a, PetscBool inside, const PetscReal x[DIM],
                        void *context)
{
  const Domain   domain = cloud->domain;
  unsigned char *touch  = (unsigned char *)context;
  unsigned char  kind   = inside ? TOUCH_FULL : cloud->integer[INT_BODY][a] == BODY_WALL ? TOUCH_WALL : TOUCH_NEAR;
  PetscInt       first[DIM], last[DIM];

  if (!Range(cells, domain, x, cloud->size[a] * (inside ? domain->spacing : KernelSupport(cloud->kernel)), first, last))
    return;
  for (PetscInt d = 0; d < DIM; d++) first[d] >>= cells->shift[d], last[d] >>= cells->shift[d];
  for (PetscInt k = first[2]; k <= last[2]; k++)
    for (PetscInt j = first[1]; j <= last[1]; j++)
      for (PetscInt i = first[0]; i <= last[0]; i++) touch[CellIndex(cells->blocks, i, j, k)] |= kind;
}

/* touch: [all] */
static PetscErrorCode SetBlocks(GasCells *cells, Cloud cloud, const PetscBool inside[], unsigned char touch[])
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(touch, cells->all));
  ForImages(cells, cloud, inside, TouchBlocks, touch);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, touch, (PetscMPIInt)cells->all, MPI_UNSIGNED_CHAR, MPI_BOR, cloud->comm));
  cells->near = 0;
  for (PetscInt b = 0; b < cells->all; b++) {
    cells->block[b] = touch[b] ? BLOCK_FULL : BLOCK_EMPTY;
    if (touch[b] <= TOUCH_FULL) continue;
    cells->home[cells->near] = b;
    cells->block[b]          = cells->near++;
  }
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

/* The cells first .. last along direction d of the blocks 'at' along it. */
static GasMask SlabMask(const GasCells *cells, PetscInt d, PetscInt at, PetscInt first, PetscInt last)
{
  const GasMask  each[DIM] = {0x1111111111111111, 0x0001000100010001, 1};
  const PetscInt origin = at << cells->shift[d], lo = PetscMax(0, first - origin),
                 hi = PetscMin((1 << cells->shift[d]) - 1, last - origin);

  return lo > hi ? 0 : Bits((PetscInt)1 << (SHIFT * d), lo, hi) * each[d];
}

/* The cells first .. last of the block (at[0], at[1], at[2]). */
static GasMask BoxMask(const GasCells *cells, const PetscInt at[DIM], const PetscInt first[DIM],
                       const PetscInt last[DIM])
{
  return SlabMask(cells, 0, at[0], first[0], last[0]) & SlabMask(cells, 1, at[1], first[1], last[1]) &
         SlabMask(cells, 2, at[2], first[2], last[2]);
}

typedef struct {
  GasMask       *wet, *close; /* [near] the cells near what is inside, and those within the support of the others */
  unsigned char *beside;      /* [all] whether a block or one beside it has cells */
} Marks;

/* context: Marks */
static void MarkCells(GasCells *cells, Cloud cloud, PetscInt a, PetscBool inside, const PetscReal x[DIM], void *context)
{
  const Marks    *marks = (const Marks *)context;
  GasMask        *mask  = inside ? marks->wet : marks->close;
  const PetscReal reach = inside ? NEAR_WET * cloud->domain->spacing : KernelSupport(cloud->kernel);
  PetscInt        first[DIM], last[DIM], from[DIM], to[DIM], at[DIM];

  if (!MayReach(cells, cloud->domain, marks->beside, x, cloud->size[a] * reach) ||
      !Range(cells, cloud->domain, x, cloud->size[a] * reach, first, last))
    return;
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
  KernelEvaluate(kernel, near->n, near->r2, near->W, near->slopes ? near->F : NULL);
  visit(cells, near, context);
  near->n = 0;
}

#define EDGE (1 << SHIFT)  /* cells of a block along a direction, */
#define SIDE (EDGE * EDGE) /* and of a layer of it */

/* The vectors from the middles of the cells of blocks 'at' of direction d to x, in units of size 1/per. */
static void Vectors(const GasCells *cells, PetscInt d, PetscInt at, PetscReal x, PetscReal per, PetscReal r[EDGE])
{
  const PetscReal from = (x - cells->lower[d] - ((at << SHIFT) + 0.5) * cells->size[d]) * per,
                  step = cells->size[d] * per;

  for (PetscInt i = 0; i < EDGE; i++) r[i] = from - i * step;
}

/* Adds the cells of a mask of a block, whose first node is 'node', that have vectors r within the support. */
static void AddBlock(GasMask mask, PetscInt node, const PetscReal volume[], PetscReal support2, PetscReal r[DIM][EDGE],
                     GasNear *near)
{
  PetscReal flat[SIDE];
  PetscInt  n = near->n;

  for (PetscInt c = 0; c < SIDE; c++) flat[c] = PetscSqr(r[0][c % EDGE]) + PetscSqr(r[1][c / EDGE]);
  for (; mask; mask &= mask - 1) {
    const unsigned  cell = (unsigned)__builtin_ctzll(mask), i = cell % EDGE, j = cell / EDGE % EDGE, k = cell / SIDE;
    const PetscReal r2 = flat[cell % SIDE] + PetscSqr(r[2][k]);

    near->node[n] = node + (PetscInt)cell;
    near->r2[n]   = r2;
    if (near->slopes) {
      near->volume[n] = volume[i];
      near->r[n][0]   = r[0][i];
      near->r[n][1]   = r[1][j];
      near->r[n][2]   = r[2][k];
    }
    n += r2 < support2;
  }
  near->n = n;
}

/* For the image of a particle at x. */
static void ForImage(const GasCells *cells, Cloud cloud, const GasSet *set, PetscInt a, const Image *image,
                     const PetscReal x[DIM], PetscReal reach, PetscBool slopes, GasVisitor visit, void *context)
{
  const PetscReal support2 = PetscSqr(KernelSupport(cloud->kernel)), per = 1 / cloud->size[a];
  const PetscInt *shift = cells->shift;
  PetscInt        first[DIM], last[DIM];
  PetscReal       r[DIM][EDGE] = {{0}};
  GasNear         near;

  if (!MayReach(cells, cloud->domain, set->beside, x, reach) || !Range(cells, cloud->domain, x, reach, first, last))
    return;
  near.n      = 0;
  near.image  = image;
  near.slopes = slopes;
  for (PetscInt k = first[2] >> shift[2]; k <= last[2] >> shift[2]; k++) {
    const GasMask layer = SlabMask(cells, 2, k, first[2], last[2]);

    if (cloud->domain->dim > 2) Vectors(cells, 2, k, x[2], per, r[2]);
    for (PetscInt j = first[1] >> shift[1]; j <= last[1] >> shift[1]; j++) {
      const GasMask row = layer & SlabMask(cells, 1, j, first[1], last[1]);

      Vectors(cells, 1, j, x[1], per, r[1]);
      for (PetscInt i = first[0] >> shift[0]; i <= last[0] >> shift[0]; i++) {
        const PetscInt block = cells->block[CellIndex(cells->blocks, i, j, k)];
        const GasMask  mask  = block < 0 ? 0 : set->mask[block] & row & SlabMask(cells, 0, i, first[0], last[0]);

        if (!mask) continue;
        if (near.n > GAS_NEAR - cells->per) Visit(cells, cloud->kernel, &near, visit, context);
        Vectors(cells, 0, i, x[0], per, r[0]);
        AddBlock(mask, block * cells->per, cells->column + (i << SHIFT), support2, r, &near);
      }
    }
  }
  Visit(cells, cloud->kernel, &near, visit, context);
}

void GasCellsNear(const GasCells *cells, Cloud cloud, const GasSet *set, PetscInt a, PetscBool slopes, GasVisitor visit,
                  void *context)
{
  const PetscReal *x     = cloud->field[FIELD_POSITION] + DIM * a;
  const PetscReal  reach = cloud->size[a] * KernelSupport(cloud->kernel);
  Image            image[IMAGES_MOST];
  PetscInt         n;

  if (Alone(cells, x, reach)) {
    ForImage(cells, cloud, set, a, &Itself, x, reach, slopes, visit, context);
    return;
  }
  n = DomainImages(cloud->domain, x, reach, image);
  for (PetscInt k = 0; k < n; k++) ForImage(cells, cloud, set, a, &image[k], image[k].x, reach, slopes, visit, context);
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

    GasCellsNear(cells, cloud, &cells->close, a, PETSC_FALSE, AddFilled, &filling);
  }
}

/* The middle of a cell, or of the first cell of an empty block. */
static void CellMiddle(const GasCells *cells, Domain domain, PetscInt node, PetscReal x[DIM])
{
  PetscInt at[DIM];

  GasCellsPlace(cells, node, at);
  for (PetscInt d = 0; d < DIM; d++) x[d] = d < domain->dim ? cells->lower[d] + (at[d] + 0.5) * cells->size[d] : 0;
}

/* Whether a cell is full by what is inside beside it. */
static PetscBool IsWet(const GasCells *cells, const GasMask wet[], PetscInt c)
{
  return (PetscBool)((wet[c / cells->per] & ~cells->close.mask[c / cells->per]) >> (c % cells->per) & 1);
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

/* Finds the CORE_... of cells that none has; the ranks of a machine share them. */
static PetscErrorCode FindCores(GasCells *cells, Cloud cloud, const GasMask wet[], PetscBool moved)
{
  unsigned char *core;

  PetscFunctionBegin;
  if (!cells->core.data) PetscCall(SharedCreate(cloud->comm, (size_t)cells->all * cells->per, &cells->core));
  core = (unsigned char *)cells->core.data;
  PetscCall(SharedFence(&cells->core));
  if (moved && cells->core.leads) PetscCall(PetscArrayzero(core, cells->all * cells->per));
  PetscCall(SharedFence(&cells->core));
  for (PetscInt c = cells->core.rank; c < cells->near * cells->per; c += cells->core.size) {
    const PetscInt at = cells->home[c / cells->per] * cells->per + c % cells->per;

    if (core[at] == CORE_UNKNOWN && !IsWet(cells, wet, c)) core[at] = CoreOf(cells, cloud, c);
  }
  PetscCall(SharedFence(&cells->core));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Cells inside a solid are full. Solids at rest are asked for each cell once. */
static PetscErrorCode FillSolids(GasCells *cells, Cloud cloud, const GasMask wet[], PetscBool moved)
{
  PetscFunctionBegin;
  if (!SceneSolidCount(cloud->scene)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(FindCores(cells, cloud, wet, moved));
  for (PetscInt c = 0; c < cells->near * cells->per; c++) {
    const unsigned char core =
      ((unsigned char *)cells->core.data)[cells->home[c / cells->per] * cells->per + c % cells->per];

    if (IsWet(cells, wet, c)) continue;
    if (core == CORE_HOLLOW || (core == CORE_DEEP && cells->filled[c] < 0.5)) cells->filled[c] = 1;
    if (core == CORE_HOLLOW) cells->close.mask[c / cells->per] &= ~((GasMask)1 << (c % cells->per));
  }
  for (PetscInt b = 0; b < cells->all; b++)
    if (cells->block[b] == BLOCK_EMPTY && CoreOf(cells, cloud, cells->near * cells->per + b) > CORE_OUTSIDE)
      cells->block[b] = BLOCK_FULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the cells that particles inside and others touch, but not those of dry blocks (touch: see FillDry) if these are
   'left' out. */
static PetscErrorCode FindMarks(GasCells *cells, Cloud cloud, const PetscBool inside[], const unsigned char touch[],
                                PetscBool left, Marks *marks)
{
  PetscFunctionBegin;
  PetscCall(PetscCalloc1(2 * cells->near, &marks->wet));
  PetscCall(PetscCalloc1(cells->all, &marks->beside));
  marks->close = marks->wet + cells->near;
  for (PetscInt b = 0; b < cells->near; b++)
    if (!left || touch[cells->home[b]] != TOUCH_WALL) AddBeside(cells, cells->home[b], marks->beside);
  ForImages(cells, cloud, inside, MarkCells, marks);
  PetscCallMPI(
    MPI_Allreduce(MPI_IN_PLACE, marks->wet, (PetscMPIInt)(2 * cells->near), MPI_UINT64_T, MPI_BOR, cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The cells of dry blocks, which nothing but dry walls of the box touches, without sums: what is in the box is empty.
 */
static void FillDry(GasCells *cells, Domain domain, const unsigned char touch[])
{
  PetscInt first[DIM] = {0, 0, 0}, last[DIM] = {0, 0, 0}, at[DIM];

  for (PetscInt d = 0; d < domain->dim; d++) {
    first[d] = (PetscInt)PetscCeilReal((domain->lower[d] - cells->lower[d]) * cells->many[d] - 0.5);
    last[d]  = (PetscInt)PetscFloorReal((domain->upper[d] - cells->lower[d]) * cells->many[d] - 0.5);
  }
  for (PetscInt b = 0; b < cells->near; b++) {
    GasMask in = 0;

    if (touch[cells->home[b]] != TOUCH_WALL) continue;
    CellCoordinates(cells->blocks, cells->home[b], at);
    in = BoxMask(cells, at, first, last);
    for (PetscInt c = 0; c < cells->per; c++) cells->filled[b * cells->per + c] = (PetscReal) !(in >> c & 1);
  }
}

PetscErrorCode GasCellsFill(GasCells *cells, Cloud cloud, Pressure pressure, PetscBool moved, PetscBool exact)
{
  PetscInt       count;
  PetscBool     *inside;
  unsigned char *touch;
  Marks          marks;

  PetscFunctionBegin;
  PetscCall(SetGrid(cells, cloud->domain));
  PetscCall(PetscMalloc2(cloud->n_owned, &inside, cells->all, &touch));
  PetscCall(FindInside(cloud, pressure, inside));
  PetscCall(SetBlocks(cells, cloud, inside, touch));
  PetscCall(Reserve(cells));
  PetscCall(FindMarks(cells, cloud, inside, touch, (PetscBool)!exact, &marks));
  count = cells->near * cells->per;
  for (PetscInt b = 0; b < cells->near; b++)
    cells->close.mask[b] = exact                                 ? marks.close[b]
                           : touch[cells->home[b]] == TOUCH_WALL ? 0
                                                                 : marks.close[b] & ~marks.wet[b];
  GasSetBeside(cells, &cells->close);
  PetscCall(PetscArrayzero(cells->filled, count));
  cells->solid_known = PETSC_FALSE;
  FillFrom(cells, cloud, 0, PressureFull(pressure), cells->filled);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, cells->filled, (PetscMPIInt)count, MPIU_REAL, MPIU_SUM, cloud->comm));
  for (PetscInt c = 0; c < count; c++)
    if (IsWet(cells, marks.wet, c)) cells->filled[c] = 1;
  if (!exact) FillDry(cells, cloud->domain, touch);
  PetscCall(FillSolids(cells, cloud, marks.wet, moved));
  PetscCall(PetscFree(marks.wet));
  PetscCall(PetscFree(marks.beside));
  PetscCall(PetscFree2(inside, touch));
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
    GasCellsNear(cells, cloud, &cells->held, a, PETSC_TRUE, AddLoad, &load);
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
  for (GasSet *const *set = (GasSet *const[]){&cells->close, &cells->seen, &cells->held, NULL}; *set; set++) {
    PetscCall(PetscFree((*set)->mask));
    PetscCall(PetscFree((*set)->beside));
  }
  PetscCall(SharedDestroy(&cells->core));
  PetscCall(PetscFree(cells->filled));
  PetscCall(PetscFree(cells->solid));
  PetscCall(PetscFree(cells->label));
  PetscCall(PetscFree(cells->owner));
  PetscFunctionReturn(PETSC_SUCCESS);
}
