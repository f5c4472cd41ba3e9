/* Joining and splitting of particles after a step. */
#include "stepper_impl.h"

static PetscErrorCode Options(Stepper stepper)
{
  PetscFunctionBegin;
  PetscCall(ResamplingSetFromOptions(stepper->cloud, &stepper->resampling));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Guard(Stepper stepper, PetscReal dt, const PetscReal impulse[], StepTrial *trial)
{
  Cloud cloud = stepper->cloud;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid && cloud->domain->rings; a++)
    trial->largest[LARGEST_SHARE] = PetscMax(trial->largest[LARGEST_SHARE], ResamplingArea(cloud, a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Not in a step that has lost particles: the cloud then has no fields of the step any more. */
static PetscErrorCode Commit(Stepper stepper, const StepTrial *trial, StepState *state)
{
  ResamplingReport report;

  PetscFunctionBegin;
  if (!ResamplingDue(&stepper->resampling, state->step, trial->largest[LARGEST_SHARE]) || trial->lost > 0 ||
      stepper->damping < 1)
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Resample(stepper->cloud, &stepper->resampling, &report));
  state->resampling_loss += report.energy;
  state->joined += report.joined;
  state->split += report.split;
  PetscFunctionReturn(PETSC_SUCCESS);
}

const StepHooks ResamplingHooks = {.options = Options, .guard = Guard, .commit = Commit};
