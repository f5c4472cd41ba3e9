/* The size of the time step. */
#include "stepper_impl.h"

#define VISCOUS_LIMIT   0.08 /* dt <= this h^2/nu: 0.125 is marginal for the form of Morris et al. */
#define LAST_LONGER     1e-3 /* a last step may be longer by this share of it */
#define CAPILLARY_LIMIT 0.25 /* dt <= this sqrt(rho h^3/(2 pi sigma)) (Brackbill et al. 1992) */
#define FORCE_LIMIT     0.03 /* dt <= this sqrt(h/|g|): a jittered film at rest is stable at 0.03, not at 0.045 */
#define SPRAY_SHARE     0.8  /* of -displacement_max that it may move in a step */
#define GROWTH          1.2  /* from one step to the next, at most */
#define SAMPLES         5    /* points a direction at which the initial velocity of a body is read */

/* Decides whether the viscosity is implicit in a step that all else would allow; returns the step viscosity allows. */
static PetscReal Viscosity(Stepper stepper, PetscReal step, PetscReal limit)
{
  Viscous *viscous = &stepper->viscous;

  viscous->implicit = (PetscBool)(limit < PETSC_MAX_REAL && (viscous->solver == VISCOUS_IMPLICIT ||
                                                             (viscous->solver == VISCOUS_AUTO && step > limit)));
  if (!viscous->implicit) return PetscMin(step, limit);
  return viscous->ratio > 0 ? PetscMin(step, viscous->ratio * limit) : step;
}

PetscErrorCode StepSize(Stepper stepper, const StepState *state, PetscReal end, PetscReal *dt)
{
  Cloud           cloud = stepper->cloud;
  const PetscReal h = KernelSmoothingLength(cloud->kernel), left = end - state->time;
  ParticleArrays  arrays;
  PetscReal       local[3] = {0, 0, 0}, largest[3], step = PETSC_MAX_REAL;

  PetscFunctionBegin;
  PetscCall(ParticlesOpen(cloud->particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) {
    const PetscReal speed = Norm(arrays.real[FIELD_VELOCITY] + DIM * a);
    PetscReal       g[DIM];

    if (arrays.integer[INT_LAYER][a]) continue;
    SceneAcceleration(cloud->scene, arrays.real[FIELD_POSITION] + DIM * a, g);
    if (arrays.real[FIELD_LAMBDA][a] > SPRAY_LAMBDA || state->step == 0)
      local[0] = PetscMax(local[0], speed);
    else
      local[2] = PetscMax(local[2], speed);
    local[1] = PetscMax(local[1], Norm(g));
  }
  PetscCall(ParticlesClose(cloud->particles, &arrays));
  PetscCallMPI(MPI_Allreduce(local, largest, 3, MPIU_REAL, MPIU_MAX, cloud->comm));
  stepper->bounds = (StepBounds){PETSC_MAX_REAL, PETSC_MAX_REAL, PETSC_MAX_REAL, PETSC_MAX_REAL};
  if (largest[0] > 0) step = PetscMin(step, stepper->cfl * h / largest[0]);
  if (stepper->sound_speed > 0)
    step = PetscMin(step, stepper->sound_cfl * h / (stepper->sound_speed + PetscMax(largest[0], largest[2])));
  if (largest[2] > 0)
    step = PetscMin(step, SPRAY_SHARE * stepper->displacement_max * cloud->domain->spacing / largest[2]);
  stepper->bounds.speed = step;
  if (largest[1] > 0) stepper->bounds.force = FORCE_LIMIT * PetscSqrtReal(h / largest[1]);
  step = PetscMin(step, stepper->bounds.force);
  for (PetscInt b = 0; b < SceneCount(cloud->scene); b++) {
    const Material *m = BodyMaterial(SceneBody(cloud->scene, b));

    if (m->viscosity > 0)
      stepper->bounds.viscosity =
        PetscMin(stepper->bounds.viscosity, VISCOUS_LIMIT * h * h * m->density / m->viscosity);
    if (m->tension > 0 && TensionReach(stepper->tension) > 0)
      stepper->bounds.tension =
        PetscMin(stepper->bounds.tension,
                 CAPILLARY_LIMIT * PetscSqrtReal(m->density * h * h * h / (2 * PETSC_PI * m->tension)));
  }
  step = PetscMin(step, stepper->bounds.tension);
  /* the first step takes the scene's own velocity for the one the particles will soon have, and so
     does a relaxation, which must use the steps of the run: pressure noise depends on them */
  if ((state->previous_time_step == 0 || stepper->damping < 1) && stepper->reference_velocity > 0)
    step = PetscMin(step, stepper->cfl * h / stepper->reference_velocity);
  if (state->previous_time_step > 0) step = PetscMin(step, GROWTH * state->previous_time_step);
  if (stepper->step_max > 0) step = PetscMin(step, stepper->step_max);
  step = Viscosity(stepper, step, stepper->bounds.viscosity);
  step = PetscMax(step, stepper->step_min);
  if (stepper->step_fixed > 0) {
    step = stepper->step_fixed;
    (void)Viscosity(stepper, step, stepper->bounds.viscosity);
  }
  /* no tiny last step, whose pressure would be noise over dt: it takes what round-off has left in the sum of a million
     steps; of steps that may be chosen the last two share what is left */
  if (left <= step * (1 + LAST_LONGER))
    step = left;
  else if (left < 2 * step && stepper->step_fixed == 0)
    step = 0.5 * left;
  *dt = step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

StepBounds StepperBounds(Stepper stepper)
{
  return stepper->bounds;
}

/* Largest speed (bodies and walls, m/s), acceleration of each direction (m/s2) and fall through the body (m2/s2), and
   surface tension over density and smoothing length (m2/s2) of the scene. */
typedef struct {
  PetscReal speed, acceleration[DIM], fall, capillary;
} Scales;

static void FindScales(Stepper stepper, Scales *scales)
{
  Cloud           cloud = stepper->cloud;
  const PetscReal h     = KernelSmoothingLength(cloud->kernel);

  *scales = (Scales){0};
  for (PetscInt b = 0; b < SceneCount(cloud->scene); b++) {
    Body            body = SceneBody(cloud->scene, b);
    const Material *m    = BodyMaterial(body);
    PetscReal       lower[DIM], upper[DIM], g[DIM], v[DIM], x[DIM];

    BodyBounds(body, lower, upper);
    for (PetscInt k = 0; k < SAMPLES * SAMPLES * SAMPLES; k++) {
      const PetscInt at[DIM] = {k % SAMPLES, (k / SAMPLES) % SAMPLES, k / (SAMPLES * SAMPLES)};

      for (PetscInt d = 0; d < DIM; d++) x[d] = lower[d] + (upper[d] - lower[d]) * at[d] / (SAMPLES - 1);
      BodyVelocity(body, x, v);
      SceneAcceleration(cloud->scene, x, g);
      scales->speed = PetscMax(scales->speed, Norm(v));
      for (PetscInt d = 0; d < DIM; d++) {
        scales->acceleration[d] = PetscMax(scales->acceleration[d], PetscAbsReal(g[d]));
        scales->fall            = PetscMax(scales->fall, PetscAbsReal(g[d]) * (upper[d] - lower[d]));
      }
    }
    if (TensionReach(stepper->tension) > 0)
      scales->capillary = PetscMax(scales->capillary, m->tension / (m->density * h));
  }
  for (PetscInt f = 0; f < DIM * 2; f++)
    scales->speed = PetscMax(scales->speed, Norm(cloud->domain->wall_velocity[f / 2][f % 2]));
}

PetscReal StepperReferenceVelocity(Stepper stepper)
{
  Scales scales;

  FindScales(stepper, &scales);
  return PetscSqrtReal(scales.speed * scales.speed + scales.fall + scales.capillary);
}

PetscReal StepperEnergyAtHand(Stepper stepper)
{
  const Domain domain = stepper->cloud->domain;
  Scales       scales;
  PetscReal    energy;

  FindScales(stepper, &scales);
  if (SceneEmits(stepper->cloud->scene)) return 0;
  energy = 0.5 * scales.speed * scales.speed + scales.capillary;
  for (PetscInt d = 0; d < domain->dim; d++) {
    if (scales.acceleration[d] > 0 && domain->face[d][0] == FACE_PERIODIC) return 0;
    energy += scales.acceleration[d] * (domain->upper[d] - domain->lower[d]);
  }
  return energy;
}
