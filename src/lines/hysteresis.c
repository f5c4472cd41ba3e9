/* Contact-angle hysteresis. Between the receding angle r and the advancing angle a the contact line does not move. The
   surface meets the wall at the angle with the cosine (cos r + cos a)/2, and the line resists with a force per length
   of up to sigma (cos r - cos a)/2: it advances when the surface would meet the wall at a, and recedes at r. On an
   incline a drop stays up to m g sin(slope) = sigma (cos r - cos a) times its width.

   The resistance acts along the wall on the particles near wall and free surface, like dry friction: it stops them, or
   reduces their velocity. A particle has the area 2 V |n| of the free surface, n = sum V grad W: a length of the line
   times a height above the wall. n lacks the part of the surface below the wall, which F of a half-space at this
   distance corrects. The force of the curvature uses W^H three times (normals, their fit, their mean) and reaches 1.5
   supports of W^H from the wall. The resistance must reach as far, or the liquid above rolls over the liquid at rest;
   it decreases linearly from the wall to there. (Acting on the first layer of particles alone it holds a drop up to a
   quarter of the right slope, within one support up to three quarters.) */
#include "lines.h"

/* In supports of W^H, see above. A drop on a slope of 0.85 and 1.15 of the right one creeps with capillary numbers of
   2.2e-4 and 5.5e-3; with 1 of 2.0e-3 and 9.2e-3, with 2 of 1.3e-4 and 3.6e-3: farther the line holds too well. */
#define REACH 1.5

/* Reduces the velocity v (m/s) of particle a by the resistance in dt (s) of the line on a wall within 'reach' (m).
   Returns the change of the kinetic energy (J). */
static PetscReal Resist(Cloud cloud, PetscReal dt, PetscInt a, PetscReal reach, const LineWall *wall, PetscReal v[DIM])
{
  const PetscReal *n = cloud->field[FIELD_NORMAL] + DIM * a, *inward = wall->inward;
  const PetscReal  distance = PetscMax(0, wall->distance), per_height = 2 / reach * (1 - distance / reach),
                  into   = Dot(n, inward),
                  sigma  = BodyMaterial(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]))->tension,
                  before = Dot(v, v);
  PetscReal across[DIM], length, speed = 0, most, change, seen;

  for (PetscInt d = 0; d < DIM; d++) across[d] = n[d] - into * inward[d];
  length = Norm(across);
  if (length == 0) return 0;
  for (PetscInt d = 0; d < DIM; d++) speed += (v[d] - wall->velocity[d]) * across[d] / length;
  KernelHalfSpace(cloud->kernel, distance / cloud->size[a], NULL, &seen);
  most   = dt * sigma * wall->hysteresis * 2 * length / seen * per_height / cloud->rest_density[a];
  change = PetscMax(-most, PetscMin(most, speed));
  for (PetscInt d = 0; d < DIM; d++) v[d] -= change * across[d] / length;
  return 0.5 * cloud->volume[a] * cloud->rest_density[a] * (Dot(v, v) - before);
}

PetscErrorCode LinesResist(Tension tension, Cloud cloud, PetscReal dt, PetscReal v[], PetscReal *work)
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid && TensionHasHysteresis(tension); a++) {
    const PetscReal reach = REACH * TensionReach(tension) * cloud->size[a];
    LineWall        wall[WALLS_NEAR];
    PetscInt        n;

    if (!cloud->integer[INT_SURFACE][a]) continue;
    n = WallsNear(tension, cloud, a, reach, wall);
    for (PetscInt k = 0; k < n; k++)
      if (wall[k].hysteresis != 0) *work += Resist(cloud, dt, a, reach, &wall[k], v + DIM * a);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
