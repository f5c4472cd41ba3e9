#include "types.h"

/* Cells a support: small enough that the cells around a particle are not much more than its sphere, large enough that
   the particles of one share the work of collecting them. */
#define CELLS_A_SUPPORT 3

/* Sorts the liquid (fluid particles, ghosts too) into cells. */
static PetscErrorCode SortLiquid(Tension tension, Cloud cloud)
{
  const PetscInt *layer = cloud->integer[INT_LAYER];
  PetscReal      *x;

  PetscFunctionBegin;
  if (cloud->n_total > tension->capacity) {
    tension->capacity = cloud->n_total + cloud->n_total / 8;
    PetscCall(PetscFree(tension->sorted));
    PetscCall(PetscFree(tension->liquid));
    PetscCall(PetscFree(tension->candidates));
    PetscCall(PetscMalloc1(9 * tension->capacity, &tension->sorted));
    PetscCall(PetscMalloc1(9 * tension->capacity, &tension->candidates));
    PetscCall(PetscMalloc1(tension->capacity, &tension->liquid));
  }
  tension->count = 0;
  for (PetscInt a = 0; a < cloud->n_total; a++)
    if (layer[a] == 0) tension->liquid[tension->count++] = a;
  PetscCall(PetscMalloc1(DIM * tension->count, &x));
  for (PetscInt k = 0; k < tension->count; k++)
    for (PetscInt d = 0; d < DIM; d++) x[DIM * k + d] = cloud->field[FIELD_POSITION][DIM * tension->liquid[k] + d];
  PetscCall(CellGridBuild(&tension->grid, cloud->domain->dim, tension->count, x,
                          KernelSupport(tension->kernel) / CELLS_A_SUPPORT));
  for (PetscInt k = 0; k < tension->count; k++)
    for (PetscInt d = 0; d < DIM; d++) tension->sorted[d * tension->count + k] = x[DIM * tension->grid.order[k] + d];
  PetscCall(PetscFree(x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How many cells further along x may hold points within 'radius' of a cell that is dy, dz cells away; -1: none. */
static PetscInt CellsAlong(PetscReal size, PetscReal radius, PetscInt dy, PetscInt dz)
{
  const PetscReal y = PetscMax(PetscAbsInt(dy) - 1, 0) * size, z = PetscMax(PetscAbsInt(dz) - 1, 0) * size,
                  rest = radius * radius - y * y - z * z;

  return rest > 0 ? (PetscInt)(PetscSqrtReal(rest) / size) + 1 : -1;
}

/* Collects 'width' columns of the sorted particles within the support of cell c into candidates[width][n], one behind
 * the other; returns n. */
static PetscInt Collect(Tension tension, PetscInt c, PetscInt width)
{
  const CellGrid *grid    = &tension->grid;
  const PetscReal support = KernelSupport(tension->kernel);
  const PetscInt  x = c % grid->n[0], y = (c / grid->n[0]) % grid->n[1], z = c / (grid->n[0] * grid->n[1]);
  const PetscInt  reach = (PetscInt)(support / grid->size) + 1;
  PetscInt        n     = 0;

  for (PetscInt dz = PetscMax(-reach, -z); dz <= PetscMin(reach, grid->n[2] - 1 - z); dz++)
    for (PetscInt dy = PetscMax(-reach, -y); dy <= PetscMin(reach, grid->n[1] - 1 - y); dy++) {
      const PetscInt along = CellsAlong(grid->size, support, dy, dz),
                     line  = ((z + dz) * grid->n[1] + y + dy) * grid->n[0];

      if (along < 0) continue;
      {
        const PetscInt begin  = grid->start[line + PetscMax(0, x - along)],
                       length = grid->start[line + PetscMin(grid->n[0] - 1, x + along) + 1] - begin;

        for (PetscInt w = 0; w < width; w++)
          for (PetscInt k = 0; k < length; k++)
            tension->candidates[w * tension->count + n + k] = tension->sorted[w * tension->count + begin + k];
        n += length;
      }
    }
  return n;
}

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
  const PetscReal *restrict cx = tension->candidates, *restrict cy = cx + tension->count,
                            *restrict cz = cy + tension->count;
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
  const PetscInt stride        = tension->count;
  const PetscReal *restrict cx = tension->candidates, *restrict cy = cx + stride, *restrict cz = cy + stride;
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
  const CellGrid *grid = &tension->grid;
  const PetscReal V = cloud->domain->volume, H = KernelSmoothingLength(tension->kernel);

  PetscFunctionBegin;
  for (PetscInt c = 0; c < grid->count; c++) {
    PetscInt n = -1;

    for (PetscInt p = grid->start[c]; p < grid->start[c + 1]; p++) {
      const PetscInt  a      = tension->liquid[grid->order[p]];
      const PetscReal x[DIM] = {tension->sorted[p], tension->sorted[tension->count + p],
                                tension->sorted[2 * tension->count + p]};
      PetscReal       sum[DIM];

      if (a >= cloud->n_owned || !tension->band_cells.near[BandCell(&tension->band_cells, x)]) continue;
      if (n < 0) n = Collect(tension, c, force ? 9 : 3);
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
  PetscFunctionBegin;
  PetscCall(SortLiquid(tension, cloud));
  if (!tension->has_band) {
    const PetscReal support = KernelSupport(tension->kernel);

    PetscCall(BandCreate(cloud->domain, tension->band * support + tension->spacing, support + cloud->slack,
                         &tension->band_cells));
    tension->has_band = PETSC_TRUE;
  }
  PetscCall(BandMark(&tension->band_cells, cloud));
  PetscCall(PetscArrayzero(cloud->field[FIELD_STRESS], 6 * cloud->n_owned));
  PetscCall(Pass(tension, cloud, PETSC_FALSE));
  PetscCall(CloudUpdate(cloud, FIELD_STRESS));
  for (PetscInt i = 0; i < 6; i++)
    for (PetscInt k = 0; k < tension->count; k++)
      tension->sorted[(3 + i) * tension->count + k] =
        cloud->field[FIELD_STRESS][6 * tension->liquid[tension->grid.order[k]] + i];
  PetscCall(Pass(tension, cloud, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}
