/* The two-level preconditioner on synthetic matrices: symmetric, positive, few iterations, on any number of ranks (also
   one without rows, or without a row that the grid takes part in). */
#include "../../src/twolevel/twolevel.h"
#include "check.h"

#define SPACING   0.5
#define REACH     (2.6 * SPACING)
#define KEPT_MORE 4 /* iterations; with a diagonal that is kept, too, splash takes 5 more, dam_2d 8 */
#define ISOLATED  3 /* points with no neighbour */

typedef struct {
  PetscInt  dim, n[DIM];                                         /* points of a lattice */
  PetscBool periodic[DIM], surface, blob, isolated, rings, shut; /* shut: the small lattice has no surface */
} Scene_;

/* The length of the ring at a point, over 2 pi. */
static PetscReal Length(const Scene_ *s, const PetscReal x[DIM])
{
  return s->rings ? x[0] : 1;
}

/* All points on every rank: a jittered lattice, a small one far above it, and points with no neighbour. */
static PetscErrorCode MakePoints(const Scene_ *s, PetscInt *count, PetscReal **x)
{
  PetscInt total = s->n[0] * s->n[1] * s->n[2], k = 0;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(DIM * (total + 200), x));
  for (PetscInt part = 0; part < (s->blob ? 2 : 1); part++)
    for (PetscInt c = 0; c < (part ? (s->dim == 3 ? 125 : 25) : total); c++) {
      const PetscInt nx = part ? 5 : s->n[0], ny = part ? 5 : s->n[1], i[DIM] = {c % nx, c / nx % ny, c / nx / ny};

      for (PetscInt d = 0; d < s->dim; d++)
        (*x)[DIM * k + d] = SPACING * (i[d] + 0.5 + 0.3 * (RandomUnit(7, DIM * k + d) - 0.5) +
                                       (part && d == s->dim - 1 ? s->n[d] + 7 : 0));
      k++;
    }
  for (PetscInt p = 0; s->isolated && p < ISOLATED; p++) {
    (*x)[DIM * k]              = SPACING * (1 + 4 * p);
    (*x)[DIM * k + s->dim - 1] = SPACING * (s->n[s->dim - 1] + 30);
    k++;
  }
  *count = k;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows start..end of the graph Laplacian; the surface: rows whose diagonal is less than full are filled up. */
static PetscErrorCode MakeMatrix(const Scene_ *s, PetscInt N, const PetscReal x[], PetscInt n, Mat *A)
{
  PetscInt  start, end;
  PetscReal full = 0, *diagonal;

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(PETSC_COMM_WORLD, n, n, PETSC_DETERMINE, PETSC_DETERMINE, 250, NULL, 250, NULL, A));
  PetscCall(MatGetOwnershipRange(*A, &start, &end));
  PetscCall(PetscCalloc1(n, &diagonal));
  for (PetscInt a = start; a < end; a++) {
    for (PetscInt b = 0; b < N; b++) {
      PetscReal r2 = 0, K;

      for (PetscInt d = 0; d < s->dim; d++) {
        PetscReal dx = x[DIM * a + d] - x[DIM * b + d];

        if (s->periodic[d]) dx -= s->n[d] * SPACING * PetscFloorReal(dx / (s->n[d] * SPACING) + 0.5);
        r2 += dx * dx;
      }
      if (a == b || r2 >= REACH * REACH) continue;
      K = 11 * PetscPowReal(1 - PetscSqrtReal(r2) / REACH, 3) *
          PetscSqrtReal(Length(s, x + DIM * a) * Length(s, x + DIM * b));
      diagonal[a - start] += K;
      PetscCall(MatSetValue(*A, a, b, -K, INSERT_VALUES));
    }
    full = PetscMax(full, diagonal[a - start] / Length(s, x + DIM * a));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &full, 1, MPIU_REAL, MPIU_MAX, PETSC_COMM_WORLD));
  for (PetscInt a = start; a < end; a++) {
    const PetscBool shut = (PetscBool)(s->shut && a >= s->n[0] * s->n[1] * s->n[2]);
    PetscReal       d    = diagonal[a - start];

    if (s->surface && !shut && d < 0.6 * full * Length(s, x + DIM * a)) d = 0.8 * full * Length(s, x + DIM * a);
    if (s->surface && diagonal[a - start] == 0) d = 1;
    PetscCall(MatSetValue(*A, a, a, d, INSERT_VALUES));
  }
  PetscCall(PetscFree(diagonal));
  PetscCall(MatAssemblyBegin(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*A, MAT_FINAL_ASSEMBLY));
  if (!s->surface) {
    MatNullSpace constant;

    PetscCall(MatNullSpaceCreate(PETSC_COMM_WORLD, PETSC_TRUE, 0, NULL, &constant));
    PetscCall(MatSetNullSpace(*A, constant));
    PetscCall(MatNullSpaceDestroy(&constant));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x'My = y'Mx and x'Mx > 0 for random vectors. */
static PetscErrorCode TestOperator(PC pc, Mat A, const char name[])
{
  Vec          x, y, Mx, My;
  PetscScalar  a, b, e, f;
  char         text[128];
  MatNullSpace constant;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(A, &x, &y));
  PetscCall(VecDuplicate(x, &Mx));
  PetscCall(VecDuplicate(x, &My));
  PetscCall(VecSetRandom(x, NULL));
  PetscCall(VecSetRandom(y, NULL));
  PetscCall(VecShift(x, -0.3));
  PetscCall(VecShift(y, -0.8));
  PetscCall(MatGetNullSpace(A, &constant));
  PetscCall(PCApply(pc, x, Mx));
  PetscCall(PCApply(pc, y, My));
  if (constant) {
    PetscCall(MatNullSpaceRemove(constant, x));
    PetscCall(MatNullSpaceRemove(constant, y));
    PetscCall(PCApply(pc, x, Mx));
    PetscCall(PCApply(pc, y, My));
  }
  PetscCall(VecDot(x, My, &a));
  PetscCall(VecDot(y, Mx, &b));
  PetscCall(VecDot(x, Mx, &e));
  PetscCall(VecDot(y, My, &f));
  PetscCall(PetscSNPrintf(text, sizeof(text), "%s_symmetric", name));
  CHECK_CLOSE(PetscRealPart(a), PetscRealPart(b), 1e-11 * PetscRealPart(e + f), text);
  PetscCall(PetscSNPrintf(text, sizeof(text), "%s_positive", name));
  CHECK(PetscRealPart(e) > 0 && PetscRealPart(f) > 0, text);
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y));
  PetscCall(VecDestroy(&Mx));
  PetscCall(VecDestroy(&My));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows of a rank. Points with no neighbour are all on the last rank, and nothing else is; without them the last of
   three ranks has no rows. */
static PetscInt RowsOfRank(const Scene_ *s, PetscInt N, PetscMPIInt rank, PetscMPIInt size)
{
  const PetscBool alone = (PetscBool)(size > 2 || (s->isolated && size > 1)); /* the last rank */
  const PetscInt  ranks = alone ? size - 1 : size, last = alone && s->isolated ? ISOLATED : 0;
  const PetscInt  shared = N - last;

  return alone && rank == size - 1 ? last : shared / ranks + (rank < shared % ranks);
}

/* A kept preconditioner serves when rows came to the free surface or left it: of the surplus of the diagonal that the
   closure makes there, odd rows get twice as much here, even rows a tenth. */
static PetscErrorCode TestKept(KSP ksp, Mat A, Vec x, Vec b, PetscInt dim, PetscReal own[], const char name[])
{
  PetscInt     start, end, iterations[2]; /* kept, new */
  PC           pc;
  Vec          diagonal, surplus;
  PetscScalar *value;
  char         text[128];

  PetscFunctionBegin;
  PetscCall(VecDuplicate(b, &diagonal));
  PetscCall(VecDuplicate(b, &surplus));
  PetscCall(VecSet(x, 1));
  PetscCall(MatMult(A, x, surplus));
  PetscCall(MatGetDiagonal(A, diagonal));
  PetscCall(MatGetOwnershipRange(A, &start, &end));
  PetscCall(VecGetArray(surplus, &value));
  for (PetscInt a = start; a < end; a++) value[a - start] *= a % 2 ? 1 : -0.9;
  PetscCall(VecRestoreArray(surplus, &value));
  PetscCall(VecAXPY(diagonal, 1, surplus));
  PetscCall(MatDiagonalSet(A, diagonal, INSERT_VALUES));
  PetscCall(KSPGetPC(ksp, &pc));
  for (PetscInt k = 0; k < 2; k++) {
    PetscCall(KSPSetReusePreconditioner(ksp, (PetscBool)(k == 0)));
    PetscCall(KSPSetOperators(ksp, A, A));
    if (k > 0) PetscCall(PCSetCoordinates(pc, dim, end - start, own));
    PetscCall(VecSet(x, 0));
    PetscCall(KSPSolve(ksp, b, x));
    PetscCall(KSPGetIterationNumber(ksp, &iterations[k]));
  }
  PetscCall(PetscSNPrintf(text, sizeof(text), "%s_kept", name));
  CHECK_CLOSE(iterations[0], iterations[1], KEPT_MORE, text);
  PetscCall(VecDestroy(&diagonal));
  PetscCall(VecDestroy(&surplus));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestScene(const Scene_ *s, PetscInt most, const char name[])
{
  KSP                ksp;
  PC                 pc;
  Mat                A;
  Vec                x, b, r;
  PetscInt           N = 0, n, start, iterations, jacobi;
  PetscReal         *points, *own, *volume, *factor, norm, error;
  PetscMPIInt        rank, size;
  KSPConvergedReason reason;
  char               text[128];
  const PetscReal    lower[DIM] = {0, 0, 0}, upper[DIM] = {s->n[0] * SPACING, s->n[1] * SPACING, s->n[2] * SPACING};

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(MakePoints(s, &N, &points));
  n = RowsOfRank(s, N, rank, size);
  PetscCall(MakeMatrix(s, N, points, n, &A));
  PetscCall(MatGetOwnershipRange(A, &start, NULL));
  PetscCall(PetscMalloc3(s->dim * n, &own, n, &volume, n, &factor));
  for (PetscInt a = 0; a < n; a++) volume[a] = 1;
  for (PetscInt a = 0; a < n; a++) factor[a] = Length(s, points + DIM * (start + a));
  for (PetscInt a = 0; a < n; a++)
    for (PetscInt d = 0; d < s->dim; d++) own[s->dim * a + d] = points[DIM * (start + a) + d];
  PetscCall(MatCreateVecs(A, &x, &b));
  PetscCall(VecDuplicate(b, &r));
  PetscCall(VecSetRandom(x, NULL));
  PetscCall(MatMult(A, x, b));
  PetscCall(KSPCreate(PETSC_COMM_WORLD, &ksp));
  PetscCall(KSPSetType(ksp, KSPCG));
  PetscCall(KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED));
  PetscCall(KSPSetTolerances(ksp, 1e-6, PETSC_DEFAULT, PETSC_DEFAULT, 1000));
  PetscCall(KSPSetOperators(ksp, A, A));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCJACOBI));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(KSPGetIterationNumber(ksp, &jacobi));
  PetscCall(PCSetType(pc, PCTWOLEVEL));
  PetscCall(PCTwoLevelSetGrid(pc, SPACING, lower, upper, s->periodic));
  if (s->rings) PetscCall(PCTwoLevelSetVolumes(pc, SPACING, n, volume, factor));
  PetscCall(PCSetCoordinates(pc, s->dim, n, own));
  PetscCall(KSPSetFromOptions(ksp));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(KSPGetIterationNumber(ksp, &iterations));
  PetscCall(KSPGetConvergedReason(ksp, &reason));
  PetscCall(MatMult(A, x, r));
  PetscCall(VecAXPY(r, -1, b));
  PetscCall(VecNorm(r, NORM_2, &error));
  PetscCall(VecNorm(b, NORM_2, &norm));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD,
                        "%s: %" PetscInt_FMT " rows, %" PetscInt_FMT " iterations, jacobi %" PetscInt_FMT "\n", name, N,
                        iterations, jacobi));
  PetscCall(PetscSNPrintf(text, sizeof(text), "%s_converges", name));
  CHECK(reason > 0 && error < 2e-6 * norm, text);
  PetscCall(PetscSNPrintf(text, sizeof(text), "%s_iterations", name));
  CHECK_CLOSE(iterations, 0.5 * most, 0.5 * most, text);
  PetscCall(TestOperator(pc, A, name));
  PetscCall(KSPSetOperators(ksp, A, A)); /* a second set-up, other rows' scale */
  PetscCall(PCSetCoordinates(pc, s->dim, n, own));
  PetscCall(MatScale(A, 2));
  PetscCall(VecScale(b, 2));
  PetscCall(VecSet(x, 0));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(KSPGetIterationNumber(ksp, &jacobi));
  PetscCall(PetscSNPrintf(text, sizeof(text), "%s_again", name));
  CHECK_CLOSE(jacobi, iterations, 0, text);
  if (s->surface) PetscCall(TestKept(ksp, A, x, b, s->dim, own, name));
  PetscCall(KSPDestroy(&ksp));
  PetscCall(MatDestroy(&A));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&r));
  PetscCall(PetscFree(points));
  PetscCall(PetscFree3(own, volume, factor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  const PetscBool       yes      = PETSC_TRUE;
  static const char    *names[]  = {"film",      "periodic_box", "closed_box",    "splash", "dam_2d",
                                    "narrow_2d", "rings",        "isolated_only", "shut_2d"};
  static const PetscInt most[]   = {20, 20, 20, 22, 25, 25, 18, 3, 30}; /* iterations */
  const Scene_          scenes[] = {
             {3, {16, 14, 12}, {yes, yes}, .surface = yes},
             {3, {15, 15, 15}, {yes, yes, yes}},
             {3, {12, 12, 9}},
             {3, {16, 14, 10}, {yes}, .surface = yes, .blob = yes, .isolated = yes},
             {2, {60, 30, 1}, .surface = yes, .blob = yes, .isolated = yes},
             {2, {6, 80, 1}, {yes}, .surface = yes},
             {2, {60, 30, 1}, .surface = yes, .rings = yes},
             {2, {0, 0, 0}, .surface = yes, .isolated = yes},
             {2, {60, 30, 1}, .surface = yes, .blob = yes, .shut = yes},
  };

  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(PCTwoLevelRegister());
  for (size_t c = 0; c < PETSC_STATIC_ARRAY_LENGTH(scenes); c++) PetscCall(TestScene(&scenes[c], most[c], names[c]));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
