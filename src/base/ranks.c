/* isph -ranks N ...: the program starts itself by mpiexec on N processes. Open MPI's mpiexec answers Ctrl-C, SIGTERM
   and SIGHUP by a SIGTERM to the ranks one second later and a SIGKILL after another, which is too soon for a checkpoint
   after a long step; SIGUSR1 it forwards at once and goes on (mpirun(1), signal propagation). So it runs in a session
   of its own, where the terminal's signals do not reach it, and gets SIGUSR1 for each of them. */
#include "base.h"
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#ifdef __linux__
  #include <sys/prctl.h>
#endif

static const int Ends[]    = {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGUSR1, SIGXCPU};
static const int Suspend[] = {SIGTSTP, SIGCONT};

static volatile sig_atomic_t Child = 0; /* mpiexec */

/* A handler. One signal may come twice, from the shell and from the terminal: the second counts a while later. */
static void PassOn(int number)
{
  static const char said[] = "\nisph: the run ends with a checkpoint after this step; once more ends it at once\n";
  static double     last   = 0;
  const int         error  = errno;
  const double      now    = ProgramSeconds();
  const PetscBool   first  = (PetscBool)(last == 0);

  if (first || now - last > SIGNAL_AGAIN) {
    (void)kill((pid_t)Child, SIGUSR1);
    if (first && write(STDERR_FILENO, said, sizeof(said) - 1) < 0) errno = error;
    last = now;
  }
  errno = error;
}

/* A handler of Ctrl-Z, and of what follows it; a closing terminal sends SIGCONT, too. */
static void PassSuspension(int number)
{
  static sig_atomic_t suspended = 0;
  const int           error     = errno;

  if (number == SIGTSTP || suspended) (void)kill((pid_t)Child, number);
  suspended = number == SIGTSTP;
  if (suspended) (void)raise(SIGSTOP);
  errno = error;
}

static void Handle(const int signals[], size_t n, void (*handler)(int))
{
  struct sigaction action = {.sa_flags = SA_RESTART}, before;

  action.sa_handler = handler;
  for (size_t k = 0; k < n; k++)
    if (!sigaction(signals[k], NULL, &before) && before.sa_handler != SIG_IGN)
      (void)sigaction(signals[k], &action, NULL);
}

/* What the child does: it becomes mpiexec. If this program is killed, mpiexec gets SIGUSR1, too. */
static void Become(char *words[])
{
  (void)setsid();
#ifdef __linux__
  (void)prctl(PR_SET_PDEATHSIG, SIGUSR1);
#endif
  (void)setenv("OMPI_MCA_rmaps_base_oversubscribe", "1",
               0); /* the user has said how many; ProgramStart lets them share */
  if (!freopen("/dev/null", "r", stdin)) _exit(2);
  (void)execvp(words[0], words);
  fprintf(stderr, "isph: error: -ranks needs mpiexec: %s\n", strerror(errno));
  _exit(2);
}

/* Moves -ranks and its number to the end of the command line, since options files come first; the number as it was
   given, NULL: not one that needs mpiexec. */
static char *Wanted(int argc, char *argv[])
{
  char *number = NULL, *end;

  for (int k = argc - 2; k > 0 && !number; k--) {
    char *option = argv[k];

    if (strcmp(option, RANKS_OPTION)) continue;
    number = argv[k + 1];
    memmove(argv + k, argv + k + 2, (size_t)(argc - k - 2) * sizeof(*argv));
    argv[argc - 2] = option;
    argv[argc - 1] = number;
  }
  return number && strtol(number, &end, 10) > 1 && !*end ? number : NULL;
}

int RanksLaunch(int argc, char *argv[])
{
  static char mpiexec[] = "mpiexec", n[] = "-n";
  char       *number = Wanted(argc, argv), **words;
  int         status = 0;

  if (!number || getenv("OMPI_COMM_WORLD_SIZE") || getenv("PMI_SIZE") || getenv("PMIX_RANK")) return -1;
  words = malloc(((size_t)argc + 4) * sizeof(*words));
  if (!words) return -1;
  words[0] = mpiexec, words[1] = n, words[2] = number;
  memcpy(words + 3, argv, ((size_t)argc + 1) * sizeof(*words)); /* -ranks included, which the ranks compare */
  Child = (sig_atomic_t)fork();
  if (Child == 0) Become(words);
  Handle(Ends, PETSC_STATIC_ARRAY_LENGTH(Ends), PassOn);
  Handle(Suspend, PETSC_STATIC_ARRAY_LENGTH(Suspend), PassSuspension);
  while (Child > 0 && waitpid((pid_t)Child, &status, 0) < 0 && errno == EINTR) {
  }
  free(words);
  if (Child < 0 || WIFSIGNALED(status))
    fprintf(stderr, "isph: error: mpiexec %s\n", Child < 0 ? "cannot be started" : strsignal(WTERMSIG(status)));
  return Child > 0 && WIFEXITED(status) ? WEXITSTATUS(status) : 2;
}
