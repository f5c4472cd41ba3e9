/* Heights of the surface above places, by SPH interpolation along verticals. */
#include "output_impl.h"

#define BINS 4   /* a spacing, along a vertical */
#define GAP  4   /* empty bins that end what hangs together from below */
#define HALF 0.5 /* share of the space where the surface is */

/* Sums of V W at the points of a vertical: of the liquid, and of walls and solids. */
typedef struct {
  PetscReal liquid, solid;
} Share;

/* Adds what this rank's particles give to the points lower + k bin of the vertical through an image of a place. */
static void AddVertical(Output output, const ParticleArrays *arrays, const PointImage *image, PetscReal bin,
                        PetscInt bins, Share share[])
{
  const Domain    domain = output->cloud->domain;
  const Kernel    kernel = output->cloud->kernel;
  const PetscInt  up     = domain->dim - 1;
  const PetscReal reach2 = PetscSqr(KernelSupport(kernel)), lower = domain->lower[up];

  for (PetscInt a = 0; a < arrays->n; a++) {
    const PetscReal *x       = arrays->real[FIELD_POSITION] + DIM * a;
    PetscReal        across2 = 0, half;

    for (PetscInt d = 0; d < up; d++) across2 += PetscSqr(x[d] - image->x[d]);
    if (across2 >= reach2) continue;
    half = PetscSqrtReal(reach2 - across2);
    for (PetscInt k = PetscMax(0, (PetscInt)PetscCeilReal((x[up] - half - lower) / bin));
         k < bins && lower + k * bin < x[up] + half; k++) {
      const PetscReal r2 = across2 + PetscSqr(lower + k * bin - x[up]);
      PetscReal       W;

      KernelEvaluate(kernel, 1, &r2, &W, NULL);
      W *= domain->volume;
      if (arrays->integer[INT_LAYER][a])
        share[k].solid += W;
      else
        share[k].liquid += W;
    }
  }
}

/* Height over the lowest point, in bins; -1 without liquid. */
static PetscReal Top(PetscInt bins, const Share share[])
{
  PetscReal before = 0, top = -1;
  PetscInt  last = -1;

  for (PetscInt k = 0; k < bins && (last < 0 || k - last <= GAP); k++) {
    const PetscReal excess = share[k].liquid - HALF * (1 - share[k].solid); /* positive in the liquid */

    if (excess >= 0 && share[k].liquid > 0) {
      last = k;
      top  = k;
    } else if (last == k - 1 && last >= 0)
      top = last + before / (before - excess); /* the zero between the two points */
    before = excess;
  }
  return top;
}

PetscErrorCode HeightsMeasure(Output output, PetscReal height[])
{
  const Domain       domain = output->cloud->domain;
  const GaugeProbes *probes = &output->probes;
  const PetscInt     up     = domain->dim - 1;
  const PetscReal    bin = domain->spacing / BINS, reach = KernelSupport(output->cloud->kernel);
  const PetscInt     bins = (PetscInt)((domain->upper[up] - domain->lower[up]) / bin) + 1;
  Share             *share; /* [heights][bins] */
  ParticleArrays     arrays;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(probes->heights * bins, &share));
  PetscCall(ParticlesOpen(output->cloud->particles, &arrays));
  for (PetscInt h = 0; h < probes->heights; h++) {
    PetscReal  at[DIM] = {0, 0, 0};
    PointImage image[IMAGES_MOST];
    PetscInt   images;

    for (PetscInt d = 0; d < up; d++) at[d] = probes->height_at[up * h + d];
    at[up] = 0.5 * (domain->lower[up] + domain->upper[up]); /* no images through bottom and top */
    images = PointImages(domain, at, PetscMin(reach, 0.5 * (domain->upper[up] - domain->lower[up])), image);
    for (PetscInt k = 0; k < images; k++) AddVertical(output, &arrays, &image[k], bin, bins, share + bins * h);
  }
  PetscCall(ParticlesClose(output->cloud->particles, &arrays));
  PetscCallMPI(
    MPI_Allreduce(MPI_IN_PLACE, share, (PetscMPIInt)(2 * probes->heights * bins), MPIU_REAL, MPIU_SUM, output->comm));
  for (PetscInt h = 0; h < probes->heights; h++)
    height[h] = domain->lower[up] + bin * PetscMax(0, Top(bins, share + bins * h));
  PetscCall(PetscFree(share));
  PetscFunctionReturn(PETSC_SUCCESS);
}
