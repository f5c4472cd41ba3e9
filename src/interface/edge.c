/* The interface in a step: its energy, and the work of the jumps of the pressure. */
#include "../stepper/edge.h"
#include "interface_impl.h"

static PetscBool On(const Step *step)
{
  return (PetscBool)(SceneInterfaceTension(step->scene) > 0);
}

static PetscErrorCode Create(const Step *step)
{
  PetscFunctionBegin;
  if (On(step)) TensionSetSurfaces(step->tension, InterfaceApply);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void WriteJson(const Step *step, Json *json)
{
  JsonReal(json, "interface_tension", SceneInterfaceTension(step->scene));
}

/* n, the sum of V grad W (1/m) over the neighbours of the other liquid of particle a; adds the flow (m3/s) into a's
   liquid through a's part of the interface at the velocity v ([n_total][3], m/s) to *flow, unless this is NULL. */
static void Normal(Cloud cloud, PetscInt a, const PetscReal v[], PetscReal n[DIM], PetscReal *flow)
{
  const PetscReal *x = cloud->field[FIELD_POSITION];
  PetscReal        scale_w, scale_f, inverse_h2;

  KernelScales(cloud->kernel, &scale_w, &scale_f, &inverse_h2);
  n[0] = n[1] = n[2] = 0;
  for (PetscInt64 k = cloud->first[a]; k < cloud->first[a + 1]; k++) {
    const PetscInt  b = cloud->list[k];
    const PetscReal f = cloud->domain->volume * scale_f * cloud->slope[k];

    if (cloud->integer[INT_LAYER][b] != 0 || !CloudAcross(cloud, a, b)) continue; /* a wall is no interface */
    for (PetscInt d = 0; d < DIM; d++) {
      const PetscReal part = f * (x[DIM * a + d] - x[DIM * b + d]);

      n[d] += part;
      if (flow) *flow -= cloud->volume[a] * part * (v[DIM * a + d] + v[DIM * b + d]);
    }
  }
}

/* Adds sigma times the area of the interface, J: the integral of |sum V grad W| over the liquid on each side is half
   the area. */
static PetscErrorCode Diagnose(const Step *step)
{
  const Cloud cloud = step->cloud;
  PetscReal   area  = 0, n[DIM];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    Normal(cloud, a, NULL, n, NULL);
    area += cloud->volume[a] * Norm(n);
  }
  step->trial->sum[SUM_SURFACE_ENERGY] += SceneInterfaceTension(cloud->scene) * area;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The work of tension on the whole surface of each liquid, towards gas and the other liquid, with its part of the
   pressure, cloud->pressure_jump, at the velocity v in the middle of the step: as on the free surface. */
static PetscErrorCode Work(const Step *step, PetscReal v[])
{
  const Cloud      cloud  = step->cloud;
  const PetscReal *normal = cloud->field[FIELD_NORMAL];

  PetscFunctionBegin;
  PetscCall(CloudUpdateArray(cloud, DIM, PARITY_VECTOR, v));
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscInt at = SUM_SURFACES + SURFACE_SUMS * (1 + cloud->liquid[a]);
    PetscReal      n[DIM], flow, area = OperatorsSurfaceArea(cloud, a, 0);

    flow = area > 0 ? 2 * cloud->volume[a] * Dot(v + DIM * a, normal + DIM * a) : 0;
    if (cloud->at_interface[a]) {
      Normal(cloud, a, v, n, &flow);
      area += 2 * cloud->volume[a] * Norm(n);
    }
    step->trial->sum[SUM_TENSION_WORK] += cloud->pressure_jump[a] * step->dt * flow;
    step->trial->sum[at] += step->dt * flow;
    step->trial->sum[at + 1] += area;
    step->trial->sum[at + 2] += cloud->pressure_jump[a] * area;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define INTERFACE "-interface_tension"

static const Refusal refusals[] = {
  {INTERFACE, NOT_WITH, "-spacing_coarse", " yet"},
  {INTERFACE, NOT_WITH, FEATURE_ANGLES, " yet: the interface would have another angle than the free surface"},
  {INTERFACE, NEEDS, FEATURE_CONSISTENT, ", the default"},
  {INTERFACE, NEEDS, "-tension_type " TENSION_CURVATURE, ", the default"},
  {.one = NULL},
};

const Edge InterfaceEdge = {.name     = "interface",
                            .refusals = refusals,
                            .on       = On,
                            .json     = WriteJson,
                            .create   = Create,
                            .diagnose = Diagnose,
                            .work     = Work};
