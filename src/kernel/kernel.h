/* Floor 1: smoothing kernels. W(r,h), normalised in two or three dimensions, as a registered type.

   Pair loops hand over squared distances in short arrays (a row of neighbours) and get values back, so that one
   indirect call serves about eighty pairs and the arithmetic vectorises. */
#ifndef ISPH_KERNEL_H
#define ISPH_KERNEL_H

#include "../base/base.h"

typedef struct _p_Kernel *Kernel;

#define KERNEL_CUBIC_SPLINE   "cubic_spline"
#define KERNEL_WENDLAND_C2    "wendland_c2"
#define KERNEL_QUINTIC_SPLINE "quintic_spline"

/* What a kernel type provides (a new one: one file and one line in kernel.c), for unit normalisation (the class
 * multiplies by it). */
typedef struct {
  PetscReal support;      /* radius of support over h */
  PetscReal norm2, norm3; /* W = norm/h^dim w(r/h) */
  /* w[k] = w(q_k) and f[k] = w'(q_k)/q_k for k < n, q_k = r_k/h, from s[k] = q_k^2; w or f may be NULL. Zero outside
   * the support. */
  void (*evaluate)(PetscInt n, const PetscReal s[], PetscReal w[], PetscReal f[]);
  /* the same in single precision */
  void (*single)(PetscInt n, const float s[], float w[], float f[]);
} KernelOps;

/* Where a sum divides by r^2 it divides by r^2 + eta^2, eta = 0.1 h (Kuri et al., Eq. (1)). */
#define ETA_OVER_H 0.1

/* KernelCreate - a kernel of h not yet set, cubic spline. Collective on comm. */
PetscErrorCode KernelCreate(MPI_Comm comm, PetscInt dim, Kernel *kernel);
PetscErrorCode KernelSetType(Kernel kernel, const char name[]);
/* KernelSetSmoothingLength - h in m, positive. */
PetscErrorCode KernelSetSmoothingLength(Kernel kernel, PetscReal h);
/* KernelSetFromOptions - -kernel_type, and h from -kernel_ratio (h/d0) times spacing (m). Collective. */
PetscErrorCode KernelSetFromOptions(Kernel kernel, PetscReal spacing);
PetscErrorCode KernelView(Kernel kernel, PetscViewer viewer);
PetscErrorCode KernelDestroy(Kernel *kernel);

/* KernelSmoothingLength (m), KernelSupport (radius beyond which W = 0, m), KernelSelf (W(0), m^-dim). Not collective.
 */
PetscReal KernelSmoothingLength(Kernel kernel);
PetscReal KernelSupport(Kernel kernel);
PetscReal KernelSelf(Kernel kernel);
/* KernelEvaluate - for k < n: W[k] = W(r_k) (m^-dim) and F[k] = W'(r_k)/r_k (m^-dim-2), so that grad_a W_ab = F r_ab;
   r2[k] = r_k^2 (m^2). W or F may be NULL. Not collective. */
void KernelEvaluate(Kernel kernel, PetscInt n, const PetscReal r2[], PetscReal W[], PetscReal F[]);
/* KernelGradient - F as above, computed in single precision from r2 in double, because its square root and division are
   most of the cost of a pair loop. The relative error is below 1e-6 and the same for both particles of a pair, so what
   pairs exchange is conserved to round-off. Not collective. */
void KernelGradient(Kernel kernel, PetscInt n, const PetscReal r2[], PetscReal F[]);
/* KernelSingle - W and F without their dimensions, in single precision: W = scale_w w[k] and F = scale_f f[k] from s[k]
   = r_k^2/h^2, k < n; w or f may be NULL. The arrays must have room for n rounded up to a multiple of KERNEL_LANES,
   since whole vectors are computed. The precision is that of KernelGradient. Not collective. */
#define KERNEL_LANES 16
void KernelSingle(Kernel kernel, PetscInt n, const float s[], float w[], float f[]);
/* KernelScales - the factors of KernelSingle: scale_w (m^-dim), scale_f (m^-dim-2), 1/h^2 (m^-2). Not collective. */
void KernelScales(Kernel kernel, PetscReal *scale_w, PetscReal *scale_f, PetscReal *inverse_h2);
/* KernelHalfSpace - a half-space of liquid whose surface is at distance s (m) above the point (s < 0: the point is
   outside): plane = w1(s) = integral of W over the plane at distance s (1/m) = |int grad W| over the liquid; fraction =
   F(s) = integral of W over the liquid. Either may be NULL. Not collective. */
void KernelHalfSpace(Kernel kernel, PetscReal s, PetscReal *plane, PetscReal *fraction);
/* KernelSurfaceTable - fraction[k] = F at the depth where w1(s)/w1(0) = k/n, k = 0 to n: the filled fraction of the
   kernel from the length of sum V grad W, as if the surface were flat. Not collective. */
void KernelSurfaceTable(Kernel kernel, PetscInt n, PetscReal fraction[]);

#endif
