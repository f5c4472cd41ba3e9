/* Private to gas/: pockets of gas, an edge of the step. */
#ifndef ISPH_GAS_IMPL_H
#define ISPH_GAS_IMPL_H

#include "../base/shared.h"
#include "../domain/images.h"
#include "../gauges/columns.h"
#include "../stepper/edge.h"

#define GAS_MOST  256 /* pockets, whose equations are dense; of more regions the smallest have no gas */
#define GAS_SHARE 8   /* pockets that a row may see */

/* What a region of emptiness is, or the number of a pocket, 1 ... count. */
enum { GAS_LIQUID = -2, GAS_VOID = -1, GAS_AIR = 0 };

/* --- cells.c: cells of one spacing near free surfaces, walls and solids, which the ranks of a machine share. Cells lie
   in blocks; a block that no such particle reaches has no cells, it is empty or full as a whole. A node is a cell or an
   empty block. --- */
typedef uint64_t GasMask; /* a bit for each cell of a block */
typedef struct {
  GasMask       *mask;   /* [all], near of them used: the cells of the set */
  unsigned char *beside; /* [all] whether a block or one beside it has cells of the set */
} GasSet;
typedef struct {
  PetscInt       n[DIM], blocks[DIM];   /* cells and blocks a direction */
  PetscInt       shift[DIM];            /* a block has 2^shift cells a direction */
  PetscReal      lower[DIM], size[DIM]; /* m */
  PetscReal      many[DIM];             /* 1/size */
  PetscReal      single[DIM][2];        /* what reaches none of these planes has no image, m */
  PetscReal      volume;                /* of a cell, m^dim, of the cross section of rings */
  PetscReal     *column;                /* [n[0]] the volumes of cells, of rings the whole (m3) */
  PetscInt       per, near, all;        /* cells of a block, blocks with cells, blocks */
  PetscInt       capacity;              /* nodes */
  Shared         of_blocks, of_nodes;   /* the arrays of blocks, and of nodes */
  PetscInt      *block;                 /* [all] number of a block with cells; BLOCK_EMPTY, BLOCK_FULL */
  PetscInt      *home;                  /* [all], near of them used: the block with this number */
  GasSet         close, seen, held;     /* cells that are not full for sure; with an owner; with a pocket as owner */
  GasSet         wet;                   /* cells near what is inside; beside: of the blocks that are filled */
  unsigned char *touch;                 /* [all] TOUCH_... */
  unsigned char *core;                  /* [all][per] of solids: CORE_... */
  PetscInt64    *sum;                   /* [near][per] while parts are added: SharedAdd */
  PetscReal     *filled;                /* [near][per] sum V W over its value in full liquid, 1 */
  PetscReal     *solid;                 /* [near][per] the part of walls and solids, if it is known */
  PetscBool      solid_known;
  PetscInt      *label; /* [nodes] */
  PetscInt      *owner; /* [near][per] the region around, a few cells into the liquid, too */
} GasCells;

#define BLOCK_EMPTY (-1)
#define BLOCK_FULL  (-2)

/* The volume (m^dim) of particle a in the sums of cells. full: sum V W on a full lattice. Not collective. */
static inline PetscReal GasPart(Cloud cloud, PetscInt a, PetscReal full)
{
  return cloud->domain->volume * cloud->relative_weight[a] / full;
}

/* GasCellsFill - finds the cells and how far they are filled at the positions of the cloud; moved: solids have moved;
   exact: else cells beside particles inside count as full, and cells beside dry walls of the box alone as empty: the
   sums cost a third, and that suffices to see what is empty. GasCellsSolid - the part of walls and solids of it; full:
   PressureFull. Collective. GasCellsNode - the node of a cell, -1: full. Not collective. */
PetscErrorCode GasCellsFill(GasCells *cells, Cloud cloud, Pressure pressure, PetscBool moved, PetscBool exact);
PetscErrorCode GasCellsSolid(GasCells *cells, Cloud cloud, PetscReal full);
PetscErrorCode GasCellsDestroy(GasCells *cells);

/* Cells within the support of the image of a particle: W there; with 'slopes' also the vectors from their middles to it
   in units of its size, F there, and their volumes (m^dim, of rings m3). */
#define GAS_NEAR 256 /* at most, some blocks' cells; more come in several */
typedef struct {
  const Image *image;
  PetscBool    slopes;
  PetscInt     n, node[GAS_NEAR];
  PetscReal    r2[GAS_NEAR], W[GAS_NEAR], r[GAS_NEAR][DIM], F[GAS_NEAR], volume[GAS_NEAR];
} GasNear;
typedef void (*GasVisitor)(const GasCells *cells, const GasNear *near, void *context);

/* GasCellsNear - visits the cells of a set within the support of an owned particle and of its images. Not
   collective. */
void GasCellsNear(const GasCells *cells, Cloud cloud, const GasSet *set, PetscInt a, PetscBool slopes, GasVisitor visit,
                  void *context);

/* GasSetBeside - finds the blocks beside the cells of a set, after its masks have changed. Collective. */
PetscErrorCode GasSetBeside(const GasCells *cells, GasSet *set);

/* The force of a pocket of unit pressure on a dummy particle of a wall or solid, m^(dim - 1): the sum over the pocket's
   cells of 6 s (1 - f) V grad W, f how far a cell is filled, s how far by walls and solids. On a dry wall, s = f, it is
   the area: 6 s (1 - s) grad s integrates to 1 whatever the kernel, and is symmetric in 1 - s, so that nothing is
   missing in corners. Where liquid fills a share q of what is in front of the wall, 1 - f = (1 - q) (1 - s). */
typedef struct {
  PetscInt  dummy, pocket; /* pocket: from 1 on */
  PetscReal unit[DIM];
} GasLoad;
typedef struct {
  PetscInt count, capacity;
  GasLoad *load;
} GasLoads;

/* GasCellsLoads - the loads of this rank's dummy particles at their present positions. Collective. */
PetscErrorCode GasCellsLoads(GasCells *cells, Cloud cloud, PetscReal full, GasLoads *loads);

static inline PetscInt GasCellsNode(const GasCells *cells, PetscInt i, PetscInt j, PetscInt k)
{
  const PetscInt *s     = cells->shift;
  const PetscInt  home  = ((k >> s[2]) * cells->blocks[1] + (j >> s[1])) * cells->blocks[0] + (i >> s[0]);
  const PetscInt  block = cells->block[home];

  if (block == BLOCK_FULL) return -1;
  if (block == BLOCK_EMPTY) return cells->near * cells->per + home;
  return block * cells->per + ((((k & ((1 << s[2]) - 1)) << s[1]) + (j & ((1 << s[1]) - 1))) << s[0]) +
         (i & ((1 << s[0]) - 1));
}
/* GasCellsPlace - the cell of a node; of an empty block its first. Not collective. */
void GasCellsPlace(const GasCells *cells, PetscInt node, PetscInt at[DIM]);

/* --- regions.c --- */

typedef struct {
  PetscReal amount;      /* its volume at the pressure of the open air, m^dim (m3 of rings); 0: a void, without gas */
  PetscReal tracked;     /* its volume, by its flux and the cells, m^dim */
  PetscReal pressure;    /* Pa, over that of the open air */
  PetscReal volume;      /* by the cells, m^dim */
  PetscReal center[DIM]; /* m */
} Pocket;
#define POCKET_NUMBERS ((PetscInt)(sizeof(Pocket) / sizeof(PetscReal)))

static inline PetscBool PocketIsVoid(const Pocket *pocket)
{
  return (PetscBool)(pocket->amount == 0);
}

/* The numbers of the edge in a StepState. */
typedef struct {
  PetscReal work, swept;            /* done by gas on the liquid, J; up to the start of the last step */
  PetscReal power;                  /* at that time, W */
  PetscReal highest;                /* largest pressure so far, Pa */
  PetscReal change;                 /* the fastest of a pocket's pressure in the last step, Pa/s */
  PetscReal enclosed, vented, lost; /* amounts so far: from the air, to the air, in regions too small for a pocket */
  PetscInt  count, known, idle;     /* pockets; they have been looked for; steps since then */
  PetscInt  born, split, merged, ended; /* pockets so far: enclosed, parted, joined, opened or filled */
  Pocket    pocket[GAS_MOST];
} GasNumbers;

/* Pockets and the cells by which they are found. */
typedef struct {
  GasCells *cells;
  PetscInt  count;
  Pocket    pocket[GAS_MOST + 1]; /* from 1 on */
  PetscInt  faces[GAS_MOST + 1];  /* of the box that they touch, a bit for each */
  PetscReal moved;                /* spacings by which what is beside them has moved since the cells were filled */
  PetscReal liquid;               /* all that there was, m^dim (m3 of rings) */
} Pockets;

/* A row beside pocket k - 1: the pocket's share of what the row sees outside, its slope (1/m) and the acceleration by
   this slope under unit pressure (m/(s2 Pa)); how much the pocket grows if the row moves, m^(dim - 1). */
typedef struct {
  PetscInt  row, pocket;
  PetscReal closure, share, slope[DIM], bend[DIM], area[DIM];
} GasRow;

/* How fast pocket 'pocket', from 1 on, grows (m3/s) if 'particle' moves by a unit velocity, m^(dim - 1), and if its
   ring gets longer by a unit of its length, m^dim: the derivative of the sums of the cells. */
typedef struct {
  PetscInt  particle, pocket;
  PetscReal area[DIM], lengthened;
} GasArea;

/* Row 'row' of this rank is beside the particle 'gap', a row that sees neither gas nor air, although its neighbourhood
   has gaps. */
typedef struct {
  PetscInt row, gap;
} GasTie;

/* The data of the edge. */
typedef struct {
  PetscBool on, frozen, open, solids_move; /* open: there is open air, too */
  PetscReal ambient, exponent, start;      /* Pa; p V^exponent is constant; Pa, of the pockets of the start */
  Cloud     cloud;                         /* borrowed */
  Pressure  pressure;                      /* borrowed */
  GasCells  cells[2];
  Pockets   now, before; /* of this trial; of the last step */
  PetscBool before_known, found, solved;
  PetscInt  resumed; /* pockets of the checkpoint that is continued, while they are found again; else 0 */
  PetscBool same;    /* those of this trial are those of the last step, with its cells */
  PetscBool crowded; /* there are more than GAS_MOST regions */
  PetscInt  idle;    /* steps since pockets were looked for */
  PetscInt  born, split, merged, ended; /* in this step */
  PetscReal enclosed, vented, lost;     /* in this step */
  PetscReal unseen;                     /* in this step, its work by changes of volume that no flux tells, J */
  PetscInt  layout;                     /* of the cloud, when the rows were found */
  PetscInt  rows, rows_capacity, gaps, gaps_capacity;
  GasRow   *row;
  PetscInt  areas, areas_capacity;
  GasArea  *area;
  PetscInt  gapped, ties, ties_capacity; /* gaps of all ranks */
  PetscInt *gap;
  GasTie   *tie;
  Mat       factor;                                /* of D + C, by Cholesky */
  PetscReal g[GAS_MOST], *matrix;                  /* [count][count] D + C */
  PetscReal star[GAS_MOST + 1], old[GAS_MOST + 1]; /* rates of the volumes without the pressure, at the start, m3/s */
  PetscReal kept[GAS_MOST + 1];                    /* pressures of the former step, Pa */
  PetscReal change;                                /* that of the numbers */
  GasLoads  loads;
  PetscInt  yields; /* rows by which pockets move what floats, behind the others */
} Gas;

/* Whether liquid sees anything but open air. */
static inline PetscBool GasSeen(const Gas *gas)
{
  return (PetscBool)(gas->now.count || !gas->open);
}

/* GasHolePressure - the pressure (Pa) that gas at x (m) has at the start by the option of a hole there, 0: none; the
   largest of all holes without x. Not collective. */
extern const Property GasProperties[]; /* of holes */
PetscReal             GasHolePressure(Scene scene, const PetscReal x[]);

/* GasFind - finds the regions without liquid at the positions of the cloud, and gives pockets what pockets before had;
   exact: else a first look is a quick one, which suffices if all regions are open.
   GasKeep - or takes over what was found last, if nothing beside the pockets has moved far since. Collective. GasSwap -
   the pockets now become those before. Not collective. */
PetscErrorCode GasFind(Gas *gas, PetscBool exact);
PetscErrorCode GasKeep(Gas *gas, PetscBool *kept);
void           GasSwap(Gas *gas);

/* --- couple.c --- */
extern const LowRank GasTerm; /* its context is a Gas */
/* GasFindRows - finds rows and gaps after GasFind. Collective. GasForget - there are none. Not collective. */
PetscErrorCode GasFindRows(Gas *gas);
void           GasForget(Gas *gas);

extern const GaugeKind GaugePockets; /* gauge.c */

#endif
