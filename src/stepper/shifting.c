#include "types.h"

#define LAMBDA_SHIFTED 0.2 /* below: a spray particle, not shifted */
#define CLUMP_WEIGHT   0.2 /* of the term that resists pairing (Lind et al. 2012; Monaghan 2000) */

/* dr_a = -A h dt max_b|v_b - v_a| sum V (1 + 0.2 (W/W(d0))^4) grad W (Skillen et al. 2013, Lind et al. 2012), at most
   'cap' spacings; particles on or near the surface lose the component along sum V grad W; then v_a += sum V (v_b -
   v_a)(dr . B grad W), the first Taylor term. */
PetscErrorCode Shift(Stepper stepper, PetscReal dt, PetscReal x[])
{
  Cloud            cloud = stepper->cloud;
  const PetscReal *u = cloud->field[FIELD_PREDICTED], *volume = cloud->volume, h = KernelSmoothingLength(cloud->kernel);
  const PetscReal  cap = stepper->shifting_cap * cloud->domain->spacing, scale = 1 / stepper->self_kernel;
  const PetscInt  *layer = cloud->integer[INT_LAYER];
  PetscReal       *v     = cloud->field[FIELD_VELOCITY];
  PairRow          row;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_SHIFT), 0, 0, 0, 0));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *normal = cloud->field[FIELD_NORMAL] + DIM * a, ux = u[3 * a], uy = u[3 * a + 1], uz = u[3 * a + 2];
    PetscReal        cx = 0, cy = 0, cz = 0, speed2 = 0, length, gx, gy, gz, dr[DIM], along[DIM];

    for (PetscInt d = 0; d < DIM; d++) v[DIM * a + d] = u[DIM * a + d];
    if (cloud->field[FIELD_LAMBDA][a] <= LAMBDA_SHIFTED) continue;
    PairRowLoad(cloud, cloud->field[FIELD_POSITION], a, &row);
    KernelEvaluate(cloud->kernel, row.n, row.r2, row.W, NULL);
    KernelGradient(cloud->kernel, row.n, row.r2, row.F);
    SIMD_LOOP(reduction(+ : cx, cy, cz) reduction(max : speed2))
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt  b     = row.index[k];
      const PetscReal ratio = row.W[k] * scale, ratio2 = ratio * ratio,
                      f  = volume[b] * row.F[k] * (1 + CLUMP_WEIGHT * ratio2 * ratio2);
      const PetscReal wx = u[3 * b] - ux, wy = u[3 * b + 1] - uy, wz = u[3 * b + 2] - uz,
                      w2 = wx * wx + wy * wy + wz * wz;

      cx += f * row.dx[k];
      cy += f * row.dy[k];
      cz += f * row.dz[k];
      speed2 = w2 > speed2 ? w2 : speed2;
    }
    {
      const PetscReal factor = -stepper->shifting_strength * h * dt * PetscSqrtReal(speed2);

      dr[0] = factor * cx;
      dr[1] = factor * cy;
      dr[2] = factor * cz;
    }
    if (cloud->integer[INT_SURFACE][a]) {
      const PetscReal n2 = Dot(normal, normal), share = n2 > 0 ? Dot(dr, normal) / n2 : 0;

      for (PetscInt d = 0; d < DIM; d++) dr[d] -= share * normal[d];
    }
    length = Norm(dr);
    if (length > cap)
      for (PetscInt d = 0; d < DIM; d++) dr[d] *= cap / length;
    TensorApply(cloud->field[FIELD_MOMENT] + 6 * a, dr[0], dr[1], dr[2], along);
    gx = gy = gz = 0;
    SIMD_LOOP(reduction(+ : gx, gy, gz))
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt  b = row.index[k];
      const PetscReal c =
        (layer[b] ? 0 : volume[b]) * row.F[k] * (along[0] * row.dx[k] + along[1] * row.dy[k] + along[2] * row.dz[k]);

      gx += c * (u[3 * b] - ux);
      gy += c * (u[3 * b + 1] - uy);
      gz += c * (u[3 * b + 2] - uz);
    }
    for (PetscInt d = 0; d < DIM; d++) x[DIM * a + d] += dr[d];
    v[3 * a] += gx;
    v[3 * a + 1] += gy;
    v[3 * a + 2] += gz;
  }
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_SHIFT), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
