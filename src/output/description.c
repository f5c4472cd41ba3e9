/* What describes a run: options.opts, usable with -options_file, and version.txt. */
#include "output_impl.h"
#include <errno.h>
#include <sys/stat.h>
#include <time.h>

#define INPUTS "inputs" /* folder in the run's, of the files that options name */

/* Options of one start of the program, not of the run. */
static const char *const transient[] = {"-restart",
                                        "-restart_disturbance",
                                        "-output_dir",
                                        "-output_overwrite",
                                        "-options_file",
                                        "-options_file_yaml",
                                        "-options_left",
                                        "-dry_run",
                                        "-measure",
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

/* Copies a file under another name, unless it is that file. Rank 0 only; returns an errno. */
static int Copy(const char from[], const char to[])
{
  char        part[65536];
  struct stat source, target;
  size_t      n;
  int         error = 0;
  FILE       *in, *out;

  if (stat(from, &source)) return errno;
  if (!stat(to, &target) && source.st_dev == target.st_dev && source.st_ino == target.st_ino) return 0;
  in  = fopen(from, "rb");
  out = in ? fopen(to, "wb") : NULL;
  if (!out) error = errno;
  while (!error && (n = fread(part, 1, sizeof(part), in)) > 0)
    if (fwrite(part, 1, n, out) < n) error = errno;
  if (in && !error && ferror(in)) error = EIO;
  if (out && fclose(out) && !error) error = errno;
  if (in) (void)fclose(in);
  return error;
}

/* Keeps a file that the option of a note names, as inputs/<option><.ending>; has the options of the run name that. */
static PetscErrorCode KeepInput(Output output, const OptionNote *note, char **text)
{
  const char *dot = strrchr(note->value, '.'), *slash = strrchr(note->value, '/');
  char        path[PETSC_MAX_PATH_LEN], name[OUTPUT_NAME_LENGTH], line[OPTION_NAME_LENGTH + 2], *at, *end, *longer;
  int         error = 0;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(name, sizeof(name), INPUTS "/%s%.8s", note->name + 1, dot > slash ? dot : ""));
  PetscCall(OutputPath(output, INPUTS, path));
  if (!output->rank && mkdir(path, 0777) && errno != EEXIST) error = errno;
  PetscCall(FolderStatus(output, error, "make the folder", path));
  PetscCall(OutputPath(output, name, path));
  if (!output->rank) error = Copy(note->value, path);
  PetscCall(FolderStatus(output, error, "keep a copy of an input as", path));
  PetscCall(PetscSNPrintf(line, sizeof(line), "%s ", note->name));
  for (at = *text; at && strncmp(at, line, strlen(line)); at += at != NULL) at = strchr(at, '\n');
  if (!at) PetscFunctionReturn(PETSC_SUCCESS);
  end = strchr(at, '\n');
  PetscCall(PetscMalloc1(strlen(*text) + sizeof(name) + 1, &longer));
  (void)sprintf(longer, "%.*s%s%s", (int)(at - *text) + (int)strlen(line), *text, name, end ? end : "");
  PetscCall(PetscFree(*text));
  *text = longer;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* options.opts, which names the copies of the files that the run has read. */
static PetscErrorCode DescribeOptions(Output output)
{
  char    *text;
  PetscInt count;

  PetscFunctionBegin;
  PetscCall(PetscStrallocpy(output->options, &text));
  for (const OptionNote *note = OptionsNoted(&count), *last = note + count; note < last; note++)
    if (note->row.kind == ROW_FILE && note->given && note->value[0]) PetscCall(KeepInput(output, note, &text));
  PetscCall(OutputText(output, "options.opts", text));
  PetscCall(PetscFree(text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode DescribeRun(Output output, PetscBool same)
{
  char path[PETSC_MAX_PATH_LEN], version[4096];
  int  error = 0;

  PetscFunctionBegin;
  PetscCall(DescribeOptions(output));
  PetscCall(OutputPath(output, "version.txt", path));
  PetscCall(DescribeProgram(output, same, version, sizeof(version)));
  if (!output->rank) error = WriteText(path, same ? "a" : "w", version);
  PetscCall(FolderStatus(output, error, "write", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}
