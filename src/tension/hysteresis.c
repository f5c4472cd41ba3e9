/* Contact lines that stick. Between the receding angle r and the advancing angle a nothing moves the line. The surface
   meets the wall under the angle between them, of cosine (cos r + cos a)/2, and the line resists with a pull of up to
   sigma (cos r - cos a)/2: it advances where the surface would meet the wall at a, and recedes at r. On an incline a
   drop stays where it is up to m g sin(slope) = sigma (cos r - cos a) times its width.

   The resistance acts along the wall on the particles near wall and free surface, as dry friction does: it stops them,
   or takes what it can from their velocity. The part of the free surface that a particle has is 2 V |n|, n = sum V grad
   W; across the wall that is a part of the line times one of the height above the wall. n lacks what the surface would
   add below the wall, F of a half-space at this distance. The pull of the curvature, for which W^H is taken three times
   (normals, their fit, their mean), reaches up to some 1.5 supports of W^H from the wall, and so must the resistance,
   or the liquid above rolls over what is held: it falls from the wall to there, linearly. (On the first layer of
   particles alone it holds a drop at a quarter of the slope that it should, within one support at three quarters.) */
#include "tension_impl.h"

#define REACH 1.5 /* over the support of W^H: see above; chosen for this model, no reference */

/* Takes from the velocity v (m/s) of particle a what the line on a wall can in dt (s). The wall has this contact angle,
   is at this distance (m), 'inward' out of it, and moves with wall_v (m/s). Returns the change of the kinetic energy
   (J). */
static PetscReal Hold(Tension tension, Cloud cloud, PetscReal dt, PetscInt a, const ContactAngle *contact,
                      PetscReal distance, const PetscReal inward[DIM], const PetscReal wall_v[DIM], PetscReal v[DIM])
{
  const PetscReal *n     = cloud->field[FIELD_NORMAL] + DIM * a;
  const PetscReal  reach = REACH * KernelSupport(tension->kernel) * cloud->size[a],
                  share = distance < reach ? 2 / reach * (1 - PetscMax(0, distance) / reach) : 0, into = Dot(n, inward),
                  sigma  = BodyMaterial(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]))->tension,
                  before = Dot(v, v);
  PetscReal across[DIM], length, speed = 0, most, change, seen;

  for (PetscInt d = 0; d < DIM; d++) across[d] = n[d] - into * inward[d];
  length = Norm(across);
  if (length == 0 || share == 0) return 0;
  for (PetscInt d = 0; d < DIM; d++) speed += (v[d] - wall_v[d]) * across[d] / length;
  KernelHalfSpace(cloud->kernel, PetscMax(0, distance) / cloud->size[a], NULL, &seen);
  most   = dt * sigma * contact->stick * 2 * length / seen * share / cloud->rest_density[a];
  change = PetscMax(-most, PetscMin(most, speed));
  for (PetscInt d = 0; d < DIM; d++) v[d] -= change * across[d] / length;
  return 0.5 * cloud->volume[a] * cloud->rest_density[a] * (Dot(v, v) - before);
}

/* Of particle a near solids. */
static PetscReal HoldAtSolid(Tension tension, Cloud cloud, PetscReal dt, PetscInt a, PetscReal v[DIM])
{
  const PetscReal *x    = cloud->field[FIELD_POSITION] + DIM * a;
  PetscInt         near = 0;
  const PetscReal  s    = SceneSolidDistance(cloud->scene, x, &near);
  PetscReal        inward[DIM], wall_v[DIM];

  if (s > REACH * KernelSupport(tension->kernel) * cloud->size[a] || tension->solid.angle[near].stick == 0) return 0;
  SceneSolidNormal(cloud->scene, x, inward);
  BodyMotion(SceneSolid(cloud->scene, near), SceneSolidTime(cloud->scene), x, wall_v);
  return Hold(tension, cloud, dt, a, &tension->solid.angle[near], s, inward, wall_v, v);
}

PetscErrorCode TensionHold(Tension tension, Cloud cloud, PetscReal dt, PetscReal v[], PetscReal *work)
{
  const Domain domain = cloud->domain;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid && tension->sticks; a++) {
    if (!cloud->integer[INT_SURFACE][a]) continue;
    for (PetscInt f = 0; f < 2 * domain->dim; f++) {
      const PetscInt  d = f / 2, side = f % 2;
      const PetscReal distance =
        PetscAbsReal(cloud->field[FIELD_POSITION][DIM * a + d] - (side ? domain->upper : domain->lower)[d]);
      PetscReal inward[DIM] = {0, 0, 0};

      if (domain->face[d][side] != FACE_WALL || tension->contact[d][side].stick == 0) continue;
      inward[d] = side ? -1 : 1;
      *work += Hold(tension, cloud, dt, a, &tension->contact[d][side], distance, inward, domain->wall_velocity[d][side],
                    v + DIM * a);
    }
    if (tension->solid.count) *work += HoldAtSolid(tension, cloud, dt, a, v + DIM * a);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool TensionSticks(Tension tension)
{
  return (PetscBool)(tension->active && tension->sticks);
}

PetscBool TensionHasAngles(Tension tension)
{
  return (PetscBool)(tension->slanted || tension->sticks);
}
