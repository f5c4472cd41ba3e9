/* Particle shifting. Plain: every particle for itself, in one pass. Conserved (-shifting_conserved): whatever a
   particle gains its neighbours lose, so that the centre of mass, momentum and angular momentum stay; in the drop
   impact at 0.5 mm that costs about 5 % of the kinetic energy at 5 ms. Speeds and gradient are those that the source of
   the pressure has summed already, of the velocity before the pressure: a pass over the pairs less. */
#include "../neighbors/pairs.h"
#include "stepper_impl.h"

#define SHIFT FIELD_WORK3 /* dr */
#define SHARE FIELD_WORK1 /* see OperatorsCompensationWeights */

/* dr_a = -A h dt max_b|v_b - v_a| sum V (1 + 0.2 (W/W(d0))^4) grad W (Skillen et al. 2013, Lind et al. 2012), at most
   'cap' spacings; particles on or near the surface lose the component along sum V grad W. */
static void Wish(Stepper stepper, PetscReal dt, PetscInt a, PetscReal dr[DIM])
{
  Cloud            cloud  = stepper->cloud;
  const PetscReal *normal = cloud->field[FIELD_NORMAL] + DIM * a, *crowding = cloud->field[FIELD_CROWDING] + DIM * a;
  const PetscReal  cap   = stepper->shifting_cap * cloud->domain->spacing,
                  factor = -stepper->shifting_strength * KernelSmoothingLength(cloud->kernel) * dt *
                           cloud->field[FIELD_VELOCITY_JUMP][a];
  PetscReal length;

  for (PetscInt d = 0; d < DIM; d++) dr[d] = factor * crowding[d];
  if (cloud->integer[INT_SURFACE][a]) {
    const PetscReal n2 = Dot(normal, normal), share = n2 > 0 ? Dot(dr, normal) / n2 : 0;

    for (PetscInt d = 0; d < DIM; d++) dr[d] -= share * normal[d];
  }
  length = Norm(dr);
  if (length > cap)
    for (PetscInt d = 0; d < DIM; d++) dr[d] *= cap / length;
}

/* Pass 1: what each particle wants. */
static PetscErrorCode Wishes(Stepper stepper, PetscReal dt)
{
  Cloud cloud = stepper->cloud;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    PetscReal *dr = cloud->field[SHIFT] + DIM * a;

    dr[0] = dr[1] = dr[2] = 0;
    if (a < cloud->n_fluid && cloud->field[SHARE][a] > 0) Wish(stepper, dt, a, dr);
  }
  PetscCall(CloudUpdate(cloud, SHIFT));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The first Taylor term of the velocity, (dr . B grad) u, of the fluid around a. */
static void Taylor(Cloud cloud, PetscInt a, const PetscReal dr[DIM], PetscReal change[DIM])
{
  const PetscReal *G = cloud->field[FIELD_GRADIENT] + DIM * DIM * a;
  PetscReal        along[DIM];

  TensorApply(cloud->field[FIELD_CORRECTION] + 6 * a, dr[0], dr[1], dr[2], along);
  for (PetscInt d = 0; d < DIM; d++) change[d] = Dot(G + DIM * d, along);
}

/* Pass 2: the displacement dr_a - sum_b s_b W_ab dr_b, s the shares, so that the mass moved has no sum, is added to x;
   the change of the velocity goes to change. */
static PetscErrorCode Displace(Stepper stepper, PetscReal x[], PetscReal change[])
{
  Cloud            cloud = stepper->cloud;
  const PetscReal *wish = cloud->field[SHIFT], *share = cloud->field[SHARE];
  PairRow          pairs;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal sx = wish[3 * a], sy = wish[3 * a + 1], sz = wish[3 * a + 2];

    PairRowLoad(cloud, cloud->field[FIELD_POSITION], a, &pairs);
    KernelEvaluate(cloud->kernel, pairs.n, pairs.r2, pairs.W, NULL);
    SIMD_LOOP(reduction(- : sx, sy, sz))
    for (PetscInt k = 0; k < pairs.n; k++) {
      const PetscInt  b = pairs.index[k];
      const PetscReal w = pairs.W[k] * share[b]; /* walls have none */

      sx -= w * wish[3 * b];
      sy -= w * wish[3 * b + 1];
      sz -= w * wish[3 * b + 2];
    }
    {
      const PetscReal dr[DIM] = {sx, sy, sz};

      Taylor(cloud, a, dr, change + DIM * a);
      for (PetscInt d = 0; d < DIM; d++) {
        x[DIM * a + d] += dr[d];
        if (share[a] <= 0) change[DIM * a + d] = 0;
      }
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Every particle for itself: one pass. */
static PetscErrorCode ShiftPlain(Stepper stepper, PetscReal dt, PetscReal x[], PetscReal change[])
{
  Cloud cloud = stepper->cloud;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    PetscReal dr[DIM];

    for (PetscInt d = 0; d < DIM; d++) change[DIM * a + d] = 0;
    if (cloud->field[FIELD_LAMBDA][a] <= SPRAY_LAMBDA) continue;
    Wish(stepper, dt, a, dr);
    Taylor(cloud, a, dr, change + DIM * a);
    for (PetscInt d = 0; d < DIM; d++) x[DIM * a + d] += dr[d];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Shift(Stepper stepper, PetscReal dt)
{
  Cloud      cloud  = stepper->cloud;
  PetscReal *change = cloud->field[FIELD_ACCELERATION], *u = cloud->field[FIELD_VELOCITY_STAR],
            *v = cloud->field[FIELD_VELOCITY], *x = cloud->field[FIELD_START];

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_SHIFT), 0, 0, 0, 0));
  if (stepper->shifting_conserved) {
    PetscCall(CloudUpdate(cloud, FIELD_VELOCITY_STAR));
    PetscCall(OperatorsCompensationWeights(cloud));
    PetscCall(Wishes(stepper, dt));
    PetscCall(Displace(stepper, x, change));
    PetscCall(CloudUpdate(cloud, FIELD_START));
    PetscCall(OperatorsCompensate(cloud, x, u, change));
  } else
    PetscCall(ShiftPlain(stepper, dt, x, change));
  for (PetscInt k = 0; k < DIM * cloud->n_fluid; k++) v[k] = u[k] + change[k];
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_SHIFT), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
