/* HDF5 files. Rank 0 makes the structure of a file; HDF5 says where the rows of a data set lie, and each rank writes
   its own there. Of compressed rows each rank compresses its own, and rank 0 writes them. On a full disk HDF5 over
   MPI-IO would wait for ever, and serial HDF5 1.10 would crash in closing the file, so the disk's space is reserved
   before HDF5 needs it. Every rank reads its own rows. */
#define _GNU_SOURCE /* pwrite, posix_fallocate */
#include "storage.h"
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#define TEXT_MAX   60000              /* bytes of a text attribute; HDF5's limit is 64 KB */
#define ROWS_TAG   1                  /* of the messages that bring rows */
#define STRUCTURE  ((hsize_t)1 << 18) /* bytes that HDF5 may need for attributes and the structure of the file */
#define DEFLATE    1.01      /* most bytes of a compressed data set, over those of its rows: zlib adds 0.03 % */
#define CHUNK_ROWS (1 << 14) /* of a compressed data set: a chunk of vectors is a third of HDF5's cache */

PetscErrorCode RowsSet(MPI_Comm comm, PetscInt n, PetscInt width, Rows *rows)
{
  PetscFunctionBegin;
  PetscCallMPI(MPI_Scan(&n, &rows->start, 1, MPIU_INT, MPI_SUM, comm));
  PetscCallMPI(MPI_Allreduce(&n, &rows->total, 1, MPIU_INT, MPI_SUM, comm));
  rows->start -= n;
  rows->n     = n;
  rows->width = width;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether ok_here is true on all ranks. */
static PetscErrorCode AllAgree(H5File *h5, PetscBool ok_here, PetscBool *everywhere)
{
  PetscMPIInt ok = ok_here ? 1 : 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &ok, 1, MPI_INT, MPI_MIN, h5->comm));
  *everywhere = ok ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rank 0 makes sure that the disk has room for so many bytes of rows, and for what HDF5 adds. */
static void Reserve(H5File *h5, hsize_t bytes)
{
  hsize_t length = 0;

  if (h5->id < 0 || h5->file < 0 || h5->failed) return;
  if (H5Fget_filesize(h5->id, &length) < 0) h5->failed = PETSC_TRUE;
  length += bytes + STRUCTURE;
  if (length > h5->reserved && posix_fallocate(h5->file, (off_t)h5->reserved, (off_t)(length - h5->reserved)))
    h5->failed = PETSC_TRUE;
  else
    h5->reserved = PetscMax(h5->reserved, length);
}

/* HDF5 1.10 crashes in closing what it cannot write, which a limit may forbid in spite of the room, and so it would at
   the end of the program, when it closes all that is open: here before main, and so before MPI, since what HDF5 plans
   for the end depends on the time of its first call. */
__attribute__((constructor)) static void CloseNothing(void)
{
  (void)H5dont_atexit();
  (void)H5open();
}

/* HDF5 writes what it still has; false: it cannot, and the file stays open for ever. */
static PetscBool Settle(H5File *h5)
{
  if (h5->id < 0 || H5Fflush(h5->id, H5F_SCOPE_LOCAL) >= 0) return PETSC_TRUE;
  h5->failed = PETSC_TRUE;
  h5->id     = -1;
  return PETSC_FALSE;
}

static void LetClose(H5File *h5, PetscBool writing)
{
  if (writing && !Settle(h5)) return;
  if (h5->id >= 0 && H5Fclose(h5->id) < 0) h5->failed = PETSC_TRUE;
  h5->id = -1;
}

/* Opens or creates the file on the ranks that own it. */
static PetscErrorCode OpenOrCreate(MPI_Comm comm, const char path[], PetscBool writing, H5File *h5)
{
  hid_t     access;
  PetscBool all;

  PetscFunctionBegin;
  h5->comm        = comm;
  h5->failed      = PETSC_FALSE;
  h5->external    = PETSC_FALSE;
  h5->length      = 0;
  h5->id          = -1;
  h5->file        = -1;
  h5->reserved    = 0;
  h5->compression = 0;
  PetscCallMPI(MPI_Comm_rank(comm, &h5->rank));
  PetscCallMPI(MPI_Comm_size(comm, &h5->size));
  h5->owns_file = (PetscBool)(!writing || !h5->rank);
  (void)H5Eget_auto2(H5E_DEFAULT, &h5->handler, &h5->client);
  (void)H5Eset_auto2(H5E_DEFAULT, NULL, NULL); /* the caller reports errors in one sentence */
  if (h5->owns_file) {
    access = H5Pcreate(H5P_FILE_ACCESS);
    (void)H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_LATEST); /* checksums of metadata */
#if H5_VERSION_GE(1, 10, 7)
    if (writing) (void)H5Pset_file_locking(access, PETSC_FALSE, PETSC_TRUE); /* the run's folder has its own lock */
#endif
    h5->id = writing ? H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, access) : H5Fopen(path, H5F_ACC_RDONLY, access);
    (void)H5Pclose(access);
    if (!writing && h5->id >= 0 && H5Fget_filesize(h5->id, &h5->length) < 0) h5->length = 0;
  }
  PetscCall(AllAgree(h5, (PetscBool)(!h5->owns_file || h5->id >= 0), &all));
  if (all && writing) {
    h5->file = open(path, O_WRONLY | O_CLOEXEC);
    if (h5->file < 0) h5->failed = PETSC_TRUE;
    Reserve(h5, 0);
    PetscCall(AllAgree(h5, (PetscBool)!h5->failed, &all));
  }
  if (!all) {
    LetClose(h5, writing);
    h5->failed = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode H5FileCreate(MPI_Comm comm, const char path[], H5File *h5)
{
  PetscFunctionBegin;
  PetscCall(OpenOrCreate(comm, path, PETSC_TRUE, h5));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode H5FileOpen(MPI_Comm comm, const char path[], H5File *h5)
{
  PetscFunctionBegin;
  PetscCall(OpenOrCreate(comm, path, PETSC_FALSE, h5));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Cuts off what is reserved behind the end of a file that is closed; end 0: nothing. HDF5 does so only where it has not
   written the last bytes itself. */
static PetscBool CutReserved(int file, off_t end)
{
  struct stat info;

  return (PetscBool)(end == 0 || (!fstat(file, &info) && (info.st_size <= end || !ftruncate(file, end))));
}

PetscErrorCode H5FileClose(H5File *h5, PetscBool *failed)
{
  PetscBool       all;
  const PetscBool writing = (PetscBool)(h5->file >= 0);
  haddr_t         end     = 0;

  PetscFunctionBegin;
  PetscCall(AllAgree(h5, (PetscBool)!h5->failed, &all)); /* all rows are written */
  if (all && writing && h5->id >= 0 && Settle(h5) && H5Fget_eoa(h5->id, &end) < 0) h5->failed = PETSC_TRUE;
  LetClose(h5, writing);
  if (writing && !CutReserved(h5->file, (off_t)end)) h5->failed = PETSC_TRUE;
  if (writing && close(h5->file)) h5->failed = PETSC_TRUE;
  h5->file = -1;
  (void)H5Eset_auto2(H5E_DEFAULT, h5->handler, h5->client);
  PetscCall(AllAgree(h5, (PetscBool)(all && !h5->failed), &all));
  *failed = (PetscBool)!all;
  PetscFunctionReturn(PETSC_SUCCESS);
}

void H5FileNote(H5File *h5, hid_t status)
{
  if (status < 0) h5->failed = PETSC_TRUE;
}

void H5FilePutAttribute(H5File *h5, hid_t object, const char name[], hid_t file_type, hid_t type, hsize_t n,
                        const void *values)
{
  hid_t space, attribute;

  if (!h5->owns_file) return;
  space     = n == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &n, NULL);
  attribute = object < 0 ? -1 : H5Acreate2(object, name, file_type, space, H5P_DEFAULT, H5P_DEFAULT);
  if (attribute < 0)
    h5->failed = PETSC_TRUE;
  else {
    H5FileNote(h5, H5Awrite(attribute, type, values));
    H5FileNote(h5, H5Aclose(attribute));
  }
  (void)H5Sclose(space);
}

static void AttributePutText(H5File *h5, hid_t object, const char name[], const char text[])
{
  const size_t length = PetscMin(strlen(text), (size_t)TEXT_MAX);
  const hid_t  type   = H5Tcopy(H5T_C_S1);

  (void)H5Tset_size(type, PetscMax(length, 1));
  (void)H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5FilePutAttribute(h5, object, name, type, type, 1, length ? text : "\0");
  (void)H5Tclose(type);
}

/* Data spaces: of the data set, with rows start to start + n - 1 selected, and of these rows in memory. */
static void SelectRows(const Rows *rows, PetscInt start, PetscInt n, hid_t *file, hid_t *memory)
{
  const hsize_t total[2] = {(hsize_t)rows->total, (hsize_t)rows->width}, count[2] = {(hsize_t)n, (hsize_t)rows->width};
  const hsize_t first[2] = {(hsize_t)start, 0};
  const int     rank     = rows->width > 1 ? 2 : 1;

  *file   = H5Screate_simple(rank, total, NULL);
  *memory = H5Screate_simple(rank, count, NULL);
  if (n)
    (void)H5Sselect_hyperslab(*file, H5S_SELECT_SET, first, NULL, count, NULL);
  else {
    (void)H5Sselect_none(*file);
    (void)H5Sselect_none(*memory);
  }
}

/* HDF5's shuffle of a chunk (the first bytes of all its numbers, then the second ones, ...) and deflate. Returns the
   number of bytes, 0 if zlib fails. */
static uLong Deflate(H5File *h5, size_t number, size_t bytes, const Bytef *raw, Bytef *shuffled, Bytef *packed)
{
  const size_t count  = bytes / number;
  uLong        length = compressBound(bytes);

  for (size_t b = 0; b < number; b++)
    for (size_t k = 0; k < count; k++) shuffled[b * count + k] = raw[number * k + b];
  return compress2(packed, &length, shuffled, bytes, (int)h5->compression) == Z_OK ? length : 0;
}

/* The rows of a compressed data set lie in chunks of so many rows. A chunk belongs to the rank with its first row,
   which gets its other rows from the ranks behind. */
typedef struct {
  PetscInt    rows, first, last; /* of a chunk; the chunks of this rank, first to last - 1 */
  PetscInt    n;                 /* rows from the ranks behind */
  PetscInt   *start;             /* [ranks + 1] first row of each rank, and the end */
  const char *own;
  char       *behind;
} Chunks;

static PetscInt ChunksBefore(const Chunks *chunks, PetscInt row)
{
  return row / chunks->rows + (row % chunks->rows > 0); /* no sum beyond the last integer */
}

static PetscErrorCode ChunksCreate(H5File *h5, const Rows *rows, PetscInt count, size_t size, MPI_Datatype row,
                                   const void *values, Chunks *chunks)
{
  const PetscMPIInt me = h5->rank;
  PetscInt         *start, lead, end;
  PetscMPIInt       owner   = me;
  MPI_Request       request = MPI_REQUEST_NULL;

  PetscFunctionBegin;
  *chunks = (Chunks){.rows = count, .own = (const char *)values};
  PetscCall(PetscMalloc1(h5->size + 1, &chunks->start));
  start           = chunks->start;
  start[h5->size] = rows->total;
  PetscCallMPI(MPI_Allgather(&rows->start, 1, MPIU_INT, start, 1, MPIU_INT, h5->comm));
  chunks->first = ChunksBefore(chunks, start[me]);
  chunks->last  = ChunksBefore(chunks, start[me + 1]);
  lead          = (PetscInt)PetscMin(rows->n, (PetscInt64)chunks->first * count - start[me]);
  while (lead && start[owner] > (chunks->first - 1) * count) owner--;
  if (lead) PetscCallMPI(MPI_Isend(values, (PetscMPIInt)lead, row, owner, ROWS_TAG, h5->comm, &request));
  end =
    chunks->last > chunks->first ? (PetscInt)PetscMin((PetscInt64)chunks->last * count, rows->total) : start[me + 1];
  chunks->n = end - start[me + 1];
  PetscCall(PetscMalloc1(size * (size_t)chunks->n, &chunks->behind));
  for (PetscMPIInt r = me + 1; r < h5->size && start[r] < end; r++)
    if (start[r + 1] > start[r])
      PetscCallMPI(MPI_Recv(chunks->behind + size * (size_t)(start[r] - start[me + 1]),
                            (PetscMPIInt)(PetscMin(start[r + 1], end) - start[r]), row, r, ROWS_TAG, h5->comm,
                            MPI_STATUS_IGNORE));
  PetscCallMPI(MPI_Wait(&request, MPI_STATUS_IGNORE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The bytes of chunk k of this rank; zeros behind the last row. */
static void ChunkGet(const Chunks *chunks, const Rows *rows, PetscInt k, size_t size, Bytef *raw)
{
  const PetscInt at = k * chunks->rows - rows->start, own = PetscMin(chunks->rows, rows->n - at),
                 behind = PetscMin(chunks->rows - own, chunks->n);

  (void)memset(raw, 0, size * (size_t)chunks->rows);
  (void)memcpy(raw, chunks->own + size * (size_t)at, size * (size_t)own);
  if (behind) (void)memcpy(raw + size * (size_t)own, chunks->behind, size * (size_t)behind);
}

static void WriteChunk(H5File *h5, hid_t set, PetscInt row, size_t bytes, const void *packed)
{
  const hsize_t at[2] = {(hsize_t)row, 0};

  if (set >= 0 && !h5->failed) H5FileNote(h5, bytes ? H5Dwrite_chunk(set, H5P_DEFAULT, 0, at, bytes, packed) : -1);
}

/* Each rank compresses its chunks; rank 0 writes those of all, one rank after the other. It receives every message even
   after a failure, so no rank waits. */
static PetscErrorCode DeflateRows(H5File *h5, hid_t set, hid_t type, const Rows *rows, PetscInt count,
                                  const void *values)
{
  const size_t size = H5Tget_size(type) * (size_t)rows->width, bytes = size * (size_t)count;
  const size_t most = compressBound(bytes);
  Bytef       *raw, *shuffled, *packed;
  size_t       used = 0, *length;
  Chunks       chunks;
  MPI_Datatype row;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Type_contiguous((int)size, MPI_BYTE, &row));
  PetscCallMPI(MPI_Type_commit(&row));
  PetscCall(ChunksCreate(h5, rows, count, size, row, values, &chunks));
  PetscCall(PetscMalloc4(bytes, &raw, bytes, &shuffled, most * (size_t)(chunks.last - chunks.first + 1), &packed,
                         chunks.last - chunks.first, &length));
  for (PetscInt k = chunks.first; k < chunks.last; k++) {
    ChunkGet(&chunks, rows, k, size, raw);
    length[k - chunks.first] = Deflate(h5, H5Tget_size(type), bytes, raw, shuffled, packed + used);
    used += length[k - chunks.first];
    InterruptAlive(NULL);
  }
  used = 0;
  for (PetscInt k = chunks.first; k < chunks.last; used += length[k++ - chunks.first]) {
    const size_t n = length[k - chunks.first];

    if (h5->rank)
      PetscCallMPI(MPI_Ssend(packed + used, (PetscMPIInt)n, MPI_BYTE, 0, ROWS_TAG, h5->comm));
    else
      WriteChunk(h5, set, k * count, n, packed + used);
  }
  for (PetscMPIInt r = 1; r < h5->size && !h5->rank; r++)
    for (PetscInt k = ChunksBefore(&chunks, chunks.start[r]); k < ChunksBefore(&chunks, chunks.start[r + 1]); k++) {
      MPI_Status  status;
      PetscMPIInt n;

      PetscCallMPI(MPI_Recv(packed, (PetscMPIInt)most, MPI_BYTE, r, ROWS_TAG, h5->comm, &status));
      PetscCallMPI(MPI_Get_count(&status, MPI_BYTE, &n));
      WriteChunk(h5, set, k * count, (size_t)n, packed);
      InterruptAlive(NULL);
    }
  PetscCall(PetscFree4(raw, shuffled, packed, length));
  PetscCall(PetscFree(chunks.behind));
  PetscCall(PetscFree(chunks.start));
  PetscCallMPI(MPI_Type_free(&row));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Each rank writes its rows where HDF5 has room for them. */
static PetscErrorCode PlaceRows(H5File *h5, hid_t set, hid_t type, const Rows *rows, const void *values)
{
  const size_t size = H5Tget_size(type) * (size_t)rows->width, bytes = size * (size_t)rows->n;
  PetscInt64   place = set < 0 || h5->failed ? -1 : (PetscInt64)H5Dget_offset(set);

  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(&place, 1, MPIU_INT64, 0, h5->comm));
  if (place < 0) h5->failed = PETSC_TRUE; /* HADDR_UNDEF is negative here */
  place += (PetscInt64)(size * (size_t)rows->start);
  for (size_t done = 0; done < bytes && !h5->failed;) {
    const ssize_t n = pwrite(h5->file, (const char *)values + done, PetscMin(bytes - done, (size_t)1 << 30),
                             (off_t)(place + (PetscInt64)done));

    if (n <= 0) h5->failed = PETSC_TRUE;
    done += n > 0 ? (size_t)n : 0;
    InterruptAlive(NULL);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode H5FileWrite(H5File *h5, const char name[], hid_t type, const Rows *rows, const void *values,
                           const char unit[], const char meaning[])
{
  const hsize_t  bytes = H5Tget_size(type) * (hsize_t)rows->width * (hsize_t)rows->total;
  const PetscInt chunk = PetscMin(rows->total, CHUNK_ROWS);
  hid_t          file, memory, create, set = -1;

  PetscFunctionBegin;
  Reserve(h5, (hsize_t)(DEFLATE * (double)bytes));
  if (h5->owns_file && h5->id >= 0 && !h5->failed) {
    SelectRows(rows, 0, 0, &file, &memory);
    create = H5Pcreate(H5P_DATASET_CREATE);
    (void)H5Pset_fill_time(create, H5D_FILL_TIME_NEVER);
    if (!h5->compression) (void)H5Pset_alloc_time(create, H5D_ALLOC_TIME_EARLY);
    if (h5->compression && chunk) {
      const hsize_t shape[2] = {(hsize_t)chunk, (hsize_t)rows->width};

      H5FileNote(h5, H5Pset_chunk(create, rows->width > 1 ? 2 : 1, shape));
      H5FileNote(h5, H5Pset_shuffle(create));
      H5FileNote(h5, H5Pset_deflate(create, (unsigned)h5->compression));
    }
    set = H5Dcreate2(h5->id, name, type, file, H5P_DEFAULT, create, H5P_DEFAULT);
    (void)H5Pclose(create);
    (void)H5Sclose(memory);
    (void)H5Sclose(file);
    H5FileNote(h5, set < 0 ? -1 : 0);
    AttributePutText(h5, set, "unit", unit);
    AttributePutText(h5, set, "meaning", meaning);
  }
  if (chunk && h5->compression)
    PetscCall(DeflateRows(h5, set, type, rows, chunk, values));
  else if (chunk)
    PetscCall(PlaceRows(h5, set, type, rows, values));
  if (set >= 0 && Settle(h5)) H5FileNote(h5, H5Dclose(set));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a data set is stored in this file: in one piece, or in chunks as H5FileWrite makes. */
static PetscBool StoredInFile(hid_t set)
{
  const hid_t        create   = H5Dget_create_plist(set);
  const H5D_layout_t layout   = H5Pget_layout(create);
  hsize_t            chunk[2] = {0, 0};
  PetscBool          inside   = (PetscBool)(layout == H5D_CONTIGUOUS && H5Pget_external_count(create) == 0);

  if (layout == H5D_CHUNKED) inside = (PetscBool)(H5Pget_chunk(create, 2, chunk) > 0 && chunk[0] <= CHUNK_ROWS);
  (void)H5Pclose(create);
  return inside;
}

/* Opens a data set that is stored in this file; negative if there is none. *external: it is stored elsewhere. */
static hid_t OpenSet(H5File *h5, const char name[], PetscBool *external)
{
  H5L_info_t link;
  hid_t      set = -1;

  if (h5->id < 0 || H5Lget_info(h5->id, name, &link, H5P_DEFAULT) < 0) return -1;
  *external = (PetscBool)(link.type != H5L_TYPE_HARD);
  if (!*external) set = H5Dopen2(h5->id, name, H5P_DEFAULT);
  if (set >= 0 && !StoredInFile(set)) {
    *external = PETSC_TRUE;
    (void)H5Dclose(set);
    set = -1;
  }
  return set;
}

/* Whether a data set has the shape of 'rows' and the class of 'type' (real or integer). */
static PetscBool HasShape(hid_t set, hid_t type, const Rows *rows)
{
  const hid_t       space = H5Dget_space(set), stored = H5Dget_type(set);
  const int         rank    = H5Sget_simple_extent_ndims(space);
  const H5T_class_t kind    = H5Tget_class(stored);
  hsize_t           size[2] = {0, 1};
  PetscBool         same;

  if (rank == 1 || rank == 2) (void)H5Sget_simple_extent_dims(space, size, NULL);
  same = (PetscBool)(rank == (rows->width > 1 ? 2 : 1) && size[0] == (hsize_t)rows->total &&
                     size[1] == (hsize_t)rows->width && kind == H5Tget_class(type));
  (void)H5Tclose(stored);
  (void)H5Sclose(space);
  return same;
}

PetscErrorCode H5FileRead(H5File *h5, const char name[], hid_t type, const Rows *rows, void *values)
{
  PetscBool   external = PETSC_FALSE, all;
  const hid_t set      = OpenSet(h5, name, &external);
  hid_t       file, memory;

  PetscFunctionBegin;
  PetscCall(ProgressWork(h5->comm, -1, "reading %s of %" PetscInt_FMT " rows", name, rows->total));
  PetscCall(AllAgree(h5, (PetscBool)(set >= 0 && HasShape(set, type, rows)), &all));
  if (!all) {
    h5->failed = PETSC_TRUE;
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &external, 1, MPIU_BOOL, MPI_LOR, h5->comm));
    h5->external = (PetscBool)(h5->external || external);
  }
  if (all && rows->n) {
    SelectRows(rows, rows->start, rows->n, &file, &memory);
    H5FileNote(h5, H5Dread(set, type, memory, file, H5P_DEFAULT, values));
    (void)H5Sclose(memory);
    (void)H5Sclose(file);
  }
  if (set >= 0) (void)H5Dclose(set);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool H5FileHolds(H5File *h5, PetscInt64 rows, size_t bytes)
{
  return (PetscBool)(rows >= 0 && (hsize_t)rows <= h5->length / bytes);
}

void H5FilePutReal(H5File *h5, const char name[], PetscInt n, const PetscReal values[])
{
  H5FilePutAttribute(h5, h5->id, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, (hsize_t)n, values);
}

void H5FilePutInt(H5File *h5, const char name[], PetscInt64 value)
{
  H5FilePutAttribute(h5, h5->id, name, H5T_STD_I64LE, H5T_NATIVE_LLONG, 1, &value);
}

void H5FilePutText(H5File *h5, const char name[], const char text[])
{
  AttributePutText(h5, h5->id, name, text);
}

/* Reads a scalar attribute of a class; size: bytes of 'value' for a text. */
static PetscBool AttributeGet(H5File *h5, const char name[], H5T_class_t kind, hid_t type, void *value, size_t size)
{
  hid_t     attribute, stored, space;
  PetscBool found = PETSC_FALSE;

  if (h5->id < 0 || H5Aexists(h5->id, name) <= 0) return PETSC_FALSE;
  attribute = H5Aopen(h5->id, name, H5P_DEFAULT);
  if (attribute < 0) return PETSC_FALSE;
  stored = H5Aget_type(attribute);
  space  = H5Aget_space(attribute);
  if (H5Tget_class(stored) == kind && H5Sget_simple_extent_npoints(space) == 1) {
    if (kind != H5T_STRING)
      found = (PetscBool)(H5Aread(attribute, type, value) >= 0);
    else if (H5Tis_variable_str(stored) == 0 && H5Tget_size(stored) < size)
      found = (PetscBool)(H5Aread(attribute, stored, value) >= 0);
  }
  (void)H5Sclose(space);
  (void)H5Tclose(stored);
  (void)H5Aclose(attribute);
  return found;
}

PetscBool H5FileHas(H5File *h5, const char name[])
{
  return (PetscBool)(h5->id >= 0 && H5Lexists(h5->id, name, H5P_DEFAULT) > 0);
}

PetscBool H5FileGetReal(H5File *h5, const char name[], PetscReal *value)
{
  return AttributeGet(h5, name, H5T_FLOAT, H5T_NATIVE_DOUBLE, value, 0);
}

PetscBool H5FileGetInt(H5File *h5, const char name[], PetscInt64 *value)
{
  return AttributeGet(h5, name, H5T_INTEGER, H5T_NATIVE_LLONG, value, 0);
}

PetscBool H5FileGetText(H5File *h5, const char name[], char text[], size_t size)
{
  memset(text, 0, size);
  return AttributeGet(h5, name, H5T_STRING, -1, text, size);
}
