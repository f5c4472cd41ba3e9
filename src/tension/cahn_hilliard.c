#include "types.h"

/* Cells have size H: the support reaches this many cells. */
#define CELL_REACH 2

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
    PetscCall(PetscMalloc1(9 * tension->capacity, &tension->sorted));
    PetscCall(PetscMalloc1(tension->capacity, &tension->liquid));
  }
  tension->count = 0;
  for (PetscInt a = 0; a < cloud->n_total; a++)
    if (layer[a] == 0) tension->liquid[tension->count++] = a;
  PetscCall(PetscMalloc1(DIM * tension->count, &x));
  for (PetscInt k = 0; k < tension->count; k++)
    for (PetscInt d = 0; d < DIM; d++) x[DIM * k + d] = cloud->field[FIELD_POSITION][DIM * tension->liquid[k] + d];
  PetscCall(CellGridBuild(&tension->grid, cloud->domain->dim, tension->count, x, KernelSmoothingLength(tension->kernel)));
  for (PetscInt k = 0; k < tension->count; k++)
    for (PetscInt d = 0; d < DIM; d++) tension->sorted[d * tension->count + k] = x[DIM * tension->grid.order[k] + d];
  PetscCall(PetscFree(x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks the cells within the band of a cell that holds a surface particle, a direction after the other. */
static PetscErrorCode MarkNear(Tension tension, Cloud cloud)
{
  const CellGrid *grid = &tension->grid;
  const PetscInt  reach = (PetscInt)PetscCeilReal((tension->band * KernelSupport(tension->kernel) + tension->spacing) / grid->size), stride[DIM] = {1, grid->n[0], grid->n[0] * grid->n[1]};

  PetscFunctionBegin;
  if (grid->count > tension->near_capacity) {
    tension->near_capacity = grid->count + grid->count / 4;
    PetscCall(PetscFree(tension->near));
    PetscCall(PetscMalloc1(tension->near_capacity, &tension->near));
  }
  for (PetscInt c = 0; c < grid->count; c++) {
    tension->near[c] = 0;
    for (PetscInt k = grid->start[c]; k < grid->start[c + 1] && !tension->near[c]; k++) tension->near[c] = (unsigned char)(cloud->integer[INT_SURFACE][tension->liquid[grid->order[k]]] == 1);
  }
  for (PetscInt d = 0; d < DIM; d++) {
    for (PetscInt c = 0; c < grid->count; c++) {
      PetscInt since = reach + 1;

      if ((c / stride[d]) % grid->n[d]) continue; /* c starts a line along d */
      for (PetscInt k = 0; k < grid->n[d]; k++) { /* forwards: spread marks up to 'reach' ahead, as 2 */
        unsigned char *cell = &tension->near[c + k * stride[d]];

        since = *cell == 1 ? 0 : since + 1;
        if (since && since <= reach) *cell = 2;
      }
      since = reach + 1;
      for (PetscInt k = grid->n[d] - 1; k >= 0; k--) {
        unsigned char *cell = &tension->near[c + k * stride[d]];

        since = *cell == 1 ? 0 : since + 1;
        if (since && since <= reach) *cell = 2;
      }
    }
    for (PetscInt c = 0; c < grid->count; c++) tension->near[c] = tension->near[c] != 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Runs body(begin, count) over the rows of cells around cell c: contiguous sorted particles. */
#define FOR_RUNS(grid, c, begin, n_run) \
  for (PetscInt cx = (c) % (grid)->n[0], cy = ((c) / (grid)->n[0]) % (grid)->n[1], cz = (c) / ((grid)->n[0] * (grid)->n[1]), z = PetscMax(0, cz - CELL_REACH); z <= PetscMin((grid)->n[2] - 1, cz + CELL_REACH); z++) \
    for (PetscInt y = PetscMax(0, cy - CELL_REACH); y <= PetscMin((grid)->n[1] - 1, cy + CELL_REACH); y++) \
      for (PetscInt line = (z * (grid)->n[1] + y) * (grid)->n[0], begin = (grid)->start[line + PetscMax(0, cx - CELL_REACH)], n_run = (grid)->start[line + PetscMin((grid)->n[0] - 1, cx + CELL_REACH) + 1] - begin, once = 1; once; once = 0)

#define RUN_CHUNK 512

/* grad phi of the walls around x: each wall face is a half-space full of liquid. */
static void AddWalls(Tension tension, Domain domain, const PetscReal x[DIM], PetscReal gradient[DIM])
{
  const PetscReal support = KernelSupport(tension->kernel);

  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt side = 0; side < 2; side++) {
      const PetscReal s = PetscAbsReal((side ? domain->upper[d] : domain->lower[d]) - x[d]), place = s / support * WALL_TABLE;
      const PetscInt  k = (PetscInt)PetscMin(place, (PetscReal)WALL_TABLE);

      if (domain->face[d][side] != FACE_WALL || k >= WALL_TABLE) continue;
      gradient[d] += (side ? 1 : -1) * (tension->wall[k] + (place - k) * (tension->wall[k + 1] - tension->wall[k]));
    }
}

/* grad phi, Eq. (6), and S, Eq. (7), of the owned liquid in near cells. All V are the same. */
static PetscErrorCode StressPass(Tension tension, Cloud cloud)
{
  const CellGrid  *grid = &tension->grid;
  const PetscInt   n = tension->count;
  const PetscReal *sx = tension->sorted, *sy = sx + n, *sz = sy + n, H = KernelSmoothingLength(tension->kernel);
  PetscReal       *S = cloud->field[FIELD_STRESS], r2[RUN_CHUNK], F[RUN_CHUNK];

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(S, 6 * cloud->n_owned));
  for (PetscInt c = 0; c < grid->count; c++) {
    if (!tension->near[c]) continue;
    for (PetscInt p = grid->start[c]; p < grid->start[c + 1]; p++) {
      const PetscInt  a = tension->liquid[grid->order[p]];
      const PetscReal x = sx[p], y0 = sy[p], z0 = sz[p];
      PetscReal       g[DIM] = {0, 0, 0}, kappa, g2;

      if (a >= cloud->n_owned) continue;
      FOR_RUNS(grid, c, begin, length) {
        for (PetscInt chunk = begin; chunk < begin + length; chunk += RUN_CHUNK) {
          const PetscInt m  = PetscMin(RUN_CHUNK, begin + length - chunk);
          PetscReal      gx = 0, gy = 0, gz = 0;

          SIMD_LOOP()
          for (PetscInt k = 0; k < m; k++) r2[k] = PetscSqr(x - sx[chunk + k]) + PetscSqr(y0 - sy[chunk + k]) + PetscSqr(z0 - sz[chunk + k]);
          KernelEvaluate(tension->kernel, m, r2, NULL, F);
          SIMD_LOOP(reduction(+ : gx, gy, gz))
          for (PetscInt k = 0; k < m; k++) {
            gx += F[k] * (x - sx[chunk + k]);
            gy += F[k] * (y0 - sy[chunk + k]);
            gz += F[k] * (z0 - sz[chunk + k]);
          }
          g[0] += gx;
          g[1] += gy;
          g[2] += gz;
        }
      }
      for (PetscInt d = 0; d < DIM; d++) g[d] *= cloud->domain->volume;
      {
        const PetscReal position[DIM] = {x, y0, z0};

        AddWalls(tension, cloud->domain, position, g);
      }
      kappa        = tension->calibration * H * BodyMaterial(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]))->tension;
      g2           = Dot(g, g);
      S[6 * a]     = kappa * (g2 - g[0] * g[0]);
      S[6 * a + 1] = kappa * (g2 - g[1] * g[1]);
      S[6 * a + 2] = kappa * (g2 - g[2] * g[2]);
      S[6 * a + 3] = -kappa * g[0] * g[1];
      S[6 * a + 4] = -kappa * g[0] * g[2];
      S[6 * a + 5] = -kappa * g[1] * g[2];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* acceleration += 1/rho_a sum_b V_b S_b grad W^H_ab, which equals the symmetric form of Eq. (1) because S_a . grad phi_a = 0. */
static PetscErrorCode ForcePass(Tension tension, Cloud cloud)
{
  const CellGrid  *grid = &tension->grid;
  const PetscInt   n = tension->count;
  const PetscReal *sx = tension->sorted, *sy = sx + n, *sz = sy + n, *xx = sz + n, *yy = xx + n, *zz = yy + n, *xy = zz + n, *xz = xy + n, *yz = xz + n;
  PetscReal        r2[RUN_CHUNK], F[RUN_CHUNK];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++)
    for (PetscInt i = 0; i < 6; i++) tension->sorted[(3 + i) * n + k] = cloud->field[FIELD_STRESS][6 * tension->liquid[grid->order[k]] + i];
  for (PetscInt c = 0; c < grid->count; c++) {
    if (!tension->near[c]) continue;
    for (PetscInt p = grid->start[c]; p < grid->start[c + 1]; p++) {
      const PetscInt  a = tension->liquid[grid->order[p]];
      const PetscReal x = sx[p], y0 = sy[p], z0 = sz[p], scale = cloud->domain->volume / cloud->rest_density[a];
      PetscReal       f[DIM] = {0, 0, 0};

      if (a >= cloud->n_owned) continue;
      FOR_RUNS(grid, c, begin, length) {
        for (PetscInt chunk = begin; chunk < begin + length; chunk += RUN_CHUNK) {
          const PetscInt m  = PetscMin(RUN_CHUNK, begin + length - chunk);
          PetscReal      fx = 0, fy = 0, fz = 0;

          SIMD_LOOP()
          for (PetscInt k = 0; k < m; k++) r2[k] = PetscSqr(x - sx[chunk + k]) + PetscSqr(y0 - sy[chunk + k]) + PetscSqr(z0 - sz[chunk + k]);
          KernelEvaluate(tension->kernel, m, r2, NULL, F);
          SIMD_LOOP(reduction(+ : fx, fy, fz))
          for (PetscInt k = 0; k < m; k++) {
            const PetscInt  b  = chunk + k;
            const PetscReal dx = F[k] * (x - sx[b]), dy = F[k] * (y0 - sy[b]), dz = F[k] * (z0 - sz[b]);

            fx += xx[b] * dx + xy[b] * dy + xz[b] * dz;
            fy += xy[b] * dx + yy[b] * dy + yz[b] * dz;
            fz += xz[b] * dx + yz[b] * dy + zz[b] * dz;
          }
          f[0] += fx;
          f[1] += fy;
          f[2] += fz;
        }
      }
      for (PetscInt d = 0; d < DIM; d++) cloud->field[FIELD_ACCELERATION][DIM * a + d] += scale * f[d];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TensionApply_CahnHilliard(Tension tension, Cloud cloud)
{
  PetscFunctionBegin;
  PetscCall(SortLiquid(tension, cloud));
  PetscCall(MarkNear(tension, cloud));
  PetscCall(StressPass(tension, cloud));
  PetscCall(CloudUpdate(cloud, FIELD_STRESS));
  PetscCall(ForcePass(tension, cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}
