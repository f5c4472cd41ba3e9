/* Position and motion of free bodies: columns of the series. */
#include "bodies_impl.h"

/* Columns of a body: centre, velocity, angle and angular velocity. The last two have one component in two dimensions,
   three in three. */
typedef enum { COLUMN_CENTER, COLUMN_VELOCITY, COLUMN_TURN, COLUMN_RATE, COLUMN_KINDS } Kind;

static const char *const KindNames[] = {"", "_velocity", "_turn", "_rate"};
static const char *const KindUnits[] = {"m", "m/s", "rad", "rad/s"};

/* Returns the number of components of a kind of column; 'first' is the first component. */
static PetscInt Directions(Domain domain, Kind kind, PetscInt *first)
{
  const PetscBool turning = (PetscBool)(kind >= COLUMN_TURN);

  *first = turning && domain->dim == 2 ? 2 : DomainFirstStraight(domain);
  if (turning && domain->dim == 2) return DomainIsFlat(domain) ? 1 : 0;
  return domain->dim - *first;
}

/* The index in -solids of free body number k; -1: no such body. */
static PetscInt FreeBody(Scene scene, PetscInt k)
{
  for (PetscInt b = 0; b < SceneSolidCount(scene); b++)
    if (BodyMass(SceneSolid(scene, b)) > 0 && k-- == 0) return b;
  return -1;
}

static PetscErrorCode Columns_Bodies(Gauges gauges, const void *data, ColumnList *list)
{
  const Scene scene = GaugesCloud(gauges)->scene;

  PetscFunctionBegin;
  for (PetscInt k = 0, b; (b = FreeBody(scene, k)) >= 0; k++)
    for (PetscInt kind = 0; kind < COLUMN_KINDS; kind++) {
      const Column row = {.unit   = KindUnits[kind],
                          .counts = COUNTS_VALUE,
                          .of     = OF_RECEIVER,
                          .index  = GaugeWallFace(GaugesCloud(gauges)->domain, -1, NULL, NULL) + b};
      char         name[COLUMN_NAME_LENGTH];
      PetscInt     first = 0, count = Directions(GaugesCloud(gauges)->domain, (Kind)kind, &first);

      PetscCall(PetscSNPrintf(name, sizeof(name), "%s%s", BodyName(SceneSolid(scene, b)), KindNames[kind]));
      PetscCall(ColumnAddVector(list, row, first, first + count - 1, name));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Measure_Bodies(Gauges gauges, const void *data, PetscReal values[])
{
  const Domain domain = GaugesCloud(gauges)->domain;

  PetscFunctionBegin;
  for (PetscInt k = 0, b; (b = FreeBody(GaugesCloud(gauges)->scene, k)) >= 0; k++) {
    const Body solid = SceneSolid(GaugesCloud(gauges)->scene, b);
    PetscReal  center[DIM], motion[RIGID_MOTIONS], angle[DIM];

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

const GaugeKind GaugeBodies = {.columns = Columns_Bodies, .measure = Measure_Bodies};
