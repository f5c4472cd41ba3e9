/* Emitters in a step. The liquid in an emitter has its velocity whatever presses on it, like a piston that is handed
   over particle by particle: in the equation of the pressure its particles are boundaries like the dummy particles of a
   wall, with the whole velocity, and no pressure acts between them (CloudPushes). With a free surface behind them
   instead, an emitter could not push: a column of water above one sank and rose by 33 mm, pressures scattered by a
   third, and a channel got 0.78 to 0.90 of its flow. Implicit viscosity holds them, too: in a long step viscosity
   brings neighbours nearly to one velocity, and the liquid that has left would drag them along, and tear. */
#include "emitters_impl.h"

static const NumberRow rows[] = {
  {"inflow_energy", NUMBER_REAL, 0, ENERGY_BROUGHT, "emitters"},
  {.name = NULL},
};

static PetscErrorCode Destroy(const Step *step)
{
  PetscFunctionBegin;
  PetscCall(EmissionsDestroy((Emissions *)step->own));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool On(const Step *step)
{
  return SceneComesLater(step->scene);
}

static PetscErrorCode Hold(const Step *step)
{
  Cloud cloud = step->cloud;

  PetscFunctionBegin;
  ((Emissions *)step->own)->held = PETSC_TRUE;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal v[DIM];

    if (!PressureHolds(step->pressure, a)) continue;
    BodyFillingVelocity(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]), step->time + step->dt,
                        cloud->field[FIELD_POSITION] + DIM * a, v);
    PetscCall(ViscousHold(step->stepper, a, v));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MakeRoom(Emissions *emissions, Cloud cloud)
{
  PetscFunctionBegin;
  if (emissions->capacity >= cloud->capacity) PetscFunctionReturn(PETSC_SUCCESS);
  emissions->capacity = cloud->capacity;
  PetscCall(PetscFree2(emissions->pushing, emissions->pushed));
  PetscCall(PetscMalloc2(emissions->capacity, &emissions->pushing, emissions->capacity, &emissions->pushed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Particle a has the velocity of an emitter's liquid at the end of the step. */
static void Push(const Step *step, PetscInt a, Body body)
{
  Emissions      *emissions = (Emissions *)step->own;
  const Cloud     cloud     = step->cloud;
  const PetscReal mass      = cloud->rest_density[a] * cloud->volume[a];
  PetscReal      *v_star    = cloud->field[FIELD_VELOCITY_STAR];
  Pushed         *p         = &emissions->pushed[emissions->count++];

  p->a = a;
  BodyFillingVelocity(body, step->time + step->dt, cloud->field[FIELD_POSITION] + DIM * a, p->v);
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscInt k = DIM * a + d;

    emissions->work += 0.5 * mass * (p->v[d] - v_star[k]) * (cloud->field[FIELD_VELOCITY][k] + p->v[d]);
    v_star[k] = p->v[d];
    p->x[d]   = cloud->field[FIELD_POSITION][k] + (emissions->half ? 0.5 : 1) * step->dt * p->v[d];
  }
}

/* The emitter in whose liquid particle a of another body is, away from free surfaces; NULL: it is not in one. */
static Body Enclosing(Cloud cloud, PetscInt a)
{
  PetscBool beside = PETSC_FALSE;

  if (CloudPushes(cloud, a) || cloud->integer[INT_SURFACE][a]) return NULL;
  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1] && !beside; k++)
    beside = CloudPushes(cloud, cloud->list[k]);
  for (PetscInt b = 0; b < SceneCount(cloud->scene) && beside; b++) {
    const Body body = SceneBody(cloud->scene, b);

    if (BodyComesLater(body) && BodyHolds(body, cloud->field[FIELD_POSITION] + DIM * a, 0)) return body;
  }
  return NULL;
}

/* The liquid in emitters pushes: it has its velocity at the end of the step whatever the pressure. So has what got
   among it: beside liquid that pushes and walls alone its pressure would have no equation (a weir stopped by it). */
static PetscErrorCode Predict(const Step *step)
{
  Emissions *emissions = (Emissions *)step->own;
  Cloud      cloud     = step->cloud;
  PetscInt   own;

  PetscFunctionBegin;
  emissions->count = 0;
  emissions->work  = 0;
  if (emissions->frozen || !PressureTakesDivergence(step->pressure)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MakeRoom(emissions, cloud));
  PetscCall(PetscArrayzero(emissions->pushing, cloud->n_total));
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    if (PressureHolds(step->pressure, a)) Push(step, a, SceneBody(cloud->scene, cloud->integer[INT_BODY][a]));
  own = emissions->count;
  for (PetscInt k = 0; k < own; k++) emissions->pushing[emissions->pushed[k].a] = 1;
  PetscCall(CloudUpdateIntArray(cloud, emissions->pushing));
  cloud->pushing = emissions->pushing;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const Body body = Enclosing(cloud, a);

    if (body) Push(step, a, body);
  }
  for (PetscInt k = own; k < emissions->count; k++) emissions->pushing[emissions->pushed[k].a] = 1;
  PetscCall(CloudUpdateIntArray(cloud, emissions->pushing));
  PetscCall(CloudUpdate(cloud, FIELD_VELOCITY_STAR));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What pushes amid its like has no equation for its pressure. When it comes up to liquid that flows, the former
   pressure acts there before the next is known: so it has the mean of those around that have one. With 0 a viscous
   channel lost a fifth of the slope of its pressure in long steps, the more the higher its pressure. */
static PetscErrorCode ContinuePressure(const Step *step)
{
  const Emissions *emissions = (Emissions *)step->own;
  const Cloud      cloud     = step->cloud;
  PetscReal       *p         = cloud->field[FIELD_PRESSURE], *has;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, 1, &has));
  for (PetscInt a = 0; a < cloud->n_owned; a++) has[a] = PressureRow(step->pressure, a) >= 0;
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, has));
  for (const Pushed *q = emissions->pushed; q < emissions->pushed + emissions->count; q++) {
    PetscReal sum = 0, count = 0;

    for (PetscInt64 k = cloud->first[q->a]; k < cloud->first[q->a + 1] && !has[q->a]; k++) {
      sum += has[cloud->list[k]] * p[cloud->list[k]];
      count += has[cloud->list[k]];
    }
    if (count > 0) p[q->a] = sum / count;
  }
  PetscCall(CloudUpdate(cloud, FIELD_PRESSURE));
  PetscCall(CloudRestoreWork(cloud, &has));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* u[] ([n_total][3]): the velocity of what pushes, and what dummy particles beside it have of it. */
static PetscErrorCode FindPushing(const Step *step, PetscReal u[])
{
  const Emissions *emissions = (Emissions *)step->own;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(u, DIM * step->cloud->n_total));
  for (const Pushed *p = emissions->pushed; p < emissions->pushed + emissions->count; p++)
    PetscCall(PetscArraycpy(u + DIM * p->a, p->v, DIM));
  PetscCall(OperatorsBeside(step->cloud, u));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Kick(const Step *step)
{
  Emissions *emissions = (Emissions *)step->own;
  Cloud      cloud     = step->cloud;
  PetscReal *force, *u;

  PetscFunctionBegin;
  if (!cloud->pushing) PetscFunctionReturn(PETSC_SUCCESS);
  if (emissions->held) PetscCall(ContinuePressure(step));
  emissions->held = PETSC_FALSE;
  PetscCall(CloudGetWork(cloud, DIM, &force));
  PetscCall(CloudGetWork(cloud, DIM, &u));
  PetscCall(OperatorsWallForce(cloud, PressureGradientCorrected(step->pressure), force));
  PetscCall(FindPushing(step, u));
  for (const Pushed *p = emissions->pushed; p < emissions->pushed + emissions->count; p++)
    PetscCall(PetscArraycpy(cloud->field[FIELD_VELOCITY_NEW] + DIM * p->a, p->v, DIM));
  for (PetscInt k = 0; k < DIM * cloud->n_total; k++) emissions->work -= step->dt * force[k] * u[k]; /* ghosts, too */
  PetscCall(CloudRestoreWork(cloud, &u));
  PetscCall(CloudRestoreWork(cloud, &force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Shifting evens it out across its velocity, so that as much comes as was asked for. */
static PetscErrorCode Guard(const Step *step)
{
  const Emissions *emissions = (Emissions *)step->own;
  Cloud            cloud     = step->cloud;

  PetscFunctionBegin;
  if (!cloud->pushing) PetscFunctionReturn(PETSC_SUCCESS);
  for (const Pushed *p = emissions->pushed; p < emissions->pushed + emissions->count; p++) {
    PetscReal *x = cloud->field[FIELD_POSITION] + DIM * p->a, along = 0;

    for (PetscInt d = 0; d < DIM; d++) along += (p->x[d] - x[d]) * p->v[d];
    for (PetscInt d = 0; d < DIM && along != 0; d++) x[d] += along * p->v[d] / Dot(p->v, p->v);
    PetscCall(PetscArraycpy(cloud->field[FIELD_VELOCITY] + DIM * p->a, p->v, DIM));
  }
  cloud->pushing = NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Restore(const Step *step)
{
  PetscFunctionBegin;
  step->cloud->pushing           = NULL;
  ((Emissions *)step->own)->half = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Drift(const Step *step, PetscReal from, PetscReal to, PetscReal end, PetscBool *moved)
{
  PetscFunctionBegin;
  if (to < end) ((Emissions *)step->own)->half = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses to fill what is full. */
static PetscErrorCode Check(const Step *step, PetscBool ahead, char why[], size_t length)
{
  const Scene     scene = step->scene;
  const PetscReal now   = step->time;

  PetscFunctionBegin;
  for (PetscInt b = 0; b < SceneCount(scene) && ((Emissions *)step->own)->full && !ahead && !why[0]; b++)
    if (BodyComesLater(SceneBody(scene, b)) && BodyFillings(SceneBody(scene, b), now + step->dt) > 0)
      PetscCall(
        PetscSNPrintf(why, length,
                      "the emitter %s has filled the vessel: its liquid has no free surface and no open face to "
                      "leave by; end the run earlier, give -%s_count, or open a face",
                      BodyName(SceneBody(scene, b)), BodyName(SceneBody(scene, b))));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Freeze(const Step *step, PetscBool frozen)
{
  PetscFunctionBegin;
  ((Emissions *)step->own)->frozen = frozen;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Commit(const Step *step, StepState *state)
{
  Emissions *emissions = (Emissions *)step->own;
  /* work, speed of what pushes, particles that do not */
  PetscReal sum[3] = {emissions->work, 0, (PetscReal)(step->cloud->n_fluid - emissions->count)};

  PetscFunctionBegin;
  for (const Pushed *p = emissions->pushed; p < emissions->pushed + emissions->count; p++) sum[1] += Norm(p->v);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 3, MPIU_REAL, MPI_SUM, step->cloud->comm));
  emissions->full = (PetscBool)(sum[1] > 0 && sum[2] > 0 && PressureIsClosed(step->pressure));
  *(PetscReal *)StepNumbers(step, state) += sum[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Brings energy, too: of the liquid that comes, and that which changes liquid that does not push. */
static PetscErrorCode Bring(const Step *step, Packing packing, Gauges gauges, PetscBool resumed, StepState *state)
{
  GaugeTotals before, after;
  PetscInt    emitted;

  PetscFunctionBegin;
  if (gauges) PetscCall(GaugesTotals(gauges, &before));
  PetscCall(EmissionsAdd((Emissions *)step->own, step->cloud, packing, state->time, resumed, &emitted));
  if (!gauges) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GaugesTotals(gauges, &after));
  *(PetscReal *)StepNumbers(step, state) +=
    after.kinetic_energy + after.potential_energy - before.kinetic_energy - before.potential_energy;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal Filling(const Step *step, PetscInt body, PetscInt *particles)
{
  const Emission *emission = &((Emissions *)step->own)->of[body];

  if (particles) *particles = emission->n;
  return EmissionVolume(emission, step->cloud->domain);
}

#define EMITTERS "-<body>_type emitter"

static PetscBool Emits(Scene scene, Tension tension)
{
  return (PetscBool)(scene && SceneComesLater(scene));
}

static const Feature features[] = {{EMITTERS, Emits}, {.name = NULL}};
static const Refusal refusals[] = {{FEATURE_POISSON, NOT_WITH, EMITTERS, "; use -packing_type lattice"}, {.one = NULL}};

const Edge EmitterEdge = {.name        = "emitters",
                          .features    = features,
                          .refusals    = refusals,
                          .data_size   = sizeof(Emissions),
                          .number_size = sizeof(PetscReal),
                          .numbers     = rows,
                          .destroy     = Destroy,
                          .on          = On,
                          .drives      = On,
                          .check       = Check,
                          .freeze      = Freeze,
                          .restore     = Restore,
                          .drift       = Drift,
                          .hold        = Hold,
                          .predict     = Predict,
                          .kick        = Kick,
                          .guard       = Guard,
                          .commit      = Commit,
                          .bring       = Bring,
                          .filling     = Filling};
