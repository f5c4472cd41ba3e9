/* Polymers: each model beside its equation integrated finely, in shear, extension and long steps; the divergence of a
   stress that pulls along a thread; a linear velocity feels none of the balance, a linear stretch does not
   mix. Runs on any number of ranks. */
#include "../../src/elastic/elastic_impl.h"
#include "check.h"
#include "setup.h"

#define FINE 20000 /* steps of the integration */
#define THREAD                                                                                                         \
  "-dimension axisymmetric -spacing 1e-4 -box_lower 0,0 -box_upper 2e-3,4e-3 -box_y periodic -bodies jet "             \
  "-jet_shape thread -jet_center 0,0 -jet_wave_length 4e-3 -jet_polymer_modulus 10 -jet_relaxation_time 1 "
#define CHANNEL                                                                                                        \
  "-dimension 2 -spacing 0.1e-3 -box_lower 0,0 -box_upper 2e-3,1.5e-3 -box_x periodic -box_ymin wall -bodies film "    \
  "-film_upper 2e-3,1e-3 -film_polymer_modulus 10 -film_relaxation_time 1 -film_viscosity 0.1 "
#define WIDTH 2e-3 /* m, of its wall */

static const PetscInt At[DIM][DIM] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};

/* dc/dt of the header's equation, as s = c - 1. */
static void Rate(const Polymers *p, PetscReal L[DIM][DIM], const PetscReal s[6], PetscReal rate[6])
{
  const PetscReal trace = 3 + s[0] + s[1] + s[2], f = p->model == FENE_P ? (p->extent - 3) / (p->extent - trace) : 1;

  for (PetscInt i = 0; i < DIM; i++)
    for (PetscInt j = i; j < DIM; j++) {
      PetscReal *r = rate + At[i][j];

      *r = L[i][j] + L[j][i] - (f * s[At[i][j]] + (i == j) * (f - 1)) / p->relaxation;
      for (PetscInt k = 0; k < DIM; k++) {
        *r += L[i][k] * s[At[k][j]] + L[j][k] * s[At[i][k]];
        if (p->model == GIESEKUS) *r -= p->mobility / p->relaxation * s[At[i][k]] * s[At[k][j]];
      }
    }
}

static void TestModel(const char name[], Polymers p, PetscReal shear, PetscReal extension, PetscInt steps,
                      PetscReal tol)
{
  PetscReal L[DIM][DIM] = {{-0.5 * extension, 0, 0}, {shear, extension, 0}, {0, 0, -0.5 * extension}};
  PetscReal s[6] = {0}, exact[6] = {0}, middle[6], rate[6], tau[6], most = 0, off = 0;

  for (PetscInt k = 0; k < FINE; k++) { /* the midpoint rule */
    Rate(&p, L, exact, rate);
    for (PetscInt m = 0; m < 6; m++) middle[m] = exact[m] + 0.5 / FINE * rate[m];
    Rate(&p, L, middle, rate);
    for (PetscInt m = 0; m < 6; m++) exact[m] += 1. / FINE * rate[m];
  }
  for (PetscInt k = 0; k < steps; k++) PolymersStretch(&p, L, 1. / (PetscReal)steps, s);
  PolymersStress(&p, s, tau);
  for (PetscInt m = 0; m < 6; m++) {
    most = PetscMax(most, PetscAbsReal(exact[m]));
    off  = PetscMax(off, PetscAbsReal(s[m] - exact[m]));
  }
  CHECK_CLOSE(off / most, 0, tol, name);
  CHECK(PolymersEnergy(&p, s) > 0, "its energy is positive");
}

static void TestModels(void)
{
  const Polymers oldroyd  = {.modulus = 1, .relaxation = 0.2, .model = OLDROYD_B},
                 giesekus = {.modulus = 1, .relaxation = 0.2, .model = GIESEKUS, .mobility = 0.2},
                 fene     = {.modulus = 1, .relaxation = 0.2, .model = FENE_P, .extent = 50},
                 brief    = {.modulus = 1, .relaxation = 1e-6, .model = OLDROYD_B};
  PetscReal L[DIM][DIM] = {{0, 500, 0}, {-300, 0, 900}, {0, 20, 0}}, slow[DIM][DIM] = {{0, 5, 0}}, c[6], s[6] = {0};

  TestModel("shear of oldroyd_b", oldroyd, 5, 0, 1000, 1e-5);
  TestModel("extension of oldroyd_b", oldroyd, 0, 2, 1000, 1e-5);
  TestModel("shear of giesekus", giesekus, 10, 0, 4000, 1e-3);
  TestModel("shear of fene_p", fene, 10, 0, 4000, 2e-3);
  TestModel("extension of fene_p", fene, 1, 3, 4000, 2e-3);
  PolymersStretch(&brief, slow, 1, s);
  CHECK_CLOSE(s[3] / 5e-6, 1, 1e-4, "a step of a million relaxation times is that of a Newtonian liquid");
  for (PetscInt m = 0; m < 6; m++) s[m] = 0;
  for (PetscInt k = 0; k < 3; k++) PolymersStretch(&oldroyd, L, 0.01, s);
  for (PetscInt m = 0; m < 6; m++) c[m] = s[m] + (m < DIM);
  CHECK(SymmetricSmallestEigenvalue(3, c) > 0, "positive in steps that turn by several radians");
}

/* A unit stress along the lines that run along a thread of the section A = A0 + A1 cos kz: div T = A'/A along the axis,
   and the power on sin kz is -k A1 L/2. Its section is what the particles have. */
static PetscErrorCode TestThread(PetscReal radius, PetscReal tol)
{
  const PetscReal k = 2 * PETSC_PI / 4e-3;
  char            options[1024], name[64];
  Setup           s;
  PetscReal      *T, *n, *f, *wall, A0 = 0, A1 = 0, power = 0, push = 0;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof(options), THREAD "-jet_radius %g -jet_wave_amplitude %g", (double)radius,
                          0.15 * (double)radius));
  PetscCall(SetupPack(options, &s));
  PetscCall(SetupMoments(&s));
  PetscCall(CloudGetWork(s.cloud, 6, &T));
  PetscCall(CloudGetWork(s.cloud, DIM, &n));
  PetscCall(CloudGetWork(s.cloud, DIM, &f));
  PetscCall(CloudGetWork(s.cloud, DIM, &wall));
  PetscCall(PetscArrayzero(T, 6 * s.cloud->n_total));
  PetscCall(PetscArrayzero(s.cloud->field[FIELD_VELOCITY], DIM * s.cloud->n_total));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    A0 += s.cloud->volume[a];
    A1 += 2 * s.cloud->volume[a] * PetscCosReal(k * s.cloud->field[FIELD_POSITION][DIM * a + 1]);
  }
  A0 = SetupSum(A0);
  A1 = SetupSum(A1);
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    const PetscReal *x = s.cloud->field[FIELD_POSITION] + DIM * a,
                    b  = -0.5 * k * A1 * PetscSinReal(k * x[1]) / (A0 + A1 * PetscCosReal(k * x[1]));

    T[6 * a]     = PetscSqr(x[0] * b);
    T[6 * a + 1] = 1;
    T[6 * a + 3] = x[0] * b;
  }
  PetscCall(CloudUpdateArray(s.cloud, 6, PARITY_TENSOR, T));
  PetscCall(OperatorsSmoothNormals(s.cloud, n));
  PetscCall(ElasticDivergence(s.cloud, n, T, f, wall));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    power += s.cloud->volume[a] * f[DIM * a + 1] * PetscSinReal(k * s.cloud->field[FIELD_POSITION][DIM * a + 1]);
    push += s.cloud->volume[a] * f[DIM * a + 1];
  }
  PetscCall(PetscSNPrintf(name, sizeof(name), "pull of a thread of %g spacings", (double)radius / 1e-4));
  CHECK_CLOSE(SetupSum(power) / (-0.5 * k * A1), 1, tol, name);
  CHECK_CLOSE(SetupSum(push) / (k * A1), 0, 1e-5, "its momentum stays"); /* weights have single precision */
  PetscCall(CloudRestoreWork(s.cloud, &wall));
  PetscCall(CloudRestoreWork(s.cloud, &f));
  PetscCall(CloudRestoreWork(s.cloud, &n));
  PetscCall(CloudRestoreWork(s.cloud, &T));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A film on a wall shears, at rest on the wall: what all of the viscosity does to the velocities of the fit is what it
   does to the velocities, and walls get nothing. The stress (1, 2) Pa on the wall pulls at it as it does in the liquid.
 */
static PetscErrorCode TestSeen(void)
{
  Setup      s;
  Viscosity  viscosity = {.form = VISCOSITY_MOMENT};
  PetscReal *L, *share, *seen, *pair, *u, *drag, *wall, *T, most = 0, off = 0, on[DIM] = {0, 0, 0};

  PetscFunctionBegin;
  PetscCall(SetupPack(CHANNEL, &s));
  PetscCall(SetupMoments(&s));
  OperatorsNoSlip(s.cloud, &viscosity);
  for (PetscInt a = 0; a < s.cloud->n_total; a++) {
    PetscReal *v = s.cloud->field[FIELD_VELOCITY] + DIM * a;

    v[0] = s.cloud->integer[INT_LAYER][a] ? 0 : s.cloud->field[FIELD_POSITION][DIM * a + 1];
    v[1] = v[2] = 0;
  }
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) s.cloud->field[FIELD_VISCOSITY][a] = 0.1;
  PetscCall(CloudUpdate(s.cloud, FIELD_VISCOSITY));
  PetscCall(CloudGetWork(s.cloud, DIM * DIM, &L));
  PetscCall(CloudGetWork(s.cloud, 1, &share));
  PetscCall(CloudGetWork(s.cloud, DIM, &seen));
  PetscCall(CloudGetWork(s.cloud, DIM, &u));
  PetscCall(CloudGetWork(s.cloud, DIM, &drag));
  PetscCall(CloudGetWork(s.cloud, DIM, &wall));
  PetscCall(CloudGetWork(s.cloud, 6, &T));
  PetscCall(PetscMalloc1(OperatorsViscosityRoom(s.cloud), &pair));
  for (PetscInt a = 0; a < s.cloud->n_total; a++) share[a] = s.cloud->integer[INT_LAYER][a] == 0;
  PetscCall(OperatorsVelocityGradient(s.cloud, &viscosity, L));
  PetscCall(OperatorsViscosityPairs(s.cloud, &viscosity, s.cloud->rest_density, pair));
  PetscCall(PetscArrayzero(wall, DIM * s.cloud->n_total));
  PetscCall(ElasticSeen(s.cloud, &viscosity, pair, share, L, seen, wall));
  PetscCall(OperatorsWallDrag(s.cloud, &viscosity, s.cloud->field[FIELD_VELOCITY], drag));
  PetscCall(PetscArraycpy(u, s.cloud->field[FIELD_VELOCITY], DIM * s.cloud->n_total));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    PetscReal all[DIM];

    OperatorsViscosityRow(s.cloud, &viscosity, pair, a, u, all);
    for (PetscInt d = 0; d < DIM; d++) {
      most = PetscMax(most, PetscAbsReal(all[d]));
      off  = PetscMax(off, PetscAbsReal(all[d] + seen[DIM * a + d]));
    }
  }
  CHECK_CLOSE(SetupMax(off) / SetupMax(most), 0, 1e-6, "a linear velocity feels none of the balance");
  off = most = 0;
  for (PetscInt k = DIM * s.cloud->n_fluid; k < DIM * s.cloud->n_total; k++) {
    most = PetscMax(most, PetscAbsReal(drag[k]));
    off  = PetscMax(off, PetscAbsReal(drag[k] + wall[k]));
  }
  CHECK_CLOSE(SetupMax(off) / SetupMax(most), 0, 1e-6, "and gives walls none");
  PetscCall(PetscArrayzero(wall, DIM * s.cloud->n_total));
  for (PetscInt a = 0; a < s.cloud->n_total; a++)
    for (PetscInt m = 0; m < 6; m++) T[6 * a + m] = (m == 3) + 2 * (m == 1);
  PetscCall(OperatorsSmoothNormals(s.cloud, u));
  PetscCall(ElasticDivergence(s.cloud, u, T, seen, wall));
  for (PetscInt a = s.cloud->n_fluid; a < s.cloud->n_total; a++)
    for (PetscInt d = 0; d < DIM; d++) on[d] += wall[DIM * a + d];
  CHECK_CLOSE(SetupSum(on[0]) / WIDTH, 1, 0.01, "shear stress on a wall");
  CHECK_CLOSE(SetupSum(on[1]) / WIDTH, 2, 0.02, "normal stress on a wall");
  PetscCall(PetscFree(pair));
  PetscCall(CloudRestoreWork(s.cloud, &T));
  PetscCall(CloudRestoreWork(s.cloud, &wall));
  PetscCall(CloudRestoreWork(s.cloud, &drag));
  PetscCall(CloudRestoreWork(s.cloud, &u));
  PetscCall(CloudRestoreWork(s.cloud, &seen));
  PetscCall(CloudRestoreWork(s.cloud, &share));
  PetscCall(CloudRestoreWork(s.cloud, &L));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A unit of shear on a film on a wall: a stretch that is linear, as far as the walls and the surface, stays; one that
   differs from particle to particle becomes even. */
static PetscErrorCode TestMix(void)
{
  Setup      s;
  PetscReal *L, *c, off = 0, before = 0, after = 0;

  PetscFunctionBegin;
  PetscCall(SetupPack(CHANNEL, &s));
  PetscCall(SetupMoments(&s));
  PetscCall(CloudGetWork(s.cloud, DIM * DIM, &L));
  PetscCall(PetscArrayzero(L, DIM * DIM * s.cloud->n_fluid));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) L[DIM * DIM * a + 1] = 1;
  c = s.cloud->field[FIELD_STRETCH];
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
    for (PetscInt m = 0; m < 6; m++) c[6 * a + m] = m == 3 ? 0 : s.cloud->field[FIELD_POSITION][DIM * a + 1] / 1e-3;
  PetscCall(ElasticMix(s.cloud, L, 1));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
    off = PetscMax(off, PetscAbsReal(c[6 * a] - s.cloud->field[FIELD_POSITION][DIM * a + 1] / 1e-3));
  CHECK_CLOSE(SetupMax(off), 0, 1e-5, "a linear stretch does not mix"); /* weights have single precision */
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    for (PetscInt m = 0; m < DIM; m++) c[6 * a + m] = s.cloud->integer[INT_ID][a] % 2;
    before += PetscSqr(c[6 * a] - 0.5);
  }
  PetscCall(ElasticMix(s.cloud, L, 1));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) after += PetscSqr(c[6 * a] - 0.5);
  CHECK(SetupSum(after) < 0.25 * SetupSum(before), "a stretch that alternates becomes even in a unit of shear");
  PetscCall(CloudRestoreWork(s.cloud, &L));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  TestModels();
  PetscCall(TestThread(3e-4, 0.02));
  PetscCall(TestThread(12e-4, 0.01));
  PetscCall(TestSeen());
  PetscCall(TestMix());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
