/* Contact lines in a step. Hysteresis: the resistance of a line slows or stops the velocity after the pressure. A line
   whose angle depends on its speed: its capillary number follows the velocity. */
#include "stepper_impl.h"

static PetscBool On(Stepper stepper)
{
  return (PetscBool)(TensionReach(stepper->tension) > 0);
}

static PetscErrorCode Kick(Stepper stepper, PetscReal dt, StepTrial *trial)
{
  Cloud cloud = stepper->cloud;

  PetscFunctionBegin;
  trial->largest[LARGEST_LINE] = TensionFastestLine(stepper->tension);
  if (TensionHasLaw(stepper->tension)) TensionMoveLines(stepper->tension, cloud, dt);
  PetscCall(TensionApplyHysteresis(stepper->tension, cloud, dt, cloud->field[FIELD_VELOCITY_NEW],
                                   &trial->sum[SUM_TENSION_WORK]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const Edge ContactEdge = {.name = "contact_line", .on = On, .kick = Kick};
