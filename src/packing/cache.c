/* Finished packings on disk, one HDF5 file each, named after a hash of all that determines them. Rank 0 reads and
   writes. */
#include "packing_impl.h"
#include <hdf5.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#define CACHE_VERSION 1 /* raise it when the same options give another packing */
#define HASH_START    0xCBF29CE484222325ULL
#define HASH_PRIME    0x100000001B3ULL

/* FNV-1a, 64 bits */
static void HashBytes(unsigned long long *hash, const void *data, size_t size)
{
  const unsigned char *bytes = (const unsigned char *)data;

  for (size_t k = 0; k < size; k++) *hash = (*hash ^ bytes[k]) * HASH_PRIME;
}

static void HashReal(unsigned long long *hash, PetscReal value)
{
  const PetscReal number = value + 0.0; /* -0 and 0 alike */

  HashBytes(hash, &number, sizeof(number));
}

/* A shape, whatever its options are called: its signed distance on a lattice of about the spacing over its bounds. */
static void HashBody(unsigned long long *hash, Domain domain, Body body)
{
  PetscReal lower[DIM], upper[DIM];
  PetscInt  n[DIM];

  BodyBounds(body, lower, upper);
  for (PetscInt d = 0; d < DIM; d++) {
    n[d] = d < domain->dim ? (PetscInt)PetscCeilReal((upper[d] - lower[d]) / domain->spacing) + 1 : 1;
    HashReal(hash, lower[d]);
    HashReal(hash, upper[d]);
  }
  for (PetscInt c = 0; c < n[0] * n[1] * n[2]; c++) {
    const PetscInt at[DIM] = {c % n[0], (c / n[0]) % n[1], c / (n[0] * n[1])};
    PetscReal      x[DIM]  = {0, 0, 0};

    for (PetscInt d = 0; d < domain->dim; d++) x[d] = lower[d] + (at[d] + 0.5) * (upper[d] - lower[d]) / n[d];
    HashReal(hash, BodyDistance(body, x));
  }
}

PetscErrorCode PackingHash(Packing packing, PetscInt n, const PetscReal numbers[], unsigned long long *hash)
{
  const Domain domain = packing->cloud->domain;
  const Kernel kernel = packing->cloud->kernel;
  PetscReal    r2[2], W[2]; /* two values tell one kernel from another */

  PetscFunctionBegin;
  *hash = HASH_START;
  HashReal(hash, CACHE_VERSION);
  HashReal(hash, domain->dim);
  HashReal(hash, domain->spacing);
  for (PetscInt d = 0; d < DIM; d++) {
    HashReal(hash, domain->lower[d]);
    HashReal(hash, domain->upper[d]);
    for (PetscInt side = 0; side < 2; side++) HashReal(hash, domain->face[d][side]);
  }
  r2[0] = 0;
  r2[1] = PetscSqr(KernelSmoothingLength(kernel));
  KernelEvaluate(kernel, 2, r2, W, NULL);
  HashReal(hash, KernelSupport(kernel));
  HashReal(hash, W[0]);
  HashReal(hash, W[1]);
  HashBytes(hash, packing->type, strlen(packing->type));
  HashReal(hash, packing->seed);
  for (PetscInt k = 0; k < n; k++) HashReal(hash, numbers[k]);
  for (PetscInt b = 0; b < SceneCount(packing->cloud->scene); b++)
    HashBody(hash, domain, SceneBody(packing->cloud->scene, b));
  for (PetscInt b = 0; b < SceneSolidCount(packing->cloud->scene); b++)
    HashBody(hash, domain, SceneSolid(packing->cloud->scene, b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void HashText(unsigned long long *hash, const char text[])
{
  HashBytes(hash, text, strlen(text));
}

static unsigned long long Checksum(PetscInt n, const PetscReal x[], const PetscInt body[])
{
  unsigned long long sum = HASH_START;

  HashBytes(&sum, x, sizeof(*x) * DIM * (size_t)n);
  for (PetscInt a = 0; a < n; a++) HashReal(&sum, body[a]); /* of whatever width PetscInt is */
  return sum;
}

static PetscErrorCode FileName(const char folder[], unsigned long long hash, char name[PETSC_MAX_PATH_LEN])
{
  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(name, PETSC_MAX_PATH_LEN, "%s/packing_%016llx.h5", folder, hash));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads a data set of rank 1 or 2 whose first extent must be n (0: any, returned), the others multiplying to width. */
static PetscBool ReadSet(hid_t file, const char name[], hid_t type, hsize_t width, hsize_t *n, void **data)
{
  hid_t     set       = H5Dopen2(file, name, H5P_DEFAULT), space;
  hsize_t   extent[2] = {0, 1};
  PetscBool good      = PETSC_FALSE;

  *data = NULL;
  if (set < 0) return PETSC_FALSE;
  space = H5Dget_space(set);
  if (H5Sget_simple_extent_ndims(space) <= 2 && H5Sget_simple_extent_dims(space, extent, NULL) >= 1 &&
      extent[1] == width && extent[0] > 0 && (*n == 0 || *n == extent[0]) &&
      extent[0] <= (hsize_t)PETSC_MPI_INT_MAX / DIM) {
    *n   = extent[0];
    good = (PetscBool)(!PetscMalloc(extent[0] * width * H5Tget_size(type), data) &&
                       H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, *data) >= 0);
  }
  H5Sclose(space);
  H5Dclose(set);
  return good;
}

static PetscErrorCode ReadFile(const char name[], PetscInt *n, PetscReal **x, PetscInt **body)
{
  const hid_t         integer = sizeof(PetscInt) == 8 ? H5T_NATIVE_INT64 : H5T_NATIVE_INT32;
  hsize_t             count = 0, one = 1;
  unsigned long long *sum = NULL;
  hid_t               file;
  PetscBool           good;

  PetscFunctionBegin;
  *n    = 0;
  *x    = NULL;
  *body = NULL;
  if (access(name, R_OK)) PetscFunctionReturn(PETSC_SUCCESS);
  file = H5Fopen(name, H5F_ACC_RDONLY, H5P_DEFAULT);
  good = (PetscBool)(file >= 0 && ReadSet(file, "position", H5T_NATIVE_DOUBLE, DIM, &count, (void **)x) &&
                     ReadSet(file, "body", integer, 1, &count, (void **)body) &&
                     ReadSet(file, "checksum", H5T_NATIVE_ULLONG, 1, &one, (void **)&sum) &&
                     *sum == Checksum((PetscInt)count, *x, *body));
  if (file >= 0) H5Fclose(file);
  PetscCall(PetscFree(sum));
  if (good)
    *n = (PetscInt)count;
  else {
    PetscCall(PetscInfo(NULL, "packing: %s is not readable, it will be made again\n", name));
    PetscCall(PetscFree(*x));
    PetscCall(PetscFree(*body));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* HDF5 prints its errors unless told not to; what it printed with before is put back. */
typedef struct {
  H5E_auto2_t print;
  void       *data;
} Silence;

static void SilenceBegin(Silence *silence)
{
  H5Eget_auto2(H5E_DEFAULT, &silence->print, &silence->data);
  H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

static void SilenceEnd(const Silence *silence)
{
  H5Eset_auto2(H5E_DEFAULT, silence->print, silence->data);
}

PetscErrorCode CacheRead(MPI_Comm comm, const char folder[], unsigned long long hash, PetscInt *n, PetscReal **x,
                         PetscInt **body)
{
  char        name[PETSC_MAX_PATH_LEN];
  PetscMPIInt rank;
  Silence     silence;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(FileName(folder, hash, name));
  *n = 0;
  if (rank == 0) {
    SilenceBegin(&silence);
    PetscCall(ReadFile(name, n, x, body));
    SilenceEnd(&silence);
  }
  PetscCallMPI(MPI_Bcast(n, 1, MPIU_INT, 0, comm));
  if (*n == 0) PetscFunctionReturn(PETSC_SUCCESS);
  if (rank) {
    PetscCall(PetscMalloc1(DIM * *n, x));
    PetscCall(PetscMalloc1(*n, body));
  }
  PetscCallMPI(MPI_Bcast(*x, (PetscMPIInt)(DIM * *n), MPIU_REAL, 0, comm));
  PetscCallMPI(MPI_Bcast(*body, (PetscMPIInt)*n, MPIU_INT, 0, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- writing --- */

/* All fluid particles on rank 0, in the order of their ids: x [count][3], body [count]; NULL elsewhere. */
static PetscErrorCode Gather(Particles particles, MPI_Comm comm, PetscInt count, PetscReal **x, PetscInt **body)
{
  ParticleArrays arrays;
  PetscMPIInt    rank, size, own = 0, *counts = NULL, *starts = NULL;
  PetscReal     *packed, *all = NULL; /* [particles][5] id, body, position: reals hold ids exactly up to 2^53 */

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(ParticlesOpen(particles, &arrays));
  PetscCall(PetscMalloc1(5 * arrays.n, &packed));
  for (PetscInt a = 0; a < arrays.n; a++) {
    if (arrays.integer[INT_LAYER][a] > 0) continue;
    packed[own++] = arrays.integer[INT_ID][a];
    packed[own++] = arrays.integer[INT_BODY][a];
    for (PetscInt d = 0; d < DIM; d++) packed[own++] = arrays.real[FIELD_POSITION][DIM * a + d];
  }
  PetscCall(ParticlesClose(particles, &arrays));
  *x    = NULL;
  *body = NULL;
  if (rank == 0) {
    PetscCall(PetscMalloc3(size, &counts, size, &starts, 5 * count, &all));
    PetscCall(PetscCalloc1(DIM * count, x));
    PetscCall(PetscCalloc1(count, body));
  }
  PetscCallMPI(MPI_Gather(&own, 1, MPI_INT, counts, 1, MPI_INT, 0, comm));
  for (PetscMPIInt r = 0, sum = 0; rank == 0 && r < size; sum += counts[r++]) starts[r] = sum;
  PetscCallMPI(MPI_Gatherv(packed, own, MPIU_REAL, all, counts, starts, MPIU_REAL, 0, comm));
  for (PetscInt a = 0; rank == 0 && a < count; a++) {
    const PetscInt id = (PetscInt)all[5 * a];

    (*body)[id] = (PetscInt)all[5 * a + 1];
    PetscCall(PetscArraycpy(*x + DIM * id, all + 5 * a + 2, DIM));
  }
  if (rank == 0) PetscCall(PetscFree3(counts, starts, all));
  PetscCall(PetscFree(packed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool WriteSet(hid_t file, const char name[], hid_t type, int rank, const hsize_t extent[], const void *data)
{
  hid_t     space = H5Screate_simple(rank, extent, NULL);
  hid_t     set   = H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  PetscBool good  = (PetscBool)(set >= 0 && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0);

  if (set >= 0) H5Dclose(set);
  H5Sclose(space);
  return good;
}

/* Written beside its place and then moved there: nobody ever sees half a file. */
static PetscErrorCode WriteFile(const char folder[], const char name[], PetscInt n, const PetscReal x[],
                                const PetscInt body[])
{
  const hsize_t            extent[2] = {(hsize_t)n, DIM}, one = 1;
  const unsigned long long sum = Checksum(n, x, body);
  char                     part[PETSC_MAX_PATH_LEN + 32];
  PetscBool                good = PETSC_FALSE;
  hid_t                    file;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(part, sizeof(part), "%s.%ld.part", name, (long)getpid()));
  file = H5Fcreate(part, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  if (file >= 0) {
    good = (PetscBool)(WriteSet(file, "position", H5T_NATIVE_DOUBLE, 2, extent, x) &&
                       WriteSet(file, "body", sizeof(PetscInt) == 8 ? H5T_NATIVE_INT64 : H5T_NATIVE_INT32, 1, extent,
                                body) &&
                       WriteSet(file, "checksum", H5T_NATIVE_ULLONG, 1, &one, &sum));
    good = (PetscBool)(H5Fclose(file) >= 0 && good);
  }
  if (!good || rename(part, name)) {
    (void)remove(part);
    PetscCall(PetscInfo(NULL, "packing: cannot write into the folder %s; the packing is not kept\n", folder));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes the folder and those above it, as far as that works. */
static PetscErrorCode MakeFolder(const char folder[])
{
  char path[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(path, folder, sizeof(path)));
  for (char *end = path + 1; path[0]; end++) {
    const char kept = *end;

    if (kept != '/' && kept != '\0') continue;
    *end = '\0';
    (void)mkdir(path, 0777);
    *end = kept;
    if (kept == '\0') break;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CacheWrite(Particles particles, MPI_Comm comm, const char folder[], unsigned long long hash,
                          PetscInt count)
{
  char        name[PETSC_MAX_PATH_LEN];
  PetscMPIInt rank;
  PetscReal  *x;
  PetscInt   *body;
  Silence     silence;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(FileName(folder, hash, name));
  PetscCall(Gather(particles, comm, count, &x, &body));
  if (rank == 0) {
    SilenceBegin(&silence);
    PetscCall(MakeFolder(folder));
    PetscCall(WriteFile(folder, name, count, x, body));
    SilenceEnd(&silence);
  }
  PetscCall(PetscFree(x));
  PetscCall(PetscFree(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}
