/* Liquid at rest starts at rest: particles move to places where pressure leaves them, before the first step. */
#include "sim_impl.h"

#define WHY_LENGTH 512
/* rms speed over the scene's own at which the relaxation ends: 0.01 m/s in Kuri et al.'s impact */
#define AT_REST 0.003

/* Root mean square of the speeds of the fluid (m/s), all ranks. */
static PetscErrorCode RmsSpeed(Sim sim, PetscReal *speed)
{
  PetscReal      sum[2] = {0, 0}; /* of squared speeds, and of particles */
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(sim->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscReal *v = arrays.real[FIELD_VELOCITY] + DIM * a;

    if (arrays.integer[INT_LAYER][a]) continue;
    sum[0] += Dot(v, v);
    sum[1] += 1;
  }
  PetscCall(ParticlesClose(sim->particles, &arrays));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPIU_REAL, MPIU_SUM, sim->comm));
  *speed = PetscSqrtReal(sum[0] / PetscMax(sum[1], 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Steps without body force whose velocities are damped, as in Kuri et al., for schemes that settling does not suit. */
static PetscErrorCode Relax(Sim sim)
{
  const PetscReal at_rest = AT_REST * StepperReferenceVelocity(sim->stepper);
  PetscReal       speed   = PETSC_MAX_REAL;
  StepState       state   = {0};
  ParticleArrays  arrays;
  PetscBool       failed;
  char            why[WHY_LENGTH], now[TIME_LENGTH];

  PetscFunctionBegin;
  PetscCall(StepperSetRelaxation(sim->stepper, PETSC_TRUE, sim->relaxation_step));
  PetscCall(ParticlesOpen(sim->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++)
    if (!arrays.integer[INT_LAYER][a]) PetscCall(PetscArrayzero(arrays.real[FIELD_VELOCITY] + DIM * a, DIM));
  PetscCall(ParticlesClose(sim->particles, &arrays));
  PetscCall(CloudResync(sim->cloud));
  ProgressBegin("the relaxation of the packing", "no step of the run was computed");
  while (state.time < sim->relaxation_time && speed > at_rest) {
    PetscCall(ProgressWork(sim->comm, state.time / sim->relaxation_time,
                           "t = %s  step %6" PetscInt_FMT "  dt = %8.3g s", TimeText(sim, state.time, now), state.step,
                           (double)state.time_step));
    PetscCall(StepperAdvance(sim->stepper, sim->relaxation_time, PETSC_FALSE, &state, &failed, why, sizeof(why)));
    PetscCheckUser(!failed, sim->comm, "the relaxation of the packing failed after %" PetscInt_FMT " steps: %s",
                   state.step, why);
    PetscCall(RmsSpeed(sim, &speed));
  }
  PetscCheckUser(state.lost == 0, sim->comm,
                 "%" PetscInt_FMT
                 " particles left the box while the packing relaxed; give the bodies more room to the open faces",
                 state.lost);
  PetscCall(StepperSetRelaxation(sim->stepper, PETSC_FALSE, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode StartAtRest(Sim sim, PetscBool turned)
{
  ParticleArrays arrays;

  PetscFunctionBegin;
  if (sim->relaxation_time > 0 && !turned)
    PetscCall(Relax(sim));
  else if (!StepperRepairsAtOnce(sim->stepper))
    PetscCall(StepperSettle(sim->stepper));
  else
    PetscFunctionReturn(PETSC_SUCCESS);
  /* nothing remains but the positions, at which what liquid carries starts */
  PetscCall(ParticlesOpen(sim->particles, &arrays));
  if (!turned) ParticlesStart(sim->particles, 0, &arrays);
  PetscCall(PetscArrayzero(arrays.real[FIELD_PRESSURE], arrays.n));
  PetscCall(ParticlesClose(sim->particles, &arrays));
  PetscCall(turned ? CloudResync(sim->cloud) : PackingSetVelocities(sim->packing));
  PetscCall(StepperReset(sim->stepper, PETSC_FALSE, &sim->state));
  PetscFunctionReturn(PETSC_SUCCESS);
}
