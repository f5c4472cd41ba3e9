/* Initial velocity fields, which add to the uniform part. A field needs one table and one registration line. */
#include "scene_impl.h"

#define GRADIENT_SIZE  (DIM * DIM)
#define TRACE_ROUNDING 1e-9 /* relative to the largest rate */

/* A linear field v = G (x - center): rotation, and strain with shear. */
typedef struct {
  PetscReal gradient[DIM][DIM];      /* G_ij = dv_i/dx_j, 1/s */
  PetscReal center[DIM];             /* m */
  PetscReal rate[GRADIENT_SIZE + 1]; /* the numbers given, 1/s; one more than allowed, to detect too many */
  PetscInt  rates;                   /* count of the numbers given */
} Linear;

static void LinearAdd(Body body, const PetscReal x[DIM], PetscReal v[DIM])
{
  const Linear *linear = (const Linear *)body->velocity_data;

  for (PetscInt i = 0; i < body->domain->dim; i++) {
    for (PetscInt j = 0; j < body->domain->dim; j++) v[i] += linear->gradient[i][j] * (x[j] - linear->center[j]);
  }
}

/* Reads up to 'most' finite numbers. count: of the numbers read; 0 without the option. */
static PetscErrorCode ReadNumbers(Body body, OptionItems PetscOptionsObject, const char option[], const char help[],
                                  PetscInt most, PetscReal number[], PetscInt *count)
{
  PetscBool found;

  PetscFunctionBegin;
  *count = most;
  PetscCall(PetscOptionsRealArray(option, help, "Velocity", number, count, &found));
  if (!found) *count = 0;
  for (PetscInt k = 0; k < *count; k++) {
    PetscCheckUser(!PetscIsInfOrNanReal(number[k]), body->domain->comm, "-%s%s must have finite numbers", body->prefix,
                   option + 1);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses an option that is missing. */
static PetscErrorCode CheckGiven(Body body, const char option[], PetscInt count)
{
  PetscFunctionBegin;
  PetscCheckUser(count > 0, body->domain->comm, "-%s%s is missing: -%svelocity_type %s needs it", body->prefix,
                 option + 1, body->prefix, body->velocity_type);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rigid rotation v = omega x (x - center). The square patch of Colagrossi (2005), v = omega (y, -x), has the rate
   0,0,-omega. */
static PetscErrorCode RotationSetFromOptions(Body body, OptionItems PetscOptionsObject)
{
  Linear *linear = (Linear *)body->velocity_data;

  PetscFunctionBegin;
  PetscCall(ReadNumbers(body, PetscOptionsObject, "-rotation_rate",
                        "Angular velocity (rad/s); in two dimensions one number is enough", DIM + 1, linear->rate,
                        &linear->rates));
  PetscCall(DomainOptionsVector(body->domain, PetscOptionsObject, VECTOR_POINT, "-rotation_center",
                                "Point on the axis of rotation (m)", "Velocity", linear->center, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RotationSetUp(Body body)
{
  Linear   *linear    = (Linear *)body->velocity_data;
  PetscReal rate[DIM] = {0, 0, 0};

  PetscFunctionBegin;
  PetscCall(CheckGiven(body, "-rotation_rate", linear->rates));
  PetscCheckUser(linear->rates == DIM || (linear->rates == 1 && body->domain->dim == 2), body->domain->comm,
                 "-%srotation_rate must have %s", body->prefix,
                 body->domain->dim == 2 ? "one number, or three numbers of which the first two are 0"
                                        : "three numbers");
  if (linear->rates == 1)
    rate[2] = linear->rate[0];
  else
    PetscCall(PetscArraycpy(rate, linear->rate, DIM));
  PetscCheckUser(body->domain->dim == DIM || (rate[0] == 0 && rate[1] == 0), body->domain->comm,
                 "-%srotation_rate must be about z in two dimensions: its first two numbers must be 0", body->prefix);
  linear->gradient[0][1] = -rate[2];
  linear->gradient[0][2] = rate[1];
  linear->gradient[1][0] = rate[2];
  linear->gradient[1][2] = -rate[0];
  linear->gradient[2][0] = -rate[1];
  linear->gradient[2][1] = rate[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* v = G (x - center), G diagonal or full, with zero trace. The stretching drop of Monaghan (1994), v = (-A x, A y), has
   the rates -A,A. */
static PetscErrorCode StrainSetFromOptions(Body body, OptionItems PetscOptionsObject)
{
  Linear *linear = (Linear *)body->velocity_data;

  PetscFunctionBegin;
  PetscCall(ReadNumbers(body, PetscOptionsObject, "-strain_rate",
                        "Velocity gradient dv_i/dx_j (1/s): its diagonal, or all numbers row by row", GRADIENT_SIZE + 1,
                        linear->rate, &linear->rates));
  PetscCall(DomainOptionsVector(body->domain, PetscOptionsObject, VECTOR_POINT, "-strain_center",
                                "Point at rest in the strain (m)", "Velocity", linear->center, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode StrainSetUp(Body body)
{
  Linear        *linear = (Linear *)body->velocity_data;
  const PetscInt dim = body->domain->dim, count = linear->rates;
  PetscReal      trace = 0, largest = 0;

  PetscFunctionBegin;
  PetscCall(CheckGiven(body, "-strain_rate", count));
  PetscCheckUser(count == dim || count == dim * dim, body->domain->comm,
                 "-%sstrain_rate must have %" PetscInt_FMT " numbers (the diagonal) or %" PetscInt_FMT, body->prefix,
                 dim, dim * dim);
  for (PetscInt i = 0; i < dim; i++) {
    for (PetscInt j = 0; j < dim; j++) {
      if (count == dim)
        linear->gradient[i][j] = i == j ? linear->rate[i] : 0;
      else
        linear->gradient[i][j] = linear->rate[i * dim + j];
      largest = PetscMax(largest, PetscAbsReal(linear->gradient[i][j]));
    }
    trace += linear->gradient[i][i];
  }
  if (body->domain->rings) trace += linear->gradient[0][0]; /* v_r/r */
  PetscCheckUser(PetscAbsReal(trace) <= TRACE_ROUNDING * largest, body->domain->comm,
                 "-%sstrain_rate must not change the volume: the sum of its diagonal must be 0%s, not %g 1/s",
                 body->prefix, body->domain->rings ? ", with the first number counted twice for rings" : "",
                 (double)trace);
  PetscFunctionReturn(PETSC_SUCCESS);
}

typedef struct {
  PetscReal amplitude[2]; /* m/s; one more than allowed, to detect too many */
  PetscInt  amplitudes;   /* count of the numbers given */
  PetscReal wavelength;   /* m */
} TaylorGreen;

static PetscErrorCode TaylorGreenSetFromOptions(Body body, OptionItems PetscOptionsObject)
{
  TaylorGreen *vortex = (TaylorGreen *)body->velocity_data;

  PetscFunctionBegin;
  PetscCall(ReadNumbers(body, PetscOptionsObject, "-taylor_green_amplitude",
                        "Largest velocity of the Taylor-Green vortices (m/s)", 2, vortex->amplitude,
                        &vortex->amplitudes));
  vortex->wavelength = body->domain->upper[0] - body->domain->lower[0];
  PetscCall(OptionReal("-taylor_green_wavelength",
                       "Wavelength of the Taylor-Green vortices (m); default: the width of the box", "(0, inf)",
                       &vortex->wavelength));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TaylorGreenSetUp(Body body)
{
  const TaylorGreen *vortex = (const TaylorGreen *)body->velocity_data;

  PetscFunctionBegin;
  PetscCall(CheckGiven(body, "-taylor_green_amplitude", vortex->amplitudes));
  PetscCheckUser(vortex->amplitudes == 1, body->domain->comm, "-%staylor_green_amplitude must have one number",
                 body->prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Taylor & Green (1937), plane and constant along z: u = -U cos(2 pi x/L) sin(2 pi y/L),
   v = U sin(2 pi x/L) cos(2 pi y/L). */
static void TaylorGreenAdd(Body body, const PetscReal x[DIM], PetscReal v[DIM])
{
  const TaylorGreen *vortex = (const TaylorGreen *)body->velocity_data;
  const PetscReal    k      = 2 * PETSC_PI / vortex->wavelength;

  v[0] -= vortex->amplitude[0] * PetscCosReal(k * x[0]) * PetscSinReal(k * x[1]);
  v[1] += vortex->amplitude[0] * PetscSinReal(k * x[0]) * PetscCosReal(k * x[1]);
}

#define VELOCITY_TABLE(name, size, setfromoptions, setup, add)                                                         \
  static const BodyChoice *Velocity##name(void)                                                                        \
  {                                                                                                                    \
    static const VelocityOps ops = {{size, setfromoptions, setup}, add};                                               \
                                                                                                                       \
    return &ops.choice;                                                                                                \
  }
VELOCITY_TABLE(Uniform, 0, NULL, NULL, NULL)
VELOCITY_TABLE(Rotation, sizeof(Linear), RotationSetFromOptions, RotationSetUp, LinearAdd)
VELOCITY_TABLE(Strain, sizeof(Linear), StrainSetFromOptions, StrainSetUp, LinearAdd)
VELOCITY_TABLE(TaylorGreen, sizeof(TaylorGreen), TaylorGreenSetFromOptions, TaylorGreenSetUp, TaylorGreenAdd)

PetscErrorCode VelocityRegisterAll(PetscFunctionList *list)
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListAdd(list, "uniform", VelocityUniform));
  PetscCall(PetscFunctionListAdd(list, "rotation", VelocityRotation));
  PetscCall(PetscFunctionListAdd(list, "strain", VelocityStrain));
  PetscCall(PetscFunctionListAdd(list, "taylor_green", VelocityTaylorGreen));
  PetscFunctionReturn(PETSC_SUCCESS);
}
