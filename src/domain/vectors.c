/* Options that are vectors: directions, and tables of options with vectors in them. */
#include "domain.h"
#include <stdlib.h>
#include <string.h>

#define TEXT_LENGTH 64 /* of a direction */

static const char *const AxisNames[DIM] = {"x", "y", "z"};

/* Reads numbers from a text like "1,0,-2"; count is -1 for any other text. */
static void ParseNumbers(const char text[], PetscInt most, PetscReal number[], PetscInt *count)
{
  char *end;

  for (*count = 0; *count < most; text = end + 1) {
    number[(*count)++] = (PetscReal)strtod(text, &end);
    if (end == text || (*end && *end != ',')) *count = -1;
    if (*count < 0 || !*end) return;
  }
  *count = -1;
}

/* Reads a direction, x, y, z or a vector of any non-zero length; axis: the unit vector, the default on entry. */
static PetscErrorCode ReadAxis(Domain domain, OptionItems PetscOptionsObject, const OptionRow *row, const char help[],
                               const char function[], PetscReal axis[DIM])
{
  const char     *prefix = PetscOptionsObject->prefix ? PetscOptionsObject->prefix : "", *option = row->name;
  const PetscBool normal_allowed = (PetscBool)(row->kind == ROW_NORMAL);
  PetscInt        count, largest = 0;
  PetscReal       v[DIM] = {0, 0, 0}, size;
  PetscBool       found, planar;
  char            text[TEXT_LENGTH];

  PetscFunctionBegin;
  for (PetscInt d = 1; d < DIM; d++) largest = axis[d] > axis[largest] ? d : largest;
  PetscCall(PetscOptionsString(option, help, function, AxisNames[largest], text, sizeof(text), &found));
  if (!found) PetscFunctionReturn(PETSC_SUCCESS);
  if (text[0] >= 'x' && text[0] <= 'z' && !text[1])
    v[text[0] - 'x'] = 1;
  else {
    ParseNumbers(text, DIM, v, &count);
    PetscCheckUser(count == domain->dim || count == DIM, domain->comm,
                   "-%s%s %s is no direction: give x, y, z or %s numbers", prefix, option + 1, text,
                   domain->dim == 2 ? "two or three" : "three");
  }
  /* The largest component scales the vector first: the square of 1e-200 would be 0. */
  size = PetscMax(PetscAbsReal(v[0]), PetscMax(PetscAbsReal(v[1]), PetscAbsReal(v[2])));
  PetscCheckUser(size > 0 && !PetscIsInfOrNanReal(v[0] + v[1] + v[2]), domain->comm,
                 "-%s%s %s must be finite and not zero", prefix, option + 1, text);
  for (PetscInt d = 0; d < DIM; d++) v[d] /= size;
  size   = Norm(v);
  planar = v[2] == 0 || (normal_allowed && v[0] == 0 && v[1] == 0) ? PETSC_TRUE : PETSC_FALSE;
  PetscCheckUser(domain->dim == DIM || planar, domain->comm, "-%s%s %s must lie in the plane%s in two dimensions",
                 prefix, option + 1, text, normal_allowed ? " or along z" : "");
  for (PetscInt d = 0; d < DIM; d++) axis[d] = v[d] / size;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads a point or a direction; *value: the default on entry. */
static PetscErrorCode ReadComponents(Domain domain, OptionItems PetscOptionsObject, const OptionRow *row,
                                     const char help[], const char function[], PetscReal value[DIM])
{
  const char *prefix = PetscOptionsObject->prefix ? PetscOptionsObject->prefix : "", *option = row->name;
  PetscReal   number[DIM + 1] = {value[0], value[1], value[2], 0}; /* one more than allowed, to detect too many */
  PetscInt    count           = DIM + 1;
  PetscBool   found;

  PetscFunctionBegin;
  PetscCall(PetscOptionsRealArray(option, help, function, number, &count, &found));
  if (found) {
    PetscCheckUser(count == domain->dim || (count == DIM && !domain->rings), domain->comm,
                   "-%s%s must have %s numbers, separated by commas without blanks", prefix, option + 1,
                   domain->rings      ? "two (distance from the axis, position along the axis)"
                   : domain->dim == 2 ? "two or three"
                                      : "three");
    for (PetscInt d = 0; d < count; d++) {
      PetscCheckUser(!PetscIsInfOrNanReal(number[d]), domain->comm, "-%s%s must have finite numbers", prefix,
                     option + 1);
    }
    PetscCheckUser(row->kind == ROW_POINT || domain->dim == DIM || count < DIM || number[2] == 0, domain->comm,
                   "-%s%s must have no third component in two dimensions, not %g", prefix, option + 1,
                   (double)number[2]);
    for (PetscInt d = 0; d < count; d++) value[d] = number[d];
  }
  if (domain->dim == 2) value[2] = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An OptionVector. */
static PetscErrorCode ReadVector(void *context, OptionItems PetscOptionsObject, const OptionRow *row, const char help[],
                                 const char function[], PetscReal vector[DIM])
{
  Domain domain = (Domain)context;

  PetscFunctionBegin;
  if (row->kind == ROW_AXIS || row->kind == ROW_NORMAL)
    PetscCall(ReadAxis(domain, PetscOptionsObject, row, help, function, vector));
  else
    PetscCall(ReadComponents(domain, PetscOptionsObject, row, help, function, vector));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode DomainReadOptions(Domain domain, OptionItems PetscOptionsObject, const OptionRow rows[],
                                 const char function[], void *data)
{
  return OptionsReadVectors(PetscOptionsObject, rows, function, data, ReadVector, domain);
}
