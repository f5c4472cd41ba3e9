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
static PetscErrorCode MirrorVelocity(Cloud cloud, PetscReal u[])
{
  const PetscReal *v = cloud->field[FIELD_VELOCITY];
  PairRow          row;

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

PetscErrorCode OperatorsViscosity(Cloud cloud, ViscosityForm form, const PetscReal density[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *volume = cloud->volume, *rest = cloud->rest_density,
                  *v   = cloud->field[FIELD_VELOCITY];
  const PetscReal eta2 = EtaSquared(cloud->kernel),
                  zeta = form == VISCOSITY_CLEARY ? (PetscReal)(cloud->domain->dim + 2) : 1;
  PetscReal *mu = cloud->field[FIELD_WORK1], *acceleration = cloud->field[FIELD_ACCELERATION];
  PairRow    row;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_VISCOSITY), 0, 0, 0, 0));
  PetscCall(CollectViscosity(cloud, mu));
  if (form == VISCOSITY_MORRIS) {
    PetscCall(MirrorVelocity(cloud, cloud->field[FIELD_WORK3]));
    v = cloud->field[FIELD_WORK3];
  }
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal mu_a = mu[a], inverse_a = 1 / (density[a] * density[a]), vx = v[3 * a], vy = v[3 * a + 1],
                    vz = v[3 * a + 2];
    PetscReal ax = 0, ay = 0, az = 0;

    if (mu_a <= 0) continue;
    PairRowLoad(cloud, x, a, &row);
    KernelGradient(cloud->kernel, row.n, row.r2, row.F);
    SIMD_LOOP()
    for (PetscInt k = 0; k < row.n;
         k++) { /* W: the pair's coefficient; for liquids of different density the mass that counts is V_b rho_b */
      const PetscInt  b    = row.index[k];
      const PetscReal mu_b = mu[b] < 0 ? mu_a : mu[b];

      row.W[k] = volume[b] * rest[b] * zeta * (inverse_a + 1 / (density[b] * density[b])) * 2 * mu_a * mu_b /
                 (mu_a + mu_b) * row.F[k];
    }
    if (form == VISCOSITY_CLEARY) { /* Eq. (1) of Kuri et al. */
      SIMD_LOOP(reduction(+ : ax, ay, az))
      for (PetscInt k = 0; k < row.n; k++) {
        const PetscInt  b = row.index[k];
        const PetscReal c =
          row.W[k] * ((vx - v[3 * b]) * row.dx[k] + (vy - v[3 * b + 1]) * row.dy[k] + (vz - v[3 * b + 2]) * row.dz[k]) /
          (row.r2[k] + eta2);

        ax += c * row.dx[k];
        ay += c * row.dy[k];
        az += c * row.dz[k];
      }
    } else { /* Morris et al. 1997; grad W.r is finite at r = 0, so eta is not needed */
      SIMD_LOOP(reduction(+ : ax, ay, az))
      for (PetscInt k = 0; k < row.n; k++) {
        const PetscInt b = row.index[k];

        ax += row.W[k] * (vx - v[3 * b]);
        ay += row.W[k] * (vy - v[3 * b + 1]);
        az += row.W[k] * (vz - v[3 * b + 2]);
      }
    }
    acceleration[3 * a] += ax;
    acceleration[3 * a + 1] += ay;
    acceleration[3 * a + 2] += az;
  }
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_VISCOSITY), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The part of a velocity u (m/s) that is normal to the wall of dummy particle b: in the directions of the faces it is
   behind, or along the normal of its solid. */
static inline void WallPart(Cloud cloud, PetscInt b, const PetscReal u[DIM], PetscReal part[DIM])
{
  const Domain     domain = cloud->domain;
  const PetscReal *x      = cloud->field[FIELD_POSITION] + DIM * b;

  if (cloud->solid_normal && cloud->integer[INT_BODY][b] <= BODY_SOLID) {
    const PetscReal *n = cloud->solid_normal + DIM * b, along = Dot(u, n);

    for (PetscInt d = 0; d < DIM; d++) part[d] = along * n[d];
    return;
  }
  for (PetscInt d = 0; d < DIM; d++)
    part[d] = (domain->face[d][0] == FACE_WALL && x[d] < domain->lower[d]) ||
                  (domain->face[d][1] == FACE_WALL && x[d] > domain->upper[d])
                ? u[d]
                : 0;
}

/* Whether dummy particles may be within the kernel's support of x (m). */
static inline PetscBool NearWall(Cloud cloud, const PetscReal x[DIM])
{
  const Domain    domain = cloud->domain;
  const PetscReal reach  = KernelSupport(cloud->kernel);

  if (cloud->solid_normal && SceneSolidDistance(cloud->scene, x, NULL) < reach) return PETSC_TRUE;
  for (PetscInt d = 0; d < domain->dim; d++)
    if ((domain->face[d][0] == FACE_WALL && x[d] < domain->lower[d] + reach) ||
        (domain->face[d][1] == FACE_WALL && x[d] > domain->upper[d] - reach))
      return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Takes from the velocity gradient G (rows: components of the velocity) of fluid particle a what walls gave it by
   sliding. */
static void RemoveSliding(Cloud cloud, PetscInt a, const PairRow *row, const PetscReal velocity[],
                          PetscReal G[DIM][DIM])
{
  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt  b    = row->index[k];
    const PetscReal f    = cloud->volume[b] * row->F[k];
    const PetscReal r[3] = {row->dx[k], row->dy[k], row->dz[k]};
    PetscReal       u[DIM], part[DIM];

    if (!cloud->integer[INT_LAYER][b]) continue;
    for (PetscInt i = 0; i < DIM; i++) u[i] = velocity[DIM * b + i] - velocity[DIM * a + i];
    WallPart(cloud, b, u, part);
    for (PetscInt i = 0; i < DIM; i++)
      for (PetscInt j = 0; j < DIM; j++) G[i][j] -= (u[i] - part[i]) * f * r[j];
  }
}

/* sum V (v_b - v_a).grad W of a wall particle: the fluid only, its velocity normal to the wall only. */
static PetscReal WallDivergence(Cloud cloud, PetscInt a, const PairRow *row, const PetscReal velocity[])
{
  const PetscReal *v   = velocity;
  PetscReal        sum = 0;

  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt  b      = row->index[k];
    const PetscReal f      = cloud->integer[INT_LAYER][b] ? 0 : cloud->volume[b] * row->F[k];
    const PetscReal u[DIM] = {v[3 * b] - v[3 * a], v[3 * b + 1] - v[3 * a + 1], v[3 * b + 2] - v[3 * a + 2]};
    PetscReal       part[DIM];

    if (f == 0) continue;
    WallPart(cloud, a, u, part);
    sum += f * (part[0] * row->dx[k] + part[1] * row->dy[k] + part[2] * row->dz[k]);
  }
  return sum;
}

PetscErrorCode OperatorsDivergence(Cloud cloud, const PetscReal velocity[], PetscBool corrected, PetscReal div[])
{
  const PetscReal  identity[6] = {1, 1, 1, 0, 0, 0};
  const PetscReal *x = cloud->field[FIELD_POSITION], *volume = cloud->volume, *v = velocity;
  PairRow          row;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    const PetscReal *B  = corrected ? cloud->field[FIELD_MOMENT] + 6 * a : identity;
    const PetscReal  vx = v[3 * a], vy = v[3 * a + 1], vz = v[3 * a + 2];
    PetscReal        xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yx = 0, yz = 0, zx = 0, zy = 0;

    PairRowLoad(cloud, x, a, &row);
    KernelGradient(cloud->kernel, row.n, row.r2, row.F);
    if (cloud->integer[INT_LAYER][a]) {
      div[a] = WallDivergence(cloud, a, &row, velocity);
      continue;
    }
    /* the velocity gradient once, then B: div v = sum_ij G_ij B_ij, G_ij = sum V (v_b - v_a)_i grad_j W */
    SIMD_LOOP(reduction(+ : xx, yy, zz, xy, xz, yx, yz, zx, zy))
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt  b = row.index[k];
      const PetscReal f = volume[b] * row.F[k], ux = (v[3 * b] - vx) * f, uy = (v[3 * b + 1] - vy) * f,
                      uz = (v[3 * b + 2] - vz) * f;

      xx += ux * row.dx[k];
      xy += ux * row.dy[k];
      xz += ux * row.dz[k];
      yx += uy * row.dx[k];
      yy += uy * row.dy[k];
      yz += uy * row.dz[k];
      zx += uz * row.dx[k];
      zy += uz * row.dy[k];
      zz += uz * row.dz[k];
    }
    if (NearWall(cloud, x + DIM * a)) {
      PetscReal G[DIM][DIM] = {{xx, xy, xz}, {yx, yy, yz}, {zx, zy, zz}};

      RemoveSliding(cloud, a, &row, velocity, G);
      div[a] = B[0] * G[0][0] + B[1] * G[1][1] + B[2] * G[2][2] + B[3] * (G[0][1] + G[1][0]) +
               B[4] * (G[0][2] + G[2][0]) + B[5] * (G[1][2] + G[2][1]);
    } else
      div[a] = B[0] * xx + B[1] * yy + B[2] * zz + B[3] * (xy + yx) + B[4] * (xz + zx) + B[5] * (yz + zy);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
