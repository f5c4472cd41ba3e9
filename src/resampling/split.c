/* Splitting. A ring splits into two halves of equal volume. Their distance is about the spacing of rings of half the
   area; their direction keeps them farthest from all neighbours. A ring on the free surface splits along the surface if
   there is room. */
#include "resampling_impl.h"

#define DIRECTIONS 8    /* tried within half a turn */
#define APART      0.6  /* distance of the halves, over the spacing and the square root of the area */
#define ALONG      (-1) /* the direction along the free surface */
#define NEARER     3    /* distances tried, each half the last */
#define AXIS_LEAST 0.25 /* spacings: least distance of a half from the axis, and from walls and mirrors of the box */
#define CLEARLY    1e-6 /* spacings, beyond rounding: a direction is better from this on */

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

/* Finds the displacement at the spacing of rings of half the area; without room there, nearer. */
static PetscBool FindPlace(Cloud cloud, PetscInt a, PetscReal area, PetscReal at[DIM])
{
  PetscReal distance = 0.5 * APART * PetscSqrtReal(area) * cloud->size[a] * cloud->domain->spacing;

  for (PetscInt k = 0; k < NEARER; k++, distance *= 0.5)
    if (FindDirection(cloud, a, distance, at)) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscErrorCode SplitLarge(Cloud cloud, const Resampling *resampling, Change *change, ResamplingReport *report)
{
  ParticleArrays *arrays = &change->arrays;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal *at = change->at + DIM * change->split, dv[DIM];

    if (change->area[a] <= MOST || !change->keep[a] || change->changed[a]) continue;
    if (!FindPlace(cloud, a, change->area[a], at)) continue;
    SplitVelocity(cloud, a, at, dv);
    change->parent[change->split++] = a;
    arrays->real[FIELD_VOLUME][a] *= 0.5;
    for (PetscInt d = 0; d < DIM; d++) {
      arrays->real[FIELD_POSITION][DIM * a + d] -= at[d];
      arrays->real[FIELD_VELOCITY][DIM * a + d] -= dv[d];
    }
    report->energy -= 0.5 * cloud->rest_density[a] * cloud->volume[a] * Dot(dv, dv);
  }
  report->split = change->split;
  PetscFunctionReturn(PETSC_SUCCESS);
}
