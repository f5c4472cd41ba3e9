/* Neighbour lists and ghosts against all pairs of particles and explicit images; the signs of vectors and tensors in
   images. Runs on any number of ranks. */
#include "../../src/stepper/stepper_impl.h"
#include "setup.h"
#include "check.h"

#define PARTICLES 700
#define STEPS     14
#define STEP_WIDTH                                                                                                     \
  0.3                   /* largest motion a step and component, spacings: the slack of one spacing lasts a step or two \
                         */
#define SAME_PLACE 1e-9 /* spacings: two positions of one particle, computed twice */

/* All particles of all ranks, by place in the gathered list. */
typedef struct {
  PetscInt   n;
  PetscInt  *id;
  PetscReal *x; /* [n][3] m */
} World;

/* One image of one particle: how each direction is changed. */
typedef struct {
  PetscReal sign[DIM], offset[DIM];
} Image;

static PetscErrorCode WorldGather(Cloud cloud, World *world)
{
  PetscMPIInt size, mine = (PetscMPIInt)cloud->n_owned, *count, *start;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(PetscMalloc2(size, &count, size + 1, &start));
  PetscCallMPI(MPI_Allgather(&mine, 1, MPI_INT, count, 1, MPI_INT, PETSC_COMM_WORLD));
  start[0] = 0;
  for (PetscMPIInt r = 0; r < size; r++) start[r + 1] = start[r] + count[r];
  world->n = start[size];
  PetscCall(PetscMalloc2(world->n, &world->id, DIM * world->n, &world->x));
  PetscCallMPI(
    MPI_Allgatherv(cloud->integer[INT_ID], mine, MPIU_INT, world->id, count, start, MPIU_INT, PETSC_COMM_WORLD));
  for (PetscMPIInt r = 0; r < size; r++) {
    count[r] *= DIM;
    start[r] *= DIM;
  }
  PetscCallMPI(MPI_Allgatherv(cloud->field[FIELD_POSITION], DIM * mine, MPIU_REAL, world->x, count, start, MPIU_REAL,
                              PETSC_COMM_WORLD));
  PetscCall(PetscFree2(count, start));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The images of one direction: itself, then what the faces add. */
static PetscInt ImagesOf(Domain domain, PetscInt d, PetscReal sign[4], PetscReal offset[4])
{
  const PetscReal lower = domain->lower[d], upper = domain->upper[d];
  PetscInt        n = 1;

  sign[0]   = 1;
  offset[0] = 0;
  if (d >= domain->dim) return 1;
  if (domain->face[d][0] == FACE_PERIODIC) {
    sign[1] = sign[2] = 1;
    offset[1]         = upper - lower;
    offset[2]         = lower - upper;
    return 3;
  }
  for (PetscInt side = 0; side < 2; side++)
    if (domain->face[d][side] == FACE_SYMMETRY) {
      sign[n]     = -1;
      offset[n++] = 2 * (side ? upper : lower);
    }
  return n;
}

static PetscInt AllImages(Domain domain, Image image[64])
{
  PetscReal sign[DIM][4], offset[DIM][4];
  PetscInt  n[DIM], count = 0;

  for (PetscInt d = 0; d < DIM; d++) n[d] = ImagesOf(domain, d, sign[d], offset[d]);
  for (PetscInt k = 0; k < n[2]; k++)
    for (PetscInt j = 0; j < n[1]; j++)
      for (PetscInt i = 0; i < n[0]; i++) {
        const PetscInt at[DIM] = {i, j, k};

        for (PetscInt d = 0; d < DIM; d++) {
          image[count].sign[d]   = sign[d][at[d]];
          image[count].offset[d] = offset[d][at[d]];
        }
        count++;
      }
  return count;
}

/* What one particle must see, and what it sees: id and place. */
typedef struct {
  PetscInt  id;
  PetscReal x[DIM];
} Seen;

static int CompareSeen(const void *left, const void *right)
{
  const Seen *a = (const Seen *)left, *b = (const Seen *)right;

  if (a->id != b->id) return a->id < b->id ? -1 : 1;
  for (PetscInt d = 0; d < DIM; d++)
    if (PetscAbsReal(a->x[d] - b->x[d]) > 1e-6) return a->x[d] < b->x[d] ? -1 : 1;
  return 0;
}

static PetscInt BruteForce(Domain domain, const World *world, const PetscReal p[DIM], PetscReal radius, PetscInt own,
                           Seen seen[])
{
  Image          image[64];
  const PetscInt images = AllImages(domain, image);
  PetscInt       count  = 0;

  for (PetscInt b = 0; b < world->n; b++)
    for (PetscInt m = 0; m < images; m++) {
      PetscReal r2 = 0, x[DIM];

      for (PetscInt d = 0; d < DIM; d++) {
        x[d] = image[m].sign[d] * world->x[DIM * b + d] + image[m].offset[d];
        r2 += PetscSqr(p[d] - x[d]);
      }
      if (r2 >= radius * radius || (m == 0 && world->id[b] == own)) continue;
      seen[count].id = world->id[b];
      for (PetscInt d = 0; d < DIM; d++) seen[count].x[d] = x[d];
      count++;
    }
  qsort(seen, (size_t)count, sizeof(*seen), CompareSeen);
  return count;
}

static PetscBool SameSets(PetscInt n, const Seen a[], PetscInt m, const Seen b[], PetscReal spacing)
{
  if (n != m) return PETSC_FALSE;
  for (PetscInt k = 0; k < n; k++) {
    if (a[k].id != b[k].id) return PETSC_FALSE;
    for (PetscInt d = 0; d < DIM; d++)
      if (!(PetscAbsReal(a[k].x[d] - b[k].x[d]) <= SAME_PLACE * spacing)) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* Wrong rows: lists within the kernel's support, and all points within the cloud's reach. */
static PetscErrorCode CompareLists(Cloud cloud, PetscInt wrong[2], PetscInt *pairs)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], spacing = cloud->domain->spacing;
  const PetscReal  radius[2] = {KernelSupport(cloud->kernel), cloud->reach};
  World            world;
  Seen            *must, *does;

  PetscFunctionBegin;
  PetscCall(WorldGather(cloud, &world));
  PetscCall(PetscMalloc2(27 * world.n, &must, cloud->n_total, &does));
  wrong[0] = wrong[1] = *pairs = 0;
  for (PetscInt a = 0; a < cloud->n_owned; a++)
    for (PetscInt kind = 0; kind < 2; kind++) {
      const PetscInt id    = cloud->integer[INT_ID][a];
      const PetscInt n     = BruteForce(cloud->domain, &world, x + DIM * a, radius[kind], id, must);
      const PetscInt tries = kind ? cloud->n_total : cloud->first[a + 1] - cloud->first[a];
      PetscInt       m     = 0;

      for (PetscInt k = 0; k < tries; k++) {
        const PetscInt b  = kind ? k : cloud->list[cloud->first[a] + k];
        PetscReal      r2 = 0;

        for (PetscInt d = 0; d < DIM; d++) r2 += PetscSqr(x[DIM * a + d] - x[DIM * b + d]);
        if (kind && (b == a || r2 >= radius[kind] * radius[kind])) continue;
        does[m].id = cloud->integer[INT_ID][b];
        for (PetscInt d = 0; d < DIM; d++) does[m].x[d] = x[DIM * b + d];
        m++;
      }
      qsort(does, (size_t)m, sizeof(*does), CompareSeen);
      wrong[kind] += !SameSets(n, must, m, does, spacing);
      if (!kind) *pairs += n;
    }
  PetscCall(PetscFree2(must, does));
  PetscCall(PetscFree2(world.id, world.x));
  for (PetscInt kind = 0; kind < 2; kind++) wrong[kind] = (PetscInt)SetupSum((PetscReal)wrong[kind]);
  *pairs = (PetscInt)SetupSum((PetscReal)*pairs);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Largest errors of the factors that stand beside the lists: of F from KernelGradient, relative, and of its Laplacian
 * form, in units; the sums of the latter that are wrong count too. */
static void FactorErrors(Cloud cloud, PetscReal *relative, PetscReal *units)
{
  const PetscReal *x = cloud->field[FIELD_POSITION], eta2 = PetscSqr(ETA_OVER_H * KernelSmoothingLength(cloud->kernel));
  PetscReal        scale_w, scale_f, inverse_h2, unit, error = 0, coded = 0, largest = 0;

  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  unit = scale_f * cloud->laplacian_unit;
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    PetscInt sum = 0;

    for (PetscInt k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
      PetscReal r2 = 0, F;

      for (PetscInt d = 0; d < DIM; d++) r2 += PetscSqr(x[DIM * a + d] - x[DIM * cloud->list[k] + d]);
      KernelGradient(cloud->kernel, 1, &r2, &F);
      largest = PetscMax(largest, PetscAbsReal(F));
      error   = PetscMax(error, PetscAbsReal(scale_f * cloud->slope[k] - F));
      if (cloud->integer[INT_LAYER][a] && cloud->integer[INT_LAYER][cloud->list[k]]) F = 0; /* has no weight */
      coded = PetscMax(coded, PetscAbsReal(cloud->laplacian[k] + F * r2 / (r2 + eta2) / unit));
      sum += cloud->laplacian[k];
    }
    coded += sum != cloud->laplacian_sum[a];
  }
  *relative = SetupMax(error) / SetupMax(largest);
  *units    = SetupMax(coded);
}

/* A number that belongs to particle and component. */
static PetscReal Mark(PetscInt id, PetscInt component)
{
  return 1 + RandomUnit(7, (unsigned long long)(16 * id + component));
}

/* Ghosts whose scalar, vector, axial vector, tensor or point differs from its owner's under the image the ghost's
 * position tells. */
static PetscErrorCode CompareParity(Cloud cloud, PetscInt *wrong)
{
  const PetscInt *id   = cloud->integer[INT_ID];
  const PetscReal tiny = SAME_PLACE * cloud->domain->spacing;
  PetscReal      *scalar, *vector, *axial, *tensor, *point = cloud->field[FIELD_POSITION_NEW];
  Image           image[64];
  const PetscInt  images = AllImages(cloud->domain, image);
  World           world;

  PetscFunctionBegin;
  PetscCall(CloudGetWork(cloud, 1, &scalar));
  PetscCall(CloudGetWork(cloud, DIM, &vector));
  PetscCall(CloudGetWork(cloud, DIM, &axial));
  PetscCall(CloudGetWork(cloud, 6, &tensor));
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    scalar[a] = a < cloud->n_owned ? Mark(id[a], 0) : NAN;
    for (PetscInt d = 0; d < DIM; d++) vector[DIM * a + d] = a < cloud->n_owned ? Mark(id[a], 1 + d) : NAN;
    for (PetscInt d = 0; d < DIM; d++) point[DIM * a + d] = a < cloud->n_owned ? Mark(id[a], 4 + d) : NAN;
    for (PetscInt d = 0; d < DIM; d++) axial[DIM * a + d] = a < cloud->n_owned ? Mark(id[a], 13 + d) : NAN;
    for (PetscInt c = 0; c < 6; c++) tensor[6 * a + c] = a < cloud->n_owned ? Mark(id[a], 7 + c) : NAN;
  }
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, scalar));
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, vector));
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_AXIAL, axial));
  PetscCall(CloudUpdateArray(cloud, 6, PARITY_TENSOR, tensor));
  PetscCall(CloudUpdate(cloud, FIELD_POSITION_NEW));
  PetscCall(WorldGather(cloud, &world));
  *wrong = 0;
  for (PetscInt g = cloud->n_owned; g < cloud->n_total; g++) {
    const PetscReal *p     = cloud->field[FIELD_POSITION] + DIM * g;
    const Image     *found = NULL;

    for (PetscInt b = 0; b < world.n && !found; b++)
      for (PetscInt m = 0; m < images && !found && world.id[b] == id[g]; m++) {
        PetscBool here = PETSC_TRUE;

        for (PetscInt d = 0; d < DIM; d++)
          here = (PetscBool)(here &&
                             PetscAbsReal(image[m].sign[d] * world.x[DIM * b + d] + image[m].offset[d] - p[d]) <= tiny);
        if (here) found = &image[m];
      }
    if (!found)
      (*wrong)++;
    else {
      const PetscReal *s    = found->sign;
      PetscReal        miss = PetscAbsReal(scalar[g] - Mark(id[g], 0));

      for (PetscInt d = 0; d < DIM; d++) {
        miss += PetscAbsReal(vector[DIM * g + d] - s[d] * Mark(id[g], 1 + d));
        miss += PetscAbsReal(axial[DIM * g + d] - s[0] * s[1] * s[2] * s[d] * Mark(id[g], 13 + d));
        miss += PetscAbsReal(point[DIM * g + d] - s[d] * Mark(id[g], 4 + d) - found->offset[d]);
        miss += PetscAbsReal(tensor[6 * g + d] - Mark(id[g], 7 + d));
      }
      miss += PetscAbsReal(tensor[6 * g + 3] - s[0] * s[1] * Mark(id[g], 10));
      miss += PetscAbsReal(tensor[6 * g + 4] - s[0] * s[2] * Mark(id[g], 11));
      miss += PetscAbsReal(tensor[6 * g + 5] - s[1] * s[2] * Mark(id[g], 12));
      *wrong += !(miss < 1e-12);
    }
  }
  PetscCall(PetscFree2(world.id, world.x));
  PetscCall(CloudRestoreWork(cloud, &tensor));
  PetscCall(CloudRestoreWork(cloud, &axial));
  PetscCall(CloudRestoreWork(cloud, &vector));
  PetscCall(CloudRestoreWork(cloud, &scalar));
  *wrong = (PetscInt)SetupSum((PetscReal)*wrong);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A random walk of the fluid, as a step of the program goes: begin, move, ghosts and lists anew, commit. */
static PetscErrorCode Walk(Setup *s, PetscInt step, PetscInt *lost)
{
  static const Edge *const none[]  = {NULL};
  Cloud                    cloud   = s->cloud;
  struct _p_Stepper        stepper = {.cloud = cloud, .edges = none};
  PetscReal                width   = STEP_WIDTH * s->domain->spacing;

  PetscFunctionBegin;
  PetscCall(CloudBegin(cloud));
  PetscCall(CloudSearch(cloud, NULL, NULL));
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    for (PetscInt d = 0; d < s->domain->dim; d++) {
      const unsigned long long place = (unsigned long long)(DIM * cloud->integer[INT_ID][a] + d);
      /* a drift of each particle's own, so that some travel far and cross faces and ranks */
      const PetscReal drift = 2 * RandomUnit(3, place) - 1,
                      noise = 2 * RandomUnit(100 + (unsigned long long)step, place) - 1;

      cloud->field[FIELD_POSITION][DIM * a + d] += width * (0.7 * drift + 0.3 * noise);
    }
  PetscCall(WallGuard(&stepper, 0.25 * s->domain->spacing, cloud->field[FIELD_POSITION], cloud->field[FIELD_VELOCITY]));
  PetscCall(CloudMoved(cloud));
  PetscCall(CloudSearch(cloud, NULL, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestBox(const char label[], PetscInt dim, const char faces[], PetscInt layers)
{
  const char box3[]            = "-box_lower -2,-3,0 -box_upper 7,7,8 ",
             box2[]            = "-dimension 2 -box_lower -7,-8 -box_upper 18,19 ";
  PetscReal x[DIM * PARTICLES] = {0}, relative, units;
  PetscInt  wrong[2], bad = 0, far = 0, signs = 0, pairs, total = 0, lost = 0, n;
  Setup     s;
  char      options[512], name[96];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof(options), "%s %s -spacing 1 -bodies a -a_tension 1 -sort_interval 5 %s",
                          dim == 3 ? box3 : box2, dim == 3 ? "-tension_ratio 1.2" : "-tension_ratio 2", faces));
  for (PetscInt k = 0; k < DIM * PARTICLES; k++) {
    const PetscInt  d     = k % DIM;
    const PetscReal low[] = {-2, -3, 0}, width[] = {9, 10, 8}, low2[] = {-7, -8, 0}, width2[] = {25, 27, 0};

    x[k] = RandomUnit(11, (unsigned long long)k);
    x[k] = dim == 3 ? low[d] + width[d] * x[k] : low2[d] + width2[d] * x[k];
  }
  PetscCall(SetupFill(options, PARTICLES, x, layers, &s));
  PetscCall(CompareLists(s.cloud, wrong, &pairs));
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_lists", label));
  CHECK(wrong[0] == 0 && pairs > 10 * PARTICLES, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_factors", label));
  FactorErrors(s.cloud, &relative, &units);
  CHECK_CLOSE(relative, 0, 2e-6, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_laplacian", label));
  CHECK_CLOSE(units, 0, 0.6, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_reach", label));
  CHECK(wrong[1] == 0, name);
  PetscCall(ParticlesGlobalSize(s.particles, &n));
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_walls", label));
  CHECK((n > PARTICLES) == (layers > 0), name);
  for (PetscInt step = 0; step < STEPS; step++) {
    PetscInt parity = 0;

    PetscCall(Walk(&s, step, &lost));
    PetscCall(CompareLists(s.cloud, wrong, &pairs));
    PetscCall(CompareParity(s.cloud, &parity));
    bad += wrong[0];
    far += wrong[1];
    signs += parity;
    total += pairs;
    PetscCall(CloudCommit(s.cloud, &lost, NULL));
  }
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_lists_moving", label));
  CHECK_CLOSE(bad, 0, 0, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_reach_moving", label));
  CHECK_CLOSE(far, 0, 0, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_parity", label));
  CHECK_CLOSE(signs, 0, 0, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_moved", label));
  CHECK(total > 0 && s.cloud->halo_builds > STEPS / 3, name);
  PetscCall(ParticlesGlobalSize(s.particles, &pairs));
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_lost", label)); /* through open faces only, and counted */
  CHECK(n - lost == pairs && (lost > 0) == (strstr(faces, "open") != NULL), name);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Two particles further apart than the box is long, which the search compares in one go: it must neither overflow (the
   sanitizers see that) nor take them for neighbours. */
static PetscErrorCode TestFarApart(void)
{
  const PetscReal x[] = {1900, 5, 0, -900, 5, 0};
  PetscInt        pairs;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(SetupFill("-dimension 2 -box_lower 0,0 -box_upper 1000,10 -spacing 1 -bodies a", 2, x, 0, &s));
  pairs = (PetscInt)SetupSum((PetscReal)s.cloud->first[s.cloud->n_owned]);
  CHECK(pairs == 0, "far_apart");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Particles that go to other ranks in many portions all arrive. */
static PetscErrorCode TestPortions(void)
{
  PetscReal      x[DIM * PARTICLES] = {0};
  PetscInt       wrong              = 0, bodies;
  PetscMPIInt    rank;
  ParticleArrays arrays;
  Setup          s;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(SetupOpen("-dimension 2 -box_lower 0,0 -box_upper 25,27 -spacing 1 -bodies a", &s));
  PetscCall(ParticlesAppend(s.particles, rank ? 0 : PARTICLES));
  for (PetscInt k = 0; k < DIM * PARTICLES; k++) x[k] = k % DIM < 2 ? 25 * RandomUnit(12, (unsigned long long)k) : 0;
  PetscCall(ParticlesOpen(s.particles, &arrays));
  PetscCall(PetscArraycpy(arrays.real[FIELD_POSITION], x, DIM * arrays.n));
  for (PetscInt a = 0; a < arrays.n; a++) arrays.integer[INT_BODY][a] = a;
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(ParticlesSetPortion(s.particles, 17));
  PetscCall(ParticlesMigrate(s.particles));
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscReal *at = arrays.real[FIELD_POSITION] + DIM * a, *was = x + DIM * arrays.integer[INT_BODY][a];

    wrong += s.domain->cell_rank[DomainCell(s.domain, at)] != rank || at[0] != was[0] || at[1] != was[1];
  }
  PetscCall(ParticlesClose(s.particles, &arrays));
  PetscCall(ParticlesGlobalSize(s.particles, &bodies));
  CHECK(SetupSum((PetscReal)wrong) == 0 && bodies == PARTICLES, "migration_in_portions");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(TestBox("open_3d", 3, "-box_x open", 0));
  PetscCall(TestBox("periodic_3d", 3, "-box_x periodic -box_y periodic -box_z periodic", 0));
  PetscCall(TestBox("symmetry_3d", 3, "-box_x symmetry -box_y symmetry -box_z symmetry", 0));
  PetscCall(TestBox("mixed_3d", 3, "-box_x periodic -box_y symmetry -box_zmin wall -box_zmax open", 3));
  PetscCall(TestBox("corner_3d", 3, "-box_xmin wall -box_xmax symmetry -box_ymin wall -box_ymax open -box_z wall", 3));
  PetscCall(TestBox("open_2d", 2, "-box_x open", 0));
  PetscCall(TestBox("periodic_2d", 2, "-box_x periodic -box_y periodic", 0));
  PetscCall(TestBox("symmetry_2d", 2, "-box_x symmetry -box_y symmetry", 0));
  PetscCall(TestBox("mixed_2d", 2, "-box_x periodic -box_ymin wall -box_ymax symmetry", 3));
  PetscCall(TestFarApart());
  PetscCall(TestPortions());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
