/* Quintic spline, support 3h. */
#include "kernel_impl.h"

#define POWER5(x) (POWER4(x) * (x))
#define W(T, q)   (POWER5(PLUS(T, 3 - q)) - 6 * POWER5(PLUS(T, 2 - q)) + 15 * POWER5(PLUS(T, 1 - q)))
/* For q < 1 the sum is expanded: its terms cancel to 24 q - 24 q^3 + 10 q^4. */
#define F(T, q, i)                                                                                                     \
  (q < 1 ? -5 * (24 + q * q * (10 * q - 24)) : -5 * (POWER4(PLUS(T, 3 - q)) - 6 * POWER4(PLUS(T, 2 - q))) * i)

KERNEL_LOOPS(Evaluate, PetscReal, 1, ROOT_EXACT, W, F)
KERNEL_LOOPS(Single, float, KERNEL_LANES, ROOT_FAST, W, F)

const KernelOps KernelQuinticSpline = {.choice   = {.name = KERNEL_QUINTIC_SPLINE},
                                       .support  = 3.0,
                                       .norm2    = 7.0 / (478.0 * PETSC_PI),
                                       .norm3    = 1.0 / (120.0 * PETSC_PI),
                                       .evaluate = Evaluate,
                                       .single   = Single};
