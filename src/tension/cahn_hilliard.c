#include "tension_impl.h"

#define CHUNK 512

/* grad phi of the walls around x: each wall face is a half-space full of liquid. */
static void AddWalls(Tension tension, Domain domain, const PetscReal x[DIM], PetscReal gradient[DIM])
{
  const PetscReal support = KernelSupport(tension->kernel);

  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt side = 0; side < 2; side++) {
      const PetscReal s     = PetscAbsReal((side ? domain->upper[d] : domain->lower[d]) - x[d]),
                      place = s / support * WALL_TABLE;
      const PetscInt k      = (PetscInt)PetscMin(place, (PetscReal)WALL_TABLE);

      if (domain->face[d][side] != FACE_WALL || k >= WALL_TABLE) continue;
      gradient[d] += (side ? 1 : -1) * (tension->wall[k] + (place - k) * (tension->wall[k + 1] - tension->wall[k]));
    }
}

/* sum over the n collected candidates of V grad W^H at x (without V). */
static void SumGradient(Tension tension, PetscInt n, const PetscReal x[DIM], PetscReal gradient[DIM])
{
  const PetscReal *restrict cx = tension->liquid.near, *restrict cy = cx + tension->liquid.stride,
                            *restrict cz = cy + tension->liquid.stride;
  PetscReal r2[CHUNK], F[CHUNK];

  gradient[0] = gradient[1] = gradient[2] = 0;
  for (PetscInt begin = 0; begin < n; begin += CHUNK) {
    const PetscInt  m  = PetscMin(CHUNK, n - begin);
    const PetscReal x0 = x[0], y0 = x[1], z0 = x[2];
    PetscReal       gx = 0, gy = 0, gz = 0;

    SIMD_LOOP()
    for (PetscInt k = 0; k < m; k++)
      r2[k] = PetscSqr(x0 - cx[begin + k]) + PetscSqr(y0 - cy[begin + k]) + PetscSqr(z0 - cz[begin + k]);
    KernelGradient(tension->kernel, m, r2, F);
    SIMD_LOOP(reduction(+ : gx, gy, gz))
    for (PetscInt k = 0; k < m; k++) {
      gx += F[k] * (x0 - cx[begin + k]);
      gy += F[k] * (y0 - cy[begin + k]);
      gz += F[k] * (z0 - cz[begin + k]);
    }
    gradient[0] += gx;
    gradient[1] += gy;
    gradient[2] += gz;
  }
}

/* sum over the n collected candidates of S_b grad W^H at x (without V). */
static void SumForce(Tension tension, PetscInt n, const PetscReal x[DIM], PetscReal force[DIM])
{
  const PetscInt stride        = tension->liquid.stride;
  const PetscReal *restrict cx = tension->liquid.near, *restrict cy = cx + stride, *restrict cz = cy + stride;
  const PetscReal *restrict xx = cz + stride, *restrict yy = xx + stride, *restrict zz = yy + stride,
                            *restrict xy = zz + stride, *restrict xz = xy + stride, *restrict yz = xz + stride;
  PetscReal r2[CHUNK], F[CHUNK];

  force[0] = force[1] = force[2] = 0;
  for (PetscInt begin = 0; begin < n; begin += CHUNK) {
    const PetscInt  m  = PetscMin(CHUNK, n - begin);
    const PetscReal x0 = x[0], y0 = x[1], z0 = x[2];
    PetscReal       fx = 0, fy = 0, fz = 0;

    SIMD_LOOP()
    for (PetscInt k = 0; k < m; k++)
      r2[k] = PetscSqr(x0 - cx[begin + k]) + PetscSqr(y0 - cy[begin + k]) + PetscSqr(z0 - cz[begin + k]);
    KernelGradient(tension->kernel, m, r2, F);
    SIMD_LOOP(reduction(+ : fx, fy, fz))
    for (PetscInt k = 0; k < m; k++) {
      const PetscInt  b  = begin + k;
      const PetscReal dx = F[k] * (x0 - cx[b]), dy = F[k] * (y0 - cy[b]), dz = F[k] * (z0 - cz[b]);

      fx += xx[b] * dx + xy[b] * dy + xz[b] * dz;
      fy += xy[b] * dx + yy[b] * dy + yz[b] * dz;
      fz += xz[b] * dx + yz[b] * dy + zz[b] * dz;
    }
    force[0] += fx;
    force[1] += fy;
    force[2] += fz;
  }
}

/* S = kappa (|g|^2 I - g (x) g), Eq. (7). */
static void Stress(PetscReal kappa, const PetscReal g[DIM], PetscReal S[6])
{
  const PetscReal g2 = Dot(g, g);

  for (PetscInt d = 0; d < DIM; d++) S[d] = kappa * (g2 - g[d] * g[d]);
  S[3] = -kappa * g[0] * g[1];
  S[4] = -kappa * g[0] * g[2];
  S[5] = -kappa * g[1] * g[2];
}

/* One pass over the owned liquid in near cells: grad phi, Eq. (6), and S; or, with S known everywhere, acceleration +=
   1/rho_a sum_b V_b S_b grad W^H_ab, which equals the symmetric form of Eq. (1) because S_a . grad phi_a = 0. All V are
   the same. */
static PetscErrorCode Pass(Tension tension, Cloud cloud, PetscBool force)
{
  Liquid         *liquid = &tension->liquid;
  const CellGrid *grid   = &liquid->grid;
  const PetscReal V = cloud->domain->volume, H = KernelSmoothingLength(tension->kernel);

  PetscFunctionBegin;
  for (PetscInt c = 0; c < grid->count; c++) {
    PetscInt n = -1;

    for (PetscInt p = grid->start[c]; p < grid->start[c + 1]; p++) {
      const PetscInt  a      = LiquidParticle(liquid, p);
      const PetscReal x[DIM] = {liquid->sorted[p], liquid->sorted[liquid->count + p],
                                liquid->sorted[2 * liquid->count + p]};
      PetscReal       sum[DIM];

      if (a >= cloud->n_owned || !BandNear(&tension->band_cells, x)) continue;
      if (n < 0) PetscCall(LiquidCollect(liquid, c, COLUMNS(0, force ? 9 : 3), 1, &n));
      if (force) {
        SumForce(tension, n, x, sum);
        for (PetscInt d = 0; d < DIM; d++)
          cloud->field[FIELD_ACCELERATION][DIM * a + d] += V / cloud->rest_density[a] * sum[d];
      } else {
        SumGradient(tension, n, x, sum);
        for (PetscInt d = 0; d < DIM; d++) sum[d] *= V;
        AddWalls(tension, cloud->domain, x, sum);
        Stress(tension->calibration * H * BodyMaterial(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]))->tension,
               sum, cloud->field[FIELD_STRESS] + 6 * a);
      }
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TensionApply_CahnHilliard(Tension tension, Cloud cloud)
{
  const PetscReal support = KernelSupport(tension->kernel);

  PetscFunctionBegin;
  PetscCall(LiquidSort(&tension->liquid, cloud, support, NULL));
  PetscCall(TensionBand(tension, cloud, tension->band * support + tension->spacing));
  PetscCall(PetscArrayzero(cloud->field[FIELD_STRESS], 6 * cloud->n_owned));
  PetscCall(Pass(tension, cloud, PETSC_FALSE));
  PetscCall(CloudUpdate(cloud, FIELD_STRESS));
  LiquidLoad(&tension->liquid, 3, 6, cloud->field[FIELD_STRESS]);
  PetscCall(Pass(tension, cloud, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}
