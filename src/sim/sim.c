#include "../bodies/bodies.h"
#include "sim_impl.h"
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define UNEVEN 0.01 /* standard deviation of the density over the rest density; an optimised packing has 1e-4 */

/* particles a process: their sums take 0.8 ms a step, its messages 0.3 to 0.8 (tests/bench/README.md) */
#define FEW             500
#define FAREWELL_LENGTH 512
#define LOOK_AHEAD      2 /* steps */
#define JOURNAL_FILE    "log.txt"
#define STOP_FILE       "stop"

PetscErrorCode SimCreate(MPI_Comm comm, Sim *sim)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(sim));
  (*sim)->comm               = comm;
  (*sim)->time_end           = -1;
  (*sim)->stop               = PETSC_MAX_REAL;
  (*sim)->progress_interval  = 2;
  (*sim)->wall_clock_silence = 600;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SimEmbed(Sim sim)
{
  PetscFunctionBegin;
  sim->embedded           = PETSC_TRUE;
  sim->progress_interval  = 0;
  sim->wall_clock_silence = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const OptionRow options[] = {
  {"-time_start", "Time of the initial state", "s", "(-inf, inf)", ROW_REAL, offsetof(struct _p_Sim, state.time)},
  {"-time_end", "Time at which the run ends", "s", NULL, ROW_REAL, offsetof(struct _p_Sim, time_end),
   .fallback = "none"},
  {"-steps_max", "Number of steps after which the run ends; 0: no bound", "1", "[0, inf)", ROW_INT,
   offsetof(struct _p_Sim, steps_max)},
  {"-restart",
   "Checkpoint file to continue (resume) from, or the folder of a run, whose newest is taken; changed options are "
   "listed; spacing, box, kernel, solids and bodies must be the same, but for their viscosity; a scene in space with "
   "-spacing_follow begins from rings, too: they are turned about the axis x = y = 0",
   NULL, NULL, ROW_TEXT, offsetof(struct _p_Sim, restart)},
  {"-restart_disturbance",
   "Disturbance of rings that become particles in space, from which fingers grow: the share that the velocity away "
   "from "
   "the axis gains, a formula of r and z in m and the angle a from x (-pi to pi): 0.05*cos(12*a); even modes in a "
   "quarter; see -help formula",
   "1", NULL, ROW_TEXT, offsetof(struct _p_Sim, disturbance), .fallback = "none"},
  {"-progress_interval", "Wall-clock time between progress lines; 0: none but the summary at the end", "s", "[0, inf)",
   ROW_REAL, offsetof(struct _p_Sim, progress_interval)},
  {"-wall_clock_limit",
   "Wall-clock time from the start of the program, set-up included, after which the run writes a checkpoint and ends; "
   "0: none",
   "s", "[0, inf)", ROW_REAL, offsetof(struct _p_Sim, wall_clock_limit)},
  {"-wall_clock_silence",
   "Wall-clock time without a sign of life (a step, an iteration, a file) after which the run ends, since the network "
   "or a host may be gone; 0: never",
   "s", "[0, inf)", ROW_REAL, offsetof(struct _p_Sim, wall_clock_silence)},
  {"-packing_relaxation_time",
   "With -scheme density_invariant: time of a relaxation of the packing to rest before the run, without body force",
   "s", "[0, inf)", ROW_REAL, offsetof(struct _p_Sim, relaxation_time)},
  {"-packing_relaxation_step", "Time step of the relaxation; 0: as in the run", "s", "[0, inf)", ROW_REAL,
   offsetof(struct _p_Sim, relaxation_step)},
  {.name = NULL},
};

static const OptionRow deeds[] = {
  {RANKS_OPTION,
   "Processes (MPI, parallel), which the program starts by mpiexec itself; a signal or Ctrl-C then ends the run with a "
   "checkpoint "
   "however long a step is; on the command line only",
   "1", "[1, inf)", ROW_INT, offsetof(struct _p_Sim, ranks), .fallback = "those of mpiexec, or one"},
  {"-dry_run",
   "Print particles, memory, bounds of the time step, estimated time and output, and which models hold (rings, "
   "mirrors, a plane); draw the scene",
   NULL, NULL, ROW_BOOL, offsetof(struct _p_Sim, dry_run)},
  {MEASURE_OPTION,
   "Folder of a run that is done: its columns at the times of its snapshots, with gauges that are given now, go into "
   "measured.csv there; its options.opts is read first; forces need -snapshot_walls of the run",
   NULL, NULL, ROW_TEXT, offsetof(struct _p_Sim, measure), .fallback = "none"},
  {SCENE_OPTION,
   "Write what the program knows about the scene into a file (options/scene_json.md), as each run does into its folder",
   NULL, NULL, ROW_TEXT, offsetof(struct _p_Sim, scene_json)},
  {DUMP_OPTION, "Write a commented options file of the scene with all options", NULL, NULL, ROW_TEXT,
   offsetof(struct _p_Sim, dump)},
  {LIST_OPTION, "Write a list of all options, with or without a scene", NULL, NULL, ROW_TEXT,
   offsetof(struct _p_Sim, list)},
  {.name = NULL},
};

static PetscErrorCode ReadOwnOptions(Sim sim)
{
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscCall(OptionsReadBlock(sim->comm, "Run", options, "SimSetFromOptions", sim));
  PetscCall(OptionsReadBlock(sim->comm, DEEDS, deeds, "SimSetFromOptions", sim));
  PetscCall(PetscOptionsGetString(NULL, NULL, HELP_OPTION, sim->word, sizeof(sim->word), NULL));
  sim->has_end = OptionFind("-time_end")->given;
  PetscCall(PetscOptionsHasName(NULL, NULL, "-output_dir", &sim->writes));
  if (!sim->embedded) sim->writes = PETSC_TRUE;
  for (const OptionRow *row = deeds; row->name; row++)
    PetscCheckUser(row->kind != ROW_TEXT || !OptionFind(row->name)->given || ((char *)sim + row->offset)[0], sim->comm,
                   "%s needs the name of the file to write", row->name);
  PetscCallMPI(MPI_Comm_size(sim->comm, &size));
  PetscCheckUser(!sim->ranks || sim->ranks == size, sim->comm,
                 RANKS_OPTION " %" PetscInt_FMT
                              " starts mpiexec itself, but this run has %d process%s: write it on the "
                              "command line, without mpiexec",
                 sim->ranks, size, size > 1 ? "es" : "");
  if (sim->ranks) InterruptPatience();
  ProgressInterval((double)sim->progress_interval);
  InterruptLimit((double)sim->wall_clock_limit);
  InterruptSilence((double)sim->wall_clock_silence);
  PetscCall(RestSetFromOptions(sim));
  PetscCall(MonitorSetFromOptions(sim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses to start without a scene. -help without a scene gets a minimal scene, so that all classes print their
   options. */
static PetscErrorCode CheckScene(Sim sim)
{
  static const char *const least[][2] = {{"-spacing", "1"},
                                         {"-box_lower", "0,0,0"},
                                         {"-box_upper", "10,10,10"},
                                         {"-bodies", "liquid"},
                                         {"-time_step_max", "1"}};
  PetscBool                any        = OptionsAll(), set;

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(least); k++) {
    PetscCall(PetscOptionsHasName(NULL, NULL, least[k][0], &set));
    if (!set && OptionsAll()) PetscCall(PetscOptionsSetValue(NULL, least[k][0], least[k][1]));
    any = (PetscBool)(any || set);
  }
  PetscCheckUser(
    any, sim->comm,
    "no scene is given: name its file, as ./isph cases/drop_impact/case.opts or with -options_file; -help lists all "
    "options");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For GaugesSetRefresh. */
static PetscErrorCode RefreshSums(void *stepper)
{
  PetscFunctionBegin;
  PetscCall(StepperRefresh((Stepper)stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SimSetFromOptions(Sim sim, PetscBool *stop)
{
  MPI_Comm  comm = sim->comm;
  PetscBool help;

  PetscFunctionBegin;
  PetscCall(RefuseTraps(comm));
  PetscCall(OptionsForget());
  PetscCall(PetscOptionsHasHelp(NULL, &help));
  PetscCall(CheckScene(sim));
  PetscCall(ReadOwnOptions(sim));
  *stop = (PetscBool)(help || sim->dump[0] || sim->list[0] || sim->word[0]);
  PetscCall(DomainCreate(comm, &sim->domain));
  PetscCall(StepperProperties(sim->domain));
  PetscCall(DomainSetFromOptions(sim->domain));
  PetscCall(RefuseCombinations(sim));
  PetscCall(KernelCreate(comm, sim->domain->dim, &sim->kernel));
  PetscCall(KernelSetFromOptions(sim->kernel, sim->domain->spacing));
  PetscCall(SceneCreate(sim->domain, &sim->scene));
  PetscCall(SceneSetFromOptions(sim->scene));
  PetscCall(RefuseCombinations(sim));
  if (OptionsAll()) PetscCall(SceneHelp(sim->domain));
  PetscCall(TensionCreate(sim->domain, sim->scene, sim->kernel, &sim->tension));
  PetscCall(TensionSetFromOptions(sim->tension));
  PetscCall(RefuseCombinations(sim));
  PetscCall(StepperParticles(sim->scene, sim->tension, &sim->particles));
  PetscCall(ParticlesBalanceSurface(sim->particles, (PetscBool)(TensionReach(sim->tension) > 0)));
  PetscCall(CloudCreate(sim->domain, sim->scene, sim->kernel, sim->particles,
                        PetscMax(KernelSupport(sim->kernel), TensionReach(sim->tension)), &sim->cloud));
  PetscCall(CloudSetFromOptions(sim->cloud));
  PetscCall(DomainSetUp(sim->domain, sim->cloud->size_most * sim->cloud->reach + sim->cloud->slack));
  PetscCall(PackingCreate(sim->cloud, &sim->packing));
  PetscCall(PackingSetFromOptions(sim->packing));
  PetscCall(PressureCreate(sim->cloud, &sim->pressure));
  PetscCall(StepperCreate(sim->cloud, sim->tension, sim->pressure, &sim->stepper));
  PetscCall(StepperSetFromOptions(sim->stepper));
  PetscCall(RefuseCombinations(sim));
  PackingSetRough(sim->packing, (PetscBool)!StepperSettles(sim->stepper));
  PetscCheckUser(sim->relaxation_time == 0 || StepperRepairsAtOnce(sim->stepper), comm,
                 "-packing_relaxation_time is for -scheme " SCHEME_DENSITY_INVARIANT
                 "; other schemes bring the packing to rest without it");
  PetscCall(SpectrumCreate(sim->cloud, sim->tension, sim->pressure, &sim->spectrum));
  PetscCall(SpectrumSetFromOptions(sim->spectrum));
  PetscCall(GaugesCreate(sim->cloud, &sim->gauges));
  GaugesSetRun(sim->gauges, sim->stepper);
  PetscCall(GaugesSetFromOptions(sim->gauges));
  GaugesSetForces(sim->gauges, StepperViscosity(sim->stepper), sim->pressure, TensionOnSurface(sim->tension));
  GaugesSetRefresh(sim->gauges, RefreshSums, sim->stepper);
  PetscCall(OutputCreate(sim->cloud, sim->gauges, &sim->output));
  PetscCall(OutputSetFromOptions(sim->output));
  PetscCheckUser(*stop || sim->embedded || sim->has_end || sim->steps_max > 0, comm,
                 "neither -time_end (s) nor -steps_max says when the run ends");
  PetscCheckUser(*stop || !sim->has_end || sim->time_end > sim->state.time, comm,
                 "-time_end (%g s) is not after -time_start (%g s)", (double)sim->time_end, (double)sim->state.time);
  if (!sim->has_end) sim->time_end = PETSC_MAX_REAL;
  PetscCheckUser(sim->writes || !sim->rest.names.count, comm,
                 "-stop_at_rest looks at the lines of the series: it needs -output_dir");
  PetscCall(RestSetUp(sim));
  PetscCall(DumpOptions(sim));
  if (help) PetscCall(SolversHelp("", &help));
  if (help) PetscCall(RefusalsHelp(comm));
  if (!*stop) PetscCall(RefuseUnusedOptions(comm, PETSC_TRUE));
  if (!*stop && sim->scene_json[0]) {
    PetscCall(SceneFileWrite(sim, sim->scene_json));
    *stop = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SimSetUp(Sim sim)
{
  PetscBool restarting = (PetscBool)(sim->restart[0] != 0), turned = PETSC_FALSE;
  PetscInt  particles;

  PetscFunctionBegin;
  PetscCall(PetscLogStagePush(LogStage(STAGE_PACKING)));
  SceneStart(sim->scene, sim->state.time);
  SceneMoveSolids(sim->scene, sim->state.time);
  PetscCall(ProgressWork(sim->comm, -1, restarting ? "the checkpoint is read" : "particles are made"));
  if (restarting) {
    PetscCall(OutputNewest(sim->output, sim->restart));
    PetscCall(OutputRestart(sim->output, sim->restart, sim->disturbance, &sim->state, &turned));
    PetscCheckUser(sim->time_end > sim->state.time, sim->comm,
                   "the checkpoint %s is at %g s, not before -time_end %g s", sim->restart, (double)sim->state.time,
                   (double)sim->time_end);
    SceneMoveSolids(sim->scene, sim->state.time);
    restarting = (PetscBool)!turned;
  }
  if (restarting) {
    PetscCall(CloudResync(sim->cloud));
    PetscCall(StepperReset(sim->stepper, PETSC_TRUE, &sim->state));
  } else
    PetscCall(PackingRun(sim->packing, &sim->report));
  PetscCall(StepperBring(sim->stepper, sim->packing, NULL, restarting, &sim->state));
  PetscCallMPI(MPI_Allreduce(&sim->cloud->n_fluid, &particles, 1, MPIU_INT, MPI_SUM, sim->comm));
  PetscCheckUser(particles > 0, sim->comm,
                 "there is no liquid at the start: an emitter must start at -time_start or before");
  PetscCall(StepperForesee(sim->stepper, sim->state.time, sim->time_end));
  PetscCall(StepperPrepare(sim->stepper));
  PetscCall(RefuseUnusedOptions(sim->comm, PETSC_FALSE));
  if (!restarting) {
    PetscInt lost = 0;

    PetscCall(CloudCommit(sim->cloud, &lost, NULL)); /* the partition now knows where the free surface is */
    PetscCall(CloudResync(sim->cloud));
    PetscCall(StartAtRest(sim, turned));
    PetscCall(BudgetStart(sim));
    sim->restart[0] = 0; /* the run of the rings ends here, and this one begins */
  } else
    PetscCall(BudgetRestart(sim));
  if (!sim->dry_run && !SimMeasures(sim) && sim->writes) {
    char path[PETSC_MAX_PATH_LEN];

    PetscCall(OutputSetUp(sim->output, restarting ? sim->restart : NULL, &sim->state));
    PetscCall(SceneFileWrite(sim, NULL));
    PetscCall(PetscSNPrintf(path, sizeof(path), "%s/" JOURNAL_FILE, OutputFolder(sim->output)));
    PetscCall(JournalOpen(sim->comm, path));
    PetscCall(PetscSNPrintf(path, sizeof(path), "%s/" STOP_FILE, OutputFolder(sim->output)));
    InterruptStopFile(path);
  }
  PetscCall(PetscLogStagePop());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Says what several processes mean: whether they pay, and in a terminal how the run is ended: before the signal, since
   mpiexec leaves no time after it. */
static PetscErrorCode ViewRanks(Sim sim, PetscViewer viewer)
{
  PetscMPIInt size;
  PetscInt    n;
  double      load;
  int         processors;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(sim->comm, &size));
  if (size == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ParticlesGlobalSize(sim->particles, &n));
  if (n < FEW * size)
    PetscCall(PetscViewerASCIIPrintf(viewer,
                                     "Processes: %d, of %" PetscInt_FMT " particles each: below %d the messages of a "
                                     "step take as long as its sums; fewer processes are as fast\n",
                                     size, n / size, FEW));
  if (ProcessorsCrowded(&load, &processors))
    PetscCall(
      PetscViewerASCIIPrintf(viewer,
                             "Processes: %d, besides %.1f programs that ran before, on %d processor%s: they wait "
                             "for each other, and one may be faster\n",
                             size, load, processors, processors == 1 ? "" : "s"));
  if (!sim->ranks && !sim->dry_run && isatty(STDOUT_FILENO))
    PetscCall(PetscViewerASCIIPrintf(viewer,
                                     "To end with a checkpoint: touch %s/" STOP_FILE
                                     "; after Ctrl-C mpiexec kills the run in two seconds, which ./isph " RANKS_OPTION
                                     " %d in place of mpiexec does not\n",
                                     OutputFolder(sim->output), size));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SimView(Sim sim, PetscViewer viewer)
{
  PetscFunctionBegin;
  PetscCall(DomainView(sim->domain, viewer));
  PetscCall(KernelView(sim->kernel, viewer));
  PetscCall(SceneView(sim->scene, viewer));
  PetscCall(ParticlesView(sim->particles, viewer));
  if (sim->restart[0])
    PetscCall(PetscViewerASCIIPrintf(viewer, "Restart: %s at %g s, step %" PetscInt_FMT "\n", sim->restart,
                                     (double)sim->state.time, sim->state.step));
  else if (sim->report.smallest_distance < PETSC_INFINITY) /* else no two particles are neighbours */
    PetscCall(PetscViewerASCIIPrintf(viewer,
                                     "Packing: rms of summed minus rest density %.3g kg/m3, free surfaces included; "
                                     "closest particles %.3g spacings apart%s\n",
                                     (double)sim->report.density_std, (double)sim->report.smallest_distance,
                                     sim->report.cached ? ", from the cache" : ""));
  if (!sim->restart[0] && sim->relaxation_time == 0 && StepperRepairsAtOnce(sim->stepper) &&
      sim->report.density_std > UNEVEN * BodyMaterial(SceneBody(sim->scene, 0))->density)
    PetscCall(PetscViewerASCIIPrintf(viewer,
                                     "warning: this scheme corrects that density in the first step, which sets the "
                                     "liquid in motion; use -packing_type poisson or -packing_relaxation_time\n"));
  PetscCall(FillingsView(sim, viewer));
  PetscCall(StepperView(sim->stepper, viewer));
  PetscCall(PetscViewerASCIIPrintf(viewer, "Output: %s\n", OutputFolder(sim->output)));
  PetscCall(ViewRanks(sim, viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Brings swarm and cloud into the state from which a restart will start, and writes it: this run and a restart then go
   on alike. */
PetscErrorCode SimCheckpoint(Sim sim)
{
  PetscFunctionBegin;
  PetscCall(PetscLogStagePush(LogStage(STAGE_OUTPUT)));
  PetscCall(CloudResync(sim->cloud));
  PetscCall(StepperReset(sim->stepper, PETSC_FALSE, &sim->state));
  PetscCall(BudgetKeep(sim));
  PetscCall(OutputCheckpoint(sim->output, &sim->state));
  PetscCall(PetscLogStagePop());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a particle may have this position (m), or this velocity (m/s). */
static PetscBool MayBe(Domain domain, FieldId field, const double value[])
{
  PetscReal x[DIM] = {0};

  for (PetscInt d = 0; d < domain->dim; d++) {
    x[d] = (PetscReal)value[d];
    if (PetscIsInfOrNanReal(x[d])) return PETSC_FALSE;
  }
  if (field != FIELD_POSITION) return PETSC_TRUE;
  DomainWrap(domain, x);
  for (PetscInt d = 0; d < domain->dim; d++)
    if (x[d] < domain->lower[d] || x[d] > domain->upper[d]) return PETSC_FALSE;
  return PETSC_TRUE;
}

PetscErrorCode SimSetField(Sim sim, FieldId field, const double values[], PetscBool *fine)
{
  GaugeTotals    before;
  ParticleArrays arrays;
  PetscMPIInt    good = 1;

  PetscFunctionBegin;
  PetscCall(GaugesTotals(sim->gauges, &before));
  PetscCall(ParticlesOpen(sim->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++)
    good = good && (arrays.integer[INT_LAYER][a] > 0 || MayBe(sim->domain, field, values + DIM * a));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &good, 1, MPI_INT, MPI_MIN, sim->comm));
  for (PetscInt a = 0; a < arrays.n && good; a++)
    for (PetscInt d = 0; d < sim->domain->dim && !arrays.integer[INT_LAYER][a]; d++)
      arrays.real[field][DIM * a + d] = (PetscReal)values[DIM * a + d];
  PetscCall(ParticlesClose(sim->particles, &arrays));
  *fine = (PetscBool)(good != 0);
  if (!good) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CloudResync(sim->cloud));
  PetscCall(BudgetChanged(sim, &before));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteOutput(Sim sim, PetscBool last)
{
  PetscFunctionBegin;
  PetscCall(PetscLogStagePush(LogStage(STAGE_OUTPUT)));
  PetscCall(OutputStep(sim->output, &sim->state, last));
  PetscCall(PetscLogStagePop());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the next step may end in a line of the series, which needs the divergence: a pass over the pairs. Steps grow
   by less than the factor LOOK_AHEAD. */
static PetscBool DivergenceWanted(Sim sim)
{
  const PetscReal soon = sim->state.time + LOOK_AHEAD * sim->state.previous_time_step;

  return (PetscBool)(sim->state.previous_time_step == 0 || soon >= PetscMin(sim->time_end, sim->stop) ||
                     sim->steps + 1 == sim->steps_max || OutputSeriesDue(sim->output, soon));
}

/* The message goes to standard error if nobody reads standard output any more. */
static PetscErrorCode SayHowToContinue(Sim sim)
{
  const char *folder = OutputFolder(sim->output);
  FILE       *stream = PrinterLost() ? stderr : PETSC_STDOUT;
  char        checkpoint[OUTPUT_NAME_LENGTH];

  PetscFunctionBegin;
  OutputCheckpointName(sim->state.step, checkpoint);
  if (sim->interrupted)
    PetscCall(PetscFPrintf(sim->comm, stream, "ended by %s at %g s\n", sim->interrupted, (double)sim->state.time));
  if (sim->writes)
    PetscCall(PetscFPrintf(sim->comm, stream, "Results are in %s; continue with%s -restart %s/%s\n", folder,
                           sim->interrupted ? "" : " a later -time_end and", folder, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of an embedded run without a folder gauges measure the first state, too: it is the level of a crater. */
static PetscErrorCode Begin(Sim sim)
{
  const PetscReal *values;
  PetscInt         count;

  PetscFunctionBegin;
  if (sim->begun) PetscFunctionReturn(PETSC_SUCCESS);
  sim->begun = PETSC_TRUE;
  PetscCall(ProgressStart(sim, &sim->progress));
  if (sim->restart[0]) PetscFunctionReturn(PETSC_SUCCESS);
  if (sim->writes)
    PetscCall(WriteOutput(sim, PETSC_FALSE));
  else
    PetscCall(OutputMeasure(sim->output, &sim->state, &count, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes what is due after a step. clock: a checkpoint is due by the clock. */
static PetscErrorCode WriteStep(Sim sim, PetscBool clock)
{
  PetscBool last = SimEnded(sim);

  PetscFunctionBegin;
  if (sim->writes) {
    PetscCall(WriteOutput(sim, last));
    if (!last) PetscCall(RestCheck(sim, &sim->rests));
    if (sim->rests) {
      last = PETSC_TRUE;
      PetscCall(WriteOutput(sim, last));
    }
    if (last || OutputCheckpointDue(sim->output, &sim->state))
      PetscCall(SimCheckpoint(sim));
    else if (clock) {
      PetscCall(BudgetKeep(sim));
      PetscCall(OutputByClock(sim->output, &sim->state));
    }
  }
  PetscCall(ProgressStep(sim, &sim->progress, last));
  PetscCall(MonitorStep(sim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The time (s) at which the run ends. */
static PetscReal End(Sim sim)
{
  return PetscMin(sim->time_end, sim->stop);
}

void SimSetEnd(Sim sim, PetscReal end)
{
  sim->stop = end;
}

PetscBool SimEnded(Sim sim)
{
  return (PetscBool)(sim->state.time >= End(sim) || (sim->steps_max > 0 && sim->steps >= sim->steps_max) ||
                     sim->interrupted || sim->rests);
}

PetscErrorCode SimStep(Sim sim, PetscReal end)
{
  PetscBool failed, clock;
  char      why[FAREWELL_LENGTH];

  PetscFunctionBegin;
  PetscCall(Begin(sim));
  PetscCall(PetscLogStagePush(LogStage(STAGE_STEPS)));
  InterruptAlive("a step");
  PetscCall(StepperAdvance(sim->stepper, PetscMin(end, End(sim)), DivergenceWanted(sim), &sim->state, &failed, why,
                           sizeof(why)));
  if (failed && sim->writes) PetscCall(SimCheckpoint(sim));
  PetscCheckUser(!failed, sim->comm, "stopped at %g s, step %" PetscInt_FMT ": %s%s%s", (double)sim->state.time,
                 sim->state.step, why, sim->writes ? "; the last good state is the newest checkpoint in " : "",
                 sim->writes ? OutputFolder(sim->output) : "");
  PetscCall(StepperBring(sim->stepper, sim->packing, sim->gauges, PETSC_FALSE, &sim->state));
  sim->steps++;
  clock = (PetscBool)(sim->writes && !sim->cloud->keep_order && OutputClockDue(sim->output)); /* no pair is begun */
  PetscCall(InterruptCheck(sim->comm, &clock, &sim->interrupted));
  PetscCall(WriteStep(sim, clock));
  PetscCall(PetscLogStagePop());
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SimFinish(Sim sim)
{
  PetscFunctionBegin;
  PetscCall(SayHowToContinue(sim));
  if (SpectrumWanted(sim->spectrum) && !sim->interrupted) {
    SpectrumStep step = {.iterations = sim->state.iterations, .viscosity = StepperViscosity(sim->stepper)};

    PetscCall(StepperPredict(sim->stepper, &sim->state, &step.dt));
    PetscCall(SpectrumRun(sim->spectrum, &step));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool SimWrites(Sim sim)
{
  return sim->writes;
}

const char *SimUnit(Sim sim, const char unit[])
{
  return DomainUnit(sim->domain, unit);
}

MPI_Comm SimComm(Sim sim)
{
  return sim->comm;
}

const StepState *SimState(Sim sim)
{
  return &sim->state;
}

Particles SimParticles(Sim sim)
{
  return sim->particles;
}

Output SimOutput(Sim sim)
{
  return sim->output;
}

PetscErrorCode SimDestroy(Sim *sim)
{
  Sim s = *sim;

  PetscFunctionBegin;
  if (!s) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MonitorDestroy(s));
  PetscCall(RestDestroy(s));
  if (s->output) PetscCall(OutputDestroy(&s->output));
  if (s->gauges) PetscCall(GaugesDestroy(&s->gauges));
  if (s->spectrum) PetscCall(SpectrumDestroy(&s->spectrum));
  if (s->stepper) PetscCall(StepperDestroy(&s->stepper));
  if (s->pressure) PetscCall(PressureDestroy(&s->pressure));
  if (s->packing) PetscCall(PackingDestroy(&s->packing));
  if (s->cloud) PetscCall(CloudDestroy(&s->cloud));
  if (s->particles) PetscCall(ParticlesDestroy(&s->particles));
  if (s->tension) PetscCall(TensionDestroy(&s->tension));
  if (s->scene) PetscCall(SceneDestroy(&s->scene));
  if (s->kernel) PetscCall(KernelDestroy(&s->kernel));
  if (s->domain) PetscCall(DomainDestroy(&s->domain));
  PetscCall(PetscFree(*sim));
  PetscCall(JournalClose());
  PetscFunctionReturn(PETSC_SUCCESS);
}
