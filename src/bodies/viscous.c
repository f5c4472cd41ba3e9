/* Viscosity on free bodies. In an implicit step a body follows the drag within the solve; an explicit drag would be
   unstable in very viscous liquid. With the body's velocity U, its inertia M, the drag f on the body at rest and the
   drag -C U of its own velocity,

     U = U_0 + dt/M (f - C U),

   which each application of the liquid's operator solves for its f. */
#include "bodies_impl.h"

void FreeSetVelocities(Cloud cloud, PetscInt solid, const PetscReal motion[RIGID_MOTIONS], PetscReal velocity[])
{
  PetscReal center[DIM], now[RIGID_MOTIONS];

  FreeMotion(SceneSolid(cloud->scene, solid), center, now);
  for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++) {
    const PetscReal *x        = cloud->field[FIELD_POSITION] + DIM * a;
    const PetscReal  arm[DIM] = {x[0] - center[0], x[1] - center[1], x[2] - center[2]};

    if (cloud->integer[INT_BODY][a] != BODY_SOLID - solid) continue;
    Cross(motion + DIM, arm, velocity + DIM * a);
    for (PetscInt d = 0; d < DIM; d++) velocity[DIM * a + d] += motion[d];
  }
}

PetscErrorCode FreeSum(Cloud cloud, const PetscReal each[], const PetscReal normal[], PetscReal sum[])
{
  const PetscInt solids = SceneSolidCount(cloud->scene);

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(sum, RIGID_MOTIONS * solids));
  for (PetscInt b = cloud->n_fluid; b < cloud->n_total; b++) {
    const PetscInt solid = BODY_SOLID - cloud->integer[INT_BODY][b];

    if (!cloud->integer[INT_LAYER][b] || solid < 0 || BodyMass(SceneSolid(cloud->scene, solid)) == 0) continue;
    FreeAddForce(SceneSolid(cloud->scene, solid), cloud->field[FIELD_POSITION] + DIM * b, each + DIM * b,
                 normal ? normal + DIM * b : NULL, sum + RIGID_MOTIONS * solid);
  }
  PetscCallMPI(
    MPI_Allreduce(MPI_IN_PLACE, sum, (PetscMPIInt)(RIGID_MOTIONS * solids), MPIU_REAL, MPIU_SUM, cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* drag[solids][RIGID_MOTIONS]: viscous force and torque (N, N m) on each free solid at these velocities ([n_total][3],
   m/s); 0 for other solids. load: with StepperLoad. */
static PetscErrorCode Drag(const Step *step, const PetscReal velocity[], PetscBool load, PetscReal drag[])
{
  Cloud      cloud = step->cloud;
  PetscReal *each;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, DIM, &each));
  PetscCall(OperatorsWallDrag(cloud, StepperViscosity(step->stepper), velocity, each));
  if (load) PetscCall(StepperLoad(step->stepper, each));
  PetscCall(FreeSum(cloud, each, NULL, drag));
  PetscCall(CloudRestoreWork(cloud, &each));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The inverse of 1 + dt/M C of each body; C is the drag at each unit motion of the body. */
PetscErrorCode FreeViscousHold(const Step *step)
{
  Cloud          cloud  = step->cloud;
  const PetscInt solids = SceneSolidCount(cloud->scene);
  PetscReal     *u, drag[RIGID_MOTIONS * SCENE_MAX_BODIES];

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, DIM, &u));
  for (PetscInt k = 0; k < RIGID_MOTIONS; k++) {
    PetscReal motion[RIGID_MOTIONS] = {0, 0, 0, 0, 0, 0};

    motion[k] = 1;
    PetscCall(PetscArrayzero(u, DIM * cloud->n_total));
    for (PetscInt b = 0; b < solids; b++)
      if (BodyMass(SceneSolid(cloud->scene, b)) > 0) FreeSetVelocities(cloud, b, motion, u);
    PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, u));
    PetscCall(Drag(step, u, PETSC_FALSE, drag));
    for (PetscInt b = 0; b < solids; b++) {
      PetscReal *matrix = ((FreeData *)step->own)->follow + RIGID_MOTIONS * RIGID_MOTIONS * b, change[RIGID_MOTIONS];

      if (BodyMass(SceneSolid(cloud->scene, b)) == 0) continue;
      FreeResponse(SceneSolid(cloud->scene, b), drag + RIGID_MOTIONS * b, change);
      for (PetscInt i = 0; i < RIGID_MOTIONS; i++) matrix[RIGID_MOTIONS * i + k] = (i == k) - step->dt * change[i];
    }
  }
  PetscCall(CloudRestoreWork(cloud, &u));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x = A^-1 x by elimination; A is the identity plus the product of two positive matrices, and needs no pivots. */
static void Solve(const PetscReal A[RIGID_MOTIONS * RIGID_MOTIONS], PetscReal x[RIGID_MOTIONS])
{
  PetscReal m[RIGID_MOTIONS][RIGID_MOTIONS];

  for (PetscInt i = 0; i < RIGID_MOTIONS; i++)
    for (PetscInt j = 0; j < RIGID_MOTIONS; j++) m[i][j] = A[RIGID_MOTIONS * i + j];
  for (PetscInt k = 0; k < RIGID_MOTIONS; k++)
    for (PetscInt i = k + 1; i < RIGID_MOTIONS; i++) {
      const PetscReal factor = m[i][k] / m[k][k];

      for (PetscInt j = k; j < RIGID_MOTIONS; j++) m[i][j] -= factor * m[k][j];
      x[i] -= factor * x[k];
    }
  for (PetscInt i = RIGID_MOTIONS - 1; i >= 0; i--) {
    for (PetscInt j = i + 1; j < RIGID_MOTIONS; j++) x[i] -= m[i][j] * x[j];
    x[i] /= m[i][i];
  }
}

PetscErrorCode FreeViscousFollow(const Step *step, PetscBool own, PetscReal u[])
{
  Cloud           cloud               = step->cloud;
  const PetscReal rest[RIGID_MOTIONS] = {0, 0, 0, 0, 0, 0};
  PetscReal       drag[RIGID_MOTIONS * SCENE_MAX_BODIES];

  PetscFunctionBegin;
  for (PetscInt b = 0; b < SceneSolidCount(cloud->scene); b++)
    if (BodyMass(SceneSolid(cloud->scene, b)) > 0) FreeSetVelocities(cloud, b, rest, u);
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, u));
  PetscCall(Drag(step, u, own, drag));
  for (PetscInt b = 0; b < SceneSolidCount(cloud->scene); b++) {
    const Body solid = SceneSolid(cloud->scene, b);
    PetscReal  center[DIM], start[RIGID_MOTIONS], impulse[RIGID_MOTIONS], motion[RIGID_MOTIONS], change[RIGID_MOTIONS],
      g[DIM], *force, *excess;

    if (BodyMass(solid) == 0) continue;
    FreeMotion(solid, center, start);
    FreeForces(solid, &force, &excess);
    SceneAcceleration(cloud->scene, center, g);
    for (PetscInt k = 0; k < RIGID_MOTIONS; k++) {
      impulse[k] = step->dt * drag[RIGID_MOTIONS * b + k];
      if (own) impulse[k] += step->dt * (force[k] + (k < DIM ? BodyMass(solid) * g[k] : 0));
    }
    FreeResponse(solid, impulse, change);
    for (PetscInt k = 0; k < RIGID_MOTIONS; k++) motion[k] = (own ? start[k] : 0) + change[k];
    Solve(((FreeData *)step->own)->follow + RIGID_MOTIONS * RIGID_MOTIONS * b, motion);
    FreeSetVelocities(cloud, b, motion, u);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FreeViscousDrag(const Step *step, const PetscReal velocity[])
{
  PetscFunctionBegin;
  PetscCall(Drag(step, velocity, PETSC_TRUE, ((FreeData *)step->own)->drag));
  PetscFunctionReturn(PETSC_SUCCESS);
}
