#include "wall.h"

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
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_GUARD), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
