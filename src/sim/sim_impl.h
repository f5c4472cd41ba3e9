/* Private to sim/. */
#ifndef ISPH_SIM_TYPES_H
#define ISPH_SIM_TYPES_H

#include "sim.h"

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
  PetscReal     time_end, progress_interval, wall_clock_limit, relaxation_time, relaxation_damping, relaxation_step,
    relaxation_speed;
  PetscInt    steps_max;
  PetscBool   has_end, dry_run;
  PetscViewer monitor; /* NULL: none */
  PetscInt    monitor_lines;
  PetscBool   monitor_csv, monitor_draw;
  char        dump[PETSC_MAX_PATH_LEN];
  char        restart[PETSC_MAX_PATH_LEN];
};

/* The progress line. */
typedef struct {
  double    started; /* s, on the program's clock */
  PetscReal start_time;
  PetscInt  start_step, iterations;
  PetscBool frayed; /* said that liquid tears */
} Progress;

PetscErrorCode ProgressStart(Sim sim, Progress *progress);
/* ProgressStep - prints when due: simulated time, step, time step, iterations, time to go; at the end a summary.
 * Collective. */
PetscErrorCode ProgressStep(Sim sim, Progress *progress, PetscBool last);
/* BudgetStart - the state's energy and density at the start of a run, into the state. Collective. */
PetscErrorCode BudgetStart(Sim sim);
/* BudgetReport - prints density error, divergence, energy residual and volume of the present state against the start,
   and which knob dominates. Collective. */
PetscErrorCode BudgetReport(Sim sim);
/* MonitorSetFromOptions - -monitor [ascii|ascii:file|ascii:file.csv:ascii_csv|draw], see monitor.c; MonitorStep - a
   line, or a picture, of the step; MonitorDestroy. Collective. */
PetscErrorCode MonitorSetFromOptions(Sim sim);
PetscErrorCode MonitorStep(Sim sim);
PetscErrorCode MonitorDestroy(Sim sim);
/* HelpCatch - from here on -help is on and its text kept instead of printed; HelpCaught - that is over; the text, to be
   freed by free, empty but on rank 0. Collective. */
PetscErrorCode HelpCatch(void);
PetscErrorCode HelpCaught(char **text);
/* RefuseCombinations - refuses (UserError) features that cannot be used together, of those parts of sim that have read
   their options; before more is made of them. RefusalsHelp - lists them, for -help. Collective. */
PetscErrorCode RefuseCombinations(Sim sim);
PetscErrorCode RefusalsHelp(MPI_Comm comm);
/* DumpStart - with -dump_options, from here on the help texts of all options are kept instead of printed; DumpFinish -
   they are written to the file. Collective. */
PetscErrorCode DumpStart(Sim sim);
PetscErrorCode DumpFinish(Sim sim);
/* SimEmit - liquid of emitters for the time of the state, whose energy is counted. Collective. */
PetscErrorCode SimEmit(Sim sim);
/* What steps took, with n particles of liquid: sums over those that were timed. */
typedef struct {
  PetscReal steps, n, n2, time, time_n; /* 1, 1, 1, s, s */
  PetscReal late_steps, late;           /* steps of the second half of them, and how far they went, s */
  PetscReal covered;                    /* how far all went, s */
} StepTimes;
/* What a run takes: steps (1) of step_time (s) each, and what was rehearsed: a share of the run's time (1), with
   a spacing 'coarser' times as large (1). Without 'coarser' the trial steps say it alone; they were the whole run if
   'rehearsed' is 1. */
typedef struct {
  PetscReal steps, step_time, rehearsed, coarser;
} RunEstimate;
/* TrySteps - computes some steps, for their time, with what emitters bring; the particles move. Collective. */
PetscErrorCode TrySteps(Sim sim, StepTimes *times);
/* EstimateRun - from steps that were tried, and a rehearsal of the run with a coarser spacing, whose bounds of the time
   step tell those of the run; without it for a restart or a number of steps. Collective. */
PetscErrorCode EstimateRun(Sim sim, const StepTimes *times, RunEstimate *run);
/* Relax - lets the packing come to rest for -packing_relaxation_time, or takes the result from the cache. Collective.
 */
PetscErrorCode Relax(Sim sim);
/* RefuseTraps - a UserError for -fp_trap. Collective. */
PetscErrorCode RefuseTraps(MPI_Comm comm);
/* Names of options without the dash, and the choice that each belongs to, "-packing_type poisson", or "". */
#define OPTION_NAME_LENGTH 128
typedef struct {
  char      name[OPTION_NAME_LENGTH], choice[OPTION_NAME_LENGTH];
  PetscBool body; /* of a body or solid */
} OptionName;
typedef struct {
  PetscInt    n, capacity;
  OptionName *entry; /* [n] */
} OptionNames;
/* RefuseUnusedOptions - a UserError naming the first option nobody read, with the nearest name that exists or the
   choice it belongs to. early: before the packing, options of PETSc pass, which may still be read; own: adds the names
   of the program's own options, on rank 0. Collective. */
PetscErrorCode RefuseUnusedOptions(MPI_Comm comm, PetscBool early, PetscErrorCode (*own)(MPI_Comm, OptionNames *));
/* OptionNamesFromHelp - adds those in the text of -help (which is cut), of bodies for each of the scene.
   OptionNamesPetsc - adds those of PETSc's and SLEPc's libraries; none where these cannot be read. Not collective. */
PetscErrorCode OptionNamesFromHelp(Scene scene, char help[], OptionNames *names);
PetscErrorCode OptionNamesPetsc(OptionNames *names);
PetscErrorCode OptionNamesDestroy(OptionNames *names);

#endif
