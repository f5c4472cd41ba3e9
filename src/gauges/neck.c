/* Diameter of a thread or jet along an axis: columns of the series. The sections of the largest connected piece are
   sums of its particles' volumes with a weight along the axis that is 2 REACH spacings wide. */
#include "gauges_impl.h"

#define BINS  4    /* sections per spacing */
#define REACH 1.5  /* spacings */
#define CLEAR 1.02 /* on both sides of a neck the liquid is thicker by this factor */

static const char *const Axes[] = {"x", "y", "z", "none", NULL};

static const OptionRow options[] = {
  {"-gauge_neck",
   "Axis of a thread or jet: the series has the mean diameter of the largest connected piece along it, and diameter "
   "and place of its neck (m), nan without one",
   NULL, NULL, ROW_WORD, 0, .words = Axes},
  {.name = NULL},
};

static void Defaults_Neck(Gauges gauges, void *data)
{
  *(int *)data = DIM;
}

static PetscErrorCode Check_Neck(Gauges gauges, void *data)
{
  const Domain   domain = gauges->cloud->domain;
  const PetscInt axis   = *(int *)data;

  PetscFunctionBegin;
  PetscCheckUser(axis == DIM || (axis >= DomainFirstStraight(domain) && axis < domain->dim), gauges->comm,
                 "-gauge_neck is %c; it must be %s.", AxisName(axis),
                 domain->rings      ? "y, the axis of the rings"
                 : domain->dim == 2 ? "x or y in two dimensions"
                                    : "x, y or z");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Columns_Neck(Gauges gauges, const void *data, ColumnList *list)
{
  static const char *const names[] = {"neck_diameter", "neck_position", "thread_diameter"};

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(names) && *(const int *)data < DIM; k++)
    PetscCall(ColumnAdd(list, (Column){.unit = "m", .counts = COUNTS_VALUE, .of = OF_PIECE}, "%s", names[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds a volume at z (m over the lower face) to the sections (m2). The weight is a raised cosine. */
static void AddSection(PetscReal z, PetscReal reach, PetscReal volume, PetscReal bin, PetscInt bins,
                       PetscReal section[])
{
  for (PetscInt k = (PetscInt)PetscMax(0, PetscCeilReal((z - reach) / bin - 0.5));
       k < bins && (k + 0.5) * bin < z + reach; k++)
    section[k] += volume * 0.5 / reach * (1 + PetscCosReal(PETSC_PI * ((k + 0.5) * bin - z) / reach));
}

/* Adds the sections of this rank's particles of the piece, and their images in the faces at the ends. A wall has an
   image too: liquid reaches up to it. */
static void AddSections(Gauges gauges, PetscInt axis, const PetscBool main[], PetscReal bin, PetscInt bins,
                        PetscReal section[])
{
  const Cloud     cloud  = gauges->cloud;
  const Domain    domain = cloud->domain;
  const PetscReal length = domain->upper[axis] - domain->lower[axis];

  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal z     = cloud->field[FIELD_POSITION][DIM * a + axis] - domain->lower[axis],
                    reach = REACH * domain->spacing * cloud->size[a];

    if (!main[a]) continue;
    AddSection(z, reach, cloud->volume[a], bin, bins, section);
    for (PetscInt side = 0; side < 2; side++) {
      const FaceType face = domain->face[axis][side];

      if (face == FACE_PERIODIC)
        AddSection(side ? z - length : z + length, reach, cloud->volume[a], bin, bins, section);
      else if (face != FACE_OPEN)
        AddSection(2 * side * length - z, reach, cloud->volume[a], bin, bins, section);
    }
  }
}

/* The bin of the smallest of n diameters with thicker ones on both sides, -1: none. 'before' and 'after' are the
   largest beyond the ends. */
static PetscInt Neck(PetscInt n, const PetscReal diameter[], PetscInt begin, PetscReal before, PetscReal after)
{
  PetscReal *behind, least = PETSC_MAX_REAL;
  PetscInt   neck = -1;

  if (PetscMalloc1(n + 1, &behind)) return -1;
  behind[n] = after;
  for (PetscInt k = n - 1; k >= 0; k--) behind[k] = PetscMax(behind[k + 1], diameter[(begin + k) % n]);
  for (PetscInt k = 0; k < n; k++) {
    const PetscReal d = diameter[(begin + k) % n];

    if (d > 0 && d < least && before > CLEAR * d && behind[k + 1] > CLEAR * d) {
      least = d;
      neck  = (begin + k) % n;
    }
    before = d > 0 ? PetscMax(before, d) : 0;
  }
  (void)PetscFree(behind);
  return neck;
}

/* Diameter, in two dimensions width, and place (m) of the neck, NAN without one; the mean diameter (m) of the piece. */
static PetscErrorCode Measure_Neck(Gauges gauges, const void *data, PetscReal value[])
{
  const Domain    domain = gauges->cloud->domain;
  const PetscInt  axis   = *(const int *)data;
  const PetscReal length = domain->upper[axis] - domain->lower[axis];
  const PetscInt  bins   = PetscMax(1, (PetscInt)(BINS * length / domain->spacing + 0.5));
  const PetscReal bin    = length / bins;
  PetscReal      *diameter, copies = gauges->multiplicity, whole = 1, most = 0, sum = 0;
  PetscInt        filled = 0, begin = 0, neck;
  PetscBool      *main, periodic    = (PetscBool)(domain->face[axis][0] == FACE_PERIODIC);

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(gauges->cloud->n_fluid, &main));
  PetscCall(PetscCalloc1(bins, &diameter));
  PetscCall(ConnectedLargest(gauges, ANY_BODY, main));
  AddSections(gauges, axis, main, bin, bins, diameter);
  PetscCall(PetscFree(main));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, diameter, (PetscMPIInt)bins, MPIU_REAL, MPIU_SUM, gauges->comm));
  for (PetscInt d = 0; d < domain->dim; d++)
    if (d != axis && !DomainIsRadial(domain, d) && !PetscIsInfOrNanReal(GaugeMirror(domain, d, &copies))) whole *= 2;
  for (PetscInt k = 0; k < bins; k++) {
    diameter[k] *= whole;
    if (!DomainIsFlat(domain)) diameter[k] = 2 * PetscSqrtReal(diameter[k] / PETSC_PI);
    most = PetscMax(most, diameter[k]);
    sum += diameter[k];
    filled += diameter[k] > 0;
    if (periodic && diameter[k] <= diameter[begin]) begin = k; /* an end of the piece; else replaced below */
  }
  if (periodic && diameter[begin] > 0) {
    neck = most > CLEAR * diameter[begin] ? begin : -1; /* the thread has no end */
  } else
    neck = Neck(bins, diameter, begin, domain->face[axis][0] == FACE_SYMMETRY && diameter[0] > 0 ? most : 0,
                domain->face[axis][1] == FACE_SYMMETRY && diameter[bins - 1] > 0 ? most : 0);
  value[0] = neck < 0 ? NAN : diameter[neck];
  value[1] = neck < 0 ? NAN : domain->lower[axis] + (neck + 0.5) * bin;
  value[2] = filled ? sum / filled : NAN;
  PetscCall(PetscFree(diameter));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const GaugeKind GaugeNeck = {.bytes    = sizeof(PetscInt),
                             .options  = options,
                             .defaults = Defaults_Neck,
                             .check    = Check_Neck,
                             .columns  = Columns_Neck,
                             .measure  = Measure_Neck};
