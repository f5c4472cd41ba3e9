/* Prescribed motion of solids. It is a function of the time alone, so a checkpoint does not store it; free bodies,
   whose state a checkpoint stores, are in rigid.c. A point of the solid moves as

     x(t) = c + s(t) + R(t) (X - c),  s(t) = velocity t + amplitude (sin(w t + phase) - sin(phase)) + table(t),

   with X its position at the time 0, where the solid has the position of its shape, c the centre of rotation, and R(t)
   the rotation by the angle |rate| t about the direction of the rate, or by that of the table about its axis. The table
   is a file of lines t, x, y (and z), and perhaps an angle. A cubic curve connects its points, monotone between two
   of them, with velocity zero at the first and the last point; before and after them the displacement is constant. */
#include "bodies_impl.h"
#include "../scene/body.h"
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define DEGREE        (PETSC_PI / 180)
#define MOVES         (DIM + 1) /* of a table's row, after its time: displacement and angle */
#define TABLE_ROW     (1 + MOVES)
#define TABLE_SAMPLES 16 /* between two rows of a table, for its largest speed */
#define STEEPEST      3  /* slope at a row over those beside it, at most: then a cubic curve does not overshoot */

struct _p_Motion {
  PetscReal     velocity[DIM];            /* m/s */
  PetscReal     amplitude[DIM], w, phase; /* m, rad/s, rad */
  PetscReal     frequency, phase_degrees; /* Hz, degrees */
  OptionNumbers rate_given;
  PetscReal     center_given[DIM];          /* m */
  PetscReal     rate[DIM], center[DIM];     /* rad/s, m */
  PetscReal     axis[DIM];                  /* of the table's angles */
  OptionFile    file;                       /* of the table; empty: none */
  PetscReal     shift[DIM], turn[DIM][DIM]; /* s and R at the time of MotionSetTime */
  PetscInt      rows;                       /* of the table */
  PetscReal    *table;                      /* [rows][TABLE_ROW]: time (s), displacement (m), angle (rad) */
};

/* Displacement (m) and angle (rad) at a row of the table, and their rates (m/s, rad/s). The rate is the difference of
   the rows after and before over that of their times, and 0 at the first and the last row. So that the solid stays
   between two rows, it is 0 where the table stops or turns, else bounded as Fritsch and Carlson say (Monotone piecewise
   cubic interpolation, SIAM J. Numer. Anal. 17, 238, 1980). */
static void Row(const struct _p_Motion *m, PetscInt k, PetscReal move[MOVES], PetscReal rate[MOVES])
{
  const PetscReal *row = m->table + TABLE_ROW * k, *before = row - TABLE_ROW, *after = row + TABLE_ROW;

  for (PetscInt d = 0; d < MOVES; d++) {
    move[d] = row[1 + d];
    rate[d] = 0;
    if (k > 0 && k < m->rows - 1) {
      const PetscReal in  = (row[1 + d] - before[1 + d]) / (row[0] - before[0]),
                      out = (after[1 + d] - row[1 + d]) / (after[0] - row[0]), sign = in > 0 ? 1 : -1,
                      mean = (after[1 + d] - before[1 + d]) / (after[0] - before[0]);

      if (in * out > 0) rate[d] = sign * PetscMin(sign * mean, STEEPEST * PetscMin(sign * in, sign * out));
    }
  }
}

/* The table's displacement (m) and angle (rad) at a time (s), and their rates: a cubic Hermite curve between the
   rows. */
static void Table(const struct _p_Motion *m, PetscReal time, PetscReal move[MOVES], PetscReal rate[MOVES])
{
  PetscInt  k = 0, last = m->rows - 1;
  PetscReal a[MOVES], b[MOVES], va[MOVES], vb[MOVES], length, u;

  for (PetscInt d = 0; d < MOVES; d++) move[d] = rate[d] = 0;
  if (m->rows == 0) return;
  while (last - k > 1) {
    const PetscInt middle = (k + last) / 2;

    if (m->table[TABLE_ROW * middle] <= time)
      k = middle;
    else
      last = middle;
  }
  Row(m, k, a, va);
  Row(m, k + 1, b, vb);
  length = m->table[TABLE_ROW * (k + 1)] - m->table[TABLE_ROW * k];
  u      = (time - m->table[TABLE_ROW * k]) / length;
  if (u < 0 || u > 1) { /* before the first or after the last row */
    for (PetscInt d = 0; d < MOVES; d++) move[d] = u < 0 ? a[d] : b[d];
    return;
  }
  for (PetscInt d = 0; d < MOVES; d++) {
    const PetscReal step = b[d] - a[d], cubic = length * (va[d] + vb[d]) - 2 * step,
                    square = 3 * step - length * (2 * va[d] + vb[d]);

    move[d] = a[d] + u * (length * va[d] + u * (square + u * cubic));
    rate[d] = va[d] + u * (2 * square + 3 * u * cubic) / length;
  }
}

/* s (m) and R at a time (s), of a prescribed motion, and their rates (m/s, rad/s). */
static void Prescribed(const struct _p_Motion *m, PetscReal time, PetscReal shift[DIM], PetscReal turn[DIM][DIM],
                       PetscReal velocity[DIM], PetscReal spin[DIM])
{
  PetscReal move[MOVES], rate[MOVES], angle[DIM];

  Table(m, time, move, rate);
  for (PetscInt d = 0; d < DIM; d++) {
    shift[d] = m->velocity[d] * time + move[d] +
               m->amplitude[d] * (PetscSinReal(m->w * time + m->phase) - PetscSinReal(m->phase));
    velocity[d] = m->velocity[d] + m->amplitude[d] * m->w * PetscCosReal(m->w * time + m->phase) + rate[d];
    spin[d]     = m->rate[d] + m->axis[d] * rate[DIM];
    angle[d]    = m->rate[d] * time + m->axis[d] * move[DIM]; /* one of both is 0 */
  }
  RotationMatrix(angle, 1, turn);
}

/* s and R of a solid at a time (s). */
static void Pose(Body body, PetscReal time, PetscReal shift[DIM], PetscReal turn[DIM][DIM])
{
  PetscReal velocity[DIM], spin[DIM];

  if (body->free)
    FreePose(body, time, shift, turn);
  else
    Prescribed(body->motion, time, shift, turn, velocity, spin);
}

/* y = c + R^T (x - c - s): the position at the time 0 of the point that is at x. */
static void Back(const struct _p_Motion *m, const PetscReal shift[DIM], const PetscReal turn[DIM][DIM],
                 const PetscReal x[DIM], PetscReal y[DIM])
{
  for (PetscInt i = 0; i < DIM; i++) {
    y[i] = m->center[i];
    for (PetscInt j = 0; j < DIM; j++) y[i] += turn[j][i] * (x[j] - m->center[j] - shift[j]);
  }
}

static const OptionRow MotionOptions[] = {
  {"-velocity", "Velocity of the solid", "m/s", NULL, ROW_DIRECTION, offsetof(struct _p_Motion, velocity)},
  {"-oscillation_amplitude", "Amplitude a of an oscillation a (sin(2 pi f t + phase) - sin(phase))", "m", NULL,
   ROW_DIRECTION, offsetof(struct _p_Motion, amplitude)},
  {"-oscillation_frequency", "Frequency f of that oscillation", "Hz", "[0, inf)", ROW_REAL,
   offsetof(struct _p_Motion, frequency)},
  {"-oscillation_phase", "Phase of that oscillation; -90: it starts from rest", "degrees", "[-360, 360]", ROW_REAL,
   offsetof(struct _p_Motion, phase_degrees)},
  {"-rotation_rate", "Angular velocity vector of the solid; in two dimensions one number is enough", "rad/s", NULL,
   ROW_NUMBERS, offsetof(struct _p_Motion, rate_given)},
  {"-rotation_center",
   "Point on the axis of the solid's rotation, which moves with the solid; for a solid with a mass the centre of mass, "
   "by default that of its shape",
   "m", NULL, ROW_POINT, offsetof(struct _p_Motion, center_given)},
  {"-rotation_axis", "Direction of the axis of the angles in -motion_file", NULL, NULL, ROW_AXIS,
   offsetof(struct _p_Motion, axis), .fallback = "z"},
  {"-motion_file",
   "File of lines t,x,y or t,x,y,z: displacements of the solid (paddle, wavemaker) at increasing times (s), which a "
   "smooth curve connects; one number more is an angle (degrees) about -rotation_axis through -rotation_center",
   NULL, NULL, ROW_FILE, offsetof(struct _p_Motion, file)},
  {.name = NULL},
};

static PetscErrorCode MotionSetFromOptions(Body body, OptionItems PetscOptionsObject)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(&body->motion));
  PetscCall(DomainReadOptions(body->domain, PetscOptionsObject, MotionOptions, "SceneSetFromOptions", body->motion));
  PetscCall(FreeSetFromOptions(body, PetscOptionsObject));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses a table in which the solid is faster than SPEED_MAX. */
static PetscErrorCode CheckTable(Body body)
{
  const struct _p_Motion *m = body->motion;

  PetscFunctionBegin;
  for (PetscInt k = 0; k + 1 < m->rows; k++) {
    const PetscReal *a = m->table + TABLE_ROW * k, *b = a + TABLE_ROW,
                    step[DIM] = {b[1] - a[1], b[2] - a[2], b[3] - a[3]}, speed = Norm(step) / (b[0] - a[0]);

    PetscCheckUser(speed <= SPEED_MAX, body->domain->comm,
                   "-%smotion_file %s: between %g and %g s the solid moves by %g m, with %g m/s; at most %g m/s are "
                   "allowed",
                   body->prefix, m->file.path, (double)a[0], (double)b[0], (double)Norm(step), (double)speed,
                   SPEED_MAX);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads the table. */
static PetscErrorCode ShareTable(Body body)
{
  struct _p_Motion *m   = body->motion;
  const PetscInt    dim = body->domain->dim;
  PetscInt          columns;
  PetscReal        *read;
  char              option[SCENE_NAME_LENGTH + 32], what[128];

  PetscFunctionBegin;
  if (!m->file.path[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(option, sizeof(option), "-%smotion_file", body->prefix));
  PetscCall(PetscSNPrintf(what, sizeof(what), "%d finite numbers, %s, or in all lines an angle more", (int)dim + 1,
                          dim == 2 ? "t,x,y" : "t,x,y,z"));
  PetscCall(
    TableRead(body->domain->comm, option, what, "later time", dim + 1, dim + 2, &m->file, &m->rows, &columns, &read));
  PetscCall(PetscCalloc1(TABLE_ROW * m->rows, &m->table));
  for (PetscInt k = 0; k < m->rows; k++) {
    PetscReal *row = m->table + TABLE_ROW * k;

    for (PetscInt c = 0; c <= dim; c++) row[c] = read[columns * k + c];
    if (columns == dim + 2) row[TABLE_ROW - 1] = DEGREE * read[columns * k + dim + 1];
  }
  PetscCall(PetscFree(read));
  for (PetscInt k = 0; k < m->rows; k++)
    PetscCheckUser(!DomainIsRadial(body->domain, 0) ||
                     (m->table[TABLE_ROW * k + 1] == 0 && m->table[TABLE_ROW * (k + 1) - 1] == 0),
                   body->domain->comm,
                   "-%smotion_file %s: with -dimension axisymmetric a solid can move along the axis only, so x and "
                   "the angle must be 0",
                   body->prefix, m->file.path);
  PetscCall(CheckTable(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MotionDestroy(Body body)
{
  PetscFunctionBegin;
  if (body->motion) PetscCall(PetscFree(body->motion->table));
  PetscCall(PetscFree(body->free));
  PetscCall(PetscFree(body->motion));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void MotionSetTime(Body body, PetscReal time)
{
  struct _p_Motion *m = body->motion;

  Pose(body, time, m->shift, m->turn);
  for (PetscInt d = 0; d < DIM; d++) body->middle[d] = m->center[d] + m->shift[d];
  if (body->free) FreeSetTime(body, m->shift, m->turn);
}

static PetscErrorCode MotionSetUp(Body body)
{
  Domain            domain = body->domain;
  struct _p_Motion *m      = body->motion;
  PetscBool         centered;

  PetscFunctionBegin;
  m->w     = 2 * PETSC_PI * m->frequency;
  m->phase = DEGREE * m->phase_degrees;
  PetscCall(PetscArraycpy(m->center, m->center_given, DIM));
  PetscCall(PetscOptionsHasName(NULL, body->prefix, "-rotation_center", &centered));
  PetscCall(RateCheck(domain, body->prefix, &m->rate_given, m->rate));
  if (domain->dim == 2 || Norm(m->axis) == 0) {
    m->axis[0] = m->axis[1] = 0;
    m->axis[2]              = 1;
  }
  PetscCall(ShareTable(body));
  for (PetscInt k = 0; k < m->rows; k++)
    PetscCheckUser(
      Norm(m->rate) == 0 || m->table[TABLE_ROW * (k + 1) - 1] == 0, domain->comm,
      "-%srotation_rate and angles in -%smotion_file cannot be used together: the table must have them all",
      body->prefix, body->prefix);
  PetscCheckUser(Norm(m->amplitude) == 0 || m->w > 0, domain->comm,
                 "-%soscillation_amplitude needs -%soscillation_frequency, in Hz", body->prefix, body->prefix);
  PetscCheckUser(!DomainIsRadial(domain, 0) || (m->velocity[0] == 0 && m->amplitude[0] == 0 && Norm(m->rate) == 0),
                 domain->comm,
                 "with -dimension axisymmetric the solid %s can move along the axis only and cannot rotate",
                 body->name);
  PetscCheckUser(
    BodyMass(body) == 0 || (Norm(m->amplitude) == 0 && m->rows == 0), domain->comm,
    "-%smass cannot be used with -%soscillation_amplitude or -%smotion_file: a free body has no prescribed "
    "motion",
    body->prefix, body->prefix, body->prefix);
  PetscCall(FreeSetUp(body, centered, m->center, m->velocity, m->rate));
  if (!body->free && Norm(m->velocity) == 0 && Norm(m->amplitude) == 0 && Norm(m->rate) == 0 && m->rows == 0)
    PetscCall(MotionDestroy(body));
  else
    MotionSetTime(body, 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x = c + s + R (y - c): where the point is that was at y at the time 0. */
static void Forth(const struct _p_Motion *m, const PetscReal shift[DIM], PetscReal turn[DIM][DIM],
                  const PetscReal y[DIM], PetscReal x[DIM])
{
  for (PetscInt i = 0; i < DIM; i++) {
    x[i] = m->center[i] + shift[i];
    for (PetscInt j = 0; j < DIM; j++) x[i] += turn[i][j] * (y[j] - m->center[j]);
  }
}

static void MotionForth(Body body, PetscReal x[DIM])
{
  const PetscReal y[DIM] = {x[0], x[1], x[2]};

  Forth(body->motion, body->motion->shift, body->motion->turn, y, x);
}

static void MotionBack(Body body, const PetscReal x[DIM], PetscReal y[DIM])
{
  Back(body->motion, body->motion->shift, body->motion->turn, x, y);
}

/* Of a table: for each of its numbers the rows where it is least and largest, and the middle of its fastest step. */
static void MotionMoments(Body body, Moments *moments)
{
  const struct _p_Motion *m = body->motion;

  if (body->free) return;
  MomentAdd(moments, moments->start);
  MomentAdd(moments, moments->end);
  MomentPeriod(moments, Norm(m->amplitude) > 0 ? m->frequency : 0, moments->start);
  MomentPeriod(moments, Norm(m->rate) / (2 * PETSC_PI), moments->start);
  for (PetscInt d = 1; d <= MOVES && m->rows; d++) {
    PetscInt  least = 0, most = 0, fast = 0;
    PetscReal fastest = 0;

    MomentTable(moments, m->table, m->rows, TABLE_ROW, d);
    for (PetscInt k = 0; k < m->rows; k++) {
      const PetscReal *row = m->table + TABLE_ROW * k, *next = row + TABLE_ROW,
                      rate = k < m->rows - 1 ? PetscAbsReal(next[d] - row[d]) / (next[0] - row[0]) : 0;

      if (row[d] < m->table[TABLE_ROW * least + d]) least = k;
      if (row[d] > m->table[TABLE_ROW * most + d]) most = k;
      if (rate > fastest) {
        fastest = rate;
        fast    = k;
      }
    }
    if (fastest == 0) continue;
    MomentAdd(moments, m->table[TABLE_ROW * least]);
    MomentAdd(moments, m->table[TABLE_ROW * most]);
    MomentAdd(moments, 0.5 * (m->table[TABLE_ROW * fast] + m->table[TABLE_ROW * (fast + 1)]));
  }
}

static PetscErrorCode MotionView(Body body, PetscBool tension, PetscViewer viewer)
{
  const struct _p_Motion *m   = body->motion;
  const PetscInt          dim = body->domain->dim;
  char                    text[4][VECTOR_TEXT];

  PetscFunctionBegin;
  if (body->free) {
    PetscCall(FreeView(body, viewer));
    if (tension)
      PetscCall(PetscViewerASCIIPrintf(viewer,
                                       "  warning: the force of surface tension on %s at its contact lines is not "
                                       "computed; in a plane it is up to 2 sigma, which must be small against the "
                                       "weight\n",
                                       body->name));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscViewerASCIIPushTab(viewer));
  PetscCall(PetscViewerASCIIPrintf(
    viewer, "moves: velocity %s m/s, oscillation %s m at %g Hz, rotation %s rad/s about %s m%s%s\n",
    VectorText(dim, m->velocity, text[0]), VectorText(dim, m->amplitude, text[1]), (double)(m->w / (2 * PETSC_PI)),
    AxesText(dim, m->rate, text[2]), VectorText(dim, m->center, text[3]), m->rows ? ", as in " : "", m->file.path));
  PetscCall(PetscViewerASCIIPopTab(viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Unset numbers are zero, so the bytes before 'rows' can be compared; the name of the file stands for the table. */
PetscBool BodyMovesAs(Body solid, Body other)
{
  if (!solid->motion || !other->motion || solid->free || other->free)
    return (PetscBool)(solid->motion == other->motion);
  return (PetscBool)!memcmp(solid->motion, other->motion, offsetof(struct _p_Motion, rows));
}

void BodyMove(Body solid, PetscReal from, PetscReal to, PetscReal x[DIM])
{
  const struct _p_Motion *m = solid->motion;
  PetscReal               shift[DIM], turn[DIM][DIM], y[DIM];

  Pose(solid, from, shift, turn);
  Back(m, shift, turn, x, y);
  Pose(solid, to, shift, turn);
  Forth(m, shift, turn, y, x);
}

static void MotionVelocity(Body solid, PetscReal time, const PetscReal x[DIM], PetscReal v[DIM])
{
  const struct _p_Motion *m = solid->motion;
  PetscReal               shift[DIM], turn[DIM][DIM], rate[DIM], r[DIM], turned[DIM];

  if (solid->free) {
    FreePose(solid, time, shift, turn);
    FreeVelocity(solid, v, rate);
  } else
    Prescribed(m, time, shift, turn, v, rate);
  for (PetscInt d = 0; d < DIM; d++) r[d] = x[d] - m->center[d] - shift[d];
  Cross(rate, r, turned);
  for (PetscInt d = 0; d < DIM; d++) v[d] += turned[d];
}

/* The largest speed (m/s) of the table with an arm (m), from samples. */
static PetscReal TableSpeed(const struct _p_Motion *m, PetscReal arm)
{
  PetscReal speed = 0;

  for (PetscInt k = 0; k < TABLE_SAMPLES * (m->rows - 1); k++) {
    const PetscReal *row  = m->table + TABLE_ROW * (k / TABLE_SAMPLES);
    const PetscReal  time = row[0] + (row[TABLE_ROW] - row[0]) * ((PetscReal)(k % TABLE_SAMPLES) + 0.5) / TABLE_SAMPLES;
    PetscReal        move[MOVES], rate[MOVES];

    Table(m, time, move, rate);
    speed = PetscMax(speed, Norm(rate) + (rate[DIM] != 0 ? PetscAbsReal(rate[DIM]) * arm : 0));
  }
  return speed;
}

/* The speed (m/s) of the end of an arm (m). Without rotation the arm may be infinite. */
static PetscReal TurningSpeed(const PetscReal rate[DIM], const PetscReal arm[DIM])
{
  return Norm(rate) > 0 ? Norm(rate) * Norm(arm) : 0;
}

/* Adds the speeds of velocity, oscillation, rotation at the farthest corner, and table. */
static PetscReal MotionSpeed(Body body, const PetscReal lower[DIM], const PetscReal upper[DIM])
{
  const struct _p_Motion *m        = body->motion;
  PetscReal               arm[DIM] = {0, 0, 0}, velocity[DIM], rate[DIM];

  for (PetscInt d = 0; d < body->domain->dim; d++)
    arm[d] = PetscMax(PetscAbsReal(lower[d] - m->center[d]), PetscAbsReal(upper[d] - m->center[d]));
  if (body->free) {
    FreeVelocity(body, velocity, rate);
    return Norm(velocity) + TurningSpeed(rate, arm);
  }
  return Norm(m->velocity) + m->w * Norm(m->amplitude) + TurningSpeed(m->rate, arm) + TableSpeed(m, Norm(arm));
}

static void MotionJson(Body body, Json *json)
{
  JsonBool(json, "free", (PetscBool)(body->free != NULL));
  JsonBool(json, "driven", (PetscBool)(body->motion && !body->free));
}

const MotionOps SolidMotion = {.rows     = {MotionOptions, FreeOptions},
                               .data     = {offsetof(struct _p_Body, motion), offsetof(struct _p_Body, free)},
                               .read     = MotionSetFromOptions,
                               .setup    = MotionSetUp,
                               .destroy  = MotionDestroy,
                               .json     = MotionJson,
                               .check    = FreeCheck,
                               .view     = MotionView,
                               .move     = MotionSetTime,
                               .back     = MotionBack,
                               .forth    = MotionForth,
                               .velocity = MotionVelocity,
                               .speed    = MotionSpeed,
                               .moments  = MotionMoments};
