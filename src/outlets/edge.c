/* Outlets: open faces of the box whose outside holds a level or a pressure. */
#include "outlets_impl.h"

#define NO_LEVEL (-PETSC_MAX_REAL) /* m; null in scene.json */

#define OF_FACE(name, member, f)                                                                                       \
  {                                                                                                                    \
    name, NUMBER_REAL, offsetof(OutletNumbers, member[f]), ENERGY_NONE, NULL                                           \
  }
#define OF_FACES(name, member)                                                                                         \
  OF_FACE(name "_xmin", member, 0), OF_FACE(name "_xmax", member, 1), OF_FACE(name "_ymin", member, 2),                \
    OF_FACE(name "_ymax", member, 3), OF_FACE(name "_zmin", member, 4), OF_FACE(name "_zmax", member, 5)

static const NumberRow rows[] = {
  {"outlet_work", NUMBER_REAL, offsetof(OutletNumbers, work), ENERGY_GIVEN, "the pressure outside outlets"},
  OF_FACES("outlet", left),
  OF_FACES("outlet_push", push),
  {.name = NULL},
};

static const OptionRow of_faces[] = {
  {"-level",
   "Level that the outside of an open face holds, in the coordinate against gravity; below it the outside has the "
   "hydrostatic pressure. Liquid leaves, none enters",
   "m", "(-inf, inf)", ROW_REAL, offsetof(Outlet, level), .fallback = "none", .changes = PETSC_TRUE},
  {"-pressure", "Pressure outside an open face, over that of the open air; with a level: above it, too", "Pa",
   "(-inf, inf)", ROW_REAL, offsetof(Outlet, pressure), .changes = PETSC_TRUE},
  {.name = NULL},
};

static void Defaults(void *data)
{
  ((Outlet *)data)->level = NO_LEVEL;
}

static PetscErrorCode Check(Domain domain, const char prefix[], void *data)
{
  Outlet *outlet = (Outlet *)data;

  PetscFunctionBegin;
  outlet->has_level = (PetscBool)(outlet->level > 0.5 * NO_LEVEL); /* typed out it is rounded */
  outlet->on        = (PetscBool)(outlet->has_level || outlet->pressure != 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const Property properties[] = {{OWNER_FACE, sizeof(Outlet), of_faces, Defaults, Check}, {.rows = NULL}};

/* Whether a face is an outlet. */
static PetscBool HasOutlets(Scene scene, Tension tension)
{
  for (PetscInt f = 0; scene && f < 2 * DIM; f++)
    if (((const Outlet *)SceneFaceOwn(scene, f / 2, f % 2, properties))->on) return PETSC_TRUE;
  return PETSC_FALSE;
}

static PetscBool On(const Step *step)
{
  return HasOutlets(step->scene, NULL);
}

static PetscErrorCode Create(const Step *step)
{
  Outlets *outlets = (Outlets *)step->own;

  PetscFunctionBegin;
  outlets->cloud    = step->cloud;
  outlets->pressure = step->pressure;
  for (PetscInt f = 0; f < 2 * DIM; f++)
    outlets->face[f / 2][f % 2] = (const Outlet *)SceneFaceOwn(outlets->cloud->scene, f / 2, f % 2, properties);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gravity, the slope of the potential. */
static void FindGravity(Scene scene, PetscReal gravity[DIM])
{
  const PetscReal origin[DIM] = {0, 0, 0};

  for (PetscInt d = 0; d < DIM; d++) {
    PetscReal x[DIM] = {0, 0, 0};

    x[d]       = 1;
    gravity[d] = SceneForcePotential(scene, origin) - SceneForcePotential(scene, x);
  }
}

/* The speed (m/s) of Bernoulli at the largest pressure outside: at a lower corner of the box. Where an emitter sets the
   flow it is too large, and densities are corrected the faster: behind one of 0.05 m/s, against 1500 Pa, the error of
   the density is 0.4 and not 1.1 %, the scatter of the pressure 25 and not 9 Pa, its mean the same to 0.1 %. */
static PetscReal FindSpeed(const Outlets *outlets)
{
  const Domain domain = outlets->cloud->domain;
  PetscReal    most   = 0;

  for (PetscInt f = 0; f < 2 * DIM; f++) {
    const Outlet *outlet = outlets->face[f / 2][f % 2];
    PetscReal     head   = outlet->level * Norm(outlets->gravity);

    for (PetscInt d = 0; d < domain->dim; d++)
      head += PetscMax(outlets->gravity[d] * domain->lower[d], outlets->gravity[d] * domain->upper[d]);
    if (!outlet->has_level) head = 0;
    if (outlet->on) most = PetscMax(most, PetscAbsReal(outlet->pressure) / outlets->density + PetscMax(0, head));
  }
  return PetscSqrtReal(2 * most);
}

static PetscErrorCode Options(const Step *step)
{
  Outlets     *outlets = (Outlets *)step->own;
  const Domain domain  = outlets->cloud->domain;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < 2 * DIM; f++)
    PetscCheckUser(!outlets->face[f / 2][f % 2]->on || domain->face[f / 2][f % 2] == FACE_OPEN, domain->comm,
                   "-box_%s_%s: the face is %s; only an open one has an outside", FaceNames[f / 2][f % 2],
                   outlets->face[f / 2][f % 2]->has_level ? "level" : "pressure",
                   FaceTypes[domain->face[f / 2][f % 2]]);
  if (!On(step)) PetscFunctionReturn(PETSC_SUCCESS);
  FindGravity(outlets->cloud->scene, outlets->gravity);
  outlets->density = BodyMaterial(SceneBody(outlets->cloud->scene, 0))->density;
  outlets->speed   = FindSpeed(outlets);
  for (PetscInt f = 0; f < 2 * DIM; f++)
    PetscCheckUser(!outlets->face[f / 2][f % 2]->has_level || Norm(outlets->gravity) > 0, domain->comm,
                   "-box_%s_level needs -gravity: without it there is no level; -box_%s_pressure is a pressure",
                   FaceNames[f / 2][f % 2], FaceNames[f / 2][f % 2]);
  PetscCall(PressureAddLowRank(step->pressure, &OutletTerm, outlets));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal Speed(const Step *step)
{
  return ((Outlets *)step->own)->speed;
}

static PetscErrorCode Freeze(const Step *step, PetscBool frozen)
{
  PetscFunctionBegin;
  ((Outlets *)step->own)->frozen = frozen;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sums the work of the outsides on the surfaces in front of them. */
static void SumPush(const Outlets *outlets, PetscReal dt, OutletSums *sums)
{
  const Cloud      cloud = outlets->cloud;
  const PetscReal *n = cloud->field[FIELD_NORMAL], *v = cloud->field[FIELD_VELOCITY],
                  *v_new = cloud->field[FIELD_VELOCITY_NEW];

  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscInt  face  = cloud->integer[INT_SURFACE][a] ? OutletsFacing(outlets, a) : -1;
    const PetscReal force = face < 0 ? 0 : 2 * cloud->volume[a] * OutletsPressure(outlets, a, NULL);

    if (force == 0) continue;
    sums->load[face] += force * Norm(n + DIM * a);
    sums->now.push[face] += 0.5 * dt * force * (Dot(n + DIM * a, v + DIM * a) + Dot(n + DIM * a, v_new + DIM * a));
  }
}

static PetscErrorCode Kick(const Step *step)
{
  OutletSums *sums = (OutletSums *)step->sums;

  PetscFunctionBegin;
  SumPush((Outlets *)step->own, step->dt, sums);
  PetscCall(OutletsCalm((Outlets *)step->own, step->dt, step->cloud->field[FIELD_VELOCITY_NEW], &sums->now.work));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What will leave with this step, and the work of the pressure that it leaves against. The work on the surface at its
   velocity, as that of surface tension, is 2.5 % larger in a channel: a surface that particles leave is uneven. So it
   counts beside that on what left only while the surface is in front of the face, or half a spacing behind it. */
static PetscErrorCode Guard(const Step *step)
{
  Outlets    *outlets = (Outlets *)step->own;
  OutletSums *sums    = (OutletSums *)step->sums;
  const Cloud cloud   = step->cloud;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < cloud->n_fluid; a++) {
    const PetscReal *x = cloud->field[FIELD_POSITION] + DIM * a;
    const PetscInt   f = DomainExit(cloud->domain, x);
    PetscReal        P;

    if (f < 0 || !outlets->face[f / 2][f % 2]->on) continue;
    P = OutletOutside(outlets, f / 2, f % 2, x, 0, NULL);
    sums->now.left[f] += cloud->volume[a];
    sums->now.work -= cloud->volume[a] * P;
    sums->against[f] += cloud->volume[a] * P;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The work (J) of an outside on the surface in front of it beside that on what left, after its work 'by' of a step,
   'taken' of it by what left. Their small differences add up in a long flow; so a surface that has not been pushed in
   stays within half a spacing of the face. */
static PetscReal Pushed(PetscReal before, PetscReal by, PetscReal taken, PetscReal half)
{
  const PetscReal now = PetscMax(before + by, -half);

  return now > half ? now + taken : PetscMin(now + taken, half);
}

static PetscErrorCode Commit(const Step *step, StepState *state)
{
  Outlets          *outlets = (Outlets *)step->own;
  OutletNumbers    *so_far  = (OutletNumbers *)StepNumbers(step, state);
  const OutletSums *sum     = (OutletSums *)step->sums;

  PetscFunctionBegin;
  if (outlets->frozen) PetscFunctionReturn(PETSC_SUCCESS);
  so_far->work += sum->now.work;
  for (PetscInt f = 0; f < 2 * DIM; f++) {
    const PetscReal before = so_far->push[f], row = sum->load[f] * outlets->cloud->domain->spacing;

    so_far->left[f] += sum->now.left[f];
    so_far->push[f] = Pushed(before, sum->now.push[f], sum->against[f], 0.5 * row);
    so_far->work += so_far->push[f] - before;
    if (!outlets->higher && row > 0 && so_far->push[f] > row) outlets->higher = f + 1;
  }
  outlets->so_far = *so_far;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An outside that has pushed the surface in by more than a spacing. */
static PetscErrorCode Doubt(const Step *step, char text[], size_t length)
{
  Outlets       *outlets = (Outlets *)step->own;
  const PetscInt f       = outlets->higher - 1;

  PetscFunctionBegin;
  if (f < 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(text, length,
                          "the outside of %s presses more than the liquid inside: liquid would enter there, but none "
                          "does, so a gap opens at the face; an emitter (-<body>_type emitter) brings liquid",
                          FaceNames[f / 2][f % 2]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Renew(const Step *step, PetscBool resumed, StepState *state)
{
  PetscFunctionBegin;
  ((Outlets *)step->own)->so_far = *(OutletNumbers *)StepNumbers(step, state);
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define OUTLET "-box_<face>_level or -box_<face>_pressure"

static const Feature features[] = {{OUTLET, HasOutlets}, {.name = NULL}};
static const Refusal refusals[] = {{OUTLET, NEEDS, FEATURE_CONSISTENT, ", the default"},
                                   {OUTLET, NEEDS, FEATURE_DIVERGENCE, ", the default"},
                                   {OUTLET, NOT_WITH, FEATURE_DENSITIES, " yet"},
                                   {OUTLET, NOT_WITH, FEATURE_FRAME, " yet: a level in it is no plane"},
                                   {OUTLET, NOT_WITH, "-central_force_rate", ": it has no level"},
                                   {OUTLET, NOT_WITH, "-gas", " yet: beside an open face there is open air"},
                                   {.one = NULL}};

const Edge OutletEdge = {.name        = "outlets",
                         .properties  = properties,
                         .features    = features,
                         .refusals    = refusals,
                         .gauge       = &GaugeOutlets,
                         .data_size   = sizeof(Outlets),
                         .number_size = sizeof(OutletNumbers),
                         .sums        = sizeof(OutletSums) / sizeof(PetscReal),
                         .numbers     = rows,
                         .create      = Create,
                         .on          = On,
                         .drives      = On,
                         .speed       = Speed,
                         .options     = Options,
                         .freeze      = Freeze,
                         .kick        = Kick,
                         .guard       = Guard,
                         .commit      = Commit,
                         .doubt       = Doubt,
                         .renew       = Renew};
