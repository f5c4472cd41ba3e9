/* How the free surface closes the equation: an addition to the diagonal of the row of a particle whose neighbourhood is
   incomplete, as if the missing neighbours had a known pressure.

     doubled         A_aa + sum_b K_ab: Eq. (11) of Kuri et al., after Bockmann et al. 2012
     full_diagonal   A_aa + c max(0, Lambda_0 m/rho - A_aa), Lambda_0 the diagonal of a full lattice: Nair & Tomar 2014
 */
#include "pressure_impl.h"

/* ClosureFull gives their sources. */
#define FACTOR 2 /* times the filling of Nair and Tomar: p = 0 lies on the surface */
/* rows with a smaller lambda are filled up: rows of the surface and of the layer below. With 0.85 and 0.95 the height
   of a dam break is by 1.5 and 1.4 %, with 0.9 by 1.2 % of 2 a beside the reference; the angular momentum of drops that
   collide off centre changes by 1.0 and 1.6 %, with 0.9 by 0.9 % of R sum m v. */
#define FILLED_LAMBDA 0.9
#define LEAST         2.5 /* times n.B n V/rho: least closure; below 1 a row diverges */

/* Eq. (11): (2 p_a - p_b) in place of (p_a - p_b). */
PetscReal ClosureDoubled(Pressure pressure, PetscInt a, PetscReal diagonal)
{
  return pressure->cloud->integer[INT_SURFACE][a] == 1 ? diagonal : 0;
}

/* The squared size (1) of graded particles around a: the mean over its pairs with their weights in its row. The
   diagonal of a full row follows from this size and not from the particle's own size: a fine particle that mixing has
   brought among coarse particles has a small diagonal. */
static PetscReal SizeAround2(Cloud cloud, PetscInt a)
{
  PetscReal sum = 0, weighted = 0;

  if (cloud->size_most <= 1) return 1;
  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    sum += cloud->laplacian[k];
    weighted += cloud->laplacian[k] * PetscSqr(CloudPairSize(cloud, a, cloud->list[k]));
  }
  return sum > 0 ? weighted / sum : PetscSqr(cloud->size[a]);
}

PetscBool PressureCloses(Pressure pressure, PetscInt a)
{
  return (PetscBool)(pressure->cloud->integer[INT_SURFACE][a] ||
                     pressure->cloud->field[FIELD_LAMBDA][a] < FILLED_LAMBDA);
}

/* Nair & Tomar (2014) fill the diagonal of a row near the surface (lambda < FILLED_LAMBDA) up to that of a full
   neighbourhood, as if the missing neighbours had p = 0. That puts the zero at their positions, 0.8 spacings outside
   the surface: the first pressure of a rotating square is then 8 % too large with 40 spacings along a side. With twice
   the filling (FACTOR) the missing neighbours have -p_a, mirrored in the surface as in Eq. (11): 2.2 %.

   Where two fronts meet, crowded particles have full rows in spite of a free side. Yet by Eq. (9) a pressure p drives
   them outwards by 2 p n/rho, n = sum V grad W, with the corrected divergence 2 n.B n p/rho. If such a row is closed by
   less than half of this, each projection over-corrects and the velocity grows from step to step, 5 to 15 times in a
   row without a closure, for any size of the step. At rest density the filling is 2.5 to 6 n.B n/rho, for all kernels
   and h; crowded rows get at least LEAST. */
PetscReal ClosureFull(Pressure pressure, PetscInt a, PetscReal diagonal)
{
  Cloud            cloud   = pressure->cloud;
  PetscReal        filling = 0, volume, n[DIM];
  const PetscReal *normal;

  if (!pressure->free_surface || a >= cloud->n_fluid || CloudPushes(cloud, a)) return 0;
  volume = PressureRowWeight(pressure, a) / PressureDensity(pressure)[a];
  if (cloud->field[FIELD_LAMBDA][a] < FILLED_LAMBDA)
    filling = FACTOR * PetscMax(0, pressure->lattice_diagonal / SizeAround2(cloud, a) * volume - diagonal);
  if (!cloud->integer[INT_SURFACE][a]) return filling;
  normal = cloud->field[FIELD_NORMAL] + DIM * a;
  TensorApply(cloud->field[FIELD_CORRECTION] + 6 * a, normal[0], normal[1], normal[2], n);
  return PetscMax(filling, LEAST * Dot(n, normal) * volume);
}

void PressureLattice(Cloud cloud, PetscReal *diagonal, PetscReal *sum)
{
  const PetscInt dim   = cloud->domain->dim,
                 reach = (PetscInt)(KernelSupport(cloud->kernel) / cloud->domain->spacing) + 1;
  const PetscReal d0 = cloud->domain->spacing, eta2 = EtaSquared(cloud->kernel), V = cloud->domain->volume;

  *diagonal = *sum = 0;
  for (PetscInt k = dim == 3 ? -reach : 0; k <= (dim == 3 ? reach : 0); k++)
    for (PetscInt j = -reach; j <= reach; j++)
      for (PetscInt i = -reach; i <= reach; i++) {
        const PetscReal r2 = d0 * d0 * (i * i + j * j + k * k);
        PetscReal       W, F;

        KernelEvaluate(cloud->kernel, 1, &r2, &W, &F);
        *sum += V * W;
        if (r2 > 0) *diagonal -= 2 * V * F * r2 / (r2 + eta2);
      }
}
