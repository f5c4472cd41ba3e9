/* Emitters: liquid that comes into the box during the run. */
#include "emitters_impl.h"

/* A visitor's context: collects the points of an emitter. */
typedef struct {
  PetscSegBuffer x;
  PetscReal      area; /* of each point, as in Sample */
} Points;

static PetscErrorCode KeepPoint(void *context, const Sample *sample)
{
  Points    *points = (Points *)context;
  PetscReal *x;

  PetscFunctionBegin;
  points->area = sample->area;
  PetscCall(PetscSegBufferGet(points->x, DIM, &x));
  PetscCall(PetscArraycpy(x, sample->x, DIM));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the points of an emitter, at the first call. */
static PetscErrorCode FindPoints(Cloud cloud, Packing packing, PetscInt b, Emission *emission)
{
  Points points = {.area = 0};
  size_t size;

  PetscFunctionBegin;
  if (emission->x) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSegBufferCreate(sizeof(PetscReal), 1024, &points.x));
  PetscCall(LatticeVisitBody(packing, b, KeepPoint, &points));
  PetscCall(PetscSegBufferGetSize(points.x, &size));
  PetscCall(PetscSegBufferExtractAlloc(points.x, &emission->x));
  PetscCall(PetscSegBufferDestroy(&points.x));
  emission->n    = (PetscInt)size / DIM;
  emission->area = points.area;
  PetscCheckUser(emission->n > 0, cloud->comm,
                 "no particle of -spacing %g m fits into the emitter %s; it must be larger",
                 (double)cloud->domain->spacing, BodyName(SceneBody(cloud->scene, b)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The k-th emission of body b, at the time (s). */
typedef struct {
  MPI_Comm        comm;
  const Emission *emission;
  Body            body;
  PetscInt        b, k;
  PetscReal       time;
} Portion;

static PetscErrorCode VisitPortion(void *source, SampleVisitor visitor, void *context)
{
  const Portion *portion = (const Portion *)source;
  PetscReal      shift[DIM];
  PetscInt       first, last;

  PetscFunctionBegin;
  OwnShare(portion->comm, portion->emission->n, &first, &last);
  EmissionShift(portion->body, portion->k, portion->time, shift);
  for (PetscInt p = first; p < last; p++) {
    Sample sample = {.density = BodyMaterial(portion->body)->density,
                     .body    = portion->b,
                     .area    = portion->emission->area};

    for (PetscInt d = 0; d < DIM; d++) sample.x[d] = portion->emission->x[DIM * p + d] + shift[d];
    BodyFillingVelocity(portion->body, portion->time, sample.x, sample.v);
    sample.id = sample.parent = p;
    PetscCall(visitor(context, &sample));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives the liquid inside an emitter its velocity, and a row of particles outside until the next emission comes:
   surface tension would retract the end of the liquid that has left. */
static PetscErrorCode SetVelocities(Cloud cloud, PetscReal time)
{
  const Scene    scene = cloud->scene;
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(cloud->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscInt   b = arrays.integer[INT_BODY][a];
    const PetscReal *x = arrays.real[FIELD_POSITION] + DIM * a, row = 0.5 * cloud->domain->spacing;

    if (b >= 0 && BodyHolds(SceneBody(scene, b), x, row))
      BodyFillingVelocity(SceneBody(scene, b), time, x, arrays.real[FIELD_VELOCITY] + DIM * a);
  }
  PetscCall(ParticlesClose(cloud->particles, &arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode EmissionsAdd(Emissions *emissions, Cloud cloud, Packing packing, PetscReal time, PetscBool resumed,
                            PetscInt *emitted)
{
  const Scene scene = cloud->scene;
  PetscInt    most = 1, emitters = 0, number = 0; /* points of an emitter at most; emitters; emitters before this one */

  PetscFunctionBegin;
  *emitted = 0;
  if (!SceneComesLater(scene)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    if (!BodyComesLater(SceneBody(scene, b))) continue;
    PetscCall(FindPoints(cloud, packing, b, &emissions->of[b]));
    most = PetscMax(most, emissions->of[b].n);
    emitters++;
  }
  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    Emission *emission = &emissions->of[b];
    Portion   portion  = {.comm = cloud->comm, .emission = emission, .body = SceneBody(scene, b), .b = b, .time = time};
    PetscInt  wanted, count;

    if (!BodyComesLater(portion.body)) continue;
    wanted = BodyFillings(portion.body, time);
    for (; emission->done < wanted; emission->done++) {
      if (resumed) continue;
      PetscCheckUser(emission->done < (EMITTED_ID - most) / (most * PetscMax(emitters, 1)), cloud->comm,
                     "the emitter %s has brought as many particles as this build of PETSc can number",
                     BodyName(portion.body));
      portion.k = emission->done;
      PetscCall(SamplesAppend(cloud->particles, cloud->domain, VisitPortion, &portion,
                              EMITTED_ID + (portion.k * emitters + number) * most, &count));
      *emitted += count;
    }
    number++;
  }
  PetscCall(SetVelocities(cloud, time));
  if (*emitted) PetscCall(CloudResync(cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal EmissionVolume(const Emission *emission, Domain domain)
{
  PetscReal volume = 0;

  for (PetscInt p = 0; p < emission->n; p++)
    volume += emission->area * domain->volume * DomainRingLength(domain, emission->x + DIM * p, 1);
  return volume;
}

PetscErrorCode EmissionsDestroy(Emissions *emissions)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < SCENE_MAX_BODIES; b++) PetscCall(PetscFree(emissions->of[b].x));
  PetscFunctionReturn(PETSC_SUCCESS);
}
