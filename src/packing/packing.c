/* The class Packing: types, options, and the packing of a scene. */
#include "packing_impl.h"

static const Choice *const Packings[] = {&PackingLattice.choice, &PackingPoisson.choice, NULL};

/* Makes a type that of the packing. */
static PetscErrorCode SetType(Packing packing, const Choice *choice)
{
  PetscFunctionBegin;
  if (packing->ops && packing->ops->destroy) PetscCall(packing->ops->destroy(packing));
  PetscCall(PetscFree(packing->data));
  packing->ops = (const PackingOps *)choice;
  PetscCall(PetscStrncpy(packing->type, choice->name, sizeof(packing->type)));
  PetscCall(PetscCalloc(choice->size, &packing->data));
  choice->defaults(packing);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PackingCreate(Cloud cloud, Packing *packing)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(packing));
  (*packing)->cloud = cloud;
  (*packing)->seed  = 1;
  PetscCall(PetscStrncpy((*packing)->cache, "output/packing", sizeof((*packing)->cache)));
  PetscCall(SetType(*packing, &PackingLattice.choice));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A ChoiceReader. */
static PetscErrorCode ReadType(void *object, const Choice *choice)
{
  Packing packing = (Packing)object;
  char    title[128];

  PetscFunctionBegin;
  PetscCall(SetType(packing, choice));
  PetscCall(PetscSNPrintf(title, sizeof(title), "Packing with -packing_type %s", choice->name));
  PetscCall(OptionsReadBlock(packing->cloud->comm, title, choice->options, "PackingSetFromOptions", packing->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const OptionRow options[] = {
  {"-packing_type", "How bodies are filled with particles", NULL, NULL, ROW_CHOICE, offsetof(struct _p_Packing, type),
   .choices = Packings},
  {"-packing_seed", "Seed of the random numbers", "1", "[0, inf)", ROW_INT, offsetof(struct _p_Packing, seed)},
  {"-packing_cache", "Folder in which finished packings are kept for later runs; empty: none", NULL, NULL, ROW_TEXT,
   offsetof(struct _p_Packing, cache)},
  {.name = NULL},
};

void PackingSetRough(Packing packing, PetscBool rough)
{
  packing->rough = rough;
}

PetscErrorCode PackingSetFromOptions(Packing packing)
{
  const MPI_Comm comm = packing->cloud->comm;
  const Choice  *choice;

  PetscFunctionBegin;
  PetscCall(OptionsReadBlock(comm, "Packing", options, __func__, packing));
  PetscCall(ChoiceFind(comm, Packings, "-packing_type", packing->type, &choice));
  PetscCall(ChoicesRead(Packings, "-packing_type", NULL, choice, OptionsAll(), ReadType, packing));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PackingDestroy(Packing *packing)
{
  PetscFunctionBegin;
  if (!*packing) PetscFunctionReturn(PETSC_SUCCESS);
  if ((*packing)->ops->destroy) PetscCall((*packing)->ops->destroy(*packing));
  PetscCall(PetscFree((*packing)->data));
  PetscCall(GradedDestroy(*packing));
  PetscCall(PetscFree(*packing));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses a body or a solid without a particle, by name. Emitters are checked at their first emission. */
static PetscErrorCode CheckEachBody(Cloud cloud)
{
  const Scene    scene  = cloud->scene;
  const PetscInt bodies = SceneCount(scene), all = bodies + SceneSolidCount(scene);
  PetscInt       count[2 * SCENE_MAX_BODIES] = {0};
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(cloud->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscInt body = arrays.integer[INT_BODY][a];

    if (body != BODY_WALL) count[body >= 0 ? body : bodies + BODY_SOLID - body]++;
  }
  PetscCall(ParticlesClose(cloud->particles, &arrays));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, count, (PetscMPIInt)all, MPIU_INT, MPI_SUM, cloud->comm));
  for (PetscInt k = 0; k < all; k++) {
    const Body body = k < bodies ? SceneBody(scene, k) : SceneSolid(scene, k - bodies);

    PetscCheckUser(count[k] > 0 || (k < bodies && BodyComesLater(body)), cloud->comm,
                   "no particle of -spacing %g m fits into the %s %s: it is too small for the spacing, covered by a "
                   "solid, or outside of the box at the start",
                   (double)cloud->domain->spacing, k < bodies ? "body" : "solid", BodyName(body));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Each rank makes a part of the particles, wherever they are. */
static PetscErrorCode CreateParticles(Packing packing)
{
  const Cloud        cloud   = packing->cloud;
  const Domain       domain  = cloud->domain;
  const SampleSource visit[] = {domain->graded ? GradedVisit : packing->ops->visit,
                                domain->graded ? GradedVisitWalls : WallVisit, SolidVisit};
  Dummies  dummies                                 = {.cloud = cloud, .layers = CloudWallLayers(cloud)};
  void    *source[]                                = {packing, domain->graded ? (void *)packing : &dummies, &dummies};
  PetscInt count[PETSC_STATIC_ARRAY_LENGTH(visit)] = {0}, first_id;

  PetscFunctionBegin;
  PetscCall(ParticlesGlobalSize(cloud->particles, &first_id));
  count[0] = first_id;
  for (size_t k = first_id > 0; k < PETSC_STATIC_ARRAY_LENGTH(visit); k++) {
    PetscCall(SamplesAppend(cloud->particles, domain, visit[k], source[k], first_id, &count[k]));
    first_id += count[k];
  }
  packing->count = count[0];
  PetscCheckUser(packing->count > 0 || SceneComesLater(cloud->scene), cloud->comm,
                 "no particle of -spacing %g m fits into the bodies of the scene; it must be smaller than the bodies",
                 (double)domain->spacing);
  if (domain->adaptive) PetscCall(domain->adaptive->walls(cloud));
  PetscCall(PetscInfo(NULL,
                      "packing %s: %" PetscInt_FMT " fluid, %" PetscInt_FMT " wall and %" PetscInt_FMT
                      " solid particles\n",
                      packing->type, count[0], count[1], count[2]));
  PetscCall(CheckEachBody(cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetVelocities(Packing packing)
{
  ParticleArrays arrays;
  PetscInt       bad = -1; /* a body whose formula has no value */

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(packing->cloud->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscInt body = arrays.integer[INT_BODY][a];
    PetscReal     *v    = arrays.real[FIELD_VELOCITY] + DIM * a;

    if (body < 0) continue;
    BodyVelocity(SceneBody(packing->cloud->scene, body), arrays.real[FIELD_POSITION] + DIM * a, v);
    if (PetscIsInfOrNanReal(v[0] + v[1] + v[2])) bad = PetscMax(bad, body);
  }
  PetscCall(ParticlesClose(packing->cloud->particles, &arrays));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &bad, 1, MPIU_INT, MPI_MAX, packing->cloud->comm));
  PetscCheckUser(bad < 0, packing->cloud->comm, "-%s_velocity_formula is no number at some of the particles",
                 BodyName(SceneBody(packing->cloud->scene, bad)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PackingSetVelocities(Packing packing)
{
  PetscFunctionBegin;
  PetscCall(SetVelocities(packing));
  PetscCall(CloudResync(packing->cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PackingRun(Packing packing, PackingReport *report)
{
  const Cloud cloud = packing->cloud;
  PetscInt    lost  = 0, liquid;

  PetscFunctionBegin;
  PetscCall(ParticlesGlobalSize(cloud->particles, &liquid));
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_PACKING), 0, 0, 0, 0));
  PetscCall(PetscMemzero(report, sizeof(*report)));
  PetscCall(PackingCheckMemory(packing));
  ProgressBegin("the packing", "no step was computed");
  if (packing->ops->setup && !liquid) PetscCall(packing->ops->setup(packing, report));
  if (cloud->domain->graded && !liquid) PetscCall(GradedSetUp(packing));
  PetscCall(CreateParticles(packing));
  PetscCall(CloudResync(cloud));
  if (packing->ops->improve && !liquid) PetscCall(packing->ops->improve(packing, report));
  if (!liquid) PetscCall(SetVelocities(packing));
  PetscCall(CloudResync(cloud));
  PetscCall(PackingMeasure(packing, report));
  PetscCall(CloudCommit(cloud, &lost, NULL));
  PetscCheck(lost == 0, cloud->comm, PETSC_ERR_PLIB, "%" PetscInt_FMT " particles of the packing are outside the box",
             lost);
  PetscCall(CloudResync(cloud));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_PACKING), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
