/* Estimates what a run takes, from trial steps and from a rehearsal of the run with a coarser spacing. */
#include "sim_impl.h"
#include <petsctime.h>

#define TRIAL_LEAST     3     /* trial steps at least */
#define TRIAL_MOST      10000 /* trial steps at most */
#define TRIAL_TIME      1.0   /* s of trial steps at least, as of a rehearsal, which a thin box refuses */
#define TRIAL_LONG      10.   /* s, at most */
#define TRIAL_SHARE     0.04  /* of the run's wall time for trial steps, between these bounds */
#define STEEPEST        1.5   /* most that a step's time grows with the number of particles, over proportional growth */
#define MANY            30 /* with so many steps their mean counts; fewer may still be growing, so their bounds count */
#define SPREAD_LEAST    0.1  /* relative spread of the particle numbers in trial steps that tells their cost */
#define COARSER_LEAST   1.5  /* least ratio of the rehearsal's spacing to the run's */
#define COARSER_MOST    4.   /* largest ratio: drops keep some particles across */
#define REHEARSAL_SHARE 0.05 /* of the run's wall time for a rehearsal */
#define REHEARSAL_TIME  1.0  /* s, at least: in less it is so coarse that it finds a third of the steps too few */
#define REHEARSAL_LONG  15.  /* s, at most */
#define REHEARSED_LEAST 0.05 /* of the run: a shorter rehearsal tells no more than the trial steps */
#define WHY_LENGTH      512

PetscErrorCode CountLiquid(Sim sim, PetscInt *n)
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

/* How long (s) to go on with trial steps, of which k have taken 'all' (s) since the simulated time 'start' (s). */
static double TrialTime(Sim sim, PetscReal start, double all, PetscInt k)
{
  const PetscReal share = sim->time_end < PETSC_MAX_REAL ? (sim->state.time - start) / (sim->time_end - start)
                                                         : (PetscReal)k / sim->steps_max; /* done so far */

  return PetscMin(TRIAL_LONG, PetscMax(TRIAL_TIME, TRIAL_SHARE * all / share));
}

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
    PetscCall(StepperBring(sim->stepper, sim->packing, sim->gauges, PETSC_FALSE, &sim->state));
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
  times->last    = sim->state.time_step;
  sim->state     = before;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The wall time (s) of a step with n liquid particles: proportional to n; if emitters have changed n enough during the
   timed steps, from the straight line through these steps, at most STEEPEST times as steep. */
static PetscReal StepTime(const StepTimes *t, PetscReal n)
{
  const PetscReal mean = t->steps > 0 ? t->n / t->steps : 0, time = t->steps > 0 ? t->time / t->steps : 0,
                  spread = t->steps > 0 ? t->n2 / t->steps - mean * mean : 0;
  PetscReal slope;

  if (mean == 0) return 0;
  slope = spread > PetscSqr(SPREAD_LEAST * mean) ? (t->time_n / t->steps - mean * time) / spread : time / mean;
  return time + PetscMin(PetscMax(slope, 0), STEEPEST * time / mean) * (n - mean);
}

/* The number of liquid particles at the end of the run, if all that emitters bring stays. now: that at the start. */
static PetscReal LastParticles(Sim sim, PetscInt now)
{
  const PetscReal end     = sim->time_end < PETSC_MAX_REAL ? sim->time_end : sim->state.time;
  PetscReal       brought = 0;

  for (PetscInt b = 0; b < SceneCount(sim->scene); b++) {
    const Body body = SceneBody(sim->scene, b);
    PetscInt   n;

    if (!BodyComesLater(body)) continue;
    (void)StepperFilling(sim->stepper, b, &n);
    brought += (PetscReal)n * (BodyFillings(body, end) - BodyFillings(body, sim->state.time));
  }
  return now + brought;
}

/* A span of simulated time (s), and the steps of the run in it. */
typedef struct {
  PetscReal time, steps;
} Span;

/* Sums over the steps of a rehearsal, a run with a coarser spacing. A steady step has the full size that the bounds
   allow; steps after a rejected one are smaller. Early steps are those within the simulated time of the run's own trial
   steps. A span ends when it is longer than all steps ahead of it: 'last' is the span that has not ended, 'before' the
   one ahead of it. */
typedef struct {
  PetscReal time;               /* simulated, s */
  PetscReal mean, end;          /* integral of the run's particles over this time, s; their number at its end */
  PetscReal steps, n;           /* steady steps that the run itself needs for this time; sum of its particles in them */
  PetscReal steady, taken;      /* steady steps that the rehearsal needs for it, and steps that it took */
  PetscReal cost;               /* wall time over the run's particles, s, summed over all steps */
  PetscReal early, early_steps; /* the same, summed over early steps, and their number */
  Span      last, before;
} Rehearsal;

/* Sets the options of the fine and the coarse spacing (m; coarse 0: not graded). */
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

/* Adds a step of the coarse run. dt: its size, s; n: particles that the run itself has at this time; took: wall time,
   s. */
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
  r->mean += dt * n;
  r->end = n;
  r->steady += dt / StepperSteadyStep(coarse->stepper, 1);
  r->taken++;
  r->cost += took / n;
  if (!early) return;
  r->early += took / n;
  r->early_steps++;
}

/* Computes the coarse run to its end, for 'longest' s at most. n: liquid particles of the run at its start; covered:
   simulated time of the trial steps, s. */
static PetscErrorCode RehearseSteps(Sim coarse, PetscReal coarser, PetscInt n, PetscReal covered, double longest,
                                    Rehearsal *r)
{
  const PetscReal begin = coarse->state.time;
  PetscReal       each, more, spent = 0;
  PetscInt        first, now;
  PetscBool       failed = PETSC_FALSE;
  char            why[WHY_LENGTH];

  PetscFunctionBegin;
  PetscCall(CountLiquid(coarse, &first));
  each =
    SceneComesLater(coarse->scene) ? PetscPowReal(coarser, coarse->domain->dim) : (PetscReal)n / PetscMax(1, first);
  /* new ones are at surfaces */
  more = coarse->domain->adaptive ? PetscPowReal(coarser, coarse->domain->dim - 1) : each;
  for (PetscInt k = 0; coarse->state.time < coarse->time_end && spent < (PetscReal)longest; k++) {
    const PetscReal before = coarse->state.time;
    PetscReal       took;
    double          start, end;

    PetscCall(ProgressWork(coarse->comm, (before - begin) / (coarse->time_end - begin), "rehearsal"));
    PetscCall(PetscTime(&start));
    PetscCall(
      StepperAdvance(coarse->stepper, coarse->time_end, PETSC_FALSE, &coarse->state, &failed, why, sizeof(why)));
    if (failed) break;
    PetscCall(StepperBring(coarse->stepper, coarse->packing, coarse->gauges, PETSC_FALSE, &coarse->state));
    PetscCall(CountLiquid(coarse, &now));
    PetscCall(PetscTime(&end));
    took = (PetscReal)(end - start);
    PetscCallMPI(MPI_Bcast(&took, 1, MPIU_REAL, 0, coarse->comm));
    spent += took;
    if (k == 0) continue; /* it sets everything up */
    AddStep(coarse, coarser, coarse->state.time - before, PetscMax(1, first * each + (now - first) * more), took,
            (PetscBool)(before - begin < covered || r->early_steps < TRIAL_LEAST), r);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes a second program from the same options, since its particles must not be those of the run. */
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
  ProgressBegin("the dry run", "nothing is lost"); /* the set-up had set another name */
  PetscCall(RehearseSteps(coarse, coarser, n, covered, longest, r));
  PetscCall(SimDestroy(&coarse));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rehearses the run with a spacing 'coarser' times as large, as far as it gets: a scene may be impossible at this
   spacing. */
static PetscErrorCode Rehearse(Sim sim, PetscReal coarser, PetscInt n, PetscReal covered, double longest, Rehearsal *r)
{
  const Domain   domain = sim->domain;
  PetscErrorCode code;

  PetscFunctionBegin;
  *r = (Rehearsal){0};
  PetscCall(SetSpacing(coarser * domain->spacing, domain->graded ? coarser * domain->spacing_coarse : 0));
  UserErrorsMute(PETSC_TRUE);
  code = RehearseScene(sim, coarser, n, covered, longest, r);
  UserErrorsMute(PETSC_FALSE);
  PetscCall(SetSpacing(domain->spacing, domain->graded ? domain->spacing_coarse : 0));
  PetscCall(ProgressWork(sim->comm, -1, "the rehearsal is over")); /* an interrupt ends the program */
  if (code && code != ISPH_USER_ERROR) PetscFunctionReturn(code);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The estimate from the trial steps alone, the last of which may still grow. */
static RunEstimate Extrapolate(Sim sim, const StepTimes *times, PetscInt n)
{
  const PetscReal step =
    times->late_steps >= MANY ? times->late / times->late_steps : StepperSteadyStep(sim->stepper, 1);
  RunEstimate run = {.start = n, .end = LastParticles(sim, n)};

  run.mean      = 0.5 * (run.start + run.end);
  run.step_time = StepTime(times, run.mean);
  run.steps     = sim->steps_max;
  if (sim->time_end < PETSC_MAX_REAL)
    run.steps = times->steps + 1 + StepperStepsIn(sim->time_end - sim->state.time - times->covered, times->last, step);
  if (sim->steps_max) run.steps = PetscMin(run.steps, (PetscReal)sim->steps_max);
  return run;
}

PetscErrorCode EstimateRun(Sim sim, PetscInt n, const StepTimes *times, RunEstimate *run)
{
  const PetscReal whole = sim->time_end - sim->state.time;
  PetscReal       longest, coarser;
  PetscInt        now;
  Rehearsal       r;

  PetscFunctionBegin;
  PetscCall(CountLiquid(sim, &now));
  *run = Extrapolate(sim, times, n);
  if (times->covered >= whole && times->steps > 0)
    *run = (RunEstimate){times->steps + 1, times->time / times->steps, 1, 0, n, times->n / times->steps, now};
  if (times->covered >= whole || sim->restart[0] || sim->steps_max || !times->steps) PetscFunctionReturn(PETSC_SUCCESS);
  longest = PetscMin(REHEARSAL_LONG, PetscMax(REHEARSAL_TIME, REHEARSAL_SHARE * run->steps * run->step_time));
  coarser = PetscPowReal(2 * run->steps * run->step_time / longest, 1. / (sim->domain->dim + 1));
  coarser = PetscMin(COARSER_MOST, PetscMax(COARSER_LEAST, coarser));
  PetscCall(Rehearse(sim, coarser, n, times->covered, (double)longest, &r));
  run->rehearsed = r.time / whole;
  if (run->rehearsed < REHEARSED_LEAST) PetscFunctionReturn(PETSC_SUCCESS);
  run->coarser = coarser;
  run->steps   = (r.steps + (whole - r.time) * (r.last.steps + r.before.steps) / (r.last.time + r.before.time)) *
               PetscMax(1, r.taken / r.steady);
  /* what the rehearsal has not reached goes on as it did */
  run->end       = PetscMax(0, r.end + (r.end - n) * (whole - r.time) / r.time);
  run->mean      = (r.mean + 0.5 * (r.end + run->end) * (whole - r.time)) / whole;
  run->step_time = StepTime(times, r.n / r.steps) * (r.cost / r.taken) / (r.early / r.early_steps);
  PetscFunctionReturn(PETSC_SUCCESS);
}
