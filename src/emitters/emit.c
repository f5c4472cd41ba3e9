/* Emitters: liquid that comes into the box during the run. */
#include "../scene/body.h"
#include "emitters_impl.h"

#define SLACK       1e-6 /* spacings, of a shape's faces; of a train's period and share */
#define PLACES      8    /* at which a point must be inside its shape on its way through it */
#define LEAST_SHARE 0.5  /* of a train */
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

/* The points of an emitter, in place of those before. shaken: with the jitter. */
static PetscErrorCode Collect(Packing packing, PetscInt b, PetscBool shaken, Emission *emission)
{
  Points points = {.area = 0};
  size_t size;

  PetscFunctionBegin;
  PetscCall(PetscSegBufferCreate(sizeof(PetscReal), 1024, &points.x));
  PetscCall(LatticeVisitBody(packing, b, shaken, KeepPoint, &points));
  PetscCall(PetscSegBufferGetSize(points.x, &size));
  PetscCall(PetscFree(emission->x));
  PetscCall(PetscSegBufferExtractAlloc(points.x, &emission->x));
  PetscCall(PetscSegBufferDestroy(&points.x));
  emission->n    = (PetscInt)size / DIM;
  emission->area = points.area;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the points of an emitter. Their jitter stays in what pushes, which is evened out across its velocity alone.
   Rows without it do not stretch evenly: a sheet of honey fell 10 % too fast, and in pieces with jitter across alone.
 */
static PetscErrorCode FindPoints(Cloud cloud, Packing packing, PetscInt b, Emission *emission)
{
  const Body body  = SceneBody(cloud->scene, b);
  PetscBool  whole = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(Collect(packing, b, PETSC_FALSE, emission));
  PetscCheckUser(emission->n > 0, cloud->comm,
                 "no particle of -spacing %g m fits into the emitter %s; it must be larger",
                 (double)cloud->domain->spacing, BodyName(body));
  PetscCall(PetscCalloc2(emission->n, &emission->way, emission->n, &emission->done));
  for (PetscInt p = 0; p < emission->n; p++) {
    emission->way[p] = EmissionWay(body, emission->x + DIM * p);
    whole            = (PetscBool)(whole || emission->way[p] < 0);
  }
  emission->stretch = whole ? 1 : Stretch(cloud, emission, body);
  for (PetscInt p = 0; p < emission->n && whole; p++) emission->way[p] = -1;
  PetscCall(Collect(packing, b, PETSC_TRUE, emission));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What body b brings from its counts 'done' on, up to the time (s). */
typedef struct {
  MPI_Comm        comm;
  const Emission *emission;
  Body            body;
  PetscInt        b, stride; /* stride: of the numbers of particles between fillings */
  PetscReal       time;
} Portion;

static PetscErrorCode VisitPortion(void *source, SampleVisitor visitor, void *context)
{
  const Portion  *portion  = (const Portion *)source;
  const Emission *emission = portion->emission;
  PetscInt        first, last;

  PetscFunctionBegin;
  OwnShare(portion->comm, emission->n, &first, &last);
  for (PetscInt p = first; p < last; p++)
    for (PetscInt k = emission->done[p]; k < EmissionCount(emission, portion->body, portion->time, p); k++) {
      Sample    sample = {.density = BodyMaterial(portion->body)->density, .body = portion->b, .area = emission->area};
      PetscReal shift[DIM];

      EmissionShift(portion->body, EmissionFilling(emission, k, p), portion->time, shift);
      for (PetscInt d = 0; d < DIM; d++) sample.x[d] = emission->x[DIM * p + d] + shift[d];
      BodyFillingVelocity(portion->body, portion->time, sample.x, sample.v);
      sample.id = sample.parent = k * portion->stride + p;
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

/* At the start of a run that begins later than an emitter, what came before the start is past, but for what is still in
   the emitter. */
static void Forget(Emission *emission, Body body, PetscReal time)
{
  for (PetscInt p = 0; p < emission->n; p++) {
    const PetscInt count = EmissionCount(emission, body, time, p);
    PetscReal      x[DIM], shift[DIM];

    if (count == 0) continue;
    EmissionShift(body, EmissionFilling(emission, count - 1, p), time, shift);
    for (PetscInt d = 0; d < DIM; d++) x[d] = emission->x[DIM * p + d] + shift[d];
    emission->done[p] = count - (BodyHolds(body, x, 0) ? 1 : 0);
  }
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
    if (!emissions->of[b].x) {
      PetscCall(FindPoints(cloud, packing, b, &emissions->of[b]));
      Forget(&emissions->of[b], SceneBody(scene, b), time);
    }
    most = PetscMax(most, emissions->of[b].n);
    emitters++;
  }
  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    Emission *emission = &emissions->of[b];
    Portion   portion  = {.comm     = cloud->comm,
                          .emission = emission,
                          .body     = SceneBody(scene, b),
                          .b        = b,
                          .stride   = most * emitters,
                          .time     = time};
    PetscInt  count, due = 0;

    if (!BodyComesLater(portion.body)) continue;
    PetscCheckUser(BodyFillings(portion.body, time) / emission->stretch <
                     (PetscReal)(EMITTED_ID - most) / portion.stride - 1,
                   cloud->comm, "the emitter %s has brought as many particles as this build of PETSc can number",
                   BodyName(portion.body));
    for (PetscInt p = 0; p < emission->n && !resumed; p++)
      due += EmissionCount(emission, portion.body, time, p) - emission->done[p];
    if (due)
      PetscCall(
        SamplesAppend(cloud->particles, cloud->domain, VisitPortion, &portion, EMITTED_ID + number * most, &count));
    for (PetscInt p = 0; p < emission->n; p++) emission->done[p] = EmissionCount(emission, portion.body, time, p);
    *emitted += due;
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
  for (PetscInt b = 0; b < SCENE_MAX_BODIES; b++) {
    PetscCall(PetscFree(emissions->of[b].x));
    PetscCall(PetscFree2(emissions->of[b].way, emissions->of[b].done));
  }
  PetscCall(PetscFree2(emissions->pushing, emissions->pushed));
  PetscFunctionReturn(PETSC_SUCCESS);
}
