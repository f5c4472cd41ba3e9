/* The cheapest model that holds for a scene: SceneModel, which every -dry_run and scene.json tell. Its
   symmetries are found by trying: what is at a point of the scene must be at the image of this point, too, for points
   in and around each body and in the box. If something in the scene depends on the time, this must be so at many
   moments: those where motions, swinging gravity and emitters are extreme (SceneMoments), and some at golden-ratio
   distances, which no period has. So the symmetries hold for any shape, motion and force. A place where a surface is
   nearer than a tenth of a spacing says nothing: the particles cannot tell either. */
#include "../scene/body.h"
#include "../stepper/edge.h"
#include "sim_impl.h"

#define POINTS       3000 /* in the bounds of each body, and in the box */
#define SETS         8    /* with more bodies there are fewer points of each, down to POINTS_LEAST */
#define POINTS_LEAST 500
#define MARGIN       0.1  /* by which the bounds of a body are widened, of their extent */
#define NEAR         0.1  /* spacings from a surface within which it is not known what a point is in */
#define SAME         1e-6 /* of the largest value of the scene, for velocities, accelerations, sizes */
#define SEED         1
#define MOMENTS      16                  /* at golden-ratio distances */
#define MOMENTS_MOST 80                  /* with the extreme ones */
#define GOLDEN       0.61803398874989485 /* is the ratio that fractions approximate worst */
#define LONG         10.                 /* s, that are looked at of a run without an end */
#define TURNS        3
#define SHIFTS       2
#define SMALL        0.01 /* share that counts as nothing */
#define FAST         1e3  /* 1/s, a shear rate at which liquid is thin */

/* What is at a place. */
typedef struct {
  Body      body; /* of liquid; a solid; a hole or the open air */
  PetscInt  liquid;
  PetscInt  emits; /* 0: no emitter; else 1 and the fillings so far */
  PetscReal spacing, velocity[DIM], force[DIM];
  PetscInt  member; /* the body of liquid */
  PetscReal x[DIM]; /* m, in the box */
  PetscBool near;   /* a surface is */
} Place;

/* A map of the space: x -> turn (x - center) + center + shift. */
typedef struct {
  PetscReal turn[DIM][DIM], center[DIM], shift[DIM];
} Map;

typedef struct {
  Sim       sim;
  PetscInt  moments;
  PetscReal moment[MOMENTS_MOST]; /* s */
  PetscReal center[DIM];          /* m, of the whole scene: the middle of the box, or its mirror at a lower face */
  PetscBool folded[DIM];          /* the lower face is that mirror */
  PetscReal speed, force;         /* the largest, m/s, m/s2 */
} Model;

/* What is at x, which a mirror through the middle of the whole scene folds back into the box; 'parity' takes the
   velocities back. */
static void Look(const Model *model, PetscReal time, const PetscReal at[DIM], Place *place)
{
  const Sim       sim   = model->sim;
  const Scene     scene = sim->scene;
  const PetscReal near  = NEAR * sim->domain->spacing;
  PetscReal       x[DIM], parity[DIM], wall;
  PetscInt        solid = -1;

  *place = (Place){.near = PETSC_FALSE};
  for (PetscInt d = 0; d < DIM; d++) {
    parity[d] = model->folded[d] && at[d] < model->center[d] ? -1 : 1;
    x[d]      = model->center[d] + parity[d] * (at[d] - model->center[d]);
  }
  for (PetscInt d = 0; d < DIM; d++) place->x[d] = x[d];
  wall        = SceneSolidDistance(scene, x, &solid);
  place->near = (PetscBool)(PetscAbsReal(wall) < near);
  if (wall < 0) {
    place->body = SceneSolid(scene, solid);
    BodyMotion(place->body, time, x, place->velocity);
  }
  for (PetscInt b = 0; b < SceneCount(scene) && !place->body; b++) {
    const Body      body     = SceneBody(scene, b);
    const PetscReal distance = BodyDistance(body, x); /* a face that is periodic cuts liquid, too */

    place->near = (PetscBool)(place->near || PetscAbsReal(distance) < near);
    if (distance >= 0) continue;
    place->body   = body;
    place->member = b;
    place->liquid = SceneLiquid(scene, b);
    place->emits  = BodyComesLater(body) ? 1 + BodyFillings(body, time) : 0;
    if (BodyComesLater(body))
      BodyFillingVelocity(body, time, x, place->velocity);
    else
      BodyVelocity(body, x, place->velocity);
  }
  if (!place->body) place->body = SceneHoleAt(scene, x);
  if (sim->domain->graded && !sim->domain->adaptive) place->spacing = SceneSpacing(scene, x);
  SceneAcceleration(scene, x, place->force);
  for (PetscInt d = 0; d < DIM; d++) {
    place->velocity[d] *= parity[d];
    place->force[d] *= parity[d];
  }
}

static void Turned(const Map *map, const PetscReal v[DIM], PetscReal out[DIM])
{
  for (PetscInt d = 0; d < DIM; d++) out[d] = Dot(map->turn[d], v);
}

static PetscReal Difference(const Map *map, const PetscReal v[DIM], const PetscReal image[DIM])
{
  PetscReal turned[DIM];

  Turned(map, v, turned);
  for (PetscInt d = 0; d < DIM; d++) turned[d] -= image[d];
  return Norm(turned);
}

/* Whether liquid at both places has the same at the start of all that it carries and that a mirror does not turn. */
static PetscBool CarriesAlike(Scene scene, const Place *one, const Place *other)
{
  for (const Edge *const *edge = StepEdges; *edge; edge++)
    for (const EdgeField *row = (*edge)->fields; row && row->needed; row++) {
      PetscReal a, b;

      if (!row->start || Fields[row->field].width > 1 || !row->needed(scene, NULL)) continue;
      row->start(scene, one->member, one->x, &a);
      row->start(scene, other->member, other->x, &b);
      if (PetscAbsReal(a - b) > SAME * PetscMax(PetscAbsReal(a), PetscAbsReal(b))) return PETSC_FALSE;
    }
  return PETSC_TRUE;
}

/* Whether x and its image are alike. */
static PetscBool Alike(const Model *model, PetscReal time, const Map *map, const PetscReal x[DIM], const char **what)
{
  PetscReal r[DIM], y[DIM];
  Place     one, other;

  for (PetscInt d = 0; d < DIM; d++) r[d] = x[d] - map->center[d];
  Turned(map, r, y);
  for (PetscInt d = 0; d < DIM; d++) y[d] += map->center[d] + map->shift[d];
  Look(model, time, x, &one);
  Look(model, time, y, &other);
  if (one.near || other.near) return PETSC_TRUE;
  *what = one.body->own.owner != other.body->own.owner ? "what is there differs" : "materials or spacings differ";
  if (!BodiesAlike(one.body, other.body) || one.liquid != other.liquid || one.emits != other.emits ||
      PetscAbsReal(one.spacing - other.spacing) > NEAR * model->sim->domain->spacing)
    return PETSC_FALSE;
  *what = "what liquid carries differs";
  if (one.body->own.owner == OWNER_BODY && !CarriesAlike(model->sim->scene, &one, &other)) return PETSC_FALSE;
  *what = "velocities differ";
  if (Difference(map, one.velocity, other.velocity) > SAME * model->speed) return PETSC_FALSE;
  *what = "forces differ";
  return (PetscBool)(Difference(map, one.force, other.force) <= SAME * model->force);
}

/* Body or solid s, NULL beyond the last. */
static Body Member(const Model *model, PetscInt s)
{
  const Scene    scene = model->sim->scene;
  const PetscInt solid = s - SceneCount(scene);

  return solid < 0 ? SceneBody(scene, s) : solid < SceneSolidCount(scene) ? SceneSolid(scene, solid) : NULL;
}

/* Point k within bounds. */
static void Point(PetscInt k, const PetscReal lower[DIM], const PetscReal upper[DIM], PetscReal x[DIM])
{
  for (PetscInt d = 0; d < DIM; d++)
    x[d] = lower[d] + RandomUnit(SEED, (unsigned long long)(DIM * k + d)) * (upper[d] - lower[d]);
}

/* Bounds of the points of set s: the bodies', the solids', the box. Returns the name. */
static const char *Bounds(const Model *model, PetscInt s, PetscReal lower[DIM], PetscReal upper[DIM])
{
  const Domain domain = model->sim->domain;
  const Body   body   = Member(model, s);

  if (body) BodyBounds(body, lower, upper);
  for (PetscInt d = 0; d < DIM; d++) {
    const PetscReal margin = body ? MARGIN * (upper[d] - lower[d]) : 0;

    lower[d] = body ? PetscMax(lower[d] - margin, domain->lower[d]) : domain->lower[d];
    upper[d] = body ? PetscMin(upper[d] + margin, domain->upper[d]) : domain->upper[d];
  }
  return body ? BodyName(body) : "the box";
}

/* The moments at which the scene is looked at: the start alone if nothing depends on the time. */
static void FindMoments(Model *model)
{
  const Sim       sim   = model->sim;
  const PetscReal start = sim->state.time, end = sim->has_end ? sim->time_end : start + LONG;

  model->moments = SceneMoments(sim->scene, start, end, MOMENTS_MOST - MOMENTS, model->moment);
  for (PetscInt k = 0; model->moments && k < MOMENTS; k++)
    model->moment[model->moments + k] = start + (end - start) * ((k + 1) * GOLDEN - PetscFloorReal((k + 1) * GOLDEN));
  model->moments += model->moments ? MOMENTS : 0;
  if (!model->moments) model->moment[model->moments++] = start;
}

/* For each point of all sets and each moment; 'ok' says in 'why' what is wrong. */
static PetscBool AtAll(const Model *model,
                       PetscBool (*ok)(const Model *, PetscReal, const PetscReal[], const void *, const char **),
                       const void *context, char why[])
{
  const Scene     scene  = model->sim->scene;
  const PetscInt  sets   = SceneCount(scene) + SceneSolidCount(scene) + 1;
  const PetscInt  points = PetscMax(POINTS_LEAST, POINTS * PetscMin(sets, SETS) / sets);
  const PetscReal now = SceneSolidTime(scene), then = SceneTime(scene);
  PetscBool       good = PETSC_TRUE;
  const char     *what = "";

  for (PetscInt t = 0; t < model->moments && good; t++) {
    const PetscReal time = model->moment[t];

    SceneMoveSolids(scene, time);
    SceneSetTime(scene, time);
    for (PetscInt s = 0; s < sets && good; s++) {
      PetscReal         lower[DIM], upper[DIM];
      const char *const name = Bounds(model, s, lower, upper);

      for (PetscInt k = 0; k < points && good; k++) {
        PetscReal x[DIM];

        Point(k, lower, upper, x);
        good = ok(model, time, x, context, &what);
        if (!good)
          (void)PetscSNPrintf(why, MODEL_WHY, "%s, at %.3g, %.3g, %.3g m and %.3g s (%s)", what, (double)x[0],
                              (double)x[1], (double)x[2], (double)time, name);
      }
    }
  }
  SceneMoveSolids(scene, now);
  SceneSetTime(scene, then);
  return good;
}

static PetscBool MirrorOk(const Model *model, PetscReal time, const PetscReal x[], const void *across,
                          const char **what)
{
  Map map = {.turn = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

  map.turn[*(const PetscInt *)across][*(const PetscInt *)across] = -1;
  for (PetscInt d = 0; d < DIM; d++) map.center[d] = model->center[d];
  return Alike(model, time, &map, x, what);
}

/* Points beside the largest circle in the box are compared with those on it at their height. */
static PetscBool TurnOk(const Model *model, PetscReal time, const PetscReal x[], const void *about, const char **what)
{
  const PetscReal angle[TURNS] = {0.5 * PETSC_PI, 2.4, 4};
  const Domain    domain       = model->sim->domain;
  const PetscInt  u = *(const PetscInt *)about, a = (u + 1) % DIM, b = (u + 2) % DIM;
  PetscReal       radius = PETSC_MAX_REAL, r[DIM], distance, y[DIM];
  Place           place;

  for (PetscInt d = 0; d < DIM; d++) {
    if (d != u) radius = PetscMin(radius, domain->upper[d] - model->center[d]);
    y[d] = x[d];
    r[d] = d == u ? 0 : x[d] - model->center[d];
  }
  distance = Norm(r);
  if (distance > radius)
    for (PetscInt d = 0; d < DIM; d++)
      if (d != u) y[d] = model->center[d] + r[d] * radius * (1 - SMALL) / distance;
  Look(model, time, x, &place);
  *what = "there is swirl";
  if (PetscAbsReal(r[a] * place.velocity[b] - r[b] * place.velocity[a]) > SAME * model->speed * distance)
    return PETSC_FALSE;
  for (PetscInt k = 0; k < TURNS; k++) {
    const PetscReal c = PetscCosReal(angle[k]), s = PetscSinReal(angle[k]);
    Map             map = {.turn = {{0}}};

    map.turn[u][u] = 1;
    map.turn[a][a] = map.turn[b][b] = c;
    map.turn[a][b]                  = -s;
    map.turn[b][a]                  = s;
    for (PetscInt d = 0; d < DIM; d++) map.center[d] = model->center[d];
    if (!Alike(model, time, &map, y, what)) return PETSC_FALSE;
  }
  if (distance > radius) {
    Map map = {.turn = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

    for (PetscInt d = 0; d < DIM; d++) map.shift[d] = y[d] - x[d];
    return Alike(model, time, &map, x, what);
  }
  return PETSC_TRUE;
}

static PetscBool AlongOk(const Model *model, PetscReal time, const PetscReal x[], const void *along, const char **what)
{
  const PetscReal share[SHIFTS] = {1 - GOLDEN, 0.25 * GOLDEN}; /* of the box; a row of equal bodies has neither */
  const Domain    domain        = model->sim->domain;
  const PetscInt  d             = *(const PetscInt *)along;
  Map             map           = {.turn = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Place           place;

  Look(model, time, x, &place);
  *what = "there is motion or force along it";
  if (PetscAbsReal(place.velocity[d]) > SAME * model->speed || PetscAbsReal(place.force[d]) > SAME * model->force)
    return PETSC_FALSE;
  for (PetscInt k = 0; k < SHIFTS; k++) {
    map.shift[d] = share[k] * (domain->upper[d] - domain->lower[d]);
    if (x[d] + map.shift[d] > domain->upper[d]) map.shift[d] *= -1;
    if (!Alike(model, time, &map, x, what)) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* Whether two faces are alike, but for the velocity of walls, which 'parity' turns. */
static PetscBool FacesAlike(const Model *model, PetscInt d, PetscInt side, PetscInt e, PetscInt other,
                            const PetscReal parity[DIM])
{
  const Domain domain      = model->sim->domain;
  PetscReal    angle[2][2] = {{0, 0}, {0, 0}}, moved[DIM];

  (void)TensionFaceAngles(model->sim->tension, d, side, angle[0]);
  (void)TensionFaceAngles(model->sim->tension, e, other, angle[1]);
  if (!PropertiesSame(domain, &domain->own[d][side], &domain->own[e][other])) return PETSC_FALSE;
  for (PetscInt k = 0; k < DIM; k++)
    moved[k] = parity[k] * domain->wall_velocity[d][side][k] - domain->wall_velocity[e][other][k];
  return (PetscBool)(domain->face[d][side] == domain->face[e][other] && angle[0][0] == angle[1][0] &&
                     angle[0][1] == angle[1][1] && Norm(moved) == 0);
}

/* Whether the plane across d is a mirror of the scene. */
static PetscBool IsMirror(const Model *model, PetscInt d, char why[])
{
  PetscReal parity[DIM] = {1, 1, 1};

  parity[d] = -1;
  for (PetscInt e = 0; e < model->sim->domain->dim; e++)
    for (PetscInt side = 0; side < 2; side++)
      if (!FacesAlike(model, e, side, e, e == d && !model->folded[d] ? 1 - side : side, parity)) {
        (void)PetscSNPrintf(why, MODEL_WHY, "the faces differ");
        return PETSC_FALSE;
      }
  return AtAll(model, MirrorOk, &d, why);
}

static PetscBool IsRevolution(const Model *model, PetscInt u, char why[])
{
  const Domain    domain = model->sim->domain;
  const PetscInt  a = (u + 1) % DIM, b = (u + 2) % DIM;
  const PetscReal wide = domain->upper[a] - model->center[a], deep = domain->upper[b] - model->center[b];
  PetscReal       parity[DIM] = {-1, -1, -1}; /* walls may move along the axis only */
  PetscBool       faces;

  parity[u] = 1;
  faces     = FacesAlike(model, a, 1, b, 1, parity);
  for (PetscInt side = 0; side < 2; side++) faces = (PetscBool)(faces && FacesAlike(model, u, side, u, side, parity));
  if (!model->folded[a]) faces = (PetscBool)(faces && FacesAlike(model, a, 0, a, 1, parity));
  if (!model->folded[b]) faces = (PetscBool)(faces && FacesAlike(model, b, 0, b, 1, parity));
  (void)PetscSNPrintf(why, MODEL_WHY, faces ? "the box is not square" : "the vertical faces differ");
  if (!faces || PetscAbsReal(wide - deep) > SAME * wide) return PETSC_FALSE;
  return AtAll(model, TurnOk, &u, why);
}

static PetscBool IsUniform(const Model *model, PetscInt d, char why[])
{
  const FaceType low = model->sim->domain->face[d][0], high = model->sim->domain->face[d][1];

  (void)PetscSNPrintf(why, MODEL_WHY, "its faces are neither periodic nor mirrors");
  if (!(low == FACE_PERIODIC || low == FACE_SYMMETRY) || !(high == FACE_PERIODIC || high == FACE_SYMMETRY))
    return PETSC_FALSE;
  for (PetscInt f = 0; f < 2 * DIM; f++)
    if (model->sim->domain->wall_velocity[f / 2][f % 2][d] != 0) {
      (void)PetscSNPrintf(why, MODEL_WHY, "a wall moves along it");
      return PETSC_FALSE;
    }
  return AtAll(model, AlongOk, &d, why);
}

/* Liquid particles in the whole of the box, and as rings about u, where a ring of the area d0^2 is at each distance. */
static void CountParticles(const Model *model, PetscInt u, PetscReal *whole, PetscReal *as_rings)
{
  const Scene     scene = model->sim->scene;
  const PetscReal d0    = model->sim->domain->spacing;
  PetscReal       parts = 1;

  *whole = *as_rings = 0;
  for (PetscInt d = 0; d < DIM; d++) parts *= model->folded[d] && d != u ? 2 : 1;
  for (PetscInt s = 0; s < SceneCount(scene); s++) {
    PetscReal lower[DIM], upper[DIM], volume;

    (void)Bounds(model, s, lower, upper);
    volume = (upper[0] - lower[0]) * (upper[1] - lower[1]) * (upper[2] - lower[2]) / POINTS;
    for (PetscInt k = 0; k < POINTS; k++) {
      PetscReal x[DIM], square = 0;

      Point(k, lower, upper, x);
      for (PetscInt d = 0; d < DIM; d++)
        if (d != u) square += PetscSqr(x[d] - model->center[d]);
      if (!BodyContains(SceneBody(scene, s), x)) continue;
      *whole += volume / PetscPowRealInt(d0, 3);
      *as_rings += parts * volume / (2 * PETSC_PI * PetscSqrtReal(square) * d0 * d0);
    }
  }
}

/* The largest speed and force at all points. */
static PetscBool Measure(const Model *model, PetscReal time, const PetscReal x[], const void *context,
                         const char **what)
{
  Model *const scale = (Model *)context;
  Place        place;

  Look(model, time, x, &place);
  scale->speed = PetscMax(scale->speed, Norm(place.velocity));
  scale->force = PetscMax(scale->force, Norm(place.force));
  return PETSC_TRUE;
}

/* Whether tension, viscosity and gravity can matter: bounds that hold for the smallest thing that a run can show, one
   spacing. Viscosity matters where a law moves the contact lines, gravity also where its pressure does. */
static void FindForces(const Model *model, SceneModel *found)
{
  const Sim       sim   = model->sim;
  const Scene     scene = sim->scene;
  const PetscReal d0 = sim->domain->spacing, span = sim->has_end ? sim->time_end - sim->state.time : PETSC_MAX_REAL,
                  g = model->force, fall = 0.5 * g * PetscSqr(span), speed = model->speed;
  PetscReal drawn = 0, diffused = 0, height = 0; /* m: way by tension, width of a boundary layer, size of the box */

  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    const Material *m     = BodyMaterial(SceneBody(scene, b));
    const PetscReal mu    = PetscMax(BodyViscosity(SceneBody(scene, b), 0), BodyViscosity(SceneBody(scene, b), FAST)),
                    sigma = PetscMax(m->tension, SceneInterfaceTension(scene));

    drawn    = PetscMax(drawn, 0.5 * sigma * PetscSqr(span) / (m->density * PetscSqr(d0)));
    diffused = PetscMax(diffused, PetscSqrtReal(mu / m->density * span));
  }
  for (PetscInt d = 0; d < sim->domain->dim; d++)
    height = PetscMax(height, sim->domain->upper[d] - sim->domain->lower[d]);
  found->force[MODEL_TENSION] =
    (ForceFound){"tension", (PetscBool)(drawn > 0), (PetscBool)(drawn > 0 && drawn < SMALL * d0),
                 "it moves a drop of one spacing by less than a hundredth of that within the run"};
  found->force[MODEL_VISCOSITY] =
    (ForceFound){"viscosity", (PetscBool)(diffused > 0),
                 (PetscBool)(diffused > 0 && diffused < 0.5 * d0 && !TensionHasLaw(sim->tension)),
                 "momentum spreads by less than half a spacing within the run"};
  found->force[MODEL_GRAVITY] = (ForceFound){
    "gravity", (PetscBool)(g > 0),
    (PetscBool)(g > 0 && fall < SMALL * d0 && g * height < 0.5 * SMALL * PetscSqr(speed)),
    "it moves liquid by less than a hundredth of a spacing within the run, and its pressure is less than a "
    "hundredth of that of the flow"};
}

static void FindRevolution(Model *model, PetscInt u, SceneModel *found)
{
  Revolution *r = &found->revolution[u];
  PetscReal   whole, as_rings;

  r->tried = PETSC_TRUE;
  r->holds = IsRevolution(model, u, r->why);
  if (!r->holds) return;
  r->why[0] = 0;
  for (PetscInt d = 0; d < DIM; d++) r->center[d] = model->center[d];
  CountParticles(model, u, &whole, &as_rings);
  r->particles = whole > 0 ? as_rings / whole : 0;
}

/* The mirror across d, and whether the scene is uniform along it. */
static void FindMirror(const Model *model, PetscInt d, SceneModel *found)
{
  Mirror  *mirror  = &found->mirror[d];
  Uniform *uniform = &found->uniform[d];
  Body     body;

  mirror->used  = model->folded[d];
  mirror->holds = (PetscBool)(!mirror->used && IsMirror(model, d, mirror->why));
  if (mirror->holds || mirror->used) mirror->why[0] = 0;
  for (PetscInt s = 0; mirror->holds && (body = Member(model, s)); s++) {
    PetscReal lower[DIM], upper[DIM];

    BodyBounds(body, lower, upper);
    mirror->gone[s] = (PetscBool)(upper[d] <= model->center[d] + NEAR * model->sim->domain->spacing);
  }
  uniform->holds = (PetscBool)(model->sim->domain->dim == DIM && IsUniform(model, d, uniform->why));
  if (uniform->holds) uniform->why[0] = 0;
}

void ModelFind(Sim sim, SceneModel *found)
{
  const Domain domain = sim->domain;
  Model        model = {.sim = sim}, scale = {.sim = sim};
  PetscInt     first = 0, last = DIM - 1;
  PetscReal    g[DIM];
  char         why[MODEL_WHY];

  *found = (SceneModel){.none = SceneFrameTurns(sim->scene) ? "a frame that rotates" : NULL};
  for (const Edge *const *edge = StepEdges; *edge && !found->none; edge++)
    if ((*edge)->lopsided) found->none = (*edge)->lopsided(sim->scene);
  for (PetscInt d = 0; d < DIM; d++) model.center[d] = 0.5 * (domain->lower[d] + domain->upper[d]);
  FindMoments(&model);
  (void)AtAll(&model, Measure, &scale, why);
  model.speed = PetscMax(scale.speed, DomainWallSpeed(domain));
  model.force = scale.force;
  FindForces(&model, found);
  if (found->none) return;
  for (PetscInt d = 0; d < domain->dim; d++)
    if (domain->face[d][0] == FACE_SYMMETRY && !IsMirror(&model, d, why)) {
      model.folded[d] = PETSC_TRUE; /* a half already, unless its middle is a mirror, too */
      model.center[d] = domain->lower[d];
    }
  SceneAcceleration(sim->scene, model.center, g);
  for (PetscInt d = 0; d < DIM; d++)
    if (g[d] != 0 && Norm(g) == PetscAbsReal(g[d])) first = last = d;
  for (PetscInt u = last; u >= first && domain->dim == DIM; u--) {
    FindRevolution(&model, u, found);
    if (found->revolution[u].holds) break;
  }
  for (PetscInt d = DomainFirstStraight(domain); d < domain->dim; d++) FindMirror(&model, d, found);
}

/* Whether a model is cheaper than the scene as it is. */
static PetscBool Cheaper(const SceneModel *found)
{
  for (PetscInt d = 0; d < DIM; d++)
    if (found->revolution[d].holds || found->mirror[d].holds || found->uniform[d].holds) return PETSC_TRUE;
  for (PetscInt f = 0; f < MODEL_FORCES; f++)
    if (found->force[f].vain) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Name of body or solid s. */
static const char *MemberName(Sim sim, PetscInt s)
{
  return BodyName(Member(&(Model){.sim = sim}, s));
}

PetscErrorCode ModelPrint(Sim sim, const SceneModel *found)
{
  const PetscInt members = SceneCount(sim->scene) + SceneSolidCount(sim->scene);

  PetscFunctionBegin;
  PetscCall(PetscPrintf(sim->comm, "Model\n"));
  if (found->none) PetscCall(PetscPrintf(sim->comm, "  symmetry: none is looked for with %s\n", found->none));
  for (PetscInt u = DIM - 1; u >= 0; u--) {
    const Revolution *r = &found->revolution[u];
    const PetscInt    a = (u + 1) % DIM, b = (u + 2) % DIM;

    if (r->tried && !r->holds) PetscCall(PetscPrintf(sim->comm, "  revolution about %c: no: %s\n", "xyz"[u], r -> why));
    if (r->holds)
      PetscCall(PetscPrintf(sim->comm,
                            "  revolution about %c: yes, through %c = %.9g, %c = %.9g m; rings take %.2g %% of "
                            "the particles\n",
                            "xyz"[u], "xyz"[a], (double)r -> center[a], "xyz"[b], (double)r -> center[b],
                            (double)(100 * r->particles)));
  }
  for (PetscInt d = DomainFirstStraight(sim->domain); d < sim->domain->dim && !found->none; d++) {
    const Mirror *mirror = &found->mirror[d];
    PetscBool     first  = PETSC_TRUE;

    PetscCall(PetscPrintf(sim->comm, "  mirror across %c: %s%s", "xyz"[d],
                          mirror -> used            ? "used already"
                                    : mirror->holds ? "yes"
                                                    : "no: ",
                          mirror->why));
    for (PetscInt s = 0; s < members; s++) {
      if (!mirror->gone[s]) continue;
      PetscCall(PetscPrintf(sim->comm, "%s%s", first ? "; without " : ",", MemberName(sim, s)));
      first = PETSC_FALSE;
    }
    PetscCall(PetscPrintf(sim->comm, "\n"));
    if (found->uniform[d].holds) PetscCall(PetscPrintf(sim->comm, "  uniform along %c: yes\n", "xyz"[d]));
  }
  for (PetscInt f = 0; f < MODEL_FORCES; f++)
    if (found->force[f].vain)
      PetscCall(PetscPrintf(sim->comm, "  %s: cannot matter: %s\n", found->force[f].name, found->force[f].why));
  PetscCall(PetscPrintf(sim->comm, Cheaper(found) ? "  make reduce SCENE=my.opts writes the cheaper scene\n"
                                                  : "  nothing cheaper than the scene as it is\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* {direction: a letter, "holds", "why"}, left open. */
static void WriteFinding(Json *json, const char key[], PetscInt d, PetscBool holds, const char why[])
{
  const char letter[2] = {"xyz"[d], 0};

  JsonObject(json, NULL);
  JsonText(json, key, letter);
  JsonBool(json, "holds", holds);
  JsonText(json, "why", why);
}

void ModelJson(Sim sim, const SceneModel *found, Json *json)
{
  const PetscInt members = SceneCount(sim->scene) + SceneSolidCount(sim->scene);

  JsonObject(json, "model");
  JsonText(json, "not_looked_for", found->none);
  JsonArray(json, "revolution");
  for (PetscInt u = 0; u < DIM; u++) {
    if (!found->revolution[u].tried) continue;
    WriteFinding(json, "about", u, found->revolution[u].holds, found->revolution[u].why);
    JsonReals(json, "center", DIM, found->revolution[u].center);
    JsonReal(json, "particles", found->revolution[u].particles);
    JsonEnd(json);
  }
  JsonEnd(json);
  JsonArray(json, "mirrors");
  for (PetscInt d = DomainFirstStraight(sim->domain); d < sim->domain->dim && !found->none; d++) {
    WriteFinding(json, "across", d, found->mirror[d].holds, found->mirror[d].why);
    JsonBool(json, "used", found->mirror[d].used);
    JsonArray(json, "gone");
    for (PetscInt s = 0; s < members; s++)
      if (found->mirror[d].gone[s]) JsonText(json, NULL, MemberName(sim, s));
    JsonEnd(json);
    JsonEnd(json);
  }
  JsonEnd(json);
  JsonArray(json, "uniform");
  for (PetscInt d = 0; sim->domain->dim == DIM && d < DIM && !found->none; d++) {
    WriteFinding(json, "along", d, found->uniform[d].holds, found->uniform[d].why);
    JsonEnd(json);
  }
  JsonEnd(json);
  JsonArray(json, "forces");
  for (PetscInt f = 0; f < MODEL_FORCES; f++) {
    JsonObject(json, NULL);
    JsonText(json, "name", found->force[f].name);
    JsonBool(json, "acts", found->force[f].acts);
    JsonBool(json, "vain", found->force[f].vain);
    JsonText(json, "why", found->force[f].vain ? found->force[f].why : "");
    JsonEnd(json);
  }
  JsonEnd(json);
  JsonEnd(json);
}
