/* Floor 1: what pressure and implicit viscosity share about their solvers. A solver's word is not taken for it: after
   each solve the true residual b - A x, of a product of its own, is held against what was asked for. */
#ifndef ISPH_SOLVER_H
#define ISPH_SOLVER_H

#include "../base/base.h"

/* A residual may exceed what was asked for by this factor: norms that solvers carry along instead of computing them
   drift. CG stayed within 1 + 1e-5 at tolerances down to 1e-10. */
#define SOLVER_SLACK 1.1
/* Nor can a residual be smaller than the rounding of the product: it may be so many units of rounding of
   |diagonal x| in any case. CG comes to between 1 and 4 of them. */
#define SOLVER_ROUNDING 20

typedef struct {
  KSPConvergedReason reason;                   /* what the solver says; 0: nothing was solved */
  PetscInt           iterations;               /* of all attempts */
  PetscReal          asked, claimed, residual; /* the residual asked for, the solver's own, and the true one */
  PetscBool          lied;                     /* it claims to have converged, and its residual says that it has not */
} SolverReport;

/* SolverFailed - whether the solver gave up or lied. Not collective. */
static inline PetscBool SolverFailed(const SolverReport *report)
{
  return (PetscBool)(report->reason < 0 || report->lied);
}

/* SolverJudge - sets 'lied' from the other entries; rounding: |diagonal x|, in the unit of the residual. A residual
   that is not a number is a lie. Not collective. */
void SolverJudge(SolverReport *report, PetscReal rounding);
/* SolverExplain - why a solver failed, in a sentence of at most 'length' bytes; what: "pressure", "viscous"; prefix: of
   its options, "" or "viscous_". Not collective. */
PetscErrorCode SolverExplain(KSP ksp, const SolverReport *report, const char what[], char why[], size_t length);

#endif
