/* Free bodies: solids with a mass, which the liquid and the body force accelerate. At the time t_0 of a push (FreePush)
   the velocity v and the angular velocity w change. Between two pushes a point moves as

     x(t) = C + shift + v (t - t_0) + R(w (t - t_0)) turn (X - C),

   with X its position and C the centre of mass at the start, R a rotation, shift and turn those at t_0. The moment of
   inertia rotates with the body. Torques change the angular momentum, from which w follows at each push. */
#include "bodies_impl.h"
#include "../scene/body.h"

/* Halvings of the largest extent of a shape, for its volume, centre and moment of inertia: to 1/1024 and 1/128. */
#define HALVINGS_PLANE 10
#define HALVINGS_SPACE 7
/* Allowed ratios of a body's density to that of the densest liquid, and of its moment of inertia to its mass times the
   square of its extent. A lighter body leaves the liquid within a few steps, a heavier one hardly moves; far outside
   the pressure solve fails. */
#define RATIO_MIN 1e-5
#define RATIO_MAX 1e9

/* The state that a checkpoint stores; PetscReal only, see FreeNumbers. */
typedef struct {
  PetscReal time;                                        /* t_0, s */
  PetscReal shift[DIM], turn[DIM][DIM];                  /* translation, m, and rotation matrix */
  PetscReal velocity[DIM], rate[DIM];                    /* m/s, rad/s */
  PetscReal spin[DIM];                                   /* angular momentum about the centre, kg m2/s */
  PetscReal force[RIGID_MOTIONS], excess[RIGID_MOTIONS]; /* see FreeForces */
} FreeState;

struct _p_Free {
  PetscReal     mass;                    /* kg; kg/m in two dimensions; 0: the solid is not free */
  PetscBool     turns;                   /* the body may rotate */
  PetscReal     friction, restitution;   /* coefficients of contacts */
  OptionNumbers given;                   /* -<s>_inertia, kg m2 */
  PetscReal     inertia[DIM][DIM];       /* at the start, kg m2 */
  PetscReal     inverse[DIM][DIM];       /* of the inertia at the time of FreeSetTime; 0 if the body may not rotate */
  PetscBool     moves[DIM];              /* the body may move in this direction */
  PetscReal     start[DIM], center[DIM]; /* centre of mass at the start and at the time of FreeSetTime, m */
  PetscReal     volume;                  /* of the shape, m3; m2 in two dimensions */
  PetscBool     frozen;                  /* see SceneFreeze */
  FreeState     now, saved;              /* the present state and that of SceneSave */
};

/* --- options --- */

const OptionRow FreeOptions[] = {
  {"-mass",
   "Mass of a solid that liquid and gravity move freely; in two dimensions kg per metre of depth; 0: the solid has the "
   "motion of its other options",
   "kg", "[0, inf)", ROW_REAL, offsetof(struct _p_Free, mass)},
  {"-inertia",
   "Moment of inertia of a solid with a mass about its centre: one number, or three about x, y and z; in two "
   "dimensions one number, per metre of depth",
   "kg m2", NULL, ROW_NUMBERS, offsetof(struct _p_Free, given), .fallback = "that of a constant density"},
  {"-turns", "A solid with a mass may rotate", NULL, NULL, ROW_BOOL, offsetof(struct _p_Free, turns)},
  {"-friction",
   "Friction of a solid with a mass on walls and solids that it touches: force along the surface over that across, at "
   "most; of two of them the geometric mean counts",
   "1", "[0, inf)", ROW_REAL, offsetof(struct _p_Free, friction)},
  {"-restitution",
   "Speed with which a solid with a mass leaves a wall or solid that it hits, over that with which it came; of two of "
   "them the geometric mean counts",
   "1", "[0, 1]", ROW_REAL, offsetof(struct _p_Free, restitution)},
  {.name = NULL},
};

PetscErrorCode FreeSetFromOptions(Body body, OptionItems PetscOptionsObject)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(&body->free));
  body->free->turns = (PetscBool)!body->domain->rings;
  PetscCall(DomainReadOptions(body->domain, PetscOptionsObject, FreeOptions, "SceneSetFromOptions", body->free));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses a free body that reaches out of the box, or in a box with a symmetry face. */
static PetscErrorCode CheckBounds(Body body)
{
  const Domain domain = body->domain;
  PetscReal    lower[DIM], upper[DIM];

  PetscFunctionBegin;
  body->shape->bounds(body, lower, upper);
  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscBool axis = DomainIsRadial(domain, d);

    for (PetscInt s = 0; s < 2; s++)
      PetscCheckUser(
        domain->face[d][s] != FACE_SYMMETRY || (axis && s == 0), domain->comm,
        "-%smass cannot be used with the symmetry face -box_%c%s: the force on the body would lack that of "
        "the liquid behind the face; compute the whole scene",
        body->prefix, "xyz"[d], s ? "max" : "min");
    PetscCheckUser(upper[d] <= domain->upper[d] && (axis || lower[d] >= domain->lower[d]), domain->comm,
                   "the solid %s has a mass and must lie wholly in the box; it reaches from %g to %g m along %c",
                   body->name, (double)lower[d], (double)upper[d], "xyz"[d]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Integrals over a shape: volume (m3), first moments (m4), and second moments (m5) about a point. */
typedef struct {
  PetscReal about[DIM]; /* m */
  PetscReal volume, first[DIM], second[DIM][DIM];
} Integrals;

/* Adds the cube with this centre and half of this edge (m), of which a share is in the shape. With rings a cube
   counts with the length of its ring. */
static void AddCube(Domain domain, const PetscReal x[DIM], PetscReal half, PetscReal share, Integrals *sum)
{
  PetscReal volume = share * DomainRingLength(domain, x, 1);

  for (PetscInt d = 0; d < domain->dim; d++) volume *= 2 * half;
  sum->volume += volume;
  for (PetscInt d = 0; d < DIM; d++) {
    sum->first[d] += volume * (DomainIsRadial(domain, d) ? 0 : x[d]);
    for (PetscInt e = 0; e < DIM; e++)
      sum->second[d][e] += volume * ((x[d] - sum->about[d]) * (x[e] - sum->about[e]) + (d == e ? half * half / 3 : 0));
  }
}

/* Adds the part of a cube that is in the shape. A cube that the surface may cut is parted into halves a direction;
   after the last halving it counts with the share that a plane at its distance from the centre cuts off, so that thin
   walls of a hollow body have their volume. */
static void AddShape(Body body, const PetscReal x[DIM], PetscReal half, PetscInt halvings, Integrals *sum)
{
  const Domain    domain   = body->domain;
  const PetscReal distance = ShapeDistance(body, x), reach = half * PetscSqrtReal((PetscReal)domain->dim);

  if (distance >= reach) return;
  if (distance <= -reach) {
    AddCube(domain, x, half, 1, sum);
  } else if (halvings == 0) {
    AddCube(domain, x, half, PetscMin(PetscMax(0.5 - distance / (2 * half), 0), 1), sum);
  } else {
    for (PetscInt k = 0; k < 1 << domain->dim; k++) {
      PetscReal center[DIM] = {0, 0, 0};

      for (PetscInt d = 0; d < domain->dim; d++) center[d] = x[d] + (k >> d & 1 ? half : -half) / 2;
      AddShape(body, center, half / 2, halvings - 1, sum);
    }
  }
}

/* Integrals over the shape less its holes, the second moments about the point 'about' (m). */
static Integrals IntegrateShape(Body body, const PetscReal about[DIM])
{
  const Domain domain = body->domain;
  PetscReal    lower[DIM], upper[DIM], center[DIM] = {0, 0, 0}, half = 0;
  Integrals    sum = {.about = {about[0], about[1], about[2]}};

  body->shape->bounds(body, lower, upper);
  for (PetscInt d = 0; d < domain->dim; d++) {
    if (DomainIsRadial(domain, d)) lower[d] = PetscMax(lower[d], 0);
    half = PetscMax(half, (upper[d] - lower[d]) / 2);
  }
  for (PetscInt d = 0; d < domain->dim; d++)
    center[d] = DomainIsRadial(domain, d) ? lower[d] + half : (lower[d] + upper[d]) / 2;
  AddShape(body, center, half, domain->dim == 3 ? HALVINGS_SPACE : HALVINGS_PLANE, &sum);
  return sum;
}

/* Sets the moment of inertia at the start: as given, or that of a constant density. */
static PetscErrorCode SetInertia(Body body, const PetscReal center[DIM])
{
  const Domain    domain = body->domain;
  struct _p_Free *f      = body->free;
  const PetscBool one = (PetscBool)(f->given.count == 1), flat = (PetscBool)(domain->dim == 2);
  Integrals       shape;
  PetscReal       trace = 0;

  PetscFunctionBegin;
  PetscCheckUser(f->given.count == 0 || one || (f->given.count == DIM && !flat), domain->comm,
                 "-%sinertia must have %s", body->prefix, flat ? "one number" : "one number or three");
  for (PetscInt d = 0; d < f->given.count; d++)
    PetscCheckUser(f->given.value[d] > 0, domain->comm, "-%sinertia must have positive numbers", body->prefix);
  if (!f->turns) PetscFunctionReturn(PETSC_SUCCESS);
  shape = IntegrateShape(body, center);
  for (PetscInt d = 0; d < DIM; d++) trace += shape.second[d][d];
  for (PetscInt d = 0; d < DIM; d++)
    for (PetscInt e = 0; e < DIM; e++)
      f->inertia[d][e] = f->given.count ? (d == e ? f->given.value[one ? 0 : d] : 0)
                                        : f->mass / shape.volume * ((d == e ? trace : 0) - shape.second[d][e]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FreeSetUp(Body body, PetscBool centered, PetscReal center[DIM], const PetscReal velocity[DIM],
                         const PetscReal rate[DIM])
{
  const Domain    domain      = body->domain;
  struct _p_Free *f           = body->free;
  const PetscReal origin[DIM] = {0, 0, 0};
  Integrals       shape;

  PetscFunctionBegin;
  PetscCheckUser(f->mass > 0 || (f->given.count == 0 && f->turns == !domain->rings), domain->comm,
                 "-%sinertia and -%sturns need -%smass: the solid %s is no free body", body->prefix, body->prefix,
                 body->prefix, body->name);
  if (f->mass == 0) {
    PetscCall(PetscFree(body->free));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCheckUser(
    !domain->rings || (!f->turns && f->given.count == 0), domain->comm,
    "with -dimension axisymmetric the solid %s can move along the axis only: -%sinertia and -%sturns cannot "
    "be used",
    body->name, body->prefix, body->prefix);
  PetscCall(CheckBounds(body));
  shape     = IntegrateShape(body, origin);
  f->volume = shape.volume;
  PetscCheckUser(f->volume > 0, domain->comm, "the solid %s has a mass but no volume", body->name);
  for (PetscInt d = 0; d < DIM && !centered; d++) center[d] = shape.first[d] / shape.volume;
  PetscCall(SetInertia(body, center));
  for (PetscInt d = 0; d < DIM; d++) {
    f->moves[d]        = (PetscBool)(d < domain->dim && !DomainIsRadial(domain, d));
    f->now.velocity[d] = velocity[d];
    f->now.rate[d]     = rate[d];
    f->now.turn[d][d]  = 1;
    f->start[d]        = center[d];
    for (PetscInt e = 0; e < DIM; e++) f->now.spin[d] += f->inertia[d][e] * rate[e];
  }
  PetscCheckUser(f->turns || Norm(rate) == 0, domain->comm, "-%srotation_rate cannot be used with -%sturns 0",
                 body->prefix, body->prefix);
  f->saved = f->now;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FreeCheck(Body body, PetscReal density)
{
  const Domain          domain = body->domain;
  const struct _p_Free *f      = body->free;
  const char           *flat   = DomainIsFlat(domain) ? "/m" : "";
  PetscReal             lower[DIM], upper[DIM], scale = 0;

  PetscFunctionBegin;
  if (!f) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheckUser(f->mass >= RATIO_MIN * density * f->volume && f->mass <= RATIO_MAX * density * f->volume, domain->comm,
                 "-%smass is %g kg%s; it must lie in [%.3g, %.3g]: liquid of the body's volume has %.3g kg%s",
                 body->prefix, (double)f->mass, flat, (double)(RATIO_MIN * density * f->volume),
                 (double)(RATIO_MAX * density * f->volume), (double)(density * f->volume), flat);
  body->shape->bounds(body, lower, upper);
  for (PetscInt d = 0; d < domain->dim; d++) {
    scale += f->mass * PetscSqr(upper[d] - lower[d]);
    PetscCheckUser(!f->moves[d] || (f->start[d] >= lower[d] && f->start[d] <= upper[d]), domain->comm,
                   "-%srotation_center: the centre of mass of the solid %s, which reaches from %g to %g m along %c, "
                   "cannot be at %g m",
                   body->prefix, body->name, (double)lower[d], (double)upper[d], "xyz"[d], (double)(f->start[d]));
  }
  for (PetscInt d = 0; d < f->given.count; d++)
    PetscCheckUser(f->given.value[d] >= RATIO_MIN * scale && f->given.value[d] <= RATIO_MAX * scale, domain->comm,
                   "-%sinertia has %g kg m2%s; with this mass and shape it must lie in [%.3g, %.3g]", body->prefix,
                   (double)f->given.value[d], flat, (double)(RATIO_MIN * scale), (double)(RATIO_MAX * scale));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode FreeView(Body body, PetscViewer viewer)
{
  const struct _p_Free *f            = body->free;
  const char           *flat         = DomainIsFlat(body->domain) ? "/m" : "";
  const PetscInt        dim          = body->domain->dim;
  const PetscReal       inertia[DIM] = {f->inertia[0][0], f->inertia[1][1], f->inertia[2][2]};
  char                  text[4][VECTOR_TEXT];

  PetscFunctionBegin;
  PetscCall(PetscViewerASCIIPushTab(viewer));
  PetscCall(PetscViewerASCIIPrintf(
    viewer,
    "moves freely: mass %g kg%s, %g kg/m3, inertia %s kg m2%s about %s m; at the start velocity %s m/s, "
    "rotation %s rad/s\n",
    (double)f->mass, flat, (double)(f->mass / f->volume), AxesText(dim, inertia, text[0]), flat,
    VectorText(dim, f->start, text[1]), VectorText(dim, f->now.velocity, text[2]),
    AxesText(dim, f->now.rate, text[3])));
  PetscCall(PetscViewerASCIIPopTab(viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- position and velocity --- */

void FreePose(Body body, PetscReal time, PetscReal shift[DIM], PetscReal turn[DIM][DIM])
{
  const FreeState *s  = &body->free->now;
  const PetscReal  on = body->free->frozen ? 0 : time - s->time; /* s */
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
    velocity[d] = f->frozen ? 0 : f->now.velocity[d];
    rate[d]     = f->frozen ? 0 : f->now.rate[d];
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

/* --- forces; the solid must be free --- */

void FreeMotion(Body solid, PetscReal center[DIM], PetscReal motion[RIGID_MOTIONS])
{
  const struct _p_Free *f = solid->free;
  const FreeState      *s = &f->now;

  for (PetscInt d = 0; d < DIM; d++) {
    center[d]       = f->center[d];
    motion[d]       = f->frozen ? 0 : s->velocity[d];
    motion[DIM + d] = f->frozen ? 0 : Dot(f->inverse[d], s->spin);
  }
}

void FreeResponse(Body solid, const PetscReal impulse[RIGID_MOTIONS], PetscReal change[RIGID_MOTIONS])
{
  const struct _p_Free *f = solid->free;

  for (PetscInt d = 0; d < DIM; d++) {
    change[d]       = f->moves[d] && !f->frozen ? impulse[d] / f->mass : 0;
    change[DIM + d] = f->frozen ? 0 : Dot(f->inverse[d], impulse + DIM);
  }
}

void FreePush(Body solid, PetscReal time, const PetscReal impulse[RIGID_MOTIONS])
{
  struct _p_Free *f = solid->free;
  FreeState      *s = &f->now;
  PetscReal       shift[DIM], turn[DIM][DIM];

  if (f->frozen) return;
  FreePose(solid, time, shift, turn);
  RotationStraighten(turn);
  s->time = time;
  for (PetscInt d = 0; d < DIM; d++) {
    s->shift[d] = shift[d];
    s->velocity[d] += f->moves[d] ? impulse[d] / f->mass : 0;
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

void FreeAddForce(Body solid, const PetscReal x[DIM], const PetscReal force[DIM], const PetscReal normal[],
                  PetscReal sum[RIGID_MOTIONS])
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

PetscReal FreeFriction(Body solid)
{
  return solid->free->friction;
}

PetscReal FreeRestitution(Body solid)
{
  return solid->free->restitution;
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

PetscBool SceneHasFree(Scene scene)
{
  for (PetscInt b = 0; b < SceneSolidCount(scene); b++)
    if (BodyMass(SceneSolid(scene, b)) > 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

void SceneStart(Scene scene, PetscReal time)
{
  for (PetscInt b = 0; b < SceneSolidCount(scene); b++)
    if (BodyMass(SceneSolid(scene, b)) > 0) SceneSolid(scene, b)->free->now.time = time;
}

void SceneFreeze(Scene scene, PetscBool frozen)
{
  for (PetscInt b = 0; b < SceneSolidCount(scene); b++)
    if (BodyMass(SceneSolid(scene, b)) > 0) {
      struct _p_Free *f = SceneSolid(scene, b)->free;

      f->frozen = frozen;
      for (PetscInt k = 0; k < RIGID_MOTIONS && !frozen; k++) f->now.force[k] = f->now.excess[k] = 0;
    }
}

void SceneSave(Scene scene)
{
  for (PetscInt b = 0; b < SceneSolidCount(scene); b++)
    if (BodyMass(SceneSolid(scene, b)) > 0) SceneSolid(scene, b)->free->saved = SceneSolid(scene, b)->free->now;
}

void SceneRestore(Scene scene)
{
  for (PetscInt b = 0; b < SceneSolidCount(scene); b++)
    if (BodyMass(SceneSolid(scene, b)) > 0) SceneSolid(scene, b)->free->now = SceneSolid(scene, b)->free->saved;
}
