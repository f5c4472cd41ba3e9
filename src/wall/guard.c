#include "wall.h"

/* The same for solids: out along the normal. */
static void GuardSolids(Cloud cloud, PetscReal distance, PetscReal x[], PetscReal v[], PetscInt *touched)
{
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal deep = distance - SceneSolidDistance(cloud->scene, x + DIM * a, NULL);
    PetscReal       n[DIM], inwards;

    if (deep <= 0) continue;
    SceneSolidNormal(cloud->scene, x + DIM * a, n);
    inwards = PetscMin(0, Dot(v + DIM * a, n));
    for (PetscInt d = 0; d < DIM; d++) {
      x[DIM * a + d] += deep * n[d];
      v[DIM * a + d] -= inwards * n[d];
    }
    (*touched)++;
  }
}

PetscErrorCode WallGuard(Cloud cloud, PetscReal distance, PetscReal x[], PetscReal v[], PetscInt *touched)
{
  Domain domain = cloud->domain;

  PetscFunctionBegin;
  *touched = 0;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_GUARD), 0, 0, 0, 0));
  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt side = 0; side < 2; side++) {
      const FaceType  face    = domain->face[d][side];
      const PetscReal inwards = side ? -1 : 1, at = side ? domain->upper[d] : domain->lower[d],
                      wall = domain->wall_velocity[d][side][d];

      if (face != FACE_WALL && face != FACE_SYMMETRY) continue;
      for (PetscInt a = 0; a < cloud->n_fluid; a++) {
        PetscReal *place = &x[DIM * a + d], *speed = &v[DIM * a + d];

        if (face == FACE_WALL && inwards * (*place - at) < distance) {
          *place = at + inwards * distance;
          if (inwards * (*speed - wall) < 0) *speed = wall;
          (*touched)++;
        } else if (face == FACE_SYMMETRY && inwards * (*place - at) < 0) {
          *place = 2 * at - *place;
          *speed = -*speed;
        }
      }
    }
  if (SceneSolidCount(cloud->scene)) GuardSolids(cloud, distance, x, v, touched);
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_GUARD), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
