/* The search for walls near a contact line. */
#include "curvature.h"

void *TensionLines(Tension tension)
{
  const Curvature *data = CurvatureOf(tension);

  return data ? data->contact.lines : NULL;
}

PetscInt WallsNear(Tension tension, Cloud cloud, PetscInt a, PetscReal reach, LineWall wall[WALLS_NEAR])
{
  const Curvature *data   = tension->data;
  const Domain     domain = cloud->domain;
  const PetscReal *x      = cloud->field[FIELD_POSITION] + DIM * a;
  PetscInt         n = 0, near = 0;
  PetscReal        s;

  for (PetscInt f = 0; f < 2 * domain->dim; f++) {
    const PetscInt  d = f / 2, side = f % 2;
    const PetscReal y = PetscAbsReal(x[d] - (side ? domain->upper : domain->lower)[d]);

    if (domain->face[d][side] != FACE_WALL || y >= reach) continue;
    wall[n].hysteresis = data->contact.face[d][side].hysteresis_force;
    wall[n].distance   = y;
    for (PetscInt e = 0; e < DIM; e++) {
      wall[n].inward[e]   = e != d ? 0 : side ? -1 : 1;
      wall[n].velocity[e] = domain->wall_velocity[d][side][e];
    }
    n++;
  }
  if (!data->contact.solids) return n;
  s = SceneSolidWithin(cloud->scene, reach, x, &near);
  if (s >= reach || data->contact.solid[near].angle <= 0) return n;
  wall[n].hysteresis = data->contact.solid[near].hysteresis_force;
  wall[n].distance   = s;
  SceneSolidNormal(cloud->scene, x, wall[n].inward);
  SceneSolidVelocity(cloud->scene, near, x, wall[n].velocity);
  return n + 1;
}
