/* The viscosity of liquids in which it depends on the shear rate. */
#include "../neighbors/pairs.h"
#include "operators.h"

#define CURVE_MINIMUM 0.02 /* share of the squares that a linear fit must leave to the quadratic part */

/* How deep each dummy particle of a solid is inside it, m; 0 for all others. */
static void FindDepths(Cloud cloud, PetscReal depth[])
{
  for (PetscInt a = 0; a < cloud->n_total; a++)
    depth[a] = cloud->integer[INT_BODY][a] <= BODY_SOLID
                 ? PetscMax(0, -SceneSolidDistance(cloud->scene, cloud->field[FIELD_POSITION] + DIM * a, NULL))
                 : 0;
}

/* How much of the way from fluid particle a at x to dummy particle b is in front of the wall's face. A particle that is
   very near the face counts as a little farther away, as it does in the wall's friction. */
static PetscReal ShareInFront(Cloud cloud, const PetscReal x[DIM], PetscInt b, const PetscReal depth[])
{
  const Domain     domain = cloud->domain;
  const PetscReal *y = cloud->field[FIELD_POSITION] + DIM * b, closest = WALL_CLOSEST * domain->spacing;
  PetscReal        share = 1;

  if (cloud->integer[INT_BODY][b] <= BODY_SOLID) {
    const PetscReal distance = PetscMax(closest, SceneSolidDistance(cloud->scene, x, NULL));

    return distance / (distance + depth[b]);
  }
  for (PetscInt d = 0; d < domain->dim; d++)
    for (PetscInt side = 0; side < 2; side++) {
      const PetscReal sign = side ? 1 : -1, face = side ? domain->upper[d] : domain->lower[d],
                      distance = PetscMax(closest, sign * (face - x[d])), beyond = sign * (y[d] - face);

      if (domain->face[d][side] == FACE_WALL && beyond > 0) share = PetscMin(share, distance / (distance + beyond));
    }
  return share;
}

/* The neighbours of a particle as places d (m, from them to it) at which the velocity differs from its own: the dummy
   particles of walls stand for the points of the face on the way to them, where the liquid has the wall's velocity if
   it does not slip. */
typedef struct {
  PairRow   row; /* f: times V, so that sums are of the order of one */
  PetscReal d[ROW_CAPACITY][DIM];
  PetscReal wall[DIM]; /* unit vector out of the wall, zero where there is none */
} Places;

static void FindPlaces(Cloud cloud, const Viscosity *viscosity, PetscInt a, const PetscReal depth[], PetscReal scale,
                       Places *places)
{
  const PetscReal *x      = cloud->field[FIELD_POSITION] + DIM * a;
  PairRow         *row    = &places->row;
  PetscReal        n[DIM] = {0, 0, 0}, size;

  PairRowLoadFactors(cloud, a, row);
  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt   b     = row->index[k];
    const PetscReal *y     = cloud->field[FIELD_POSITION] + DIM * b;
    const PetscBool  wall  = (PetscBool)(viscosity->no_slip && cloud->integer[INT_LAYER][b]);
    const PetscReal  share = wall ? ShareInFront(cloud, x, b, depth) : 1;

    row->f[k] *= scale;
    for (PetscInt i = 0; i < DIM; i++) {
      places->d[k][i] = share * (x[i] - y[i]);
      if (wall) n[i] += places->d[k][i];
    }
  }
  size = Norm(n);
  for (PetscInt i = 0; i < DIM; i++) places->wall[i] = size > 0 ? n[i] / size : 0;
}

/* The velocity gradient L_ij (1/s) of fluid particle a: the least squares fit to its neighbours, exact for a velocity
   that is linear, and next to a wall for one that is quadratic away from it: there the neighbours of the first layer
   are all to one side, and the shear rate is largest. With few neighbours there is no correction, and L is small. */
static void FitGradient(Cloud cloud, PetscInt a, const Places *places, PetscReal L[DIM][DIM])
{
  const PetscReal *v           = cloud->field[FIELD_VELOCITY] + DIM * a;
  const PairRow   *row         = &places->row;
  PetscReal        G[DIM][DIM] = {{0}}, M[6] = {0}, B[6] = {1, 1, 1, 0, 0, 0}, cross[DIM] = {0, 0, 0}, along[DIM];
  PetscReal        square = 0, curved[DIM] = {0, 0, 0}; /* the quadratic part's own sums */

  for (PetscInt k = 0; k < row->n; k++) {
    const PetscReal *u = cloud->field[FIELD_VELOCITY] + DIM * row->index[k], *d = places->d[k], f = row->f[k],
                    q = PetscSqr(Dot(d, places->wall)) / cloud->domain->spacing;

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
}

/* sqrt(2 D:D) of a velocity gradient, 1/s. A ring also grows, at the rate v_r/r; on the axis that is the slope of v_r.
 */
static PetscReal ShearRate(Domain domain, const PetscReal x[DIM], const PetscReal v[DIM], const PetscReal L[DIM][DIM])
{
  const PetscReal hoop = !domain->rings ? 0 : x[0] > domain->spacing ? v[0] / x[0] : L[0][0];
  PetscReal       sum  = 2 * hoop * hoop;

  for (PetscInt i = 0; i < domain->dim; i++)
    for (PetscInt j = 0; j < domain->dim; j++) sum += 0.5 * PetscSqr(L[i][j] + L[j][i]);
  return PetscSqrtReal(sum);
}

PetscErrorCode OperatorsApparentViscosity(Cloud cloud, const Viscosity *viscosity)
{
  PetscReal *depth, scale_w, scale_f, inverse_h2;
  Places     places;

  PetscFunctionBegin;
  if (!SceneViscosityVaries(cloud->scene)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscLogEventBegin(LogEvent(EVENT_VISCOSITY), 0, 0, 0, 0));
  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  PetscCall(CloudGetWork(cloud, 1, &depth));
  FindDepths(cloud, depth);
  for (PetscInt a = 0; a < cloud->n_owned; a++) {
    const PetscInt body = cloud->integer[INT_BODY][a];
    PetscReal      L[DIM][DIM], *mu = cloud->field[FIELD_VISCOSITY] + a;

    *mu = body < 0 ? 0 : BodyMaterial(SceneBody(cloud->scene, body))->viscosity;
    if (body < 0 || !BodyViscosityVaries(SceneBody(cloud->scene, body))) continue;
    FindPlaces(cloud, viscosity, a, depth, cloud->domain->volume * scale_f, &places);
    FitGradient(cloud, a, &places, L);
    *mu = BodyViscosity(SceneBody(cloud->scene, body), ShearRate(cloud->domain, cloud->field[FIELD_POSITION] + DIM * a,
                                                                 cloud->field[FIELD_VELOCITY] + DIM * a, L));
  }
  PetscCall(CloudRestoreWork(cloud, &depth));
  PetscCall(CloudUpdate(cloud, FIELD_VISCOSITY));
  PetscCall(PetscLogEventEnd(LogEvent(EVENT_VISCOSITY), 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}
