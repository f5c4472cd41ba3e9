/* The library, isph.h, and the program as its client. A run in another program has options, error handler and printer
   of its own, which are PETSc's during a call only. */
#include "isph.h"
#include "sim/sim.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct _p_Isph {
  Sim              sim;
  PetscOptions     options;             /* NULL: those of PETSc's database, of the program */
  PetscBool        done, ready, failed; /* done: options wanted no run; ready: set up; failed: after an error */
  PetscBool        calling;             /* 'after' */
  IsphCallback     after;
  void            *context;
  char            *json;
  PetscInt         columns;
  const PetscReal *values;               /* [columns] of this state, borrowed; NULL: not yet measured */
  char (*name)[COLUMN_NAME_LENGTH + 16]; /* [columns] */
  size_t *plain;                         /* [columns] length of the name without the unit */
};

static Isph      Open; /* the run of this process */
static PetscBool StartedMPI, StartedPETSc;
static char      Refusal[256]; /* the sentence of an error outside of a run */

static const char help[] =
  "isph: incompressible smoothed particle hydrodynamics on PETSc.\n"
  "  ./isph [-ranks N] cases/drop_impact/case.opts [options/quick.opts ...] [-name value ...]\n"
  "Later options win over earlier ones. Numbers are in SI, or have a unit behind them: 0.1mm, 40deg, 3cP.\n\n";

/* --- each call --- */

/* An error of the caller, which the run survives. */
static int Refuse(const char format[], ...)
{
  va_list arguments;

  va_start(arguments, format);
  (void)vsnprintf(Refusal, sizeof(Refusal), format, arguments);
  va_end(arguments);
  return (int)ISPH_USER_ERROR;
}

/* Makes options, errors and prints those of the run. */
static void Enter(Isph run)
{
  if (!run->options) return;
  Refusal[0] = 0;
  (void)PetscOptionsPush(run->options);
  (void)ErrorsKeep(PETSC_TRUE);
  PrinterQuiet(PETSC_TRUE);
}

static int Leave(Isph run, PetscErrorCode code)
{
  if (code) run->failed = PETSC_TRUE;
  if (!run->options) return (int)code;
  PrinterQuiet(PETSC_FALSE);
  (void)ErrorsKeep(PETSC_FALSE);
  (void)PetscOptionsPop();
  return (int)code;
}

/* Ends a function by a call within the run. */
#define RETURN_CALL(run, call)                                                                                         \
  do {                                                                                                                 \
    Enter(run);                                                                                                        \
    return Leave(run, call);                                                                                           \
  } while (0)

/* Whether the run can be asked: IsphDestroy or a refused option may have ended it. */
static PetscBool Lives(Isph run)
{
  return (PetscBool)(run && run == Open && run->sim);
}

/* Refuses a call before IsphSetUp or after an error. */
static int Check(Isph run)
{
  Refusal[0] = 0;
  if (!run || run != Open) return Refuse("there is no such run");
  if (run->failed) return Refuse("the run has failed before");
  return run->ready ? 0 : Refuse("the run needs IsphSetUp first");
}

/* --- creation --- */

/* PetscInitialize sets handlers of signals, which are another program's matter. */
static int Start(MPI_Comm *comm, int handle)
{
  int begun = 0, relation;

  DisplaysIgnore();
  (void)MPI_Initialized(&begun);
  if (!begun && MPI_Init(NULL, NULL)) return Refuse("MPI cannot start");
  StartedMPI = (PetscBool)(StartedMPI || !begun);
  *comm      = handle == ISPH_WORLD ? MPI_COMM_WORLD : MPI_Comm_f2c((MPI_Fint)handle);
  if (PetscInitializeCalled) {
    if (MPI_Comm_compare(*comm, PETSC_COMM_WORLD, &relation) || relation == MPI_UNEQUAL)
      return Refuse("PETSc has started on other processes than those of this run");
    return 0;
  }
  PETSC_COMM_WORLD = *comm;
  if (PetscInitializeNoArguments()) return Refuse("PETSc cannot start");
  (void)PetscPopSignalHandler();
  StartedPETSc = PETSC_TRUE;
  return 0;
}

/* The options as the program reads them from its command line. */
static PetscErrorCode ReadOptions(MPI_Comm comm, const char text[])
{
  char    **word, *all;
  int       count = WordsSplit(text, &word);
  PetscBool stop;

  PetscFunctionBeginUser;
  PetscCheckUser(count > 0, comm, "out of memory");
  all = word[0];
  PetscCall(CommandLineCheck(comm, &count, &word, &stop));
  PetscCall(PetscOptionsInsert(NULL, &count, &word, NULL));
  free(word);
  free(all);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A ColumnVisitor: keeps the names of the series. */
static PetscErrorCode KeepName(void *context, const char file[], const Column *column, const ColumnWords *words)
{
  Isph run = (Isph)context;

  PetscFunctionBeginUser;
  if (strcmp(file, OUTPUT_SERIES)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscRealloc(((size_t)run->columns + 1) * sizeof(*run->name), &run->name));
  PetscCall(PetscRealloc(((size_t)run->columns + 1) * sizeof(*run->plain), &run->plain));
  PetscCall(PetscStrncpy(run->name[run->columns], words->head, sizeof(*run->name)));
  run->plain[run->columns++] = strlen(column->name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Create(Isph run, MPI_Comm comm, const char options[])
{
  PetscFunctionBeginUser;
  if (options) PetscCall(ReadOptions(comm, options));
  PetscCall(LogRegister());
  PetscCall(SimCreate(comm, &run->sim));
  if (options) PetscCall(SimEmbed(run->sim));
  PetscCall(SimSetFromOptions(run->sim, &run->done));
  PetscCall(OutputEachColumn(SimOutput(run->sim), KeepName, run));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int IsphCreate(const char options[], int handle, Isph *run)
{
  MPI_Comm comm = MPI_COMM_WORLD;
  int      code;

  *run = NULL;
  if (Open) return Refuse("this process has a run already; IsphDestroy ends it");
  code = Start(&comm, handle);
  if (code) return code;
  if (sizeof(PetscReal) != sizeof(double)) return Refuse("this PETSc does not compute in double precision");
  *run = Open = (Isph)calloc(1, sizeof(**run));
  if (!Open || (options && PetscOptionsCreate(&Open->options))) return Refuse("out of memory");
  RETURN_CALL(Open, Create(Open, comm, options));
}

static PetscErrorCode SetUp(Isph run)
{
  MPI_Comm comm = SimComm(run->sim);

  PetscFunctionBeginUser;
  PetscCall(SimSetUp(run->sim));
  PetscCall(SimView(run->sim, PETSC_VIEWER_STDOUT_(comm)));
  run->ready = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

int IsphSetUp(Isph run)
{
  const int code = Check(run);

  if (code && (!run || run != Open || run->failed)) return code;
  if (run->done) return Refuse("the options ask for no run, but for a list or a file");
  if (run->ready) return Refuse("the run is set up already");
  RETURN_CALL(run, SetUp(run));
}

/* --- steps --- */

/* The columns are those of another state. */
static void Stale(Isph run)
{
  run->values = NULL;
}

static PetscErrorCode Step(Isph run, double end)
{
  PetscFunctionBeginUser;
  Stale(run);
  PetscCall(SimStep(run->sim, (PetscReal)end));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int IsphStep(Isph run, double end)
{
  int code = Check(run);

  if (code) return code;
  if (SimEnded(run->sim)) return Refuse("the run is at its end, %g s", IsphTime(run));
  if (!(end > IsphTime(run))) return Refuse("the run is at %g s, not before %g s", IsphTime(run), end);
  Enter(run);
  code = Leave(run, Step(run, end));
  if (code || !run->after) return code;
  run->calling = PETSC_TRUE;
  code         = run->after(run->context, run);
  run->calling = PETSC_FALSE;
  return code;
}

int IsphRun(Isph run, double end)
{
  int code = Check(run);

  if (code) return code;
  if (SimIsDry(run->sim)) RETURN_CALL(run, SimDryRun(run->sim));
  if (SimMeasures(run->sim)) RETURN_CALL(run, SimMeasure(run->sim));
  SimSetEnd(run->sim, (PetscReal)end);
  while (!code && !SimEnded(run->sim)) code = IsphStep(run, end);
  if (!code) {
    Enter(run);
    code = Leave(run, SimFinish(run->sim));
  }
  SimSetEnd(run->sim, PETSC_MAX_REAL);
  return code;
}

int IsphEnded(Isph run)
{
  return !Lives(run) || SimEnded(run->sim);
}

int IsphSetCallback(Isph run, IsphCallback after, void *context)
{
  if (!Lives(run)) return Refuse("there is no such run");
  run->after   = after;
  run->context = context;
  return 0;
}

int IsphCheckpoint(Isph run)
{
  const int code = Check(run);

  if (code) return code;
  if (!SimWrites(run->sim)) return Refuse("a checkpoint needs -output_dir");
  RETURN_CALL(run, SimCheckpoint(run->sim));
}

double IsphTime(Isph run)
{
  return Lives(run) ? (double)SimState(run->sim)->time : NAN;
}

double IsphTimeStep(Isph run)
{
  return Lives(run) ? (double)SimState(run->sim)->time_step : NAN;
}

long IsphSteps(Isph run)
{
  return Lives(run) ? (long)SimState(run->sim)->step : 0;
}

/* --- what the run has --- */

static PetscErrorCode Find(Isph run, PetscInt field, IsphArray *array)
{
  const PetscBool real = (PetscBool)(field < FIELD_STORED_COUNT);
  ParticleArrays  arrays;

  PetscFunctionBeginUser;
  PetscCall(ParticlesOpen(SimParticles(run->sim), &arrays));
  array->data  = real ? (const void *)arrays.real[field] : (const void *)arrays.integer[field - FIELD_STORED_COUNT];
  array->count = (long)arrays.n;
  array->components = real ? (int)Fields[field].width : 1;
  array->bytes      = (int)(real ? sizeof(PetscReal) : sizeof(PetscInt));
  array->integer    = !real;
  array->unit       = real ? SimUnit(run->sim, Fields[field].unit) : "1";
  PetscCall(ParticlesClose(SimParticles(run->sim), &arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The name of field f of all stored ones, reals first; NULL: the run has it not. */
static const char *NameOf(Isph run, PetscInt f)
{
  if (f >= FIELD_STORED_COUNT) return IntFieldNames[f - FIELD_STORED_COUNT];
  return ParticlesHave(SimParticles(run->sim), f) ? Fields[f].name : NULL;
}

#define FIELDS (FIELD_STORED_COUNT + INT_COUNT)

int IsphField(Isph run, const char name[], IsphArray *array)
{
  const int code = Check(run);

  if (code) return code;
  for (PetscInt f = 0; f < FIELDS; f++)
    if (NameOf(run, f) && !strcmp(NameOf(run, f), name)) RETURN_CALL(run, Find(run, f, array));
  return Refuse("particles of this run have no field '%s'", name);
}

const char *IsphFieldName(Isph run, int k)
{
  if (!Lives(run) || !run->ready) return NULL;
  for (PetscInt f = 0; f < FIELDS; f++)
    if (NameOf(run, f) && k-- == 0) return NameOf(run, f);
  return NULL;
}

static PetscErrorCode Set(Isph run, FieldId field, const double values[], PetscBool *fine)
{
  PetscFunctionBeginUser;
  Stale(run);
  PetscCall(SimSetField(run->sim, field, values, fine));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int IsphSetField(Isph run, const char name[], const double values[])
{
  const FieldId field = strcmp(name, Fields[FIELD_POSITION].name) ? FIELD_VELOCITY : FIELD_POSITION;
  int           code  = Check(run);
  PetscBool     fine  = PETSC_TRUE;

  if (code) return code;
  if (strcmp(name, Fields[field].name)) return Refuse("'%s' cannot be set: only position and velocity can", name);
  Enter(run);
  code = Leave(run, Set(run, field, values, &fine));
  if (!code && !fine)
    return Refuse("a %s is no number%s", name, field == FIELD_POSITION ? ", or outside of the box" : "");
  return code;
}

static PetscErrorCode Value(Isph run, PetscInt column, double *value)
{
  PetscInt count;

  PetscFunctionBeginUser;
  if (!run->values) PetscCall(OutputMeasure(SimOutput(run->sim), SimState(run->sim), &count, &run->values));
  *value = (double)run->values[column];
  PetscFunctionReturn(PETSC_SUCCESS);
}

int IsphColumn(Isph run, const char name[], double *value)
{
  const int code = Check(run);

  if (code) return code;
  for (PetscInt k = 0; k < run->columns; k++)
    if (!strcmp(run->name[k], name) || (strlen(name) == run->plain[k] && !strncmp(run->name[k], name, run->plain[k])))
      RETURN_CALL(run, Value(run, k, value));
  return Refuse("the series of this run has no column '%s'", name);
}

const char *IsphColumnName(Isph run, int k)
{
  return Lives(run) && k >= 0 && k < run->columns ? run->name[k] : NULL;
}

int IsphScene(Isph run, const char **json)
{
  int code = Check(run);

  *json = "";
  if (code) return code;
  free(run->json);
  Enter(run);
  code = Leave(run, SimScene(run->sim, PETSC_TRUE, &run->json));
  if (run->json) *json = run->json;
  return code;
}

/* --- the end --- */

static PetscErrorCode Destroy(Isph run)
{
  PetscFunctionBeginUser;
  InterruptStopFile("");
  PetscCall(SimDestroy(&run->sim));
  PetscCall(PetscFree(run->name));
  PetscCall(PetscFree(run->plain));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int IsphDestroy(Isph *run)
{
  Isph r = *run;
  int  code;

  if (r && r == Open && r->calling) return Refuse("a callback cannot end its run; what it returns or raises can");
  *run = NULL;
  if (!r || r != Open) return 0;
  Open = NULL;
  Enter(r);
  code = Leave(r, Destroy(r));
  if (r->options) (void)PetscOptionsDestroy(&r->options);
  free(r->json);
  free(r);
  return code;
}

int IsphFinalize(void)
{
  int code = 0;

  if (Open) return Refuse("a run is open; IsphDestroy ends it");
  if (StartedPETSc) code = (int)PetscFinalize();
  if (StartedMPI) code = MPI_Finalize() || code;
  StartedPETSc = StartedMPI = PETSC_FALSE;
  return code;
}

const char *IsphError(void)
{
  return Refusal[0] ? Refusal : ErrorSentence();
}

const char *IsphVersion(void)
{
  return ISPH_VERSION;
}

/* --- the program --- */

static int Run(void)
{
  Isph run;
  int  code = IsphCreate(NULL, ISPH_WORLD, &run);

  if (!code && !run->done) code = IsphSetUp(run);
  if (!code && !run->done) code = IsphRun(run, (double)PETSC_MAX_REAL);
  return code ? code : IsphDestroy(&run);
}

/* PetscInitialize sets handlers of signals, of which none may end the program without a word. */
static PetscErrorCode Initialize(int *argc, char ***argv)
{
  PetscErrorCode code;

  InterruptBlock();
  code = PetscInitialize(argc, argv, NULL, help);
  InterruptWatch();
  return code ? code : UserErrorHandlerFirst();
}

int IsphMain(int argc, char *argv[])
{
  PetscErrorCode code;
  PetscBool      stop;
  int            result;

  ProgramStart();
  result = RanksLaunch(argc, argv);
  if (result >= 0) return result;
  if (MPI_Init(&argc, &argv) || UserErrorHandlerPush())
    return 2; /* before the options are read: a missing options file is the user's error too */
  PrinterStart();
  code = CommandLineCheck(MPI_COMM_WORLD, &argc, &argv, &stop);
  if (!code && !stop) code = Initialize(&argc, &argv);
  if (!code && !stop) code = (PetscErrorCode)Run();
  result = ErrorFinish(code);
  if (PetscInitializeCalled) (void)PetscFinalize();
  (void)MPI_Finalize();
  return result;
}
