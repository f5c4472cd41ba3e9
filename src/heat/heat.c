/* What bodies, faces, solids and the air have of heat and of a concentration: properties. */
#include "heat_impl.h"

#define NO_VALUE       (-PETSC_MAX_REAL) /* null in scene.json */
#define WATER_CAPACITY 4184.             /* J/(kg K), as water has at 20 degrees Celsius */

static const OptionRow of_temperature[] = {
  {"-temperature", "Temperature at the start; 0: the scene has none", "K", "[0, inf)", ROW_REAL,
   offsetof(BodyScalar, start)},
  {"-temperature_gradient", "Gradient of the temperature at the start, which is -<body>_temperature at the origin",
   "K/m", NULL, ROW_DIRECTION, offsetof(BodyScalar, slope)},
  {"-thermal_conductivity", "Thermal conductivity, of a liquid with a temperature", "W/(m K)", "[0, inf)", ROW_REAL,
   offsetof(BodyScalar, conductivity), .changes = PETSC_TRUE},
  {"-heat_capacity", "Specific heat capacity", "J/(kg K)", "(0, inf)", ROW_REAL, offsetof(BodyScalar, capacity)},
  {.name = NULL},
};
static const OptionRow of_concentration[] = {
  {"-concentration", "Concentration of a solute or a dye at the start, in any unit of an amount in a volume", "1",
   "[0, inf)", ROW_REAL, offsetof(BodyScalar, start)},
  {"-diffusivity", "Diffusivity of the concentration", "m2/s", "[0, inf)", ROW_REAL, offsetof(BodyScalar, conductivity),
   .changes = PETSC_TRUE},
  {.name = NULL},
};
static const OptionRow warm_side[] = {
  {"-temperature", "Temperature that the wall or solid holds", "K", "(0, inf)", ROW_REAL, offsetof(Side, value),
   .fallback = "insulated", .changes = PETSC_TRUE},
  {"-heat_flux", "Heat that it gives the liquid", "W/m2", "(-inf, inf)", ROW_REAL, offsetof(Side, flux),
   .changes = PETSC_TRUE},
  {.name = NULL},
};
static const OptionRow soluble_side[] = {
  {"-concentration", "Concentration that the liquid has at the wall or solid", "1", "[0, inf)", ROW_REAL,
   offsetof(Side, value), .fallback = "none", .changes = PETSC_TRUE},
  {.name = NULL},
};
static const OptionRow of_air[] = {
  {"-surface_heat_transfer", "Heat transfer from the free surface to the air", "W/(m2 K)", "[0, inf)", ROW_REAL,
   offsetof(Air, transfer), .changes = PETSC_TRUE},
  {"-ambient_temperature", "Temperature of that air; 0: not given", "K", "[0, inf)", ROW_REAL, offsetof(Air, ambient),
   .changes = PETSC_TRUE},
  {.name = NULL},
};

static void BodyDefaults(void *data)
{
  ((BodyScalar *)data)->capacity = WATER_CAPACITY;
}

static void SideDefaults(void *data)
{
  ((Side *)data)->value = NO_VALUE;
}

static PetscErrorCode CheckBody(Domain domain, const char prefix[], void *data)
{
  const BodyScalar *heat  = (const BodyScalar *)data;
  const PetscReal   slope = Norm(heat->slope);

  PetscFunctionBegin;
  PetscCheckUser(heat->conductivity == 0 || heat->start > 0, domain->comm,
                 "-%sthermal_conductivity needs -%stemperature, in K", prefix, prefix);
  PetscCheckUser(slope == 0 || heat->start > 0, domain->comm, "-%stemperature_gradient needs -%stemperature, in K",
                 prefix, prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckSide(Domain domain, const char prefix[], void *data)
{
  Side *side = (Side *)data;

  PetscFunctionBegin;
  side->holds = (PetscBool)(side->value > 0.5 * NO_VALUE); /* typed out it is rounded */
  PetscCheckUser(!side->holds || side->flux == 0, domain->comm,
                 "-%stemperature and -%sheat_flux exclude each other: give the one that is known", prefix, prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckAir(Domain domain, const char prefix[], void *data)
{
  const Air *air = (const Air *)data;

  PetscFunctionBegin;
  PetscCheckUser((air->transfer > 0) == (air->ambient > 0), domain->comm,
                 "-surface_heat_transfer, in W/(m2 K), and -ambient_temperature, in K, need each other");
  PetscFunctionReturn(PETSC_SUCCESS);
}

enum { OF_HEAT, HOT_FACE, HOT_SOLID, COOL_AIR, OF_SOLUTE, WET_FACE, WET_SOLID };
const Property HeatProperties[] = {
  [OF_HEAT]   = {OWNER_BODY, sizeof(BodyScalar), of_temperature, BodyDefaults, CheckBody},
  [HOT_FACE]  = {OWNER_FACE, sizeof(Side), warm_side, SideDefaults, CheckSide},
  [HOT_SOLID] = {OWNER_SOLID, sizeof(Side), warm_side, SideDefaults, CheckSide},
  [COOL_AIR]  = {OWNER_SCENE, sizeof(Air), of_air, NULL, CheckAir},
  [OF_SOLUTE] = {OWNER_BODY, sizeof(BodyScalar), of_concentration},
  [WET_FACE]  = {OWNER_FACE, sizeof(Side), soluble_side, SideDefaults, CheckSide},
  [WET_SOLID] = {OWNER_SOLID, sizeof(Side), soluble_side, SideDefaults, CheckSide},
  {.rows = NULL},
};

const Scalar Scalars[SCALARS] = {
  {"temperature", "K", "heat", "J", "W", FIELD_TEMPERATURE, PETSC_TRUE, HeatProperties + OF_HEAT,
   HeatProperties + HOT_FACE, HeatProperties + HOT_SOLID, HeatProperties + COOL_AIR},
  {"concentration", NULL, "solute", "m3", "m3/s", FIELD_CONCENTRATION, PETSC_FALSE, HeatProperties + OF_SOLUTE,
   HeatProperties + WET_FACE, HeatProperties + WET_SOLID, NULL},
};

const BodyScalar *ScalarOf(Scene scene, const Scalar *scalar, PetscInt body)
{
  return (const BodyScalar *)BodyOwn(SceneBody(scene, body), scalar->body);
}

const Side *SideOf(Scene scene, const Scalar *scalar, PetscInt receiver)
{
  const Side *side = receiver < 2 * DIM ? (const Side *)SceneFaceOwn(scene, receiver / 2, receiver % 2, scalar->face)
                                        : (const Side *)BodyOwn(SceneSolid(scene, receiver - 2 * DIM), scalar->solid);

  return side && (side->holds || side->flux != 0) ? side : NULL;
}

PetscBool ScalarOn(Scene scene, const Scalar *scalar)
{
  for (PetscInt b = 0; scene && b < SceneCount(scene); b++)
    if (ScalarOf(scene, scalar, b)->start > 0 || ScalarOf(scene, scalar, b)->conductivity > 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscBool HeatOn(Scene scene, Tension tension)
{
  return ScalarOn(scene, &Scalars[0]);
}

PetscBool ConcentrationOn(Scene scene, Tension tension)
{
  return ScalarOn(scene, &Scalars[1]);
}

PetscReal ScalarStore(Cloud cloud, const Scalar *scalar, PetscInt a)
{
  const PetscReal V = cloud->volume[a];

  return scalar->by_mass
           ? V * cloud->rest_density[a] * ScalarOf(cloud->scene, scalar, cloud->integer[INT_BODY][a])->capacity
           : V;
}
