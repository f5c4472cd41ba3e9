/* Forces of the liquid on the walls of the box and on solids: columns of the series. */
#include "gauges_impl.h"

#define TIE 1e-6 /* spacings within which depths are equal */

static const char *const FaceNames[DIM][2] = {{"xmin", "xmax"}, {"ymin", "ymax"}, {"zmin", "zmax"}};

/* The wall faces of the box in order: direction and side of number 'index'; returns their number. */
static PetscInt WallFace(Domain domain, PetscInt index, PetscInt *direction, PetscInt *side)
{
  PetscInt count = 0;

  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt s = 0; s < 2; s++) {
      if (domain->face[d][s] != FACE_WALL) continue;
      if (count == index) {
        *direction = d;
        *side      = s;
      }
      count++;
    }
  return count;
}

static PetscErrorCode SetFromOptions_Forces(Gauges gauges, OptionItems PetscOptionsObject)
{
  PetscFunctionBegin;
  PetscCall(PetscOptionsBool("-gauge_forces",
                             "The series holds the force of the liquid on each wall of the box and each solid (N), and "
                             "the pull of surface tension at all lines of contact together; "
                             "of a solid that moves freely, not exactly the one that moves it",
                             "GaugesMeasure", gauges->forces, &gauges->forces, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How many walls and solids there are. */
static PetscInt ReceiverCount(Gauges gauges)
{
  return WallFace(gauges->cloud->domain, -1, NULL, NULL) + SceneSolidCount(gauges->cloud->scene);
}

/* How many columns the pull of lines of contact has, and the direction of number 'index': those without a mirror,
   behind which there is liquid that is not counted, and of rings that along the axis. */
static PetscInt PullDirection(Gauges gauges, PetscInt index, PetscInt *direction)
{
  const Domain domain = gauges->cloud->domain;
  PetscInt     count  = 0;

  if (!gauges->tension || ReceiverCount(gauges) == 0) return 0;
  for (PetscInt d = domain->rings ? 1 : 0; d < domain->dim; d++) {
    if (domain->face[d][0] == FACE_SYMMETRY || domain->face[d][1] == FACE_SYMMETRY) continue;
    if (count == index) *direction = d;
    count++;
  }
  return count;
}

static PetscInt Columns_Forces(Gauges gauges)
{
  if (!gauges->forces) return 0;
  return ReceiverCount(gauges) * gauges->cloud->domain->dim + PullDirection(gauges, -1, NULL);
}

static PetscErrorCode Name_Forces(Gauges gauges, PetscInt column, char name[], size_t length)
{
  const PetscInt dim = gauges->cloud->domain->dim, index = column / dim;
  PetscInt       d = 0, s = 0;
  const PetscInt faces = WallFace(gauges->cloud->domain, index, &d, &s);

  PetscFunctionBegin;
  if (index >= ReceiverCount(gauges)) {
    (void)PullDirection(gauges, column - ReceiverCount(gauges) * dim, &d);
    PetscCall(PetscSNPrintf(name, length, "force_tension_%c_%s", AxisName(d), GaugeUnit(gauges->cloud->domain, "N")));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscSNPrintf(name, length, "force_%s_%c_%s",
                          index < faces ? FaceNames[d][s] : BodyName(SceneSolid(gauges->cloud->scene, index - faces)),
                          AxisName(column % dim), GaugeUnit(gauges->cloud->domain, "N")));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which receiver a dummy particle belongs to: its solid, or the wall that it is deepest behind, of equals
   (behind an edge) the first. */
static PetscInt Receiver(Gauges gauges, PetscInt body, const PetscReal x[DIM])
{
  const Domain   domain  = gauges->cloud->domain;
  const PetscInt faces   = WallFace(domain, -1, NULL, NULL);
  PetscInt       best    = 0;
  PetscReal      deepest = PETSC_MIN_REAL;

  if (body <= BODY_SOLID) return faces + BODY_SOLID - body;
  for (PetscInt f = 0; f < faces; f++) {
    PetscInt  d = 0, s = 0;
    PetscReal depth;

    (void)WallFace(domain, f, &d, &s);
    depth = s ? x[d] - domain->upper[d] : domain->lower[d] - x[d];
    if (depth > deepest + TIE * domain->spacing) {
      deepest = depth;
      best    = f;
    }
  }
  return best;
}

/* Which wall takes the pressure along direction d of a dummy particle behind an edge: that whose normal it is. */
static PetscInt Across(Gauges gauges, PetscInt body, PetscInt d, const PetscReal x[DIM], PetscInt receiver)
{
  const Domain   domain = gauges->cloud->domain;
  const PetscInt faces  = WallFace(domain, -1, NULL, NULL);

  for (PetscInt f = 0; f < faces && body > BODY_SOLID; f++) {
    PetscInt direction = 0, side = 0;

    (void)WallFace(domain, f, &direction, &side);
    if (direction == d && (side ? x[d] > domain->upper[d] : x[d] < domain->lower[d])) return f;
  }
  return receiver;
}

/* Adds what the dummy particles, ghosts too, hold of the fluid of this rank ([n_total][3], N) to their receivers. */
static void AddToReceivers(Gauges gauges, PetscBool pressure, const PetscReal held[], PetscReal force[])
{
  Cloud          cloud = gauges->cloud;
  const PetscInt dim   = cloud->domain->dim;

  for (PetscInt b = cloud->n_fluid; b < cloud->n_total; b++) {
    const PetscReal *x    = cloud->field[FIELD_POSITION] + DIM * b;
    const PetscInt   body = cloud->integer[INT_BODY][b];
    PetscInt         to;

    if (!cloud->integer[INT_LAYER][b]) continue;
    to = Receiver(gauges, body, x);
    for (PetscInt d = 0; d < dim; d++)
      force[dim * (pressure ? Across(gauges, body, d, x, to) : to) + d] += held[DIM * b + d];
  }
}

/* Adds the pull at lines of contact: tension pushes on the free surface, -int sigma kappa n dA, and would not push on
   liquid as a whole if no solid pulled it by its edge; it pulls the solid back as much. */
static void AddPull(Gauges gauges, PetscReal pull[])
{
  Cloud            cloud   = gauges->cloud;
  const PetscInt   columns = PullDirection(gauges, -1, NULL);
  const PetscReal *normal = cloud->field[FIELD_NORMAL], *capillary = cloud->field[FIELD_CAPILLARY];

  for (PetscInt k = 0; k < columns; k++) {
    PetscInt d = 0;

    (void)PullDirection(gauges, k, &d);
    for (PetscInt a = 0; a < cloud->n_fluid; a++) pull[k] -= 2 * cloud->volume[a] * capillary[a] * normal[DIM * a + d];
  }
}

/* Force [receivers][dim] of the liquid's pressure and viscosity, and the pull of its tension, N (N/m in two
   dimensions). */
static PetscErrorCode Measure_Forces(Gauges gauges, PetscReal force[])
{
  Cloud          cloud   = gauges->cloud;
  const PetscInt columns = Columns_Forces(gauges);
  PetscReal     *held;

  PetscFunctionBegin;
  PetscCall(CloudUpdate(cloud, FIELD_POSITION));
  PetscCall(CloudUpdate(cloud, FIELD_PRESSURE));
  PetscCall(PetscArrayzero(force, columns));
  PetscCall(CloudGetWork(cloud, DIM, &held));
  PetscCall(OperatorsWallForce(cloud, gauges->corrected, held));
  AddToReceivers(gauges, PETSC_TRUE, held, force);
  if (gauges->viscosity) {
    PetscCall(CloudUpdate(cloud, FIELD_VELOCITY));
    PetscCall(OperatorsWallDrag(cloud, gauges->viscosity, cloud->field[FIELD_VELOCITY], held));
    AddToReceivers(gauges, PETSC_FALSE, held, force);
  }
  PetscCall(CloudRestoreWork(cloud, &held));
  AddPull(gauges, force + ReceiverCount(gauges) * cloud->domain->dim);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, force, (PetscMPIInt)columns, MPIU_REAL, MPIU_SUM, gauges->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const GaugeKind GaugeForces = {.setfromoptions = SetFromOptions_Forces,
                               .columns        = Columns_Forces,
                               .name           = Name_Forces,
                               .measure        = Measure_Forces,
                               .needs_sums     = PETSC_TRUE};
