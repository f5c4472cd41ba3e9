/* Infinite thread of liquid with waves along its axis, Rayleigh's varicose mode. The points of a circular cylinder move
   for a unit of time along the mode's velocity field, which conserves volumes. */
#include "scene_impl.h"

#define STEPS         8   /* of the Runge-Kutta method along the flow of the largest amplitude; fewer for less, but 2 */
#define FAR           2   /* radii from the axis: the flow ends there */
#define AMPLITUDE_MAX 0.2 /* of the radius: the linear mode describes no larger wave */

typedef struct {
  PetscReal center[DIM]; /* at a crest, m */
  PetscReal axis[DIM];   /* unit vector */
  PetscReal radius;      /* m */
  PetscReal amplitude;   /* m */
  PetscReal wave_length; /* m */
  PetscReal k;           /* wave number, 1/m */
  PetscReal scale;       /* amplitude/I1(k radius), m */
  PetscReal stretch;     /* largest factor by which the map changes distances within FAR, 1 */
} Thread;

static void Bessel(PetscReal x, PetscReal *I0, PetscReal *I1_over_x)
{
  BesselSeries(0.25 * x * x, I0, I1_over_x);
}

static const OptionRow options[] = {
  ROW_OF_CENTER(Thread),
  ROW_OF_RADIUS(Thread),
  {"-axis", "Axis of a thread: x, y, z or a vector", NULL, NULL, ROW_AXIS, offsetof(Thread, axis)},
  ROW_OF_AMPLITUDE(Thread),
  {"-wave_length", "Length of the waves along a thread", "m", "(0, inf)", ROW_REAL, offsetof(Thread, wave_length),
   .fallback = OPTION_REQUIRED},
  {.name = NULL},
};

static void ThreadDefaults(void *owner)
{
  Body body                                                       = (Body)owner;
  ((Thread *)body->shape_data)->axis[body->domain->rings ? 1 : 2] = 1;
}

static PetscErrorCode ThreadSetUp(void *owner)
{
  Body      body   = (Body)owner;
  Domain    domain = body->domain;
  Thread   *thread = (Thread *)body->shape_data;
  PetscReal I0, I1;

  PetscFunctionBegin;
  PetscCheckUser(domain->dim == 3 || domain->rings, domain->comm, "-%sshape thread needs three dimensions, or rings",
                 body->prefix);
  PetscCheckUser(!domain->rings || (thread->center[0] == 0 && thread->axis[1] == 1), domain->comm,
                 "-%scenter must have 0 as its first number and -%saxis be y: the rings have one axis", body->prefix,
                 body->prefix);
  PetscCall(BodyCheckLength(body, "-radius", thread->radius));
  PetscCall(BodyCheckLength(body, "-wave_length", thread->wave_length));
  thread->k = 2 * PETSC_PI / thread->wave_length;
  PetscCheckUser(PetscAbsReal(thread->amplitude) <= AMPLITUDE_MAX * thread->radius, domain->comm,
                 "-%swave_amplitude is %g m; it must be at most a fifth of the radius", body->prefix,
                 (double)thread->amplitude);
  PetscCheckUser(thread->k * thread->radius <= PETSC_PI, domain->comm,
                 "-%swave_length is %g m; it must be at least twice the radius", body->prefix,
                 (double)thread->wave_length);
  Bessel(thread->k * thread->radius, &I0, &I1);
  thread->scale = thread->amplitude / (I1 * thread->k * thread->radius);
  Bessel(FAR * thread->k * thread->radius, &I0, &I1);
  thread->stretch = PetscExpReal(2 * PetscAbsReal(thread->scale) * thread->k * I0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Splits x - center into a part along the axis and a part r normal to it (m). Returns the distance from the axis. */
static PetscReal Split(const Thread *thread, const PetscReal x[DIM], PetscReal r[DIM], PetscReal *along)
{
  *along = 0;
  for (PetscInt d = 0; d < DIM; d++) *along += (x[d] - thread->center[d]) * thread->axis[d];
  for (PetscInt d = 0; d < DIM; d++) r[d] = x[d] - thread->center[d] - *along * thread->axis[d];
  return Norm(r);
}

/* The mode's velocity times 1 s: scale/k grad(I0(kr) cos(kz)). It has no divergence. */
static void Flow(const void *shape, const PetscReal x[DIM], PetscReal v[DIM])
{
  const Thread   *thread = (const Thread *)shape;
  PetscReal       r[DIM], z, I0, I1;
  const PetscReal distance = Split(thread, x, r, &z);

  Bessel(thread->k * distance, &I0, &I1);
  for (PetscInt d = 0; d < DIM; d++)
    v[d] = thread->scale *
           (I1 * thread->k * r[d] * PetscCosReal(thread->k * z) - I0 * thread->axis[d] * PetscSinReal(thread->k * z));
}

static PetscInt Steps(const Thread *thread)
{
  return PetscMax(2,
                  (PetscInt)PetscCeilReal(STEPS * PetscAbsReal(thread->amplitude) / (AMPLITUDE_MAX * thread->radius)));
}

static void ThreadDisplace(Body body, PetscReal x[DIM])
{
  const Thread *thread = (const Thread *)body->shape_data;
  PetscReal     r[DIM], z;

  if (Split(thread, x, r, &z) < FAR * thread->radius) MoveAlong(thread, Flow, 1, Steps(thread), x);
}

static PetscReal ThreadDistance(Body body, const PetscReal x[DIM])
{
  const Thread   *thread = (const Thread *)body->shape_data;
  PetscReal       r[DIM], z, y[DIM] = {x[0], x[1], x[2]};
  const PetscReal distance = Split(thread, x, r, &z);

  if (distance > FAR * thread->radius) return distance - FAR * thread->radius + thread->radius / thread->stretch;
  MoveAlong(thread, Flow, -1, Steps(thread), y);
  return (Split(thread, y, r, &z) - thread->radius) / thread->stretch;
}

static void ThreadBounds(Body body, PetscReal lower[DIM], PetscReal upper[DIM])
{
  const Thread *thread = (const Thread *)body->shape_data;

  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal a = thread->axis[d], half = FAR * thread->radius * PetscSqrtReal(PetscMax(0, 1 - a * a));

    lower[d] = a != 0 ? -PETSC_MAX_REAL : thread->center[d] - half;
    upper[d] = a != 0 ? PETSC_MAX_REAL : thread->center[d] + half;
  }
}

static PetscReal ThreadWave(Body body)
{
  return ((const Thread *)body->shape_data)->wave_length;
}

const ShapeOps ShapeThread = {{"thread", sizeof(Thread), options, ThreadDefaults, ThreadSetUp},
                              ThreadDistance,
                              ThreadBounds,
                              ThreadDisplace,
                              ThreadWave};
