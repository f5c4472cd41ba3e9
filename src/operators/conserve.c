/* Changes of velocity that neighbours pay for, so that momentum and angular momentum stay. */
#include "../neighbors/pairs.h"
#include "operators.h"

/* What the passes hand to the neighbours. TURN stands where a symmetric tensor has yz, xz, xy: an axial vector changes
   sign under a mirror as those do. */
#define SHARE           FIELD_WORK1
#define TURN(stress, a) ((stress) + 6 * (a) + 3) /* beta_z, beta_y, beta_x */

PetscErrorCode OperatorsCompensationWeights(Cloud cloud)
{
  const PetscReal *volume = cloud->volume, *rest = cloud->rest_density;
  const PetscInt  *layer = cloud->integer[INT_LAYER];
  PetscReal       *share = cloud->field[SHARE];
  PairRow          row;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    PetscReal sum = 0;

    share[a] = 0;
    if (a >= cloud->n_fluid || cloud->field[FIELD_LAMBDA][a] <= SPRAY_LAMBDA) continue;
    PairRowLoad(cloud, cloud->field[FIELD_POSITION], a, &row);
    KernelEvaluate(cloud->kernel, row.n, row.r2, row.W, NULL);
    SIMD_LOOP(reduction(+ : sum))
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt b = row.index[k];

      sum += layer[b] ? 0 : row.W[k] * volume[b] * rest[b];
    }
    if (sum > 0) share[a] = volume[a] * rest[a] / sum;
  }
  PetscCall(CloudUpdate(cloud, SHARE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* beta with (sum w (|xi|^2 - xi xi)) beta = torque; J: xx yy zz xy xz yz of that tensor. */
static void Spin(PetscInt dim, const PetscReal J[6], const PetscReal torque[DIM], PetscReal beta[DIM])
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

/* a's neighbours pay for a's change c of velocity, and for the torque of that and of the displacements, with the
   changes -s_a W_ab (c + beta x (x_b - mean x)), means weighted with m_b W_ab; g = c + beta x (x_a - mean x). x: the
   final positions, ghosts current. */
static PetscErrorCode Charge(Cloud cloud, const PetscReal x[], const PetscReal u[], const PetscReal change[])
{
  const PetscReal *share = cloud->field[SHARE], *volume = cloud->volume, *rest = cloud->rest_density;
  const PetscInt  *layer = cloud->integer[INT_LAYER];
  PairRow          row;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal  per_mass = share[a] / (volume[a] * rest[a]);
    const PetscReal *c = change + DIM * a, xa = x[3 * a], ya = x[3 * a + 1], za = x[3 * a + 2];
    PetscReal       *dr = cloud->field[FIELD_WORK3] + DIM * a, *turn = TURN(cloud->field[FIELD_STRESS], a);
    PetscReal        xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0, mx = 0, my = 0, mz = 0, vx = 0, vy = 0, vz = 0;

    turn[0] = turn[1] = turn[2] = 0;
    if (share[a] <= 0) continue;
    PairRowLoad(cloud, cloud->field[FIELD_POSITION], a, &row);
    KernelEvaluate(cloud->kernel, row.n, row.r2, row.W, NULL);
    SIMD_LOOP(reduction(+ : xx, yy, zz, xy, xz, yz, mx, my, mz, vx, vy, vz))
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt  b = row.index[k];
      const PetscReal w = layer[b] ? 0 : row.W[k] * volume[b] * rest[b] * per_mass, dx = x[3 * b] - xa,
                      dy = x[3 * b + 1] - ya, dz = x[3 * b + 2] - za;

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
      const PetscReal torque[3] = {dr[1] * vz - dr[2] * vy - my * c[2] + mz * c[1],
                                   dr[2] * vx - dr[0] * vz - mz * c[0] + mx * c[2],
                                   dr[0] * vy - dr[1] * vx - mx * c[1] + my * c[0]};
      PetscReal       beta[DIM];

      Spin(cloud->domain->dim, J, torque, beta);
      dr[0]   = c[0] - (beta[1] * mz - beta[2] * my);
      dr[1]   = c[1] - (beta[2] * mx - beta[0] * mz);
      dr[2]   = c[2] - (beta[0] * my - beta[1] * mx);
      turn[0] = beta[2];
      turn[1] = beta[1];
      turn[2] = beta[0];
    }
  }
  PetscCall(CloudUpdate(cloud, FIELD_WORK3));
  PetscCall(CloudUpdate(cloud, FIELD_STRESS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OperatorsCompensate(Cloud cloud, const PetscReal x[], const PetscReal u[], PetscReal change[])
{
  const PetscReal *g = cloud->field[FIELD_WORK3], *share = cloud->field[SHARE], *stress = cloud->field[FIELD_STRESS];
  PairRow          row;

  PetscFunctionBegin;
  PetscCall(Charge(cloud, x, u, change));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal xa = x[3 * a], ya = x[3 * a + 1], za = x[3 * a + 2];
    PetscReal       vx = 0, vy = 0, vz = 0;

    PairRowLoad(cloud, cloud->field[FIELD_POSITION], a, &row);
    KernelEvaluate(cloud->kernel, row.n, row.r2, row.W, NULL);
    SIMD_LOOP(reduction(+ : vx, vy, vz))
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt  b = row.index[k];
      const PetscReal w = row.W[k] * share[b], *turn = TURN(stress, b), dx = xa - x[3 * b], dy = ya - x[3 * b + 1],
                      dz = za - x[3 * b + 2];

      vx += w * (g[3 * b] + turn[1] * dz - turn[0] * dy);
      vy += w * (g[3 * b + 1] + turn[0] * dx - turn[2] * dz);
      vz += w * (g[3 * b + 2] + turn[2] * dy - turn[1] * dx);
    }
    change[3 * a] -= vx;
    change[3 * a + 1] -= vy;
    change[3 * a + 2] -= vz;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
