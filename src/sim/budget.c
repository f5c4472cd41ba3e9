/* The error budget at the end of a run: what the numbers cannot hide, and which knob to turn first. */
#include "sim_impl.h"

#define SOLVER_SHARE  0.3  /* of the divergence that steps leave: the solver's tolerance shows */
#define ENERGY_SHARE  0.01 /* of the energy exchanged that may be missing or appear */
#define SOLVER_FINE   1e-5 /* rms density error that a solver may leave in a step in any case */
#define DENSITY_FINE  1e-3 /* rms density error that needs no remedy */
#define TENSION_SHARE 0.4  /* by which the measured work of surface tension may be wrong at R/d0 = 8 */
#define LINE_LENGTH   512

static PetscReal Energy(const GaugeTotals *totals)
{
  return totals->kinetic_energy + totals->potential_energy;
}

PetscErrorCode BudgetStart(Sim sim)
{
  GaugeTotals totals;

  PetscFunctionBegin;
  PetscCall(StepperMeasure(sim->stepper, &sim->state));
  PetscCall(GaugesTotals(sim->gauges, &totals));
  sim->state.start_energy   = Energy(&totals);
  sim->state.start_density  = sim->state.density_mean;
  sim->state.kinetic_energy = totals.kinetic_energy / totals.multiplicity;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The energy (J) it took to lift the liquid from the lowest corner of the box to where it is: what a change of its
   volume changes in its own measure. */
static PetscReal Lift(Sim sim, const GaugeTotals *totals)
{
  const Domain    domain = sim->domain;
  const PetscReal mass   = totals->volume * BodyMaterial(SceneBody(sim->scene, 0))->density;
  PetscReal       least  = PETSC_MAX_REAL;

  for (PetscInt corner = 0; corner < 1 << DIM; corner++) {
    PetscReal x[DIM] = {0, 0, 0};

    for (PetscInt d = 0; d < domain->dim; d++) x[d] = corner >> d & 1 ? domain->upper[d] : domain->lower[d];
    least = PetscMin(least, SceneForcePotential(sim->scene, x));
  }
  return PetscAbsReal(totals->potential_energy - mass * least);
}

/* The energy of a run in J: what is there, what came and went, and what is missing (negative) or too much of it. */
typedef struct {
  GaugeTotals totals;
  PetscReal   viscous, friction, tension, gain, residual;
  PetscReal   exchanged; /* what changed its form, or its owner: the measure of the residual */
  PetscReal   doubt;     /* of the residual */
} Balance;

static PetscErrorCode BalanceTake(Sim sim, Balance *b)
{
  const StepState *state = &sim->state;
  PetscReal        outside, much;

  PetscFunctionBegin;
  PetscCall(GaugesTotals(sim->gauges, &b->totals));
  much        = b->totals.multiplicity;
  b->friction = much * state->friction_work;
  b->viscous  = much * state->viscous_work - b->friction;
  b->tension  = much * state->tension_work;
  outside     = much * StepperOutsideWork(state);
  b->gain     = Energy(&b->totals) - state->start_energy;
  b->residual = b->gain - b->viscous - b->friction - b->tension - outside + much * state->resampling_loss;
  b->exchanged =
    much * PetscMax(state->given + state->inflow_energy, state->taken + PetscAbsReal(state->outflow_energy));
  b->doubt = ENERGY_SHARE * b->exchanged + TENSION_SHARE * much * state->tension_swing +
             PetscAbsReal(state->start_density / state->density_mean - 1) * Lift(sim, &b->totals);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The knob that the measured shares point to. The solver and the step show in the divergence that a step leaves, the
   spacing in the density that the particles have in spite of it, and in the energy that disappears. */
static const char *Knob(const StepState *state, const Balance *b)
{
  if (state->solver_error > PetscMax(SOLVER_FINE, SOLVER_SHARE * state->divergence))
    return "the solver's tolerance: a smaller -pressure_density_tolerance or -ksp_rtol";
  if (b->residual > b->doubt) return "the time step, energy grows: a smaller -time_cfl";
  if (state->divergence > state->density_error) return "the time step: a smaller -time_cfl";
  if (b->residual < -b->doubt) return "the particle spacing, energy is lost: a smaller -spacing";
  if (state->density_error > DENSITY_FINE) return "the particle spacing: a smaller -spacing";
  return "nothing: every share is small";
}

/* What was given from outside, of what the scene has: ", solids that move 4.1, ..." */
static PetscErrorCode Outside(Sim sim, PetscReal multiplicity, char text[], size_t length)
{
  const StepState *s = &sim->state;
  const struct {
    const char *name;
    PetscReal   value;
  } given[] = {{"the friction of walls that move", s->friction_work},
               {"the pressure of solids that move", s->solid_work},
               {"shaking", s->shaking_work},
               {"emitters", s->inflow_energy},
               {"what left through open faces", -s->outflow_energy}};
  char part[128];

  PetscFunctionBegin;
  text[0] = 0;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(given); k++) {
    if (given[k].value == 0) continue;
    PetscCall(PetscSNPrintf(part, sizeof(part), ", %s %.4g", given[k].name, (double)(multiplicity * given[k].value)));
    PetscCall(PetscStrlcat(text, part, length));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the residual means. Where liquid meets liquid or a wall at speed, particles lose up to 1/sqrt(N) of the energy
   with N spacings across a drop: 17 and 10 % in the main case with 8 and 16, 25 and 21 % in its like in two dimensions
   with 10 and 20. */
static PetscErrorCode Meaning(Sim sim, const Balance *b, char text[], size_t length)
{
  const Scene     scene = sim->scene;
  const PetscReal share = b->exchanged > 0 ? b->residual / b->exchanged : 0;
  PetscReal       least = PETSC_MAX_REAL, normal;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < SceneCount(scene); k++) {
    BodyScales scales;

    SceneBodyScales(scene, k, &scales);
    least = PetscMin(least, scales.length / sim->domain->spacing);
  }
  normal = PetscMin(1, 1 / PetscSqrtReal(PetscMax(1, least)));
  if (PetscAbsReal(b->residual) <= b->doubt)
    PetscCall(PetscSNPrintf(text, length, "within its own error"));
  else if (share > 0)
    PetscCall(PetscSNPrintf(text, length, "energy has appeared, which no flow does"));
  else
    PetscCall(PetscSNPrintf(
      text, length, "%s with %.0f spacings across the least body: each loses up to %.0f %%, a period of waves a few",
      -share <= normal ? "as after one impact" : "more than one impact takes", (double)least, (double)(100 * normal)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReportEnergy(Sim sim)
{
  const char *joule = GaugeUnit(sim->domain, "J");
  Balance     b;
  char        outside[LINE_LENGTH], meaning[LINE_LENGTH];

  PetscFunctionBegin;
  PetscCall(BalanceTake(sim, &b));
  PetscCall(Outside(sim, b.totals.multiplicity, outside, sizeof(outside)));
  PetscCall(Meaning(sim, &b, meaning, sizeof(meaning)));
  PetscCall(PetscPrintf(sim->comm,
                        "  energy      kinetic %.4g, potential %.4g, together %+.4g %s since the start\n"
                        "              viscosity gave %.4g, tension %.4g%s\n"
                        "              residual %+.3g %s, %+.2g %% of what was exchanged: %s\n"
                        "  dominant    %s\n",
                        (double)b.totals.kinetic_energy, (double)b.totals.potential_energy, (double)b.gain, joule,
                        (double)b.viscous, (double)b.tension, outside, (double)b.residual, joule,
                        b.exchanged > 0 ? 100 * (double)(b.residual / b.exchanged) : 0.0, meaning,
                        Knob(&sim->state, &b)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The energy of free bodies. The budget is that of the liquid: what they took from it is in the work of the pressure of
   solids that move, and in that of viscosity. */
static PetscErrorCode ReportFree(Sim sim)
{
  PetscReal kinetic = 0, potential = 0;

  PetscFunctionBegin;
  if (!SceneHasFree(sim->scene)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt b = 0; b < SceneSolidCount(sim->scene); b++) {
    const Body solid = SceneSolid(sim->scene, b);
    PetscReal  center[DIM], motion[FREE_MOTIONS];

    if (BodyMass(solid) == 0) continue;
    FreeMotion(solid, center, motion);
    kinetic += FreeKinetic(solid);
    potential += BodyMass(solid) * SceneForcePotential(sim->scene, center);
  }
  PetscCall(PetscPrintf(sim->comm,
                        "  solids      those with a mass: kinetic %.4g, potential %.4g %s, not part of the liquid's "
                        "energy above\n",
                        (double)kinetic, (double)potential, GaugeUnit(sim->domain, "J")));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BudgetReport(Sim sim)
{
  const StepState *state = &sim->state;
  GaugeTotals      totals;

  PetscFunctionBegin;
  PetscCall(GaugesTotals(sim->gauges, &totals));
  PetscCall(
    PetscPrintf(sim->comm,
                "Error budget\n"
                "  density     rms error %.2g inside; volume changed by %+.2g %% since the start, %" PetscInt_FMT
                " particles left through open faces\n"
                "  divergence  rms %.2g a step (times the time step), of which the solver left %.2g\n",
                (double)state->density_error, 100 * (double)(state->start_density / state->density_mean - 1),
                state->lost, (double)state->divergence, (double)state->solver_error));
  if (state->joined + state->split > 0)
    PetscCall(PetscPrintf(sim->comm,
                          "  particles   %" PetscInt_FMT " joined with others, %" PetscInt_FMT
                          " split, which took %.3g %s of kinetic energy\n",
                          state->joined, state->split, (double)(totals.multiplicity * state->resampling_loss),
                          GaugeUnit(sim->domain, "J")));
  PetscCall(ReportEnergy(sim));
  PetscCall(ReportFree(sim));
  PetscFunctionReturn(PETSC_SUCCESS);
}
