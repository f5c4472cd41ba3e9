#include "solver.h"
#include <petsc/private/kspimpl.h>
#include <stdio.h>
#include <string.h>

#define TEXT   512
#define MAXITS 2000

static MPI_Comm Meeting = MPI_COMM_NULL; /* of its own: stuck ranks are in the midst of other messages */

static PetscErrorCode FinalizePackage(void)
{
  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_free(&Meeting));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The options that the user has chosen the solver by, " -name value ..."; those of the viscosity have a prefix. */
static PetscErrorCode Choices(const char prefix[], char text[], size_t length)
{
  const char *const kinds[] = {"ksp_", "pc_", "mat_", "sub_", "mg_levels_"};
  char             *all;
  size_t            used = 0;

  PetscFunctionBegin;
  text[0] = 0;
  PetscCall(PetscOptionsGetAll(NULL, &all));
  for (char *option = all, *next; *option; option = next) {
    next = strstr(option, " -");
    next = next ? next + 1 : option + strlen(option);
    if (option[0] != '-' || strncmp(option + 1, prefix, strlen(prefix))) continue;
    for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(kinds); k++)
      if (!strncmp(option + 1 + strlen(prefix), kinds[k], strlen(kinds[k])) && used < length) {
        const int n = (int)(next - option) - (next[-1] == ' ');

        used += (size_t)snprintf(text + used, length - used, " %.*s", n, option);
      }
  }
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SolverTried(MPI_Comm comm, const char equation[], PetscErrorCode code)
{
  const char *prefix = strcmp(equation, "viscous") ? "" : "viscous_";
  char        choices[TEXT], said[TEXT];
  PetscMPIInt first, size, all;

  PetscFunctionBegin;
  ErrorsCapture(PETSC_FALSE);
  if (Meeting == MPI_COMM_NULL) {
    PetscCallMPI(MPI_Comm_dup(comm, &Meeting));
    PetscCall(PetscRegisterFinalize(FinalizePackage));
  }
  PetscCallMPI(MPI_Comm_size(Meeting, &size));
  PetscCall(RanksMeet(Meeting, (PetscBool)(code != 0), &first, &all));
  if (all && first == size) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscStrncpy(said, CapturedError(), sizeof(said)));
  if (all) PetscCallMPI(MPI_Bcast(said, sizeof(said), MPI_CHAR, first, Meeting));
  if (all && !said[0]) return UserErrorSaid();
  PetscCall(Choices(prefix, choices, sizeof(choices)));
  PetscCheckUser(!all, comm,
                 "the %s equation cannot be solved with%s: PETSc says \"%s\"; -%sksp_type cg with -%spc_type %sjacobi "
                 "always works",
                 equation, choices[0] ? choices : " the default solver", said, prefix, prefix,
                 prefix[0] ? "" : "twolevel or ");
  (void)UserError(PETSC_COMM_SELF, "the %s equation cannot be solved with%s: PETSc says \"%s\" on some ranks", equation,
                  choices, said);
  (void)MPI_Abort(comm, 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Options that scale the equation in place, from which the residual is not computed and the next one not made. */
static PetscErrorCode RefuseScaling(KSP ksp, const char prefix[])
{
  const char *const names[] = {"ksp_diagonal_scale", "ksp_diagonal_scale_fix"};
  char              option[TEXT];
  PetscBool         set;

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(names); k++) {
    PetscCall(PetscSNPrintf(option, sizeof(option), "-%s%s", prefix, names[k]));
    PetscCall(PetscOptionsHasName(NULL, NULL, option, &set));
    PetscCheckUser(!set, PetscObjectComm((PetscObject)ksp),
                   "%s would scale an equation that belongs to the program, in each step again; -%spc_type jacobi does "
                   "the same to the solver",
                   option, prefix);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A preconditioner alone has no use for a start value, and PETSc does not read tolerances for it, which its answer is
   held to here all the same. */
static PetscErrorCode SetDirect(KSP ksp, const char prefix[])
{
  PetscReal rtol, atol, divtol;
  PetscInt  iterations;

  PetscFunctionBegin;
  PetscCall(KSPSetInitialGuessNonzero(ksp, PETSC_FALSE));
  PetscCall(KSPGetTolerances(ksp, &rtol, &atol, &divtol, &iterations));
  PetscCall(PetscOptionsGetReal(NULL, prefix, "-ksp_rtol", &rtol, NULL));
  PetscCall(PetscOptionsGetReal(NULL, prefix, "-ksp_atol", &atol, NULL));
  PetscCall(PetscOptionsGetReal(NULL, prefix, "-ksp_divtol", &divtol, NULL));
  PetscCall(PetscOptionsGetInt(NULL, prefix, "-ksp_max_it", &iterations, NULL));
  PetscCall(KSPSetTolerances(ksp, rtol, atol, divtol, iterations));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* KSPSetFromOptions for a KSP whose norm and start value are set. */
static PetscErrorCode SetFromOptions(KSP ksp, const char equation[])
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)ksp);
  const char *prefix;
  char        option[TEXT];
  PetscBool   direct, chosen, residual = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(KSPGetOptionsPrefix(ksp, &prefix));
  if (!prefix) prefix = "";
  PetscCall(RefuseScaling(ksp, prefix));
  SolverTry(comm, equation, KSPSetFromOptions(ksp));
  PetscCall(PetscSNPrintf(option, sizeof(option), "-%sksp_norm_type", prefix));
  PetscCall(PetscOptionsHasName(NULL, NULL, option, &chosen));
  for (PetscInt side = 0; side < PC_SIDE_MAX; side++)
    if (ksp->normsupporttable[KSP_NORM_UNPRECONDITIONED][side] > 0) residual = PETSC_TRUE;
  if (!chosen && !residual) PetscCall(KSPSetNormType(ksp, KSP_NORM_DEFAULT));
  PetscCall(PetscObjectTypeCompareAny((PetscObject)ksp, &direct, KSPPREONLY, KSPNONE, ""));
  if (direct) PetscCall(SetDirect(ksp, prefix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A sign of life in each iteration: thousands of them may take longer than -wall_clock_silence. */
static PetscErrorCode Alive(KSP ksp, PetscInt iteration, PetscReal norm, void *context)
{
  InterruptAlive(NULL);
  return PETSC_SUCCESS;
}

PetscErrorCode SolverCreate(MPI_Comm comm, const char prefix[], KSPNormType norm, PetscReal rtol, PCType preconditioner,
                            Solver *solver)
{
  PC pc;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2; k++) PetscCall(VecDuplicate(solver->b, &solver->scratch[k]));
  PetscCall(KSPCreate(comm, &solver->ksp));
  PetscCall(KSPSetOptionsPrefix(solver->ksp, prefix));
  PetscCall(KSPSetType(solver->ksp, KSPCG));
  PetscCall(KSPSetNormType(solver->ksp, norm));
  PetscCall(KSPSetTolerances(solver->ksp, rtol, PETSC_DEFAULT, PETSC_DEFAULT, MAXITS));
  PetscCall(KSPSetInitialGuessNonzero(solver->ksp, PETSC_TRUE));
  PetscCall(KSPGetPC(solver->ksp, &pc));
  PetscCall(PCSetType(pc, preconditioner));
  PetscCall(SetFromOptions(solver->ksp, solver->name));
  PetscCall(KSPMonitorSet(solver->ksp, Alive, NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SolverReset(Solver *solver)
{
  PetscFunctionBegin;
  PetscCall(KSPDestroy(&solver->ksp));
  PetscCall(VecDestroy(&solver->b));
  PetscCall(VecDestroy(&solver->x));
  for (PetscInt k = 0; k < 2; k++) PetscCall(VecDestroy(&solver->scratch[k]));
  solver->from_zero = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* |r| in the norm that the KSP goes by; z: room. */
static PetscErrorCode NormOf(KSP ksp, Vec r, Vec z, PetscReal *norm)
{
  KSPNormType type;
  PC          pc;
  PetscScalar square;

  PetscFunctionBegin;
  PetscCall(KSPGetNormType(ksp, &type));
  PetscCall(KSPGetPC(ksp, &pc));
  if (type == KSP_NORM_PRECONDITIONED || type == KSP_NORM_NATURAL) PetscCall(PCApply(pc, r, z));
  if (type == KSP_NORM_NATURAL) {
    PetscCall(VecDot(r, z, &square));
    *norm = PetscSqrtReal(PetscAbsScalar(square));
  } else
    PetscCall(VecNorm(type == KSP_NORM_PRECONDITIONED ? z : r, NORM_2, norm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* r is lost. The diagonal is made only where the rounding decides. */
static PetscErrorCode Measure(const Solver *solver, Vec r, SolverReport *report, PetscReal *rounding)
{
  PetscReal rtol, atol, rhs;

  PetscFunctionBegin;
  PetscCall(KSPGetTolerances(solver->ksp, &rtol, &atol, NULL, NULL));
  PetscCall(NormOf(solver->ksp, solver->b, solver->scratch[1], &rhs));
  PetscCall(NormOf(solver->ksp, r, solver->scratch[1], &report->residual));
  PetscCall(KSPGetResidualNorm(solver->ksp, &report->claimed));
  report->asked = PetscMax(rtol * rhs, atol);
  *rounding     = 0;
  if (report->residual <= report->asked) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatGetDiagonal(solver->A, r));
  PetscCall(VecPointwiseMult(r, r, solver->x));
  PetscCall(NormOf(solver->ksp, r, solver->scratch[1], rounding));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Judges what stands in x by its true residual. */
static PetscErrorCode Check(Solver *solver, SolverReport *report)
{
  PetscReal rounding;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_RESIDUAL), 0, 0, 0, 0));
  PetscCall(MatMult(solver->A, solver->x, solver->scratch[0]));
  PetscCall(VecAYPX(solver->scratch[0], -1, solver->b));
  if (solver->measure)
    PetscCall(solver->measure(solver->context, solver->scratch[0], report, &rounding));
  else
    PetscCall(Measure(solver, solver->scratch[0], report, &rounding));
  SolverJudge(report, rounding);
  PetscCall(PetscInfo(solver->ksp, "residual %.17g, claimed %.17g, asked %g, rounding %g\n", (double)report->residual,
                      (double)report->claimed, (double)report->asked, (double)(PETSC_MACHINE_EPSILON * rounding)));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_RESIDUAL), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One attempt; its iterations are added to those of the report. */
static PetscErrorCode Attempt(Solver *solver, PetscBool again, SolverReport *report)
{
  PetscInt iterations;

  PetscFunctionBegin;
  if (solver->start) PetscCall(solver->start(solver->context, again));
  if (again || solver->from_zero) PetscCall(VecSet(solver->x, 0));
  SolverTry(PetscObjectComm((PetscObject)solver->ksp), solver->name, KSPSolve(solver->ksp, solver->b, solver->x));
  PetscCall(KSPGetConvergedReason(solver->ksp, &report->reason));
  PetscCall(KSPGetIterationNumber(solver->ksp, &iterations));
  report->iterations += iterations;
  PetscCall(Check(solver, report));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SolverSolve(Solver *solver, SolverReport *report)
{
  PetscFunctionBegin;
  report->iterations = 0;
  PetscCall(Attempt(solver, PETSC_FALSE, report));
  if (SolverFailed(report)) {
    const PetscBool lied = report->lied;

    PetscCall(PetscInfo(solver->ksp, "solved again from zero: %s, residual %g, asked for %g\n",
                        KSPConvergedReasons[report->reason], (double)report->residual, (double)report->asked));
    PetscCall(Attempt(solver, PETSC_TRUE, report));
    if (lied && !SolverFailed(report)) solver->from_zero = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

void SolverJudge(SolverReport *report, PetscReal rounding)
{
  const PetscReal limit = SOLVER_SLACK * report->asked + SOLVER_ROUNDING * PETSC_MACHINE_EPSILON * rounding;

  report->lied = (PetscBool)(report->reason >= 0 && !(report->residual <= limit));
}

PetscErrorCode SolverExplain(KSP ksp, const SolverReport *report, const char equation[], char why[], size_t length)
{
  const char *prefix;
  KSPType     method;
  PCType      preconditioner;
  PC          pc;

  PetscFunctionBegin;
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(KSPGetType(ksp, &method));
  PetscCall(PCGetType(pc, &preconditioner));
  PetscCall(KSPGetOptionsPrefix(ksp, &prefix));
  if (!prefix) prefix = "";
  if (report->lied)
    PetscCall(PetscSNPrintf(why, length,
                            "the %s solver (-%sksp_type %s, -%spc_type %s) says %s with a residual of %.3g where %.3g "
                            "was asked for, but its true residual is %.3g: try -%sksp_type cg or another -%spc_type",
                            equation, prefix, method, prefix, preconditioner, KSPConvergedReasons[report->reason],
                            (double)report->claimed, (double)report->asked, (double)report->residual, prefix, prefix));
  else
    PetscCall(PetscSNPrintf(why, length,
                            "the %s solver (-%sksp_type %s, -%spc_type %s) stopped with %s after %" PetscInt_FMT
                            " iterations at a residual of %.3g where %.3g was asked for: try -%sksp_type cg, another "
                            "-%spc_type, a larger -%sksp_max_it or -%sksp_rtol",
                            equation, prefix, method, prefix, preconditioner, KSPConvergedReasons[report->reason],
                            report->iterations, (double)report->residual, (double)report->asked, prefix, prefix, prefix,
                            prefix));
  PetscFunctionReturn(PETSC_SUCCESS);
}
