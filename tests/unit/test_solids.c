/* The dummy particles of solids: where liquid feels the faces of a solid, for any place and size. Liquid at half a
   spacing in front of a face has sum V W of the dummies there; a solid full of liquid would have the integral of W. The
   difference, over the slope of the integral, is how far the face that is felt is from that of the shape. */
#include "../../src/bodies/bodies_impl.h"
#include "check.h"
#include "setup.h"
#include <stdio.h>

#define CUBE    "output/test_solids.stl"
#define SPACING 0.1
#define FELT    0.05 /* spacings */
/* flat faces of a file are not layers of the lattice that the dummies start from: 0.08 here, turned 0.16 */
#define FELT_FILE   0.1
#define FELT_TURNED 0.2
#define FINE        5 /* cells of the integral in a spacing */
#define PLACES      4 /* in each direction, per spacing and a half */

#define WATER "-spacing 0.1 -solids s -bodies water -water_lower 1.8,1.8,1.8 -water_upper 2,2,2 -packing_cache '' "
#define FLAT  WATER "-dimension 2 -box_lower -2,-2 -box_upper 2,2 "
#define SPACE WATER "-dimension 3 -box_lower -2,-2,-2 -box_upper 2,2,2 "

/* sum V W at x over all dummies, and the integral of W over the solid at x and at y. */
static PetscReal SumDummies(const Setup *s, const PetscReal x[DIM])
{
  PetscReal sum = 0;

  for (PetscInt a = s->cloud->n_fluid; a < s->cloud->n_owned; a++) {
    const PetscReal *b = s->cloud->field[FIELD_POSITION] + DIM * a;
    PetscReal        r[DIM], r2, w, slope;

    if (s->cloud->integer[INT_BODY][a] > BODY_SOLID) continue;
    for (PetscInt d = 0; d < DIM; d++) r[d] = x[d] - b[d];
    DomainNearest(s->domain, r);
    r2 = Dot(r, r);
    KernelEvaluate(s->kernel, 1, &r2, &w, &slope);
    sum += s->cloud->volume[a] * w;
  }
  return SetupSum(sum);
}

static PetscReal Integral(const Setup *s, const PetscReal x[DIM])
{
  const PetscInt n          = (PetscInt)PetscCeilReal(KernelSupport(s->kernel) / SPACING) * FINE,
                 first[DIM] = {-n, -n, s->domain->dim == 3 ? -n : 0},
                 last[DIM]  = {n - 1, n - 1, s->domain->dim == 3 ? n - 1 : 0};
  PetscReal sum             = 0;
  PetscInt  at[DIM]         = {first[0], first[1], first[2]};

  do {
    PetscReal r[DIM] = {0, 0, 0}, y[DIM], r2, w, slope;

    for (PetscInt d = 0; d < s->domain->dim; d++) r[d] = (at[d] + 0.5) * SPACING / FINE;
    for (PetscInt d = 0; d < DIM; d++) y[d] = x[d] + r[d];
    DomainWrap(s->domain, y);
    r2 = Dot(r, r);
    KernelEvaluate(s->kernel, 1, &r2, &w, &slope);
    if (w > 0) sum += w * PetscMax(0, PetscMin(1, 0.5 - SceneSolidDistance(s->scene, y, NULL) * FINE / SPACING));
  } while (CellNext(first, last, at));
  return sum * s->domain->volume / PetscPowRealInt(FINE, (int)s->domain->dim);
}

/* How far a face is felt in front of the shape's around the place x, spacings. */
static PetscReal Felt(const Setup *s, const PetscReal x[DIM])
{
  const PetscReal step = 0.1 * SPACING;
  PetscReal       n[DIM], near[DIM], integral = Integral(s, x);

  SceneSolidNormal(s->scene, x, n);
  for (PetscInt d = 0; d < DIM; d++) near[d] = x[d] - step * n[d];
  return (SumDummies(s, x) - integral) / ((Integral(s, near) - integral) / 0.1);
}

/* The mean of what is felt on each of the sides of the solids, by the direction of the normal, in the middle of the box
   up to 'reach' (m); count: places. */
static PetscErrorCode Faces(const Setup *s, PetscReal reach, PetscReal felt[2 * DIM], PetscInt count[2 * DIM])
{
  const PetscInt dim = s->domain->dim, first[DIM] = {0, 0, 0};
  PetscInt       last[DIM] = {0, 0, 0}, at[DIM] = {0, 0, 0};

  PetscFunctionBegin;
  for (PetscInt f = 0; f < 2 * DIM; f++) felt[f] = count[f] = 0;
  for (PetscInt d = 0; d < dim; d++) last[d] = (PetscInt)(2 * reach / SPACING * PLACES / (dim == 3 ? 3 : 1.5));
  do {
    PetscReal x[DIM] = {0, 0, 0}, n[DIM];
    PetscInt  f      = 0;

    for (PetscInt d = 0; d < dim; d++) x[d] = -reach + (at[d] + 0.37) * 2 * reach / (last[d] + 1);
    DomainWrap(s->domain, x);
    if (PetscAbsReal(SceneSolidDistance(s->scene, x, NULL) - 0.5 * SPACING) > 0.4 * SPACING) continue;
    for (PetscInt k = 0; k < 3; k++) {
      const PetscReal off = SceneSolidDistance(s->scene, x, NULL) - 0.5 * SPACING;

      SceneSolidNormal(s->scene, x, n);
      for (PetscInt d = 0; d < DIM; d++) x[d] -= off * n[d];
    }
    for (PetscInt d = 1; d < dim; d++)
      if (PetscAbsReal(n[d]) > PetscAbsReal(n[f])) f = d;
    f = 2 * f + (n[f] > 0);
    felt[f] += Felt(s, x);
    count[f]++;
  } while (CellNext(first, last, at));
  for (PetscInt f = 0; f < 2 * DIM; f++) felt[f] /= PetscMax(1, count[f]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A cube as an STL file, turned by 'angle' (rad) about z. */
static PetscErrorCode WriteCube(const char path[], PetscReal half, PetscReal angle)
{
  static const int corner[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  FILE            *file;

  PetscFunctionBegin;
  PetscCall(PetscFOpen(PETSC_COMM_WORLD, path, "w", &file));
  PetscCall(PetscFPrintf(PETSC_COMM_WORLD, file, "solid cube\n"));
  for (PetscInt k = 0; k < 12; k++) {
    PetscCall(PetscFPrintf(PETSC_COMM_WORLD, file, "facet normal 0 0 0\nouter loop\n"));
    for (PetscInt c = 0; c < 3; c++) {
      const PetscReal x = corner[k][c] & 1 ? half : -half, y = corner[k][c] & 2 ? half : -half,
                      z = corner[k][c] & 4 ? half : -half, cosine = PetscCosReal(angle), sine = PetscSinReal(angle);

      PetscCall(PetscFPrintf(PETSC_COMM_WORLD, file, "vertex %.9g %.9g %.9g\n", (double)(cosine * x - sine * y),
                             (double)(sine * x + cosine * y), (double)z));
    }
    PetscCall(PetscFPrintf(PETSC_COMM_WORLD, file, "endloop\nendfacet\n"));
  }
  PetscCall(PetscFPrintf(PETSC_COMM_WORLD, file, "endsolid cube\n"));
  PetscCall(PetscFClose(PETSC_COMM_WORLD, file));
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks all sides of the solids against 'flat', what is felt of a flat face with lattices on both sides of it, for the
   sum over a lattice is no integral; within 'most' spacings. time: to which solids move, s. Returns the mean of all
   sides. */
static PetscErrorCode TestSceneAt(const char options[], PetscReal time, PetscReal most, PetscReal reach, PetscInt sides,
                                  PetscReal flat, const char name[], PetscReal *mean)
{
  PetscReal felt[2 * DIM], worst = 0, sum = 0;
  PetscInt  count[2 * DIM], seen = 0;
  char      label[128];
  Setup     s;

  PetscFunctionBegin;
  PetscCall(SetupPack(options, &s));
  if (time > 0) PetscCall(SolidsMove(s.cloud, 0, time, time));
  PetscCall(Faces(&s, reach, felt, count));
  for (PetscInt f = 0; f < 2 * DIM; f++) {
    if (!count[f]) continue;
    seen++;
    sum += felt[f];
    worst = PetscMax(worst, PetscAbsReal(felt[f] - flat));
  }
  *mean = sum / PetscMax(1, seen);
  PetscCall(PetscSNPrintf(label, sizeof(label), "felt_%s", name));
  CHECK_CLOSE(worst, 0, most, label);
  PetscCall(PetscSNPrintf(label, sizeof(label), "sides_%s", name));
  CHECK(seen == sides, label);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestScene(const char options[], PetscReal reach, PetscInt sides, PetscReal flat,
                                const char name[], PetscReal *mean)
{
  PetscFunctionBegin;
  PetscCall(TestSceneAt(options, 0, FELT, reach, sides, flat, name, mean));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Solids from a file, and those that have moved and turned, also free ones by their motion. */
static PetscErrorCode TestFurther(PetscReal flat, PetscReal flat_space)
{
  PetscReal other;

  PetscFunctionBegin;
  PetscCall(TestSceneAt(FLAT "-s_lower -0.63,-0.51 -s_upper 0.61,0.523 -s_velocity 0.11,0.037", 1, FELT, 1, 4, flat,
                        "moved", &other));
  PetscCall(TestSceneAt(FLAT "-s_lower -0.63,-0.51 -s_upper 0.61,0.523 -s_rotation_rate 0.6 -s_rotation_center 0,0", 1,
                        FELT, 1, 4, flat, "turned", &other));
  PetscCall(TestSceneAt(SPACE "-s_lower -0.43,-0.31,-0.38 -s_upper 0.41,0.323,0.4 -s_rotation_rate 0.4,0.2,0.3 "
                              "-s_rotation_center 0,0,0",
                        1, FELT, 0.6, 6, flat_space, "turned_cuboid", &other));
  for (PetscInt k = 0; k < 2; k++) {
    PetscCall(WriteCube(CUBE, 0.37, k ? 0.5 : 0));
    PetscCall(TestSceneAt(SPACE "-s_shape stl -s_file " CUBE, 0, k ? FELT_TURNED : FELT_FILE, 0.6, 6, flat_space,
                          k ? "turned_cube_of_a_file" : "cube_of_a_file", &other));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In the middle of a plate both faces are as far, and the normal is across it, as beside the middle. */
static PetscErrorCode TestPlate(const char options[], const char name[])
{
  Setup s;

  PetscFunctionBegin;
  PetscCall(SetupPack(options, &s));
  for (PetscInt k = 0; k < 3; k++) {
    const PetscReal x[DIM] = {0.07 * k, -0.7 * 0.07 * k, 0};
    PetscReal       n[DIM];

    SceneSolidNormal(s.scene, x, n);
    CHECK_CLOSE(PetscAbsReal((0.7 * n[0] + n[1]) / PetscSqrtReal(1.49)), 1, 1e-9, name);
  }
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscReal flat, flat_space, other;

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(TestScene(FLAT "-s_lower -0.6,-0.5 -s_upper 0.6,0.5", 1, 4, 0, "box", &flat));
  PetscCall(TestScene(FLAT "-s_lower -0.63,-0.51 -s_upper 0.61,0.523", 1, 4, flat, "box_broken", &other));
  PetscCall(TestScene(FLAT "-s_lower -0.65,-0.5 -s_upper 0.6,0.45", 1, 4, flat, "box_half", &other));
  PetscCall(TestScene(FLAT "-s_lower -0.9,-0.6 -s_upper 0.93,0.6 -s_holes h -h_lower -0.33,-0.2 -h_upper 0.28,2", 1, 4,
                      flat, "box_with_hole", &other));
  PetscCall(TestScene(FLAT "-s_shape sphere -s_radius 0.5", 1, 4, flat, "circle", &other));
  PetscCall(TestScene(FLAT "-s_shape sphere -s_radius 0.337 -s_center 0.04,0.013", 1, 4, flat, "circle_small", &other));
  PetscCall(TestScene(FLAT "-s_shape half_space -s_normal 0.3,1 -s_point 0,0.02", 1, 1, flat, "slope", &other));
  PetscCall(
    TestScene(FLAT "-box_x periodic -s_shape sphere -s_radius 0.52 -s_center 1.9,0", 3, 4, flat, "across", &other));
  PetscCall(TestScene(SPACE "-s_lower -0.4,-0.4,-0.4 -s_upper 0.4,0.4,0.4", 0.6, 6, flat, "cube", &flat_space));
  PetscCall(
    TestScene(SPACE "-s_lower -0.43,-0.31,-0.38 -s_upper 0.41,0.323,0.4", 0.6, 6, flat_space, "cuboid", &other));
  PetscCall(TestScene(SPACE "-s_shape sphere -s_radius 0.437", 0.6, 6, flat_space, "ball", &other));
  PetscCall(TestScene(SPACE "-s_shape cylinder -s_radius 0.43 -s_height 0.75", 0.6, 6, flat_space, "cylinder", &other));
  PetscCall(TestFurther(flat, flat_space));
  PetscCall(TestPlate(FLAT "-s_shape half_space -s_normal 0.7,1 -s_point 0,0.02 -s_holes h -h_shape half_space "
                           "-h_normal 0.7,1 -h_point 0,-0.02",
                      "middle_of_a_plate"));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
