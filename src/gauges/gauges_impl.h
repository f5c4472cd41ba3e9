/* Private to gauges/: what a gauge provides, and what several gauges share. */
#ifndef ISPH_GAUGES_IMPL_H
#define ISPH_GAUGES_IMPL_H

#include "../base/shared.h"
#include "../domain/images.h"
#include "columns.h"

extern const GaugeKind GaugeCrater, GaugePoints, GaugeHeights, GaugeForces, GaugeDroplets, GaugeLines, GaugeNeck,
  GaugeRoughness;
#define GAUGE_KINDS 16 /* at most, with those of edges */

/* A table that is written, and the data of its gauge. */
typedef struct {
  const GaugeTable *kind;
  void             *data;
  ColumnList        columns;
} FilledTable;

struct _p_Gauges {
  MPI_Comm         comm;
  PetscMPIInt      rank, size;
  Cloud            cloud;                   /* borrowed */
  const Viscosity *viscosity;               /* borrowed; NULL: not known */
  Pressure         pressure;                /* borrowed; NULL: none */
  PetscBool        corrected;               /* the pressure gradient is corrected */
  PetscBool        tension;                 /* FIELD_CAPILLARY holds the pressure of surface tension */
  PetscReal        level;                   /* m; NAN: not given and not yet measured */
  PetscBool        level_given;             /* by -gauge_level */
  PetscReal        multiplicity;            /* copies of the simulated part that make the whole */
  PetscErrorCode (*refresh)(void *context); /* of GaugesSetRefresh */
  void       *context;
  void       *run; /* of GaugesSetRun */
  void       *data[GAUGE_KINDS];
  PetscBool   listed; /* the lists are filled */
  ColumnList  series;
  PetscInt    first[GAUGE_KINDS + 1]; /* the first column of each kind in it */
  FilledTable table[GAUGE_TABLES_MOST];
  PetscInt    tables;
};

#define GAUGE_PLACES_MOST 64 /* points or heights; lines are fewer */
#define GAUGE_LINES_MOST  16

/* Places of one option, as a list of coordinates. */
typedef struct {
  PetscInt  numbers;                           /* of coordinates; with the next a ROW_NUMBERS */
  PetscReal at[(GAUGE_PLACES_MOST + 1) * DIM]; /* [count][coordinates a place] m; room for one place too many */
  PetscInt  count;                             /* of places */
} Places;

static inline char AxisName(PetscInt direction)
{
  return "xyz"[direction];
}

/* --- totals.c --- */
/* HeightOverLevel - height (m) over the level of liquid whose highest particle is at 'top' (m, -PETSC_MAX_REAL: none);
   NAN without liquid. A particle fills a cube of one spacing, so the surface is half a spacing above it; beyond a
   periodic face liquid is at the other one, so it is never higher than that. Not collective. */
PetscReal HeightOverLevel(Gauges gauges, PetscReal top);

/* --- sample.c: values at places --- */
/* PlacesCheck - counts the places of an option, of 'points' points with so many coordinates each. Refuses (UserError)
   an incomplete place, more than 'most' places, and a place outside the box. what: "point", ... Collective. */
PetscErrorCode PlacesCheck(Gauges gauges, const char option[], const char what[], PetscInt points, PetscInt coordinates,
                           PetscInt most, Places *places);

/* InsideSolid - whether a place at this signed distance (m) from a solid lies inside the solid. A place on its surface
   does not. Not collective. */
PetscBool InsideSolid(Gauges gauges, PetscReal distance);
/* SampledFields - the fields that gauges take at places besides (CARRY_SCALAR) and this run has; their number. Not
   collective. PointsSample - pressure (Pa), velocity (dim components, m/s) and the n SampledFields at 'count' points at
   ([count][dim], m); values [count][1 + dim + n]. The value is that of the linear function that fits the fluid
   within the kernel's support best, weighted by V W, through periodic faces and mirrors, but not through solids: a
   point on a wall or a solid reads the fluid in front, continued to it. Where liquid is thin it is the mean. In open
   air the pressure is 0, in a pocket of gas its own, and all else NAN. Inside a solid all is NAN. Collective. */
PetscInt       SampledFields(Gauges gauges, FieldId fields[FIELD_STORED_COUNT]);
PetscErrorCode PointsSample(Gauges gauges, PetscInt count, const PetscReal at[], PetscReal values[]);

/* --- heights.c --- */
/* HeightsSample - height (m) of the liquid column at each of 'count' places at ([count][dim - 1], m), or thickness: its
   height over the wall or solid below, 0 if its lowest point is more than a spacing above. The column ends where the
   volume fraction of liquid, sum V W over the fluid divided by 1 - sum V W over walls and solids, stays below a half
   for a spacing. Without liquid, the bottom of the box. Collective. */
PetscErrorCode HeightsSample(Gauges gauges, PetscInt count, const PetscReal places[], PetscBool thickness,
                             PetscReal height[]);

/* --- connect.c: connected liquid --- */
/* Largest distance between connected particles, spacings. Neighbours in a sheet or thread are closer; a drop that has
   left the rim is not. */
#define CONNECTION 1.25

/* ConnectedLabels - label [n_total of the cloud]: for an owned fluid particle, the smallest id in its connected piece
   (CONNECTION). Cloud and swarm must hold the same state. Collective. */
PetscErrorCode ConnectedLabels(Gauges gauges, PetscReal label[]);

/* --- crater_setup.c --- */
#define POOL 0 /* the first body is that in which a crater forms */

/* Where and how crown, crater and jet are measured. */
typedef struct {
  PetscBool wanted;
  PetscReal axis[DIM];  /* m, horizontal */
  PetscReal jet_radius; /* m */
  PetscReal radius;     /* m, the crater lies inside */
  struct {
    PetscInt  count;
    PetscReal value[DIM];
  } given; /* the axis, as the user gave it */
} Crater;

/* CraterOptions, CraterDefaults, CraterMore, CraterCheck - of the GaugeKind. GaugeBodyBounds - bounding box
   of a body inside the box, m. CraterMirrors - number of symmetry faces that hold the axis. The last two are not
   collective. */
extern const OptionRow CraterOptions[];
void                   CraterDefaults(Gauges gauges, void *data);
PetscErrorCode         CraterMore(Gauges gauges, OptionItems PetscOptionsObject, void *data);
PetscErrorCode         CraterCheck(Gauges gauges, void *data);
void                   GaugeBodyBounds(Gauges gauges, PetscInt body, PetscReal lower[DIM], PetscReal upper[DIM]);
PetscInt               CraterMirrors(Gauges gauges, const Crater *crater);

/* --- crater_grid.c: cells over the fluid find the liquid connected with the pool, and the surface below the sky --- */
#define CELL_LIQUID 1 /* holds fluid */
#define CELL_BODY   2 /* holds fluid of the pool's body */
#define CELL_POOL   4 /* connected with the pool */

/* Axes 0 and 1 are horizontal, axis 2 points upwards. A rim of one empty cell surrounds the fluid. Layers of air lie on
   top. */
typedef struct {
  PetscInt       n[DIM], count, columns; /* rim included; columns = n[0] n[1] */
  PetscInt       component[DIM];         /* of positions, for each axis; in two dimensions component[1] is unused */
  PetscReal      lower[DIM], size;       /* m, of the cell 1,1,1 */
  Shared         shared;                 /* the arrays */
  unsigned char *cell;                   /* [count] CELL_... */
  PetscInt      *piece;                  /* [count + 1] of what is connected */
  PetscInt      *lowest;                 /* [columns] layer of the lowest cell that is open to the sky; n[2]: none */
  PetscReal     *radius, *top;           /* [columns] m: see crater.c */
  PetscBool     *inside;                 /* [columns] the crater radius */
} CraterGrid;

/* CraterGridCreate - marks the cells that hold fluid of any rank. CELL_POOL marks the connected component (26
   neighbours) with the most cells of the body 'pool'. Collective. */
PetscErrorCode CraterGridCreate(Gauges gauges, PetscInt pool, const ParticleArrays *arrays, CraterGrid *grid);
/* CraterGridSky - finds 'lowest'. A column that is not inside blocks the sky. Collective. */
PetscErrorCode CraterGridSky(CraterGrid *grid, PetscInt dim);
PetscErrorCode CraterGridDestroy(CraterGrid *grid);

/* CraterGridCell - number and indices of the cell that holds the point x (m); -1: outside the grid. Not collective. */
static inline PetscInt CraterGridCell(const CraterGrid *grid, const PetscReal x[DIM], PetscInt index[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal s = (x[grid->component[d]] - grid->lower[d]) / grid->size;

    if (!(s > -0.5 && s < (PetscReal)(grid->n[d] - 2))) return -1; /* true for NAN, too */
    index[d] = PetscMax((PetscInt)PetscFloorReal(s), 0) + 1;
  }
  return CellIndex(grid->n, index[0], index[1], index[2]);
}

/* CraterGridReach - the cells first..last that a particle at x (m) of this size (1) covers. A particle of size 1 covers
   the cell of its centre; a larger particle covers the cells of the fine particles it could be divided into. False:
   outside the grid. Not collective. */
static inline PetscBool CraterGridReach(const CraterGrid *grid, const PetscReal x[DIM], PetscReal size,
                                        PetscReal spacing, PetscInt first[DIM], PetscInt last[DIM])
{
  const PetscReal reach = 0.5 * PetscMax(0, size - 1) * spacing / grid->size; /* cells */
  PetscInt        index[DIM];

  if (CraterGridCell(grid, x, index) < 0) return PETSC_FALSE;
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal s = (x[grid->component[d]] - grid->lower[d]) / grid->size;

    first[d] = reach > 0 ? PetscMax(1, (PetscInt)PetscFloorReal(s - reach) + 1) : index[d];
    last[d]  = reach > 0 ? PetscMin(grid->n[d] - 2, (PetscInt)PetscFloorReal(s + reach) + 1) : index[d];
  }
  return PETSC_TRUE;
}

#endif
