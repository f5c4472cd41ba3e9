/* Floor 8: contact lines in a step, an edge. */
#ifndef ISPH_LINES_H
#define ISPH_LINES_H

#include "../gauges/columns.h"
#include "../tension/lines.h"

/* Capillary number from which the angle of a line differs by ten degrees or more from that at rest; lines with their
   angle at rest are watched until one is so fast. */
#define FAST_LINE 0.01

/* LinesResist - reduces the velocities v ([n_fluid][3], m/s) after the pressure by the resistance of contact lines with
   hysteresis in dt (s); adds its work (J) to *work. Not collective. */
PetscErrorCode LinesResist(Tension tension, Cloud cloud, PetscReal dt, PetscReal v[], PetscReal *work);
/* LinesMove - the change of FIELD_LINE in dt (s), after TensionApply, with a law. LinesFastest - the largest capillary
   number mu U/sigma of a contact line on this rank, at the last TensionApply; 0 unless the liquid meets a wall.
   LineBend - Ca L of a line with a capillary number Ca beside a particle of this size (1), with the data of the lines.
   Not collective. */
void                   LinesMove(Tension tension, Cloud cloud, PetscReal dt);
PetscReal              LinesFastest(Tension tension);
PetscReal              LineBend(const void *data, PetscReal spacing, PetscReal size, PetscReal capillary);
extern const GaugeKind GaugeSpread; /* spread.c */

#endif
