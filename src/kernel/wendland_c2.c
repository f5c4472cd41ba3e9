/* Wendland C2, support 2h: never pairs (its Fourier transform is not negative anywhere). */
#include "types.h"

static void Evaluate(PetscInt n, const PetscReal *restrict s, PetscReal *restrict w, PetscReal *restrict f)
{
  if (w) {
    SIMD_LOOP()
    for (PetscInt k = 0; k < n; k++) {
      const PetscReal q = PetscSqrtReal(s[k]), u = PetscMax(1.0 - 0.5 * q, 0.0);

      w[k] = u * u * u * u * (1.0 + 2.0 * q);
    }
  }
  if (f) {
    SIMD_LOOP()
    for (PetscInt k = 0; k < n; k++) {
      const PetscReal u = PetscMax(1.0 - 0.5 * PetscSqrtReal(s[k]), 0.0);

      f[k] = -5.0 * u * u * u;
    }
  }
}

static void Single(PetscInt n, const float *restrict s, float *restrict w, float *restrict f)
{
  if (w) {
    SIMD_LOOP()
    for (PetscInt k = 0; k < n; k++) {
      const float q = sqrtf(s[k]), u = PetscMax(1.0f - 0.5f * q, 0.0f);

      w[k] = u * u * u * u * (1.0f + 2.0f * q);
    }
  }
  if (f) {
    SIMD_LOOP()
    for (PetscInt k = 0; k < n; k++) {
      const float u = PetscMax(1.0f - 0.5f * sqrtf(s[k]), 0.0f);

      f[k] = -5.0f * u * u * u;
    }
  }
}

const KernelOps KernelWendlandC2 = {.support  = 2.0,
                                    .norm2    = 7.0 / (4.0 * PETSC_PI),
                                    .norm3    = 21.0 / (16.0 * PETSC_PI),
                                    .evaluate = Evaluate,
                                    .single   = Single};
