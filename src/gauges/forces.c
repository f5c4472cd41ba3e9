/* Forces of the liquid on the walls of the box and on solids: columns of the series. */
#include "../stepper/stepper.h"
#include "gauges_impl.h"

#define TIE 1e-6 /* spacings: depths that differ by less are equal */

typedef struct {
  PetscBool     forces;
  OptionNumbers about; /* m; none: no moments */
} Forces;

static const OptionRow options[] = {
  {"-gauge_forces",
   "Write to the series the force (drag, lift, buoyancy) of the liquid on each wall of the box and each solid (N), "
   "and the sum of the capillary forces at all contact lines; the force on a free solid differs slightly from the "
   "force that moves it",
   NULL, NULL, ROW_BOOL, offsetof(Forces, forces)},
  {"-gauge_moments",
   "Write to the series the moment (torque) of the liquid's pressure and friction about this point on each wall of "
   "the box and each solid, in two dimensions about z",
   "m", NULL, ROW_NUMBERS, offsetof(Forces, about), .fallback = "none", .most = DIM},
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

/* Components of a moment. */
static PetscInt MomentParts(Gauges gauges, const Forces *data)
{
  return data->about.count == 0 ? 0 : gauges->cloud->domain->dim == DIM ? DIM : 1;
}

static PetscErrorCode AddMoments(Gauges gauges, const Forces *data, ColumnList *list)
{
  const Domain   domain = gauges->cloud->domain;
  const PetscInt parts  = MomentParts(gauges, data);

  PetscFunctionBegin;
  if (parts == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheckUser(data->about.count == domain->dim, domain->comm,
                 "-gauge_moments has %" PetscInt_FMT " numbers; it must have the %" PetscInt_FMT
                 " coordinates of a point",
                 data->about.count, domain->dim);
  for (PetscInt d = 0; d < domain->dim; d++)
    PetscCheckUser(domain->face[d][0] != FACE_SYMMETRY && domain->face[d][1] != FACE_SYMMETRY, domain->comm,
                   "-gauge_moments cannot be used with symmetry faces or rings: the moment would lack that of the "
                   "liquid behind the mirror");
  for (PetscInt r = 0; r < GaugeReceivers(gauges); r++) {
    const Column row = {.unit = "Nm", .counts = COUNTS_SUM, .of = OF_RECEIVER, .index = r, .needs = NEEDS_PRESSURE};
    char         name[COLUMN_NAME_LENGTH];

    PetscCall(PetscSNPrintf(name, sizeof(name), "moment_%s", GaugeReceiverName(gauges, r)));
    PetscCall(ColumnAddVector(list, row, DIM - parts, DIM - 1, name));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Columns_Forces(Gauges gauges, const void *data, ColumnList *list)
{
  const PetscInt dim     = gauges->cloud->domain->dim;
  const Forces  *forces  = (const Forces *)data;
  const Column   contact = {.unit = "N", .counts = COUNTS_SUM, .needs = NEEDS_TENSION};

  PetscFunctionBegin;
  for (PetscInt r = 0; r < GaugeReceivers(gauges) && forces->forces; r++) {
    const Column row = {.unit = "N", .counts = COUNTS_SUM, .of = OF_RECEIVER, .index = r, .needs = NEEDS_PRESSURE};
    char         name[COLUMN_NAME_LENGTH];

    PetscCall(PetscSNPrintf(name, sizeof(name), "force_%s", GaugeReceiverName(gauges, r)));
    PetscCall(ColumnAddVector(list, row, 0, dim - 1, name));
  }
  for (PetscInt d = 0; d < dim && forces->forces; d++)
    if (HasContact(gauges, d)) PetscCall(ColumnAddVector(list, contact, d, d, "force_tension"));
  PetscCall(AddMoments(gauges, forces, list));
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

/* Adds forces on the dummy particles, ghosts too (on_dummy [n_total][3], N), to those of their receivers,
   [receivers][3] N, and to the moments about a point (m), [receivers][3] N m. */
static void AddToReceivers(Gauges gauges, PetscBool pressure, const PetscReal on_dummy[], const PetscReal about[DIM],
                           PetscReal force[], PetscReal moment[])
{
  Cloud          cloud = gauges->cloud;
  const PetscInt dim   = cloud->domain->dim;

  for (PetscInt b = cloud->n_fluid; b < cloud->n_total; b++) {
    const PetscReal *x    = cloud->field[FIELD_POSITION] + DIM * b;
    const PetscInt   body = cloud->integer[INT_BODY][b];
    PetscInt         to;

    if (!cloud->integer[INT_LAYER][b]) continue;
    to = Receiver(gauges, body, x);
    for (PetscInt d = 0; d < dim; d++) {
      const PetscInt  r         = pressure ? PressureReceiver(gauges, body, d, x, to) : to;
      const PetscReal arm[DIM]  = {x[0] - about[0], x[1] - about[1], x[2] - about[2]};
      PetscReal       part[DIM] = {0, 0, 0}, turning[DIM];

      part[d] = on_dummy[DIM * b + d];
      Cross(arm, part, turning);
      force[DIM * r + d] += part[d];
      for (PetscInt e = 0; e < DIM; e++) moment[DIM * r + e] += turning[e];
    }
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

/* Force [receivers][dim] of pressure and viscosity, then the capillary force; N, in two dimensions N/m; then the
   moments [receivers][parts], N m. */
static PetscErrorCode Measure_Forces(Gauges gauges, const void *data, PetscReal value[])
{
  const Forces  *forces    = (const Forces *)data;
  Cloud          cloud     = gauges->cloud;
  const PetscInt receivers = GaugeReceivers(gauges), dim = cloud->domain->dim, parts = MomentParts(gauges, forces);
  PetscReal     *on_dummy, *force, *moment, about[DIM] = {0, 0, 0};
  PetscInt       n = 0;

  PetscFunctionBegin;
  if (!forces->forces && parts == 0) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt d = 0; d < forces->about.count; d++) about[d] = forces->about.value[d];
  PetscCall(CloudUpdate(cloud, FIELD_PRESSURE));
  PetscCall(PetscCalloc2(DIM * receivers, &force, DIM * receivers, &moment));
  PetscCall(CloudGetWork(cloud, DIM, &on_dummy));
  PetscCall(OperatorsWallForce(cloud, gauges->corrected, on_dummy));
  if (gauges->pressure) PetscCall(PressureLoad(gauges->pressure, on_dummy));
  AddToReceivers(gauges, PETSC_TRUE, on_dummy, about, force, moment);
  if (gauges->viscosity) {
    PetscCall(CloudUpdate(cloud, FIELD_VELOCITY));
    PetscCall(OperatorsWallDrag(cloud, gauges->viscosity, cloud->field[FIELD_VELOCITY], on_dummy));
    if (gauges->run) PetscCall(StepperLoad((Stepper)gauges->run, on_dummy));
    AddToReceivers(gauges, PETSC_FALSE, on_dummy, about, force, moment);
  }
  PetscCall(CloudRestoreWork(cloud, &on_dummy));
  for (PetscInt k = 0; k < dim * receivers && forces->forces; k++) value[n++] = force[DIM * (k / dim) + k % dim];
  if (forces->forces) n += AddContactForce(gauges, value + n);
  for (PetscInt k = 0; k < parts * receivers; k++) value[n++] = moment[DIM * (k / parts) + DIM - parts + k % parts];
  PetscCall(PetscFree2(force, moment));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, value, (PetscMPIInt)n, MPIU_REAL, MPIU_SUM, gauges->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const GaugeKind GaugeForces = {.bytes      = sizeof(Forces),
                               .options    = options,
                               .columns    = Columns_Forces,
                               .measure    = Measure_Forces,
                               .needs_sums = PETSC_TRUE};
