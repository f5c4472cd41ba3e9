/* Options that are numbers within an interval. */
#include "base.h"
#include <stdio.h>

/* Whether x lies in the interval, "[low, high)" or the like; not a number lies in none. */
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

PetscErrorCode OptionReadInt(OptionItems PetscOptionsObject, const char name[], const char text[],
                             const char interval[], const char function[], PetscInt *value)
{
  const char *prefix = PetscOptionsObject->prefix ? PetscOptionsObject->prefix : "";
  char        help[NAMES_LENGTH];
  PetscBool   set;

  PetscFunctionBegin;
  PetscCall(Describe(text, interval, help));
  PetscCall(PetscOptionsInt(name, help, function, *value, value, &set));
  PetscCheckUser(!set || Inside(interval, (PetscReal)*value), PetscOptionsObject->comm,
                 "-%s%s is %" PetscInt_FMT "; it must lie in %s", prefix, name + 1, *value, interval);
  PetscFunctionReturn(PETSC_SUCCESS);
}
