/* Gauges: where the axis, the level and the crater are. */
#include "output_impl.h"

/* Default of the jet radius, in half widths of the last body. */
#define JET_RADIUS 1.1
/* Default size of the cells that decide what is connected, in spacings. */
#define CELL_SIZE 1.25
/* Neighbours within a sheet or thread are closer than this, in spacings; a drop that has left the rim is not. */
#define CONNECTION 1.25
#define CELL_LEAST 1.0
#define CELL_MOST  4.0

void GaugeBodyBounds(Output output, PetscInt body, PetscReal lower[DIM], PetscReal upper[DIM])
{
  const Domain domain = output->cloud->domain;

  BodyBounds(SceneBody(output->cloud->scene, body), lower, upper);
  for (PetscInt d = 0; d < DIM; d++) {
    lower[d] = PetscMax(lower[d], domain->lower[d]);
    upper[d] = PetscMin(upper[d], domain->upper[d]);
  }
}

/* Axis and jet radius from the last body, as it is with its mirror images; the crater is looked for up to half way to
 * the box. */
PetscErrorCode GaugesDefaults(Output output)
{
  const Domain domain = output->cloud->domain;
  GaugeSetup  *gauge  = &output->gauge;
  PetscReal    lower[DIM], upper[DIM], half = 0;

  PetscFunctionBegin;
  GaugeBodyBounds(output, SceneCount(output->cloud->scene) - 1, lower, upper);
  gauge->axis[1] = 0;
  for (PetscInt d = 0; d < domain->dim - 1; d++) {
    const PetscReal near = 0.5 * domain->spacing;

    gauge->axis[d] = 0.5 * (lower[d] + upper[d]);
    if (domain->face[d][0] == FACE_SYMMETRY && lower[d] < domain->lower[d] + near)
      gauge->axis[d] = domain->lower[d];
    else if (domain->face[d][1] == FACE_SYMMETRY && upper[d] > domain->upper[d] - near)
      gauge->axis[d] = domain->upper[d];
    half = PetscMax(half, PetscMax(upper[d] - gauge->axis[d], gauge->axis[d] - lower[d]));
  }
  PetscCall(PetscStrncpy(gauge->pool_name, BodyName(SceneBody(output->cloud->scene, 0)), sizeof(gauge->pool_name)));
  gauge->level        = NAN;
  gauge->jet_radius   = JET_RADIUS * half;
  gauge->cell         = CELL_SIZE;
  gauge->connection   = CONNECTION;
  gauge->multiplicity = 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Half of the distance from the axis to the nearest face of the box that is no mirror through the axis, m. */
static PetscReal CraterRadius(Output output)
{
  const Domain domain = output->cloud->domain;
  PetscReal    radius = PETSC_MAX_REAL;

  for (PetscInt d = 0; d < domain->dim - 1; d++) {
    const PetscReal distance[2] = {output->gauge.axis[d] - domain->lower[d], domain->upper[d] - output->gauge.axis[d]};

    for (PetscInt side = 0; side < 2; side++)
      if (domain->face[d][side] != FACE_SYMMETRY || distance[side] > 0.5 * domain->spacing)
        radius = PetscMin(radius, 0.5 * distance[side]);
  }
  return radius;
}

PetscErrorCode GaugesSetFromOptions(Output output, OptionItems PetscOptionsObject)
{
  const Domain domain = output->cloud->domain;
  GaugeSetup  *gauge  = &output->gauge;
  PetscInt     n      = domain->dim; /* one more than wanted, to notice it */
  PetscBool    set;

  PetscFunctionBegin;
  PetscCall(PetscOptionsString("-gauge_pool", "Body that is the pool", "OutputGauges", gauge->pool_name,
                               gauge->pool_name, sizeof(gauge->pool_name), NULL));
  PetscCall(PetscOptionsReal("-gauge_level", "Level of the undisturbed surface, m; nan: measured at the first state",
                             "OutputGauges", gauge->level, &gauge->level, NULL));
  PetscCall(PetscOptionsRealArray("-gauge_axis", "Axis of the impact, x,y (in two dimensions x), m", "OutputGauges",
                                  gauge->axis, &n, &set));
  gauge->axis_numbers = set ? n : domain->dim - 1;
  PetscCall(PetscOptionsReal("-gauge_jet_radius", "Liquid within this distance of the axis is jet, not crown, m",
                             "OutputGauges", gauge->jet_radius, &gauge->jet_radius, NULL));
  gauge->crater_radius = CraterRadius(output);
  PetscCall(PetscOptionsReal("-gauge_crater_radius", "The crater is looked for within this distance of the axis, m",
                             "OutputGauges", gauge->crater_radius, &gauge->crater_radius, NULL));
  PetscCall(PetscOptionsReal("-gauge_cell",
                             "Cells that tell liquid from air for the crater's depth and diameter, in spacings",
                             "OutputGauges", gauge->cell, &gauge->cell, NULL));
  PetscCall(PetscOptionsReal("-gauge_connection",
                             "Particles closer than this hang together, for crown and jet, in spacings", "OutputGauges",
                             gauge->connection, &gauge->connection, NULL));
  PetscCall(PetscOptionsReal("-gauge_multiplicity",
                             "Factor of energies and volume, 4 for a quarter of a symmetric scene", "OutputGauges",
                             gauge->multiplicity, &gauge->multiplicity, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode GaugesCheck(Output output)
{
  const PetscInt numbers = output->cloud->domain->dim - 1;
  const Scene    scene   = output->cloud->scene;
  GaugeSetup    *gauge   = &output->gauge;

  PetscFunctionBegin;
  PetscCheckUser(gauge->axis_numbers == numbers, output->comm, "-gauge_axis has %d numbers; it needs %d.",
                 (int)gauge->axis_numbers, (int)numbers);
  for (gauge->pool = 0; gauge->pool < SceneCount(scene); gauge->pool++)
    if (!strcmp(gauge->pool_name, BodyName(SceneBody(scene, gauge->pool)))) break;
  PetscCheckUser(gauge->pool < SceneCount(scene), output->comm, "-gauge_pool is %s, which is none of -bodies.",
                 gauge->pool_name);
  PetscCheckUser(gauge->jet_radius >= 0, output->comm, "-gauge_jet_radius is %g m; it must not be negative.",
                 (double)gauge->jet_radius);
  PetscCheckUser(gauge->crater_radius >= 0, output->comm,
                 "-gauge_crater_radius is %g m; it must not be negative, and -gauge_axis must lie in the box.",
                 (double)gauge->crater_radius);
  PetscCheckUser(gauge->connection > 0 && gauge->connection <= 2, output->comm,
                 "-gauge_connection is %g spacings; it must lie in (0, 2]", (double)gauge->connection);
  PetscCheckUser(gauge->cell >= CELL_LEAST && gauge->cell <= CELL_MOST, output->comm,
                 "-gauge_cell is %g spacings; it must be from %g to %g.", (double)gauge->cell, CELL_LEAST, CELL_MOST);
  PetscCheckUser(gauge->multiplicity > 0, output->comm, "-gauge_multiplicity is %g; it must be positive.",
                 (double)gauge->multiplicity);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt GaugeMirrors(Output output)
{
  const Domain domain  = output->cloud->domain;
  PetscInt     mirrors = 0;

  for (PetscInt d = 0; d < domain->dim - 1; d++) {
    const PetscReal near = 0.5 * domain->spacing, axis = output->gauge.axis[d];

    mirrors += (domain->face[d][0] == FACE_SYMMETRY && axis < domain->lower[d] + near) ||
               (domain->face[d][1] == FACE_SYMMETRY && axis > domain->upper[d] - near);
  }
  return mirrors;
}
