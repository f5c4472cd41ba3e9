/* What describes a run: options.opts, usable with -options_file, and version.txt. */
#include "output_impl.h"
#include <errno.h>
#include <time.h>

/* Options of one start of the program, not of the run. */
static const char *const transient[] = {"-restart",
                                        "-output_dir",
                                        "-output_overwrite",
                                        "-options_file",
                                        "-options_file_yaml",
                                        "-options_left",
                                        "-dry_run",
                                        "-dump_options",
                                        "-options_view",
                                        "-help",
                                        "-h",
                                        "-version",
                                        "-v",
                                        NULL};

/* Moves *word to the start of the next word, after spaces; returns the end of the word. */
static char *WordEnd(char **word)
{
  char *end;

  while (**word == ' ') (*word)++;
  for (end = *word; *end && *end != ' '; end++)
    ;
  return end;
}

static PetscErrorCode IsKey(char word[], char *end, PetscBool *key)
{
  const char kept = *end;

  PetscFunctionBegin;
  *end = '\0';
  PetscCall(PetscOptionsValidKey(word, key));
  *end = kept;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputOptions(char **text)
{
  char  *all, *key, *key_end;
  size_t length, used = 0;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetAll(NULL, &all));
  PetscCall(PetscStrlen(all, &length));
  PetscCall(PetscCalloc1(3 * length + 1, text)); /* at most two quotes and a line end are added for each option */
  key     = all;
  key_end = WordEnd(&key);
  while (*key) {
    char     *value = key_end, *value_end = key_end, *next = key_end, *next_end = WordEnd(&next);
    PetscBool found = PETSC_FALSE, skip = PETSC_FALSE;
    PetscInt  words = 0;

    while (*next && !found) { /* the value ends at the next option's name */
      PetscCall(IsKey(next, next_end, &found));
      if (found) break;
      if (!words++) value = next;
      value_end = next = next_end;
      next_end         = WordEnd(&next);
    }
    for (PetscInt t = 0; transient[t]; t++)
      skip = (PetscBool)(skip || ((size_t)(key_end - key) == strlen(transient[t]) &&
                                  !strncmp(key, transient[t], (size_t)(key_end - key))));
    if (!skip) {
      const char *quote = words > 1 ? "\"" : "";

      used += (size_t)sprintf(*text + used, "%.*s%s%s%.*s%s\n", (int)(key_end - key), key, words ? " " : "", quote,
                              (int)(value_end - value), value, quote);
    }
    key     = next;
    key_end = next_end;
  }
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rank 0 only; returns an errno. */
static int WriteText(const char path[], const char mode[], const char text[])
{
  FILE *file = fopen(path, mode);
  int   error;

  if (!file) return errno;
  error = fputs(text, file) < 0 || fflush(file) ? errno : 0;
  if (fclose(file) && !error) error = errno;
  return error;
}

static PetscErrorCode DescribeProgram(Output output, PetscBool same, char text[], size_t size)
{
  char      petsc[256], mpi[MPI_MAX_LIBRARY_VERSION_STRING], date[64] = "";
  unsigned  major, minor, release;
  int       length;
  time_t    now = time(NULL);
  struct tm moment;

  PetscFunctionBegin;
  PetscCall(PetscGetVersion(petsc, sizeof(petsc)));
  PetscCallMPI(MPI_Get_library_version(mpi, &length));
  for (char *end = mpi; *end; end++)
    if (*end == '\n') *end = ' ';
  H5get_libversion(&major, &minor, &release);
  if (gmtime_r(&now, &moment)) strftime(date, sizeof(date), "%Y-%m-%dT%H:%M:%SZ", &moment);
  PetscCall(PetscSNPrintf(text, size,
                          "%sisph %s\n%s\nHDF5 %u.%u.%u\nMPI %s\nranks %d\ncompiler %s\nindices %d bit\ndate %s\n",
                          same ? "\ncontinued by\n" : "", ISPH_VERSION, petsc, major, minor, release, mpi, output->size,
                          __VERSION__, (int)(8 * sizeof(PetscInt)), date));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutputText(Output output, const char name[], const char text[])
{
  char path[PETSC_MAX_PATH_LEN], temporary[OUTPUT_NAME_LENGTH];
  int  error = 0;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(temporary, sizeof(temporary), "%s.tmp", name));
  PetscCall(OutputPath(output, temporary, path));
  if (!output->rank) error = WriteText(path, "w", text);
  PetscCall(FolderStatus(output, error, "write", path));
  PetscCall(FolderCommit(output, name, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode DescribeRun(Output output, PetscBool same)
{
  char path[PETSC_MAX_PATH_LEN], version[4096];
  int  error = 0;

  PetscFunctionBegin;
  PetscCall(OutputText(output, "options.opts", output->options));
  PetscCall(OutputPath(output, "version.txt", path));
  PetscCall(DescribeProgram(output, same, version, sizeof(version)));
  if (!output->rank) error = WriteText(path, same ? "a" : "w", version);
  PetscCall(FolderStatus(output, error, "write", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}
