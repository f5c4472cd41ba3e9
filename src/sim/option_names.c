/* The names of all options: the program's from its own -help for the scene, PETSc's from the text of its library, which
   has each name as a string. */
#define _GNU_SOURCE /* dladdr */
#include "sim_impl.h"
#include <ctype.h>
#include <dlfcn.h>
#include <slepcsys.h>
#include <stdio.h>
#include <string.h>

#define NAME_LEAST 4 /* characters of a name in the library; shorter strings are mostly chance */
#define ANY_BODY   "<body>_"

static PetscErrorCode Add(OptionNames *names, const char name[], size_t length, const char choice[], PetscBool body)
{
  OptionName *entry;

  PetscFunctionBegin;
  if (names->n == names->capacity) {
    names->capacity = 2 * names->capacity + 1000;
    PetscCall(PetscRealloc(names->capacity * sizeof(*names->entry), &names->entry));
  }
  entry = &names->entry[names->n++];
  PetscCall(PetscStrncpy(entry->name, name, PetscMin(length + 1, sizeof(entry->name))));
  PetscCall(PetscStrncpy(entry->choice, choice, sizeof(entry->choice)));
  entry->body = body;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OptionNamesDestroy(OptionNames *names)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(names->entry));
  PetscCall(PetscMemzero(names, sizeof(*names)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds an option of any body, with its choice, for each body, solid and region of the scene. */
static PetscErrorCode AddForBodies(Scene scene, OptionNames *names, const char name[], size_t length,
                                   const char choice[])
{
  const char *where = strstr(choice, ANY_BODY);

  PetscFunctionBegin;
  for (PetscInt b = 0; b < SceneNames(scene); b++) {
    const char *body = SceneName(scene, b);
    char        full[OPTION_NAME_LENGTH], chosen[OPTION_NAME_LENGTH] = "";

    (void)snprintf(full, sizeof(full), "%s_%.*s", body, (int)(length - strlen(ANY_BODY)), name + strlen(ANY_BODY));
    if (where) (void)snprintf(chosen, sizeof(chosen), "-%s_%s", body, where + strlen(ANY_BODY));
    PetscCall(Add(names, full, strlen(full), chosen, PETSC_TRUE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lines "  -name ..." below titles "Group:" or "Group with -option choice:". */
PetscErrorCode OptionNamesFromHelp(Scene scene, char help[], OptionNames *names)
{
  char *rest = NULL, *with, choice[OPTION_NAME_LENGTH] = "";

  PetscFunctionBegin;
  for (char *line = strtok_r(help, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
    const size_t length = strlen(line), end = strcspn(line + 2, " :");

    if (line[0] != ' ' && line[length - 1] == ':') {
      line[length - 1] = 0;
      with             = strstr(line, " with -");
      PetscCall(PetscStrncpy(choice, with ? with + strlen(" with ") : "", sizeof(choice)));
    }
    if (strncmp(line, "  -", 3)) continue;
    if (!strncmp(line + 3, ANY_BODY, strlen(ANY_BODY)))
      PetscCall(AddForBodies(scene, names, line + 3, end - 1, choice));
    else
      PetscCall(Add(names, line + 3, end - 1, choice, PETSC_FALSE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the strings "-name" of a file, each of which ends with a zero byte. */
static PetscErrorCode ReadFile(const char path[], OptionNames *names)
{
  FILE  *file = fopen(path, "rb");
  char   text[OPTION_NAME_LENGTH];
  size_t length = 0; /* of the name so far; 0: outside a name */
  int    c, before = 0;

  PetscFunctionBegin;
  while (file && (c = getc_unlocked(file)) != EOF) {
    if (length && (islower(c) || c == '_' || (isdigit(c) && length > 1)) && length < sizeof(text))
      text[length++] = (char)c;
    else {
      if (length > NAME_LEAST && !c) PetscCall(Add(names, text + 1, length - 1, "", PETSC_FALSE));
      length  = c == '-' && !isalnum(before) && before != '_';
      text[0] = '-';
    }
    before = c;
  }
  if (file) (void)fclose(file);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OptionNamesPetsc(OptionNames *names)
{
  const void *const functions[] = {(const void *)&PetscInitialized, (const void *)&SlepcInitialize};
  Dl_info           info;

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(functions); k++)
    if (dladdr(functions[k], &info) && info.dli_fname) PetscCall(ReadFile(info.dli_fname, names));
  PetscFunctionReturn(PETSC_SUCCESS);
}
