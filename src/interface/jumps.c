/* The tension of the interface between two immiscible liquids, as jumps of the pressure.

   The tension of each pair of A, B and gas is the sum of two parts, sigma_AB = s_A + s_B, sigma_A = s_A + s_G and
   sigma_B = s_B + s_G (Smith, Solis and Chopp 2002). So each of the three has one tension along its whole boundary, and
   triple lines need no treatment: the corners of the three boundaries balance at the angles of Neumann's triangle. The
   curvature of the boundary of A is that of the free surface of A alone (tension/curvature.c). The same holds for B,
   and for both together, whose boundary is that of the gas.

   The pressure of A is raised by s_A kappa_A (the cloud's pressure_jump), that of B by s_B kappa_B; the gas has -s_G
   kappa_AB, with kappa_AB the curvature of both together. Sums over neighbours in different liquids use pressures less
   their jumps, and missing neighbours at a free surface have the pressure pressure_jump + s_G kappa_AB. A drop of
   constant curvature is then at rest exactly, like a drop of a single liquid. */
#include "interface_impl.h"

/* Finds the bits of all particles ([n_total]), and which fluid particles are at the interface, ghosts too. */
static PetscErrorCode FindLiquids(Cloud cloud, unsigned char bits[])
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_total; a++) {
    if (cloud->integer[INT_LAYER][a] != 0) cloud->liquid[a] = -1; /* from the last step */
    bits[a] = (unsigned char)(cloud->liquid[a] < 0 ? 0 : 1 << cloud->liquid[a]);
  }
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    cloud->at_interface[a] = 0;
    for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1] && !cloud->at_interface[a]; k++)
      cloud->at_interface[a] = CloudAcross(cloud, a, cloud->list[k]);
  }
  PetscCall(CloudUpdateIntArray(cloud, cloud->at_interface));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One pass: the surface of a phase. */
static PetscErrorCode Pass(Tension tension, Cloud cloud, Phase phase)
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(cloud->field[FIELD_CAPILLARY], cloud->n_owned));
  PetscCall(PetscArrayzero(cloud->field[FIELD_CAPILLARY_SLOPE], DIM * cloud->n_owned));
  PetscCall(TensionSurface(tension, cloud, &phase));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Particles at the interface that are too deep for a normal take the curvature of the other liquid. */
static PetscErrorCode CompleteJumps(Cloud cloud, const PetscReal part[3])
{
  PetscReal *added;

  PetscFunctionBegin;
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, cloud->pressure_jump));
  PetscCall(CloudGetWork(cloud, 1, &added));
  PetscCall(PetscArrayzero(added, cloud->n_fluid));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal other = part[1 - cloud->liquid[a]];
    PetscReal       sum = 0, weights = 0;

    if (!cloud->at_interface[a] || cloud->pressure_jump[a] != 0 || other == 0) continue;
    for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
      const PetscInt b = cloud->list[k];

      if (!CloudAcross(cloud, a, b) || cloud->pressure_jump[b] == 0) continue;
      sum += cloud->laplacian[k] * cloud->pressure_jump[b];
      weights += cloud->laplacian[k];
    }
    if (weights > 0) added[a] = -sum / weights * part[cloud->liquid[a]] / other;
  }
  for (PetscInt a = 0; a < cloud->n_fluid; a++) cloud->pressure_jump[a] += added[a];
  PetscCall(CloudRestoreWork(cloud, &added));
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, cloud->pressure_jump));
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, cloud->pressure_jump_slope));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode InterfaceApply(Tension tension, Cloud cloud)
{
  PetscReal     *capillary = cloud->field[FIELD_CAPILLARY], *slope = cloud->field[FIELD_CAPILLARY_SLOPE], part[3];
  unsigned char *bits;

  PetscFunctionBegin;
  SceneTensions(cloud->scene, part);
  PetscCall(PetscMalloc1(cloud->n_total, &bits));
  PetscCall(FindLiquids(cloud, bits));
  PetscCall(PetscArrayzero(cloud->pressure_jump, cloud->n_total));
  PetscCall(PetscArrayzero(cloud->pressure_jump_slope, DIM * cloud->n_total));
  for (PetscInt l = 0; l < 2; l++) {
    PetscCall(Pass(tension, cloud, (Phase){1 << l, bits, part[l], cloud->at_interface}));
    for (PetscInt a = 0; a < cloud->n_fluid; a++) cloud->pressure_jump[a] += capillary[a];
    for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) cloud->pressure_jump_slope[k] += slope[k];
  }
  PetscCall(CompleteJumps(cloud, part));
  PetscCall(Pass(tension, cloud, (Phase){3, bits, part[2], NULL}));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) capillary[a] += cloud->pressure_jump[a];
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) slope[k] += cloud->pressure_jump_slope[k];
  PetscCall(PetscFree(bits));
  PetscFunctionReturn(PETSC_SUCCESS);
}
