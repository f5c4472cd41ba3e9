/* Log events and stages of -log_view. */
#include "base.h"

static PetscLogEvent Events[EVENT_COUNT];
static PetscLogStage Stages[STAGE_COUNT];

static const char *const EventNames[EVENT_COUNT] = {
  [EVENT_DRIFT] = "SphDrift",         [EVENT_SEARCH] = "SphSearch",
  [EVENT_FORCES] = "SphForces",       [EVENT_DIVERGENCE] = "SphDivergence",
  [EVENT_PROJECT] = "SphProject",     [EVENT_KICK] = "SphKick",
  [EVENT_HALO] = "SphHalo",           [EVENT_MIGRATE] = "SphMigrate",
  [EVENT_NEIGHBORS] = "SphNeighbors", [EVENT_MOMENTS] = "SphMoments",
  [EVENT_SURFACE] = "SphSurface",     [EVENT_VISCOSITY] = "SphViscosity",
  [EVENT_TENSION] = "SphTension",     [EVENT_SOURCE] = "SphSource",
  [EVENT_ASSEMBLE] = "SphAssemble",   [EVENT_SOLVE] = "SphSolve",
  [EVENT_RESIDUAL] = "SphResidual",   [EVENT_GRADIENT] = "SphGradient",
  [EVENT_SHIFT] = "SphShift",         [EVENT_GUARD] = "SphGuard",
  [EVENT_PACKING] = "SphPacking",     [EVENT_OUTPUT] = "SphOutput",
  [EVENT_GAUGES] = "SphGauges",       [EVENT_RESAMPLING] = "SphResampling",
};

static const char *const StageNames[STAGE_COUNT] = {
  [STAGE_PACKING] = "Packing", [STAGE_STEPS] = "Steps", [STAGE_OUTPUT] = "Output"};

PetscErrorCode LogRegister(void)
{
  static PetscBool registered = PETSC_FALSE;
  PetscClassId     class_id;

  PetscFunctionBeginUser;
  if (registered) PetscFunctionReturn(PETSC_SUCCESS);
  registered = PETSC_TRUE;
  PetscCall(PetscClassIdRegister("isph", &class_id));
  for (PetscInt e = 0; e < EVENT_COUNT; e++) PetscCall(PetscLogEventRegister(EventNames[e], class_id, &Events[e]));
  for (PetscInt s = 0; s < STAGE_COUNT; s++) PetscCall(PetscLogStageRegister(StageNames[s], &Stages[s]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscLogEvent LogEvent(EventId event)
{
  return Events[event];
}

PetscLogStage LogStage(StageId stage)
{
  return Stages[stage];
}

PetscErrorCode LogPairFlops(PetscInt64 n, PetscInt each)
{
  PetscFunctionBegin;
  PetscCall(PetscLogFlops((PetscLogDouble)each * (PetscLogDouble)n));
  PetscFunctionReturn(PETSC_SUCCESS);
}
