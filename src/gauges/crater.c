/* Crown, crater and jet of an impact, as in figure 2 of Kuri et al. (2014). A particle fills a cube of one spacing, so
   the free surface lies half a spacing beyond the outermost particles.

   Depth of the crater: in each column of cells, the surface is the highest liquid below the lowest air that is open to
   the sky. Voids, overhanging crowns and spray thus do not count. The depth is the mean over the few lowest patches of
   two by two columns.

   Crown: its highest point is a finger's. Its mean over the azimuth, of the highest liquid of each sector, is what an
   axisymmetric computation has.

   Diameter of the crater: liquid fills a fraction of each ring around the axis, in the layer of one spacing below the
   level; a particle fills a square of its own size. The crater's wall is the first filled ring outside the first gap.

   tests/unit/test_gauges.c measures shapes cut out of a lattice. With the constants below, depth and diameter of a bowl
   are right to 0.6 spacings, even if particles are displaced by a quarter of a spacing. */
#include "gauges_impl.h"

#define LOWEST_3D  5   /* patches averaged for the depth; half as many for each mirror through the axis */
#define LOWEST_2D  3   /* the same in two dimensions */
#define SECTORS    8   /* around the axis: they sample the fraction of a ring that is in the box */
#define RING       0.5 /* width of a ring, spacings */
#define FILLED     0.5 /* fraction of liquid from which a ring is filled */
#define GAP        6   /* rings without liquid that make a crater: three spacings, wider than holes between particles */
#define MARGIN     4   /* rings on each side of the wall that average its roughness */
#define RINGS_MOST ((PetscInt)1 << 21) /* bounds the memory */
#define AZIMUTH    60  /* sectors in which the crown's mean takes the highest liquid: 1 mm of a crown of 20 mm */
#define SKIRT      2.0 /* jet radii: the level is measured farther from the axis than this */

/* The columns. Heights count from the level, along the last direction of the scene; NAN: nothing to measure. */
typedef enum {
  CROWN,    /* highest liquid connected with the pool, outside the jet radius */
  MEAN,     /* the same, mean over the sectors of the azimuth */
  DEPTH,    /* lowest free surface below the open sky, inside the crater radius; positive downwards */
  DIAMETER, /* twice the mean radius at which the crater's wall crosses the level; 0: no crater */
  JET,      /* highest liquid connected with the pool, inside the jet radius; negative in a crater */
  QUANTITIES
} Quantity;

/* Horizontal vector r (m) from the axis to the nearest periodic image of the point x. */
static inline void FromAxis(Gauges gauges, const Crater *crater, const PetscReal x[], PetscReal r[2])
{
  const Domain domain = gauges->cloud->domain;

  r[0] = r[1] = 0;
  for (PetscInt d = 0; d < domain->dim - 1; d++) {
    r[d] = x[d] - crater->axis[d];
    if (domain->face[d][0] == FACE_PERIODIC) {
      const PetscReal length = domain->upper[d] - domain->lower[d];

      r[d] -= length * PetscFloorReal(r[d] / length + 0.5);
    }
  }
}

/* A particle of the pool. Graded spacing: a particle larger than the finest spacing counts as the fine particles that
   it could be divided into. */
typedef struct {
  PetscReal radius, height;    /* m: distance from the axis; height of the highest fine particle */
  PetscReal count;             /* fine particles in one layer; of a ring, cross-section over V_0 */
  PetscReal size;              /* over the finest spacing */
  PetscInt  first[2], last[2]; /* columns that the particle covers */
  PetscInt  layer;             /* of its cell */
} PoolParticle;

/* The pool's n particles on this rank; free the array. */
static PetscErrorCode ListPool(Gauges gauges, const Crater *crater, const ParticleArrays *arrays,
                               const CraterGrid *grid, PetscInt *n, PoolParticle **pool)
{
  const Domain   domain = gauges->cloud->domain;
  const PetscInt up     = domain->dim - 1;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(arrays->n, pool));
  *n = 0;
  for (PetscInt a = 0; a < arrays->n; a++) {
    const PetscReal *x = arrays->real[FIELD_POSITION] + DIM * a, size = ParticleSize(domain, arrays, a);
    PetscReal        r[2];
    PetscInt         index[DIM], first[DIM], last[DIM], c;

    if (arrays->integer[INT_LAYER][a]) continue;
    c = CraterGridCell(grid, x, index);
    if (c < 0 || !(grid->cell[c] & CELL_POOL)) continue;
    FromAxis(gauges, crater, x, r);
    (void)CraterGridReach(grid, x, size, domain->spacing, first, last);
    (*pool)[(*n)++] = (PoolParticle){.radius = PetscSqrtReal(r[0] * r[0] + r[1] * r[1]),
                                     .height = x[up] + 0.5 * (size - 1) * domain->spacing,
                                     .count  = ParticleSumVolume(domain, arrays, a) / (size * domain->volume),
                                     .size   = size,
                                     .first  = {first[0], first[1]},
                                     .last   = {last[0], last[1]},
                                     .layer  = index[2]};
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the horizontal components of x (m) to the centre of a column. */
static void ColumnCentre(const CraterGrid *grid, PetscInt column, PetscReal x[DIM])
{
  const PetscInt along = column % grid->n[0], across = column / grid->n[0];

  x[grid->component[0]] = grid->lower[0] + (along - 0.5) * grid->size;
  x[grid->component[1]] = grid->lower[1] + (across - 0.5) * grid->size;
}

/* Finds the pool's surface below the open sky in each column: 'radius', its distance from the axis, 'top', the height
   of the highest particle below the lowest open air (-PETSC_MAX_REAL: none), and whether it is inside the crater
   radius. */
static PetscErrorCode FindSurface(Gauges gauges, const Crater *crater, CraterGrid *grid, PetscInt n,
                                  const PoolParticle pool[])
{
  PetscInt first, end;

  PetscFunctionBegin;
  SharedSlice(&grid->shared, grid->columns, &first, &end);
  for (PetscInt c = first; c < end; c++) {
    const PetscInt i = c % grid->n[0], j = c / grid->n[0];
    PetscReal      x[DIM] = {0, 0, 0}, r[2];

    ColumnCentre(grid, c, x);
    FromAxis(gauges, crater, x, r);
    grid->radius[c] = PetscSqrtReal(r[0] * r[0] + r[1] * r[1]);
    grid->top[c]    = -PETSC_MAX_REAL;
    grid->inside[c] =
      (PetscBool)(i > 0 && i < grid->n[0] - 1 && j > 0 && j < grid->n[1] - 1 && grid->radius[c] <= crater->radius);
  }
  PetscCall(SharedFence(&grid->shared));
  PetscCall(CraterGridSky(grid, gauges->cloud->domain->dim));
  for (PetscInt a = 0; a < n; a++)
    for (PetscInt j = pool[a].first[1]; j <= pool[a].last[1]; j++)
      for (PetscInt i = pool[a].first[0]; i <= pool[a].last[0]; i++) {
        const PetscInt c = j * grid->n[0] + i;

        if (pool[a].layer < grid->lowest[c]) SharedMax(&grid->top[c], pool[a].height);
      }
  PetscCall(SharedReduce(&grid->shared, grid->top, grid->columns, MPIU_REAL, MPIU_MAX));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Height (m) of the undisturbed free surface: the mean outside the impact. Without liquid there, the top of the pool's
   body. */
static PetscReal MeasureLevel(Gauges gauges, const Crater *crater, const CraterGrid *grid)
{
  const PetscReal half = 0.5 * gauges->cloud->domain->spacing;
  PetscReal       sum  = 0, lower[DIM], upper[DIM];
  PetscInt        n    = 0;

  for (PetscInt c = 0; c < grid->columns; c++) {
    if (!grid->inside[c] || grid->radius[c] < SKIRT * crater->jet_radius || grid->top[c] == -PETSC_MAX_REAL) continue;
    sum += grid->top[c] + half;
    n++;
  }
  if (n) return sum / n;
  GaugeBodyBounds(gauges, POOL, lower, upper);
  return upper[gauges->cloud->domain->dim - 1];
}

/* The height z (m) of a column's surface. A dry column has the bottom of the pool's body. False: outside the pool. */
static PetscBool ColumnSurface(Gauges gauges, const Crater *crater, const CraterGrid *grid, PetscInt column,
                               PetscReal *z)
{
  const PetscReal half   = 0.5 * gauges->cloud->domain->spacing;
  const PetscInt  up     = gauges->cloud->domain->dim - 1;
  PetscReal       x[DIM] = {0, 0, 0}, lower[DIM], upper[DIM];

  if (!grid->inside[column]) return PETSC_FALSE;
  *z = grid->top[column] + half;
  if (grid->top[column] > -PETSC_MAX_REAL) return PETSC_TRUE;
  ColumnCentre(grid, column, x);
  x[up] = gauges->level - half;
  GaugeBodyBounds(gauges, POOL, lower, upper);
  *z = lower[up];
  return BodyContains(SceneBody(gauges->cloud->scene, POOL), x);
}

/* Mean height (m) of the patch of two columns a side that begins with this column. False: not all columns lie in the
   pool. */
static PetscBool PatchSurface(Gauges gauges, const Crater *crater, const CraterGrid *grid, PetscInt column,
                              PetscReal *mean)
{
  const PetscInt columns = gauges->cloud->domain->dim == 2 ? 2 : 4;

  *mean = 0;
  for (PetscInt k = 0; k < columns; k++) {
    const PetscInt c = column + k % 2 + (k / 2) * grid->n[0];
    PetscReal      z;

    if (c >= grid->columns || !ColumnSurface(gauges, crater, grid, c, &z)) return PETSC_FALSE;
    *mean += z / columns;
  }
  return PETSC_TRUE;
}

static PetscReal CraterDepth(Gauges gauges, const Crater *crater, const CraterGrid *grid)
{
  const PetscInt most =
    PetscMax((gauges->cloud->domain->dim == 2 ? LOWEST_2D : LOWEST_3D) >> CraterMirrors(gauges, crater), 1);
  PetscReal lowest[LOWEST_3D + 1], sum = 0; /* ascending, one more than wanted */
  PetscInt  n = 0;

  for (PetscInt c = 0; c < grid->columns; c++) {
    PetscReal mean;
    PetscInt  k;

    if (!PatchSurface(gauges, crater, grid, c, &mean) || (n == most && mean >= lowest[n - 1])) continue;
    for (k = n; k > 0 && lowest[k - 1] > mean; k--) lowest[k] = lowest[k - 1];
    lowest[k] = mean;
    n         = PetscMin(n + 1, most);
  }
  for (PetscInt k = 0; k < n; k++) sum += lowest[k];
  return n ? gauges->level - sum / n : NAN;
}

/* Whether a sector lies in the box. Mirrors through the axis cut sectors off. */
static PetscBool SectorExists(Gauges gauges, const Crater *crater, PetscInt sector)
{
  const Domain    domain = gauges->cloud->domain;
  const PetscReal angle  = (sector + 0.5) * 2 * PETSC_PI / SECTORS;
  const PetscReal way[2] = {PetscCosReal(angle), PetscSinReal(angle)};

  for (PetscInt d = 0; d < domain->dim - 1; d++) {
    const PetscReal x = crater->axis[d] + domain->spacing * way[d];

    if (domain->face[d][0] != FACE_PERIODIC && (x < domain->lower[d] || x > domain->upper[d])) return PETSC_FALSE;
  }
  return domain->dim == 2 ? (PetscBool)(sector == 0 || sector == SECTORS / 2) : PETSC_TRUE;
}

/* Share of a ring around the axis that lies in the box. */
static PetscReal RingFraction(Gauges gauges, const Crater *crater)
{
  PetscInt sectors = 0, all = gauges->cloud->domain->dim == 2 ? 2 : SECTORS;

  for (PetscInt s = 0; s < SECTORS; s++) sectors += SectorExists(gauges, crater, s);
  return (PetscReal)sectors / all;
}

/* Area (m2; m in two dimensions) of the ring from 'inner' to 'outer' (m). */
static PetscReal RingArea(PetscInt dim, PetscReal inner, PetscReal outer)
{
  return dim == 2 ? 2 * (outer - inner) : PETSC_PI * (outer * outer - inner * inner);
}

/* Radius (m) of the crater's wall; liquid fills fraction[k] of ring k, whose width is w (m). The wall is the first
   filled ring outside a gap. The radius is that of a sharp wall with the same empty area in the rings around this ring.
   0: no gap; negative: no liquid. */
static PetscReal WallRadius(PetscInt dim, PetscInt rings, PetscReal w, const PetscReal fraction[])
{
  PetscInt  gap     = 0, wall, first, last;
  PetscReal missing = 0;

  for (wall = 0; wall < rings; wall++) {
    if (fraction[wall] >= FILLED && gap >= GAP) break;
    gap = fraction[wall] < FILLED ? gap + 1 : 0;
  }
  if (wall == rings) return gap == rings ? -1 : 0;
  first = PetscMax(wall - MARGIN, 0);
  last  = PetscMin(wall + MARGIN, rings - 1);
  for (PetscInt k = first; k <= last; k++) missing += (1 - fraction[k]) * RingArea(dim, k * w, (k + 1) * w);
  return dim == 2 ? first * w + missing / 2 : PetscSqrtReal(PetscSqr(first * w) + missing / PETSC_PI);
}

/* Twice the radius of the crater's wall in the layer of one spacing below the level. */
static PetscErrorCode CraterDiameter(Gauges gauges, const Crater *crater, PetscInt n, const PoolParticle pool[],
                                     PetscReal *diameter)
{
  const Domain    domain = gauges->cloud->domain;
  const PetscReal d0 = domain->spacing, w = RING * d0, reach = PetscMin(2 * crater->radius, RINGS_MOST * w);
  const PetscInt  rings = (PetscInt)PetscCeilReal(reach / w) + 1;
  const PetscReal full  = RingFraction(gauges, crater) * d0 / domain->volume; /* particles per area of a full ring */
  PetscReal      *fraction, radius;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(rings, &fraction));
  for (PetscInt a = 0; a < n; a++) {
    const PetscReal side = pool[a].size * d0, top = pool[a].height + 0.5 * d0 - gauges->level; /* m */
    const PetscReal inner = PetscMax(pool[a].radius - 0.5 * side, 0), outer = pool[a].radius + 0.5 * side;
    const PetscReal deep  = PetscMax(0, PetscMin(top, 0) - PetscMax(top - side, -d0)); /* of the layer */
    const PetscReal share = pool[a].count * deep / (d0 * (outer - inner));
    const PetscInt  last  = (PetscInt)PetscMin(outer / w, rings - 1);

    for (PetscInt k = (PetscInt)(inner / w); k <= last && share > 0; k++)
      fraction[k] += share * (PetscMin(outer, (k + 1) * w) - PetscMax(inner, k * w));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, fraction, (PetscMPIInt)rings, MPIU_REAL, MPI_SUM, gauges->comm));
  for (PetscInt k = 0; k < rings; k++) fraction[k] /= full * RingArea(domain->dim, k * w, (k + 1) * w);
  radius = WallRadius(domain->dim, rings, w, fraction);
  PetscCall(PetscFree(fraction));
  *diameter = radius >= 0 ? 2 * radius : NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Heights of crown and jet: the highest particles connected with the pool. */
static PetscErrorCode CrownAndJet(Gauges gauges, const Crater *crater, PetscReal values[])
{
  const Cloud      cloud = gauges->cloud;
  const PetscReal *x     = cloud->field[FIELD_POSITION];
  PetscReal        top[AZIMUTH + 1], sum = 0; /* of the sectors and the jet */
  PetscInt         sectors = 0;
  PetscBool       *connected;

  PetscFunctionBegin;
  for (PetscInt k = 0; k <= AZIMUTH; k++) top[k] = -PETSC_MAX_REAL;
  PetscCall(PetscMalloc1(cloud->n_fluid, &connected));
  PetscCall(ConnectedLargest(gauges, POOL, connected));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal r[2];
    PetscInt  k = AZIMUTH;

    if (!connected[a]) continue;
    FromAxis(gauges, crater, x + DIM * a, r);
    if (r[0] * r[0] + r[1] * r[1] > PetscSqr(crater->jet_radius))
      k = (PetscInt)(AZIMUTH * (0.5 + PetscAtan2Real(r[1], r[0]) / (2 * PETSC_PI))) % AZIMUTH;
    top[k] =
      PetscMax(top[k], x[DIM * a + cloud->domain->dim - 1] + 0.5 * (cloud->size[a] - 1) * cloud->domain->spacing);
  }
  PetscCall(PetscFree(connected));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, top, AZIMUTH + 1, MPIU_REAL, MPIU_MAX, gauges->comm));
  values[JET]   = HeightOverLevel(gauges, top[AZIMUTH]);
  values[CROWN] = HeightOverLevel(gauges, -PETSC_MAX_REAL);
  for (PetscInt k = 0; k < AZIMUTH; k++) {
    const PetscReal height = HeightOverLevel(gauges, top[k]);

    if (PetscIsNanReal(height)) continue;
    values[CROWN] = sectors++ ? PetscMax(values[CROWN], height) : height;
    sum += height;
  }
  values[MEAN] = sectors ? sum / sectors : values[CROWN];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Columns_Crater(Gauges gauges, const void *data, ColumnList *list)
{
  static const char *const names[QUANTITIES] = {"crown_height", "crown_mean", "crater_depth", "crater_diameter",
                                                "jet_height"};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < QUANTITIES && ((const Crater *)data)->wanted; k++)
    PetscCall(ColumnAdd(list, (Column){.unit = "m", .counts = COUNTS_VALUE}, "%s", names[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Measure_Crater(Gauges gauges, const void *data, PetscReal values[])
{
  const Crater  *crater = data;
  ParticleArrays arrays;
  CraterGrid     grid;
  PoolParticle  *pool;
  PetscInt       n = 0;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(gauges->cloud->particles, &arrays));
  PetscCall(CraterGridCreate(gauges, POOL, &arrays, &grid));
  PetscCall(ListPool(gauges, crater, &arrays, &grid, &n, &pool));
  PetscCall(ParticlesClose(gauges->cloud->particles, &arrays));
  PetscCall(FindSurface(gauges, crater, &grid, n, pool));
  if (PetscIsInfOrNanReal(gauges->level)) gauges->level = MeasureLevel(gauges, crater, &grid);
  values[DEPTH] = CraterDepth(gauges, crater, &grid);
  PetscCall(CraterDiameter(gauges, crater, n, pool, &values[DIAMETER]));
  PetscCall(PetscFree(pool));
  PetscCall(CraterGridDestroy(&grid));
  PetscCall(CrownAndJet(gauges, crater, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const GaugeKind GaugeCrater = {.bytes    = sizeof(Crater),
                               .options  = CraterOptions,
                               .defaults = CraterDefaults,
                               .more     = CraterMore,
                               .check    = CraterCheck,
                               .columns  = Columns_Crater,
                               .measure  = Measure_Crater};
