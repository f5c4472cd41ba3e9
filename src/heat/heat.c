/* What a body has of heat: its properties. */
#include "heat_impl.h"

static const OptionRow of_bodies[] = {
  {"-temperature", "Temperature at the start; 0: the scene has none", "K", "[0, inf)", ROW_REAL,
   offsetof(BodyHeat, temperature)},
  {"-thermal_conductivity", "Thermal conductivity, of a liquid with a temperature", "W/(m K)", "[0, inf)", ROW_REAL,
   offsetof(BodyHeat, conductivity), .changes = PETSC_TRUE},
  {"-heat_capacity", "Specific heat capacity", "J/(kg K)", "(0, inf)", ROW_REAL, offsetof(BodyHeat, capacity)},
  {.name = NULL},
};

#define WATER_CAPACITY 4184. /* J/(kg K), as water has at 20 degrees Celsius */

static void Defaults(void *data)
{
  ((BodyHeat *)data)->capacity = WATER_CAPACITY;
}

static PetscErrorCode Check(Domain domain, const char prefix[], void *data)
{
  const BodyHeat *heat = (const BodyHeat *)data;

  PetscFunctionBegin;
  PetscCheckUser(heat->conductivity == 0 || heat->temperature > 0, domain->comm,
                 "-%sthermal_conductivity needs -%stemperature, in K", prefix, prefix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

const Property HeatProperties[] = {{OWNER_BODY, sizeof(BodyHeat), of_bodies, Defaults, Check}, {.rows = NULL}};

const BodyHeat *HeatOf(Scene scene, PetscInt body)
{
  return (const BodyHeat *)BodyOwn(SceneBody(scene, body), HeatProperties);
}

PetscBool HeatOn(Scene scene, Tension tension)
{
  for (PetscInt b = 0; scene && b < SceneCount(scene); b++)
    if (HeatOf(scene, b)->temperature > 0) return PETSC_TRUE;
  return PETSC_FALSE;
}
