/* Emitters: liquid that comes into the box during the run. */
#include "../scene/body.h"
#include "emitters_impl.h"

#define SLACK       1e-6 /* spacings, of a shape's faces; of a train's period and share */
#define PLACES      8    /* at which a point must be inside its shape on its way through it */
#define LEAST_SHARE 0.5  /* then a filling has a point twice at most */
#define CELLS       64   /* per spacing, of a cross-section */
#define MOST_CELLS  1024 /* in each direction */

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

/* Length (m) of a jet's filling, and *from: its lower end. */
static PetscReal Reach(Body body, PetscInt along, PetscReal *from)
{
  PetscReal lower[DIM], upper[DIM];

  BodyBounds(body, lower, upper);
  *from = lower[along];
  return upper[along] - lower[along];
}

/* Whether a point of an emitter that moves through it along the jet is never farther outside, nor in a solid. */
static PetscBool StaysInside(const Emission *emission, Scene scene, Body body, PetscInt p)
{
  const PetscReal *x     = emission->x + DIM * p;
  const PetscReal  slack = SLACK * body->domain->spacing, out = PetscMax(0, BodyDistance(body, x)) + slack;
  PetscReal        from, y[DIM];
  const PetscReal  length = Reach(body, emission->along, &from);

  for (PetscInt d = 0; d < DIM; d++) y[d] = x[d];
  for (PetscInt k = 0; k < PLACES; k++) {
    y[emission->along] = from + (k + 0.5) / PLACES * length;
    if (BodyDistance(body, y) > out || SceneSolidDistance(scene, y, NULL) <= 0) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* The cross-section (m2, in two dimensions m) of an emitter in the middle of its length, where no solid is. */
static PetscReal CrossSection(Cloud cloud, Body body, PetscInt along)
{
  const Domain domain = cloud->domain;
  PetscInt     n[DIM] = {1, 1, 1}, index[DIM], inside = 0;
  PetscReal    cell = 1, lower[DIM], upper[DIM], x[DIM] = {0, 0, 0};

  BodyBounds(body, lower, upper);
  for (PetscInt d = 0; d < domain->dim; d++) {
    if (d == along) continue;
    lower[d] = PetscMax(lower[d], domain->lower[d]);
    upper[d] = PetscMin(upper[d], domain->upper[d]);
    n[d]     = PetscMin(MOST_CELLS, (PetscInt)PetscCeilReal(CELLS * (upper[d] - lower[d]) / domain->spacing));
    cell *= (upper[d] - lower[d]) / n[d];
  }
  for (PetscInt k = 0; k < n[0] * n[1] * n[2]; k++) {
    CellCoordinates(n, k, index);
    for (PetscInt d = 0; d < domain->dim; d++) x[d] = lower[d] + (index[d] + 0.5) * (upper[d] - lower[d]) / n[d];
    inside += BodyContains(body, x) && SceneSolidDistance(cloud->scene, x, NULL) > 0;
  }
  return inside * cell;
}

/* By how much the train of a jet's points is stretched: their volume over that of the shape. 1: not. Rings have the
   right area. */
static PetscReal Stretch(Cloud cloud, Emission *emission, Body body)
{
  const Domain domain = cloud->domain;
  PetscReal    from, length, share;

  if (emission->area != 1 || !EmissionIsJet(body, &emission->along)) return 1;
  length = Reach(body, emission->along, &from);
  if (from < domain->lower[emission->along] || from + length > domain->upper[emission->along]) return 1;
  share = emission->n * domain->volume / (length * CrossSection(cloud, body, emission->along));
  if (!(share >= LEAST_SHARE && share <= 1 / LEAST_SHARE) || PetscAbsReal(share - 1) < SLACK) return 1;
  for (PetscInt p = 0; p < emission->n; p++)
    if (!StaysInside(emission, cloud->scene, body, p)) return 1;
  return share;
}

PetscBool EmissionPoint(const Emission *emission, Body body, PetscInt k, PetscInt p, PetscInt copy, PetscReal x[DIM])
{
  const PetscBool up = (PetscBool)(body->uniform[emission->along] > 0);
  PetscReal       from, way, length, period;

  for (PetscInt d = 0; d < DIM; d++) x[d] = emission->x[DIM * p + d];
  if (emission->stretch == 1) return (PetscBool)(copy == 0);
  length = Reach(body, emission->along, &from);
  period = emission->stretch * length;
  way    = up ? from + length - x[emission->along] : x[emission->along] - from; /* upstream from the end of filling k */
  way    = emission->stretch * way - (PetscReal)k * length;
  way += period * (PetscCeilReal(-way / period - SLACK) + (PetscReal)copy);
  x[emission->along] = up ? from + length - way : from + way;
  return (PetscBool)(way < length - SLACK * period);
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
  emission->n       = (PetscInt)size / DIM;
  emission->area    = points.area;
  emission->stretch = Stretch(cloud, emission, SceneBody(cloud->scene, b));
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
  for (PetscInt q = 2 * first; q < 2 * last; q++) {
    Sample sample = {.density = BodyMaterial(portion->body)->density,
                     .body    = portion->b,
                     .area    = portion->emission->area};

    if (!EmissionPoint(portion->emission, portion->body, portion->k, q / 2, q % 2, sample.x)) continue;
    for (PetscInt d = 0; d < DIM; d++) sample.x[d] += shift[d];
    BodyFillingVelocity(portion->body, portion->time, sample.x, sample.v);
    sample.id = sample.parent = q / 2 + (q % 2) * portion->emission->n;
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
    most = PetscMax(most, (emissions->of[b].stretch < 1 ? 2 : 1) * emissions->of[b].n);
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
  return volume / emission->stretch;
}

PetscErrorCode EmissionsDestroy(Emissions *emissions)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < SCENE_MAX_BODIES; b++) PetscCall(PetscFree(emissions->of[b].x));
  PetscFunctionReturn(PETSC_SUCCESS);
}
