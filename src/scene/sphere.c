/* Sphere; a circle in two dimensions. A wave is the shape of an oscillating drop: its points move for a unit of time
   along the mode's flow, grad(r^n P_n), which conserves volumes. */
#include "scene_impl.h"

#define STEPS         8   /* of the Runge-Kutta method along the flow of the largest amplitude; fewer for less, but 2 */
#define MODE_LEAST    2   /* modes 0 and 1 are no oscillations */
#define FAR           1.5 /* radii: the flow ends there, beyond the highest wave */
#define STEEPNESS_MAX 0.4 /* of n times amplitude over radius: the linear mode describes no larger wave */

typedef struct {
  PetscReal center[DIM]; /* m */
  PetscReal radius;      /* m */
  PetscReal amplitude;   /* of the wave at the poles, m */
  PetscInt  mode;        /* n */
  PetscInt  up;          /* the direction of the poles */
  PetscReal stretch;     /* largest factor by which the map changes distances within FAR, 1 */
} Sphere;

static const OptionRow options[] = {
  ROW_OF_CENTER(Sphere),
  ROW_OF_RADIUS(Sphere),
  ROW_OF_AMPLITUDE(Sphere),
  {"-wave_mode", "Mode n of that wave, P_n(cos theta), theta from the vertical: 2 is a spheroid", "1", "[2, 6]",
   ROW_INT, offsetof(Sphere, mode)},
  {.name = NULL},
};

static void SphereDefaults(void *owner)
{
  Body body                          = (Body)owner;
  ((Sphere *)body->shape_data)->mode = MODE_LEAST;
}

static PetscErrorCode SphereSetUp(void *owner)
{
  Body         body   = (Body)owner;
  const Domain domain = body->domain;
  Sphere      *sphere = (Sphere *)body->shape_data;

  PetscFunctionBegin;
  PetscCall(BodyCheckLength(body, "-radius", sphere->radius));
  PetscCheckUser(sphere->mode * PetscAbsReal(sphere->amplitude) <= STEEPNESS_MAX * sphere->radius, domain->comm,
                 "-%swave_amplitude is %g m; it must be at most %g m, 0.4 of the radius over the mode", body->prefix,
                 (double)sphere->amplitude, STEEPNESS_MAX * (double)sphere->radius / (double)sphere->mode);
  PetscCheckUser(sphere->amplitude == 0 || domain->dim == DIM || (domain->rings && sphere->center[0] == 0),
                 domain->comm, "-%swave_amplitude needs three dimensions, or rings and a sphere on their axis",
                 body->prefix);
  sphere->up      = domain->dim - 1;
  sphere->stretch = PetscExpReal(sphere->mode * PetscPowReal(FAR, (PetscReal)(sphere->mode - 2)) *
                                 PetscAbsReal(sphere->amplitude) / sphere->radius);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The mode's velocity times 1 s: (amplitude/n) grad S_n, S_n = r^n P_n with lengths in radii. The recursion is
   (n + 1) S_n+1 = (2 n + 1) z S_n - n r^2 S_n-1; slope is its derivative to the square of the distance from the poles'
   axis. */
static void SphereFlow(const void *shape, const PetscReal x[DIM], PetscReal v[DIM])
{
  const Sphere   *sphere = (const Sphere *)shape;
  const PetscInt  up = sphere->up, n = sphere->mode;
  const PetscReal z = (x[up] - sphere->center[up]) / sphere->radius, scale = sphere->amplitude / n;
  PetscReal       S[2] = {1, z}, slope[2] = {0, 0}, r2 = z * z; /* [0]: n - 1, [1]: n */

  for (PetscInt d = 0; d < up; d++) r2 += PetscSqr((x[d] - sphere->center[d]) / sphere->radius);
  for (PetscInt k = 1; k < n; k++) {
    const PetscReal next       = ((2 * k + 1) * z * S[1] - k * r2 * S[0]) / (k + 1),
                    next_slope = ((2 * k + 1) * z * slope[1] - k * (S[0] + r2 * slope[0])) / (k + 1);

    S[0]     = S[1];
    S[1]     = next;
    slope[0] = slope[1];
    slope[1] = next_slope;
  }
  v[0] = v[1] = v[2] = 0;
  for (PetscInt d = 0; d < up; d++) v[d] = scale * 2 * slope[1] * (x[d] - sphere->center[d]) / sphere->radius;
  v[up] = scale * n * S[0];
}

static PetscReal CenterDistance(Body body, const PetscReal x[DIM])
{
  const Sphere *sphere = (const Sphere *)body->shape_data;
  PetscReal     square = 0;

  for (PetscInt d = 0; d < body->domain->dim; d++) square += PetscSqr(x[d] - sphere->center[d]);
  return PetscSqrtReal(square);
}

static PetscInt Steps(const Sphere *sphere)
{
  const PetscReal steepness = (PetscReal)sphere->mode * PetscAbsReal(sphere->amplitude) / sphere->radius;

  return PetscMax(2, (PetscInt)PetscCeilReal(STEPS * steepness / STEEPNESS_MAX));
}

static void SphereDisplace(Body body, PetscReal x[DIM])
{
  const Sphere *sphere = (const Sphere *)body->shape_data;

  if (sphere->amplitude != 0 && CenterDistance(body, x) < FAR * sphere->radius)
    MoveAlong(sphere, SphereFlow, 1, Steps(sphere), x);
}

static PetscReal SphereDistance(Body body, const PetscReal x[DIM])
{
  const Sphere   *sphere = (const Sphere *)body->shape_data;
  const PetscReal far    = CenterDistance(body, x);
  PetscReal       y[DIM] = {x[0], x[1], x[2]};

  if (sphere->amplitude == 0) return far - sphere->radius;
  if (far > FAR * sphere->radius) return far - FAR * sphere->radius + (FAR - 1) / 2 * sphere->radius / sphere->stretch;
  MoveAlong(sphere, SphereFlow, -1, Steps(sphere), y);
  return (CenterDistance(body, y) - sphere->radius) / sphere->stretch;
}

static void SphereBounds(Body body, PetscReal lower[DIM], PetscReal upper[DIM])
{
  const Sphere *sphere = (const Sphere *)body->shape_data;

  for (PetscInt d = 0; d < DIM; d++) {
    lower[d] = sphere->center[d] - sphere->radius - 2 * PetscAbsReal(sphere->amplitude);
    upper[d] = sphere->center[d] + sphere->radius + 2 * PetscAbsReal(sphere->amplitude);
  }
}

/* A great circle has n waves of the mode n. */
static PetscReal SphereWave(Body body)
{
  const Sphere *sphere = (const Sphere *)body->shape_data;

  return sphere->amplitude != 0 ? 2 * PETSC_PI * sphere->radius / (PetscReal)sphere->mode : 0;
}

const ShapeOps ShapeSphere = {{"sphere", sizeof(Sphere), options, SphereDefaults, SphereSetUp},
                              SphereDistance,
                              SphereBounds,
                              SphereDisplace,
                              SphereWave};
