/* Ends a run cleanly: a handler records the signals that would end the program, and the run checks for them and for
   -wall_clock_limit between steps and during long work. The limit counts from the start of the program. A run that
   gives no sign of life is ended by a timer, -wall_clock_silence. */
#define _DEFAULT_SOURCE 1 /* getloadavg */
#include "base.h"
#include <errno.h>
#include <fcntl.h>
#include <malloc.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static const struct {
  int         number;
  const char *name;
} Watched[] = {{SIGHUP, "SIGHUP"},   {SIGINT, "SIGINT"},   {SIGQUIT, "SIGQUIT"}, {SIGPIPE, "SIGPIPE"},
               {SIGTERM, "SIGTERM"}, {SIGUSR1, "SIGUSR1"}, {SIGXCPU, "SIGXCPU"}};

#define WATCHED     PETSC_STATIC_ARRAY_LENGTH(Watched)
#define SLOW        500000 /* us after a signal: without a check, it is confirmed; mpiexec kills after 1 s */
#define LEAST_HALF  1e-3   /* s: bounds of half the time of silence */
#define MOST_HALF   1e9
#define LARGE_ARRAY (1 << 23) /* bytes; the step's work arrays of small scenes stay on the heap, which is faster */
#define LOOK        1.0       /* s between two looks for the stop file */

#define CROWDED 0.5 /* programs more than processors */

static double                Load      = 0; /* mean number of running programs in the minute before the start */
static volatile sig_atomic_t Signalled = 0; /* 1 + index in Watched of the first signal; 0: none */
static PetscBool             Ignored[WATCHED];
static struct timespec       Start;
static double                Limit      = 0;           /* s; 0: none */
static PetscBool             KilledSoon = PETSC_FALSE; /* mpiexec kills the program a second after a signal */

/* Rank 0 keeps a timer. It rings in each half of the time of silence, and the second ring ends the run: a program that
   was stopped (Ctrl-Z, a debugger) for long hears one ring when it goes on, and has the other half for a sign of life.
   A signal sets the timer to SLOW. */
static struct {
  PetscBool             kept;
  struct itimerval      half;           /* 0: no end */
  volatile sig_atomic_t rung, answered; /* answered: the run knows of the signal, or the user does */
  char                  seconds[32];
  const char           *doing;
  char                  checkpoint[PETSC_MAX_PATH_LEN]; /* the last complete one; "": none */
} Timer = {.doing = "the set-up"};

/* On rank 0, which looks for it. */
static struct {
  char   path[PETSC_MAX_PATH_LEN]; /* "": none */
  double next;                     /* s */
} Stop;

/* Prints a line of up to eight texts on standard error and into the journal. Signal handlers call this: stdio is not
   safe there. */
static void Say(const char *const text[8])
{
  const int files[]                        = {STDERR_FILENO, JournalFile()};
  char      line[PETSC_MAX_PATH_LEN + 512] = "isph: ";

  for (size_t k = 0; k < 8 && text[k]; k++) strncat(line, text[k], sizeof(line) - strlen(line) - 2);
  strncat(line, "\n", 1);
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(files); k++)
    if (write(files[k], line, strlen(line)) < 0) continue;
}

/* The handler of the timer. The program may hang within MPI or within a write, so neither is waited for: the exit of
   rank 0 makes mpiexec end the other ranks. */
static void Ring(int number)
{
  const int         error = errno;
  const char *const last  = Timer.checkpoint[0] ? "; the last complete checkpoint is " : "; there is no checkpoint yet";

  if (Signalled && !Timer.answered) {
    Timer.answered = 1;
    Say((const char *const[8]){"received a signal: the run ends with a checkpoint after this step",
                               KilledSoon ? ", unless mpiexec sent the signal and kills the run in half a second: "
                                            "./isph " RANKS_OPTION " N in place of mpiexec gives it the time"
                                          : "",
                               last, Timer.checkpoint});
    (void)setitimer(ITIMER_REAL, &Timer.half, NULL);
  } else if (Timer.rung++) {
    (void)signal(number, SIG_DFL);
    (void)alarm(1); /* ends a write that hangs */
    Say((const char *const[8]){"error: there was no sign of life for ", Timer.seconds,
                               " s (-wall_clock_silence) during ", Timer.doing,
                               ": the network, a host or a disk may be gone, so start again on others", last,
                               Timer.checkpoint});
    _exit(1);
  }
  errno = error;
}

static void Record(int number)
{
  static double last[WATCHED];
  const int     error = errno;
  const double  now   = ProgramSeconds();

  if (!Signalled && number != SIGPIPE && Timer.kept)
    (void)setitimer(ITIMER_REAL, &(struct itimerval){.it_value.tv_usec = SLOW}, NULL);
  for (size_t k = 0; k < WATCHED; k++) {
    if (Watched[k].number != number) continue;
    if (!Signalled) Signalled = (sig_atomic_t)(k + 1);
    /* The second signal ends the program at once, but each print into a closed pipe raises SIGPIPE again. */
    if (last[k] > 0 && now - last[k] > SIGNAL_AGAIN && number != SIGPIPE) {
      (void)signal(number, SIG_DFL);
      (void)raise(number); /* it is blocked until this handler returns */
    }
    if (last[k] == 0) last[k] = now;
  }
  errno = error;
}

void InterruptWatch(void)
{
  struct sigaction action = {.sa_handler = Record, .sa_flags = SA_RESTART}; /* an interrupted write goes on */
  sigset_t         all;

  (void)sigemptyset(&all);
  for (size_t k = 0; k < WATCHED; k++) {
    if (Ignored[k])
      (void)signal(Watched[k].number, SIG_IGN);
    else
      (void)sigaction(Watched[k].number, &action, NULL);
    (void)sigaddset(&all, Watched[k].number);
  }
  (void)signal(SIGXFSZ, SIG_IGN); /* a write beyond the file-size limit then fails as on a full disk */
  (void)sigprocmask(SIG_UNBLOCK, &all, NULL);
}

void InterruptBlock(void)
{
  sigset_t all;

  (void)sigemptyset(&all);
  for (size_t k = 0; k < WATCHED; k++) (void)sigaddset(&all, Watched[k].number);
  (void)sigprocmask(SIG_BLOCK, &all, NULL);
}

/* Ranks and other programs want more processors than this host has: a rank that waits must leave its processor to
   another one, else a step takes ten or a hundred times as long. mpiexec sees to it only where its own count of places
   is exceeded. */
static void ShareProcessors(void)
{
  const char *const ranks = getenv("OMPI_COMM_WORLD_LOCAL_SIZE");

  (void)getloadavg(&Load, 1);
  if (ranks && (double)atol(ranks) + Load > (double)sysconf(_SC_NPROCESSORS_ONLN) + CROWDED)
    (void)setenv("OMPI_MCA_mpi_yield_when_idle", "1", 0);
}

PetscBool ProcessorsCrowded(double *load, int *processors)
{
  const char *const ranks = getenv("OMPI_COMM_WORLD_LOCAL_SIZE");

  *load       = Load;
  *processors = (int)sysconf(_SC_NPROCESSORS_ONLN);
  return (PetscBool)(ranks && atol(ranks) > 1 && (double)atol(ranks) + Load > *processors + CROWDED);
}

/* SuperLU_DIST, which PETSc loads, has told malloc to keep all on one heap that never shrinks, where an array that
   grows leaves a hole of its former size. */
static void GiveBackMemory(void)
{
#if defined(M_MMAP_MAX)
  (void)mallopt(M_MMAP_MAX, 1 << 16);
  (void)mallopt(M_MMAP_THRESHOLD, LARGE_ARRAY);
#endif
}

void DisplaysIgnore(void)
{
  (void)setenv("HWLOC_COMPONENTS", "-gl", 0);
}

void ProgramStart(void)
{
  (void)clock_gettime(CLOCK_MONOTONIC, &Start);
  GiveBackMemory();
  ShareProcessors();
  DisplaysIgnore();
  KilledSoon = (PetscBool) !!getenv("OMPI_COMM_WORLD_SIZE");
  /* A file of the run must not get the descriptor of a closed standard stream. */
  for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++)
    if (fcntl(fd, F_GETFD) < 0 && errno == EBADF) (void)open("/dev/null", fd == STDIN_FILENO ? O_RDONLY : O_WRONLY);
  for (size_t k = 0; k < WATCHED; k++) {
    struct sigaction before;

    Ignored[k] = (PetscBool)(!sigaction(Watched[k].number, NULL, &before) && before.sa_handler == SIG_IGN);
  }
  InterruptWatch();
}

double ProgramSeconds(void)
{
  struct timespec now;

  (void)clock_gettime(CLOCK_MONOTONIC, &now);
  if (!Start.tv_sec && !Start.tv_nsec) Start = now; /* within another program */
  return (double)(now.tv_sec - Start.tv_sec) + 1e-9 * (double)(now.tv_nsec - Start.tv_nsec);
}

void InterruptLimit(double seconds)
{
  Limit = seconds;
}

void InterruptPatience(void)
{
  KilledSoon = PETSC_FALSE;
}

void InterruptStopFile(const char path[])
{
  PetscMPIInt rank = 0;

  (void)MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank) return;
  (void)unlink(path);
  (void)snprintf(Stop.path, sizeof(Stop.path), "%s", path);
}

/* Whether the stop file has appeared. It is removed, so that the next run in the folder is not ended, too. */
static PetscBool StopWanted(double now)
{
  if (!Stop.path[0] || now < Stop.next) return PETSC_FALSE;
  Stop.next = now + LOOK;
  return (PetscBool)!unlink(Stop.path);
}

PetscErrorCode InterruptCheck(MPI_Comm comm, PetscBool *wanted, const char **reason)
{
  const double now     = ProgramSeconds();
  PetscInt     what[4] = {Signalled, Limit > 0 && now > Limit, wanted && *wanted, StopWanted(now)};

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, what, 4, MPIU_INT, MPI_MAX, comm));
  Timer.answered = what[0] > 0;
  InterruptAlive(NULL);
  if (wanted) *wanted = (PetscBool)(what[2] > 0);
  *reason = what[0] ? Watched[what[0] - 1].name : what[1] ? "-wall_clock_limit" : what[3] ? "the stop file" : NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

void InterruptSilence(double seconds)
{
  const double     half   = seconds > 0 ? PetscMin(PetscMax(seconds / 2, LEAST_HALF), MOST_HALF) : 0;
  struct sigaction action = {.sa_handler = Ring, .sa_flags = SA_RESTART | SA_NODEFER};
  sigset_t         own;
  PetscMPIInt      rank = 0;

  if (half == 0 && !Timer.kept) return; /* another program may have a timer of its own */
  (void)MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  Timer.kept = (PetscBool)!rank;
  if (rank) return; /* rank 0 works alone at times, while the others wait */
  (void)snprintf(Timer.seconds, sizeof(Timer.seconds), "%g", seconds);
  Timer.half.it_value.tv_sec  = (time_t)half;
  Timer.half.it_value.tv_usec = (suseconds_t)(1e6 * (half - floor(half)));
  Timer.half.it_interval      = Timer.half.it_value;
  (void)sigaction(SIGALRM, &action, NULL);
  (void)sigemptyset(&own);
  (void)sigaddset(&own, SIGALRM);
  (void)sigprocmask(SIG_UNBLOCK, &own, NULL);
  (void)setitimer(ITIMER_REAL, &Timer.half, NULL);
}

void InterruptAlive(const char doing[])
{
  if (doing) Timer.doing = doing;
  Timer.rung = 0;
  if (Signalled && !Timer.answered) return; /* its ring is to come */
  if (Timer.half.it_value.tv_sec || Timer.half.it_value.tv_usec) (void)setitimer(ITIMER_REAL, &Timer.half, NULL);
}

void InterruptCheckpoint(const char path[])
{
  (void)snprintf(Timer.checkpoint, sizeof(Timer.checkpoint), "%s", path);
}
