/* Private to interface/: the interface of two liquids that do not mix (-interface_tension), an edge. */
#ifndef ISPH_INTERFACE_IMPL_H
#define ISPH_INTERFACE_IMPL_H

#include "../tension/tension.h"

/* InterfaceApply - the TensionSurfaces: the surface of each liquid, and that of both together. Sets the same fields as
   TensionSurface, and the cloud's at_interface, pressure_jump and pressure_jump_slope. Collective. */
PetscErrorCode InterfaceApply(Tension tension, Cloud cloud);

#endif
