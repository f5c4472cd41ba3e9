/* The source that the pressure must remove: rhs = minus the source of div(grad p/rho), in 1/s2.

     density      (rho - rho_0)/(rho_0 dt^2), Eq. (8) of Kuri et al.: density invariance
     divergence   -div(v*)/dt - e/(dt T), e the density defect that the free surface does not explain, T the time in
                  which it is corrected */
#include "pressure_impl.h"

/* Of T, for liquid whose weight is carried: a tank at rest moves by half more with 1, and a wave gains what the errors
   of density at its surface give. With 0.2 a dam break loses 0.42 % of its energy and its front is by 1.24 % beside the
   reference, with 0.8 0.28 and 1.03 %, with 0.4 0.24 and 0.98 %. */
#define LOADED      0.4
#define LEAST_STEPS 3 /* in which the divergence source corrects density errors; SourceDivergence says why */

/* Eq. (8): rhs = (rho_a - rho_0)/(rho_0 dt^2). Walls push, but pull only with -pressure_wall_suction: the density of a
   wall particle without liquid all around is too low although no liquid is rarefied. Its row has few pairs and would
   turn this into a suction that tears particles off, for any size of the step. */
PetscErrorCode SourceDensity(Pressure pressure, PetscReal dt, PetscReal rhs[])
{
  Cloud            cloud = pressure->cloud;
  const PetscReal *rho = cloud->field[FIELD_DENSITY], *rest = cloud->rest_density;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_rows; a++) rhs[a] = (rho[a] / rest[a] - 1) / (dt * dt);
  if (!pressure->wall_suction)
    for (PetscInt a = cloud->n_fluid; a < cloud->n_rows; a++) rhs[a] = PetscMax(rhs[a], 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define LAMBDA_FULL 0.95           /* above: a full neighbourhood, F = 1 */
#define LAMBDA_THIN MOMENT_MINIMUM /* below: too few neighbours for F; only compression counts */

PetscBool PressureHolds(Pressure pressure, PetscInt a)
{
  const Cloud cloud = pressure->cloud;

  return BodyHolds(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]), cloud->field[FIELD_POSITION] + DIM * a,
                   0.5 * cloud->size[a] * cloud->domain->spacing);
}

/* F is the fraction of sum V W below a plane free surface, where |sum V grad W| is that of particle a; S is the sum on
   a full lattice. */
PetscReal PressureDensityDefect(Pressure pressure, PetscInt a)
{
  Cloud            cloud    = pressure->cloud;
  const PetscReal *gradient = cloud->field[FIELD_NORMAL] + DIM * a, lambda = cloud->field[FIELD_LAMBDA][a];
  PetscReal        fraction = 1, defect;

  if (PressureHolds(pressure, a)) return 0;
  if (lambda < LAMBDA_FULL) {
    const PetscReal place = cloud->size[a] * Norm(gradient) / pressure->surface_plane * SURFACE_TABLE;
    const PetscInt  k     = (PetscInt)PetscMin(place, (PetscReal)(SURFACE_TABLE - 1));
    const PetscReal t     = PetscMin(place - k, 1.0);

    fraction = (1 - t) * pressure->surface_fraction[k] + t * pressure->surface_fraction[k + 1];
    fraction += SurfaceDensity(pressure, a);
  }
  defect = fraction - cloud->field[FIELD_DENSITY][a] / (cloud->rest_density[a] * pressure->lattice_sum);
  return lambda < LAMBDA_THIN ? PetscMin(defect, 0) : defect;
}

/* rhs = -(1/dt) div v* of FIELD_DIVERGENCE less e/(dt T), T at least LEAST_STEPS dt: in fewer steps the correction
   overshoots, and a Couette flow with implicit viscosity at dt = 3 T blows up. Rows of walls have the divergence alone,
   with the sum of deeper layers. In a centered step the positions are those of the middle, but the new velocity is that
   at the end, so the divergence must be that at the end (time_offset of OperatorsDivergence). A velocity without
   divergence in the middle would have the divergence dt/2 tr (grad v)^2 at the end: the density would drift by this
   times T, and the pressure would lose an energy of dt/2 |grad p|^2/rho for each volume and time, 3 % of the energy of
   Taylor-Green vortices of Re 1000 at 50 spacings. */
PetscErrorCode SourceDivergence(Pressure pressure, PetscReal dt, PetscReal rhs[])
{
  Cloud            cloud = pressure->cloud;
  const PetscReal *div   = cloud->field[FIELD_DIVERGENCE];
  const PetscReal  least = LEAST_STEPS * dt, T = pressure->relaxation_time;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    rhs[a] = -div[a] / dt - PressureDensityDefect(pressure, a) *
                              (pressure->repair /
                               (dt * PetscMax(cloud->size[a] * T * (1 + (LOADED - 1) * ShareOf(pressure, a)), least)));
  for (PetscInt a = cloud->n_fluid; a < cloud->n_rows; a++) rhs[a] = -div[a] / dt;
  for (PetscInt a = cloud->n_rows; a < cloud->n_owned; a++) {
    const PetscInt r = ParentRow(pressure, a);

    rhs[r] -= div[a] / dt * (cloud->volume[a] / cloud->volume[r]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PressureSource(Pressure pressure, PetscReal dt, PetscReal rhs[])
{
  PetscFunctionBegin;
  PetscCall(RowsNumber(pressure));
  PetscCall(pressure->source(pressure, dt, rhs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool PressureTakesDivergence(Pressure pressure)
{
  return (PetscBool)(pressure->source == SourceDivergence);
}
