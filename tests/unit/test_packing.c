/* Packing: the lattice and its walls against what one can count, the Poisson packing against its goals, the cache
   against the original. Everything made on all ranks is compared by id with the same made on one. */
#include "setup.h"
#include "check.h"

#define CACHE_FOLDER "output/build/tests/packing_cache"

/* Fluid particles of all ranks, the sum over the fluid of position component d, and the smallest and largest of it. */
static PetscErrorCode Fluid(Setup *s, PetscInt d, PetscInt *count, PetscReal range[2])
{
  ParticleArrays p;

  PetscFunctionBeginUser;
  *count   = 0;
  range[0] = PETSC_MAX_REAL;
  range[1] = PETSC_MIN_REAL;
  PetscCall(ParticlesOpen(s->particles, &p));
  for (PetscInt a = 0; a < p.n; a++) {
    if (p.integer[INT_LAYER][a]) continue;
    (*count)++;
    range[0] = PetscMin(range[0], p.real[FIELD_POSITION][DIM * a + d]);
    range[1] = PetscMax(range[1], p.real[FIELD_POSITION][DIM * a + d]);
  }
  PetscCall(ParticlesClose(s->particles, &p));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, count, 1, MPIU_INT, MPI_SUM, s->domain->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &range[0], 1, MPIU_REAL, MPIU_MIN, s->domain->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &range[1], 1, MPIU_REAL, MPIU_MAX, s->domain->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Largest difference of positions and number of differing integers between two sets, by id; the second one complete on
   every rank. */
static PetscErrorCode Compare(Setup *parts, Setup *whole, PetscReal *position, PetscInt *integers)
{
  ParticleArrays p, w;
  PetscInt      *place;

  PetscFunctionBeginUser;
  *position = 0;
  *integers = parts->global != whole->global;
  PetscCall(PetscMalloc1(whole->global, &place));
  PetscCall(ParticlesOpen(whole->particles, &w));
  PetscCall(ParticlesOpen(parts->particles, &p));
  for (PetscInt b = 0; b < w.n; b++) place[b] = -1;
  for (PetscInt b = 0; b < w.n; b++)
    if (w.integer[INT_ID][b] >= 0 && w.integer[INT_ID][b] < w.n) place[w.integer[INT_ID][b]] = b;
  for (PetscInt a = 0; a < p.n; a++) {
    const PetscInt id = p.integer[INT_ID][a], b = id >= 0 && id < w.n ? place[id] : -1;

    if (b < 0) {
      (*integers)++;
      continue;
    }
    for (PetscInt d = 0; d < DIM; d++)
      *position =
        PetscMax(*position, PetscAbsReal(p.real[FIELD_POSITION][DIM * a + d] - w.real[FIELD_POSITION][DIM * b + d]));
    for (PetscInt f = 0; f < INT_COUNT; f++) *integers += p.integer[f][a] != w.integer[f][b];
  }
  PetscCall(ParticlesClose(parts->particles, &p));
  PetscCall(ParticlesClose(whole->particles, &w));
  PetscCall(PetscFree(place));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, position, 1, MPIU_REAL, MPIU_MAX, parts->domain->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, integers, 1, MPIU_INT, MPI_SUM, parts->domain->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestRanks(const char name[], const char options[])
{
  Setup     parts, whole;
  PetscReal position;
  PetscInt  integers;
  char      text[128];

  PetscFunctionBeginUser;
  PetscCall(SetupPackOn(PETSC_COMM_WORLD, options, &parts));
  PetscCall(SetupPackOn(PETSC_COMM_SELF, options, &whole));
  PetscCall(Compare(&parts, &whole, &position, &integers));
  PetscCall(PetscSNPrintf(text, sizeof(text), "%s: positions alike on any number of ranks", name));
  CHECK_CLOSE(position, 0, 0, text);
  PetscCall(PetscSNPrintf(text, sizeof(text), "%s: ids, bodies, layers, parents alike on any number of ranks", name));
  CHECK_CLOSE(integers, 0, 0, text);
  PetscCall(SetupClose(&parts));
  PetscCall(SetupClose(&whole));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Brute force over all wall particles, on one rank: layers, parents, velocities. depth: number of spacings outside the
   box. */
static PetscErrorCode CheckWalls(Setup *s, const char name[])
{
  const Domain   domain = s->domain;
  ParticleArrays p;
  PetscInt       wrong[4] = {0, 0, 0, 0}; /* body, layer, parent, velocity */
  char           text[128];
  const char *what[4] = {"body -1, outside the box", "layer counts from the face", "parent is the nearest of layer 1",
                         "velocity is the face's"};

  PetscFunctionBeginUser;
  PetscCall(ParticlesOpen(s->particles, &p));
  for (PetscInt a = 0; a < p.n; a++) {
    const PetscReal *x = p.real[FIELD_POSITION] + DIM * a, *v = p.real[FIELD_VELOCITY] + DIM * a;
    const PetscInt   layer   = p.integer[INT_LAYER][a];
    PetscReal        outside = 0, nearest = PETSC_MAX_REAL, mine = PETSC_MAX_REAL, expected[DIM] = {0, 0, 0};
    PetscInt         faces = 0;

    if (layer == 0) continue;
    for (PetscInt d = 0; d < domain->dim; d++) {
      const PetscReal out = PetscMax(domain->lower[d] - x[d], x[d] - domain->upper[d]) / domain->spacing;

      outside = PetscMax(outside, out);
      if (out > 0 && faces++ == 0)
        PetscCall(PetscArraycpy(expected, domain->wall_velocity[d][x[d] > domain->upper[d]], DIM));
    }
    if (faces > 1) PetscCall(PetscArrayzero(expected, DIM)); /* the scene's faces all differ */
    for (PetscInt b = 0; b < p.n; b++) {
      PetscReal r2 = 0;

      if (p.integer[INT_LAYER][b] != 1) continue;
      for (PetscInt d = 0; d < DIM; d++) r2 += PetscSqr(p.real[FIELD_POSITION][DIM * b + d] - x[d]);
      nearest = PetscMin(nearest, r2);
      if (p.integer[INT_ID][b] == p.integer[INT_PARENT][a]) mine = r2;
    }
    wrong[0] += p.integer[INT_BODY][a] != -1 || outside <= 0;
    wrong[1] += layer != (PetscInt)PetscCeilReal(outside);
    wrong[2] += PetscAbsReal(mine - nearest) > 1e-9 * PetscSqr(domain->spacing);
    for (PetscInt d = 0; d < DIM; d++) wrong[3] += v[d] != expected[d];
  }
  PetscCall(ParticlesClose(s->particles, &p));
  for (PetscInt k = 0; k < 4; k++) {
    PetscCall(PetscSNPrintf(text, sizeof(text), "%s: wall: %s", name, what[k]));
    CHECK_CLOSE(wrong[k], 0, 0, text);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A film on a floor, side walls in x, periodic in y where 0.96 m is not a multiple of the spacing. */
#define FILM                                                                                                           \
  "-spacing 0.1 -box_lower 0,0,0 -box_upper 1,0.96,2 -box_x wall -box_y periodic -box_zmin wall -box_xmax_velocity "   \
  "0,2,0 -box_zmin_velocity 0,1,0 "                                                                                    \
  "-bodies film -film_shape box -film_lower 0,0,0 -film_upper 1,0.96,0.5 "

static PetscErrorCode TestLattice(void)
{
  Setup     s;
  PetscInt  count;
  PetscReal range[2];

  PetscFunctionBeginUser;
  PetscCall(SetupPackOn(PETSC_COMM_SELF, FILM "-packing_jitter 0", &s));
  PetscCall(Fluid(&s, 1, &count, range));
  CHECK_CLOSE(count, 10 * 10 * 5, 0, "film: fluid particles"); /* 0.96 / 0.1 rounds to 10 */
  CHECK_CLOSE(range[0], 0.048, 1e-12, "film: the lattice is fitted to the periodic direction, lower end");
  CHECK_CLOSE(range[1], 0.912, 1e-12, "film: the lattice is fitted to the periodic direction, upper end");
  CHECK_CLOSE(s.global - count, ((10 + 6) * (20 + 3) - 10 * 20) * 10, 0,
              "film: wall particles, three layers on three faces and two edges");
  CHECK_CLOSE(s.report.smallest_distance, 0.96, 1e-12, "film: smallest distance, across the periodic face too");
  CHECK(s.report.iterations == 0 && !s.report.cached, "film: no iterations, no cache");
  PetscCall(CheckWalls(&s, "film"));
  PetscCall(SetupClose(&s));

  PetscCall(SetupPackOn(PETSC_COMM_SELF, FILM, &s));
  CHECK(s.report.smallest_distance > 0.56 && s.report.smallest_distance < 0.66,
        "film: the default jitter is 0.2 spacings");
  PetscCall(SetupClose(&s));

  /* a sphere clear of all faces, off the box's lattice: symmetric about its centre; and a quarter of it on symmetry
     planes */
  PetscCall(SetupPackOn(PETSC_COMM_SELF,
                        "-spacing 0.1 -box_lower -1,-1,-1 -box_upper 1,1,1 -bodies b -b_shape sphere -b_radius 0.4 "
                        "-b_center 0.03,0,0 -packing_jitter 0",
                        &s));
  PetscCall(Fluid(&s, 0, &count, range));
  CHECK_CLOSE(range[0] + range[1], 0.06, 1e-12, "sphere: symmetric about its centre");
  PetscCall(SetupClose(&s));
  PetscCall(SetupPackOn(PETSC_COMM_SELF,
                        "-spacing 0.1 -box_lower 0,0,-1 -box_upper 1,1,1 -box_xmin symmetry -box_ymin symmetry -bodies "
                        "b -b_shape sphere -b_radius 0.4 -packing_jitter 0",
                        &s));
  {
    PetscInt  quarter;
    PetscReal low[2];

    PetscCall(Fluid(&s, 0, &quarter, low));
    CHECK_CLOSE(4 * quarter, count, 0, "sphere: a quarter between symmetry planes has a quarter of the particles");
    CHECK_CLOSE(low[0], 0.05, 1e-12, "sphere: half a spacing from the symmetry plane");
  }
  PetscCall(SetupClose(&s));

  PetscCall(SetupPackOn(PETSC_COMM_SELF,
                        "-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 1,1 -box_x wall -box_y wall "
                        "-box_ymax_velocity 1,0 -bodies b -packing_jitter 0.1",
                        &s));
  CHECK_CLOSE(s.global, 16 * 16, 0, "tank in two dimensions: fluid and walls");
  PetscCall(Fluid(&s, 2, &count, range));
  CHECK_CLOSE(count, 100, 0, "tank in two dimensions: fluid");
  CHECK(range[0] == 0 && range[1] == 0, "tank in two dimensions: everything in the plane");
  PetscCall(CheckWalls(&s, "tank"));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define DROP                                                                                                           \
  "-spacing 0.25e-3 -box_lower -4e-3,-4e-3,-4e-3 -box_upper 4e-3,4e-3,4e-3 -bodies drop -drop_shape sphere "           \
  "-drop_radius 1.5e-3 -drop_density 1100 -packing_type poisson "

static PetscErrorCode TestPoisson(void)
{
  Setup       s, first, again;
  PetscReal   position;
  PetscInt    integers, count;
  PetscReal   range[2];
  PetscMPIInt rank;

  PetscFunctionBeginUser;
  PetscCall(SetupPackOn(PETSC_COMM_WORLD, DROP "-packing_cache \"\"", &s));
  PetscCall(Fluid(&s, 0, &count, range));
  CHECK_CLOSE(count, 4. / 3. * PETSC_PI * 216, 4, "drop: as many particles as fit its volume");
  CHECK(s.report.density_std <= 0.11 * 1.001, "drop: standard deviation of the density at most 0.11 kg/m3");
  CHECK(s.report.density_std > 0, "drop: a random packing");
  CHECK(s.report.smallest_distance >= 0.6, "drop: nobody closer than 0.6 spacings");
  CHECK(s.report.iterations > 0, "drop: TAO was at work");
  CHECK(range[0] > -1.5e-3 && range[1] < 1.5e-3, "drop: inside the sphere");
  PetscCall(SetupClose(&s));

  PetscCall(
    SetupPackOn(PETSC_COMM_WORLD, FILM "-packing_type poisson -packing_tolerance 1e-3 -packing_cache \"\"", &s));
  PetscCall(Fluid(&s, 2, &count, range));
  CHECK_CLOSE(count, 480, 1, "film: as many particles as fit its volume");
  CHECK(s.report.density_std <= 1.001, "film: standard deviation below -packing_tolerance, between walls and images");
  CHECK(s.report.smallest_distance >= 0.6, "film: nobody too close");
  CHECK(range[0] > 0 && range[1] < 0.5, "film: between floor and surface");
  PetscCall(SetupClose(&s));

  /* Trials of the line search that throw particles far out of the box are refused. */
  PetscCall(SetupPackOn(PETSC_COMM_WORLD,
                        FILM "-packing_type poisson -packing_cache \"\" -packing_tao_type cg -packing_tao_max_it 3 "
                             "-packing_tao_cg_delta_min 1e4 -packing_tao_cg_delta_max 1e4",
                        &s));
  PetscCall(Fluid(&s, 2, &count, range));
  CHECK_CLOSE(count, 480, 1, "film, steps too long: every particle is still there");
  CHECK(range[0] > 0 && range[1] < 0.5, "film, steps too long: between floor and surface");
  PetscCall(SetupClose(&s));

  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0) PetscCall(PetscRMTree(CACHE_FOLDER));
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  PetscCall(SetupPackOn(PETSC_COMM_WORLD, DROP "-packing_tolerance 2e-3 -packing_cache " CACHE_FOLDER, &first));
  CHECK(!first.report.cached && first.report.iterations > 0, "cache: the first run computes");
  PetscCall(SetupPackOn(PETSC_COMM_WORLD, DROP "-packing_tolerance 2e-3 -packing_cache " CACHE_FOLDER, &s));
  CHECK(s.report.cached && s.report.iterations == 0, "cache: the second run reads");
  CHECK(s.report.density_std <= 2.2 * 1.001, "cache: the density is as good");
  PetscCall(SetupPackOn(PETSC_COMM_SELF, DROP "-packing_tolerance 2e-3 -packing_cache " CACHE_FOLDER, &again));
  PetscCall(Compare(&first, &again, &position, &integers));
  CHECK_CLOSE(position, 0, 0, "cache: the same positions to the last bit");
  CHECK_CLOSE(integers, 0, 0, "cache: the same ids and bodies");
  PetscCall(SetupClose(&again));
  PetscCall(SetupClose(&first));
  PetscCall(SetupClose(&s));
  PetscCall(SetupPackOn(PETSC_COMM_WORLD,
                        DROP "-packing_tolerance 2e-3 -packing_tao_ls_max_funcs 29 -packing_cache " CACHE_FOLDER, &s));
  CHECK(!s.report.cached, "cache: not read with another option of TAO");
  PetscCall(SetupClose(&s));
  PetscCall(SetupPackOn(PETSC_COMM_WORLD, DROP "-packing_tolerance 3e-3 -packing_seed 5 -packing_cache \"\"", &s));
  CHECK(!s.report.cached, "cache: not read when switched off");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The key of the cache for what these options pack. */
static PetscErrorCode FindKey(const char options[], const char change[], unsigned long long *key)
{
  char    all[1024];
  Setup   s;
  Packing packing;

  PetscFunctionBeginUser;
  PetscCall(PetscSNPrintf(all, sizeof(all), "%s%s", options, change));
  PetscCall(SetupOpenOn(PETSC_COMM_WORLD, all, &s));
  PetscCall(PackingCreate(s.cloud, &packing));
  PetscCall(PackingSetFromOptions(packing));
  if (s.domain->graded) PetscCall(GradedSetUp(packing));
  PetscCall(PackingHash(packing, "", key));
  PetscCall(PackingDestroy(&packing));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whatever a packing depends on gives it another key in the cache, one thing changed at a time, and no two the same. */
static PetscErrorCode TestKeys(void)
{
  static const char *const kinds[] = {"", "-packing_type poisson ", "-spacing_coarse 0.09 -fine c -c_lower 0.3,0.2 "},
                           *bodies = "-dimension 2 -spacing 0.05 -box_lower 0,0 -box_upper 1,1 -box_x wall -box_ymin "
                                     "wall -bodies a,b -a_lower 0,0 -a_upper 1,0.5 -b_shape sphere -b_radius 0.15 "
                                     "-b_center 0.5,0.7 ",
                           *changes[] = {"",
                                         "-spacing 0.04",
                                         "-box_upper 1,1.1",
                                         "-box_upper 1.1,1",
                                         "-box_lower 0,-0.1",
                                         "-box_lower -0.1,0",
                                         "-box_ymax wall",
                                         "-box_ymin symmetry",
                                         "-box_xmin symmetry",
                                         "-box_x periodic",
                                         "-a_upper 1,0.45",
                                         "-a_lower 0,0.05",
                                         "-a_lower 0.1,0",
                                         "-b_radius 0.16",
                                         "-b_center 0.5,0.71",
                                         "-b_center 0.51,0.7",
                                         "-b_shape box -b_lower 0.35,0.55 -b_upper 0.65,0.85",
                                         "-bodies b,a",
                                         "-kernel_type wendland_c2",
                                         "-kernel_ratio 1.25",
                                         "-packing_seed 2",
                                         "-packing_tao_gatol 1e-3",
                                         "-packing_tao_gatol 2e-3",
                                         "-packing_tao_max_it 9"},
                           *solids[]  = {"", "-s_upper 0.9,0.81", "-s_lower 0.79,0.6",
                                         "-s_shape sphere -s_center 0.8,0.7 "
                                          "-s_radius 0.1",
                                         "-solids s,t -t_lower 0,0.9 -t_upper 0.2,1"},
                           *grading[] = {"",
                                         "-spacing_coarse 0.07",
                                         "-spacing_growth 0.2",
                                         "-c_lower 0.4,0.2",
                                         "-c_lower 0.3,0.3",
                                         "-fine c,d -d_lower 0,0 -d_upper 0.1,0.1"};
  unsigned long long key[64], again;
  char               options[1024], name[128];

  PetscFunctionBeginUser;
  for (size_t kind = 0; kind < PETSC_STATIC_ARRAY_LENGTH(kinds) + 2; kind++) {
    const PetscBool          solid  = (PetscBool)(kind == 3);
    const char *const *const change = solid ? solids : kind == 4 ? grading : changes;
    const size_t             count  = solid       ? PETSC_STATIC_ARRAY_LENGTH(solids)
                                      : kind == 4 ? PETSC_STATIC_ARRAY_LENGTH(grading)
                                                  : PETSC_STATIC_ARRAY_LENGTH(changes);

    PetscCall(PetscSNPrintf(options, sizeof(options), "%s%s%s", bodies,
                            kinds[solid       ? 0
                                  : kind == 4 ? 2
                                              : kind],
                            solid ? "-solids s -s_lower 0.8,0.6 -s_upper 0.9,0.8 " : ""));
    for (size_t k = 0; k < count; k++) {
      size_t same = k;

      PetscCall(FindKey(options, change[k], &key[k]));
      for (size_t other = 0; other < k; other++)
        if (key[other] == key[k]) same = other;
      PetscCall(PetscSNPrintf(name, sizeof(name), "key %d: %s beside %s", (int)kind, change[k], change[same]));
      CHECK(same == k, name);
    }
    PetscCall(FindKey(options, "-packing_cache elsewhere", &again));
    CHECK(again == key[0], "key: the same wherever it is kept");
    if (kind > 0 && kind < 3) CHECK(again != key[63], "key: another for each kind");
    key[63] = again;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The tolerance of a Poisson packing is in its key, too: the cache is not read. */
static PetscErrorCode TestKeysOfPoisson(void)
{
  static const char *const changes[] = {"", "", "-packing_tolerance 6e-3"};
  char                     options[512];

  PetscFunctionBeginUser;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(changes); k++) {
    Setup s;

    PetscCall(
      PetscSNPrintf(options, sizeof(options),
                    "-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 1,1 -box_x periodic -box_ymin wall "
                    "-bodies a -a_upper 1,0.5 -packing_type poisson -packing_tolerance 5e-3 -packing_cache %s %s",
                    CACHE_FOLDER, changes[k]));
    PetscCall(SetupPackOn(PETSC_COMM_WORLD, options, &s));
    CHECK(s.report.cached == (k == 1), k == 1 ? "cache: read again" : k ? changes[k] : "cache: new");
    PetscCall(SetupClose(&s));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(LogRegister());
  PetscCall(TestLattice());
  PetscCall(TestRanks("film", FILM "-packing_seed 3"));
  PetscCall(TestRanks("two bodies", "-spacing 0.1 -box_lower -1,-1,-1 -box_upper 1,1,1.5 -box_zmin wall -box_xmin "
                                    "symmetry -bodies film,drop -film_shape box "
                                    "-film_lower -1,-1,-1 -film_upper 1,1,-0.5 -drop_shape sphere -drop_radius 0.5 "
                                    "-drop_center 0,0,0.2"));
  PetscCall(TestRanks("solids", FILM "-solids a,b -a_upper 0.4,0.5,0.7 -b_lower 0.5,0.1,0.2 -b_upper 0.9,0.7,1.8"));
  PetscCall(TestRanks("rings", "-dimension axisymmetric -spacing 0.1 -box_lower 0,-1 -box_upper 2,1 -box_ymin wall "
                               "-bodies a,b -a_upper 2,-0.5 -b_shape sphere -b_radius 0.4"));
  PetscCall(TestRanks("graded", "-dimension 2 -spacing 0.05 -spacing_coarse 0.1 -fine core -core_shape sphere "
                                "-core_radius 0.4 -box_lower -1,-1 -box_upper 1,1 -box_x wall -box_ymin wall "
                                "-bodies a -a_upper 1,0.5"));
  PetscCall(TestPoisson());
  PetscCall(TestKeysOfPoisson());
  PetscCall(TestKeys());
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
