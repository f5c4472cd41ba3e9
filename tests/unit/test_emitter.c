/* Emitters: when they fill, where a filling is, how fast it moves, the numbers of its particles; the waves of a thread.
   Runs on any number of ranks. */
#include "../../src/emitters/emitters_impl.h"
#include "setup.h"
#include "check.h"

/* jet: fillings of 4 x 5 particles each 0.25 s from 0.3 s on, three of them; hose: of 3 x 2 each 0.3 s from 0 on */
#define EMITTERS                                                                                                       \
  "-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 4,4 -packing_jitter 0 -bodies jet,hose -jet_type emitter "      \
  "-jet_lower 1,3 -jet_upper 1.4,3.5 -jet_velocity 0,-2 -jet_start 0.3 -jet_count 3 -jet_modulation 0.1 "              \
  "-jet_modulation_frequency 2 -hose_type emitter -hose_lower 3,1 -hose_upper 3.3,1.2 -hose_velocity 1,0 "
#define THREAD                                                                                                         \
  "-spacing 0.1 -box_lower -2,-2,0 -box_upper 2,2,4 -box_z periodic -bodies a -a_shape thread -a_radius 0.8 "          \
  "-a_wave_length 4 -a_wave_amplitude 0.12 "

/* The time that the liquid of the jet has been under way at t after its start, at its mean speed: the integral of 1 +
   0.1 sin(4 pi t), summed up. */
static PetscReal Travelled(PetscReal t)
{
  const PetscInt n   = 100000;
  PetscReal      sum = 0;

  for (PetscInt k = 0; k < n; k++) sum += (1 + 0.1 * PetscSinReal(4 * PETSC_PI * t * (k + 0.5) / n)) * t / n;
  return sum;
}

static PetscErrorCode TestTimes(void)
{
  const PetscReal x[DIM] = {1.2, 3.2, 0};
  PetscReal       shift[DIM], v[DIM];
  Body            jet;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(SetupOpen(EMITTERS, &s));
  jet = SceneBody(s.scene, 0);
  CHECK_CLOSE(BodyFillings(jet, 0.29), 0, 0, "no filling before the start");
  CHECK_CLOSE(BodyFillings(jet, 0.31), 1, 0, "the first filling");
  CHECK_CLOSE(BodyFillings(jet, 0.3 + 0.27), 2, 0, "the second filling");
  CHECK_CLOSE(BodyFillings(jet, 9), 3, 0, "no more fillings than asked for");
  EmissionShift(jet, 1, 0.3 + 0.35, shift);
  CHECK_CLOSE(shift[0], 0, 0, "a filling goes straight on");
  CHECK_CLOSE(shift[1], -2 * (Travelled(0.35) - 0.25), 1e-9, "way of the second filling");
  BodyFillingVelocity(jet, 0.3 + 0.125, x, v);
  CHECK_CLOSE(v[1], -2 * 1.1, 1e-12, "speed at the top of its modulation");
  BodyFillingVelocity(jet, 0.3 + 0.25, x, v);
  CHECK_CLOSE(v[1], -2, 1e-12, "speed after half a period");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A run that drops keep busy waits for the next one, until the last has come. */
static PetscErrorCode TestMoments(void)
{
  PetscReal moment[16];
  Setup     s;

  PetscFunctionBegin;
  PetscCall(SetupOpen(EMITTERS "-jet_interval 3 -jet_modulation 0 ", &s));
  for (PetscInt k = 0; k < 3; k++) {
    const PetscInt n = BodyMoments(SceneBody(s.scene, 0), 0.2 + 3 * k, 100, 16, moment);

    CHECK(n > 0 && PetscAbsReal(moment[0] - (0.3 + 3 * (k + 0.5))) < 1e-12, "the middle after the next filling");
  }
  CHECK(BodyMoments(SceneBody(s.scene, 0), 0.3 + 3 * 4, 100, 16, moment) == 0, "nothing after the last");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An emitter holds what is in its shape, what has come less far than its nozzle, and nothing beside or behind it. */
static PetscErrorCode TestHolds(void)
{
  const struct {
    PetscReal   x[DIM];
    PetscBool   with, without; /* a nozzle of 0.25 m */
    const char *name;
  } at[] = {{{3.15, 1.1, 0}, PETSC_TRUE, PETSC_TRUE, "in the shape"},
            {{3.31, 1.1, 0}, PETSC_TRUE, PETSC_FALSE, "in the nozzle"},
            {{3.54, 1.1, 0}, PETSC_TRUE, PETSC_FALSE, "at the nozzle's end"},
            {{3.56, 1.1, 0}, PETSC_FALSE, PETSC_FALSE, "beyond the nozzle"},
            {{3.4, 1.24, 0}, PETSC_FALSE, PETSC_FALSE, "beside the nozzle"},
            {{2.96, 1.1, 0}, PETSC_FALSE, PETSC_FALSE, "behind the shape"}};
  Setup s;

  PetscFunctionBegin;
  for (PetscInt nozzle = 0; nozzle < 2; nozzle++) {
    PetscCall(SetupOpen(nozzle ? EMITTERS "-hose_nozzle 0.25 " : EMITTERS, &s));
    for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(at); k++)
      CHECK(BodyHolds(SceneBody(s.scene, 1), at[k].x, 0.05) == (nozzle ? at[k].with : at[k].without), at[k].name);
    PetscCall(SetupClose(&s));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Particles of one rank that have the number of another one. */
static PetscInt Twice(const ParticleArrays *arrays)
{
  PetscInt count = 0;

  for (PetscInt a = 0; a < arrays->n; a++)
    for (PetscInt b = 0; b < a; b++) count += arrays->integer[INT_ID][a] == arrays->integer[INT_ID][b];
  return count;
}

/* At 0.31 s the jet has come once, the hose twice. */
static PetscErrorCode TestParticles(void)
{
  const PetscReal time = 0.31;
  PetscInt        emitted, again, resumed, n, inside = 0;
  PetscReal       twice, wrong = 0;
  ParticleArrays  arrays;
  PackingReport   report;
  Packing         packing;
  Setup           s;

  PetscFunctionBegin;
  for (PetscInt restart = 0; restart < 2; restart++) {
    Emissions emissions = {0};

    PetscCall(SetupOpen(EMITTERS, &s));
    PetscCall(PackingCreate(s.cloud, &packing));
    PetscCall(PackingSetFromOptions(packing));
    PetscCall(PackingRun(packing, &report));
    if (restart) {
      PetscCall(EmissionsAdd(&emissions, s.cloud, packing, time, PETSC_TRUE, &resumed));
      CHECK_CLOSE(resumed, 0, 0, "a restart brings no filling again");
      PetscCall(EmissionsAdd(&emissions, s.cloud, packing, 0.61, PETSC_FALSE, &emitted));
      CHECK_CLOSE(emitted, 6 * 4 + 3 * 2, 0, "after a restart the next rows come");
    } else {
      PetscCall(EmissionsAdd(&emissions, s.cloud, packing, 0, PETSC_FALSE, &again));
      CHECK_CLOSE(again, 6, 0, "the first filling of the hose");
      PetscCall(ParticlesOpen(s.particles, &arrays));
      for (PetscInt a = 0; a < arrays.n; a++) /* it goes on */
        if (arrays.integer[INT_BODY][a] == 1) arrays.real[FIELD_POSITION][DIM * a] += time;
      PetscCall(ParticlesClose(s.particles, &arrays));
      PetscCall(EmissionsAdd(&emissions, s.cloud, packing, time, PETSC_FALSE, &emitted));
      PetscCall(ParticlesGlobalSize(s.particles, &n));
      CHECK(emitted == 20 + 6 && n == emitted + 6, "fillings of two emitters");
      CHECK_CLOSE(EmissionVolume(&emissions.of[0], s.domain), 0.2, 1e-12, "volume of a filling of the jet");
      CHECK_CLOSE(EmissionVolume(&emissions.of[1], s.domain), 0.06, 1e-12, "volume of a filling of the hose");
      PetscCall(ParticlesOpen(s.particles, &arrays));
      twice = SetupSum((PetscReal)Twice(&arrays));
      for (PetscInt a = 0; a < arrays.n; a++) PetscCall(PetscArrayzero(arrays.real[FIELD_VELOCITY] + DIM * a, DIM));
      PetscCall(ParticlesClose(s.particles, &arrays));
      CHECK_CLOSE(twice, 0, 0, "each particle has a number of its own");
      PetscCall(EmissionsAdd(&emissions, s.cloud, packing, time, PETSC_FALSE, &again));
      CHECK_CLOSE(again, 0, 0, "nothing comes twice");
      PetscCall(ParticlesOpen(s.particles, &arrays));
      for (PetscInt a = 0; a < arrays.n; a++) { /* those in the hose move with it, those that have left it are free */
        const PetscReal *x = arrays.real[FIELD_POSITION] + DIM * a, *v = arrays.real[FIELD_VELOCITY] + DIM * a;

        if (arrays.integer[INT_BODY][a] == 0) continue;
        inside += x[0] < 3.3;
        wrong = PetscMax(wrong, PetscAbsReal(v[0] - (x[0] < 3.3 ? 1 : 0)) + PetscAbsReal(v[1]));
      }
      PetscCall(ParticlesClose(s.particles, &arrays));
      CHECK_CLOSE(SetupSum((PetscReal)inside), 6, 0, "one filling of the hose is in it");
      CHECK_CLOSE(SetupMax(wrong), 0, 1e-12, "liquid in an emitter has its velocity");
    }
    PetscCall(EmissionsDestroy(&emissions));
    PetscCall(PackingDestroy(&packing));
    PetscCall(SetupClose(&s));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The train of a jet whose width (m) fits no lattice, up or down: after many fillings it has the volume of its shape
   but for a row, its rows are evenly far apart, and each particle has a number of its own. */
static PetscErrorCode TestFlux(PetscReal width, PetscReal speed)
{
  const PetscInt  fillings = 20, rows = 10;
  const PetscReal h = 0.1, time = (fillings - 0.5) * rows * h / PetscAbsReal(speed), shape = width * rows * h;
  char            options[512];
  PetscInt        emitted, first;
  PetscReal       way[512], gap, wrong = 0;
  Emissions       emissions = {0}, late = {0};
  PackingReport   report;
  Packing         packing;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof(options),
                          "-dimension 2 -spacing %g -box_lower 0,-30 -box_upper 4,30 -packing_jitter 0 -bodies jet "
                          "-jet_type emitter -jet_lower 1,0 -jet_upper %g,%g -jet_velocity 0,%g ",
                          (double)h, (double)(1 + width), (double)(rows * h), (double)speed));
  PetscCall(SetupOpen(options, &s));
  PetscCall(PackingCreate(s.cloud, &packing));
  PetscCall(PackingSetFromOptions(packing));
  PetscCall(PackingRun(packing, &report));
  PetscCall(EmissionsAdd(&emissions, s.cloud, packing, 0, PETSC_FALSE, &first));
  PetscCall(EmissionsAdd(&emissions, s.cloud, packing, time, PETSC_FALSE, &emitted));
  emitted += first;
  CHECK_CLOSE(emitted * h * h / ((fillings + 0.5) * shape), 1, 1.0 / (fillings * rows),
              "volume of a train of fillings and half of the next one");
  CHECK_CLOSE(EmissionVolume(&emissions.of[0], s.domain), shape, 1e-3 * shape, "volume of a filling in the mean");
  first = 0;
  for (PetscInt p = 0; p < emissions.of[0].n; p++) { /* the rows of the first column */
    const PetscReal *x = emissions.of[0].x + DIM * p;

    if (PetscAbsReal(x[0] - emissions.of[0].x[0]) > 0.1 * h) continue;
    for (PetscInt k = 0; k < fillings; k++) {
      PetscReal shift[DIM];

      EmissionShift(SceneBody(s.scene, 0), EmissionFilling(&emissions.of[0], k, p), 0, shift);
      way[first++] = (speed > 0 ? rows * h - x[1] - shift[1] : x[1] + shift[1]);
    }
  }
  PetscCall(PetscSortReal(first, way));
  gap = (way[first - 1] - way[0]) / (first - 1);
  for (PetscInt k = 1; k < first; k++) wrong = PetscMax(wrong, PetscAbsReal(way[k] - way[k - 1] - gap));
  CHECK_CLOSE(wrong, 0, 1e-9, "rows of a train are evenly far apart");
  CHECK_CLOSE(gap * width, h * h * (emissions.of[0].n / rows), 1e-3 * h * h,
              "and so far that the flux is that of the shape");
  PetscCall(EmissionsAdd(&late, s.cloud, packing, time, PETSC_FALSE, &emitted));
  CHECK_CLOSE(emitted * h * h / shape, 1, 1.0 / rows, "a run that begins later begins with what is in the emitter");
  PetscCall(EmissionsDestroy(&late));
  PetscCall(EmissionsDestroy(&emissions));
  PetscCall(PackingDestroy(&packing));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The modified Bessel function of order one, by its series. */
static PetscReal BesselI1(PetscReal x)
{
  PetscReal term = 0.5 * x, sum = term;

  for (PetscInt m = 1; m < 30; m++) {
    term *= 0.25 * x * x / (m * (m + 1));
    sum += term;
  }
  return sum;
}

/* At a crest and a trough a point of the cylinder goes by the mode's velocity, a I1(kr)/I1(kR), outwards or inwards;
   there the surface is. */
static PetscErrorCode TestThread(void)
{
  const PetscReal R = 0.8, k = 2 * PETSC_PI / 4;
  const PetscInt  steps = 100000;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(SetupOpen(THREAD, &s));
  for (PetscInt trough = 0; trough < 2; trough++) {
    PetscReal x[DIM] = {R, 0, trough ? 2 : 0}, r = R;

    for (PetscInt n = 0; n < steps; n++) r += (trough ? -1 : 1) * 0.12 * BesselI1(k * r) / BesselI1(k * R) / steps;
    BodyDisplace(SceneBody(s.scene, 0), x);
    CHECK_CLOSE(x[0], r, 2e-6, trough ? "trough of a thread" : "crest of a thread"); /* of Euler's steps above */
    CHECK_CLOSE(BodyDistance(SceneBody(s.scene, 0), x), 0, 1e-6, "surface of a thread");
  }
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(LogRegister());
  PetscCall(TestTimes());
  PetscCall(TestMoments());
  PetscCall(TestHolds());
  PetscCall(TestParticles());
  for (PetscInt k = 0; k < 2; k++) {
    PetscCall(TestFlux(1.06, k ? 1 : -1)); /* 11 columns */
    PetscCall(TestFlux(0.53, k ? 1 : -1)); /* 5 */
    PetscCall(TestFlux(0.5, k ? 1 : -1));
  }
  PetscCall(TestThread());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
