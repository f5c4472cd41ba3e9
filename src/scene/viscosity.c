/* Viscosity models: the viscosity mu of a liquid as a function of its shear rate g = sqrt(2 D:D), D the rate of strain
   tensor. A model needs one table and one registration line.

   newtonian         mu = K, where K is -<b>_viscosity
   power_law         mu = K g^(n-1), at most -<b>_viscosity_max
   carreau           mu = mu_inf + (K - mu_inf) (1 + (t g)^2)^((n-1)/2)
   herschel_bulkley  mu = tau_y (1 - exp(-m g))/g + K g^(n-1), at most -<b>_viscosity_max, m = -<b>_viscosity_max/tau_y:
                     the form of Papanastasiou (1987): a liquid below its yield stress creeps; n = 1: Bingham */
#include "scene_impl.h"

#define STIFF        1000 /* default of the largest viscosity, over the viscosity at a shear rate of 1/s */
#define EXPONENT_MAX 2    /* with a larger n the viscosity changes too much in a step */

typedef struct {
  PetscReal exponent;     /* n; 0: not given */
  PetscReal max;          /* Pa s; 0: not given */
  PetscReal infinite;     /* mu_inf, Pa s */
  PetscReal time;         /* t, s */
  PetscReal yield_stress; /* tau_y, Pa */
} Law;

#define EXPONENT                                                                                                       \
  {                                                                                                                    \
    "-viscosity_exponent",                                                                                             \
      "Exponent n of the shear rate in the stress: below 1 shear thinning, above 1 shear thickening", "1", "(0, 2]",   \
      ROW_REAL, offsetof(Law, exponent), .fallback = "1 for herschel_bulkley, else required", .changes = PETSC_TRUE    \
  }
#define MAX                                                                                                            \
  {                                                                                                                    \
    "-viscosity_max", "Largest viscosity", "Pa s", "(0, inf)", ROW_REAL, offsetof(Law, max),                           \
      .fallback = "1000 times the viscosity at a shear rate of 1/s", .changes = PETSC_TRUE                             \
  }

static const OptionRow power_law[] = {EXPONENT, MAX, {.name = NULL}};

static const OptionRow carreau[] = {
  EXPONENT,
  {"-viscosity_time", "Time constant t: the viscosity changes at shear rates above 1/t", "s", "(0, inf)", ROW_REAL,
   offsetof(Law, time), .fallback = OPTION_REQUIRED, .changes = PETSC_TRUE},
  {"-viscosity_infinite", "Viscosity at infinite shear rate", "Pa s", "[0, inf)", ROW_REAL, offsetof(Law, infinite),
   .changes = PETSC_TRUE},
  {.name = NULL},
};

static const OptionRow herschel_bulkley[] = {
  {"-yield_stress", "Yield stress, below which the liquid only creeps", "Pa", "(0, inf)", ROW_REAL,
   offsetof(Law, yield_stress), .fallback = OPTION_REQUIRED, .changes = PETSC_TRUE},
  EXPONENT,
  MAX,
  {.name = NULL},
};

/* Refuses a viscosity of 0 and a number that is missing; unit: of the number, may be "". */
static PetscErrorCode CheckGiven(Body body, const char option[], const char unit[], PetscReal value)
{
  PetscFunctionBegin;
  PetscCheckUser(body->material.viscosity > 0, body->domain->comm,
                 "-%sviscosity is 0: -%sviscosity_model %s needs a positive viscosity", body->prefix, body->prefix,
                 body->viscosity_type);
  PetscCheckUser(value > 0, body->domain->comm, "-%s%s is missing: -%sviscosity_model %s needs a positive value%s%s",
                 body->prefix, option + 1, body->prefix, body->viscosity_type, unit[0] ? ", in " : "", unit);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PowerLawSetUp(void *owner)
{
  Body body = (Body)owner;
  Law *law  = (Law *)body->viscosity_data;

  PetscFunctionBegin;
  PetscCall(CheckGiven(body, "-viscosity_exponent", "", law->exponent));
  if (law->max == 0) law->max = STIFF * body->material.viscosity;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* rate^(n-1), at most 'most', also for a rate of zero. */
static PetscReal Power(PetscReal rate, PetscReal n, PetscReal most)
{
  if (n == 1) return 1;
  if (rate == 0) return n < 1 ? most : 0;
  return PetscMin(PetscPowReal(rate, n - 1), most);
}

static PetscReal PowerLawAt(Body body, PetscReal rate)
{
  const Law      *law = (const Law *)body->viscosity_data;
  const PetscReal K   = body->material.viscosity;

  return K * Power(rate, law->exponent, law->max / K);
}

static PetscErrorCode CarreauSetUp(void *owner)
{
  Body       body = (Body)owner;
  const Law *law  = (const Law *)body->viscosity_data;

  PetscFunctionBegin;
  PetscCall(CheckGiven(body, "-viscosity_exponent", "", law->exponent));
  PetscCall(CheckGiven(body, "-viscosity_time", "s", law->time));
  PetscCheckUser(law->infinite <= body->material.viscosity, body->domain->comm,
                 "-%sviscosity_infinite is %g Pa s; it must be at most -%sviscosity, %g Pa s", body->prefix,
                 (double)law->infinite, body->prefix, (double)body->material.viscosity);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal CarreauAt(Body body, PetscReal rate)
{
  const Law *law = (const Law *)body->viscosity_data;

  return law->infinite + (body->material.viscosity - law->infinite) *
                           PetscPowReal(1 + PetscSqr(law->time * rate), 0.5 * (law->exponent - 1));
}

static void HerschelBulkleyDefaults(void *owner)
{
  Body body                               = (Body)owner;
  ((Law *)body->viscosity_data)->exponent = 1;
}

static PetscErrorCode HerschelBulkleySetUp(void *owner)
{
  Body body = (Body)owner;
  Law *law  = (Law *)body->viscosity_data;

  PetscFunctionBegin;
  PetscCall(CheckGiven(body, "-yield_stress", "Pa", law->yield_stress));
  if (law->max == 0) law->max = STIFF * (body->material.viscosity + law->yield_stress);
  PetscCheckUser(law->max > body->material.viscosity, body->domain->comm,
                 "-%sviscosity_max is %g Pa s; it must be more than -%sviscosity, %g Pa s", body->prefix,
                 (double)law->max, body->prefix, (double)body->material.viscosity);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* expm1 is accurate at small rates, where the first term tends to the largest viscosity. */
static PetscReal HerschelBulkleyAt(Body body, PetscReal rate)
{
  const Law      *law = (const Law *)body->viscosity_data;
  const PetscReal K = body->material.viscosity, m = law->max / law->yield_stress;
  const PetscReal rigid = rate > 0 ? -law->yield_stress * expm1(-m * rate) / rate : law->max;

  return PetscMin(rigid + K * Power(rate, law->exponent, law->max / K), law->max);
}

static const ViscosityOps Newtonian       = {{"newtonian", 0, NULL, NULL, NULL}, NULL};
static const ViscosityOps PowerLaw        = {{"power_law", sizeof(Law), power_law, NULL, PowerLawSetUp}, PowerLawAt};
static const ViscosityOps Carreau         = {{"carreau", sizeof(Law), carreau, NULL, CarreauSetUp}, CarreauAt};
static const ViscosityOps HerschelBulkley = {{"herschel_bulkley", sizeof(Law), herschel_bulkley,
                                              HerschelBulkleyDefaults, HerschelBulkleySetUp},
                                             HerschelBulkleyAt};

const Choice *const Viscosities[] = {&Newtonian.choice, &PowerLaw.choice, &Carreau.choice, &HerschelBulkley.choice,
                                     NULL};

PetscBool BodyViscosityVaries(Body body)
{
  return (PetscBool)(body->viscosity && body->viscosity->at);
}

PetscReal BodyViscosity(Body body, PetscReal rate)
{
  return BodyViscosityVaries(body) ? body->viscosity->at(body, rate) : body->material.viscosity;
}

PetscBool SceneViscosityVaries(Scene scene)
{
  for (PetscInt b = 0; b < scene->count; b++)
    if (BodyViscosityVaries(scene->body[b])) return PETSC_TRUE;
  return PETSC_FALSE;
}
