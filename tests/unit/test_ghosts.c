/* When ghosts are chosen anew and what they then have, on two particles that approach each other through a periodic
   face; what a step gives back to the swarm; how far particles are outside their rank's cells; a
   piece over all ranks. Runs on any number of ranks. */
#include "../../src/neighbors/halo.h"
#include "setup.h"
#include "check.h"

#define SPACING 0.1
#define PERIODIC                                                                                                       \
  "-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 2,2 -box_x periodic -bodies a -sort_interval "                  \
  "1000 "
/* The kernel's support is 0.26 m, the slack 0.1 m, so that of the one at 0.365 m there is no ghost behind the upper
   face at first. Each goes 0.06 m towards the other. */
#define LEFT  0.365
#define RIGHT 1.995
#define WAY   0.06

static PetscErrorCode Open(Setup *s)
{
  const PetscReal x[] = {LEFT, 1, 0, RIGHT, 1, 0};

  PetscFunctionBegin;
  PetscCall(SetupFill(PERIODIC, 2, x, 0, s));
  CHECK_CLOSE(s->cloud->slack, SPACING, 1e-15, "halo_slack");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves the two by a share of their way. */
static void Approach(Cloud cloud, PetscReal share)
{
  for (PetscInt a = 0; a < cloud->n_owned; a++)
    cloud->field[FIELD_POSITION][DIM * a] += (cloud->integer[INT_ID][a] ? WAY : -WAY) * share;
}

/* How many of the two see the other one. */
static PetscErrorCode Seen(Cloud cloud, PetscReal *count)
{
  PetscFunctionBegin;
  PetscCall(CloudSearch(cloud, NULL, NULL));
  *count = SetupSum((PetscReal)cloud->first[cloud->n_owned]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Within a step: the ghosts are chosen anew and have the intermediate velocity too. */
static PetscErrorCode TestWithin(void)
{
  PetscReal seen, wrong = 0;
  Setup     s;

  PetscFunctionBegin;
  PetscCall(Open(&s));
  PetscCall(CloudBegin(s.cloud));
  PetscCall(Seen(s.cloud, &seen));
  CHECK_CLOSE(seen, 0, 0, "far_apart");
  for (PetscInt a = 0; a < s.cloud->n_total; a++)
    for (PetscInt d = 0; d < DIM; d++)
      s.cloud->field[FIELD_VELOCITY_STAR][DIM * a + d] = a < s.cloud->n_owned ? 7 + s.cloud->integer[INT_ID][a] : NAN;
  Approach(s.cloud, 1);
  PetscCall(CloudMoved(s.cloud));
  PetscCall(Seen(s.cloud, &seen));
  CHECK_CLOSE(seen, 2, 0, "close_within_a_step");
  for (PetscInt a = 0; a < s.cloud->n_total; a++)
    for (PetscInt d = 0; d < DIM; d++)
      wrong += s.cloud->field[FIELD_VELOCITY_STAR][DIM * a + d] != 7 + s.cloud->integer[INT_ID][a];
  CHECK_CLOSE(SetupSum(wrong), 0, 0, "ghosts_have_the_intermediate_velocity");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* From step to step: at the start of the third one the ghosts are chosen anew. Flags and positions of an accepted step
   are in the swarm; at last the particles are wrapped into the box. */
static PetscErrorCode TestBetween(void)
{
  PetscReal      seen, flags = 0, outside = 0;
  PetscInt       lost = 0;
  ParticleArrays arrays;
  Setup          s;

  PetscFunctionBegin;
  PetscCall(Open(&s));
  for (PetscInt k = 0; k < 2; k++) {
    PetscCall(CloudBegin(s.cloud));
    Approach(s.cloud, 0.5); /* the last thing that a step does */
    for (PetscInt a = 0; a < s.cloud->n_owned; a++) s.cloud->integer[INT_SURFACE][a] = 2 - k;
    PetscCall(CloudCommit(s.cloud, &lost, NULL));
  }
  PetscCall(ParticlesOpen(s.particles, &arrays));
  for (PetscInt a = 0; a < arrays.n; a++) flags += arrays.integer[INT_SURFACE][a] == 1;
  PetscCall(ParticlesClose(s.particles, &arrays));
  CHECK_CLOSE(SetupSum(flags), 2, 0, "flags_of_a_step_are_kept");
  PetscCall(CloudBegin(s.cloud));
  PetscCall(Seen(s.cloud, &seen));
  CHECK_CLOSE(seen, 2, 0, "close_after_two_steps");
  PetscCall(CloudResync(s.cloud));
  for (PetscInt a = 0; a < s.cloud->n_owned; a++) {
    const PetscReal due = s.cloud->integer[INT_ID][a] ? RIGHT + WAY - 2 : LEFT - WAY;

    outside = PetscMax(outside, PetscAbsReal(s.cloud->field[FIELD_POSITION][DIM * a] - due));
  }
  CHECK_CLOSE(SetupMax(outside), 0, 1e-12, "wrapped_into_the_box");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The lower half of the cells along x is of rank 0, the upper half of rank 1: how far points are outside. */
static PetscErrorCode TestOutside(void)
{
  const PetscReal inside[] = {0.3, 1, 0}, far[] = {1.5, 1, 0}, behind[] = {-0.02, 1, 0};
  PetscMPIInt    *cells;
  Domain          domain;
  Setup           s;

  PetscFunctionBegin;
  PetscCall(Open(&s));
  domain = s.domain;
  PetscCall(PetscMalloc1(domain->cells[0] * domain->cells[1], &cells));
  for (PetscInt c = 0; c < domain->cells[0] * domain->cells[1]; c++) {
    cells[c]             = domain->cell_rank[c];
    domain->cell_rank[c] = 2 * (c % domain->cells[0]) >= domain->cells[0];
  }
  {
    const PetscReal edge   = domain->cell_size[0] * ((domain->cells[0] + 1) / 2);
    const PetscReal past[] = {edge + 0.04, 1, 0};

    CHECK_CLOSE(HaloDistanceOutside(domain, 0, 1, inside, 0.2), 0, 0, "inside_its_rank");
    CHECK_CLOSE(HaloDistanceOutside(domain, 0, 1, past, 0.2), 0.04, 1e-12, "outside_its_rank");
    CHECK_CLOSE(HaloDistanceOutside(domain, 0, 1, far, 0.2), 0.2, 1e-12, "far_outside_its_rank");
    CHECK_CLOSE(HaloDistanceOutside(domain, 0, 1, behind, 0.2), 0.02, 1e-12, "outside_a_periodic_face");
  }
  for (PetscInt c = 0; c < domain->cells[0] * domain->cells[1]; c++) domain->cell_rank[c] = cells[c];
  PetscCall(PetscFree(cells));
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All particles on one of the ranks: it has as many times its share as there are ranks. */
static PetscErrorCode TestImbalance(void)
{
  PetscMPIInt rank, size;
  PetscReal   imbalance;
  Setup       s;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(SetupOpen(PERIODIC, &s));
  PetscCall(ParticlesAppend(s.particles, rank ? 0 : 100));
  PetscCall(ParticlesImbalance(s.particles, &imbalance));
  CHECK_CLOSE(imbalance, size, 1e-15, "imbalance");
  PetscCall(SetupClose(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One thread that winds through the box, over the parts of all ranks again and again, is one piece; cut once, two. */
static PetscErrorCode TestWinding(void)
{
  const PetscInt   long_rows = 10, length = 36;
  static PetscReal x[DIM * 400];

  PetscFunctionBegin;
  for (PetscInt cut = 0; cut < 2; cut++) {
    PetscInt   n = 0, *parent;
    PetscReal *least, wrong = 0;
    Setup      s;

    for (PetscInt row = 0; row < long_rows; row++)
      for (PetscInt k = 0; k < length + 3; k++) { /* to the right and back, and 4 spacings up at the end of each */
        const PetscReal along = k < length ? k : length - 1, at = row % 2 ? length - 1 - along : along;

        if (row == long_rows - 1 && k >= length) continue;
        if (cut && row == 5 && k == length / 2) continue;
        x[DIM * n]     = at - 0.5 * (length - 1);
        x[DIM * n + 1] = 4 * row - 18 + (k < length ? 0 : k - length + 1);
        x[DIM * n + 2] = 0;
        n++;
      }
    PetscCall(SetupFill("-dimension 2 -spacing 1 -box_lower -20,-20 -box_upper 20,20 -bodies a ", n, x, 0, &s));
    PetscCall(PetscMalloc2(s.cloud->n_total, &parent, s.cloud->n_total, &least));
    OperatorsConnect(s.cloud, 1.3, parent);
    for (PetscInt a = 0; a < s.cloud->n_fluid; a++) least[a] = s.cloud->integer[INT_ID][a];
    PetscCall(OperatorsComponentMinimum(s.cloud, parent, 1, least));
    for (PetscInt a = 0; a < s.cloud->n_fluid; a++)
      wrong += (least[a] == 0) != (!cut || s.cloud->integer[INT_ID][a] < 5 * (length + 3) + length / 2);
    CHECK_CLOSE(SetupSum(wrong), 0, 0, cut ? "a_thread_that_is_cut" : "a_winding_thread_is_one_piece");
    PetscCall(PetscFree2(parent, least));
    PetscCall(SetupClose(&s));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCall(LogRegister());
  PetscCall(TestWithin());
  PetscCall(TestBetween());
  PetscCall(TestOutside());
  PetscCall(TestImbalance());
  PetscCall(TestWinding());
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscFinalize());
  return CHECK_DONE();
}
