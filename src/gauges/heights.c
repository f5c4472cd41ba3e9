/* Heights of the free surface at horizontal places: columns of the series, by SPH interpolation along verticals. */
#include "gauges_impl.h"

#define BINS 4   /* sampling points per spacing, along a vertical */
#define GAP  4   /* points, one spacing: a longer gap ends the liquid column */
#define HALF 0.5 /* volume fraction of liquid at the free surface */

static PetscErrorCode SetFromOptions_Heights(Gauges gauges, OptionItems PetscOptionsObject)
{
  Places *heights = &gauges->heights;

  PetscFunctionBegin;
  heights->numbers = (GAUGE_PLACES_MOST + 1) * (DIM - 1); /* room for one place too many, to refuse it */
  PetscCall(
    PetscOptionsRealArray("-gauge_heights",
                          "Places x,y,x,y,... (in two dimensions x,x,...) of liquid columns whose height is written "
                          "to the series, m; a gap of a spacing ends a column; default: none",
                          "GaugesMeasure", heights->at, &heights->numbers, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Check_Heights(Gauges gauges)
{
  PetscFunctionBegin;
  PetscCall(PlacesCheck(gauges, "-gauge_heights", "place", gauges->cloud->domain->dim - 1, GAUGE_PLACES_MOST,
                        &gauges->heights));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt Columns_Heights(Gauges gauges)
{
  return gauges->heights.count;
}

static PetscErrorCode Name_Heights(Gauges gauges, PetscInt column, char name[], size_t length)
{
  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(name, length, "height_%d_m", (int)column + 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sums of V W at a point: over the liquid, and over walls and solids. */
typedef struct {
  PetscReal liquid, solid;
} VolumeFraction;

/* Adds this rank's particles to the sums at the points lower + k bin of the vertical through an image of a place. */
static void AddVertical(Gauges gauges, const ParticleArrays *arrays, const PointImage *image, PetscReal bin,
                        PetscInt bins, VolumeFraction fraction[])
{
  const Domain    domain   = gauges->cloud->domain;
  const Kernel    kernel   = gauges->cloud->kernel;
  const PetscInt  up       = domain->dim - 1;
  const PetscReal support2 = PetscSqr(KernelSupport(kernel)), lower = domain->lower[up];

  for (PetscInt a = 0; a < arrays->n; a++) {
    const PetscReal *x    = arrays->real[FIELD_POSITION] + DIM * a;
    const PetscReal  size = ParticleSize(domain, arrays, a), reach2 = support2 * PetscSqr(size);
    PetscReal        across2 = 0, half;

    for (PetscInt d = 0; d < up; d++) across2 += PetscSqr(x[d] - image->x[d]);
    if (across2 >= reach2) continue;
    half = PetscSqrtReal(reach2 - across2);
    for (PetscInt k = PetscMax(0, (PetscInt)PetscCeilReal((x[up] - half - lower) / bin));
         k < bins && lower + k * bin < x[up] + half; k++) {
      const PetscReal r2 = (across2 + PetscSqr(lower + k * bin - x[up])) / PetscSqr(size);
      PetscReal       W;

      KernelEvaluate(kernel, 1, &r2, &W, NULL);
      W *= ParticleSumVolume(domain, arrays, a) / PetscPowRealInt(size, (int)domain->dim);
      if (arrays->integer[INT_LAYER][a])
        fraction[k].solid += W;
      else
        fraction[k].liquid += W;
    }
  }
}

/* Height of the liquid column over the lowest point, in bins; -1 without liquid. */
static PetscReal Top(PetscInt bins, const VolumeFraction fraction[])
{
  PetscReal before = 0, top = -1;
  PetscInt  last = -1;

  for (PetscInt k = 0; k < bins && (last < 0 || k - last <= GAP); k++) {
    const PetscReal excess = fraction[k].liquid - HALF * (1 - fraction[k].solid); /* positive in the liquid */

    if (excess >= 0 && fraction[k].liquid > 0) {
      last = k;
      top  = k;
    } else if (last == k - 1 && last >= 0)
      top = last + before / (before - excess); /* the zero between the two points */
    before = excess;
  }
  return top;
}

/* Height (m) of the liquid column at each place. The column ends where the volume fraction of liquid, sum V W over the
   fluid divided by 1 - sum V W over walls and solids, stays below a half for a spacing. Without liquid, the bottom of
   the box. */
static PetscErrorCode Measure_Heights(Gauges gauges, PetscReal height[])
{
  const Domain    domain = gauges->cloud->domain;
  const Places   *places = &gauges->heights;
  const PetscInt  up     = domain->dim - 1;
  const PetscReal bin = domain->spacing / BINS, reach = gauges->cloud->size_most * KernelSupport(gauges->cloud->kernel);
  const PetscInt  bins = (PetscInt)((domain->upper[up] - domain->lower[up]) / bin) + 1;
  VolumeFraction *fraction; /* [heights][bins] */
  ParticleArrays  arrays;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(places->count * bins, &fraction));
  PetscCall(ParticlesOpen(gauges->cloud->particles, &arrays));
  for (PetscInt h = 0; h < places->count; h++) {
    PetscReal  at[DIM] = {0, 0, 0};
    PointImage image[IMAGES_MOST];
    PetscInt   images;

    for (PetscInt d = 0; d < up; d++) at[d] = places->at[up * h + d];
    at[up] = 0.5 * (domain->lower[up] + domain->upper[up]); /* no images through bottom and top */
    images = PointImages(domain, at, PetscMin(reach, 0.5 * (domain->upper[up] - domain->lower[up])), image);
    for (PetscInt k = 0; k < images; k++) AddVertical(gauges, &arrays, &image[k], bin, bins, fraction + bins * h);
  }
  PetscCall(ParticlesClose(gauges->cloud->particles, &arrays));
  PetscCallMPI(
    MPI_Allreduce(MPI_IN_PLACE, fraction, (PetscMPIInt)(2 * places->count * bins), MPIU_REAL, MPIU_SUM, gauges->comm));
  for (PetscInt h = 0; h < places->count; h++)
    height[h] = domain->lower[up] + bin * PetscMax(0, Top(bins, fraction + bins * h));
  PetscCall(PetscFree(fraction));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const GaugeKind GaugeHeights = {.setfromoptions = SetFromOptions_Heights,
                                .check          = Check_Heights,
                                .columns        = Columns_Heights,
                                .name           = Name_Heights,
                                .measure        = Measure_Heights};
