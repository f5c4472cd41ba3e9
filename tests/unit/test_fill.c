/* The packings by numbers: jitter, seed and level of a lattice, grading, solids, the report, the least distance of
   random ones. Lengths in spacings. Runs on any number of ranks. */
#include "setup.h"
#include "check.h"

#define H      1.3
#define SQUARE "-dimension 2 -spacing 1 -box_lower 0,0 -box_upper 20,20 -box_x periodic -box_y periodic -bodies a "

#define GRADED                                                                                                         \
  "-dimension 2 -spacing 1 -spacing_coarse 2 -box_lower -24,0 -box_upper 24,20 -box_x symmetry -box_ymin wall "        \
  "-bodies film -film_lower -24,0 -film_upper 24,16 -fine core -core_lower -6,0 -core_upper 3,8 -tension_type none "

static PetscErrorCode Pack(const char options[], Setup *s, PackingReport *report)
{
  Packing packing;

  PetscFunctionBegin;
  PetscCall(SetupOpen(options, s));
  PetscCall(PackingCreate(s->cloud, &packing));
  PetscCall(PackingSetFromOptions(packing));
  PetscCall(PackingRun(packing, report));
  PetscCall(PackingDestroy(&packing));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Largest and mean displacement (of a component) from a lattice of 20 by 20, and the sum of all positions times
   numbers, which tells packings apart. */
static PetscErrorCode Displaced(const char options[], PetscReal *largest, PetscReal *mean, PetscReal *mark)
{
  ParticleArrays arrays;
  PackingReport  report;
  Setup          s;

  PetscFunctionBegin;
  PetscCall(Pack(options, &s, &report));
  *largest = *mean = *mark = 0;
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt k = 0; k < DIM * arrays.n; k++) {
    const PetscReal x = arrays.real[FIELD_POSITION][k], off = x - PetscFloorReal(x) - 0.5;

    if (k % DIM == 2) continue;
    *largest = PetscMax(*largest, PetscAbsReal(off));
    *mean += off / 800;
    *mark += x * (arrays.integer[INT_ID][k / DIM] % 17);
  }
  PetscCall(ParticlesClose(s.particles, &arrays));
  *largest = SetupMax(*largest);
  *mean    = SetupSum(*mean);
  *mark    = SetupSum(*mark);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestJitter(void)
{
  PetscReal largest, mean, one, two, again;

  PetscFunctionBegin;
  PetscCall(Displaced(SQUARE "-packing_jitter 0.2 -packing_seed 3", &largest, &mean, &one));
  CHECK_CLOSE(largest, 0.1975, 0.0025, "jitter"); /* the largest of 800 numbers up to 0.2 */
  CHECK_CLOSE(mean, 0, 0.02, "jitter_to_both_sides");
  PetscCall(Displaced(SQUARE "-packing_jitter 0.2 -packing_seed 4", &largest, &mean, &two));
  PetscCall(Displaced(SQUARE "-packing_jitter 0.2 -packing_seed 3", &largest, &mean, &again));
  CHECK(PetscAbsReal(one - two) > 0.1 && PetscAbsReal(one - again) < 1e-9, "seed");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Discs have as many particles as they have area, within one and a half. */
static PetscErrorCode TestLevel(void)
{
  const PetscReal radius[] = {8.3, 11.7, 15.1};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 3; k++) {
    char          options[256];
    PetscInt      n;
    PackingReport report;
    Setup         s;

    PetscCall(PetscSNPrintf(options, sizeof(options),
                            "-dimension 2 -spacing 1 -box_lower -20,-20 -box_upper 20,20 -packing_jitter 0 -bodies a "
                            "-a_shape sphere -a_radius %g",
                            (double)radius[k]));
    PetscCall(Pack(options, &s, &report));
    PetscCall(ParticlesGlobalSize(s.particles, &n));
    CHECK_CLOSE(n, PETSC_PI * PetscSqr(radius[k]), 1.5, "particles_of_a_disc");
    PetscCall(SetupClose(&s));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* No liquid stands in a solid; its 6 by 4 places are empty. */
static PetscErrorCode TestSolid(void)
{
  PetscInt       fluid = 0, in = 0;
  ParticleArrays arrays;
  PackingReport  report;
  Setup          s;

  PetscFunctionBegin;
  PetscCall(Pack(SQUARE "-packing_jitter 0 -solids block -block_lower 7,8 -block_upper 13,12", &s, &report));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscReal *x = arrays.real[FIELD_POSITION] + DIM * a;

    if (arrays.integer[INT_LAYER][a]) continue;
    fluid++;
    in += x[0] > 7 && x[0] < 13 && x[1] > 8 && x[1] < 12;
  }
  PetscCall(ParticlesClose(s.particles, &arrays));
  CHECK(SetupSum((PetscReal)in) == 0 && SetupSum((PetscReal)fluid) == 400 - 24, "solids_are_no_liquid");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The report of a full lattice: all densities are off by the same, what the sum of the cubic spline lacks to one. */
static PetscErrorCode TestReport(void)
{
  PetscReal     sum = 0;
  PackingReport report;
  Setup         s;

  PetscFunctionBegin;
  for (PetscInt i = -3; i <= 3; i++)
    for (PetscInt j = -3; j <= 3; j++) {
      const PetscReal q = PetscSqrtReal((PetscReal)(i * i + j * j)) / H;

      sum += 10 / (7 * PETSC_PI * H * H) *
             (q < 1   ? 1 - 1.5 * q * q + 0.75 * q * q * q
              : q < 2 ? 0.25 * (2 - q) * (2 - q) * (2 - q)
                      : 0);
    }
  PetscCall(Pack(SQUARE "-packing_jitter 0", &s, &report));
  CHECK_CLOSE(report.density_std / (1000 * PetscAbsReal(sum - 1)), 1, 1e-9, "deviation_of_the_density");
  CHECK_CLOSE(report.smallest_distance, 1, 1e-12, "smallest_distance");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Random packings keep their distance, also where the density is good enough before. */
static PetscErrorCode TestDistance(void)
{
  PackingReport report;
  Setup         s;

  PetscFunctionBegin;
  PetscCall(Pack(SQUARE "-packing_type poisson -packing_cache \"\" -packing_tolerance 0.05", &s, &report));
  CHECK(report.smallest_distance >= 0.6 && report.density_std <= 0.05 * 1000 * 1.001, "least_distance");
  if (getenv("TEST_VERBOSE"))
    printf("%g %g %" PetscInt_FMT "\n", report.smallest_distance, report.density_std, report.iterations);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Jitter moves lattice points by up to so many of their own spacings; the columns of wall particles share the floor,
   each in the middle of its part, the first half of its width behind the face. */
static PetscErrorCode TestPlaces(void)
{
  const PetscReal jitter = 0.2;
  Setup           s, moved;
  ParticleArrays  at, there;
  PetscReal       coarse = 0, fine = 0, sum[2] = {0, 0}, depth = 0;

  PetscFunctionBegin;
  PetscCall(SetupPack(GRADED "-packing_jitter 0 ", &s));
  PetscCall(SetupPack(GRADED "-packing_jitter 0.2 ", &moved));
  PetscCall(ParticlesOpen(s.particles, &at));
  PetscCall(ParticlesOpen(moved.particles, &there));
  for (PetscInt a = 0; a < at.n; a++) {
    const PetscReal *x = at.real[FIELD_POSITION] + DIM * a, width = PetscSqrtReal(at.real[FIELD_VOLUME][a]);

    if (at.integer[INT_LAYER][a] == 1 && x[1] < 0) {
      sum[0] += width;
      sum[1] += width * x[0];
      depth = PetscMax(depth, PetscAbsReal(x[1] / width + 0.5));
    }
    for (PetscInt b = 0; b < there.n && at.integer[INT_LAYER][a] == 0; b++)
      if (there.integer[INT_ID][b] == at.integer[INT_ID][a] && there.integer[INT_LAYER][b] == 0)
        for (PetscInt d = 0; d < 2; d++) {
          const PetscReal way = PetscAbsReal(there.real[FIELD_POSITION][DIM * b + d] - x[d]) / width;

          if (width > 1.9)
            coarse = PetscMax(coarse, way);
          else if (width < 1.01)
            fine = PetscMax(fine, way);
        }
  }
  PetscCall(ParticlesClose(s.particles, &at));
  PetscCall(ParticlesClose(moved.particles, &there));
  CHECK(fine > 0.9 * jitter && fine <= jitter * 1.001, "jitter of fine particles");
  CHECK(coarse > 0.9 * jitter && coarse <= jitter * 1.001, "jitter of coarse particles");
  CHECK_CLOSE(SetupSum(sum[0]), 48, 1e-9, "wall particles share the floor");
  CHECK_CLOSE(SetupSum(sum[1]), 0, 1e-6, "each in the middle of its part");
  CHECK_CLOSE(SetupMax(depth), 0, 1e-9, "half a width behind the face");
  PetscCall(SetupClose(&moved));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(LogRegister());
  PetscCall(TestJitter());
  PetscCall(TestLevel());
  PetscCall(TestSolid());
  PetscCall(TestReport());
  PetscCall(TestDistance());
  PetscCall(TestPlaces());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
