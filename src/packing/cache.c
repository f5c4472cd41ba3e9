/* Finished packings on disk, one HDF5 file each, named after a hash of all that determines them. */
#include "../storage/storage.h"
#include "packing_impl.h"
#include <ctype.h>
#include <stdlib.h>
#include <unistd.h>

#define STRAY         2 /* spacings: a negative -wall_guard lets liquid one spacing behind a wall */
#define CACHE_VERSION 5 /* raise it when the same options give another packing, or when the files change */

/* Adds the options of TAO, which PETSc reads: names and values as given. */
static PetscErrorCode AddTao(unsigned long long *hash)
{
  const char prefix[] = "-packing_tao_";
  char      *all, **word;
  int        words;
  PetscBool  ours = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetAll(NULL, &all));
  PetscCall(PetscStrToArray(all, ' ', &words, &word));
  for (int k = 0; k < words; k++) {
    if (word[k][0] == '-' && isalpha((unsigned char)word[k][1]))
      ours = (PetscBool)(strncmp(word[k], prefix, sizeof(prefix) - 1) == 0);
    if (ours) *hash = HashBytes(*hash, word[k], strlen(word[k]) + 1);
  }
  PetscCall(PetscStrToArrayDestroy(words, word));
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PackingHash(Packing packing, const char how[], unsigned long long *hash)
{
  const PetscInt key[] = {CACHE_VERSION, packing->seed};
  char          *text;

  PetscFunctionBegin;
  PetscCall(CloudIdentity(packing->cloud, &text));
  *hash = HashBytes(HASH_START, key, sizeof(key));
  *hash = HashBytes(*hash, packing->type, strlen(packing->type) + 1);
  *hash = HashBytes(*hash, text, strlen(text) + 1);
  *hash = HashBytes(*hash, how, strlen(how) + 1);
  free(text);
  for (PetscInt k = 0; k < packing->graded_count[0]; k++) { /* they depend on -fine and the growth of the spacing */
    const Sample *sample = &packing->graded[0][k];

    *hash = HashBytes(*hash, sample->x, sizeof(sample->x));
    *hash = HashBytes(*hash, &sample->area, sizeof(sample->area));
  }
  PetscCall(AddTao(hash));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FileName(const char folder[], unsigned long long hash, char name[PETSC_MAX_PATH_LEN])
{
  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(name, PETSC_MAX_PATH_LEN, "%s/packing_%016llx.h5", folder, hash));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the contents are a packing of the scene: each id once, particles of every body that is liquid from the start
   and of no other, positions in the box. A relaxation may have moved particles out by the slack of the ghosts, or
   behind a wall. */
static PetscBool Sound(Cloud cloud, PetscInt n, const PetscInt id[], const PetscInt body[], const PetscReal x[],
                       PetscBool seen[])
{
  const Domain    domain                   = cloud->domain;
  const PetscReal margin                   = cloud->slack + STRAY * domain->spacing_coarse;
  PetscBool       filled[SCENE_MAX_BODIES] = {PETSC_FALSE};

  for (PetscInt k = 0; k < n; k++) {
    if (id[k] < 0 || id[k] >= n || seen[id[k]] || body[k] < 0 || body[k] >= SceneCount(cloud->scene))
      return PETSC_FALSE;
    seen[id[k]]     = PETSC_TRUE;
    filled[body[k]] = PETSC_TRUE;
    for (PetscInt d = 0; d < DIM; d++) {
      const PetscReal coordinate = x[DIM * k + d];

      if (d < domain->dim ? !(coordinate >= domain->lower[d] - margin && coordinate <= domain->upper[d] + margin)
                          : coordinate != 0)
        return PETSC_FALSE;
    }
  }
  for (PetscInt b = 0; b < SceneCount(cloud->scene); b++)
    if (filled[b] == BodyComesLater(SceneBody(cloud->scene, b))) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* Reads all n particles of the file, which has them in any order, and sorts them by id. *good: this worked on every
   rank. Collective. */
static PetscErrorCode ReadParticles(Cloud cloud, H5File *h5, PetscInt n, PetscReal x[], PetscInt body[],
                                    PetscBool *good)
{
  Rows       rows = {.n = n, .start = 0, .total = n, .width = 1};
  PetscInt  *id, *body_read;
  PetscReal *x_read;
  PetscBool *seen, failed;

  PetscFunctionBegin;
  PetscCall(PetscCalloc4(n, &id, n, &body_read, DIM * n, &x_read, n, &seen));
  PetscCall(H5FileRead(h5, "id", H5FILE_INT, &rows, id));
  PetscCall(H5FileRead(h5, "body", H5FILE_INT, &rows, body_read));
  rows.width = DIM;
  PetscCall(H5FileRead(h5, "position", H5T_NATIVE_DOUBLE, &rows, x_read));
  h5->failed = (PetscBool)(h5->failed || !Sound(cloud, n, id, body_read, x_read, seen));
  PetscCall(H5FileClose(h5, &failed));
  *good = (PetscBool)!failed;
  for (PetscInt k = 0; k < n && *good; k++) {
    body[id[k]] = body_read[k];
    PetscCall(PetscArraycpy(x + DIM * id[k], x_read + DIM * k, DIM));
  }
  PetscCall(PetscFree4(id, body_read, x_read, seen));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CacheRead(Cloud cloud, const char folder[], unsigned long long hash, PetscInt *n, PetscReal **x,
                         PetscInt **body)
{
  const size_t row = 2 * sizeof(int32_t) + DIM * sizeof(PetscReal); /* bytes of a particle */
  char         name[PETSC_MAX_PATH_LEN];
  H5File       h5;
  Seal         seal;
  PetscInt64   count = 0;
  PetscBool    good  = PETSC_FALSE;

  PetscFunctionBegin;
  *n = 0;
  PetscCall(FileName(folder, hash, name));
  PetscCall(FileCheckSeal(cloud->comm, name, &seal));
  if (seal == SEAL_NONE) PetscFunctionReturn(PETSC_SUCCESS);
  if (seal == SEAL_GOOD) {
    PetscCall(H5FileOpen(cloud->comm, name, &h5));
    (void)H5FileGetInt(&h5, "particles", &count);
    if (count > PETSC_MAX_INT || !H5FileHolds(&h5, count, row)) count = 0;
    PetscCall(PetscMalloc1(DIM * count, x));
    PetscCall(PetscMalloc1(count, body));
    PetscCall(ReadParticles(cloud, &h5, (PetscInt)count, *x, *body, &good));
    if (good) {
      *n = (PetscInt)count;
      PetscFunctionReturn(PETSC_SUCCESS);
    }
    PetscCall(PetscFree(*x));
    PetscCall(PetscFree(*body));
  }
  PetscCall(PetscInfo(NULL, "packing: %s is damaged; the packing is made again\n", name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The fluid particles of this rank: x [own][3], body [own] and id [own], to be freed with PetscFree3. */
static PetscErrorCode CollectFluid(Particles particles, PetscInt *own, PetscReal **x, PetscInt **body, PetscInt **id)
{
  ParticleArrays arrays;
  PetscInt       n = 0;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(particles, &arrays));
  PetscCall(PetscMalloc3(DIM * arrays.n, x, arrays.n, body, arrays.n, id));
  for (PetscInt a = 0; a < arrays.n; a++) {
    if (arrays.integer[INT_LAYER][a] > 0) continue;
    PetscCall(PetscArraycpy(*x + DIM * n, arrays.real[FIELD_POSITION] + DIM * a, DIM));
    (*body)[n] = arrays.integer[INT_BODY][a];
    (*id)[n++] = arrays.integer[INT_ID][a];
  }
  PetscCall(ParticlesClose(particles, &arrays));
  *own = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CacheWrite(Particles particles, MPI_Comm comm, const char folder[], unsigned long long hash,
                          PetscInt count)
{
  char        name[PETSC_MAX_PATH_LEN], part[PETSC_MAX_PATH_LEN + 32];
  PetscMPIInt rank;
  long        process = (long)getpid();
  Rows        rows;
  H5File      h5;
  PetscReal  *x;
  PetscInt   *body, *id, n = 0;
  PetscBool   failed;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Bcast(&process, 1, MPI_LONG, 0, comm));
  PetscCall(FileName(folder, hash, name));
  PetscCall(PetscSNPrintf(part, sizeof(part), "%s.%ld.part", name, process)); /* so that nobody reads half a file */
  if (!rank) (void)FolderCreate(folder);
  PetscCall(CollectFluid(particles, &n, &x, &body, &id));
  PetscCall(RowsSet(comm, n, 1, &rows));
  PetscCall(H5FileCreate(comm, part, &h5));
  h5.failed = (PetscBool)(h5.failed || rows.total != count); /* with the liquid of an emitter: not a packing */
  H5FilePutInt(&h5, "particles", count);
  PetscCall(H5FileWrite(&h5, "id", H5FILE_INT, &rows, id, "1", "identity, 0, 1, ..."));
  PetscCall(H5FileWrite(&h5, "body", H5FILE_INT, &rows, body, "1", "index of the body in -bodies"));
  rows.width = DIM;
  PetscCall(H5FileWrite(&h5, "position", H5T_NATIVE_DOUBLE, &rows, x, "m", "position"));
  PetscCall(H5FileClose(&h5, &failed));
  if (!failed) PetscCall(FileSeal(comm, part, &failed));
  if (!rank && (failed || rename(part, name))) {
    (void)remove(part);
    PetscCall(PetscInfo(NULL, "packing: not kept in the folder %s\n", folder));
  }
  PetscCall(PetscFree3(x, body, id));
  PetscFunctionReturn(PETSC_SUCCESS);
}
