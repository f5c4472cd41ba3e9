/* Resampling: options, the time of a resampling, and the change of the swarm. */
#include "resampling_impl.h"

#define INTERVAL   10
#define BISECTIONS 20
#define AT_ONCE    2     /* times MOST: a ring that runs onto the axis grows too fast to wait for the interval */
#define ALONE      0.125 /* about nine particles in three dimensions */

static const OptionRow interval[] = {
  {"-resampling_interval", "Steps between two resamplings, sooner if a ring grows too large; 0: never", "1", "[0, inf)",
   ROW_INT, offsetof(Resampling, interval)},
  {.name = NULL},
};
static const OptionRow most[] = {
  {"-particles_most",
   "With -spacing_follow: particles of liquid that the spacing may ask for; more, and it is coarser everywhere; 0: no "
   "bound",
   "1", "[0, inf)", ROW_INT, offsetof(Resampling, particles_most)},
  {.name = NULL},
};
static const OptionRow alone[] = {
  {"-resampling_alone",
   "A graded particle joins a larger neighbour if liquid of its own size fills less than this part of its support; 0: "
   "never",
   "1", "[0, 1)", ROW_REAL, offsetof(Resampling, alone)},
  {.name = NULL},
};

PetscErrorCode ResamplingSetFromOptions(Cloud cloud, Resampling *r)
{
  const Domain    domain = cloud->domain;
  const PetscBool any = DomainVolumesDiffer(domain), follows = (PetscBool)(domain->follow > 0),
                  fixed = (PetscBool)(domain->graded && !ByShare(domain));

  PetscFunctionBegin;
  *r = (Resampling){.interval = INTERVAL, .alone = ALONE, .least = LEAST, .most = MOST};
  if (domain->follow) {
    r->least = LEAST_FOLLOW;
    r->most  = MOST_FOLLOW;
  }
  PetscOptionsBegin(cloud->comm, NULL, "Joining and splitting of particles", "Resampling");
  PetscCall(
    OptionsReadIf(PetscOptionsObject, any, "-dimension axisymmetric or -spacing_coarse", interval, __func__, r));
  if (!any) r->interval = 0;
  PetscCall(OptionsReadIf(PetscOptionsObject, follows, "-spacing_follow", most, __func__, r));
  PetscCall(OptionsReadIf(PetscOptionsObject, fixed, "-spacing_coarse without -spacing_follow", alone, __func__, r));
  PetscOptionsEnd();
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal ResamplingArea(Cloud cloud, PetscInt a)
{
  const Domain    domain = cloud->domain;
  const PetscReal length = DomainRingLength(domain, cloud->field[FIELD_POSITION] + DIM * a, cloud->size[a]);

  return cloud->volume[a] / (length * domain->volume) / PetscSqr(cloud->size[a]);
}

PetscBool ResamplingDue(const Resampling *r, PetscInt step, PetscReal largest)
{
  return (PetscBool)(r->interval > 0 && (step % r->interval == 0 || largest > AT_ONCE * MOST));
}

/* The particles of liquid, of all ranks, that a target 'factor' times as coarse asks for. */
static PetscErrorCode CountWanted(Cloud cloud, const PetscReal unit[], PetscReal factor, PetscReal *count)
{
  const Domain domain = cloud->domain;
  PetscReal    sum    = 0;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    sum += cloud->weight[a] /
           PetscPowRealInt(PetscMin(factor * unit[a], domain->spacing_coarse / domain->spacing), (int)domain->dim);
  PetscCallMPI(MPI_Allreduce(&sum, count, 1, MPIU_REAL, MPI_SUM, cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes the target coarser until it asks for no more than -particles_most. */
static PetscErrorCode BoundCount(Cloud cloud, const Resampling *resampling, PetscReal unit[])
{
  const PetscReal coarsest = cloud->domain->spacing_coarse / cloud->domain->spacing;
  PetscReal       low = 1, high = coarsest, count;

  PetscFunctionBegin;
  if (!resampling->particles_most) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CountWanted(cloud, unit, low, &count));
  if (count <= resampling->particles_most) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < BISECTIONS; k++) {
    const PetscReal middle = 0.5 * (low + high);

    PetscCall(CountWanted(cloud, unit, middle, &count));
    if (count > resampling->particles_most)
      low = middle;
    else
      high = middle;
  }
  for (PetscInt a = 0; a < cloud->n_total; a++) unit[a] = PetscMin(high * unit[a], coarsest);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The unit and the share of each particle, ghosts too: the unit is its size, or what -spacing_follow wants there. */
static PetscErrorCode FindShares(Cloud cloud, const Resampling *resampling, Change *change)
{
  const Domain     domain = cloud->domain;
  const PetscReal *x      = cloud->field[FIELD_POSITION];

  PetscFunctionBegin;
  if (domain->follow) PetscCall(TargetFind(cloud));
  for (PetscInt a = 0; a < cloud->n_total; a++)
    change->unit[a] = domain->follow ? SceneSpacing(cloud->scene, x + DIM * a) / domain->spacing : cloud->size[a];
  for (PetscInt a = 0; a < cloud->n_total && domain->follow; a++)
    if (TargetIsThin(cloud, a)) change->unit[a] = PetscMin(change->unit[a], cloud->size[a]);
  if (domain->follow) PetscCall(BoundCount(cloud, resampling, change->unit));
  for (PetscInt a = 0; a < cloud->n_total; a++)
    change->share[a] = cloud->volume[a] / (DomainRingLength(domain, x + DIM * a, change->unit[a]) * domain->volume) /
                       PetscPowRealInt(change->unit[a], (int)domain->dim);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ChangeCreate(Cloud cloud, const Resampling *resampling, Change *change)
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
  PetscCall(FindShares(cloud, resampling, change));
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

/* Changes the swarm. The cloud holds the state before until CloudResync. */
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
  if (cloud->domain->follow) PetscCall(ResampleWalls(cloud));
  PetscCall(CloudResync(cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Resample(Cloud cloud, const Resampling *resampling, ResamplingReport *report)
{
  Change   change;
  PetscInt done[2];

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_RESAMPLING), 0, 0, 0, 0));
  *report = (ResamplingReport){.joined = 0};
  for (PetscInt f = 0; f < FIELD_STORED_COUNT; f++)
    if (Fields[f].carry != CARRY_OWN && ParticlesHave(cloud->particles, f)) PetscCall(CloudUpdate(cloud, (FieldId)f));
  if (cloud->domain->follow) PetscCall(CloudUpdate(cloud, FIELD_LAMBDA));
  PetscCall(ChangeCreate(cloud, resampling, &change));
  for (PetscInt a = 0; a < cloud->n_fluid && change.arrays.real[FIELD_SIZE]; a++)
    change.arrays.real[FIELD_SIZE][a] = ShareSize(cloud, &change, a, 1);
  PetscCall(JoinSmall(cloud, resampling, &change, report));
  if (ByShare(cloud->domain)) PetscCall(SplitLarge(cloud, resampling, &change, report));
  PetscCall(ParticlesClose(cloud->particles, &change.arrays));
  done[0] = report->joined;
  done[1] = report->split;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, done, 2, MPIU_INT, MPI_SUM, cloud->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &report->energy, 1, MPIU_REAL, MPI_SUM, cloud->comm));
  report->joined = done[0];
  report->split  = done[1];
  if (done[0] + done[1] > 0 || cloud->domain->follow) PetscCall(Apply(cloud, &change));
  if (done[0] + done[1] > 0 && cloud->domain->follow) PetscCall(SmoothDisorder(cloud));
  PetscCall(PetscFree2(change.parent, change.at));
  PetscCall(PetscFree2(change.keep, change.changed));
  PetscCall(PetscFree2(change.unit, change.share));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_RESAMPLING), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
