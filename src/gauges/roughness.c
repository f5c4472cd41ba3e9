/* Roughness of the free surface: a column of the series. Around each particle of the surface a quadratic surface is
   fitted to the places of the surface within the kernel's support. What it does not hold are waves as short as the
   support; the scene has none, since particles cannot carry them, so it is their noise. */
#include "gauges_impl.h"

#define TERMS     6 /* 1, u, u2, v, uv, v2 of coordinates u, v along the surface; in two dimensions the first three */
#define DISTINCT  1e-6 /* least sum of squares of a term without its part along those before, supports */
#define SAME_SIDE 0.5  /* least cosine between normals of one surface: the other side of a sheet has -1 */

static const OptionRow options[] = {
  {"-gauge_roughness",
   "Whether the series has the rms roughness of the free surface: what a quadratic surface through the kernel's "
   "support does not hold, noise of the particles that no scene asks for",
   NULL, NULL, ROW_BOOL, 0},
  {.name = NULL},
};

static PetscErrorCode Columns_Roughness(Gauges gauges, const void *data, ColumnList *list)
{
  PetscFunctionBegin;
  if (*(const PetscBool *)data)
    PetscCall(ColumnAdd(list, (Column){.unit = "m", .counts = COUNTS_RUN}, "surface_roughness"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Place (m) and outward normal of the surface of each particle, ghosts too, [n_total][3]. */
static PetscErrorCode Surface(Gauges gauges, PetscReal place[], PetscReal normal[])
{
  const Cloud cloud = gauges->cloud;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *slope = cloud->field[FIELD_NORMAL] + DIM * a, length = PetscMax(Norm(slope), PETSC_SMALL);
    const PetscReal  depth = PressureDepth(gauges->pressure, a);

    for (PetscInt d = 0; d < DIM; d++) {
      normal[DIM * a + d] = -slope[d] / length;
      place[DIM * a + d]  = cloud->field[FIELD_POSITION][DIM * a + d] + depth * normal[DIM * a + d];
    }
  }
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_POINT, place));
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, normal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Two directions across a normal; in two dimensions the second is that out of the plane. */
static void Along(PetscInt dim, const PetscReal n[DIM], PetscReal u[DIM], PetscReal v[DIM])
{
  const PetscBool steep          = (PetscBool)(dim == 3 && PetscAbsReal(n[2]) > 0.5);
  const PetscReal across[2][DIM] = {{0, 0, 1}, {1, 0, 0}};
  PetscReal       length;

  Cross(across[steep], n, u);
  length = Norm(u);
  for (PetscInt d = 0; d < DIM; d++) u[d] /= length;
  Cross(n, u, v);
}

/* The sum of squares that a fit by least squares leaves. M: sums of products of its terms, then of the value, row by
   row; eliminating the terms leaves it in the corner. Negative: the places do not tell all terms apart. */
static PetscReal Remainder(PetscInt terms, PetscReal M[])
{
  const PetscInt n = terms + 1;

  for (PetscInt k = 0; k < terms; k++) {
    if (M[n * k + k] < DISTINCT) return -1;
    for (PetscInt i = k + 1; i < n; i++)
      for (PetscInt j = k + 1; j < n; j++) M[n * i + j] -= M[n * i + k] * M[n * k + j] / M[n * k + k];
  }
  return PetscMax(M[n * n - 1], 0);
}

/* Variance (m2) of the places about the quadratic surface around particle a, without bias: over those that the fit does
   not use up. Negative: there are too few. */
static PetscReal Variance(Cloud cloud, const PetscReal place[], const PetscReal normal[], PetscInt a)
{
  const PetscInt  plane = cloud->domain->dim - 2, terms = plane ? TERMS : TERMS / 2;
  const PetscReal length = KernelSupport(cloud->kernel) * cloud->size[a], *n = normal + DIM * a;
  PetscReal       M[(TERMS + 1) * (TERMS + 1)] = {0}, u[DIM], v[DIM], left;
  PetscInt        count                        = 0;

  Along(cloud->domain->dim, n, u, v);
  for (PetscInt64 k = cloud->first[a] - 1; k < cloud->first[a + 1]; k++) {
    const PetscInt c = k < cloud->first[a] ? a : cloud->list[k];
    PetscReal      r[DIM], term[TERMS + 1];

    if (cloud->integer[INT_LAYER][c] || cloud->integer[INT_SURFACE][c] != 1) continue;
    if (Dot(normal + DIM * c, n) < SAME_SIDE) continue;
    for (PetscInt d = 0; d < DIM; d++) r[d] = (place[DIM * c + d] - place[DIM * a + d]) / length;
    term[0] = 1;
    term[1] = Dot(r, u);
    term[2] = term[1] * term[1];
    if (plane) {
      term[3] = Dot(r, v);
      term[4] = term[1] * term[3];
      term[5] = term[3] * term[3];
    }
    term[terms] = Dot(r, n);
    for (PetscInt i = 0; i <= terms; i++)
      for (PetscInt j = 0; j <= terms; j++) M[(terms + 1) * i + j] += term[i] * term[j];
    count++;
  }
  left = count > terms ? Remainder(terms, M) : -1;
  return left < 0 ? left : left * length * length / (PetscReal)(count - terms);
}

static PetscErrorCode Measure_Roughness(Gauges gauges, const void *data, PetscReal *roughness)
{
  const Cloud    cloud  = gauges->cloud;
  const PetscInt across = cloud->domain->dim - 1;
  PetscReal     *place, *normal, sum[2] = {0, 0}; /* of areas times variances, of areas */

  PetscFunctionBegin;
  *roughness = NAN;
  if (!gauges->pressure) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CloudGetWork(cloud, DIM, &place));
  PetscCall(CloudGetWork(cloud, DIM, &normal));
  PetscCall(Surface(gauges, place, normal));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal area     = PetscPowRealInt(cloud->size[a], (int)across) * cloud->length[a],
                    variance = cloud->integer[INT_SURFACE][a] == 1 ? Variance(cloud, place, normal, a) : -1;

    if (variance < 0) continue;
    sum[0] += area * variance;
    sum[1] += area;
  }
  PetscCall(CloudRestoreWork(cloud, &normal));
  PetscCall(CloudRestoreWork(cloud, &place));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPIU_REAL, MPIU_SUM, gauges->comm));
  if (sum[1] > 0) *roughness = PetscSqrtReal(sum[0] / sum[1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

const GaugeKind GaugeRoughness = {.bytes      = sizeof(PetscBool),
                                  .options    = options,
                                  .columns    = Columns_Roughness,
                                  .measure    = Measure_Roughness,
                                  .needs_sums = PETSC_TRUE};
