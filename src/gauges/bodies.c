/* Position and motion of free bodies: columns of the series. */
#include "gauges_impl.h"

/* Columns of a body: centre, velocity, angle and angular velocity. The last two have one component in two dimensions,
   three in three. */
typedef enum { COLUMN_CENTER, COLUMN_VELOCITY, COLUMN_TURN, COLUMN_RATE, COLUMN_KINDS } Kind;

static const char *const KindNames[] = {"", "velocity_", "turn_", "rate_"};
static const char *const KindUnits[] = {"m", "m/s", "rad", "rad/s"};

/* Returns the number of components of a kind of column; 'first' is the first component. */
static PetscInt Directions(Domain domain, Kind kind, PetscInt *first)
{
  const PetscBool turning = (PetscBool)(kind >= COLUMN_TURN);

  if (domain->rings) {
    *first = 1;
    return turning ? 0 : 1;
  }
  *first = turning && domain->dim == 2 ? 2 : 0;
  return turning && domain->dim == 2 ? 1 : domain->dim;
}

/* The index in -solids of free body number k; -1: no such body. */
static PetscInt FreeBody(Scene scene, PetscInt k)
{
  for (PetscInt b = 0; b < SceneSolidCount(scene); b++)
    if (BodyMass(SceneSolid(scene, b)) > 0 && k-- == 0) return b;
  return -1;
}

static PetscInt ColumnsEach(Domain domain)
{
  PetscInt count = 0, first;

  for (PetscInt kind = 0; kind < COLUMN_KINDS; kind++) count += Directions(domain, (Kind)kind, &first);
  return count;
}

static PetscInt Columns_Bodies(Gauges gauges)
{
  PetscInt bodies = 0;

  while (FreeBody(gauges->cloud->scene, bodies) >= 0) bodies++;
  return bodies * ColumnsEach(gauges->cloud->domain);
}

static PetscErrorCode Name_Bodies(Gauges gauges, PetscInt column, char name[], size_t length)
{
  const Domain   domain = gauges->cloud->domain;
  const PetscInt each = ColumnsEach(domain), body = FreeBody(gauges->cloud->scene, column / each);
  PetscInt       index = column % each, kind = 0, first;

  PetscFunctionBegin;
  while (index >= Directions(domain, (Kind)kind, &first)) index -= Directions(domain, (Kind)kind++, &first);
  PetscCall(PetscSNPrintf(name, length, "%s_%s%c_%s", BodyName(SceneSolid(gauges->cloud->scene, body)), KindNames[kind],
                          AxisName(first + index), KindUnits[kind]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Measure_Bodies(Gauges gauges, PetscReal values[])
{
  const Domain domain = gauges->cloud->domain;

  PetscFunctionBegin;
  for (PetscInt k = 0, b; (b = FreeBody(gauges->cloud->scene, k)) >= 0; k++) {
    const Body solid = SceneSolid(gauges->cloud->scene, b);
    PetscReal  center[DIM], motion[FREE_MOTIONS], angle[DIM];

    FreeMotion(solid, center, motion);
    FreeTurned(solid, angle);
    const PetscReal *const kinds[] = {center, motion, angle, motion + DIM};

    for (PetscInt kind = 0; kind < COLUMN_KINDS; kind++) {
      PetscInt       first;
      const PetscInt count = Directions(domain, (Kind)kind, &first);

      for (PetscInt d = first; d < first + count; d++) *values++ = kinds[kind][d];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

const GaugeKind GaugeBodies = {.columns = Columns_Bodies, .name = Name_Bodies, .measure = Measure_Bodies};
