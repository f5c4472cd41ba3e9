/* Free bodies in the pressure equation. Their velocity at the end of a step depends on the pressure, and the divergence
   on their velocity. With c the divergence of the rows, times their volumes, for a unit velocity of the body, M its
   inertia and U its velocity without the pressure, the force of the pressure is F = V c p, and

     A p = b(U) - c dU/dt,  M dU = dt F:   (A + c M^-1 c^T/m) p = b(U),

   symmetric and positive for any mass, however small: added mass needs no iteration. The preconditioner is that of A;
   each velocity of a body costs the solver about one iteration more. */
#include "bodies_impl.h"

#define BEFORE 1.25 /* spacings, from a dummy particle of the first layer to what is in front of its solid */
#define ROOM   0.4  /* spacings, from there to the next wall or solid at least, if something can be there */

/* The rows with a divergence from the motion of one body. */
struct _p_Coupling {
  Body       solid;
  PetscInt   body; /* INT_BODY of its dummy particles */
  PetscInt   count, capacity, *row;
  PetscReal *slope; /* [count][RIGID_MOTIONS] weight of a row times its divergence for a unit motion */
};

/* Adds a particle's part of a row; deeper dummy particles share the row of their parent. */
static PetscErrorCode AddRow(struct _p_Coupling *c, PetscInt row, PetscReal weight,
                             const PetscReal slope[RIGID_MOTIONS])
{
  PetscFunctionBegin;
  if (c->count == c->capacity) {
    c->capacity = 2 * c->capacity + 1024;
    PetscCall(PetscRealloc((size_t)c->capacity * sizeof(*c->row), &c->row));
    PetscCall(PetscRealloc((size_t)c->capacity * RIGID_MOTIONS * sizeof(*c->slope), &c->slope));
  }
  c->row[c->count] = row;
  for (PetscInt k = 0; k < RIGID_MOTIONS; k++) c->slope[RIGID_MOTIONS * c->count + k] = weight * slope[k];
  c->count++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetUp(void *context, Pressure pressure)
{
  FreeData       *data  = (FreeData *)context;
  const Cloud     cloud = data->cloud;
  const PetscReal reach = KernelSupport(cloud->kernel) * cloud->size_most;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < data->couplings; k++) {
    struct _p_Coupling *c = &data->coupling[k];
    PetscReal           center[DIM], motion[RIGID_MOTIONS], slope[RIGID_MOTIONS], y[DIM];

    c->count = 0;
    FreeMotion(c->solid, center, motion);
    for (PetscInt a = 0; a < cloud->n_owned; a++) {
      PetscInt row;

      if (a < cloud->n_fluid ? BodyNearest(c->solid, cloud->field[FIELD_POSITION] + DIM * a, y) > reach
                             : cloud->integer[INT_BODY][a] != c->body)
        continue;
      row = PressureRow(pressure, a);
      if (row < 0) continue;
      OperatorsSolidDivergence(cloud, a, c->body, center, slope);
      PetscCall(AddRow(c, row, PressureRowWeight(pressure, row) * cloud->volume[a] / cloud->volume[row], slope));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The force of the pressures p ([n_rows], Pa) on each body, force[couplings][RIGID_MOTIONS] (N, N m). */
static PetscErrorCode Forces(const FreeData *data, Pressure pressure, const PetscScalar p[], PetscReal force[])
{
  const Cloud     cloud  = data->cloud;
  const PetscReal volume = cloud->domain->volume;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(force, RIGID_MOTIONS * data->couplings));
  for (PetscInt k = 0; k < data->couplings; k++) {
    const struct _p_Coupling *c = &data->coupling[k];

    for (PetscInt r = 0; r < c->count; r++)
      for (PetscInt m = 0; m < RIGID_MOTIONS; m++)
        force[RIGID_MOTIONS * k + m] += volume * c->slope[RIGID_MOTIONS * r + m] * PetscRealPart(p[c->row[r]]);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, force, (PetscMPIInt)(RIGID_MOTIONS * data->couplings), MPIU_REAL, MPIU_SUM,
                             cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Add(void *context, Pressure pressure, const PetscScalar p[], PetscScalar y[])
{
  const FreeData *data = (const FreeData *)context;
  PetscReal       force[RIGID_MOTIONS * SCENE_MAX_BODIES];

  PetscFunctionBegin;
  PetscCall(Forces(data, pressure, p, force));
  for (PetscInt k = 0; k < data->couplings; k++) {
    const struct _p_Coupling *c = &data->coupling[k];
    PetscReal                 change[RIGID_MOTIONS];

    FreeResponse(c->solid, force + RIGID_MOTIONS * k, change);
    for (PetscInt r = 0; r < c->count; r++)
      for (PetscInt m = 0; m < RIGID_MOTIONS; m++) y[c->row[r]] += c->slope[RIGID_MOTIONS * r + m] * change[m];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Yield(void *context, Pressure pressure, const PetscReal force[], PetscReal acceleration[],
                            PetscReal y[])
{
  const FreeData *data = (const FreeData *)context;
  PetscReal       sum[RIGID_MOTIONS * SCENE_MAX_BODIES];

  PetscFunctionBegin;
  PetscCall(FreeSum(data->cloud, force, NULL, sum));
  for (PetscInt k = 0; k < data->couplings; k++) {
    const struct _p_Coupling *c     = &data->coupling[k];
    const PetscInt            solid = BODY_SOLID - c->body;
    PetscReal                 change[RIGID_MOTIONS];

    FreeResponse(c->solid, sum + RIGID_MOTIONS * solid, change);
    FreeSetVelocities(data->cloud, solid, change, acceleration);
    for (PetscInt r = 0; r < c->count; r++)
      for (PetscInt m = 0; m < RIGID_MOTIONS; m++) y[c->row[r]] += c->slope[RIGID_MOTIONS * r + m] * change[m];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the front of dummy particle a of a solid is empty: neither liquid nor a wall or another solid is there. */
static PetscBool IsBare(Cloud cloud, PetscInt a)
{
  const Domain     domain = cloud->domain;
  const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, *n = cloud->solid_normal + DIM * a,
                  d0 = domain->spacing * cloud->size[a];
  PetscReal front[DIM];

  for (PetscInt d = 0; d < DIM; d++) front[d] = x[d] + BEFORE * d0 * n[d];
  for (PetscInt d = 0; d < domain->dim; d++)
    if ((domain->face[d][0] == FACE_WALL && front[d] < domain->lower[d] + ROOM * d0) ||
        (domain->face[d][1] == FACE_WALL && front[d] > domain->upper[d] - ROOM * d0))
      return PETSC_FALSE;
  if (SceneSolidDistance(cloud->scene, front, NULL) < ROOM * d0) return PETSC_FALSE;
  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    const PetscReal *y = cloud->field[FIELD_POSITION] + DIM * cloud->list[k];
    PetscReal        r[DIM];

    for (PetscInt d = 0; d < DIM; d++) r[d] = y[d] - front[d];
    DomainNearest(domain, r);
    if (Norm(r) < d0) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* The pressure of liquid without a free surface moves a body if the body has liquid on one side and emptiness on the
   other: the ram of a hydraulic jack does, a body within the liquid or on the floor below it does not, but for the
   disorder of its dummy particles. wet and bare: the sums of the areas, as vectors; they are equal for the ram. */
static PetscErrorCode Level(void *context, Pressure pressure, PetscBool *held)
{
  const FreeData *data   = (FreeData *)context;
  const Cloud     cloud  = data->cloud;
  const PetscReal volume = cloud->domain->volume;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < data->couplings && !*held; k++) {
    const struct _p_Coupling *c           = &data->coupling[k];
    PetscReal                 sum[2][DIM] = {{0}}, *wet = sum[0], *bare = sum[1];

    for (PetscInt r = 0; r < c->count; r++)
      for (PetscInt d = 0; d < DIM; d++) wet[d] += volume * c->slope[RIGID_MOTIONS * r + d];
    for (PetscInt a = cloud->n_fluid; a < cloud->n_owned; a++) {
      if (cloud->integer[INT_BODY][a] != c->body || cloud->integer[INT_LAYER][a] != 1 || !IsBare(cloud, a)) continue;
      for (PetscInt d = 0; d < DIM; d++)
        bare[d] += cloud->volume[a] / (cloud->domain->spacing * cloud->size[a]) * cloud->solid_normal[DIM * a + d];
    }
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 2 * DIM, MPIU_REAL, MPI_SUM, cloud->comm));
    *held = (PetscBool)(Dot(wet, bare) > 0.5 * Dot(wet, wet));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CouplingForces(FreeData *data, Pressure pressure, PetscReal force[])
{
  PetscReal *load, sum[RIGID_MOTIONS * SCENE_MAX_BODIES];

  PetscFunctionBegin;
  PetscCall(Forces(data, pressure, data->cloud->field[FIELD_PRESSURE], force));
  PetscCall(CloudGetWork(data->cloud, DIM, &load));
  PetscCall(PetscArrayzero(load, DIM * data->cloud->n_total));
  PetscCall(PressureLoad(pressure, load));
  PetscCall(FreeSum(data->cloud, load, NULL, sum));
  PetscCall(CloudRestoreWork(data->cloud, &load));
  for (PetscInt k = 0; k < data->couplings; k++)
    for (PetscInt m = 0; m < RIGID_MOTIONS; m++)
      force[RIGID_MOTIONS * k + m] += sum[RIGID_MOTIONS * (BODY_SOLID - data->coupling[k].body) + m];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CouplingCreate(FreeData *data, Cloud cloud, Pressure pressure)
{
  static const LowRank term  = {.set_up = SetUp, .add = Add, .yield = Yield, .level = Level};
  const Scene          scene = cloud->scene;

  PetscFunctionBegin;
  if (!SceneHasFree(scene)) PetscFunctionReturn(PETSC_SUCCESS);
  data->cloud = cloud;
  PetscCall(PetscCalloc1(SceneSolidCount(scene), &data->coupling));
  for (PetscInt b = 0; b < SceneSolidCount(scene); b++) {
    if (BodyMass(SceneSolid(scene, b)) == 0) continue;
    data->coupling[data->couplings].solid  = SceneSolid(scene, b);
    data->coupling[data->couplings++].body = BODY_SOLID - b;
  }
  PetscCall(PressureAddLowRank(pressure, &term, data));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CouplingDestroy(FreeData *data)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < data->couplings; k++) {
    PetscCall(PetscFree(data->coupling[k].row));
    PetscCall(PetscFree(data->coupling[k].slope));
  }
  PetscCall(PetscFree(data->coupling));
  PetscFunctionReturn(PETSC_SUCCESS);
}
