/* Cubic spline, support 2h: the paper's kernel, Eq. (3) of Kuri et al. (its printed form lacks h^-3 in three
 * dimensions). */
#include "types.h"

static void Evaluate(PetscInt n, const PetscReal *restrict s, PetscReal *restrict w, PetscReal *restrict f)
{
  if (w) {
    SIMD_LOOP()
    for (PetscInt k = 0; k < n; k++) {
      const PetscReal q = PetscSqrtReal(s[k]), u = PetscMax(2.0 - q, 0.0), t = PetscMax(1.0 - q, 0.0);

      w[k] = 0.25 * u * u * u - t * t * t;
    }
  }
  if (f) {
    SIMD_LOOP()
    for (PetscInt k = 0; k < n; k++) {
      const PetscReal q = PetscSqrtReal(s[k]), u = PetscMax(2.0 - q, 0.0);

      f[k] = q < 1.0 ? 2.25 * q - 3.0 : -0.75 * u * u / q;
    }
  }
}

static void Single(PetscInt n, const float *restrict s, float *restrict w, float *restrict f)
{
  if (w) {
    SIMD_LOOP()
    for (PetscInt k = 0; k < n; k++) {
      const float q = sqrtf(s[k]), u = PetscMax(2.0f - q, 0.0f), t = PetscMax(1.0f - q, 0.0f);

      w[k] = 0.25f * u * u * u - t * t * t;
    }
  }
  if (f) {
    SIMD_LOOP()
    for (PetscInt k = 0; k < n; k++) {
      const float q = sqrtf(s[k]), u = PetscMax(2.0f - q, 0.0f);

      f[k] = q < 1.0f ? 2.25f * q - 3.0f : -0.75f * u * u / q;
    }
  }
}

const KernelOps KernelCubicSpline = {
  .support = 2.0, .norm2 = 10.0 / (7.0 * PETSC_PI), .norm3 = 1.0 / PETSC_PI, .evaluate = Evaluate, .single = Single};
