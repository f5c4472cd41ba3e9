/* Pressure and velocity at fixed points, interpolated from the fluid. */
#include "output_impl.h"

static const char *const AxisNames[DIM] = {"x", "y", "z"};

PetscErrorCode PointsSetFromOptions(Output output, OptionItems PetscOptionsObject)
{
  GaugePoints *points = &output->points;

  PetscFunctionBegin;
  points->numbers = (GAUGE_POINTS_MOST + 1) * DIM; /* more than allowed, to notice it */
  PetscCall(PetscOptionsRealArray("-gauge_points",
                                  "Points whose pressure and velocity the series holds, x,y,z,x,y,z,... (in two "
                                  "dimensions x,y,x,y,...), m",
                                  "OutputPoints", points->at, &points->numbers, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PointsCheck(Output output)
{
  const Domain domain = output->cloud->domain;
  GaugePoints *points = &output->points;

  PetscFunctionBegin;
  PetscCheckUser(points->numbers % domain->dim == 0, output->comm, "-gauge_points has %d numbers; it needs %d a point.",
                 (int)points->numbers, (int)domain->dim);
  points->count = points->numbers / domain->dim;
  PetscCheckUser(points->count <= GAUGE_POINTS_MOST, output->comm, "-gauge_points has more than %d points.",
                 GAUGE_POINTS_MOST);
  for (PetscInt k = 0; k < points->numbers; k++) {
    const PetscInt d = k % domain->dim;

    PetscCheckUser(points->at[k] >= domain->lower[d] && points->at[k] <= domain->upper[d], output->comm,
                   "-gauge_points: %s = %g m of point %d is not in the box.", AxisNames[d], (double)points->at[k],
                   (int)(k / domain->dim) + 1);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt PointsColumns(Output output)
{
  return output->points.count * (1 + output->cloud->domain->dim);
}

PetscErrorCode PointsName(Output output, PetscInt column, char name[], size_t length)
{
  const PetscInt width = 1 + output->cloud->domain->dim, point = column / width, part = column % width;

  PetscFunctionBegin;
  if (part == 0)
    PetscCall(PetscSNPrintf(name, length, "point_%d_pressure_Pa", (int)point + 1));
  else
    PetscCall(PetscSNPrintf(name, length, "point_%d_velocity_%s_m/s", (int)point + 1, AxisNames[part - 1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt PointImages(Domain domain, const PetscReal at[], PetscReal reach, PointImage image[IMAGES_MOST])
{
  PetscInt count = 1;

  for (PetscInt d = 0; d < DIM; d++) {
    image[0].x[d]    = d < domain->dim ? at[d] : 0;
    image[0].sign[d] = 1;
  }
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscInt  before = count;
    const PetscReal length = domain->upper[d] - domain->lower[d];

    for (PetscInt side = 0; side < 2; side++) {
      const PetscReal face = side ? domain->upper[d] : domain->lower[d];
      const FaceType  type = domain->face[d][side];

      if ((type != FACE_PERIODIC && type != FACE_SYMMETRY) || PetscAbsReal(at[d] - face) >= reach) continue;
      for (PetscInt k = 0; k < before; k++) {
        PointImage *copy = &image[count++];

        *copy = image[k];
        if (type == FACE_PERIODIC)
          copy->x[d] += side ? -length : length;
        else {
          copy->x[d]    = 2 * face - copy->x[d];
          copy->sign[d] = -1;
        }
      }
    }
  }
  return count;
}

/* Adds to sum: V W, V W p, V W v of the fluid of this rank around an image. */
static void AddAround(Output output, const ParticleArrays *arrays, const PointImage *image, PetscReal sum[2 + DIM])
{
  Kernel           kernel = output->cloud->kernel;
  const PetscReal  reach2 = PetscSqr(KernelSupport(kernel)), volume = output->cloud->domain->volume;
  const PetscReal *x = arrays->real[FIELD_POSITION], *v = arrays->real[FIELD_VELOCITY];

  for (PetscInt a = 0; a < arrays->n; a++) {
    const PetscReal r[DIM] = {x[DIM * a] - image->x[0], x[DIM * a + 1] - image->x[1], x[DIM * a + 2] - image->x[2]};
    const PetscReal r2     = Dot(r, r);
    PetscReal       W;

    if (r2 >= reach2 || arrays->integer[INT_LAYER][a]) continue;
    KernelEvaluate(kernel, 1, &r2, &W, NULL);
    W *= volume;
    sum[0] += W;
    sum[1] += W * arrays->real[FIELD_PRESSURE][a];
    for (PetscInt d = 0; d < DIM; d++) sum[2 + d] += W * image->sign[d] * v[DIM * a + d];
  }
}

PetscErrorCode PointsSample(Output output, PetscInt count, const PetscReal at[], PetscReal values[])
{
  const Domain   domain = output->cloud->domain;
  const PetscInt width  = 1 + domain->dim;
  PetscReal     *sum;
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(count * (2 + DIM), &sum));
  PetscCall(ParticlesOpen(output->cloud->particles, &arrays));
  for (PetscInt p = 0; p < count; p++) {
    PointImage     image[IMAGES_MOST];
    const PetscInt images = PointImages(domain, at + domain->dim * p, KernelSupport(output->cloud->kernel), image);

    for (PetscInt k = 0; k < images; k++) AddAround(output, &arrays, &image[k], sum + (2 + DIM) * p);
  }
  PetscCall(ParticlesClose(output->cloud->particles, &arrays));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, (PetscMPIInt)(count * (2 + DIM)), MPIU_REAL, MPIU_SUM, output->comm));
  for (PetscInt p = 0; p < count; p++) {
    const PetscReal *s = sum + (2 + DIM) * p;

    values[width * p] = s[0] > 0 ? s[1] / s[0] : 0;
    for (PetscInt d = 0; d < domain->dim; d++) values[width * p + 1 + d] = s[0] > 0 ? s[2 + d] / s[0] : NAN;
  }
  PetscCall(PetscFree(sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputPoints(Output output, PetscReal values[])
{
  PetscFunctionBegin;
  if (!output->points.count) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_GAUGES), 0, 0, 0, 0));
  PetscCall(PointsSample(output, output->points.count, output->points.at, values));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_GAUGES), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
