/* Floor 6: gauges, what is measured on the particles: energies and volume; crown, crater and jet of an impact; pressure
   and velocity at points and along lines; heights of the surface; forces on walls and solids; droplets.

   A gauge gives columns of the time series, or rows of a table of its own, or both; who writes them is no concern of
   the gauges. */
#ifndef ISPH_GAUGES_H
#define ISPH_GAUGES_H

#include "../operators/operators.h"

typedef struct _p_Gauges *Gauges;

/* Sums over the fluid. Energies and volume are those of the simulated part times -gauge_multiplicity, in J and m3 (J/m
   and m2 in two dimensions). */
typedef struct {
  PetscReal kinetic_energy;   /* sum of m v^2/2 */
  PetscReal potential_energy; /* sum of m times the potential of the body force */
  PetscReal volume;           /* particles times V_0 */
  PetscReal multiplicity;     /* -gauge_multiplicity */
  PetscReal highest;          /* m, of the highest liquid over the level (see GaugesLevel); NAN without liquid */
  PetscInt  particles;        /* in the simulated part */
} GaugeTotals;

/* An impact as figure 2 of Kuri et al. (2014) shows it: heights over the level, m, upwards (the last direction of the
   scene). NAN where there is nothing to measure. */
typedef struct {
  PetscReal crown_height;    /* of the highest liquid that hangs together with the pool, outside the jet radius */
  PetscReal crater_depth;    /* of the lowest surface open to the sky inside the crater radius, downwards */
  PetscReal crater_diameter; /* twice the mean radius where the crater's wall crosses the level; 0: no crater */
  PetscReal jet_height;      /* of the highest liquid that hangs together with the pool, within the jet radius of the
                                axis; negative in a crater */
} CraterValues;

/* GaugesCreate - for the particles of a cloud (borrowed), whose scene must know its bodies. Collective. */
PetscErrorCode GaugesCreate(Cloud cloud, Gauges *gauges);
/* GaugesSetForces - the forces on walls hold those of this viscosity (borrowed), too, and are those of a corrected
   gradient of pressure, or of pairs; tension: and the pull of surface tension, whose pressure FIELD_CAPILLARY is. Not
   collective. */
void GaugesSetForces(Gauges gauges, const Viscosity *viscosity, PetscBool corrected, PetscBool tension);
/* GaugesSetRefresh - what GaugesMeasure calls with its context (borrowed) when a gauge needs sums over neighbours and
   the cloud's are of another order of its particles: it computes them anew from the stored fields, so that the gauge
   has the value that the state has in a checkpoint. Not collective. */
void GaugesSetRefresh(Gauges gauges, PetscErrorCode (*refresh)(void *context), void *context);
/* GaugesSetFromOptions - all options -gauge_...; refuses (UserError) values that make no sense. Collective. */
PetscErrorCode GaugesSetFromOptions(Gauges gauges);
PetscErrorCode GaugesView(Gauges gauges, PetscViewer viewer);
PetscErrorCode GaugesDestroy(Gauges *gauges);

/* GaugesTotals - from the swarm. Collective. */
PetscErrorCode GaugesTotals(Gauges gauges, GaugeTotals *totals);
/* GaugesHasCrater - whether -gauge_crater is set. Not collective. */
PetscBool GaugesHasCrater(Gauges gauges);
/* GaugesCrater - from the swarm and the neighbour lists of the cloud, which must be in step; at the first call also
   measures the level unless -gauge_level gives it. Collective. */
PetscErrorCode GaugesCrater(Gauges gauges, CraterValues *values);
/* GaugesLevel - height (m) of the undisturbed surface: that of -gauge_level; else, with -gauge_crater, as measured at
   the first state (NAN before); else 0. GaugesSetLevel - that of an earlier start of the run, unless -gauge_level gives
   it. Not collective. */
PetscReal GaugesLevel(Gauges gauges);
void      GaugesSetLevel(Gauges gauges, PetscReal level);

/* GaugesColumns - how many columns the gauges other than totals and crater add to the series. GaugesColumnName - the
   name of one, with its unit. Not collective. GaugesMeasure - their values of the moment, values [GaugesColumns].
   Collective. */
PetscInt       GaugesColumns(Gauges gauges);
PetscErrorCode GaugesColumnName(Gauges gauges, PetscInt column, char name[], size_t length);
PetscErrorCode GaugesMeasure(Gauges gauges, PetscReal values[]);

#define GAUGE_TABLES_MOST 2
/* GaugesTables - how many tables of their own the gauges fill, at most GAUGE_TABLES_MOST. GaugesTableHead - the name of
   the table's file and the names of its columns, separated by commas. Not collective. GaugesTableRows - the rows of the
   moment, values [count][width] on rank 0, to be freed with PetscFree; elsewhere none. Collective. */
PetscInt       GaugesTables(Gauges gauges);
PetscErrorCode GaugesTableHead(Gauges gauges, PetscInt table, const char **file, char head[], size_t length);
PetscErrorCode GaugesTableRows(Gauges gauges, PetscInt table, PetscInt *count, PetscInt *width, PetscReal **values);

/* GaugeUnit - a unit of three dimensions in those of the scene: J, N and m3 are J/m, N/m and m2 in two dimensions. Not
   collective. */
const char *GaugeUnit(Domain domain, const char unit[]);

#endif
