/* Tables of comma-separated values that grow line by line; written by rank 0 and flushed line by line. */
#include "output_impl.h"
#include <errno.h>
#include <sys/stat.h>
#include <unistd.h>

/* Cuts the file behind a step: copies the head and the complete lines to a temporary file, which replaces it. Rank 0;
   returns an errno, EILSEQ when the file has other columns. */
static int Cut(const char path[], const char temporary[], const char head[], PetscInt restart_step, PetscInt *last_step)
{
  FILE *from = fopen(path, "r"), *to;
  char  line[LINE_LENGTH];
  int   error = 0;

  *last_step = -1;
  if (!from) return errno == ENOENT ? 0 : errno;
  to = fopen(temporary, "w");
  if (!to) error = errno;
  if (!error && (!fgets(line, sizeof(line), from) || strcmp(line, head))) error = EILSEQ;
  if (!error && fputs(head, to) < 0) error = errno;
  while (!error && fgets(line, sizeof(line), from)) {
    double time;
    long   step;

    if (!strchr(line, '\n') || sscanf(line, "%lf,%ld,", &time, &step) != 2) break; /* cut off in writing */
    if (step > restart_step) break;
    if (fputs(line, to) < 0) error = errno;
    *last_step = (PetscInt)step;
  }
  fclose(from);
  if (!to) return error;
  if (fflush(to) && !error) error = errno;
  if (fsync(fileno(to)) && !error && errno != EINVAL) error = errno;
  if (fclose(to) && !error) error = errno;
  if (!error && rename(temporary, path)) error = errno;
  if (error) (void)unlink(temporary);
  return error;
}

/* Opens the file to append, with the head when it is new. Rank 0; returns an errno. */
static int Open(const char path[], const char head[], FILE **file)
{
  struct stat info;

  *file = fopen(path, "a");
  if (!*file) return errno;
  if (fstat(fileno(*file), &info)) return errno;
  if (info.st_size == 0 && (fputs(head, *file) < 0 || fflush(*file))) return errno;
  return 0;
}

PetscErrorCode TableOpen(Output output, const char name[], const char head[], PetscBool same, PetscInt restart_step,
                         FILE **file, PetscInt *last)
{
  char path[PETSC_MAX_PATH_LEN], temporary[PETSC_MAX_PATH_LEN];
  int  error = 0, other;

  PetscFunctionBegin;
  *last = -1;
  PetscCall(OutputPath(output, name, path));
  PetscCall(PetscSNPrintf(temporary, sizeof(temporary), "%s.tmp", path));
  if (!output->rank && same) error = Cut(path, temporary, head, restart_step, last);
  other = error == EILSEQ;
  PetscCallMPI(MPI_Bcast(&other, 1, MPI_INT, 0, output->comm));
  PetscCheckUser(
    !other, output->comm,
    "%s has other columns than this run writes (-gauge_..., or the version of the program); move it away to "
    "continue the run.",
    path);
  if (!output->rank && !error) error = Open(path, head, file);
  PetscCall(FolderStatus(output, error, "write", path));
  PetscCallMPI(MPI_Bcast(last, 1, MPIU_INT, 0, output->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes a value. Returns an errno. */
static int WriteValue(FILE *file, PetscInt digits, double value)
{
  if (value != value) return fputs(",nan", file) < 0 ? errno : 0; /* no "-nan" */
  return fprintf(file, ",%.*g", (int)digits, value) < 0 ? errno : 0;
}

int TableWrite(FILE *file, const StepState *state, PetscInt digits, PetscInt count, PetscInt width,
               const PetscReal values[])
{
  int error = 0;

  for (PetscInt k = 0; k < count && !error; k++) {
    if (fprintf(file, "%.12g,%ld", (double)state->time, (long)state->step) < 0) return errno;
    for (PetscInt c = 0; c < width && !error; c++) error = WriteValue(file, digits, (double)values[width * k + c]);
    if (!error && fputs("\n", file) < 0) error = errno;
  }
  if (!error && fflush(file)) error = errno;
  return error;
}
