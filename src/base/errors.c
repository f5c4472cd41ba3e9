/* Error messages. Bad input gives one sentence at once. Any other error gives one sentence at the end of the program,
   with the chain of calls instead of PETSc's trace. */
#include "base.h"
#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define MESSAGE_LENGTH 1024
#define PATIENCE       10. /* s for which a failed rank waits for the others */
#define NAP            10  /* ms between two tests whether the others have come */

static PetscBool UserErrorRaised = PETSC_FALSE; /* the code of a printed UserError is travelling up to main */
static PetscBool Muted           = PETSC_FALSE; /* see UserErrorsMute */
static PetscBool Capturing       = PETSC_FALSE; /* see ErrorsCapture */
static char      Captured[MESSAGE_LENGTH];
static char      LastError[MESSAGE_LENGTH]; /* its sentence and the chain of calls */
static PetscBool Said    = PETSC_FALSE;     /* this rank has printed LastError */
static MPI_Comm  Meeting = MPI_COMM_NULL;   /* for RanksMeet in ErrorFinish */

/* Prints one line on standard error. Control characters in a user's text would act on the terminal, so they become
   '?'. */
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

/* Rank 0 prints for all; the other ranks keep the sentence, since rank 0 may not have the error. */
static void SayOnce(MPI_Comm comm)
{
  PetscMPIInt rank = 0;

  (void)MPI_Comm_rank(comm, &rank);
  Said = PETSC_FALSE;
  if (!rank && !Muted) Say(LastError);
}

PetscErrorCode UserError(MPI_Comm comm, const char format[], ...)
{
  va_list arguments;

  va_start(arguments, format);
  (void)vsnprintf(LastError, sizeof(LastError), format, arguments);
  va_end(arguments);
  SayOnce(comm);
  UserErrorRaised = PETSC_TRUE;
  return ISPH_USER_ERROR; /* bare: PetscError() would print a trace */
}

void TextAppend(char text[], size_t size, const char more[])
{
  const size_t used = strlen(text);

  (void)snprintf(text + used, size - used, "%s", more);
}

const char *VectorText(PetscInt dim, const PetscReal x[], char text[VECTOR_TEXT])
{
  int n = 0;

  for (PetscInt d = 0; d < dim; d++)
    n += snprintf(text + n, (size_t)(VECTOR_TEXT - n), "%s%g", d ? ", " : "", (double)x[d]);
  return text;
}

const char *AxesText(PetscInt dim, const PetscReal x[DIM], char text[VECTOR_TEXT])
{
  return dim == 2 ? VectorText(1, x + 2, text) : VectorText(dim, x, text);
}

PetscErrorCode UserErrorSaid(void)
{
  UserErrorRaised = Said = PETSC_TRUE;
  return ISPH_USER_ERROR;
}

void UserErrorsMute(PetscBool mute)
{
  Muted = mute;
}

void ErrorsCapture(PetscBool capture)
{
  if (capture) Captured[0] = 0;
  Capturing = capture;
}

const char *CapturedError(void)
{
  return Captured;
}

/* Stores the first line of an error message, or the meaning of its code. */
static PetscBool Capture(PetscErrorCode code, const char message[])
{
  const char *text = message;

  if (!Capturing) return PETSC_FALSE;
  if (!text || !*text) (void)PetscErrorMessage(code, &text, NULL);
  (void)snprintf(Captured, sizeof(Captured), "%.*s", text ? (int)strcspn(text, "\n") : 0, text ? text : "");
  return PETSC_TRUE;
}

/* Whether 'word' is one of the words of 'text'; 'separators' lists the characters between words. */
static PetscBool HasWord(const char text[], const char word[], size_t length, const char separators[])
{
  for (const char *p = text; *p; p += strcspn(p, separators), p += strspn(p, separators))
    if (strcspn(p, separators) == length && !strncmp(p, word, length)) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* The option that PETSc's complaint is about, as " (-name value)": the first one whose value, or a number of the value,
   the complaint cites; else "". */
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

/* Makes one sentence of PETSc's complaint about the value of an option. */
static PetscBool ReportBadValue(const char function[], PetscErrorCode code, const char message[])
{
  char option[256];

  if (!message || !function) return PETSC_FALSE;
  if (strncmp(function, "PetscOptionsStringTo", 20) && strncmp(function, "PetscOptionsGetE", 16) &&
      strncmp(function, "PetscOptionsInsert", 18) && strncmp(function, "PetscOptionsSetValue", 20) &&
      code != PETSC_ERR_ARG_UNKNOWN_TYPE)
    return PETSC_FALSE;
  if (strstr(message, ": extra token"))
    (void)snprintf(option, sizeof(option),
                   "; between numbers, and before a unit, there are no blanks: 1,2mm, or \"1, 2 mm\"");
  else if (strstr(function, "YAML"))
    (void)snprintf(option, sizeof(option), ": an options file whose name ends in .yaml or .yml is not YAML");
  else
    FindOption(message, option, sizeof(option));
  (void)snprintf(LastError, sizeof(LastError), "%s%.*s%s",
                 strncmp(function, "PetscOptionsSetValue", 20) ? ""
                                                               : "there are more options than PETSc has room for: ",
                 (int)strcspn(message, "\n"), message, option);
  SayOnce(PETSC_COMM_WORLD);
  return PETSC_TRUE;
}

/* Out of memory: the rank says so and aborts all ranks, since the others wait for it. In PETSc 3.18 only the name of
   the function tells it; the code is another. */
static PetscBool ReportMemory(const char function[], PetscErrorCode code)
{
  static const char message[] = "out of memory: take a larger -spacing, a smaller box or more machines";
  PetscMPIInt       size      = 1;

  if (function && !strncmp(function, "PetscOptions", 12)) return PETSC_FALSE; /* its table of options is full */
  if (code != PETSC_ERR_MEM &&
      (!function || (strcmp(function, "PetscMallocAlign") && strcmp(function, "PetscReallocAlign"))))
    return PETSC_FALSE;
  Say(message);
  (void)MPI_Comm_size(PETSC_COMM_WORLD, &size);
  if (size > 1) (void)MPI_Abort(PETSC_COMM_WORLD, 1);
  return PETSC_TRUE;
}

/* What PETSc's options ask for when an error starts. */
typedef struct {
  const char *option;
  PetscErrorCode (*handler)(MPI_Comm, int, const char *, const char *, PetscErrorCode, PetscErrorType, const char *,
                            void *);
} Debugger;

static Debugger Debuggers[] = {{"-on_error_abort", PetscAbortErrorHandler},
                               {"-on_error_mpiabort", PetscMPIAbortErrorHandler},
                               {"-on_error_attach_debugger", PetscAttachDebuggerErrorHandler},
                               {"-start_in_debugger", PetscAbortErrorHandler}};

/* PETSc calls this where an error starts (PETSC_ERROR_INITIAL) and again in each PetscCall on the way up, which gives
   the chain of calls. A user error does not start here, so its PetscCalls print nothing. A PetscCall in main, as in a
   test, ends the program, so the sentence is printed there. */
static PetscErrorCode UserErrorHandler(MPI_Comm comm, int line, const char *function, const char *file,
                                       PetscErrorCode code, PetscErrorType type, const char *message, void *context)
{
  const char *text = message;
  size_t      used;

  if (type == PETSC_ERROR_INITIAL) {
    UserErrorRaised =
      (PetscBool)(ReportMemory(function, code) || Capture(code, message) || ReportBadValue(function, code, message));
    if (UserErrorRaised) return code;
    if (!text || !*text) (void)PetscErrorMessage(code, &text, NULL);
    (void)snprintf(LastError, sizeof(LastError), "PETSc says \"%.*s\" (error %d in %s, line %d of %s",
                   text ? (int)strcspn(text, "\n") : 0, text ? text : "", (int)code, function, line, file);
    Said = PETSC_FALSE;
  } else if (!UserErrorRaised) {
    used = strlen(LastError);
    (void)snprintf(LastError + used, sizeof(LastError) - used, " < %s", function);
  }
  if (!UserErrorRaised && function && !strcmp(function, "main")) Say(LastError);
  if (context && !UserErrorRaised)
    return ((const Debugger *)context)->handler(comm, line, function, file, code, type, message, NULL);
  return code;
}

PetscErrorCode UserErrorHandlerPush(void)
{
  PetscFunctionBeginUser;
  PetscCall(PetscPushErrorHandler(UserErrorHandler, NULL));
  PetscCallMPI(MPI_Comm_dup(MPI_COMM_WORLD, &Meeting));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode UserErrorHandlerFirst(void)
{
  PetscBool asked = PETSC_FALSE;

  PetscFunctionBeginUser;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(Debuggers) && !asked; k++) {
    PetscCall(PetscOptionsHasName(NULL, NULL, Debuggers[k].option, &asked));
    if (asked) PetscCall(PetscPushErrorHandler(UserErrorHandler, &Debuggers[k]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ErrorsKeep(PetscBool keep)
{
  PetscFunctionBeginUser;
  Muted = keep;
  if (keep) {
    LastError[0]    = 0;
    UserErrorRaised = PETSC_FALSE;
    PetscCall(PetscPushErrorHandler(UserErrorHandler, NULL));
  } else
    PetscCall(PetscPopErrorHandler());
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void CloseSentence(void)
{
  const size_t length = strlen(LastError);

  if (!UserErrorRaised && length && LastError[length - 1] != ')')
    (void)snprintf(LastError + length, sizeof(LastError) - length, ")");
}

const char *ErrorSentence(void)
{
  CloseSentence();
  return LastError;
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

int ErrorFinish(PetscErrorCode code)
{
  PetscMPIInt first = 0, all = 1, rank = 0;

  if (code) CloseSentence();
  if (code && !LastError[0])
    (void)snprintf(LastError, sizeof(LastError), "PETSc could not start or end (error %d)", (int)code);
  (void)MPI_Comm_rank(Meeting, &rank);
  if (code && !rank && !Said) Say(LastError);
  if (code) (void)RanksMeet(Meeting, PETSC_TRUE, &first, &all);
  if (code && rank && !all && !Said) Say(LastError);
  if (!all) (void)MPI_Abort(MPI_COMM_WORLD, 1);
  (void)MPI_Comm_free(&Meeting);
  return code ? 1 : 0;
}
