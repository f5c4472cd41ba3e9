/* Private to heat/. */
#ifndef ISPH_HEAT_IMPL_H
#define ISPH_HEAT_IMPL_H

#include "../gauges/columns.h"
#include "../stepper/edge.h"

/* What a body has of heat, a property. */
typedef struct {
  PetscReal temperature;            /* K, at the start; 0: none */
  PetscReal conductivity, capacity; /* W/(m K), J/(kg K) */
} BodyHeat;

/* HeatOf - of a body of the scene. HeatOn - whether a scene has temperatures. Not collective. */
const BodyHeat *HeatOf(Scene scene, PetscInt body);
PetscBool       HeatOn(Scene scene, Tension tension);
/* HeatSpread - conducts for dt (s) in the fluid at the positions of the last search: FIELD_TEMPERATURE. Walls and free
   surfaces are insulated: the sum of m c T over all ranks stays, to rounding. Collective. */
PetscErrorCode HeatSpread(Cloud cloud, PetscReal dt);

extern const Property  HeatProperties[];
extern const GaugeKind GaugeTemperature;

#endif
