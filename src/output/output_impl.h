/* Private to the folder output. */
#ifndef ISPH_OUTPUT_IMPL_H
#define ISPH_OUTPUT_IMPL_H

#include "../storage/storage.h"
#include "output.h"

/* A schedule: multiples of an interval (s). next: the number of the multiple that is due next. */
typedef struct {
  PetscReal  interval;
  PetscInt64 next;
} Schedule;

#define SCHEDULE_UNSET PETSC_MIN_INT

/* A snapshot that is on disk, as the XDMF file needs it. */
typedef struct {
  PetscInt  index, step, n; /* n: number of particles */
  PetscReal time;           /* s */
  PetscInt  precision;      /* bytes of a real number */
  unsigned  fields;         /* bit f: field f of SnapshotFieldAt is in it */
} SnapshotEntry;

/* The fields that a snapshot may have: the stored reals, then id, body, surface, layer. */
#define SNAPSHOT_FIELDS (FIELD_STORED_COUNT + 4)
typedef struct {
  Column      column;
  const char *meaning;
  PetscInt    width;   /* numbers a particle */
  PetscInt    integer; /* the IntFieldId; -1: a real field */
} SnapshotField;

/* What goes into the snapshots. */
typedef struct {
  struct {
    PetscInt count;
    char    *name[SNAPSHOT_FIELDS + 1];
  } named;                  /* as the user gave them */
  unsigned  fields;         /* bits, as in SnapshotEntry */
  PetscBool region;         /* only particles in lower .. upper */
  PetscReal corner[2][DIM]; /* m: lower, upper */
  PetscInt  compression;    /* HDF5's deflate, 0 to 9 */
  PetscBool walls, precise; /* wall particles too; double precision */
} SnapshotSetup;

struct _p_Output {
  MPI_Comm       comm;
  PetscMPIInt    rank, size;
  Cloud          cloud;  /* borrowed */
  Gauges         gauges; /* borrowed */
  char           folder[PETSC_MAX_PATH_LEN];
  char          *options;                  /* the user's, one a line, before solvers add defaults of their own */
  PetscBool      overwrite, ready, solids; /* solids: solids.h5 is written */
  Schedule       series, snapshot, checkpoint;
  SnapshotSetup  content;
  PetscInt       series_step, snapshot_step;                  /* of the last line and the last snapshot; -1: none */
  PetscReal     *line;                                        /* the last line of the series, time and step first */
  FILE          *series_file, *table_file[GAUGE_TABLES_MOST]; /* rank 0 */
  SnapshotEntry *entry;                                       /* [entries], the same on every rank */
  PetscInt       entries, entry_capacity;
  PetscReal      wall_start, wall_before;  /* s: MPI_Wtime at the start; spent before the restart */
  PetscReal      clock_interval, clock_at; /* s: between checkpoints by the clock; MPI_Wtime at the last checkpoint */
  PetscBool      pressed;                  /* OutputReadSnapshot has found all particles of walls */
  PetscBool      locked;                   /* this run holds the folder's lock */
};

/* OutputWallTime - s that the run has taken, earlier starts included. Not collective. */
static inline PetscReal OutputWallTime(Output output)
{
  return output->wall_before + (PetscReal)MPI_Wtime() - output->wall_start;
}

/* Rounding allowed when a time is compared with a multiple of an interval, in intervals. */
#define SCHEDULE_ROUNDING 1e-9
/* The largest number of a multiple: whole numbers up to here are exact as reals. */
#define SCHEDULE_MOST 9e15

/* ScheduleAfter - the number of the first multiple behind a time (s). ScheduleReached - whether the next multiple has
   come. Not collective. */
static inline PetscInt64 ScheduleAfter(const Schedule *schedule, PetscReal time)
{
  if (schedule->interval <= 0) return 0;
  return (PetscInt64)PetscFloorReal(
           PetscMax(-SCHEDULE_MOST, PetscMin(time / schedule->interval + SCHEDULE_ROUNDING, SCHEDULE_MOST))) +
         1;
}

static inline PetscBool ScheduleReached(const Schedule *schedule, PetscReal time)
{
  if (schedule->interval <= 0) return PETSC_FALSE;
  return (PetscBool)(time / schedule->interval + SCHEDULE_ROUNDING >= (PetscReal)schedule->next);
}

/* --- folder.c: the run folder and the files in it --- */
/* OutputPath - <folder>/<name>. Not collective. */
PetscErrorCode OutputPath(Output output, const char name[], char path[PETSC_MAX_PATH_LEN]);
/* FolderStatus - rank 0's errno decides for all: a UserError "Cannot <doing> <path>: <reason>" unless it is zero.
   Collective. */
PetscErrorCode FolderStatus(Output output, int error, const char doing[], const char path[]);
/* FolderMake - makes the run folder and its parents. Collective. */
PetscErrorCode FolderMake(Output output);
/* FolderClear - refuses (UserError) a folder that holds a run, or removes the files of that run with -output_overwrite.
   Collective. */
PetscErrorCode FolderClear(Output output);
/* FolderHolds - whether the file lies in the run folder. Collective. */
PetscErrorCode FolderHolds(Output output, const char file[], PetscBool *same);
/* FolderNumbers - the numbers of the files <prefix><digits>.h5 of a folder, ascending, in an array to be freed. Rank 0
   only. */
PetscErrorCode FolderNumbers(const char folder[], const char prefix[], PetscInt *count, PetscInt **numbers);
/* FolderCommit - gives a finished file (written as <name>.tmp) its name; sync: after it has reached the disk.
   FolderDiscard - removes <name>.tmp. Collective. */
PetscErrorCode FolderCommit(Output output, const char name[], PetscBool sync);
PetscErrorCode FolderDiscard(Output output, const char name[]);

/* CHECKPOINT_BY_CLOCK - the name of the checkpoint by the clock. */
#define CHECKPOINT_BY_CLOCK "checkpoint_clock.h5"

/* --- lock.c: the lock of the run folder --- */
/* FolderLock - makes the lock; refuses (UserError) a folder in which another run is going on, and a folder that some
   ranks do not see. FolderUnlock - removes the lock; the end of the program does so, too. FolderStands - refuses
   (UserError) to go on without the lock: the folder was removed or moved. Collective. */
PetscErrorCode FolderLock(Output output);
PetscErrorCode FolderUnlock(Output output);
PetscErrorCode FolderStands(Output output);

/* --- description.c: options.opts and version.txt --- */
/* DescribeRun - writes both files; same: the run in the folder is continued. Collective. */
PetscErrorCode DescribeRun(Output output, PetscBool same);

/* --- restart_scene.c: what a scene and the scene of a checkpoint must have in common --- */
/* RestartSceneCheck - stored: CloudIdentity of the checkpoint, known on rank 0. Refuses (UserError) the checkpoint if
   this differs, and names the differences. An empty identity is of an older version: the checkpoint is accepted, and a
   line says so. RestartOptionsSay - stored: OutputOptions of the checkpoint, known on rank 0. Prints which options have
   changed, and which of these act at the start of a run only. Collective. */
PetscErrorCode RestartSceneCheck(Output output, const char file[], const char stored[]);
PetscErrorCode RestartOptionsSay(Output output, const char stored[]);

/* --- rings.c --- */
/* RestartTurns - whether the scene is in space and the text of RestartSceneCheck one of rings. RestartRingsCheck -
   refuses (UserError) rings of another liquid, or that do not fill the box or carry too little, and a spacing that does
   not adapt. RestartFillIn - gives n rows of rings a field that they lack. RestartTurn - makes the rings in the swarm
   the particles of the scene; disturbance: see OutputRestart. All but RestartFillIn are collective. */
PetscBool      RestartTurns(Output output, const char stored[]);
PetscErrorCode RestartRingsCheck(Output output, const char file[], const char stored[], H5File *h5);
void           RestartFillIn(FieldId f, const ParticleArrays *rows);
PetscErrorCode RestartTurn(Output output, const char file[], const char disturbance[]);

/* --- restart_check.c --- */
/* RestartCheckParticles - refuses (UserError) particles that no run leaves in a checkpoint: numbers that are not
   finite, positions outside the box, bodies that the scene does not have. Collective. */
PetscErrorCode RestartCheckParticles(Output output, const char file[]);

/* --- table.c: tables of comma-separated values that grow line by line and whose first columns are time and step --- */
#define LINE_LENGTH 65536 /* bytes of a line: 100 for each column that a run can have */
/* TableOpen - opens <folder>/<name> to append; a new file gets the head line. same: the run in the folder is continued,
   so lines behind restart_step are cut off. *last: the step of the last line, or -1. Collective. */
PetscErrorCode TableOpen(Output output, const char name[], const char head[], PetscBool same, PetscInt restart_step,
                         FILE **file, PetscInt *last);
/* TableWrite - count lines: time, step, then 'width' values with 'digits' digits. Rank 0; returns an errno. */
int TableWrite(FILE *file, const StepState *state, PetscInt digits, PetscInt count, PetscInt width,
               const PetscReal values[]);

/* --- series.c: series.csv, with a line for each due step, and the tables of the gauges, with a block of lines for each
   snapshot --- */
/* SeriesStart - opens the files as TableOpen does; SeriesWrite - adds a line; SeriesWriteTables - adds a block to each
   table; SeriesFinish - closes the files. Collective. */
PetscErrorCode SeriesStart(Output output, PetscBool same, const StepState *state);
PetscErrorCode SeriesWrite(Output output, const StepState *state);
PetscErrorCode SeriesWriteTables(Output output, const StepState *state, PetscBool events);
PetscErrorCode SeriesFinish(Output output);

/* --- snapshot_fields.c --- */
/* SnapshotSetFromOptions - reads -snapshot_..., inside an options block. SnapshotCheck - refuses (UserError) bad
   values, after the block. Collective. */
PetscErrorCode SnapshotSetFromOptions(Output output, OptionItems PetscOptionsObject);
PetscErrorCode SnapshotCheck(Output output);
/* SnapshotFieldAt - field f of 0 .. SNAPSHOT_FIELDS - 1. SnapshotUnit - its unit in the scene's dimensions, "1" for a
   pure number. Not collective. */
SnapshotField SnapshotFieldAt(PetscInt f);
const char   *SnapshotUnit(Output output, PetscInt f);

/* SnapshotName - the name of the file with an index. Not collective. */
void SnapshotName(PetscInt index, char name[64]);

/* --- snapshot.c --- */
/* SnapshotScan - finds the snapshots of the folder up to a step and removes later ones. Collective. */
PetscErrorCode SnapshotScan(Output output, PetscInt restart_step);
PetscErrorCode SnapshotWrite(Output output, const StepState *state);

/* --- solids.c --- */
/* SolidsWrite - writes where the dummy particles of solids are at the start into solids.h5, for pictures.
   Collective. */
PetscErrorCode SolidsWrite(Output output);

/* --- paraview.c --- */
/* XdmfWrite - snapshots.xdmf, which names all snapshots on disk as one series; replaces the old one at once.
   Collective. VtkWrite - adds to an open snapshot the group VTKHDF, whose data sets are links to the fields. VTK 9.1
   and ParaView 5.10 and later then read the snapshot as a file of points. Collective. */
PetscErrorCode XdmfWrite(Output output);
PetscErrorCode VtkWrite(H5File *h5, const SnapshotEntry *entry, Rows *rows);

#endif
