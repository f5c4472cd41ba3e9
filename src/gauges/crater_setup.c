/* Options of the crater gauge: axis, pool and crater of an impact. */
#include "gauges_impl.h"

#define JET_RADIUS 1.1 /* default of -gauge_jet_radius, half widths of the last body: a little wider than the drop */
#define NEAR       0.5 /* spacings: an axis or a body closer than this to a mirror lies on the mirror */

void GaugeBodyBounds(Gauges gauges, PetscInt body, PetscReal lower[DIM], PetscReal upper[DIM])
{
  const Domain domain = gauges->cloud->domain;

  BodyBounds(SceneBody(gauges->cloud->scene, body), lower, upper);
  for (PetscInt d = 0; d < DIM; d++) {
    lower[d] = PetscMax(lower[d], domain->lower[d]);
    upper[d] = PetscMin(upper[d], domain->upper[d]);
  }
}

/* Whether the interval lower..upper (m) reaches a mirror on this side of the box. */
static PetscBool OnMirror(Domain domain, PetscInt d, PetscInt side, PetscReal lower, PetscReal upper)
{
  const PetscReal near = NEAR * domain->spacing;

  if (domain->face[d][side] != FACE_SYMMETRY) return PETSC_FALSE;
  return (PetscBool)(side ? upper > domain->upper[d] - near : lower < domain->lower[d] + near);
}

PetscInt CraterMirrors(Gauges gauges, const Crater *crater)
{
  const Domain     domain  = gauges->cloud->domain;
  const PetscReal *axis    = crater->axis;
  PetscInt         mirrors = 0;

  for (PetscInt d = 0; d < domain->dim - 1; d++)
    mirrors += OnMirror(domain, d, 0, axis[d], axis[d]) || OnMirror(domain, d, 1, axis[d], axis[d]);
  return mirrors;
}

/* The pool is the first body. Axis and jet radius are those of the last body together with its mirror images. */
void CraterDefaults(Gauges gauges, void *data)
{
  Crater      *crater = data;
  const Domain domain = gauges->cloud->domain;
  const Scene  scene  = gauges->cloud->scene;
  PetscReal    lower[DIM], upper[DIM], half = 0;

  if (!SceneCount(scene)) return;
  GaugeBodyBounds(gauges, SceneCount(scene) - 1, lower, upper);
  for (PetscInt d = 0; d < domain->dim - 1; d++) {
    crater->axis[d] = 0.5 * (lower[d] + upper[d]);
    if (OnMirror(domain, d, 0, lower[d], upper[d]))
      crater->axis[d] = domain->lower[d];
    else if (OnMirror(domain, d, 1, lower[d], upper[d]))
      crater->axis[d] = domain->upper[d];
    half = PetscMax(half, PetscMax(upper[d] - crater->axis[d], crater->axis[d] - lower[d]));
  }
  crater->jet_radius = JET_RADIUS * half;
}

/* Half the distance (m) from the axis to the nearest face of the box, other than mirrors through the axis. */
static PetscReal CraterRadius(Gauges gauges, const Crater *crater)
{
  const Domain     domain = gauges->cloud->domain;
  const PetscReal *axis   = crater->axis;
  PetscReal        radius = PETSC_MAX_REAL;

  for (PetscInt d = 0; d < domain->dim - 1; d++) {
    const PetscReal distance[2] = {axis[d] - domain->lower[d], domain->upper[d] - axis[d]};

    for (PetscInt side = 0; side < 2; side++)
      if (domain->face[d][side] != FACE_SYMMETRY || distance[side] > NEAR * domain->spacing)
        radius = PetscMin(radius, 0.5 * distance[side]);
  }
  return radius;
}

const OptionRow CraterOptions[] = {
  {"-gauge_axis", "Axis of the impact, x,y (in two dimensions x)", "m", NULL, ROW_NUMBERS, offsetof(Crater, given),
   .fallback = "that of the last body", .most = DIM},
  {"-gauge_jet_radius", "Radius around the axis that separates jet from crown", "m", "[0, inf)", ROW_REAL,
   offsetof(Crater, jet_radius), .fallback = "1.1 half widths of the last body"},
  {.name = NULL},
};

static const OptionRow wanted[] = {
  {"-gauge_crater", "Write heights of crown and jet, depth and diameter of the crater in the first body to the series",
   NULL, NULL, ROW_BOOL, offsetof(Crater, wanted), .fallback = "true if -gauge_axis or -gauge_jet_radius is given"},
  {.name = NULL},
};

PetscErrorCode CraterMore(Gauges gauges, OptionItems PetscOptionsObject, void *data)
{
  Crater *crater = data;

  PetscFunctionBegin;
  for (const OptionRow *row = CraterOptions; row->name && !crater->wanted; row++)
    PetscCall(PetscOptionsHasName(NULL, NULL, row->name, &crater->wanted));
  for (PetscInt d = 0; d < crater->given.count; d++) crater->axis[d] = crater->given.value[d];
  crater->radius = CraterRadius(gauges, crater);
  PetscCall(OptionsRead(PetscOptionsObject, wanted, "GaugesSetFromOptions", crater));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode CraterCheck(Gauges gauges, void *data)
{
  const PetscInt numbers = gauges->cloud->domain->dim - 1;
  Crater        *crater  = data;

  PetscFunctionBegin;
  if (!crater->wanted) {
    if (!gauges->level_given) gauges->level = 0; /* no crater measures it */
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCheckUser(!crater->given.count || crater->given.count == numbers, gauges->comm,
                 "-gauge_axis has %d numbers; it needs %d.", (int)crater->given.count, (int)numbers);
  PetscCheckUser(crater->radius >= 0, gauges->comm, "-gauge_axis must lie in the box.");
  PetscFunctionReturn(PETSC_SUCCESS);
}
