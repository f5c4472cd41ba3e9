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

/* An equation A x = b, the KSP that solves it, and the watch over that. */
typedef struct {
  const char *name; /* "pressure", "viscous": for sentences */
  KSP         ksp;
  Mat         A; /* borrowed: the true residual is of its product, whatever matrix the KSP was given */
  Vec         b, x, scratch[2];
  PetscBool   from_zero; /* the KSP cannot be trusted with a start value */
  void       *context;   /* of the next two */
  /* before an attempt: the start value, the preconditioner. again: the former attempt failed, this one starts from
     zero. NULL: x holds the start value */
  PetscErrorCode (*start)(void *context, PetscBool again);
  /* sets asked, claimed and residual from r = b - A x; *rounding: see SolverJudge. NULL: in the norm of the KSP */
  PetscErrorCode (*measure)(void *context, Vec r, SolverReport *report, PetscReal *rounding);
} Solver;

/* SolverCreate - the KSP: CG with this preconditioner, norm and relative tolerance, and with a start value, then as the
   user's options behind the prefix ("" or "viscous_") say; where their choice cannot work with the norm or a start
   value, the KSP's own norm, or no start value. Refuses (UserError) options that change the equation. The caller has
   set the name and the vectors b and x, and sets A and the functions before SolverSolve. Collective. SolverReset -
   destroys the KSP and the vectors. Collective. */
PetscErrorCode SolverCreate(MPI_Comm comm, const char prefix[], KSPNormType norm, PetscReal rtol, PCType preconditioner,
                            Solver *solver);
PetscErrorCode SolverReset(Solver *solver);
/* SolverSolve - solves, and holds the true residual against what was asked for. A KSP that fails may have been misled
   by a preconditioner made of an older matrix, or by the start value: it tries again without either. One that was right
   only without a start value does not get one any more: those of PETSc 3.18 that take the preconditioner on the right,
   but for the family of gmres and bcgs, apply it to the start value too. Collective. */
PetscErrorCode SolverSolve(Solver *solver, SolverReport *report);

/* SolverTry - makes a call of PETSc's that fails where it cannot do what the user's options ask for, and refuses these
   in a sentence then; equation: "pressure", "viscous". Ranks that fail do not wait long for others that are stuck in
   the call: they end the program. Collective.  SolverTried - what it does after the call. */
#define SolverTry(comm, equation, call)                                                                                \
  do {                                                                                                                 \
    ErrorsCapture(PETSC_TRUE);                                                                                         \
    PetscCall(SolverTried(comm, equation, call));                                                                      \
  } while (0)
PetscErrorCode SolverTried(MPI_Comm comm, const char equation[], PetscErrorCode code);

#endif
