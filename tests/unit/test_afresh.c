/* What gauges say of a step after which the particles have another order, because some left, joined, split, were
   brought by an emitter or went to another rank, is what they say of the same state measured afresh, as from a
   checkpoint. Runs on any number of ranks. */
#include "../../src/sim/sim_impl.h"
#include "check.h"
#include "columns.h"

#define COLUMNS_MOST 64
#define COMMON                                                                                                         \
  " -gauge_forces -gauge_droplets -ksp_rtol 1e-8 -packing_cache '' -output_overwrite -output_dir output/test_afresh "
/* A wave of water leaves through an open face of a tank whose floor and obstacle feel its force. */
#define LEAVES                                                                                                         \
  "-dimension 2 -spacing 0.05 -box_lower 0,0 -box_upper 2,1 -box_xmin wall -box_ymin wall -gravity 0,-9.81 -bodies "   \
  "film -film_lower 1.2,0 -film_upper 1.9,0.5 -film_velocity 2,0 -film_tension 1 -solids post -post_lower 0.9,0 "      \
  "-post_upper 1.1,0.2 -gauge_heights 1.5 -gauge_points 1.6,0.1"
/* Two rings of liquid that join and split, over a floor; the axis is a crater's. */
#define RESAMPLED                                                                                                      \
  "-dimension axisymmetric -spacing 1e-3 -box_lower 0,-10e-3 -box_upper 30e-3,12e-3 -box_ymin wall -gravity 0,-9.81 "  \
  "-bodies pool,a,b -a_shape sphere -a_radius 2.6e-3 -a_center 4e-3,0 -a_velocity 3,0 -a_tension 0.067 -b_shape "      \
  "sphere -b_radius 2.6e-3 -b_center 16e-3,7e-3 -b_velocity -3,-2 -b_tension 0.067 -pool_lower 0,-10e-3 -pool_upper "  \
  "30e-3,-6e-3 -pool_tension 0.067 -time_step 4e-5 -gauge_crater"
/* A jet onto an inclined plate. */
#define EMITTED                                                                                                        \
  "-dimension 2 -spacing 0.1 -box_lower -2,-2 -box_upper 2,2 -bodies jet -jet_type emitter -jet_lower -0.3,0.6 "       \
  "-jet_upper 0.3,0.8 -jet_velocity 0,-1 -jet_tension 1 -solids plate -plate_shape half_space -plate_normal 0.5,1 "    \
  "-plate_point 0,0 -gauge_points 0,0.3"

typedef struct {
  GaugeTotals totals;
  PetscReal   columns[COLUMNS_MOST];
} Values;

static PetscErrorCode Measure(Sim sim, Values *v)
{
  PetscFunctionBegin;
  PetscCall(PetscMemzero(v, sizeof(*v)));
  PetscCall(GaugesMeasure(sim->gauges, v->columns)); /* first: it measures the level */
  PetscCall(GaugesTotals(sim->gauges, &v->totals));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The difference of two numbers over the larger of them and a scale; two that are not numbers do not differ. */
static PetscReal Apart(PetscReal a, PetscReal b, PetscReal scale)
{
  if (a != a && b != b) return 0;
  return PetscAbsReal(a - b) / PetscMax(scale, PetscMax(PetscAbsReal(a), PetscAbsReal(b)));
}

static PetscErrorCode Compare(Sim sim, const Values *a, const Values *b, PetscReal *apart)
{
  const PetscInt n       = ColumnCount(sim->gauges);
  PetscReal      largest = 0;

  PetscFunctionBegin;
  *apart = PetscMax(Apart(a->totals.kinetic_energy, b->totals.kinetic_energy, 0),
                    PetscMax(Apart(a->totals.potential_energy, b->totals.potential_energy, 0),
                             PetscMax(Apart(a->totals.volume, b->totals.volume, 0),
                                      Apart(a->totals.highest, b->totals.highest, sim->domain->spacing))));
  for (PetscInt k = 0; k < n; k++) largest = PetscMax(largest, PetscAbsReal(a->columns[k]));
  for (PetscInt k = 0; k < n; k++) {
    char name[64];

    PetscCall(ColumnHead(sim->gauges, k, name, sizeof(name)));
    *apart = PetscMax(*apart, Apart(a->columns[k], b->columns[k], 0.01 * largest));
    if (!strncmp(name, "force_", 6) && !(PetscAbsReal(a->columns[k]) < PETSC_MAX_REAL)) *apart = 1;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Runs so many steps; of those that change the order of particles the largest difference, and how many there were. */
static PetscErrorCode Run(const char options[], PetscInt steps, const char name[])
{
  Sim       sim;
  PetscBool stop, failed = PETSC_FALSE;
  PetscInt  changed = 0;
  PetscReal worst   = 0;
  char      text[256], why[256];
  Values    first, second;

  PetscFunctionBegin;
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscOptionsInsertString(NULL, options));
  PetscCall(PetscOptionsInsertString(NULL, COMMON "-time_end 1e3 -progress_interval 0"));
  PetscCall(SimCreate(PETSC_COMM_WORLD, &sim));
  PetscCall(SimSetFromOptions(sim, &stop));
  PetscCall(SimSetUp(sim));
  CHECK(ColumnCount(sim->gauges) <= COLUMNS_MOST, "columns_fit");
  PetscCall(StepperMeasure(sim->stepper, &sim->state)); /* sums of neighbours, but no tension */
  PetscCall(Measure(sim, &first));
  PetscCall(CloudResync(sim->cloud));
  PetscCall(Measure(sim, &second));
  PetscCall(Compare(sim, &first, &second, &worst));
  PetscCall(PetscSNPrintf(text, sizeof(text), "%s_at_the_start", name));
  CHECK_CLOSE(worst, 0, 1e-9, text);
  for (PetscInt k = 0; k < steps && !failed; k++) {
    PetscInt before;
    Values   now, afresh;

    PetscCall(CloudBegin(sim->cloud)); /* the step's own finds nothing left to do */
    before = sim->cloud->layout;
    PetscCall(StepperAdvance(sim->stepper, 1e3, PETSC_TRUE, &sim->state, &failed, why, sizeof(why)));
    PetscCall(StepperBring(sim->stepper, sim->packing, sim->gauges, PETSC_FALSE, &sim->state));
    if (sim->cloud->layout == before) continue;
    changed++;
    PetscCall(Measure(sim, &now));
    PetscCall(CloudResync(sim->cloud));
    PetscCall(Measure(sim, &afresh));
    PetscCall(Compare(sim, &now, &afresh, &worst));
    if (worst > 1e-9) break;
  }
  PetscCall(PetscSNPrintf(text, sizeof(text), "%s_runs", name));
  CHECK(!failed && changed > 3, text);
  PetscCall(PetscSNPrintf(text, sizeof(text), "%s_is_measured_as_afresh", name));
  CHECK_CLOSE(worst, 0, 1e-9, text);
  PetscCall(SimDestroy(&sim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(Run(LEAVES, 120, "liquid_that_leaves"));
  PetscCall(Run(RESAMPLED, 60, "liquid_that_joins_and_splits"));
  PetscCall(Run(EMITTED, 120, "liquid_that_is_emitted"));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
