/* Free bodies in a step. Their velocity is one with the pressure, in whose equation they are (pressure/coupling.c):

     U* = U + dt/M (M g + viscous force + excess)      the velocity that their dummy particles have in the projection
     U' = U* + dt/M times the force of the equation

   The force of the equation, a sum over the pairs of liquid and dummy particles, is wrong by some per cent of a
   pressure that acts on one side only: a box would float 0.3 spacings too deep. The balance of the liquid's momentum
   around the body (Balance) is right, but rough, and unstable where the body is light. So the excess of the balance
   over the equation is given to the body too, spread over the time in which the density is repaired. What is given late
   is not lost: body and liquid keep the momentum they have together. */
#include "stepper_impl.h"

#define CLOSEST 1e-3 /* spacings: a receiver of forces is not taken for closer */
#define REACH   2.5  /* extents of a body: how far its balance looks */

/* Weight 1/s^2 and its gradient (1/m^3) of a distance s (m), whose gradient is n. */
static void AddWeight(PetscReal s, const PetscReal n[DIM], PetscReal least, PetscReal *weight, PetscReal slope[DIM])
{
  const PetscReal own = 1 / PetscSqr(PetscMax(s, least));

  *weight += own;
  for (PetscInt d = 0; d < DIM; d++) slope[d] -= s > least ? 2 * own / s * n[d] : 0;
}

/* That of a solid, of its nearest image where the box is periodic: else the weight would jump across the box. */
static void AddSolid(Cloud cloud, Body solid, const PetscReal x[DIM], PetscReal *weight, PetscReal slope[DIM])
{
  const PetscReal step   = 0.1 * cloud->domain->spacing;
  PetscReal       n[DIM] = {0, 0, 0}, y[DIM];
  const PetscReal s      = BodyNearest(solid, x, y);

  for (PetscInt d = 0; d < cloud->domain->dim; d++) {
    PetscReal low[DIM] = {y[0], y[1], y[2]}, high[DIM] = {y[0], y[1], y[2]};

    low[d] -= step;
    high[d] += step;
    n[d] = (BodyDistance(solid, high) - BodyDistance(solid, low)) / (2 * step);
  }
  AddWeight(s, n, CLOSEST * cloud->domain->spacing, weight, slope);
}

static void AddFaces(Cloud cloud, const PetscReal x[DIM], PetscReal *weight, PetscReal slope[DIM])
{
  const Domain domain = cloud->domain;

  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt side = 0; side < 2; side++) {
      const PetscReal n[DIM] = {(side ? -1 : 1) * (d == 0), (side ? -1 : 1) * (d == 1), (side ? -1 : 1) * (d == 2)};

      if (domain->face[d][side] != FACE_WALL) continue;
      AddWeight(side ? domain->upper[d] - x[d] : x[d] - domain->lower[d], n, CLOSEST * domain->spacing, weight, slope);
    }
}

/* The weight (1/m2) of what is far away. There is none where nothing but the body can take up momentum: in a box that
   is periodic all around. */
static PetscReal FarWeight(Cloud cloud, Body solid)
{
  const Domain domain = cloud->domain;
  PetscBool    alone  = (PetscBool)(SceneSolidCount(cloud->scene) == 1);
  PetscReal    lower[DIM], upper[DIM], extent = 0;

  BodyBounds(solid, lower, upper);
  for (PetscInt d = 0; d < domain->dim; d++) {
    extent = PetscMax(extent, upper[d] - lower[d]);
    alone  = (PetscBool)(alone && domain->face[d][0] == FACE_PERIODIC);
  }
  return alone ? 0 : 1 / PetscSqr(REACH * extent);
}

/* The share phi of a body in what holds the liquid at x (m), and its gradient (1/m): 1 at the body's surface, 0 at that
   of all other solids and walls and far away. */
static PetscReal Share(Cloud cloud, Body solid, PetscReal far, const PetscReal x[DIM], PetscReal gradient[DIM])
{
  PetscReal own = 0, own_slope[DIM] = {0, 0, 0}, others = far, slope[DIM] = {0, 0, 0};

  AddSolid(cloud, solid, x, &own, own_slope);
  AddFaces(cloud, x, &others, slope);
  for (PetscInt b = 0; b < SceneSolidCount(cloud->scene); b++)
    if (SceneSolid(cloud->scene, b) != solid) AddSolid(cloud, SceneSolid(cloud->scene, b), x, &others, slope);
  for (PetscInt d = 0; d < DIM; d++) gradient[d] = (own_slope[d] * others - own * slope[d]) / PetscSqr(own + others);
  return own / (own + others);
}

/* F and the torque about the centre (N, N m) on a body, after StepKick: over its surface phi = 1, so that

     F = integral of p n dA = sum over the liquid of V grad (phi p) = sum of V p grad phi - phi m a,

   a the acceleration of the liquid by the pressure, n out of the liquid; in a box that is periodic all around phi is 1,
   and the body gets exactly what the liquid loses. On a free surface p is the pressure of tension, which does not push
   the body: what the sum has of it is taken out. */
static PetscErrorCode Balance(Stepper stepper, PetscReal dt, Body solid, PetscReal force[FREE_MOTIONS])
{
  Cloud            cloud = stepper->cloud;
  const PetscReal *v = cloud->field[FIELD_VELOCITY_NEW], *v_star = cloud->field[FIELD_VELOCITY_STAR];
  const PetscReal  far = FarWeight(cloud, solid);
  PetscReal        center[DIM], motion[FREE_MOTIONS];

  PetscFunctionBegin;
  FreeMotion(solid, center, motion);
  for (PetscInt k = 0; k < FREE_MOTIONS; k++) force[k] = 0;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, *n = cloud->field[FIELD_NORMAL] + DIM * a,
                    V = cloud->volume[a], p = cloud->field[FIELD_PRESSURE][a],
                    capillary = cloud->integer[INT_SURFACE][a] ? 2 * cloud->field[FIELD_CAPILLARY][a] : 0;
    PetscReal       gradient[DIM], arm[DIM], own[DIM], torque[DIM];
    const PetscReal share = Share(cloud, solid, far, x, gradient);

    for (PetscInt d = 0; d < DIM; d++) {
      own[d] = V * (p * gradient[d] + share * capillary * n[d] -
                    share * cloud->rest_density[a] / dt * (v[DIM * a + d] - v_star[DIM * a + d]));
      arm[d] = x[d] - center[d];
    }
    DomainNearest(cloud->domain, arm);
    Cross(arm, own, torque);
    for (PetscInt d = 0; d < DIM; d++) {
      force[d] += own[d];
      force[DIM + d] += torque[d];
    }
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, force, FREE_MOTIONS, MPIU_REAL, MPIU_SUM, cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds to an impulse (N s, N m s) that of the body force in dt (s). */
static void AddWeightOf(Scene scene, Body solid, PetscReal dt, PetscReal impulse[FREE_MOTIONS])
{
  PetscReal center[DIM], motion[FREE_MOTIONS], g[DIM];

  FreeMotion(solid, center, motion);
  SceneAcceleration(scene, center, g);
  for (PetscInt d = 0; d < DIM; d++) impulse[d] += dt * BodyMass(solid) * g[d];
}

PetscErrorCode FreePredict(Stepper stepper, PetscReal dt)
{
  Cloud cloud = stepper->cloud;

  PetscFunctionBegin;
  if (!SceneHasFree(cloud->scene)) PetscFunctionReturn(PETSC_SUCCESS);
  if (!stepper->viscous.implicit) PetscCall(FreeDrag(stepper, cloud->field[FIELD_VELOCITY], stepper->free_drag));
  for (PetscInt b = 0; b < SceneSolidCount(cloud->scene); b++) {
    const Body solid = SceneSolid(cloud->scene, b);
    PetscReal  center[DIM], motion[FREE_MOTIONS], impulse[FREE_MOTIONS], change[FREE_MOTIONS], *force, *excess;

    if (BodyMass(solid) == 0) continue;
    FreeForces(solid, &force, &excess);
    FreeMotion(solid, center, motion);
    for (PetscInt k = 0; k < FREE_MOTIONS; k++)
      impulse[k] = dt * (stepper->free_drag[FREE_MOTIONS * b + k] + excess[k]);
    AddWeightOf(cloud->scene, solid, dt, impulse);
    FreeResponse(solid, impulse, change);
    for (PetscInt k = 0; k < FREE_MOTIONS; k++) motion[k] += change[k];
    FreeSetVelocities(cloud, b, motion, cloud->field[FIELD_VELOCITY_STAR]);
  }
  PetscCall(CloudUpdate(cloud, FIELD_VELOCITY_STAR));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FreeKick(Stepper stepper, PetscReal dt, StepTrial *trial)
{
  Cloud           cloud = stepper->cloud;
  const PetscReal soon  = 1 - PetscExpReal(-dt / PressureRelaxationTime(stepper->pressure));
  PetscReal       equation[FREE_MOTIONS * SCENE_MAX_BODIES], *push = equation;
  PetscMPIInt     rank;

  PetscFunctionBegin;
  if (!SceneHasFree(cloud->scene)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Comm_rank(cloud->comm, &rank));
  PetscCall(PressureFreeForces(stepper->pressure, equation));
  for (PetscInt b = 0; b < SceneSolidCount(cloud->scene); b++) {
    const Body solid = SceneSolid(cloud->scene, b);
    PetscReal  center[DIM], before[FREE_MOTIONS], after[FREE_MOTIONS], balance[FREE_MOTIONS], impulse[FREE_MOTIONS],
      *force, *excess;

    if (BodyMass(solid) == 0) continue;
    FreeForces(solid, &force, &excess);
    FreeMotion(solid, center, before);
    PetscCall(Balance(stepper, dt, solid, balance));
    for (PetscInt k = 0; k < FREE_MOTIONS; k++) {
      force[k]   = push[k] + excess[k];
      impulse[k] = dt * (stepper->free_drag[FREE_MOTIONS * b + k] + force[k]);
      excess[k] += soon * (balance[k] - force[k]);
    }
    AddWeightOf(cloud->scene, solid, dt, impulse);
    FreePush(solid, stepper->time + 0.5 * dt, impulse);
    FreeMotion(solid, center, after);
    for (PetscInt k = 0; k < FREE_MOTIONS && !rank; k++)
      trial->sum[SUM_SOLID_WORK] -= 0.5 * dt * force[k] * (before[k] + after[k]);
    push += FREE_MOTIONS;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
