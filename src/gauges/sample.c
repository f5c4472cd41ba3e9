/* Pressure and velocity at points, interpolated from the particles. */
#include "../operators/operators.h"
#include "../stepper/stepper.h"
#include "gauges_impl.h"

#define SKIN       0.1  /* spacings: a point less deep in a solid is on its surface; triangle files are that exact */
#define LEAST_STEP 0.05 /* spacings: shortest step along a line of sight */
#define FILLED     0.2  /* sum V W from which on a point is in liquid: 1/2 on a flat wall or surface, 1/4 on an edge */
#define SPREAD     0.05 /* spacings^2: the least variance of places that tell a slope; of a full support 0.5 */
#define MOMENTS    10   /* sum V W, V W r and V W r r */
#define SLOPE      (1 + DIM) /* sums of a value: V W f and V W f r */

PetscErrorCode PlacesCheck(Gauges gauges, const char option[], const char what[], PetscInt points, PetscInt coordinates,
                           PetscInt most, Places *places)
{
  const Domain   domain = gauges->cloud->domain;
  const PetscInt width  = points * coordinates;

  PetscFunctionBegin;
  PetscCheckUser(places->numbers % width == 0, gauges->comm, "%s has %d numbers; it needs %d a %s.", option,
                 (int)places->numbers, (int)width, what);
  places->count = places->numbers / width;
  PetscCheckUser(places->count <= most, gauges->comm, "%s has more than %d %ss.", option, (int)most, what);
  for (PetscInt k = 0; k < places->numbers; k++) {
    const PetscInt d = k % coordinates;

    PetscCheckUser(places->at[k] >= domain->lower[d] && places->at[k] <= domain->upper[d], gauges->comm,
                   "%s: %c = %g m of %s %d is not in the box.", option, AxisName(d), (double)places->at[k], what,
                   (int)(k / width) + 1);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool InsideSolid(Gauges gauges, PetscReal distance)
{
  return (PetscBool)(distance < -SKIN * gauges->cloud->domain->spacing);
}

/* Whether a solid lies between the points x and x + r; distance: of x from the nearest solid, m. Sphere tracing: each
   step along r has the length of the distance to the nearest solid, at least LEAST_STEP. */
static PetscBool BehindSolid(Gauges gauges, const PetscReal x[DIM], PetscReal distance, const PetscReal r[DIM])
{
  const PetscReal least = LEAST_STEP * gauges->cloud->domain->spacing, length = PetscSqrtReal(Dot(r, r));

  for (PetscReal traced = 0; traced + distance < length;) {
    PetscReal at[DIM];

    if (InsideSolid(gauges, distance)) return PETSC_TRUE;
    traced += PetscMax(distance, least);
    if (traced >= length) break;
    for (PetscInt d = 0; d < DIM; d++) at[d] = x[d] + traced / length * r[d];
    distance = SceneSolidDistance(gauges->cloud->scene, at, NULL);
  }
  return PETSC_FALSE;
}

PetscInt SampledFields(Gauges gauges, FieldId fields[FIELD_STORED_COUNT])
{
  PetscInt n = 0;

  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++)
    if (Fields[f].carry == CARRY_SCALAR && ParticlesHave(gauges->cloud->particles, f)) fields[n++] = (FieldId)f;
  return n;
}

/* Adds to sum the moments of V W of this rank's fluid around an image of a point, then those of pressure, velocity and
   the n fields. Fluid behind a solid does not count. */
static void AddAround(Gauges gauges, const ParticleArrays *arrays, const Image *image, PetscInt n,
                      const FieldId fields[], PetscReal sum[])
{
  Kernel          kernel   = gauges->cloud->kernel;
  const Domain    domain   = gauges->cloud->domain;
  const PetscReal reach2   = PetscSqr(KernelSupport(kernel)),
                  distance = SceneSolidDistance(gauges->cloud->scene, image->x, NULL);
  const PetscReal *x = arrays->real[FIELD_POSITION], *v = arrays->real[FIELD_VELOCITY];

  for (PetscInt a = 0; a < arrays->n; a++) {
    PetscReal       r[DIM] = {x[DIM * a] - image->x[0], x[DIM * a + 1] - image->x[1], x[DIM * a + 2] - image->x[2]};
    const PetscReal size = ParticleSize(domain, arrays, a), r2 = Dot(r, r) / PetscSqr(size);
    PetscReal       W;

    if (r2 >= reach2 || arrays->integer[INT_LAYER][a] || BehindSolid(gauges, image->x, distance, r)) continue;
    KernelEvaluate(kernel, 1, &r2, &W, NULL);
    W *= ParticleSumVolume(domain, arrays, a) / PetscPowRealInt(size, (int)domain->dim);
    for (PetscInt d = 0; d < DIM; d++) r[d] *= image->sign[d];
    for (PetscInt d = 0; d < DIM; d++) {
      sum[1 + d] += W * r[d];
      sum[1 + DIM + d] += W * r[d] * r[d];
      sum[1 + 2 * DIM + d] += W * r[d == 2 ? 1 : 0] * r[d == 0 ? 1 : 2]; /* xy, xz, yz */
    }
    sum[0] += W;
    for (PetscInt f = 0; f < 1 + DIM + n; f++) {
      const PetscReal value = f == 0     ? arrays->real[FIELD_PRESSURE][a]
                              : f <= DIM ? image->sign[f - 1] * v[DIM * a + f - 1]
                                         : arrays->real[fields[f - 1 - DIM]][a];

      sum[MOMENTS + SLOPE * f] += W * value;
      for (PetscInt d = 0; d < DIM; d++) sum[MOMENTS + SLOPE * f + 1 + d] += W * value * r[d];
    }
  }
}

/* Sets step (m) so that mean f - step.covariance of f and place is the value at the point of the linear function that
   fits f best. It is 0, and the value the Shepard mean, where the point is not in liquid, or few particles tell no
   slope. */
static void StepToPoint(Domain domain, const PetscReal sum[], PetscReal step[DIM])
{
  const PetscReal least = SPREAD * PetscSqr(domain->spacing), *r = sum + 1;
  PetscReal       C[6], B[6];

  for (PetscInt d = 0; d < DIM; d++) {
    step[d]    = 0;
    C[d]       = (sum[1 + DIM + d] - r[d] * r[d] / sum[0]) / sum[0];
    C[DIM + d] = (sum[1 + 2 * DIM + d] - r[d == 2 ? 1 : 0] * r[d == 0 ? 1 : 2] / sum[0]) / sum[0];
  }
  if (sum[0] < FILLED || SymmetricSmallestEigenvalue(domain->dim, C) < least) return;
  SymmetricInverse(domain->dim, C, B);
  TensorApply(B, r[0] / sum[0], r[1] / sum[0], domain->dim == DIM ? r[2] / sum[0] : 0, step);
}

/* The value f at a point from its moments and those of V W. */
static PetscReal ValueAt(const PetscReal sum[], PetscInt f, const PetscReal step[DIM])
{
  const PetscReal *of    = sum + MOMENTS + SLOPE * f;
  PetscReal        value = of[0] / sum[0];

  for (PetscInt d = 0; d < DIM; d++) value -= step[d] * (of[1 + d] - of[0] * sum[1 + d] / sum[0]) / sum[0];
  return value;
}

/* The pressure (Pa) at a point where no liquid is. */
static PetscReal Beside(Gauges gauges, const PetscReal at[])
{
  PetscReal x[DIM] = {0, 0, 0};

  for (PetscInt d = 0; d < gauges->cloud->domain->dim; d++) x[d] = at[d];
  return gauges->run ? StepperBeside((Stepper)gauges->run, x) : 0;
}

PetscErrorCode PointsSample(Gauges gauges, PetscInt count, const PetscReal at[], PetscReal values[])
{
  const Domain   domain = gauges->cloud->domain;
  FieldId        fields[FIELD_STORED_COUNT];
  const PetscInt n = SampledFields(gauges, fields), width = 1 + domain->dim + n, sums = MOMENTS + SLOPE * (1 + DIM + n);
  PetscReal     *sum;
  PetscBool     *inside;
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(count * sums, &sum, count, &inside));
  PetscCall(ParticlesOpen(gauges->cloud->particles, &arrays));
  for (PetscInt p = 0; p < count; p++) {
    Image          image[IMAGES_MOST];
    const PetscInt images = DomainImages(domain, at + domain->dim * p,
                                         gauges->cloud->size_most * KernelSupport(gauges->cloud->kernel), image);

    inside[p] = InsideSolid(gauges, SceneSolidDistance(gauges->cloud->scene, image[0].x, NULL));
    for (PetscInt k = 0; k < images && !inside[p]; k++)
      AddAround(gauges, &arrays, &image[k], n, fields, sum + sums * p);
  }
  PetscCall(ParticlesClose(gauges->cloud->particles, &arrays));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, (PetscMPIInt)(count * sums), MPIU_REAL, MPIU_SUM, gauges->comm));
  for (PetscInt p = 0; p < count; p++) {
    const PetscReal *s     = sum + sums * p;
    PetscReal       *value = values + width * p, step[DIM];

    if (s[0] > 0) {
      StepToPoint(domain, s, step);
      for (PetscInt k = 0; k < width; k++) value[k] = ValueAt(s, k <= domain->dim ? k : k + DIM - domain->dim, step);
    } else {
      value[0] = inside[p] ? NAN : Beside(gauges, at + domain->dim * p);
      for (PetscInt k = 1; k < width; k++) value[k] = NAN;
    }
  }
  PetscCall(PetscFree2(sum, inside));
  PetscFunctionReturn(PETSC_SUCCESS);
}
