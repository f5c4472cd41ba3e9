/* A frame of reference that rotates with a constant angular velocity W about an axis through c. Positions and
   velocities are those in this frame. The liquid has the centrifugal acceleration -W x (W x (x - c)) and the Coriolis
   acceleration -2 W x v. */
#include "scene_impl.h"

typedef struct _p_Frame {
  OptionNumbers given;
  PetscReal     center[DIM], rate[DIM]; /* m, rad/s */
} Frame;

static const OptionRow rows[] = {
  {"-frame_rotation_rate", "Angular velocity vector of the frame of reference; in two dimensions one number is enough",
   "rad/s", NULL, ROW_NUMBERS, offsetof(Frame, given)},
  {"-frame_rotation_center", "Point on the axis of the frame's rotation", "m", NULL, ROW_POINT,
   offsetof(Frame, center)},
  {.name = NULL},
};

PetscBool FrameKeeps(Scene scene, const PetscReal g[DIM])
{
  PetscReal across[DIM];

  if (!SceneFrameTurns(scene)) return PETSC_TRUE;
  Cross(g, scene->frame->rate, across);
  return (PetscBool)(Norm(across) <= PETSC_SMALL * Norm(g) * Norm(scene->frame->rate));
}

static PetscErrorCode Check(Scene scene, void *data)
{
  Frame         *frame  = (Frame *)data;
  const Domain   domain = scene->domain;
  const MPI_Comm comm   = domain->comm;

  PetscFunctionBegin;
  PetscCall(RateCheck(domain, "frame_", &frame->given, frame->rate));
  frame->given.count = DIM;
  PetscCall(PetscArraycpy(frame->given.value, frame->rate, DIM));
  scene->frame = frame;
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal direction[DIM] = {d == 0, d == 1, d == 2};

    for (PetscInt side = 0; side < 2; side++)
      PetscCheckUser((domain->face[d][side] != FACE_PERIODIC && domain->face[d][side] != FACE_SYMMETRY) ||
                       FrameKeeps(scene, direction),
                     comm,
                     "-box_%c%s is periodic or symmetry: with -frame_rotation_rate only faces at right angles to its "
                     "axis can be, since elsewhere the forces differ between both sides of the face",
                     "xyz"[d], side ? "max" : "min");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool SceneFrameTurns(Scene scene)
{
  return (PetscBool)(scene->frame && Norm(scene->frame->rate) > 0);
}

void SceneFrameRate(Scene scene, PetscReal rate[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) rate[d] = scene->frame ? scene->frame->rate[d] : 0;
}

/* -W x (W x r) = W^2 r - W (W.r), r = x - c. */
static void Add(Domain domain, const void *data, const PetscReal x[DIM], PetscReal g[DIM])
{
  const Frame     *frame = (const Frame *)data;
  const PetscReal *w = frame->rate, *c = frame->center, r[DIM] = {x[0] - c[0], x[1] - c[1], x[2] - c[2]};

  for (PetscInt d = 0; d < domain->dim; d++) g[d] += Dot(w, w) * r[d] - Dot(w, r) * w[d];
}

static PetscBool Varies(const void *data)
{
  return (PetscBool)(Norm(((const Frame *)data)->rate) > 0);
}

static PetscReal Potential(Domain domain, const void *data, const PetscReal x[DIM])
{
  PetscReal g[DIM] = {0, 0, 0}, energy = 0;

  Add(domain, data, x, g);
  for (PetscInt d = 0; d < DIM; d++) energy -= 0.5 * g[d] * (x[d] - ((const Frame *)data)->center[d]);
  return energy;
}

PetscErrorCode FrameView(Scene scene, PetscViewer viewer)
{
  PetscFunctionBegin;
  if (SceneFrameTurns(scene)) {
    const PetscReal *w = scene->frame->rate, *c = scene->frame->center;

    PetscCall(PetscViewerASCIIPrintf(viewer, "in a frame that rotates with %g, %g, %g rad/s about %g, %g, %g m\n",
                                     (double)w[0], (double)w[1], (double)w[2], (double)c[0], (double)c[1],
                                     (double)c[2]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

const ForceOps ForceFrame = {
  .size = sizeof(Frame), .rows = rows, .check = Check, .add = Add, .varies = Varies, .potential = Potential};
