/* Joining. A ring with too small a share proposes to its nearest neighbour, a graded particle that is alone among
   larger ones to the nearest of these. That one accepts the nearest of those who propose to it, unless it has itself
   proposed to a third; of two that propose to each other the one with the smaller id stays. Ids and places decide, so
   all ranks agree. */
#include "resampling_impl.h"

#define NOBODY   (-1)
#define LEAST    0.6  /* ring area over spacing^2 below which rings join */
#define TOGETHER 1.3  /* that of two that join, at most */
#define REACH    1.25 /* spacings between two that join, at most ... */
#define PATH     0.45 /* ... and over the smaller share: 0.75 for one of 0.6; a tiny one may go further */
#define LARGER   1.5  /* times the size of a particle that is alone among such particles */
#define TOUCHES  1.5  /* mean spacings of a pair: what is farther apart does not join */

/* Whether particle b may join with another: liquid, and not an image behind a face of the box. */
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

/* The size of a and b as one: the mean of theirs, by volume. */
static PetscReal JoinedSize(Cloud cloud, PetscInt a, PetscInt b)
{
  const PetscReal *V = cloud->volume, *size = cloud->size;

  return (V[a] * size[a] + V[b] * size[b]) / (V[a] + V[b]);
}

/* The share of a and b as one. */
static PetscReal JoinedShare(Cloud cloud, const PetscReal share[], PetscInt a, PetscInt b)
{
  const PetscReal *size = cloud->size;

  if (!size) return share[a] + share[b];
  return (share[a] * PetscSqr(size[a]) + share[b] * PetscSqr(size[b])) / PetscSqr(JoinedSize(cloud, a, b));
}

/* Whether a particle of body k may join with one of body l: it is the same liquid. */
static PetscBool SameLiquid(Scene scene, PetscInt k, PetscInt l)
{
  const Material *m, *n;

  if (k == l) return PETSC_TRUE;
  m = BodyMaterial(SceneBody(scene, k));
  n = BodyMaterial(SceneBody(scene, l));
  return (PetscBool)(m->density == n->density && m->viscosity == n->viscosity && m->tension == n->tension &&
                     SceneLiquid(scene, k) == SceneLiquid(scene, l) && !SceneViscosityVaries(scene));
}

/* Whether two rings at the square d2 (m2) of their distance may join: of one body, close enough, and together not too
   large. */
static PetscBool RingsFit(Cloud cloud, const Resampling *resampling, const PetscReal share[], PetscInt a, PetscInt b,
                          PetscReal d2)
{
  const PetscReal spacing = CloudSize(cloud, a) * cloud->domain->spacing;

  return (PetscBool)(d2 <= PetscSqr(REACH * spacing) && cloud->integer[INT_BODY][a] == cloud->integer[INT_BODY][b] &&
                     JoinedShare(cloud, share, a, b) <= TOGETHER &&
                     PetscMin(share[a], share[b]) * PetscSqrtReal(d2) <= PATH * spacing);
}

/* The same of graded particles that are no rings. */
static PetscBool SizesFit(Cloud cloud, PetscInt a, PetscInt b, PetscReal d2)
{
  const PetscReal *size = cloud->size, V = cloud->volume[a] + cloud->volume[b];

  return (PetscBool)(PetscMax(size[a], size[b]) > LARGER * PetscMin(size[a], size[b]) &&
                     d2 <= PetscSqr(TOUCHES * CloudPairSize(cloud, a, b) * cloud->domain->spacing) &&
                     DomainSize(cloud->domain, V) <= cloud->size_most &&
                     SameLiquid(cloud->scene, cloud->integer[INT_BODY][a], cloud->integer[INT_BODY][b]));
}

/* The nearest neighbour of a that fits; with proposal ([n_total], NULL: any) only among those that have proposed to a.
   The local index, or NOBODY. Of two equally near the smaller id. */
static PetscInt Nearest(Cloud cloud, const Resampling *resampling, const PetscReal share[], PetscInt a,
                        const PetscInt proposal[])
{
  const PetscInt *id    = cloud->integer[INT_ID];
  PetscReal       least = PETSC_MAX_REAL;
  PetscInt        best  = NOBODY;

  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    const PetscInt  b  = cloud->list[k];
    const PetscReal d2 = Distance2(cloud, a, b);

    if (d2 > least || (d2 == least && id[b] > id[best])) continue;
    if (id[b] == id[a] || !MayJoin(cloud, b) || (proposal && proposal[b] != id[a])) continue;
    if (!(cloud->domain->rings ? RingsFit(cloud, resampling, share, a, b, d2) : SizesFit(cloud, a, b, d2))) continue;
    least = d2;
    best  = b;
  }
  return best;
}

/* Whether there is little liquid of its own size around particle a: it takes no part in what the larger ones compute,
   which only push it about. */
static PetscBool IsAlone(Cloud cloud, const Resampling *resampling, PetscInt a)
{
  const PetscReal R = cloud->size[a] * KernelSupport(cloud->kernel);
  PetscReal       V = cloud->volume[a];

  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++)
    if (cloud->size[cloud->list[k]] <= LARGER * cloud->size[a]) V += cloud->volume[cloud->list[k]];
  return (PetscBool)(V < resampling->alone * PETSC_PI * R * R * (cloud->domain->dim == 3 ? 4 * R / 3 : 1));
}

/* Particle b takes a up. */
static void TakeUp(Cloud cloud, PetscInt b, PetscInt a, Change *change, ResamplingReport *report)
{
  const PetscReal *V = cloud->volume, sum = V[a] + V[b], of_a = V[a] / sum, of_b = V[b] / sum;
  const PetscReal *u = cloud->field[FIELD_VELOCITY] + DIM * a, *v = cloud->field[FIELD_VELOCITY] + DIM * b;
  const PetscReal  dv[DIM] = {u[0] - v[0], u[1] - v[1], u[2] - v[2]};

  for (PetscInt f = FIELD_POSITION; f <= FIELD_PRESSURE; f++)
    for (PetscInt c = 0; c < Fields[f].width; c++) {
      const PetscInt k = Fields[f].width * b + c;

      change->arrays.real[f][k] = of_b * cloud->field[f][k] + of_a * cloud->field[f][Fields[f].width * a + c];
    }
  change->arrays.real[FIELD_VOLUME][b] = sum;
  if (change->arrays.real[FIELD_SIZE]) change->arrays.real[FIELD_SIZE][b] = JoinedSize(cloud, a, b);
  change->changed[b] = PETSC_TRUE;
  report->energy += 0.5 * cloud->rest_density[b] * sum * of_a * of_b * Dot(dv, dv);
}

PetscErrorCode JoinSmall(Cloud cloud, const Resampling *resampling, Change *change, ResamplingReport *report)
{
  const PetscInt *id = cloud->integer[INT_ID];
  PetscInt       *proposal, *accepted, *chosen; /* ids, ids; local indices */

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(cloud->n_total, &proposal, cloud->n_total, &accepted, cloud->n_owned, &chosen));
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    PetscBool small = PETSC_FALSE;

    if (a < cloud->n_fluid && MayJoin(cloud, a))
      small = cloud->domain->rings ? (PetscBool)(change->share[a] < LEAST) : IsAlone(cloud, resampling, a);
    chosen[a]   = small ? Nearest(cloud, resampling, change->share, a, NULL) : NOBODY;
    proposal[a] = chosen[a] == NOBODY ? NOBODY : id[chosen[a]];
  }
  PetscCall(CloudUpdateIntArray(cloud, proposal));
  for (PetscInt b = 0; b < cloud->n_owned; b++) {
    PetscInt a = NOBODY;

    if (b < cloud->n_fluid && MayJoin(cloud, b)) a = Nearest(cloud, resampling, change->share, b, proposal);
    if (a != NOBODY && proposal[b] != NOBODY && (proposal[b] != id[a] || id[b] > id[a])) a = NOBODY;
    accepted[b] = a == NOBODY ? NOBODY : id[a];
    if (a != NOBODY) TakeUp(cloud, b, a, change, report);
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
