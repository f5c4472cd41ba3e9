#include "particles.h"

#define INFO_STORED(id, name, width, parity, carry, unit, meaning) {name, width, parity, carry, unit, meaning},
#define INFO_REAL(id, name, width, parity, unit, meaning)          {name, width, parity, CARRY_OWN, unit, meaning},
const FieldInfo Fields[FIELD_COUNT] = {STORED_REALS(INFO_STORED) WORK_REALS(INFO_REAL)};
#define NAME_INT(id, name, meaning)    name,
#define MEANING_INT(id, name, meaning) meaning,
const char *const IntFieldNames[INT_COUNT]    = {STORED_INTS(NAME_INT)};
const char *const IntFieldMeanings[INT_COUNT] = {STORED_INTS(MEANING_INT)};

#define SWARM_BUFFER   1024 /* particles that the swarm can add before it allocates again */
#define PARTICLE_BYTES 256  /* a particle has fewer: DMSwarmMigrate (3.18) counts the bytes of a message in an int */

struct _p_Particles {
  MPI_Comm         comm;
  Domain           domain; /* borrowed */
  DM               swarm;
  FieldMask        stored;
  PetscBool        balance_surface; /* the partition divides the work near the free surface, too */
  PetscInt         global;          /* expected global number of particles, checked after each migration */
  PetscInt         portion;         /* most particles in one message */
  ParticlesStarter start;           /* of new particles; NULL: none */
  void            *context;
};

PetscBool ParticlesHave(Particles particles, PetscInt f)
{
  return (PetscBool)((particles->stored & FIELD_BIT(f)) != 0);
}

void ParticlesSetStart(Particles particles, ParticlesStarter start, void *context)
{
  particles->start   = start;
  particles->context = context;
}

void ParticlesStart(Particles particles, PetscInt first, ParticleArrays *arrays)
{
  if (particles->start) particles->start(particles->context, first, arrays);
}

PetscErrorCode ParticlesCreate(Domain domain, FieldMask more, Particles *particles)
{
  Particles p;

  PetscFunctionBegin;
  PetscCall(PetscNew(&p));
  p->comm   = domain->comm;
  p->domain = domain;
  p->stored = more | (FIELD_BIT(FIELD_LAMBDA + 1) - 1) | (DomainVolumesDiffer(domain) ? FIELD_BIT(FIELD_VOLUME) : 0) |
              (DomainStoresSizes(domain) ? FIELD_BIT(FIELD_SIZE) : 0) |
              (domain->adaptive ? FIELD_BIT(FIELD_COLOUR) : 0);
  p->portion = PETSC_MPI_INT_MAX / PARTICLE_BYTES;
  PetscCall(DMCreate(p->comm, &p->swarm));
  PetscCall(DMSetType(p->swarm, DMSWARM));
  PetscCall(PetscObjectSetName((PetscObject)p->swarm, "particles"));
  PetscCall(DMSetDimension(p->swarm, domain->dim));
  PetscCall(DMSwarmSetType(p->swarm, DMSWARM_BASIC));
  PetscCall(DMSwarmInitializeFieldRegister(p->swarm));
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++)
    if (ParticlesHave(p, f))
      PetscCall(DMSwarmRegisterPetscDatatypeField(p->swarm, Fields[f].name, Fields[f].width, PETSC_REAL));
  for (PetscInt f = 0; f < INT_COUNT; f++)
    PetscCall(DMSwarmRegisterPetscDatatypeField(p->swarm, IntFieldNames[f], 1, PETSC_INT));
  PetscCall(DMSwarmFinalizeFieldRegister(p->swarm));
  PetscCall(DMSwarmSetLocalSizes(p->swarm, 0, SWARM_BUFFER));
  *particles = p;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ParticlesDestroy(Particles *particles)
{
  PetscFunctionBegin;
  if (!*particles) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DMDestroy(&(*particles)->swarm));
  PetscCall(PetscFree(*particles));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ParticlesView(Particles particles, PetscViewer viewer)
{
  PetscInt    global;
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(particles->comm, &size));
  PetscCall(ParticlesGlobalSize(particles, &global));
  PetscCall(PetscViewerASCIIPrintf(viewer, "Particles: %" PetscInt_FMT " in a DMSwarm on %d rank%s\n", global, size,
                                   size > 1 ? "s" : ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ParticlesCheckRoom(MPI_Comm comm, PetscInt64 n)
{
  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &n, 1, MPIU_INT64, MPI_MAX, comm));
  PetscCheckUser(n <= PETSC_MAX_INT / NUMBERS_A_PARTICLE, comm,
                 "a rank would hold %" PetscInt64_FMT " particles, ghosts included; this build of PETSc can index the "
                 "fields of %" PetscInt_FMT ": take more ranks, or a PETSc configured with 64-bit indices",
                 n, PETSC_MAX_INT / NUMBERS_A_PARTICLE);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ParticlesAppend(Particles particles, PetscInt count)
{
  PetscInt       n;
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(DMSwarmGetLocalSize(particles->swarm, &n));
  PetscCall(ParticlesCheckRoom(particles->comm, (PetscInt64)n + count));
  PetscCall(DMSwarmSetLocalSizes(particles->swarm, n + count, SWARM_BUFFER));
  PetscCall(ParticlesOpen(particles, &arrays));
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++)
    if (ParticlesHave(particles, f))
      PetscCall(PetscArrayzero(arrays.real[f] + n * Fields[f].width, count * Fields[f].width));
  for (PetscInt f = 0; f < INT_COUNT; f++) PetscCall(PetscArrayzero(arrays.integer[f] + n, count));
  PetscCall(ParticlesClose(particles, &arrays));
  PetscCall(ParticlesGlobalSize(particles, &particles->global));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ParticlesOpen(Particles particles, ParticleArrays *arrays)
{
  PetscFunctionBegin;
  PetscCall(DMSwarmGetLocalSize(particles->swarm, &arrays->n));
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++) {
    arrays->real[f] = NULL;
    if (ParticlesHave(particles, f))
      PetscCall(DMSwarmGetField(particles->swarm, Fields[f].name, NULL, NULL, (void **)&arrays->real[f]));
  }
  for (PetscInt f = 0; f < INT_COUNT; f++)
    PetscCall(DMSwarmGetField(particles->swarm, IntFieldNames[f], NULL, NULL, (void **)&arrays->integer[f]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ParticlesClose(Particles particles, ParticleArrays *arrays)
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++)
    if (arrays->real[f])
      PetscCall(DMSwarmRestoreField(particles->swarm, Fields[f].name, NULL, NULL, (void **)&arrays->real[f]));
  for (PetscInt f = 0; f < INT_COUNT; f++)
    PetscCall(DMSwarmRestoreField(particles->swarm, IntFieldNames[f], NULL, NULL, (void **)&arrays->integer[f]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ParticlesLocalSize(Particles particles, PetscInt *n)
{
  PetscFunctionBegin;
  PetscCall(DMSwarmGetLocalSize(particles->swarm, n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ParticlesGlobalSize(Particles particles, PetscInt *n)
{
  PetscFunctionBegin;
  PetscCall(DMSwarmGetSize(particles->swarm, n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rearranges the fields: particle order[k] moves to index k, for k < n. */
static PetscErrorCode Rearrange(ParticleArrays *arrays, PetscInt n, const PetscInt order[])
{
  PetscReal *real;
  PetscInt  *integer, widest = 1;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++) widest = PetscMax(widest, Fields[f].width);
  PetscCall(PetscMalloc2(n * widest, &real, n, &integer));
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++) {
    const PetscInt width = Fields[f].width;

    if (!arrays->real[f]) continue;
    for (PetscInt k = 0; k < n; k++)
      for (PetscInt c = 0; c < width; c++) real[k * width + c] = arrays->real[f][order[k] * width + c];
    PetscCall(PetscArraycpy(arrays->real[f], real, n * width));
  }
  for (PetscInt f = 0; f < INT_COUNT; f++) {
    for (PetscInt k = 0; k < n; k++) integer[k] = arrays->integer[f][order[k]];
    PetscCall(PetscArraycpy(arrays->integer[f], integer, n));
  }
  PetscCall(PetscFree2(real, integer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ParticlesLastId(MPI_Comm comm, PetscInt n, const PetscInt id[], PetscInt *last)
{
  PetscFunctionBegin;
  *last = -1;
  for (PetscInt a = 0; a < n; a++)
    if (id[a] < EMITTED_ID) *last = PetscMax(*last, id[a]);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, last, 1, MPIU_INT, MPI_MAX, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ParticlesRemove(Particles particles, const PetscBool keep[])
{
  ParticleArrays arrays;
  PetscInt      *order, kept = 0;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(particles, &arrays));
  PetscCall(PetscMalloc1(arrays.n, &order));
  for (PetscInt a = 0; a < arrays.n; a++)
    if (keep[a]) order[kept++] = a;
  PetscCall(Rearrange(&arrays, kept, order));
  PetscCall(PetscFree(order));
  PetscCall(ParticlesClose(particles, &arrays));
  PetscCall(DMSwarmSetLocalSizes(particles->swarm, kept, SWARM_BUFFER));
  PetscCall(ParticlesGlobalSize(particles, &particles->global));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ParticlesSetPortion(Particles particles, PetscInt portion)
{
  PetscFunctionBegin;
  particles->portion = portion;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes the destination rank of each particle into the swarm, at most 'portion' particles to any other rank. *left:
   whether a rank has particles left to send. */
static PetscErrorCode ChooseRanks(Particles particles, PetscBool *left)
{
  ParticleArrays arrays;
  PetscMPIInt    size, me, more = 0;
  PetscInt      *sent, *rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(particles->comm, &size));
  PetscCallMPI(MPI_Comm_rank(particles->comm, &me));
  PetscCall(PetscCalloc1(size, &sent));
  PetscCall(ParticlesOpen(particles, &arrays));
  PetscCall(DMSwarmGetField(particles->swarm, DMSwarmField_rank, NULL, NULL, (void **)&rank));
  for (PetscInt a = 0; a < arrays.n; a++) {
    rank[a] = particles->domain->cell_rank[DomainCell(particles->domain, arrays.real[FIELD_POSITION] + DIM * a)];
    if (rank[a] == me || sent[rank[a]]++ < particles->portion) continue;
    rank[a] = me;
    more    = 1;
  }
  PetscCall(DMSwarmRestoreField(particles->swarm, DMSwarmField_rank, NULL, NULL, (void **)&rank));
  PetscCall(ParticlesClose(particles, &arrays));
  PetscCall(PetscFree(sent));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &more, 1, MPI_INT, MPI_MAX, particles->comm));
  *left = (PetscBool)(more > 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ParticlesMigrate(Particles particles)
{
  PetscMPIInt size;
  PetscInt    global;
  PetscBool   left;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(particles->comm, &size));
  if (size == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_MIGRATE), 0, 0, 0, 0));
  do {
    PetscCall(ChooseRanks(particles, &left));
    PetscCall(DMSwarmMigrate(particles->swarm, PETSC_TRUE));
  } while (left);
  PetscCall(ParticlesGlobalSize(particles, &global));
  PetscCheck(global == particles->global, particles->comm, PETSC_ERR_PLIB,
             "migration changed the number of particles from %" PetscInt_FMT " to %" PetscInt_FMT, particles->global,
             global);
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_MIGRATE), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ParticlesBalanceSurface(Particles particles, PetscBool surface)
{
  PetscFunctionBegin;
  particles->balance_surface = surface;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The work of a particle near the free surface with graded spacing: only surface particles count, for the number of
   layers in the cells near the surface depends on their size. A large particle has about twice the neighbours. */
static PetscInt SurfaceWork(Domain domain, const ParticleArrays *arrays, PetscInt a)
{
  if (!arrays->integer[INT_SURFACE][a]) return 0;
  return ParticleSize(domain, arrays, a) > 1 + POINT_TOLERANCE ? 2 : 1;
}

PetscErrorCode ParticlesImbalance(Particles particles, PetscReal *imbalance)
{
  ParticleArrays arrays;
  PetscMPIInt    size;
  PetscReal      count[2] = {0, 0}, largest[2], total[2];

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(particles->comm, &size));
  PetscCall(ParticlesOpen(particles, &arrays));
  count[0] = (PetscReal)arrays.n;
  for (PetscInt a = 0; a < arrays.n && particles->balance_surface; a++)
    count[1] += particles->domain->graded ? (PetscReal)SurfaceWork(particles->domain, &arrays, a)
                                          : (PetscReal)(arrays.integer[INT_SURFACE][a] != 0);
  PetscCall(ParticlesClose(particles, &arrays));
  PetscCallMPI(MPI_Allreduce(count, largest, 2, MPIU_REAL, MPIU_MAX, particles->comm));
  PetscCallMPI(MPI_Allreduce(count, total, 2, MPIU_REAL, MPIU_SUM, particles->comm));
  *imbalance = 1;
  for (PetscInt k = 0; k < 2; k++)
    if (total[k] > 0) *imbalance = PetscMax(*imbalance, size * largest[k] / total[k]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* near[cells]: whether the cell or an adjacent cell holds a free-surface particle of any rank. */
static PetscErrorCode MarkSurfaceCells(Particles particles, const ParticleArrays *arrays, PetscInt near[])
{
  Domain          domain = particles->domain;
  const PetscInt *n = domain->cells, count = n[0] * n[1] * n[2];
  PetscInt       *surface;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(count, &surface));
  for (PetscInt a = 0; a < arrays->n; a++)
    if (arrays->integer[INT_SURFACE][a] == 1 && arrays->integer[INT_LAYER][a] == 0)
      surface[DomainCell(domain, arrays->real[FIELD_POSITION] + DIM * a)] = 1;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, surface, (PetscMPIInt)count, MPIU_INT, MPI_MAX, particles->comm));
  for (PetscInt c = 0; c < count; c++) {
    PetscInt at[DIM], first[DIM], last[DIM], cell[DIM];

    if (!surface[c]) continue;
    CellCoordinates(n, c, at);
    for (PetscInt d = 0; d < DIM; d++) {
      first[d] = cell[d] = PetscMax(0, at[d] - 1);
      last[d]            = PetscMin(n[d] - 1, at[d] + 1);
    }
    do near[CellIndex(n, cell[0], cell[1], cell[2])] = 1;
    while (CellNext(first, last, cell));
  }
  PetscCall(PetscFree(surface));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ParticlesRepartition(Particles particles)
{
  Domain         domain = particles->domain;
  const PetscInt count  = domain->cells[0] * domain->cells[1] * domain->cells[2];
  ParticleArrays arrays;
  PetscMPIInt    size;
  PetscInt      *weight, *near, constraints = 1;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(particles->comm, &size));
  if (size == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscCalloc2(2 * count, &weight, count, &near));
  PetscCall(ParticlesOpen(particles, &arrays));
  if (particles->balance_surface) {
    PetscCall(MarkSurfaceCells(particles, &arrays, near));
    for (PetscInt c = 0; c < count; c++)
      if (near[c]) constraints = 2; /* without surface particles the second weights are all zero */
  }
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscInt c = DomainCell(domain, arrays.real[FIELD_POSITION] + DIM * a);

    weight[constraints * c]++;
    if (near[c]) weight[constraints * c + 1] += domain->graded ? SurfaceWork(domain, &arrays, a) : 1;
  }
  PetscCall(ParticlesClose(particles, &arrays));
  PetscCall(DomainPartition(domain, constraints, weight));
  PetscCall(PetscFree2(weight, near));
  PetscCall(ParticlesMigrate(particles));
  PetscFunctionReturn(PETSC_SUCCESS);
}

typedef struct {
  PetscInt kind, cell, id, place;
} SortKey;

static int CompareKeys(const void *left, const void *right)
{
  const SortKey *a = (const SortKey *)left, *b = (const SortKey *)right;

  if (a->kind != b->kind) return a->kind < b->kind ? -1 : 1;
  if (a->cell != b->cell) return a->cell < b->cell ? -1 : 1;
  return a->id < b->id ? -1 : a->id > b->id;
}

PetscErrorCode ParticlesSort(Particles particles, PetscReal cell_size)
{
  Domain         domain = particles->domain;
  ParticleArrays arrays;
  SortKey       *keys;
  PetscInt      *order, n[DIM];

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(particles, &arrays));
  for (PetscInt d = 0; d < DIM; d++) n[d] = PetscMax(1, (PetscInt)((domain->upper[d] - domain->lower[d]) / cell_size));
  PetscCall(PetscMalloc2(arrays.n, &keys, arrays.n, &order));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscInt layer = arrays.integer[INT_LAYER][a];
    PetscInt       cell[DIM];

    for (PetscInt d = 0; d < DIM; d++) {
      const PetscReal x =
        (arrays.real[FIELD_POSITION][DIM * a + d] - domain->lower[d]) / (domain->upper[d] - domain->lower[d]);

      cell[d] = PetscMax(0, PetscMin(n[d] - 1, (PetscInt)PetscMin(x * n[d], (PetscReal)n[d])));
    }
    keys[a].kind  = PetscMin(layer, 2);
    keys[a].cell  = CellIndex(n, cell[0], cell[1], cell[2]);
    keys[a].id    = arrays.integer[INT_ID][a];
    keys[a].place = a;
  }
  if (arrays.n) qsort(keys, (size_t)arrays.n, sizeof(*keys), CompareKeys);
  for (PetscInt a = 0; a < arrays.n; a++) order[a] = keys[a].place;
  PetscCall(Rearrange(&arrays, arrays.n, order));
  PetscCall(PetscFree2(keys, order));
  PetscCall(ParticlesClose(particles, &arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}
