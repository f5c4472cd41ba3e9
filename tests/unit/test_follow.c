/* The spacing follows the surface: the target for known shapes, what joins and splits keep, the bound on particles.
   Lengths in fine spacings. Runs on any number of ranks. */
#include "../../src/following/following_impl.h"
#include "../../src/resampling/resampling_impl.h"
#include "setup.h"
#include "check.h"

#define POOL                                                                                                           \
  "-spacing 1 -spacing_coarse 4 -spacing_growth 0.1 -box_lower 0,0,0 -box_upper 40,40,60 "                             \
  "-box_x symmetry -box_y symmetry -box_zmin wall -bodies film,drop -film_upper 40,40,20 -drop_shape sphere "          \
  "-drop_center 0,0,34 -drop_radius 8 -film_density 1 -drop_density 1 -film_viscosity 1 "                              \
  "-drop_viscosity 1 -film_tension 1 -drop_tension 1 "

/* A drop of radius R and curvature 2/R wants R/8 with four spacings a radius 1/(k1 + k2); a flat film none, at the
   faces of the box neither; a sheet a fifth of its thickness; between, the spacing grows with the distance. */
static PetscErrorCode TestTarget(void)
{
  const PetscReal top[DIM] = {0, 0, 42}, far[DIM] = {39, 39, 19}, corner[DIM] = {39.5, 20, 20},
                  beside[DIM] = {20, 0, 34}, below[DIM] = {0, 0, 20}, floor[DIM] = {30, 30, 1},
                  sheet[DIM] = {20, 20, 30};
  Setup s;

  PetscFunctionBegin;
  PetscCall(SetupOpen(POOL "-spacing_follow curvature ", &s));
  CHECK_CLOSE(SceneSpacing(s.scene, top), 1, 0.01, "a drop of eight spacings is fine");
  CHECK_CLOSE(SceneSpacing(s.scene, far), 4, 1e-6, "flat liquid far away is coarse");
  CHECK_CLOSE(SceneSpacing(s.scene, corner), 4, 0.3, "a wall makes no edge of the film");
  CHECK_CLOSE(SceneSpacing(s.scene, beside), 1 + 0.1 * (12 - 4), 0.15, "the spacing grows with the distance");
  CHECK_CLOSE(SceneSpacing(s.scene, below), 1 + 0.1 * (6 - 4), 0.15, "and through the air");
  CHECK_CLOSE(SceneSpacing(s.scene, floor), 4, 1e-6, "the floor asks for nothing");
  PetscCall(SetupClose(&s));
  PetscCall(SetupOpen(POOL "-spacing_follow surface ", &s));
  CHECK_CLOSE(SceneSpacing(s.scene, far), 1, 0.01, "all free surfaces are fine");
  CHECK_CLOSE(SceneSpacing(s.scene, floor), 1 + 0.1 * (19 - 4), 0.2, "and walls are not");
  PetscCall(SetupClose(&s));
  PetscCall(SetupOpen(POOL
                      "-spacing_follow curvature -bodies film,drop,sheet -sheet_lower 0,0,27 -sheet_upper 40,40,37 "
                      "-bodies_overlap -drop_radius 1 -drop_center 0,0,55 -sheet_density 1 ",
                      &s));
  CHECK_CLOSE(SceneSpacing(s.scene, sheet), 1.35, 0.35, "a sheet has five particles across");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Volume of the liquid and of the first body's, moment, momentum, number. */
static void SumLiquid(Cloud cloud, PetscReal sum[5])
{
  for (PetscInt k = 0; k < 5; k++) sum[k] = 0;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    sum[0] += cloud->volume[a];
    sum[1] += cloud->volume[a] * cloud->field[FIELD_COLOUR][a];
    sum[2] += cloud->volume[a] * cloud->field[FIELD_POSITION][DIM * a + 2];
    sum[3] += cloud->volume[a] * cloud->field[FIELD_VELOCITY][DIM * a + 2];
    sum[4] += 1;
  }
  for (PetscInt k = 0; k < 5; k++) sum[k] = SetupSum(sum[k]);
}

/* The floor: its columns cover it without gap or overlap, with the smoothing length and the layers of the target, and
   each has its parent at its top. widest: of a column. */
static PetscErrorCode CheckFloor(Setup *s, PetscReal widest, const char when[])
{
  const Cloud      cloud = s->cloud;
  const PetscReal *x     = cloud->field[FIELD_POSITION];
  PetscReal        area = 0, off = 0, most = 0, density = 0, lowest = 0;
  PetscInt         lost = 0;

  PetscFunctionBegin;
  for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++) {
    const PetscReal on[DIM] = {x[DIM * a], x[DIM * a + 1], 0}, wanted = SceneSpacing(s->scene, on),
                    own = cloud->volume[a] / cloud->size[a];
    PetscInt b          = cloud->n_fluid;

    if (cloud->integer[INT_LAYER][a] == 1) area += own;
    most = PetscMax(most, PetscSqrtReal(own));
    off  = PetscMax(off, PetscAbsReal(cloud->size[a] - wanted));
    off  = PetscMax(off, PetscAbsReal(x[DIM * a + 2] + (cloud->integer[INT_LAYER][a] - 0.5) * wanted));
    while (b < cloud->n_owned && cloud->integer[INT_ID][b] != cloud->integer[INT_PARENT][a]) b++;
    lost += b == cloud->n_owned || x[DIM * b] != x[DIM * a] || x[DIM * b + 1] != x[DIM * a + 1] ||
            cloud->integer[INT_LAYER][b] != 1;
  }
  PetscCall(SetupMoments(s));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    if (x[DIM * a + 2] > cloud->size[a]) continue;
    density += cloud->field[FIELD_DENSITY][a];
    lowest += 1;
  }
  CHECK_CLOSE(SetupSum(density) / SetupSum(lowest), 1, 0.04, "liquid on the floor has the density of all");
  CHECK_CLOSE(SetupSum(area), 1600, 1e-9, when);
  CHECK_CLOSE(off, 0, 1e-12, "a wall has the smoothing length and the layers of the target");
  CHECK(most <= widest + 1e-9, "and columns as narrow as it needs");
  CHECK(lost == 0, "each column has one parent");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A drop in the film of another body, both packed for a surface that is fine, then followed by curvature: the film
   becomes coarse, the drop's liquid mixes into it, and volume, colour, momentum and, but for the smoothing, the centre
   stay. Then the reverse, with a bound on the particles. */
static PetscErrorCode TestKept(void)
{
  Setup            s;
  ParticleArrays   arrays;
  ResamplingReport report;
  PetscReal        before[5], after[5];
  PetscInt         joined = 0, split = 0;

  PetscFunctionBegin;
  PetscCall(SetupPack(POOL "-spacing_follow surface -drop_center 0,0,24 -drop_radius 4.5 -box_upper 40,40,40 ", &s));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++)
    if (arrays.integer[INT_LAYER][a] == 0)
      arrays.real[FIELD_VELOCITY][DIM * a + 2] = arrays.integer[INT_BODY][a] ? -3 : 0;
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(CloudResync(s.cloud));
  PetscCall(CheckFloor(&s, 2, "the first floor has no gap"));
  SumLiquid(s.cloud, before);
  FollowOf(s.domain)->what = FOLLOW_CURVATURE;
  for (PetscInt k = 0; k < 6; k++) {
    PetscCall(SetupMoments(&s));
    PetscCall(PetscArrayzero(s.cloud->field[FIELD_VELOCITY_GRADIENT], DIM * DIM * s.cloud->n_owned));
    PetscCall(Resample(s.cloud, &report));
    PetscCall(CheckFloor(&s, 4, "nor the floor of coarse liquid"));
    joined += report.joined;
    split += report.split;
  }
  SumLiquid(s.cloud, after);
  CHECK(joined > 0.15 * before[4], "flat liquid becomes coarse");
  CHECK_CLOSE(after[4], before[4] - joined + split, 0, "those that join are gone, those that split are two");
  CHECK_CLOSE(after[0], before[0], 1e-12 * before[0], "the volume stays");
  CHECK_CLOSE(after[1], before[1], 1e-12 * before[0], "the volume of each liquid stays");
  CHECK_CLOSE(after[2], before[2], 1e-6 * before[2], "the centre stays");
  CHECK_CLOSE(after[3], before[3], 1e-12 * before[0], "the momentum stays");
  split                              = 0;
  FollowOf(s.domain)->what           = FOLLOW_SURFACE;
  FollowOf(s.domain)->particles_most = (PetscInt)(1.5 * after[4]);
  for (PetscInt k = 0; k < 8; k++) {
    PetscCall(SetupMoments(&s));
    PetscCall(PetscArrayzero(s.cloud->field[FIELD_VELOCITY_GRADIENT], DIM * DIM * s.cloud->n_owned));
    PetscCall(Resample(s.cloud, &report));
    PetscCall(CheckFloor(&s, 4, "nor that of finer liquid"));
    split += report.split - report.joined;
  }
  SumLiquid(s.cloud, after);
  CHECK(split > 0, "the surface becomes fine again");
  CHECK(after[4] < 1.35 * FollowOf(s.domain)->particles_most,
        "no more particles than asked for, but for what is about to join");
  CHECK_CLOSE(after[0], before[0], 1e-12 * before[0], "the volume stays in splits");
  CHECK_CLOSE(after[1], before[1], 1e-12 * before[0], "and the colour");
  CHECK_CLOSE(after[3], before[3], 1e-12 * before[0], "and the momentum");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define ROUND                                                                                                          \
  "-dimension axisymmetric -spacing 1 -spacing_coarse 4 -spacing_growth 0.1 -box_lower 0,0 "                           \
  "-box_upper 40,70 -box_xmax wall -box_ymin wall -bodies film,drop -film_upper 40,20 -drop_shape sphere "             \
  "-drop_center 0,46 -drop_radius 16 -film_density 1 -drop_density 1 -packing_jitter 0 "

/* The dummies of rings: those of a layer of the floor reach from the axis to the wall and cover the disc, but for the
   first ring, whose mean radius is that of its layer where its column is narrower; those of a layer of the cylinder
   fill it to the top. */
static PetscErrorCode CheckRound(Setup *s, const char label[])
{
  const Cloud cloud = s->cloud;
  PetscReal   area = 0, radius = 0, height = 0;
  char        name[96];

  PetscFunctionBegin;
  for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++) {
    const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, size = cloud->size[a],
                    inner = 40 + size * (cloud->integer[INT_LAYER][a] - 1);

    if (cloud->integer[INT_LAYER][a] == 1 && x[0] < 40 && x[1] < 0) {
      area += cloud->volume[a] / size;
      radius += cloud->volume[a] / (size * cloud->length[a]);
    }
    if (x[0] > 40 && x[1] > 0 && x[1] < 70 && cloud->integer[INT_LAYER][a] == 2)
      height += cloud->volume[a] / (PETSC_PI * (PetscSqr(inner + size) - PetscSqr(inner)));
  }
  PetscCall(PetscSNPrintf(name, sizeof(name), "the floor from the axis to the wall, %s", label));
  CHECK_CLOSE(SetupSum(radius) / 40, 1, 1e-12, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "the area of the floor of rings, %s", label));
  CHECK_CLOSE(SetupSum(area) / (PETSC_PI * 1600), 1, 4e-4, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "the cylinder around rings, %s", label));
  CHECK_CLOSE(SetupSum(height) / 70, 1, 1e-12, name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The target of the cloud as it is. */
static PetscErrorCode FindTarget(Setup *s)
{
  PetscReal *size;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(s->cloud, 1, &size));
  PetscCall(TargetFind(s->cloud, size));
  PetscCall(CloudRestoreWork(s->cloud, &size));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The target by the normals of the particles of a packing, whatever the packing followed. */
static PetscErrorCode FindByNormals(Setup *s)
{
  PetscFunctionBegin;
  FollowOf(s->domain)->what = FOLLOW_CURVATURE;
  PetscCall(SetupMoments(s));
  PetscCall(FindTarget(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define SHELLS 10000

/* A ball of radius R around 'center' of shells a spacing thick, in space or as rings. Returns its particles. */
static PetscInt Shells(PetscBool rings, const PetscReal center[DIM], PetscReal R, PetscReal x[])
{
  PetscInt n = 0;

  for (PetscReal r = R - 0.5; r > 0; r -= 1) {
    const PetscInt  count = (PetscInt)(rings ? PETSC_PI * r : 4 * PETSC_PI * r * r) + 1;
    const PetscReal turn  = PETSC_PI * (3 - PetscSqrtReal(5)); /* a Fibonacci lattice */

    for (PetscInt k = 0; k < count; k++, n++) {
      const PetscReal z = 1 - (2 * k + 1) / (PetscReal)count, across = PetscSqrtReal(1 - z * z),
                      angle         = PETSC_PI * (k + 0.5) / count;
      const PetscReal place[2][DIM] = {{across * PetscCosReal(turn * k), across * PetscSinReal(turn * k), z},
                                       {PetscSinReal(angle), PetscCosReal(angle), 0}};

      for (PetscInt d = 0; d < DIM; d++) x[DIM * n + d] = center[d] + r * place[rings][d];
    }
  }
  return n;
}

/* A drop has two curvatures of 1/R by its normals, in space and as rings. */
static PetscErrorCode TestNormals(void)
{
  static PetscReal   x[DIM * SHELLS];
  static const char *box[2] = {"-box_lower -20,-20,-20 -box_upper 20,20,20 -drop_shape sphere -drop_radius 12 ",
                               "-dimension axisymmetric -box_lower 0,-20 -box_upper 30,20 -drop_shape sphere "
                               "-drop_radius 12 "};

  PetscFunctionBegin;
  for (PetscInt rings = 0; rings < 2; rings++) {
    const PetscReal center[DIM] = {0, 0, 0}, side[DIM] = {12, 0, 0};
    const PetscInt  n = Shells((PetscBool)rings, center, 12, x);
    char            options[PETSC_MAX_PATH_LEN];
    Setup           s;

    PetscCall(PetscSNPrintf(options, sizeof(options),
                            "-spacing 1 -spacing_coarse 4 -spacing_growth 0.02 "
                            "-bodies drop -spacing_follow curvature %s",
                            box[rings]));
    PetscCall(SetupFill(options, n, x, 0, &s));
    PetscCall(FindByNormals(&s));
    CHECK_CLOSE(SceneSpacing(s.scene, side), 1.5, 0.2,
                rings ? "a drop of rings, by its normals" : "a drop, by its normals");
    PetscCall(SetupClose(&s));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A drop of rings has two curvatures of 1/R and wants R/8, on the axis and beside it; the wall of a cavity in the
   liquid has that around the axis alone and wants R/4, by its shape and by the normals of its particles. On a surface
   the target is up to its growth over the band smaller. */
static PetscErrorCode TestRings(void)
{
  const PetscReal top[DIM] = {0.1, 62, 0}, side[DIM] = {16, 46, 0}, cavity[DIM] = {8, 40, 0};
  Setup           s;

  PetscFunctionBegin;
  PetscCall(SetupPack(ROUND "-spacing_follow curvature ", &s));
  CHECK_CLOSE(SceneSpacing(s.scene, top), 1.8, 0.2, "the top of a drop of rings");
  CHECK_CLOSE(SceneSpacing(s.scene, side), 1.8, 0.2, "its side");
  PetscCall(CheckRound(&s, "coarse"));
  PetscCall(SetupClose(&s));
  PetscCall(SetupPack(ROUND "-bodies film -film_lower 8,0 -film_upper 40,70 -spacing_follow surface ", &s));
  PetscCall(CheckRound(&s, "fine"));
  PetscCall(FindByNormals(&s));
  CHECK_CLOSE(SceneSpacing(s.scene, cavity), 1.8, 0.2, "the wall of a cavity, by its normals");
  PetscCall(TargetClear(s.scene));
  PetscCall(TargetBodies(s.domain, s.scene));
  /* the curvature is that of the parallel surface at r = 6, carried back as if it were a sphere's: 1/7 */
  CHECK_CLOSE(SceneSpacing(s.scene, cavity), 1.55, 0.2, "the wall of a cavity, by its shape");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Nearest to the axis a torus has the curvatures 1/12 and -1/12 (1/spacings): their sum is zero, as in a plane, their
   magnitudes ask for six spacings over four. */
static PetscErrorCode TestSaddle(void)
{
  const PetscReal inside[DIM] = {12, 35, 0};
  Setup           s;
  PetscReal       bending = 0, kappa = 0, count = 0;

  PetscFunctionBegin;
  PetscCall(SetupPack(ROUND "-bodies drop -drop_center 24,35 -drop_radius 12 "
                            "-drop_tension 1 -spacing_follow surface ",
                      &s));
  FollowOf(s.domain)->what = FOLLOW_CURVATURE;
  PetscCall(SetupMoments(&s));
  PetscCall(TensionApply(s.tension, s.cloud));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    const PetscReal *x = s.cloud->field[FIELD_POSITION] + DIM * a;

    if (s.cloud->integer[INT_SURFACE][a] != 1 || x[0] > 13 || PetscAbsReal(x[1] - 35) > 2) continue;
    bending += s.cloud->field[FIELD_BENDING][a];
    kappa += s.cloud->field[FIELD_CAPILLARY][a];
    count++;
  }
  count = SetupSum(count);
  CHECK_CLOSE(SetupSum(bending) / count, 1. / 6, 0.02, "the magnitudes of the curvatures of a saddle");
  CHECK_CLOSE(SetupSum(kappa) / count, 0, 0.02, "its tension has their sum");
  PetscCall(FindTarget(&s));
  CHECK_CLOSE(SceneSpacing(s.scene, inside), 1.5, 0.5, "the spacing at a saddle");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What auto stands for. */
static PetscErrorCode TestAuto(void)
{
  Setup s;

  PetscFunctionBegin;
  PetscCall(SetupOpen(ROUND "-spacing_follow auto ", &s));
  CHECK(FollowOf(s.domain)->what == FOLLOW_SURFACE, "rings follow all of the surface");
  PetscCall(SetupClose(&s));
  PetscCall(SetupOpen(POOL "-spacing_follow auto ", &s));
  CHECK(FollowOf(s.domain)->what == FOLLOW_CURVATURE, "in space the curvature counts");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How a field is carried. A colour is a part of the volume, whatever its row says. */
static Carry CarryOf(PetscInt f)
{
  return f == FIELD_COLOUR ? CARRY_MEAN : Fields[f].carry;
}

/* What of each stored field joins and splits keep, from the meaning of its row alone: the sum, the mean over the
   volume, or that of the logarithm; 0: nothing. A field that a new row stores is tested with the others. */
static void SumCarried(Cloud cloud, PetscReal sum[FIELD_STORED_COUNT])
{
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++) {
    sum[f] = 0;
    if (f == FIELD_POSITION || !ParticlesHave(cloud->particles, f)) continue; /* places even out after splits */
    for (PetscInt a = 0; a < cloud->n_fluid; a++)
      for (PetscInt c = 0; c < Fields[f].width; c++) {
        const PetscReal x = cloud->field[f][Fields[f].width * a + c], V = cloud->volume[a];

        if (CarryOf(f) == CARRY_SUM) sum[f] += x;
        if (CarryOf(f) == CARRY_MEAN) sum[f] += (c + 1) * V * x;
        if (CarryOf(f) == CARRY_LOGARITHM) sum[f] += V * PetscLogReal(x);
      }
    sum[f] = SetupSum(sum[f]);
  }
}

/* Joins, then splits, of particles that differ in every stored field. */
static PetscErrorCode TestCarried(void)
{
  Setup            s;
  ParticleArrays   arrays;
  ResamplingReport report;
  PetscReal        before[FIELD_STORED_COUNT], after[FIELD_STORED_COUNT];

  PetscFunctionBegin;
  PetscCall(SetupPack(POOL "-spacing_follow surface -drop_center 0,0,24 -drop_radius 4.5 -box_upper 40,40,40 "
                           "-film_upper 40,40,10 -wall_contact_law cox_voinov -film_viscosity_model carreau "
                           "-film_viscosity_infinite 0.1 -film_viscosity_time 1 -film_viscosity_exponent 0.5 ",
                      &s));
  for (PetscInt turn = 0; turn < 2; turn++) {
    PetscCall(ParticlesOpen(s.particles, &arrays));
    for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++)
      for (PetscInt k = 0; arrays.real[f] && k < arrays.n * Fields[f].width; k++)
        if (f > FIELD_POSITION && (CarryOf(f) == CARRY_MEAN || CarryOf(f) == CARRY_LOGARITHM))
          arrays.real[f][k] =
            0.5 + 0.4 * PetscSinReal((PetscReal)(7 * arrays.integer[INT_ID][k / Fields[f].width] + f));
    PetscCall(ParticlesClose(s.particles, &arrays));
    PetscCall(CloudResync(s.cloud));
    SumCarried(s.cloud, before);
    FollowOf(s.domain)->what = turn ? FOLLOW_SURFACE : FOLLOW_CURVATURE;
    PetscCall(SetupMoments(&s));
    PetscCall(PetscArrayzero(s.cloud->field[FIELD_VELOCITY_GRADIENT], DIM * DIM * s.cloud->n_owned));
    PetscCall(Resample(s.cloud, &report));
    CHECK((turn ? report.split : report.joined) > 100, turn ? "many split" : "many join");
    SumCarried(s.cloud, after);
    for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++)
      CHECK_CLOSE(after[f], before[f], 1e-11 * (1 + PetscAbsReal(before[f])), Fields[f].name);
  }
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(LogRegister());
  PetscCall(TestTarget());
  PetscCall(TestKept());
  PetscCall(TestCarried());
  PetscCall(TestRings());
  PetscCall(TestNormals());
  PetscCall(TestSaddle());
  PetscCall(TestAuto());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
