#include "stepper_impl.h"

/* Keeps particles out of one face of the box, a wall or a mirror. */
static void GuardFace(Cloud cloud, PetscInt d, PetscInt side, PetscReal distance, PetscReal x[], PetscReal v[])
{
  const Domain    domain  = cloud->domain;
  const PetscBool wall    = (PetscBool)(domain->face[d][side] == FACE_WALL);
  const PetscReal inwards = side ? -1 : 1, at = side ? domain->upper[d] : domain->lower[d],
                  wall_velocity = domain->wall_velocity[d][side][d];

  for (PetscInt k = d; k < DIM * cloud->n_fluid; k += DIM) {
    const PetscReal least = distance * cloud->size[k / DIM];

    if (wall && inwards * (x[k] - at) < least) {
      x[k] = at + inwards * least;
      if (inwards * (v[k] - wall_velocity) < 0) v[k] = wall_velocity;
    } else if (!wall && inwards * (x[k] - at) < 0) {
      x[k] = 2 * at - x[k];
      v[k] = -v[k];
    }
  }
}

/* The same for solids: moves particles out along the normal. */
static PetscErrorCode GuardSolids(Stepper stepper, PetscReal distance, PetscReal x[], PetscReal v[])
{
  const Cloud cloud = stepper->cloud;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscInt        solid = 0;
    const PetscReal deep  = distance - SceneSolidWithin(cloud->scene, distance, x + DIM * a, &solid);
    PetscReal       n[DIM], u[DIM], image[DIM], taken[DIM], inwards;

    if (deep <= 0) continue;
    (void)BodyNearest(SceneSolid(cloud->scene, solid), x + DIM * a, image);
    SceneSolidVelocity(cloud->scene, solid, image, u);
    SceneSolidNormal(cloud->scene, x + DIM * a, n);
    inwards = PetscMin(0, Dot(v + DIM * a, n) - Dot(u, n));
    for (PetscInt d = 0; d < DIM; d++) {
      x[DIM * a + d] += deep * n[d];
      v[DIM * a + d] -= inwards * n[d];
      taken[d] = cloud->volume[a] * cloud->rest_density[a] * inwards * n[d];
    }
    StepHook(stepper, push, stepper, solid, x + DIM * a, taken);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode WallGuard(Stepper stepper, PetscReal distance, PetscReal x[], PetscReal v[])
{
  const Cloud  cloud  = stepper->cloud;
  const Domain domain = cloud->domain;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt side = 0; side < 2; side++)
      if (domain->face[d][side] == FACE_WALL || domain->face[d][side] == FACE_SYMMETRY)
        GuardFace(cloud, d, side, distance, x, v);
  if (SceneSolidCount(cloud->scene)) PetscCall(GuardSolids(stepper, distance, x, v));
  PetscFunctionReturn(PETSC_SUCCESS);
}
