/* Floor 8: everything a run writes, into its own folder: snapshots (HDF5 and XDMF), checkpoints, the time series and
   the tables of the gauges, the options used.

   Order of calls: Create, SetFromOptions, Restart when the run continues, SetUp, then at every state Step, and
   Checkpoint when CheckpointDue (and once at the end of the run). */
#ifndef ISPH_OUTPUT_H
#define ISPH_OUTPUT_H

#include "../gauges/gauges.h"
#include "../stepper/stepper.h"

typedef struct _p_Output *Output;

/* OutputCreate - for the particles of a cloud, and the gauges on it (both borrowed). Collective. */
PetscErrorCode OutputCreate(Cloud cloud, Gauges gauges, Output *output);
/* OutputSetFromOptions - -output_dir, -output_overwrite, -snapshot_interval (s), -series_interval (s),
   -checkpoint_interval (s), -checkpoint_wall_clock (s), -snapshot_* (what is in them). Refuses (UserError) negative
   intervals. Collective. */
PetscErrorCode OutputSetFromOptions(Output output);
/* OutputSetUp - makes the run folder and its parents, locks the folder, and writes options.opts (every option in use,
   usable with -options_file; the files that it names are copied into inputs/), version.txt and the head of series.csv.
   Refuses (UserError) a folder that cannot be written, a folder in which another run is going on, and a folder with the
   files of an earlier run; -output_overwrite removes these files. restart: the checkpoint of OutputRestart, or NULL; a
   restart in the checkpoint's own folder cuts the series and the snapshots behind the state and continues them. Call it
   when nothing else can refuse the run. Collective. */
PetscErrorCode OutputSetUp(Output output, const char restart[], const StepState *state);
/* OutputStep - writes what is due at this state: a series line, a snapshot. 'last' forces both; neither is written
   twice for one step. The first state of a run always gets both. Refuses (UserError) to go on when the disk is full or
   the folder is gone. Collective. */
PetscErrorCode OutputStep(Output output, const StepState *state, PetscBool last);
/* OutputSeriesDue - whether a state at this time (s) gets a line of the series. Not collective, same answer on all
 * ranks. */
PetscBool OutputSeriesDue(Output output, PetscReal time);
/* OutputCheckpointDue - whether a checkpoint is due at this state; never with -checkpoint_interval 0. Not collective,
 * same answer on all ranks. */
PetscBool OutputCheckpointDue(Output output, const StepState *state);
/* OutputCheckpoint - writes the swarm's stored fields and the state to <dir>/checkpoint_<step>.h5: first under a
   temporary name, fsync, then renamed; removes all others but the newest before it. The file keeps the swarm's order.
   Collective. */
PetscErrorCode OutputCheckpoint(Output output, const StepState *state);
/* OutputClockDue - whether -checkpoint_wall_clock has passed since the last checkpoint, by this rank's clock. Not
   collective. OutputByClock - writes <dir>/checkpoint_clock.h5 in place of the former file of this name; the next
   OutputCheckpoint removes it. The file must not change the run, so the caller does not bring the run into the state of
   a restart first, and a restart from this file agrees with the run to round-off only. Collective. */
PetscBool      OutputClockDue(Output output);
PetscErrorCode OutputByClock(Output output, const StepState *state);
/* OutputCheckpointName - the name of the file that OutputCheckpoint makes at a step. Not collective. */
#define OUTPUT_NAME_LENGTH 64
void OutputCheckpointName(PetscInt step, char name[OUTPUT_NAME_LENGTH]);
/* For -measure, on one process. OutputSnapshots - the numbers of a folder's snapshots, ascending, to be freed; refuses
   (UserError) a folder without any. OutputReadSnapshot - the particles become those of the snapshot, the liquid anew,
   dummies by their ids, and the state has its time and step; refuses (UserError) one that is not whole or lacks
   velocity or pressure. OutputMeasured - a line of the columns that are of the particles alone, forces NAN where
   the snapshot lacks particles of walls; state NULL: their names. */
PetscErrorCode OutputSnapshots(Output output, const char folder[], PetscInt *count, PetscInt **numbers);
PetscErrorCode OutputReadSnapshot(Output output, const char folder[], PetscInt number, StepState *state);
PetscErrorCode OutputMeasured(Output output, const StepState *state, FILE *file);
/* OutputNewest - the path of a folder becomes that of its newest checkpoint; others stay. Refuses (UserError) a folder
   without one. Collective. */
PetscErrorCode OutputNewest(Output output, char path[PETSC_MAX_PATH_LEN]);
/* OutputRestart - fills the (empty) swarm from a checkpoint and sets the state: on as many ranks as wrote it, every
   rank gets the particles it had, in their order; on another number, equal slabs of the file. Refuses (UserError) a
   file that is missing, truncated, damaged or no checkpoint, a checkpoint of another scene, numbers that no run leaves,
   and data outside the file. Writes nothing. Call OutputSetUp and CloudResync afterwards. turned: the checkpoint is of
   rings, and the scene in space; then the swarm has liquid alone, the state the time, and PackingRun follows.
   disturbance: -restart_disturbance, for such a checkpoint alone, or empty. Collective. */
PetscErrorCode OutputRestart(Output output, const char file[], const char disturbance[], StepState *state,
                             PetscBool *turned);
/* OutputEachColumn - calls visit(context, file, column, words) for each column of series.csv and of the tables of
   gauges that this run writes ("series.csv", "droplets.csv", ...), in their order, and for each field of its snapshots
   (file "snapshot"); words: those of GaugesColumnWords. Every gauge must know its options and forces. Not collective.
 */
typedef PetscErrorCode (*ColumnVisitor)(void *context, const char file[], const Column *column,
                                        const ColumnWords *words);
PetscErrorCode OutputEachColumn(Output output, ColumnVisitor visit, void *context);
/* OutputMeasure - measures the columns of series.csv now: their number, and the values of the whole scene in the order
   of OutputEachColumn, borrowed until the next line. Collective. OutputLine - the line of the series that was written
   at this step, on rank 0 in that order; NULL: there was none. Not collective. */
PetscErrorCode   OutputMeasure(Output output, const StepState *state, PetscInt *count, const PetscReal **values);
const PetscReal *OutputLine(Output output, PetscInt step);
#define OUTPUT_SCENE  "scene.json"
#define OUTPUT_SERIES "series.csv"
/* OutputText - writes a text (of rank 0) as a file of the run folder, whole or not at all. Collective. */
PetscErrorCode OutputText(Output output, const char name[], const char text[]);
/* OutputFolder - the run folder. Not collective. */
const char *OutputFolder(Output output);
/* OutputEstimate - what a run from 'start' to 'end' (s) will write: number of snapshots, bytes of a snapshot, bytes of
   a checkpoint, with the present particles; each: bytes that one more adds to either. Collective. */
PetscErrorCode OutputEstimate(Output output, PetscReal start, PetscReal end, PetscInt64 *snapshots, PetscInt64 *bytes,
                              PetscInt64 *checkpoint, PetscReal each[2]);
/* OutputOptions - the options in use as text, one a line; to be freed with PetscFree. Not collective. */
PetscErrorCode OutputOptions(char **text);
PetscErrorCode OutputDestroy(Output *output);

#endif
