/* Quintic spline, support 3h. */
#include "types.h"

static inline PetscReal Power4(PetscReal x)
{
  return (x * x) * (x * x);
}

static void Evaluate(PetscInt n, const PetscReal *restrict s, PetscReal *restrict w, PetscReal *restrict f)
{
  if (w) {
    SIMD_LOOP()
    for (PetscInt k = 0; k < n; k++) {
      const PetscReal q = PetscSqrtReal(s[k]), c = PetscMax(3.0 - q, 0.0), b = PetscMax(2.0 - q, 0.0),
                      a = PetscMax(1.0 - q, 0.0);

      w[k] = Power4(c) * c - 6.0 * Power4(b) * b + 15.0 * Power4(a) * a;
    }
  }
  if (f) {
    SIMD_LOOP()
    for (PetscInt k = 0; k < n; k++) {
      const PetscReal q = PetscSqrtReal(PetscMax(s[k], KERNEL_TINY)), c = PetscMax(3.0 - q, 0.0),
                      b = PetscMax(2.0 - q, 0.0), a = PetscMax(1.0 - q, 0.0);

      f[k] = -5.0 * (Power4(c) - 6.0 * Power4(b) + 15.0 * Power4(a)) / q;
    }
  }
}

const KernelOps KernelQuinticSpline = {.support  = 3.0,
                                       .norm2    = 7.0 / (478.0 * PETSC_PI),
                                       .norm3    = 1.0 / (120.0 * PETSC_PI),
                                       .evaluate = Evaluate};
