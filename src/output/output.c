/* The class Output: its options, and what is due when. */
#include "output_impl.h"

PetscErrorCode OutputCreate(Cloud cloud, Gauges gauges, Output *output)
{
  Output o;

  PetscFunctionBegin;
  PetscCall(PetscNew(&o));
  o->comm   = cloud->comm;
  o->cloud  = cloud;
  o->gauges = gauges;
  PetscCallMPI(MPI_Comm_rank(o->comm, &o->rank));
  PetscCallMPI(MPI_Comm_size(o->comm, &o->size));
  PetscCall(PetscStrncpy(o->folder, "output/run", sizeof(o->folder)));
  o->series.next = o->snapshot.next = o->checkpoint.next = SCHEDULE_UNSET;
  o->series_step = o->snapshot_step = -1;
  o->wall_start = o->clock_at = MPI_Wtime();
  o->clock_interval           = 600;
  *output                     = o;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputDestroy(Output *output)
{
  PetscFunctionBegin;
  if (!*output) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(SeriesFinish(*output));
  PetscCall(FolderUnlock(*output));
  for (PetscInt k = 0; k < (*output)->content.named.count; k++) PetscCall(PetscFree((*output)->content.named.name[k]));
  PetscCall(PetscFree((*output)->entry));
  PetscCall(PetscFree((*output)->options));
  PetscCall(PetscFree(*output));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const OptionRow options[] = {
  {"-output_dir", "Folder of the run, made with its parents", NULL, NULL, ROW_TEXT, offsetof(struct _p_Output, folder)},
  {"-output_overwrite", "Remove the files of an earlier run in the folder", NULL, NULL, ROW_BOOL,
   offsetof(struct _p_Output, overwrite)},
  {"-series_interval", "Time between lines of series.csv; 0: every step", "s", "[0, inf)", ROW_REAL,
   offsetof(struct _p_Output, series.interval)},
  {"-snapshot_interval", "Time between snapshots (for ParaView: VTKHDF); 0: only the first and the last state", "s",
   "[0, inf)", ROW_REAL, offsetof(struct _p_Output, snapshot.interval)},
  {"-checkpoint_interval", "Time between checkpoints; 0: only at the end", "s", "[0, inf)", ROW_REAL,
   offsetof(struct _p_Output, checkpoint.interval)},
  {"-checkpoint_wall_clock",
   "Wall-clock time between checkpoints into " CHECKPOINT_BY_CLOCK
   "; each replaces the last, the next other checkpoint "
   "removes it; a run continued from it differs by round-off and the solver's tolerance; 0: none",
   "s", "[0, inf)", ROW_REAL, offsetof(struct _p_Output, clock_interval)},
  {.name = NULL},
};

PetscErrorCode OutputSetFromOptions(Output output)
{
  size_t length;

  PetscFunctionBegin;
  PetscCall(PetscFree(output->options));
  PetscCall(OutputOptions(&output->options));
  PetscOptionsBegin(output->comm, NULL, "What a run writes", "Output");
  PetscCall(OptionsRead(PetscOptionsObject, options, __func__, output));
  PetscCall(SnapshotSetFromOptions(output, PetscOptionsObject));
  PetscOptionsEnd();
  PetscCall(SnapshotCheck(output));
  PetscCall(PetscStrlen(output->folder, &length));
  PetscCheckUser(length > 0, output->comm, "-output_dir is empty; it must name the folder of the run.");
  PetscCheckUser(length < PETSC_MAX_PATH_LEN - 64, output->comm,
                 "-output_dir is %d characters long; at most %d are allowed.", (int)length, PETSC_MAX_PATH_LEN - 64);
  while (length > 1 && output->folder[length - 1] == '/') output->folder[--length] = '\0';
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputSetUp(Output output, const char restart[], const StepState *state)
{
  PetscBool same = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(FolderMake(output));
  PetscCall(FolderLock(output));
  if (restart) PetscCall(FolderHolds(output, restart, &same));
  if (!same) PetscCall(FolderClear(output));
  PetscCall(DescribeRun(output, same));
  PetscCall(SeriesStart(output, same, state));
  if (same) PetscCall(SnapshotScan(output, state->step));
  output->ready = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputStep(Output output, const StepState *state, PetscBool last)
{
  const PetscBool line = (PetscBool)(state->step != output->series_step &&
                                     (last || output->series.interval <= 0 || output->series_step < 0 ||
                                      ScheduleReached(&output->series, state->time)));
  const PetscBool picture =
    (PetscBool)(state->step != output->snapshot_step &&
                (last || ScheduleReached(&output->snapshot, state->time) || output->snapshot_step < 0));

  PetscFunctionBegin;
  PetscCheck(output->ready, output->comm, PETSC_ERR_ORDER, "Call OutputSetUp first");
  if (line || picture) PetscCall(FolderStands(output));
  if (!output->solids) PetscCall(SolidsWrite(output));
  output->solids = PETSC_TRUE;
  if (output->checkpoint.next == SCHEDULE_UNSET)
    output->checkpoint.next = ScheduleAfter(&output->checkpoint, state->time);
  if (line) {
    PetscCall(SeriesWrite(output, state));
    PetscCall(SeriesWriteTables(output, state, PETSC_TRUE));
    output->series_step = state->step;
    output->series.next = ScheduleAfter(&output->series, state->time);
  }
  if (picture) {
    PetscCall(SnapshotWrite(output, state));
    PetscCall(SeriesWriteTables(output, state, PETSC_FALSE));
    output->snapshot_step = state->step;
    output->snapshot.next = ScheduleAfter(&output->snapshot, state->time);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool OutputSeriesDue(Output output, PetscReal time)
{
  return (PetscBool)(output->series.interval <= 0 || ScheduleReached(&output->series, time));
}

PetscBool OutputCheckpointDue(Output output, const StepState *state)
{
  if (output->checkpoint.next == SCHEDULE_UNSET)
    output->checkpoint.next = ScheduleAfter(&output->checkpoint, state->time);
  return ScheduleReached(&output->checkpoint, state->time);
}

const char *OutputFolder(Output output)
{
  return output->folder;
}
