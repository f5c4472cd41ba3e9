/* What a run takes, before it runs: steps are tried, and the run is rehearsed with a coarser spacing. */
#include "sim_impl.h"
#include <petsctime.h>

#define TRIAL_LEAST     3     /* steps that are computed to tell the time */
#define TRIAL_MOST      10000 /* of them */
#define TRIAL_TIME      2.0   /* s, that they take at least, if they are quick */
#define TRIAL_LONG      10.   /* s, at most */
#define TRIAL_SHARE     0.1   /* of the whole run's time, in between */
#define STEEPEST        1.5   /* times in proportion */
#define MANY            30  /* of so many steps the mean counts, of fewer what bounds them: they may still be growing */
#define SPREAD_LEAST    0.1 /* standard deviation of the numbers of particles in them that shows what one costs */
#define COARSER_LEAST   1.5 /* spacings of a rehearsal */
#define COARSER_MOST    4.  /* of them: drops keep some particles across */
#define REHEARSAL_SHARE 0.05 /* of the run's time that a rehearsal is to take */
#define REHEARSAL_LONG  15.  /* s, at most */
#define REHEARSED_LEAST 0.05 /* of the run, to tell more of it than the trial steps */
#define WHY_LENGTH      512

/* Particles of liquid, of all ranks. */
static PetscErrorCode CountLiquid(Sim sim, PetscInt *n)
{
  ParticleArrays arrays;

  PetscFunctionBegin;
  *n = 0;
  PetscCall(ParticlesOpen(sim->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) *n += arrays.integer[INT_LAYER][a] == 0;
  PetscCall(ParticlesClose(sim->particles, &arrays));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, n, 1, MPIU_INT, MPI_SUM, sim->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How long (s) steps are tried of which k have taken 'all' (s), since the time 'start' of the run (s). */
static double TrialTime(Sim sim, PetscReal start, double all, PetscInt k)
{
  const PetscReal share = sim->time_end < PETSC_MAX_REAL ? (sim->state.time - start) / (sim->time_end - start)
                                                         : (PetscReal)k / sim->steps_max; /* of the run that is done */

  return PetscMin(TRIAL_LONG, PetscMax(TRIAL_TIME, TRIAL_SHARE * all / share));
}

/* Computes some steps for their time, with what emitters bring. */
PetscErrorCode TrySteps(Sim sim, StepTimes *times)
{
  const StepState before = sim->state;
  const PetscInt  most   = sim->steps_max ? PetscMax(TRIAL_LEAST, PetscMin(TRIAL_MOST, sim->steps_max)) : TRIAL_MOST;

  double    all = 0, start, now;
  PetscBool failed;
  PetscReal step[TRIAL_MOST + 1] = {0};
  char      why[512];

  PetscFunctionBegin;
  *times = (StepTimes){0};
  for (PetscInt k = 0; k < most && sim->state.time < sim->time_end; k++) {
    PetscInt  n;
    PetscReal took;

    if (k >= TRIAL_LEAST && all > TrialTime(sim, before.time, all, k)) break;
    PetscCall(ProgressWork(sim->comm, PetscMin(1, (PetscReal)all / TRIAL_LONG), "trial step"));
    PetscCall(PetscTime(&start));
    PetscCall(StepperAdvance(sim->stepper, sim->time_end, PETSC_FALSE, &sim->state, &failed, why, sizeof(why)));
    PetscCheckUser(!failed, sim->comm, "the first steps of the scene fail: %s", why);
    PetscCall(SimEmit(sim));
    PetscCall(PetscTime(&now));
    took = (PetscReal)(now - start);
    PetscCallMPI(MPI_Bcast(&took, 1, MPIU_REAL, 0, sim->comm));
    PetscCall(CountLiquid(sim, &n));
    all += (double)took;
    if (k == 0) continue; /* it sets everything up */
    times->steps++;
    times->n += n;
    times->n2 += (PetscReal)n * n;
    times->time += took;
    times->time_n += took * n;
    step[k] = sim->state.time_step;
  }
  for (PetscInt k = (PetscInt)times->steps / 2 + 1; k <= (PetscInt)times->steps; k++) {
    times->late_steps++;
    times->late += step[k];
  }
  times->covered = sim->state.time - before.time;
  sim->state     = before;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The time (s) of a step with n particles of liquid: along the straight line through the steps that were timed, if
   emitters have made their numbers differ enough, but not much steeper than in proportion; else in proportion. */
static PetscReal StepTime(const StepTimes *t, PetscReal n)
{
  const PetscReal mean = t->steps > 0 ? t->n / t->steps : 0, time = t->steps > 0 ? t->time / t->steps : 0,
                  spread = t->steps > 0 ? t->n2 / t->steps - mean * mean : 0;
  PetscReal slope;

  if (mean == 0) return 0;
  slope = spread > PetscSqr(SPREAD_LEAST * mean) ? (t->time_n / t->steps - mean * time) / spread : time / mean;
  return time + PetscMin(PetscMax(slope, 0), STEEPEST * time / mean) * (n - mean);
}

/* The mean number of particles of liquid in the run, if what emitters bring stays; now: at its start. */
static PetscReal MeanParticles(Sim sim, PetscInt now)
{
  const PetscReal end = sim->time_end < PETSC_MAX_REAL ? sim->time_end : sim->state.time;

  if (!SceneEmits(sim->scene)) return now;
  return now + 0.5 * (PackingEmitted(sim->packing, end) - PackingEmitted(sim->packing, sim->state.time));
}

/* Time (s) and steps of the run in it. */
typedef struct {
  PetscReal time, steps;
} Span;

/* Sums over the steps of a rehearsal: how many steady steps the run would take in their place, and with how many
   particles; how many steady ones the rehearsal would take and how many it took, which differ by those that follow a
   rejected one; and the time they took a particle, all of them and the early ones, which are as the trial steps of the
   run. last, before: two spans at its end, the former up to half of all, the latter as long as all before it. */
typedef struct {
  PetscReal time, steps, n;           /* s, 1, 1: the last one of all steps together */
  PetscReal steady, taken;            /* 1, 1 */
  PetscReal cost, early, early_steps; /* s, s, 1 */
  Span      last, before;
} Rehearsal;

/* Spacings, fine and coarse (m; coarse 0: not graded), as options. */
static PetscErrorCode SetSpacing(PetscReal spacing, PetscReal coarse)
{
  char text[64];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(text, sizeof(text), "%.17g", (double)spacing));
  PetscCall(PetscOptionsSetValue(NULL, "-spacing", text));
  if (coarse == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(text, sizeof(text), "%.17g", (double)coarse));
  PetscCall(PetscOptionsSetValue(NULL, "-spacing_coarse", text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds a step of the coarse run. dt: s; n: particles that the run has now; took: s. */
static void AddStep(Sim coarse, PetscReal coarser, PetscReal dt, PetscReal n, PetscReal took, PetscBool early,
                    Rehearsal *r)
{
  const PetscReal steps = dt / StepperSteadyStep(coarse->stepper, 1 / coarser);

  if (r->last.time > 0.5 * r->time) {
    r->before = r->last;
    r->last   = (Span){0};
  }
  r->last.time += dt;
  r->last.steps += steps;
  r->time += dt;
  r->steps += steps;
  r->n += steps * n;
  r->steady += dt / StepperSteadyStep(coarse->stepper, 1);
  r->taken++;
  r->cost += took / n;
  if (!early) return;
  r->early += took / n;
  r->early_steps++;
}

/* Steps of the coarse run to its end, for 'longest' s at most. n: particles of liquid of the run at its start; covered:
   what the trial steps went, s. */
static PetscErrorCode RehearseSteps(Sim coarse, PetscReal coarser, PetscInt n, PetscReal covered, double longest,
                                    Rehearsal *r)
{
  const PetscReal begin = coarse->state.time;
  PetscReal       each, spent = 0;
  PetscInt        now;
  PetscBool       failed = PETSC_FALSE;
  char            why[WHY_LENGTH];

  PetscFunctionBegin;
  PetscCall(CountLiquid(coarse, &now));
  each = SceneEmits(coarse->scene) ? PetscPowReal(coarser, coarse->domain->dim) : (PetscReal)n / PetscMax(1, now);
  for (PetscInt k = 0; coarse->state.time < coarse->time_end && spent < (PetscReal)longest; k++) {
    const PetscReal before = coarse->state.time;
    PetscReal       took;
    double          start, end;

    PetscCall(ProgressWork(coarse->comm, (before - begin) / (coarse->time_end - begin), "rehearsal"));
    PetscCall(PetscTime(&start));
    PetscCall(
      StepperAdvance(coarse->stepper, coarse->time_end, PETSC_FALSE, &coarse->state, &failed, why, sizeof(why)));
    if (failed) break;
    PetscCall(SimEmit(coarse));
    PetscCall(CountLiquid(coarse, &now));
    PetscCall(PetscTime(&end));
    took = (PetscReal)(end - start);
    PetscCallMPI(MPI_Bcast(&took, 1, MPIU_REAL, 0, coarse->comm));
    spent += took;
    if (k == 0) continue; /* it sets everything up */
    AddStep(coarse, coarser, coarse->state.time - before, (PetscReal)PetscMax(1, now) * each, took,
            (PetscBool)(before - begin < covered || r->early_steps < TRIAL_LEAST), r);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A second program of the same options: the particles of its scene must not be those of the run. */
static PetscErrorCode RehearseScene(Sim sim, PetscReal coarser, PetscInt n, PetscReal covered, double longest,
                                    Rehearsal *r)
{
  Sim       coarse;
  PetscBool stop;

  PetscFunctionBegin;
  PetscCall(SimCreate(sim->comm, &coarse));
  PetscCall(SimSetFromOptions(coarse, &stop));
  coarse->relaxation_time = 0;
  PetscCall(SimSetUp(coarse));
  ProgressBegin("the dry run", "nothing is lost"); /* the set-up has given its own name to the work */
  PetscCall(RehearseSteps(coarse, coarser, n, covered, longest, r));
  PetscCall(SimDestroy(&coarse));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The run with a spacing 'coarser' times as large, as far as it comes: a scene may not be possible so coarse. */
static PetscErrorCode Rehearse(Sim sim, PetscReal coarser, PetscReal covered, double longest, Rehearsal *r)
{
  const Domain   domain = sim->domain;
  PetscErrorCode code;
  PetscInt       n;

  PetscFunctionBegin;
  *r = (Rehearsal){0};
  PetscCall(CountLiquid(sim, &n));
  PetscCall(SetSpacing(coarser * domain->spacing, domain->graded ? coarser * domain->spacing_coarse : 0));
  UserErrorsMute(PETSC_TRUE);
  code = RehearseScene(sim, coarser, n, covered, longest, r);
  UserErrorsMute(PETSC_FALSE);
  PetscCall(SetSpacing(domain->spacing, domain->graded ? domain->spacing_coarse : 0));
  PetscCall(ProgressWork(sim->comm, -1, "the rehearsal is over")); /* an interrupt ends the program */
  if (code && code != ISPH_USER_ERROR) PetscFunctionReturn(code);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the trial steps say alone. */
static RunEstimate Extrapolate(Sim sim, const StepTimes *times, PetscInt n)
{
  const PetscReal step =
    times->late_steps >= MANY ? times->late / times->late_steps : StepperSteadyStep(sim->stepper, 1);
  RunEstimate run = {.step_time = StepTime(times, MeanParticles(sim, n))};

  run.steps = sim->time_end < PETSC_MAX_REAL ? (sim->time_end - sim->state.time) / step : sim->steps_max;
  if (sim->steps_max) run.steps = PetscMin(run.steps, (PetscReal)sim->steps_max);
  return run;
}

PetscErrorCode EstimateRun(Sim sim, const StepTimes *times, RunEstimate *run)
{
  const PetscReal whole = sim->time_end - sim->state.time;
  PetscReal       longest, coarser;
  PetscInt        n;
  Rehearsal       r;

  PetscFunctionBegin;
  PetscCall(CountLiquid(sim, &n));
  *run = Extrapolate(sim, times, n);
  if (times->covered >= whole && times->steps > 0)
    *run = (RunEstimate){.steps = times->steps + 1, .step_time = times->time / times->steps, .rehearsed = 1};
  if (times->covered >= whole || sim->restart[0] || sim->steps_max || !times->steps) PetscFunctionReturn(PETSC_SUCCESS);
  longest = PetscMin(REHEARSAL_LONG, PetscMax(TRIAL_TIME, REHEARSAL_SHARE * run->steps * run->step_time));
  coarser = PetscPowReal(2 * run->steps * run->step_time / longest, 1. / (sim->domain->dim + 1));
  coarser = PetscMin(COARSER_MOST, PetscMax(COARSER_LEAST, coarser));
  PetscCall(Rehearse(sim, coarser, times->covered, (double)longest, &r));
  run->rehearsed = r.time / whole;
  if (run->rehearsed < REHEARSED_LEAST) PetscFunctionReturn(PETSC_SUCCESS);
  run->coarser = coarser;
  run->steps   = (r.steps + (whole - r.time) * (r.last.steps + r.before.steps) / (r.last.time + r.before.time)) *
               PetscMax(1, r.taken / r.steady);
  run->step_time = StepTime(times, r.n / r.steps) * (r.cost / r.taken) / (r.early / r.early_steps);
  PetscFunctionReturn(PETSC_SUCCESS);
}
