/* Log events and stages of -log_view, and the refusal of bad input. */
#include "base.h"
#include <stdarg.h>
#include <stdio.h>

#define MESSAGE_LENGTH 1024

static PetscLogEvent Events[EVENT_COUNT];
static PetscLogStage Stages[STAGE_COUNT];
static PetscBool UserErrorRaised = PETSC_FALSE; /* UserError has printed its sentence and its code is on its way up */

static const char *const EventNames[EVENT_COUNT] = {
    [EVENT_HALO] = "SphHalo",       [EVENT_MIGRATE] = "SphMigrate",   [EVENT_NEIGHBORS] = "SphNeighbors",
    [EVENT_MOMENTS] = "SphMoments", [EVENT_SURFACE] = "SphSurface",   [EVENT_VISCOSITY] = "SphViscosity",
    [EVENT_TENSION] = "SphTension", [EVENT_SOURCE] = "SphSource",     [EVENT_ASSEMBLE] = "SphAssemble",
    [EVENT_SOLVE] = "SphSolve",     [EVENT_GRADIENT] = "SphGradient", [EVENT_SHIFT] = "SphShift",
    [EVENT_GUARD] = "SphGuard",     [EVENT_PACKING] = "SphPacking",   [EVENT_OUTPUT] = "SphOutput",
    [EVENT_GAUGES] = "SphGauges",
};

static const char *const StageNames[STAGE_COUNT] = {
    [STAGE_PACKING] = "Packing", [STAGE_STEPS] = "Steps", [STAGE_OUTPUT] = "Output"};

PetscErrorCode LogRegister(void)
{
  PetscClassId class_id;

  PetscFunctionBeginUser;
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

PetscErrorCode UserError(MPI_Comm comm, const char format[], ...)
{
  char        message[MESSAGE_LENGTH];
  PetscMPIInt rank;
  va_list     arguments;

  va_start(arguments, format);
  (void)vsnprintf(message, sizeof(message), format, arguments);
  va_end(arguments);
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (!rank) {
    fprintf(stderr, "isph: error: %s\n", message);
    fflush(stderr);
  }
  UserErrorRaised = PETSC_TRUE;
  return ISPH_USER_ERROR; /* bare: PetscError() would print a trace */
}

/* An error that starts anew is PETSc's; the repeats of a user error, one a PetscCall on the way up, are not printed. */
static PetscErrorCode UserErrorHandler(MPI_Comm comm, int line, const char *function, const char *file,
                                       PetscErrorCode code, PetscErrorType type, const char *message, void *context)
{
  if (type == PETSC_ERROR_INITIAL) UserErrorRaised = PETSC_FALSE;
  if (UserErrorRaised && code == ISPH_USER_ERROR) return code;
  return PetscTraceBackErrorHandler(comm, line, function, file, code, type, message, context);
}

PetscErrorCode UserErrorHandlerPush(void)
{
  PetscFunctionBeginUser;
  PetscCall(PetscPushErrorHandler(UserErrorHandler, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}
