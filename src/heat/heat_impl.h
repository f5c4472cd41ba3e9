/* Private to heat/: scalars that liquid carries and that spread in it, temperature and concentration. */
#ifndef ISPH_HEAT_IMPL_H
#define ISPH_HEAT_IMPL_H

#include "../gauges/columns.h"
#include "../neighbors/pairs.h"
#include "../stepper/edge.h"

#define HEAT_OPTION "-<body>_temperature"

/* What a body has of a scalar, a property. Concentrations have the conductivity D (m2/s). */
typedef struct {
  PetscReal start, slope[DIM];      /* at the start: at the origin, 0: none; and its gradient, 1/m */
  PetscReal conductivity, capacity; /* W/(m K), J/(kg K) */
} BodyScalar;

/* What the liquid meets at a face or a solid: a value, or a flux into the liquid (W/m2). */
typedef struct {
  PetscReal value, flux;
  PetscBool holds; /* a value */
} Side;

/* What it meets at the free surface. */
typedef struct {
  PetscReal transfer, ambient; /* W/(m2 K), K */
} Air;

/* A scalar as a row. The amount of it in liquid is its value times m c (by mass) or times V. */
typedef struct {
  const char     *name, *unit, *amount, *amount_unit, *flow_unit;
  FieldId         field;
  PetscBool       by_mass;
  const Property *body, *face, *solid, *air; /* air NULL: none passes the free surface */
} Scalar;
#define SCALARS 2
extern const Scalar   Scalars[SCALARS];
extern const Property HeatProperties[];
#define HEAT_TEMPERATURE (&Scalars[0])

/* ScalarOn - whether a scene has the scalar; HeatOn, ConcentrationOn - the same of each, as fields and features ask.
   ScalarOf - of a body. SideOf - of a receiver: 2 d + side of a face, then the solids; NULL: insulated. Not collective.
 */
PetscBool         ScalarOn(Scene scene, const Scalar *scalar);
PetscBool         HeatOn(Scene scene, Tension tension);
PetscBool         ConcentrationOn(Scene scene, Tension tension);
const BodyScalar *ScalarOf(Scene scene, const Scalar *scalar, PetscInt body);
const Side       *SideOf(Scene scene, const Scalar *scalar, PetscInt receiver);
/* ScalarStore - what fluid particle a takes up (J/K), mass times capacity; of a concentration its volume (m3). Not
   collective. */
PetscReal ScalarStore(Cloud cloud, const Scalar *scalar, PetscInt a);

/* What a particle exchanges with a receiver: inflow - conductance T (W). */
#define RECEIVERS (2 * DIM + SCENE_MAX_BODIES + 1) /* faces, solids, and the air */
#define OF_AIR    (RECEIVERS - 1)
typedef struct {
  PetscInt  a, receiver;
  PetscReal inflow, conductance; /* W, W/K */
} HeatExchange;

/* How a scalar spreads at the positions of a search. */
typedef struct {
  PetscReal    *pair; /* [pairs of the fluid] what a pair conducts, W/K */
  PetscInt64    capacity;
  HeatExchange *exchange; /* [count] */
  PetscInt      count, room;
  PetscReal     fastest; /* bound of the eigenvalues of this rank, 1/s */
} HeatSpread;

/* SpreadFind - finds pairs and exchanges at the positions of the last search. SpreadStep - the field of the scalar
   after dt (s); gained[]: what each receiver gave this rank's liquid, J. Insulated, the sum of all amounts stays, to
   rounding. SpreadFlows - what each receiver gives this rank's liquid now, W. SpreadShift - what particles carry after
   they have been moved relative to the liquid by moved ([n_fluid][3], m): that of the liquid where they are; amounts
   stay, and no value leaves the range of the neighbours. Needs SpreadFind. Collective. SpreadFree - not collective. */
PetscErrorCode SpreadFind(HeatSpread *spread, Cloud cloud, const Scalar *scalar);
PetscErrorCode SpreadStep(HeatSpread *spread, Cloud cloud, const Scalar *scalar, PetscReal dt,
                          PetscReal gained[RECEIVERS]);
void           SpreadFlows(const HeatSpread *spread, const PetscReal T[], PetscReal flow[RECEIVERS]);
PetscErrorCode SpreadShift(Cloud cloud, const Scalar *scalar, const PetscReal moved[]);
PetscErrorCode SpreadFree(HeatSpread *spread);

extern const GaugeKind GaugeScalars;

#endif
