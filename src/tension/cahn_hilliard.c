/* Surface tension as the divergence of a capillary stress: Eqs. (5)-(7) of Kuri et al. See tension.h. The kernel has a
   thousand neighbours; sums are in single precision, relative to a point nearby. */
#include "tension_impl.h"

#define NEAR_CELLS     4         /* cells in the distance from the surface up to which the model is evaluated */
#define VOLUME_COLUMN  DIM       /* rho_0/rho_b: V_b over the volume at rest density */
#define DENSITY_COLUMN (DIM + 1) /* rho_0 of b: m_b over V */

/* Adds grad phi of the walls around x: each wall is a half-space full of liquid. */
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

/* x - c_b (m), and the kernel's F without its scale, of m <= CHUNK candidates from 'begin' on. */
static inline void Separations(Tension tension, PetscInt begin, PetscInt m, const float x[DIM], float *restrict dx,
                               float *restrict dy, float *restrict dz, float *restrict F)
{
  const float *restrict cx = tension->liquid->single + begin, *restrict cy = cx + tension->liquid->single_stride,
                        *restrict cz = cy + tension->liquid->single_stride;
  const float x0 = x[0], y0 = x[1], z0 = x[2];
  PetscReal   scale_w, scale_f, inverse_h2;
  float       s[CHUNK];

  KernelScales(tension->kernel, &scale_w, &scale_f, &inverse_h2);
  SIMD_LOOP()
  for (PetscInt k = 0; k < m; k++) {
    dx[k] = x0 - cx[k];
    dy[k] = y0 - cy[k];
    dz[k] = z0 - cz[k];
    s[k]  = (dx[k] * dx[k] + dy[k] * dy[k] + dz[k] * dz[k]) * (float)inverse_h2;
  }
  KernelSingle(tension->kernel, m, s, NULL, F);
}

/* Adds the sum of w_b grad W^H, without the kernel's scale, over a chunk of m candidates. F has w F. */
static inline void AddGradient(PetscReal scale, PetscInt m, const float dx[], const float dy[], const float dz[],
                               const float F[], PetscReal gradient[DIM])
{
  float gx = 0, gy = 0, gz = 0;

  SIMD_LOOP(reduction(+ : gx, gy, gz))
  for (PetscInt k = 0; k < m; k++) {
    gx += F[k] * dx[k];
    gy += F[k] * dy[k];
    gz += F[k] * dz[k];
  }
  gradient[0] += scale * gx;
  gradient[1] += scale * gy;
  gradient[2] += scale * gz;
}

/* The sum of grad W^H at x over m candidates; with -tension_density summed the sums of w grad W^H with w in
   VOLUME_COLUMN and in DENSITY_COLUMN. */
static void SumGradients(Tension tension, PetscInt m, const float x[DIM], PetscReal gradient[2][DIM])
{
  const PetscInt stride     = tension->liquid->single_stride;
  const float *restrict w   = tension->liquid->single + VOLUME_COLUMN * stride;
  const float *restrict rho = tension->liquid->single + DENSITY_COLUMN * stride;
  float     dx[CHUNK], dy[CHUNK], dz[CHUNK], F[CHUNK], weighted[CHUNK];
  PetscReal scale_w, scale_f, inverse_h2;

  KernelScales(tension->kernel, &scale_w, &scale_f, &inverse_h2);
  for (PetscInt d = 0; d < DIM; d++) gradient[0][d] = gradient[1][d] = 0;
  for (PetscInt begin = 0; begin < m; begin += CHUNK) {
    const PetscInt count = PetscMin(CHUNK, m - begin);

    Separations(tension, begin, count, x, dx, dy, dz, F);
    if (!tension->summed) {
      AddGradient(scale_f, count, dx, dy, dz, F, gradient[0]);
      continue;
    }
    SIMD_LOOP()
    for (PetscInt k = 0; k < count; k++) weighted[k] = F[k] * w[begin + k];
    AddGradient(scale_f, count, dx, dy, dz, weighted, gradient[0]);
    SIMD_LOOP()
    for (PetscInt k = 0; k < count; k++) weighted[k] = F[k] * rho[begin + k];
    AddGradient(scale_f, count, dx, dy, dz, weighted, gradient[1]);
  }
}

/* The sum of S_b grad W^H at x over m candidates, S_b in the columns 3 to 8. */
static void SumForce(Tension tension, PetscInt m, const float x[DIM], PetscReal force[DIM])
{
  const PetscInt stride    = tension->liquid->single_stride;
  const float *restrict xx = tension->liquid->single + DIM * stride, *restrict yy = xx + stride,
                        *restrict zz = yy + stride, *restrict xy = zz + stride, *restrict xz = xy + stride,
                        *restrict yz = xz + stride;
  float     dx[CHUNK], dy[CHUNK], dz[CHUNK], F[CHUNK];
  PetscReal scale_w, scale_f, inverse_h2;

  KernelScales(tension->kernel, &scale_w, &scale_f, &inverse_h2);
  force[0] = force[1] = force[2] = 0;
  for (PetscInt begin = 0; begin < m; begin += CHUNK) {
    const PetscInt count = PetscMin(CHUNK, m - begin);
    float          fx = 0, fy = 0, fz = 0;

    Separations(tension, begin, count, x, dx, dy, dz, F);
    SIMD_LOOP(reduction(+ : fx, fy, fz))
    for (PetscInt k = 0; k < count; k++) {
      const PetscInt b  = begin + k;
      const float    gx = F[k] * dx[k], gy = F[k] * dy[k], gz = F[k] * dz[k];

      fx += xx[b] * gx + xy[b] * gy + xz[b] * gz;
      fy += xy[b] * gx + yy[b] * gy + yz[b] * gz;
      fz += xz[b] * gx + yz[b] * gy + zz[b] * gz;
    }
    force[0] += scale_f * fx;
    force[1] += scale_f * fy;
    force[2] += scale_f * fz;
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

/* Whether the model is evaluated for particle a at x. */
static inline PetscBool Evaluated(Tension tension, Cloud cloud, PetscInt a, const PetscReal x[DIM])
{
  return (PetscBool)(a < cloud->n_owned && CellMaskHas(&tension->near, x));
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

/* Adds the part of Eq. (1) with the particle's own stress, S_a/rho_a^2 sum m_b grad W^H, and turns S_a into S_a
   rho_0/rho_a^2, the form in the other particles' sums. gradient: of the density over V_0, without walls. */
static void AddOwnForce(Tension tension, Cloud cloud, PetscInt a, const PetscReal x[DIM], PetscReal gradient[DIM],
                        PetscReal S[6])
{
  const PetscReal V = cloud->domain->volume, rest = cloud->rest_density[a], rho = cloud->field[FIELD_DENSITY][a];
  PetscReal       walls[DIM] = {0}, force[DIM];

  AddWalls(tension, cloud->domain, x, walls);
  for (PetscInt d = 0; d < DIM; d++) gradient[d] = V * gradient[d] + rest * walls[d];
  TensorApply(S, gradient[0], gradient[1], gradient[2], force);
  for (PetscInt d = 0; d < DIM; d++) cloud->field[FIELD_ACCELERATION][DIM * a + d] += force[d] / (rho * rho);
  for (PetscInt k = 0; k < 6; k++) S[k] *= rest / (rho * rho);
}

/* Finds grad phi, Eq. (6), and the stress ([n_owned][6]) of the particles near the surface; with -tension_density
   summed the stress times rho_0/rho^2. */
static PetscErrorCode FindStress(Tension tension, Cloud cloud, PetscReal stress[])
{
  SortedCells    *liquid = tension->liquid;
  const PetscReal V = cloud->domain->volume, H = KernelSmoothingLength(tension->kernel);
  const PetscBool summed      = tension->summed;
  PetscReal       origin[DIM] = {0};
  PetscInt        cell = -1, m = 0;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < liquid->count; p++) {
    const PetscInt a = liquid->index[p];
    PetscReal      x[DIM], gradient[2][DIM];
    float          place[DIM]; /* x, relative to the origin of the candidates */

    SortedPosition(liquid, p, x);
    if (!Evaluated(tension, cloud, a, x)) continue;
    if (SortedCell(liquid, p) != cell) {
      cell = SortedCell(liquid, p);
      PetscCall(PetscArraycpy(origin, x, DIM));
      PetscCall(SortedCellsCollectSingle(liquid, cell, COLUMNS(0, summed ? DIM + 2 : DIM), origin, &m));
    }
    for (PetscInt d = 0; d < DIM; d++) place[d] = (float)(x[d] - origin[d]);
    SumGradients(tension, m, place, gradient);
    for (PetscInt d = 0; d < DIM; d++) gradient[0][d] *= V;
    AddWalls(tension, cloud->domain, x, gradient[0]);
    Stress(tension->calibration * H * BodyMaterial(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]))->tension,
           gradient[0], stress + 6 * a);
    if (summed) AddOwnForce(tension, cloud, a, x, gradient[1], stress + 6 * a);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds 1/rho_a sum_b V_b S_b grad W^H_ab to the acceleration. With one rest density this equals the symmetric form of
   Eq. (1), because S_a . grad phi_a = 0. With summed densities it adds the rest of that form, without the part of
   AddOwnForce. */
static PetscErrorCode AddForce(Tension tension, Cloud cloud)
{
  SortedCells    *liquid      = tension->liquid;
  const PetscReal V           = cloud->domain->volume;
  PetscReal       origin[DIM] = {0};
  PetscInt        cell = -1, m = 0;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < liquid->count; p++) {
    const PetscInt  a      = liquid->index[p];
    const PetscReal factor = tension->summed ? V : V / cloud->rest_density[a];
    PetscReal       x[DIM], force[DIM];
    float           place[DIM];

    SortedPosition(liquid, p, x);
    if (!Evaluated(tension, cloud, a, x)) continue;
    if (SortedCell(liquid, p) != cell) {
      cell = SortedCell(liquid, p);
      PetscCall(PetscArraycpy(origin, x, DIM));
      PetscCall(SortedCellsCollectSingle(liquid, cell, COLUMNS(0, DIM + 6), origin, &m));
    }
    for (PetscInt d = 0; d < DIM; d++) place[d] = (float)(x[d] - origin[d]);
    SumForce(tension, m, place, force);
    for (PetscInt d = 0; d < DIM; d++) cloud->field[FIELD_ACCELERATION][DIM * a + d] += factor * force[d];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marks where the model is evaluated, near the surface particles of all ranks. A rank knows the surface particles
   within the kernel's support of its own, and asks other ranks if the distance is larger. */
static PetscErrorCode MarkNear(Tension tension, Cloud cloud)
{
  const Domain    domain  = cloud->domain;
  const PetscReal support = KernelSupport(tension->kernel), radius = tension->band * support + tension->spacing;
  PetscReal       origin[DIM];
  PetscInt       *of, count;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < DIM; d++) origin[d] = domain->lower[d] - (support + cloud->slack);
  PetscCall(PetscMalloc1(cloud->n_total, &of));
  PetscCall(SurfaceList(tension, cloud, NULL, of, &count));
  PetscCall(CellMaskDestroy(&tension->near));
  PetscCall(CellMaskCreate(radius > support ? domain->comm : PETSC_COMM_SELF, domain->dim, origin, radius / NEAR_CELLS,
                           radius, count, of, cloud->field[FIELD_POSITION], &tension->near));
  PetscCall(PetscFree(of));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CahnHilliardStress(Tension tension, Cloud cloud, PetscReal stress[])
{
  PetscFunctionBegin;
  PetscCall(LiquidSort(tension, cloud, 0, NULL));
  PetscCall(MarkNear(tension, cloud));
  PetscCall(PetscArrayzero(stress, 6 * cloud->n_owned));
  if (tension->summed) PetscCall(LoadDensities(tension, cloud));
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
  SortedCellsLoad(tension->liquid, DIM, 6, stress);
  PetscCall(CloudRestoreWork(cloud, &stress));
  PetscCall(AddForce(tension, cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tabulates w1(s) of W^H, for the part of phi from a wall. */
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
  const char *const densities[] = {"rest", "summed"};
  PetscInt          density     = tension->summed;

  PetscFunctionBegin;
  PetscCall(OptionReal("-tension_calibration",
                       "kappa/(sigma H) (1); 3.959 fits a flat surface, 5.30 a flat film at H = 2.5 h", "(0, inf)",
                       &tension->calibration));
  PetscCall(OptionReal("-tension_band", "distance from the surface within which tension is evaluated, over 2H (1)",
                       "(0, 2]", &tension->band));
  PetscCall(PetscOptionsEList(
    "-tension_density",
    "density in phi and in the force of the stress: summed is Eq. (4), rest keeps the packing's noise out of the force",
    "TensionSetFromOptions", densities, 2, densities[density], &density, NULL));
  tension->summed = (PetscBool)density;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TensionCreate_CahnHilliard(Tension tension)
{
  PetscFunctionBegin;
  tension->setfromoptions = SetFromOptions;
  tension->setup          = TabulateWall;
  tension->apply          = TensionApply_CahnHilliard;
  PetscFunctionReturn(PETSC_SUCCESS);
}
