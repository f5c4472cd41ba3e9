/* Particles of different sizes (-spacing_coarse): the pairs against all pairs, the sums against fields with known
   answers, the symmetry of the pressure operator, the volumes of the packing, and what is refused. Lengths in fine
   spacings. Runs on any number of ranks. */
#include "../../src/emitters/emitters_impl.h"
#include "../../src/neighbors/pairs.h"
#include "../../src/resampling/resampling_impl.h"
#include "setup.h"
#include "refuse.h"

#define FLAT                                                                                                           \
  "-dimension 2 -spacing 1 -spacing_coarse 2 -box_lower -24,0 -box_upper 24,20 -box_x symmetry -box_ymin wall "        \
  "-bodies film -film_lower -24,0 -film_upper 24,16 -fine core -core_lower -4,10 -core_upper 4,20 -tension_type none "
#define DEEP                                                                                                           \
  "-spacing 1 -spacing_coarse 2.5 -spacing_growth 0.2 -box_lower 0,0,0 -box_upper 10,10,20 -box_x periodic "           \
  "-box_y symmetry -box_zmin wall -bodies film -film_upper 10,10,15 -fine core -core_shape sphere -core_radius 2 "     \
  "-core_center 5,5,15 -tension_type none "
#define STEEP                                                                                                          \
  "-spacing 1 -spacing_coarse 4 -spacing_growth 0.2 -box_lower 0,0,0 -box_upper 20,20,20 -box_x symmetry "             \
  "-box_y symmetry -box_zmin wall -bodies film -film_upper 20,20,16 -fine core -core_shape sphere -core_radius 2 "     \
  "-core_center 0,0,16 -tension_type none "
#define STEEPEST                                                                                                       \
  "-spacing 1 -spacing_coarse 8 -spacing_growth 0.15 -box_lower 0,0,0 -box_upper 48,48,48 -box_x symmetry "            \
  "-box_y symmetry -box_zmin wall -bodies film -film_upper 48,48,40 -fine core -core_shape sphere -core_radius 2 "     \
  "-core_center 0,0,40 -tension_type none "
/* rings: a tank, and a drop that is fine above and coarse below */
#define ROUND                                                                                                          \
  "-dimension axisymmetric -spacing 1 -spacing_coarse 3 -spacing_growth 0.2 -box_lower 0,0 -box_upper 30,30 "          \
  "-box_xmax wall -box_ymin wall -bodies film -film_upper 30,24 -fine core -core_shape sphere -core_radius 4 "         \
  "-core_center 0,24 -packing_jitter 0 -tension_type none "
#define FLAT_DROP                                                                                                      \
  "-dimension 2 -spacing 1 -spacing_coarse 2 -spacing_growth 0.2 -box_lower -50,-50 -box_upper 50,50 -bodies a "       \
  "-a_shape sphere -a_radius 40 -a_center 0,0 -a_tension 1 -fine c -c_lower 4,-50 -c_upper 50,50 "
#define ROUND_DROP                                                                                                     \
  "-dimension axisymmetric -spacing 1 -spacing_coarse 2 -spacing_growth 0.2 -box_lower 0,-50 -box_upper 50,50 "        \
  "-bodies a -a_shape sphere -a_radius 40 -a_center 0,0 -a_tension 1 -fine c -c_lower 0,4 -c_upper 50,50 "
#define SOLID      "-core_lower -8,5 -core_upper 8,20 -solids b -b_shape sphere -b_radius 2 -b_center 0,11 "
#define NEAR_LIMIT 1e-5 /* of the support: pairs so close to it may be on either side in single precision */

/* The pairs of a row that should be there and are not, or are there and should not. */
static PetscInt WrongPairs(Cloud cloud, PetscInt a)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], support = KernelSupport(cloud->kernel);
  PetscInt         found = 0, wrong = 0;

  for (PetscInt b = 0; b < cloud->n_total; b++) {
    const PetscReal r[DIM] = {x[3 * a] - x[3 * b], x[3 * a + 1] - x[3 * b + 1], x[3 * a + 2] - x[3 * b + 2]},
                    reach = support * 0.5 * (cloud->size[a] + cloud->size[b]), excess = Norm(r) / reach - 1;
    PetscBool there = PETSC_FALSE;

    if (excess > 1 || b == a) continue;
    for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) there = there || cloud->list[k] == b;
    found += there;
    wrong += PetscAbsReal(excess) > NEAR_LIMIT && there != (excess < 0);
  }
  return wrong + (found != cloud->first[a + 1] - cloud->first[a]);
}

/* The pairs of an owned particle and one at y of this size that are within the cloud's reach of the larger one. */
static PetscReal PairsWith(Cloud cloud, const PetscReal y[DIM], PetscReal size)
{
  const PetscReal *x     = cloud->field[FIELD_POSITION];
  PetscReal        count = 0;

  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    const PetscReal r[DIM] = {x[3 * a] - y[0], x[3 * a + 1] - y[1], x[3 * a + 2] - y[2]};

    count += Norm(r) < cloud->reach * PetscMax(size, cloud->size[a]);
  }
  return count;
}

/* What happens to a coordinate in the images along one direction: x' = sign x + offset. Returns how many there are. */
static PetscInt Images(Domain domain, PetscInt d, PetscReal sign[3], PetscReal offset[3])
{
  const PetscReal length = domain->upper[d] - domain->lower[d];
  PetscInt        n      = 1;

  sign[0]   = 1;
  offset[0] = 0;
  for (PetscInt side = 0; side < 2; side++) {
    const FaceType face = domain->face[d][side];

    if (face != FACE_PERIODIC && face != FACE_SYMMETRY) continue;
    sign[n]     = face == FACE_PERIODIC ? 1 : -1;
    offset[n++] = face == FACE_PERIODIC ? (side ? length : -length) : 2 * (side ? domain->upper[d] : domain->lower[d]);
  }
  return n;
}

/* The pairs within reach that the ghosts lack: among the particles of all ranks and their images less those here. */
static PetscErrorCode MissingPairs(Cloud cloud, PetscReal *missing)
{
  PetscMPIInt ranks, n = (PetscMPIInt)(4 * cloud->n_owned), *count, *from, total = 0;
  PetscReal  *own, *all;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  PetscCall(PetscMalloc3(ranks, &count, ranks, &from, n, &own));
  PetscCallMPI(MPI_Allgather(&n, 1, MPI_INT, count, 1, MPI_INT, PETSC_COMM_WORLD));
  for (PetscMPIInt r = 0; r < ranks; total += count[r++]) from[r] = total;
  PetscCall(PetscMalloc1(total, &all));
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    for (PetscInt d = 0; d < DIM; d++) own[4 * a + d] = cloud->field[FIELD_POSITION][DIM * a + d];
    own[4 * a + 3] = cloud->size[a];
  }
  PetscCallMPI(MPI_Allgatherv(own, n, MPIU_REAL, all, count, from, MPIU_REAL, PETSC_COMM_WORLD));
  *missing = 0;
  for (PetscInt b = 0; b < total / 4; b++) {
    PetscReal sign[DIM][3], offset[DIM][3], y[DIM];
    PetscInt  kinds[DIM];

    for (PetscInt d = 0; d < DIM; d++) kinds[d] = Images(cloud->domain, d, sign[d], offset[d]);
    for (PetscInt k = 0; k < kinds[0] * kinds[1] * kinds[2]; k++) {
      const PetscInt kind[DIM] = {k % kinds[0], k / kinds[0] % kinds[1], k / kinds[0] / kinds[1]};

      for (PetscInt d = 0; d < DIM; d++) y[d] = sign[d][kind[d]] * all[4 * b + d] + offset[d][kind[d]];
      *missing += PairsWith(cloud, y, all[4 * b + 3]);
    }
  }
  for (PetscInt b = 0; b < cloud->n_total; b++)
    *missing -= PairsWith(cloud, cloud->field[FIELD_POSITION] + DIM * b, cloud->size[b]);
  PetscCall(PetscFree3(count, from, own));
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The distance of particle a to its nearest neighbour, over the mean size of both. */
static PetscReal Nearest(Cloud cloud, PetscInt a)
{
  const PetscReal *x    = cloud->field[FIELD_POSITION];
  PetscReal        near = PETSC_MAX_REAL;

  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    const PetscInt  b      = cloud->list[k];
    const PetscReal r[DIM] = {x[3 * a] - x[3 * b], x[3 * a + 1] - x[3 * b + 1], x[3 * a + 2] - x[3 * b + 2]};

    near = PetscMin(near, Norm(r) / CloudPairSize(cloud, a, b));
  }
  return near;
}

/* Largest error of the corrected divergence of v = A x, over |A|, of particles away from walls and images. */
static PetscErrorCode LinearDivergence(Setup *s, PetscReal *worst)
{
  const Cloud     cloud       = s->cloud;
  const PetscReal A[DIM][DIM] = {{0.3, -1.2, 0.4}, {0.7, 0.5, -0.2}, {-0.6, 0.1, 0.9}};
  const PetscInt  dim         = s->domain->dim;
  PetscReal       trace       = 0;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < dim; d++) trace += A[d][d];
  if (s->domain->rings) trace += A[0][0];
  for (PetscInt a = 0; a < cloud->n_total; a++)
    for (PetscInt i = 0; i < DIM; i++) {
      PetscReal sum = 0;

      for (PetscInt j = 0; j < dim; j++)
        if (!s->domain->rings || i == j) sum += A[i][j] * cloud->field[FIELD_POSITION][DIM * a + j];
      cloud->field[FIELD_VELOCITY_STAR][DIM * a + i] = i < dim ? sum : 0;
    }
  PetscCall(OperatorsDivergence(cloud, cloud->field[FIELD_VELOCITY_STAR], PETSC_TRUE, 0, cloud->field[FIELD_DIVERGENCE],
                                NULL, NULL));
  *worst = 0;
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    if (!OperatorsNearWall(cloud, cloud->field[FIELD_POSITION] + DIM * a) && cloud->field[FIELD_LAMBDA][a] > 0.5)
      *worst = PetscMax(*worst, PetscAbsReal(cloud->field[FIELD_DIVERGENCE][a] - trace));
  *worst = SetupMax(*worst);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x.A y - y.A x over |x||A y|, and the largest |A 1| of rows that the surface does not close, over the diagonal. */
static PetscErrorCode Symmetry(Setup *s, PetscReal *asymmetry, PetscReal *constant)
{
  Mat                A;
  Vec                b, x, y, Ax, Ay;
  PetscRandom        random;
  PetscScalar        one, other;
  PetscReal          size[2];
  const PetscScalar *value;

  PetscFunctionBegin;
  PetscCall(PressureCreate(s->cloud, &s->pressure));
  PetscCall(PressureSetFromOptions(s->pressure));
  PetscCall(PressureAssemble(s->pressure, 1e-3, &A, &b));
  PetscCall(MatCreateVecs(A, &x, &Ax));
  PetscCall(MatCreateVecs(A, &y, &Ay));
  PetscCall(PetscRandomCreate(PETSC_COMM_WORLD, &random));
  PetscCall(VecSetRandom(x, random));
  PetscCall(VecSetRandom(y, random));
  PetscCall(MatMult(A, x, Ax));
  PetscCall(MatMult(A, y, Ay));
  PetscCall(VecDot(Ax, y, &one));
  PetscCall(VecDot(Ay, x, &other));
  PetscCall(VecNorm(Ax, NORM_2, &size[0]));
  PetscCall(VecNorm(y, NORM_2, &size[1]));
  *asymmetry = PetscAbsScalar(one - other) / (size[0] * size[1]);
  PetscCall(VecSet(x, 1));
  PetscCall(MatMult(A, x, Ax));
  PetscCall(MatGetDiagonal(A, y));
  PetscCall(VecPointwiseDivide(Ay, Ax, y));
  PetscCall(VecGetArrayRead(Ay, &value));
  *constant = 0;
  for (PetscInt a = 0; a < s->cloud->n_fluid; a++)
    if (s->cloud->field[FIELD_LAMBDA][a] > 0.95 && !s->cloud->integer[INT_SURFACE][a])
      *constant = PetscMax(*constant, PetscAbsScalar(value[a]));
  *constant = SetupMax(*constant);
  PetscCall(VecRestoreArrayRead(Ay, &value));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y));
  PetscCall(VecDestroy(&Ax));
  PetscCall(VecDestroy(&Ay));
  PetscCall(PetscRandomDestroy(&random));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What one scene must be like, whose bodies have this volume. */
static PetscErrorCode TestScene(const char options[], PetscReal volume)
{
  Setup     s;
  Cloud     cloud;
  PetscReal sum = 0, squares = 0, inside = 0, sizes[2] = {PETSC_MAX_REAL, 0}, worst = 0, asymmetry = 0, constant = 0,
            wrong = 0, near = 0, nearest = 0, close = 0, count = 0, missing = 0;

  PetscFunctionBegin;
  PetscCall(SetupPack(options, &s));
  cloud = s.cloud;
  PetscCall(SetupMoments(&s));
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    const PetscReal wanted = SceneSpacing(s.scene, cloud->field[FIELD_POSITION] + DIM * a), size = cloud->size[a];

    wrong += WrongPairs(cloud, a);
    if (a >= cloud->n_fluid) continue;
    nearest += Nearest(cloud, a);
    close += Nearest(cloud, a) < 0.6;
    count++;
    sum += cloud->volume[a];
    sizes[0] = PetscMin(sizes[0], size);
    sizes[1] = PetscMax(sizes[1], size);
    near     = PetscMax(near, PetscAbsReal(size / wanted - 1));
    if (cloud->field[FIELD_LAMBDA][a] < 0.95 || cloud->integer[INT_SURFACE][a]) continue;
    inside++;
    squares += PetscSqr(cloud->field[FIELD_DENSITY][a] / cloud->rest_density[a] - 1);
  }
  CHECK_CLOSE(SetupSum(wrong), 0, 0, "pairs within the support of their mean smoothing length");
  PetscCall(MissingPairs(cloud, &missing));
  CHECK_CLOSE(SetupSum(PetscAbsReal(missing)), 0, 0, "all within reach of the larger one of a pair are there");
  CHECK_CLOSE(SetupSum(sum), volume, 1e-9 * volume, "the particles share the volume of the body");
  CHECK_CLOSE(-SetupMax(-sizes[0]), 1, 1e-9, "the finest have the spacing");
  CHECK(SetupMax(sizes[1]) < DomainSizeMax(s.domain), "the largest are not larger than allowed");
  CHECK(SetupMax(sizes[1]) > 1.5, "there are large ones");
  count = SetupSum(count);
  CHECK(SetupSum(nearest) / count > 0.92, "distance to the nearest particle or image, in the mean");
  CHECK_CLOSE(SetupSum(close) / count, 0, 0.01, "share of particles too close to another or to an image");
  CHECK(SetupMax(near) < 0.25, "sizes near what is wanted where they are");
  CHECK(PetscSqrtReal(SetupSum(squares) / SetupSum(inside)) < 0.03, "density inside");
  PetscCall(LinearDivergence(&s, &worst));
  CHECK_CLOSE(worst, 0, 2e-5, "corrected divergence of a linear velocity");
  PetscCall(Symmetry(&s, &asymmetry, &constant));
  CHECK_CLOSE(asymmetry, 0, 1e-12, "the pressure operator is symmetric");
  CHECK_CLOSE(constant, 0, 1e-12, "a constant pressure gives nothing inside");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Two particles of sizes 1 and 2 at a distance of 1.5: every factor of the pair from the kernel of their mean. */
static PetscErrorCode TestPair(void)
{
  const PetscReal x[2 * DIM] = {0, 0, 0, 1.5, 0, 0}, r2 = 1, h = 1.3;
  const char      options[] = "-spacing 1 -spacing_coarse 2 -box_lower -10,-10,-10 -box_upper 10,10,10 -bodies a "
                              "-fine core -core_shape sphere -core_radius 1 ";
  Setup           s;
  ParticleArrays  arrays;
  PetscReal       W, F, scale_w, scale_f, inverse_h2, ratio;
  PairRow         row;

  PetscFunctionBegin;
  PetscCall(SetupOpen(options, &s));
  PetscCall(ParticlesAppend(s.particles, 2));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  PetscCall(PetscArraycpy(arrays.real[FIELD_POSITION], x, 2 * DIM));
  for (PetscInt a = 0; a < 2; a++) {
    arrays.integer[INT_ID][a] = arrays.integer[INT_PARENT][a] = a;
    arrays.real[FIELD_VOLUME][a]                              = a ? 8 : 1;
  }
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(CloudResync(s.cloud));
  PetscCall(OperatorsMoments(s.cloud, NULL));
  KernelEvaluate(s.kernel, 1, &r2, &W, &F); /* at r = h_ab/h: W and F of the pair are W/1.5^3, F/1.5^5 */
  W /= 1.5 * 1.5 * 1.5;
  F /= 1.5 * 1.5 * 1.5 * 1.5 * 1.5;
  KernelScales(s.kernel, &scale_w, &scale_f, &inverse_h2);
  for (PetscInt a = 0; a < 2; a++) {
    const PetscReal other = a ? 1 : 8, eta = ETA_OVER_H * 1.5 * h;

    CHECK_CLOSE(s.cloud->first[a + 1] - s.cloud->first[a], 1, 0, "the pair is in both rows");
    CHECK_CLOSE(s.cloud->slope[a] * scale_f, other * F, 5e-7, "F of the pair times V_b");
    CHECK_CLOSE(s.cloud->field[FIELD_DENSITY][a], 1000 * (KernelSelf(s.kernel) + other * W), 1e-3,
                "density: V_a W(0) is the same for all sizes");
    PairRowLoadGeometry(s.cloud, s.cloud->field[FIELD_POSITION], a, &row);
    PairRowEvaluate(s.cloud, a, &row);
    PairRowGradient(s.cloud, a, &row);
    CHECK_CLOSE(row.W[0] / W, 1, 1e-9, "W of the pair from its distance");
    CHECK_CLOSE(row.F[0] / F, 1, 1e-6, "F of the pair from its distance");
    ratio = s.cloud->laplacian[a] * s.cloud->laplacian_unit * scale_f / (8 * -F * 2.25 / (2.25 + eta * eta));
    CHECK_CLOSE(PetscAbsReal(ratio), 1, 1e-3, "the pair's part in a Laplacian times V_a V_b");
  }
  CHECK_CLOSE(s.cloud->laplacian[0], s.cloud->laplacian[1], 0, "which is the same for both");
  for (PetscInt a = 0; a < 2; a++) s.cloud->field[FIELD_VELOCITY][DIM * a] = a;
  PetscCall(PetscArrayzero(s.cloud->field[FIELD_ACCELERATION], DIM * s.cloud->n_owned));
  PetscCall(OperatorsViscosity(s.cloud, &(Viscosity){.form = VISCOSITY_MOMENT}, s.cloud->rest_density));
  PetscCall(SetupTakenAlong(s.cloud, &(Viscosity){.form = VISCOSITY_MOMENT}, &ratio));
  CHECK_CLOSE(ratio, 0, 1e-6, "the viscosity of the pair taken along");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A fine particle between those of a coarse lattice lacks no neighbours: its row is not closed as if it did. The
   closure of all rows, over the rest of the diagonal. */
static PetscErrorCode TestClosure(void)
{
  const PetscInt n     = 9;
  const char options[] = "-spacing 1 -spacing_coarse 3 -box_lower -15,-15,-15 -box_upper 15,15,15 -bodies a -fine core "
                         "-core_shape sphere -core_radius 1 -tension_type none ";
  Setup      s;
  ParticleArrays arrays;
  Mat            A;
  Vec            b, sum, diagonal;
  PetscReal      closed = -1;

  PetscFunctionBegin;
  PetscCall(SetupOpen(options, &s));
  PetscCall(ParticlesAppend(s.particles, n * n * n + 1));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscInt place[DIM] = {a % n - n / 2, a / n % n - n / 2, a / (n * n) - n / 2};

    for (PetscInt d = 0; d < DIM; d++) arrays.real[FIELD_POSITION][DIM * a + d] = a < n * n * n ? 3 * place[d] : 1.5;
    arrays.integer[INT_ID][a] = arrays.integer[INT_PARENT][a] = a;
    arrays.real[FIELD_VOLUME][a]                              = a < n * n * n ? 27 : 1;
  }
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(CloudResync(s.cloud));
  PetscCall(SetupMoments(&s));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) s.cloud->field[FIELD_LAMBDA][a] = 0.5;
  PetscCall(PressureCreate(s.cloud, &s.pressure));
  PetscCall(PressureSetFromOptions(s.pressure));
  PetscCall(PressureAssemble(s.pressure, 1e-3, &A, &b));
  PetscCall(MatCreateVecs(A, &sum, &diagonal));
  PetscCall(VecSet(diagonal, 1));
  PetscCall(MatMult(A, diagonal, sum));
  PetscCall(MatGetDiagonal(A, diagonal));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    const PetscScalar *part, *whole;

    if (s.cloud->size[a] > 2) continue;
    PetscCall(VecGetArrayRead(sum, &part));
    PetscCall(VecGetArrayRead(diagonal, &whole));
    closed = PetscRealPart(part[a] / (whole[a] - part[a]));
    PetscCall(VecRestoreArrayRead(sum, &part));
    PetscCall(VecRestoreArrayRead(diagonal, &whole));
  }
  CHECK_CLOSE(closed, 0, 0.2, "a fine particle among coarse ones is not closed like one of the surface");
  PetscCall(VecDestroy(&sum));
  PetscCall(VecDestroy(&diagonal));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The pressure of surface tension of a drop of radius 40 whose particles are fine on one side and coarse on the other.
 */
static PetscErrorCode TestTension(const char options[], PetscReal pressure)
{
  Setup     s;
  PetscReal sum[2] = {0, 0}, count[2] = {0, 0};

  PetscFunctionBegin;
  PetscCall(SetupPack(options, &s));
  PetscCall(SetupMoments(&s));
  PetscCall(PetscArrayzero(s.cloud->field[FIELD_ACCELERATION], DIM * s.cloud->n_owned));
  PetscCall(TensionApply(s.tension, s.cloud));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    const PetscInt coarse = s.cloud->size[a] > 1.5 ? 1 : 0;

    if (s.cloud->integer[INT_SURFACE][a] != 1) continue;
    sum[coarse] += s.cloud->volume[a] * s.cloud->field[FIELD_CAPILLARY][a] / pressure;
    count[coarse] += s.cloud->volume[a];
  }
  CHECK_CLOSE(SetupSum(sum[0]) / SetupSum(count[0]), 1, 0.1, "surface tension where a drop is fine");
  CHECK_CLOSE(SetupSum(sum[1]) / SetupSum(count[1]), 1, 0.1,
              "surface tension where it is coarse"); /* a lattice, not at rest: 1.06 for one size */
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A flat sheet of one layer of particles, fine on one side and coarse on the other: each edge is pulled by 2 sigma, and
   the forces between the sizes add up to none. */
static PetscErrorCode TestSheet(void)
{
  const PetscReal L    = 16;
  PetscReal       left = 0, right = 0, sum[DIM] = {0, 0, 0};
  Setup           s;
  ParticleArrays  arrays;
  PetscMPIInt     rank;

  PetscFunctionBegin;
  PetscCall(SetupOpen("-spacing 1 -spacing_coarse 2 -box_lower -30,0,-15 -box_upper 30,16,15 -box_y periodic -bodies a "
                      "-a_tension 1 -a_density 1 -fine c -c_lower -30,0,-15 -c_upper 0,16,15 ",
                      &s));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(ParticlesAppend(s.particles, rank ? 0 : 16 * 16 + 8 * 8));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscInt fine = a < 16 * 16, k = fine ? a : a - 16 * 16, width = fine ? 16 : 8, size = fine ? 1 : 2;
    PetscReal     *x = arrays.real[FIELD_POSITION] + DIM * a;

    x[0] = (fine ? -1 : 1) * (k / width + 0.5) * size;
    x[1] = (k % width + 0.5) * size;
    x[2] = 0;

    arrays.real[FIELD_VOLUME][a] = size * size * size;
    arrays.integer[INT_ID][a] = arrays.integer[INT_PARENT][a] = a;
  }
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(CloudResync(s.cloud));
  PetscCall(SetupMoments(&s));
  PetscCall(PetscArrayzero(s.cloud->field[FIELD_ACCELERATION], DIM * s.cloud->n_owned));
  PetscCall(TensionApply(s.tension, s.cloud));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    const PetscReal *force = s.cloud->field[FIELD_ACCELERATION] + DIM * a, x = s.cloud->field[FIELD_POSITION][DIM * a];

    for (PetscInt d = 0; d < DIM; d++) sum[d] += s.cloud->volume[a] * force[d];
    if (x < -8) left += s.cloud->volume[a] * force[0];
    if (x > 8) right += s.cloud->volume[a] * force[0];
  }
  CHECK_CLOSE(SetupSum(left), 2 * L, 0.1 * 2 * L, "the pull of a sheet's edge where it is fine");
  CHECK_CLOSE(SetupSum(right), -2 * L, 0.1 * 2 * L, "the pull of its edge where it is coarse");
  for (PetscInt d = 0; d < DIM; d++) CHECK_CLOSE(SetupSum(sum[d]), 0, 1e-4 * L, "no force on the whole sheet");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where the surface is fine on one side and coarse on the other, the ranks share its particles too, of which coarse
   ones, for their more neighbours, count twice. */
static PetscErrorCode TestBalance(void)
{
  Setup       s;
  PetscInt    lost = 0;
  PetscReal   work = 0;
  PetscMPIInt ranks;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  PetscCall(SetupPack(STEEP "-box_upper 40,40,20 -film_upper 40,40,16 -core_radius 6 ", &s));
  PetscCall(SetupMoments(&s));
  PetscCall(CloudCommit(s.cloud, &lost, NULL));
  PetscCall(ParticlesBalanceSurface(s.particles, PETSC_TRUE));
  PetscCall(CloudResync(s.cloud));
  for (PetscInt a = 0; a < s.cloud->n_owned; a++)
    if (s.cloud->integer[INT_SURFACE][a]) work += s.cloud->size[a] > 1.001 ? 2 : 1;
  CHECK(SetupMax(work) < 1.3 * SetupSum(work) / ranks, "the ranks share the work at the surface");
  CHECK(SetupMax((PetscReal)s.cloud->n_owned) < 1.2 * SetupSum((PetscReal)s.cloud->n_owned) / ranks,
        "and the particles");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The least and the largest share of the liquid, and the sum of its volumes times height and 1. */
static void SumRings(Cloud cloud, PetscReal share[2], PetscReal sum[2])
{
  share[0] = PETSC_MAX_REAL;
  share[1] = sum[0] = sum[1] = 0;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    share[0] = PetscMin(share[0], ResamplingArea(cloud, a));
    share[1] = PetscMax(share[1], ResamplingArea(cloud, a));
    sum[0] += cloud->volume[a] * cloud->field[FIELD_POSITION][DIM * a + 1];
    sum[1] += cloud->volume[a];
  }
  share[0] = -SetupMax(-share[0]);
  share[1] = SetupMax(share[1]);
  for (PetscInt k = 0; k < 2; k++) sum[k] = SetupSum(sum[k]);
}

/* The mean of the pressure operator's Laplacian of z2, which is 2, over the rings inside, by volume. */
static PetscErrorCode MeanLaplacian(Setup *s, PetscReal *mean)
{
  const Cloud cloud  = s->cloud;
  PetscReal   sum[2] = {0, 0}, *p, *y;
  Mat         A;
  Vec         b;

  PetscFunctionBegin;
  PetscCall(PressureCreate(cloud, &s->pressure));
  PetscCall(PressureSetFromOptions(s->pressure));
  PetscCall(PressureAssemble(s->pressure, 1e-3, &A, &b));
  PetscCall(PetscMalloc2(cloud->n_rows, &p, cloud->n_rows, &y));
  for (PetscInt a = 0; a < cloud->n_rows; a++) p[a] = PetscSqr(cloud->field[FIELD_POSITION][DIM * a + 1]);
  PetscCall(PressureMultiply(s->pressure, p, y));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    if (cloud->field[FIELD_LAMBDA][a] < 0.95 || OperatorsNearWall(cloud, cloud->field[FIELD_POSITION] + DIM * a))
      continue;
    sum[0] -= y[a] * cloud->rest_density[a];
    sum[1] += cloud->volume[a];
  }
  *mean = SetupSum(sum[0]) / SetupSum(sum[1]);
  PetscCall(PetscFree2(p, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rings have areas about the squares of their sizes, walls and images too. Where every third is made thin and every
   seventh fat, joining and splitting bring the areas back to that and keep volume and height. */
static PetscErrorCode TestRings(void)
{
  Setup            s;
  ParticleArrays   arrays;
  ResamplingReport report;
  PetscReal        share[2], before[2], after[2], first = 0, error = 0, mean = 0;

  PetscFunctionBegin;
  PetscCall(SetupPack(ROUND, &s));
  for (PetscInt a = 0; a < s.cloud->n_total; a++)
    error = PetscMax(error, PetscAbsReal(s.cloud->weight[a] / PetscSqr(s.cloud->size[a]) - 1));
  CHECK_CLOSE(SetupMax(error), 0, 0.2, "areas of graded rings");
  PetscCall(SetupMoments(&s));
  PetscCall(MeanLaplacian(&s, &mean));
  CHECK_CLOSE(mean, 2, 0.05, "Laplacian of graded rings"); /* 1.98: the spacing grows fast */
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscInt id = arrays.integer[INT_ID][a];

    if (arrays.integer[INT_LAYER][a] == 0) arrays.real[FIELD_VOLUME][a] *= id % 7 == 0 ? 1.7 : id % 3 == 0 ? 0.3 : 0.9;
  }
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(CloudResync(s.cloud));
  SumRings(s.cloud, share, before);
  CHECK(share[0] < 0.35 && share[1] > 1.6, "rings that are thin or fat");
  for (PetscInt k = 0; k < 6; k++) {
    PetscCall(SetupMoments(&s));
    PetscCall(SetupDivergence(&s));
    PetscCall(Resample(s.cloud, &report));
    if (k == 0) first = (PetscReal)PetscMin(report.joined, report.split);
  }
  SumRings(s.cloud, share, after);
  CHECK(first > 10, "graded rings join and split");
  CHECK(share[0] > 0.5 && share[1] < 1.7, "which takes their areas back");
  for (PetscInt k = 0; k < 2; k++) CHECK_CLOSE(after[k] / before[k], 1, 1e-12, "and keeps volume and its height");
  error = 0;
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
    error = PetscMax(error, PetscAbsReal(s.cloud->size[a] * s.domain->spacing /
                                           SceneSpacing(s.scene, s.cloud->field[FIELD_POSITION] + DIM * a) -
                                         1));
  CHECK_CLOSE(SetupMax(error), 0, 0.25, "rings that have joined have the size of those around");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A thin fine ring beside a coarse one joins it, for together they are not too large for their mean size, which they
   have then; a fat coarse one splits so far apart as coarse ones are. */
static PetscErrorCode TestJoin(void)
{
  const PetscReal  place[3] = {10, 10.5, 20}, size[3] = {1, 2, 2}, area[3] = {0.5, 3.6, 8};
  const char       options[] = "-dimension axisymmetric -spacing 1 -spacing_coarse 2 -box_lower 0,0 -box_upper 30,30 "
                               "-bodies a -fine core -core_shape sphere -core_radius 1 ";
  Setup            s;
  ParticleArrays   arrays;
  ResamplingReport report;
  PetscReal        x[3] = {0, 0, 0}, joined = 0;

  PetscFunctionBegin;
  PetscCall(SetupOpen(options, &s));
  PetscCall(ParticlesAppend(s.particles, 3));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt a = 0; a < 3; a++) {
    arrays.real[FIELD_POSITION][DIM * a]     = place[a];
    arrays.real[FIELD_POSITION][DIM * a + 1] = 15;
    arrays.real[FIELD_SIZE][a]               = size[a];
    arrays.real[FIELD_VOLUME][a]             = area[a] * 2 * PETSC_PI * place[a];
    arrays.integer[INT_ID][a] = arrays.integer[INT_PARENT][a] = a;
  }
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(CloudResync(s.cloud));
  PetscCall(SetupMoments(&s));
  PetscCall(SetupDivergence(&s));
  PetscCall(Resample(s.cloud, &report));
  CHECK(report.joined == 1 && report.split == 1, "rings of two sizes join, a fat one splits");
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    const PetscReal *at = s.cloud->field[FIELD_POSITION] + DIM * a;

    if (at[0] < 12) joined = s.cloud->size[a];
    if (at[0] > 12)
      for (PetscInt d = 0; d < DIM; d++) x[d] = PetscAbsReal(x[d] - at[d]); /* the second from the first */
  }
  CHECK_CLOSE(joined, (0.5 * 10 + 3.6 * 10.5 * 2) / (0.5 * 10 + 3.6 * 10.5), 1e-12, "the size of joined rings");
  CHECK_CLOSE(Norm(x), 0.6 * 2 * PetscSqrtReal(2), 1e-6, "the distance of the halves of a coarse ring");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What an emitter within the fine region brings are particles of the fine size. */
static PetscErrorCode TestEmitter(void)
{
  Setup          s;
  Packing        packing;
  PackingReport  report;
  ParticleArrays arrays;
  PetscInt       emitted;
  Emissions      emissions = {0};
  PetscReal      wrong     = 0;

  PetscFunctionBegin;
  PetscCall(SetupOpen(FLAT "-box_upper 24,30 -core_lower -8,5 -core_upper 8,30 -bodies film,e -e_type emitter "
                           "-e_velocity 0,-1 -e_lower -2,22 -e_upper 2,25 ",
                      &s));
  PetscCall(PackingCreate(s.cloud, &packing));
  PetscCall(PackingSetFromOptions(packing));
  PetscCall(PackingRun(packing, &report));
  PetscCall(EmissionsAdd(&emissions, s.cloud, packing, 0.1, PETSC_FALSE, &emitted));
  CHECK_CLOSE(emitted, 4 * 3, 0, "an emitter beside graded liquid");
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++)
    if (arrays.integer[INT_BODY][a] == 1) wrong += PetscAbsReal(arrays.real[FIELD_VOLUME][a] - 1);
  PetscCall(ParticlesClose(s.particles, &arrays));
  CHECK_CLOSE(SetupSum(wrong), 0, 1e-9, "what it brings is fine");
  PetscCall(EmissionsDestroy(&emissions));
  PetscCall(PackingDestroy(&packing));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Refused(const char options[], const char word[])
{
  Setup          s;
  PetscErrorCode code;

  RefuseBegin();
  code = SetupPack(options, &s);
  RefuseEnd(code, word, word);
}

int main(int argc, char **argv)
{
  PetscMPIInt size;

  if (PetscInitialize(&argc, &argv, NULL, NULL)) return 1;
  PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(TestScene(FLAT, 48 * 16));
  PetscCall(TestScene(FLAT "-film_shape wave -film_wave_amplitude 1 -film_wave_length 48 ", 48 * 16));
  PetscCall(TestScene(FLAT SOLID, 48 * 16 - 12)); /* 12 points of the lattice are in the solid */
  PetscCall(TestScene(DEEP, 10 * 10 * 15));
  PetscCall(TestScene(STEEP, 20 * 20 * 16));
  PetscCall(TestScene(STEEPEST, 48 * 48 * 40));
  PetscCall(TestScene(ROUND, PETSC_PI * 30 * 30 * 24));
  PetscCall(TestTension(FLAT_DROP, 1. / 40));
  PetscCall(TestTension(ROUND_DROP, 2. / 40));
  PetscCall(TestRings());
  PetscCall(TestSheet());
  PetscCall(TestEmitter());
  PetscCall(TestBalance());
  if (size == 1) PetscCall(TestPair());
  if (size == 1) PetscCall(TestJoin());
  if (size == 1) PetscCall(TestClosure());
  Refused(FLAT "-spacing_coarse 0.5 ", "-spacing_coarse 0.5 m must be one to 8 times -spacing");
  Refused(FLAT "-spacing_coarse 9 ", "must be one to 8 times");
  Refused("-dimension 2 -spacing 1 -spacing_coarse 2 -box_lower 0,0 -box_upper 9,9 -bodies a ", "-fine");
  Refused("-dimension 2 -spacing 1 -fine c -box_lower 0,0 -box_upper 9,9 -bodies a ", "-spacing_coarse (m) is missing");
  Refused(FLAT "-solids b -b_shape sphere -b_radius 3 -b_center 0,5 ", "the solid b must lie in a region of -fine");
  Refused(FLAT "-bodies film,e -e_type emitter -e_velocity 0,-1 -e_lower -2,17 -e_upper 2,19 ",
          "the emitter e must lie in a region of -fine");
  Refused(FLAT "-box_lower -1.4,0 -box_upper 1.4,20 -box_x wall -film_lower -1.4,0 -film_upper 1.4,16 ",
          "does not fit the box");
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
