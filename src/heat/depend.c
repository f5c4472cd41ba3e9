/* What depends on the temperature: density in its weight (Boussinesq 1903), viscosity, surface tension. Bodies have
   their density, viscosity and tension at -reference_temperature. */
#include "../neighbors/pairs.h"
#include "../scene/body.h"
#include "heat_impl.h"

#define TABLE_MOST 64   /* lines of -<body>_viscosity_file */
#define WAVE       0.25 /* of sqrt(rho h^3/(2 pi sigma)) of Brackbill et al. 1992 */

/* What a body has. */
typedef struct {
  PetscReal  expansion, activation, slope; /* 1/K; K; N/(m K) */
  OptionFile file;
  PetscInt   rows;
  PetscReal  table[2 * TABLE_MOST]; /* [rows] temperature (K), logarithm of the viscosity */
} Dependence;

static const OptionRow of_bodies[] = {
  {"-thermal_expansion", "Thermal expansion of the volume, in its weight alone (Boussinesq)", "1/K", "(-inf, inf)",
   ROW_REAL, offsetof(Dependence, expansion), .changes = PETSC_TRUE},
  {"-viscosity_activation",
   "Activation temperature B of the viscosity, which exp(B/T - B/T0) multiplies, T0 the -reference_temperature "
   "(Arrhenius)",
   "K", "[0, inf)", ROW_REAL, offsetof(Dependence, activation), .changes = PETSC_TRUE},
  {"-viscosity_file",
   "Table of the viscosity: lines of a temperature (K) and a viscosity, in any unit; between them it is exponential, "
   "beyond them constant; it multiplies -<body>_viscosity, over its value at the -reference_temperature",
   NULL, NULL, ROW_FILE, offsetof(Dependence, file), .fallback = "none"},
  {"-tension_temperature", "Change of the surface tension with the temperature; liquids have a negative one", "N/(m K)",
   "(-inf, inf)", ROW_REAL, offsetof(Dependence, slope), .changes = PETSC_TRUE},
  {.name = NULL},
};

static const OptionRow of_scene[] = {
  {"-reference_temperature", "Temperature at which bodies have their density, viscosity and tension", "K", "[0, inf)",
   ROW_REAL, 0, .fallback = "the temperature of the first body"},
  {.name = NULL},
};

static PetscErrorCode Check(Domain domain, const char prefix[], void *data)
{
  Dependence *of = (Dependence *)data;
  PetscReal  *table;
  PetscInt    columns, rises = 0;
  char        option[OPTION_NAME_LENGTH];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(option, sizeof(option), "-%sviscosity_file", prefix));
  PetscCall(TableRead(domain->comm, option, "two finite numbers, temperature and viscosity", "higher temperature", 2, 2,
                      &of->file, &of->rows, &columns, &table));
  PetscCheckUser(of->rows <= TABLE_MOST, domain->comm, "%s %s has more than %d lines", option, of->file.path,
                 TABLE_MOST);
  for (PetscInt k = 0; k < of->rows; k++) {
    PetscCheckUser(table[2 * k] > 0 && table[2 * k + 1] > 0, domain->comm,
                   "%s %s: temperatures and viscosities must be positive", option, of->file.path);
    of->table[2 * k]     = table[2 * k];
    of->table[2 * k + 1] = PetscLogReal(table[2 * k + 1]);
    if (k) rises += table[2 * k + 1] >= table[2 * k - 1];
  }
  PetscCheckUser(rises == 0 || rises == of->rows - 1, domain->comm,
                 "%s %s: the viscosity must fall from each line to the next, or rise from each to the next", option,
                 of->file.path);
  PetscCheckUser(of->rows == 0 || of->activation == 0, domain->comm,
                 "-%sviscosity_activation and %s exclude each other: give one law of the viscosity", prefix, option);
  PetscCall(PetscFree(table));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const Property properties[] = {{OWNER_BODY, sizeof(Dependence), of_bodies, NULL, Check},
                                      {OWNER_SCENE, sizeof(PetscReal), of_scene},
                                      {.rows = NULL}};

static const Dependence *Of(Scene scene, PetscInt body)
{
  return (const Dependence *)BodyOwn(SceneBody(scene, body), properties);
}

static PetscReal Reference(Scene scene)
{
  const PetscReal given = *(const PetscReal *)SceneOwn(scene, properties + 1);

  return given > 0 ? given : ScalarOf(scene, HEAT_TEMPERATURE, 0)->start;
}

static PetscBool Thickens(Scene scene, Tension tension)
{
  for (PetscInt b = 0; scene && b < SceneCount(scene); b++)
    if (Of(scene, b)->activation > 0 || Of(scene, b)->rows > 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

static PetscBool Pulls(Scene scene, Tension tension)
{
  for (PetscInt b = 0; scene && b < SceneCount(scene); b++)
    if (Of(scene, b)->slope != 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

static PetscBool Floats(Scene scene, Tension tension)
{
  for (PetscInt b = 0; scene && b < SceneCount(scene); b++)
    if (Of(scene, b)->expansion != 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* --- viscosity --- */

/* The logarithm of the viscosity of a table at T. */
static PetscReal Interpolate(const Dependence *of, PetscReal T)
{
  const PetscReal *row = of->table;
  PetscReal        t;

  for (PetscInt k = 0; k < of->rows - 2 && row[2] < T; k++) row += 2;
  t = PetscMax(0, PetscMin(1, (T - row[0]) / (row[2] - row[0])));
  return (1 - t) * row[1] + t * row[3];
}

static PetscErrorCode Thicken(const Step *step)
{
  const Cloud      cloud = step->cloud;
  const PetscReal *T = cloud->field[FIELD_TEMPERATURE], T0 = Reference(cloud->scene);
  PetscReal       *mu = cloud->field[FIELD_VISCOSITY];

  PetscFunctionBegin;
  if (!Thickens(cloud->scene, NULL)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const Dependence *of = Of(cloud->scene, cloud->integer[INT_BODY][a]);

    if (of->rows) mu[a] *= PetscExpReal(Interpolate(of, T[a]) - Interpolate(of, T0));
    if (of->activation > 0) mu[a] *= PetscExpReal(of->activation / T[a] - of->activation / T0);
  }
  PetscCall(CloudUpdate(cloud, FIELD_VISCOSITY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- weight --- */

static void AddWeight(Cloud cloud, PetscReal a[])
{
  const PetscReal *T = cloud->field[FIELD_TEMPERATURE], T0 = Reference(cloud->scene);

  for (PetscInt k = 0; k < cloud->n_fluid; k++) {
    const PetscReal lighter = Of(cloud->scene, cloud->integer[INT_BODY][k])->expansion * (T[k] - T0);
    PetscReal       g[DIM];

    if (lighter == 0) continue;
    SceneAcceleration(cloud->scene, cloud->field[FIELD_POSITION] + DIM * k, g);
    for (PetscInt d = 0; d < DIM; d++) a[DIM * k + d] -= lighter * g[d];
  }
}

/* --- tension --- */

/* The tension of each particle at its temperature, [n_total] N/m: the cloud has it while the tension acts. */
typedef struct {
  PetscReal *tension;
  PetscInt   capacity;
} Tensions;

static PetscErrorCode SetTension(Cloud cloud, Tensions *own)
{
  const PetscReal *T = cloud->field[FIELD_TEMPERATURE], T0 = Reference(cloud->scene);

  PetscFunctionBegin;
  if (cloud->n_total > own->capacity) {
    own->capacity = PetscMax(cloud->capacity, cloud->n_total);
    PetscCall(PetscRealloc((size_t)own->capacity * sizeof(PetscReal), &own->tension));
  }
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscInt b = cloud->integer[INT_BODY][a];

    own->tension[a] = BodyMaterial(SceneBody(cloud->scene, b))->tension + Of(cloud->scene, b)->slope * (T[a] - T0);
  }
  PetscCall(PetscArrayzero(own->tension + cloud->n_fluid, cloud->n_owned - cloud->n_fluid));
  PetscCall(CloudUpdateArray(cloud, 1, PARITY_SCALAR, own->tension));
  cloud->tension = own->tension;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Tense(const Step *step)
{
  PetscFunctionBegin;
  if (Pulls(step->scene, NULL)) PetscCall(SetTension(step->cloud, (Tensions *)step->own));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The power of an acceleration ([n_fluid][3]) on this rank's fluid, W. */
static PetscReal Power(Cloud cloud, const PetscReal a[])
{
  PetscReal sum = 0;

  for (PetscInt k = 0; k < cloud->n_fluid; k++)
    sum += cloud->volume[k] * cloud->rest_density[k] * Dot(cloud->field[FIELD_VELOCITY] + DIM * k, a + DIM * k);
  return sum;
}

static PetscErrorCode Force(const Step *step)
{
  const Cloud cloud = step->cloud;
  PetscReal  *a = cloud->field[FIELD_ACCELERATION], before;

  PetscFunctionBegin;
  if (Floats(cloud->scene, NULL)) {
    before = Power(cloud, a);
    AddWeight(cloud, a);
    step->sums[0] += step->dt * (Power(cloud, a) - before);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* --- scales --- */

/* The largest difference (K) that the scene has between bodies, faces, solids and air. */
static PetscReal Difference(Scene scene)
{
  PetscReal low = PETSC_MAX_REAL, high = 0;

  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    const BodyScalar *of = ScalarOf(scene, HEAT_TEMPERATURE, b);
    PetscReal         lower[DIM], upper[DIM], least = of->start, most = of->start;

    BodyBounds(SceneBody(scene, b), lower, upper);
    for (PetscInt d = 0; d < DIM; d++) {
      if (of->slope[d] == 0) continue; /* a bound may be infinite */
      least += PetscMin(of->slope[d] * lower[d], of->slope[d] * upper[d]);
      most += PetscMax(of->slope[d] * lower[d], of->slope[d] * upper[d]);
    }
    low  = PetscMin(low, least);
    high = PetscMax(high, most);
  }
  for (PetscInt r = 0; r < 2 * DIM + SceneSolidCount(scene); r++) {
    const Side *side = SideOf(scene, HEAT_TEMPERATURE, r);

    if (!side || !side->holds) continue;
    low  = PetscMin(low, side->value);
    high = PetscMax(high, side->value);
  }
  return high - low;
}

static PetscReal Speed(const Step *step)
{
  const Scene     scene = step->scene;
  const PetscReal h = KernelSmoothingLength(step->cloud->kernel), difference = Difference(scene);
  PetscReal       speed = 0;

  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    const Material *m    = BodyMaterial(SceneBody(scene, b));
    const PetscReal pull = PetscAbsReal(Of(scene, b)->slope) * difference;
    BodyScales      scales;

    SceneBodyScales(scene, b, &scales);
    speed = PetscMax(speed, PetscSqrtReal(PetscAbsReal(Of(scene, b)->expansion) * difference *
                                          Norm(scales.acceleration) * scales.length));
    speed = PetscMax(speed, PetscMin(PetscSqrtReal(pull / (m->density * h)),
                                     m->viscosity > 0 ? pull / m->viscosity : PETSC_MAX_REAL));
  }
  return speed;
}

static PetscErrorCode Destroy(const Step *step)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(((Tensions *)step->own)->tension));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Bound(const Step *step, PetscReal scale, StepBound *bound)
{
  const Scene     scene = step->scene;
  const PetscReal h = scale * KernelSmoothingLength(step->cloud->kernel), difference = Difference(scene);

  bound->name  = "tension_temperature";
  bound->cause = "tension that varies with the temperature";
  bound->lift  = "a larger -spacing";
  for (PetscInt b = 0; b < SceneCount(scene); b++) {
    const PetscReal pull = PetscAbsReal(Of(scene, b)->slope) * difference,
                    rho  = BodyMaterial(SceneBody(scene, b))->density;

    if (pull > 0) bound->step = PetscMin(bound->step, WAVE * PetscSqrtReal(rho * h * h * h / (2 * PETSC_PI * pull)));
  }
}

static PetscErrorCode Commit(const Step *step, StepState *state)
{
  PetscReal *work = (PetscReal *)StepNumbers(step, state);

  PetscFunctionBegin;
  *work += step->sums[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool Depends(Scene scene, Tension tension)
{
  return (PetscBool)(Thickens(scene, tension) || Floats(scene, tension) || Pulls(scene, tension));
}

static PetscBool On(const Step *step)
{
  return Depends(step->scene, NULL);
}

static PetscBool Drives(const Step *step)
{
  return (PetscBool)(On(step) && (Floats(step->scene, NULL) || Pulls(step->scene, NULL)));
}

#define PULLS   "-<body>_tension_temperature"
#define DEPENDS "a viscosity, weight or tension that depends on the temperature"

static const NumberRow rows[]     = {{"buoyancy_work", NUMBER_REAL, 0, ENERGY_GIVEN, "buoyancy"}, {.name = NULL}};
static const EdgeField fields[]   = {{FIELD_VISCOSITY, Thickens}, {.needed = NULL}};
static const Feature   features[] = {{DEPENDS, Depends}, {PULLS, Pulls}, {.name = NULL}};
static const Refusal   refusals[] = {{DEPENDS, NEEDS_GIVEN, HEAT_OPTION, ""},
                                     {PULLS, NEEDS, "-tension_type " TENSION_CURVATURE, ", the default"},
                                     {PULLS, NOT_WITH, "-interface_tension", " yet"},
                                     {.one = NULL}};

const Edge DependEdge = {.name        = "dependence",
                         .properties  = properties,
                         .fields      = fields,
                         .features    = features,
                         .refusals    = refusals,
                         .number_size = sizeof(PetscReal),
                         .numbers     = rows,
                         .sums        = 1, /* work of buoyancy, J */
                         .data_size   = sizeof(Tensions),
                         .destroy     = Destroy,
                         .on          = On,
                         .bound       = Bound,
                         .drives      = Drives,
                         .speed       = Speed,
                         .thicken     = Thicken,
                         .force       = Force,
                         .tense       = Tense,
                         .commit      = Commit};
