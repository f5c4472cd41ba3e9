/* The weakly compressible scheme on states whose change is known: Tait's equation, the diffusion of the density, the
   pressure of walls under a liquid at rest. Runs on any number of ranks. */
#include "../../src/stepper/stepper_impl.h"
#include "setup.h"
#include "check.h"

#define H   0.13 /* smoothing length, m */
#define RHO 800. /* kg/m3 */
#define C   20.  /* speed of sound, m/s */
#define SOUND                                                                                                          \
  "-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 3,3 -packing_jitter 0 -bodies a -a_density 800 -a_viscosity 0 " \
  "-scheme weakly_compressible -sound_speed 20 -time_step 1e-4 -pressure_relaxation_time 1e30 "

typedef enum { PARABOLA, EXPANSION, DEPTH } State;

/* The pressure (Pa) or velocity (m/s) that a state has at x. */
static PetscReal Pressure0(State state, const PetscReal x[])
{
  return state == PARABOLA ? 500 * x[0] * x[0] : state == DEPTH ? RHO * 10 * (1 - x[1]) : 0;
}

/* One step of dt (s) from a state; the largest error of the change of the pressure against 'due' (of the pressure
   itself in the two layers of walls that see the liquid), of particles that are further than the kernel's support from
   the edges of a body of 1 m. */
static PetscErrorCode Error(const char options[], State state, PetscReal dt, PetscReal due, PetscReal *error)
{
  StepTrial      trial = {0};
  ParticleArrays arrays;
  Stepper        stepper;
  Setup          s;

  PetscFunctionBegin;
  PetscCall(SetupPack(options, &s));
  PetscCall(PressureCreate(s.cloud, &s.pressure));
  PetscCall(StepperCreate(s.cloud, s.tension, s.pressure, &stepper));
  PetscCall(StepperSetFromOptions(stepper));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscReal *x = arrays.real[FIELD_POSITION] + DIM * a;

    if (arrays.integer[INT_LAYER][a]) continue;
    arrays.real[FIELD_PRESSURE][a]       = Pressure0(state, x);
    arrays.real[FIELD_VELOCITY][DIM * a] = state == EXPANSION ? 10 * x[0] : 0;
  }
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(stepper->ops->step(stepper, dt, &trial));
  *error = 0;
  for (PetscInt a = 0; a < s.cloud->n_owned; a++) {
    const PetscReal *x = s.cloud->field[FIELD_POSITION] + DIM * a, p = s.cloud->field[FIELD_PRESSURE][a];

    if (state == DEPTH) {
      if (s.cloud->integer[INT_LAYER][a] == 1 || s.cloud->integer[INT_LAYER][a] == 2)
        *error = PetscMax(*error, PetscAbsReal(p - Pressure0(state, x)));
    } else if (x[0] > 2 * H && x[0] < 1 - 2 * H && x[1] > 2 * H && x[1] < 1 - 2 * H)
      *error = PetscMax(*error, PetscAbsReal(p - Pressure0(state, x) - due));
  }
  *error = SetupMax(*error);
  PetscCall(StepperDestroy(&stepper));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  const PetscReal dt = 1e-4, tait = RHO * C * C / 7 * (PetscExpReal(-7 * 10 * dt / (1 + 0.5 * 10 * dt)) - 1);
  PetscReal       error = 0;

  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(LogRegister());
  /* delta h c lap p: a lattice gives the Laplacian within a percent */
  PetscCall(Error(SOUND "-a_upper 1,1", PARABOLA, dt, 0.1 * H * C * 1000 * dt, &error));
  CHECK_CLOSE(error / (0.1 * H * C * 1000 * dt), 0, 0.02, "diffusion_of_the_density");
  /* B ((1 + p/B) e^(-7 dt div v) - 1), div v 10 1/s at the start, taken in the middle of the step */
  PetscCall(Error(SOUND "-a_upper 1,1", EXPANSION, dt, tait, &error));
  CHECK_CLOSE(error / tait, 0, 1e-6, "equation_of_state");
  PetscCall(Error(SOUND "-box_x periodic -box_ymin wall -a_upper 3,1 -gravity 0,-10", DEPTH, 1e-9, 0, &error));
  CHECK_CLOSE(error / (RHO * 10), 0, 1e-6, "walls_have_the_weight_above_them");
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
