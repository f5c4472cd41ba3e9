/* Columns of a run that is done, from its snapshots: -measure. */
#include "output_impl.h"
#include <stdlib.h>

/* The rows of a snapshot that belong to liquid, and those of solids that move, whose dummies find their places by id.
 */
typedef struct {
  H5File    h5;
  Rows      rows;
  PetscInt *body, *id;
  PetscInt  liquid, found; /* found: dummies */
} Snapshot;

/* What is kept of the particles: dummies, at the front of the swarm; then room for the liquid. */
static PetscErrorCode MakeRoom(Output output, PetscInt liquid, PetscInt *dummies)
{
  Particles      particles = output->cloud->particles;
  ParticleArrays arrays;
  PetscBool     *keep;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(particles, &arrays));
  PetscCall(PetscMalloc1(arrays.n + 1, &keep));
  for (PetscInt a = 0; a < arrays.n; a++) keep[a] = (PetscBool)(arrays.integer[INT_BODY][a] < 0);
  PetscCall(ParticlesClose(particles, &arrays));
  PetscCall(ParticlesRemove(particles, keep));
  PetscCall(PetscFree(keep));
  PetscCall(ParticlesGlobalSize(particles, dummies));
  PetscCall(ParticlesAppend(particles, liquid));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The local index [rows] of each row of the snapshot; -1: a dummy that this run does not have. */
static PetscErrorCode Places(Output output, Snapshot *snapshot, PetscInt dummies, PetscInt place[])
{
  ParticleArrays arrays;
  PetscInt      *id, *index, at, next = dummies;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(dummies + 1, &id, dummies + 1, &index));
  PetscCall(ParticlesOpen(output->cloud->particles, &arrays));
  for (PetscInt a = 0; a < dummies; a++) {
    id[a]    = arrays.integer[INT_ID][a];
    index[a] = a;
  }
  PetscCall(PetscSortIntWithArray(dummies, id, index));
  for (PetscInt k = 0; k < snapshot->rows.n; k++) {
    place[k] = -1;
    if (snapshot->body[k] >= 0) {
      place[k]                           = next++;
      arrays.integer[INT_BODY][place[k]] = snapshot->body[k];
      arrays.integer[INT_ID][place[k]] = arrays.integer[INT_PARENT][place[k]] = snapshot->id[k];
    } else {
      PetscCall(PetscFindInt(snapshot->id[k], dummies, id, &at));
      if (at < 0) continue;
      place[k] = index[at];
      snapshot->found++;
    }
  }
  PetscCall(ParticlesClose(output->cloud->particles, &arrays));
  PetscCall(PetscFree2(id, index));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadFields(Output output, Snapshot *snapshot, const PetscInt place[])
{
  ParticleArrays arrays;
  double        *values;
  PetscInt       widest = 1;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++) widest = PetscMax(widest, Fields[f].width);
  PetscCall(PetscMalloc1(widest * snapshot->rows.n + 1, &values));
  PetscCall(ParticlesOpen(output->cloud->particles, &arrays));
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++) {
    const PetscInt width = snapshot->rows.width = Fields[f].width;

    if (!arrays.real[f] || !H5FileHas(&snapshot->h5, Fields[f].name)) continue;
    PetscCall(H5FileRead(&snapshot->h5, Fields[f].name, H5T_NATIVE_DOUBLE, &snapshot->rows, values));
    for (PetscInt k = 0; k < snapshot->rows.n; k++)
      for (PetscInt c = 0; c < width && place[k] >= 0; c++)
        arrays.real[f][width * place[k] + c] = (PetscReal)values[width * k + c];
  }
  PetscCall(ParticlesClose(output->cloud->particles, &arrays));
  PetscCall(PetscFree(values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads the head of a snapshot and who its rows are. */
static PetscErrorCode ReadHead(Output output, const char path[], Snapshot *snapshot, StepState *state)
{
  static const FieldId needed[] = {FIELD_VELOCITY, FIELD_PRESSURE};
  PetscInt64           n = 0, step = 0;
  PetscReal            level = NAN;
  PetscBool            good;

  PetscFunctionBegin;
  PetscCall(H5FileOpen(output->comm, path, &snapshot->h5));
  good = (PetscBool)(H5FileGetReal(&snapshot->h5, "time", &state->time) &&
                     H5FileGetReal(&snapshot->h5, "time_step", &state->time_step) &&
                     H5FileGetInt(&snapshot->h5, "step", &step) && H5FileGetInt(&snapshot->h5, "particles", &n) &&
                     H5FileHolds(&snapshot->h5, n, 2 * sizeof(int32_t)));
  PetscCheckUser(good, output->comm, "%s is not a complete snapshot of a run", path);
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(needed); k++)
    PetscCheckUser(H5FileHas(&snapshot->h5, Fields[needed[k]].name), output->comm,
                   "%s has no %s, which -measure needs: -snapshot_fields of the run left it out", path,
                   Fields[needed[k]].name);
  (void)H5FileGetReal(&snapshot->h5, "level", &level);
  if (!H5FileGetReal(&snapshot->h5, "pressure_time", &state->pressure_time)) state->pressure_time = NAN;
  if (!PetscIsInfOrNanReal(level)) GaugesSetLevel(output->gauges, level);
  state->step    = (PetscInt)step;
  snapshot->rows = (Rows){.n = (PetscInt)n, .total = (PetscInt)n, .width = 1};
  PetscCall(PetscMalloc2(n + 1, &snapshot->body, n + 1, &snapshot->id));
  PetscCall(H5FileRead(&snapshot->h5, IntFieldNames[INT_BODY], H5FILE_INT, &snapshot->rows, snapshot->body));
  PetscCall(H5FileRead(&snapshot->h5, IntFieldNames[INT_ID], H5FILE_INT, &snapshot->rows, snapshot->id));
  for (PetscInt k = 0; k < snapshot->rows.n; k++) snapshot->liquid += snapshot->body[k] >= 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputSnapshots(Output output, const char folder[], PetscInt *count, PetscInt **numbers)
{
  PetscFunctionBegin;
  PetscCall(FolderNumbers(folder, "snapshot_", count, numbers));
  PetscCheckUser(*count > 0, output->comm, "the folder %s has no snapshot_<number>.h5 to measure", folder);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputReadSnapshot(Output output, const char folder[], PetscInt number, StepState *state)
{
  Snapshot  snapshot = {.liquid = 0};
  char      name[64], path[PETSC_MAX_PATH_LEN];
  PetscInt  dummies, *place;
  PetscBool failed;

  PetscFunctionBegin;
  SnapshotName(number, name);
  PetscCall(PetscSNPrintf(path, sizeof(path), "%s/%s", folder, name));
  PetscCall(ReadHead(output, path, &snapshot, state));
  PetscCall(PetscMalloc1(snapshot.rows.n + 1, &place));
  PetscCall(MakeRoom(output, snapshot.liquid, &dummies));
  PetscCall(Places(output, &snapshot, dummies, place));
  PetscCall(ReadFields(output, &snapshot, place));
  output->pressed = (PetscBool)(snapshot.found == dummies);
  PetscCall(H5FileClose(&snapshot.h5, &failed));
  PetscCheckUser(!failed, output->comm, "%s is damaged: it cannot be read", path);
  PetscCall(PetscFree2(snapshot.body, snapshot.id));
  PetscCall(PetscFree(place));
  PetscFunctionReturn(PETSC_SUCCESS);
}
