#include "stepper_impl.h"

#define MAX_HALVINGS            10
#define COMPRESSIBLE_RELAXATION 25 /* default of -pressure_relaxation_ratio: a faster repair does work on the sound */

static PetscFunctionList SchemeList = NULL;

static PetscErrorCode StepperFinalizePackage(void)
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListDestroy(&SchemeList));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode StepperRegisterAll(void)
{
  PetscFunctionBegin;
  if (SchemeList) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscRegisterFinalize(StepperFinalizePackage));
  PetscCall(PetscFunctionListAdd(&SchemeList, SCHEME_CONSISTENT, SchemeConsistent));
  PetscCall(PetscFunctionListAdd(&SchemeList, SCHEME_DENSITY_INVARIANT, SchemeDensityInvariant));
  PetscCall(PetscFunctionListAdd(&SchemeList, SCHEME_WEAKLY_COMPRESSIBLE, SchemeWeaklyCompressible));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperCreate(Cloud cloud, Tension tension, Pressure pressure, Stepper *stepper)
{
  Stepper s;

  PetscFunctionBegin;
  PetscCall(StepperRegisterAll());
  PetscCall(PetscNew(&s));
  s->cloud             = cloud;
  s->tension           = tension;
  s->pressure          = pressure;
  s->cfl               = 0.2;
  s->displacement_max  = 0.5;
  s->density_max       = 3;
  s->guard             = 0.25;
  s->energy_max        = 2;
  s->density_ratio_max = 2;
  s->shifting_strength = 2;
  s->shifting_cap      = 0.1;
  s->relaxation_ratio  = 5;
  s->damping           = 1;
  s->sound_mach        = 0.1;
  s->sound_cfl         = 0.4;
  s->density_diffusion = 0.1;
  s->sound_projected   = PETSC_TRUE;
  PetscCall(PetscStrncpy(s->scheme_type, SCHEME_CONSISTENT, sizeof(s->scheme_type)));
  *stepper = s;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What a scheme is made of, unless options say otherwise. */
static PetscErrorCode SetSchemeTypes(Stepper s)
{
  const PetscBool paper = (PetscBool)(s->scheme == SchemeDensityInvariant);

  PetscFunctionBegin;
  if (paper)
    PetscCall(PressureSetTypes(s->pressure, SOURCE_DENSITY, CLOSURE_DOUBLED, GRADIENT_SYMMETRIC, PETSC_TRUE));
  else if (s->scheme == SchemeWeaklyCompressible)
    PetscCall(PressureSetTypes(s->pressure, SOURCE_DIVERGENCE, CLOSURE_FULL, GRADIENT_SYMMETRIC, PETSC_FALSE));
  else
    PetscCall(PressureSetTypes(s->pressure, SOURCE_DIVERGENCE, CLOSURE_FULL, GRADIENT_CORRECTED, PETSC_FALSE));
  if (s->scheme == SchemeWeaklyCompressible) s->relaxation_ratio = COMPRESSIBLE_RELAXATION;
  s->shifting = s->centered = (PetscBool)!paper;
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
  PetscCheckUser(BodyMaterial(dense)->density <= s->density_ratio_max * BodyMaterial(light)->density, s->cloud->comm,
                 "-%s_density is %g times -%s_density; at most -density_ratio_max %g is stable where the two touch",
                 BodyName(dense), (double)(BodyMaterial(dense)->density / BodyMaterial(light)->density),
                 BodyName(light), (double)s->density_ratio_max);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperSetFromOptions(Stepper s)
{
  const char *const forms[] = {"cleary", "morris"}, *const walls[] = {"rest", "linear"};
  MPI_Comm comm = s->cloud->comm;
  PetscInt form = s->viscosity_form, wall;

  PetscFunctionBegin;
  PetscOptionsBegin(comm, NULL, "Scheme", "Stepper");
  PetscCall(PetscOptionsFList("-scheme", "how the pressure keeps the liquid incompressible", "StepperSetFromOptions",
                              SchemeList, s->scheme_type, s->scheme_type, sizeof(s->scheme_type), NULL));
  PetscOptionsEnd();
  PetscCall(PetscFunctionListFind(SchemeList, s->scheme_type, &s->scheme));
  PetscCheckUser(s->scheme, comm,
                 "-scheme %s is not a scheme; there are " SCHEME_CONSISTENT ", " SCHEME_DENSITY_INVARIANT
                 " and " SCHEME_WEAKLY_COMPRESSIBLE,
                 s->scheme_type);
  PetscCall(SetSchemeTypes(s));
  wall = s->scheme == SchemeDensityInvariant ? 0 : 1;
  PetscOptionsBegin(comm, NULL, "Time stepping", "Stepper");
  if (s->scheme != SchemeDensityInvariant)
    PetscCall(PetscOptionsBool("-shifting", "shift particles towards an even distribution", "StepperSetFromOptions",
                               s->shifting, &s->shifting, NULL));
  if (s->scheme != SchemeDensityInvariant)
    PetscCall(PetscOptionsBool("-shifting_conserved",
                               "shifting keeps momentum and angular momentum, at more loss of energy",
                               "StepperSetFromOptions", s->shifting_conserved, &s->shifting_conserved, NULL));
  PetscCall(PetscOptionsEList("-viscosity_form", "cleary: Eq. (1), keeps angular momentum; morris: exact for shear",
                              "StepperSetFromOptions", forms, 2, forms[form], &form, NULL));
  PetscCall(PetscOptionsEList("-viscosity_wall",
                              "velocity behind a wall: rest, the wall's own, as printed, lets the first layer slide; "
                              "linear: it goes on straight, no slip at the face",
                              "StepperSetFromOptions", walls, 2, walls[wall], &wall, NULL));
  if (s->scheme != SchemeDensityInvariant)
    PetscCall(PetscOptionsBool("-time_centered", "evaluate forces at the middle of the step: drift, kick, drift",
                               "StepperSetFromOptions", s->centered, &s->centered, NULL));
  PetscCall(ViscousSetFromOptions(s, PetscOptionsObject));
  PetscCall(PetscOptionsReal("-shifting_strength", "A in dr = -A h dt |dv| grad C (1)", "StepperSetFromOptions",
                             s->shifting_strength, &s->shifting_strength, NULL));
  PetscCall(PetscOptionsReal("-shifting_cap", "largest shift in a step (spacings)", "StepperSetFromOptions",
                             s->shifting_cap, &s->shifting_cap, NULL));
  PetscCall(PetscOptionsReal("-pressure_relaxation_ratio",
                             "time in which the divergence source repairs density errors, over h/U of the scene (1)",
                             "StepperSetFromOptions", s->relaxation_ratio, &s->relaxation_ratio, NULL));
  PetscCall(PetscOptionsReal("-time_cfl", "largest speed times time step over h (1)", "StepperSetFromOptions", s->cfl,
                             &s->cfl, NULL));
  PetscCall(PetscOptionsReal("-time_step_min", "smallest time step chosen (s)", "StepperSetFromOptions", s->step_min,
                             &s->step_min, NULL));
  PetscCall(PetscOptionsReal("-time_step_max", "largest time step chosen (s); 0: no bound", "StepperSetFromOptions",
                             s->step_max, &s->step_max, NULL));
  PetscCall(PetscOptionsReal("-time_step", "fixed time step (s); 0: chosen from the state", "StepperSetFromOptions",
                             s->step_fixed, &s->step_fixed, NULL));
  PetscCall(PetscOptionsReal("-displacement_max", "displacement in a step that rolls it back (spacings)",
                             "StepperSetFromOptions", s->displacement_max, &s->displacement_max, NULL));
  PetscCall(PetscOptionsReal("-density_max", "summed density over rest density that rolls a step back (1)",
                             "StepperSetFromOptions", s->density_max, &s->density_max, NULL));
  PetscCall(PetscOptionsReal("-energy_max",
                             "kinetic energy over all that the scene has at hand that stops the run (1); 0: not "
                             "watched",
                             "StepperSetFromOptions", s->energy_max, &s->energy_max, NULL));
  PetscCall(PetscOptionsReal("-density_ratio_max",
                             "largest ratio of the densities of two bodies; a denser drop than 4 times its film is "
                             "unstable (1)",
                             "StepperSetFromOptions", s->density_ratio_max, &s->density_ratio_max, NULL));
  PetscCall(PetscOptionsReal("-wall_guard", "distance from a wall that particles cannot go below (spacings)",
                             "StepperSetFromOptions", s->guard, &s->guard, NULL));
  if (s->scheme == SchemeWeaklyCompressible) PetscCall(CompressibleSetFromOptions(s, PetscOptionsObject));
  PetscOptionsEnd();
  s->viscosity_form = (ViscosityForm)form;
  if (wall == 1) PetscCall(OperatorsNoSlip(s->cloud, s->viscosity_form));
  PetscCheckUser(s->viscous.ratio >= 0, comm, "-viscosity_step_ratio is %g; it must not be negative",
                 (double)s->viscous.ratio);
  PetscCheckUser(s->energy_max >= 0, comm, "-energy_max is %g; it must not be negative", (double)s->energy_max);
  PetscCall(CheckDensities(s));
  s->energy_at_hand = StepperEnergyAtHand(s);
  PetscCheckUser(s->cfl > 0 && s->cfl <= 2, comm, "-time_cfl is %g; it must lie in (0, 2]", (double)s->cfl);
  PetscCheckUser(s->step_min >= 0 && s->step_max >= 0 && s->step_fixed >= 0, comm,
                 "-time_step, -time_step_min and -time_step_max must not be negative");
  PetscCheckUser(s->step_max == 0 || s->step_min <= s->step_max, comm,
                 "-time_step_min (%g s) is larger than -time_step_max (%g s)", (double)s->step_min,
                 (double)s->step_max);
  PetscCheckUser(s->displacement_max > 0, comm, "-displacement_max is %g; it must be positive",
                 (double)s->displacement_max);
  PetscCheckUser(s->density_max > 1, comm, "-density_max is %g; it must be larger than 1", (double)s->density_max);
  PetscCheckUser(s->guard >= 0 && s->guard <= 0.5, comm, "-wall_guard is %g; it must lie between 0 and 0.5 spacings",
                 (double)s->guard);
  PetscCheckUser(s->shifting_strength >= 0 && s->shifting_cap >= 0, comm,
                 "-shifting_strength and -shifting_cap must not be negative");
  PetscCheckUser(s->relaxation_ratio > 0, comm, "-pressure_relaxation_ratio is %g; it must be positive",
                 (double)s->relaxation_ratio);
  PetscCall(PressureSetFromOptions(s->pressure));
  PetscCall(PressureSetAhead(s->pressure, s->scheme == SchemeConsistent && s->centered ? 0.5 : 0));
  {
    const PetscReal velocity = StepperReferenceVelocity(s), h = KernelSmoothingLength(s->cloud->kernel);

    s->reference_velocity = velocity;
    if (s->scheme == SchemeWeaklyCompressible) PetscCall(CompressibleCheck(s, velocity));
    if (velocity > 0) PetscCall(PressureSetRelaxationTime(s->pressure, s->relaxation_ratio * h / velocity));
    PetscCheckUser(
      velocity > 0 || s->step_max > 0 || s->step_fixed > 0, comm,
      "nothing in the scene moves or pushes, so no time step follows from it: give -time_step or -time_step_max (s)");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperView(Stepper stepper, PetscViewer viewer)
{
  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(viewer, "Scheme: %s, CFL %g, shifting %s\n", stepper->scheme_type,
                                   (double)stepper->cfl, stepper->shifting ? "on" : "off"));
  if (stepper->sound_speed > 0)
    PetscCall(PetscViewerASCIIPrintf(viewer, "Sound: %g m/s, CFL %g, density diffusion %g\n",
                                     (double)stepper->sound_speed, (double)stepper->sound_cfl,
                                     (double)stepper->density_diffusion));
  PetscCall(PressureView(stepper->pressure, viewer));
  PetscCall(TensionView(stepper->tension, viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperSetDamping(Stepper stepper, PetscReal factor)
{
  PetscFunctionBegin;
  stepper->damping = factor;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperReset(Stepper stepper)
{
  PetscFunctionBegin;
  PetscCall(PressureReset(stepper->pressure));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperDestroy(Stepper *stepper)
{
  PetscFunctionBegin;
  PetscCall(ViscousDestroy(*stepper));
  PetscCall(PetscFree(*stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Kinetic energy (J) and mass (kg) of this rank's fluid. */
static void KineticEnergy(Cloud cloud, PetscReal *energy, PetscReal *mass)
{
  const PetscReal *v = cloud->field[FIELD_VELOCITY];

  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal m = cloud->rest_density[a] * cloud->volume[a];

    *mass += m;
    *energy += 0.5 * m * Dot(v + DIM * a, v + DIM * a);
  }
}

/* What CheckTrial sums over the ranks. */
enum {
  SUM_ERROR2,
  SUM_DIVERGENCE2,
  SUM_INSIDE,
  SUM_ERROR,
  SUM_SURFACE,
  SUM_VISCOUS,
  SUM_TENSION,
  SUM_INWARD,
  SUM_AREA,
  SUM_CAPILLARY,
  SUM_KINETIC,
  SUM_MASS,
  SUM_COUNT
};

/* The verdict over all ranks; 'why' says what is wrong, empty if nothing is. */
static PetscErrorCode CheckTrial(Stepper stepper, PetscReal dt, const StepTrial *trial, PetscReal sums[SUM_COUNT],
                                 char why[], size_t length)
{
  Cloud           cloud    = stepper->cloud;
  const PetscReal spacing  = cloud->domain->spacing;
  PetscReal       local[3] = {trial->displacement / spacing, trial->density, (PetscReal)trial->broken}, largest[3], all;
  PetscReal       parts[SUM_COUNT] = {[SUM_ERROR2]      = trial->error2,
                                      [SUM_DIVERGENCE2] = trial->divergence2,
                                      [SUM_INSIDE]      = (PetscReal)trial->inside,
                                      [SUM_ERROR]       = trial->error,
                                      [SUM_SURFACE]     = trial->surface,
                                      [SUM_VISCOUS]     = trial->viscous_work,
                                      [SUM_TENSION]     = trial->tension_work,
                                      [SUM_INWARD]      = trial->inward,
                                      [SUM_AREA]        = trial->area,
                                      [SUM_CAPILLARY]   = trial->capillary_area};

  PetscFunctionBegin;
  why[0] = 0;
  KineticEnergy(cloud, &parts[SUM_KINETIC], &parts[SUM_MASS]);
  PetscCallMPI(MPI_Allreduce(local, largest, 3, MPIU_REAL, MPIU_MAX, cloud->comm));
  PetscCallMPI(MPI_Allreduce(parts, sums, SUM_COUNT, MPIU_REAL, MPIU_SUM, cloud->comm));
  all = stepper->energy_at_hand * sums[SUM_MASS];
  if (trial->viscous < 0)
    PetscCall(PetscSNPrintf(why, length,
                            "the viscous solver stopped with %s (step %g s): try a smaller -viscosity_step_ratio, a "
                            "larger -viscous_ksp_max_it or -viscous_ksp_rtol",
                            KSPConvergedReasons[trial->viscous], (double)dt));
  else if (trial->pressure.reason < 0)
    PetscCall(PetscSNPrintf(why, length,
                            "the pressure solver stopped with %s after %" PetscInt_FMT
                            " iterations (step %g s): try another -pc_type, a larger -ksp_max_it or -ksp_rtol",
                            KSPConvergedReasons[trial->pressure.reason], trial->pressure.iterations, (double)dt));
  else if (largest[2] > 0)
    PetscCall(PetscSNPrintf(why, length,
                            "positions or velocities are not numbers any more (step %g s): try a smaller -time_cfl",
                            (double)dt));
  else if (largest[0] > stepper->displacement_max)
    PetscCall(PetscSNPrintf(why, length,
                            "a particle would move %.3g spacings in one step of %g s, more than -displacement_max %g: "
                            "try a smaller -time_cfl",
                            (double)largest[0], (double)dt, (double)stepper->displacement_max));
  else if (largest[1] > stepper->density_max)
    PetscCall(PetscSNPrintf(why, length,
                            "the density reaches %.3g times the rest density, more than -density_max %g: particles "
                            "have clumped; try a smaller -time_cfl, -shifting or a smaller spacing",
                            (double)largest[1], (double)stepper->density_max));
  else if (all > 0 && stepper->energy_max > 0 && sums[SUM_KINETIC] > stepper->energy_max * all)
    PetscCall(PetscSNPrintf(why, length,
                            "the kinetic energy is %.3g times all that speeds, falls and surfaces of the scene can "
                            "give, more than -energy_max %g: the run has become unstable; try a smaller -time_cfl or "
                            "spacing",
                            (double)(sums[SUM_KINETIC] / all), (double)stepper->energy_max));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The sums' part of the state; of the divergence, that over the time step. */
static void Measure(const PetscReal sums[SUM_COUNT], StepState *state)
{
  const PetscReal inside = PetscMax(1, sums[SUM_INSIDE]);

  state->density_error  = PetscSqrtReal(sums[SUM_ERROR2] / inside);
  state->divergence     = PetscSqrtReal(sums[SUM_DIVERGENCE2] / inside);
  state->density_mean   = sums[SUM_INSIDE] > 0 ? sums[SUM_ERROR] / inside : 1;
  state->surface_energy = sums[SUM_SURFACE];
}

PetscErrorCode StepperAdvance(Stepper stepper, PetscReal end, PetscBool diagnose, StepState *state, PetscBool *failed,
                              char why[], size_t length)
{
  Cloud     cloud = stepper->cloud;
  PetscReal dt, sums[SUM_COUNT];
  PetscInt  iterations = 0;

  PetscFunctionBegin;
  PetscCall(StepSize(stepper, state, end, &dt));
  stepper->first = (PetscBool)(state->step == 0);
  *failed        = PETSC_TRUE;
  for (PetscInt attempt = 0; attempt <= MAX_HALVINGS; attempt++, dt *= 0.5) {
    StepTrial trial = {0};

    SceneSetTime(cloud->scene, state->time + (stepper->centered ? 0.5 * dt : 0));
    PetscCall(stepper->scheme(stepper, dt, diagnose, &trial));
    PetscCall(CheckTrial(stepper, dt, &trial, sums, why, length));
    iterations += trial.pressure.iterations;
    state->solver_error = trial.pressure.density;
    if (!why[0]) {
      *failed = PETSC_FALSE;
      break;
    }
    state->rejected++;
    PetscCall(PetscInfo(NULL, "step of %g s rolled back: %s\n", (double)dt, why));
    PetscCall(PressureReset(stepper->pressure));
  }
  if (*failed) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CloudCommit(cloud, &state->lost));
  state->time               = PetscAbsReal(end - state->time - dt) <= 1e-9 * dt ? end : state->time + dt;
  state->time_step          = dt;
  state->previous_time_step = dt;
  state->iterations         = iterations;
  state->step++;
  Measure(sums, state);
  state->divergence = !diagnose ? NAN : dt * state->divergence;
  state->viscous_work += sums[SUM_VISCOUS];
  state->tension_work += sums[SUM_TENSION];
  if (sums[SUM_AREA] > 0) state->tension_work -= sums[SUM_INWARD] * sums[SUM_CAPILLARY] / sums[SUM_AREA];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperPredict(Stepper stepper, const StepState *state, PetscReal *dt)
{
  Cloud     cloud = stepper->cloud;
  StepTrial trial = {0};

  PetscFunctionBegin;
  PetscCall(StepSize(stepper, state, PETSC_MAX_REAL, dt));
  PetscCall(CloudBegin(cloud, PETSC_FALSE));
  PetscCall(OperatorsMoments(cloud, PETSC_FALSE));
  PetscCall(CloudUpdate(cloud, FIELD_DENSITY));
  PetscCall(OperatorsFreeSurface(cloud));
  PetscCall(StageOne(stepper, *dt, PressureDensity(stepper->pressure), PETSC_FALSE, &trial));
  PetscFunctionReturn(PETSC_SUCCESS);
}

ViscosityForm StepperViscosityForm(Stepper stepper)
{
  return stepper->viscosity_form;
}

PetscErrorCode StepperMeasure(Stepper stepper, StepState *state)
{
  Cloud     cloud = stepper->cloud;
  StepTrial trial = {0};
  PetscReal sums[SUM_COUNT];
  char      why[1];

  PetscFunctionBegin;
  PetscCall(CloudBegin(cloud, PETSC_FALSE));
  PetscCall(OperatorsMoments(cloud, PETSC_FALSE));
  PetscCall(OperatorsFreeSurface(cloud));
  PetscCall(Diagnose(stepper, PETSC_FALSE, &trial));
  PetscCall(CheckTrial(stepper, 0, &trial, sums, why, sizeof(why)));
  Measure(sums, state);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StepperPrepare(Stepper stepper)
{
  Cloud     cloud = stepper->cloud;
  StepState state = {0};
  PetscReal dt;

  PetscFunctionBegin;
  PetscCall(StepSize(stepper, &state, PETSC_MAX_REAL, &dt));
  PetscCall(OperatorsMoments(cloud, PETSC_FALSE));
  PetscCall(CloudUpdate(cloud, FIELD_DENSITY));
  PetscCall(OperatorsFreeSurface(cloud));
  PetscCall(PetscArraycpy(cloud->field[FIELD_VELOCITY_STAR], cloud->field[FIELD_VELOCITY], DIM * cloud->n_total));
  PetscCall(PetscArrayzero(cloud->field[FIELD_CAPILLARY], cloud->n_owned));
  PetscCall(PetscArrayzero(cloud->field[FIELD_CAPILLARY_SLOPE], DIM * cloud->n_owned));
  PetscCall(PressureSetUp(stepper->pressure, dt));
  PetscCall(ViscousPrepare(stepper));
  PetscCall(PressureReset(stepper->pressure));
  PetscFunctionReturn(PETSC_SUCCESS);
}
