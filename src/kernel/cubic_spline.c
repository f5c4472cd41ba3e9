/* Cubic spline, support 2h: Eq. (3) of Kuri et al., which as printed lacks h^-3 in three dimensions. */
#include "kernel_impl.h"

#define W(T, q)    ((T)0.25 * POWER3(PLUS(T, 2 - q)) - POWER3(PLUS(T, 1 - q)))
#define F(T, q, i) (q < 1 ? (T)2.25 * q - 3 : (T)-0.75 * POWER2(PLUS(T, 2 - q)) * i)

KERNEL_LOOPS(Evaluate, PetscReal, 1, ROOT_EXACT, W, F)
KERNEL_LOOPS(Single, float, KERNEL_LANES, ROOT_FAST, W, F)

const KernelOps KernelCubicSpline = {.choice   = {.name = KERNEL_CUBIC_SPLINE},
                                     .support  = 2.0,
                                     .norm2    = 10.0 / (7.0 * PETSC_PI),
                                     .norm3    = 1.0 / PETSC_PI,
                                     .evaluate = Evaluate,
                                     .single   = Single};
