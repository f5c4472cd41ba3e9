/* The models: conformation and stress of one particle; what a body has of polymers. */
#include "elastic_impl.h"

static const PetscInt At[DIM][DIM] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};

#define FENE_MOST 0.999 /* of the extent, for tr c: the spring is not infinite if a step overshoots */
#define SMALL     1e-6  /* of a step over lambda, in which exp is a difference of equal numbers */

static const char *const Models[] = {"oldroyd_b", "giesekus", "fene_p", NULL};

static const OptionRow of_bodies[] = {
  {"-polymer_modulus", "Elastic modulus of polymers in the liquid, whose own viscosity is that of the solvent; 0: none",
   "Pa", "[0, inf)", ROW_REAL, offsetof(Polymers, modulus)},
  {"-relaxation_time", "Time in which their stress relaxes", "s", "[0, inf)", ROW_REAL, offsetof(Polymers, relaxation)},
  {"-polymer_model", "How their stress depends on their stretch", NULL, NULL, ROW_WORD, offsetof(Polymers, model),
   .words = Models},
  {"-polymer_mobility", "Mobility factor alpha of giesekus", "1", "[0, 1]", ROW_REAL, offsetof(Polymers, mobility)},
  {"-polymer_extensibility", "Largest trace of the conformation in fene_p, L^2, larger than 3; 0: not given", "1",
   "[0, inf)", ROW_REAL, offsetof(Polymers, extent)},
  {.name = NULL},
};

static PetscErrorCode Check(Domain domain, const char prefix[], void *data)
{
  const Polymers *p = (const Polymers *)data;

  PetscFunctionBegin;
  PetscCheckUser(p->modulus == 0 || p->relaxation > 0, domain->comm,
                 "-%spolymer_modulus is given: -%srelaxation_time must be positive", prefix, prefix);
  PetscCheckUser(p->modulus > 0 || (p->relaxation == 0 && p->model == OLDROYD_B), domain->comm,
                 "-%srelaxation_time or -%spolymer_model is given: -%spolymer_modulus must be positive", prefix, prefix,
                 prefix);
  PetscCheckUser((p->model == GIESEKUS) == (p->mobility > 0), domain->comm,
                 "-%spolymer_mobility must be positive with -%spolymer_model giesekus, and is for it alone", prefix,
                 prefix);
  PetscCheckUser((p->model == FENE_P) == (p->extent > 0) && (p->extent == 0 || p->extent > 3), domain->comm,
                 "-%spolymer_extensibility must be larger than 3 with -%spolymer_model fene_p, and is for it alone",
                 prefix, prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

const Property ElasticProperties[] = {{OWNER_BODY, sizeof(Polymers), of_bodies, NULL, Check}, {.rows = NULL}};

const Polymers *PolymersOf(Scene scene, PetscInt body)
{
  return (const Polymers *)BodyOwn(SceneBody(scene, body), ElasticProperties);
}

PetscBool PolymersAlike(const Polymers *p, const Polymers *q)
{
  return (PetscBool)(p == q || (p->modulus == q->modulus && p->relaxation == q->relaxation && p->model == q->model &&
                                p->mobility == q->mobility && p->extent == q->extent));
}

PetscBool ElasticOn(Scene scene, Tension tension)
{
  for (PetscInt b = 0; scene && b < SceneCount(scene); b++)
    if (PolymersOf(scene, b)->modulus > 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

static PetscReal Trace(const PetscReal s[6])
{
  return 3 + s[0] + s[1] + s[2];
}

/* f of tau = G (f c - 1). */
static PetscReal Spring(const Polymers *p, const PetscReal s[6])
{
  if (p->model != FENE_P) return 1;
  return (p->extent - 3) / (p->extent - PetscMin(Trace(s), FENE_MOST * p->extent));
}

/* s - s (1 + k s)^-1 k s = (1 + k s)^-1 s: the quadratic relaxation of Giesekus, implicit. */
static void RelaxQuadratic(PetscReal k, PetscReal s[6])
{
  PetscReal M[6], B[6], out[6] = {0};

  for (PetscInt i = 0; i < 6; i++) M[i] = (i < DIM) + k * s[i];
  SymmetricInverse(3, M, B);
  for (PetscInt i = 0; i < DIM; i++)
    for (PetscInt j = i; j < DIM; j++) {
      for (PetscInt l = 0; l < DIM; l++) out[At[i][j]] += B[At[i][l]] * s[At[l][j]];
    }
  for (PetscInt i = 0; i < 6; i++) s[i] = out[i];
}

/* c = q + u with q = 1/f and r = f/lambda: du/dt = L u + u L^T + q (L + L^T) - r u. With A = exp(L dt), e = exp(-r dt)
   and g = (1 - e)/(r dt): u <- e A u A^T + q g (A A^T - 1). As e <= g <= 1, c is a sum of positive matrices for any
   step, and for r dt >> 1 the stress is that of a Newtonian liquid. */
void PolymersStretch(const Polymers *p, PetscReal L[DIM][DIM], PetscReal dt, PetscReal s[6])
{
  const PetscReal f = Spring(p, s), q = 1 / f, x = dt * f / p->relaxation, e = PetscExpReal(-x),
                  g = x > SMALL ? (1 - e) / x : 1;
  PetscReal A[DIM][DIM], P[DIM][DIM], u[6];

  for (PetscInt i = 0; i < DIM; i++)
    for (PetscInt j = 0; j < DIM; j++) {
      A[i][j] = (i == j) + dt * L[i][j];
      for (PetscInt k = 0; k < DIM; k++) A[i][j] += 0.5 * dt * dt * L[i][k] * L[k][j];
    }
  for (PetscInt k = 0; k < 6; k++) u[k] = s[k] + (k < DIM ? 1 - q : 0);
  for (PetscInt i = 0; i < DIM; i++)
    for (PetscInt j = 0; j < DIM; j++) {
      P[i][j] = 0;
      for (PetscInt k = 0; k < DIM; k++) P[i][j] += A[i][k] * (e * u[At[k][j]] + (k == j) * q * g);
    }
  for (PetscInt i = 0; i < DIM; i++)
    for (PetscInt j = i; j < DIM; j++) {
      PetscReal *out = s + At[i][j];

      *out = (i == j) * (q - 1 - q * g);
      for (PetscInt k = 0; k < DIM; k++) *out += P[i][k] * A[j][k];
    }
  if (p->model == GIESEKUS) RelaxQuadratic(p->mobility * dt / p->relaxation, s);
}

void PolymersStress(const Polymers *p, const PetscReal s[6], PetscReal tau[6])
{
  const PetscReal f = Spring(p, s);

  for (PetscInt k = 0; k < 6; k++) tau[k] = p->modulus * (f * s[k] + (k < DIM ? f - 1 : 0));
}

PetscReal PolymersEnergy(const Polymers *p, const PetscReal s[6])
{
  const PetscReal xx = 1 + s[0], yy = 1 + s[1], zz = 1 + s[2], trace = xx + yy + zz,
                  det =
                    xx * (yy * zz - s[5] * s[5]) - s[3] * (s[3] * zz - s[4] * s[5]) + s[4] * (s[3] * s[5] - yy * s[4]),
                  spring = p->model == FENE_P
                             ? -(p->extent - 3) * log1p(-(PetscMin(trace, FENE_MOST * p->extent) - 3) / (p->extent - 3))
                             : trace - 3;

  return 0.5 * p->modulus * (spring - PetscLogReal(PetscMax(det, PETSC_SMALL)));
}

/* The largest eigenvalue of c is at most tr c - 2 if the others are 1. */
PetscReal PolymersStiffness(const Polymers *p, const PetscReal s[6], PetscReal *relaxation)
{
  const PetscReal f = Spring(p, s);

  *relaxation = p->relaxation / f;
  return p->modulus * f * PetscMax(1, Trace(s) - 2);
}
