/* Measures a trial of a step, and decides whether it is accepted. */
#include "stepper_impl.h"

/* over the rest density, of clumped particles: a step is rolled back. What runs well is far from it: 2 and 6 change no
   digit of ten cases, a dam break, drops that collide and a sheet of one particle among them. */
#define DENSITY_MAX     3
#define OPEN_FACE_REACH 4 /* spacings from an open face within which a cut sheet may look underresolved */

/* Whether particle a has neighbours along a line at most, in liquid so viscous that no capillary wave of a spacing's
   length breaks it up (mu^2 > rho sigma d0, implicit steps): a sheet or thread is one particle thick there and tears.
   Liquid whose velocity is given, or that is about to leave through an open face, does not count: its end is a cut. */
static PetscBool IsUnderresolved(Stepper stepper, PetscInt a)
{
  Cloud            cloud  = stepper->cloud;
  const Domain     domain = cloud->domain;
  const Body       body   = SceneBody(cloud->scene, cloud->integer[INT_BODY][a]);
  const Material  *m      = BodyMaterial(body);
  const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, reach = cloud->size[a] * domain->spacing;

  if (cloud->field[FIELD_LAMBDA][a] > SPRAY_LAMBDA || !stepper->viscous.implicit) return PETSC_FALSE;
  if (PetscSqr(m->viscosity) <= m->density * m->tension * domain->spacing) return PETSC_FALSE;
  for (PetscInt d = 0; d < domain->dim; d++)
    if ((domain->face[d][0] == FACE_OPEN && x[d] < domain->lower[d] + OPEN_FACE_REACH * reach) ||
        (domain->face[d][1] == FACE_OPEN && x[d] > domain->upper[d] - OPEN_FACE_REACH * reach))
      return PETSC_FALSE;
  return (PetscBool)!BodyHolds(body, x, reach);
}

StepTrial *TrialStart(Stepper stepper, PetscReal dt, PetscBool diagnose)
{
  for (PetscInt k = 0; k < stepper->edge_sum_count; k++) stepper->edge_sums[k] = 0;
  stepper->now.dt    = dt;
  stepper->now.usual = PetscMax(dt, stepper->now.usual);
  stepper->result    = (StepTrial){.diagnose = diagnose};
  return &stepper->result;
}

PetscErrorCode TrialDiagnose(Stepper stepper, StepTrial *trial)
{
  Cloud      cloud = stepper->cloud;
  PetscReal *div;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal ratio = cloud->field[FIELD_DENSITY][a] / cloud->rest_density[a],
                    sigma = BodyMaterial(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]))->tension;

    trial->largest[LARGEST_DENSITY] = PetscMax(trial->largest[LARGEST_DENSITY], ratio);
    trial->sum[SUM_SURFACE_ENERGY] += sigma * OperatorsSurfaceArea(cloud, a, 0);
    trial->sum[SUM_UNDERRESOLVED] += IsUnderresolved(stepper, a);
    if (cloud->integer[INT_SURFACE][a] || PressureHolds(stepper->pressure, a)) continue; /* nothing corrects it there */
    trial->sum[SUM_DENSITY] += ratio;
    trial->sum[SUM_DENSITY2] += PetscSqr(ratio - 1);
    trial->sum[SUM_INSIDE]++;
  }
  StepHook(stepper, diagnose, &step);
  if (!trial->diagnose) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CloudGetWork(cloud, 1, &div));
  PetscCall(OperatorsDivergence(cloud, cloud->field[FIELD_VELOCITY], PETSC_TRUE, 0, div, NULL, NULL));
  for (PetscInt a = 0; a < cloud->n_fluid; a++)
    if (!cloud->integer[INT_SURFACE][a] && !PressureHolds(stepper->pressure, a))
      trial->sum[SUM_DIVERGENCE2] += PetscSqr(div[a]);
  PetscCall(CloudRestoreWork(cloud, &div));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TrialReduce(Stepper stepper, StepTrial *trial)
{
  Cloud            cloud = stepper->cloud;
  const PetscReal *v     = cloud->field[FIELD_VELOCITY];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal m = cloud->rest_density[a] * cloud->volume[a];

    trial->sum[SUM_MASS] += m;
    trial->sum[SUM_KINETIC] += 0.5 * m * Dot(v + DIM * a, v + DIM * a);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, trial->largest, LARGEST_COUNT, MPIU_REAL, MPIU_MAX, cloud->comm));
  if (stepper->edge_sum_count > 0)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, stepper->edge_sums, (PetscMPIInt)stepper->edge_sum_count, MPIU_REAL,
                               MPIU_SUM, cloud->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, trial->sum, SUM_COUNT, MPIU_REAL, MPIU_SUM, cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Says why a solver failed. */
static PetscErrorCode ExplainSolver(Stepper stepper, PetscReal dt, const StepTrial *trial, char why[], size_t length)
{
  KSP    ksp;
  Vec    b;
  size_t used;

  PetscFunctionBegin;
  if (SolverFailed(&trial->viscous)) {
    PetscCall(SolverExplain(stepper->viscous.solver.ksp, &trial->viscous, VISCOUS_EQUATION, why, length));
    TextAppend(why, length, ", or a smaller -time_step_max");
  } else {
    PetscCall(PressureSolver(stepper->pressure, &ksp, &b));
    PetscCall(SolverExplain(ksp, &trial->pressure.solver, PRESSURE_EQUATION, why, length));
  }
  PetscCall(PetscStrlen(why, &used));
  PetscCall(PetscSNPrintf(why + used, length - used, " (step %g s)", (double)dt));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode TrialCheck(Stepper stepper, PetscReal dt, const StepTrial *trial, char why[], size_t length)
{
  const TrialLimits *limits = &stepper->trial;
  const char        *knob   = stepper->limits.fixed > 0 ? "-time_step" : "-time_cfl";
  const PetscReal    moved  = trial->largest[LARGEST_DISPLACEMENT] / stepper->cloud->domain->spacing,
                  at_hand   = limits->at_hand * trial->sum[SUM_MASS];

  PetscFunctionBegin;
  why[0] = 0;
  if (TrialFailed(trial))
    PetscCall(ExplainSolver(stepper, dt, trial, why, length));
  else if (trial->largest[LARGEST_BROKEN] > 0)
    PetscCall(PetscSNPrintf(why, length,
                            "positions or velocities are not numbers any more (step %g s): try a smaller %s",
                            (double)dt, knob));
  else if (moved > limits->displacement)
    PetscCall(PetscSNPrintf(why, length,
                            "a particle would move %.3g spacings in one step of %g s, more than -displacement_max %g: "
                            "try a smaller %s",
                            (double)moved, (double)dt, (double)limits->displacement, knob));
  else if (limits->energy > 0 && trial->largest[LARGEST_DENSITY] > DENSITY_MAX)
    PetscCall(PetscSNPrintf(why, length,
                            "the density reaches %.3g times the rest density: particles have clumped; try a smaller "
                            "-time_cfl, -shifting or a smaller -spacing",
                            (double)trial->largest[LARGEST_DENSITY]));
  else if (at_hand > 0 && limits->energy > 0 && trial->sum[SUM_KINETIC] > limits->energy * at_hand)
    PetscCall(
      PetscSNPrintf(why, length,
                    "the kinetic energy is %.3g times the most that speeds, falls and surfaces of the scene can give, "
                    "more than -energy_max %g: the run is unstable; try a smaller -time_cfl or -spacing",
                    (double)(trial->sum[SUM_KINETIC] / at_hand), (double)limits->energy));
  PetscFunctionReturn(PETSC_SUCCESS);
}
