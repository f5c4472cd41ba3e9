/* The time series: plain CSV with a head line, one line a due step, SI units; written by rank 0 and flushed line by
 * line. */
#include "output_impl.h"
#include <errno.h>
#include <sys/stat.h>
#include <unistd.h>

#define SERIES_FILE "series.csv"
#define LINE_LENGTH 65536 /* a hundred bytes for each of the columns below and of the gauges */
#define NAME_LENGTH 64

/* The columns: name, unit ("" if it has none) and value, from state (StepState), gauges (GaugeValues) and wall (s). The
 * places of the first three are fixed. */
#define SERIES_COLUMNS(X)                                                                                              \
  X("time", "s", state->time)                                                                                          \
  X("step", "", state->step)                                                                                           \
  X("time_step", "s", state->time_step)                                                                                \
  X("crown_height", "m", gauges->crown_height)                                                                         \
  X("crater_depth", "m", gauges->crater_depth)                                                                         \
  X("crater_diameter", "m", gauges->crater_diameter)                                                                   \
  X("kinetic_energy", "J", gauges->kinetic_energy)                                                                     \
  X("iterations", "", state->iterations)                                                                               \
  X("jet_height", "m", gauges->jet_height)                                                                             \
  X("highest", "m", gauges->highest)                                                                                   \
  X("potential_energy", "J", gauges->potential_energy)                                                                 \
  X("volume", "m3", gauges->volume)                                                                                    \
  X("density_error", "", state->density_error)                                                                         \
  X("divergence", "", state->divergence)                                                                               \
  X("solver_error", "", state->solver_error)                                                                           \
  X("surface_energy", "J", gauges->multiplicity * state->surface_energy)                                               \
  X("viscous_work", "J", gauges->multiplicity * state->viscous_work)                                                   \
  X("tension_work", "J", gauges->multiplicity * state->tension_work)                                                   \
  X("particles", "", gauges->particles)                                                                                \
  X("lost", "", state->lost)                                                                                           \
  X("rejected", "", state->rejected)                                                                                   \
  X("wall_time", "s", wall)

/* Head line: name and unit. */
static const char *const names[][2] = {
#define COLUMN_NAME(name, unit, value) {name, unit},
  SERIES_COLUMNS(COLUMN_NAME)
#undef COLUMN_NAME
};

#define COLUMNS ((PetscInt)(sizeof(names) / sizeof(names[0])))

const char *GaugeUnit(Output output, const char unit[])
{
  static const char *const flat[][2] = {{"J", "J/m"}, {"N", "N/m"}, {"m3", "m2"}};

  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(flat) && output->cloud->domain->dim == 2; k++)
    if (!strcmp(unit, flat[k][0])) return flat[k][1];
  return unit;
}

static PetscErrorCode HeadLine(Output output, char line[LINE_LENGTH])
{
  size_t used = 0;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < COLUMNS; c++)
    used += (size_t)snprintf(line + used, LINE_LENGTH - used, "%s%s%s%s", c ? "," : "", names[c][0],
                             names[c][1][0] ? "_" : "", GaugeUnit(output, names[c][1]));
  for (PetscInt c = 0; c < PointsColumns(output); c++) {
    char name[NAME_LENGTH];

    PetscCall(PointsName(output, c, name, sizeof(name)));
    used += (size_t)snprintf(line + used, LINE_LENGTH - used, ",%s", name);
  }
  for (PetscInt c = 0; c < ProbesColumns(output); c++) {
    char name[NAME_LENGTH];

    PetscCall(ProbesName(output, c, name, sizeof(name)));
    used += (size_t)snprintf(line + used, LINE_LENGTH - used, ",%s", name);
  }
  (void)snprintf(line + used, LINE_LENGTH - used, "\n");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Copies the head and the whole lines up to a step to a temporary file that then takes the name. Rank 0; returns an
   errno, EILSEQ when the file has other columns. */
static int Cut(const char path[], const char temporary[], const char head[], PetscInt restart_step, PetscInt *last_step)
{
  FILE *from = fopen(path, "r"), *to;
  char  line[LINE_LENGTH];
  int   error = 0;

  *last_step = -1;
  if (!from) return errno == ENOENT ? 0 : errno;
  to = fopen(temporary, "w");
  if (!to) error = errno;
  if (!error && (!fgets(line, sizeof(line), from) || strcmp(line, head))) error = EILSEQ;
  if (!error && fputs(head, to) < 0) error = errno;
  while (!error && fgets(line, sizeof(line), from)) {
    double time;
    long   step;

    if (!strchr(line, '\n') || sscanf(line, "%lf,%ld,", &time, &step) != 2) break; /* cut off in writing */
    if (step > restart_step) break;
    if (fputs(line, to) < 0) error = errno;
    *last_step = (PetscInt)step;
  }
  fclose(from);
  if (!to) return error;
  if (fflush(to) && !error) error = errno;
  if (fsync(fileno(to)) && !error && errno != EINVAL) error = errno;
  if (fclose(to) && !error) error = errno;
  if (!error && rename(temporary, path)) error = errno;
  if (error) (void)unlink(temporary);
  return error;
}

/* Opens the file to append, with the head when it is new. Rank 0; returns an errno. */
static int Open(const char path[], const char head[], FILE **file)
{
  struct stat info;

  *file = fopen(path, "a");
  if (!*file) return errno;
  if (fstat(fileno(*file), &info)) return errno;
  if (info.st_size == 0 && (fputs(head, *file) < 0 || fflush(*file))) return errno;
  return 0;
}

PetscErrorCode TableStart(Output output, const char name[], const char head[], PetscBool same, PetscInt restart_step,
                          FILE **file, PetscInt *last)
{
  char path[PETSC_MAX_PATH_LEN], temporary[PETSC_MAX_PATH_LEN];
  int  error = 0, other;

  PetscFunctionBegin;
  *last = -1;
  PetscCall(OutputPath(output, name, path));
  PetscCall(PetscSNPrintf(temporary, sizeof(temporary), "%s.tmp", path));
  if (!output->rank && same) error = Cut(path, temporary, head, restart_step, last);
  other = error == EILSEQ;
  PetscCallMPI(MPI_Bcast(&other, 1, MPI_INT, 0, output->comm));
  PetscCheckUser(
    !other, output->comm,
    "%s has other columns than this run writes (-gauge_..., or the version of the program); move it away to "
    "continue the run.",
    path);
  if (!output->rank && !error) error = Open(path, head, file);
  PetscCall(FolderStatus(output, error, "write", path));
  PetscCallMPI(MPI_Bcast(last, 1, MPIU_INT, 0, output->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SeriesStart(Output output, PetscBool same, PetscInt restart_step)
{
  char *head;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(LINE_LENGTH, &head));
  PetscCall(HeadLine(output, head));
  PetscCall(TableStart(output, SERIES_FILE, head, same, restart_step, &output->series_file, &output->series_step));
  PetscCall(PetscFree(head));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One value, after a comma unless it is the first; whole numbers come out as such up to 12 digits. Returns an errno. */
static int Value(FILE *file, PetscBool first, double value)
{
  if (!first && fputs(",", file) < 0) return errno;
  if (value != value) return fputs("nan", file) < 0 ? errno : 0; /* no "-nan" */
  return fprintf(file, "%.12g", value) < 0 ? errno : 0;
}

/* One line: the columns, then the n values of points and other gauges. Returns an errno. */
static int Line(FILE *file, const StepState *state, const GaugeValues *gauges, PetscReal wall, PetscInt n,
                const PetscReal point[])
{
  int          error    = 0;
  const double values[] = {
#define COLUMN_VALUE(name, unit, value) (double)(value),
    SERIES_COLUMNS(COLUMN_VALUE)
#undef COLUMN_VALUE
  };

  for (PetscInt c = 0; c < COLUMNS && !error; c++) error = Value(file, (PetscBool)(c == 0), values[c]);
  for (PetscInt c = 0; c < n && !error; c++) error = Value(file, PETSC_FALSE, (double)point[c]);
  if (error) return error;
  if (fputs("\n", file) < 0 || fflush(file)) return errno;
  return 0;
}

PetscErrorCode SeriesWrite(Output output, const StepState *state)
{
  char        path[PETSC_MAX_PATH_LEN];
  GaugeValues gauges;
  PetscInt    points = PointsColumns(output), probes = ProbesColumns(output);
  PetscReal  *gauge;
  int         error = 0;

  PetscFunctionBegin;
  PetscCall(OutputGauges(output, &gauges));
  PetscCall(PetscMalloc1(points + probes, &gauge));
  PetscCall(OutputPoints(output, gauge));
  PetscCall(ProbesMeasure(output, gauge + points));
  PetscCall(OutputPath(output, SERIES_FILE, path));
  if (!output->rank) error = Line(output->series_file, state, &gauges, OutputWallTime(output), points + probes, gauge);
  PetscCall(PetscFree(gauge));
  PetscCall(FolderStatus(output, error, "write", path));
  PetscFunctionReturn(PETSC_SUCCESS);
}
