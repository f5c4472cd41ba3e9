/* Floor 7: gauges measure the particles: energies and volume; crown, crater and jet of an impact; pressure and velocity
   at points and along lines; heights of the free surface; forces on walls and solids; what is wetted; droplets, necks.

   A gauge fills columns of the time series, rows of a table of its own, or both. The output writes them. */
#ifndef ISPH_GAUGES_H
#define ISPH_GAUGES_H

#include "../operators/operators.h"
#include "../pressure/pressure.h"

typedef struct _p_Gauges *Gauges;

/* Sums over the fluid of the simulated part; times the multiplicity they are those of the whole. Units: J and m3, in
   two dimensions J/m and m2. */
typedef struct {
  PetscReal kinetic_energy;   /* sum of m v^2/2 */
  PetscReal potential_energy; /* sum of m times the potential of the body force */
  PetscReal volume;           /* of all particles */
  PetscReal multiplicity;     /* -gauge_multiplicity: copies of the part in the whole */
  PetscReal highest;          /* m, height of the highest liquid over the level (GaugesLevel); NAN without liquid */
  PetscInt  particles;        /* in the simulated part */
} GaugeTotals;

/* --- a column of a table, or a field of a snapshot, as a row --- */

/* What its number counts. */
typedef enum {
  COUNTS_RUN,   /* the computation: steps, particles, seconds of the machine; another spacing or half of the scene has
                   another number */
  COUNTS_VALUE, /* an intensive quantity, or the largest or smallest of something: the same of a part as of the whole */
  COUNTS_SUM    /* an extensive quantity: mirrors and copies multiply it; per metre in a plane, around the ring of rings
                 */
} ColumnCounts;
/* Of what it is. */
typedef enum {
  OF_SCENE,    /* of all liquid, or of the run */
  OF_RECEIVER, /* of a wall face of the box or a solid */
  OF_PIECE,    /* of a connected piece of liquid, its mirror images included */
  OF_PLACE,    /* of a point, a line or a vertical */
  OF_PARTICLE
} ColumnOf;
/* What it needs to have a meaning, bits. */
#define NEEDS_GRAVITY   1U
#define NEEDS_TENSION   2U
#define NEEDS_VISCOSITY 4U
#define NEEDS_PRESSURE  8U  /* of a step ... */
#define NEEDS_STEP      16U /* ... or what else it leaves: series and tables have nan before the first step */
#define COLUMN_NEEDS    5   /* that have a word */
#define NEEDS_PAST      32U /* all steps before: a sum over them */

#define COLUMN_NAME_LENGTH 64
typedef struct {
  char         name[COLUMN_NAME_LENGTH]; /* without the unit */
  const char  *unit;                     /* in three dimensions; NULL: a pure number */
  ColumnCounts counts;
  ColumnOf     of;
  PetscInt     index;     /* which receiver: the wall faces of the box, then -solids; which place */
  char         component; /* of a vector: 'x', 'y', 'z'; 0: it is no component */
  unsigned     needs;
} Column;
/* A row in words. */
typedef struct {
  char        head[COLUMN_NAME_LENGTH + 16]; /* as the file has it: name and unit, "kinetic_energy_J/m" */
  const char *unit;                          /* in the scene's dimensions; "": a pure number */
  const char *counts;                        /* "run", "value", "sum" */
  const char *of, *whose; /* "scene", "face", "solid", "piece", "place", "particle"; "xmin", a solid's name, "" */
  const char *direction;  /* "x", "y", "z"; of rings "radial", "axial"; "": no component */
  const char *extent;     /* of a sum: "whole", "per metre", "around the ring"; else "" */
  const char *needs[COLUMN_NEEDS + 1]; /* "gravity", ...; the last is NULL */
} ColumnWords;

/* GaugesCreate - makes the gauges of a cloud (borrowed). The scene must know its bodies. Collective. */
PetscErrorCode GaugesCreate(Cloud cloud, Gauges *gauges);
/* GaugesSetForces - tells how the run computes the forces on walls. viscosity (borrowed): its friction is included.
   pressure (borrowed): its gradient, and what presses on dry walls; NULL: the gradient is corrected, nothing does, and
   roughness is NAN. tension: surface tension sets FIELD_CAPILLARY, and the gauge adds its force at contact lines. Not
   collective. */
void GaugesSetForces(Gauges gauges, const Viscosity *viscosity, Pressure pressure, PetscBool tension);
/* GaugesSetRun - tells what moves the particles (borrowed), for the gauges in folders of its edges. Not collective. */
void GaugesSetRun(Gauges gauges, void *run);
/* GaugesSetRefresh - GaugesMeasure calls refresh(context) (borrowed) when a gauge needs sums over neighbours and the
   cloud holds sums of another order of the particles. The call computes the sums from the stored fields. The gauge then
   has the value that a restart from this state would give. Not collective. */
void GaugesSetRefresh(Gauges gauges, PetscErrorCode (*refresh)(void *context), void *context);
/* GaugesSetFromOptions - reads all options -gauge_...; refuses (UserError) values out of range. Collective. */
PetscErrorCode GaugesSetFromOptions(Gauges gauges);
PetscErrorCode GaugesDestroy(Gauges *gauges);

/* GaugesTotals - sums over the particles of the swarm. Collective. */
PetscErrorCode GaugesTotals(Gauges gauges, GaugeTotals *totals);
/* GaugesLevel - height (m) of the undisturbed free surface: -gauge_level; else, with -gauge_crater, the level measured
   at the first state (NAN before); else 0. GaugesSetLevel - sets the level that the run had before a restart, unless
   -gauge_level gives it. Not collective. */
PetscReal GaugesLevel(Gauges gauges);
void      GaugesSetLevel(Gauges gauges, PetscReal level);

/* GaugesColumns - the rows of the columns that the gauges add to the series, [count], borrowed; they change with
   GaugesSetForces and GaugesSetFromOptions. Not collective. GaugesMeasure - measures them now, values [count], of the
   whole scene. The first call also measures the level of a crater, unless -gauge_level gives it. Particles and
   neighbour lists must belong to one state. Collective. */
PetscErrorCode GaugesColumns(Gauges gauges, PetscInt *count, const Column *columns[]);
PetscErrorCode GaugesMeasure(Gauges gauges, PetscReal values[]);
/* GaugesColumnWords - a row in words. GaugesFactor - the number by which that of the simulated part becomes that of the
   whole scene of -gauge_multiplicity copies: 1 unless the column is a sum. Each mirror doubles a face or a solid that
   it cuts, and cancels the component across it; it does not change one whose image is another. Not collective. */
PetscErrorCode GaugesColumnWords(Gauges gauges, const Column *column, ColumnWords *words);
PetscReal      GaugesFactor(Gauges gauges, const Column *column);

/* GaugesTableFile - name of the file of table t of all that gauges may fill; NULL: there is none. Not collective. */
const char *GaugesTableFile(PetscInt t);

#define GAUGE_TABLES_MOST 5
/* GaugesTables - number of tables that the gauges fill, at most GAUGE_TABLES_MOST. GaugesTableColumns - the table's
   file name and the rows of its columns, [count], borrowed. GaugesTableEvents - whether its rows are of the times of
   the series, not of the snapshots. Not collective. GaugesTableRows - measures the rows at this time (s): values
   [count][width] on rank 0, none elsewhere; free them with PetscFree. Collective. */
PetscInt       GaugesTables(Gauges gauges);
PetscBool      GaugesTableEvents(Gauges gauges, PetscInt table);
PetscErrorCode GaugesTableColumns(Gauges gauges, PetscInt table, const char **file, PetscInt *count,
                                  const Column *columns[]);
PetscErrorCode GaugesTableRows(Gauges gauges, PetscInt table, PetscReal time, PetscInt *count, PetscInt *width,
                               PetscReal **values);

#endif
