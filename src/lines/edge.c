/* Contact lines in a step. Hysteresis: the resistance of a line slows or stops the velocity after the pressure. A line
   whose angle depends on its speed: its capillary number follows the velocity. */
#include "../stepper/edge.h"
#include "lines.h"

#define NAME "contact_line"

typedef struct {
  PetscReal fastest; /* largest capillary number of a line in the step, of this rank */
  PetscBool said;    /* by Doubt */
} Line;

static PetscBool On(Stepper stepper)
{
  return (PetscBool)(TensionReach(StepperTension(stepper)) > 0);
}

static PetscErrorCode Kick(Stepper stepper, PetscReal dt, StepTrial *trial)
{
  Cloud cloud = StepperCloud(stepper);

  PetscFunctionBegin;
  ((Line *)StepEdgeData(stepper, NAME))->fastest = LinesFastest(StepperTension(stepper));
  if (TensionHasLaw(StepperTension(stepper))) LinesMove(StepperTension(stepper), cloud, dt);
  PetscCall(
    LinesResist(StepperTension(stepper), cloud, dt, cloud->field[FIELD_VELOCITY_NEW], &trial->sum[SUM_TENSION_WORK]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A line that moves so fast that its angle at rest does not describe it. */
static PetscErrorCode Doubt(Stepper stepper, char text[], size_t length)
{
  Line     *line = (Line *)StepEdgeData(stepper, NAME);
  PetscReal Ca;

  PetscFunctionBegin;
  if (line->said || TensionHasLaw(StepperTension(stepper))) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Allreduce(&line->fastest, &Ca, 1, MPIU_REAL, MPIU_MAX, StepperCloud(stepper)->comm));
  if (Ca < FAST_LINE) PetscFunctionReturn(PETSC_SUCCESS);
  line->said = PETSC_TRUE;
  PetscCall(PetscSNPrintf(text, length,
                          "a contact line moves at the capillary number %.2g with the angle of a line at rest, so "
                          "liquid spreads too far and recedes too slowly; -wall_contact_law has other angles",
                          (double)Ca));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define HYSTERESIS "a contact angle with hysteresis"
#define LAW        "-wall_contact_law"
#define WET        "-<solid>_contact_angle"

static PetscBool HasHysteresis(Scene scene, Tension tension)
{
  return (PetscBool)(tension && TensionHasHysteresis(tension));
}

static PetscBool HasLaw(Scene scene, Tension tension)
{
  return (PetscBool)(tension && TensionHasLaw(tension));
}

static PetscBool HasAngles(Scene scene, Tension tension)
{
  return (PetscBool)(tension && TensionHasAngles(tension));
}

static PetscBool SolidsWet(Scene scene, Tension tension)
{
  return (PetscBool)(scene && TensionSolidsWet(scene));
}

static const Feature features[] = {
  {HYSTERESIS, HasHysteresis}, {LAW, HasLaw}, {FEATURE_ANGLES, HasAngles}, {WET, SolidsWet}, {.name = NULL}};
static const Refusal refusals[] = {
  {HYSTERESIS, NEEDS, FEATURE_CONSISTENT, ", the default"},
  {LAW, NEEDS, FEATURE_CONSISTENT, ", the default"},
  {WET, NEEDS, "-tension_type " TENSION_CURVATURE, ", the default"},
  {.one = NULL},
};

static const EdgeField fields[] = {{FIELD_LINE, HasLaw, NULL}, {.needed = NULL}};

const Edge ContactEdge = {.name      = NAME,
                          .fields    = fields,
                          .gauge     = &GaugeSpread,
                          .features  = features,
                          .refusals  = refusals,
                          .data_size = sizeof(Line),
                          .on        = On,
                          .kick      = Kick,
                          .doubt     = Doubt};
