/* Compensation: neighbours receive the opposite of a particle's change of velocity, which conserves momentum and
   angular momentum. */
#include "../neighbors/pairs.h"
#include "operators.h"

PetscErrorCode OperatorsCompensationWeights(Cloud cloud, PetscReal weight[])
{
  const PetscReal *volume = cloud->volume, *rest = cloud->rest_density;
  const PetscInt  *layer = cloud->integer[INT_LAYER];
  PairRow          row;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    PetscReal sum = 0;

    weight[a] = 0;
    if (a >= cloud->n_fluid || cloud->field[FIELD_LAMBDA][a] <= SPRAY_LAMBDA) continue;
    PairRowLoadGeometry(cloud, cloud->field[FIELD_POSITION], a, &row);
    KernelEvaluate(cloud->kernel, row.n, row.r2, row.W, NULL);
    SIMD_LOOP(reduction(+ : sum))
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt b = row.index[k];

      sum += layer[b] ? 0 : row.W[k] * volume[b] * rest[b];
    }
    if (sum > 0) weight[a] = volume[a] * rest[a] / sum;
  }
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, weight));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Solves J beta = torque. J: xx yy zz xy xz yz of the tensor sum w (|xi|^2 - xi xi). */
static void SolveSpin(PetscInt dim, const PetscReal J[6], const PetscReal torque[DIM], PetscReal beta[DIM])
{
  beta[0] = beta[1] = beta[2] = 0;
  if (dim == 2)
    beta[2] = J[2] > 0 ? torque[2] / J[2] : 0;
  else {
    const PetscReal xx = J[1] * J[2] - J[5] * J[5], xy = J[4] * J[5] - J[3] * J[2], xz = J[3] * J[5] - J[1] * J[4];
    const PetscReal yy = J[0] * J[2] - J[4] * J[4], yz = J[3] * J[4] - J[0] * J[5], zz = J[0] * J[1] - J[3] * J[3];
    const PetscReal determinant = J[0] * xx + J[3] * xy + J[4] * xz;

    if (determinant <= 0) return;
    beta[0] = (xx * torque[0] + xy * torque[1] + xz * torque[2]) / determinant;
    beta[1] = (xy * torque[0] + yy * torque[1] + yz * torque[2]) / determinant;
    beta[2] = (xz * torque[0] + yz * torque[1] + zz * torque[2]) / determinant;
  }
}

/* Neighbour b of a particle a with the change c receives -s_a W_ab (c + beta x (x_b - mean x)): s_a is the weight of a,
   and means are weighted with m_b W_ab. beta cancels the torque of c and of the displacement dr (or NULL).
   recoil = c + beta x (x_a - mean x), spin = beta ([n_fluid][3] each). x: the final positions, ghosts current. */
static void FindRecoils(Cloud cloud, const PetscReal weight[], const PetscReal x[], const PetscReal dr[],
                        const PetscReal u[], const PetscReal change[], PetscReal recoil[], PetscReal spin[])
{
  const PetscReal *volume = cloud->volume, *rest = cloud->rest_density, still[DIM] = {0, 0, 0};
  const PetscInt  *layer = cloud->integer[INT_LAYER];
  PairRow          row;

  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal  per_mass = weight[a] / (volume[a] * rest[a]);
    const PetscReal *c = change + DIM * a, *d = dr ? dr + DIM * a : still, xa = x[3 * a], ya = x[3 * a + 1],
                    za = x[3 * a + 2];
    PetscReal *g = recoil + DIM * a, *beta = spin + DIM * a;
    PetscReal  xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0, mx = 0, my = 0, mz = 0, vx = 0, vy = 0, vz = 0;

    for (PetscInt k = 0; k < DIM; k++) g[k] = beta[k] = 0;
    if (weight[a] <= 0) continue;
    PairRowLoadGeometry(cloud, cloud->field[FIELD_POSITION], a, &row);
    KernelEvaluate(cloud->kernel, row.n, row.r2, row.W, NULL);
    SIMD_LOOP(reduction(+ : xx, yy, zz, xy, xz, yz, mx, my, mz, vx, vy, vz))
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt  b = row.index[k];
      const PetscReal w = row.W[k] * volume[b] * rest[b] * per_mass, dx = x[3 * b] - xa, dy = x[3 * b + 1] - ya,
                      dz = x[3 * b + 2] - za;

      if (layer[b]) continue; /* x and u hold no walls */
      mx += w * dx;
      my += w * dy;
      mz += w * dz;
      xx += w * dx * dx;
      yy += w * dy * dy;
      zz += w * dz * dz;
      xy += w * dx * dy;
      xz += w * dx * dz;
      yz += w * dy * dz;
      vx += w * (u[3 * a] - u[3 * b]);
      vy += w * (u[3 * a + 1] - u[3 * b + 1]);
      vz += w * (u[3 * a + 2] - u[3 * b + 2]);
    }
    xx -= mx * mx;
    yy -= my * my;
    zz -= mz * mz;
    {
      const PetscReal J[6]      = {yy + zz, xx + zz, xx + yy, mx * my - xy, mx * mz - xz, my * mz - yz};
      const PetscReal torque[3] = {d[1] * vz - d[2] * vy - my * c[2] + mz * c[1],
                                   d[2] * vx - d[0] * vz - mz * c[0] + mx * c[2],
                                   d[0] * vy - d[1] * vx - mx * c[1] + my * c[0]};

      SolveSpin(cloud->domain->dim, J, torque, beta);
      g[0] = c[0] - (beta[1] * mz - beta[2] * my);
      g[1] = c[1] - (beta[2] * mx - beta[0] * mz);
      g[2] = c[2] - (beta[0] * my - beta[1] * mx);
    }
  }
}

PetscErrorCode OperatorsCompensate(Cloud cloud, const PetscReal weight[], const PetscReal x[], const PetscReal dr[],
                                   const PetscReal u[], PetscReal change[])
{
  PetscReal *recoil, *spin;
  PairRow    row;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, DIM, &recoil));
  PetscCall(CloudGetWork(cloud, DIM, &spin));
  FindRecoils(cloud, weight, x, dr, u, change, recoil, spin);
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, recoil));
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_AXIAL, spin));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal xa = x[3 * a], ya = x[3 * a + 1], za = x[3 * a + 2];
    PetscReal       vx = 0, vy = 0, vz = 0;

    PairRowLoadGeometry(cloud, cloud->field[FIELD_POSITION], a, &row);
    KernelEvaluate(cloud->kernel, row.n, row.r2, row.W, NULL);
    SIMD_LOOP(reduction(+ : vx, vy, vz))
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt  b = row.index[k];
      const PetscReal w = row.W[k] * weight[b], *beta = spin + DIM * b, dx = xa - x[3 * b], dy = ya - x[3 * b + 1],
                      dz = za - x[3 * b + 2];

      if (weight[b] == 0) continue; /* then recoil[b] is not set */
      vx += w * (recoil[3 * b] + beta[1] * dz - beta[2] * dy);
      vy += w * (recoil[3 * b + 1] + beta[2] * dx - beta[0] * dz);
      vz += w * (recoil[3 * b + 2] + beta[0] * dy - beta[1] * dx);
    }
    change[3 * a] -= vx;
    change[3 * a + 1] -= vy;
    change[3 * a + 2] -= vz;
  }
  PetscCall(CloudRestoreWork(cloud, &spin));
  PetscCall(CloudRestoreWork(cloud, &recoil));
  PetscFunctionReturn(PETSC_SUCCESS);
}
