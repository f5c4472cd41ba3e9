/* Free bodies in the pressure equation. Their velocity at the end of a step depends on the pressure, and the divergence
   on their velocity. With c the divergence of the rows, times their masses, for a unit velocity of the body, M its
   inertia and U its velocity without the pressure, the force of the pressure is F = V c p, and

     A p = b(U) - c dU/dt,  M dU = dt F:   (A + c M^-1 c^T/m) p = b(U),

   symmetric and positive for any mass, however small: added mass needs no iteration. (With liquids of different
   densities it would not be symmetric: rows have masses as weights, the force has volumes.) The preconditioner is that
   of A; each velocity of a body costs the solver about one iteration more. */
#include "pressure_impl.h"

/* The rows with a divergence from the motion of one body. */
struct _p_Coupling {
  Body       solid;
  PetscInt   body; /* INT_BODY of its dummy particles */
  PetscInt   count, capacity, *row;
  PetscReal *slope; /* [count][FREE_MOTIONS] mass of a row times its divergence for a unit motion */
};

PetscErrorCode CouplingReset(Pressure pressure)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < pressure->couplings; k++) {
    PetscCall(PetscFree(pressure->coupling[k].row));
    PetscCall(PetscFree(pressure->coupling[k].slope));
  }
  PetscCall(PetscFree(pressure->coupling));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Create(Pressure pressure)
{
  Scene scene = pressure->cloud->scene;

  PetscFunctionBegin;
  if (pressure->coupling || !SceneHasFree(scene)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscCalloc1(SceneSolidCount(scene), &pressure->coupling));
  for (PetscInt b = 0; b < SceneSolidCount(scene); b++) {
    if (BodyMass(SceneSolid(scene, b)) == 0) continue;
    pressure->coupling[pressure->couplings].solid  = SceneSolid(scene, b);
    pressure->coupling[pressure->couplings++].body = BODY_SOLID - b;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds a particle's part of a row; deeper dummy particles share the row of their parent. */
static PetscErrorCode AddRow(struct _p_Coupling *c, PetscInt row, PetscReal mass, const PetscReal slope[FREE_MOTIONS])
{
  PetscFunctionBegin;
  if (c->count == c->capacity) {
    c->capacity = 2 * c->capacity + 1024;
    PetscCall(PetscRealloc((size_t)c->capacity * sizeof(*c->row), &c->row));
    PetscCall(PetscRealloc((size_t)c->capacity * FREE_MOTIONS * sizeof(*c->slope), &c->slope));
  }
  c->row[c->count] = row;
  for (PetscInt k = 0; k < FREE_MOTIONS; k++) c->slope[FREE_MOTIONS * c->count + k] = mass * slope[k];
  c->count++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CouplingSetUp(Pressure pressure)
{
  Cloud           cloud = pressure->cloud;
  const PetscReal reach = KernelSupport(cloud->kernel) * cloud->size_most;

  PetscFunctionBegin;
  PetscCall(Create(pressure));
  for (PetscInt k = 0; k < pressure->couplings; k++) {
    struct _p_Coupling *c = &pressure->coupling[k];
    PetscReal           center[DIM], motion[FREE_MOTIONS], slope[FREE_MOTIONS], y[DIM];

    c->count = 0;
    FreeMotion(c->solid, center, motion);
    for (PetscInt a = 0; a < cloud->n_owned; a++) {
      const PetscInt row = a < cloud->n_rows ? a : ParentRow(pressure, a);

      if (a < cloud->n_fluid ? BodyNearest(c->solid, cloud->field[FIELD_POSITION] + DIM * a, y) > reach
                             : cloud->integer[INT_BODY][a] != c->body)
        continue;
      if (pressure->pair_diagonal[row] == 0) continue;
      OperatorsSolidDivergence(cloud, a, c->body, center, slope);
      PetscCall(AddRow(c, row, cloud->volume[a] * cloud->rest_density[row] * pressure->row_scale, slope));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The force of the pressures p ([n_rows], Pa) on each body, force[couplings][FREE_MOTIONS] (N, N m). */
static PetscErrorCode Forces(Pressure pressure, const PetscScalar p[], PetscReal force[])
{
  const PetscReal volume = 1 / (pressure->row_scale * BodyMaterial(SceneBody(pressure->cloud->scene, 0))->density);

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(force, FREE_MOTIONS * pressure->couplings));
  for (PetscInt k = 0; k < pressure->couplings; k++) {
    const struct _p_Coupling *c = &pressure->coupling[k];

    for (PetscInt r = 0; r < c->count; r++)
      for (PetscInt m = 0; m < FREE_MOTIONS; m++)
        force[FREE_MOTIONS * k + m] += volume * c->slope[FREE_MOTIONS * r + m] * PetscRealPart(p[c->row[r]]);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, force, (PetscMPIInt)(FREE_MOTIONS * pressure->couplings), MPIU_REAL,
                             MPIU_SUM, pressure->cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureFreeForces(Pressure pressure, PetscReal force[])
{
  PetscFunctionBegin;
  PetscCall(Forces(pressure, pressure->cloud->field[FIELD_PRESSURE], force));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CouplingAdd(Pressure pressure, const PetscScalar p[], PetscScalar y[])
{
  PetscReal force[FREE_MOTIONS * SCENE_MAX_BODIES];

  PetscFunctionBegin;
  PetscCall(Forces(pressure, p, force));
  for (PetscInt k = 0; k < pressure->couplings; k++) {
    const struct _p_Coupling *c = &pressure->coupling[k];
    PetscReal                 change[FREE_MOTIONS];

    FreeResponse(c->solid, force + FREE_MOTIONS * k, change);
    for (PetscInt r = 0; r < c->count; r++)
      for (PetscInt m = 0; m < FREE_MOTIONS; m++) y[c->row[r]] += c->slope[FREE_MOTIONS * r + m] * change[m];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
