/* Solids and walls that move. In a step from t to t + dt their dummy particles are, like the liquid, at their positions
   at t + dt/2, with their velocities at t + dt, the time of the liquid's new velocity. At the end of the step they move
   to their positions at t + dt. Positions depend on the time alone. */
#include "bodies_impl.h"

/* The moving solid of a dummy particle, or NULL. */
static Body MovingSolid(Scene scene, PetscInt body)
{
  const Body solid = body <= BODY_SOLID ? SceneSolid(scene, BODY_SOLID - body) : NULL;

  return solid && BodyMoves(solid) ? solid : NULL;
}

PetscErrorCode SolidsMove(Cloud cloud, PetscReal from, PetscReal to, PetscReal end)
{
  PetscFunctionBegin;
  SceneMoveSolids(cloud->scene, to);
  for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++) {
    const Body solid = MovingSolid(cloud->scene, cloud->integer[INT_BODY][a]);
    PetscReal *x     = cloud->field[FIELD_POSITION] + DIM * a, y[DIM];

    if (!solid) continue;
    BodyMove(solid, from, to, x);
    for (PetscInt d = 0; d < DIM; d++) y[d] = x[d];
    BodyMove(solid, to, end, y);
    BodyMotion(solid, end, y, cloud->field[FIELD_VELOCITY] + DIM * a);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Drift(const Step *step, PetscReal from, PetscReal to, PetscReal end, PetscBool *moved)
{
  PetscFunctionBegin;
  if (!SceneSolidsMove(step->scene)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SolidsMove(step->cloud, from, to, end));
  *moved = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The name of another solid, with another motion, in which x is deeper than a spacing; NULL: none. given: free bodies
   do not count. */
static const char *Inside(Scene scene, Body solid, PetscReal spacing, PetscBool given, const PetscReal x[DIM])
{
  for (PetscInt b = 0; b < SceneSolidCount(scene); b++)
    if ((!given || BodyMass(SceneSolid(scene, b)) == 0) && SceneSolid(scene, b) != solid &&
        !BodyMovesAs(SceneSolid(scene, b), solid) && BodyDistance(SceneSolid(scene, b), x) < -spacing)
      return BodyName(SceneSolid(scene, b));
  return NULL;
}

/* Refuses a step in which a solid would leave the box or enter another solid. */
static PetscErrorCode Check(const Step *step, PetscBool ahead, char why[], size_t length)
{
  const Cloud     cloud  = step->cloud;
  const Domain    domain = cloud->domain;
  const PetscReal from = step->time, to = from + step->dt;
  const Scene     scene = cloud->scene;
  ParticleArrays  arrays;
  PetscMPIInt     rank, own, first, size;

  PetscFunctionBegin;
  if (!SceneSolidsMove(scene)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Comm_rank(cloud->comm, &rank));
  PetscCallMPI(MPI_Comm_size(cloud->comm, &size));
  SceneMoveSolids(scene, to);
  PetscCall(ParticlesOpen(cloud->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n && !why[0]; a++) {
    const Body  solid = MovingSolid(scene, arrays.integer[INT_BODY][a]);
    PetscReal   x[DIM];
    const char *other, *face = NULL;

    if (!solid || (ahead && BodyMass(solid) > 0)) continue;
    for (PetscInt d = 0; d < DIM; d++) x[d] = arrays.real[FIELD_POSITION][DIM * a + d];
    BodyMove(solid, from, to, x);
    for (PetscInt d = 0; d < domain->dim; d++)
      if (x[d] < domain->lower[d] || x[d] > domain->upper[d]) face = FaceNames[d][x[d] > domain->upper[d]];
    other = Inside(scene, solid, domain->spacing, ahead, x);
    if (face) PetscCall(PetscSNPrintf(why, length, "the solid %s moves out of the box at %s", BodyName(solid), face));
    if (other) PetscCall(PetscSNPrintf(why, length, "the solid %s moves into the solid %s", BodyName(solid), other));
  }
  PetscCall(ParticlesClose(cloud->particles, &arrays));
  own = why[0] ? rank : size;
  PetscCallMPI(MPI_Allreduce(&own, &first, 1, MPI_INT, MPI_MIN, cloud->comm));
  if (first < size) PetscCallMPI(MPI_Bcast(why, (PetscMPIInt)length, MPI_CHAR, first, cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the work of friction done by walls and solids that move. */
static PetscErrorCode Drag(const Step *step, const PetscReal velocity[])
{
  Cloud      cloud = step->cloud;
  PetscReal *drag;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, DIM, &drag));
  PetscCall(OperatorsWallDrag(cloud, StepperViscosity(step->stepper), velocity, drag));
  PetscCall(StepperLoad(step->stepper, drag));
  for (PetscInt b = cloud->n_fluid; b < cloud->n_total; b++)
    if (cloud->integer[INT_LAYER][b])
      step->trial->sum[SUM_FRICTION_WORK] -= step->dt * Dot(drag + DIM * b, velocity + DIM * b);
  PetscCall(CloudRestoreWork(cloud, &drag));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The mean of the velocities (m/s, [n_total][3]) at the start and the end of the step, of solids that move, but not of
   free bodies (free.c), and what is beside them; before the first step they rest: what starts with a speed is brought
   to it. The cloud's positions are those in the middle. */
static PetscErrorCode MeanVelocities(const Step *step, PetscReal mean[])
{
  const Cloud     cloud  = step->cloud;
  const PetscReal middle = step->time + 0.5 * step->dt;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(mean, DIM * cloud->n_total));
  for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++) {
    const Body solid = MovingSolid(cloud->scene, cloud->integer[INT_BODY][a]);
    PetscReal  x[DIM], start[DIM] = {0, 0, 0};

    if (!solid || BodyMass(solid) > 0) continue;
    for (PetscInt d = 0; d < DIM; d++) x[d] = cloud->field[FIELD_POSITION][DIM * a + d];
    BodyMove(solid, middle, step->time, x);
    if (!step->first) BodyMotion(solid, step->time, x, start);
    for (PetscInt d = 0; d < DIM; d++) mean[DIM * a + d] = 0.5 * (start[d] + cloud->field[FIELD_VELOCITY][DIM * a + d]);
  }
  PetscCall(OperatorsBeside(cloud, mean));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the work of the pressure of solids that move. Its impulse takes the liquid from the velocities at the start to
   those at the end of the step, so it acts on their mean. With those at the end a paddle that swings gave 6 % too
   much, and one that starts with a speed twice what the liquid got. */
static PetscErrorCode Kick(const Step *step)
{
  const Cloud cloud = step->cloud;
  PetscReal  *force, *mean;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, DIM, &force));
  PetscCall(CloudGetWork(cloud, DIM, &mean));
  PetscCall(MeanVelocities(step, mean));
  PetscCall(OperatorsWallForce(cloud, PressureGradientCorrected(step->pressure), force));
  PetscCall(PressureLoad(step->pressure, force));
  for (PetscInt b = cloud->n_fluid; b < cloud->n_total; b++)
    step->trial->sum[SUM_SOLID_WORK] -= step->dt * Dot(force + DIM * b, mean + DIM * b);
  PetscCall(CloudRestoreWork(cloud, &mean));
  PetscCall(CloudRestoreWork(cloud, &force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Save(const Step *step)
{
  PetscFunctionBegin;
  SceneSave(step->scene);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Restore(const Step *step)
{
  PetscFunctionBegin;
  SceneRestore(step->scene);
  SceneMoveSolids(step->scene, step->time);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool Drives(const Step *step)
{
  return SceneSolidsMove(step->scene);
}

static PetscBool On(const Step *step)
{
  const Cloud cloud = step->cloud;

  return (PetscBool)(SceneSolidsMove(cloud->scene) || DomainWallSpeed(cloud->domain) != 0);
}

#define MOVING "a solid that moves"

static PetscBool Moves(Scene scene, Tension tension)
{
  return (PetscBool)(scene && SceneSolidsMove(scene));
}

static const Feature features[] = {{MOVING, Moves}, {.name = NULL}};
static const Refusal refusals[] = {
  {MOVING, NOT_WITH, FEATURE_FIXED, ": it would leave the fine region"},
  {MOVING, NEEDS, FEATURE_CONSISTENT, ", the default"},
  {MOVING, NEEDS, FEATURE_CENTERED, ", the default"},
  {.one = NULL},
};

const Edge MovingEdge = {.name     = "moving",
                         .features = features,
                         .refusals = refusals,
                         .on       = On,
                         .drives   = Drives,
                         .check    = Check,
                         .save     = Save,
                         .restore  = Restore,
                         .drift    = Drift,
                         .drag     = Drag,
                         .kick     = Kick};
