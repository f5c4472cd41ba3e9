/* Relaxation of the packing to rest, as in Kuri et al.: no body force, velocities damped if asked; the result is
 * cached. */
#include "sim_impl.h"

#define WHY_LENGTH 512

/* Options that the relaxed positions do not depend on. */
static const char *const irrelevant[] = {"output_",       "snapshot_",  "series_",  "checkpoint_", "gauge_",
                                         "progress_",     "time_start", "time_end", "steps_max",   "restart",
                                         "log_",          "options_",   "monitor",  "dry_run",     "velocity",
                                         "packing_cache", "wall_clock"};

/* All other options in use, as one text. */
static PetscErrorCode DescribeRelaxation(char **how)
{
  char  *all, *token;
  size_t length;
  char   before;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetAll(NULL, &all));
  PetscCall(PetscStrlen(all, &length));
  PetscCall(PetscCalloc1(length + 1, how));
  token = all;
  while (*token) {
    char     *end  = token + 1, *found;
    PetscBool skip = PETSC_FALSE;

    /* an option reaches to the next " -" that starts a name */
    while (*end &&
           !(end[0] == ' ' && end[1] == '-' && ((end[2] >= 'a' && end[2] <= 'z') || (end[2] >= 'A' && end[2] <= 'Z'))))
      end++;
    before = *end;
    *end   = 0;
    for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(irrelevant) && !skip; k++) {
      PetscCall(PetscStrstr(token, irrelevant[k], &found));
      skip = (PetscBool)(found != NULL);
    }
    if (!skip) PetscCall(PetscStrlcat(*how, token, length + 1));
    *end  = before;
    token = before ? end + 1 : end;
  }
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Root mean square of the speeds of the fluid (m/s), all ranks. */
static PetscErrorCode RmsSpeed(Sim sim, PetscReal *speed)
{
  PetscReal      sum[2] = {0, 0}; /* of squares, of particles */
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

PetscErrorCode Relax(Sim sim)
{
  PetscReal      speed = PETSC_MAX_REAL;
  StepState      state = {0};
  ParticleArrays arrays;
  PetscBool      failed, found;
  char           why[WHY_LENGTH], *how;

  PetscFunctionBegin;
  PetscCall(DescribeRelaxation(&how));
  PetscCall(PackingFindRelaxed(sim->packing, how, &found));
  if (!found) {
    PetscCall(StepperSetRelaxation(sim->stepper, PETSC_TRUE, sim->relaxation_damping, sim->relaxation_step));
    PetscCall(ParticlesOpen(sim->particles, &arrays));
    for (PetscInt a = 0; a < arrays.n; a++)
      if (!arrays.integer[INT_LAYER][a]) PetscCall(PetscArrayzero(arrays.real[FIELD_VELOCITY] + DIM * a, DIM));
    PetscCall(ParticlesClose(sim->particles, &arrays));
    PetscCall(CloudResync(sim->cloud));
    while (state.time < sim->relaxation_time && speed > sim->relaxation_speed) {
      PetscCall(StepperAdvance(sim->stepper, sim->relaxation_time, PETSC_FALSE, &state, &failed, why, sizeof(why)));
      PetscCheckUser(!failed, sim->comm, "the relaxation of the packing failed after %" PetscInt_FMT " steps: %s",
                     state.step, why);
      if (sim->relaxation_speed > 0) PetscCall(RmsSpeed(sim, &speed));
    }
    PetscCheckUser(state.lost == 0, sim->comm,
                   "%" PetscInt_FMT
                   " particles left the box while the packing relaxed; give the bodies more room to the open faces",
                   state.lost);
    PetscCall(StepperSetRelaxation(sim->stepper, PETSC_FALSE, 1, 0));
    PetscCall(PackingKeepRelaxed(sim->packing, how));
  }
  PetscCall(PetscFree(how));
  sim->report.cached = (PetscBool)(sim->report.cached || found);
  /* no start value from the relaxation, so that a run from the cache does the same */
  PetscCall(ParticlesOpen(sim->particles, &arrays));
  PetscCall(PetscArrayzero(arrays.real[FIELD_PRESSURE], arrays.n));
  PetscCall(ParticlesClose(sim->particles, &arrays));
  PetscCall(PackingSetVelocities(sim->packing));
  PetscCall(StepperReset(sim->stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}
