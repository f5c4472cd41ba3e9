/* PC type "twolevel": a two-level preconditioner for the pressure matrix of particles,

     M r = omega D^-1 r + P C P^T r,   D the diagonal of A.

   A row has some 80 entries, so each product with A is expensive. Algebraic coarsening multiplies these rows with each
   other, and a multigrid cycle has two products or more. But A is a Laplacian on points with known positions, so its
   coarse form is known beforehand.

   P interpolates (bi/tri)linearly to the points from a background grid, whose cells are 8/3 spacings wide. C is one
   cycle of an inner solver (-twolevel_coarse_ksp_type, -twolevel_coarse_pc_type) for the rediscretised problem.
   Default: one V-cycle of algebraic multigrid with SOR smoothing; a direct solver for plane and for tiny grids. The
   problem is the 5/7-point Laplacian, each cell weighted with the fraction of it that particles fill, at most 1, plus
   P^T S P. S is the surplus of the diagonal over the row's pair sum; the closure at the free surface causes it. For
   smooth functions this is the Galerkin product P^T A P, at no cost. The edges of the filled cells are natural Neumann
   boundaries: walls and symmetry faces need no treatment, and the free surface enters through S alone.

   Why it works: at wavelengths below two cells the kernel's Fourier transform is almost zero, so D^-1 A is nearly the
   identity, and one Jacobi sweep suffices. The grid reduces the errors of long wavelength. Both parts are added
   (Bramble, Pasciak, Xu, Math. Comp. 55, 1990): M is symmetric and positive for every omega > 0, and an iteration has
   one product with A, in the Krylov method. The multiplicative form, a sweep before and after the coarse correction,
   needs two thirds to three quarters of the iterations, but three products in each. The set-up has three products and
   the grid; it takes the time of about five iterations.

   Rows without pairs (isolated particles) do not enter the grid. If A has the constant null space, so has the coarse
   matrix. A must be symmetric and approximate c * (-laplacian) with one c inside the liquid; the set-up measures c. */
#include <petsc/private/pcimpl.h>

#include "coarse_grid.h"
#include "twolevel.h"

#define OMEGA 1.4      /* an impact at 0.8 mm takes 5.4 iterations; with 1, 5.6; with 2, 5.5 */
#define RATIO (8 / 3.) /* spacings; with 2 it takes 5.3 iterations and more than twice the nodes; with 4, 6.8 */
/* Largest numbers of nodes for a direct coarse solver, which each rank runs for itself. In the plane a factorisation
   costs less than the set-up of a multigrid cycle, and saves an iteration or two. */
#define DIRECT_PLANE 20000
#define DIRECT_SPACE 500
#define NO_PAIR      1e-10 /* of the diagonal: a row with a smaller pair sum has no pairs */
#define FULL_ROW     0.75  /* of the largest pair sum: a row with a larger pair sum is inside the liquid */
#define WAVELENGTH   20.   /* spacings, of the wave that measures c */

typedef struct {
  PetscReal  spacing, lower[DIM], upper[DIM];
  PetscBool  periodic[DIM];
  PetscInt   dim, n;       /* n: points */
  PetscReal *x;            /* [n][dim] m, until the set-up has used them: then n is -1 */
  PetscReal *volume;       /* [n] relative volumes, see PCTwoLevelSetVolumes; NULL: all 1 */
  PetscReal *factor;       /* [n] of the rows; NULL: all 1 */
  PetscReal  spacing_most; /* largest spacing, m */
  CoarseGrid grid;
  PetscReal  point_energy; /* c of a point of factor 1, [A] m2 */
  Vec        jacobi;       /* omega D^-1 */
  Vec        coarse_b, coarse_x;
  Mat        A; /* coarse */
  KSP        ksp;
} TwoLevel;

static PetscErrorCode PCReset_TwoLevel(PC pc)
{
  TwoLevel *two = (TwoLevel *)pc->data;

  PetscFunctionBegin;
  PetscCall(CoarseGridDestroy(&two->grid));
  PetscCall(VecDestroy(&two->jacobi));
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
  PetscCall(PetscFree(two->x));
  PetscCall(PetscMalloc1(dim * n, &two->x));
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
  two->spacing = two->spacing_most = spacing;
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

static PetscErrorCode PCTwoLevelSetVolumes_TwoLevel(PC pc, PetscReal most, PetscInt n, const PetscReal volume[],
                                                    const PetscReal factor[])
{
  TwoLevel *two = (TwoLevel *)pc->data;

  PetscFunctionBegin;
  two->spacing_most = most;
  PetscCall(PetscFree2(two->volume, two->factor));
  PetscCall(PetscMalloc2(n, &two->volume, n, &two->factor));
  PetscCall(PetscArraycpy(two->volume, volume, n));
  PetscCall(PetscArraycpy(two->factor, factor, n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PCTwoLevelSetVolumes(PC pc, PetscReal most, PetscInt n, const PetscReal volume[],
                                    const PetscReal factor[])
{
  PetscFunctionBegin;
  PetscTryMethod(pc, "PCTwoLevelSetVolumes_C", (PC, PetscReal, PetscInt, const PetscReal[], const PetscReal[]),
                 (pc, most, n, volume, factor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The pair sum of row a, converted to that of a point of relative volume and factor 1. Pair sums grow with the factor
   over the square of the spacing. */
static PetscReal RowSize(const TwoLevel *two, PetscInt a, PetscReal sum)
{
  return two->volume ? sum * PetscPowReal(two->volume[a], 2. / two->dim) / two->factor[a] : sum;
}

/* Splits the diagonal of A, which it copies to two->jacobi. surplus: [n] diagonal minus pair sum; skip: [n] whether the
   row has no pairs; largest: the largest pair sum of all ranks. */
static PetscErrorCode SplitDiagonal(PC pc, TwoLevel *two, PetscReal surplus[], PetscBool skip[], PetscReal *largest)
{
  const PetscScalar *diagonal, *sum;
  Vec                ones, sums;

  PetscFunctionBegin;
  PetscCall(MatGetDiagonal(pc->pmat, two->jacobi));
  PetscCall(MatCreateVecs(pc->pmat, &ones, &sums));
  PetscCall(VecSet(ones, 1));
  PetscCall(MatMult(pc->pmat, ones, sums));
  PetscCall(VecGetArrayRead(two->jacobi, &diagonal));
  PetscCall(VecGetArrayRead(sums, &sum));
  *largest = 0;
  for (PetscInt a = 0; a < two->n; a++) {
    const PetscReal d = PetscRealPart(diagonal[a]), s = PetscRealPart(sum[a]);

    surplus[a] = s > NO_PAIR * d ? s : 0;
    skip[a]    = (PetscBool)(d - s <= NO_PAIR * d);
    *largest   = PetscMax(*largest, RowSize(two, a, d - s));
  }
  PetscCall(VecRestoreArrayRead(two->jacobi, &diagonal));
  PetscCall(VecRestoreArrayRead(sums, &sum));
  PetscCall(VecDestroy(&ones));
  PetscCall(VecDestroy(&sums));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, largest, 1, MPIU_REAL, MPIU_MAX, PetscObjectComm((PetscObject)pc)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The wave that measures c: returns its direction, the longest of the box; k: wave number, 1/m. Its length is about
   WAVELENGTH spacings, if the box allows. */
static PetscInt WaveDirection(const TwoLevel *two, PetscReal *k)
{
  PetscInt  direction = 0;
  PetscReal waves, length;

  for (PetscInt d = 1; d < two->dim; d++)
    if (two->upper[d] - two->lower[d] > two->upper[direction] - two->lower[direction]) direction = d;
  length = two->upper[direction] - two->lower[direction];
  waves  = PetscMax(1, PetscFloorReal(length / (WAVELENGTH * two->spacing_most)));
  *k     = 2 * PETSC_PI * waves / length;
  return direction;
}

/* Measures c, the energy p'Ap = sum c |grad p|^2 of a point, by the symbol of A. With u = exp(ikx), row a gives
   Re(conj(u) A u) - surplus = sum_b K_ab (1 - cos k x_ab) = c k^2 for small k. Two products give this for any type of
   matrix and any scaling of rows. c is the mean over the rows inside the liquid. */
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
  PetscCall(VecGetArrayRead(two->jacobi, &diagonal));
  for (PetscInt a = 0; a < two->n; a++) {
    if (RowSize(two, a, PetscRealPart(diagonal[a]) - surplus[a]) < FULL_ROW * largest) continue;
    sum[0] += energy[a] - surplus[a];
    sum[1] += two->factor ? two->factor[a] : 1;
  }
  PetscCall(VecRestoreArrayRead(two->jacobi, &diagonal));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 2, MPIU_REAL, MPIU_SUM, PetscObjectComm((PetscObject)pc)));
  two->point_energy = sum[1] > 0 ? sum[0] / (sum[1] * k * k) : 0;
  PetscCall(PetscFree(energy));
  PetscCall(VecDestroy(&wave));
  PetscCall(VecDestroy(&product));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets up the inner solver. Its levels read their defaults from the options database only, so the defaults are there
   during the set-up. A piece of liquid that solids enclose may see no surface: its nodes have the constant null space,
   and rounding can leave them a pivot of zero or less. */
static PetscErrorCode SetUpCoarseSolver(KSP ksp)
{
  const char *const defaults[][2] = {{"mg_levels_ksp_type", KSPRICHARDSON},
                                     {"mg_levels_ksp_max_it", "1"},
                                     {"mg_levels_pc_type", PCSOR},
                                     {"redundant_pc_factor_shift_type", "positive_definite"}};
  char              option[PETSC_STATIC_ARRAY_LENGTH(defaults)][PETSC_MAX_PATH_LEN];
  PetscBool         set[PETSC_STATIC_ARRAY_LENGTH(defaults)];
  const char       *prefix;

  PetscFunctionBegin;
  PetscCall(KSPGetOptionsPrefix(ksp, &prefix));
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(defaults); k++) {
    PetscCall(PetscSNPrintf(option[k], sizeof(option[k]), "-%s%s", prefix, defaults[k][0]));
    PetscCall(PetscOptionsHasName(NULL, NULL, option[k], &set[k])); /* counts as read, even if the grid has no levels */
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

/* omega D^-1 of the present A. */
static PetscErrorCode SetJacobi(PC pc, TwoLevel *two)
{
  PetscFunctionBegin;
  PetscCall(MatGetDiagonal(pc->pmat, two->jacobi));
  PetscCall(VecReciprocal(two->jacobi));
  PetscCall(VecScale(two->jacobi, OMEGA));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Before each solve: a kept preconditioner has rows that came to the free surface or left it since its set-up, and a
   row's diagonal changes by the closure there. A dam break takes 5.2 iterations so, and 6.9 with a diagonal kept, too.
 */
static PetscErrorCode PCPreSolve_TwoLevel(PC pc, KSP ksp, Vec b, Vec x)
{
  TwoLevel *two = (TwoLevel *)pc->data;

  PetscFunctionBegin;
  if (two->jacobi) PetscCall(SetJacobi(pc, two));
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
  PetscCall(MatCreateVecs(pc->pmat, &two->jacobi, NULL));
  PetscCall(PetscMalloc1(n, &surplus));
  PetscCall(PetscMalloc1(n, &skip));
  PetscCall(SplitDiagonal(pc, two, surplus, skip, &largest));
  PetscCall(MeasureEnergy(pc, two, surplus, largest));
  PetscCall(CoarseGridCreate(PetscObjectComm((PetscObject)pc), two->dim, n, two->x, two->volume, skip,
                             PetscMax(RATIO * two->spacing, two->spacing_most), two->lower, two->upper, two->periodic,
                             &two->grid));
  PetscCall(PetscFree(two->x));
  PetscCall(CoarseGridSizes(two->grid, &local, &nodes));
  if (nodes > 0) {
    for (PetscInt d = 0; d < two->dim; d++) volume *= two->spacing;
    PetscCall(CoarseGridMatrix(two->grid, two->point_energy, volume, two->factor, surplus, &two->A));
    PetscCall(MatCreateVecs(two->A, &two->coarse_x, &two->coarse_b));
  }
  two->n = -1;
  PetscCall(PetscFree(surplus));
  PetscCall(PetscFree(skip));
  if (nodes > 0) PetscCall(CreateCoarseSolver(pc, two, nodes));
  PetscCall(SetJacobi(pc, two));
  PetscCall(PetscInfo(pc, "%" PetscInt_FMT " nodes, point energy %g\n", nodes, (double)two->point_energy));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PCApply_TwoLevel(PC pc, Vec r, Vec x)
{
  TwoLevel    *two = (TwoLevel *)pc->data;
  MatNullSpace constant;

  PetscFunctionBegin;
  PetscCall(VecPointwiseMult(x, two->jacobi, r));
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
  PetscCall(PetscFree2(two->volume, two->factor));
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
  pc->ops->presolve       = PCPreSolve_TwoLevel;
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
