/* Private to gauges/: what a gauge provides, and what several of them share. */
#ifndef ISPH_GAUGES_IMPL_H
#define ISPH_GAUGES_IMPL_H

#include "gauges.h"

#define GAUGE_NAME_LENGTH 64  /* bytes of a column's name */
#define GAUGE_HEAD_LENGTH 160 /* bytes of a table's head */

/* A kind of gauge: one file and one line in gauges.c. Entries may be NULL. */
typedef struct {
  PetscErrorCode (*setfromoptions)(Gauges gauges, OptionItems PetscOptionsObject); /* inside an options block */
  PetscErrorCode (*check)(Gauges gauges); /* refuses bad values, after the block */
  /* Columns of the series: how many, the name of one, their values. */
  PetscInt (*columns)(Gauges gauges);
  PetscErrorCode (*name)(Gauges gauges, PetscInt column, char name[], size_t length);
  PetscErrorCode (*measure)(Gauges gauges, PetscReal values[]);
  PetscBool needs_sums; /* 'measure' reads what OperatorsMoments and TensionApply write */
  /* A table of its own: its file, whether it is wanted, its head, its rows (see GaugesTableRows). */
  const char *file;
  PetscBool (*wanted)(Gauges gauges);
  PetscErrorCode (*head)(Gauges gauges, char head[], size_t length);
  PetscErrorCode (*rows)(Gauges gauges, PetscInt *count, PetscInt *width, PetscReal **values);
} GaugeKind;

extern const GaugeKind GaugeCrater, GaugePoints, GaugeHeights, GaugeForces, GaugeBodies, GaugeDroplets, GaugeLines;

/* Where and how crown, crater and jet are measured. */
typedef struct {
  PetscBool wanted;
  char      pool_name[256];
  PetscInt  pool;         /* index of the body that is the pool */
  PetscInt  axis_numbers; /* how many numbers the user gave for the axis */
  PetscReal axis[DIM];    /* m, horizontal */
  PetscReal jet_radius;   /* m */
  PetscReal radius;       /* m, the crater is looked for inside */
  PetscReal cell;         /* spacings, size of the cells that tell liquid from air */
} CraterSetup;

#define PLACES_MOST 64 /* points or heights; lines are fewer */
#define LINES_MOST  16

/* Places that the user gave as one list of coordinates. */
typedef struct {
  PetscInt  count, numbers;              /* numbers: how many coordinates there are */
  PetscReal at[(PLACES_MOST + 1) * DIM]; /* [count][coordinates a place] m; room for one place too many */
} Places;

struct _p_Gauges {
  MPI_Comm         comm;
  PetscMPIInt      rank, size;
  Cloud            cloud;        /* borrowed */
  const Viscosity *viscosity;    /* borrowed; NULL: not known */
  PetscBool        corrected;    /* the gradient of pressure is */
  PetscBool        tension;      /* FIELD_CAPILLARY is the pressure that it puts on the free surface */
  PetscReal        level;        /* m; NAN: not given and not measured */
  PetscBool        level_given;  /* by -gauge_level */
  PetscReal        multiplicity; /* how many copies of the simulated part make the whole */
  PetscReal        connection;   /* spacings, distance within which particles hang together */
  CraterSetup      crater;
  Places           points, heights, lines;
  PetscInt         line_points;
  PetscBool        forces, droplets;
  PetscErrorCode (*refresh)(void *context); /* of GaugesSetRefresh */
  void    *context;
  PetscInt droplet_least; /* particles of the smallest droplet */
};

static inline char AxisName(PetscInt direction)
{
  return "xyz"[direction];
}

/* --- totals.c --- */
/* HeightOverLevel - of liquid whose highest particle is at 'top' (m, -PETSC_MAX_REAL: there is none), m; NAN without
   liquid. A particle stands for a cube of one spacing, so the surface is half a spacing above it. Not collective. */
PetscReal HeightOverLevel(Gauges gauges, PetscReal top);

/* --- sample.c: values at places --- */
/* PlacesCheck - counts the places of an option, of 'width' coordinates each; refuses (UserError) incomplete ones, more
   than 'most', and such as are not in the box. what: "point", ... Collective. */
PetscErrorCode PlacesCheck(Gauges gauges, const char option[], const char what[], PetscInt width, PetscInt most,
                           Places *places);

#define IMAGES_MOST 27 /* of a point: 3 a direction */
/* Where a point is seen from the box: x (m) and the sign of each component of velocities there. */
typedef struct {
  PetscReal x[DIM], sign[DIM];
} PointImage;

/* PointImages - the point at [dim] (m) and those images of it, through periodic faces and mirrors, that are within
   reach (m) of the box; returns how many. Particles near an image are near the point in another copy of the liquid. Not
   collective. */
PetscInt PointImages(Domain domain, const PetscReal at[], PetscReal reach, PointImage image[IMAGES_MOST]);

/* DistanceInside - whether a place with this signed distance (m) from a solid is inside it; on its surface it is not.
   Not collective. */
PetscBool DistanceInside(Gauges gauges, PetscReal distance);
/* PointsSample - pressure (Pa) and velocity (dim components, m/s) at count points at ([count][dim], m) into values
   [count][1 + dim], from the swarm: the Shepard mean sum V W f / sum V W over the fluid within the kernel's support,
   also through periodic faces and mirrors, but not through solids. So a point on a wall or a solid reads the fluid in
   front of it. With no fluid there the pressure is 0, that of the air, and the velocity NAN; inside a solid both are
   NAN. Collective. */
PetscErrorCode PointsSample(Gauges gauges, PetscInt count, const PetscReal at[], PetscReal values[]);

/* --- connect.c: what hangs together --- */
/* ConnectedLabels - label [n_total of the cloud]: of owned fluid particles, the smallest id among those that they hang
   together with by steps shorter than -gauge_connection. The cloud must be in step with the swarm. Collective. */
PetscErrorCode ConnectedLabels(Gauges gauges, PetscReal label[]);
/* ConnectedWithBody - connected [n_fluid of the cloud]: whether a particle hangs together with the deepest one of a
   body. The cloud must be in step with the swarm. Collective. */
PetscErrorCode ConnectedWithBody(Gauges gauges, PetscInt body, PetscBool connected[]);

/* --- crater_setup.c --- */
/* GaugeBodyBounds - of a body, cut by the box, m. CraterMirrors - how many symmetry faces hold the axis. Not
   collective. */
void     GaugeBodyBounds(Gauges gauges, PetscInt body, PetscReal lower[DIM], PetscReal upper[DIM]);
PetscInt CraterMirrors(Gauges gauges);

/* --- crater_grid.c: cells over the fluid: what is connected with the pool, and which surface the sky sees --- */
#define CELL_LIQUID  1  /* holds fluid */
#define CELL_BODY    2  /* holds fluid of the pool's body */
#define CELL_VISITED 4  /* by the search for the pool */
#define CELL_POOL    8  /* connected with the pool */
#define CELL_TESTED  16 /* by the search for the sky */

/* Axes 0 and 1 are horizontal, 2 is upwards. Around the fluid is a rim of one empty cell, and on top layers of air. */
typedef struct {
  PetscInt       n[DIM], count, columns; /* rim included; columns = n[0] n[1] */
  PetscInt       component[DIM];         /* of the position; component[1] is the unused third in two dimensions */
  PetscReal      lower[DIM], size;       /* m: of the cell 1,1,1 */
  unsigned char *cell;                   /* [count] */
  PetscInt      *queue;                  /* [count] */
} CraterGrid;

/* CraterGridCreate - occupancy of the fluid of all ranks, and CELL_POOL: the component (26 neighbours) with the most
   cells of the pool's body. Collective. */
PetscErrorCode CraterGridCreate(Gauges gauges, const ParticleArrays *arrays, CraterGrid *grid);
/* CraterGridSky - lowest[c]: layer of the lowest cell of column c that is open to the sky. Columns whose inside[c] is
   false are walls of the sky and get the layer above the top. Not collective. */
void           CraterGridSky(CraterGrid *grid, PetscInt dim, const PetscBool inside[], PetscInt lowest[]);
PetscErrorCode CraterGridDestroy(CraterGrid *grid);

/* CraterGridCell - indices and number of the cell of a point x (m), -1 when it is outside the grid. Not collective. */
static inline PetscInt CraterGridCell(const CraterGrid *grid, const PetscReal x[DIM], PetscInt index[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal s = (x[grid->component[d]] - grid->lower[d]) / grid->size;

    if (!(s > -0.5 && s < (PetscReal)(grid->n[d] - 2))) return -1; /* also for a position that is not a number */
    index[d] = PetscMax((PetscInt)PetscFloorReal(s), 0) + 1;
  }
  return CellIndex(grid->n, index[0], index[1], index[2]);
}

/* CraterGridReach - the block of cells, first to last, that a particle at x (m) of this size (1) covers: that of its
   centre, and if it is larger than the spacing those around that it would be divided over. False where CraterGridCell
   is -1. Not collective. */
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
