/* The pressure outside of outlets, in the equation of the pressure. The surface of the liquid at an open face is a free
   surface, whose rows are closed as if the missing neighbours had the pressure of the open air. Beside an outlet they
   have that of the outside, P: what surface tension has, too. Nothing of it is unknown, so the operator stays as it is.

   P is that at the foot of the particle on the face. A row has it within REACH of the face, where particles that leave
   one by one make the surface uneven, and with the share with which its surface looks at the face: fully up to 45
   degrees. Above the level of the outside there is air.

   A row with p = P that falls along the face as the hydrostatic pressure does gets exactly -grad P/rho (GasTerm and
   surface tension have the same slope in gradient.c): liquid at rest at the level of its outlet stays at rest. But the
   surface there is vertical and as heavy on both sides: nothing holds it, and what errors of the gradient move leaves
   for ever. A tank of 25 spacings lost 6 % of its water in 3 s. So the surface is held as gravity holds a level one:
   where it stands off the face by s, P is less by rho g s. Flow takes it in and out by half a spacing, which cancels.
   OutletsCalm damps what remains. */
#include "outlets_impl.h"

#define REACH    1   /* spacings beyond the support of the kernel */
#define FULL_COS 0.5 /* square of the cosine above which a surface looks at the face */
#define HELD     1   /* spacings from the face that a surface is held by */

PetscReal OutletOutside(const Outlets *outlets, PetscInt d, PetscInt side, const PetscReal x[DIM], PetscReal gap,
                        PetscReal slope[DIM])
{
  const Outlet   *outlet = outlets->face[d][side];
  const Domain    domain = outlets->cloud->domain;
  const PetscReal g      = Norm(outlets->gravity);
  PetscReal       foot[DIM], head, P;

  for (PetscInt e = 0; e < DIM; e++) foot[e] = x[e];
  foot[d] = side ? domain->upper[d] : domain->lower[d];
  head    = outlet->has_level ? PetscMax(0, outlet->level * g + Dot(outlets->gravity, foot)) : 0;
  P       = outlet->pressure + outlets->density * head;
  for (PetscInt e = 0; e < DIM && slope; e++)
    slope[e] = e == d || head == 0 ? 0 : outlets->density * outlets->gravity[e];
  return P == 0 ? 0 : P - outlets->density * g * gap;
}

PetscReal OutletsPressure(const Outlets *outlets, PetscInt a, PetscReal slope[DIM])
{
  const Cloud      cloud  = outlets->cloud;
  const Domain     domain = cloud->domain;
  const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a, *n = cloud->field[FIELD_NORMAL] + DIM * a,
                  s     = cloud->size[a] * domain->spacing,
                  reach = cloud->size[a] * KernelSupport(cloud->kernel) + REACH * s, n2 = Dot(n, n);
  PetscReal P = 0, looks = 0, slopes[DIM] = {0, 0, 0};

  for (PetscInt f = 0; f < 2 * domain->dim && n2 > 0; f++) {
    const PetscInt  d = f / 2, side = f % 2;
    const PetscReal away = side ? domain->upper[d] - x[d] : x[d] - domain->lower[d], share = n[d] * n[d] / n2;
    PetscReal       gap, part[DIM];

    if (!outlets->face[d][side]->on || away > reach || (side ? -n[d] : n[d]) <= 0) continue;
    gap = PetscMax(-HELD * s, PetscMin(HELD * s, away - PressureDepth(outlets->pressure, a)));
    looks += share;
    P += share * OutletOutside(outlets, d, side, x, gap, part);
    for (PetscInt e = 0; e < DIM; e++) slopes[e] += share * part[e];
  }
  if (looks == 0) return 0;
  for (PetscInt e = 0; e < DIM && slope; e++) slope[e] += slopes[e] / PetscMax(looks, FULL_COS);
  return P / PetscMax(looks, FULL_COS);
}

PetscInt OutletsFacing(const Outlets *outlets, PetscInt a)
{
  const PetscReal *n    = outlets->cloud->field[FIELD_NORMAL] + DIM * a;
  PetscReal        most = 0;
  PetscInt         face = -1;

  for (PetscInt f = 0; f < 2 * DIM; f++) {
    const PetscReal looks = f % 2 ? -n[f / 2] : n[f / 2];

    if (!outlets->face[f / 2][f % 2]->on || looks <= most) continue;
    most = looks;
    face = f;
  }
  return face;
}

/* The mean of v ([n_total][width]) over the liquid around particle a, itself included. */
static void MeanAround(Cloud cloud, PetscInt a, PetscInt width, const PetscReal v[], PetscReal mean[])
{
  const PetscReal *x   = cloud->field[FIELD_POSITION] + DIM * a;
  PetscReal        sum = 0, r2 = 0, W;

  KernelEvaluate(cloud->kernel, 1, &r2, &sum, NULL);
  for (PetscInt d = 0; d < width; d++) mean[d] = sum * v[width * a + d];
  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    const PetscInt   b = cloud->list[k];
    const PetscReal *y = cloud->field[FIELD_POSITION] + DIM * b, r[DIM] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};

    if (cloud->integer[INT_LAYER][b]) continue;
    r2 = Dot(r, r) / PetscSqr(CloudPairSize(cloud, a, b));
    KernelEvaluate(cloud->kernel, 1, &r2, &W, NULL);
    sum += W;
    for (PetscInt d = 0; d < width; d++) mean[d] += W * v[width * b + d];
  }
  for (PetscInt d = 0; d < width; d++) mean[d] /= sum;
}

/* What the closed row of particle a has outside (Pa), beyond what surrounds it anyway: on and near a surface what the
   outlets have. A gap amid the liquid has the former pressure around: with that of the open air it was a sink, which
   came and went with the particles, and the pressure behind an emitter, against 1500 Pa, moved by 120 Pa (now 30). */
static PetscReal OutsideRow(const Outlets *outlets, PetscInt a)
{
  const Cloud cloud = outlets->cloud;
  PetscReal   around;

  if (cloud->integer[INT_SURFACE][a]) return OutletsPressure(outlets, a, NULL);
  MeanAround(cloud, a, 1, cloud->field[FIELD_PRESSURE], &around);
  return around - PressureSurrounds(outlets->pressure, a, NULL);
}

static PetscErrorCode RightSide(void *context, Pressure pressure, PetscScalar rhs[])
{
  const Outlets   *outlets = (const Outlets *)context;
  const PetscReal *closure = PressureClosure(pressure), share = 1 - PressureKeptShare(pressure);

  PetscFunctionBegin;
  for (PetscInt a = 0; a < outlets->cloud->n_fluid && !outlets->frozen; a++)
    if (closure[a] > 0 && !CloudPushes(outlets->cloud, a)) rhs[a] += share * closure[a] * OutsideRow(outlets, a);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode OutsideRows(void *context, Pressure pressure, PetscReal outside[], PetscReal slope[])
{
  const Outlets *outlets = (const Outlets *)context;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < outlets->cloud->n_fluid && !outlets->frozen; a++)
    outside[a] += OutletsPressure(outlets, a, slope + DIM * a);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode OutletsCalm(const Outlets *outlets, PetscReal dt, PetscReal v[], PetscReal *energy)
{
  const Cloud cloud = outlets->cloud;
  PetscReal  *calm;

  PetscFunctionBegin;
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, v));
  PetscCall(CloudGetWork(cloud, DIM, &calm));
  PetscCall(PetscArraycpy(calm, v, DIM * cloud->n_fluid));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal share = 1 - PetscExpReal(-dt * outlets->speed / (cloud->size[a] * cloud->domain->spacing));
    PetscReal      *u     = calm + DIM * a, mean[DIM], before;

    if (!cloud->integer[INT_SURFACE][a] || CloudPushes(cloud, a) || OutletsPressure(outlets, a, NULL) == 0) continue;
    before = Dot(u, u);
    MeanAround(cloud, a, DIM, v, mean);
    for (PetscInt d = 0; d < DIM; d++) u[d] += share * (mean[d] - u[d]);
    *energy += 0.5 * cloud->volume[a] * cloud->rest_density[a] * (Dot(u, u) - before);
  }
  PetscCall(PetscArraycpy(v, calm, DIM * cloud->n_fluid));
  PetscCall(CloudRestoreWork(cloud, &calm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const LowRank OutletTerm = {.right_side = RightSide, .outside = OutsideRows};
