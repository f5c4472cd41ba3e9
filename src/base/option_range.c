/* Numerical options with an interval of allowed values, and tables of options. */
#include "base.h"
#include <stdio.h>
#include <stdlib.h>

/* Whether x lies in the interval, a text like "[low, high)"; NaN lies in none. */
static PetscBool Inside(const char interval[], PetscReal x)
{
  double low, high;
  char   opens, closes;

  if (sscanf(interval, "%c%lf, %lf%c", &opens, &low, &high, &closes) != 4) return PETSC_FALSE;
  return (PetscBool)((opens == '[' ? x >= low : x > low) && (closes == ']' ? x <= high : x < high));
}

static PetscErrorCode Describe(const char text[], const char interval[], char help[NAMES_LENGTH])
{
  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(help, NAMES_LENGTH, "%s, in %s", text, interval));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OptionReadReal(OptionItems PetscOptionsObject, const char name[], const char text[],
                              const char interval[], const char function[], PetscReal *value)
{
  const char *prefix = PetscOptionsObject->prefix ? PetscOptionsObject->prefix : "";
  char        help[NAMES_LENGTH];
  PetscBool   set;

  PetscFunctionBegin;
  PetscCall(Describe(text, interval, help));
  PetscCall(PetscOptionsReal(name, help, function, *value, value, &set));
  PetscCheckUser(!set || Inside(interval, *value), PetscOptionsObject->comm, "-%s%s is %g; it must lie in %s", prefix,
                 name + 1, (double)*value, interval);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses an integer that does not fit PetscInt, which PETSc would truncate. */
static PetscErrorCode RefuseWrapped(OptionItems PetscOptionsObject, const char name[], const char interval[])
{
  const char *prefix = PetscOptionsObject->prefix ? PetscOptionsObject->prefix : "";
  char        text[NAMES_LENGTH], *end;
  PetscBool   set;
  long long   number;

  PetscFunctionBegin;
  PetscCall(
    PetscOptionsGetString(PetscOptionsObject->options, PetscOptionsObject->prefix, name, text, sizeof(text), &set));
  if (!set) PetscFunctionReturn(PETSC_SUCCESS);
  number = strtoll(text, &end, 10);
  PetscCheckUser(*end || (number >= PETSC_MIN_INT && number <= PETSC_MAX_INT), PetscOptionsObject->comm,
                 "-%s%s is %s; it must lie in %s and have at most %d bits", prefix, name + 1, text, interval,
                 (int)(8 * sizeof(PetscInt)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OptionReadInt(OptionItems PetscOptionsObject, const char name[], const char text[],
                             const char interval[], const char function[], PetscInt *value)
{
  const char *prefix = PetscOptionsObject->prefix ? PetscOptionsObject->prefix : "";
  char        help[NAMES_LENGTH];
  PetscBool   set;

  PetscFunctionBegin;
  PetscCall(Describe(text, interval, help));
  PetscCall(RefuseWrapped(PetscOptionsObject, name, interval));
  PetscCall(PetscOptionsInt(name, help, function, *value, value, &set));
  PetscCheckUser(!set || Inside(interval, (PetscReal)*value), PetscOptionsObject->comm,
                 "-%s%s is %" PetscInt_FMT "; it must lie in %s", prefix, name + 1, *value, interval);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OptionReadWord(OptionItems PetscOptionsObject, const char name[], const char text[], PetscInt count,
                              const char *const words[], const char function[], PetscInt *value)
{
  const char *prefix             = PetscOptionsObject->prefix ? PetscOptionsObject->prefix : "";
  char        help[NAMES_LENGTH] = "", list[NAMES_LENGTH] = "", word[NAMES_LENGTH] = "";
  PetscBool   set, same = PETSC_FALSE;
  PetscInt    k;

  PetscFunctionBegin;
  for (k = 0; k < count; k++) {
    PetscCall(PetscStrlcat(list, k ? " " : "", sizeof(list)));
    PetscCall(PetscStrlcat(list, words[k], sizeof(list)));
  }
  PetscCall(PetscSNPrintf(help, sizeof(help), "%s (one of) %s", text, list));
  PetscCall(PetscOptionsString(name, help, function, words[*value], word, sizeof(word), &set));
  for (k = 0; set && k < count; k++) {
    PetscCall(PetscStrcasecmp(word, words[k], &same));
    if (same) break;
  }
  PetscCheckUser(!set || same, PetscOptionsObject->comm, "-%s%s %s does not exist; choose from %s", prefix, name + 1,
                 word, list);
  if (set) *value = k;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadNumbers(OptionItems PetscOptionsObject, const OptionRow *row, const char function[],
                                  OptionNumbers *numbers)
{
  const char *prefix = PetscOptionsObject->prefix ? PetscOptionsObject->prefix : "";

  PetscFunctionBegin;
  numbers->count = PETSC_STATIC_ARRAY_LENGTH(numbers->value);
  PetscCall(PetscOptionsRealArray(row->name, row->text, function, numbers->value, &numbers->count, NULL));
  for (PetscInt k = 0; k < numbers->count; k++)
    PetscCheckUser(!PetscIsInfOrNanReal(numbers->value[k]), PetscOptionsObject->comm, "-%s%s must have finite numbers",
                   prefix, row->name + 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OptionReadRow(OptionItems PetscOptionsObject, const OptionRow *row, const char function[], void *data)
{
  const char *name = row->name, *text = row->text;
  void       *value = (char *)data + row->offset;
  PetscReal  *real  = (PetscReal *)value;
  PetscBool  *flag  = (PetscBool *)value;
  OptionFile *file  = (OptionFile *)value;

  PetscFunctionBegin;
  switch (row->kind) {
  case ROW_REAL:
    if (row->interval)
      PetscCall(OptionReadReal(PetscOptionsObject, name, text, row->interval, function, real));
    else
      PetscCall(PetscOptionsReal(name, text, function, *real, real, NULL));
    break;
  case ROW_INT:
    PetscCall(OptionReadInt(PetscOptionsObject, name, text, row->interval, function, (PetscInt *)value));
    break;
  case ROW_BOOL:
    PetscCall(PetscOptionsBool(name, text, function, *flag, flag, NULL));
    break;
  case ROW_NUMBERS:
    PetscCall(ReadNumbers(PetscOptionsObject, row, function, (OptionNumbers *)value));
    break;
  case ROW_FILE:
    PetscCall(PetscOptionsString(name, text, function, file->path, file->path, sizeof(file->path), NULL));
    break;
  default:
    SETERRQ(PetscOptionsObject->comm, PETSC_ERR_PLIB, "%s has no kind that is read here", name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
