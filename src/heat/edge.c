/* Scalars in a step: liquid has the temperature and the concentration of its body, and they spread. */
#include "heat_impl.h"

#define RESOLVED 0.5 /* h^2 over the diffusivity, the longest step: 0.1 % of a step in a strip of 50 spacings */

/* The books of a scalar, in its unit of amounts. */
typedef struct {
  PetscReal start, now, walls, air,
    brought; /* at the start, now, what was given, and came with liquid less what left */
  PetscInt begun;
} Books;
enum { BEFORE, AFTER, BY_WALLS, BY_AIR, SUMS }; /* sums of a step */

static PetscBool On(const Step *step)
{
  return (PetscBool)(HeatOn(step->scene, NULL) || ConcentrationOn(step->scene, NULL));
}

/* A body's value at x (m). */
static PetscReal StartOf(const BodyScalar *of, const PetscReal x[DIM])
{
  return of->start + Dot(of->slope, x);
}

static void StartTemperature(Scene scene, PetscInt body, const PetscReal x[DIM], PetscReal value[])
{
  value[0] = StartOf(ScalarOf(scene, &Scalars[0], body), x);
}

static void StartConcentration(Scene scene, PetscInt body, const PetscReal x[DIM], PetscReal value[])
{
  value[0] = StartOf(ScalarOf(scene, &Scalars[1], body), x);
}

static const EdgeField fields[] = {{FIELD_TEMPERATURE, HeatOn, StartTemperature},
                                   {FIELD_CONCENTRATION, ConcentrationOn, StartConcentration},
                                   {.needed = NULL}};

static void Bound(const Step *step, PetscReal scale, StepBound *bound)
{
  const Scene     scene = step->scene;
  const PetscReal h     = scale * KernelSmoothingLength(step->cloud->kernel);

  bound->name  = "heat";
  bound->cause = "conduction of heat, or diffusion";
  bound->lift  = "a larger -spacing";
  for (PetscInt k = 0; k < SCALARS; k++)
    for (PetscInt b = 0; b < SceneCount(scene) && ScalarOn(scene, &Scalars[k]); b++) {
      const BodyScalar *of    = ScalarOf(scene, &Scalars[k], b);
      const PetscReal   store = Scalars[k].by_mass ? BodyMaterial(SceneBody(scene, b))->density * of->capacity : 1;

      if (of->conductivity > 0) bound->step = PetscMin(bound->step, RESOLVED * h * h * store / of->conductivity);
    }
}

/* The amount of a scalar in this rank's liquid. */
static PetscReal Amount(Cloud cloud, const Scalar *scalar)
{
  PetscReal sum = 0;

  for (PetscInt a = 0; a < cloud->n_fluid; a++) sum += ScalarStore(cloud, scalar, a) * cloud->field[scalar->field][a];
  return sum;
}

static PetscErrorCode Kick(const Step *step)
{
  const Cloud cloud  = step->cloud;
  HeatSpread *spread = (HeatSpread *)step->own;
  PetscReal   gained[RECEIVERS];

  PetscFunctionBegin;
  if (step->damping != 1) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < SCALARS; k++) {
    PetscReal *sum = step->sums + SUMS * k;

    if (!ScalarOn(cloud->scene, &Scalars[k])) continue;
    sum[BEFORE] = Amount(cloud, &Scalars[k]);
    PetscCall(SpreadFind(spread, cloud, &Scalars[k]));
    PetscCall(SpreadStep(spread, cloud, &Scalars[k], step->dt, gained));
    sum[AFTER] = Amount(cloud, &Scalars[k]);
    for (PetscInt r = 0; r < RECEIVERS; r++) sum[r == OF_AIR ? BY_AIR : BY_WALLS] += gained[r];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Shifted(const Step *step, const PetscReal moved[])
{
  const Cloud cloud = step->cloud;

  PetscFunctionBegin;
  if (step->damping != 1) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < SCALARS; k++)
    if (ScalarOn(cloud->scene, &Scalars[k])) PetscCall(SpreadShift(cloud, &Scalars[k], moved));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Commit(const Step *step, StepState *state)
{
  Books *books = (Books *)StepNumbers(step, state);

  PetscFunctionBegin;
  for (PetscInt k = 0; k < SCALARS; k++, books++) {
    const PetscReal *sum = step->sums + SUMS * k;

    if (!books->begun) books->start = books->now = sum[BEFORE];
    books->begun = 1;
    books->brought += sum[BEFORE] - books->now;
    books->walls += sum[BY_WALLS];
    books->air += sum[BY_AIR];
    books->now = sum[AFTER];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define BOOK(k, name, what)                                                                                            \
  {                                                                                                                    \
    name, NUMBER_REAL, (k) * sizeof(Books) + offsetof(Books, what), ENERGY_NONE, NULL                                  \
  }
#define BOOKS(k, name)                                                                                                 \
  BOOK(k, name "_start", start), BOOK(k, name "_now", now), BOOK(k, name "_by_walls", walls),                          \
    BOOK(k, name "_by_air", air), BOOK(k, name "_brought", brought),                                                   \
  {                                                                                                                    \
    name "_begun", NUMBER_COUNT, (k) * sizeof(Books) + offsetof(Books, begun), ENERGY_NONE, NULL                       \
  }
static const NumberRow rows[] = {BOOKS(0, "heat"), BOOKS(1, "solute"), {.name = NULL}};

static PetscErrorCode Report(Scene scene, const void *numbers, PetscReal copies, const char joule[], char text[],
                             size_t length)
{
  const Books *books = (const Books *)numbers;

  PetscFunctionBegin;
  text[0] = 0;
  for (PetscInt k = 0; k < SCALARS; k++, books++) {
    const Scalar   *scalar = &Scalars[k];
    const PetscReal gain = books->now - books->start, rest = gain - books->walls - books->air - books->brought;
    char            line[512];

    if (!books->begun || !ScalarOn(scene, scalar)) continue;
    PetscCall(PetscSNPrintf(line, sizeof(line),
                            "  %-11s %.6g %s, %+.4g since the start: faces and solids gave %.4g, the air %.4g, liquid "
                            "that came or left %.4g; residual %+.2g\n",
                            scalar->amount, (double)(copies * books->now),
                            DomainUnit(SceneDomain(scene), scalar->amount_unit), (double)(copies * gain),
                            (double)(copies * books->walls), (double)(copies * books->air),
                            (double)(copies * books->brought), (double)(copies * rest)));
    TextAppend(text, length, line);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy(const Step *step)
{
  PetscFunctionBegin;
  PetscCall(SpreadFree((HeatSpread *)step->own));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define CONCENTRATION "-<body>_concentration"
#define COLD          "bodies without -<body>_temperature"
#define HOT_SIDES     "a temperature or a heat flux of a face, a solid or the air"
#define WET_SIDES     "a concentration of a face or a solid"

/* Whether a body has no temperature where another has one. */
static PetscBool Cold(Scene scene, Tension tension)
{
  for (PetscInt b = 0; HeatOn(scene, tension) && b < SceneCount(scene); b++)
    if (ScalarOf(scene, &Scalars[0], b)->start == 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

static PetscBool HasSides(Scene scene, const Scalar *scalar)
{
  for (PetscInt r = 0; scene && r < 2 * DIM + SceneSolidCount(scene); r++)
    if (SideOf(scene, scalar, r)) return PETSC_TRUE;
  return (PetscBool)(scene && scalar->air && ((const Air *)SceneOwn(scene, scalar->air))->transfer > 0);
}

static PetscBool HotSides(Scene scene, Tension tension)
{
  return HasSides(scene, &Scalars[0]);
}

static PetscBool WetSides(Scene scene, Tension tension)
{
  return HasSides(scene, &Scalars[1]);
}

static const Feature features[] = {{HEAT_OPTION, HeatOn}, {CONCENTRATION, ConcentrationOn},
                                   {COLD, Cold},          {HOT_SIDES, HotSides},
                                   {WET_SIDES, WetSides}, {.name = NULL}};
static const Refusal refusals[] = {
  {HEAT_OPTION, NEEDS, FEATURE_CONSISTENT, ", the default"},
  {CONCENTRATION, NEEDS, FEATURE_CONSISTENT, ", the default"},
  {HEAT_OPTION, NOT_WITH, COLD, "; give all bodies one"},
  {HOT_SIDES, NEEDS_GIVEN, HEAT_OPTION, ""},
  {WET_SIDES, NEEDS_GIVEN, CONCENTRATION, " or -<body>_diffusivity"},
  {.one = NULL},
};

const Edge HeatEdge = {.name        = "heat",
                       .data_size   = sizeof(HeatSpread),
                       .number_size = SCALARS * sizeof(Books),
                       .numbers     = rows,
                       .sums        = SCALARS * SUMS,
                       .properties  = HeatProperties,
                       .fields      = fields,
                       .features    = features,
                       .refusals    = refusals,
                       .gauge       = &GaugeScalars,
                       .destroy     = Destroy,
                       .on          = On,
                       .report      = Report,
                       .bound       = Bound,
                       .kick        = Kick,
                       .shifted     = Shifted,
                       .commit      = Commit};
