#include "halo.h"
#include "work.h"

/* Cell of the canonical order of ParticlesSort, in kernel supports. */
#define SORT_CELL 1.0
/* Particles may be outside their rank's cells by this share of the slack before they migrate. */
#define OUTSIDE_SHARE 0.6
/* Largest distance outside that is measured, in slacks: since the last measurement a particle has moved by less than
   one. */
#define OUTSIDE_LIMIT 2
/* Ratio of the largest to the mean number of particles of a rank that triggers a new partition. */
#define IMBALANCE 1.2

PetscErrorCode CloudCreate(Domain domain, Scene scene, Kernel kernel, Particles particles, PetscReal reach,
                           Cloud *cloud)
{
  Cloud c;

  PetscFunctionBegin;
  PetscCall(PetscNew(&c));
  c->comm          = domain->comm;
  c->domain        = domain;
  c->scene         = scene;
  c->kernel        = kernel;
  c->particles     = particles;
  c->reach         = reach;
  c->size_most     = DomainSizeMax(domain);
  c->slack         = domain->spacing_coarse;
  c->sort_interval = 100;
  PetscCall(HaloCreate(domain, &c->halo));
  if (domain->rings) KernelAxisTable(kernel, AXIS_TABLE, c->axis);
  if (domain->adaptive) PetscCall(domain->adaptive->start(domain, scene));
  *cloud = c;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const OptionRow options[] = {
  {"-sort_interval", "Steps between two sorts of the particles along the cells", "1", "[1, inf)", ROW_INT,
   offsetof(struct _p_Cloud, sort_interval)},
  {.name = NULL},
};

PetscErrorCode CloudSetFromOptions(Cloud cloud)
{
  PetscFunctionBegin;
  PetscCall(OptionsReadBlock(cloud->comm, "Neighbours and domain decomposition", options, __func__, cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CloudIdentity(Cloud cloud, char **text)
{
  size_t length;
  FILE  *stream = open_memstream(text, &length);

  PetscFunctionBegin;
  PetscCheck(stream, PETSC_COMM_SELF, PETSC_ERR_MEM, "cannot keep a text");
  PetscCall(SceneIdentity(cloud->scene, stream));
  fprintf(stream, "-kernel_type = %s\n-kernel_ratio = %.12g\n", KernelType(cloud->kernel),
          (double)(KernelSmoothingLength(cloud->kernel) / cloud->domain->spacing));
  PetscCheck(!fclose(stream), PETSC_COMM_SELF, PETSC_ERR_MEM, "cannot keep a text");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a field is first written when another is no longer read, and so has that one's memory. */
static PetscBool Borrows(PetscInt f)
{
  return (PetscBool)(f == FIELD_POSITION_NEW || f == FIELD_VELOCITY_NEW);
}

/* Whether a field has memory of its own. */
static PetscBool Needs(Cloud cloud, PetscInt f)
{
  if (f == FIELD_BENDING) return (PetscBool)(cloud->domain->adaptive != NULL);
  return (PetscBool)(!Borrows(f) &&
                     (f >= FIELD_STORED_COUNT || f == FIELD_VOLUME || f == FIELD_SIZE || /* all ask for these two */
                      ParticlesHave(cloud->particles, f)));
}

PetscErrorCode CloudDestroy(Cloud *cloud)
{
  Cloud c = *cloud;

  PetscFunctionBegin;
  if (!c) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CloudFreeWork(c));
  PetscCall(HaloDestroy(&c->halo));
  if (c->weight != c->size) {
    PetscCall(PetscFree(c->weight));
    PetscCall(PetscFree(c->length));
    PetscCall(PetscFree(c->relative_weight));
  }
  for (PetscInt f = 0; f < FIELD_COUNT; f++)
    if (!Borrows(f)) PetscCall(PetscFree(c->field[f]));
  for (PetscInt f = 0; f < INT_COUNT; f++) PetscCall(PetscFree(c->integer[f]));
  PetscCall(PetscFree(c->rest_density));
  PetscCall(PetscFree(c->solid_normal));
  PetscCall(PetscFree(c->liquid));
  PetscCall(PetscFree(c->at_interface));
  PetscCall(PetscFree(c->pressure_jump));
  PetscCall(PetscFree(c->pressure_jump_slope));
  PetscCall(PetscFree(c->reference));
  PetscCall(PetscFree(c->first));
  PetscCall(PetscFree(c->laplacian_sum));
  PetscCall(PetscFree(c->list));
  PetscCall(PetscFree(c->slope));
  PetscCall(PetscFree(c->laplacian));
  for (PetscInt l = 0; l < SEARCH_LEVELS; l++) PetscCall(CellGridReset(&c->grid[l]));
  PetscCall(PetscFree(*cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes room for n particles in every array; contents are kept. */
static PetscErrorCode Reserve(Cloud cloud, PetscInt n)
{
  PetscFunctionBegin;
  /* a rank without particles has the arrays, too; room for one particle more, since vectors of three are loaded as
     four */
  if (cloud->first && n < cloud->capacity) PetscFunctionReturn(PETSC_SUCCESS);
  cloud->capacity = n + n / 8 + 64;
  for (PetscInt f = 0; f < FIELD_COUNT; f++)
    if (Needs(cloud, f))
      PetscCall(PetscRealloc(cloud->capacity * Fields[f].width * sizeof(PetscReal), &cloud->field[f]));
  cloud->field[FIELD_POSITION_NEW] = cloud->field[FIELD_ACCELERATION];
  cloud->field[FIELD_VELOCITY_NEW] = cloud->field[FIELD_CAPILLARY_SLOPE];
  for (PetscInt f = 0; f < INT_COUNT; f++)
    PetscCall(PetscRealloc(cloud->capacity * sizeof(PetscInt), &cloud->integer[f]));
  cloud->volume = cloud->field[FIELD_VOLUME];
  cloud->size   = cloud->field[FIELD_SIZE];
  if (ParticlesHave(cloud->particles, FIELD_VOLUME)) {
    PetscCall(PetscRealloc(cloud->capacity * sizeof(PetscReal), &cloud->weight));
    PetscCall(PetscRealloc(cloud->capacity * sizeof(PetscReal), &cloud->length));
    PetscCall(PetscRealloc(cloud->capacity * sizeof(PetscReal), &cloud->relative_weight));
  } else
    cloud->weight = cloud->length = cloud->relative_weight = cloud->size; /* all are 1 */
  PetscCall(PetscRealloc(cloud->capacity * sizeof(PetscReal), &cloud->rest_density));
  PetscCall(PetscRealloc(cloud->capacity * DIM * sizeof(PetscReal), &cloud->reference));
  if (SceneSolidCount(cloud->scene))
    PetscCall(PetscRealloc(cloud->capacity * DIM * sizeof(PetscReal), &cloud->solid_normal));
  if (SceneInterfaceTension(cloud->scene) > 0) {
    PetscCall(PetscRealloc(cloud->capacity * sizeof(PetscInt), &cloud->liquid));
    PetscCall(PetscRealloc(cloud->capacity * sizeof(PetscInt), &cloud->at_interface));
    PetscCall(PetscRealloc(cloud->capacity * sizeof(PetscReal), &cloud->pressure_jump));
    PetscCall(PetscRealloc(cloud->capacity * DIM * sizeof(PetscReal), &cloud->pressure_jump_slope));
    PetscCall(PetscArrayzero(cloud->pressure_jump, cloud->capacity)); /* no jump before the first TensionApply */
    PetscCall(PetscArrayzero(cloud->pressure_jump_slope, DIM * cloud->capacity));
  }
  PetscCall(PetscRealloc((cloud->capacity + 1) * sizeof(PetscInt64), &cloud->first));
  PetscCall(PetscRealloc(cloud->capacity * sizeof(PetscInt), &cloud->laplacian_sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Copies the stored fields from the swarm. */
static PetscErrorCode Load(Cloud cloud)
{
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(cloud->particles, &arrays));
  cloud->n_owned = arrays.n;
  PetscCall(Reserve(cloud, PetscMax(arrays.n, cloud->n_total)));
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++)
    if (arrays.real[f]) PetscCall(PetscArraycpy(cloud->field[f], arrays.real[f], arrays.n * Fields[f].width));
  for (PetscInt f = 0; f < INT_COUNT; f++) PetscCall(PetscArraycpy(cloud->integer[f], arrays.integer[f], arrays.n));
  PetscCall(ParticlesClose(cloud->particles, &arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Counts the particles of each kind; the swarm's sort has put them in this order. Invalidates the work fields, which
   are still in the old order. */
static void CountKinds(Cloud cloud)
{
  const PetscInt *layer = cloud->integer[INT_LAYER];

  for (PetscInt f = FIELD_STORED_COUNT; f < FIELD_COUNT; f++)
    for (PetscInt k = 0; cloud->field[f] && k < Fields[f].width * cloud->n_owned; k++) cloud->field[f][k] = NAN;
  cloud->n_fluid = cloud->n_rows = 0;
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    cloud->n_fluid += layer[a] == 0;
    cloud->n_rows += layer[a] <= 1;
  }
  cloud->layout++;
}

/* Finds the sizes of the particles begin to end - 1 from their volumes. Graded rings have stored sizes. */
static PetscErrorCode FindSizes(Cloud cloud, PetscInt begin, PetscInt end)
{
  PetscReal most = 0;

  PetscFunctionBegin;
  for (PetscInt a = begin; a < end; a++) {
    if (!ParticlesHave(cloud->particles, FIELD_SIZE))
      cloud->size[a] = cloud->domain->graded ? DomainSize(cloud->domain, cloud->volume[a]) : 1;
    most = PetscMax(most, cloud->size[a]);
  }
  PetscCheck(most <= (1 + POINT_TOLERANCE) * cloud->size_most, PETSC_COMM_SELF, PETSC_ERR_PLIB,
             "a particle has %g times the spacing, more than -spacing_coarse allows", (double)most);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CloudFindSolidNormals(Cloud cloud)
{
  PetscFunctionBegin;
  if (!SceneSolidCount(cloud->scene)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscArrayzero(cloud->solid_normal, DIM * cloud->n_total));
  for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++)
    if (cloud->integer[INT_BODY][a] <= BODY_SOLID)
      SceneSolidNormal(cloud->scene, cloud->field[FIELD_POSITION] + DIM * a, cloud->solid_normal + DIM * a);
  PetscCall(HaloUpdate(cloud->halo, DIM, PARITY_VECTOR, cloud->solid_normal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Chooses the ghosts from the present positions and gives them all values that stay until the next choice. */
static PetscErrorCode BuildHalo(Cloud cloud)
{
  PetscReal   most[2] = {0, 0}; /* distance outside, volume */
  PetscMPIInt rank;
  PetscInt    ghosts;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(cloud->comm, &rank));
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_HALO), 0, 0, 0, 0));
  /* Every particle gets all ghosts within reach + slack, even before it has migrated or been wrapped. */
  most[0] = HaloDistanceOutside(cloud->domain, rank, cloud->n_owned, cloud->field[FIELD_POSITION],
                                OUTSIDE_LIMIT * cloud->slack);
  for (PetscInt a = 0; a < cloud->n_owned; a++)
    most[1] =
      PetscMax(most[1], ParticlesHave(cloud->particles, FIELD_VOLUME) ? cloud->volume[a] : cloud->domain->volume);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, most, 2, MPIU_REAL, MPIU_MAX, cloud->comm));
  cloud->distance_outside = most[0];
  cloud->volume_most      = most[1];
  PetscCall(FindSizes(cloud, 0, cloud->n_owned));
  PetscCall(HaloBuild(cloud->halo, cloud->n_owned, cloud->field[FIELD_POSITION], cloud->reach,
                      cloud->slack + cloud->distance_outside, cloud->domain->graded ? cloud->size : NULL,
                      cloud->size_most, &ghosts));
  PetscCall(ParticlesCheckRoom(cloud->comm, (PetscInt64)cloud->n_owned + ghosts));
  cloud->n_total = cloud->n_owned + ghosts;
  PetscCall(Reserve(cloud, cloud->n_total));
  for (PetscInt f = 0; f < INT_COUNT; f++) PetscCall(HaloUpdateInt(cloud->halo, cloud->integer[f]));
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    const PetscInt body = cloud->integer[INT_BODY][a];

    if (!ParticlesHave(cloud->particles, FIELD_VOLUME)) cloud->volume[a] = cloud->domain->volume;
    cloud->rest_density[a] = BodyMaterial(SceneBody(cloud->scene, PetscMax(body, 0)))->density;
    if (cloud->liquid) cloud->liquid[a] = body < 0 ? -1 : SceneLiquid(cloud->scene, body);
  }
  if (ParticlesHave(cloud->particles, FIELD_VOLUME)) PetscCall(CloudUpdate(cloud, FIELD_VOLUME));
  if (ParticlesHave(cloud->particles, FIELD_SIZE)) PetscCall(CloudUpdate(cloud, FIELD_SIZE));
  PetscCall(FindSizes(cloud, cloud->n_owned, cloud->n_total));
  PetscCall(CloudFindSolidNormals(cloud));
  PetscCall(PetscArraycpy(cloud->reference, cloud->field[FIELD_POSITION], DIM * cloud->n_owned));
  cloud->halo_builds++;
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_HALO), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Updates the ghosts' values of the fields from which a step starts. */
static PetscErrorCode UpdateGhosts(Cloud cloud)
{
  PetscFunctionBegin;
  PetscCall(CloudUpdate(cloud, FIELD_POSITION));
  PetscCall(CloudUpdate(cloud, FIELD_VELOCITY));
  PetscCall(CloudUpdate(cloud, FIELD_PRESSURE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WrapSwarm(Cloud cloud)
{
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(cloud->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++)
    if (arrays.integer[INT_LAYER][a] == 0) DomainWrap(cloud->domain, arrays.real[FIELD_POSITION] + DIM * a);
  PetscCall(ParticlesClose(cloud->particles, &arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sends the particles to their ranks, with 'partition' after a new partition, sorts and loads them. */
static PetscErrorCode Rehome(Cloud cloud, PetscBool partition)
{
  PetscFunctionBegin;
  PetscCall(WrapSwarm(cloud));
  if (partition) {
    PetscCall(ParticlesRepartition(cloud->particles));
    cloud->repartitions++;
  } else
    PetscCall(ParticlesMigrate(cloud->particles));
  cloud->migrations++;
  PetscCall(ParticlesSort(cloud->particles, SORT_CELL * KernelSupport(cloud->kernel)));
  PetscCall(Load(cloud));
  CountKinds(cloud);
  cloud->distance_outside = 0;
  cloud->since_sort       = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CloudReload(Cloud cloud)
{
  PetscFunctionBegin;
  PetscCall(Rehome(cloud, PETSC_TRUE));
  PetscCall(BuildHalo(cloud));
  PetscCall(UpdateGhosts(cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CloudResync(Cloud cloud)
{
  PetscFunctionBegin;
  PetscCall(CloudReload(cloud));
  PetscCall(CloudSearch(cloud, NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Largest displacement (m) of an owned particle since the ghosts were chosen, over all ranks. Ghosts are complete while
   twice this fits into the slack. */
static PetscErrorCode Displacement(Cloud cloud, PetscReal *moved)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], *r = cloud->reference;
  PetscReal        largest2 = 0;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_owned; a++)
    largest2 = PetscMax(largest2, PetscSqr(x[3 * a] - r[3 * a]) + PetscSqr(x[3 * a + 1] - r[3 * a + 1]) +
                                    PetscSqr(x[3 * a + 2] - r[3 * a + 2]));
  PetscCallMPI(MPI_Allreduce(&largest2, moved, 1, MPIU_REAL, MPIU_MAX, cloud->comm));
  *moved = PetscSqrtReal(*moved);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sends the particles to their ranks if one is too far outside or a sort is due; then chooses the ghosts. */
static PetscErrorCode Renew(Cloud cloud, PetscBool sort)
{
  PetscMPIInt rank, size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(cloud->comm, &rank));
  PetscCallMPI(MPI_Comm_size(cloud->comm, &size));
  if (size > 1) {
    cloud->distance_outside = HaloDistanceOutside(cloud->domain, rank, cloud->n_owned, cloud->field[FIELD_POSITION],
                                                  OUTSIDE_LIMIT * cloud->slack);
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &cloud->distance_outside, 1, MPIU_REAL, MPIU_MAX, cloud->comm));
  }
  if (sort || (size > 1 && !cloud->keep_order && cloud->distance_outside > OUTSIDE_SHARE * cloud->slack)) {
    PetscReal imbalance;

    PetscCall(ParticlesImbalance(cloud->particles, &imbalance));
    PetscCall(Rehome(cloud, (PetscBool)(imbalance > IMBALANCE)));
  } else if (size == 1) {
    PetscCall(WrapSwarm(cloud));
    PetscCall(Load(cloud));
  }
  PetscCall(BuildHalo(cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CloudBegin(Cloud cloud)
{
  const PetscBool sort = (PetscBool)(++cloud->since_sort >= cloud->sort_interval && !cloud->keep_order);

  PetscFunctionBegin;
  PetscCall(Load(cloud));
  if (sort)
    PetscCall(Renew(cloud, PETSC_TRUE));
  else {
    PetscReal moved;

    PetscCall(Displacement(cloud, &moved));
    /* distance_outside is tested here since CloudMoved may choose the ghosts each time, and does not migrate */
    if (2 * moved > cloud->slack || cloud->distance_outside > OUTSIDE_SHARE * cloud->slack)
      PetscCall(Renew(cloud, PETSC_FALSE));
  }
  PetscCall(UpdateGhosts(cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CloudMoved(Cloud cloud)
{
  PetscReal moved;

  PetscFunctionBegin;
  PetscCall(Displacement(cloud, &moved));
  if (2 * moved > cloud->slack) {
    PetscCall(BuildHalo(cloud));
    PetscCall(UpdateGhosts(cloud));
    PetscCall(CloudUpdate(cloud, FIELD_VELOCITY_STAR));
  } else
    PetscCall(CloudUpdate(cloud, FIELD_POSITION));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CloudCheckUnknowns(MPI_Comm comm, PetscInt n, PetscInt width, const char what[])
{
  PetscInt64 unknowns = (PetscInt64)width * n;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &unknowns, 1, MPIU_INT64, MPI_SUM, comm));
  PetscCheckUser(unknowns <= PETSC_MAX_INT, comm,
                 "%s has %" PetscInt64_FMT " unknowns, but this build of PETSc can number %" PetscInt_FMT
                 ": use a larger -spacing, or a PETSc configured with 64-bit indices",
                 what, unknowns, PETSC_MAX_INT);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CloudUpdate(Cloud cloud, FieldId field)
{
  PetscFunctionBegin;
  PetscCheck(Fields[field].parity != PARITY_NONE, cloud->comm, PETSC_ERR_PLIB, "ghosts have no %s", Fields[field].name);
  PetscCall(HaloUpdate(cloud->halo, Fields[field].width, Fields[field].parity, cloud->field[field]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CloudUpdateArray(Cloud cloud, PetscInt width, Parity parity, PetscReal array[])
{
  PetscFunctionBegin;
  PetscCall(HaloUpdate(cloud->halo, width, parity, array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CloudUpdateInt(Cloud cloud, IntFieldId field)
{
  PetscFunctionBegin;
  PetscCall(HaloUpdateInt(cloud->halo, cloud->integer[field]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CloudUpdateIntArray(Cloud cloud, PetscInt array[])
{
  PetscFunctionBegin;
  PetscCall(HaloUpdateInt(cloud->halo, array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the kinetic and potential energy (J) of the particles that are not kept, over all ranks. */
static PetscErrorCode AddEnergyLost(Cloud cloud, const PetscBool keep[], PetscReal *energy)
{
  PetscReal sum = 0;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *v = cloud->field[FIELD_VELOCITY] + DIM * a;

    if (!keep[a])
      sum += cloud->volume[a] * cloud->rest_density[a] *
             (0.5 * Dot(v, v) + SceneForcePotential(cloud->scene, cloud->field[FIELD_POSITION] + DIM * a));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPIU_REAL, MPIU_SUM, cloud->comm));
  *energy += sum;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CloudCommit(Cloud cloud, PetscInt *lost, PetscReal *energy)
{
  ParticleArrays arrays;
  PetscBool     *keep;
  PetscInt       left[2 * DIM] = {0}, global = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(cloud->n_owned, &keep));
  PetscCall(ParticlesOpen(cloud->particles, &arrays));
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++)
    if (arrays.real[f]) PetscCall(PetscArraycpy(arrays.real[f], cloud->field[f], arrays.n * Fields[f].width));
  for (PetscInt f = 0; f < INT_COUNT; f++) PetscCall(PetscArraycpy(arrays.integer[f], cloud->integer[f], arrays.n));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscInt exit =
      cloud->integer[INT_LAYER][a] > 0 ? -1 : DomainExit(cloud->domain, arrays.real[FIELD_POSITION] + DIM * a);

    keep[a] = (PetscBool)(exit < 0);
    if (exit >= 0) left[exit]++;
  }
  PetscCall(ParticlesClose(cloud->particles, &arrays));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, left, 2 * DIM, MPIU_INT, MPI_SUM, cloud->comm));
  for (PetscInt f = 0; f < 2 * DIM; f++) {
    cloud->exits[f] += left[f];
    global += left[f];
  }
  if (global) {
    if (energy) PetscCall(AddEnergyLost(cloud, keep, energy));
    PetscCall(ParticlesRemove(cloud->particles, keep));
    PetscCall(CloudResync(cloud));
  }
  PetscCall(PetscFree(keep));
  *lost += global;
  cloud->keep_order = PetscMax(0, cloud->keep_order - 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}
