/* Snapshots: one HDF5 file each, with what -snapshot_fields, -snapshot_lower and -snapshot_upper choose. */
#include "output_impl.h"
#include <unistd.h>

#define SOLIDS_FILE  "solids.h5"
#define DEFLATE      1 /* default: halves the files; 4 or 9 gain a hundredth more */
#define DEFLATE_MOST 9

/* Integer fields of a snapshot. */
static const IntFieldId int_fields[] = {INT_ID, INT_BODY, INT_SURFACE, INT_LAYER};

SnapshotField SnapshotFieldAt(PetscInt f)
{
  if (f < FIELD_STORED_COUNT)
    return (SnapshotField){Fields[f].name, Fields[f].unit, Fields[f].meaning, Fields[f].width, -1};
  if (f < SNAPSHOT_FIELDS - 1) {
    const IntFieldId id = int_fields[f - FIELD_STORED_COUNT];

    return (SnapshotField){IntFieldNames[id], "1", IntFieldMeanings[id], 1, (PetscInt)id};
  }
  return (SnapshotField){"color", "1", "colour of the body; -1 for a wall", 1, INT_COUNT};
}

/* What every snapshot has: without it a particle is not to be told from others. */
static PetscBool Always(PetscInt f)
{
  const PetscInt integer = SnapshotFieldAt(f).integer;

  return (PetscBool)(f == FIELD_POSITION || integer == INT_ID || integer == INT_BODY);
}

void SnapshotName(PetscInt index, char name[64])
{
  (void)snprintf(name, 64, "snapshot_%06d.h5", (int)index);
}

/* --- what goes into them --- */

PetscErrorCode SnapshotSetFromOptions(Output output, OptionItems PetscOptionsObject)
{
  const Domain   domain  = output->cloud->domain;
  SnapshotSetup *content = &output->content;
  PetscBool      set[2];

  PetscFunctionBegin;
  PetscCall(PetscOptionsBool("-snapshot_walls", "Wall particles in the snapshots too", "OutputStep", content->walls,
                             &content->walls, NULL));
  PetscCall(PetscOptionsBool("-snapshot_double", "Snapshots in double precision", "OutputStep", content->precise,
                             &content->precise, NULL));
  content->names       = SNAPSHOT_FIELDS + 1;
  content->compression = DEFLATE;
  PetscCall(PetscOptionsStringArray("-snapshot_fields",
                                    "Fields of a snapshot besides position, id and body: velocity, pressure, density, "
                                    "lambda, surface, layer (of walls), color; default: all; none",
                                    "OutputStep", content->name, &content->names, NULL));
  for (PetscInt d = 0; d < DIM; d++) {
    content->corner[0][d] = domain->lower[d];
    content->corner[1][d] = domain->upper[d];
  }
  content->numbers[0] = content->numbers[1] = domain->dim + 1;
  PetscCall(PetscOptionsRealArray("-snapshot_lower", "Lower corner of what snapshots hold (m); default: the box's",
                                  "OutputStep", content->corner[0], &content->numbers[0], &set[0]));
  PetscCall(PetscOptionsRealArray("-snapshot_upper", "Upper corner of what snapshots hold (m); default: the box's",
                                  "OutputStep", content->corner[1], &content->numbers[1], &set[1]));
  for (PetscInt side = 0; side < 2; side++)
    if (!set[side]) content->numbers[side] = domain->dim;
  content->region = (PetscBool)(set[0] || set[1]);
  PetscCall(PetscOptionsInt("-snapshot_compression", "Deflate level of the snapshots, 0 (none) to 9 (smallest, slow)",
                            "OutputStep", content->compression, &content->compression, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The bits of the fields that the user named. */
static PetscErrorCode CheckFields(Output output)
{
  SnapshotSetup *content = &output->content;
  PetscBool      none    = PETSC_FALSE;

  PetscFunctionBegin;
  content->fields = 0;
  if (content->names == 1) PetscCall(PetscStrcmp(content->name[0], "none", &none));
  for (PetscInt f = 0; f < SNAPSHOT_FIELDS; f++)
    if (Always(f) || (content->names == 0 && (SnapshotFieldAt(f).integer != INT_LAYER || content->walls)))
      content->fields |= 1U << f;
  for (PetscInt k = 0; k < content->names && !none; k++) {
    PetscBool found = PETSC_FALSE;

    for (PetscInt f = 0; f < SNAPSHOT_FIELDS && !found; f++) {
      PetscCall(PetscStrcmp(content->name[k], SnapshotFieldAt(f).name, &found));
      if (found) content->fields |= 1U << f;
    }
    PetscCheckUser(found, output->comm,
                   "-snapshot_fields names %s; there are velocity, pressure, density, lambda, surface, layer and "
                   "color, or none.",
                   content->name[k]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SnapshotCheck(Output output)
{
  static const char *const option[2] = {"-snapshot_lower", "-snapshot_upper"};
  const Domain             domain    = output->cloud->domain;
  const SnapshotSetup     *content   = &output->content;

  PetscFunctionBegin;
  PetscCall(CheckFields(output));
  for (PetscInt side = 0; side < 2; side++)
    PetscCheckUser(content->numbers[side] == domain->dim, output->comm, "%s has %d numbers; it needs %d.", option[side],
                   (int)content->numbers[side], (int)domain->dim);
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal lower = content->corner[0][d], upper = content->corner[1][d];

    PetscCheckUser(
      lower < upper && lower < domain->upper[d] && upper > domain->lower[d], output->comm,
      "-snapshot_lower and -snapshot_upper leave %c from %g to %g m; there must be a part of the box, which "
      "goes from %g to %g m.",
      'x' + (int)d, (double)lower, (double)upper, (double)domain->lower[d], (double)domain->upper[d]);
  }
  PetscCheckUser(content->compression >= 0 && content->compression <= DEFLATE_MOST, output->comm,
                 "-snapshot_compression is %d; it must be from 0 to %d.", (int)content->compression, DEFLATE_MOST);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SnapshotView(Output output, PetscViewer viewer)
{
  const SnapshotSetup *content = &output->content;

  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(viewer, "    of"));
  PetscCall(PetscViewerASCIIUseTabs(viewer, PETSC_FALSE));
  for (PetscInt f = 0; f < SNAPSHOT_FIELDS; f++)
    if (content->fields & 1U << f) PetscCall(PetscViewerASCIIPrintf(viewer, " %s", SnapshotFieldAt(f).name));
  PetscCall(PetscViewerASCIIPrintf(viewer, "%s, %s precision, compression %d\n",
                                   content->region ? " in a part of the box" : "",
                                   content->precise ? "double" : "single", (int)content->compression));
  PetscCall(PetscViewerASCIIUseTabs(viewer, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode EntryAdd(Output output, const SnapshotEntry *entry)
{
  PetscFunctionBegin;
  if (output->entries == output->entry_capacity) {
    output->entry_capacity = 2 * output->entry_capacity + 64;
    PetscCall(PetscRealloc(sizeof(*output->entry) * output->entry_capacity, &output->entry));
  }
  output->entry[output->entries++] = *entry;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- finding those of an earlier start of the run --- */

/* Reads what the XDMF file needs from a snapshot. Rank 0. */
static PetscErrorCode EntryRead(Output output, PetscInt index, SnapshotEntry *entry, PetscBool *good)
{
  char       name[64], path[PETSC_MAX_PATH_LEN];
  Storage    storage;
  PetscInt64 step = 0, n = 0, precision = 0;
  PetscBool  found[4], failed = PETSC_TRUE;

  PetscFunctionBegin;
  SnapshotName(index, name);
  PetscCall(OutputPath(output, name, path));
  PetscCall(PetscMemzero(entry, sizeof(*entry)));
  PetscCall(StorageOpen(PETSC_COMM_SELF, path, &storage));
  PetscCall(StorageGetReal(&storage, "time", &entry->time, &found[0]));
  PetscCall(StorageGetInt(&storage, "step", &step, &found[1]));
  PetscCall(StorageGetInt(&storage, "particles", &n, &found[2]));
  PetscCall(StorageGetInt(&storage, "precision", &precision, &found[3]));
  for (PetscInt f = 0; f < SNAPSHOT_FIELDS; f++)
    if (StorageHas(&storage, SnapshotFieldAt(f).name)) entry->fields |= 1U << f;
  PetscCall(StorageClose(&storage, &failed));
  entry->index     = index;
  entry->step      = (PetscInt)step;
  entry->n         = (PetscInt)n;
  entry->precision = (PetscInt)precision;
  *good            = (PetscBool)(!failed && found[0] && found[1] && found[2] && found[3]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SnapshotScan(Output output, PetscInt restart_step)
{
  PetscInt  count = 0, *numbers = NULL;
  PetscBool changed = PETSC_FALSE;
  char      name[64], path[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  output->entries = 0;
  if (!output->rank) PetscCall(FolderNumbers(output, "snapshot_", &count, &numbers));
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

/* --- writing one --- */

/* Whether a particle at x (m), in a layer of a wall or in the fluid (0), goes into the snapshots. */
static PetscBool Wanted(Output output, PetscInt layer, const PetscReal x[DIM])
{
  const SnapshotSetup *content = &output->content;

  if (layer && !content->walls) return PETSC_FALSE;
  for (PetscInt d = 0; d < output->cloud->domain->dim && content->region; d++)
    if (x[d] < content->corner[0][d] || x[d] > content->corner[1][d]) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* Where the rows of the snapshot come from: particle[k] is the local index of row k. */
static PetscErrorCode Choose(Output output, const ParticleArrays *arrays, PetscInt particle[], Rows *rows)
{
  PetscFunctionBegin;
  rows->n     = 0;
  rows->start = 0;
  for (PetscInt a = 0; a < arrays->n; a++)
    if (Wanted(output, arrays->integer[INT_LAYER][a], arrays->real[FIELD_POSITION] + DIM * a)) particle[rows->n++] = a;
  PetscCallMPI(MPI_Exscan(&rows->n, &rows->start, 1, MPIU_INT, MPI_SUM, output->comm));
  if (!output->rank) rows->start = 0;
  PetscCallMPI(MPI_Allreduce(&rows->n, &rows->total, 1, MPIU_INT, MPI_SUM, output->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteHead(Output output, const StepState *state, const SnapshotEntry *entry, Storage *storage)
{
  const Domain    domain = output->cloud->domain;
  const PetscReal h      = KernelSmoothingLength(output->cloud->kernel);

  PetscFunctionBegin;
  PetscCall(StoragePutText(storage, "format", "isph snapshot"));
  PetscCall(StoragePutText(storage, "version", ISPH_VERSION));
  PetscCall(StoragePutReal(storage, "time", 1, &state->time));
  PetscCall(StoragePutReal(storage, "time_step", 1, &state->time_step));
  PetscCall(StoragePutInt(storage, "step", state->step));
  PetscCall(StoragePutInt(storage, "particles", entry->n));
  PetscCall(StoragePutInt(storage, "precision", entry->precision));
  PetscCall(StoragePutInt(storage, "walls", output->content.walls));
  PetscCall(StoragePutInt(storage, "dimension", domain->dim));
  PetscCall(StoragePutReal(storage, "spacing", 1, &domain->spacing));
  PetscCall(StoragePutReal(storage, "smoothing_length", 1, &h));
  PetscCall(StoragePutReal(storage, "box_lower", DIM, domain->lower));
  PetscCall(StoragePutReal(storage, "box_upper", DIM, domain->upper));
  PetscCall(StoragePutReal(storage, "level", 1, &output->gauge.level));
  PetscCall(StoragePutText(storage, "options", output->options));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The values of a real field in the precision of the snapshots, or of an integer field, in values. */
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

    if (field.integer == INT_COUNT) {
      const PetscInt body = arrays->integer[INT_BODY][a];

      integer[k] = body < 0 ? -1 : BodyColor(SceneBody(output->cloud->scene, body));
    } else if (field.integer >= 0)
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
                                  Storage *storage)
{
  double *values;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(3 * rows->n + 1, &values));
  for (PetscInt f = 0; f < SNAPSHOT_FIELDS; f++) {
    const SnapshotField field = SnapshotFieldAt(f);
    const hid_t         real  = output->content.precise ? H5T_NATIVE_DOUBLE : H5T_NATIVE_FLOAT;

    if (!(output->content.fields & 1U << f)) continue;
    PetscCheck(field.width <= 3, output->comm, PETSC_ERR_PLIB, "Snapshots know fields of up to three numbers");
    rows->width = field.width;
    Pack(output, arrays, particle, rows->n, f, values);
    PetscCall(StorageWrite(storage, field.name, field.integer < 0 ? real : STORAGE_INT, rows, values, field.unit,
                           field.meaning));
  }
  PetscCall(PetscFree(values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Bytes a particle has in a snapshot. */
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
                              PetscInt64 *checkpoint)
{
  PetscInt       count[2] = {0, 0}; /* in a snapshot, all */
  PetscInt64     stored   = INT_COUNT * (PetscInt64)sizeof(PetscInt);
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(output->cloud->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++)
    count[0] += Wanted(output, arrays.integer[INT_LAYER][a], arrays.real[FIELD_POSITION] + DIM * a);
  count[1] = arrays.n;
  PetscCall(ParticlesClose(output->cloud->particles, &arrays));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, count, 2, MPIU_INT, MPI_SUM, output->comm));
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++) stored += Fields[f].width * (PetscInt64)sizeof(PetscReal);
  *bytes      = count[0] * ParticleBytes(output);
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
  Storage        storage;
  Rows           rows;
  PetscInt      *particle;
  PetscBool      failed;
  char           name[64], path[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_OUTPUT), 0, 0, 0, 0));
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
  PetscCall(PetscStrlcat(path, ".tmp", sizeof(path)));
  PetscCall(StorageCreate(output->comm, path, &storage));
  PetscCall(WriteHead(output, state, &entry, &storage));
  storage.compression = output->content.compression;
  PetscCall(WriteFields(output, &arrays, particle, &rows, &storage));
  PetscCall(VtkWrite(&storage, &entry));
  PetscCall(StorageClose(&storage, &failed));
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

PetscErrorCode SolidsWrite(Output output)
{
  Cloud     cloud = output->cloud;
  Rows      rows  = {.width = DIM};
  Storage   storage;
  PetscBool failed;
  double   *place, *normal;
  PetscInt *solid;
  char      path[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  if (!SceneSolidCount(cloud->scene)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc3(DIM * cloud->n_owned, &place, DIM * cloud->n_owned, &normal, cloud->n_owned, &solid));
  for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++) {
    const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a;
    PetscReal        n[DIM];

    if (cloud->integer[INT_BODY][a] > BODY_SOLID) continue;
    SceneSolidNormal(cloud->scene, x, n);
    for (PetscInt d = 0; d < DIM; d++) {
      place[DIM * rows.n + d]  = (double)x[d];
      normal[DIM * rows.n + d] = (double)n[d];
    }
    solid[rows.n++] = BODY_SOLID - cloud->integer[INT_BODY][a];
  }
  PetscCallMPI(MPI_Exscan(&rows.n, &rows.start, 1, MPIU_INT, MPI_SUM, output->comm));
  if (!output->rank) rows.start = 0;
  PetscCallMPI(MPI_Allreduce(&rows.n, &rows.total, 1, MPIU_INT, MPI_SUM, output->comm));
  PetscCall(OutputPath(output, SOLIDS_FILE ".tmp", path));
  PetscCall(StorageCreate(output->comm, path, &storage));
  PetscCall(StoragePutText(&storage, "format", "isph solids"));
  PetscCall(StorageWrite(&storage, "position", H5T_NATIVE_DOUBLE, &rows, place, "m", "dummy particles of solids"));
  PetscCall(StorageWrite(&storage, "normal", H5T_NATIVE_DOUBLE, &rows, normal, "1", "out of the solid"));
  rows.width = 1;
  PetscCall(StorageWrite(&storage, "solid", STORAGE_INT, &rows, solid, "1", "index of the solid in -solids"));
  PetscCall(StorageClose(&storage, &failed));
  PetscCall(PetscFree3(place, normal, solid));
  PetscCheckUser(!failed, output->comm, "Cannot write %s/%s: is the disk full, or the folder gone?", output->folder,
                 SOLIDS_FILE);
  PetscCall(FolderCommit(output, SOLIDS_FILE, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}
