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
#include "tension_impl.h"

#define REACH 1.5 /* in supports of W^H, see above; no reference */

/* Reduces the velocity v (m/s) of particle a by the resistance in dt (s) of the line on a wall with this contact angle,
   at this distance (m), with the normal 'inward' into the liquid and the velocity wall_v (m/s). Returns the change of
   the kinetic energy (J). */
static PetscReal Resist(Tension tension, Cloud cloud, PetscReal dt, PetscInt a, const ContactAngle *contact,
                        PetscReal distance, const PetscReal inward[DIM], const PetscReal wall_v[DIM], PetscReal v[DIM])
{
  const PetscReal *n         = cloud->field[FIELD_NORMAL] + DIM * a;
  const PetscReal  reach     = REACH * KernelSupport(tension->kernel) * cloud->size[a],
                  per_height = distance < reach ? 2 / reach * (1 - PetscMax(0, distance) / reach) : 0,
                  into       = Dot(n, inward),
                  sigma      = BodyMaterial(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]))->tension,
                  before     = Dot(v, v);
  PetscReal across[DIM], length, speed = 0, most, change, seen;

  for (PetscInt d = 0; d < DIM; d++) across[d] = n[d] - into * inward[d];
  length = Norm(across);
  if (length == 0 || per_height == 0) return 0;
  for (PetscInt d = 0; d < DIM; d++) speed += (v[d] - wall_v[d]) * across[d] / length;
  KernelHalfSpace(cloud->kernel, PetscMax(0, distance) / cloud->size[a], NULL, &seen);
  most   = dt * sigma * contact->hysteresis_force * 2 * length / seen * per_height / cloud->rest_density[a];
  change = PetscMax(-most, PetscMin(most, speed));
  for (PetscInt d = 0; d < DIM; d++) v[d] -= change * across[d] / length;
  return 0.5 * cloud->volume[a] * cloud->rest_density[a] * (Dot(v, v) - before);
}

/* The same for particle a near solids. */
static PetscReal ResistAtSolid(Tension tension, Cloud cloud, PetscReal dt, PetscInt a, PetscReal v[DIM])
{
  const PetscReal *x    = cloud->field[FIELD_POSITION] + DIM * a;
  PetscInt         near = 0;
  const PetscReal  s    = SceneSolidDistance(cloud->scene, x, &near);
  PetscReal        inward[DIM], wall_v[DIM];

  if (s > REACH * KernelSupport(tension->kernel) * cloud->size[a] || tension->solid.angle[near].hysteresis_force == 0)
    return 0;
  SceneSolidNormal(cloud->scene, x, inward);
  SceneSolidVelocity(cloud->scene, near, x, wall_v);
  return Resist(tension, cloud, dt, a, &tension->solid.angle[near], s, inward, wall_v, v);
}

PetscErrorCode TensionApplyHysteresis(Tension tension, Cloud cloud, PetscReal dt, PetscReal v[], PetscReal *work)
{
  const Domain domain = cloud->domain;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid && tension->hysteresis; a++) {
    if (!cloud->integer[INT_SURFACE][a]) continue;
    for (PetscInt f = 0; f < 2 * domain->dim; f++) {
      const PetscInt  d = f / 2, side = f % 2;
      const PetscReal distance =
        PetscAbsReal(cloud->field[FIELD_POSITION][DIM * a + d] - (side ? domain->upper : domain->lower)[d]);
      PetscReal inward[DIM] = {0, 0, 0};

      if (domain->face[d][side] != FACE_WALL || tension->contact[d][side].hysteresis_force == 0) continue;
      inward[d] = side ? -1 : 1;
      *work += Resist(tension, cloud, dt, a, &tension->contact[d][side], distance, inward,
                      domain->wall_velocity[d][side], v + DIM * a);
    }
    if (tension->solid.count) *work += ResistAtSolid(tension, cloud, dt, a, v + DIM * a);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool TensionHasHysteresis(Tension tension)
{
  return (PetscBool)(tension->active && tension->hysteresis);
}

PetscBool TensionHasAngles(Tension tension)
{
  return (PetscBool)(tension->tilted || tension->hysteresis);
}
