/* The lock of a run folder: a file that rank 0 holds with a lock of the operating system. The lock ends with the
   process, however that ends. It keeps two runs out of one folder, and its absence shows that the folder was removed.
   On a file system without locks it shows the latter only. */
#include "output_impl.h"
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define LOCK_FILE    "run.lock"
#define OWNER_LENGTH 384 /* bytes of the text in it */

/* The lock that this process holds. */
static struct {
  char path[PETSC_MAX_PATH_LEN];
  int  file;
} Held = {"", -1};

/* Whether the lock still lies where it was made. */
static PetscBool HeldThere(void)
{
  struct stat own, there;

  return (PetscBool)(!fstat(Held.file, &own) && !stat(Held.path, &there) && own.st_dev == there.st_dev &&
                     own.st_ino == there.st_ino);
}

static void Release(void)
{
  if (Held.file < 0) return;
  if (HeldThere()) (void)unlink(Held.path);
  (void)close(Held.file);
  Held.file = -1;
}

/* Writes who has the lock, for the message of a run that finds it. Returns an errno. */
static int WriteOwner(void)
{
  const time_t now       = time(NULL);
  char         host[256] = "", date[32] = "", text[OWNER_LENGTH];
  struct tm    moment;
  int          length;

  (void)gethostname(host, sizeof(host) - 1);
  if (gmtime_r(&now, &moment)) (void)strftime(date, sizeof(date), "%Y-%m-%d %H:%M:%S UTC", &moment);
  length = snprintf(text, sizeof(text), "process %ld on %s, since %s", (long)getpid(), host, date);
  errno  = 0;
  return ftruncate(Held.file, 0) || write(Held.file, text, (size_t)length) != length ? (errno ? errno : ENOSPC) : 0;
}

/* Rank 0: takes the lock. Returns an errno, EAGAIN if another process has it: owner ([OWNER_LENGTH]) says who. */
static int Take(const char path[], char owner[])
{
  static PetscBool registered = PETSC_FALSE;
  struct flock     whole      = {.l_type = F_WRLCK, .l_whence = SEEK_SET};

  if (!registered) (void)atexit(Release);
  registered = PETSC_TRUE;
  (void)snprintf(Held.path, sizeof(Held.path), "%s", path);
  do { /* again if the former owner removed the file in between */
    if (Held.file >= 0) (void)close(Held.file);
    Held.file = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, S_IRUSR | S_IWUSR | S_IRGRP | S_IROTH);
    if (Held.file < 0) return errno;
    if (fcntl(Held.file, F_SETLK, &whole) && (errno == EAGAIN || errno == EACCES)) {
      const ssize_t length = read(Held.file, owner, OWNER_LENGTH - 1);

      owner[PetscMax(length, 0)] = 0;
      (void)close(Held.file);
      Held.file = -1;
      return EAGAIN;
    }
  } while (!HeldThere());
  return WriteOwner();
}

/* The lowest rank that does not see the file, or the number of ranks. Rank 0 must not close it: that would end its
   lock. */
static PetscErrorCode Blind(Output output, const char path[], PetscMPIInt *first)
{
  const int file = output->rank ? open(path, O_RDONLY | O_CLOEXEC) : Held.file;

  PetscFunctionBegin;
  *first = file < 0 ? output->rank : output->size;
  if (file >= 0 && output->rank) (void)close(file);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, first, 1, MPI_INT, MPI_MIN, output->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FolderLock(Output output)
{
  char        path[PETSC_MAX_PATH_LEN], owner[OWNER_LENGTH] = "";
  PetscMPIInt first;
  int         error = 0;

  PetscFunctionBegin;
  PetscCall(OutputPath(output, LOCK_FILE, path));
  if (!output->rank) error = Take(path, owner);
  PetscCallMPI(MPI_Bcast(&error, 1, MPI_INT, 0, output->comm));
  PetscCallMPI(MPI_Bcast(owner, sizeof(owner), MPI_CHAR, 0, output->comm));
  PetscCheckUser(error != EAGAIN, output->comm,
                 "In the folder %s another run is going on: %s; choose another -output_dir", output->folder, owner);
  PetscCall(FolderStatus(output, error, "make", path));
  output->locked = PETSC_TRUE;
  PetscCall(Blind(output, path, &first));
  PetscCheckUser(first == output->size, output->comm,
                 "Rank %d does not see %s, which rank 0 has made: the folder must be on a file system that all share.",
                 first, path);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FolderUnlock(Output output)
{
  PetscFunctionBegin;
  if (output->locked && !output->rank) Release();
  output->locked = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FolderStands(Output output)
{
  int there = 1;

  PetscFunctionBegin;
  if (!output->rank) there = HeldThere();
  PetscCallMPI(MPI_Bcast(&there, 1, MPI_INT, 0, output->comm));
  PetscCheckUser(there, output->comm,
                 "The folder %s was removed or moved while the run goes on, or its " LOCK_FILE
                 " was: nothing more can be written.",
                 output->folder);
  PetscFunctionReturn(PETSC_SUCCESS);
}
