/* Eq. (8) without a matrix, as a MATSHELL: y_a = sum_b K_ab (p_a - p_b) + C_a p_a, summed over the pairs of the cloud's
   list; C_a is the closure's addition. Deeper wall particles are folded into their parent (P^T A P), and pairs of wall
   particles are left out.

   A product reads six bytes a pair, the neighbour's index and a weight of sixteen bits. An assembled row would need
   twelve, and its assembly costs six to eight products. Both particles of a pair have the same weight: the operator is
   symmetric, and a constant pressure gives zero to round-off. Rounding the weights, by 8e-6 of the largest, changes a
   row by 3e-6, a thousandth of the error of a sum over 80 neighbours against the Laplacian. */
#include "pressure_impl.h"

#define PAIR_FLOPS 3 /* of a product: subtract, multiply with the weight, add */

const PetscReal *PressureDensity(Pressure pressure)
{
  return pressure->summed ? pressure->cloud->field[FIELD_DENSITY] : pressure->cloud->rest_density;
}

/* Whether the operators divide by one density everywhere. The cloud's factors are then the weights. */
static PetscBool OneDensity(Pressure pressure)
{
  return (PetscBool)(!pressure->summed && SceneOneDensity(pressure->cloud->scene));
}

PetscReal PressureRowWeight(Pressure pressure, PetscInt a)
{
  return RowWeight(pressure, pressure->cloud->volume[a], pressure->cloud->rest_density[a]);
}

/* The weights of SIMD_WIDTH pairs of particle a, the neighbours 'index' with the cloud's factors 'coded'. radius: NULL,
   or the signed distances of rings from the axis, m; one: all have one density. See SetWeights. */
static inline SimdSingle PairWeights(Pressure pressure, PetscBool one, const PetscReal radius[], PetscInt a,
                                     const PetscInt index[], const uint16_t coded[])
{
  typedef uint16_t Coded __attribute__((vector_size(SIMD_WIDTH * sizeof(uint16_t))));
  const PetscReal *density = PressureDensity(pressure), *rest = pressure->cloud->rest_density,
                  *share = pressure->cloud->relative_weight;
  Simd       parts       = share[a] * SimdGather(share, index);
  SimdSingle weight;
  Coded      t;

  (void)memcpy(&t, coded, sizeof(t));
  weight = __builtin_convertvector(t, SimdSingle);
  if (radius) parts *= PETSC_PI * SimdAbs(radius[a] + SimdGather(radius, index)); /* DomainPairLength */
  if (!one) {
    const Simd sum = SimdSet(density[a]) + SimdGather(density, index);

    if (pressure->summed)
      weight *= __builtin_convertvector(rest[a] * 4 * SimdGather(rest, index) / (sum * sum), SimdSingle);
    else
      weight *= __builtin_convertvector(2 * pressure->reference / sum, SimdSingle);
  }
  return weight * __builtin_convertvector(parts, SimdSingle);
}

/* Takes away the weights between particle a and other boundaries, for liquid that pushes. Returns the sum of the rest.
 */
static PetscReal LoosenBounds(Pressure pressure, PetscInt a)
{
  const Cloud cloud = pressure->cloud;
  PetscReal   sum   = 0;

  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    if (CloudBounds(cloud, cloud->list[k])) pressure->pair_weight[k] = 0;
    sum += pressure->pair_weight[k];
  }
  return sum;
}

/* Sets the weights of the pairs of particle a; returns their sum. */
static inline PetscReal RowWeights(Pressure pressure, PetscBool one, const PetscReal radius[], PetscInt a)
{
  const Cloud      cloud = pressure->cloud;
  const PetscInt64 end   = cloud->first[a + 1];
  Simd             sum   = SimdSet(0);

  for (PetscInt64 k = cloud->first[a]; k < end; k += SIMD_WIDTH) { /* the last overwrites those of the next row */
    const SimdSingle weight = PairWeights(pressure, one, radius, a, cloud->list + k, cloud->laplacian + k);

    (void)memcpy(pressure->pair_weight + k, &weight, sizeof(weight));
    sum += SimdFirst(__builtin_convertvector(weight, Simd), (PetscInt)PetscMin(end - k, SIMD_WIDTH));
  }
  if (cloud->pushing && CloudBounds(cloud, a)) return LoosenBounds(pressure, a);
  return SimdSum(sum);
}

/* div(grad p/rho) times V_a/V_0: K_ab = V_a/V_0 V_b 4/(rho_a + rho_b) (-r . grad W)/(r^2 + eta^2), symmetric. Eq. (8),
   with the summed density, has masses: m_a/m_ref m_b 8/(rho_a + rho_b)^2, m_ref that of a particle of the first body.
   For one liquid at rest both are the same. Where the density jumps, the sums with masses are those of lap p: of 2000
   under 1000 kg/m3 at rest, the first pressure was twice too large. With one density weight_scale has all but the
   cloud's factors. Rings: times the shares of both and the length of the ring half-way between. With the exact length
   |r| instead, the Laplacian of r^2 would be wrong by 8 % in the first ring of a lattice, not by 5 %, and that of z^2
   by 26 %, not by 2 %. */
static PetscErrorCode SetWeights(Pressure pressure)
{
  Cloud            cloud = pressure->cloud;
  const PetscInt64 count = cloud->first[cloud->n_owned];
  const PetscBool  one   = OneDensity(pressure);
  PetscReal        scale_w, scale_f, inverse_h2, *radius;

  PetscFunctionBegin;
  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  pressure->weight_scale = 2 * cloud->domain->volume / pressure->reference * scale_f * cloud->laplacian_unit;
  pressure->own_weights  = (PetscBool)(CloudWeighs(cloud) || !one || cloud->pushing);
  if (!pressure->own_weights) PetscFunctionReturn(PETSC_SUCCESS);
  if (count + SIMD_WIDTH > pressure->weight_capacity) { /* rows are read and written in multiples of SIMD_WIDTH */
    pressure->weight_capacity = count + count / 16 + SIMD_WIDTH;
    PetscCall(PetscFree(pressure->pair_weight));
    PetscCall(PetscMalloc1(pressure->weight_capacity, &pressure->pair_weight));
  }
  if (cloud->n_owned > pressure->sum_capacity) {
    pressure->sum_capacity = cloud->capacity;
    PetscCall(PetscFree(pressure->weight_sum));
    PetscCall(PetscMalloc1(pressure->sum_capacity, &pressure->weight_sum));
  }
  PetscCall(CloudGetWork(cloud, 1, &radius));
  for (PetscInt a = 0; a < cloud->n_total && cloud->domain->rings; a++)
    radius[a] = cloud->field[FIELD_POSITION][DIM * a];
  for (PetscInt a = 0; a < cloud->n_owned; a++)
    pressure->weight_sum[a] = RowWeights(pressure, one, cloud->domain->rings ? radius : NULL, a);
  PetscCall(CloudRestoreWork(cloud, &radius));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether particle a may be a neighbour of its own image behind a symmetry or periodic face. This pair has no pressure
   difference and does not count. */
static PetscBool MayMeetItself(Cloud cloud, PetscInt a)
{
  const Domain     domain = cloud->domain;
  const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, reach = cloud->size[a] * KernelSupport(cloud->kernel);

  for (PetscInt d = 0; d < domain->dim; d++) {
    if (domain->face[d][0] == FACE_SYMMETRY && 2 * (x[d] - domain->lower[d]) < reach) return PETSC_TRUE;
    if (domain->face[d][1] == FACE_SYMMETRY && 2 * (domain->upper[d] - x[d]) < reach) return PETSC_TRUE;
    if (domain->face[d][0] == FACE_PERIODIC && domain->upper[d] - domain->lower[d] < reach) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* The sum of the weights of particle a's pairs; itself: those with its own images, too. */
static PetscReal WeightSum(Pressure pressure, PetscInt a, PetscBool itself)
{
  Cloud            cloud = pressure->cloud;
  const PetscInt  *id    = cloud->integer[INT_ID];
  const PetscInt64 end   = cloud->first[a + 1];
  PetscReal        sum   = 0;

  if (!itself && a < cloud->n_fluid && MayMeetItself(cloud, a)) {
    for (PetscInt64 k = cloud->first[a]; k < end; k++) sum += id[cloud->list[k]] == id[a] ? 0 : PairWeight(pressure, k);
  } else
    sum = pressure->own_weights ? pressure->weight_sum[a] : (PetscReal)cloud->laplacian_sum[a];
  return sum;
}

/* Finds whether some particle of some rank is on a free surface or near one (class 1 or 2). If none is, no row is
   closed, however disordered the particles are. With class 1 alone, rows of class 2 beside a void in a full vessel had
   Eq. (9) and no closure: in a gap of two spacings along a piston their velocity doubled from step to step. */
static PetscErrorCode FindFreeSurface(Pressure pressure)
{
  Cloud    cloud = pressure->cloud;
  PetscInt flags = 0;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid && !flags; a++)
    flags = cloud->integer[INT_SURFACE][a] != 0 && !CloudPushes(cloud, a);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &flags, 1, MPIU_INT, MPI_MAX, cloud->comm));
  pressure->free_surface = (PetscBool)(flags > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the diagonal: sums of pairs and closures. Finds whether the null space contains the constant, and how many rows
   are empty. */
static PetscErrorCode SetDiagonal(Pressure pressure)
{
  Cloud    cloud    = pressure->cloud;
  PetscInt count[2] = {0, 0}; /* closed rows, rows without pairs */

  PetscFunctionBegin;
  if (cloud->n_rows > pressure->rows_capacity) {
    pressure->rows_capacity = cloud->capacity;
    PetscCall(PetscFree3(pressure->closure_diagonal, pressure->pair_diagonal, pressure->level_diagonal));
    PetscCall(PetscMalloc3(pressure->rows_capacity, &pressure->closure_diagonal, pressure->rows_capacity,
                           &pressure->pair_diagonal, pressure->rows_capacity, &pressure->level_diagonal));
  }
  for (PetscInt r = 0; r < cloud->n_rows; r++)
    pressure->pair_diagonal[r] = pressure->weight_scale * WeightSum(pressure, r, PETSC_FALSE);
  for (PetscInt a = cloud->n_rows; a < cloud->n_owned; a++)
    pressure->pair_diagonal[ParentRow(pressure, a)] += pressure->weight_scale * WeightSum(pressure, a, PETSC_FALSE);
  for (PetscInt r = 0; r < cloud->n_rows; r++) {
    /* the particle's own image fills its neighbourhood like any other particle */
    const PetscReal filled = r < cloud->n_fluid && MayMeetItself(cloud, r)
                               ? pressure->weight_scale * WeightSum(pressure, r, PETSC_TRUE)
                               : pressure->pair_diagonal[r];

    pressure->closure_diagonal[r] = pressure->closure(pressure, r, filled);
    count[0] += pressure->closure_diagonal[r] > 0;
    count[1] += pressure->pair_diagonal[r] == 0;
    /* A row without entries gets the diagonal of a full row: it may get pairs while the preconditioner is kept. */
    if (pressure->pair_diagonal[r] + pressure->closure_diagonal[r] == 0)
      pressure->closure_diagonal[r] =
        pressure->lattice_diagonal * PressureRowWeight(pressure, r) / PressureDensity(pressure)[r];
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, count, 2, MPIU_INT, MPI_SUM, cloud->comm));
  /* Liquid without a free surface fills the whole box, since a gap would be a surface. So the null space is one
     constant or nothing; FindLevel may find that it is nothing. */
  pressure->constant_null = (PetscBool)(count[0] == 0);
  pressure->empty_rows    = count[1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* sum_b weight (p_a - p_b) over n pairs. Their weights are in 'coded', the cloud's factors, or, if this is NULL, in
   'plain'. The loop reads up to the next multiple of SIMD_WIDTH: into the next row, or the padding behind the last. It
   takes half of the solver's time. */
#if defined(__AVX2__)
static inline PetscReal PairSum(const PetscInt *restrict index, const uint16_t *restrict coded,
                                const float *restrict plain, PetscInt n, const PetscReal *restrict p, PetscReal own)
{
  const Simd all  = SimdSet(own);
  Simd       even = SimdSet(0), odd = even;
  PetscInt   k = 0;

  for (; k + 2 * SIMD_WIDTH <= n; k += 2 * SIMD_WIDTH) {
    even += SimdWeights(coded, plain, k) * (all - SimdGather(p, index + k));
    odd += SimdWeights(coded, plain, k + SIMD_WIDTH) * (all - SimdGather(p, index + k + SIMD_WIDTH));
  }
  for (; k < n; k += SIMD_WIDTH)
    even += SimdFirst(SimdWeights(coded, plain, k), n - k) * (all - SimdGather(p, index + k));
  return SimdSum(even + odd);
}
#else /* with shorter registers the compiler's own loop is faster */
static inline PetscReal PairSum(const PetscInt *restrict index, const uint16_t *restrict coded,
                                const float *restrict plain, PetscInt n, const PetscReal *restrict p, PetscReal own)
{
  PetscReal sum = 0;

  if (coded) {
    SIMD_LOOP(reduction(+ : sum))
    for (PetscInt k = 0; k < n; k++) sum += coded[k] * (own - p[index[k]]);
  } else if (plain) {
    SIMD_LOOP(reduction(+ : sum))
    for (PetscInt k = 0; k < n; k++) sum += plain[k] * (own - p[index[k]]);
  }
  return sum;
}
#endif

/* The same sum over all pairs of particle a. */
static inline PetscReal RowSum(Pressure pressure, PetscInt a, const PetscReal p[])
{
  const Cloud      cloud = pressure->cloud;
  const PetscInt64 first = cloud->first[a];
  const PetscInt   n = (PetscInt)(cloud->first[a + 1] - first), *index = cloud->list + first;

  PairsPrefetch(index, n);
  if (pressure->own_weights)
    PairsPrefetch(pressure->pair_weight + first, n);
  else
    PairsPrefetch(cloud->laplacian + first, n);
  return pressure->own_weights ? PairSum(index, NULL, pressure->pair_weight + first, n, p, p[a])
                               : PairSum(index, cloud->laplacian + first, NULL, n, p, p[a]);
}

PetscErrorCode PressureMultiply(Pressure pressure, const PetscReal p[], PetscReal y[])
{
  Cloud           cloud = pressure->cloud;
  const PetscReal scale = pressure->weight_scale;
  PetscReal      *full;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, 1, &full));
  PetscCall(PetscArraycpy(full, p, cloud->n_rows));
  for (PetscInt a = cloud->n_rows; a < cloud->n_owned; a++) full[a] = p[ParentRow(pressure, a)];
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, full));
  for (PetscInt r = 0; r < cloud->n_rows; r++)
    y[r] = scale * RowSum(pressure, r, full) + pressure->closure_diagonal[r] * full[r];
  for (PetscInt a = cloud->n_rows; a < cloud->n_owned; a++)
    y[ParentRow(pressure, a)] += scale * RowSum(pressure, a, full);
  PetscCall(CloudRestoreWork(cloud, &full));
  PetscCall(LogPairFlops(cloud->first[cloud->n_owned] + cloud->n_owned, PAIR_FLOPS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether terms of low rank hold the level of the pressure, which no closed row does. With L their sum and 1 the
   constant, the preconditioner gets the diagonal L 1 in place of L, which is the same for the constant. */
static PetscErrorCode FindLevel(Pressure pressure)
{
  const PetscInt n     = pressure->cloud->n_rows;
  PetscReal      moved = 0;
  PetscScalar   *one, *level;
  PetscBool      held = PETSC_FALSE;

  PetscFunctionBegin;
  pressure->level_held = PETSC_FALSE;
  for (PetscInt k = 0; k < pressure->low_ranks && pressure->constant_null && !held; k++)
    if (pressure->low_rank[k].term->level)
      PetscCall(pressure->low_rank[k].term->level(pressure->low_rank[k].context, pressure, &held));
  if (!held) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(n, &one));
  PetscCall(PetscCalloc1(n, &level));
  for (PetscInt r = 0; r < n; r++) one[r] = pressure->pair_diagonal[r] > 0 ? 1 : 0;
  for (PetscInt k = 0; k < pressure->low_ranks; k++)
    if (pressure->low_rank[k].term->add)
      PetscCall(pressure->low_rank[k].term->add(pressure->low_rank[k].context, pressure, one, level));
  for (PetscInt r = 0; r < n; r++) {
    pressure->level_diagonal[r] = PetscMax(0, PetscRealPart(level[r] * one[r]));
    moved += pressure->level_diagonal[r];
  }
  PetscCall(PetscFree(level));
  PetscCall(PetscFree(one));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &moved, 1, MPIU_REAL, MPI_SUM, pressure->cloud->comm));
  pressure->level_held    = (PetscBool)(moved > 0); /* while the packing settles, nothing moves */
  pressure->constant_null = (PetscBool)!pressure->level_held;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The product of both operators, without and with the terms of low rank. If the pressure is known up to a constant, a
   constant moves nothing: the component along the constant, from rounding and disorder in these terms, is removed. */
static PetscErrorCode MatMult_Pairs(Mat A, Vec x, Vec y)
{
  Pressure           pressure;
  MatNullSpace       constant = NULL;
  const PetscScalar *p;
  PetscScalar       *sum;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(A, &pressure));
  PetscCall(VecGetArrayRead(x, &p));
  PetscCall(VecGetArrayWrite(y, &sum));
  PetscCall(PressureMultiply(pressure, p, sum));
  if (A == pressure->coupled) {
    for (PetscInt k = 0; k < pressure->low_ranks; k++)
      if (pressure->low_rank[k].term->add)
        PetscCall(pressure->low_rank[k].term->add(pressure->low_rank[k].context, pressure, p, sum));
    PetscCall(MatGetNullSpace(A, &constant));
  } else if (pressure->level_held)
    for (PetscInt r = 0; r < pressure->cloud->n_rows; r++) sum[r] += pressure->level_diagonal[r] * p[r];
  PetscCall(VecRestoreArrayWrite(y, &sum));
  PetscCall(VecRestoreArrayRead(x, &p));
  if (constant) PetscCall(MatNullSpaceRemove(constant, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool PressureIsClosed(Pressure pressure)
{
  return pressure->constant_null;
}

static PetscErrorCode MatGetDiagonal_Pairs(Mat A, Vec d)
{
  Pressure     pressure;
  PetscScalar *value;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(A, &pressure));
  PetscCall(VecGetArrayWrite(d, &value));
  for (PetscInt r = 0; r < pressure->cloud->n_rows; r++) value[r] = PressureDiagonal(pressure, r);
  PetscCall(VecRestoreArrayWrite(d, &value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateShell(Pressure pressure, Mat *A)
{
  const PetscInt n = pressure->cloud->n_rows, all = pressure->rows_global;

  PetscFunctionBegin;
  PetscCall(MatCreateShell(pressure->cloud->comm, n, n, all, all, pressure, A));
  PetscCall(MatShellSetOperation(*A, MATOP_MULT, (void (*)(void))MatMult_Pairs));
  PetscCall(MatShellSetOperation(*A, MATOP_MULT_TRANSPOSE, (void (*)(void))MatMult_Pairs));
  PetscCall(MatShellSetOperation(*A, MATOP_GET_DIAGONAL, (void (*)(void))MatGetDiagonal_Pairs));
  PetscCall(MatSetOption(*A, MAT_SPD, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OperatorSetUp(Pressure pressure)
{
  PetscFunctionBegin;
  PetscCall(FindFreeSurface(pressure));
  PetscCall(SetWeights(pressure));
  PetscCall(SetDiagonal(pressure));
  for (PetscInt k = 0; k < pressure->low_ranks; k++)
    if (pressure->low_rank[k].term->set_up)
      PetscCall(pressure->low_rank[k].term->set_up(pressure->low_rank[k].context, pressure));
  PetscCall(FindLevel(pressure));
  if (!pressure->operator) PetscCall(CreateShell(pressure, &pressure->operator));
  if (!pressure->coupled && pressure->low_ranks) PetscCall(CreateShell(pressure, &pressure->coupled));
  PetscFunctionReturn(PETSC_SUCCESS);
}
