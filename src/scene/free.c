/* Solids that move freely: bodies of a given mass, which the liquid and the body force push. Between the moments at
   which the stepper gives them a new velocity they move on with the one they have:

     x(t) = C + shift + v (t - t_0) + R(w (t - t_0)) turn (X - C),

   X the place at the start, C the centre of mass there, t_0 the last such moment, R a rotation. Their moment of inertia
   turns with them; what torques change is the angular momentum. */
#include "scene_impl.h"

#define SAMPLES 64 /* of a shape a direction, for its volume, centre and moment of inertia */
/* What a body's density may be over that of the densest liquid, and its moment of inertia over its mass times the
   square of its extent. Lighter ones are thrown out of the liquid within steps, heavier ones are as good as held; far
   beyond, the pressure cannot be solved for. */
#define LEAST_SHARE 1e-5
#define MOST_SHARE  1e9

/* What changes, and what a checkpoint holds: numbers only. */
typedef struct {
  PetscReal time;                                      /* t_0, s */
  PetscReal shift[DIM], turn[DIM][DIM];                /* m, 1 */
  PetscReal velocity[DIM], rate[DIM];                  /* m/s, rad/s */
  PetscReal spin[DIM];                                 /* angular momentum about the centre, kg m2/s */
  PetscReal force[FREE_MOTIONS], excess[FREE_MOTIONS]; /* of FreeForces */
} FreeState;

struct _p_Free {
  PetscReal mass;                    /* kg; kg/m in two dimensions; 0: the solid is not free */
  PetscBool turns;                   /* it may */
  PetscReal given[DIM + 1];          /* moments of inertia about x, y, z, kg m2; one number more, to notice too many */
  PetscInt  numbers;                 /* of them */
  PetscReal inertia[DIM][DIM];       /* at the start */
  PetscReal inverse[DIM][DIM];       /* its inverse at the time set last; 0 if the body does not turn */
  PetscBool here[DIM];               /* directions in which it may move */
  PetscReal start[DIM], center[DIM]; /* centre of mass at the start, at the time set last, m */
  PetscReal volume;                  /* of the shape, m3; m2 in two dimensions */
  PetscBool held;                    /* it does not move for now */
  FreeState now, kept;
};

/* --- options --- */

PetscErrorCode FreeSetFromOptions(Body body, OptionItems PetscOptionsObject)
{
  struct _p_Free *f;

  PetscFunctionBegin;
  PetscCall(PetscNew(&f));
  body->free = f;
  f->turns   = (PetscBool)!body->domain->rings;
  f->numbers = DIM + 1;
  PetscCall(OptionReal("-mass",
                       "Mass with which a solid moves freely, pushed by the liquid and gravity (kg); in two dimensions "
                       "kg per metre of depth; 0: it moves as its other options say",
                       "[0, inf)", &f->mass));
  PetscCall(PetscOptionsRealArray("-inertia",
                                  "Moment of inertia of a solid of a mass about its centre (kg m2), one number, or "
                                  "three, about x, y and z; in two dimensions one, per metre of depth; default: of its "
                                  "shape, evenly filled",
                                  "SceneSetFromOptions", f->given, &f->numbers, NULL));
  PetscCall(PetscOptionsBool("-turns", "A solid of a mass may turn", "SceneSetFromOptions", f->turns, &f->turns, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses where a free body cannot be. */
static PetscErrorCode CheckPlace(Body body)
{
  const Domain domain = body->domain;
  PetscReal    lower[DIM], upper[DIM];

  PetscFunctionBegin;
  body->shape->bounds(body, lower, upper);
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscBool axis = (PetscBool)(domain->rings && d == 0);

    for (PetscInt s = 0; s < 2; s++)
      PetscCheckUser(domain->face[d][s] != FACE_SYMMETRY || (axis && s == 0), domain->comm,
                     "-%smass cannot be used with the symmetry face -box_%c%s: what the liquid does behind it would be "
                     "missing in the force on the body; compute the whole scene",
                     body->prefix, "xyz"[d], s ? "max" : "min");
    PetscCheckUser(upper[d] <= domain->upper[d] && (axis || lower[d] >= domain->lower[d]), domain->comm,
                   "the solid %s has a mass and must lie wholly in the box; it reaches from %g to %g m along %c",
                   body->name, (double)lower[d], (double)upper[d], "xyz"[d]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Volume (m3) of the shape, the middle of it (m), and the second moments of the middles of cells about 'about' (m5) for
   the moment of inertia, if that is given. Cells of rings count with their length. */
static void SampleShape(Body body, const PetscReal *about, PetscReal *volume, PetscReal middle[DIM],
                        PetscReal moment[DIM][DIM])
{
  const Domain domain = body->domain;
  PetscReal    lower[DIM], upper[DIM], cell = 1;

  body->shape->bounds(body, lower, upper);
  *volume = 0;
  for (PetscInt d = 0; d < DIM; d++) {
    middle[d] = 0;
    for (PetscInt e = 0; e < DIM && about; e++) moment[d][e] = 0;
    if (domain->rings && d == 0) lower[d] = PetscMax(lower[d], 0);
    if (d < domain->dim) cell *= (upper[d] - lower[d]) / SAMPLES;
  }
  for (PetscInt k = 0; k < PetscPowInt(SAMPLES, domain->dim); k++) {
    const PetscInt place[DIM] = {k % SAMPLES, k / SAMPLES % SAMPLES, k / (SAMPLES * SAMPLES)};
    PetscReal      x[DIM]     = {0, 0, 0}, share;

    for (PetscInt d = 0; d < domain->dim; d++)
      x[d] = lower[d] + (upper[d] - lower[d]) * ((PetscReal)place[d] + 0.5) / SAMPLES;
    if (body->shape->distance(body, x) > 0) continue;
    share = cell * DomainRingLength(domain, x, 1);
    *volume += share;
    for (PetscInt d = 0; d < DIM; d++) {
      middle[d] += share * (domain->rings && d == 0 ? 0 : x[d]);
      for (PetscInt e = 0; e < DIM && about; e++) moment[d][e] += share * (x[d] - about[d]) * (x[e] - about[e]);
    }
  }
  if (*volume > 0)
    for (PetscInt d = 0; d < DIM; d++) middle[d] /= *volume;
}

/* The moment of inertia at the start: as given, or of the shape evenly filled. */
static PetscErrorCode SetInertia(Body body, const PetscReal center[DIM])
{
  const Domain    domain = body->domain;
  struct _p_Free *f      = body->free;
  const PetscBool one = (PetscBool)(f->numbers == 1), flat = (PetscBool)(domain->dim == 2);
  PetscReal       volume, middle[DIM], moment[DIM][DIM], trace = 0;

  PetscFunctionBegin;
  PetscCheckUser(f->numbers == 0 || one || (f->numbers == DIM && !flat), domain->comm, "-%sinertia must have %s",
                 body->prefix, flat ? "one number" : "one number or three");
  for (PetscInt d = 0; d < f->numbers; d++)
    PetscCheckUser(f->given[d] > 0 && !PetscIsInfOrNanReal(f->given[d]), domain->comm,
                   "-%sinertia must have positive numbers", body->prefix);
  if (!f->turns) PetscFunctionReturn(PETSC_SUCCESS);
  SampleShape(body, center, &volume, middle, moment);
  for (PetscInt d = 0; d < DIM; d++) trace += moment[d][d];
  for (PetscInt d = 0; d < DIM; d++)
    for (PetscInt e = 0; e < DIM; e++)
      f->inertia[d][e] =
        f->numbers ? (d == e ? f->given[one ? 0 : d] : 0) : f->mass / volume * ((d == e ? trace : 0) - moment[d][e]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FreeSetUp(Body body, PetscBool centered, PetscReal center[DIM], const PetscReal velocity[DIM],
                         const PetscReal rate[DIM])
{
  const Domain    domain = body->domain;
  struct _p_Free *f      = body->free;
  PetscReal       middle[DIM];

  PetscFunctionBegin;
  PetscCheckUser(f->mass > 0 || (f->numbers == 0 && f->turns == !domain->rings), domain->comm,
                 "-%sinertia and -%sturns need -%smass: the solid %s does not move freely", body->prefix, body->prefix,
                 body->prefix, body->name);
  if (f->mass == 0) {
    PetscCall(PetscFree(body->free));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCheckUser(!domain->rings || (!f->turns && f->numbers == 0), domain->comm,
                 "with -dimension axisymmetric the solid %s can move along the axis only: -%sinertia and -%sturns have "
                 "no place",
                 body->name, body->prefix, body->prefix);
  PetscCall(CheckPlace(body));
  SampleShape(body, NULL, &f->volume, middle, NULL);
  PetscCheckUser(f->volume > 0, domain->comm, "the solid %s has a mass, but no volume", body->name);
  for (PetscInt d = 0; d < DIM && !centered; d++) center[d] = middle[d];
  PetscCall(SetInertia(body, center));
  for (PetscInt d = 0; d < DIM; d++) {
    f->here[d]         = (PetscBool)(d < domain->dim && !(domain->rings && d == 0));
    f->now.velocity[d] = velocity[d];
    f->now.rate[d]     = rate[d];
    f->now.turn[d][d]  = 1;
    f->start[d]        = center[d];
    for (PetscInt e = 0; e < DIM; e++) f->now.spin[d] += f->inertia[d][e] * rate[e];
  }
  PetscCheckUser(f->turns || Norm(rate) == 0, domain->comm, "-%srotation_rate has no place with -%sturns 0",
                 body->prefix, body->prefix);
  f->kept = f->now;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FreeCheck(Body body, PetscReal density)
{
  const Domain          domain = body->domain;
  const struct _p_Free *f      = body->free;
  const char           *flat   = domain->dim == 2 && !domain->rings ? "/m" : "";
  PetscReal             lower[DIM], upper[DIM], scale = 0;

  PetscFunctionBegin;
  if (!f) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheckUser(f->mass >= LEAST_SHARE * density * f->volume && f->mass <= MOST_SHARE * density * f->volume,
                 domain->comm,
                 "-%smass is %g kg%s; it must lie in [%.3g, %.3g]: the liquid in the body's place has %.3g kg%s",
                 body->prefix, (double)f->mass, flat, (double)(LEAST_SHARE * density * f->volume),
                 (double)(MOST_SHARE * density * f->volume), (double)(density * f->volume), flat);
  body->shape->bounds(body, lower, upper);
  for (PetscInt d = 0; d < domain->dim; d++) {
    scale += f->mass * PetscSqr(upper[d] - lower[d]);
    PetscCheckUser(!f->here[d] || (f->start[d] >= lower[d] && f->start[d] <= upper[d]), domain->comm,
                   "-%srotation_center: the solid %s has a mass and reaches from %g to %g m along %c; its centre of "
                   "mass cannot be at %g m",
                   body->prefix, body->name, (double)lower[d], (double)upper[d], "xyz"[d], (double)(f->start[d]));
  }
  for (PetscInt d = 0; d < f->numbers; d++)
    PetscCheckUser(f->given[d] >= LEAST_SHARE * scale && f->given[d] <= MOST_SHARE * scale, domain->comm,
                   "-%sinertia has %g kg m2%s; with this mass and shape its numbers must lie in [%.3g, %.3g]",
                   body->prefix, (double)f->given[d], flat, (double)(LEAST_SHARE * scale),
                   (double)(MOST_SHARE * scale));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FreeView(Body body, PetscViewer viewer)
{
  const struct _p_Free *f    = body->free;
  const char           *flat = body->domain->dim == 2 && !body->domain->rings ? "/m" : "";

  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPushTab(viewer));
  PetscCall(PetscViewerASCIIPrintf(viewer,
                                   "moves freely: mass %g kg%s, %g kg/m3, inertia %g, %g, %g kg m2%s about %g, %g, %g "
                                   "m; from velocity %g, %g, %g m/s, rotation %g, %g, %g rad/s on\n",
                                   (double)f->mass, flat, (double)(f->mass / f->volume), (double)f->inertia[0][0],
                                   (double)f->inertia[1][1], (double)f->inertia[2][2], flat, (double)f->start[0],
                                   (double)f->start[1], (double)f->start[2], (double)f->now.velocity[0],
                                   (double)f->now.velocity[1], (double)f->now.velocity[2], (double)f->now.rate[0],
                                   (double)f->now.rate[1], (double)f->now.rate[2]));
  PetscCall(PetscViewerASCIIPopTab(viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- where it is --- */

void FreePlace(Body body, PetscReal time, PetscReal shift[DIM], PetscReal turn[DIM][DIM])
{
  const FreeState *s  = &body->free->now;
  const PetscReal  on = body->free->held ? 0 : time - s->time; /* s */
  PetscReal        further[DIM][DIM], before[DIM][DIM];

  for (PetscInt d = 0; d < DIM; d++) {
    shift[d] = s->shift[d] + on * s->velocity[d];
    for (PetscInt e = 0; e < DIM; e++) before[d][e] = s->turn[d][e];
  }
  RotationMatrix(s->rate, on, further);
  RotationMultiply(further, before, turn);
}

void FreeVelocity(Body body, PetscReal velocity[DIM], PetscReal rate[DIM])
{
  const struct _p_Free *f = body->free;

  for (PetscInt d = 0; d < DIM; d++) {
    velocity[d] = f->held ? 0 : f->now.velocity[d];
    rate[d]     = f->held ? 0 : f->now.rate[d];
  }
}

void FreeSetTime(Body body, const PetscReal shift[DIM], PetscReal turn[DIM][DIM])
{
  struct _p_Free *f = body->free;
  PetscReal       back[DIM][DIM], half[DIM][DIM], inertia[DIM][DIM];

  for (PetscInt d = 0; d < DIM; d++) f->center[d] = f->start[d] + shift[d];
  if (!f->turns) return;
  for (PetscInt d = 0; d < DIM; d++)
    for (PetscInt e = 0; e < DIM; e++) back[d][e] = turn[e][d];
  RotationMultiply(turn, f->inertia, half);
  RotationMultiply(half, back, inertia);
  RotationInverse(inertia, f->inverse);
}

/* --- what moves it; the solid must be free --- */

void FreeMotion(Body solid, PetscReal center[DIM], PetscReal motion[FREE_MOTIONS])
{
  const struct _p_Free *f = solid->free;
  const FreeState      *s = &f->now;

  for (PetscInt d = 0; d < DIM; d++) {
    center[d]       = f->center[d];
    motion[d]       = f->held ? 0 : s->velocity[d];
    motion[DIM + d] = f->held ? 0 : Dot(f->inverse[d], s->spin);
  }
}

void FreeResponse(Body solid, const PetscReal impulse[FREE_MOTIONS], PetscReal change[FREE_MOTIONS])
{
  const struct _p_Free *f = solid->free;

  for (PetscInt d = 0; d < DIM; d++) {
    change[d]       = f->here[d] && !f->held ? impulse[d] / f->mass : 0;
    change[DIM + d] = f->held ? 0 : Dot(f->inverse[d], impulse + DIM);
  }
}

void FreePush(Body solid, PetscReal time, const PetscReal impulse[FREE_MOTIONS])
{
  struct _p_Free *f = solid->free;
  FreeState      *s = &f->now;
  PetscReal       shift[DIM], turn[DIM][DIM];

  if (f->held) return;
  FreePlace(solid, time, shift, turn);
  RotationStraighten(turn);
  s->time = time;
  for (PetscInt d = 0; d < DIM; d++) {
    s->shift[d] = shift[d];
    s->velocity[d] += f->here[d] ? impulse[d] / f->mass : 0;
    s->spin[d] += f->turns ? impulse[DIM + d] : 0;
    for (PetscInt e = 0; e < DIM; e++) s->turn[d][e] = turn[d][e];
  }
  for (PetscInt d = 0; d < DIM; d++) s->rate[d] = Dot(f->inverse[d], s->spin);
}

void FreeForces(Body solid, PetscReal **force, PetscReal **excess)
{
  struct _p_Free *f = solid->free;

  *force  = f->now.force;
  *excess = f->now.excess;
}

void FreeAdd(Body solid, const PetscReal x[DIM], const PetscReal force[DIM], const PetscReal normal[],
             PetscReal sum[FREE_MOTIONS])
{
  PetscReal arm[DIM], acting[DIM], torque[DIM];

  for (PetscInt d = 0; d < DIM; d++) {
    arm[d]    = x[d] - solid->free->center[d];
    acting[d] = normal ? Dot(force, normal) * normal[d] : force[d];
  }
  DomainNearest(solid->domain, arm);
  Cross(arm, acting, torque);
  for (PetscInt d = 0; d < DIM; d++) {
    sum[d] += force[d];
    sum[DIM + d] += torque[d];
  }
}

PetscReal BodyMass(Body solid)
{
  return solid->free ? solid->free->mass : 0;
}

PetscReal *FreeNumbers(Body solid, PetscInt *count)
{
  *count = (PetscInt)(sizeof(FreeState) / sizeof(PetscReal));
  return (PetscReal *)&solid->free->now;
}

PetscReal FreeKinetic(Body solid)
{
  const FreeState *s = &solid->free->now;

  return 0.5 * (solid->free->mass * Dot(s->velocity, s->velocity) + Dot(s->rate, s->spin));
}

void FreeTurned(Body solid, PetscReal angle[DIM])
{
  RotationVector(solid->free->now.turn, angle);
}

void FreeStart(Body solid, PetscReal center[DIM], PetscReal inertia[DIM], PetscBool *turns)
{
  const struct _p_Free *f = solid->free;

  *turns = f->turns;
  for (PetscInt d = 0; d < DIM; d++) {
    center[d]  = f->start[d];
    inertia[d] = f->inertia[d][d];
  }
}

PetscBool SceneHasFree(Scene scene)
{
  for (PetscInt b = 0; b < scene->solids; b++)
    if (BodyMass(scene->solid[b]) > 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

void SceneStart(Scene scene, PetscReal time)
{
  for (PetscInt b = 0; b < scene->solids; b++)
    if (BodyMass(scene->solid[b]) > 0) scene->solid[b]->free->now.time = time;
}

void SceneFreeze(Scene scene, PetscBool frozen)
{
  for (PetscInt b = 0; b < scene->solids; b++)
    if (BodyMass(scene->solid[b]) > 0) {
      struct _p_Free *f = scene->solid[b]->free;

      f->held = frozen;
      for (PetscInt k = 0; k < FREE_MOTIONS && !frozen; k++) f->now.force[k] = f->now.excess[k] = 0;
    }
}

PetscBool SceneDriven(Scene scene)
{
  for (PetscInt b = 0; b < scene->solids; b++)
    if (scene->solid[b]->motion && BodyMass(scene->solid[b]) == 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

void SceneSave(Scene scene)
{
  for (PetscInt b = 0; b < scene->solids; b++)
    if (BodyMass(scene->solid[b]) > 0) scene->solid[b]->free->kept = scene->solid[b]->free->now;
}

void SceneRestore(Scene scene)
{
  for (PetscInt b = 0; b < scene->solids; b++)
    if (BodyMass(scene->solid[b]) > 0) scene->solid[b]->free->now = scene->solid[b]->free->kept;
}
