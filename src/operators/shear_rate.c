/* The viscosity of liquids with a viscosity that depends on the shear rate. */
#include "../neighbors/pairs.h"
#include "operators.h"

#define CURVE_MINIMUM 0.02 /* fraction of the squares that a linear fit must leave to the quadratic term */

void OperatorsDepths(Cloud cloud, PetscReal depth[])
{
  for (PetscInt a = 0; a < cloud->n_total; a++)
    depth[a] = cloud->integer[INT_BODY][a] <= BODY_SOLID
                 ? PetscMax(0, -SceneSolidDistance(cloud->scene, cloud->field[FIELD_POSITION] + DIM * a, NULL))
                 : 0;
}

PetscReal OperatorsWallFraction(Cloud cloud, PetscInt a, PetscInt b, const PetscReal depth[])
{
  const Domain     domain = cloud->domain;
  const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, *y = cloud->field[FIELD_POSITION] + DIM * b,
                  closest = WALL_CLOSEST * domain->spacing * cloud->size[a];
  PetscReal fraction      = 1;

  if (cloud->integer[INT_BODY][b] <= BODY_SOLID) {
    const PetscReal distance = PetscMax(closest, SceneSolidDistance(cloud->scene, x, NULL));

    return distance / (distance + depth[b]);
  }
  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt side = 0; side < 2; side++) {
      const PetscReal sign = side ? 1 : -1, face = side ? domain->upper[d] : domain->lower[d],
                      distance = PetscMax(closest, sign * (face - x[d])), beyond = sign * (y[d] - face);

      if (domain->face[d][side] == FACE_WALL && beyond > 0)
        fraction = PetscMin(fraction, distance / (distance + beyond));
    }
  return fraction;
}

/* The points around a particle that fit the velocity gradient: its neighbours. With no slip, a dummy particle stands
   for the point of the wall's face in front of it, where the liquid has the wall's velocity. */
typedef struct {
  PairRow   row;                  /* f: times V, so that sums are of order one */
  PetscReal d[ROW_CAPACITY][DIM]; /* m, from the point to the particle */
  PetscReal wall[DIM];            /* unit normal out of the wall; zero without a wall */
} FitPoints;

static void FindFitPoints(Cloud cloud, const Viscosity *viscosity, PetscInt a, const PetscReal depth[], PetscReal scale,
                          FitPoints *points)
{
  const PetscReal *x      = cloud->field[FIELD_POSITION] + DIM * a;
  PairRow         *row    = &points->row;
  PetscReal        n[DIM] = {0, 0, 0}, size;

  PairRowLoadFactors(cloud, a, row);
  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt   b        = row->index[k];
    const PetscReal *y        = cloud->field[FIELD_POSITION] + DIM * b;
    const PetscBool  wall     = (PetscBool)(viscosity->no_slip && cloud->integer[INT_LAYER][b]);
    const PetscReal  fraction = wall ? OperatorsWallFraction(cloud, a, b, depth) : 1;

    row->f[k] *= scale;
    for (PetscInt i = 0; i < DIM; i++) {
      points->d[k][i] = fraction * (x[i] - y[i]);
      if (wall) n[i] += points->d[k][i];
    }
  }
  size = Norm(n);
  for (PetscInt i = 0; i < DIM; i++) points->wall[i] = size > 0 ? n[i] / size : 0;
}

/* The velocity gradient L_ij (1/s) of fluid particle a, a least squares fit. It is exact for a linear velocity. Next to
   a wall it is exact for a velocity quadratic in the distance from the wall: there the shear rate is largest, and all
   neighbours of the first layer lie to one side. With too few neighbours the fit has no correction, and L is small.
   A ring also grows at the rate v_r/r; on the axis this is the slope of v_r. */
static void FitGradient(Cloud cloud, PetscInt a, const FitPoints *points, PetscReal L[DIM][DIM])
{
  const PetscReal *v           = cloud->field[FIELD_VELOCITY] + DIM * a;
  const PairRow   *row         = &points->row;
  PetscReal        G[DIM][DIM] = {{0}}, M[6] = {0}, B[6] = {1, 1, 1, 0, 0, 0}, cross[DIM] = {0, 0, 0}, along[DIM];
  PetscReal        square = 0, curved[DIM] = {0, 0, 0}; /* sums of the quadratic term */

  for (PetscInt k = 0; k < row->n; k++) {
    const PetscReal *u = cloud->field[FIELD_VELOCITY] + DIM * row->index[k], *d = points->d[k], f = row->f[k],
                    q = PetscSqr(Dot(d, points->wall)) / cloud->domain->spacing;

    for (PetscInt i = 0; i < DIM; i++) {
      for (PetscInt j = 0; j < DIM; j++) G[i][j] += f * (u[i] - v[i]) * d[j];
      M[i] -= f * d[i] * d[i];
      cross[i] -= f * q * d[i];
      curved[i] += f * (u[i] - v[i]) * q;
    }
    M[3] -= f * d[0] * d[1];
    M[4] -= f * d[0] * d[2];
    M[5] -= f * d[1] * d[2];
    square -= f * q * q;
  }
  if (SymmetricSmallestEigenvalue(cloud->domain->dim, M) > MOMENT_MINIMUM) SymmetricInverse(cloud->domain->dim, M, B);
  TensorApply(B, cross[0], cross[1], cross[2], along);
  for (PetscInt i = 0; i < DIM; i++) {
    const PetscReal left = square - Dot(cross, along), curve = (curved[i] - Dot(G[i], along)) / left;

    if (left > CURVE_MINIMUM * square)
      for (PetscInt j = 0; j < DIM; j++) G[i][j] -= curve * cross[j];
    TensorApply(B, G[i][0], G[i][1], G[i][2], L[i]);
  }
  if (cloud->domain->rings) {
    const PetscReal r = cloud->field[FIELD_POSITION][DIM * a];

    L[2][2] = r > cloud->domain->spacing * cloud->size[a] ? v[0] / r : L[0][0];
  }
}

PetscReal OperatorsShearRate(const PetscReal L[DIM][DIM])
{
  PetscReal sum = 0;

  for (PetscInt i = 0; i < DIM; i++)
    for (PetscInt j = 0; j < DIM; j++) sum += 0.5 * PetscSqr(L[i][j] + L[j][i]);
  return PetscSqrtReal(sum);
}

PetscErrorCode OperatorsApparentViscosity(Cloud cloud, const Viscosity *viscosity)
{
  PetscReal *depth, scale_w, scale_f, inverse_h2;
  FitPoints  points;

  PetscFunctionBegin;
  if (!cloud->field[FIELD_VISCOSITY]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_VISCOSITY), 0, 0, 0, 0));
  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  PetscCall(CloudGetWork(cloud, 1, &depth));
  OperatorsDepths(cloud, depth);
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    const PetscInt body = cloud->integer[INT_BODY][a];
    PetscReal      L[DIM][DIM], *mu = cloud->field[FIELD_VISCOSITY] + a;

    *mu = body < 0 ? 0 : BodyMaterial(SceneBody(cloud->scene, body))->viscosity;
    if (body < 0 || !BodyViscosityVaries(SceneBody(cloud->scene, body))) continue;
    FindFitPoints(cloud, viscosity, a, depth, cloud->domain->volume * scale_f, &points);
    FitGradient(cloud, a, &points, L);
    *mu = BodyViscosity(SceneBody(cloud->scene, body), OperatorsShearRate(L));
  }
  PetscCall(CloudRestoreWork(cloud, &depth));
  PetscCall(CloudUpdate(cloud, FIELD_VISCOSITY));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_VISCOSITY), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OperatorsVelocityGradient(Cloud cloud, const Viscosity *viscosity, PetscReal L[])
{
  PetscReal *depth, scale_w, scale_f, inverse_h2;
  FitPoints  points;

  PetscFunctionBegin;
  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  PetscCall(CloudGetWork(cloud, 1, &depth));
  OperatorsDepths(cloud, depth);
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    FindFitPoints(cloud, viscosity, a, depth, cloud->domain->volume * scale_f, &points);
    FitGradient(cloud, a, &points, (PetscReal(*)[DIM])(L + DIM * DIM * a));
  }
  PetscCall(CloudRestoreWork(cloud, &depth));
  PetscFunctionReturn(PETSC_SUCCESS);
}
