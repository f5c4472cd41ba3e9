/* Free bodies touch walls, solids and each other. Where the first layer of dummy particles of one solid has come to
   half a spacing from another solid or a wall, their surfaces touch. The impulses there hold, at all places at once,

     (v_1 - v_2).n >= -gap/dt,   impulse >= 0,   one of them with equality (Signorini),
     |impulse along the surface| <= friction times that across, against the sliding (Coulomb),

   by the sequential impulses of Moreau and Jean (1996) and Catto (2005): sweeps over the places, each of which corrects
   its own velocity, until none changes. Both bodies get an impulse at one place, so they keep their momentum and
   angular momentum. A body that has been pushed in by the liquid in a step is let out over some steps (LET_OUT).

   A gap of less than a spacing closes within 'leave' at the earliest, the time in which the density is repaired: liquid
   in it is not resolved, and would have to leave at any speed. Without, a box that sinks to the floor flat ended the
   run. With a restitution there is no such cushion.

   The impulse acts before the pressure is solved for, so that liquid and bodies have one velocity (free.c). */
#include "bodies_impl.h"
#include "../scene/body.h"
#include <stdlib.h>

#define CLOSE   1     /* spacings, largest gap of a place that may touch in a step, beside the way of the step */
#define LET_OUT 0.2   /* of an overlap, in a step (Catto 2005) */
#define SWEEPS  200   /* at most */
#define DONE    1e-10 /* largest change of a velocity in the last sweep, over the largest velocity */
#define AROUND                                                                                                         \
  0.3 /* spacings to the sides within which a surface is plane: the first dummy particle is at half of one */
#define PLANE  1e-6 /* one less the cosine between the normals of a plane */
#define BEFORE 0.5  /* cosine between the way to an edge and the normal of the surface before which it is */
#define NOBODY -1   /* a wall, in place of the index of a solid */

/* A place where two solids may touch, of particle id of the solid 'one'; all numbers are of one width, for MPI. */
typedef struct {
  PetscReal id, one, other;
  PetscReal x[DIM], n[DIM], gap; /* m; out of the other one; m */
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

/* Adds a place if a step of this length may close the gap. */
static PetscErrorCode AddPlace(Scene scene, const PetscReal motion[], PetscReal dt, PetscReal spacing, Place *place,
                               PetscSegBuffer places)
{
  PetscReal v[DIM];
  Place    *kept;

  PetscFunctionBegin;
  Apart(scene, place, motion, v);
  if (place->gap > CLOSE * spacing + dt * Norm(v)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSegBufferGet(places, 1, &kept));
  *kept = *place;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A SceneDistance. */
static PetscReal SolidDistance(Scene scene, PetscInt which, const PetscReal x[DIM])
{
  return BodyDistance(SceneSolid(scene, which), x);
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
    DistanceNormal(scene, SolidDistance, solid, y, m);
    if (Dot(m, n) < 1 - PLANE) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* Where an edge of the other solid is next to a dummy particle behind a plane surface, normal and gap of the place
   become those of the plane at the edge: out of an edge normals point to all sides, and an edge that slides along the
   surface would run into one dummy particle after the other. False: the edge is before other particles, not before this
   one. image: where the particle is for the other solid, m. */
static PetscBool TakePlane(Scene scene, PetscInt one, const PetscReal image[DIM], Place *place)
{
  PetscReal m[DIM];

  if (IsPlane(scene, (PetscInt)place->other, image, place->n)) return PETSC_TRUE;
  DistanceNormal(scene, SolidDistance, one, place->x, m);
  if (Norm(m) == 0 || !IsPlane(scene, one, place->x, m)) return PETSC_TRUE;
  if (Dot(m, place->n) > -BEFORE) return PETSC_FALSE;
  place->gap = SolidDistance(scene, one, place->x);
  for (PetscInt d = 0; d < DIM; d++) place->n[d] = -m[d];
  return PETSC_TRUE;
}

/* Adds the places where dummy particle a of a solid may touch walls and other solids. */
static PetscErrorCode AddPlaces(Cloud cloud, PetscInt a, PetscReal time, const PetscReal motion[], PetscReal dt,
                                PetscSegBuffer places)
{
  const Domain     domain = cloud->domain;
  const Scene      scene  = cloud->scene;
  const PetscInt   one    = BODY_SOLID - cloud->integer[INT_BODY][a];
  const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, half = 0.5 * domain->spacing;
  Place            at = {.id = cloud->integer[INT_ID][a], .one = one};

  PetscFunctionBegin;
  if (BodyDistance(SceneSolid(scene, one), x) <= -2 * half) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt f = 0; f < 2 * domain->dim && IsFree(scene, one); f++) {
    const PetscInt d = f / 2, upper = f % 2;

    if (domain->face[d][upper] != FACE_WALL) continue;
    at.other = NOBODY - f;
    at.gap   = (upper ? domain->upper[d] - x[d] : x[d] - domain->lower[d]) - half;
    for (PetscInt e = 0; e < DIM; e++) {
      at.n[e] = e == d ? (upper ? -1 : 1) : 0;
      at.x[e] = x[e] - (half + at.gap) * at.n[e];
      at.u[e] = 0;
    }
    PetscCall(AddPlace(scene, motion, dt, domain->spacing, &at, places));
  }
  for (PetscInt other = 0; other < SceneSolidCount(scene); other++) {
    PetscReal image[DIM], v[2][DIM] = {{0}};

    if (other == one || !(IsFree(scene, one) || IsFree(scene, other))) continue;
    at.other = other;
    at.gap   = BodyNearest(SceneSolid(scene, other), x, image) - half;
    if (at.gap > domain->spacing) continue;
    DistanceNormal(scene, SolidDistance, other, image, at.n);
    if (!IsFree(scene, one)) BodyMotion(SceneSolid(scene, one), time, x, v[0]);
    if (!IsFree(scene, other)) BodyMotion(SceneSolid(scene, other), time, image, v[1]);
    for (PetscInt d = 0; d < DIM; d++) {
      at.x[d] = x[d] - (half + at.gap) * at.n[d];
      at.u[d] = v[0][d] - v[1][d];
    }
    if (Norm(at.n) > 0 && TakePlane(scene, one, image, &at))
      PetscCall(AddPlace(scene, motion, dt, domain->spacing, &at, places));
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

PetscErrorCode FreeTouch(Cloud cloud, PetscReal time, PetscReal dt, PetscReal leave, PetscReal motion[],
                         PetscReal sum[])
{
  const Scene scene   = cloud->scene;
  PetscReal   fastest = 0, change = 1;
  PetscInt    n = 0;
  Place      *place;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(sum, RIGID_MOTIONS * SceneSolidCount(scene)));
  PetscCall(FindPlaces(cloud, time, motion, dt, &n, &place));
  for (PetscInt k = 0; k < n; k++) {
    PetscReal v[DIM], approach, rebound;

    Apart(scene, &place[k], motion, v);
    approach     = -Dot(v, place[k].n);
    rebound      = Pair(scene, &place[k], FreeRestitution);
    place[k].aim = -place[k].gap * (place[k].gap < 0 ? LET_OUT / dt : 1 / (rebound > 0 ? dt : PetscMax(dt, leave)));
    if (approach > PetscMax(0, -place[k].aim)) place[k].aim = PetscMax(place[k].aim, rebound * approach);
    fastest = PetscMax(fastest, Norm(v));
  }
  for (PetscInt sweep = 0; sweep < SWEEPS && change > DONE * fastest; sweep++) {
    change = 0;
    for (PetscInt k = 0; k < n; k++) {
      const PetscReal by = Correct(scene, &place[sweep % 2 ? n - 1 - k : k], motion, sum);

      change = PetscMax(change, by);
    }
  }
  PetscCall(PetscFree(place));
  PetscFunctionReturn(PETSC_SUCCESS);
}
