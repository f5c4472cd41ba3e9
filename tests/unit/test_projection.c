/* Projecting a velocity again and again at fixed positions must not enlarge it: of liquid whose surface layers are as
   crowded as where two fronts meet. Runs on any number of ranks. */
#include "setup.h"
#include "check.h"

#define SCENE                                                                                                          \
  "-dimension 2 -spacing 1 -box_lower -20,-20 -box_upper 20,20 -bodies a -ksp_rtol 1e-12 -pressure_relaxation_time "   \
  "1e30 "
#define SIDE     11  /* spacings wide */
#define DEEP     5   /* layers at rest */
#define ALONG    0.7 /* spacings between the particles of the crowded layer */
#define ABOVE    0.6 /* spacings that it is above the others */
#define REPEATED 12

/* A block of SIDE by DEEP particles on a lattice, a crowded layer on it. Returns how many. */
static PetscInt Crowd(PetscReal x[][DIM])
{
  const PetscInt crowded = (PetscInt)((SIDE - 1) / ALONG) + 1;
  PetscInt       n       = 0;

  for (PetscInt k = 0; k < SIDE * DEEP; k++, n++) {
    x[n][0] = k % SIDE - 0.5 * (SIDE - 1);
    x[n][1] = -k / SIDE;
    x[n][2] = 0;
  }
  for (PetscInt k = 0; k < crowded; k++, n++) {
    x[n][0] = (k - 0.5 * (crowded - 1)) * ALONG;
    x[n][1] = ABOVE;
    x[n][2] = 0;
  }
  return n;
}

static PetscReal Length(Cloud cloud)
{
  PetscReal sum = 0;

  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) sum += PetscSqr(cloud->field[FIELD_VELOCITY_STAR][k]);
  return PetscSqrtReal(SetupSum(sum));
}

static PetscErrorCode TestCrowd(const char gradient[])
{
  const PetscReal dt = 1e-3; /* s; without meaning here */
  PetscReal       x[2 * SIDE * (DEEP + 1)][DIM], first, *v, *acceleration;
  PressureResult  result;
  char            name[96];
  Setup           s;

  PetscFunctionBegin;
  PetscCall(SetupFill(SCENE, Crowd(x), &x[0][0], 0, &s));
  PetscCall(SetupMoments(&s));
  PetscCall(PetscArrayzero(s.cloud->field[FIELD_CAPILLARY], s.cloud->n_owned));
  PetscCall(PetscArrayzero(s.cloud->field[FIELD_CAPILLARY_SLOPE], DIM * s.cloud->n_owned));
  PetscCall(PressureCreate(s.cloud, &s.pressure));
  PetscCall(PressureSetTypes(s.pressure, SOURCE_DIVERGENCE, CLOSURE_FULL, gradient, PETSC_FALSE));
  PetscCall(PressureSetFromOptions(s.pressure));
  v = s.cloud->field[FIELD_VELOCITY_STAR];
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
    for (PetscInt d = 0; d < DIM; d++)
      v[DIM * a + d] = d < 2 ? RandomUnit(3, (unsigned long long)(DIM * s.cloud->integer[INT_ID][a] + d)) - 0.5 : 0;
  first = Length(s.cloud);
  for (PetscInt k = 0; k < REPEATED; k++) {
    PetscCall(SetupDivergence(&s));
    PetscCall(PressureSolve(s.pressure, dt, &result));
    PetscCall(CloudGetWork(s.cloud, DIM, &acceleration));
    PetscCall(PressureAcceleration(s.pressure, acceleration));
    for (PetscInt l = 0; l < DIM * s.cloud->n_fluid; l++) v[l] += dt * acceleration[l];
    PetscCall(CloudRestoreWork(s.cloud, &acceleration));
  }
  PetscCall(PetscSNPrintf(name, sizeof(name), "crowded_surface_%s", gradient));
  CHECK_CLOSE(Length(s.cloud) / first, 0.5, 0.5, name); /* 1e8 times as long without -pressure_closure_least */
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(TestCrowd(GRADIENT_SYMMETRIC));
  PetscCall(TestCrowd(GRADIENT_CORRECTED));
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
