#include "json.h"

static void Quote(FILE *file, const char text[])
{
  fputc('"', file);
  for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
    if (*c < ' ')
      fprintf(file, "\\u%04x", *c);
    else
      fprintf(file, *c == '"' || *c == '\\' ? "\\%c" : "%c", *c);
  }
  fputc('"', file);
}

/* What stands before a value: comma, line, indentation, key. */
static void Before(Json *json, const char key[])
{
  if (json->depth) {
    const PetscBool some = json->some[json->depth - 1];

    json->some[json->depth - 1] = PETSC_TRUE;
    fprintf(json->file, "%s\n%*s", some ? "," : "", (int)(2 * json->depth), "");
  }
  if (!key) return;
  Quote(json->file, key);
  fputs(": ", json->file);
}

static void Open(Json *json, const char key[], char open, char close)
{
  Before(json, key);
  fputc(open, json->file);
  PetscCheckAbort(json->depth < JSON_DEPTH, PETSC_COMM_SELF, PETSC_ERR_PLIB, "JSON deeper than %d", JSON_DEPTH);
  json->close[json->depth]  = close;
  json->some[json->depth++] = PETSC_FALSE;
}

void JsonObject(Json *json, const char key[])
{
  Open(json, key, '{', '}');
}

void JsonArray(Json *json, const char key[])
{
  Open(json, key, '[', ']');
}

void JsonEnd(Json *json)
{
  json->depth--;
  if (json->some[json->depth]) fprintf(json->file, "\n%*s", (int)(2 * json->depth), "");
  fputc(json->close[json->depth], json->file);
  if (!json->depth) fputc('\n', json->file);
}

void JsonText(Json *json, const char key[], const char text[])
{
  Before(json, key);
  if (text)
    Quote(json->file, text);
  else
    fputs("null", json->file);
}

static void Number(FILE *file, PetscReal value)
{
  if (PetscIsInfOrNanReal(value) || PetscAbsReal(value) >= PETSC_MAX_REAL)
    fputs("null", file);
  else
    fprintf(file, "%.17g", (double)value);
}

void JsonReal(Json *json, const char key[], PetscReal value)
{
  Before(json, key);
  Number(json->file, value);
}

void JsonInt(Json *json, const char key[], PetscInt value)
{
  Before(json, key);
  fprintf(json->file, "%" PetscInt_FMT, value);
}

void JsonBool(Json *json, const char key[], PetscBool value)
{
  Before(json, key);
  fputs(value ? "true" : "false", json->file);
}

void JsonReals(Json *json, const char key[], PetscInt n, const PetscReal value[])
{
  Before(json, key);
  fputc('[', json->file);
  for (PetscInt k = 0; k < n; k++) {
    if (k) fputs(", ", json->file);
    Number(json->file, value[k]);
  }
  fputc(']', json->file);
}
