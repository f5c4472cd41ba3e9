/* Free bodies in a step. Pressure and bodies' velocities are solved together (coupling.c):

     U* = U + dt/M (M g + viscous force + excess) + contacts (contact.c)
                                                       the velocity that their dummy particles have in the projection
     U' = U* + dt/M times the force of the equation

   Contacts hold the motion that a body would have with the force of the equation of the step before: with none, water
   on one of two boxes that lie on the floor pressed it 0.6 spacings into the other, in every step anew.

   The force of the equation, a sum over the pairs of liquid and dummy particles, has an error of some percent of a
   pressure that acts on one side only: a box would float 0.3 spacings too deep. The momentum that the pressure takes
   from the liquid near the body (OperatorsWallForce) is exact, but noisy, and unstable for a light body. So the body
   gets the excess of this force over that of the equation later, spread over the time in which density errors are
   corrected. The momentum of body and liquid together is conserved. */
#include "bodies_impl.h"

/* F and the torque about the centre (N, N m) on each body, after StepKick: the momentum that the liquid loses to its
   dummy particles, and the force of gas on them. In a periodic box a single body takes up all momentum that the
   liquid loses, to the last digit. */
static PetscErrorCode Balance(const Step *step, PetscReal force[])
{
  Cloud            cloud = step->cloud;
  const PetscReal *v = cloud->field[FIELD_VELOCITY_NEW], *v_star = cloud->field[FIELD_VELOCITY_STAR];
  PetscBool        alone = (PetscBool)(SceneSolidCount(cloud->scene) == 1);
  PetscReal       *each;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, DIM, &each));
  PetscCall(OperatorsWallForce(cloud, PressureGradientCorrected(step->pressure), each));
  PetscCall(PressureLoad(step->pressure, each));
  PetscCall(FreeSum(cloud, each, cloud->solid_normal, force));
  PetscCall(CloudRestoreWork(cloud, &each));
  for (PetscInt d = 0; d < cloud->domain->dim; d++)
    alone = (PetscBool)(alone && cloud->domain->face[d][0] == FACE_PERIODIC);
  if (!alone) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt d = 0; d < DIM; d++) force[d] = 0;
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++)
    force[k % DIM] -= cloud->volume[k / DIM] * cloud->rest_density[k / DIM] / step->dt * (v[k] - v_star[k]);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, force, DIM, MPIU_REAL, MPIU_SUM, cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the impulse of the body force in dt (s) to 'impulse' (N s, N m s). */
static void AddWeight(Scene scene, Body solid, PetscReal dt, PetscReal impulse[RIGID_MOTIONS])
{
  PetscReal center[DIM], motion[RIGID_MOTIONS], g[DIM];

  FreeMotion(solid, center, motion);
  SceneAcceleration(scene, center, g);
  for (PetscInt d = 0; d < DIM; d++) impulse[d] += dt * BodyMass(solid) * g[d];
}

/* The motion that a free body has without contacts at the end of a step: before the pressure acts, or with the force
   that the pressure of the step before had on it. */
static void Pushed(const Step *step, PetscInt solid, PetscBool pressed, PetscReal motion[RIGID_MOTIONS])
{
  const Body      body = SceneSolid(step->scene, solid);
  const FreeData *data = (const FreeData *)step->own;
  PetscReal       center[DIM], impulse[RIGID_MOTIONS], change[RIGID_MOTIONS], *force, *excess;

  FreeForces(body, &force, &excess);
  FreeMotion(body, center, motion);
  for (PetscInt k = 0; k < RIGID_MOTIONS; k++)
    impulse[k] = step->dt * (data->drag[RIGID_MOTIONS * solid + k] + (pressed ? force[k] : excess[k]));
  AddWeight(step->scene, body, step->dt, impulse);
  FreeResponse(body, impulse, change);
  for (PetscInt k = 0; k < RIGID_MOTIONS; k++) motion[k] += change[k];
}

static PetscErrorCode Predict(const Step *step)
{
  const PetscReal dt                                       = step->dt;
  Cloud           cloud                                    = step->cloud;
  FreeData       *data                                     = (FreeData *)step->own;
  PetscReal       before[RIGID_MOTIONS * SCENE_MAX_BODIES] = {0}, motions[RIGID_MOTIONS * SCENE_MAX_BODIES] = {0};

  PetscFunctionBegin;
  for (PetscInt b = 0; b < SceneSolidCount(cloud->scene); b++) {
    const Body solid = SceneSolid(cloud->scene, b);

    PetscReal center[DIM];

    if (BodyMass(solid) == 0) continue;
    FreeMotion(solid, center, before + RIGID_MOTIONS * b);
    Pushed(step, b, PETSC_TRUE, motions + RIGID_MOTIONS * b);
  }
  PetscCall(FreeTouch(cloud, step->time + dt, dt, step->usual, PressureRelaxationTime(step->pressure), before, motions,
                      data->contact, &data->hit));
  for (PetscInt b = 0; b < SceneSolidCount(cloud->scene); b++) {
    const Body solid  = SceneSolid(cloud->scene, b);
    PetscReal *motion = motions + RIGID_MOTIONS * b, change[RIGID_MOTIONS];

    if (BodyMass(solid) == 0) continue;
    Pushed(step, b, PETSC_FALSE, motion);
    FreeResponse(solid, data->contact + RIGID_MOTIONS * b, change);
    for (PetscInt k = 0; k < RIGID_MOTIONS; k++) motion[k] += change[k];
    FreeSetVelocities(cloud, b, motion, cloud->field[FIELD_VELOCITY_STAR]);
  }
  PetscCall(CloudUpdate(cloud, FIELD_VELOCITY_STAR));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The share of a body's excess that the body gets in a step. */
static PetscReal ExcessShare(const Step *step)
{
  return 1 - PetscExpReal(-step->dt / PressureRelaxationTime(step->pressure));
}

static PetscErrorCode Push(const Step *step, PetscInt solid, const PetscReal x[DIM], const PetscReal momentum[DIM])
{
  const Body body = SceneSolid(step->scene, solid);

  PetscFunctionBegin;
  if (BodyMass(body) > 0)
    FreeAddForce(body, x, momentum, NULL, ((FreeData *)step->own)->impulse + RIGID_MOTIONS * solid);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the impulses of the particles that were kept out to the excess of free bodies. */
static PetscErrorCode Guard(const Step *step)
{
  const Scene     scene   = step->scene;
  const PetscInt  solids  = SceneSolidCount(scene);
  const PetscReal share   = ExcessShare(step) / step->dt;
  PetscReal      *impulse = ((FreeData *)step->own)->impulse;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, impulse, (PetscMPIInt)(RIGID_MOTIONS * solids), MPIU_REAL, MPIU_SUM,
                             step->cloud->comm));
  for (PetscInt b = 0; b < solids; b++) {
    PetscReal *force, *excess;

    if (BodyMass(SceneSolid(scene, b)) == 0) continue;
    FreeForces(SceneSolid(scene, b), &force, &excess);
    for (PetscInt k = 0; k < RIGID_MOTIONS; k++) excess[k] += share * impulse[RIGID_MOTIONS * b + k];
  }
  PetscCall(PetscArrayzero(impulse, RIGID_MOTIONS * solids));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the new velocities of free bodies; adds their work on the fluid to the trial. */
static PetscErrorCode Kick(const Step *step)
{
  Cloud           cloud = step->cloud;
  FreeData       *data  = (FreeData *)step->own;
  const PetscReal dt = step->dt, share                            = ExcessShare(step);
  PetscReal equation[RIGID_MOTIONS * SCENE_MAX_BODIES], *pair_sum = equation, balance[RIGID_MOTIONS * SCENE_MAX_BODIES];
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(cloud->comm, &rank));
  PetscCall(CouplingForces(data, step->pressure, equation));
  PetscCall(Balance(step, balance));
  for (PetscInt b = 0; b < SceneSolidCount(cloud->scene); b++) {
    const Body solid = SceneSolid(cloud->scene, b);
    PetscReal  center[DIM], before[RIGID_MOTIONS], after[RIGID_MOTIONS], impulse[RIGID_MOTIONS], *force, *excess;

    if (BodyMass(solid) == 0) continue;
    FreeForces(solid, &force, &excess);
    FreeMotion(solid, center, before);
    for (PetscInt k = 0; k < RIGID_MOTIONS; k++) {
      force[k]   = pair_sum[k] + excess[k];
      impulse[k] = dt * (data->drag[RIGID_MOTIONS * b + k] + force[k]);
      excess[k] += share * (balance[RIGID_MOTIONS * b + k] - force[k]);
    }
    AddWeight(cloud->scene, solid, dt, impulse);
    for (PetscInt k = 0; k < RIGID_MOTIONS; k++) impulse[k] += data->contact[RIGID_MOTIONS * b + k];
    FreePush(solid, step->time + 0.5 * dt, impulse);
    FreeMotion(solid, center, after);
    for (PetscInt k = 0; k < RIGID_MOTIONS && !rank; k++)
      step->trial->sum[SUM_SOLID_WORK] -= 0.5 * dt * force[k] * (before[k] + after[k]);
    pair_sum += RIGID_MOTIONS;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A body that two others hit at once. */
static PetscErrorCode Doubt(const Step *step, char text[], size_t length)
{
  const Scene        scene = step->scene;
  FreeData          *data  = (FreeData *)step->own;
  const HitTogether *hit   = &data->hit;
  const char        *by[2];

  PetscFunctionBegin;
  if (!hit->seen) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < 2; k++) by[k] = hit->by[k] < 0 ? "a wall" : BodyName(SceneSolid(scene, hit->by[k]));
  PetscCall(PetscSNPrintf(text, length,
                          "%s is between %s and %s in a hit: its impulses act at once, so a row of balls shares the "
                          "momentum, which real ones hand on from one to the next; leave a gap between them",
                          BodyName(SceneSolid(scene, hit->body)), by[0], by[1]));
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
    PetscReal  center[DIM], motion[RIGID_MOTIONS];

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

static PetscBool On(const Step *step)
{
  return SceneHasFree(step->scene);
}

/* The numbers of free body k, see FreeNumbers. */
static PetscReal *Numbers(Scene scene, void *numbers, PetscInt k, PetscInt *width)
{
  for (PetscInt b = 0; b < SceneSolidCount(scene); b++)
    if (BodyMass(SceneSolid(scene, b)) > 0 && k-- == 0) return FreeNumbers(SceneSolid(scene, b), width);
  return NULL;
}

static PetscErrorCode Freeze(const Step *step, PetscBool frozen)
{
  PetscFunctionBegin;
  SceneFreeze(step->scene, frozen);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Create(const Step *step)
{
  PetscFunctionBegin;
  PetscCall(CouplingCreate((FreeData *)step->own, step->cloud, step->pressure));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy(const Step *step)
{
  PetscFunctionBegin;
  PetscCall(CouplingDestroy((FreeData *)step->own));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define FREE "-<solid>_mass"

static PetscBool HasFree(Scene scene, Tension tension)
{
  return (PetscBool)(scene && SceneHasFree(scene));
}

static const char *Lopsided(Scene scene)
{
  return SceneHasFree(scene) ? "a free body" : NULL;
}

static const Feature features[] = {{FREE, HasFree}, {.name = NULL}};
static const Refusal refusals[] = {
  {FREE, NOT_WITH, FEATURE_DENSITIES, " yet"},
  {FREE, NOT_WITH, FEATURE_FRAME, " yet"},
  {"-ksp_type preonly", NOT_WITH, FREE,
   ": the body's part of the pressure equation is not in the preconditioner; -ksp_type cg can"},
  {"-ksp_type none", NOT_WITH, FREE,
   ": the body's part of the pressure equation is not in the preconditioner; -ksp_type cg can"},
  {FREE, NEEDS, FEATURE_DIVERGENCE, ", the default"},
  {.one = NULL},
};

const Edge FreeEdge = {.name      = "free",
                       .gauge     = &GaugeBodies,
                       .features  = features,
                       .refusals  = refusals,
                       .lopsided  = Lopsided,
                       .on        = On,
                       .create    = Create,
                       .destroy   = Destroy,
                       .data_size = sizeof(FreeData),
                       .table     = {"free_bodies",
                                     "of each solid with a mass: time, shift, turn, velocity, rate, spin, "
                                         "force, excess",
                                     Numbers},
                       .report    = Report,
                       .doubt     = Doubt,
                       .freeze    = Freeze,
                       .hold      = FreeViscousHold,
                       .follow    = FreeViscousFollow,
                       .drag      = FreeViscousDrag,
                       .predict   = Predict,
                       .kick      = Kick,
                       .push      = Push,
                       .guard     = Guard};
