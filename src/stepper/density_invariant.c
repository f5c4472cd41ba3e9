/* The scheme of Kuri et al. (2014) as printed. Stage one moves particles to r^F without pressure; stage two restores
   the rest density there:

     search   rho_a = sum m_b W_ab                                                    Eq. (4) at r^n
     forces   v^F = v^n + dt (viscosity + tension S + g)                              Eqs. (1), (5) to (7)
     predict  r^F = r^n + dt v^F                                                      Eq. (2)
     search   rho_a = sum m_b W_ab, free surface                                      Eq. (4) at r^F
     project  div (grad p/rho) = (rho_0 - rho)/(rho_0 dt^2), closed at the surface    Eqs. (8), (11)
     kick     v^{n+1} = v^F - dt sum m (p_a/rho_a^2 + p_b/rho_b^2) grad W             Eq. (9)
     drift    r^{n+1} = r^n + dt/2 (v^n + v^{n+1})                                    Eq. (10)
     guard    no particle inside a wall; the paper has none

   Eq. (3) is the kernel, the cubic spline with h = 1.3 d0 (src/kernel). FIELD_VELOCITY_STAR has v^F. */
#include "stepper_impl.h"

/* At the free surface the summed density of a lattice is too low, and Eq. (8) makes suction of that. Eq. (11) closes
   rows on the surface only; where two fronts meet, other rows need a closure, too: see closure.c. */
#define ADVICE                                                                                                         \
  "the scheme as printed needs -packing_type poisson, and where liquid meets liquid at speed may need "                \
  "-pressure_closure "                                                                                                 \
  "full_diagonal"
/* The displacement of stage one over that of a step at most: stage two takes part of it back. */
#define PREDICTED_RATIO 2

/* r^F = r^n + dt v^F, ghosts included; start: r^n ([n_owned][3], m). The trial's displacement becomes 0, or the
   displacement if it is too large. */
static PetscErrorCode Predict(Stepper stepper, PetscReal dt, PetscReal start[], StepTrial *trial)
{
  const Cloud      cloud = stepper->cloud;
  PetscReal       *r = cloud->field[FIELD_POSITION], *largest = &trial->largest[LARGEST_DISPLACEMENT];
  const PetscReal *v_star = cloud->field[FIELD_VELOCITY_STAR];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) *largest = PetscMax(*largest, dt * Norm(v_star + DIM * a));
  *largest /= PREDICTED_RATIO;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, largest, 1, MPIU_REAL, MPIU_MAX, cloud->comm));
  if (StepTooFar(stepper, trial)) {
    *largest *= PREDICTED_RATIO;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  *largest = 0;
  PetscCall(PetscArraycpy(start, r, DIM * cloud->n_owned));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) r[k] += dt * v_star[k]; /* Eq. (2) */
  PetscCall(CloudMoved(cloud));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Stage two, from r^F back to the step's end; start: r^n. */
static PetscErrorCode Correct(Stepper stepper, PetscReal dt, const PetscReal start[], StepTrial *trial)
{
  PetscFunctionBegin;
  PetscCall(StepSearch(stepper, PETSC_FALSE));
  PetscCall(TrialDiagnose(stepper, trial));
  if (PressureTakesDivergence(stepper->pressure)) PetscCall(StepDivergence(stepper, 0));
  PetscCall(StepProject(stepper, dt, &trial->pressure)); /* Eqs. (8), (11) */
  if (TrialFailed(trial)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(StepKick(stepper, dt, trial));                 /* Eq. (9) */
  PetscCall(StepDriftOn(stepper, dt, start, PETSC_FALSE)); /* Eq. (10) */
  PetscCall(StepGuard(stepper, dt, start, trial));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DensityInvariantStep(Stepper stepper, PetscReal dt, StepTrial *trial)
{
  Cloud      cloud = stepper->cloud;
  PetscReal *start;

  PetscFunctionBegin;
  PetscCall(CloudBegin(cloud));
  PetscCall(StepSearch(stepper, PETSC_FALSE));
  PetscCall(StepForces(stepper, dt, cloud->field[FIELD_DENSITY], PETSC_FALSE, trial));
  if (TrialFailed(trial)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CloudGetWork(cloud, DIM, &start));
  PetscCall(Predict(stepper, dt, start, trial));
  if (!StepTooFar(stepper, trial)) PetscCall(Correct(stepper, dt, start, trial));
  PetscCall(CloudRestoreWork(cloud, &start));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Create(Stepper stepper)
{
  PetscFunctionBegin;
  stepper->no_slip          = PETSC_FALSE;
  stepper->relaxation_ratio = 5; /* for another source than the scheme's */
  stepper->force_time       = 0;
  PetscCall(PressureSetTypes(stepper->pressure, SOURCE_DENSITY, CLOSURE_DOUBLED, GRADIENT_SYMMETRIC, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const SchemeOps SchemeDensityInvariant = {.choice  = {.name = SCHEME_DENSITY_INVARIANT},
                                          .create  = Create,
                                          .step    = DensityInvariantStep,
                                          .advice  = ADVICE,
                                          .at_once = PETSC_TRUE};
