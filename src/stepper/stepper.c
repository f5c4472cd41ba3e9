#include "stepper_impl.h"

#define FORESEEN      64    /* times at which StepperForesee looks */
#define MAX_HALVINGS  10    /* of a step that is rolled back */
#define DENSITY_RATIO 2.    /* largest one of two bodies; a denser drop than 4 times its film is unstable */
#define STALLED       1e-12 /* step over time: a smaller step does not advance the time */
/* Factor on the velocities in a step of the relaxation; cases/drop_impact/paper.md compares others. */
#define RELAXATION_DAMPING 0.9

static const Choice *const Schemes[] = {&SchemeConsistent.choice, &SchemeDensityInvariant.choice,
                                        &SchemeWeaklyCompressible.choice, NULL};

/* Makes a scheme that of the stepper, with its defaults. */
static PetscErrorCode SetScheme(Stepper s, const Choice *choice)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(s->scheme));
  TimeStepDefaults(&s->limits);
  s->ops = (const SchemeOps *)choice;
  PetscCall(PetscStrncpy(s->scheme_type, choice->name, sizeof(s->scheme_type)));
  if (choice->size) PetscCall(PetscCalloc(choice->size, &s->scheme));
  PetscCall(s->ops->create(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperCreate(Cloud cloud, Tension tension, Pressure pressure, Stepper *stepper)
{
  Stepper s;

  PetscFunctionBegin;
  PetscCall(PetscNew(&s));
  s->cloud    = cloud;
  s->tension  = tension;
  s->pressure = pressure;
  s->edges    = StepEdges;
  s->now      = (Step){s, cloud->scene, cloud, tension, pressure, .trial = &s->result, .damping = 1};
  PetscCall(StepEdgesCreate(s));
  s->trial = (TrialLimits){.displacement = 0.5, .energy = 2};
  s->guard = 0.25;
  PetscCall(SetScheme(s, &SchemeConsistent.choice));
  *stepper = s;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses liquids whose densities are too far apart. */
static PetscErrorCode CheckDensities(Stepper s)
{
  Scene scene = s->cloud->scene;
  Body  light = SceneBody(scene, 0), dense = light;

  PetscFunctionBegin;
  for (PetscInt b = 1; b < SceneCount(scene); b++) {
    if (BodyMaterial(SceneBody(scene, b))->density < BodyMaterial(light)->density) light = SceneBody(scene, b);
    if (BodyMaterial(SceneBody(scene, b))->density > BodyMaterial(dense)->density) dense = SceneBody(scene, b);
  }
  PetscCheckUser(BodyMaterial(dense)->density <= DENSITY_RATIO * BodyMaterial(light)->density, s->cloud->comm,
                 "-%s_density is %g times -%s_density; at most %g times is stable where they touch", BodyName(dense),
                 (double)(BodyMaterial(dense)->density / BodyMaterial(light)->density), BodyName(light),
                 (double)DENSITY_RATIO);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A ChoiceReader. */
static PetscErrorCode ReadScheme(void *object, const Choice *choice)
{
  Stepper s = (Stepper)object;
  char    title[128];

  PetscFunctionBegin;
  PetscCall(SetScheme(s, choice));
  PetscCall(PetscSNPrintf(title, sizeof(title), "Scheme with -scheme %s", choice->name));
  PetscOptionsBegin(s->cloud->comm, NULL, title, "Stepper");
  PetscCall(OptionsRead(PetscOptionsObject, choice->options, "StepperSetFromOptions", s->scheme));
  if (choice->setup) PetscCall(choice->setup(s));
  PetscOptionsEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const OptionRow schemes[] = {
  {"-scheme", "How the pressure keeps the liquid incompressible", NULL, NULL, ROW_CHOICE,
   offsetof(struct _p_Stepper, scheme_type), .choices = Schemes},
  {"-wall_guard", "Least distance of particles from a wall; negative: how far they may go behind it", "spacings",
   "[-1, 0.5]", ROW_REAL, offsetof(struct _p_Stepper, guard)},
  {.name = NULL},
};

static PetscErrorCode SetSchemeFromOptions(Stepper s)
{
  const Choice *choice;

  PetscFunctionBegin;
  PetscCall(OptionsReadBlock(s->cloud->comm, "Scheme", schemes, "StepperSetFromOptions", s));
  PetscCall(ChoiceFind(s->cloud->comm, Schemes, "-scheme", s->scheme_type, &choice));
  PetscCall(ChoicesRead(Schemes, "-scheme", NULL, choice, OptionsAll(), ReadScheme, s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const char *const Forms[] = {"moment", "cleary", "morris", NULL}, *const Walls[] = {"rest", "linear", NULL};

static const OptionRow viscosity[] = {
  {"-viscosity_form",
   "Form of the viscous force; moment conserves angular momentum; cleary, Eq. (1), does, too, but is a tenth off where "
   "particles lie in layers; morris is exact for shear flow and dissipates too little at free surfaces",
   NULL, NULL, ROW_WORD, offsetof(struct _p_Stepper, viscosity.form), .words = Forms},
  {"-viscosity_wall",
   "Velocity behind a wall; rest is the wall's own, as printed, and lets the first layer slip; linear continues the "
   "liquid's velocity, for no slip at the wall's face",
   NULL, NULL, ROW_WORD, offsetof(struct _p_Stepper, no_slip), .words = Walls},
  {.name = NULL},
};

static PetscErrorCode SetViscosityFromOptions(Stepper s)
{
  PetscFunctionBegin;
  PetscOptionsBegin(s->cloud->comm, NULL, "Viscosity", "Stepper");
  PetscCall(OptionsRead(PetscOptionsObject, viscosity, "StepperSetFromOptions", s));
  PetscCall(ViscousSetFromOptions(s, PetscOptionsObject));
  PetscOptionsEnd();
  if (s->no_slip) OperatorsNoSlip(s->cloud, &s->viscosity);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const OptionRow checks[] = {
  {"-displacement_max", "Largest displacement in a step; a larger one rolls the step back", "spacings", "(0, inf)",
   ROW_REAL, offsetof(struct _p_Stepper, trial.displacement)},
  {"-energy_max",
   "Largest kinetic energy, over the most that the scene's speeds, falls and surfaces can give; more stops the run; 0: "
   "no limit, nor one of the density",
   "1", "[0, inf)", ROW_REAL, offsetof(struct _p_Stepper, trial.energy)},
  {.name = NULL},
};

static PetscErrorCode SetTrialFromOptions(Stepper s)
{
  PetscFunctionBegin;
  PetscCall(OptionsReadBlock(s->cloud->comm, "Checks of a step", checks, "StepperSetFromOptions", s));
  PetscCall(CheckDensities(s));
  s->trial.at_hand = StepperEnergyAtHand(s);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperSetFromOptions(Stepper s)
{
  PetscReal velocity;

  PetscFunctionBegin;
  PetscCall(SetSchemeFromOptions(s));
  PetscCall(SetViscosityFromOptions(s));
  PetscCall(TimeStepSetFromOptions(s));
  for (Step step = StepFirst(s); *step.edge; StepNext(&step))
    if ((*step.edge)->options) PetscCall((*step.edge)->options(&step));
  PetscCall(SetTrialFromOptions(s));
  PetscCall(PressureSetFromOptions(s->pressure));
  s->reference_velocity = velocity = StepperReferenceVelocity(s);
  if (s->ops->check) PetscCall(s->ops->check(s));
  if (velocity > 0)
    PetscCall(
      PressureSetRelaxationTime(s->pressure, s->relaxation_ratio * KernelSmoothingLength(s->cloud->kernel) / velocity));
  PetscCheckUser(velocity > 0 || s->limits.max > 0 || s->limits.fixed > 0 || StepEdgesBound(s, 1) < PETSC_MAX_REAL,
                 s->cloud->comm,
                 "no motion or force in the scene bounds the time step: give -time_step or -time_step_max (s)");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperView(Stepper stepper, PetscViewer viewer)
{
  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(viewer, "Scheme: %s, CFL %g\n", stepper->scheme_type, (double)stepper->limits.cfl));
  PetscCall(TimeStepView(stepper, viewer));
  if (stepper->ops->view) PetscCall(stepper->ops->view(stepper, viewer));
  PetscCall(PressureView(stepper->pressure, viewer));
  PetscCall(TensionView(stepper->tension, viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperSetRelaxation(Stepper stepper, PetscBool relaxing, PetscReal size)
{
  PetscFunctionBegin;
  stepper->relaxing        = relaxing;
  stepper->now.damping     = relaxing ? RELAXATION_DAMPING : 1;
  stepper->relaxation_step = relaxing ? size : 0;
  StepHook(stepper, freeze, &step, relaxing);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool StepperRepairsAtOnce(Stepper stepper)
{
  return (PetscBool)(stepper->ops->at_once && !PressureTakesDivergence(stepper->pressure));
}

PetscErrorCode StepperForesee(Stepper stepper, PetscReal start, PetscReal end)
{
  PetscReal moment[FORESEEN];
  PetscInt  n;
  char      why[256] = "";

  PetscFunctionBegin;
  if (end == PETSC_MAX_REAL) PetscFunctionReturn(PETSC_SUCCESS);
  n                 = SceneMoments(stepper->cloud->scene, start, end, FORESEEN / 2, moment);
  stepper->now.time = start;
  for (PetscInt k = 1; k <= FORESEEN / 2 && n; k++) moment[n++] = start + (end - start) * 2 * k / FORESEEN;
  PetscCall(PetscSortReal(n, moment));
  for (PetscInt k = 0; k < n; k++) {
    stepper->now.dt = moment[k] - start;
    StepHook(stepper, check, &step, PETSC_TRUE, why, sizeof(why));
    PetscCheckUser(!why[0], stepper->cloud->comm, "%s, at %g s or before; another motion or an earlier -time_end helps",
                   why, (double)moment[k]);
  }
  SceneMoveSolids(stepper->cloud->scene, start);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperReset(Stepper stepper, PetscBool resumed, StepState *state)
{
  PetscFunctionBegin;
  PetscCall(PressureReset(stepper->pressure));
  StepHook(stepper, renew, &step, resumed, state);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperDestroy(Stepper *stepper)
{
  PetscFunctionBegin;
  PetscCall(PetscFree((*stepper)->scheme));
  PetscCall(ViscousDestroy(*stepper));
  PetscCall(StepEdgesDestroy(*stepper));
  PetscCall(PetscFree(*stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const Viscosity *StepperViscosity(Stepper stepper)
{
  return &stepper->viscosity;
}

PetscInt StepperUnderresolved(Stepper stepper)
{
  return stepper->underresolved;
}

PetscReal StepperBeside(Stepper stepper, const PetscReal x[DIM])
{
  PetscReal pressure = 0;

  for (Step step = StepFirst(stepper); *step.edge; StepNext(&step))
    if ((*step.edge)->beside && StepHas(&step)) pressure += (*step.edge)->beside(&step, x);
  return pressure;
}

PetscErrorCode StepperDoubt(Stepper stepper, StepState *state, char text[], size_t length)
{
  Step     step = StepFirst(stepper);
  PetscInt bit  = 1;

  PetscFunctionBegin;
  text[0] = 0;
  for (; *step.edge && !text[0]; StepNext(&step), bit <<= 1) {
    if ((*step.edge)->doubt && !(state->said & bit) && StepHas(&step))
      PetscCall((*step.edge)->doubt(&step, text, length));
    if (text[0]) state->said |= bit;
  }
  if (text[0] || state->said & bit) PetscFunctionReturn(PETSC_SUCCESS);
  TimeStepDoubt(stepper, text, length);
  if (text[0]) state->said |= bit;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Stores a viscosity that varies in the swarm, after a search: the first step uses it as that of the step before. */
static PetscErrorCode StoreViscosity(Stepper stepper)
{
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(StepApparentViscosity(stepper));
  PetscCall(ParticlesOpen(stepper->cloud->particles, &arrays));
  if (arrays.real[FIELD_VISCOSITY])
    PetscCall(PetscArraycpy(arrays.real[FIELD_VISCOSITY], stepper->cloud->field[FIELD_VISCOSITY], arrays.n));
  PetscCall(ParticlesClose(stepper->cloud->particles, &arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Copies the measurements of a trial into the state; the divergence is not yet times the time step. */
static void Record(const StepTrial *trial, StepState *state)
{
  const PetscReal *sum = trial->sum, inside = PetscMax(1, sum[SUM_INSIDE]);

  state->density_error  = PetscSqrtReal(sum[SUM_DENSITY2] / inside);
  state->divergence     = PetscSqrtReal(sum[SUM_DIVERGENCE2] / inside);
  state->density_mean   = sum[SUM_INSIDE] > 0 ? sum[SUM_DENSITY] / inside : 1;
  state->surface_energy = sum[SUM_SURFACE_ENERGY];
}

/* Counts an energy (J) that the fluid's motion gained, or lost if it is negative. */
static void Exchange(StepState *state, PetscReal energy)
{
  if (energy > 0)
    state->given += energy;
  else
    state->taken -= energy;
}

/* Counts the energy that the liquid's motion exchanged in a step with heat, surfaces, boundaries that move and body
   forces. The work of body forces is not counted: it is the remainder of the others. */
static void RecordExchange(const PetscReal sum[], PetscReal tension, StepState *state)
{
  Exchange(state, sum[SUM_VISCOUS_WORK] - sum[SUM_FRICTION_WORK]);
  Exchange(state, sum[SUM_FRICTION_WORK]);
  Exchange(state, tension);
  Exchange(state, sum[SUM_SOLID_WORK]);
  Exchange(state, sum[SUM_DRIVE_WORK]);
  Exchange(state, state->kinetic_energy - sum[SUM_KINETIC]);
  state->kinetic_energy = sum[SUM_KINETIC];
  state->kinetic_most   = PetscMax(state->kinetic_most, state->kinetic_energy);
}

/* The state after an accepted step of size dt. The pressures balance the forces, so they hold when these act. */
static void RecordStep(const StepTrial *trial, PetscReal force_time, PetscReal dt, PetscReal end, StepState *state)
{
  const PetscReal *sum     = trial->sum;
  PetscReal        tension = sum[SUM_TENSION_WORK];

  for (const PetscReal *of = sum + SUM_SURFACES; of <= sum + SUM_SURFACES_LAST; of += SURFACE_SUMS)
    if (of[1] > 0) tension -= of[0] * of[2] / of[1];

  state->pressure_time      = state->time + force_time * dt;
  state->time               = PetscAbsReal(end - state->time - dt) <= 1e-9 * dt ? end : state->time + dt;
  state->time_step          = dt;
  state->previous_time_step = dt;
  state->step++;
  Record(trial, state);
  state->divergence = !trial->diagnose ? NAN : dt * state->divergence;
  state->viscous_work += sum[SUM_VISCOUS_WORK];
  state->friction_work += sum[SUM_FRICTION_WORK];
  state->solid_work += sum[SUM_SOLID_WORK];
  state->drive_work += sum[SUM_DRIVE_WORK];
  state->tension_work += tension;
  state->tension_swing += PetscAbsReal(tension);
  RecordExchange(sum, tension, state);
}

PetscErrorCode StepperAdvance(Stepper stepper, PetscReal end, PetscBool diagnose, StepState *state, PetscBool *failed,
                              char why[], size_t length)
{
  Cloud      cloud = stepper->cloud;
  StepTrial *trial = &stepper->result;
  PetscReal  dt;
  PetscInt   iterations = 0, lost = state->lost;

  PetscFunctionBegin;
  SceneSetTime(cloud->scene, state->time); /* the step is that of the force now, after a restart, too */
  PetscCall(StepSize(stepper, state, end, &dt));
  stepper->now.first = (PetscBool)(state->step == 0);
  stepper->now.time  = state->time;
  stepper->now.dt    = dt;
  stepper->now.usual = state->previous_time_step;
  stepper->second    = (PetscBool)(state->step % 2 > 0);
  *failed            = PETSC_TRUE;
  if (StepperSteadyStep(stepper, 1) < STALLED * PetscAbsReal(state->time)) {
    PetscCall(PetscSNPrintf(why, length,
                            "the time step has fallen to %.1e s and does not advance the time any more, because speeds "
                            "or forces have become too large; try a smaller -time_cfl or -spacing",
                            (double)dt));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  why[0] = 0;
  StepHook(stepper, check, &step, PETSC_FALSE, why, length);
  if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
  StepHook(stepper, save, &step);
  for (PetscInt attempt = 0; attempt <= MAX_HALVINGS; attempt++, dt *= 0.5) {
    trial           = TrialStart(stepper, dt, diagnose);
    stepper->trying = PETSC_TRUE;
    StepHook(stepper, restore, &step);
    SceneSetTime(cloud->scene, state->time + stepper->force_time * dt);
    PressureSetRepair(stepper->pressure,
                      PetscMin(1, (state->step + 1) * dt / PressureRelaxationTime(stepper->pressure)));
    PetscCall(stepper->ops->step(stepper, dt, trial));
    stepper->trying = PETSC_FALSE;
    PetscCall(TrialReduce(stepper, trial));
    PetscCall(TrialCheck(stepper, dt, trial, why, length));
    iterations += trial->pressure.solver.iterations;
    state->solver_error = trial->pressure.density;
    *failed             = (PetscBool)(why[0] != 0);
    if (!*failed) break;
    state->rejected++;
    PetscCall(PetscInfo(NULL, "step of %g s rolled back: %s\n", (double)dt, why));
    PetscCall(PressureReset(stepper->pressure));
  }
  if (*failed && stepper->ops->advice) {
    TextAppend(why, length, "; ");
    TextAppend(why, length, stepper->ops->advice);
  }
  if (*failed) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CloudCommit(cloud, &state->lost, &state->outflow_energy));
  trial->lost       = state->lost - lost;
  state->iterations = iterations;
  RecordStep(trial, stepper->force_time, dt, end, state);
  stepper->underresolved = (PetscInt)trial->sum[SUM_UNDERRESOLVED];
  StepHook(stepper, commit, &step, state);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperPredict(Stepper stepper, const StepState *state, PetscReal *dt)
{
  StepTrial *trial;

  PetscFunctionBegin;
  PetscCall(StepSize(stepper, state, PETSC_MAX_REAL, dt));
  trial = TrialStart(stepper, *dt, PETSC_FALSE);
  PetscCall(CloudBegin(stepper->cloud));
  PetscCall(StepSearch(stepper, PETSC_FALSE));
  PetscCall(StepForces(stepper, *dt, PressureDensity(stepper->pressure), PETSC_FALSE, trial));
  PetscCall(StepDivergence(stepper, stepper->force_time * *dt));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperRefresh(Stepper stepper)
{
  Cloud cloud = stepper->cloud;

  PetscFunctionBegin;
  PetscCall(StepSearch(stepper, PETSC_FALSE));
  PetscCall(PetscArrayzero(cloud->field[FIELD_ACCELERATION], DIM * cloud->n_owned)); /* StepTension may add to it */
  PetscCall(StepTension(stepper, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperMeasure(Stepper stepper, StepState *state)
{
  StepTrial *trial = TrialStart(stepper, 0, PETSC_FALSE);

  PetscFunctionBegin;
  PetscCall(CloudBegin(stepper->cloud));
  PetscCall(StepSearch(stepper, PETSC_FALSE));
  PetscCall(StoreViscosity(stepper));
  PetscCall(TrialDiagnose(stepper, trial));
  PetscCall(TrialReduce(stepper, trial));
  Record(trial, state);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperPrepare(Stepper stepper)
{
  Cloud     cloud = stepper->cloud;
  StepState state = {0};
  PetscReal dt;

  PetscFunctionBegin;
  PetscCall(StepSize(stepper, &state, PETSC_MAX_REAL, &dt));
  PetscCall(StepSearch(stepper, PETSC_FALSE));
  PetscCall(StepApparentViscosity(stepper));
  PetscCall(PetscArraycpy(cloud->field[FIELD_VELOCITY_STAR], cloud->field[FIELD_VELOCITY], DIM * cloud->n_total));
  PetscCall(StepDivergence(stepper, 0));
  PetscCall(PetscArrayzero(cloud->field[FIELD_CAPILLARY], cloud->n_owned));
  PetscCall(PetscArrayzero(cloud->field[FIELD_CAPILLARY_SLOPE], DIM * cloud->n_owned));
  PetscCall(PressureSetUp(stepper->pressure, dt));
  PetscCall(ViscousPrepare(stepper));
  PetscCall(PressureReset(stepper->pressure));
  PetscFunctionReturn(PETSC_SUCCESS);
}
