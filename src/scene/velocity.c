/* Initial velocity fields. Each adds to the uniform part; one table and one registration line a field. */
#include "scene_impl.h"

#define GRADIENT_SIZE  (DIM * DIM)
#define TRACE_ROUNDING 1e-9 /* relative to the largest rate */

/* Velocity gradients are linear fields v = G (x - center): rotation, strain and shear are of this form. */
typedef struct {
  PetscReal gradient[DIM][DIM]; /* G_ij = dv_i/dx_j, 1/s */
  PetscReal center[DIM];        /* m */
} Linear;

static void LinearAdd(Body body, const PetscReal x[DIM], PetscReal v[DIM])
{
  const Linear *linear = (const Linear *)body->velocity_data;

  for (PetscInt i = 0; i < body->domain->dim; i++) {
    for (PetscInt j = 0; j < body->domain->dim; j++) v[i] += linear->gradient[i][j] * (x[j] - linear->center[j]);
  }
}

/* Reads up to 'most' finite numbers that must be given; count is how many there were. */
static PetscErrorCode ReadNumbers(Body body, OptionItems PetscOptionsObject, const char option[], const char help[],
                                  PetscInt most, PetscReal number[], PetscInt *count)
{
  PetscBool found;

  PetscFunctionBegin;
  *count = most;
  PetscCall(PetscOptionsRealArray(option, help, "Velocity", number, count, &found));
  PetscCheckUser(found, body->domain->comm, "-%s%s is missing: -%svelocity_type %s needs it", body->prefix, option + 1,
                 body->prefix, body->velocity_type);
  for (PetscInt k = 0; k < *count; k++) {
    PetscCheckUser(!PetscIsInfOrNanReal(number[k]), body->domain->comm, "-%s%s must have finite numbers", body->prefix,
                   option + 1);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rigid rotation v = omega x (x - center). The square patch v = omega (y, -x) of Colagrossi (2005) has the rate
   0,0,-omega. */
static PetscErrorCode RotationSetFromOptions(Body body, OptionItems PetscOptionsObject)
{
  Linear   *linear          = (Linear *)body->velocity_data;
  PetscReal number[DIM + 1] = {0}, rate[DIM] = {0, 0, 0};
  PetscInt  count;

  PetscFunctionBegin;
  PetscCall(ReadNumbers(body, PetscOptionsObject, "-rotation_rate",
                        "Angular velocity; in two dimensions one number will do (rad/s)", DIM + 1, number, &count));
  PetscCheckUser(count == DIM || (count == 1 && body->domain->dim == 2), body->domain->comm,
                 "-%srotation_rate must have %s", body->prefix,
                 body->domain->dim == 2 ? "one number, or three in which the first two are 0" : "three numbers");
  if (count == 1)
    rate[2] = number[0];
  else
    PetscCall(PetscArraycpy(rate, number, DIM));
  PetscCheckUser(body->domain->dim == DIM || (rate[0] == 0 && rate[1] == 0), body->domain->comm,
                 "-%srotation_rate must be about z in two dimensions: its first two numbers must be 0", body->prefix);
  linear->gradient[0][1] = -rate[2];
  linear->gradient[0][2] = rate[1];
  linear->gradient[1][0] = rate[2];
  linear->gradient[1][2] = -rate[0];
  linear->gradient[2][0] = -rate[1];
  linear->gradient[2][1] = rate[0];
  PetscCall(DomainOptionsVector(body->domain, PetscOptionsObject, VECTOR_POINT, "-rotation_center",
                                "Point on the axis of rotation (m)", "Velocity", linear->center, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* v = G (x - center), G diagonal or full, of zero trace. The stretching drop v = (-A x, A y) of Monaghan (1994) has the
   rates -A,A. */
static PetscErrorCode StrainSetFromOptions(Body body, OptionItems PetscOptionsObject)
{
  Linear        *linear                    = (Linear *)body->velocity_data;
  const PetscInt dim                       = body->domain->dim;
  PetscReal      number[GRADIENT_SIZE + 1] = {0}, trace = 0, largest = 0;
  PetscInt       count;

  PetscFunctionBegin;
  PetscCall(ReadNumbers(body, PetscOptionsObject, "-strain_rate",
                        "Velocity gradient dv_i/dx_j: its diagonal, or all of it row by row (1/s)", GRADIENT_SIZE + 1,
                        number, &count));
  PetscCheckUser(count == dim || count == dim * dim, body->domain->comm,
                 "-%sstrain_rate must have %" PetscInt_FMT " numbers (the diagonal) or %" PetscInt_FMT, body->prefix,
                 dim, dim * dim);
  for (PetscInt i = 0; i < dim; i++) {
    for (PetscInt j = 0; j < dim; j++) {
      if (count == dim)
        linear->gradient[i][j] = i == j ? number[i] : 0;
      else
        linear->gradient[i][j] = number[i * dim + j];
      largest = PetscMax(largest, PetscAbsReal(linear->gradient[i][j]));
    }
    trace += linear->gradient[i][i];
  }
  PetscCheckUser(PetscAbsReal(trace) <= TRACE_ROUNDING * largest, body->domain->comm,
                 "-%sstrain_rate must not change the volume: its diagonal must sum to 0, not %g 1/s", body->prefix,
                 (double)trace);
  PetscCall(DomainOptionsVector(body->domain, PetscOptionsObject, VECTOR_POINT, "-strain_center",
                                "Point the strain leaves at rest (m)", "Velocity", linear->center, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Simple shear v = rate (n . (x - center)) e with e normal to n; plane Couette flow. */
static PetscErrorCode ShearSetFromOptions(Body body, OptionItems PetscOptionsObject)
{
  Linear   *linear = (Linear *)body->velocity_data;
  PetscReal rate[2], e[DIM] = {1, 0, 0}, n[DIM] = {0, 0, 0};
  PetscInt  count;

  PetscFunctionBegin;
  n[body->domain->dim - 1] = 1;
  PetscCall(ReadNumbers(body, PetscOptionsObject, "-shear_rate", "Shear rate (1/s)", 2, rate, &count));
  PetscCheckUser(count == 1, body->domain->comm, "-%sshear_rate must have one number", body->prefix);
  PetscCall(BodyOptionsAxis(body, PetscOptionsObject, "-shear_direction", "Direction of the flow: x, y, z or a vector",
                            PETSC_FALSE, e));
  PetscCall(BodyOptionsAxis(body, PetscOptionsObject, "-shear_normal",
                            "Direction in which the flow grows: x, y, z or a vector", PETSC_FALSE, n));
  PetscCheckUser(PetscAbsReal(Dot(e, n)) <= TRACE_ROUNDING, body->domain->comm,
                 "-%sshear_direction and -%sshear_normal must be at right angles", body->prefix, body->prefix);
  for (PetscInt i = 0; i < DIM; i++) {
    for (PetscInt j = 0; j < DIM; j++) linear->gradient[i][j] = rate[0] * e[i] * n[j];
  }
  PetscCall(DomainOptionsVector(body->domain, PetscOptionsObject, VECTOR_POINT, "-shear_center",
                                "Point of the plane at rest (m)", "Velocity", linear->center, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

typedef struct {
  PetscReal amplitude;  /* m/s */
  PetscReal wavelength; /* m */
} TaylorGreen;

static PetscErrorCode TaylorGreenSetFromOptions(Body body, OptionItems PetscOptionsObject)
{
  TaylorGreen *vortex = (TaylorGreen *)body->velocity_data;
  PetscReal    amplitude[2];
  PetscInt     count;

  PetscFunctionBegin;
  PetscCall(ReadNumbers(body, PetscOptionsObject, "-taylor_green_amplitude",
                        "Largest velocity of the Taylor-Green vortices (m/s)", 2, amplitude, &count));
  PetscCheckUser(count == 1, body->domain->comm, "-%staylor_green_amplitude must have one number", body->prefix);
  vortex->amplitude  = amplitude[0];
  vortex->wavelength = body->domain->upper[0] - body->domain->lower[0];
  PetscCall(BodyOptionsLength(body, PetscOptionsObject, "-taylor_green_wavelength",
                              "Wavelength of the Taylor-Green vortices, default: the width of the box (m)",
                              &vortex->wavelength));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Taylor & Green (1937), at t = 0 in the plane and constant along z: u = -U cos(2 pi x/L) sin(2 pi y/L), v = U sin(2 pi
   x/L) cos(2 pi y/L). */
static void TaylorGreenAdd(Body body, const PetscReal x[DIM], PetscReal v[DIM])
{
  const TaylorGreen *vortex = (const TaylorGreen *)body->velocity_data;
  const PetscReal    k      = 2 * PETSC_PI / vortex->wavelength;

  v[0] -= vortex->amplitude * PetscCosReal(k * x[0]) * PetscSinReal(k * x[1]);
  v[1] += vortex->amplitude * PetscSinReal(k * x[0]) * PetscCosReal(k * x[1]);
}

#define VELOCITY_TABLE(name, size, setfromoptions, add)                                                                \
  static const VelocityOps *Velocity##name(void)                                                                       \
  {                                                                                                                    \
    static const VelocityOps ops = {size, setfromoptions, add};                                                        \
                                                                                                                       \
    return &ops;                                                                                                       \
  }
VELOCITY_TABLE(Uniform, 0, NULL, NULL)
VELOCITY_TABLE(Rotation, sizeof(Linear), RotationSetFromOptions, LinearAdd)
VELOCITY_TABLE(Strain, sizeof(Linear), StrainSetFromOptions, LinearAdd)
VELOCITY_TABLE(Shear, sizeof(Linear), ShearSetFromOptions, LinearAdd)
VELOCITY_TABLE(TaylorGreen, sizeof(TaylorGreen), TaylorGreenSetFromOptions, TaylorGreenAdd)

PetscErrorCode VelocityRegisterAll(PetscFunctionList *list)
{
  PetscFunctionBegin;
  PetscCall(PetscFunctionListAdd(list, "uniform", VelocityUniform));
  PetscCall(PetscFunctionListAdd(list, "rotation", VelocityRotation));
  PetscCall(PetscFunctionListAdd(list, "strain", VelocityStrain));
  PetscCall(PetscFunctionListAdd(list, "shear", VelocityShear));
  PetscCall(PetscFunctionListAdd(list, "taylor_green", VelocityTaylorGreen));
  PetscFunctionReturn(PETSC_SUCCESS);
}
