/* Regions without liquid: the open air, from which a way leads to an open face of the box; pockets of gas; voids, which
   have neither: pockets of no amount, to whose constant volume 0 couple.c takes them. A region that closes keeps the
   air in it; what opens between liquid is a void, and so is a region that is too small.

   Regions and cells are kept while nothing beside a pocket has moved by SKIN: rows and fluxes are those of the present
   positions, and the volumes follow their flux. A breathing bubble then has the volumes and pressures of cells that
   are filled anew in each step within 0.3 % of their swing, with a tenth of the relaxation time within 1.1 %. */
#include "gas_impl.h"

#define FILLED   0.5 /* cells that are filled by less are empty */
#define SMALLEST 4   /* cells of a new pocket, at least */
#define JUMP     0.3 /* of liquid that emitters bring: a volume that shrinks by more at once has it */
#define SKIN     0.1 /* spacings that what is beside pockets moves before cells are filled anew */
#define REACH    3   /* cells around a region in which what is not filled is the region's */

/* The regions while they are found: how many cells they have, the faces of the box that they touch, a bit for each, and
   their labels, GAS_AIR, GAS_VOID, or the number of a pocket. */
typedef struct {
  PetscInt  count;
  PetscInt *cells, *faces, *label; /* [count] */
} Regions;

typedef void (*NodeVisitor)(const GasCells *cells, PetscInt node, void *context);

static PetscBool IsEmpty(const GasCells *cells, PetscInt node)
{
  return (PetscBool)(node >= cells->near * cells->per || cells->filled[node] < FILLED);
}

/* The node of a cell, which may be beyond a face in direction d; negative: there is none. */
static PetscInt Beyond(const GasCells *cells, Domain domain, PetscInt d, const PetscInt at[DIM])
{
  PetscInt place[DIM] = {at[0], at[1], at[2]};

  if (place[d] < 0 || place[d] >= cells->n[d]) {
    if (domain->face[d][0] != FACE_PERIODIC) return -1;
    place[d] = (place[d] + cells->n[d]) % cells->n[d];
  }
  return GasCellsNode(cells, place[0], place[1], place[2]);
}

/* The cells first .. last of a node. Returns whether it is a cell of the grid or an empty block: the last block along a
   direction may reach beyond the grid. */
static PetscBool NodeRange(const GasCells *cells, PetscInt node, PetscInt first[DIM], PetscInt last[DIM])
{
  const PetscBool cell = (PetscBool)(node < cells->near * cells->per);

  GasCellsPlace(cells, node, first);
  for (PetscInt d = 0; d < DIM; d++)
    last[d] = cell ? first[d] : PetscMin(cells->n[d], first[d] + (1 << cells->shift[d])) - 1;
  return (PetscBool)(cell ? first[0] < cells->n[0] && first[1] < cells->n[1] && first[2] < cells->n[2]
                          : cells->block[node - cells->near * cells->per] == BLOCK_EMPTY);
}

/* Visits the nodes beside a node. */
static void ForNeighbours(const GasCells *cells, Domain domain, PetscInt node, NodeVisitor visit, void *context)
{
  const PetscInt count = cells->near * cells->per;
  PetscInt       lower[DIM], upper[DIM];

  NodeRange(cells, node, lower, upper);
  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt side = 0; side < 2; side++) {
      const PetscInt from = lower[d], to = upper[d];
      PetscInt       at[DIM] = {lower[0], lower[1], lower[2]}, next;

      at[d] = side ? to + 1 : from - 1;
      next  = Beyond(cells, domain, d, at);
      if (next >= 0) visit(cells, next, context);
      if (node < count || next < 0 || next >= count) continue; /* the whole side of the node is beside this */
      lower[d] = upper[d] = at[d];
      while (CellNext(lower, upper, at)) visit(cells, Beyond(cells, domain, d, at), context);
      lower[d] = from;
      upper[d] = to;
    }
}

/* Makes the node one piece with that of the context, which comes later. */
static void Join(const GasCells *cells, PetscInt node, void *context)
{
  const PetscInt of = *(const PetscInt *)context;

  if (node < of && cells->label[node] >= 0) PieceJoin(cells->label, node, of);
}

/* Labels the nodes with the numbers of their regions, and finds which regions are open air. */
static PetscErrorCode Connect(GasCells *cells, Domain domain, Regions *regions)
{
  const PetscInt nodes = cells->near * cells->per + cells->all;
  PetscInt       begin, end, first[DIM], last[DIM];

  PetscFunctionBegin;
  SharedSlice(&cells->of_nodes, nodes, &begin, &end);
  for (PetscInt c = begin; c < end; c++)
    cells->label[c] = IsEmpty(cells, c) && NodeRange(cells, c, first, last) ? c : GAS_LIQUID;
  PetscCall(SharedFence(&cells->of_nodes));
  for (PetscInt c = begin; c < end; c++)
    if (cells->label[c] >= 0) ForNeighbours(cells, domain, c, Join, &c);
  PetscCall(PiecesNumber(&cells->of_nodes, nodes, cells->label, &regions->count));
  PetscCall(PetscCalloc1(3 * regions->count, &regions->cells));
  regions->faces = regions->cells + regions->count;
  regions->label = regions->faces + regions->count;
  SharedPart(&cells->of_nodes, nodes, &begin, &end);
  for (PetscInt c = begin; c < end; c++) {
    const PetscInt r = cells->label[c];

    if (r < 0) continue;
    NodeRange(cells, c, first, last);
    regions->cells[r] += (last[0] - first[0] + 1) * (last[1] - first[1] + 1) * (last[2] - first[2] + 1);
    for (PetscInt d = 0; d < domain->dim; d++)
      regions->faces[r] |= (first[d] == 0) << 2 * d | (last[d] == cells->n[d] - 1) << (2 * d + 1);
  }
  PetscCallMPI(
    MPI_Allreduce(MPI_IN_PLACE, regions->cells, (PetscMPIInt)regions->count, MPIU_INT, MPI_SUM, domain->comm));
  PetscCallMPI(
    MPI_Allreduce(MPI_IN_PLACE, regions->faces, (PetscMPIInt)regions->count, MPIU_INT, MPI_BOR, domain->comm));
  for (PetscInt r = 0; r < regions->count; r++) {
    regions->label[r] = GAS_VOID;
    for (PetscInt f = 0; f < 2 * domain->dim; f++)
      if (regions->faces[r] >> f & 1 && domain->face[f / 2][f % 2] == FACE_OPEN) regions->label[r] = GAS_AIR;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The region, of those beside a cell, that takes it. */
typedef struct {
  const Regions *regions;
  PetscInt       best; /* GAS_LIQUID: none */
} Taker;

/* A cell that is as near to two regions is the larger one's, wherever the axes point. With the smaller one's a film of
   two spacings around gas burst (tests/verify/gas_odd.py). */
static void Take(const GasCells *cells, PetscInt node, void *context)
{
  Taker         *taker = (Taker *)context;
  const PetscInt owner =
    node < cells->near * cells->per ? __atomic_load_n(&cells->owner[node], __ATOMIC_RELAXED) : GAS_LIQUID;
  PetscInt more;

  if (owner < 0 || owner == taker->best) return;
  more = taker->best < 0 ? 1 : taker->regions->cells[owner] - taker->regions->cells[taker->best];
  if (more > 0 || (more == 0 && owner < taker->best)) taker->best = owner;
}

#define TAKEN(region) (GAS_LIQUID - 1 - (region)) /* in this layer: what is beside does not see it yet */

/* Gives the cells within REACH of a region to it. */
static PetscErrorCode Spread(GasCells *cells, Domain domain, const Regions *regions)
{
  PetscInt first, end;

  PetscFunctionBegin;
  SharedSlice(&cells->of_nodes, cells->near * cells->per, &first, &end);
  for (PetscInt c = first; c < end; c++) cells->owner[c] = cells->label[c];
  for (PetscInt layer = 0; layer < REACH; layer++) {
    PetscCall(SharedFence(&cells->of_nodes));
    for (PetscInt c = first; c < end; c++) {
      Taker taker = {regions, GAS_LIQUID};

      if (cells->owner[c] != GAS_LIQUID) continue;
      ForNeighbours(cells, domain, c, Take, &taker);
      if (taker.best >= 0) __atomic_store_n(&cells->owner[c], TAKEN(taker.best), __ATOMIC_RELAXED);
    }
    PetscCall(SharedFence(&cells->of_nodes));
    for (PetscInt c = first; c < end; c++)
      if (cells->owner[c] < GAS_LIQUID) cells->owner[c] = TAKEN(cells->owner[c]);
  }
  PetscCall(SharedFence(&cells->of_nodes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the cells with an owner, and those with a pocket. */
static PetscErrorCode SetOwned(GasCells *cells)
{
  PetscInt first, end;

  PetscFunctionBegin;
  SharedSlice(&cells->of_blocks, cells->near, &first, &end);
  for (PetscInt b = first; b < end; b++) {
    cells->seen.mask[b] = cells->held.mask[b] = 0;
    for (PetscInt c = 0; c < cells->per; c++) {
      const GasMask  bit   = cells->close.mask[b] & (GasMask)1 << c;
      const PetscInt owner = cells->owner[b * cells->per + c];

      if (owner >= GAS_AIR) cells->seen.mask[b] |= bit;
      if (owner > GAS_AIR) cells->held.mask[b] |= bit;
    }
  }
  PetscCall(GasSetBeside(cells, &cells->seen));
  PetscCall(GasSetBeside(cells, &cells->held));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Labels and owners become those of the regions. */
static PetscErrorCode Rename(GasCells *cells, const Regions *regions, PetscBool owned)
{
  PetscInt first, end;

  PetscFunctionBegin;
  SharedSlice(&cells->of_nodes, cells->near * cells->per + cells->all, &first, &end);
  for (PetscInt c = first; c < end; c++) {
    if (cells->label[c] >= 0) cells->label[c] = regions->label[cells->label[c]];
    if (owned && c < cells->near * cells->per && cells->owner[c] >= 0)
      cells->owner[c] = regions->label[cells->owner[c]];
  }
  PetscCall(SharedFence(&cells->of_nodes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The volumes of the pockets and their centres. */
static PetscErrorCode Measure(Pockets *pockets, Domain domain)
{
  const GasCells *cells = pockets->cells;
  const PetscInt  count = cells->near * cells->per;
  PetscInt        from, end;
  PetscReal       sum[GAS_MOST + 1][1 + DIM] = {{0}};

  PetscFunctionBegin;
  SharedPart(&cells->of_nodes, count + cells->all, &from, &end);
  for (PetscInt node = from; node < end; node++) {
    const PetscInt owner = node < count ? cells->owner[node] : cells->label[node];
    PetscInt       at[DIM], first[DIM], last[DIM];

    if (owner <= 0 || !NodeRange(cells, node, first, last)) continue;
    for (PetscInt d = 0; d < DIM; d++) at[d] = first[d];
    do {
      const PetscReal V = (node < count ? 1 - cells->filled[node] : 1) * cells->column[at[0]];

      sum[owner][0] += V;
      for (PetscInt d = 0; d < domain->dim; d++)
        sum[owner][1 + d] += V * (cells->lower[d] + (at[d] + 0.5) * cells->size[d]);
    } while (CellNext(first, last, at));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, (PetscMPIInt)((1 + DIM) * (pockets->count + 1)), MPIU_REAL, MPIU_SUM,
                             domain->comm));
  for (PetscInt k = 1; k <= pockets->count; k++) {
    pockets->pocket[k].volume = sum[k][0];
    for (PetscInt d = 0; d < DIM; d++)
      pockets->pocket[k].center[d] = sum[k][0] > 0 ? sum[k][1 + d] / sum[k][0] : sum[k][1 + d];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How many cells of pocket b before, from 1 on, are now in region r, [b (count + 1) + r]; b = 0: of the open air
   before. */
static PetscErrorCode Overlap(const Gas *gas, const Regions *regions, PetscInt **common)
{
  const GasCells *now = gas->now.cells, *before = gas->before.cells;
  const PetscInt  width = regions->count + 1;
  PetscInt        from, end;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1((gas->before.count + 1) * width, common));
  SharedPart(&before->of_nodes, before->near * before->per + before->all, &from, &end);
  for (PetscInt node = from; node < end; node++) {
    const PetscInt b = before->label[node];
    PetscInt       at[DIM], first[DIM], last[DIM];

    if (b < 0 || !NodeRange(before, node, first, last)) continue;
    for (PetscInt d = 0; d < DIM; d++) at[d] = first[d];
    do {
      const PetscInt here = GasCellsNode(now, at[0], at[1], at[2]), region = here < 0 ? -1 : now->label[here];

      if (region >= 0) (*common)[b * width + region]++;
    } while (CellNext(first, last, at));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, *common, (PetscMPIInt)((gas->before.count + 1) * width), MPIU_INT, MPI_SUM,
                             gas->cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The pocket of region r, from the pockets, voids and air that had its cells; *air: the part of these cells that was
   air; returns from how many pockets of gas it is. Volumes are not yet known: 'amount' and 'tracked' are without the
   air's, 'volume' is that before. */
static PetscInt Inherit(const Gas *gas, const PetscInt common[], PetscInt width, PetscInt r, Pocket *pocket,
                        PetscReal *air)
{
  PetscInt from = common[r], sources = 0;

  *pocket = (Pocket){0};
  for (PetscInt b = 1; b <= gas->before.count; b++) {
    const PetscInt  cells  = common[b * width + r];
    const PetscReal share  = cells / (PetscReal)PetscMax(1, common[b * width + width - 1]);
    const Pocket   *source = &gas->before.pocket[b];

    if (!cells) continue;
    from += cells;
    pocket->volume += share * source->volume;
    pocket->pressure += cells * source->pressure;
    if (PocketIsVoid(source)) continue;
    sources++;
    pocket->amount += share * source->amount;
    pocket->tracked += share * source->tracked;
  }
  from = PetscMax(1, from);
  pocket->pressure /= from;
  *air = common[r] / (PetscReal)from;
  return sources;
}

/* The cells of the smallest pocket of a checkpoint, if it has become smaller than a new one. sorted: room. */
static PetscErrorCode FindSmallestResumed(const Gas *gas, const Regions *regions, PetscInt sorted[], PetscInt *smallest)
{
  PetscInt n = 0;

  PetscFunctionBegin;
  for (PetscInt r = 0; r < regions->count; r++)
    if (regions->label[r] != GAS_AIR) sorted[n++] = regions->cells[r];
  PetscCall(PetscSortInt(n, sorted));
  if (n) *smallest = PetscMin(*smallest, sorted[PetscMax(0, n - gas->resumed)]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Labels regions that are large enough for a pocket with their numbers, and sums in common[b width + count] the cells
   of pocket b that are in these and in the air: what sheds regions too small for a pocket keeps their gas. The
   largest part of a pocket lasts to its last cell. Of more than GAS_MOST regions the largest are chosen, first of these
   parts. */
static PetscErrorCode Select(Gas *gas, Regions *regions, PetscInt common[])
{
  const PetscInt width = regions->count + 1;
  PetscInt      *size, *sorted, n = 0, least = 1, spare = 0, smallest = SMALLEST;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(regions->count, &size));
  PetscCall(PetscMalloc1(regions->count, &sorted));
  for (PetscInt b = 1; b <= gas->before.count && common; b++) {
    PetscInt largest = 1;

    if (PocketIsVoid(&gas->before.pocket[b])) continue;
    for (PetscInt r = 0; r < regions->count; r++) largest = PetscMax(largest, common[b * width + r]);
    for (PetscInt r = 0; r < regions->count; r++) /* of equal parts all: a mirror does not tell which */
      if (common[b * width + r] == largest) size[r] = PETSC_MAX_INT / 2;
  }
  if (gas->resumed) PetscCall(FindSmallestResumed(gas, regions, sorted, &smallest));
  for (PetscInt r = 0; r < regions->count; r++) {
    if (regions->label[r] == GAS_AIR || (!size[r] && regions->cells[r] < smallest))
      size[r] = 0;
    else
      sorted[n++] = size[r] += regions->cells[r];
  }
  PetscCall(PetscSortInt(n, sorted));
  gas->crowded = (PetscBool)(n > GAS_MOST);
  if (gas->crowded) least = sorted[n - GAS_MOST];
  for (PetscInt k = PetscMax(0, n - GAS_MOST); k < n; k++) spare += sorted[k] == least;
  gas->now.count = 0;
  for (PetscInt r = 0; r < regions->count; r++) {
    if (size[r] > least || (size[r] == least && spare-- > 0)) regions->label[r] = ++gas->now.count;
    for (PetscInt b = 0; b <= gas->before.count && common && regions->label[r] >= GAS_AIR; b++)
      common[b * width + width - 1] += common[b * width + r];
  }
  PetscCall(PetscFree(size));
  PetscCall(PetscFree(sorted));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a region is large enough for a pocket, and not open. */
static PetscBool SomeClosed(const Regions *regions)
{
  for (PetscInt r = 0; r < regions->count; r++)
    if (regions->label[r] != GAS_AIR && regions->cells[r] >= SMALLEST) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Decides which regions are pockets, and what gas they have: a void has none. Without pockets before, at the start,
   every region that is not open has gas. */
static PetscErrorCode Choose(Gas *gas, Regions *regions, PetscReal air[GAS_MOST + 1])
{
  const PetscInt width  = regions->count + 1;
  PetscInt      *common = NULL;

  PetscFunctionBegin;
  gas->open = PETSC_FALSE;
  gas->born = gas->merged = gas->split = 0;
  gas->enclosed = gas->vented = gas->lost = 0;
  if (gas->before.count || (gas->before_known && SomeClosed(regions))) PetscCall(Overlap(gas, regions, &common));
  PetscCall(Select(gas, regions, common));
  for (PetscInt r = 0; r < regions->count; r++) {
    const PetscInt label   = regions->label[r];
    Pocket         pocket  = {0};
    PetscReal      was_air = 1;
    PetscInt       sources = 0;

    gas->open = (PetscBool)(gas->open || label == GAS_AIR);
    if (label <= 0) continue;
    if (gas->before_known) sources = Inherit(gas, common, width, r, &pocket, &was_air);
    gas->now.pocket[label] = pocket;
    gas->now.faces[label]  = regions->faces[r];
    air[label]             = was_air;
    gas->born += gas->before_known && sources == 0 && was_air > 0;
    gas->merged += PetscMax(0, sources - 1);
  }
  for (PetscInt b = 1; b <= gas->before.count && common; b++) {
    const PetscReal amount = gas->before.pocket[b].amount;
    const PetscInt  all    = common[b * width + width - 1];
    PetscInt        into = 0, vented = 0;

    if (PocketIsVoid(&gas->before.pocket[b])) continue;
    for (PetscInt r = 0; r < regions->count; r++) {
      into += regions->label[r] > 0 && common[b * width + r] > 0;
      vented += regions->label[r] == GAS_AIR ? common[b * width + r] : 0;
    }
    if (all)
      gas->vented += amount * vented / all;
    else
      gas->lost += amount;
    gas->split += PetscMax(0, into - 1);
    gas->ended += into == 0;
  }
  PetscCall(PetscFree(common));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of a hole. */
typedef struct {
  PetscReal pressure; /* Pa; 0: not given */
} HoleGas;

static const OptionRow of_holes[] = {
  {"-pressure", "Pressure at the start of the gas in a hole, with -gas; 0: -gas_pressure_start", "Pa", "[0, inf)",
   ROW_REAL, offsetof(HoleGas, pressure), .changes = PETSC_TRUE},
  {.name = NULL},
};

const Property GasProperties[] = {{OWNER_HOLE, sizeof(HoleGas), of_holes}, {.rows = NULL}};

PetscReal GasHolePressure(Scene scene, const PetscReal x[])
{
  PetscReal pressure = 0;
  Body      hole;

  for (PetscInt k = 0; (hole = SceneHole(scene, k)); k++)
    if (!x || BodyDistance(hole, x) < 0)
      pressure = PetscMax(pressure, ((const HoleGas *)BodyOwn(hole, GasProperties))->pressure);
  return pressure;
}

/* The pressures (Pa) of the pockets at the start: that of -gas_pressure_start, or of a hole that they fill. */
static PetscErrorCode Start(const Gas *gas, PetscReal pressure[])
{
  const GasCells *cells  = gas->now.cells;
  const Domain    domain = gas->cloud->domain;
  PetscReal       least[GAS_MOST + 1]; /* negative: MPI takes the largest of both */
  PetscInt        first, end;

  PetscFunctionBegin;
  for (PetscInt k = 1; k <= gas->now.count; k++) pressure[k] = 0, least[k] = -PETSC_MAX_REAL;
  SharedPart(&cells->of_nodes, cells->near * cells->per + cells->all, &first, &end);
  for (PetscInt node = first; node < end; node++) {
    const PetscInt label = cells->label[node];
    PetscInt       at[DIM], last[DIM];
    PetscReal      x[DIM] = {0, 0, 0}, own;

    if (label <= 0 || !NodeRange(cells, node, at, last)) continue;
    for (PetscInt d = 0; d < domain->dim; d++) x[d] = cells->lower[d] + (at[d] + 0.5) * cells->size[d];
    own             = GasHolePressure(gas->cloud->scene, x);
    pressure[label] = PetscMax(pressure[label], own);
    if (own > 0) least[label] = PetscMax(least[label], -own);
  }
  for (PetscReal **of = (PetscReal *[]){pressure, least, NULL}; *of; of++)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, *of + 1, (PetscMPIInt)gas->now.count, MPIU_REAL, MPIU_MAX, domain->comm));
  for (PetscInt k = 1; k <= gas->now.count; k++) {
    PetscCheckUser(pressure[k] == 0 || pressure[k] == -least[k], domain->comm,
                   "holes of the pressures %g and %g Pa are one pocket of gas: they touch", (double)-least[k],
                   (double)pressure[k]);
    if (pressure[k] == 0) pressure[k] = gas->start;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* *brought: the liquid that has been brought since pockets were last looked for, m^dim. */
static PetscErrorCode Brought(Gas *gas, PetscReal *brought)
{
  PetscReal liquid = 0;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < gas->cloud->n_fluid; a++) liquid += gas->cloud->volume[a];
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &liquid, 1, MPIU_REAL, MPIU_SUM, gas->cloud->comm));
  *brought        = gas->before_known ? liquid - gas->before.liquid : 0;
  gas->now.liquid = liquid;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The pressure (Pa, over that of the open air) of an amount of gas in a volume. */
static PetscReal Compressed(const Gas *gas, PetscReal amount, PetscReal volume)
{
  return amount > 0 && volume > 0 ? gas->ambient * (PetscPowReal(amount / volume, gas->exponent) - 1) : 0;
}

PetscErrorCode GasFind(Gas *gas, PetscBool exact)
{
  GasCells *cells  = &gas->cells[gas->before.cells == &gas->cells[0]];
  Domain    domain = gas->cloud->domain;
  Regions   regions;
  PetscReal air[GAS_MOST + 1], start[GAS_MOST + 1], was[GAS_MOST + 1] = {0}, brought = 0;

  PetscFunctionBegin;
  gas->ended     = 0;
  gas->unseen    = 0;
  gas->now.cells = cells;
  gas->now.moved = 0;
  exact          = (PetscBool)(exact || !gas->before_known || gas->before.count || !gas->open);
  PetscCall(GasCellsFill(cells, gas->cloud, gas->pressure, gas->solids_move, exact));
  PetscCall(Connect(cells, domain, &regions));
  if (!exact && SomeClosed(&regions)) {
    PetscCall(PetscFree(regions.cells));
    PetscCall(GasCellsFill(cells, gas->cloud, gas->pressure, gas->solids_move, PETSC_TRUE));
    PetscCall(Connect(cells, domain, &regions));
  }
  PetscCall(Choose(gas, &regions, air));
  if (GasSeen(gas)) PetscCall(Spread(cells, domain, &regions));
  PetscCall(Rename(cells, &regions, GasSeen(gas)));
  PetscCall(PetscFree(regions.cells));
  if (GasSeen(gas)) PetscCall(SetOwned(cells));
  PetscCall(Brought(gas, &brought));
  for (PetscInt k = 1; k <= gas->now.count; k++) was[k] = gas->now.pocket[k].volume;
  if (gas->now.count) PetscCall(Measure(&gas->now, domain));
  for (PetscInt k = 1; k <= gas->now.count; k++) start[k] = gas->ambient;
  if (!gas->before_known) PetscCall(Start(gas, start));
  for (PetscInt k = 1; k <= gas->now.count; k++) {
    Pocket         *pocket = &gas->now.pocket[k];
    const PetscReal had    = pocket->amount;

    /* what was air has the air's pressure, at the start that of the option */
    pocket->amount +=
      air[k] * pocket->volume *
      (gas->frozen || gas->exponent == 0 ? 1 : PetscPowReal(start[k] / gas->ambient, 1 / gas->exponent));
    gas->enclosed += pocket->amount - had;
    pocket->tracked += air[k] * pocket->volume;
    if (brought > gas->cloud->domain->volume / 2 && was[k] - pocket->volume > JUMP * brought) {
      const PetscReal gained = pocket->volume - was[k]; /* no flux tells it */

      gas->unseen += gained * Compressed(gas, pocket->amount, pocket->tracked + 0.5 * gained);
      pocket->tracked += gained;
    }
  }
  gas->found = PETSC_TRUE;
  gas->same  = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GasKeep(Gas *gas, PetscBool *kept)
{
  PetscReal brought;

  PetscFunctionBegin;
  PetscCall(Brought(gas, &brought));
  *kept = (PetscBool)(gas->before.moved < SKIN && PetscAbsReal(brought) < gas->cloud->domain->volume / 2);
  if (!*kept) PetscFunctionReturn(PETSC_SUCCESS);
  gas->now   = gas->before;
  gas->found = gas->same = PETSC_TRUE;
  gas->born = gas->split = gas->merged = gas->ended = 0;
  gas->enclosed = gas->vented = gas->lost = gas->unseen = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

void GasSwap(Gas *gas)
{
  gas->before       = gas->now;
  gas->now.count    = 0;
  gas->before_known = PETSC_TRUE;
  gas->found        = PETSC_FALSE;
}
