/* Private to pressure/. */
#ifndef ISPH_PRESSURE_IMPL_H
#define ISPH_PRESSURE_IMPL_H

#include "../neighbors/pairs.h"
#include "../operators/operators.h"
#include "../twolevel/twolevel.h"
#include "pressure.h"

#define SURFACE_TABLE 512 /* places of the table of density at a free surface */
#define TYPE_LENGTH   64
#define KEPT_NONE     (-1) /* for Pressure.kept */
#define KEPT_OPERATOR 2

/* The three types. Source: rhs ([n_rows], 1/s2) becomes minus the source of div(grad p/rho). */
typedef PetscErrorCode (*SourceFunction)(Pressure, PetscReal dt, PetscReal rhs[]);
/* Closure: what to add to the diagonal of row a, the sum of whose pairs is 'diagonal'. */
typedef PetscReal (*ClosureFunction)(Pressure, PetscInt a, PetscReal diagonal);
/* Gradient: acceleration ([n_fluid][3], m/s2) becomes -grad p/rho. */
typedef PetscErrorCode (*GradientFunction)(Pressure, PetscReal acceleration[]);

/* A matrix and the arrays that it wraps: i, j, a for columns of this rank; oi, oj, oa for those of other ranks. */
typedef struct {
  Mat          A;
  PetscInt     rows_capacity, capacity, o_capacity;
  PetscInt    *i, *j, *oi, *oj;
  PetscScalar *a, *oa;
} MatrixStore;

/* What the assembled matrix knows of the particles. */
typedef struct {
  PetscInt  layout, halo_builds; /* of the cloud, that this is for */
  PetscInt *of;                  /* [n_total] column of a particle: < n_rows local, else n_rows + place in off_row */
  PetscInt  off_count, *off_row; /* rows of other ranks that ghosts here have, ascending */
  PetscInt *child_first, *child; /* deeper wall particles of row r: child[child_first[r] .. child_first[r + 1]) */
} Columns;

struct _p_Pressure {
  Cloud            cloud; /* borrowed */
  char             source_type[TYPE_LENGTH], closure_type[TYPE_LENGTH], gradient_type[TYPE_LENGTH];
  SourceFunction   source;
  ClosureFunction  closure;
  GradientFunction gradient;
  PetscBool        summed; /* the operators divide by the summed density, not the rest density */

  /* of the source */
  PetscReal relaxation_time, relaxation_option;  /* s, in use and as the user gave it (0: not) */
  PetscReal repair;                              /* the share of the density term that acts, 1 */
  PetscReal lattice_sum;                         /* sum V W on a full lattice, 1 */
  PetscReal surface_plane;                       /* |sum V grad W| on the plane surface of a half space, 1/m */
  PetscReal surface_fraction[SURFACE_TABLE + 1]; /* sum V W over its value inside, by |sum V grad W|/surface_plane */

  /* What sums over the first two layers of a lattice below a flat surface are, from which the
     gradient and the density of surface rows are corrected: see surface_lattice.c */
  PetscReal layer_share;     /* the share of that which is corrected, 1 */
  PetscReal layer_normal[2]; /* |sum V grad W| times the spacing, 1 */
  PetscReal layer_slope[2];  /* what Eq. (9) makes of a hydrostatic pressure of slope 1 */
  PetscReal layer_density;   /* filled fraction of the first layer less that of the table, 1 */

  /* of the closure */
  PetscBool wall_suction;     /* of the density source */
  PetscReal lattice_diagonal; /* Lambda_0 of a row with rest density 1, 1/m2 */
  PetscBool free_surface;     /* any particle of any rank is on one */

  /* of the gradient */
  PetscReal regularization; /* 1 */

  /* Eq. (8) as the sum of pairs: K_ab = weight_scale PairWeight(k) of pair k of the cloud's list, 1/kg m3/m2. Rows are
     multiplied with the mass of their particle times row_scale, the reciprocal of a particle's of the first body. */
  PetscReal row_scale; /* 1/kg */
  PetscReal weight_scale;
  PetscBool
         own_weights; /* densities or volumes differ: the pairs' weights are pair_weight, not the cloud's laplacian */
  float *pair_weight;
  PetscReal *pair_diagonal;    /* [n_rows] sum of K_ab */
  PetscReal *closure_diagonal; /* [n_rows] what the closure adds; where there is nothing, the diagonal of a full row */
  PetscInt   rows_capacity;
  PetscInt64 weight_capacity;
  PetscBool  constant_null; /* no row is closed: the pressure is known up to a constant */
  PetscInt   empty_rows;    /* of all ranks, without pairs: deep in a solid, say. They have no part in the constant */
  PetscReal  dt;            /* s, of the right-hand side */
  PetscReal  kept_share;    /* PressureKeep */

  /* numbers of the rows */
  PetscInt  row_layout;             /* the cloud's layout that they are for */
  PetscInt  row_start, rows_global; /* first row of this rank, rows of all */
  PetscInt *parent_row;             /* [n_owned - n_rows] local row of the parent of deeper wall particles */
  Columns   columns;

  /* free bodies, coupling.c */
  PetscInt            couplings;
  struct _p_Coupling *coupling; /* [couplings]; NULL: none, or not made yet */

  /* the matrix */
  char        mat_type[TYPE_LENGTH];
  PetscBool   assembled;   /* the preconditioner needs entries: A is a matrix, not the operator */
  Mat         operator, A; /* the sum of pairs as a MATSHELL; this step's matrix, borrowed from it or from a store */
  Mat         coupled;     /* the operator with free bodies, as a MATSHELL; NULL without */
  MatrixStore store[2];
  PetscInt    current, kept; /* store of this step's matrix; the preconditioner's, KEPT_NONE or KEPT_OPERATOR */

  /* the solver */
  Solver    solver;
  PetscInt  solver_layout;                /* the cloud's layout that it was made for */
  PetscReal density_tolerance;            /* 1; 0: PETSc's own test */
  PetscReal density_claimed;              /* 1, that the solver stopped at */
  PetscReal density_left;                 /* 1, rms that its residual leaves */
  PetscInt  rebuild_interval, kept_steps; /* the user's choice, 0: none; steps that the preconditioner is kept */
  PetscInt  age, first_iterations;        /* of the preconditioner: steps, and iterations in the first of them */
  PetscBool rebuild;                      /* make it anew in the next step */
};

/* The weight of pair k of the cloud's list, in units of weight_scale. */
static inline PetscReal PairWeight(Pressure pressure, PetscInt64 k)
{
  return pressure->own_weights ? pressure->pair_weight[k] : pressure->cloud->laplacian[k];
}

/* The local row of the parent of particle a of a deeper wall layer, n_rows <= a < n_owned; after RowsNumber. */
static inline PetscInt ParentRow(Pressure pressure, PetscInt a)
{
  return pressure->parent_row[a - pressure->cloud->n_rows];
}

/* RowsNumber - numbers the rows if the cloud's layout is new. Collective. */
PetscErrorCode RowsNumber(Pressure pressure);
/* EquationOf - the operator that the equation of a step has: with free bodies, or without. Not collective. */
static inline Mat EquationOf(Pressure pressure)
{
  return pressure->couplings ? pressure->coupled : pressure->operator;
}

/* MatrixStarts - turns the numbers of entries of the n rows, start[1 .. n], into their starts and the end of the last.
   PETSc keeps them as PetscInt, so more entries on a rank are refused (UserError): have_room is false. Not collective.
 */
void MatrixStarts(PetscInt n, PetscInt start[], PetscBool *have_room);
/* MatrixAssemble - the matrix of OperatorSetUp with its entries into store s. Collective. */
PetscErrorCode MatrixAssemble(Pressure pressure, MatrixStore *s);
PetscErrorCode MatrixStoreReset(MatrixStore *s);
PetscErrorCode ColumnsReset(Columns *columns);
/* OperatorSetUp - weights of the pairs, their sums and what the closure adds, at the positions of the cloud; creates
   the operator if there is none. Collective. */
PetscErrorCode OperatorSetUp(Pressure pressure);

/* CouplingSetUp - what free bodies do to the rows, after OperatorSetUp. Collective. CouplingAdd - adds to the product y
   with the pressures p (both [n_rows], Pa) what the bodies they push do. Collective. */
PetscErrorCode CouplingSetUp(Pressure pressure);
PetscErrorCode CouplingAdd(Pressure pressure, const PetscScalar p[], PetscScalar y[]);
PetscErrorCode CouplingReset(Pressure pressure);
/* InterfaceSetUp - gives wall particles the liquid that they touch, and its jump of the pressure, ghosts too; after
   RowsNumber. Collective. InterfaceAdd - adds what the jumps contribute to the right-hand side ([n_rows]), after
   OperatorSetUp. InterfaceSum - adds to sum the jumps between particle a and its neighbours of the other liquid, times
   the row's factor and x_b - x_a. They do nothing where liquids mix. Not collective. */
PetscErrorCode InterfaceSetUp(Pressure pressure);
void           InterfaceAdd(Pressure pressure, PetscScalar rhs[]);
void           InterfaceSum(Cloud cloud, PetscInt a, const PairRow *row, PetscReal sum[DIM]);

/* SetConvergence - after the solver's options have been read: it stops at density_tolerance, or else at -ksp_rtol and
   -ksp_atol in the 2-norm of the residual. Collective. */
PetscErrorCode SetConvergence(Pressure pressure);
/* ResidualMeasure - of SolverSolve: the residual r in the 2-norm or as the largest density error; also density_left.
   Collective. */
PetscErrorCode ResidualMeasure(void *context, Vec r, SolverReport *report, PetscReal *rounding);

/* SurfaceLattice - sets the layer_... . Not collective. */
void SurfaceLattice(Pressure pressure);
/* SurfaceSlope, SurfaceDensity - by what Eq. (9) is too large in the row of particle a on or near the surface; what is
   to be added to its filled fraction. Not collective. */
PetscReal SurfaceSlope(Pressure pressure, PetscInt a);
PetscReal SurfaceDensity(Pressure pressure, PetscInt a);

PetscErrorCode SourceDensity(Pressure, PetscReal, PetscReal[]);
PetscErrorCode SourceDivergence(Pressure, PetscReal, PetscReal[]);
PetscReal      ClosureDoubled(Pressure, PetscInt, PetscReal);
PetscReal      ClosureFull(Pressure, PetscInt, PetscReal);
PetscErrorCode GradientSymmetric(Pressure, PetscReal[]);
PetscErrorCode GradientCorrected(Pressure, PetscReal[]);
PetscErrorCode GradientConserved(Pressure, PetscReal[]);

#endif
