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

/* What pulls the liquid along its surface is the gradient of the tension there, a stress (N/m2). It acts by each
   particle's part of the surface, 2 V |N|: what a pair of particles lacks of neighbours across the surface is in
   proportion to this, so that a velocity that is linear below it needs no other force. The continuum surface stress of
   Lafaurie et al. (1994), which the kernel spreads twice, moves a layer of 10 spacings with 0.6 of its speed. */

/* The slopes of the tension along the surface in this step, [n_fluid][3], N/m2. */
typedef struct {
  PetscReal *slope;
  PetscInt   capacity;
  PetscBool  found; /* by the force of this step */
} Slopes;

/* The normal of the surface at fluid particle a: the kernel's mean of N = sum V grad W around it. N alone, which is
   short in the second layer, leans by the disorder of the particles, and its projection would cost a tenth. */
static void SmoothNormal(Cloud cloud, PetscInt a, PairRow *row, PetscReal n[DIM])
{
  const PetscReal *N = cloud->field[FIELD_NORMAL], self = KernelSelf(cloud->kernel);

  PairRowLoadGeometry(cloud, cloud->field[FIELD_POSITION], a, row);
  PairRowEvaluate(cloud, a, row);
  for (PetscInt d = 0; d < DIM; d++) n[d] = self * N[DIM * a + d];
  for (PetscInt k = 0; k < row->n; k++) {
    const PetscInt b = row->index[k];

    if (cloud->integer[INT_LAYER][b] || !cloud->integer[INT_SURFACE][b]) continue;
    for (PetscInt d = 0; d < DIM; d++) n[d] += row->W[k] * N[DIM * b + d];
  }
}

/* Finds the slopes, and adds their pull to the acceleration. */
static PetscErrorCode AddTension(Cloud cloud, Slopes *slopes, PetscReal acceleration[])
{
  PairRow row;

  PetscFunctionBegin;
  if (cloud->n_fluid > slopes->capacity) {
    slopes->capacity = cloud->capacity;
    PetscCall(PetscRealloc((size_t)(DIM * slopes->capacity) * sizeof(PetscReal), &slopes->slope));
  }
  slopes->found = PETSC_TRUE;
  PetscCall(PetscArrayzero(slopes->slope, DIM * cloud->n_fluid));
  PetscCall(CloudUpdate(cloud, FIELD_TEMPERATURE));
  PetscCall(CloudUpdate(cloud, FIELD_NORMAL));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal share = TrialSurfaceArea(cloud, a) / (cloud->volume[a] * cloud->rest_density[a]),
                    unit  = Of(cloud->scene, cloud->integer[INT_BODY][a])->slope;
    PetscReal n[DIM], G[DIM], *slope = slopes->slope + DIM * a;

    if (share == 0 || unit == 0) continue;
    SmoothNormal(cloud, a, &row, n);
    HeatGradient(cloud, cloud->field[FIELD_TEMPERATURE], a, &row, G);
    for (PetscInt d = 0; d < DIM; d++) {
      slope[d] = unit * (G[d] - Dot(G, n) / PetscMax(Dot(n, n), PETSC_MIN_REAL) * n[d]);
      acceleration[DIM * a + d] += share * slope[d];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The pressure sigma kappa of the tension is that of its value at the place, and its slope along the surface has that
   of the tension. */
static PetscErrorCode Surround(const Step *step)
{
  Slopes          *slopes = (Slopes *)step->own;
  const Cloud      cloud  = step->cloud;
  const PetscReal *T = cloud->field[FIELD_TEMPERATURE], T0 = Reference(cloud->scene);

  PetscFunctionBegin;
  if (!slopes->found) PetscFunctionReturn(PETSC_SUCCESS); /* a packing is settled without forces */
  slopes->found = PETSC_FALSE;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal sigma  = BodyMaterial(SceneBody(cloud->scene, cloud->integer[INT_BODY][a]))->tension,
                    change = Of(cloud->scene, cloud->integer[INT_BODY][a])->slope * (T[a] - T0);
    PetscReal *pressure = cloud->field[FIELD_CAPILLARY] + a, *slope = slopes->slope + DIM * a;

    if (sigma == 0 || *pressure == 0) continue;
    for (PetscInt d = 0; d < DIM; d++) {
      PetscReal *along = cloud->field[FIELD_CAPILLARY_SLOPE] + DIM * a + d;

      *along = *along * (1 + change / sigma) + *pressure * slope[d] / sigma;
    }
    *pressure *= 1 + change / sigma;
  }
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
  PetscReal  *a = cloud->field[FIELD_ACCELERATION], *work = step->sums, before;

  PetscFunctionBegin;
  if (Floats(cloud->scene, NULL)) {
    before = Power(cloud, a);
    AddWeight(cloud, a);
    work[0] += step->dt * (Power(cloud, a) - before);
  }
  if (Pulls(cloud->scene, NULL)) {
    before = Power(cloud, a);
    PetscCall(AddTension(cloud, (Slopes *)step->own, a));
    work[1] += step->dt * (Power(cloud, a) - before);
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
    BodyScales        scales;
    PetscReal         swing = 0;

    SceneBodyScales(scene, b, &scales);
    for (PetscInt d = 0; d < DIM; d++) swing += PetscAbsReal(of->slope[d]) * scales.extent[d];
    low  = PetscMin(low, of->start);
    high = PetscMax(high, of->start + swing);
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
  PetscCall(PetscFree(((Slopes *)step->own)->slope));
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
  for (PetscInt k = 0; k < 2; k++) work[k] += step->sums[k];
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

static const NumberRow rows[]     = {{"buoyancy_work", NUMBER_REAL, 0, ENERGY_GIVEN, "buoyancy"},
                                     {"thermal_tension_work", NUMBER_REAL, sizeof(PetscReal), ENERGY_GIVEN,
                                      "tension that varies"},
                                     {.name = NULL}};
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
                         .number_size = 2 * sizeof(PetscReal),
                         .numbers     = rows,
                         .sums        = 2, /* works of buoyancy and of tension, J */
                         .data_size   = sizeof(Slopes),
                         .destroy     = Destroy,
                         .on          = On,
                         .bound       = Bound,
                         .drives      = Drives,
                         .speed       = Speed,
                         .thicken     = Thicken,
                         .force       = Force,
                         .surround    = Surround,
                         .commit      = Commit};
