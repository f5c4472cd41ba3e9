/* Positions of the fluid particles that bring the summed density to rho_0 everywhere (Kuri et al.: standard deviation
   1e-4 of rho_0), by TAO.

   Minimised over y, the displacement in spacings:
     f = 1/2 sum_a e_a^2 + 1/2 sum_pairs max(0, 1 - r_ab/c)^2,     e_a = V_0 (W(0) + sum_b W_ab) - 1.
   The second sum runs over pairs with a fluid particle; without it particles pair up, which the density alone does not
   prevent. The sum vanishes once all particles are c apart, so it does not keep the density from its goal. Walls and
   images behind periodic and symmetry faces count in both sums. */
#include "packing_impl.h"
#include <petsctao.h>

#define SMALLEST_DISTANCE 1e-6 /* over c: two particles at one point have no direction in which to move apart */
#define REPULSION_MARGIN  1.02 /* c over the smallest distance allowed */
#define NEAR              1.03 /* a distance found in single precision below this may be below c */
#define SLACK             3.0 /* spacings, of the halo during the optimisation: particles move farther than in a step */
#define LIST_MARGIN       0.1 /* spacings by which lists reach beyond the support: they serve for half of it */
#define TRIAL_LIMIT       10  /* spacings that a particle may move in a trial of the line search */
#define TRAVEL_LIMIT      1.5 /* spacings that a particle may move before all migrate to their ranks */

typedef struct {
  Cloud      cloud;
  PetscBool *crowded;             /* [n_fluid] some particle is within the repulsion */
  PetscReal  tolerance, distance; /* the goal: relative; m */
  PetscReal  deviation, closest;  /* at the last evaluation: relative; m, infinite if no two are within the repulsion */
  PetscReal  travelled;           /* largest displacement of a round, m */
  PetscReal  particles;           /* fluid particles of all ranks */
  PetscInt   iterations;          /* of all rounds */
  PetscReal *start, *searched;    /* [n_fluid][3] positions at the start of the round and at the last search, m */
} Optimiser;

/* Largest displacement of the fluid from 'before' ([n_fluid][3], m). */
static PetscErrorCode LargestDisplacement(Cloud cloud, const PetscReal before[], PetscReal *largest)
{
  const PetscReal *x = cloud->field[FIELD_POSITION];

  PetscFunctionBegin;
  *largest = 0;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal r2 = 0;

    for (PetscInt k = DIM * a; k < DIM * (a + 1); k++) r2 += PetscSqr(x[k] - before[k]);
    *largest = PetscMax(*largest, r2);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, largest, 1, MPIU_REAL, MPIU_MAX, cloud->comm));
  *largest = PetscSqrtReal(*largest);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves the fluid to start + d0 y, or sets *too_far if that is farther than TRIAL_LIMIT. The lists of neighbours stay
   while no particle has moved by half their margin. */
static PetscErrorCode MoveFluid(Optimiser *o, Vec y, PetscBool *too_far)
{
  const Cloud      cloud = o->cloud;
  const PetscInt   dim   = cloud->domain->dim;
  PetscReal       *x     = cloud->field[FIELD_POSITION], moved;
  const PetscReal *shift;
  PetscBool        search;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(y, &shift));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    for (PetscInt d = 0; d < dim; d++)
      x[DIM * a + d] = o->start[DIM * a + d] + cloud->domain->spacing * shift[dim * a + d];
  }
  PetscCall(VecRestoreArrayRead(y, &shift));
  PetscCall(LargestDisplacement(cloud, o->start, &o->travelled));
  *too_far = (PetscBool)(o->travelled > TRIAL_LIMIT * cloud->domain->spacing);
  if (*too_far) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(LargestDisplacement(cloud, o->searched, &moved));
  search                  = (PetscBool)(2 * moved > cloud->margin);
  cloud->distance_outside = o->travelled;
  PetscCall(CloudMoved(cloud));
  if (search) PetscCall(CloudSearch(cloud, NULL, NULL));
  if (search) PetscCall(PetscArraycpy(o->searched, cloud->field[FIELD_POSITION], DIM * cloud->n_fluid));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Computes s = r2/h2 of the row of particle a at the present positions, padded to a multiple of SIMD_WIDTH. */
static void LoadDistances(Cloud cloud, PetscInt a, const PetscInt index[], PetscInt n, float s[])
{
  const PetscReal *x = cloud->field[FIELD_POSITION];
  const Simd3      p = Simd3Set(x + DIM * a);
  PetscReal        scale_w, scale_f, inverse_h2;

  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  for (PetscInt k = 0; k < n; k += SIMD_WIDTH) {
    const SimdOffsets at = SimdLocate(index + k);
    const Simd3       d  = Simd3Difference(PETSC_FALSE, Simd3Collect(PETSC_FALSE, x, &at), p);
    const SimdSingle  t  = __builtin_convertvector(inverse_h2 * Simd3Dot(PETSC_FALSE, d, d), SimdSingle);

    (void)memcpy(s + k, &t, sizeof(t));
  }
}

/* Adds the repulsion of particle a to *sum, and to its gradient g (1/m) unless that is NULL; lowers *closest2, r^2 of
   the closest pair of fluid particles (m2). */
static void Repel(Optimiser *o, PetscInt a, PetscReal *sum, PetscReal *closest2, PetscReal g[DIM])
{
  const Cloud      cloud = o->cloud;
  const PetscReal *x = cloud->field[FIELD_POSITION], reach = REPULSION_MARGIN * o->distance;

  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    const PetscInt  b       = cloud->list[k];
    const PetscBool fluid   = (PetscBool)(cloud->integer[INT_LAYER][b] == 0);
    const PetscReal dx[DIM] = {x[DIM * a] - x[DIM * b], x[DIM * a + 1] - x[DIM * b + 1],
                               x[DIM * a + 2] - x[DIM * b + 2]},
                    r2 = Dot(dx, dx), r = PetscMax(PetscSqrtReal(r2), SMALLEST_DISTANCE * reach);

    if (r2 >= reach * reach) continue;
    if (fluid) *closest2 = PetscMin(*closest2, r2);
    /* of a pair of fluid particles the other particle adds its half */
    *sum += (fluid ? 0.5 : 1) * PetscSqr(1 - PetscSqrtReal(r2) / reach);
    for (PetscInt d = 0; d < DIM && g; d++) g[d] -= (1 - r / reach) / (reach * r) * dx[d];
  }
}

/* error: [n_owned] e_a; zero for walls, which do not move and whose density does not count. f: see above. The cloud's
   factors become those of the present positions. */
static PetscErrorCode Errors(Optimiser *o, PetscReal error[], PetscReal *f)
{
  const Cloud cloud   = o->cloud;
  PetscReal   sums[2] = {0, 0}, closest2 = PETSC_MAX_REAL; /* sums of e^2 and of the repulsion */
  PetscReal   scale_w, scale_f, inverse_h2;
  float       s[ROW_CAPACITY + KERNEL_LANES] = {0}, w[ROW_CAPACITY + KERNEL_LANES], slope[ROW_CAPACITY + KERNEL_LANES];

  PetscFunctionBegin;
  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  PetscCall(PetscArrayzero(error, cloud->n_owned));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscInt n   = (PetscInt)(cloud->first[a + 1] - cloud->first[a]);
    float          sum = 0, least = PETSC_MAX_INT;

    LoadDistances(cloud, a, cloud->list + cloud->first[a], n, s);
    KernelSingle(cloud->kernel, n, s, w, slope);
    SIMD_LOOP(reduction(+ : sum) reduction(min : least))
    for (PetscInt k = 0; k < n; k++) {
      sum += w[k];
      least = PetscMin(least, s[k]);
    }
    PetscCall(PetscArraycpy(cloud->slope + cloud->first[a], slope, n));
    error[a] = cloud->domain->volume * (KernelSelf(cloud->kernel) + scale_w * sum) - 1;
    sums[0] += PetscSqr(error[a]);
    o->crowded[a] = (PetscBool)(least < PetscSqr(NEAR * o->distance) * inverse_h2);
    if (o->crowded[a]) Repel(o, a, &sums[1], &closest2, NULL);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPIU_REAL, MPIU_SUM, cloud->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &closest2, 1, MPIU_REAL, MPIU_MIN, cloud->comm));
  o->closest   = closest2 < PETSC_MAX_REAL ? PetscSqrtReal(closest2) : PETSC_INFINITY;
  o->deviation = PetscSqrtReal(sums[0] / o->particles);
  *f           = 0.5 * (sums[0] + sums[1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* df/dx_a = V_0 sum_b (e_a + e_b) grad_a W_ab - 1/c sum_b (1 - r_ab/c) r_ab/|r_ab|, also of a pair of a particle and
   its image: they move alike. */
static PetscErrorCode Gradient(Optimiser *o, const PetscReal error[], Vec gradient)
{
  const Cloud      cloud = o->cloud;
  const PetscInt   dim   = cloud->domain->dim;
  const PetscReal *x     = cloud->field[FIELD_POSITION];
  const Simd       zero  = SimdSet(0);
  PetscReal        scale_w, scale_f, inverse_h2, unused[2] = {0, 0}, *g;
  PairRow          row;

  PetscFunctionBegin;
  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  PetscCall(VecGetArrayWrite(gradient, &g));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const Simd3 p   = Simd3Set(x + DIM * a);
    const Simd  own = SimdSet(error[a]);
    Simd3       sum = {zero, zero, zero};
    PetscReal   all[DIM];

    PairRowLoadFactors(cloud, a, &row);
    for (PetscInt k = 0; k < row.n; k += SIMD_WIDTH) {
      const SimdOffsets at = SimdLocate(row.index + k);

      Simd3Add(PETSC_FALSE, &sum, (own + SimdGather(error, row.index + k)) * SimdLoad(row.f + k),
               Simd3Difference(PETSC_FALSE, p, Simd3Collect(PETSC_FALSE, x, &at)));
    }
    Vec4Store(cloud->domain->volume * scale_f * Simd3Sum(sum, zero), all);
    if (o->crowded[a]) Repel(o, a, &unused[0], &unused[1], all);
    for (PetscInt d = 0; d < dim; d++) g[dim * a + d] = cloud->domain->spacing * all[d];
  }
  PetscCall(VecRestoreArrayWrite(gradient, &g));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Evaluate(Tao tao, Vec y, PetscReal *f, Vec gradient, void *context)
{
  Optimiser *o = (Optimiser *)context;
  PetscBool  too_far;
  PetscReal *error;

  PetscFunctionBegin;
  PetscCall(MoveFluid(o, y, &too_far));
  if (too_far) { /* Close to the goal rounding dominates the gradient, and a trial may move particles far out of the
                    box. */
    *f = PETSC_INFINITY; /* so that the line search takes a shorter step */
    PetscCall(VecSet(gradient, 0));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(CloudGetWork(o->cloud, 1, &error));
  PetscCall(Errors(o, error, f));
  PetscCall(CloudUpdateArray(o->cloud, 1, PARITY_SCALAR, error));
  PetscCall(Gradient(o, error, gradient));
  PetscCall(CloudRestoreWork(o->cloud, &error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Stops at the goal, and when particles have moved so far that they must migrate first. */
static PetscErrorCode Converged(Tao tao, void *context)
{
  Optimiser *o = (Optimiser *)context;

  PetscFunctionBegin;
  PetscCall(ProgressWork(o->cloud->comm, -1,
                         "iteration %4" PetscInt_FMT
                         "  relative density deviation %.2e, goal %.1e  closest %.2f spacings",
                         o->iterations++, (double)o->deviation, (double)o->tolerance,
                         (double)(o->closest / o->cloud->domain->spacing)));
  PetscCall(TaoDefaultConvergenceTest(tao, NULL));
  if (o->travelled > TRAVEL_LIMIT * o->cloud->domain->spacing)
    PetscCall(TaoSetConvergedReason(tao, TAO_DIVERGED_USER));
  else if (o->deviation <= o->tolerance && o->closest >= o->distance)
    PetscCall(TaoSetConvergedReason(tao, TAO_CONVERGED_USER));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One round: TAO from the present positions until it stops. The swarm gets the result. Counts the remaining iterations
   down. */
static PetscErrorCode Round(Optimiser *o, PetscInt *remaining, PetscInt *done, TaoConvergedReason *reason)
{
  const Cloud    cloud = o->cloud;
  const PetscInt size  = DIM * cloud->n_fluid;
  PetscInt       lost  = 0, limit;
  PetscReal      f;
  Tao            tao;
  Vec            y, gradient;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(size, &o->start, size, &o->searched, cloud->n_fluid, &o->crowded));
  PetscCall(PetscArraycpy(o->start, cloud->field[FIELD_POSITION], size));
  PetscCall(PetscArraycpy(o->searched, o->start, size));
  PetscCall(VecCreateMPI(cloud->comm, cloud->domain->dim * cloud->n_fluid, PETSC_DETERMINE, &y));
  PetscCall(VecDuplicate(y, &gradient));
  PetscCall(TaoCreate(cloud->comm, &tao));
  PetscCall(TaoSetType(tao, TAOLMVM));
  PetscCall(TaoSetOptionsPrefix(tao, "packing_"));
  PetscCall(TaoSetSolution(tao, y));
  PetscCall(TaoSetObjectiveAndGradient(tao, gradient, Evaluate, o));
  PetscCall(TaoSetConvergenceTest(tao, Converged, o));
  PetscCall(TaoSetFromOptions(tao));
  PetscCall(TaoGetMaximumIterations(tao, &limit));
  *remaining = *remaining < 0 ? limit : *remaining;
  PetscCall(TaoSetMaximumIterations(tao, *remaining));
  PetscCall(TaoSolve(tao));
  PetscCall(TaoGetConvergedReason(tao, reason));
  PetscCall(TaoGetIterationNumber(tao, done));
  *remaining -= *done;
  PetscCall(Evaluate(tao, y, &f, gradient, o)); /* the last trial need not be the best */
  PetscCall(
    PetscInfo(tao, "packing: %" PetscInt_FMT " iterations, %s, density deviation %g, smallest distance %g spacings\n",
              *done, TaoConvergedReasons[*reason], (double)o->deviation,
              (double)(o->closest / cloud->domain->spacing)));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) DomainConfine(cloud->domain, cloud->field[FIELD_POSITION] + DIM * a);
  PetscCall(CloudCommit(cloud, &lost, NULL));
  PetscCall(CloudResync(cloud));
  PetscCall(TaoDestroy(&tao));
  PetscCall(VecDestroy(&y));
  PetscCall(VecDestroy(&gradient));
  PetscCall(PetscFree3(o->start, o->searched, o->crowded));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PackingOptimise(Cloud cloud, PackingTarget *target)
{
  Optimiser          o         = {.cloud = cloud, .tolerance = target->tolerance};
  const PetscReal    slack     = cloud->slack;
  PetscInt           remaining = -1, done, particles;
  TaoConvergedReason reason;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(&cloud->n_fluid, &particles, 1, MPIU_INT, MPI_SUM, cloud->comm));
  o.particles = (PetscReal)particles;
  ProgressBegin("the optimisation of the packing", "no step was computed");
  o.distance         = target->distance * cloud->domain->spacing;
  target->iterations = 0;
  PetscCall(CloudCheckUnknowns(cloud->comm, cloud->n_fluid, cloud->domain->dim, "the packing (-packing_type)"));
  cloud->slack  = PetscMax(slack, SLACK * cloud->domain->spacing);
  cloud->margin = LIST_MARGIN * cloud->domain->spacing;
  PetscCall(CloudResync(cloud));
  do { /* after a failed line search, try again without the memory of LMVM */
    PetscCall(Round(&o, &remaining, &done, &reason));
    target->iterations += done;
  } while (done > 0 && remaining > 0 && (reason == TAO_DIVERGED_USER || reason == TAO_DIVERGED_LS_FAILURE));
  cloud->slack      = slack; /* the caller's CloudResync builds a halo for it */
  cloud->margin     = 0;
  target->deviation = o.deviation;
  PetscFunctionReturn(PETSC_SUCCESS);
}
