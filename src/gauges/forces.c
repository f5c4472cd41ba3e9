/* Forces of the liquid on the walls of the box and on solids: columns of the series. */
#include "gauges_impl.h"

#define TIE 1e-6 /* spacings: depths that differ by less are equal */

static const char *const FaceNames[DIM][2] = {{"xmin", "xmax"}, {"ymin", "ymax"}, {"zmin", "zmax"}};

PetscInt GaugeWallFace(Domain domain, PetscInt index, PetscInt *direction, PetscInt *side)
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
                             "Write to the series the force of the liquid on each wall of the box and each solid (N), "
                             "and the sum of the capillary forces at all contact lines; the force on a free solid "
                             "differs slightly from the force that moves it",
                             "GaugesMeasure", gauges->forces, &gauges->forces, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt GaugeReceivers(Gauges gauges)
{
  return GaugeWallFace(gauges->cloud->domain, -1, NULL, NULL) + SceneSolidCount(gauges->cloud->scene);
}

const char *GaugeReceiverName(Gauges gauges, PetscInt receiver)
{
  PetscInt       d = 0, side = 0;
  const PetscInt faces = GaugeWallFace(gauges->cloud->domain, receiver, &d, &side);

  return receiver < faces ? FaceNames[d][side] : BodyName(SceneSolid(gauges->cloud->scene, receiver - faces));
}

/* Returns the number of columns of the capillary force at contact lines; direction: that of column 'index'. A direction
   with a mirror has no column, since the liquid behind the mirror does not count. Rings have the axial direction. */
static PetscInt ContactDirection(Gauges gauges, PetscInt index, PetscInt *direction)
{
  const Domain domain = gauges->cloud->domain;
  PetscInt     count  = 0;

  if (!gauges->tension || GaugeReceivers(gauges) == 0) return 0;
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
  return GaugeReceivers(gauges) * gauges->cloud->domain->dim + ContactDirection(gauges, -1, NULL);
}

static PetscErrorCode Name_Forces(Gauges gauges, PetscInt column, char name[], size_t length)
{
  const PetscInt dim = gauges->cloud->domain->dim, index = column / dim;
  PetscInt       d = 0;

  PetscFunctionBegin;
  if (index >= GaugeReceivers(gauges)) {
    (void)ContactDirection(gauges, column - GaugeReceivers(gauges) * dim, &d);
    PetscCall(PetscSNPrintf(name, length, "force_tension_%c_%s", AxisName(d), GaugeUnit(gauges->cloud->domain, "N")));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscSNPrintf(name, length, "force_%s_%c_%s", GaugeReceiverName(gauges, index), AxisName(column % dim),
                          GaugeUnit(gauges->cloud->domain, "N")));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The receiver of a dummy particle's force: its solid, or the wall behind which the particle lies deepest. Behind an
   edge of the box, the first of equally deep walls. */
static PetscInt Receiver(Gauges gauges, PetscInt body, const PetscReal x[DIM])
{
  const Domain   domain  = gauges->cloud->domain;
  const PetscInt faces   = GaugeWallFace(domain, -1, NULL, NULL);
  PetscInt       best    = 0;
  PetscReal      deepest = PETSC_MIN_REAL;

  if (body <= BODY_SOLID) return faces + BODY_SOLID - body;
  for (PetscInt f = 0; f < faces; f++) {
    PetscInt  d = 0, s = 0;
    PetscReal depth;

    (void)GaugeWallFace(domain, f, &d, &s);
    depth = s ? x[d] - domain->upper[d] : domain->lower[d] - x[d];
    if (depth > deepest + TIE * domain->spacing) {
      deepest = depth;
      best    = f;
    }
  }
  return best;
}

/* The receiver of component d of a dummy particle's pressure force. Behind an edge of the box, the wall with the normal
   d takes this component. */
static PetscInt PressureReceiver(Gauges gauges, PetscInt body, PetscInt d, const PetscReal x[DIM], PetscInt receiver)
{
  const Domain   domain = gauges->cloud->domain;
  const PetscInt faces  = GaugeWallFace(domain, -1, NULL, NULL);

  for (PetscInt f = 0; f < faces && body > BODY_SOLID; f++) {
    PetscInt direction = 0, side = 0;

    (void)GaugeWallFace(domain, f, &direction, &side);
    if (direction == d && (side ? x[d] > domain->upper[d] : x[d] < domain->lower[d])) return f;
  }
  return receiver;
}

/* Adds the forces of this rank's fluid on the dummy particles, ghosts too (on_dummy [n_total][3], N), to their
   receivers. */
static void AddToReceivers(Gauges gauges, PetscBool pressure, const PetscReal on_dummy[], PetscReal force[])
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
      force[dim * (pressure ? PressureReceiver(gauges, body, d, x, to) : to) + d] += on_dummy[DIM * b + d];
  }
}

/* Adds the capillary force at contact lines. Tension exerts the force -int sigma kappa n dA on the free surface. The
   integral over a closed surface vanishes, so its value is the force of the solids at the contact lines; the solids
   receive the opposite force. */
static void AddContactForce(Gauges gauges, PetscReal force[])
{
  Cloud            cloud   = gauges->cloud;
  const PetscInt   columns = ContactDirection(gauges, -1, NULL);
  const PetscReal *normal = cloud->field[FIELD_NORMAL], *capillary = cloud->field[FIELD_CAPILLARY];

  for (PetscInt k = 0; k < columns; k++) {
    PetscInt d = 0;

    (void)ContactDirection(gauges, k, &d);
    for (PetscInt a = 0; a < cloud->n_fluid; a++) force[k] -= 2 * cloud->volume[a] * capillary[a] * normal[DIM * a + d];
  }
}

/* Force [receivers][dim] of pressure and viscosity, then the capillary force; N, in two dimensions N/m. */
static PetscErrorCode Measure_Forces(Gauges gauges, PetscReal force[])
{
  Cloud          cloud   = gauges->cloud;
  const PetscInt columns = Columns_Forces(gauges);
  PetscReal     *on_dummy;

  PetscFunctionBegin;
  PetscCall(CloudUpdate(cloud, FIELD_POSITION));
  PetscCall(CloudUpdate(cloud, FIELD_PRESSURE));
  PetscCall(PetscArrayzero(force, columns));
  PetscCall(CloudGetWork(cloud, DIM, &on_dummy));
  PetscCall(OperatorsWallForce(cloud, gauges->corrected, on_dummy));
  AddToReceivers(gauges, PETSC_TRUE, on_dummy, force);
  if (gauges->viscosity) {
    PetscCall(CloudUpdate(cloud, FIELD_VELOCITY));
    PetscCall(OperatorsWallDrag(cloud, gauges->viscosity, cloud->field[FIELD_VELOCITY], on_dummy));
    AddToReceivers(gauges, PETSC_FALSE, on_dummy, force);
  }
  PetscCall(CloudRestoreWork(cloud, &on_dummy));
  AddContactForce(gauges, force + GaugeReceivers(gauges) * cloud->domain->dim);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, force, (PetscMPIInt)columns, MPIU_REAL, MPIU_SUM, gauges->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const GaugeKind GaugeForces = {.setfromoptions = SetFromOptions_Forces,
                               .columns        = Columns_Forces,
                               .name           = Name_Forces,
                               .measure        = Measure_Forces,
                               .needs_sums     = PETSC_TRUE};
