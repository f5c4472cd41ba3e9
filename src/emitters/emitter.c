/* Emitters: bodies that add liquid at intervals. */
#include "../scene/body.h"
#include "emitters_impl.h"

#define FILLINGS_BEFORE    1000 /* largest number of fillings before the time 0 */
#define FILLINGS_LOOKED_AT 2    /* in FillingMoments */
#define INTERVAL_ROUNDING  1e-9 /* of the interval: a filling that is due must not be missed by rounding */

#define ROWS_MOST 256 /* of a table of speeds */

#define WAY_STEP     0.25 /* spacings, of WayOut */
#define WAY_HALVINGS 30
#define PRISM        0.01 /* spacings by which lengths of a shape along the velocity may differ, to be always full */
#define BUFFER       3    /* spacings of moving liquid that free liquid needs behind it, so that it is pushed */

typedef struct {
  PetscReal  start, interval;       /* s */
  PetscInt   count;                 /* of fillings; 0: no end */
  PetscReal  nozzle;                /* m */
  PetscReal  modulation, frequency; /* of the speed: amplitude e (1), f (Hz) */
  PetscReal  w;                     /* 2 pi f, rad/s */
  OptionFile file;                  /* of the table; empty: none */
  PetscInt   rows;                  /* of the table */
  PetscReal  row[ROWS_MOST][2];     /* [rows] time (s), speed (m/s) */
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

/* Whether fillings follow each other without gaps. */
static PetscBool WithoutGaps(Body body)
{
  const PetscReal speed = Norm(body->uniform);

  return (PetscBool)(((const Emitter *)body->type_data)->interval * speed <=
                     LengthAlong(body, speed) * (1 + INTERVAL_ROUNDING));
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
  {"-velocity_file",
   "Table of an emitter's speed, lines of t,speed (s, m/s), linear between them and constant before and after; "
   "the direction is that of the velocity",
   NULL, NULL, ROW_FILE, offsetof(Emitter, file), .fallback = "none"},
  {"-modulation_frequency", "Frequency of that oscillation", "Hz", "[0, inf)", ROW_REAL, offsetof(Emitter, frequency)},
  {.name = NULL},
};

static void EmitterDefaults(void *owner)
{
  Body            body  = (Body)owner;
  const PetscReal speed = Norm(body->uniform);

  ((Emitter *)body->type_data)->interval = speed > 0 ? LengthAlong(body, speed) / speed : 0;
}

static PetscErrorCode ReadSpeeds(Body body, Emitter *e)
{
  const MPI_Comm comm = body->domain->comm;
  char           option[SCENE_NAME_LENGTH + 32];
  PetscInt       columns;
  PetscReal     *table;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(option, sizeof(option), "-%svelocity_file", body->prefix));
  PetscCall(TableRead(comm, option, "two finite numbers, time and speed", "later time", 2, 2, &e->file, &e->rows,
                      &columns, &table));
  if (!e->rows) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheckUser(e->rows <= ROWS_MOST, comm, "%s %s has %" PetscInt_FMT " lines; at most %d are allowed", option,
                 e->file.path, e->rows, ROWS_MOST);
  PetscCheckUser(e->modulation == 0, comm, "%s and -%smodulation cannot be used together", option, body->prefix);
  for (PetscInt k = 0; k < e->rows; k++) {
    PetscCheckUser(table[2 * k + 1] >= 0 && table[2 * k + 1] <= SPEED_MAX, comm,
                   "%s %s: the speed %g m/s must lie in [0, %g]: an emitter takes no liquid back", option, e->file.path,
                   (double)table[2 * k + 1], SPEED_MAX);
    e->row[k][0] = table[2 * k];
    e->row[k][1] = table[2 * k + 1];
  }
  PetscCall(PetscFree(table));
  PetscFunctionReturn(PETSC_SUCCESS);
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
  PetscCall(ReadSpeeds(body, e));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The speed of the table at a time (m/s). */
static PetscReal TableSpeed(const Emitter *e, PetscReal time)
{
  PetscInt k = 0;

  while (k < e->rows && e->row[k][0] <= time) k++;
  if (k == 0 || k == e->rows) return e->row[PetscMax(0, k - 1)][1];
  return e->row[k - 1][1] +
         (e->row[k][1] - e->row[k - 1][1]) * (time - e->row[k - 1][0]) / (e->row[k][0] - e->row[k - 1][0]);
}

/* The way (m) of liquid with the table's speed from the start to a time: the trapezoids between rows are exact. */
static PetscReal TableWay(const Emitter *e, PetscReal time)
{
  PetscReal way = 0, before = e->start;

  for (PetscInt k = 0; k <= e->rows && before < time; k++) {
    const PetscReal next = k < e->rows ? PetscMin(time, e->row[k][0]) : time;

    if (next <= before) continue;
    way += 0.5 * (next - before) * (TableSpeed(e, before) + TableSpeed(e, next));
    before = next;
  }
  return way;
}

/* The distance that the emitter's liquid has moved since the start, over the speed of the body's velocity (s). */
static PetscReal TravelTime(Body body, PetscReal time)
{
  const Emitter  *e = (const Emitter *)body->type_data;
  const PetscReal t = time - e->start;

  if (e->rows) return t <= 0 ? t : TableWay(e, time) / Norm(body->uniform);
  return e->modulation > 0 ? t + e->modulation * (1 - PetscCosReal(e->w * t)) / e->w : t;
}

static void FillingMoments(Body body, Moments *moments)
{
  const Emitter  *e    = (const Emitter *)body->type_data;
  const PetscReal past = PetscMax(0, PetscCeilReal((moments->start - e->start) / e->interval));

  for (PetscInt k = 0; k < FILLINGS_LOOKED_AT; k++) { /* of a jet the first ones, of drops the next ones */
    const PetscReal filling = (WithoutGaps(body) ? 0 : past) + k;

    if (e->count == 0 || filling < e->count) MomentAdd(moments, e->start + (0.5 + filling) * e->interval);
  }
  MomentAdd(moments, e->start - e->interval);
  if (e->count > 0) MomentAdd(moments, e->start + (0.5 + (PetscReal)e->count) * e->interval);
  for (PetscInt k = 0; k < e->rows; k++) MomentAdd(moments, e->row[k][0]);
  MomentTable(moments, &e->row[0][0], e->rows, 2, 1);
  MomentPeriod(moments, e->modulation > 0 ? e->frequency : 0, e->start);
}

static PetscInt Fillings(Body body, PetscReal time)
{
  const Emitter *e = (const Emitter *)body->type_data;
  PetscInt       n;

  if (time < e->start) return 0;
  n = (PetscInt)PetscFloorReal(TravelTime(body, time) / e->interval + INTERVAL_ROUNDING) + 1;
  return e->count > 0 ? PetscMin(n, e->count) : n;
}

PetscInt EmissionCount(const Emission *emission, Body body, PetscReal time, PetscInt p)
{
  const Emitter  *e   = (const Emitter *)body->type_data;
  const PetscReal way = emission->way[p], share = emission->stretch,
                  room = 1 - 0.5 * body->domain->spacing / LengthAlong(body, Norm(body->uniform));
  PetscReal ahead      = room / share - way;
  PetscInt  n;

  if (way < 0 || time < e->start) return Fillings(body, time);
  if (ahead < 0 && share * way < 1) ahead = 0; /* nearer than half a spacing to the rear */
  n = (PetscInt)PetscFloorReal(TravelTime(body, time) / (share * e->interval) + ahead + INTERVAL_ROUNDING) + 1;
  if (e->count > 0) n = PetscMin(n, (PetscInt)PetscCeilReal(e->count / share - way - INTERVAL_ROUNDING));
  return PetscMax(0, n);
}

PetscReal EmissionFilling(const Emission *emission, PetscInt k, PetscInt p)
{
  return emission->way[p] < 0 ? k : emission->stretch * k + (emission->stretch - 1) * emission->way[p];
}

/* Whether the point at a distance (m) from x along the emitter's velocity is in the shape. */
static PetscBool Inside(Body body, const PetscReal x[DIM], PetscReal way)
{
  PetscReal y[DIM];

  for (PetscInt d = 0; d < DIM; d++) y[d] = x[d] + way * body->uniform[d] / Norm(body->uniform);
  return (PetscBool)(BodyDistance(body, y) < 0);
}

/* The distance (m) from x in the shape to its surface, along the emitter's velocity or against it (sign -1). */
static PetscReal WayOut(Body body, const PetscReal x[DIM], PetscReal sign)
{
  const PetscReal step = WAY_STEP * body->domain->spacing, length = LengthAlong(body, Norm(body->uniform));
  PetscReal       least = 0, most = step, way = step;

  for (; Inside(body, x, sign * most) && most < length; most += step) least = most;
  for (PetscInt k = 0; k < WAY_HALVINGS; k++) {
    way = 0.5 * (least + most);
    if (Inside(body, x, sign * way))
      least = way;
    else
      most = way;
  }
  return way;
}

PetscReal EmissionWay(Body body, const PetscReal x[DIM])
{
  const PetscReal length = LengthAlong(body, Norm(body->uniform)), front = WayOut(body, x, 1);

  if (!WithoutGaps(body)) return -1;
  if (PetscAbsReal(front + WayOut(body, x, -1) - length) > PRISM * body->domain->spacing) return -1;
  return front / length;
}

void EmissionShift(Body body, PetscReal k, PetscReal time, PetscReal shift[DIM])
{
  const Emitter *e = (const Emitter *)body->type_data;

  for (PetscInt d = 0; d < DIM; d++) shift[d] = (TravelTime(body, time) - k * e->interval) * body->uniform[d];
}

PetscBool EmissionIsJet(Body body, PetscInt *along)
{
  const PetscReal *v = body->uniform;

  for (*along = 0; *along < body->domain->dim - 1 && v[*along] == 0;) (*along)++;
  return (PetscBool)(PetscAbsReal(v[*along]) == Norm(v) && WithoutGaps(body));
}

static void Velocity(Body body, PetscReal time, const PetscReal x[DIM], PetscReal v[DIM])
{
  const Emitter  *e = (const Emitter *)body->type_data;
  const PetscReal speed =
    e->rows ? TableSpeed(e, time) / Norm(body->uniform) : 1 + e->modulation * PetscSinReal(e->w * (time - e->start));

  BodyVelocity(body, x, v);
  for (PetscInt d = 0; d < DIM; d++) v[d] += (speed - 1) * body->uniform[d];
}

static PetscBool Holds(Body body, const PetscReal x[DIM], PetscReal behind)
{
  const Emitter *e = (const Emitter *)body->type_data;
  PetscReal      distance, reach, speed;
  PetscInt       steps;

  speed    = Norm(body->uniform);
  distance = BodyDistance(body, x);
  reach    = PetscMax(e->nozzle, BUFFER * body->domain->spacing - LengthAlong(body, speed));
  if (!WithoutGaps(body)) reach = e->nozzle + behind;
  if (distance < 0 || distance >= reach) return (PetscBool)(distance < 0);
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
