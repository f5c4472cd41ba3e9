/* One projection: sets up the equation at the positions of the cloud, solves it, and decides when to rebuild the
   preconditioner. */
#include "pressure_impl.h"

#define DEFAULT_RTOL      1e-3
#define DEFAULT_GAMG_DROP 0.01 /* threshold that keeps the coarse grids of these 80-point rows small */
#define REBUILD_GROWTH    1.5  /* growth of the iterations at which the preconditioner is rebuilt */
#define REBUILD_SLACK     3    /* iterations that a kept preconditioner may cost beyond this growth */
#define REBUILD_CHEAP     10   /* steps to keep a preconditioner whose set-up costs a few iterations */
#define REBUILD_DEAR      50   /* steps to keep any other preconditioner */

static PetscErrorCode DefaultOption(const char name[], const char value[])
{
  PetscBool set;

  PetscFunctionBegin;
  PetscCall(PetscOptionsHasName(NULL, NULL, name, &set));
  if (!set) PetscCall(PetscOptionsSetValue(NULL, name, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureReset(Pressure pressure)
{
  PetscFunctionBegin;
  PetscCall(SolverReset(&pressure->solver));
  PetscCall(MatDestroy(&pressure->operator));
  PetscCall(MatDestroy(&pressure->coupled));
  pressure->kept    = KEPT_NONE;
  pressure->rebuild = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses to show the entries of a matrix without entries, before the KSP reads its options, when PETSc empties the
   file. */
static PetscErrorCode CheckViews(Pressure pressure)
{
  const struct {
    const char *option;
    PetscBool   entries;
  } views[] = {{"-ksp_view_mat", (PetscBool)(pressure->assembled && !pressure->low_ranks)},
               {"-ksp_view_pmat", pressure->assembled}};
  PetscBool set;

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(views); k++) {
    PetscCall(PetscOptionsHasName(NULL, NULL, views[k].option, &set));
    PetscCheckUser(
      !set || views[k].entries, pressure->cloud->comm,
      "%s has nothing to show: the matrix is a sum of pairs without entries; with -mat_type aij %s shows them",
      views[k].option, pressure->low_ranks ? "-ksp_view_pmat" : "it");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives the two-level preconditioner the positions of the rows. Other preconditioners would use coordinates for rigid
   modes of elasticity. */
static PetscErrorCode LocateRows(Pressure pressure)
{
  Cloud      cloud  = pressure->cloud;
  Domain     domain = cloud->domain;
  PetscBool  periodic[DIM], twolevel;
  PetscReal *x = cloud->field[FIELD_POSITION], *factor;
  PC         pc;

  PetscFunctionBegin;
  PetscCall(KSPGetPC(pressure->solver.ksp, &pc));
  PetscCall(PetscObjectTypeCompare((PetscObject)pc, PCTWOLEVEL, &twolevel));
  if (!twolevel) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt d = 0; d < DIM; d++) periodic[d] = (PetscBool)(domain->face[d][0] == FACE_PERIODIC);
  PetscCall(PCTwoLevelSetGrid(pc, domain->spacing, domain->lower, domain->upper, periodic));
  if (ParticlesHave(cloud->particles, FIELD_VOLUME)) {
    PetscCall(CloudGetWork(cloud, 1, &factor));
    for (PetscInt a = 0; a < cloud->n_rows; a++) factor[a] = cloud->weight[a] * cloud->length[a];
    PetscCall(PCTwoLevelSetVolumes(pc, domain->spacing_coarse, cloud->n_rows, cloud->weight, factor));
    PetscCall(CloudRestoreWork(cloud, &factor));
  }
  if (domain->dim < DIM) {
    PetscCall(PetscMalloc1(domain->dim * cloud->n_rows, &x));
    for (PetscInt a = 0; a < cloud->n_rows; a++)
      for (PetscInt d = 0; d < domain->dim; d++) x[domain->dim * a + d] = cloud->field[FIELD_POSITION][DIM * a + d];
  }
  PetscCall(PCSetCoordinates(pc, domain->dim, cloud->n_rows, x));
  if (domain->dim < DIM) PetscCall(PetscFree(x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives the solver the operator of this step, with 'renew' the preconditioner's matrix, too. A preconditioner may still
   read the entries from which it was built, so they stay in their store until the next rebuild. */
static PetscErrorCode SetOperators(Pressure pressure, PetscBool renew)
{
  PetscFunctionBegin;
  if (renew) {
    pressure->kept    = pressure->assembled ? pressure->current : KEPT_OPERATOR;
    pressure->age     = 0;
    pressure->rebuild = PETSC_FALSE;
    PetscCall(LocateRows(pressure));
    if (!pressure->assembled) { /* one object in all steps: marks it as changed */
      PetscCall(MatAssemblyBegin(pressure->A, MAT_FINAL_ASSEMBLY));
      PetscCall(MatAssemblyEnd(pressure->A, MAT_FINAL_ASSEMBLY));
    }
  }
  PetscCall(KSPSetReusePreconditioner(pressure->solver.ksp, (PetscBool)!renew));
  PetscCall(KSPSetOperators(pressure->solver.ksp, pressure->low_ranks ? pressure->coupled : pressure->A,
                            pressure->assembled ? pressure->store[pressure->kept].A : pressure->A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the level to the pressures x of rows with pairs. */
static PetscErrorCode AddLevel(Pressure pressure, PetscReal level, Vec x)
{
  PetscScalar *p;

  PetscFunctionBegin;
  if (level == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArray(x, &p));
  for (PetscInt r = 0; r < pressure->cloud->n_rows; r++)
    if (pressure->pair_diagonal[r] > 0) p[r] += level;
  PetscCall(VecRestoreArray(x, &p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Before an attempt: sets the kept or a new preconditioner, and the cloud's pressure as the initial guess. */
static PetscErrorCode Start(void *context, PetscBool again)
{
  Pressure     pressure = (Pressure)context;
  PetscScalar *x;

  PetscFunctionBegin;
  PetscCall(SetOperators(pressure, (PetscBool)(again || pressure->rebuild || pressure->kept == KEPT_NONE ||
                                               pressure->age >= pressure->kept_steps)));
  PetscCall(VecGetArrayWrite(pressure->solver.x, &x));
  PetscCall(PetscArraycpy(x, pressure->cloud->field[FIELD_PRESSURE], pressure->cloud->n_rows));
  PetscCall(VecRestoreArrayWrite(pressure->solver.x, &x));
  PetscCall(AddLevel(pressure, -pressure->level, pressure->solver.x));
  if (pressure->constant_null) {
    MatNullSpace constant;

    PetscCall(MatGetNullSpace(pressure->A, &constant));
    PetscCall(MatNullSpaceRemove(constant, pressure->solver.b));
    PetscCall(MatNullSpaceRemove(constant, pressure->solver.x));
  }
  pressure->density_claimed = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Decides whether the matrix has entries. *cheap: the preconditioner needs none. */
static PetscErrorCode ChooseMatrix(Pressure pressure, PetscBool *cheap)
{
  const char *const cheap_types[]     = {PCTWOLEVEL, PCJACOBI, PCNONE};
  char              type[TYPE_LENGTH] = PCTWOLEVEL;
  PetscBool         shell, same;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetString(NULL, NULL, "-pc_type", type, sizeof(type), NULL));
  *cheap = PETSC_FALSE;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(cheap_types); k++) {
    PetscCall(PetscStrcmp(type, cheap_types[k], &same));
    *cheap = (PetscBool)(*cheap || same);
  }
  PetscCall(PetscStrcmp(pressure->mat_type, MATSHELL, &shell));
  PetscCheckUser(*cheap || !shell, pressure->cloud->comm,
                 "-mat_type shell has no entries, which this -pc_type needs; " PCTWOLEVEL
                 ", jacobi and none need none");
  pressure->assembled = (PetscBool) !(shell || (*cheap && !pressure->mat_type[0]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes the solver for the present rows: CG with the two-level preconditioner, stopped by the true residual; then the
   user's options act. */
static PetscErrorCode CreateSolver(Pressure pressure)
{
  Cloud     cloud = pressure->cloud;
  PC        pc;
  PetscBool gamg, jacobi, cheap = PETSC_FALSE, direct;

  PetscFunctionBegin;
  PetscCall(PressureReset(pressure));
  PetscCall(ChooseMatrix(pressure, &cheap));
  PetscCall(CheckViews(pressure));
  pressure->solver_layout = cloud->layout;
  PetscCall(VecCreate(cloud->comm, &pressure->solver.b));
  PetscCall(VecSetSizes(pressure->solver.b, cloud->n_rows, pressure->rows_global));
  PetscCall(VecSetFromOptions(pressure->solver.b));
  PetscCall(VecDuplicate(pressure->solver.b, &pressure->solver.x));
  pressure->solver.name    = PRESSURE_EQUATION;
  pressure->solver.context = pressure;
  pressure->solver.start   = Start;
  pressure->solver.measure = ResidualMeasure;
  PetscCall(SolverCreate(cloud->comm, "", KSP_NORM_UNPRECONDITIONED, DEFAULT_RTOL, PCTWOLEVEL, &pressure->solver));
  PetscCall(KSPGetPC(pressure->solver.ksp, &pc));
  PetscCall(SetConvergence(pressure));
  PetscCall(PetscObjectTypeCompare((PetscObject)pc, PCGAMG, &gamg));
  PetscCall(PetscObjectTypeCompare((PetscObject)pc, PCJACOBI, &jacobi));
  pressure->kept_steps = jacobi ? 1 : cheap ? REBUILD_CHEAP : REBUILD_DEAR;
  PetscCall(PetscObjectTypeCompareAny((PetscObject)pressure->solver.ksp, &direct, KSPPREONLY, KSPNONE, ""));
  if (direct) pressure->kept_steps = 1; /* the preconditioner is the solver: it must be of this step */
  if (gamg) {
    PetscReal threshold = DEFAULT_GAMG_DROP;

    PetscCall(PCGAMGSetThreshold(pc, &threshold, 1));
    PetscCall(DefaultOption("-mg_levels_ksp_max_it", "1"));
    SolverTry(cloud->comm, PRESSURE_EQUATION, PCSetFromOptions(pc)); /* the user's threshold wins */
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The constant on the rows with pairs, of norm 1. */
static PetscErrorCode CreateConstant(Pressure pressure, Vec *constant)
{
  PetscScalar *value;

  PetscFunctionBegin;
  PetscCall(VecDuplicate(pressure->solver.b, constant));
  PetscCall(VecGetArrayWrite(*constant, &value));
  for (PetscInt r = 0; r < pressure->cloud->n_rows; r++) value[r] = pressure->pair_diagonal[r] > 0 ? 1 : 0;
  PetscCall(VecRestoreArrayWrite(*constant, &value));
  PetscCall(VecNormalize(*constant, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tells A that its null space is the constant, or that it has none. */
static PetscErrorCode SetNullSpace(Pressure pressure, Mat A)
{
  MatNullSpace   constant = NULL;
  Vec            vector   = NULL;
  const PetscInt vectors  = pressure->empty_rows > 0 ? 1 : 0;

  PetscFunctionBegin;
  if (pressure->constant_null) {
    if (vectors) PetscCall(CreateConstant(pressure, &vector));
    PetscCall(MatNullSpaceCreate(pressure->cloud->comm, vectors ? PETSC_FALSE : PETSC_TRUE, vectors,
                                 vectors ? &vector : NULL, &constant));
    PetscCall(VecDestroy(&vector));
  }
  PetscCall(MatSetNullSpace(A, constant));
  PetscCall(MatNullSpaceDestroy(&constant));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureSetKeptShare(Pressure pressure, PetscReal share)
{
  PetscFunctionBegin;
  pressure->kept_share = share;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal PressureKeptShare(Pressure pressure)
{
  return pressure->kept_share;
}

/* Adds the kept share of the cloud's pressure, moved from the left-hand side to the right. This share includes the same
   share of the surfaces' contribution. */
static PetscErrorCode AddKept(Pressure pressure, PetscScalar rhs[])
{
  Cloud           cloud = pressure->cloud;
  const PetscReal share = pressure->kept_share;
  PetscReal      *left, *surfaces;

  PetscFunctionBegin;
  if (share == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CloudGetWork(cloud, 1, &left));
  PetscCall(CloudGetWork(cloud, 1, &surfaces));
  PetscCall(PressureMultiply(pressure, cloud->field[FIELD_PRESSURE], left));
  PetscCall(PressureCapillary(pressure, surfaces));
  for (PetscInt r = 0; r < cloud->n_rows; r++) rhs[r] += share * (left[r] - surfaces[r]);
  PetscCall(CloudRestoreWork(cloud, &surfaces));
  PetscCall(CloudRestoreWork(cloud, &left));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds what the pressure of tension on free surface and interface, and what is carried, give to the rows. */
static void AddCapillary(Pressure pressure, PetscScalar rhs[])
{
  const Cloud cloud = pressure->cloud;

  for (PetscInt r = 0; r < cloud->n_fluid; r++)
    if (pressure->closure_diagonal[r] != 0)
      rhs[r] += pressure->closure_diagonal[r] * PressureSurrounds(pressure, r, NULL);
  JumpsAdd(pressure, rhs);
  BalanceAdd(pressure, rhs);
}

/* The right-hand side b, after OperatorSetUp: the source times the weight of the row, plus the contribution of the free
   surface, where missing neighbours have the pressure of surface tension. */
static PetscErrorCode SetRightHandSide(Pressure pressure, PetscReal dt)
{
  Cloud        cloud = pressure->cloud;
  PetscScalar *rhs;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_SOURCE), 0, 0, 0, 0));
  PetscCall(VecGetArrayWrite(pressure->solver.b, &rhs));
  PetscCall(pressure->source(pressure, dt, rhs));
  for (PetscInt r = 0; r < cloud->n_rows; r++) rhs[r] *= PressureRowWeight(pressure, r);
  AddCapillary(pressure, rhs);
  for (PetscInt k = 0; k < pressure->low_ranks; k++)
    if (pressure->low_rank[k].term->right_side)
      PetscCall(pressure->low_rank[k].term->right_side(pressure->low_rank[k].context, pressure, rhs));
  PetscCall(AddKept(pressure, rhs));
  for (PetscInt r = 0; r < cloud->n_rows; r++) /* isolated particles have no pressure */
    if (pressure->pair_diagonal[r] == 0) rhs[r] = 0;
  PetscCall(VecRestoreArrayWrite(pressure->solver.b, &rhs));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_SOURCE), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets up the equation at the positions of the cloud. Assembles the operator if the solver or the caller needs its
   entries, into the store that the preconditioner does not read. Makes a new solver if the rows have changed. */
static PetscErrorCode Prepare(Pressure pressure, PetscReal dt, PetscBool entries)
{
  PetscFunctionBegin;
  PetscCall(RowsNumber(pressure));
  if (!pressure->solver.ksp || pressure->solver_layout != pressure->cloud->layout) PetscCall(CreateSolver(pressure));
  pressure->dt = dt;
  PetscCall(JumpsSetUp(pressure));
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_ASSEMBLE), 0, 0, 0, 0));
  PetscCall(OperatorSetUp(pressure));
  PetscCall(SetNullSpace(pressure, pressure->operator));
  if (pressure->low_ranks) PetscCall(SetNullSpace(pressure, pressure->coupled));
  pressure->A = pressure->operator;
  if (entries || pressure->assembled) {
    pressure->current = pressure->kept == 0 ? 1 : 0;
    PetscCall(MatrixAssemble(pressure, &pressure->store[pressure->current]));
    pressure->A = pressure->store[pressure->current].A;
    PetscCall(SetNullSpace(pressure, pressure->A));
  }
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_ASSEMBLE), 0, 0, 0, 0));
  PetscCall(SetRightHandSide(pressure, dt));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureAssemble(Pressure pressure, PetscReal dt, Mat *A, Vec *b)
{
  PetscFunctionBegin;
  PetscCall(Prepare(pressure, dt, PETSC_TRUE));
  *A = pressure->A;
  *b = pressure->solver.b;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureSetUp(Pressure pressure, PetscReal dt)
{
  PetscFunctionBegin;
  PetscCall(Prepare(pressure, dt, PETSC_FALSE));
  PetscCall(LocateRows(pressure));
  PetscCall(KSPSetOperators(pressure->solver.ksp, pressure->low_ranks ? pressure->coupled : pressure->A, pressure->A));
  SolverTry(pressure->cloud->comm, PRESSURE_EQUATION, KSPSetUp(pressure->solver.ksp));
  SolverTry(pressure->cloud->comm, PRESSURE_EQUATION, KSPSetUpOnBlocks(pressure->solver.ksp));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureSolver(Pressure pressure, KSP *ksp, Vec *b)
{
  PetscFunctionBegin;
  *ksp = pressure->solver.ksp;
  *b   = pressure->solver.b;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureCapillary(Pressure pressure, PetscReal values[])
{
  const Cloud cloud = pressure->cloud;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(values, cloud->n_rows));
  AddCapillary(pressure, values);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureToCloud(Pressure pressure, Vec x)
{
  const Cloud        cloud = pressure->cloud;
  const PetscScalar *p;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(x, &p));
  for (PetscInt a = 0; a < cloud->n_owned; a++)
    cloud->field[FIELD_PRESSURE][a] = PetscRealPart(p[a < cloud->n_rows ? a : ParentRow(pressure, a)]);
  PetscCall(VecRestoreArrayRead(x, &p));
  PetscCall(CloudUpdate(cloud, FIELD_PRESSURE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes from the right-hand side b the level of the pressure outside: the constant whose closures are nearest to b. A
   constant is no flow, and the solver's tolerance is a share of |b|: a vessel at rest beside an outlet of 1500 Pa had
   an error of the density of 3 %, in long steps without an iteration. Only of known pressures: others have their own
   rows. */
static PetscErrorCode TakeLevel(Pressure pressure)
{
  const PetscReal *closure = pressure->closure_diagonal;
  PetscBool        known   = PETSC_FALSE;
  PetscReal        sum[2]  = {0, 0}; /* b.c, c.c */
  PetscScalar     *b;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < pressure->low_ranks; k++)
    known = (PetscBool)(known || (pressure->low_rank[k].term->outside && !pressure->low_rank[k].term->add));
  if (!known) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArray(pressure->solver.b, &b));
  for (PetscInt r = 0; r < pressure->cloud->n_rows; r++) {
    if (pressure->pair_diagonal[r] == 0) continue;
    sum[0] += PetscRealPart(b[r]) * closure[r];
    sum[1] += closure[r] * closure[r];
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPIU_REAL, MPI_SUM, pressure->cloud->comm));
  pressure->level = sum[1] > 0 ? sum[0] / sum[1] : 0;
  for (PetscInt r = 0; r < pressure->cloud->n_rows; r++)
    if (pressure->pair_diagonal[r] > 0) b[r] -= pressure->level * closure[r];
  PetscCall(VecRestoreArray(pressure->solver.b, &b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureSolve(Pressure pressure, PetscReal dt, PressureResult *result)
{
  SolverReport *report = &result->solver;

  PetscFunctionBegin;
  PetscCall(Prepare(pressure, dt, PETSC_FALSE));
  PetscCall(TakeLevel(pressure));
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_SOLVE), 0, 0, 0, 0));
  pressure->solver.A = EquationOf(pressure);
  PetscCall(SolverSolve(&pressure->solver, report));
  PetscCall(AddLevel(pressure, pressure->level, pressure->solver.x));
  pressure->level = 0;
  result->density = pressure->density_left;
  result->rebuilt = (PetscBool)(pressure->age++ == 0);
  if (result->rebuilt) pressure->first_iterations = report->iterations;
  if (report->iterations > REBUILD_GROWTH * pressure->first_iterations + REBUILD_SLACK) pressure->rebuild = PETSC_TRUE;
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_SOLVE), 0, 0, 0, 0));
  if (SolverFailed(report))
    pressure->rebuild = PETSC_TRUE;
  else {
    PetscCall(PressureToCloud(pressure, pressure->solver.x));
    for (PetscInt k = 0; k < pressure->low_ranks; k++)
      if (pressure->low_rank[k].term->solved)
        PetscCall(pressure->low_rank[k].term->solved(pressure->low_rank[k].context, pressure));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
