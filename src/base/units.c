/* Units behind the numbers of options: "0.1mm", "40 deg", "3 cP". A number without one has the unit of its row. */
#include "json.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEGREE       (PETSC_PI / 180)
#define EXPONENT_MAX 1000 /* in the text of a number */

/* A value is the number times 10^power, and times the factor unless that is 0. */
typedef struct {
  const char *unit, *word; /* of the row; what may stand behind a number besides */
  int         power;
  double      factor;
} Unit;

static const Unit Units[] = {
  {"m", "nm", -9},
  {"m", "um", -6},
  {"m", "mm", -3},
  {"m", "cm", -2},
  {"s", "ns", -9},
  {"s", "us", -6},
  {"s", "ms", -3},
  {"s", "min", 0, 60},
  {"s", "h", 0, 3600},
  {"m/s", "mm/s", -3},
  {"m/s", "cm/s", -2},
  {"m/s", "km/h", 0, 1 / 3.6},
  {"m/s2", "mm/s2", -3},
  {"m/s2", "cm/s2", -2},
  {"1/s", "1/ms", 3},
  {"Hz", "kHz", 3},
  {"Hz", "MHz", 6},
  {"rad/s", "deg/s", 0, DEGREE},
  {"rad/s", "rpm", 0, 6 * DEGREE},
  {"degrees", "deg", 0},
  {"degrees", "rad", 0, 1 / DEGREE},
  {"N/m", "mN/m", -3},
  {"N/m", "dyn/cm", -3},
  {"Pa s", "mPa s", -3},
  {"Pa s", "P", -1},
  {"Pa s", "cP", -3},
  {"Pa", "hPa", 2},
  {"Pa", "kPa", 3},
  {"Pa", "MPa", 6},
  {"Pa", "mbar", 2},
  {"Pa", "bar", 5},
  {"kg", "g", -3},
  {"kg", "mg", -6},
  {"kg/m3", "g/cm3", 3},
  {"kg m2", "g cm2", -7},
  {NULL},
};
static const Unit Own; /* that of the row itself */

/* Whether the first 'length' letters of a text are the word. A blank of the word may be a dot or left out. */
static PetscBool IsWord(const char text[], size_t length, const char word[])
{
  size_t k = 0;

  for (; *word; word++)
    if (k < length && (text[k] == *word || (*word == ' ' && text[k] == '.')))
      k++;
    else if (*word != ' ')
      return PETSC_FALSE;
  return (PetscBool)(k == length);
}

PetscBool UnitIs(const char text[])
{
  for (const Unit *u = Units; u->unit; u++)
    if (IsWord(text, strlen(text), u->word) || IsWord(text, strlen(text), u->unit)) return PETSC_TRUE;
  return PETSC_FALSE;
}

void UnitsList(const char unit[], char text[], size_t size)
{
  for (const Unit *u = Units; u->unit; u++) {
    if (strcmp(u->unit, unit)) continue;
    TextAppend(text, size, ", ");
    TextAppend(text, size, u->word);
  }
}

void UnitsJson(Json *json)
{
  JsonObject(json, "units");
  for (const Unit *u = Units; u->unit; u++) {
    if (u == Units || strcmp(u->unit, u[-1].unit)) JsonArray(json, u->unit);
    JsonText(json, NULL, u->word);
    if (!u[1].unit || strcmp(u->unit, u[1].unit)) JsonEnd(json);
  }
  JsonEnd(json);
}

/* A number, and the unit behind it or NULL. */
typedef struct {
  const char *text;
  int         length; /* without the unit */
  const Unit *unit;
} Quantity;

/* Reads one of "1.5 mm,0", up to the comma or the end of the text, which is *end. */
static PetscBool ReadQuantity(const char unit[], const char text[], Quantity *q, const char **end)
{
  char  *after;
  size_t length;

  text += strspn(text, " ");
  *end = text + strcspn(text, ",");
  (void)strtod(text, &after);
  *q = (Quantity){text, (int)(after - text), NULL};
  if (after == text || after > *end) return PETSC_FALSE;
  after += strspn(after, " ");
  length = (size_t)(*end - after);
  if (!length) return PETSC_TRUE;
  if (IsWord(after, length, unit)) q->unit = &Own;
  for (const Unit *u = Units; u->unit && !q->unit; u++)
    if (!strcmp(u->unit, unit) && IsWord(after, length, u->word)) q->unit = u;
  return (PetscBool)(q->unit != NULL);
}

/* Appends a number in the unit of the row. A power of ten goes into its text: 0.1mm is 0.1e-3 to the last bit. */
static PetscBool WriteQuantity(const Quantity *q, char text[], size_t size)
{
  const int    digits = (int)strspn(q->text, "+-.0123456789"), lead = PetscMin(digits, q->length);
  const double number = strtod(q->text, NULL);
  char         more[OPTION_NAME_LENGTH];
  int          length;
  long         power = 0;

  if (!q->unit || number == 0 || (!q->unit->power && q->unit->factor == 0))
    length = snprintf(more, sizeof(more), "%.*s", q->length, q->text);
  else if (q->unit->factor != 0)
    length = snprintf(more, sizeof(more), "%.17g", number * q->unit->factor);
  else {
    if (lead < q->length && (q->text[lead] | 32) != 'e') return PETSC_FALSE; /* inf, or a hexadecimal number */
    if (lead < q->length) power = strtol(q->text + lead + 1, NULL, 10);
    if (PetscAbs(power) > EXPONENT_MAX) return PETSC_FALSE;
    length = snprintf(more, sizeof(more), "%.*se%ld", lead, q->text, power + q->unit->power);
  }
  if (length >= (int)sizeof(more) || strlen(text) + (size_t)length + 2 > size) return PETSC_FALSE;
  TextAppend(text, size, more);
  return PETSC_TRUE;
}

PetscBool UnitsConvert(const char unit[], const char given[], char text[], size_t size, PetscBool *any)
{
  Quantity    q, last = {NULL, 0, NULL};
  const char *end = given;

  *any    = PETSC_FALSE;
  text[0] = 0;
  for (const char *at = given; *end; at = end + 1) {
    if (!ReadQuantity(unit, at, &last, &end)) return PETSC_FALSE;
    *any = (PetscBool)(*any || last.unit);
  }
  end = given;
  for (const char *at = given; *any && *end; at = end + 1) {
    (void)ReadQuantity(unit, at, &q, &end);
    if (!q.unit) q.unit = last.unit;
    if (!q.unit && strtod(q.text, NULL) != 0) return PETSC_FALSE;
    if (at != given) TextAppend(text, size, ",");
    if (!WriteQuantity(&q, text, size)) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}
