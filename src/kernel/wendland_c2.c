/* Wendland C2, support 2h. Its Fourier transform is nowhere negative, so particles do not pair (cluster). */
#include "kernel_impl.h"

#define W(T, q)    (POWER4(PLUS(T, 1 - q / 2)) * (1 + 2 * q))
#define F(T, q, i) (-5 * POWER3(PLUS(T, 1 - q / 2)))

KERNEL_LOOPS(Evaluate, PetscReal, 1, ROOT_EXACT, W, F)
KERNEL_LOOPS(Single, float, KERNEL_LANES, ROOT_FAST, W, F)

const KernelOps KernelWendlandC2 = {.choice   = {.name = KERNEL_WENDLAND_C2},
                                    .support  = 2.0,
                                    .norm2    = 7.0 / (4.0 * PETSC_PI),
                                    .norm3    = 21.0 / (16.0 * PETSC_PI),
                                    .evaluate = Evaluate,
                                    .single   = Single};
