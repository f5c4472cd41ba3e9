/* Kernels: normalisation, derivative, support, sums on a lattice, half-spaces. Every number is exact or of a quadrature
   finer than its tolerance. */
#include "../../src/kernel/kernel.h"
#include "check.h"

#define POINTS  20000 /* of the quadratures */
#define SAMPLES 200   /* radii at which a derivative is compared */

static PetscReal W(Kernel kernel, PetscReal r)
{
  const PetscReal r2 = r * r;
  PetscReal       w;

  KernelEvaluate(kernel, 1, &r2, &w, NULL);
  return w;
}

static PetscReal F(Kernel kernel, PetscReal r)
{
  const PetscReal r2 = r * r;
  PetscReal       f;

  KernelEvaluate(kernel, 1, &r2, NULL, &f);
  return f;
}

static PetscErrorCode Make(const char type[], PetscInt dim, PetscReal h, Kernel *kernel)
{
  PetscFunctionBegin;
  PetscCall(KernelCreate(PETSC_COMM_WORLD, dim, kernel));
  PetscCall(KernelSetType(*kernel, type));
  PetscCall(KernelSetSmoothingLength(*kernel, h));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Integral of W over the disc or ball, by the midpoint rule. */
static PetscReal Integral(Kernel kernel, PetscInt dim)
{
  const PetscReal dr  = KernelSupport(kernel) / POINTS;
  PetscReal       sum = 0;

  for (PetscInt k = 0; k < POINTS; k++) {
    const PetscReal r = (k + 0.5) * dr;

    sum += W(kernel, r) * (dim == 3 ? 4 * PETSC_PI * r * r : 2 * PETSC_PI * r) * dr;
  }
  return sum;
}

/* Largest difference between F r and the central difference of W, over W(0)/h; kinks of W'' cost O(step). */
static PetscReal DerivativeError(Kernel kernel)
{
  const PetscReal h = KernelSmoothingLength(kernel), step = 1e-5 * h, support = KernelSupport(kernel);
  PetscReal       error = 0;

  for (PetscInt k = 1; k < SAMPLES; k++) {
    const PetscReal r     = 1.1 * support * k / SAMPLES;
    const PetscReal slope = (W(kernel, r + step) - W(kernel, r - step)) / (2 * step);

    error = PetscMax(error, PetscAbsReal(slope - F(kernel, r) * r) * h / KernelSelf(kernel));
  }
  return error;
}

/* Values of many pairs in one call, longer than any block inside, equal those of single calls. */
static PetscBool RowsAgree(Kernel kernel)
{
  enum { LONG = 1001 };
  PetscReal r2[LONG], w[LONG], f[LONG];
  PetscBool same = PETSC_TRUE;

  for (PetscInt k = 0; k < LONG; k++) r2[k] = PetscSqr(1.2 * KernelSupport(kernel) * k / LONG);
  KernelEvaluate(kernel, LONG, r2, w, f);
  for (PetscInt k = 0; k < LONG; k++) {
    const PetscReal r = PetscSqrtReal(r2[k]), scale = 1e-13 * KernelSelf(kernel);

    same = (PetscBool)(same && PetscAbsReal(w[k] - W(kernel, r)) <= scale);
    same = (PetscBool)(same && (k == 0 || PetscAbsReal((f[k] - F(kernel, r)) * r) <= scale * 1e3));
  }
  return same;
}

/* Largest difference of KernelSingle, with its scales, from KernelEvaluate, over the largest value of each; both
   together, W alone and F alone (which may differ in what the compiler fuses). */
static PetscReal SingleError(Kernel kernel)
{
  PetscReal scale_w, scale_f, inverse_h2, error = 0, largest_f = 0;

  KernelScales(kernel, &scale_w, &scale_f, &inverse_h2);
  for (PetscInt k = 1; k < SAMPLES; k++)
    largest_f = PetscMax(largest_f, PetscAbsReal(F(kernel, k * 1e-2 / PetscSqrtReal(inverse_h2))));
  for (PetscInt k = 1; k < SAMPLES; k++) {
    const PetscReal r               = 1.1 * KernelSupport(kernel) * k / SAMPLES;
    const float     s[KERNEL_LANES] = {(float)(r * r * inverse_h2)};
    float           w[KERNEL_LANES], f[KERNEL_LANES], alone[KERNEL_LANES];

    KernelSingle(kernel, 1, s, w, f);
    error = PetscMax(error, PetscAbsReal(scale_w * w[0] - W(kernel, r)) / KernelSelf(kernel));
    error = PetscMax(error, PetscAbsReal(scale_f * f[0] - F(kernel, r)) / largest_f);
    KernelSingle(kernel, 1, s, alone, NULL);
    error = PetscMax(error, PetscAbsReal(scale_w * alone[0] - W(kernel, r)) / KernelSelf(kernel));
    KernelSingle(kernel, 1, s, NULL, alone);
    error = PetscMax(error, PetscAbsReal(scale_f * alone[0] - F(kernel, r)) / largest_f);
  }
  return error;
}

/* Half-spaces: F(0) = 1/2, F(support) = 1, F(-s) = 1 - F(s), dF/ds = w1, w1 the integral of W over a plane. */
static PetscErrorCode CheckHalfSpace(Kernel kernel, const char label[])
{
  const PetscReal support = KernelSupport(kernel), step = 1e-3 * support;
  PetscReal       zero, full, beyond, plane, end, error = 0, odd = 0;
  char            name[96];

  PetscFunctionBegin;
  KernelHalfSpace(kernel, 0, NULL, &zero);
  KernelHalfSpace(kernel, support, &end, &full);
  KernelHalfSpace(kernel, -2 * support, NULL, &beyond);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_half_space_at_surface", label));
  CHECK_CLOSE(zero, 0.5, 1e-14, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_half_space_full", label));
  CHECK_CLOSE(full, 1, 1e-4, name); /* 1e-5 off: the quadrature of the class */
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_half_space_empty", label));
  CHECK(PetscAbsReal(beyond) <= 1e-4 && end == 0, name);
  for (PetscInt k = 1; k < 20; k++) {
    const PetscReal s = support * k / 20;
    PetscReal       up, down, at, below;

    KernelHalfSpace(kernel, s + step, NULL, &up);
    KernelHalfSpace(kernel, s - step, NULL, &down);
    KernelHalfSpace(kernel, s, &plane, &at);
    KernelHalfSpace(kernel, -s, NULL, &below);
    odd   = PetscMax(odd, PetscAbsReal(at + below - 1));
    error = PetscMax(error, PetscAbsReal((up - down) / (2 * step) - plane) * support);
  }
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_half_space_odd", label));
  CHECK_CLOSE(odd, 0, 1e-14, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_half_space_slope", label));
  CHECK_CLOSE(error, 0, 1e-3, name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestType(const char type[], PetscInt dim)
{
  const PetscReal scales[] = {1, 3.25e-4};
  char            label[64], name[96];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2; k++) {
    Kernel    kernel;
    PetscReal support;

    PetscCall(Make(type, dim, scales[k], &kernel));
    support = KernelSupport(kernel);
    PetscCall(PetscSNPrintf(label, sizeof(label), "%s_%dd_%s", type, (int)dim, k ? "small" : "unit"));
    PetscCall(PetscSNPrintf(name, sizeof(name), "%s_integral", label));
    CHECK_CLOSE(Integral(kernel, dim), 1, 1e-7, name);
    PetscCall(PetscSNPrintf(name, sizeof(name), "%s_derivative", label));
    CHECK_CLOSE(DerivativeError(kernel), 0, 1e-4, name);
    PetscCall(PetscSNPrintf(name, sizeof(name), "%s_outside", label));
    CHECK(W(kernel, support * (1 + 1e-12)) == 0 && W(kernel, 5 * support) == 0 &&
            F(kernel, support * (1 + 1e-12)) == 0 && F(kernel, 1e3 * support) == 0,
          name);
    PetscCall(PetscSNPrintf(name, sizeof(name), "%s_vanishes_at_support", label));
    CHECK(W(kernel, support * (1 - 1e-6)) >= 0 && W(kernel, support * (1 - 1e-6)) < 1e-12 * KernelSelf(kernel), name);
    PetscCall(PetscSNPrintf(name, sizeof(name), "%s_center", label));
    CHECK(KernelSelf(kernel) == W(kernel, 0) && PetscAbsReal(F(kernel, 0)) < PETSC_MAX_REAL, name);
    PetscCall(PetscSNPrintf(name, sizeof(name), "%s_rows", label));
    CHECK(RowsAgree(kernel), name);
    PetscCall(PetscSNPrintf(name, sizeof(name), "%s_single", label));
    CHECK_CLOSE(SingleError(kernel), 0, 2e-6, name);
    if (k == 0) PetscCall(CheckHalfSpace(kernel, label));
    PetscCall(KernelDestroy(&kernel));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* On a lattice of spacing 1: sum W, number of neighbours, and -sum F x^2. */
static void LatticeSums(Kernel kernel, PetscInt dim, PetscReal *sum, PetscInt *neighbors, PetscReal *moment)
{
  const PetscInt reach = (PetscInt)KernelSupport(kernel) + 1, deep = dim == 3 ? reach : 0;

  *sum       = 0;
  *moment    = 0;
  *neighbors = -1; /* not itself */
  for (PetscInt k = -deep; k <= deep; k++)
    for (PetscInt j = -reach; j <= reach; j++)
      for (PetscInt i = -reach; i <= reach; i++) {
        const PetscReal r = PetscSqrtReal((PetscReal)(i * i + j * j + k * k));

        *sum += W(kernel, r);
        *neighbors += r < KernelSupport(kernel);
        if (r > 0) *moment -= F(kernel, r) * i * i;
      }
}

/* The lattice values this method's literature quotes, and closed forms of the cubic spline. */
static PetscErrorCode TestKnownValues(void)
{
  Kernel    kernel;
  PetscReal sum, moment, plane, square = 0;
  PetscInt  neighbors;

  PetscFunctionBegin;
  PetscCall(Make(KERNEL_CUBIC_SPLINE, 3, 1.3, &kernel));
  LatticeSums(kernel, 3, &sum, &neighbors, &moment);
  CHECK_CLOSE(sum, 0.9973, 5e-5, "cubic_lattice_density");
  CHECK(neighbors == 80, "cubic_lattice_neighbors");
  CHECK_CLOSE(moment, 0.993, 5e-4, "cubic_lattice_moment");
  CHECK_CLOSE(KernelSelf(kernel), 1 / (PETSC_PI * 1.3 * 1.3 * 1.3), 1e-14, "cubic_3d_center");
  KernelHalfSpace(kernel, 0, &plane, NULL);
  CHECK_CLOSE(plane, 0.7 / 1.3, 1e-5, "cubic_3d_plane"); /* w1(0) = 7/(10 h) */
  for (PetscInt k = 0; k < 2000; k++) {
    const PetscReal ds = KernelSupport(kernel) / 2000;

    KernelHalfSpace(kernel, (k + 0.5) * ds, &plane, NULL);
    square += plane * plane * ds;
  }
  CHECK_CLOSE(square * 1.3, 0.252584, 1e-5, "cubic_3d_plane_squared"); /* what kappa = 3.959 sigma H rests on */
  CHECK_CLOSE(3.959 * square * 1.3, 1, 1e-3, "tension_calibration");
  PetscCall(KernelDestroy(&kernel));
  PetscCall(Make(KERNEL_CUBIC_SPLINE, 2, 1.3, &kernel));
  CHECK_CLOSE(KernelSelf(kernel), 10 / (7 * PETSC_PI * 1.69), 1e-14, "cubic_2d_center");
  PetscCall(KernelDestroy(&kernel));
  for (const Choice *const *t = Kernels; *t; t++)
    for (PetscInt dim = 2; dim <= 3; dim++) {
      char name[96];

      PetscCall(Make((*t)->name, dim, 2, &kernel)); /* wide: lattice sums are integrals but for little */
      LatticeSums(kernel, dim, &sum, &neighbors, &moment);
      PetscCall(PetscSNPrintf(name, sizeof(name), "%s_%dd_wide_lattice", (*t)->name, (int)dim));
      CHECK(PetscAbsReal(sum - 1) < 2e-3 && PetscAbsReal(moment - 1) < 5e-3, name);
      PetscCall(KernelDestroy(&kernel));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The options of a kernel act. */
static PetscErrorCode TestOptions(void)
{
  Kernel kernel;

  PetscFunctionBegin;
  PetscCall(PetscOptionsInsertString(NULL, "-kernel_type quintic_spline -kernel_ratio 1.5"));
  PetscCall(KernelCreate(PETSC_COMM_WORLD, 3, &kernel));
  PetscCall(KernelSetFromOptions(kernel, 0.2));
  CHECK_CLOSE(KernelSmoothingLength(kernel), 0.3, 1e-15, "kernel_ratio");
  CHECK_CLOSE(KernelSupport(kernel), 0.9, 1e-15, "kernel_type");
  PetscCall(KernelDestroy(&kernel));
  PetscCall(PetscOptionsClear(NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  for (const Choice *const *t = Kernels; *t; t++)
    for (PetscInt dim = 2; dim <= 3; dim++) PetscCall(TestType((*t)->name, dim));
  PetscCall(TestKnownValues());
  PetscCall(TestOptions());
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
