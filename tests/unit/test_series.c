/* What a run writes, number by number: each column of the series from a state of which all entries differ, a snapshot
   of a part of the box, the energies of the budget. Runs on any number of ranks. */
#include "../../src/sim/sim_impl.h"
#include "../../src/storage/storage.h"
#include "lattice.h"

#define FOLDER "output/test_series"
#define COPIES 3.
#define G      9.81
#define RHO    1100.
#define NUMBER 72 /* particles: 12 a layer, six layers, which move up with 2 m/s */
#define OPTIONS                                                                                                        \
  "-dimension 2 -box_lower 0,0,0 -box_upper 6e-3,6e-3,0 -spacing 0.5e-3 -bodies film -film_shape box -film_lower "     \
  "0,0,-1 -film_upper 1,3e-3,1 -film_density 1100 -gravity 0,-9.81 -output_overwrite -output_dir " FOLDER              \
  " -gauge_multiplicity 3 "

static int Low(PetscReal r, PetscReal z)
{
  return z < 3e-3;
}

static StepState state = {.time           = 0.125,
                          .time_step      = 2e-3,
                          .pressure_time  = 0.124,
                          .step           = 41,
                          .iterations     = 17,
                          .density_error  = 0.011,
                          .divergence     = 0.012,
                          .solver_error   = 0.013,
                          .density_mean   = 0.99,
                          .surface_energy = 0.021,
                          .viscous_work   = -0.022,
                          .tension_work   = 0.023,
                          .solid_work     = 0.1,
                          .friction_work  = 0.005,
                          .given          = 0.3,
                          .taken          = 0.2,
                          .drive_work     = 0.02,
                          .outflow_energy = 0.0004,
                          .start_energy   = 0.5,
                          .start_density  = 0.98,
                          .rejected       = 5,
                          .lost           = 7};

/* m g z and m v^2/2 of all, copies included; J/m. */
static const PetscReal kinetic   = COPIES * NUMBER * RHO * D0 * D0 * 0.5 * 4,
                       potential = COPIES * NUMBER * RHO * D0 * D0 * G * 1.5e-3;

/* --- series --- */

/* The number in the column of this name in the last line of the series; not a number if there is none. */
static PetscReal Written(const char name[])
{
  FILE     *file       = fopen(FOLDER "/series.csv", "r");
  char      head[8192] = "", line[8192] = "", *next, *place;
  PetscReal value = NAN;

  if (!file || !fgets(head, sizeof(head), file)) return NAN;
  while (fgets(line, sizeof(line), file))
    ;
  (void)fclose(file);
  head[strcspn(head, "\n")] = 0;
  place                     = line;
  for (char *word = strtok_r(head, ",", &next); word; word = strtok_r(NULL, ",", &next)) {
    if (!strcmp(word, name)) value = atof(place);
    place += strcspn(place, ",\n") + 1;
  }
  return value;
}

static PetscErrorCode TestSeries(void)
{
  const struct {
    const char *name;
    PetscReal   value;
  } columns[] = {{"time_s", 0.125},
                 {"step", 41},
                 {"time_step_s", 2e-3},
                 {"pressure_time_s", 0.124},
                 {"kinetic_energy_J/m", kinetic},
                 {"iterations", 17},
                 {"highest_m", 3e-3},
                 {"potential_energy_J/m", potential},
                 {"volume_m2", COPIES * NUMBER * D0 * D0},
                 {"density_error", 0.011},
                 {"divergence", 0.012},
                 {"solver_error", 0.013},
                 {"surface_energy_J/m", COPIES * 0.021},
                 {"viscous_work_J/m", COPIES * -0.022},
                 {"tension_work_J/m", COPIES * 0.023},
                 {"outside_work_J/m", COPIES * 0.1226},
                 {"particles", NUMBER},
                 {"lost", 7},
                 {"rejected", 5},
                 {"point_1_pressure_Pa", 0},
                 {"point_1_velocity_y_m/s", 2}};
  PetscMPIInt rank;
  Run         run;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(RunCreate(OPTIONS "-gauge_points 3e-3,1.5e-3", &run));
  PetscCall(Fill(&run, Low, 0));
  PetscCall(OutputSetUp(run.output, NULL, &(StepState){0}));
  PetscCall(OutputStep(run.output, &state, PETSC_TRUE));
  PetscCall(RunDestroy(&run));
  if (!rank)
    for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(columns); k++)
      CHECK_CLOSE(Written(columns[k].name), columns[k].value, 1e-9 * (1 + PetscAbsReal(columns[k].value)),
                  columns[k].name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- snapshots --- */

/* Reads a data set of the first snapshot as real numbers; returns how many there are. */
static hsize_t Read(const char name[], PetscReal values[], hsize_t most)
{
  const hid_t file = H5Fopen(FOLDER "/snapshot_000000.h5", H5F_ACC_RDONLY, H5P_DEFAULT),
              set  = H5Lexists(file, name, H5P_DEFAULT) > 0 ? H5Dopen2(file, name, H5P_DEFAULT) : -1;
  hsize_t count    = 0;

  if (set >= 0) {
    const hid_t space = H5Dget_space(set);

    count = (hsize_t)H5Sget_simple_extent_npoints(space);
    if (count <= most) (void)H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    (void)H5Sclose(space);
    (void)H5Dclose(set);
  }
  (void)H5Fclose(file);
  return count;
}

/* A part of the film on the right, six columns and three layers, in double precision: their positions, and what Fill
   gives a particle, a density of 1001 + id. */
static PetscErrorCode TestSnapshot(void)
{
  PetscReal   x[DIM * NUMBER], v[DIM * NUMBER], density[NUMBER], id[NUMBER], wrong = 0;
  PetscMPIInt rank;
  Run         run;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(RunCreate(OPTIONS "-snapshot_lower 3e-3,1e-3 -snapshot_upper 6e-3,2.5e-3 -snapshot_double -snapshot_fields "
                              "density,velocity",
                      &run));
  PetscCall(Fill(&run, Low, 0));
  PetscCall(OutputSetUp(run.output, NULL, &(StepState){0}));
  PetscCall(OutputStep(run.output, &state, PETSC_TRUE));
  PetscCall(RunDestroy(&run));
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  if (rank) PetscFunctionReturn(PETSC_SUCCESS);
  CHECK(Read("position", x, DIM * NUMBER) == DIM * 18 && Read("velocity", v, DIM * NUMBER) == DIM * 18 &&
          Read("density", density, NUMBER) == 18 && Read("id", id, NUMBER) == 18,
        "snapshot of a part of the box");
  CHECK(Read("pressure", x + DIM, 0) == 0, "snapshot without the pressure");
  for (PetscInt k = 0; k < 18; k++) {
    const PetscInt  i      = (PetscInt)id[k];
    const PetscReal due[2] = {(i % 12 + 0.5) * D0, (i / 12 + 0.5) * D0};

    wrong = PetscMax(wrong, PetscAbsReal(x[DIM * k] - due[0]) + PetscAbsReal(x[DIM * k + 1] - due[1]));
    wrong = PetscMax(wrong, PetscAbsReal(density[k] - 1001 - i) + PetscAbsReal(v[DIM * k + 1] - 2));
  }
  CHECK_CLOSE(wrong, 0, 1e-12, "snapshot has what the particles have");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- budget --- */

/* The number behind a word in a text. */
static PetscReal After(const char text[], const char word[])
{
  const char *found = strstr(text, word);

  return found ? atof(found + strlen(word)) : NAN;
}

#define REPORT 4096

/* What the budget of a run in a state says. */
static PetscErrorCode Report(const StepState *of, char text[REPORT])
{
  struct _p_Sim sim = {.comm = PETSC_COMM_WORLD, .state = *of};
  FILE         *out = PETSC_STDOUT;
  Run           run;

  PetscFunctionBegin;
  PetscCall(RunCreate(OPTIONS, &run));
  PetscCall(Fill(&run, Low, 0));
  sim.domain   = run.domain;
  sim.scene    = run.scene;
  sim.gauges   = run.gauges;
  sim.cloud    = run.cloud;
  PetscCall(PressureCreate(run.cloud, &sim.pressure));
  PETSC_STDOUT = tmpfile();
  PetscCall(BudgetReport(&sim));
  rewind(PETSC_STDOUT);
  text[fread(text, 1, REPORT - 1, PETSC_STDOUT)] = 0;
  (void)fclose(PETSC_STDOUT);
  PETSC_STDOUT = out;
  PetscCall(PressureDestroy(&sim.pressure));
  PetscCall(RunDestroy(&run));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What dominates the error: the solver; of energy that grows it is not known. */
static PetscErrorCode TestVerdict(void)
{
  StepState grows = state;
  char      text[REPORT];

  PetscFunctionBegin;
  PetscCall(Report(&state, text));
  CHECK(strstr(text, "dominant    the solver's tolerance"), "verdict: the solver");
  grows.solver_error = 0;
  grows.start_energy = -10;
  PetscCall(Report(&grows, text));
  CHECK(strstr(text, "dominant    not known (energy grows)"), "verdict: not known");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The residual is what the energy has gained beyond the works of viscosity and tension. */
static PetscErrorCode TestBudget(void)
{
  const PetscReal gain = kinetic + potential - 0.5;
  char            text[REPORT];
  PetscMPIInt     rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(Report(&state, text));
  if (rank) PetscFunctionReturn(PETSC_SUCCESS);
  CHECK_CLOSE(After(text, "kinetic "), kinetic, 1e-3 * kinetic, "budget: kinetic energy");
  CHECK_CLOSE(After(text, "potential "), potential, 1e-3 * potential, "budget: potential energy");
  CHECK_CLOSE(After(text, "together "), gain, 1e-3, "budget: gain");
  CHECK_CLOSE(After(text, "viscosity gave "), COPIES * (-0.022 - 0.005), 1e-5, "budget: work of viscosity");
  CHECK_CLOSE(After(text, "walls that move "), COPIES * 0.005, 1e-5, "budget: work of friction");
  CHECK_CLOSE(After(text, "tension "), COPIES * 0.023, 1e-5, "budget: work of tension");
  CHECK_CLOSE(After(text, "solids that move "), COPIES * 0.1, 1e-5, "budget: work of solids");
  CHECK_CLOSE(After(text, "shaking "), COPIES * 0.02, 1e-5, "budget: work of shaking");
  CHECK_CLOSE(After(text, "emitters "), COPIES * 0.003, 1e-5, "budget: energy of emitters");
  CHECK_CLOSE(After(text, "through open faces -"), COPIES * 0.0004, 1e-5, "budget: energy of what left");
  CHECK_CLOSE(After(text, "residual "), gain - COPIES * (0.023 - 0.022 + 0.1226), 6e-3 * PetscAbsReal(gain),
              "budget: residual");
  CHECK_CLOSE(After(text, "J/m, "), 100 * (gain / COPIES - 0.1236) / 0.303, 1, "budget: share of what was exchanged");
  CHECK_CLOSE(After(text, "volume changed by "), 100 * (0.98 / 0.99 - 1), 0.05, "budget: volume");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives a number of an edge a value, by its name. */
static void Give(const char name[], PetscReal value)
{
  Number number;

  for (PetscInt k = 0; StateNumber(&state, k, &number); k++)
    if (!strcmp(number.row->name, name)) *(PetscReal *)number.at = value;
}

int main(int argc, char **argv)
{
  PetscMPIInt rank;

  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  world = PETSC_COMM_WORLD;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(LogRegister());
  Give("inflow_energy", 0.003);
  PetscCall(TestSeries());
  PetscCall(TestSnapshot());
  PetscCall(TestBudget());
  PetscCall(TestVerdict());
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  if (!rank) CHECK(!system("rm -rf " FOLDER), "folder removed");
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
