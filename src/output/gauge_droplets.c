/* Pieces of liquid: what hangs together by steps below -gauge_connection. */
#include "output_impl.h"
#include <stdlib.h>

#define PIECE_REALS ((PetscMPIInt)(sizeof(Piece) / sizeof(PetscReal)))

static int CompareLabels(const void *a, const void *b)
{
  const PetscReal x = ((const Piece *)a)->label, y = ((const Piece *)b)->label;

  return (x > y) - (x < y);
}

static int CompareSizes(const void *a, const void *b)
{
  const PetscReal x = ((const Piece *)a)->particles, y = ((const Piece *)b)->particles;

  return x != y ? (x < y) - (x > y) : CompareLabels(a, b);
}

/* Adds up pieces of one label, in order of labels; returns how many are left. place and velocity are sums here. */
static PetscInt Merge(PetscInt n, Piece piece[])
{
  PetscInt count = 0;

  if (n) qsort(piece, (size_t)n, sizeof(*piece), CompareLabels);
  for (PetscInt k = 0; k < n; k++) {
    Piece *to = &piece[count - 1];

    if (count == 0 || to->label != piece[k].label) {
      piece[count++] = piece[k];
      continue;
    }
    to->particles += piece[k].particles;
    for (PetscInt d = 0; d < DIM; d++) {
      to->place[d] += piece[k].place[d];
      to->velocity[d] += piece[k].velocity[d];
    }
  }
  return count;
}

PetscErrorCode DropletsFind(Output output, PetscInt *count, Piece **piece)
{
  Cloud       cloud = output->cloud;
  Piece      *own;
  PetscMPIInt send, *number = NULL, *place = NULL, total = 0;

  PetscFunctionBegin;
  PetscCall(GaugeLabels(output, output->gauge.connection * cloud->domain->spacing));
  PetscCall(PetscMalloc1(cloud->n_fluid, &own));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    own[a] = (Piece){.label = cloud->field[FIELD_WORK1][a], .particles = 1};
    for (PetscInt d = 0; d < DIM; d++) {
      own[a].place[d]    = cloud->field[FIELD_POSITION][DIM * a + d];
      own[a].velocity[d] = cloud->field[FIELD_VELOCITY][DIM * a + d];
    }
  }
  send = PIECE_REALS * (PetscMPIInt)Merge(cloud->n_fluid, own);
  PetscCall(PetscMalloc2(output->size, &number, output->size, &place));
  PetscCallMPI(MPI_Gather(&send, 1, MPI_INT, number, 1, MPI_INT, 0, output->comm));
  for (PetscMPIInt r = 0; r < output->size && !output->rank; r++) {
    place[r] = total;
    total += number[r];
  }
  PetscCall(PetscMalloc1(total / PIECE_REALS, piece));
  PetscCallMPI(MPI_Gatherv(own, send, MPIU_REAL, *piece, number, place, MPIU_REAL, 0, output->comm));
  PetscCall(PetscFree2(number, place));
  PetscCall(PetscFree(own));
  *count = Merge(total / PIECE_REALS, *piece);
  for (PetscInt k = 0; k < *count; k++)
    for (PetscInt d = 0; d < DIM; d++) {
      (*piece)[k].place[d] /= (*piece)[k].particles;
      (*piece)[k].velocity[d] /= (*piece)[k].particles;
    }
  if (*count) qsort(*piece, (size_t)*count, sizeof(**piece), CompareSizes);
  PetscFunctionReturn(PETSC_SUCCESS);
}
