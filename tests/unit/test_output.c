/* Run folder, series, snapshots; checkpoints there and back, and damaged ones. */
#include "lattice.h"
#include <sys/stat.h>

#define FOLDER "output/test_output"

#define RUN_OPTIONS                                                                                                    \
  "-dimension 2 -box_lower 0,0,0 -box_upper 6e-3,6e-3,0 -spacing 0.5e-3 -bodies film -film_shape box -film_lower "     \
  "0,0,-1 -film_upper 1,3e-3,1 -film_density 1100 -output_dir " FOLDER " "
#define STEPS 6
#define MANY  300 /* numbers */

static int Low(PetscReal r, PetscReal z)
{
  return z < 3e-3;
}

static PetscErrorCode RemoveFolder(void)
{
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (!rank) CHECK(!system("rm -rf " FOLDER), "folder removed");
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Other values than zero, no two alike, in all numbers, and a pattern in each field of the core that no row names. */
static void SetState(StepState *state, PetscInt step)
{
  const size_t end = offsetof(StepState, said) + sizeof(state->said);
  Number number;

  memset(state, 0, sizeof(*state));
  memset(state, 0x3f, offsetof(StepState, edge));
  memset((char *)state + end, 0, offsetof(StepState, previous_time_step) - end); /* what aligns it is no field */
  for (PetscInt k = 0; StateNumber(state, k, &number); k++)
    if (number.row->kind == NUMBER_COUNT)
      *(PetscInt *)number.at = 100 + k;
    else
      *(PetscReal *)number.at = (k + 1) / 64.0;
  state->step      = step;
  state->time      = step * 1e-3 / 3;
  state->time_step = 1e-3 / 3;
}

/* Whole text of a file, to be freed; "" when there is none. */
static PetscErrorCode ReadFile(const char path[], char **text, size_t *size)
{
  FILE *file   = fopen(path, "rb");
  long  length = 0;

  PetscFunctionBegin;
  if (file) {
    (void)fseek(file, 0, SEEK_END);
    length = ftell(file);
    rewind(file);
  }
  PetscCall(PetscCalloc1(length + 1, text));
  *size = file ? fread(*text, 1, (size_t)length, file) : 0;
  if (file) fclose(file);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rank 0 writes, all wait. */
static PetscErrorCode WriteFile(const char path[], const char bytes[], size_t size)
{
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  if (!rank) {
    FILE *file = fopen(path, "wb");

    PetscCheck(file && fwrite(bytes, 1, size, file) == size && !fclose(file), PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE,
               "%s", path);
  }
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static int Exists(const char path[])
{
  struct stat info;

  return !stat(path, &info);
}

static PetscInt Lines(const char path[])
{
  char    *text;
  size_t   size;
  PetscInt lines = 0;

  if (ReadFile(path, &text, &size)) return -1;
  for (size_t k = 0; k < size; k++) lines += text[k] == '\n';
  if (PetscFree(text)) return -1;
  return lines;
}

static const StepState Beginning = {0};

/* A run of STEPS states with a checkpoint at each of the steps 2, 4, 6. */
static PetscErrorCode WriteRun(void)
{
  Run       run;
  StepState state;

  PetscFunctionBegin;
  PetscCall(RunCreate(RUN_OPTIONS "-snapshot_interval 1e-3 ", &run));
  PetscCall(Fill(&run, Low, 0.3));
  PetscCall(OutputSetUp(run.output, NULL, &Beginning));
  for (PetscInt step = 0; step <= STEPS; step++) {
    SetState(&state, step);
    PetscCall(OutputStep(run.output, &state, (PetscBool)(step == STEPS)));
    if (step && step % 2 == 0) PetscCall(OutputCheckpoint(run.output, &state));
  }
  PetscCall(OutputStep(run.output, &state, PETSC_TRUE));
  PetscCall(RunDestroy(&run));
  CHECK(Lines(FOLDER "/series.csv") == STEPS + 2, "series has a line a step");
  CHECK(Exists(FOLDER "/snapshot_000000.h5") && Exists(FOLDER "/snapshot_000002.h5") &&
          !Exists(FOLDER "/snapshot_000003.h5"),
        "snapshots at 0, 1, 2 ms");
  CHECK(!Exists(FOLDER "/checkpoint_000002.h5") && Exists(FOLDER "/checkpoint_000004.h5") &&
          Exists(FOLDER "/checkpoint_000006.h5"),
        "two checkpoints kept");
  CHECK(Exists(FOLDER "/snapshots.xdmf") && Exists(FOLDER "/version.txt"), "xdmf and version");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TryRestart(const char options[], const char file[], Run *run, StepState *state)
{
  PetscBool turned;

  PetscFunctionBegin;
  PetscCall(RunCreate(options, run));
  PetscCall(OutputRestart(run->output, file, "", state, &turned));
  PetscCall(OutputSetUp(run->output, file, state));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the run's particles are those Fill makes, on the same ranks in the same order, to the last bit. */
static PetscErrorCode SameParticles(Run *run, PetscBool *same)
{
  Run            other;
  ParticleArrays a, b;

  PetscFunctionBegin;
  PetscCall(RunCreate(RUN_OPTIONS, &other));
  PetscCall(Fill(&other, Low, 0.3));
  PetscCall(ParticlesOpen(run->particles, &a));
  PetscCall(ParticlesOpen(other.particles, &b));
  *same = (PetscBool)(a.n == b.n);
  for (PetscInt f = 0; f < FIELD_STORED_COUNT && a.real[f] && *same; f++)
    *same = (PetscBool)!memcmp(a.real[f], b.real[f], sizeof(PetscReal) * (size_t)(a.n * Fields[f].width));
  for (PetscInt f = 0; f < INT_COUNT && *same; f++)
    *same = (PetscBool)!memcmp(a.integer[f], b.integer[f], sizeof(PetscInt) * (size_t)a.n);
  PetscCall(ParticlesClose(other.particles, &b));
  PetscCall(ParticlesClose(run->particles, &a));
  PetscCall(RunDestroy(&other));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Each row has a place of its own: after all are set, each number has its value still. */
static void CheckRows(void)
{
  StepState state = {0};
  Number    number;

  for (PetscInt k = 0; StateNumber(&state, k, &number); k++)
    if (number.row->kind == NUMBER_COUNT)
      *(PetscInt *)number.at = k;
    else
      *(PetscReal *)number.at = k;
  for (PetscInt k = 0; StateNumber(&state, k, &number); k++)
    CHECK((number.row->kind == NUMBER_COUNT ? *(PetscInt *)number.at : *(PetscReal *)number.at) == k, number.row->name);
}

/* A table has as many rows as it likes. */
static void CheckRoom(void)
{
  static NumberRow rows[MANY + 1];
  PetscReal        value[MANY];
  Number           number;
  PetscInt         found = 0;

  for (PetscInt k = 0; k < MANY; k++) rows[k] = (NumberRow){"number", NUMBER_REAL, (size_t)k * sizeof(PetscReal)};
  for (PetscInt k = 0; k <= MANY; k++) {
    PetscInt left = k;

    if (NumbersWalk(rows, value, &left, &number)) found += number.at == &value[k];
    if (k == MANY) CHECK(left == 0, "numbers behind the last row are those of the next table");
  }
  CHECK(found == MANY, "as many numbers as rows");
}

static PetscErrorCode CheckRestart(void)
{
  Run       run;
  StepState state, expected;
  PetscBool same = PETSC_FALSE;

  PetscFunctionBegin;
  SetState(&expected, 4);
  PetscCall(TryRestart(RUN_OPTIONS "-snapshot_interval 1e-3 ", FOLDER "/checkpoint_000004.h5", &run, &state));
  CHECK(!memcmp(&state, &expected, sizeof(state)), "restart: state");
  PetscCall(SameParticles(&run, &same));
  CHECK(same, "restart: particles");
  CHECK(Lines(FOLDER "/series.csv") == 1 + 5, "restart: series cut behind the step");
  CHECK(Exists(FOLDER "/snapshot_000001.h5") && !Exists(FOLDER "/snapshot_000002.h5"),
        "restart: snapshots cut behind the step");
  PetscCall(CloudResync(run.cloud));
  PetscCall(OutputStep(run.output, &state, PETSC_FALSE)); /* the state of the restart is there already */
  CHECK(Lines(FOLDER "/series.csv") == 1 + 5, "restart: no line twice");
  for (PetscInt step = 5; step <= STEPS; step++) {
    SetState(&state, step);
    PetscCall(OutputStep(run.output, &state, (PetscBool)(step == STEPS)));
  }
  PetscCall(OutputCheckpoint(run.output, &state));
  PetscCall(RunDestroy(&run));
  CHECK(Lines(FOLDER "/series.csv") == STEPS + 2, "restart: series whole again");
  CHECK(Exists(FOLDER "/snapshot_000002.h5") && !Exists(FOLDER "/snapshot_000003.h5"),
        "restart: snapshots whole again");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A checkpoint of one rank, continued on all: equal slabs. */
static PetscErrorCode CheckOtherRanks(void)
{
  Run            one, all;
  StepState      state;
  ParticleArrays a, b;
  PetscMPIInt    rank, size;
  PetscInt       start = 0, n;
  PetscBool      same;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  SetState(&state, 1);
  world = PETSC_COMM_SELF;
  PetscCall(RunCreate(RUN_OPTIONS "-output_overwrite ", &one));
  PetscCall(Fill(&one, Low, 0.3));
  if (!rank) {
    PetscCall(OutputSetUp(one.output, NULL, &Beginning));
    PetscCall(OutputCheckpoint(one.output, &state));
  }
  PetscCall(OutputDestroy(&one.output)); /* which locks the folder */
  world = PETSC_COMM_WORLD;
  PetscCallMPI(MPI_Barrier(world));
  PetscCall(TryRestart(RUN_OPTIONS, FOLDER "/checkpoint_000001.h5", &all, &state));
  PetscCall(ParticlesOpen(one.particles, &a));
  PetscCall(ParticlesOpen(all.particles, &b));
  PetscCallMPI(MPI_Exscan(&b.n, &start, 1, MPIU_INT, MPI_SUM, world));
  PetscCallMPI(MPI_Allreduce(&b.n, &n, 1, MPIU_INT, MPI_SUM, world));
  if (!rank) start = 0;
  same = (PetscBool)(n == a.n && b.n >= n / size && b.n <= n / size + 1);
  for (PetscInt f = 0; f < FIELD_STORED_COUNT && a.real[f] && same; f++) {
    const PetscInt width = Fields[f].width;

    same = (PetscBool)!memcmp(a.real[f] + start * width, b.real[f], sizeof(PetscReal) * (size_t)(b.n * width));
  }
  for (PetscInt f = 0; f < INT_COUNT && same; f++)
    same = (PetscBool)!memcmp(a.integer[f] + start, b.integer[f], sizeof(PetscInt) * (size_t)b.n);
  CHECK(same, "restart: equal slabs on another number of ranks");
  PetscCall(ParticlesClose(all.particles, &b));
  PetscCall(ParticlesClose(one.particles, &a));
  PetscCall(RunDestroy(&all));
  PetscCall(RunDestroy(&one));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Refused(const char options[], const char file[], const char word[], const char name[])
{
  Run            run;
  StepState      state;
  PetscErrorCode code;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  RefuseBegin();
  if (file)
    code = TryRestart(options, file, &run, &state);
  else {
    code = RunCreate(options, &run);
    if (!code) code = OutputSetUp(run.output, NULL, &Beginning);
  }
  RefuseEnd(code, word, name);
  PetscCall(RunDestroy(&run));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckRefusals(void)
{
  PetscFunctionBegin;
  PetscCall(Refused(RUN_OPTIONS, NULL, "holds a run already", "refuse: a folder with a run"));
  PetscCall(Refused(RUN_OPTIONS "-output_dir " FOLDER "/series.csv/below", NULL, "Cannot write into the folder",
                    "refuse: a folder below a file"));
  PetscCall(Refused(RUN_OPTIONS "-series_interval -1", NULL, "-series_interval", "refuse: a negative interval"));
#if !defined(PETSC_USE_64BIT_INDICES) /* not taken for its last 32 bits */
  PetscCall(Refused(RUN_OPTIONS "-gauge_lines 0,0,1,1 -gauge_line_points 4294967297", NULL,
                    "-gauge_line_points is 4294967297", "refuse: a wrapped number"));
#endif
  PetscCall(Refused(RUN_OPTIONS "-gauge_axis 0,0", NULL, "-gauge_axis", "refuse: an axis of two numbers in the plane"));
  PetscCall(Refused(RUN_OPTIONS, FOLDER "/none.h5", "no readable file", "refuse: a missing checkpoint"));
  PetscCall(Refused(RUN_OPTIONS, FOLDER "/series.csv", "not a checkpoint", "refuse: a text file"));
  PetscCall(Refused(RUN_OPTIONS, FOLDER "/snapshot_000000.h5", "not a checkpoint", "refuse: a snapshot"));
  PetscCall(
    Refused(RUN_OPTIONS "-spacing 0.25e-3", FOLDER "/checkpoint_000006.h5", "spacing", "refuse: another spacing"));
  PetscCall(Refused(RUN_OPTIONS "-dimension 3 -box_zmin open -box_upper 6e-3,6e-3,6e-3", FOLDER "/checkpoint_000006.h5",
                    "dimensions", "refuse: another dimension"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Every flipped byte is refused or does no harm; a file cut anywhere is refused. */
static PetscErrorCode CheckDamage(void)
{
  const char    *file = FOLDER "/damaged.h5";
  char          *bytes;
  size_t         size;
  PetscInt       refused = 0, harmless = 0, harmful = 0, cuts = 0;
  Run            run;
  StepState      state, expected;
  PetscErrorCode code;
  PetscBool      same;

  PetscFunctionBegin;
  SetState(&expected, STEPS);
  PetscCall(ReadFile(FOLDER "/checkpoint_000006.h5", &bytes, &size));
  CHECK(size > 1000, "damage: a checkpoint");
  for (size_t k = 0; k < size; k += 1 + size / 211) {
    bytes[k] ^= 0x10;
    PetscCall(WriteFile(file, bytes, size));
    bytes[k] ^= 0x10;
    RefuseBegin();
    code = TryRestart(RUN_OPTIONS, file, &run, &state);
    (void)dup2(refuse_stderr, STDERR_FILENO);
    close(refuse_stderr);
    fclose(refuse_file);
    same = PETSC_FALSE;
    if (!code) PetscCall(SameParticles(&run, &same));
    refused += code == ISPH_USER_ERROR;
    harmless += !code && same && !memcmp(&state, &expected, sizeof(state));
    harmful += code ? code != ISPH_USER_ERROR : !same || memcmp(&state, &expected, sizeof(state));
    PetscCall(RunDestroy(&run));
  }
  CHECK(!harmful && refused > 100, "damage: flipped bytes are noticed");
  if (getenv("TEST_VERBOSE"))
    printf("flips: %d refused, %d harmless, %d harmful, size %d\n", (int)refused, (int)harmless, (int)harmful,
           (int)size);
  for (size_t part = 1; part < 8; part++) {
    PetscCall(WriteFile(file, bytes, part == 7 ? size - 1 : size * part / 7));
    RefuseBegin();
    code = TryRestart(RUN_OPTIONS, file, &run, &state);
    (void)dup2(refuse_stderr, STDERR_FILENO);
    close(refuse_stderr);
    fclose(refuse_file);
    cuts += code == ISPH_USER_ERROR;
    PetscCall(RunDestroy(&run));
  }
  CHECK(cuts == 7, "damage: truncated files are refused");
  PetscCall(PetscFree(bytes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The options file gives the same options back. */
static PetscErrorCode CheckOptions(void)
{
  Run       run;
  char      value[128];
  PetscBool found;

  PetscFunctionBegin;
  PetscCall(RunCreate(RUN_OPTIONS "-output_overwrite -title \"two words\" -shift -20e-3,-1 -flag -negative -3 ", &run));
  PetscCall(OutputSetUp(run.output, NULL, &Beginning));
  PetscCall(RunDestroy(&run));
  CHECK(!Exists(FOLDER "/checkpoint_000006.h5") && !Exists(FOLDER "/snapshots.xdmf") && Exists(FOLDER "/damaged.h5"),
        "overwrite removes what a run writes, and no more");
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscOptionsInsertFile(PETSC_COMM_WORLD, NULL, FOLDER "/options.opts", PETSC_TRUE));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-title", value, sizeof(value), &found));
  CHECK(found && !strcmp(value, "two words"), "options: a value with a space");
  PetscCall(PetscOptionsGetString(NULL, NULL, "-shift", value, sizeof(value), &found));
  CHECK(found && !strcmp(value, "-20e-3,-1"), "options: a negative value");
  PetscCall(PetscOptionsHasName(NULL, NULL, "-flag", &found));
  CHECK(found, "options: a flag");
  PetscCall(PetscOptionsGetString(NULL, NULL, "-bodies", value, sizeof(value), &found));
  CHECK(found && !strcmp(value, "film"), "options: a name");
  PetscCall(PetscOptionsHasName(NULL, NULL, "-output_dir", &found));
  CHECK(!found, "options: without the folder");
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  world = PETSC_COMM_WORLD;
  PetscCall(LogRegister());
  PetscCall(UserErrorHandlerPush());
  PetscCall(RemoveFolder());
  PetscCall(WriteRun());
  CheckRows();
  CheckRoom();
  PetscCall(CheckRestart());
  PetscCall(CheckRefusals());
  PetscCall(CheckDamage());
  PetscCall(CheckOptions());
  PetscCall(CheckOtherRanks());
  PetscCall(RemoveFolder());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
