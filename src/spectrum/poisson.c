/* The pressure operator: its extreme eigenvalues alone and under the preconditioner. */
#include "spectrum_impl.h"

#define TOLERANCE  1e-4  /* relative, of eigenvalues; of the preconditioned operator 10 times that */
#define INNER_RTOL 1e-10 /* of the solves with the operator */
#define WAVES      8     /* wave numbers a direction up to pi/d0 at which the lattice's symbol is taken */

typedef struct {
  Mat A;
  KSP ksp;
} Operators;

/* y = A^-1 x */
static PetscErrorCode ApplyInverse(Mat shell, Vec x, Vec y)
{
  Operators *o;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &o));
  PetscCall(VecSet(y, 0));
  PetscCall(KSPSolve(o->ksp, x, y));
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
  PetscCall(KSPGetPC(o->ksp, &pc));
  PetscCall(VecDuplicate(x, &Ax));
  PetscCall(MatMult(o->A, x, Ax));
  PetscCall(PCApply(pc, Ax, y));
  PetscCall(VecDestroy(&Ax));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest eigenvalue of a full lattice times density, 1/m2: the maximum over the wave number k of sum_b c_b (1 -
   cos k.r_b), c_b as in Eq. (8) of Kuri et al. with V = d0^dim; 3.53/d0^2 for the cubic spline with h = 1.3 d0. */
static PetscReal LatticeLargest(Cloud cloud)
{
  const PetscInt dim   = cloud->domain->dim,
                 reach = (PetscInt)(KernelSupport(cloud->kernel) / cloud->domain->spacing) + 1,
                 top = dim == 3 ? reach : 0, waves = dim == 3 ? WAVES : 0;
  const PetscReal d0 = cloud->domain->spacing, eta2 = EtaSquared(cloud->kernel), V = cloud->domain->volume;
  PetscReal       largest = 0;

  for (PetscInt p = 0; p <= WAVES; p++)
    for (PetscInt q = 0; q <= p; q++)
      for (PetscInt r = 0; r <= PetscMin(q, waves); r++) {
        PetscReal sum = 0;

        for (PetscInt k = -top; k <= top; k++)
          for (PetscInt j = -reach; j <= reach; j++)
            for (PetscInt i = -reach; i <= reach; i++) {
              const PetscReal r2 = d0 * d0 * (i * i + j * j + k * k);
              PetscReal       W, F;

              KernelEvaluate(cloud->kernel, 1, &r2, &W, &F);
              if (r2 > 0)
                sum -= 2 * V * F * r2 / (r2 + eta2) * (1 - PetscCosReal(PETSC_PI / WAVES * (p * i + q * j + r * k)));
            }
        largest = PetscMax(largest, sum);
      }
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

static PetscErrorCode Shell(Operators *o, PetscErrorCode (*apply)(Mat, Vec, Vec), Mat *shell)
{
  PetscInt n, N;

  PetscFunctionBegin;
  PetscCall(MatGetLocalSize(o->A, &n, NULL));
  PetscCall(MatGetSize(o->A, &N, NULL));
  PetscCall(MatCreateShell(PetscObjectComm((PetscObject)o->A), n, n, N, N, o, shell));
  PetscCall(MatShellSetOperation(*shell, MATOP_MULT, (void (*)(void))apply));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* CG with the preconditioner of the run, tight, watching its Lanczos process. */
static PetscErrorCode Watched(KSP model, KSP *ksp)
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
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The iterations from zero to the run's tolerance, and extreme singular values seen on the way to a tight one. */
static PetscErrorCode Lanczos(KSP ksp, Vec b, PetscReal rtol, PetscInt *iterations, PetscReal *most, PetscReal *least)
{
  Vec x;

  PetscFunctionBegin;
  PetscCall(VecDuplicate(b, &x));
  PetscCall(KSPSetTolerances(ksp, rtol, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(KSPGetIterationNumber(ksp, iterations));
  PetscCall(KSPSetTolerances(ksp, INNER_RTOL, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(VecSet(x, 0));
  PetscCall(KSPSolve(ksp, b, x));
  PetscCall(KSPComputeExtremeSingularValues(ksp, most, least));
  PetscCall(VecDestroy(&x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SpectrumPoisson(Spectrum s, PetscInt iterations)
{
  Cloud           cloud   = s->cloud;
  const PetscReal density = BodyMaterial(SceneBody(cloud->scene, 0))->density;
  Operators       o;
  KSP             model;
  Mat             inverse, preconditioned;
  MatNullSpace    null;
  Vec             b, constant = NULL;
  PetscReal       largest, smallest, most, least, seen_most, seen_least, theory, rtol;
  PetscBool       found[4];
  PetscInt        solve, rows;
  PCType          name;
  PC              pc;
  char            words[128] = "";

  PetscFunctionBegin;
  PetscCall(PressureSolver(s->pressure, &model, &b));
  PetscCall(KSPGetOperators(model, &o.A, NULL));
  PetscCall(KSPGetTolerances(model, &rtol, NULL, NULL, NULL));
  PetscCall(KSPGetPC(model, &pc));
  PetscCall(PCGetType(pc, &name));
  PetscCall(MatGetSize(o.A, &rows, NULL));
  PetscCall(MatGetNullSpace(o.A, &null));
  if (null) {
    PetscCall(VecDuplicate(b, &constant));
    PetscCall(VecSet(constant, 1));
    PetscCall(MatNullSpaceRemove(null, b));
  }
  PetscCall(Watched(model, &o.ksp));
  PetscCall(Shell(&o, ApplyInverse, &inverse));
  PetscCall(Shell(&o, ApplyPreconditioned, &preconditioned));
  PetscCall(SpectrumExtreme(o.A, EPS_HEP, EPS_LARGEST_REAL, TOLERANCE, constant, &largest, &found[0]));
  PetscCall(SpectrumExtreme(inverse, EPS_HEP, EPS_LARGEST_REAL, TOLERANCE, constant, &smallest, &found[1]));
  smallest = 1 / smallest;
  PetscCall(SmallestInTheory(cloud, (PetscBool)!null, &theory, words, sizeof(words)));
  PetscCall(
    PetscPrintf(cloud->comm,
                "  pressure operator, %" PetscInt_FMT " rows (eigenvalues times density)\n"
                "    largest    %.5g 1/m2 = %.4g/d0^2; a full lattice has %.4g/d0^2\n"
                "    smallest   %.5g 1/m2",
                rows, (double)(largest * density), (double)(largest * density * PetscSqr(cloud->domain->spacing)),
                (double)(LatticeLargest(cloud) * PetscSqr(cloud->domain->spacing)), (double)(smallest * density)));
  if (theory > 0) PetscCall(PetscPrintf(cloud->comm, "; theory %.5g 1/m2, %s", (double)theory, words));
  PetscCall(PetscPrintf(cloud->comm, "\n    condition  %.5g%s\n", (double)(largest / smallest),
                        null ? ", constants left out" : ""));
  PetscCall(SpectrumExtreme(preconditioned, EPS_NHEP, EPS_LARGEST_REAL, 10 * TOLERANCE, constant, &most, &found[2]));
  PetscCall(SpectrumExtreme(preconditioned, EPS_NHEP, EPS_SMALLEST_REAL, 10 * TOLERANCE, constant, &least, &found[3]));
  PetscCall(Lanczos(o.ksp, b, rtol, &solve, &seen_most, &seen_least));
  PetscCall(PetscPrintf(cloud->comm,
                        "  with -pc_type %s\n"
                        "    largest    %.5g, smallest %.5g, condition %.5g\n"
                        "    CG saw     %.5g, %.5g, %.5g (KSPSetComputeSingularValues)\n"
                        "    iterations %" PetscInt_FMT
                        " from zero to %.0e; at most %.0f by that condition; %" PetscInt_FMT
                        " in the last step, from the former pressure\n",
                        name, (double)most, (double)least, (double)(most / least), (double)seen_most,
                        (double)seen_least, (double)(seen_most / seen_least), solve, (double)rtol,
                        PetscCeilReal(0.5 * PetscSqrtReal(most / least) *
                                      PetscLogReal(2 * PetscSqrtReal(largest / smallest) / rtol)),
                        iterations));
  if (!found[0] || !found[1] || !found[2] || !found[3])
    PetscCall(PetscPrintf(cloud->comm, "    nan: not converged; -spectrum_eps_max_it, -spectrum_eps_ncv help\n"));
  PetscCall(MatDestroy(&inverse));
  PetscCall(MatDestroy(&preconditioned));
  PetscCall(KSPDestroy(&o.ksp));
  PetscCall(VecDestroy(&constant));
  PetscFunctionReturn(PETSC_SUCCESS);
}
