/* Joining. A particle with too small a share proposes to its nearest neighbour. That one accepts the nearest of those
   who propose to it, unless it has itself proposed to a third; of two that propose to each other the one with the
   smaller id stays. Ids and places decide, so all ranks agree. */
#include "resampling_impl.h"

#define NOBODY (-1)

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

/* The nearest neighbour of a that fits: of its body, close enough, and together not too large; with proposal
   ([n_total], NULL: any) only among those that have proposed to a. The local index, or NOBODY. Of two equally near the
   smaller id. */
static PetscInt Nearest(Cloud cloud, const Resampling *resampling, const PetscReal share[], PetscInt a,
                        const PetscInt proposal[])
{
  const PetscInt *id = cloud->integer[INT_ID], *body = cloud->integer[INT_BODY];
  const PetscReal spacing = CloudSize(cloud, a) * cloud->domain->spacing;
  PetscReal       least   = PetscSqr(resampling->reach * spacing);
  PetscInt        best    = NOBODY;

  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    const PetscInt  b  = cloud->list[k];
    const PetscReal d2 = Distance2(cloud, a, b);

    if (d2 > least || (d2 == least && (best == NOBODY || id[b] > id[best]))) continue;
    if (id[b] == id[a] || body[b] != body[a] || !MayJoin(cloud, b) ||
        JoinedShare(cloud, share, a, b) > resampling->together)
      continue;
    if (PetscMin(share[a], share[b]) * PetscSqrtReal(d2) > resampling->path * spacing) continue;
    if (proposal && proposal[b] != id[a]) continue;
    least = d2;
    best  = b;
  }
  return best;
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
    const PetscBool small =
      (PetscBool)(a < cloud->n_fluid && change->share[a] < resampling->least && MayJoin(cloud, a));

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
