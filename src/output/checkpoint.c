/* Checkpoints: all stored fields in the swarm's order, the state of the stepper and of this class; sealed by a
 * checksum. */
#include "output_impl.h"
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#define CHECKPOINT_FORMAT  "isph checkpoint"
#define CHECKPOINT_VERSION 4
#define SCENE              "scene_identity" /* older files have "scene", whose lines cannot be compared with these */
#define HEAD_TEXT          65536            /* bytes of a text: the most that HDF5 keeps in an attribute */

/* The numbers in the head of the file. */
typedef struct {
  StepState state;
  PetscReal spacing, level, wall_time;
  PetscInt  dimension, bodies, particles, ranks;
} Head;

static const NumberRow HeadRows[] = {
  {"spacing", NUMBER_REAL, offsetof(Head, spacing), ENERGY_NONE, NULL},
  {"level", NUMBER_MAYBE, offsetof(Head, level), ENERGY_NONE, NULL},
  {"wall_time", NUMBER_SPAN, offsetof(Head, wall_time), ENERGY_NONE, NULL},
  {"dimension", NUMBER_COUNT, offsetof(Head, dimension), ENERGY_NONE, NULL},
  {"bodies", NUMBER_COUNT, offsetof(Head, bodies), ENERGY_NONE, NULL},
  {"particles", NUMBER_COUNT, offsetof(Head, particles), ENERGY_NONE, NULL},
  {"ranks", NUMBER_COUNT, offsetof(Head, ranks), ENERGY_NONE, NULL},
  {.name = NULL},
};

/* Number k of the head; false: there are only k. */
static PetscBool HeadNumber(const Head *head, PetscInt k, Number *number)
{
  return (PetscBool)(NumbersWalk(HeadRows, head, &k, number) || StateNumber(&head->state, k, number));
}

static void HeadFill(Output output, const StepState *state, PetscInt particles, Head *head)
{
  *head = (Head){.state     = *state,
                 .spacing   = output->cloud->domain->spacing,
                 .level     = GaugesLevel(output->gauges),
                 .wall_time = OutputWallTime(output),
                 .dimension = output->cloud->domain->dim,
                 .bodies    = SceneCount(output->cloud->scene),
                 .particles = particles,
                 .ranks     = output->size};
}

/* --- writing --- */

static void HeadPut(H5File *h5, const Head *head, const char scene[], const char options[])
{
  Number number;

  H5FilePutText(h5, "format", CHECKPOINT_FORMAT);
  H5FilePutInt(h5, "format_version", CHECKPOINT_VERSION);
  H5FilePutText(h5, "version", ISPH_VERSION);
  H5FilePutText(h5, SCENE, scene);
  H5FilePutText(h5, "options", options);
  for (PetscInt k = 0; HeadNumber(head, k, &number); k++)
    if (number.row->kind == NUMBER_COUNT)
      H5FilePutInt(h5, number.row->name, *(PetscInt *)number.at);
    else
      H5FilePutReal(h5, number.row->name, 1, (PetscReal *)number.at);
}

/* The positions, wrapped into the box as a restart needs them, to be freed: during a run a particle may be behind a
   periodic face for some steps. */
static PetscErrorCode Positions(Output output, const ParticleArrays *arrays, PetscReal **position)
{
  PetscFunctionBegin;
  PetscCall(PetscMalloc1(DIM * arrays->n, position));
  PetscCall(PetscArraycpy(*position, arrays->real[FIELD_POSITION], DIM * arrays->n));
  for (PetscInt a = 0; a < arrays->n; a++)
    if (arrays->integer[INT_LAYER][a] == 0) DomainWrap(output->cloud->domain, *position + DIM * a);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FieldsPut(Output output, H5File *h5, ParticleArrays *arrays, Rows rows)
{
  PetscInt   counts = arrays->n;
  Rows       ranks  = {.n = 1, .start = output->rank, .total = output->size, .width = 1};
  PetscReal *position;

  PetscFunctionBegin;
  PetscCall(H5FileWrite(h5, "counts", H5FILE_INT, &ranks, &counts, "1", "particles of each rank"));
  PetscCall(Positions(output, arrays, &position));
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++) {
    if (!arrays->real[f]) continue;
    rows.width = Fields[f].width;
    PetscCall(H5FileWrite(h5, Fields[f].name, H5T_NATIVE_DOUBLE, &rows,
                          f == FIELD_POSITION ? position : arrays->real[f], SnapshotUnit(output, f),
                          Fields[f].meaning));
  }
  PetscCall(PetscFree(position));
  rows.width = 1;
  for (PetscInt f = 0; f < INT_COUNT; f++)
    PetscCall(H5FileWrite(h5, IntFieldNames[f], H5FILE_INT, &rows, arrays->integer[f], "1", IntFieldMeanings[f]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes the numbers that an edge of the step keeps in the scene, or reads them into it. *good becomes false if a
   number is not finite. */
static PetscErrorCode TablePutGet(Output output, H5File *h5, const NumberTable *table, void *numbers, PetscBool write,
                                  PetscBool *good)
{
  const Scene scene = output->cloud->scene;
  Rows        rows  = {.n = 0, .start = 0, .total = 0, .width = 0};
  PetscReal  *all, *own;

  PetscFunctionBegin;
  while (table->row(scene, numbers, rows.total, &rows.width)) rows.total++;
  if (!rows.total) PetscFunctionReturn(PETSC_SUCCESS);
  rows.n = output->rank ? 0 : rows.total;
  PetscCall(PetscCalloc1(rows.total * rows.width, &all));
  if (!write) {
    PetscCall(H5FileRead(h5, table->name, H5T_NATIVE_DOUBLE, &rows, all));
    PetscCallMPI(MPI_Bcast(all, (PetscMPIInt)(rows.total * rows.width), MPIU_REAL, 0, output->comm));
  }
  for (PetscInt k = 0; k < rows.total; k++) {
    own = table->row(scene, numbers, k, &rows.width);
    PetscCall(PetscArraycpy(write ? all + rows.width * k : own, write ? own : all + rows.width * k, rows.width));
    for (PetscInt i = 0; i < rows.width; i++) *good = (PetscBool)(*good && !PetscIsInfOrNanReal(own[i]));
  }
  if (write) PetscCall(H5FileWrite(h5, table->name, H5T_NATIVE_DOUBLE, &rows, all, "SI", table->meaning));
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Tables(Output output, H5File *h5, const StepState *state, PetscBool write, PetscBool *good)
{
  const NumberTable *table;
  void              *numbers;

  PetscFunctionBegin;
  for (PetscInt k = 0; (table = StepperTable(state, k, &numbers)); k++)
    PetscCall(TablePutGet(output, h5, table, numbers, write, good));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void OutputCheckpointName(PetscInt step, char name[OUTPUT_NAME_LENGTH])
{
  (void)snprintf(name, OUTPUT_NAME_LENGTH, "checkpoint_%06d.h5", (int)step);
}

/* Removes all checkpoints but those of this step and the newest step before it. Later steps are of a run that a restart
   gave up. The checkpoint by the clock is older than this step's. */
static PetscErrorCode Prune(Output output, PetscInt step)
{
  PetscInt count, *numbers, before = -1;
  char     name[OUTPUT_NAME_LENGTH], path[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  if (output->rank) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(FolderNumbers(output->folder, "checkpoint_", &count, &numbers));
  for (PetscInt k = 0; k < count; k++)
    if (numbers[k] < step) before = numbers[k];
  for (PetscInt k = 0; k < count; k++) {
    if (numbers[k] == step || numbers[k] == before) continue;
    OutputCheckpointName(numbers[k], name);
    PetscCall(OutputPath(output, name, path));
    (void)unlink(path);
  }
  PetscCall(PetscFree(numbers));
  PetscCall(OutputPath(output, CHECKPOINT_BY_CLOCK, path));
  (void)unlink(path);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Write(Output output, const StepState *state, const char name[])
{
  ParticleArrays arrays;
  H5File         h5;
  Rows           rows;
  Head           head;
  PetscBool      failed, good = PETSC_TRUE;
  char           path[PETSC_MAX_PATH_LEN], *scene;

  PetscFunctionBegin;
  PetscCheck(output->ready, output->comm, PETSC_ERR_ORDER, "Call OutputSetUp first");
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_OUTPUT), 0, 0, 0, 0));
  InterruptAlive("the writing of a checkpoint");
  PetscCall(FolderStands(output));
  PetscCall(ParticlesOpen(output->cloud->particles, &arrays));
  PetscCall(RowsSet(output->comm, arrays.n, 1, &rows));
  HeadFill(output, state, rows.total, &head);
  PetscCall(OutputPath(output, name, path));
  TextAppend(path, sizeof(path), ".tmp");
  PetscCall(H5FileCreate(output->comm, path, &h5));
  PetscCall(CloudIdentity(output->cloud, &scene));
  HeadPut(&h5, &head, scene, output->options ? output->options : "");
  free(scene);
  PetscCall(FieldsPut(output, &h5, &arrays, rows));
  PetscCall(Tables(output, &h5, state, PETSC_TRUE, &good));
  PetscCall(H5FileClose(&h5, &failed));
  PetscCall(ParticlesClose(output->cloud->particles, &arrays));
  if (!failed) PetscCall(FileSeal(output->comm, path, &failed));
  if (failed) PetscCall(FolderDiscard(output, name));
  PetscCheckUser(!failed, output->comm, "Cannot write the checkpoint %s/%s: is the disk full, or the folder gone?",
                 output->folder, name);
  PetscCall(FolderCommit(output, name, PETSC_TRUE));
  PetscCall(OutputPath(output, name, path));
  InterruptCheckpoint(path);
  output->clock_at = (PetscReal)MPI_Wtime();
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_OUTPUT), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputCheckpoint(Output output, const StepState *state)
{
  char name[OUTPUT_NAME_LENGTH];

  PetscFunctionBegin;
  output->checkpoint.next = ScheduleAfter(&output->checkpoint, state->time);
  OutputCheckpointName(state->step, name);
  PetscCall(Write(output, state, name));
  PetscCall(Prune(output, state->step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool OutputClockDue(Output output)
{
  return (PetscBool)(output->clock_interval > 0 &&
                     MPI_Wtime() - (double)output->clock_at >= (double)output->clock_interval);
}

PetscErrorCode OutputByClock(Output output, const StepState *state)
{
  PetscFunctionBegin;
  PetscCall(Write(output, state, CHECKPOINT_BY_CLOCK));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- reading --- */

/* What rank 0 finds wrong with a file. */
typedef enum { FILE_GOOD, FILE_MISSING, FILE_FOREIGN, FILE_BROKEN, FILE_OTHER_VERSION } FileVerdict;

/* Whether all numbers of the head are there and a PetscInt holds the integers. */
static PetscBool HeadRead(H5File *h5, Head *head)
{
  Number     number;
  PetscBool  whole = PETSC_TRUE;
  PetscInt64 value;

  for (PetscInt k = 0; whole && HeadNumber(head, k, &number); k++)
    if (number.row->kind == NUMBER_COUNT) {
      whole =
        (PetscBool)(H5FileGetInt(h5, number.row->name, &value) && value >= PETSC_MIN_INT && value <= PETSC_MAX_INT);
      if (whole) *(PetscInt *)number.at = (PetscInt)value;
    } else
      whole = H5FileGetReal(h5, number.row->name, (PetscReal *)number.at);
  return whole;
}

/* The texts in the head, empty where there is none: the scene's description, the options of the run that wrote it. */
typedef struct {
  char scene[HEAD_TEXT], options[HEAD_TEXT];
} Texts;

/* Reads the head and its texts, if the file is a checkpoint.
   Rank 0. */
static PetscErrorCode HeadGet(const char file[], Seal seal, Head *head, Texts *texts, FileVerdict *verdict)
{
  H5File      h5;
  PetscBool   failed;
  PetscInt64  version;
  struct stat info;
  char        format[64];

  PetscFunctionBegin;
  *verdict = FILE_MISSING;
  if (stat(file, &info) || !S_ISREG(info.st_mode) || access(file, R_OK)) PetscFunctionReturn(PETSC_SUCCESS);
  *verdict = FILE_BROKEN;
  if (seal == SEAL_WRONG) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(H5FileOpen(PETSC_COMM_SELF, file, &h5));
  if (h5.failed) {
    if (H5Fis_hdf5(file) <= 0) *verdict = FILE_FOREIGN;
  } else if (!H5FileGetText(&h5, "format", format, sizeof(format)) || strcmp(format, CHECKPOINT_FORMAT))
    *verdict = FILE_FOREIGN;
  else if (H5FileGetInt(&h5, "format_version", &version) && version != CHECKPOINT_VERSION)
    *verdict = FILE_OTHER_VERSION;
  else if (seal == SEAL_GOOD && !HeadRead(&h5, head)) /* numbers came or went since it was written */
    *verdict = FILE_OTHER_VERSION;
  else if (seal == SEAL_GOOD) {
    (void)H5FileGetText(&h5, SCENE, texts->scene, HEAD_TEXT);
    (void)H5FileGetText(&h5, "options", texts->options, HEAD_TEXT);
    *verdict = FILE_GOOD;
  }
  PetscCall(H5FileClose(&h5, &failed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses numbers that no run leaves. */
static PetscErrorCode HeadCheckNumbers(Output output, const char file[], const Head *head)
{
  Number number;

  PetscFunctionBegin;
  for (PetscInt k = 0; HeadNumber(head, k, &number); k++) {
    const NumberKind kind  = number.row->kind;
    const PetscReal  value = kind == NUMBER_COUNT ? (PetscReal) * (PetscInt *)number.at : *(PetscReal *)number.at;
    const PetscBool  nan   = (PetscBool)(value != value && kind == NUMBER_MAYBE),
                    low    = (PetscBool)(value < 0 && (kind == NUMBER_SPAN || kind == NUMBER_COUNT));

    PetscCheckUser(nan || (!PetscIsInfOrNanReal(value) && !low), output->comm,
                   "The checkpoint %s cannot be used: its %s is %g; restart from another one.", file, number.row->name,
                   (double)value);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* turns: rings of any spacing become particles in space. */
static PetscErrorCode HeadCheck(Output output, const char file[], const Head *head, PetscBool turns,
                                FileVerdict verdict)
{
  const Domain    domain  = output->cloud->domain;
  const PetscReal spacing = head->spacing;
  const PetscInt  bodies  = SceneCount(output->cloud->scene);
  MPI_Comm        comm    = output->comm;

  PetscFunctionBegin;
  PetscCheckUser(verdict != FILE_MISSING, comm, "There is no readable file %s to restart from.", file);
  PetscCheckUser(verdict != FILE_FOREIGN, comm,
                 "%s is not a checkpoint of this program; restart from a file named checkpoint_<step>.h5.", file);
  PetscCheckUser(verdict != FILE_OTHER_VERSION, comm,
                 "The checkpoint %s is of another version of the program; continue with the version that wrote it.",
                 file);
  PetscCheckUser(verdict != FILE_BROKEN, comm,
                 "The checkpoint %s is truncated or damaged; restart from the one before it.", file);
  PetscCheckUser(turns || head->dimension == domain->dim, comm,
                 "The checkpoint %s has %d dimensions, the scene has %d.", file, (int)head->dimension,
                 (int)domain->dim);
  PetscCheckUser(turns || PetscAbsReal(spacing - domain->spacing) <= 1e-12 * domain->spacing, comm,
                 "The checkpoint %s has particles of spacing %g m, the scene of %g m.", file, (double)spacing,
                 (double)domain->spacing);
  PetscCheckUser(head->bodies == bodies, comm, "The checkpoint %s has %d bodies, the scene has %d.", file,
                 (int)head->bodies, (int)bodies);
  PetscCall(HeadCheckNumbers(output, file, head));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows of this rank: on as many ranks as wrote the file, the rows that it wrote; else equal slabs. *good: the
   counts of the ranks add up to the number of particles, and the file is long enough. Collective. */
static PetscErrorCode Share(Output output, H5File *h5, const Head *head, PetscBool turns, Rows *rows, PetscBool *good)
{
  const PetscInt total = head->particles, size = output->size, rank = output->rank;
  Rows           ranks = {.n = 0, .start = 0, .total = head->ranks, .width = 1};
  PetscInt      *counts;
  PetscInt64     sum = 0;
  size_t         row = INT_COUNT * sizeof(int32_t); /* bytes; with 64-bit indices the file may have more */

  PetscFunctionBegin;
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++)
    if (ParticlesHave(output->cloud->particles, f) && (!turns || H5FileHas(h5, Fields[f].name)))
      row += (size_t)Fields[f].width * sizeof(double);
  *good = (PetscBool)(H5FileHolds(h5, total, row) && H5FileHolds(h5, ranks.total, sizeof(int32_t)));
  if (!*good) PetscFunctionReturn(PETSC_SUCCESS);
  ranks.n = rank ? 0 : ranks.total; /* rank 0 reads all */
  PetscCall(PetscCalloc1(ranks.total + 1, &counts));
  PetscCall(H5FileRead(h5, "counts", H5FILE_INT, &ranks, counts));
  PetscCallMPI(MPI_Bcast(counts, (PetscMPIInt)ranks.total, MPIU_INT, 0, output->comm));
  for (PetscInt k = 0; k < ranks.total; k++) {
    *good = (PetscBool)(*good && counts[k] >= 0);
    sum += counts[k];
  }
  *good       = (PetscBool)(*good && sum == total);
  rows->total = total;
  rows->width = 1;
  rows->n     = total / size + (rank < total % size);
  rows->start = rank * (total / size) + PetscMin(rank, total % size);
  if (turns) { /* few: the first rank turns all */
    rows->n     = rank ? 0 : total;
    rows->start = rank ? total : 0;
  } else if (*good && ranks.total == size) {
    rows->n     = counts[rank];
    rows->start = 0;
    for (PetscInt k = 0; k < rank; k++) rows->start += counts[k];
  }
  PetscCall(PetscFree(counts));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FieldsGet(Output output, H5File *h5, const Head *head, PetscBool turns, PetscBool *good)
{
  ParticleArrays arrays;
  Rows           rows;

  PetscFunctionBegin;
  PetscCall(Share(output, h5, head, turns, &rows, good));
  if (!*good) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ParticlesAppend(output->cloud->particles, rows.n));
  PetscCall(ParticlesOpen(output->cloud->particles, &arrays));
  for (PetscInt f = 0; f < INT_COUNT; f++)
    PetscCall(H5FileRead(h5, IntFieldNames[f], H5FILE_INT, &rows, arrays.integer[f]));
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++) {
    if (!arrays.real[f]) continue;
    rows.width = Fields[f].width;
    if (!turns || H5FileHas(h5, Fields[f].name))
      PetscCall(H5FileRead(h5, Fields[f].name, H5T_NATIVE_DOUBLE, &rows, arrays.real[f]));
    else
      RestartFillIn((FieldId)f, &arrays);
  }
  PetscCall(ParticlesClose(output->cloud->particles, &arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void HeadUse(Output output, const Head *head, StepState *state)
{
  *state              = head->state;
  output->wall_before = head->wall_time;
  GaugesSetLevel(output->gauges, head->level);
  output->series.next     = ScheduleAfter(&output->series, state->time);
  output->snapshot.next   = ScheduleAfter(&output->snapshot, state->time);
  output->checkpoint.next = ScheduleAfter(&output->checkpoint, state->time);
}

/* Gives the walls the velocity of this run's options. */
static PetscErrorCode MoveWalls(Output output)
{
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(output->cloud->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++)
    if (arrays.integer[INT_BODY][a] == BODY_WALL)
      DomainWallVelocity(output->cloud->domain, arrays.real[FIELD_POSITION] + DIM * a,
                         arrays.real[FIELD_VELOCITY] + DIM * a);
  PetscCall(ParticlesClose(output->cloud->particles, &arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputNewest(Output output, char path[PETSC_MAX_PATH_LEN])
{
  const char *folder = path;
  char        name[OUTPUT_NAME_LENGTH], found[PETSC_MAX_PATH_LEN];
  struct stat info;
  PetscInt    count = 1, *numbers = NULL;

  PetscFunctionBegin;
  if (!output->rank && !stat(path, &info) && S_ISDIR(info.st_mode)) {
    PetscCall(PetscSNPrintf(found, sizeof(found), "%s/" CHECKPOINT_BY_CLOCK, folder));
    if (access(found, F_OK)) { /* each other checkpoint removes it */
      PetscCall(FolderNumbers(folder, "checkpoint_", &count, &numbers));
      OutputCheckpointName(count ? numbers[count - 1] : 0, name);
      PetscCall(PetscSNPrintf(found, sizeof(found), "%s/%s", folder, name));
    }
    if (count) PetscCall(PetscStrncpy(path, found, PETSC_MAX_PATH_LEN));
  }
  PetscCall(PetscFree(numbers));
  PetscCallMPI(MPI_Bcast(&count, 1, MPIU_INT, 0, output->comm));
  PetscCallMPI(MPI_Bcast(path, PETSC_MAX_PATH_LEN, MPI_CHAR, 0, output->comm));
  PetscCheckUser(count > 0, output->comm, "The folder %s has no checkpoint_<step>.h5 to restart from.", path);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputRestart(Output output, const char file[], const char disturbance[], StepState *state,
                             PetscBool *turned)
{
  Head        head;
  FileVerdict verdict = FILE_MISSING;
  H5File      h5;
  Seal        seal;
  PetscBool   failed, external, good = PETSC_FALSE;
  PetscInt    present;
  Texts      *texts;

  PetscFunctionBegin;
  ProgressBegin("the restart", "the checkpoint is as it was");
  PetscCall(ParticlesGlobalSize(output->cloud->particles, &present));
  PetscCheck(!present, output->comm, PETSC_ERR_ORDER, "A restart needs an empty swarm");
  PetscCall(PetscMemzero(&head, sizeof(head)));
  PetscCall(FileCheckSeal(output->comm, file, &seal));
  PetscCall(PetscNew(&texts));
  if (!output->rank) PetscCall(HeadGet(file, seal, &head, texts, &verdict));
  *turned = RestartTurns(output, texts->scene);
  PetscCallMPI(MPI_Bcast(turned, 1, MPIU_BOOL, 0, output->comm));
  PetscCallMPI(MPI_Bcast(&verdict, sizeof(verdict), MPI_BYTE, 0, output->comm));
  PetscCallMPI(MPI_Bcast(&head, sizeof(head), MPI_BYTE, 0, output->comm));
  PetscCall(HeadCheck(output, file, &head, *turned, verdict));
  PetscCheckUser(*turned || !disturbance[0], output->comm,
                 "-restart_disturbance is for a scene in space that begins from rings, which the checkpoint %s is not",
                 file);
  PetscCall(H5FileOpen(output->comm, file, &h5));
  PetscCall(*turned ? RestartRingsCheck(output, file, texts->scene, &h5)
                    : RestartSceneCheck(output, file, texts->scene));
  PetscCall(FieldsGet(output, &h5, &head, *turned, &good));
  if (!*turned) PetscCall(Tables(output, &h5, &head.state, PETSC_FALSE, &good));
  external = h5.external;
  PetscCall(H5FileClose(&h5, &failed));
  PetscCheckUser(!external, output->comm,
                 "The checkpoint %s cannot be used: some of its data lie behind a link or in another file; restart "
                 "from another one.",
                 file);
  PetscCheckUser(good && !failed, output->comm,
                 "The checkpoint %s is truncated or damaged; restart from the one before it.", file);
  if (*turned) {
    PetscCall(RestartTurn(output, file, disturbance));
    state->time = head.state.time;
    GaugesSetLevel(output->gauges, head.level);
  } else {
    PetscCall(MoveWalls(output));
    InterruptCheckpoint(file);
    HeadUse(output, &head, state);
    PetscCall(RestartOptionsSay(output, texts->options));
  }
  PetscCall(RestartCheckParticles(output, file));
  PetscCall(PetscFree(texts));
  PetscFunctionReturn(PETSC_SUCCESS);
}
