/* The capillary pressure of the curvature model on disordered particles of known shapes, on what is too small to have a
   curvature, and at walls; the Cahn-Hilliard force. Lengths in spacings, tension 1. Runs on any number of ranks. */
#include "setup.h"
#include "check.h"
#include "../../src/lines/lines.h"
#include "../../src/tension/tension_impl.h"

#define MAX_POINTS 16000
#define BALL       "-s_shape sphere -s_radius "
#define RADII      5   /* around 16 spacings: where a lattice ends at a wall is chance */
#define JITTER     0.1 /* of each coordinate, spacings */
#define OPEN       "-spacing 1 -box_lower -24,-24,-24 -box_upper 24,24,24 -bodies a -a_tension 1 "
#define PHASES     "-tension_type cahn_hilliard "
#define OPEN_2D    "-dimension 2 -spacing 1 -box_lower -36,-36 -box_upper 36,36 -bodies a -a_tension 1 "
#define LONG       "-spacing 1 -box_lower -24,-24,0 -box_upper 24,24,12 -box_z periodic -bodies a -a_tension 1 "
#define FILM                                                                                                           \
  "-spacing 1 -box_lower -7,-7,-20 -box_upper 7,7,20 -box_x periodic -box_y periodic -bodies a "                       \
  "-a_tension 1 "
#define STRIP "-spacing 1 -box_lower -24,-7,-20 -box_upper 24,7,20 -box_y periodic -bodies a -a_tension 1 "
#define OCTANT                                                                                                         \
  "-spacing 1 -box_lower 0,0,0 -box_upper 24,24,24 -box_xmin symmetry -box_ymin symmetry -box_zmin symmetry -bodies "  \
  "a -a_tension 1 "
#define FLOOR "-dimension 2 -spacing 1 -box_lower -40,0 -box_upper 40,40 -box_ymin wall -bodies a -a_tension 1 "
#define SOLID                                                                                                          \
  "-dimension 2 -spacing 1 -box_lower -40,-40 -box_upper 40,40 -bodies a -a_tension 1 -solids s -s_contact_angle "
#define POOL                                                                                                           \
  "-dimension 2 -spacing 1 -box_lower -10,0 -box_upper 10,60 -box_x periodic -box_ymin wall -bodies a -a_tension 1 "

#define PRINTED "-a_density 1 -tension_type cahn_hilliard -tension_ratio 2.5 -tension_calibration 4 "

static PetscReal points[DIM * MAX_POINTS];

/* A shape: whether a point belongs to it; its numbers. */
typedef PetscBool (*Inside)(const PetscReal x[DIM], const PetscReal number[]);

static PetscBool InShell(const PetscReal x[DIM], const PetscReal number[])
{
  return (PetscBool)(Norm(x) >= number[0] && Norm(x) < number[1]);
}

static PetscBool InTube(const PetscReal x[DIM], const PetscReal number[])
{
  return (PetscBool)(x[0] * x[0] + x[1] * x[1] < number[0] * number[0]);
}

static PetscBool InSlab(const PetscReal x[DIM], const PetscReal number[])
{
  return (PetscBool)(PetscAbsReal(x[2]) < 0.5 * number[0]);
}

/* Near the floor. */
static PetscBool InFoot(const PetscReal x[DIM], const PetscReal number[])
{
  (void)number;
  return (PetscBool)(x[1] < 5);
}

static PetscBool InPair(const PetscReal x[DIM], const PetscReal number[])
{
  const PetscReal r[DIM] = {PetscAbsReal(x[0]) - number[0], x[1], x[2]};

  return (PetscBool)(Norm(r) < number[1]);
}

static PetscBool InCap(const PetscReal x[DIM], const PetscReal number[])
{
  const PetscReal r[DIM] = {x[0], x[1] + number[0] * PetscCosReal(number[1] * PETSC_PI / 180), 0};

  return (PetscBool)(Norm(r) < number[0]);
}

/* The same on a plane at 45 degrees to the lattice, and on a circle of radius number[0] about the origin. */
static PetscBool InSlopedCap(const PetscReal x[DIM], const PetscReal number[])
{
  const PetscReal turned[DIM] = {(x[0] + x[1]) / PetscSqrtReal(2), (x[1] - x[0] - 0.5) / PetscSqrtReal(2), 0};

  return (PetscBool)(turned[1] > 0 && InCap(turned, number));
}

static PetscBool InSlopedFoot(const PetscReal x[DIM], const PetscReal number[])
{
  (void)number;
  return (PetscBool)(x[1] - x[0] < 5 * PetscSqrtReal(2));
}

static PetscBool InRoundCap(const PetscReal x[DIM], const PetscReal number[])
{
  const PetscReal R = number[0], ball = number[2], angle = number[1] * PETSC_PI / 180,
                  away   = PetscSqrtReal(R * R + ball * ball - 2 * R * ball * PetscCosReal(angle)),
                  r[DIM] = {x[0], x[1] - away, 0};

  return (PetscBool)(Norm(x) > ball && Norm(r) < R);
}

static PetscBool InRoundFoot(const PetscReal x[DIM], const PetscReal number[])
{
  return (PetscBool)(Norm(x) < number[2] + 5);
}

/* The points of a lattice with cells centered at (i + 1/2) in a block of n[d] cells a direction about 'middle' that are
   inside, each moved by up to 'jitter' a component, the mirror image in x, y or z by the mirrored vector. Returns their
   number. */
static PetscInt Fill(Inside inside, const PetscReal number[], const PetscInt n[DIM], const PetscReal middle[DIM],
                     PetscReal jitter)
{
  PetscInt count = 0;

  for (PetscInt k = 0; k < n[2]; k++)
    for (PetscInt j = 0; j < n[1]; j++)
      for (PetscInt i = 0; i < n[0]; i++) {
        const PetscInt index[DIM] = {i, j, k};
        PetscReal      x[DIM];

        for (PetscInt d = 0; d < DIM; d++) x[d] = n[d] > 1 ? middle[d] + index[d] - 0.5 * (n[d] - 1) : middle[d];
        if (!inside(x, number) || count == MAX_POINTS) continue;
        for (PetscInt d = 0; d < DIM; d++) {
          const PetscInt  key   = (PetscInt)(1e6 * PetscAbsReal(x[2]) + 1e3 * PetscAbsReal(x[1]) + PetscAbsReal(x[0]));
          const PetscReal noise = 2 * RandomUnit(7, (unsigned long long)(DIM * key + d)) - 1;

          points[DIM * count + d] = x[d] + (n[d] > 1 ? jitter * noise * (x[d] < 0 ? -1 : 1) : 0);
        }
        count++;
      }
  return count;
}

/* What the model gives: over the surface particles that 'counts' accepts (NULL: all) number, mean and standard
   deviation; largest size of capillary pressure and slope of all particles, nan if any is. */
typedef struct {
  PetscReal number, mean, deviation, largest;
} Outcome;

static PetscErrorCode Measure(const char options[], PetscInt n, PetscInt layers, Inside counts,
                              const PetscReal number[], Outcome *out)
{
  Setup     s;
  PetscReal sum = 0, square = 0, surface = 0, largest = 0, bad = 0;

  PetscFunctionBegin;
  PetscCall(SetupFill(options, n, points, layers, &s));
  PetscCall(SetupMoments(&s));
  PetscCall(TensionApply(s.tension, s.cloud));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    const PetscReal p = s.cloud->field[FIELD_CAPILLARY][a], *x = s.cloud->field[FIELD_POSITION] + DIM * a;
    const PetscReal slope = Norm(s.cloud->field[FIELD_CAPILLARY_SLOPE] + DIM * a);

    if (PetscIsInfOrNanReal(p) || PetscIsInfOrNanReal(slope)) bad++;
    largest = PetscMax(largest, PetscMax(PetscAbsReal(p), slope));
    if (s.cloud->integer[INT_SURFACE][a] != 1 || (counts && !counts(x, number))) continue;
    surface++;
    sum += p;
    square += p * p;
  }
  PetscCall(SetupClose(&s));
  out->number    = SetupSum(surface);
  out->mean      = SetupSum(sum) / PetscMax(1, out->number);
  out->deviation = PetscSqrtReal(PetscMax(0, SetupSum(square) / PetscMax(1, out->number) - PetscSqr(out->mean)));
  out->largest   = SetupSum(bad) > 0 ? NAN : SetupMax(largest);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const PetscReal origin[DIM] = {0, 0, 0};

/* The radius of a shape is that of its volume: the lattice decides on whole particles. */
static PetscErrorCode TestShapes(void)
{
  const PetscInt cube[DIM] = {30, 30, 30}, square[DIM] = {54, 54, 1}, tube[DIM] = {20, 20, 12},
                 slab[DIM] = {14, 14, 10};
  const PetscReal ball[] = {0, 8}, disc[] = {0, 16}, hole[] = {7, 12}, hollow[] = {16, 26}, wire[] = {8}, thin[] = {2},
                  three[] = {3}, thick[] = {10}, inner[] = {0, 9.5}, around[] = {0, 21};
  Outcome  o;
  PetscInt n;

  PetscFunctionBegin;
  n = Fill(InShell, ball, cube, origin, JITTER);
  PetscCall(Measure(OPEN, n, 0, NULL, NULL, &o));
  CHECK_CLOSE(o.mean * PetscPowReal(0.75 * n / PETSC_PI, 1. / 3) / 2, 1, 0.02, "sphere");
  CHECK_CLOSE(o.deviation / o.mean, 0, 0.1, "sphere_even");
  n = Fill(InShell, disc, square, origin, JITTER);
  PetscCall(Measure(OPEN_2D, n, 0, NULL, NULL, &o));
  CHECK_CLOSE(o.mean * PetscSqrtReal(n / PETSC_PI), 1, 0.03, "circle");
  n = Fill(InTube, wire, tube, (const PetscReal[DIM]){0, 0, 6}, JITTER);
  PetscCall(Measure(LONG, n, 0, NULL, NULL, &o));
  CHECK_CLOSE(o.mean * PetscSqrtReal(n / (12 * PETSC_PI)), 1, 0.02, "cylinder");
  n = Fill(InTube, thin, tube, (const PetscReal[DIM]){0, 0, 6}, JITTER);
  PetscCall(Measure(LONG, n, 0, NULL, NULL, &o));
  CHECK_CLOSE(o.mean * PetscSqrtReal(n / (12 * PETSC_PI)), 1, 0.032, "thread_of_2");
  n = Fill(InTube, three, tube, (const PetscReal[DIM]){0, 0, 6}, JITTER);
  PetscCall(Measure(LONG, n, 0, NULL, NULL, &o));
  CHECK_CLOSE(o.mean * PetscSqrtReal(n / (12 * PETSC_PI)), 1, 0.008, "thread_of_3");
  n = Fill(InSlab, thick, slab, origin, JITTER);
  PetscCall(Measure(FILM, n, 0, NULL, NULL, &o));
  CHECK_CLOSE(o.mean, 0, 0.002, "plane");
  CHECK_CLOSE(o.deviation, 0, 0.02, "plane_even");
  n = Fill(InShell, hole, cube, origin, JITTER);
  PetscCall(Measure(OPEN, n, 0, InShell, inner, &o));
  CHECK_CLOSE(o.mean * 7 / 2, -1, 0.05, "bubble");
  n = Fill(InShell, hollow, square, origin, JITTER);
  PetscCall(Measure(OPEN_2D, n, 0, InShell, around, &o));
  CHECK_CLOSE(o.mean * 16, -1, 0.05, "hollow_circle");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An octant between three mirrors is the whole drop. */
static PetscErrorCode TestMirrors(void)
{
  const PetscInt  cube[DIM] = {18, 18, 18}, half[DIM] = {9, 9, 9};
  const PetscReal ball[] = {0, 8}, middle[DIM] = {4.5, 4.5, 4.5};
  Outcome         whole, part;
  PetscInt        n, octant;

  PetscFunctionBegin;
  n = Fill(InShell, ball, cube, origin, JITTER);
  PetscCall(Measure(OPEN, n, 0, NULL, NULL, &whole));
  octant = Fill(InShell, ball, half, middle, JITTER);
  PetscCall(Measure(OCTANT, octant, 0, NULL, NULL, &part));
  CHECK_CLOSE(8 * octant, n, 0, "octant_particles");
  CHECK_CLOSE(8 * part.number, whole.number, 0, "octant_surface");
  CHECK_CLOSE(part.mean, whole.mean, 1e-12, "octant_mean");
  CHECK_CLOSE(part.deviation, whole.deviation, 1e-10, "octant_deviation");
  CHECK_CLOSE(part.largest, whole.largest, 1e-12, "octant_largest");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Too small, too thin, or touching: the curvature is bounded by (dim - 1)/d0, the pressure never more than the
   sharpening makes of that. */
static PetscErrorCode TestExtremes(void)
{
  const PetscInt one[DIM] = {1, 1, 1}, two[DIM] = {2, 1, 1}, eight[DIM] = {2, 2, 2}, row[DIM] = {12, 1, 1},
                 single[DIM] = {14, 14, 1}, twofold[DIM] = {14, 14, 2}, wide[DIM] = {30, 16, 16};
  const PetscReal any[] = {0, 1000}, touching[] = {6.5, 6.5};
  const PetscInt *block[] = {one, two, eight, row, single, twofold, wide};
  const char     *name[]  = {"one_particle",        "pair",          "cluster_of_8", "row", "sheet",
                             "sheet_of_two_layers", "touching_drops"};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 7; k++) {
    const PetscInt n =
      k < 6 ? Fill(InShell, any, block[k], origin, JITTER) : Fill(InPair, touching, block[k], origin, JITTER);
    Outcome o;

    PetscCall(Measure(k == 4 || k == 5 ? FILM : OPEN, n, 0, NULL, NULL, &o));
    CHECK(o.largest <= 6, name[k]);
    if (k == 0) CHECK_CLOSE(o.largest, 0, 0, "one_particle_none");
    if (k == 4 || k == 5) CHECK_CLOSE(o.mean, 0, 0.02, k == 4 ? "sheet_flat" : "sheet_of_two_layers_flat");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A sheet of one particle is pulled together by twice the tension; the forces of all add up to nothing, jitter or not.
 */
static PetscErrorCode TestSheet(void)
{
  const PetscInt  strip[DIM] = {28, 14, 1};
  const PetscReal any[]      = {0, 1000};

  PetscFunctionBegin;
  for (PetscInt jittered = 0; jittered < 2; jittered++) {
    const PetscInt n    = Fill(InShell, any, strip, origin, jittered ? JITTER : 0);
    PetscReal      half = 0, pressure = 0, sum[DIM] = {0, 0, 0};
    Setup          s;

    PetscCall(SetupFill(STRIP, n, points, 0, &s));
    PetscCall(SetupMoments(&s));
    PetscCall(PetscArrayzero(s.cloud->field[FIELD_ACCELERATION], DIM * s.cloud->n_owned));
    PetscCall(TensionApply(s.tension, s.cloud));
    for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
      const PetscReal *force = s.cloud->field[FIELD_ACCELERATION] + DIM * a, mass = s.cloud->rest_density[a];

      for (PetscInt d = 0; d < DIM; d++) sum[d] += mass * force[d];
      if (s.cloud->field[FIELD_POSITION][DIM * a] > 0) half += mass * force[0];
      pressure = PetscMax(pressure, PetscAbsReal(s.cloud->field[FIELD_CAPILLARY][a]));
    }
    PetscCall(SetupClose(&s));
    if (!jittered) CHECK_CLOSE(SetupSum(half) / 14, -2, 0.04, "sheet_pull"); /* sums for integrals: 2 % of W_c */
    CHECK_CLOSE(pressure, 0, 0.01, "sheet_pulled_once"); /* of its edge, in tensions over a spacing */
    for (PetscInt d = 0; d < DIM; d++) CHECK_CLOSE(SetupSum(sum[d]) / 14, 0, 1e-10, "sheet_momentum");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A strip of three particles, each side of which has one row of normals: displacements of a thousandth of a spacing do
   not make the pressure of its surface steeper than that of its corners over a spacing. */
static PetscErrorCode TestStrip(void)
{
  const PetscInt  strip[DIM] = {20, 3, 1};
  const PetscReal any[]      = {0, 1000};
  const PetscInt  n          = Fill(InShell, any, strip, origin, 0.001);
  PetscReal       pressure = 0, slope = 0;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(SetupFill(OPEN_2D, n, points, 0, &s));
  PetscCall(SetupMoments(&s));
  PetscCall(TensionApply(s.tension, s.cloud));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    pressure = PetscMax(pressure, PetscAbsReal(s.cloud->field[FIELD_CAPILLARY][a]));
    slope    = PetscMax(slope, Norm(s.cloud->field[FIELD_CAPILLARY_SLOPE] + DIM * a));
  }
  PetscCall(SetupClose(&s));
  CHECK(SetupMax(pressure) > 0.2, "strip_has_corners");
  CHECK(SetupMax(slope) < SetupMax(pressure), "strip_is_even");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A sheet of one particle whose particles crowd and thin out along y, in 'waves' periods of the box of 14 spacings. The
   force per displacement that helps them to, in tensions over a squared spacing and particle, is at most half of what
   attraction alone has (0.12, 0.84, 1.20, 0.63, 0.15; see sheet.c). */
static PetscErrorCode TestUnevenSheet(void)
{
  const PetscInt  strip[DIM] = {42, 14, 1};
  const PetscReal any[] = {0, 1000}, step = 0.05, length = 14;

  PetscFunctionBegin;
  for (PetscInt waves = 1; waves <= 5; waves++) {
    const PetscReal wave  = 2 * PETSC_PI * waves / length;
    const PetscInt  n     = Fill(InShell, any, strip, origin, 0);
    PetscReal       work  = 0;
    PetscInt        count = 0;
    Setup           s;

    for (PetscInt a = 0; a < n; a++) points[DIM * a + 1] += step * PetscSinReal(wave * points[DIM * a + 1]);
    PetscCall(SetupFill(STRIP, n, points, 0, &s));
    PetscCall(SetupMoments(&s));
    PetscCall(PetscArrayzero(s.cloud->field[FIELD_ACCELERATION], DIM * s.cloud->n_owned));
    PetscCall(TensionApply(s.tension, s.cloud));
    for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
      const PetscReal *x = s.cloud->field[FIELD_POSITION] + DIM * a;

      if (PetscAbsReal(x[0]) > 7) continue; /* the edges pull */
      work += s.cloud->rest_density[a] * s.cloud->field[FIELD_ACCELERATION][DIM * a + 1] * PetscSinReal(wave * x[1]);
      count++;
    }
    PetscCall(SetupClose(&s));
    work = SetupSum(work) / SetupSum(count) * 2 / step;
    CHECK(work < 0.6, "sheet_even");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A sheet of one particle whose particles leave its plane in turn, along x or in a chequerboard: the forces bring them
   back. */
static PetscErrorCode TestZigzagSheet(void)
{
  const PetscInt  strip[DIM] = {42, 14, 1};
  const PetscReal any[] = {0, 1000}, step = 0.05;

  PetscFunctionBegin;
  for (PetscInt chequered = 0; chequered < 2; chequered++) {
    const PetscInt n    = Fill(InShell, any, strip, origin, 0);
    PetscReal      work = 0;
    Setup          s;

    for (PetscInt a = 0; a < n; a++) {
      const PetscInt i = (PetscInt)PetscFloorReal(points[DIM * a]), j = (PetscInt)PetscFloorReal(points[DIM * a + 1]);

      points[DIM * a + 2] += (i + chequered * j) % 2 == 0 ? step : -step;
    }
    PetscCall(SetupFill(STRIP, n, points, 0, &s));
    PetscCall(SetupMoments(&s));
    PetscCall(PetscArrayzero(s.cloud->field[FIELD_ACCELERATION], DIM * s.cloud->n_owned));
    PetscCall(TensionApply(s.tension, s.cloud));
    for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
      const PetscReal *x = s.cloud->field[FIELD_POSITION] + DIM * a;

      if (PetscAbsReal(x[0]) < 7) work += s.cloud->field[FIELD_ACCELERATION][DIM * a + 2] * x[2]; /* the edges pull */
    }
    PetscCall(SetupClose(&s));
    CHECK(SetupSum(work) < 0, chequered ? "sheet_flat_chequered" : "sheet_flat_zigzag");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Threads of one particle are not pulled as sheets are: their ends stay. */
static PetscErrorCode TestThread(void)
{
  const PetscInt  row[DIM] = {28, 1, 1};
  const PetscReal any[]    = {0, 1000};
  const PetscInt  n        = Fill(InShell, any, row, origin, 0);
  PetscReal       half     = 0;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(SetupFill(OPEN, n, points, 0, &s));
  PetscCall(SetupMoments(&s));
  PetscCall(PetscArrayzero(s.cloud->field[FIELD_ACCELERATION], DIM * s.cloud->n_owned));
  PetscCall(TensionApply(s.tension, s.cloud));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
    if (s.cloud->field[FIELD_POSITION][DIM * a] > 0)
      half += s.cloud->rest_density[a] * s.cloud->field[FIELD_ACCELERATION][DIM * a];
  PetscCall(SetupClose(&s));
  CHECK_CLOSE(SetupSum(half), 0, 1e-12, "thread_not_pulled");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A circle that meets the floor under the contact angle has the same curvature everywhere, the foot not excepted. */
static PetscErrorCode TestContact(void)
{
  const PetscInt  half[DIM]   = {76, 36, 1};
  const PetscReal middle[DIM] = {0, 18, 0};

  PetscFunctionBegin;
  for (PetscInt angle = 60; angle <= 120; angle += 30)
    for (PetscInt low = 0; low < 2; low++) {
      PetscReal sum = 0;
      char      options[256], name[64];
      Outcome   o;

      PetscCall(PetscSNPrintf(options, sizeof(options), FLOOR "-wall_contact_angle %d ", (int)angle));
      PetscCall(PetscSNPrintf(name, sizeof(name), "contact_%d%s", (int)angle, low ? "_foot" : ""));
      for (PetscInt k = 0; k < RADII; k++) {
        const PetscReal cap[] = {14 + (PetscReal)k, (PetscReal)angle};
        const PetscInt  n     = Fill(InCap, cap, half, middle, JITTER);

        PetscCall(Measure(options, n, 4, low ? InFoot : NULL, cap, &o));
        sum += o.mean * cap[0] / RADII;
      }
      CHECK_CLOSE(sum, 1, low ? 0.12 : 0.04, name);
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same of circles on a solid plane at 45 degrees to the lattice, on a solid circle as large as they are, and on one
   of six spacings: there the solid's normal below the surface is not that at it. */
static PetscErrorCode TestContactSolid(void)
{
  const PetscInt    block[DIM] = {80, 80, 1};
  const char *const shape[2]   = {"-s_shape half_space -s_point 0,0.5 -s_normal -1,1", BALL};
  const Inside      cap[2] = {InSlopedCap, InRoundCap}, foot[2] = {InSlopedFoot, InRoundFoot};

  PetscFunctionBegin;
  for (PetscInt angle = 60; angle <= 120; angle += 30)
    for (PetscInt ball = 0; ball < 3; ball++) {
      for (PetscInt low = 0; low < 2; low++) {
        PetscReal sum = 0;
        char      options[512], name[64];
        Outcome   o;

        PetscCall(PetscSNPrintf(name, sizeof(name), "contact_%s_%d%s",
                                ball ? ball > 1 ? "small_ball" : "ball" : "slope", (int)angle, low ? "_foot" : ""));
        for (PetscInt k = 0; k < RADII; k++) {
          const PetscReal number[] = {14 + (PetscReal)k, (PetscReal)angle, ball > 1 ? 6 : 14 + (PetscReal)k};
          const PetscInt  n        = Fill(cap[ball > 0], number, block, origin, JITTER);

          PetscCall(PetscSNPrintf(options, sizeof(options), SOLID "%d %s", (int)angle, shape[ball > 0]));
          if (ball)
            PetscCall(PetscSNPrintf(options, sizeof(options), SOLID "%d " BALL "%g", (int)angle, (double)number[2]));
          PetscCall(Measure(options, n, 4, low ? foot[ball > 0] : NULL, number, &o));
          sum += o.mean * number[0] / RADII;
        }
        CHECK_CLOSE(sum, 1, low ? 0.22 : 0.07, name);
      }
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Coordinates of the surface particles of all ranks, images not included; returns their number. */
static PetscErrorCode GatherSurface(Cloud cloud, PetscReal x[DIM * MAX_POINTS], PetscInt *count)
{
  PetscMPIInt size, mine = 0, lengths[64], starts[64];
  PetscReal  *own;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCheck(size <= 64, PETSC_COMM_WORLD, PETSC_ERR_ARG_OUTOFRANGE, "too many ranks");
  PetscCall(PetscMalloc1(DIM * cloud->n_fluid, &own));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    if (cloud->integer[INT_SURFACE][a] != 1) continue;
    for (PetscInt d = 0; d < DIM; d++) own[mine++] = cloud->field[FIELD_POSITION][DIM * a + d];
  }
  PetscCallMPI(MPI_Allgather(&mine, 1, MPI_INT, lengths, 1, MPI_INT, PETSC_COMM_WORLD));
  starts[0] = 0;
  for (PetscMPIInt r = 1; r < size; r++) starts[r] = starts[r - 1] + lengths[r - 1];
  PetscCallMPI(MPI_Allgatherv(own, mine, MPIU_REAL, x, lengths, starts, MPIU_REAL, PETSC_COMM_WORLD));
  *count = (starts[size - 1] + lengths[size - 1]) / DIM;
  PetscCall(PetscFree(own));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The cells near the surface are all that the radius reaches and none beyond it and two cells, a fourth of it: of two
   drops, where ghosts suffice for that, and of a pool whose bottom is on another rank than the surface, which must tell
   it. */
static PetscErrorCode TestBand(void)
{
  static PetscReal surface[DIM * MAX_POINTS];
  const PetscInt   block[2][DIM]  = {{46, 16, 16}, {20, 30, 1}};
  const PetscReal  middle[2][DIM] = {{0, 0, 0}, {0, 15, 0}}, number[2][2] = {{14.5, 7}, {0, 1000}},
                  radius[2] = {2.3, 18}; /* spacings; ghosts reach 5.5 */

  PetscFunctionBegin;
  for (PetscInt pool = 0; pool < 2; pool++) {
    const PetscInt  n      = Fill(pool ? InShell : InPair, number[pool], block[pool], middle[pool], JITTER);
    const PetscReal slack  = 2 * PetscSqrtReal(3) * radius[pool] / 4;
    PetscInt        missed = 0, beyond = 0, near = 0, count = 0;
    Setup           s;
    CahnHilliard   *data;

    PetscCall(SetupFill(pool ? POOL PHASES : OPEN PHASES, n, points, pool ? 4 : 0, &s));
    PetscCall(SetupMoments(&s));

    data = (CahnHilliard *)s.tension->data;
    PetscCall(CahnHilliardMark(s.tension, s.cloud, radius[pool]));
    PetscCall(GatherSurface(s.cloud, surface, &count));
    for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
      const PetscReal *x     = s.cloud->field[FIELD_POSITION] + DIM * a;
      const PetscBool  found = CellMaskHas(&data->near, x);
      PetscReal        least = PETSC_MAX_REAL;

      for (PetscInt k = 0; k < count; k++) {
        const PetscReal d[DIM] = {x[0] - surface[DIM * k], x[1] - surface[DIM * k + 1], x[2] - surface[DIM * k + 2]};

        least = PetscMin(least, Norm(d));
      }
      missed += least <= radius[pool] && !found;
      beyond += least > radius[pool] + slack && found;
      near += found;
    }
    PetscCall(SetupClose(&s));
    CHECK_CLOSE(SetupSum(missed), 0, 0, pool ? "band_pool_missed" : "band_missed");
    CHECK_CLOSE(SetupSum(beyond), 0, 0, pool ? "band_pool_beyond" : "band_beyond");
    CHECK(SetupSum(near) > 0 && (pool || SetupSum(near) < n), pool ? "band_pool_some" : "band_some");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* W'(r)/r of the cubic spline, h = 1 (1). */
static PetscReal SplineSlope(PetscReal q)
{
  if (q >= 2 || q == 0) return 0;
  return (q < 1 ? -3 * q + 2.25 * q * q : -0.75 * PetscSqr(2 - q)) / (PETSC_PI * q);
}

/* The capillary part of Eq. (1) with Eqs. (6) and (7) as the paper prints them, but for W^H in both sums: all pairs of
   n points of unit mass and these densities, h the smoothing length, kappa. */
static void PrintedForce(PetscInt n, const PetscReal rho[], PetscReal h, PetscReal kappa, PetscReal force[][DIM])
{
  static PetscReal S[MAX_POINTS][DIM][DIM];

  for (PetscInt pass = 0; pass < 2; pass++)
    for (PetscInt a = 0; a < n; a++) {
      PetscReal g[DIM] = {0}, f[DIM] = {0};

      for (PetscInt b = 0; b < n; b++) {
        PetscReal r[DIM], F;

        for (PetscInt d = 0; d < DIM; d++) r[d] = points[DIM * a + d] - points[DIM * b + d];
        F = SplineSlope(Norm(r) / h) / PetscPowRealInt(h, 5);
        for (PetscInt d = 0; d < DIM; d++) {
          g[d] += F * r[d] / rho[b];
          for (PetscInt e = 0; e < DIM && pass; e++)
            f[d] += (S[a][d][e] / PetscSqr(rho[a]) + S[b][d][e] / PetscSqr(rho[b])) * F * r[e];
        }
      }
      for (PetscInt d = 0; d < DIM; d++) {
        for (PetscInt e = 0; e < DIM && !pass; e++) S[a][d][e] = kappa * ((d == e ? Dot(g, g) : 0) - g[d] * g[e]);
        if (pass) force[a][d] = f[d];
      }
    }
}

/* The Cahn-Hilliard force of a disordered drop is that of the printed formula, with densities at rest and summed. */
static PetscErrorCode TestPrinted(void)
{
  static PetscReal expected[MAX_POINTS][DIM], rho[MAX_POINTS];
  const PetscInt   block[DIM] = {9, 9, 9};
  const PetscReal  ball[]     = {0, 3.7};

  PetscFunctionBegin;
  for (PetscInt summed = 0; summed < 2; summed++) {
    const PetscInt n     = Fill(InShell, ball, block, origin, JITTER);
    PetscReal      error = 0, largest = 0;
    Setup          s;

    PetscCall(SetupFill(summed ? OPEN PRINTED "-tension_density summed" : OPEN PRINTED, n, points, 0, &s));
    PetscCall(SetupMoments(&s));
    for (PetscInt a = 0; a < n; a++) rho[a] = 1;
    for (PetscInt a = 0; a < s.cloud->n_total && summed; a++) { /* any positive densities will do */
      const PetscInt id = s.cloud->integer[INT_ID][a];

      rho[id] = s.cloud->field[FIELD_DENSITY][a] = 0.8 + 0.4 * RandomUnit(3, (unsigned long long)id);
    }
    for (PetscInt id = 0; id < n && summed; id++) rho[id] = 0.8 + 0.4 * RandomUnit(3, (unsigned long long)id);
    PrintedForce(n, rho, KernelSmoothingLength(s.tension->kernel), 4 * KernelSmoothingLength(s.tension->kernel),
                 expected);
    PetscCall(PetscArrayzero(s.cloud->field[FIELD_ACCELERATION], DIM * s.cloud->n_owned));
    PetscCall(TensionApply(s.tension, s.cloud));
    for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
      for (PetscInt d = 0; d < DIM; d++) {
        const PetscReal exact = expected[s.cloud->integer[INT_ID][a]][d];

        largest = PetscMax(largest, PetscAbsReal(exact));
        error   = PetscMax(error, PetscAbsReal(s.cloud->field[FIELD_ACCELERATION][DIM * a + d] - exact));
      }
    PetscCall(SetupClose(&s));
    /* single precision: 1e-6 of the terms, which cancel to a tenth */
    CHECK_CLOSE(SetupMax(error) / SetupMax(largest), 0, 1e-5, summed ? "printed_summed" : "printed_rest");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The two lines of a half circle on a floor, or on a solid: what they hold back together of liquid that moves along it,
   over sigma (cos r - cos a)/2; a slow particle is stopped, and their work is what the kinetic energy loses. */
static PetscErrorCode TestHold(const char options[], const char name[])
{
  const PetscReal dt = 1e-3, stick = PetscSinReal(20 * PETSC_PI / 180), along[DIM] = {0.8, 0.6, 0};
  PetscReal       force = 0, fastest = 0, energy = 0, work[2] = {0, 0}, *fast, *slow;
  char            label[64];
  Setup           s;

  PetscFunctionBegin;
  PetscCall(SetupPack(options, &s));
  PetscCall(SetupMoments(&s));
  PetscCall(PetscMalloc2(DIM * s.cloud->n_fluid, &fast, DIM * s.cloud->n_fluid, &slow));
  for (PetscInt k = 0; k < DIM * s.cloud->n_fluid; k++) {
    fast[k] = s.scene && SceneSolidCount(s.scene) ? along[k % DIM] : k % DIM == 0;
    slow[k] = 1e-12 * fast[k];
  }
  PetscCall(LinesResist(s.tension, s.cloud, dt, fast, &work[0]));
  PetscCall(LinesResist(s.tension, s.cloud, dt, slow, &work[1]));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    const PetscReal speed = Norm(fast + DIM * a);

    force += (1 - speed) / dt;
    energy += 0.5 * (speed * speed - 1);
    if (speed < 1 - 1e-5) fastest = PetscMax(fastest, Norm(slow + DIM * a));
  }
  PetscCall(PetscSNPrintf(label, sizeof(label), "%s_holds_the_lines", name));
  CHECK_CLOSE(SetupSum(force) / stick, 2, 0.2, label);
  PetscCall(PetscSNPrintf(label, sizeof(label), "%s_stops_slow_liquid", name));
  CHECK(SetupMax(fastest) < 1e-13, label);
  PetscCall(PetscSNPrintf(label, sizeof(label), "%s_work", name));
  CHECK_CLOSE(SetupSum(work[0]) / SetupSum(energy), 1, 1e-9, label);
  PetscCall(PetscFree2(fast, slow));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A drop of particles of two spacings, with a fine region elsewhere, has the pressure of a drop of fine ones. */
static PetscErrorCode TestCoarse(void)
{
  PetscReal sum = 0, count = 0, size = 0;
  Setup     s;

  PetscFunctionBegin;
  PetscCall(SetupPack("-dimension 2 -spacing 1 -spacing_coarse 2 -spacing_growth 0.2 -box_lower -60,-60 "
                      "-box_upper 60,60 -bodies a -a_shape sphere -a_radius 32 -a_tension 1 -fine core "
                      "-core_lower -58,-58 -core_upper -54,-54 ",
                      &s));
  PetscCall(SetupMoments(&s));
  PetscCall(TensionApply(s.tension, s.cloud));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    if (s.cloud->integer[INT_SURFACE][a] != 1) continue;
    sum += s.cloud->field[FIELD_CAPILLARY][a];
    size += s.cloud->size[a];
    count++;
  }
  count = SetupSum(count);
  CHECK_CLOSE(SetupSum(size) / count, 2, 0.01, "coarse_surface");
  CHECK_CLOSE(32 * SetupSum(sum) / count, 1, 0.02, "coarse_pressure");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(TestShapes());
  PetscCall(TestMirrors());
  PetscCall(TestExtremes());
  PetscCall(TestSheet());
  PetscCall(TestStrip());
  PetscCall(TestUnevenSheet());
  PetscCall(TestZigzagSheet());
  PetscCall(TestThread());
  PetscCall(TestContact());
  PetscCall(TestContactSolid());
  PetscCall(
    TestHold(FLOOR "-a_density 1 -a_shape sphere -a_radius 16 -a_center 0,0 -wall_contact_hysteresis 40 ", "floor"));
  PetscCall(TestHold("-dimension 2 -spacing 1 -box_lower -40,-40 -box_upper 40,40 -bodies a -a_tension 1 -a_density 1 "
                     "-a_shape sphere -a_radius 16 -a_center 0,0 -solids s -s_shape half_space -s_point 0,0 -s_normal "
                     "-0.6,0.8 -s_contact_angle 90 -s_contact_hysteresis 40 ",
                     "solid"));
  PetscCall(TestBand());
  PetscCall(TestPrinted());
  PetscCall(TestCoarse());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
