/* The names of PETSc's and SLEPc's options: PETSc has no list of them, but its library has each name as a string. */
#define _GNU_SOURCE /* dladdr */
#include "../twolevel/twolevel.h"
#include "sim_impl.h"
#include <ctype.h>
#include <dlfcn.h>
#include <petscksp.h>
#include <slepcsys.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define NAME_LEAST 4 /* characters of a name in the library; shorter strings are mostly chance */

static PetscErrorCode Add(PetscNames *names, const char name[], size_t length)
{
  PetscFunctionBegin;
  PetscCall(ListGrow(names->n, &names->capacity, sizeof(*names->name), &names->name));
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

/* --- what PETSc's solvers read --- */

#define MARK '~' /* around the number in the prefix of a solver, since PETSc tells each prefix once */

static char  *Told; /* all that PETSc has printed of options */
static size_t ToldSize;

/* In place of PETSc's printing: keeps the text. */
static PetscErrorCode Tell(FILE *stream, const char format[], va_list arguments)
{
  char  *text = NULL;
  size_t size = 0;
  FILE  *file;

  PetscFunctionBegin;
  file = open_memstream(&text, &size);
  PetscCheck(file, PETSC_COMM_SELF, PETSC_ERR_MEM, "out of memory");
  (void)vfprintf(file, format, arguments);
  (void)fclose(file);
  PetscCall(PetscRealloc(ToldSize + size + 1, &Told));
  for (size_t k = 0; k < size; k++) {
    if (text[k] == MARK) k += strcspn(text + k + 1, (char[]){MARK, 0}) + 2;
    Told[ToldSize++] = text[k];
  }
  Told[ToldSize] = 0;
  free(text);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lets a solver of these types read its options under -help; NULL: those of the pressure equation. A type that cannot
   be set up alone tells nothing. */
static PetscErrorCode Ask(PetscOptions options, const char ksp_type[], const char pc_type[])
{
  static int asked = 0;
  char       prefix[NAME_LEAST + 8];
  KSP        ksp;
  PC         pc;

  PetscFunctionBegin;
  PetscCall(KSPCreate(PETSC_COMM_SELF, &ksp));
  PetscCall(PetscObjectSetOptions((PetscObject)ksp, options));
  PetscCall(PetscSNPrintf(prefix, sizeof(prefix), "%c%d%c", MARK, asked++, MARK));
  PetscCall(KSPSetOptionsPrefix(ksp, prefix));
  PetscCall(KSPGetPC(ksp, &pc));
  ErrorsCapture(PETSC_TRUE);
  if (!KSPSetType(ksp, ksp_type ? ksp_type : KSPCG) && !PCSetType(pc, pc_type ? pc_type : PCTWOLEVEL)) {
    if (ksp_type || !pc_type) (void)KSPSetFromOptions(ksp);
    if (pc_type) (void)PCSetFromOptions(pc);
  }
  ErrorsCapture(PETSC_FALSE);
  PetscCall(KSPDestroy(&ksp));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Asks all solvers and preconditioners of PETSc. */
static PetscErrorCode AskAll(PetscOptions options)
{
  const PetscFunctionList lists[] = {KSPList, PCList};
  const char            **names;
  int                     n;

  PetscFunctionBegin;
  for (int l = 0; l < 2; l++) {
    PetscCall(PetscFunctionListGet(lists[l], &names, &n));
    for (int k = 0; k < n; k++) PetscCall(Ask(options, l ? NULL : names[k], l ? names[k] : NULL));
    PetscCall(PetscFree(names));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the option of this line has not been told before. */
static PetscBool IsNew(const char line[])
{
  const size_t indent = strspn(line, " "), length = indent + strcspn(line + indent, " :<") + 1;

  for (const char *before = Told; before < line; before += strcspn(before, "\n") + 1)
    if (!strncmp(before, line, length)) return PETSC_FALSE;
  return PETSC_TRUE;
}

PetscBool Mentions(const char text[], const char word[])
{
  for (; text && *text; text++)
    if (!strncasecmp(text, word, strlen(word))) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscErrorCode SolversHelp(const char word[], PetscBool *any)
{
  PetscErrorCode (*print)(FILE *, const char[], va_list) = PetscVFPrintf;
  PetscOptions options; /* of its own, since -help stays set */
  char         type[2][OPTION_NAME_LENGTH];
  PetscBool    has[2];

  PetscFunctionBegin;
  PetscCall(PCTwoLevelRegister());
  PetscCall(PetscOptionsGetString(NULL, NULL, "-ksp_type", type[0], sizeof(type[0]), &has[0]));
  PetscCall(PetscOptionsGetString(NULL, NULL, "-pc_type", type[1], sizeof(type[1]), &has[1]));
  PetscCall(PetscOptionsCreate(&options));
  PetscCall(PetscOptionsSetValue(options, "-help", NULL));
  PetscVFPrintf = Tell;
  ToldSize      = 0;
  if (word[0])
    PetscCall(AskAll(options));
  else {
    PetscCall(Ask(options, has[0] ? type[0] : NULL, NULL));
    if (has[1]) PetscCall(Ask(options, NULL, type[1]));
  }
  PetscVFPrintf = print;
  PetscCall(PetscOptionsDestroy(&options));
  *any = PETSC_FALSE;
  for (char *line = Told; line && *line; line += line[0] != 0) {
    const size_t length = strcspn(line, "\n");
    char        *name   = line + strspn(line, " ");

    if (name[0] == '-' && isalpha(name[1]) && IsNew(line)) {
      const char end = line[length];

      line[length] = 0;
      if (Mentions(name, word)) {
        if (!*any)
          PetscCall(PetscPrintf(PETSC_COMM_WORLD, "\nPETSc's solver of the pressure (-viscous_ksp_..., -viscous_pc_... "
                                                  "of implicit viscosity):\n"));
        *any = PETSC_TRUE;
        PetscCall(PetscPrintf(PETSC_COMM_WORLD, "  %s\n", name));
      }
      line[length] = end;
    }
    line += length;
  }
  PetscCall(PetscFree(Told));
  PetscFunctionReturn(PETSC_SUCCESS);
}
