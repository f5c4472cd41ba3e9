/* The class: options, what is due when. */
#include "output_impl.h"

/* Rounding allowed when a time is compared with a multiple of an interval, in intervals. */
#define SCHEDULE_ROUNDING 1e-9

PetscErrorCode OutputPath(Output output, const char name[], char path[PETSC_MAX_PATH_LEN])
{
  size_t length, more;

  PetscFunctionBegin;
  PetscCall(PetscStrlen(output->folder, &length));
  PetscCall(PetscStrlen(name, &more));
  PetscCheck(length + more + 2 <= PETSC_MAX_PATH_LEN, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE, "Path too long: %s/%s",
             output->folder, name);
  PetscCall(PetscSNPrintf(path, PETSC_MAX_PATH_LEN, "%s/%s", output->folder, name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal OutputWallTime(Output output)
{
  return output->wall_before + (PetscReal)MPI_Wtime() - output->wall_start;
}

PetscInt64 ScheduleAfter(const Schedule *schedule, PetscReal time)
{
  if (schedule->interval <= 0) return 0;
  return (PetscInt64)PetscFloorReal(time / schedule->interval + SCHEDULE_ROUNDING) + 1;
}

PetscBool ScheduleReached(const Schedule *schedule, PetscReal time)
{
  if (schedule->interval <= 0) return PETSC_FALSE;
  return (PetscBool)(time / schedule->interval + SCHEDULE_ROUNDING >= (PetscReal)schedule->next);
}

PetscErrorCode OutputCreate(Cloud cloud, Output *output)
{
  Output o;

  PetscFunctionBegin;
  PetscCall(PetscNew(&o));
  o->comm  = cloud->comm;
  o->cloud = cloud;
  PetscCallMPI(MPI_Comm_rank(o->comm, &o->rank));
  PetscCallMPI(MPI_Comm_size(o->comm, &o->size));
  PetscCall(PetscStrncpy(o->folder, "output/run", sizeof(o->folder)));
  o->series.next = o->snapshot.next = o->checkpoint.next = SCHEDULE_UNSET;
  o->series_step = o->snapshot_step = -1;
  o->wall_start                     = MPI_Wtime();
  PetscCall(GaugesDefaults(o));
  *output = o;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputDestroy(Output *output)
{
  PetscFunctionBegin;
  if (!*output) PetscFunctionReturn(PETSC_SUCCESS);
  if ((*output)->series_file) fclose((*output)->series_file);
  PetscCall(ProbesFinish(*output));
  for (PetscInt k = 0; k < (*output)->content.names; k++) PetscCall(PetscFree((*output)->content.name[k]));
  PetscCall(PetscFree((*output)->entry));
  PetscCall(PetscFree((*output)->options));
  PetscCall(PetscFree(*output));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckInterval(Output output, const char option[], PetscReal interval)
{
  PetscFunctionBegin;
  PetscCheckUser(interval >= 0 && !PetscIsInfOrNanReal(interval), output->comm,
                 "%s is %g s; it must be zero or a positive time in seconds.", option, (double)interval);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputSetFromOptions(Output output)
{
  size_t length;

  PetscFunctionBegin;
  PetscCall(PetscFree(output->options));
  PetscCall(FolderOptions(&output->options));
  PetscOptionsBegin(output->comm, NULL, "What a run writes", "Output");
  PetscCall(PetscOptionsString("-output_dir", "Folder of the run, made with its parents", "OutputSetUp", output->folder,
                               output->folder, sizeof(output->folder), NULL));
  PetscCall(PetscOptionsBool("-output_overwrite", "Remove the files of a run the folder holds already", "OutputSetUp",
                             output->overwrite, &output->overwrite, NULL));
  PetscCall(PetscOptionsReal("-series_interval", "Time between lines of series.csv, s; 0: every step", "OutputStep",
                             output->series.interval, &output->series.interval, NULL));
  PetscCall(PetscOptionsReal("-snapshot_interval", "Time between snapshots, s; 0: only the first and the last state",
                             "OutputStep", output->snapshot.interval, &output->snapshot.interval, NULL));
  PetscCall(PetscOptionsReal("-checkpoint_interval", "Time between checkpoints, s; 0: only at the end",
                             "OutputCheckpoint", output->checkpoint.interval, &output->checkpoint.interval, NULL));
  PetscCall(SnapshotSetFromOptions(output, PetscOptionsObject));
  PetscCall(GaugesSetFromOptions(output, PetscOptionsObject));
  PetscCall(PointsSetFromOptions(output, PetscOptionsObject));
  PetscCall(ProbesSetFromOptions(output, PetscOptionsObject));
  PetscOptionsEnd();
  PetscCall(SnapshotCheck(output));
  PetscCall(GaugesCheck(output));
  PetscCall(PointsCheck(output));
  PetscCall(ProbesCheck(output));
  PetscCall(CheckInterval(output, "-series_interval", output->series.interval));
  PetscCall(CheckInterval(output, "-snapshot_interval", output->snapshot.interval));
  PetscCall(CheckInterval(output, "-checkpoint_interval", output->checkpoint.interval));
  PetscCall(PetscStrlen(output->folder, &length));
  PetscCheckUser(length > 0, output->comm, "-output_dir is empty; it must name the folder of the run.");
  PetscCheckUser(length < PETSC_MAX_PATH_LEN - 64, output->comm,
                 "-output_dir is %d characters long; at most %d are allowed.", (int)length, PETSC_MAX_PATH_LEN - 64);
  while (length > 1 && output->folder[length - 1] == '/') output->folder[--length] = '\0';
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputSetUp(Output output, PetscBool restarting)
{
  PetscFunctionBegin;
  PetscCall(FolderMake(output));
  output->ready      = PETSC_TRUE;
  output->restarting = restarting;
  if (!restarting) {
    PetscCall(FolderClaim(output, PETSC_FALSE));
    PetscCall(SeriesStart(output, PETSC_FALSE, 0));
    PetscCall(ProbesStart(output, PETSC_FALSE, 0));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ViewInterval(PetscViewer viewer, const char what[], PetscReal interval, const char otherwise[])
{
  PetscFunctionBegin;
  if (interval > 0)
    PetscCall(PetscViewerASCIIPrintf(viewer, "  %s every %g s\n", what, (double)interval));
  else
    PetscCall(PetscViewerASCIIPrintf(viewer, "  %s %s\n", what, otherwise));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputView(Output output, PetscViewer viewer)
{
  const GaugeSetup *gauge = &output->gauge;

  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(viewer, "Output: folder %s\n", output->folder));
  PetscCall(ViewInterval(viewer, "series", output->series.interval, "every step"));
  PetscCall(ViewInterval(viewer, "snapshots", output->snapshot.interval, "of the first and the last state"));
  PetscCall(SnapshotView(output, viewer));
  PetscCall(ViewInterval(viewer, "checkpoints", output->checkpoint.interval, "at the end only"));
  PetscCall(PetscViewerASCIIPrintf(viewer, "  gauges: axis %g %g m, jet radius %g m, crater radius %g m, pool %s\n",
                                   (double)gauge->axis[0], (double)gauge->axis[1], (double)gauge->jet_radius,
                                   (double)gauge->crater_radius,
                                   BodyName(SceneBody(output->cloud->scene, gauge->pool))));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputStep(Output output, const StepState *state, PetscBool last)
{
  const PetscBool every = (PetscBool)(output->series.interval <= 0);

  PetscFunctionBegin;
  PetscCheck(output->ready, output->comm, PETSC_ERR_ORDER, "Call OutputSetUp first");
  if (!output->solids) PetscCall(SolidsWrite(output));
  output->solids = PETSC_TRUE;
  if (output->checkpoint.next == SCHEDULE_UNSET)
    output->checkpoint.next = ScheduleAfter(&output->checkpoint, state->time);
  if (state->step != output->series_step &&
      (last || every || ScheduleReached(&output->series, state->time) || output->series_step < 0)) {
    PetscCall(SeriesWrite(output, state));
    output->series_step = state->step;
    output->series.next = ScheduleAfter(&output->series, state->time);
  }
  if (state->step != output->snapshot_step &&
      (last || ScheduleReached(&output->snapshot, state->time) || output->snapshot_step < 0)) {
    PetscCall(SnapshotWrite(output, state));
    PetscCall(ProbesWrite(output, state));
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

PetscErrorCode OutputOptions(char **text)
{
  PetscFunctionBegin;
  PetscCall(FolderOptions(text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const char *OutputFolder(Output output)
{
  return output->folder;
}
