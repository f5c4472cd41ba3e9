/* Private to pressure/. */
#ifndef ISPH_PRESSURE_TYPES_H
#define ISPH_PRESSURE_TYPES_H

#include "../neighbors/pairs.h"
#include "../operators/operators.h"
#include "../twolevel/twolevel.h"
#include "pressure.h"

#define SURFACE_TABLE 512
#define KEPT_OPERATOR 2 /* for Pressure.kept */

/* rhs[n_rows], to be multiplied by the row's mass later: minus the source of div(grad p/rho). */
typedef PetscErrorCode (*SourceFunction)(Pressure, PetscReal dt, PetscReal rhs[]);
/* What to add to the diagonal of row a, whose pair sum is 'diagonal' (already scaled). */
typedef PetscReal (*ClosureFunction)(Pressure, PetscInt a, PetscReal diagonal);
typedef PetscErrorCode (*GradientFunction)(Pressure, PetscReal acceleration[]);

/* One matrix with the arrays it wraps: local block i, j, a; columns of other ranks oi, oj, oa. */
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
  char             source_type[64], closure_type[64], gradient_type[64], mat_type[64];
  SourceFunction   source;
  ClosureFunction  closure;
  GradientFunction gradient;
  PetscBool        summed;
  /* Eq. (8) as the sum of pairs: K_ab = weight_scale PairWeight(k) of pair k of the cloud's list, 1/kg m3/m2 */
  PetscBool   mixed_density; /* densities differ: the pairs' weights are pair_weight, not the cloud's laplacian */
  float      *pair_weight;
  PetscReal   weight_scale;
  PetscReal  *pair_diagonal, *closure_diagonal; /* [n_rows] sum of K_ab; what the closure adds */
  PetscInt    rows_capacity, weight_capacity;
  PetscReal   relaxation_time, relaxation_option;
  PetscReal   lattice_diagonal;                                   /* Lambda_0 of a row with rest density 1 */
  PetscReal   lattice_sum;                                        /* sum V W on a full lattice, 1 */
  PetscReal   surface_plane, surface_fraction[SURFACE_TABLE + 1]; /* w1(0) and F as function of w1/w1(0) */
  PetscInt    row_layout;             /* the cloud's layout that the rows are numbered for */
  PetscInt    row_start, rows_global; /* first row of this rank, rows of all */
  PetscInt   *parent_row;             /* [n_owned - n_rows] local row of the parent of deeper wall particles */
  Columns     columns;
  PetscReal   row_scale; /* 1/m_ref */
  MatrixStore store[2];
  PetscInt    current, kept; /* stores of this step's matrix and of the preconditioner's; -1: none, or
                                KEPT_OPERATOR */
  Mat       operator, A;     /* the sum of pairs as a MATSHELL; this step's matrix, borrowed from it or from a store */
  KSP       ksp;
  Vec       b, x;
  PetscInt  solver_layout;  /* the local order the solver was made for */
  PetscReal closure_factor; /* of the filling of full_diagonal */
  PetscReal regularization; /* background pressure of the corrected gradient over h |grad p| */
  PetscBool free_surface;   /* any particle is on one */
  PetscBool constant_null;
  PetscBool assembled; /* the solver needs entries: a matrix, not the operator */
  PetscInt  age, rebuild_interval, kept_steps,
    first_iterations;          /* kept_steps: rebuild_interval, or what suits the preconditioner */
  PetscReal dt;                /* s, of the system assembled last */
  PetscReal density_tolerance; /* 1; 0: PETSc's own test */
  Vec       scratch[2];
  PetscReal rebuild_growth;
  PetscBool rebuild;
};

static inline PetscReal PairWeight(Pressure pressure, PetscInt k)
{
  return pressure->mixed_density ? pressure->pair_weight[k] : pressure->cloud->laplacian[k];
}

/* The local row of the parent of particle a of a deeper wall layer, n_rows <= a < n_owned; after RowsNumber. */
static inline PetscInt ParentRow(Pressure pressure, PetscInt a)
{
  return pressure->parent_row[a - pressure->cloud->n_rows];
}

/* RowsNumber - numbers the rows if the cloud's layout is new. Collective. */
PetscErrorCode RowsNumber(Pressure pressure);
/* MatrixAssemble - the matrix of OperatorSetUp with its entries into store s. Collective. */
PetscErrorCode MatrixAssemble(Pressure pressure, MatrixStore *s);
PetscErrorCode MatrixStoreReset(MatrixStore *s);
PetscErrorCode ColumnsReset(Columns *columns);
/* OperatorSetUp - weights of the pairs, their sums and what the closure adds, at the positions of the cloud; creates
   the operator if there is none. Collective. */
PetscErrorCode OperatorSetUp(Pressure pressure);

/* SetDensityConvergence - the solver stops at density_tolerance. Collective. */
PetscErrorCode SetDensityConvergence(Pressure pressure);
/* ResidualDensity - relative density error (1) that the residual leaves after the step, of a finished solve or of the
   iterate within one: largest and root mean square over the rows. Collective. */
PetscErrorCode ResidualDensity(Pressure pressure, PetscBool finished, PetscReal *largest, PetscReal *rms);

PetscErrorCode SourceDensity(Pressure, PetscReal, PetscReal[]);
PetscErrorCode SourceDivergence(Pressure, PetscReal, PetscReal[]);
PetscReal      ClosureDoubled(Pressure, PetscInt, PetscReal);
PetscReal      ClosureFull(Pressure, PetscInt, PetscReal);
PetscErrorCode GradientSymmetric(Pressure, PetscReal[]);
PetscErrorCode GradientCorrected(Pressure, PetscReal[]);
PetscErrorCode GradientConserved(Pressure, PetscReal[]);

#endif
