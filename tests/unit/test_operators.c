/* Operators on lattices and on disordered particles: density, moments, flags of the free surface, divergence,
   viscosity, surface tension. Lengths in spacings. Runs on any number of ranks. */
#include "setup.h"
#include "check.h"
#include "tension/tension_impl.h"

#define MAX_POINTS 8000
#define OPEN       "-spacing 1 -box_lower -20,-20,-20 -box_upper 20,20,20 -bodies a "
#define OPEN_2D    "-dimension 2 -spacing 1 -box_lower -20,-20 -box_upper 20,20 -bodies a "
#define FILM       "-spacing 1 -box_lower 0,0,-20 -box_upper 10,10,20 -box_x periodic -box_y periodic -bodies a "

static PetscReal points[DIM * MAX_POINTS];

/* A block of nx ny nz lattice points about the origin, without the one nearest to 'hole' (NULL: full), each moved by up
   to 'jitter' a component; returns their number. */
static PetscInt Block(PetscInt nx, PetscInt ny, PetscInt nz, PetscReal jitter, const PetscReal *hole)
{
  PetscInt n = 0;

  for (PetscInt k = 0; k < nz; k++)
    for (PetscInt j = 0; j < ny; j++)
      for (PetscInt i = 0; i < nx; i++) {
        const PetscReal x[DIM] = {i - 0.5 * (nx - 1), j - 0.5 * (ny - 1), k - 0.5 * (nz - 1)};

        if (hole && PetscAbsReal(x[0] - hole[0]) + PetscAbsReal(x[1] - hole[1]) + PetscAbsReal(x[2] - hole[2]) < 0.5)
          continue;
        for (PetscInt d = 0; d < DIM; d++) {
          const PetscReal noise = 2 * RandomUnit(5, (unsigned long long)(DIM * n + d)) - 1;

          points[DIM * n + d] = x[d] + (nz > 1 || d < 2 ? jitter * noise : 0);
        }
        n++;
      }
  return n;
}

/* A field of the particle nearest to a point, over all ranks; which: 0 lambda, 1 density/rest, 2 flag. */
static PetscReal PlaceAt(Setup *s, PetscReal x, PetscReal y, PetscReal z, PetscInt which)
{
  const PetscReal p[DIM]  = {x, y, z};
  PetscReal       nearest = PETSC_MAX_REAL, value = 0, all;
  Cloud           cloud = s->cloud;

  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *q  = cloud->field[FIELD_POSITION] + DIM * a;
    PetscReal        r2 = 0;

    for (PetscInt d = 0; d < DIM; d++) r2 += PetscSqr(q[d] - p[d]);
    if (r2 >= nearest) continue;
    nearest = r2;
    value   = which == 0   ? cloud->field[FIELD_LAMBDA][a]
              : which == 1 ? cloud->field[FIELD_DENSITY][a] / cloud->rest_density[a]
                           : (PetscReal)cloud->integer[INT_SURFACE][a];
  }
  all = -SetupMax(-nearest);
  return SetupMax(nearest == all ? value : -PETSC_MAX_REAL);
}

static PetscErrorCode MakeBlock(const char options[], PetscInt nx, PetscInt ny, PetscInt nz, const PetscReal *hole,
                                Setup *s)
{
  PetscFunctionBegin;
  PetscCall(SetupFill(options, Block(nx, ny, nz, 0, hole), points, 0, s));
  PetscCall(SetupMoments(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Periodic films: the lattice starts half a spacing inside the box. */
static PetscErrorCode MakeFilm(PetscInt layers, Setup *s)
{
  const PetscInt n = Block(10, 10, layers, 0, NULL);

  PetscFunctionBegin;
  for (PetscInt k = 0; k < n; k++)
    for (PetscInt d = 0; d < 2; d++) points[DIM * k + d] += 5;
  PetscCall(SetupFill(FILM, n, points, 0, s));
  PetscCall(SetupMoments(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Smallest eigenvalues on a cubic lattice, cubic spline, h = 1.3 spacings: Marrone et al. 2010's lambda, computed once
   by an independent program; and the summed densities of a flat surface. */
static PetscErrorCode TestLatticeTable(void)
{
  const PetscReal center[DIM] = {0, 0, 0};
  Setup           s;

  PetscFunctionBegin;
  PetscCall(MakeBlock(OPEN, 9, 9, 9, NULL, &s));
  CHECK_CLOSE(PlaceAt(&s, 0, 0, 0, 0), 0.993, 6e-4, "lambda_inside");
  CHECK_CLOSE(PlaceAt(&s, 0, 0, 0, 1), 0.9973, 6e-5, "density_inside");
  CHECK_CLOSE(PlaceAt(&s, 0, 0, 4, 0), 0.497, 6e-4, "lambda_top");
  CHECK_CLOSE(PlaceAt(&s, 0, 0, 3, 0), 0.904, 6e-4, "lambda_second");
  CHECK_CLOSE(PlaceAt(&s, 0, 4, 4, 0), 0.276, 6e-4, "lambda_edge");
  CHECK_CLOSE(PlaceAt(&s, -4, 4, 4, 0), 0.212, 6e-4, "lambda_corner");
  PetscCall(SetupClose(&s));
  PetscCall(MakeBlock(OPEN, 9, 9, 9, center, &s));
  CHECK_CLOSE(PlaceAt(&s, 1, 0, 0, 0), 0.885, 6e-4, "lambda_vacancy");
  CHECK_CLOSE(PlaceAt(&s, 1, 0, 0, 2), 0, 0, "flag_vacancy");
  PetscCall(SetupClose(&s));
  PetscCall(MakeBlock(OPEN, 2, 2, 2, NULL, &s));
  CHECK_CLOSE(PlaceAt(&s, 0.5, 0.5, 0.5, 0), 0.158, 6e-4, "lambda_2x2x2");
  CHECK_CLOSE(PlaceAt(&s, 0.5, 0.5, 0.5, 2), 1, 0, "flag_2x2x2");
  PetscCall(SetupClose(&s));
  PetscCall(MakeBlock(OPEN, 3, 3, 3, NULL, &s));
  CHECK_CLOSE(PlaceAt(&s, 0, 0, 0, 0), 0.783, 6e-4, "lambda_3x3x3_center");
  PetscCall(SetupClose(&s));
  PetscCall(MakeBlock(OPEN, 1, 1, 1, NULL, &s));
  CHECK_CLOSE(PlaceAt(&s, 0, 0, 0, 0), 0, 0, "lambda_alone");
  CHECK_CLOSE(PlaceAt(&s, 0, 0, 0, 2), 1, 0, "flag_alone");
  CHECK_CLOSE(PlaceAt(&s, 0, 0, 0, 1), 1 / (PETSC_PI * 1.3 * 1.3 * 1.3), 1e-14, "density_alone");
  PetscCall(SetupClose(&s));
  PetscCall(MakeBlock(OPEN, 2, 1, 1, NULL, &s));
  CHECK_CLOSE(PlaceAt(&s, 0.5, 0, 0, 0), 0, 1e-8, "lambda_pair");
  CHECK_CLOSE(PlaceAt(&s, 0.5, 0, 0, 2), 1, 0, "flag_pair");
  PetscCall(SetupClose(&s));
  PetscCall(MakeFilm(1, &s));
  CHECK_CLOSE(PlaceAt(&s, 5.5, 5.5, 0, 0), 0, 1e-14, "lambda_monolayer");
  CHECK_CLOSE(PlaceAt(&s, 5.5, 5.5, 0, 2), 1, 0, "flag_monolayer");
  PetscCall(SetupClose(&s));
  PetscCall(MakeFilm(2, &s));
  CHECK_CLOSE(PlaceAt(&s, 5.5, 5.5, 0.5, 0), 0.407, 6e-4, "lambda_bilayer");
  CHECK_CLOSE(PlaceAt(&s, 0.5, 9.5, -0.5, 2), 1, 0, "flag_bilayer");
  PetscCall(SetupClose(&s));
  PetscCall(MakeFilm(3, &s));
  CHECK_CLOSE(PlaceAt(&s, 5.5, 5.5, 0, 0), 0.814, 6e-4, "lambda_trilayer_mid");
  CHECK_CLOSE(PlaceAt(&s, 5.5, 5.5, 0, 2), 2, 0, "flag_trilayer_mid_is_near");
  CHECK_CLOSE(PlaceAt(&s, 5.5, 5.5, 1, 2), 1, 0, "flag_trilayer_top");
  PetscCall(SetupClose(&s));
  PetscCall(MakeFilm(7, &s));
  CHECK_CLOSE(PlaceAt(&s, 5.5, 5.5, 3, 1), 0.768, 6e-4, "density_top");
  CHECK_CLOSE(PlaceAt(&s, 5.5, 5.5, 2, 1), 0.990, 6e-4, "density_second");
  CHECK_CLOSE(PlaceAt(&s, 5.5, 5.5, 1, 1), 0.997, 6e-4, "density_third");
  CHECK_CLOSE(PlaceAt(&s, 0.5, 5.5, 3, 0), 0.497, 6e-4, "lambda_top_at_periodic_face");
  CHECK_CLOSE(PlaceAt(&s, 0.5, 5.5, 2, 2), 2, 0, "flag_second_is_near");
  CHECK_CLOSE(PlaceAt(&s, 0.5, 5.5, 0, 2), 0, 0, "flag_film_inside");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Counts flags: *missed of those with depth < 'outer' that are not on the surface, *false_ones of those with depth >=
   'inner' that are; depth in spacings below the outermost layer of a box (half widths) or a ball (radius in half[0],
   others 0). */
static PetscErrorCode CountFlags(Setup *s, const PetscReal half[DIM], PetscReal outer, PetscReal inner,
                                 PetscInt *missed, PetscInt *false_ones)
{
  Cloud cloud = s->cloud;

  PetscFunctionBegin;
  *missed = *false_ones = 0;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *x     = cloud->field[FIELD_POSITION] + DIM * a;
    PetscReal        depth = half[0] - Norm(x);

    if (half[1] > 0) {
      depth = PETSC_MAX_REAL;
      for (PetscInt d = 0; d < s->domain->dim; d++) depth = PetscMin(depth, half[d] - PetscAbsReal(x[d]));
    }
    *missed += depth < outer && cloud->integer[INT_SURFACE][a] != 1;
    *false_ones += depth >= inner && cloud->integer[INT_SURFACE][a] == 1;
  }
  *missed     = (PetscInt)SetupSum((PetscReal)*missed);
  *false_ones = (PetscInt)SetupSum((PetscReal)*false_ones);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestFlags(void)
{
  const PetscReal cube[DIM] = {6, 6, 6}, block[DIM] = {9, 9, 9}, square[DIM] = {12, 12, 0}, ball[DIM] = {7, 0, 0};
  PetscInt        missed, false_ones, n;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(MakeBlock(OPEN, 13, 13, 13, NULL, &s));
  PetscCall(CountFlags(&s, cube, 0.5, 0.5, &missed, &false_ones));
  CHECK(missed == 0, "cube_outer_layer_flagged");
  CHECK(false_ones == 0, "cube_inside_not_flagged");
  PetscCall(SetupClose(&s));
  PetscCall(SetupFill(OPEN_2D, Block(25, 25, 1, 0, NULL), points, 0, &s));
  PetscCall(SetupMoments(&s));
  PetscCall(CountFlags(&s, square, 0.5, 0.5, &missed, &false_ones));
  CHECK(missed == 0, "square_outer_layer_flagged");
  CHECK(false_ones == 0, "square_inside_not_flagged");
  PetscCall(SetupClose(&s));
  /* jitter of a quarter spacing: no flag more than a layer and the jitter below the surface */
  PetscCall(SetupFill(OPEN, Block(19, 19, 19, 0.25, NULL), points, 0, &s));
  PetscCall(SetupMoments(&s));
  PetscCall(CountFlags(&s, block, -1, 1.3, &missed, &false_ones));
  CHECK_CLOSE(false_ones, 0, 0, "jittered_bulk_not_flagged");
  PetscCall(CountFlags(&s, block, 0.3, 9, &missed, &false_ones));
  CHECK(missed < 0.1 * 6 * 19 * 19, "jittered_surface_flagged"); /* 7 %: those a step behind their neighbours */
  PetscCall(SetupClose(&s));
  PetscCall(SetupPack("-spacing 1 -box_lower -20,-20,-20 -box_upper 20,20,20 -packing_jitter 0 "
                      "-bodies a -a_shape sphere -a_radius 7",
                      &s));
  PetscCall(SetupMoments(&s));
  PetscCall(CountFlags(&s, ball, -1, 1.75, &missed, &false_ones));
  CHECK_CLOSE(false_ones, 0, 0, "sphere_inside_not_flagged");
  PetscCall(CountFlags(&s, ball, 0.5, 9, &missed, &false_ones));
  CHECK_CLOSE(missed, 0, 0, "sphere_outside_flagged");
  PetscCall(SetupClose(&s));
  /* a full box without a free surface: nothing is flagged, also next to walls, periodic and symmetry faces */
  PetscCall(SetupPack("-spacing 1 -box_lower 0,0,0 -box_upper 8,9,10 -box_x periodic -box_y symmetry -box_z wall "
                      "-packing_jitter 0.2 -bodies a",
                      &s));
  PetscCall(SetupMoments(&s));
  n = 0;
  for (PetscInt a = 0; a < s.cloud->n_rows; a++) n += s.cloud->integer[INT_SURFACE][a] != 0;
  CHECK_CLOSE(SetupSum((PetscReal)n), 0, 0, "full_box_not_flagged");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Linear velocities on disordered particles with a free surface: the corrected divergence is exact wherever B is not
   the identity, and so is the one half a second ahead; the plain one is not. */
static PetscErrorCode CheckDivergence(const char options[], PetscInt nz, const char label[])
{
  const PetscReal A[DIM][DIM] = {{0.7, -1.1, 2}, {0.3, 0.2, -0.6}, {1.7, 0.4, 0.8}};
  const PetscInt  dim         = nz > 1 ? 3 : 2;
  const PetscReal trace       = A[0][0] + A[1][1] + (dim == 3 ? A[2][2] : 0);
  PetscReal      *div, worst = 0, plain = 0, ahead = 0, later = trace;
  PetscInt        count = 0;
  char            name[96];
  Cloud           cloud;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(SetupFill(options, Block(11, 11, nz, 0.25, NULL), points, 0, &s));
  PetscCall(SetupMoments(&s));
  cloud = s.cloud;
  for (PetscInt a = 0; a < cloud->n_total; a++)
    for (PetscInt d = 0; d < dim; d++) {
      const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a;

      cloud->field[FIELD_VELOCITY][DIM * a + d] = A[d][0] * x[0] + A[d][1] * x[1] + A[d][2] * x[2] + 3;
    }
  PetscCall(PetscMalloc1(cloud->n_owned, &div));
  PetscCall(OperatorsDivergence(cloud, cloud->field[FIELD_VELOCITY], PETSC_TRUE, 0, div, NULL, NULL));
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    if (cloud->field[FIELD_LAMBDA][a] > MOMENT_MINIMUM) {
      worst = PetscMax(worst, PetscAbsReal(div[a] - trace));
      count++;
    }
  PetscCall(OperatorsDivergence(cloud, cloud->field[FIELD_VELOCITY], PETSC_FALSE, 0, div, NULL, NULL));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) plain = PetscMax(plain, PetscAbsReal(div[a] - trace));
  PetscCall(OperatorsDivergence(cloud, cloud->field[FIELD_VELOCITY], PETSC_TRUE, 0.5, div, NULL, NULL));
  for (PetscInt i = 0; i < dim; i++)
    for (PetscInt j = 0; j < dim; j++) later -= 0.5 * A[i][j] * A[j][i];
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    if (cloud->field[FIELD_LAMBDA][a] > MOMENT_MINIMUM) ahead = PetscMax(ahead, PetscAbsReal(div[a] - later));
  PetscCall(PetscFree(div));
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_ahead", label));
  CHECK_CLOSE(SetupMax(ahead), 0, 1e-10, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_exact", label));
  CHECK_CLOSE(SetupMax(worst), 0, 1e-10, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_uncorrected_is_not", label));
  CHECK(SetupMax(plain) > 0.1 && SetupSum((PetscReal)count) > 100, name);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Liquid in disorder that slides along a wall as one has no divergence, and neither have the wall's particles; liquid
   that falls on it has. The velocity gradient that is kept for the shifting does not know of the wall. */
static PetscErrorCode TestSliding(void)
{
  const char options[] = "-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 2,2 -box_x periodic -box_ymin wall "
                         "-bodies a -a_upper 2,1 -packing_jitter 0.25 ";
  Setup      s;
  PetscReal *div, *gradient, slide = 0, fall = 0, walls = 0;

  PetscFunctionBegin;
  PetscCall(SetupPack(options, &s));
  PetscCall(SetupMoments(&s));
  PetscCall(PetscMalloc1(s.cloud->n_owned, &div));
  for (PetscInt direction = 0; direction < 2; direction++) {
    for (PetscInt a = 0; a < s.cloud->n_total; a++)
      for (PetscInt d = 0; d < DIM; d++)
        s.cloud->field[FIELD_VELOCITY][DIM * a + d] = s.cloud->integer[INT_LAYER][a] == 0 && d == direction;
    PetscCall(OperatorsDivergence(s.cloud, s.cloud->field[FIELD_VELOCITY], PETSC_TRUE, 0, div,
                                  s.cloud->field[FIELD_VELOCITY_GRADIENT], NULL));
    for (PetscInt a = 0; a < s.cloud->n_owned; a++)
      *(direction ? &fall : &slide) = PetscMax(direction ? fall : slide, PetscAbsReal(div[a]));
  }
  PetscCall(PetscMalloc1(DIM * DIM * s.cloud->n_fluid, &gradient));
  PetscCall(PetscArraycpy(gradient, s.cloud->field[FIELD_VELOCITY_GRADIENT], DIM * DIM * s.cloud->n_fluid));
  for (PetscInt a = 0; a < s.cloud->n_total; a++)
    if (s.cloud->integer[INT_LAYER][a]) s.cloud->field[FIELD_VELOCITY][DIM * a] = 5;
  PetscCall(OperatorsDivergence(s.cloud, s.cloud->field[FIELD_VELOCITY], PETSC_TRUE, 0, NULL,
                                s.cloud->field[FIELD_VELOCITY_GRADIENT], NULL));
  for (PetscInt k = 0; k < DIM * DIM * s.cloud->n_fluid; k++)
    walls = PetscMax(walls, PetscAbsReal(s.cloud->field[FIELD_VELOCITY_GRADIENT][k] - gradient[k]));
  PetscCall(PetscFree(gradient));
  PetscCall(PetscFree(div));
  CHECK_CLOSE(SetupMax(walls), 0, 1e-10, "walls_have_no_part_in_the_gradient");
  CHECK_CLOSE(SetupMax(slide), 0, 1e-5, "sliding_along_a_wall_has_no_divergence");
  CHECK(SetupMax(fall) > 1, "leaving_a_wall_has");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Velocity n (t.r)^2, n and t normal to each other: nu lap v = 2 nu n. Returns the mean n.a over 2 nu, far from
 * surfaces. */
static PetscErrorCode ShearResponse(Setup *s, const PetscReal n[DIM], const PetscReal t[DIM], PetscReal nu,
                                    PetscReal *response)
{
  Cloud     cloud = s->cloud;
  PetscReal sum = 0, count = 0;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_total; a++)
    for (PetscInt d = 0; d < DIM; d++)
      cloud->field[FIELD_VELOCITY][DIM * a + d] = n[d] * PetscSqr(Dot(t, cloud->field[FIELD_POSITION] + DIM * a));
  PetscCall(PetscArrayzero(cloud->field[FIELD_ACCELERATION], DIM * cloud->n_owned));
  PetscCall(OperatorsViscosity(cloud, &(Viscosity){.form = VISCOSITY_MOMENT}, cloud->rest_density));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a;

    if (PetscAbsReal(x[0]) > 4 || PetscAbsReal(x[1]) > 4 || PetscAbsReal(x[2]) > 4) continue;
    sum += Dot(n, cloud->field[FIELD_ACCELERATION] + DIM * a);
    count += 1;
  }
  *response = SetupSum(sum) / SetupSum(count) / (2 * nu);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Shear along the lattice and at 45 degrees to it. A lattice of 80 (20) neighbours is nearly isotropic in
   VISCOSITY_MOMENT; in Eq. (1) the operator is 11 % (14 %) low along it, and across it as much high. */
static PetscErrorCode CheckViscosity(const char options[], PetscInt dim, PetscReal jitter, PetscReal tol,
                                     const char label[])
{
  const PetscReal x[DIM] = {1, 0, 0}, y[DIM] = {0, 1, 0}, c = PETSC_SQRT2 / 2, up[DIM] = {c, c, 0},
                  down[DIM] = {c, -c, 0};
  const PetscReal nu        = 0.5 / 250; /* of the options */
  PetscReal       along, across, difference = 0;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(SetupFill(options, Block(15, 15, dim == 3 ? 15 : 1, jitter, NULL), points, 0, &s));
  PetscCall(SetupMoments(&s));
  PetscCall(ShearResponse(&s, x, y, nu, &along));
  PetscCall(ShearResponse(&s, up, down, nu, &across));
  if (getenv("TEST_VERBOSE")) printf("%s: along %g, across %g\n", label, along, across);
  CHECK_CLOSE(along, 1, tol, label);
  CHECK_CLOSE(across, 1, tol, label);
  PetscCall(SetupTakenAlong(s.cloud, &(Viscosity){.form = VISCOSITY_MOMENT}, &difference));
  CHECK_CLOSE(difference, 0, 1e-6, "viscosity_taken_along");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Largest viscous acceleration of a linear shear flow over a wall, its velocity zero at the wall's face, within the
   kernel's reach of the wall; in units of nu times the shear over a spacing. */
static PetscErrorCode WallShear(Cloud cloud, const Viscosity *viscosity, PetscReal nu, PetscReal *largest)
{
  const PetscReal *x = cloud->field[FIELD_POSITION];

  PetscFunctionBegin;
  *largest = 0;
  PetscCall(PetscArrayzero(cloud->field[FIELD_ACCELERATION], DIM * cloud->n_owned));
  PetscCall(OperatorsViscosity(cloud, viscosity, cloud->rest_density));
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    if (x[DIM * a + 2] < 4) *largest = PetscMax(*largest, PetscAbsReal(cloud->field[FIELD_ACCELERATION][DIM * a]) / nu);
  *largest = SetupMax(*largest);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestNoSlip(void)
{
  const char above[] =
    "-spacing 1 -box_upper 12,12,12 -box_x periodic -box_y periodic -bodies a -a_lower 0,0,0 -a_upper "
    "12,12,12 -a_density 250 -a_viscosity 0.5 -packing_jitter 0 ";
  const char *const floors[] = {"-box_lower 0,0,0 -box_zmin wall",
                                "-box_lower 0,0,-6 -solids floor -floor_lower 0,0,-6 -floor_upper 12,12,0"};
  const PetscReal   nu       = 0.5 / 250;
  char              options[512];
  PetscReal         rest, straight, difference = 0;
  Setup             s;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 6; k++) {
    Viscosity viscosity = {.form = (ViscosityForm)(k % 3)};

    PetscCall(PetscSNPrintf(options, sizeof(options), "%s%s", above, floors[k / 3]));
    PetscCall(SetupPack(options, &s));
    PetscCall(SetupMoments(&s));
    for (PetscInt a = 0; a < s.cloud->n_owned; a++)
      s.cloud->field[FIELD_VELOCITY][DIM * a] =
        s.cloud->integer[INT_LAYER][a] ? 0 : s.cloud->field[FIELD_POSITION][DIM * a + 2];
    PetscCall(CloudUpdate(s.cloud, FIELD_VELOCITY));
    PetscCall(WallShear(s.cloud, &viscosity, nu, &rest));
    OperatorsNoSlip(s.cloud, &viscosity);
    PetscCall(WallShear(s.cloud, &viscosity, nu, &straight));
    CHECK(rest > 0.3, "dummies_at_rest_let_the_first_layer_slide");
    CHECK(straight < 0.003, "a_linear_shear_flow_feels_no_force_at_a_wall");
    if (viscosity.form == VISCOSITY_MOMENT) {
      PetscCall(SetupTakenAlong(s.cloud, &viscosity, &difference));
      CHECK_CLOSE(difference, 0, 1e-5, "viscosity_taken_along_walls");
    }
    PetscCall(SetupClose(&s));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* |sum of m a| over sum of |m a| for the fluid. */
static PetscReal Imbalance(Cloud cloud)
{
  PetscReal total[DIM] = {0, 0, 0}, size = 0;

  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *f = cloud->field[FIELD_ACCELERATION] + DIM * a, mass = cloud->volume[a] * cloud->rest_density[a];

    for (PetscInt d = 0; d < DIM; d++) total[d] += mass * f[d];
    size += mass * Norm(f);
  }
  for (PetscInt d = 0; d < DIM; d++) total[d] = SetupSum(total[d]);
  return Norm(total) / SetupSum(size);
}

static PetscErrorCode TestViscosity(void)
{
  const char two[] = "-spacing 1 -box_lower -9,-9,-9 -box_upper 9,9,9 -bodies a,b -a_upper 9,9,0 -b_lower -9,-9,0 "
                     "-b_density 700 -b_viscosity 3 -packing_jitter 0.2";
  Cloud      cloud;
  Setup      s;

  PetscFunctionBegin;
  PetscCall(CheckViscosity(OPEN "-a_density 250 -a_viscosity 0.5", 3, 0, 0.03, "viscosity_3d"));
  PetscCall(CheckViscosity(OPEN_2D "-a_density 250 -a_viscosity 0.5", 2, 0, 0.06, "viscosity_2d"));
  PetscCall(CheckViscosity(OPEN "-a_density 250 -a_viscosity 0.5", 3, 0.1, 0.05, "viscosity_3d_disordered"));
  /* two liquids, random velocities, no outside: forces cancel in pairs */
  PetscCall(SetupPack(two, &s));
  PetscCall(SetupMoments(&s));
  cloud = s.cloud;
  for (PetscInt a = 0; a < cloud->n_owned; a++)
    for (PetscInt d = 0; d < DIM; d++)
      cloud->field[FIELD_VELOCITY][DIM * a + d] =
        RandomUnit(9, (unsigned long long)(DIM * cloud->integer[INT_ID][a] + d));
  PetscCall(CloudUpdate(cloud, FIELD_VELOCITY));
  PetscCall(PetscArrayzero(cloud->field[FIELD_ACCELERATION], DIM * cloud->n_owned));
  PetscCall(OperatorsViscosity(cloud, &(Viscosity){.form = VISCOSITY_MOMENT}, cloud->field[FIELD_DENSITY]));
  CHECK_CLOSE(Imbalance(cloud), 0, 1e-12, "viscosity_conserves_momentum");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A sheet in the plane, 'layers' particles thick, that stretches with the rate E: what its viscosity takes over 4 mu
   E^2 V, the exact value (Trouton's ratio in the plane), far from its ends; and by how much the linear operator of an
   implicit step and the viscosity that OperatorsMoments takes along differ from it, over the largest. */
static PetscErrorCode Sheet(PetscInt layers, PetscReal *ratio, PetscReal *implicit, PetscReal *along)
{
  const Viscosity  viscosity = {.form = VISCOSITY_MOMENT};
  const PetscReal  E = 0.3, mu = 0.5;
  PetscReal       *pair, *out, most = 0, different = 0, loss = 0, volume = 0;
  const PetscReal *x;
  Setup            s;
  Cloud            cloud;

  PetscFunctionBegin;
  PetscCall(SetupFill(OPEN_2D "-a_density 250 -a_viscosity 0.5", Block(35, layers, 1, 0, NULL), points, 0, &s));
  PetscCall(SetupMoments(&s));
  cloud = s.cloud;
  x     = cloud->field[FIELD_POSITION];
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    PetscReal *v = cloud->field[FIELD_VELOCITY] + DIM * a;

    v[0] = E * x[DIM * a];
    v[1] = -E * x[DIM * a + 1];
    v[2] = 0;
  }
  PetscCall(PetscArrayzero(cloud->field[FIELD_ACCELERATION], DIM * cloud->n_owned));
  PetscCall(OperatorsViscosity(cloud, &viscosity, cloud->rest_density));
  PetscCall(PetscMalloc2(OperatorsViscosityRoom(cloud), &pair, DIM * cloud->n_owned, &out));
  PetscCall(OperatorsViscosityPairs(cloud, &viscosity, cloud->rest_density, pair));
  PetscCall(OperatorsViscosityApply(cloud, &viscosity, pair, cloud->field[FIELD_VELOCITY], out));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    for (PetscInt d = 0; d < DIM; d++) {
      most      = PetscMax(most, PetscAbsReal(out[DIM * a + d]));
      different = PetscMax(different, PetscAbsReal(out[DIM * a + d] - cloud->field[FIELD_ACCELERATION][DIM * a + d]));
    }
    if (PetscAbsReal(x[DIM * a]) > 10) continue;
    volume += cloud->volume[a];
    for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) { /* half of what each pair takes */
      const PetscInt  b      = cloud->list[k];
      const PetscReal r[DIM] = {x[DIM * a] - x[DIM * b], x[DIM * a + 1] - x[DIM * b + 1], 0};

      loss -= 0.5 * cloud->volume[a] * cloud->rest_density[a] * pair[k] * PetscSqr(E * (r[0] * r[0] - r[1] * r[1]));
    }
  }
  *ratio    = SetupSum(loss) / SetupSum(volume) / (4 * mu * E * E);
  *implicit = SetupMax(different) / SetupMax(most);
  PetscCall(PetscFree2(pair, out));
  PetscCall(SetupTakenAlong(cloud, &viscosity, along));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestSheets(void)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < 4; k++) {
    const PetscInt layers[] = {1, 2, 3, 10};
    PetscReal      ratio = 0, implicit = 0, along = 0;
    char           name[64];

    PetscCall(Sheet(layers[k], &ratio, &implicit, &along));
    PetscCall(PetscSNPrintf(name, sizeof(name), "sheet_of_%" PetscInt_FMT "_resists_with_its_viscosity", layers[k]));
    CHECK_CLOSE(ratio, 1, 0.1, name);
    PetscCall(PetscSNPrintf(name, sizeof(name), "sheet_of_%" PetscInt_FMT "_explicit_is_implicit", layers[k]));
    CHECK_CLOSE(implicit, 0, 1e-5, name);
    PetscCall(PetscSNPrintf(name, sizeof(name), "sheet_of_%" PetscInt_FMT "_taken_along", layers[k]));
    CHECK_CLOSE(along, 0, 1e-5, name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sum of m a . r over the fluid. */
static PetscReal Virial(Cloud cloud)
{
  PetscReal sum = 0;

  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    sum += cloud->volume[a] * cloud->rest_density[a] *
           Dot(cloud->field[FIELD_ACCELERATION] + DIM * a, cloud->field[FIELD_POSITION] + DIM * a);
  return SetupSum(sum);
}

static PetscErrorCode TestTension(void)
{
  PetscReal inside = 0, pull = 0, force = 0, *g;
  PetscInt  n;
  Cloud     cloud;
  Setup     s;

  PetscFunctionBegin;
  PetscCall(SetupPack("-spacing 1 -box_lower -14,-14,-14 -box_upper 14,14,14 -packing_jitter 0.1 "
                      "-bodies a -a_shape sphere -a_radius 9 -a_tension 2 -tension_type cahn_hilliard",
                      &s));
  PetscCall(SetupMoments(&s));
  PetscCall(PetscArrayzero(s.cloud->field[FIELD_ACCELERATION], DIM * s.cloud->n_owned));
  PetscCall(TensionApply(s.tension, s.cloud));
  CHECK_CLOSE(Imbalance(s.cloud), 0, 1e-7, "tension_conserves_momentum"); /* sums in single precision */
  /* A sharp interface has - sigma (2/R) R 4 pi R^2 = -8 pi sigma R^2. This layer lies 2H deep inside the drop and its
     sums are cut at the surface: 0.571 of it here. The number guards kappa and H. */
  CHECK_CLOSE(Virial(s.cloud) / (-8 * PETSC_PI * 2 * 81), 0.571, 0.02, "tension_of_a_drop");
  PetscCall(SetupClose(&s));
  /* A film of 24 layers. S is flat and the same all along: it pulls nowhere. It vanishes beyond 2H = 4.55 of a surface.
   */
  n = Block(12, 12, 24, 0, NULL);
  for (PetscInt k = 0; k < n; k++)
    for (PetscInt d = 0; d < 2; d++) points[DIM * k + d] += 6;
  PetscCall(SetupFill("-spacing 1 -box_lower 0,0,-20 -box_upper 12,12,20 -box_x periodic -box_y periodic -bodies a "
                      "-a_tension 2 -tension_type cahn_hilliard",
                      n, points, 0, &s));
  PetscCall(SetupMoments(&s));
  cloud = s.cloud;
  PetscCall(PetscArrayzero(cloud->field[FIELD_ACCELERATION], DIM * cloud->n_owned));
  PetscCall(TensionApply(s.tension, cloud));
  PetscCall(PetscMalloc1(DIM * cloud->n_owned, &g));
  PetscCall(CahnHilliardGradient(s.tension, cloud, g));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *f    = cloud->field[FIELD_ACCELERATION] + DIM * a,
                    depth = 11.5 - PetscAbsReal(cloud->field[FIELD_POSITION][DIM * a + 2]);

    force = PetscMax(force, Norm(f));
    if (depth < 0.5) pull = PetscMax(pull, PetscSqr(g[DIM * a + 1]) + PetscSqr(g[DIM * a + 2])); /* S_xx */
    if (depth > 4.6) inside = PetscMax(inside, Dot(g + DIM * a, g + DIM * a));
  }
  PetscCall(PetscFree(g));
  CHECK(SetupMax(pull) > 0.1 * 2 / 2.275, "tension_film_pulls"); /* sigma/H */
  CHECK_CLOSE(SetupMax(inside), 0, 1e-12, "tension_film_inside");
  CHECK_CLOSE(SetupMax(force) / (2. / 1000), 0, 1e-6, "tension_film_no_force"); /* of sigma/(rho d0^2), in float */
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Against roots known in closed form. */
static void TestEigenvalue(void)
{
  const PetscReal diagonal[6] = {3, 1, 2, 0, 0, 0}, plane[6] = {2, 2, -9, 1, 7, 7}, ball[6] = {4, 4, 4, 0, 0, 0};
  const PetscReal rank_one[6] = {1, 4, 9, 2, 3, 6}, ring[6] = {2, 2, 2, 1, 1, 1}; /* eigenvalues 0, 0, 14 and 1, 1, 4 */

  CHECK_CLOSE(SymmetricSmallestEigenvalue(3, diagonal), 1, 1e-14, "eigenvalue_diagonal");
  CHECK_CLOSE(SymmetricSmallestEigenvalue(2, plane), 1, 1e-14, "eigenvalue_2d_takes_the_block");
  CHECK_CLOSE(SymmetricSmallestEigenvalue(3, ball), 4, 1e-14, "eigenvalue_triple");
  CHECK_CLOSE(SymmetricSmallestEigenvalue(3, rank_one), 0, 1e-6, "eigenvalue_rank_one");
  CHECK_CLOSE(SymmetricSmallestEigenvalue(3, ring), 1, 1e-7, "eigenvalue_double");
}

/* Two liquids beside each other on a floor: behind each is its own density, in whichever order they are named. */
static PetscErrorCode TestWallDensities(void)
{
  static const char *const orders[] = {"a,b", "b,a"};

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2; k++) {
    char      options[512];
    PetscReal wrong = 0;
    PetscInt  seen  = 0;
    Setup     s;

    PetscCall(PetscSNPrintf(options, sizeof(options),
                            "-dimension 2 -spacing 0.05 -packing_jitter 0 -box_lower 0,0 -box_upper 2,1 -box_ymin wall "
                            "-bodies %s -a_upper 1,0.5 -b_lower 1,0 -b_upper 2,0.5 -b_density 600",
                            orders[k]));
    PetscCall(SetupPack(options, &s));
    PetscCall(SetupMoments(&s));
    for (PetscInt a = s.cloud->n_fluid; a < s.cloud->n_owned; a++) {
      const PetscReal x = s.cloud->field[FIELD_POSITION][DIM * a], due = x < 1 ? 1000 : 600;

      if (s.cloud->integer[INT_LAYER][a] != 1 || PetscAbsReal(x - 1) < 0.2) continue;
      seen++;
      wrong = PetscMax(wrong, PetscAbsReal(s.cloud->rest_density[a] / due - 1));
    }
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &seen, 1, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD));
    CHECK(seen > 20, "particles_of_a_wall");
    CHECK_CLOSE(wrong, 0, 1e-12, "a_wall_has_the_density_of_the_liquid_before_it");
    PetscCall(SetupClose(&s));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The force (N) along y of a pressure c + y on a ball in disordered liquid; with 'stands' the ball is cut off below and
   stands on the floor, at y = 0. seed: of the packing. */
static PetscErrorCode BallForce(const char space[], PetscBool stands, PetscReal c, int seed, PetscReal *force)
{
  char       options[1024];
  PetscReal *on, sum = 0;
  Setup      s;

  PetscFunctionBegin;
  PetscCall(
    PetscSNPrintf(options, sizeof(options),
                  "-packing_jitter 0.1 -spacing 1 -box_lower 0,0 -box_upper 24,40 -bodies a -box_xmax wall -box_y "
                  "wall -solids ball -ball_shape sphere -ball_radius 7 -ball_center 0,%g -packing_seed %d %s",
                  stands ? 3.5 : 20, seed, space));
  PetscCall(SetupPackOn(PETSC_COMM_WORLD, options, &s));
  PetscCall(SetupMoments(&s));
  for (PetscInt a = 0; a < s.cloud->n_total; a++)
    s.cloud->field[FIELD_PRESSURE][a] = c + s.cloud->field[FIELD_POSITION][DIM * a + 1];
  PetscCall(CloudGetWork(s.cloud, DIM, &on));
  PetscCall(OperatorsWallForce(s.cloud, PETSC_TRUE, on));
  for (PetscInt b = s.cloud->n_fluid; b < s.cloud->n_total; b++)
    if (s.cloud->integer[INT_BODY][b] <= BODY_SOLID) sum += on[DIM * b + 1];
  PetscCall(CloudRestoreWork(s.cloud, &on));
  *force = SetupSum(sum);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The level of the pressure does not push a solid that liquid surrounds; it holds down one that stands on the floor. */
static PetscErrorCode TestLevel(const char space[], PetscReal volume, PetscReal base, const char label[])
{
  const int packings = 20;
  PetscReal low, high, slope = 0;
  char      name[64];

  PetscFunctionBegin;
  for (int seed = packings; seed > 0; seed--) {
    PetscCall(BallForce(space, PETSC_FALSE, 0, seed, &low));
    slope += low / volume / packings;
  }
  PetscCall(BallForce(space, PETSC_FALSE, 1e5, 1, &high));
  PetscCall(PetscSNPrintf(name, sizeof(name), "slope_on_a_ball_%s", label));
  CHECK_CLOSE(slope, -1, 0.06, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "level_on_a_ball_%s", label));
  CHECK_CLOSE((high - low) / volume, 0, 1e-6, name);
  PetscCall(BallForce(space, PETSC_TRUE, 0, 1, &low));
  PetscCall(BallForce(space, PETSC_TRUE, 1e5, 1, &high));
  PetscCall(PetscSNPrintf(name, sizeof(name), "level_on_a_ball_that_stands_%s", label));
  CHECK_CLOSE((high - low) / 1e5 / base, -1, 0.1, name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  TestEigenvalue();
  PetscCall(TestSliding());
  PetscCall(TestLatticeTable());
  PetscCall(TestFlags());
  PetscCall(CheckDivergence(OPEN, 11, "divergence_3d"));
  PetscCall(CheckDivergence(OPEN_2D, 1, "divergence_2d"));
  PetscCall(TestViscosity());
  PetscCall(TestSheets());
  PetscCall(TestNoSlip());
  PetscCall(TestWallDensities());
  PetscCall(TestTension());
  PetscCall(TestLevel("-dimension 2 -box_xmin symmetry", 0.5 * PETSC_PI * 49, 7 * PetscSqrtReal(0.75), "2d"));
  PetscCall(TestLevel("-dimension axisymmetric", 4 * PETSC_PI / 3 * 343, PETSC_PI * 0.75 * 49, "rings"));
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
