#include "solver.h"

void SolverJudge(SolverReport *report, PetscReal rounding)
{
  const PetscReal limit = SOLVER_SLACK * report->asked + SOLVER_ROUNDING * PETSC_MACHINE_EPSILON * rounding;

  report->lied = (PetscBool)(report->reason >= 0 && !(report->residual <= limit));
}

PetscErrorCode SolverExplain(KSP ksp, const SolverReport *report, const char what[], char why[], size_t length)
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
                            what, prefix, method, prefix, preconditioner, KSPConvergedReasons[report->reason],
                            (double)report->claimed, (double)report->asked, (double)report->residual, prefix, prefix));
  else
    PetscCall(PetscSNPrintf(why, length,
                            "the %s solver (-%sksp_type %s, -%spc_type %s) stopped with %s after %" PetscInt_FMT
                            " iterations at a residual of %.3g where %.3g was asked for: try -%sksp_type cg, another "
                            "-%spc_type, a larger -%sksp_max_it or -%sksp_rtol",
                            what, prefix, method, prefix, preconditioner, KSPConvergedReasons[report->reason],
                            report->iterations, (double)report->residual, (double)report->asked, prefix, prefix, prefix,
                            prefix));
  PetscFunctionReturn(PETSC_SUCCESS);
}
