/* Initial velocity fields, which add to the uniform part. A field needs one table and one registration line. */
#include "scene_impl.h"

#define TRACE_ROUNDING 1e-9 /* relative to the largest rate */

/* A linear field v = G (x - center): rotation, and strain with shear. */
typedef struct {
  PetscReal     gradient[DIM][DIM]; /* G_ij = dv_i/dx_j, 1/s */
  PetscReal     center[DIM];        /* m */
  OptionNumbers rate;               /* 1/s */
} Linear;

static void LinearAdd(Body body, const PetscReal x[DIM], PetscReal v[DIM])
{
  const Linear *linear = (const Linear *)body->velocity_data;

  for (PetscInt i = 0; i < body->domain->dim; i++) {
    for (PetscInt j = 0; j < body->domain->dim; j++) v[i] += linear->gradient[i][j] * (x[j] - linear->center[j]);
  }
}

/* Refuses an option that is missing. */
static PetscErrorCode CheckGiven(Body body, const char option[], PetscInt count)
{
  PetscFunctionBegin;
  PetscCheckUser(count > 0, body->domain->comm, "-%s%s is missing: -%svelocity_type %s needs it", body->prefix,
                 option + 1, body->prefix, body->velocity_type);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rigid rotation v = omega x (x - center). The square patch of Colagrossi (2005), v = omega (y, -x), has the rate
   0,0,-omega. */
static const OptionRow rotation[] = {
  {"-rotation_rate", "Angular velocity; in two dimensions one number is enough", "rad/s", NULL, ROW_NUMBERS,
   offsetof(Linear, rate)},
  {"-rotation_center", "Point on the axis of rotation", "m", NULL, ROW_POINT, offsetof(Linear, center)},
  {.name = NULL},
};

static PetscErrorCode RotationSetUp(void *owner)
{
  Body      body   = (Body)owner;
  Linear   *linear = (Linear *)body->velocity_data;
  PetscReal rate[DIM];

  PetscFunctionBegin;
  PetscCall(CheckGiven(body, "-rotation_rate", linear->rate.count));
  PetscCall(RateCheck(body->domain, body->prefix, &linear->rate, rate));
  linear->gradient[0][1] = -rate[2];
  linear->gradient[0][2] = rate[1];
  linear->gradient[1][0] = rate[2];
  linear->gradient[1][2] = -rate[0];
  linear->gradient[2][0] = -rate[1];
  linear->gradient[2][1] = rate[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* v = G (x - center), G diagonal or full, with zero trace. The stretching drop of Monaghan (1994), v = (-A x, A y), has
   the rates -A,A. */
static const OptionRow strain[] = {
  {"-strain_rate", "Velocity gradient dv_i/dx_j: its diagonal, or all numbers row by row", "1/s", NULL, ROW_NUMBERS,
   offsetof(Linear, rate)},
  {"-strain_center", "Point at rest in the strain", "m", NULL, ROW_POINT, offsetof(Linear, center)},
  {.name = NULL},
};

static PetscErrorCode StrainSetUp(void *owner)
{
  Body           body   = (Body)owner;
  Linear        *linear = (Linear *)body->velocity_data;
  const PetscInt dim = body->domain->dim, count = linear->rate.count;
  PetscReal      trace = 0, largest = 0;

  PetscFunctionBegin;
  PetscCall(CheckGiven(body, "-strain_rate", count));
  PetscCheckUser(count == dim || count == dim * dim, body->domain->comm,
                 "-%sstrain_rate must have %" PetscInt_FMT " numbers (the diagonal) or %" PetscInt_FMT, body->prefix,
                 dim, dim * dim);
  for (PetscInt i = 0; i < dim; i++) {
    for (PetscInt j = 0; j < dim; j++) {
      if (count == dim)
        linear->gradient[i][j] = i == j ? linear->rate.value[i] : 0;
      else
        linear->gradient[i][j] = linear->rate.value[i * dim + j];
      largest = PetscMax(largest, PetscAbsReal(linear->gradient[i][j]));
    }
    trace += linear->gradient[i][i];
  }
  if (body->domain->rings) trace += linear->gradient[0][0]; /* v_r/r */
  PetscCheckUser(PetscAbsReal(trace) <= TRACE_ROUNDING * largest, body->domain->comm,
                 "-%sstrain_rate must not change the volume: the sum of its diagonal must be 0%s, not %g 1/s",
                 body->prefix, body->domain->rings ? ", with the first number counted twice for rings" : "",
                 (double)trace);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A formula for each component. Vortices of Taylor & Green (1937) are
   0-cos(2*pi*x)*sin(2*pi*y),sin(2*pi*x)*cos(2*pi*y). */
typedef struct {
  char    text[PETSC_MAX_PATH_LEN];
  Formula of[DIM];
} Formulas;

static const OptionRow formula[] = {
  {"-velocity_formula",
   "Velocity as formulas of x, y and z in m (rings: r and z), separated by commas: 0.1*sin(2*pi*x/1e-3), 0; with + - * "
   "/ ^, pi, sin, cos, tan, exp, log, sqrt, tanh, atan, abs and step, which is 1 above 0",
   "m/s", NULL, ROW_TEXT, offsetof(Formulas, text), .fallback = OPTION_REQUIRED},
  {.name = NULL},
};

static PetscErrorCode FormulasSetUp(void *owner)
{
  Body        body     = (Body)owner;
  Formulas   *formulas = (Formulas *)body->velocity_data;
  const char *text = formulas->text, *names = body->domain->rings ? "rz" : body->domain->dim == 2 ? "xy" : "xyz";

  PetscFunctionBegin;
  PetscCheckUser(text[0], body->domain->comm,
                 "-%svelocity_formula is missing: -%svelocity_type formula needs it; at its start 0-x stands for -x",
                 body->prefix, body->prefix);
  for (PetscInt d = 0; d < body->domain->dim; d++)
    PetscCheckUser(FormulaRead(&text, names, &formulas->of[d]), body->domain->comm,
                   "-%svelocity_formula \"%s\" has %" PetscInt_FMT " formulas that can be read, not %" PetscInt_FMT
                   ": the next is \"%s\"; see -help formula",
                   body->prefix, formulas->text, d, body->domain->dim, text);
  PetscCheckUser(!*text, body->domain->comm,
                 "-%svelocity_formula has more than %" PetscInt_FMT " formulas: \"%s\" is left", body->prefix,
                 body->domain->dim, text);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void FormulasAdd(Body body, const PetscReal x[DIM], PetscReal v[DIM])
{
  const Formulas *formulas = (const Formulas *)body->velocity_data;

  for (PetscInt d = 0; d < body->domain->dim; d++) v[d] += FormulaValue(&formulas->of[d], x);
}

static const VelocityOps Uniform   = {{"uniform", 0, NULL, NULL, NULL}, NULL};
static const VelocityOps Rotation  = {{"rotation", sizeof(Linear), rotation, NULL, RotationSetUp}, LinearAdd};
static const VelocityOps Strain    = {{"strain", sizeof(Linear), strain, NULL, StrainSetUp}, LinearAdd};
static const VelocityOps ByFormula = {{"formula", sizeof(Formulas), formula, NULL, FormulasSetUp}, FormulasAdd};

const Choice *const Velocities[] = {&Uniform.choice, &Rotation.choice, &Strain.choice, &ByFormula.choice, NULL};
