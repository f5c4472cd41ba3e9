#include "sim_impl.h"
#include <petsctime.h>
#include <unistd.h>

#define KEEP 0.02 /* of the time so far: lines that stay on the screen are at least so far apart */

PetscErrorCode ProgressStart(Sim sim, Progress *progress)
{
  PetscFunctionBegin;
  PetscCall(PetscTime(&progress->started));
  progress->printed    = progress->started;
  progress->kept       = progress->started;
  progress->start_time = sim->state.time;
  progress->start_step = sim->state.step;
  progress->terminal   = (PetscBool)isatty(STDOUT_FILENO);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FormatDuration(double seconds, char text[], size_t length)
{
  const int whole = (int)PetscMin(seconds + 0.5, 1e8);

  PetscFunctionBegin;
  if (whole >= 3600)
    PetscCall(PetscSNPrintf(text, length, "%d h %02d min", whole / 3600, whole / 60 % 60));
  else if (whole >= 60)
    PetscCall(PetscSNPrintf(text, length, "%d min %02d s", whole / 60, whole % 60));
  else
    PetscCall(PetscSNPrintf(text, length, "%d s", whole));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ProgressStep(Sim sim, Progress *progress, PetscBool last)
{
  const StepState *state = &sim->state;
  const PetscInt   steps = state->step - progress->start_step;
  PetscInt         due;
  PetscBool        kept;
  double           now;
  char             text[64];

  PetscFunctionBegin;
  progress->iterations += state->iterations;
  PetscCall(PetscTime(&now));
  due = sim->progress_interval > 0 && (last || now - progress->printed >= sim->progress_interval);
  kept =
    (PetscBool)(last || now - progress->kept >= PetscMax(sim->progress_interval, KEEP * (now - progress->started)));
  if (!progress->terminal && !kept) due = 0;
  PetscCallMPI(MPI_Bcast(&due, 1, MPIU_INT, 0, sim->comm)); /* clocks differ between ranks */
  if (due) {
    PetscReal done = (state->time - progress->start_time) / (sim->time_end - progress->start_time);

    if (sim->time_end >= PETSC_MAX_REAL) done = sim->steps_max ? (PetscReal)steps / sim->steps_max : 0;
    PetscCall(FormatDuration((now - progress->started) * (1 / PetscMax(done, 1e-9) - 1), text, sizeof(text)));
    PetscCall(PetscPrintf(sim->comm,
                          "%st = %8.3f ms  step %6" PetscInt_FMT "  dt = %8.3g s  its %3" PetscInt_FMT
                          "  density error %.1e  %3d %%  to go %s%s",
                          progress->terminal ? "\r" : "", (double)state->time * 1e3, state->step,
                          (double)state->time_step, state->iterations, (double)state->density_error, (int)(100 * done),
                          text, progress->terminal && !kept ? "   " : "\n"));
    progress->printed = now;
    if (kept) progress->kept = now;
  }
  if (last && sim->progress_interval > 0) {
    PetscInt n;

    PetscCall(ParticlesGlobalSize(sim->particles, &n));
    PetscCall(FormatDuration(now - progress->started, text, sizeof(text)));
    PetscCall(PetscPrintf(sim->comm,
                          "%" PetscInt_FMT " steps of %" PetscInt_FMT
                          " particles in %s: %.4g s and %.3g iterations a step, %" PetscInt_FMT
                          " steps rolled back, %" PetscInt_FMT " particles left the box\n",
                          steps, n, text, (now - progress->started) / PetscMax(1, steps),
                          (double)progress->iterations / PetscMax(1, steps), state->rejected, state->lost));
    PetscCall(BudgetReport(sim));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
