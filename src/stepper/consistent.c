/* The consistent scheme, which is the default: all operators act at the positions in the middle of the step, with one
   neighbour search. It keeps the energy of an impact at three times the spacing that the printed scheme needs.
   ConsistentStep has its equations: v* is the velocity without pressure, all sums are at the positions in the middle, e
   is the density defect. hooks.c has what edges add to the sub-steps.

   The scheme is a leapfrog, which conserves the phase volume of an oscillation. Forces at r^n would multiply this
   volume by 1 + (w dt)^2/2 in each step. With -time_centered 0 forces do act at r^n: there is no first drift, and the
   second is r^{n+1} = r^n + dt/2 (v^n + v^{n+1}). Closure: Nair and Tomar (2014); shifting: Skillen et al. (2013). */
#include "consistent.h"

/* Of centered steps, over sqrt(h/|g|). What moves in a tank at rest does not depend on it from 0.06 to 0.4; with 0.4 in
   place of 0.25 a wave of 100 spacings is 0.7 in place of 0.5 % too fast. */
#define FORCE_LIMIT      0.25
#define FORCE_LIMIT_RAW  0.06 /* where no force is balanced: what moves in a film at rest grows in proportion */
#define RELAXATION_RATIO 5    /* time in which density errors are corrected, over h/U of the scene */

/* Whether an edge wants to know where particles have been shifted. */
static PetscBool Follows(Stepper stepper)
{
  for (Step step = StepFirst(stepper); *step.edge; StepNext(&step))
    if ((*step.edge)->shifted && StepHas(&step)) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Shifts the particles, and then what edges have them carry. */
static PetscErrorCode ShiftAll(Stepper stepper, const Shifting *shifting, PetscReal dt)
{
  const Cloud      cloud = stepper->cloud;
  const PetscReal *x     = cloud->field[FIELD_POSITION_NEW];
  PetscReal       *moved;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, DIM, &moved));
  PetscCall(PetscArraycpy(moved, x, DIM * cloud->n_fluid));
  PetscCall(Shift(cloud, shifting, stepper->guard, dt));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) moved[k] = x[k] - moved[k];
  StepHook(stepper, shifted, &step, moved);
  PetscCall(CloudRestoreWork(cloud, &moved));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ConsistentStep(Stepper stepper, PetscReal dt, StepTrial *trial)
{
  const Consistent *scheme  = (const Consistent *)stepper->scheme;
  const PetscBool   viscous = StepViscosityFused(stepper);
  Cloud             cloud   = stepper->cloud;

  PetscFunctionBegin;
  PetscCall(CloudBegin(cloud));
  /* r^{n+1/2} = r^n + dt/2 v^n */
  if (scheme->centered) PetscCall(StepDrift(stepper, dt, trial));
  if (StepTooFar(stepper, trial)) PetscFunctionReturn(PETSC_SUCCESS);
  /* rho = sum m W, n = sum V grad W, B = (-sum V grad W (x) r_ab)^-1, the free surface */
  PetscCall(StepSearch(stepper, viscous));
  PetscCall(TrialDiagnose(stepper, trial));
  /* v* = v^n + dt (nu lap v + g + tension of sheets), sigma kappa on the free surface */
  PetscCall(StepForces(stepper, dt, cloud->rest_density, viscous, trial));
  if (TrialFailed(trial)) PetscFunctionReturn(PETSC_SUCCESS);
  /* D = sum V (v*_b - v*_a).B_a grad W, grad v* */
  if (scheme->shifting.active || PressureTakesDivergence(stepper->pressure))
    PetscCall(StepDivergence(stepper, scheme->divergence_offset * dt));
  /* div (grad p/rho) = D/dt + e/(dt T), p = sigma kappa on the free surface */
  PetscCall(scheme->project(stepper, dt, &trial->pressure));
  if (TrialFailed(trial)) PetscFunctionReturn(PETSC_SUCCESS);
  /* v^{n+1} = v* - dt (grad p)/rho */
  PetscCall(StepKick(stepper, dt, trial));
  /* v^{n+1} at the surface of what rests: closer to the linear flow around it */
  if (scheme->shifting.active || PressureTakesDivergence(stepper->pressure)) PetscCall(StepCalm(stepper, dt));
  /* r^{n+1} = r^{n+1/2} + dt/2 v^{n+1} */
  PetscCall(StepDriftOn(stepper, dt, cloud->field[FIELD_POSITION], scheme->centered));
  /* r^{n+1} += dr, v^{n+1} += (dr.grad) v* */
  if (scheme->shifting.active && Follows(stepper))
    PetscCall(ShiftAll(stepper, &scheme->shifting, dt));
  else if (scheme->shifting.active)
    PetscCall(Shift(cloud, &scheme->shifting, stepper->guard, dt));
  /* no particle inside a wall */
  PetscCall(StepGuard(stepper, dt, cloud->field[FIELD_POSITION], trial));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const OptionRow options[] = {CONSISTENT_ROWS, {.name = NULL}};

PetscErrorCode ConsistentSetUp(void *owner)
{
  Stepper           stepper = (Stepper)owner;
  const Consistent *scheme  = (const Consistent *)stepper->scheme;

  PetscFunctionBegin;
  stepper->force_time = scheme->centered ? 0.5 : 0;
  if (scheme->centered) {
    stepper->limits.force_limit = FORCE_LIMIT_RAW;
    TensionStepLimits(stepper->tension, &stepper->limits.capillary_limit, &stepper->limits.capillary_most);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ConsistentView(Stepper stepper, PetscViewer viewer)
{
  const Consistent *scheme = (const Consistent *)stepper->scheme;

  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(viewer, "Shifting: %s\n", scheme->shifting.active ? "on" : "off"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ConsistentDefaults(Stepper stepper)
{
  Consistent *scheme = (Consistent *)stepper->scheme;

  PetscFunctionBegin;
  stepper->no_slip          = PETSC_TRUE;
  stepper->relaxation_ratio = RELAXATION_RATIO;
  stepper->force_time       = 0.5;
  scheme->centered          = PETSC_TRUE;
  scheme->shifting          = (Shifting){PETSC_TRUE, PETSC_FALSE};
  PetscCall(PressureSetTypes(stepper->pressure, SOURCE_DIVERGENCE, CLOSURE_FULL, GRADIENT_CORRECTED, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Centered: the new velocity is that at the end of the step, half a step after the positions of the sums. The corrected
   gradient balances the body force (pressure/balance.c). */
static PetscErrorCode CheckConsistent(Stepper stepper)
{
  Consistent *scheme = (Consistent *)stepper->scheme;

  PetscFunctionBegin;
  scheme->divergence_offset = stepper->force_time;
  if (scheme->centered && PressureGradientCorrected(stepper->pressure)) stepper->limits.force_limit = FORCE_LIMIT;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Create(Stepper stepper)
{
  PetscFunctionBegin;
  ((Consistent *)stepper->scheme)->project = StepProject;
  stepper->keeps_pressure                  = PETSC_TRUE;
  PetscCall(ConsistentDefaults(stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const SchemeOps SchemeConsistent = {.choice = {SCHEME_CONSISTENT, sizeof(Consistent), options, NULL, ConsistentSetUp},
                                    .create = Create,
                                    .check  = CheckConsistent,
                                    .view   = ConsistentView,
                                    .step   = ConsistentStep};
