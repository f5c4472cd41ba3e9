/* The word of the pressure's solver is checked: one that lies is found out, one that lies only about a start value or
   with an old preconditioner is tried again without; an honest one is believed down to the rounding of the product.
   Runs on any number of ranks. */
#include <petsc/private/kspimpl.h>
#include "setup.h"
#include "check.h"

#define DT 1e-3 /* s; without meaning here */
#define FILM                                                                                                           \
  "-dimension 2 -spacing 1 -box_lower 0,0 -box_upper 22,40 -box_x periodic -box_ymin wall -bodies a -a_density 900 "   \
  "-packing_jitter 0.2 -a_upper 22,12 "

static PetscInt Calls; /* of the solvers below */

/* Says that it is done, whatever x is. */
static PetscErrorCode Lie(KSP ksp)
{
  PetscFunctionBegin;
  Calls++;
  PetscCall(VecSet(ksp->vec_sol, 1));
  ksp->its    = 1;
  ksp->rnorm  = 0;
  ksp->reason = KSP_CONVERGED_RTOL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lies if it is given a start value, else solves by steepest descent. */
static PetscErrorCode LieFromStart(KSP ksp)
{
  PetscReal start, initial, square, curvature;
  Mat       A;
  Vec       r, y;

  PetscFunctionBegin;
  PetscCall(VecNorm(ksp->vec_sol, NORM_2, &start));
  PetscCall(Lie(ksp));
  if (start > 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(KSPGetOperators(ksp, &A, NULL));
  PetscCall(VecDuplicate(ksp->vec_rhs, &y));
  PetscCall(VecDuplicate(ksp->vec_rhs, &r));
  PetscCall(VecSet(ksp->vec_sol, 0));
  PetscCall(VecCopy(ksp->vec_rhs, r));
  PetscCall(VecNorm(r, NORM_2, &initial));
  do {
    PetscCall(MatMult(A, r, y));
    PetscCall(VecDot(r, r, &square));
    PetscCall(VecDot(r, y, &curvature));
    PetscCall(VecAXPY(ksp->vec_sol, square / curvature, r));
    PetscCall(VecAXPY(r, -square / curvature, y));
    PetscCall(VecNorm(r, NORM_2, &ksp->rnorm));
  } while (ksp->rnorm > ksp->rtol * initial);
  PetscCall(VecDestroy(&y));
  PetscCall(VecDestroy(&r));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode NoSetUp(KSP ksp)
{
  return PETSC_SUCCESS;
}

static PetscErrorCode Create(KSP ksp, PetscErrorCode (*solve)(KSP))
{
  PetscFunctionBegin;
  PetscCall(KSPSetSupportedNorm(ksp, KSP_NORM_UNPRECONDITIONED, PC_LEFT, 2));
  ksp->ops->solve         = solve;
  ksp->ops->setup         = NoSetUp;
  ksp->ops->buildsolution = KSPBuildSolutionDefault;
  ksp->ops->buildresidual = KSPBuildResidualDefault;
  ksp->ops->destroy       = KSPDestroyDefault;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateLiar(KSP ksp)
{
  return Create(ksp, Lie);
}

static PetscErrorCode CreateLiarFromStart(KSP ksp)
{
  return Create(ksp, LieFromStart);
}

/* A film with a random velocity and a pressure of 1 Pa for a start. */
static PetscErrorCode Open(const char options[], Setup *s)
{
  char text[1024];

  PetscFunctionBegin;
  Calls = 0;
  PetscCall(PetscSNPrintf(text, sizeof(text), FILM "%s", options));
  PetscCall(SetupPack(text, s));
  PetscCall(SetupMoments(s));
  PetscCall(PetscArrayzero(s->cloud->field[FIELD_CAPILLARY], s->cloud->n_owned));
  PetscCall(PetscArrayzero(s->cloud->field[FIELD_CAPILLARY_SLOPE], DIM * s->cloud->n_owned));
  PetscCall(PressureCreate(s->cloud, &s->pressure));
  PetscCall(PressureSetTypes(s->pressure, SOURCE_DIVERGENCE, CLOSURE_FULL, GRADIENT_SYMMETRIC, PETSC_FALSE));
  PetscCall(PressureSetFromOptions(s->pressure));
  for (PetscInt k = 0; k < DIM * s->cloud->n_owned; k++) s->cloud->field[FIELD_VELOCITY_STAR][k] = 0;
  for (PetscInt a = 0; a < s->cloud->n_fluid; a++)
    for (PetscInt d = 0; d < s->domain->dim; d++)
      s->cloud->field[FIELD_VELOCITY_STAR][DIM * a + d] =
        RandomUnit(2, (unsigned long long)(DIM * s->cloud->integer[INT_ID][a] + d));
  for (PetscInt a = 0; a < s->cloud->n_owned; a++) s->cloud->field[FIELD_PRESSURE][a] = 1;
  PetscCall(SetupDivergence(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* |b - A p|/|b| of the pressure that the cloud has. */
static PetscErrorCode Residual(Setup *s, PetscReal *residual)
{
  PetscScalar *p;
  PetscReal    norm;
  Mat          A;
  Vec          b, x, r;

  PetscFunctionBegin;
  PetscCall(PressureAssemble(s->pressure, DT, &A, &b));
  PetscCall(MatCreateVecs(A, &x, &r));
  PetscCall(VecGetArrayWrite(x, &p));
  PetscCall(PetscArraycpy(p, s->cloud->field[FIELD_PRESSURE], s->cloud->n_rows));
  PetscCall(VecRestoreArrayWrite(x, &p));
  PetscCall(MatMult(A, x, r));
  PetscCall(VecAXPY(r, -1, b));
  PetscCall(VecNorm(r, NORM_2, residual));
  PetscCall(VecNorm(b, NORM_2, &norm));
  *residual /= norm;
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&r));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* It fails, says why, and leaves the pressure alone. */
static PetscErrorCode TestRefused(const char options[], const char name[])
{
  PressureResult result;
  PetscReal      changed = 0;
  Setup          s;

  PetscFunctionBegin;
  PetscCall(Open(options, &s));
  PetscCall(PressureSolve(s.pressure, DT, &result));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
    changed = PetscMax(changed, PetscAbsReal(s.cloud->field[FIELD_PRESSURE][a] - 1));
  CHECK(SolverFailed(&result.solver) && result.solver.lied && result.solver.residual > result.solver.asked &&
          SetupMax(changed) == 0,
        name);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A solver that says that it gives up is believed: it tries twice, and leaves the pressure alone. */
static PetscErrorCode TestGivesUp(void)
{
  PressureResult result;
  PetscReal      changed = 0;
  Setup          s;

  PetscFunctionBegin;
  PetscCall(Open("-ksp_max_it 2 -ksp_rtol 1e-10", &s));
  PetscCall(PressureSolve(s.pressure, DT, &result));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
    changed = PetscMax(changed, PetscAbsReal(s.cloud->field[FIELD_PRESSURE][a] - 1));
  CHECK(SolverFailed(&result.solver) && result.solver.reason == KSP_DIVERGED_ITS && !result.solver.lied &&
          result.solver.iterations == 4 && SetupMax(changed) == 0,
        "solver that gives up");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The preconditioner is made anew every tenth time. */
static PetscErrorCode TestInterval(void)
{
  PressureResult result;
  PetscInt       rebuilt = 0;
  Setup          s;

  PetscFunctionBegin;
  PetscCall(Open("", &s));
  for (PetscInt k = 0; k < 21; k++) {
    PetscCall(PressureSolve(s.pressure, DT, &result));
    rebuilt |= result.rebuilt << k;
  }
  CHECK_CLOSE(rebuilt, 1 + (1 << 10) + (1 << 20), 0, "preconditioner is made anew at its interval");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The density error that a solve leaves is dt^2 times the residual over the mass of the row (here 1), its root mean
   square the one reported, its largest the one that -pressure_density_tolerance bounds. */
static PetscErrorCode TestDensityError(const char options[], PetscReal bound, const char name[])
{
  PressureResult     result;
  const PetscScalar *rhs;
  PetscReal         *p, *y, sum = 0, largest = 0, rows;
  KSP                ksp;
  Vec                b;
  Setup              s;

  PetscFunctionBegin;
  PetscCall(Open(options, &s));
  PetscCall(PressureSolve(s.pressure, DT, &result));
  PetscCall(PressureSolver(s.pressure, &ksp, &b));
  PetscCall(PetscMalloc2(s.cloud->n_rows, &p, s.cloud->n_rows, &y));
  PetscCall(PetscArraycpy(p, s.cloud->field[FIELD_PRESSURE], s.cloud->n_rows));
  PetscCall(PressureMultiply(s.pressure, p, y));
  PetscCall(VecGetArrayRead(b, &rhs));
  for (PetscInt r = 0; r < s.cloud->n_rows; r++) {
    const PetscReal error = DT * DT * PetscAbsReal(rhs[r] - y[r]);

    sum += error * error;
    largest = PetscMax(largest, error);
  }
  PetscCall(VecRestoreArrayRead(b, &rhs));
  PetscCall(PetscFree2(p, y));
  rows = SetupSum((PetscReal)s.cloud->n_rows);
  CHECK_CLOSE(result.density / PetscSqrtReal(SetupSum(sum) / rows), 1, 1e-6, name);
  CHECK(!SolverFailed(&result.solver) && SetupMax(largest) <= bound, name);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* It is right, to 'tolerance', also after the particles have moved. */
static PetscErrorCode TestRight(const char options[], PetscReal tolerance, const char name[])
{
  PressureResult result[2];
  PetscReal      residual[2];
  Setup          s;

  PetscFunctionBegin;
  PetscCall(Open(options, &s));
  for (PetscInt k = 0; k < 2; k++) {
    for (PetscInt l = 0; l < DIM * s.cloud->n_fluid && k; l++)
      if (l % DIM < s.domain->dim)
        s.cloud->field[FIELD_POSITION][l] += 0.1 * (s.cloud->field[FIELD_VELOCITY_STAR][l] - 0.5);
    PetscCall(CloudMoved(s.cloud));
    PetscCall(CloudSearch(s.cloud, NULL, NULL));
    PetscCall(SetupMoments(&s));
    PetscCall(SetupDivergence(&s));
    PetscCall(PressureSolve(s.pressure, DT, &result[k]));
    PetscCall(Residual(&s, &residual[k]));
  }
  CHECK(!SolverFailed(&result[0].solver) && !SolverFailed(&result[1].solver) &&
          PetscMax(residual[0], residual[1]) <= tolerance,
        name);
  if (result[0].solver.iterations == 1 && !Calls)
    CHECK(result[1].solver.iterations == 1, "direct solver needs no second attempt");
  if (Calls) CHECK(Calls == 3, "start value is not given again"); /* from it, from zero, from zero */
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What is a lie: a true residual beyond what was asked for by more than the slack and the rounding, whatever the solver
   says, or one that is not a number; never that of a solver that gives up. */
static void TestJudge(void)
{
  const struct {
    const char        *name;
    KSPConvergedReason reason;
    PetscReal          residual, claimed, rounding;
    PetscBool          lied;
  } cases[] = {{"judge: right", KSP_CONVERGED_RTOL, 1.05e-3, 1e-3, 0, PETSC_FALSE},
               {"judge: wrong", KSP_CONVERGED_RTOL, 1.2e-3, 1e-3, 0, PETSC_TRUE},
               {"judge: wrong as claimed", KSP_CONVERGED_RTOL, 5e-3, 5e-3, 0, PETSC_TRUE},
               {"judge: rounding", KSP_CONVERGED_RTOL, 5e-3, 1e-3, 2e12, PETSC_FALSE},
               {"judge: not a number", KSP_CONVERGED_RTOL, NAN, 1e-3, 0, PETSC_TRUE},
               {"judge: given up", KSP_DIVERGED_ITS, 1, 1, 0, PETSC_FALSE}};

  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(cases); k++) {
    SolverReport report = {.reason   = cases[k].reason,
                           .asked    = 1e-3,
                           .claimed  = cases[k].claimed,
                           .residual = cases[k].residual};

    SolverJudge(&report, cases[k].rounding);
    CHECK_CLOSE(report.lied, cases[k].lied, 0, cases[k].name);
  }
}

/* A solver without a measure of its own, A = 1 + c times a Laplacian and x a long wave: the terms of A x are far larger
   than b, so the rounding of the product is, too, and what it keeps from a tolerance of 1e-13 is no lie. */
static PetscErrorCode TestRounding(void)
{
  const PetscReal c      = 1e6;
  const PetscInt  n      = 200;
  const PetscReal k      = 2 * PETSC_PI / n;
  Solver          solver = {.name = "rounding"};
  SolverReport    report;
  PetscInt        begin, end;
  Vec             wave;
  PetscReal       off;

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(PETSC_COMM_WORLD, PETSC_DECIDE, PETSC_DECIDE, n, n, 3, NULL, 2, NULL, &solver.A));
  PetscCall(MatGetOwnershipRange(solver.A, &begin, &end));
  for (PetscInt i = begin; i < end; i++) {
    const PetscInt  near[] = {i, i ? i - 1 : n - 1, (i + 1) % n};
    const PetscReal row[]  = {1 + 2 * c, -c, -c};

    PetscCall(MatSetValues(solver.A, 1, &i, 3, near, row, INSERT_VALUES));
  }
  PetscCall(MatAssemblyBegin(solver.A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(solver.A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatCreateVecs(solver.A, &solver.x, &solver.b));
  PetscCall(VecDuplicate(solver.x, &wave));
  for (PetscInt i = begin; i < end; i++) {
    PetscCall(VecSetValue(wave, i, PetscCosReal(k * i), INSERT_VALUES));
    PetscCall(VecSetValue(solver.x, i, 0.1 * PetscSinReal(i * i), INSERT_VALUES));
  }
  PetscCall(VecAssemblyBegin(wave));
  PetscCall(VecAssemblyEnd(wave));
  PetscCall(VecAssemblyBegin(solver.x));
  PetscCall(VecAssemblyEnd(solver.x));
  PetscCall(VecAXPY(solver.x, 1, wave));
  PetscCall(VecCopy(wave, solver.b));
  PetscCall(VecScale(solver.b, 1 + 2 * c * (1 - PetscCosReal(k))));
  PetscCall(SolverCreate(PETSC_COMM_WORLD, "rounding_", KSP_NORM_DEFAULT, 1e-13, PCJACOBI, &solver));
  PetscCall(KSPSetOperators(solver.ksp, solver.A, solver.A));
  PetscCall(SolverSolve(&solver, &report));
  CHECK(!SolverFailed(&report), "the rounding of a product whose terms cancel is no lie");
  PetscCall(VecAXPY(solver.x, -1, wave));
  PetscCall(VecNorm(solver.x, NORM_INFINITY, &off));
  CHECK_CLOSE(off, 0, 1e-8, "x where the rounding decides");
  PetscCall(VecDestroy(&wave));
  PetscCall(MatDestroy(&solver.A));
  PetscCall(SolverReset(&solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscMPIInt size;

  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(KSPRegister("liar", CreateLiar));
  PetscCall(KSPRegister("liar_from_start", CreateLiarFromStart));
  TestJudge();
  PetscCall(TestRounding());
  PetscCall(TestRefused("-ksp_type liar", "liar"));
  PetscCall(TestRefused("-ksp_type liar -pressure_density_tolerance 1e-6", "liar about the density"));
  PetscCall(TestRefused("-ksp_type preonly -pc_type jacobi", "preconditioner alone"));
  PetscCall(TestRight("-ksp_type liar_from_start", 1.1e-3, "liar from a start value"));
  PetscCall(TestRight("-ksp_type cgs -pc_type jacobi -ksp_rtol 1e-8", 1.1e-8, "cgs"));
  PetscCall(TestRight("-ksp_type tfqmr -pc_type jacobi -ksp_rtol 1e-8", 1.1e-8, "tfqmr"));
  PetscCall(TestRight("-ksp_type gmres -ksp_norm_type preconditioned -ksp_rtol 1e-6", 1.1e-6, "gmres in its own norm"));
  PetscCall(TestRight("-ksp_rtol 1e-16", 1e-11, "cg to the rounding"));
  PetscCall(TestGivesUp());
  PetscCall(TestInterval());
  PetscCall(TestDensityError("-ksp_rtol 1e-4", PETSC_MAX_REAL, "density error of a solve"));
  PetscCall(TestDensityError("-ksp_rtol 0.9 -pressure_density_tolerance 1e-7", 1.1e-7, "density tolerance of a solve"));
  if (size == 1) {
    PetscCall(TestRight("-ksp_type preonly -pc_type lu", 1e-11, "factor of this step"));
    PetscCall(TestRight("-ksp_type preonly -pc_type cholesky", 1e-11, "cholesky factor of this step"));
  }
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
