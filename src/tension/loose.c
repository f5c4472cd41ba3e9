/* Rings in flight. An isolated piece of rings is a torus. A fat torus contracts onto the axis by its curvature around
   the axis. A slender torus becomes a row of drops first: with R its radius and a that of its section, its waves grow
   in 17 sqrt(rho a^3/sigma) from a smooth surface, in 7 from a rim as corrugated as a crown's, and it would contract in
   R sqrt(2 rho a/sigma). Drops have no pull towards the axis. So a slender piece keeps the curvature of its section,
   which holds it together, and loses the curvature around the axis. */
#include "curvature.h"

#define CONNECTION 1.5 /* spacings: a wider gap separates pieces */
/* R/a from which waves of a rim as corrugated as a crown's, 7 sqrt(rho a^3/sigma), are faster than the contraction */
#define SLENDER 5

/* Quantities of a piece whose smallest value is sought. */
enum { LEAST_R, LEAST_MINUS_R, LEAST_Z, LEAST_MINUS_Z, LEAST_FREE, LEAST_COUNT = 6 }; /* ghosts know 1, 3 or 6 */

/* Whether a ring touches a wall or a solid, or an emitter holds it. */
static PetscBool IsHeld(Cloud cloud, PetscInt a)
{
  const PetscReal *x    = cloud->field[FIELD_POSITION] + DIM * a;
  const Body       body = SceneBody(cloud->scene, cloud->integer[INT_BODY][a]);

  if (BodyHolds(body, x, cloud->size[a] * cloud->domain->spacing)) return PETSC_TRUE;
  if (!OperatorsNearWall(cloud, x)) return PETSC_FALSE;
  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++)
    if (cloud->integer[INT_LAYER][cloud->list[k]] > 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscErrorCode LooseFind(Tension tension, Cloud cloud)
{
  Curvature *data = tension->data;
  PetscReal *least;
  PetscInt  *parent;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(LEAST_COUNT * cloud->n_total, &least, cloud->n_total, &parent));
  PetscCall(PetscRealloc((size_t)cloud->n_owned * sizeof(*data->loose), &data->loose));
  PetscCall(PetscArrayzero(least, LEAST_COUNT * cloud->n_total));
  OperatorsConnect(cloud, CONNECTION * tension->spacing, parent);
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, half = 0.5 * cloud->size[a] * tension->spacing;
    PetscReal       *of = least + LEAST_COUNT * a;

    of[LEAST_R]       = x[0] - half;
    of[LEAST_MINUS_R] = -x[0] - half;
    of[LEAST_Z]       = x[1] - half;
    of[LEAST_MINUS_Z] = -x[1] - half;
    of[LEAST_FREE]    = IsHeld(cloud, a) ? 0 : 1;
  }
  PetscCall(OperatorsComponentMinimum(cloud, parent, LEAST_COUNT, least));
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    const PetscReal *of = least + LEAST_COUNT * a, radius = 0.5 * (of[LEAST_R] - of[LEAST_MINUS_R]),
                    width = -0.5 * PetscMin(of[LEAST_R] + of[LEAST_MINUS_R], of[LEAST_Z] + of[LEAST_MINUS_Z]);

    data->loose[a] = (PetscBool)(of[LEAST_FREE] > 0 && radius > SLENDER * width);
  }
  PetscCall(PetscFree2(least, parent));
  PetscFunctionReturn(PETSC_SUCCESS);
}
