/* Weakly compressible SPH with the operators of the consistent scheme: the pressure is not solved for, but follows from
   Tait's equation of state (Monaghan 1994; Nishio et al. 2010 for the impact), p = B ((rho/rho_0)^7 - 1), B = rho_0
   c^2/7, with an artificial speed of sound c. The step is short (sound crosses a fraction of h) and cheap.

   The pressure is the stored state and stands for the density of the equation of state, (rho/rho_0)^7 = 1 + p/B. This
   density changes with the source of the projection, d ln rho/dt = -div v - e/T. With -pressure_source density rho is
   the present summed density instead, and suction is cut off: the free surface, where the sum lacks neighbours, would
   have nothing but suction.

   Density diffusion keeps the pressure smooth: Molteni & Colagrossi 2009, without the hydrostatic part (Fourtakas et
   al. 2019), which would pull the liquid of a film at rest apart. */
#include "../neighbors/pairs.h"
#include "consistent.h"

#define TAIT_EXPONENT 7 /* water; Monaghan 1994 */

/* time in which density errors are corrected, over h/U of the scene; a shorter time feeds sound waves */
#define RELAXATION_RATIO 25
#define MACH             0.1 /* the scene's velocity over the speed of sound: density within 1 % (Monaghan 1994) */
#define DIFFUSION        0.1 /* delta of the diffusion delta h c lap rho of the density (Molteni & Colagrossi 2009) */
#define SOUND_CFL        0.4 /* (speed of sound + largest speed) times time step over h; Monaghan 1992 */

typedef struct {
  Consistent base;
  PetscReal  speed;       /* of sound, m/s */
  PetscReal  lattice_sum; /* sum V W on a full lattice, 1 */
} Compressible;

static const OptionRow options[] = {
  CONSISTENT_ROWS,
  {"-sound_speed", "Artificial speed of sound; 0: ten times the scene's velocity", "m/s", "[0, inf)", ROW_REAL,
   offsetof(Compressible, speed)},
  {.name = NULL},
};

static PetscErrorCode SetUp(void *owner)
{
  PetscFunctionBegin;
  PetscCall(ConsistentSetUp(owner));
  TimeStepDefaults(&((Stepper)owner)->limits); /* no larger limits are known for this scheme */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Chooses the speed of sound from the scene's velocity; refuses bad values. */
static PetscErrorCode Check(Stepper stepper)
{
  Compressible   *s        = (Compressible *)stepper->scheme;
  const PetscReal velocity = stepper->reference_velocity;
  PetscReal       diagonal;

  PetscFunctionBegin;
  PetscCheckUser(s->speed > 0 || velocity > 0, stepper->cloud->comm,
                 "no motion or force in the scene determines a speed of sound: give -sound_speed (m/s)");
  if (s->speed == 0) s->speed = velocity / MACH;
  PressureLattice(stepper->cloud, &diagonal, &s->lattice_sum);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode View(Stepper stepper, PetscViewer viewer)
{
  const Compressible *s = (const Compressible *)stepper->scheme;

  PetscFunctionBegin;
  PetscCall(ConsistentView(stepper, viewer));
  PetscCall(PetscViewerASCIIPrintf(viewer, "Sound: %g m/s, CFL %g, density diffusion %g\n", (double)s->speed, SOUND_CFL,
                                   DIFFUSION));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal Bound(Stepper stepper, PetscReal speed)
{
  const Compressible *s = (const Compressible *)stepper->scheme;

  return SOUND_CFL * KernelSmoothingLength(stepper->cloud->kernel) / (s->speed + speed);
}

/* delta h c lap p of the fluid, Pa/s, p without its hydrostatic part. */
static PetscErrorCode Diffusion(Cloud cloud, const Compressible *s, PetscReal out[])
{
  const PetscReal *p = cloud->field[FIELD_PRESSURE], *volume = cloud->volume;
  const PetscInt  *layer = cloud->integer[INT_LAYER];
  const PetscReal  scale = 2 * DIFFUSION * KernelSmoothingLength(cloud->kernel) * s->speed;
  PairRow          row;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, own = p[a];
    PetscReal        g[DIM], gx, gy, gz, sum = 0;

    SceneAcceleration(cloud->scene, x, g);
    gx = cloud->rest_density[a] * g[0];
    gy = cloud->rest_density[a] * g[1];
    gz = cloud->rest_density[a] * g[2];
    PairRowLoadGeometry(cloud, cloud->field[FIELD_POSITION], a, &row);
    KernelGradient(cloud->kernel, row.n, row.r2, row.F);
    SIMD_LOOP(reduction(+ : sum))
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt  b     = row.index[k];
      const PetscReal still = gx * row.dx[k] + gy * row.dy[k] + gz * row.dz[k]; /* the hydrostatic p_a - p_b */

      sum += (layer[b] ? 0 : volume[b]) * row.F[k] * (own - p[b] - still);
    }
    out[a] = scale * sum;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Walls get the pressure of the fluid in front of them, plus the weight of the fluid between (Adami et al. 2012). */
static PetscErrorCode ExtendToWalls(Cloud cloud)
{
  const PetscReal *x     = cloud->field[FIELD_POSITION];
  const PetscInt  *layer = cloud->integer[INT_LAYER];
  PetscReal       *p     = cloud->field[FIELD_PRESSURE];
  PairRow          row;

  PetscFunctionBegin;
  for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++) {
    PetscReal g[DIM], weight = 0, sum = 0;

    SceneAcceleration(cloud->scene, x + DIM * a, g);
    PairRowLoadGeometry(cloud, x, a, &row);
    KernelEvaluate(cloud->kernel, row.n, row.r2, row.W, NULL);
    for (PetscInt k = 0; k < row.n; k++) {
      const PetscInt b = row.index[k];

      if (layer[b]) continue;
      weight += row.W[k];
      sum += row.W[k] * (p[b] + cloud->rest_density[b] * (g[0] * row.dx[k] + g[1] * row.dy[k] + g[2] * row.dz[k]));
    }
    p[a] = weight > 0 ? sum / weight : 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Computes the new pressure of the fluid from the source. */
static PetscErrorCode Compress(Stepper stepper, PetscReal dt)
{
  Cloud               cloud = stepper->cloud;
  const Compressible *s     = (const Compressible *)stepper->scheme;
  const PetscBool     rate  = PressureTakesDivergence(stepper->pressure);
  PetscReal          *p     = cloud->field[FIELD_PRESSURE], *rhs, *diffusion;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_SOURCE), 0, 0, 0, 0));
  PetscCall(PetscMalloc2(cloud->n_rows, &rhs, cloud->n_fluid, &diffusion));
  PetscCall(PressureSource(stepper->pressure, dt, rhs));
  if (rate)
    PetscCall(Diffusion(cloud, s, diffusion));
  else
    PetscCall(PetscArrayzero(diffusion, cloud->n_fluid));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal B      = cloud->rest_density[a] * PetscSqr(s->speed) / TAIT_EXPONENT;
    const PetscReal change = dt * dt * rhs[a];

    if (cloud->field[FIELD_LAMBDA][a] <= SPRAY_LAMBDA)
      p[a] = 0;
    else if (rate)
      p[a] = B * ((1 + p[a] / B) * PetscExpReal(TAIT_EXPONENT * change) - 1) + dt * diffusion[a];
    else
      p[a] = PetscMax(0, B * (PetscPowRealInt((1 + change) / s->lattice_sum, TAIT_EXPONENT) - 1));
  }
  PetscCall(PetscFree2(rhs, diffusion));
  PetscCall(CloudUpdate(cloud, FIELD_PRESSURE));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_SOURCE), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* FIELD_VELOCITY_STAR = v + dt a. */
static PetscErrorCode Predict(Stepper stepper, PetscReal dt)
{
  Cloud            cloud = stepper->cloud;
  const PetscReal *v = cloud->field[FIELD_VELOCITY], *a = cloud->field[FIELD_ACCELERATION];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++)
    cloud->field[FIELD_VELOCITY_STAR][k] = stepper->now.damping * v[k] + dt * a[k];
  PetscCall(CloudUpdate(cloud, FIELD_VELOCITY_STAR));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The initial pressure: that of an incompressible step of the size that the consistent scheme would take. In a step of
   this scheme's size the noise of div v would dominate the pressure. */
static PetscErrorCode PressureAtStart(Stepper stepper, PetscReal dt, PressureResult *result)
{
  const PetscReal h = KernelSmoothingLength(stepper->cloud->kernel), velocity = stepper->reference_velocity;
  const PetscReal flow_dt = velocity > 0 ? PetscMax(dt, stepper->limits.cfl * h / velocity) : dt;

  PetscFunctionBegin;
  PetscCall(Predict(stepper, flow_dt));
  if (PressureTakesDivergence(stepper->pressure)) PetscCall(StepDivergence(stepper, 0));
  PetscCall(PressureSolve(stepper->pressure, flow_dt, result));
  PetscCall(Predict(stepper, dt));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Project(Stepper stepper, PetscReal dt, PressureResult *result)
{
  Cloud cloud = stepper->cloud;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_PROJECT), 0, 0, 0, 0));
  if (stepper->now.first)
    PetscCall(PressureAtStart(stepper, dt, result));
  else
    PetscCall(Compress(stepper, dt));
  if (!SolverFailed(&result->solver)) {
    PetscCall(ExtendToWalls(cloud));
    PetscCall(CloudUpdate(cloud, FIELD_PRESSURE));
  }
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_PROJECT), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Create(Stepper stepper)
{
  Compressible *s = (Compressible *)stepper->scheme;

  PetscFunctionBegin;
  s->base.project = Project;
  PetscCall(ConsistentDefaults(stepper));
  stepper->relaxation_ratio = RELAXATION_RATIO;
  PetscCall(PressureSetTypes(stepper->pressure, SOURCE_DIVERGENCE, CLOSURE_FULL, GRADIENT_SYMMETRIC, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const SchemeOps SchemeWeaklyCompressible = {.choice = {SCHEME_WEAKLY_COMPRESSIBLE, sizeof(Compressible), options, NULL,
                                                       SetUp},
                                            .create = Create,
                                            .check  = Check,
                                            .view   = View,
                                            .bound  = Bound,
                                            .step   = ConsistentStep};
