/* The pressure operator: its extreme eigenvalues, plain and preconditioned. */
#include "spectrum_impl.h"

#define TOLERANCE  1e-4  /* relative, of eigenvalues of A; 10 times this for the preconditioned operator */
#define INNER_RTOL 1e-10 /* of the solves with A */
#define WAVES      8     /* wave numbers per direction, up to pi/d0, that sample the symbol of the lattice */

/* The pressure operator A. */
typedef struct {
  Mat       A;
  Mat       plain, inverse, preconditioned; /* shells: A and A^-1, scaled by 'root'; M^-1 A */
  KSP       ksp;                            /* solves with A to INNER_RTOL */
  Vec       b;                              /* the run's right-hand side, borrowed */
  Vec       constant;                       /* null space, times root; NULL: none */
  Vec       root;                           /* D^1/2 of rings, see Scaled; NULL: all 1 */
  PCType    preconditioner;                 /* its name */
  PetscReal rtol;                           /* of the run's solves */
} Operators;

typedef struct {
  PetscReal largest, smallest;                               /* eigenvalues of A */
  PetscReal preconditioned_largest, preconditioned_smallest; /* of the preconditioned operator */
  PetscReal cg_largest, cg_smallest;                         /* the same, by the Lanczos process of CG */
  PetscInt  iterations;                                      /* of CG, from zero to the run's tolerance */
  PetscBool converged;                                       /* all eigenvalues */
} Extremes;

/* A ring's row of A is that of the Laplacian times its volume V over V_0. With D = V/V_0, D^-1/2 A D^-1/2 is symmetric
   and has the eigenvalues of the Laplacian. out: a copy of x, divided by D^1/2 or multiplied; destroy it. */
static PetscErrorCode Scaled(const Operators *o, PetscBool divide, Vec x, Vec *out)
{
  PetscFunctionBegin;
  PetscCall(VecDuplicate(x, out));
  PetscCall(VecCopy(x, *out));
  if (o->root && divide) PetscCall(VecPointwiseDivide(*out, x, o->root));
  if (o->root && !divide) PetscCall(VecPointwiseMult(*out, x, o->root));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = A x */
static PetscErrorCode ApplyOperator(Mat shell, Vec x, Vec y)
{
  Operators *o;
  Vec        in;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &o));
  PetscCall(ProgressWork(PetscObjectComm((PetscObject)shell), -1, "a product of the pressure operator"));
  PetscCall(Scaled(o, PETSC_TRUE, x, &in));
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
  PetscCall(Scaled(o, PETSC_FALSE, x, &in));
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

/* The symbol of a full lattice, sum_b c_b (1 - cos k.r_b), 1/m2, with c_b of Eq. (8) of Kuri et al. and V = d0^dim.
   wave: k in units of pi/(WAVES d0). */
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

/* The largest eigenvalue of a full lattice times density, 1/m2: the maximum of the symbol. It is 3.53/d0^2 for the
   cubic spline with h = 1.3 d0. */
static PetscReal LatticeLargest(Cloud cloud)
{
  const PetscInt first[DIM] = {0, 0, 0}, last[DIM] = {WAVES, WAVES, cloud->domain->dim == DIM ? WAVES : 0};
  PetscInt       wave[DIM] = {0, 0, 0};
  PetscReal      largest   = 0;

  do {
    if (wave[0] < wave[1] || wave[1] < wave[2]) continue; /* the symbol is symmetric in the directions */
    largest = PetscMax(largest, LatticeSymbol(cloud, wave));
  } while (CellNext(first, last, wave));
  return largest;
}

/* The smallest eigenvalue times density in theory, 1/m2: (pi/2H)^2 for a layer of depth H on a wall, (2 pi/L)^2 for a
   full periodic box, 0 (unknown) for other scenes. */
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

/* A monitor of CG: shows the progress. */
static PetscErrorCode ShowIteration(KSP ksp, PetscInt iterations, PetscReal residual, void *context)
{
  PetscFunctionBegin;
  PetscCall(ProgressWork(PetscObjectComm((PetscObject)ksp), -1,
                         "iteration %" PetscInt_FMT " of a tight solve, residual %.1e", iterations, (double)residual));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* CG to INNER_RTOL, with the run's preconditioner; CG keeps its Lanczos process. */
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
  PetscCall(KSPMonitorSet(*ksp, ShowIteration, NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Counts CG's iterations from zero to the run's tolerance, then solves to INNER_RTOL for the extreme singular values.
 */
static PetscErrorCode SolveTightly(const Operators *o, Extremes *e)
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
  PetscCall(KSPComputeExtremeSingularValues(ksp, &e->cg_largest, &e->cg_smallest));
  PetscCall(VecDestroy(&x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* D^1/2 of Scaled: the square root of each row's volume over V_0. */
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
  KSP          model; /* the run's solver */
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
    if (vectors) PetscCall(VecCopy(vector[0], o->constant)); /* zero in rows outside the null space */
    PetscCall(MatNullSpaceRemove(null, o->b));
    if (o->root) PetscCall(VecPointwiseMult(o->constant, o->constant, o->root));
  }
  PetscCall(CreateTightSolver(model, &o->ksp));
  PetscCall(CreateShell(o, ApplyOperator, &o->plain));
  PetscCall(CreateShell(o, ApplyInverse, &o->inverse));
  PetscCall(CreateShell(o, ApplyPreconditioned, &o->preconditioned));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DestroyOperators(Operators *o)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&o->plain));
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
  PetscCall(SpectrumExtreme(o->plain, EPS_HEP, EPS_LARGEST_REAL, TOLERANCE, o->constant, &e->largest, &found[0]));
  PetscCall(SpectrumExtreme(o->inverse, EPS_HEP, EPS_LARGEST_REAL, TOLERANCE, o->constant, &inverse, &found[1]));
  e->smallest = 1 / inverse;
  PetscCall(SpectrumExtreme(o->preconditioned, EPS_NHEP, EPS_LARGEST_REAL, 10 * TOLERANCE, o->constant,
                            &e->preconditioned_largest, &found[2]));
  PetscCall(SpectrumExtreme(o->preconditioned, EPS_NHEP, EPS_SMALLEST_REAL, 10 * TOLERANCE, o->constant,
                            &e->preconditioned_smallest, &found[3]));
  PetscCall(SolveTightly(o, e));
  e->converged = (PetscBool)(found[0] && found[1] && found[2] && found[3]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Prints the plain operator beside theory. */
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

/* Prints the preconditioned operator beside the iterations. */
static PetscErrorCode PrintPreconditioned(Cloud cloud, const Operators *o, const Extremes *e, PetscInt iterations)
{
  const PetscReal condition = e->preconditioned_largest / e->preconditioned_smallest;
  const PetscReal bound     = /* on the iterations of CG with this condition */
    PetscCeilReal(0.5 * PetscSqrtReal(condition) * PetscLogReal(2 * PetscSqrtReal(e->largest / e->smallest) / o->rtol));

  PetscFunctionBegin;
  PetscCall(
    PetscPrintf(cloud->comm,
                "  with -pc_type %s\n"
                "    largest    %.5g, smallest %.5g, condition %.5g\n"
                "    CG saw     %.5g, %.5g, %.5g (KSPSetComputeSingularValues)\n"
                "    iterations %" PetscInt_FMT " from zero to %.0e; at most %.0f by that condition; %" PetscInt_FMT
                " in the last step, from the former pressure\n",
                o->preconditioner, (double)e->preconditioned_largest, (double)e->preconditioned_smallest,
                (double)condition, (double)e->cg_largest, (double)e->cg_smallest,
                (double)(e->cg_largest / e->cg_smallest), e->iterations, (double)o->rtol, (double)bound, iterations));
  if (!e->converged)
    PetscCall(PetscPrintf(cloud->comm, "    nan: not converged; increase -spectrum_eps_max_it or -spectrum_eps_ncv\n"));
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
