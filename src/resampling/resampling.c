/* Resampling: the time of a resampling, and the change of the swarm. */
#include "resampling_impl.h"

#define INTERVAL 10 /* steps; a particle moves 0.26 spacings in one at most, a fraction of a support in all of them */
#define AT_ONCE  2  /* times MOST: a ring that runs onto the axis grows too fast to wait for the interval */

PetscReal ResamplingArea(Cloud cloud, PetscInt a)
{
  const Domain    domain = cloud->domain;
  const PetscReal length = DomainRingLength(domain, cloud->field[FIELD_POSITION] + DIM * a, cloud->size[a]);

  return cloud->volume[a] / (length * domain->volume) / PetscSqr(cloud->size[a]);
}

PetscBool ResamplingDue(PetscInt step, PetscReal largest)
{
  return (PetscBool)(step % INTERVAL == 0 || largest > AT_ONCE * MOST);
}

/* The unit and the share of each particle, ghosts too: the unit is its size, or what adapts the spacing wants. */
static PetscErrorCode FindShares(Cloud cloud, Change *change)
{
  const Domain     domain = cloud->domain;
  const PetscReal *x      = cloud->field[FIELD_POSITION];

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(change->unit, cloud->size, cloud->n_total));
  if (domain->adaptive) PetscCall(domain->adaptive->find(cloud, change->unit));
  for (PetscInt a = 0; a < cloud->n_total; a++)
    change->share[a] = cloud->volume[a] / (DomainRingLength(domain, x + DIM * a, change->unit[a]) * domain->volume) /
                       PetscPowRealInt(change->unit[a], (int)domain->dim);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ChangeCreate(Cloud cloud, Change *change)
{
  PetscFunctionBegin;
  *change = (Change){.split = 0};
  PetscCall(PetscMalloc2(cloud->n_owned, &change->keep, cloud->n_owned, &change->changed));
  PetscCall(PetscMalloc2(cloud->n_total, &change->unit, cloud->n_total, &change->share));
  PetscCall(PetscMalloc2(cloud->n_fluid, &change->parent, DIM * cloud->n_fluid, &change->at));
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    change->keep[a]    = PETSC_TRUE;
    change->changed[a] = PETSC_FALSE;
  }
  PetscCall(FindShares(cloud, change));
  PetscCall(ParticlesOpen(cloud->particles, &change->arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ids of the new particles ([split]). They follow the largest id of the scene, emitted particles aside, in the order of
   the parents' ids over all ranks. */
static PetscErrorCode NumberNew(Cloud cloud, const Change *change, PetscInt id[])
{
  const PetscInt n = change->split;
  PetscInt       last, total, *own, *all;

  PetscFunctionBegin;
  PetscCall(ParticlesLastId(cloud->comm, cloud->n_owned, cloud->integer[INT_ID], &last));
  PetscCall(PetscMalloc1(n, &own));
  for (PetscInt k = 0; k < n; k++) own[k] = cloud->integer[INT_ID][change->parent[k]];
  PetscCall(GatherAll(cloud->comm, n, own, MPIU_INT, &total, &all));
  PetscCall(PetscSortInt(total, all));
  for (PetscInt k = 0; k < n; k++) {
    PetscInt place;

    PetscCall(PetscFindInt(own[k], total, all, &place));
    id[k] = last + 1 + place;
  }
  PetscCall(PetscFree(all));
  PetscCall(PetscFree(own));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Appends the new halves behind the n particles that stay on this rank. */
static PetscErrorCode AppendNew(Cloud cloud, const Change *change, PetscInt n, const PetscInt id[])
{
  ParticleArrays arrays;

  PetscFunctionBegin;
  PetscCall(ParticlesAppend(cloud->particles, change->split));
  PetscCall(ParticlesOpen(cloud->particles, &arrays));
  for (PetscInt k = 0; k < change->split; k++) {
    const PetscInt   a = change->parent[k], b = n + k;
    const PetscReal *at = change->at + DIM * k;
    PetscReal        dv[DIM];

    SplitVelocity(cloud, a, at, dv);
    for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++)
      for (PetscInt c = 0; arrays.real[f] && c < Fields[f].width; c++)
        arrays.real[f][Fields[f].width * b + c] =
          (Fields[f].carry == CARRY_SUM ? 0.5 : 1) * cloud->field[f][Fields[f].width * a + c];
    for (PetscInt d = 0; d < DIM; d++) {
      arrays.real[FIELD_POSITION][DIM * b + d] += at[d];
      arrays.real[FIELD_VELOCITY][DIM * b + d] += dv[d];
    }
    if (arrays.real[FIELD_SIZE]) arrays.real[FIELD_SIZE][b] = ShareSize(cloud, change, a, 0.5);
    arrays.integer[INT_ID][b] = arrays.integer[INT_PARENT][b] = id[k];
    arrays.integer[INT_BODY][b]                               = cloud->integer[INT_BODY][a];
    arrays.integer[INT_SURFACE][b]                            = cloud->integer[INT_SURFACE][a];
  }
  PetscCall(ParticlesClose(cloud->particles, &arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Changes the swarm. The cloud holds the state before until CloudReload. */
static PetscErrorCode Apply(Cloud cloud, Change *change)
{
  PetscInt n, *id;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(change->split, &id));
  PetscCall(NumberNew(cloud, change, id));
  PetscCall(ParticlesRemove(cloud->particles, change->keep));
  PetscCall(ParticlesLocalSize(cloud->particles, &n));
  PetscCall(AppendNew(cloud, change, n, id));
  PetscCall(PetscFree(id));
  if (cloud->domain->adaptive) PetscCall(cloud->domain->adaptive->walls(cloud));
  PetscCall(CloudReload(cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Resample(Cloud cloud, ResamplingReport *report)
{
  Change    change;
  PetscInt  done[2];
  PetscBool any;

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_RESAMPLING), 0, 0, 0, 0));
  *report = (ResamplingReport){.joined = 0};
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++)
    if (Fields[f].carry != CARRY_OWN && ParticlesHave(cloud->particles, f)) PetscCall(CloudUpdate(cloud, (FieldId)f));
  PetscCall(ChangeCreate(cloud, &change));
  for (PetscInt a = 0; a < cloud->n_fluid && change.arrays.real[FIELD_SIZE]; a++)
    change.arrays.real[FIELD_SIZE][a] = ShareSize(cloud, &change, a, 1);
  PetscCall(JoinSmall(cloud, &change, report));
  if (ByShare(cloud->domain)) PetscCall(SplitLarge(cloud, &change, report));
  PetscCall(ParticlesClose(cloud->particles, &change.arrays));
  done[0] = report->joined;
  done[1] = report->split;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, done, 2, MPIU_INT, MPI_SUM, cloud->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &report->energy, 1, MPIU_REAL, MPI_SUM, cloud->comm));
  report->joined = done[0];
  report->split  = done[1];
  any            = (PetscBool)(done[0] + done[1] > 0);
  if (any || cloud->domain->adaptive) {
    PetscCall(Apply(cloud, &change));
    PetscCall(any && cloud->domain->adaptive ? SmoothDisorder(cloud) : CloudSearch(cloud, NULL, NULL));
  }
  PetscCall(PetscFree2(change.parent, change.at));
  PetscCall(PetscFree2(change.keep, change.changed));
  PetscCall(PetscFree2(change.unit, change.share));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_RESAMPLING), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
