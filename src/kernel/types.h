/* Private to kernel/: the types. */
#ifndef ISPH_KERNEL_TYPES_H
#define ISPH_KERNEL_TYPES_H

#include "kernel.h"

/* Smallest (r/h)^2 at which W'(q)/q is evaluated as a quotient: coincident particles get the limit, not 0/0. */
#define KERNEL_TINY 1e-12

extern const KernelOps KernelCubicSpline, KernelWendlandC2, KernelQuinticSpline;

#endif
