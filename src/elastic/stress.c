/* The divergence of the stress, and what viscosity does to the velocities of the fit. */
#include "../operators/liquid_row.h"
#include "elastic_impl.h"

void ElasticSolenoidal(Cloud cloud, const PetscReal n[], PetscReal L[])
{
  const PetscInt dim = DomainIsFlat(cloud->domain) ? 2 : DIM;

  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal      *l     = L + DIM * DIM * a;
    const PetscReal trace = l[0] + l[4] + l[8], *m = n + DIM * a;
    const PetscBool surface = (PetscBool)(Dot(m, m) > 0);

    for (PetscInt i = 0; i < DIM; i++)
      for (PetscInt j = 0; j < DIM; j++)
        l[DIM * i + j] -= trace * (surface ? m[i] * m[j] : i == j && i < dim ? 1. / (PetscReal)dim : 0);
  }
}

/* T minus its part along the surface: n (n.T) + (T.n) n - n n (n.T.n). */
static void Across(const PetscReal T[6], const PetscReal n[DIM], PetscReal out[6])
{
  PetscReal t[DIM], nn;

  TensorApply(T, n[0], n[1], n[2], t);
  nn = Dot(t, n);
  for (PetscInt i = 0; i < DIM; i++) out[i] = 2 * n[i] * t[i] - nn * n[i] * n[i];
  out[3] = n[0] * t[1] + n[1] * t[0] - nn * n[0] * n[1];
  out[4] = n[0] * t[2] + n[2] * t[0] - nn * n[0] * n[2];
  out[5] = n[1] * t[2] + n[2] * t[1] - nn * n[1] * n[2];
}

static void Add(const PetscReal T[6], PetscReal factor, const PetscReal d[DIM], PetscReal sum[DIM])
{
  PetscReal part[DIM];

  TensorApply(T, d[0], d[1], d[2], part);
  for (PetscInt i = 0; i < DIM; i++) sum[i] += factor * part[i];
}

PetscErrorCode ElasticMix(Cloud cloud, const PetscReal L[], PetscReal time)
{
  PetscReal *s = cloud->field[FIELD_STRETCH], *mixed;
  LiquidRow  row;

  PetscFunctionBegin;
  PetscCall(CloudUpdate(cloud, FIELD_STRETCH));
  PetscCall(CloudGetWork(cloud, 6, &mixed));
  PetscCall(PetscArraycpy(mixed, s, 6 * cloud->n_fluid));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const Polymers *own    = PolymersOf(cloud->scene, cloud->integer[INT_BODY][a]);
    const PetscReal share  = PetscMin(1, time * OperatorsShearRate((const PetscReal(*)[DIM])(L + DIM * DIM * a)));
    PetscReal       weight = 0, mean[DIM] = {0, 0, 0}, c[6], *out = mixed + 6 * a;

    if (own->modulus == 0 || share == 0) continue;
    LiquidRowLoad(cloud, a, &row);
    for (PetscInt k = 0; k < row.n; k++) {
      if (!PolymersAlike(own, PolymersOf(cloud->scene, cloud->integer[INT_BODY][row.index[k]]))) row.f[k] = 0;
      weight += row.f[k];
      for (PetscInt i = 0; i < DIM; i++) mean[i] += row.f[k] * row.d[k][i];
    }
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscReal *its = s + 6 * row.index[k];
      PetscReal        e[DIM];

      TensorApply(row.B, row.d[k][0], row.d[k][1], row.d[k][2], e);
      for (PetscInt m = 0; m < 6 && row.f[k] != 0; m++)
        out[m] += share * row.f[k] / weight * (1 + Dot(e, mean)) * (its[m] - s[6 * a + m]);
    }
    for (PetscInt m = 0; m < 6; m++) c[m] = out[m] + (m < DIM);
    if (SymmetricSmallestEigenvalue(DIM, c) <= 0) PetscCall(PetscArraycpy(out, s + 6 * a, 6));
  }
  PetscCall(PetscArraycpy(s, mixed, 6 * cloud->n_fluid));
  PetscCall(CloudRestoreWork(cloud, &mixed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Inside the liquid the corrected difference, exact for a linear stress. No stress acts on the free surface, T.n = 0.
   Near it the part of T with a component along n is mirrored oddly, as the pressure is in Eq. (9), and the rest, which
   need not vanish there, evenly to first order: the difference corrected on the liquid's side. The sum of Eq. (9)
   mirrors all of T oddly, which is the same on a lattice; on disordered particles 2 T sum V grad W then has the
   disorder of the sum times the tension along the surface, and threads tear. Here T is times a smooth normal, and T.n
   is small.

   conserved: sum V_b (T_a B_a + T_b B_b) grad W, the adjoint of the corrected gradient. It conserves momentum and gives
   velocities the power -sum V T:L, so a section of a thread pulls with all of its area; the sum without B lacks 10 to
   20 % of a thread of 4 spacings. Rings: its terms are those of the length of a ring. */
static void DivergenceRow(Cloud cloud, const PetscReal T[], PetscInt a, const PetscReal n[DIM], PetscReal out[DIM],
                          PetscReal conserved[DIM])
{
  const PetscBool  surface = (PetscBool)(cloud->integer[INT_SURFACE][a] != 0);
  const PetscReal *own = T + 6 * a, *N = cloud->field[FIELD_NORMAL] + DIM * a, out_of_axis[DIM] = {1, 0, 0},
                  x[DIM] = {PetscMax(cloud->field[FIELD_POSITION][DIM * a],
                                     0.5 * cloud->size[a] * cloud->domain->spacing)},
                  bend   = DomainLengthening(cloud->domain, x, out_of_axis);
  LiquidRow row;

  LiquidRowLoad(cloud, a, &row);
  for (PetscInt i = 0; i < DIM; i++) out[i] = conserved[i] = 0;
  for (PetscInt k = 0; k < row.n; k++) {
    const PetscReal *its = T + 6 * row.index[k], *d = row.d[k];
    const PetscReal *B = cloud->field[FIELD_CORRECTION] + 6 * a, *C = cloud->field[FIELD_CORRECTION] + 6 * row.index[k];
    PetscReal        D[6], P[6], e[DIM];

    for (PetscInt m = 0; m < 6; m++) D[m] = its[m] - own[m];
    TensorApply(B, d[0], d[1], d[2], e);
    Add(own, row.f[k], e, conserved);
    TensorApply(C, d[0], d[1], d[2], e);
    Add(its, row.f[k] * cloud->length[row.index[k]] / cloud->length[a], e, conserved);
    if (surface) {
      Across(D, n, P);
      for (PetscInt m = 0; m < 6; m++) D[m] -= P[m];
      Add(P, row.f[k], d, out);
    }
    TensorApply(row.B, d[0], d[1], d[2], e);
    Add(D, row.f[k], e, out);
  }
  if (surface) Add(own, 2 * Dot(N, n), n, out);
  /* of rings (T_rr - T_tt)/r and T_rz/r; on the axis their slopes */
  out[0] += (own[0] - own[2]) * bend;
  out[1] += own[3] * bend;
  conserved[0] -= own[2] * bend;
  if (cloud->domain->dim == 2) out[2] = conserved[2] = 0;
}

/* Adds the force (N) of fluid particle a on walls to the dummy particles around it, by their W'. */
static void AddToWalls(Cloud cloud, PetscInt a, const PetscReal force[DIM], PetscReal wall[])
{
  PetscReal sum = 0;
  PairRow   row;

  PairRowLoadFactors(cloud, a, &row);
  for (PetscInt k = 0; k < row.n; k++) sum += cloud->integer[INT_LAYER][row.index[k]] ? row.f[k] : 0;
  for (PetscInt k = 0; k < row.n && sum != 0; k++)
    for (PetscInt d = 0; d < DIM && cloud->integer[INT_LAYER][row.index[k]]; d++)
      wall[DIM * row.index[k] + d] += force[d] * row.f[k] / sum;
}

/* The neighbours share the opposite of what a row differs from the conserved sum by: what is left of that is smooth.
   Rows beside walls, which have no stress in these sums, give the wall their momentum. */
PetscErrorCode ElasticDivergence(Cloud cloud, const PetscReal normal[], const PetscReal T[], PetscReal force[],
                                 PetscReal wall[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];
  PetscReal       *weight, *change, conserved[DIM];

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, DIM, &change));
  PetscCall(CloudGetWork(cloud, 1, &weight));
  PetscCall(CloudUpdate(cloud, FIELD_CORRECTION));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal      *f     = force + DIM * a;
    const PetscBool share = (PetscBool)(!OperatorsNearWall(cloud, x + DIM * a));

    DivergenceRow(cloud, T, a, normal + DIM * a, f, conserved);
    for (PetscInt d = 0; d < DIM; d++) {
      change[DIM * a + d] = share ? (f[d] - conserved[d]) / cloud->rest_density[a] : 0;
      f[d] -= cloud->rest_density[a] * change[DIM * a + d];
      conserved[d] = cloud->volume[a] * (conserved[d] - f[d]);
    }
    if (!share) AddToWalls(cloud, a, conserved, wall);
  }
  PetscCall(OperatorsCompensationWeights(cloud, weight));
  PetscCall(OperatorsCompensate(cloud, weight, x, NULL, cloud->field[FIELD_VELOCITY], change));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    for (PetscInt d = 0; d < DIM; d++) force[DIM * a + d] += cloud->rest_density[a] * change[DIM * a + d];
  }
  PetscCall(CloudRestoreWork(cloud, &weight));
  PetscCall(CloudRestoreWork(cloud, &change));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* D ([n_total][6]): the symmetric part of L, which is all that forces along the line of centres see. */
static PetscErrorCode FindStrains(Cloud cloud, const PetscReal L[], PetscReal D[])
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *l = L + DIM * DIM * a;
    PetscReal       *d = D + 6 * a;

    d[0] = l[0];
    d[1] = l[4];
    d[2] = l[8];
    d[3] = 0.5 * (l[1] + l[3]);
    d[4] = 0.5 * (l[2] + l[6]);
    d[5] = 0.5 * (l[5] + l[7]);
  }
  PetscCall(CloudUpdateArray(cloud, 6, PARITY_TENSOR, D));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ElasticSeen(Cloud cloud, const Viscosity *viscosity, const PetscReal pair[], const PetscReal share[],
                           const PetscReal L[], PetscReal out[], PetscReal wall[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];
  PetscReal       *D, *depth;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, 6, &D));
  PetscCall(CloudGetWork(cloud, 1, &depth));
  PetscCall(FindStrains(cloud, L, D));
  OperatorsDepths(cloud, depth);
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal sum[DIM] = {-pair[cloud->first[cloud->n_fluid] + a] * share[a] * cloud->field[FIELD_VELOCITY][DIM * a]};

    for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
      const PetscInt  b        = cloud->list[k];
      const PetscBool boundary = (PetscBool)(cloud->integer[INT_LAYER][b] > 0);
      const PetscReal d[DIM]   = {x[DIM * a] - x[DIM * b], x[DIM * a + 1] - x[DIM * b + 1],
                                  x[DIM * a + 2] - x[DIM * b + 2]},
                      part     = boundary ? share[a] : 0.5 * (share[a] + share[b]);
      PetscReal mean[6], u[DIM], along;

      if (part == 0) continue;
      for (PetscInt m = 0; m < 6; m++) mean[m] = boundary ? D[6 * a + m] : 0.5 * (D[6 * a + m] + D[6 * b + m]);
      TensorApply(mean, d[0], d[1], d[2], u);
      along = Dot(u, d) * pair[k] * part;
      if (boundary && viscosity->no_slip) along *= OperatorsWallFraction(cloud, a, b, depth);
      for (PetscInt i = 0; i < DIM; i++) sum[i] -= along * d[i];
      for (PetscInt i = 0; i < DIM && boundary; i++)
        wall[DIM * b + i] += cloud->volume[a] * cloud->rest_density[a] * along * d[i];
    }
    for (PetscInt i = 0; i < DIM; i++) out[DIM * a + i] = sum[i];
  }
  PetscCall(CloudRestoreWork(cloud, &depth));
  PetscCall(CloudRestoreWork(cloud, &D));
  PetscFunctionReturn(PETSC_SUCCESS);
}
