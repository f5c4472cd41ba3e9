/* Emitters: bodies that add liquid at intervals. */
#include "../scene/body.h"
#include "emitters_impl.h"

#define FILLINGS_BEFORE    1000 /* largest number of fillings before the time 0 */
#define FILLINGS_LOOKED_AT 2    /* in FillingMoments */
#define INTERVAL_ROUNDING  1e-9 /* of the interval: a filling that is due must not be missed by rounding */

typedef struct {
  PetscReal start, interval;       /* s */
  PetscInt  count;                 /* of fillings; 0: no end */
  PetscReal nozzle;                /* m */
  PetscReal modulation, frequency; /* of the speed: amplitude e (1), f (Hz) */
  PetscReal w;                     /* 2 pi f, rad/s */
} Emitter;

/* Length (m) of the body's bounds along its velocity. */
static PetscReal LengthAlong(Body body, PetscReal speed)
{
  PetscReal lower[DIM], upper[DIM], length = PETSC_MAX_REAL;

  BodyBounds(body, lower, upper);
  for (PetscInt d = 0; d < body->domain->dim; d++)
    if (PetscAbsReal(body->uniform[d]) > 0)
      length = PetscMin(length, (upper[d] - lower[d]) * speed / PetscAbsReal(body->uniform[d]));
  return length;
}

static const OptionRow options[] = {
  {"-interval", "Time between fillings of an emitter", "s", NULL, ROW_REAL, offsetof(Emitter, interval),
   .fallback = "that of a jet without gaps"},
  {"-start", "Time of an emitter's first filling", "s", "(-inf, inf)", ROW_REAL, offsetof(Emitter, start)},
  {"-count", "Number of fillings of an emitter; 0: no end", "1", "[0, inf)", ROW_INT, offsetof(Emitter, count)},
  {"-nozzle", "Length downstream of an emitter's shape in which the liquid keeps the emitter's velocity", "m",
   "[0, inf)", ROW_REAL, offsetof(Emitter, nozzle)},
  {"-modulation", "Amplitude of the oscillation of an emitter's speed, over the speed", "1", "[0, 1)", ROW_REAL,
   offsetof(Emitter, modulation)},
  {"-modulation_frequency", "Frequency of that oscillation", "Hz", "[0, inf)", ROW_REAL, offsetof(Emitter, frequency)},
  {.name = NULL},
};

static void EmitterDefaults(void *owner)
{
  Body            body  = (Body)owner;
  const PetscReal speed = Norm(body->uniform);

  ((Emitter *)body->type_data)->interval = speed > 0 ? LengthAlong(body, speed) / speed : 0;
}

static PetscErrorCode EmitterSetUp(void *owner)
{
  Body            body  = (Body)owner;
  MPI_Comm        comm  = body->domain->comm;
  const PetscReal speed = Norm(body->uniform);
  Emitter        *e     = (Emitter *)body->type_data;

  PetscFunctionBegin;
  PetscCheckUser(!DomainIsRadial(body->domain, 0) || (body->uniform[0] == 0 && !body->velocity->add), comm,
                 "-%stype emitter with -dimension axisymmetric: the liquid must leave along the axis, so the first "
                 "number of -%svelocity must be 0 and -%svelocity_type uniform; else the rings would grow",
                 body->prefix, body->prefix, body->prefix);
  PetscCheckUser(speed > 0, comm, "-%stype emitter needs a non-zero -%svelocity: the liquid must leave the shape",
                 body->prefix, body->prefix);
  PetscCheckUser(e->interval >= LengthAlong(body, speed) / speed * (1 - INTERVAL_ROUNDING) &&
                   !PetscIsInfOrNanReal(e->interval),
                 comm, "-%sinterval is %g s; it must be at least %g s, in which the liquid leaves the shape",
                 body->prefix, (double)e->interval, (double)(LengthAlong(body, speed) / speed));
  PetscCheckUser(e->start >= -FILLINGS_BEFORE * e->interval, comm,
                 "-%sstart is %g s; it must be at least -%d times -%sinterval (%g s)", body->prefix, (double)e->start,
                 FILLINGS_BEFORE, body->prefix, (double)e->interval);
  PetscCheckUser(e->frequency > 0 || e->modulation == 0, comm, "-%smodulation needs -%smodulation_frequency, in Hz",
                 body->prefix, body->prefix);
  e->w = 2 * PETSC_PI * e->frequency;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The distance that the emitter's liquid has moved since the start, over the speed without modulation (s). */
static PetscReal TravelTime(const Emitter *e, PetscReal time)
{
  const PetscReal t = time - e->start;

  return e->modulation > 0 ? t + e->modulation * (1 - PetscCosReal(e->w * t)) / e->w : t;
}

static void FillingMoments(Body body, Moments *moments)
{
  const Emitter *e = (const Emitter *)body->type_data;

  for (PetscInt k = 0; k < FILLINGS_LOOKED_AT; k++) MomentAdd(moments, e->start + (0.5 + k) * e->interval);
  MomentAdd(moments, e->start - e->interval);
  if (e->count > 0) MomentAdd(moments, e->start + (0.5 + (PetscReal)e->count) * e->interval);
  MomentPeriod(moments, e->modulation > 0 ? e->frequency : 0, e->start);
}

static PetscInt Fillings(Body body, PetscReal time)
{
  const Emitter *e = (const Emitter *)body->type_data;
  PetscInt       n;

  if (time < e->start) return 0;
  n = (PetscInt)PetscFloorReal(TravelTime(e, time) / e->interval + INTERVAL_ROUNDING) + 1;
  return e->count > 0 ? PetscMin(n, e->count) : n;
}

void EmissionShift(Body body, PetscInt k, PetscReal time, PetscReal shift[DIM])
{
  const Emitter *e = (const Emitter *)body->type_data;

  for (PetscInt d = 0; d < DIM; d++) shift[d] = (TravelTime(e, time) - (PetscReal)k * e->interval) * body->uniform[d];
}

static void Velocity(Body body, PetscReal time, const PetscReal x[DIM], PetscReal v[DIM])
{
  const Emitter  *e     = (const Emitter *)body->type_data;
  const PetscReal speed = 1 + e->modulation * PetscSinReal(e->w * (time - e->start));

  BodyVelocity(body, x, v);
  for (PetscInt d = 0; d < DIM; d++) v[d] += (speed - 1) * body->uniform[d];
}

static PetscBool Holds(Body body, const PetscReal x[DIM], PetscReal behind)
{
  const Emitter *e = (const Emitter *)body->type_data;
  PetscReal      distance, reach, speed;
  PetscInt       steps;

  distance = BodyDistance(body, x);
  reach    = behind + e->nozzle;
  if (distance < 0 || distance >= reach) return (PetscBool)(distance < 0);
  speed = Norm(body->uniform);
  steps = (PetscInt)PetscCeilReal(reach / body->domain->spacing); /* upstream */
  for (PetscInt k = 1; k <= steps; k++) {
    PetscReal rear[DIM];

    for (PetscInt d = 0; d < DIM; d++) rear[d] = x[d] - reach * k / steps * body->uniform[d] / speed;
    if (BodyDistance(body, rear) < 0) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

const BodyTypeOps BodyTypeEmitter = {{"emitter", sizeof(Emitter), options, EmitterDefaults, EmitterSetUp},
                                     .later    = PETSC_TRUE,
                                     .holds    = Holds,
                                     .moments  = FillingMoments,
                                     .fillings = Fillings,
                                     .velocity = Velocity};
