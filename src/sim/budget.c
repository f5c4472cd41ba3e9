/* The error budget at the end of a run: the errors that can be measured, and the option that reduces the largest. */
#include "sim_impl.h"

#define SOLVER_SHARE  0.3  /* of the divergence after a step: above it the solver's error dominates */
#define ENERGY_SHARE  0.01 /* of the energy exchanged: a smaller residual is no error */
#define SOLVER_FINE   1e-5 /* rms density error of the solver in a step that needs no remedy */
#define DENSITY_FINE  1e-3 /* rms density error that needs no remedy */
#define TENSION_SHARE 0.4  /* relative error of the measured work of surface tension at R/d0 = 8 */
#define ROW_SHARE     0.01 /* of a spacing, to which the height of the liquid is known: tanks at rest 0.003 to 0.006 */
#define LINE_LENGTH   512

/* Of the whole scene (J). */
static PetscReal Energy(const GaugeTotals *totals)
{
  return totals->multiplicity * (totals->kinetic_energy + totals->potential_energy);
}

PetscErrorCode BudgetStart(Sim sim)
{
  GaugeTotals totals;

  PetscFunctionBegin;
  PetscCall(StepperMeasure(sim->stepper, &sim->state));
  PetscCall(GaugesTotals(sim->gauges, &totals));
  sim->state.start_energy   = Energy(&totals);
  sim->state.start_density  = sim->state.density_mean;
  sim->state.start_surface  = sim->state.surface_energy;
  sim->state.kinetic_energy = totals.kinetic_energy;
  sim->state.kinetic_most   = totals.kinetic_energy;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BudgetChanged(Sim sim, const GaugeTotals *before)
{
  GaugeTotals totals;

  PetscFunctionBegin;
  PetscCall(StepperMeasure(sim->stepper, &sim->state));
  PetscCall(GaugesTotals(sim->gauges, &totals));
  sim->state.given_energy += (Energy(&totals) - Energy(before)) / totals.multiplicity;
  sim->state.kinetic_energy = totals.kinetic_energy;
  sim->state.kinetic_most   = PetscMax(sim->state.kinetic_most, totals.kinetic_energy);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BudgetKeep(Sim sim)
{
  GaugeTotals totals;

  PetscFunctionBegin;
  PetscCall(GaugesTotals(sim->gauges, &totals));
  sim->state.potential_energy = totals.potential_energy;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal LargestDensity(Scene scene)
{
  PetscReal density = 0;

  for (PetscInt b = 0; b < SceneCount(scene); b++)
    density = PetscMax(density, BodyMaterial(SceneBody(scene, b))->density);
  return density;
}

/* The energy (J) that lifts the liquid by a spacing. */
static PetscReal RowLift(Sim sim, const GaugeTotals *totals)
{
  const Domain    domain      = sim->domain;
  const PetscReal middle[DIM] = {0.5 * (domain->lower[0] + domain->upper[0]),
                                 0.5 * (domain->lower[1] + domain->upper[1]),
                                 0.5 * (domain->lower[2] + domain->upper[2])};
  PetscReal       g[DIM];

  SceneAcceleration(sim->scene, middle, g);
  return totals->multiplicity * totals->volume * LargestDensity(sim->scene) * Norm(g) * domain->spacing;
}

PetscErrorCode BudgetRestart(Sim sim)
{
  const PetscReal kept = sim->state.potential_energy;
  GaugeTotals     totals;

  PetscFunctionBegin;
  PetscCall(GaugesTotals(sim->gauges, &totals));
  if (PetscAbsReal(totals.potential_energy - kept) >
      PETSC_SQRT_MACHINE_EPSILON * (PetscAbsReal(kept) + RowLift(sim, &totals)))
    sim->state.given_energy += totals.potential_energy - kept;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The energy (J) that lifted the liquid from the lowest corner of the box. An error of the volume changes the measured
   energy by the same fraction of it. */
static PetscReal Lift(Sim sim, const GaugeTotals *totals)
{
  const Domain    domain  = sim->domain;
  const PetscReal density = LargestDensity(sim->scene);
  PetscReal       least   = PETSC_MAX_REAL;

  for (PetscInt corner = 0; corner < 1 << DIM; corner++) {
    PetscReal x[DIM] = {0, 0, 0};

    for (PetscInt d = 0; d < domain->dim; d++) x[d] = corner >> d & 1 ? domain->upper[d] : domain->lower[d];
    least = PetscMin(least, SceneForcePotential(sim->scene, x));
  }
  return totals->multiplicity * PetscAbsReal(totals->potential_energy - totals->volume * density * least);
}

/* The energy (J) of liquid that goes the support of the kernel times the density error in the time of its correction:
   what moves thus is no flow, and without gravity and speeds it is all that moves. */
static PetscReal Settling(Sim sim, const GaugeTotals *totals)
{
  const PetscReal error = PetscMax(sim->state.density_error, SOLVER_FINE),
                  speed = error * KernelSupport(sim->cloud->kernel) / PressureRelaxationTime(sim->pressure);

  return 0.5 * totals->multiplicity * totals->volume * LargestDensity(sim->scene) * PetscSqr(speed);
}

/* The energy balance of a run, in J. gain: of the liquid's energy since the start. residual: the part of it that no
   work explains. stored: the same, if the surface's energy is that of its area; the measured work of tension and this
   area differ by tens of per cent where drops are coarse, so energy has appeared if both say so. */
typedef struct {
  GaugeTotals totals;
  PetscReal   viscous, friction, tension, gain, residual, stored;
  PetscReal   exchanged; /* energy that changed its form or crossed the boundary */
  PetscReal   scale;     /* of the residual: this, or the largest kinetic energy */
  PetscReal   doubt;     /* uncertainty of the residual */
} Balance;

static PetscErrorCode BalanceTake(Sim sim, Balance *b)
{
  const StepState *state = &sim->state;
  PetscReal        outside, much;

  PetscFunctionBegin;
  PetscCall(GaugesTotals(sim->gauges, &b->totals));
  much         = b->totals.multiplicity;
  b->friction  = much * state->friction_work;
  b->viscous   = much * state->viscous_work - b->friction;
  b->tension   = much * state->tension_work;
  outside      = much * StepperOutsideWork(state);
  b->gain      = Energy(&b->totals) - state->start_energy;
  b->residual  = b->gain - b->viscous - b->friction - b->tension - outside + much * StepperEnergy(state, ENERGY_LOST);
  b->stored    = b->residual + b->tension + much * (state->surface_energy - state->start_surface);
  b->exchanged = much * PetscMax(state->given + StepperEnergy(state, ENERGY_BROUGHT),
                                 state->taken + PetscAbsReal(StepperEnergy(state, ENERGY_TAKEN)));
  b->scale     = PetscMax(b->exchanged, much * state->kinetic_most);
  b->doubt     = ENERGY_SHARE * b->exchanged + TENSION_SHARE * much * state->tension_swing +
             PetscAbsReal(state->start_density / state->density_mean - 1) * Lift(sim, &b->totals) +
             ROW_SHARE * RowLift(sim, &b->totals) + Settling(sim, &b->totals);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The dominant error, where a run with half of what is named has shown half of the residual: the solver's tolerance and
   the spacing, in tests/solvers/tolerance.py. Where liquid comes in and leaves the solver leaves 0.2 of the density
   error, which is no cause: a thousandth of it is the same residual of a tank that drains. Energy that grows has no
   known cause: in a dam break of 25 spacings shorter steps add more of it, and a channel between an emitter and an
   outlet has 0.3, -0.2 and -0.1 % at three spacings. */
static const char *Dominant(const StepState *state, const Balance *b)
{
  const PetscBool open =
    (PetscBool)(StepperEnergy(state, ENERGY_BROUGHT) != 0 || StepperEnergy(state, ENERGY_TAKEN) != 0);
  const PetscBool grows = (PetscBool)(PetscMin(b->residual, b->stored) > b->doubt),
                  lost  = (PetscBool)(b->residual < -b->doubt);

  if (state->solver_error > PetscMax(SOLVER_FINE, SOLVER_SHARE * state->divergence) &&
      (state->solver_error > state->density_error || (!open && (grows || lost))))
    return "the solver's tolerance; reduce -pressure_density_tolerance or -ksp_rtol";
  if (grows) return "not known (energy grows); neither -spacing nor -time_cfl is sure to reduce it";
  if (lost) return "the particle spacing (energy is lost); reduce -spacing";
  if (state->density_error > DENSITY_FINE) return "the particle spacing; reduce -spacing";
  return "none, all errors are small";
}

/* Lists the energies that boundaries and sources gave: ", the pressure of solids that move 4.1, ..." */
static PetscErrorCode Outside(Sim sim, PetscReal multiplicity, char text[], size_t length)
{
  Number number;
  char   part[128];

  PetscFunctionBegin;
  text[0] = 0;
  for (PetscInt k = 0; StateNumber(&sim->state, k, &number); k++) {
    const NumberRow *row   = number.row;
    const PetscReal  value = row->part != ENERGY_NONE && row->part != ENERGY_LOST ? *(PetscReal *)number.at : 0;

    if (value == 0) continue;
    PetscCall(PetscSNPrintf(part, sizeof(part), ", %s %.4g", row->source,
                            (double)(multiplicity * (row->part == ENERGY_TAKEN ? -value : value))));
    TextAppend(text, length, part);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the residual means. An impact on liquid or a wall loses up to 1/sqrt(N) of the energy with N spacings across a
   drop: 17 and 10 % in the main case with N = 8 and 16, 25 and 21 % in the same impact in two dimensions with N = 10
   and 20. */
static PetscErrorCode Meaning(Sim sim, const Balance *b, char text[], size_t length)
{
  const Scene     scene = sim->scene;
  const PetscReal share = b->scale > 0 ? b->residual / b->scale : 0;
  PetscReal       least = PETSC_MAX_REAL, normal;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < SceneCount(scene); k++) {
    BodyScales scales;

    SceneBodyScales(scene, k, &scales);
    least = PetscMin(least, scales.length / sim->domain->spacing);
  }
  normal = PetscMin(1, 1 / PetscSqrtReal(PetscMax(1, least)));
  if (PetscMin(PetscAbsReal(b->residual), b->residual > 0 ? b->stored : PETSC_MAX_REAL) <= b->doubt)
    PetscCall(PetscSNPrintf(text, length, "within the error of its measurement, %.2g %s",
                            (double)PetscMax(b->doubt, b->residual - PetscMax(0, b->stored)),
                            DomainUnit(sim->domain, "J")));
  else if (share > 0)
    PetscCall(PetscSNPrintf(text, length, "energy has grown, which no flow does"));
  else
    PetscCall(PetscSNPrintf(
      text, length,
      "%s one impact loses with %.0f spacings across the smallest body, %.0f %%; a period of waves loses a few %%",
      -share <= normal ? "no more than" : "more than", (double)least, (double)(100 * normal)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReportEnergy(Sim sim)
{
  const char *joule = DomainUnit(sim->domain, "J");
  Balance     b;
  char        outside[LINE_LENGTH], meaning[LINE_LENGTH], share[LINE_LENGTH] = "";

  PetscFunctionBegin;
  PetscCall(BalanceTake(sim, &b));
  PetscCall(Outside(sim, b.totals.multiplicity, outside, sizeof(outside)));
  PetscCall(Meaning(sim, &b, meaning, sizeof(meaning)));
  if (b.scale > b.doubt) /* else it is a share of nothing */
    PetscCall(PetscSNPrintf(share, sizeof(share), ", %+.3g %% of the %s", 100 * (double)(b.residual / b.scale),
                            b.scale > b.exchanged ? "largest kinetic energy" : "energy exchanged"));
  PetscCall(PetscPrintf(sim->comm,
                        "  energy      kinetic %.4g, potential %.4g, together %+.4g %s since the start\n"
                        "              viscosity gave %.4g, tension %.4g%s\n"
                        "              residual %+.3g %s%s: %s\n"
                        "  dominant    %s\n",
                        (double)(b.totals.multiplicity * b.totals.kinetic_energy),
                        (double)(b.totals.multiplicity * b.totals.potential_energy), (double)b.gain, joule,
                        (double)b.viscous, (double)b.tension, outside, (double)b.residual, joule, share, meaning,
                        Dominant(&sim->state, &b)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode BudgetReport(Sim sim)
{
  const StepState *state = &sim->state;
  GaugeTotals      totals;
  char             text[LINE_LENGTH];

  PetscFunctionBegin;
  PetscCall(GaugesTotals(sim->gauges, &totals));
  PetscCall(
    PetscPrintf(sim->comm,
                "Error budget\n"
                "  density     rms error %.2g inside; volume changed by %+.2g %% since the start, %" PetscInt_FMT
                " particles left through open faces\n",
                (double)state->density_error, 100 * (double)(state->start_density / state->density_mean - 1),
                state->lost));
  if (!PetscIsInfOrNanReal(state->divergence)) /* a signal may end a run after a step that did not measure it */
    PetscCall(PetscPrintf(sim->comm,
                          "  divergence  rms %.2g a step (times the time step), of which the solver left %.2g\n",
                          (double)state->divergence, (double)state->solver_error));
  PetscCall(StepperReport(sim->scene, state, totals.multiplicity, DomainUnit(sim->domain, "J"), text, sizeof(text)));
  PetscCall(PetscPrintf(sim->comm, "%s", text));
  PetscCall(ReportEnergy(sim));
  PetscFunctionReturn(PETSC_SUCCESS);
}
