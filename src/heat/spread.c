/* Conduction between particles, m_a c_a dT_a/dt = sum over b of what a pair conducts (W):

     Q_ab = 2 V_a V_b k_ab F_ab (T_b - T_a)/C_ab,    k_ab = 2 k_a k_b/(k_a + k_b),    C_ab = (C_a + C_b)/2

   the sum of Brookshaw (1985) with the mean of Cleary and Monaghan (1999). F = -W'/r. C_a is the second moment of the
   sum, sum V_b r^2 F_ab/dim inside, 1 but for the places of the particles. What a gives is what b gets.

   A dummy particle has what its receiver makes it have: the temperature falls along a straight line through that of
   the wall's face, or with the slope q/k. It is s in front of the face and z behind it, and T_b - T_a is
   (T_w - T_a) (s + z)/s, or q (s + z)/k.

   In time: Runge, Kutta, Legendre of second order (Meyer, Balsara and Aslam 2014). With s stages it is stable in steps
   of (s^2 + s - 2)/4 times the explicit limit, so the stages follow from the step, as the iterations of an implicit
   step would: as few of them, but each conserves heat to rounding, and no tolerance is left. */
#include "../operators/liquid_row.h"
#include "heat_impl.h"

#define STAGES_LEAST 3
#define BOUNDARY     0.25 /* of w1(0): more is beside a boundary */
#define LEAST_MOMENT 0.25 /* of spray, whose few pairs would conduct without bound */

static PetscReal Harmonic(PetscReal k, PetscReal l)
{
  return k + l > 0 ? 2 * k * l / (k + l) : 0;
}

/* The receiver that dummy particle b stands for, and how far (m) the fluid particle at x is in front of its face and b
   behind it; -1: it is insulated. Behind an edge of the box b stands for the face that it is farther behind, if both
   hold something. depth: of b in its solid. */
static PetscInt FindReceiver(Cloud cloud, const Scalar *scalar, const PetscReal x[DIM], PetscInt b, PetscReal depth,
                             PetscReal *front, PetscReal *behind)
{
  const Domain     domain  = cloud->domain;
  const PetscReal *y       = cloud->field[FIELD_POSITION] + DIM * b;
  const PetscReal  closest = WALL_CLOSEST * domain->spacing;
  const PetscInt   body    = cloud->integer[INT_BODY][b];
  PetscInt         found   = -1, nearest;

  *behind = 0;
  if (body <= BODY_SOLID) {
    found   = 2 * DIM + BODY_SOLID - body;
    *behind = depth;
    *front  = SceneSolidDistance(cloud->scene, x, &nearest);
    if (nearest != BODY_SOLID - body) *front = SceneOneDistance(cloud->scene, BODY_SOLID - body, x);
    *front = PetscMax(closest, *front);
    return SideOf(cloud->scene, scalar, found) ? found : -1;
  }
  for (PetscInt f = 0; f < 2 * domain->dim; f++) {
    const PetscInt  d = f / 2, side = f % 2;
    const PetscReal sign = side ? 1 : -1, face = side ? domain->upper[d] : domain->lower[d],
                    beyond = sign * (y[d] - face);

    if (domain->face[d][side] != FACE_WALL || beyond <= 0) continue;
    if (!SideOf(cloud->scene, scalar, f)) return -1;
    if (beyond <= *behind) continue;
    found   = f;
    *behind = beyond;
    *front  = PetscMax(closest, sign * (face - x[d]));
  }
  return found;
}

/* Adds to what fluid particle a exchanges with a receiver; its own entries are the last ones, from 'first' on. */
static PetscErrorCode Add(HeatSpread *spread, PetscInt first, HeatExchange more)
{
  PetscInt k = first;

  PetscFunctionBegin;
  while (k < spread->count && spread->exchange[k].receiver != more.receiver) k++;
  if (k == spread->room) {
    spread->room = 2 * spread->room + 64;
    PetscCall(PetscRealloc((size_t)spread->room * sizeof(*spread->exchange), &spread->exchange));
  }
  if (k == spread->count)
    spread->exchange[spread->count++] = more;
  else {
    spread->exchange[k].inflow += more.inflow;
    spread->exchange[k].conductance += more.conductance;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The second moment of the pairs of fluid particle a that conduct. Beside a boundary that nothing crosses the others
   are missing, and what they leave conducts along the boundary: the moment is that across the normal n, the sum of V
   grad W, which is w1(0) at the boundary and fades within the kernel. M: xx yy zz xy xz yz. */
static PetscReal SecondMoment(Cloud cloud, PetscInt a, const PetscReal M[6], const PetscReal n[DIM])
{
  const PetscReal size = Norm(n), trace = M[0] + M[1] + M[2];
  PetscReal       plane, across[DIM], share;

  KernelHalfSpace(cloud->kernel, 0, &plane, NULL);
  share = PetscMin(1, size * cloud->size[a] / (BOUNDARY * plane));
  if (share * size == 0) return trace / cloud->domain->dim;
  TensorApply(M, n[0], n[1], n[2], across);
  return (trace - share * Dot(n, across) / (size * size)) / (cloud->domain->dim - share);
}

/* 2 V_a V_b F_ab (m, per metre in a plane) of the pairs of fluid particle a into pair[], 0 if nothing crosses them, and
   C_a. depth ([n_total]): see FindReceiver. */
static PetscReal FindRow(Cloud cloud, const Scalar *scalar, PetscInt a, const PetscReal depth[], PairRow *row,
                         PetscReal pair[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, V = cloud->domain->volume;
  PetscReal        M[6] = {0}, n[DIM] = {0, 0, 0}, front, behind;

  PairRowLoadGeometry(cloud, cloud->field[FIELD_POSITION], a, row);
  PairRowGradient(cloud, a, row);
  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt  b    = row->index[k];
    const PetscReal F    = -V * cloud->weight[b] * row->F[k];
    const PetscReal r[3] = {row->dx[k], row->dy[k], row->dz[k]};

    pair[k] = 0;
    if (cloud->integer[INT_LAYER][b] && FindReceiver(cloud, scalar, x, b, depth[b], &front, &behind) < 0) continue;
    pair[k] = V * cloud->weight[a] * F * (cloud->length[a] + cloud->length[b]);
    for (PetscInt d = 0; d < DIM; d++) {
      n[d] -= F * r[d];
      M[d] += F * r[d] * r[d];
    }
    M[3] += F * r[0] * r[1];
    M[4] += F * r[0] * r[2];
    M[5] += F * r[1] * r[2];
  }
  return PetscMax(LEAST_MOMENT, SecondMoment(cloud, a, M, n));
}

/* What fluid particle a exchanges by the pair of it and dummy particle b, whose strength is 2 V_a V_b F_ab/C_a. */
static PetscErrorCode AddWall(HeatSpread *spread, PetscInt first, Cloud cloud, const Scalar *scalar, PetscInt a,
                              PetscInt b, PetscReal depth, PetscReal strength)
{
  const PetscReal k = ScalarOf(cloud->scene, scalar, cloud->integer[INT_BODY][a])->conductivity;
  PetscReal       front, behind;
  const PetscInt  receiver =
    FindReceiver(cloud, scalar, cloud->field[FIELD_POSITION] + DIM * a, b, depth, &front, &behind);
  const Side  *side = receiver >= 0 ? SideOf(cloud->scene, scalar, receiver) : NULL;
  HeatExchange more = {.a = a, .receiver = receiver};

  PetscFunctionBegin;
  if (!side) PetscFunctionReturn(PETSC_SUCCESS);
  more.conductance = side->holds ? strength * k * (front + behind) / front : 0;
  more.inflow      = side->holds ? more.conductance * side->value : strength * side->flux * (front + behind);
  PetscCall(Add(spread, first, more));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What it exchanges with the air, by its part of the surface, whose curvature is kappa (1/m). */
static PetscErrorCode AddAir(HeatSpread *spread, Cloud cloud, const Air *air, PetscInt a, PetscReal kappa)
{
  const PetscReal give = air->transfer * OperatorsSurfaceArea(cloud, a, kappa);

  PetscFunctionBegin;
  if (give > 0)
    PetscCall(Add(spread, spread->count,
                  (HeatExchange){.a = a, .receiver = OF_AIR, .inflow = give * air->ambient, .conductance = give}));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes the pairs of fluid particle a those of its conductivity, and adds what it exchanges. C ([n_total]), depth;
   kappa: [n_fluid] of OperatorsCurvatures, NULL: the air takes nothing. */
static PetscErrorCode CompleteRow(HeatSpread *spread, Cloud cloud, const Scalar *scalar, PetscInt a,
                                  const PetscReal C[], const PetscReal depth[], const PetscReal kappa[])
{
  const Scene     scene = cloud->scene;
  const PetscReal own   = ScalarOf(scene, scalar, cloud->integer[INT_BODY][a])->conductivity;
  const PetscInt  first = spread->count;
  PetscReal       sum   = 0;

  PetscFunctionBegin;
  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    const PetscInt b = cloud->list[k];

    if (spread->pair[k] == 0) continue;
    if (cloud->integer[INT_LAYER][b]) {
      PetscCall(AddWall(spread, first, cloud, scalar, a, b, depth[b], spread->pair[k] / C[a]));
      spread->pair[k] = 0;
    } else
      spread->pair[k] *=
        Harmonic(own, ScalarOf(scene, scalar, cloud->integer[INT_BODY][b])->conductivity) * 2 / (C[a] + C[b]);
    sum += 2 * spread->pair[k];
  }
  if (kappa) PetscCall(AddAir(spread, cloud, (const Air *)SceneOwn(scene, scalar->air), a, kappa[a]));
  for (PetscInt k = first; k < spread->count; k++) sum += spread->exchange[k].conductance;
  spread->fastest = PetscMax(spread->fastest, sum / ScalarStore(cloud, scalar, a)); /* Gershgorin's circle */
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SpreadFind(HeatSpread *spread, Cloud cloud, const Scalar *scalar)
{
  const Air *air = scalar->air ? (const Air *)SceneOwn(cloud->scene, scalar->air) : NULL;
  PetscReal *C, *depth, *kappa = NULL;
  PairRow    row;

  PetscFunctionBegin;
  if (cloud->first[cloud->n_fluid] > spread->capacity) {
    spread->capacity = cloud->first[cloud->n_fluid] + cloud->first[cloud->n_fluid] / 4;
    PetscCall(PetscFree(spread->pair));
    PetscCall(PetscMalloc1(spread->capacity, &spread->pair));
  }
  spread->count   = 0;
  spread->fastest = 0;
  PetscCall(CloudGetWork(cloud, 1, &C));
  PetscCall(CloudGetWork(cloud, 1, &depth));
  OperatorsDepths(cloud, depth);
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    C[a] = FindRow(cloud, scalar, a, depth, &row, spread->pair + cloud->first[a]);
  for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++) C[a] = 1;
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, C));
  if (air && air->transfer > 0) {
    PetscCall(CloudGetWork(cloud, 1, &kappa));
    PetscCall(OperatorsCurvatures(cloud, kappa));
  }
  for (PetscInt a = 0; a < cloud->n_fluid; a++) PetscCall(CompleteRow(spread, cloud, scalar, a, C, depth, kappa));
  if (kappa) PetscCall(CloudRestoreWork(cloud, &kappa));
  PetscCall(CloudRestoreWork(cloud, &depth));
  PetscCall(CloudRestoreWork(cloud, &C));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void SpreadFlows(const HeatSpread *spread, const PetscReal T[], PetscReal flow[RECEIVERS])
{
  for (PetscInt r = 0; r < RECEIVERS; r++) flow[r] = 0;
  for (const HeatExchange *e = spread->exchange; e < spread->exchange + spread->count; e++)
    flow[e->receiver] += e->inflow - e->conductance * T[e->a];
}

/* rate ([n_fluid], K/s) at T ([n_total], whose ghosts it updates), and the flows. */
static PetscErrorCode Rate(const HeatSpread *spread, Cloud cloud, const Scalar *scalar, PetscReal T[], PetscReal rate[],
                           PetscReal flow[RECEIVERS])
{
  PetscFunctionBegin;
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, T));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    rate[a] = 0;
    for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++)
      rate[a] += spread->pair[k] * (T[cloud->list[k]] - T[a]);
  }
  for (const HeatExchange *e = spread->exchange; e < spread->exchange + spread->count; e++)
    rate[e->a] += e->inflow - e->conductance * T[e->a];
  for (PetscInt a = 0; a < cloud->n_fluid; a++) rate[a] /= ScalarStore(cloud, scalar, a);
  SpreadFlows(spread, T, flow);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A state of the stages: the values ([n_total]), and what the receivers have given. */
typedef struct {
  PetscReal *T, gained[RECEIVERS];
} Stage;

/* b_j of Meyer et al. */
static PetscReal Legendre(PetscInt j)
{
  return j < 2 ? 1. / 3 : (PetscReal)(j * j + j - 2) / (2 * j * (j + 1));
}

/* Y_j of s stages, from Y_0, Y_(j-1), Y_(j-2) and the rates and flows of the first two, into Y_(j-2). */
static void Combine(PetscInt n, PetscInt j, PetscReal first, const Stage *zero, const Stage *one, Stage *two,
                    const Stage *rate_zero, const Stage *rate_one)
{
  const PetscReal b = Legendre(j), mu = (2. * j - 1) / j * b / Legendre(j - 1),
                  nu = -(j - 1.) / j * b / Legendre(j - 2), step = mu * first, back = -(1 - Legendre(j - 1)) * step;

  for (PetscInt a = 0; a < n; a++)
    two->T[a] =
      mu * one->T[a] + nu * two->T[a] + (1 - mu - nu) * zero->T[a] + step * rate_one->T[a] + back * rate_zero->T[a];
  for (PetscInt r = 0; r < RECEIVERS; r++)
    two->gained[r] =
      mu * one->gained[r] + nu * two->gained[r] + step * rate_one->gained[r] + back * rate_zero->gained[r];
}

PetscErrorCode SpreadStep(HeatSpread *spread, Cloud cloud, const Scalar *scalar, PetscReal dt,
                          PetscReal gained[RECEIVERS])
{
  const PetscInt n       = cloud->n_fluid;
  Stage          zero    = {.gained = {0}}, one, two, at_zero, at_one;
  PetscReal      fastest = spread->fastest, first;
  PetscInt       stages;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(gained, RECEIVERS));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &fastest, 1, MPIU_REAL, MPIU_MAX, cloud->comm));
  stages = PetscMax(STAGES_LEAST, (PetscInt)PetscCeilReal(0.5 * (PetscSqrtReal(9 + 8 * dt * fastest) - 1)));
  first  = 4. / (stages * stages + stages - 2) * dt;
  zero.T = cloud->field[scalar->field];
  two    = zero;
  PetscCall(CloudGetWork(cloud, 1, &one.T));
  PetscCall(CloudGetWork(cloud, 1, &two.T));
  PetscCall(CloudGetWork(cloud, 1, &at_zero.T));
  PetscCall(CloudGetWork(cloud, 1, &at_one.T));
  PetscCall(Rate(spread, cloud, scalar, zero.T, at_zero.T, at_zero.gained));
  PetscCall(PetscArraycpy(two.T, zero.T, cloud->n_owned));
  PetscCall(PetscArraycpy(one.T, zero.T, cloud->n_owned)); /* dummy particles, too, whose pairs are zero */
  for (PetscInt a = 0; a < n; a++) one.T[a] = zero.T[a] + Legendre(1) * first * at_zero.T[a];
  for (PetscInt r = 0; r < RECEIVERS; r++) one.gained[r] = Legendre(1) * first * at_zero.gained[r];
  for (PetscInt j = 2; j <= stages; j++) {
    const Stage before = one;

    PetscCall(Rate(spread, cloud, scalar, one.T, at_one.T, at_one.gained));
    Combine(n, j, first, &zero, &one, &two, &at_zero, &at_one);
    one = two;
    two = before;
  }
  PetscCall(PetscArraycpy(zero.T, one.T, n));
  PetscCall(PetscArraycpy(gained, one.gained, RECEIVERS));
  PetscCall(CloudRestoreWork(cloud, &at_one.T));
  PetscCall(CloudRestoreWork(cloud, &at_zero.T));
  PetscCall(CloudRestoreWork(cloud, &two.T));
  PetscCall(CloudRestoreWork(cloud, &one.T));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The change of the value of fluid particle a by a shift dr, within the range of the neighbours. */
static PetscReal Taylor(Cloud cloud, const PetscReal T[], PetscInt a, const PetscReal dr[DIM])
{
  PetscReal low = T[a], high = T[a], along[DIM], change = 0;
  LiquidRow row;

  LiquidRowLoad(cloud, a, &row);
  TensorApply(row.B, dr[0], dr[1], dr[2], along);
  for (PetscInt k = 0; k < row.n; k++) {
    const PetscReal its = T[row.index[k]];

    low  = PetscMin(low, its);
    high = PetscMax(high, its);
    if (row.enough) change += row.f[k] * (its - T[a]) * Dot(row.d[k], along);
  }
  return PetscMax(low, PetscMin(high, T[a] + change)) - T[a];
}

PetscErrorCode SpreadShift(Cloud cloud, const Scalar *scalar, const PetscReal moved[])
{
  PetscReal *T = cloud->field[scalar->field], *change, sum[2] = {0, 0}; /* of what is gained, and lost */

  PetscFunctionBegin;
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, T));
  PetscCall(CloudGetWork(cloud, 1, &change));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *dr = moved + DIM * a;

    change[a] = dr[0] != 0 || dr[1] != 0 || dr[2] != 0 ? Taylor(cloud, T, a, dr) : 0;
    sum[change[a] < 0] += ScalarStore(cloud, scalar, a) * PetscAbsReal(change[a]);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPIU_REAL, MPIU_SUM, cloud->comm));
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    if (change[a] != 0) T[a] += change[a] * PetscMin(1, sum[change[a] > 0] / sum[change[a] < 0]);
  PetscCall(CloudRestoreWork(cloud, &change));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SpreadFree(HeatSpread *spread)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(spread->pair));
  PetscCall(PetscFree(spread->exchange));
  PetscFunctionReturn(PETSC_SUCCESS);
}
