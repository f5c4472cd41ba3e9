/* The error budget at the end of a run: what the numbers cannot hide, and which knob to turn first. */
#include "sim_impl.h"

#define SOLVER_SHARE  0.3  /* of the divergence that steps leave: the solver's tolerance shows */
#define ENERGY_SHARE  0.01 /* of the energy exchanged that may be missing or appear */
#define SOLVER_FINE   1e-5 /* rms density error that a solver may leave in a step in any case */
#define DENSITY_FINE  1e-3 /* rms density error that needs no remedy */
#define TENSION_SHARE 0.4  /* by which the measured work of surface tension may be wrong at R/d0 = 8 */

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
  sim->state.start_energy  = Energy(&totals);
  sim->state.start_density = sim->state.density_mean;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The knob that the measured shares point to. The solver and the step show in the divergence that a step leaves, the
   spacing in the density that the particles have in spite of it, and in the energy that disappears. */
static const char *Knob(const StepState *state, PetscReal residual, PetscReal doubt)
{
  if (state->solver_error > PetscMax(SOLVER_FINE, SOLVER_SHARE * state->divergence))
    return "the solver's tolerance: a smaller -pressure_density_tolerance or -ksp_rtol";
  if (residual > doubt) return "the time step, energy grows: a smaller -time_cfl";
  if (state->divergence > state->density_error) return "the time step: a smaller -time_cfl";
  if (residual < -doubt) return "the particle spacing, energy is lost: a smaller -spacing";
  if (state->density_error > DENSITY_FINE) return "the particle spacing: a smaller -spacing";
  return "nothing: every share is small";
}

PetscErrorCode BudgetReport(Sim sim)
{
  const StepState *state  = &sim->state;
  const char      *joule  = GaugeUnit(sim->domain, "J");
  const PetscBool  moving = SceneSolidsMove(sim->scene);
  GaugeTotals      totals;
  PetscReal        viscous, tension, gain, residual, exchanged;

  PetscFunctionBegin;
  PetscCall(GaugesTotals(sim->gauges, &totals));
  viscous   = totals.multiplicity * state->viscous_work;
  tension   = totals.multiplicity * state->tension_work;
  gain      = Energy(&totals) - state->start_energy;
  residual  = gain - viscous - tension + totals.multiplicity * state->resampling_loss;
  exchanged = totals.kinetic_energy + PetscAbsReal(viscous) + PetscAbsReal(tension) + PetscAbsReal(gain);
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
                          state->joined, state->split, (double)(totals.multiplicity * state->resampling_loss), joule));
  PetscCall(
    PetscPrintf(sim->comm,
                "  energy      kinetic %.4g, potential %.4g, together %+.4g %s since the start; viscosity gave "
                "%.4g, tension %.4g\n"
                "              residual %+.3g %s, %+.2g %% of what was exchanged%s\n"
                "  dominant    %s\n",
                (double)totals.kinetic_energy, (double)totals.potential_energy, (double)gain, joule, (double)viscous,
                (double)tension, (double)residual, joule, exchanged > 0 ? 100 * (double)(residual / exchanged) : 0.0,
                moving ? ", the work of solids that move included" : "",
                Knob(state, moving ? 0 : residual, ENERGY_SHARE * exchanged + TENSION_SHARE * PetscAbsReal(tension))));
  PetscFunctionReturn(PETSC_SUCCESS);
}
