/* Floor 5: the pressure projection. Eq. (8) of Kuri et al., sum_b K_ab (p_a - p_b) = -source, as an operator that sums
   over the pairs or as a matrix with entries (-mat_type), solved by a KSP without a prefix: -ksp_type, -pc_type and
   -ksp_rtol act on it.

   Three types that can be chosen independently make a projection: the source (source.c), the closure at the free
   surface (closure.c) and the gradient (gradient.c). The operator is symmetric and positive: rows are multiplied with
   the volume, and deeper wall particles are folded into their parent (P^T A P). Pairs of wall particles are left out,
   so that a wall conducts no pressure along itself. Rows of a dry wall are identity rows. */
#ifndef ISPH_PRESSURE_H
#define ISPH_PRESSURE_H

#include "../solver/solver.h"
#include "../neighbors/cloud.h"

typedef struct _p_Pressure *Pressure;

#define PRESSURE_EQUATION "pressure" /* for SolverTry and SolverExplain */

#define SOURCE_DENSITY "density" /* (rho_0 - rho)/(rho_0 dt^2), Eq. (8): density invariance */
#define SOURCE_DIVERGENCE                                                                                              \
  "divergence" /* corrected divergence over dt, plus e/(dt T), e the surface-corrected density defect */
#define CLOSURE_DOUBLED    "doubled"       /* Eq. (11), Bockmann 2012: diagonal of surface rows doubled */
#define CLOSURE_FULL       "full_diagonal" /* Nair & Tomar 2014: diagonal filled up to that of a full neighbourhood */
#define GRADIENT_SYMMETRIC "symmetric"     /* Eq. (9): p_a/rho_a^2 + p_b/rho_b^2, conserves momentum */
#define GRADIENT_CORRECTED                                                                                             \
  "corrected" /* B_a (p_b - p_a)/rho_a and a background pressure inside, symmetric at the surface */
#define GRADIENT_CONSERVED "conserved" /* corrected; neighbours compensate the error of momentum */

typedef struct {
  SolverReport solver;  /* residuals: 2-norms over the rows, or with -pressure_density_tolerance density errors (1) */
  PetscReal    density; /* rms relative density error that the true residual leaves after the step, 1 */
  PetscBool    rebuilt; /* the preconditioner was rebuilt */
} PressureResult;

/* PressureCreate - for a cloud (borrowed). Collective. */
PetscErrorCode PressureCreate(Cloud cloud, Pressure *pressure);
/* PressureSetTypes - source, closure, gradient; summed: operators use the summed density (the paper) or the rest
 * density. Not collective. */
PetscErrorCode PressureSetTypes(Pressure pressure, const char source[], const char closure[], const char gradient[],
                                PetscBool summed);
/* PressureSetRelaxationTime - sets T (s) of the density term. PressureSetRepair - sets the share (1) of the density
   term that acts: 1, or less in the first steps of a run, so that errors of the packing do not kick liquid at rest. Not
   collective. */
PetscErrorCode PressureSetRelaxationTime(Pressure pressure, PetscReal time);
void           PressureSetRepair(Pressure pressure, PetscReal share);
/* PressureHolds - whether the velocity of fluid particle a is given, so that no pressure moves it.
   PressureDensityDefect
   - the density defect e_a = F_a - rho_a/(rho_0 S) (1), due neither to the free surface, F_a, nor to the kernel, S; 0
   of what is held, whose correction would only push the liquid that has left. After OperatorsFreeSurface. Not
   collective.
 */
PetscBool PressureHolds(Pressure pressure, PetscInt a);
PetscReal PressureDensityDefect(Pressure pressure, PetscInt a);
/* PressureSetFromOptions - -pressure_source, -pressure_closure, -pressure_gradient,
   -pressure_regularization, -pressure_relaxation_time (s; 0: the stepper's choice), -pressure_wall_suction,
   -pressure_density_tolerance, -mat_type; the KSP's options act at its creation.
   Collective. */
PetscErrorCode PressureSetFromOptions(Pressure pressure);
PetscErrorCode PressureView(Pressure pressure, PetscViewer viewer);
PetscErrorCode PressureDestroy(Pressure *pressure);

/* PressureSolve - assembles at the positions of the cloud and solves for FIELD_PRESSURE (Pa) of owned particles and
   ghosts; the former pressure is the initial guess. Reads FIELD_DENSITY (owned and ghosts), FIELD_DIVERGENCE (if
   PressureTakesDivergence), FIELD_CORRECTION, FIELD_LAMBDA, FIELD_NORMAL, FIELD_CAPILLARY (the pressure outside the
   free surface), INT_SURFACE of owned particles. A solver that does not converge, or whose claim to have converged is
   false, is tried again from zero with a new preconditioner. A second failure is no error (see SolverFailed); the
   pressure is then unchanged. dt in s. Collective. */
PetscErrorCode PressureSolve(Pressure pressure, PetscReal dt, PressureResult *result);
/* PressureSetKeptShare - for the next solves: the given velocity has the effect of this share (1) of the cloud's former
   pressure already, so the equation is for the remaining pressure. FIELD_PRESSURE becomes the whole pressure. 0:
   nothing is kept. PressureKeptShare - returns the share. Not collective. */
PetscErrorCode PressureSetKeptShare(Pressure pressure, PetscReal share);
PetscReal      PressureKeptShare(Pressure pressure);
/* PressureAssemble - makes only the matrix and right-hand side of PressureSolve, for tests and views; borrowed until
   the next call. Collective. */
PetscErrorCode PressureAssemble(Pressure pressure, PetscReal dt, Mat *A, Vec *b);
/* PressureSetUp - PressureAssemble, then sets up solver and preconditioner, which read all their options.
   Collective. */
PetscErrorCode PressureSetUp(Pressure pressure, PetscReal dt);
/* PressureSolver - the KSP and the right-hand side of the last PressureSetUp or PressureSolve, borrowed until the next
   call. Not collective. */
PetscErrorCode PressureSolver(Pressure pressure, KSP *ksp, Vec *b);
/* PressureCapillary - the contribution of FIELD_CAPILLARY to the right-hand side with the closures of the last
   PressureSetUp; values [n_rows]. Not collective. */
PetscErrorCode PressureCapillary(Pressure pressure, PetscReal values[]);
/* PressureToCloud - sets FIELD_PRESSURE (Pa) of owned particles and ghosts from the rows x of a solution.
   Collective. */
PetscErrorCode PressureToCloud(Pressure pressure, Vec x);
/* PressureGradientCorrected - whether -pressure_gradient is corrected. Not collective. */
PetscBool PressureGradientCorrected(Pressure pressure);
/* PressureMultiply - y = A p as a sum over pairs, without a matrix; p and y [n_rows]. For tests. Collective. */
PetscErrorCode PressureMultiply(Pressure pressure, const PetscReal p[], PetscReal y[]);
/* PressureSource - rhs[n_rows]: minus the source of div(grad p/rho) in PressureSolve, 1/s2; reads the same fields.
   Collective. */
PetscErrorCode PressureSource(Pressure pressure, PetscReal dt, PetscReal rhs[]);
/* PressureTakesDivergence - whether the source is FIELD_DIVERGENCE over dt; else it is the compression over dt^2. Not
   collective. */
PetscBool PressureTakesDivergence(Pressure pressure);
/* PressurePredict - begins a step that balances the body force which the pressure is expected to carry (balance.c),
   from FIELD_CARRIED; after a search. PressureTakeCarried - takes its acceleration S from acceleration ([n_fluid][3],
   m/s2). PressureKeepCarried - ends the step: sets FIELD_CARRIED from 'rest', that of PressureAcceleration.
   PressureCarries - whether some liquid of some rank carried a force in the last PressurePredict, which is collective.
   PressureShare - w (1) of particle a in this step: the share of the force that its pressure is expected to carry. */
PetscBool      PressureCarries(Pressure pressure);
PetscReal      PressureShare(Pressure pressure, PetscInt a);
PetscErrorCode PressurePredict(Pressure pressure);
void           PressureTakeCarried(Pressure pressure, PetscReal acceleration[]);
void           PressureKeepCarried(Pressure pressure, const PetscReal rest[]);
/* PressureDepth - the depth (m) of particle a below the surface that it sees, by its |sum V grad W|. PressureSurrounds
   - the pressure (Pa) outside the surface of fluid particle a, of surface tension and of what is carried, and its slope
   (Pa/m; NULL: not wanted) along the surface. Not collective. */
PetscReal PressureDepth(Pressure pressure, PetscInt a);
PetscReal PressureSurrounds(Pressure pressure, PetscInt a, PetscReal slope[DIM]);
/* PressureAcceleration - acceleration ([n_fluid][3], m/s2) -grad p/rho of the fluid, less the part that
   PressureTakeCarried has taken. Collective. */
PetscErrorCode PressureAcceleration(Pressure pressure, PetscReal acceleration[]);
/* PressureSlopeAcceleration - what a slope (Pa/m) of the pressure outside adds to the acceleration (m/s2) of fluid
   particle a. Not collective. */
void PressureSlopeAcceleration(Pressure pressure, PetscInt a, const PetscReal slope[DIM], PetscReal out[DIM]);
/* PressureRelaxationTime - the time (s) in which density errors are corrected. Not collective. */
PetscReal PressureRelaxationTime(Pressure pressure);
/* Something that the pressures move and whose motion changes the divergence of some rows, as a body that floats or a
   pocket of gas does. With c the divergence of the rows, times their weights, for each unit motion and M the inertia,
   the operator gets the term L = c M^-1 c^T of low rank, symmetric; the preconditioner is that of the operator without
   it. A pressure outside that is known, as that
   of an outlet is, adds to the right side alone. Any hook may be NULL. All are collective. */
typedef struct {
  PetscErrorCode (*set_up)(void *context, Pressure pressure); /* before a solve, at the positions of the cloud */
  PetscErrorCode (*add)(void *context, Pressure pressure, const PetscScalar p[], PetscScalar y[]); /* y += L p */
  PetscErrorCode (*right_side)(void *context, Pressure pressure, PetscScalar rhs[]);
  PetscErrorCode (*solved)(void *context, Pressure pressure); /* FIELD_PRESSURE is new */
  /* adds to the pressure outside the free surface ([n_fluid], Pa) and its slope ([n_fluid][3], Pa/m) what is there
     besides surface tension */
  PetscErrorCode (*outside)(void *context, Pressure pressure, PetscReal outside[], PetscReal slope[]);
  /* adds to the forces on dummy particles ([n_total][3], N) that of what is outside the liquid and beside them */
  PetscErrorCode (*load)(void *context, Pressure pressure, PetscReal force[]);
  /* what moves under such forces: adds L of the motion to y ([n_rows]), as for a pressure with these forces, and sets
     the accelerations ([n_total][3], m/s2) of its dummy particles of this rank */
  PetscErrorCode (*yield)(void *context, Pressure pressure, const PetscReal force[], PetscReal acceleration[],
                          PetscReal y[]);
  /* *held: L holds the level of the pressure where no row is closed, as the ram of a hydraulic jack does */
  PetscErrorCode (*level)(void *context, Pressure pressure, PetscBool *held);
} LowRank;

/* PressureAddLowRank - adds a term to the equations to come; what is given must last as long as they. PressureParent -
   the local row of owned particle a, that of its parent for a deeper wall particle; PressureRow - the same; -1: it has
   no pairs. PressureRowWeight - the factor (1) of the row of particle a: its volume over that on the
   lattice, or with summed densities its mass over that of a particle of the first body. Not collective. PressureNumber
   - finds the rows of the cloud's present order, which PressureParent needs before a solve. PressureLoad, PressureYield
   - the hooks of all terms; PressureYields - whether a term has 'yield'. Collective. */
PetscErrorCode PressureAddLowRank(Pressure pressure, const LowRank *term, void *context);
PetscErrorCode PressureLoad(Pressure pressure, PetscReal force[]);
PetscErrorCode PressureYield(Pressure pressure, const PetscReal force[], PetscReal acceleration[], PetscReal y[]);
PetscBool      PressureYields(Pressure pressure);
PetscErrorCode PressureNumber(Pressure pressure);
PetscInt       PressureParent(Pressure pressure, PetscInt a);
PetscInt       PressureRow(Pressure pressure, PetscInt a);
PetscReal      PressureRowWeight(Pressure pressure, PetscInt a);
/* PressureCloses - whether the row of fluid particle a is near a free surface, so that it may be closed.
   PressureClosure
   - the closures of the last solve, [n_rows], zero in rows that are not closed. PressureStep - the step (s) of the
   equation. PressureFull - sum V W on a full lattice (1). Not collective. */
PetscBool        PressureCloses(Pressure pressure, PetscInt a);
const PetscReal *PressureClosure(Pressure pressure);
PetscReal        PressureStep(Pressure pressure);
PetscReal        PressureFull(Pressure pressure);
/* PressureIsClosed - whether the last solve had no closed row, and no term that holds the level of the pressure: the
   liquid has nowhere to go. Not collective. */
PetscBool PressureIsClosed(Pressure pressure);
/* PressureDensity - the density by which the operators divide, [n_total] kg/m3: summed or rest. Not collective. */
const PetscReal *PressureDensity(Pressure pressure);
/* PressureLattice - properties of a full lattice. diagonal: Lambda_0 of Nair & Tomar, the diagonal of Eq. (8) for V =
   d0^dim and density 1 (1/m2). sum: sum V W with the particle itself, which counts as rest density in the density term
   (1). Not collective. */
void PressureLattice(Cloud cloud, PetscReal *diagonal, PetscReal *sum);

/* PressureReset - drops the preconditioner and the solver, as after a restart. Collective. */
PetscErrorCode PressureReset(Pressure pressure);

#endif
