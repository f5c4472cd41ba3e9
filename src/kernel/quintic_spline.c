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

static void Single(PetscInt n, const float *restrict s, float *restrict w, float *restrict f)
{
  if (w) {
    SIMD_LOOP()
    for (PetscInt k = 0; k < n; k++) {
      const float q = sqrtf(s[k]), c = PetscMax(3.0f - q, 0.0f), b = PetscMax(2.0f - q, 0.0f),
                  a  = PetscMax(1.0f - q, 0.0f);
      const float c2 = c * c, b2 = b * b, a2 = a * a;

      w[k] = c2 * c2 * c - 6.0f * b2 * b2 * b + 15.0f * a2 * a2 * a;
    }
  }
  if (f) { /* below 1 the sum multiplied out: its terms cancel to 24 q - 24 q^3 + 10 q^4 */
    SIMD_LOOP()
    for (PetscInt k = 0; k < n; k++) {
      const float q = sqrtf(s[k]), c = PetscMax(3.0f - q, 0.0f), b = PetscMax(2.0f - q, 0.0f);
      const float c2 = c * c, b2 = b * b;

      f[k] = q < 1.0f ? -5.0f * (24.0f + s[k] * (10.0f * q - 24.0f)) : -5.0f * (c2 * c2 - 6.0f * b2 * b2) / q;
    }
  }
}

const KernelOps KernelQuinticSpline = {.support  = 3.0,
                                       .norm2    = 7.0 / (478.0 * PETSC_PI),
                                       .norm3    = 1.0 / (120.0 * PETSC_PI),
                                       .evaluate = Evaluate,
                                       .single   = Single};
