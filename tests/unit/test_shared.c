/* An array that the ranks of a machine share: what all write at once does not depend on their order, and all read it.
   Runs on any number of ranks. */
#include "../../src/base/shared.h"
#include "check.h"

#define PLACES 1000

int main(int argc, char **argv)
{
  Shared         shared = {0};
  PetscMPIInt    rank, size;
  float         *value;
  unsigned char *mark;
  PetscInt       wrong = 0;

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(SharedDestroy(&shared));
  PetscCall(SharedCreate(PETSC_COMM_WORLD, PLACES * (sizeof(float) + 1), &shared));
  CHECK(shared.size == size && shared.rank == rank && shared.leads == (rank == 0), "the ranks here are of one machine");
  value = (float *)shared.data;
  mark  = (unsigned char *)(value + PLACES);
  for (PetscInt k = 0; k < PLACES; k++) {
    SharedMin(&value[k], (float)(-k - rank));
    SharedOr(&mark[k], (unsigned char)(1 << rank));
  }
  PetscCall(SharedReduce(&shared, value, PLACES, MPI_FLOAT, MPI_MIN));
  for (PetscInt k = 0; k < PLACES; k++) wrong += value[k] != (float)(-k - (size - 1)) || mark[k] != (1 << size) - 1;
  CHECK(wrong == 0, "every rank reads what all have written");
  PetscCall(SharedFence(&shared));
  if (shared.leads) mark[PLACES - 1] = 77;
  PetscCall(SharedFence(&shared));
  CHECK(mark[PLACES - 1] == 77, "and what the one that leads has written");
  PetscCall(SharedDestroy(&shared));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
