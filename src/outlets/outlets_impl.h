/* Private to outlets/: open faces with a pressure outside, an edge of the step. */
#ifndef ISPH_OUTLETS_IMPL_H
#define ISPH_OUTLETS_IMPL_H

#include "../gauges/columns.h"
#include "../stepper/edge.h"

/* The outside of an open face, a property of the face. */
typedef struct {
  PetscBool on, has_level;
  PetscReal level, pressure; /* m, against gravity; Pa, over that of the open air */
} Outlet;

/* The numbers of the edge in a StepState. */
typedef struct {
  PetscReal work;          /* done by the pressure outside on the liquid, J */
  PetscReal left[2 * DIM]; /* volume that left through each face that is an outlet, m3 */
  PetscReal
    push[2 * DIM]; /* work by which its outside has pushed the surface in, J: as it comes back it gives it back */
} OutletNumbers;

/* The sums of the edge in a trial; of each face: load, the force of its outside (N); against, its work on what left,
   with the other sign (J). */
typedef struct {
  OutletNumbers now;
  PetscReal     load[2 * DIM], against[2 * DIM];
} OutletSums;

/* The data of the edge. */
typedef struct {
  Cloud         cloud;    /* borrowed */
  Pressure      pressure; /* borrowed */
  PetscBool     frozen;
  const Outlet *face[DIM][2];          /* borrowed */
  PetscReal     gravity[DIM], density; /* m/s2, kg/m3 */
  PetscReal     speed;                 /* m/s, that the largest pressure outside can give */
  PetscInt      higher;                /* the first outlet through which liquid would enter, from 1 on; 0: none */
  OutletNumbers so_far;                /* a copy of the state's */
} Outlets;

/* OutletOutside - the pressure (Pa) outside a face at the foot of x (m), less what holds a surface that stands off it
   by 'gap' (m); slope: that along the face (Pa/m), or NULL. OutletsPressure - the pressure (Pa) outside the surface of
   fluid particle a, 0 if no outlet is near; adds its slope along the surface (Pa/m) to 'slope' unless this is NULL.
   OutletsFacing - the outlet that the surface of fluid particle a looks at most, 2 d + side; -1: none.
   Not collective. OutletsCalm
   - brings the velocities v ([n_total][3], m/s, not yet of ghosts) of what has a pressure outside closer to the mean
   around, in the time in which 'speed' moves it by a spacing; adds the energy (J) that this
   gives to *energy. Collective. */
PetscReal      OutletOutside(const Outlets *outlets, PetscInt d, PetscInt side, const PetscReal x[DIM], PetscReal gap,
                             PetscReal slope[DIM]);
PetscInt       OutletsFacing(const Outlets *outlets, PetscInt a);
PetscReal      OutletsPressure(const Outlets *outlets, PetscInt a, PetscReal slope[DIM]);
PetscErrorCode OutletsCalm(const Outlets *outlets, PetscReal dt, PetscReal v[], PetscReal *energy);

extern const LowRank   OutletTerm;   /* its context is an Outlets */
extern const GaugeKind GaugeOutlets; /* gauge.c */

#endif
