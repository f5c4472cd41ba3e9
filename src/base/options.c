/* Checks the command line before PETSc reads it. PETSc follows an options file that includes itself until the stack
   overflows, and skips arguments that are no options. */
#include "simd.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#define DEPTH_MAX    32 /* of nested options files */
#define LINE_LENGTH  8192
#define FOLDERS_MOST 32
#define KEY          "-options_file"
#define BLANKS       " \t\r\n\"'"

static PetscBool TextIsShallow(char text[], int left);

/* The folders of the options files, of rank 0. */
static struct {
  int  count;
  char name[FOLDERS_MOST][PETSC_MAX_PATH_LEN];
} folders;

static void NoteFolder(const char file[])
{
  const char  *slash = strrchr(file, '/');
  const size_t size  = slash ? (size_t)(slash + 1 - file) : 0;

  if (!size || size >= PETSC_MAX_PATH_LEN || folders.count == FOLDERS_MOST) return;
  (void)memcpy(folders.name[folders.count], file, size);
  folders.name[folders.count++][size] = 0;
}

PetscErrorCode OptionsFileFind(MPI_Comm comm, char path[PETSC_MAX_PATH_LEN])
{
  char        longer[2 * PETSC_MAX_PATH_LEN];
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  for (int k = folders.count; !rank && k-- && path[0] != '/' && access(path, F_OK);) {
    (void)snprintf(longer, sizeof(longer), "%s%s", folders.name[k], path);
    if (strlen(longer) < PETSC_MAX_PATH_LEN && !access(longer, F_OK))
      PetscCall(PetscStrncpy(path, longer, PETSC_MAX_PATH_LEN));
  }
  PetscCallMPI(MPI_Bcast(path, PETSC_MAX_PATH_LEN, MPI_CHAR, 0, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the file is regular and includes files less than 'left' levels deep. PETSc opens a file twice, so a pipe
   would be empty. */
static PetscBool FileIsShallow(const char file[], int left)
{
  struct stat info;
  char        line[LINE_LENGTH];
  PetscBool   good = (PetscBool)(left > 0);
  FILE       *text;

  if (stat(file, &info)) return good; /* PETSc refuses it */
  if (!S_ISREG(info.st_mode)) return PETSC_FALSE;
  if (!(text = fopen(file, "r"))) return good;
  NoteFolder(file);
  while (good && fgets(line, sizeof(line), text)) good = TextIsShallow(line, left);
  (void)fclose(text);
  return good;
}

/* FileIsShallow for the files that a text of options names. Splits the text into words. */
static PetscBool TextIsShallow(char text[], int left)
{
  char     *rest;
  PetscBool file = PETSC_FALSE, good = PETSC_TRUE;

  for (char *word = strtok_r(text, BLANKS, &rest); word && good; word = strtok_r(NULL, BLANKS, &rest)) {
    if (word[0] == '#') break;
    if (file) good = FileIsShallow(word, left - 1);
    file = (PetscBool)!strcasecmp(word, KEY); /* PETSc takes any case */
  }
  return good;
}

static PetscErrorCode RefuseFile(MPI_Comm comm, const char file[])
{
  struct stat info;

  if (!stat(file, &info) && !S_ISREG(info.st_mode))
    return UserError(
      comm, "the options file %s is not a regular file: write the options to one (a pipe cannot be read twice)", file);
  return UserError(comm,
                   "the options file %s includes itself, nests files more than %d deep, or includes what is no file",
                   file, DEPTH_MAX);
}

/* A word of a text of options that PETSc would skip, or NULL. A text with quotation marks is not checked. */
static const char *FindStray(const char text[])
{
  PetscBool option = PETSC_FALSE; /* the word before is an option */

  if (strpbrk(text, "\"'")) return NULL;
  for (const char *word = text + strspn(text, BLANKS); *word;
       word += strcspn(word, BLANKS), word += strspn(word, BLANKS)) {
    if (word[0] != '-' && !option) return word;
    option = (PetscBool)(word[0] == '-');
  }
  return NULL;
}

/* Checks the options files that PETSc reads by itself and the environment variable PETSC_OPTIONS. */
static PetscErrorCode CheckSurroundings(MPI_Comm comm)
{
  static const char *const unasked[]   = {".petscrc", "petscrc"};
  const char              *home        = getenv("HOME");
  const char              *environment = getenv("PETSC_OPTIONS");
  const char              *stray;
  char                     text[LINE_LENGTH];

  (void)snprintf(text, sizeof(text), "%s/.petscrc", home ? home : "");
  if (home && !FileIsShallow(text, DEPTH_MAX)) return RefuseFile(comm, text);
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(unasked); k++)
    if (!FileIsShallow(unasked[k], DEPTH_MAX)) return RefuseFile(comm, unasked[k]);
  if (environment && (stray = FindStray(environment)))
    return UserError(comm, "in PETSC_OPTIONS %.*s is neither an option nor the value of one",
                     (int)strcspn(stray, BLANKS), stray);
  (void)snprintf(text, sizeof(text), "%s", environment ? environment : "");
  if (!TextIsShallow(text, DEPTH_MAX + 1))
    return UserError(comm,
                     "PETSC_OPTIONS names an options file that includes itself, nests files more than %d deep, or "
                     "includes what is no file",
                     DEPTH_MAX);
  return PETSC_SUCCESS;
}

static PetscErrorCode CheckFiles(MPI_Comm comm, int argc, char *argv[])
{
  for (int k = 1; k < argc; k++) {
    if (strcasecmp(argv[k], KEY)) continue;
    if (k + 1 == argc || !argv[k + 1][0] || argv[k + 1][0] == '-')
      return UserError(comm, KEY " needs the name of a file after it");
    /* PETSc would refuse the file on rank 0 only, and the other ranks would wait */
    if (access(argv[k + 1], R_OK))
      return UserError(comm, "the options file %s cannot be opened: %s", argv[k + 1], strerror(errno));
    if (!FileIsShallow(argv[k + 1], DEPTH_MAX)) return RefuseFile(comm, argv[k + 1]);
  }
  return CheckSurroundings(comm);
}

/* Inserts -options_file before each name that comes before the first option. PETSc keeps the new argument vector, so it
   is never freed. */
static PetscErrorCode NameFiles(MPI_Comm comm, int *argc, char ***argv)
{
  static char key[] = KEY;
  int         files = 0;
  char      **longer;

  while (files + 1 < *argc && (*argv)[files + 1][0] != '-') files++;
  if (!files) return PETSC_SUCCESS;
  longer = malloc((size_t)(*argc + files + 1) * sizeof(*longer));
  if (!longer) return UserError(comm, "out of memory");
  longer[0] = (*argv)[0];
  for (int k = 1; k <= *argc; k++) { /* argv[argc] is NULL */
    if (k <= files) longer[2 * k - 1] = key;
    longer[k <= files ? 2 * k : files + k] = (*argv)[k];
  }
  *argc += files;
  *argv = longer;
  return PETSC_SUCCESS;
}

/* Names options.opts of the folder that -measure names, before all others. The new list is never freed. */
static PetscErrorCode NameMeasured(MPI_Comm comm, int *argc, char ***argv)
{
  static char key[] = KEY, file[PETSC_MAX_PATH_LEN];
  char      **longer;
  int         k = 1;

  while (k < *argc - 1 && strcmp((*argv)[k], MEASURE_OPTION)) k++;
  if (k >= *argc - 1) return PETSC_SUCCESS;
  longer = malloc((size_t)(*argc + 3) * sizeof(*longer));
  if (!longer || snprintf(file, sizeof(file), "%s/options.opts", (*argv)[k + 1]) >= (int)sizeof(file))
    return UserError(comm, "the name of the folder of " MEASURE_OPTION " is too long");
  longer[0] = (*argv)[0];
  longer[1] = key;
  longer[2] = file;
  for (k = 1; k <= *argc; k++) longer[k + 2] = (*argv)[k];
  *argc += 2;
  *argv = longer;
  return PETSC_SUCCESS;
}

int WordsSplit(const char text[], char ***word)
{
  const size_t length = strlen(text);
  char        *to     = malloc(length + sizeof("isph") + 1);
  int          count  = 0;
  char         quote  = 0;

  *word = malloc((length / 2 + 3) * sizeof(**word));
  if (!to || !*word) return 0;
  (*word)[count++] = strcpy(to, "isph");
  for (to += sizeof("isph"); *(text += quote ? 0 : strspn(text, " \t\r\n"));) {
    (*word)[count++] = to;
    for (; *text && (quote || !strchr(" \t\r\n", *text)); text++) {
      if (quote ? *text == quote : strchr("\"'", *text) != NULL)
        quote = quote ? 0 : *text;
      else
        *to++ = *text;
    }
    quote = 0;
    *to++ = 0;
  }
  (*word)[count] = NULL;
  return count;
}

static PetscBool EndsInComma(const char word[])
{
  const size_t size = strlen(word);

  return (PetscBool)(size > 0 && word[size - 1] == ',');
}

PetscErrorCode CommandLineCheck(MPI_Comm comm, int *argc, char ***argv, PetscBool *stop)
{
  static char help[] = "-help", help_on[] = HELP_OPTION;
  int         rank, bad                   = 0;

  *stop = PETSC_FALSE;
  (void)MPI_Comm_rank(comm, &rank);
  if (NameFiles(comm, argc, argv) || NameMeasured(comm, argc, argv)) return ISPH_USER_ERROR;
  for (int k = 1; k < *argc; k++) {
    char *word = (*argv)[k];

    if (!strcmp(word, "-h") || !strcmp(word, "--help") || !strcmp(word, "-help"))
      (*argv)[k] = k + 1 < *argc && (*argv)[k + 1][0] != '-' && strcmp((*argv)[k + 1], "intro") ? help_on : help;
    if (!strcmp(word, "--version") || !strcmp(word, "-version")) *stop = PETSC_TRUE;
    if (word[0] != '-' && (*argv)[k - 1][0] != '-' && (word[0] == ',' || EndsInComma((*argv)[k - 1])))
      return UserError(comm, "%s%s stands in two words: write numbers without blanks between them", (*argv)[k - 1],
                       word);
    if (word[0] != '-' && (*argv)[k - 1][0] != '-' && UnitIs(word))
      return UserError(comm,
                       "%s %s stands in two words: write a unit without a blank, %s%s, or both in quotation marks",
                       (*argv)[k - 1], word, (*argv)[k - 1], word);
    if (word[0] != '-' && (*argv)[k - 1][0] != '-')
      return UserError(comm, "%s is not the value of an option; did you mean -options_file %s?", word, word);
  }
  if (*stop && !rank)
    (void)printf("isph %s, PETSc %d.%d.%d, code for %s\n", ISPH_VERSION, PETSC_VERSION_MAJOR, PETSC_VERSION_MINOR,
                 PETSC_VERSION_SUBMINOR, SIMD_NAME);
  if (!rank) bad = CheckFiles(comm, *argc, *argv) != PETSC_SUCCESS; /* in PETSc, too, rank 0 reads them */
  (void)MPI_Bcast(&bad, 1, MPI_INT, 0, comm);
  return bad ? UserErrorSaid() : PETSC_SUCCESS;
}
