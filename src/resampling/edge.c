/* Joining and splitting of particles after a step. */
#include "../stepper/edge.h"
#include "resampling_impl.h"

/* What it has done so far. */
typedef struct {
  PetscReal loss;          /* of kinetic energy, J */
  PetscInt  joined, split; /* particles removed, particles added */
} Resampled;

static const NumberRow rows[] = {
  {"resampling_loss", NUMBER_REAL, offsetof(Resampled, loss), ENERGY_LOST, "joining and splitting"},
  {"joined", NUMBER_COUNT, offsetof(Resampled, joined), ENERGY_NONE, NULL},
  {"split", NUMBER_COUNT, offsetof(Resampled, split), ENERGY_NONE, NULL},
  {.name = NULL},
};

/* The largest area of a ring over its area at the start, on all ranks. */
static PetscErrorCode LargestShare(Cloud cloud, PetscReal *share)
{
  PetscFunctionBegin;
  *share = 0;
  if (!cloud->domain->rings) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = 0; a < cloud->n_fluid; a++) *share = PetscMax(*share, ResamplingArea(cloud, a));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, share, 1, MPIU_REAL, MPIU_MAX, cloud->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Not in a step that has lost particles: the cloud then has no fields of the step any more. */
static PetscErrorCode Commit(const Step *step, StepState *state)
{
  Resampled       *so_far = (Resampled *)StepNumbers(step, state);
  PetscReal        largest;
  ResamplingReport report;

  PetscFunctionBegin;
  if (!DomainVolumesDiffer(step->cloud->domain) || step->trial->lost > 0 || step->damping < 1)
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(LargestShare(step->cloud, &largest));
  if (!ResamplingDue(state->step, largest)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Resample(step->cloud, &report));
  so_far->loss += report.energy;
  so_far->joined += report.joined;
  so_far->split += report.split;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Report(Scene scene, const void *numbers, PetscReal copies, const char joule[], char text[],
                             size_t length)
{
  const Resampled *so_far = (const Resampled *)numbers;

  PetscFunctionBegin;
  if (so_far->joined + so_far->split > 0)
    PetscCall(PetscSNPrintf(text, length,
                            "  particles   %" PetscInt_FMT " joined with others, %" PetscInt_FMT
                            " split, which took %.3g %s of kinetic energy\n",
                            so_far->joined, so_far->split, (double)(copies * so_far->loss), joule));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const Edge ResamplingEdge = {
  .name = "resampling", .number_size = sizeof(Resampled), .numbers = rows, .report = Report, .commit = Commit};
