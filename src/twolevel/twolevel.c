/* PC type "twolevel": a two-level preconditioner for the pressure matrix of particles,

     M r = omega D^-1 r + P C P^T r,   D the diagonal of A.

   Rows have some 80 entries, so each pass over them is expensive: algebraic coarsening multiplies such rows with each
   other, and a multigrid cycle multiplies with A twice or more. But the matrix is a Laplacian on points whose places
   are known, so its coarse form is known beforehand.

   P interpolates (bi/tri)linearly from a background grid, its cells 8/3 particle spacings wide, to the points. C is
   one cycle of an inner solver (-twolevel_coarse_ksp_type, -twolevel_coarse_pc_type; by default one V-cycle of
   algebraic multigrid with SOR smoothing, a direct solver for grids in the plane and tiny ones) for the REDISCRETISED
   problem: the 5/7-point Laplacian, each cell weighted with its fill by particles and no more than full, plus P^T S P
   with S the surplus of the diagonal over the row's pair sum (what the closure at the free surface added). For smooth
   functions that is the Galerkin product P^T A P, without the product. Edges of the fill are natural Neumann
   boundaries, so walls and symmetry faces need nothing, and a free surface enters through S alone.

   Why it works: the kernel's Fourier transform is close to nothing at wavelengths below two cells, so D^-1 A is nearly
   the identity there and Jacobi needs no second sweep; the grid takes the long waves. Both parts simply add (Bramble,
   Pasciak, Xu, Math. Comp. 55, 1990): M is then symmetric and positive for every omega > 0, and an iteration multiplies
   with A once, in the Krylov method, not in M. The form with a sweep before and after a correction of the residual
   needs two thirds to three quarters of the iterations but three products in each. Set-up costs three products and the
   grid, in time about five iterations.

   Rows without a pair (isolated particles) have no part in the grid. If A has the constant null space, so has the
   coarse matrix. A must be symmetric and approximate c * (-laplacian) with one c inside the liquid; how its rows are
   scaled is measured, not assumed. */
#include <petsc/private/pcimpl.h>

#include "coarse_grid.h"
#include "twolevel.h"

#define OMEGA 1.4      /* an impact at 0.8 mm takes 5.4 iterations, 5.6 with 1, 5.5 with 2 */
#define RATIO (8 / 3.) /* spacings; with 2 it takes 5.3 and more than twice the nodes, with 4 6.8 */
/* Nodes up to which the coarse problem is solved directly, by every rank for itself: in the plane a factorisation costs
   less than what a cycle of multigrid takes to set up, and saves an iteration or two. */
#define DIRECT_PLANE 20000
#define DIRECT_SPACE 500
#define NO_PAIR      1e-10 /* part of the diagonal below which a row's pairs count as none */
#define FULL_ROW     0.75  /* part of the largest pair sum above which a row counts as inside the liquid */
#define WAVELENGTH   20.   /* spacings, of the wave that measures the matrix */

typedef struct {
  PetscReal  spacing, lower[DIM], upper[DIM];
  PetscBool  periodic[DIM];
  PetscInt   dim, n; /* n: points given */
  PetscReal *x;      /* [n][dim] m */
  PetscReal *volume; /* [n] over spacing^dim, 1; NULL: all are 1 */
  PetscReal  most;   /* largest spacing, m */
  CoarseGrid grid;
  PetscReal  point_energy;               /* [A] m2 */
  Vec        weight, coarse_b, coarse_x; /* weight: omega D^-1 */
  Mat        A;                          /* coarse */
  KSP        ksp;
} TwoLevel;

static PetscErrorCode PCReset_TwoLevel(PC pc)
{
  TwoLevel *two = (TwoLevel *)pc->data;

  PetscFunctionBegin;
  PetscCall(CoarseGridDestroy(&two->grid));
  PetscCall(VecDestroy(&two->weight));
  PetscCall(VecDestroy(&two->coarse_b));
  PetscCall(VecDestroy(&two->coarse_x));
  PetscCall(MatDestroy(&two->A));
  PetscCall(KSPDestroy(&two->ksp));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PCSetCoordinates_TwoLevel(PC pc, PetscInt dim, PetscInt n, PetscReal x[])
{
  TwoLevel *two = (TwoLevel *)pc->data;

  PetscFunctionBegin;
  PetscCheck(dim == 2 || dim == 3, PetscObjectComm((PetscObject)pc), PETSC_ERR_ARG_OUTOFRANGE,
             "PC type " PCTWOLEVEL " works in 2 or 3 dimensions, not %" PetscInt_FMT, dim);
  if (two->n != n || two->dim != dim) {
    PetscCall(PetscFree(two->x));
    PetscCall(PetscMalloc1(dim * n, &two->x));
  }
  two->dim = dim;
  two->n   = n;
  PetscCall(PetscArraycpy(two->x, x, dim * n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PCTwoLevelSetGrid_TwoLevel(PC pc, PetscReal spacing, const PetscReal lower[],
                                                 const PetscReal upper[], const PetscBool periodic[])
{
  TwoLevel *two = (TwoLevel *)pc->data;

  PetscFunctionBegin;
  two->spacing = two->most = spacing;
  for (PetscInt d = 0; d < DIM; d++) {
    two->lower[d]    = lower[d];
    two->upper[d]    = upper[d];
    two->periodic[d] = periodic[d];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PCTwoLevelSetGrid(PC pc, PetscReal spacing, const PetscReal lower[DIM], const PetscReal upper[DIM],
                                 const PetscBool periodic[DIM])
{
  PetscFunctionBegin;
  PetscTryMethod(pc, "PCTwoLevelSetGrid_C", (PC, PetscReal, const PetscReal[], const PetscReal[], const PetscBool[]),
                 (pc, spacing, lower, upper, periodic));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PCTwoLevelSetVolumes_TwoLevel(PC pc, PetscReal most, PetscInt n, const PetscReal volume[])
{
  TwoLevel *two = (TwoLevel *)pc->data;

  PetscFunctionBegin;
  two->most = most;
  PetscCall(PetscFree(two->volume));
  PetscCall(PetscMalloc1(n, &two->volume));
  PetscCall(PetscArraycpy(two->volume, volume, n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PCTwoLevelSetVolumes(PC pc, PetscReal most, PetscInt n, const PetscReal volume[])
{
  PetscFunctionBegin;
  PetscTryMethod(pc, "PCTwoLevelSetVolumes_C", (PC, PetscReal, PetscInt, const PetscReal[]), (pc, most, n, volume));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The pairs' sum of a row of the size of a point of the given spacing: it grows with the volume over the square of the
   spacing. */
static PetscReal RowSize(const TwoLevel *two, PetscInt a, PetscReal sum)
{
  return two->volume ? sum * PetscPowReal(two->volume[a], 2. / two->dim - 1) : sum;
}

/* surplus ([n]) of the diagonal over the row's pairs; skip ([n]) rows without pairs; the largest pair sum of all rows;
 * sets the weight to the diagonal. */
static PetscErrorCode SplitDiagonal(PC pc, TwoLevel *two, PetscReal surplus[], PetscBool skip[], PetscReal *largest)
{
  const PetscScalar *diagonal, *sum;
  Vec                ones, sums;

  PetscFunctionBegin;
  PetscCall(MatGetDiagonal(pc->pmat, two->weight));
  PetscCall(MatCreateVecs(pc->pmat, &ones, &sums));
  PetscCall(VecSet(ones, 1));
  PetscCall(MatMult(pc->pmat, ones, sums));
  PetscCall(VecGetArrayRead(two->weight, &diagonal));
  PetscCall(VecGetArrayRead(sums, &sum));
  *largest = 0;
  for (PetscInt a = 0; a < two->n; a++) {
    const PetscReal d = PetscRealPart(diagonal[a]), s = PetscRealPart(sum[a]);

    surplus[a] = s > NO_PAIR * d ? s : 0;
    skip[a]    = (PetscBool)(d - s <= NO_PAIR * d);
    *largest   = PetscMax(*largest, RowSize(two, a, d - s));
  }
  PetscCall(VecRestoreArrayRead(two->weight, &diagonal));
  PetscCall(VecRestoreArrayRead(sums, &sum));
  PetscCall(VecDestroy(&ones));
  PetscCall(VecDestroy(&sums));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, largest, 1, MPIU_REAL, MPIU_MAX, PetscObjectComm((PetscObject)pc)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The wave vector: along the longest direction, WAVELENGTH spacings if the box allows. Returns the direction; 1/m. */
static PetscInt WaveDirection(const TwoLevel *two, PetscReal *k)
{
  PetscInt  direction = 0;
  PetscReal waves, length;

  for (PetscInt d = 1; d < two->dim; d++)
    if (two->upper[d] - two->lower[d] > two->upper[direction] - two->lower[direction]) direction = d;
  length = two->upper[direction] - two->lower[direction];
  waves  = PetscMax(1, PetscFloorReal(length / (WAVELENGTH * two->most)));
  *k     = 2 * PETSC_PI * waves / length;
  return direction;
}

/* What a point adds to the energy p'Ap = sum c |grad p|^2: from the symbol of A. With u = exp(ikx), Re(conj(u) A u) -
   surplus = sum_b K_ab (1 - cos k x_ab) = c k^2 for small k: row by row from two products, for any type of matrix,
   however its rows are scaled. Average over rows inside the liquid. */
static PetscErrorCode MeasureEnergy(PC pc, TwoLevel *two, const PetscReal surplus[], PetscReal largest)
{
  Vec                wave, product;
  PetscReal         *energy, k, sum[2] = {0, 0};
  const PetscReal   *x         = two->x;
  const PetscInt     direction = WaveDirection(two, &k), dim = two->dim;
  const PetscScalar *diagonal, *Au;
  PetscScalar       *u;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(pc->pmat, &wave, &product));
  PetscCall(PetscCalloc1(two->n, &energy));
  for (PetscInt part = 0; part < 2; part++) {
    const PetscReal phase = part * PETSC_PI / 2;

    PetscCall(VecGetArrayWrite(wave, &u));
    for (PetscInt a = 0; a < two->n; a++) u[a] = PetscSinReal(k * x[dim * a + direction] + phase);
    PetscCall(VecRestoreArrayWrite(wave, &u));
    PetscCall(MatMult(pc->pmat, wave, product));
    PetscCall(VecGetArray(wave, &u));
    PetscCall(VecGetArrayRead(product, &Au));
    for (PetscInt a = 0; a < two->n; a++) energy[a] += PetscRealPart(u[a] * Au[a]);
    PetscCall(VecRestoreArrayRead(product, &Au));
    PetscCall(VecRestoreArray(wave, &u));
  }
  PetscCall(VecGetArrayRead(two->weight, &diagonal));
  for (PetscInt a = 0; a < two->n; a++) {
    if (RowSize(two, a, PetscRealPart(diagonal[a]) - surplus[a]) < FULL_ROW * largest) continue;
    sum[0] += energy[a] - surplus[a];
    sum[1] += two->volume ? two->volume[a] : 1;
  }
  PetscCall(VecRestoreArrayRead(two->weight, &diagonal));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)pc)));
  two->point_energy = sum[1] > 0 ? sum[0] / (sum[1] * k * k) : 0;
  PetscCall(PetscFree(energy));
  PetscCall(VecDestroy(&wave));
  PetscCall(VecDestroy(&product));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the options of the inner solver that the user did not, while it is set up: its levels read no others. */
static PetscErrorCode SetUpCoarseSolver(KSP ksp)
{
  const char *const defaults[][2] = {{"mg_levels_ksp_type", KSPRICHARDSON},
                                     {"mg_levels_ksp_max_it", "1"},
                                     {"mg_levels_pc_type", PCSOR}};
  char              option[PETSC_STATIC_ARRAY_LENGTH(defaults)][PETSC_MAX_PATH_LEN];
  PetscBool         set[PETSC_STATIC_ARRAY_LENGTH(defaults)];
  const char       *prefix;

  PetscFunctionBegin;
  PetscCall(KSPGetOptionsPrefix(ksp, &prefix));
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(defaults); k++) {
    PetscCall(PetscSNPrintf(option[k], sizeof(option[k]), "-%s%s", prefix, defaults[k][0]));
    PetscCall(PetscOptionsHasName(NULL, NULL, option[k], &set[k])); /* it is read: not every grid has levels */
    if (!set[k]) PetscCall(PetscOptionsSetValue(NULL, option[k], defaults[k][1]));
  }
  PetscCall(KSPSetFromOptions(ksp));
  PetscCall(KSPSetUp(ksp));
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(defaults); k++)
    if (!set[k]) PetscCall(PetscOptionsClearValue(NULL, option[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateCoarseSolver(PC pc, TwoLevel *two, PetscInt nodes)
{
  MatNullSpace constant;
  const char  *prefix;
  PC           inner;
  PetscBool    direct;

  PetscFunctionBegin;
  PetscCall(MatGetNullSpace(pc->pmat, &constant));
  direct = (PetscBool)(nodes <= (two->dim == 2 ? DIRECT_PLANE : DIRECT_SPACE) && !constant);
  if (constant) {
    PetscCall(MatNullSpaceCreate(PetscObjectComm((PetscObject)pc), PETSC_TRUE, 0, NULL, &constant));
    PetscCall(MatSetNullSpace(two->A, constant));
    PetscCall(MatNullSpaceDestroy(&constant));
  } else
    PetscCall(MatSetOption(two->A, MAT_SPD, PETSC_TRUE));
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)pc), &two->ksp));
  PetscCall(PetscObjectIncrementTabLevel((PetscObject)two->ksp, (PetscObject)pc, 1));
  PetscCall(PCGetOptionsPrefix(pc, &prefix));
  PetscCall(KSPSetOptionsPrefix(two->ksp, prefix));
  PetscCall(KSPAppendOptionsPrefix(two->ksp, "twolevel_coarse_"));
  PetscCall(KSPSetType(two->ksp, KSPPREONLY));
  PetscCall(KSPSetOperators(two->ksp, two->A, two->A));
  PetscCall(KSPGetPC(two->ksp, &inner));
  PetscCall(PCSetType(inner, direct ? PCREDUNDANT : PCGAMG));
  PetscCall(SetUpCoarseSolver(two->ksp));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PCSetUp_TwoLevel(PC pc)
{
  TwoLevel  *two = (TwoLevel *)pc->data;
  PetscInt   n, local, nodes;
  PetscReal *surplus, largest, volume = 1;
  PetscBool *skip;

  PetscFunctionBegin;
  PetscCall(PCReset_TwoLevel(pc));
  PetscCall(MatGetLocalSize(pc->pmat, &n, NULL));
  PetscCheck(two->n == n && two->dim, PETSC_COMM_SELF, PETSC_ERR_ORDER,
             "PC type " PCTWOLEVEL " needs PCSetCoordinates with a point for each of the %" PetscInt_FMT " local rows",
             n);
  PetscCheck(two->spacing > 0, PetscObjectComm((PetscObject)pc), PETSC_ERR_ORDER,
             "PC type " PCTWOLEVEL " needs PCTwoLevelSetGrid");
  PetscCall(MatCreateVecs(pc->pmat, &two->weight, NULL));
  PetscCall(PetscMalloc1(n, &surplus));
  PetscCall(PetscMalloc1(n, &skip));
  PetscCall(SplitDiagonal(pc, two, surplus, skip, &largest));
  PetscCall(CoarseGridCreate(PetscObjectComm((PetscObject)pc), two->dim, n, two->x, two->volume, skip,
                             PetscMax(RATIO * two->spacing, two->most), two->lower, two->upper, two->periodic,
                             &two->grid));
  PetscCall(CoarseGridSizes(two->grid, &local, &nodes));
  if (nodes > 0) {
    for (PetscInt d = 0; d < two->dim; d++) volume *= two->spacing;
    PetscCall(MeasureEnergy(pc, two, surplus, largest));
    PetscCall(CoarseGridMatrix(two->grid, two->point_energy, volume, surplus, &two->A));
    PetscCall(MatCreateVecs(two->A, &two->coarse_x, &two->coarse_b));
    PetscCall(CreateCoarseSolver(pc, two, nodes));
  }
  PetscCall(PetscFree(surplus));
  PetscCall(PetscFree(skip));
  PetscCall(VecReciprocal(two->weight));
  PetscCall(VecScale(two->weight, OMEGA));
  PetscCall(PetscInfo(pc, "%" PetscInt_FMT " nodes, point energy %g\n", nodes, (double)two->point_energy));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PCApply_TwoLevel(PC pc, Vec r, Vec x)
{
  TwoLevel    *two = (TwoLevel *)pc->data;
  MatNullSpace constant;

  PetscFunctionBegin;
  PetscCall(VecPointwiseMult(x, two->weight, r));
  if (!two->A) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CoarseGridRestrict(two->grid, r, two->coarse_b));
  PetscCall(MatGetNullSpace(two->A, &constant));
  if (constant) PetscCall(MatNullSpaceRemove(constant, two->coarse_b));
  PetscCall(KSPSolve(two->ksp, two->coarse_b, two->coarse_x));
  PetscCall(CoarseGridProlongAdd(two->grid, two->coarse_x, x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PCView_TwoLevel(PC pc, PetscViewer viewer)
{
  TwoLevel *two = (TwoLevel *)pc->data;
  PetscInt  nodes;

  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPrintf(viewer, "  Jacobi with omega %g\n", OMEGA));
  if (!two->grid) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CoarseGridSizes(two->grid, NULL, &nodes));
  PetscCall(PetscViewerASCIIPrintf(viewer, "  grid of %g spacings, %" PetscInt_FMT " nodes\n", RATIO, nodes));
  PetscCall(PetscViewerASCIIPushTab(viewer));
  if (two->ksp) PetscCall(KSPView(two->ksp, viewer));
  PetscCall(PetscViewerASCIIPopTab(viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PCDestroy_TwoLevel(PC pc)
{
  TwoLevel *two = (TwoLevel *)pc->data;

  PetscFunctionBegin;
  PetscCall(PCReset_TwoLevel(pc));
  PetscCall(PetscFree(two->x));
  PetscCall(PetscFree(two->volume));
  PetscCall(PetscObjectComposeFunction((PetscObject)pc, "PCTwoLevelSetVolumes_C", NULL));
  PetscCall(PetscObjectComposeFunction((PetscObject)pc, "PCSetCoordinates_C", NULL));
  PetscCall(PetscObjectComposeFunction((PetscObject)pc, "PCTwoLevelSetGrid_C", NULL));
  PetscCall(PetscFree(pc->data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PCCreate_TwoLevel(PC pc)
{
  TwoLevel *two;

  PetscFunctionBegin;
  PetscCall(PetscNew(&two));
  pc->data                = two;
  pc->ops->setup          = PCSetUp_TwoLevel;
  pc->ops->apply          = PCApply_TwoLevel;
  pc->ops->applytranspose = PCApply_TwoLevel;
  pc->ops->view           = PCView_TwoLevel;
  pc->ops->reset          = PCReset_TwoLevel;
  pc->ops->destroy        = PCDestroy_TwoLevel;
  PetscCall(PetscObjectComposeFunction((PetscObject)pc, "PCSetCoordinates_C", PCSetCoordinates_TwoLevel));
  PetscCall(PetscObjectComposeFunction((PetscObject)pc, "PCTwoLevelSetGrid_C", PCTwoLevelSetGrid_TwoLevel));
  PetscCall(PetscObjectComposeFunction((PetscObject)pc, "PCTwoLevelSetVolumes_C", PCTwoLevelSetVolumes_TwoLevel));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PCTwoLevelRegister(void)
{
  PetscFunctionBegin;
  PetscCall(PCRegister(PCTWOLEVEL, PCCreate_TwoLevel));
  PetscFunctionReturn(PETSC_SUCCESS);
}
