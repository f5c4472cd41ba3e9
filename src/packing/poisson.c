/* The type poisson: random samples fill the bodies (poisson_samples.c), TAO brings their density to rho_0 (optimise.c),
   as in Kuri et al.; a file keeps a finished packing (cache.c). */
#include "packing_impl.h"

#define DISTANCE  0.6  /* spacings, of two particles; reaches the tolerance of the paper; 0.7 stays at 1.5 times */
#define TOLERANCE 9e-5 /* Kuri et al.: at most 0.1 of 1100 kg/m3 */

typedef struct {
  PetscReal          tolerance; /* relative */
  unsigned long long hash;
  PetscBool          cached;
  PetscInt           n;
  PetscReal         *x;    /* [n][3] m, on every rank */
  PetscInt          *body; /* [n] */
} Poisson;

static const OptionRow options[] = {
  {"-packing_tolerance", "Standard deviation of the density over the rest density at which the optimisation stops", "1",
   "(0, 1)", ROW_REAL, offsetof(Poisson, tolerance)},
  {.name = NULL},
};

static void Defaults(void *owner)
{
  ((Poisson *)((Packing)owner)->data)->tolerance = TOLERANCE;
}

static PetscErrorCode SetUp_Poisson(Packing packing, PackingReport *report)
{
  Poisson       *p    = (Poisson *)packing->data;
  const MPI_Comm comm = packing->cloud->comm;
  PetscErrorCode bad  = PETSC_SUCCESS;
  PetscMPIInt    rank;
  char           how[64];

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  (void)snprintf(how, sizeof(how), "%.12g %.12g", DISTANCE, (double)p->tolerance);
  PetscCall(PackingHash(packing, how, &p->hash));
  if (packing->cache[0]) PetscCall(CacheRead(packing->cloud, packing->cache, p->hash, &p->n, &p->x, &p->body));
  p->cached = report->cached = (PetscBool)(p->n > 0);
  if (p->cached) PetscFunctionReturn(PETSC_SUCCESS);
  if (rank == 0) bad = PoissonSample(packing, &p->n, &p->x, &p->body);
  if (bad) p->n = -1;
  PetscCallMPI(MPI_Bcast(&p->n, 1, MPIU_INT, 0, comm));
  PetscCall(bad);
  if (p->n < 0) return UserErrorSaid();
  if (rank) {
    PetscCall(PetscMalloc1(DIM * p->n, &p->x));
    PetscCall(PetscMalloc1(p->n, &p->body));
  }
  PetscCallMPI(MPI_Bcast(p->x, (PetscMPIInt)(DIM * p->n), MPIU_REAL, 0, comm));
  PetscCallMPI(MPI_Bcast(p->body, (PetscMPIInt)p->n, MPIU_INT, 0, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Visit_Poisson(void *source, SampleVisitor visitor, void *context)
{
  const Poisson *p = (const Poisson *)((Packing)source)->data;
  PetscInt       first, last;

  PetscFunctionBegin;
  OwnShare(((Packing)source)->cloud->comm, p->n, &first, &last);
  for (PetscInt a = first; a < last; a++) {
    Sample sample = {.id = a, .parent = a, .body = p->body[a]};

    for (PetscInt d = 0; d < DIM; d++) sample.x[d] = p->x[DIM * a + d];
    PetscCall(visitor(context, &sample));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Improve_Poisson(Packing packing, PackingReport *report)
{
  Poisson      *p      = (Poisson *)packing->data;
  const Cloud   cloud  = packing->cloud;
  PackingTarget target = {.distance = DISTANCE, .tolerance = p->tolerance};

  PetscFunctionBegin;
  PetscCall(PetscFree(p->x)); /* the swarm has the positions now */
  PetscCall(PetscFree(p->body));
  p->n = 0;
  if (p->cached) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PackingOptimise(cloud, &target));
  report->iterations = target.iterations;
  /* A packing that missed its goal is not kept: the next run may allow more iterations. */
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
  PetscFunctionReturn(PETSC_SUCCESS);
}

const PackingOps PackingPoisson = {.choice  = {"poisson", sizeof(Poisson), options, Defaults, NULL},
                                   .setup   = SetUp_Poisson,
                                   .visit   = Visit_Poisson,
                                   .improve = Improve_Poisson,
                                   .destroy = Destroy_Poisson};
