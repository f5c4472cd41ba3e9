#include "sim_impl.h"
#include <stdio.h>
#include <unistd.h>

#define DOUBT_LENGTH 512 /* bytes of a sentence */

PetscErrorCode ProgressStart(Sim sim, Progress *progress)
{
  PetscFunctionBegin;
  ProgressBegin("the run", "");
  progress->started    = ProgramSeconds();
  progress->start_time = sim->state.time;
  progress->start_step = sim->state.step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The share of the run that is done, 1. */
static PetscReal Done(Sim sim, const Progress *progress)
{
  const PetscInt steps = sim->state.step - progress->start_step;

  if (sim->time_end < PETSC_MAX_REAL)
    return (sim->state.time - progress->start_time) / (sim->time_end - progress->start_time);
  return sim->steps_max ? (PetscReal)steps / sim->steps_max : 0;
}

const char *TimeText(Sim sim, PetscReal time, char text[TIME_LENGTH])
{
  static const char *const units[] = {"s", "ms", "us", "ns"};
  const PetscReal          end     = sim->time_end < PETSC_MAX_REAL ? PetscAbsReal(sim->time_end) : 1e-3;
  PetscReal                factor  = 1;
  size_t                   k       = 0;

  for (; k + 1 < PETSC_STATIC_ARRAY_LENGTH(units) && end * factor < 1; k++) factor *= 1e3;
  (void)snprintf(text, TIME_LENGTH, "%8.3f %s", (double)(time * factor), units[k]);
  return text;
}

/* Says once that a sheet or thread of viscous liquid is underresolved: it tears too early. */
static PetscErrorCode SayUnderresolved(Sim sim, Progress *progress)
{
  char now[TIME_LENGTH];

  PetscFunctionBegin;
  if (progress->underresolved || StepperUnderresolved(sim->stepper) == 0) PetscFunctionReturn(PETSC_SUCCESS);
  progress->underresolved = PETSC_TRUE;
  PetscCall(PetscPrintf(sim->comm,
                        "%st = %s: a sheet or thread of viscous liquid is only one particle thick and tears too "
                        "early there; reduce -spacing\n",
                        isatty(STDOUT_FILENO) ? "\n" : "", TimeText(sim, sim->state.time, now)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Says what an edge of the step finds doubtful about it. */
static PetscErrorCode SayDoubt(Sim sim)
{
  char text[DOUBT_LENGTH], now[TIME_LENGTH];

  PetscFunctionBegin;
  PetscCall(StepperDoubt(sim->stepper, &sim->state, text, sizeof(text)));
  if (text[0])
    PetscCall(PetscPrintf(sim->comm, "%st = %s: %s\n", isatty(STDOUT_FILENO) ? "\n" : "",
                          TimeText(sim, sim->state.time, now), text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What bounds the steps at the end of the run, and what would lift it. */
static PetscErrorCode SayBound(Sim sim)
{
  StepBound      bound[STEP_BOUNDS];
  const PetscInt n = StepperBounds(sim->stepper, bound);

  PetscFunctionBegin;
  if (n == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscPrintf(sim->comm, "steps bounded by %s: %.3g s; %s lifts it", bound[0].cause, (double)bound[0].step,
                        bound[0].lift));
  for (PetscInt k = 1; k < n; k++)
    PetscCall(
      PetscPrintf(sim->comm, "%s%s %.3g s", k == 1 ? "; other bounds: " : ", ", bound[k].cause, (double)bound[k].step));
  PetscCall(PetscPrintf(sim->comm, "\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The open faces by which liquid left since the program's start, " (xmax 12, ymin 3)"; "": by none. */
static void Exits(Cloud cloud, char text[], size_t size)
{
  char one[32];

  text[0] = 0;
  for (PetscInt f = 0; f < 2 * DIM; f++)
    if (cloud->exits[f] > 0) {
      (void)PetscSNPrintf(one, sizeof(one), "%s%s %" PetscInt_FMT, text[0] ? ", " : " (", FaceNames[f / 2][f % 2],
                          cloud->exits[f]);
      TextAppend(text, size, one);
    }
  if (text[0]) TextAppend(text, size, ")");
}

PetscErrorCode ProgressStep(Sim sim, Progress *progress, PetscBool last)
{
  const StepState *state   = &sim->state;
  const PetscInt   steps   = state->step - progress->start_step;
  const double     seconds = ProgramSeconds() - progress->started;
  PetscBool        due;
  char             text[64], now[TIME_LENGTH], by[128];

  PetscFunctionBegin;
  progress->iterations += state->iterations;
  PetscCall(SayUnderresolved(sim, progress));
  PetscCall(SayDoubt(sim));
  PetscCall(ProgressDue(sim->comm, last, &due));
  if (due)
    PetscCall(ProgressPrint(sim->comm, Done(sim, progress),
                            "t = %s  step %6" PetscInt_FMT "  dt = %8.3g s  its %3" PetscInt_FMT "  density error %.1e",
                            TimeText(sim, state->time, now), state->step, (double)state->time_step, state->iterations,
                            (double)state->density_error));
  if (last) {
    PetscInt n;

    PetscCall(ParticlesGlobalSize(sim->particles, &n));
    PetscCall(FormatDuration(seconds, text, sizeof(text)));
    Exits(sim->cloud, by, sizeof(by));
    PetscCall(PetscPrintf(sim->comm,
                          "%" PetscInt_FMT " steps of %" PetscInt_FMT
                          " particles in %s: %.4g s and %.3g iterations a step, %" PetscInt_FMT
                          " steps rolled back, %" PetscInt_FMT " particles left through open faces%s\n",
                          steps, n, text, seconds / PetscMax(1, steps),
                          (double)progress->iterations / PetscMax(1, steps), state->rejected, state->lost, by));
    PetscCall(SayBound(sim));
    PetscCall(BudgetReport(sim));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
