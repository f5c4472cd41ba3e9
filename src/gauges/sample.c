/* Pressure and velocity at points, interpolated from the particles. */
#include "../stepper/stepper.h"
#include "gauges_impl.h"

#define SKIN       0.1  /* spacings: a point less deep in a solid is on its surface; triangle files are that exact */
#define LEAST_STEP 0.05 /* spacings: shortest step along a line of sight */

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

/* Adds V W, V W p, V W v and V W times the n fields of this rank's fluid around an image to sum. Fluid behind a solid
   does not count. */
static void AddAround(Gauges gauges, const ParticleArrays *arrays, const Image *image, PetscInt n,
                      const FieldId fields[], PetscReal sum[])
{
  Kernel          kernel   = gauges->cloud->kernel;
  const Domain    domain   = gauges->cloud->domain;
  const PetscReal reach2   = PetscSqr(KernelSupport(kernel)),
                  distance = SceneSolidDistance(gauges->cloud->scene, image->x, NULL);
  const PetscReal *x = arrays->real[FIELD_POSITION], *v = arrays->real[FIELD_VELOCITY];

  for (PetscInt a = 0; a < arrays->n; a++) {
    const PetscReal r[DIM] = {x[DIM * a] - image->x[0], x[DIM * a + 1] - image->x[1], x[DIM * a + 2] - image->x[2]};
    const PetscReal size = ParticleSize(domain, arrays, a), r2 = Dot(r, r) / PetscSqr(size);
    PetscReal       W;

    if (r2 >= reach2 || arrays->integer[INT_LAYER][a] || BehindSolid(gauges, image->x, distance, r)) continue;
    KernelEvaluate(kernel, 1, &r2, &W, NULL);
    W *= ParticleSumVolume(domain, arrays, a) / PetscPowRealInt(size, (int)domain->dim);
    sum[0] += W;
    sum[1] += W * arrays->real[FIELD_PRESSURE][a];
    for (PetscInt d = 0; d < DIM; d++) sum[2 + d] += W * image->sign[d] * v[DIM * a + d];
    for (PetscInt f = 0; f < n; f++) sum[2 + DIM + f] += W * arrays->real[fields[f]][a];
  }
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
  const PetscInt n = SampledFields(gauges, fields), width = 1 + domain->dim + n, sums = 2 + DIM + n;
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
    const PetscReal *s = sum + sums * p;

    if (s[0] > 0)
      values[width * p] = s[1] / s[0];
    else
      values[width * p] = inside[p] ? NAN : Beside(gauges, at + domain->dim * p);
    for (PetscInt d = 0; d < domain->dim; d++) values[width * p + 1 + d] = s[0] > 0 ? s[2 + d] / s[0] : NAN;
    for (PetscInt f = 0; f < n; f++) values[width * p + 1 + domain->dim + f] = s[0] > 0 ? s[2 + DIM + f] / s[0] : NAN;
  }
  PetscCall(PetscFree2(sum, inside));
  PetscFunctionReturn(PETSC_SUCCESS);
}
