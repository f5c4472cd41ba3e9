/* Parts of the search: units of positions, lines of cells, room for the list; the kernel of a row. */
#include "search.h"

#define ROW_GUESS 72 /* neighbours of a particle: first guess of the size of the list */
#define BOX_BITS  30
#define OUTSIDE   1.5 /* the integers cover so many box lengths from the middle of the box, plus */
#define REACHES   4   /* so many times the largest support */

Units SearchUnits(Cloud cloud)
{
  const Domain domain = cloud->domain;
  Units        units  = {{0}, {0}, {0}};

  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal length = domain->upper[d] - domain->lower[d],
                    needed = OUTSIDE * length + REACHES * cloud->size_most * cloud->reach;
    int bits               = BOX_BITS;

    while (PetscPowRealInt(2, 31 - bits) * length < needed) bits--;
    units.center[d]  = 0.5 * (domain->lower[d] + domain->upper[d]);
    units.inverse[d] = PetscPowRealInt(2, bits) / length;
    units.unit[d]    = (float)(1 / (units.inverse[d] * KernelSmoothingLength(cloud->kernel)));
  }
  return units;
}

void LinesSet(const CellGrid *grid, PetscInt dim, PetscInt reach, Lines *lines)
{
  const PetscInt width = 2 * reach + 1, layers = dim == 3 ? reach : 0;

  lines->count = width * (2 * layers + 1);
  for (PetscInt l = 0; l < LINES_MOST; l++) {
    const PetscInt y = l % width - reach, z = l / width - layers;

    lines->y[l]       = y;
    lines->z[l]       = l < lines->count ? z : -reach - 1 - grid->n[2]; /* outside */
    lines->cells[l]   = CellIndex(grid->n, 0, y, z);
    lines->from_y[l]  = (float)(y > 0 ? y : y < 0 ? -y - 1 : 0);
    lines->times_y[l] = (float)(y > 0 ? -1 : y < 0 ? 1 : 0);
    lines->from_z[l]  = (float)(z > 0 ? z : z < 0 ? -z - 1 : 0);
    lines->times_z[l] = (float)(z > 0 ? -1 : z < 0 ? 1 : 0);
  }
}

PetscInt LinesCandidates(PetscInt reach, PetscInt longest)
{
  return LINES(reach) * ((2 * reach * SPLIT + 1) * longest + LANES);
}

PetscInt64 CloudListRoom(PetscInt64 used, PetscInt rows, PetscInt most)
{
  return used + PetscMax(most, used / 8 + (PetscInt64)ROW_GUESS * rows) + most;
}

PetscErrorCode ReserveList(Cloud cloud, PetscInt64 pairs)
{
  const size_t room = (size_t)pairs;

  PetscFunctionBegin;
  cloud->list_capacity = pairs;
  PetscCall(PetscRealloc(room * sizeof(PetscInt), &cloud->list));
  PetscCall(PetscRealloc(room * sizeof(float), &cloud->slope));
  PetscCall(PetscRealloc(room * sizeof(uint16_t), &cloud->laplacian));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt DropWallPairs(const PetscInt layer[], PetscInt n, const PetscInt list[], uint16_t laplacian[])
{
  PetscInt sum = 0;

  for (PetscInt k = 0; k < n; k++) {
    if (layer[list[k]]) laplacian[k] = 0;
    sum += laplacian[k];
  }
  return sum;
}

void FindWeights(Cloud cloud)
{
  const Domain     domain = cloud->domain;
  const PetscReal *x      = cloud->field[FIELD_POSITION];
  const PetscBool  weighs = CloudWeighs(cloud);

  for (PetscInt a = 0; a < cloud->n_total && cloud->weight != cloud->size; a++) {
    cloud->length[a]          = DomainRingLength(domain, x + DIM * a, cloud->size[a]);
    cloud->weight[a]          = cloud->volume[a] / (cloud->length[a] * domain->volume);
    cloud->relative_weight[a] = weighs ? cloud->weight[a] / PetscPowRealInt(cloud->size[a], (int)domain->dim) : 1;
  }
}

void WeightRow(Cloud cloud, PetscInt n, const PetscInt list[], float *restrict w, float *restrict slope)
{
  for (PetscInt k = 0; k < n; k += SIMD_WIDTH) {
    const SimdSingle share = __builtin_convertvector(SimdGather(cloud->relative_weight, list + k), SimdSingle);

    if (w) SimdScaleSingle(share, w + k);
    SimdScaleSingle(share, slope + k);
  }
}

/* Sets r2 of a graded particle's row, over the square of each pair's size. */
static void ScaleRow(Cloud cloud, PetscInt a, const PairRow *row, PetscReal r2[])
{
  for (PetscInt k = 0; k < row->n; k++) r2[k] = row->r2[k] / PetscSqr(CloudPairSize(cloud, a, row->index[k]));
}

void PairRowEvaluate(Cloud cloud, PetscInt a, PairRow *row)
{
  PetscReal r2[ROW_CAPACITY];

  if (!cloud->domain->graded) {
    KernelEvaluate(cloud->kernel, row->n, row->r2, row->W, NULL);
    return;
  }
  ScaleRow(cloud, a, row, r2);
  KernelEvaluate(cloud->kernel, row->n, r2, row->W, NULL);
  for (PetscInt k = 0; k < row->n; k++)
    row->W[k] *= PetscPowRealInt(1 / CloudPairSize(cloud, a, row->index[k]), (int)cloud->domain->dim);
}

void PairRowGradient(Cloud cloud, PetscInt a, PairRow *row)
{
  PetscReal r2[ROW_CAPACITY];

  if (!cloud->domain->graded) {
    KernelGradient(cloud->kernel, row->n, row->r2, row->F);
    return;
  }
  ScaleRow(cloud, a, row, r2);
  KernelGradient(cloud->kernel, row->n, r2, row->F);
  for (PetscInt k = 0; k < row->n; k++)
    row->F[k] *= PetscPowRealInt(1 / CloudPairSize(cloud, a, row->index[k]), (int)cloud->domain->dim + 2);
}
