/* The seal at the end of a finished file: a magic word, and length and checksum of the file without the seal. */
#include "storage.h"
#include <sys/stat.h>

#define SEAL_MAGIC  0x31304C4145534853ULL /* "SHSEAL01" in a little-endian file */
#define SEAL_WORDS  3                     /* magic, length in bytes, checksum */
#define WORD        sizeof(unsigned long long)
#define CHUNK_WORDS (1 << 16)             /* read at a time */
#define INDEX_STEP  0x9E3779B97F4A7C15ULL /* SplitMix64's increment, with which the index of a word is hashed */

/* Sums a hash of each word and its index over the words first to last - 1 of a file, so the ranks can share the words.
   Bytes beyond 'length' are zero. Returns false if the file cannot be read. */
static PetscBool SumWords(const char path[], unsigned long long length, unsigned long long first,
                          unsigned long long last, unsigned long long *sum)
{
  FILE               *file  = fopen(path, "rb");
  unsigned long long *chunk = malloc(CHUNK_WORDS * WORD);
  PetscBool           good  = (PetscBool)(file && chunk && !fseeko(file, (off_t)(first * WORD), SEEK_SET));

  *sum = 0;
  for (unsigned long long word = first; good && word < last; word += CHUNK_WORDS) {
    const unsigned long long words = PetscMin(last - word, CHUNK_WORDS),
                             bytes = PetscMin(length - word * WORD, words * WORD);

    InterruptAlive(NULL);
    memset(chunk, 0, CHUNK_WORDS * WORD);
    good = (PetscBool)(fread(chunk, 1, bytes, file) == bytes);
    for (unsigned long long k = 0; good && k < words; k++)
      *sum += SplitMix64(chunk[k] ^ SplitMix64((word + k + 1) * INDEX_STEP));
  }
  if (file) fclose(file);
  free(chunk);
  return good;
}

static PetscErrorCode Checksum(MPI_Comm comm, const char path[], unsigned long long length, unsigned long long *sum,
                               PetscBool *good)
{
  const unsigned long long words = (length + WORD - 1) / WORD;
  PetscMPIInt              rank, size, ok;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  ok =
    SumWords(path, length, words * (unsigned)rank / (unsigned)size, words * (unsigned)(rank + 1) / (unsigned)size, sum);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &ok, 1, MPI_INT, MPI_MIN, comm));
  *good = ok ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FileSeal(MPI_Comm comm, const char path[], PetscBool *failed)
{
  unsigned long long seal[SEAL_WORDS] = {SEAL_MAGIC, 0, 0}, length = 0;
  PetscMPIInt        rank, ok                                      = 1;
  PetscBool          good;
  struct stat        info;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (!rank) {
    ok     = !stat(path, &info);
    length = ok ? (unsigned long long)info.st_size : 0;
  }
  PetscCallMPI(MPI_Bcast(&length, 1, MPI_UNSIGNED_LONG_LONG, 0, comm));
  seal[1] = length;
  PetscCall(Checksum(comm, path, length, &seal[2], &good));
  if (!rank) {
    FILE *file = ok ? fopen(path, "ab") : NULL;

    ok = file && fwrite(seal, sizeof(seal), 1, file) == 1;
    if (file && fclose(file)) ok = 0;
  }
  PetscCallMPI(MPI_Bcast(&ok, 1, MPI_INT, 0, comm));
  *failed = (PetscBool) !(ok && good);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FileCheckSeal(MPI_Comm comm, const char path[], Seal *found)
{
  unsigned long long seal[SEAL_WORDS] = {0, 0, 0}, sum;
  PetscMPIInt        rank, ok = 0;
  PetscBool          good;
  struct stat        info;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (!rank) {
    /* Opening a pipe could wait for ever. */
    FILE *file = !stat(path, &info) && S_ISREG(info.st_mode) ? fopen(path, "rb") : NULL;

    ok = file && !fseeko(file, -(off_t)sizeof(seal), SEEK_END) && fread(seal, sizeof(seal), 1, file) == 1 &&
         !fstat(fileno(file), &info);
    ok = ok && seal[0] == SEAL_MAGIC && seal[1] + sizeof(seal) == (unsigned long long)info.st_size;
    if (file) fclose(file);
  }
  PetscCallMPI(MPI_Bcast(&ok, 1, MPI_INT, 0, comm));
  PetscCallMPI(MPI_Bcast(seal, SEAL_WORDS, MPI_UNSIGNED_LONG_LONG, 0, comm));
  *found = SEAL_NONE;
  if (!ok) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Checksum(comm, path, seal[1], &sum, &good));
  *found = good && sum == seal[2] ? SEAL_GOOD : SEAL_WRONG;
  PetscFunctionReturn(PETSC_SUCCESS);
}
