/* An array that the ranks of a machine share: what all write at once does not depend on their order, and all read it.
   Pieces of what is connected are those of a walk from cell to cell. Runs on any number of ranks. */
#include "../../src/base/shared.h"
#include "check.h"

#define PLACES 1000
#define SIDE   60

/* Of a square of cells that are in at random: numbers of connected cells by a walk, in the order of first cells. */
static PetscInt Walk(const PetscBool in[], PetscInt number[])
{
  PetscInt pieces = 0, stack[4 * SIDE * SIDE], n;

  for (PetscInt c = 0; c < SIDE * SIDE; c++) number[c] = -1;
  for (PetscInt seed = 0; seed < SIDE * SIDE; seed++) {
    if (!in[seed] || number[seed] >= 0) continue;
    stack[0] = seed;
    for (n = 1; n > 0;) {
      const PetscInt c = stack[--n], x = c % SIDE, y = c / SIDE;

      number[c] = pieces;
      if (x > 0 && in[c - 1] && number[c - 1] < 0) stack[n++] = c - 1;
      if (x < SIDE - 1 && in[c + 1] && number[c + 1] < 0) stack[n++] = c + 1;
      if (y > 0 && in[c - SIDE] && number[c - SIDE] < 0) stack[n++] = c - SIDE;
      if (y < SIDE - 1 && in[c + SIDE] && number[c + SIDE] < 0) stack[n++] = c + SIDE;
    }
    pieces++;
  }
  return pieces;
}

static PetscErrorCode TestPieces(void)
{
  Shared    shared;
  PetscInt *piece, number[SIDE * SIDE], pieces, first, end, wrong = 0, expected;
  PetscBool in[SIDE * SIDE];

  PetscFunctionBegin;
  PetscCall(SharedCreate(PETSC_COMM_WORLD, 1, &(SharedArray){&piece, SIDE * SIDE, sizeof(PetscInt)}, &shared));
  for (PetscInt c = 0; c < SIDE * SIDE; c++) in[c] = (PetscBool)(RandomUnit(1, (unsigned long long)c) < 0.6);
  expected = Walk(in, number);
  SharedSlice(&shared, SIDE * SIDE, &first, &end);
  for (PetscInt c = first; c < end; c++) piece[c] = in[c] ? c : -1;
  PetscCall(SharedFence(&shared));
  for (PetscInt c = first; c < end; c++) {
    if (in[c] && c % SIDE && in[c - 1]) PieceJoin(piece, c, c - 1);
    if (in[c] && c >= SIDE && in[c - SIDE]) PieceJoin(piece, c - SIDE, c);
  }
  PetscCall(PiecesNumber(&shared, SIDE * SIDE, piece, &pieces));
  for (PetscInt c = 0; c < SIDE * SIDE; c++) wrong += piece[c] != number[c];
  CHECK(pieces == expected && pieces > 10, "as many pieces as by a walk");
  CHECK(wrong == 0, "each cell has the number of its piece");
  PetscCall(SharedDestroy(&shared));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  Shared         shared = {0};
  PetscMPIInt    rank, size;
  PetscInt      *value, wrong = 0, first, end;
  PetscInt64    *sum;
  unsigned char *mark;

  PetscFunctionBeginUser;
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(SharedDestroy(&shared));
  {
    const SharedArray arrays[] = {{&mark, PLACES, 1},
                                  {&value, PLACES, sizeof(PetscInt)},
                                  {&sum, 1, sizeof(PetscInt64)}};

    PetscCall(SharedCreate(PETSC_COMM_WORLD, PETSC_STATIC_ARRAY_LENGTH(arrays), arrays, &shared));
  }
  CHECK(shared.size == size && shared.rank == rank && shared.leads == (rank == 0), "the ranks here are of one machine");
  for (PetscInt k = 0; k < PLACES; k++) {
    SharedMin(&value[k], -k - rank);
    SharedOr(&mark[k], (unsigned char)(1 << rank));
    SharedAdd(&shared, sum, 0.1 * (k % 7 + rank));
  }
  PetscCall(SharedReduce(&shared, value, PLACES, MPIU_INT, MPI_MIN));
  for (PetscInt k = 0; k < PLACES; k++) wrong += value[k] != -k - (size - 1) || mark[k] != (1 << size) - 1;
  CHECK(wrong == 0, "every rank reads what all have written");
  CHECK_CLOSE((PetscReal)*sum * SHARED_UNIT, 0.1 * (size * (142 * 21 + 15) + PLACES * size * (size - 1) / 2), 1e-12,
              "the sum of all parts");
  SharedSlice(&shared, PLACES, &first, &end);
  wrong = 0;
  PetscCall(SharedFence(&shared));
  for (PetscInt k = first; k < end; k++) value[k] = 1;
  PetscCall(SharedFence(&shared));
  for (PetscInt k = 0; k < PLACES; k++) wrong += value[k] != 1;
  CHECK(wrong == 0, "slices cover all places");
  PetscCall(SharedFence(&shared));
  if (shared.leads) mark[PLACES - 1] = 77;
  PetscCall(SharedFence(&shared));
  CHECK(mark[PLACES - 1] == 77, "and what the one that leads has written");
  PetscCall(SharedDestroy(&shared));
  PetscCall(TestPieces());
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
