/* Volumes of shapes, and what a lattice of particles makes of them. */
#include "sim_impl.h"

#define VOLUME_STEP  0.25 /* spacings, of the cells that measure a shape's volume */
#define VOLUME_CELLS 4e6  /* at most */
#define UNEVEN_FLUX  0.02 /* of an emitter: a lattice in a round nozzle of 5 spacings across is 4 % off */

/* Whether particles of a body, or a solid of index 'solid', are at x (m), of its shape. */
static PetscBool IsThere(Sim sim, PetscInt solid, const PetscReal x[DIM])
{
  PetscInt        nearest = -1;
  const PetscReal s       = SceneSolidDistance(sim->scene, x, &nearest);

  return (PetscBool)(solid < 0 ? s > 0 : nearest == solid && s > -PackingSolidDepth(sim->cloud));
}

PetscReal ShapeVolume(Sim sim, Body body, PetscInt solid)
{
  const PetscInt dim = sim->domain->dim;
  PetscReal      lower[DIM], upper[DIM], x[DIM] = {0, 0, 0}, cell = 1, step;
  PetscReal      inside = 0;
  PetscInt       n[DIM] = {1, 1, 1};

  BodyBounds(body, lower, upper);
  for (PetscInt d = 0; d < dim; d++) {
    lower[d] = PetscMax(lower[d], sim->domain->lower[d]);
    upper[d] = PetscMin(upper[d], sim->domain->upper[d]);
    cell *= upper[d] - lower[d];
  }
  step = PetscMax(VOLUME_STEP * sim->domain->spacing, PetscPowReal(cell / VOLUME_CELLS, 1.0 / dim));
  for (PetscInt d = 0; d < dim; d++) {
    n[d] = PetscMax(1, (PetscInt)PetscCeilReal((upper[d] - lower[d]) / step));
    cell /= n[d];
  }
  for (PetscInt k = 0; k < n[0] * n[1] * n[2]; k++) {
    PetscInt index[DIM];

    CellCoordinates(n, k, index);
    for (PetscInt d = 0; d < dim; d++) x[d] = lower[d] + (index[d] + 0.5) * (upper[d] - lower[d]) / n[d];
    if (BodyContains(body, x) && IsThere(sim, solid, x)) inside += DomainPairLength(sim->domain, x, x);
  }
  return cell * inside;
}

PetscErrorCode FillingsView(Sim sim, PetscViewer viewer)
{
  PetscFunctionBegin;
  for (PetscInt b = 0; b < SceneCount(sim->scene); b++) {
    const Body body = SceneBody(sim->scene, b);
    PetscReal  shape, more;

    if (!BodyComesLater(body)) continue;
    shape = ShapeVolume(sim, body, -1);
    more  = shape > 0 ? StepperFilling(sim->stepper, b, NULL) / shape - 1 : 0;
    if (PetscAbsReal(more) < UNEVEN_FLUX) continue;
    PetscCall(PetscViewerASCIIPrintf(
      viewer,
      "warning: a filling of the emitter %s has %+.1f %% of the volume of its shape, and its flux is that of the "
      "particles; choose another -spacing or another width\n",
      BodyName(body), (double)(100 * more)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
