/* The lock of a run folder: a file that names the process of rank 0. Two runs do not write into one folder, and a
   folder that vanishes is noticed, since its lock is gone, too. */
#include "output_impl.h"
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define LOCK_FILE   "run.lock"
#define HOST_LENGTH 256
#define DATE_LENGTH 32

/* What stands in the file. start: of the process, in the kernel's ticks, 0 where that is unknown: numbers of processes
   are used again. */
typedef struct {
  char               host[HOST_LENGTH], date[DATE_LENGTH];
  long               process;
  unsigned long long start;
} Owner;

typedef enum { LOCK_MADE, LOCK_TAKEN_OVER, LOCK_HELD, LOCK_FAILED } LockVerdict;

/* The lock that this process holds; open as long as it is, so that no other file gets its number in the file system. */
static struct {
  char  path[PETSC_MAX_PATH_LEN];
  int   file;
  pid_t process;
} Held = {"", -1, 0};

/* Whether the lock still lies where it was made. */
static PetscBool HeldThere(void)
{
  struct stat own, there;

  return (PetscBool)(!fstat(Held.file, &own) && !stat(Held.path, &there) && own.st_dev == there.st_dev &&
                     own.st_ino == there.st_ino);
}

static void Release(void)
{
  if (Held.file < 0 || Held.process != getpid()) return;
  if (HeldThere()) (void)unlink(Held.path);
  (void)close(Held.file);
  Held.file = -1;
}

/* Whether a process of this machine runs; *start: see Owner. What cannot be known is taken to run. */
static PetscBool Runs(long process, unsigned long long *start)
{
  char  path[64], text[1024] = "", state = 0;
  FILE *file;

  *start = 0;
  if (kill((pid_t)process, 0) && errno == ESRCH) return PETSC_FALSE;
  (void)snprintf(path, sizeof(path), "/proc/%ld/stat", process);
  file = fopen(path, "r");
  if (!file) return PETSC_TRUE;
  if (fgets(text, sizeof(text), file) && strrchr(text, ')')) /* behind the name, which may hold anything */
    (void)sscanf(strrchr(text, ')') + 1,
                 " %c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %*u %*u %*d %*d %*d %*d %*d %*d %llu", &state, start);
  fclose(file);
  return (PetscBool)(state != 'Z' && state != 'X');
}

static void OwnerSelf(Owner *owner)
{
  const time_t now = time(NULL);
  struct tm    moment;

  memset(owner, 0, sizeof(*owner));
  if (gethostname(owner->host, sizeof(owner->host) - 1) || !owner->host[0])
    (void)snprintf(owner->host, sizeof(owner->host), "unknown");
  if (gmtime_r(&now, &moment)) (void)strftime(owner->date, sizeof(owner->date), "%Y-%m-%d %H:%M:%S UTC", &moment);
  owner->process = (long)getpid();
  (void)Runs(owner->process, &owner->start);
}

/* Whether the file says who made it. */
static PetscBool OwnerRead(const char path[], Owner *owner)
{
  FILE     *file = fopen(path, "r");
  PetscBool whole;

  memset(owner, 0, sizeof(*owner));
  if (!file) return PETSC_FALSE;
  whole = (PetscBool)(fscanf(file, "host %255s process %ld start %llu since %31[^\n]", owner->host, &owner->process,
                             &owner->start, owner->date) == 4 &&
                      owner->process > 0);
  fclose(file);
  return whole;
}

static PetscBool OwnerDead(const Owner *owner, const Owner *self)
{
  unsigned long long start;

  if (strcmp(owner->host, self->host)) return PETSC_FALSE; /* nobody knows */
  return (PetscBool)(!Runs(owner->process, &start) || (start && owner->start && start != owner->start));
}

/* Makes the file, of one piece or not at all. Returns an errno. */
static int Make(const char path[], const Owner *self)
{
  const int file = open(path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR | S_IRGRP | S_IROTH);
  char      text[HOST_LENGTH + DATE_LENGTH + 128];
  int       length, error = 0;

  if (file < 0) return errno;
  length = snprintf(text, sizeof(text), "host %s\nprocess %ld\nstart %llu\nsince %s\n", self->host, self->process,
                    self->start, self->date);
  errno  = 0;
  if (write(file, text, (size_t)length) != length) error = errno ? errno : ENOSPC;
  if (error) {
    (void)unlink(path);
    (void)close(file);
    return error;
  }
  (void)snprintf(Held.path, sizeof(Held.path), "%s", path);
  Held.file    = file;
  Held.process = getpid();
  return 0;
}

/* Rank 0. *error: an errno for LOCK_FAILED; other: who has, or had, the lock. */
static LockVerdict Take(const char folder[], const char path[], Owner *other, int *error)
{
  static PetscBool registered = PETSC_FALSE;
  const int        guard      = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  LockVerdict      verdict    = LOCK_MADE;
  Owner            self;

  OwnerSelf(&self);
  if (!registered) (void)atexit(Release);
  registered = PETSC_TRUE;
  if (guard >= 0) (void)flock(guard, LOCK_EX); /* two that find a dead one's lock take it over one after the other */
  *error = Make(path, &self);
  if (*error == EEXIST) {
    verdict = LOCK_HELD;
    if (OwnerRead(path, other) && OwnerDead(other, &self)) {
      verdict = LOCK_TAKEN_OVER;
      *error  = unlink(path) ? errno : Make(path, &self);
    }
  }
  if (guard >= 0) (void)close(guard);
  return *error && verdict != LOCK_HELD ? LOCK_FAILED : verdict;
}

/* The lowest rank that does not see the file, or their number. A file system tells of new files when one is opened. */
static PetscErrorCode Blind(Output output, const char path[], PetscMPIInt *first)
{
  const int file = open(path, O_RDONLY | O_CLOEXEC);

  PetscFunctionBegin;
  *first = file < 0 ? output->rank : output->size;
  if (file >= 0) (void)close(file);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, first, 1, MPI_INT, MPI_MIN, output->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FolderLock(Output output)
{
  char        path[PETSC_MAX_PATH_LEN];
  Owner       other   = {.process = 0};
  LockVerdict verdict = LOCK_MADE;
  PetscMPIInt first;
  int         error = 0;

  PetscFunctionBegin;
  PetscCall(OutputPath(output, LOCK_FILE, path));
  if (!output->rank) verdict = Take(output->folder, path, &other, &error);
  PetscCallMPI(MPI_Bcast(&verdict, sizeof(verdict), MPI_BYTE, 0, output->comm));
  PetscCallMPI(MPI_Bcast(&other, sizeof(other), MPI_BYTE, 0, output->comm));
  PetscCall(FolderStatus(output, verdict == LOCK_FAILED ? error : 0, "make", path));
  PetscCheckUser(verdict != LOCK_HELD || other.process, output->comm,
                 "The folder %s has a lock that says nothing, %s; if no run is going on there, remove it.",
                 output->folder, path);
  PetscCheckUser(
    verdict != LOCK_HELD, output->comm,
    "In the folder %s another run is going on: process %ld on %s, since %s; choose another -output_dir, or "
    "remove %s if that one is dead.",
    output->folder, other.process, other.host, other.date, path);
  output->locked = PETSC_TRUE;
  if (verdict == LOCK_TAKEN_OVER)
    PetscCall(PetscPrintf(output->comm,
                          "The run of %s in %s, process %ld, has died without its end; its lock is taken over.\n",
                          other.date, output->folder, other.process));
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
