/* Body forces. A new one is a struct of its numbers, their rows, what it adds to the acceleration, and a line of
   Forces. One with a potential is in the balance of energy by it; the work of one without is counted in the run. */
#include "scene_impl.h"

/* Whether a uniform force has no potential along direction d: a particle that goes round comes back to where it was. */
static inline PetscBool GoesRound(Domain domain, PetscInt d)
{
  return (PetscBool)(d < domain->dim && domain->face[d][0] == FACE_PERIODIC);
}

/* --- gravity --- */

static const OptionRow gravity[] = {
  {"-gravity", "Acceleration of gravity", "m/s2", NULL, ROW_DIRECTION, 0},
  {.name = NULL},
};

static void Direction(const void *data, PetscReal g[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) g[d] = ((const PetscReal *)data)[d];
}

static void AddGravity(Domain domain, const void *data, const PetscReal x[DIM], PetscReal g[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) g[d] += ((const PetscReal *)data)[d];
}

static PetscReal GravityPotential(Domain domain, const void *data, const PetscReal x[DIM])
{
  PetscReal energy = 0;

  for (PetscInt d = 0; d < domain->dim; d++) energy -= GoesRound(domain, d) ? 0 : x[d] * ((const PetscReal *)data)[d];
  return energy;
}

/* --- shaking --- */

typedef struct {
  PetscReal amplitude[DIM];   /* m/s2 */
  PetscReal frequency, phase; /* Hz, degrees */
  PetscReal now[DIM];         /* m/s2, at the time of SceneSetTime */
} Shaking;

static const OptionRow shaking[] = {
  {"-gravity_amplitude", "Amplitude a of an oscillating part a sin(2 pi f t + phase) of gravity: a shaken tank", "m/s2",
   NULL, ROW_DIRECTION, offsetof(Shaking, amplitude)},
  {"-gravity_frequency", "Frequency f of that oscillating part", "Hz", "[0, inf)", ROW_REAL,
   offsetof(Shaking, frequency)},
  {"-gravity_phase", "Phase of that oscillating part; 90: the tank is at its turning point at the time 0", "degrees",
   "[-360, 360]", ROW_REAL, offsetof(Shaking, phase)},
  {.name = NULL},
};

static PetscErrorCode CheckShaking(Scene scene, void *data)
{
  const Shaking *s = (const Shaking *)data;

  PetscFunctionBegin;
  PetscCheckUser(s->frequency > 0 || Norm(s->amplitude) == 0, scene->domain->comm,
                 "-gravity_amplitude needs -gravity_frequency, in Hz");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void AddShaking(Domain domain, const void *data, const PetscReal x[DIM], PetscReal g[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) g[d] += ((const Shaking *)data)->now[d];
}

static void ShakeAt(void *data, PetscReal time)
{
  Shaking *s = (Shaking *)data;

  for (PetscInt d = 0; d < DIM; d++)
    s->now[d] = PetscIsNanReal(time)
                  ? 0
                  : s->amplitude[d] * PetscSinReal(s->frequency * (2 * PETSC_PI) * time + s->phase * PETSC_PI / 180);
}

static PetscBool ShakingMoments(const void *data, Moments *moments)
{
  const Shaking *s = (const Shaking *)data;

  if (Norm(s->amplitude) == 0) return PETSC_FALSE;
  MomentPeriod(moments, s->frequency, moments->start);
  return PETSC_TRUE;
}

/* --- a central force --- */

static const OptionRow central[] = {
  {"-central_force_rate", "Rate w of a central force, acceleration -w^2 x about the origin", "1/s", "[0, inf)",
   ROW_REAL, 0},
  {.name = NULL},
};

static void AddCentral(Domain domain, const void *data, const PetscReal x[DIM], PetscReal g[DIM])
{
  const PetscReal square = PetscSqr(*(const PetscReal *)data);

  for (PetscInt d = 0; d < domain->dim; d++) g[d] -= square * x[d];
}

static PetscBool CentralVaries(const void *data)
{
  return (PetscBool)(*(const PetscReal *)data > 0);
}

static PetscReal CentralPotential(Domain domain, const void *data, const PetscReal x[DIM])
{
  const PetscReal square = PetscSqr(*(const PetscReal *)data);
  PetscReal       energy = 0;

  for (PetscInt d = 0; d < domain->dim; d++) energy += x[d] * (0.5 * square * x[d]);
  return energy;
}

/* --- the registry --- */

static const ForceOps ForceGravity = {.size      = DIM * sizeof(PetscReal),
                                      .rows      = gravity,
                                      .direction = Direction,
                                      .add       = AddGravity,
                                      .potential = GravityPotential};
static const ForceOps ForceShaking = {.size      = sizeof(Shaking),
                                      .rows      = shaking,
                                      .check     = CheckShaking,
                                      .direction = Direction, /* the amplitude is the first */
                                      .add       = AddShaking,
                                      .at        = ShakeAt,
                                      .moments   = ShakingMoments};
static const ForceOps ForceCentral = {.size      = sizeof(PetscReal),
                                      .rows      = central,
                                      .add       = AddCentral,
                                      .varies    = CentralVaries,
                                      .potential = CentralPotential};

const ForceOps *const Forces[] = {&ForceGravity, &ForceShaking, &ForceCentral, &ForceFrame, NULL};

/* --- all of them --- */

static inline PetscBool Varies(Scene scene, PetscInt k)
{
  return (PetscBool)(!Forces[k]->direction && (!Forces[k]->varies || Forces[k]->varies(scene->force[k])));
}

/* Sums the forces that are the same everywhere. */
static void SumUniform(Scene scene)
{
  PetscReal g[DIM];

  scene->varies = PETSC_FALSE;
  for (PetscInt d = 0; d < DIM; d++) scene->uniform[d] = scene->drive[d] = 0;
  for (PetscInt k = 0; Forces[k]; k++) {
    if (Varies(scene, k)) scene->varies = PETSC_TRUE;
    if (!Forces[k]->direction) continue;
    Forces[k]->add(scene->domain, scene->force[k], NULL, scene->uniform);
    if (!Forces[k]->potential) Forces[k]->add(scene->domain, scene->force[k], NULL, scene->drive);
    Forces[k]->direction(scene->force[k], g);
    for (PetscInt d = 0; d < DIM && Forces[k]->potential; d++)
      scene->drive[d] += GoesRound(scene->domain, d) ? g[d] : 0;
  }
}

PetscErrorCode ForcesRead(Scene scene, OptionItems PetscOptionsObject)
{
  PetscInt n = 0;

  PetscFunctionBegin;
  while (Forces[n]) n++;
  PetscCall(PetscCalloc1(n, &scene->force));
  for (PetscInt k = 0; k < n; k++) {
    PetscCall(PetscCalloc(Forces[k]->size, &scene->force[k]));
    PetscCall(
      DomainReadOptions(scene->domain, PetscOptionsObject, Forces[k]->rows, "SceneSetFromOptions", scene->force[k]));
  }
  scene->time = NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ForcesCheck(Scene scene)
{
  PetscReal g[DIM];

  PetscFunctionBegin;
  for (PetscInt k = 0; Forces[k]; k++)
    if (Forces[k]->check) PetscCall(Forces[k]->check(scene, scene->force[k]));
  for (PetscInt k = 0; Forces[k]; k++) {
    if (!Forces[k]->direction) continue;
    Forces[k]->direction(scene->force[k], g);
    PetscCheckUser(g[0] == 0 || !scene->domain->rings, scene->domain->comm,
                   "%s must have 0 as its first number: with -dimension axisymmetric it acts along the axis",
                   Forces[k]->rows->name);
    PetscCheckUser(FrameKeeps(scene, g), scene->domain->comm,
                   "%s must be along the axis of -frame_rotation_rate: any other gravity would rotate in that frame",
                   Forces[k]->rows->name);
  }
  SumUniform(scene);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ForcesDestroy(Scene scene)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; Forces[k] && scene->force; k++) PetscCall(PetscFree(scene->force[k]));
  PetscCall(PetscFree(scene->force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ForcesView(Scene scene, PetscViewer viewer)
{
  char text[OPTION_TEXT_LENGTH] = "";

  PetscFunctionBegin;
  for (PetscInt k = 0; Forces[k]; k++)
    OptionsTell(text, sizeof(text), Forces[k]->rows, scene->force[k], scene->domain->dim, PETSC_FALSE);
  PetscCall(
    PetscViewerASCIIPrintf(viewer, "Scene: %" PetscInt_FMT " bodies%s%s\n", scene->count, text[0] ? ", " : "", text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void ForcesJson(Scene scene, Json *json)
{
  JsonObject(json, "forces");
  for (PetscInt k = 0; Forces[k]; k++) OptionsValues(json, Forces[k]->rows, scene->force[k], scene->domain->dim);
  JsonEnd(json);
}

PetscBool ForcesMoments(Scene scene, Moments *moments)
{
  PetscBool any = PETSC_FALSE;

  for (PetscInt k = 0; Forces[k]; k++)
    if (Forces[k]->moments && Forces[k]->moments(scene->force[k], moments)) any = PETSC_TRUE;
  return any;
}

void SceneSetTime(Scene scene, PetscReal time)
{
  scene->time = time;
  for (PetscInt k = 0; Forces[k]; k++)
    if (Forces[k]->at) Forces[k]->at(scene->force[k], time);
  SumUniform(scene);
}

PetscReal SceneTime(Scene scene)
{
  return scene->time;
}

void SceneAcceleration(Scene scene, const PetscReal x[DIM], PetscReal g[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) g[d] = scene->uniform[d];
  for (PetscInt k = 0; scene->varies && Forces[k]; k++)
    if (Varies(scene, k)) Forces[k]->add(scene->domain, scene->force[k], x, g);
}

void ForcesMost(Scene scene, const PetscReal x[DIM], PetscReal most[DIM])
{
  PetscReal amplitude[DIM] = {0, 0, 0}, g[DIM];

  for (PetscInt d = 0; d < DIM; d++) most[d] = 0;
  for (PetscInt k = 0; Forces[k]; k++) {
    if (Forces[k]->potential || !Forces[k]->direction) {
      Forces[k]->add(scene->domain, scene->force[k], x, most);
      continue;
    }
    Forces[k]->direction(scene->force[k], g);
    for (PetscInt d = 0; d < DIM; d++) amplitude[d] += PetscAbsReal(g[d]);
  }
  for (PetscInt d = 0; d < DIM; d++) most[d] = PetscAbsReal(most[d]) + amplitude[d];
}

PetscBool SceneDrive(Scene scene, const PetscReal x[DIM], PetscReal drive[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) drive[d] = scene->drive[d];
  for (PetscInt k = 0; scene->varies && Forces[k]; k++)
    if (Varies(scene, k) && !Forces[k]->potential) Forces[k]->add(scene->domain, scene->force[k], x, drive);
  return (PetscBool)(Norm(drive) > 0);
}

PetscBool SceneForceUniform(Scene scene)
{
  return (PetscBool)!scene->varies;
}

PetscReal SceneForcePotential(Scene scene, const PetscReal x[DIM])
{
  PetscReal energy = 0;

  for (PetscInt k = 0; Forces[k]; k++)
    if (Forces[k]->potential) energy += Forces[k]->potential(scene->domain, scene->force[k], x);
  return energy;
}
