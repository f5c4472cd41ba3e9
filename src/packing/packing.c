/* The class: types, options, and how samples become particles. */
#include "packing_impl.h"
#include <unistd.h>

static PetscFunctionList PackingList = NULL;

static PetscErrorCode PackingFinalize(void)
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListDestroy(&PackingList));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PackingRegisterAll(void)
{
  PetscFunctionBegin;
  if (PackingList) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFunctionListAdd(&PackingList, "lattice", PackingCreate_Lattice));
  PetscCall(PetscFunctionListAdd(&PackingList, "poisson", PackingCreate_Poisson));
  PetscCall(PetscRegisterFinalize(PackingFinalize));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PackingSetType(Packing packing, const char name[])
{
  PetscErrorCode (*create)(Packing);
  char names[NAMES_LENGTH];

  PetscFunctionBegin;
  PetscCall(ListNames(PackingList, names));
  PetscCall(PetscFunctionListFind(PackingList, name, &create));
  PetscCheckUser(create, packing->cloud->comm, "-packing_type %s is not a packing; there are %s", name, names);
  if (packing->ops.destroy) PetscCall(packing->ops.destroy(packing));
  PetscCall(PetscMemzero(&packing->ops, sizeof(packing->ops)));
  PetscCall(PetscStrncpy(packing->type, name, sizeof(packing->type)));
  PetscCall(create(packing));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PackingCreate(Cloud cloud, Packing *packing)
{
  PetscFunctionBegin;
  PetscCall(PackingRegisterAll());
  PetscCall(PetscNew(packing));
  (*packing)->cloud = cloud;
  (*packing)->seed  = 1;
  PetscCall(PetscStrncpy((*packing)->cache, "output/packing", sizeof((*packing)->cache)));
  PetscCall(PackingSetType(*packing, "lattice"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A TypeReader of packings. */
static PetscErrorCode ReadPackingType(void *object, const char type[])
{
  Packing packing = (Packing)object;
  char    title[128];

  PetscFunctionBegin;
  PetscCall(PackingSetType(packing, type));
  PetscCall(PetscSNPrintf(title, sizeof(title), "Packing with -packing_type %s", type));
  PetscOptionsBegin(packing->cloud->comm, NULL, title, "Packing");
  if (packing->ops.setfromoptions) PetscCall(packing->ops.setfromoptions(packing, PetscOptionsObject));
  PetscOptionsEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PackingSetFromOptions(Packing packing)
{
  const MPI_Comm comm = packing->cloud->comm;
  char           type[sizeof(packing->type)];

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(type, packing->type, sizeof(type)));
  PetscOptionsBegin(comm, NULL, "Packing", "Packing");
  PetscCall(PetscOptionsFList("-packing_type", "how bodies are filled with particles", "PackingSetType", PackingList,
                              type, type, sizeof(type), NULL));
  PetscCall(PetscOptionsInt("-packing_seed", "seed of the random numbers, 0 or more (1)", "PackingSetFromOptions",
                            packing->seed, &packing->seed, NULL));
  PetscCall(PetscOptionsString("-packing_cache", "folder that keeps finished packings for the next run; empty: none",
                               "PackingSetFromOptions", packing->cache, packing->cache, sizeof(packing->cache), NULL));
  PetscOptionsEnd();
  PetscCall(ReadTypeOptions(PackingList, type, ReadPackingType, packing));
  PetscCheckUser(packing->seed >= 0, comm, "-packing_seed is %" PetscInt_FMT "; it must be 0 or more", packing->seed);
  if (packing->ops.check) PetscCall(packing->ops.check(packing));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PackingDestroy(Packing *packing)
{
  PetscFunctionBegin;
  if (!*packing) PetscFunctionReturn(PETSC_SUCCESS);
  if ((*packing)->ops.destroy) PetscCall((*packing)->ops.destroy(*packing));
  PetscCall(EmissionsDestroy(*packing));
  PetscCall(PetscFree(*packing));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt PackingWallLayers(Cloud cloud)
{
  return (PetscInt)PetscCeilReal(KernelSupport(cloud->kernel) / cloud->domain->spacing - ROUNDING);
}

void PackingConfine(Domain domain, PetscReal x[DIM])
{
  const PetscReal margin = ROUNDING * domain->spacing;

  DomainWrap(domain, x);
  for (PetscInt d = 0; d < domain->dim; d++) {
    if (domain->face[d][0] == FACE_PERIODIC) continue;
    if (domain->face[d][0] == FACE_SYMMETRY && x[d] < domain->lower[d]) x[d] = 2 * domain->lower[d] - x[d];
    if (domain->face[d][1] == FACE_SYMMETRY && x[d] > domain->upper[d]) x[d] = 2 * domain->upper[d] - x[d];
    x[d] = PetscMax(domain->lower[d] + margin, PetscMin(domain->upper[d] - margin, x[d]));
  }
}

/* --- from samples to particles --- */

typedef struct {
  Domain         domain;
  PetscMPIInt    rank;
  PetscInt       count;  /* samples seen */
  PetscInt      *weight; /* [cells] samples of each */
  ParticleArrays arrays;
  PetscInt       next; /* place of the next particle of this rank */
} Filling;

static void Weigh(void *context, PetscInt id, PetscInt body, const PetscReal x[DIM])
{
  Filling *filling = (Filling *)context;

  filling->count++;
  filling->weight[DomainCell(filling->domain, x)]++;
}

static void Fill(void *context, PetscInt id, PetscInt body, const PetscReal x[DIM])
{
  Filling       *filling = (Filling *)context;
  const PetscInt a       = filling->next;

  if (filling->domain->cell_rank[DomainCell(filling->domain, x)] != filling->rank) return;
  for (PetscInt d = 0; d < DIM; d++) filling->arrays.real[FIELD_POSITION][DIM * a + d] = x[d];
  filling->arrays.integer[INT_ID][a]     = id;
  filling->arrays.integer[INT_BODY][a]   = body;
  filling->arrays.integer[INT_PARENT][a] = id;
  filling->next++;
}

/* Every rank sees all samples and keeps those of its cells; the cells are dealt out first, with the weights that
   CloudResync will use, so that nothing has to migrate. */
static PetscErrorCode CreateParticles(Packing packing)
{
  const Cloud    cloud  = packing->cloud;
  const Domain   domain = cloud->domain;
  const PetscInt cells = domain->cells[0] * domain->cells[1] * domain->cells[2], layers = PackingWallLayers(cloud);
  Filling        filling = {.domain = domain};
  PetscInt      *weight, own = 0, walls, solids;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(cloud->comm, &filling.rank));
  PetscCall(PetscCalloc2(cells, &filling.weight, cells, &weight));
  PetscCall(packing->ops.visit(packing, Weigh, &filling));
  packing->count = filling.count;
  PetscCheckUser(packing->count > 0 || SceneEmits(cloud->scene), cloud->comm,
                 "no particle of -spacing %g m fits into the bodies of the scene; it must be smaller than the bodies",
                 (double)domain->spacing);
  if (filling.rank == 0) { /* DomainPartition sums over the ranks */
    PetscCall(PetscArraycpy(weight, filling.weight, cells));
    WallWeigh(domain, layers, weight);
    SolidWeigh(domain, cloud->scene, layers, weight);
  }
  PetscCall(DomainPartition(domain, 1, weight));
  for (PetscInt c = 0; c < cells; c++)
    if (domain->cell_rank[c] == filling.rank) own += filling.weight[c];
  PetscCall(PetscFree2(filling.weight, weight));
  PetscCall(ParticlesLocalSize(cloud->particles, &filling.next));
  PetscCall(ParticlesAppend(cloud->particles, own));
  PetscCall(ParticlesOpen(cloud->particles, &filling.arrays));
  PetscCall(packing->ops.visit(packing, Fill, &filling));
  PetscCall(ParticlesClose(cloud->particles, &filling.arrays));
  PetscCall(WallCreateParticles(cloud->particles, domain, layers, packing->count, &walls));
  PetscCall(SolidCreateParticles(cloud->particles, domain, cloud->scene, layers, packing->count + walls, &solids));
  PetscCall(PetscInfo(NULL,
                      "packing %s: %" PetscInt_FMT " fluid, %" PetscInt_FMT " wall and %" PetscInt_FMT
                      " solid particles\n",
                      packing->type, packing->count, walls, solids));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- what is known once the particles stand --- */

PetscReal PackingRow(Cloud cloud, PetscInt a, PairRow *row)
{
  PetscReal sum = 0;

  PairRowLoad(cloud, cloud->field[FIELD_POSITION], a, row);
  KernelEvaluate(cloud->kernel, row->n, row->r2, row->W, NULL);
  SIMD_LOOP(reduction(+ : sum))
  for (PetscInt k = 0; k < row->n; k++) sum += row->W[k];
  return cloud->domain->volume * (sum + KernelSelf(cloud->kernel));
}

static PetscErrorCode SetVelocities(Packing packing)
{
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(packing->cloud->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscInt body = arrays.integer[INT_BODY][a];

    if (body >= 0)
      BodyVelocity(SceneBody(packing->cloud->scene, body), arrays.real[FIELD_POSITION] + DIM * a,
                   arrays.real[FIELD_VELOCITY] + DIM * a);
  }
  PetscCall(ParticlesClose(packing->cloud->particles, &arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RelaxedHash(Packing packing, const char how[], unsigned long long *hash)
{
  PetscFunctionBegin;
  PetscCall(PackingHash(packing, 0, NULL, hash));
  HashText(hash, how);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PackingFindRelaxed(Packing packing, const char how[], PetscBool *found)
{
  const Cloud        cloud = packing->cloud;
  ParticleArrays     arrays;
  unsigned long long hash;
  PetscInt           n = 0, *body;
  PetscReal         *x;

  PetscFunctionBegin;
  PetscCall(RelaxedHash(packing, how, &hash));
  if (packing->cache[0]) PetscCall(CacheRead(cloud->comm, packing->cache, hash, &n, &x, &body));
  *found = (PetscBool)(n == packing->count);
  if (*found) {
    PetscCall(ParticlesOpen(cloud->particles, &arrays));
    for (PetscInt a = 0; a < arrays.n; a++)
      if (arrays.integer[INT_LAYER][a] == 0)
        PetscCall(PetscArraycpy(arrays.real[FIELD_POSITION] + DIM * a, x + DIM * arrays.integer[INT_ID][a], DIM));
    PetscCall(ParticlesClose(cloud->particles, &arrays));
  }
  if (n) {
    PetscCall(PetscFree(x));
    PetscCall(PetscFree(body));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PackingKeepRelaxed(Packing packing, const char how[])
{
  unsigned long long hash;

  PetscFunctionBegin;
  if (!packing->cache[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(RelaxedHash(packing, how, &hash));
  PetscCall(CacheWrite(packing->cloud->particles, packing->cloud->comm, packing->cache, hash, packing->count));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PackingSetVelocities(Packing packing)
{
  PetscFunctionBegin;
  PetscCall(SetVelocities(packing));
  PetscCall(CloudResync(packing->cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Densities, Eq. (4) of Kuri et al. with the rest density of the particle itself, so that two liquids in touch are at
   rest; and the report. */
static PetscErrorCode Measure(Packing packing, PackingReport *report)
{
  const Cloud cloud = packing->cloud;
  PairRow    *row;
  PetscReal   squares = 0, closest2 = PETSC_MAX_REAL;

  PetscFunctionBegin;
  PetscCall(PetscNew(&row));
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    const PetscReal rest = cloud->rest_density[a], fraction = PackingRow(cloud, a, row);

    cloud->field[FIELD_DENSITY][a] = rest * fraction;
    if (a >= cloud->n_fluid) continue;
    squares += PetscSqr(rest * (fraction - 1));
    for (PetscInt k = 0; k < row->n; k++)
      if (cloud->integer[INT_LAYER][row->index[k]] == 0) closest2 = PetscMin(closest2, row->r2[k]);
  }
  PetscCall(PetscFree(row));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &squares, 1, MPIU_REAL, MPIU_SUM, cloud->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &closest2, 1, MPIU_REAL, MPIU_MIN, cloud->comm));
  report->density_std = PetscSqrtReal(squares / PetscMax(packing->count, 1));
  report->smallest_distance =
    closest2 < PETSC_MAX_REAL ? PetscSqrtReal(closest2) / cloud->domain->spacing : PETSC_INFINITY;
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define PARTICLE_LEAST                                                                                                 \
  500              /* bytes a particle takes, at least: 1.2 kB in two dimensions, 2.2 kB in three by default           \
                    */
#define SAMPLES 16 /* points a direction at which a body is probed */

/* How many particles the bodies (to a few percent) and the box's walls will have. */
static PetscReal Estimate(Packing packing)
{
  const Domain    domain = packing->cloud->domain;
  const PetscInt  deep   = domain->dim == DIM ? SAMPLES : 1;
  const PetscReal layers = (PetscReal)PackingWallLayers(packing->cloud);
  PetscReal       count = 0, box = 1, walled = 1;

  for (PetscInt b = 0; b < SceneCount(packing->cloud->scene); b++) {
    const Body body   = SceneBody(packing->cloud->scene, b);
    PetscReal  volume = 1 / domain->volume, inside = 0, lower[DIM], upper[DIM], x[DIM];

    BodyBounds(body, lower, upper);
    for (PetscInt d = 0; d < domain->dim; d++) volume *= upper[d] - lower[d];
    for (PetscInt k = 0; k < SAMPLES * SAMPLES * deep; k++) {
      const PetscInt at[DIM] = {k % SAMPLES, (k / SAMPLES) % SAMPLES, k / (SAMPLES * SAMPLES)};

      for (PetscInt d = 0; d < DIM; d++)
        x[d] = lower[d] + (upper[d] - lower[d]) * (at[d] + 0.5) / (d < 2 ? SAMPLES : deep);
      inside += BodyContains(body, x) ? 1 : 0;
    }
    count += volume * inside / (SAMPLES * SAMPLES * deep);
  }
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscReal places = (domain->upper[d] - domain->lower[d]) / domain->spacing;

    box *= places;
    walled *= places + layers * ((domain->face[d][0] == FACE_WALL) + (domain->face[d][1] == FACE_WALL));
  }
  return count + walled - box;
}

/* Whether the machines of the ranks have the memory: Linux gives more away than there is and ends the run later. */
static PetscErrorCode CheckMemory(Packing packing)
{
  const MPI_Comm comm  = packing->cloud->comm;
  const double   bytes = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE), count = Estimate(packing);
  double         room;
  PetscMPIInt    neighbors;
  MPI_Comm       machine;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine));
  PetscCallMPI(MPI_Comm_size(machine, &neighbors));
  PetscCallMPI(MPI_Comm_free(&machine));
  room = bytes / neighbors;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &room, 1, MPI_DOUBLE, MPI_SUM, comm));
  PetscCheckUser(bytes <= 0 || count * PARTICLE_LEAST <= room, comm,
                 "-spacing %g m is too small for the memory: about %.2g particles take more than %.3g GB, there are "
                 "%.3g GB",
                 (double)packing->cloud->domain->spacing, count, count * PARTICLE_LEAST / 1e9, room / 1e9);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PackingRun(Packing packing, PackingReport *report)
{
  const Cloud cloud = packing->cloud;
  PetscInt    lost  = 0;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_PACKING), 0, 0, 0, 0));
  PetscCall(PetscMemzero(report, sizeof(*report)));
  PetscCall(CheckMemory(packing));
  if (packing->ops.setup) PetscCall(packing->ops.setup(packing, report));
  PetscCall(CreateParticles(packing));
  PetscCall(CloudResync(cloud));
  if (packing->ops.improve) PetscCall(packing->ops.improve(packing, report));
  PetscCall(SetVelocities(packing));
  PetscCall(CloudResync(cloud));
  PetscCall(Measure(packing, report));
  PetscCall(CloudCommit(cloud, &lost));
  PetscCheck(lost == 0, cloud->comm, PETSC_ERR_PLIB, "%" PetscInt_FMT " particles of the packing are outside the box",
             lost);
  PetscCall(CloudResync(cloud));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_PACKING), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
