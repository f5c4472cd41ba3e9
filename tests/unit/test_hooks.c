/* What an edge may add to a step: its hooks are called in their order, its force acts, its bound binds, its sums are
   those of all ranks. Runs on any number of ranks. */
#include "../../src/stepper/stepper_impl.h"
#include "check.h"
#include "setup.h"
#include <string.h>

#define SPY   "spy"
#define PUSH  3.   /* m/s2 */
#define BOUND 1e-4 /* s */
#define CALLS 64

static size_t   calls[CALLS]; /* offsets of the hooks in an Edge */
static PetscInt count;

static void Heard(size_t hook)
{
  if (count < CALLS) calls[count++] = hook;
}

#define HEARD(hook, ...)                                                                                               \
  static PetscErrorCode Spy_##hook(__VA_ARGS__)                                                                        \
  {                                                                                                                    \
    PetscFunctionBegin;                                                                                                \
    Heard(offsetof(Edge, hook));                                                                                       \
    PetscFunctionReturn(PETSC_SUCCESS);                                                                                \
  }

HEARD(check, const Step *step, PetscBool ahead, char why[], size_t length)
HEARD(save, const Step *step)
HEARD(restore, const Step *step)
HEARD(drift, const Step *step, PetscReal from, PetscReal to, PetscReal end, PetscBool *moved)
HEARD(diagnose, const Step *step)
HEARD(thicken, const Step *step)
HEARD(tense, const Step *step)
HEARD(surround, const Step *step)
HEARD(hold, const Step *step)
HEARD(follow, const Step *step, PetscBool own, PetscReal u[])
HEARD(drag, const Step *step, const PetscReal velocity[])
HEARD(predict, const Step *step)
HEARD(work, const Step *step, PetscReal mean[])
HEARD(shifted, const Step *step, const PetscReal moved[])
HEARD(guard, const Step *step)

static PetscErrorCode Spy_force(const Step *step)
{
  PetscReal *a = step->cloud->field[FIELD_ACCELERATION];

  PetscFunctionBegin;
  Heard(offsetof(Edge, force));
  for (PetscInt k = 0; k < step->cloud->n_fluid; k++) a[DIM * k] += PUSH;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Spy_kick(const Step *step)
{
  PetscFunctionBegin;
  Heard(offsetof(Edge, kick));
  step->sums[1] += 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Spy_commit(const Step *step, StepState *state)
{
  PetscMPIInt size;

  PetscFunctionBegin;
  Heard(offsetof(Edge, commit));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  CHECK(step->sums[0] == 0 && step->sums[1] == size, "sums of one trial, of all ranks");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Spy_bound(const Step *step, PetscReal scale, StepBound *bound)
{
  *bound = (StepBound){"spy", "a spy", BOUND * scale, "nothing"};
}

static const Edge        Spy     = {.name     = SPY,
                                    .sums     = 2,
                                    .bound    = Spy_bound,
                                    .check    = Spy_check,
                                    .save     = Spy_save,
                                    .restore  = Spy_restore,
                                    .drift    = Spy_drift,
                                    .diagnose = Spy_diagnose,
                                    .thicken  = Spy_thicken,
                                    .force    = Spy_force,
                                    .tense    = Spy_tense,
                                    .surround = Spy_surround,
                                    .hold     = Spy_hold,
                                    .follow   = Spy_follow,
                                    .drag     = Spy_drag,
                                    .predict  = Spy_predict,
                                    .work     = Spy_work,
                                    .kick     = Spy_kick,
                                    .shifted  = Spy_shifted,
                                    .guard    = Spy_guard,
                                    .commit   = Spy_commit};
static const Edge *const spies[] = {&Spy, NULL};

/* Of the fluid, kg m/s over kg. */
static PetscReal MeanVelocity(Cloud cloud)
{
  PetscReal v = 0;

  for (PetscInt a = 0; a < cloud->n_fluid; a++) v += cloud->field[FIELD_VELOCITY][DIM * a];
  return SetupSum(v) / SetupSum(cloud->n_fluid);
}

int main(int argc, char **argv)
{
  Setup     s;
  Stepper   stepper;
  StepState state = {0};
  StepBound bounds[STEP_BOUNDS];
  PetscBool failed;
  PetscReal before;
  char      why[256];

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(
    SetupPack("-dimension 2 -spacing 0.1 -box_lower -1,-1 -box_upper 1,1 -bodies drop -drop_shape sphere "
              "-drop_radius 0.6 -drop_viscosity 10 -drop_tension 0.1 -viscosity_solver implicit -time_step_max 1 ",
              &s));
  PetscCall(PressureCreate(s.cloud, &s.pressure));
  PetscCall(StepperCreate(s.cloud, s.tension, s.pressure, &stepper));
  PetscCall(StepEdgesDestroy(stepper));
  stepper->edges = spies;
  PetscCall(StepEdgesCreate(stepper));
  PetscCall(StepperSetFromOptions(stepper));
  PetscCall(StepperPrepare(stepper));
  PetscCall(StepperMeasure(stepper, &state));
  before = MeanVelocity(s.cloud);
  count  = 0;
  PetscCall(StepperAdvance(stepper, 1, PETSC_FALSE, &state, &failed, why, sizeof(why)));
  CHECK(!failed, why);
  CHECK_CLOSE(state.time_step, BOUND, 1e-15, "its bound binds");
  CHECK(StepperBounds(stepper, bounds) > 1 && !strcmp(bounds[0].name, "spy"), "and is told");
  CHECK_CLOSE(StepperSteadyStep(stepper, 2), 2 * BOUND, 1e-15, "with a larger spacing");
  CHECK_CLOSE((MeanVelocity(s.cloud) - before) / state.time_step, PUSH, 1e-6 * PUSH, "its force acts");
  CHECK(stepper->reached == offsetof(Edge, guard), "the order of the hooks is kept");
  stepper->trying = PETSC_TRUE;
  PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  CHECK(StepInOrder(stepper, offsetof(Edge, guard)) == 0 && StepInOrder(stepper, offsetof(Edge, restore)) == 0 &&
          StepInOrder(stepper, offsetof(Edge, kick)) == 0 && StepInOrder(stepper, offsetof(Edge, force)) != 0,
        "another order of the hooks than that of the record is refused");
  PetscCall(PetscPopErrorHandler());
  for (size_t hook = offsetof(Edge, check); hook <= offsetof(Edge, commit); hook += sizeof(void (*)(void))) {
    PetscBool heard = (PetscBool)(hook == offsetof(Edge, push)); /* there is no solid */

    for (PetscInt k = 0; k < count; k++) heard = (PetscBool)(heard || calls[k] == hook);
    CHECK(heard, "every hook of a step is called");
  }
  PetscCall(StepperDestroy(&stepper));
  PetscCall(SetupClose(&s));
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
