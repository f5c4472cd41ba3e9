#include "stepper_impl.h"

/* cosine of the angle within which two surfaces are the sides of a gap; tests/verify/touching.py and confined.py hold
   with 0.7 and with 0.99 */
#define FACING 0.95
/* of the guard's distance, within which a particle touches a wall: both sides of a gap stop one in its middle, and
   rounding does not decide about one that its shift has taken just there */
#define TOUCH 1e-9

/* What faces the solid at x (m), s (m) out of it along n: the least distance (m) from x of a wall or another solid on
   the other side of a gap. */
static PetscReal Opposite(Cloud cloud, PetscInt solid, const PetscReal x[DIM], const PetscReal n[DIM])
{
  const Domain domain = cloud->domain;
  PetscReal    least  = PETSC_MAX_REAL;

  for (PetscInt f = 0; f < 2 * domain->dim; f++) {
    const PetscInt  d = f / 2, side = f % 2;
    const PetscReal inwards = side ? -1 : 1, at = side ? domain->upper[d] : domain->lower[d];

    if (domain->face[d][side] == FACE_WALL && inwards * n[d] < -FACING) least = PetscMin(least, inwards * (x[d] - at));
  }
  for (PetscInt b = 0; b < SceneSolidCount(cloud->scene); b++) {
    PetscReal image[DIM], other[DIM], s;

    if (b == solid) continue;
    s = BodyNearest(SceneSolid(cloud->scene, b), x, image);
    if (s >= least) continue;
    DistanceNormal(cloud->scene, SceneOneDistance, b, image, other);
    if (Dot(n, other) < -FACING) least = s;
  }
  return least;
}

/* The guard's distance is for a particle of the fine spacing; a larger one needs more. A gap between a solid and a
   wall, or two solids, may be narrower than the guard needs on both sides: there it moves a particle to the middle, and
   room[a] is half of the gap (m). Else each side in turn moves it, up to out of the other end of the solid, however
   short the step. */
static void GuardGaps(Cloud cloud, PetscReal distance, PetscReal x[], PetscReal room[])
{
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscInt        solid = 0;
    const PetscReal least = distance * cloud->size[a],
                    s     = SceneSolidWithin(cloud->scene, 2 * least, x + DIM * a, &solid);
    PetscReal image[DIM], n[DIM], w;

    room[a] = least;
    if (s >= 2 * least) continue;
    (void)BodyNearest(SceneSolid(cloud->scene, solid), x + DIM * a, image);
    DistanceNormal(cloud->scene, SceneOneDistance, solid, image, n);
    w = Opposite(cloud, solid, x + DIM * a, n);
    if (w + s >= 2 * least) continue;
    for (PetscInt d = 0; d < DIM; d++) x[DIM * a + d] += 0.5 * (w - s) * n[d];
    room[a] = 0.5 * (w + s);
  }
}

/* Keeps particles out of one face of the box, a wall or a mirror. */
static void GuardFace(Cloud cloud, PetscInt d, PetscInt side, const PetscReal room[], PetscReal x[], PetscReal v[])
{
  const Domain    domain  = cloud->domain;
  const PetscBool wall    = (PetscBool)(domain->face[d][side] == FACE_WALL);
  const PetscReal inwards = side ? -1 : 1, at = side ? domain->upper[d] : domain->lower[d],
                  wall_velocity = domain->wall_velocity[d][side][d];

  for (PetscInt k = d; k < DIM * cloud->n_fluid; k += DIM) {
    const PetscReal least = room[k / DIM];

    if (wall && inwards * (x[k] - at) < (1 + TOUCH) * least) {
      x[k] = at + inwards * PetscMax(least, inwards * (x[k] - at));
      if (inwards * (v[k] - wall_velocity) < 0) v[k] = wall_velocity;
    } else if (!wall && inwards * (x[k] - at) < 0) {
      x[k] = 2 * at - x[k];
      v[k] = -v[k];
    }
  }
}

/* The same for solids: moves particles out along the normal. */
static PetscErrorCode GuardSolids(Stepper stepper, const PetscReal room[], PetscReal x[], PetscReal v[])
{
  const Cloud cloud = stepper->cloud;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscInt        solid = 0;
    const PetscReal touch = (1 + TOUCH) * room[a], s = SceneSolidWithin(cloud->scene, touch, x + DIM * a, &solid),
                    deep = PetscMax(0, room[a] - s);
    PetscReal n[DIM], u[DIM], image[DIM], taken[DIM], inwards;

    if (s >= touch) continue;
    (void)BodyNearest(SceneSolid(cloud->scene, solid), x + DIM * a, image);
    SceneSolidVelocity(cloud->scene, solid, image, u);
    SceneSolidNormal(cloud->scene, x + DIM * a, n);
    inwards = PetscMin(0, Dot(v + DIM * a, n) - Dot(u, n));
    for (PetscInt d = 0; d < DIM; d++) {
      x[DIM * a + d] += deep * n[d];
      v[DIM * a + d] -= inwards * n[d];
      taken[d] = cloud->volume[a] * cloud->rest_density[a] * inwards * n[d];
    }
    StepHook(stepper, push, &step, solid, x + DIM * a, taken);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode WallGuard(Stepper stepper, PetscReal distance, PetscReal x[], PetscReal v[])
{
  const Cloud  cloud  = stepper->cloud;
  const Domain domain = cloud->domain;
  PetscReal   *room;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, 1, &room));
  GuardGaps(cloud, distance, x, room);
  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt side = 0; side < 2; side++)
      if (domain->face[d][side] == FACE_WALL || domain->face[d][side] == FACE_SYMMETRY)
        GuardFace(cloud, d, side, room, x, v);
  if (SceneSolidCount(cloud->scene)) PetscCall(GuardSolids(stepper, room, x, v));
  PetscCall(CloudRestoreWork(cloud, &room));
  PetscFunctionReturn(PETSC_SUCCESS);
}
