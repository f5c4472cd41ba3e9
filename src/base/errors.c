/* How errors are told: bad input by a sentence at once, what else PETSc finds by one at the end of the program, with
   the calls that led to it instead of PETSc's trace. */
#include "base.h"
#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define MESSAGE_LENGTH 1024
#define PATIENCE       10. /* s that a rank which failed waits for the others */
#define NAP            10  /* ms between two looks */

static PetscBool UserErrorRaised = PETSC_FALSE; /* UserError has printed its sentence and its code is on its way up */
static PetscBool Held            = PETSC_FALSE; /* user errors are not printed */
static PetscBool Keeping         = PETSC_FALSE; /* errors of PETSc's are kept for the caller */
static char      Kept[MESSAGE_LENGTH];
static char      Last[MESSAGE_LENGTH];      /* the sentence of the last error, and the calls that led to it */
static PetscBool Said      = PETSC_FALSE;   /* it has been printed here */
static MPI_Comm  Farewells = MPI_COMM_NULL; /* where ranks meet that failed */

PetscErrorCode ListNames(PetscFunctionList list, char names[NAMES_LENGTH])
{
  const char **array;
  int          count;

  PetscFunctionBegin;
  names[0] = 0;
  PetscCall(PetscFunctionListGet(list, &array, &count));
  for (int k = 0; k < count && array[k]; k++) { /* PETSc counts the end too */
    if (k) PetscCall(PetscStrlcat(names, ", ", NAMES_LENGTH));
    PetscCall(PetscStrlcat(names, array[k], NAMES_LENGTH));
  }
  PetscCall(PetscFree(array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One line on standard error; what a user typed may hold characters that a terminal would obey. */
static void Say(const char message[])
{
  char line[MESSAGE_LENGTH + 32];

  (void)snprintf(line, sizeof(line), "isph: error: %s", message);
  for (char *c = line; *c; c++)
    if (iscntrl((unsigned char)*c)) *c = '?';
  PrinterBreak();
  fprintf(stderr, "%s\n", line);
  fflush(stderr);
  JournalText(line);
  JournalText("\n");
  Said = PETSC_TRUE;
}

/* Rank 0 speaks for all; the others keep the sentence, in case that rank 0 has no error. */
static void SayOnce(MPI_Comm comm)
{
  PetscMPIInt rank = 0;

  (void)MPI_Comm_rank(comm, &rank);
  Said = PETSC_FALSE;
  if (!rank && !Held) Say(Last);
}

PetscErrorCode UserError(MPI_Comm comm, const char format[], ...)
{
  va_list arguments;

  va_start(arguments, format);
  (void)vsnprintf(Last, sizeof(Last), format, arguments);
  va_end(arguments);
  SayOnce(comm);
  UserErrorRaised = PETSC_TRUE;
  return ISPH_USER_ERROR; /* bare: PetscError() would print a trace */
}

PetscErrorCode UserErrorSaid(void)
{
  UserErrorRaised = Said = PETSC_TRUE;
  return ISPH_USER_ERROR;
}

void UserErrorsHold(PetscBool hold)
{
  Held = hold;
}

void ErrorsKeep(PetscBool keep)
{
  if (keep) Kept[0] = 0;
  Keeping = keep;
}

const char *ErrorKept(void)
{
  return Kept;
}

/* Keeps the first line of an error, or what its code means. */
static PetscBool Keep(PetscErrorCode code, const char message[])
{
  const char *text = message;

  if (!Keeping) return PETSC_FALSE;
  if (!text || !*text) (void)PetscErrorMessage(code, &text, NULL);
  (void)snprintf(Kept, sizeof(Kept), "%.*s", text ? (int)strcspn(text, "\n") : 0, text ? text : "");
  return PETSC_TRUE;
}

/* Whether 'word' is one of the words of 'text', which are separated by one of 'separators'. */
static PetscBool HasWord(const char text[], const char word[], size_t length, const char separators[])
{
  for (const char *p = text; *p; p += strcspn(p, separators), p += strspn(p, separators))
    if (strcspn(p, separators) == length && !strncmp(p, word, length)) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* The option of the database that PETSc's complaint is about, as " (-name value)": one whose value, or a number of it,
   the complaint cites; empty if there is none. */
static void FindOption(const char complaint[], char option[], size_t length)
{
  char *all = NULL;

  option[0] = 0;
  if (PetscOptionsGetAll(NULL, &all)) return;
  for (const char *name = all; *name && !option[0];) {
    const size_t name_end = strcspn(name, " ");
    const char  *value    = name + name_end + strspn(name + name_end, " ");

    const size_t value_end = strcspn(value, " ");
    PetscBool    cited     = HasWord(complaint, value, value_end, " ");

    for (size_t at = 0; at < value_end && !cited; at += strcspn(value + at, ", ") + 1)
      cited = HasWord(complaint, value + at, strcspn(value + at, ", "), " ");
    if (*name == '-' && value_end && cited)
      (void)snprintf(option, length, " (%.*s)", (int)(value + value_end - name), name);
    name = value;
  }
  (void)PetscFree(all);
}

/* Values of options that PETSc itself cannot read or does not know: one sentence, as for the program's own checks. */
static PetscBool ReportBadValue(const char function[], PetscErrorCode code, const char message[])
{
  char option[256];

  if (!message || !function) return PETSC_FALSE;
  if (strncmp(function, "PetscOptionsStringTo", 20) && strncmp(function, "PetscOptionsGetE", 16) &&
      strncmp(function, "PetscOptionsInsert", 18) && strncmp(function, "PetscOptionsSetValue", 20) &&
      code != PETSC_ERR_ARG_UNKNOWN_TYPE)
    return PETSC_FALSE;
  if (strstr(function, "YAML"))
    (void)snprintf(option, sizeof(option), ": an options file whose name ends in .yaml or .yml is not YAML");
  else
    FindOption(message, option, sizeof(option));
  (void)snprintf(Last, sizeof(Last), "%s%.*s%s",
                 strncmp(function, "PetscOptionsSetValue", 20) ? ""
                                                               : "there are more options than PETSc has room for: ",
                 (int)strcspn(message, "\n"), message, option);
  SayOnce(PETSC_COMM_WORLD);
  return PETSC_TRUE;
}

/* No memory: the rank that has none says so and ends all, since the others wait for it. PETSc 3.18 knows it by the
   function only, the code is another. */
static PetscBool ReportMemory(const char function[], PetscErrorCode code)
{
  static const char message[] = "out of memory: take a larger -spacing, a smaller box or more machines";
  PetscMPIInt       size      = 1;

  if (function && !strncmp(function, "PetscOptions", 12)) return PETSC_FALSE; /* has room for so many */
  if (code != PETSC_ERR_MEM &&
      (!function || (strcmp(function, "PetscMallocAlign") && strcmp(function, "PetscReallocAlign"))))
    return PETSC_FALSE;
  Say(message);
  (void)MPI_Comm_size(PETSC_COMM_WORLD, &size);
  if (size > 1) (void)MPI_Abort(PETSC_COMM_WORLD, 1);
  return PETSC_TRUE;
}

/* An error that starts anew is PETSc's, and so are its repeats, one a PetscCall on the way up: the calls. Those of a
   user error say nothing. A PetscCall in main, of a test, ends the program. */
static PetscErrorCode UserErrorHandler(MPI_Comm comm, int line, const char *function, const char *file,
                                       PetscErrorCode code, PetscErrorType type, const char *message, void *context)
{
  const char *text = message;
  size_t      used;

  if (type == PETSC_ERROR_INITIAL) {
    UserErrorRaised =
      (PetscBool)(ReportMemory(function, code) || Keep(code, message) || ReportBadValue(function, code, message));
    if (UserErrorRaised) return code;
    if (!text || !*text) (void)PetscErrorMessage(code, &text, NULL);
    (void)snprintf(Last, sizeof(Last), "PETSc says \"%.*s\" (error %d in %s, line %d of %s",
                   text ? (int)strcspn(text, "\n") : 0, text ? text : "", (int)code, function, line, file);
    Said = PETSC_FALSE;
  } else if (!UserErrorRaised) {
    used = strlen(Last);
    (void)snprintf(Last + used, sizeof(Last) - used, " < %s", function);
  }
  if (!UserErrorRaised && function && !strcmp(function, "main")) Say(Last);
  return code;
}

PetscErrorCode UserErrorHandlerPush(void)
{
  PetscFunctionBeginUser;
  PetscCall(PetscPushErrorHandler(UserErrorHandler, NULL));
  PetscCallMPI(MPI_Comm_dup(MPI_COMM_WORLD, &Farewells));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RanksMeet(MPI_Comm meeting, PetscBool failed, PetscMPIInt *first, PetscMPIInt *all)
{
  const struct timespec nap = {.tv_nsec = NAP * 1000000L};
  PetscMPIInt           rank, size, own;
  MPI_Request           request;
  const double          start = ProgramSeconds();

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(meeting, &rank));
  PetscCallMPI(MPI_Comm_size(meeting, &size));
  own = failed ? rank : size;
  PetscCallMPI(MPI_Iallreduce(&own, first, 1, MPI_INT, MPI_MIN, meeting, &request));
  *all = 0;
  if (!failed) {
    PetscCallMPI(MPI_Wait(&request, MPI_STATUS_IGNORE));
    *all = 1;
  }
  while (!*all && ProgramSeconds() < start + PATIENCE) {
    PetscCallMPI(MPI_Test(&request, all, MPI_STATUS_IGNORE));
    if (!*all) (void)nanosleep(&nap, NULL);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

int ErrorFarewell(PetscErrorCode code)
{
  PetscMPIInt first = 0, all = 1, rank = 0;

  if (code && !UserErrorRaised && Last[0]) (void)snprintf(Last + strlen(Last), sizeof(Last) - strlen(Last), ")");
  if (code && !Last[0]) (void)snprintf(Last, sizeof(Last), "PETSc could not start or end (error %d)", (int)code);
  (void)MPI_Comm_rank(Farewells, &rank);
  if (code && !rank && !Said) Say(Last);
  if (code) (void)RanksMeet(Farewells, PETSC_TRUE, &first, &all);
  if (code && rank && !all && !Said) Say(Last);
  if (!all) (void)MPI_Abort(MPI_COMM_WORLD, 1);
  (void)MPI_Comm_free(&Farewells);
  return code ? 1 : 0;
}
