/* Splitting. A particle splits into two halves of equal volume. Their distance is about the spacing of particles of
   half the volume; their direction keeps them farthest from all neighbours. In the plane a particle on the free surface
   splits along the surface if there is room. In space it may split along the normal, too, but the air in front of it
   does not count as room: a film whose surface splits along itself only has all children of a particle in one layer. */
#include "resampling_impl.h"

#define DIRECTIONS  8   /* tried within half a turn */
#define APART       0.6 /* distance of the halves, over the spacing of the particle; in space ... */
#define APART_SPACE 0.65
#define LINES       13   /* through a cube: between opposite faces, edges and corners */
#define TANGENTS    4    /* tried along a surface in space */
#define ALONG       (-1) /* the direction along the free surface */
#define NEARER      3    /* distances tried, each half the last */
#define AXIS_LEAST  0.25 /* spacings: least distance of a half from the axis, and from walls and mirrors of the box */
#define CLEARLY     1e-6 /* spacings, beyond rounding: a direction is better from this on */

void SplitVelocity(Cloud cloud, PetscInt a, const PetscReal at[DIM], PetscReal dv[DIM])
{
  const PetscReal *G = cloud->field[FIELD_VELOCITY_GRADIENT] + DIM * DIM * a;
  PetscReal        along[DIM];

  TensorApply(cloud->field[FIELD_CORRECTION] + 6 * a, at[0], at[1], at[2], along);
  for (PetscInt d = 0; d < DIM; d++)
    dv[d] = cloud->field[FIELD_LAMBDA][a] > MOMENT_MINIMUM ? Dot(G + DIM * d, along) : 0;
}

/* Distance (m) of the point x from the nearest neighbour of a; negative: no half may be there. */
static PetscReal Clearance(Cloud cloud, PetscInt a, const PetscReal x[DIM])
{
  const Domain    domain  = cloud->domain;
  const PetscReal spacing = cloud->size[a] * domain->spacing;
  PetscReal       least2  = PETSC_MAX_REAL;

  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal below = x[d] - domain->lower[d], above = domain->upper[d] - x[d];

    if (below < (domain->face[d][0] == FACE_OPEN ? 0 : AXIS_LEAST * spacing)) return -1;
    if (above < (domain->face[d][1] == FACE_OPEN ? 0 : AXIS_LEAST * spacing)) return -1;
  }
  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    const PetscReal *y     = cloud->field[FIELD_POSITION] + DIM * cloud->list[k],
                    r[DIM] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};

    least2 = PetscMin(least2, Dot(r, r));
  }
  return PetscSqrtReal(least2);
}

/* Finds the displacement at of a half of particle a; the other half moves by -at. distance: |at|, m. A ring on the free
   surface splits along the surface if there is room. False: no room in any direction. */
static PetscBool FindDirection(Cloud cloud, PetscInt a, PetscReal distance, PetscReal at[DIM])
{
  const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, *n = cloud->field[FIELD_NORMAL] + DIM * a;
  const PetscBool  surface = (PetscBool)(cloud->integer[INT_SURFACE][a] == 1 && Norm(n) > 0);
  PetscReal        best    = 0;

  for (PetscInt k = surface ? ALONG : 0; k < DIRECTIONS; k++) {
    const PetscReal angle  = PETSC_PI * k / DIRECTIONS;
    const PetscReal e[DIM] = {k == ALONG ? -n[1] / Norm(n) : PetscCosReal(angle),
                              k == ALONG ? n[0] / Norm(n) : PetscSinReal(angle), 0};
    PetscReal there[DIM], here[DIM], clear;

    for (PetscInt d = 0; d < DIM; d++) {
      there[d] = x[d] + distance * e[d];
      here[d]  = x[d] - distance * e[d];
    }
    clear = PetscMin(Clearance(cloud, a, there), Clearance(cloud, a, here));
    if (clear <= best + (best > 0 ? CLEARLY * cloud->domain->spacing : 0)) continue;
    best = clear;
    for (PetscInt d = 0; d < DIM; d++) at[d] = distance * e[d];
    if (k == ALONG) break;
  }
  return (PetscBool)(best > 0);
}

/* The direction k of those tried in space, a unit vector; n: normal of the free surface, NULL inside. */
static void Line(PetscInt k, const PetscReal n[], PetscReal e[DIM])
{
  const PetscReal angle       = PETSC_PI * k / TANGENTS;
  PetscReal       across[DIM] = {0, 0, 0}, up[DIM], length;
  PetscInt        least       = 0;

  if (!n) {
    const PetscInt c = k + LINES + 1; /* the half of the 27 cells of a cube behind its middle */

    for (PetscInt d = 0; d < DIM; d++) e[d] = (d == 0 ? c % 3 : d == 1 ? c / 3 % 3 : c / 9) - 1;
  } else if (k == TANGENTS) {
    for (PetscInt d = 0; d < DIM; d++) e[d] = n[d];
  } else {
    for (PetscInt d = 1; d < DIM; d++)
      if (PetscAbsReal(n[d]) < PetscAbsReal(n[least])) least = d;
    across[least] = 1;
    Cross(n, across, up);
    length = Norm(up) / Norm(n);
    Cross(n, up, across);
    for (PetscInt d = 0; d < DIM; d++)
      e[d] = PetscCosReal(angle) * up[d] / (length * Norm(n)) + PetscSinReal(angle) * across[d] / Norm(across);
  }
  length = Norm(e);
  for (PetscInt d = 0; d < DIM; d++) e[d] /= length;
}

/* FindDirection in space. spacing: of the particle, m. */
static PetscBool FindLine(Cloud cloud, PetscInt a, PetscReal spacing, PetscReal distance, PetscReal at[DIM])
{
  const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, *n = cloud->field[FIELD_NORMAL] + DIM * a;
  const PetscBool  surface = (PetscBool)(cloud->integer[INT_SURFACE][a] == 1 && Norm(n) > 0);
  PetscReal        best    = 0;

  for (PetscInt k = 0; k < (surface ? TANGENTS + 1 : LINES); k++) {
    PetscReal e[DIM], there[DIM], here[DIM], clear;

    Line(k, surface ? n : NULL, e);
    for (PetscInt d = 0; d < DIM; d++) {
      there[d] = x[d] + distance * e[d];
      here[d]  = x[d] - distance * e[d];
    }
    clear = PetscMin(Clearance(cloud, a, there), Clearance(cloud, a, here));
    if (surface && k == TANGENTS) clear = PetscMin(clear, spacing - distance);
    if (clear <= best + CLEARLY * cloud->domain->spacing) continue;
    best = clear;
    for (PetscInt d = 0; d < DIM; d++) at[d] = distance * e[d];
  }
  return (PetscBool)(best > 0);
}

/* Finds the displacement at the spacing of particles of half the volume; without room there, nearer. */
static PetscBool FindPlace(Cloud cloud, PetscInt a, const Change *change, PetscReal at[DIM])
{
  const Domain    domain   = cloud->domain;
  const PetscReal spacing  = PetscPowReal(change->share[a], 1. / domain->dim) * change->unit[a] * domain->spacing;
  PetscReal       distance = 0.5 * (domain->dim == DIM ? APART_SPACE : APART) * spacing;

  for (PetscInt k = 0; k < NEARER; k++, distance *= 0.5)
    if (domain->dim == DIM ? FindLine(cloud, a, spacing, distance, at) : FindDirection(cloud, a, distance, at))
      return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscErrorCode SplitLarge(Cloud cloud, Change *change, ResamplingReport *report)
{
  const PetscReal most   = cloud->domain->adaptive ? MOST_FOLLOW : MOST;
  ParticleArrays *arrays = &change->arrays;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal *at = change->at + DIM * change->split, dv[DIM];

    if (change->share[a] <= most || !change->keep[a] || change->changed[a]) continue;
    if (!FindPlace(cloud, a, change, at)) continue;
    SplitVelocity(cloud, a, at, dv);
    change->parent[change->split++] = a;
    for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++)
      for (PetscInt c = 0; arrays->real[f] && Fields[f].carry == CARRY_SUM && c < Fields[f].width; c++)
        arrays->real[f][Fields[f].width * a + c] *= 0.5;
    if (arrays->real[FIELD_SIZE]) arrays->real[FIELD_SIZE][a] = ShareSize(cloud, change, a, 0.5);
    for (PetscInt d = 0; d < DIM; d++) {
      arrays->real[FIELD_POSITION][DIM * a + d] -= at[d];
      arrays->real[FIELD_VELOCITY][DIM * a + d] -= dv[d];
    }
    report->energy -= 0.5 * cloud->rest_density[a] * cloud->volume[a] * Dot(dv, dv);
  }
  report->split = change->split;
  PetscFunctionReturn(PETSC_SUCCESS);
}
