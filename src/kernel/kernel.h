/* Floor 1: smoothing kernels W(r,h), normalised in two or three dimensions, as registered types.

   A pair loop passes an array of squared distances, one row of neighbours: one indirect call serves about eighty pairs,
   and the arithmetic vectorises. */
#ifndef ISPH_KERNEL_H
#define ISPH_KERNEL_H

#include "../base/base.h"

typedef struct _p_Kernel *Kernel;

#define KERNEL_CUBIC_SPLINE   "cubic_spline"
#define KERNEL_WENDLAND_C2    "wendland_c2"
#define KERNEL_QUINTIC_SPLINE "quintic_spline"

/* What a kernel type provides. A new type needs one file and one entry of Kernels in kernel.c. */
typedef struct {
  Choice    choice;
  PetscReal support;      /* radius of support over h */
  PetscReal norm2, norm3; /* W = norm/h^dim w(r/h) in two and three dimensions */
  /* w[k] = w(q_k) and f[k] = w'(q_k)/q_k for k < n, with q_k = r_k/h and s[k] = q_k^2; zero outside the support. w or f
     may be NULL. 'single' does it in single precision. */
  void (*evaluate)(PetscInt n, const PetscReal s[], PetscReal w[], PetscReal f[]);
  void (*single)(PetscInt n, const float s[], float w[], float f[]);
} KernelOps;
extern const Choice *const Kernels[];

/* eta/h: sums over pairs divide by r^2 + eta^2 instead of r^2 (Kuri et al., Eq. (1)). */
#define ETA_OVER_H 0.1

/* KernelCreate - a cubic spline whose h is not set yet. Collective on comm. */
PetscErrorCode KernelCreate(MPI_Comm comm, PetscInt dim, Kernel *kernel);
PetscErrorCode KernelSetType(Kernel kernel, const char name[]);
/* KernelSetSmoothingLength - sets h (m), which must be positive. */
PetscErrorCode KernelSetSmoothingLength(Kernel kernel, PetscReal h);
/* KernelSetFromOptions - reads -kernel_type, and sets h to -kernel_ratio times the spacing d0 (m). Collective. */
PetscErrorCode KernelSetFromOptions(Kernel kernel, PetscReal spacing);
PetscErrorCode KernelView(Kernel kernel, PetscViewer viewer);
PetscErrorCode KernelDestroy(Kernel *kernel);

/* KernelType - the name of -kernel_type. KernelSmoothingLength - h (m). KernelSupport - the radius of support (m).
   KernelSelf - W(0) (m^-dim). Not collective. */
const char *KernelType(Kernel kernel);
PetscReal   KernelSmoothingLength(Kernel kernel);
PetscReal   KernelSupport(Kernel kernel);
PetscReal   KernelSelf(Kernel kernel);
/* KernelEvaluate - for k < n: W[k] = W(r_k) (m^-dim) and F[k] = W'(r_k)/r_k (m^-dim-2), so that grad_a W_ab = F r_ab;
   r2[k] = r_k^2 (m^2). W or F may be NULL. Not collective. */
void KernelEvaluate(Kernel kernel, PetscInt n, const PetscReal r2[], PetscReal W[], PetscReal F[]);
/* KernelGradient - F of KernelEvaluate, computed in single precision from r2 in double precision, because the square
   root and the division are most of the cost of a pair loop. The relative error is below 1e-6. Both particles of a pair
   have the same error, so momentum is conserved to round-off. Not collective. */
void KernelGradient(Kernel kernel, PetscInt n, const PetscReal r2[], PetscReal F[]);
/* KernelSingle - dimensionless W and F with the precision of KernelGradient: W = scale_w w[k] and F = scale_f f[k] for
   s[k] = r_k^2/h^2, k < n. w or f may be NULL. The arrays must have room for n rounded up to a multiple of
   KERNEL_LANES. Not collective. */
#define KERNEL_LANES 16
void KernelSingle(Kernel kernel, PetscInt n, const float s[], float w[], float f[]);
/* KernelScales - the factors of KernelSingle: scale_w (m^-dim), scale_f (m^-dim-2), 1/h^2 (m^-2). Not collective. */
void KernelScales(Kernel kernel, PetscReal *scale_w, PetscReal *scale_f, PetscReal *inverse_h2);
/* KernelMoment - the second moment int r^2 W (m2). KernelPlaneMoment - int x^2 W over a plane through the middle, x
   along it (m); it is int s w1(s) ds over the depths s of KernelHalfSpace, too. Not collective. */
PetscReal KernelMoment(Kernel kernel);
PetscReal KernelPlaneMoment(Kernel kernel);
/* KernelHalfSpace - integrals of W around a point at depth s (m) in a half-space of liquid (s < 0: outside). plane:
   w1(s), over the plane of the surface (1/m), which equals |int grad W| over the liquid. fraction: F(s), over the
   liquid (1). Either may be NULL. Not collective. */
void KernelHalfSpace(Kernel kernel, PetscReal s, PetscReal *plane, PetscReal *fraction);
/* KernelSlice - F(to) - F(from) (1) by Simpson's rule, for close depths (m). Not collective. */
PetscReal KernelSlice(Kernel kernel, PetscReal from, PetscReal to);
/* KernelAxisTable - of a kernel in a plane: share[k] = G(x) at the distance x = k/n of half the support from an axis,
   k = 0 to n,

     G(x) = 2/M int F |2 x - r_x| (r_x^2 - 2 r_y^2) r_x,   M = int r^2 W,   F = W'/r

   over the support (1). A sum over pairs that count as F r^2 and as the length of a ring at their middle gives 2 G(x)/x
   along x of the strain v = (x, -2 y). G is 1 where no pair reaches across the axis. Not collective. */
void KernelAxisTable(Kernel kernel, PetscInt n, PetscReal share[]);
/* KernelSurfaceTable - fraction[k] = F(s) at the depth s where w1(s)/w1(0) = k/n, k = 0 to n. It gives the filled
   fraction of the kernel near a flat surface from |sum V grad W|. Not collective. */
void KernelSurfaceTable(Kernel kernel, PetscInt n, PetscReal fraction[]);

#endif
