/* Cells near free surfaces, and how far they are filled with liquid, walls and solids. */
#include "gas_impl.h"

#define SHIFT 3 /* a block has 2^SHIFT cells a direction */
#define MARGIN                                                                                                         \
  1.5 /* spacings that the cells reach into walls, where they are full: without them half of the part of W             \
         that dry walls have in the box is missing, and a volume is short by d0/4 per wall */
#define NEAR_WET 1.01 /* spacings around a particle inside in which a cell is full */
#define ROW_MOST 64   /* cells of a line within a support */
#define IMAGES   27

enum { TOUCH_EMPTY, TOUCH_FULL, TOUCH_NEAR };
enum { MARK_WET = 1, MARK_CLOSE = 2 };

/* Maps of particles to their images: x' = sign x + offset. */
typedef struct {
  PetscReal sign[DIM], offset[DIM];
} Image;

/* The images of a particle at x that are within 'reach' (m) of the box, itself first. Returns their number. */
static PetscInt Images(Domain domain, const PetscReal x[DIM], PetscReal reach, Image image[IMAGES])
{
  PetscInt n = 1;

  image[0] = (Image){{1, 1, 1}, {0, 0, 0}};
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

static void Map(const Image *image, const PetscReal x[DIM], PetscReal y[DIM])
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
    cells->shift[d]  = d < domain->dim ? SHIFT : 0;
    cells->blocks[d] = (cells->n[d] + (1 << cells->shift[d]) - 1) >> cells->shift[d];
    cells->all *= cells->blocks[d];
    cells->per <<= cells->shift[d];
    if (d < domain->dim) cells->volume *= cells->size[d];
  }
  PetscCall(PetscMalloc1(cells->all, &cells->block));
  PetscCall(PetscMalloc1(cells->all, &cells->home));
  PetscCall(PetscMalloc1(cells->all, &cells->held));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool GasCellsRange(const GasCells *cells, Domain domain, const PetscReal x[DIM], PetscReal reach,
                        PetscInt first[DIM], PetscInt last[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) {
    first[d] = last[d] = 0;
    if (d >= domain->dim) continue;
    first[d] = (PetscInt)PetscMax(0, PetscCeilReal((x[d] - reach - cells->lower[d]) / cells->size[d] - 0.5));
    last[d] =
      (PetscInt)PetscMin(cells->n[d] - 1., PetscFloorReal((x[d] + reach - cells->lower[d]) / cells->size[d] - 0.5));
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

PetscReal GasCellsVolume(const GasCells *cells, Domain domain, PetscInt i)
{
  const PetscReal x[DIM] = {cells->lower[0] + (i + 0.5) * cells->size[0], 0, 0};

  return cells->volume * DomainPairLength(domain, x, x);
}

/* Whether a particle is inside liquid, so that what is next to it is full. */
static PetscBool IsInside(Cloud cloud, Pressure pressure, PetscInt a)
{
  return (PetscBool)(a < cloud->n_fluid && !PressureCloses(pressure, a));
}

/* Calls 'visit' for the images of the owned particles from 'first' on. inside: NULL: none is. */
typedef void (*Visitor)(GasCells *cells, Cloud cloud, PetscInt a, PetscBool inside, const Image *image,
                        const PetscReal x[DIM], void *context);

static void ForImages(GasCells *cells, Cloud cloud, PetscInt first, const PetscBool inside[], Visitor visit,
                      void *context)
{
  for (PetscInt a = first; a < cloud->n_owned; a++) {
    const PetscReal *x     = cloud->field[FIELD_POSITION] + DIM * a;
    const PetscReal  reach = cloud->size[a] * KernelSupport(cloud->kernel);
    Image            image[IMAGES];
    const PetscInt   n = Images(cloud->domain, x, reach, image);

    for (PetscInt k = 0; k < n; k++) {
      PetscReal y[DIM];

      Map(&image[k], x, y);
      visit(cells, cloud, a, (PetscBool)(inside && inside[a]), &image[k], y, context);
    }
  }
}

/* The blocks that a particle touches; context: [all] TOUCH_... */
static void TouchBlocks(GasCells *cells, Cloud cloud, PetscInt a, PetscBool inside, const Image *image,
                        const PetscReal x[DIM], void *context)
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
  ForImages(cells, cloud, 0, inside, TouchBlocks, touch);
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
  PetscCall(PetscFree(cells->mark));
  PetscCall(PetscFree(cells->filled));
  PetscCall(PetscFree(cells->solid));
  PetscCall(PetscFree(cells->label));
  PetscCall(PetscFree(cells->owner));
  PetscCall(PetscMalloc1(cells->capacity, &cells->mark));
  PetscCall(PetscMalloc1(cells->capacity, &cells->filled));
  PetscCall(PetscMalloc1(cells->capacity, &cells->solid));
  PetscCall(PetscMalloc1(cells->capacity, &cells->label));
  PetscCall(PetscMalloc1(cells->capacity, &cells->owner));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether one of the cells first .. last is in a block with cells; owned: with cells of pockets. */
static PetscBool Reaches(const GasCells *cells, PetscBool owned, const PetscInt first[DIM], const PetscInt last[DIM])
{
  const PetscInt *s = cells->shift;

  for (PetscInt k = first[2] >> s[2]; k <= last[2] >> s[2]; k++)
    for (PetscInt j = first[1] >> s[1]; j <= last[1] >> s[1]; j++)
      for (PetscInt i = first[0] >> s[0]; i <= last[0] >> s[0]; i++) {
        const PetscInt block = cells->block[CellIndex(cells->blocks, i, j, k)];

        if (block >= 0 && (!owned || cells->held[block])) return PETSC_TRUE;
      }
  return PETSC_FALSE;
}

static void MarkCells(GasCells *cells, Cloud cloud, PetscInt a, PetscBool inside, const Image *image,
                      const PetscReal x[DIM], void *context)
{
  const PetscInt      end   = cells->near * cells->per;
  const PetscReal     reach = inside ? NEAR_WET * cloud->domain->spacing : KernelSupport(cloud->kernel);
  const unsigned char mark  = inside ? MARK_WET : MARK_CLOSE;
  PetscInt            first[DIM], last[DIM];

  if (!GasCellsRange(cells, cloud->domain, x, cloud->size[a] * reach, first, last) ||
      !Reaches(cells, PETSC_FALSE, first, last))
    return;
  for (PetscInt k = first[2]; k <= last[2]; k++)
    for (PetscInt j = first[1]; j <= last[1]; j++)
      for (PetscInt i = first[0]; i <= last[0]; i++) {
        const PetscInt node = GasCellsNode(cells, i, j, k);

        if (node >= 0 && node < end) cells->mark[node] |= mark;
      }
}

/* Cells of a line of them within the support of a particle, with the vector from their middles to it in units of its
   size: r[0] of each, the rest of all. */
typedef struct {
  PetscInt  n, node[ROW_MOST];
  PetscReal r[ROW_MOST], rest[DIM], r2[ROW_MOST], W[ROW_MOST], F[ROW_MOST];
} Line;

/* Finds the cells first .. last of the line (j, k); owned: those of pockets. */
static void LineSet(const GasCells *cells, Cloud cloud, PetscBool owned, const PetscReal x[DIM], PetscReal size,
                    const PetscInt first[DIM], const PetscInt last[DIM], PetscInt j, PetscInt k, Line *line)
{
  const PetscReal support2 = PetscSqr(KernelSupport(cloud->kernel));
  const PetscInt *s = cells->shift, at[DIM] = {0, j, k},
                 *block = cells->block + ((k >> s[2]) * cells->blocks[1] + (j >> s[1])) * cells->blocks[0],
                 inside = (((k & ((1 << s[2]) - 1)) << s[1]) + (j & ((1 << s[1]) - 1))) << s[0];
  PetscReal aside2;

  line->n       = 0;
  line->rest[0] = line->rest[1] = line->rest[2] = 0;
  for (PetscInt d = 1; d < cloud->domain->dim; d++)
    line->rest[d] = (x[d] - cells->lower[d] - (at[d] + 0.5) * cells->size[d]) / size;
  aside2 = Dot(line->rest, line->rest);
  for (PetscInt i = first[0]; i <= last[0] && line->n < ROW_MOST && aside2 < support2; i++) {
    const PetscInt  near = block[i >> s[0]], node = near * cells->per + inside + (i & ((1 << s[0]) - 1));
    const PetscReal r = (x[0] - cells->lower[0] - (i + 0.5) * cells->size[0]) / size;

    if (near < 0 || !(cells->mark[node] & MARK_CLOSE) || (owned && cells->owner[node] <= 0) ||
        aside2 + r * r >= support2)
      continue;
    line->node[line->n] = node;
    line->r[line->n]    = r;
    line->r2[line->n++] = aside2 + r * r;
  }
}

/* Calls 'add' for each line of cells within the support of a particle, owned: of pockets, whose image is at x, with W
 * and F there. */
typedef void (*LineVisitor)(GasCells *cells, Cloud cloud, const Line *line, void *context);

static void ForLines(GasCells *cells, Cloud cloud, PetscBool owned, PetscInt a, const PetscReal x[DIM], LineVisitor add,
                     void *context)
{
  const PetscReal size = cloud->size[a];
  PetscInt        first[DIM], last[DIM];
  Line            line;

  if (!GasCellsRange(cells, cloud->domain, x, size * KernelSupport(cloud->kernel), first, last) ||
      !Reaches(cells, owned, first, last))
    return;
  for (PetscInt k = first[2]; k <= last[2]; k++)
    for (PetscInt j = first[1]; j <= last[1]; j++) {
      LineSet(cells, cloud, owned, x, size, first, last, j, k, &line);
      if (!line.n) continue;
      KernelEvaluate(cloud->kernel, line.n, line.r2, line.W, line.F);
      add(cells, cloud, &line, context);
    }
}

/* Where a particle's sums go, and its volume of GasPart. */
typedef struct {
  PetscReal *sum, part;
} Filling;

static void AddFilled(GasCells *cells, Cloud cloud, const Line *line, void *context)
{
  const Filling *filling = (const Filling *)context;

  for (PetscInt m = 0; m < line->n; m++) filling->sum[line->node[m]] += filling->part * line->W[m];
}

/* The context of FillCells; full: sum V W on a full lattice. */
typedef struct {
  PetscReal full, *sum;
} Fill;

static void FillCells(GasCells *cells, Cloud cloud, PetscInt a, PetscBool inside, const Image *image,
                      const PetscReal x[DIM], void *context)
{
  const Fill *fill    = (const Fill *)context;
  Filling     filling = {fill->sum, GasPart(cloud, a, fill->full)};

  ForLines(cells, cloud, PETSC_FALSE, a, x, AddFilled, &filling);
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
static PetscErrorCode FillSolids(GasCells *cells, Cloud cloud, PetscBool moved)
{
  PetscFunctionBegin;
  if (!SceneSolidCount(cloud->scene)) PetscFunctionReturn(PETSC_SUCCESS);
  if (!cells->core) PetscCall(PetscCalloc1(cells->all * cells->per, &cells->core));
  if (moved) PetscCall(PetscArrayzero(cells->core, cells->all * cells->per));
  for (PetscInt c = 0; c < cells->near * cells->per; c++) {
    unsigned char *core = &cells->core[cells->home[c / cells->per] * cells->per + c % cells->per];

    if (cells->mark[c] == MARK_WET) continue;
    if (*core == CORE_UNKNOWN) *core = CoreOf(cells, cloud, c);
    if (*core == CORE_HOLLOW || (*core == CORE_DEEP && cells->filled[c] < 0.5)) cells->filled[c] = 1;
    if (*core == CORE_HOLLOW) cells->mark[c] = MARK_WET;
  }
  for (PetscInt b = 0; b < cells->all; b++)
    if (cells->block[b] == BLOCK_EMPTY && CoreOf(cells, cloud, cells->near * cells->per + b) > CORE_OUTSIDE)
      cells->block[b] = BLOCK_FULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GasCellsFill(GasCells *cells, Cloud cloud, Pressure pressure, PetscBool moved)
{
  Fill       fill = {.full = PressureFull(pressure)};
  PetscInt   count;
  PetscBool *inside;

  PetscFunctionBegin;
  PetscCall(SetGrid(cells, cloud->domain));
  PetscCall(PetscMalloc1(cloud->n_owned, &inside));
  for (PetscInt a = 0; a < cloud->n_owned; a++) inside[a] = IsInside(cloud, pressure, a);
  PetscCall(SetBlocks(cells, cloud, inside));
  PetscCall(Reserve(cells));
  count = cells->near * cells->per;
  PetscCall(PetscArrayzero(cells->mark, count));
  ForImages(cells, cloud, 0, inside, MarkCells, NULL);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, cells->mark, (PetscMPIInt)count, MPI_UNSIGNED_CHAR, MPI_BOR, cloud->comm));
  PetscCall(PetscArrayzero(cells->filled, count));
  fill.sum           = cells->filled;
  cells->solid_known = PETSC_FALSE;
  ForImages(cells, cloud, 0, inside, FillCells, &fill);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, cells->filled, (PetscMPIInt)count, MPIU_REAL, MPIU_SUM, cloud->comm));
  for (PetscInt c = 0; c < count; c++)
    if (cells->mark[c] == MARK_WET) cells->filled[c] = 1;
  PetscCall(FillSolids(cells, cloud, moved));
  PetscCall(PetscFree(inside));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GasCellsSolid(GasCells *cells, Cloud cloud, PetscReal full)
{
  const PetscInt count = cells->near * cells->per;
  Fill           fill  = {full, cells->solid};

  PetscFunctionBegin;
  if (cells->solid_known) PetscFunctionReturn(PETSC_SUCCESS);
  cells->solid_known = PETSC_TRUE;
  PetscCall(PetscArrayzero(cells->solid, count));
  ForImages(cells, cloud, cloud->n_fluid, NULL, FillCells, &fill);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, cells->solid, (PetscMPIInt)count, MPIU_REAL, MPIU_SUM, cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The velocities of two states, and the rates that they give the volumes; what a particle adds to them. */
typedef struct {
  PetscReal        full;
  const PetscReal *v[2];
  PetscReal       *rate[2];
  PetscReal        part, size, lengthening[2], u[2][DIM];
  PetscBool        solid;
} Flux;

/* The weight of the part of a solid, s: behind its dummy particles, a solid is hollow. In front of what is dry as well
   as of what is wet, the weighted grad s integrates to what grad s does if the solid is full. */
static PetscReal SolidWeight(PetscReal s)
{
  return 6 * s * (1 - s);
}

static void AddRates(GasCells *cells, Cloud cloud, const Line *line, void *context)
{
  const Flux *flux = (const Flux *)context;

  for (PetscInt m = 0; m < line->n; m++) {
    const PetscInt owner = cells->owner[line->node[m]];
    PetscInt       at[DIM];
    PetscReal      volume;

    GasCellsPlace(cells, line->node[m], at);
    volume = flux->part * GasCellsVolume(cells, cloud->domain, at[0]);
    if (flux->solid) volume *= SolidWeight(cells->solid[line->node[m]]);
    for (PetscInt s = 0; s < 2; s++) /* a longer ring has a smaller area */
      flux->rate[s][owner] -=
        volume * (line->F[m] * (line->r[m] * flux->u[s][0] + Dot(line->rest, flux->u[s])) / flux->size -
                  line->W[m] * flux->lengthening[s]);
  }
}

static void FluxOf(GasCells *cells, Cloud cloud, PetscInt a, PetscBool inside, const Image *image,
                   const PetscReal x[DIM], void *context)
{
  Flux *flux = (Flux *)context;

  flux->part  = GasPart(cloud, a, flux->full);
  flux->size  = cloud->size[a];
  flux->solid = (PetscBool)(cells->solid_known && cloud->integer[INT_BODY][a] <= BODY_SOLID);
  for (PetscInt s = 0; s < 2; s++) {
    for (PetscInt d = 0; d < DIM; d++) flux->u[s][d] = image->sign[d] * flux->v[s][DIM * a + d];
    flux->lengthening[s] = DomainLengthening(cloud->domain, x, flux->u[s]);
  }
  if (Dot(flux->u[0], flux->u[0]) + Dot(flux->u[1], flux->u[1]) > 0)
    ForLines(cells, cloud, PETSC_TRUE, a, x, AddRates, flux);
}

PetscErrorCode GasCellsRates(GasCells *cells, Cloud cloud, PetscReal full, PetscInt count, const PetscReal v[],
                             const PetscReal w[], PetscReal rate_v[], PetscReal rate_w[])
{
  Flux flux = {.full = full, .v = {v, w}, .rate = {rate_v, rate_w}};

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(rate_v, count + 1));
  PetscCall(PetscArrayzero(rate_w, count + 1));
  ForImages(cells, cloud, 0, NULL, FluxOf, &flux);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, rate_v, (PetscMPIInt)count + 1, MPIU_REAL, MPIU_SUM, cloud->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, rate_w, (PetscMPIInt)count + 1, MPIU_REAL, MPIU_SUM, cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The forces on a dummy particle by the regions around it. */
typedef struct {
  PetscReal part, size;
  PetscInt  count, owner[GAS_SHARE];
  PetscReal unit[GAS_SHARE][DIM];
} Load;

static void AddLoad(GasCells *cells, Cloud cloud, const Line *line, void *context)
{
  Load *load = (Load *)context;

  for (PetscInt m = 0; m < line->n; m++) {
    const PetscInt owner = cells->owner[line->node[m]];
    PetscInt       at[DIM], k = 0;
    PetscReal      scale;

    while (k < load->count && load->owner[k] != owner) k++;
    if (k == GAS_SHARE) continue;
    if (k == load->count) load->owner[load->count++] = owner;
    GasCellsPlace(cells, line->node[m], at);
    scale = -6 * cells->solid[line->node[m]] * (1 - cells->filled[line->node[m]]) * load->part *
            GasCellsVolume(cells, cloud->domain, at[0]) * line->F[m] / load->size;
    load->unit[k][0] += scale * line->r[m];
    for (PetscInt d = 1; d < DIM; d++) load->unit[k][d] += scale * line->rest[d];
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

static PetscErrorCode ListLoads(Domain domain, PetscInt a, PetscInt body, const PetscReal x[DIM], const Image *image,
                                const Load *load, GasLoads *loads)
{
  PetscFunctionBegin;
  if (loads->count + load->count > loads->capacity) {
    loads->capacity = 2 * loads->capacity + 1024;
    PetscCall(PetscRealloc((size_t)loads->capacity * sizeof(GasLoad), &loads->load));
  }
  for (PetscInt k = 0; k < load->count; k++) {
    GasLoad *to = &loads->load[loads->count++];

    *to = (GasLoad){.dummy = a, .pocket = load->owner[k]};
    for (PetscInt d = 0; d < DIM; d++) to->unit[d] = Bears(domain, body, x, d) ? image->sign[d] * load->unit[k][d] : 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GasCellsLoads(GasCells *cells, Cloud cloud, PetscReal full, GasLoads *loads)
{
  PetscFunctionBegin;
  loads->count = 0;
  PetscCall(GasCellsSolid(cells, cloud, full));
  for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++) {
    const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a;
    Image            image[IMAGES];
    const PetscInt   n = Images(cloud->domain, x, cloud->size[a] * KernelSupport(cloud->kernel), image);

    for (PetscInt i = 0; i < n && cloud->integer[INT_LAYER][a]; i++) {
      Load      load = {.part = GasPart(cloud, a, full), .size = cloud->size[a]};
      PetscReal y[DIM];

      Map(&image[i], x, y);
      ForLines(cells, cloud, PETSC_TRUE, a, y, AddLoad, &load);
      PetscCall(ListLoads(cloud->domain, a, cloud->integer[INT_BODY][a], x, &image[i], &load, loads));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GasCellsDestroy(GasCells *cells)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(cells->block));
  PetscCall(PetscFree(cells->home));
  PetscCall(PetscFree(cells->held));
  PetscCall(PetscFree(cells->core));
  PetscCall(PetscFree(cells->mark));
  PetscCall(PetscFree(cells->filled));
  PetscCall(PetscFree(cells->solid));
  PetscCall(PetscFree(cells->label));
  PetscCall(PetscFree(cells->owner));
  PetscFunctionReturn(PETSC_SUCCESS);
}
