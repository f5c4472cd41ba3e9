/* The names of PETSc's and SLEPc's options: PETSc has no list of them, but its library has each name as a string. */
#define _GNU_SOURCE /* dladdr */
#include "sim_impl.h"
#include <ctype.h>
#include <dlfcn.h>
#include <slepcsys.h>
#include <stdio.h>

#define NAME_LEAST 4 /* characters of a name in the library; shorter strings are mostly chance */

static PetscErrorCode Add(PetscNames *names, const char name[], size_t length)
{
  PetscFunctionBegin;
  if (names->n == names->capacity) {
    names->capacity = 2 * names->capacity + 1000;
    PetscCall(PetscRealloc((size_t)names->capacity * sizeof(*names->name), &names->name));
  }
  PetscCall(PetscStrncpy(names->name[names->n++], name, PetscMin(length + 1, OPTION_NAME_LENGTH)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PetscNamesDestroy(PetscNames *names)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(names->name));
  names->n = names->capacity = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the strings "-name" of a file, each of which ends with a zero byte. */
static PetscErrorCode ReadFile(const char path[], PetscNames *names)
{
  FILE  *file = fopen(path, "rb");
  char   text[OPTION_NAME_LENGTH];
  size_t length = 0; /* of the name so far; 0: outside a name */
  int    c, before = 0;

  PetscFunctionBegin;
  while (file && (c = getc_unlocked(file)) != EOF) {
    if (length && (isalpha(c) || c == '_' || (isdigit(c) && length > 1)) && length < sizeof(text))
      text[length++] = (char)c;
    else {
      if (length > NAME_LEAST && !c) PetscCall(Add(names, text + 1, length - 1));
      length  = c == '-' && !isalnum(before) && before != '_';
      text[0] = '-';
    }
    before = c;
  }
  if (file) (void)fclose(file);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PetscNamesRead(PetscNames *names)
{
  const void *const functions[] = {(const void *)&PetscInitialized, (const void *)&SlepcInitialize};
  Dl_info           info;

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(functions); k++)
    if (dladdr(functions[k], &info) && info.dli_fname) PetscCall(ReadFile(info.dli_fname, names));
  PetscFunctionReturn(PETSC_SUCCESS);
}
