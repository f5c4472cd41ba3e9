/* What liquid wets of the walls of the box and of solids, and the contact angle that its surface shows: columns of the
   series.

   Wetted area: the share of the space in front of a point p of the wall that liquid fills is
   c(p) = sum V W over the fluid/(1 - sum V W over walls and solids), W the kernel with the support COVER. The wall is
   wet where c half a spacing above it exceeds the c above the edge of a wedge of the contact angle. Each particle near
   the wall samples points around its foot; at a point particles count by their part of sum V W. So the parts of a point
   add up to 1 whatever the distance of the particles, and ghosts make the sum independent of the number of ranks.

   Contact angle: on a sphere or circle that a plane cuts, the cosine of the angle between surface and plane is linear
   in the height over the plane. A line is fitted to the cosines of particles at the surface from LOW to HIGH and near
   the edge of the wetted area; its value at height 0 is the angle. Below LOW the kernel's sums see the wall. */
#include "../neighbors/sorted_cells.h"
#include "lines.h"

#define COVER  0.56 /* of the kernel's support: that of W; ghosts are known within COVER + PART = 1 */
#define PART   0.44 /* of the kernel's support: points lie within this of a particle */
#define POINTS 4    /* around a foot, along each axis */
#define PITCH  0.5  /* spacings between points: on a lattice those of all particles coincide */
#define RAISED 0.5  /* spacings: height of points */
/* c half a spacing above the line of a wedge of the angle t is about 1/2 - TILT cos t, t within 60 and 120 degrees */
#define TILT    0.48
#define RAMP    0.2  /* c rises by twice this across the edge of what is wet */
#define ONTO    0.3  /* spacings: a point this far from a solid is not on its surface */
#define LOW     1.0  /* spacings */
#define HIGH    10.  /* spacings */
#define AROUND  15.  /* spacings between the edge of the wetted area and a particle that shows the angle */
#define SURFACE 0.1  /* |sum V grad W| times the spacing; below this a particle is inside the liquid */
#define SWAYS   8    /* directions in which the spread of the liquid is measured, over half a turn */
#define SUMS    11   /* of a receiver: area, its first and second moments, sums of the fit */
#define FIT     6    /* the first sum of the fit */
#define LEAST   1e-9 /* spacings^2: variance of heights that makes a fit */

typedef struct {
  Gauges         gauges;
  SortedCells    cells;
  PetscReal     *sum;   /* [receivers][SUMS] */
  PetscReal     *wedge; /* [receivers] share of the wedge at the contact line, 1 */
  PetscReal     *edge;  /* [edges][1 + DIM] receiver, foot (m), of the particles at an edge, of all ranks */
  PetscInt       edges;
  PetscSegBuffer own; /* of this rank */
} Cover;

/* The foot (m) of a point x on a receiver and the normal out of the wall there. Returns the distance (m);
   PETSC_MAX_REAL: another solid is nearer, or no normal. */
static PetscReal Foot(Gauges gauges, PetscInt receiver, const PetscReal x[DIM], PetscReal foot[DIM],
                      PetscReal normal[DIM])
{
  const Domain   domain = GaugesCloud(gauges)->domain;
  PetscInt       d = 0, side = 0, nearest = 0;
  const PetscInt faces = GaugeWallFace(domain, receiver, &d, &side);
  PetscReal      s;

  for (PetscInt k = 0; k < DIM; k++) normal[k] = 0;
  if (receiver < faces) {
    normal[d] = side ? -1 : 1;
    s         = side ? domain->upper[d] - x[d] : x[d] - domain->lower[d];
  } else {
    s = SceneSolidDistance(GaugesCloud(gauges)->scene, x, &nearest);
    if (nearest != receiver - faces) return PETSC_MAX_REAL;
    SceneSolidNormal(GaugesCloud(gauges)->scene, x, normal);
    if (Norm(normal) == 0) return PETSC_MAX_REAL;
  }
  for (PetscInt k = 0; k < DIM; k++) foot[k] = x[k] - s * normal[k];
  return s;
}

/* Whether a point p (m) lies on the part of a receiver that liquid can wet. */
static PetscBool OnReceiver(Gauges gauges, PetscInt receiver, const PetscReal p[DIM])
{
  const Domain    domain  = GaugesCloud(gauges)->domain;
  PetscInt        nearest = 0, axis = -1, side = 0;
  const PetscInt  faces = GaugeWallFace(domain, receiver, &axis, &side);
  const PetscReal s     = SceneSolidDistance(GaugesCloud(gauges)->scene, p, &nearest) / domain->spacing;

  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscBool above = (PetscBool)(p[d] > domain->upper[d]);
    const FaceType  face  = domain->face[d][above];

    if ((above || p[d] < domain->lower[d]) && d != axis && face != FACE_PERIODIC && face != FACE_SYMMETRY)
      return PETSC_FALSE;
  }
  return (PetscBool)(receiver < faces ? s >= -ONTO : nearest == receiver - faces && PetscAbsReal(s) <= ONTO);
}

/* The share c of the space in front of p (m) that liquid fills; part: that of particle a in the liquid near p. */
static PetscReal Share(Cover *cover, const PetscReal p[DIM], PetscInt a, PetscReal *part)
{
  const Cloud      cloud = GaugesCloud(cover->gauges);
  SortedCells     *cells = &cover->cells;
  const PetscReal *x = cells->sorted, *y = x + cells->count, *z = y + cells->count;
  const PetscReal  support = KernelSupport(cloud->kernel);
  PetscReal        liquid = 0, solid = 0, own = 0, all = 0;

  SortedCellsLines(cells, p, cells->support);
  for (PetscInt l = 0; l < cells->lines; l++)
    for (PetscInt k = cells->line[l].begin; k < cells->line[l].begin + cells->line[l].length; k++) {
      const PetscInt  b      = cells->index[k];
      const PetscReal r[DIM] = {x[k] - p[0], y[k] - p[1], z[k] - p[2]}, scale = 1 / (COVER * cloud->size[b]),
                      r2 = Dot(r, r) * PetscSqr(scale), near = 1 - r2 * PetscSqr(COVER / (PART * support));
      PetscReal W;

      if (r2 >= PetscSqr(support)) continue;
      KernelEvaluate(cloud->kernel, 1, &r2, &W, NULL);
      W *= cloud->domain->volume * cloud->weight[b] * PetscPowRealInt(scale, (int)cloud->domain->dim);
      *(cloud->integer[INT_LAYER][b] ? &solid : &liquid) += W;
      if (cloud->integer[INT_LAYER][b] || near <= 0) continue;
      all += near * near;
      if (b == a) own = near * near;
    }
  *part = own > 0 ? own / all : 0;
  return liquid / PetscMax(1 - solid, 0.25);
}

/* The components of positions along a face with the normal d. */
static inline void Along(PetscInt d, PetscInt along[2])
{
  along[0] = d == 0 ? 1 : 0;
  along[1] = d == 2 ? 1 : 2;
}

/* Two unit vectors at right angles to a normal; in two dimensions the first is in the plane. */
static void Tangents(PetscInt dim, const PetscReal normal[DIM], PetscReal first[DIM], PetscReal second[DIM])
{
  PetscReal axis[DIM] = {0, 0, 0}, length;
  PetscInt  least     = DIM - 1;

  for (PetscInt d = 0; d < DIM && dim == 3; d++)
    if (PetscAbsReal(normal[d]) < PetscAbsReal(normal[least])) least = d;
  axis[least] = 1;
  Cross(axis, normal, first);
  length = Norm(first);
  for (PetscInt d = 0; d < DIM; d++) first[d] /= length;
  Cross(normal, first, second);
}

/* Adds to the sums of a receiver the wetted area around the foot of particle a. Returns whether an edge is there. */
static PetscBool AddArea(Cover *cover, PetscInt receiver, PetscInt a, const PetscReal foot[DIM],
                         const PetscReal normal[DIM])
{
  const Cloud     cloud = GaugesCloud(cover->gauges);
  const PetscInt  dim   = cloud->domain->dim;
  const PetscReal pitch = PITCH * cloud->domain->spacing * cloud->size[a];
  PetscReal      *sum   = cover->sum + SUMS * receiver, first[DIM], second[DIM];
  PetscInt        along[2], axis = 0, side = 0;
  PetscReal       driest = 1, wettest = -1; /* c at points, over RAMP */

  (void)GaugeWallFace(cloud->domain, receiver, &axis, &side);
  Along(axis, along);
  Tangents(dim, normal, first, second);
  for (PetscInt k = 0; k < POINTS * (dim == 3 ? POINTS : 1); k++) {
    const PetscReal u = (k % POINTS - 0.5 * (POINTS - 1)) * pitch,
                    v = dim == 3 ? (k / POINTS - 0.5 * (POINTS - 1)) * pitch : 0;
    PetscReal p[DIM], part, c, area;

    for (PetscInt d = 0; d < DIM; d++) p[d] = foot[d] + u * first[d] + v * second[d];
    if (!OnReceiver(cover->gauges, receiver, p)) continue;
    for (PetscInt d = 0; d < DIM; d++) p[d] += RAISED * cloud->size[a] * cloud->domain->spacing * normal[d];
    c = (Share(cover, p, a, &part) - cover->wedge[receiver]) / (2 * RAMP);
    if (part > 0) {
      driest  = PetscMin(driest, c);
      wettest = PetscMax(wettest, c);
    }
    area = part * PetscMax(0, PetscMin(1, 0.5 + c)) * PetscPowRealInt(pitch, (int)dim - 1);
    area *= DomainPairLength(cloud->domain, p, p);
    sum[0] += area;
    for (PetscInt d = 0; d < 2; d++) {
      sum[1 + d] += area * p[along[d]];
      sum[3 + d] += area * PetscSqr(p[along[d]]);
    }
    sum[5] += area * p[along[0]] * p[along[1]];
  }
  return (PetscBool)(driest < 0 && wettest > 0);
}

/* Sums the wetted areas and collects the edges of this rank. */
static PetscErrorCode AddAreas(Cover *cover)
{
  const Cloud cloud = GaugesCloud(cover->gauges);

  PetscFunctionBegin;
  for (PetscInt r = 0; r < GaugeReceivers(cover->gauges); r++) {
    for (PetscInt k = 0; k < FIT; k++) cover->sum[SUMS * r + k] = 0;
    for (PetscInt a = 0; a < cloud->n_fluid; a++) {
      PetscReal foot[DIM], normal[DIM], *edge;

      if (Foot(cover->gauges, r, cloud->field[FIELD_POSITION] + DIM * a, foot, normal) >=
          (PART * KernelSupport(cloud->kernel) + RAISED * cloud->domain->spacing) * cloud->size[a])
        continue;
      if (!AddArea(cover, r, a, foot, normal)) continue;
      PetscCall(PetscSegBufferGet(cover->own, 1 + DIM, &edge));
      edge[0] = r;
      PetscCall(PetscArraycpy(edge + 1, foot, DIM));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives all ranks the edges of all. */
static PetscErrorCode ShareEdges(Cover *cover)
{
  PetscReal *own;
  PetscInt   total;
  size_t     n;

  PetscFunctionBegin;
  PetscCall(PetscSegBufferGetSize(cover->own, &n));
  PetscCall(PetscSegBufferExtractInPlace(cover->own, &own));
  PetscCall(GatherAll(GaugesCloud(cover->gauges)->comm, (PetscInt)n, own, MPIU_REAL, &total, &cover->edge));
  cover->edges = total / (1 + DIM);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether an edge on a receiver is within a distance (m) of x (m), also through periodic faces. */
static PetscBool NearEdge(const Cover *cover, PetscInt receiver, const PetscReal x[DIM], PetscReal distance)
{
  const Domain domain = GaugesCloud(cover->gauges)->domain;

  for (PetscInt e = 0; e < cover->edges; e++) {
    const PetscReal *edge = cover->edge + (1 + DIM) * e;
    PetscReal        r[DIM];

    if (edge[0] != receiver) continue;
    for (PetscInt d = 0; d < DIM; d++) {
      const PetscReal length = domain->upper[d] - domain->lower[d];

      r[d] = x[d] - edge[1 + d];
      if (domain->face[d][0] == FACE_PERIODIC) r[d] -= length * PetscFloorReal(r[d] / length + 0.5);
    }
    if (Dot(r, r) < PetscSqr(distance)) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* Sums for the fit of cosines over heights at the surface near edges, weighted by the surface's share in the contact
   line, |n x normal|. */
static void AddAngles(Cover *cover)
{
  const Cloud     cloud = GaugesCloud(cover->gauges);
  const PetscReal d0    = cloud->domain->spacing;

  for (PetscInt r = 0; r < GaugeReceivers(cover->gauges); r++)
    for (PetscInt a = 0; a < cloud->n_fluid; a++) {
      const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, *n = cloud->field[FIELD_NORMAL] + DIM * a;
      const PetscReal  size = cloud->size[a] * d0, length = Norm(n);
      PetscReal        foot[DIM], normal[DIM], s, cosine, height, weight, *fit = cover->sum + SUMS * r + FIT;

      s = Foot(cover->gauges, r, x, foot, normal);
      if (s < LOW * size || s > HIGH * size || length * size < SURFACE || !NearEdge(cover, r, x, AROUND * size))
        continue;
      cosine = -Dot(n, normal) / length;
      height = s / d0 + 0.5 * cloud->size[a] * cosine;
      weight = cloud->volume[a] * length * length * PetscSqrtReal(PetscMax(0, 1 - cosine * cosine));
      fit[0] += weight;
      fit[1] += weight * height;
      fit[2] += weight * cosine;
      fit[3] += weight * height * height;
      fit[4] += weight * height * cosine;
    }
}

/* The angle (degrees) that the fit has at height 0; NAN without a contact line. */
static PetscReal Angle(const PetscReal fit[5])
{
  const PetscReal height = fit[1] / fit[0], cosine = fit[2] / fit[0], variance = fit[3] / fit[0] - height * height;

  if (!(fit[0] > 0 && variance > LEAST)) return NAN;
  return PetscAcosReal(PetscMax(-1, PetscMin(1, cosine - height * (fit[4] / fit[0] - height * cosine) / variance))) *
         180 / PETSC_PI;
}

/* Widths (m) of the ellipse with the area's second moments about its centre. A mirror at a face doubles the area, as
   far as -gauge_multiplicity counts copies: the centre is on the mirror. */
static void Axes(Gauges gauges, PetscInt d, const PetscReal sum[SUMS], PetscReal width[2])
{
  const Domain domain = GaugesCloud(gauges)->domain;
  PetscReal    copies = GaugesMultiplicity(gauges), xx[2], xy, center[2], mean, half;
  PetscInt     along[2];

  Along(d, along);
  xy = sum[5] / sum[0] - sum[1] * sum[2] / PetscSqr(sum[0]);
  for (PetscInt k = 0; k < 2; k++) {
    const PetscReal mirror = GaugeMirror(domain, along[k], &copies);

    center[k] = PetscIsInfOrNanReal(mirror) ? sum[1 + k] / sum[0] : mirror;
    if (!PetscIsInfOrNanReal(mirror)) xy = 0;
    xx[k] = sum[3 + k] / sum[0] - 2 * center[k] * sum[1 + k] / sum[0] + PetscSqr(center[k]);
  }
  mean     = 0.5 * (xx[0] + xx[1]);
  half     = PetscSqrtReal(PetscSqr(0.5 * (xx[0] - xx[1])) + xy * xy);
  width[0] = 4 * PetscSqrtReal(mean + half);
  width[1] = 4 * PetscSqrtReal(PetscMax(0, mean - half));
}

/* Largest extent (m) along a face of the largest connected piece of liquid: over SWAYS directions. */
static PetscErrorCode Spread(Gauges gauges, PetscInt d, const PetscBool main[], PetscReal *spread)
{
  const Cloud  cloud  = GaugesCloud(gauges);
  const Domain domain = cloud->domain;
  PetscReal    most[2 * SWAYS], mirror[2], copies = GaugesMultiplicity(gauges);
  PetscInt     along[2];

  PetscFunctionBegin;
  Along(d, along);
  for (PetscInt k = 0; k < 2; k++) mirror[k] = GaugeMirror(domain, along[k], &copies);
  for (PetscInt w = 0; w < 2 * SWAYS; w++) most[w] = -PETSC_MAX_REAL;
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    for (PetscInt w = 0; w < 2 * SWAYS && main[a]; w++) {
      const PetscReal angle = PETSC_PI * w / SWAYS, way[2] = {PetscCosReal(angle), PetscSinReal(angle)};
      PetscReal       reach = 0.5 * cloud->size[a] * domain->spacing;

      for (PetscInt k = 0; k < 2; k++) {
        const PetscReal x = cloud->field[FIELD_POSITION][DIM * a + along[k]];

        reach += PetscIsInfOrNanReal(mirror[k]) ? way[k] * x : PetscAbsReal(way[k] * (x - mirror[k]));
      }
      most[w] = PetscMax(most[w], reach);
    }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, most, 2 * SWAYS, MPIU_REAL, MPIU_MAX, GaugesCloud(gauges)->comm));
  *spread = 0;
  for (PetscInt w = 0; w < (domain->dim == 3 ? SWAYS : 1); w++) *spread = PetscMax(*spread, most[w] + most[w + SWAYS]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const OptionRow options[] = {
  {"-gauge_spread",
   "Write to the series, for each wall of the box and each solid, the wetted area (m2), the diameter of the circle of "
   "this area (m) and the contact angle seen (degrees); for walls also the widths of the ellipse (3-d) and of the "
   "liquid",
   NULL, NULL, ROW_BOOL, 0},
  {.name = NULL},
};

/* The quantities of a receiver, in the order of their columns. */
typedef enum { WETTED, DIAMETER, ANGLE, EXTENT, LONG, SHORT, QUANTITIES } Quantity;

/* The number of columns of a receiver: solids have no extent, and only walls in three dimensions have an ellipse. */
static PetscInt Quantities(Gauges gauges, PetscInt receiver)
{
  if (receiver >= GaugeWallFace(GaugesCloud(gauges)->domain, -1, NULL, NULL)) return EXTENT;
  return GaugesCloud(gauges)->domain->dim == 3 ? QUANTITIES : LONG;
}

static PetscErrorCode Columns_Spread(Gauges gauges, const void *data, ColumnList *list)
{
  static const char *const names[QUANTITIES] = {"wetted", "contact_diameter", "contact_angle",
                                                "spread", "contact_long",     "contact_short"};

  PetscFunctionBegin;
  for (PetscInt r = 0; r < GaugeReceivers(gauges) && *(const PetscBool *)data; r++)
    for (PetscInt q = 0; q < Quantities(gauges, r); q++) {
      const Column row = {.unit   = q == WETTED  ? "m2"
                                    : q == ANGLE ? "degrees"
                                                 : "m",
                          .counts = q == WETTED ? COUNTS_SUM : COUNTS_VALUE,
                          .of     = OF_RECEIVER,
                          .index  = r};

      PetscCall(ColumnAdd(list, row, "%s_%s", names[q], GaugeReceiverName(gauges, r)));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sums of all ranks for the areas and edges of these wedges, then for the angles. */
static PetscErrorCode SumAreas(Cover *cover)
{
  const Gauges   gauges = cover->gauges;
  const PetscInt n      = GaugeReceivers(gauges);

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(cover->sum, n * SUMS));
  PetscCall(PetscSegBufferCreate(sizeof(PetscReal), 1024, &cover->own));
  PetscCall(AddAreas(cover));
  PetscCall(ShareEdges(cover));
  PetscCall(PetscSegBufferDestroy(&cover->own));
  AddAngles(cover);
  PetscCall(PetscFree(cover->edge));
  PetscCallMPI(
    MPI_Allreduce(MPI_IN_PLACE, cover->sum, (PetscMPIInt)(n * SUMS), MPIU_REAL, MPIU_SUM, GaugesCloud(gauges)->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Measure_Spread(Gauges gauges, const void *data, PetscReal value[])
{
  const Cloud    cloud = GaugesCloud(gauges);
  const PetscInt n = GaugeReceivers(gauges), faces = GaugeWallFace(cloud->domain, -1, NULL, NULL);
  Cover          cover = {.gauges = gauges};
  PetscInt      *all;
  PetscBool     *main;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(cloud->n_total, &all, cloud->n_fluid, &main, n * SUMS, &cover.sum, n, &cover.wedge));
  for (PetscInt a = 0; a < cloud->n_total; a++) all[a] = a;
  PetscCall(SortedCellsBuild(&cover.cells, cloud, cloud->n_total, all,
                             COVER * KernelSupport(cloud->kernel) * DomainSizeMax(cloud->domain),
                             COVER * KernelSupport(cloud->kernel) * DomainSizeMax(cloud->domain)));
  PetscCall(ConnectedLargest(gauges, ANY_BODY, main));
  for (PetscInt r = 0; r < n; r++) cover.wedge[r] = 0.5;
  PetscCall(SumAreas(&cover));
  for (PetscInt r = 0; r < n; r++) {
    const PetscReal angle = Angle(cover.sum + SUMS * r + FIT);

    if (!PetscIsInfOrNanReal(angle))
      cover.wedge[r] = 0.5 - TILT * PetscMax(-0.5, PetscMin(0.5, PetscCosReal(angle * PETSC_PI / 180)));
  }
  PetscCall(SumAreas(&cover));
  for (PetscInt r = 0; r < n; r++) {
    const Column     row = {.counts = COUNTS_SUM, .of = OF_RECEIVER, .index = r};
    const PetscReal *sum = cover.sum + SUMS * r, whole = GaugesFactor(gauges, &row) * sum[0];
    PetscInt         d = 0, side = 0;

    (void)GaugeWallFace(cloud->domain, r, &d, &side);
    value[WETTED]   = sum[0];
    value[DIAMETER] = DomainIsFlat(cloud->domain) ? whole : 2 * PetscSqrtReal(whole / PETSC_PI);
    value[ANGLE]    = Angle(sum + FIT);
    if (r < faces) PetscCall(Spread(gauges, d, main, &value[EXTENT]));
    if (r < faces && cloud->domain->dim == 3) Axes(gauges, d, sum, value + LONG);
    value += Quantities(gauges, r);
  }
  PetscCall(SortedCellsReset(&cover.cells));
  PetscCall(PetscFree4(all, main, cover.sum, cover.wedge));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const GaugeKind GaugeSpread = {.bytes      = sizeof(PetscBool),
                               .options    = options,
                               .columns    = Columns_Spread,
                               .measure    = Measure_Spread,
                               .needs_sums = PETSC_TRUE};
