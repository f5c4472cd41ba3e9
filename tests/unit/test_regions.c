/* Pockets of gas, from pictures of what is empty: how they start, split, merge, vent, open in part, shed, close and are
   enclosed, and that no gas is lost. The cells are filled by hand: GasCellsFill here is taken before that of the
   program (makefile, TEST_FLAGS). */
#include "../../src/gas/gas_impl.h"
#include "check.h"
#include "setup.h"
#include <string.h>

#define COLUMNS 96 /* at most */
#define LINES   64
#define EDGE    4 /* cells of a block, along x and y */
#define PER     (EDGE * EDGE)
#define AIR     1e5 /* Pa */
#define STEPS   60  /* of random pictures */

static PetscInt columns, lines, near;
static char     picture[LINES][COLUMNS + 1]; /* '.': empty; upside down: the first line is the lowest */

/* Of the grid: one of liquid, before the first fill. */
static PetscErrorCode Grid(GasCells *cells)
{
  const SharedArray blocks[] = {{&cells->block, near, sizeof(PetscInt)},
                                {&cells->home, near, sizeof(PetscInt)},
                                {&cells->close.mask, near, sizeof(GasMask)},
                                {&cells->seen.mask, near, sizeof(GasMask)},
                                {&cells->held.mask, near, sizeof(GasMask)},
                                {&cells->seen.beside, near, 1},
                                {&cells->held.beside, near, 1}},
                    nodes[]  = {{&cells->filled, near * PER, sizeof(PetscReal)},
                                {&cells->label, near * PER + near, sizeof(PetscInt)},
                                {&cells->owner, near * PER, sizeof(PetscInt)}};

  PetscFunctionBegin;
  *cells = (GasCells){.n      = {columns, lines, 1},
                      .blocks = {columns / EDGE, lines / EDGE, 1},
                      .shift  = {2, 2, 0},
                      .size   = {1, 1, 1},
                      .many   = {1, 1, 1},
                      .volume = 1,
                      .per    = PER,
                      .near   = near,
                      .all    = near};
  PetscCall(PetscCalloc1(columns, &cells->column));
  PetscCall(SharedCreate(PETSC_COMM_SELF, PETSC_STATIC_ARRAY_LENGTH(blocks), blocks, &cells->of_blocks));
  PetscCall(SharedCreate(PETSC_COMM_SELF, PETSC_STATIC_ARRAY_LENGTH(nodes), nodes, &cells->of_nodes));
  for (PetscInt b = 0; b < near; b++) {
    cells->block[b] = cells->home[b] = b;
    cells->close.mask[b]             = ~(GasMask)0;
  }
  for (PetscInt i = 0; i < columns; i++) cells->column[i] = 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GasCellsFill(GasCells *cells, Cloud cloud, Pressure pressure, PetscBool moved, PetscBool exact)
{
  PetscFunctionBegin;
  for (PetscInt j = 0; j < lines; j++)
    for (PetscInt i = 0; i < columns; i++) cells->filled[GasCellsNode(cells, i, j, 0)] = picture[j][i] != '.';
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Liquid(void)
{
  for (PetscInt j = 0; j < lines; j++) {
    memset(picture[j], '#', columns);
    picture[j][columns] = 0;
  }
}

/* Empties cells i .. i + wide - 1, j .. j + high - 1. */
static void Empty(PetscInt i, PetscInt j, PetscInt wide, PetscInt high)
{
  for (PetscInt y = j; y < j + high; y++) memset(picture[y] + i, '.', (size_t)wide);
}

/* A box of liquid under gas that has not been looked for; what is beyond the top is open. */
static PetscErrorCode Open(PetscInt wide, PetscInt high, const char faces[], Setup *s, Gas **gas)
{
  char options[512];

  PetscFunctionBegin;
  columns = wide;
  lines   = high;
  near    = wide * high / PER;
  PetscCall(
    PetscSNPrintf(options, sizeof(options),
                  "-dimension 2 -spacing 1 -box_lower 0,0 -box_upper %d,%d -box_y wall -box_ymax open -bodies a "
                  "-a_upper 1,1 %s",
                  (int)columns, (int)lines, faces));
  PetscCall(SetupOpen(options, s));
  PetscCall(PetscNew(gas));
  **gas = (Gas){.on = PETSC_TRUE, .ambient = AIR, .start = AIR, .exponent = 1.4, .cloud = s->cloud};
  PetscCall(Grid(&(*gas)->cells[0]));
  PetscCall(Grid(&(*gas)->cells[1]));
  Liquid();
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Close(Setup *s, Gas **gas)
{
  PetscFunctionBegin;
  for (GasCells *cells = (*gas)->cells; cells < (*gas)->cells + 2; cells++) PetscCall(GasCellsDestroy(cells));
  PetscCall(PetscFree(*gas));
  PetscCall(SetupClose(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The pockets of the picture, after those before. */
static PetscErrorCode Next(Gas *gas)
{
  PetscFunctionBegin;
  if (gas->found) GasSwap(gas);
  PetscCall(GasFind(gas, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The pocket around a cell; none: its amount is nan. */
static Pocket At(const Gas *gas, PetscInt i, PetscInt j)
{
  const PetscInt label = gas->now.cells->label[GasCellsNode(gas->now.cells, i, j, 0)];

  return label > 0 ? gas->now.pocket[label] : (Pocket){.amount = NAN};
}

static PetscErrorCode TestChanges(void)
{
  Setup s;
  Gas  *gas;

  PetscFunctionBegin;
  PetscCall(Open(24, 16, "-box_x wall", &s, &gas));
  gas->start = 2 * AIR;
  Empty(2, 2, 4, 2);   /* a pocket of 8 cells */
  Empty(10, 2, 6, 2);  /* of 12 */
  Empty(0, 12, 24, 4); /* the open air */
  Empty(20, 2, 3, 1);  /* too small */
  PetscCall(Next(gas));
  CHECK(gas->now.count == 2 && gas->open && !gas->born, "two pockets and the air at the start");
  CHECK_CLOSE(At(gas, 2, 2).amount, 8 * pow(2, 1 / 1.4), 1e-12, "gas of the pressure at the start");
  CHECK_CLOSE(At(gas, 2, 2).center[0], 4, 1e-12, "centre across");
  CHECK_CLOSE(At(gas, 10, 3).center[1], 3, 1e-12, "centre up");

  gas->start = AIR;
  gas->found = gas->before_known = PETSC_FALSE;
  PetscCall(Next(gas));
  CHECK_CLOSE(At(gas, 10, 2).amount, 12, 1e-12, "gas of the air's pressure at the start");
  gas->now.pocket[1].pressure = 8, gas->now.pocket[2].pressure = 3;
  if (At(gas, 2, 2).pressure != 8) gas->now.pocket[1].pressure = 3, gas->now.pocket[2].pressure = 8;

  memset(picture[2] + 13, '#', 1);
  memset(picture[3] + 13, '#', 1); /* 3 and 2 columns of 6 are left, of 5 cells' width */
  PetscCall(Next(gas));
  CHECK(gas->now.count == 3 && gas->split == 1 && !gas->merged && !gas->ended, "a pocket splits");
  CHECK_CLOSE(At(gas, 10, 2).amount, 12 * 0.6, 1e-12, "the larger part of it");
  CHECK_CLOSE(At(gas, 15, 2).amount, 12 * 0.4, 1e-12, "the smaller part of it");
  CHECK_CLOSE(At(gas, 15, 2).pressure, 3, 1e-12, "a part has the pressure");

  Empty(6, 2, 4, 1);
  PetscCall(Next(gas));
  CHECK(gas->now.count == 2 && gas->merged == 1 && !gas->split, "two pockets merge");
  CHECK_CLOSE(At(gas, 2, 2).amount, 8 + 7.2, 1e-12, "with the gas of both");
  CHECK_CLOSE(At(gas, 2, 2).pressure, (8 * 8 + 6 * 3) / 14., 1e-12, "and the mean pressure");
  CHECK_CLOSE(At(gas, 2, 2).volume, 18, 1e-12, "and the volume that is seen");

  Empty(15, 4, 1, 8);
  PetscCall(Next(gas));
  CHECK(gas->now.count == 1 && gas->ended == 1, "a pocket opens");
  CHECK_CLOSE(gas->vented, 4.8, 1e-12, "all its gas goes");

  memset(picture[2] + 6, '#', 4);
  Empty(3, 4, 1, 8);
  PetscCall(Next(gas));
  CHECK(gas->now.count == 1 && !gas->ended, "a pocket opens in part");
  CHECK_CLOSE(gas->vented, 15.2 * 8 / 14, 1e-12, "the open part's gas goes");
  CHECK_CLOSE(At(gas, 10, 2).amount, 15.2 * 6 / 14, 1e-12, "the other part's stays");

  for (PetscInt j = 4; j < 12; j++) picture[j][3] = '#';
  PetscCall(Next(gas));
  CHECK(gas->now.count == 2 && gas->born == 1, "air is enclosed");
  CHECK_CLOSE(At(gas, 2, 2).amount, 8, 1e-12, "it has the air's pressure");
  CHECK_CLOSE(gas->enclosed, 8, 1e-12, "it is on the account");

  Empty(18, 6, 4, 4);
  PetscCall(Next(gas));
  CHECK(gas->now.count == 3 && At(gas, 18, 6).amount == 0 && !gas->born, "what opens in liquid is a void");
  CHECK_CLOSE(gas->enclosed, 0, 0, "a void has no gas");
  memset(picture[2] + 2, '#', 3);
  memset(picture[3] + 2, '#', 3);
  PetscCall(Next(gas));
  CHECK_CLOSE(At(gas, 5, 2).amount, 8, 1e-12, "a small pocket lasts, with all its gas");
  picture[2][5] = picture[3][5] = '#';
  PetscCall(Next(gas));
  CHECK(gas->ended == 1 && gas->now.count == 2, "a pocket is filled");
  CHECK_CLOSE(gas->lost, 8, 1e-12, "its gas is lost");
  PetscCall(Close(&s, &gas));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Turns the picture's lines about. */
static void Mirror(void)
{
  for (PetscInt j = 0; j < lines; j++)
    for (PetscInt i = 0; i < columns / 2; i++) {
      const char c = picture[j][i];

      picture[j][i]               = picture[j][columns - 1 - i];
      picture[j][columns - 1 - i] = c;
    }
}

/* A pocket that crosses periodic faces is one; of a mirror its image is another. */
static PetscErrorCode TestFaces(void)
{
  const struct {
    const char *faces;
    PetscInt    pockets;
  } cases[] = {{"-box_x periodic", 1}, {"-box_x symmetry", 2}, {"-box_x wall", 2}, {"-box_x open", 0}};

  PetscFunctionBegin;
  for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(cases); k++) {
    Setup s;
    Gas  *gas;

    PetscCall(Open(24, 16, cases[k].faces, &s, &gas));
    Empty(0, 3, 3, 3);
    Empty(columns - 2, 4, 2, 3);
    PetscCall(Next(gas));
    CHECK(gas->now.count == cases[k].pockets && gas->open == (PetscBool)!cases[k].pockets, cases[k].faces);
    if (cases[k].pockets == 1) CHECK_CLOSE(At(gas, 0, 3).volume, 15, 1e-12, "volume across a periodic face");
    PetscCall(Close(&s, &gas));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of more regions than there are pockets the largest have gas, and of equal ones as many as there is room for. */
static PetscErrorCode TestCrowd(void)
{
  Setup    s;
  Gas     *gas;
  PetscInt all = 0, large = 0;

  PetscFunctionBegin;
  PetscCall(Open(COLUMNS, LINES, "-box_x wall -box_ymax wall", &s, &gas));
  for (PetscInt j = 0; j + 1 < lines; j += 4)
    for (PetscInt i = 0; i + 1 < columns; i += 3, all++) Empty(i, j, 2, all % 3 ? 2 : 3);
  PetscCall(Next(gas));
  CHECK(all > GAS_MOST && gas->crowded && gas->now.count == GAS_MOST, "as many pockets as there are places");
  for (PetscInt k = 1; k <= gas->now.count; k++) large += gas->now.pocket[k].amount == 6;
  CHECK(large == (all + 2) / 3, "all of the larger ones");
  PetscCall(Close(&s, &gas));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Pictures that change at random, and the same in a mirror: no gas is lost but by the account, and left is right. */
static PetscErrorCode TestAccount(void)
{
  Setup     s[2];
  Gas      *gas[2];
  PetscReal enclosed[2] = {0, 0}, gone[2] = {0, 0}, worst = 0, apart = 0;
  PetscInt  changes = 0;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < 2; k++) PetscCall(Open(24, 16, "-box_x wall", &s[k], &gas[k]));
  Empty(0, 12, 24, 4);
  for (PetscInt step = 0; step < STEPS; step++) {
    for (PetscInt n = 0; n < 6; n++) { /* lumps of liquid and of nothing */
      const unsigned long long draw = (unsigned long long)(6 * step + n);
      const PetscInt i = (PetscInt)(RandomUnit(1, draw) * (columns - 5)), j = (PetscInt)(RandomUnit(2, draw) * 9);

      if (n % 2)
        Empty(i, j, 2 + n, 2);
      else
        for (PetscInt y = j; y < j + 4; y++) memset(picture[y] + i, '#', 5);
    }
    for (PetscInt k = 0; k < 2; k++) {
      PetscReal left = 0;

      PetscCall(Next(gas[k]));
      for (PetscInt p = 1; p <= gas[k]->now.count; p++) left += gas[k]->now.pocket[p].amount;
      enclosed[k] += gas[k]->enclosed + (step ? 0 : left - gas[k]->enclosed);
      gone[k] += gas[k]->vented + gas[k]->lost;
      worst = PetscMax(worst, PetscAbsReal(enclosed[k] - gone[k] - left));
      changes += gas[k]->split + gas[k]->merged + gas[k]->born + gas[k]->ended;
      Mirror();
    }
    for (PetscInt j = 0; j < lines; j++)
      for (PetscInt i = 0; i < columns; i++) {
        const Pocket one = At(gas[0], i, j), other = At(gas[1], columns - 1 - i, j);

        apart = PetscMax(apart, PetscIsNanReal(one.amount) != PetscIsNanReal(other.amount) ? 1 : 0);
        if (one.amount >= 0) apart = PetscMax(apart, PetscAbsReal(one.amount - other.amount));
      }
  }
  CHECK(changes > STEPS, "pockets split, merge, begin and end");
  CHECK_CLOSE(worst, 0, 1e-9, "all gas is on the account");
  CHECK_CLOSE(apart, 0, 1e-9, "pictures in a mirror have the same pockets");
  for (PetscInt k = 0; k < 2; k++) PetscCall(Close(&s[k], &gas[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(TestChanges());
  PetscCall(TestFaces());
  PetscCall(TestCrowd());
  PetscCall(TestAccount());
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
