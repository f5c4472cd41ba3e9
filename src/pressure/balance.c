/* The body force that the pressure carries is balanced exactly.

   The compact Laplacian of Eq. (8) is not exact for a linear pressure on disordered particles, the divergence and the
   corrected gradient are. So a pressure that merely carries weight was wrong at each particle, in proportion to g and
   the disorder, which acted like a viscosity of 0.2 d0 sqrt(g d0) and moved tanks at rest. With S the acceleration that
   the pressure is expected to balance, equation, closure and gradient act on what differs from it:

     sum_b K_ab (p_a - p_b - T_ab.(y_a - y_b)) + c_a (p_a - P_a - T_a.(x_a - x_s)) = source of v* = v + dt (g - S)
     v' = v* - dt (grad p - T)/rho

   T = rho S, T_ab the mean of both; y: the place where a particle's pressure holds: of an image in a mirror that of its
   particle, of a deeper wall particle that of its parent; P: what surface tension and terms of low rank have outside;
   x_s: the surface that row a sees, whose depth follows from |sum V grad W|. The operator is the same, symmetric, and
   with S = 0 so is all else. It is a deferred correction of the compact Laplacian by the corrected gradient, with which
   Fatehi and Manzari (2011) make a Laplacian second order, for the part of the pressure that S knows.

   S = w f, f the body force at the particle. Each particle keeps the share of f that the pressure carried in its last
   step, 1 - |f + a|/|f|, a the acceleration by pressure, cut off below NONE and above ALL: liquid that rests or flows
   slowly has 1, liquid that falls 0, and the noise of both is gone. w is the mean of the kept shares of the liquid
   around that no emitter holds, cut off again; what one holds has no share, and its weight is the emitter's to lift.
   Liquid that has w keeps it while the pressure lifts it by more than f, -a.f/f2 > 1, as in a corner. Liquid in flight
   does not get it there: some of its particles have a = -f by chance where tension or an impact moves it, and with
   -a.f/f2 alone it would know the frame from which it is seen. Without the first cut S repeats its own noise: an impact
   rolled a tenth of its steps back. */
#include "pressure_impl.h"

/* The share of the force below which nothing is carried, and above which all of it: chosen on tanks, waves and impacts.
   The front of a dam break is by 0.98 % beside the reference; with NONE 0.3 and 0.5 by 1.16 and 1.99 %, with ALL 0.6
   and 0.8 by 1.02 and 1.70 %. A tank at rest moves as much with all of them. */
#define NONE 0.4
#define ALL  0.7

/* A share with its noise cut off: 0 below NONE, 1 above ALL. */
static PetscReal Cut(PetscReal share)
{
  return PetscMax(0, PetscMin(1, (share - NONE) / (ALL - NONE)));
}

/* Makes the table of PressureDepth. */
void BalanceSetUp(Pressure pressure)
{
  const Kernel    kernel  = pressure->cloud->kernel;
  const PetscReal support = KernelSupport(kernel);

  for (PetscInt k = 0, j = 0; k <= DEPTH_TABLE; k++) { /* |sum V grad W| falls with the depth */
    PetscReal w = 0;

    for (; j <= DEPTH_FINE * DEPTH_TABLE; j++) {
      KernelHalfSpace(kernel, support * j / (DEPTH_FINE * DEPTH_TABLE), &w, NULL);
      if (w <= pressure->surface_plane * (DEPTH_TABLE - k) / DEPTH_TABLE) break;
    }
    pressure->depth[DEPTH_TABLE - k] = support * PetscMin(1, (PetscReal)j / (DEPTH_FINE * DEPTH_TABLE));
  }
}

PetscReal PressureDepth(Pressure pressure, PetscInt a)
{
  const Cloud     cloud = pressure->cloud;
  const PetscReal size = cloud->size[a], at = DEPTH_TABLE * PetscMin(1, Norm(cloud->field[FIELD_NORMAL] + DIM * a) *
                                                                          size / pressure->surface_plane);
  const PetscInt  k = PetscMin((PetscInt)at, DEPTH_TABLE - 1);

  return size * (pressure->depth[k] + (at - k) * (pressure->depth[k + 1] - pressure->depth[k]));
}

/* The mean of the shares of the liquid around particle a that a pressure moves, by the weights of the Laplacian; alone:
   its own. kept: negative of others. */
static PetscReal MeanShare(Cloud cloud, PetscInt a, const PetscReal kept[])
{
  const PetscInt64 end    = cloud->first[a + 1];
  const Simd       zero   = SimdSet(0);
  Simd             shares = zero, weights = zero;
  PetscReal        weight;

  for (PetscInt64 k = cloud->first[a]; k < end; k += SIMD_WIDTH) {
    const Simd     u      = SimdGather(kept, cloud->list + k);
    const Simd     w      = SimdFirst(SimdCoded(cloud->laplacian, k), (PetscInt)PetscMin(end - k, SIMD_WIDTH));
    const SimdMask liquid = u >= zero;

    shares += (Simd)(liquid & (SimdMask)(w * u));
    weights += (Simd)(liquid & (SimdMask)w);
  }
  weight = SimdSum(weights);
  return weight > 0 ? SimdSum(shares) / weight : PetscMax(0, kept[a]);
}

/* Where the pressures hold: of owned particles, then of ghosts. */
static PetscErrorCode FindPlaces(Pressure pressure)
{
  const Cloud      cloud  = pressure->cloud;
  const Domain     domain = cloud->domain;
  const PetscReal *x      = cloud->field[FIELD_POSITION];
  PetscReal       *y      = pressure->place;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(y, DIM * cloud->n_rows));
  for (PetscInt a = cloud->n_rows; a < cloud->n_owned; a++) {
    const PetscInt r = ParentRow(pressure, a);

    for (PetscInt d = 0; d < DIM; d++) y[DIM * a + d] = x[DIM * r + d] - x[DIM * a + d];
  }
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, y));
  for (PetscInt k = 0; k < DIM * cloud->n_total; k++) y[k] += x[k];
  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt side = 0; side < 2; side++) {
      const PetscReal at = side ? domain->upper[d] : domain->lower[d];

      if (domain->face[d][side] != FACE_SYMMETRY) continue;
      for (PetscInt a = cloud->n_owned; a < cloud->n_total; a++)
        if (side ? y[DIM * a + d] > at : y[DIM * a + d] < at) y[DIM * a + d] = 2 * at - y[DIM * a + d];
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether some liquid of some rank carries a force. */
static PetscErrorCode FindCarried(Pressure pressure)
{
  const Cloud cloud = pressure->cloud;
  PetscInt    found = 0;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid && !found; a++) found = cloud->field[FIELD_CARRIED][a] > 0;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &found, 1, MPIU_INT, MPI_MAX, cloud->comm));
  pressure->carries = (PetscBool)(found && pressure->balanced);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool PressureCarries(Pressure pressure)
{
  return pressure->carries;
}

/* The shares w, [n_total]. */
static PetscErrorCode FindShares(Pressure pressure, PetscReal share[])
{
  const Cloud cloud = pressure->cloud;
  PetscReal  *kept;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, 1, &kept));
  for (PetscInt a = 0; a < cloud->n_owned; a++)
    kept[a] = a < cloud->n_fluid && !PressureHolds(pressure, a) ? cloud->field[FIELD_CARRIED][a] : -1;
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, kept));
  for (PetscInt a = 0; a < cloud->n_owned; a++) share[a] = Cut(MeanShare(cloud, a, kept));
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, share));
  PetscCall(CloudRestoreWork(cloud, &kept));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal PressureShare(Pressure pressure, PetscInt a)
{
  return ShareOf(pressure, a);
}

PetscErrorCode PressurePredict(Pressure pressure)
{
  const Cloud cloud = pressure->cloud;
  PetscReal  *share;

  PetscFunctionBegin;
  pressure->balances = PETSC_FALSE;
  PetscCall(FindCarried(pressure));
  if (!pressure->carries) PetscFunctionReturn(PETSC_SUCCESS);
  if (cloud->n_total >= pressure->balance_capacity) {
    pressure->balance_capacity = cloud->capacity;
    PetscCall(PetscFree3(pressure->carried, pressure->place, pressure->load));
    PetscCall(PetscMalloc3(DIM * cloud->capacity, &pressure->carried, DIM * cloud->capacity, &pressure->place,
                           DIM * cloud->capacity, &pressure->load));
  }
  PetscCall(RowsNumber(pressure));
  PetscCall(FindPlaces(pressure));
  PetscCall(CloudGetWork(cloud, 1, &share));
  PetscCall(FindShares(pressure, share));
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    const PetscReal *y    = pressure->place + DIM * a;
    PetscReal       *load = pressure->load + DIM * a, f[DIM];

    SceneAcceleration(cloud->scene, y, f);
    load[0] = share[a] * cloud->rest_density[a];
    load[1] = Dot(f, y);
    for (PetscInt d = 0; d < DIM; d++) pressure->carried[DIM * a + d] = load[0] * f[d];
  }
  PetscCall(CloudRestoreWork(cloud, &share));
  pressure->uniform  = SceneForceUniform(cloud->scene);
  pressure->balances = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

void PressureTakeCarried(Pressure pressure, PetscReal acceleration[])
{
  const Cloud cloud = pressure->cloud;

  for (PetscInt a = 0; a < cloud->n_fluid && pressure->balances; a++)
    for (PetscInt d = 0; d < DIM && !PressureHolds(pressure, a); d++)
      acceleration[DIM * a + d] -= pressure->carried[DIM * a + d] / cloud->rest_density[a];
}

void PressureKeepCarried(Pressure pressure, const PetscReal rest[])
{
  const Cloud cloud = pressure->cloud;

  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal f[DIM], by[DIM], sum[DIM], size, share = 0;

    SceneAcceleration(cloud->scene, cloud->field[FIELD_POSITION] + DIM * a, f);
    for (PetscInt d = 0; d < DIM; d++) {
      by[d] = rest[DIM * a + d];
      if (pressure->balances) by[d] -= pressure->carried[DIM * a + d] / cloud->rest_density[a];
      sum[d] = f[d] + by[d];
    }
    size = Norm(f);
    if (size > 0)
      share = PetscMax(Cut(1 - Norm(sum) / size), PetscMin(ShareOf(pressure, a), Cut(-Dot(f, by) / (size * size))));
    cloud->field[FIELD_CARRIED][a] = share;
  }
  pressure->balances = PETSC_FALSE;
}

PetscReal PressureSurrounds(Pressure pressure, PetscInt a, PetscReal slope[DIM])
{
  const Cloud      cloud = pressure->cloud;
  const PetscReal *n = cloud->field[FIELD_NORMAL] + DIM * a, *T = pressure->carried + DIM * a, n2 = Dot(n, n);
  PetscReal        P = cloud->field[FIELD_CAPILLARY][a];

  for (PetscInt d = 0; d < DIM && slope; d++) slope[d] = cloud->field[FIELD_CAPILLARY_SLOPE][DIM * a + d];
  if (!pressure->balances || n2 == 0) return P;
  for (PetscInt d = 0; d < DIM && slope; d++) slope[d] -= T[d] - Dot(T, n) / n2 * n[d];
  return P + PressureDepth(pressure, a) * Dot(T, n) / PetscSqrtReal(n2);
}

void BalanceAdd(Pressure pressure, PetscScalar rhs[])
{
  const Cloud     cloud = pressure->cloud;
  const uint16_t *coded = pressure->own_weights ? NULL : cloud->laplacian;

  for (PetscInt a = 0; a < cloud->n_owned && pressure->balances; a++) {
    const PetscInt64 end = cloud->first[a + 1];
    const PetscInt   r   = a < cloud->n_rows ? a : ParentRow(pressure, a);
    const Balance    own = BalanceOf(pressure, a);
    Simd             sum = SimdSet(0), p;

    for (PetscInt64 k = cloud->first[a]; k < end; k += SIMD_WIDTH) {
      const SimdOffsets at = SimdLocate(cloud->list + k);

      sum += SimdFirst(SimdWeights(coded, pressure->pair_weight, k) * BalanceTo(pressure, &own, &at, &p),
                       (PetscInt)PetscMin(end - k, SIMD_WIDTH));
    }
    rhs[r] -= pressure->weight_scale * SimdSum(sum);
  }
}
