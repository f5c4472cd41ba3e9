/* Snapshots: one HDF5 file each, with what -snapshot_fields, -snapshot_lower and -snapshot_upper choose. */
#include "output_impl.h"
#include <unistd.h>

#define SNAPSHOT_WIDEST 6     /* most numbers of a field, those of a tensor */
#define FILE_HEAD       40000 /* bytes of a snapshot besides its fields */
#define DEFLATED        0.5   /* share of the fields that compression leaves; 0.5 to 0.6 of runs that have begun */

static PetscErrorCode EntryAdd(Output output, const SnapshotEntry *entry)
{
  PetscFunctionBegin;
  PetscCall(ListGrow(output->entries, &output->entry_capacity, sizeof(*output->entry), &output->entry));
  output->entry[output->entries++] = *entry;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- snapshots of an earlier start of the run --- */

/* Reads what the XDMF file needs from a snapshot. Rank 0. */
static PetscErrorCode EntryRead(Output output, PetscInt index, SnapshotEntry *entry, PetscBool *good)
{
  char       name[64], path[PETSC_MAX_PATH_LEN];
  H5File     h5;
  PetscInt64 step = 0, n = 0, precision = 0;
  PetscBool  whole, failed;

  PetscFunctionBegin;
  SnapshotName(index, name);
  PetscCall(OutputPath(output, name, path));
  PetscCall(PetscMemzero(entry, sizeof(*entry)));
  PetscCall(H5FileOpen(PETSC_COMM_SELF, path, &h5));
  whole = (PetscBool)(H5FileGetReal(&h5, "time", &entry->time) && H5FileGetInt(&h5, "step", &step) &&
                      H5FileGetInt(&h5, "particles", &n) && H5FileGetInt(&h5, "precision", &precision));
  for (PetscInt f = 0; f < SNAPSHOT_FIELDS; f++)
    if (H5FileHas(&h5, SnapshotFieldAt(f).column.name)) entry->fields |= 1U << f;
  PetscCall(H5FileClose(&h5, &failed));
  entry->index     = index;
  entry->step      = (PetscInt)step;
  entry->n         = (PetscInt)n;
  entry->precision = (PetscInt)precision;
  *good            = (PetscBool)(whole && !failed);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SnapshotScan(Output output, PetscInt restart_step)
{
  PetscInt  count = 0, *numbers = NULL;
  PetscBool changed = PETSC_FALSE;
  char      name[64], path[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  output->entries = 0;
  if (!output->rank) PetscCall(FolderNumbers(output->folder, "snapshot_", &count, &numbers));
  for (PetscInt k = 0; k < count; k++) { /* rank 0 */
    SnapshotEntry entry;
    PetscBool     good = PETSC_FALSE;

    PetscCall(EntryRead(output, numbers[k], &entry, &good));
    if (good && entry.step <= restart_step)
      PetscCall(EntryAdd(output, &entry));
    else {
      SnapshotName(numbers[k], name);
      PetscCall(OutputPath(output, name, path));
      (void)unlink(path);
      changed = PETSC_TRUE;
    }
  }
  PetscCall(PetscFree(numbers));
  PetscCallMPI(MPI_Bcast(&output->entries, 1, MPIU_INT, 0, output->comm));
  PetscCallMPI(MPI_Bcast(&changed, 1, MPIU_BOOL, 0, output->comm));
  if (output->rank && output->entries) PetscCall(PetscMalloc1(output->entries, &output->entry));
  if (output->rank) output->entry_capacity = output->entries;
  if (output->entries)
    PetscCallMPI(
      MPI_Bcast(output->entry, (PetscMPIInt)(sizeof(*output->entry) * output->entries), MPI_BYTE, 0, output->comm));
  output->snapshot_step = output->entries ? output->entry[output->entries - 1].step : -1;
  if (changed) PetscCall(XdmfWrite(output));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- writing --- */

/* Whether a particle of 'body' at x (m) goes into the snapshots. Particles of moving solids do: solids.h5 has their
   positions at the start only. */
static PetscBool Wanted(Output output, PetscInt body, const PetscReal x[DIM])
{
  const SnapshotSetup *content = &output->content;
  const Scene          scene   = output->cloud->scene;
  const PetscBool      moves   = (PetscBool)(body <= BODY_SOLID && BodyMoves(SceneSolid(scene, BODY_SOLID - body)));

  if (body < 0 && !content->walls && !moves) return PETSC_FALSE;
  for (PetscInt d = 0; d < output->cloud->domain->dim && content->region; d++)
    if (x[d] < content->corner[0][d] || x[d] > content->corner[1][d]) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* The rows of the snapshot: particle[k] is the local index of row k. */
static PetscErrorCode Choose(Output output, const ParticleArrays *arrays, PetscInt particle[], Rows *rows)
{
  PetscInt n = 0;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < arrays->n; a++)
    if (Wanted(output, arrays->integer[INT_BODY][a], arrays->real[FIELD_POSITION] + DIM * a)) particle[n++] = a;
  PetscCall(RowsSet(output->comm, n, 1, rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void WriteHead(Output output, const StepState *state, const SnapshotEntry *entry, H5File *h5)
{
  const Domain    domain = output->cloud->domain;
  const PetscReal h      = KernelSmoothingLength(output->cloud->kernel);
  const PetscReal level  = GaugesLevel(output->gauges);

  H5FilePutText(h5, "format", "isph snapshot");
  H5FilePutText(h5, "version", ISPH_VERSION);
  H5FilePutReal(h5, "time", 1, &state->time);
  H5FilePutReal(h5, "time_step", 1, &state->time_step);
  H5FilePutReal(h5, "pressure_time", 1, &state->pressure_time);
  H5FilePutInt(h5, "step", state->step);
  H5FilePutInt(h5, "particles", entry->n);
  H5FilePutInt(h5, "precision", entry->precision);
  H5FilePutInt(h5, "walls", output->content.walls);
  H5FilePutInt(h5, "dimension", domain->dim);
  H5FilePutInt(h5, "axisymmetric", domain->rings);
  H5FilePutReal(h5, "spacing", 1, &domain->spacing);
  H5FilePutReal(h5, "smoothing_length", 1, &h);
  H5FilePutReal(h5, "box_lower", DIM, domain->lower);
  H5FilePutReal(h5, "box_upper", DIM, domain->upper);
  H5FilePutReal(h5, "level", 1, &level);
  H5FilePutText(h5, "options", output->options);
}

/* Fills 'values' with an integer field, or with a real field in the precision of the snapshots. */
static void Pack(Output output, const ParticleArrays *arrays, const PetscInt particle[], PetscInt n, PetscInt f,
                 void *values)
{
  const SnapshotField field   = SnapshotFieldAt(f);
  const PetscInt      width   = field.width;
  double             *real    = (double *)values;
  float              *single  = (float *)values;
  PetscInt           *integer = (PetscInt *)values;

  for (PetscInt k = 0; k < n; k++) {
    const PetscInt a = particle[k];

    if (field.integer >= 0)
      integer[k] = arrays->integer[field.integer][a];
    else
      for (PetscInt c = 0; c < width; c++) {
        if (output->content.precise)
          real[width * k + c] = arrays->real[f][width * a + c];
        else
          single[width * k + c] = (float)arrays->real[f][width * a + c];
      }
  }
}

static PetscErrorCode WriteFields(Output output, const ParticleArrays *arrays, const PetscInt particle[], Rows *rows,
                                  H5File *h5)
{
  double *values;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(SNAPSHOT_WIDEST * rows->n + 1, &values));
  for (PetscInt f = 0; f < SNAPSHOT_FIELDS; f++) {
    const SnapshotField field = SnapshotFieldAt(f);
    const hid_t         real  = output->content.precise ? H5T_NATIVE_DOUBLE : H5T_NATIVE_FLOAT;

    if (!(output->content.fields & 1U << f)) continue;
    rows->width = field.width;
    Pack(output, arrays, particle, rows->n, f, values);
    PetscCall(H5FileWrite(h5, field.column.name, field.integer < 0 ? real : H5FILE_INT, rows, values,
                          SnapshotUnit(output, f), field.meaning));
  }
  PetscCall(PetscFree(values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Bytes of a particle in a snapshot. */
static PetscInt64 ParticleBytes(Output output)
{
  const size_t real  = output->content.precise ? sizeof(double) : sizeof(float);
  PetscInt64   bytes = 0;

  for (PetscInt f = 0; f < SNAPSHOT_FIELDS; f++) {
    const SnapshotField field = SnapshotFieldAt(f);

    if (output->content.fields & 1U << f)
      bytes += field.width * (PetscInt64)(field.integer < 0 ? real : sizeof(PetscInt));
  }
  return bytes;
}

PetscErrorCode OutputEstimate(Output output, PetscReal start, PetscReal end, PetscInt64 *snapshots, PetscInt64 *bytes,
                              PetscInt64 *checkpoint, PetscReal each[2])
{
  PetscInt       count[2] = {0, 0}; /* in a snapshot, all */
  PetscInt64     stored   = INT_COUNT * (PetscInt64)sizeof(PetscInt);
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(output->cloud->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++)
    count[0] += Wanted(output, arrays.integer[INT_BODY][a], arrays.real[FIELD_POSITION] + DIM * a);
  count[1] = arrays.n;
  PetscCall(ParticlesClose(output->cloud->particles, &arrays));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, count, 2, MPIU_INT, MPI_SUM, output->comm));
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++)
    if (ParticlesHave(output->cloud->particles, f)) stored += Fields[f].width * (PetscInt64)sizeof(PetscReal);
  each[0]     = (output->content.compression ? DEFLATED : 1) * (PetscReal)ParticleBytes(output);
  each[1]     = (PetscReal)stored;
  *bytes      = FILE_HEAD + (PetscInt64)((PetscReal)count[0] * each[0]);
  *checkpoint = count[1] * stored;
  *snapshots  = 2;
  if (output->snapshot.interval > 0 && end < PETSC_MAX_REAL)
    *snapshots = 1 + (PetscInt64)PetscCeilReal((end - start) / output->snapshot.interval);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SnapshotWrite(Output output, const StepState *state)
{
  ParticleArrays arrays;
  SnapshotEntry  entry;
  H5File         h5;
  Rows           rows;
  PetscInt      *particle;
  PetscBool      failed;
  char           name[64], path[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_OUTPUT), 0, 0, 0, 0));
  InterruptAlive("the writing of a snapshot");
  PetscCall(ParticlesOpen(output->cloud->particles, &arrays));
  PetscCall(PetscMalloc1(arrays.n + 1, &particle));
  PetscCall(Choose(output, &arrays, particle, &rows));
  entry.index     = output->entries ? output->entry[output->entries - 1].index + 1 : 0;
  entry.step      = state->step;
  entry.time      = state->time;
  entry.n         = rows.total;
  entry.precision = output->content.precise ? (PetscInt)sizeof(double) : (PetscInt)sizeof(float);
  entry.fields    = output->content.fields;
  SnapshotName(entry.index, name);
  PetscCall(OutputPath(output, name, path));
  TextAppend(path, sizeof(path), ".tmp");
  PetscCall(H5FileCreate(output->comm, path, &h5));
  WriteHead(output, state, &entry, &h5);
  h5.compression = output->content.compression;
  PetscCall(WriteFields(output, &arrays, particle, &rows, &h5));
  PetscCall(VtkWrite(&h5, &entry, &rows));
  PetscCall(H5FileClose(&h5, &failed));
  PetscCall(PetscFree(particle));
  PetscCall(ParticlesClose(output->cloud->particles, &arrays));
  if (failed) PetscCall(FolderDiscard(output, name));
  PetscCheckUser(!failed, output->comm, "Cannot write the snapshot %s/%s: is the disk full, or the folder gone?",
                 output->folder, name);
  PetscCall(FolderCommit(output, name, PETSC_FALSE));
  PetscCall(EntryAdd(output, &entry));
  PetscCall(XdmfWrite(output));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_OUTPUT), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
