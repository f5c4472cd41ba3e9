/* The run folder and the files in it. */
#include "output_impl.h"
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <sys/stat.h>
#include <unistd.h>

/* Files of a run besides the numbered ones. */
static const char *const files[]    = {OUTPUT_SERIES, "snapshots.xdmf", "options.opts",      "version.txt", "solids.h5",
                                       "log.txt",     OUTPUT_SCENE,     CHECKPOINT_BY_CLOCK, NULL};
static const char *const numbered[] = {"snapshot_", "checkpoint_", NULL};

PetscErrorCode OutputPath(Output output, const char name[], char path[PETSC_MAX_PATH_LEN])
{
  size_t length, more;

  PetscFunctionBegin;
  PetscCall(PetscStrlen(output->folder, &length));
  PetscCall(PetscStrlen(name, &more));
  PetscCheck(length + more + 2 <= PETSC_MAX_PATH_LEN, PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE, "Path too long: %s/%s",
             output->folder, name);
  PetscCall(PetscSNPrintf(path, PETSC_MAX_PATH_LEN, "%s/%s", output->folder, name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

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

PetscErrorCode FolderNumbers(const char path[], const char prefix[], PetscInt *count, PetscInt **numbers)
{
  DIR           *folder = opendir(path);
  struct dirent *file;
  PetscInt       n = 0, capacity = 0, *list = NULL;

  PetscFunctionBegin;
  while (folder && (file = readdir(folder))) {
    const PetscInt number = NumberOf(file->d_name, prefix, PETSC_FALSE);

    if (number < 0) continue;
    PetscCall(ListGrow(n, &capacity, sizeof(*list), &list));
    list[n++] = number;
  }
  if (folder) closedir(folder);
  PetscCall(PetscSortInt(n, list));
  *count   = n;
  *numbers = list;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a name is that of a file, or of this file while it is written. */
static PetscBool IsFile(const char name[], const char file[])
{
  const size_t length = strlen(file);

  return (PetscBool)(!strncmp(name, file, length) && (!name[length] || !strcmp(name + length, ".tmp")));
}

static PetscBool IsOurs(const char name[])
{
  const char *table;

  for (PetscInt f = 0; files[f]; f++)
    if (IsFile(name, files[f])) return PETSC_TRUE;
  for (PetscInt t = 0; (table = GaugesTableFile(t)); t++)
    if (IsFile(name, table)) return PETSC_TRUE;
  for (PetscInt f = 0; numbered[f]; f++) {
    if (NumberOf(name, numbered[f], PETSC_FALSE) >= 0 || NumberOf(name, numbered[f], PETSC_TRUE) >= 0)
      return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* Counts the files that show that the folder holds a run; with 'removing', removes all that a run writes. Rank 0 only;
   returns an errno. */
static int Sweep(Output output, PetscBool removing, PetscInt *found)
{
  DIR           *folder = opendir(output->folder);
  struct dirent *file;
  char           path[PETSC_MAX_PATH_LEN];

  *found = 0;
  if (!folder) return errno;
  while ((file = readdir(folder))) {
    const char *name = file->d_name;

    if (!strcmp(name, files[0]) || !strcmp(name, CHECKPOINT_BY_CLOCK) ||
        NumberOf(name, numbered[0], PETSC_FALSE) >= 0 || NumberOf(name, numbered[1], PETSC_FALSE) >= 0)
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

PetscErrorCode FolderClear(Output output)
{
  PetscInt found = 0;
  int      error = 0;

  PetscFunctionBegin;
  if (!output->rank) error = Sweep(output, PETSC_FALSE, &found);
  PetscCall(FolderStatus(output, error, "read the folder", output->folder));
  PetscCallMPI(MPI_Bcast(&found, 1, MPIU_INT, 0, output->comm));
  PetscCheckUser(!found || output->overwrite, output->comm,
                 "The folder %s holds a run already; choose another -output_dir, continue it with -restart, or "
                 "replace it with -output_overwrite.",
                 output->folder);
  if (!output->rank && output->overwrite) error = Sweep(output, PETSC_TRUE, &found);
  PetscCall(FolderStatus(output, error, "remove the earlier run in", output->folder));
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
  TextAppend(path, sizeof(path), ".tmp");
  if (!output->rank) (void)unlink(path);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FolderHolds(Output output, const char file[], PetscBool *same)
{
  char        path[PETSC_MAX_PATH_LEN], *slash;
  struct stat here, there;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(path, file, sizeof(path)));
  slash = strrchr(path, '/');
  if (slash) slash[slash == path] = '\0';
  *same = (PetscBool)(!stat(slash ? path : ".", &there) && !stat(output->folder, &here) &&
                      here.st_dev == there.st_dev && here.st_ino == there.st_ino);
  PetscCallMPI(MPI_Bcast(same, 1, MPIU_BOOL, 0, output->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}
