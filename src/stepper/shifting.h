/* Private to stepper/: particle shifting. */
#ifndef ISPH_SHIFTING_H
#define ISPH_SHIFTING_H

#include "../operators/operators.h"

typedef struct {
  PetscBool active, conserved;
} Shifting;

/* Shift - moves FIELD_POSITION_NEW (m) towards an even distribution and corrects FIELD_VELOCITY_NEW (m/s) for the
   displacement. Reads FIELD_VELOCITY_GRADIENT (1/s) and FIELD_VELOCITY_JUMP (m/s) of the velocity before the pressure
   acted, which saves a pass over the pairs. guard: least distance from walls (spacings), to which a shift may lead.
   conserved: centre of mass, momentum and angular momentum of the fluid stay the same to round-off, unless mirrors or
   the box's period change them. Lists, kernels and B are those of FIELD_POSITION. Collective. */
PetscErrorCode Shift(Cloud cloud, const Shifting *shifting, PetscReal guard, PetscReal dt);

#endif
