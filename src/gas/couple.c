/* Pockets of gas in the pressure equation. Each has one unknown pressure P (over that of the open air), which acts on
   its rows like surface tension. With c_r the closure of row r times the pocket's share of what row r sees outside, s
   the volume whose row has the weight 1, and Q* the rate of the pocket's volume without the pressure, at whose start it
   is Q,

     A p - c P = b,   Q' = Q* - dt s (c^T (p - sigma kappa) - C P),   P = P(V) - K dt ((a + b) Q' - b Q),   K = gamma
   P/V,

   C = c^T share + S, V at the positions of the sums, in the middle of the step; b = 1/4, a = 0 is stable for any step
   and has no damping. Without P the equation is (A - c (D + C)^-1 c^T) p = b + c (D + C)^-1 g, D = 1/(K dt^2 (a + b)
   s): symmetric and positive. Gas of constant volume has D = 0.

   S: rows in a film see gas on both sides, and its difference of pressure pushes them by the slope of their share, as
   the gradient has it; with area_r the change of the volume if row r moves, S = sum area_r . acceleration_r/s. In a
   film of two spacings the volume moves 20 times as much as without S; Q', too large by then, grew from step to step.
   Without sigma kappa, of curvature and slopes, a pocket of constant volume is too large by dt^2 C sigma kappa.

   Steps that do not resolve the gas damp it: a = 1/4 where K s C dt^2, an upper bound of the square of its frequency
   times the step, is large. A bubble of ten spacings has a third to a fourth of that frequency: it is damped only with
   less than some twelve steps in a period. It is the idea of Goldade, Aanjaneya and Batty 2020, of Caboussat, Picasso
   and Rappaz 2005 on grids: gas without density has one pressure.

   The volume that the cells show is rough: 1 % of V is 1.4 kPa of air at 1 atm. So V follows its flux, the derivative
   of the cells' sums by the velocities, and relaxes to the cells in MEMORY relaxation times.

   A void, which has no gas, is a pocket of the constant volume 0: what it has is taken from it in MEMORY relaxation
   times.

   Rows that see neither gas nor air nor a void, or are not beside a free surface (gaps between particles that are no
   surface, rows that the flow has stretched), have the pressure around them outside: with m the mean of the liquid
   neighbours, their closure c p becomes c (1 - m)(1 - m)^T p, but for its part HELD, which has the former m outside:
   with 0 there, gaps of liquid under suction opened from step to step. Where there is open air and no pocket they keep
   0, as dry dummy particles have. What else was tried: cases/breathing_bubble/tried.md. */
#include "gas_impl.h"

#define CENTRED 0.25 /* b */
#define DAMPED                                                                                                         \
  0.25 /* a, from RESOLVED + UNRESOLVED on; a bottle glugs at 0.25 s, with 0.125 too, with 0.5 at 0.18 s               \
        */
#define RESOLVED   3.5 /* bound of the frequency times the step below which a = 0 */
#define UNRESOLVED 4
#define MEMORY     4    /* relaxation times of the pressure in which the cells correct a volume */
#define COUNTS     0.1  /* cells that are emptier count for what a row sees */
#define HOLD       0.3  /* of what a volume lacks, that an iteration of the settling gives back */
#define HELD       0.2  /* of the closure of a gap that stays; 0.1 and 0.4 move a rising bubble by 0.02 and 0.05 % */
#define LEVEL      0.05 /* of C, that constant volumes without open air get besides: else the level is free */
#define LEAST      0.1  /* of the volume by the cells: the tracked one is not less */

void GasForget(Gas *gas)
{
  gas->rows = gas->areas = gas->gaps = gas->gapped = gas->yields = 0;
  gas->now.count                                                 = 0;
}

/* The mean of p ([n_total]) of the liquid around particle a; alone: 0. */
static PetscReal MeanAround(Cloud cloud, PetscInt a, const PetscReal p[], PetscInt *n)
{
  PetscReal sum = 0;

  *n = 0;
  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    if (cloud->integer[INT_LAYER][cloud->list[k]]) continue;
    sum += p[cloud->list[k]];
    (*n)++;
  }
  return *n ? sum / *n : 0;
}

/* Lists the liquid beside gaps, of this rank and of others. */
static PetscErrorCode FindTies(Gas *gas)
{
  const Cloud cloud = gas->cloud;
  PetscReal  *is;

  PetscFunctionBegin;
  gas->ties   = 0;
  gas->gapped = gas->gaps;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &gas->gapped, 1, MPIU_INT, MPI_SUM, cloud->comm));
  if (!gas->gapped) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CloudGetWork(cloud, 1, &is));
  PetscCall(PetscArrayzero(is, cloud->n_total));
  for (PetscInt g = 0; g < gas->gaps; g++) is[gas->gap[g]] = 1;
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, is));
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
      if (is[cloud->list[k]] == 0 || cloud->integer[INT_LAYER][cloud->list[k]]) continue;
      PetscCall(ListGrow(gas->ties, &gas->ties_capacity, sizeof(*gas->tie), &gas->tie));
      gas->tie[gas->ties++] = (GasTie){a, cloud->list[k]};
    }
  PetscCall(CloudRestoreWork(cloud, &is));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y += share c ((1 - m)(1 - m)^T - 1) p of all gaps, but for their part HELD. */
static PetscErrorCode AddGaps(const Gas *gas, Pressure pressure, PetscReal share, const PetscScalar p[],
                              PetscScalar y[])
{
  const Cloud      cloud   = gas->cloud;
  const PetscReal *closure = PressureClosure(pressure);
  PetscReal       *all, *pull;

  PetscFunctionBegin;
  if (!gas->gapped || share == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CloudGetWork(cloud, 1, &all));
  PetscCall(CloudGetWork(cloud, 1, &pull));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) all[a] = PetscRealPart(p[a]);
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, all));
  for (PetscInt g = 0; g < gas->gaps; g++) {
    const PetscInt  a = gas->gap[g];
    PetscInt        n;
    const PetscReal mean = MeanAround(cloud, a, all, &n), c = share * (1 - HELD) * closure[a];

    pull[a] = 0;
    if (!n) continue;
    y[a] -= c * mean;
    pull[a] = c / n * (all[a] - mean);
  }
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, pull));
  for (const GasTie *tie = gas->tie; tie < gas->tie + gas->ties; tie++) y[tie->row] -= pull[tie->gap];
  PetscCall(CloudRestoreWork(cloud, &pull));
  PetscCall(CloudRestoreWork(cloud, &all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddRow(Gas *gas, const GasRow *row)
{
  PetscFunctionBegin;
  PetscCall(ListGrow(gas->rows, &gas->rows_capacity, sizeof(*gas->row), &gas->row));
  gas->row[gas->rows++] = *row;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What a particle sees of one region: the kernel's sum over the empty parts of cells, and its gradient; the same over
   whole cells times their volumes. */
typedef struct {
  PetscInt  region;
  PetscReal sum, slope[DIM], volume, area[DIM];
} Sight;
typedef struct {
  PetscInt  n;
  PetscReal size;
  PetscBool moves; /* a dummy particle of a solid that moves */
  Sight     each[GAS_SHARE];
} View;

/* The weight of the part of a solid, s: behind its dummy particles, a solid is hollow. In front of what is dry as well
   as of what is wet, the weighted grad s integrates to what grad s does if the solid is full. */
static PetscReal SolidWeight(PetscReal s)
{
  return 6 * s * (1 - s);
}

static void See(const GasCells *cells, const GasNear *near, void *context)
{
  View *view = (View *)context;

  for (PetscInt m = 0; m < near->n; m++) {
    const PetscInt  node = near->node[m], region = cells->owner[node];
    const PetscReal empty = 1 - cells->filled[node], F = near->F[m] / view->size,
                    volume = near->volume[m] * (view->moves ? SolidWeight(cells->solid[node]) : 1);
    PetscInt k             = 0;
    Sight   *sight;

    while (k < view->n && view->each[k].region != region) k++;
    if (k == GAS_SHARE) continue;
    sight = &view->each[k];
    if (k == view->n) {
      view->n++;
      *sight = (Sight){.region = region};
    }
    sight->volume += volume * near->W[m];
    for (PetscInt d = 0; d < DIM; d++) sight->area[d] += volume * F * near->image->sign[d] * near->r[m][d];
    if (empty < COUNTS) continue;
    sight->sum += empty * near->W[m];
    for (PetscInt d = 0; d < DIM; d++) sight->slope[d] += empty * F * near->image->sign[d] * near->r[m][d];
  }
}

/* Adds the rows of particle a, which is beside a free surface, or the gap that it is. */
static PetscErrorCode AddSights(Gas *gas, PetscInt a, const View *view)
{
  Sight all = {0};

  PetscFunctionBegin;
  for (const Sight *each = view->each; each < view->each + view->n; each++) {
    all.sum += each->sum;
    for (PetscInt d = 0; d < DIM; d++) all.slope[d] += each->slope[d];
  }
  if (all.sum == 0 || !gas->cloud->integer[INT_SURFACE][a]) {
    PetscCall(ListGrow(gas->gaps, &gas->gaps_capacity, sizeof(*gas->gap), &gas->gap));
    gas->gap[gas->gaps++] = a;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (const Sight *each = view->each; each < view->each + view->n; each++) {
    GasRow row = {.row = a, .pocket = each->region - 1};

    if (each->region == GAS_AIR || each->sum == 0) continue;
    row.share = each->sum / all.sum;
    for (PetscInt d = 0; d < DIM; d++) {
      row.slope[d] = (each->slope[d] - row.share * all.slope[d]) / all.sum;
      row.area[d]  = -GasPart(gas->cloud, a, PressureFull(gas->pressure)) * each->area[d];
    }
    PetscCall(AddRow(gas, &row));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddAreas(Gas *gas, PetscInt a, const View *view)
{
  const PetscReal part = GasPart(gas->cloud, a, PressureFull(gas->pressure));

  PetscFunctionBegin;
  for (const Sight *each = view->each; each < view->each + view->n; each++) {
    GasArea *area;

    if (each->region == GAS_AIR) continue;
    PetscCall(ListGrow(gas->areas, &gas->areas_capacity, sizeof(*gas->area), &gas->area));
    area  = &gas->area[gas->areas++];
    *area = (GasArea){.particle = a, .pocket = each->region, .lengthened = part * each->volume};
    for (PetscInt d = 0; d < DIM; d++) area->area[d] = -part * each->area[d];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GasFindRows(Gas *gas)
{
  Cloud     cloud = gas->cloud;
  GasCells *cells = gas->now.cells;

  PetscFunctionBegin;
  gas->rows = gas->areas = gas->gaps = gas->yields = 0;
  gas->layout                                      = cloud->layout;
  if (gas->now.count && gas->solids_move) PetscCall(GasCellsSolid(cells, cloud, PressureFull(gas->pressure)));
  for (PetscInt a = 0; a < cloud->n_owned && GasSeen(gas); a++) {
    const PetscBool row = (PetscBool)(a < cloud->n_fluid && PressureCloses(gas->pressure, a));
    View            view;

    if (!row && gas->frozen) continue;
    view.n     = 0;
    view.size  = cloud->size[a];
    view.moves = (PetscBool)(gas->solids_move && cloud->integer[INT_BODY][a] <= BODY_SOLID);
    GasCellsNear(cells, cloud, row ? &cells->seen : &cells->held, a, PETSC_TRUE, See, &view);
    if (row) PetscCall(AddSights(gas, a, &view));
    if (!gas->frozen) PetscCall(AddAreas(gas, a, &view));
  }
  PetscCall(FindTies(gas));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How fast the volumes of the pockets grow (m3/s, [count + 1] from 1 on) with the velocities v ([n_owned][3], m/s);
 *fastest: the largest of them that count. */
static PetscErrorCode Rates(const Gas *gas, const PetscReal v[], PetscReal rate[], PetscReal *fastest)
{
  const PetscInt   n = gas->now.count + 1;
  const PetscReal *x = gas->cloud->field[FIELD_POSITION];

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(rate, n));
  *fastest = 0;
  for (const GasArea *area = gas->area; area < gas->area + gas->areas; area++) {
    const PetscInt a = DIM * area->particle;

    rate[area->pocket] +=
      Dot(area->area, v + a) + area->lengthened * DomainLengthening(gas->cloud->domain, x + a, v + a);
    *fastest = PetscMax(*fastest, Norm(v + a));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, fastest, 1, MPIU_REAL, MPIU_MAX, gas->cloud->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, rate, (PetscMPIInt)n, MPIU_REAL, MPIU_SUM, gas->cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the rows are of the cloud's present order. While the packing settles, the liquid in a closed vessel decides
   how much it leaves to the gas. */
static PetscBool Acts(const Gas *gas)
{
  return (PetscBool)(gas->found && gas->layout == gas->cloud->layout && (gas->open || !gas->frozen));
}

/* q = (D + C)^-1 y */
static PetscErrorCode Solve(const Gas *gas, PetscReal y[], PetscReal q[])
{
  Vec right, left;

  PetscFunctionBegin;
  PetscCall(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, gas->now.count, y, &right));
  PetscCall(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, gas->now.count, q, &left));
  PetscCall(MatSolve(gas->factor, right, left));
  PetscCall(VecDestroy(&right));
  PetscCall(VecDestroy(&left));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The loads of the pockets that act: those of this step, or of the last. */
static PetscErrorCode FindLoads(Gas *gas, Pockets **pockets)
{
  PetscFunctionBegin;
  *pockets         = Acts(gas) ? &gas->now : &gas->before;
  gas->loads.count = 0;
  if ((*pockets)->count)
    PetscCall(GasCellsLoads((*pockets)->cells, gas->cloud, PressureFull(gas->pressure), &gas->loads));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What floats gives way to the gas: with d the loads, M its inertia and S the divergence of the rows by its motion, c
   becomes c - S M^-1 d, and C gets d M^-1 d. It has more rows, which see no gas. */
static PetscErrorCode AddYields(Gas *gas, Pressure pressure)
{
  const Cloud     cloud = gas->cloud;
  const PetscReal s     = cloud->domain->volume;
  const PetscInt  n     = gas->now.count;
  PetscReal      *force, *acceleration, *y, *given;
  PetscInt        touched[GAS_MOST];
  Pockets        *pockets;

  PetscFunctionBegin;
  PetscCall(FindLoads(gas, &pockets));
  PetscCall(PetscCalloc1(n * n, &given));
  PetscCall(PetscArrayzero(touched, n));
  for (const GasLoad *l = gas->loads.load; l < gas->loads.load + gas->loads.count; l++)
    touched[l->pocket - 1] |= cloud->integer[INT_BODY][l->dummy] <= BODY_SOLID;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, touched, (PetscMPIInt)n, MPIU_INT, MPI_MAX, cloud->comm));
  PetscCall(CloudGetWork(cloud, DIM, &force));
  PetscCall(CloudGetWork(cloud, DIM, &acceleration));
  PetscCall(CloudGetWork(cloud, 1, &y));
  for (PetscInt k = 0; k < n; k++) {
    if (!touched[k]) continue;
    PetscCall(PetscArrayzero(force, DIM * cloud->n_total));
    PetscCall(PetscArrayzero(acceleration, DIM * cloud->n_total));
    PetscCall(PetscArrayzero(y, cloud->n_rows));
    for (const GasLoad *l = gas->loads.load; l < gas->loads.load + gas->loads.count; l++)
      for (PetscInt d = 0; d < DIM && l->pocket == k + 1; d++) force[DIM * l->dummy + d] += l->unit[d];
    PetscCall(PressureYield(pressure, force, acceleration, y));
    for (const GasLoad *l = gas->loads.load; l < gas->loads.load + gas->loads.count; l++)
      given[k * n + l->pocket - 1] += Dot(l->unit, acceleration + DIM * l->dummy) / s;
    for (PetscInt r = 0; r < cloud->n_rows; r++) {
      const GasRow row = {.row = r, .pocket = k, .closure = -y[r]};

      if (y[r] == 0) continue;
      PetscCall(AddRow(gas, &row));
      gas->yields++;
    }
  }
  PetscCall(CloudRestoreWork(cloud, &y));
  PetscCall(CloudRestoreWork(cloud, &acceleration));
  PetscCall(CloudRestoreWork(cloud, &force));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, given, (PetscMPIInt)(n * n), MPIU_REAL, MPIU_SUM, cloud->comm));
  for (PetscInt i = 0; i < n * n; i++) gas->matrix[i] += given[i];
  PetscCall(PetscFree(given));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the rows q .. end - 1, which are those of one particle, to C, and to moved ([count]) what its pressure and
   tension do to the volumes. S is symmetric and not negative: area is parallel to bend, or taken so. */
static void AssembleRow(Gas *gas, Pressure pressure, PetscInt q, PetscInt end, PetscReal moved[])
{
  const Cloud     cloud = gas->cloud;
  const PetscInt  n = gas->now.count, a = gas->row[q].row;
  const PetscReal kept = PressureKeptShare(pressure), s = cloud->domain->volume;
  PetscReal       slope[DIM], pull[DIM], along = 0, bent = 0;
  const PetscReal outside = kept * cloud->field[FIELD_PRESSURE][a] + (1 - kept) * PressureSurrounds(pressure, a, slope);

  PressureSlopeAcceleration(pressure, a, slope, pull);
  for (GasRow *r = gas->row + q; r < gas->row + end; r++) {
    PressureSlopeAcceleration(pressure, a, r->slope, r->bend);
    along += Dot(r->area, r->bend) / s;
    bent += Dot(r->bend, r->bend);
    moved[r->pocket] += r->closure * outside + (1 - kept) * Dot(r->area, pull) / s;
  }
  for (const GasRow *r = gas->row + q; r < gas->row + end; r++) /* rows that see several pockets couple them */
    for (const GasRow *t = gas->row + q; t < gas->row + end; t++)
      gas->matrix[r->pocket * n + t->pocket] +=
        r->closure * t->share + (along > 0 ? along / bent * Dot(r->bend, t->bend) : 0);
}

/* C, and the rates of the volumes without the pressure and at the start. */
static PetscErrorCode Assemble(Gas *gas, Pressure pressure)
{
  const Cloud      cloud   = gas->cloud;
  const PetscReal *closure = PressureClosure(pressure), kept = PressureKeptShare(pressure), dt = PressureStep(pressure);
  const PetscInt   n = gas->now.count;
  PetscReal        moved[GAS_MOST], fastest;

  PetscFunctionBegin;
  PetscCall(PetscFree(gas->matrix));
  PetscCall(PetscCalloc1(n * n, &gas->matrix));
  PetscCall(PetscArrayzero(moved, n));
  gas->rows -= gas->yields;
  gas->yields = 0;
  for (GasRow *r = gas->row; r < gas->row + gas->rows; r++)
    r->closure = PressureRow(pressure, r->row) < 0 ? 0 : closure[r->row] * r->share;
  for (PetscInt q = 0, end; q < gas->rows; q = end) {
    for (end = q; end < gas->rows && gas->row[end].row == gas->row[q].row; end++)
      ;
    AssembleRow(gas, pressure, q, end, moved);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, gas->matrix, (PetscMPIInt)(n * n), MPIU_REAL, MPIU_SUM, cloud->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, moved, (PetscMPIInt)n, MPIU_REAL, MPIU_SUM, cloud->comm));
  if (gas->frozen) PetscFunctionReturn(PETSC_SUCCESS); /* nothing moves */
  PetscCall(Rates(gas, cloud->field[FIELD_VELOCITY_STAR], gas->star, &fastest));
  PetscCall(Rates(gas, cloud->field[FIELD_VELOCITY], gas->old, &fastest));
  gas->now.moved += dt * fastest / cloud->domain->spacing;
  for (PetscInt i = 0; i < n; i++) { /* tension acts; the kept share of the pressure leaves the velocity */
    for (PetscInt j = 0; j < n; j++) moved[i] -= kept * gas->matrix[i * n + j] * gas->now.pocket[j + 1].pressure;
    gas->star[i + 1] += dt * cloud->domain->volume * moved[i];
  }
  if (PressureYields(pressure)) PetscCall(AddYields(gas, pressure));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetUp(void *context, Pressure pressure)
{
  Gas            *gas = (Gas *)context;
  const PetscReal dt = PressureStep(pressure), s = gas->cloud->domain->volume,
                  correction = PetscMin(1, dt / (MEMORY * PressureRelaxationTime(pressure)));
  const PetscInt n           = gas->now.count;

  PetscFunctionBegin;
  gas->solved = PETSC_FALSE;
  if (!Acts(gas) || !n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Assemble(gas, pressure));
  for (PetscInt k = 0; k < n; k++) {
    Pocket         *pocket   = &gas->now.pocket[k + 1];
    const PetscBool constant = (PetscBool)(gas->exponent == 0 || PocketIsVoid(pocket));
    PetscReal       V;

    if (gas->same) pocket->volume += dt * gas->old[k + 1]; /* the sums of the cells would */
    if (PocketIsVoid(pocket)) pocket->tracked = pocket->volume;
    /* the flux gives the fast changes of the volume, the cells the slow ones */
    if (gas->before_known && !gas->frozen) pocket->tracked += dt * gas->old[k + 1];
    V = PetscMax(pocket->tracked + correction * (pocket->volume - pocket->tracked), LEAST * pocket->volume);
    if (gas->before_known && !gas->frozen && !constant) gas->unseen += pocket->pressure * (V - pocket->tracked);
    pocket->tracked = V;
    if ((gas->frozen || constant) && gas->matrix[k * n + k] == 0) { /* nothing that moves sees it */
      gas->matrix[k * n + k] = 1;
      gas->g[k]              = 0;
    } else if (gas->frozen) /* at rest */
      gas->g[k] = HOLD * (pocket->amount - pocket->volume) / (dt * dt * s);
    else if (constant) {
      if (!gas->open) gas->matrix[k * n + k] *= 1 + LEVEL;
      gas->g[k] = ((pocket->amount - V) / (MEMORY * PressureRelaxationTime(pressure)) - gas->star[k + 1]) / (dt * s);
    } else {
      const PetscReal P = gas->ambient * PetscPowReal(pocket->amount / V, gas->exponent), K = gas->exponent * P / V,
                      often = dt * PetscSqrtReal(K * s * gas->matrix[k * n + k]),
                      part = PetscMax(0, PetscMin(1, (often - RESOLVED) / UNRESOLVED)), now = CENTRED + DAMPED * part,
                      stiff = K * dt * dt * now * s;

      gas->g[k] = (P - gas->ambient - K * dt * (now * gas->star[k + 1] - CENTRED * gas->old[k + 1])) / stiff;
      gas->matrix[k * n + k] += 1 / stiff;
    }
  }
  PetscCall(MatDestroy(&gas->factor));
  PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, n, n, gas->matrix, &gas->factor));
  PetscCall(MatCholeskyFactor(gas->factor, NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* q = (D + C)^-1 (c^T p + g), p or g may be missing. */
static PetscErrorCode Pressures(const Gas *gas, const PetscScalar p[], const PetscReal g[], PetscReal q[])
{
  const PetscInt n = gas->now.count;
  PetscReal      y[GAS_MOST];

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(y, n));
  for (const GasRow *r = gas->row; r < gas->row + gas->rows && p; r++)
    y[r->pocket] += r->closure * PetscRealPart(p[r->row]);
  if (p) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, y, (PetscMPIInt)n, MPIU_REAL, MPIU_SUM, gas->cloud->comm));
  for (PetscInt k = 0; k < n && g; k++) y[k] += g[k];
  PetscCall(Solve(gas, y, q));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Add(void *context, Pressure pressure, const PetscScalar p[], PetscScalar y[])
{
  const Gas *gas = (const Gas *)context;
  PetscReal  q[GAS_MOST];

  PetscFunctionBegin;
  if (!Acts(gas)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(AddGaps(gas, pressure, 1, p, y));
  if (!gas->now.count) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Pressures(gas, p, NULL, q));
  for (const GasRow *r = gas->row; r < gas->row + gas->rows; r++) y[r->row] -= r->closure * q[r->pocket];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RightSide(void *context, Pressure pressure, PetscScalar rhs[])
{
  const Gas      *gas  = (const Gas *)context;
  const PetscReal kept = PressureKeptShare(pressure), *p = gas->cloud->field[FIELD_PRESSURE];
  PetscReal       q[GAS_MOST];

  PetscFunctionBegin;
  if (!Acts(gas)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(AddGaps(gas, pressure, kept, p, rhs));
  for (PetscInt g = 0, n; g < gas->gaps; g++)
    rhs[gas->gap[g]] +=
      (1 - kept) * HELD * PressureClosure(pressure)[gas->gap[g]] * MeanAround(gas->cloud, gas->gap[g], p, &n);
  if (!gas->now.count) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Pressures(gas, NULL, gas->g, q));
  for (const GasRow *r = gas->row; r < gas->row + gas->rows; r++)
    rhs[r->row] += r->closure * (q[r->pocket] - (r->share > 0 ? kept * gas->now.pocket[r->pocket + 1].pressure : 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The pressures after the solve. */
static PetscErrorCode Solved(void *context, Pressure pressure)
{
  Gas      *gas = (Gas *)context;
  PetscReal q[GAS_MOST];

  PetscFunctionBegin;
  if (!Acts(gas) || !gas->now.count) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Pressures(gas, gas->cloud->field[FIELD_PRESSURE], gas->g, q));
  for (PetscInt k = 0; k < gas->now.count; k++) {
    gas->kept[k + 1]                = gas->now.pocket[k + 1].pressure;
    gas->now.pocket[k + 1].pressure = q[k];
  }
  gas->solved = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Outside(void *context, Pressure pressure, PetscReal outside[], PetscReal slope[])
{
  const Gas *gas = (const Gas *)context;

  PetscFunctionBegin;
  if (!Acts(gas)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt g = 0, n; g < gas->gaps; g++)
    outside[gas->gap[g]] += MeanAround(gas->cloud, gas->gap[g], gas->cloud->field[FIELD_PRESSURE], &n);
  for (const GasRow *r = gas->row; r < gas->row + gas->rows; r++) {
    const PetscReal P = gas->now.pocket[r->pocket + 1].pressure;

    outside[r->row] += r->share * P;
    for (PetscInt d = 0; d < DIM; d++) slope[DIM * r->row + d] += r->slope[d] * P;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Press(void *context, Pressure pressure, PetscReal force[])
{
  Gas     *gas = (Gas *)context;
  Pockets *pockets;

  PetscFunctionBegin;
  PetscCall(FindLoads(gas, &pockets));
  for (const GasLoad *l = gas->loads.load; l < gas->loads.load + gas->loads.count; l++)
    for (PetscInt d = 0; d < DIM; d++) force[DIM * l->dummy + d] += pockets->pocket[l->pocket].pressure * l->unit[d];
  PetscFunctionReturn(PETSC_SUCCESS);
}

const LowRank GasTerm = {
  .set_up = SetUp, .add = Add, .right_side = RightSide, .solved = Solved, .outside = Outside, .load = Press};
