/* Free bodies in a step. Pressure and bodies' velocities are solved together (pressure/coupling.c):

     U* = U + dt/M (M g + viscous force + excess)      the velocity that their dummy particles have in the projection
     U' = U* + dt/M times the force of the equation

   The force of the equation, a sum over the pairs of liquid and dummy particles, has an error of some percent of a
   pressure that acts on one side only: a box would float 0.3 spacings too deep. The momentum that the pressure takes
   from the liquid near the body (OperatorsWallForce) is exact, but noisy, and unstable for a light body. So the body
   gets the excess of this force over that of the equation later, spread over the time in which density errors are
   corrected. The momentum of body and liquid together is conserved. */
#include "stepper_impl.h"

/* F and the torque about the centre (N, N m) on each body, after StepKick: the momentum that the liquid loses to its
   dummy particles; zero without liquid in their reach. In a periodic box a single body takes up all momentum that the
   liquid loses, to the last digit. */
static PetscErrorCode Balance(Stepper stepper, PetscReal dt, PetscReal force[])
{
  Cloud            cloud = stepper->cloud;
  const PetscReal *v = cloud->field[FIELD_VELOCITY_NEW], *v_star = cloud->field[FIELD_VELOCITY_STAR];
  PetscBool        alone = (PetscBool)(SceneSolidCount(cloud->scene) == 1);
  PetscReal       *each;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, DIM, &each));
  PetscCall(OperatorsWallForce(cloud, PressureGradientCorrected(stepper->pressure), each));
  PetscCall(FreeSum(cloud, each, cloud->solid_normal, force));
  PetscCall(CloudRestoreWork(cloud, &each));
  for (PetscInt d = 0; d < cloud->domain->dim; d++)
    alone = (PetscBool)(alone && cloud->domain->face[d][0] == FACE_PERIODIC);
  if (!alone) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt d = 0; d < DIM; d++) force[d] = 0;
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++)
    force[k % DIM] -= cloud->volume[k / DIM] * cloud->rest_density[k / DIM] / dt * (v[k] - v_star[k]);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, force, DIM, MPIU_REAL, MPIU_SUM, cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the impulse of the body force in dt (s) to 'impulse' (N s, N m s). */
static void AddWeight(Scene scene, Body solid, PetscReal dt, PetscReal impulse[FREE_MOTIONS])
{
  PetscReal center[DIM], motion[FREE_MOTIONS], g[DIM];

  FreeMotion(solid, center, motion);
  SceneAcceleration(scene, center, g);
  for (PetscInt d = 0; d < DIM; d++) impulse[d] += dt * BodyMass(solid) * g[d];
}

static PetscErrorCode Predict(Stepper stepper, PetscReal dt)
{
  Cloud cloud = stepper->cloud;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < SceneSolidCount(cloud->scene); b++) {
    const Body solid = SceneSolid(cloud->scene, b);
    PetscReal  center[DIM], motion[FREE_MOTIONS], impulse[FREE_MOTIONS], change[FREE_MOTIONS], *force, *excess;

    if (BodyMass(solid) == 0) continue;
    FreeForces(solid, &force, &excess);
    FreeMotion(solid, center, motion);
    for (PetscInt k = 0; k < FREE_MOTIONS; k++)
      impulse[k] = dt * (FreeDataOf(stepper)->drag[FREE_MOTIONS * b + k] + excess[k]);
    AddWeight(cloud->scene, solid, dt, impulse);
    FreeResponse(solid, impulse, change);
    for (PetscInt k = 0; k < FREE_MOTIONS; k++) motion[k] += change[k];
    FreeSetVelocities(cloud, b, motion, cloud->field[FIELD_VELOCITY_STAR]);
  }
  PetscCall(CloudUpdate(cloud, FIELD_VELOCITY_STAR));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The share of a body's excess that the body gets in a step. */
static PetscReal ExcessShare(Stepper stepper, PetscReal dt)
{
  return 1 - PetscExpReal(-dt / PressureRelaxationTime(stepper->pressure));
}

/* Adds the impulses of WallGuard to the excess of free bodies. */
static PetscErrorCode Guard(Stepper stepper, PetscReal dt, const PetscReal impulse[], StepTrial *trial)
{
  const Scene     scene = stepper->cloud->scene;
  const PetscReal share = ExcessShare(stepper, dt) / dt;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < SceneSolidCount(scene); b++) {
    PetscReal *force, *excess;

    if (BodyMass(SceneSolid(scene, b)) == 0) continue;
    FreeForces(SceneSolid(scene, b), &force, &excess);
    for (PetscInt k = 0; k < FREE_MOTIONS; k++) excess[k] += share * impulse[FREE_MOTIONS * b + k];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the new velocities of free bodies; adds their work on the fluid to the trial. */
static PetscErrorCode Kick(Stepper stepper, PetscReal dt, StepTrial *trial)
{
  Cloud           cloud = stepper->cloud;
  const PetscReal share = ExcessShare(stepper, dt);
  PetscReal   equation[FREE_MOTIONS * SCENE_MAX_BODIES], *pair_sum = equation, balance[FREE_MOTIONS * SCENE_MAX_BODIES];
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(cloud->comm, &rank));
  PetscCall(PressureFreeForces(stepper->pressure, equation));
  PetscCall(Balance(stepper, dt, balance));
  for (PetscInt b = 0; b < SceneSolidCount(cloud->scene); b++) {
    const Body solid = SceneSolid(cloud->scene, b);
    PetscReal  center[DIM], before[FREE_MOTIONS], after[FREE_MOTIONS], impulse[FREE_MOTIONS], *force, *excess;

    if (BodyMass(solid) == 0) continue;
    FreeForces(solid, &force, &excess);
    FreeMotion(solid, center, before);
    for (PetscInt k = 0; k < FREE_MOTIONS; k++) {
      force[k]   = pair_sum[k] + excess[k];
      impulse[k] = dt * (FreeDataOf(stepper)->drag[FREE_MOTIONS * b + k] + force[k]);
      excess[k] += share * (balance[FREE_MOTIONS * b + k] - force[k]);
    }
    AddWeight(cloud->scene, solid, dt, impulse);
    FreePush(solid, stepper->time + 0.5 * dt, impulse);
    FreeMotion(solid, center, after);
    for (PetscInt k = 0; k < FREE_MOTIONS && !rank; k++)
      trial->sum[SUM_SOLID_WORK] -= 0.5 * dt * force[k] * (before[k] + after[k]);
    pair_sum += FREE_MOTIONS;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The energy of the bodies. The budget is that of the liquid: the energy that the bodies took is in the work of the
   pressure of solids that move and in the work of viscosity. */
static PetscErrorCode Report(Scene scene, const void *numbers, PetscReal copies, const char joule[], char text[],
                             size_t length)
{
  PetscReal kinetic = 0, potential = 0;

  PetscFunctionBegin;
  if (!SceneHasFree(scene)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < SceneSolidCount(scene); b++) {
    const Body solid = SceneSolid(scene, b);
    PetscReal  center[DIM], motion[FREE_MOTIONS];

    if (BodyMass(solid) == 0) continue;
    FreeMotion(solid, center, motion);
    kinetic += FreeKinetic(solid);
    potential += BodyMass(solid) * SceneForcePotential(scene, center);
  }
  PetscCall(PetscSNPrintf(text, length,
                          "  solids      those with a mass: kinetic %.4g, potential %.4g %s, not part of the liquid's "
                          "energy below\n",
                          (double)kinetic, (double)potential, joule));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool On(Stepper stepper)
{
  return SceneHasFree(stepper->cloud->scene);
}

const StepHooks FreeHooks = {.name      = FREE_EDGE,
                             .on        = On,
                             .data_size = sizeof(FreeData),
                             .hold      = FreeViscousHold,
                             .follow    = FreeViscousFollow,
                             .drag      = FreeViscousDrag,
                             .predict   = Predict,
                             .kick      = Kick,
                             .guard     = Guard,
                             .report    = Report};
