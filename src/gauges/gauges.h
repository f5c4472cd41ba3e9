/* Floor 6: gauges measure the particles: energies and volume; crown, crater and jet of an impact; pressure and velocity
   at points and along lines; heights of the free surface; forces on walls and solids; what is wetted; droplets, necks.

   A gauge fills columns of the time series, rows of a table of its own, or both. The output writes them. */
#ifndef ISPH_GAUGES_H
#define ISPH_GAUGES_H

#include "../operators/operators.h"

typedef struct _p_Gauges *Gauges;

/* Sums over the fluid. Energies and volume are multiplied by -gauge_multiplicity. Units: J and m3, in two dimensions
   J/m and m2. */
typedef struct {
  PetscReal kinetic_energy;   /* sum of m v^2/2 */
  PetscReal potential_energy; /* sum of m times the potential of the body force */
  PetscReal volume;           /* of all particles */
  PetscReal multiplicity;     /* -gauge_multiplicity */
  PetscReal highest;          /* m, height of the highest liquid over the level (GaugesLevel); NAN without liquid */
  PetscInt  particles;        /* in the simulated part */
} GaugeTotals;

/* Crown, crater and jet of an impact as in figure 2 of Kuri et al. (2014). Heights count from the level, m, along the
   last direction of the scene. NAN: nothing to measure. */
typedef struct {
  PetscReal crown_height;    /* highest liquid connected with the pool, outside the jet radius */
  PetscReal crater_depth;    /* lowest free surface below the open sky, inside the crater radius; positive downwards */
  PetscReal crater_diameter; /* twice the mean radius at which the crater's wall crosses the level; 0: no crater */
  PetscReal jet_height;      /* highest liquid connected with the pool, inside the jet radius; negative in a crater */
} CraterValues;

/* GaugesCreate - makes the gauges of a cloud (borrowed). The scene must know its bodies. Collective. */
PetscErrorCode GaugesCreate(Cloud cloud, Gauges *gauges);
/* GaugesSetForces - tells how the run computes the forces on walls. viscosity (borrowed): its friction is included.
   corrected: the pressure gradient is corrected; else it is a sum of pair forces. tension: surface tension sets
   FIELD_CAPILLARY, and the gauge adds its force at contact lines. Not collective. */
void GaugesSetForces(Gauges gauges, const Viscosity *viscosity, PetscBool corrected, PetscBool tension);
/* GaugesSetRefresh - GaugesMeasure calls refresh(context) (borrowed) when a gauge needs sums over neighbours and the
   cloud holds sums of another order of the particles. The call computes the sums from the stored fields. The gauge then
   has the value that a restart from this state would give. Not collective. */
void GaugesSetRefresh(Gauges gauges, PetscErrorCode (*refresh)(void *context), void *context);
/* GaugesSetFromOptions - reads all options -gauge_...; refuses (UserError) values out of range. Collective. */
PetscErrorCode GaugesSetFromOptions(Gauges gauges);
PetscErrorCode GaugesView(Gauges gauges, PetscViewer viewer);
PetscErrorCode GaugesDestroy(Gauges *gauges);

/* GaugesTotals - sums over the particles of the swarm. Collective. */
PetscErrorCode GaugesTotals(Gauges gauges, GaugeTotals *totals);
/* GaugesHasCrater - whether -gauge_crater is set. Not collective. */
PetscBool GaugesHasCrater(Gauges gauges);
/* GaugesCrater - measures the impact on the swarm and the cloud's neighbour lists, which must belong to one state. The
   first call also measures the level, unless -gauge_level gives it. Collective. */
PetscErrorCode GaugesCrater(Gauges gauges, CraterValues *values);
/* GaugesLevel - height (m) of the undisturbed free surface: -gauge_level; else, with -gauge_crater, the level measured
   at the first state (NAN before); else 0. GaugesSetLevel - sets the level that the run had before a restart, unless
   -gauge_level gives it. Not collective. */
PetscReal GaugesLevel(Gauges gauges);
void      GaugesSetLevel(Gauges gauges, PetscReal level);

/* GaugesColumns - number of columns that the gauges add to the series, besides totals and crater. GaugesColumnName -
   name of a column, with its unit. Not collective. GaugesMeasure - measures them now, values [GaugesColumns].
   Collective. */
PetscInt       GaugesColumns(Gauges gauges);
PetscErrorCode GaugesColumnName(Gauges gauges, PetscInt column, char name[], size_t length);
PetscErrorCode GaugesMeasure(Gauges gauges, PetscReal values[]);

#define GAUGE_TABLES_MOST 4
/* GaugesTables - number of tables that the gauges fill, at most GAUGE_TABLES_MOST. GaugesTableHead - the table's file
   name, and its column names separated by commas. GaugesTableEvents - whether its rows are of the times of the series,
   not of the snapshots. Not collective. GaugesTableRows - measures the rows at this time (s): values
   [count][width] on rank 0, none elsewhere; free them with PetscFree. Collective. */
PetscInt       GaugesTables(Gauges gauges);
PetscBool      GaugesTableEvents(Gauges gauges, PetscInt table);
PetscErrorCode GaugesTableHead(Gauges gauges, PetscInt table, const char **file, char head[], size_t length);
PetscErrorCode GaugesTableRows(Gauges gauges, PetscInt table, PetscReal time, PetscInt *count, PetscInt *width,
                               PetscReal **values);

/* GaugeUnit - the unit in the dimensions of the scene: J, N and m3 become J/m, N/m and m2 in two dimensions,
   m2 becomes m. Not
   collective. */
const char *GaugeUnit(Domain domain, const char unit[]);

#endif
