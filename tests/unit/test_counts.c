/* Counts beyond 32 bits, without the memory that they would take: the list of a small cloud is moved behind 2^31 places
   that are never touched, and whatever reads it must give the same numbers to the last bit; sizes and refusals are
   computed from made-up counts. */
#define _DEFAULT_SOURCE /* MAP_NORESERVE */
#include "../../src/pressure/pressure_impl.h"
#include "../../src/neighbors/pairs.h"
#include "setup.h"
#include "check.h"
#include <sys/mman.h>

#define POOL                                                                                                           \
  "-spacing 1 -box_lower 0,0,0 -box_upper 9,8,20 -box_x periodic -box_y symmetry -box_zmin wall -packing_jitter 0.2 "  \
  "-bodies a,b -a_upper 9,8,4 -a_viscosity 2 -b_lower 0,0,4 -b_upper 9,8,6 -b_viscosity 3 "
#define BEHIND ((PetscInt64)INT32_MAX + 4096) /* places before the list that was moved */
#define SUMS   8

/* Room for BEHIND items of that size, which no memory stands behind, and then for n. */
static void *Far(PetscInt64 n, size_t size)
{
  void *p =
    mmap(NULL, (size_t)(BEHIND + n) * size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);

  return p == MAP_FAILED ? NULL : p;
}

/* The arrays of the list. */
typedef struct {
  PetscInt *list;
  float    *slope;
  uint16_t *laplacian;
} Pairs;

static Pairs Swap(Cloud cloud, Pairs new, PetscInt64 shift)
{
  const Pairs old = {cloud->list, cloud->slope, cloud->laplacian};

  cloud->list      = new.list;
  cloud->slope     = new.slope;
  cloud->laplacian = new.laplacian;
  for (PetscInt a = 0; a <= cloud->n_owned; a++) cloud->first[a] += shift;
  return old;
}

static PetscReal Squares(PetscInt n, const PetscReal x[])
{
  PetscReal sum = 0;

  for (PetscInt k = 0; k < n; k++) sum += x[k] * x[k];
  return sum;
}

/* The viscous terms of random velocities: explicit; and as the operator of the implicit solve, its product and
   diagonal. pair: room for the places of the list. */
static PetscErrorCode SumViscosity(Cloud cloud, ViscosityForm form, PetscReal pair[], PetscReal sum[3])
{
  Viscosity  viscosity = {.form = form};
  PetscReal *v         = cloud->field[FIELD_VELOCITY], *out;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, DIM, &out));
  for (PetscInt k = 0; k < DIM * cloud->n_owned; k++) v[k] = RandomUnit(4, (unsigned long long)k);
  PetscCall(CloudUpdate(cloud, FIELD_VELOCITY));
  OperatorsNoSlip(cloud, &viscosity);
  PetscCall(PetscArrayzero(cloud->field[FIELD_ACCELERATION], DIM * cloud->n_owned));
  PetscCall(OperatorsViscosity(cloud, &viscosity, cloud->rest_density));
  sum[0] = Squares(DIM * cloud->n_fluid, cloud->field[FIELD_ACCELERATION]);
  PetscCall(OperatorsViscosityPairs(cloud, &viscosity, cloud->rest_density, pair));
  PetscCall(OperatorsViscosityApply(cloud, &viscosity, pair, v, out));
  sum[1] = Squares(DIM * cloud->n_fluid, out);
  PetscCall(OperatorsViscosityDiagonal(cloud, &viscosity, pair, out));
  sum[2] = Squares(DIM * cloud->n_fluid, out);
  PetscCall(CloudRestoreWork(cloud, &out));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Numbers of all that reads the list. */
static PetscErrorCode Sums(Setup *s, PetscReal pair[], PetscReal sum[SUMS])
{
  Cloud      cloud = s->cloud;
  PetscInt   flags = 0;
  PetscReal *p, *y;
  Mat        A;
  Vec        b;

  PetscFunctionBegin;
  PetscCall(OperatorsFreeSurface(cloud));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) flags += cloud->integer[INT_SURFACE][a];
  sum[0] = flags;
  PetscCall(SumViscosity(cloud, VISCOSITY_CLEARY, pair, sum + 1));
  PetscCall(SumViscosity(cloud, VISCOSITY_MORRIS, pair, sum + 4));
  PetscCall(PressureAssemble(s->pressure, 1, &A, &b));
  PetscCall(MatNorm(A, NORM_FROBENIUS, &sum[7]));
  PetscCall(CloudGetWork(cloud, 1, &p));
  PetscCall(CloudGetWork(cloud, 1, &y));
  for (PetscInt k = 0; k < cloud->n_rows; k++) p[k] = RandomUnit(5, (unsigned long long)k);
  PetscCall(PressureMultiply(s->pressure, p, y));
  sum[7] += Squares(cloud->n_rows, y);
  PetscCall(CloudRestoreWork(cloud, &y));
  PetscCall(CloudRestoreWork(cloud, &p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestFarList(void)
{
  const char *const names[SUMS] = {"free_surface",    "viscosity", "cleary",          "cleary_diagonal",
                                   "morris_explicit", "morris",    "morris_diagonal", "pressure"};
  Setup             s;
  Cloud             cloud;
  PetscInt64        n, room;
  Pairs             far, near;
  PetscReal         before[SUMS], after[SUMS], *pair;
  char              name[64];

  PetscFunctionBegin;
  PetscCall(SetupPack(POOL, &s));
  cloud = s.cloud;
  PetscCall(SetupMoments(&s));
  PetscCall(PressureCreate(cloud, &s.pressure));
  PetscCall(PressureSetTypes(s.pressure, SOURCE_DENSITY, CLOSURE_FULL, GRADIENT_SYMMETRIC, PETSC_FALSE));
  PetscCall(PressureSetFromOptions(s.pressure));
  n             = cloud->first[cloud->n_owned] + SEARCH_LANES;
  room          = OperatorsViscosityRoom(cloud);
  pair          = Far(room, sizeof(PetscReal));
  far.list      = Far(n, sizeof(PetscInt));
  far.slope     = Far(n, sizeof(float));
  far.laplacian = Far(n, sizeof(uint16_t));
  CHECK(pair && far.list && far.slope && far.laplacian, "address_space");
  PetscCall(PetscArraycpy(far.list + BEHIND, cloud->list, n));
  PetscCall(PetscArraycpy(far.slope + BEHIND, cloud->slope, n));
  PetscCall(PetscArraycpy(far.laplacian + BEHIND, cloud->laplacian, n));
  PetscCall(Sums(&s, pair, before));
  near = Swap(cloud, far, BEHIND);
  PetscCall(Sums(&s, pair, after));
  (void)Swap(cloud, near, -BEHIND);
  for (PetscInt k = 0; k < SUMS; k++) {
    PetscCall(PetscSNPrintf(name, sizeof(name), "far_list_%s", names[k]));
    CHECK(SetupMax(before[k]) > 0 && before[k] == after[k], name);
  }
  (void)munmap(pair, (size_t)(BEHIND + room) * sizeof(PetscReal));
  (void)munmap(far.list, (size_t)(BEHIND + n) * sizeof(PetscInt));
  (void)munmap(far.slope, (size_t)(BEHIND + n) * sizeof(float));
  (void)munmap(far.laplacian, (size_t)(BEHIND + n) * sizeof(uint16_t));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What a rank of twenty million particles needs, and a hundred neighbours each. */
static void TestSizes(void)
{
  const PetscInt64 used  = 1900000000;
  PetscInt         few[] = {0, 700000000, 700000000, 600000000};
  PetscBool        room;

  CHECK(CloudListRoom(0, 30000000, 1000) == 72 * (PetscInt64)30000000 + 1000, "list_at_first");
  CHECK(CloudListRoom(used, 1000000, 1000) == used + used / 8 + 72000000 + 1000, "list_later");
  CHECK(CloudListRoom(used, 1, 400000000) == used + 800000000, "list_of_clumps");
  MatrixStarts(3, few, &room);
  CHECK(room && few[1] == 700000000 && few[2] == 1400000000 && few[3] == 2000000000, "matrix_that_fits");
#if !defined(PETSC_USE_64BIT_INDICES)
  PetscInt many[] = {0, 700000000, 700000000, 700000000, 900000000};

  MatrixStarts(4, many, &room);
  CHECK(!room, "matrix_too_large");
#endif
}

/* Twenty million particles a rank and a thousand million in all pass; more than PETSc can number are refused. */
static PetscErrorCode TestRefusals(void)
{
  PetscFunctionBegin;
  PetscCall(ParticlesCheckRoom(PETSC_COMM_WORLD, 30000000));
  PetscCall(CloudCheckUnknowns(PETSC_COMM_SELF, 700000000, DIM, "x"));
#if !defined(PETSC_USE_64BIT_INDICES)
  CHECK(ParticlesCheckRoom(PETSC_COMM_WORLD, 70000000) == ISPH_USER_ERROR, "particles_of_a_rank");
  CHECK(ParticlesCheckRoom(PETSC_COMM_WORLD, 5000000000) == ISPH_USER_ERROR, "particles_beyond_32_bits");
  CHECK(CloudCheckUnknowns(PETSC_COMM_SELF, 1000000000, DIM, "implicit viscosity") == ISPH_USER_ERROR, "unknowns");
#endif
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(UserErrorHandlerPush());
  PetscCall(TestFarList());
  TestSizes();
  PetscCall(TestRefusals());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
