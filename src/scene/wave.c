/* Box whose top is a standing wave along x at its largest displacement. With rings: a cylinder with the first
   axisymmetric standing wave. */
#include "scene_impl.h"

#define STEPS         16                 /* of the Runge-Kutta method along the flow */
#define WAVE_SAMPLES  64                 /* of half a wave; the nearest sample brackets the nearest point */
#define BISECTIONS    60                 /* to the nearest point, exact to the last bit */
#define WAVE_ROUNDING 1e-6               /* of a half wave, for the rounding of decimal input */
#define FIRST_ZERO    3.8317059702075125 /* of J1: the first j with J1(j) = 0 */
#define RING_HEIGHT   2                  /* amplitudes above the level: an upper bound of the crests */
#define STEEPNESS_MAX 0.5                /* of k a: the expansion to second order describes no steeper wave */

typedef struct {
  PetscReal lower[DIM], upper[DIM];   /* m; upper[up]: the level */
  PetscReal amplitude;                /* m */
  PetscReal length;                   /* m */
  PetscReal k;                        /* wave number, with rings the first zero of J1 over the radius, 1/m */
  PetscReal second;                   /* m, amplitude of the second harmonic */
  PetscReal scale;                    /* m, of WaveFlow: the amplitude over sinh(k depth) */
  PetscReal sample[WAVE_SAMPLES + 1]; /* m, WaveSurface from a crest to the next trough */
  PetscReal stretch;                  /* with rings: largest factor by which the map changes distances, 1 */
  PetscInt  up;                       /* the direction upwards */
  PetscBool rings;
} Wave;

static const OptionRow options[] = {
  ROW_OF_LOWER(Wave),
  ROW_OF_UPPER(Wave),
  {"-wave_amplitude", "Amplitude of the wave, if positive with a crest at the lower x", "m", NULL, ROW_REAL,
   offsetof(Wave, amplitude), .fallback = OPTION_REQUIRED},
  {"-wave_length", "Length of the wave along x", "m", "(0, inf)", ROW_REAL, offsetof(Wave, length),
   .fallback = "the width of its box"},
  {.name = NULL},
};

/* Elevation of the surface above the level (m) at s = x - lower[0] (m), and its slope. */
static PetscReal WaveSurface(const Wave *wave, PetscReal s, PetscReal *slope)
{
  const PetscReal a = wave->amplitude, k = wave->k, cosine = PetscCosReal(k * s), sine = PetscSinReal(k * s);

  *slope = -k * sine * (a + 4 * wave->second * cosine);
  return a * cosine + wave->second * (2 * cosine * cosine - 1);
}

static void WaveDefaults(void *owner)
{
  Body  body = (Body)owner;
  Wave *wave = (Wave *)body->shape_data;

  for (PetscInt d = 0; d < DIM; d++) {
    wave->lower[d] = body->domain->lower[d];
    wave->upper[d] = body->domain->upper[d];
  }
}

static PetscErrorCode WaveSetUp(void *owner)
{
  Body           body   = (Body)owner;
  Domain         domain = body->domain;
  const PetscInt up     = domain->dim - 1;
  Wave          *wave   = (Wave *)body->shape_data;
  PetscReal      halves, depth, slope;
  PetscBool      given;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < domain->dim; d++)
    PetscCheckUser(wave->upper[d] > wave->lower[d], domain->comm, "-%supper must be above -%slower in every direction",
                   body->prefix, body->prefix);
  PetscCall(PetscOptionsHasName(NULL, body->prefix, "-wave_amplitude", &given));
  if (wave->length == 0) wave->length = wave->upper[0] - wave->lower[0];
  PetscCheckUser(given && PetscAbsReal(wave->amplitude) < 0.5 * (wave->upper[up] - wave->lower[up]), domain->comm,
                 "-%swave_amplitude must be given and below half the depth, %g m", body->prefix,
                 0.5 * (double)(wave->upper[up] - wave->lower[up]));
  wave->rings = domain->rings;
  wave->up    = domain->dim - 1;
  if (wave->rings) {
    PetscCheckUser(wave->lower[0] == 0 && wave->length == wave->upper[0], domain->comm,
                   "-%slower must have 0 as its first number, and -%swave_length cannot be used: with -dimension "
                   "axisymmetric the wave is the first axisymmetric one",
                   body->prefix, body->prefix);
    wave->length = 2 * PETSC_PI / FIRST_ZERO * wave->upper[0];
  }
  wave->k       = 2 * PETSC_PI / wave->length;
  depth         = wave->upper[up] - wave->lower[up];
  wave->second  = 0.5 * wave->k * wave->amplitude * wave->amplitude / PetscTanhReal(wave->k * depth);
  wave->scale   = wave->amplitude / PetscSinhReal(wave->k * depth);
  wave->stretch = PetscExpReal(PetscAbsReal(wave->k * wave->amplitude) / PetscTanhReal(wave->k * depth));
  halves        = 2 * (wave->upper[0] - wave->lower[0]) / wave->length;
  PetscCheckUser(wave->rings || (halves > 0.5 && PetscAbsReal(halves - PetscFloorReal(halves + 0.5)) < WAVE_ROUNDING),
                 domain->comm,
                 "-%swave_length is %g m: the width of the body, %g m, must hold a whole number of half waves",
                 body->prefix, (double)wave->length, (double)(wave->upper[0] - wave->lower[0]));
  PetscCheckUser(PetscAbsReal(wave->k * wave->amplitude) < STEEPNESS_MAX, domain->comm,
                 "-%swave_amplitude is %g m: it must be at most 0.08 of the wave's length", body->prefix,
                 (double)wave->amplitude);
  for (PetscInt m = 0; m <= WAVE_SAMPLES; m++)
    wave->sample[m] = WaveSurface(wave, PETSC_PI / wave->k * m / WAVE_SAMPLES, &slope);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* WaveFlow for rings. */
static void RingFlow(const void *shape, const PetscReal x[DIM], PetscReal v[DIM])
{
  const Wave     *wave = (const Wave *)shape;
  const PetscReal k = wave->k, scale = wave->scale, height = x[1] - wave->lower[1];
  PetscReal       J0, J1_over_kr;

  BesselSeries(-0.25 * k * k * x[0] * x[0], &J0, &J1_over_kr);
  v[0] = -scale * J1_over_kr * k * x[0] * PetscCoshReal(k * height);
  v[1] = scale * J0 * PetscSinhReal(k * height);
  v[2] = 0;
}

/* Signed distance of a point to the surface, negative below. The nearest point is in the same half wave, since the
   curve is symmetric at both ends of it. It is the zero of the derivative of the squared distance next to the best
   sample. */
static PetscReal SurfaceDistance(const Wave *wave, PetscInt up, const PetscReal x[DIM])
{
  const PetscReal half = PETSC_PI / wave->k, z = x[up] - wave->upper[up], across = x[0] - wave->lower[0];
  PetscReal       s = across - 2 * half * PetscFloorReal(across / (2 * half)), best = PETSC_MAX_REAL, low = 0, high = 0;
  PetscReal       slope, eta, square;

  s = PetscMin(s, 2 * half - s);
  for (PetscInt m = 0; m <= WAVE_SAMPLES; m++) {
    square = PetscSqr(half * m / WAVE_SAMPLES - s) + PetscSqr(wave->sample[m] - z);
    if (square >= best) continue;
    best = square;
    low  = half * PetscMax(m - 1, 0) / WAVE_SAMPLES;
    high = half * PetscMin(m + 1, WAVE_SAMPLES) / WAVE_SAMPLES;
  }
  for (PetscInt n = 0; n < BISECTIONS; n++) {
    const PetscReal middle = 0.5 * (low + high);

    eta = WaveSurface(wave, middle, &slope);
    if (middle - s + (eta - z) * slope > 0)
      high = middle;
    else
      low = middle;
  }
  eta    = WaveSurface(wave, low, &slope);
  square = PetscSqrtReal(PetscMin(best, PetscSqr(low - s) + PetscSqr(eta - z)));
  return z < WaveSurface(wave, s, &slope) ? -square : square;
}

/* With rings: a lower bound of the distance, from the distance to the level before the displacement. */
static PetscReal RingDistance(const Wave *wave, const PetscReal x[DIM])
{
  const PetscReal level = wave->upper[1], top = level + RING_HEIGHT * PetscAbsReal(wave->amplitude);
  PetscReal       y[DIM] = {x[0], x[1], 0}, above;

  y[0]  = PetscMin(PetscMax(y[0], 0), wave->upper[0]);
  y[1]  = PetscMin(PetscMax(y[1], wave->lower[1]), top);
  above = x[1] - y[1];
  MoveAlong(wave, RingFlow, -1, STEPS, y);
  return (y[1] - level + above) / wave->stretch;
}

static PetscReal WaveDistance(Body body, const PetscReal x[DIM])
{
  const Wave    *wave = (const Wave *)body->shape_data;
  const PetscInt up   = body->domain->dim - 1;
  PetscReal      deep = wave->rings ? RingDistance(wave, x) : SurfaceDistance(wave, up, x);

  for (PetscInt d = 0; d <= up; d++)
    deep = PetscMax(deep, PetscMax(wave->lower[d] - x[d], d < up ? x[d] - wave->upper[d] : deep));
  return deep;
}

static void WaveBounds(Body body, PetscReal lower[DIM], PetscReal upper[DIM])
{
  const Wave    *wave = (const Wave *)body->shape_data;
  const PetscInt up   = body->domain->dim - 1;
  PetscReal      slope;

  for (PetscInt d = 0; d < DIM; d++) {
    lower[d] = wave->lower[d];
    upper[d] = wave->upper[d];
  }
  if (wave->rings)
    upper[up] += RING_HEIGHT * PetscAbsReal(wave->amplitude);
  else
    upper[up] += PetscMax(WaveSurface(wave, 0, &slope), WaveSurface(wave, PETSC_PI / wave->k, &slope));
}

/* The velocity of the linear standing wave times 1 s. It has no divergence and is tangential at bottom and sides. */
static void WaveFlow(const void *shape, const PetscReal x[DIM], PetscReal v[DIM])
{
  const Wave     *wave = (const Wave *)shape;
  const PetscInt  up   = wave->up;
  const PetscReal k = wave->k, e = PetscExpReal(k * (x[up] - wave->lower[up])), half = 0.5 * wave->scale,
                  phase = k * (x[0] - wave->lower[0]);

  v[1] = v[2] = 0;
  v[0]        = -half * PetscSinReal(phase) * (e + 1 / e);
  v[up]       = half * PetscCosReal(phase) * (e - 1 / e);
}

static void WaveDisplace(Body body, PetscReal x[DIM])
{
  const Wave *wave = (const Wave *)body->shape_data;

  MoveAlong(wave, wave->rings ? RingFlow : WaveFlow, 1, STEPS, x);
}

static PetscReal WaveLength(Body body)
{
  const Wave *wave = (const Wave *)body->shape_data;

  return 2 * PETSC_PI / wave->k;
}

const ShapeOps ShapeWave = {
  {"wave", sizeof(Wave), options, WaveDefaults, WaveSetUp}, WaveDistance, WaveBounds, WaveDisplace, WaveLength};
