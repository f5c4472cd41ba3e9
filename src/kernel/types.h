/* Private to kernel/: the types. */
#ifndef ISPH_KERNEL_TYPES_H
#define ISPH_KERNEL_TYPES_H

#include "kernel.h"

/* The loops of a kernel in precision T: W(T, q) and F(T, q) = W'(q)/q are macros of q = r/h, without their norm. Where
   F is a quotient it must not be evaluated as one near q = 0: coincident particles get the limit. */
#define KERNEL_LOOPS(Name, T, Root, W, F)                                                                              \
  static void Name(PetscInt n, const T *restrict s, T *restrict w, T *restrict f)                                      \
  {                                                                                                                    \
    if (w) {                                                                                                           \
      SIMD_LOOP()                                                                                                      \
      for (PetscInt k = 0; k < n; k++) {                                                                               \
        const T q = Root(s[k]);                                                                                        \
                                                                                                                       \
        w[k] = W(T, q);                                                                                                \
      }                                                                                                                \
    }                                                                                                                  \
    if (f) {                                                                                                           \
      SIMD_LOOP()                                                                                                      \
      for (PetscInt k = 0; k < n; k++) {                                                                               \
        const T q = Root(s[k]);                                                                                        \
                                                                                                                       \
        f[k] = F(T, q);                                                                                                \
      }                                                                                                                \
    }                                                                                                                  \
  }

#define PLUS(T, x) PetscMax(x, (T)0)
#define POWER2(x)  ((x) * (x))
#define POWER3(x)  ((x) * (x) * (x))
#define POWER4(x)  POWER2(POWER2(x))

extern const KernelOps KernelCubicSpline, KernelWendlandC2, KernelQuinticSpline;

#endif
