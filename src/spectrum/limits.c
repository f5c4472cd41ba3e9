/* The explicit terms: their largest stable time steps. */
#include "spectrum_impl.h"

#define TOLERANCE    1e-3 /* relative, of eigenvalues */
#define DISPLACEMENT 1e-3 /* spacings, of the finite difference of the surface tension */

/* y = -(viscous acceleration of the velocity x). */
static PetscErrorCode ApplyViscosity(Mat shell, Vec x, Vec y)
{
  Spectrum           s;
  const PetscScalar *u;
  PetscScalar       *a;
  Cloud              cloud;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &s));
  cloud = s->cloud;
  PetscCall(ProgressWork(cloud->comm, -1, "a product of the viscosity"));
  PetscCall(PetscArrayzero(cloud->field[FIELD_VELOCITY], DIM * cloud->n_owned));
  PetscCall(PetscArrayzero(cloud->field[FIELD_ACCELERATION], DIM * cloud->n_owned));
  PetscCall(VecGetArrayRead(x, &u));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) cloud->field[FIELD_VELOCITY][k] = PetscRealPart(u[k]);
  PetscCall(VecRestoreArrayRead(x, &u));
  PetscCall(CloudUpdate(cloud, FIELD_VELOCITY));
  PetscCall(OperatorsViscosity(cloud, s->viscosity, cloud->rest_density));
  PetscCall(VecGetArrayWrite(y, &a));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) a[k] = -cloud->field[FIELD_ACCELERATION][k];
  PetscCall(VecRestoreArrayWrite(y, &a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Acceleration, capillary pressure and its slope, by surface tension at the positions s->position + scale displacement.
 */
static PetscErrorCode DisplacedTension(Spectrum s, const PetscReal displacement[], PetscReal scale)
{
  Cloud cloud = s->cloud;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(cloud->field[FIELD_POSITION], s->position, DIM * cloud->n_owned));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) cloud->field[FIELD_POSITION][k] += scale * displacement[k];
  PetscCall(CloudMoved(cloud));
  PetscCall(PetscArrayzero(cloud->field[FIELD_ACCELERATION], DIM * cloud->n_owned));
  PetscCall(TensionApply(s->tension, cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CapillaryResponse(Spectrum s, const PetscReal displacement[], PetscReal acceleration[])
{
  const FieldId fields[] = {FIELD_ACCELERATION, FIELD_CAPILLARY_SLOPE, FIELD_CAPILLARY}; /* vector, vector, scalar */
  Cloud         cloud    = s->cloud;
  PetscReal     largest  = 0, scale, *before[3];
  PetscScalar  *rhs;
  KSP           ksp;
  Vec           b, p;

  PetscFunctionBegin;
  PetscCall(ProgressWork(cloud->comm, -1, "a response of the surface tension"));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) largest = PetscMax(largest, Norm(displacement + DIM * a));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPIU_REAL, MPIU_MAX, cloud->comm));
  scale = DISPLACEMENT * cloud->domain->spacing / PetscMax(largest, PETSC_SMALL * cloud->domain->spacing);
  PetscCall(DisplacedTension(s, displacement, -scale));
  for (PetscInt f = 0; f < 3; f++) {
    PetscCall(PetscMalloc1(DIM * cloud->n_owned, &before[f]));
    PetscCall(PetscArraycpy(before[f], cloud->field[fields[f]], (f < 2 ? DIM : 1) * cloud->n_owned));
  }
  PetscCall(DisplacedTension(s, displacement, scale));
  for (PetscInt f = 0; f < 3; f++) {
    PetscReal *now = cloud->field[fields[f]];

    for (PetscInt k = 0; k < (f < 2 ? DIM : 1) * cloud->n_owned; k++) now[k] = (now[k] - before[f][k]) / (2 * scale);
    PetscCall(PetscFree(before[f]));
  }
  PetscCall(PetscArraycpy(cloud->field[FIELD_POSITION], s->position, DIM * cloud->n_owned));
  PetscCall(CloudMoved(cloud));
  /* the change of pressure in the fluid, from that on the free surface */
  PetscCall(PressureSolver(s->pressure, &ksp, &b));
  PetscCall(VecDuplicate(b, &p));
  PetscCall(VecGetArrayWrite(b, &rhs));
  PetscCall(PressureCapillary(s->pressure, rhs));
  PetscCall(VecRestoreArrayWrite(b, &rhs));
  PetscCall(VecSet(p, 0));
  PetscCall(KSPSetTolerances(ksp, 1e-2 * TOLERANCE, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  PetscCall(KSPSolve(ksp, b, p));
  PetscCall(PressureToCloud(s->pressure, p));
  PetscCall(VecDestroy(&p));
  PetscCall(PressureAcceleration(s->pressure, acceleration));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) acceleration[k] += cloud->field[FIELD_ACCELERATION][k];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = -(acceleration by the displacement x). Eigenvalues are squares of angular frequencies, 1/s2. */
static PetscErrorCode ApplyCapillary(Mat shell, Vec x, Vec y)
{
  Spectrum           s;
  const PetscScalar *u;
  PetscScalar       *a;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &s));
  PetscCall(VecGetArrayRead(x, &u));
  PetscCall(VecGetArrayWrite(y, &a));
  PetscCall(CapillaryResponse(s, u, a));
  for (PetscInt k = 0; k < DIM * s->cloud->n_fluid; k++) a[k] = -a[k];
  PetscCall(VecRestoreArrayWrite(y, &a));
  PetscCall(VecRestoreArrayRead(x, &u));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The eigenvalue that 'which' selects, of an operator on vectors of the fluid; NAN: not found. */
static PetscErrorCode FindEigenvalue(Spectrum s, PetscErrorCode (*apply)(Mat, Vec, Vec), EPSWhich which,
                                     PetscReal *value)
{
  Mat       shell;
  PetscBool found;

  PetscFunctionBegin;
  PetscCall(MatCreateShell(s->cloud->comm, DIM * s->cloud->n_fluid, DIM * s->cloud->n_fluid, PETSC_DETERMINE,
                           PETSC_DETERMINE, s, &shell));
  PetscCall(MatShellSetOperation(shell, MATOP_MULT, (void (*)(void))apply));
  PetscCall(SpectrumExtreme(shell, EPS_NHEP, which, TOLERANCE, NULL, value, &found));
  PetscCall(MatDestroy(&shell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* nu: largest kinematic viscosity, m2/s. */
static PetscErrorCode PrintViscosity(Spectrum s, PetscReal nu, PetscReal dt)
{
  const PetscReal d2 = PetscSqr(s->cloud->domain->spacing);
  PetscReal       value;

  PetscFunctionBegin;
  PetscCall(FindEigenvalue(s, ApplyViscosity, EPS_LARGEST_MAGNITUDE, &value));
  PetscCall(PetscPrintf(s->cloud->comm,
                        "    viscosity  largest eigenvalue %.5g 1/s = %.4g nu/d0^2: stable up to 2/lambda = %.4g s, "
                        "%.3g times the step\n",
                        (double)value, (double)(value * d2 / nu), (double)(2 / value), (double)(2 / value / dt)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A positive eigenvalue is the square of an angular frequency. A negative eigenvalue is minus the square of a growth
   rate: surface tension makes liquid coalesce or break up. That is physics, not an instability of the time step. */
static PetscErrorCode PrintTension(Spectrum s, PetscReal dt)
{
  PetscReal largest, value;

  PetscFunctionBegin;
  PetscCall(FindEigenvalue(s, ApplyCapillary, EPS_LARGEST_MAGNITUDE, &largest));
  value = largest;
  if (largest < 0) PetscCall(FindEigenvalue(s, ApplyCapillary, EPS_LARGEST_REAL, &value));
  if (value <= 0)
    PetscCall(PetscPrintf(s->cloud->comm, "    tension    no oscillation: stable with any step\n"));
  else {
    const PetscReal omega = PetscSqrtReal(value);

    PetscCall(PetscPrintf(s->cloud->comm,
                          "    tension    largest frequency %.5g 1/s: stable up to 2/omega = %.4g s, %.3g times the "
                          "step\n",
                          (double)omega, (double)(2 / omega), (double)(2 / omega / dt)));
  }
  if (largest < 0)
    PetscCall(PetscPrintf(s->cloud->comm,
                          "               liquid coalesces or breaks up: a displacement grows at %.5g 1/s, by %.3g %% "
                          "per step\n",
                          (double)PetscSqrtReal(-largest),
                          (double)(100 * (PetscExpReal(dt * PetscSqrtReal(-largest)) - 1))));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SpectrumLimits(Spectrum s, PetscReal dt)
{
  PetscReal nu = 0;

  PetscFunctionBegin;
  PetscCall(CloudCheckUnknowns(s->cloud->comm, s->cloud->n_fluid, DIM, "-spectrum"));
  PetscCall(PetscPrintf(s->cloud->comm, "  explicit terms, against the time step %.4g s\n", (double)dt));
  for (PetscInt b = 0; b < SceneCount(s->cloud->scene); b++) {
    const Material *m = BodyMaterial(SceneBody(s->cloud->scene, b));

    if (!s->cloud->field[FIELD_VISCOSITY]) nu = PetscMax(nu, m->viscosity / m->density);
  }
  for (PetscInt a = 0; a < s->cloud->n_fluid && s->cloud->field[FIELD_VISCOSITY]; a++)
    nu = PetscMax(nu, s->cloud->field[FIELD_VISCOSITY][a] / s->cloud->rest_density[a]);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &nu, 1, MPIU_REAL, MPIU_MAX, s->cloud->comm));
  if (nu > 0) PetscCall(PrintViscosity(s, nu, dt));
  if (SceneInterfaceTension(s->cloud->scene) > 0)
    PetscCall(PetscPrintf(s->cloud->comm, "    tension    no limit is computed with an interface between liquids\n"));
  else if (TensionReach(s->tension) > 0)
    PetscCall(PrintTension(s, dt));
  PetscFunctionReturn(PETSC_SUCCESS);
}
