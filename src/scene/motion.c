/* Motion of solids: where a solid is at each time, as a function of the time alone, so that a run that is continued has
   it where it was; free solids, whose motion a checkpoint holds, are in free.c. At the time 0 it is where its shape
   says:

     x(t) = c + s(t) + R(t) (X - c),  s(t) = velocity t + amplitude (sin(w t + phase) - sin(phase)) + table(t),

   X the place at the time 0, c the centre of the rotation, R(t) the rotation by the angle |rate| t about the direction
   of the rate. The table is a file of lines t, x, y (and z): a curve through its points, straight up to its first and
   from its last one on, of which the solid leaves the first and reaches the last from rest and to rest. */
#include "scene_impl.h"
#include <ctype.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define DEGREE      (PETSC_PI / 180)
#define LINE_LENGTH 4096
#define NUMBER_MOST (PETSC_MAX_REAL / 4) /* in a table, so that differences are finite */
#define BYTE_ORDER  "\xef\xbb\xbf"       /* the mark that some programs put before the text of a file */
#define SAMPLES     16                   /* between two rows of a table, of its speed */

struct _p_Motion {
  PetscReal  velocity[DIM];              /* m/s */
  PetscReal  amplitude[DIM], w, phase;   /* m, rad/s, rad */
  PetscReal  rate[DIM + 1], center[DIM]; /* rad/s; m; one number more, to notice too many */
  PetscInt   rates;                      /* numbers given */
  char       file[PETSC_MAX_PATH_LEN];   /* of the table; empty: none */
  PetscReal  shift[DIM], turn[DIM][DIM]; /* s and R at the time set last */
  PetscBool  centered;                   /* the centre was given */
  PetscInt   rows;                       /* of the table */
  PetscReal *table;                      /* [rows][1 + 3]: time (s), displacement (m) */
};

/* The displacement (m) of a row of the table, and its rate (m/s): that from the row before to the row after, 0 at the
   ends. */
static void Row(const struct _p_Motion *m, PetscInt k, PetscReal place[DIM], PetscReal rate[DIM])
{
  const PetscReal *row = m->table + (DIM + 1) * k;

  for (PetscInt d = 0; d < DIM; d++) {
    place[d] = row[1 + d];
    rate[d]  = k == 0 || k == m->rows - 1 ? 0 : (row[DIM + 2 + d] - row[d - DIM]) / (row[DIM + 1] - row[-(DIM + 1)]);
  }
}

/* Adds the table's displacement (m) and its rate (m/s) at the time: cubic between its rows. */
static void AddTable(const struct _p_Motion *m, PetscReal time, PetscReal shift[DIM], PetscReal rate[DIM])
{
  PetscInt  k = 0, last = m->rows - 1;
  PetscReal a[DIM], b[DIM], va[DIM], vb[DIM], length, u;

  if (m->rows == 0) return;
  while (last - k > 1) {
    const PetscInt middle = (k + last) / 2;

    if (m->table[(DIM + 1) * middle] <= time)
      k = middle;
    else
      last = middle;
  }
  Row(m, k, a, va);
  Row(m, k + 1, b, vb);
  length = m->table[(DIM + 1) * (k + 1)] - m->table[(DIM + 1) * k];
  u      = (time - m->table[(DIM + 1) * k]) / length;
  if (u < 0 || u > 1) { /* before the first or after the last row */
    for (PetscInt d = 0; d < DIM; d++) shift[d] += u < 0 ? a[d] : b[d];
    return;
  }
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal way = b[d] - a[d], bend = length * (va[d] + vb[d]) - 2 * way,
                    lift = 3 * way - length * (2 * va[d] + vb[d]);

    shift[d] += a[d] + u * (length * va[d] + u * (lift + u * bend));
    if (rate) rate[d] += va[d] + u * (2 * lift + 3 * u * bend) / length;
  }
}

/* s (m) and, if wanted, its rate (m/s) at the time (s), of a motion as the options say. */
static void Shift(const struct _p_Motion *m, PetscReal time, PetscReal shift[DIM], PetscReal rate[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) {
    shift[d] =
      m->velocity[d] * time + m->amplitude[d] * (PetscSinReal(m->w * time + m->phase) - PetscSinReal(m->phase));
    if (rate) rate[d] = m->velocity[d] + m->amplitude[d] * m->w * PetscCosReal(m->w * time + m->phase);
  }
  AddTable(m, time, shift, rate);
}

/* s and R of a solid at the time. */
static void Place(Body body, PetscReal time, PetscReal shift[DIM], PetscReal turn[DIM][DIM])
{
  if (body->free)
    FreePlace(body, time, shift, turn);
  else {
    Shift(body->motion, time, shift, NULL);
    RotationMatrix(body->motion->rate, time, turn);
  }
}

/* y = c + R^T (x - c - s): the place at the time 0 of the point that is at x. */
static void Back(const struct _p_Motion *m, const PetscReal shift[DIM], const PetscReal turn[DIM][DIM],
                 const PetscReal x[DIM], PetscReal y[DIM])
{
  for (PetscInt i = 0; i < DIM; i++) {
    y[i] = m->center[i];
    for (PetscInt j = 0; j < DIM; j++) y[i] += turn[j][i] * (x[j] - m->center[j] - shift[j]);
  }
}

PetscErrorCode MotionSetFromOptions(Body body, OptionItems PetscOptionsObject)
{
  Domain            domain = body->domain;
  struct _p_Motion *m;
  PetscReal         frequency = 0, phase = 0;

  PetscFunctionBegin;
  PetscCall(PetscNew(&m));
  body->motion = m;
  PetscCall(DomainOptionsVector(domain, PetscOptionsObject, VECTOR_DIRECTION, "-velocity",
                                "Velocity with which the solid moves (m/s)", "SceneSetFromOptions", m->velocity, NULL));
  PetscCall(DomainOptionsVector(domain, PetscOptionsObject, VECTOR_DIRECTION, "-oscillation_amplitude",
                                "Amplitude a of a motion a (sin(2 pi f t + phase) - sin(phase)) (m)",
                                "SceneSetFromOptions", m->amplitude, NULL));
  PetscCall(OptionReal("-oscillation_frequency", "Frequency f of that motion (Hz)", "[0, inf)", &frequency));
  PetscCall(OptionReal("-oscillation_phase", "Phase of that motion (degrees); -90: it starts from rest", "[-360, 360]",
                       &phase));
  m->rates = DIM + 1;
  PetscCall(PetscOptionsRealArray("-rotation_rate",
                                  "Angular velocity of the solid about an axis of this direction; in two dimensions "
                                  "one number will do (rad/s)",
                                  "SceneSetFromOptions", m->rate, &m->rates, NULL));
  PetscCall(
    DomainOptionsVector(domain, PetscOptionsObject, VECTOR_POINT, "-rotation_center",
                        "Point on that axis (m), which moves with the solid; of a solid of a mass its centre, by "
                        "default that of its shape",
                        "SceneSetFromOptions", m->center, &m->centered));
  PetscCall(PetscOptionsString("-motion_file",
                               "File of lines t,x,y or t,x,y,z: how far the solid is from its place (m) at rising "
                               "times (s); a smooth curve between them",
                               "SceneSetFromOptions", m->file, m->file, sizeof(m->file), NULL));
  m->w     = 2 * PETSC_PI * frequency;
  m->phase = DEGREE * phase;
  PetscCall(FreeSetFromOptions(body, PetscOptionsObject));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode RateCheck(Domain domain, const char prefix[], PetscInt count, PetscReal rate[DIM + 1])
{
  const PetscBool flat = (PetscBool)(domain->dim == 2);

  PetscFunctionBegin;
  PetscCheckUser(count == 0 || count == DIM || (flat && count == 1), domain->comm, "-%srotation_rate must have %s",
                 prefix, flat ? "one number, or three of which the first two are 0" : "three numbers");
  if (count == 1) {
    rate[2] = rate[0];
    rate[0] = 0;
  }
  PetscCheckUser(!PetscIsInfOrNanReal(rate[0] + rate[1] + rate[2]), domain->comm,
                 "-%srotation_rate must have finite numbers", prefix);
  PetscCheckUser(!flat || (rate[0] == 0 && rate[1] == 0), domain->comm,
                 "-%srotation_rate must be about z in two dimensions: its first two numbers must be 0", prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What a line of a table's file can be, if it has no numbers. */
enum {
  LINE_BAD   = -1, /* numbers, but not only, too many, or none that are finite */
  LINE_NAMES = -2  /* words only, of which the first begins with a letter, quoted or not */
};

/* Reads the numbers of a line; returns how many there are, or what the line is instead. */
static int ReadLine(char line[], PetscReal number[DIM + 2])
{
  int       count = 0, others = 0;
  PetscBool named = PETSC_FALSE;
  char     *rest;

  for (char *word = strtok_r(line, ", \t\r\n", &rest); word; word = strtok_r(NULL, ", \t\r\n", &rest)) {
    char     *end;
    PetscReal value;

    word += *word == '"' || *word == '\'';
    value = (PetscReal)strtod(word, &end);
    if (count + others == 0) named = (PetscBool)(isalpha((unsigned char)*word) != 0);
    if (end == word || (*end && isalpha((unsigned char)*word))) { /* as in "information" */
      others++;
      continue;
    }
    if (*end || !(PetscAbsReal(value) < NUMBER_MOST) || count == DIM + 2) return LINE_BAD;
    number[count++] = value;
  }
  return others == 0 ? count : named && count == 0 ? LINE_NAMES : LINE_BAD;
}

/* Rank 0: reads the table; *bad: the line that is none of a table, -1: no such file. Passed over are blank lines,
   comments (#), names of the columns in the first line that is neither, and a mark of the byte order before all. */
static PetscErrorCode ReadTable(struct _p_Motion *m, PetscInt dim, int *bad)
{
  PetscSegBuffer rows;
  FILE          *file = NULL;
  struct stat    info;
  char           line[LINE_LENGTH];
  PetscReal      before = -PETSC_MAX_REAL;
  PetscBool      first  = PETSC_TRUE;

  PetscFunctionBegin;
  *bad = -1;
  if (stat(m->file, &info) || !S_ISREG(info.st_mode) || !(file = fopen(m->file, "r")))
    PetscFunctionReturn(PETSC_SUCCESS);
  *bad = 0;
  PetscCall(PetscSegBufferCreate((DIM + 1) * sizeof(PetscReal), 64, &rows));
  for (int n = 1; !*bad && fgets(line, sizeof(line), file); n++) {
    const PetscBool whole = (PetscBool)(strchr(line, '\n') || feof(file)); /* neither too long nor with a zero in it */
    char           *text  = line;
    PetscReal       number[DIM + 2] = {0}, *row;
    int             count;

    if (n == 1 && !strncmp(text, BYTE_ORDER, strlen(BYTE_ORDER))) text += strlen(BYTE_ORDER);
    text += strspn(text, " \t");
    count = !whole ? LINE_BAD : *text == '#' ? 0 : ReadLine(text, number);
    if (count == 0) continue;
    if (first && count == LINE_NAMES) {
      first = PETSC_FALSE;
      continue;
    }
    first = PETSC_FALSE;
    if (count != dim + 1 || number[0] <= before) *bad = n;
    before = number[0];
    PetscCall(PetscSegBufferGet(rows, 1, &row));
    for (PetscInt k = 0; k <= DIM; k++) row[k] = number[k];
    m->rows++;
  }
  (void)fclose(file);
  PetscCall(PetscSegBufferExtractAlloc(rows, &m->table));
  PetscCall(PetscSegBufferDestroy(&rows));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses a table that moves the solid faster between two rows than any solid may be; the same on all ranks. */
static PetscErrorCode CheckTable(Body body)
{
  const struct _p_Motion *m = body->motion;

  PetscFunctionBegin;
  for (PetscInt k = 0; k + 1 < m->rows; k++) {
    const PetscReal *a = m->table + (DIM + 1) * k, *b = a + DIM + 1, way[DIM] = {b[1] - a[1], b[2] - a[2], b[3] - a[3]},
                    speed = Norm(way) / (b[0] - a[0]);

    PetscCheckUser(speed <= SPEED_MOST, body->domain->comm,
                   "-%smotion_file %s: between the times %g and %g s the solid moves by %g m, with %g m/s; at most %g "
                   "m/s are allowed",
                   body->prefix, m->file, (double)a[0], (double)b[0], (double)Norm(way), (double)speed, SPEED_MOST);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads the table on rank 0, for all. */
static PetscErrorCode ShareTable(Body body)
{
  struct _p_Motion *m    = body->motion;
  MPI_Comm          comm = body->domain->comm;
  PetscMPIInt       rank;
  int               bad = 0;

  PetscFunctionBegin;
  if (!m->file[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (!rank) PetscCall(ReadTable(m, body->domain->dim, &bad));
  PetscCallMPI(MPI_Bcast(&bad, 1, MPI_INT, 0, comm));
  PetscCallMPI(MPI_Bcast(&m->rows, 1, MPIU_INT, 0, comm));
  PetscCheckUser(bad >= 0, comm, "-%smotion_file %s cannot be read, or is no regular file", body->prefix, m->file);
  PetscCheckUser(bad == 0, comm,
                 "-%smotion_file %s, line %d: a line must have %d finite numbers, %s, and a later time than the line "
                 "before; the first may have the names of these columns",
                 body->prefix, m->file, bad, (int)body->domain->dim + 1, body->domain->dim == 2 ? "t,x,y" : "t,x,y,z");
  PetscCheckUser(m->rows >= 2, comm, "-%smotion_file %s must have two lines or more", body->prefix, m->file);
  if (rank) PetscCall(PetscMalloc1((DIM + 1) * m->rows, &m->table));
  PetscCallMPI(MPI_Bcast(m->table, (PetscMPIInt)((DIM + 1) * m->rows), MPIU_REAL, 0, comm));
  for (PetscInt k = 0; k < m->rows; k++)
    PetscCheckUser(!body->domain->rings || m->table[(DIM + 1) * k + 1] == 0, comm,
                   "-%smotion_file %s: with -dimension axisymmetric x must be 0: a solid can move along the axis only",
                   body->prefix, m->file);
  PetscCall(CheckTable(body));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MotionDestroy(Body body)
{
  PetscFunctionBegin;
  if (body->motion) PetscCall(PetscFree(body->motion->table));
  PetscCall(PetscFree(body->free));
  PetscCall(PetscFree(body->motion));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MotionSetUp(Body body)
{
  Domain            domain = body->domain;
  struct _p_Motion *m      = body->motion;

  PetscFunctionBegin;
  PetscCall(RateCheck(domain, body->prefix, m->rates, m->rate));
  PetscCall(ShareTable(body));
  PetscCheckUser(Norm(m->amplitude) == 0 || m->w > 0, domain->comm,
                 "-%soscillation_amplitude needs -%soscillation_frequency, in Hz", body->prefix, body->prefix);
  PetscCheckUser(!domain->rings || (m->velocity[0] == 0 && m->amplitude[0] == 0 && Norm(m->rate) == 0), domain->comm,
                 "with -dimension axisymmetric the solid %s can move along the axis only, and not turn", body->name);
  PetscCheckUser(BodyMass(body) == 0 || (Norm(m->amplitude) == 0 && m->rows == 0), domain->comm,
                 "-%smass: a solid that moves freely cannot have -%soscillation_amplitude or -%smotion_file too",
                 body->prefix, body->prefix, body->prefix);
  PetscCall(FreeSetUp(body, m->centered, m->center, m->velocity, m->rate));
  if (!body->free && Norm(m->velocity) == 0 && Norm(m->amplitude) == 0 && Norm(m->rate) == 0 && m->rows == 0)
    PetscCall(MotionDestroy(body));
  else
    MotionSetTime(body, 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MotionSetTime(Body body, PetscReal time)
{
  struct _p_Motion *m = body->motion;

  if (!m) return;
  Place(body, time, m->shift, m->turn);
  if (body->free) FreeSetTime(body, m->shift, m->turn);
}

void MotionBack(Body body, const PetscReal x[DIM], PetscReal y[DIM])
{
  Back(body->motion, body->motion->shift, body->motion->turn, x, y);
}

PetscErrorCode MotionView(Body body, PetscViewer viewer)
{
  const struct _p_Motion *m = body->motion;

  PetscFunctionBegin;
  if (body->free) PetscCall(FreeView(body, viewer));
  if (!m || body->free) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscViewerASCIIPushTab(viewer));
  PetscCall(PetscViewerASCIIPrintf(viewer,
                                   "moves: velocity %g, %g, %g m/s, oscillation %g, %g, %g m at %g Hz, rotation %g, "
                                   "%g, %g rad/s about %g, %g, %g m%s%s\n",
                                   (double)m->velocity[0], (double)m->velocity[1], (double)m->velocity[2],
                                   (double)m->amplitude[0], (double)m->amplitude[1], (double)m->amplitude[2],
                                   (double)(m->w / (2 * PETSC_PI)), (double)m->rate[0], (double)m->rate[1],
                                   (double)m->rate[2], (double)m->center[0], (double)m->center[1], (double)m->center[2],
                                   m->rows ? ", as in " : "", m->file));
  PetscCall(PetscViewerASCIIPopTab(viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool BodyMoves(Body solid)
{
  return (PetscBool)(solid->motion != NULL);
}

/* Motions start as zeros, and are compared up to their table, whose file has a name. */
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

  Place(solid, from, shift, turn);
  Back(m, shift, turn, x, y);
  Place(solid, to, shift, turn);
  for (PetscInt i = 0; i < DIM; i++) {
    x[i] = m->center[i] + shift[i];
    for (PetscInt j = 0; j < DIM; j++) x[i] += turn[i][j] * (y[j] - m->center[j]);
  }
}

void BodyMotion(Body solid, PetscReal time, const PetscReal x[DIM], PetscReal v[DIM])
{
  const struct _p_Motion *m = solid->motion;
  PetscReal               shift[DIM], turn[DIM][DIM], rate[DIM], r[DIM], turned[DIM];

  for (PetscInt d = 0; d < DIM; d++) v[d] = 0;
  if (!m) return;
  for (PetscInt d = 0; d < DIM; d++) rate[d] = m->rate[d];
  if (solid->free) {
    FreePlace(solid, time, shift, turn);
    FreeVelocity(solid, v, rate);
  } else
    Shift(m, time, shift, v);
  for (PetscInt d = 0; d < DIM; d++) r[d] = x[d] - m->center[d] - shift[d];
  Cross(rate, r, turned);
  for (PetscInt d = 0; d < DIM; d++) v[d] += turned[d];
}

PetscBool SceneSolidsMove(Scene scene)
{
  for (PetscInt b = 0; b < scene->solids; b++)
    if (BodyMoves(scene->solid[b])) return PETSC_TRUE;
  return PETSC_FALSE;
}

void SceneMoveSolids(Scene scene, PetscReal time)
{
  scene->solid_time = time;
  for (PetscInt b = 0; b < scene->solids; b++) MotionSetTime(scene->solid[b], time);
}

void SceneSolidsAtStart(Scene scene)
{
  SceneMoveSolids(scene, 0);
  for (PetscInt b = 0; b < scene->solids; b++) {
    struct _p_Motion *m = scene->solid[b]->motion;

    for (PetscInt i = 0; i < DIM && scene->solid[b]->free; i++) {
      m->shift[i] = 0;
      for (PetscInt j = 0; j < DIM; j++) m->turn[i][j] = i == j;
    }
  }
}

PetscReal SceneSolidTime(Scene scene)
{
  return scene->solid_time;
}

/* The largest speed of the table, at samples. */
static PetscReal TableSpeed(const struct _p_Motion *m)
{
  PetscReal speed = 0;

  for (PetscInt k = 0; k < SAMPLES * (m->rows - 1); k++) {
    const PetscReal *row        = m->table + (DIM + 1) * (k / SAMPLES);
    const PetscReal  time       = row[0] + (row[DIM + 1] - row[0]) * ((PetscReal)(k % SAMPLES) + 0.5) / SAMPLES;
    PetscReal        shift[DIM] = {0, 0, 0}, rate[DIM] = {0, 0, 0};

    AddTable(m, time, shift, rate);
    speed = PetscMax(speed, Norm(rate));
  }
  return speed;
}

/* Of a point at the end of the arm, which may be beyond all numbers where nothing turns. */
static PetscReal TurningSpeed(const PetscReal rate[DIM], const PetscReal arm[DIM])
{
  return Norm(rate) > 0 ? Norm(rate) * Norm(arm) : 0;
}

/* The velocity, the largest of the oscillation, and the rate times the distance of the farthest corner. */
PetscReal MotionSpeed(Body body, const PetscReal lower[DIM], const PetscReal upper[DIM])
{
  const struct _p_Motion *m        = body->motion;
  PetscReal               arm[DIM] = {0, 0, 0}, velocity[DIM], rate[DIM];

  if (!m) return 0;
  for (PetscInt d = 0; d < body->domain->dim; d++)
    arm[d] = PetscMax(PetscAbsReal(lower[d] - m->center[d]), PetscAbsReal(upper[d] - m->center[d]));
  if (body->free) {
    FreeVelocity(body, velocity, rate);
    return Norm(velocity) + TurningSpeed(rate, arm);
  }
  return Norm(m->velocity) + m->w * Norm(m->amplitude) + TurningSpeed(m->rate, arm) + TableSpeed(m);
}
