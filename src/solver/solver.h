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
/* SolverExplain - why a solver failed, in a sentence of at most 'length' bytes. Not collective. */
PetscErrorCode SolverExplain(KSP ksp, const SolverReport *report, const char equation[], char why[], size_t length);

/* SolverTry - makes a call of PETSc's that fails where it cannot do what the user's options ask for, and refuses these
   in a sentence then; equation: "pressure", "viscous". Ranks that fail do not wait long for others that are stuck in
   the call: they end the program. Collective.  SolverTried - what it does after the call. */
#define SolverTry(comm, equation, call)                                                                                \
  do {                                                                                                                 \
    ErrorsKeep(PETSC_TRUE);                                                                                            \
    PetscCall(SolverTried(comm, equation, call));                                                                      \
  } while (0)
PetscErrorCode SolverTried(MPI_Comm comm, const char equation[], PetscErrorCode code);
/* SolverSetFromOptions - KSPSetFromOptions for a solver whose norm and start value are set; where the user's choice
   cannot work with them, the solver's own norm, or no start value. Refuses options that change the equation.
   Collective.
 */
PetscErrorCode SolverSetFromOptions(KSP ksp, const char equation[]);

#endif
