/* Gas without density that liquid encloses, as an edge of the step: one unknown pressure for each pocket. */
#include "gas_impl.h"

/* of a constant volume, by which its sum may be wrong: one by stirring was 0.004 of the liquid's */
#define UNKEPT 0.05
#define LOOK   8 /* steps after which pockets are looked for again, at the latest */

static const OptionRow option[] = {
  {"-gas",
   "Gas that liquid, walls and solids enclose (bubbles) has a pressure, p V^exponent constant; else emptiness has that "
   "of the open air everywhere",
   NULL, NULL, ROW_BOOL, offsetof(Gas, on)},
  {.name = NULL},
};

static const OptionRow options[] = {
  {"-gas_pressure", "Pressure of the open air, with -gas", "Pa", "(0, inf)", ROW_REAL, offsetof(Gas, ambient)},
  {"-gas_exponent",
   "Exponent of enclosed gas: 1.4 for quick changes of air, 1 for slow ones; 0: its volume is constant", "1",
   "[0, inf)", ROW_REAL, offsetof(Gas, exponent)},
  {"-gas_pressure_start", "Pressure of the gas that is enclosed at the start; 0: -gas_pressure", "Pa", "[0, inf)",
   ROW_REAL, offsetof(Gas, start)},
  {.name = NULL},
};

static const NumberRow rows[] = {
  {"gas_work", NUMBER_REAL, offsetof(GasNumbers, work), ENERGY_GIVEN, "enclosed gas"},
  {"gas_swept", NUMBER_REAL, offsetof(GasNumbers, swept), ENERGY_NONE, NULL},
  {"gas_power", NUMBER_REAL, offsetof(GasNumbers, power), ENERGY_NONE, NULL},
  {"gas_pressure_change", NUMBER_REAL, offsetof(GasNumbers, change), ENERGY_NONE, NULL},
  {"gas_highest", NUMBER_REAL, offsetof(GasNumbers, highest), ENERGY_NONE, NULL},
  {"gas_enclosed", NUMBER_REAL, offsetof(GasNumbers, enclosed), ENERGY_NONE, NULL},
  {"gas_vented", NUMBER_REAL, offsetof(GasNumbers, vented), ENERGY_NONE, NULL},
  {"gas_lost", NUMBER_REAL, offsetof(GasNumbers, lost), ENERGY_NONE, NULL},
  {"gas_pockets", NUMBER_COUNT, offsetof(GasNumbers, count), ENERGY_NONE, NULL},
  {"gas_known", NUMBER_COUNT, offsetof(GasNumbers, known), ENERGY_NONE, NULL},
  {"gas_idle_steps", NUMBER_COUNT, offsetof(GasNumbers, idle), ENERGY_NONE, NULL},
  {"gas_born", NUMBER_COUNT, offsetof(GasNumbers, born), ENERGY_NONE, NULL},
  {"gas_split", NUMBER_COUNT, offsetof(GasNumbers, split), ENERGY_NONE, NULL},
  {"gas_merged", NUMBER_COUNT, offsetof(GasNumbers, merged), ENERGY_NONE, NULL},
  {"gas_ended", NUMBER_COUNT, offsetof(GasNumbers, ended), ENERGY_NONE, NULL},
  {.name = NULL},
};

static PetscReal *Numbers(Scene scene, void *numbers, PetscInt k, PetscInt *width)
{
  GasNumbers *so_far = (GasNumbers *)numbers;

  *width = POCKET_NUMBERS;
  return k < PetscMin(so_far->count, GAS_MOST) ? (PetscReal *)&so_far->pocket[k] : NULL;
}

static PetscErrorCode Create(const Step *step)
{
  Gas *gas = (Gas *)step->own;

  PetscFunctionBegin;
  gas->cloud    = step->cloud;
  gas->pressure = step->pressure;
  gas->ambient  = 101325;
  gas->exponent = 1.4;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Options(const Step *step)
{
  Gas     *gas  = (Gas *)step->own;
  MPI_Comm comm = gas->cloud->comm;

  PetscFunctionBegin;
  PetscOptionsBegin(comm, NULL, "Enclosed gas", "Gas");
  PetscCall(OptionsRead(PetscOptionsObject, option, __func__, gas));
  PetscCall(OptionsReadIf(PetscOptionsObject, gas->on, "-gas", options, __func__, gas));
  PetscOptionsEnd();
  if (gas->start == 0) gas->start = gas->ambient;
  if (gas->on) PetscCall(PressureAddLowRank(gas->pressure, &GasTerm, gas));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy(const Step *step)
{
  Gas *gas = (Gas *)step->own;

  PetscFunctionBegin;
  PetscCall(GasCellsDestroy(&gas->cells[0]));
  PetscCall(GasCellsDestroy(&gas->cells[1]));
  PetscCall(MatDestroy(&gas->factor));
  PetscCall(PetscFree(gas->row));
  PetscCall(PetscFree(gas->area));
  PetscCall(PetscFree(gas->gap));
  PetscCall(PetscFree(gas->tie));
  PetscCall(PetscFree(gas->matrix));
  PetscCall(PetscFree(gas->loads.load));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool On(const Step *step)
{
  return ((Gas *)step->own)->on;
}

/* The largest difference (Pa) of the pressures at the start to that of the open air. */
static PetscReal Excess(const Gas *gas)
{
  const PetscReal hole = GasHolePressure(gas->cloud->scene, NULL);

  return PetscMax(PetscAbsReal(gas->start - gas->ambient), hole > 0 ? PetscAbsReal(hole - gas->ambient) : 0);
}

/* That of Bernoulli. */
static PetscReal Speed(const Step *step)
{
  const Gas *gas = (Gas *)step->own;

  return gas->on ? PetscSqrtReal(2 * Excess(gas) / BodyMaterial(SceneBody(gas->cloud->scene, 0))->density) : 0;
}

/* Gas at the pressure of the open air gives back what it got. */
static PetscBool Drives(const Step *step)
{
  return (PetscBool)(((Gas *)step->own)->on && Excess((Gas *)step->own) > 0);
}

static PetscErrorCode Freeze(const Step *step, PetscBool frozen)
{
  Gas *gas = (Gas *)step->own;

  PetscFunctionBegin;
  gas->frozen       = frozen;
  gas->before_known = gas->found = PETSC_FALSE;
  gas->before.count              = 0;
  GasForget(gas);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Restore(const Step *step)
{
  PetscFunctionBegin;
  ((Gas *)step->own)->found = PETSC_FALSE;
  GasForget((Gas *)step->own);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After the edges of solids: whether they have moved theirs. */
static PetscErrorCode Drift(const Step *step, PetscReal from, PetscReal to, PetscReal end, PetscBool *moved)
{
  PetscFunctionBegin;
  ((Gas *)step->own)->solids_move = *moved;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Surround(const Step *step)
{
  Gas            *gas  = (Gas *)step->own;
  const PetscBool soon = (PetscBool)(gas->before_known && gas->idle < LOOK - 1); /* since they were looked for */
  PetscBool       kept = PETSC_FALSE;

  PetscFunctionBegin;
  if (gas->before_known && !gas->before.count && (gas->frozen || (gas->open && soon)))
    PetscFunctionReturn(PETSC_SUCCESS);
  if (gas->frozen && gas->found) GasSwap(gas);
  if (gas->before.count && soon && !gas->frozen && !gas->solids_move) PetscCall(GasKeep(gas, &kept));
  if (!kept) PetscCall(GasFind(gas, PETSC_FALSE));
  PetscCall(GasFindRows(gas));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses to go on where gas of constant volume has lost or gained some: without open air its volume is what the liquid
   leaves of the vessel. */
static PetscErrorCode Check(const Step *step, PetscBool ahead, char why[], size_t length)
{
  const Gas *gas    = (Gas *)step->own;
  PetscReal  amount = 0, volume = 0;

  PetscFunctionBegin;
  if (ahead || gas->open || gas->exponent > 0) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 1; k <= gas->before.count; k++) {
    if (PocketIsVoid(&gas->before.pocket[k])) continue;
    amount += gas->before.pocket[k].amount;
    volume += gas->before.pocket[k].tracked;
  }
  if (PetscAbsReal(volume - amount) > UNKEPT * amount)
    PetscCall(PetscSNPrintf(why, length,
                            "the gas of the vessel has %.3g %s and should keep %.3g (-gas_exponent 0): an emitter or a "
                            "solid that moves fills the vessel; gas with a -gas_exponent over 0 gives way, and so does "
                            "an open face",
                            (double)volume, DomainUnit(gas->cloud->domain, "m3"), (double)amount));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* That of the pocket at x, by the cells of the last step. */
static PetscReal Beside(const Step *step, const PetscReal x[DIM])
{
  const Gas      *gas     = (Gas *)step->own;
  const GasCells *cells   = gas->before.cells;
  PetscInt        at[DIM] = {0, 0, 0}, node, owner;

  if (!gas->before.count) return 0;
  for (PetscInt d = 0; d < gas->cloud->domain->dim; d++)
    at[d] = PetscMax(0, PetscMin(cells->n[d] - 1, (PetscInt)((x[d] - cells->lower[d]) * cells->many[d])));
  node = GasCellsNode(cells, at[0], at[1], at[2]);
  if (node < 0) return 0;
  owner = node < cells->near * cells->per ? cells->owner[node] : cells->label[node];
  return owner > GAS_AIR ? gas->before.pocket[owner].pressure : 0;
}

static PetscErrorCode Doubt(const Step *step, char text[], size_t length)
{
  Gas *gas = (Gas *)step->own;

  PetscFunctionBegin;
  if (!gas->crowded) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(
    PetscSNPrintf(text, length,
                  "there are more than %d pockets of gas, the most that are computed: the others, the smallest, "
                  "have no gas and collapse; a larger -spacing has fewer",
                  GAS_MOST));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The pockets that were found become those of the step, and of the state; counted: so do their changes. */
static void Keep(Gas *gas, PetscBool counted, GasNumbers *so_far)
{
  if (counted) {
    so_far->enclosed += gas->enclosed;
    so_far->vented += gas->vented;
    so_far->lost += gas->lost;
    so_far->born += gas->born;
    so_far->split += gas->split;
    so_far->merged += gas->merged;
    so_far->ended += gas->ended;
  }
  GasSwap(gas);
  GasForget(gas);
  so_far->count = gas->before.count;
  so_far->known = gas->before_known;
  for (PetscInt k = 0; k < so_far->count; k++) so_far->pocket[k] = gas->before.pocket[k + 1];
}

/* as that of a body force, FORCE_LIMIT of stepper/consistent.c; without a bound a plug of water between two pockets
   loses 15 % of its swing in a period */
#define JOLT 0.25
/* of the change, that is left after a step: steps that follow a swing of the gas, short halfway and long at its ends,
   feed it; that plug gains 6 % of its swing in a period with 0, 2 % with 0.9, none with this */
#define FORGOTTEN 0.95

/* The change of a pocket's pressure in a step is a force on the layer of a smoothing length beside it, dp/dt dt/(rho
   h), which bounds the step as a body force does. */
static void Bound(const Step *step, PetscReal scale, StepBound *bound)
{
  const Gas      *gas = (const Gas *)step->own;
  const PetscReal h   = scale * KernelSmoothingLength(step->cloud->kernel),
                  m   = BodyMaterial(SceneBody(step->scene, 0))->density * h;

  bound->name  = "gas";
  bound->cause = "changes of the gas's pressure";
  bound->lift  = "a larger -spacing";
  if (gas->change > 0) bound->step = PetscPowReal(JOLT * JOLT * h * m / gas->change, 1.0 / 3);
}

static PetscErrorCode Commit(const Step *step, StepState *state)
{
  Gas        *gas    = (Gas *)step->own;
  GasNumbers *so_far = (GasNumbers *)StepNumbers(step, state);
  PetscReal   power  = 0;

  PetscFunctionBegin;
  if (gas->frozen) PetscFunctionReturn(PETSC_SUCCESS);
  gas->idle = so_far->idle = gas->found && !gas->same ? 0 : gas->idle + 1;
  if (!gas->found) PetscFunctionReturn(PETSC_SUCCESS);
  so_far->change *= FORGOTTEN;
  for (PetscInt k = 1; k <= gas->now.count && gas->solved; k++) {
    const PetscReal P = gas->now.pocket[k].pressure;

    if (!PocketIsVoid(&gas->now.pocket[k]))
      so_far->change = PetscMax(so_far->change, PetscAbsReal(P - gas->kept[k]) / state->time_step);

    so_far->swept += 0.5 * state->time_step * gas->old[k] * (P + gas->kept[k]);
    power += P * gas->old[k];
    so_far->highest = PetscMax(so_far->highest, P);
  }
  so_far->swept += gas->unseen;
  /* swept: to the start of the step; in its second half the power goes on as it did */
  so_far->work  = so_far->swept + 0.5 * state->time_step * (2 * power - so_far->power);
  so_far->power = power;
  gas->change   = so_far->change;
  Keep(gas, PETSC_TRUE, so_far);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The pocket of the state that is nearest to each that was found: the same one, unless regions have changed since the
   last step. */
static void Recognise(Gas *gas, const GasNumbers *so_far)
{
  for (PetscInt k = 1; k <= gas->now.count; k++) {
    Pocket   *pocket = &gas->now.pocket[k];
    PetscReal least  = PETSC_MAX_REAL;
    PetscInt  found  = -1;

    for (PetscInt b = 0; b < so_far->count; b++) {
      PetscReal r[DIM];

      for (PetscInt d = 0; d < DIM; d++) r[d] = pocket->center[d] - so_far->pocket[b].center[d];
      DomainNearest(gas->cloud->domain, r);
      if (Norm(r) >= least) continue;
      least = Norm(r);
      found = b;
    }
    if (found < 0) continue;
    pocket->amount   = so_far->pocket[found].amount;
    pocket->tracked  = so_far->pocket[found].tracked;
    pocket->pressure = so_far->pocket[found].pressure;
  }
}

static PetscErrorCode Renew(const Step *step, PetscBool resumed, StepState *state)
{
  Gas        *gas    = (Gas *)step->own;
  GasNumbers *so_far = (GasNumbers *)StepNumbers(step, state);

  PetscFunctionBegin;
  if (!so_far->known) PetscFunctionReturn(PETSC_SUCCESS);
  gas->idle    = so_far->idle;
  gas->change  = so_far->change;
  gas->resumed = resumed ? so_far->count : 0;
  PetscCall(GasFind(gas, PETSC_TRUE));
  gas->resumed = 0;
  if (resumed) Recognise(gas, so_far);
  Keep(gas, (PetscBool)!resumed, so_far);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Report(Scene scene, const void *numbers, PetscReal copies, const char joule[], char text[],
                             size_t length)
{
  const GasNumbers *so_far = (const GasNumbers *)numbers;
  const char       *unit   = DomainUnit(SceneDomain(scene), "m3");

  PetscFunctionBegin;
  if (so_far->known)
    PetscCall(PetscSNPrintf(text, length,
                            "  gas         %" PetscInt_FMT " pockets; so far %" PetscInt_FMT " enclosed, %" PetscInt_FMT
                            " split, %" PetscInt_FMT " merged, %" PetscInt_FMT
                            " opened or filled; largest pressure %.4g Pa; work %.4g %s\n"
                            "              enclosed %.4g %s, of which %.4g opened, %.4g was in regions too small for "
                            "a pocket and is lost\n",
                            so_far->count, so_far->born, so_far->split, so_far->merged, so_far->ended,
                            (double)so_far->highest, (double)(copies * so_far->work), joule,
                            (double)(copies * so_far->enclosed), unit, (double)(copies * so_far->vented),
                            (double)(copies * so_far->lost)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define HOLE "-<hole>_pressure"

static PetscBool HasHole(Scene scene, Tension tension)
{
  return (PetscBool)(scene && GasHolePressure(scene, NULL) > 0);
}

static const Feature features[] = {{HOLE, HasHole}, {.name = NULL}};

#define DIRECT ": the gas's part of the pressure equation is not in the preconditioner; -ksp_type cg can"
static const Refusal refusals[] = {{HOLE, NEEDS_GIVEN, "-gas", ""},
                                   {"-gas", NEEDS, FEATURE_CONSISTENT, ", the default"},
                                   {"-gas", NEEDS, FEATURE_CENTERED, ", the default"},
                                   {"-gas", NEEDS, FEATURE_DIVERGENCE, ", the default"},
                                   {"-gas", NOT_WITH, "-interface_tension", " yet"},
                                   {"-ksp_type preonly", NOT_WITH, "-gas", DIRECT},
                                   {"-ksp_type none", NOT_WITH, "-gas", DIRECT},
                                   {"-gas", NOT_WITH, FEATURE_DENSITIES, " yet"},
                                   {.one = NULL}};

const Edge GasEdge = {.name        = "gas",
                      .features    = features,
                      .properties  = GasProperties,
                      .gauge       = &GaugePockets,
                      .refusals    = refusals,
                      .data_size   = sizeof(Gas),
                      .number_size = sizeof(GasNumbers),
                      .numbers     = rows,
                      .table  = {"gas_pocket_table", "of each pocket: amount, tracked volume, pressure, volume, centre",
                                 Numbers},
                      .create = Create,
                      .destroy  = Destroy,
                      .on       = On,
                      .drives   = Drives,
                      .speed    = Speed,
                      .options  = Options,
                      .report   = Report,
                      .freeze   = Freeze,
                      .restore  = Restore,
                      .drift    = Drift,
                      .surround = Surround,
                      .check    = Check,
                      .bound    = Bound,
                      .beside   = Beside,
                      .doubt    = Doubt,
                      .commit   = Commit,
                      .renew    = Renew};
