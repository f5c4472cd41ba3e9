/* The oscillation modes of a free drop (Rayleigh 1879; Lamb, Hydrodynamics, section 275): the 2n + 1 modes of degree n
   have omega^2 = n (n-1)(n+2) sigma/(rho R^3).

   The displacements of an ideal drop are gradients of the solid harmonics r^n Y_nm. The Rayleigh-Ritz method projects
   CapillaryResponse onto these displacements, up to two degrees above the highest reported degree; SLEPc solves the
   small problem. A Krylov method cannot find the modes of the whole operator: its kernel holds all displacements that
   leave the surface as it is, and the wanted eigenvalues are the smallest outside the kernel. */
#include "spectrum_impl.h"

#define HIGHEST 4    /* reported degree */
#define EXTRA   2    /* degrees above the highest reported degree */
#define STEP    1e-4 /* R, of the finite difference for the gradient of a harmonic */
#define DEGREES (HIGHEST + EXTRA)

/* r^n P_nm(cos theta) cos(m phi) at x (over R); sin(m phi) for m < 0. */
static PetscReal SolidHarmonic(PetscInt n, PetscInt m, const PetscReal x[DIM])
{
  const PetscInt  order = PetscAbsInt(m);
  const PetscReal r2    = Dot(x, x);
  PetscReal       c = 1, s = 0, lower = 0, value;

  for (PetscInt k = 0; k < order; k++) {
    const PetscReal next = x[0] * c - x[1] * s;

    s = x[0] * s + x[1] * c;
    c = next;
  }
  value = m < 0 ? s : c;
  for (PetscInt k = order; k < n; k++) { /* Legendre's recursion in the degree */
    const PetscReal next = ((2 * k + 1) * x[2] * value - (k + order) * r2 * lower) / (k - order + 1);

    lower = value;
    value = next;
  }
  return value;
}

/* Centre of mass (m) and radius (m, from the volume) of the drop. */
static PetscErrorCode MeasureDrop(Cloud cloud, PetscReal centre[DIM], PetscReal *radius)
{
  PetscReal sum[4] = {0, 0, 0, 0};

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    sum[3] += cloud->volume[a];
    for (PetscInt d = 0; d < DIM; d++) sum[d] += cloud->volume[a] * cloud->field[FIELD_POSITION][DIM * a + d];
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 4, MPIU_REAL, MPI_SUM, cloud->comm));
  for (PetscInt d = 0; d < DIM; d++) centre[d] = sum[d] / sum[3];
  *radius = PetscCbrtReal(3 * sum[3] / (4 * PETSC_PI));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the scene is a single drop with tension, in three dimensions and an open box. */
static PetscBool IsFreeDrop(Spectrum s)
{
  const Domain domain = s->cloud->domain;

  if (domain->dim < 3 || SceneCount(s->cloud->scene) > 1 || TensionReach(s->tension) <= 0) return PETSC_FALSE;
  for (PetscInt d = 0; d < DIM; d++)
    if (domain->face[d][0] != FACE_OPEN || domain->face[d][1] != FACE_OPEN) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* Displacements basis[k] ([n_fluid][3]) of the degrees 1 to 'most'. */
static PetscErrorCode HarmonicDisplacements(Spectrum s, const PetscReal centre[DIM], PetscReal radius, PetscInt most,
                                            PetscReal *basis[])
{
  Cloud    cloud = s->cloud;
  PetscInt k     = 0;

  PetscFunctionBegin;
  for (PetscInt n = 1; n <= most; n++)
    for (PetscInt m = -n; m <= n; m++, k++) {
      PetscCall(PetscMalloc1(DIM * cloud->n_fluid, &basis[k]));
      for (PetscInt a = 0; a < cloud->n_fluid; a++) {
        PetscReal x[DIM];

        for (PetscInt d = 0; d < DIM; d++) x[d] = (s->position[DIM * a + d] - centre[d]) / radius;
        for (PetscInt d = 0; d < DIM; d++) {
          PetscReal above[DIM] = {x[0], x[1], x[2]}, below[DIM] = {x[0], x[1], x[2]};

          above[d] += STEP;
          below[d] -= STEP;
          basis[k][DIM * a + d] = (SolidHarmonic(n, m, above) - SolidHarmonic(n, m, below)) / (2 * STEP);
        }
      }
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* row[j] = basis_j . v, over all ranks. */
static PetscErrorCode BasisProducts(Cloud cloud, PetscInt count, PetscReal *basis[], const PetscReal v[],
                                    PetscReal row[])
{
  PetscFunctionBegin;
  for (PetscInt j = 0; j < count; j++) {
    row[j] = 0;
    for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) row[j] += basis[j][k] * v[k];
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, row, (PetscMPIInt)count, MPIU_REAL, MPI_SUM, cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The small matrices K and M of K x = omega^2 M x, the same on every rank. */
static PetscErrorCode ProjectOperator(Spectrum s, PetscInt count, PetscReal *basis[], Mat *K, Mat *M)
{
  Cloud        cloud = s->cloud;
  PetscReal   *response, *row;
  PetscScalar *k, *m;

  PetscFunctionBegin;
  PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, count, count, NULL, K));
  PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, count, count, NULL, M));
  PetscCall(PetscMalloc2(DIM * cloud->n_fluid, &response, count, &row));
  PetscCall(MatDenseGetArray(*K, &k));
  PetscCall(MatDenseGetArray(*M, &m));
  for (PetscInt i = 0; i < count; i++) {
    PetscCall(CapillaryResponse(s, basis[i], response));
    PetscCall(BasisProducts(cloud, count, basis, response, row));
    for (PetscInt j = 0; j < count; j++) k[i * count + j] = -row[j];
    PetscCall(BasisProducts(cloud, count, basis, basis[i], row));
    for (PetscInt j = 0; j < count; j++) m[i * count + j] = row[j];
  }
  PetscCall(MatDenseRestoreArray(*M, &m));
  PetscCall(MatDenseRestoreArray(*K, &k));
  PetscCall(PetscFree2(response, row));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The degree with the largest part of the eigenvector x, in the norm of M. */
static PetscInt DegreeOf(PetscInt most, const PetscScalar x[], Mat M)
{
  PetscReal          best   = -1;
  PetscInt           degree = 0, k = 0, count;
  const PetscScalar *m;

  (void)MatGetSize(M, &count, NULL);
  (void)MatDenseGetArrayRead(M, &m);
  for (PetscInt n = 1; n <= most; n++) {
    PetscReal sum = 0;

    for (PetscInt j = 0; j < 2 * n + 1; j++, k++)
      sum += PetscSqr(PetscAbsScalar(x[k])) * PetscRealPart(m[k * count + k]);
    if (sum > best) {
      best   = sum;
      degree = n;
    }
  }
  (void)MatDenseRestoreArrayRead(M, &m);
  return degree;
}

/* Solves K x = omega^2 M x: number, sum, smallest and largest of the eigenvalues of each degree. */
static PetscErrorCode SolveModes(Mat K, Mat M, PetscInt most, PetscInt number[], PetscReal sum[], PetscReal low[],
                                 PetscReal high[])
{
  EPS      eps;
  Vec      x;
  PetscInt count, found;

  PetscFunctionBegin;
  PetscCall(EPSCreate(PETSC_COMM_SELF, &eps));
  PetscCall(EPSSetOperators(eps, K, M));
  PetscCall(EPSSetProblemType(eps, EPS_GNHEP));
  PetscCall(EPSSetType(eps, EPSLAPACK));
  PetscCall(EPSSolve(eps));
  PetscCall(EPSGetConverged(eps, &found));
  PetscCall(MatCreateVecs(K, &x, NULL));
  PetscCall(MatGetSize(K, &count, NULL));
  for (PetscInt n = 0; n <= most; n++) {
    number[n] = 0;
    sum[n]    = 0;
    low[n]    = PETSC_MAX_REAL;
    high[n]   = -PETSC_MAX_REAL;
  }
  for (PetscInt k = 0; k < found; k++) {
    const PetscScalar *values;
    PetscScalar        real, imaginary;
    PetscInt           n;

    PetscCall(EPSGetEigenpair(eps, k, &real, &imaginary, x, NULL));
    PetscCall(VecGetArrayRead(x, &values));
    n = DegreeOf(most, values, M);
    PetscCall(VecRestoreArrayRead(x, &values));
    number[n]++;
    sum[n] += PetscRealPart(real);
    low[n]  = PetscMin(low[n], PetscRealPart(real));
    high[n] = PetscMax(high[n], PetscRealPart(real));
  }
  PetscCall(VecDestroy(&x));
  PetscCall(EPSDestroy(&eps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SpectrumModes(Spectrum s)
{
  const PetscInt  most = DEGREES, count = (most + 1) * (most + 1) - 1;
  const Material *m = BodyMaterial(SceneBody(s->cloud->scene, 0));
  PetscReal     **basis, centre[DIM], radius = 0, unit, sum[DEGREES + 1], low[DEGREES + 1], high[DEGREES + 1];
  PetscInt        number[DEGREES + 1];
  Mat             K, M;

  PetscFunctionBegin;
  if (!IsFreeDrop(s)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MeasureDrop(s->cloud, centre, &radius));
  unit = m->tension / (m->density * radius * radius * radius);
  PetscCall(PetscMalloc1(count, &basis));
  PetscCall(HarmonicDisplacements(s, centre, radius, most, basis));
  PetscCall(ProjectOperator(s, count, basis, &K, &M));
  PetscCall(SolveModes(K, M, most, number, sum, low, high));
  PetscCall(PetscPrintf(s->cloud->comm,
                        "  modes of the drop, R = %.4g m = %.3g d0: omega^2 over sigma/(rho R^3) = %.5g 1/s2\n",
                        (double)radius, (double)(radius / s->cloud->domain->spacing), (double)unit));
  for (PetscInt n = 1; n <= HIGHEST; n++)
    PetscCall(PetscPrintf(s->cloud->comm,
                          "    degree %" PetscInt_FMT "  mean %7.3f (theory %3" PetscInt_FMT
                          "), from %7.3f to %7.3f, %" PetscInt_FMT " modes (theory %" PetscInt_FMT ")\n",
                          n, (double)(sum[n] / PetscMax(1, number[n]) / unit), n * (n - 1) * (n + 2),
                          (double)(low[n] / unit), (double)(high[n] / unit), number[n], 2 * n + 1));
  for (PetscInt k = 0; k < count; k++) PetscCall(PetscFree(basis[k]));
  PetscCall(PetscFree(basis));
  PetscCall(MatDestroy(&K));
  PetscCall(MatDestroy(&M));
  PetscFunctionReturn(PETSC_SUCCESS);
}
