/* Contact-angle hysteresis in a step: the resistance of a contact line slows or stops the velocity after the
   pressure. */
#include "stepper_impl.h"

static PetscBool On(Stepper stepper)
{
  return TensionHasHysteresis(stepper->tension);
}

static PetscErrorCode Kick(Stepper stepper, PetscReal dt, StepTrial *trial)
{
  Cloud cloud = stepper->cloud;

  PetscFunctionBegin;
  PetscCall(TensionApplyHysteresis(stepper->tension, cloud, dt, cloud->field[FIELD_VELOCITY_NEW],
                                   &trial->sum[SUM_TENSION_WORK]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const StepHooks ContactHooks = {.on = On, .kick = Kick};
