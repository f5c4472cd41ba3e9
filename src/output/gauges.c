/* Gauges: what the paper's figure 2 plots, measured on the particles. A particle stands for a cube of one spacing, so a
   surface lies half a spacing beyond the outermost particles. Heights are relative to the level of the undisturbed
   surface.

   Crater depth: columns of cells; in each the highest liquid below the lowest air open to the sky, so that neither
   voids nor overhanging crowns nor spray count; means over patches of two by two columns; of these the mean of the
   lowest few. Crater diameter: in the layer just below the level, the share of rings around the axis that liquid fills;
   going outwards, where it begins again behind the first gap. */
#include "output_impl.h"

#define LOWEST_3D 5 /* patches averaged for the depth; half as many for each mirror through the axis */
#define LOWEST_2D 3
#define SECTORS   8   /* around the axis */
#define RING      0.5 /* width of a ring, in spacings */
#define GAP       6   /* rings without liquid that make a crater */
#define MARGIN    4   /* rings a wall may be rough by, to each side */
#define FILLED    0.5 /* share of a ring that makes it liquid */
#define SKIRT     2.0 /* the undisturbed level is measured beyond this many jet radii */

/* Horizontal vector from the axis to the point x, m; through periodic faces by the shortest way. */
static inline void FromAxis(Output output, const PetscReal x[], PetscReal r[2])
{
  const Domain domain = output->cloud->domain;

  r[0] = r[1] = 0;
  for (PetscInt d = 0; d < domain->dim - 1; d++) {
    r[d] = x[d] - output->gauge.axis[d];
    if (domain->face[d][0] == FACE_PERIODIC) {
      const PetscReal length = domain->upper[d] - domain->lower[d];

      r[d] -= length * PetscFloorReal(r[d] / length + 0.5);
    }
  }
}

/* Fluid of the pool: [n] the horizontal distance from the axis, height (m), direction, column and layer of its cell. */
typedef struct {
  PetscInt   n;
  PetscReal *radius, *height, *x, *y; /* x, y: from the axis */
  PetscInt  *column, *layer;
} PoolList;

static PetscErrorCode PoolListCreate(Output output, const ParticleArrays *arrays, const GaugeGrid *grid, PoolList *list)
{
  const PetscInt up = output->cloud->domain->dim - 1, n = arrays->n;

  PetscFunctionBegin;
  PetscCall(
    PetscMalloc6(n, &list->radius, n, &list->height, n, &list->x, n, &list->y, n, &list->column, n, &list->layer));
  list->n = 0;
  for (PetscInt a = 0; a < n; a++) {
    const PetscReal *x = arrays->real[FIELD_POSITION] + DIM * a;
    PetscReal        r[2];
    PetscInt         index[DIM], c;

    if (arrays->integer[INT_LAYER][a]) continue;
    c = GaugeGridCell(grid, x, index);
    if (c < 0 || !(grid->cell[c] & CELL_POOL)) continue;
    FromAxis(output, x, r);
    list->radius[list->n] = PetscSqrtReal(r[0] * r[0] + r[1] * r[1]);
    list->height[list->n] = x[up];
    list->x[list->n]      = r[0];
    list->y[list->n]      = r[1];
    list->column[list->n] = index[1] * grid->n[0] + index[0];
    list->layer[list->n]  = index[2];
    list->n++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PoolListDestroy(PoolList *list)
{
  PetscFunctionBegin;
  PetscCall(PetscFree6(list->radius, list->height, list->x, list->y, list->column, list->layer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Centre x (m) of a column in the components of the position; the vertical one is untouched. */
static void ColumnCentre(const GaugeGrid *grid, PetscInt column, PetscReal x[DIM])
{
  const PetscInt along = column % grid->n[0], across = column / grid->n[0];

  x[grid->component[0]] = grid->lower[0] + (along - 0.5) * grid->size;
  x[grid->component[1]] = grid->lower[1] + (across - 0.5) * grid->size;
}

/* The surface of the pool that the sky sees: for each column its distance from the axis (m), whether it is inside the
   crater radius, and the height (m) of its highest particle below the lowest open air; -PETSC_MAX_REAL where there is
   none. */
typedef struct {
  PetscReal *radius, *top;
  PetscBool *inside;
} SkyMap;

static PetscErrorCode SkyMapCreate(Output output, GaugeGrid *grid, const PoolList *list, SkyMap *map)
{
  const PetscInt dim = output->cloud->domain->dim;
  PetscInt      *lowest;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(grid->columns, &map->radius, grid->columns, &map->top, grid->columns, &map->inside));
  PetscCall(PetscMalloc1(grid->columns, &lowest));
  for (PetscInt c = 0; c < grid->columns; c++) {
    const PetscInt i = c % grid->n[0], j = c / grid->n[0];
    PetscReal      x[DIM] = {0, 0, 0}, r[2];

    ColumnCentre(grid, c, x);
    FromAxis(output, x, r);
    map->radius[c] = PetscSqrtReal(r[0] * r[0] + r[1] * r[1]);
    map->top[c]    = -PETSC_MAX_REAL;
    map->inside[c] = (PetscBool)(i > 0 && i < grid->n[0] - 1 && j > 0 && j < grid->n[1] - 1 &&
                                 map->radius[c] <= output->gauge.crater_radius);
  }
  GaugeGridSky(grid, dim, map->inside, lowest);
  for (PetscInt a = 0; a < list->n; a++) {
    const PetscInt c = list->column[a];

    if (list->layer[a] < lowest[c]) map->top[c] = PetscMax(map->top[c], list->height[a]);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, map->top, (PetscMPIInt)grid->columns, MPIU_REAL, MPIU_MAX, output->comm));
  PetscCall(PetscFree(lowest));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SkyMapDestroy(SkyMap *map)
{
  PetscFunctionBegin;
  PetscCall(PetscFree3(map->radius, map->top, map->inside));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The mean surface around the place of the impact; where nothing is there, the top of the pool's body. m */
static PetscReal MeasureLevel(Output output, const GaugeGrid *grid, const SkyMap *map)
{
  const PetscReal half = 0.5 * output->cloud->domain->spacing;
  PetscReal       sum  = 0, lower[DIM], upper[DIM];
  PetscInt        n    = 0;

  for (PetscInt c = 0; c < grid->columns; c++) {
    if (!map->inside[c] || map->radius[c] < SKIRT * output->gauge.jet_radius || map->top[c] == -PETSC_MAX_REAL)
      continue;
    sum += map->top[c] + half;
    n++;
  }
  if (n) return sum / n;
  GaugeBodyBounds(output, output->gauge.pool, lower, upper);
  return upper[output->cloud->domain->dim - 1];
}

/* The surface of a column, m; the bottom of the pool's body where it has run dry. False outside the pool. */
static PetscBool ColumnSurface(Output output, const GaugeGrid *grid, const SkyMap *map, PetscInt column, PetscReal *z)
{
  const PetscReal half   = 0.5 * output->cloud->domain->spacing;
  const PetscInt  up     = output->cloud->domain->dim - 1;
  PetscReal       x[DIM] = {0, 0, 0}, lower[DIM], upper[DIM];

  if (!map->inside[column]) return PETSC_FALSE;
  *z = map->top[column] + half;
  if (map->top[column] > -PETSC_MAX_REAL) return PETSC_TRUE;
  ColumnCentre(grid, column, x);
  x[up] = output->gauge.level - half;
  GaugeBodyBounds(output, output->gauge.pool, lower, upper);
  *z = lower[up];
  return BodyContains(SceneBody(output->cloud->scene, output->gauge.pool), x);
}

static PetscReal CraterDepth(Output output, const GaugeGrid *grid, const SkyMap *map)
{
  const PetscInt dim = output->cloud->domain->dim, wide = dim == 2 ? 1 : 2;
  const PetscInt most = PetscMax((dim == 2 ? LOWEST_2D : LOWEST_3D) >> GaugeMirrors(output), 1);
  PetscReal      lowest[LOWEST_3D], sum = 0;
  PetscInt       n = 0;

  for (PetscInt c = 0; c < grid->columns; c++) {
    PetscReal mean  = 0, z;
    PetscBool whole = PETSC_TRUE;

    for (PetscInt k = 0; k < 2 * wide && whole; k++) {
      const PetscInt column = c + k % 2 + (k / 2) * grid->n[0];

      whole = (PetscBool)(column < grid->columns && ColumnSurface(output, grid, map, column, &z));
      if (whole) mean += z / (2 * wide);
    }
    if (!whole || (n == most && mean >= lowest[n - 1])) continue;
    if (n < most) n++;
    for (PetscInt k = n - 1; k >= 0; k--) { /* keeps the list sorted */
      if (k == 0 || lowest[k - 1] <= mean) {
        lowest[k] = mean;
        break;
      }
      lowest[k] = lowest[k - 1];
    }
  }
  for (PetscInt k = 0; k < n; k++) sum += lowest[k];
  return n ? output->gauge.level - sum / n : NAN;
}

/* Whether a sector lies in the box: a mirror scene has only some. */
static PetscBool SectorExists(Output output, PetscInt sector)
{
  const Domain    domain = output->cloud->domain;
  const PetscReal angle  = (sector + 0.5) * 2 * PETSC_PI / SECTORS;
  const PetscReal way[2] = {PetscCosReal(angle), PetscSinReal(angle)};

  for (PetscInt d = 0; d < domain->dim - 1; d++) {
    const PetscReal x = output->gauge.axis[d] + domain->spacing * way[d];

    if (domain->face[d][0] != FACE_PERIODIC && (x < domain->lower[d] || x > domain->upper[d])) return PETSC_FALSE;
  }
  return domain->dim == 2 ? (PetscBool)(sector == 0 || sector == SECTORS / 2) : PETSC_TRUE;
}

/* Share of a ring around the axis that lies in the box. */
static PetscReal RingShare(Output output)
{
  PetscInt sectors = 0, all = output->cloud->domain->dim == 2 ? 2 : SECTORS;

  for (PetscInt s = 0; s < SECTORS; s++) sectors += SectorExists(output, s);
  return (PetscReal)sectors / all;
}

/* Area (m2; m in two dimensions) of the ring from 'inner' to 'outer' (m). */
static PetscReal RingArea(PetscInt dim, PetscReal inner, PetscReal outer)
{
  return dim == 2 ? 2 * (outer - inner) : PETSC_PI * (outer * outer - inner * inner);
}

/* Radius (m) at which the liquid begins, from the filled share of rings of width w: the first ring that is filled
   behind a gap; the shares around it give the place within: what is missing there is as if it were missing at one
   radius. 0 without a gap, negative without liquid. */
static PetscReal WallRadius(PetscInt dim, PetscInt rings, PetscReal w, const PetscReal share[])
{
  PetscInt  gap     = 0, wall, first, last;
  PetscReal missing = 0;

  for (wall = 0; wall < rings; wall++) {
    if (share[wall] >= FILLED && gap >= GAP) break;
    gap = share[wall] < FILLED ? gap + 1 : 0;
  }
  if (wall == rings) return gap == rings ? -1 : 0;
  first = PetscMax(wall - MARGIN, 0);
  last  = PetscMin(wall + MARGIN, rings - 1);
  for (PetscInt k = first; k <= last; k++) missing += (1 - share[k]) * RingArea(dim, k * w, (k + 1) * w);
  return dim == 2 ? first * w + missing / 2 : PetscSqrtReal(PetscSqr(first * w) + missing / PETSC_PI);
}

/* Twice the radius of the crater's wall at the level, from the share of rings that liquid fills in the layer of one
 * spacing below it. */
static PetscErrorCode CraterDiameter(Output output, const PoolList *list, PetscReal *diameter)
{
  const Domain    domain = output->cloud->domain;
  const PetscReal d0 = domain->spacing, w = RING * d0, reach = PetscMin(2 * output->gauge.crater_radius, 1e6 * d0);
  const PetscInt  rings = (PetscInt)PetscCeilReal(reach / w) + 1;
  const PetscReal full  = RingShare(output) * d0 / domain->volume; /* particles an area of a full ring */
  PetscReal      *share, radius;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(rings, &share));
  for (PetscInt a = 0; a < list->n; a++) {
    const PetscInt ring = list->radius[a] < rings * w ? (PetscInt)(list->radius[a] / w) : rings;

    if (ring < rings && PetscAbsReal(list->height[a] - output->gauge.level + 0.5 * d0) <= 0.5 * d0) share[ring] += 1;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, share, (PetscMPIInt)rings, MPIU_REAL, MPI_SUM, output->comm));
  for (PetscInt k = 0; k < rings; k++) share[k] /= full * RingArea(domain->dim, k * w, (k + 1) * w);
  radius = WallRadius(domain->dim, rings, w, share);
  PetscCall(PetscFree(share));
  *diameter = radius >= 0 ? 2 * radius : NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Energies, volume, and the highest liquid of all. */
static PetscErrorCode Totals(Output output, const ParticleArrays *arrays, GaugeValues *values)
{
  const Domain domain = output->cloud->domain;
  const Scene  scene  = output->cloud->scene;
  PetscReal    sum[3] = {0, 0, 0}, highest = -PETSC_MAX_REAL;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < arrays->n; a++) {
    const PetscReal *x = arrays->real[FIELD_POSITION] + DIM * a, *v = arrays->real[FIELD_VELOCITY] + DIM * a;
    PetscReal        mass;

    if (arrays->integer[INT_LAYER][a]) continue;
    mass = domain->volume * BodyMaterial(SceneBody(scene, arrays->integer[INT_BODY][a]))->density;
    sum[0] += 0.5 * mass * Dot(v, v);
    sum[1] += mass * SceneForcePotential(scene, x);
    sum[2] += 1;
    highest = PetscMax(highest, x[domain->dim - 1]);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 3, MPIU_REAL, MPIU_SUM, output->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &highest, 1, MPIU_REAL, MPIU_MAX, output->comm));
  values->multiplicity     = output->gauge.multiplicity;
  values->kinetic_energy   = output->gauge.multiplicity * sum[0];
  values->potential_energy = output->gauge.multiplicity * sum[1];
  values->volume           = output->gauge.multiplicity * sum[2] * domain->volume;
  values->particles        = (PetscInt)sum[2];
  values->highest          = highest > -PETSC_MAX_REAL ? highest + 0.5 * domain->spacing - output->gauge.level : NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Heights of crown and jet: the highest particles that hang together with the pool. */
static PetscErrorCode Heights(Output output, GaugeValues *values)
{
  const Cloud      cloud  = output->cloud;
  const PetscReal  half   = 0.5 * cloud->domain->spacing;
  const PetscReal *x      = cloud->field[FIELD_POSITION];
  PetscReal        top[2] = {-PETSC_MAX_REAL, -PETSC_MAX_REAL}; /* crown, jet */
  PetscBool       *connected;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(cloud->n_fluid, &connected));
  PetscCall(GaugeConnected(output, output->gauge.connection * cloud->domain->spacing, connected));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal r[2];
    PetscInt  jet;

    if (!connected[a]) continue;
    FromAxis(output, x + DIM * a, r);
    jet      = r[0] * r[0] + r[1] * r[1] <= PetscSqr(output->gauge.jet_radius);
    top[jet] = PetscMax(top[jet], x[DIM * a + cloud->domain->dim - 1]);
  }
  PetscCall(PetscFree(connected));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, top, 2, MPIU_REAL, MPIU_MAX, output->comm));
  values->crown_height = top[0] > -PETSC_MAX_REAL ? top[0] + half - output->gauge.level : NAN;
  values->jet_height   = top[1] > -PETSC_MAX_REAL ? top[1] + half - output->gauge.level : NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputGauges(Output output, GaugeValues *values)
{
  ParticleArrays arrays;
  GaugeGrid      grid;
  PoolList       list;
  SkyMap         map;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_GAUGES), 0, 0, 0, 0));
  PetscCall(ParticlesOpen(output->cloud->particles, &arrays));
  PetscCall(GaugeGridCreate(output, &arrays, &grid));
  GaugeGridPool(&grid);
  PetscCall(PoolListCreate(output, &arrays, &grid, &list));
  PetscCall(SkyMapCreate(output, &grid, &list, &map));
  if (PetscIsInfOrNanReal(output->gauge.level)) output->gauge.level = MeasureLevel(output, &grid, &map);
  values->crater_depth = CraterDepth(output, &grid, &map);
  PetscCall(CraterDiameter(output, &list, &values->crater_diameter));
  PetscCall(Totals(output, &arrays, values));
  PetscCall(SkyMapDestroy(&map));
  PetscCall(PoolListDestroy(&list));
  PetscCall(GaugeGridDestroy(&grid));
  PetscCall(ParticlesClose(output->cloud->particles, &arrays));
  PetscCall(Heights(output, values));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_GAUGES), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
