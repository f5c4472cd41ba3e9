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

/* Lays the arrays of blocks; solids: the scene has some. */
static PetscErrorCode ShareBlocks(GasCells *cells, MPI_Comm comm, PetscBool solids)
{
  const PetscInt    all      = cells->all;
  const SharedArray arrays[] = {{&cells->block, all, sizeof(PetscInt)},
                                {&cells->home, all, sizeof(PetscInt)},
                                {&cells->close.mask, all, sizeof(GasMask)},
                                {&cells->seen.mask, all, sizeof(GasMask)},
                                {&cells->held.mask, all, sizeof(GasMask)},
                                {&cells->wet.mask, all, sizeof(GasMask)},
                                {&cells->close.beside, all, 1},
                                {&cells->seen.beside, all, 1},
                                {&cells->held.beside, all, 1},
                                {&cells->wet.beside, all, 1},
                                {&cells->touch, all, 1},
                                {&cells->core, solids ? all * cells->per : 0, 1}};

  PetscFunctionBegin;
  PetscCall(SharedCreate(comm, PETSC_STATIC_ARRAY_LENGTH(arrays), arrays, &cells->of_blocks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes room for the nodes. */
static PetscErrorCode ShareNodes(GasCells *cells, MPI_Comm comm)
{
  const PetscInt    nodes = cells->near * cells->per + cells->all, room = nodes + nodes / 4;
  const SharedArray arrays[] = {{&cells->sum, room, sizeof(PetscInt64)},
                                {&cells->filled, room, sizeof(PetscReal)},
                                {&cells->solid, room, sizeof(PetscReal)},
                                {&cells->label, room, sizeof(PetscInt)},
                                {&cells->owner, room, sizeof(PetscInt)}};

  PetscFunctionBegin;
  if (nodes <= cells->capacity) PetscFunctionReturn(PETSC_SUCCESS);
  cells->capacity = room;
  PetscCall(SharedDestroy(&cells->of_nodes));
  PetscCall(SharedCreate(comm, PETSC_STATIC_ARRAY_LENGTH(arrays), arrays, &cells->of_nodes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetGrid(GasCells *cells, Domain domain, PetscBool solids)
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
  PetscCall(ShareBlocks(cells, domain->comm, solids));
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
  do SharedOr(&beside[CellIndex(cells->blocks, at[0], at[1], at[2])], 1);
  while (CellNext(from, to, at));
}

/* Forgets which blocks are beside those of a set. Returns the blocks with cells first .. end - 1 that are this rank's.
 */
static PetscErrorCode ClearBeside(const GasCells *cells, GasSet *set, PetscInt *first, PetscInt *end)
{
  PetscFunctionBegin;
  SharedSlice(&cells->of_blocks, cells->all, first, end);
  PetscCall(PetscArrayzero(set->beside + *first, *end - *first));
  PetscCall(SharedFence(&cells->of_blocks));
  SharedSlice(&cells->of_blocks, cells->near, first, end);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GasSetBeside(const GasCells *cells, GasSet *set)
{
  PetscInt first, end;

  PetscFunctionBegin;
  PetscCall(ClearBeside(cells, set, &first, &end));
  for (PetscInt b = first; b < end; b++)
    if (set->mask[b]) AddBeside(cells, cells->home[b], set->beside);
  PetscCall(SharedFence(&cells->of_blocks));
  PetscFunctionReturn(PETSC_SUCCESS);
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
typedef void (*Visitor)(GasCells *cells, Cloud cloud, PetscInt a, PetscBool inside, const PetscReal x[DIM]);

static void ForImages(GasCells *cells, Cloud cloud, const PetscBool inside[], Visitor visit)
{
  const PetscReal support = KernelSupport(cloud->kernel);

  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a;
    Image            image[IMAGES_MOST];
    PetscInt         n;

    if (Alone(cells, x, cloud->size[a] * support)) {
      visit(cells, cloud, a, inside[a], x);
      continue;
    }
    n = DomainImages(cloud->domain, x, cloud->size[a] * support, image);
    for (PetscInt k = 0; k < n; k++) visit(cells, cloud, a, inside[a], image[k].x);
  }
}

/* Tells the blocks that a particle touches what it is: inside, a particle of a wall of the box, or another. */
static void TouchBlocks(GasCells *cells, Cloud cloud, PetscInt a, PetscBool inside, const PetscReal x[DIM])
{
  const Domain        domain = cloud->domain;
  const unsigned char kind   = inside ? TOUCH_FULL : cloud->integer[INT_BODY][a] == BODY_WALL ? TOUCH_WALL : TOUCH_NEAR;
  PetscInt            first[DIM], last[DIM];

  if (!Range(cells, domain, x, cloud->size[a] * (inside ? domain->spacing : KernelSupport(cloud->kernel)), first, last))
    return;
  for (PetscInt d = 0; d < DIM; d++) first[d] >>= cells->shift[d], last[d] >>= cells->shift[d];
  for (PetscInt k = first[2]; k <= last[2]; k++)
    for (PetscInt j = first[1]; j <= last[1]; j++)
      for (PetscInt i = first[0]; i <= last[0]; i++) SharedOr(&cells->touch[CellIndex(cells->blocks, i, j, k)], kind);
}

static PetscErrorCode SetBlocks(GasCells *cells, Cloud cloud, const PetscBool inside[])
{
  PetscInt first, end, near = 0, before;

  PetscFunctionBegin;
  SharedSlice(&cells->of_blocks, cells->all, &first, &end);
  PetscCall(SharedFence(&cells->of_blocks)); /* no rank reads these cells any more */
  PetscCall(PetscArrayzero(cells->touch + first, end - first));
  PetscCall(SharedFence(&cells->of_blocks));
  ForImages(cells, cloud, inside, TouchBlocks);
  PetscCall(SharedReduce(&cells->of_blocks, cells->touch, cells->all, MPI_UNSIGNED_CHAR, MPI_BOR));
  for (PetscInt b = first; b < end; b++) near += cells->touch[b] > TOUCH_FULL;
  PetscCall(SharedCount(&cells->of_blocks, near, &before, &cells->near));
  for (PetscInt b = first; b < end; b++) {
    cells->block[b] = cells->touch[b] ? BLOCK_FULL : BLOCK_EMPTY;
    if (cells->touch[b] <= TOUCH_FULL) continue;
    cells->home[before] = b;
    cells->block[b]     = before++;
  }
  PetscCall(SharedFence(&cells->of_blocks));
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

/* Marks the cells near a particle inside as wet, and those within the support of another as close. */
static void MarkCells(GasCells *cells, Cloud cloud, PetscInt a, PetscBool inside, const PetscReal x[DIM])
{
  GasMask        *mask  = inside ? cells->wet.mask : cells->close.mask;
  const PetscReal reach = inside ? NEAR_WET * cloud->domain->spacing : KernelSupport(cloud->kernel);
  PetscInt        first[DIM], last[DIM], from[DIM], to[DIM], at[DIM];

  if (!MayReach(cells, cloud->domain, cells->wet.beside, x, cloud->size[a] * reach) ||
      !Range(cells, cloud->domain, x, cloud->size[a] * reach, first, last))
    return;
  for (PetscInt d = 0; d < DIM; d++) {
    at[d] = from[d] = first[d] >> cells->shift[d];
    to[d]           = last[d] >> cells->shift[d];
  }
  do {
    const PetscInt block = cells->block[CellIndex(cells->blocks, at[0], at[1], at[2])];

    if (block >= 0) SharedOr(&mask[block], BoxMask(cells, at, first, last));
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

/* Adds a particle of this volume (GasPart) to the sums of cells. */
static void AddFilled(const GasCells *cells, const GasNear *near, void *context)
{
  const PetscReal part = *(const PetscReal *)context;

  for (PetscInt m = 0; m < near->n; m++) SharedAdd(&cells->of_nodes, &cells->sum[near->node[m]], part * near->W[m]);
}

/* The sums of the particles from 'start' on at the cells, [near][per]; full: sum V W on a full lattice. */
static PetscErrorCode FillFrom(GasCells *cells, Cloud cloud, PetscInt start, PetscReal full, PetscReal value[])
{
  const PetscInt count = cells->near * cells->per;
  PetscInt       first, end;

  PetscFunctionBegin;
  SharedSlice(&cells->of_nodes, count, &first, &end);
  PetscCall(PetscArrayzero(cells->sum + first, end - first));
  PetscCall(SharedFence(&cells->of_nodes));
  for (PetscInt a = start; a < cloud->n_owned; a++) {
    PetscReal part = GasPart(cloud, a, full);

    GasCellsNear(cells, cloud, &cells->close, a, PETSC_FALSE, AddFilled, &part);
  }
  PetscCall(SharedReduce(&cells->of_nodes, cells->sum, count, MPI_INT64_T, MPI_SUM));
  for (PetscInt c = first; c < end; c++) value[c] = (PetscReal)cells->sum[c] * SHARED_UNIT;
  PetscCall(SharedFence(&cells->of_nodes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The middle of a cell, or of the first cell of an empty block. */
static void CellMiddle(const GasCells *cells, Domain domain, PetscInt node, PetscReal x[DIM])
{
  PetscInt at[DIM];

  GasCellsPlace(cells, node, at);
  for (PetscInt d = 0; d < DIM; d++) x[d] = d < domain->dim ? cells->lower[d] + (at[d] + 0.5) * cells->size[d] : 0;
}

/* Whether a cell is full by what is inside beside it. */
static PetscBool IsWet(const GasCells *cells, PetscInt c)
{
  return (PetscBool)((cells->wet.mask[c / cells->per] & ~cells->close.mask[c / cells->per]) >> (c % cells->per) & 1);
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

/* Cells inside a solid are full. Solids at rest are asked for each cell once. first .. end - 1: the blocks with cells
   of this rank. */
static PetscErrorCode FillSolids(GasCells *cells, Cloud cloud, PetscBool moved, PetscInt first, PetscInt end)
{
  PetscInt from, to;

  PetscFunctionBegin;
  if (!SceneSolidCount(cloud->scene)) PetscFunctionReturn(PETSC_SUCCESS);
  SharedSlice(&cells->of_blocks, cells->all, &from, &to);
  if (moved) PetscCall(PetscArrayzero(cells->core + from * cells->per, (to - from) * cells->per));
  for (PetscInt b = from; b < to; b++)
    if (cells->block[b] == BLOCK_EMPTY && CoreOf(cells, cloud, cells->near * cells->per + b) > CORE_OUTSIDE)
      cells->block[b] = BLOCK_FULL;
  PetscCall(SharedFence(&cells->of_blocks));
  for (PetscInt c = first * cells->per; c < end * cells->per; c++) {
    unsigned char *core = &cells->core[cells->home[c / cells->per] * cells->per + c % cells->per];

    if (IsWet(cells, c)) continue;
    if (*core == CORE_UNKNOWN) *core = CoreOf(cells, cloud, c);
    if (*core == CORE_HOLLOW || (*core == CORE_DEEP && cells->filled[c] < 0.5)) cells->filled[c] = 1;
    if (*core == CORE_HOLLOW) cells->close.mask[c / cells->per] &= ~((GasMask)1 << (c % cells->per));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether nothing but dry walls of the box touches a block with cells. */
static PetscBool IsDry(const GasCells *cells, PetscInt b)
{
  return (PetscBool)(cells->touch[cells->home[b]] == TOUCH_WALL);
}

/* Finds the cells that particles inside and others touch; unless exact, not those of dry blocks, and of those beside
   particles inside none to sum over. */
static PetscErrorCode FindMarks(GasCells *cells, Cloud cloud, const PetscBool inside[], PetscBool exact)
{
  PetscInt first, end;

  PetscFunctionBegin;
  PetscCall(ClearBeside(cells, &cells->wet, &first, &end));
  for (PetscInt b = first; b < end; b++) {
    cells->wet.mask[b] = cells->close.mask[b] = 0;
    if (exact || !IsDry(cells, b)) AddBeside(cells, cells->home[b], cells->wet.beside);
  }
  PetscCall(SharedFence(&cells->of_blocks));
  ForImages(cells, cloud, inside, MarkCells);
  PetscCall(SharedReduce(&cells->of_blocks, cells->wet.mask, cells->near, MPI_UINT64_T, MPI_BOR));
  PetscCall(SharedReduce(&cells->of_blocks, cells->close.mask, cells->near, MPI_UINT64_T, MPI_BOR));
  for (PetscInt b = first; b < end && !exact; b++)
    cells->close.mask[b] = IsDry(cells, b) ? 0 : cells->close.mask[b] & ~cells->wet.mask[b];
  PetscCall(GasSetBeside(cells, &cells->close));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The cells of dry blocks, without sums: what is in the box is empty. first .. end - 1: the blocks of this rank. */
static void FillDry(GasCells *cells, Domain domain, PetscInt first, PetscInt end)
{
  PetscInt from[DIM] = {0, 0, 0}, to[DIM] = {0, 0, 0}, at[DIM];

  for (PetscInt d = 0; d < domain->dim; d++) {
    from[d] = (PetscInt)PetscCeilReal((domain->lower[d] - cells->lower[d]) * cells->many[d] - 0.5);
    to[d]   = (PetscInt)PetscFloorReal((domain->upper[d] - cells->lower[d]) * cells->many[d] - 0.5);
  }
  for (PetscInt b = first; b < end; b++) {
    GasMask in = 0;

    if (!IsDry(cells, b)) continue;
    CellCoordinates(cells->blocks, cells->home[b], at);
    in = BoxMask(cells, at, from, to);
    for (PetscInt c = 0; c < cells->per; c++) cells->filled[b * cells->per + c] = (PetscReal) !(in >> c & 1);
  }
}

PetscErrorCode GasCellsFill(GasCells *cells, Cloud cloud, Pressure pressure, PetscBool moved, PetscBool exact)
{
  PetscInt   first, end;
  PetscBool *inside;

  PetscFunctionBegin;
  PetscCall(SetGrid(cells, cloud->domain, (PetscBool)(SceneSolidCount(cloud->scene) > 0)));
  PetscCall(PetscMalloc1(cloud->n_owned, &inside));
  PetscCall(FindInside(cloud, pressure, inside));
  PetscCall(SetBlocks(cells, cloud, inside));
  PetscCall(ShareNodes(cells, cloud->comm));
  PetscCall(FindMarks(cells, cloud, inside, exact));
  PetscCall(PetscFree(inside));
  cells->solid_known = PETSC_FALSE;
  PetscCall(FillFrom(cells, cloud, 0, PressureFull(pressure), cells->filled));
  SharedSlice(&cells->of_blocks, cells->near, &first, &end);
  for (PetscInt c = first * cells->per; c < end * cells->per; c++)
    if (IsWet(cells, c)) cells->filled[c] = 1;
  if (!exact) FillDry(cells, cloud->domain, first, end);
  PetscCall(FillSolids(cells, cloud, moved, first, end));
  PetscCall(SharedFence(&cells->of_blocks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GasCellsSolid(GasCells *cells, Cloud cloud, PetscReal full)
{
  PetscFunctionBegin;
  if (!cells->solid_known) PetscCall(FillFrom(cells, cloud, cloud->n_fluid, full, cells->solid));
  cells->solid_known = PETSC_TRUE;
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
  for (PetscInt k = 0; k < load->count; k++) {
    GasLoad *to;

    PetscCall(ListGrow(loads->count, &loads->capacity, sizeof(*to), &loads->load));
    to  = &loads->load[loads->count++];
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
  PetscCall(SharedDestroy(&cells->of_blocks));
  PetscCall(SharedDestroy(&cells->of_nodes));
  PetscFunctionReturn(PETSC_SUCCESS);
}
