/* The pressure operator: its extreme eigenvalues alone and under the preconditioner. */
#include "spectrum_impl.h"

#define TOLERANCE  1e-4  /* relative, of eigenvalues; of the preconditioned operator 10 times that */
#define INNER_RTOL 1e-10 /* of the solves with the operator */
#define WAVES      8     /* wave numbers a direction up to pi/d0 at which the lattice's symbol is taken */

/* The pressure operator A and what is made of it. */
typedef struct {
  Mat       A, watched, inverse, preconditioned; /* the last three as shells; watched: A with lines of progress */
  KSP       ksp;                                 /* solves with A, tightly */
  Vec       b;                                   /* a right side, borrowed */
  Vec       constant;                            /* of the null space, times root; NULL: there is none */
  Vec       root;                                /* of rings: see Unweigh; NULL: all 1 */
  PCType    preconditioner;                      /* its name */
  PetscReal rtol;                                /* of the run's own solves */
} Operators;

/* What was found. */
typedef struct {
  PetscReal largest, smallest;     /* eigenvalues of A */
  PetscReal most, least;           /* of the preconditioned one */
  PetscReal seen_most, seen_least; /* of the preconditioned one, by CG's Lanczos process */
  PetscInt  iterations;            /* from zero to the run's tolerance */
  PetscBool converged;             /* all of them */
} Extremes;

/* The rows of rings are those of the Laplacian times their volumes V over V_0. With D = V/V_0, D^-1/2 A D^-1/2 is
   symmetric and has the Laplacian's eigenvalues: divides x by D^1/2, or multiplies. A copy, to be destroyed. */
static PetscErrorCode Unweigh(const Operators *o, PetscBool divide, Vec x, Vec *out)
{
  PetscFunctionBegin;
  PetscCall(VecDuplicate(x, out));
  PetscCall(VecCopy(x, *out));
  if (o->root && divide) PetscCall(VecPointwiseDivide(*out, x, o->root));
  if (o->root && !divide) PetscCall(VecPointwiseMult(*out, x, o->root));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = A x */
static PetscErrorCode ApplyWatched(Mat shell, Vec x, Vec y)
{
  Operators *o;
  Vec        in;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &o));
  PetscCall(ProgressWork(PetscObjectComm((PetscObject)shell), -1, "a product of the pressure operator"));
  PetscCall(Unweigh(o, PETSC_TRUE, x, &in));
  PetscCall(MatMult(o->A, in, y));
  PetscCall(VecDestroy(&in));
  if (o->root) PetscCall(VecPointwiseDivide(y, y, o->root));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = A^-1 x */
static PetscErrorCode ApplyInverse(Mat shell, Vec x, Vec y)
{
  Operators *o;
  Vec        in;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &o));
  PetscCall(Unweigh(o, PETSC_FALSE, x, &in));
  PetscCall(VecSet(y, 0));
  PetscCall(KSPSolve(o->ksp, in, y));
  PetscCall(VecDestroy(&in));
  if (o->root) PetscCall(VecPointwiseMult(y, y, o->root));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = M^-1 A x */
static PetscErrorCode ApplyPreconditioned(Mat shell, Vec x, Vec y)
{
  Operators *o;
  PC         pc;
  Vec        Ax;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &o));
  PetscCall(ProgressWork(PetscObjectComm((PetscObject)shell), -1, "a product of the preconditioned operator"));
  PetscCall(KSPGetPC(o->ksp, &pc));
  PetscCall(VecDuplicate(x, &Ax));
  PetscCall(MatMult(o->A, x, Ax));
  PetscCall(PCApply(pc, Ax, y));
  PetscCall(VecDestroy(&Ax));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* sum_b c_b (1 - cos k.r_b) over a full lattice, 1/m2, with c_b as in Eq. (8) of Kuri et al. and V = d0^dim; wave: k in
   units of pi/(WAVES d0). */
static PetscReal LatticeSymbol(Cloud cloud, const PetscInt wave[DIM])
{
  const PetscInt reach = (PetscInt)(KernelSupport(cloud->kernel) / cloud->domain->spacing) + 1,
                 top = cloud->domain->dim == DIM ? reach : 0, first[DIM] = {-reach, -reach, -top},
                 last[DIM] = {reach, reach, top};
  const PetscReal d0 = cloud->domain->spacing, eta2 = EtaSquared(cloud->kernel), V = cloud->domain->volume;
  PetscInt        at[DIM] = {-reach, -reach, -top};
  PetscReal       sum     = 0;

  do {
    const PetscReal r2    = d0 * d0 * (at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
    const PetscInt  phase = wave[0] * at[0] + wave[1] * at[1] + wave[2] * at[2];
    PetscReal       W, F;

    if (!(r2 > 0)) continue;
    KernelEvaluate(cloud->kernel, 1, &r2, &W, &F);
    sum -= 2 * V * F * r2 / (r2 + eta2) * (1 - PetscCosReal(PETSC_PI / WAVES * phase));
  } while (CellNext(first, last, at));
  return sum;
}

/* The largest eigenvalue of a full lattice times density, 1/m2: the maximum of the symbol over the wave numbers;
   3.53/d0^2 for the cubic spline with h = 1.3 d0. */
static PetscReal LatticeLargest(Cloud cloud)
{
  const PetscInt first[DIM] = {0, 0, 0}, last[DIM] = {WAVES, WAVES, cloud->domain->dim == DIM ? WAVES : 0};
  PetscInt       wave[DIM] = {0, 0, 0};
  PetscReal      largest   = 0;

  do {
    if (wave[0] < wave[1] || wave[1] < wave[2]) continue; /* by symmetry no other than its mirror images */
    largest = PetscMax(largest, LatticeSymbol(cloud, wave));
  } while (CellNext(first, last, wave));
  return largest;
}

/* What theory says of the smallest eigenvalue times density (1/m2), 0 where it says nothing: (pi/2H)^2 of a layer of
   depth H on a wall, (2 pi/L)^2 of a full periodic box. */
static PetscErrorCode SmallestInTheory(Cloud cloud, PetscBool free, PetscReal *value, char words[], size_t length)
{
  const Domain   domain = cloud->domain;
  const PetscInt up     = domain->dim - 1;
  PetscReal      top = -PETSC_MAX_REAL, longest = 0;
  PetscBool      closed = PETSC_TRUE, periodic = PETSC_TRUE;

  PetscFunctionBegin;
  *value = 0;
  for (PetscInt d = 0; d < domain->dim; d++) {
    if (d != up) closed = (PetscBool)(closed && domain->face[d][0] != FACE_OPEN && domain->face[d][1] != FACE_OPEN);
    periodic = (PetscBool)(periodic && domain->face[d][0] == FACE_PERIODIC);
    longest  = PetscMax(longest, domain->upper[d] - domain->lower[d]);
  }
  for (PetscInt a = 0; a < cloud->n_fluid; a++) top = PetscMax(top, cloud->field[FIELD_POSITION][DIM * a + up]);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &top, 1, MPIU_REAL, MPIU_MAX, cloud->comm));
  if (closed && free && domain->face[up][0] == FACE_WALL) {
    const PetscReal depth = top + 0.5 * domain->spacing - domain->lower[up];

    *value = PetscSqr(PETSC_PI / (2 * depth));
    PetscCall(PetscSNPrintf(words, length, "(pi/2H)^2, a layer H = %.3g m deep", (double)depth));
  } else if (periodic && !free) {
    *value = PetscSqr(2 * PETSC_PI / longest);
    PetscCall(PetscSNPrintf(words, length, "(2 pi/L)^2, L = %.3g m", (double)longest));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateShell(Operators *o, PetscErrorCode (*apply)(Mat, Vec, Vec), Mat *shell)
{
  PetscInt n, N;

  PetscFunctionBegin;
  PetscCall(MatGetLocalSize(o->A, &n, NULL));
  PetscCall(MatGetSize(o->A, &N, NULL));
  PetscCall(MatCreateShell(PetscObjectComm((PetscObject)o->A), n, n, N, N, o, shell));
  PetscCall(MatShellSetOperation(*shell, MATOP_MULT, (void (*)(void))apply));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A monitor of CG. */
static PetscErrorCode Watch(KSP ksp, PetscInt iterations, PetscReal residual, void *context)
{
  PetscFunctionBegin;
  PetscCall(ProgressWork(PetscObjectComm((PetscObject)ksp), -1,
                         "iteration %" PetscInt_FMT " of a tight solve, residual %.1e", iterations, (double)residual));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* CG with the preconditioner of the run, tight, watching its Lanczos process. */
static PetscErrorCode CreateTightSolver(KSP model, KSP *ksp)
{
  Mat A, P;
  PC  pc;

  PetscFunctionBegin;
  PetscCall(KSPGetOperators(model, &A, &P));
  PetscCall(KSPGetPC(model, &pc));
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)model), ksp));
  PetscCall(KSPSetOperators(*ksp, A, P));
  PetscCall(KSPSetType(*ksp, KSPCG));
  PetscCall(KSPSetPC(*ksp, pc));
  PetscCall(KSPSetNormType(*ksp, KSP_NORM_UNPRECONDITIONED));
  PetscCall(KSPSetTolerances(*ksp, INNER_RTOL, PETSC_DEFAULT, PETSC_DEFAULT, 100000));
  PetscCall(KSPSetComputeSingularValues(*ksp, PETSC_TRUE));
  PetscCall(KSPMonitorSet(*ksp, Watch, NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The iterations from zero to the run's tolerance, and extreme singular values seen on the way to a tight one. */
static PetscErrorCode WatchLanczos(const Operators *o, Extremes *e)
{
  const KSP ksp = o->ksp;
  Vec       x;

  PetscFunctionBegin;
  PetscCall(VecDuplicate(o->b, &x));
  PetscCall(KSPSetTolerances(ksp, o->rtol, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(KSPSolve(ksp, o->b, x));
  PetscCall(KSPGetIterationNumber(ksp, &e->iterations));
  PetscCall(KSPSetTolerances(ksp, INNER_RTOL, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(VecSet(x, 0));
  PetscCall(KSPSolve(ksp, o->b, x));
  PetscCall(KSPComputeExtremeSingularValues(ksp, &e->seen_most, &e->seen_least));
  PetscCall(VecDestroy(&x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The square root of each row's volume over V_0. */
static PetscErrorCode CreateRoot(Spectrum s, Vec like, Vec *root)
{
  const Cloud  cloud = s->cloud;
  PetscScalar *value;

  PetscFunctionBegin;
  *root = NULL;
  if (!cloud->domain->rings) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecDuplicate(like, root));
  PetscCall(VecGetArrayWrite(*root, &value));
  for (PetscInt r = 0; r < cloud->n_rows; r++) value[r] = PetscSqrtReal(cloud->volume[r] / cloud->domain->volume);
  PetscCall(VecRestoreArrayWrite(*root, &value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateOperators(Spectrum s, Operators *o)
{
  KSP          model; /* of the run */
  PC           pc;
  MatNullSpace null;
  PetscInt     vectors;
  const Vec   *vector;

  PetscFunctionBegin;
  PetscCall(PressureSolver(s->pressure, &model, &o->b));
  PetscCall(KSPGetOperators(model, &o->A, NULL));
  PetscCall(KSPGetTolerances(model, &o->rtol, NULL, NULL, NULL));
  PetscCall(KSPGetPC(model, &pc));
  PetscCall(PCGetType(pc, &o->preconditioner));
  PetscCall(MatGetNullSpace(o->A, &null));
  PetscCall(CreateRoot(s, o->b, &o->root));
  o->constant = NULL;
  if (null) {
    PetscCall(VecDuplicate(o->b, &o->constant));
    PetscCall(VecSet(o->constant, 1));
    PetscCall(MatNullSpaceGetVecs(null, NULL, &vectors, &vector));
    if (vectors) PetscCall(VecCopy(vector[0], o->constant)); /* some rows have no part in it */
    PetscCall(MatNullSpaceRemove(null, o->b));
    if (o->root) PetscCall(VecPointwiseMult(o->constant, o->constant, o->root));
  }
  PetscCall(CreateTightSolver(model, &o->ksp));
  PetscCall(CreateShell(o, ApplyWatched, &o->watched));
  PetscCall(CreateShell(o, ApplyInverse, &o->inverse));
  PetscCall(CreateShell(o, ApplyPreconditioned, &o->preconditioned));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DestroyOperators(Operators *o)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&o->watched));
  PetscCall(MatDestroy(&o->inverse));
  PetscCall(MatDestroy(&o->preconditioned));
  PetscCall(KSPDestroy(&o->ksp));
  PetscCall(VecDestroy(&o->constant));
  PetscCall(VecDestroy(&o->root));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FindExtremes(const Operators *o, Extremes *e)
{
  PetscReal inverse;
  PetscBool found[4];

  PetscFunctionBegin;
  PetscCall(SpectrumExtreme(o->watched, EPS_HEP, EPS_LARGEST_REAL, TOLERANCE, o->constant, &e->largest, &found[0]));
  PetscCall(SpectrumExtreme(o->inverse, EPS_HEP, EPS_LARGEST_REAL, TOLERANCE, o->constant, &inverse, &found[1]));
  e->smallest = 1 / inverse;
  PetscCall(
    SpectrumExtreme(o->preconditioned, EPS_NHEP, EPS_LARGEST_REAL, 10 * TOLERANCE, o->constant, &e->most, &found[2]));
  PetscCall(
    SpectrumExtreme(o->preconditioned, EPS_NHEP, EPS_SMALLEST_REAL, 10 * TOLERANCE, o->constant, &e->least, &found[3]));
  PetscCall(WatchLanczos(o, e));
  e->converged = (PetscBool)(found[0] && found[1] && found[2] && found[3]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The operator alone, beside theory. */
static PetscErrorCode PrintOperator(Cloud cloud, const Operators *o, const Extremes *e, PetscInt rows)
{
  const PetscReal density = BodyMaterial(SceneBody(cloud->scene, 0))->density, d0 = cloud->domain->spacing;
  PetscReal       theory;
  char            words[128] = "";

  PetscFunctionBegin;
  PetscCall(SmallestInTheory(cloud, (PetscBool)!o->constant, &theory, words, sizeof(words)));
  PetscCall(PetscPrintf(cloud->comm,
                        "  pressure operator, %" PetscInt_FMT " rows (eigenvalues times density)\n"
                        "    largest    %.5g 1/m2 = %.4g/d0^2; a full lattice has %.4g/d0^2\n"
                        "    smallest   %.5g 1/m2",
                        rows, (double)(e->largest * density), (double)(e->largest * density * PetscSqr(d0)),
                        (double)(LatticeLargest(cloud) * PetscSqr(d0)), (double)(e->smallest * density)));
  if (theory > 0) PetscCall(PetscPrintf(cloud->comm, "; theory %.5g 1/m2, %s", (double)theory, words));
  PetscCall(PetscPrintf(cloud->comm, "\n    condition  %.5g%s\n", (double)(e->largest / e->smallest),
                        o->constant ? ", constants left out" : ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The operator under the preconditioner, beside the iterations. */
static PetscErrorCode PrintPreconditioned(Cloud cloud, const Operators *o, const Extremes *e, PetscInt iterations)
{
  const PetscReal condition = e->most / e->least; /* and the bound on CG's iterations that follows from it */
  const PetscReal bound =
    PetscCeilReal(0.5 * PetscSqrtReal(condition) * PetscLogReal(2 * PetscSqrtReal(e->largest / e->smallest) / o->rtol));

  PetscFunctionBegin;
  PetscCall(PetscPrintf(cloud->comm,
                        "  with -pc_type %s\n"
                        "    largest    %.5g, smallest %.5g, condition %.5g\n"
                        "    CG saw     %.5g, %.5g, %.5g (KSPSetComputeSingularValues)\n"
                        "    iterations %" PetscInt_FMT
                        " from zero to %.0e; at most %.0f by that condition; %" PetscInt_FMT
                        " in the last step, from the former pressure\n",
                        o->preconditioner, (double)e->most, (double)e->least, (double)condition, (double)e->seen_most,
                        (double)e->seen_least, (double)(e->seen_most / e->seen_least), e->iterations, (double)o->rtol,
                        (double)bound, iterations));
  if (!e->converged)
    PetscCall(PetscPrintf(cloud->comm, "    nan: not converged; -spectrum_eps_max_it, -spectrum_eps_ncv help\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SpectrumPoisson(Spectrum s, PetscInt iterations)
{
  Operators o;
  Extremes  e;
  PetscInt  rows;

  PetscFunctionBegin;
  PetscCall(CreateOperators(s, &o));
  PetscCall(FindExtremes(&o, &e));
  PetscCall(MatGetSize(o.A, &rows, NULL));
  PetscCall(PrintOperator(s->cloud, &o, &e, rows));
  PetscCall(PrintPreconditioned(s->cloud, &o, &e, iterations));
  PetscCall(DestroyOperators(&o));
  PetscFunctionReturn(PETSC_SUCCESS);
}
