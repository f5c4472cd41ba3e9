/* Relaxation of the packing to rest, as in Kuri et al.: no body force, damping as an option; the result is cached. */
#include "sim_impl.h"

#define WHY_LENGTH 512

/* Options that cannot change the relaxed positions: output, gauges, the end of the run. All others count, initial
   velocities too, because the scene's speeds set limits. */
static const char *const irrelevant[] = {"series_interval",
                                         "snapshot_interval",
                                         "snapshot_fields",
                                         "snapshot_double",
                                         "snapshot_compression",
                                         "snapshot_walls",
                                         "snapshot_lower",
                                         "snapshot_upper",
                                         "checkpoint_interval",
                                         "checkpoint_wall_clock",
                                         "progress_interval",
                                         "wall_clock_limit",
                                         "time_end",
                                         "steps_max",
                                         "monitor",
                                         "packing_cache",
                                         "log_view",
                                         "gauge_points",
                                         "gauge_heights",
                                         "gauge_lines",
                                         "gauge_line_points",
                                         "gauge_level",
                                         "gauge_crater",
                                         "gauge_crater_radius",
                                         "gauge_jet_radius",
                                         "gauge_droplets",
                                         "gauge_droplet_least",
                                         "gauge_forces",
                                         "gauge_multiplicity",
                                         "gauge_connection",
                                         "gauge_cell",
                                         "gauge_axis",
                                         "gauge_pool"};

/* Whether an option, "-name" or "-name value", is one of these, and not that of a body: -snapshot_lower may be of a
   body 'snapshot'. */
static PetscBool Irrelevant(Scene scene, const char option[])
{
  const char  *name   = option + 1;
  const size_t length = strcspn(name, " \n");

  for (PetscInt b = 0; b < SceneCount(scene) + SceneSolidCount(scene); b++) {
    const char *body = BodyName(b < SceneCount(scene) ? SceneBody(scene, b) : SceneSolid(scene, b - SceneCount(scene)));
    const size_t n   = strlen(body);

    if (!strncmp(name, body, n) && name[n] == '_') return PETSC_FALSE;
  }
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(irrelevant); k++)
    if (strlen(irrelevant[k]) == length && !strncmp(name, irrelevant[k], length)) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Lists all other options in use, one a line. */
static PetscErrorCode DescribeRelaxation(Scene scene, char **how)
{
  char *end;

  PetscFunctionBegin;
  PetscCall(OutputOptions(how));
  end = *how;
  for (const char *line = *how, *next; *line; line = next) {
    next = line + strcspn(line, "\n") + 1; /* each line has its end */
    if (Irrelevant(scene, line)) continue;
    memmove(end, line, (size_t)(next - line));
    end += next - line;
  }
  *end = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

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

PetscErrorCode Relax(Sim sim)
{
  PetscReal      speed = PETSC_MAX_REAL;
  StepState      state = {0};
  ParticleArrays arrays;
  PetscBool      failed, found;
  char           why[WHY_LENGTH], now[TIME_LENGTH], *how;

  PetscFunctionBegin;
  PetscCall(DescribeRelaxation(sim->scene, &how));
  PetscCall(PackingFindRelaxed(sim->packing, how, &found));
  if (!found) {
    PetscCall(StepperSetRelaxation(sim->stepper, PETSC_TRUE, sim->relaxation_damping, sim->relaxation_step));
    PetscCall(ParticlesOpen(sim->particles, &arrays));
    for (PetscInt a = 0; a < arrays.n; a++)
      if (!arrays.integer[INT_LAYER][a]) PetscCall(PetscArrayzero(arrays.real[FIELD_VELOCITY] + DIM * a, DIM));
    PetscCall(ParticlesClose(sim->particles, &arrays));
    PetscCall(CloudResync(sim->cloud));
    ProgressBegin("the relaxation of the packing", "no step of the run was computed");
    while (state.time < sim->relaxation_time && speed > sim->relaxation_speed) {
      PetscCall(ProgressWork(sim->comm, state.time / sim->relaxation_time,
                             "t = %s  step %6" PetscInt_FMT "  dt = %8.3g s", TimeText(sim, state.time, now),
                             state.step, (double)state.time_step));
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
