/* The pressure jumps between two immiscible liquids. For neighbours a and b on both sides (CloudAcross) b's
   pressure counts as p_b + [p], with the jump [p] of surface tension: in the gradient at a the jump at b; in Eq. (8),
   where both rows need one value, the jump in the middle. */
#include "pressure_impl.h"

/* Sets the liquid that fills most of a wall particle's row, and its mean jump next to the interface. */
static void WallLiquid(Cloud cloud, PetscInt a)
{
  PetscReal filled[2] = {0, 0}, weight = 0, jump = 0, slope[DIM] = {0, 0, 0};

  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    const PetscInt b = cloud->list[k];

    if (cloud->integer[INT_LAYER][b] == 0) filled[cloud->liquid[b]] += cloud->laplacian[k];
  }
  cloud->liquid[a] = filled[0] + filled[1] == 0 ? -1 : filled[1] > filled[0];
  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    const PetscInt b = cloud->list[k];

    if (cloud->integer[INT_LAYER][b] != 0 || cloud->liquid[b] != cloud->liquid[a] || cloud->pressure_jump[b] == 0)
      continue;
    weight += cloud->laplacian[k];
    jump += cloud->laplacian[k] * cloud->pressure_jump[b];
    for (PetscInt d = 0; d < DIM; d++) slope[d] += cloud->laplacian[k] * cloud->pressure_jump_slope[DIM * b + d];
  }
  cloud->pressure_jump[a] = weight > 0 ? jump / weight : 0;
  for (PetscInt d = 0; d < DIM; d++) cloud->pressure_jump_slope[DIM * a + d] = weight > 0 ? slope[d] / weight : 0;
}

PetscErrorCode JumpsSetUp(Pressure pressure)
{
  Cloud cloud = pressure->cloud;

  PetscFunctionBegin;
  if (!cloud->liquid) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = cloud->n_fluid; a < cloud->n_rows; a++) WallLiquid(cloud, a);
  for (PetscInt a = cloud->n_rows; a < cloud->n_owned; a++) {
    const PetscInt r = ParentRow(pressure, a);

    cloud->liquid[a]        = cloud->liquid[r];
    cloud->pressure_jump[a] = cloud->pressure_jump[r];
    for (PetscInt d = 0; d < DIM; d++)
      cloud->pressure_jump_slope[DIM * a + d] = cloud->pressure_jump_slope[DIM * r + d];
  }
  PetscCall(CloudUpdateIntArray(cloud, cloud->liquid));
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, cloud->pressure_jump));
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, cloud->pressure_jump_slope));
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    cloud->at_interface[a] = 0;
    for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1] && !cloud->at_interface[a]; k++)
      cloud->at_interface[a] = CloudAcross(cloud, a, cloud->list[k]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

void JumpsAdd(Pressure pressure, PetscScalar rhs[])
{
  Cloud cloud = pressure->cloud;

  for (PetscInt a = 0; a < cloud->n_owned && cloud->liquid; a++) {
    const PetscInt row = a < cloud->n_rows ? a : ParentRow(pressure, a);
    PetscReal      sum = 0;

    if (!cloud->at_interface[a]) continue;
    for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++)
      if (CloudAcross(cloud, a, cloud->list[k]))
        sum += PairWeight(pressure, k) * CloudPressureJump(cloud, a, cloud->list[k], 0.5);
    rhs[row] += pressure->weight_scale * sum;
  }
}

void JumpsSum(Cloud cloud, PetscInt a, const PairRow *row, PetscBool mean, PetscReal sum[DIM])
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *rho = cloud->rest_density,
                  *slope = cloud->pressure_jump_slope + DIM * a;

  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt  b     = row->index[k];
    const PetscReal share = mean ? 2 * rho[a] / (rho[a] + rho[b]) : 1;
    PetscReal       r[DIM], c;

    if (!CloudAcross(cloud, a, b)) continue;
    for (PetscInt d = 0; d < DIM; d++) r[d] = x[DIM * b + d] - x[DIM * a + d];
    c = (share * CloudPressureJump(cloud, a, b, 1) + (1 - share) * Dot(slope, r)) * row->f[k];
    for (PetscInt d = 0; d < DIM; d++) sum[d] += c * r[d];
  }
}
