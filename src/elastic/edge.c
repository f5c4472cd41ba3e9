/* Polymers in a step: their stress acts on the liquid, and the liquid's motion stretches them. */
#include "elastic_impl.h"

/* Of h sqrt(rho w), w of PolymersStiffness: the viscosity of what the fit does not see. Threads hold to four spacings
   from 0.3 on; with 3 the start-up of a flow lags twice as much in time. No reference. */
#define BALANCE 1

/* Longest steps over h/c, c the speed of waves: of liquid that is not stretched, where the start-up of a channel of 20
   spacings is off by 2 %; of stretched liquid, where implicit viscosity holds waves. */
#define STEP_RATIO      0.3
#define STRETCHED_RATIO 2

enum { SUM_WORK, SUM_ENERGY, SUMS };

typedef struct {
  PetscReal *force, *seen; /* [capacity][3] m/s2: of the stress; of ElasticSeen */
  PetscReal *wall;         /* [capacity][3] N: of both on dummy particles */
  PetscBool  loads;        /* wall is that of the step that is made */
  PetscReal *share;        /* [capacity] part of the viscosity that is the balance */
  PetscReal *pair;         /* [pairs] of OperatorsViscosityPairs */
  PetscInt   capacity;
  PetscInt64 pairs;
  PetscReal  fastest; /* of the numbers; within a step of this rank */
} Elastic;

typedef struct {
  PetscReal work, energy; /* J: done on the liquid so far; stored now */
  PetscReal fastest; /* m2/s2: the largest squared speed of an elastic wave over the squared size, in the last step */
} ElasticNumbers;

static const NumberRow rows[] = {
  {"elastic_work", NUMBER_REAL, offsetof(ElasticNumbers, work), ENERGY_GIVEN, "polymers"},
  {"elastic_energy", NUMBER_REAL, offsetof(ElasticNumbers, energy), ENERGY_NONE, NULL},
  {"elastic_speed_squared", NUMBER_SPAN, offsetof(ElasticNumbers, fastest), ENERGY_NONE, NULL},
  {.name = NULL},
};

static PetscBool On(const Step *step)
{
  return (PetscBool)(ElasticOn(step->scene, NULL) && step->damping == 1);
}

static PetscErrorCode Create(const Step *step)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < SceneCount(step->scene); b++) {
    const Body body = SceneBody(step->scene, b);

    PetscCheckUser(PolymersOf(step->scene, b)->modulus == 0 || BodyMaterial(body)->viscosity > 0, step->cloud->comm,
                   "-%s_polymer_modulus is given: -%s_viscosity, that of the solvent, must be positive", BodyName(body),
                   BodyName(body));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy(const Step *step)
{
  Elastic *data = (Elastic *)step->own;

  PetscFunctionBegin;
  PetscCall(PetscFree(data->force));
  PetscCall(PetscFree(data->seen));
  PetscCall(PetscFree(data->wall));
  PetscCall(PetscFree(data->share));
  PetscCall(PetscFree(data->pair));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const Polymers *Of(Cloud cloud, PetscInt a)
{
  return PolymersOf(cloud->scene, cloud->integer[INT_BODY][a]);
}

static PetscErrorCode MakeRoom(Cloud cloud, Elastic *data)
{
  PetscFunctionBegin;
  if (cloud->n_total > data->capacity) {
    data->capacity = PetscMax(cloud->capacity, cloud->n_total);
    PetscCall(PetscRealloc(DIM * (size_t)data->capacity * sizeof(PetscReal), &data->force));
    PetscCall(PetscRealloc(DIM * (size_t)data->capacity * sizeof(PetscReal), &data->seen));
    PetscCall(PetscRealloc(DIM * (size_t)data->capacity * sizeof(PetscReal), &data->wall));
    PetscCall(PetscRealloc((size_t)data->capacity * sizeof(PetscReal), &data->share));
  }
  if (OperatorsViscosityRoom(cloud) > data->pairs) {
    data->pairs = OperatorsViscosityRoom(cloud) + OperatorsViscosityRoom(cloud) / 4;
    PetscCall(PetscRealloc((size_t)data->pairs * sizeof(PetscReal), &data->pair));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The balance (Pa s) damps waves across a smoothing length in about their period; at most the viscosity of the stress
   in a slow flow. */
static PetscReal Balance(Cloud cloud, PetscInt a)
{
  const Polymers *p = Of(cloud, a);
  PetscReal       relaxation, w;

  if (p->modulus == 0) return 0;
  w = PolymersStiffness(p, cloud->field[FIELD_STRETCH] + 6 * a, &relaxation);
  return PetscMin(w * relaxation, BALANCE * KernelSmoothingLength(cloud->kernel) * cloud->size[a] *
                                    PetscSqrtReal(cloud->rest_density[a] * w));
}

static PetscErrorCode Thicken(const Step *step)
{
  Elastic   *data  = (Elastic *)step->own;
  Cloud      cloud = step->cloud;
  PetscReal *mu    = cloud->field[FIELD_VISCOSITY];

  PetscFunctionBegin;
  PetscCall(MakeRoom(cloud, data));
  PetscCall(PetscArrayzero(data->share, cloud->n_total));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal balance = Balance(cloud, a);

    mu[a] += balance;
    if (balance > 0) data->share[a] = balance / mu[a];
  }
  PetscCall(CloudUpdate(cloud, FIELD_VISCOSITY));
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, data->share));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the forces of the stress at the positions of the last search; with stretches, after the polymers have been
   stretched for a step: the stretch is that in its middle, half a step after the velocity, a leapfrog. */
static PetscErrorCode Act(const Step *step, PetscBool stretches)
{
  Elastic         *data      = (Elastic *)step->own;
  Cloud            cloud     = step->cloud;
  const Viscosity *viscosity = StepperViscosity(step->stepper);
  PetscReal       *L, *T, *normal, *s = cloud->field[FIELD_STRETCH];

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, DIM * DIM, &L));
  PetscCall(CloudGetWork(cloud, 6, &T));
  PetscCall(CloudGetWork(cloud, DIM, &normal));
  PetscCall(OperatorsVelocityGradient(cloud, viscosity, L));
  PetscCall(OperatorsSmoothNormals(cloud, normal));
  ElasticSolenoidal(cloud, normal, L);
  for (PetscInt a = 0; a < cloud->n_fluid && stretches; a++)
    if (Of(cloud, a)->modulus > 0)
      PolymersStretch(Of(cloud, a), (PetscReal(*)[DIM])(L + DIM * DIM * a), step->dt, s + 6 * a);
  if (stretches) PetscCall(ElasticMix(cloud, L, step->dt));
  PetscCall(PetscArrayzero(T, 6 * cloud->n_total));
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    if (Of(cloud, a)->modulus > 0) PolymersStress(Of(cloud, a), s + 6 * a, T + 6 * a);
  PetscCall(CloudUpdateArray(cloud, 6, PARITY_TENSOR, T));
  PetscCall(PetscArrayzero(data->wall, DIM * cloud->n_total));
  PetscCall(ElasticDivergence(cloud, normal, T, data->force, data->wall));
  PetscCall(OperatorsViscosityPairs(cloud, viscosity, cloud->rest_density, data->pair));
  PetscCall(ElasticSeen(cloud, viscosity, data->pair, data->share, L, data->seen, data->wall));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) data->force[k] /= cloud->rest_density[k / DIM];
  PetscCall(CloudRestoreWork(cloud, &normal));
  PetscCall(CloudRestoreWork(cloud, &T));
  PetscCall(CloudRestoreWork(cloud, &L));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Force(const Step *step)
{
  Elastic   *data         = (Elastic *)step->own;
  PetscReal *acceleration = step->cloud->field[FIELD_ACCELERATION];

  PetscFunctionBegin;
  PetscCall(Act(step, PETSC_TRUE));
  for (PetscInt k = 0; k < DIM * step->cloud->n_fluid; k++) acceleration[k] += data->force[k] + data->seen[k];
  data->loads = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Load(const Step *step, PetscReal force[])
{
  Elastic         *data  = (Elastic *)step->own;
  Cloud            cloud = step->cloud;
  const PetscReal *mu    = cloud->field[FIELD_VISCOSITY];

  PetscFunctionBegin;
  if (!data->loads) {
    PetscCall(MakeRoom(cloud, data));
    PetscCall(PetscArrayzero(data->share, cloud->n_total));
    for (PetscInt a = 0; a < cloud->n_fluid; a++)
      if (mu[a] > 0) data->share[a] = PetscMin(1, Balance(cloud, a) / mu[a]);
    PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, data->share));
    PetscCall(Act(step, PETSC_FALSE));
  }
  for (PetscInt k = DIM * cloud->n_fluid; k < DIM * cloud->n_total; k++) force[k] += data->wall[k];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Kick(const Step *step)
{
  Elastic         *data  = (Elastic *)step->own;
  Cloud            cloud = step->cloud;
  const PetscReal *v = cloud->field[FIELD_VELOCITY], *v_new = cloud->field[FIELD_VELOCITY_NEW];

  PetscFunctionBegin;
  data->fastest = 0;
  data->loads   = PETSC_FALSE;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const Polymers  *p    = Of(cloud, a);
    const PetscReal *s    = cloud->field[FIELD_STRETCH] + 6 * a;
    const PetscReal  mass = cloud->volume[a] * cloud->rest_density[a];
    PetscReal        relaxation, w;

    for (PetscInt k = DIM * a; k < DIM * (a + 1); k++) {
      step->sums[SUM_WORK] += 0.5 * step->dt * mass * data->force[k] * (v[k] + v_new[k]);
      step->trial->sum[SUM_VISCOUS_WORK] += 0.5 * step->dt * mass * data->seen[k] * (v[k] + v_new[k]);
    }
    if (p->modulus == 0) continue;
    step->sums[SUM_ENERGY] += cloud->volume[a] * PolymersEnergy(p, s);
    w             = PolymersStiffness(p, s, &relaxation);
    data->fastest = PetscMax(data->fastest, w / (cloud->rest_density[a] * PetscSqr(cloud->size[a])));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Commit(const Step *step, StepState *state)
{
  Elastic        *data    = (Elastic *)step->own;
  ElasticNumbers *numbers = (ElasticNumbers *)StepNumbers(step, state);

  PetscFunctionBegin;
  numbers->work += step->sums[SUM_WORK];
  numbers->energy = step->sums[SUM_ENERGY];
  PetscCallMPI(MPI_Allreduce(&data->fastest, &numbers->fastest, 1, MPIU_REAL, MPIU_MAX, step->cloud->comm));
  data->fastest = numbers->fastest;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Renew(const Step *step, PetscBool resumed, StepState *state)
{
  PetscFunctionBegin;
  ((Elastic *)step->own)->fastest = ((ElasticNumbers *)StepNumbers(step, state))->fastest;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The balance makes waves that the step does not resolve slower, not unstable, as long as viscosity is implicit. */
static void Bound(const Step *step, PetscReal scale, StepBound *bound)
{
  const Elastic  *data  = (const Elastic *)step->own;
  const Cloud     cloud = step->cloud;
  const PetscReal h     = scale * KernelSmoothingLength(cloud->kernel);
  PetscReal       w     = 0;

  bound->name  = "elastic_waves";
  bound->cause = "elastic waves";
  bound->lift  = "a larger -spacing";
  for (PetscInt b = 0; b < SceneCount(step->scene); b++)
    w = PetscMax(w, PolymersOf(step->scene, b)->modulus / BodyMaterial(SceneBody(step->scene, b))->density);
  if (w > 0)
    bound->step =
      h * PetscMin(STEP_RATIO / PetscSqrtReal(w), STRETCHED_RATIO / PetscSqrtReal(PetscMax(w, data->fastest)));
}

static PetscErrorCode Report(Scene scene, const void *numbers, PetscReal copies, const char joule[], char text[],
                             size_t length)
{
  const ElasticNumbers *so_far = (const ElasticNumbers *)numbers;

  PetscFunctionBegin;
  if (ElasticOn(scene, NULL))
    PetscCall(PetscSNPrintf(text, length,
                            "  polymers    gave the liquid %.4g %s, store %.4g, have turned %.4g to heat\n",
                            (double)(copies * so_far->work), joule, (double)(copies * so_far->energy),
                            (double)(copies * -(so_far->work + so_far->energy))));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define POLYMERS "-<body>_polymer_modulus"

static const EdgeField fields[]   = {{FIELD_STRETCH, ElasticOn}, {FIELD_VISCOSITY, ElasticOn}, {.needed = NULL}};
static const Feature   features[] = {{POLYMERS, ElasticOn}, {.name = NULL}};
static const Refusal   refusals[] = {
    {POLYMERS, NEEDS, FEATURE_CONSISTENT, ", the default"},
    {POLYMERS, NEEDS, FEATURE_CENTERED, ", the default"},
    {"-viscosity_form morris", NOT_WITH, POLYMERS, ": its forces do not act along the line of centres"},
    {.one = NULL},
};

const Edge ElasticEdge = {.name        = "elastic",
                          .properties  = ElasticProperties,
                          .fields      = fields,
                          .features    = features,
                          .refusals    = refusals,
                          .gauge       = &GaugeElastic,
                          .data_size   = sizeof(Elastic),
                          .number_size = sizeof(ElasticNumbers),
                          .numbers     = rows,
                          .sums        = SUMS,
                          .on          = On,
                          .create      = Create,
                          .destroy     = Destroy,
                          .thicken     = Thicken,
                          .force       = Force,
                          .kick        = Kick,
                          .commit      = Commit,
                          .renew       = Renew,
                          .bound       = Bound,
                          .load        = Load,
                          .report      = Report};
