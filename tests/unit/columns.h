/* The columns that gauges add to the series: how many, their names, the number of a name. */
#ifndef ISPH_COLUMNS_H
#define ISPH_COLUMNS_H

#include "../../src/gauges/gauges.h"
#include <string.h>

static inline PetscInt ColumnCount(Gauges gauges)
{
  PetscInt      count = -1;
  const Column *columns;

  return GaugesColumns(gauges, &count, &columns) ? -1 : count;
}

/* ColumnHead - the name of a column as the series has it, with its unit. */
static inline PetscErrorCode ColumnHead(Gauges gauges, PetscInt column, char head[], size_t length)
{
  PetscInt      count;
  const Column *columns;
  ColumnWords   words;

  PetscFunctionBegin;
  PetscCall(GaugesColumns(gauges, &count, &columns));
  PetscCall(GaugesColumnWords(gauges, &columns[column], &words));
  PetscCall(PetscStrncpy(head, words.head, length));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ColumnFind - the number of the column of this name, without its unit; -1: none. */
static inline PetscInt ColumnFind(Gauges gauges, const char name[])
{
  PetscInt      count;
  const Column *columns;

  if (GaugesColumns(gauges, &count, &columns)) return -1;
  for (PetscInt k = 0; k < count; k++)
    if (!strcmp(columns[k].name, name)) return k;
  return -1;
}

#endif
