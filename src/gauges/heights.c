/* Heights of the free surface at horizontal places: columns of the series, by SPH interpolation along verticals. */
#include "gauges_impl.h"

#define BINS 4   /* sampling points per spacing, along a vertical */
#define GAP  4   /* points, one spacing: a longer gap ends the liquid column */
#define HALF 0.5 /* volume fraction of liquid at the free surface */

static const OptionRow options[] = {
  {"-gauge_heights",
   "Places x,y,x,y,... (in two dimensions x,x,...) of liquid columns whose height is written to the series; a gap of a "
   "spacing ends a column",
   "m", NULL, ROW_NUMBERS, 0, .fallback = "none", .most = (GAUGE_PLACES_MOST + 1) * (DIM - 1)},
  {.name = NULL},
};

static PetscErrorCode Check_Heights(Gauges gauges, void *data)
{
  PetscFunctionBegin;
  PetscCall(PlacesCheck(gauges, "-gauge_heights", "place", 1, gauges->cloud->domain->dim - 1, GAUGE_PLACES_MOST, data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Columns_Heights(Gauges gauges, const void *data, ColumnList *list)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < ((const Places *)data)->count; p++)
    PetscCall(ColumnAdd(list, (Column){.unit = "m", .counts = COUNTS_VALUE, .of = OF_PLACE, .index = p}, "height_%d",
                        (int)p + 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sums of V W at a point: over the liquid, and over walls and solids. */
typedef struct {
  PetscReal liquid, solid;
} VolumeFraction;

/* Adds this rank's particles to the sums at the points lower + k bin of the vertical through an image of a place. */
static void AddVertical(Gauges gauges, const ParticleArrays *arrays, const Image *image, PetscReal bin, PetscInt bins,
                        VolumeFraction fraction[])
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

/* Height of the liquid column over the lowest point, in bins; -1 without liquid. first: its lowest bin. */
static PetscReal Top(PetscInt bins, const VolumeFraction fraction[], PetscInt *first)
{
  PetscReal before = 0, top = -1;
  PetscInt  last = -1;

  *first = bins;
  for (PetscInt k = 0; k < bins && (last < 0 || k - last <= GAP); k++) {
    const PetscReal excess = fraction[k].liquid - HALF * (1 - fraction[k].solid); /* positive in the liquid */

    if (excess >= 0 && fraction[k].liquid > 0) {
      *first = PetscMin(*first, k);
      last   = k;
      top    = k;
    } else if (last == k - 1 && last >= 0)
      top = last + before / (before - excess); /* the zero between the two points */
    before = excess;
  }
  return top;
}

/* Height (m) of the highest wall or solid below z (m) at a place at. */
static PetscReal Bottom(Gauges gauges, const PetscReal at[], PetscReal z)
{
  const Domain    domain = gauges->cloud->domain;
  const PetscInt  up     = domain->dim - 1;
  const PetscReal bin    = domain->spacing / BINS;
  PetscReal       x[DIM] = {0, 0, 0}, above = 0;

  for (PetscInt d = 0; d < up; d++) x[d] = at[d];
  for (x[up] = z; x[up] > domain->lower[up]; x[up] -= bin) {
    const PetscReal s = SceneSolidDistance(gauges->cloud->scene, x, NULL);

    if (s <= 0) return x[up] - (above > 0 ? bin * s / (above - s) : 0); /* the zero between the two points */
    above = s;
  }
  return domain->lower[up];
}

PetscErrorCode HeightsSample(Gauges gauges, PetscInt count, const PetscReal places[], PetscBool thickness,
                             PetscReal height[])
{
  const Domain    domain = gauges->cloud->domain;
  const PetscInt  up     = domain->dim - 1;
  const PetscReal bin = domain->spacing / BINS, reach = gauges->cloud->size_most * KernelSupport(gauges->cloud->kernel);
  const PetscInt  bins = (PetscInt)((domain->upper[up] - domain->lower[up]) / bin) + 1;
  VolumeFraction *fraction; /* [count][bins] */
  ParticleArrays  arrays;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(count * bins, &fraction));
  PetscCall(ParticlesOpen(gauges->cloud->particles, &arrays));
  for (PetscInt h = 0; h < count; h++) {
    PetscReal at[DIM] = {0, 0, 0};
    Image     image[IMAGES_MOST];
    PetscInt  images;

    for (PetscInt d = 0; d < up; d++) at[d] = places[up * h + d];
    at[up] = 0.5 * (domain->lower[up] + domain->upper[up]); /* no images through bottom and top */
    images = DomainImages(domain, at, PetscMin(reach, 0.5 * (domain->upper[up] - domain->lower[up])), image);
    for (PetscInt k = 0; k < images; k++) AddVertical(gauges, &arrays, &image[k], bin, bins, fraction + bins * h);
  }
  PetscCall(ParticlesClose(gauges->cloud->particles, &arrays));
  PetscCallMPI(
    MPI_Allreduce(MPI_IN_PLACE, fraction, (PetscMPIInt)(2 * count * bins), MPIU_REAL, MPIU_SUM, gauges->comm));
  for (PetscInt h = 0; h < count; h++) {
    PetscInt        first;
    const PetscReal top = Top(bins, fraction + bins * h, &first);

    height[h] = domain->lower[up] + bin * PetscMax(0, top);
    if (thickness) {
      const PetscReal bottom = Bottom(gauges, places + up * h, height[h]);

      height[h] = domain->lower[up] + bin * first > bottom + domain->spacing ? 0 : PetscMax(0, height[h] - bottom);
    }
  }
  PetscCall(PetscFree(fraction));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Measure_Heights(Gauges gauges, const void *data, PetscReal height[])
{
  const Places *heights = data;

  PetscFunctionBegin;
  PetscCall(HeightsSample(gauges, heights->count, heights->at, PETSC_FALSE, height));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const GaugeKind GaugeHeights = {.bytes   = sizeof(Places),
                                .options = options,
                                .check   = Check_Heights,
                                .columns = Columns_Heights,
                                .measure = Measure_Heights};
