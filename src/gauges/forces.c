/* Forces of the liquid on the walls of the box and on solids: columns of the series. */
#include "gauges_impl.h"

#define TIE 1e-6 /* spacings: depths that differ by less are equal */

static const OptionRow options[] = {
  {"-gauge_forces",
   "Write to the series the force of the liquid on each wall of the box and each solid (N), and the sum of the "
   "capillary forces at all contact lines; the force on a free solid differs slightly from the force that moves it",
   NULL, NULL, ROW_BOOL, 0},
  {.name = NULL},
};

/* Whether the series has the component d of the capillary force at contact lines. A direction with a mirror has no
   column, since the liquid behind the mirror does not count. Rings have the axial direction. */
static PetscBool HasContact(Gauges gauges, PetscInt d)
{
  const Domain domain = gauges->cloud->domain;

  return (PetscBool)(gauges->tension && GaugeReceivers(gauges) > 0 && !DomainIsRadial(domain, d) &&
                     domain->face[d][0] != FACE_SYMMETRY && domain->face[d][1] != FACE_SYMMETRY);
}

static PetscErrorCode Columns_Forces(Gauges gauges, const void *data, ColumnList *list)
{
  const PetscInt dim     = gauges->cloud->domain->dim;
  const Column   contact = {.unit = "N", .counts = COUNTS_SUM, .needs = NEEDS_TENSION};

  PetscFunctionBegin;
  if (!*(const PetscBool *)data) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt r = 0; r < GaugeReceivers(gauges); r++) {
    const Column row = {.unit = "N", .counts = COUNTS_SUM, .of = OF_RECEIVER, .index = r, .needs = NEEDS_PRESSURE};
    char         name[COLUMN_NAME_LENGTH];

    PetscCall(PetscSNPrintf(name, sizeof(name), "force_%s", GaugeReceiverName(gauges, r)));
    PetscCall(ColumnAddVector(list, row, 0, dim - 1, name));
  }
  for (PetscInt d = 0; d < dim; d++)
    if (HasContact(gauges, d)) PetscCall(ColumnAddVector(list, contact, d, d, "force_tension"));
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

/* Adds forces on the dummy particles, ghosts too (on_dummy [n_total][3], N), to their receivers. */
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

/* Adds the capillary force at contact lines; returns its number of components. Tension exerts the force
   -int sigma kappa n dA on the free surface. The integral over a closed surface vanishes, so its value is the force of
   the solids at the contact lines; the solids receive the opposite force. */
static PetscInt AddContactForce(Gauges gauges, PetscReal force[])
{
  Cloud            cloud  = gauges->cloud;
  const PetscReal *normal = cloud->field[FIELD_NORMAL], *capillary = cloud->field[FIELD_CAPILLARY];
  PetscInt         k = 0;

  for (PetscInt d = 0; d < cloud->domain->dim; d++) {
    if (!HasContact(gauges, d)) continue;
    force[k] = 0;
    for (PetscInt a = 0; a < cloud->n_fluid; a++) force[k] -= 2 * cloud->volume[a] * capillary[a] * normal[DIM * a + d];
    k++;
  }
  return k;
}

/* Force [receivers][dim] of pressure and viscosity, then the capillary force; N, in two dimensions N/m. */
static PetscErrorCode Measure_Forces(Gauges gauges, const void *data, PetscReal force[])
{
  Cloud      cloud   = gauges->cloud;
  PetscInt   columns = GaugeReceivers(gauges) * cloud->domain->dim;
  PetscReal *on_dummy;

  PetscFunctionBegin;
  PetscCall(CloudUpdate(cloud, FIELD_POSITION));
  PetscCall(CloudUpdate(cloud, FIELD_PRESSURE));
  PetscCall(PetscArrayzero(force, columns));
  PetscCall(CloudGetWork(cloud, DIM, &on_dummy));
  PetscCall(OperatorsWallForce(cloud, gauges->corrected, on_dummy));
  if (gauges->pressure) PetscCall(PressureLoad(gauges->pressure, on_dummy));
  AddToReceivers(gauges, PETSC_TRUE, on_dummy, force);
  if (gauges->viscosity) {
    PetscCall(CloudUpdate(cloud, FIELD_VELOCITY));
    PetscCall(OperatorsWallDrag(cloud, gauges->viscosity, cloud->field[FIELD_VELOCITY], on_dummy));
    AddToReceivers(gauges, PETSC_FALSE, on_dummy, force);
  }
  PetscCall(CloudRestoreWork(cloud, &on_dummy));
  columns += AddContactForce(gauges, force + columns);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, force, (PetscMPIInt)columns, MPIU_REAL, MPIU_SUM, gauges->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const GaugeKind GaugeForces = {.bytes      = sizeof(PetscBool),
                               .options    = options,
                               .columns    = Columns_Forces,
                               .measure    = Measure_Forces,
                               .needs_sums = PETSC_TRUE};
