#include "operators.h"

/* Viscosity of each particle, Pa s; -1 marks walls, which take their neighbour's. */
static PetscErrorCode CollectViscosity(Cloud cloud, PetscReal mu[])
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    const PetscInt body = cloud->integer[INT_BODY][a];

    mu[a] = body < 0 ? -1 : BodyMaterial(SceneBody(cloud->scene, body))->viscosity;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Velocity u of wall particles for a no-slip wall between them and the fluid: 2 v_wall - the fluid's mean there (Adami
 * et al. 2012); of the fluid its own. */
static PetscErrorCode MirrorVelocity(Cloud cloud, const PetscReal v[], PetscReal u[])
{
  PairRow row;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(u, v, DIM * cloud->n_total));
  for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++) {
    PetscReal sum = 0, mean[DIM] = {0, 0, 0};

    PairRowLoad(cloud, cloud->field[FIELD_POSITION], a, &row);
    KernelEvaluate(cloud->kernel, row.n, row.r2, row.W, NULL);
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt b = row.index[k];

      if (cloud->integer[INT_LAYER][b]) continue;
      sum += row.W[k];
      for (PetscInt d = 0; d < DIM; d++) mean[d] += row.W[k] * v[DIM * b + d];
    }
    if (sum > 0)
      for (PetscInt d = 0; d < DIM; d++) u[DIM * a + d] = 2 * v[DIM * a + d] - mean[d] / sum;
  }
  PetscCall(CloudUpdate(cloud, FIELD_WORK3));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool OperatorsOneLiquid(Cloud cloud)
{
  const Material *first = BodyMaterial(SceneBody(cloud->scene, 0));

  for (PetscInt b = 1; b < SceneCount(cloud->scene); b++) {
    const Material *m = BodyMaterial(SceneBody(cloud->scene, b));

    if (m->density != first->density || m->viscosity != first->viscosity) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* Multiplies the row's factors by V_b rho_0b (1/rho_a^2 + 1/rho_b^2) 2 mu_a mu_b/(mu_a + mu_b); for liquids of
   different density the mass that counts is V_b rho_0b. */
static void PairViscosity(Cloud cloud, PetscBool one, PetscInt a, const PetscReal density[], const PetscReal mu[],
                          Row *row)
{
  const PetscReal *rest = cloud->rest_density, V = cloud->domain->volume, mu_a = mu[a],
                  inverse_a = 1 / (density[a] * density[a]), same = V * 2 * mu_a / density[a];

  if (one) {
    SIMD_LOOP()
    for (PetscInt k = 0; k < row->n; k++) row->f[k] *= same;
    return;
  }
  SIMD_LOOP()
  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt  b    = row->index[k];
    const PetscReal mu_b = mu[b] < 0 ? mu_a : mu[b];

    row->f[k] *= V * rest[b] * (inverse_a + 1 / (density[b] * density[b])) * 2 * mu_a * mu_b / (mu_a + mu_b);
  }
}

/* Eq. (1) of Kuri et al. from factors divided by r2 + eta2. */
static void ViscosityCleary(Cloud cloud, PetscInt a, const Row *row, const PetscReal v[], PetscReal out[DIM])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];
  const Triple     p = TripleLoad(x + DIM * a), own = TripleLoad(v + DIM * a);
  Triple           sum = TripleSet(0);

  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt b = DIM * row->index[k];
    const Triple   d = p - TripleLoad(x + b);

    sum += TripleSet(row->f[k]) * TripleDot(own - TripleLoad(v + b), d) * d;
  }
  TripleStore(sum, out);
}

/* Morris et al. 1997; grad W.r is finite at r = 0, so eta is not needed. */
static void ViscosityMorris(PetscInt a, const Row *row, const PetscReal v[], PetscReal out[DIM])
{
  const Triple own = TripleLoad(v + DIM * a);
  Triple       sum = TripleSet(0);

  for (PetscInt k = 0; k < row->n; k++) sum += TripleSet(row->f[k]) * (own - TripleLoad(v + DIM * row->index[k]));
  TripleStore(sum, out);
}

/* Divides the row's factors F by r2 + eta2 (m2). */
static void DivideByDistance(Cloud cloud, PetscInt a, PetscReal eta2, Row *row)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], x0 = x[DIM * a], x1 = x[DIM * a + 1], x2 = x[DIM * a + 2];

  SIMD_LOOP()
  for (PetscInt k = 0; k < row->n; k++) {
    const PetscReal *at = x + DIM * row->index[k];

    row->f[k] /= PetscSqr(x0 - at[0]) + PetscSqr(x1 - at[1]) + PetscSqr(x2 - at[2]) + eta2;
  }
}

PetscErrorCode OperatorsViscosity(Cloud cloud, ViscosityForm form, const PetscReal density[])
{
  const PetscReal *v    = cloud->field[FIELD_VELOCITY];
  const PetscReal  eta2 = EtaSquared(cloud->kernel),
                  zeta  = form == VISCOSITY_CLEARY ? (PetscReal)(cloud->domain->dim + 2) : 1;
  const PetscBool one   = (PetscBool)(density == cloud->rest_density && OperatorsOneLiquid(cloud));
  PetscReal      *mu = cloud->field[FIELD_WORK1], *acceleration = cloud->field[FIELD_ACCELERATION], scale_w, scale_f,
            inverse_h2;
  Row row;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_VISCOSITY), 0, 0, 0, 0));
  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  PetscCall(CollectViscosity(cloud, mu));
  if (form == VISCOSITY_MORRIS) {
    PetscCall(MirrorVelocity(cloud, v, cloud->field[FIELD_WORK3]));
    v = cloud->field[FIELD_WORK3];
  }
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal sum[DIM];

    if (mu[a] <= 0) continue;
    RowLoad(cloud, a, &row);
    if (form == VISCOSITY_CLEARY) DivideByDistance(cloud, a, eta2, &row);
    PairViscosity(cloud, one, a, density, mu, &row);
    if (form == VISCOSITY_CLEARY)
      ViscosityCleary(cloud, a, &row, v, sum);
    else
      ViscosityMorris(a, &row, v, sum);
    for (PetscInt d = 0; d < DIM; d++) acceleration[DIM * a + d] += zeta * scale_f * sum[d];
  }
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_VISCOSITY), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OperatorsViscosityPairs(Cloud cloud, ViscosityForm form, const PetscReal density[], PetscReal pair[])
{
  const PetscReal *volume = cloud->volume, *rest = cloud->rest_density;
  const PetscReal  eta2 = EtaSquared(cloud->kernel),
                  zeta  = form == VISCOSITY_CLEARY ? (PetscReal)(cloud->domain->dim + 2) : 1;
  PetscReal *mu         = cloud->field[FIELD_WORK1];
  PairRow    row;

  PetscFunctionBegin;
  PetscCall(CollectViscosity(cloud, mu));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal *c = pair + cloud->first[a];

    PairRowLoad(cloud, cloud->field[FIELD_POSITION], a, &row);
    KernelGradient(cloud->kernel, row.n, row.r2, row.F);
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt  b    = row.index[k];
      const PetscReal mu_b = mu[b] < 0 ? mu[a] : mu[b], sum = mu[a] + mu_b;

      c[k] = sum > 0 ? volume[b] * rest[b] * zeta * (1 / PetscSqr(density[a]) + 1 / PetscSqr(density[b])) * 2 * mu[a] *
                         mu_b / sum * row.F[k]
                     : 0;
      if (form == VISCOSITY_CLEARY) c[k] /= row.r2[k] + eta2;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OperatorsViscosityApply(Cloud cloud, ViscosityForm form, const PetscReal pair[], FieldId velocity,
                                       PetscReal out[])
{
  const PetscReal *v = cloud->field[velocity];
  PairRow          row;

  PetscFunctionBegin;
  PetscCall(CloudUpdate(cloud, velocity));
  if (form == VISCOSITY_MORRIS) {
    PetscCall(MirrorVelocity(cloud, v, cloud->field[FIELD_WORK3]));
    v = cloud->field[FIELD_WORK3];
  }
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *restrict c = pair + cloud->first[a];
    const PetscReal vx = v[3 * a], vy = v[3 * a + 1], vz = v[3 * a + 2];
    PetscReal       ax = 0, ay = 0, az = 0;

    PairRowLoad(cloud, cloud->field[FIELD_POSITION], a, &row);
    if (form == VISCOSITY_CLEARY) {
      SIMD_LOOP(reduction(+ : ax, ay, az))
      for (PetscInt k = 0; k < row.n; k++) {
        const PetscInt  b = row.index[k];
        const PetscReal f =
          c[k] * ((vx - v[3 * b]) * row.dx[k] + (vy - v[3 * b + 1]) * row.dy[k] + (vz - v[3 * b + 2]) * row.dz[k]);

        ax += f * row.dx[k];
        ay += f * row.dy[k];
        az += f * row.dz[k];
      }
    } else {
      SIMD_LOOP(reduction(+ : ax, ay, az))
      for (PetscInt k = 0; k < row.n; k++) {
        const PetscInt b = row.index[k];

        ax += c[k] * (vx - v[3 * b]);
        ay += c[k] * (vy - v[3 * b + 1]);
        az += c[k] * (vz - v[3 * b + 2]);
      }
    }
    out[3 * a]     = ax;
    out[3 * a + 1] = ay;
    out[3 * a + 2] = az;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OperatorsViscosityDiagonal(Cloud cloud, ViscosityForm form, const PetscReal pair[], PetscReal diagonal[])
{
  PairRow row;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *c = pair + cloud->first[a];
    PetscReal       *d = diagonal + DIM * a;

    d[0] = d[1] = d[2] = 0;
    PairRowLoad(cloud, cloud->field[FIELD_POSITION], a, &row);
    for (PetscInt k = 0; k < row.n; k++) {
      d[0] += c[k] * (form == VISCOSITY_CLEARY ? PetscSqr(row.dx[k]) : 1);
      d[1] += c[k] * (form == VISCOSITY_CLEARY ? PetscSqr(row.dy[k]) : 1);
      d[2] += c[k] * (form == VISCOSITY_CLEARY ? PetscSqr(row.dz[k]) : 1);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
