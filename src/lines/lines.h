/* Floor 8: contact lines in a step, an edge. */
#ifndef ISPH_LINES_H
#define ISPH_LINES_H

#include "../gauges/columns.h"
#include "../tension/tension.h"

/* LinesResist - reduces the velocities v ([n_fluid][3], m/s) after the pressure by the resistance of contact lines with
   hysteresis in dt (s); adds its work (J) to *work. Not collective. */
PetscErrorCode         LinesResist(Tension tension, Cloud cloud, PetscReal dt, PetscReal v[], PetscReal *work);
extern const GaugeKind GaugeSpread; /* spread.c */

#endif
