/* The run folder: made, claimed, and described by options.opts and version.txt. */
#include "output_impl.h"
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <time.h>
#include <unistd.h>

/* Options that belong to one start of the program, not to the run. */
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

/* Files of a run besides the numbered ones. */
static const char *const files[]    = {"series.csv",   "snapshots.xdmf", "options.opts", "version.txt", "lines.csv",
                                       "droplets.csv", "solids.h5",      "log.txt",      NULL};
static const char *const numbered[] = {"snapshot_", "checkpoint_", NULL};

PetscErrorCode FolderStatus(Output output, int error, const char doing[], const char path[])
{
  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(&error, 1, MPI_INT, 0, output->comm));
  PetscCheckUser(!error, output->comm, "Cannot %s %s: %s.", doing, path, strerror(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FolderMake(Output output)
{
  int error = 0;

  PetscFunctionBegin;
  if (!output->rank) {
    error = FolderCreate(output->folder);
    if (!error && access(output->folder, W_OK | X_OK)) error = errno;
  }
  PetscCall(FolderStatus(output, error, "write into the folder", output->folder));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The number in <prefix><digits>.h5, or in <prefix><digits>.h5.tmp when temporary is true; -1 for other names. */
static PetscInt NumberOf(const char name[], const char prefix[], PetscBool temporary)
{
  const size_t length = strlen(prefix);
  const char  *digits = name + length;
  char        *end;
  long         number;

  if (strncmp(name, prefix, length) || !isdigit((unsigned char)*digits)) return -1;
  number = strtol(digits, &end, 10);
  if (strcmp(end, temporary ? ".h5.tmp" : ".h5") || number < 0 || number >= PETSC_MAX_INT) return -1;
  return (PetscInt)number;
}

PetscErrorCode FolderNumbers(Output output, const char prefix[], PetscInt *count, PetscInt **numbers)
{
  DIR           *folder;
  struct dirent *file;
  PetscInt       n = 0, capacity = 0, *list = NULL;

  PetscFunctionBegin;
  folder = opendir(output->folder);
  while (folder && (file = readdir(folder))) {
    const PetscInt number = NumberOf(file->d_name, prefix, PETSC_FALSE);

    if (number < 0) continue;
    if (n == capacity) {
      capacity = 2 * capacity + 16;
      PetscCall(PetscRealloc(sizeof(*list) * capacity, &list));
    }
    list[n++] = number;
  }
  if (folder) closedir(folder);
  PetscCall(PetscSortInt(n, list));
  *count   = n;
  *numbers = list;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsOurs(const char name[])
{
  char temporary[64];

  for (PetscInt f = 0; files[f]; f++) {
    snprintf(temporary, sizeof(temporary), "%s.tmp", files[f]);
    if (!strcmp(name, files[f]) || !strcmp(name, temporary)) return PETSC_TRUE;
  }
  for (PetscInt f = 0; numbered[f]; f++) {
    if (NumberOf(name, numbered[f], PETSC_FALSE) >= 0 || NumberOf(name, numbered[f], PETSC_TRUE) >= 0)
      return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* Counts the files that make a folder a run's, and removes all that a run writes when asked to. Rank 0 only; returns an
 * errno. */
static int Sweep(Output output, PetscBool removing, PetscInt *found)
{
  DIR           *folder = opendir(output->folder);
  struct dirent *file;
  char           path[PETSC_MAX_PATH_LEN];

  *found = 0;
  if (!folder) return errno;
  while ((file = readdir(folder))) {
    const char *name = file->d_name;

    if (!strcmp(name, files[0]) || NumberOf(name, numbered[0], PETSC_FALSE) >= 0 ||
        NumberOf(name, numbered[1], PETSC_FALSE) >= 0)
      (*found)++;
    if (!removing || !IsOurs(name)) continue;
    if (snprintf(path, sizeof(path), "%s/%s", output->folder, name) >= (int)sizeof(path) || unlink(path)) {
      const int error = errno;

      closedir(folder);
      return error;
    }
  }
  closedir(folder);
  return 0;
}

/* The end of the next word of a text, words being separated by spaces; *word is moved to its start. */
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

PetscErrorCode FolderOptions(char **text)
{
  char  *all, *key, *key_end;
  size_t length, used = 0;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetAll(NULL, &all));
  PetscCall(PetscStrlen(all, &length));
  PetscCall(PetscCalloc1(3 * length + 1, text)); /* at most two quotes and a line end more for each option */
  key     = all;
  key_end = WordEnd(&key);
  while (*key) {
    char     *value = key_end, *value_end = key_end, *next = key_end, *next_end = WordEnd(&next);
    PetscBool found = PETSC_FALSE, skip = PETSC_FALSE;
    PetscInt  words = 0;

    while (*next && !found) { /* the value is all up to the next key */
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

static PetscErrorCode WriteDescriptions(Output output, PetscBool same)
{
  char path[PETSC_MAX_PATH_LEN], version[4096];
  int  error = 0;

  PetscFunctionBegin;
  PetscCall(OutputPath(output, "options.opts.tmp", path));
  if (!output->rank) error = WriteText(path, "w", output->options);
  PetscCall(FolderStatus(output, error, "write", path));
  PetscCall(FolderCommit(output, "options.opts", PETSC_FALSE));
  PetscCall(OutputPath(output, "version.txt", path));
  PetscCall(DescribeProgram(output, same, version, sizeof(version)));
  if (!output->rank) error = WriteText(path, same ? "a" : "w", version);
  PetscCall(FolderStatus(output, error, "write", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FolderClaim(Output output, PetscBool same)
{
  PetscInt found = 0;
  int      error = 0;

  PetscFunctionBegin;
  if (!same) {
    if (!output->rank) error = Sweep(output, PETSC_FALSE, &found);
    PetscCall(FolderStatus(output, error, "read the folder", output->folder));
    PetscCallMPI(MPI_Bcast(&found, 1, MPIU_INT, 0, output->comm));
    PetscCheckUser(!found || output->overwrite, output->comm,
                   "The folder %s holds a run already; choose another -output_dir, continue it with -restart, or "
                   "replace it with -output_overwrite.",
                   output->folder);
    if (!output->rank && output->overwrite) error = Sweep(output, PETSC_TRUE, &found);
    PetscCall(FolderStatus(output, error, "remove the earlier run in", output->folder));
  }
  PetscCall(WriteDescriptions(output, same));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FolderCommit(Output output, const char name[], PetscBool sync)
{
  char path[PETSC_MAX_PATH_LEN], temporary[PETSC_MAX_PATH_LEN];
  int  error = 0;

  PetscFunctionBegin;
  PetscCall(OutputPath(output, name, path));
  PetscCall(PetscSNPrintf(temporary, sizeof(temporary), "%s.tmp", path));
  if (!output->rank) {
    if (sync) error = FileSync(temporary);
    if (!error && rename(temporary, path)) error = errno;
    if (!error && sync) error = FileSync(output->folder);
  }
  PetscCall(FolderStatus(output, error, "write", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FolderDiscard(Output output, const char name[])
{
  char path[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(OutputPath(output, name, path));
  PetscCall(PetscStrlcat(path, ".tmp", sizeof(path)));
  if (!output->rank) (void)unlink(path);
  PetscFunctionReturn(PETSC_SUCCESS);
}
