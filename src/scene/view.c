/* SceneView: the bodies with their sizes and dimensionless numbers, and warnings of too coarse a spacing and of wrong
   units. */
#include "scene_impl.h"
#include <string.h>

#define ALONG        0.9  /* of an emitter's speed: a direction along which its liquid leaves is no thickness */
#define BODY_SAMPLES 5    /* points a direction at which a body's velocity and body force are sampled */
#define CUT          1e-6 /* spacings between two bodies that are one, cut in two */
#define ACROSS_MIN   6    /* spacings across a body: fewer hardly resolve its flow */
#define WAVE_MIN     12   /* spacings a wavelength: fewer hardly resolve the wave */
#define RIM_SAMPLES  12   /* points a direction at which a solid is looked for */
#define RIM_NEAR     1.5  /* spacings */
#define WEBER_DRIPS  4    /* below, liquid drips from a tube instead of leaving as a jet (Clanet and Lasheras 1999) */
#define BOND_MAX     1e4  /* with a larger Bond number tension cannot matter: a drop of water of a quarter of a metre */
#define WEBER_MAX    1e7  /* with a larger Weber number the liquid is spray: a likely cause is lengths in mm */

/* Whether a box of liquid continues another, with these bounds (m), of one liquid: then both are one box, whose bounds
   replace them. */
static PetscBool Continues(Body one, Body body, PetscReal lower[DIM], PetscReal upper[DIM])
{
  const PetscReal near = CUT * body->domain->spacing;
  PetscReal       low[DIM], high[DIM];
  PetscInt        apart = 0, along = 0;

  if (body == one || strcmp(body->shape_type, "box") || BodyComesLater(body)) return PETSC_FALSE;
  if (!BodiesAlike(one, body)) return PETSC_FALSE;
  BodyBounds(body, low, high);
  for (PetscInt d = 0; d < DIM; d++) {
    if (PetscAbsReal(low[d] - lower[d]) <= near && PetscAbsReal(high[d] - upper[d]) <= near) continue;
    along = d;
    apart++;
  }
  if (apart != 1 || PetscMin(PetscAbsReal(low[along] - upper[along]), PetscAbsReal(high[along] - lower[along])) > near)
    return PETSC_FALSE;
  lower[along] = PetscMin(low[along], lower[along]);
  upper[along] = PetscMax(high[along], upper[along]);
  return PETSC_TRUE;
}

/* The bounds (m) of body b, with those of all bodies that it was cut from: a film of two bodies is one film, and its
   scales are those of one. */
static void WholeBounds(Scene scene, PetscInt b, PetscReal lower[DIM], PetscReal upper[DIM])
{
  const Body one    = SceneBody(scene, b);
  PetscBool  larger = (PetscBool) !(strcmp(one->shape_type, "box") || BodyComesLater(one));

  BodyBounds(one, lower, upper);
  while (larger) {
    larger = PETSC_FALSE;
    for (PetscInt k = 0; k < SceneCount(scene); k++)
      if (Continues(one, SceneBody(scene, k), lower, upper)) larger = PETSC_TRUE;
  }
}

/* The least of the extents between bounds (m), with their mirror images; not along 'along' (NULL: none). */
static PetscReal LeastExtent(Domain domain, const PetscReal lower[DIM], const PetscReal upper[DIM],
                             const PetscReal along[DIM])
{
  PetscReal least = PETSC_MAX_REAL;

  for (PetscInt d = 0; d < domain->dim; d++) {
    const PetscBool mirrored = (PetscBool)((domain->face[d][0] == FACE_SYMMETRY && lower[d] <= domain->lower[d]) ||
                                           (domain->face[d][1] == FACE_SYMMETRY && upper[d] >= domain->upper[d]));

    if (along && PetscAbsReal(along[d]) > ALONG * Norm(along)) continue;
    least = PetscMin(least, (mirrored ? 2 : 1) * (upper[d] - lower[d]));
  }
  return least;
}

static PetscReal Thickness(Scene scene, PetscInt b)
{
  const Body body = SceneBody(scene, b);
  PetscReal  lower[DIM], upper[DIM];

  WholeBounds(scene, b, lower, upper);
  return LeastExtent(scene->domain, lower, upper, BodyComesLater(body) ? body->uniform : NULL);
}

PetscReal SceneBodyThinnest(Scene scene, PetscInt b)
{
  const Body body  = SceneBody(scene, b);
  PetscReal  least = Thickness(scene, b), lower[DIM], upper[DIM];

  for (PetscInt k = 0; k < body->holes; k++) {
    BodyBounds(body->hole[k], lower, upper);
    least = PetscMin(least, LeastExtent(scene->domain, lower, upper, NULL));
  }
  return least;
}

void SceneBodyScales(Scene scene, PetscInt b, BodyScales *scales)
{
  Body      body = SceneBody(scene, b);
  PetscReal lower[DIM], upper[DIM], g[DIM], v[DIM], x[DIM];

  *scales = (BodyScales){.length = Thickness(scene, b)};
  WholeBounds(scene, b, lower, upper);
  for (PetscInt d = 0; d < DIM; d++) scales->extent[d] = upper[d] - lower[d];
  BodyBounds(body, lower, upper);
  for (PetscInt k = 0; k < BODY_SAMPLES * BODY_SAMPLES * BODY_SAMPLES; k++) {
    const PetscInt at[DIM] = {k % BODY_SAMPLES, (k / BODY_SAMPLES) % BODY_SAMPLES, k / (BODY_SAMPLES * BODY_SAMPLES)};

    for (PetscInt d = 0; d < DIM; d++) x[d] = lower[d] + (upper[d] - lower[d]) * at[d] / (BODY_SAMPLES - 1);
    BodyVelocity(body, x, v);
    ForcesMost(scene, x, g);
    scales->speed = PetscMax(scales->speed, Norm(v));
    for (PetscInt d = 0; d < DIM; d++) scales->acceleration[d] = PetscMax(scales->acceleration[d], g[d]);
  }
}

/* Warns of too coarse a spacing and of wrong units. */
static PetscErrorCode Warn(Body body, PetscReal across, PetscReal bond, PetscReal weber, PetscViewer viewer)
{
  const PetscReal wave = body->shape->wave ? body->shape->wave(body) / body->domain->spacing : 0;

  PetscFunctionBegin;
  if (across < ACROSS_MIN)
    PetscCall(PetscViewerASCIIPrintf(viewer, "warning: %s is only %.2g spacings across; its flow needs %d or more\n",
                                     body->name, (double)across, ACROSS_MIN));
  if (wave > 0 && wave < WAVE_MIN)
    PetscCall(PetscViewerASCIIPrintf(viewer,
                                     "warning: the waves of %s are only %.2g spacings long; they need %d or more\n",
                                     body->name, (double)wave, WAVE_MIN));
  if (bond > BOND_MAX || weber > WEBER_MAX)
    PetscCall(PetscViewerASCIIPrintf(
      viewer, "warning: surface tension hardly affects %s at this size and speed: omit it, or are lengths not in m?\n",
      body->name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a solid, on whose rim a drop could hang, is within a spacing or two of an emitter's surface. */
static PetscBool HasRim(Scene scene, Body body)
{
  const PetscReal d0 = scene->domain->spacing;
  PetscReal       lower[DIM], upper[DIM];

  BodyBounds(body, lower, upper);
  for (PetscInt k = 0; k < RIM_SAMPLES * RIM_SAMPLES * RIM_SAMPLES; k++) {
    const PetscInt at[DIM] = {k % RIM_SAMPLES, k / RIM_SAMPLES % RIM_SAMPLES, k / (RIM_SAMPLES * RIM_SAMPLES)};
    PetscReal      x[DIM];

    for (PetscInt d = 0; d < DIM; d++) x[d] = lower[d] + (upper[d] - lower[d]) * at[d] / (RIM_SAMPLES - 1);
    if (BodyDistance(body, x) < d0 && SceneSolidDistance(scene, x, NULL) < RIM_NEAR * d0) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

void SceneNumbers(Scene scene, PetscInt b, BodyNumbers *numbers)
{
  Body            body = SceneBody(scene, b);
  const Material *m    = &body->material;
  BodyScales      scales;
  PetscReal       L, U, g, inertia, weight, viscosity;

  SceneBodyScales(scene, b, &scales);
  L         = scales.length;
  U         = scales.speed;
  g         = Norm(scales.acceleration);
  inertia   = m->density * U * U * L; /* N/m */
  weight    = m->density * g * L * L; /* N/m */
  viscosity = BodyViscosity(body, U / L);
  *numbers  = (BodyNumbers){.length    = L,
                            .speed     = U,
                            .viscosity = viscosity,
                            .number    = {{"Re", m->density * U * L, viscosity},
                                          {"We", inertia, m->tension},
                                          {"Fr", U * U, g * L},
                                          {"Bo", weight, m->tension},
                                          {"Oh", viscosity, PetscSqrtReal(m->density * m->tension * L)},
                                          {"Ca", viscosity * U, m->tension}}};
  for (PetscInt k = 0; k < SCENE_NUMBERS; k++) {
    DimensionlessNumber *n = &numbers->number[k];

    n->value = n->above > 0 && n->below > 0 ? n->above / n->below : NAN;
  }
}

/* Prints the least extent of body b, its dimensionless numbers, and the warnings. */
static PetscErrorCode ViewNumbers(Scene scene, PetscInt b, PetscViewer viewer)
{
  Body            body = SceneBody(scene, b);
  const Material *m    = &body->material;
  BodyNumbers     numbers;
  PetscReal       across, inertia, weight;
  char            text[256] = "", number[64];

  PetscFunctionBegin;
  SceneNumbers(scene, b, &numbers);
  across  = numbers.length / scene->domain->spacing;
  inertia = numbers.number[NUMBER_WEBER].above;
  weight  = numbers.number[NUMBER_BOND].above;
  for (PetscInt k = 0; k < SCENE_NUMBERS; k++) {
    if (PetscIsNanReal(numbers.number[k].value)) continue;
    PetscCall(
      PetscSNPrintf(number, sizeof(number), ", %s %.3g", numbers.number[k].name, (double)numbers.number[k].value));
    TextAppend(text, sizeof(text), number);
  }
  PetscCall(PetscViewerASCIIPrintf(viewer, "least extent %.3g m, %.3g spacings%s\n", (double)numbers.length,
                                   (double)across, text));
  PetscCall(
    Warn(body, across, m->tension > 0 ? weight / m->tension : 0, m->tension > 0 ? inertia / m->tension : 0, viewer));
  if (BodyComesLater(body) && weight > 0 &&
      PetscMax(inertia / WEBER_DRIPS, numbers.viscosity * numbers.speed) < m->tension && !HasRim(scene, body))
    PetscCall(PetscViewerASCIIPrintf(
      viewer,
      "warning: %s is so slow that its liquid drips, but there is no solid on whose rim a drop could hang: drops will "
      "be a tenth too small; give it a tube, as in cases/dripping\n",
      body->name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode SceneView(Scene scene, PetscViewer viewer)
{
  PetscBool ascii;

  PetscFunctionBegin;
  if (!viewer) PetscCall(PetscViewerASCIIGetStdout(scene->domain->comm, &viewer));
  PetscCall(PetscObjectTypeCompare((PetscObject)viewer, PETSCVIEWERASCII, &ascii));
  if (!ascii) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ForcesView(scene, viewer));
  PetscCall(PetscViewerASCIIPushTab(viewer));
  PetscCall(FrameView(scene, viewer));
  for (PetscInt b = 0; b < scene->count; b++) {
    PetscCall(BodyView(scene->body[b], PETSC_FALSE, viewer));
    PetscCall(PetscViewerASCIIPushTab(viewer));
    PetscCall(ViewNumbers(scene, b, viewer));
    PetscCall(PetscViewerASCIIPopTab(viewer));
  }
  PetscCall(LiquidsView(scene, viewer));
  for (PetscInt b = 0; b < scene->solids; b++) {
    PetscCall(PetscViewerASCIIPrintf(viewer, "solid "));
    PetscCall(BodyView(scene->solid[b], SceneHasTension(scene), viewer));
  }
  PetscCall(PetscViewerASCIIPopTab(viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}
