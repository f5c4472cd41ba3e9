/* Formulas of options: a descent through sums, products and powers that writes what a stack does. */
#include "base.h"
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
  Formula    *formula;
  const char *at;    /* what is read next */
  const char *names; /* a letter for each variable */
  PetscBool   bad;
  PetscInt    depth; /* parentheses that are open */
} Reader;

typedef struct {
  const char *name;
  PetscReal (*value)(PetscReal x);
} Function;

static PetscReal Absolute(PetscReal x)
{
  return PetscAbsReal(x);
}
static PetscReal Step(PetscReal x)
{
  return x > 0 ? 1 : 0;
}

static const Function functions[] = {{"sin", sin},      {"cos", cos},   {"tan", tan},   {"exp", exp},
                                     {"log", log},      {"sqrt", sqrt}, {"tanh", tanh}, {"atan", atan},
                                     {"abs", Absolute}, {"step", Step}, {NULL, NULL}};

static void Sum(Reader *reader);

static void Put(Reader *reader, char what, PetscReal value, PetscInt index)
{
  Formula *formula = reader->formula;

  if (formula->count == FORMULA_MOST)
    reader->bad = PETSC_TRUE;
  else
    formula->part[formula->count++] = (FormulaPart){.what = what, .index = (int)index, .value = value};
}

/* The next character that is no blank. */
static char Next(Reader *reader)
{
  while (isspace((unsigned char)*reader->at)) reader->at++;
  return *reader->at;
}

static PetscBool Take(Reader *reader, char what)
{
  if (Next(reader) != what) return PETSC_FALSE;
  reader->at++;
  return PETSC_TRUE;
}

static void Enclosed(Reader *reader)
{
  if (++reader->depth > FORMULA_MOST || !Take(reader, '(')) reader->bad = PETSC_TRUE;
  if (!reader->bad) Sum(reader);
  if (!reader->bad && !Take(reader, ')')) reader->bad = PETSC_TRUE;
  reader->depth--;
}

/* pi, a variable or a function. */
static void Word(Reader *reader)
{
  size_t      length = 0;
  const char *word   = reader->at, *name;

  while (isalnum((unsigned char)word[length])) length++;
  name = length == 1 ? strchr(reader->names, *word) : NULL;
  if (name) {
    reader->at += length;
    Put(reader, 'x', 0, (PetscInt)(name - reader->names));
    return;
  }
  if (length == 2 && !strncmp(word, "pi", 2)) {
    reader->at += length;
    Put(reader, '0', PETSC_PI, 0);
    return;
  }
  for (PetscInt k = 0; functions[k].name; k++) {
    if (strlen(functions[k].name) != length || strncmp(functions[k].name, word, length)) continue;
    reader->at += length;
    Enclosed(reader);
    Put(reader, 'f', 0, k);
    return;
  }
  reader->bad = PETSC_TRUE;
}

static void Power(Reader *reader)
{
  const char first = Next(reader);
  char      *end;

  if (first == '(')
    Enclosed(reader);
  else if (isdigit((unsigned char)first) || first == '.') {
    const PetscReal value = (PetscReal)strtod(reader->at, &end);

    if (end == reader->at || (end[-1] != '.' && !isdigit((unsigned char)end[-1]))) reader->bad = PETSC_TRUE;
    reader->at = end;
    Put(reader, '0', value, 0);
  } else if (isalpha((unsigned char)first))
    Word(reader);
  else
    reader->bad = PETSC_TRUE;
}

/* A sign binds less than a power: -x^2 is -(x^2), and x^-2 is a power. */
static void Signed(Reader *reader)
{
  PetscInt minus = 0;

  for (; Next(reader) == '-' || *reader->at == '+'; reader->at++) minus += *reader->at == '-';
  Power(reader);
  if (!reader->bad && Take(reader, '^')) {
    if (++reader->depth > FORMULA_MOST) reader->bad = PETSC_TRUE;
    if (!reader->bad) Signed(reader);
    reader->depth--;
    Put(reader, '^', 0, 0);
  }
  if (minus % 2) Put(reader, '~', 0, 0);
}

static void Product(Reader *reader)
{
  Signed(reader);
  while (!reader->bad && (Next(reader) == '*' || *reader->at == '/')) {
    const char what = *reader->at++;

    Signed(reader);
    Put(reader, what, 0, 0);
  }
}

static void Sum(Reader *reader)
{
  Product(reader);
  while (!reader->bad && (Next(reader) == '+' || *reader->at == '-')) {
    const char what = *reader->at++;

    Product(reader);
    Put(reader, what, 0, 0);
  }
}

PetscBool FormulaRead(const char **text, const char names[], Formula *formula)
{
  Reader reader = {.formula = formula, .at = *text, .names = names};

  formula->count = 0;
  Sum(&reader);
  *text = reader.at;
  if (reader.bad || !Next(&reader)) return (PetscBool)!reader.bad;
  if (!Take(&reader, ',')) return PETSC_FALSE;
  *text = reader.at;
  return PETSC_TRUE;
}

PetscReal FormulaValue(const Formula *formula, const PetscReal x[])
{
  PetscReal stack[FORMULA_MOST + 1] = {0};
  PetscInt  n = 0;

  for (PetscInt k = 0; k < formula->count; k++) {
    const FormulaPart *part = &formula->part[k];

    switch (part->what) {
    case '0':
      stack[n++] = part->value;
      break;
    case 'x':
      stack[n++] = x[part->index];
      break;
    case 'f':
      stack[n - 1] = functions[part->index].value(stack[n - 1]);
      break;
    case '~':
      stack[n - 1] = -stack[n - 1];
      break;
    case '+':
      n--, stack[n - 1] += stack[n];
      break;
    case '-':
      n--, stack[n - 1] -= stack[n];
      break;
    case '*':
      n--, stack[n - 1] *= stack[n];
      break;
    case '/':
      n--, stack[n - 1] /= stack[n];
      break;
    default:
      n--, stack[n - 1] = PetscPowReal(stack[n - 1], stack[n]);
    }
  }
  return stack[0];
}
