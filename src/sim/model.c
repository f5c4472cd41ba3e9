/* -scene_model, and a line of -dry_run: the cheapest model that holds for a scene. Its symmetries are found by trying:
   what is at a point of the scene must be at the image of this point, too, for points in and around each body and in
   the box, at the start, in the middle and at the end of the run. So they hold for any shape, motion and force. A place
   where a surface is nearer than a tenth of a spacing says nothing: the particles cannot tell either. */
#include "sim_impl.h"
#include <string.h>

#define POINTS       3000 /* in the bounds of each body, and in the box */
#define SETS         8    /* with more bodies there are fewer points of each, down to POINTS_LEAST */
#define POINTS_LEAST 500
#define MARGIN       0.1  /* by which the bounds of a body are widened, of their extent */
#define NEAR         0.1  /* spacings from a surface within which it is not known what a point is in */
#define SAME         1e-6 /* of the largest value of the scene, for velocities, accelerations, sizes */
#define SEED         1
#define TIMES        3
#define TURNS        3
#define SMALL        0.01 /* share that counts as nothing */
#define RATES        3
#define WHY_LENGTH   160

/* What is at a place: of the liquid or the solid there. Equal structs are equal places. */
typedef struct {
  PetscReal kind; /* 0: air, 1: liquid, 2: solid */
  PetscReal density, tension, viscosity[RATES], angle, hysteresis, spacing, liquid;
  PetscReal emits; /* 0: no emitter; else 1 and the fillings so far */
} Matter;
typedef struct {
  Matter    matter;
  PetscReal velocity[DIM], force[DIM];
  PetscBool near; /* a surface is */
} Place;

/* A map of the space: x -> turn (x - center) + center + shift. */
typedef struct {
  PetscReal turn[DIM][DIM], center[DIM], shift[DIM];
} Map;

typedef struct {
  Sim       sim;
  PetscReal center[DIM];  /* m, of the whole scene: the middle of the box, or its mirror at a lower face */
  PetscBool folded[DIM];  /* the lower face is that mirror */
  PetscReal speed, force; /* the largest, m/s, m/s2 */
  PetscReal least_force;  /* m/s2 */
  PetscBool cheaper;      /* a cheaper model holds */
} Model;

static const PetscReal rates[RATES] = {0, 1, 1e3};

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
  wall        = SceneSolidDistance(scene, x, &solid);
  place->near = (PetscBool)(PetscAbsReal(wall) < near);
  if (wall < 0) {
    const Body body = SceneSolid(scene, solid);

    place->matter = (Matter){.kind = 2, .angle = BodyContactAngle(body), .hysteresis = BodyContactHysteresis(body)};
    BodyMotion(body, time, x, place->velocity);
  } else
    for (PetscInt b = 0; b < SceneCount(scene) && place->matter.kind == 0; b++) {
      const Body      body = SceneBody(scene, b);
      PetscReal       image[DIM];
      const PetscReal distance = BodyNearest(body, x, image);

      place->near = (PetscBool)(place->near || PetscAbsReal(distance) < near);
      if (distance >= 0) continue;
      place->matter = (Matter){.kind    = 1,
                               .density = BodyMaterial(body)->density,
                               .tension = BodyMaterial(body)->tension,
                               .liquid  = (PetscReal)SceneLiquid(scene, b),
                               .emits   = BodyEmits(body) ? 1 + (PetscReal)BodyEmissions(body, time) : 0};
      for (PetscInt r = 0; r < RATES; r++) place->matter.viscosity[r] = BodyViscosity(body, rates[r]);
      if (BodyEmits(body))
        BodyEmissionVelocity(body, time, x, place->velocity);
      else
        BodyVelocity(body, image, place->velocity);
    }
  if (sim->domain->graded && sim->domain->follow == FOLLOW_NONE) place->matter.spacing = SceneSpacing(scene, x);
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
  *what = one.matter.kind != other.matter.kind ? "what is there differs" : "materials or spacings differ";
  if (PetscAbsReal(one.matter.spacing - other.matter.spacing) <= NEAR * model->sim->domain->spacing)
    one.matter.spacing = other.matter.spacing;
  if (memcmp(&one.matter, &other.matter, sizeof(one.matter))) return PETSC_FALSE;
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

/* For each point of all sets and each time; 'ok' says in 'why' what is wrong. */
static PetscBool AtAll(const Model *model,
                       PetscBool (*ok)(const Model *, PetscReal, const PetscReal[], const void *, const char **),
                       const void *context, char why[])
{
  const Sim       sim    = model->sim;
  const PetscInt  sets   = SceneCount(sim->scene) + SceneSolidCount(sim->scene) + 1;
  const PetscInt  points = PetscMax(POINTS_LEAST, POINTS * PetscMin(sets, SETS) / sets);
  const PetscReal span   = sim->has_end ? sim->time_end - sim->state.time : 0;
  PetscBool       good   = PETSC_TRUE;
  const char     *what   = "";

  for (PetscInt t = 0; t < TIMES && good; t++) {
    const PetscReal time = sim->state.time + span * (PetscReal)t / (TIMES - 1);

    SceneMoveSolids(sim->scene, time);
    SceneSetTime(sim->scene, time);
    for (PetscInt s = 0; s < sets && good; s++) {
      PetscReal         lower[DIM], upper[DIM];
      const char *const name = Bounds(model, s, lower, upper);

      for (PetscInt k = 0; k < points && good; k++) {
        PetscReal x[DIM];

        Point(k, lower, upper, x);
        good = ok(model, time, x, context, &what);
        if (!good)
          (void)PetscSNPrintf(why, WHY_LENGTH, "%s, at %.3g, %.3g, %.3g m and %.3g s (%s)", what, (double)x[0],
                              (double)x[1], (double)x[2], (double)time, name);
      }
    }
  }
  SceneMoveSolids(sim->scene, sim->state.time);
  SceneSetTime(sim->scene, sim->state.time);
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
  const Domain   domain = model->sim->domain;
  const PetscInt d      = *(const PetscInt *)along;
  Map            map    = {.turn = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Place          place;

  Look(model, time, x, &place);
  *what = "there is motion or force along it";
  if (PetscAbsReal(place.velocity[d]) > SAME * model->speed || PetscAbsReal(place.force[d]) > SAME * model->force)
    return PETSC_FALSE;
  map.shift[d] = 0.4 * (domain->upper[d] - domain->lower[d]);
  if (x[d] + map.shift[d] > domain->upper[d]) map.shift[d] *= -1;
  return Alike(model, time, &map, x, what);
}

/* Whether two faces are alike, but for the velocity of walls, which 'parity' turns. */
static PetscBool FacesAlike(const Model *model, PetscInt d, PetscInt side, PetscInt e, PetscInt other,
                            const PetscReal parity[DIM])
{
  const Domain domain   = model->sim->domain;
  PetscReal    angle[2] = {-1, -1}, moved[DIM];
  char         name[64];

  for (PetscInt k = 0; k < 2; k++) {
    (void)PetscSNPrintf(name, sizeof(name), "-box_%c%s_contact_angle", "xyz"[k ? e : d],
                        (k ? other : side) ? "max" : "min");
    (void)PetscOptionsGetReal(NULL, NULL, name, &angle[k], NULL);
  }
  for (PetscInt k = 0; k < DIM; k++)
    moved[k] = parity[k] * domain->wall_velocity[d][side][k] - domain->wall_velocity[e][other][k];
  return (PetscBool)(domain->face[d][side] == domain->face[e][other] && angle[0] == angle[1] && Norm(moved) == 0);
}

/* Whether the plane across d is a mirror of the scene. */
static PetscBool IsMirror(const Model *model, PetscInt d, char why[])
{
  PetscReal parity[DIM] = {1, 1, 1};

  parity[d] = -1;
  for (PetscInt e = 0; e < model->sim->domain->dim; e++)
    for (PetscInt side = 0; side < 2; side++)
      if (!FacesAlike(model, e, side, e, e == d && !model->folded[d] ? 1 - side : side, parity)) {
        (void)PetscSNPrintf(why, WHY_LENGTH, "the faces differ");
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
  (void)PetscSNPrintf(why, WHY_LENGTH, faces ? "the box is not square" : "the vertical faces differ");
  if (!faces || PetscAbsReal(wide - deep) > SAME * wide) return PETSC_FALSE;
  return AtAll(model, TurnOk, &u, why);
}

static PetscBool IsUniform(const Model *model, PetscInt d, char why[])
{
  const FaceType low = model->sim->domain->face[d][0], high = model->sim->domain->face[d][1];

  (void)PetscSNPrintf(why, WHY_LENGTH, "its faces are neither periodic nor mirrors");
  if (!(low == FACE_PERIODIC || low == FACE_SYMMETRY) || !(high == FACE_PERIODIC || high == FACE_SYMMETRY))
    return PETSC_FALSE;
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

/* "; without a,b": bodies and solids that lie wholly below the middle across d, which a half has no more. */
static void Outside(const Model *model, PetscInt d, char names[], size_t length)
{
  Body body;

  names[0] = 0;
  for (PetscInt s = 0; (body = Member(model, s)); s++) {
    PetscReal lower[DIM], upper[DIM];

    BodyBounds(body, lower, upper);
    if (upper[d] > model->center[d] + NEAR * model->sim->domain->spacing) continue;
    (void)PetscStrlcat(names, names[0] ? "," : "; without ", length);
    (void)PetscStrlcat(names, BodyName(body), length);
  }
}

static PetscErrorCode PrintForce(Model *model, const char name[], PetscBool acts, PetscBool vain, const char why[])
{
  PetscFunctionBegin;
  if (acts && vain) {
    PetscCall(PetscPrintf(model->sim->comm, "  %s: cannot matter: %s\n", name, why));
    model->cheaper = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether tension, viscosity and gravity can matter: bounds that hold for the smallest thing that a run can show, one
   spacing. */
static PetscErrorCode PrintForces(Model *model)
{
  const Sim       sim   = model->sim;
  const Scene     scene = sim->scene;
  const PetscReal d0 = sim->domain->spacing, span = sim->has_end ? sim->time_end - sim->state.time : PETSC_MAX_REAL,
                  g = model->force, fall = 0.5 * g * PetscSqr(span);
  PetscReal capillary = 0, drawn = 0, diffused = 0; /* m: capillary length, way by tension, width of a boundary layer */

  PetscFunctionBegin;
  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    const Material *m  = BodyMaterial(SceneBody(scene, b));
    const PetscReal mu = PetscMax(BodyViscosity(SceneBody(scene, b), 0), BodyViscosity(SceneBody(scene, b), rates[2])),
                    sigma = PetscMax(m->tension, SceneInterfaceTension(scene));

    capillary = PetscMax(capillary, PetscSqrtReal(sigma / (m->density * PetscMax(model->least_force, PETSC_SMALL))));
    drawn     = PetscMax(drawn, 0.5 * sigma * PetscSqr(span) / (m->density * PetscSqr(d0)));
    diffused  = PetscMax(diffused, PetscSqrtReal(mu / m->density * span));
  }
  PetscCall(PrintForce(model, "tension", (PetscBool)(drawn > 0), (PetscBool)(drawn < SMALL * d0),
                       "it moves a drop of one spacing by less than a hundredth of that within the run"));
  PetscCall(PrintForce(model, "tension", (PetscBool)(drawn >= SMALL * d0), (PetscBool)(capillary < d0),
                       "the capillary length is below the spacing"));
  PetscCall(PrintForce(model, "viscosity", (PetscBool)(diffused > 0), (PetscBool)(diffused < 0.5 * d0),
                       "momentum spreads by less than half a spacing within the run"));
  PetscCall(PrintForce(model, "gravity", (PetscBool)(g > 0), (PetscBool)(fall < SMALL * d0),
                       "it moves liquid by less than a hundredth of a spacing within the run"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintRevolution(Model *model, PetscInt u, PetscBool *found)
{
  const Sim        sim = model->sim;
  const PetscInt   a = (u + 1) % DIM, b = (u + 2) % DIM;
  const PetscReal *c = model->center;
  PetscReal        whole, as_rings;
  char             why[WHY_LENGTH];

  PetscFunctionBegin;
  *found         = IsRevolution(model, u, why);
  model->cheaper = *found;
  if (*found) {
    CountParticles(model, u, &whole, &as_rings);
    PetscCall(PetscPrintf(sim->comm,
                          "  revolution about %c: yes, through %c = %.9g, %c = %.9g m; rings take %.2g %% of "
                          "the particles\n",
                          "xyz"[u], "xyz"[a], (double)c[a], "xyz"[b], (double)c[b], (double)(100 * as_rings / whole)));
  } else
    PetscCall(PetscPrintf(sim->comm, "  revolution about %c: no: %s\n", "xyz"[u], why));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest speed, and the largest and least force, at all points. */
static PetscBool Measure(const Model *model, PetscReal time, const PetscReal x[], const void *context,
                         const char **what)
{
  Model *const scale = (Model *)context;
  Place        place;

  Look(model, time, x, &place);
  scale->speed       = PetscMax(scale->speed, Norm(place.velocity));
  scale->force       = PetscMax(scale->force, Norm(place.force));
  scale->least_force = PetscMin(scale->least_force, Norm(place.force));
  return PETSC_TRUE;
}

/* The mirror across d, and whether the scene is uniform along it. */
static PetscErrorCode PrintMirror(Model *model, PetscInt d)
{
  const Sim sim = model->sim;
  char      why[WHY_LENGTH], names[WHY_LENGTH];
  PetscBool is;

  PetscFunctionBegin;
  if (model->folded[d]) {
    PetscCall(PetscPrintf(sim->comm, "  mirror across %c: used already\n", "xyz"[d]));
  } else {
    is = IsMirror(model, d, why);
    if (is) Outside(model, d, names, sizeof(names));
    model->cheaper = (PetscBool)(model->cheaper || is);
    PetscCall(PetscPrintf(sim->comm, "  mirror across %c: %s%s\n", "xyz"[d], is ? "yes" : "no: ", is ? names : why));
  }
  is             = (PetscBool)(sim->domain->dim == DIM && IsUniform(model, d, why));
  model->cheaper = (PetscBool)(model->cheaper || is);
  if (is) PetscCall(PetscPrintf(sim->comm, "  uniform along %c: yes\n", "xyz"[d]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode ModelPrint(Sim sim)
{
  const Domain domain = sim->domain;
  Model        model = {.sim = sim}, scale = {.sim = sim, .least_force = PETSC_MAX_REAL};
  PetscReal    g[DIM];
  PetscInt     first = 0, last = DIM - 1;
  PetscBool    found = PETSC_FALSE;
  char         why[WHY_LENGTH];

  PetscFunctionBegin;
  for (PetscInt d = 0; d < DIM; d++) model.center[d] = 0.5 * (domain->lower[d] + domain->upper[d]);
  (void)AtAll(&model, Measure, &scale, why);
  model.speed       = scale.speed;
  model.force       = scale.force;
  model.least_force = scale.least_force;
  PetscCall(PetscPrintf(sim->comm, "Model\n"));
  if (SceneHasFree(sim->scene) || SceneFrameTurns(sim->scene)) {
    PetscCall(PetscPrintf(sim->comm, "  symmetry: none is looked for with %s\n",
                          SceneHasFree(sim->scene) ? "a free body" : "a frame that rotates"));
  } else {
    for (PetscInt d = 0; d < domain->dim; d++)
      if (domain->face[d][0] == FACE_SYMMETRY && !IsMirror(&model, d, why)) {
        model.folded[d] = PETSC_TRUE; /* a half already, unless its middle is a mirror, too */
        model.center[d] = domain->lower[d];
      }
    SceneAcceleration(sim->scene, model.center, g);
    for (PetscInt d = 0; d < DIM; d++)
      if (g[d] != 0 && Norm(g) == PetscAbsReal(g[d])) first = last = d;
    for (PetscInt u = last; u >= first && domain->dim == DIM && !found; u--)
      PetscCall(PrintRevolution(&model, u, &found));
    for (PetscInt d = domain->rings; d < domain->dim; d++) PetscCall(PrintMirror(&model, d));
  }
  PetscCall(PrintForces(&model));
  PetscCall(PetscPrintf(sim->comm, model.cheaper ? "  make reduce SCENE=my.opts writes the cheaper scene\n"
                                                 : "  nothing cheaper than the scene as it is\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}
