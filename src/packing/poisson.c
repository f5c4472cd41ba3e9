/* Bodies filled with Poisson-disk samples (Schechter & Bridson 2012), whose density is then brought to rho_0 by TAO,
   as in Kuri et al. */
#include "packing_impl.h"

typedef struct {
  PetscReal          distance, tolerance; /* spacings; relative */
  unsigned long long hash;
  PetscBool          cached;
  PetscInt           n;
  PetscReal         *x;    /* [n][3] m, on every rank */
  PetscInt          *body; /* [n] */
} Poisson;

static PetscErrorCode SetFromOptions_Poisson(Packing packing, OptionItems PetscOptionsObject)
{
  Poisson *p = (Poisson *)packing->data;

  PetscFunctionBegin;
  PetscCall(PetscOptionsReal("-packing_distance", "smallest distance of two fluid particles (spacings)",
                             "PackingSetFromOptions", p->distance, &p->distance, NULL));
  PetscCall(PetscOptionsReal("-packing_tolerance",
                             "standard deviation of the density about rho_0, over rho_0, at which TAO stops (1)",
                             "PackingSetFromOptions", p->tolerance, &p->tolerance, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Check_Poisson(Packing packing)
{
  const Poisson *p    = (const Poisson *)packing->data;
  const MPI_Comm comm = packing->cloud->comm;

  PetscFunctionBegin;
  PetscCheckUser(!SceneSolidCount(packing->cloud->scene) && !SceneEmits(packing->cloud->scene), packing->cloud->comm,
                 "-packing_type poisson knows neither -solids nor emitters; use -packing_type lattice");
  PetscCheckUser(p->distance > 0 && p->distance < 1, comm,
                 "-packing_distance is %g; it must lie between 0 and 1 spacings", (double)p->distance);
  PetscCheckUser(p->tolerance > 0 && p->tolerance < 1, comm, "-packing_tolerance is %g; it must lie between 0 and 1",
                 (double)p->tolerance);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetUp_Poisson(Packing packing, PackingReport *report)
{
  Poisson        *p         = (Poisson *)packing->data;
  const PetscReal numbers[] = {p->distance, p->tolerance};
  const MPI_Comm  comm      = packing->cloud->comm;
  PetscMPIInt     rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(PackingHash(packing, PETSC_STATIC_ARRAY_LENGTH(numbers), numbers, &p->hash));
  if (packing->cache[0]) PetscCall(CacheRead(comm, packing->cache, p->hash, &p->n, &p->x, &p->body));
  p->cached = report->cached = (PetscBool)(p->n > 0);
  if (p->cached) PetscFunctionReturn(PETSC_SUCCESS);
  if (rank == 0) PetscCall(PoissonSample(packing, &p->n, &p->x, &p->body));
  PetscCallMPI(MPI_Bcast(&p->n, 1, MPIU_INT, 0, comm));
  if (rank) {
    PetscCall(PetscMalloc1(DIM * p->n, &p->x));
    PetscCall(PetscMalloc1(p->n, &p->body));
  }
  PetscCallMPI(MPI_Bcast(p->x, (PetscMPIInt)(DIM * p->n), MPIU_REAL, 0, comm));
  PetscCallMPI(MPI_Bcast(p->body, (PetscMPIInt)p->n, MPIU_INT, 0, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Visit_Poisson(Packing packing, PackingVisitor visitor, void *context)
{
  const Poisson *p = (const Poisson *)packing->data;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < p->n; a++) visitor(context, a, p->body[a], p->x + DIM * a);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Improve_Poisson(Packing packing, PackingReport *report)
{
  Poisson      *p      = (Poisson *)packing->data;
  const Cloud   cloud  = packing->cloud;
  PackingTarget target = {.distance = p->distance, .tolerance = p->tolerance};

  PetscFunctionBegin;
  PetscCall(PetscFree(p->x)); /* the particles have them now */
  PetscCall(PetscFree(p->body));
  p->n = 0;
  if (p->cached) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PackingOptimise(cloud, &target));
  report->iterations = target.iterations;
  /* One that missed its goal is not kept: more iterations may be allowed next time. */
  if (packing->cache[0] && target.deviation <= p->tolerance)
    PetscCall(CacheWrite(cloud->particles, cloud->comm, packing->cache, p->hash, packing->count));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy_Poisson(Packing packing)
{
  Poisson *p = (Poisson *)packing->data;

  PetscFunctionBegin;
  PetscCall(PetscFree(p->x));
  PetscCall(PetscFree(p->body));
  PetscCall(PetscFree(packing->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PackingCreate_Poisson(Packing packing)
{
  Poisson *p;

  PetscFunctionBegin;
  PetscCall(PetscNew(&p));
  p->distance                 = 0.6;  /* reaches the tolerance of the paper; 0.7 stays at 1.5 times, 0.8 stalls */
  p->tolerance                = 9e-5; /* Kuri et al.: at most 0.1 of 1100 kg/m3 */
  packing->data               = p;
  packing->ops.setfromoptions = SetFromOptions_Poisson;
  packing->ops.check          = Check_Poisson;
  packing->ops.setup          = SetUp_Poisson;
  packing->ops.visit          = Visit_Poisson;
  packing->ops.improve        = Improve_Poisson;
  packing->ops.destroy        = Destroy_Poisson;
  PetscFunctionReturn(PETSC_SUCCESS);
}
