/* -measure: the columns of gauges from the snapshots of a run that is done. */
#include "../bodies/bodies.h"
#include "sim_impl.h"

PetscBool SimMeasures(Sim sim)
{
  return (PetscBool)(sim->measure[0] != 0);
}

/* Refuses what the snapshots do not have. */
static PetscErrorCode Check(Sim sim)
{
  const OptionNote *gas = OptionFind("-gas");
  PetscMPIInt       size;
  PetscBool         region;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(sim->comm, &size));
  PetscCheckUser(size == 1, sim->comm, "-measure runs on one process, not %d", size);
  PetscCheckUser(!SceneHasFree(sim->scene), sim->comm,
                 "-measure cannot be used with free solids: snapshots do not have how they lie");
  PetscCheckUser(!gas || !gas->given || !strcmp(gas->value, "false"), sim->comm,
                 "-measure cannot be used with -gas: snapshots do not have the gas of each pocket");
  PetscCall(PetscOptionsHasName(NULL, NULL, "-snapshot_lower", &region));
  if (!region) PetscCall(PetscOptionsHasName(NULL, NULL, "-snapshot_upper", &region));
  PetscCheckUser(!region, sim->comm, "-measure cannot be used with the snapshots of a part of the liquid");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A FileWriter. */
static PetscErrorCode WriteMeasured(Sim sim, FILE *file)
{
  PetscInt count, *numbers;

  PetscFunctionBegin;
  PetscCall(OutputSnapshots(sim->output, sim->measure, &count, &numbers));
  PetscCall(OutputMeasured(sim->output, NULL, file));
  for (PetscInt k = 0; k < count; k++) {
    PetscCall(OutputReadSnapshot(sim->output, sim->measure, numbers[k], &sim->state));
    SceneMoveSolids(sim->scene, sim->state.time);
    PetscCall(CloudResync(sim->cloud));
    PetscCall(StepperReset(sim->stepper, PETSC_TRUE, &sim->state));
    PetscCall(StepperMeasure(sim->stepper, &sim->state));
    PetscCall(OutputMeasured(sim->output, &sim->state, file));
  }
  PetscCall(PetscFree(numbers));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SimMeasure(Sim sim)
{
  char path[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(Check(sim));
  PetscCall(PetscSNPrintf(path, sizeof(path), "%s/measured.csv", sim->measure));
  PetscCall(FileWrite(sim, path, "measured columns", WriteMeasured));
  PetscCall(PetscPrintf(sim->comm, "Columns at the times of the snapshots are in %s\n", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}
