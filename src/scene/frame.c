/* A frame that turns at a constant rate W about a point c: the scene and its velocities are those that are seen in it,
   and the liquid feels the centrifugal acceleration -W x (W x (x - c)) and that of Coriolis, -2 W x v. */
#include "scene_impl.h"

PetscErrorCode FrameSetFromOptions(Scene scene, OptionItems PetscOptionsObject)
{
  PetscFunctionBegin;
  scene->frame_rates = DIM + 1;
  PetscCall(PetscOptionsRealArray("-frame_rotation_rate",
                                  "Angular velocity of a frame in which the scene is at rest, about an axis of this "
                                  "direction; in two dimensions one number will do (rad/s)",
                                  "SceneSetFromOptions", scene->frame_rate, &scene->frame_rates, NULL));
  PetscCall(DomainOptionsVector(scene->domain, PetscOptionsObject, VECTOR_POINT, "-frame_rotation_center",
                                "Point on that axis (m)", "SceneSetFromOptions", scene->frame_center, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a vector is along the axis. */
static PetscBool AlongAxis(Scene scene, const PetscReal g[DIM])
{
  PetscReal across[DIM];

  Cross(g, scene->frame_rate, across);
  return (PetscBool)(Norm(across) <= PETSC_SMALL * Norm(g) * Norm(scene->frame_rate));
}

PetscErrorCode FrameCheck(Scene scene)
{
  const Domain   domain = scene->domain;
  const MPI_Comm comm   = domain->comm;

  PetscFunctionBegin;
  PetscCall(RateCheck(domain, "frame_", scene->frame_rates, scene->frame_rate));
  if (!SceneFrameTurns(scene)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheckUser(AlongAxis(scene, scene->gravity) && AlongAxis(scene, scene->amplitude), comm,
                 "-gravity and -gravity_amplitude must be along the axis of -frame_rotation_rate: any other would turn "
                 "in that frame");
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal direction[DIM] = {d == 0, d == 1, d == 2};

    for (PetscInt side = 0; side < 2; side++)
      PetscCheckUser((domain->face[d][side] != FACE_PERIODIC && domain->face[d][side] != FACE_SYMMETRY) ||
                       AlongAxis(scene, direction),
                     comm,
                     "-box_%c%s is periodic or symmetry, which with -frame_rotation_rate only faces at right angles to "
                     "its axis can be: the forces in the frame are not the same on both sides",
                     "xyz"[d], side ? "max" : "min");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool SceneFrameTurns(Scene scene)
{
  return (PetscBool)(Norm(scene->frame_rate) > 0);
}

void SceneFrameRate(Scene scene, PetscReal rate[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) rate[d] = scene->frame_rate[d];
}

/* W^2 r - W (W.r), r from the centre. */
void FrameAdd(Scene scene, const PetscReal x[DIM], PetscReal g[DIM])
{
  const PetscReal *w = scene->frame_rate, *c = scene->frame_center, r[DIM] = {x[0] - c[0], x[1] - c[1], x[2] - c[2]};

  for (PetscInt d = 0; d < scene->domain->dim; d++) g[d] += Dot(w, w) * r[d] - Dot(w, r) * w[d];
}

PetscReal FramePotential(Scene scene, const PetscReal x[DIM])
{
  PetscReal g[DIM] = {0, 0, 0}, energy = 0;

  FrameAdd(scene, x, g);
  for (PetscInt d = 0; d < DIM; d++) energy -= 0.5 * g[d] * (x[d] - scene->frame_center[d]);
  return energy;
}

PetscErrorCode FrameView(Scene scene, PetscViewer viewer)
{
  const PetscReal *w = scene->frame_rate, *c = scene->frame_center;

  PetscFunctionBegin;
  if (SceneFrameTurns(scene))
    PetscCall(PetscViewerASCIIPrintf(viewer, "in a frame that turns with %g, %g, %g rad/s about %g, %g, %g m\n",
                                     (double)w[0], (double)w[1], (double)w[2], (double)c[0], (double)c[1],
                                     (double)c[2]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
