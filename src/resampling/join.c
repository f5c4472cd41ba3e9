/* Joining. With -spacing_follow a particle with too small a share proposes to that neighbour with which it loses the
   least kinetic energy. At fixed spacings such a ring proposes to its nearest neighbour, and a graded particle without
   others of its size to its nearest larger one. A particle accepts the best proposer by the same rule, unless it has
   proposed to a third particle. If two particles propose to each other, the smaller id stays. Ids, positions and
   velocities decide, so all ranks agree.

   With the nearest neighbour a drop impact whose spacing follows the liquid lost 11 uJ of 225 exchanged by joins, with
   the cheapest 2.6 (and joins below a share of 0.3 in place of 0.45). */
#include "resampling_impl.h"

#define NOBODY      (-1)
#define JOINED_MOST 1.3   /* largest share after joining */
#define REACH       1.25  /* spacings, largest distance of two particles that join */
#define PATH        0.45  /* spacings, largest distance times the smaller share: 0.75 spacings for a share of 0.6 */
#define AS_ONE      1e-6  /* square of the least difference of velocities, over the velocity, that decides a choice */
#define ALONE       0.125 /* part of its support that liquid of its size fills: nine particles in space */
#define LARGER      1.5   /* ratio of sizes from which a neighbour is larger */
#define TOUCHES     1.5   /* mean spacings of a pair: largest distance of graded particles that join */

/* Whether particle b may join: it is liquid and no image behind a face of the box. */
static PetscBool MayJoin(Cloud cloud, PetscInt b)
{
  const Domain     domain = cloud->domain;
  const PetscReal *x      = cloud->field[FIELD_POSITION] + DIM * b;

  if (cloud->integer[INT_LAYER][b]) return PETSC_FALSE;
  for (PetscInt d = 0; d < domain->dim; d++)
    if (x[d] < domain->lower[d] || x[d] > domain->upper[d]) return PETSC_FALSE;
  return PETSC_TRUE;
}

static PetscReal Distance2(Cloud cloud, PetscInt a, PetscInt b)
{
  const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, *y = cloud->field[FIELD_POSITION] + DIM * b;
  const PetscReal  r[DIM] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};

  return Dot(r, r);
}

/* The mean of a value of a and b, weighted by volume. */
static PetscReal Mean(Cloud cloud, const PetscReal value[], PetscInt a, PetscInt b)
{
  const PetscReal *V = cloud->volume;

  return (V[a] * value[a] + V[b] * value[b]) / (V[a] + V[b]);
}

/* What a particle with the parts of_a and of_b (1) of the volume of two others has of their values of a field. */
static PetscReal Carried(Carry carry, PetscReal of_a, PetscReal value_a, PetscReal of_b, PetscReal value_b)
{
  switch (carry) {
  case CARRY_MEAN:
  case CARRY_SCALAR:
    return of_b * value_b + of_a * value_a;
  case CARRY_SUM:
    return value_a + value_b;
  case CARRY_LOGARITHM:
    return value_a > 0 && value_b > 0 ? PetscPowReal(value_a / value_b, of_a) * value_b : value_b;
  default:
    return value_b;
  }
}

/* The share of a and b joined. */
static PetscReal JoinedShare(Cloud cloud, const Change *change, PetscInt a, PetscInt b)
{
  const PetscReal *unit = change->unit, *share = change->share;
  const int        dim = (int)cloud->domain->dim;

  return (share[a] * PetscPowRealInt(unit[a], dim) + share[b] * PetscPowRealInt(unit[b], dim)) /
         PetscPowRealInt(Mean(cloud, unit, a, b), dim);
}

/* Whether the bodies k and l are the same liquid. */
static PetscBool SameLiquid(Scene scene, PetscInt k, PetscInt l)
{
  return (PetscBool)(k == l || (SceneLiquid(scene, k) == SceneLiquid(scene, l) &&
                                BodiesAlike(SceneBody(scene, k), SceneBody(scene, l))));
}

/* Whether a and b may join by their shares: their liquids may mix, they are close, and they make no particle that is
   too large. One colour tells the liquid of the first body only, so other bodies do not mix with each other. d2: square
   of their distance, m2. */
static PetscBool SharesFit(Cloud cloud, const Change *change, PetscInt a, PetscInt b, PetscReal d2)
{
  const Domain    domain  = cloud->domain;
  const PetscReal spacing = change->unit[a] * domain->spacing, *share = change->share;
  const PetscInt  k = cloud->integer[INT_BODY][a], l = cloud->integer[INT_BODY][b];

  return (PetscBool)(d2 <= PetscSqr(REACH * spacing) &&
                     (k == l || (domain->adaptive && (k == 0 || l == 0) && SameLiquid(cloud->scene, k, l))) &&
                     JoinedShare(cloud, change, a, b) <= JOINED_MOST &&
                     (domain->rings || DomainSize(domain, cloud->volume[a] + cloud->volume[b]) <= cloud->size_most) &&
                     PetscMin(share[a], share[b]) * PetscSqrtReal(d2) <= PATH * spacing);
}

/* Whether the graded particles a and b, no rings, may join. */
static PetscBool SizesFit(Cloud cloud, PetscInt a, PetscInt b, PetscReal d2)
{
  const PetscReal *size = cloud->size, V = cloud->volume[a] + cloud->volume[b];

  return (PetscBool)(PetscMax(size[a], size[b]) > LARGER * PetscMin(size[a], size[b]) &&
                     d2 <= PetscSqr(TOUCHES * CloudPairSize(cloud, a, b) * cloud->domain->spacing) &&
                     DomainSize(cloud->domain, V) <= cloud->size_most &&
                     SameLiquid(cloud->scene, cloud->integer[INT_BODY][a], cloud->integer[INT_BODY][b]));
}

/* What speaks against joining a and b, d2 (m2) apart squared: the energy that it takes, over half of a's mass, m2/s2;
   at fixed spacings the distance. Liquid that moves as one has differences by rounding only, which no choice may depend
   on: there the distance decides. */
static PetscReal Price(Cloud cloud, PetscInt a, PetscInt b, PetscReal d2)
{
  const PetscReal *u = cloud->field[FIELD_VELOCITY] + DIM * a, *v = cloud->field[FIELD_VELOCITY] + DIM * b;
  const PetscReal  dv[DIM] = {u[0] - v[0], u[1] - v[1], u[2] - v[2]};

  if (!cloud->domain->adaptive) return d2;
  return Dot(dv, dv) * cloud->volume[b] / (cloud->volume[a] + cloud->volume[b]) +
         AS_ONE * (Dot(u, u) + PETSC_MACHINE_EPSILON) * d2 / PetscSqr(cloud->domain->spacing);
}

/* Local index of the neighbour that may join a at the least price, or NOBODY. At equal prices the smaller id decides.
   proposal: [n_total], the neighbour must have proposed to a; NULL: any neighbour. */
static PetscInt Cheapest(Cloud cloud, const Change *change, PetscInt a, const PetscInt proposal[])
{
  const PetscInt *id    = cloud->integer[INT_ID];
  PetscReal       least = PETSC_MAX_REAL;
  PetscInt        best  = NOBODY;

  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    const PetscInt  b  = cloud->list[k];
    const PetscReal d2 = Distance2(cloud, a, b), price = Price(cloud, a, b, d2);

    if (price > least || (price == least && id[b] > id[best])) continue;
    if (id[b] == id[a] || !MayJoin(cloud, b) || (proposal && proposal[b] != id[a])) continue;
    if (!(ByShare(cloud->domain) ? SharesFit(cloud, change, a, b, d2) : SizesFit(cloud, a, b, d2))) continue;
    least = price;
    best  = b;
  }
  return best;
}

/* Whether little liquid of its own size surrounds particle a. */
static PetscBool IsAlone(Cloud cloud, PetscInt a)
{
  const PetscReal R = cloud->size[a] * KernelSupport(cloud->kernel);
  PetscReal       V = cloud->volume[a];

  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++)
    if (cloud->size[cloud->list[k]] <= LARGER * cloud->size[a]) V += cloud->volume[cloud->list[k]];
  return (PetscBool)(V < ALONE * PETSC_PI * R * R * (cloud->domain->dim == 3 ? 4 * R / 3 : 1));
}

/* Particle b absorbs a. */
static void Absorb(Cloud cloud, PetscInt b, PetscInt a, Change *change, ResamplingReport *report)
{
  const PetscReal *V = cloud->volume, sum = V[a] + V[b], of_a = V[a] / sum, of_b = V[b] / sum;
  const PetscReal *u = cloud->field[FIELD_VELOCITY] + DIM * a, *v = cloud->field[FIELD_VELOCITY] + DIM * b;
  const PetscReal  dv[DIM] = {u[0] - v[0], u[1] - v[1], u[2] - v[2]};

  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++)
    for (PetscInt c = 0; change->arrays.real[f] && c < Fields[f].width; c++)
      change->arrays.real[f][Fields[f].width * b + c] =
        Carried(Fields[f].carry, of_a, cloud->field[f][Fields[f].width * a + c], of_b,
                cloud->field[f][Fields[f].width * b + c]);
  if (change->arrays.real[FIELD_SIZE])
    change->arrays.real[FIELD_SIZE][b] =
      cloud->domain->adaptive ? ShareSize(cloud, change, b, sum / V[b]) : Mean(cloud, change->unit, a, b);
  if (change->arrays.real[FIELD_COLOUR])
    change->arrays.integer[INT_BODY][b] = change->arrays.real[FIELD_COLOUR][b] >= 0.5
                                            ? 0
                                            : PetscMax(cloud->integer[INT_BODY][a], cloud->integer[INT_BODY][b]);
  change->changed[b] = PETSC_TRUE;
  report->energy += 0.5 * cloud->rest_density[b] * sum * of_a * of_b * Dot(dv, dv);
}

PetscErrorCode JoinSmall(Cloud cloud, Change *change, ResamplingReport *report)
{
  const PetscInt *id    = cloud->integer[INT_ID];
  const PetscReal least = cloud->domain->adaptive ? LEAST_FOLLOW : LEAST;
  PetscInt       *proposal, *accepted, *chosen; /* ids, ids; local indices */

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(cloud->n_total, &proposal, cloud->n_total, &accepted, cloud->n_owned, &chosen));
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    PetscBool small = PETSC_FALSE;

    if (a < cloud->n_fluid && MayJoin(cloud, a))
      small = ByShare(cloud->domain) ? (PetscBool)(change->share[a] < least) : IsAlone(cloud, a);
    chosen[a]   = small ? Cheapest(cloud, change, a, NULL) : NOBODY;
    proposal[a] = chosen[a] == NOBODY ? NOBODY : id[chosen[a]];
  }
  PetscCall(CloudUpdateIntArray(cloud, proposal));
  for (PetscInt b = 0; b < cloud->n_owned; b++) {
    PetscInt a = NOBODY;

    if (b < cloud->n_fluid && MayJoin(cloud, b)) a = Cheapest(cloud, change, b, proposal);
    if (a != NOBODY && proposal[b] != NOBODY && (proposal[b] != id[a] || id[b] > id[a])) a = NOBODY;
    accepted[b] = a == NOBODY ? NOBODY : id[a];
    if (a != NOBODY) Absorb(cloud, b, a, change, report);
  }
  PetscCall(CloudUpdateIntArray(cloud, accepted));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    if (chosen[a] == NOBODY || accepted[chosen[a]] != id[a]) continue;
    change->keep[a] = PETSC_FALSE;
    report->joined++;
  }
  PetscCall(PetscFree3(proposal, accepted, chosen));
  PetscFunctionReturn(PETSC_SUCCESS);
}
