/* Small particles among large ones join them. Lengths in fine spacings. Runs on any number of ranks. */
#include "../../src/resampling/resampling_impl.h"
#include "setup.h"
#include "check.h"

#define POOL                                                                                                           \
  "-spacing 1 -spacing_coarse 4 -spacing_growth 0.2 -box_lower 0,0,0 -box_upper 20,20,20 -box_x symmetry "             \
  "-box_y symmetry -box_zmin wall -bodies film -film_upper 20,20,16 -fine core -core_shape sphere -core_radius 2 "     \
  "-core_center 0,0,16 -tension_type none "

/* Volume of the liquid, and its moment along x, momentum and kinetic energy, of unit density. */
static void SumLiquid(Cloud cloud, PetscReal sum[4])
{
  sum[0] = sum[1] = sum[2] = sum[3] = 0;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *v = cloud->field[FIELD_VELOCITY] + DIM * a;

    sum[0] += cloud->volume[a];
    sum[1] += cloud->volume[a] * cloud->field[FIELD_POSITION][DIM * a];
    sum[2] += cloud->volume[a] * v[0];
    sum[3] += 0.5 * cloud->volume[a] * Dot(v, v);
  }
  for (PetscInt k = 0; k < 4; k++) sum[k] = SetupSum(sum[k]);
}

/* Small particles among large ones become one with them, and keep volume, place and momentum of all; what they lose is
   told. The grading itself stays, so does what flies, what has much of its size around it, and another liquid. */
static PetscErrorCode TestAlone(void)
{
  enum { ALONE = 9, FLIES, OTHER, COUNT };
  Setup            s;
  ParticleArrays   arrays;
  ResamplingReport report;
  PetscInt         n, joined = 0;
  PetscMPIInt      rank;
  PetscReal        before[4], after[4], energy = 0, most = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(SetupPack(POOL "-bodies film,drop -drop_shape sphere -drop_radius 2 -drop_center 18,4,18 -drop_density 9 "
                           "-film_density 1 -drop_viscosity 1 -film_viscosity 1 ",
                      &s));
  PetscCall(SetupMoments(&s));
  PetscCall(Resample(s.cloud, &report));
  CHECK_CLOSE(report.joined, 0, 0, "no particle of a grading is alone");
  PetscCall(ParticlesLocalSize(s.particles, &n));
  PetscCall(ParticlesAppend(s.particles, rank ? 0 : COUNT));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt k = 0; k < COUNT && rank == 0; k++) { /* in coarse liquid, above it, and of the drop's liquid */
    const PetscReal x[DIM] = {k == FLIES ? 5 : 13 + 3.1 * (k % 2), 14 + 0.7 * k - (k > ALONE ? 4 : 0),
                              k == FLIES ? 19.9 : 3 + 0.9 * (k % 5)};

    PetscCall(PetscArraycpy(arrays.real[FIELD_POSITION] + DIM * (n + k), x, DIM));
    arrays.real[FIELD_VELOCITY][DIM * (n + k)] = 1 + 0.5 * k;
    arrays.real[FIELD_VOLUME][n + k]           = 1;
    arrays.integer[INT_BODY][n + k]            = k == OTHER;
    arrays.integer[INT_ID][n + k] = arrays.integer[INT_PARENT][n + k] = 100000 + k;
  }
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(CloudResync(s.cloud));
  SumLiquid(s.cloud, before);
  for (PetscInt k = 0; k < 5; k++) {
    PetscCall(SetupMoments(&s));
    PetscCall(Resample(s.cloud, &report));
    CHECK(report.split == 0, "graded particles do not split");
    joined += report.joined;
    for (PetscInt a = 0; a < s.cloud->n_fluid; a++) most = PetscMax(most, s.cloud->size[a]);
    energy += report.energy;
  }
  SumLiquid(s.cloud, after);
  CHECK_CLOSE(joined, ALONE, 0, "small particles among large ones join them, others do not");
  CHECK(SetupMax(most) > 4, "and make them larger");
  for (PetscInt k = 0; k < 3; k++) CHECK_CLOSE(after[k] / before[k], 1, 1e-12, "joining keeps volume, place, momentum");
  CHECK_CLOSE(energy / (before[3] - after[3]), 1, 1e-9, "and tells the energy");
  PetscCall(ParticlesLocalSize(s.particles, &n));
  PetscCall(ParticlesAppend(s.particles, rank == 0));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt a = 0; a < n; a++) /* as large as may be */
    if (arrays.real[FIELD_VOLUME][a] > 20) arrays.real[FIELD_VOLUME][a] = 0.9999 * PetscPowRealInt(4.4, 3);
  if (rank == 0) {
    for (PetscInt d = 0; d < DIM; d++) arrays.real[FIELD_POSITION][DIM * n + d] = d == 0 ? 13 : d == 1 ? 14 : 3;
    arrays.real[FIELD_VOLUME][n] = 1;
    arrays.integer[INT_ID][n] = arrays.integer[INT_PARENT][n] = 200000;
  }
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(CloudResync(s.cloud));
  PetscCall(SetupMoments(&s));
  PetscCall(Resample(s.cloud, &report));
  CHECK_CLOSE(report.joined, 0, 0, "particles as large as may be take up no more");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* As many particles of one spacing as of four, and nothing else: up to nine of a size fill less than an eighth of their
   support, a sphere of 2.6 of their spacings. */
static PetscErrorCode TestShare(PetscInt n, PetscBool joins, const char name[])
{
  Setup            s;
  ParticleArrays   arrays;
  ResamplingReport report;
  PetscMPIInt      rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(SetupOpen(POOL, &s));
  PetscCall(ParticlesAppend(s.particles, rank ? 0 : 2 * n));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    arrays.real[FIELD_POSITION][DIM * a]     = a < n ? 10 + 0.1 * (PetscReal)a : 12 + 0.1 * (PetscReal)a;
    arrays.real[FIELD_POSITION][DIM * a + 1] = arrays.real[FIELD_POSITION][DIM * a + 2] = 10;

    arrays.real[FIELD_VOLUME][a] = a < n ? 1 : 64;
    arrays.integer[INT_ID][a] = arrays.integer[INT_PARENT][a] = a;
  }
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(CloudResync(s.cloud));
  PetscCall(SetupMoments(&s));
  PetscCall(Resample(s.cloud, &report));
  CHECK((report.joined > 0) == joins, name);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(LogRegister());
  PetscCall(TestAlone());
  PetscCall(TestShare(10, PETSC_FALSE, "more than an eighth of a support is company"));
  PetscCall(TestShare(9, PETSC_TRUE, "less is not"));
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
