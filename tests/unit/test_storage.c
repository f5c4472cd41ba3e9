/* Files of rows spread over the ranks, there and back; attributes; seals; folders. On any number of ranks. */
#include "../../src/storage/storage.h"
#include "check.h"
#include <errno.h>
#include <string.h>
#include <unistd.h>

#define FOLDER    "output/test_storage/below"
#define FILE_H5   FOLDER "/file.h5"
#define MOST      5         /* rows of a rank, or times ... */
#define STRUCTURE (1 << 18) /* bytes that a file needs besides its rows */
#define MANY      9000      /* ... so many: some chunks of a compressed data set have the rows of several ranks */

/* Rank r has (r + 2) % MOST times 'of' rows, so some have none. Value c of row k is k + c/4. */
static PetscErrorCode MakeRows(PetscInt of, PetscInt width, Rows *rows, double **values)
{
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  *rows = (Rows){.n = of * ((rank + 2) % MOST), .width = width};
  PetscCallMPI(MPI_Exscan(&rows->n, &rows->start, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD));
  if (!rank) rows->start = 0;
  PetscCallMPI(MPI_Allreduce(&rows->n, &rows->total, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD));
  PetscCall(PetscMalloc1(width * rows->n, values));
  for (PetscInt k = 0; k < rows->n; k++)
    for (PetscInt c = 0; c < width; c++) (*values)[width * k + c] = (double)(rows->start + k) + 0.25 * (double)c;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteAndRead(PetscInt of, PetscInt compression)
{
  H5File      h5;
  PetscMPIInt rank;
  Rows        rows, all;
  double     *values, *back;
  PetscReal   time = 0.1, corner[2] = {1, 2};
  PetscInt64  step = 0;
  char        text[16];
  PetscBool   failed, same = PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(MakeRows(of, DIM, &rows, &values));
  PetscCall(H5FileCreate(PETSC_COMM_WORLD, FILE_H5, &h5));
  h5.compression = compression;
  H5FilePutReal(&h5, "time", 1, &time);
  H5FilePutReal(&h5, "corner", 2, corner);
  H5FilePutInt(&h5, "step", 7);
  H5FilePutText(&h5, "format", "test");
  PetscCall(H5FileWrite(&h5, "place", H5T_NATIVE_DOUBLE, &rows, values, "m", "where"));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (!rank)
    CHECK(h5.reserved >= sizeof(double) * DIM * (hsize_t)rows.total + STRUCTURE, "room for rows and structure");
  PetscCall(H5FileClose(&h5, &failed));
  CHECK(!failed, "file written");
  PetscCall(H5FileOpen(PETSC_COMM_WORLD, FILE_H5, &h5));
  time = 0;
  CHECK(H5FileGetReal(&h5, "time", &time) && time == 0.1, "a real attribute");
  CHECK(H5FileGetInt(&h5, "step", &step) && step == 7, "a whole attribute");
  CHECK(H5FileGetText(&h5, "format", text, sizeof(text)) && !strcmp(text, "test"), "a text");
  CHECK(!H5FileGetText(&h5, "format", text, 4) && !text[0], "a text that is too long");
  CHECK(!H5FileGetReal(&h5, "corner", &time) && !H5FileGetReal(&h5, "none", &time) && time == 0.1,
        "no number, no change");
  CHECK(H5FileHas(&h5, "place") && !H5FileHas(&h5, "velocity"), "which data sets there are");
  all = (Rows){.n = rows.total, .total = rows.total, .width = DIM}; /* each rank reads everything */
  PetscCall(PetscCalloc1(DIM * rows.total, &back));
  PetscCall(H5FileRead(&h5, "place", H5T_NATIVE_DOUBLE, &all, back));
  for (PetscInt k = 0; k < DIM * rows.total; k++) same = (PetscBool)(same && back[k] == k / DIM + 0.25 * (k % DIM));
  CHECK(same && rows.total > 0, "rows of all ranks in order");
  PetscCall(H5FileClose(&h5, &failed));
  CHECK(!failed, "file read");
  PetscCall(H5FileOpen(PETSC_COMM_WORLD, FILE_H5, &h5));
  all.width = 1;
  PetscCall(H5FileRead(&h5, "place", H5T_NATIVE_DOUBLE, &all, back));
  PetscCall(H5FileClose(&h5, &failed));
  CHECK(failed, "rows of another width are refused");
  PetscCall(PetscFree(back));
  PetscCall(PetscFree(values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckSeals(void)
{
  PetscMPIInt rank;
  PetscBool   failed;
  Seal        seal;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(FileCheckSeal(PETSC_COMM_WORLD, FOLDER "/none.h5", &seal));
  CHECK(seal == SEAL_NONE, "no file, no seal");
  PetscCall(FileCheckSeal(PETSC_COMM_WORLD, FILE_H5, &seal));
  CHECK(seal == SEAL_NONE, "not yet sealed");
  PetscCall(FileSeal(PETSC_COMM_WORLD, FILE_H5, &failed));
  PetscCall(FileCheckSeal(PETSC_COMM_WORLD, FILE_H5, &seal));
  CHECK(!failed && seal == SEAL_GOOD, "sealed");
  if (!rank) {
    FILE *file = fopen(FILE_H5, "r+b");
    int   byte;

    CHECK(file && !fseek(file, 1000, SEEK_SET) && (byte = fgetc(file)) != EOF && !fseek(file, 1000, SEEK_SET) &&
            fputc(byte ^ 1, file) != EOF && !fclose(file),
          "a bit is changed");
  }
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  PetscCall(FileCheckSeal(PETSC_COMM_WORLD, FILE_H5, &seal));
  CHECK(seal == SEAL_WRONG, "damage is noticed");
  if (!rank) { /* the bit as it was, and two words exchanged */
    FILE *file = fopen(FILE_H5, "r+b");
    char  first[8], second[8];
    int   byte;

    CHECK(file && !fseek(file, 1000, SEEK_SET) && (byte = fgetc(file)) != EOF && !fseek(file, 1000, SEEK_SET) &&
            fputc(byte ^ 1, file) != EOF && !fseek(file, 0, SEEK_SET) && fread(first, 8, 1, file) == 1 &&
            !fseek(file, 1000, SEEK_SET) && fread(second, 8, 1, file) == 1 && memcmp(first, second, 8) &&
            !fseek(file, 0, SEEK_SET) && fwrite(second, 8, 1, file) == 1 && !fseek(file, 1000, SEEK_SET) &&
            fwrite(first, 8, 1, file) == 1 && !fclose(file),
          "two words are exchanged");
  }
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  PetscCall(FileCheckSeal(PETSC_COMM_WORLD, FILE_H5, &seal));
  CHECK(seal == SEAL_WRONG, "exchanged words are noticed");
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscMPIInt rank;
  H5File      h5;
  PetscBool   failed;

  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (!rank) {
    CHECK(!FolderCreate(FOLDER) && !FolderCreate(FOLDER) && !access(FOLDER, W_OK), "a folder and those above it");
    CHECK(!FileSync(FOLDER) && FileSync(FOLDER "/none") == ENOENT, "what is not there cannot be synced");
  }
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  PetscCall(WriteAndRead(MANY, 1));
  PetscCall(WriteAndRead(1, 0));
  PetscCall(WriteAndRead(1, 1));
  PetscCall(CheckSeals());
  if (!rank) CHECK(FolderCreate(FILE_H5) == ENOTDIR, "a file is no folder");
  PetscCall(H5FileCreate(PETSC_COMM_WORLD, FOLDER "/none/file.h5", &h5));
  PetscCall(H5FileClose(&h5, &failed));
  CHECK(failed, "no folder, no file");
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  if (!rank) CHECK(!unlink(FILE_H5) && !rmdir(FOLDER) && !rmdir("output/test_storage"), "cleared");
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
