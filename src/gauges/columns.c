/* Rows of columns: lists of them, their words, and what -gauge_multiplicity makes of their numbers. */
#include "gauges_impl.h"
#include <stdarg.h>

#define ON_MIRROR 0.5 /* spacings: a solid nearer than this to a mirror is cut by it */

PetscErrorCode ColumnAdd(ColumnList *list, Column row, const char format[], ...)
{
  va_list arguments;

  PetscFunctionBegin;
  PetscCall(ListGrow(list->count, &list->capacity, sizeof(*list->row), &list->row));
  va_start(arguments, format);
  PetscCall(PetscVSNPrintf(row.name, sizeof(row.name), format, NULL, arguments));
  va_end(arguments);
  list->row[list->count++] = row;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ColumnAddVector(ColumnList *list, Column row, PetscInt first, PetscInt last, const char name[])
{
  PetscFunctionBegin;
  for (PetscInt d = first; d <= last; d++) {
    row.component = AxisName(d);
    PetscCall(ColumnAdd(list, row, "%s%s%c", name, name[0] ? "_" : "", row.component));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ColumnAddFields(ColumnList *list, Column row, PetscInt n, const FieldId fields[], const char prefix[])
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < n; f++) {
    row.unit = strcmp(Fields[fields[f]].unit, "1") ? Fields[fields[f]].unit : NULL;
    PetscCall(ColumnAdd(list, row, "%s%s", prefix, Fields[fields[f]].name));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GaugesColumnWords(Gauges gauges, const Column *column, ColumnWords *words)
{
  static const char *const        counts[]            = {"run", "value", "sum"},
                           *const needs[COLUMN_NEEDS] = {"gravity", "tension", "viscosity", "pressure", "step"},
                           *const of[]                = {"scene", "face", "piece", "place", "particle"},
                           *const ways[]              = {"x", "y", "z"};
  const Domain                    domain              = gauges->cloud->domain;
  const PetscBool sum = (PetscBool)(column->counts == COUNTS_SUM), receiver = (PetscBool)(column->of == OF_RECEIVER);
  PetscInt        n = 0;

  PetscFunctionBegin;
  words->unit      = !column->unit ? "" : sum ? DomainUnit(domain, column->unit) : column->unit;
  words->counts    = counts[column->counts];
  words->of        = receiver && column->index >= GaugeWallFace(domain, -1, NULL, NULL) ? "solid" : of[column->of];
  words->whose     = receiver ? GaugeReceiverName(gauges, column->index) : "";
  words->extent    = !sum ? "" : domain->rings ? "around the ring" : domain->dim == 2 ? "per metre" : "whole";
  words->direction = "";
  if (column->component)
    words->direction = !domain->rings ? ways[column->component - 'x'] : column->component == 'x' ? "radial" : "axial";
  for (PetscInt k = 0; k < COLUMN_NEEDS; k++)
    if (column->needs & 1U << k) words->needs[n++] = needs[k];
  words->needs[n] = NULL;
  PetscCall(
    PetscSNPrintf(words->head, sizeof(words->head), "%s%s%s", column->name, words->unit[0] ? "_" : "", words->unit));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a mirror of direction d (m) cuts a receiver: a wall along d, or a solid on the mirror. */
static PetscBool Cuts(Gauges gauges, PetscInt receiver, PetscInt d, PetscReal mirror)
{
  const Domain   domain = gauges->cloud->domain;
  PetscInt       axis = -1, side = 0;
  const PetscInt faces = GaugeWallFace(domain, receiver, &axis, &side);
  PetscReal      lower[DIM], upper[DIM];

  if (receiver < faces) return (PetscBool)(axis != d);
  BodyBounds(SceneSolid(gauges->cloud->scene, receiver - faces), lower, upper);
  return (PetscBool)(PetscMax(lower[d] - mirror, mirror - upper[d]) <= ON_MIRROR * domain->spacing);
}

PetscReal GaugesFactor(Gauges gauges, const Column *column)
{
  const Domain domain = gauges->cloud->domain;
  PetscReal    copies = gauges->multiplicity, factor = 1;

  if (column->counts != COUNTS_SUM || (column->of != OF_SCENE && column->of != OF_RECEIVER)) return 1;
  for (PetscInt d = DomainFirstStraight(domain); d < domain->dim; d++) {
    const PetscReal mirror = GaugeMirror(domain, d, &copies);

    if (PetscIsInfOrNanReal(mirror) || (column->of == OF_RECEIVER && !Cuts(gauges, column->index, d, mirror))) continue;
    factor *= column->component == AxisName(d) ? 0 : 2;
  }
  return factor * copies;
}

PetscReal GaugeWhole(Gauges gauges, const PetscReal mirror[DIM], PetscReal center[DIM], PetscReal velocity[DIM],
                     PetscReal *number)
{
  const Domain domain = gauges->cloud->domain;
  PetscReal    larger = 1;

  *number = gauges->multiplicity;
  for (PetscInt d = 0; d < domain->dim; d++) {
    if (mirror[d] == 0 || *number < 2) continue;
    *number /= 2;
    larger *= 2;
    center[d] = mirror[d] < 0 ? domain->lower[d] : domain->upper[d];
    if (velocity) velocity[d] = 0;
  }
  return larger;
}

Cloud GaugesCloud(Gauges gauges)
{
  return gauges->cloud;
}
