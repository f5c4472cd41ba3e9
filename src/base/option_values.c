/* What is done with the values of any table of options: they are compared, told, and written. */
#include "json.h"
#include <string.h>

PetscBool OptionsSame(const OptionRow rows[], const void *one, const void *other)
{
  static const size_t size[] = {[ROW_REAL] = sizeof(PetscReal),        [ROW_INT] = sizeof(PetscInt),
                                [ROW_BOOL] = sizeof(PetscBool),        [ROW_WORD] = sizeof(int),
                                [ROW_POINT] = DIM * sizeof(PetscReal), [ROW_DIRECTION] = DIM * sizeof(PetscReal),
                                [ROW_AXIS] = DIM * sizeof(PetscReal),  [ROW_NORMAL] = DIM * sizeof(PetscReal)};

  for (const OptionRow *row = rows; row && row->name; row++) {
    const char          *a = (const char *)one + row->offset, *b = (const char *)other + row->offset;
    const OptionNumbers *list[2]  = {(const OptionNumbers *)a, (const OptionNumbers *)b};
    const OptionList    *names[2] = {(const OptionList *)a, (const OptionList *)b};

    if (row->kind == ROW_CHOICE || row->kind == ROW_TEXT) {
      if (strcmp(a, b)) return PETSC_FALSE;
    } else if (row->kind == ROW_FILE) {
      if (((const OptionFile *)a)->checksum != ((const OptionFile *)b)->checksum) return PETSC_FALSE;
    } else if (row->kind == ROW_NUMBERS) {
      if (list[0]->count != list[1]->count) return PETSC_FALSE;
      for (PetscInt k = 0; k < list[0]->count; k++)
        if (list[0]->value[k] != list[1]->value[k]) return PETSC_FALSE;
    } else if (row->kind == ROW_NAMES) {
      if (names[0]->count != names[1]->count) return PETSC_FALSE;
      for (PetscInt k = 0; k < names[0]->count; k++)
        if (strcmp(names[0]->text[k], names[1]->text[k])) return PETSC_FALSE;
    } else if (memcmp(a, b, size[row->kind]))
      return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

static void PrintNumbers(FILE *text, PetscInt n, const PetscReal x[])
{
  for (PetscInt k = 0; k < n; k++) fprintf(text, "%s%.12g", k ? "," : "", (double)(x[k] + 0.0)); /* -0 as 0 */
  fprintf(text, "\n");
}

void OptionsIdentity(FILE *text, const char prefix[], const OptionRow rows[], const void *data, PetscInt dim)
{
  for (const OptionRow *row = rows; row && row->name; row++) {
    const char          *value   = (const char *)data + row->offset;
    const OptionNumbers *numbers = (const OptionNumbers *)value;
    const OptionFile    *file    = (const OptionFile *)value;
    const PetscBool      unit    = (PetscBool)(row->kind == ROW_AXIS || row->kind == ROW_NORMAL);

    if (row->changes || row->kind == ROW_NAMES || (row->kind == ROW_NUMBERS && numbers->count == 0)) continue;
    if (row->kind == ROW_FILE && !file->path[0]) continue;
    fprintf(text, "-%s%s = ", prefix, row->name + 1);
    if (row->kind == ROW_INT)
      fprintf(text, "%" PetscInt_FMT "\n", *(const PetscInt *)value);
    else if (row->kind == ROW_BOOL)
      fprintf(text, "%d\n", (int)*(const PetscBool *)value);
    else if (row->kind == ROW_WORD)
      fprintf(text, "%s\n", row->words[*(const int *)value]);
    else if (row->kind == ROW_CHOICE || row->kind == ROW_TEXT)
      fprintf(text, "%s\n", value);
    else if (row->kind == ROW_FILE)
      fprintf(text, "a file of the checksum %016llx\n", file->checksum);
    else if (row->kind == ROW_NUMBERS)
      PrintNumbers(text, numbers->count, numbers->value);
    else
      PrintNumbers(text, row->kind == ROW_REAL ? 1 : unit ? DIM : dim, (const PetscReal *)value);
  }
}

void OptionsTell(char text[], size_t length, const OptionRow rows[], const void *data, PetscInt dim, PetscBool zeros)
{
  for (const OptionRow *row = rows; row && row->name; row++) {
    const void      *value = (const char *)data + row->offset;
    const PetscReal *v     = (const PetscReal *)value;
    const char      *comma = text[0] ? ", " : "", *gap = row->unit ? " " : "", *unit = row->unit ? row->unit : "";
    char             one[OPTION_NAME_LENGTH] = "", vector[VECTOR_TEXT];

    if (row->kind == ROW_REAL && (zeros || *v != 0))
      (void)snprintf(one, sizeof(one), "%s%s %g%s%s", comma, row->name + 1, (double)*v, gap, unit);
    else if (row->kind == ROW_DIRECTION && (zeros || Norm(v) > 0))
      (void)snprintf(one, sizeof(one), "%s%s %s%s%s", comma, row->name + 1, VectorText(dim, v, vector), gap, unit);
    else if (row->kind == ROW_CHOICE && strcmp((const char *)value, row->choices[0]->name))
      (void)snprintf(one, sizeof(one), "%s%s %s", comma, row->name + 1, (const char *)value);
    TextAppend(text, length, one);
  }
}

void OptionsValues(Json *json, const OptionRow rows[], const void *data, PetscInt dim)
{
  for (const OptionRow *row = rows; row && row->name; row++) {
    const char          *key     = row->name + 1;
    const void          *value   = (const char *)data + row->offset;
    const OptionNumbers *numbers = (const OptionNumbers *)value;

    if (row->kind == ROW_REAL)
      JsonReal(json, key, *(const PetscReal *)value);
    else if (row->kind == ROW_INT)
      JsonInt(json, key, *(const PetscInt *)value);
    else if (row->kind == ROW_BOOL)
      JsonBool(json, key, *(const PetscBool *)value);
    else if (row->kind == ROW_WORD)
      JsonText(json, key, row->words[*(const int *)value]);
    else if (row->kind == ROW_TEXT)
      JsonText(json, key, (const char *)value);
    else if (row->kind == ROW_FILE)
      JsonText(json, key, ((const OptionFile *)value)->path);
    else if (row->kind == ROW_NUMBERS)
      JsonReals(json, key, numbers->count, numbers->value);
    else if (row->kind >= ROW_POINT)
      JsonReals(json, key, dim, (const PetscReal *)value);
  }
}
