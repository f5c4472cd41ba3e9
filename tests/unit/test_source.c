/* The sources of the pressure, its right-hand side, what the options of closure and gradient do: from fields that are
   set by hand, against the formulas. Lengths in spacings. Runs on any number of ranks. */
#include "setup.h"
#include "check.h"

#define DT 1e-3 /* s */
#define H  1.5  /* smoothing length; a lattice's sum of V W is 1.003 */
/* two liquids over each other on a floor, 900 and 600 kg/m3 */
#define POOL                                                                                                           \
  "-dimension 2 -spacing 1 -kernel_ratio 1.5 -box_lower 0,0 -box_upper 8,20 -box_x periodic -box_ymin wall "           \
  "-packing_jitter 0 -bodies "                                                                                         \
  "a,b -a_density 900 -a_upper 8,3 -b_lower 0,3 -b_upper 8,6 -b_density 600 "
/* an emitter that holds the left half of the pool and half a spacing */
#define HOSE "-bodies a,b,c -bodies_overlap -c_type emitter -c_lower 0,0 -c_upper 4,6 -c_velocity 1,0 -c_density 900 "
#define DROP                                                                                                           \
  "-dimension 2 -spacing 1 -kernel_ratio 1.5 -box_lower -9,-9 -box_upper 9,9 -packing_jitter 0.2 -bodies a -a_shape "  \
  "sphere -a_radius 6 "                                                                                                \
  "-a_density 900 -pressure_relaxation_time 1e30 -ksp_rtol 1e-9 -ksp_max_it 1000 "
#define ROUND                                                                                                          \
  "-dimension 2 -spacing 1 -kernel_ratio 1.5 -box_lower 0,0 -box_upper 9,9 -box_x periodic -box_y periodic "           \
  "-packing_jitter 0.2 -bodies "                                                                                       \
  "a -a_density 900 -pressure_regularization 0.3 "

static PetscErrorCode Open(const char options[], const char source[], const char closure[], const char gradient[],
                           PetscBool summed, Setup *s)
{
  PetscFunctionBegin;
  PetscCall(SetupPack(options, s));
  PetscCall(SetupMoments(s));
  PetscCall(PetscArrayzero(s->cloud->field[FIELD_CAPILLARY], s->cloud->n_owned));
  PetscCall(PetscArrayzero(s->cloud->field[FIELD_CAPILLARY_SLOPE], DIM * s->cloud->n_owned));
  PetscCall(PetscArrayzero(s->cloud->field[FIELD_DIVERGENCE], s->cloud->n_owned));
  PetscCall(PressureCreate(s->cloud, &s->pressure));
  PetscCall(PressureSetTypes(s->pressure, source, closure, gradient, summed));
  PetscCall(PressureSetFromOptions(s->pressure));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The cubic spline in two dimensions at the distance r. */
static PetscReal Spline(PetscReal r)
{
  const PetscReal q = r / H, norm = 10 / (7 * PETSC_PI * H * H);

  return norm * (q < 1 ? 1 - 1.5 * q * q + 0.75 * q * q * q : q < 2 ? 0.25 * (2 - q) * (2 - q) * (2 - q) : 0);
}

/* The sum of V W on a full lattice; the integral of W over a line that passes at a distance. */
static PetscReal LatticeSum(void)
{
  PetscReal sum = 0;

  for (PetscInt i = -3; i <= 3; i++)
    for (PetscInt j = -3; j <= 3; j++) sum += Spline(PetscSqrtReal((PetscReal)(i * i + j * j)));
  return sum;
}

static PetscReal LineIntegral(PetscReal distance)
{
  PetscReal sum = 0;

  for (PetscInt k = 0; k < 3000; k++)
    sum += 2e-3 * Spline(PetscSqrtReal(PetscSqr(distance) + PetscSqr(1e-3 * (k + 0.5))));
  return sum;
}

/* The part of the kernel that is within a plane surface at this depth. */
static PetscReal Within(PetscReal depth)
{
  PetscReal sum = 0.5;

  for (PetscInt k = 0; k < 100; k++) sum += LineIntegral(depth * (k + 0.5) / 100) * depth / 100;
  return sum;
}

/* Of the relative compressions -2 .. 2 percent, by number. */
static PetscReal Compression(PetscInt id)
{
  return 0.01 * (id % 5 - 2);
}

/* Eq. (8) from densities; walls push only. The rows of the equation have the volume of their particle, and with
   summed densities its mass over that of the first liquid's. */
static PetscErrorCode TestDensity(PetscBool summed)
{
  const PetscScalar *b;
  PetscReal         *rhs, fluid = 0, walls = 0, rows = 0;
  Mat                A;
  Vec                right;
  Setup              s;

  PetscFunctionBegin;
  PetscCall(Open(POOL, SOURCE_DENSITY, CLOSURE_FULL, GRADIENT_SYMMETRIC, summed, &s));
  for (PetscInt a = 0; a < s.cloud->n_total; a++)
    s.cloud->field[FIELD_DENSITY][a] = s.cloud->rest_density[a] * (1 + Compression(s.cloud->integer[INT_ID][a]));
  PetscCall(PetscMalloc1(s.cloud->n_rows, &rhs));
  PetscCall(PressureSource(s.pressure, DT, rhs));
  PetscCall(PressureAssemble(s.pressure, DT, &A, &right));
  PetscCall(VecGetArrayRead(right, &b));
  for (PetscInt a = 0; a < s.cloud->n_rows; a++) {
    const PetscReal compression = Compression(s.cloud->integer[INT_ID][a]);
    const PetscInt  body        = s.cloud->integer[INT_BODY][a];

    if (a < s.cloud->n_fluid) {
      fluid = PetscMax(fluid, PetscAbsReal(rhs[a] - compression / (DT * DT)));
      rows  = PetscMax(rows, PetscAbsReal(b[a] - rhs[a] * (summed && body ? 600. / 900. : 1)));
    } else
      walls = PetscMax(walls, PetscAbsReal(rhs[a] - PetscMax(0, compression) / (DT * DT)));
  }
  PetscCall(VecRestoreArrayRead(right, &b));
  PetscCall(PetscFree(rhs));
  CHECK_CLOSE(SetupMax(fluid), 0, 1e-6, "density_source_of_the_fluid"); /* of 2e4 1/s2 */
  CHECK_CLOSE(SetupMax(walls), 0, 1e-6, "density_source_of_walls_pushes_only");
  CHECK_CLOSE(SetupMax(rows), 0, 1e-6,
              summed ? "rows_have_the_mass_of_their_liquid" : "rows_have_the_volume_of_their_particle");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The row of the top wall particle whose number is 'parent'. */
static PetscInt RowOf(Cloud cloud, PetscInt parent)
{
  for (PetscInt r = cloud->n_fluid; r < cloud->n_rows; r++)
    if (cloud->integer[INT_ID][r] == parent) return r;
  return -1;
}

/* A divergence of id 1/s and the density term: e = F - rho/(rho_0 S), repaired in the time T. Walls add up the
   divergence of their layers. T is 0.02 s, or five steps. */
static PetscErrorCode TestDivergence(PetscBool steps, PetscBool held)
{
  const PetscReal T = steps ? 3 * DT : 0.02, S = LatticeSum(), plane = LineIntegral(0);
  /* lambda, normal over that of a plane surface, rho/rho_0, and e */
  const PetscReal kinds[6][4] = {{1, 0, 1.02, 1 - 1.02 / S},
                                 {0.5, 0, 0.9, 1 - 0.9 / S},
                                 {0.5, 1, 0.4, 0.5 - 0.4 / S},
                                 {0.25, 1, 0.4, 0},
                                 {0.25, 1, 0.8, 0.5 - 0.8 / S},
                                 {0.5, LineIntegral(0.6) / plane, 0.7, Within(0.6) - 0.7 / S}};
  PetscReal      *rhs, *due, fluid = 0, walls = 0;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(Open(held    ? POOL HOSE "-pressure_relaxation_time 0.02"
                 : steps ? POOL "-pressure_relaxation_time 1e-9"
                         : POOL "-pressure_relaxation_time 0.02",
                 SOURCE_DIVERGENCE, CLOSURE_FULL, GRADIENT_SYMMETRIC, PETSC_FALSE, &s));
  PetscCall(PetscCalloc2(s.cloud->n_rows, &rhs, s.cloud->n_rows, &due));
  for (PetscInt a = 0; a < s.cloud->n_owned; a++) {
    const PetscInt   id   = s.cloud->integer[INT_ID][a];
    const PetscReal *kind = kinds[id % 6];

    s.cloud->field[FIELD_DIVERGENCE][a]       = id;
    s.cloud->field[FIELD_LAMBDA][a]           = kind[0];
    s.cloud->field[FIELD_NORMAL][DIM * a]     = 0.6 * kind[1] * plane;
    s.cloud->field[FIELD_NORMAL][DIM * a + 1] = -0.8 * kind[1] * plane;
    s.cloud->field[FIELD_DENSITY][a]          = kind[2] * s.cloud->rest_density[a];
    if (held && a < s.cloud->n_fluid) {
      const PetscReal *x = s.cloud->field[FIELD_POSITION] + DIM * a;

      s.cloud->integer[INT_BODY][a] = 2;
      due[a]                        = -id / DT - (x[0] < 4.5 ? 0 : kind[3] / (DT * T));
    } else if (a < s.cloud->n_fluid)
      due[a] = -id / DT - kind[3] / (DT * T);
    else
      due[a < s.cloud->n_rows ? a : RowOf(s.cloud, s.cloud->integer[INT_PARENT][a])] -= id / DT;
  }
  PetscCall(PressureSource(s.pressure, DT, rhs));
  for (PetscInt r = 0; r < s.cloud->n_rows; r++) {
    PetscReal *worst = r < s.cloud->n_fluid ? &fluid : &walls;

    *worst = PetscMax(*worst, PetscAbsReal(rhs[r] - due[r]) * DT * T);
  }
  PetscCall(PetscFree2(rhs, due));
  CHECK_CLOSE(SetupMax(fluid), 0, 1e-4, /* of a table */
              held    ? "divergence_source_of_an_emitter"
              : steps ? "divergence_source_in_steps"
                      : "divergence_source");
  CHECK_CLOSE(SetupMax(walls), 0, 1e-9, "divergence_source_of_walls_adds_their_layers");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A drop under the same capillary pressure everywhere has this pressure, and nothing moves. */
static PetscErrorCode TestCapillary(const char closure[], const char gradient[])
{
  const PetscReal sigma_kappa = 3; /* Pa */
  PressureResult  result;
  PetscReal       worst = 0, push = 0, *acceleration;
  char            name[96];
  Setup           s;

  PetscFunctionBegin;
  PetscCall(Open(DROP, SOURCE_DIVERGENCE, closure, gradient, PETSC_FALSE, &s));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) s.cloud->field[FIELD_CAPILLARY][a] = sigma_kappa;
  PetscCall(PressureSolve(s.pressure, DT, &result));
  PetscCall(CloudGetWork(s.cloud, DIM, &acceleration));
  PetscCall(PressureAcceleration(s.pressure, acceleration));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    worst = PetscMax(worst, PetscAbsReal(s.cloud->field[FIELD_PRESSURE][a] - sigma_kappa));
    push  = PetscMax(push, Norm(acceleration + DIM * a));
  }
  PetscCall(CloudRestoreWork(s.cloud, &acceleration));
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_%s_drop_under_capillary_pressure", closure, gradient));
  CHECK_CLOSE(SetupMax(worst), 0, 1e-8, name);
  PetscCall(PetscSNPrintf(name, sizeof(name), "%s_%s_drop_at_rest", closure, gradient));
  CHECK_CLOSE(SetupMax(push), 0, 1e-8, name); /* of 3 Pa/(900 kg/m3 d0) */
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sums over the rows of a drop whose particles all have this lambda and this multiple of their normals: what the
   closure adds, A 1; what they lack to the diagonal of a full lattice; n.B n/rho of those on the surface. */
static PetscErrorCode Closed(PetscReal lambda, PetscReal normal, PetscReal sum[3])
{
  const PetscScalar *added, *diagonal;
  PetscReal          lattice, unused;
  Mat                A;
  Vec                b, one, d;
  Setup              s;

  PetscFunctionBegin;
  PetscCall(Open(DROP, SOURCE_DIVERGENCE, CLOSURE_FULL, GRADIENT_SYMMETRIC, PETSC_FALSE, &s));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    s.cloud->field[FIELD_LAMBDA][a] = lambda;
    for (PetscInt k = 0; k < DIM; k++) s.cloud->field[FIELD_NORMAL][DIM * a + k] *= normal;
  }
  PetscCall(PressureAssemble(s.pressure, DT, &A, &b));
  PressureLattice(s.cloud, &lattice, &unused);
  PetscCall(MatCreateVecs(A, &one, &d));
  PetscCall(VecSet(one, 1));
  PetscCall(MatMult(A, one, d));
  PetscCall(MatGetDiagonal(A, one));
  PetscCall(VecGetArrayRead(d, &added));
  PetscCall(VecGetArrayRead(one, &diagonal));
  sum[0] = sum[1] = sum[2] = 0;
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    const PetscReal *n = s.cloud->field[FIELD_NORMAL] + DIM * a;
    PetscReal        Bn[DIM];

    TensorApply(s.cloud->field[FIELD_CORRECTION] + 6 * a, n[0], n[1], n[2], Bn);
    sum[0] += PetscRealPart(added[a]);
    sum[1] += PetscMax(0, lattice / 900 - PetscRealPart(diagonal[a] - added[a]));
    sum[2] += s.cloud->integer[INT_SURFACE][a] ? Dot(Bn, n) / 900 : 0;
  }
  for (PetscInt k = 0; k < 3; k++) sum[k] = SetupSum(sum[k]);
  PetscCall(VecRestoreArrayRead(one, &diagonal));
  PetscCall(VecRestoreArrayRead(d, &added));
  PetscCall(VecDestroy(&one));
  PetscCall(VecDestroy(&d));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows of lambda below 0.9 are filled up twice; those on the surface get 2.5 n.B n/rho at least. */
static PetscErrorCode TestClosure(void)
{
  PetscReal filled[3], full[3], least[3];

  PetscFunctionBegin;
  PetscCall(Closed(0.89, 0, filled));
  PetscCall(Closed(0.91, 0, full));
  PetscCall(Closed(0.91, 1, least));
  CHECK_CLOSE(filled[0] / filled[1], 2, 1e-9, "closure_fills_up_twice");
  CHECK_CLOSE(full[0] / filled[0], 0, 1e-12, "closure_of_a_full_row");
  CHECK_CLOSE(least[0] / least[2], 2.5, 1e-9, "closure_at_least");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* -(G + q n + q/10 (c - n))/rho of a linear pressure G.x inside, with the sums n and c by hand: q = 2 c h |G|, whatever
   the body force is. g: m/s2. */
static PetscErrorCode TestGradient(PetscReal g, const char name[])
{
  const PetscReal G[DIM] = {400, -300, 0}, n[DIM] = {0.03, -0.01, 0}, c[DIM] = {0.01, 0.05, 0}, q = 2 * 0.3 * H * 500;
  char            text[512];
  PetscReal       worst = 0, *acceleration;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(text, sizeof(text), ROUND "-gravity 0,%g", (double)-g));
  PetscCall(Open(text, SOURCE_DIVERGENCE, CLOSURE_FULL, GRADIENT_CORRECTED, PETSC_FALSE, &s));
  for (PetscInt a = 0; a < s.cloud->n_total; a++) {
    s.cloud->field[FIELD_PRESSURE][a] = Dot(G, s.cloud->field[FIELD_POSITION] + DIM * a);
    for (PetscInt d = 0; d < DIM; d++) {
      s.cloud->field[FIELD_NORMAL][DIM * a + d]   = n[d];
      s.cloud->field[FIELD_CROWDING][DIM * a + d] = c[d];
    }
    s.cloud->integer[INT_SURFACE][a] = 0;
  }
  PetscCall(CloudGetWork(s.cloud, DIM, &acceleration));
  PetscCall(PressureAcceleration(s.pressure, acceleration));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
    for (PetscInt d = 0; d < DIM; d++)
      worst =
        PetscMax(worst, PetscAbsReal(acceleration[DIM * a + d] + (G[d] + q * n[d] + 0.1 * q * (c[d] - n[d])) / 900));
  PetscCall(CloudRestoreWork(s.cloud, &acceleration));
  CHECK_CLOSE(SetupMax(worst), 0, 1e-10, name);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define TROUGH                                                                                                         \
  "-dimension 2 -spacing 1 -box_lower 0,0 -box_upper 12,10 -box_xmin symmetry -box_xmax wall -box_y wall "             \
  "-bodies water -water_upper 12,10 -packing_jitter 0.2 -pressure_relaxation_time 1e30 -ksp_rtol 1e-9 -ksp_max_it "    \
  "1000 "

/* The pressure (Pa) of liquid at rest at x, less that at the origin: exact for a force that is linear in x. */
static PetscReal AtRest(Scene scene, const PetscReal x[DIM])
{
  const PetscReal origin[DIM] = {0, 0, 0};
  PetscReal       g[DIM], there[DIM];

  SceneAcceleration(scene, origin, g);
  SceneAcceleration(scene, x, there);
  return 500 * (Dot(g, x) + Dot(there, x));
}

/* One step of disordered liquid at rest in a full vessel, all of whose weight is carried: the share of the force that
   is kept for the next step, the largest acceleration besides, and the error of the pressure. */
static PetscErrorCode CarryWeight(PetscReal share, const char gravity[], PetscReal *kept, PetscReal *rest,
                                  PetscReal *error)
{
  char           text[1024];
  PetscReal      sum[3] = {0, 0, 0}, *acceleration; /* errors, deficits, particles */
  PressureResult result;
  Setup          s;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(text, sizeof(text), TROUGH "-gravity %s", gravity));
  PetscCall(Open(text, SOURCE_DIVERGENCE, CLOSURE_FULL, GRADIENT_CORRECTED, PETSC_FALSE, &s));
  *kept = *rest = *error = 0;
  SceneSetTime(s.scene, 1);
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) s.cloud->field[FIELD_CARRIED][a] = share;
  PetscCall(PressurePredict(s.pressure));
  PetscCall(CloudGetWork(s.cloud, DIM, &acceleration));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
    SceneAcceleration(s.scene, s.cloud->field[FIELD_POSITION] + DIM * a, acceleration + DIM * a);
  PressureTakeCarried(s.pressure, acceleration);
  PetscCall(PetscArrayzero(s.cloud->field[FIELD_VELOCITY_STAR], DIM * s.cloud->n_owned));
  for (PetscInt k = 0; k < DIM * s.cloud->n_fluid; k++) s.cloud->field[FIELD_VELOCITY_STAR][k] = DT * acceleration[k];
  PetscCall(SetupDivergence(&s));
  PetscCall(PressureSolve(s.pressure, DT, &result));
  PetscCall(PressureAcceleration(s.pressure, acceleration));
  for (PetscInt k = 0; k < DIM * s.cloud->n_fluid; k++) *rest = PetscMax(*rest, PetscAbsReal(acceleration[k]));
  PressureKeepCarried(s.pressure, acceleration);
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    sum[0] += s.cloud->field[FIELD_PRESSURE][a] - AtRest(s.scene, s.cloud->field[FIELD_POSITION] + DIM * a);
    sum[1] += 1 - s.cloud->field[FIELD_CARRIED][a];
    sum[2]++;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 3, MPIU_REAL, MPIU_SUM, PETSC_COMM_WORLD));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
    *error = PetscMax(*error, PetscAbsReal(s.cloud->field[FIELD_PRESSURE][a] - sum[0] / sum[2] -
                                           AtRest(s.scene, s.cloud->field[FIELD_POSITION] + DIM * a)));
  *kept  = sum[1] / sum[2];
  *rest  = SetupMax(*rest);
  *error = SetupMax(*error);
  PetscCall(CloudRestoreWork(s.cloud, &acceleration));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What is carried moves nothing, however disordered the particles are, across a mirror and beside walls. */
static PetscErrorCode TestCarried(const char gravity[])
{
  PetscReal kept, rest, error;

  PetscFunctionBegin;
  PetscCall(CarryWeight(1, gravity, &kept, &rest, &error));
  CHECK_CLOSE(rest, 0, 1e-6, "carried_moves_nothing");
  CHECK_CLOSE(error, 0, 1e-3, "carried_pressure");
  CHECK_CLOSE(kept, 0, 1e-12, "carried_is_kept");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Without a share the same liquid moves by its disorder, and finds that its weight is carried. */
static PetscErrorCode TestUncarried(void)
{
  PetscReal kept, rest, error;

  PetscFunctionBegin;
  PetscCall(CarryWeight(0, "0.6,-0.8,0", &kept, &rest, &error));
  CHECK(error > 1, "uncarried_pressure");
  CHECK_CLOSE(kept, 0, 0.5, "uncarried_is_found");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The mean acceleration by the pressure over g, of two liquids over each other in a tank, disordered and pulled down by
   g in one step. */
static PetscErrorCode Held(PetscReal low, PetscReal high, PetscReal held[2])
{
  const PetscReal g      = 9.81;
  PetscReal       sum[2] = {0, 0}, count[2] = {0, 0}, *acceleration, *v;
  char            options[1024];
  PressureResult  result;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof(options),
                          "-dimension 2 -spacing 1 -box_lower 0,0 -box_upper 16,40 -box_x periodic -box_ymin wall "
                          "-bodies a,b -a_density %g -a_upper 16,10 -b_density %g -b_lower 0,10 -b_upper 16,25 "
                          "-pressure_relaxation_time 1e30 -ksp_rtol 1e-8 ",
                          (double)low, (double)high));
  PetscCall(Open(options, SOURCE_DIVERGENCE, CLOSURE_FULL, GRADIENT_CORRECTED, PETSC_FALSE, &s));
  v = s.cloud->field[FIELD_VELOCITY_STAR];
  PetscCall(PetscArrayzero(v, DIM * s.cloud->n_owned));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) v[DIM * a + 1] = -DT * g;
  PetscCall(SetupDivergence(&s));
  PetscCall(PressureSolve(s.pressure, DT, &result));
  PetscCall(CloudGetWork(s.cloud, DIM, &acceleration));
  PetscCall(PressureAcceleration(s.pressure, acceleration));
  for (PetscInt a = 0; a < s.cloud->n_fluid; a++) {
    sum[s.cloud->integer[INT_BODY][a]] += acceleration[DIM * a + 1] / g;
    count[s.cloud->integer[INT_BODY][a]]++;
  }
  PetscCall(CloudRestoreWork(s.cloud, &acceleration));
  for (PetscInt body = 0; body < 2; body++) held[body] = SetupSum(sum[body]) / SetupSum(count[body]);
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The pressure of one step holds two liquids like one, whichever is below. */
static PetscErrorCode TestAtRest(PetscReal low, PetscReal high)
{
  PetscReal one[2], two[2];
  char      name[96];

  PetscFunctionBegin;
  PetscCall(Held(low, low, one));
  PetscCall(Held(low, high, two));
  for (PetscInt body = 0; body < 2; body++) {
    PetscCall(PetscSNPrintf(name, sizeof(name), "%d_%s_of_%d_is_held", (int)(body ? high : low),
                            body ? "above" : "below", (int)(body ? low : high)));
    CHECK_CLOSE(two[body], one[body], 0.01, name);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(TestDensity(PETSC_FALSE));
  PetscCall(TestDensity(PETSC_TRUE));
  PetscCall(TestAtRest(2000, 1000));
  PetscCall(TestAtRest(1000, 2000));
  PetscCall(TestDivergence(PETSC_FALSE, PETSC_FALSE));
  PetscCall(TestDivergence(PETSC_TRUE, PETSC_FALSE));
  PetscCall(TestDivergence(PETSC_FALSE, PETSC_TRUE));
  PetscCall(TestCapillary(CLOSURE_DOUBLED, GRADIENT_SYMMETRIC));
  PetscCall(TestCapillary(CLOSURE_FULL, GRADIENT_SYMMETRIC));
  PetscCall(TestCapillary(CLOSURE_FULL, GRADIENT_CORRECTED));
  PetscCall(TestClosure());
  PetscCall(TestGradient(0, "gradient_in_motion"));
  PetscCall(TestGradient(9.81, "gradient_loaded"));
  PetscCall(TestCarried("0.6,-0.8,0"));
  PetscCall(TestCarried("0,0,0 -central_force_rate 0.3"));
  PetscCall(TestCarried("0,0,0 -gravity_amplitude 0.6,-0.8 -gravity_frequency 0.25 -time_start 1"));
  PetscCall(TestUncarried());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
