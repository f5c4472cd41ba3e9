/* Emitters: liquid that comes into the box during the run. */
#include "packing_impl.h"

#define EMITTED_ID (PETSC_MAX_INT / 2) /* ids of emitted particles start here: the same after a restart */

typedef struct {
  Emission *emission;
  PetscInt  capacity;
} Points;

static void CountPoint(void *context, PetscInt id, PetscInt body, const PetscReal x[DIM])
{
  ((Points *)context)->capacity++;
}

static void KeepPoint(void *context, PetscInt id, PetscInt body, const PetscReal x[DIM])
{
  Emission *emission = ((Points *)context)->emission;

  for (PetscInt d = 0; d < DIM; d++) emission->x[DIM * emission->n + d] = x[d];
  emission->n++;
}

/* The points of an emitter, once. */
static PetscErrorCode FindPoints(Packing packing, PetscInt b)
{
  Points points = {.emission = &packing->emission[b]};

  PetscFunctionBegin;
  if (points.emission->x) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(LatticeVisitBody(packing, b, CountPoint, &points));
  PetscCheckUser(points.capacity > 0, packing->cloud->comm,
                 "no particle of -spacing %g m fits into the emitter %s; it must be larger",
                 (double)packing->cloud->domain->spacing, BodyName(SceneBody(packing->cloud->scene, b)));
  PetscCall(PetscMalloc1(DIM * points.capacity, &points.emission->x));
  PetscCall(LatticeVisitBody(packing, b, KeepPoint, &points));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Emission number k of body b, counted over all emitters by 'number': appends this rank's particles. */
static PetscErrorCode Emit(Packing packing, PetscInt b, PetscInt k, PetscInt first_id, PetscReal time)
{
  const Cloud     cloud    = packing->cloud;
  const Domain    domain   = cloud->domain;
  const Body      body     = SceneBody(cloud->scene, b);
  const Emission *emission = &packing->emission[b];
  PetscMPIInt     rank;
  PetscInt        own = 0, next;
  PetscReal       shift[DIM];
  ParticleArrays  arrays;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(cloud->comm, &rank));
  BodyEmissionShift(body, k, time, shift);
  for (PetscInt pass = 0; pass < 2; pass++) {
    if (pass) {
      PetscCall(ParticlesLocalSize(cloud->particles, &next));
      PetscCall(ParticlesAppend(cloud->particles, own));
      PetscCall(ParticlesOpen(cloud->particles, &arrays));
    }
    for (PetscInt p = 0; p < emission->n; p++) {
      PetscReal x[DIM];

      for (PetscInt d = 0; d < DIM; d++) x[d] = emission->x[DIM * p + d] + shift[d];
      if (domain->cell_rank[DomainCell(domain, x)] != rank) continue;
      if (!pass) {
        own++;
        continue;
      }
      for (PetscInt d = 0; d < DIM; d++) arrays.real[FIELD_POSITION][DIM * next + d] = x[d];
      BodyEmissionVelocity(body, time, x, arrays.real[FIELD_VELOCITY] + DIM * next);
      arrays.real[FIELD_DENSITY][next] = BodyMaterial(body)->density;
      arrays.integer[INT_ID][next]     = first_id + p;
      arrays.integer[INT_PARENT][next] = first_id + p;
      arrays.integer[INT_BODY][next++] = b;
    }
  }
  PetscCall(ParticlesClose(cloud->particles, &arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Liquid inside an emitter moves with its velocity. */
static PetscErrorCode Hold(Packing packing, PetscReal time)
{
  const Scene    scene = packing->cloud->scene;
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(packing->cloud->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscInt   b = arrays.integer[INT_BODY][a];
    const PetscReal *x = arrays.real[FIELD_POSITION] + DIM * a;

    if (b >= 0 && BodyEmits(SceneBody(scene, b)) && BodyDistance(SceneBody(scene, b), x) < 0)
      BodyEmissionVelocity(SceneBody(scene, b), time, x, arrays.real[FIELD_VELOCITY] + DIM * a);
  }
  PetscCall(ParticlesClose(packing->cloud->particles, &arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PackingEmit(Packing packing, PetscReal time, PetscBool resumed, PetscInt *emitted)
{
  const Scene scene    = packing->cloud->scene;
  PetscInt    first_id = EMITTED_ID, most = 1, emitters = 0, number = 0;

  PetscFunctionBegin;
  *emitted = 0;
  if (!SceneEmits(scene)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    if (!BodyEmits(SceneBody(scene, b))) continue;
    PetscCall(FindPoints(packing, b));
    most = PetscMax(most, packing->emission[b].n);
    emitters++;
  }
  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    Emission *emission = &packing->emission[b];
    PetscInt  wanted;

    if (!BodyEmits(SceneBody(scene, b))) continue;
    wanted = BodyEmissions(SceneBody(scene, b), time);
    for (; emission->done < wanted; emission->done++) {
      if (resumed) continue;
      PetscCheckUser(emission->done < (EMITTED_ID - most) / (most * PetscMax(emitters, 1)), packing->cloud->comm,
                     "the emitter %s has brought as many particles as this build of PETSc can number",
                     BodyName(SceneBody(scene, b)));
      PetscCall(Emit(packing, b, emission->done, first_id + (emission->done * emitters + number) * most, time));
      *emitted += emission->n;
    }
    number++;
  }
  PetscCall(Hold(packing, time));
  if (*emitted) PetscCall(CloudResync(packing->cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode EmissionsDestroy(Packing packing)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < SCENE_MAX_BODIES; b++) PetscCall(PetscFree(packing->emission[b].x));
  PetscFunctionReturn(PETSC_SUCCESS);
}
