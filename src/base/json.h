/* A writer of JSON (RFC 8259). A value in an object has a key, one in an array has none (NULL). Errors of the stream
   stay in it, for ferror. Not collective. */
#ifndef ISPH_JSON_H
#define ISPH_JSON_H

#include "base.h"
#include <stdio.h>

#define JSON_DEPTH 16 /* of objects and arrays in each other */

typedef struct {
  FILE     *file;              /* borrowed */
  PetscInt  depth;             /* of what is open */
  char      close[JSON_DEPTH]; /* of each */
  PetscBool some[JSON_DEPTH];  /* whether it has a value already */
} Json;

/* JsonObject, JsonArray - open an object or an array; JsonEnd closes the innermost. */
void JsonObject(Json *json, const char key[]);
void JsonArray(Json *json, const char key[]);
void JsonEnd(Json *json);
/* JsonText - text, with escapes; NULL: null. JsonReal - a number with all its digits; null if it is not finite or as
   large as PETSC_MAX_REAL, which stands for "none". JsonReals - an array of n numbers. */
void JsonText(Json *json, const char key[], const char text[]);
void JsonReal(Json *json, const char key[], PetscReal value);
void JsonInt(Json *json, const char key[], PetscInt value);
void JsonBool(Json *json, const char key[], PetscBool value);
void JsonReals(Json *json, const char key[], PetscInt n, const PetscReal value[]);

/* OptionsValues - writes the values of a struct by the rows of a table, with the names of the options; dim: numbers of
   a vector. A choice is left out: it has rows of its own. Not collective. */
void OptionsValues(Json *json, const OptionRow rows[], const void *data, PetscInt dim);
/* OptionsJson - writes the noted options as the array "options". scene: those that were read, bodies and all, with
   their values; else those of any scene, with <body> for the name of a body. Not collective. */
PetscErrorCode OptionsJson(Json *json, PetscBool scene);
/* UnitsJson - writes the object "units": for each unit of rows an array of those that may stand behind a number
   besides. Not collective. */
void UnitsJson(Json *json);

#endif
