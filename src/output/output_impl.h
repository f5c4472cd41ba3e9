/* Private to the folder output. */
#ifndef ISPH_OUTPUT_IMPL_H
#define ISPH_OUTPUT_IMPL_H

#include "../storage/storage.h"
#include "output.h"

/* What is due at multiples of an interval (s). next is the number of the multiple that is due next. */
typedef struct {
  PetscReal  interval;
  PetscInt64 next;
} Schedule;

#define SCHEDULE_UNSET PETSC_MIN_INT

/* A snapshot that is on disk, as the XDMF file needs it. */
typedef struct {
  PetscInt  index, step, n; /* n: number of particles */
  PetscReal time;           /* s */
  PetscInt  precision;      /* bytes of a real number */
  unsigned  fields;         /* bit f: field f of SnapshotFieldAt is in it */
} SnapshotEntry;

/* The fields that a snapshot may have: the stored reals, then id, body, surface, layer, then the colour. */
#define SNAPSHOT_FIELDS (FIELD_STORED_COUNT + 5)
typedef struct {
  const char *name, *unit, *meaning;
  PetscInt    width;   /* numbers a particle */
  PetscInt    integer; /* the IntFieldId; INT_COUNT: the colour; -1: a real field */
} SnapshotField;

/* What goes into the snapshots. */
typedef struct {
  char     *name[SNAPSHOT_FIELDS + 1]; /* as the user gave them; [names] */
  PetscInt  names;
  unsigned  fields;             /* bits, as in SnapshotEntry */
  PetscBool region;             /* only particles in lower .. upper */
  PetscInt  numbers[2];         /* how many the user gave */
  PetscReal corner[2][DIM + 1]; /* m: lower, upper; one more than wanted, to notice it */
  PetscInt  compression;        /* HDF5's deflate, 0 to 9 */
  PetscBool walls, precise;     /* wall particles too; double precision */
} SnapshotSetup;

/* How the gauges measure. */
typedef struct {
  char      pool_name[256];
  PetscInt  pool;          /* index of the body that is the pool */
  PetscInt  axis_numbers;  /* how many numbers the user gave for the axis */
  PetscReal level;         /* m; NAN: measured at the first call */
  PetscReal axis[DIM];     /* m, horizontal */
  PetscReal jet_radius;    /* m */
  PetscReal crater_radius; /* m, the crater is looked for inside */
  PetscReal cell;          /* in spacings, of the grid that tells liquid from air */
  PetscReal connection;    /* in spacings, distance within which particles hang together */
  PetscReal multiplicity;  /* 1 */
} GaugeSetup;

#define GAUGE_POINTS_MOST 64

/* Points of which the series holds pressure and velocity. */
typedef struct {
  PetscInt  count, numbers;                    /* numbers: how many the user gave */
  PetscReal at[(GAUGE_POINTS_MOST + 1) * DIM]; /* [count][dim] m */
} GaugePoints;

#define GAUGE_HEIGHTS_MOST 64
#define GAUGE_LINES_MOST   16

/* What further gauges measure. */
typedef struct {
  PetscInt  heights, height_numbers;
  PetscReal height_at[(GAUGE_HEIGHTS_MOST + 1) * (DIM - 1)]; /* [heights][dim - 1] m */
  PetscInt  lines, line_numbers, line_points;
  PetscReal line_at[(GAUGE_LINES_MOST + 1) * 2 * DIM]; /* [lines][2][dim] m */
  PetscBool forces, droplets;
  PetscInt  droplet_least;            /* particles of a droplet */
  FILE     *line_file, *droplet_file; /* rank 0 */
} GaugeProbes;

struct _p_Output {
  MPI_Comm       comm;
  PetscMPIInt    rank, size;
  Cloud          cloud; /* borrowed */
  char           folder[PETSC_MAX_PATH_LEN];
  char          *options; /* the user's, one a line, before solvers add defaults of their own */
  PetscBool      overwrite, ready, restarting, solids; /* solids: they are written */
  Schedule       series, snapshot, checkpoint;
  SnapshotSetup  content;
  PetscInt       series_step, snapshot_step; /* of the last line and the last snapshot; -1: none */
  FILE          *series_file;                /* rank 0 */
  SnapshotEntry *entry;                      /* [entries], the same on every rank */
  PetscInt       entries, entry_capacity;
  PetscReal      wall_start, wall_before; /* s: MPI_Wtime at the start; spent before the restart */
  GaugeSetup     gauge;
  GaugePoints    points;
  GaugeProbes    probes;
};

/* --- output.c --- */
/* OutputPath - <folder>/<name>. Not collective. */
PetscErrorCode OutputPath(Output output, const char name[], char path[PETSC_MAX_PATH_LEN]);
PetscReal      OutputWallTime(Output output);
PetscInt64     ScheduleAfter(const Schedule *schedule, PetscReal time);
PetscBool      ScheduleReached(const Schedule *schedule, PetscReal time);

/* --- folder.c --- */
/* FolderStatus - rank 0's errno decides for all: a UserError "Cannot <doing> <path>: <reason>" unless it is zero.
 * Collective. */
PetscErrorCode FolderStatus(Output output, int error, const char doing[], const char path[]);
/* FolderMake - the run folder and its parents. FolderClaim - refuses or clears one that holds a run; writes
   options.opts and version.txt; 'same': the run in it is continued. Collective. */
PetscErrorCode FolderMake(Output output);
PetscErrorCode FolderClaim(Output output, PetscBool same);
/* FolderNumbers - the numbers in the names <prefix><digits>.h5 present, ascending, in an array to be freed. Rank 0
 * only. */
PetscErrorCode FolderNumbers(Output output, const char prefix[], PetscInt *count, PetscInt **numbers);
/* FolderCommit - gives a finished file (written as <name>.tmp) its name; sync: after it has reached the disk.
 * Collective. */
PetscErrorCode FolderCommit(Output output, const char name[], PetscBool sync);
/* FolderDiscard - removes <name>.tmp. Collective. */
PetscErrorCode FolderDiscard(Output output, const char name[]);
/* FolderOptions - the options of the run as text, one a line; to be freed. Not collective. */
PetscErrorCode FolderOptions(char **text);

/* --- series.c --- */
PetscErrorCode SeriesStart(Output output, PetscBool same, PetscInt restart_step);
PetscErrorCode SeriesWrite(Output output, const StepState *state);
/* GaugeUnit - a unit of three dimensions in those of the scene: J, N and m3 are J/m, N/m and m2 in two. Not collective.
 */
const char *GaugeUnit(Output output, const char unit[]);

/* --- content.c --- */
/* SnapshotSetFromOptions - inside an options block; SnapshotCheck - refuses bad values, after it. Collective. */
PetscErrorCode SnapshotSetFromOptions(Output output, OptionItems PetscOptionsObject);
PetscErrorCode SnapshotCheck(Output output);
PetscErrorCode SnapshotView(Output output, PetscViewer viewer);
/* SnapshotFieldAt - field f of 0 .. SNAPSHOT_FIELDS - 1. Not collective. */
SnapshotField SnapshotFieldAt(PetscInt f);

/* --- snapshot.c --- */
/* SnapshotName - the name of the file with an index. Not collective. */
void SnapshotName(PetscInt index, char name[64]);
/* SnapshotScan - finds the snapshots of the folder up to a step and removes later ones. Collective. */
PetscErrorCode SnapshotScan(Output output, PetscInt restart_step);
PetscErrorCode SnapshotWrite(Output output, const StepState *state);
/* SolidsWrite - the dummy particles of solids, which do not move, into solids.h5: for pictures. Collective. */
PetscErrorCode SolidsWrite(Output output);

/* --- gauge_setup.c --- */
PetscErrorCode GaugesDefaults(Output output);
/* GaugesSetFromOptions - inside an options block; GaugesCheck - refuses bad values, after it. */
PetscErrorCode GaugesSetFromOptions(Output output, OptionItems PetscOptionsObject);
PetscErrorCode GaugesCheck(Output output);
/* GaugeBodyBounds - of a body, cut by the box, m. GaugeMirrors - how many symmetry faces hold the axis. Not collective.
 */
void     GaugeBodyBounds(Output output, PetscInt body, PetscReal lower[DIM], PetscReal upper[DIM]);
PetscInt GaugeMirrors(Output output);

/* --- gauge_points.c --- */
/* PointsSetFromOptions - inside an options block; PointsCheck - refuses bad values, after it. Collective. */
PetscErrorCode PointsSetFromOptions(Output output, OptionItems PetscOptionsObject);
PetscErrorCode PointsCheck(Output output);
/* PointsColumns - how many columns the points have. PointsName - the name of one, with its unit. Not collective. */
PetscInt       PointsColumns(Output output);
PetscErrorCode PointsName(Output output, PetscInt column, char name[], size_t length);

/* PointsSample - as OutputPoints, at count points at ([count][dim], m); values [count][1 + dim]. Collective. */
PetscErrorCode PointsSample(Output output, PetscInt count, const PetscReal at[], PetscReal values[]);

#define IMAGES_MOST 27 /* of a point: 3 a direction */
/* Where a point is seen from the box: x (m) and the sign of each component of velocities there. */
typedef struct {
  PetscReal x[DIM], sign[DIM];
} PointImage;

/* PointImages - the point at [dim] (m) and those images of it, through periodic faces and mirrors, that are within
   reach (m) of the box, and how many: particles near an image are near the point in another copy of the liquid. Not
   collective. */
PetscInt PointImages(Domain domain, const PetscReal at[], PetscReal reach, PointImage image[IMAGES_MOST]);

/* --- gauge_heights.c --- */
/* HeightsMeasure - height [heights] (m) of the liquid that stands on the vertical through each place of -gauge_heights:
   going up, where the liquid's share of the space, sum V W over it against 1 - sum V W over walls and solids, falls
   below a half, unless it comes back within a spacing. The bottom of the box where there is none. Collective. */
PetscErrorCode HeightsMeasure(Output output, PetscReal height[]);

/* --- gauge_probes.c: surface heights, lines, forces on walls and solids, droplets --- */
/* ProbesSetFromOptions - inside an options block; ProbesCheck - refuses bad values, after it. Collective. */
PetscErrorCode ProbesSetFromOptions(Output output, OptionItems PetscOptionsObject);
PetscErrorCode ProbesCheck(Output output);
/* ProbesColumns - how many columns of the series they have. ProbesName - the name of one, with its unit. Not
 * collective. */
PetscInt       ProbesColumns(Output output);
PetscErrorCode ProbesName(Output output, PetscInt column, char name[], size_t length);
/* ProbesMeasure - values [ProbesColumns]. Collective. */
PetscErrorCode ProbesMeasure(Output output, PetscReal values[]);
/* ProbesStart - opens lines.csv and droplets.csv as SeriesStart does the series; ProbesWrite - adds the state to them;
   ProbesFinish - closes them. Collective. */
PetscErrorCode ProbesStart(Output output, PetscBool same, PetscInt restart_step);
PetscErrorCode ProbesWrite(Output output, const StepState *state);
PetscErrorCode ProbesFinish(Output output);
/* --- gauge_forces.c --- */
/* ForcesCount - walls of the box and solids. ForcesName - xmin, ..., zmax or the solid's. ForcesMeasure - force
   [count][dim] of the liquid's pressure on each, N (N/m in two dimensions): -sum V_a V_b (p_a + p_b) grad W over pairs
   of fluid a and dummy b (as Adami et al. 2012 for the fluid). Collective. */
PetscInt       ForcesCount(Output output);
const char    *ForcesName(Output output, PetscInt index);
PetscErrorCode ForcesMeasure(Output output, PetscReal force[]);
/* --- gauge_droplets.c --- */
/* A piece of liquid: particles that hang together. */
typedef struct {
  PetscReal label, particles, place[DIM], velocity[DIM]; /* label: smallest id; mean place (m) and velocity (m/s) */
} Piece;

/* DropletsFind - all pieces, the largest first, on rank 0, to be freed with PetscFree; elsewhere none. Collective. */
PetscErrorCode DropletsFind(Output output, PetscInt *count, Piece **piece);

/* --- series.c, for tables that grow line by line and whose first columns are time and step --- */
/* TableStart - opens <folder>/<name> to append, with the head line if it is new, cut behind restart_step if 'same';
 *last: the step of its last line or -1. Collective. */
PetscErrorCode TableStart(Output output, const char name[], const char head[], PetscBool same, PetscInt restart_step,
                          FILE **file, PetscInt *last);

/* --- paraview.c --- */
/* XdmfWrite - snapshots.xdmf, which names all snapshots on disk as one series; replaces the old one at once.
   Collective. VtkWrite - makes an open snapshot with all its fields a VTKHDF file of points too (the group VTKHDF,
   whose data sets are links to the fields), which VTK 9.1 and ParaView 5.10 and later read. Collective. */
PetscErrorCode XdmfWrite(Output output);
PetscErrorCode VtkWrite(H5File *h5, const SnapshotEntry *entry);

/* --- gauge_grid.c: what is connected with the pool, and the surface seen from the sky --- */
#define CELL_LIQUID  1 /* holds fluid */
#define CELL_BODY    2 /* holds fluid of the pool's body */
#define CELL_VISITED 4
#define CELL_POOL    8  /* connected with the pool */
#define CELL_AIR     16 /* connected with the sky through gaps two cells wide */
#define CELL_TESTED  32

/* Cells over the fluid, with a rim of one empty cell around and layers of air on top. Axes 0 and 1 are horizontal, 2 is
 * upwards. */
typedef struct {
  PetscInt       n[DIM], count, columns; /* rim included; columns = n[0] n[1] */
  PetscInt       component[DIM];         /* of the position; component[1] is the unused third in two dimensions */
  PetscReal      lower[DIM], size;       /* m: of the cell 1,1,1 */
  unsigned char *cell;                   /* [count] */
  PetscInt      *queue;                  /* [count] */
} GaugeGrid;

/* GaugeLabels - FIELD_WORK1 of owned fluid: the smallest id of what it hangs together with by steps below 'distance'
   (m). The cloud must be in step with the swarm. Collective. */
PetscErrorCode GaugeLabels(Output output, PetscReal distance);
/* GaugeConnected - connected[n_fluid of the cloud]: whether a chain of fluid particles, each closer than 'distance' (m)
   to the next, joins it with the pool. The cloud must be in step with the swarm. Collective. */
PetscErrorCode GaugeConnected(Output output, PetscReal distance, PetscBool connected[]);
/* GaugeGridCreate - occupancy of the fluid of all ranks. Collective. */
PetscErrorCode GaugeGridCreate(Output output, const ParticleArrays *arrays, GaugeGrid *grid);
/* GaugeGridPool - marks CELL_POOL: the component (26 neighbours) with the most cells of the pool's body. Not
 * collective. */
void GaugeGridPool(GaugeGrid *grid);
/* GaugeGridSky - lowest[c] = layer of the lowest cell of column c that is open to the sky; columns whose inside[c] is
   false are walls of the sky and get the layer above the top. Not collective. */
void           GaugeGridSky(GaugeGrid *grid, PetscInt dim, const PetscBool inside[], PetscInt lowest[]);
PetscErrorCode GaugeGridDestroy(GaugeGrid *grid);

/* GaugeGridCell - indices and number of the cell of a point x (m), -1 when it is outside the grid. */
static inline PetscInt GaugeGridCell(const GaugeGrid *grid, const PetscReal x[DIM], PetscInt index[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal s = (x[grid->component[d]] - grid->lower[d]) / grid->size;

    if (!(s > -0.5 && s < (PetscReal)(grid->n[d] - 2))) return -1; /* also for a position that is not a number */
    index[d] = PetscMax((PetscInt)PetscFloorReal(s), 0) + 1;
  }
  return (index[2] * grid->n[1] + index[1]) * grid->n[0] + index[0];
}

#endif
