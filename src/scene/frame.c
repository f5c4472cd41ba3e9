/* A frame of reference that rotates with a constant angular velocity W about an axis through c. Positions and
   velocities are those in this frame. The liquid has the centrifugal acceleration -W x (W x (x - c)) and the Coriolis
   acceleration -2 W x v. */
#include "scene_impl.h"

/* Whether a vector is parallel to the axis. */
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
  PetscCall(RateCheck(domain, "frame_", &scene->frame_given, scene->frame_rate));
  if (!SceneFrameTurns(scene)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheckUser(AlongAxis(scene, scene->gravity) && AlongAxis(scene, scene->amplitude), comm,
                 "-gravity and -gravity_amplitude must be along the axis of -frame_rotation_rate: any other gravity "
                 "would rotate in that frame");
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal direction[DIM] = {d == 0, d == 1, d == 2};

    for (PetscInt side = 0; side < 2; side++)
      PetscCheckUser((domain->face[d][side] != FACE_PERIODIC && domain->face[d][side] != FACE_SYMMETRY) ||
                       AlongAxis(scene, direction),
                     comm,
                     "-box_%c%s is periodic or symmetry: with -frame_rotation_rate only faces at right angles to its "
                     "axis can be, since elsewhere the forces differ between both sides of the face",
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

/* -W x (W x r) = W^2 r - W (W.r), r = x - c. */
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
    PetscCall(PetscViewerASCIIPrintf(viewer, "in a frame that rotates with %g, %g, %g rad/s about %g, %g, %g m\n",
                                     (double)w[0], (double)w[1], (double)w[2], (double)c[0], (double)c[1],
                                     (double)c[2]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
