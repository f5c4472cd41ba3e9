/* The size of the time step, and the scales of a scene on which it depends. */
#include "stepper_impl.h"

#define LAST_LONGER   1e-3 /* a last step may be longer by this fraction */
#define CAPILLARY     0.25 /* for schemes whose forces do not act at the middle of the step; else TensionStepLimit */
#define VISCOUS_LIMIT 0.08 /* over h^2/nu, of explicit viscosity; 0.125 is marginal for -viscosity_form morris */
#define FORCE_LIMIT   0.03 /* the same, over sqrt(h/|g|); a film at rest is stable at 0.03, not at 0.045 */
/* implicit over explicit steps; Couette flow across 20 spacings: 0.8 % of the wall's speed */
#define VISCOUS_RATIO 30
/* a number below it is small; 0.15 and 0.6 change no digit of columns and threads of honey, Stokes' second problem */
#define INERTIA  0.3
#define PULL     5    /* of sigma/mu; density errors are then corrected in h mu/sigma, as surfaces move by h */
#define CREEPING 0.03 /* of mu h/sigma, in which tension moves a very viscous surface by h; 0.11 is too long */
#define AT_ONCE  0.15 /* of d2/nu, in which pressure keeps up with a creeping flow: squeeze_film */
#define LAG      4e-4 /* times dt nu/d2 by which pressure lags behind such a flow, over d/U: squeeze_film */
/* largest ratio of a step to the step before; with 1.5 the angular momentum of drops that collide off centre is 1.3 %
   wrong, with 1.2 0.9 %, with 1.1 0.7 %; the front of a dam break moves by less than 0.2 % */
#define GROWTH      1.2
#define UNSTABLE    2   /* times a bound, from which a fixed step is doubted: viscosity's is unstable from 1.6 on */
#define SWING_STEPS 16  /* in a period of what swings; a shaken tank's mean pressure is 0.3 % off */
#define PER_PERIOD  250 /* cases/oscillating_drop: the period stays, damping grows by 1 to 5 % */
/* of -displacement_max, that a particle may move in a step; twice as many steps do not pay: with 0.4 a dam break's
   front is by 0.8 %, with 0.8 by 1.0 % beside the reference, its height by 1.5 %, 1.2 %; 0.95 binds nowhere in it */
#define MOVED 0.8

void TimeStepDefaults(TimeStepLimits *limits)
{
  *limits = (TimeStepLimits){.cfl             = 0.2,
                             .force_limit     = FORCE_LIMIT,
                             .capillary_limit = CAPILLARY,
                             .capillary_most  = CAPILLARY,
                             .per_period      = PER_PERIOD,
                             .swing           = PETSC_MAX_REAL};
}

static const OptionRow options[] = {
  {"-time_cfl", "Largest speed times time step over h; 0.8 of -displacement_max bounds the step, too", "1", "(0, 2]",
   ROW_REAL, offsetof(TimeStepLimits, cfl)},
  {"-time_steps_per_period",
   "Bound by surface tension: at least so many steps in a period of a drop as thick as the thinnest body, if the "
   "spacing alone asks for more; 0: as the spacing asks",
   "1", "[0, inf)", ROW_REAL, offsetof(TimeStepLimits, per_period)},
  {"-time_step_min", "Smallest time step chosen", "s", "[0, inf)", ROW_REAL, offsetof(TimeStepLimits, min)},
  {"-time_step_max", "Largest time step chosen; 0: no bound", "s", "[0, inf)", ROW_REAL, offsetof(TimeStepLimits, max)},
  {"-time_step", "Fixed time step; the last two share what is left; 0: chosen from the state", "s", "[0, inf)",
   ROW_REAL, offsetof(TimeStepLimits, fixed)},
  {.name = NULL},
};

PetscErrorCode TimeStepSetFromOptions(Stepper stepper)
{
  MPI_Comm        comm   = stepper->cloud->comm;
  TimeStepLimits *limits = &stepper->limits;

  PetscFunctionBegin;
  PetscCall(OptionsReadBlock(comm, "Time step", options, __func__, limits));
  PetscCheckUser(limits->max == 0 || limits->min <= limits->max, comm,
                 "-time_step_min (%g s) is larger than -time_step_max (%g s)", (double)limits->min,
                 (double)limits->max);
  if (SceneFrequency(stepper->cloud->scene) > 0)
    limits->swing = 1 / (SWING_STEPS * SceneFrequency(stepper->cloud->scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TimeStepView(Stepper stepper, PetscViewer viewer)
{
  const TimeStepLimits *limits = &stepper->limits;
  const PetscReal       least  = PetscMax(limits->fixed, limits->min);

  PetscFunctionBegin;
  if (least > limits->swing)
    PetscCall(PetscViewerASCIIPrintf(viewer,
                                     "warning: %s %g s has %.3g steps in the shortest period of what swings in the "
                                     "scene; at least %d resolve it\n",
                                     limits->fixed > 0 ? "-time_step" : "-time_step_min", (double)least,
                                     (double)(SWING_STEPS * limits->swing / least), SWING_STEPS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

typedef enum { FASTEST, FASTEST_SPRAY, STRONGEST, THICKEST, EXTREME_COUNT } Extreme;

/* Largest values over all ranks: speeds (m/s) of the fluid and of its spray, which pressure does not slow down; body
   force (m/s2); kinematic viscosity (m2/s) of liquids whose viscosity varies. Speeds and forces of graded particles are
   divided by their size: a fine particle with these values has the same bounds of the step. At the start of a run no
   particle counts as spray, since lambda is not known yet. */
static PetscErrorCode FindExtremes(Cloud cloud, PetscBool start, PetscReal extreme[EXTREME_COUNT])
{
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(extreme, EXTREME_COUNT));
  PetscCall(ParticlesOpen(cloud->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const Extreme   kind  = start || arrays.real[FIELD_LAMBDA][a] > SPRAY_LAMBDA ? FASTEST : FASTEST_SPRAY;
    const PetscReal size  = ParticleSize(cloud->domain, &arrays, a),
                    speed = Norm(arrays.real[FIELD_VELOCITY] + DIM * a) / size;
    PetscReal g[DIM];

    if (arrays.integer[INT_LAYER][a]) continue;
    if (arrays.real[FIELD_VISCOSITY]) {
      const Material *m = BodyMaterial(SceneBody(cloud->scene, arrays.integer[INT_BODY][a]));

      extreme[THICKEST] = PetscMax(extreme[THICKEST], arrays.real[FIELD_VISCOSITY][a] / m->density);
    }
    SceneAcceleration(cloud->scene, arrays.real[FIELD_POSITION] + DIM * a, g);
    extreme[kind]      = PetscMax(extreme[kind], speed);
    extreme[STRONGEST] = PetscMax(extreme[STRONGEST], Norm(g) / size);
  }
  PetscCall(ParticlesClose(cloud->particles, &arrays));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, extreme, EXTREME_COUNT, MPIU_REAL, MPIU_MAX, cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Bounds the step by constant viscosities, and by the largest kinematic viscosity that varies. viscosity_flow has the
   viscosity at the shear rate of the flow, since that of liquid at rest may be infinite. */
static void BoundByViscosities(Stepper stepper, PetscReal thickest, StepBounds *bounds)
{
  Scene           scene = stepper->cloud->scene;
  const PetscReal h = KernelSmoothingLength(stepper->cloud->kernel), fine = VISCOUS_LIMIT * h * h;

  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    const Body      body = SceneBody(scene, b);
    const Material *m    = BodyMaterial(body);
    const PetscReal flow = BodyViscosity(body, stepper->reference_velocity / h);

    if (m->viscosity <= 0) continue;
    if (!BodyViscosityVaries(body) && thickest == 0)
      bounds->viscosity = PetscMin(bounds->viscosity, fine * m->density / m->viscosity);
    bounds->viscosity_flow = PetscMin(bounds->viscosity_flow, fine * m->density / flow);
  }
  if (thickest > 0) bounds->viscosity = PetscMin(bounds->viscosity, fine / thickest);
  bounds->viscosity_flow = PetscMax(bounds->viscosity_flow, bounds->viscosity);
}

/* The smallest capillary step (s) of all surfaces with a spacing 'scale' times as large. A body's step may be as long
   as a share of the period of a sphere as thick as the body or a hole in it: w^2 = 8 sigma/(rho R^3). The approximate
   projection damps waves by a rate in proportion to the step. Waves of an interface move the liquid on both sides. */
static PetscReal CapillaryStep(Stepper stepper, PetscReal scale)
{
  const TimeStepLimits *limits = &stepper->limits;
  Scene                 scene  = stepper->cloud->scene;
  const PetscReal       h = scale * KernelSmoothingLength(stepper->cloud->kernel), sigma = SceneInterfaceTension(scene);
  PetscReal             step = PETSC_MAX_REAL;

  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    const Material *m = BodyMaterial(SceneBody(scene, b));

    if (m->tension > 0) {
      const PetscReal unit   = PetscSqrtReal(m->density * h * h * h / (2 * PETSC_PI * m->tension));
      const PetscReal radius = 0.5 * SceneBodyThinnest(scene, b);
      const PetscReal period = 2 * PETSC_PI * PetscSqrtReal(m->density * PetscPowRealInt(radius, 3) / (8 * m->tension));
      const PetscReal wanted = limits->per_period > 0 ? period / limits->per_period : 0;

      step =
        PetscMin(step,
                 PetscMax(CREEPING * m->viscosity * h / m->tension,
                          PetscMax(limits->capillary_limit * unit, PetscMin(limits->capillary_most * unit, wanted))));
    }
  }
  if (sigma > 0)
    step = PetscMin(step, limits->capillary_limit *
                            PetscSqrtReal(SceneInterfaceDensity(scene) * h * h * h / (2 * PETSC_PI * sigma)));
  return step;
}

/* Largest speed (bodies and walls, m/s), acceleration of each direction (m/s2) and fall through the body (m2/s2), and
   surface tension over density and smoothing length (m2/s2) of the scene; pull: the largest squared speed (m2/s2) that
   tension gives, which viscosity holds at PULL sigma/mu. */
typedef struct {
  PetscReal speed, acceleration[DIM], fall, capillary, pull;
} Scales;

/* Counts a surface of this tension (N/m), with the density times h (kg/m2) and viscosity (Pa s) of its liquid. */
static void Pull(Scales *scales, PetscReal tension, PetscReal mass, PetscReal viscosity)
{
  const PetscReal capillary = tension / mass;

  scales->capillary = PetscMax(scales->capillary, capillary);
  scales->pull =
    PetscMax(scales->pull, viscosity > 0 ? PetscMin(capillary, PetscSqr(PULL * tension / viscosity)) : capillary);
}

static void FindScales(Stepper stepper, Scales *scales)
{
  Cloud           cloud    = stepper->cloud;
  const PetscReal h        = KernelSmoothingLength(cloud->kernel);
  PetscReal       thinnest = PETSC_MAX_REAL;

  *scales = (Scales){0};
  for (PetscInt b = 0; b < SceneCount(cloud->scene); b++) {
    const Material *m = BodyMaterial(SceneBody(cloud->scene, b));
    BodyScales      body;

    SceneBodyScales(cloud->scene, b, &body);
    scales->speed = PetscMax(scales->speed, body.speed);
    for (PetscInt d = 0; d < DIM; d++) {
      scales->acceleration[d] = PetscMax(scales->acceleration[d], body.acceleration[d]);
      scales->fall            = PetscMax(scales->fall, body.acceleration[d] * body.extent[d]);
    }
    if (TensionReach(stepper->tension) > 0) Pull(scales, m->tension, m->density * h, m->viscosity);
    thinnest = PetscMin(thinnest, m->viscosity);
  }
  if (TensionReach(stepper->tension) > 0 && SceneInterfaceTension(cloud->scene) > 0)
    Pull(scales, SceneInterfaceTension(cloud->scene), SceneInterfaceDensity(cloud->scene) * h, thinnest);
  scales->speed = PetscMax(scales->speed, SceneSolidSpeed(cloud->scene));
  scales->speed = PetscMax(scales->speed, DomainWallSpeed(cloud->domain));
}

/* The step (s) of implicit viscosity in a flow without inertia; 0: inertia counts. It does if the Reynolds number
   U d rho/mu of a liquid is not small, d the least thickness of its body, U the largest speed; or if waves of a length
   2 d, of w^2 = g k + sigma k^3/rho, are not much slower than their decay, 2 nu k^2 (Lamb 1932, sections 267 and 349).

   The projection answers a flow by dt grad p of what viscosity leaves of it, so in a step longer than d^2/nu the
   pressure gets the share d^2/(nu dt) of what it lacks: it lags behind by about dt^2 nu/d^2, which must be short beside
   the time d/U in which the flow changes, if the step is longer than a share of d^2/nu. */
static PetscReal CreepingStep(Stepper stepper, PetscReal fastest)
{
  Scene           scene = stepper->cloud->scene;
  const PetscReal h     = KernelSmoothingLength(stepper->cloud->kernel);
  PetscReal       step  = PETSC_MAX_REAL;
  Scales          scales;

  FindScales(stepper, &scales);
  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    const Body      body = SceneBody(scene, b);
    const PetscReal d = SceneBodyThinnest(scene, b), U = PetscMax(fastest, scales.speed), k = PETSC_PI / d,
                    nu     = BodyViscosity(body, stepper->reference_velocity / h) / BodyMaterial(body)->density,
                    waves  = k * Norm(scales.acceleration) + k * k * k * h * scales.capillary,
                    change = PetscSqrtReal(U * U + scales.pull) * nu;

    if (U * d > INERTIA * nu || PetscSqrtReal(waves) > INERTIA * 2 * nu * k * k) return 0;
    if (change > 0) step = PetscMin(step, PetscMax(AT_ONCE * d * d / nu, PetscSqrtReal(LAG * d * d * d / change)));
  }
  return step;
}

/* The bound of each cause. */
static StepBounds FindBounds(Stepper stepper, const PetscReal extreme[EXTREME_COUNT], PetscBool start)
{
  Cloud                 cloud  = stepper->cloud;
  const TimeStepLimits *limits = &stepper->limits;
  const PetscReal       h      = KernelSmoothingLength(cloud->kernel),
                  fastest      = PetscMax(extreme[FASTEST], SceneSolidSpeed(cloud->scene));
  const PetscReal most         = MOVED * stepper->trial.displacement * cloud->domain->spacing; /* else it rolls back */
  StepBounds      bounds       = {.speed          = PETSC_MAX_REAL,
                                  .force          = PETSC_MAX_REAL,
                                  .viscosity      = PETSC_MAX_REAL,
                                  .viscosity_flow = PETSC_MAX_REAL,
                                  .tension        = PETSC_MAX_REAL,
                                  .swing          = limits->swing};

  if (fastest > 0) bounds.speed = PetscMin(limits->cfl * h, most) / fastest;
  if (extreme[FASTEST_SPRAY] > 0) bounds.speed = PetscMin(bounds.speed, most / extreme[FASTEST_SPRAY]);
  if (stepper->ops->bound)
    bounds.speed = PetscMin(bounds.speed, stepper->ops->bound(stepper, PetscMax(fastest, extreme[FASTEST_SPRAY])));
  if (extreme[STRONGEST] > 0) bounds.force = limits->force_limit * PetscSqrtReal(h / extreme[STRONGEST]);
  BoundByViscosities(stepper, extreme[THICKEST], &bounds);
  bounds.flow = start ? 0 : CreepingStep(stepper, PetscMax(fastest, extreme[FASTEST_SPRAY]));
  if (TensionReach(stepper->tension) > 0 && SceneHasTension(cloud->scene)) bounds.tension = CapillaryStep(stepper, 1);
  return bounds;
}

/* The bound of an edge; false: it has none. */
static PetscBool EdgeBound(const Step *step, PetscReal scale, StepBound *bound)
{
  if (!(*step->edge)->bound || !StepHas(step)) return PETSC_FALSE;
  *bound = (StepBound){.step = PETSC_MAX_REAL};
  (*step->edge)->bound(step, scale, bound);
  return PETSC_TRUE;
}

PetscReal StepEdgesBound(Stepper stepper, PetscReal scale)
{
  PetscReal least = PETSC_MAX_REAL;
  StepBound bound;

  for (Step step = StepFirst(stepper); *step.edge; StepNext(&step))
    if (EdgeBound(&step, scale, &bound)) least = PetscMin(least, bound.step);
  return least;
}

/* The step that all bounds but those of viscosity allow, with a spacing 'scale' times as large. */
static PetscReal LeastBound(Stepper stepper, const StepBounds *bounds, PetscReal scale)
{
  const PetscReal own = PetscMin(PetscMin(bounds->speed, bounds->force), PetscMin(bounds->tension, bounds->swing));

  return PetscMin(own, StepEdgesBound(stepper, scale));
}

/* Whether implicit viscosity is faster for a step that all other bounds allow. */
static PetscBool ImplicitPays(const Viscous *viscous, const StepBounds *bounds, PetscReal step)
{
  const PetscReal limit = bounds->viscosity;

  return (PetscBool)(limit < PETSC_MAX_REAL &&
                     (viscous->choice == VISCOUS_IMPLICIT || (viscous->choice == VISCOUS_AUTO && step > limit)));
}

/* Bounds a step by viscosity. Implicit steps resolve the diffusion of momentum, or, where inertia does not count, the
   time in which the flow changes. */
static PetscReal BoundByViscosity(const Viscous *viscous, const StepBounds *bounds, PetscReal step)
{
  if (!ImplicitPays(viscous, bounds, step)) return PetscMin(step, bounds->viscosity);
  return PetscMin(step, PetscMax(VISCOUS_RATIO * bounds->viscosity_flow, bounds->flow));
}

/* The step within all bounds and options. */
static PetscReal ChooseStep(Stepper stepper, const StepState *state)
{
  const TimeStepLimits *limits = &stepper->limits;
  const StepBounds     *bounds = &stepper->bounds;
  const PetscReal       h = KernelSmoothingLength(stepper->cloud->kernel), velocity = stepper->reference_velocity;
  const PetscReal       fixed = stepper->relaxation_step > 0 ? stepper->relaxation_step : limits->fixed;
  PetscReal             step  = fixed;

  if (fixed == 0) {
    step = LeastBound(stepper, bounds, 1);
    /* In the first step the scene's velocity counts as the particles' speed, which will soon reach it. The same in a
       relaxation, which must use the steps of the run: the noise of the pressure depends on them. */
    if ((state->previous_time_step == 0 || stepper->relaxing) && velocity > 0)
      step = PetscMin(step, limits->cfl * h / velocity);
    if (state->previous_time_step > 0) step = PetscMin(step, GROWTH * state->previous_time_step);
    if (limits->max > 0) step = PetscMin(step, limits->max);
  }
  stepper->viscous.implicit = ImplicitPays(&stepper->viscous, bounds, step);
  step                      = BoundByViscosity(&stepper->viscous, bounds, step);
  return fixed > 0 ? fixed : PetscMax(step, limits->min);
}

PetscErrorCode StepSize(Stepper stepper, const StepState *state, PetscReal end, PetscReal *dt)
{
  const PetscReal left = end - state->time;
  PetscReal       extreme[EXTREME_COUNT], step;

  PetscFunctionBegin;
  PetscCall(FindExtremes(stepper->cloud, (PetscBool)(state->step == 0), extreme));
  stepper->bounds  = FindBounds(stepper, extreme, (PetscBool)(state->step == 0));
  stepper->fastest = PetscMax(extreme[FASTEST], extreme[FASTEST_SPRAY]);
  step             = ChooseStep(stepper, state);
  /* Avoid a tiny last step, whose pressure would be noise over dt. The last step includes what round-off leaves in the
     sum of a million steps; the last two steps are equal. */
  if (left <= step * (1 + LAST_LONGER))
    step = left;
  else if (left < 2 * step * (1 - LAST_LONGER))
    step = 0.5 * left;
  *dt = step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The bounds with a spacing 'scale' times as large. */
static StepBounds ScaleBounds(Stepper stepper, PetscReal scale)
{
  const StepBounds *bounds = &stepper->bounds;
  const PetscReal   h2     = scale * scale;

  return (StepBounds){.speed          = bounds->speed * scale,
                      .force          = bounds->force * PetscSqrtReal(scale),
                      .viscosity      = bounds->viscosity * h2,
                      .viscosity_flow = bounds->viscosity_flow * h2,
                      .flow           = bounds->flow,
                      .swing          = bounds->swing,
                      .tension = bounds->tension < PETSC_MAX_REAL ? CapillaryStep(stepper, scale) : PETSC_MAX_REAL};
}

PetscReal StepperSteadyStep(Stepper stepper, PetscReal scale)
{
  const TimeStepLimits *limits = &stepper->limits;
  const StepBounds      bounds = ScaleBounds(stepper, scale);
  PetscReal             step   = LeastBound(stepper, &bounds, scale);

  if (limits->fixed > 0) return limits->fixed;
  step = limits->max > 0 ? PetscMin(step, limits->max) : step;
  return PetscMax(BoundByViscosity(&stepper->viscous, &bounds, step), limits->min);
}

PetscReal StepperStepsIn(PetscReal time, PetscReal before, PetscReal most)
{
  PetscReal steps = 0;

  for (; time > 0 && before > 0 && GROWTH * before < most; steps++) {
    before *= GROWTH;
    time -= before;
  }
  return steps + PetscMax(0, time) / most;
}

/* All bounds in a fixed order, those of the edges last; PETSC_MAX_REAL: none. Returns how many. */
static PetscInt ListBounds(Stepper stepper, StepBound all[STEP_BOUNDS])
{
  const TimeStepLimits *limits   = &stepper->limits;
  const StepBounds     *b        = &stepper->bounds;
  const Viscous        *v        = &stepper->viscous;
  const PetscReal       none     = PETSC_MAX_REAL;
  const StepBound       listed[] = {
          {"speed", "speed", b->speed, "a larger -time_cfl, to 0.8 of -displacement_max, or -spacing"},
          {"force", "body force", b->force, "a larger -spacing"},
          {"surface_tension", "surface tension", b->tension, "a larger -spacing, or fewer -time_steps_per_period"},
          {"swing", "what swings", b->swing, "a lower frequency"},
          {"viscosity", "explicit viscosity", v->implicit ? none : b->viscosity, "-viscosity_solver auto"},
          {"implicit_viscosity", "implicit viscosity", v->implicit ? BoundByViscosity(v, b, none) : none,
           "a larger -spacing"},
          {"time_step_max", "-time_step_max", limits->max > 0 ? limits->max : none, "a larger one"},
          {"time_step", "-time_step", limits->fixed > 0 ? limits->fixed : none, "none, for steps from the state"},
  };

  PetscInt n = (PetscInt)PETSC_STATIC_ARRAY_LENGTH(listed);

  (void)memcpy(all, listed, sizeof(listed));
  for (Step step = StepFirst(stepper); *step.edge && n < STEP_BOUNDS; StepNext(&step))
    n += EdgeBound(&step, 1, &all[n]);
  return n;
}

PetscInt StepperBounds(Stepper stepper, StepBound rows[STEP_BOUNDS])
{
  StepBound all[STEP_BOUNDS];
  PetscInt  n = 0, listed = ListBounds(stepper, all);

  for (PetscInt k = 0; k < listed; k++)
    if (all[k].step < PETSC_MAX_REAL) rows[n++] = all[k];
  for (PetscInt k = 1; k < n; k++)
    if (rows[0].step != stepper->limits.fixed &&
        (rows[k].step < rows[0].step || rows[k].step == stepper->limits.fixed)) {
      const StepBound first = rows[0];

      rows[0] = rows[k];
      rows[k] = first;
    }
  return n;
}

void TimeStepDoubt(Stepper stepper, char text[], size_t length)
{
  const PetscReal fixed = stepper->limits.fixed;
  StepBound       rows[STEP_BOUNDS];
  const PetscInt  n = StepperBounds(stepper, rows);

  for (PetscInt k = 1; k < n && fixed > 0 && !text[0]; k++) {
    if (fixed <= UNSTABLE * rows[k].step) continue;
    (void)snprintf(text, length,
                   "warning: -time_step %g s is %.3g times what %s allows, %.3g s: the run may be unstable",
                   (double)fixed, (double)(fixed / rows[k].step), rows[k].cause, (double)rows[k].step);
  }
}

void StepperJson(Stepper stepper, PetscBool chosen, Json *json)
{
  StepBound      all[STEP_BOUNDS], rows[STEP_BOUNDS];
  const PetscInt n = StepperBounds(stepper, rows), listed = ListBounds(stepper, all);

  JsonText(json, "scheme", stepper->scheme_type);
  JsonObject(json, "step");
  for (PetscInt k = 0; k < listed && chosen; k++) JsonReal(json, all[k].name, all[k].step);
  if (chosen) JsonText(json, "binds", n > 0 ? rows[0].name : NULL);
  JsonEnd(json);
  for (Step step = StepFirst(stepper); *step.edge; StepNext(&step))
    if ((*step.edge)->json) (*step.edge)->json(&step, json);
}

PetscReal StepperReferenceVelocity(Stepper stepper)
{
  Scales    scales;
  PetscReal given = 0;

  FindScales(stepper, &scales);
  for (Step step = StepFirst(stepper); *step.edge; StepNext(&step))
    if ((*step.edge)->speed) given = PetscMax(given, (*step.edge)->speed(&step));
  return PetscSqrtReal(scales.speed * scales.speed + given * given + scales.fall + scales.pull);
}

PetscReal StepperEnergyAtHand(Stepper stepper)
{
  const Domain domain = stepper->cloud->domain;
  Scales       scales;
  PetscReal    energy;

  FindScales(stepper, &scales);
  for (Step step = StepFirst(stepper); *step.edge; StepNext(&step))
    if ((*step.edge)->drives && (*step.edge)->drives(&step)) return 0;
  energy = 0.5 * scales.speed * scales.speed + scales.capillary;
  for (PetscInt d = 0; d < domain->dim; d++) {
    if (scales.acceleration[d] > 0 && domain->face[d][0] == FACE_PERIODIC) return 0;
    energy += scales.acceleration[d] * (domain->upper[d] - domain->lower[d]);
  }
  return energy;
}
