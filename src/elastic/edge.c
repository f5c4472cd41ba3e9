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
    PetscCall(PetscRealloc((size_t)data->capacity * sizeof(PetscReal), &data->share));
  }
  if (OperatorsViscosityRoom(cloud) > data->pairs) {
    data->pairs = OperatorsViscosityRoom(cloud) + OperatorsViscosityRoom(cloud) / 4;
    PetscCall(PetscRealloc((size_t)data->pairs * sizeof(PetscReal), &data->pair));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The balance damps waves across a smoothing length in about their period; at most the viscosity of the stress in a
   slow flow. */
static PetscErrorCode Thicken(const Step *step)
{
  Elastic        *data  = (Elastic *)step->own;
  Cloud           cloud = step->cloud;
  const PetscReal h     = KernelSmoothingLength(cloud->kernel);
  PetscReal      *mu    = cloud->field[FIELD_VISCOSITY];

  PetscFunctionBegin;
  PetscCall(MakeRoom(cloud, data));
  PetscCall(PetscArrayzero(data->share, cloud->n_total));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const Polymers *p = Of(cloud, a);
    PetscReal       relaxation, w, balance;

    if (p->modulus == 0) continue;
    w       = PolymersStiffness(p, cloud->field[FIELD_STRETCH] + 6 * a, &relaxation);
    balance = PetscMin(w * relaxation, BALANCE * h * cloud->size[a] * PetscSqrtReal(cloud->rest_density[a] * w));
    mu[a] += balance;
    data->share[a] = balance / mu[a];
  }
  PetscCall(CloudUpdate(cloud, FIELD_VISCOSITY));
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, data->share));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The stretch is that in the middle of the step, half a step after the velocity: a leapfrog. */
static PetscErrorCode Force(const Step *step)
{
  Elastic         *data      = (Elastic *)step->own;
  Cloud            cloud     = step->cloud;
  const Viscosity *viscosity = StepperViscosity(step->stepper);
  PetscReal       *L, *T, *normal, *s = cloud->field[FIELD_STRETCH], *acceleration = cloud->field[FIELD_ACCELERATION];

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, DIM * DIM, &L));
  PetscCall(CloudGetWork(cloud, 6, &T));
  PetscCall(CloudGetWork(cloud, DIM, &normal));
  PetscCall(OperatorsVelocityGradient(cloud, viscosity, L));
  PetscCall(ElasticNormals(cloud, normal));
  ElasticSolenoidal(cloud, normal, L);
  PetscCall(PetscArrayzero(T, 6 * cloud->n_total));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const Polymers *p = Of(cloud, a);

    if (p->modulus > 0) PolymersStretch(p, (PetscReal(*)[DIM])(L + DIM * DIM * a), step->dt, s + 6 * a);
  }
  PetscCall(ElasticMix(cloud, L, step->dt));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const Polymers *p = Of(cloud, a);

    if (p->modulus > 0) PolymersStress(p, s + 6 * a, T + 6 * a);
  }
  PetscCall(CloudUpdateArray(cloud, 6, PARITY_TENSOR, T));
  PetscCall(ElasticDivergence(cloud, normal, T, data->force));
  PetscCall(OperatorsViscosityPairs(cloud, viscosity, cloud->rest_density, data->pair));
  PetscCall(ElasticSeen(cloud, viscosity, data->pair, data->share, L, data->seen));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) {
    data->force[k] /= cloud->rest_density[k / DIM];
    acceleration[k] += data->force[k] + data->seen[k];
  }
  PetscCall(CloudRestoreWork(cloud, &normal));
  PetscCall(CloudRestoreWork(cloud, &T));
  PetscCall(CloudRestoreWork(cloud, &L));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Kick(const Step *step)
{
  Elastic         *data  = (Elastic *)step->own;
  Cloud            cloud = step->cloud;
  const PetscReal *v = cloud->field[FIELD_VELOCITY], *v_new = cloud->field[FIELD_VELOCITY_NEW];

  PetscFunctionBegin;
  data->fastest = 0;
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
    {"-gauge_forces", NOT_WITH, POLYMERS, " yet: forces on walls lack the stress of polymers"},
    {"-gauge_moments", NOT_WITH, POLYMERS, " yet: forces on walls lack the stress of polymers"},
    {"-<solid>_mass", NOT_WITH, POLYMERS, " yet: the stress of polymers does not act on it"},
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
                          .report      = Report};
