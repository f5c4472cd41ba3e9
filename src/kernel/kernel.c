#include "kernel_impl.h"

struct _p_Kernel {
  MPI_Comm         comm;
  PetscInt         dim;
  const KernelOps *ops;
  PetscReal        h, scale_w, scale_f, inverse_h2, moment, plane_moment;
};

const Choice *const Kernels[] = {&KernelCubicSpline.choice, &KernelWendlandC2.choice, &KernelQuinticSpline.choice,
                                 NULL};

#define MOMENT_POINTS 500 /* of the midpoint rule: exact to 1e-5 */

/* int r^2 W over a line, a plane of rings 2 pi r dr, or a space of shells 4 pi r^2 dr. */
static PetscReal Moment(Kernel kernel, PetscInt dim)
{
  const PetscReal dr = KernelSupport(kernel) / MOMENT_POINTS, shell = dim == 1 ? 2 : 2 * (dim - 1) * PETSC_PI;
  PetscReal       r2[MOMENT_POINTS], W[MOMENT_POINTS], sum = 0;

  for (PetscInt m = 0; m < MOMENT_POINTS; m++) r2[m] = PetscSqr((m + 0.5) * dr);
  KernelEvaluate(kernel, MOMENT_POINTS, r2, W, NULL);
  for (PetscInt m = 0; m < MOMENT_POINTS; m++)
    sum += W[m] * r2[m] * dr * shell * PetscPowRealInt(PetscSqrtReal(r2[m]), (int)dim - 1);
  return sum;
}

static void KernelScale(Kernel kernel)
{
  const PetscReal norm = kernel->dim == 2 ? kernel->ops->norm2 : kernel->ops->norm3;

  if (kernel->h <= 0) return;
  kernel->scale_w      = norm / PetscPowRealInt(kernel->h, (int)kernel->dim);
  kernel->inverse_h2   = 1.0 / (kernel->h * kernel->h);
  kernel->scale_f      = kernel->scale_w * kernel->inverse_h2;
  kernel->moment       = Moment(kernel, kernel->dim);
  kernel->plane_moment = Moment(kernel, kernel->dim - 1) / (kernel->dim - 1);
}

PetscErrorCode KernelCreate(MPI_Comm comm, PetscInt dim, Kernel *kernel)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(kernel));
  (*kernel)->comm = comm;
  (*kernel)->dim  = dim;
  PetscCall(KernelSetType(*kernel, KERNEL_CUBIC_SPLINE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode KernelSetType(Kernel kernel, const char name[])
{
  const Choice *choice;

  PetscFunctionBegin;
  PetscCall(ChoiceFind(kernel->comm, Kernels, "-kernel_type", name, &choice));
  kernel->ops = (const KernelOps *)choice;
  KernelScale(kernel);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode KernelSetSmoothingLength(Kernel kernel, PetscReal h)
{
  PetscFunctionBegin;
  PetscCheckUser(h > 0, kernel->comm, "the smoothing length must be positive, not %g m", (double)h);
  kernel->h = h;
  KernelScale(kernel);
  PetscFunctionReturn(PETSC_SUCCESS);
}

typedef struct {
  char      type[OPTION_WORD_LENGTH];
  PetscReal ratio; /* h/d0 */
} Given;

static const OptionRow options[] = {
  {"-kernel_type", "Smoothing kernel", NULL, NULL, ROW_CHOICE, offsetof(Given, type), .choices = Kernels},
  {"-kernel_ratio", "Smoothing length h over particle spacing d0", "1", "[1, 3]", ROW_REAL, offsetof(Given, ratio)},
  {.name = NULL},
};

PetscErrorCode KernelSetFromOptions(Kernel kernel, PetscReal spacing)
{
  Given given = {.ratio = 1.3};

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(given.type, KernelType(kernel), sizeof(given.type)));
  PetscCall(OptionsReadBlock(kernel->comm, "Kernel", options, "KernelSetFromOptions", &given));
  PetscCall(KernelSetType(kernel, given.type));
  PetscCall(KernelSetSmoothingLength(kernel, given.ratio * spacing));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode KernelView(Kernel kernel, PetscViewer viewer)
{
  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(viewer, "Kernel: %s, %" PetscInt_FMT "-d, h = %g m, support %g m\n",
                                   kernel->ops->choice.name, kernel->dim, (double)kernel->h,
                                   (double)KernelSupport(kernel)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode KernelDestroy(Kernel *kernel)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(*kernel));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const char *KernelType(Kernel kernel)
{
  return kernel->ops->choice.name;
}

PetscReal KernelSmoothingLength(Kernel kernel)
{
  return kernel->h;
}

PetscReal KernelSupport(Kernel kernel)
{
  return kernel->h * kernel->ops->support;
}

PetscReal KernelSelf(Kernel kernel)
{
  const PetscReal zero = 0;
  PetscReal       w;

  KernelEvaluate(kernel, 1, &zero, &w, NULL);
  return w;
}

#define KERNEL_CHUNK 256 /* pairs at once: their arrays fit into the L1 cache */

void KernelEvaluate(Kernel kernel, PetscInt n, const PetscReal *restrict r2, PetscReal *restrict W,
                    PetscReal *restrict F)
{
  PetscReal s[KERNEL_CHUNK];

  for (PetscInt start = 0; start < n; start += KERNEL_CHUNK) {
    const PetscInt m = PetscMin(n - start, KERNEL_CHUNK);

    SIMD_LOOP()
    for (PetscInt k = 0; k < m; k++) s[k] = r2[start + k] * kernel->inverse_h2;
    kernel->ops->evaluate(m, s, W ? W + start : NULL, F ? F + start : NULL);
    if (W) {
      SIMD_LOOP()
      for (PetscInt k = 0; k < m; k++) W[start + k] *= kernel->scale_w;
    }
    if (F) {
      SIMD_LOOP()
      for (PetscInt k = 0; k < m; k++) F[start + k] *= kernel->scale_f;
    }
  }
}

void KernelGradient(Kernel kernel, PetscInt n, const PetscReal *restrict r2, PetscReal *restrict F)
{
  float s[KERNEL_CHUNK], f[KERNEL_CHUNK];

  for (PetscInt start = 0; start < n; start += KERNEL_CHUNK) {
    const PetscInt m = PetscMin(n - start, KERNEL_CHUNK);

    SIMD_LOOP()
    for (PetscInt k = 0; k < m; k++) s[k] = (float)(r2[start + k] * kernel->inverse_h2);
    kernel->ops->single(m, s, NULL, f);
    SIMD_LOOP()
    for (PetscInt k = 0; k < m; k++) F[start + k] = kernel->scale_f * f[k];
  }
}

void KernelSingle(Kernel kernel, PetscInt n, const float s[], float w[], float f[])
{
  kernel->ops->single(n, s, w, f);
}

PetscReal KernelMoment(Kernel kernel)
{
  return kernel->moment;
}

PetscReal KernelPlaneMoment(Kernel kernel)
{
  return kernel->plane_moment;
}

void KernelScales(Kernel kernel, PetscReal *scale_w, PetscReal *scale_f, PetscReal *inverse_h2)
{
  *scale_w    = kernel->scale_w;
  *scale_f    = kernel->scale_f;
  *inverse_h2 = kernel->inverse_h2;
}

#define PLANE_POINTS 400 /* of the midpoint rule over a plane */
#define DEPTH_POINTS 200 /* of the midpoint rule over the depth of a half-space */
#define ANGLES       64  /* of the midpoint rule over a half of the plane */
#define BISECTIONS   25  /* of the search for a depth between two of these */

/* w1(s) of KernelHalfSpace by the midpoint rule: along the chord in two dimensions, over rings 2 pi r dr in three. */
static PetscReal PlaneIntegral(Kernel kernel, PetscReal s)
{
  const PetscReal support = KernelSupport(kernel), s2 = s * s;
  const PetscReal chord = s2 < support * support ? PetscSqrtReal(support * support - s2) : 0;
  const PetscReal dt    = chord / PLANE_POINTS;
  PetscReal       r2[PLANE_POINTS], W[PLANE_POINTS], sum = 0;

  for (PetscInt k = 0; k < PLANE_POINTS; k++) r2[k] = s2 + PetscSqr((k + 0.5) * dt);
  KernelEvaluate(kernel, PLANE_POINTS, r2, W, NULL);
  for (PetscInt k = 0; k < PLANE_POINTS; k++)
    sum += W[k] * (kernel->dim == 3 ? 2.0 * PETSC_PI * (k + 0.5) * dt : 2.0) * dt;
  return sum;
}

void KernelHalfSpace(Kernel kernel, PetscReal s, PetscReal *plane, PetscReal *fraction)
{
  const PetscReal end = PetscMin(PetscAbsReal(s), KernelSupport(kernel));

  if (plane) *plane = PlaneIntegral(kernel, s);
  if (fraction) {
    PetscReal sum = 0;

    for (PetscInt k = 0; k < DEPTH_POINTS; k++)
      sum += PlaneIntegral(kernel, (k + 0.5) * end / DEPTH_POINTS) * end / DEPTH_POINTS;
    *fraction = s >= 0 ? PetscMin(0.5 + sum, 1.0) : PetscMax(0.5 - sum, 0.0);
  }
}

void KernelAxisTable(Kernel kernel, PetscInt n, PetscReal share[])
{
  const PetscReal support = KernelSupport(kernel), dr = support / PLANE_POINTS, angle = PETSC_PI / ANGLES;
  PetscReal       r2[PLANE_POINTS], W[PLANE_POINTS], F[PLANE_POINTS], cosine[ANGLES];

  for (PetscInt l = 0; l < ANGLES; l++) cosine[l] = PetscCosReal((l + 0.5) * angle);
  for (PetscInt m = 0; m < PLANE_POINTS; m++) r2[m] = PetscSqr((m + 0.5) * dr);
  KernelEvaluate(kernel, PLANE_POINTS, r2, W, F);
  for (PetscInt k = 0; k <= n; k++) {
    PetscReal sum = 0;

    for (PetscInt m = 0; m < PLANE_POINTS; m++)
      for (PetscInt l = 0; l < ANGLES; l++) { /* of a half of the plane */
        const PetscReal r = PetscSqrtReal(r2[m]), x = r * cosine[l];

        sum += F[m] * PetscAbsReal(support * k / n - x) * (3 * x * x - 2 * r2[m]) * x * 2 * r * dr * angle;
      }
    share[k] = 2 / kernel->moment * sum;
  }
}

PetscReal KernelSlice(Kernel kernel, PetscReal from, PetscReal to)
{
  return (to - from) / 6 *
         (PlaneIntegral(kernel, from) + 4 * PlaneIntegral(kernel, 0.5 * (from + to)) + PlaneIntegral(kernel, to));
}

void KernelSurfaceTable(Kernel kernel, PetscInt n, PetscReal fraction[])
{
  const PetscReal step = KernelSupport(kernel) / DEPTH_POINTS, zero = PlaneIntegral(kernel, 0);
  PetscReal       above = 0, filled = 0.5; /* a depth, F there */

  fraction[0] = 1;
  fraction[n] = 0.5;
  for (PetscInt k = n - 1; k > 0; k--) { /* w1 decreases with depth */
    PetscReal low, high;

    for (; PlaneIntegral(kernel, above + step) * n > zero * k; above += step)
      filled += KernelSlice(kernel, above, above + step);
    low  = above;
    high = above + step;
    for (PetscInt bisection = 0; bisection < BISECTIONS; bisection++) {
      const PetscReal middle = 0.5 * (low + high);

      if (PlaneIntegral(kernel, middle) * n > zero * k)
        low = middle;
      else
        high = middle;
    }
    fraction[k] = filled + KernelSlice(kernel, above, low);
  }
}
