/* Implicit viscosity: (1 - dt V) u = v + dt a, V the viscous operator, a all other accelerations of stage one; backward
   Euler. Rows are scaled with the mass, which makes the operator symmetric and positive; it is applied by
   pairs, not assembled. */
#include "stepper_impl.h"

#define VISCOUS_RTOL 1e-8 /* momentum is conserved to about this */

PetscBool ViscosityIsExplicit(Stepper stepper)
{
  return (PetscBool)(SceneHasViscosity(stepper->cloud->scene) && !stepper->viscous.implicit);
}

static const char *const Solvers[] = {"explicit", "implicit", "auto", NULL};

static const OptionRow options[] = {
  {"-viscosity_solver",
   "Explicit, implicit (solver: -viscous_ksp_type ...), or auto: implicit in steps that the explicit limit would "
   "shorten",
   NULL, NULL, ROW_WORD, offsetof(Viscous, choice), .words = Solvers},
  {.name = NULL},
};

PetscErrorCode ViscousSetFromOptions(Stepper stepper, OptionItems PetscOptionsObject)
{
  PetscFunctionBegin;
  stepper->viscous.choice = VISCOUS_AUTO;
  PetscCall(OptionsRead(PetscOptionsObject, options, "StepperSetFromOptions", &stepper->viscous));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ViscousGetKeptKick(Stepper stepper, PetscReal **kick)
{
  Viscous *viscous = &stepper->viscous;

  PetscFunctionBegin;
  if (stepper->cloud->n_fluid > viscous->kick_capacity) {
    viscous->kick_capacity = stepper->cloud->capacity;
    PetscCall(PetscFree(viscous->kept_kick));
    PetscCall(PetscMalloc1(DIM * viscous->kick_capacity, &viscous->kept_kick));
  }
  *kick = viscous->kept_kick;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ViscousHold(Stepper stepper, PetscInt a, const PetscReal v[DIM])
{
  Cloud    cloud   = stepper->cloud;
  Viscous *viscous = &stepper->viscous;

  PetscFunctionBegin;
  if (viscous->held_count == viscous->held_capacity) {
    viscous->held_capacity = cloud->n_fluid;
    PetscCall(PetscRealloc((size_t)viscous->held_capacity * sizeof(*viscous->held), &viscous->held));
    PetscCall(PetscRealloc((size_t)viscous->held_capacity * DIM * sizeof(PetscReal), &viscous->held_star));
  }
  PetscCall(
    PetscArraycpy(viscous->held_star + DIM * viscous->held_count, cloud->field[FIELD_VELOCITY_STAR] + DIM * a, DIM));
  PetscCall(PetscArraycpy(cloud->field[FIELD_VELOCITY] + DIM * a, v, DIM));
  viscous->held[viscous->held_count++] = a;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* u ([n_owned][3]): velocities of the fluid from x (NULL: zero); with 'walls' walls and held liquid have their own,
   else zero. */
static PetscErrorCode Load(Stepper stepper, Vec x, PetscBool walls, PetscReal u[])
{
  const Cloud        cloud   = stepper->cloud;
  const Viscous     *viscous = &stepper->viscous;
  const PetscReal   *v       = cloud->field[FIELD_VELOCITY];
  const PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(u, DIM * cloud->n_owned));
  if (x) {
    PetscCall(VecGetArrayRead(x, &values));
    PetscCall(PetscArraycpy(u, values, DIM * cloud->n_fluid));
    PetscCall(VecRestoreArrayRead(x, &values));
  }
  if (walls)
    PetscCall(
      PetscArraycpy(u + DIM * cloud->n_fluid, v + DIM * cloud->n_fluid, DIM * (cloud->n_owned - cloud->n_fluid)));
  for (PetscInt h = 0; h < viscous->held_count; h++)
    for (PetscInt k = DIM * viscous->held[h]; k < DIM * (viscous->held[h] + 1); k++) u[k] = walls ? v[k] : 0;
  StepHook(stepper, follow, &step, walls, u);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* out ([n_fluid][3], m/s2): viscous acceleration at the velocities of Load. */
static PetscErrorCode ApplyViscosity(Stepper stepper, Vec x, PetscBool walls, PetscReal out[])
{
  Cloud      cloud = stepper->cloud;
  PetscReal *u;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, DIM, &u));
  PetscCall(Load(stepper, x, walls, u));
  PetscCall(OperatorsViscosityApply(cloud, &stepper->viscosity, stepper->viscous.pair, u, out));
  PetscCall(CloudRestoreWork(cloud, &u));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Mass of a particle over that of a particle of the first body, with rings at the far face of the box: rows then have
   the size of a velocity. */
static inline PetscReal Mass(Cloud cloud, PetscInt a)
{
  const PetscReal mass = cloud->rest_density[a] / BodyMaterial(SceneBody(cloud->scene, 0))->density;

  return mass * cloud->weight[a] * (cloud->length[a] / DomainRingLength(cloud->domain, cloud->domain->upper, 1));
}

/* Makes the rows of held liquid y = m x; x = NULL: y = m. */
static void HoldRows(Stepper stepper, const PetscReal x[], PetscReal y[])
{
  const Viscous *viscous = &stepper->viscous;

  for (PetscInt h = 0; h < viscous->held_count; h++) {
    const PetscInt a = viscous->held[h];

    for (PetscInt k = DIM * a; k < DIM * (a + 1); k++) y[k] = Mass(stepper->cloud, a) * (x ? x[k] : 1);
  }
}

/* y = m (x - dt V x), walls and held liquid at rest. */
static PetscErrorCode Multiply(Mat A, Vec x, Vec y)
{
  Stepper            stepper;
  Cloud              cloud;
  const PetscScalar *u;
  PetscScalar       *out;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(A, &stepper));
  cloud = stepper->cloud;
  PetscCall(VecGetArrayWrite(y, &out));
  PetscCall(ApplyViscosity(stepper, x, PETSC_FALSE, out));
  PetscCall(VecGetArrayRead(x, &u));
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    for (PetscInt k = DIM * a; k < DIM * (a + 1); k++) out[k] = Mass(cloud, a) * (u[k] - stepper->viscous.dt * out[k]);
  HoldRows(stepper, u, out);
  PetscCall(VecRestoreArrayWrite(y, &out));
  PetscCall(VecRestoreArrayRead(x, &u));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Diagonal(Mat A, Vec diagonal)
{
  Stepper      stepper;
  Cloud        cloud;
  PetscScalar *d;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(A, &stepper));
  cloud = stepper->cloud;
  PetscCall(VecGetArrayWrite(diagonal, &d));
  PetscCall(OperatorsViscosityDiagonal(cloud, &stepper->viscosity, stepper->viscous.pair, d));
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    for (PetscInt k = DIM * a; k < DIM * (a + 1); k++) d[k] = Mass(cloud, a) * (1 - stepper->viscous.dt * d[k]);
  HoldRows(stepper, NULL, d);
  PetscCall(VecRestoreArrayWrite(diagonal, &d));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Reset(Viscous *viscous)
{
  PetscFunctionBegin;
  PetscCall(SolverReset(&viscous->solver));
  PetscCall(MatDestroy(&viscous->solver.A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ViscousDestroy(Stepper stepper)
{
  PetscFunctionBegin;
  PetscCall(Reset(&stepper->viscous));
  PetscCall(PetscFree(stepper->viscous.pair));
  PetscCall(PetscFree(stepper->viscous.held));
  PetscCall(PetscFree(stepper->viscous.held_star));
  PetscCall(PetscFree(stepper->viscous.kept_kick));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The solver of this local order: CG with Jacobi. Its norm is the preconditioned one, a norm of velocities; the true
   residual is judged in the same norm. */
static PetscErrorCode CreateSolver(Stepper stepper)
{
  Cloud          cloud   = stepper->cloud;
  Viscous       *viscous = &stepper->viscous;
  Solver        *solver  = &viscous->solver;
  const PetscInt n       = DIM * cloud->n_fluid;
  PC             pc;
  PetscBool      known;

  PetscFunctionBegin;
  PetscCall(Reset(viscous));
  viscous->layout = cloud->layout;
  PetscCall(CloudCheckUnknowns(cloud->comm, cloud->n_fluid, DIM, "implicit viscosity (-viscosity_solver)"));
  PetscCall(MatCreateShell(cloud->comm, n, n, PETSC_DETERMINE, PETSC_DETERMINE, stepper, &solver->A));
  PetscCall(MatShellSetOperation(solver->A, MATOP_MULT, (void (*)(void))Multiply));
  PetscCall(MatShellSetOperation(solver->A, MATOP_GET_DIAGONAL, (void (*)(void))Diagonal));
  PetscCall(MatCreateVecs(solver->A, &solver->x, &solver->b));
  solver->name = VISCOUS_EQUATION;
  PetscCall(SolverCreate(cloud->comm, "viscous_", KSP_NORM_DEFAULT, VISCOUS_RTOL, PCJACOBI, solver));
  PetscCall(KSPGetPC(solver->ksp, &pc));
  PetscCall(PetscObjectTypeCompareAny((PetscObject)pc, &known, PCJACOBI, PCNONE, ""));
  PetscCheckUser(known, cloud->comm,
                 "-viscous_pc_type must be " PCJACOBI " or " PCNONE ": the operator of the viscosity is not assembled");
  PetscCall(KSPSetOperators(solver->ksp, solver->A, solver->A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ViscousPrepare(Stepper stepper)
{
  PetscFunctionBegin;
  if (stepper->viscous.choice != VISCOUS_EXPLICIT && SceneHasViscosity(stepper->cloud->scene))
    PetscCall(CreateSolver(stepper));
  PetscCall(Reset(&stepper->viscous)); /* most runs never need its vectors */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* b = m (v* + dt V(0; velocity of walls and held liquid)), x = v, the initial guess. */
static PetscErrorCode RightHandSide(Stepper stepper)
{
  Cloud            cloud   = stepper->cloud;
  Viscous         *viscous = &stepper->viscous;
  const PetscReal *v_star  = cloud->field[FIELD_VELOCITY_STAR];
  PetscScalar     *b, *x;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(viscous->solver.b, &b));
  PetscCall(ApplyViscosity(stepper, NULL, PETSC_TRUE, b));
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    for (PetscInt k = DIM * a; k < DIM * (a + 1); k++) b[k] = Mass(cloud, a) * (v_star[k] + viscous->dt * b[k]);
  HoldRows(stepper, cloud->field[FIELD_VELOCITY], b);
  PetscCall(VecRestoreArrayWrite(viscous->solver.b, &b));
  PetscCall(VecGetArrayWrite(viscous->solver.x, &x));
  PetscCall(PetscArraycpy(x, cloud->field[FIELD_VELOCITY], DIM * cloud->n_fluid));
  PetscCall(VecRestoreArrayWrite(viscous->solver.x, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ViscousSolve(Stepper stepper, PetscReal dt, const PetscReal density[], SolverReport *report)
{
  Cloud            cloud   = stepper->cloud;
  Viscous         *viscous = &stepper->viscous;
  const PetscInt64 pairs   = OperatorsViscosityRoom(cloud);

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_VISCOSITY), 0, 0, 0, 0));
  if (!viscous->solver.ksp || viscous->layout != cloud->layout) PetscCall(CreateSolver(stepper));
  if (pairs > viscous->capacity) {
    viscous->capacity = pairs + pairs / 4;
    PetscCall(PetscFree(viscous->pair));
    PetscCall(PetscMalloc1(viscous->capacity, &viscous->pair));
  }
  viscous->dt         = dt;
  viscous->held_count = 0;
  PetscCall(OperatorsViscosityPairs(cloud, &stepper->viscosity, density, viscous->pair));
  StepHook(stepper, hold, &step);
  PetscCall(RightHandSide(stepper));
  PetscCall(
    MatAssemblyBegin(viscous->solver.A,
                     MAT_FINAL_ASSEMBLY)); /* marks the operator as changed, so that the preconditioner is rebuilt */
  PetscCall(MatAssemblyEnd(viscous->solver.A, MAT_FINAL_ASSEMBLY));
  PetscCall(SolverSolve(&viscous->solver, report));
  PetscCall(Load(stepper, viscous->solver.x, PETSC_TRUE, cloud->field[FIELD_VELOCITY_STAR]));
  PetscCall(CloudUpdate(cloud, FIELD_VELOCITY_STAR));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_VISCOSITY), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void ViscousRelease(Stepper stepper)
{
  const Viscous *viscous = &stepper->viscous;
  PetscReal     *v_star = stepper->cloud->field[FIELD_VELOCITY_STAR], *held_star = viscous->held_star;

  for (PetscInt h = 0; h < viscous->held_count; h++) { /* the others need the velocities that were given */
    PetscReal a[DIM];

    OperatorsViscosityRow(stepper->cloud, &stepper->viscosity, viscous->pair, viscous->held[h], v_star, a);
    for (PetscInt d = 0; d < DIM; d++) held_star[DIM * h + d] += viscous->dt * a[d];
  }
  for (PetscInt h = 0; h < viscous->held_count; h++)
    for (PetscInt d = 0; d < DIM; d++) v_star[DIM * viscous->held[h] + d] = held_star[DIM * h + d];
}
