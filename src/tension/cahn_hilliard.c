/* Surface tension as the divergence of a capillary stress: Eqs. (5)-(7) of Kuri et al. See tension.h. The kernel has a
   thousand neighbours; sums are in single precision, relative to a point nearby. */
#include "tension_impl.h"

#define NEAR_CELLS     4         /* cells in the distance from the surface up to which the model is evaluated */
#define VOLUME_COLUMN  DIM       /* rho_0/rho_b: V_b over the volume at rest density */
#define DENSITY_COLUMN (DIM + 1) /* rho_0 of b: m_b over V */

static inline CahnHilliard *Data(Tension tension)
{
  return (CahnHilliard *)tension->data;
}

/* Adds grad phi of the walls around x: each wall is a half-space full of liquid. */
static void AddWalls(Tension tension, Domain domain, const PetscReal x[DIM], PetscReal gradient[DIM])
{
  const CahnHilliard *data    = tension->data;
  const PetscReal     support = KernelSupport(tension->kernel);

  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt side = 0; side < 2; side++) {
      const PetscReal s     = PetscAbsReal((side ? domain->upper[d] : domain->lower[d]) - x[d]),
                      place = s / support * WALL_TABLE;
      const PetscInt k      = (PetscInt)PetscMin(place, (PetscReal)WALL_TABLE);

      if (domain->face[d][side] != FACE_WALL || k >= WALL_TABLE) continue;
      gradient[d] += (side ? 1 : -1) * (data->wall[k] + (place - k) * (data->wall[k + 1] - data->wall[k]));
    }
}

/* The kernel's F without its scale between x and m <= CHUNK candidates c[3] from a place on. */
static inline void Slopes(Tension tension, const float *const c[DIM], PetscInt m, const float x[DIM], float F[])
{
  const float *restrict cx = c[0], *restrict cy = c[1], *restrict cz = c[2];
  const float x0 = x[0], y0 = x[1], z0 = x[2];
  PetscReal   scale_w, scale_f, inverse_h2;
  float       s[CHUNK];

  KernelScales(tension->kernel, &scale_w, &scale_f, &inverse_h2);
  SIMD_LOOP()
  for (PetscInt k = 0; k < m; k++) {
    const float dx = x0 - cx[k], dy = y0 - cy[k], dz = z0 - cz[k];

    s[k] = (dx * dx + dy * dy + dz * dz) * (float)inverse_h2;
  }
  KernelSingle(tension->kernel, m, s, NULL, F);
}

/* The sum of grad W^H at x over m candidates; with -tension_density summed the sums of w grad W^H with w in
   VOLUME_COLUMN and in DENSITY_COLUMN. */
static void SumGradients(Tension tension, PetscInt m, const float x[DIM], PetscReal gradient[2][DIM])
{
  const PetscInt stride = tension->liquid->single_stride;
  const float    x0 = x[0], y0 = x[1], z0 = x[2];
  PetscReal      scale_w, scale_f, inverse_h2;
  float          F[CHUNK];

  KernelScales(tension->kernel, &scale_w, &scale_f, &inverse_h2);
  for (PetscInt d = 0; d < DIM; d++) gradient[0][d] = gradient[1][d] = 0;
  for (PetscInt begin = 0; begin < m; begin += CHUNK) {
    const PetscInt count     = PetscMin(CHUNK, m - begin);
    const float *restrict cx = tension->liquid->single + begin, *restrict cy = cx + stride, *restrict cz = cy + stride,
                          *restrict w = cx + VOLUME_COLUMN * stride, *restrict rho = cx + DENSITY_COLUMN * stride;
    float gx = 0, gy = 0, gz = 0, hx = 0, hy = 0, hz = 0;

    Slopes(tension, (const float *const[]){cx, cy, cz}, count, x, F);
    if (Data(tension)->summed) {
      SIMD_LOOP(reduction(+ : gx, gy, gz, hx, hy, hz))
      for (PetscInt k = 0; k < count; k++) {
        const float dx = x0 - cx[k], dy = y0 - cy[k], dz = z0 - cz[k], f = F[k] * w[k], h = F[k] * rho[k];

        gx += f * dx;
        gy += f * dy;
        gz += f * dz;
        hx += h * dx;
        hy += h * dy;
        hz += h * dz;
      }
    } else {
      SIMD_LOOP(reduction(+ : gx, gy, gz))
      for (PetscInt k = 0; k < count; k++) {
        gx += F[k] * (x0 - cx[k]);
        gy += F[k] * (y0 - cy[k]);
        gz += F[k] * (z0 - cz[k]);
      }
    }
    gradient[0][0] += scale_f * gx;
    gradient[0][1] += scale_f * gy;
    gradient[0][2] += scale_f * gz;
    gradient[1][0] += scale_f * hx;
    gradient[1][1] += scale_f * hy;
    gradient[1][2] += scale_f * hz;
  }
}

/* The sum of S_b grad W^H = |g|^2 grad W^H - g (g . grad W^H) at x over m candidates, g of b in the columns 3 to 5. */
static void SumForce(Tension tension, PetscInt m, const float x[DIM], PetscReal force[DIM])
{
  const PetscInt stride = tension->liquid->single_stride;
  const float    x0 = x[0], y0 = x[1], z0 = x[2];
  float          F[CHUNK];
  PetscReal      scale_w, scale_f, inverse_h2;

  KernelScales(tension->kernel, &scale_w, &scale_f, &inverse_h2);
  force[0] = force[1] = force[2] = 0;
  for (PetscInt begin = 0; begin < m; begin += CHUNK) {
    const PetscInt count     = PetscMin(CHUNK, m - begin);
    const float *restrict cx = tension->liquid->single + begin, *restrict cy = cx + stride, *restrict cz = cy + stride,
                          *restrict gx = cz + stride, *restrict gy = gx + stride, *restrict gz = gy + stride;
    float fx = 0, fy = 0, fz = 0;

    Slopes(tension, (const float *const[]){cx, cy, cz}, count, x, F);
    SIMD_LOOP(reduction(+ : fx, fy, fz))
    for (PetscInt k = 0; k < count; k++) {
      const float wx = F[k] * (x0 - cx[k]), wy = F[k] * (y0 - cy[k]), wz = F[k] * (z0 - cz[k]),
                  g2 = gx[k] * gx[k] + gy[k] * gy[k] + gz[k] * gz[k], along = gx[k] * wx + gy[k] * wy + gz[k] * wz;

      fx += g2 * wx - gx[k] * along;
      fy += g2 * wy - gy[k] * along;
      fz += g2 * wz - gz[k] * along;
    }
    force[0] += scale_f * fx;
    force[1] += scale_f * fy;
    force[2] += scale_f * fz;
  }
}

/* Whether the model is evaluated for particle a at x. */
static inline PetscBool Evaluated(Tension tension, Cloud cloud, PetscInt a, const PetscReal x[DIM])
{
  return (PetscBool)(a < cloud->n_owned && CellMaskHas(&Data(tension)->near, x));
}

/* With -tension_density summed: loads the columns of the first pass. */
static PetscErrorCode LoadDensities(Tension tension, Cloud cloud)
{
  const PetscReal *rest = cloud->rest_density, *rho = cloud->field[FIELD_DENSITY];
  PetscReal       *columns;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, 2, &columns));
  for (PetscInt b = 0; b < cloud->n_total; b++) {
    columns[2 * b]     = rest[b] / rho[b];
    columns[2 * b + 1] = rest[b];
  }
  SortedCellsLoad(tension->liquid, VOLUME_COLUMN, 2, columns);
  PetscCall(CloudRestoreWork(cloud, &columns));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the part of Eq. (1) with the particle's own stress, S_a/rho_a^2 sum m_b grad W^H, and turns g into the form in
   the other particles' sums, of S_a rho_0/rho_a^2. gradient: of the density over V_0, without walls. */
static void AddOwnForce(Tension tension, Cloud cloud, PetscInt a, const PetscReal x[DIM], PetscReal gradient[DIM],
                        PetscReal g[DIM])
{
  const PetscReal V = cloud->domain->volume, rest = cloud->rest_density[a], rho = cloud->field[FIELD_DENSITY][a];
  PetscReal       walls[DIM] = {0}, along;

  AddWalls(tension, cloud->domain, x, walls);
  for (PetscInt d = 0; d < DIM; d++) gradient[d] = V * gradient[d] + rest * walls[d];
  along = Dot(g, gradient);
  for (PetscInt d = 0; d < DIM; d++)
    cloud->field[FIELD_ACCELERATION][DIM * a + d] += (Dot(g, g) * gradient[d] - along * g[d]) / (rho * rho);
  for (PetscInt d = 0; d < DIM; d++) g[d] *= PetscSqrtReal(rest) / rho;
}

/* Finds g of particle a at x, root(kappa) times grad phi of Eq. (6); with -tension_density summed times
   root(rho_0)/rho. place: x, relative to the m candidates' origin. */
static void FindGradient(Tension tension, Cloud cloud, PetscInt a, const PetscReal x[DIM], const float place[DIM],
                         PetscInt m, PetscReal g[DIM])
{
  const PetscReal sigma = BodyMaterial(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]))->tension,
                  kappa = Data(tension)->calibration * KernelSmoothingLength(tension->kernel) * sigma;
  PetscReal gradient[2][DIM];

  SumGradients(tension, m, place, gradient);
  for (PetscInt d = 0; d < DIM; d++) gradient[0][d] *= cloud->domain->volume;
  AddWalls(tension, cloud->domain, x, gradient[0]);
  for (PetscInt d = 0; d < DIM; d++) g[d] = PetscSqrtReal(kappa) * gradient[0][d];
  if (Data(tension)->summed) AddOwnForce(tension, cloud, a, x, gradient[1], g);
}

/* Adds 1/rho_a sum_b V_b S_b grad W^H_ab to the acceleration of particle a. With one rest density this equals the
   symmetric form of Eq. (1), because S_a . grad phi_a = 0. With summed densities it adds the rest of that form, without
   the part of AddOwnForce. */
static void AddForce(Tension tension, Cloud cloud, PetscInt a, const float place[DIM], PetscInt m)
{
  const PetscReal factor = cloud->domain->volume / (Data(tension)->summed ? 1 : cloud->rest_density[a]);
  PetscReal       force[DIM];

  SumForce(tension, m, place, force);
  for (PetscInt d = 0; d < DIM; d++) cloud->field[FIELD_ACCELERATION][DIM * a + d] += factor * force[d];
}

/* The places before 'end' from p on that are of one cell, and the box (m) of those that are evaluated. Returns the
   place behind them. */
static PetscInt NextGroup(Tension tension, Cloud cloud, PetscInt p, PetscReal lower[DIM], PetscReal upper[DIM],
                          PetscInt *evaluated)
{
  const SortedCells *liquid = tension->liquid;
  const PetscInt     cell   = SortedCell(liquid, p);

  *evaluated = 0;
  for (; p < liquid->count && SortedCell(liquid, p) == cell; p++) {
    PetscReal x[DIM];

    SortedPosition(liquid, p, x);
    if (!Evaluated(tension, cloud, liquid->index[p], x)) continue;
    for (PetscInt d = 0; d < DIM; d++) {
      lower[d] = *evaluated ? PetscMin(lower[d], x[d]) : x[d];
      upper[d] = *evaluated ? PetscMax(upper[d], x[d]) : x[d];
    }
    (*evaluated)++;
  }
  return p;
}

/* One of both passes over the particles near the surface: the first, if there is g ([n_owned][3]), finds it, the second
   adds the force. */
static PetscErrorCode Pass(Tension tension, Cloud cloud, PetscReal g[])
{
  SortedCells   *liquid  = tension->liquid;
  const PetscInt columns = DIM + (!g ? DIM : Data(tension)->summed ? 2 : 0);
  PetscReal      lower[DIM], upper[DIM];

  PetscFunctionBegin;
  for (PetscInt p = 0, end; p < liquid->count; p = end) {
    PetscInt evaluated, m = 0;

    end = NextGroup(tension, cloud, p, lower, upper, &evaluated);
    if (!evaluated) continue;
    PetscCall(SortedCellsCollectSingle(liquid, SortedCell(liquid, p), columns, lower, upper, &m));
    for (PetscInt q = p; q < end; q++) {
      const PetscInt a = liquid->index[q];
      PetscReal      x[DIM];
      float          place[DIM]; /* x, relative to the origin of the candidates */

      SortedPosition(liquid, q, x);
      if (!Evaluated(tension, cloud, a, x)) continue;
      for (PetscInt d = 0; d < DIM; d++) place[d] = (float)(x[d] - lower[d]);
      if (g)
        FindGradient(tension, cloud, a, x, place, m, g + DIM * a);
      else
        AddForce(tension, cloud, a, place, m);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CahnHilliardMark(Tension tension, Cloud cloud, PetscReal radius)
{
  const Domain    domain  = cloud->domain;
  CahnHilliard   *data    = tension->data;
  const PetscReal support = KernelSupport(tension->kernel);
  PetscReal       origin[DIM];
  PetscInt       *of, count;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < DIM; d++) origin[d] = domain->lower[d] - (support + cloud->slack);
  PetscCall(PetscMalloc1(cloud->n_total, &of));
  PetscCall(SurfaceList(cloud, NULL, NULL, of, &count));
  PetscCall(CellMaskDestroy(&data->near));
  PetscCall(CellMaskCreate(domain->comm, domain->dim, origin, radius / NEAR_CELLS, radius, count, of,
                           cloud->field[FIELD_POSITION], &data->near));
  PetscCall(PetscFree(of));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CahnHilliardGradient(Tension tension, Cloud cloud, PetscReal g[])
{
  PetscFunctionBegin;
  PetscCall(LiquidSort(tension, cloud, NULL, 0, NULL));
  PetscCall(CahnHilliardMark(tension, cloud, KernelSupport(tension->kernel) + tension->spacing));
  PetscCall(PetscArrayzero(g, DIM * cloud->n_owned));
  if (Data(tension)->summed) PetscCall(LoadDensities(tension, cloud));
  PetscCall(Pass(tension, cloud, g));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TensionApply_CahnHilliard(Tension tension, Cloud cloud)
{
  PetscReal *g;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, DIM, &g));
  PetscCall(CahnHilliardGradient(tension, cloud, g));
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, g));
  SortedCellsLoad(tension->liquid, DIM, DIM, g);
  PetscCall(CloudRestoreWork(cloud, &g));
  PetscCall(Pass(tension, cloud, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tabulates w1(s) of W^H, for the part of phi from a wall. */
static PetscErrorCode TabulateWall(void *owner)
{
  Tension         tension = (Tension)owner;
  CahnHilliard   *data    = tension->data;
  const PetscReal support = KernelSupport(tension->kernel);

  PetscFunctionBegin;
  for (PetscInt k = 0; k <= WALL_TABLE; k++)
    KernelHalfSpace(tension->kernel, support * k / WALL_TABLE, &data->wall[k], NULL);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void SetDefaults(void *owner)
{
  CahnHilliard *data = ((Tension)owner)->data;

  data->calibration = 3.959;
}

static PetscErrorCode Destroy(Tension tension)
{
  PetscFunctionBegin;
  PetscCall(CellMaskDestroy(&Data(tension)->near));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const char *const Densities[] = {"rest", "summed", NULL};

static const OptionRow options[] = {
  {"-tension_calibration", "kappa/(sigma H); 3.959 fits a flat surface, 5.30 a flat film at H = 2.5 h", "1", "(0, inf)",
   ROW_REAL, offsetof(CahnHilliard, calibration)},
  {"-tension_density",
   "Density in phi and in the force of the stress: summed is Eq. (4), rest keeps the packing's noise out of the force",
   NULL, NULL, ROW_WORD, offsetof(CahnHilliard, summed), .words = Densities},
  {.name = NULL},
};

const TensionModel TensionCahnHilliard = {
  .choice     = {TENSION_CAHN_HILLIARD, sizeof(CahnHilliard), options, SetDefaults, TabulateWall},
  .apply      = TensionApply_CahnHilliard,
  .destroy    = Destroy,
  .step_limit = STEP_LIMIT_PLAIN,
  .step_most  = STEP_LIMIT_PLAIN,
};
