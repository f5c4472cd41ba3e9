/* Surface tension as the divergence of a capillary stress: Eqs. (5)-(7) of Kuri et al. See tension.h. */
#include "tension_impl.h"

/* Adds grad phi of the walls around x: each wall face stands for a half-space full of liquid. */
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

/* The sum of grad W^H at x over the n collected candidates. */
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

/* The sum of S_b grad W^H at x over the n collected candidates, S_b in the columns 3 to 8. */
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

/* Whether particle a at x is one of those that the model is evaluated for. */
static inline PetscBool Evaluated(Tension tension, Cloud cloud, PetscInt a, const PetscReal x[DIM])
{
  return (PetscBool)(a < cloud->n_owned && BandNear(&tension->band_cells, x));
}

/* grad phi, Eq. (6), and from it the stress ([n_owned][6]) of the particles near the surface. All V are the same. */
static PetscErrorCode FindStress(Tension tension, Cloud cloud, PetscReal stress[])
{
  Liquid         *liquid = &tension->liquid;
  const PetscReal V = cloud->domain->volume, H = KernelSmoothingLength(tension->kernel);
  PetscInt        cell = -1, n = 0;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < liquid->count; p++) {
    const PetscInt a = LiquidParticle(liquid, p);
    PetscReal      x[DIM], gradient[DIM];

    LiquidPosition(liquid, p, x);
    if (!Evaluated(tension, cloud, a, x)) continue;
    if (LiquidCell(liquid, p) != cell) {
      cell = LiquidCell(liquid, p);
      PetscCall(LiquidCollect(liquid, cell, COLUMNS(0, DIM), 1, &n));
    }
    SumGradient(tension, n, x, gradient);
    for (PetscInt d = 0; d < DIM; d++) gradient[d] *= V;
    AddWalls(tension, cloud->domain, x, gradient);
    Stress(tension->calibration * H * BodyMaterial(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]))->tension,
           gradient, stress + 6 * a);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds 1/rho_a sum_b V_b S_b grad W^H_ab to the acceleration. This equals the symmetric form of Eq. (1) because
   S_a . grad phi_a = 0. */
static PetscErrorCode AddForce(Tension tension, Cloud cloud)
{
  Liquid         *liquid = &tension->liquid;
  const PetscReal V      = cloud->domain->volume;
  PetscInt        cell = -1, n = 0;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < liquid->count; p++) {
    const PetscInt a = LiquidParticle(liquid, p);
    PetscReal      x[DIM], force[DIM];

    LiquidPosition(liquid, p, x);
    if (!Evaluated(tension, cloud, a, x)) continue;
    if (LiquidCell(liquid, p) != cell) {
      cell = LiquidCell(liquid, p);
      PetscCall(LiquidCollect(liquid, cell, COLUMNS(0, DIM + 6), 1, &n));
    }
    SumForce(tension, n, x, force);
    for (PetscInt d = 0; d < DIM; d++)
      cloud->field[FIELD_ACCELERATION][DIM * a + d] += V / cloud->rest_density[a] * force[d];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CahnHilliardStress(Tension tension, Cloud cloud, PetscReal stress[])
{
  const PetscReal support = KernelSupport(tension->kernel);

  PetscFunctionBegin;
  PetscCall(LiquidSort(&tension->liquid, cloud, support, NULL));
  PetscCall(BandMark(&tension->band_cells, cloud, tension->band * support + tension->spacing, support));
  PetscCall(PetscArrayzero(stress, 6 * cloud->n_owned));
  PetscCall(FindStress(tension, cloud, stress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TensionApply_CahnHilliard(Tension tension, Cloud cloud)
{
  PetscReal *stress;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, 6, &stress));
  PetscCall(CahnHilliardStress(tension, cloud, stress));
  PetscCall(CloudUpdateArray(cloud, 6, PARITY_TENSOR, stress));
  LiquidLoad(&tension->liquid, DIM, 6, stress);
  PetscCall(CloudRestoreWork(cloud, &stress));
  PetscCall(AddForce(tension, cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* w1(s) of W^H, for the part of phi that a wall stands for. */
static PetscErrorCode TabulateWall(Tension tension)
{
  const PetscReal support = KernelSupport(tension->kernel);

  PetscFunctionBegin;
  for (PetscInt k = 0; k <= WALL_TABLE; k++)
    KernelHalfSpace(tension->kernel, support * k / WALL_TABLE, &tension->wall[k], NULL);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetFromOptions(Tension tension, OptionItems PetscOptionsObject)
{
  PetscFunctionBegin;
  PetscCall(OptionReal("-tension_calibration",
                       "kappa/(sigma H) (1); 3.959 fits a flat surface, 5.30 a flat film at H = 2.5 h", "(0, inf)",
                       &tension->calibration));
  PetscCall(OptionReal("-tension_band", "distance from the surface within which tension is evaluated, over 2H (1)",
                       "(0, 2]", &tension->band));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TensionCreate_CahnHilliard(Tension tension)
{
  PetscFunctionBegin;
  tension->setfromoptions = SetFromOptions;
  tension->setadvanced    = NULL;
  tension->setup          = TabulateWall;
  tension->apply          = TensionApply_CahnHilliard;
  PetscFunctionReturn(PETSC_SUCCESS);
}
