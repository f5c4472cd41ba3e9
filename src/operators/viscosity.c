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

PetscErrorCode OperatorsDivergence(Cloud cloud, const PetscReal velocity[], PetscBool corrected, PetscReal div[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *volume = cloud->volume;
  const PetscInt  *layer = cloud->integer[INT_LAYER];
  PairRow          row;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    const PetscReal *B = cloud->field[FIELD_MOMENT] + 6 * a, *v = velocity, vx = v[3 * a], vy = v[3 * a + 1],
                    vz = v[3 * a + 2];
    PetscReal xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yx = 0, yz = 0, zx = 0, zy = 0;

    PairRowLoad(cloud, x, a, &row);
    KernelGradient(cloud->kernel, row.n, row.r2, row.F);
    if (layer[a] == 0 && corrected) {
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
      div[a] = B[0] * xx + B[1] * yy + B[2] * zz + B[3] * (xy + yx) + B[4] * (xz + zx) + B[5] * (yz + zy);
    } else {
      for (PetscInt k = 0; k < row.n; k++) {
        const PetscInt  b = row.index[k];
        const PetscReal f = layer[a] && layer[b] ? 0 : volume[b] * row.F[k];

        xx += f * ((v[3 * b] - vx) * row.dx[k] + (v[3 * b + 1] - vy) * row.dy[k] + (v[3 * b + 2] - vz) * row.dz[k]);
      }
      div[a] = xx;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
