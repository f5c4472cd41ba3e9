/* Says where liquid under tension opens without -gas. A row inside it whose neighbourhood has become incomplete is
   closed as if air were beside it, so a siphon parts at its crest, where the air of the world would not get. */
#include "gas_impl.h"

#define OFTEN 4 /* times as many steps may pass without a row that opens as with one */
/* OFTEN for each step with one, less the others: a few heal. With 40 tests/verify/opening.py holds, with 160 a siphon
   has not said it by 0.28 s */
#define LASTING 80

typedef struct {
  PetscBool frozen;
  PetscInt  lasting;        /* see LASTING */
  PetscReal least, at[DIM]; /* Pa, the mean pressure of the liquid around, and where, of this rank since then */
} Opening;

typedef struct {
  PetscReal rows, surface; /* that open in this step; that are on a free surface: without one no pressure has a level */
} OpeningSums;

static PetscBool On(const Step *step)
{
  return (PetscBool) !((const Gas *)StepperOwn(step->stepper, &GaugePockets))->on;
}

static PetscErrorCode Freeze(const Step *step, PetscBool frozen)
{
  PetscFunctionBegin;
  ((Opening *)step->own)->frozen = frozen;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether row a is closed although all liquid around it is under tension, by the pressure of the former step, and away
   from free surfaces; *mean (Pa): its pressure. */
static PetscBool Opens(Cloud cloud, Pressure pressure, PetscInt a, PetscReal *mean)
{
  const PetscReal *p = cloud->field[FIELD_PRESSURE];
  PetscInt         n = 0;

  *mean = 0;
  if (p[a] >= 0 || cloud->integer[INT_SURFACE][a] || CloudPushes(cloud, a) || !PressureCloses(pressure, a))
    return PETSC_FALSE;
  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    const PetscInt b = cloud->list[k];

    if (cloud->integer[INT_LAYER][b]) continue;
    if (p[b] >= 0 || cloud->integer[INT_SURFACE][b]) return PETSC_FALSE;
    *mean += p[b];
    n++;
  }
  *mean /= PetscMax(1, n);
  return (PetscBool)(n > 0);
}

static PetscErrorCode Surround(const Step *step)
{
  Opening     *opening = (Opening *)step->own;
  const Cloud  cloud   = step->cloud;
  OpeningSums *sums    = (OpeningSums *)step->sums;
  PetscReal    mean;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid && !opening->frozen; a++) {
    sums->surface += cloud->integer[INT_SURFACE][a] == 1;
    if (!Opens(cloud, step->pressure, a, &mean)) continue;
    sums->rows++;
    if (mean >= opening->least) continue;
    opening->least = mean;
    PetscCall(PetscArraycpy(opening->at, cloud->field[FIELD_POSITION] + DIM * a, DIM));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Commit(const Step *step, StepState *state)
{
  Opening           *opening = (Opening *)step->own;
  const OpeningSums *sums    = (OpeningSums *)step->sums;

  PetscFunctionBegin;
  opening->lasting += sums->rows > 0 && sums->surface > 0 ? OFTEN : -PetscMin(1, opening->lasting);
  if (!opening->lasting) opening->least = 0;
  *(PetscInt *)StepNumbers(step, state) = opening->lasting;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Renew(const Step *step, PetscBool resumed, StepState *state)
{
  PetscFunctionBegin;
  ((Opening *)step->own)->lasting = *(PetscInt *)StepNumbers(step, state);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const NumberRow rows[] = {{"opening_lasting", NUMBER_COUNT, 0, ENERGY_NONE, NULL}, {.name = NULL}};

static PetscErrorCode Doubt(const Step *step, char text[], size_t length)
{
  Opening *opening = (Opening *)step->own;
  MPI_Comm comm    = step->cloud->comm;
  struct {
    double least;
    int    rank;
  } lowest = {opening->least, 0};

  PetscFunctionBegin;
  if (opening->lasting < LASTING) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Comm_rank(comm, &lowest.rank));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &lowest, 1, MPI_DOUBLE_INT, MPI_MINLOC, comm));
  PetscCallMPI(MPI_Bcast(opening->at, DIM, MPIU_REAL, lowest.rank, comm));
  PetscCall(PetscSNPrintf(text, length,
                          "liquid under tension, %.4g Pa, opens at %.4g,%.4g,%.4g m, away from the air: the gap has "
                          "the air's pressure all the same, so what hangs there parts; -gas lets no air into it",
                          lowest.least, (double)opening->at[0], (double)opening->at[1], (double)opening->at[2]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const Edge OpeningEdge = {.name        = "opening",
                          .data_size   = sizeof(Opening),
                          .sums        = sizeof(OpeningSums) / sizeof(PetscReal),
                          .number_size = sizeof(PetscInt),
                          .numbers     = rows,
                          .on          = On,
                          .freeze      = Freeze,
                          .surround    = Surround,
                          .commit      = Commit,
                          .renew       = Renew,
                          .doubt       = Doubt};
