/* Private to pressure/. */
#ifndef ISPH_PRESSURE_IMPL_H
#define ISPH_PRESSURE_IMPL_H

#include "../neighbors/pairs.h"
#include "../operators/operators.h"
#include "../twolevel/twolevel.h"
#include "pressure.h"

#define SURFACE_TABLE 512 /* intervals of the table of density at a free surface */
#define DEPTH_TABLE   64  /* intervals of the table of depths */
#define DEPTH_FINE    8   /* points of the search for an entry of this table, over its entries */
#define TYPE_LENGTH   OPTION_WORD_LENGTH
#define KEPT_NONE     (-1) /* for Pressure.kept */
#define KEPT_OPERATOR 2

/* The three types. Source: sets rhs ([n_rows], 1/s2) to minus the source of div(grad p/rho). */
typedef PetscErrorCode (*SourceFunction)(Pressure, PetscReal dt, PetscReal rhs[]);
/* Closure: returns the addition to the diagonal of row a. diagonal: the sum of the row's pairs. */
typedef PetscReal (*ClosureFunction)(Pressure, PetscInt a, PetscReal diagonal);
/* Gradient: sets acceleration ([n_fluid][3], m/s2) to -grad p/rho. */
typedef PetscErrorCode (*GradientFunction)(Pressure, PetscReal acceleration[]);

/* A matrix and the arrays that it wraps: i, j, a for columns of this rank; oi, oj, oa for those of other ranks. */
typedef struct {
  Mat          A;
  PetscInt     rows_capacity, capacity, o_capacity;
  PetscInt    *i, *j, *oi, *oj;
  PetscScalar *a, *oa;
} MatrixStore;

/* The columns of the assembled matrix. */
typedef struct {
  PetscInt  layout, halo_builds; /* of the cloud, for which the columns are numbered */
  PetscInt *of;                  /* [n_total] column of a particle: < n_rows: local; else n_rows + index in off_row */
  PetscInt  off_count, *off_row; /* rows of other ranks that ghosts here have, ascending */
  PetscInt *child_first, *child; /* deeper wall particles of row r: child[child_first[r] .. child_first[r + 1]) */
} Columns;

#define LOW_RANKS_MOST 4 /* terms of PressureAddLowRank */

/* Entries of the registries of pressure.c. */
typedef struct {
  Choice         choice;
  SourceFunction apply;
} SourceChoice;
typedef struct {
  Choice          choice;
  ClosureFunction apply;
} ClosureChoice;
typedef struct {
  Choice           choice;
  GradientFunction apply;
} GradientChoice;

struct _p_Pressure {
  Cloud            cloud; /* borrowed */
  char             source_type[TYPE_LENGTH], closure_type[TYPE_LENGTH], gradient_type[TYPE_LENGTH];
  SourceFunction   source;
  ClosureFunction  closure;
  GradientFunction gradient;
  PetscBool        summed; /* the operators divide by the summed density, not the rest density */

  /* of the source */
  PetscReal relaxation_time, relaxation_option;  /* s, in use, and the option (0: not set) */
  PetscReal repair;                              /* the share of the density term that acts, 1 */
  PetscReal lattice_sum;                         /* sum V W on a full lattice, 1 */
  PetscReal surface_plane;                       /* |sum V grad W| on the plane surface of a half space, 1/m */
  PetscReal surface_fraction[SURFACE_TABLE + 1]; /* sum V W over its value inside, by |sum V grad W|/surface_plane */

  /* Sums at the first two layers of a lattice below a flat surface, which correct the gradient and the density of
     surface rows: see surface_lattice.c */
  PetscReal layer_share;     /* the share of the error that is corrected, 1 */
  PetscReal layer_normal[2]; /* |sum V grad W| times the spacing, 1 */
  PetscReal layer_slope[2];  /* gradient by Eq. (9) of a hydrostatic pressure of slope 1 */
  PetscReal layer_density;   /* filled fraction of the first layer less the table's value, 1 */

  /* of the closure */
  PetscBool wall_suction;     /* walls may pull by the density source */
  PetscReal lattice_diagonal; /* Lambda_0 of a row with rest density 1, 1/m2 */
  PetscBool free_surface;     /* some particle of some rank is on a free surface or near one */

  /* of what is carried: balance.c */
  PetscBool  balanced; /* the gradient knows what is carried: the corrected one */
  PetscBool  carries;  /* some liquid carries a force */
  PetscBool  balances; /* it does, between PressurePredict and PressureKeepCarried */
  PetscReal *carried;  /* [n_total][3] T, Pa/m */
  PetscReal *place;    /* [n_total][3] where the pressure of a particle holds, m */
  PetscReal *load;     /* [n_total][3] rho w, kg/m3; f.place, J/kg, if f is uniform; the pressure, Pa, in a gradient */
  PetscBool  uniform;
  PetscInt   balance_capacity;
  PetscReal  depth[DEPTH_TABLE + 1]; /* m, at which |sum V grad W| is k/DEPTH_TABLE of that on a plane surface */

  /* of the gradient */
  PetscReal  regularization; /* 1 */
  PetscReal *outside;        /* [n_fluid] Pa, outside the free surface, while the gradient is computed */
  PetscReal *outside_slope;  /* [n_fluid][3] Pa/m, its gradient along the surface */

  /* The operator as the sum of pairs: K_ab = weight_scale PairWeight(k) of pair k of the cloud's list, m/kg. */
  PetscReal  reference; /* kg/m3, rest density of the first body */
  PetscReal  weight_scale;
  PetscBool  own_weights; /* densities or volumes differ: pairs have pair_weight, not the cloud's laplacian */
  float     *pair_weight;
  PetscReal *weight_sum;       /* [n_owned] of pair_weight */
  PetscReal *pair_diagonal;    /* [n_rows] sum of K_ab */
  PetscReal *closure_diagonal; /* [n_rows] the closure's addition; an empty row has a full diagonal */
  PetscReal *level_diagonal;   /* [n_rows] for the preconditioner, if terms of low rank hold the level: see FindLevel */
  PetscInt   rows_capacity, sum_capacity;
  PetscInt64 weight_capacity;
  PetscBool  constant_null; /* neither closed rows nor terms of low rank hold the level of the pressure */
  PetscBool  level_held;    /* terms of low rank hold it, and no row is closed */
  PetscInt  empty_rows; /* rows without pairs, of all ranks, for instance deep in a solid; the constant is zero there */
  PetscReal dt;         /* s, of the right-hand side */
  PetscReal level;      /* Pa, what the solver's pressures are above, while it solves */
  PetscReal kept_share; /* PressureSetKeptShare */

  /* numbers of the rows */
  PetscInt  row_layout;             /* the cloud's layout for which they are numbered */
  PetscInt  row_start, rows_global; /* first row of this rank, rows of all ranks */
  PetscInt *parent_row;             /* [n_owned - n_rows] local row of the parent of deeper wall particles */
  Columns   columns;

  /* PressureAddLowRank */
  PetscInt low_ranks;
  struct {
    const LowRank *term;
    void          *context;
  } low_rank[LOW_RANKS_MOST];

  /* the matrix */
  char        mat_type[PETSC_MAX_PATH_LEN];
  PetscBool   assembled;   /* the preconditioner needs entries: A is a matrix, not the operator */
  Mat         operator, A; /* the sum of pairs as a MATSHELL; this step's matrix, borrowed from 'operator' or a store */
  Mat         coupled;     /* the operator with the terms of low rank, as a MATSHELL; NULL without */
  MatrixStore store[2];
  PetscInt current, kept; /* store of this step's matrix; store of the preconditioner's, KEPT_NONE or KEPT_OPERATOR */

  /* the solver */
  Solver    solver;
  PetscInt  solver_layout;         /* the cloud's layout for which the solver was made */
  PetscReal density_tolerance;     /* 1; 0: PETSc's own test */
  PetscReal density_claimed;       /* 1, largest error at which the solver stopped */
  PetscReal density_left;          /* 1, rms error that the solver's residual leaves */
  PetscInt  kept_steps;            /* steps for which the preconditioner is kept */
  PetscInt  age, first_iterations; /* of the preconditioner: steps, and iterations in its first step */
  PetscBool rebuild;               /* rebuild the preconditioner in the next step */
};

/* PressureShare of particle a. */
static inline PetscReal ShareOf(Pressure pressure, PetscInt a)
{
  return pressure->carries ? pressure->load[DIM * a] / pressure->cloud->rest_density[a] : 0;
}

/* The weight of pair k of the cloud's list, in units of weight_scale. */
static inline PetscReal PairWeight(Pressure pressure, PetscInt64 k)
{
  return pressure->own_weights ? pressure->pair_weight[k] : pressure->cloud->laplacian[k];
}

/* The weights of SIMD_WIDTH pairs from k on: SimdCoded of the cloud; SimdWeights of it, or, if it is NULL, 'plain'. */
static inline Simd SimdCoded(const uint16_t *coded, PetscInt64 k)
{
  typedef uint16_t Coded __attribute__((vector_size(SIMD_WIDTH * sizeof(uint16_t))));
  Coded            t;

#if defined(__AVX512F__)
  return (Simd)_mm512_cvtepi32_pd(_mm256_cvtepu16_epi32(_mm_loadu_si128((const __m128i *)(coded + k))));
#elif defined(__AVX2__)
  return (Simd)_mm256_cvtepi32_pd(_mm_cvtepu16_epi32(_mm_loadl_epi64((const __m128i *)(coded + k))));
#endif
  (void)memcpy(&t, coded + k, sizeof(t));
  return __builtin_convertvector(t, Simd);
}

static inline Simd SimdWeights(const uint16_t *coded, const float *plain, PetscInt64 k)
{
  return coded ? SimdCoded(coded, k) : SimdLoadSingle(plain + k);
}

/* The factor (1) of the row of a particle with this volume (m3) and rest density (kg/m3): see PressureRowWeight. */
static inline PetscReal RowWeight(Pressure pressure, PetscReal volume, PetscReal rest)
{
  return volume / pressure->cloud->domain->volume * (pressure->summed ? rest / pressure->reference : 1);
}

/* The local row of the parent of particle a of a deeper wall layer, n_rows <= a < n_owned; after RowsNumber. */
static inline PetscInt ParentRow(Pressure pressure, PetscInt a)
{
  return pressure->parent_row[a - pressure->cloud->n_rows];
}

/* RowsNumber - numbers the rows if the cloud's layout is new. Collective. */
PetscErrorCode RowsNumber(Pressure pressure);
/* PressureDiagonal - the diagonal of row r in the matrix of the preconditioner. Not collective. */
static inline PetscReal PressureDiagonal(Pressure pressure, PetscInt r)
{
  return pressure->pair_diagonal[r] + pressure->closure_diagonal[r] +
         (pressure->level_held ? pressure->level_diagonal[r] : 0);
}

/* EquationOf - the operator of a step's equation, with the terms of low rank. Not collective. */
static inline Mat EquationOf(Pressure pressure)
{
  return pressure->low_ranks ? pressure->coupled : pressure->operator;
}

/* MatrixStarts - turns the numbers of entries of the n rows, start[1 .. n], into the starts of the rows and the end of
   the last. *have_room: the entries can be counted in PetscInt, as PETSc needs. Not collective. */
void MatrixStarts(PetscInt n, PetscInt start[], PetscBool *have_room);
/* MatrixAssemble - assembles the operator of OperatorSetUp into store s. Refuses (UserError) more entries on a rank
   than PetscInt can count. Collective. */
PetscErrorCode MatrixAssemble(Pressure pressure, MatrixStore *s);
PetscErrorCode MatrixStoreReset(MatrixStore *s);
PetscErrorCode ColumnsReset(Columns *columns);
/* OperatorSetUp - computes the weights of the pairs, their sums and the closure's additions at the positions of the
   cloud; creates the operator at first. Collective. */
PetscErrorCode OperatorSetUp(Pressure pressure);
/* JumpsSetUp - gives wall particles, ghosts too, the liquid that they touch and its pressure jump; after
   RowsNumber. Collective. JumpsAdd - adds the contribution of the jumps to the right-hand side ([n_rows]), after
   OperatorSetUp. JumpsSum - adds to 'sum' the jumps between particle a and its neighbours of the other liquid,
   times the row's factor and x_b - x_a; 'mean': where the pressure's difference counts rho_a over the mean density of
   both, but for the slope of the jump. All do nothing if liquids
   mix. Not collective. */
PetscErrorCode JumpsSetUp(Pressure pressure);
void           JumpsAdd(Pressure pressure, PetscScalar rhs[]);
void           JumpsSum(Cloud cloud, PetscInt a, const PairRow *row, PetscBool mean, PetscReal sum[DIM]);

/* BalanceSetUp - makes the table of PressureDepth. BalanceAdd - adds what is carried inside the liquid to the
   right-hand side ([n_rows]). BalanceOf - what of particle a BalanceTo needs; BalanceTo - T_ab.(y_b - y_a) (Pa) of
   SIMD_WIDTH of its neighbours b, and in a gradient their pressures p (Pa), between PressurePredict and
   PressureKeepCarried. Not collective. */
typedef struct {
  Simd3 place, carried, load;
} Balance;
void BalanceSetUp(Pressure pressure);
void BalanceAdd(Pressure pressure, PetscScalar rhs[]);

static inline Balance BalanceOf(Pressure pressure, PetscInt a)
{
  return (Balance){Simd3Set(pressure->place + DIM * a), Simd3Set(pressure->carried + DIM * a),
                   Simd3Set(pressure->load + DIM * a)};
}

static inline Simd BalanceTo(Pressure pressure, const Balance *own, const SimdOffsets *at, Simd *p)
{
  const PetscBool flat = PETSC_FALSE;
  const Simd3     load = Simd3Collect(flat, pressure->load, at);
  Simd3           T, y;

  *p = load.z;
  if (pressure->uniform) return 0.5 * (load.x + own->load.x) * (load.y - own->load.y);
  T = Simd3Collect(flat, pressure->carried, at);
  y = Simd3Difference(flat, Simd3Collect(flat, pressure->place, at), own->place);
  return 0.5 * Simd3Dot(flat, (Simd3){T.x + own->carried.x, T.y + own->carried.y, T.z + own->carried.z}, y);
}

/* SetConvergence - sets the solver's test, after its options are read: it stops at density_tolerance, or else at
   -ksp_rtol and -ksp_atol in the 2-norm of the residual. Collective. */
PetscErrorCode SetConvergence(Pressure pressure);
/* ResidualMeasure - for SolverSolve: measures the residual r in the 2-norm or as the largest density error; sets
   density_left, too. Collective. */
PetscErrorCode ResidualMeasure(void *context, Vec r, SolverReport *report, PetscReal *rounding);

/* SurfaceLattice - sets layer_share, layer_normal, layer_slope and layer_density. Not collective. */
void SurfaceLattice(Pressure pressure);
/* SurfaceSlope - the factor by which Eq. (9) is too large in the row of particle a on or near the surface.
   SurfaceDensity - the correction to add to its filled fraction. Not collective. */
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
