/* Free bodies touch walls, solids and each other. Where a dummy particle of the first layer of one solid has come as
   close to another solid or a wall as it is to its own surface, their surfaces touch. On a surface that is bent it
   first slides along its layer to the place nearest to the other one, so that a cylinder rolls on its circle, not on
   the corners between its particles. The impulses at these places hold, at all of them at once,

     (v_1 - v_2).n >= -gap/dt,   impulse >= 0,   one of them with equality (Signorini),
     |impulse along the surface| <= friction times that across, against the sliding (Coulomb),

   by the sequential impulses of Moreau and Jean (1996) and Catto (2005): sweeps over the places, each of which corrects
   its own velocity, until none changes. Both bodies get an impulse at one place, so they keep their momentum and
   angular momentum. A body that has been pushed in by the liquid in a step is let out over some steps (LET_OUT).

   A gap of less than a spacing closes within 'leave' at the earliest, the time in which the density is repaired: liquid
   in it is not resolved, and would have to leave at any speed. Without, a box that sinks to the floor flat ended the
   run. Where the gap opens like a wedge liquid leaves by itself, and the place ahead of a cylinder that rolls closes
   (WEDGE). With a restitution there is no such cushion.

   A face hits with all of its places that are hardly further away (TOGETHER) than the first one, since the disorder of
   the liquid turns a body by as much. The first one alone would turn it: a boat whose heading was 0.006 rad off turned
   at 0.5 rad/s after it had met a wall with its bow.

   The impulse acts before the pressure is solved for, so that liquid and bodies have one velocity (free.c). */
#include "bodies_impl.h"
#include "../scene/body.h"
#include <stdlib.h>

#define CLOSE   1     /* spacings, largest gap of a place that may touch in a step, beside the way of the step */
#define LET_OUT 0.2   /* of an overlap, in a step of the usual size (Catto 2005) */
#define SWEEPS  200   /* at most */
#define DONE    1e-10 /* largest change of a velocity in the last sweep, over the largest velocity */
/* spacings to the sides within which a surface is plane: the first dummy particle is at half of one */
#define AROUND   0.3
#define PLANE    1e-6 /* one less the cosine between the normals of a plane */
#define BEFORE   0.5  /* cosine between the way to an edge and the normal of the surface before which it is */
#define NOBODY   -1   /* a wall, in place of the index of a solid */
#define SLIDE    0.75 /* spacings that a place slides at most: half of those between particles, in any direction */
#define SLIDES   4    /* of regula falsi; on a circle 1e-6 spacings are left */
#define CORNER   0.5  /* sine of the angle from which a place belongs to a corner, and does not slide */
#define STRAIGHT 1e-3 /* the same, up to which it is the nearest one */
/* change of the slope within SLIDE, over the slope, of a bent surface; tests/verify/touching.py holds with 0.1,
   0.4 */
#define BENT 0.2
/* spacings that liquid leaves a wedge in 'leave', faster than liquid of the scene; with 3 a cylinder rolls 0.76 of its
   way, with 30 as with 10 */
#define WEDGE 10
/* spacings between places of a face that hit at once, and from there to none; the same test holds with 0.03 and 0.3 */
#define TOGETHER 0.1
/* spacings, by which a body approaches in a step that hits; less is what weight does to one at rest */
#define NOTICED 0.01
#define TIE     1e-3 /* the same of places on a bent surface, which touches at one */

/* A place where two solids may touch, of particle id of the solid 'one'; all numbers are of one width, for MPI. */
typedef struct {
  PetscReal id, one, other;
  PetscReal x[DIM], n[DIM], gap; /* m; out of the other one; m */
  PetscReal open;                /* angle between the surfaces, if it is small; at an edge that of the flatter one */
  PetscReal aside;               /* whether it is on a bent surface, beside the place that touches */
  PetscReal u[DIM];              /* velocity of the surfaces of solids that are not free: of the first less the other */
  PetscReal across, along[DIM];  /* impulses so far, N s */
  PetscReal aim;                 /* least velocity along n, m/s */
} Place;
#define PLACE_REALS ((PetscInt)(sizeof(Place) / sizeof(PetscReal)))

static int ComparePlaces(const void *left, const void *right)
{
  const PetscReal *a = (const PetscReal *)left, *b = (const PetscReal *)right;

  for (PetscInt k = 0; k < 3 + DIM; k++)
    if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
  return 0;
}

static inline PetscBool IsFree(Scene scene, PetscInt solid)
{
  return (PetscBool)(solid >= 0 && BodyMass(SceneSolid(scene, solid)) > 0);
}

/* Velocity (m/s) of the point x (m) of a free body with a motion. */
static void PointVelocity(Body solid, const PetscReal motion[RIGID_MOTIONS], const PetscReal x[DIM], PetscReal v[DIM])
{
  PetscReal center[DIM], now[RIGID_MOTIONS], arm[DIM];

  FreeMotion(solid, center, now);
  for (PetscInt d = 0; d < DIM; d++) arm[d] = x[d] - center[d];
  DomainNearest(solid->domain, arm);
  Cross(motion + DIM, arm, v);
  for (PetscInt d = 0; d < DIM; d++) v[d] += motion[d];
}

/* v: the velocity (m/s) with which the surfaces move apart at a place. motion: [solids][RIGID_MOTIONS]. */
static void Apart(Scene scene, const Place *place, const PetscReal motion[], PetscReal v[DIM])
{
  const PetscInt pair[2] = {(PetscInt)place->one, (PetscInt)place->other};

  for (PetscInt d = 0; d < DIM; d++) v[d] = place->u[d];
  for (PetscInt k = 0; k < 2; k++) {
    PetscReal w[DIM];

    if (!IsFree(scene, pair[k])) continue;
    PointVelocity(SceneSolid(scene, pair[k]), motion + RIGID_MOTIONS * pair[k], place->x, w);
    for (PetscInt d = 0; d < DIM; d++) v[d] += k ? -w[d] : w[d];
  }
}

/* The changes of the motions of both bodies by an impulse (N s) at a place. */
static void Changes(Scene scene, const Place *place, const PetscReal impulse[DIM], PetscReal push[2][RIGID_MOTIONS],
                    PetscReal change[2][RIGID_MOTIONS])
{
  const PetscInt pair[2] = {(PetscInt)place->one, (PetscInt)place->other};

  for (PetscInt k = 0; k < 2; k++) {
    PetscReal signed_impulse[DIM];

    for (PetscInt m = 0; m < RIGID_MOTIONS; m++) push[k][m] = change[k][m] = 0;
    if (!IsFree(scene, pair[k])) continue;
    for (PetscInt d = 0; d < DIM; d++) signed_impulse[d] = k ? -impulse[d] : impulse[d];
    FreeAddForce(SceneSolid(scene, pair[k]), place->x, signed_impulse, NULL, push[k]);
    FreeResponse(SceneSolid(scene, pair[k]), push[k], change[k]);
  }
}

/* Velocity along the unit vector n that an impulse of 1 N s along it gives at a place. */
static PetscReal Ease(Scene scene, const Place *place, const PetscReal n[DIM])
{
  PetscReal push[2][RIGID_MOTIONS], change[2][RIGID_MOTIONS], ease = 0;

  Changes(scene, place, n, push, change);
  for (PetscInt k = 0; k < 2; k++)
    for (PetscInt m = 0; m < RIGID_MOTIONS; m++) ease += push[k][m] * change[k][m];
  return ease;
}

/* Applies an impulse at a place to the motions, and adds it to the sums. */
static void Apply(Scene scene, const Place *place, const PetscReal impulse[DIM], PetscReal motion[], PetscReal sum[])
{
  const PetscInt pair[2] = {(PetscInt)place->one, (PetscInt)place->other};
  PetscReal      push[2][RIGID_MOTIONS], change[2][RIGID_MOTIONS];

  Changes(scene, place, impulse, push, change);
  for (PetscInt k = 0; k < 2; k++)
    for (PetscInt m = 0; m < RIGID_MOTIONS && IsFree(scene, pair[k]); m++) {
      motion[RIGID_MOTIONS * pair[k] + m] += change[k][m];
      sum[RIGID_MOTIONS * pair[k] + m] += push[k][m];
    }
}

/* A coefficient of the two solids of a place: that of the free one, or of two the geometric mean. */
static PetscReal Pair(Scene scene, const Place *place, PetscReal (*of)(Body solid))
{
  const PetscInt  one = (PetscInt)place->one, other = (PetscInt)place->other;
  const PetscReal first  = IsFree(scene, one) ? of(SceneSolid(scene, one)) : -1,
                  second = IsFree(scene, other) ? of(SceneSolid(scene, other)) : -1;

  return first < 0 ? second : second < 0 ? first : PetscSqrtReal(first * second);
}

/* Corrects the velocities at a place. Returns the size of the change, m/s. */
static PetscReal Correct(Scene scene, Place *place, PetscReal motion[], PetscReal sum[])
{
  const PetscReal ease = Ease(scene, place, place->n), friction = Pair(scene, place, FreeFriction);
  PetscReal       v[DIM], impulse[DIM], more, change, along[DIM], speed, most;

  if (ease <= 0) return 0;
  Apart(scene, place, motion, v);
  more = PetscMax(-place->across, (place->aim - Dot(v, place->n)) / ease);
  place->across += more;
  for (PetscInt d = 0; d < DIM; d++) impulse[d] = more * place->n[d];
  change = PetscAbsReal(more) * ease;
  if (more != 0) Apply(scene, place, impulse, motion, sum);
  if (friction == 0) return change;
  Apart(scene, place, motion, v);
  for (PetscInt d = 0; d < DIM; d++) along[d] = v[d] - Dot(v, place->n) * place->n[d];
  speed = Norm(along);
  for (PetscInt d = 0; d < DIM && speed > 0; d++) along[d] /= speed;
  more = speed > 0 ? Ease(scene, place, along) : 0;
  for (PetscInt d = 0; d < DIM; d++)
    along[d] = place->along[d] - (more > 0 ? speed / more : 0) * along[d]; /* would end the sliding */
  most  = friction * place->across;
  speed = Norm(along);
  for (PetscInt d = 0; d < DIM; d++) {
    impulse[d] = along[d] * (speed > most ? most / speed : 1) - place->along[d];
    place->along[d] += impulse[d];
  }
  if (Norm(impulse) > 0) Apply(scene, place, impulse, motion, sum);
  return change + Norm(impulse) * more;
}

/* Distance (m) of x (m) from what a place is on, and the normal n out of that. */
static PetscReal OtherDistance(Scene scene, Domain domain, PetscInt other, const PetscReal x[DIM], PetscReal n[DIM])
{
  PetscReal image[DIM], distance;

  if (other < 0) {
    const PetscInt d = (NOBODY - other) / 2, upper = (NOBODY - other) % 2;

    for (PetscInt e = 0; e < DIM; e++) n[e] = e == d ? (upper ? -1 : 1) : 0;
    return upper ? domain->upper[d] - x[d] : x[d] - domain->lower[d];
  }
  distance = BodyNearest(SceneSolid(scene, other), x, image);
  DistanceNormal(scene, SceneOneDistance, other, image, n);
  return distance;
}

/* A dummy particle of the first layer of a solid: 'depth' (m) below its surface at x (m), that is at 'own' (m) for the
   solid, behind a periodic face perhaps. */
typedef struct {
  PetscInt  one;
  PetscReal x[DIM], own[DIM], depth;
} Layer;

/* A way s (m) along the layer in the direction t: x (m) is there, own its normal, distance (m) and n those of the other
   solid. Returns the slope of the distance. */
static PetscReal Along(Scene scene, Domain domain, const Layer *layer, PetscInt other, PetscReal s,
                       const PetscReal t[DIM], PetscReal x[DIM], PetscReal own[DIM], PetscReal *distance,
                       PetscReal n[DIM])
{
  PetscReal there[DIM], tangent[DIM], lift;

  for (PetscInt d = 0; d < DIM; d++) there[d] = layer->own[d] + s * t[d];
  DistanceNormal(scene, SceneOneDistance, layer->one, there, own);
  lift = SceneOneDistance(scene, layer->one, there) + layer->depth;
  for (PetscInt d = 0; d < DIM; d++) {
    x[d]       = layer->x[d] + s * t[d] - lift * own[d];
    tangent[d] = t[d] - Dot(t, own) * own[d];
  }
  *distance = OtherDistance(scene, domain, other, x, n);
  return Dot(n, tangent);
}

/* Slides a place along a layer that is bent to where it is nearest to the other solid, if that is within reach. Returns
   whether it is bent, but the place is not within reach. */
static PetscBool Slide(Scene scene, Domain domain, const Layer *layer, PetscReal x[DIM], PetscReal own[DIM],
                       PetscReal *distance, PetscReal n[DIM], PetscInt other)
{
  PetscReal t[DIM], y[DIM], own_y[DIM], n_y[DIM], there, low = 0, high = SLIDE * domain->spacing, slope[2], length;

  for (PetscInt d = 0; d < DIM; d++) t[d] = Dot(n, own) * own[d] - n[d];
  length = Norm(t);
  if (length < STRAIGHT || length > CORNER || Dot(n, own) > 0) return PETSC_FALSE;
  for (PetscInt d = 0; d < DIM; d++) t[d] /= length;
  slope[0] = -length;
  slope[1] = Along(scene, domain, layer, other, high, t, y, own_y, &there, n_y);
  if (slope[1] <= 0) return (PetscBool)(slope[1] - slope[0] > BENT * length);
  for (PetscInt k = 0; k < SLIDES; k++) {
    const PetscReal s   = low - slope[0] * (high - low) / (slope[1] - slope[0]),
                    now = Along(scene, domain, layer, other, s, t, y, own_y, &there, n_y);

    if (now < 0) {
      low      = s;
      slope[0] = now;
    } else {
      high     = s;
      slope[1] = now;
    }
  }
  if (there >= *distance) return PETSC_FALSE; /* a corner in the way */
  *distance = there;
  for (PetscInt d = 0; d < DIM; d++) {
    x[d]   = y[d];
    own[d] = own_y[d];
    n[d]   = n_y[d];
  }
  return PETSC_FALSE;
}

/* Whether the surface of a solid is plane around the point of it that is nearest to x; n: its normal there. */
static PetscBool IsPlane(Scene scene, PetscInt solid, const PetscReal x[DIM], const PetscReal n[DIM])
{
  const Domain domain = SceneSolid(scene, solid)->domain;

  for (PetscInt k = 0; k < 2 * domain->dim; k++) {
    PetscReal side[DIM] = {0, 0, 0}, y[DIM], m[DIM];

    for (PetscInt d = 0; d < DIM; d++) side[d] = (d == k / 2) - n[k / 2] * n[d];
    if (Norm(side) < 0.5) continue;
    for (PetscInt d = 0; d < DIM; d++) y[d] = x[d] + (k % 2 ? 1 : -1) * AROUND * domain->spacing * side[d] / Norm(side);
    DistanceNormal(scene, SceneOneDistance, solid, y, m);
    if (Dot(m, n) < 1 - PLANE) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* Where an edge of the other solid is next to a dummy particle behind a plane surface, normal and gap of the place
   become those of the plane at the edge: out of an edge normals point to all sides, and an edge that slides along the
   surface would run into one dummy particle after the other. False: the edge is before other particles, not before this
   one. x: where the particle has slid to, m. */
static PetscBool TakePlane(Scene scene, const Layer *layer, const PetscReal x[DIM], Place *place)
{
  const PetscInt other = (PetscInt)place->other;
  PetscReal      image[DIM], edge[DIM], m[DIM];

  (void)BodyNearest(SceneSolid(scene, other), x, image);
  if (IsPlane(scene, other, image, place->n)) return PETSC_TRUE;
  for (PetscInt d = 0; d < DIM; d++) edge[d] = layer->own[d] + (place->x[d] - layer->x[d]);
  DistanceNormal(scene, SceneOneDistance, layer->one, edge, m);
  if (Norm(m) == 0 || !IsPlane(scene, layer->one, edge, m)) return PETSC_TRUE;
  if (Dot(m, place->n) > -BEFORE) return PETSC_FALSE;
  place->gap = SceneOneDistance(scene, layer->one, edge);
  for (PetscInt d = 0; d < DIM; d++) place->n[d] = -m[d];
  return PETSC_TRUE;
}

/* Sets the velocity of the surfaces that do not move freely, of the first less the other, where they touch. */
static void SetDriven(Scene scene, Domain domain, PetscReal time, Place *place)
{
  const PetscInt pair[2] = {(PetscInt)place->one, (PetscInt)place->other};

  for (PetscInt d = 0; d < DIM; d++) place->u[d] = 0;
  for (PetscInt k = 0; k < 2; k++) {
    const PetscReal *v = pair[k] < 0 ? domain->wall_velocity[(NOBODY - pair[k]) / 2][(NOBODY - pair[k]) % 2] : NULL;
    PetscReal        image[DIM], motion[DIM];

    if (IsFree(scene, pair[k])) continue;
    if (!v) {
      (void)BodyNearest(SceneSolid(scene, pair[k]), place->x, image);
      BodyMotion(SceneSolid(scene, pair[k]), time, image, motion);
      v = motion;
    }
    for (PetscInt d = 0; d < DIM; d++) place->u[d] += k ? -v[d] : v[d];
  }
}

/* Adds the place where a layer may touch a wall or another solid in a step of dt (s). */
static PetscErrorCode AddPlace(Scene scene, Domain domain, const Layer *layer, PetscReal time, const PetscReal motion[],
                               PetscReal dt, Place *place, PetscSegBuffer places)
{
  const PetscInt one = layer->one, other = (PetscInt)place->other;
  /* a dummy particle may be on the surface, or a little in front of it */
  const PetscReal probe = PetscMax(layer->depth, TIE * domain->spacing);
  PetscReal       x[DIM], own[DIM], v[DIM], distance, toward[DIM];
  Place          *kept;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < DIM; d++) x[d] = layer->x[d];
  if (other >= 0 && BodyBeyond(SceneSolid(scene, other), domain->spacing + layer->depth, x))
    PetscFunctionReturn(PETSC_SUCCESS);
  distance = OtherDistance(scene, domain, other, x, place->n);
  if (Norm(place->n) == 0) PetscFunctionReturn(PETSC_SUCCESS);
  if (other >= 0 && distance - layer->depth > domain->spacing) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt d = 0; d < DIM; d++) place->x[d] = x[d] - distance * place->n[d];
  SetDriven(scene, domain, time, place);
  Apart(scene, place, motion, v);
  if (distance - layer->depth > CLOSE * domain->spacing + dt * Norm(v)) PetscFunctionReturn(PETSC_SUCCESS);
  DistanceNormal(scene, SceneOneDistance, one, layer->own, own);
  place->aside = Slide(scene, domain, layer, x, own, &distance, place->n, other);
  for (PetscInt d = 0; d < DIM; d++) {
    place->x[d] = x[d] - distance * place->n[d];
    toward[d]   = layer->own[d] + (x[d] - layer->x[d]) - probe * place->n[d];
  }
  SetDriven(scene, domain, time, place);
  place->gap  = distance - layer->depth;
  place->open = PetscSqrtReal(PetscMax(0, 2 - 2 * (SceneOneDistance(scene, one, toward) + layer->depth) / probe));
  if (other >= 0 && !TakePlane(scene, layer, x, place)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSegBufferGet(places, 1, &kept));
  *kept = *place;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the places where dummy particle a of a solid may touch walls and other solids. */
static PetscErrorCode AddPlaces(Cloud cloud, PetscInt a, PetscReal time, const PetscReal motion[], PetscReal dt,
                                PetscSegBuffer places)
{
  const Domain   domain = cloud->domain;
  const Scene    scene  = cloud->scene;
  const PetscInt one    = BODY_SOLID - cloud->integer[INT_BODY][a];
  Layer          layer  = {.one = one};
  Place          at     = {.id = cloud->integer[INT_ID][a], .one = one};

  PetscFunctionBegin;
  for (PetscInt d = 0; d < DIM; d++) layer.x[d] = cloud->field[FIELD_POSITION][DIM * a + d];
  layer.depth = -BodyNearest(SceneSolid(scene, one), layer.x, layer.own);
  if (layer.depth >= domain->spacing) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt f = 0; f < 2 * domain->dim && IsFree(scene, one); f++) {
    if (domain->face[f / 2][f % 2] != FACE_WALL) continue;
    at.other = NOBODY - f;
    PetscCall(AddPlace(scene, domain, &layer, time, motion, dt, &at, places));
  }
  for (PetscInt other = 0; other < SceneSolidCount(scene); other++) {
    if (other == one || !(IsFree(scene, one) || IsFree(scene, other))) continue;
    at.other = other;
    PetscCall(AddPlace(scene, domain, &layer, time, motion, dt, &at, places));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All places of all ranks, in an order that does not depend on their number. */
static PetscErrorCode FindPlaces(Cloud cloud, PetscReal time, const PetscReal motion[], PetscReal dt, PetscInt *n,
                                 Place **place)
{
  PetscSegBuffer places;
  Place         *own;
  size_t         count;
  PetscInt       total;

  PetscFunctionBegin;
  PetscCall(PetscSegBufferCreate(sizeof(Place), 64, &places));
  for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++)
    if (cloud->integer[INT_BODY][a] <= BODY_SOLID) PetscCall(AddPlaces(cloud, a, time, motion, dt, places));
  PetscCall(PetscSegBufferGetSize(places, &count));
  PetscCall(PetscSegBufferExtractInPlace(places, &own));
  PetscCall(GatherAll(cloud->comm, (PetscInt)count * PLACE_REALS, own, MPIU_REAL, &total, place));
  PetscCall(PetscSegBufferDestroy(&places));
  *n = total / PLACE_REALS;
  if (*n) qsort(*place, (size_t)*n, sizeof(**place), ComparePlaces);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The pair of a place among all pairs of solids and of solids and faces of the box. */
static PetscInt PairOf(Scene scene, const Place *place)
{
  const PetscInt one = (PetscInt)place->one, other = (PetscInt)place->other, solids = SceneSolidCount(scene);

  if (other < 0) return (solids + NOBODY - other) * solids + one;
  return PetscMax(one, other) * solids + PetscMin(one, other);
}

/* The least velocity (m/s) along n after a hit of a place that approaches and is 'behind' (m) the first of its pair.
   leaves: velocity with which it rebounds (m/s). */
static PetscReal Rebound(const Place *place, PetscReal spacing, PetscReal leaves, PetscReal approach, PetscReal behind)
{
  const PetscReal reach = (place->aside > 0 ? TIE : TOGETHER) * spacing,
                  share = PetscMin(1, PetscMax(0, 2 - behind / reach));

  return share * (leaves + approach) - approach;
}

/* Sets the aims of the places, and raises 'fastest' (m/s) to their largest velocity. first[pairs]: the gap (m) of the
   first place of a pair that hits, else -PETSC_MAX_REAL; approach[n]: m/s, into the other one. before: the motions at
   the start of the step, from which bodies rebound (Moreau): what their weight adds in it raised a ball with each hit.
 */
static void SetAims(Scene scene, PetscReal spacing, PetscReal dt, PetscReal usual, PetscReal leave,
                    const PetscReal before[], const PetscReal motion[], PetscInt pairs, PetscReal first[], PetscInt n,
                    PetscReal approach[], Place place[], PetscReal *fastest)
{
  for (PetscInt p = 0; p < pairs; p++) first[p] = -PETSC_MAX_REAL; /* the pair does not hit */
  for (PetscInt k = 0; k < n; k++) {
    const PetscReal gap = place[k].gap, rebound = Pair(scene, &place[k], FreeRestitution),
                    wedge = WEDGE * spacing * place[k].open;
    const PetscInt pair   = PairOf(scene, &place[k]);
    PetscReal      v[DIM];

    Apart(scene, &place[k], motion, v);
    *fastest    = PetscMax(*fastest, Norm(v));
    approach[k] = -Dot(v, place[k].n);
    if (gap < 0)
      place[k].aim = -LET_OUT * gap / usual;
    else if (rebound > 0)
      place[k].aim = -gap / dt;
    else
      place[k].aim = -PetscMin(gap / dt, (gap + wedge) / leave);
    if (rebound > 0 && approach[k] > PetscMax(0, -place[k].aim))
      first[pair] = first[pair] == -PETSC_MAX_REAL ? gap : PetscMin(first[pair], gap);
  }
  for (PetscInt k = 0; k < n; k++) {
    const PetscReal nearest = first[PairOf(scene, &place[k])];
    PetscReal       v[DIM];

    if (approach[k] <= 0 || nearest == -PETSC_MAX_REAL) continue;
    Apart(scene, &place[k], before, v);
    place[k].aim =
      PetscMax(place[k].aim, Rebound(&place[k], spacing, -Pair(scene, &place[k], FreeRestitution) * Dot(v, place[k].n),
                                     approach[k], place[k].gap - nearest));
  }
}

/* Finds a free body that is hit while another one or a wall presses on it, too: how it shares the impulse among them
   follows from no law of two bodies. */
static void FindTogether(Scene scene, PetscReal least, const PetscReal first[], const PetscReal approach[], PetscInt n,
                         const Place place[], HitTogether *hit)
{
  for (PetscInt k = 0; k < n && !hit->seen; k++) {
    if (approach[k] < least || first[PairOf(scene, &place[k])] == -PETSC_MAX_REAL || place[k].across == 0) continue;
    for (PetscInt j = 0; j < n && !hit->seen; j++) {
      if (place[j].across == 0 || PairOf(scene, &place[j]) == PairOf(scene, &place[k])) continue;
      for (PetscInt side = 0; side < 4 && !hit->seen; side++) {
        const PetscInt by[2] = {(PetscInt)(side % 2 ? place[k].one : place[k].other),
                                (PetscInt)(side / 2 ? place[j].one : place[j].other)},
                       body  = (PetscInt)(side % 2 ? place[k].other : place[k].one);

        if (!IsFree(scene, body) || body != (PetscInt)(side / 2 ? place[j].other : place[j].one)) continue;
        *hit = (HitTogether){.seen = PETSC_TRUE, .body = body, .by = {by[0], by[1]}};
      }
    }
  }
}

PetscErrorCode FreeTouch(Cloud cloud, PetscReal time, PetscReal dt, PetscReal usual, PetscReal leave,
                         const PetscReal before[], PetscReal motion[], PetscReal sum[], HitTogether *hit)
{
  const Scene     scene  = cloud->scene;
  const PetscInt  solids = SceneSolidCount(scene), pairs = (solids + 2 * DIM) * solids;
  const PetscReal spacing = cloud->domain->spacing;
  PetscReal       fastest = 0, change = 1, *first, *approach;
  PetscInt        n = 0;
  Place          *place;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(sum, RIGID_MOTIONS * SceneSolidCount(scene)));
  PetscCall(FindPlaces(cloud, time, motion, dt, &n, &place));
  PetscCall(PetscMalloc2(pairs, &first, n, &approach));
  SetAims(scene, spacing, dt, usual, leave, before, motion, pairs, first, n, approach, place, &fastest);
  for (PetscInt sweep = 0; sweep < SWEEPS && change > DONE * fastest; sweep++) {
    change = 0;
    for (PetscInt k = 0; k < n; k++) {
      const PetscReal by = Correct(scene, &place[sweep % 2 ? n - 1 - k : k], motion, sum);

      change = PetscMax(change, by);
    }
  }
  FindTogether(scene, NOTICED * spacing / dt, first, approach, n, place, hit);
  PetscCall(PetscFree2(first, approach));
  PetscCall(PetscFree(place));
  PetscFunctionReturn(PETSC_SUCCESS);
}
