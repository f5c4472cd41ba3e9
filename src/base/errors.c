/* How bad input is refused: one sentence instead of PETSc's trace. */
#include "base.h"
#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define MESSAGE_LENGTH 1024

static PetscBool UserErrorRaised = PETSC_FALSE; /* UserError has printed its sentence and its code is on its way up */
static PetscBool Keeping         = PETSC_FALSE; /* errors of PETSc's are kept for the caller */
static char      Kept[MESSAGE_LENGTH];

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
static void Say(const char message[], int length, const char option[])
{
  char line[2 * MESSAGE_LENGTH];

  (void)snprintf(line, sizeof(line), "isph: error: %.*s%s", length, message, option);
  for (char *c = line; *c; c++)
    if (iscntrl((unsigned char)*c)) *c = '?';
  fprintf(stderr, "%s\n", line);
  fflush(stderr);
  JournalText(line);
  JournalText("\n");
}

PetscErrorCode UserError(MPI_Comm comm, const char format[], ...)
{
  char        message[MESSAGE_LENGTH];
  PetscMPIInt rank;
  va_list     arguments;

  va_start(arguments, format);
  (void)vsnprintf(message, sizeof(message), format, arguments);
  va_end(arguments);
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (!rank) Say(message, (int)strlen(message), "");
  UserErrorRaised = PETSC_TRUE;
  return ISPH_USER_ERROR; /* bare: PetscError() would print a trace */
}

PetscErrorCode UserErrorSaid(void)
{
  UserErrorRaised = PETSC_TRUE;
  return ISPH_USER_ERROR;
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
  PetscMPIInt rank = 0;
  char        option[256];

  if (!message || !function) return PETSC_FALSE;
  if (strncmp(function, "PetscOptionsStringTo", 20) && strncmp(function, "PetscOptionsGetE", 16) &&
      strncmp(function, "PetscOptionsInsertFile", 22) && code != PETSC_ERR_ARG_UNKNOWN_TYPE)
    return PETSC_FALSE;
  FindOption(message, option, sizeof(option));
  (void)MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (!rank) Say(message, (int)strcspn(message, "\n"), option);
  return PETSC_TRUE;
}

/* No memory: the rank that has none says so and ends all, since the others wait for it. PETSc 3.18 knows it by the
   function only, the code is another. */
static PetscBool ReportMemory(const char function[], PetscErrorCode code)
{
  static const char message[] = "out of memory: take a larger -spacing, a smaller box or more machines";
  PetscMPIInt       size      = 1;

  if (code != PETSC_ERR_MEM &&
      (!function || (strcmp(function, "PetscMallocAlign") && strcmp(function, "PetscReallocAlign"))))
    return PETSC_FALSE;
  Say(message, (int)strlen(message), "");
  (void)MPI_Comm_size(PETSC_COMM_WORLD, &size);
  if (size > 1) (void)MPI_Abort(PETSC_COMM_WORLD, 1);
  return PETSC_TRUE;
}

/* An error that starts anew is PETSc's; the repeats of a user error, one a PetscCall on the way up, are not printed. */
static PetscErrorCode UserErrorHandler(MPI_Comm comm, int line, const char *function, const char *file,
                                       PetscErrorCode code, PetscErrorType type, const char *message, void *context)
{
  if (type == PETSC_ERROR_INITIAL)
    UserErrorRaised =
      (PetscBool)(ReportMemory(function, code) || ReportBadValue(function, code, message) || Keep(code, message));
  if (UserErrorRaised) return code;
  return PetscTraceBackErrorHandler(comm, line, function, file, code, type, message, context);
}

PetscErrorCode UserErrorHandlerPush(void)
{
  PetscFunctionBeginUser;
  PetscCall(PetscPushErrorHandler(UserErrorHandler, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}
