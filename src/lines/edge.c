/* Contact lines in a step. Hysteresis: the resistance of a line slows or stops the velocity after the pressure. A line
   whose angle depends on its speed: its capillary number follows the velocity. */
#include "../stepper/edge.h"
#include "lines.h"

typedef struct {
  PetscReal fastest; /* largest capillary number of a line in the step, of this rank */
} Line;

static PetscBool On(const Step *step)
{
  return (PetscBool)(TensionReach(step->tension) > 0);
}

static PetscErrorCode Kick(const Step *step)
{
  Cloud cloud = step->cloud;

  PetscFunctionBegin;
  ((Line *)step->own)->fastest = LinesFastest(step->tension);
  if (TensionHasLaw(step->tension)) LinesMove(step->tension, cloud, step->dt);
  PetscCall(
    LinesResist(step->tension, cloud, step->dt, cloud->field[FIELD_VELOCITY_NEW], &step->trial->sum[SUM_TENSION_WORK]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A line that moves so fast that its angle at rest does not describe it. */
static PetscErrorCode Doubt(const Step *step, char text[], size_t length)
{
  Line     *line = (Line *)step->own;
  PetscReal Ca;

  PetscFunctionBegin;
  if (TensionHasLaw(step->tension)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Allreduce(&line->fastest, &Ca, 1, MPIU_REAL, MPIU_MAX, step->cloud->comm));
  if (Ca < FAST_LINE) PetscFunctionReturn(PETSC_SUCCESS);
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

const Edge ContactEdge = {.name      = "contact_line",
                          .fields    = fields,
                          .gauge     = &GaugeSpread,
                          .features  = features,
                          .refusals  = refusals,
                          .data_size = sizeof(Line),
                          .on        = On,
                          .kick      = Kick,
                          .doubt     = Doubt};
