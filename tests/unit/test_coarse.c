/* The background grid of the two-level preconditioner: weights that sum to one, points outside a periodic box, the same
   matrix on any number of ranks; the preconditioner inverts smooth functions. Runs on any number of ranks. */
#include "../../src/twolevel/coarse_grid.h"
#include "../../src/twolevel/twolevel.h"
#include "check.h"

#define POINTS 300
#define SIDE   24 /* points of a square lattice */
#define STEP   0.5

static const PetscReal lower[DIM] = {0, 0, 0}, upper[DIM] = {9, 8, 7};

/* The random points k of a box that this rank has, of 'size', each moved by so many widths of the box along x; all are
   in the lower half of it, so that the upper one has empty cells. Returns how many. */
static PetscInt Points(PetscMPIInt rank, PetscMPIInt size, PetscReal widths, PetscReal x[])
{
  PetscInt n = 0;

  for (PetscInt k = 0; k < POINTS; k++) {
    if (k % size != rank) continue;
    for (PetscInt d = 0; d < DIM; d++)
      x[DIM * n + d] = (d == 2 ? 0.5 : 1) * upper[d] * RandomUnit(4, (unsigned long long)(DIM * k + d));
    x[DIM * n++] += widths * upper[0];
  }
  return n;
}

/* The grid over the points of all ranks of comm; its sum of the restricted values k of the points and the sum of their
   squares, the least and largest value of ones on the nodes at the points, the norm of its matrix, and of one whose
   cells have all more points than fit. */
typedef struct {
  PetscReal sum, square, least, most, matrix, full;
} Grid;

static PetscErrorCode Measure(MPI_Comm comm, PetscReal widths, PetscBool twice, Grid *out)
{
  const PetscBool periodic[DIM]    = {PETSC_TRUE, PETSC_FALSE, PETSC_FALSE};
  PetscBool       skip[2 * POINTS] = {PETSC_FALSE};
  PetscReal       x[DIM * 2 * POINTS], surplus[2 * POINTS];
  PetscMPIInt     rank, size;
  PetscInt        n, local;
  PetscScalar    *values;
  CoarseGrid      grid;
  Vec             fine, coarse;
  Mat             A;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  n = Points(rank, size, widths, x);
  if (twice) {
    PetscCall(PetscArraycpy(x + DIM * n, x, DIM * n));
    n *= 2;
  }
  PetscCall(CoarseGridCreate(comm, DIM, n, x, NULL, skip, 1.5, lower, upper, periodic, &grid));
  PetscCall(CoarseGridSizes(grid, &local, NULL));
  PetscCall(VecCreateMPI(comm, n, PETSC_DETERMINE, &fine));
  PetscCall(VecCreateMPI(comm, local, PETSC_DETERMINE, &coarse));
  PetscCall(VecGetArrayWrite(fine, &values));
  for (PetscInt a = 0; a < n; a++) {
    values[a]  = rank + a * size;
    surplus[a] = 0;
  }
  PetscCall(VecRestoreArrayWrite(fine, &values));
  PetscCall(CoarseGridRestrict(grid, fine, coarse));
  PetscCall(VecSum(coarse, &out->sum));
  PetscCall(VecDot(coarse, coarse, &out->square));
  PetscCall(VecSet(coarse, 1));
  PetscCall(VecSet(fine, 0));
  PetscCall(CoarseGridProlongAdd(grid, coarse, fine));
  PetscCall(VecMin(fine, NULL, &out->least));
  PetscCall(VecMax(fine, NULL, &out->most));
  PetscCall(CoarseGridMatrix(grid, 1, 0.5, NULL, surplus, &A)); /* some cells have more points than fit */
  PetscCall(MatNorm(A, NORM_FROBENIUS, &out->matrix));
  PetscCall(MatDestroy(&A));
  PetscCall(CoarseGridMatrix(grid, 1, 50, NULL, surplus, &A));
  PetscCall(MatNorm(A, NORM_FROBENIUS, &out->full));
  PetscCall(MatDestroy(&A));
  PetscCall(VecDestroy(&fine));
  PetscCall(VecDestroy(&coarse));
  PetscCall(CoarseGridDestroy(&grid));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestGrid(void)
{
  Grid parts, whole, moved, twice;

  PetscFunctionBegin;
  PetscCall(Measure(PETSC_COMM_WORLD, 0, PETSC_FALSE, &parts));
  PetscCall(Measure(PETSC_COMM_SELF, 0, PETSC_FALSE, &whole));
  PetscCall(Measure(PETSC_COMM_WORLD, -2, PETSC_FALSE, &moved));
  PetscCall(Measure(PETSC_COMM_WORLD, 0, PETSC_TRUE, &twice));
  CHECK_CLOSE(parts.sum / (0.5 * POINTS * (POINTS - 1)), 1, 1e-12, "restricted_values_have_the_sum_of_the_points");
  CHECK_CLOSE(parts.least, 1, 1e-12, "ones_are_ones_at_the_points_least");
  CHECK_CLOSE(parts.most, 1, 1e-12, "ones_are_ones_at_the_points_most");
  CHECK_CLOSE(moved.square / parts.square, 1, 1e-10, "points_outside_a_periodic_box_are_wrapped");
  CHECK_CLOSE(parts.square / whole.square, 1, 1e-12, "restriction_on_any_number_of_ranks");
  CHECK_CLOSE(parts.matrix / whole.matrix, 1, 1e-12, "matrix_on_any_number_of_ranks");
  CHECK_CLOSE(twice.full / whole.full, 1, 1e-12, "full_cells_count_no_more_points");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The five-point Laplacian of a square that is zero around it: the preconditioned operator leaves half a wave in each
   direction as it is, but for the smoother's two percent and the coarse cells' error. */
static PetscErrorCode TestSmooth(void)
{
  const PetscBool periodic[DIM] = {PETSC_FALSE, PETSC_FALSE, PETSC_FALSE};
  const PetscReal low[DIM] = {0, 0, 0}, high[DIM] = {SIDE * STEP, SIDE * STEP, 1};
  PetscInt        start, end;
  PetscReal      *at, product, square;
  PetscScalar    *u;
  Mat             A;
  Vec             x, y, z;
  PC              pc;

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(PETSC_COMM_WORLD, PETSC_DECIDE, PETSC_DECIDE, SIDE * SIDE, SIDE * SIDE, 5, NULL, 5, NULL, &A));
  PetscCall(MatGetOwnershipRange(A, &start, &end));
  PetscCall(PetscMalloc1(2 * (end - start), &at));
  PetscCall(MatCreateVecs(A, &x, &y));
  PetscCall(VecDuplicate(x, &z));
  PetscCall(VecGetArrayWrite(x, &u));
  for (PetscInt r = start; r < end; r++) {
    const PetscInt i = r % SIDE, j = r / SIDE;

    PetscCall(MatSetValue(A, r, r, 4, INSERT_VALUES));
    if (i > 0) PetscCall(MatSetValue(A, r, r - 1, -1, INSERT_VALUES));
    if (i < SIDE - 1) PetscCall(MatSetValue(A, r, r + 1, -1, INSERT_VALUES));
    if (j > 0) PetscCall(MatSetValue(A, r, r - SIDE, -1, INSERT_VALUES));
    if (j < SIDE - 1) PetscCall(MatSetValue(A, r, r + SIDE, -1, INSERT_VALUES));
    at[2 * (r - start)]     = STEP * (i + 0.5);
    at[2 * (r - start) + 1] = STEP * (j + 0.5);
    u[r - start] = PetscSinReal(PETSC_PI * (i + 1) / (SIDE + 1)) * PetscSinReal(PETSC_PI * (j + 1) / (SIDE + 1));
  }
  PetscCall(VecRestoreArrayWrite(x, &u));
  PetscCall(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
  PetscCall(PCCreate(PETSC_COMM_WORLD, &pc));
  PetscCall(PCSetType(pc, PCTWOLEVEL));
  PetscCall(PCSetOperators(pc, A, A));
  PetscCall(PCTwoLevelSetGrid(pc, STEP, low, high, periodic));
  PetscCall(PCSetCoordinates(pc, 2, end - start, at));
  PetscCall(PCSetUp(pc));
  PetscCall(MatMult(A, x, y));
  PetscCall(PCApply(pc, y, z));
  PetscCall(VecDot(x, z, &product));
  PetscCall(VecDot(x, x, &square));
  CHECK_CLOSE(product / square, 1, 0.15, "smooth_functions_are_inverted");
  if (getenv("TEST_VERBOSE")) printf("%g\n", (double)(product / square));
  PetscCall(PCDestroy(&pc));
  PetscCall(PetscFree(at));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y));
  PetscCall(VecDestroy(&z));
  PetscCall(MatDestroy(&A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(PCTwoLevelRegister());
  PetscCall(TestGrid());
  PetscCall(TestSmooth());
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
