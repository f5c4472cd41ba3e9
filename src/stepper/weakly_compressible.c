/* Weakly compressible SPH on the same operators: where the consistent scheme solves for the pressure, this one takes it
   from Tait's equation of state (Monaghan 1994; Nishio et al. 2010 for the impact), p = B ((rho/rho_0)^7 - 1), B =
   rho_0 c^2/7, with an artificial speed of sound c. The step is short (sound crosses a fraction of h) and cheap.

   The pressure is the state: it stands for the density of the equation of state, (rho/rho_0)^7 = 1 + p/B, which the
   source that the projection removes changes, d ln rho/dt = -div v - e/T. With -pressure_source density rho is the
   summed density of the moment instead, and no suction: the free surface, whose sum lacks neighbours, would have
   nothing else.

   Density diffusion keeps the pressure smooth: Molteni & Colagrossi 2009, without the hydrostatic part (Fourtakas et
   al. 2019), which would pull the liquid of a film at rest apart. */
#include "../neighbors/pairs.h"
#include "stepper_impl.h"

#define TAIT_EXPONENT 7 /* water; Monaghan 1994 */

PetscErrorCode CompressibleSetFromOptions(Stepper s, OptionItems PetscOptionsObject)
{
  PetscFunctionBegin;
  PetscCall(PetscOptionsReal("-sound_speed", "artificial speed of sound (m/s); 0: from the scene's velocity",
                             "CompressibleSetFromOptions", s->sound_speed, &s->sound_speed, NULL));
  PetscCall(PetscOptionsReal("-sound_mach", "the scene's velocity over the speed of sound (1)",
                             "CompressibleSetFromOptions", s->sound_mach, &s->sound_mach, NULL));
  PetscCall(PetscOptionsReal("-sound_cfl", "(speed of sound + largest speed) times time step over h (1)",
                             "CompressibleSetFromOptions", s->sound_cfl, &s->sound_cfl, NULL));
  PetscCall(PetscOptionsReal("-density_diffusion", "delta of the diffusion delta h c lap rho of the density (1)",
                             "CompressibleSetFromOptions", s->density_diffusion, &s->density_diffusion, NULL));
  PetscCall(PetscOptionsBool("-sound_projected", "start from the pressure of a projection instead of from zero",
                             "CompressibleSetFromOptions", s->sound_projected, &s->sound_projected, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CompressibleCheck(Stepper s, PetscReal velocity)
{
  MPI_Comm  comm = s->cloud->comm;
  PetscReal diagonal;

  PetscFunctionBegin;
  PetscCheckUser(s->sound_speed >= 0, comm, "-sound_speed is %g m/s; it must not be negative", (double)s->sound_speed);
  PetscCheckUser(s->sound_mach > 0 && s->sound_mach <= 1, comm, "-sound_mach is %g; it must lie in (0, 1]",
                 (double)s->sound_mach);
  PetscCheckUser(s->sound_cfl > 0 && s->sound_cfl <= 2, comm, "-sound_cfl is %g; it must lie in (0, 2]",
                 (double)s->sound_cfl);
  PetscCheckUser(s->density_diffusion >= 0 && s->density_diffusion <= 1, comm,
                 "-density_diffusion is %g; it must lie in [0, 1]", (double)s->density_diffusion);
  PetscCheckUser(s->sound_speed > 0 || velocity > 0, comm,
                 "nothing in the scene moves or pushes, so no speed of sound follows from it: give -sound_speed (m/s)");
  if (s->sound_speed == 0) s->sound_speed = velocity / s->sound_mach;
  PressureLattice(s->cloud, &diagonal, &s->lattice_sum);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* delta h c lap p of the fluid, Pa/s, p without its hydrostatic part. */
static PetscErrorCode Diffusion(Stepper stepper, PetscReal out[])
{
  Cloud            cloud = stepper->cloud;
  const PetscReal *p = cloud->field[FIELD_PRESSURE], *volume = cloud->volume;
  const PetscInt  *layer = cloud->integer[INT_LAYER];
  const PetscReal  scale = 2 * stepper->density_diffusion * KernelSmoothingLength(cloud->kernel) * stepper->sound_speed;
  PairRow          row;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, own = p[a];
    PetscReal        g[DIM], gx, gy, gz, sum = 0;

    SceneAcceleration(cloud->scene, x, g);
    gx = cloud->rest_density[a] * g[0];
    gy = cloud->rest_density[a] * g[1];
    gz = cloud->rest_density[a] * g[2];
    PairRowLoad(cloud, cloud->field[FIELD_POSITION], a, &row);
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

/* Walls take the pressure of the fluid in front of them, with the weight of what lies between (Adami et al. 2012). */
static PetscErrorCode ExtendToWalls(Stepper stepper)
{
  Cloud            cloud = stepper->cloud;
  const PetscReal *x     = cloud->field[FIELD_POSITION];
  const PetscInt  *layer = cloud->integer[INT_LAYER];
  PetscReal       *p     = cloud->field[FIELD_PRESSURE];
  PairRow          row;

  PetscFunctionBegin;
  for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++) {
    PetscReal g[DIM], weight = 0, sum = 0;

    SceneAcceleration(cloud->scene, x + DIM * a, g);
    PairRowLoad(cloud, x, a, &row);
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

/* The new pressure of the fluid from the source. */
static PetscErrorCode Compress(Stepper stepper, PetscReal dt)
{
  Cloud           cloud       = stepper->cloud;
  const PetscReal c2          = PetscSqr(stepper->sound_speed);
  PetscReal      *p           = cloud->field[FIELD_PRESSURE], *rhs, *diffusion;
  const PetscBool accumulates = PressureTakesDivergence(stepper->pressure);

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_SOURCE), 0, 0, 0, 0));
  PetscCall(PetscMalloc2(cloud->n_rows, &rhs, cloud->n_fluid, &diffusion));
  PetscCall(PressureSource(stepper->pressure, dt, rhs));
  if (accumulates && stepper->density_diffusion > 0)
    PetscCall(Diffusion(stepper, diffusion));
  else
    PetscCall(PetscArrayzero(diffusion, cloud->n_fluid));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal B = cloud->rest_density[a] * c2 / TAIT_EXPONENT, change = dt * dt * rhs[a];

    if (cloud->field[FIELD_LAMBDA][a] <= SPRAY_LAMBDA)
      p[a] = 0;
    else if (accumulates)
      p[a] = B * ((1 + p[a] / B) * PetscExpReal(TAIT_EXPONENT * change) - 1) + dt * diffusion[a];
    else
      p[a] = PetscMax(0, B * (PetscPowRealInt((1 + change) / stepper->lattice_sum, TAIT_EXPONENT) - 1));
  }
  PetscCall(PetscFree2(rhs, diffusion));
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
    cloud->field[FIELD_VELOCITY_STAR][k] = stepper->damping * v[k] + dt * a[k];
  PetscCall(CloudUpdate(cloud, FIELD_VELOCITY_STAR));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The pressure of an incompressible step, of the size that scheme would take: with the short one the noise of div v
 * would stand for pressure. */
static PetscErrorCode PressureAtStart(Stepper stepper, PetscReal dt, PressureResult *result)
{
  const PetscReal h = KernelSmoothingLength(stepper->cloud->kernel), velocity = stepper->reference_velocity;
  const PetscReal flow_dt = velocity > 0 ? PetscMax(dt, stepper->cfl * h / velocity) : dt;

  PetscFunctionBegin;
  PetscCall(Predict(stepper, flow_dt));
  PetscCall(PressureSolve(stepper->pressure, flow_dt, result));
  PetscCall(Predict(stepper, dt));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PressureCompressed(Stepper stepper, PetscReal dt, PressureResult *result)
{
  Cloud cloud = stepper->cloud;

  PetscFunctionBegin;
  result->reason = KSP_CONVERGED_ITERATING;
  if (stepper->first && stepper->sound_projected) {
    PetscCall(PressureAtStart(stepper, dt, result));
    if (result->reason < 0) PetscFunctionReturn(PETSC_SUCCESS);
  } else {
    PetscCall(Compress(stepper, dt));
    PetscCall(CloudUpdate(cloud, FIELD_PRESSURE));
  }
  PetscCall(ExtendToWalls(stepper));
  PetscCall(CloudUpdate(cloud, FIELD_PRESSURE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SchemeWeaklyCompressible(Stepper stepper, PetscReal dt, PetscBool diagnose, StepTrial *trial)
{
  PetscFunctionBegin;
  PetscCall(ConsistentStep(stepper, dt, diagnose, PressureCompressed, trial));
  PetscFunctionReturn(PETSC_SUCCESS);
}
