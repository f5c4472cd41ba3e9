/* Private to sim/. */
#ifndef ISPH_SIM_TYPES_H
#define ISPH_SIM_TYPES_H

#include "../base/json.h"
#include "sim.h"

#define REST_COLUMNS 16
/* Columns of the series that must rest, and their curves. */
typedef struct {
  struct {
    PetscInt count;
    char    *text[REST_COLUMNS];
  } names;
  PetscInt   column[REST_COLUMNS];  /* of a line of the series */
  PetscReal *curve;                 /* [lines][1 + count]: time (s) and values; rank 0 */
  PetscInt   lines, capacity, next; /* next: so many lines are judged next */
} RestWatch;

/* The progress line. */
typedef struct {
  double    started; /* s, on the program's clock */
  PetscReal start_time;
  PetscInt  start_step, iterations;
  PetscBool underresolved; /* the line on underresolved liquid was printed */
} Progress;

struct _p_Sim {
  MPI_Comm      comm;
  Domain        domain;
  Kernel        kernel;
  Scene         scene;
  Particles     particles;
  Cloud         cloud;
  Tension       tension;
  Packing       packing;
  Pressure      pressure;
  Stepper       stepper;
  Spectrum      spectrum;
  Gauges        gauges;
  Output        output;
  StepState     state;
  PackingReport report;
  PetscReal     stop; /* s: SimSetEnd */
  PetscReal     time_end, progress_interval, wall_clock_limit, wall_clock_silence, relaxation_time, relaxation_step;
  PetscInt      steps_max, ranks; /* ranks: 0: mpiexec was started by the user */
  Progress      progress;
  PetscBool     embedded, writes, begun, rests; /* writes: into a run folder; rests: -stop_at_rest ends the run */
  PetscInt      steps;                          /* of this start of the program */
  const char   *interrupted;                    /* what ends the run early; NULL: nothing has */
  PetscBool     has_end, dry_run;
  PetscViewer   monitor; /* NULL: none */
  PetscInt      monitor_lines;
  PetscBool     monitor_csv, monitor_draw;
  RestWatch     rest;
  char          dump[PETSC_MAX_PATH_LEN], list[PETSC_MAX_PATH_LEN]; /* files of options; empty: none */
  char          scene_json[PETSC_MAX_PATH_LEN];
  char          word[PETSC_MAX_PATH_LEN]; /* of the options to print; empty: none */
  char          restart[PETSC_MAX_PATH_LEN], disturbance[PETSC_MAX_PATH_LEN];
  char          measure[PETSC_MAX_PATH_LEN]; /* the folder of a run that is done; empty: none */
};

PetscErrorCode ProgressStart(Sim sim, Progress *progress);
/* TimeText - a simulated time (s) in s, ms, us or ns, the unit in which the end of the run is at least one; returns
   'text'. Not collective. */
#define TIME_LENGTH 32
const char *TimeText(Sim sim, PetscReal time, char text[TIME_LENGTH]);
/* ProgressStep - prints when due: simulated time, step, time step, iterations, time to go; at the end a summary.
 * Collective. */
PetscErrorCode ProgressStep(Sim sim, Progress *progress, PetscBool last);
/* BudgetStart - writes energy and density at the start of a run into the state. Collective. */
PetscErrorCode BudgetStart(Sim sim);
/* BudgetChanged - counts the energy of a state that another program has changed; before: the totals until then.
   Collective. */
PetscErrorCode BudgetChanged(Sim sim, const GaugeTotals *before);
/* BudgetKeep - keeps the potential energy in the state before it is written. BudgetRestart - counts by how much the
   options of a restart have changed it: of gravity, for one. Collective. */
PetscErrorCode BudgetKeep(Sim sim);
PetscErrorCode BudgetRestart(Sim sim);
/* BudgetReport - prints density error, divergence, energy residual and volume of the present state against the start,
   and the dominant error. Collective. */
PetscErrorCode BudgetReport(Sim sim);
/* MonitorSetFromOptions - -monitor [ascii|ascii:file|ascii:file.csv:ascii_csv|draw], see monitor.c; MonitorStep - a
   line, or a picture, of the step; MonitorDestroy. Collective. */
PetscErrorCode MonitorSetFromOptions(Sim sim);
PetscErrorCode MonitorStep(Sim sim);
PetscErrorCode MonitorDestroy(Sim sim);
/* RestSetFromOptions - reads -stop_at_rest; RestSetUp - looks its columns up, refuses (UserError) unknown ones, once
   the gauges know theirs; RestCheck - whether they rest after this step, with a line that says so; RestDestroy.
   Collective. */
PetscErrorCode RestSetFromOptions(Sim sim);
PetscErrorCode RestSetUp(Sim sim);
PetscErrorCode RestCheck(Sim sim, PetscBool *rests);
PetscErrorCode RestDestroy(Sim sim);
/* RefuseCombinations - refuses (UserError) features that cannot be used together, of the parts of sim that have read
   their options so far. RefusalsHelp - prints all these pairs of features, for -help. Collective. RefusalsJson - writes
   them. Not collective. */
PetscErrorCode RefuseCombinations(Sim sim);
PetscErrorCode RefusalsHelp(MPI_Comm comm);
void           RefusalsJson(Json *json);
/* DEEDS - the title of the options that say what to do with the scene, not what it is. FileWrite - writes a file by a
   function on rank 0; refuses (UserError) a path that cannot be written; an empty path: none. what: the
   file is. Collective. */
#define DEEDS "Instead of a run"
typedef PetscErrorCode (*FileWriter)(Sim sim, FILE *file);
PetscErrorCode FileWrite(Sim sim, const char path[], const char what[], FileWriter write);
/* OthersVisit - visits the options that no class has read: those of PETSc's solvers. Not collective. */
typedef void (*OtherVisitor)(void *context, const char name[], const char value[]);
PetscErrorCode OthersVisit(OtherVisitor visit, void *context);
/* DumpOptions - writes the options of the scene to the files that the user wants. Collective. */
PetscErrorCode DumpOptions(Sim sim);
/* ShapeVolume - volume (m3, in two dimensions m2) of a body's shape in the box, outside solids (solid = -1); of a solid
   of this index, of the part near its surface that has dummy particles: midpoints of cells of a quarter of the spacing.
   Not collective. */
PetscReal ShapeVolume(Sim sim, Body body, PetscInt solid);
/* FillingsView - warns of emitters that bring more or less than their options say: the lattice fills their shape with
   whole particles. Not collective. */
PetscErrorCode FillingsView(Sim sim, PetscViewer viewer);
/* Sums over the timed steps: their number, the number n of liquid particles, n^2, wall time, wall time times n. */
typedef struct {
  PetscReal steps, n, n2, time, time_n; /* 1, 1, 1, s, s */
  PetscReal late_steps, late;           /* of the second half: steps, and simulated time, s */
  PetscReal covered, last;              /* simulated time of all, and of the last step, s */
} StepTimes;
/* What a run takes: its steps (1), and the wall time of a step (s). rehearsed: the rehearsed share of the run's time
   (1), with a spacing 'coarser' times as large (1). coarser = 0: the estimate is from the trial steps alone, which were
   the whole run if 'rehearsed' is 1. start, mean, end: liquid particles at the start, in the mean over its time, and at
   the end. */
typedef struct {
  PetscReal steps, step_time, rehearsed, coarser, start, mean, end;
} RunEstimate;
/* TrySteps - computes and times some steps, emitters included; the particles move. Collective. */
PetscErrorCode TrySteps(Sim sim, StepTimes *times);
/* CountLiquid - the number of liquid particles, over all ranks. Collective.
   EstimateRun - estimates what the run, of n liquid particles at its start, takes, from the trial steps and from a
   rehearsal with a coarser spacing, whose bounds of the time step give the run's. A restart, and a run of a given
   number of steps, have no rehearsal. Collective. */
PetscErrorCode CountLiquid(Sim sim, PetscInt *n);
PetscErrorCode EstimateRun(Sim sim, PetscInt n, const StepTimes *times, RunEstimate *run);
/* The models that hold for a scene. 'why' says why one does not. */
#define MODEL_WHY 160
enum { MODEL_TENSION, MODEL_VISCOSITY, MODEL_GRAVITY, MODEL_FORCES };
typedef struct {
  PetscBool tried, holds;
  char      why[MODEL_WHY];
  PetscReal center[DIM], particles; /* m, on the axis; share of the particles that rings take, 1 */
} Revolution;
typedef struct {
  PetscBool used, holds; /* used: the scene is a half already */
  char      why[MODEL_WHY];
  PetscBool gone[2 * SCENE_MAX_BODIES]; /* of the bodies, then the solids: the upper half does not have it */
} Mirror;
typedef struct {
  PetscBool holds;
  char      why[MODEL_WHY];
} Uniform;
typedef struct {
  const char *name;
  PetscBool   acts, vain; /* vain: it cannot matter, as 'why' says */
  const char *why;
} ForceFound;
typedef struct {
  const char *none; /* symmetry is not looked for with this; NULL: it is */
  Revolution  revolution[DIM];
  Mirror      mirror[DIM];
  Uniform     uniform[DIM]; /* along: a plane */
  ForceFound  force[MODEL_FORCES];
} SceneModel;
/* ModelFind - finds the models that hold for the scene. ModelJson - writes them into the open object of
   scene.json. Not collective. ModelPrint - prints them. Collective. */
void           ModelFind(Sim sim, SceneModel *found);
void           ModelJson(Sim sim, const SceneModel *found, Json *json);
PetscErrorCode ModelPrint(Sim sim, const SceneModel *found);
/* SceneFileWrite - writes scene.json, what the program knows about the scene (options/scene_json.md), into a file, or
   with path NULL into the run folder, where the particles are known. Collective. */
PetscErrorCode SceneFileWrite(Sim sim, const char path[]);
/* StartAtRest - moves the particles of the packing so that liquid at rest starts at rest: the consistent schemes settle
   it, the printed one relaxes it for -packing_relaxation_time. turned: it moves already, and is settled only.
   Collective. */
PetscErrorCode StartAtRest(Sim sim, PetscBool turned);
/* RefuseTraps - a UserError for -fp_trap. Collective. */
PetscErrorCode RefuseTraps(MPI_Comm comm);
/* RefuseUnusedOptions - a UserError naming the first option that nothing has read, with the nearest name that exists or
   the choice that the option belongs to. early: before the packing; PETSc's options pass, since PETSc may read them
   later. Collective. */
PetscErrorCode RefuseUnusedOptions(MPI_Comm comm, PetscBool early);
/* PetscNames - the names of PETSc's and SLEPc's options without their dash, from the texts of these libraries, which
   have no list of them; none if they cannot be read. Free the names with PetscNamesDestroy. Not collective. */
typedef struct {
  PetscInt n, capacity;
  char (*name)[OPTION_NAME_LENGTH]; /* [n] */
} PetscNames;
PetscErrorCode PetscNamesRead(PetscNames *names);
PetscErrorCode PetscNamesDestroy(PetscNames *names);
/* Mentions - whether a text has a word in it, in any case. Not collective. SolversHelp - prints what PETSc's solvers
   and preconditioners read that mentions a word, or with "" what those of the pressure read, and whether there is any.
   Collective. */
PetscBool      Mentions(const char text[], const char word[]);
PetscErrorCode SolversHelp(const char word[], PetscBool *any);

#endif
