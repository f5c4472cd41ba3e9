/* Finds the option that a misspelt name means. */
#include "base.h"
#include <stdio.h>
#include <string.h>

#define WORD_LENGTH 128

PetscInt WordDistance(const char a[], const char b[])
{
  PetscInt       row[3][WORD_LENGTH + 1]; /* of the last three letters of a */
  const PetscInt n = (PetscInt)PetscMin(strlen(b), WORD_LENGTH);

  for (PetscInt j = 0; j <= n; j++) row[0][j] = j;
  for (PetscInt i = 1; a[i - 1]; i++) {
    PetscInt *now = row[i % 3], *before = row[(i + 2) % 3], *two_before = row[(i + 1) % 3];

    now[0] = i;
    for (PetscInt j = 1; j <= n; j++) {
      now[j] = PetscMin(PetscMin(now[j - 1], before[j]) + 1, before[j - 1] + (a[i - 1] != b[j - 1]));
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        now[j] = PetscMin(now[j], two_before[j - 2] + 1);
    }
  }
  return row[strlen(a) % 3][n];
}

PetscInt WordsAlike(const char name[])
{
  const size_t length = strlen(name);

  return length < 4 ? 0 : length < 8 ? 1 : length < 16 ? 2 : 3;
}

const char *OptionMeant(const char option[])
{
  static char text[2 * WORD_LENGTH];
  PetscInt    n = 0, count;
  char      **names, **values;

  text[0] = 0;
  if (PetscOptionsLeftGet(NULL, &n, &names, &values)) return text;
  for (PetscInt k = 0; k < n && !text[0]; k++)
    if (WordDistance(names[k], option + 1) <= WordsAlike(option + 1))
      (void)snprintf(text, sizeof(text), " (is -%.100s meant for it?)", names[k]);
  count = n;
  (void)PetscOptionsLeftRestore(NULL, &count, &names, &values);
  return text;
}
