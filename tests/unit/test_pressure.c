/* The pressure equation: the assembled matrix is symmetric, positive and the pair sum; null space, empty rows,
   fragments; the first pressure of the rotating square; momentum. Runs on any number of ranks. */
#include "setup.h"
#include "check.h"

#define VECTORS 5
#define DT      1e-3 /* s; what the sources divide by, without meaning here */
#define BODY    "-bodies a -a_density 900 -packing_jitter 0.2 "
/* a film on a floor between a periodic and a symmetry direction; a box with all kinds of corners; liquid next to liquid
 */
#define FILM                                                                                                           \
  "-spacing 1 -box_lower 0,0,0 -box_upper 9,8,20 -box_x periodic -box_y symmetry -box_zmin wall " BODY "-a_upper "     \
  "9,8,6 "
#define CORNER                                                                                                         \
  "-spacing 1 -box_lower 0,0,0 -box_upper 9,8,20 -box_xmin wall -box_xmax symmetry -box_y wall -box_zmin wall " BODY   \
  "-a_upper 9,8,6 "
#define FILM_2D                                                                                                        \
  "-dimension 2 -spacing 1 -box_lower 0,0 -box_upper 22,40 -box_x periodic -box_ymin wall " BODY "-a_upper 22,12 "
#define TANK_2D                                                                                                        \
  "-dimension 2 -spacing 1 -box_lower 0,0 -box_upper 22,40 -box_xmin wall -box_xmax symmetry -box_ymin wall " BODY     \
  "-a_upper 22,12 "
#define DROPS                                                                                                          \
  "-spacing 1 -box_lower -20,-20,-20 -box_upper 20,20,20 -packing_jitter 0.2 -bodies a,b,c,d "                         \
  "-a_shape sphere -a_radius 4 -a_center -9,0,0 -b_shape sphere -b_radius 3 -b_center 9,2,0 -b_density 700 "           \
  "-c_shape sphere -c_radius 0.6 -c_center 0,15,0 -d_shape box -d_lower -3,-12,3 -d_upper 2,-8,8 "
#define TWO                                                                                                            \
  "-spacing 1 -box_lower 0,0,0 -box_upper 9,8,20 -box_x periodic -box_y periodic -box_zmin wall "                      \
  "-packing_jitter 0.2 -bodies a,b -a_upper 9,8,4 -b_lower 0,0,4 -b_upper 9,8,8 -b_density 600 "
#define PERIODIC "-spacing 1 -box_lower 0,0,0 -box_upper 9,8,8 -box_x periodic -box_y periodic -box_z periodic " BODY
#define SHUT     "-spacing 1 -box_lower 0,0,0 -box_upper 9,8,8 -box_x periodic -box_y symmetry -box_z wall " BODY

/* The two sets of types: those of the scheme 'density_invariant' and those of 'consistent'. */
static PetscErrorCode MakePressure(Setup *s, PetscBool paper)
{
  PetscFunctionBegin;
  PetscCall(SetupMoments(s));
  PetscCall(PetscArrayzero(s->cloud->field[FIELD_CAPILLARY], s->cloud->n_owned));
  PetscCall(PetscArrayzero(s->cloud->field[FIELD_CAPILLARY_SLOPE], DIM * s->cloud->n_owned));
  PetscCall(PressureCreate(s->cloud, &s->pressure));
  if (paper)
    PetscCall(PressureSetTypes(s->pressure, SOURCE_DENSITY, CLOSURE_DOUBLED, GRADIENT_SYMMETRIC, PETSC_TRUE));
  else
    PetscCall(PressureSetTypes(s->pressure, SOURCE_DIVERGENCE, CLOSURE_FULL, GRADIENT_SYMMETRIC, PETSC_FALSE));
  PetscCall(PressureSetFromOptions(s->pressure));
  for (PetscInt a = 0; a < s->cloud->n_owned; a++)
    for (PetscInt d = 0; d < DIM; d++) {
      const PetscReal v = RandomUnit(2, (unsigned long long)(DIM * s->cloud->integer[INT_ID][a] + d));

      s->cloud->field[FIELD_VELOCITY_STAR][DIM * a + d] =
        s->cloud->integer[INT_LAYER][a] || d >= s->domain->dim ? 0 : v;
    }
  PetscCall(SetupDivergence(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A vector of random numbers of the particles' ids, between -1 and 1. */
static PetscErrorCode RandomVector(Cloud cloud, PetscInt seed, Vec x)
{
  PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(VecGetArrayWrite(x, &values));
  for (PetscInt a = 0; a < cloud->n_rows; a++)
    values[a] = 2 * RandomUnit((unsigned long long)seed, (unsigned long long)cloud->integer[INT_ID][a]) - 1;
  PetscCall(VecRestoreArrayWrite(x, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* |A - A'|/|A| (Frobenius). */
static PetscErrorCode Asymmetry(Mat A, PetscReal *asymmetry)
{
  Mat       T;
  PetscReal norm;

  PetscFunctionBegin;
  PetscCall(MatTranspose(A, MAT_INITIAL_MATRIX, &T));
  PetscCall(MatAXPY(T, -1, A, DIFFERENT_NONZERO_PATTERN));
  PetscCall(MatNorm(T, NORM_FROBENIUS, asymmetry));
  PetscCall(MatNorm(A, NORM_FROBENIUS, &norm));
  *asymmetry /= norm;
  PetscCall(MatDestroy(&T));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Smallest x.Ax/x.x over rough and smooth vectors, and the largest |A x - pair sum|/|A x|. */
static PetscErrorCode Probe(Setup *s, Mat A, PetscReal *smallest, PetscReal *difference)
{
  Vec x, y, z;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(A, &x, &y));
  PetscCall(VecDuplicate(x, &z));
  *smallest   = PETSC_MAX_REAL;
  *difference = 0;
  for (PetscInt k = 0; k < VECTORS; k++) {
    PetscScalar       *sum;
    const PetscScalar *p;
    PetscReal          product, square, error, norm;

    if (k == 0)
      PetscCall(VecSet(x, 1)); /* the smoothest of all */
    else
      PetscCall(RandomVector(s->cloud, k, x));
    for (PetscInt sweep = 1; sweep < k; sweep++) { /* then smoother ones: x -= A x/(2 of the largest diagonal) */
      PetscReal largest;

      PetscCall(MatGetDiagonal(A, y));
      PetscCall(VecMax(y, NULL, &largest));
      PetscCall(MatMult(A, x, y));
      PetscCall(VecAXPY(x, -0.5 / largest, y));
    }
    PetscCall(MatMult(A, x, y));
    PetscCall(VecDot(x, y, &product));
    PetscCall(VecDot(x, x, &square));
    *smallest = PetscMin(*smallest, product / square);
    PetscCall(VecGetArrayRead(x, &p));
    PetscCall(VecGetArrayWrite(z, &sum));
    PetscCall(PressureMultiply(s->pressure, p, sum));
    PetscCall(VecRestoreArrayWrite(z, &sum));
    PetscCall(VecRestoreArrayRead(x, &p));
    PetscCall(VecNorm(y, NORM_2, &norm));
    PetscCall(VecAXPY(z, -1, y));
    PetscCall(VecNorm(z, NORM_2, &error));
    if (k) *difference = PetscMax(*difference, error / norm);
  }
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y));
  PetscCall(VecDestroy(&z));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestMatrix(const char options[], PetscBool paper, PetscBool closed, const char label[])
{
  PetscReal      asymmetry = 0, smallest = 0, difference = 0;
  PetscInt       iterations;
  PetscBool      null;
  MatNullSpace   space;
  PressureResult result;
  Mat            A;
  Vec            b, x, r;
  PetscScalar   *p;
  PetscReal      residual = 0, norm = 1;
  char           text[1024], name[96];
  Setup          s;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(text, sizeof(text), "%s -ksp_rtol 1e-10", options));
  PetscCall(SetupPack(text, &s));
  PetscCall(MakePressure(&s, paper));
  PetscCall(PressureAssemble(s.pressure, DT, &A, &b));
  PetscCall(Asymmetry(A, &asymmetry));
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_symmetric", label));
  CHECK_CLOSE(asymmetry, 0, 1e-14, name);
  PetscCall(Probe(&s, A, &smallest, &difference));
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_%s", label, closed ? "semidefinite" : "definite"));
  CHECK(closed ? PetscAbsReal(smallest) < 1e-15 : smallest > 1e-6, name); /* A is of order 3/(900 d0^2) */
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_pair_sum", label));
  CHECK_CLOSE(difference, 0, 1e-12, name);
  PetscCall(MatGetNullSpace(A, &space));
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_null_space", label));
  null = PETSC_FALSE;
  if (space) PetscCall(MatNullSpaceTest(space, A, &null));
  CHECK((space != NULL) == closed && null == closed, name);
  /* the solution fulfils the equation, up to what the null space takes from the right-hand side */
  PetscCall(PressureSolve(s.pressure, DT, &result));
  iterations = result.solver.iterations;
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_solved", label));
  CHECK(result.solver.reason > 0 && iterations > 0, name);
  PetscCall(PressureAssemble(s.pressure, DT, &A, &b));
  PetscCall(MatCreateVecs(A, &x, &r));
  PetscCall(VecGetArrayWrite(x, &p));
  PetscCall(PetscArraycpy(p, s.cloud->field[FIELD_PRESSURE], s.cloud->n_rows));
  PetscCall(VecRestoreArrayWrite(x, &p));
  PetscCall(MatGetNullSpace(A, &space));
  if (space) PetscCall(MatNullSpaceRemove(space, b));
  PetscCall(MatMult(A, x, r));
  PetscCall(VecAXPY(r, -1, b));
  PetscCall(VecNorm(r, NORM_2, &residual));
  PetscCall(VecNorm(b, NORM_2, &norm));
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_residual", label));
  CHECK_CLOSE(residual / norm, 0, 1e-9, name);
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&r));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether an image of particle a is its neighbour. */
static PetscBool MeetsItself(Cloud cloud, PetscInt a)
{
  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++)
    if (cloud->integer[INT_ID][cloud->list[k]] == cloud->integer[INT_ID][a]) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* What a closure adds to a row is its sum, A 1: with 'doubled' the pair sum of rows on the surface; with
   'full_diagonal' twice what the diagonal of fluid with lambda < 0.9 lacks of a lattice's, near the surface at
   least 2.5 n.B n; nothing to other rows. Cubic spline, h = 1.3: 3.065/(rho d0^2). */
static PetscErrorCode TestClosure(PetscBool paper, const char label[])
{
  const PetscScalar *sum, *diagonal;
  PetscReal          worst  = 0, diagonal_sum, density_sum;
  PetscInt           closed = 0;
  char               name[96];
  Mat                A;
  Vec                b, x, y;
  Setup              s;

  PetscFunctionBegin;
  PetscCall(SetupPack(FILM, &s));
  PetscCall(MakePressure(&s, paper));
  PressureLattice(s.cloud, &diagonal_sum, &density_sum);
  CHECK_CLOSE(diagonal_sum, 3.065, 2e-3, "lattice_diagonal");
  CHECK_CLOSE(density_sum, 0.99726, 1e-5, "lattice_sum");
  PetscCall(PressureAssemble(s.pressure, DT, &A, &b));
  PetscCall(MatCreateVecs(A, &x, &y));
  PetscCall(VecSet(x, 1));
  PetscCall(MatMult(A, x, y));
  PetscCall(MatGetDiagonal(A, x));
  PetscCall(VecGetArrayRead(x, &diagonal));
  PetscCall(VecGetArrayRead(y, &sum));
  for (PetscInt a = 0; a < s.cloud->n_rows; a++) {
    const PetscReal lattice = diagonal_sum / 900, pairs = diagonal[a] - sum[a];
    const PetscBool fluid = (PetscBool)(a < s.cloud->n_fluid),
                    fill  = (PetscBool)(s.cloud->field[FIELD_LAMBDA][a] < 0.9),
                    near  = (PetscBool)(s.cloud->integer[INT_SURFACE][a] > 0);
    const PetscReal *n    = s.cloud->field[FIELD_NORMAL] + DIM * a;
    PetscReal        Bn[DIM], due = 0;

    TensorApply(s.cloud->field[FIELD_CORRECTION] + 6 * a, n[0], n[1], n[2], Bn);
    if (paper)
      due = s.cloud->integer[INT_SURFACE][a] == 1 ? pairs : 0;
    else if (fluid)
      due = PetscMax(fill ? 2 * PetscMax(0, lattice - pairs) : 0, near ? 2.5 * Dot(n, Bn) / 900 : 0);

    if (pairs < 1e-12 * lattice) continue; /* a dry wall's row is the identity */
    if (MeetsItself(s.cloud, a)) continue; /* beside a mirror: see tests/verify/limits.py */
    worst = PetscMax(worst, PetscAbsReal(sum[a] - due) / lattice);
    closed += due > 0;
  }
  PetscCall(VecRestoreArrayRead(x, &diagonal));
  PetscCall(VecRestoreArrayRead(y, &sum));
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_closure", label));
  CHECK(SetupMax(worst) < 1e-12 && SetupSum((PetscReal)closed) > 50, name);
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A particle out of everyone's sight: its row holds the diagonal alone, its right-hand side and pressure are zero. */
static PetscErrorCode TestIsolated(PetscBool paper, const char label[])
{
  const PetscReal    x[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 9, 0, 0, 0, -9, 0, 1, -9, 0};
  const PetscInt     n = 7, alone = 4;
  PetscReal          other = 0, diagonal = 0, pressure = 0, rhs = 0;
  PetscInt           start;
  PressureResult     result;
  const PetscScalar *values;
  const PetscInt    *columns;
  Mat                A;
  Vec                b;
  char               name[96];
  Setup              s;

  PetscFunctionBegin;
  PetscCall(SetupFill("-spacing 1 -box_lower -20,-20,-20 -box_upper 20,20,20 -bodies a -ksp_rtol 1e-10", n, x, 0, &s));
  PetscCall(MakePressure(&s, paper));
  PetscCall(PressureAssemble(s.pressure, DT, &A, &b));
  PetscCall(MatGetOwnershipRange(A, &start, NULL));
  for (PetscInt a = 0; a < s.cloud->n_rows; a++) {
    PetscInt width;

    if (s.cloud->integer[INT_ID][a] != alone) continue;
    PetscCall(MatGetRow(A, start + a, &width, &columns, &values));
    for (PetscInt k = 0; k < width; k++) {
      if (columns[k] == start + a)
        diagonal = values[k];
      else
        other += PetscAbsReal(values[k]);
    }
    PetscCall(MatRestoreRow(A, start + a, &width, &columns, &values));
    PetscCall(VecGetArrayRead(b, &values));
    rhs = PetscAbsReal(values[a]);
    PetscCall(VecRestoreArrayRead(b, &values));
  }
  PetscCall(PressureSolve(s.pressure, DT, &result));
  for (PetscInt a = 0; a < s.cloud->n_rows; a++)
    if (s.cloud->integer[INT_ID][a] == alone) pressure = PetscAbsReal(s.cloud->field[FIELD_PRESSURE][a]);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_isolated_row", label));
  CHECK(SetupMax(other) == 0 && SetupMax(diagonal) > 0 && SetupMax(diagonal) <= 1, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_isolated_pressure", label));
  CHECK(result.solver.reason > 0 && SetupMax(rhs) == 0 && SetupMax(pressure) == 0, name);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Symmetric and conserved gradients of any pressure leave momentum and angular momentum of a liquid without outside
   alone; both liquids' densities count. */
static PetscErrorCode TestMomentum(PetscBool paper, const char gradient[], const char label[])
{
  PetscReal  total[2 * DIM] = {0}, size = 0;
  char       name[96];
  Cloud      cloud;
  PetscReal *acceleration;
  Setup      s;

  PetscFunctionBegin;
  PetscCall(SetupPack("-spacing 1 -box_lower -9,-9,-9 -box_upper 9,9,9 -packing_jitter 0.2 -bodies a,b "
                      "-a_upper 9,9,0 -b_lower -9,-9,0 -b_density 600",
                      &s));
  PetscCall(MakePressure(&s, paper));
  if (!paper) PetscCall(PressureSetTypes(s.pressure, SOURCE_DIVERGENCE, CLOSURE_FULL, gradient, PETSC_FALSE));
  cloud = s.cloud;
  for (PetscInt a = 0; a < cloud->n_owned; a++)
    cloud->field[FIELD_PRESSURE][a] = 1e3 * RandomUnit(4, (unsigned long long)cloud->integer[INT_ID][a]);
  PetscCall(CloudUpdate(cloud, FIELD_PRESSURE));
  PetscCall(CloudGetWork(cloud, DIM, &acceleration));
  PetscCall(PressureAcceleration(s.pressure, acceleration));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *f = acceleration + DIM * a, mass = cloud->volume[a] * cloud->rest_density[a];

    for (PetscInt d = 0; d < DIM; d++) {
      const PetscReal *r = cloud->field[FIELD_POSITION] + DIM * a;

      total[d] += mass * f[d];
      total[DIM + d] += mass * (r[(d + 1) % DIM] * f[(d + 2) % DIM] - r[(d + 2) % DIM] * f[(d + 1) % DIM]) / 9;
    }
    size += mass * Norm(f);
  }
  for (PetscInt i = 0; i < 2 * DIM; i++) total[i] = SetupSum(total[i]);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_gradient_conserves_momentum", label));
  CHECK_CLOSE(Norm(total) / SetupSum(size), 0, 1e-12, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_gradient_conserves_angular_momentum", label));
  CHECK_CLOSE(Norm(total + DIM) / SetupSum(size), 0, 1e-12, name);
  PetscCall(CloudRestoreWork(cloud, &acceleration));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rotating square, side 1, w = 1, density 1000: v of the start at positions a moment later has the divergence 2 w^2 dt,
   so the pressure is that of lap p = 2 rho w^2, p = 0 on the edge (Colagrossi 2005; Le Touze et al. 2013): -0.147343
   rho w^2 L^2 in the middle. */
static PetscErrorCode TestRotatingSquare(PetscInt side, const char closure[], PetscReal tol, PetscReal *ratio)
{
  const PetscReal spacing = 1. / side, dt = 1e-4;
  PetscReal       middle = 0, count = 0, largest = -PETSC_MAX_REAL, nearest;
  PressureResult  result;
  char            options[512], name[96];
  Cloud           cloud;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof(options),
                          "-dimension 2 -spacing %.17g -box_lower -1,-1 -box_upper 1,1 -bodies a -a_lower -0.5,-0.5 "
                          "-a_upper 0.5,0.5 -a_velocity_type rotation -a_rotation_rate -1 -packing_jitter 0 "
                          "-pressure_relaxation_time 1e30 -ksp_rtol 1e-10 -pressure_closure %s",
                          (double)spacing, closure));
  PetscCall(SetupPack(options, &s));
  cloud = s.cloud;
  for (PetscInt k = 0; k < DIM * cloud->n_owned; k++)
    cloud->field[FIELD_POSITION][k] += dt * cloud->field[FIELD_VELOCITY][k];
  PetscCall(CloudMoved(cloud));
  PetscCall(CloudSearch(cloud, NULL, NULL));
  PetscCall(MakePressure(&s, PETSC_FALSE));
  PetscCall(PetscArraycpy(cloud->field[FIELD_VELOCITY_STAR], cloud->field[FIELD_VELOCITY], DIM * cloud->n_total));
  PetscCall(SetupDivergence(&s));
  PetscCall(PressureSolve(s.pressure, dt, &result));
  nearest = 1.1 * PETSC_SQRT2 / 2 * spacing; /* the four around the middle */
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    if (Norm(cloud->field[FIELD_POSITION] + DIM * a) < nearest) {
      middle += cloud->field[FIELD_PRESSURE][a];
      count += 1;
    }
    largest = PetscMax(largest, cloud->field[FIELD_PRESSURE][a]);
  }
  middle = SetupSum(middle) / SetupSum(count) / 1000;
  *ratio = middle / -0.147343;
  PetscCall(PetscSNPrintf(name, sizeof(name), "rotating_square_%d_%s", (int)side, closure));
  CHECK_CLOSE(*ratio, 1, tol, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "rotating_square_%d_%s_suction", (int)side, closure));
  CHECK(result.solver.reason > 0 && SetupMax(largest) < 0, name);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscReal coarse, fine;

  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  for (PetscInt paper = 0; paper < 2; paper++) {
    const PetscBool   p    = (PetscBool)paper;
    const char *const name = paper ? "paper" : "consistent";
    const struct {
      const char *options, *label;
      PetscBool   closed;
    } box[] = {{FILM, "film", PETSC_FALSE},        {CORNER, "corner", PETSC_FALSE}, {FILM_2D, "film_2d", PETSC_FALSE},
               {TANK_2D, "tank_2d", PETSC_FALSE},  {DROPS, "drops", PETSC_FALSE},   {TWO, "two_liquids", PETSC_FALSE},
               {PERIODIC, "periodic", PETSC_TRUE}, {SHUT, "shut_box", PETSC_TRUE}};

    for (size_t k = 0; k < sizeof(box) / sizeof(*box); k++) {
      char label[64];

      PetscCall(PetscSNPrintf(label, sizeof(label), "%s_%s", name, box[k].label));
      PetscCall(TestMatrix(box[k].options, p, box[k].closed, label));
    }
    PetscCall(TestClosure(p, name));
    PetscCall(TestIsolated(p, name));
    PetscCall(TestMomentum(p, GRADIENT_SYMMETRIC, name));
  }
  PetscCall(TestMomentum(PETSC_FALSE, GRADIENT_CONSERVED, "conserved"));
  PetscCall(TestRotatingSquare(40, "full_diagonal", 0.03, &coarse));
  PetscCall(TestRotatingSquare(60, "full_diagonal", 0.02, &fine));
  CHECK_CLOSE(3 * fine - 2 * coarse, 1, 0.01, "rotating_square_limit"); /* of an error that falls with the spacing */
  PetscCall(TestRotatingSquare(60, "doubled", 0.03, &fine));
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
