/* Tables of numbers in files. */
#include "body.h"
#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define LINE_LENGTH  4096
#define NUMBER_MOST  (PETSC_MAX_REAL / 4) /* differences are finite */
#define COLUMNS_MOST 8
#define BYTE_ORDER   "\xef\xbb\xbf" /* byte-order mark, which some programs write at the start of a text file */

/* Results of ReadLine for a line that is no row of a table. */
enum {
  LINE_BAD   = -1, /* numbers and words, too many numbers, or a number that is not finite */
  LINE_NAMES = -2  /* words, the first of which begins with a letter, perhaps in quotes */
};

/* Reads the numbers of a line, 'most' of them. Returns their count, LINE_BAD or LINE_NAMES. */
static int ReadLine(char line[], PetscInt most, PetscReal number[])
{
  int       count = 0, others = 0;
  PetscBool named = PETSC_FALSE;
  char     *rest;

  for (char *word = strtok_r(line, ", \t\r\n", &rest); word; word = strtok_r(NULL, ", \t\r\n", &rest)) {
    char     *end;
    PetscReal value;

    word += *word == '"' || *word == '\'';
    value = (PetscReal)strtod(word, &end);
    if (count + others == 0) named = (PetscBool)(isalpha((unsigned char)*word) != 0);
    if (end == word || (*end && isalpha((unsigned char)*word))) { /* a word; strtod reads "inf" from "information" */
      others++;
      continue;
    }
    if (*end || !(PetscAbsReal(value) < NUMBER_MOST) || count == most) return LINE_BAD;
    number[count++] = value;
  }
  return others == 0 ? count : named && count == 0 ? LINE_NAMES : LINE_BAD;
}

/* Reads the table on rank 0. *bad: the number of the first bad line, or -1 if the file cannot be read. */
static PetscErrorCode ReadFile(const char path[], PetscInt least, PetscInt most, PetscInt *rows, PetscInt *columns,
                               PetscReal **table, int *bad)
{
  PetscSegBuffer kept;
  FILE          *file = NULL;
  struct stat    info;
  char           line[LINE_LENGTH];
  PetscReal      before = -PETSC_MAX_REAL;
  PetscBool      first  = PETSC_TRUE;

  PetscFunctionBegin;
  *bad = -1;
  if (stat(path, &info) || !S_ISREG(info.st_mode) || !(file = fopen(path, "r"))) PetscFunctionReturn(PETSC_SUCCESS);
  *bad = 0;
  PetscCall(PetscSegBufferCreate(sizeof(PetscReal), 64, &kept));
  for (int n = 1; !*bad && fgets(line, sizeof(line), file); n++) {
    const PetscBool whole = (PetscBool)(strchr(line, '\n') || feof(file)); /* neither too long nor with a byte 0 */
    char           *text  = line;
    PetscReal       number[COLUMNS_MOST + 1] = {0}, *row;
    int             count;

    if (n == 1 && !strncmp(text, BYTE_ORDER, strlen(BYTE_ORDER))) text += strlen(BYTE_ORDER);
    text += strspn(text, " \t");
    count = !whole ? LINE_BAD : *text == '#' ? 0 : ReadLine(text, most + 1, number);
    if (count == 0) continue;
    if (first && count == LINE_NAMES) {
      first = PETSC_FALSE;
      continue;
    }
    first = PETSC_FALSE;
    if (*columns == 0) *columns = count;
    if (count != *columns || count < least || count > most || number[0] <= before) {
      *bad = n;
      continue;
    }
    before = number[0];
    PetscCall(PetscSegBufferGet(kept, (size_t)count, &row));
    PetscCall(PetscArraycpy(row, number, count));
    (*rows)++;
  }
  (void)fclose(file);
  PetscCall(PetscSegBufferExtractAlloc(kept, table));
  PetscCall(PetscSegBufferDestroy(&kept));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TableRead(MPI_Comm comm, const char option[], const char what[], const char first[], PetscInt least,
                         PetscInt most, OptionFile *file, PetscInt *rows, PetscInt *columns, PetscReal **table)
{
  PetscMPIInt rank;
  int         bad = 0;

  PetscFunctionBegin;
  *rows = *columns = 0;
  *table           = NULL;
  if (!file->path[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(most <= COLUMNS_MOST, comm, PETSC_ERR_ARG_OUTOFRANGE, "at most %d columns", COLUMNS_MOST);
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (!rank) PetscCall(ReadFile(file->path, least, most, rows, columns, table, &bad));
  PetscCallMPI(MPI_Bcast(&bad, 1, MPI_INT, 0, comm));
  PetscCallMPI(MPI_Bcast(rows, 1, MPIU_INT, 0, comm));
  PetscCallMPI(MPI_Bcast(columns, 1, MPIU_INT, 0, comm));
  PetscCheckUser(bad >= 0, comm, "%s %s cannot be read or is no regular file", option, file->path);
  PetscCheckUser(
    bad == 0, comm,
    "%s %s, line %d: a line must have %s, and a %s than the line before; the first line may have the names "
    "of the columns",
    option, file->path, bad, what, first);
  PetscCheckUser(*rows >= 2, comm, "%s %s must have two lines or more", option, file->path);
  if (rank) PetscCall(PetscMalloc1(*columns * *rows, table));
  PetscCallMPI(MPI_Bcast(*table, (PetscMPIInt)(*columns * *rows), MPIU_REAL, 0, comm));
  file->checksum = HashBytes(HASH_START, *table, (size_t)(*columns * *rows) * sizeof(**table));
  PetscFunctionReturn(PETSC_SUCCESS);
}
