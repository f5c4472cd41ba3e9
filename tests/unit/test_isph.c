/* The library: what each function of isph.h gives, refuses, and leaves as it was for the program around it. Runs on any
   number of ranks. */
#include "../../src/base/base.h"
#include "../../src/isph.h"
#include "check.h"
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define SCENE                                                                                                          \
  "-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 1,1 -box_xmin wall -box_xmax wall -box_ymin wall -gravity "     \
  "0,-9.81 -bodies pool -pool_upper 0.5,0.5 -packing_seed 3 "
#define FOLDER "output/test_isph"
#define STEPS  5

static int ranks, rank;

static void Split(void)
{
  char    **word;
  const int count = WordsSplit("  -a 'b  c'\t-d \"\" e\"f\"\n", &word);

  CHECK(count == 6 && !strcmp(word[1], "-a") && !strcmp(word[2], "b  c") && !strcmp(word[4], "") &&
          !strcmp(word[5], "ef") && !word[6],
        "words_of_a_text");
  free(word[0]);
  free(word);
}

/* A run of the scene that is set up; NULL if that fails. */
static Isph Ready(const char options[], const char name[])
{
  Isph run;
  int  code = IsphCreate(options, ISPH_WORLD, &run);

  if (!code) code = IsphSetUp(run);
  CHECK(code == 0, name);
  if (code) printf("%s\n", IsphError());
  return code ? NULL : run;
}

/* What fails says so in a sentence, prints nothing, and leaves the process ready for another run. */
static void Refuse(const char options[], const char word[], const char name[])
{
  Isph run;
  int  code = IsphCreate(options, ISPH_WORLD, &run);

  if (!code) code = IsphSetUp(run);
  CHECK(code != 0 && (rank || strstr(IsphError(), word)), name);
  if (!rank && !strstr(IsphError(), word)) printf("%s\n", IsphError());
  CHECK(IsphStep(run, 1) != 0 && strstr(IsphError(), "failed before"), "a_failed_run_makes_no_step");
  CHECK(IsphDestroy(&run) == 0 && !run, "a_failed_run_ends");
}

static void Mistakes(void)
{
  Isph      run = Ready(SCENE "-steps_max 5 ", "set_up"), other;
  IsphArray array;
  double    value;

  CHECK(IsphCreate(SCENE, ISPH_WORLD, &other) != 0 && strstr(IsphError(), "has a run already"), "one_run_at_a_time");
  CHECK(IsphSetUp(run) != 0 && strstr(IsphError(), "set up already"), "set_up_twice");
  CHECK(IsphField(run, "colour", &array) != 0 && strstr(IsphError(), "no field 'colour'"), "no_such_field");
  CHECK(IsphColumn(run, "crater_depth", &value) != 0 && strstr(IsphError(), "no column"), "no_such_column");
  CHECK(IsphCheckpoint(run) != 0 && strstr(IsphError(), "-output_dir"), "no_folder_no_checkpoint");
  CHECK(IsphFinalize() != 0, "finalize_with_a_run");
  CHECK(!IsphColumn(run, "time_step", &value) && value != value, "no_step_has_been");
  CHECK(IsphStep(run, 1) == 0 && !IsphError()[0], "mistakes_do_not_end_a_run");
  CHECK(IsphStep(run, 0) != 0 && strstr(IsphError(), "not before 0 s"), "step_into_the_past");
  CHECK(IsphStep(run, IsphTime(run)) != 0 && strstr(IsphError(), "not before"), "step_of_no_time");
  other = run;
  CHECK(IsphRun(run, INFINITY) == 0 && IsphStep(run, INFINITY) != 0 && strstr(IsphError(), "at its end"), "step_on");
  CHECK(IsphDestroy(&run) == 0 && !run && IsphDestroy(&run) == 0, "destroy");
  CHECK(IsphEnded(other) && isnan(IsphTime(other)) && isnan(IsphTimeStep(other)) && !IsphSteps(other) &&
          !IsphFieldName(other, 0) && !IsphColumnName(other, 0) && IsphSetCallback(other, NULL, NULL),
        "questions_to_a_run_that_is_none");
  CHECK(IsphCreate(SCENE, ISPH_WORLD, &run) == 0 && IsphStep(run, 1) != 0 && strstr(IsphError(), "IsphSetUp first"),
        "step_before_set_up");
  CHECK(IsphDestroy(&run) == 0, "destroy_before_set_up");
}

/* Sum over all ranks. */
static double Sum(double value)
{
  (void)MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  return value;
}

static void Fields(void)
{
  Isph      run = Ready(SCENE "-gauge_points 0.25,0.25", "with_a_gauge");
  IsphArray x, again, layer, v, none;
  double    liquid = 0, energy = 0, value = NAN, plain = NAN;
  int       names = 0, position = 0;

  CHECK(IsphStep(run, INFINITY) == 0, "a_step");
  CHECK(!IsphField(run, "position", &x) && !IsphField(run, "position", &again) && !IsphField(run, "layer", &layer) &&
          !IsphField(run, "velocity", &v),
        "fields");
  CHECK(x.data == again.data && x.count == layer.count && x.components == 3 && layer.components == 1, "arrays");
  CHECK(!x.integer && x.bytes == sizeof(double) && layer.integer && layer.bytes == sizeof(PetscInt), "numbers");
  CHECK(!strcmp(x.unit, "m") && !strcmp(v.unit, "m/s") && !strcmp(layer.unit, "1"), "units_of_fields");
  for (long k = 0; k < x.count; k++) {
    const double *u = (const double *)v.data + 3 * k;

    if (((const PetscInt *)layer.data)[k] > 0) continue;
    liquid++;
    energy += 0.5 * 1000 * 0.01 * (u[0] * u[0] + u[1] * u[1]);
  }
  CHECK_CLOSE(Sum(liquid), 25, 0, "liquid_of_the_arrays");
  CHECK(!IsphColumn(run, "particles", &value), "column");
  CHECK_CLOSE(value, 25, 0, "particles_of_the_column");
  CHECK(!IsphColumn(run, "kinetic_energy_J/m", &value) && !IsphColumn(run, "kinetic_energy", &plain), "two_names");
  CHECK_CLOSE(plain, value, 0, "a_column_by_both_names");
  CHECK_CLOSE(Sum(energy), value, 1e-10 * value, "energy_of_the_arrays");
  CHECK(!IsphColumn(run, "time", &value) && value == IsphTime(run) && value == IsphTimeStep(run), "time");
  CHECK(!IsphColumn(run, "point_1_pressure", &value) && value > 0, "column_of_a_gauge");
  CHECK(IsphField(run, "velocity_star", &none), "a_field_of_the_step_is_none");
  for (; IsphFieldName(run, names); names++) position += !strcmp(IsphFieldName(run, names), "position");
  CHECK(names >= 10 && position == 1, "names_of_fields");
  for (names = 0; IsphColumnName(run, names); names++) position += !strcmp(IsphColumnName(run, names), "highest_m");
  CHECK(names > 15 && position == 2 && !IsphColumnName(run, -1), "names_of_columns");
  CHECK(IsphDestroy(&run) == 0, "destroy_with_a_gauge");
}

/* A callback's: how often it was called, and after how many it says 7; what it sees of the program around. */
typedef struct {
  int    calls, most;
  double times, before;
} Seen;

static int After(void *context, Isph run)
{
  Seen     *seen = (Seen *)context;
  PetscBool set;
  double    time;

  CHECK(!PetscOptionsHasName(NULL, NULL, "-spacing", &set) && !set, "options_of_the_run_are_apart");
  CHECK(!IsphColumn(run, "time", &time) && time > seen->before, "callback_sees_the_step");
  seen->before = time;
  return ++seen->calls == seen->most ? 7 : 0;
}

static void Steps(void)
{
  Isph   run  = Ready(SCENE "-time_end 0.1", "with_an_end");
  Seen   seen = {.most = 3, .before = 0};
  double half;

  CHECK(!IsphStep(run, 1e-9) && IsphTime(run) == 1e-9 && IsphSteps(run) == 1, "step_to_a_time");
  CHECK(!IsphSetCallback(run, After, &seen), "set_callback");
  CHECK(IsphRun(run, 1) == 7 && seen.calls == 3 && IsphSteps(run) == 4, "callback_ends_a_run");
  half = 0.5 * (IsphTime(run) + 0.1);
  CHECK(!IsphRun(run, half) && IsphTime(run) == half && !IsphEnded(run), "run_to_a_time");
  CHECK(!IsphRun(run, INFINITY) && IsphTime(run) == 0.1 && IsphEnded(run), "run_to_the_end");
  CHECK(seen.calls == IsphSteps(run) - 1, "a_call_a_step");
  CHECK(IsphDestroy(&run) == 0, "destroy_at_the_end");
}

/* Energy after some steps, with what a run leaves in its folder. */
static double Energy(const char options[], const char name[])
{
  Isph        run   = Ready(options, name);
  double      value = NAN;
  const char *json;

  CHECK(!IsphRun(run, INFINITY) && IsphSteps(run) == STEPS && IsphEnded(run), "steps_max");
  CHECK(!IsphColumn(run, "kinetic_energy", &value), "energy");
  CHECK(!IsphScene(run, &json) && (rank ? !json[0] : json[0] == '{' && strstr(json, "\"columns\"")), "scene");
  CHECK(IsphDestroy(&run) == 0, "destroy_after_steps");
  return value;
}

static PetscBool Exists(const char path[])
{
  struct stat info;

  return (PetscBool)!stat(path, &info);
}

/* What another program gives the liquid is what the next step starts from, and the budget knows it. */
static void Given(void)
{
  Isph      run = Ready("-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 2,2 -bodies pool -pool_lower 0.5,0.5 "
                             "-pool_upper 1,1 -pool_tension 0 -packing_jitter 0 -solids part -part_lower 1.5,1.5 "
                             "-part_upper 1.8,1.8 -time_step 1e-3 -ksp_rtol 1e-12",
                        "a_block_in_flight");
  IsphArray x, layer, v;
  double   *values, kinetic = 0, work = 0, before = 0, after = 0, sum = 0, own = 0;

  CHECK(IsphStep(run, INFINITY) == 0 && !IsphField(run, "velocity", &v) && !IsphField(run, "layer", &layer), "at_rest");
  values = (double *)calloc(3 * 1000, sizeof(double));
  for (long k = 0; k < v.count; k++) {
    values[3 * k]     = ((const PetscInt *)layer.data)[k] > 0 ? NAN : 2; /* rows of solids are not read */
    values[3 * k + 1] = 1;
  }
  CHECK(!IsphColumn(run, "kinetic_energy", &own) && !IsphColumn(run, "highest", &before),
        "before"); /* the packing spreads */
  CHECK(!IsphSetField(run, "velocity", values), "velocities_are_given");
  CHECK(!IsphColumn(run, "kinetic_energy", &kinetic) && !IsphColumn(run, "outside_work", &work),
        "energy_that_is_given");
  CHECK_CLOSE(kinetic, 0.5 * 1000 * 0.25 * 5, 1e-9 * kinetic, "kinetic_energy_that_is_given");
  CHECK_CLOSE(work, kinetic - own, 1e-9 * kinetic, "work_from_outside");
  for (int step = 0; step < 10; step++) CHECK(IsphStep(run, INFINITY) == 0, "a_step_on");
  CHECK(!IsphColumn(run, "highest", &after) && !IsphField(run, "velocity", &v) && !IsphField(run, "layer", &layer),
        "on");
  CHECK_CLOSE(after - before, 0.01, 0.004, "the_block_flies");
  for (long k = 0; k < v.count; k++)
    if (((const PetscInt *)layer.data)[k] == 0) sum += ((const double *)v.data)[3 * k];
  CHECK_CLOSE(Sum(sum), 2 * 25, 1e-7, "velocity_of_the_block");
  CHECK(!IsphField(run, "position", &x) && !IsphField(run, "layer", &layer), "positions");
  for (long k = 0; k < 3 * x.count; k++) values[k] = ((const double *)x.data)[k] + 0.3; /* to other ranks */
  CHECK(!IsphSetField(run, "position", values) && !IsphColumn(run, "highest", &sum), "positions_are_given");
  CHECK_CLOSE(sum - after, 0.3, 1e-9, "the_block_is_moved");
  CHECK(IsphStep(run, INFINITY) == 0 && !IsphField(run, "position", &x), "a_step_from_there");
  CHECK(!IsphColumn(run, "kinetic_energy", &kinetic), "energy_then");
  for (long k = 0; k < 3 * x.count; k++) values[k] = ((const double *)x.data)[k] + 1;
  CHECK(IsphSetField(run, "position", values) && strstr(IsphError(), "outside of the box"), "refuse_places_outside");
  for (long k = 0; k < 3 * x.count; k++) values[k] = NAN;
  CHECK(IsphSetField(run, "velocity", values) && strstr(IsphError(), "no number"), "refuse_no_number");
  CHECK(IsphSetField(run, "pressure", values) && strstr(IsphError(), "cannot be set"), "refuse_a_pressure");
  CHECK(!IsphColumn(run, "kinetic_energy", &work), "a_refusal_ends_no_run");
  CHECK_CLOSE(work, kinetic, 0, "a_refusal_changes_nothing");
  free(values);
  CHECK(IsphDestroy(&run) == 0, "destroy_the_block");
}

/* A run has nothing of the one before, and the folder changes nothing. */
static void Again(void)
{
  const double first = Energy(SCENE "-steps_max 5", "first_run"), second = Energy(SCENE "-steps_max 5", "second_run");

  CHECK_CLOSE(second, first, 0, "two_runs_are_one");
  CHECK_CLOSE(Energy(SCENE "-steps_max 5 -output_overwrite -output_dir '" FOLDER " x'", "run_with_a_folder"), first,
              1e-14 * first, /* its checkpoint sorts the particles, so the sum has another order */
              "a_folder_changes_nothing");
  (void)MPI_Barrier(MPI_COMM_WORLD);
  CHECK(Exists(FOLDER " x/series.csv") && Exists(FOLDER " x/scene.json") && Exists(FOLDER " x/log.txt") &&
          Exists(FOLDER " x/checkpoint_000005.h5"),
        "files_of_the_folder");
  (void)MPI_Barrier(MPI_COMM_WORLD);
  if (!rank) CHECK(!system("rm -r '" FOLDER " x'"), "folder_removed");
}

int main(int argc, char **argv)
{
  PetscErrorCode (*print)(FILE *, const char[], va_list);

  (void)MPI_Init(&argc, &argv);
  (void)MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  (void)MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  Split();
  Refuse(SCENE "-pool_visosity 1", "-pool_viscosity", "refuse_a_misspelt_option");
  Refuse(SCENE "-pool_density -1", "-pool_density", "refuse_a_value");
  Refuse(SCENE "-options_file nowhere.opts", "nowhere.opts cannot be opened", "refuse_a_missing_file");
  Refuse(SCENE "stray word", "stray is not the value", "refuse_a_stray_word");
  Refuse(SCENE "-restart nowhere.h5", "nowhere.h5", "refuse_a_missing_checkpoint");
  Refuse(SCENE "-pc_type nothing", "nothing", "refuse_a_type_of_petsc");
  print = PetscVFPrintf;
  Mistakes();
  CHECK(print == PetscVFPrintf, "printer_of_the_program");
  Fields();
  Given();
  Steps();
  Again();
  CHECK(!strcmp(IsphVersion(), ISPH_VERSION), "version");
  CHECK(IsphFinalize() == 0, "finalize");
  (void)MPI_Finalize();
  return CHECK_DONE();
}
