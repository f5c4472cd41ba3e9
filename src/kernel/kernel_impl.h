/* Private to kernel/: macros of the types. */
#ifndef ISPH_KERNEL_TYPES_H
#define ISPH_KERNEL_TYPES_H

#include "kernel.h"

/* 1/sqrt(s) for 0 <= s < 1e30 with a relative error of 1e-7, in a tenth of the time of a root and a division: Lomont's
   (2003) guess from the exponent, then a Householder step of third and one of second order. For s = 0 the result is
   large but finite. */
static inline float InverseRoot(float s)
{
  uint32_t bits;
  float    y, e;

  (void)memcpy(&bits, &s, sizeof(bits));
  bits = 0x5f375a86u - (bits >> 1);
  (void)memcpy(&y, &bits, sizeof(y));
  e = s * y * y;
  y *= 1.875f - e * (1.25f - 0.375f * e);
  return y * (1.5f - 0.5f * s * y * y);
}

/* ROOT_EXACT and ROOT_FAST set q = sqrt(s) and i = 1/q. */
#define ROOT_EXACT(s)                                                                                                  \
  const PetscReal q = PetscSqrtReal(s), i = 1 / q;                                                                     \
  (void)i;
#define ROOT_FAST(s)                                                                                                   \
  const float i = InverseRoot(s), q = s * i;                                                                           \
  (void)i;

/* Defines the function 'Name' that evaluates a kernel in precision T, over n rounded up to a multiple of LANES. The
   macros W(T, q) and F(T, q, i) = W'(q)/q take q = r/h and i = 1/q and leave the norm out. Near q = 0 F must not divide
   by q: coincident particles need the limit. */
#define KERNEL_LOOPS(Name, T, LANES, ROOT, W, F)                                                                       \
  static void Name(PetscInt n, const T *restrict s, T *restrict w, T *restrict f)                                      \
  {                                                                                                                    \
    const PetscInt m = (n + LANES - 1) / LANES * LANES;                                                                \
                                                                                                                       \
    if (w && f) {                                                                                                      \
      SIMD_LOOP()                                                                                                      \
      for (PetscInt k = 0; k < m; k++) {                                                                               \
        ROOT(s[k])                                                                                                     \
        w[k] = W(T, q);                                                                                                \
        f[k] = F(T, q, i);                                                                                             \
      }                                                                                                                \
    } else if (w) {                                                                                                    \
      SIMD_LOOP()                                                                                                      \
      for (PetscInt k = 0; k < m; k++) {                                                                               \
        ROOT(s[k])                                                                                                     \
        w[k] = W(T, q);                                                                                                \
      }                                                                                                                \
    } else if (f) {                                                                                                    \
      SIMD_LOOP()                                                                                                      \
      for (PetscInt k = 0; k < m; k++) {                                                                               \
        ROOT(s[k])                                                                                                     \
        f[k] = F(T, q, i);                                                                                             \
      }                                                                                                                \
    }                                                                                                                  \
  }

#define PLUS(T, x) PetscMax(x, (T)0)
#define POWER2(x)  ((x) * (x))
#define POWER3(x)  ((x) * (x) * (x))
#define POWER4(x)  POWER2(POWER2(x))

extern const KernelOps KernelCubicSpline, KernelWendlandC2, KernelQuinticSpline;

#endif
